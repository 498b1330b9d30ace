"""Outlines as polygons: chord error, orientation, convergence, symmetry, scale, and where teeth stand."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import atan, pi

import numpy as np
import pytest
import shapely
from shapely import Polygon, affinity

from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import FILLET, FLANK
from ncgear.teeth.form import Cutter, CutterKind, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair
from oracles import rack_cut
from pairs import baler_law, rack, sine_law
from plane import steps, turns
from test_laws import spline_of

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
    "spline": lambda: spline_of(60),
    "undercut": lambda: uniform_law(Lobes()),
    "undercut ellipse": lambda: elliptical_law(0.7, 0.0, Lobes()),
    "pinion": lambda: sine_law(0.2),
}


def pitch_pair(name: str, teeth: int, module: float) -> PitchPair:
    """Pitch curves of a law for so many driving teeth."""
    law = LAWS[name]()
    return sized_pair(law, teeth, module, None)


@cache
def made(name: str, teeth: int, module: float = 2.0, tolerance: float = TOLERANCE) -> tuple[PitchPair, ToothedPair]:
    """A pair with ISO 53 A teeth, cut as the name says, with one tolerance everywhere."""
    pitch = pitch_pair(name, teeth, module)
    cutter = Cutter(CutterKind.PINION, 20) if name == "pinion" else Cutter()
    limits = TipLimits(0.2 * module, avoid_undercut="undercut" not in name)
    wanted = ToothForm(rack(module=module), cutter=cutter, limits=limits)
    return pitch, toothed_pair(pitch, wanted, tolerance, flank_tolerance_mm=tolerance)


def gears(name: str, teeth: int, module: float = 2.0, tolerance: float = TOLERANCE) -> tuple[ToothedGear, ToothedGear]:
    """Both gears of a pair."""
    pair = made(name, teeth, module, tolerance)[1]
    return pair.driving, pair.driven


CASES = [
    ("undercut", 12),
    ("undercut ellipse", 13),
    ("sine", 25),
    ("3:1", 48),
    ("baler", 25),
    ("spline", 25),
    ("pinion", 40),
    *(
        pytest.param(name, teeth, marks=pytest.mark.slow)
        for name, teeth in (
            ("uniform", 18),
            ("ellipse", 37),
            ("sharp ellipse", 25),
            ("1:2", 25),
            ("undercut ellipse", 25),
        )
    ),
]


# --- chords ------------------------------------------------------------------------------------------------------


def dense_sides(gear: ToothedGear, kind: int) -> Array:
    """Dense points on what is left of all curves of a kind, shape (runs, DENSE, 2)."""
    own, sides = gear.flanks, gear.sides
    chosen = sides.kind == kind
    start, end = sides.start[chosen][:, None], sides.end[chosen][:, None]
    curve = {FLANK: own.flank, FILLET: own.fillet}[kind]
    return curve(sides.owner[chosen][:, None], start + (end - start) * np.linspace(0.0, 1.0, DENSE))[0]


def at_joints(sigma: Array, joints: Array) -> Array:
    """Arc lengths, shape (z, n), the nearest to each joint put on it: a sloping land has a corner there."""
    for joint in joints:
        rows = np.nonzero((sigma[:, 0] < joint) & (joint < sigma[:, -1]))[0]
        sigma[rows, np.argmin(np.abs(sigma[rows] - joint), axis=1)] = joint
    return sigma


def dense_lands(gear: ToothedGear) -> list[Array]:
    """Dense points on tip lands and root lands, the one across the seam included, shape (z, DENSE, 2) each.

    A tip land's height over the pitch curve changes evenly along it.
    """
    own, sides = gear.flanks, gear.sides
    share = np.linspace(0.0, 1.0, DENSE)
    start, end = sides.tip_mm[0::2], sides.tip_mm[1::2]
    heights = own.tip_height_mm.reshape(-1, 2)
    sigma = at_joints(start[:, None] + (end - start)[:, None] * share, own.curve.joints_around_mm)
    rise = np.diff(heights, axis=1)[:, 0] / (end - start)
    tips = own.offset(sigma, heights[:, :1] + rise[:, None] * (sigma - start[:, None]))[0]
    start, end = sides.roots.lands()
    sigma = start[:, None] + (end - start)[:, None] * share
    return [tips, sides.roots.land(np.arange(gear.teeth)[:, None], sigma)[0]]


def distances(points: Array, gear: ToothedGear) -> Array:
    """Of points to the outline, in their shape."""
    flat = shapely.points(points.reshape(-1, 2))
    return rack_cut.deviation_of_points(flat, Polygon(gear.outline_mm)).reshape(points.shape[:-1])


@pytest.mark.tiers(slow=["undercut-12", "sine-25", "baler-25", "pinion-40", "ellipse-37", "1:2-25"], rest="long")
@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_no_exact_curve_is_farther_from_the_outline_than_the_tolerance(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        for kind in (FLANK, FILLET):
            points = dense_sides(gear, kind)
            assert not points.size or distances(points, gear).max() <= TOLERANCE
        assert max(distances(points, gear).max() for points in dense_lands(gear)) <= TOLERANCE


@pytest.mark.tiers(slow=["undercut ellipse-13", "3:1-48", "pinion-40", "ellipse-37", "1:2-25"], rest="long")
@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_vertices_are_on_the_exact_curves_but_for_hollow_ones(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        flanks, fillets = (dense_sides(gear, kind) for kind in (FLANK, FILLET))
        hollow = [*fillets, *(flanks if gear.flanks.curve.curvature_bounds[0] < 0.0 else ())]
        points = shapely.points(gear.outline_mm)
        astray = distance_to([*flanks, *fillets, *(line for land in dense_lands(gear) for line in land)], points)
        assert astray.max() <= TOLERANCE
        # The dense points' own chords: 400 to a curve of 20 chords or less, (1/20)^2 of the tolerance, twice over.
        elsewhere = distance_to(hollow, points) > TOLERANCE
        assert np.all(astray[elsewhere] < TOLERANCE / 200.0)


def distance_to(lines: list[Array], points: Array) -> Array:
    """Of shapely's points to lines, shape (n,)."""
    exact = shapely.MultiLineString(lines)
    shapely.prepare(exact)
    distance: Array = shapely.distance(exact, points)
    return distance


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), [("3:1", 48), ("baler", 25), ("undercut", 12)])
def test_chords_of_flanks_stay_within_the_material_where_the_mate_comes_near(name: str, teeth: int) -> None:
    """Points of the exact curves are on the outline or outside it; a rack's fillets are hollow and no mate is near."""
    for gear in gears(name, teeth):
        mated = isinstance(gear.flanks.tool, PitchCurve)
        sides = [dense_sides(gear, kind).reshape(-1, 2) for kind in (FLANK, FILLET)[: 1 + mated]]
        points, polygon = shapely.points(np.concatenate(sides)), Polygon(gear.outline_mm)
        shapely.prepare(polygon)
        inside = shapely.contains(polygon, points)
        assert shapely.distance(polygon.exterior, points[inside]).max(initial=0.0) <= TOLERANCE / 20.0
    # The negative control: fillets of a rack stand out by the tolerance.
    deep = dense_sides(gears("undercut", 12)[0], FILLET)
    assert distances(deep, gears("undercut", 12)[0]).max() > TOLERANCE / 3.0


@pytest.mark.tiers(
    thorough=["*-undercut-12"],
    slow=[
        "0.02-undercut ellipse-13",
        "0.02-3:1-48",
        "0.02-spline-25",
        "0.02-uniform-18",
        "0.02-sharp ellipse-25",
        "0.02-undercut ellipse-25",
        "0.001-sine-25",
        "0.001-baler-25",
        "0.001-pinion-40",
        "0.001-ellipse-37",
        "0.001-1:2-25",
    ],
    rest="long",
)
@pytest.mark.parametrize(("name", "teeth"), CASES)
@pytest.mark.parametrize("tolerance", [0.02, 0.001])
def test_flanks_use_the_tolerance(name: str, teeth: int, tolerance: float) -> None:
    """Chord counts are whole numbers: the worst of many flanks uses a good share, if not every one does."""
    for gear in gears(name, teeth, 2.0, tolerance):
        worst = distances(dense_sides(gear, FLANK), gear).max()
        assert tolerance / 3.0 <= worst <= tolerance


# --- the polygon -------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), CASES)
def test_outline_is_a_simple_counter_clockwise_polygon(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        polygon = Polygon(gear.outline_mm)
        assert polygon.is_valid
        assert polygon.exterior.is_ccw
        assert polygon.contains(shapely.Point(0.0, 0.0))
        assert np.linalg.norm(steps(gear.outline_mm), axis=1).min() > 1e-9
        assert turns(gear.outline_mm).sum() == pytest.approx(2.0 * pi, abs=1e-9)


@pytest.mark.tiers(quick=["undercut-1*", "sine-25-*"], rest="slow")
@pytest.mark.parametrize("tolerance", [TOLERANCE, TOLERANCE / 10.0])
@pytest.mark.parametrize(
    ("name", "teeth"),
    [*CASES, ("undercut", 16), *(("baler", z) for z in (23, 38, 48))],
)
def test_outline_never_turns_back(name: str, teeth: int, tolerance: float) -> None:
    """A tip turns by 90 degrees less the pressure angle there, and by as much more as its land may slope.

    Slightly undercut teeth and jumps of the curvature make loops of micrometres, which must be cut off as well.
    """
    for gear in gears(name, teeth, tolerance=tolerance):
        assert np.abs(turns(gear.outline_mm)).max() < pi / 2.0 + atan(0.25)


@pytest.mark.slow
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


def test_circular_gear_has_its_tip_and_root_circles() -> None:
    for gear in gears("uniform", 18):
        radius = np.hypot(*gear.outline_mm.T)
        assert (radius.max(), radius.min()) == pytest.approx((20.0, 15.5), rel=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), [("uniform", 18), ("sine", 25), ("baler", 25)])
def test_area_converges_linearly_with_the_tolerance(name: str, teeth: int) -> None:
    """Second order in the chord's length, which is the tolerance's square root; the reference is 31 times finer."""
    tolerances = 0.01 * 0.25 ** np.arange(5)
    exact = [Polygon(gear.outline_mm).area for gear in gears(name, teeth, 2.0, 1.25e-6)]
    for number, area in enumerate(exact):
        errors = [abs(Polygon(gears(name, teeth, 2.0, t)[number].outline_mm).area - area) for t in tolerances]
        # Flanks lose and fillets gain area, and counts are whole numbers: the rate is 1 to a tenth.
        assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] == pytest.approx(1.0, abs=0.12)


# --- symmetry ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), [("sine", 25), ("uniform", 18), ("3:1", 48)])
def test_even_law_gives_outlines_that_are_their_own_mirror_image(name: str, teeth: int) -> None:
    for gear in gears(name, teeth):
        polygon = Polygon(gear.outline_mm)
        mirrored = affinity.scale(polygon, 1.0, -1.0, origin=(0.0, 0.0))
        assert polygon.symmetric_difference(mirrored).area < 1e-9 * polygon.area
        # The chords are placed from both ends alike, to rounding of their counts: points of one lie on the other.
        assert rack_cut.outline_distance(polygon, mirrored) < 1e-9


@pytest.mark.slow
def test_uneven_law_does_not() -> None:
    """Negative control."""
    polygon = Polygon(gears("baler", 25)[0].outline_mm)
    assert rack_cut.outline_distance(polygon, affinity.scale(polygon, 1.0, -1.0, origin=(0.0, 0.0))) > 1.0


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth", "repeats"), [("3:1", 48, (3, 1)), ("1:2", 24, (1, 2)), ("sine", 24, (2, 2))])
def test_lobed_gear_comes_back_to_itself_when_turned(name: str, teeth: int, repeats: tuple[int, int]) -> None:
    for gear, number in zip(gears(name, teeth), repeats, strict=True):
        polygon = Polygon(gear.outline_mm)
        turned = affinity.rotate(polygon, 2.0 * pi / number, origin=(0.0, 0.0), use_radians=True)
        assert rack_cut.outline_distance(polygon, turned) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("module", [0.3, 20.0])
def test_outlines_scale_with_the_module(module: float) -> None:
    unit, scaled = gears("baler", 25, 1.0, 0.0025), gears("baler", 25, module, 0.0025 * module)
    for one, other in zip(unit, scaled, strict=True):
        polygon, expected = Polygon(other.outline_mm / module), Polygon(one.outline_mm)
        assert other.undercut == one.undercut
        assert rack_cut.outline_distance(polygon, expected) < 1e-9


# --- where teeth stand -------------------------------------------------------------------------------------------


def turned(polygon: Polygon, angle: float) -> Polygon:
    return affinity.rotate(polygon, angle, origin=(0.0, 0.0), use_radians=True)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), [("baler", 25), ("1:2", 24)])
def test_teeth_advanced_by_a_pitch_make_the_same_gears(name: str, teeth: int) -> None:
    """Tooth i has then gone where tooth i + 1 stood; by half a pitch, teeth stand where spaces were."""
    pitch, wanted = pitch_pair(name, teeth, 2.0), ToothForm(rack(), limits=TipLimits(0.4))
    plain, whole, half = (
        toothed_pair(pitch, wanted, TOLERANCE, advance_mm=share * pi * 2.0) for share in (0.0, 1.0, 0.5)
    )
    for gear in ("driving", "driven"):
        outlines = [Polygon(getattr(pair, gear).outline_mm) for pair in (plain, whole, half)]
        assert rack_cut.outline_distance(outlines[0], outlines[1]) < 1e-8
        assert rack_cut.outline_distance(outlines[0], outlines[2]) > 1.0
        tips = [getattr(pair, gear).tips for pair in (plain, whole)]
        assert np.roll(tips[0].height_mm, -2) == pytest.approx(tips[1].height_mm, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.2, 0.9])
def test_a_circular_gear_is_the_same_wherever_its_teeth_begin(share: float) -> None:
    """Turned back by the advance; the seam at phi1 = 0 is then somewhere else on the teeth."""
    pitch, wanted = pitch_pair("uniform", 18, 2.0), ToothForm(rack())
    plain, moved = (toothed_pair(pitch, wanted, TOLERANCE, advance_mm=share * t * pi * 2.0) for t in (0.0, 1.0))
    angle = share * 2.0 * pi / 18
    for gear, sense in (("driving", 1.0), ("driven", -1.0)):
        outlines = [Polygon(getattr(pair, gear).outline_mm) for pair in (plain, moved)]
        assert rack_cut.outline_distance(outlines[0], turned(outlines[1], sense * angle)) < 1e-9


@pytest.mark.slow
def test_an_ellipse_begun_half_a_cycle_later_is_the_same_gear_turned() -> None:
    """A law that starts elsewhere in its cycle puts the seam elsewhere: the same gears, turned, and no trace of it."""
    wanted = ToothForm(rack(), limits=TipLimits(0.4))
    pairs = [
        toothed_pair(sized_pair(elliptical_law(0.35, phase, Lobes()), 36, 2.0, None), wanted, TOLERANCE)
        for phase in (0.0, pi)
    ]
    for gear, other in (("driving", pi), ("driven", pi)):
        outlines = [Polygon(getattr(pair, gear).outline_mm) for pair in pairs]
        assert rack_cut.outline_distance(outlines[0], turned(outlines[1], other)) < 1e-8
