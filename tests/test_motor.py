"""A motor that cannot move its machine is told at once, where and by how much, and so is one of another speed."""

from __future__ import annotations

import re
from math import cos, sin, sqrt

import pytest
from scipy.optimize import brentq

from commands import Run, on_text
from drives import drive_of_text
from ncgear.dynamics import motion_in_time
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures.advice.values import Kind
from ncgear.figures.advice.verdict import KnownParts, State, judged
from ncgear.project.drive import Drive
from ncgear.project.motor import motor_stall, motor_within, steady_rad_s

FORCE, CRANK, ROD = 400.0, 38.0, 96.0

HEAD = """\
name: press
linkage: {crank_mm: 38, rod_mm: 96}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
resistance: {polynomial_n: [400]}
gears: {teeth: 19, module_mm: 1.5, face_width_mm: 10}
masses: {slider_kg: 1, rod: {mass_kg: 0.3, center_mm: 40, inertia_kg_mm2: 300}, crank: {mass_kg: 0.4, center_mm: 10, \
inertia_kg_mm2: 200}, driving_gear_kg_mm2: 5000, driven_gear_kg_mm2: 50}
"""


def with_motor(no_load_rpm: float, stall_n_m: float, start: str = "on_law") -> str:
    motor = f"{{no_load_speed_rpm: {no_load_rpm:g}, stall_torque_n_m: {stall_n_m:.9g}}}"
    return f"{HEAD}simulation: {{start: {start}, motor: {motor}}}\n"


def pushed_mm(phi: float) -> float:
    """The slider's way from its retracted dead centre on, of an in-line crank-slider."""
    return sqrt(ROD**2 - (CRANK * sin(phi)) ** 2) - CRANK * cos(phi) - (ROD - CRANK)


def heavy(text: str) -> str:
    """With a flywheel that is slow to start, far below the speed without load."""
    return text.replace("driving_gear_kg_mm2: 5000", "driving_gear_kg_mm2: 3e6")


@pytest.mark.slow
def test_a_constant_torque_stops_where_its_work_is_that_of_the_force() -> None:
    """From rest, next to no loss of torque by speed: S phi = F x(phi), whatever the masses are."""
    # The most that the force needs in the mean from the start on
    least, hardest = max((FORCE * pushed_mm(phi) / phi, phi) for phi in (0.01 * k for k in range(1, 315)))
    for share in (0.5, 0.8, 0.98):
        torque = share * least
        expected = brentq(lambda phi, torque=torque: torque * phi - FORCE * pushed_mm(phi), 0.05, hardest)
        stall = motor_stall(drive_of_text(heavy(with_motor(1e6, torque / 1000.0, "rest"))))
        assert stall is not None
        assert stall.phi1_rad == pytest.approx(expected, abs=1e-4)
        assert stall.crank_rad == pytest.approx(expected, abs=1e-4)
        assert stall.given_n_mm == pytest.approx(torque)
        slope = (pushed_mm(expected + 1e-4) - pushed_mm(expected - 1e-4)) / 2e-4
        assert stall.needed_n_mm == pytest.approx(FORCE * slope, rel=1e-3)
        assert stall.needed_n_mm > torque
    # Negative control: a little more torque passes that one place
    assert motor_stall(drive_of_text(heavy(with_motor(1e6, 1.02 * least / 1000.0, "rest")))) is None


def motor_row(drive: Drive, known: KnownParts = KnownParts.MOTION) -> tuple[State, str]:
    (row,) = (row for row in judged(drive, known).rows if row.kind is Kind.MOTOR)
    return row.state, "; ".join(advice.line for advice in row.advices) or row.why


def told_keys(said: str, group: str) -> dict[str, str]:
    """The keys below a group that an advice tells, with their values."""
    return dict(re.findall(rf"{re.escape(group)}([a-z_.]+): ([0-9.e+-]+)", said))


@pytest.mark.long
@pytest.mark.slow
def test_the_verdict_names_the_motor() -> None:
    state, said = motor_row(drive_of_text(with_motor(90, 1.0)))
    assert state is State.BROKEN
    assert "the motor stops at phi1 = " in said
    assert "gives 1 N m at rest" in said
    state, said = motor_row(drive_of_text(with_motor(30, 200.0)))
    assert state is State.BROKEN
    assert "the machine runs at 29." in said
    assert motor_row(drive_of_text(with_motor(60.6, 200.0))) == (State.KEPT, "")


@pytest.mark.tiers(slow=["90-1.0"], rest="long")
@pytest.mark.parametrize(("no_load", "stall_n_m"), [(30, 200.0), (90, 1.0), (90, 8.0)])
def test_the_motor_that_is_told_does(no_load: float, stall_n_m: float) -> None:
    """The keys as told, put into the file, give a verdict without a word on the motor."""
    keys = told_keys(motor_row(drive_of_text(with_motor(no_load, stall_n_m)))[1], "simulation.motor.")
    given = {"no_load_speed_rpm": f"{no_load:g}", "stall_torque_n_m": f"{stall_n_m:g}"}
    mended = {**given, **keys}
    assert mended != given
    text = with_motor(float(mended["no_load_speed_rpm"]), float(mended["stall_torque_n_m"]))
    assert motor_row(drive_of_text(text)) == (State.KEPT, "")


@pytest.mark.slow
def test_a_motor_that_cannot_go_on_is_told_though_its_flywheel_lasts_through_the_turn() -> None:
    drive = drive_of_text(heavy(with_motor(90, 2.0)))
    assert motor_stall(drive) is None
    with pytest.raises(NoSuchMechanism, match="stopped by it"):
        steady_rad_s(drive)
    state, said = motor_row(drive)
    assert state is State.BROKEN
    assert "from cycle to cycle" in said


def geared(rated_n_m: float, more: str = "") -> str:
    motor = f"{{rated_torque_n_m: {rated_n_m:g}, rated_speed_rpm: 1450, {more}gearbox: {{ratio: 24, efficiency: 0.9}}}}"
    return f"{HEAD}drivetrain: {{motor: {motor}}}\n"


@pytest.mark.slow
def test_a_motor_behind_a_gearbox_is_judged_before_teeth_are_made() -> None:
    """What a check says a build says, and the value that the check tells is enough for both."""
    weak, (least, most) = drive_of_text(geared(0.3)), motor_within(drive_of_text(geared(0.3)))
    for known in KnownParts:
        assert motor_row(weak, known)[0] is State.BROKEN
        assert motor_row(drive_of_text(geared(1.0)), known) == (State.KEPT, "")
    told = float(told_keys(motor_row(weak)[1], "drivetrain.motor.")["rated_torque_n_m"])
    for known in KnownParts:
        assert motor_row(drive_of_text(geared(told)), known) == (State.KEPT, "")
    # The friction of the teeth as they are lies between what a check looks at, where it says that this decides
    exact = weak.drivetrain.motor
    assert exact is not None
    assert least.rms_n_m < exact.rms_n_m < most.rms_n_m
    between = drive_of_text(geared(exact.rms_n_m))
    assert motor_row(between) == (State.NOT_JUDGED, "the friction between the teeth decides: ncgear build")


@pytest.mark.long
@pytest.mark.slow
def test_friction_between_teeth_may_relieve_a_motor_and_both_ends_are_told() -> None:
    """A force that drives the machine: the motor brakes, and rubbing teeth brake with it (T = T1 + share |T1|)."""
    text = geared(0.2).replace("{polynomial_n: [400]}", "{polynomial_n: [-400], where_negative: keep}")
    braking, (none, most) = drive_of_text(text), motor_within(drive_of_text(text))
    exact = braking.drivetrain.motor
    assert exact is not None
    assert most.rms_n_m < exact.rms_n_m < none.rms_n_m
    told = [float(number) for number in re.findall(r"([\d.]+) N m w", motor_row(braking)[1])]
    assert told == pytest.approx([none.rms_n_m, most.rms_n_m], rel=1e-3)
    assert f"{exact.rms_n_m:.4g} N m, more than" in motor_row(braking, KnownParts.TEETH)[1]
    enough = float(told_keys(motor_row(braking)[1], "drivetrain.motor.")["rated_torque_n_m"])
    assert enough >= none.rms_n_m
    assert motor_row(drive_of_text(text.replace("0.2,", f"{enough},")))[0] is State.KEPT
    between = text.replace("rated_torque_n_m: 0.2", f"rated_torque_n_m: {exact.rms_n_m}")
    assert motor_row(drive_of_text(between))[0] is State.NOT_JUDGED


OWN = "no_load_speed_rpm: 1500, peak_torque_n_m: 0.2, "


@pytest.mark.parametrize(
    "text",
    [
        geared(0.2, OWN).replace("ratio: 24", "ratio: 30"),
        pytest.param(geared(0.2, OWN), marks=pytest.mark.slow),
        pytest.param(geared(0.02, OWN), marks=pytest.mark.slow, id="stops"),
        pytest.param(
            geared(2.0, "peak_torque_n_m: 2, ") + "simulation: {motor: {no_load_speed_rpm: 70, stall_torque_n_m: 3}}\n",
            marks=pytest.mark.slow,
            id="line at the driving gear",
        ),
    ],
)
def test_the_motor_that_is_offered_holds_when_it_is_entered(text: str) -> None:
    """A stiffer motor takes more torque in its peaks than the motor that is judged.

    Control: all values but one of the told ones leave the motor as broken as it was.
    """
    state, said = motor_row(drive_of_text(text))
    assert state is State.BROKEN
    told = {
        **told_keys(said, "drivetrain.motor."),
        **told_keys(said, "simulation.motor."),
    }

    def entered(keys: list[str]) -> State:
        changed = text
        for key in keys:
            name = key.rpartition(".")[2]
            changed, count = re.subn(rf"\b{name}: [\d.]+", f"{name}: {told[key]}", changed)
            assert count == 1
        try:
            return motor_row(drive_of_text(changed))[0]
        except WrongInput:  # a peak under the rated torque
            return State.BROKEN

    assert entered(list(told)) is State.KEPT
    for left_out in told:
        assert entered([key for key in told if key != left_out]) is not State.KEPT


@pytest.mark.slow
def test_a_motor_that_stops_behind_its_gearbox_is_told_with_one_that_does() -> None:
    weak = geared(0.02, "no_load_speed_rpm: 1500, ")
    state, said = motor_row(drive_of_text(weak), KnownParts.TEETH)
    assert state is State.BROKEN
    assert "cannot keep the machine turning" in said
    keys = told_keys(said, "drivetrain.motor.")
    text = weak.replace("rated_torque_n_m: 0.02", f"rated_torque_n_m: {keys['rated_torque_n_m']}")
    text = text.replace("ratio: 24", f"ratio: {keys.get('gearbox.ratio', 24)}")
    assert motor_row(drive_of_text(text), KnownParts.TEETH) == (State.KEPT, "")


@pytest.mark.slow
def test_the_level_in_time_refuses_it_at_once(run: Run) -> None:
    outcome = on_text(run, "simulate")(with_motor(90, 1.0), "--level", "dynamic", "--out", "here")
    assert outcome[0] == 3
    assert "simulation.motor: the motor stops at phi1 = " in str(outcome)
    # The same motor that a check names
    named = told_keys(motor_row(drive_of_text(with_motor(90, 1.0)))[1], "simulation.motor.")
    assert named
    assert told_keys(" ".join(str(outcome).split()), "simulation.motor.") == named


@pytest.mark.slow
def test_a_motion_that_does_not_get_on_ends_with_its_time_and_crank_angle(monkeypatch: pytest.MonkeyPatch) -> None:
    """The motion in time by itself stands where the rigid machine's energy is used up."""
    monkeypatch.setattr(motion_in_time, "MOST_STEPS", 800)
    drive = drive_of_text(with_motor(90, 3.0))
    stall = motor_stall(drive)
    assert stall is not None
    vars(drive)["motor_stall"] = None
    with pytest.raises(NoSuchMechanism, match=r"after \d.* s, 800 steps on one place") as caught:
        _ = drive.course
    assert f"phi1 = {stall.phi1_rad:.1f}" in str(caught.value)
