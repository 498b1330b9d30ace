"""What is written: tables, meshes, workshop formats, and how they reach a folder."""
