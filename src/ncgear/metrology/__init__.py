"""What a workshop measures on a finished gear, from the exact curves of its teeth."""
