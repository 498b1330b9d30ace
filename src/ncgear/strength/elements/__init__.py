"""Plane finite elements on the exact outline of every tooth of a gear."""
