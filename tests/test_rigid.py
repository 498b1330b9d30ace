"""Inverse dynamics against a linear system of all bodies, energies, closed forms, scaling, and dense samples."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp
from scipy.optimize import brentq

from at_once import at_once
from ncgear.dynamics.crank_load import reduced_inertia
from ncgear.dynamics.driving_shaft import DrivingShaft, Fluctuation, counting_masses, fluctuation
from ncgear.dynamics.loaded_machine import Loads, RigidMachine
from ncgear.dynamics.mesh_force import MeshPlace
from ncgear.dynamics.rigid import Rigid, load_peaks, rigid_level
from ncgear.errors import NoSuchMechanism
from ncgear.kinematics.check import kinematic_check
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.forces import CrankPace, RodMasses
from ncgear.mechanisms.resistance import PolynomialResistance, TableResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.pitch.shape import Mesh
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from oracles import newton_euler
from published import BALER_LINKAGE, PRESS, RPM
from test_kinematics import machine
from test_laws import LAWS

HEAVY = RodMasses(
    slider_kg=150.0,
    rod_kg=30.0,
    rod_center_mm=430.0,
    rod_inertia_kg_mm2=2.8e6,
    crank_kg=40.0,
    crank_center_mm=-120.0,
    crank_inertia_kg_mm2=1.6e6,
    driven_inertia_kg_mm2=2e5,
    gravity_m_s2=(3.0, -9.0),
)
OUTSIDE = MeshPlace(200.0, radians(20.0), Mesh.EXTERNAL, radians(150.0))
SWAYING = "phi - 0.08*sin(2*phi)"
SLOWED = "phi/2 - 0.08*sin(phi)"
"""Of a ring, which needs a ratio over 1; two turns of the driving gear to one of its own."""


@cache
def felt(speed_rpm: float, offset_mm: float, *, internal: bool = False) -> RigidMachine:
    """A law in closed form on an offset linkage."""
    text, lobes = (SLOWED, Lobes(1, 2)) if internal else (SWAYING, Lobes())
    place = replace(OUTSIDE, mesh=Mesh.INTERNAL) if internal else OUTSIDE
    transmission = driven_angle_expression_law(text, lobes)
    made = Machine(transmission, CrankSlider(380.0, 960.0, offset_mm), PRESS, speed_rpm * RPM)
    return RigidMachine(made, HEAVY, place)


def scene(rigid: RigidMachine) -> newton_euler.Scene:
    """The same machine for the oracle, the law written anew."""
    linkage, masses, place = rigid.machine.linkage, rigid.masses, rigid.place
    assert place is not None
    internal = place.mesh is Mesh.INTERNAL

    def driven(phi: object) -> object:
        return phi / 2 - mp.mpf("0.08") * mp.sin(phi) if internal else phi - mp.mpf("0.08") * mp.sin(2 * phi)

    def press(x: object) -> object:
        return max(mp.polyval([2.498e-7, -1.575e-4, 1.846e-2, 3.447, -131.2779], x), 0)

    return newton_euler.Scene(
        driven_angle=driven,
        speed_rad_s=rigid.machine.speed_rad_s,
        crank=linkage.crank_mm,
        rod=linkage.rod_mm,
        offset=linkage.offset_mm,
        slider_kg=masses.slider_kg,
        rod_kg=masses.rod_kg,
        rod_center=masses.rod_center_mm,
        rod_inertia=masses.rod_inertia_kg_mm2,
        crank_kg=masses.crank_kg,
        crank_center=masses.crank_center_mm,
        shaft_inertia=masses.crank_shaft_kg_mm2,
        gravity=masses.gravity_m_s2,
        resistance=press,
        distance=place.center_distance_mm,
        rack_angle=place.rack_angle_rad,
        internal=internal,
        driving_axis=place.driving_axis_rad,
    )


def values(loads: Loads) -> dict[str, float]:
    """What the oracle calls it, at the only angle."""
    mesh = loads.mesh_force
    found = {
        "wrist_x": loads.joints["wrist"].x,
        "wrist_y": loads.joints["wrist"].y,
        "pin_x": loads.joints["pin"].x,
        "pin_y": loads.joints["pin"].y,
        "crank_x": loads.crank_bearing.x,
        "crank_y": loads.crank_bearing.y,
        "guide": loads.guide,
        "mesh": mesh.size_n,
        "axis_x": mesh.force.x,
        "axis_y": mesh.force.y,
        "torque": loads.driving_torque,
    }
    return {name: float(value.value[0]) for name, value in found.items()}


@pytest.mark.judges("dynamics")
@at_once("phi1", [0.1, 1.3, 2.2, 3.0, 3.5, 4.4, 5.9])
@at_once("internal", [False, True])
@at_once("rpm", [20.0, 200.0])
def test_all_forces_solve_one_linear_system(rpm: float, internal: bool, phi1: float) -> None:
    """At 200 r/min inertia turns the tooth load round: both flanks are among the cases."""
    rigid = felt(rpm, 60.0, internal=internal)
    angle = np.array([phi1])
    loads = rigid.at(angle)
    pushing = bool(loads.driven_torque.value[0] > 0.0)
    working = bool(rigid.machine.working(rigid.machine.transmission.driven_angle(angle).value)[0])
    exact = newton_euler.solved(scene(rigid), phi1, working=working, pushing=pushing)
    assert exact["mesh"] > 0.0
    scale = max(map(abs, exact.values()))
    for name, value in values(loads).items():
        assert value == pytest.approx(exact[name], rel=1e-11, abs=1e-13 * scale), name


def test_both_flanks_carry_in_these_cases() -> None:
    """At 200 r/min already in the working stroke, which ends near 3.1."""
    torque = felt(200.0, 60.0).at(np.array([1.3, 2.2, 3.0])).driven_torque.value
    assert torque.min() < 0.0 < torque.max()


def test_the_wrong_flank_is_seen() -> None:
    """Negative control: solved on the other flanks, the mesh force would have to pull."""
    rigid = felt(20.0, 60.0)
    exact = newton_euler.solved(scene(rigid), 2.2, working=True, pushing=False)
    assert exact["mesh"] < 0.0
    assert abs(exact["crank_x"] / values(rigid.at(np.array([2.2])))["crank_x"] - 1.0) > 0.01


# --- energies ------------------------------------------------------------------------------------------------------


@cache
def swing(name: str) -> Fluctuation:
    return fluctuation(RigidMachine(machine(name, 50.0), HEAVY, OUTSIDE))


@at_once("name", LAWS)
def test_work_of_the_driving_torque_is_that_of_the_resistance(name: str) -> None:
    """Over a cycle masses and weights give back what they took: 1e-12 of the work."""
    linkage = machine(name, 50.0).linkage
    work = float(PRESS.working.work_n_mm(np.array([linkage.stroke_mm]), linkage.stroke_mm)[0])
    assert swing(name).work_n_mm == pytest.approx(work, rel=1e-12)


def test_the_mean_power_is_that_of_the_resistance_with_any_inertia() -> None:
    """Of 1e10 kg m2 the mean is lost in the torque's rounding errors; a guide that rubs takes more of any machine."""
    made = machine("stroke, e = 0", RPM)
    alone = kinematic_check(made)
    for rubs, inertia_kg_mm2 in ((0.0, 1e16), (0.0, 1e4), (0.1, 1e4)):
        rigid = RigidMachine(made, replace(HEAVY, driven_inertia_kg_mm2=inertia_kg_mm2), guide_friction=rubs)
        found = counting_masses(alone, DrivingShaft(rigid))
        assert found.mean_power_w > 0.0
        assert (found.mean_power_w == pytest.approx(alone.mean_power_w, rel=1e-12)) is not bool(rubs)
        assert (found.mean_power_w > 1.001 * alone.mean_power_w) is bool(rubs)


@pytest.mark.parametrize("name", ["uniform", "stroke, e = 0", "ellipse 1:2"])
def test_work_up_to_any_angle_is_the_energy_gained(name: str) -> None:
    """Kinetic energy from the reduced inertia, potential energy from the heights, work of the resistance."""
    made = machine(name, 50.0)
    phi1 = np.linspace(0.0, made.transmission.cycle_rad, 40)[:-1]
    driven = made.transmission.driven_angle(phi1, 1)
    angle = Jet.variable(driven.value, 2)
    rod, crank = made.linkage.rod(angle), made.linkage.crank_body(angle, -120.0).center
    moving = made.linkage.moving_masses(angle, HEAVY)
    inertia_kg_mm2, _ = reduced_inertia(moving, HEAVY)
    kinetic = 1e-3 * 0.5 * inertia_kg_mm2 * (driven.derivative(1) * made.speed_rad_s) ** 2
    position = made.linkage.displacement(driven).value
    forth = made.working(driven.value)
    stroke = np.full(phi1.shape, made.linkage.stroke_mm)
    pressed = made.load.working.work_n_mm(np.where(forth, position, stroke), made.linkage.stroke_mm)
    energy = kinetic - weight_work(rod.at(430.0).x.value, rod.at(430.0).y.value, HEAVY.rod_kg)
    energy -= weight_work(crank.x.value, crank.y.value, HEAVY.crank_kg)
    energy -= weight_work(rod.wrist.x.value, rod.wrist.y.value, HEAVY.slider_kg)
    gained = energy - energy[0] + pressed
    assert np.max(np.abs(swing(name).work(phi1) - gained)) <= 1e-12 * swing(name).work_n_mm


def weight_work(x_mm: Array, y_mm: Array, mass_kg: float) -> Array:
    return mass_kg * (HEAVY.gravity_m_s2[0] * x_mm + HEAVY.gravity_m_s2[1] * y_mm)


@pytest.mark.slow
@given(
    rod_mm=st.floats(500.0, 5000.0),
    offset_mm=st.floats(-100.0, 100.0),
    rod_center_mm=st.floats(-200.0, 1500.0),
    rod_kg=st.floats(0.0, 200.0),
    slider_kg=st.floats(0.0, 500.0),
    speed=st.floats(-50.0, 50.0),
    acceleration=st.floats(-500.0, 500.0),
)
@settings(max_examples=60, deadline=None)
def test_torque_is_lagranges_with_any_turning_of_the_crank(
    rod_mm: float,
    offset_mm: float,
    rod_center_mm: float,
    rod_kg: float,
    slider_kg: float,
    speed: float,
    acceleration: float,
) -> None:
    linkage, angle = CrankSlider(380.0, rod_mm, offset_mm), Jet.variable(np.linspace(0.0, 2.0 * pi, 41), 2)
    pace, press = (np.full(41, speed), np.full(41, acceleration)), np.linspace(0.0, 1000.0, 41)
    varied = {"rod_kg": rod_kg, "rod_center_mm": rod_center_mm, "slider_kg": slider_kg}
    masses = replace(HEAVY, gravity_m_s2=(0.0, 0.0), **varied)
    newton = linkage.joint_forces(angle, masses, CrankPace(*pace), press)
    moving = linkage.moving_masses(angle, masses)
    inertia, change = reduced_inertia(moving, masses)
    lagrange = 1e-3 * (inertia * acceleration + 0.5 * change * speed**2)
    lagrange += press * linkage.rod(angle).wrist.x.derivative(1)
    # Rounding errors are those of the pin's force times the crank, which the torque may be far below
    largest = 380.0 * np.max(np.hypot(newton.joints["pin"].x, newton.joints["pin"].y)) + np.max(
        np.abs(newton.torque_n_mm)
    )
    assert np.max(np.abs(newton.torque_n_mm - lagrange)) <= 1e-12 * largest


def test_reduced_inertia_by_differences_of_places() -> None:
    """M from velocities and dM/dq from M, both by mpmath."""
    rigid = replace(felt(20.0, 60.0), machine=replace(felt(20.0, 60.0).machine, transmission=uniform_law(Lobes())))
    unit = replace(scene(rigid), driven_angle=lambda phi: phi)

    def inertia(q: object) -> object:
        names = "wrist", "rod", "rod_angle"
        wrist, rod, turn = (mp.diff(lambda a, n=n: newton_euler.places(unit, a)[n], q) for n in names)
        rod_part = unit.rod_kg * abs(rod) ** 2 + unit.rod_inertia * turn**2
        return unit.slider_kg * abs(wrist) ** 2 + rod_part + unit.shaft_inertia

    found, slope = reduced_inertia(rigid.machine.linkage.moving_masses(Jet.variable([1.1], 2), HEAVY), HEAVY)
    with mp.workdps(50):
        exact, change = float(inertia(mp.mpf(1.1))), float(mp.diff(inertia, mp.mpf(1.1)))
    assert found[0] == pytest.approx(exact, rel=1e-14)
    assert slope[0] == pytest.approx(change, rel=1e-13)


# --- closed forms and scaling --------------------------------------------------------------------------------------


def even(masses: RodMasses, load: SliderLoad, rpm: float = 60.0) -> RigidMachine:
    """A uniform crank in line."""
    linkage = BALER_LINKAGE
    return RigidMachine(Machine(uniform_law(Lobes()), linkage, load, rpm * RPM), masses, OUTSIDE)


def test_uniform_crank_without_a_rods_mass() -> None:
    """With s = sin q, c = cos q, L = sqrt(l^2 - r^2 s^2): x' = r s (1 + r c / L), torque = (R + m x'' w^2) x'."""
    loads = even(RodMasses(slider_kg=100.0), SliderLoad(PolynomialResistance((400.0,)))).at(
        q := np.linspace(0.05, 6.2, 60)
    )
    r, rod, w = 380.0, 960.0, 2.0 * pi
    s, c = np.sin(q), np.cos(q)
    along = np.sqrt(rod**2 - (r * s) ** 2)
    # Angles from the retracted end: the pin's advance is -r cos q, the rod's projection L
    first = r * s - r**2 * s * c / along
    second = r * c - r**2 * (c**2 - s**2) / along - r**4 * s**2 * c**2 / along**3
    push = np.where(q < pi, 400.0, 0.0) + 100.0 * second * w**2 / 1000.0
    assert loads.driving_torque.value == pytest.approx(push * first, rel=1e-12, abs=1e-8)
    assert loads.joints["wrist"].x.value == pytest.approx(push, rel=1e-12, abs=1e-10)
    assert np.abs(loads.guide.value) == pytest.approx(np.abs(push * r * s / along), rel=1e-12, abs=1e-10)


def test_circular_gears_press_by_the_torque_over_the_base_radius() -> None:
    loads = even(HEAVY, PRESS).at(np.linspace(0.0, 6.2, 60))
    size = np.abs(loads.driven_torque.value) / (100.0 * np.cos(radians(20.0)))
    assert loads.mesh_force.size_n.value == pytest.approx(size, rel=1e-13)
    assert loads.mesh_force.pressure_angle_rad.value == pytest.approx(radians(20.0), rel=1e-15)


def test_standing_weights_are_borne() -> None:
    """Nearly at rest and unpressed, guide and crank bearing together bear all weights but the mesh force's part."""
    loads = even(HEAVY, SliderLoad(), rpm=1e-6).at(np.linspace(0.0, 6.2, 30))
    down = HEAVY.slider_kg + HEAVY.rod_kg + HEAVY.crank_kg
    upward = loads.guide.value + loads.crank_bearing.y.value + loads.mesh_force.force.y.value
    assert upward == pytest.approx(down * 9.0, rel=1e-12)
    assert loads.crank_bearing.x.value + loads.mesh_force.force.x.value == pytest.approx(-down * 3.0, rel=1e-11)


@pytest.mark.parametrize("name", ["stroke, e = 0", "displacement table"])
def test_forces_of_inertia_go_with_mass_and_speed_squared(name: str) -> None:
    free = SliderLoad()
    weightless = replace(HEAVY, gravity_m_s2=(0.0, 0.0))
    known = [(name, value) for name, value in vars(weightless).items() if isinstance(value, float)]
    names = [name for name, _ in known if name.endswith(("_kg", "inertia_kg_mm2"))]
    double = replace(weightless, **{name: 2.0 * getattr(weightless, name) for name in names})
    angle = np.array([1.7])
    slow = values(RigidMachine(machine(name, 20.0, load=free), weightless, OUTSIDE).at(angle))
    fast = values(RigidMachine(machine(name, 60.0, load=free), double, OUTSIDE).at(angle))
    assert fast == pytest.approx({name: 18.0 * value for name, value in slow.items()}, rel=1e-12, abs=1e-9)


def level_of(machine: RigidMachine) -> Rigid:
    return rigid_level(DrivingShaft(machine), [machine.place] if machine.place else [])


def test_no_mass_and_no_resistance_ask_for_nothing() -> None:
    level = level_of(even(RodMasses(), SliderLoad()))
    assert level.driving.peak_power_w.value == level.peaks.crank_bearing_n.value == 0.0
    assert level.fluctuation.swing_n_mm == 0.0


# --- peaks and flywheel --------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", ["uniform", "stroke, e = 0", "ratio table", "ellipse 1:2"])
def test_peaks_are_those_of_dense_samples(name: str) -> None:
    rigid = RigidMachine(machine(name, 60.0), HEAVY, OUTSIDE)
    peaks, loads = load_peaks(rigid), rigid.at(np.linspace(0.0, rigid.machine.transmission.cycle_rad, 20001)[:-1])
    least, most = DrivingShaft(rigid).torque_range_n_mm
    assert peaks.mesh is not None
    for peak, sampled in (
        (most.value, loads.driving_torque.value),
        (-least.value, -loads.driving_torque.value),
        (peaks.mesh.force_n.value, loads.mesh_force.size_n.value),
        (peaks.joints_n["wrist"].value, np.hypot(loads.joints["wrist"].x.value, loads.joints["wrist"].y.value)),
        (peaks.joints_n["pin"].value, np.hypot(loads.joints["pin"].x.value, loads.joints["pin"].y.value)),
        (peaks.crank_bearing_n.value, np.hypot(loads.crank_bearing.x.value, loads.crank_bearing.y.value)),
        (peaks.guide_n.value, np.abs(loads.guide.value)),
    ):
        # 20 000 samples: a smooth peak is missed by a square of the step, one at a joint or dead centre by the step
        assert sampled.max() <= peak * (1.0 + 1e-12)
        assert sampled.max() >= peak * (1.0 - 2e-3)


@pytest.mark.slow
def test_a_narrow_peak_of_a_table_is_neither_passed_over_nor_missed_in_the_work() -> None:
    """Half a millimetre of a stroke of 760 mm: 5000 N over a plain 100 N, on a slider alone."""
    spike = TableResistance((0.0, 400.0, 400.25, 400.5, 760.0), (100.0, 100.0, 5000.0, 100.0, 100.0))
    rigid = RigidMachine(machine("stroke, e = 0", 20.0, load=SliderLoad(spike)), RodMasses(slider_kg=1.0), OUTSIDE)
    level = level_of(rigid)
    made = rigid.machine
    at = brentq(lambda phi1: made.displacement(np.array([phi1]), 0).value[0] - 400.25, 0.1, 3.0, xtol=1e-15)
    push = 5000.0 + 1e-3 * made.motion(np.array([at])).acceleration[0]
    slant = np.hypot(1.0, rigid.at(np.array([at])).guide.value[0] / push)
    assert level.peaks.joints_n["wrist"].value == pytest.approx(push * slant, rel=1e-9)
    # The rod's slant changes at the peak, which moves the top of the wrist's force by 5e-9 rad
    assert level.peaks.joints_n["wrist"].at == pytest.approx(at, abs=2e-8)
    work = float(spike.work_n_mm(np.array([760.0]), 760.0)[0])
    assert level.fluctuation.work_n_mm == pytest.approx(work, rel=1e-12)


@pytest.mark.parametrize(("name", "rpm"), [("stroke, e = 0", 20.0), ("stroke, e = 0", 80.0), ("ellipse 1:2", 60.0)])
def test_flanks_change_where_the_torque_changes_its_sign(name: str, rpm: float) -> None:
    """Of 20 000 samples; at 80 r/min inertia reverses the load in the working stroke too."""
    rigid = RigidMachine(machine(name, rpm), HEAVY, OUTSIDE)
    cycle = rigid.machine.transmission.cycle_rad
    phi1 = (np.arange(20000) + 0.5) * cycle / 20000
    signs = np.sign(rigid.at(phi1).driving_torque.value)
    sampled = (phi1 + cycle / 40000)[signs != np.roll(signs, -1)]
    found = fluctuation(rigid).flank_changes_rad
    assert found == pytest.approx(sampled, abs=cycle / 20000)
    assert found.size >= 2


def test_flanks_never_change_under_a_load_without_inertia() -> None:
    assert fluctuation(even(RodMasses(), SliderLoad(PolynomialResistance((400.0,))))).flank_changes_rad.size == 0


@pytest.mark.thorough
def test_flywheel_keeps_the_speed_as_even_as_asked() -> None:
    """The shaft with that flywheel, driven by the mean torque: w^2 = w0^2 + 2 E / J, E summed from samples."""
    level = swing("stroke, e = 0")
    phi1 = (np.arange(100000) + 0.5) * 2.0 * pi / 100000
    torque = RigidMachine(machine("stroke, e = 0", 50.0), HEAVY, OUTSIDE).at(phi1).driving_torque.value
    stored = np.cumsum(torque.mean() - torque) * (phi1[1] - phi1[0])
    flywheel, w = level.flywheel_kg_mm2(0.04), 50.0 * RPM
    square = 2.0 * stored * 1e3 / flywheel
    speed = np.sqrt(w**2 + square - (square.max() + square.min()) / 2.0)
    # The energy is J (w_max^2 - w_min^2) / 2, for which C takes J C w^2: C^2 / 8 less
    assert np.ptp(speed) / w == pytest.approx(1.04**0.5 - 0.96**0.5, rel=1e-6)
    assert np.ptp(speed) / w == pytest.approx(0.04, rel=0.04**2 / 7.0)


@pytest.mark.slow
def test_flanks_beyond_90_degrees_are_refused() -> None:
    with pytest.raises(NoSuchMechanism, match=r"cannot push the driven gear at phi1 = .* pressure angle is 9\d"):
        level_of(RigidMachine(machine("stroke, law speed", 20.0), HEAVY, OUTSIDE))


@pytest.mark.slow
def test_without_gears_the_bearing_holds_the_linkage_alone() -> None:
    alone = RigidMachine(machine("uniform", 20.0), HEAVY)
    loads, geared = alone.at(np.array([1.0])), replace(alone, place=OUTSIDE).at(np.array([1.0]))
    assert loads.mesh is None
    assert load_peaks(alone).mesh is None
    assert loads.crank_bearing.x.value == pytest.approx(geared.crank_bearing.x.value + geared.mesh_force.force.x.value)
