"""Trains of gears that stand on more than two axes: parts, meshes, and how all of it moves."""
