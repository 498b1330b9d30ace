"""Gear bodies: planned from a tooth outline and wishes for the body, then made as checked meshes or exact solids."""
