"""Outlines as polygons: chord error, economy, orientation, convergence, symmetry, and hard gears."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import atan, pi, radians
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely import Polygon

from ncgear.machine.rack import BasicRack
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import FILLET, FLANK
from ncgear.teeth.form import TipLimits, ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair
from oracles import rack_cut
from pairs import baler_law, sine_law

DESIGNS = Path(__file__).parents[1] / "designs"
TOLERANCE = 0.005
DENSE = 400
"""Points per exact curve: an outline has 2 to 20 chords on one, so chords are seen 20 times and more."""

Array = np.ndarray


LAWS: dict[str, Callable[[], Transmission]] = {
    "uniform": lambda: uniform_law(Lobes()),
    "ellipse": lambda: elliptical_law(0.35, 0.0, Lobes()),
    "sharp ellipse": lambda: elliptical_law(0.7, 0.0, Lobes()),
    "sine": lambda: sine_law(0.08),
    "1:2": lambda: elliptical_law(0.2, 0.3, Lobes(1, 2)),
    "3:1": lambda: elliptical_law(0.3, 0.0, Lobes(3, 1)),
    "baler": baler_law,
}


def pitch_pair(name: str, teeth: int, module: float) -> PitchPair:
    """Pitch curves of a law for so many driving teeth."""
    law = LAWS[name]()
    return sized_pair(law, teeth, module, None)


@cache
def made(name: str, teeth: int, module: float = 2.0, tolerance: float = TOLERANCE) -> tuple[PitchPair, ToothedPair]:
    """A pair with ISO 53 A teeth."""
    pitch = pitch_pair(name, teeth, module)
    rack = BasicRack(module, radians(20.0), module, 1.25 * module, 0.38 * module)
    form = ToothForm(rack, limits=TipLimits(0.2 * module))
    return pitch, toothed_pair(pitch, form, tolerance, flank_tolerance_mm=tolerance)


def gears(name: str, teeth: int, module: float = 2.0, tolerance: float = TOLERANCE) -> tuple[ToothedGear, ToothedGear]:
    """Both gears of a pair."""
    pair = made(name, teeth, module, tolerance)[1]
    return pair.driving, pair.driven


CASES = [("uniform", 18), ("ellipse", 37), ("sharp ellipse", 25), ("sine", 25), ("1:2", 25), ("3:1", 60), ("baler", 25)]


# --- chords ------------------------------------------------------------------------------------------------------


def dense_sides(gear: ToothedGear, kind: int) -> Array:
    """Dense points on what is left of all curves of a kind, shape (runs, DENSE, 2)."""
    own, sides = gear.flanks, gear.sides
    chosen = sides.kind == kind
    start, end = sides.start[chosen][:, None], sides.end[chosen][:, None]
    curve = {FLANK: own.flank, FILLET: own.fillet}[kind]
    return curve(sides.owner[chosen][:, None], start + (end - start) * np.linspace(0.0, 1.0, DENSE))[0]


def dense_lands(gear: ToothedGear) -> list[Array]:
    """Dense points on tip lands and root lands, the one across the seam included."""
    own, sides = gear.flanks, gear.sides
    share = np.linspace(0.0, 1.0, DENSE)
    back, front = sides.tip_mm[0::2, None], sides.tip_mm[1::2, None]
    heights = own.tip_height_mm.reshape(-1, 2)
    parallel = own.offset(back + (front - back) * share, heights[:, :1])[0]
    edges = own.offset(sides.tip_mm, own.tip_height_mm)[0].reshape(-1, 2, 2)
    straight = edges[:, :1] + (edges[:, 1:] - edges[:, :1]) * share[:, None]
    level = heights[:, 0] == heights[:, 1]
    start, end = sides.roots.lands()
    every = np.arange(gear.teeth)[:, None]
    roots = sides.roots.land(every, start[:, None] + (end - start)[:, None] * share)[0]
    return [np.where(level[:, None, None], parallel, straight), roots]


def distances(points: Array, gear: ToothedGear) -> Array:
    """Of points to the outline, in their shape."""
    flat = shapely.points(points.reshape(-1, 2))
    return rack_cut.deviation_of_points(flat, Polygon(gear.outline_mm)).reshape(points.shape[:-1])


@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_no_exact_curve_is_farther_from_the_outline_than_the_tolerance(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        for kind in (FLANK, FILLET):
            points = dense_sides(gear, kind)
            assert not points.size or distances(points, gear).max() <= TOLERANCE
        assert max(distances(points, gear).max() for points in dense_lands(gear)) <= TOLERANCE


@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_vertices_are_on_the_exact_curves(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        pieces = [*(dense_sides(gear, kind) for kind in (FLANK, FILLET)), *dense_lands(gear)]
        exact = shapely.MultiLineString([line for piece in pieces for line in piece])
        shapely.prepare(exact)
        # The dense points' own chords: 400 to a curve of 20 chords or less, (1/20)^2 of the tolerance, twice over.
        assert shapely.distance(exact, shapely.points(gear.outline_mm)).max() < TOLERANCE / 200.0


@pytest.mark.parametrize(("name", "teeth"), CASES)
@pytest.mark.parametrize("tolerance", [0.02, 0.001])
def test_flanks_use_the_tolerance(name: str, teeth: int, tolerance: float) -> None:
    """Chord counts are whole numbers: the worst of many flanks uses a good share, if not every one does."""
    for gear in gears(name, teeth, 2.0, tolerance):
        worst = distances(dense_sides(gear, FLANK), gear).max()
        assert tolerance / 3.0 <= worst <= tolerance


def needed_chords(points: Array, tolerance: float) -> Array:
    """Chords of even error along dense curves (shape (runs, DENSE, 2)): the integral of sqrt(k / 8 t) by arc length."""
    chord = np.diff(points, axis=1)
    length = np.linalg.norm(chord, axis=-1)
    direction = np.unwrap(np.arctan2(chord[..., 1], chord[..., 0]), axis=1)
    turn = np.abs(np.diff(direction, axis=1))
    return np.sum(np.sqrt((length[:, 1:] + length[:, :-1]) / 2.0 * turn / (8.0 * tolerance)), axis=1)


@pytest.mark.parametrize(("name", "teeth"), CASES)
@pytest.mark.parametrize("tolerance", [0.005, 0.0005, 0.00002])
def test_outline_has_hardly_more_points_than_are_needed(name: str, teeth: int, tolerance: float) -> None:
    for gear in gears(name, teeth, 2.0, tolerance):
        pieces = [*(dense_sides(gear, kind) for kind in (FLANK, FILLET)), *dense_lands(gear)]
        least = sum(np.ceil(needed_chords(piece, tolerance)).sum() for piece in pieces if piece.size)
        # Chords are placed for 0.95 of the tolerance, which is 1.026 times as many; the rest is whole numbers and cuts,
        # of which every flank has one more where its mate ceases to touch it.
        assert 0.95 * least < len(gear.outline_mm) < 1.07 * least + 2.0 * gear.teeth


# --- the polygon -------------------------------------------------------------------------------------------------


def steps(outline: Array) -> Array:
    """Chords of a closed outline."""
    return np.roll(outline, -1, axis=0) - outline


def turns(outline: Array) -> Array:
    """Angle turned at each vertex, -pi to pi."""
    after = steps(outline)
    before = np.roll(after, 1, axis=0)
    return np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], np.sum(before * after, axis=1))


@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_outline_is_a_simple_counter_clockwise_polygon(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        polygon = Polygon(gear.outline_mm)
        assert polygon.is_valid
        assert polygon.exterior.is_ccw
        assert polygon.contains(shapely.Point(0.0, 0.0))
        assert np.linalg.norm(steps(gear.outline_mm), axis=1).min() > 1e-9
        assert turns(gear.outline_mm).sum() == pytest.approx(2.0 * pi, abs=1e-9)


@pytest.mark.parametrize("tolerance", [TOLERANCE, TOLERANCE / 10.0])
@pytest.mark.parametrize(
    ("name", "teeth"),
    [*CASES, *(("uniform", z) for z in (12, 16)), *(("baler", z) for z in (19, 23, 31, 38, 48)), ("sharp ellipse", 13)],
)
def test_outline_never_turns_back(name: str, teeth: int, tolerance: float) -> None:
    """A tip turns by 90 degrees less the pressure angle there, or the slope of its land more, a quarter at most.

    Nothing else on a tooth is as sharp.  Slightly undercut teeth and jumps of the curvature make loops of micrometres,
    which must be cut off as well.
    """
    for gear in gears(name, teeth, tolerance=tolerance):
        assert np.abs(turns(gear.outline_mm)).max() < pi / 2.0 + atan(0.25)


@pytest.mark.parametrize("tolerance", [0.02, 0.001, 0.0001])
def test_the_tolerance_holds_across_jumps_of_the_curvature(tolerance: float) -> None:
    for gear in gears("baler", 25, 3.0, tolerance):
        assert max(distances(dense_sides(gear, kind), gear).max() for kind in (FLANK, FILLET)) <= tolerance


@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_flanks_cross_the_pitch_curve_twice_a_tooth(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        curve = gear.flanks.curve
        pitch = Polygon(curve.at_length(np.arange(20_000) * (curve.length_mm / 20_000)).position)
        shapely.prepare(pitch)
        inside = shapely.contains(pitch, shapely.points(gear.outline_mm))
        assert np.sum(inside != np.roll(inside, 1)) == 2 * gear.teeth
