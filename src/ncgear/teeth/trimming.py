"""Sides of teeth whose curves cross themselves, trimmed to what the rack really leaves.

The whole side is followed from the tip land to the root land: flank, fillet.  Wherever that path crosses itself, the
loop between is cut away.  Crossings are found on chords and refined on the exact curves.  A side is done when nothing
that is left of it folds; else it is followed on finer chords.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.crossing import chord_crossings, refined_crossings, zoomed_crossings
from ncgear.teeth.flank import Flanks
from ncgear.teeth.naming import tooth_name
from ncgear.teeth.paths import KINDS, Paths, paths_of
from ncgear.teeth.sides import Sides
from ncgear.teeth.tips import AGREEMENT

ROUNDS = (49, 145, 433)
"""Points per curve: the first round does for nearly all sides, the others for loops smaller than its chords."""

Loop = tuple[float, float]
"""Indices along a path at which a loop is entered and left."""


@dataclass(frozen=True, eq=False)
class _Trimmed:
    """What is left of paths: runs of curves (shape (runs,)), and which paths fold."""

    row: IndexArray
    kind: IndexArray
    start: Array
    end: Array
    folded: Mask


def trimmed_sides(flanks: Flanks, sides: Sides, irregular: Mask) -> Sides:
    """The sides with those of ``irregular`` flanks replaced by their trimmed paths.

    Raises NoSuchMechanism, naming the tooth, where nothing is left of a side or it cannot be untangled.
    """
    todo, tops = np.nonzero(irregular)[0], sides.flank_range()[0]
    for count in ROUNDS:
        if not todo.size:
            return sides
        paths = paths_of(flanks, todo, tops[todo], sides.roots.end_mm[todo], count)
        trimmed = _trimmed(paths)
        sides = _with_trimmed(sides, todo, trimmed)
        todo = todo[trimmed.folded]
    if todo.size:
        raise _untangled(flanks, int(todo[0]))
    return sides


def _trimmed(paths: Paths) -> _Trimmed:
    loops = _loops(paths)
    runs = [run for row in range(paths.owner.size) for run in _runs(paths, row, loops[row])]
    row, kind, start, end = (np.array(column) for column in zip(*runs, strict=True))
    folded = np.zeros(paths.owner.size, dtype=bool)
    folded[row[paths.folds(row, kind, start, end)]] = True
    return _Trimmed(row, kind, start, end, folded)


def _runs(paths: Paths, row: int, loops: list[Loop]) -> list[tuple[int, int, float, float]]:
    """Runs (row, kind, start, end) of one path from its tip to the root land, loops left out."""
    starts = [0.0] + [leave for _, leave in loops]
    ends = [enter for enter, _ in loops] + [float(KINDS * paths.count - 1)]
    runs: list[tuple[int, int, float, float]] = []
    for start, end in zip(starts, ends, strict=True):
        for kind in range(KINDS):
            low, high = max(start, kind * paths.count), min(end, kind * paths.count + paths.count - 1)
            if high > low:
                _, limits = paths.place(np.array([row, row]), np.array([low, high]))
                runs.append((row, kind, float(limits[0]), float(limits[1])))
    return runs


def _loops(paths: Paths) -> list[list[Loop]]:
    """Exact indices of each path's loops, in order and not overlapping."""
    row, first, second = chord_crossings(paths.points, paths.points)
    # Neighbouring chords meet in the point they share, also across the joint of two curves, where it stands twice.
    apart = (np.floor(second) > np.floor(first) + 1) & (second - first > 1.0 + 1e-9)
    row, first, second = row[apart], first[apart], second[apart]
    enter, leave, there = _exact_loops(paths, row, first, second)
    loops: list[list[Loop]] = [[] for _ in range(paths.owner.size)]
    for number in np.lexsort((enter, row)):
        own = loops[row[number]]
        if there[number] and (not own or enter[number] > own[-1][1]):
            own.append((float(enter[number]), float(leave[number])))
    return loops


def _exact_loops(paths: Paths, row: IndexArray, first: Array, second: Array) -> tuple[Array, Array, Mask]:
    """Exact indices of crossings found on chords, and which of them the curves themselves have."""
    flanks, owner = paths.flanks, paths.owner[row]
    kind1, start1 = paths.place(row, first)
    kind2, start2 = paths.place(row, second)
    at1, at2, met = refined_crossings(
        lambda t: flanks.curve_of(kind1, owner, t),
        lambda t: flanks.curve_of(kind2, owner, t),
        start1,
        start2,
        AGREEMENT * flanks.rack.module_mm,
    )
    # On one curve the two places must stay apart: it meets itself at every single point.
    apart = np.where(kind1 == kind2, 0.45 * np.abs(start1 - start2), np.inf)
    reach1, reach2 = (np.minimum(reach, apart) for reach in paths.reaches(row, kind1, first, kind2, second))
    met &= (np.abs(at1 - start1) <= reach1) & (np.abs(at2 - start2) <= reach2)
    lost = np.nonzero(~met)[0]
    if lost.size:
        at1[lost], at2[lost], met[lost] = zoomed_crossings(
            lambda t: flanks.curve_of(kind1[lost], owner[lost], t),
            lambda t: flanks.curve_of(kind2[lost], owner[lost], t),
            start1[lost],
            start2[lost],
            reach1[lost],
            reach2[lost],
        )
    enter, leave = paths.index(row, kind1, at1), paths.index(row, kind2, at2)
    # A path meets itself at every single point, and neighbouring curves meet in their joint: no loops.
    return enter, leave, met & (leave - enter > 1.0 + 1e-3)


def _untangled(flanks: Flanks, flank: int) -> NoSuchMechanism:
    return NoSuchMechanism(
        f"the flank of {tooth_name(flanks, flank)} crosses itself where no tool can cut it clean, so sharply does the "
        "pitch curve bend there; more teeth of a smaller module are needed",
        key="gears.teeth",
    )


def _with_trimmed(sides: Sides, owner: IndexArray, trimmed: _Trimmed) -> Sides:
    """The sides with the runs of flanks ``owner`` replaced."""
    kept = ~np.isin(sides.owner, owner)
    runs = np.concatenate([sides.owner[kept], owner[trimmed.row]])
    order = np.argsort(runs, kind="stable")
    return replace(
        sides,
        owner=runs[order],
        kind=np.concatenate([sides.kind[kept], trimmed.kind])[order],
        start=np.concatenate([sides.start[kept], trimmed.start])[order],
        end=np.concatenate([sides.end[kept], trimmed.end])[order],
    )
