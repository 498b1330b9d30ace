"""What moves in a machine, and where it is at any driving angle."""
