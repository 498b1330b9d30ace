"""Teeth of pairs in series at rest under load, against a single pair, Newton's balance of shafts, and a slow motion."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace as Made
from typing import Any

import numpy as np
import pytest

from drives import drive_of_text
from ncgear.dynamics.history import history
from ncgear.project.drive import Drive
from test_forces_of_chains import ALONE, CHAINS, TURNED

RATIO = {"even": "1", "uneven": "1 + 0.3*cos(phi) + 0.1*sin(2*phi)"}
SMOOTH = "simulation: {friction: {static: 0, dynamic: 0}}\n"


@cache
def chain(law: str, pairs: int, more: str = SMOOTH, rpm: int = 240) -> Drive:
    """Equal pairs that share a law, and turn a shaft against a torque."""
    shafts = f", shaft_between_kg_mm2: {[30_000.0] * (pairs - 1)}" if pairs > 1 else ""
    text = ALONE.format(RATIO[law], f"pairs: {pairs}")
    return drive_of_text(text.replace("speed_rpm: 240", f"speed_rpm: {rpm}") + TURNED.format(shafts) + more)


def pair(ratio: float, error_rad: float) -> Any:
    """A pair of gears with a ratio, whose driven angle is beyond the law's."""
    slope = Made(law=Made(at=lambda phi1: (ratio * phi1, np.full(phi1.shape, ratio))))
    return Made(
        _any_meshing=slope,
        _loaded_at=lambda phi1, factor: Made(phi1_rad=phi1, error_rad=np.full(2, error_rad / factor)),
    )


def test_each_pair_turns_the_errors_before_it_on() -> None:
    """By hand; errors that are only added, or turned on by the pair's own ratio, would be others."""
    drive: Any = Made(by_stage=[pair(3.0, 1e-3), pair(2.0, 1e-2), pair(0.5, 1e-1)])
    expected = 0.5 * (2.0 * 1e-3 + 1e-2) + 1e-1
    np.testing.assert_allclose(Drive.loaded_error_at(drive, np.zeros(2)), expected, rtol=1e-12)
    np.testing.assert_allclose(Drive.loaded_error_at(drive, np.zeros(2), 4.0), expected / 4.0, rtol=1e-12)


@pytest.mark.slow
def test_two_equal_circular_pairs_give_way_twice_as_far_as_each() -> None:
    """Their ratio is 1 and their loads are alike; a single pair by itself is each of them.

    The error of the last pair's teeth changes the torque that the first pair bears by 0.2 %.
    """
    alone, both = chain("even", 1), chain("even", 2)
    one, (first, last) = alone.loaded_contact, (pair.loaded_contact for pair in both.by_stage)
    np.testing.assert_allclose(last.error_rad, one.error_rad, rtol=1e-6)
    np.testing.assert_allclose(last.tooth_force_n, one.tooth_force_n, rtol=1e-6, atol=1e-3)
    np.testing.assert_allclose(first.error_rad, one.error_rad, rtol=4e-3)
    np.testing.assert_allclose(both.loaded_error_at(both.motion.phi1_rad), 2.0 * one.error_rad, rtol=2e-3)
    assert both.transmission_error_with(1.0) == pytest.approx(2.0 * alone.transmission_error_with(1.0), rel=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "between"), [("2 pairs", [3e4]), ("3 pairs", [3e4, 5e4]), ("row of 3", [3e4])])
def test_stiff_teeth_bear_what_newton_asks_of_every_shaft(name: str, between: list[float]) -> None:
    """The rigid level's torques have judges of their own; what misses falls with the stiffness.

    Negative control: without the torque of the shafts between much more would miss.
    """
    drive = drive_of_text(CHAINS[name][0] + TURNED.format(f", shaft_between_kg_mm2: {between}") + SMOOTH)
    phi1 = np.linspace(0.0, 6.2, 400)
    loads, angles = drive.rigid.machine.at(phi1), drive.rigid.machine.angles(phi1, 1)

    def missed(stiffness: float) -> float:
        found = []
        for number, each in enumerate(drive.by_stage):
            rigid = loads.passed[number].value / angles[number].derivative(1)
            torque = each._loaded_at(phi1, stiffness).driving_torque_n_mm
            found.append(float(np.abs(torque - rigid).max() / np.abs(rigid).max()))
        return max(found)

    assert missed(100.0) < 2.5e-4 < 1e-3 < missed(1.0) < 4e-3
    before, after = loads.passed[0].value, loads.passed[1].value
    assert np.abs(before - after).max() > 0.04 * np.abs(after).max()


@pytest.mark.slow
def test_a_slow_motion_is_that_of_teeth_at_rest() -> None:
    """At 6 r/min only swings after each change of pairs differ.  Negative control: errors that are not turned on."""
    drive = chain("uneven", 2, "simulation: {turns: 0.1}\n", 6)
    course = drive.course
    at = history(course, drive.rigid.machine, np.linspace(0.5, 1.0, 200) * course.time_s[-1])
    rest, pairs = drive.loaded_error_at(at.phi1_rad), [pair._loaded_at(at.phi1_rad) for pair in drive.by_stage]
    largest = np.abs(rest).max()
    assert np.abs(at.error_rad - rest).max() < 0.02 * largest
    assert np.abs(sum(pair.error_rad for pair in pairs) - rest).max() > 0.05 * largest
    for force, pair in zip([*(one.pushing_n for one in at.before), at.pushing_n], pairs, strict=True):
        off = np.abs(force - pair.tooth_force_n) / pair.tooth_force_n.max()
        assert off.max() < 0.02
        assert np.median(off) < 1e-3
