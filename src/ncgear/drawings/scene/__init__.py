"""The scene: all bodies of a machine, and their places at any driving angle."""
