"""What stands around the gears, against closed forms, published figures, another way of solving, and energy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import acos, asin, atan, cos, degrees, pi, radians, sin, sqrt, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import simpson, solve_ivp
from scipy.optimize import brentq

from at_once import at_once
from commands import Run, on_text, simulated
from drives import drive, drive_of_text
from ncgear.design.keys.drivetrain import DrivingShaft
from ncgear.drivetrain.bearings import (
    Bearing,
    Seats,
    WantedLife,
    bearing_forces,
    bending_moment_n_mm,
    bending_places_mm,
    combined_n,
    equivalent_load_n,
    gear_sides_mm,
    life_h,
    most_bent,
    rating_for_n,
)
from ncgear.drivetrain.cycle import Cycle, GearLoads, ShaftLoads, cycle_of, shafts_of, with_knocks
from ncgear.drivetrain.losses import Demand, TouchingTeeth, losses_of, mesh_loss_factor, most_mesh_loss_factor
from ncgear.drivetrain.motor import Gearbox, StraightLine, motor_load, stall_of
from ncgear.drivetrain.peaks import shaft_peaks
from ncgear.drivetrain.pto import Excursion, running_ahead, slipping
from ncgear.drivetrain.shafts import (
    KNOWN,
    STEELS,
    TEMPERED,
    BentShaft,
    ShaftKey,
    ShaftSafety,
    ShaftSection,
    Steel,
    fatigue_strengths_mpa,
    key_safety,
    shaft_safety,
)
from ncgear.drivetrain.speed import LineDrive, disc, speed_course
from ncgear.dynamics.mesh_force import MeshForce, MeshPlace, mesh_force
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.highest import hull_of_each
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import gauss_points
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project.drive import Drive
from ncgear.project.drivetrain import DrivetrainResult
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes

DESIGN = "baler-drivetrain"

# Bearings


def test_reliability_factors_are_those_of_the_standard() -> None:
    """ISO 281:2007, table 12 (secondary source), given to two digits."""
    table = {90: 1.0, 95: 0.64, 96: 0.55, 97: 0.47, 98: 0.37, 99: 0.25, 99.2: 0.22, 99.6: 0.16, 99.9: 0.093}
    for reliability, factor in table.items():
        assert WantedLife(1.0, reliability).factor == pytest.approx(factor, abs=0.0051)


@pytest.mark.judges("drivetrain")
@pytest.mark.parametrize(("kind", "exponent"), [("ball", 3.0), ("roller", 10.0 / 3.0)])
def test_life_under_constant_load(kind: str, exponent: float) -> None:
    """A tenth of the rating: 10^p million turns; and the rating that this life needs is the one it has."""
    hours = 1e6 * 10.0**exponent / (60.0 * 1500.0)
    speed = 1500.0 * pi / 30.0
    assert life_h(20_000.0, 2_000.0, kind, speed) == pytest.approx(hours, rel=1e-12)
    assert rating_for_n(2_000.0, kind, speed, WantedLife(hours, 90.0)) == pytest.approx(20_000.0, rel=1e-12)
    assert rating_for_n(2_000.0, kind, speed, WantedLife(hours, 99.0)) > 30_000.0


def test_equivalent_loads_in_closed_form() -> None:
    """Constant; a sine of either sign, whose mean cube is 4/(3 pi); a ramp from 0, mean of x^p is 1/(p + 1)."""
    turned, weight = gauss_points(np.linspace(0.0, 2.0 * pi, 9), 24)
    assert equivalent_load_n(np.full(turned.shape, 7.0), weight, 3.0) == pytest.approx(7.0, rel=1e-14)
    sine = equivalent_load_n(np.abs(np.sin(turned)), weight, 3.0)
    assert sine == pytest.approx((4.0 / (3.0 * pi)) ** (1.0 / 3.0), rel=1e-12)
    ramp = equivalent_load_n(turned / (2.0 * pi), weight, 10.0 / 3.0)
    assert ramp == pytest.approx((1.0 / (10.0 / 3.0 + 1.0)) ** 0.3, rel=1e-9)
    assert equivalent_load_n(np.zeros(3), np.ones(3), 3.0) == 0.0


def bending(loads: ShaftLoads, seats: Seats) -> dict[float, float]:
    """The largest bending at each place along a shaft, at any of the driving angles of its loads."""
    return {at: float(np.abs(bending_moment_n_mm(loads, seats, at)).max()) for at in bending_places_mm(loads, seats)}


def test_two_bearings_by_moments() -> None:
    """A gear between them, a crank beyond one, in two directions; forces and moments are in balance by hand."""
    idle = np.zeros(1)
    loads = ShaftLoads(idle, idle, (GearLoads(np.array([1000.0 + 0j]), idle, idle, 0j * idle),), np.array([600.0j]))
    seats = Seats((Bearing(-100.0, "ball"), Bearing(300.0, "ball")), crank_at_mm=500.0)
    on_first, on_second = (force[0] for force in bearing_forces(loads, seats))
    # Moments about the first: 1000 * 100 / 400, and 600 * 600 / 400
    assert on_second == pytest.approx(250.0 + 900.0j, rel=1e-14)
    assert on_first == pytest.approx(750.0 - 300.0j, rel=1e-14)
    # Bending at the gear: the first bearing's force times 100 mm; at the second, the crank's times 200 mm
    assert abs(bending_moment_n_mm(loads, seats, 0.0)[0]) == pytest.approx(abs(on_first) * 100.0, rel=1e-13)
    assert abs(bending_moment_n_mm(loads, seats, 300.0)[0]) == pytest.approx(600.0 * 200.0, rel=1e-13)
    # Nothing presses beyond the outermost places, and rounding errors of what is within them are not told
    assert bending_moment_n_mm(loads, seats, -100.0)[0] == bending_moment_n_mm(loads, seats, 500.0)
    assert bending_moment_n_mm(loads, seats, 500.0)[0] == 0.0
    beside = Seats((Bearing(20.0, "ball"), Bearing(22.0, "ball")))
    assert bending_moment_n_mm(loads, beside, 0.0)[0] == 0.0
    bent = most_bent(bending(loads, seats), seats)
    assert (bent.moment_n_mm, bent.at_mm) == pytest.approx((600.0 * 200.0, 300.0), rel=1e-13)


# Thrust of helical teeth


HELICAL = MeshPlace(210.0, radians(20.0), Mesh.EXTERNAL, radians(150.0), thrust_share=-tan(radians(15.0)))
"""A right-hand driving gear."""


def of_helical(torque_n_mm: float, slope: float = 0.75, leaning: float = 0.4) -> tuple[MeshForce, Array]:
    """The mesh force of HELICAL, and dphi2/dphi1, at a place where the pitch curves lean from their circles."""
    force = mesh_force(HELICAL, Jet(np.array([[slope], [leaning]])), Jet(np.array([[torque_n_mm]])))
    return force, np.array([slope])


@pytest.mark.judges("drivetrain")
@pytest.mark.parametrize("torque_n_mm", [8e5, -8e5])
def test_bearings_of_helical_teeth_are_in_balance_in_space(torque_n_mm: float) -> None:
    """Six equations for each shaft: cross products of forces at the pitch point, the crank and two bearings."""
    force, slope = of_helical(torque_n_mm)
    crank_n, idle, at_mm, crank_at_mm = np.array([900.0 - 4000.0j]), np.zeros(1), (-90.0, 140.0), 260.0
    angles = Jet.variable(idle, 1), Jet(np.stack([idle, slope]))
    shafts = shafts_of([HELICAL], [force], angles, [(idle, idle)], crank_n)
    seats = Seats((Bearing(at_mm[0], "ball"), Bearing(at_mm[1], "ball")), crank_at_mm=crank_at_mm)
    towards = np.array([cos(radians(150.0)), sin(radians(150.0)), 0.0])
    across = np.array([force.force.x.value[0], force.force.y.value[0], 0.0])
    whole = across + np.array([0.0, 0.0, force.thrust_n.value[0]])
    radius = 210.0 / (1.0 + slope[0])
    # The driven gear turns clockwise under a torque over 0, about its own axis; only it has a crank.
    assert np.cross(towards * radius, whole)[2] == pytest.approx(-torque_n_mm, rel=1e-12)
    for shaft, point, pressing in zip(
        shafts, (towards * (radius - 210.0), towards * radius), (-whole, whole), strict=True
    ):
        crank = np.array([shaft.crank_n[0].real, shaft.crank_n[0].imag, 0.0])
        borne = bearing_forces(shaft, seats)
        bearings = [-np.array([one[0].real, one[0].imag, 0.0]) for one in borne]
        assert pressing + crank + sum(bearings) == pytest.approx([0.0, 0.0, pressing[2]], abs=1e-9)
        moments = np.cross(point, pressing) + np.cross([0.0, 0.0, crank_at_mm], crank)
        moments += sum(np.cross([0.0, 0.0, at], one) for at, one in zip(at_mm, bearings, strict=True))
        assert moments[:2] == pytest.approx([0.0, 0.0], abs=1e-6)
        assert shaft.thrust_n[0] == pressing[2]
        # Beside the gear the shaft is bent by what stands beyond: here by its first bearing alone, or by all but that.
        before, behind = (bending_moment_n_mm(shaft, seats, one) for one in gear_sides_mm(shaft))
        assert before == pytest.approx(-borne[0] * 90.0, rel=1e-9)
        assert abs(behind - before)[0] == pytest.approx(np.hypot(*np.cross(point, pressing)[:2]), rel=1e-9)


def test_thrust_does_no_work_along_the_helix_of_circular_gears() -> None:
    """A left-hand driven gear that is screwed along its own helix keeps its flanks in place: F dz = T dz tan(b) / r."""
    for torque_n_mm in (8e5, -8e5):
        force, slope = of_helical(torque_n_mm, leaning=0.0)
        way_mm = tan(radians(15.0)) / (HELICAL.center_distance_mm / (1.0 + slope[0]))
        assert force.thrust_n.value[0] == pytest.approx(-torque_n_mm * way_mm, rel=1e-12)


def along(bearing: Bearing, across_n: float, along_n: float) -> tuple[float, float]:
    found = combined_n(replace(bearing, bears_thrust=True), np.array([across_n]), np.array([along_n]))
    return float(found[0][0]), float(found[1][0])


@pytest.mark.judges("drivetrain")
def test_published_loads_of_bearings_with_thrust() -> None:
    """Shigley, example 11-4: 6210, 500 lbf across, 400 lbf along, C_0 = 4450 lbf: 890.8 lbf by Y = 1.527."""
    groove = Bearing(0.0, "ball", static_rating_n=4450.0)
    assert along(groove, 500.0, 400.0)[0] == pytest.approx(890.8, rel=1e-3)
    # Little thrust counts nothing, and a bearing that gives way along the shaft bears none.
    assert along(groove, 500.0, 100.0) == (500.0, 500.0)
    assert combined_n(groove, np.array([500.0]), np.array([400.0]))[0][0] == 500.0
    assert along(groove, 500.0, 1000.0)[1] == pytest.approx(0.6 * 500.0 + 0.5 * 1000.0)
    # SKF 22220 E: e = 0.24, Y_1 = 2.8, Y_2 = 4.2, Y_0 = 2.8, of two digits each; e is 1.5 tan of the angle.
    roller = Bearing(0.0, "roller", contact_angle_deg=degrees(atan(0.24 / 1.5)))
    assert along(roller, 1000.0, 200.0)[0] == pytest.approx(1000.0 + 2.8 * 200.0, rel=5e-3)
    assert along(roller, 1000.0, 500.0)[0] == pytest.approx(670.0 + 4.2 * 500.0, rel=5e-3)
    assert along(roller, 1000.0, 500.0)[1] == pytest.approx(1000.0 + 2.8 * 500.0, rel=2e-2)


@pytest.mark.parametrize("kind", ["ball", "roller"])
@pytest.mark.parametrize("angle_deg", [20.0, 27.0, 40.0])
def test_loads_of_bearings_with_thrust_do_not_leap(kind: str, angle_deg: float) -> None:
    """Both terms meet at the standard's limit e, 1.5 tan of the angle for two rows of rollers."""
    limits = {20.0: 0.57, 27.0: 0.73, 40.0: 1.14}
    limit = 1.5 * tan(radians(angle_deg)) if kind == "roller" else limits[angle_deg]
    bearing = Bearing(0.0, kind, contact_angle_deg=angle_deg)
    little, much = (along(bearing, 1000.0, limit * 1000.0 * share)[0] for share in (0.98, 1.02))
    assert 0.0 < much / little - 1.0 < 0.04


# Shafts and keys


TURN = np.linspace(0.0, 2.0 * pi, 721)


def bent_by(
    moment_n_mm: Callable[[Array], ComplexArray],
    torque_n_mm: float = 0.0,
    places: Array = TURN,
    turns_rad: tuple[float, ...] = (0.0,),
) -> BentShaft:
    """A shaft that turns with the driving angle, its moment by that angle, in cycles that begin after ``turns_rad``."""

    def seen(phi1: Array) -> ComplexArray:
        return (moment_n_mm(phi1) * np.exp(-1j * phi1))[None]

    most = float(np.abs(seen(places)).max())
    (hull,) = hull_of_each(seen, places, seen(places), np.array([KNOWN * most]))
    return BentShaft(np.outer(np.exp(-1j * np.array(turns_rad)), hull).ravel(), most, (torque_n_mm, torque_n_mm))


def test_published_example_of_a_shaft_with_a_keyway() -> None:
    """A course's example (MEL1 2024W 2, public repository hanslhansl/din743): safeties 1.472 and 2.568."""
    section = ShaftSection(60.0, 80.0, Steel(750.0, 520.0, *TEMPERED))

    def safety(share: float) -> ShaftSafety:
        shaft = bent_by(lambda phi1: np.full(phi1.shape, share * 1402.294e3 + 0j), share * 1336.902e3)
        return shaft_safety(section, shaft)

    assert safety(1.0).fatigue == pytest.approx(1.472, abs=5e-4)
    assert safety(1.8).yielding == pytest.approx(2.568, abs=5e-4)


def test_fibres_see_what_turns_against_them() -> None:
    """A force that stands still bends to and fro; one that turns with the shaft bends one way; a smaller shaft less."""
    standing = bent_by(lambda phi1: np.full(phi1.shape, 1e6 + 0j))
    section = ShaftSection(50.0, 50.0, STEELS["C45"])
    still = shaft_safety(section, standing)
    stress = 1e6 / (pi * 50.0**3 / 32.0)
    assert still.stresses.bending_amplitude_mpa == pytest.approx(stress, rel=2e-6)
    assert still.stresses.bending_mean_mpa == pytest.approx(0.0, abs=2e-6 * stress)
    along = shaft_safety(section, bent_by(lambda phi1: 1e6 * np.exp(1j * phi1)))
    assert along.stresses.bending_amplitude_mpa == pytest.approx(0.0, abs=1e-9 * stress)
    assert along.fatigue > 3.0 * still.fatigue
    thinner = shaft_safety(ShaftSection(25.0, 50.0, STEELS["C45"]), standing)
    # Eight times the stress, but thin shafts endure more of it
    assert 7.0 < still.fatigue / thinner.fatigue < 8.0


def test_a_shaft_that_needs_two_turns_sees_both() -> None:
    """A pull once in two turns, half a turn on: the same fibre is pulled, then pressed, only if both are followed."""
    turned, section = np.linspace(0.0, pi, 361), ShaftSection(50.0, 50.0, STEELS["C45"])

    def pull(phi1: Array) -> ComplexArray:
        return np.where(phi1 < 0.1, 1e6 + 0j, 0j)

    once = shaft_safety(section, bent_by(pull, 0.0, turned))
    both = shaft_safety(section, bent_by(pull, 0.0, turned, (0.0, pi)))
    assert both.stresses.bending_amplitude_mpa == pytest.approx(2.0 * once.stresses.bending_amplitude_mpa, rel=1e-6)


def test_the_worst_fibre_and_its_stresses_lie_between_places() -> None:
    """Eight places over a turn: every fibre sees one amplitude, that at 2 rad, or opposite, the largest mean."""
    places, section = np.linspace(0.0, 2.0 * pi, 9), ShaftSection(50.0, 50.0, STEELS["C45"])

    def moment(phi1: Array) -> ComplexArray:
        # In the shaft's frame a circle about a point beside its axis
        return np.asarray(1e6 * np.exp(1j * phi1) * (np.exp(-1j * phi1) + 0.2 * np.exp(2.0j)))

    found = shaft_safety(section, bent_by(moment, 0.0, places)).stresses
    stress = 1e6 / (pi * 50.0**3 / 32.0)
    assert found.bending_amplitude_mpa == pytest.approx(stress, rel=2e-6)
    assert abs(found.bending_mean_mpa) == pytest.approx(0.2 * stress, rel=1e-5)
    # The places alone see no more of it than this
    assert np.real(np.exp(-1j * (places - 2.0))).max() < 0.99


@pytest.mark.slow
@pytest.mark.parametrize("gear", Gear)
def test_forces_and_stresses_of_shafts_against_many_more_places(gear: Gear) -> None:
    """Nothing at other places, nor at 721 fibres, is beyond what is told, the teeth's knocks counted.

    Knocks peak at a place; the places here are 63 millionths of a radian apart, and find them to 0.3 %.
    """
    knocking, around = drive(DESIGN).knocking, drive(DESIGN).design.drivetrain
    assert knocking is not None
    of_cycle = with_knocks(whole().demand.cycle, knocking)
    number = list(Gear).index(gear)
    found = whole().shafts[number]
    assert around is not None
    assert around.driven_shaft is not None
    assert found is not None
    assert found.bearings is not None
    assert found.most_bent is not None
    assert found.shaft is not None
    loads = of_cycle.loads_at(np.linspace(of_cycle.breaks_rad[0], of_cycle.breaks_rad[-1], 100_001)).shafts[number]
    both = found.bearings[0].bearing, found.bearings[1].bearing
    seats = Seats(both, crank_at_mm=0.0 if gear is Gear.DRIVING else around.driven_shaft.crank_at_mm)
    for one, force in zip(found.bearings, bearing_forces(loads, seats), strict=True):
        assert 0.997 < np.abs(force).max() / one.largest_n.value < 1.0 + 1e-9
    assert 0.997 < most_bent(bending(loads, seats), seats).moment_n_mm / found.most_bent.moment_n_mm < 1.0 + 1e-9
    section, stresses = found.shaft.section, found.shaft.stresses
    resistance = pi * section.diameter_mm**3 / 32.0
    torsion = np.abs(loads.gears[0].torque_n_mm).max() / (2.0 * resistance)
    assert 0.997 < torsion / (abs(stresses.torsion_mean_mpa) + stresses.torsion_amplitude_mpa) < 1.0 + 1e-9
    once = of_cycle.cycle_rad if gear is Gear.DRIVING else 2.0 * pi
    assert once == pytest.approx(2.0 * pi)  # each cycle sees the shaft as the one before
    turning = bending_moment_n_mm(loads, seats, 0.0) / resistance * np.exp(-1j * loads.turned_rad)
    most = 0.0
    for fibre in np.linspace(0.0, 2.0 * pi, 721):
        seen = np.real(turning * np.exp(1j * fibre))
        lasting = np.hypot((seen.max() + seen.min()) / 2.0, sqrt(3.0) * stresses.torsion_mean_mpa)
        terms = zip(
            fatigue_strengths_mpa(section),
            (np.ptp(seen) / 2.0, stresses.torsion_amplitude_mpa),
            (lasting, lasting / sqrt(3.0)),
            strict=True,
        )
        used = [a / s + m / (2.0 * section.tensile_mpa - s) for s, a, m in terms]
        most = max(most, float(np.hypot(*used)))
    assert 1.0 - 2e-3 < most * found.shaft.fatigue < 1.0 + 2e-6


def test_a_key_in_closed_form() -> None:
    """p = 2 T / (d h l): 2 * 100 N m / (40 mm * 3.3 mm * 50 mm)."""
    found = key_safety(ShaftKey(40.0, 3.3, 50.0, 300.0, 50.0), 1e5, 0.0)
    assert found.pressure_mpa == pytest.approx(2e5 / 6600.0, rel=1e-14)
    assert found.safety == pytest.approx(270.0 / found.pressure_mpa, rel=1e-14)
    assert not found.both_senses


def test_a_hundredth_of_the_torque_in_the_other_sense_swells_and_counts_in_full() -> None:
    """Of 100 N m, 0.9 N m against them are borne like 100.9 N m; 1.1 N m let the key work in its way."""
    key = ShaftKey(40.0, 3.3, 50.0, 300.0, 50.0)
    for most, least in ((1e5, -900.0), (900.0, -1e5)):
        found = key_safety(key, most, least)
        assert not found.both_senses
        assert found.pressure_mpa == pytest.approx(2.0 * 100_900.0 / 6600.0, rel=1e-14)
    for most, least in ((1e5, -1100.0), (1100.0, -1e5)):
        assert key_safety(key, most, least).both_senses
    assert not key_safety(key, 0.0, 0.0).both_senses


# Losses


def circular(teeth: int) -> TouchingTeeth:
    made = drive_of_text(
        "{name: even, linkage: {crank_mm: 40, rod_mm: 90}, operation: {speed_rpm: 30}, motion: {law: uniform_crank}, "
        f"gears: {{teeth: {teeth}, module_mm: 2, face_width_mm: 10}}}}"
    )
    return TouchingTeeth(made.teeth, made.pitch, made.designed_contact)


def even_torques(ratio: float) -> tuple[object, Array]:
    return lambda phi1: (np.full(phi1.shape, 5.0), np.full(phi1.shape, 5.0 * ratio)), np.array([0.0, 2.0 * pi])


@pytest.mark.tiers(quick=["23"], rest="slow")
@pytest.mark.parametrize("teeth", [23, 62])
def test_loss_factor_of_circular_gears_is_ohlendorfs(teeth: int) -> None:
    """His closed form, with the contact ratios of equal involute gears of full height."""
    tip, base = teeth + 2.0, teeth * cos(radians(20.0))
    half = (sqrt(tip**2 - base**2) - teeth * sin(radians(20.0))) / (2.0 * pi * cos(radians(20.0)))
    closed = pi * (2.0 / teeth) * (1.0 - 2.0 * half + 2.0 * half**2)
    torques, breaks = even_torques(1.0)
    found = mesh_loss_factor(circular(teeth), torques, breaks)  # type: ignore[arg-type]
    assert found == pytest.approx(closed, rel=2e-6)
    # Negative control: with every pair bearing all of the load it would be far more
    assert found < 0.8 * pi * (2.0 / teeth) * 2.0 * half**2 * 2.0


def test_a_bound_of_the_loss_factor_without_teeth() -> None:
    """Of circular gears (1 + q)^2 / q of the greatest distance over a cos(alpha), or (1 - q)^2 / q inside a ring."""
    for lobes in (Lobes(1, 2), Lobes(2, 1)):
        pitch = sized_pair(uniform_law(lobes), 20, 2.0, None)
        wanted = 3.0 * 4.5 / (pitch.center_distance_mm * cos(radians(20.0)))
        assert most_mesh_loss_factor(pitch, 3.0, radians(20.0)) == pytest.approx(wanted, rel=1e-9)
    ring: Any = SimpleNamespace(
        mesh=Mesh.INTERNAL,
        center_distance_mm=20.0,
        transmission=uniform_law(Lobes(1, 2)),
        largest_pressure_angle_deg=degrees,
    )
    assert most_mesh_loss_factor(ring, 3.0, radians(20.0)) == pytest.approx(3.0 * 0.5 / (20.0 * cos(radians(20.0))))


@pytest.mark.slow
def test_loss_factor_of_the_fzg_test_gears() -> None:
    """Type C: 16/24 teeth, module 4.5, 91.5 mm, tips 82.46 and 118.36 mm; published contact ratio 1.44, H_V 0.195."""
    angle, module = degrees(acos(4.5 * cos(radians(20.0)) * 20.0 / 91.5)), 91.5 / 20.0
    first, second = (82.46 / 2.0 - 36.6) / module, (118.36 / 2.0 - 54.9) / module
    made = drive_of_text(
        f"""\
name: fzg
linkage: {{crank_mm: 40, rod_mm: 90}}
operation: {{speed_rpm: 30}}
motion: {{law: ratio_expression, ratio: "1.5"}}
gears:
  {{teeth: 16, center_distance_mm: 91.5, face_width_mm: 14, lobes: {{driving: 2, driven: 3}}, undercut: allow,
    rack: {{pressure_angle_deg: {angle}, addendum: {(first + second) / 2.0}, root_radius: 0.2, dedendum: 1.2}},
    profile_shift: {{driving: {(first - second) / 2.0}, driven: {(second - first) / 2.0}}}}}
"""
    )
    assert made.designed_contact.contact_ratio == pytest.approx(1.44, abs=0.005)
    torques, breaks = even_torques(1.5)
    touching = TouchingTeeth(made.teeth, made.pitch, made.designed_contact)
    assert mesh_loss_factor(touching, torques, breaks) == pytest.approx(0.195, abs=5e-4)  # type: ignore[arg-type]


# The cycle and what it asks for


@cache
def cycle() -> Cycle:
    return cycle_of(drive(DESIGN).rigid)


@cache
def rubbing_at(guide_friction: float) -> Cycle:
    """The cycle of the design with another coefficient of friction in the guide."""
    given = drive(DESIGN).design
    assert given.drivetrain is not None
    around = given.drivetrain.model_copy(update={"guide_friction": guide_friction})
    return cycle_of(Drive(given.model_copy(update={"drivetrain": around})).rigid)


@cache
def demand(added_kg_mm2: float = 0.0, *, friction: bool = True) -> Demand:
    if not friction:
        return Demand(rubbing_at(0.0), losses_of(rubbing_at(0.0), (), 0.0), added_kg_mm2)
    return Demand(cycle(), losses_of(cycle(), (0.12,), 0.05), added_kg_mm2)


SMALL = """\
name: small
linkage: {crank_mm: 60, rod_mm: 150}
operation: {speed_rpm: 120}
motion: {law: harmonic_ratio, cosine: [0.2], sine: [-0.1]}
resistance: {polynomial_n: [300, 2]}
gears: {teeth: 40, module_mm: 2, face_width_mm: 10}
masses:
  slider_kg: 4
  rod: {mass_kg: 1, center_mm: 70, inertia_kg_mm2: 2000}
  crank: {mass_kg: 1, center_mm: 20, inertia_kg_mm2: 900}
  driving_gear_kg_mm2: 500
  driven_gear_kg_mm2: 700
"""
"""A machine without teeth that rub: it stands in a hundredth of the time of the shipped one."""


@cache
def small_drive() -> Drive:
    return drive_of_text(SMALL)


@cache
def small(added_kg_mm2: float = 0.0) -> Demand:
    one = cycle_of(small_drive().rigid)
    return Demand(one, losses_of(one, (), 0.0), added_kg_mm2)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.1, 0.5])
def test_friction_in_the_guide_takes_its_work_and_leaves_the_useful_one(friction: float) -> None:
    """What the motor gives more is mu |N| of the way, by forces that count friction: so the rest stays the same."""
    smooth, rough = rubbing_at(0.0), rubbing_at(friction)
    resistance = smooth.integral(smooth.loads.driving_torque_n_mm)
    assert losses_of(rough, (), 0.0).useful_n_mm == pytest.approx(resistance, rel=1e-10)
    assert rough.integral(rough.loads.driving_torque_n_mm) > (1.0 + 0.8 * friction) * resistance
    # Negative control: the forces of a smooth guide take less work than is lost.
    lost = friction * smooth.integral(np.abs(smooth.loads.guide_n * smooth.loads.way_mm))
    assert losses_of(rough, (), 0.0).guide_n_mm > (1.0 + 0.1 * friction) * lost


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.1, 0.5])
def test_friction_in_the_guide_holds_by_newtons_law_for_the_slider(friction: float) -> None:
    """Along its line the slider bears rod, load and mu |N| against its motion, across it guide and weight."""
    found = rubbing_at(friction)
    # Not at its dead centres, where its motion has no sense
    machine, phi1 = found.rigid, found.loads.phi1_rad[found.weight_rad > 0.0]
    loads, moved = machine.at(phi1), machine.machine.motion(phi1)
    wrist, masses = loads.joints["wrist"], machine.masses
    resisting = np.sign(moved.velocity) * (moved.load + friction * np.abs(loads.guide.value))
    along = wrist.x.value + masses.slider_kg * masses.gravity_m_s2[0] - resisting
    assert_allclose(along, 1e-3 * masses.slider_kg * moved.acceleration, atol=1e-8 * np.abs(wrist.x.value).max())
    across = wrist.y.value + loads.guide.value + masses.slider_kg * masses.gravity_m_s2[1]
    assert_allclose(across, 0.0, atol=1e-8 * np.abs(wrist.x.value).max())


@pytest.mark.long
@pytest.mark.slow
def test_a_key_and_the_teeth_bear_what_the_motor_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    """The key on the driving shaft bears the greatest torque that the motor implies, and the teeth rub with it."""
    monkeypatch.setattr(Drive, "knocking", None)
    given = drive(DESIGN).design
    assert given.drivetrain is not None
    found = {}
    for friction in (0.0, 0.5):
        around = given.drivetrain.model_copy(update={"guide_friction": friction})
        one = Drive(given.model_copy(update={"drivetrain": around}))
        shaft, most = one.drivetrain.shafts[0], one.drivetrain.demand.torque_range_n_mm[1].value
        assert shaft is not None
        assert shaft.key is not None
        made = shaft.key.key
        # Twice the torque over the diameter presses on half the key's height.
        exact = 2.0 * most / made.diameter_mm / (made.height_mm * made.length_mm)
        assert shaft.key.pressure_mpa == pytest.approx(exact, rel=2e-3)
        assert shaft.bearings is not None
        found[friction] = most, shaft.bearings[0].largest_n.value, one.tooth_load.peak_n
    assert all(more > 1.02 * less for less, more in zip(*found.values(), strict=True))


def test_a_slider_that_jams_in_its_guide_is_refused() -> None:
    """A crank nearly as long as its rod leans the rod by up to 59 deg: tan 59 deg times 0.9 is over 1."""
    text = (
        "name: jam\nlinkage: {crank_mm: 60, rod_mm: 70}\noperation: {speed_rpm: 30}\nmotion: {law: uniform_crank}\n"
        "resistance: {polynomial_n: [100]}\ngears: {teeth: 40, module_mm: 2, face_width_mm: 10}\n"
        "masses:\n  slider_kg: 1\n  rod: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}\n"
        "  crank: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}\n"
        "drivetrain: {guide_friction: FRICTION}\n"
    )
    # Out from theta = pi to 0 the slider bears load and inertia F, and mu |N| against it: N = (F + mu |N|) tan(lean).
    theta, turns = np.linspace(pi, 0.0, 20_001), 30.0 * pi / 30.0
    sine, cosine = np.sin(theta), np.cos(theta)
    root = np.sqrt(70.0**2 - (60.0 * sine) ** 2)
    way = 60.0 * sine * (1.0 + 60.0 * cosine / root)
    slower = 60.0 * cosine + 3600.0 * (cosine**2 - sine**2) / root + (3600.0 * sine * cosine) ** 2 / root**3
    force = 100.0 - 1e-3 * slower * turns**2
    exact = float(np.max(1e-3 * turns * way * force / (1.0 - 0.4 * 60.0 * sine / root)))
    assert drive_of_text(text.replace("FRICTION", "0.4")).check.peak_power_w.value == pytest.approx(exact, rel=1e-6)
    with pytest.raises(NoSuchMechanism, match="jams in its guide") as told:
        _ = drive_of_text(text.replace("FRICTION", "0.9")).check
    assert told.value.key == "drivetrain.guide_friction"


every_machine = pytest.mark.parametrize("name", ["small", DESIGN])


def one_of(name: str) -> Demand:
    return small() if name == "small" else demand()


@pytest.mark.slow
@every_machine
def test_means_over_the_cycle_against_simpsons_rule(name: str) -> None:
    """Work of the shaft as of the rigid level; the mean cube of the mesh force by Simpson's rule."""
    found, rigid = one_of(name).cycle, (small_drive() if name == "small" else drive(DESIGN)).rigid
    assert found.integral(found.loads.driving_torque_n_mm) == pytest.approx(rigid.fluctuation.work_n_mm, rel=1e-12)
    size = np.abs(found.loads.shafts[1].gears[0].force_n)

    def cube(phi1: Array) -> Array:
        force = rigid.machine.at(phi1).mesh_force.force
        return np.asarray(np.hypot(force.x.value, force.y.value) / 1e4) ** 3

    # Ends of intervals are taken from inside: at joints of the law the force may jump
    inner = [np.linspace(low + 1e-9, high - 1e-9, 1201) for low, high in pairwise(found.breaks_rad)]
    summed = sum(simpson(cube(places), x=places) for places in inner)
    assert found.integral((size / 1e4) ** 3) == pytest.approx(summed, rel=1e-7)


@pytest.mark.tiers(quick=["small"], rest="slow")
@every_machine
def test_forces_on_the_crank_shaft_are_in_balance(name: str) -> None:
    """Gear, crank pin and bearings, anew from Newton's law for the crank's mass."""
    found, machine = one_of(name).cycle.loads, one_of(name).cycle.rigid
    loads, masses = machine.at(found.phi1_rad), machine.masses
    pin = loads.joints["pin"]
    angle = machine.machine.transmission.driven_angle(found.phi1_rad, 2)
    speed, bend = angle.derivative(1), angle.derivative(2)
    # The crank turns clockwise from the slider's way out; its centre of mass goes round with it
    radial = masses.crank_center_mm * np.exp(1j * (pi - angle.value))
    moving = 1e-3 * masses.crank_kg * machine.machine.speed_rad_s**2 * radial * (-(speed**2) - 1j * bend)
    weight = masses.crank_kg * complex(*masses.gravity_m_s2)
    on_crank = -(pin.x.value + 1j * pin.y.value)
    assert_allclose(found.shafts[1].crank_n, on_crank + weight - moving, atol=1e-9 * np.abs(on_crank).max())


@pytest.mark.tiers(quick=["small"], rest="slow")
@every_machine
def test_inertia_has_the_slope_that_it_says_and_the_energy_of_the_cycle(name: str) -> None:
    """Central differences; and T - A over the cycle does no work, for J comes back to where it was."""
    angles, step = np.array([0.4, 1.7, 3.3, 5.9]), 1e-5
    asked = one_of(name)
    slope = (asked.inertia(angles + step)[0] - asked.inertia(angles - step)[0]) / (2.0 * step)
    assert_allclose(asked.inertia(angles)[1], slope, rtol=1e-6)
    points = asked.cycle.loads.phi1_rad
    difference = asked.cycle.integral(asked.at_any_speed_n_mm(points) - asked.torque_n_mm(points))
    assert abs(difference) <= 1e-10 * asked.fluctuation.work_n_mm


@pytest.mark.slow
def test_the_energy_of_losses_is_the_work_that_is_asked_for_more() -> None:
    """To 1e-9: work with friction = useful work + teeth + guide; without friction there is no loss."""
    losses = demand().losses
    whole = losses.useful_n_mm + losses.mesh_n_mm + losses.guide_n_mm
    assert demand().fluctuation.work_n_mm == pytest.approx(whole, rel=1e-9)
    assert losses.efficiency == pytest.approx(losses.useful_n_mm / whole, rel=1e-12)
    assert demand(friction=False).losses.efficiency == 1.0


@pytest.mark.parametrize("gear", Gear)
def test_lives_count_by_the_angle_of_their_own_shaft(gear: Gear) -> None:
    """The equivalent load and speed of both bearings, by even steps of the driving angle and what each shaft turns."""
    found, number = small().cycle, list(Gear).index(gear)
    seats = Seats((Bearing(-30.0, "ball", 9000.0), Bearing(50.0, "roller", 9000.0)), crank_at_mm=80.0)
    lives = shaft_peaks(found, {number: seats}, WantedLife(1000.0, 90.0))[number].bearings
    places = np.unique(np.concatenate([np.linspace(*ends, 2001) for ends in pairwise(found.breaks_rad)]))
    middle = (places[1:] + places[:-1]) / 2.0
    turned = places if gear is Gear.DRIVING else found.rigid.machine.transmission.driven_angle(places, 0).value
    forces = bearing_forces(found.loads_at(middle).shafts[number], seats)
    for life, force, exponent in zip(lives, forces, (3.0, 10.0 / 3.0), strict=True):
        mean = (np.diff(turned) @ np.abs(force) ** exponent / (2.0 * pi)) ** (1.0 / exponent)
        assert life.equivalent_n == pytest.approx(mean, rel=1e-6)


# Motor


class Waveform(Demand):
    """A demand of known form, in place of a machine's: a mean torque and a sine, and an even inertia in N mm s^2."""

    def torque_n_mm(self, phi1_rad: Array) -> Array:
        return 200.0 + 500.0 * np.sin(phi1_rad)

    def inertia(self, phi1_rad: Array) -> tuple[Array, Array]:
        return np.full(phi1_rad.shape, 40.0), np.zeros(phi1_rad.shape)


def waveform() -> Waveform:
    return Waveform(small().cycle, small().losses)


def test_rms_of_a_known_waveform() -> None:
    """sqrt(200^2 + 500^2/2); it brakes where sin < -0.4, with the mean of that part, in closed form."""
    found = motor_load(waveform(), Gearbox())
    assert found.rms_n_mm == pytest.approx(sqrt(200.0**2 + 500.0**2 / 2.0), rel=1e-9)
    assert found.mean_n_mm == pytest.approx(200.0, rel=1e-9)
    assert (found.most_n_mm.value, found.least_n_mm.value) == pytest.approx((700.0, -300.0), rel=1e-9)
    lacks = acos(0.4)
    assert found.braking_share == pytest.approx(2.0 * lacks / (2.0 * pi), abs=2e-3)
    assert found.braking_n_mm == pytest.approx(200.0 - 500.0 * sin(lacks) / lacks, rel=2e-2)


def test_a_gearbox_takes_power_both_ways() -> None:
    """Driving, the motor gives more than the load takes; braking, it takes less than the load gives; and back."""
    box, torque = Gearbox(10.0, 0.9), np.array([90.0, -90.0, 0.0])
    assert_allclose(box.motor_n_mm(torque), [10.0, -8.1, 0.0], rtol=1e-14)
    assert_allclose(box.shaft_n_mm(box.motor_n_mm(torque)), torque, rtol=1e-14)


# Speed over the cycle

LINE = StraightLine(36e3 / 0.03, 1500.0 * pi / 30.0)
MOTOR = LineDrive(LINE, Gearbox(24.5, 0.95))


STEPS = 6000


def followed(asked: Demand, span: tuple[float, float], start: float, given: Callable[[float], float]) -> Array:
    """Speeds over a span by the equation of motion in w and the classical method of Runge and Kutta, even steps."""
    places = np.linspace(*span, 2 * STEPS + 1)
    inertia, change = asked.inertia(places % (2.0 * pi))
    needed = asked.torque_n_mm(places % (2.0 * pi)) - change * asked.speed_rad_s**2 / 2.0
    rows = list(zip(inertia.tolist(), change.tolist(), needed.tolist(), strict=True))
    step, speeds = (span[1] - span[0]) / STEPS, [start]

    def slope(row: int, speed: float) -> float:
        mass, bend, load = rows[row]
        return (given(speed) - load - bend * speed**2 / 2.0) / (mass * speed)

    for row in range(0, 2 * STEPS, 2):
        speed = speeds[-1]
        first = slope(row, speed)
        second = slope(row + 1, speed + step / 2.0 * first)
        third = slope(row + 1, speed + step / 2.0 * second)
        fourth = slope(row + 2, speed + step * third)
        speeds.append(speed + step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth))
    return np.array(speeds)


@pytest.mark.slow
@pytest.mark.parametrize("clutch", [False, True])
@pytest.mark.parametrize("added_kg_mm2", [0.0, 1e9])
def test_speed_course_against_another_solver(added_kg_mm2: float, clutch: bool) -> None:
    """In w itself from the course's beginning: the same speeds, and back there after a cycle; work in balance."""
    asked, motor = demand(added_kg_mm2), replace(MOTOR, overrunning_clutch=clutch)
    course = speed_course(asked, motor)

    def given(speed: float) -> float:
        torque = 36e3 / 0.03 * (1.0 - 24.5 * speed / (1500.0 * pi / 30.0))
        return torque * 24.5 * 0.95 if torque > 0.0 else 0.0 if clutch else torque * 24.5 / 0.95

    start = float(course.speed_rad_s(np.zeros(1))[0])
    speed = followed(asked, (0.0, 2.0 * pi), start, given)
    places = np.linspace(0.0, 2.0 * pi, STEPS + 1)[:-1]
    assert_allclose(speed[:-1], course.speed_rad_s(places), rtol=1e-6)
    assert speed[-1] == pytest.approx(start, rel=1e-6)
    assert course.drive_work_n_mm == pytest.approx(course.asked_work_n_mm, rel=1e-9)
    assert course.range_rad_s[0].value == pytest.approx(speed.min(), rel=1e-6)
    assert course.range_rad_s[1].value == pytest.approx(speed.max(), rel=1e-6)
    if clutch:
        assert course.motor_range_n_mm[0] >= 0.0
        assert (course.motor_range_n_mm[0] == 0.0) == (added_kg_mm2 == 0.0)


@pytest.mark.parametrize("clutch", [False, True])
def test_the_course_of_a_small_machine_against_another_solver(clutch: bool) -> None:
    """With a motor whose torque falls to nothing at twice the speed, or at the speed itself behind a clutch."""
    asked = small(1e5 if clutch else 3e5)
    free, box = (1.0 if clutch else 2.0) * asked.speed_rad_s, Gearbox(3.0, 0.8)
    line = StraightLine(2.0 * asked.fluctuation.mean_torque_n_mm, 3.0 * free)
    course = speed_course(asked, LineDrive(line, box, clutch))
    start = float(course.speed_rad_s(np.zeros(1))[0])

    def motor(speed: Array | float) -> Any:
        torque = line.stall_n_mm * (1.0 - speed / free)
        return np.maximum(torque, 0.0) if clutch else torque

    def given(speed: float) -> float:
        torque = float(motor(speed))
        return torque * 3.0 * (0.8 if torque > 0.0 else 1.0 / 0.8)

    speed = followed(asked, (0.0, 2.0 * pi), start, given)
    places = np.linspace(0.0, 2.0 * pi, STEPS + 1)
    assert_allclose(speed[:-1], course.speed_rad_s(places[:-1]), rtol=1e-6)
    assert speed[-1] == pytest.approx(start, rel=1e-6)
    assert course.drive_work_n_mm == pytest.approx(course.asked_work_n_mm, rel=1e-9)
    assert [one.value for one in course.range_rad_s] == pytest.approx([speed.min(), speed.max()], rel=1e-6)
    period = np.trapezoid(1.0 / speed, places)
    assert (course.period_s, course.mean_rad_s) == pytest.approx((period, 2.0 * pi / period), rel=1e-6)
    assert course.fluctuation == pytest.approx(np.ptp(speed) * period / (2.0 * pi), rel=1e-5)
    square = np.trapezoid(motor(speed) ** 2 / speed, places) / period
    assert course.rms_n_mm == pytest.approx(sqrt(square), rel=1e-5)
    assert course.motor_range_n_mm == pytest.approx((motor(speed.max()), motor(speed.min())), rel=1e-5, abs=1e-3)
    assert (course.motor_range_n_mm[0] == 0.0) == clutch
    assert course.asked_work_n_mm == pytest.approx(asked.fluctuation.work_n_mm, rel=1e-9)


def test_a_rounded_clutch_has_the_slope_of_its_torque() -> None:
    """And passes half of the rounding where the motor gives nothing; without rounding it passes what is over 0."""
    for clutch in (False, True):
        motor = LineDrive(StraightLine(100.0, 60.0), Gearbox(2.0, 0.9), clutch)
        speed = np.array([5.0, 29.0, 31.0, 40.0])
        torque, slope = motor.rounded_n_mm(speed, 8.0)
        ahead, behind = (motor.rounded_n_mm(speed + step, 8.0)[0] for step in (1e-5, -1e-5))
        assert slope == pytest.approx((ahead - behind) / 2e-5, rel=1e-7)
        assert motor.rounded_n_mm(speed, 0.0)[0] == pytest.approx(motor.torque_n_mm(speed), abs=1e-12)
        assert motor.rounded_n_mm(np.array([30.0]), 8.0)[0] == pytest.approx([4.0 if clutch else 0.0])
        assert torque[0] == pytest.approx(100.0 * (1.0 - 5.0 / 30.0) * 1.8, rel=2e-3)


@pytest.mark.slow
def test_the_course_is_reached_from_another_speed() -> None:
    """From a tenth slower; after eight cycles the motor has brought it to the course."""
    asked = demand()
    start = float(speed_course(asked, MOTOR).speed_rad_s(np.zeros(1))[0])

    def given(speed: float) -> float:
        torque = 36e3 / 0.03 * (1.0 - 24.5 * speed / (1500.0 * pi / 30.0))
        return torque * 24.5 * 0.95 if torque > 0.0 else torque * 24.5 / 0.95

    speed = 0.9 * start
    for _ in range(8):
        speed = float(followed(asked, (0.0, 2.0 * pi), speed, given)[-1])
    assert speed == pytest.approx(start, rel=1e-6)


@pytest.mark.long
@pytest.mark.slow
def test_speed_course_against_scipy() -> None:
    """LSODA with its own steps over a cycle."""
    asked = demand()
    course = speed_course(asked, MOTOR)

    def slope(phi1: float, speed: Array) -> Array:
        angle = np.array([phi1 % (2.0 * pi)])
        inertia, change = asked.inertia(angle)
        needed = asked.torque_n_mm(angle) - change * asked.speed_rad_s**2 / 2.0
        found: Array = (MOTOR.torque_n_mm(speed) - needed - change * speed**2 / 2.0) / (inertia * speed)
        return found

    places = np.linspace(0.0, 2.0 * pi - 1e-9, 50)
    start = course.speed_rad_s(np.zeros(1))
    solved = solve_ivp(slope, (0.0, places[-1]), start, "LSODA", places, rtol=1e-8, atol=1e-8, max_step=0.2)
    assert_allclose(solved.y[0], course.speed_rad_s(places), rtol=2e-6)


@pytest.mark.slow
def test_a_large_flywheel_has_the_fluctuation_of_the_energy_swing() -> None:
    """J C w^2 = E_max - E_min with a motor that hardly reacts: of high inertia, the course agrees with the formula."""
    asked = demand(5e10)
    mean = asked.fluctuation.mean_torque_n_mm / 24.5
    soft = LineDrive(StraightLine(2.0 * mean, 2.0 * 24.5 * asked.speed_rad_s), Gearbox(24.5, 1.0))
    course = speed_course(asked, soft)
    inertia_kg_mm2 = 1e3 * float(asked.inertia(np.zeros(1))[0][0])
    predicted = asked.fluctuation.flywheel_kg_mm2(1.0) / inertia_kg_mm2
    assert course.fluctuation == pytest.approx(predicted, rel=0.01)


@pytest.mark.slow
def test_a_motor_that_is_too_weak_is_refused() -> None:
    with pytest.raises(NoSuchMechanism, match="stopped"):
        speed_course(demand(), LineDrive(StraightLine(1e3, 150.0), Gearbox(24.5, 1.0)))


def test_a_disc_has_the_inertia_asked_for() -> None:
    """J = m d^2 / 8 of a steel disc 500 mm wide across and 40 mm thick: 61.65 kg, 1.9267 kg m2."""
    mass = 7.85e-6 * pi * 250.0**2 * 40.0
    found = disc(mass * 500.0**2 / 8.0, 500.0, 10.0)
    assert (found.width_mm, found.mass_kg, found.rim_speed_m_s) == pytest.approx((40.0, mass, 2.5), rel=1e-12)


# Shafts of constant speed


def between(asked: Demand, one: Excursion, held_n_mm: float) -> Array:
    """Speeds between an excursion's ends from the equation of motion."""
    assert one.end_rad is not None
    return followed(asked, (one.start_rad, one.end_rad), asked.speed_rad_s, lambda speed: held_n_mm)


@pytest.mark.tiers(quick=["small"], rest="slow")
@pytest.mark.parametrize("demand_of", [small, demand], ids=["small", "shipped"])
def test_a_machine_that_runs_ahead_against_the_equation_of_motion(demand_of: Callable[[], Demand]) -> None:
    asked = demand_of()
    found = running_ahead(asked)
    assert found
    for one in found:
        speed = between(asked, one, 0.0)
        assert speed[-1] == pytest.approx(asked.speed_rad_s, rel=1e-6)
        assert np.all(speed[1:-1] >= asked.speed_rad_s * (1.0 - 1e-6))
        assert speed.max() == pytest.approx(one.speed_rad_s.value, rel=1e-6)
        assert one.heat_n_mm == 0.0


@pytest.mark.tiers(quick=["small"], rest="slow")
@pytest.mark.parametrize(
    ("demand_of", "flywheel_kg_mm2", "limit"), [(small, 3e5, 2.4e4), (demand, 0.0, 1.6e6)], ids=["small", "shipped"]
)
def test_a_limiter_that_slips_against_the_equation_of_motion(
    demand_of: Callable[[float], Demand], flywheel_kg_mm2: float, limit: float
) -> None:
    """And its heat: what the shaft gives at its own speed less what the machine gets."""
    asked = demand_of(flywheel_kg_mm2)
    found = slipping(asked, limit)
    assert found
    for one in found:
        speed = between(asked, one, limit)
        assert speed[-1] == pytest.approx(asked.speed_rad_s, rel=1e-5)
        assert speed.min() == pytest.approx(one.speed_rad_s.value, rel=1e-6)
        assert one.end_rad is not None
        places = np.linspace(one.start_rad, one.end_rad, speed.size)
        heat = np.trapezoid(limit * (asked.speed_rad_s / speed - 1.0), places)
        assert one.heat_n_mm == pytest.approx(heat, rel=1e-5)


def test_a_limiter_below_the_mean_torque_lets_the_machine_stop() -> None:
    """Set to 180 N mm it slips from sin = -0.04 on; the energy that is lost there is in closed form."""
    asked = waveform()
    (one,) = slipping(asked, 180.0)
    begin, least = 2.0 * pi - asin(0.04), 3.0 * pi + asin(0.04)
    assert (one.start_rad, one.end_rad, one.heat_n_mm) == (pytest.approx(begin, abs=1e-9), None, None)
    lost = 20.0 * (least - begin) - 500.0 * (cos(least) - cos(begin))
    assert one.energy_n_mm == pytest.approx(-lost, rel=1e-9)
    left = asked.speed_rad_s**2 - 2.0 * lost / 40.0
    assert one.speed_rad_s.value == pytest.approx(sqrt(left), rel=1e-9)
    assert one.speed_rad_s.at == pytest.approx(least - 2.0 * pi, abs=1e-4)
    assert one.last_rad == pytest.approx(begin + 2.0 * pi)


def test_couplings_that_never_catch_gain_or_lose_the_whole_work() -> None:
    """A limiter below all torques stops the machine; a clutch lets one that never asks for any go."""

    class Uneven(Waveform):
        def torque_n_mm(self, phi1_rad: Array) -> Array:
            return 60.0 * float(self.added_kg_mm2) + 20.0 * np.sin(phi1_rad)

    cycle, losses = small().cycle, small().losses
    (slips,) = slipping(Uneven(cycle, losses, 1.0), 30.0)
    assert (slips.start_rad, slips.end_rad, slips.speed_rad_s.value, slips.heat_n_mm) == (0.0, None, 0.0, None)
    assert slips.energy_n_mm == pytest.approx(-(60.0 - 30.0) * 2.0 * pi, rel=1e-9)
    (free,) = running_ahead(Uneven(cycle, losses, -1.0))
    assert (free.speed_rad_s.value, free.end_rad) == (small().speed_rad_s, None)
    assert free.energy_n_mm == pytest.approx(60.0 * 2.0 * pi, rel=1e-9)
    assert slipping(Uneven(cycle, losses, 1.0), 81.0) == running_ahead(Uneven(cycle, losses, 1.0)) == []


def test_a_weak_motor_stops_where_its_energy_is_spent() -> None:
    """With 100 N mm against 200 + 500 sin from an energy that lasts into the second turn, in closed form."""
    asked = waveform()

    def energy(phi1: float) -> float:
        return 1500.0 - 100.0 * phi1 + 500.0 * (cos(phi1) - 1.0)

    place = brentq(energy, 2.0 * pi, 3.0 * pi)
    start = sqrt(2.0 * 1500.0 / 40.0)
    found = stall_of(asked, lambda speed: np.full(speed.shape, 100.0), start, 4.0 * pi)
    assert found is not None
    assert found.phi1_rad == pytest.approx(place, abs=1e-5)
    assert found.needed_n_mm == pytest.approx(200.0 + 500.0 * sin(place), rel=1e-5)
    assert (found.most_n_mm.value, found.most_n_mm.at, found.given_n_mm) == pytest.approx(
        (700.0, pi / 2.0, 100.0), rel=1e-4
    )
    turned = small_drive().transmission.driven_angle(np.array([place]), 0).value[0]
    assert found.crank_rad == pytest.approx(turned, abs=1e-4)
    assert stall_of(asked, lambda speed: np.full(speed.shape, 100.0), start, 2.0 * pi) is None


@pytest.mark.slow
def test_a_limiter_over_the_peak_holds_and_one_below_the_mean_stops_the_machine() -> None:
    asked = demand()
    most = asked.torque_range_n_mm[1].value
    assert slipping(asked, 1.0001 * most) == []
    assert len(slipping(asked, 0.9999 * most)) == 1
    assert any(one.end_rad is None for one in slipping(asked, 0.9 * asked.fluctuation.mean_torque_n_mm))


# Whole designs


@cache
def whole() -> DrivetrainResult:
    return drive(DESIGN).drivetrain


@pytest.mark.slow
def test_the_shipped_design_pinned() -> None:
    """Useful power is the work of the resistance; the check's mean counts the guide as well; the rest is pinned."""
    found, losses = whole(), whole().demand.losses
    w = 1e-3 * found.demand.speed_rad_s / (2.0 * pi)
    assert w * losses.useful_n_mm == pytest.approx(drive(DESIGN).massless_check.mean_power_w, rel=1e-9)
    whole_w = w * (losses.useful_n_mm + losses.guide_n_mm)
    assert whole_w == pytest.approx(drive(DESIGN).check.mean_power_w, rel=1e-9)
    assert found.shafts[0] is not None
    assert found.shafts[1] is not None
    assert found.shafts[0].bearings is not None
    assert found.shafts[1].bearings is not None
    # The gear in the middle: half the mesh force each, where friction pushes with the knock or against it
    first, second = found.shafts[0].bearings
    peaks = drive(DESIGN).knocking_peaks
    assert peaks is not None
    assert peaks.mesh is not None
    assert abs(2.0 * first.largest_n.value / peaks.mesh.force_n.value - 1.0) < 1.01 * losses.mesh_share
    assert second.equivalent_n == pytest.approx(first.equivalent_n, rel=1e-12)
    assert found.shafts[1].bearings[1].needed_rating_n == pytest.approx(53_610.0, rel=0.01)
    assert found.motor is not None
    assert found.motor.course is not None
    assert found.motor.course.fluctuation == pytest.approx(0.06858, abs=2e-5)
    assert found.motor.course.rms_n_mm < 36e3 < found.motor.load.rms_n_mm


@pytest.mark.slow
def test_half_the_positions_apart_twice_the_life_by_the_cube() -> None:
    """A bearing of twice the rating lasts eight times as long; one with the needed rating just as long as wanted."""
    found = whole().shafts[0]
    assert found is not None
    assert found.bearings is not None
    one = found.bearings[0]
    hours = life_h(one.needed_rating_n, one.equivalent_n, "ball", one.speed_rad_s)
    assert hours == pytest.approx(whole().wanted.hours, rel=1e-9)
    assert life_h(2.0 * one.needed_rating_n, one.equivalent_n, "ball", one.speed_rad_s) == pytest.approx(8.0 * hours)


@pytest.fixture
def run(run: Run) -> Run:
    """Simulate d.yaml, which holds the text."""
    return on_text(run, "simulate", "--verbose")


PRESS = """\
name: press
linkage: {crank_mm: 38, rod_mm: 96}
operation: {speed_rpm: 600}
motion: {law: ellipse, eccentricity: 0.3}
resistance: {polynomial_n: [400]}
gears: {teeth: 19, module_mm: 1.5, face_width_mm: 10, driving: {bore_mm: 8, keyway: {width_mm: 3, depth_mm: 1.4}}}
masses:
  slider_kg: 1
  rod: {mass_kg: 0.3, center_mm: 40, inertia_kg_mm2: 300}
  crank: {mass_kg: 0.4, center_mm: 10, inertia_kg_mm2: 200}
  driving_gear_kg_mm2: 100
  driven_gear_kg_mm2: 100
  flywheel: {inertia_kg_mm2: 20000}
"""


@pytest.mark.slow
def test_the_command_tells_what_does_not_hold(run: Run) -> None:
    text = f"""{PRESS}drivetrain:
  driving_shaft:
    bearing_a: {{at_mm: -20, dynamic_rating_n: 900, static_rating_n: 400}}
    bearing_b: {{at_mm: 20}}
    steel: C45
    key: {{length_mm: 2}}
  pto: {{torque_limiter_n_m: 12, overrunning_clutch: true}}
"""
    status, out, err = run(text)
    assert (status, err) == (0, "")
    found = simulated("export/press-rigid")
    around = found["drivetrain"]
    assert around["driving_shaft"]["bearing_a"]["life_h"] < 10_000.0
    assert around["driving_shaft"]["bearing_b"]["life_h"] is None
    assert around["pto"]["torque_limiter"]["slips_at_deg"]
    assert around["pto"]["overrunning_clutch"]["largest_speed_rpm"] > 600.0
    said = " ".join(found["warnings"])
    for words in (
        "bearing a of the driving shaft lasts",
        "pressure on the key of the driving shaft",
        "torque limiter slips",
    ):
        assert words in said
    assert "warning: bearing a" in out
    assert "power take-off" in out


@pytest.mark.slow
@pytest.mark.parametrize("given", [0.0, 7000.0, 60000.0])
def test_the_disc_is_what_the_flywheel_of_the_file_lacks(given: float) -> None:
    """By m d^2 / 8; with all that the wanted fluctuation needs on the shaft there is no disc."""
    text = PRESS.replace("inertia_kg_mm2: 20000", f"inertia_kg_mm2: {given}, speed_fluctuation: 0.2")
    found = drive_of_text(f"{text}drivetrain: {{flywheel_diameter_mm: 150}}\n").drivetrain
    needed = found.flywheel_kg_mm2 - 100.0 - given
    assert found.flywheel_kg_mm2 == pytest.approx(33486.0, abs=1.0)
    if needed < 0.0:
        assert found.disc is None
    else:
        assert found.disc is not None
        assert found.disc.mass_kg * 150.0**2 / 8.0 == pytest.approx(needed, rel=1e-12)


@pytest.mark.long
@pytest.mark.slow
def test_a_gearbox_that_gives_another_speed_is_told(run: Run) -> None:
    motor = "{rated_torque_n_m: 60, rated_speed_rpm: 1450, no_load_speed_rpm: 1500, gearbox: {ratio: %s}}"
    for ratio, told in ((2.5, False), (5.0, True)):
        assert run(f"{PRESS}drivetrain:\n  motor: {motor % ratio}\n")[0] == 0
        warnings = simulated("export/press-rigid").get("warnings", [])
        assert any("with this motor and gearbox the machine runs at" in one for one in warnings) == told


@at_once(
    ("section", "message"),
    [
        ("motor: {rated_torque_n_m: 1, rated_speed_rpm: 100, no_load_speed_rpm: 90}", "over 100 r/min is right"),
        ("motor: {rated_torque_n_m: 2, rated_speed_rpm: 100, peak_torque_n_m: 1}", "2 N m or over is right"),
        ("pto: {}, motor: {rated_torque_n_m: 1, rated_speed_rpm: 100}", "keep one"),
        ("driving_shaft: {bearing_a: {at_mm: 0}}", "bearing_a: given without bearing_b"),
        ("driving_shaft: {bearing_a: {at_mm: 5}, bearing_b: {at_mm: 5}}", "another place is right"),
        ("driving_shaft: {steel: C45}", "steel: given without bearing_a"),
        ("driving_shaft: {bearing_a: {at_mm: 0}, bearing_b: {at_mm: 9}, key: {}}", "key: given without steel"),
        ("driving_shaft: {bearing_a: {at_mm: 0}, bearing_b: {at_mm: 9}, tensile_mpa: 400}", "given without yield_mpa"),
        (
            "driving_shaft: {bearing_a: {at_mm: -9}, bearing_b: {at_mm: 9}, diameter_mm: 8.01}",
            r"driving_shaft\.diameter_mm: 8\.01 mm given, but gears\.driving\.bore_mm is 8 mm",
        ),
        (
            "driven_shaft: {bearing_a: {at_mm: -9}, bearing_b: {at_mm: 4.99}}",
            r"driven_shaft\.bearing_b\.at_mm: 4\.99 mm is within the gear.*; -5 or less, or 5 or more, is right",
        ),
        (
            "driving_shaft: {bearing_a: {at_mm: -9}, bearing_b: {at_mm: 9}, steel: C45, key: {length_mm: 10.1}}",
            r"driving_shaft\.key\.length_mm: 10\.1 given, but .* is 10 mm long; 10 or less is right",
        ),
    ],
)
def test_wrong_sections_are_refused(section: str, message: str) -> None:
    with pytest.raises(WrongInput, match=message):
        drive_of_text(f"{PRESS}drivetrain: {{{section}}}\n")


def test_a_shaft_that_fits_its_gear_is_taken() -> None:
    bearings = "bearing_a: {at_mm: -5}, bearing_b: {at_mm: 5}"
    drive_of_text(f"{PRESS}drivetrain: {{driving_shaft: {{{bearings}, diameter_mm: 8}}}}\n")
    # The driven gear has no bore.
    drive_of_text(f"{PRESS}drivetrain: {{driven_shaft: {{{bearings}, diameter_mm: 9}}}}\n")


def test_what_the_section_needs_of_the_design() -> None:
    head = PRESS[: PRESS.index("masses:")]
    with pytest.raises(WrongInput, match="drivetrain: given without masses"):
        drive_of_text(f"{head}drivetrain: {{}}\n")


@pytest.mark.slow
def test_what_a_shaft_needs_of_its_gear() -> None:
    bearings = "bearing_a: {at_mm: -9}, bearing_b: {at_mm: 9}, steel: C45"
    with pytest.raises(WrongInput, match=r"driven_shaft\.diameter_mm: missing"):
        _ = drive_of_text(f"{PRESS}drivetrain: {{driven_shaft: {{{bearings}}}}}\n").drivetrain
    with pytest.raises(WrongInput, match=r"driven_shaft\.key: given, but gears\.driven has no keyway"):
        _ = drive_of_text(
            f"{PRESS}drivetrain: {{driven_shaft: {{{bearings}, diameter_mm: 9, key: {{}}}}}}\n"
        ).drivetrain


@pytest.mark.slow
def test_the_line_of_the_simulation_is_the_motors_at_the_driving_gear() -> None:
    """Two ways to give the same motor: the same course."""
    own = "motor: {rated_torque_n_m: 2, rated_speed_rpm: 1200, no_load_speed_rpm: 1300, gearbox: {ratio: 2}}"
    without = "motor: {rated_torque_n_m: 2, rated_speed_rpm: 1200, gearbox: {ratio: 2}}"
    line = f"simulation: {{motor: {{no_load_speed_rpm: 650, stall_torque_n_m: {2.0 * 2.0 * 13.0}}}}}\n"
    first = drive_of_text(f"{PRESS}drivetrain: {{{own}}}\n").drivetrain.motor
    second = drive_of_text(f"{PRESS}{line}drivetrain: {{{without}}}\n").drivetrain.motor
    third = drive_of_text(f"{PRESS}drivetrain: {{{without}}}\n").drivetrain.motor
    assert first is not None
    assert second is not None
    assert third is not None
    assert first.course is not None
    assert second.course is not None
    assert first.course.fluctuation == pytest.approx(second.course.fluctuation, rel=1e-9)
    assert third.course is None


def test_the_keys_know_the_steels() -> None:
    annotation = DrivingShaft.model_fields["steel"].annotation
    assert all(f"'{name}'" in str(annotation) for name in STEELS)


def test_the_design_has_the_law_of_the_one_without() -> None:
    ours, other = (drive(name).design.motion for name in (DESIGN, "baler-half-dynamics"))
    assert ours == other
