"""The hard cases, judged as the table of docs/hard-cases.md is: refused in the right words, or right to rounding."""

from __future__ import annotations

import re
from functools import cache

import pytest

from commands import ROOT
from hard.case import FOLDER, REFUSED, Case, cases, drive_of
from hard.condition import conditions
from hard.figures import reported, sampled_peak
from hard.judged import FACTOR, Made, Refused, allowed, in_roundings, judged
from ncgear.design.laws.registry import LawName
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.template import template
from ncgear.ratio.transmission import CLOSED
from tiers import long_but

PAGE = (ROOT / "docs" / "hard-cases.md").read_text(encoding="utf-8")

ALL = {case.name: case for case in cases()}
MADE = [name for name in ALL if name not in REFUSED]

SLOW = {LawName.THREE_SEGMENT_STROKE, LawName.HARMONIC_RATIO, LawName.SPLINE_RATIO, LawName.TABLE}
"""Laws whose reference takes seconds, and which the cases judge as well."""


@cache
def verdict(name: str) -> Made | Refused:
    return judged(ALL[name])


def told(name: str) -> list[str]:
    """The cells of a case in the page."""
    (line,) = re.findall(rf"^\| `{re.escape(name)}` \|.*$", PAGE, flags=re.MULTILINE)
    return [cell.strip() for cell in line.strip("|").split(" | ")]


def test_the_page_has_every_case_once() -> None:
    assert re.findall(r"^\| `([^`]+)` \|", PAGE, flags=re.MULTILINE) == list(ALL)
    assert set(REFUSED) <= set(ALL)
    assert {path.stem for path in FOLDER.glob("*.yaml")} <= set(ALL)


@pytest.mark.tiers(slow=["pole*"], rest="quick")
@pytest.mark.parametrize("name", REFUSED)
def test_what_does_not_exist_is_refused_in_these_words(name: str) -> None:
    refused = verdict(name)
    assert isinstance(refused, Refused)
    assert re.search(REFUSED[name], refused.message)
    assert refused.exit_status in (2, 3)
    assert told(name)[-1] == f"refused ({refused.exit_status}): {refused.message}"


@pytest.mark.tiers(quick=["uniform-crank", "lobes-*", "ratio-1-*"], rest="slow")
@pytest.mark.parametrize("name", MADE)
def test_what_is_made_closes_and_no_peak_is_passed_by(name: str) -> None:
    drive = ALL[name].drive()
    assert abs(drive.transmission.closure_error_rad) <= CLOSED
    assert drive.check.peak_acceleration_cycle.value >= sampled_peak(drive, 2003) * (1.0 - 1e-10)
    assert told(name)[-1] == "made"


@pytest.mark.tiers(slow=["lobes-1-2"], rest="long")
@pytest.mark.parametrize("name", long_but([name for name in MADE if name != "table-noisy-ratios"], MADE))
def test_no_figure_is_off_by_more_than_the_page_tells(name: str) -> None:
    """Twice what it says, for another machine's rounding, or the same rounding errors where they are few."""
    made = verdict(name)
    assert isinstance(made, Made)
    error, condition = float(told(name)[2].split(",")[0]), float(told(name)[3])
    assert max(made.errors.values()) <= max(2.0 * error, allowed(name) * 2.2e-16 * condition)


@pytest.mark.tiers(slow=["ratio-1-100"], rest="long")
@pytest.mark.parametrize("name", MADE)
def test_errors_are_the_problems(name: str) -> None:
    """No figure is farther off than the exact figures of designs whose numbers differ in the last digits."""
    made, condition = verdict(name), conditions(ALL[name].data)
    assert isinstance(made, Made)
    assert max(in_roundings(made, condition).values()) <= allowed(name)
    worst = max(made.errors, key=lambda figure: made.errors[figure])
    assert condition[worst] == pytest.approx(float(told(name)[3]), rel=1.0) or condition[worst] <= 1e6


@pytest.mark.tiers(slow=["ellipse"], rest="long")
@pytest.mark.parametrize("law", [pytest.param(law, marks=pytest.mark.slow if law in SLOW else []) for law in LawName])
def test_every_law_is_the_law_of_its_reference(law: LawName) -> None:
    """By its template; a law that is added is judged by its line in ``oracles.laws.REFERENCES``."""
    made = judged(Case(f"template-{law}", lambda: read_yaml(template("mine", law), "template").data))
    assert isinstance(made, Made)
    # The templates have conditions of 16 to 46 (hard.condition), and their figures are right to 4e-15.
    assert max(made.errors.values()) <= 1e-13


@pytest.mark.slow
def test_a_figure_off_by_more_than_its_condition_is_seen() -> None:
    """A thousandth of the crank's length is not in the last digits."""
    case = ALL["rod-1-2"]
    longer = Case(case.name, lambda: {**case.data, "linkage": {**case.data["linkage"], "rod_mm": 456.001}})
    figures = {name: figure.value for name, figure in reported(drive_of(longer.data)).items()}
    exact = {name: figure.value for name, figure in reported(case.drive()).items()}
    made = Made({name: abs(figures[name] / exact[name] - 1.0) for name in exact}, 0.0)
    assert max(in_roundings(made, conditions(case.data)).values()) > 1e3 * FACTOR


@pytest.mark.slow
def test_a_stroke_within_rounding_of_the_linkages_is_the_linkages() -> None:
    """stroke_mm off by 1e-9: every figure is that of the file without it, to the last bit."""
    written, plain = reported(ALL["stroke-off-by-1e-9"].drive()), reported(ALL["baler"].drive())
    assert written == plain
