"""Contact of the exact curves, before anything is written."""
