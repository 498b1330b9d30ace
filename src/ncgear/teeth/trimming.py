"""Sides of teeth whose curves cross themselves, trimmed to what the rack really leaves.

The whole side is followed from beyond the tip land to the root land: crown, flank, fillet.  Wherever that path crosses
itself, the loop between is cut away; then the path is cut off at the tip land.  Crossings are found on chords and
refined on the exact curves.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.crossing import chord_crossings, refined_crossings, zoomed_crossings
from ncgear.teeth.flank import FLANK, Flanks
from ncgear.teeth.sides import AGREEMENT, Sides, tooth_name

POINTS = 65
"""Points per curve of a side (flanks have half of them where they fold) on which crossings are looked for; Newton's
method then needs a few steps."""

FINE = 513
"""Heights per flank at which its regularity is looked at when its points are spread."""

KINDS = 3
"""Curves of a whole side, numbered CROWN, FLANK and FILLET in this order."""


@dataclass(frozen=True, eq=False)
class _Paths:
    """Whole sides: parameters of their three curves, shape (n, 3, POINTS), and points, shape (n, 3 POINTS, 2)."""

    flanks: Flanks
    owner: IndexArray
    parameters: Array
    points: Array

    def place(self, row: IndexArray, index: Array) -> tuple[IndexArray, Array]:
        """Kind and parameter at fractional indices of the chords."""
        kind = np.minimum((index // POINTS).astype(int), KINDS - 1)
        local = np.clip(index - kind * POINTS, 0.0, POINTS - 1.0)
        low = np.minimum(local.astype(int), POINTS - 2)
        before, after = self.parameters[row, kind, low], self.parameters[row, kind, low + 1]
        return kind, before + (after - before) * (local - low)

    def spacing(self, row: IndexArray, kind: IndexArray, index: Array) -> Array:
        """Difference of parameter between the points on both sides of fractional indices, as a positive number."""
        low = np.clip((index - kind * POINTS).astype(int), 0, POINTS - 2)
        spacing: Array = np.abs(self.parameters[row, kind, low + 1] - self.parameters[row, kind, low])
        return spacing

    def index(self, row: IndexArray, kind: IndexArray, parameter: Array) -> Array:
        """Fractional indices at which the chords have the given parameters; the inverse of ``place``."""
        found = np.empty(row.size)
        for number, (r, k) in enumerate(zip(row, kind, strict=True)):
            known = self.parameters[r, k]
            order = slice(None) if known[-1] > known[0] else slice(None, None, -1)
            found[number] = k * POINTS + np.interp(
                parameter[number], known[order], np.arange(POINTS, dtype=float)[order]
            )
        return found


def trimmed_sides(flanks: Flanks, sides: Sides, irregular: Mask) -> Sides:
    """The sides with those of ``irregular`` flanks replaced by their trimmed paths.

    Raises NoSuchMechanism, naming the tooth, where nothing is left of a side.
    """
    if not irregular.any():
        return sides
    paths = _paths(flanks, np.nonzero(irregular)[0])
    loops = _loops(paths)
    tips, feet = _tips(paths, loops)
    tip_mm = sides.tip_mm.copy()
    tip_mm[paths.owner] = feet
    rows: list[tuple[int, int, float, float]] = []
    for row, owner in enumerate(paths.owner):
        runs = _runs(paths, row, tips[row], [loop for loop in loops[row] if loop[1] > tips[row]])
        rows += [(int(owner), *run) for run in runs]
    return _merged(replace(sides, tip_mm=tip_mm), irregular, rows)


def _paths(flanks: Flanks, owner: IndexArray) -> _Paths:
    depth = np.full(owner.size, flanks.rack.flank_depth_mm)
    start = np.column_stack([flanks.crown_rounding_mm[owner], depth, flanks.rolled_mm(owner, -depth)])
    end = np.column_stack([flanks.rolled_mm(owner, depth), -depth, flanks.rounding_mm[owner]])
    parameters = np.stack([_spread(flanks, owner, start[:, k], end[:, k], k) for k in range(KINDS)], axis=1)
    curves = (flanks.crown, flanks.flank, flanks.fillet)
    points = [curve(owner[:, None], parameters[:, k])[0] for k, curve in enumerate(curves)]
    return _Paths(flanks, owner, parameters, np.concatenate(points, axis=1))


def _spread(flanks: Flanks, owner: IndexArray, start: Array, end: Array, kind: int) -> Array:
    """POINTS parameters from start to end, half of them about the heights at which a flank is not regular."""
    share = np.linspace(0.0, 1.0, POINTS)
    even = start[:, None] + (end - start)[:, None] * share
    if kind != FLANK:
        return even
    fine = start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, FINE)
    folded = flanks.regularity(owner[:, None], fine) <= 0.0
    for row in np.nonzero(folded.any(axis=1))[0]:
        places = np.nonzero(folded[row])[0]
        width = places[-1] - places[0] + 1
        near = fine[row, [max(places[0] - width, 0), min(places[-1] + width, FINE - 1)]]
        focus = np.linspace(near[0], near[1], POINTS - POINTS // 2)
        even[row] = np.sort(np.concatenate([np.linspace(start[row], end[row], POINTS // 2), focus]))[::-1]
    return even


def _tips(paths: _Paths, loops: list[list[tuple[float, float]]]) -> tuple[Array, Array]:
    """Index at which each path, its loops left out, enters the tip land's inside for good, and the land's arc length.
    Index at which each path, its loops left out, enters the tip land's inside for good, and the land's arc length."""
    flanks, owner, addendum = paths.flanks, paths.owner, paths.flanks.rack.addendum_mm
    reach = np.linspace(-0.5, 0.5, 2 * POINTS) * flanks.rack.pitch_mm
    feet = flanks.crossing_mm[owner, None] - flanks.side[owner, None] * reach
    row, index, land = chord_crossings(paths.points, flanks.offset(feet, addendum)[0])
    kept = np.array([not any(a < i < b for a, b in loops[r]) for r, i in zip(row, index, strict=True)], dtype=bool)
    row, index, land = row[kept], index[kept], land[kept]
    last = np.full(owner.size, -1.0)
    np.maximum.at(last, row, index)
    for number in np.nonzero(last < 0.0)[0]:
        raise NoSuchMechanism(
            f"{tooth_name(flanks, int(owner[number]))} does not reach the tip: the pitch curve is too "
            "concave there for "
            "this module; more teeth of a smaller module are needed",
            key="gears.teeth",
        )
    chosen = np.array([np.nonzero((row == number) & (index == last[number]))[0][0] for number in range(owner.size)])
    everyone = np.arange(owner.size)
    foot = np.array([np.interp(land[c], np.arange(reach.size), feet[number]) for number, c in enumerate(chosen)])
    kind, parameter = paths.place(everyone, last)
    parameter, foot, met = refined_crossings(
        lambda t: flanks.curve_of(kind, owner, t),
        lambda s: flanks.offset(s, addendum),
        parameter,
        foot,
        AGREEMENT * flanks.rack.module_mm,
    )
    _require(flanks, owner, met, "end on the tip land")
    return paths.index(everyone, kind, parameter), foot


def _runs(paths: _Paths, row: int, tip: float, loops: list[tuple[float, float]]) -> list[tuple[int, float, float]]:
    """Runs (kind, start, end) of one path from its tip to the root land, loops left out."""
    starts = [tip] + [leave for _, leave in loops]
    ends = [enter for enter, _ in loops] + [float(KINDS * POINTS - 1)]
    runs: list[tuple[int, float, float]] = []
    for start, end in zip(starts, ends, strict=True):
        for kind in range(KINDS):
            low, high = max(start, kind * POINTS), min(end, kind * POINTS + POINTS - 1)
            if high > low:
                _, limits = paths.place(np.array([row, row]), np.array([low, high]))
                runs.append((kind, float(limits[0]), float(limits[1])))
    return runs


def _loops(paths: _Paths) -> list[list[tuple[float, float]]]:
    """Exact indices (enter, leave) of each path's loops, in order and not overlapping."""
    row, first, second = chord_crossings(paths.points, paths.points)
    apart = np.floor(second) > np.floor(first) + 1
    row, first, second = row[apart], first[apart], second[apart]
    chosen: list[int] = []
    for number in np.lexsort((first, row)):
        if not chosen or row[chosen[-1]] != row[number] or first[number] > second[chosen[-1]]:
            chosen.append(int(number))
    chosen_row = row[chosen]
    enter, leave, there = _exact_loops(paths, chosen_row, first[chosen], second[chosen])
    loops: list[list[tuple[float, float]]] = [[] for _ in range(paths.owner.size)]
    for number in np.nonzero(there)[0]:
        loops[chosen_row[number]].append((float(enter[number]), float(leave[number])))
    return loops


def _exact_loops(paths: _Paths, row: IndexArray, first: Array, second: Array) -> tuple[Array, Array, Mask]:
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
    spacing1, spacing2 = paths.spacing(row, kind1, first), paths.spacing(row, kind2, second)
    met &= (np.abs(at1 - start1) <= 2.0 * spacing1) & (np.abs(at2 - start2) <= 2.0 * spacing2)
    lost = np.nonzero(~met)[0]
    if lost.size:
        at1[lost], at2[lost], met[lost] = zoomed_crossings(
            lambda t: flanks.curve_of(kind1[lost], owner[lost], t),
            lambda t: flanks.curve_of(kind2[lost], owner[lost], t),
            start1[lost],
            start2[lost],
            1.5 * spacing1[lost],
            1.5 * spacing2[lost],
        )
    return paths.index(row, kind1, at1), paths.index(row, kind2, at2), met


def _require(flanks: Flanks, owner: IndexArray, met: Mask, what: str) -> None:
    if not met.all():
        raise NoSuchMechanism(
            f"{tooth_name(flanks, int(owner[~met][0]))}: its {what} cannot be found, so irregular is the "
            "tooth; more teeth "
            "of a smaller module are needed",
            key="gears.teeth",
        )


def _merged(sides: Sides, replaced: Mask, rows: list[tuple[int, int, float, float]]) -> Sides:
    kept = ~replaced[sides.owner]
    owner, kind, start, end = (np.array(column) for column in zip(*rows, strict=True))
    all_owner = np.concatenate([sides.owner[kept], owner])
    order = np.argsort(all_owner, kind="stable")
    return replace(
        sides,
        owner=all_owner[order],
        kind=np.concatenate([sides.kind[kept], kind])[order],
        start=np.concatenate([sides.start[kept], start])[order],
        end=np.concatenate([sides.end[kept], end])[order],
    )
