"""The motion in time of two pairs in series against another solver, limits, and the rigid level."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drives import drive_of_text
from ncgear.dynamics import motion_in_time
from ncgear.dynamics.crank_load import CrankLoad
from ncgear.dynamics.history import history, pressed_rad
from ncgear.dynamics.meshing import Impact, Meshing
from ncgear.dynamics.motion_in_time import Course, EvenDrive, ToothedMachine, course
from ncgear.dynamics.place_by_place import StateByState, TrainByState
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.periodic_table import PeriodicTable
from test_flank_changes import INERTIA, LEVER_MM, PLAY_RAD, SPEED, TURN, TURNING, saw, teeth
from test_series_shafts import TEXT
from test_train_knocks import ALONG_MM, SLOPES, damping, rubbing, with_slope

Array = np.ndarray
SLOPE = SLOPES[-1]
TORQUE = 1e5
"""Slope of the saw-shaped torque in N mm/rad."""


def sawing(inertia: float = INERTIA) -> CrankLoad:
    """A driven side of even inertia against a torque that is ``saw`` of its own angle."""
    breaks = np.array([0.0, 0.5 * pi, 1.5 * pi, TURN])
    begins, slopes = np.array([0.0, 0.5 * pi, -0.5 * pi]) * TORQUE, np.array([1.0, -1.0, 1.0]) * TORQUE
    widths = np.diff(breaks)
    work = np.cumsum(np.append(0.0, begins * widths + slopes * widths**2 / 2.0))[:-1]
    coefficients = np.zeros((4, 3, 2))
    coefficients[3, :, 0] = inertia
    coefficients[1:, :, 1] = slopes / 2.0, begins, work
    return CrankLoad(PeriodicTable(breaks, coefficients, np.zeros(2)), (0.0, pi))


def full(meshing: Meshing) -> Meshing:
    """With as many coefficients as plain numbers expect: laws of order 5, gaps of order 3."""

    def padded(table: PeriodicTable, rows: int) -> PeriodicTable:
        missing = rows - len(table.coefficients)
        return replace(
            table, coefficients=np.pad(table.coefficients, [(missing, 0), *[(0, 0)] * (table.coefficients.ndim - 1)])
        )

    return replace(meshing, law=padded(meshing.law, 6), gaps=replace(meshing.gaps, table=padded(meshing.gaps.table, 4)))


def machine(between: float, rub: float = 0.0, share: float = 0.2) -> ToothedMachine:
    one = full(rubbing(teeth(damping=damping(share, between)), rub))
    return ToothedMachine(EvenDrive(SPEED), with_slope(one, SLOPE), sawing(), (one,), (between,))


def started_at(phi1_rad: float) -> Array:
    """A state on the law, whose last pair bears the torque asked there, as the pair before it does."""
    asked = float(saw(np.array([SLOPE * phi1_rad]))[0])
    first = phi1_rad - SLOPE * asked / TURNING
    last = SLOPE * first - asked / TURNING
    return np.array([phi1_rad, SPEED, last, SLOPE * SPEED, 0.0, 0.0, first, SPEED])


def by_hand(one: ToothedMachine, state: Array, end_s: float) -> tuple[Array, Array, Array]:
    """Radau follows the angles of both shafts, each pair as two springs with damping about a gap, and friction."""
    between, impacts, rub = one.between_n_mm_s2[0], [one.before[0].impact, one.meshing.impact], one.meshing.friction

    def moment(impact: Impact, gap: float, rate: float) -> float:
        """Of a driven gear that is ``gap`` beyond its law, at the speed ``rate``: 0 within the play."""
        pressed = -gap if gap < 0.0 else gap - PLAY_RAD
        if pressed <= 0.0:
            return 0.0
        sign = 1.0 if gap < 0.0 else -1.0
        full = impact.damping_n_s_mm if LEVER_MM * pressed > impact.full_damping_depth_mm else 0.0
        return sign * LEVER_MM * max(pressed * TURNING / LEVER_MM - full * sign * LEVER_MM * rate, 0.0)

    def moments(t: float, q1: float, q2: float, w1: float, w2: float) -> tuple[float, float]:
        first = moment(impacts[0], q1 - float(state[0]) - SPEED * t, w1 - SPEED)
        return first, moment(impacts[1], q2 - SLOPE * q1, w2 - SLOPE * w1)

    def slope(t: float, now: Array) -> Array:
        m1, m2 = moments(t, *now)
        r1, r2 = (rub.dynamic * abs(m) / LEVER_MM for m in (m1, m2))
        turned = m1 + r1 * ALONG_MM[0] - SLOPE * m2 - r2 * ALONG_MM[1]
        asked = float(saw(np.array([now[1]]))[0])
        return np.array([now[2], now[3], turned / between, (m2 + r2 * ALONG_MM[0] - asked) / INERTIA])

    begin = [state[6], state[2], state[7], state[3]]
    found = solve_ivp(slope, (0.0, end_s), begin, "Radau", rtol=1e-8, atol=1e-11, max_step=5e-5)
    assert found.success
    both = np.array([moments(t, *now) for t, now in zip(found.t, found.y.T, strict=True)])
    return found.t, both[:, 0], both[:, 1]


def moments_of(out: Course) -> list[Array]:
    """The moments of normal forces on the driven gears of all pairs at the solver's steps, without friction's part."""
    answer = out.machine.answer(out.at(out.fine_s))
    return [np.sum(one.normal_n * one.near.urge * one.near.lever_mm, axis=-1) for one in answer.teeth]


def reversal(one: ToothedMachine) -> tuple[Array, float]:
    """A state shortly before the torque reverses, and the turns until the knocks have rung."""
    return started_at((pi - 0.05) / SLOPE), 0.13 / SLOPE / TURN


@pytest.mark.slow
@pytest.mark.judges("dynamics")
@pytest.mark.parametrize(("share", "rub"), [(0.5, 0.0), (0.5, 0.1), (0.1, 0.0)])
def test_both_pairs_knock_as_in_another_solver(share: float, rub: float) -> None:
    """The largest moments of both pairs, on both sides, within half a percent."""
    one = machine(share * INERTIA, rub)
    state, turns = reversal(one)
    out = course(one, state, turns)
    assert out.energy_error < 1e-5
    _, *other = by_hand(one, state, float(out.time_s[-1]))
    for own, hand in zip(moments_of(out), other, strict=True):
        assert own.min() == pytest.approx(hand.min(), rel=5e-3)
        assert own.max() == pytest.approx(hand.max(), rel=5e-3)
        assert hand.min() < -1.19e4
    # Without the shaft's inertia knocks are others.
    heavier = course(replace(one, between_n_mm_s2=(1.5 * share * INERTIA,)), state, turns)
    assert abs(moments_of(heavier)[0].min() / moments_of(out)[0].min() - 1.0) > 0.03


@pytest.mark.slow
@pytest.mark.judges("dynamics")
def test_a_light_shaft_on_a_stiff_pair_without_play_is_no_shaft() -> None:
    """The other pair then knocks as one by itself, within 2 %; on a soft pair it does not."""
    one = machine(0.5 * INERTIA)
    state, turns = reversal(one)
    alone = course(replace(one, before=(), between_n_mm_s2=()), state[:6], turns)
    found = []
    for stiff in (300.0, 1.0):
        tight = full(teeth(play_rad=0.0, damping=one.meshing.impact.damping_n_s_mm)).stiffened(stiff)
        light = replace(one, before=(tight,), between_n_mm_s2=(2e-3 * INERTIA,))
        found.append(moments_of(course(light, state, turns))[1].min())
    single = moments_of(alone)[0].min()
    assert found[0] == pytest.approx(single, rel=0.02)
    assert abs(found[1] / single - 1.0) > 0.05


@pytest.mark.judges("dynamics")
def test_states_by_themselves_are_those_of_arrays() -> None:
    """In states with either pair pressed, apart and on its backs."""
    one = machine(0.5 * INERTIA, 0.1)
    rates = TrainByState(one.drive.answer, one.meshing, one.load, one.before, one.between_n_mm_s2).change
    rng = np.random.default_rng(3)
    for _ in range(12):
        state = started_at(float(rng.uniform(0.0, 9.0)))
        state[[2, 6]] += rng.uniform(-2.0, 2.0, 2) * PLAY_RAD
        state[[3, 7]] += rng.uniform(-0.05, 0.05, 2)
        answer = one.answer(state)
        first, last = answer.teeth
        turned = (first.driven_n_mm.sum() + last.driving_n_mm.sum()) / one.between_n_mm_s2[0]
        told = [SPEED, 0.0, state[7], turned, state[3], answer.acceleration2_rad_s2]
        assert rates(state[one.rows]) == pytest.approx(np.array(told, dtype=float), rel=1e-12)


@pytest.mark.judges("dynamics")
@pytest.mark.parametrize(("pairs", "told"), [(1, "60 steps on one place"), (2, "steps too narrow to count")])
def test_steps_beyond_all_numbers_are_refused(monkeypatch: pytest.MonkeyPatch, pairs: int, told: str) -> None:
    """Teeth that may be asked for at the start alone: every trial step overflows."""
    one, state, asked, right = machine(0.5 * INERTIA), started_at(2.0), list[int](), StateByState._teeth
    if pairs == 1:
        one, state = replace(one, before=(), between_n_mm_s2=()), state[:6]

    def teeth(self: StateByState, *shafts: float) -> tuple[float, ...]:
        asked.append(1)
        return right(self, *shafts) if len(asked) <= pairs else (1e300**2,)

    monkeypatch.setattr(StateByState, "_teeth", teeth)
    monkeypatch.setattr(motion_in_time, "MOST_STEPS", 60)
    with pytest.raises(NoSuchMechanism, match=f"does not get on: after 0 s, {told}"):
        course(one, state, 0.1)


def test_each_pair_parts_by_its_own_shafts() -> None:
    one = machine(0.5 * INERTIA)
    states = np.stack([started_at(2.0), started_at(2.0)], axis=1)
    states[6, 1] += 0.01
    pressed = [pressed_rad(meshing, shafts) > 0.0 for meshing, shafts in one.pairs(states)]
    assert [side.tolist() for side in pressed[0]] == [[True, False], [False, True]]
    assert one.law_rad(np.array([2.0])) == pytest.approx([2.0 * SLOPE])


@pytest.mark.slow
def test_forces_of_settled_pairs_are_those_of_the_rigid_level() -> None:
    """Means over a tenth of a turn without play: both meshes, shaft between and crank bearing, both components."""
    text = TEXT[: TEXT.index("drivetrain:")].replace("backlash_mm: 0.1", "backlash_mm: 0").replace("[100, 4]", "[4000]")
    made = drive_of_text(f"{text}simulation: {{turns: 0.1, damping_ratio: 0.5, friction: {{dynamic: 0, static: 0}}}}\n")
    out, rigid = made.course, made.rigid.machine
    shown = history(out, rigid, np.linspace(0.2, 1.0, 4001) * out.time_s[-1])
    loads = rigid.at(shown.phi1_rad)
    assert loads.mesh is not None
    for name, law in (
        ("mesh", loads.mesh.force),
        ("mesh_before 0", loads.meshes_before[0].force),
        ("between_bearing 0", loads.between_bearings[0]),
        ("crank_bearing", loads.crank_bearing),
    ):
        own, size = shown.forces[name], float(np.hypot(law.x.value, law.y.value).mean())
        assert float(np.mean(own.x - law.x.value)) == pytest.approx(0.0, abs=0.02 * size), name
        assert float(np.mean(own.y - law.y.value)) == pytest.approx(0.0, abs=0.02 * size), name
    assert out.energy_error < 1e-5


@pytest.mark.slow
@pytest.mark.judges("strength")
def test_strength_rates_what_two_pairs_bear_in_time() -> None:
    """Its largest forces are 0.94 and 1.01 of a second turn's: where teeth swing though their load does not turn."""
    made = drive_of_text(TEXT[: TEXT.index("drivetrain:")] + "simulation: {turns: 2}\n")
    out = made.course
    states = out.at(out.fine_s)
    later = (states[0] > TURN)[:, None]
    for pair, teeth_of in zip(made.by_stage, out.machine.answer(states).teeth, strict=True):
        rated, borne = pair.loading_by("estimate"), float((teeth_of.normal_n * later).max())
        assert 0.9 * borne < rated.contacts.force_n.max() < 1.15 * borne
        assert rated.still is not None
        assert rated.still.contacts.force_n.max() < 0.8 * borne
