"""A design file and everything that follows from it."""
