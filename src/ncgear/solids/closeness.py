"""Stacks of sections so close that a mesh through them keeps to the chord tolerance everywhere between.

A first guess follows from the curvature of the pitch curves and of the outlines.  Then the mesh is held against exact
sections half way up the steps that may be the worst, and halved where it strays, in height and around the outline.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array, Mask
from ncgear.pitch.shape import Gear
from ncgear.solids.columns import Limits, spread_columns
from ncgear.solids.pieces import PER_TOOTH
from ncgear.solids.sections import Sections
from ncgear.solids.stack import Stack, stacked

OUTLINE = 0.1
"""Share of the chord tolerance left to the outlines that sections are sampled from."""

SAGITTA, TWIST, RISE = 0.5, 0.5, 0.6
"""Shares of it that the chords of a section stray, the folds of quadrilaterals, and straight lines from one section to
the next.  They are not at their largest at one place: what they do together is measured."""

CHECKED = 3
"""Steps that are checked at least: those that seem to stray most.  All that seem to stray by more than their share are
checked as well."""

HALVINGS = 6
"""Rounds of halving.  Where a trimmed corner moves across columns, comes or goes, what strays only halves with them."""

LOCAL = 0.1
"""Share of the columns up to which what strays is taken to be at corners, where more columns help."""

MOST_STEPS = 300
"""Steps from section to section at first: millions of triangles, files of a hundred megabytes, a minute's work."""


@dataclass(frozen=True, eq=False)
class _Check:
    """Heights of exact sections (shape (s,)) and, by gear, how far the mesh strays from each after each column (s, c).

    ``allowed_mm`` is how far it may.
    """

    heights_mm: Array
    strays_mm: dict[Gear, Array]
    allowed_mm: float

    @property
    def worst_mm(self) -> Array:
        """How far either gear's mesh strays at each height, shape (s,)."""
        return np.asarray(np.max([np.max(strays, axis=1) for strays in self.strays_mm.values()], axis=0))

    @property
    def failed(self) -> Mask:
        """Heights at which that is too much."""
        return self.worst_mm > self.allowed_mm

    def wide(self, gear: Gear) -> Mask:
        """Columns of a gear after which its mesh strays too much at some height, shape (c,), if they are few."""
        wide = np.any(self.strays_mm[gear] > self.allowed_mm, axis=0)
        return np.asarray(wide & (np.mean(wide) < LOCAL))


def close_stacks(sections: Sections, tolerance_mm: float) -> dict[Gear, Stack]:
    """Each gear's stack up to where the teeth stop advancing.

    Raises NoSuchMechanism, naming the height, where a section cannot be made or no halving keeps to the tolerance;
    WrongInput when that would take too many sections.
    """
    limits = Limits(SAGITTA * tolerance_mm, TWIST * tolerance_mm)
    heights = _first_heights(sections, tolerance_mm)
    columns = {gear: spread_columns(sections.pieces(gear, heights), limits) for gear in Gear}
    for _ in range(HALVINGS + 1):
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
        coarser = tolerance * (steps / MOST_STEPS) ** 2
        raise WrongInput(
            f"teeth that advance by {sections.helix.largest_advance_mm:.4g} mm take {steps} steps from section to "
            f"section for a solid within {tolerance:g} mm, more than {MOST_STEPS}; a smaller angle, a narrower face or "
            f"an output.chord_tolerance_mm of {coarser:.2g} helps",
            key="gears.helix.angle_deg",
        )
    return np.linspace(0.0, sections.helix.rise_mm, steps + 1)


def _checked(sections: Sections, stacks: dict[Gear, Stack], tolerance: float) -> _Check:
    """The steps that may be the worst, held against exact sections half way up."""
    heights = stacks[Gear.DRIVING].heights_mm
    seeming = np.max([stack.seems_to_stray_mm() for stack in stacks.values()], axis=0)
    steps = np.argsort(seeming)[::-1][: max(CHECKED, int(np.sum(seeming > RISE * tolerance)))]
    middles = (heights[steps] + heights[steps + 1]) / 2.0
    strays = {gear: stacks[gear].strays_mm(steps, sections.pieces(gear, middles)) for gear in Gear}
    return _Check(middles, strays, (1.0 - OUTLINE) * tolerance)


def _too_abrupt(check: _Check, stacks: dict[Gear, Stack], sections: Sections, tolerance: float) -> NoSuchMechanism:
    """Teeth jump where the mate's undercut, and with it the height of the tips that avoid it, ends from one section to
    the next: halving does not help there, but letting the flanks be cut away does."""
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
