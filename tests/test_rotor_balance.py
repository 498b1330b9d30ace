"""Field balancing and chain drives: linear systems made up beforehand, and the published readings."""

from __future__ import annotations

from cmath import exp, phase
from dataclasses import replace
from math import degrees, pi, radians

import numpy as np
import pytest

from at_once import at_once
from ncgear.balance.rotor import (
    AmplitudeRange,
    ChainPhases,
    ChainUnbalance,
    TrialRun,
    WeightRun,
    balanced,
    chain_unbalance,
    opposite_weight_g,
    predicted,
)
from ncgear.errors import WrongInput


def polar(amplitude: float, phase_deg: float) -> complex:
    return amplitude * exp(1j * radians(phase_deg))


def test_the_published_first_balancing() -> None:
    """1.234 at 159, with 107.7 g at 90: 0.562 at 204; the instrument asked for 143.4 g at 115 degrees."""
    found = balanced([polar(1.234, 159)], [TrialRun(polar(107.7, 90), (polar(0.562, 204),))])
    (weight,) = found.weights
    assert abs(weight) == pytest.approx(143.4, abs=0.15)
    assert degrees(phase(weight)) == pytest.approx(115.0, abs=0.5)
    assert abs(found.residual[0]) <= 1e-15


def made_up(sensors: int, planes: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coefficients, the rotor's unbalance in each plane, and trial weights."""
    random = np.random.default_rng(seed)

    def draw(*shape: int) -> np.ndarray:
        return random.normal(size=shape) + 1j * random.normal(size=shape)

    return draw(sensors, planes), 50.0 * draw(planes), 20.0 * draw(planes)


@pytest.mark.parametrize("sensors", [2, 3, 5])
def test_two_planes_find_what_was_made_up(sensors: int) -> None:
    """A linear rotor: the corrections are the unbalance turned round, the coefficients those it was made with."""
    coefficients, unbalance, weights = made_up(sensors, 2)
    first = coefficients @ unbalance
    runs = [TrialRun(complex(w), tuple(first + coefficients[:, k] * w)) for k, w in enumerate(weights)]
    found = balanced(tuple(first), runs)
    assert found.coefficients == pytest.approx(coefficients, rel=1e-11)
    assert found.weights == pytest.approx(-unbalance, rel=1e-11)
    assert np.abs(found.residual).max() <= 1e-11 * np.abs(first).max()


def test_what_one_plane_cannot_do_stays() -> None:
    """Two sensors, one plane: the rest is at right angles to the plane's effect, and no other weight leaves less."""
    coefficients, _, weights = made_up(2, 1)
    first = np.array([3.0 + 1j, -2.0 + 0.5j])
    found = balanced(tuple(first), [TrialRun(complex(weights[0]), tuple(first + coefficients[:, 0] * weights[0]))])
    left = np.array(found.residual)
    assert abs(np.vdot(coefficients[:, 0], left)) <= 1e-12
    assert np.linalg.norm(left) > 0.1
    for turn in range(6):
        other = first + coefficients[:, 0] * (found.weights[0] + 0.1 * np.exp(1j * turn))
        assert np.linalg.norm(other) > np.linalg.norm(left)


FIRST = (1.0 + 0j, 0.5j)
REFUSED = {
    "weightless": ((TrialRun(0j, (1.1 + 0j, 0.5j)),), "trials.0.mass_g", "shows nothing"),
    "no effect": ((TrialRun(1 + 0j, FIRST),), "trials.0.readings", "changes nothing"),
    "readings": ((TrialRun(1 + 0j, (1.1 + 0j,)),), "trials.0.readings", "1 readings, but the first run has 2"),
    "planes": (
        (TrialRun(1 + 0j, (1.1 + 0j, 0.5j)), TrialRun(1 + 0j, (1.2 + 0j, 0.5j))),
        "trials",
        "effects are all alike",
    ),
    "sensors": (tuple(TrialRun(1 + 0j, (2j, 1j)) for _ in range(3)), "trials", "3 planes for 2 sensors"),
}


@at_once("name", REFUSED)
def test_readings_that_say_nothing_are_refused(name: str) -> None:
    runs, key, words = REFUSED[name]
    with pytest.raises(WrongInput, match=words) as error:
        balanced(FIRST, runs)
    assert error.value.key == key


# --- the chain drive ---------------------------------------------------------------------------------------------

TABLE_3 = (
    (60, 0.426, 275),
    (120, 0.502, 135),
    (180, 0.382, 124),
    (240, 0.513, 173),
    (300, 0.483, 209),
    (360, 0.465, 256),
)
"""Its row of 700 r/min: phase of 161.3 g, amplitude in mm/s, phase."""

RUNS = [WeightRun(radians(at), polar(amplitude, angle)) for at, amplitude, angle in TABLE_3]
PHASES = ChainPhases(wrap_rad=pi, tight_rad=radians(105.0), slack_rad=radians(270.0))
PUBLISHED = ChainUnbalance(AmplitudeRange(0.074, 0.214), AmplitudeRange(0.0, 2.04), AmplitudeRange(0.0, 2.58))


def test_the_published_ranges() -> None:
    """The slack side's 2.58 is not what the equations give (2.02); it comes out with a cosine for a sine at 300."""
    found = chain_unbalance(RUNS, PHASES)
    assert (round(found.weight.low, 4), round(found.weight.high, 4)) == (0.0743, 0.2136)
    assert (found.tight.low, found.tight.high) == pytest.approx((0.0, 2.045), abs=5e-4)
    assert found.slack.high == pytest.approx(2.024, abs=5e-4)
    slip = 0.483 * abs(np.cos(radians(209.0))) + found.weight.high * np.sin(radians(60.0))
    assert slip + found.tight.high * np.cos(radians(15.0)) == pytest.approx(2.58, abs=5e-3)


def test_ranges_hold_every_run() -> None:
    """By scanning: within the range of L_B all chain parts lie on the wrap's side, outside they do not."""
    found = chain_unbalance(RUNS, PHASES)

    def all_on_the_side(effect: float) -> bool:
        return all((run.reading - effect * exp(1j * run.phase_rad)).real < 0.0 for run in RUNS)

    for effect in np.linspace(0.001, 0.5, 500):
        assert all_on_the_side(effect) == (found.weight.low < effect < found.weight.high)
    sides = np.array([[exp(1j * PHASES.tight_rad), exp(1j * PHASES.slack_rad)]])
    system = np.vstack([sides.real, sides.imag])
    for effect in np.linspace(found.weight.low, found.weight.high, 20):
        for run in RUNS:
            chain = run.reading - effect * exp(1j * run.phase_rad)
            tight, slack = np.linalg.solve(system, [chain.real, chain.imag])
            assert found.tight.low - 1e-12 <= tight <= found.tight.high + 1e-12
            assert found.slack.low - 1e-12 <= slack <= found.slack.high + 1e-12


@pytest.mark.parametrize("turn", [0.4, 1.9])
def test_it_does_not_matter_from_where_phases_are_counted(turn: float) -> None:
    runs = [WeightRun(run.phase_rad + turn, run.reading * exp(1j * turn)) for run in RUNS]
    phases = ChainPhases(PHASES.wrap_rad + turn, PHASES.tight_rad + turn, PHASES.slack_rad + turn)
    found, before = chain_unbalance(runs, phases), chain_unbalance(RUNS, PHASES)
    for name in ("weight", "tight", "slack"):
        ends = [(getattr(one, name).low, getattr(one, name).high) for one in (found, before)]
        assert ends[0] == pytest.approx(ends[1], abs=1e-12)
    at = [
        predicted(one, two, 0.3 + more).amplitude for one, two, more in ((found, phases, turn), (before, PHASES, 0.0))
    ]
    assert at[0] == pytest.approx(at[1], rel=1e-12)


@pytest.mark.parametrize(("at", "amplitude"), [(30.0, 1.24), (270.0, 1.4)])
def test_the_published_predictions(at: float, amplitude: float) -> None:
    found = predicted(PUBLISHED, PHASES, radians(at))
    assert found.amplitude == pytest.approx(amplitude, abs=0.005)
    assert abs(found.by_slack) > abs(found.by_tight)


def test_the_weight_against_a_prediction() -> None:
    """With the effect of the first balancing; the published 152.3 g and 165.8 g are up to 6 per cent heavier."""
    effect = abs(balanced([polar(1.234, 159)], [TrialRun(polar(107.7, 90), (polar(0.562, 204),))]).coefficients[0, 0])
    for amplitude, at, opposite, published in ((1.24, 270.0, 90.0, 152.3), (1.4, 120.0, 300.0, 165.8)):
        weight = opposite_weight_g(amplitude, radians(at), effect)
        assert degrees(phase(weight)) % 360.0 == pytest.approx(opposite)
        assert 0.0 < published / abs(weight) - 1.0 < 0.06


@pytest.mark.parametrize("at", [90.0, 270.0])
def test_a_weight_across_the_wrap_says_nothing_of_its_effect(at: float) -> None:
    """Its vector moves the chain's part along the border of the wrap's side: the reading alone lies on a side."""
    across = WeightRun(radians(at), -0.3 + 0.1j)
    assert chain_unbalance([*RUNS, across], PHASES).weight == chain_unbalance(RUNS, PHASES).weight
    with pytest.raises(WrongInput, match="side of the wrap"):
        chain_unbalance([*RUNS, replace(across, reading=0.3 + 0.1j)], PHASES)


def test_runs_that_contradict_the_wrap_are_refused() -> None:
    with pytest.raises(WrongInput, match="side of the wrap") as error:
        chain_unbalance([WeightRun(0.0, 1.0 + 0j), WeightRun(pi, 1.0 + 0j)], PHASES)
    assert error.value.key == "runs"
