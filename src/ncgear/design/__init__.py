"""The design file: its keys, its reading, the place of each value in it, and the templates of new files."""
