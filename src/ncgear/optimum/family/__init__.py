"""The published family of laws, and the best of it."""
