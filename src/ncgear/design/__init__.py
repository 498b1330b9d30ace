"""The design file: its schema, how it is read, where each value stands in it, and the templates of new ones."""
