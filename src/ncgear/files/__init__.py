"""The files that commands write (tables, meshes, workshop formats), and how they reach a folder."""
