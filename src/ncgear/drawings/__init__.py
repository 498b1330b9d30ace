"""Drawings: charts, pictures, the scene, the animation, the page of the report."""
