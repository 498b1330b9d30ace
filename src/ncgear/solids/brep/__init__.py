"""Gears as solids with exact faces.  The OpenCASCADE library makes them; only the extra ``step`` installs it."""
