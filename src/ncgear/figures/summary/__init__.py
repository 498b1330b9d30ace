"""What a check and a build find, as plain values whose keys end in their unit."""
