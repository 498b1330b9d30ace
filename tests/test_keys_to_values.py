"""From keys to values, each by hand: torques, inertias that swing, limits that are drawn in, units of unknowns."""

from __future__ import annotations

from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from drives import drive_of_text, loaded
from ncgear.design.mechanisms import mechanism_of
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.jet import Jet
from ncgear.optimum.outline.conditions import Limits
from ncgear.project.forces import mean_inertia, swinging_inertia
from ncgear.project.free_lengths import _given
from ncgear.project.law import load_of
from ncgear.project.moving_masses import TrainInertia, train_inertia
from ncgear.project.outline_trial import Made, between, drawn_in

pytestmark = pytest.mark.judges("project")

Fake: Any = SimpleNamespace

SHAFT = """\
name: shaft
operation: {speed_rpm: 60}
motion: {law: ellipse, eccentricity: 0.2}
"""


@at_once(
    "given",
    [
        "table: {angle_deg: [0, 90, 180, 270, 360], torque_n_m: [2, 5, 2, 1, 2]}",
        'expression_n_m: "2 + 3*sin(x)"',
        "polynomial_n_m: [2, 0]",
    ],
)
def test_torques_on_a_shaft_are_in_n_m_over_its_angle(given: str) -> None:
    load = load_of(drive_of_text(f"{SHAFT}resistance: {{{given}}}\n").design)
    told = load.working.force_n(np.radians([0.0, 90.0, 180.0]))
    assert told == pytest.approx([2000.0, 2000.0 if "polynomial" in given else 5000.0, 2000.0])


def test_what_swings_on_teeth_is_both_inertias_in_series() -> None:
    """1/J = 1/J2 + i^2/J1 by the mean slope; a shaft that turns evenly has no end of inertia."""
    slopes = np.linspace(1.0, 2.0, 720)
    meshing = Fake(law=Fake(at=lambda angle: (angle, slopes)))
    assert swinging_inertia(meshing, 6.0, 4.0) == pytest.approx(1.0 / (1.0 / 4.0 + 1.5**2 / 6.0), rel=1e-9)
    assert swinging_inertia(meshing, 0.0, 4.0) == 4.0
    load = Fake(table=Fake(at=lambda angle: (3.0 + np.cos(angle)[:, None] * [1.0, 9.0], None)))
    assert mean_inertia(load) == pytest.approx(3.0, rel=1e-12)


def test_bodies_stand_for_inertias_that_a_file_leaves_out() -> None:
    """Of the first pair and of the last; on the shaft between is one gear of each."""
    bodies = {0: Fake(driving_kg_mm2=1.0, driven_kg_mm2=20.0), -1: Fake(driving_kg_mm2=300.0, driven_kg_mm2=4000.0)}

    def given(driving: float | None, between_kg_mm2: float | None, driven: float | None) -> Any:
        keys = "driving_gear_kg_mm2", "shaft_between_kg_mm2", "driven_gear_kg_mm2"
        return Fake(**dict(zip(keys, (driving, between_kg_mm2, driven), strict=True)))

    assert train_inertia(given(None, None, None), 2, bodies.__getitem__) == TrainInertia(1.0, 320.0, 4000.0)
    assert train_inertia(given(None, None, 7.0), 1, bodies.__getitem__) == TrainInertia(1.0, 0.0, 7.0)
    assert train_inertia(given(5.0, None, 7.0), 1, None) == TrainInertia(5.0, 0.0, 7.0)
    assert train_inertia(given(5.0, 6.0, 7.0), 2, bodies.__getitem__) == TrainInertia(5.0, 6.0, 7.0)
    assert train_inertia(given(5.0, None, 7.0), 2, bodies.__getitem__) == TrainInertia(5.0, 320.0, 7.0)


@at_once(("name", "key", "factor"), [("rocker-drive", "stroke_deg", 180.0 / pi), ("pump-1-2", "stroke_mm", 1.0)])
def test_a_free_stroke_is_in_the_unit_of_its_key(name: str, key: str, factor: float) -> None:
    design = loaded(name).design
    linkage = mechanism_of(design.linkage)
    way = linkage.displacement(Jet.variable(np.linspace(0.0, 2.0 * pi, 20_001), 0)).value
    assert _given(design, key) == pytest.approx(factor * np.ptp(way), rel=1e-6)


# --- limits of the next pair near an outline -------------------------------------------------------------------------


def made(refusal: NoSuchMechanism | None, lacking: list[tuple[float, float]], arc: float = 1.4) -> Made:
    """A closed curve of 100 mm with 20 teeth, looked at every 5 mm, flanks meeting every 2.5 mm."""
    arc_mm = np.arange(0.0, 100.0, 5.0)

    def apart(places: np.ndarray) -> np.ndarray:
        off = np.abs(arc_mm[:, None] - places)
        return np.minimum(off, 100.0 - off)

    curve = Fake(arc_mm=arc_mm, length_mm=100.0, teeth=20, apart_mm=apart)
    meetings = np.arange(0.0, 100.0, 2.5)
    arcs, rows = np.full(meetings.size, arc), np.array(lacking).reshape(-1, 2)
    return Made(curve, Limits(share=1.0), Fake(), {}, refusal, meetings, arcs, rows)


SHORT = NoSuchMechanism("too short", key="gears.least_contact_ratio")
CLASH = NoSuchMechanism("clash", key="gears")


def test_limits_are_drawn_in_beside_what_lacks_and_eased_elsewhere_at_first() -> None:
    """Over 10 mm to both sides, in proportion: by 5 % and what lacks, 3 % more for each refusal, 30 % at most."""
    first = drawn_in(made(SHORT, [(50.0, 0.08)]), 0)
    share = np.asarray(first.share)
    assert share[10] == pytest.approx(1.0 - 0.13)
    assert share[[9, 11]] == pytest.approx(1.0 - 0.5 * 0.13)
    assert share[[8, 12, 0]] == pytest.approx(1.05)
    again = np.asarray(drawn_in(made(SHORT, [(50.0, 0.08)]), 2).share)
    assert (again[10], again[0]) == (pytest.approx(1.0 - 0.19), 1.0)
    assert np.asarray(drawn_in(made(SHORT, [(50.0, 0.9)]), 1).share)[10] == pytest.approx(0.7)
    # Flanks that touch over less than one and a quarter pitches are not eased.
    assert np.asarray(drawn_in(made(SHORT, [(50.0, 0.08)], arc=1.2), 0).share)[0] == 1.0
    assert drawn_in(made(CLASH, []), 0).share == pytest.approx(np.full(20, 0.9))


@at_once(
    ("refusal", "count", "refusals", "rounder"),
    [(SHORT, 3, 5, 0), (SHORT, 3, 6, 1), (SHORT, 9, 2, 1), (CLASH, 1, 1, 0), (CLASH, 1, 2, 1)],
)
def test_slopes_are_drawn_in_after_some_refusals(refusal: Any, count: int, refusals: int, rounder: int) -> None:
    before = Limits()
    after = drawn_in(made(refusal, [(10.0 * place, 0.05) for place in range(count)]), refusals)
    assert after.steepest_rad == pytest.approx(before.steepest_rad * 0.85**rounder)
    assert after.nearest == pytest.approx(min(before.nearest + 0.05 * rounder, 0.35))


def test_limits_between_a_pair_that_was_made_and_one_that_was_not() -> None:
    kept, refused = made(None, []), made(CLASH, [])
    wider = Made(refused.curve, Limits(steepest_rad=1.0, nearest=0.3, share=1.2), Fake(), {}, CLASH)
    found = between(kept, wider)
    assert (found.share, found.steepest_rad, found.nearest) == (
        pytest.approx(1.1),
        pytest.approx((1.0 + kept.limits.steepest_rad) / 2.0),
        pytest.approx((0.3 + kept.limits.nearest) / 2.0),
    )
    assert between(kept, None).share == pytest.approx(1.05**2)
    eased = Made(kept.curve, Limits(share=1.25), Fake(), {})
    assert between(eased, None).share == 1.3
