"""Gears as rigid bodies: the driven one, pushed by nothing but contact, turns as the law says.

The engine (see oracles/rigid_body.py) shares nothing with ncgear, neither the theory of the flanks nor the contact of
the outlines.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import cos, pi

import numpy as np
import pytest
from shapely import Polygon

from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import FLANK
from ncgear.teeth.form import Backlash, ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair
from oracles import rigid_body
from pairs import rack, sine_law

pytestmark = pytest.mark.slow

Array = np.ndarray
Outlines = tuple[Array, Array]

MODULE, TEETH, TOLERANCE = 2.0, 30, 0.005

STEPS = 4000
"""Steps a turn, 133 a tooth."""

DRAG = 3.0
"""Torque per speed and moment of inertia, in 1/s at 1 rad/s: the laws slow the driven gear down by 0.8 at most, so that
it is always pushed and never runs ahead."""

LAWS: dict[str, Callable[[], Transmission]] = {
    "sine": lambda: sine_law(0.1),
    "ellipse": lambda: elliptical_law(0.35, 0.0, Lobes()),
}


@cache
def made(name: str, tolerance: float = TOLERANCE) -> tuple[PitchPair, ToothedPair]:
    """A pair whose ratio varies by a factor of 1.5 (sine) or 4.3 (ellipse); the backlash is on the idle flanks."""
    pitch = sized_pair(LAWS[name](), TEETH, MODULE, None)
    return pitch, toothed_pair(pitch, ToothForm(rack(module=MODULE), backlash=Backlash(0.05)), tolerance)


def outlines(name: str, tolerance: float = TOLERANCE) -> Outlines:
    pair = made(name, tolerance)[1]
    return pair.driving.outline_mm, pair.driven.outline_mm


def worst_lag(name: str, both: Outlines, steps: int = STEPS) -> float:
    """Largest distance of the driven body from the law over a turn, in rad, ahead or behind."""
    pitch = made(name)[0]
    transmission = pitch.transmission
    pieces = rigid_body.convex_pieces(both[0]), rigid_body.convex_pieces(both[1])
    speed = float(transmission.driven_angle(np.zeros(1), 1).derivative(1)[0])
    turning = rigid_body.turned(pieces, pitch.center_distance_mm, speed, DRAG, steps)
    return float(np.abs(rigid_body.lag(turning, lambda phi1: transmission.driven_angle(phi1).value)).max())


def allowed_lag(name: str, tolerance: float, steps: int) -> float:
    """What chords, slop and steps explain.

    Chords: both outlines off by the tolerance along the normal, at the shortest lever of the line of action about the
    driven axis.  Steps: the engine feels a contact only when there is an overlap, so in each step the drag and the
    law's own change of speed open a gap that a few steps close.
    """
    pitch = made(name)[0]
    low = pitch.center_distance_mm / (1.0 + pitch.transmission.slope_range[1].value)
    lever = low * cos(rack().pressure_angle_rad + pitch.largest_tangent_angle_rad.value)
    step = 2.0 * pi / steps
    return (2.0 * tolerance + rigid_body.SLOP) / lever + 3.0 * (DRAG + 1.0) * step**2


# --- the oracle itself -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", LAWS)
def test_pieces_are_convex_and_tile_the_outline(name: str) -> None:
    for outline in outlines(name):
        pieces = [Polygon(piece) for piece in rigid_body.convex_pieces(outline)]
        assert sum(piece.area for piece in pieces) == pytest.approx(Polygon(outline).area, rel=1e-12)
        assert max(piece.convex_hull.area - piece.area for piece in pieces) < 1e-9
        assert all(piece.exterior.is_ccw for piece in pieces)
        assert len(pieces) < len(outline) / 2


def square(half: float) -> Array:
    return half * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


def test_a_body_out_of_reach_is_not_driven() -> None:
    pieces = rigid_body.convex_pieces(square(1.0)), rigid_body.convex_pieces(square(1.0))
    turning = rigid_body.turned(pieces, 10.0, 1.0, DRAG, 400)
    assert np.ptp(turning.driving) == pytest.approx(2.0 * pi, rel=0.01)
    assert np.ptp(turning.driven) < 0.2


# --- gears -------------------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("name", LAWS)
def test_driven_gear_turns_as_the_law_says(name: str) -> None:
    assert worst_lag(name, outlines(name)) <= allowed_lag(name, TOLERANCE, STEPS)


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("name", ["sine", "ellipse"])
def test_finer_outlines_follow_the_law_more_closely(name: str) -> None:
    tolerance, steps = TOLERANCE / 4.0, 2 * STEPS
    assert worst_lag(name, outlines(name, tolerance), steps) <= allowed_lag(name, tolerance, steps)


def straight_sided(gear: ToothedGear) -> Array:
    """Teeth of the same number, height and thickness at the pitch curve with straight flanks.

    Each flank is parallel to the chord of the exact one and goes through its crossing with the pitch curve.
    """
    flanks, sides = gear.flanks, gear.sides
    every, top = np.arange(flanks.count), np.full(flanks.count, -np.inf)
    on_flank = sides.kind == FLANK
    np.maximum.at(top, sides.owner[on_flank], sides.start[on_flank])
    crossing, high, low = (flanks.flank(every, height)[0] for height in (0.0 * top, top, -MODULE + 0.0 * top))
    direction = (high - low) / (top + MODULE)[:, None]
    tips, roots = crossing + top[:, None] * direction, crossing - 1.25 * MODULE * direction
    teeth = np.stack([roots[0::2], tips[0::2], tips[1::2], roots[1::2]], axis=1).reshape(-1, 2)
    return teeth if Polygon(teeth).exterior.is_ccw else teeth[::-1]


@pytest.mark.parametrize("name", LAWS)
def test_straight_sided_teeth_do_not(name: str) -> None:
    """Negative control."""
    pair = made(name)[1]
    both = straight_sided(pair.driving), straight_sided(pair.driven)
    for straight, exact in zip(both, outlines(name), strict=True):
        assert Polygon(straight).is_valid
        assert Polygon(straight).area == pytest.approx(Polygon(exact).area, rel=0.02)
    assert worst_lag(name, both) > 5.0 * allowed_lag(name, TOLERANCE, STEPS)


@pytest.mark.long
@pytest.mark.parametrize("name", LAWS)
def test_gears_put_together_a_tooth_off_do_not(name: str) -> None:
    """Negative control: the driven gear one tooth on."""
    driving, driven = outlines(name)
    angle = 2.0 * pi / TEETH
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    assert worst_lag(name, (driving, driven @ turn)) > 5.0 * allowed_lag(name, TOLERANCE, STEPS)
