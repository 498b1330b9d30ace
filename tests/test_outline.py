"""Outlines as polygons: chord error, economy, orientation, convergence, symmetry, and hard gears."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import cos, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely import Polygon, affinity

from ncgear.errors import NoSuchMechanism
from ncgear.machine.rack import BasicRack
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import CROWN, FILLET, FLANK
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair
from oracles import meshing, rack_cut
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
    return pitch, toothed_pair(pitch, rack, tolerance)


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
    curve = {CROWN: own.crown, FLANK: own.flank, FILLET: own.fillet}[kind]
    return curve(sides.owner[chosen][:, None], start + (end - start) * np.linspace(0.0, 1.0, DENSE))[0]


def dense_lands(gear: ToothedGear) -> list[Array]:
    """Dense points on tip lands (of teeth that are not pointed) and root lands, the one across the seam included."""
    own, sides, rack = gear.flanks, gear.sides, gear.flanks.rack
    blunt = ~sides.pointed[::2]
    tips = sides.tip_mm[0::2][blunt], sides.tip_mm[1::2][blunt]
    backs = np.append(own.rounding_mm[2::2], own.rounding_mm[0] + own.curve.length_mm)
    share = np.linspace(0.0, 1.0, DENSE)
    lands = ((*tips, rack.addendum_mm), (own.rounding_mm[1::2], backs, -rack.dedendum_mm))
    return [own.offset(a[:, None] + (b - a)[:, None] * share, height)[0] for a, b, height in lands]


def distances(points: Array, gear: ToothedGear) -> Array:
    """Of points to the outline, in their shape."""
    flat = shapely.points(points.reshape(-1, 2))
    return rack_cut.deviation_of_points(flat, Polygon(gear.outline_mm)).reshape(points.shape[:-1])


@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_no_exact_curve_is_farther_from_the_outline_than_the_tolerance(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        for kind in (CROWN, FLANK, FILLET):
            points = dense_sides(gear, kind)
            assert not points.size or distances(points, gear).max() <= TOLERANCE
        assert max(distances(points, gear).max() for points in dense_lands(gear)) <= TOLERANCE


@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_vertices_are_on_the_exact_curves(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        pieces = [*(dense_sides(gear, kind) for kind in (CROWN, FLANK, FILLET)), *dense_lands(gear)]
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
        pieces = [*(dense_sides(gear, kind) for kind in (CROWN, FLANK, FILLET)), *dense_lands(gear)]
        least = sum(np.ceil(needed_chords(piece, tolerance)).sum() for piece in pieces if piece.size)
        # Chords are placed for 0.95 of the tolerance, which is 1.026 times as many; the rest is whole numbers and cuts.
        assert 0.95 * least < len(gear.outline_mm) < 1.07 * least


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
    """A tip turns by 90 degrees less the pressure angle there; nothing else on a tooth is as sharp.

    Slightly undercut teeth and jumps of the curvature make loops of micrometres, which must be cut off as well.
    """
    for gear in gears(name, teeth, tolerance=tolerance):
        assert np.abs(turns(gear.outline_mm)).max() < pi / 2.0


@pytest.mark.parametrize("tolerance", [0.02, 0.001, 0.0001])
def test_the_tolerance_holds_across_jumps_of_the_curvature(tolerance: float) -> None:
    for gear in gears("baler", 25, 3.0, tolerance):
        assert max(distances(dense_sides(gear, kind), gear).max() for kind in (FLANK, FILLET)) <= tolerance


@pytest.mark.parametrize("teeth", [25, 37])
def test_sides_of_one_space_that_cross_are_refused(teeth: int) -> None:
    """A space in the middle of a deeply concave stretch, whose two sides run into each other at the root."""
    law = sine_law(0.3)
    pitch = sized_pair(law, teeth, 2.0, None)
    rack = BasicRack(2.0, radians(20.0), 2.0, 2.5, 0.76)
    with pytest.raises(NoSuchMechanism, match=r"flank of tooth (13|19) of the driving gear \(phi1 = 3\.0"):
        toothed_pair(pitch, rack, TOLERANCE)


@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_flanks_cross_the_pitch_curve_twice_a_tooth(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        curve = gear.flanks.curve
        pitch = Polygon(curve.at_length(np.arange(20_000) * (curve.length_mm / 20_000)).position)
        shapely.prepare(pitch)
        inside = shapely.contains(pitch, shapely.points(gear.outline_mm))
        assert np.sum(inside != np.roll(inside, 1)) == 2 * gear.teeth


@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_least_radius_is_the_distance_from_the_axis(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        distance = Polygon(gear.outline_mm).exterior.distance(shapely.Point(0.0, 0.0))
        assert gear.least_radius_from_axis_mm == pytest.approx(distance, rel=1e-14)


def test_circular_gear_has_its_tip_and_root_circles() -> None:
    for gear in gears("uniform", 18):
        radius = np.hypot(*gear.outline_mm.T)
        assert (radius.max(), radius.min()) == pytest.approx((20.0, 15.5), rel=1e-13)


@pytest.mark.parametrize(("name", "teeth"), [("uniform", 18), ("sine", 25), ("baler", 25)])
def test_area_converges_linearly_with_the_tolerance(name: str, teeth: int) -> None:
    """Second order in the chord's length, which is the tolerance's square root."""
    tolerances = 0.01 * 0.25 ** np.arange(5)
    exact = [Polygon(gear.outline_mm).area for gear in gears(name, teeth, 2.0, 2e-7)]
    for number, area in enumerate(exact):
        errors = [abs(Polygon(gears(name, teeth, 2.0, t)[number].outline_mm).area - area) for t in tolerances]
        # Flanks lose and fillets gain area, and counts are whole numbers: the rate is 1 to a tenth.
        assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] == pytest.approx(1.0, abs=0.12)


# --- symmetry ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "teeth"), [("sine", 25), ("ellipse", 37), ("uniform", 18), ("3:1", 60)])
def test_even_law_gives_outlines_that_are_their_own_mirror_image(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        polygon = Polygon(gear.outline_mm)
        mirrored = affinity.scale(polygon, 1.0, -1.0, origin=(0.0, 0.0))
        assert polygon.symmetric_difference(mirrored).area < 1e-9 * polygon.area
        # The chords are placed from both ends alike, to rounding of their counts: points of one lie on the other.
        assert rack_cut.outline_distance(polygon, mirrored) < 1e-9


def test_uneven_law_does_not() -> None:
    """Negative control."""
    polygon = Polygon(gears("baler", 25)[0].outline_mm)
    assert rack_cut.outline_distance(polygon, affinity.scale(polygon, 1.0, -1.0, origin=(0.0, 0.0))) > 1.0


@pytest.mark.parametrize(("name", "teeth", "repeats"), [("3:1", 60, (3, 1)), ("1:2", 24, (1, 2)), ("sine", 24, (2, 2))])
def test_lobed_gear_comes_back_to_itself_when_turned(name: str, teeth: int, repeats: tuple[int, int]) -> None:
    for gear, number in zip(gears(name, teeth), repeats, strict=True):
        polygon = Polygon(gear.outline_mm)
        turned = affinity.rotate(polygon, 2.0 * pi / number, origin=(0.0, 0.0), use_radians=True)
        assert rack_cut.outline_distance(polygon, turned) < 1e-9


@pytest.mark.parametrize("module", [0.3, 20.0])
def test_outlines_scale_with_the_module(module: float) -> None:
    unit, scaled = gears("baler", 25, 1.0, 0.0025), gears("baler", 25, module, 0.0025 * module)
    for one, other in zip(unit, scaled, strict=True):
        polygon, expected = Polygon(other.outline_mm / module), Polygon(one.outline_mm)
        assert other.undercut == one.undercut
        assert rack_cut.outline_distance(polygon, expected) < 1e-9


# --- hard gears --------------------------------------------------------------------------------------------------


def judged(name: str, teeth: int, module: float, tolerance: float) -> meshing.MeshingReport:
    """Overlap and gap of the outlines at 401 positions of a turn, by shapely."""
    pitch, pair = made(name, teeth, module, tolerance)
    phi1 = np.linspace(0.0, 2.0 * pi * pitch.driving.periods / min(pitch.driving.periods, pitch.driven.periods), 402)
    outlines = Polygon(pair.driving.outline_mm), Polygon(pair.driven.outline_mm)
    phi2 = pitch.transmission.driven_angle(phi1).value
    return meshing.Pair(*outlines, phi1, phi2, pitch.center_distance_mm).report(401)


@pytest.mark.parametrize(
    ("name", "teeth", "module"),
    [
        ("baler", 25, 3.0),
        ("baler", 86, 2.3),
        ("baler", 200, 1.0),
        ("sharp ellipse", 60, 2.0),
        ("1:2", 25, 2.0),
        ("3:1", 60, 2.0),
        ("uniform", 18, 2.0),
    ],
)
def test_hard_pairs_mesh_as_the_judge_sees_them(name: str, teeth: int, module: float) -> None:
    for gear in gears(name, teeth, module, TOLERANCE):
        assert Polygon(gear.outline_mm).is_valid
    report = judged(name, teeth, module, TOLERANCE)
    # Each outline is off by a tolerance at most: concave flanks stand proud by it, convex ones leave a gap.
    assert report.overlap_depth.max() <= 2.0 * TOLERANCE
    assert report.gap.max() <= 2.0 * TOLERANCE


@pytest.mark.parametrize("module", [0.3, 20.0])
def test_small_and_large_modules_mesh(module: float) -> None:
    tolerance = module / 400.0
    report = judged("baler", 25, module, tolerance)
    assert max(report.overlap_depth.max(), report.gap.max()) <= 2.0 * tolerance


def test_wrong_centre_distance_is_seen_by_the_judge() -> None:
    """Negative control: a tenth of a millimetre nearer overlaps by 2 x 0.1 sin(20 deg) across the two flanks' sides."""
    pitch, pair = made("sine", 25)
    phi1 = np.linspace(0.0, 2.0 * pi, 98)
    outlines = Polygon(pair.driving.outline_mm), Polygon(pair.driven.outline_mm)
    phi2 = pitch.transmission.driven_angle(phi1).value
    near = meshing.Pair(*outlines, phi1, phi2, pitch.center_distance_mm - 0.1).report(97)
    assert near.overlap_depth.min() > 0.5 * 0.1 * sin(radians(20.0)) * cos(radians(20.0))
    assert near.overlap_depth.max() > 2.0 * TOLERANCE


@pytest.mark.parametrize(("name", "teeth"), [("baler", 6), ("3:1", 6), ("3:1", 9)])
def test_too_few_teeth_are_refused_with_gear_and_angle(name: str, teeth: int) -> None:
    with pytest.raises(
        NoSuchMechanism, match=r"the (driving|driven) pitch curve's radius.* at\s*phi1 = .* rad"
    ) as caught:
        gears(name, teeth)
    assert caught.value.key == "gears.teeth"


MANY_SIZES = [
    *(("ellipse", teeth) for teeth in (19, 28, 60, 150)),
    *(("sharp ellipse", teeth) for teeth in (30, 46, 100)),
    *(("sine", teeth) for teeth in (22, 31, 100)),
    *(("baler", teeth) for teeth in (36, 50, 60, 100, 150)),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), MANY_SIZES)
def test_outlines_of_many_sizes_mesh(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        assert Polygon(gear.outline_mm).is_valid
        assert max(distances(dense_sides(gear, kind), gear).max() for kind in (FLANK, FILLET)) <= TOLERANCE
    report = judged(name, teeth, 2.0, TOLERANCE)
    assert max(report.overlap_depth.max(), report.gap.max()) <= 2.0 * TOLERANCE


@pytest.mark.slow
@pytest.mark.parametrize("teeth", range(6, 41))
@pytest.mark.parametrize("name", ["uniform", "sharp ellipse", "sine", "baler"])
def test_few_teeth_are_made_whole_or_refused_by_name(name: str, teeth: int) -> None:
    if name == "baler" and teeth <= 12:  # the radius of curvature is then less than the dedendum
        with pytest.raises(NoSuchMechanism, match="phi1 = "):
            gears(name, teeth)
        return
    for gear in gears(name, teeth):
        assert Polygon(gear.outline_mm).is_valid
        assert np.linalg.norm(steps(gear.outline_mm), axis=1).min() > 1e-9
