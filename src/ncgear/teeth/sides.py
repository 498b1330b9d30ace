"""The sides of all teeth as runs of exact curves, from the tip land down to the root land.

A regular flank starts on the tip land and passes into its fillet tangentially.  Where the tool undercuts the flank, or
its fillet folds, the curves cross themselves, and the side is trimmed to the material that the tool leaves: at each
self-crossing of the whole path from tip land to root land, the loop is cut away.  Crossings are found on chords and
refined on the exact curves.  A side is finished when no remaining part of it folds; else it is followed on finer
chords.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ncgear.errors import RefusedAt
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.crossing import chord_crossings, refined_crossings, zoomed_crossings
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.units import in_words
from ncgear.pitch.curve import ClosedPitchCurve
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.flank import FILLET, FLANK, Flanks, flank_name
from ncgear.teeth.regular import folded_fillets, regular_depth
from ncgear.teeth.spaces import Roots, roots_of, sweep_of
from ncgear.teeth.tips import Tips
from ncgear.teeth.tool import AGREEMENT


@dataclass(frozen=True, eq=False)
class Sides:
    """Runs of curves in the order of flanks and, within a flank, from the tip inwards.

    A run is the part of a curve of flank ``owner`` and of ``kind`` FLANK or FILLET between the parameters ``start`` and
    ``end``, shape (runs,) each.  A flank's parameter is the height over the rack's pitch line in mm, a fillet's is the
    arc length in mm.  ``tip_mm`` (shape (2 z,)) is the arc length of the tip land's end at each flank; ``roots`` has
    the ends of the fillets.
    """

    owner: IndexArray
    kind: IndexArray
    start: Array
    end: Array
    tip_mm: Array
    roots: Roots

    def flank_range(self) -> tuple[Array, Array]:
        """Greatest and least height of the working flank at each flank, shape (2 z,) each."""
        on_flank, count = self.kind == FLANK, len(self.tip_mm)
        top, bottom = np.full(count, -np.inf), np.full(count, np.inf)
        np.maximum.at(top, self.owner[on_flank], self.start[on_flank])
        np.minimum.at(bottom, self.owner[on_flank], self.end[on_flank])
        return top, bottom


def swept(tips: Tips, sides: Sides) -> tuple[Tips, Sides]:
    """Tips and sides of a gear with room in its spaces for the mate's tips over the whole play, if any."""
    if not tips.flanks.is_turned:
        return tips, sides
    last = np.searchsorted(sides.owner, np.arange(tips.flanks.count), side="right") - 1
    # A side without a fillet ends where its land begins.
    start = np.where(sides.kind[last] == FILLET, sides.start[last], sides.roots.end_mm)
    flanks = replace(tips.flanks, sweep=sweep_of(sides.roots, start))
    return replace(tips, flanks=flanks), replace(sides, roots=replace(sides.roots, flanks=flanks))


def regular_sides(tips: Tips) -> tuple[Sides, Mask]:
    """All sides as if they were regular, and which flanks are not; shape (2 z,)."""
    flanks = tips.flanks
    every, depth = np.arange(flanks.count), flanks.flank_depth_mm
    undercut = regular_depth(flanks, np.maximum(depth, 0.0)) < depth
    roots = roots_of(flanks)
    sides = Sides(
        owner=np.repeat(every, 2),
        kind=np.tile([FLANK, FILLET], flanks.count),
        start=np.column_stack([tips.height_mm, flanks.rolled_mm(every, -depth)]).ravel(),
        end=np.column_stack([-depth, roots.end_mm]).ravel(),
        tip_mm=tips.at_mm,
        roots=roots,
    )
    return sides, undercut | folded_fillets(flanks)


REMEDY = "more teeth of a smaller module are needed, or a smaller range of the ratio"

SHARPEST = 0.25
"""Least radius of a pitch curve in modules.  A flank that touches at a place of this radius is regular only up to the
radius times sin(20 deg)^2, 0.03 modules, above or below the pitch curve.  Probes of lands and flanks stand 0.05 to 0.2
modules apart: they could pass by a sharper place."""


def refuse_sharp_places(pitch: PitchPair) -> None:
    """Refuse pitch curves too sharp anywhere for any tooth; raises NoSuchMechanism with the radius and the angle."""
    least = SHARPEST * pitch.size.module_mm
    for gear in Gear:
        if max(map(abs, pitch.of(gear).curvature_bounds)) * least <= 1.0:
            continue
        sharpest = max(pitch.curvature_range[gear], key=lambda extremum: abs(extremum.value))
        if abs(sharpest.value) * least > 1.0:
            raise _too_sharp(f"the {gear.value}", sharpest, least, "a law that changes more slowly there is", "motion")


def refuse_sharp_curve(curve: ClosedPitchCurve, module_mm: float, key: str) -> None:
    """As ``refuse_sharp_places``, of a curve that has no law."""
    least = SHARPEST * module_mm
    if max(map(abs, curve.curvature_bounds)) * least <= 1.0:
        return
    panels = curve.panels_mm
    sharpest = largest_of_each(lambda sigma: np.abs(curve.curvature_at(sigma))[None], panels)[0]
    if sharpest.value * least > 1.0:
        at = Extremum(sharpest.value, float(curve.driving_angle(np.array(sharpest.at))))
        raise _too_sharp("a", at, least, "rounder curves are", key)


def _too_sharp(which: str, sharpest: Extremum, least_mm: float, remedy: str, key: str) -> RefusedAt:
    return RefusedAt(
        f"{which} pitch curve is curved with a radius of {1.0 / abs(sharpest.value):.4g} mm at phi1 = "
        f"{in_words(sharpest.at)}, less than {least_mm:.4g} mm, a quarter of the module: no flank rolls over that; "
        f"{remedy} needed",
        phi1_rad=sharpest.at,
        key=key,
    )


PROBES = 17
"""Places on each land tested for folds; along a land, a sixth of a pitch, the curvature changes little."""


def refuse_folded_lands(flanks: Flanks, sides: Sides) -> None:
    """Refuse a pitch curve that is too sharply curved for its tip and root lands.

    A tip land is parallel to the pitch curve and folds where the curve is hollow with a radius less than the land's
    height.  A root land folds where it is deeper than the radius with which gear and tool turn about each other (1 over
    the sum of their curvatures).  Raises NoSuchMechanism with the radius, the tooth and the angle.
    """
    _refuse_folded_tips(flanks, sides)
    start, end = sides.roots.lands()
    sigma = _probes(start, end)
    depth, limit = sides.roots.folding(np.arange(start.size)[:, None], sigma)
    tooth, place = _worst(depth / limit)
    if depth[tooth, place] < limit[tooth, place]:
        return
    raise RefusedAt(
        f"the root of the space after tooth {tooth + 1} of the {flanks.curve.gear.value} gear folds at phi1 = "
        f"{in_words(_angle(flanks, sigma[tooth, place]))}: gear and tool turn about each other with a radius of "
        f"{limit[tooth, place]:.4g} mm there, less than its depth of {depth[tooth, place]:.4g} mm; {REMEDY}",
        phi1_rad=_angle(flanks, sigma[tooth, place]),
        key="gears.teeth",
    )


def _refuse_folded_tips(flanks: Flanks, sides: Sides) -> None:
    """Refuse a hollow that is sharper than its tip lands are high."""
    back, front = np.arange(0, flanks.count, 2), np.arange(1, flanks.count, 2)
    sigma = _probes(sides.tip_mm[back], sides.tip_mm[front])
    height = np.maximum(flanks.tip_height_mm[back], flanks.tip_height_mm[front])
    if np.all(-height * flanks.curve.curvature_bounds[0] < 1.0):
        return
    folding = -height[:, None] * flanks.curve.curvature_at(sigma)
    tooth, place = _worst(folding)
    if folding[tooth, place] < 1.0:
        return
    raise RefusedAt(
        f"the {flanks.curve.gear.value} pitch curve is hollow with a radius of "
        f"{height[tooth] / folding[tooth, place]:.4g} mm at phi1 = {in_words(_angle(flanks, sigma[tooth, place]))}, "
        f"less than the height of {height[tooth]:.4g} mm of tooth {tooth + 1} there; {REMEDY}",
        phi1_rad=_angle(flanks, sigma[tooth, place]),
        key="gears.teeth",
    )


def _probes(start: Array, end: Array) -> Array:
    return start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, PROBES)


def _worst(values: Array) -> tuple[int, int]:
    return divmod(int(np.argmax(values)), values.shape[1])


def _angle(flanks: Flanks, sigma: float) -> float:
    return float(flanks.curve.driving_angle(np.array(sigma)))


KINDS = 2
"""Number of curves of a whole side: FLANK and FILLET, in this order."""

FINE = 257
"""Points per curve tested for folds."""

FLAT = 1e-9
"""Regularity, a pure number of order 1, that counts as zero."""

ROUNDS = (49, 145, 433)
"""Points per curve in the rounds: the first does for nearly all sides, the others for loops smaller than its chords."""

Loop = tuple[float, float]
"""Indices along a path of a loop's beginning and end."""


def trimmed_sides(flanks: Flanks, sides: Sides, irregular: Mask) -> Sides:
    """The sides; sides of ``irregular`` flanks are replaced by their trimmed paths.

    Raises NoSuchMechanism, naming the tooth, where nothing of a side remains or its loops cannot be resolved.
    """
    todo, tops = np.nonzero(irregular)[0], sides.flank_range()[0]
    for count in ROUNDS:
        if not todo.size:
            return sides
        paths = _paths(flanks, todo, tops[todo], sides.roots.end_mm[todo], count)
        trimmed = _trimmed(paths)
        sides = _with_trimmed(sides, todo, trimmed)
        todo = todo[trimmed.folded]
    if todo.size:
        raise RefusedAt(
            f"{flank_name(flanks, int(todo[0]))} crosses itself where no tool can cut it clean: the pitch curve bends "
            "too sharply there; more teeth of a smaller module are needed",
            phi1_rad=_angle(flanks, flanks.crossing_mm[todo[0]]),
            key="gears.teeth",
        )
    return sides


@dataclass(frozen=True, eq=False)
class _Trimmed:
    """The remaining runs of curves of paths, shape (runs,), and the numbers of paths that still fold."""

    row: IndexArray
    kind: IndexArray
    start: Array
    end: Array
    folded: Mask


def _with_trimmed(sides: Sides, owner: IndexArray, trimmed: _Trimmed) -> Sides:
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


@dataclass(frozen=True, eq=False)
class _Paths:
    """Sides of n flanks, each of two curves of m points.

    ``parameters`` has shape (n, 2, m), ``points`` (n, 2 m, 2).  Fractional indices count the points along a path; where
    the curves join, the point stands twice.
    """

    flanks: Flanks
    owner: IndexArray
    parameters: Array
    points: Array

    @property
    def count(self) -> int:
        """Points per curve."""
        return int(self.parameters.shape[2])

    def place(self, row: IndexArray, index: Array) -> tuple[IndexArray, Array]:
        """Kind and parameter at fractional indices."""
        kind = np.minimum((index // self.count).astype(int), KINDS - 1)
        local = np.clip(index - kind * self.count, 0.0, self.count - 1.0)
        low = np.minimum(local.astype(int), self.count - 2)
        before, after = self.parameters[row, kind, low], self.parameters[row, kind, low + 1]
        return kind, before + (after - before) * (local - low)

    def index(self, row: IndexArray, kind: IndexArray, parameter: Array) -> Array:
        """Fractional indices of parameters; the inverse of ``place``."""
        numbers = np.arange(self.count, dtype=float)
        found = np.empty(row.size)
        for number, (r, k) in enumerate(zip(row, kind, strict=True)):
            known = self.parameters[r, k]
            order = slice(None) if known[-1] > known[0] else slice(None, None, -1)
            found[number] = k * self.count + np.interp(parameter[number], known[order], numbers[order])
        return found

    def reaches(
        self, row: IndexArray, kind1: IndexArray, first: Array, kind2: IndexArray, second: Array
    ) -> tuple[Array, Array]:
        """Largest distance in parameters of crossings from those of chords: 1.5 of the longer chords, for sagittas."""
        spacing1, length1 = self._chord(row, kind1, first)
        spacing2, length2 = self._chord(row, kind2, second)
        longer = 1.5 * np.maximum(length1, length2)
        return spacing1 * longer / length1, spacing2 * longer / length2

    def _chord(self, row: IndexArray, kind: IndexArray, index: Array) -> tuple[Array, Array]:
        """Step of the parameter and length in mm of the chords at fractional indices."""
        low = np.clip((index - kind * self.count).astype(int), 0, self.count - 2)
        step = np.abs(self.parameters[row, kind, low + 1] - self.parameters[row, kind, low])
        start = kind * self.count + low
        length = np.linalg.norm(self.points[row, start + 1] - self.points[row, start], axis=1)
        return step, np.maximum(length, 1e-12 * self.flanks.rack.module_mm)

    def folds(self, row: IndexArray, kind: IndexArray, start: Array, end: Array) -> Mask:
        """Whether stretches of the curves, shape (r,), still fold anywhere inside."""
        share = (1.0 - np.cos(np.pi * np.linspace(0.01, 0.99, FINE // 4))) / 2.0
        parameter = start[:, None] + (end - start)[:, None] * share
        folds = np.zeros(row.size, dtype=bool)
        for number in range(KINDS):
            mask = kind == number
            folds[mask] = np.any(_folded(self.flanks, self.owner[row[mask]], parameter[mask], number), axis=1)
        return folds


def _paths(flanks: Flanks, owner: IndexArray, top_mm: Array, root_mm: Array, count: int) -> _Paths:
    """The paths of the flanks ``owner``, ``count`` points on each curve, from heights to ends of fillets, (n,)."""
    depth = flanks.flank_depth_mm[owner]
    start = np.column_stack([top_mm, flanks.rolled_mm(owner, -depth)])
    end = np.column_stack([-depth, root_mm])
    spread = [_spread(flanks, owner, start[:, kind], end[:, kind], kind, count) for kind in range(KINDS)]
    points = [curve(owner[:, None], spread[kind])[0] for kind, curve in enumerate((flanks.flank, flanks.fillet))]
    return _Paths(flanks, owner, np.stack(spread, axis=1), np.concatenate(points, axis=1))


def _spread(flanks: Flanks, owner: IndexArray, start: Array, end: Array, kind: int, count: int) -> Array:
    """Parameters from start to end, (n, count), dense at folds and near the flank, where loops are small."""
    even = np.linspace(0.0, 1.0, count)
    share = even**3 if kind == FILLET else even
    spread = start[:, None] + (end - start)[:, None] * share
    fine = start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, FINE)
    folded = _folded(flanks, owner, fine, kind)
    for row in np.nonzero(folded.any(axis=1))[0]:
        near = _about_runs(fine[row], folded[row], count // 2)
        ordered = np.sort(np.concatenate([spread[row, ::2], near]))
        spread[row] = ordered if end[row] > start[row] else ordered[::-1]
    return spread


def _about_runs(values: Array, marked: Mask, count: int) -> Array:
    """``count`` numbers across the runs of marked values, each run widened by its own width to either side."""
    edges = np.nonzero(np.diff(np.concatenate([[False], marked, [False]])))[0]
    runs = list(zip(edges[::2], edges[1::2], strict=True))
    shares = np.diff(np.linspace(0, count, len(runs) + 1).astype(int))
    last = len(values) - 1
    pieces = [
        np.linspace(values[max(2 * first - after, 0)], values[min(2 * after - first, last)], share)
        for (first, after), share in zip(runs, shares, strict=True)
    ]
    return np.concatenate(pieces)


def _folded(flanks: Flanks, owner: IndexArray, parameter: Array, kind: int) -> Mask:
    """Whether curves fail to bound the tooth, at parameters of shape (n, m)."""
    regularity = flanks.regularity if kind == FLANK else flanks.fillet_regularity
    return regularity(owner[:, None], parameter) < -FLAT


def _trimmed(paths: _Paths) -> _Trimmed:
    loops = _loops(paths)
    runs = [run for row in range(paths.owner.size) for run in _runs(paths, row, loops[row])]
    row, kind, start, end = (np.array(column) for column in zip(*runs, strict=True))
    folded = np.zeros(paths.owner.size, dtype=bool)
    folded[row[paths.folds(row, kind, start, end)]] = True
    return _Trimmed(row, kind, start, end, folded)


def _runs(paths: _Paths, row: int, loops: list[Loop]) -> list[tuple[int, int, float, float]]:
    """Runs (row, kind, start, end) of one path from its tip to the root land, without its loops."""
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


def _loops(paths: _Paths) -> list[list[Loop]]:
    """Exact indices of each path's loops, in order and not overlapping."""
    row, first, second = chord_crossings(paths.points, paths.points)
    # Neighbouring chords meet in their common point, also across the joint of two curves, which has it twice.
    apart = (np.floor(second) > np.floor(first) + 1) & (second - first > 1.0 + 1e-9)
    row, first, second = row[apart], first[apart], second[apart]
    enter, leave, there = _exact_loops(paths, row, first, second)
    loops: list[list[Loop]] = [[] for _ in range(paths.owner.size)]
    for number in np.lexsort((enter, row)):
        own = loops[row[number]]
        if there[number] and (not own or enter[number] > own[-1][1]):
            own.append((float(enter[number]), float(leave[number])))
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
    # On a single curve the two places must stay apart: it meets itself at every point.
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
