"""Arcs, chords, pins and discs by plain geometry; loads of a way out and back; least costs; weakest teeth."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, cos, inf, pi, sin, sqrt, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from shapely.geometry import LinearRing, LineString, Point

import ncgear.whole_machines.limits as limits
from at_once import at_once
from ncgear.dynamics import quasi_static
from ncgear.kinematics.motion import sample_angles
from ncgear.mechanisms.crank_rocker import CrankRocker
from ncgear.mechanisms.resistance import FormulaResistance
from ncgear.metrology import exact_outline, pins, round_tool
from ncgear.numerics.jet import Jet
from ncgear.pitch.shape import Gear
from ncgear.strength import face_load, holding, loading
from ncgear.strength.sections import FEWEST, PER_PITCH, FaceSections, count_of
from ncgear.strength.vibration import Vibration
from ncgear.teeth import arcs
from ncgear.tolerances import outlines

Made: Any = SimpleNamespace


# --- teeth


@pytest.mark.judges("teeth")
@pytest.mark.parametrize("bulge", [0.3, -0.3, 1.4, -0.05])
def test_distances_from_an_arc_are_those_from_its_circle(bulge: float) -> None:
    """A bulge is the tangent of a quarter of the angle: the sagitta is half of it times the chord."""
    start, end = 3.0 + 1.0j, 9.0 - 2.0j
    length = abs(end - start)
    sagitta = bulge * length / 2.0
    apex = (start + end) / 2.0 - 1j * (end - start) / length * sagitta
    radius = (length**2 / 4.0 + sagitta**2) / (2.0 * sagitta)
    center = apex + 1j * (end - start) / length * radius
    assert abs(start - center) == pytest.approx(abs(radius))
    points = center + abs(radius) * (1.0 + 1e-6 * np.array([1.0, -3.0, 0.0, 7.0])) * np.exp(1j * np.arange(4.0))
    found = arcs._distance(points, np.array(start), np.array(end), np.array(bulge))
    assert found == pytest.approx(abs(radius) * 1e-6 * np.array([1.0, 3.0, 0.0, 7.0]), rel=1e-4, abs=1e-11)
    off = np.array([0.5, -0.25]) * 1j * (end - start) / length + 0.3 * end + 0.7 * start
    assert arcs._distance(off, np.array(start), np.array(end), np.array(0.0)) == pytest.approx([0.5, 0.25])


@pytest.mark.judges("teeth")
def test_the_bulge_of_an_arc_is_the_tangent_of_half_its_chords_angle() -> None:
    """A chord at an angle a to the beginning turns the arc by 2 a, a quarter of which is a / 2."""
    angles = np.array([0.4, -0.9, 2.0])
    found = arcs._bulge(5.0 * np.exp(1j * (0.7 + angles)), np.exp(0.7j) * np.ones(3), 0.1)
    assert found == pytest.approx(np.tan(angles / 2.0))
    # Lines where the sagitta is no more than the tolerance.
    flat = arcs._bulge(5.0 * np.exp(1j * angles), np.ones(3), 5.0 * tan(0.45) / 2.0)
    assert flat.tolist() == [0.0, 0.0, pytest.approx(tan(1.0))]


@pytest.mark.judges("teeth")
@pytest.mark.parametrize("spans", [1, 2])
def test_two_arcs_between_directions_touch_each_other_and_follow_an_ellipse(spans: int) -> None:
    """Points and joints of biarcs: the directions at the ends are the curve's, the same at both sides of each joint."""

    def at(rows: np.ndarray, share: Any) -> tuple[np.ndarray, np.ndarray]:
        angle = 0.3 + 0.9 * np.asarray(share) + 0.0 * rows
        point = np.stack([30.0 * np.cos(angle), 20.0 * np.sin(angle)], axis=-1)
        return point, 0.9 * np.stack([-30.0 * np.sin(angle), 20.0 * np.cos(angle)], axis=-1)

    points, bulges, apart = arcs._biarcs(Made(at=at), np.array([0]), spans, 0.0)
    assert points.shape == bulges.shape == (1, 2 * spans + 1)
    share = np.linspace(0.0, 1.0, spans + 1)
    exact, slopes = at(np.array([0]), share)
    assert points[0, ::2] == pytest.approx(exact @ [1.0, 1.0j])
    half = 2.0 * np.arctan(bulges[0, :-1])
    chord = np.angle(np.diff(points[0]))
    begins, ends = chord - half, chord + half
    assert begins[1:] == pytest.approx(ends[:-1])
    assert begins[::2] == pytest.approx(np.angle(slopes @ [1.0, 1.0j])[:-1])
    assert ends[-1] == pytest.approx(np.angle(slopes @ [1.0, 1.0j])[-1])
    # The distance falls with the third power of the length of a span.
    fine = np.abs(_off_arcs(points[0], bulges[0], at(np.array([0]), np.linspace(0.0, 1.0, 120))[0] @ [1.0, 1.0j]))
    assert apart[0] <= fine.max() * 1.01
    assert apart[0] >= fine.max() * 0.7


def _off_arcs(points: np.ndarray, bulges: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Distances of points from a chain of arcs that shapely has as very many chords."""
    chain: list[complex] = []
    for start, end, bulge in zip(points, points[1:], bulges, strict=False):
        turn = 4.0 * atan(bulge)
        center = (start + end) / 2.0 + 1j * (end - start) / 2.0 / tan(turn / 2.0)
        chain += list(center + (start - center) * np.exp(1j * turn * np.linspace(0.0, 1.0, 1000)))
    line = LineString(np.column_stack([np.real(chain), np.imag(chain)]))
    return np.array([line.distance(Point(other.real, other.imag)) for other in others])


# --- metrology


@pytest.mark.judges("metrology")
def test_the_farthest_of_points_from_an_outline_is_found() -> None:
    """Distances from a star of 60 corners, as shapely has them one by one."""
    random = np.random.default_rng(4)
    angle = np.linspace(0.0, 2.0 * pi, 60, endpoint=False)
    outline = (20.0 + random.uniform(0.0, 3.0, 60)) * np.exp(1j * angle)
    points = (20.0 + random.uniform(-1.0, 4.0, 900)) * np.exp(1j * random.uniform(0.0, 2.0 * pi, 900))
    ring = LinearRing(np.column_stack([outline.real, outline.imag]))
    exact = [ring.distance(Point(point.real, point.imag)) for point in points]
    corners = np.column_stack([outline.real, outline.imag])
    assert exact_outline.farthest_mm(np.column_stack([points.real, points.imag]), corners) == pytest.approx(max(exact))
    bound = exact_outline._at_most_mm(points, outline)
    assert (bound >= np.array(exact) - 1e-12).all()
    found = exact_outline._from_chords_mm(
        np.array([5.0 + 2.0j, -3.0 + 4.0j, 13.0j]), np.zeros(3), np.array([10.0, 10.0, 10.0j])
    )
    assert found == pytest.approx([2.0, 5.0, 3.0])


@pytest.mark.judges("metrology")
@pytest.mark.parametrize("left", [0.0, 0.2])
def test_a_disc_that_stays_off_a_point_clears_another(left: float) -> None:
    """A disc above the origin, ``left`` from it, whose radius grows till it touches a point as closely."""
    normal, other = np.array([0.0, 1.0]), np.array([[3.0, 4.0], [0.0, 9.0], [5.0, -1.0], [2.0, 0.5]])
    found = round_tool._free(np.zeros(2), normal, other, left)
    for radius, point in zip(found, other, strict=True):
        if point[1] <= left:
            assert radius == inf
        else:
            assert np.hypot(*(point - (radius + left) * normal)) == pytest.approx(radius)


@pytest.mark.judges("metrology")
@pytest.mark.parametrize(("teeth", "ring"), [(8, False), (7, False), (8, True)])
def test_sizes_are_over_two_pins_in_opposite_spaces(teeth: int, ring: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pins of 3 mm on a circle of 20 mm; of odd numbers of teeth every space has two nearly opposite ones."""
    asked: list[Any] = []

    def stands_out(working: Any, number: Any, center: Any, radius: float, outwards: Any) -> Any:
        asked.append((number, radius, np.sum(center * outwards, axis=1) / 20.0))
        return np.ones(len(center), dtype=bool)

    monkeypatch.setattr(pins, "_stands_out", stands_out)
    space = np.arange(1, teeth + 1)
    angle = 2.0 * pi * space / teeth
    made: Any = Made(space=space, center_mm=20.0 * np.column_stack([np.cos(angle), np.sin(angle)]), diameter_mm=3.0)
    working: Any = Made(is_ring=ring, flanks=Made(teeth=teeth, made=None))
    found = pins.over_two_pins(working, made)
    first, second, distance = (getattr(found, name) for name in ("first", "second", "distance_mm"))
    count = teeth // 2 if teeth % 2 == 0 else teeth
    assert first.tolist() == list(range(1, count + 1))
    assert ((second - first - teeth // 2) % teeth == 0).all()
    across = 40.0 if teeth % 2 == 0 else 40.0 * cos(pi / teeth / 2.0)
    assert distance == pytest.approx(np.full(count, across + (-3.0 if ring else 3.0)))
    assert [(radius, np.sign(out).tolist()) for _, radius, out in asked] == [(1.5, [-1.0 if ring else 1.0] * count)] * 2
    assert [number.tolist() for number, *_ in asked] == [(first - 1).tolist(), (second - 1).tolist()]
    working.flanks.made = 4
    assert pins.over_two_pins(working, made).first.size == 0


# --- strength and dynamics


@pytest.mark.judges("strength")
def test_the_weakest_tooth_has_the_least_share_of_what_is_wanted() -> None:
    life: Any = Made(
        weakest=2,
        safety=np.array([2.0, 1.2, 1.6]),
        stress_mpa=np.array([1.0, 5.0, 2.0]),
        phi1_rad=np.array([0.1, 0.2, 0.3]),
        life_h=np.array([9.0, 3.0, 6.0]),
    )
    weak = holding._weakest(life, Gear.DRIVEN, holding.Damage.BENDING, 1.6)
    assert (weak.tooth, weak.stress_mpa, weak.phi1_rad, weak.safety, weak.too_weak) == (2, 5.0, 0.2, 1.2, (2,))
    assert weak.share == pytest.approx(0.75)
    found = [weak, holding._weakest(life, Gear.DRIVING, holding.Damage.CONTACT, 1.5)]
    assert holding.worst(found) is weak
    assert holding.worst(found[::-1]) is weak
    # Pressure goes with the square root of the width.
    assert holding.face_width_factor(found) == pytest.approx(max(1.0 / 0.75, (1.5 / 1.2) ** 2))


@pytest.mark.judges("strength")
def test_helical_teeth_have_sections_by_their_advance() -> None:
    assert [count_of(advance, 6.0) for advance in (0.0, 6.0, 6.1)] == [
        FEWEST,
        max(FEWEST, int(PER_PITCH)),
        max(FEWEST, int(np.ceil(PER_PITCH * 6.1 / 6.0))),
    ]
    base = FaceSections((), 0.5).across_lines(pi / 9.0)
    assert base == pytest.approx(cos(atan(tan(0.5) * cos(pi / 9.0))))
    # sin(beta_b) = sin(beta) cos(alpha_n), with tan(alpha_n) = tan(alpha) cos(beta).
    assert sqrt(1.0 - base**2) == pytest.approx(sin(0.5) * cos(atan(tan(pi / 9.0) * cos(0.5))))


@pytest.mark.judges("strength")
@at_once("best", [0.0, 0.004, 0.06])
def test_the_best_crowning_is_where_the_largest_load_is_least(best: float) -> None:
    """A load of 1 + (c - best)^2 of 100 N at the heavier of two places; 20 N/mm2 over 40 mm begin at 0.0125 mm."""

    @dataclass
    class Lead:
        crowning_mm: float = 0.0

    @dataclass
    class Model:
        lead: Lead
        width_mm: float = 40.0

        def factors(self, loads: Any) -> np.ndarray:
            off = (self.lead.crowning_mm - best) ** 2 * 1e4
            return np.array([1.0 + off, 1.0])

    model: Any = Model(Lead())
    given: Any = Made(force_n=np.array([100.0, 10.0]), stiffness_n_mm2=np.array([200.0, 200.0]))
    found, load = face_load.best_fall_mm(model, given, np.array([100.0, 5.0]), Lead)
    assert found == pytest.approx(best, abs=face_load.RESOLVED_MM)
    assert load == pytest.approx(100.0, rel=1e-3)


@pytest.mark.judges("strength")
def test_a_given_share_of_vibration_presses_all_sections_of_a_position() -> None:
    """K_V of 1.5 at one position: half of its 40 N by their even shares, over what each contact bears."""
    contacts: Any = Made(
        position=np.array([3, 3, 5]),
        section=np.array([0, 1, 0]),
        force_n=np.array([30.0, 10.0, 8.0]),
        share=np.array([0.5, 0.5, 1.0]),
        phi1_rad=np.array([0.1, 0.1, 0.2]),
    )
    asked: list[Any] = []

    def factors(phi1: np.ndarray, force: np.ndarray, *_: Any) -> np.ndarray:
        asked.append((phi1.tolist(), force.tolist()))
        return np.array([1.5, 1.2])

    found = Vibration.of_contacts(Made(factors=factors), contacts, Made(), Made(dynamic_factor=None))
    assert asked == [([0.1, 0.2], [40.0, 8.0])]
    assert found == pytest.approx([1.0 + 0.5 * 20.0 / 30.0, 1.0 + 0.5 * 20.0 / 10.0, 1.2])
    given = Vibration.of_contacts(Made(factors=factors), contacts, Made(), Made(dynamic_factor=1.3))
    assert given.tolist() == [1.3] * 3


@pytest.mark.judges("strength")
def test_loads_of_a_way_out_go_on_with_those_of_the_way_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ways of 6 mm with places every 2 mm: the way back begins a step beyond the end, and mirrored."""

    @dataclass
    class Contacts:
        position: np.ndarray
        names: list[str]

        @staticmethod
        def joined(parts: Any) -> Contacts:
            return Contacts(
                np.concatenate([one.position for one in parts]), [name for one in parts for name in one.names]
            )

        def kept(self, rows: Any) -> Contacts:
            names = np.array(self.names)[rows].tolist()
            return Contacts(self.position[rows], names)

    @dataclass
    class Way:
        contacts: Contacts
        between: Any
        rolled_mm: np.ndarray
        cycle_mm: float
        phi1_rad: np.ndarray
        torque_n_mm: np.ndarray
        error_rad: np.ndarray
        even: np.ndarray
        transmission_error_rad: float

    monkeypatch.setattr(loading, "LoadedContacts", Contacts)
    places = np.array([0.0, 2.0, 4.0, 6.0])

    def way(name: str, error: float) -> Any:
        def between(rolled: np.ndarray) -> Contacts:
            return Contacts(np.arange(rolled.size), [f"{name}{place:g}" for place in rolled])

        numbers = np.arange(4.0)
        names = [f"{name}{number}" for number in range(4)]
        contacts = Contacts(np.arange(4), names)
        values = numbers, 10.0 * numbers, error * numbers, numbers > 0
        return Way(contacts, between, places, 6.0, *values, error)

    found: Any = loading.out_and_back(way("o", 2.0), way("b", 3.0))
    assert found.rolled_mm.tolist() == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0]
    assert (found.cycle_mm, found.transmission_error_rad) == (14.0, 3.0)
    assert found.phi1_rad.tolist() == [0.0, 1.0, 2.0, 3.0, 3.0, 2.0, 1.0, 0.0]
    assert found.error_rad.tolist() == [0.0, 2.0, 4.0, 6.0, 9.0, 6.0, 3.0, 0.0]
    order = np.argsort(found.contacts.position)
    assert [found.contacts.names[row] for row in order] == ["o0", "o1", "o2", "o3", "b3", "b2", "b1", "b0"]
    assert sorted(found.contacts.position.tolist()) == list(range(8))
    there = found.between(np.array([1.0, 6.5, 7.5, 13.0]))
    assert there.names == ["o1", "o6", "b6", "b1"]
    assert there.position.tolist() == [0, 1, 2, 3]


@pytest.mark.judges("dynamics")
def test_peaks_of_loaded_teeth_are_between_the_places() -> None:
    """Parabolas with their greatest values 9, 0.02, 300 and errors of +4e-6 and -3e-6 rad at places of their own."""

    def at(phi1: np.ndarray) -> Any:
        def hill(top: float, place: float) -> np.ndarray:
            return top * (1.0 - 0.2 * (phi1 - place) ** 2)

        error = 4e-6 * np.exp(-((phi1 - 1.1) ** 2)) - 3e-6 * np.exp(-((phi1 - 2.1) ** 2) * 40.0)
        near = Made(lever_mm=np.full((1, 2), 30.0), stiffness=np.full((1, 2), 1e4))
        return Made(
            forces=Made(depth_mm=np.stack([hill(0.02, 1.33), np.full(phi1.size, -1.0)], axis=-1), near=near),
            error_rad=error,
            tooth_force_n=hill(9.0, 0.77),
            driving_torque_n_mm=hill(300.0, 2.22),
        )

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(quasi_static, "_depth_of_next_mm", lambda forces, pairs: np.full(len(forces.depth_mm), -1.0))
        found = quasi_static.loaded_peaks(at, np.linspace(0.0, 3.0, 31), 2)
    assert (found.tooth_force_n.value, found.tooth_force_n.at) == pytest.approx((9.0, 0.77), rel=1e-3)
    assert (found.depth_mm.value, found.depth_mm.at) == pytest.approx((0.02, 1.33), rel=1e-3)
    assert found.driving_torque_n_mm.value == pytest.approx(300.0, rel=1e-4)
    phi1 = np.linspace(0.0, 3.0, 30001)
    error = at(phi1).error_rad
    assert found.transmission_error_rad == pytest.approx(float(np.ptp(error)), rel=1e-3)
    assert found.most_pairs == 2


# --- whole machines and tolerances


@pytest.mark.judges("whole_machines")
def test_the_gap_of_a_limit_is_told_over_the_limit() -> None:
    of = ((60.0, 300.0), (50.0, 240.0), (90.0, None))
    machines = [Made(figures=Made(peak_power_w=power), cost=cost) for power, cost in of]
    given: Any = Made(machines=machines, of_machines=lambda: ["a"], power_w=lambda: 40.0)
    given.cost = lambda power: 5.0 * power
    found = limits.MachineLimits.found(given)
    assert [*vars(found).values()][:2] == [40.0, pytest.approx(0.25)]
    assert [*vars(found).values()][3:] == [200.0, pytest.approx(0.2)]
    given.power_w = lambda: 0.0
    assert [*vars(limits.MachineLimits.found(given)).values()][1] == inf


@pytest.mark.judges("whole_machines")
def test_the_least_cost_has_the_cheapest_material_and_process(monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import make_dataclass

    guess_of = make_dataclass("Guess", ["peak_power_w", "peak_torque_n_m", "volume"])
    monkeypatch.setattr(limits, "guessed_figures", lambda law, wheel, volume, speed: guess_of(0.0, 0.0, volume + wheel))
    monkeypatch.setattr(limits, "motor_for", lambda choices, guess: guess.peak_torque_n_m)
    monkeypatch.setattr(limits, "cost_of", lambda choices, guess, motor, _, by: by * guess.volume + motor)
    given: Any = Made(laws=[Made(found=None)], task=Made(speed_rad_s=4.0))
    choices: Any = Made(materials=[Made(cost_factor=2.0), Made(cost_factor=0.5)], processes=[3.0, 2.0])
    assert limits.MachineLimits._cost(given, choices, 100.0, 7.0, 60.0) == pytest.approx(2.0 * (30.0 + 7.0) + 25.0)


@pytest.mark.judges("tolerances")
def test_errors_of_the_linear_mesh_are_lengths_along_the_normals() -> None:
    """Leads of 2 d and 2.1 d rad on arms of 30 and 40 mm, beside leads of chords that do not count."""
    rows = np.array([0, 2])

    @dataclass
    class Deviations:
        off_mm: np.ndarray

    mesh = Made(
        arm_mm=np.array([[30.0, 1.0, 40.0]] * 2),
        leads=lambda one: np.full((2, 3, 1), 0.5) + 2.1 * one.off_mm[None, None],
    )
    exact: Any = Made(rows=rows, mesh=mesh, leads=lambda one: np.full((2, 2), 0.7) + 2.0 * one.off_mm)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(outlines, "Deviations", Deviations)
        found = outlines.linear_errors(exact, [Deviations(np.array([0.01])), Deviations(np.array([-0.03]))])
    assert [one.displaced_mm for one in found] == pytest.approx([0.8, 2.4])
    assert [one.error_mm for one in found] == pytest.approx([0.04, 0.12])


# --- motion


@pytest.mark.judges("kinematics")
@at_once(
    ("cycle", "repeats", "end", "count"),
    [
        (2.0 * pi, True, 2.0 * pi, 2001),
        (4.0 * pi, True, 4.0 * pi, 4001),
        (pi, True, 2.0 * pi, 2001),
        (1.2, False, 1.2, 2001),
        (3.0 * pi, True, 3.0 * pi, 3001),
    ],
)
def test_places_of_a_motion_are_two_thousand_a_turn(cycle: float, repeats: bool, end: float, count: int) -> None:
    angles = sample_angles(Made(lobes=Made(repeats=repeats), cycle_rad=cycle))
    assert (angles[0], angles[-1], angles.size) == (0.0, pytest.approx(end), count)


@pytest.mark.judges("mechanisms")
@pytest.mark.parametrize("side", [1, -1])
def test_a_coupler_keeps_its_angle_without_jumps_from_the_retracted_end_on(side: int) -> None:
    """Its own x axis leads from the crank pin to the rocker's, and it begins opposite to the crank."""
    rocker = CrankRocker(40.0, 100.0, 80.0, 110.0, side)
    angles = np.linspace(0.0, 2.0 * pi, 41)
    links = rocker.links(Jet(angles[None]))
    coupler, end = links["coupler"], links["rocker"].origin
    along = (end.x.value - coupler.origin.x.value) + 1j * (end.y.value - coupler.origin.y.value)
    turned = coupler.angle.value
    assert np.abs(along) == pytest.approx(np.full(41, 100.0))
    assert np.exp(1j * turned) == pytest.approx(along / 100.0)
    assert np.abs(np.diff(turned)).max() < 1.0
    assert turned[0] == pytest.approx(rocker.crank_start_rad - pi)
    assert turned[-1] == pytest.approx(turned[0])


@pytest.mark.judges("mechanisms")
def test_a_flat_stretch_beside_a_steep_one_has_no_turns() -> None:
    """Flat up to 50 mm but for a slope that is rounding beside the slope of 1000 N/mm behind; then a bump at 80 mm."""
    force = FormulaResistance("1e-16*(x - 25)**2 if x < 50 else 1000*(x - 50)*(110 - x)/60", "resistance.formula")
    turns = force.turns_mm(100.0)
    assert np.round(turns, 6).tolist() == [50.0, 80.0]
