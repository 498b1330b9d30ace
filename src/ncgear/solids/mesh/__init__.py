"""Gears as closed meshes of triangles."""
