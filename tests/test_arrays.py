"""Rows and groups in flat arrays, against loops."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy import array
from numpy.random import default_rng

from ncgear.numerics.arrays import equal_rows, largest_rows

VALUES = st.sampled_from([-float("inf"), -1.5, 0.0, 0.25, 3.0])


@pytest.mark.slow
@given(st.lists(st.tuples(VALUES, st.integers(0, 5)), max_size=20))
def test_the_largest_row_of_each_group_is_the_first_of_equal_ones(rows: list[tuple[float, int]]) -> None:
    values, group = array([value for value, _ in rows], dtype=float), array([number for _, number in rows], dtype=int)
    found = largest_rows(values, group, 6)
    for number in range(6):
        own = [row for row, (_, of) in enumerate(rows) if of == number]
        assert found[number] == (max(own, key=lambda row: rows[row][0]) if own else -1)


def test_equal_rows_share_a_number_and_the_first_of_them_stands_for_all() -> None:
    rows = default_rng(2).integers(-1, 2, (60, 3)).astype(float)
    seen: dict[tuple[float, ...], int] = {}
    for row, values in enumerate(map(tuple, rows.tolist())):
        seen.setdefault(values, row)
    first, number = equal_rows(rows)
    assert first.tolist() == [seen[values] for values in sorted(seen)]
    assert number.tolist() == [sorted(seen).index(values) for values in map(tuple, rows.tolist())]
    assert [part.size for part in equal_rows(rows[:0])] == [0, 0]
