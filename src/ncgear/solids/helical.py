"""Helical and herringbone gears as solids: sections lofted into meshes that are held against exact sections between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.machine.rack import BasicRack
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.pitch.pair import PitchPair
from ncgear.solids.bore import bore_points
from ncgear.solids.helix import Helix
from ncgear.solids.index_hole import DRIVEN_DIRECTION_RAD, DRIVING_DIRECTION_RAD, hole_points, index_hole
from ncgear.solids.loft import lofted
from ncgear.solids.pair import Blank, GearSolid, SolidPair
from ncgear.solids.section import common_disc, require_room
from ncgear.solids.sections import Sections
from ncgear.solids.stack import Stack, stacked
from ncgear.teeth.gear import ToothedGear, ToothedPair

OUTLINE = 0.1
"""Share of the chord tolerance left to the outlines that sections are sampled from."""

SAGITTA, TWIST, RISE = 0.5, 0.5, 0.6
"""Shares of it that the chords of a section stray, the folds of quadrilaterals, and straight lines from one section to
the next.  They are not at their largest at one place: what they do together is measured."""

CHECKED = 3
"""Steps in whose middle the mesh is held against exact sections: those that seem to stray most, and all that seem to
stray by more than their share."""

HALVINGS = 6
"""Rounds of halving the steps that stray: where a trimmed corner comes or goes, what strays only halves with them."""


@dataclass(frozen=True, eq=False)
class _Stacks:
    """Sections of a pair up to where the teeth stop advancing, and each gear's stack of them."""

    pairs: list[ToothedPair]
    driving: Stack
    driven: Stack


def helical_pair(
    pitch: PitchPair, rack: BasicRack, helix: Helix, driving: Blank, driven: Blank, tolerance_mm: float
) -> SolidPair:
    """Both gears as meshes that stray from the exact surfaces by no more than the chord tolerance.

    Raises NoSuchMechanism, naming the height, where a section cannot be made or changes too abruptly with height;
    WrongInput when a bore does not fit into every section.
    """
    stacks = _close_stacks(Sections(pitch, rack, helix, OUTLINE * tolerance_mm), tolerance_mm)
    own, mate = [pair.driving for pair in stacks.pairs], [pair.driven for pair in stacks.pairs]
    return SolidPair(
        _solid(own, _whole(stacks.driving, helix), driving, tolerance_mm, DRIVING_DIRECTION_RAD, "gears.driving"),
        _solid(mate, _whole(stacks.driven, helix), driven, tolerance_mm, DRIVEN_DIRECTION_RAD, "gears.driven"),
    )


def _close_stacks(sections: Sections, tolerance: float) -> _Stacks:
    """Stacks between whose sections, as far as they are checked, the meshes keep to the tolerance."""
    heights = np.linspace(0.0, sections.helix.rise_mm, sections.steps_within(RISE * tolerance) + 1)
    for _ in range(HALVINGS + 1):
        stacks = _stacks(sections, heights, tolerance)
        steps = _suspects(stacks, tolerance)
        middles = (heights[steps] + heights[steps + 1]) / 2.0
        strays = np.array([_strays(stacks, step, sections.at(z)) for step, z in zip(steps, middles, strict=True)])
        far = strays > (1.0 - OUTLINE) * tolerance
        if not far.any():
            return stacks
        heights = np.sort(np.append(heights, middles[far]))
    raise NoSuchMechanism(
        f"the teeth change too abruptly at z = {middles[np.argmax(strays)]:.4g} mm for a solid within "
        f"{tolerance:g} mm (it strays by {strays.max():.3g} mm); more teeth of a smaller module or a coarser "
        "output.chord_tolerance_mm helps",
        key="gears.helix",
    )


def _stacks(sections: Sections, heights: Array, tolerance: float) -> _Stacks:
    pairs = [sections.at(height) for height in heights]
    limits = SAGITTA * tolerance, TWIST * tolerance
    driving = stacked(heights, [pair.driving for pair in pairs], *limits)
    return _Stacks(pairs, driving, stacked(heights, [pair.driven for pair in pairs], *limits))


def _suspects(stacks: _Stacks, tolerance: float) -> IndexArray:
    """Numbers of the steps to be checked."""
    seeming = np.maximum(stacks.driving.seems_to_stray_mm(), stacks.driven.seems_to_stray_mm())
    return np.argsort(seeming)[::-1][: max(CHECKED, int(np.sum(seeming > RISE * tolerance)))]


def _strays(stacks: _Stacks, step: int, exact: ToothedPair) -> float:
    """How far either mesh strays half way up a step from the exact section there."""
    return max(
        stacks.driving.strays_mm(step, exact.driving.outline_mm),
        stacks.driven.strays_mm(step, exact.driven.outline_mm),
    )


def _whole(stack: Stack, helix: Helix) -> Stack:
    return stack.mirrored() if helix.herringbone else stack


def _solid(
    sections: list[ToothedGear], stack: Stack, blank: Blank, tolerance: float, direction: float, key: str
) -> GearSolid:
    """A gear's mesh; bore and index hole keep their walls in every section."""
    disc = common_disc([section.outline_mm for section in sections], key)
    holes = []
    if blank.bore is not None:
        require_room(disc, blank.bore, tolerance, key)
        holes.append(bore_points(blank.bore, tolerance))
    module = sections[0].flanks.rack.module_mm
    mark = index_hole(disc, blank.bore, direction, module) if blank.index_hole else None
    if mark is not None:
        holes.append(hole_points(mark, tolerance))
    return GearSolid(lofted(stack.rings_mm, stack.heights_mm, holes), mark)
