"""Pitch curves of both gears: shape, arc length, curvature, pressure angle, and the size that fits the teeth."""
