"""The results of a check and of a build, as plain values whose keys end in their unit."""
