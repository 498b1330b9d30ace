"""Strength of whole drives in limits and under scaling, where it is known without computing it another way."""

from __future__ import annotations

import numpy as np
import pytest

from drives import drive_of_text
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.strengthening import rating_of

CIRCLES = "law: uniform_crank"


def made(law: str, scale: float = 1.0, load_n: float = 600.0, teeth: int = 24) -> Drive:
    """A pump with dynamic factor 1; its lengths times ``scale`` and its load times the square of that."""
    return drive_of_text(
        f"""\
name: pump
linkage: {{crank_mm: {30 * scale}, rod_mm: {90 * scale}}}
operation: {{speed_rpm: 60}}
motion: {{{law}}}
gears: {{teeth: {teeth}, module_mm: {2 * scale}, face_width_mm: {12 * scale}}}
resistance: {{polynomial_n: [{load_n * scale**2}]}}
strength: {{dynamic_factor: 1.0}}
"""
    )


@pytest.mark.tiers(slow=["estimate"], rest="long")
@pytest.mark.judges("strength")
@pytest.mark.parametrize("method", ["estimate", pytest.param("elements", marks=pytest.mark.slow)])
def test_ellipses_of_no_eccentricity_are_circles(method: str) -> None:
    """Radii of pitch curves differ by e = 1e-4, so stresses do by as much; at e = 0.2, the control, by far more."""
    circles, ellipses, control = (
        rating_of(made(law), method).weakest  # type: ignore[arg-type]
        for law in (CIRCLES, "law: ellipse, eccentricity: 1e-4", "law: ellipse, eccentricity: 0.2")
    )
    for one, other in zip(circles, ellipses, strict=True):
        assert (other.gear, other.damage, other.tooth) == (one.gear, one.damage, one.tooth)
        assert other.stress_mpa == pytest.approx(one.stress_mpa, rel=3e-4)
        assert other.safety == pytest.approx(one.safety, rel=3e-4)
    far = max(abs(other.stress_mpa / one.stress_mpa - 1.0) for one, other in zip(circles, control, strict=True))
    assert far > 0.03


@pytest.mark.slow
@pytest.mark.judges("strength")
def test_all_lengths_grown_alike_and_loads_by_their_square_leave_stresses_as_they_are() -> None:
    law = "law: ellipse, eccentricity: 0.3"
    small, large = (rating_of(made(law, scale), "estimate").strength for scale in (1.0, 10.0))
    for gear in Gear:
        for kind in ("bending", "contact"):
            mine, other = (getattr(strength.of(gear), kind).stress_mpa for strength in (small, large))
            np.testing.assert_allclose(other, mine, rtol=1e-5)
