"""Tests in a random order of a seed, so that none comes to need what another one has left behind.

Files come one after the other in random order and their tests too, so that what the tests of a file share is made once.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from random import Random
from typing import TypeVar

Item = TypeVar("Item")


def shuffled(items: Iterable[Item], file_of: Callable[[Item], Hashable], seed: int) -> list[Item]:
    """All items in the order of a seed, those of a file together."""
    files: dict[Hashable, list[Item]] = {}
    for item in items:
        files.setdefault(file_of(item), []).append(item)
    random, groups = Random(seed), list(files.values())
    random.shuffle(groups)
    for group in groups:
        random.shuffle(group)
    return [item for group in groups for item in group]
