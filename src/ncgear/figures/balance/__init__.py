"""What a balance file's figures are, by its parts, and how they are told."""
