"""What every mechanism has to keep, held against plain geometry and energy in mpmath, and against pylinkage.

A new mechanism joins by one case in ``mechanism_cases.py`` and one class in ``oracles/linkages.py``.
"""

from __future__ import annotations

from functools import cache
from math import pi
from typing import Any

import numpy as np
import pytest
from mpmath import mp

from at_once import at_once
from mechanism_cases import CASES, GRAVITY_M_S2, RETURNING, Case, lever, rocker
from ncgear.design.mechanisms import MECHANISMS, NO_LINKAGE
from ncgear.errors import WrongInput
from ncgear.mechanisms.crank_rocker import CrankRocker
from ncgear.mechanisms.forces import CrankPace, JointForces
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.mechanisms.slotted_lever import SlottedLever
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector

every_case = at_once("case", CASES)
every_returning = at_once("case", RETURNING)

ANGLES = np.array([0.05, 0.9, 1.7, 2.6, 3.3, 4.1, 5.2, 6.1])
SPEED, ACCELERATION, LOAD = 7.0, -13.0, 250.0


KINDS = [kind for kind in MECHANISMS if kind != NO_LINKAGE]


def test_there_is_a_case_of_every_kind() -> None:
    assert {case.kind for case in CASES} == set(KINDS)


# --- kinematics


@pytest.mark.judges("mechanisms")
@every_case
def test_displacement_and_derivatives_are_those_of_plain_geometry(case: Case) -> None:
    found = case.mechanism.displacement(Jet.variable(ANGLES, 3))
    with mp.workdps(50):
        exact = case.oracle
        wanted = np.array([list(mp.diffs(exact.displacement, q, 3)) for q in ANGLES.tolist()], dtype=float).T
    for k in range(4):
        # Near a change point the derivatives grow; each is good to some rounding errors of the largest
        assert found.derivative(k) == pytest.approx(wanted[k], abs=2e-13 * max(np.abs(wanted[: k + 1]).max(), 1e-3))


@every_returning
@at_once("angle", [1e-12, 1e-8, 1e-4, 1e-2])
def test_displacement_is_relatively_exact_near_the_retracted_end(case: Case, angle: float) -> None:
    before = 2.0 * pi - angle
    found = case.mechanism.displacement(Jet.variable([angle, before], 0)).value
    with mp.workdps(60):
        exact = case.oracle.displacement(mp.mpf(angle))
        assert abs(found[0] / exact - 1) < 4e-15
        # From the other side, the angle itself is good to rounding errors of a turn
        gone = 2 * mp.pi - mp.mpf(before)
        assert abs(found[1] / case.oracle.displacement(-gone) - 1) < 4e-15 + 4.0 * 2.3e-16 * 2.0 * pi / angle


@every_returning
def test_dead_centres_stroke_and_time_ratio_by_fifty_digits(case: Case) -> None:
    made = case.mechanism
    with mp.workdps(50):
        exact = case.oracle
        # Dead centres are where the output stands: by the slope's zeros, not by triangles
        start = exact.working_angle()
        extended = mp.findroot(lambda q: mp.diff(exact.place, q), start)
        assert abs(mp.diff(exact.place, mp.mpf(0))) < mp.mpf("1e-40") * 1000
        assert abs(extended - start) < mp.mpf("1e-18")
        assert abs(made.working_angle_rad - extended) < 2e-15
        assert abs(made.stroke_mm / exact.displacement(extended) - 1) < 4e-15
    at = made.displacement(Jet.variable([0.0, made.working_angle_rad, 2.0 * pi], 1))
    assert at.value == pytest.approx([0.0, made.stroke_mm, 0.0], abs=4e-15 * made.stroke_mm)
    assert at.derivative(1) == pytest.approx(0.0, abs=2e-14 * made.stroke_mm)


def test_the_quick_return_takes_the_textbook_ratio() -> None:
    """(pi + 2 asin(r/d)) / (pi - 2 asin(r/d)): 2 for r/d = 1/2."""
    working = SlottedLever(50.0, 100.0, 200.0).working_angle_rad
    assert working / (2.0 * pi - working) == pytest.approx(2.0, rel=1e-15)


def test_the_two_sides_of_a_rocker_are_mirror_images() -> None:
    """Seen in a mirror the crank turns the other way round: what one side does on its way out the other does back."""
    left, right = rocker(40.0, 100.0, 80.0, 110.0).mechanism, rocker(40.0, 100.0, 80.0, 110.0, -1).mechanism
    assert left.working_angle_rad + right.working_angle_rad == pytest.approx(2.0 * pi, rel=1e-15)
    there = left.displacement(Jet.variable(ANGLES, 0)).value
    assert right.displacement(Jet.variable(2.0 * pi - ANGLES, 0)).value == pytest.approx(there, rel=1e-14)


@every_returning
def test_the_crank_angle_of_a_stroke_turns_the_displacement_back(case: Case) -> None:
    """The inverse with its derivatives is the identity, up to both dead centres, by smooth roots of the way."""
    made = case.mechanism
    working, stroke = made.working_angle_rad, made.stroke_mm
    share = np.concatenate([[0.0, 1e-9, 1e-4], np.linspace(0.01, 0.99, 21), [1.0 - 1e-4, 1.0 - 1e-9, 1.0]])
    half = Jet.variable(0.5 * pi * share, 2)
    sine, cosine = jet.sin_cos(half)
    # x = stroke sin^2: with both roots smooth, as a motion law gives them
    away = np.abs(0.5 * pi * (1.0 - share))
    cosine = Jet(np.vstack([np.sin(away)[None, :], cosine.coefficients[1:]]))
    root, rest = sine * np.sqrt(stroke), cosine * np.sqrt(stroke)
    # dx is 2 stroke sin cos, twice the root of both parts
    slope = made.regular_slope(root * root, root * rest) * 2.0
    angle = slope.truncated(1).integrated(made.working_angle(root.value**2, rest.value**2))
    assert angle.value[[0, -1]] == pytest.approx([0.0, working], abs=1e-15)
    assert np.all(np.isfinite(angle.coefficients))
    back, wanted = made.displacement(angle), root * root
    for k in range(3):
        assert back.derivative(k) == pytest.approx(wanted.derivative(k), abs=2e-13 * stroke)
    inner = 0.5 * pi * share[(share > 0.001) & (share < 0.999)]
    displaced = stroke * np.sin(inner) ** 2
    for returning in (False, True):
        found = made.crank_angle(displaced, np.full(displaced.size, returning))
        assert np.all((found > working) == returning)
        assert made.displacement(Jet.variable(found, 0)).value == pytest.approx(displaced, abs=4e-14 * stroke)


@every_returning
def test_the_mechanism_of_a_stroke_has_that_stroke(case: Case) -> None:
    made = case.mechanism
    lengths = {name: value for name, value in case.lengths.items() if name != made.STROKE_KEY}
    found = type(made).of_stroke(made.stroke_mm, **lengths)
    assert getattr(found, made.STROKE_KEY) == pytest.approx(case.lengths[made.STROKE_KEY], rel=1e-12)
    assert found.stroke_mm == pytest.approx(made.stroke_mm, rel=1e-13)
    if lengths.keys() - {"offset_mm", "side"}:
        with pytest.raises(WrongInput, match="follow"):
            type(made).of_stroke(100.0 * made.stroke_mm, **lengths)


@at_once("kind", KINDS)
def test_many_at_once_are_as_each_by_itself(kind: str) -> None:
    cases = [case for case in CASES if case.kind == kind]
    columns = {name: np.array([float(case.lengths[name]) for case in cases]) for name in cases[0].lengths}
    many, angle = type(cases[0].mechanism).many(**columns), Jet.variable(np.linspace(0.4, 5.0, len(cases)), 2)
    assert np.all(many.turns_fully)
    found, each = many.displacement(angle).coefficients, [case.mechanism for case in cases]
    alone = [one.displacement(Jet(angle.coefficients[:, [i]])).coefficients for i, one in enumerate(each)]
    assert found == pytest.approx(np.hstack(alone), rel=1e-15)
    for name in ("stroke_mm", "nearest_mm", "working_angle_rad"):
        told = np.broadcast_to(getattr(many, name), (len(cases),))
        assert told == pytest.approx([getattr(one, name) for one in each], rel=1e-15)


@every_returning
def test_corners_are_the_nearest_singularities(case: Case) -> None:
    """The terms of the displacement's series fall as powers of the distance to the nearest corner's complex place."""
    made = case.mechanism
    order = np.arange(50, 81)
    for angle, _ in made.corners:
        assert 0.0 <= angle < 2.0 * pi
        nearest = min(abs((angle - at + pi) % (2.0 * pi) - pi + 1j * width) for at, width in made.corners)
        terms = made.displacement(Jet.variable([angle], 80)).coefficients[order, 0]
        # Of a square root: r^-k k^(-3/2); of a pole: r^-k
        falling = np.max((np.abs(terms) / made.stroke_mm * order) ** (1.0 / order))
        assert 1.0 / falling == pytest.approx(nearest, rel=0.06)


# --- what cannot turn


@at_once(
    ("kind", "lengths", "key", "said"),
    [
        ("crank_rocker", (60.0, 100.0, 80.0, 125.0), "linkage.crank_mm", "a crank under 55 mm works"),
        ("crank_rocker", (90.0, 100.0, 80.0, 100.0), "linkage.crank_mm", "a crank under 80 mm works"),
        ("crank_rocker", (10.0, 100.0, 50.0, 200.0), "linkage.crank_mm", "a shorter ground is needed first"),
        ("crank_rocker", (0.0, 100.0, 80.0, 110.0), "linkage.crank_mm", "0 is not a length"),
        ("slotted_lever", (60.0, 60.0, 300.0), "linkage.pivot_mm", "turn round instead of swinging"),
        ("slotted_lever", (60.0, 100.0, 160.0), "linkage.lever_mm", "a longer lever is needed"),
        ("slotted_lever", (60.0, 100.0, -1.0), "linkage.lever_mm", "not a length"),
    ],
)
def test_what_cannot_turn_is_refused(kind: str, lengths: tuple[float, ...], key: str, said: str) -> None:
    with pytest.raises(WrongInput, match=said) as refused:
        MECHANISMS[kind].load()(*lengths)
    assert refused.value.key == key


def test_grashof_by_turning_the_crank() -> None:
    """The crank turns fully exactly where the circles of coupler and rocker meet all the way round."""
    random, around = np.random.default_rng(19), np.exp(1j * np.linspace(0.0, 2.0 * pi, 721))
    seen = set[bool]()
    for _ in range(300):
        crank, coupler, rocker_mm, ground = random.uniform(10.0, 100.0, 4)
        reach = np.abs(ground - crank * around)
        meets = bool(np.all((reach < coupler + rocker_mm) & (reach > abs(coupler - rocker_mm))))
        # A double crank turns fully too; a crank-rocker's ground is longer than the crank
        meets &= ground > crank + abs(coupler - rocker_mm)
        many = CrankRocker.many(
            **{
                name: np.array([value])
                for name, value in zip(
                    ("crank_mm", "coupler_mm", "rocker_mm", "ground_mm"),
                    (crank, coupler, rocker_mm, ground),
                    strict=True,
                )
            }
        )
        assert bool(many.turns_fully[0]) == meets
        seen.add(meets)
    assert seen == {False, True}


# --- forces


def found_forces(case: Case) -> JointForces:
    angle = Jet.variable(ANGLES, 2)
    pace = CrankPace(np.full(ANGLES.size, SPEED), np.full(ANGLES.size, ACCELERATION))
    return case.mechanism.joint_forces(angle, case.masses, pace, np.full(ANGLES.size, LOAD))


@pytest.mark.judges("mechanisms")
@every_case
def test_torque_is_lagranges(case: Case) -> None:
    found = found_forces(case).torque_n_mm[::4]
    with mp.workdps(30):
        exact = case.oracle
        wanted = [float(exact.torque(mp.mpf(q), SPEED, ACCELERATION, LOAD)) for q in ANGLES[::4].tolist()]
    assert found == pytest.approx(wanted, abs=1e-12 * np.abs(wanted).max())


@pytest.mark.tiers(slow=["crank_rocker 40 110 60 125 1"], rest="long")
@pytest.mark.parametrize("case", {case.kind: case for case in CASES}.values(), ids=str)
def test_a_mass_that_is_left_out_is_seen(case: Case) -> None:
    """Negative control: each mass and the load change the torque."""
    with mp.workdps(20):
        exact, q = case.oracle, mp.mpf(ANGLES[1])
        whole = exact.torque(q, SPEED, ACCELERATION, LOAD)
        for name in exact.masses:
            if name.endswith("_center_mm"):
                continue
            less = type(exact)(exact.lengths, {**exact.masses, name: 0}, exact.gravity)
            assert abs(less.torque(q, SPEED, ACCELERATION, LOAD) / whole - 1) > 1e-6
        assert abs(exact.torque(q, SPEED, ACCELERATION, 0) / whole - 1) > 1e-6


def at(vector: Vector, row: int) -> Any:
    return mp.mpc(float(vector.x[row]), float(vector.y[row]))


Acting = dict[str, list[tuple[Any, Any]]]
"""Forces on each body with the places at which they act."""


def acting(case: Case, forces: JointForces, row: int) -> tuple[Acting, dict[str, Any]]:
    """All forces on every body but weights, by hand for each kind, and the moments on them, counter-clockwise."""
    exact, q = case.oracle, mp.mpf(ANGLES[row])
    pin, joints = exact.pin(q), {name: at(force, row) for name, force in forces.joints.items()}
    guide, drive = mp.mpc(0, float(forces.guide_n[row])), -mp.mpf(float(forces.torque_n_mm[row]))
    axis, load = (mp.mpf(0), at(forces.crank_axis, row)), mp.mpc(-LOAD)
    slider = exact.others(q).get("slider", (0, 0, 0, 0))[2]
    match case.kind:
        case "crank_slider":
            wrist, push = joints["wrist"], joints["pin"]
            bodies = {
                "slider": [(slider, wrist), (slider, load), (slider, guide)],
                "rod": [(slider, -wrist), (pin, push)],
                "crank": [(pin, -push), axis],
            }
            return bodies, {"crank": drive}
        case "scotch_yoke":
            push = joints["pin"]
            assert mp.im(push) == 0
            return {"slider": [(slider, push + load + guide)], "crank": [(pin, -push), axis]}, {"crank": drive}
        case "crank_rocker":
            end, pivot = exact.rocker_pin(q), exact.ground_mm
            bodies = {
                "rocker": [(pivot, joints["rocker_bearing"]), (end, joints["rocker_pin"])],
                "coupler": [(end, -joints["rocker_pin"]), (pin, joints["pin"])],
                "crank": [(pin, -joints["pin"]), axis],
            }
            return bodies, {"crank": drive, "rocker": exact.side * LOAD}
        case "slotted_lever":
            pivot, direction = mp.mpc(0, -exact.pivot_mm), exact.lever(q)
            tip, ram = pivot + exact.lever_mm * direction, exact.others(q)["ram"][2]
            assert mp.im(joints["ram_pin"]) == 0
            assert abs(mp.re(mp.conj(direction) * joints["slot"])) < 1e-12 * abs(joints["slot"])
            bodies = {
                "ram": [(ram, joints["ram_pin"] + load + guide)],
                "lever": [(tip, -joints["ram_pin"]), (pivot, joints["lever_bearing"]), (pin, joints["slot"])],
                "block": [(pin, -joints["slot"]), (pin, joints["pin"])],
                "crank": [(pin, -joints["pin"]), axis],
            }
            return bodies, {"crank": drive}
    rack, mesh = exact.others(q)["rack"][2], mp.mpc(0, exact.radius_mm)
    bodies = {"rack": [(rack, joints["teeth"] + load + guide)], "crank": [(mesh, -joints["teeth"]), axis]}
    return bodies, {"crank": drive}


@pytest.mark.tiers(quick=["4"], rest="slow")
@every_case
@pytest.mark.parametrize("row", [1, 4, 6])
def test_forces_and_moments_on_every_body_are_in_balance(case: Case, row: int) -> None:
    """Newton and Euler for each body by itself, with its motion from plain geometry."""
    forces = found_forces(case)
    with mp.workdps(30):
        exact, q = case.oracle, mp.mpf(ANGLES[row])
        bodies, moments = acting(case, forces, row)
        step = mp.mpf(10) ** -mp.dps
        with mp.workdps(3 * mp.dps):
            before, here, after = (exact.bodies(q + side * step) for side in (-1, 0, 1))
        assert bodies.keys() == here.keys()
        largest = max(abs(force) for body in bodies.values() for _, force in body)
        for name, body in bodies.items():
            mass, own, center, _ = here[name]
            with mp.workdps(3 * mp.dps):
                moved, turned = (
                    SPEED**2 * (after[name][k] - 2 * here[name][k] + before[name][k]) / step**2
                    + ACCELERATION * (after[name][k] - before[name][k]) / (2 * step)
                    for k in (2, 3)
                )
            sum_of = sum(force for _, force in body) + mass * mp.mpc(*GRAVITY_M_S2)
            assert abs(sum_of - mass * moved / 1000) < 1e-12 * largest
            moment = sum(mp.im(mp.conj(place - center) * force) for place, force in body) + moments.get(name, 0)
            if name in ("slider", "ram", "rack"):
                continue  # the guide bears any moment
            assert abs(moment - own * turned / 1000) < 1e-12 * largest * 300


@every_returning
def test_over_a_cycle_the_drive_does_the_work_of_the_load(case: Case) -> None:
    """Virtual work: masses and weights give back what they take; a friction takes twice its stroke."""
    made, count = case.mechanism, 4096
    q = (np.arange(count) + 0.5) * 2.0 * pi / count
    pace = CrankPace(np.full(count, SPEED), np.zeros(count))
    backwards = np.where(q < made.working_angle_rad, LOAD, -LOAD)
    torque = made.joint_forces(Jet.variable(q, 2), case.masses, pace, backwards).torque_n_mm
    resting = made.joint_forces(Jet.variable(q, 2), case.masses, pace, 0.0 * backwards).torque_n_mm
    assert resting.mean() == pytest.approx(0.0, abs=1e-9 * np.abs(torque).max())
    # The load jumps at the dead centres, where the midpoint rule is good to the second order
    assert torque.mean() * 2.0 * pi == pytest.approx(2.0 * LOAD * made.stroke_mm, rel=1e-5)


# --- another program


@cache
def pylinkage_places(kind: str, lengths: tuple[float, ...], steps: int) -> Array:
    """Places of the output's pin by pylinkage, from the retracted dead centre on, shape (steps + 1, 2)."""
    pytest.importorskip("pylinkage")
    from pylinkage.actuators import Crank
    from pylinkage.components import Ground
    from pylinkage.dyads import FixedDyad, RRPDyad, RRRDyad
    from pylinkage.simulation import Linkage

    made: Any = MECHANISMS[kind].load()(*lengths)
    axis = Ground(0.0, 0.0, name="axis")
    crank = Crank(
        anchor=axis, radius=made.crank_mm, angular_velocity=-2.0 * pi / steps, initial_angle=made.crank_start_rad
    )
    if kind == "crank_slider":
        line = Ground(-1.0, made.offset_mm), Ground(1.0, made.offset_mm)
        last: Any = RRPDyad(crank.output, *line, distance=made.rod_mm, x=made.nearest_mm, y=made.offset_mm)
        parts = [axis, *line, crank, last]
    elif kind == "crank_rocker":
        pivot, gamma = Ground(made.ground_mm, 0.0), made.nearest_mm
        x, y = made.ground_mm - made.rocker_mm * np.cos(gamma), made.side * made.rocker_mm * np.sin(gamma)
        last = RRRDyad(crank.output, pivot, distance1=made.coupler_mm, distance2=made.rocker_mm, x=x, y=y)
        parts = [axis, pivot, crank, last]
    else:
        pivot = Ground(0.0, -made.pivot_mm)
        last = FixedDyad(pivot, crank.output, distance=made.lever_mm, angle=0.0)
        parts = [axis, pivot, crank, last]
    linkage = Linkage(parts)
    found = [(last.x, last.y)]
    for _, positions in zip(range(steps), linkage.step(iterations=steps), strict=False):
        found.append(positions[parts.index(last)])
    return np.array(found, dtype=float)


@at_once("case", [one for one in RETURNING if one.kind != "scotch_yoke"])
def test_the_output_is_where_pylinkage_has_it(case: Case) -> None:
    steps = 360
    made: Any = case.mechanism
    found = pylinkage_places(case.kind, tuple(case.lengths.values()), steps)
    moved = made.displacement(Jet.variable(np.arange(len(found)) * 2.0 * pi / steps, 0)).value
    assert len(found) >= steps
    if case.kind == "crank_rocker":
        turned = np.arctan2(made.side * found[:, 1], made.ground_mm - found[:, 0])
        assert moved + made.nearest_mm == pytest.approx(turned, abs=1e-9)
    elif case.kind == "slotted_lever":
        assert moved - made.stroke_mm / 2.0 == pytest.approx(found[:, 0], abs=1e-9 * made.lever_mm)
    else:
        assert moved + made.nearest_mm == pytest.approx(found[:, 0], abs=1e-9 * made.rod_mm)


def test_a_yoke_is_a_crank_slider_of_endless_rod() -> None:
    """pylinkage has no yoke; with a rod of a thousand cranks the slider is at most a two-thousandth of it away."""
    yoke = ScotchYoke(50.0)
    found = pylinkage_places("crank_slider", (50.0, 50000.0), 90)
    moved = yoke.displacement(Jet.variable(np.arange(len(found)) * 2.0 * pi / 90, 0)).value
    assert moved + found[0, 0] == pytest.approx(found[:, 0], abs=50.0 / 2000.0 * 1.001)
    assert np.abs(moved + found[0, 0] - found[:, 0]).max() > 0.9 * 50.0 / 2000.0


# --- pictures


@every_case
def test_pins_and_links_are_where_plain_geometry_has_them(case: Case) -> None:
    made = case.mechanism
    links = made.links(Jet.variable(ANGLES, 0))
    assert list(links)[:2] == [made.OUTPUT.name, "crank"]
    assert set(made.PINS.values()) <= set(links)
    assert set(made.shapes()) >= set(links) - {"crank", made.OUTPUT.name}
    with mp.workdps(30):
        pins = np.array([complex(case.oracle.pin(mp.mpf(q))) for q in ANGLES.tolist()]) if made.PINS else None
    ends = {name: link.origin.x.value + 1j * link.origin.y.value for name, link in links.items()}
    turned = {name: np.exp(1j * link.angle.value) for name, link in links.items()}
    if pins is not None:
        assert ends[made.PINS["crank-pin"]] == pytest.approx(pins, abs=1e-12 * np.abs(pins).max())
    if isinstance(made, CrankRocker):
        assert ends["rocker"] + turned["rocker"] * made.rocker_mm == pytest.approx(made.ground_mm, abs=1e-10)
        assert ends["coupler"] + turned["coupler"] * made.coupler_mm == pytest.approx(ends["rocker"], abs=1e-10)
    if isinstance(made, SlottedLever):
        assert ends["lever"] + turned["lever"] * made.lever_mm == pytest.approx(-1j * made.pivot_mm, abs=1e-10)
        apart = (pins - ends["lever"]) / turned["lever"]
        assert apart.imag == pytest.approx(0.0, abs=1e-10)
        (slot,) = made.shapes()["lever"].slots
        assert slot[0][0] < apart.real.min() < apart.real.max() < slot[1][0]


def test_a_lever_beside_a_bearing_is_still_drawn() -> None:
    (slot,) = lever(99.0, 100.0, 200.0).mechanism.shapes()["lever"].slots
    assert slot[0][0] > 0.0
