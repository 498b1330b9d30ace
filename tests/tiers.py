"""Tiers of tests: quick ones, thorough ones that the README's command runs too, slow ones, long ones.

A test without a mark is quick.  One marked ``thorough`` takes longer than half a second or so; ``make quick`` leaves it
out.  One marked ``slow`` is left to .ci/run, and one that is also marked ``long`` to ``make slow``.  Where the
parameters of a test belong to different tiers, the mark ``tiers`` says which::

    @pytest.mark.tiers(quick=["ellipse"], slow=["baler-*"], rest="thorough")

Each is a list of ids of parameters, where * is any text; the first that fits counts, and ``rest`` is for the others.
Parameters of the tier ``long`` get both marks, ``slow`` and ``long``.

All slow tests take longer than .ci/run may.  It runs a quarter of them (``--quarter``), which the commit draws, so
that each slow test runs in one landing of four.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterable, Sequence
from typing import Any

import pytest

Collected = pytest.StashKey[list[pytest.Item]]()
"""All tests that pytest found, whether or not they are asked for."""

TIERS = ("quick", "thorough", "slow", "long")


def fits(pattern: str, name: str) -> bool:
    """Whether a pattern means the id of a parameter."""
    return re.fullmatch(".*".join(map(re.escape, pattern.split("*"))), name) is not None


def tier_of(
    name: str,
    rest: str,
    quick: Sequence[str] = (),
    thorough: Sequence[str] = (),
    slow: Sequence[str] = (),
    long: Sequence[str] = (),
) -> str:
    """The tier of a parameter by its id."""
    if rest not in TIERS:
        raise ValueError(f"{rest!r} is no tier; there are {', '.join(TIERS)}")
    for tier, patterns in zip(TIERS, (quick, thorough, slow, long), strict=True):
        if any(fits(pattern, name) for pattern in patterns):
            return tier
    return rest


def quarter_of(test: str) -> int:
    """Which quarter of all tests a test belongs to, by its name: its parameters, which share much, stay together."""
    return zlib.crc32(test.partition("[")[0].encode()) % 4


def long_but(few: Iterable[str], names: Iterable[str]) -> list[Any]:
    """Names as parameters of a slow test, all but a few of them ``long``."""
    chosen = set(few)
    return [pytest.param(name, marks=[] if name in chosen else pytest.mark.long) for name in names]
