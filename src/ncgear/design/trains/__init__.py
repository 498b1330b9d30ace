"""The keys of every kind of train, and their registry."""
