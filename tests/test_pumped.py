"""The displacement of gears in a housing, judged by areas and by moments of pressure on the pitch curves."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from shapely import Polygon

from at_once import at_once
from drives import built, drive, drive_of_text
from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.pitch.chambers import Pumped, pumped
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear

WIDTH = 25.0
TEXT = """
name: oval
operation: {{speed_rpm: 300}}
motion: {{law: ellipse, eccentricity: {share}}}
gears: {{lobes: {{driving: {lobes}, driven: {lobes}}}, teeth: 48, module_mm: 1.5, face_width_mm: 25,
  housing: {{clearance_mm: 0.03}}}}
"""


def pair(share: float, lobes: int) -> PitchPair:
    return drive_of_text(TEXT.format(share=share, lobes=lobes)).pitch


def of(pitch: PitchPair, over_mm: float = 1.5) -> tuple[Pumped, tuple[float, float]]:
    """What a pair displaces in a housing a little outside its pitch curves."""
    first, second = (pitch.radius_range_mm(gear)[1] + over_mm for gear in Gear)
    return pumped(pitch.transmission, pitch.center_distance_mm, (first, second), WIDTH), (first, second)


def curve_mm(pitch: PitchPair, gear: Gear, phi1: Array) -> Array:
    return np.asarray(pitch.of(gear).at_angle(phi1).position)


@at_once(("share", "lobes"), [(0.05, 2), (0.2, 2), (0.3, 2), (0.1, 3)])
def test_a_turn_displaces_the_spaces_between_gears_and_housing(share: float, lobes: int) -> None:
    """What is left of both circles beside both pitch curves passes once a turn; areas are of polygons."""
    pitch = pair(share, lobes)
    found, radii = of(pitch)
    phi1 = np.linspace(0.0, 2.0 * pi, 20_001)[:-1]
    areas = [Polygon(curve_mm(pitch, gear, phi1)).area for gear in Gear]
    spaces = sum(pi * radius**2 - area for radius, area in zip(radii, areas, strict=True))
    assert found.per_turn_mm3 == pytest.approx(WIDTH * spaces, rel=1e-7)


@pytest.mark.thorough
def test_the_flow_is_what_pressure_on_the_gears_does() -> None:
    """Unit pressure turns each gear from its pitch point to its tip at the housing; power is pressure times flow."""
    pitch = pair(0.2, 2)
    found, (first, second) = of(pitch)

    def flow(phi1: float) -> float:
        """In mm^3 per rad of the driving gear."""
        slope = float(pitch.transmission.driven_angle(np.array([phi1]), 1).derivative(1)[0])
        total = 0.0
        for gear, radius, speed in ((Gear.DRIVING, first, 1.0), (Gear.DRIVEN, second, slope)):
            # Along the curve to where it is farthest from the axis, and straight out to the housing.
            end = np.argmax(np.hypot(*curve_mm(pitch, gear, np.linspace(0.0, pi, 2001)).T)) * pi / 2000.0
            points = curve_mm(pitch, gear, np.linspace(phi1, phi1 + (end - phi1) % pi, 4001))
            points = np.vstack([points, points[-1] * radius / np.hypot(*points[-1])])
            # A pressure is across each chord; its moment about the axis is half the change of the squared radius.
            chords, middles = np.diff(points, axis=0), (points[1:] + points[:-1]) / 2.0
            total += WIDTH * speed * float(np.sum(chords * middles))
        return total

    places = np.linspace(0.1, 3.1, 13)
    flows = np.array([flow(float(at)) for at in places])
    assert found.least.value <= flows.min() + 1e-9 * flows.max()
    assert found.most.value >= flows.max() * (1.0 - 1e-9)
    assert flow(found.least.at) == pytest.approx(found.least.value, rel=1e-8)
    assert flow(found.most.at) == pytest.approx(found.most.value, rel=1e-8)


def test_circular_gears_have_the_formula_of_gear_pumps() -> None:
    """2 pi b (R^2 - r^2), and no pulsation of the pitch point's own."""
    pitch = drive_of_text(
        TEXT.replace("{{law: ellipse, eccentricity: {share}}}", "{{law: uniform_crank}}").format(lobes=2)
    ).pitch
    found, (radius, _) = of(pitch)
    assert found.per_turn_mm3 == pytest.approx(2.0 * pi * WIDTH * (radius**2 - 36.0**2), rel=1e-12)
    assert found.pulsation == pytest.approx(0.0, abs=1e-12)


@pytest.mark.slow
def test_the_flow_meter_is_what_its_written_outlines_make_it() -> None:
    """The circles about the outlines of driving.csv and driven.csv, and the spaces beside the pitch curves."""
    summary, made = built("oval-flow-meter").summary["displacement"], drive("oval-flow-meter")
    phi1 = np.linspace(0.0, 2.0 * pi, 20_001)[:-1]
    spaces = 0.0
    for gear in Gear:
        outline = np.loadtxt(built("oval-flow-meter").folder / f"{gear.value}.csv", delimiter=",", skiprows=1)
        radius = np.hypot(*outline.T).max() + 0.03
        spaces += pi * radius**2 - Polygon(curve_mm(made.pitch, gear, phi1)).area
    assert summary["per_turn_cm3"] == pytest.approx(25.0 * spaces / 1000.0, rel=1e-5)
    assert summary["mean_flow_l_min"] == pytest.approx(300.0 * summary["per_turn_cm3"] / 1000.0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("driving: 2, driven: 2", "driving: 1, driven: 1"), "two lobes or more"),
        (("teeth", "mesh: internal, teeth"), "ring"),
    ],
)
def test_what_is_no_meter_is_refused(change: tuple[str, str], said: str) -> None:
    with pytest.raises(WrongInput, match=said):
        drive_of_text(TEXT.format(share=0.2, lobes=2).replace(*change))
