"""The documentation's code, run as a reader would run it."""
