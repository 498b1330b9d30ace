"""Forces with masses in chains of pairs and in rows of gears: Lagrange's equations in time, Newton and Euler in place.

The judge of torques knows the angles of all shafts in closed form.  It writes down a body for each shaft and a
constraint for each mesh, solves for accelerations and multipliers, and follows the bodies in time with scipy under the
driving torque that ncgear tells: a right torque keeps the driving shaft at its speed, and the multipliers are the
torques of the meshes.  The judge of forces takes the angles alone, and their differences.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from math import cos, pi, radians, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from drives import drive_of_text
from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from ncgear.ratio.transmission import turned_after

SPEED = 240.0 * pi / 30.0
LAST = 20_000.0 + 12_000.0
TURNED = "masses: {{shaft_kg_mm2: 20000, driven_gear_kg_mm2: 12000, driving_gear_kg_mm2: 9000{}}}\n"
ALONE = """\
name: chain
linkage: {{kind: none}}
operation: {{speed_rpm: 240}}
motion: {{law: ratio_expression, ratio: "{}", scale_to_close: true}}
gears: {{teeth: 40, module_mm: 3, face_width_mm: 20, {}}}
resistance: {{expression_n_m: "40 + 10*cos(x)"}}
"""
E = 0.2
"""Eccentricity of ellipses about their foci: tan of half of the angle grows by the factor Q in each mesh."""
Q = (1.0 + E) / (1.0 - E)
Shafts = Callable[[float], tuple[Array, Array, Array]]
"""Angles of all shafts with both derivatives by the driving angle, shape (n,) each."""


def shared(count: int) -> tuple[str, Shafts]:
    """Pairs that share a whole, F' = f/mean f, by f^(k/n), and the shafts' angles by sums over a fine grid."""

    def f(x: Array | float) -> Array:
        return np.asarray(1.0 / (1.0 + 0.3 * np.cos(x) + 0.1 * np.sin(2.0 * x)))

    even = 2.0 * pi * np.arange(4096) / 4096
    mean = [float(np.mean(f(even) ** (k / count))) for k in range(count + 1)]
    waves = [np.fft.rfft(f(even) ** (k / count) / m) / 4096 for k, m in enumerate(mean)]

    def angle(series: Array, x: float) -> float:
        order = np.arange(1, 200)
        terms = 2.0 * series[1:200] / (1j * order)
        return x + float(np.sum((terms * np.exp(1j * order * x)).real - terms.real))

    def shafts(x: float) -> tuple[Array, Array, Array]:
        bend = f(x) * (0.3 * sin(x) - 0.2 * cos(2.0 * x))
        rate = np.array([f(x) ** (k / count) / m for k, m in enumerate(mean)])
        return np.array([angle(one, x) for one in waves]), rate, rate * bend * np.arange(count + 1) / count

    return ALONE.format("1 + 0.3*cos(phi) + 0.1*sin(2*phi)", f"pairs: {count}"), shafts


def ellipses(count: int) -> tuple[str, Shafts]:
    """A straight row of equal ellipses about their foci."""

    def shafts(x: float) -> tuple[Array, Array, Array]:
        q = Q ** np.arange(count + 1)
        turn = np.floor((x + pi) / (2.0 * pi)) * 2.0 * pi
        across, along = q * sin(x / 2.0), cos(x / 2.0)
        size = across**2 + along**2
        angle = 2.0 * np.arctan(q * np.tan((x - turn) / 2.0)) + turn
        return angle, q / size, -q * (q**2 - 1.0) * sin(x) / 2.0 / size**2

    idlers = f"idlers: {{lobes: {[1] * (count - 1)}}}"
    return ALONE.format(f"{1.0 + E * E} - {2.0 * E}*cos(phi)", idlers), shafts


CHAINS = {
    **{f"{count} pairs": shared(count) for count in (2, 3, 4)},
    **{f"row of {count + 1}": ellipses(count) for count in (2, 3, 6)},
}
INERTIAS = (30_000.0, 20_000.0, 50_000.0, 10_000.0, 40_000.0)


@cache
def drive(name: str) -> Drive:
    text, count = CHAINS[name][0], len(CHAINS[name][1](0.0)[0]) - 1
    return drive_of_text(text + TURNED.format(f", shaft_between_kg_mm2: {list(INERTIAS[: count - 1])}"))


def followed(name: str, inertias: Sequence[float]) -> tuple[Array, Array]:
    """The driving shaft's speed, shape (m,), and its angles at even times of a turn, from ncgear's torque."""
    even, shafts = np.linspace(0.0, 2.0 * pi, 5761), CHAINS[name][1]
    # Periodic, since a wrong torque lets the shaft run past its turn.
    torque = CubicSpline(
        even, drive(name).driving.machine.at(even % (2.0 * pi)).driving_torque.value, bc_type="periodic"
    )

    def change(_: float, state: Array) -> list[float]:
        return [state[1], solved(shafts, inertias, state[0], state[1], float(torque(state[0])))[0]]

    times = np.linspace(0.0, 2.0 * pi / SPEED, 25)
    found = solve_ivp(change, (0.0, times[-1]), [0.0, SPEED], t_eval=times, rtol=1e-8, atol=1e-8, max_step=times[1])
    return found.y[1], found.y[0]


def solved(shafts: Shafts, inertias: Sequence[float], angle: float, speed: float, torque: float) -> tuple[float, Array]:
    """The driving shaft's acceleration and the torques of all meshes on their driven gears, in N mm.

    Bodies k = 0 to n have J a_k = M_k-1 - i_k M_k + given torque, and a_k+1 = i_k a_k + (di_k/dt) w_k, with i_k the
    speed of shaft k + 1 over that of shaft k.
    """
    turned, rate, bend = shafts(angle)
    count = rate.size - 1
    ratio = rate[1:] / rate[:-1]
    change = (bend[1:] - ratio * bend[:-1]) / rate[:-1] * speed
    body = 1e-3 * np.array([9000.0, *inertias, LAST])
    matrix, right = np.zeros((2 * count + 1, 2 * count + 1)), np.zeros(2 * count + 1)
    for k in range(count + 1):
        matrix[k, k] = body[k]
        if k:
            matrix[k, count + k] = -1.0
        if k < count:
            matrix[k, count + 1 + k] = ratio[k]
            matrix[count + 1 + k, k : k + 2] = -ratio[k], 1.0
            right[count + 1 + k] = change[k] * rate[k] * speed
    right[0], right[count] = torque, -1e3 * (40.0 + 10.0 * cos(turned[-1]))
    found = np.linalg.solve(matrix, right)
    return float(found[0]), found[count + 1 :]


def judged(name: str) -> None:
    """Compare a chain with the judge."""
    count = len(CHAINS[name][1](0.0)[0]) - 1
    between = INERTIAS[: count - 1]
    speed, angle = followed(name, between)
    assert np.abs(speed / SPEED - 1.0).max() < 2e-7
    loads = drive(name).driving.machine.at(angle)
    rates = np.array([CHAINS[name][1](one)[1] for one in angle])
    ours = np.array([one.value for one in loads.passed]).T / rates[:, 1:]
    theirs = np.array(
        [solved(CHAINS[name][1], between, x, SPEED, t)[1] for x, t in zip(angle, loads.passed[0].value, strict=True)]
    )
    assert np.abs(ours - theirs).max() < 1e-6 * np.abs(theirs).max()
    # Without the shafts between the speed would not stay.
    assert np.abs(followed(name, [0.0] * (count - 1))[0] / SPEED - 1.0).max() > 1e-2


@pytest.mark.judges("dynamics")
@pytest.mark.parametrize("name", ["3 pairs", "row of 4"])
def test_a_chain_under_its_torque_turns_evenly_by_lagrange(name: str) -> None:
    judged(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in CHAINS if name not in ("3 pairs", "row of 4")])
def test_further_chains_under_their_torque_turn_evenly_by_lagrange(name: str) -> None:
    judged(name)


STEP = 1e-4


def bent(bends: list[int]) -> str:
    """A row of equal gears with lines of centres that turn at the idlers."""
    idlers = f"idlers: {{lobes: {[1] * len(bends)}, bends_deg: {bends}}}"
    return ALONE.format("1 + 0.25*cos(phi)", f"driving_axis_deg: 200, {idlers}")


def cross(place: complex, force: complex) -> float:
    return float((place.conjugate() * force).imag)


@pytest.mark.judges("dynamics")
@pytest.mark.parametrize("bends", [[40, -70], [50]])
def test_forces_in_a_bent_row_balance_by_newton_and_euler(bends: list[int]) -> None:
    """The last gear turns clockwise, as every crank; so a row of an even number of pairs is seen from behind."""
    between = [30_000.0, 20_000.0][: len(bends)]
    made = drive_of_text(bent(bends) + TURNED.format(f", shaft_between_kg_mm2: {between}"))
    pairs, count = made.by_stage, 1 + len(bends)
    behind = 1.0 if count % 2 else -1.0
    turns = np.radians(np.cumsum([0, *bends]))
    towards = np.exp(1j * (radians(20.0) + behind * (turns - turns[-1])))
    axes = np.cumsum([0j, *(pair.pitch.center_distance_mm * one for pair, one in zip(pairs, towards, strict=True))])
    inertia = 1e-3 * np.array([0.0, *between, LAST])
    sense = behind * (-1.0) ** np.arange(count + 1)
    laws = [pair.pair.transmission for pair in pairs]
    for phi1 in (0.3, 1.9, 3.6, 5.2):
        loads = made.rigid.machine.at(np.array([phi1]))
        turned = phi1 + STEP * np.arange(-2, 3)
        angle = np.array([turned, *(one.value for one in turned_after(laws, turned, 0))])
        spun = (angle[:, 3] - 2.0 * angle[:, 2] + angle[:, 1]) / STEP**2 * SPEED**2
        meshes = [one.force for one in (*loads.meshes_before, loads.mesh_force)]
        forces, points = [complex(one.x.value[0], one.y.value[0]) for one in meshes], []
        for k, (pair, force) in enumerate(zip(pairs, forces, strict=True)):
            slope = np.gradient(angle[k + 1], angle[k])
            radius = pair.pitch.center_distance_mm * slope / (1.0 + slope)
            points.append(axes[k] + radius[2] * towards[k])
            # The driving gear's curve, as its places come to the line of centres one after the other
            curve = radius * np.exp(-1j * sense[k] * (angle[k] - angle[k][2]))
            tangent = (curve[1] - curve[3]) * towards[k]
            tangent /= abs(tangent)
            away = tangent * -1j * sense[k]
            side = np.sign((force * tangent.conjugate()).real)
            wanted = side * cos(radians(20.0)) * tangent + sin(radians(20.0)) * away
            assert force / abs(force) == pytest.approx(wanted, abs=1e-5)
        bearings = [complex(one.x.value[0], one.y.value[0]) for one in loads.between_bearings]
        for k in range(1, count):
            assert bearings[k - 1] == pytest.approx(forces[k] - forces[k - 1])
            moment = cross(points[k - 1] - axes[k], forces[k - 1]) - cross(points[k] - axes[k], forces[k])
            assert moment == pytest.approx(sense[k] * inertia[k] * spun[k], rel=1e-3, abs=2.0)
        resisting = 1e3 * (40.0 + 10.0 * cos(angle[-1, 2]))
        last = cross(points[-1] - axes[-1], forces[-1])
        assert last == pytest.approx(sense[-1] * (inertia[-1] * spun[-1] + resisting), rel=1e-5)
        assert cross(points[0], forces[0]) == pytest.approx(sense[0] * loads.driving_torque.value[0], rel=1e-6)


def test_shafts_between_are_counted() -> None:
    text = CHAINS["3 pairs"][0]
    with pytest.raises(WrongInput, match=r"1 given for two shafts between three pairs of gears") as refused:
        drive_of_text(text + TURNED.format(", shaft_between_kg_mm2: 30000"))
    assert "masses.shaft_between_kg_mm2" in str(refused.value)


def test_an_idler_counts_once() -> None:
    """An idler is one body in two meshes, while two gears are on the shaft between two pairs."""
    row = drive_of_text(bent([40, -70]) + "masses: {shaft_kg_mm2: 20000}\n")
    bodies = [pair.gear_inertia for pair in row.by_stage]
    assert row.train_inertia.between_kg_mm2 == tuple(one.driven_kg_mm2 for one in bodies[:-1])
    assert bodies[1].driving_kg_mm2 == pytest.approx(bodies[0].driven_kg_mm2, rel=1e-3)
