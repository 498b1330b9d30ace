"""The random order of tests: all of them, each once, by files, and the same again of the same seed."""

from __future__ import annotations

from itertools import groupby

from shuffled import shuffled

TESTS = [f"{file}{number}" for file in "abcdef" for number in range(8)]


def of_seed(seed: int) -> list[str]:
    return shuffled(TESTS, lambda test: test[0], seed)


def test_every_test_comes_once_and_files_stay_together() -> None:
    assert sorted(of_seed(3)) == TESTS
    assert len([file for file, _ in groupby(of_seed(3), key=lambda test: test[0])]) == 6


def test_a_seed_is_an_order() -> None:
    """Workers that collect by themselves have the same one; another seed has another, of files and within a file."""
    assert of_seed(3) == of_seed(3)
    assert len({tuple(of_seed(seed)) for seed in range(20)}) == 20
    assert len({of_seed(seed)[0][0] for seed in range(20)}) > 3
    assert len({tuple(test for test in of_seed(seed) if test[0] == "a") for seed in range(20)}) == 20
