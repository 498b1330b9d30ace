"""Files for the workshop."""
