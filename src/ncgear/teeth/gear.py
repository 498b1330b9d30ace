"""Toothed gears: from the pitch curves and the form of the teeth to both gears' outlines.

This is the entrance to the room.  It chooses a tool, places flanks along both pitch curves with profile shifts that are
given or chosen against undercut, fits spaces and tips to each other, and makes the outlines from the remaining sides of
the teeth.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import ceil, cos, inf, tan

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Mask
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.shown import Shown
from ncgear.teeth.backlash import play_of
from ncgear.teeth.chords import TooManyChords
from ncgear.teeth.fitting import fitted_pair
from ncgear.teeth.flank import Flanks, flanks_of
from ncgear.teeth.form import MOST_SHIFT, BasicRack, CutterKind, ToothForm
from ncgear.teeth.fouling import refuse_fouling_cutter
from ncgear.teeth.outline import ChordTolerance, outline_points, simple_polygon
from ncgear.teeth.shifts import ToothShifts, refuse_open, tooth_shifts
from ncgear.teeth.sides import Sides, refuse_folded_lands, refuse_sharp_places, regular_sides, swept, trimmed_sides
from ncgear.teeth.tips import Limit, Tips
from ncgear.teeth.tool import chosen_tools

MOST_ASTRAY = 3.0
"""The driven gear as written may miss the law by this many chord tolerances, divided by the driven pitch radius."""

LEAST_COSINE = 0.1
"""Least cosine of the pressure angle that chords are fitted to: beyond 84 degrees no gear can be driven anyway."""


NEXT = 1.0 + 1e-4
"""Least factor between a tried tolerance and the next."""


@dataclass(frozen=True, eq=False)
class ToothedGear(Shown):
    """One gear with its outline in mm (shape (n, 2), counter-clockwise, own frame, pose of phi1 = 0)."""

    tips: Tips
    sides: Sides
    outline_mm: Array

    def __repr__(self) -> str:
        shortened = len(self._numbers(self.tips.limit != Limit.FULL))
        return (
            f"ToothedGear({self.teeth} teeth, {shortened} of them shortened, outline of {len(self.outline_mm)} points)"
        )

    @property
    def flanks(self) -> Flanks:
        """The curves of its teeth."""
        return self.tips.flanks

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return self.flanks.teeth

    @property
    def undercut(self) -> list[int]:
        """Numbers of the teeth, from 1, that a tool of full depth undercuts."""
        return self._numbers(self.tips.undercut)

    def shortened(self, reason: Limit) -> list[int]:
        """Numbers of the teeth, from 1, whose tips have this limit."""
        return self._numbers(self.tips.limit == reason)

    def _numbers(self, marked: Mask) -> list[int]:
        return sorted({int(number) for number in self.flanks.tooth[marked]})


@dataclass(frozen=True, eq=False)
class ToothedPair(Shown):
    """Both gears and the cutter; at phi1 = 0 a driving tooth stands in a driven space on the line of centres."""

    driving: ToothedGear
    driven: ToothedGear
    cutter: CutterKind

    def of(self, gear: Gear) -> ToothedGear:
        """The driving or the driven gear."""
        return self.driving if gear is Gear.DRIVING else self.driven

    def __repr__(self) -> str:
        return f"ToothedPair(cutter {self.cutter.value},\n  driving: {self.driving!r},\n  driven: {self.driven!r})"


def toothed_pair(
    pitch: PitchPair,
    form: ToothForm,
    tolerance_mm: float,
    *,
    flank_tolerance_mm: float | None = None,
    straddling: bool = False,
    advance_mm: float = 0.0,
) -> ToothedPair:
    """Exact teeth on both pitch curves, with outlines sampled to ``tolerance_mm``.

    ``flank_tolerance_mm`` is the tolerance of the working flanks.  By default it is so fine that the driven gear's
    error is at most three tolerances divided by the driven pitch radius.  With ``straddling`` chords stray to both
    sides of the flanks (see ``ChordTolerance``).  With ``advance_mm`` all teeth stand farther along both pitch curves,
    as in a section of helical gears.  Raises NoSuchMechanism, naming gear and tooth, where no tooth can stand.
    """
    made = pair_tips(pitch, form, advance_mm)
    return outlined_pair(pitch, form, made, tolerance_mm, flank_tolerance_mm=flank_tolerance_mm, straddling=straddling)


def outlined_pair(
    pitch: PitchPair,
    form: ToothForm,
    made: tuple[CutterKind, tuple[Tips, Tips]],
    tolerance_mm: float,
    *,
    flank_tolerance_mm: float | None = None,
    straddling: bool = False,
) -> ToothedPair:
    """Both gears of the flanks that ``pair_tips`` has ``made``, as ``toothed_pair``."""
    kind, tips = made
    # Two chords astray by t turn the driven gear by 2 t / (r cos(angle)), the angle being that between the flanks'
    # normal and the way of the driven pitch point.
    angle = max(form.rack.angles_rad) + pitch.largest_tangent_angle_rad.value
    flank_share = min(1.0, MOST_ASTRAY / 2.0 * max(cos(angle), LEAST_COSINE))
    finer = flank_tolerance_mm or tolerance_mm * flank_share
    driving, driven = (toothed_gear(side, ChordTolerance(finer, tolerance_mm, straddling)) for side in tips)
    return ToothedPair(driving, driven, kind)


def finest_tolerance_mm(pitch: PitchPair, form: ToothForm, from_mm: float) -> tuple[float, int]:
    """The finest tolerance from ``from_mm`` on for which ``toothed_pair`` makes points, and a gear's most points."""
    tolerance_mm = from_mm
    while True:
        try:
            made = toothed_pair(pitch, form, tolerance_mm)
        except TooManyChords as refused:
            tolerance_mm *= max(refused.times, NEXT)
        else:
            return tolerance_mm, max(len(made.of(gear).outline_mm) for gear in Gear)


def pair_tips(pitch: PitchPair, form: ToothForm, advance_mm: float) -> tuple[CutterKind, tuple[Tips, Tips]]:
    """The kind of tool and both gears' flanks, fitted to each other but not yet trimmed; raises as ``toothed_pair``."""
    refuse_sharp_places(pitch)
    play, size = play_of(pitch, form.rack, form.backlash), pitch.size
    racks = shifted_racks(pitch, form)
    kind, tools = chosen_tools(pitch, form)
    # Flanks that meet cross at equal arc lengths, so the difference of both shifts makes teeth thicker, but their sum
    # does not.  Arc length runs against the driving gear's turning: its back flanks push onto the driven front flanks;
    # its front flanks and the driven back flanks are idle.
    quarter = form.rack.pitch_mm / 4.0
    pushing, idle = ((racks[0].shift_mm - racks[1].shift_mm) / 2.0 * tan(angle) for angle in form.rack.angles_rad)
    turn = -pitch.mesh.sense * play.driven_rad
    first = quarter + pushing, quarter + idle - play.setback_mm + play.thicker_mm
    second = quarter - idle + play.setback_mm + play.thicker_mm, quarter - pushing
    arc = pitch.toothed
    first_mm = advance_mm - (arc.before * form.rack.pitch_mm if arc else 0.0)
    start = first_mm, first_mm + 2.0 * quarter
    count = (arc.around, arc.around) if arc else (size.driving_teeth, size.driven_teeth)
    made = [arc.teeth(gear) if arc else None for gear in Gear]
    shifts: tuple[ToothShifts, ToothShifts] | tuple[None, None] = (None, None)
    if form.tooth_shifts_mm:
        if arc:
            refuse_open()
        shifts = tooth_shifts(np.array(form.tooth_shifts_mm), form.rack.module_mm, form.rack.angles_rad, count)
    driving, driven = (
        partial(flanks_of, shifts=own, equivalent=form.equivalent, made=kept)
        for own, kept in zip(shifts, made, strict=True)
    )
    tips = fitted_pair(
        driving(pitch.driving, racks[0], count[0], tools[0], start[0], first),
        driven(pitch.driven, racks[1], count[1], tools[1], start[1], second, turn),
        form.limits,
    )
    if kind is CutterKind.PINION:
        for gear in tips:
            refuse_fouling_cutter(gear)
    return kind, tips


def toothed_gear(tips: Tips, chords: ChordTolerance) -> ToothedGear:
    """One gear.  Teeth are numbered along growing arc length; at phi1 = 0 the driving gear's tooth 1 is in mesh."""
    flanks = tips.flanks
    sides, irregular = regular_sides(tips)
    refuse_folded_lands(flanks, sides)
    tips, sides = swept(tips, trimmed_sides(flanks, sides, irregular))
    outline = outline_points(tips, sides, chords)
    simple_polygon(outline, f"gears.{flanks.curve.gear.value}")
    made = flanks.is_made
    return ToothedGear(
        replace(tips, limit=np.where(made, tips.limit, Limit.FULL), undercut=tips.undercut & made), sides, outline
    )


ROUNDING = 1e-9
"""Distance of chosen shifts from the limit, as a share of it: at the limit rounding would decide about undercut."""


def shifted_racks(pitch: PitchPair, form: ToothForm) -> tuple[BasicRack, BasicRack]:
    """The driving and the driven gear's rack."""
    driving, driven = form.driving_shift_mm, form.driven_shift_mm
    if form.shift_for_undercut:
        driving = shift_against_undercut(pitch, form.rack)
        driven = 0.0 - driving  # no -0.0 to be told
    return form.rack.shifted(driving), form.rack.shifted(driven)


def shift_against_undercut(pitch: PitchPair, rack: BasicRack) -> float:
    """The driving gear's shift in mm that leaves least undercut; the driven gear's is its opposite.

    Where k is a gear's largest curvature, its flank of depth f - x is regular while (f - x) k < sin^2(alpha).  That
    bounds the shift from below and from above; of unequal flanks, the flank with the closer bound counts.  A gear that
    is nowhere convex, as most rings are, sets no bound.  Between both bounds the shift nearest to zero is taken; where
    nothing lies between them, their mean.
    """
    sharpest = [pitch.curvature_range[gear][1].value for gear in Gear]
    bounds = []
    for slant in rack.slants:
        square, depth = slant.sine**2 * (1.0 - ROUNDING), rack.dedendum_mm - rack.root_radius_mm * (1.0 - slant.sine)
        driving, driven = (square / k if k > 0.0 else inf for k in sharpest)
        bounds.append((depth - driving, driven - depth))
    least, most = max(low for low, _ in bounds), min(high for _, high in bounds)
    wanted = float(np.clip(0.0, least, most)) if least <= most else (least + most) / 2.0
    reach = MOST_SHIFT * rack.addendum_mm
    return float(np.clip(wanted, -reach, reach))


def teeth_free_of_undercut(pitch: PitchPair, driving: BasicRack, driven: BasicRack) -> int:
    """Number of driving teeth, or of pitches in the range, from which no tooth can be undercut at any place.

    A flank is regular where k h_F < sin^2(alpha); the curvature per module falls as teeth are added at a fixed
    shape.
    """
    depths = {Gear.DRIVING: driving, Gear.DRIVEN: driven}
    whole, toothed = pitch.size.driving_teeth, pitch.toothed
    around = whole if toothed is None else toothed.covered_mm / driving.pitch_mm
    found = []
    for gear, rack in depths.items():
        sharpest = pitch.curvature_range[gear][1].value
        for slant in rack.slants:
            depth = rack.dedendum_mm - rack.root_radius_mm * (1.0 - slant.sine) - rack.shift_mm
            found.append(around * (sharpest * depth) / slant.sine**2)
    if toothed is not None:
        return ceil(max(found))
    lobes = pitch.transmission.lobes.driving
    return lobes * ceil(max(found) / lobes)
