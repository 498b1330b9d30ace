"""What is told of shafts, bearings and motors: figures made by hand in N mm and rad/s, told in N m, W and r/min."""

from __future__ import annotations

from math import pi
from types import SimpleNamespace
from typing import Any

import pytest

from ncgear.figures.advice.drivetrain_advice import _of_bearings, _of_jam, _of_keys, _of_motor, _of_pto, _of_shaft
from ncgear.figures.drivetrain import drivetrain_figures
from ncgear.numerics.extrema import Extremum
from ncgear.project.motor import MotorResult

pytestmark = pytest.mark.judges("figures")

Made: Any = SimpleNamespace
SPEED = 2.0 * pi
"""60 r/min: a cycle of two turns takes two seconds."""

LOSSES = Made(
    useful_n_mm=9e5,
    mesh_friction=0.1,
    mesh_loss_factor=0.2,
    mesh_n_mm=2e4,
    mesh_share=0.02,
    guide_friction=0.1,
    guide_n_mm=1e4,
    efficiency=0.9,
)
DEMAND = Made(
    losses=LOSSES,
    speed_rad_s=SPEED,
    cycle=Made(cycle_rad=4.0 * pi),
    torque_range_n_mm=(Extremum(-2e5, 1.0), Extremum(6e5, 2.0)),
    fluctuation=Made(work_n_mm=9.3e5),
)
COURSE = Made(
    mean_rad_s=0.99 * SPEED,
    range_rad_s=(Extremum(0.9 * SPEED, 1.0), Extremum(1.1 * SPEED, 2.0)),
    motor_range_n_mm=(-3e4, 5e4),
    fluctuation=0.2,
    period_s=0.5,
    rms_n_mm=2e4,
    drive_work_n_mm=4e5,
    energy_error=1e-9,
    unsettled=1e-9,
)


def motor(**changes: Any) -> Any:
    load = {"speed_rad_s": 20.0 * SPEED, "rms_n_mm": 3e4, "rms_power_n_mm_s": 4e6, "mean_n_mm": 1e4}
    load |= {"most_n_mm": Extremum(6e4, 2.0), "least_n_mm": Extremum(-2e4, 1.0), "braking_n_mm": -5e3}
    given = {"rated_torque_n_m": 25.0, "rated_speed_rpm": 1450.0, "peak_torque_n_m": 90.0, "gearbox": Made(ratio=20.0)}
    values = {"given": Made(**given), "demand": DEMAND, "load": Made(**load, braking_share=0.25), "stops": ""}
    values |= {"faults": set()}
    return Made(**values | {"course": None, "rms_n_m": 24.0, "most_n_m": 60.0} | changes)


def bearing(**changes: Any) -> Any:
    values = {"largest_n": Extremum(5000.0, 1.0), "equivalent_n": 3000.0, "speed_rad_s": SPEED, "life_h": 9000.0}
    values |= {"thrust_n": Extremum(0.0, 0.0), "static_n": 5000.0}
    values |= {"needed_rating_n": 26000.0, "bearing": Made(dynamic_rating_n=28000.0), "static_safety": 2.0}
    return Made(**values | {"within_iso_281": True} | changes)


def shaft(**changes: Any) -> Any:
    part = Made(section=Made(diameter_mm=30.0), stresses=None, fatigue=2.0, yielding=3.0)
    part.stresses = Made(
        bending_amplitude_mpa=40.0, bending_mean_mpa=5.0, torsion_amplitude_mpa=20.0, torsion_mean_mpa=10.0
    )
    key = Made(pressure_mpa=50.0, safety=2.0, both_senses=False, key=Made(length_mm=20.0, longest_mm=41.0))
    values = {"bearings": (bearing(), bearing()), "most_bent": Made(moment_n_mm=7e4, at_mm=12.0), "shaft": part}
    values |= {
        "words": "driving shaft",
        "key": key,
        "jammed": None,
        "jammed_key": None,
        "decided_by": {},
        "enough_mm": 36.0,
    }
    return Made(**values | changes)


def result(**changes: Any) -> Any:
    values = {"demand": DEMAND, "shafts": (shaft(), None), "wanted_fluctuation": 0.05}
    values |= {"flywheel_kg_mm2": 2e6, "disc": None, "motor": motor(course=COURSE), "pto": None}
    return drivetrain_figures(Made(**values | changes))


def test_losses_are_powers_of_a_cycle() -> None:
    found = result()["losses"]
    assert found["useful_power_w"] == pytest.approx(450.0)
    assert found["mesh_loss_w"] == pytest.approx(10.0)
    assert found["guide_loss_w"] == pytest.approx(5.0)
    assert found["mesh_efficiency"] == pytest.approx(0.98)
    assert found["mean_power_with_tooth_friction_w"] == pytest.approx(465.0)
    assert found["peak_driving_torque_with_tooth_friction_n_m"] == pytest.approx(600.0)
    assert found["least_driving_torque_with_tooth_friction_at_rad"] == 1.0
    assert result()["flywheel"]["inertia_needed_on_driving_shaft_kg_m2"] == pytest.approx(2.0)


def test_shafts_and_bearings_in_their_units() -> None:
    jam = Made(
        torques_n_mm=(8e5, 6e5),
        largest_n=(Extremum(1.0, 0.0), Extremum(2.0, 0.0)),
        static_safety=(1.0, 2.0),
        yielding=1.5,
    )
    found = result(shafts=(shaft(jammed=jam),))["driving_shaft"]
    assert found["largest_bending_moment_n_m"] == pytest.approx(70.0)
    assert found["bearing_a"]["mean_speed_rpm"] == pytest.approx(60.0)
    assert found["jam"]["torque_n_m"] == pytest.approx(800.0)
    assert (found["jam"]["bearing_b_force_n"], found["jam"]["bearing_b_static_safety"]) == (2.0, 2.0)


def test_a_motor_at_even_speed_and_with_a_flywheel() -> None:
    """25 N m at 1450 r/min are 3796 W; 450 W of use from 10 N m at 20 turns a second; 0.4 kJ in half a second."""
    found = result()["motor"]
    assert found["rated_power_w"] == pytest.approx(25.0 * 1450.0 * pi / 30.0)
    even, course = found["even_speed"], found["with_flywheel"]
    assert even["motor_speed_rpm"] == pytest.approx(1200.0)
    assert (even["rms_torque_n_m"], even["rms_torque_of_rated"]) == (pytest.approx(30.0), pytest.approx(1.2))
    assert (even["needed_power_w"], even["mean_torque_n_m"]) == (pytest.approx(4000.0), pytest.approx(10.0))
    assert (even["peak_torque_n_m"], even["peak_torque_safety"]) == (pytest.approx(60.0), pytest.approx(1.5))
    assert even["most_braking_power_w"] == pytest.approx(-20.0 * 20.0 * SPEED)
    assert even["mean_power_while_braking_w"] == pytest.approx(-5.0 * 20.0 * SPEED)
    assert even["time_braking_percent"] == 25.0
    assert even["efficiency_gearbox_included"] == pytest.approx(450.0 / (10.0 * 20.0 * SPEED))
    assert (course["mean_speed_rpm"], course["least_speed_rpm"]) == (pytest.approx(59.4), pytest.approx(54.0))
    assert course["largest_speed_rpm"] == pytest.approx(66.0)
    assert (course["strokes_per_minute"], course["mean_driving_power_w"]) == (120.0, pytest.approx(800.0))
    assert (course["rms_torque_n_m"], course["rms_torque_of_rated"]) == (pytest.approx(20.0), pytest.approx(0.8))
    assert (course["peak_torque_n_m"], course["peak_torque_safety"]) == (pytest.approx(50.0), pytest.approx(1.8))
    assert course["most_braking_torque_n_m"] == pytest.approx(-30.0)
    braked = motor()
    braked.load.mean_n_mm = -1.0
    assert result(motor=braked)["motor"]["even_speed"]["efficiency_gearbox_included"] is None


def slip(end_rad: float | None, speed: float) -> Any:
    speeds = {"speed_rad_s": Extremum(speed, 2.0), "heat_n_mm": 3e4, "energy_n_mm": 5e3}
    return Made(start_rad=pi / 2.0, last_rad=pi, end_rad=end_rad, **speeds)


def test_couplings_that_let_go() -> None:
    pto = Made(slips=[slip(pi, 0.5 * SPEED), slip(pi, 0.8 * SPEED)], runs_ahead=[slip(pi, 1.5 * SPEED)])
    found = result(pto=pto)["pto"]
    assert found["torque_limiter"]["slips_at_deg"][0] == pytest.approx([90.0, 180.0])
    assert found["torque_limiter"]["least_speed_rpm"] == pytest.approx(30.0)
    assert found["torque_limiter"]["heat_w"] == pytest.approx(30.0)
    assert found["overrunning_clutch"]["largest_speed_rpm"] == pytest.approx(90.0)
    assert found["overrunning_clutch"]["largest_energy_gained_j"] == pytest.approx(5.0)
    (slips,) = _of_pto(pto, 700.0)
    assert slips.remedies[0].text.startswith("drivetrain.pto.torque_limiter_n_m: 700")
    assert "in every cycle" in slips.what
    lasting = Made(slips=[slip(None, 0.5 * SPEED)], runs_ahead=[slip(None, 2.0)])
    assert result(pto=lasting)["pto"]["torque_limiter"]["stops_the_machine"]
    assert ["stops the machine" in one.what or "not caught again" in one.what for one in _of_pto(lasting, 7.0)] == [
        True,
        True,
    ]


DRIVING, DRIVEN = (Made(words=f"{name} shaft", key=f"{name}_shaft") for name in ("driving", "driven"))


def told(rows: Any) -> list[str]:
    return [f"{one.what}: {one.remedies[0].text}" for one in rows]


def test_nothing_is_told_of_parts_that_hold() -> None:
    assert not [*_of_bearings(DRIVING, shaft(), 8000.0), *_of_shaft(DRIVING, shaft()), *_of_jam(DRIVING, shaft())]
    assert not list(_of_motor(Made(), motor(), motor()))


def test_parts_that_do_not_hold_are_told_with_values_that_do() -> None:
    (life,) = told(_of_bearings(DRIVING, shaft(bearings=(bearing(),)), 10_000.0))
    assert "9000 h, and 10000 h are wanted" in life
    assert "dynamic_rating_n: 26000" in life
    (half,) = told(_of_bearings(DRIVING, shaft(bearings=(bearing(within_iso_281=False),)), 1.0))
    assert "dynamic_rating_n: 6000" in half
    (dented,) = told(_of_bearings(DRIVING, shaft(bearings=(bearing(static_safety=0.9),)), 1.0))
    assert "static_rating_n: 5000" in dented

    weak = shaft()
    weak.shaft.fatigue, weak.key.safety, weak.key.both_senses = 1.1, 0.5, True
    bent, pressed = told(_of_shaft(DRIVEN, weak))
    assert "1.1 against fatigue" in bent
    assert "diameter_mm: 36" in bent
    assert "50 MPa, and 25 MPa are allowed" in pressed
    assert "length_mm: 40" in pressed

    weak.key.key.longest_mm = 39.0
    assert "a thicker driving shaft, or a hub with a longer key" in str(
        [one.remedies for one in _of_shaft(DRIVING, weak)]
    )
    weak.key.safety = 0.8
    weak.jammed = Made(static_n=(9e3, 1e3), static_safety=(0.5, 3.0), yielding=1.2 / 8.0)
    weak.jammed_key = weak.key
    jam, yields, sheared = told(_of_jam(DRIVEN, weak))
    assert "bearing a" in jam
    assert "static_rating_n: 9000" in jam
    assert "length_mm: 25" in sheared
    # The stress goes with the cube of the diameter: the 8th of 1.2 needs twice the diameter, more for more
    from ncgear.figures.advice.drivetrain_advice import LEAST_SAFETY

    diameter = float(yields.partition("diameter_mm: ")[2].split()[0])
    assert diameter == pytest.approx(60.0 * (LEAST_SAFETY / 1.2) ** (1.0 / 3.0), rel=1e-3)


def test_keys_whose_torque_changes_its_sense_are_not_judged_once_for_all_shafts() -> None:
    """Their safety is kept, so that nothing is broken; a shaft whose torque keeps its sense is not named."""
    turning, even = shaft(), shaft()
    turning.key.both_senses = True
    (both,) = _of_keys([DRIVING, DRIVEN], [turning, turning])
    assert both.why.startswith("the torque of the driving shaft and driven shaft changes its sense")
    (one,) = _of_keys([DRIVING, DRIVEN], [even, turning])
    assert one.why.startswith("the torque of the driven shaft changes its sense")
    assert not list(_of_keys([DRIVING, DRIVEN], [even, None]))


def test_a_motor_that_does_not_do_is_told_with_one_that_does_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ncgear.project.motor.fitting_geared", lambda design, found: {"drivetrain.motor.x": 3.0})

    def rows(turns_rpm: float = 1200.0, **changes: Any) -> list[Any]:
        made = motor(turns_rpm=turns_rpm, **changes)
        faults: Any = MotorResult.faults
        made.faults = faults.fget(made)
        return list(_of_motor(Made(design=None), made, made))

    assert not rows()
    both = rows(rms_n_m=27.0, most_n_m=95.0)
    assert [one.what.partition(", more")[2] for one in both] == [" than its rated 25 N m", " than its 90 N m"]
    assert [[remedy.text for remedy in one.remedies] for one in both] == [["drivetrain.motor.x: 3"], []]
    (fast,) = rows(turns_rpm=1800.0)
    assert "turns at 1800 r/min, faster than the 1450 r/min" in fast.what
    (slow,) = rows(course=Made(mean_rad_s=0.9 * SPEED))
    assert "runs at 54 r/min, not at operation.speed_rpm: 60" in slow.what
