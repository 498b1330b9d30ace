"""The keys of each kind of wish, and their registry."""
