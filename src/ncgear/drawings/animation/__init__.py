"""The scene as a moving picture."""
