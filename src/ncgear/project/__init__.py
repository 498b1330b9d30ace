"""A design file and all that follows from it."""
