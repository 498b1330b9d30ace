"""Time and memory have a budget by the size of the input; both are counted, so that no clock decides.

Time is counted in calls of Python functions, memory in bytes that Python and numpy hold at most.
"""

from __future__ import annotations

import sys
import tracemalloc
from collections.abc import Callable
from types import FrameType
from typing import Any

import pytest

from at_once import at_once
from ncgear.design.reading import yaml
from ncgear.design.reading.yaml import read_yaml
from ncgear.errors import WrongInput
from ncgear.pitch.pair import sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import toothed_pair
from pairs import rack

CALLS_A_CHARACTER = 150
"""Calls of the parser for each character of a file; items of one character take the most."""

BYTES_A_CHARACTER = 500
"""Bytes for each character of a file: the value, its place and its dotted path."""


def calls_of(work: Callable[[], object]) -> int:
    """Number of calls of Python functions."""
    count = 0

    def counted(_: FrameType, event: str, __: Any) -> None:
        nonlocal count
        count += event == "call"

    sys.setprofile(counted)
    try:
        work()
    finally:
        sys.setprofile(None)
    return count


def most_bytes(work: Callable[[], object]) -> int:
    """Bytes that are held at most while ``work`` runs."""
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def read(text: str) -> str:
    """What is said of a text."""
    try:
        read_yaml(text, "d.yaml")
    except WrongInput as error:
        return error.problem
    return ""


GROWING: dict[str, Callable[[int], str]] = {
    # name: (a text of about n characters)
    "numbers": lambda n: "a: [" + "7," * (n // 2) + "]",
    "empty lists": lambda n: "a: [" + "[]," * (n // 3) + "]",
    "rows": lambda n: "a:\n" + "- [1, 2]\n" * (n // 9),
    "groups": lambda n: "a:\n" + "- {b: 2}\n" * (n // 9),
    "comments": lambda n: "# c\n" * (n // 4) + "a: 1",
    "words": lambda n: "a: " + "word " * (n // 5),
    "quoted": lambda n: 'a: "' + "\\n" * (n // 2) + '"',
    "text over lines": lambda n: "a: |\n" + "  x\n" * (n // 4),
    "blank lines": lambda n: "\n" * n,
    "many keys": lambda n: "".join(f"k{i}: 1\n" for i in range(n // 9)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", GROWING)
def test_reading_costs_in_proportion_to_the_size(name: str) -> None:
    text = GROWING[name](2000)
    assert calls_of(lambda: read(text)) < CALLS_A_CHARACTER * len(text)


@pytest.mark.slow
@pytest.mark.parametrize("name", GROWING)
def test_reading_takes_memory_in_proportion_to_the_size(name: str) -> None:
    text = GROWING[name](4000)
    assert most_bytes(lambda: read(text)) < BYTES_A_CHARACTER * len(text)


@pytest.mark.parametrize("text", ["a: [" + "7," * 50_000, "a: [" + "[[]]," * 50_000, "a:\n" + "- {b: 1}\n" * 50_000])
def test_limits_apply_while_a_file_is_read(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    """The rest of the file, of which two of three have no end, is not looked at."""
    monkeypatch.setattr(yaml, "MOST_VALUES", 100)
    assert "over 100 values in one file" in read(text)
    assert calls_of(lambda: read(text)) < CALLS_A_CHARACTER * 1000


@pytest.mark.slow
def test_the_judges_see_what_grows_faster_than_the_size() -> None:
    def square(size: int) -> list[list[int]]:
        return [[sum(one for one in range(size))] * size for _ in range(size)]

    assert calls_of(lambda: square(400)) > CALLS_A_CHARACTER * 400
    assert most_bytes(lambda: square(400)) > BYTES_A_CHARACTER * 400


LEAST_TOLERANCE_MM, USUAL_TOLERANCE_MM = 1e-5, 0.005
MOST_BYTES_OF_TEETH = 150e6


@pytest.mark.slow
@at_once(
    ("module_mm", "tolerance_mm", "made"),
    [
        (3.0, USUAL_TOLERANCE_MM, True),
        (800.0, USUAL_TOLERANCE_MM, True),
        (1.3e5, USUAL_TOLERANCE_MM, False),
        (7e6, 0.5, False),
        (9e6, LEAST_TOLERANCE_MM, False),
    ],
)
def test_points_do_not_grow_with_the_size_beyond_all_proportion(
    module_mm: float, tolerance_mm: float, made: bool
) -> None:
    pitch = sized_pair(elliptical_law(0.15, 0.0, Lobes()), 24, module_mm, None)
    form = ToothForm(rack(module=module_mm))

    def work() -> None:
        if made:
            toothed_pair(pitch, form, tolerance_mm)
            return
        with pytest.raises(WrongInput, match=r"times the tolerance is right") as refused:
            toothed_pair(pitch, form, tolerance_mm)
        assert refused.value.key == "output.chord_tolerance_mm"

    assert most_bytes(work) < MOST_BYTES_OF_TEETH


@pytest.mark.slow
def test_the_tolerances_that_refusals_name_lead_to_teeth() -> None:
    """Flanks, fillets and lands may each ask for more."""
    pitch, tolerance_mm = sized_pair(elliptical_law(0.15, 0.0, Lobes()), 24, 4.0e5, None), 0.002
    form = ToothForm(rack(module=4.0e5))
    for _ in range(4):
        try:
            points = toothed_pair(pitch, form, tolerance_mm).driving.outline_mm
        except WrongInput as error:
            tolerance_mm *= 1.05 * float(error.problem.split(" times the tolerance")[0].split()[-1])
    assert 0.01 < tolerance_mm < 1.0
    assert len(points) > 20_000
