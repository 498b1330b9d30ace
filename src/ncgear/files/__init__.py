"""The files that commands write, in tables, meshes and workshop formats, and how they reach a folder."""
