"""Cutters: outlines against brute-force cutting by rack and pinion, and which cutters are chosen and refused."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import pi, radians, sin

import numpy as np
import pytest
import shapely
from shapely import Polygon, affinity

from ncgear.errors import NoSuchMechanism
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.form import Backlash, BasicRack, Cutter, CutterKind, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedGear, ToothedPair, toothed_pair
from ncgear.teeth.tool import PinionCircle, most_teeth
from oracles import meshing, rack_cut
from pairs import baler_law, one_of, rack, sine_law

MODULE = 2.0
TOLERANCE = 2e-4
CUTTER_FACETS = 2.5e-4
"""Sagitta of the 24 chords that draw the oracle's rounding of 0.76 mm over 70 degrees, material it leaves standing."""
SCALLOPS = 1e-4
"""At 100 positions a pitch: halving the step moves the outlines below by 2e-5 to 6e-5 mm."""

Array = np.ndarray

LAWS: dict[str, tuple[Callable[[], Transmission], int]] = {
    "circle of 6": (lambda: uniform_law(Lobes()), 6),
    "circle of 12": (lambda: uniform_law(Lobes()), 12),
    "circle of 18": (lambda: uniform_law(Lobes()), 18),
    "ellipse": (lambda: elliptical_law(0.35, 0.0, Lobes()), 37),
    "undercut ellipse": (lambda: elliptical_law(0.7, 0.0, Lobes()), 25),
    "sine": (lambda: sine_law(0.08), 25),
    "1:2": (lambda: elliptical_law(0.2, 0.3, Lobes(1, 2)), 25),
    "concave": (lambda: sine_law(0.2), 60),
    "hardly concave": (lambda: sine_law(0.16), 60),
    "baler": (baler_law, 86),
}


@cache
def pitch_pair(name: str, teeth: int | None = None) -> PitchPair:
    """The pitch curves of one of the laws."""
    return sized_pair(LAWS[name][0](), teeth or LAWS[name][1], MODULE, None)


def form(
    kind: CutterKind, teeth: int | None = None, basic: BasicRack | None = None, *, avoid: bool = False
) -> ToothForm:
    return ToothForm(basic or rack(), cutter=Cutter(kind, teeth), limits=TipLimits(avoid_undercut=avoid))


@cache
def made(name: str, wanted: ToothForm, tolerance: float = TOLERANCE) -> ToothedPair:
    """A pair of gears."""
    return toothed_pair(pitch_pair(name), wanted, tolerance)


# --- brute force -------------------------------------------------------------------------------------------------


def brute(
    gear: ToothedGear, positions: int = 100, window: float = 2.0, cutter: rack_cut.Cutter | None = None
) -> Polygon:
    """The same gear cut by the oracle, from samples of its pitch curve whose arc length starts at a tooth's middle."""
    own, curve, basic = gear.flanks, gear.flanks.curve, gear.flanks.rack
    middle = own.crossing_mm[:2].mean()
    sigma = np.arange(4000) * (curve.length_mm / 4000)
    at = curve.at_angle(curve.driving_angle(sigma + middle))
    sampled = rack_cut.PitchCurve(at.position, at.tangent, at.normal, sigma, curve.length_mm)
    tooth = rack_cut.Proportions(
        basic.module_mm,
        basic.pressure_angle_rad,
        basic.tip_height_mm,
        basic.root_depth_mm,
        float(own.root_radius_mm[0]),
        basic.pitch_mm / 2.0 - float(own.crossing_mm[1] - own.crossing_mm[0]),
    )
    return rack_cut.cut(sampled, tooth, gear.teeth, True, cutter, positions, window)


def apart(gear: ToothedGear, cut: Polygon, step: float = 0.02, deepest: float = np.inf) -> float:
    """Largest distance of the two boundaries, to and fro, below the lowest tip and its land's sagitta.

    Nothing deeper below the pitch curve than ``deepest`` is looked at.
    """
    own = gear.flanks
    sigma = np.linspace(0.0, own.curve.length_mm, 20_001)[:-1]
    below = Polygon(own.offset(sigma, own.tip_height_mm.min() - 0.05)[0])
    if np.isfinite(deepest):
        below = below.difference(Polygon(own.offset(sigma, -deepest)[0]))
    shapely.prepare(below)

    def farthest(one: Polygon, other: Polygon) -> float:
        points = shapely.points(shapely.get_coordinates(shapely.segmentize(one.exterior, step)))
        return float(rack_cut.deviation_of_points(points[shapely.contains(below, points)], other).max())

    outline = Polygon(gear.outline_mm)
    return max(farthest(outline, cut), farthest(cut, outline))


RACK_CUT = [
    *("circle of 12", "undercut ellipse", "sine"),
    *(pytest.param(name, marks=pytest.mark.slow) for name in ("circle of 6", "circle of 18", "ellipse", "1:2")),
]


@pytest.mark.judges("teeth")
@pytest.mark.tiers(
    slow=[
        "*DRIVEN-circle of 12",
        "Gear.DRIVING-undercut ellipse",
        "Gear.DRIVING-circle of 18",
        "Gear.DRIVEN-sine",
        "Gear.DRIVEN-ellipse",
    ],
    rest="long",
)
@pytest.mark.parametrize("name", RACK_CUT)
@pytest.mark.parametrize("gear", Gear)
def test_outline_on_a_convex_curve_is_what_a_rack_cuts(name: str, gear: Gear) -> None:
    own = one_of(made(name, form(CutterKind.RACK)), gear)
    # No tip is shortened here, so the whole outline agrees.
    assert rack_cut.outline_distance(Polygon(own.outline_mm), brute(own), 0.02) < TOLERANCE + CUTTER_FACETS + SCALLOPS


@pytest.mark.tiers(slow=["0.1-0.6-Gear.DRIVING", "0.1--0.4-Gear.DRIVING"], rest="long")
@pytest.mark.parametrize("gear", Gear)
@pytest.mark.parametrize(("backlash_mm", "shift_mm"), [(0.1, 0.6), (0.1, -0.4)])
def test_backlash_and_profile_shift_move_what_a_rack_cuts(gear: Gear, backlash_mm: float, shift_mm: float) -> None:
    wanted = ToothForm(
        rack(), shift_mm, -shift_mm, limits=TipLimits(avoid_undercut=False), backlash=Backlash(backlash_mm)
    )
    own = one_of(made("sine", wanted), gear)
    cut, deepest = brute(own), np.inf
    if gear is Gear.DRIVEN:
        # A second pass, with the gear turned by the play; between both the bottoms of spaces are swept.
        turn = float(np.ptp(own.flanks.turn_rad))
        cut, deepest = (
            cut.intersection(affinity.rotate(cut, turn, (0.0, 0.0), use_radians=True)),
            0.9 * own.flanks.flank_depth_mm.min(),
        )
    assert apart(own, cut, deepest=deepest) < TOLERANCE + CUTTER_FACETS + SCALLOPS


@pytest.mark.tiers(slow=["wrong0", "wrong2"], rest="long")
@pytest.mark.parametrize("wrong", [{"angle_deg": 20.1}, {"root_radius": 0.37}, {"dedendum": 1.251}])
def test_brute_force_tells_slightly_other_racks_apart(wrong: dict[str, float]) -> None:
    """Negative controls: each changes the outline by more than the tolerance of the tests above."""
    gears = [made("ellipse", form(CutterKind.RACK, basic=basic)).driving for basic in (rack(), rack(**wrong))]
    assert apart(gears[0], brute(gears[1], 50), 0.05) > 1e-3


@pytest.mark.tiers(slow=["sine-Gear.DRIVING"], rest="long")
@pytest.mark.parametrize("gear", Gear)
@pytest.mark.parametrize(
    "name",
    [
        "circle of 18",
        "concave",
        *(pytest.param(n, marks=pytest.mark.slow) for n in ("ellipse", "sine", "1:2", "hardly concave")),
    ],
)
def test_outline_is_what_a_pinion_cutter_leaves(name: str, gear: Gear) -> None:
    own = one_of(made(name, form(CutterKind.PINION, 20)), gear)
    # At half the positions scallops are four times as high.
    assert apart(own, brute(own, 50, 2.0, rack_cut.Pinion(20))) < TOLERANCE + CUTTER_FACETS + 4.0 * SCALLOPS


@pytest.mark.tiers(slow=["ellipse-7", "sine-7"], rest="long")
@pytest.mark.parametrize("teeth", [*range(7, 26), 30])
@pytest.mark.parametrize("name", ["circle", "ellipse", "sharp ellipse", "sine"])
def test_few_teeth_are_what_a_rack_cuts(name: str, teeth: int) -> None:
    """From deep undercut to none, on curves whose teeth are undercut a little, much and not at all."""
    laws = {
        "circle": uniform_law(Lobes()),
        "ellipse": elliptical_law(0.35, 0.3, Lobes()),
        "sharp ellipse": elliptical_law(0.7, 0.3, Lobes()),
        "sine": sine_law(0.08),
    }
    tolerance = 0.002
    pair = toothed_pair(sized_pair(laws[name], teeth, MODULE, None), form(CutterKind.RACK), tolerance)
    for own in (pair.driving, pair.driven):
        assert Polygon(own.outline_mm).is_valid
        # At half the positions scallops are four times as high.
        assert apart(own, brute(own, 50), 0.05) < tolerance + CUTTER_FACETS + 4.0 * SCALLOPS


# --- the shaper, from closed forms ---------------------------------------------------------------------------------

SHAPED = {"sine": 0.08, "concave": 0.2}
"""Laws phi2 = phi1 - depth sin 2 phi1, of the driving gears of 25 and of 60 teeth: convex, and concave twice a turn."""

CORNER = 0.25
"""Root radius in modules that fits the tip of a cutter of 20 teeth; profile A's 0.38 is reduced to 0.33 there."""

LEFT_AT_LAST = 3e-4
"""What the oracle still leaves at infinitely many steps: chords of its rounded corners and blank, 1e-4 mm each."""


def polar_curve(depth: float, teeth: int) -> rack_cut.PitchCurve:
    """The driving pitch curve in polar form, r = a f / (1 + f) with f = phi2', at the angle -phi1; nothing of ncgear's.

    Its length, by Gauss's rule between the samples, sets the centre distance a.
    """

    def polar(phi: Array) -> tuple[Array, Array]:
        slope, bend = 1.0 - 2.0 * depth * np.cos(2.0 * phi), 4.0 * depth * np.sin(2.0 * phi)
        return slope / (1.0 + slope), bend / (1.0 + slope) ** 2

    phi, (nodes, weights) = np.linspace(0.0, 2.0 * pi, 4001), np.polynomial.legendre.leggauss(8)
    half = np.diff(phi) / 2.0
    speed = np.hypot(*polar(phi[:-1, None] + (1.0 + nodes) * half[:, None]))
    length = np.append(0.0, np.cumsum(speed @ weights * half))
    size = teeth * pi * MODULE / length[-1]
    (radius, rise), out = polar(phi[:-1]), np.stack([np.cos(phi[:-1]), -np.sin(phi[:-1])], axis=1)
    along = np.stack([-np.sin(phi[:-1]), -np.cos(phi[:-1])], axis=1)
    tangent = (rise[:, None] * out + radius[:, None] * along) / np.hypot(radius, rise)[:, None]
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    return rack_cut.PitchCurve(size * radius[:, None] * out, tangent, normal, size * length[:-1], size * length[-1])


def shaped_apart(name: str, cutter_teeth: int, root_radius: float, steps: tuple[int, ...]) -> list[float]:
    """Distances of ncgear's gear for a cutter of 20 teeth from what another cutter leaves in so many steps a pitch."""
    own = made(name, form(CutterKind.PINION, 20, rack(root_radius=CORNER)), 2e-5).driving
    basic, curve = rack(root_radius=root_radius), polar_curve(SHAPED[name], own.teeth)
    sizes = (MODULE, basic.pressure_angle_rad, basic.addendum_mm, basic.dedendum_mm, basic.root_radius_mm)
    tooth, cutter = rack_cut.Proportions(*sizes), rack_cut.Pinion(cutter_teeth)
    return [apart(own, rack_cut.cut(curve, tooth, own.teeth, True, cutter, step, 1.5), 0.05) for step in steps]


@pytest.mark.long
@pytest.mark.judges("teeth")
@pytest.mark.slow
@pytest.mark.parametrize("name", SHAPED)
def test_more_steps_of_a_shaper_come_nearer_to_the_outline_as_their_square(name: str) -> None:
    """12, 24 and 48 steps a pitch leave 9.8e-3, 2.9e-3 and 8e-4 mm: scallops, and nothing beside them."""
    coarse, middle, fine = shaped_apart(name, 20, CORNER, (12, 24, 48))
    assert 3.0 < (coarse - middle) / (middle - fine) < 5.0
    assert abs(fine - (middle - fine) / 3.0) < LEFT_AT_LAST


@pytest.mark.tiers(slow=["20-0.24-sine"], rest="long")
@pytest.mark.parametrize("name", SHAPED)
@pytest.mark.parametrize(("cutter_teeth", "root_radius"), [(19, CORNER), (21, CORNER), (20, 0.24), (20, 0.26)])
def test_brute_force_tells_slightly_other_shapers_apart(name: str, cutter_teeth: int, root_radius: float) -> None:
    """Negative controls: at 48 steps the right cutter leaves 8e-4 mm."""
    assert shaped_apart(name, cutter_teeth, root_radius, (48,))[0] > 1.5e-3


# --- which cutter ------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_rack_is_chosen_where_both_curves_are_convex_and_the_mate_where_one_is_not() -> None:
    for name, kind in (("sine", CutterKind.RACK), ("concave", CutterKind.MATE), ("baler", CutterKind.MATE)):
        assert made(name, ToothForm(rack()), 0.01).cutter is kind


def test_a_rack_is_refused_on_a_concave_curve_with_radius_and_angle() -> None:
    pitch = pitch_pair("concave")
    with pytest.raises(NoSuchMechanism, match="a rack does not go into the driving pitch curve") as caught:
        toothed_pair(pitch, form(CutterKind.RACK), 0.01)
    assert caught.value.key == "gears.cutter.kind"
    assert f"{pitch.least_concave_radius_mm(Gear.DRIVING):.4g} mm" in caught.value.problem
    assert "phi1 = " in caught.value.problem


@pytest.mark.slow
def test_a_straight_rack_would_gouge_the_hollow_flanks() -> None:
    """Why it is refused: brute force with a rack leaves a tenth of a millimetre less than the flanks need."""
    own = made("concave", form(CutterKind.PINION, 20)).driving
    assert apart(own, brute(own, 25), 0.05) > 0.05


@pytest.mark.thorough
def test_a_pinion_larger_than_a_concave_stretch_is_refused_and_a_smaller_one_is_not() -> None:
    pitch = pitch_pair("concave")
    radius = pitch.least_concave_radius_mm(Gear.DRIVING)
    assert radius is not None
    larger = 2 * int(2.0 * radius / MODULE)
    with pytest.raises(NoSuchMechanism, match=f"a pinion cutter of {larger} teeth") as caught:
        toothed_pair(pitch, form(CutterKind.PINION, larger), 0.01)
    assert caught.value.key == "gears.cutter.teeth"
    assert f"{radius:.4g} mm" in caught.value.problem
    toothed_pair(pitch, form(CutterKind.PINION, larger // 2 - 20), 0.01)


def ring_pair() -> PitchPair:
    """30 teeth in a ring of 60, hollow all around."""
    return sized_pair(uniform_law(Lobes(1, 2)), 30, MODULE, None, Mesh.INTERNAL)


def tip_inside_teeth(ring: ToothedGear, cutter_teeth: int) -> int:
    """How many places of the path of a cutter tooth's tip lie in the ring's teeth, by circles rolling in each other."""
    ring_radius, cutter_radius = ring.teeth * MODULE / 2.0, cutter_teeth * MODULE / 2.0
    middle = ring.flanks.curve.at_length(ring.flanks.crossing_mm[1:3].mean(keepdims=True)).position[0]
    start = np.arctan2(middle[1], middle[0])
    rolled = np.linspace(-0.4, 0.4, 4001) * 2.0 * pi * cutter_radius
    at_contact = start + rolled / ring_radius
    tooth = at_contact - rolled / cutter_radius
    center = (ring_radius - cutter_radius) * np.stack([np.cos(at_contact), np.sin(at_contact)], axis=1)
    tip = center + (cutter_radius + 1.25 * MODULE) * np.stack([np.cos(tooth), np.sin(tooth)], axis=1)
    tip = tip[np.hypot(*tip.T) > ring_radius - 0.9 * MODULE]
    own_space = np.abs(np.angle(np.exp(1j * (np.arctan2(tip[:, 1], tip[:, 0]) - start)))) < 0.15 * 2.0 * pi / ring.teeth
    free = shapely.contains(Polygon(ring.outline_mm), shapely.points(tip))
    return int(np.sum(~free & ~own_space))


@pytest.mark.slow
def test_a_pinion_of_57_teeth_does_foul_on_its_way_out_of_a_ring() -> None:
    """By the place of its tips in the finished ring, where one of 36 teeth gets out."""
    ring = toothed_pair(ring_pair(), form(CutterKind.PINION, 36), 0.001).driven
    assert tip_inside_teeth(ring, 36) == 0
    assert tip_inside_teeth(ring, 57) > 0


@pytest.mark.tiers(slow=["56", "58"], rest="long")
@pytest.mark.parametrize("teeth", [56, 57, 58])
def test_a_pinion_that_fouls_on_its_way_out_of_a_ring_is_refused(teeth: int) -> None:
    """The rule of internal gears: a difference of about ten teeth at 20 degrees."""
    with pytest.raises(NoSuchMechanism, match=r"cuts the \w+ flank of tooth \d+ of the driven gear") as caught:
        toothed_pair(ring_pair(), form(CutterKind.PINION, teeth), 0.01)
    assert caught.value.key == "gears.cutter.teeth"
    assert "phi1 = " in caught.value.problem


@pytest.mark.slow
def test_short_hollows_let_even_large_pinions_out() -> None:
    """A cutter of 65 teeth fits a hollow of 65.9 modules: it is a few teeth long, and brute force agrees."""
    own = made("concave", form(CutterKind.PINION, 65), 0.001).driving
    # At a quarter of the positions scallops are sixteen times as high.
    assert apart(own, brute(own, 25, 5.0, rack_cut.Pinion(65)), 0.05) < 0.001 + CUTTER_FACETS + 16.0 * SCALLOPS


@pytest.mark.slow
def test_chosen_pinion_goes_into_the_hollows_with_room_to_leave() -> None:
    for name, most in (("sine", 40), ("concave", 40), ("hardly concave", 40)):
        pitch = pitch_pair(name)
        assert most_teeth(pitch, rack()) == most
        pair = made(name, form(CutterKind.PINION), 0.005)
        tool = pair.driving.flanks.tool
        assert isinstance(tool, PinionCircle)
        assert (tool.teeth, tool.radius_mm) == (most, most * MODULE / 2.0)
    smaller = pitch_pair("concave", 40)
    radius = smaller.least_concave_radius_mm(Gear.DRIVING)
    assert radius is not None
    assert most_teeth(smaller, rack()) == int(2.0 * radius / MODULE) - 10


@pytest.mark.parametrize("teeth", [3, 4])
def test_pinions_of_few_teeth_are_pointed_and_refused_as_such(teeth: int) -> None:
    with pytest.raises(NoSuchMechanism, match=f"a pinion cutter of {teeth} teeth is pointed") as caught:
        toothed_pair(pitch_pair("sine"), form(CutterKind.PINION, teeth), 0.01)
    assert caught.value.key == "gears.cutter.teeth"


@pytest.mark.tiers(thorough=["1000-concave"], rest="slow")
@pytest.mark.parametrize("name", ["ellipse", "sine", "concave"])
@pytest.mark.parametrize("teeth", [20, 40, 1000])
def test_pairs_that_pinions_cut_mesh(name: str, teeth: int) -> None:
    pitch, tolerance = pitch_pair(name), 0.005
    if name == "concave" and teeth == 1000:
        with pytest.raises(NoSuchMechanism, match="does not go into"):
            made(name, form(CutterKind.PINION, teeth, avoid=True), tolerance)
        return
    pair = made(name, form(CutterKind.PINION, teeth, avoid=True), tolerance)
    phi1 = np.linspace(0.0, 2.0 * pi, 202)
    outlines = Polygon(pair.driving.outline_mm), Polygon(pair.driven.outline_mm)
    law = pitch.transmission.driven_angle(phi1).value
    report = meshing.Pair(*outlines, phi1, law, pitch.center_distance_mm).report(201)
    assert report.overlap_depth.max() <= 1.2 * tolerance
    assert report.gap.max() <= 2.0 * tolerance


@pytest.mark.slow
def test_a_pinion_of_very_many_teeth_is_a_rack() -> None:
    """Its rolling circle is straight to 1 / R: the fillets of 10 000 teeth lie within a ten-thousandth of a rack's."""
    pairs = [made("sine", form(kind, teeth)) for kind, teeth in ((CutterKind.RACK, None), (CutterKind.PINION, 10_000))]
    outlines = [Polygon(pair.driving.outline_mm) for pair in pairs]
    assert rack_cut.outline_distance(*outlines, 0.02) < 1e-3


# --- tools against each other ------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("gear", Gear)
def test_mated_spaces_contain_what_the_mates_tip_sweeps(gear: Gear) -> None:
    """The mate's tip land, carried through the space by the two rolling frames, stays clear of the root."""
    pair = made("baler", ToothForm(rack(), limits=TipLimits(0.2 * MODULE)), 0.001)
    own, mate = one_of(pair, gear), one_of(pair, next(other for other in Gear if other is not gear))
    outline = Polygon(own.outline_mm)
    shapely.prepare(outline)
    for tooth in (0, 17, 43, 61):
        edges, heights = (
            mate.tips.at_mm[2 * tooth : 2 * tooth + 2],
            mate.flanks.tip_height_mm[2 * tooth : 2 * tooth + 2],
        )
        # The land without its edges, which slide along the flanks.
        share = np.linspace(0.1, 0.9, 9)
        points = mate.flanks.offset(edges[0] + np.ptp(edges) * share, heights[0] + np.diff(heights) * share)[0]
        sigma = edges.mean() + np.linspace(-0.6, 0.6, 101) * mate.flanks.rack.pitch_mm
        at, there = mate.flanks.curve.at_length(sigma), own.flanks.curve.at_length(sigma)
        arm = points[:, None, :] - at.position
        along, outwards = np.sum(arm * at.tangent, axis=2), np.sum(arm * at.normal, axis=2)
        swept = there.position + along[..., None] * there.tangent - outwards[..., None] * there.normal
        assert not shapely.contains(outline, shapely.points(swept.reshape(-1, 2))).any()
        away = shapely.distance(outline.exterior, shapely.points(swept[4]))
        # The whole clearance where the tool's tooth is wide enough for the rounding that leaves it.
        assert 0.15 * MODULE < away.min() < 0.3 * MODULE


@pytest.mark.thorough
def test_a_mates_rounding_alone_leaves_the_clearance() -> None:
    """c = rho (1 - sin(alpha)) with a straight flank, whatever root radius is asked for below that."""
    pairs = [made("sine", form(CutterKind.MATE, basic=rack(root_radius=asked)), 0.01) for asked in (0.0, 0.2, 0.38)]
    largest = 0.25 * MODULE / (1.0 - sin(radians(20.0)))
    for own in (pair.driving.flanks for pair in pairs):
        assert own.root_radius_mm.max() == pytest.approx(max(largest, own.rack.root_radius_mm), rel=1e-9)
        assert own.root_radius_mm == pytest.approx(pairs[0].driving.flanks.root_radius_mm, rel=2e-4)
        assert own.root_depth_mm.min() > own.rack.addendum_mm + 0.15 * MODULE
