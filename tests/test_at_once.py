"""Cases at once: all run, each failure is told with its case, and what a test takes otherwise is left to pytest."""

from __future__ import annotations

import pytest

from at_once import at_once


def test_every_case_that_fails_is_told() -> None:
    seen = []

    @at_once("first", [1, 2, 3, 4])
    def odd(first: int) -> None:
        seen.append(first)
        assert first % 2

    with pytest.raises(ExceptionGroup, match="2 of 4 cases") as caught:
        odd()
    assert seen == [1, 2, 3, 4]
    assert [fault.__notes__ for fault in caught.value.exceptions] == [["with first = 2"], ["with first = 4"]]


def test_a_fault_that_is_expected_and_does_not_come_is_told_too() -> None:
    """What ``pytest.raises`` says then is no ``Exception``."""

    @at_once("value", [1])
    def refused(value: int) -> None:
        with pytest.raises(ValueError, match="refused"):
            int(value)

    with pytest.raises(BaseExceptionGroup, match="1 of 1 cases"):
        refused()


@at_once(("first", "second"), [(1, 2), (3, 4)])
@pytest.mark.parametrize("times", [1, 2])
@at_once("third", range(2))
def test_other_arguments_are_those_of_pytest(first: int, second: int, third: int, times: int, tmp_path: object) -> None:
    assert (second - first, third in (0, 1), times in (1, 2)) == (1, True, True)
    assert tmp_path
