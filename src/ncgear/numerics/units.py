"""Units of the design files and the papers in those of the code."""

from __future__ import annotations

from math import pi

RAD_S_PER_RPM = pi / 30.0
"""One turn per minute in rad/s."""
