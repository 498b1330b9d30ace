"""The keys of both files, as models that check what a person wrote."""
