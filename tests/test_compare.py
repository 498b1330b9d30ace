"""Designs side by side, and designs that come from mappings: the figures of a check, whatever brings the design."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from math import cos, exp, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ruamel.yaml import YAML

import ncgear
from at_once import at_once
from conftest import Run
from drives import DESIGNS, drive
from ncgear.errors import WrongInput
from ncgear.figures.summary.check_summary import check_summary
from ncgear.numerics.arrays import Array
from ncgear.numerics.formula import NotTraced, formula_of
from ncgear.project.opened import DIED, _decay

pytestmark = pytest.mark.judges("design")

EVEN: dict[str, Any] = {
    "name": "even",
    "linkage": {"crank_mm": 40, "rod_mm": 90},
    "operation": {"speed_rpm": 30},
    "motion": {"law": "uniform_crank"},
}


def with_law(**motion: Any) -> dict[str, Any]:
    return {**EVEN, "motion": motion}


def test_a_mapping_is_the_file() -> None:
    path = DESIGNS / "pusher.yaml"
    assert ncgear.load(YAML(typ="safe").load(path.read_text(encoding="utf-8"))).design == ncgear.load(path).design


@at_once(
    ("given", "said"),
    [
        ({**EVEN, "operation": {"speed_rpm": -3}}, "operation.speed_rpm: -3 given; a number of 1e-06 or over"),
        ({**EVEN, "speed": 3}, "speed: unknown key; known are "),
        ({**EVEN, "name": 3, "linkage": 3}, "name: 3 given; text (in quotes, if it looks like a number) is needed"),
        ({1: 2}, "1 is a key; keys are text"),
        (
            with_law(law="table", phi1_rad=np.arange(5.0), ratio=np.ones(4)),
            "motion.ratio: 4 values, but phi1_rad has 5",
        ),
        (with_law(law="table", phi1_rad=[0, 1, float("nan"), 3], ratio=np.ones(4)), "motion.phi1_rad.2: .nan given"),
        (
            with_law(law="harmonic_ratio", cosine=np.cos),
            "motion.cosine: a function given; ratio or driven_angle of the",
        ),
        (with_law(law="table", ratio=np.log), "motion.ratio: the function has no finite value at phi1 = 0 rad"),
        (
            with_law(law="ratio_expression", ratio=lambda phi: 2.0 + cos(phi)),
            "motion.ratio: the function has no formula",
        ),
    ],
)
def test_faults_of_a_mapping_name_the_key_and_no_line(given: dict[str, Any], said: str) -> None:
    with pytest.raises(ncgear.WrongInput) as caught:
        ncgear.load(given)
    assert str(caught.value).startswith(said)
    assert caught.value.location == ""


def test_two_faults_are_told_by_their_keys() -> None:
    with pytest.raises(ncgear.WrongInput, match=r"^name: 3 given.*\nlinkage: 3 given"):
        ncgear.load({**EVEN, "name": 3, "linkage": 3})


def test_a_law_by_arrays() -> None:
    angle = np.arange(48) * 2.0 * pi / 48
    given = {"phi1_rad": angle, "ratio": 1.0 + 0.2 * np.cos(angle), "scale_to_close": True}
    as_lists = {key: value if value is True else value.tolist() for key, value in given.items()}
    assert ncgear.load(with_law(law="table", **given)).design == ncgear.load(with_law(law="table", **as_lists)).design


def wavy(phi: Any) -> Any:
    bend = np.minimum(0.3, 0.2) * np.cos(phi) ** 3 / (2.0 + np.sin(2.0 * phi))
    return -bend + np.exp(np.abs(0.1)) + 0.1 * np.square(np.cos(phi))


def test_a_function_becomes_its_formula() -> None:
    made = ncgear.load(with_law(law="ratio_expression", ratio=wavy, scale_to_close=True))
    phi1 = np.linspace(0.0, 6.0, 41)
    slope = made.transmission.driven_angle(phi1, 1).derivative(1)
    product = slope * wavy(phi1)
    assert product == pytest.approx(np.full(41, product[0]), rel=1e-12)
    assert "the function is the formula" in str(made.followed)


@pytest.mark.parametrize(
    "bad", [cos, lambda phi: phi if phi > 1.0 else 1.0, lambda phi: np.interp(phi, [0, 9], [1, 2])]
)
def test_what_is_no_formula(bad: Callable[[Any], Any]) -> None:
    with pytest.raises(NotTraced):
        formula_of(bad, "phi")


def test_a_function_is_sampled_to_a_told_error() -> None:
    """The error beside one of a judge's own: the greatest at angles that it has not seen."""

    def ratio(phi: float) -> float:
        return 1.0 + 0.3 * cos(phi) + 0.05 * cos(4.0 * phi)

    made = ncgear.load(with_law(law="table", ratio=ratio, scale_to_close=True))
    followed, phi1 = made.followed, np.linspace(0.0, 2.0 * pi, 3001)[:-1]
    found = 1.0 / made.transmission.driven_angle(phi1, 1).derivative(1)
    wanted = np.array(list(map(ratio, phi1)))
    own = np.max(np.abs(found / np.mean(found / wanted) - wanted)) / wanted.max()
    assert 0.5 * own < followed.error < 1e-9
    assert f"{followed.points} points of the function" in str(followed)
    assert "its series on 256 pieces die away to" in str(followed)


def bump(width: float) -> Callable[[float], float]:
    return lambda phi: 1.0 + 0.1 * exp(-(((phi - 2.0) / width) ** 2))


@at_once(
    ("ratio", "rough"),
    [
        (lambda phi: 1.0 + 0.2 * abs(sin(phi - 1.0)), [1.0, 1.0 + pi]),
        (lambda phi: 1.0 + 0.2 * sin(phi / 2.0), [0.0]),
        (lambda phi: 1.0 + 1e-6 * (3.0 < phi < 4.0), [3.0, 4.0]),
        (bump(0.005), []),
        (lambda phi: 1.0 + 0.2 * cos(phi) + 0.1 * max(0.0, sin(phi)) ** 9, []),
    ],
)
def test_where_a_function_is_rough_is_told(ratio: Callable[[float], float], rough: list[float]) -> None:
    """Up to the width of the narrowest pieces; what they resolve is told as well."""

    def called(phi1: Array) -> Array:
        return np.array(list(map(ratio, phi1.tolist())))

    pieces, tail, found = _decay(called, 2.0 * pi)
    off = (np.array(found)[:, None] - rough + pi) % (2.0 * pi) - pi
    assert np.all(np.abs(off).min(axis=0, initial=9.0) < 1e-3)
    assert len(found) == len(rough)
    assert pieces >= 256 - len(rough)
    assert tail <= DIED


def narrow(at: float, width: float) -> Callable[[Any], Any]:
    """A smooth peak that is nothing beyond half its width on either side."""

    def ratio(phi: Any) -> Any:
        off = np.abs((np.asarray(phi) - at + pi) % (2.0 * pi) - pi) / (width / 2.0)
        return (
            1.0 + 0.2 * np.cos(phi) + 0.3 * np.where(off < 1.0, np.exp(-(off**2) / np.maximum(1.0 - off**2, 0.01)), 0.0)
        )

    return ratio


@pytest.mark.slow
def test_only_what_is_narrower_than_is_told_is_missed() -> None:
    """Peaks of a thousandth of the cycle are refused wherever they stand; what lies between two angles is not seen."""
    called: list[Array] = []

    def smooth(phi: Any) -> Any:
        called.append(np.atleast_1d(phi))
        return 1.0 + 0.2 * np.cos(phi)

    followed = ncgear.load(with_law(law="table", ratio=smooth, scale_to_close=True)).followed
    angles = np.unique(np.concatenate(called))
    gaps = np.diff(np.append(angles, angles[0] + 2.0 * pi))
    assert gaps.max() == pytest.approx(followed.step_rad, rel=1e-9)
    for at in (0.1234, 2.5, 2.0 * pi * 0.77):
        with pytest.raises(WrongInput) as refused:
            ncgear.load(with_law(law="table", ratio=narrow(at, 1e-3 * 2.0 * pi), scale_to_close=True))
        told = re.search(r"near phi1 = ([\d.]+)", refused.value.problem)
        assert told
        assert float(told[1]) == pytest.approx(at, abs=1e-3 * pi)
    widest = int(gaps.argmax())
    between = narrow(angles[widest] + gaps[widest] / 2.0, 0.9 * gaps[widest])
    assert ncgear.load(with_law(law="table", ratio=between, scale_to_close=True)).followed.rough_rad == ()


def test_a_displacement_by_a_function_has_its_extended_end() -> None:
    """The motion of another law, whose extended end is at no even angle."""
    other = ncgear.load(with_law(law="harmonic_ratio", cosine=[0.1], sine=[0.12]))

    def place(phi1: Any) -> Any:
        return other.machine.displacement(np.asarray(phi1) % (2.0 * pi), 0).value

    made = ncgear.load(with_law(law="table", displacement_mm=place))
    assert made.followed.error < 1e-9
    own, wanted = made.check.peak_acceleration_cycle.value, other.check.peak_acceleration_cycle.value
    assert own == pytest.approx(wanted, rel=1e-6)


@pytest.mark.slow
def test_figures_side_by_side_are_those_of_checks(run: Run) -> None:
    """To the digit; differences are from the first design."""
    names = ["feeder-wishes", "feeder-kept", "jar-pusher"]
    status, out, _ = run("compare", *(str(DESIGNS / f"{name}.yaml") for name in names), "--out", "out", "--json")
    assert status == 0
    found = json.loads(out)
    assert json.loads(Path("out/compare.json").read_text()) == found
    assert Path("out/compare.png").stat().st_size > 10_000
    assert (
        Path("out/compare.csv")
        .read_text()
        .startswith("key,feeder-wishes,feeder-kept,jar-pusher\nspeed_rpm,45.0,45.0,60.0\n")
    )
    first = found["designs"][0]["figures"]
    for name, told in zip(names, found["designs"], strict=True):
        summary = check_summary(drive(name))
        for key in ("peak_acceleration_cycle_mm_s2", "peak_speed_mm_s"):
            assert told["figures"][key] == summary["check"][key]
        assert told["figures"]["ratio_max"] == summary["ratio"]["max"]
        assert told["figures"]["time_ratio"] == summary["motion"]["time_ratio"]
        if told["figures"] is not first:
            share = told["figures"]["peak_speed_mm_s"] / first["peak_speed_mm_s"]
            assert told["percent_over_first"]["peak_speed_mm_s"] == pytest.approx(100.0 * (share - 1.0))


@pytest.mark.slow
def test_a_table_and_a_chart_from_python() -> None:
    slower = {**EVEN, "operation": {"speed_rpm": 15}}
    found = ncgear.compare(EVEN, slower, drive("rocker-drive"))
    text = repr(found).splitlines()
    assert text[0].split() == ["even", "even", "(2)", "than", "even", "rocker-drive", "than", "even"]
    speed = next(line for line in text if line.strip().startswith("peak speed"))
    assert "50.0 % lower" in speed
    axes = ncgear.plots.compared(found, "velocity")
    # One that turns has no place on a scale in mm/s
    assert [line.get_label() for line in axes.lines] == ["even", "even (2)"]
    fast, slow = (np.max(line.get_ydata()) for line in axes.lines)
    assert slow == pytest.approx(fast / 2.0)


@pytest.mark.slow
def test_a_machine_without_a_load_has_no_power_to_compare() -> None:
    found = ncgear.compare(DESIGNS / "pusher.yaml", EVEN)
    assert found.figures[0]["peak_power_w"] > 0.0
    assert not [key for key in found.figures[1] if "power" in key]
    assert found.percent("peak_power_w") == (None,)
    row = next(line for line in repr(found).splitlines() if line.strip().startswith("peak power"))
    assert row.split()[-1] == "-"


def test_one_design_is_nothing_to_compare(run: Run) -> None:
    status, out, err = run("compare", str(DESIGNS / "pusher.yaml"))
    assert (status, out) == (2, "")
    assert "1 design given; 2 to 8 are compared" in err
    status, _, err = run("compare", str(DESIGNS / "pusher.yaml"), "none.yaml")
    assert status == 2
    assert err.startswith("none.yaml: cannot be read")


@at_once(
    ("function", "said"),
    [
        (lambda phi: 1.0 + 0.05 * phi, "does not come back at the end of the cycle"),
        (lambda phi: np.where(phi < 2.0, 1.0, 1.2), "jumps"),
        (lambda phi: 1.0 + 0.3 * np.exp(-(((phi - 3.3217) / 0.001) ** 2)), "narrow peak"),
        (lambda phi: 1.0 + 0.1j * np.sin(phi), "real number .*complex"),
        (lambda phi: "1", "real number .*str"),
        (lambda phi: None, "no finite value|real number"),
        (lambda phi, other: 1.0, "real number .*other"),
        (lambda phi: [1.0, 2.0], "real number"),
    ],
)
def test_a_function_that_no_law_follows_is_refused_by_its_key(function: Any, said: str) -> None:
    with pytest.raises(WrongInput, match=said) as refused:
        ncgear.load(with_law(law="table", ratio=function, scale_to_close=True))
    assert refused.value.key == "motion.ratio"


def test_what_is_no_design_is_refused_in_words() -> None:
    endless: dict[str, Any] = {"name": "x"}
    endless["motion"] = endless
    for given, said in ((None, "NoneType given"), ([1], "list given"), (endless, "levels deep")):
        with pytest.raises(WrongInput, match=said):
            ncgear.load(given)  # type: ignore[arg-type]
    two = ncgear.compare(EVEN, with_law(law="harmonic_ratio", cosine=[0.1]))
    with pytest.raises(WrongInput, match="no figure of these designs"):
        two.percent("nope")
    with pytest.raises(WrongInput, match="displacement, velocity"):
        ncgear.plots.compared(two, "nope")
