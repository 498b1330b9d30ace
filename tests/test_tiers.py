"""The tiers of tests: every room has a judge among the quick ones, and the lists of parameters mean what they say."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import pytest

from at_once import at_once
from tiers import Collected, fits, quarter_of, tier_of

TESTS = Path(__file__).parent
ROOMS = {path.parent.name for path in (TESTS.parent / "src" / "ncgear").glob("*/__init__.py")}


@pytest.fixture
def collected(request: pytest.FixtureRequest) -> list[pytest.Item]:
    """All tests of all files, whichever of them are asked for."""
    items = request.config.stash[Collected]
    if {path.name for path in TESTS.rglob("test_*.py")} - {item.path.name for item in items}:
        pytest.skip("only where the tests of all files are collected")
    return items


def rooms_judged(items: list[pytest.Item]) -> set[str]:
    """Rooms of which a quick test says that it holds them against something independent."""
    quick = [item for item in items if not {"thorough", "slow"} & {mark.name for mark in item.iter_markers()}]
    return {room for item in quick for mark in item.iter_markers("judges") for room in mark.args}


def test_every_room_has_a_judge_among_the_quick_tests(collected: list[pytest.Item]) -> None:
    assert rooms_judged(collected) == ROOMS


def test_a_judge_that_is_not_quick_does_not_count(collected: list[pytest.Item]) -> None:
    """Negative control."""
    assert rooms_judged([item for item in collected if item.get_closest_marker("thorough")]) == set()


@pytest.mark.thorough
def test_every_pattern_fits_a_parameter(collected: list[pytest.Item]) -> None:
    """One that fits none is of a parameter that was renamed, whose tests have changed their tier unseen."""
    ids: dict[tuple[str, str], set[str]] = defaultdict(set)
    lists: dict[tuple[str, str], set[str]] = {}
    for item in collected:
        if mark := item.get_closest_marker("tiers"):
            # Several tests of a file may share a mark.
            place = item.path.name, str(mark.kwargs)
            ids[place].add(item.callspec.id)
            lists[place] = {one for given in mark.kwargs.values() if not isinstance(given, str) for one in given}
    unfit = [
        (place[0], pattern)
        for place, patterns in lists.items()
        for pattern in sorted(patterns)
        if not any(fits(pattern, name) for name in ids[place])
    ]
    assert unfit == []


@at_once(
    ("name", "tier"), [("ellipse", "quick"), ("ellipse-0.1", "slow"), ("baler [2]", "thorough"), ("baler-2", "slow")]
)
def test_the_first_list_that_fits_counts(name: str, tier: str) -> None:
    assert tier_of(name, "slow", quick=["ellipse"], thorough=["*[2]", "ellipse"]) == tier


def test_a_tier_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="'fast' is no tier"):
        tier_of("ellipse", "fast")


def test_quarters_are_about_equal_and_keep_parameters_together(collected: list[pytest.Item]) -> None:
    functions = {item.nodeid.partition("[")[0] for item in collected}
    counts = [sum(quarter_of(name) == quarter for name in functions) for quarter in range(4)]
    assert sum(counts) == len(functions)
    assert min(counts) > 0.22 * len(functions)
    assert quarter_of("tests/test_one.py::test_this[a]") == quarter_of("tests/test_one.py::test_this[b-1]")
