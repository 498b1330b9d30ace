"""What the keys of a file mean, read from the models that check it."""
