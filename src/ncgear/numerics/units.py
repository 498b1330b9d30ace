"""Units of the design files and the papers in those of the code."""

from __future__ import annotations

from math import pi

RAD_S_PER_RPM = pi / 30.0
"""One turn per minute in rad/s."""

N_PER_KG_MM_S2 = 1e-3
"""One kg mm/s^2 in N; likewise one kg mm^2/s^2 in N mm."""

N_M_PER_N_MM = 1e-3
"""One N mm in N m."""
