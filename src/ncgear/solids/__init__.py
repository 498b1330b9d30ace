"""Gear bodies: planned from a tooth outline and what is asked of it, then made as checked meshes or exact solids."""
