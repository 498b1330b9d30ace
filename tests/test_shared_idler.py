"""A law made by three gears in a row, whose idler meshes with both others: ``ratio/laws/shared_idler.py``.

The judge composes both meshes by the pitch curves of a row, which know nothing of the whole law.
"""

from __future__ import annotations

import json
import re
from functools import cache
from math import pi
from typing import Any

import numpy as np
import pytest
import yaml
from pydantic import ValidationError

from drives import DESIGNS, drive_of_text
from ncgear.design.trains.planetary import Planetary
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.project.law_task import task_of
from ncgear.project.strengthening import rating_of
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.laws.row import row_angle, row_laws
from ncgear.ratio.laws.shared_idler import GOLDEN_RAD, KEPT_RAD, shared_by_idler
from ncgear.ratio.laws.spline import even_steps, spline_ratio_law
from ncgear.ratio.transmission import Lobes, Transmission

GOLDEN_BEND = pi - GOLDEN_RAD
PHI1 = np.linspace(0.0, 2.0 * pi, 701)[:-1]


def composed(first: Transmission, bend_rad: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    """The last gear's angle at PHI1, by the curves of a row that bends by ``bend_rad`` at its idler."""
    return row_angle(row_laws(first, (1, 1, 1), (0.0, bend_rad), "bends_deg"), PHI1, 0).value


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    "law",
    [
        harmonic_law(np.array([0.3, 0.2, 0.1]), np.array([0.1, -0.2]), Lobes()),
        spline_ratio_law(even_steps(8), np.array([0.7, 1.0, 1.5, 1.1, 0.9, 1.3, 0.8, 1.0]), Lobes()),
    ],
    ids=["analytic", "spline"],
)
def test_the_row_turns_its_last_gear_as_prescribed(law: Transmission, sign: float) -> None:
    made = shared_by_idler(law, pi + sign * GOLDEN_BEND, "k")
    missed = np.abs(composed(made.first, sign * GOLDEN_BEND) - law.driven_angle(PHI1).value).max()
    # The row's own curves are good to 1e-10
    assert missed < made.missed_rad * 1.1 + 1e-10 < KEPT_RAD
    other = np.abs(composed(made.first, -sign * GOLDEN_BEND) - law.driven_angle(PHI1).value).max()
    assert other > 0.05


def test_a_first_mesh_is_found_again_from_the_row_that_it_makes() -> None:
    cosine, sine = np.array([0.2, 0.1, 0.0, 0.03]), np.array([0.0, -0.1, 0.05, 0.0])
    whole = composed_law(harmonic_law(cosine, sine, Lobes()), GOLDEN_BEND)
    series = shared_by_idler(whole, pi + GOLDEN_BEND, "k").series
    found = np.pad(series.cosine, (0, 4))[:4], np.pad(series.sine, (0, 4))[:4]
    assert np.abs(np.array(found) - [cosine, sine]).max() < 1e-8
    assert np.abs(series.cosine[4:]).max(initial=0.0) < 1e-8


def composed_law(first: Transmission, bend_rad: float) -> Transmission:
    """The whole law of a row by the same curves, as harmonics of its ratio over the last gear's angle."""
    from ncgear.ratio.laws.row import laws_in_series

    return laws_in_series(row_laws(first, (1, 1, 1), (0.0, bend_rad), "bends_deg")).whole


@pytest.mark.parametrize("bend_deg", [0.0, 40.0])
def test_bends_of_simple_fractions_of_a_turn_are_refused(bend_deg: float) -> None:
    law = harmonic_law(np.array([0.3, 0.2, 0.1]), np.array([0.1, -0.2]), Lobes())
    with pytest.raises(NoSuchMechanism, match=f"turns by {bend_deg:g} degrees; 42.492 degrees"):
        shared_by_idler(law, pi + np.radians(bend_deg), "k")


def keys_of(**changed: Any) -> dict[str, Any]:
    """The worked transplanter's keys with an idler that sun and planet share, no masses, its axis near the best."""
    keys = yaml.safe_load((DESIGNS / "transplanter.yaml").read_text())["train"]
    keys["path"] = {key: value for key, value in keys["path"].items() if not key.startswith("axis_")}
    keys["path"] |= {"axis_mm": [10.6, 244.4]}
    gears = {key: value for key, value in keys["gears"].items() if key != "module_mm"}
    given = {key: value for key, value in keys.items() if key not in ("kind", "masses")}
    return given | {"idler": "shared", "gears": gears | changed.pop("gears", {})} | changed


@cache
def led() -> Planetary:
    return Planetary.model_validate(keys_of())


def test_one_idler_leads_a_tip_past_all_points() -> None:
    train = led().train()
    assert [part.name for part in train.parts if part.teeth] == ["sun", "idler_1", "planet_1", "idler_2", "planet_2"]
    (passed,) = [condition for condition in train.told.conditions if condition.name == "path"]
    assert passed.holds
    motion, _ = led()._sought()
    assert motion is not None
    # The path of carrier and arm, which knows no gears; the carrier turns as the driving shaft
    w = np.linspace(0.0, 2.0 * pi, 301)
    tip = train.trace_mm(train.traces[0], motion.carrier_rad(w) - motion.carrier_rad(np.zeros(1)))
    assert np.abs(tip[:, 0] + 1j * tip[:, 1] - motion.tip(w)).max() < KEPT_RAD * motion.arm_mm
    # The same gears on fixed axes, as strength rates them
    row = drive_of_text(json.dumps({"name": "arm", **(led().machine() or {})}))
    turned = row.law.train.whole.driven_angle(PHI1).value
    assert np.abs(turned - motion.law.driven_angle(PHI1).value).max() < 10.0 * KEPT_RAD


@pytest.mark.parametrize(
    ("changed", "key", "right"),
    [
        ({"bend_deg": 40.0}, "train.bend_deg", "42.492 degrees to either side"),
        ({"path": "50"}, "train.path.pressure_angle_deg", "a compound idler is right"),
    ],
)
def test_paths_that_one_idler_does_not_make_are_refused(changed: dict[str, Any], key: str, right: str) -> None:
    if "path" in changed:
        changed = {"path": keys_of()["path"] | {"pressure_angle_deg": float(changed["path"])}}
    with pytest.raises(NoSuchMechanism, match=right) as refused:
        Planetary.model_validate(keys_of(**changed)).train()
    assert refused.value.key == key


def test_the_module_of_a_shared_idler_follows_from_the_path() -> None:
    with pytest.raises(ValidationError, match="follows from the path"):
        Planetary.model_validate(keys_of(gears={"module_mm": 2.0}))


MACHINE = """\
name: row
linkage: {{crank_mm: 60, rod_mm: 200}}
operation: {{speed_rpm: 60}}
motion: {motion}
gears: {{teeth: 40, module_mm: 2, face_width_mm: 20, backlash_mm: 0.05{more}}}
resistance: {{polynomial_n: [300]}}
"""
ROW = ", idlers: {lobes: [1], bends_deg: [42.492], law_of: row}"


def figures_of(motion: str, more: str = "") -> list[float]:
    """Peaks of power and acceleration, and the ends of the ratio, of a crank-slider."""
    drive = drive_of_text(MACHINE.format(motion=motion, more=more))
    peaks = drive.check.peak_power_w, drive.check.peak_acceleration_cycle, *drive.transmission.ratio_range
    return [peak.value for peak in peaks]


def test_three_equal_ellipses_move_a_slider_as_one_ellipse_of_their_closed_form() -> None:
    """tan(w/2) = ((1 + e)/(1 - e))^2 tan(u/2), so e of the whole is 2 e / (1 + e^2)."""
    row = figures_of("{law: ellipse, eccentricity: 0.2}", ", idlers: {lobes: [1]}")
    whole = 2.0 * 0.2 / (1.0 + 0.2**2)
    assert row == pytest.approx(figures_of(f"{{law: ellipse, eccentricity: {whole!r}}}"), rel=1e-8)
    bent = figures_of("{law: ellipse, eccentricity: 0.2}", ", idlers: {lobes: [1], bends_deg: [30]}")
    assert abs(bent[0] / row[0] - 1.0) > 0.01


def test_three_gears_move_a_slider_as_the_pair_of_a_law() -> None:
    """The made law, composed by the curves of the row, against the law of the same file without an idler."""
    for law in ("{law: harmonic_ratio, cosine: [0.25, 0.1], sine: [-0.1]}", "{law: ellipse, eccentricity: 0.35}"):
        assert figures_of(law, ROW) == pytest.approx(figures_of(law), rel=1e-6)


@pytest.mark.slow
def test_the_worked_pusher_is_made_with_an_idler() -> None:
    """A law of the slider: its jerk jumps, which waves follow within 3e-8 rad and 0.2 % of the acceleration."""
    text = (DESIGNS / "pusher.yaml").read_text()
    text = text.replace("  index_holes: true", "")
    with_idler = re.sub(r"(  teeth: 48\n)", r"\1  idlers: {lobes: [1], bends_deg: [42.492]}\n", text)
    one, row = drive_of_text(text), drive_of_text(with_idler)
    phi1 = np.linspace(0.0, 2.0 * pi, 4001)
    turned = row.transmission.driven_angle(phi1).value - one.transmission.driven_angle(phi1).value
    assert 0.0 < np.abs(turned).max() < 1e-7
    away = row.machine.motion(phi1).acceleration - one.machine.motion(phi1).acceleration
    assert np.abs(away).max() < 2e-3 * one.check.peak_acceleration_cycle.value
    assert row.check.peak_power_w.value == pytest.approx(one.check.peak_power_w.value, rel=1e-5)
    steepest = [pair.largest_pressure_angle_deg for pair in row.by_stage]
    assert max(steepest) == pytest.approx(30.31, abs=0.01)
    assert one.largest_pressure_angle_deg == pytest.approx(38.13, abs=0.01)


@pytest.mark.slow
def test_round_gears_pass_a_sliders_power_through_an_idler() -> None:
    """Each mesh is as safe as a single pair of the same gears.

    An idler's tooth has its other mesh half a turn later, where the slider returns and nothing bends it the other way.
    """
    law = "{law: uniform_crank}"
    one = rating_of(drive_of_text(MACHINE.format(motion=law, more="")))
    row = drive_of_text(MACHINE.format(motion=law, more=", idlers: {lobes: [1]}")).by_stage
    alone = {(each.gear, each.damage): each.safety for each in one.weakest}
    for stage in row:
        for each in rating_of(stage).weakest:
            assert each.safety == pytest.approx(alone[each.gear, each.damage], rel=1e-2)


@pytest.mark.parametrize(
    ("motion", "more", "key", "said"),
    [
        ("{law: ellipse, eccentricity: 0.2}", ", idlers: {lobes: [2]}", "gears.idlers.lobes", "has one lobe each"),
        (
            "{law: ellipse, eccentricity: 0.2}",
            ", idlers: {lobes: [1, 1], law_of: row}",
            "gears.idlers.lobes",
            "makes a law of the last gear",
        ),
        (
            "{law: table, phi1_deg: [0, 90, 180, 270, 360], displacement_mm: [0, 60, 120, 60, 0]}",
            ", idlers: {lobes: [1], bends_deg: [42.492], law_of: first_pair}",
            "gears.idlers.law_of",
            "row is right",
        ),
        (
            "{law: ellipse, eccentricity: 0.2}",
            ", idlers: {lobes: [1], bends_deg: [40], law_of: row}",
            "gears.idlers.bends_deg",
            "42.492 degrees to either side",
        ),
    ],
)
def test_rows_that_make_no_such_law_are_refused_by_their_key(motion: str, more: str, key: str, said: str) -> None:
    with pytest.raises(DesignError, match=said) as refused:
        _ = drive_of_text(MACHINE.format(motion=motion, more=more)).law
    assert refused.value.key == key


def test_a_best_law_is_not_sought_for_a_row_which_would_make_another() -> None:
    drive = drive_of_text(MACHINE.format(motion="{law: ellipse, eccentricity: 0.2}", more=", idlers: {lobes: [1]}"))
    with pytest.raises(WrongInput, match="law_of: row, in the file") as refused:
        task_of(drive.design, drive.train_inertia)
    assert refused.value.key == "gears.idlers"
