"""Thousands of designs at a time: the figures of a check and of the pitch curves; teeth are not made."""
