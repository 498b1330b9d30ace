"""Stacks of sections so close that the mesh through them keeps to the chord tolerance everywhere between.

A stack is one gear's sections at rising heights, with points on each at the same places round the outline, the columns;
the mesh goes in straight lines from point to point.  A first guess of heights and columns follows from the curvature of
the pitch curves and of the outlines.  Then the mesh is compared with exact sections half way up the steps that may be
the worst; steps and columns are halved where it strays too far.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from ncgear.errors import NoSuchMechanism, Unanswered, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask, counted_up
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.plane import signed_area
from ncgear.pitch.shape import Gear
from ncgear.solids.helical.sections import PER_TOOTH, Pieces, Sections

OUTLINE = 0.1
"""Share of the chord tolerance for the outlines from which sections are sampled."""

SAGITTA, TWIST, RISE = 0.5, 0.5, 0.6
"""Shares of the chord tolerance for the chords of a section, the folds of quadrilaterals, and the straight lines from
section to section.  They are largest at different places, and their sum is measured."""

CHECKED = 3
"""Least number of steps that are checked: the steps that seem to stray most.  All other steps that seem to stray by
more than their share are checked too."""

SECTION_HALVINGS = 6
"""Rounds of halving steps; where a trimmed corner moves across columns, comes or goes, each only halves the error."""

LOCAL = 0.1
"""Greatest share of the columns that may stray for the error to count as one at corners, where more columns help."""

MOST_STEPS = 300
"""Most steps between sections in the first guess: millions of triangles, files of 100 megabytes, a minute's work."""

SPREADS = 5
"""Rounds of placing columns, each by the errors of the last round; even curves would need fewer rounds."""

COLUMN_HALVINGS = 16
"""Rounds of halving between columns where outlines still stray, at corners of a piece: far below their chords."""

SPARE, LEAST = 1.05, 1e-3
"""Columns are placed 5 % closer than seems needed; even a straight interval counts as a thousandth of a column."""

TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class StrayLimits:
    """How far, in mm, the mesh may stray.

    ``sagitta_mm`` limits the distance of a section's outline from the chords between columns.  ``twist_mm`` limits the
    distance of the middle of a quadrilateral between neighbouring sections from its diagonals.
    """

    sagitta_mm: float
    twist_mm: float


def close_stacks(sections: Sections, tolerance_mm: float) -> dict[Gear, Stack]:
    """Each gear's stack up to where the teeth stop advancing.

    Raises NoSuchMechanism, naming the height, where a section cannot be made or no halving keeps to the tolerance;
    WrongInput when that would take too many sections.
    """
    limits = StrayLimits(SAGITTA * tolerance_mm, TWIST * tolerance_mm)
    heights = _first_heights(sections, tolerance_mm)
    columns = {gear: spread_columns(sections.pieces(gear, heights), limits) for gear in Gear}
    for _ in range(SECTION_HALVINGS + 1):
        stacks = {gear: stacked(heights, sections.pieces(gear, heights), columns[gear], limits) for gear in Gear}
        check = _checked(sections, stacks, tolerance_mm)
        if not check.failed.any():
            return stacks
        heights = np.sort(np.append(heights, check.heights_mm[check.failed]))
        columns = {gear: stacks[gear].columns.halved(check.wide(gear)) for gear in Gear}
    raise _too_abrupt(check, stacks, sections, tolerance_mm)


def _first_heights(sections: Sections, tolerance: float) -> Array:
    steps = sections.steps_within(RISE * tolerance)
    if steps > MOST_STEPS:
        raise WrongInput(
            f"teeth that advance by {sections.helix.largest_advance_mm:.4g} mm take {steps} steps from section to "
            f"section for a solid within {tolerance:g} mm, more than {MOST_STEPS}; a smaller angle, a narrower face or "
            f"an output.chord_tolerance_mm of {shown_above(finest_in_steps_mm(sections), 3)} helps",
            key="gears.helix.angle_deg",
        )
    return np.linspace(0.0, sections.helix.rise_mm, steps + 1)


def finest_in_steps_mm(sections: Sections) -> float:
    """The finest chord tolerance of a solid that does not need more steps between sections than are allowed."""
    return sections.sagitta_mm(MOST_STEPS) / RISE


@dataclass(frozen=True, eq=False)
class _Check:
    """Heights of exact sections (shape (s,)) and, by gear, how far the mesh strays from each after each column (s, c).

    ``allowed_mm`` is how far the mesh may stray.
    """

    heights_mm: Array
    strays_mm: dict[Gear, Array]
    allowed_mm: float

    @property
    def failed(self) -> Mask:
        """Heights at which either gear's mesh strays too much, shape (s,)."""
        worst = np.max([np.max(strays, axis=1) for strays in self.strays_mm.values()], axis=0)
        return np.asarray(worst > self.allowed_mm)

    def wide(self, gear: Gear) -> Mask:
        """Columns of a gear after which its mesh strays too far at some height, shape (c,); none if they are many."""
        wide = np.any(self.strays_mm[gear] > self.allowed_mm, axis=0)
        return np.asarray(wide & (np.mean(wide) < LOCAL))


def _checked(sections: Sections, stacks: dict[Gear, Stack], tolerance: float) -> _Check:
    """The steps that may be the worst, compared with exact sections half way up."""
    heights = stacks[Gear.DRIVING].heights_mm
    seeming = np.max([stack.seems_to_stray_mm() for stack in stacks.values()], axis=0)
    steps = np.argsort(seeming)[::-1][: max(CHECKED, int(np.sum(seeming > RISE * tolerance)))]
    middles = (heights[steps] + heights[steps + 1]) / 2.0
    strays = {gear: stacks[gear].strays_mm(steps, sections.pieces(gear, middles)) for gear in Gear}
    return _Check(middles, strays, (1.0 - OUTLINE) * tolerance)


def _too_abrupt(check: _Check, stacks: dict[Gear, Stack], sections: Sections, tolerance: float) -> NoSuchMechanism:
    """The error for teeth that jump between two sections because the undercut that the mate's tips avoid ends there.

    Halving steps does not help there, but letting the flanks be cut away does.
    """
    gear = max(Gear, key=lambda own: float(np.max(check.strays_mm[own])))
    step, column = np.unravel_index(int(np.argmax(check.strays_mm[gear])), check.strays_mm[gear].shape)
    tooth = int(stacks[gear].columns.piece[column]) // PER_TOOTH + 1
    remedy = "gears.undercut: allow, " if sections.form.limits.avoid_undercut else ""
    return NoSuchMechanism(
        f"the teeth change too abruptly at z = {check.heights_mm[step]:.4g} mm for a solid within {tolerance:g} mm: at "
        f"tooth {tooth} of the {gear.value} gear it strays by {check.strays_mm[gear][step, column]:.3g} mm; {remedy}"
        "more teeth of a smaller module or a coarser output.chord_tolerance_mm may help",
        key="gears.helix",
    )


@dataclass(frozen=True, eq=False)
class Stack:
    """Sections at rising heights (shape (l,)), and their points at the columns, shape (l, c, 2), in mm."""

    heights_mm: Array
    columns: ColumnPlaces
    rings_mm: Array

    def counter_clockwise(self) -> Array:
        """The rings, turned round where they run clockwise."""
        return self.rings_mm if signed_area(self.rings_mm[0]) > 0.0 else self.rings_mm[:, ::-1]

    def seems_to_stray_mm(self) -> Array:
        """About how far straight lines stray within each step from one section to the next, shape (l - 1,).

        A section is off the straight line between its neighbours, p below and q above, by X'' p q / 2, across the
        outline; straight lines within a step h are off by X'' h^2 / 8.  The worse end of each step counts.
        """
        step = np.diff(self.heights_mm)
        below, above = step[:-1], step[1:]
        rise = (below / (below + above))[:, None, None]
        off = self.rings_mm[:-2] * (1.0 - rise) + self.rings_mm[2:] * rise - self.rings_mm[1:-1]
        along = (np.roll(self.rings_mm, -1, axis=1) - np.roll(self.rings_mm, 1, axis=1))[1:-1]
        area = np.abs(off[..., 0] * along[..., 1] - off[..., 1] * along[..., 0])
        across = np.max(area / np.maximum(np.linalg.norm(along, axis=2), TINY), axis=1, initial=0.0)
        bend = np.pad(across / (4.0 * below * above), 1)
        return np.asarray(np.maximum(bend[:-1], bend[1:]) * step**2)

    def strays_mm(self, steps: IndexArray, sections: Sequence[Pieces]) -> Array:
        """Distances between the mesh half way up s steps and exact sections there, the largest after each column.

        Both from the outlines to the mesh and the other way round; shape (s, c).
        """
        rings = middle_section(self.rings_mm[steps], self.rings_mm[steps + 1])
        found = [_apart(ring, section.points_mm[:-1]) for ring, section in zip(rings, sections, strict=True)]
        # Two chords of a middle section lie between neighbouring columns.
        return np.asarray(np.stack(found).reshape(len(found), -1, 2).max(axis=2))


def stacked(heights_mm: Array, sections: Sequence[Pieces], columns: ColumnPlaces, limits: StrayLimits) -> Stack:
    """The stack of sections at heights (l,), with columns added until they keep the limits."""
    close = close_columns(columns, sections, limits)
    return Stack(heights_mm, close, close.rings(sections))


def _apart(ring: Array, outline: Array) -> Array:
    """Largest distance between a ring (m, 2) and an outline (n, 2) at each chord of the ring, shape (m,)."""
    chord, away = _nearest(outline, ring)
    largest = _nearest(ring, outline)[1]
    np.maximum.at(largest, chord, away)
    return largest


def _nearest(points: Array, ring: Array) -> tuple[IndexArray, Array]:
    """Number of the nearest chord of a closed ring (m, 2) for each point (n, 2), and the distance to it."""
    chords = shapely.STRtree(shapely.linestrings(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)))
    (_, chord), away = chords.query_nearest(shapely.points(points), all_matches=False, return_distance=True)
    return chord, away


def middle_section(lower_mm: Array, upper_mm: Array) -> Array:
    """Rings half way between rings (..., c, 2), shape (..., 2 c, 2): a plane there meets the mesh's edges in them."""
    lower_next, upper_next = np.roll(lower_mm, -1, axis=-2), np.roll(upper_mm, -1, axis=-2)
    falling = falls(lower_mm, upper_mm)[..., None]
    diagonal = np.where(falling, lower_next + upper_mm, lower_mm + upper_next) / 2.0
    both = np.stack([(lower_mm + upper_mm) / 2.0, diagonal], axis=-2)
    return both.reshape(*lower_mm.shape[:-2], -1, 2)


def falls(lower_mm: Array, upper_mm: Array) -> Mask:
    """Whether quadrilaterals between rings (..., c, 2) are folded from an upper point to the next lower one."""
    falling = np.roll(lower_mm, -1, axis=-2) - upper_mm
    rising = np.roll(upper_mm, -1, axis=-2) - lower_mm
    return np.sum(falling**2, axis=-1) < np.sum(rising**2, axis=-1)


@dataclass(frozen=True, eq=False)
class ColumnPlaces:
    """Places of columns in order, shape (c,) each: piece and share of its length.  Each piece begins with a column."""

    piece: IndexArray
    share: Array

    def rings(self, sections: Sequence[Pieces]) -> Array:
        """Points of the columns in mm on each of l sections, shape (l, c, 2)."""
        return np.stack([section.at(self.piece, self.share) for section in sections])

    def spread(self, wanted: Array) -> ColumnPlaces:
        """The columns spread anew: each piece gets as many as its intervals want together, closer where they want many.

        ``wanted`` (c,) is the number of parts, whole or not, into which the interval after each column is to be
        divided.
        """
        dense = np.maximum(wanted, LEAST) * SPARE
        reached = np.concatenate([[0.0], np.cumsum(dense)])
        begins = np.append(np.nonzero(np.diff(self.piece, prepend=-1))[0], self.piece.size)
        start, total = reached[begins[:-1]], np.diff(reached[begins])
        counts = np.ceil(total).astype(int)
        piece, step = counted_up(np.zeros_like(counts), counts)
        target = start[piece] + (total / counts)[piece] * step
        place = np.interp(target, reached, np.append(self.piece + self.share, counts.size))
        return ColumnPlaces(piece, np.where(step == 0, 0.0, place - piece))

    def halved(self, wide: Mask) -> ColumnPlaces:
        """The columns with a further column half way after each marked one; ``wide`` has shape (c,)."""
        after = np.append(self.share[1:], 0.0)
        middle = (self.share + np.where(after > 0.0, after, 1.0)) / 2.0
        row, step = counted_up(np.zeros_like(self.piece), np.where(wide, 2, 1))
        return ColumnPlaces(self.piece[row], np.where(step == 0, self.share[row], middle[row]))


def spread_columns(sections: Sequence[Pieces], limits: StrayLimits) -> ColumnPlaces:
    """Columns about as far apart as the limits allow in the given sections."""
    columns = ColumnPlaces(np.arange(sections[0].count), np.zeros(sections[0].count))
    for _ in range(SPREADS):
        columns = columns.spread(_wanted(columns, sections, limits))
    return columns


def close_columns(columns: ColumnPlaces, sections: Sequence[Pieces], limits: StrayLimits) -> ColumnPlaces:
    """The columns with others half way between until all sections keep the limits; raises Unanswered if none does."""
    for _ in range(COLUMN_HALVINGS):
        wide = _wanted(columns, sections, limits) > 1.0
        if not wide.any():
            return columns
        columns = columns.halved(wide)
    raise Unanswered(f"a section's outline strays from its chords even after {COLUMN_HALVINGS} halvings")


def _wanted(columns: ColumnPlaces, sections: Sequence[Pieces], limits: StrayLimits) -> Array:
    """Parts into which intervals must be divided, (c,): sagittas fall with their square, twists in proportion."""
    rings = columns.rings(sections)
    sagitta = np.max([sagittas(columns, *pair) for pair in zip(sections, rings, strict=True)], axis=0)
    return np.asarray(np.maximum(np.sqrt(sagitta / limits.sagitta_mm), twists(rings) / limits.twist_mm))


def sagittas(columns: ColumnPlaces, section: Pieces, ring: Array) -> Array:
    """Largest distance in mm of a section's outline from the chord after each column, shape (c,)."""
    at = section.lengths_at(columns.piece, columns.share)
    chord = np.searchsorted(at, section.length_mm[:-1], side="right") - 1
    start, step = ring[chord], (np.roll(ring, -1, axis=0) - ring)[chord]
    arm = section.points_mm[:-1] - start
    along = np.sum(arm * step, axis=1) / np.maximum(np.sum(step * step, axis=1), TINY)
    away = arm - np.clip(along, 0.0, 1.0)[:, None] * step
    largest = np.zeros(len(ring))
    np.maximum.at(largest, chord, np.hypot(away[:, 0], away[:, 1]))
    return largest


def twists(rings: Array) -> Array:
    """Largest distance in mm, after each column, from a quadrilateral's middle to the middles of its diagonals.

    Shape (c,); only the part across the chords counts, since the part along them lies in the surface.
    """
    chord = np.roll(rings, -1, axis=1) - rings
    lower, upper = chord[:-1], chord[1:]
    across = np.abs(lower[..., 0] * upper[..., 1] - lower[..., 1] * upper[..., 0])
    length = np.linalg.norm(lower + upper, axis=-1) / 2.0
    return np.asarray(np.max(across / np.maximum(length, TINY), axis=0) / 4.0)
