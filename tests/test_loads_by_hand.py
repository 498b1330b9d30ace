"""Loads of round gears without teeth by textbook geometry, and planets on their carriers by plane turning."""

from __future__ import annotations

from dataclasses import replace
from math import acos, atan, cos, hypot, pi, sin, sqrt, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from shapely import Point, Polygon

import ncgear.strength.without_teeth as without_teeth
from at_once import at_once
from ncgear.errors import NoSuchMechanism
from ncgear.pitch.shape import Gear, Mesh
from ncgear.strength.holding import Damage
from ncgear.strength.iso6336 import RackTip, root_factors, root_section, single_stiffness_theoretical
from ncgear.strength.without_teeth import PER_TOOTH, RolledLoad, SharedLoad, ToothPlan
from ncgear.trains.planetary import GAP_MM, Arm, ArmChain, Bodies, GearOfChain, Stand, compound_chain, planetary_train
from ncgear.trains.train import GROUND, mirrored

Made: Any = SimpleNamespace

ANGLE, MODULE, TEETH = pi / 9.0, 2.0, (20, 40)
RADII = tuple(MODULE * teeth / 2.0 for teeth in TEETH)
BASE_PITCH = pi * MODULE * cos(ANGLE)
RACK = RackTip(1.25, 0.38)
STEEL: Any = Made(youngs_modulus_mpa=without_teeth.STEEL_MPA)


def path_mm(gear: int) -> float:
    """From the pitch point to where the tip circle of a gear, a module over its pitch circle, crosses the action."""
    radius = RADII[gear]
    return sqrt((radius + MODULE) ** 2 - (radius * cos(ANGLE)) ** 2) - radius * sin(ANGLE)


def shared(force_n: float, urge: float, **others: Any) -> SharedLoad:
    """Gears of 20 and 40 teeth of 2 mm under an even force, 10 mm wide, over two pitches."""
    count = 2 * PER_TOOTH
    curvature = np.stack([np.full(count, 1.0 / radius) for radius in RADII])
    load = RolledLoad(
        np.arange(count) / 10.0, np.full(count, force_n), np.full(count, urge), curvature, np.full(count, 3.0), True
    )
    plan = ToothPlan(RACK, 1.0, (0.0, 0.0), (ANGLE, ANGLE), None, **others)
    running: Any = Made(module_mm=MODULE, face_width_mm=10.0)
    (found,) = without_teeth.shared_loads(load, plan, running, (STEEL, STEEL))
    return found


@pytest.mark.judges("strength")
@pytest.mark.parametrize("urge", [1.0, -1.0])
def test_round_gears_share_a_light_load_as_springs_along_their_path(urge: float) -> None:
    """Flanks cross the pitch circles a quarter of a pitch beside their teeth; springs soften as a cosine (Pedrero)."""
    found = shared(1.0, urge)
    ends = -path_mm(1), path_mm(0)
    ratio = (ends[1] - ends[0]) / BASE_PITCH
    assert found.bearing.mean() == pytest.approx(ratio, abs=1.5 / PER_TOOTH)
    assert found.line_n_mm.sum(axis=0) == pytest.approx(np.full(2 * PER_TOOTH, 0.1))
    softening = 1.0 / sqrt((1.0 + ratio / 2.0) ** 2 / 2.0 - 1.0)
    stiffest = 1e3 * single_stiffness_theoretical(np.array(TEETH), (0.0, 0.0))
    for row in range(0, 2 * PER_TOOTH, 5):
        first = (urge * row + PER_TOOTH / 4.0) / PER_TOOTH % 1.0
        wanted = [one for one in BASE_PITCH * (first + np.arange(-4.0, 4.0)) if ends[0] < one < ends[1]]
        bearing = found.line_n_mm[:, row] > 0.0
        order = np.argsort(found.place_mm[bearing, row])
        places, lines = found.place_mm[bearing, row][order], found.line_n_mm[bearing, row][order]
        assert places == pytest.approx(wanted)
        springs = stiffest * np.cos(softening * np.abs(places - sum(ends) / 2.0) / BASE_PITCH)
        assert lines == pytest.approx(0.1 * springs / springs.sum())
        assert found.way_mm[row] == pytest.approx(0.1 / springs.sum())
        curved = 1.0 / (RADII[0] * sin(ANGLE) + places) + 1.0 / (RADII[1] * sin(ANGLE) - places)
        assert found.relative_curvature[bearing, row][order] == pytest.approx(curved)
    assert found.root_teeth[0] == pytest.approx(20.0)
    assert found.root_teeth[1] == pytest.approx(40.0)


def parted_mm(gear: int, beyond_mm: float) -> float:
    """How far the tip of a gear is from the mate's involute, past the end of the path: involutes of one base circle.

    The pitch point is the origin, and the line of action leads towards the driving gear's tip.
    """
    radius, mate = RADII[gear], RADII[1 - gear]
    tip = path_mm(gear) * np.exp(1j * (pi / 2.0 - ANGLE)) + radius
    tip = tip * np.exp(1j * beyond_mm / (radius * cos(ANGLE))) - radius
    base = mate * cos(ANGLE)
    start = path_mm(gear) * np.exp(1j * (pi / 2.0 - ANGLE)) - mate
    moved = (tip - mate) * np.exp(1j * beyond_mm / base)

    def unrolled(point: complex) -> float:
        roll = acos(base / abs(point))
        return base * (float(np.angle(-point)) + tan(roll) - roll)

    return abs(unrolled(moved) - unrolled(start))


@pytest.mark.judges("strength")
@pytest.mark.parametrize("gear", [0, 1])
def test_loaded_edges_touch_beyond_the_path_by_the_gap_of_the_involutes(gear: int) -> None:
    """Gaps are what a pair yields less than the pairs on the path, of which the springs are known at the ends."""
    found = shared(5000.0, 1.0)
    rows = np.arange(2 * PER_TOOTH)
    rolled = ((rows + PER_TOOTH / 4.0) / PER_TOOTH)[:, None] % 1.0 + np.arange(-4.0, 4.0)
    beyond = (rolled * BASE_PITCH - path_mm(0)) if gear == 0 else (-path_mm(1) - rolled * BASE_PITCH)
    row, column = np.nonzero((beyond > 0.02) & (beyond < 0.5))
    end = path_mm(0) if gear == 0 else -path_mm(1)
    ratio = (path_mm(0) + path_mm(1)) / BASE_PITCH
    softening = 1.0 / sqrt((1.0 + ratio / 2.0) ** 2 / 2.0 - 1.0)
    spring = 1e3 * single_stiffness_theoretical(np.array(TEETH), (0.0, 0.0)) * cos(softening * ratio / 2.0)
    checked = 0
    for position, past in zip(row, beyond[row, column], strict=True):
        line = found.line_n_mm[np.isclose(found.place_mm[:, position], end), position].max()
        if line > 0.0:
            assert found.way_mm[position] - line / spring == pytest.approx(parted_mm(gear, past), rel=0.1)
            checked += 1
    assert checked > 1


@pytest.mark.judges("strength")
def test_sections_of_helical_teeth_share_the_load() -> None:
    """Lines of contact lean by the base helix angle; the pairs of all sections bear the force together."""
    helix, found = 0.3, shared(1.0, 1.0, helix_rad=0.3, advance_mm=4.0)
    assert found.sections == np.ceil(6.0 * 4.0 / (pi * MODULE))
    assert found.line_n_mm.sum(axis=0) / found.sections == pytest.approx(np.full(2 * PER_TOOTH, 0.1))
    bearing = found.line_n_mm > 0.0
    places = found.place_mm[bearing]
    curved = 1.0 / (RADII[0] * sin(ANGLE) + places) + 1.0 / (RADII[1] * sin(ANGLE) - places)
    lean = cos(atan(tan(helix) * cos(ANGLE)))
    assert found.relative_curvature[bearing] == pytest.approx(curved * lean)
    # Each section is as far ahead of the section before as its part of the advance.
    pairs = found.place_mm.reshape(found.sections, -1, 2 * PER_TOOTH)
    middles = [{round(float(one), 9) for one in part[:, 20] if -path_mm(1) < one < path_mm(0)} for part in pairs]
    ahead = 4.0 * (np.arange(found.sections) + 0.5) / found.sections * cos(ANGLE)
    for some, way in zip(middles, ahead, strict=True):
        first = (20 + PER_TOOTH / 4.0) / PER_TOOTH * BASE_PITCH - way
        wanted = [one for one in first + BASE_PITCH * np.arange(-4, 5) if -path_mm(1) < one < path_mm(0)]
        assert sorted(some) == pytest.approx(wanted)
    teeth = np.array([20.0, 40.0])
    plan = ToothPlan(RACK, 1.0, (0.0, 0.0), (ANGLE, ANGLE), None, helix_rad=helix)
    assert plan.virtual(teeth, ANGLE) == pytest.approx(teeth / (lean**2 * cos(helix)))


@pytest.mark.judges("strength")
@at_once("height", [2.0, 2.5, -0.5])
@at_once("radius", [20.0, -45.0, 1e4])
def test_the_path_ends_at_a_tip_circle_or_at_the_mates_involute(height: float, radius: float) -> None:
    """A point of the action at s is at (r + s sin a, s cos a) from the axis; the mate's involute begins at r2 sin a."""
    sine = sin(ANGLE)
    (reach,) = without_teeth._reach_mm(np.array([1.0 / radius]), np.zeros(1), height, sine)
    assert hypot(radius + reach * sine, reach * cos(ANGLE)) == pytest.approx(abs(radius + height), rel=1e-9)
    mate = 4.0
    (short,) = without_teeth._reach_mm(np.array([1.0 / radius]), np.array([1.0 / mate]), height, sine)
    assert short == pytest.approx(min(reach, mate * sine))


@pytest.mark.judges("strength")
@pytest.mark.parametrize("load", [0.5, 4.0, 60.0])
def test_pairs_yield_by_one_way_less_their_gaps(load: float) -> None:
    gap, springs = np.array([[0.0], [0.01], [0.3]]), np.array([[100.0], [50.0], [80.0]])
    (way,), share = without_teeth._borne(np.array([load]), springs, gap)
    assert share.sum() == pytest.approx(load)
    assert share == pytest.approx(springs * np.maximum(way - gap, 0.0))


@pytest.mark.judges("strength")
@pytest.mark.parametrize("gear", list(Gear))
def test_a_root_bears_what_the_standard_says_of_a_load_on_the_flank(gear: Gear) -> None:
    """100 N/mm a millimetre towards the driving gear's tip; on the driven gear it counts as at the pitch point."""
    place = list(Gear).index(gear)
    load: Any = Made(phi1_rad=np.array([0.5]))
    rows = np.full((1, 1), 100.0), np.array([0.01]), np.full((1, 1), 1.0), np.full((1, 1), 0.1)
    teeth = np.array([[[20.0]], [[40.0]]])
    rims = (lambda phi: 1.0 + phi, lambda phi: 1.2 + phi)
    plan = ToothPlan(RACK, 1.0, (0.2, -0.1), (ANGLE, ANGLE), None, rims, thinner=(0.05, 0.1))
    running: Any = Made(module_mm=MODULE)
    shared = SharedLoad(load, ANGLE, *rows, teeth, np.zeros((1, 1), dtype=int))
    ((found,),) = without_teeth._root_stress(shared, gear, plan, running)
    radius = RADII[place]
    at = hypot(radius * cos(ANGLE), radius * sin(ANGLE) + (1.0 if gear is Gear.DRIVING else 0.0))
    section = root_section(float(TEETH[place]), plan.shifts[place], RACK, ANGLE)
    section = replace(section, chord=section.chord - plan.thinner[place])
    factors = root_factors(section, float(TEETH[place]), plan.shifts[place], 2.0 * at / MODULE, ANGLE)
    rim = 1.5 if gear is Gear.DRIVING else 1.7
    assert found == pytest.approx(rim * 100.0 * cos(ANGLE) / MODULE * factors.form * factors.notch)


@pytest.mark.judges("strength")
def test_the_largest_stress_decides_and_curvatures_leap_within_a_pitch() -> None:
    sides: Any = [Made(load=Made(phi1_rad=np.array([1.0, 2.0]))), Made(load=Made(phi1_rad=np.array([3.0, 4.0])))]
    stress = [np.array([10.0, 30.0]), np.array([40.0, 5.0])]
    found = without_teeth._least(Gear.DRIVEN, Damage.BENDING, sides, stress, 100.0, 1.4)
    assert (found.safety, found.stress_mpa, found.phi1_rad, found.wanted) == (2.5, 40.0, 3.0, 1.4)
    count = 8 * PER_TOOTH
    curvature = np.zeros((2, count))
    curvature[1, 100:] = 0.05
    force = np.where(np.arange(count) < 60, 1.0, 0.01)
    for closed, largest in ((False, 0.0), (True, 0.1)):
        load = RolledLoad(np.zeros(count), force, np.ones(count), curvature, np.zeros(count), closed)
        assert load.leap(2.0) == pytest.approx(largest)
    force[68:] = 1.0
    assert RolledLoad(np.zeros(count), force, np.ones(count), curvature, np.zeros(count), False).leap(2.0) == 0.1


# --- planets


def triangle(u: Any) -> Any:
    """An angle that grows faster or slower than another one."""
    return u + 0.3 * np.sin(u)


def compound(carrier_mm: float) -> ArmChain:
    """Pairs of 40 and 30 mm between sun and planet."""
    square = np.array([[1.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    gear = Made(outline_mm=square, teeth=24)
    pitches: Any = [
        Made(center_distance_mm=distance, size=Made(module_mm=2.0), transmission=Made(driven_angle=law))
        for distance, law in ((40.0, lambda u: Made(value=triangle(u))), (30.0, lambda u: Made(value=2.0 * u)))
    ]
    teeth: Any = [Made(driving=gear, driven=gear), Made(driving=gear, driven=gear)]
    return compound_chain(tuple(pitches), tuple(teeth), carrier_mm)  # type: ignore[arg-type]


@pytest.mark.judges("trains")
@pytest.mark.parametrize("carrier_mm", [50.0, 70.0, 70.0 * (1.0 + 5e-10), 20.0])
def test_an_idler_stands_beside_the_carrier_at_both_centre_distances(carrier_mm: float) -> None:
    """Marks of the meshes point along the centre lines at first; a mesh turns its gears against each other."""
    chain = compound(carrier_mm)
    sun, idler, second, planet = chain.gears
    assert (abs(idler.place), abs(planet.place - idler.place)) == pytest.approx((40.0, 30.0))
    assert (planet.place, sun.place, second.place) == (complex(carrier_mm), 0j, idler.place)
    assert idler.place.imag >= 0.0
    before, after = np.angle(idler.place), np.angle(planet.place - idler.place)
    u = np.array([0.0, 0.7, 2.0])
    assert sun.angle(u) == pytest.approx(before - u)
    assert idler.angle(u) == pytest.approx(before + triangle(u))
    assert second.angle(u) == pytest.approx(after + triangle(u))
    assert planet.angle(u) == pytest.approx(after - 2.0 * triangle(u))
    assert chain.planet_rad(u) == pytest.approx(2.0 * triangle(u))
    assert [gear.layer for gear in chain.gears] == [0, 0, 1, 1]
    assert sun.outline_mm == pytest.approx(np.array([[0.0, -1.0], [2.0, -1.0], [1.0, 0.0]]))
    assert chain.carrier_mm == carrier_mm


@pytest.mark.judges("trains")
@pytest.mark.parametrize("carrier_mm", [9.9, 10.0, 70.1])
def test_a_carrier_that_two_centre_distances_do_not_span_is_refused(carrier_mm: float) -> None:
    with pytest.raises(NoSuchMechanism, match=f"a module of {carrier_mm / 35.0:.6g} mm"):
        compound(carrier_mm)


@pytest.mark.judges("trains")
@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize("sun_turns", [0.0, -0.5])
def test_planets_stand_on_their_carrier_and_turn_by_their_law(clockwise: bool, sun_turns: float) -> None:
    """Two arms, the carrier at half the driving angle and 0.2 rad ahead, about an axis at (5, 3)."""
    square = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    gears = (
        GearOfChain("sun", square, 20, 0j, lambda u: 0.4 - u),
        GearOfChain("idler", square, 20, 30.0 + 10.0j, lambda u: 0.4 + 2.0 * u),
        GearOfChain("planet", square, 20, 50.0 + 0j, lambda u: 0.1 - 3.0 * u, 1, "idler"),
    )
    chain = ArmChain(gears, (("sun", "idler"),), lambda u: 3.0 * u, Mesh.INTERNAL)
    made = planetary_train(
        chain,
        Arm(12.0, 0.6, np.array([[1.0, 2.0]])),
        2,
        Bodies(8.0, 6.0, 10.0),
        30.0,
        0.01,
        sun_turns,
        Stand(5.0 + 3.0j, 0.2, clockwise),
        lambda driving: driving / 2.0,
    )
    names = [part.name for part in made.parts]
    arms = [f"{name}_{number}" for number in (1, 2) for name in ("idler", "planet", "arm")]
    assert names == ["sun", *arms, "carrier"]
    assert [(mesh.first, mesh.second, mesh.kind) for mesh in made.meshes] == [
        ("sun", "idler_1", Mesh.INTERNAL),
        ("sun", "idler_2", Mesh.INTERNAL),
    ]
    assert made.part("sun").fixed_to == (GROUND if sun_turns == 0.0 else "")
    assert (made.part("planet_2").fixed_to, made.part("arm_1").fixed_to) == ("idler_2", "planet_1")
    # A turn of the carrier against the sun, three of which are two turns of the carrier and one of the sun back
    assert made.cycle_rad == pytest.approx(2.0 * pi / (1.0 - sun_turns) * made.repeats)
    assert made.repeats == (1 if sun_turns == 0.0 else 3)
    if not clockwise:
        lows = [made.part(name).low_mm for name in ("sun", "idler_1", "planet_1", "arm_1", "carrier")]
        step = 8.0 + GAP_MM
        assert lows == [0.0, 0.0, step, 2.0 * step, -step]
    driving = np.array([0.0, 1.3])
    poses = made.poses_at(driving)
    carrier = driving / 2.0 + 0.2
    for number, offset in (("", 0.0), ("_1", 0.0), ("_2", pi)):
        u = (1.0 - sun_turns) * driving / 2.0 + offset
        angles = {"sun": 0.4 - u, "idler": 0.4 + 2.0 * u, "planet": 0.1 - 3.0 * u, "arm": 0.6 - 3.0 * u}
        places = {"sun": 0j, "idler": 30.0 + 10.0j, "planet": 50.0, "arm": 50.0}
        for name in ("sun",) if not number else ("idler", "planet", "arm"):
            place, turn = poses.places(made.number(f"{name}{number}"))
            wanted = places[name] * np.exp(1j * (carrier + offset)) + 5.0 + 3.0j
            turned = np.exp(1j * (carrier + offset + angles[name]))
            assert place == pytest.approx(np.conj(wanted) if clockwise else wanted)
            assert turn == pytest.approx(np.conj(turned) if clockwise else turned)
    (first, second) = made.traces
    assert (first.part, first.at_mm, second.name) == ("arm_1", (12.0, 0.0), "path_2")


@pytest.mark.judges("trains")
def test_a_carrier_is_all_that_is_near_the_lines_through_its_axes() -> None:
    """Bars of 10 mm from the sun's axis over an idler to the planet, for each of three arms, bored at all axes."""
    square = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    gears = tuple(
        GearOfChain(name, square, 20, place, lambda u: u)
        for name, place in (("sun", 0j), ("idler", 30.0 + 10.0j), ("planet", 50.0 + 0j))
    )
    chain = ArmChain(gears, (), lambda u: u)
    made = planetary_train(chain, None, 3, Bodies(8.0, 6.0, 10.0), 30.0, 0.01)
    carrier = made.part("carrier")
    shape = Polygon(carrier.outline_mm)
    assert shape.exterior.is_ccw
    turns = np.exp(2j * pi * np.arange(3) / 3.0)
    holes = {(round(hole.x_mm, 9), round(hole.y_mm, 9)) for hole in carrier.holes}
    wanted = {
        (round(float((p * t).real), 9), round(float((p * t).imag), 9)) for p in (30.0 + 10.0j, 50.0) for t in turns
    }
    assert holes == wanted
    assert {hole.diameter_mm for hole in carrier.holes} == {6.0}
    for turn in turns:
        for start, end in ((0j, 30.0 + 10.0j), (30.0 + 10.0j, 50.0 + 0j)):
            middle, way = (start + end) / 2.0 * turn, (end - start) * turn / abs(end - start)
            for aside in (4.9, -4.9):
                place = middle + 1j * aside * way
                assert shape.contains(Point(place.real, place.imag))
        tip = 50.0 * turn
        out = (20.0 - 10.0j) * turn / abs(20.0 - 10.0j)
        for beyond, inside in ((4.98, True), (5.01, False)):
            place = tip + beyond * out
            assert shape.contains(Point(place.real, place.imag)) is inside
    assert np.hypot(*carrier.outline_mm.T).max() == pytest.approx(55.0, abs=0.01)


def test_rings_keep_their_sense_in_a_mirror() -> None:
    ring = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 2.0]])
    assert Polygon(mirrored(ring)).exterior.is_ccw
    assert {tuple(point) for point in mirrored(ring)} == {(0.0, 0.0), (3.0, 0.0), (3.0, -2.0)}


@pytest.mark.judges("strength")
def test_a_root_that_both_flanks_load_alike_has_seven_tenths_of_the_strength() -> None:
    """Teeth 1 and 2 of three: the back presses tooth 1 with as much, and no other tooth bears both."""
    rows = np.zeros((1, 2)), np.zeros(2), np.zeros((1, 2)), np.zeros((1, 2)), np.zeros((2, 1, 2))
    sides = [
        SharedLoad(Made(urge=np.full(2, urge)), ANGLE, *rows, np.array([teeth]))  # type: ignore[arg-type]
        for urge, teeth in ((1.0, [1, 2]), (-1.0, [4, 0]))
    ]
    stress = [np.array([[70.0, 70.0]]), np.array([[70.0, 30.0]])]
    found = without_teeth._alternating(sides, stress, Gear.DRIVING, 3)
    assert np.array(found) == pytest.approx(np.array([[100.0, 70.0], [100.0, 30.0]]))
    # The driven gear's tooth on a pushing flank is the one before
    found = without_teeth._alternating(sides, stress, Gear.DRIVEN, 3)
    assert np.array(found) == pytest.approx(np.array([[70.0 + 30.0 * 3.0 / 7.0, 100.0], [100.0, 60.0]]))
