"""Profile shift: given for each gear, or chosen against undercut.

A toothed gear: its flanks, the sides that are left of them, its outline, and what is special about its teeth.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, cos, sin, tan

import numpy as np

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.numerics.arrays import Array, Mask
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.cutter import chosen_kind, fouled, pinion_cutter, rack_cutter
from ncgear.teeth.fitting import fitted_pair
from ncgear.teeth.flank import Flanks, flanks_of, tooth_name
from ncgear.teeth.form import CutterKind, ToothForm
from ncgear.teeth.outline import ChordTolerance, outline_points, simple_polygon
from ncgear.teeth.rack import BasicRack
from ncgear.teeth.sides import Sides, refuse_folded_lands, regular_sides
from ncgear.teeth.tips import Limit, Tips
from ncgear.teeth.tool import PinionCircle, RackLine, Tool
from ncgear.teeth.trimming import trimmed_sides

MOST_SHIFT = 0.7
"""Largest shift, in addenda, that is chosen by itself: three tenths of the mate's addendum are left."""

ROUNDING = 1e-9
"""Share by which chosen shifts stay clear of the limit, where rounding would decide whether flanks are undercut."""


def shifted_racks(pitch: PitchPair, form: ToothForm) -> tuple[BasicRack, BasicRack]:
    """The driving and the driven gear's rack.

    Raises WrongInput when the shifts thicken the teeth by more than the backlash, so that they would not go together.
    """
    driving, driven = form.driving_shift_mm, form.driven_shift_mm
    if form.shift_for_undercut:
        driving = shift_against_undercut(pitch, form.rack)
        driven = -driving
    spare = form.rack.backlash_mm - 2.0 * (driving + driven) * sin(form.rack.pressure_angle_rad)
    if spare < -1e-12 * form.rack.module_mm:
        raise WrongInput(
            f"shifts of {driving:g} and {driven:g} mm thicken the teeth by {form.rack.backlash_mm - spare:.4g} mm "
            f"along the normal, more than the backlash of {form.rack.backlash_mm:g} mm; equal and opposite shifts, or "
            "more backlash_mm, are right",
            key="gears.profile_shift",
        )
    return form.rack.shifted(driving), form.rack.shifted(driven)


def shift_against_undercut(pitch: PitchPair, rack: BasicRack) -> float:
    """The driving gear's shift in mm, the driven gear's being its opposite, that leaves least undercut.

    Where k is a gear's largest curvature its flank of depth f - x is regular while (f - x) k < sin^2(alpha); between
    both gears' bounds the least shift is taken, and where there is none between them the mean of both.
    """
    square, depth = sin(rack.pressure_angle_rad) ** 2 * (1.0 - ROUNDING), rack.flank_depth_mm
    least = depth - square / pitch.curvature_range[Gear.DRIVING][1].value
    most = square / pitch.curvature_range[Gear.DRIVEN][1].value - depth
    wanted = float(np.clip(0.0, least, most)) if least <= most else (least + most) / 2.0
    reach = MOST_SHIFT * rack.addendum_mm
    return float(np.clip(wanted, -reach, reach))


def teeth_free_of_undercut(pitch: PitchPair, driving: BasicRack, driven: BasicRack) -> int:
    """Number of driving teeth from which no tooth can be undercut, wherever it stands on the curves.

    A flank is regular where k h_F < sin^2(alpha); curvature in modules falls as teeth are added at a fixed shape.
    """
    square = sin(driving.pressure_angle_rad) ** 2
    depths = {Gear.DRIVING: driving, Gear.DRIVEN: driven}
    worst = max(
        pitch.curvature_range[gear][1].value * (rack.flank_depth_mm - rack.shift_mm) for gear, rack in depths.items()
    )
    lobes = pitch.transmission.lobes.driving
    return lobes * ceil(pitch.size.driving_teeth * worst / square / lobes)


MOST_ASTRAY = 3.0
"""Chord tolerances, over the driven pitch radius, by which the written driven gear may miss the law."""

LEAST_COSINE = 0.1
"""Of the pressure angle, for the chords' sake: beyond 84 degrees no gear can be driven anyway."""


@dataclass(frozen=True, eq=False)
class ToothedGear:
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
        return self.flanks.count // 2

    @property
    def undercut(self) -> list[int]:
        """Numbers of the teeth, from 1, that a tool of full depth undercuts."""
        return self._numbers(self.tips.undercut)

    def shortened(self, reason: Limit) -> list[int]:
        """Numbers of the teeth, from 1, whose tips end where they do for one reason."""
        return self._numbers(self.tips.limit == reason)

    def _numbers(self, marked: Mask) -> list[int]:
        return sorted({int(number) for number in self.flanks.tooth[marked]})


@dataclass(frozen=True, eq=False)
class ToothedPair:
    """Both gears; a tooth of the driving gear stands in a space of the driven one on the line of centres."""

    driving: ToothedGear
    driven: ToothedGear
    cutter: CutterKind

    def of(self, gear: Gear) -> ToothedGear:
        """One of them."""
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
    """Exact teeth on both pitch curves, outlines sampled to ``tolerance_mm``.

    ``flank_tolerance_mm`` is that of the working flanks, by default as fine as keeps the driven gear within three
    tolerances, divided by the driven pitch radius, of the law; with ``straddling`` chords stray by it to both sides of
    the flanks (see ``ChordTolerance``).  With ``advance_mm`` all teeth stand farther along both pitch curves, as in a
    section of helical gears.  Raises NoSuchMechanism, naming gear and tooth, where no tooth can stand, and WrongInput
    where shifts contradict each other.
    """
    kind, tips = pair_tips(pitch, form, advance_mm)
    finer = flank_tolerance_mm or tolerance_mm * _flank_share(pitch, form)
    driving, driven = (_gear(side, ChordTolerance(finer, tolerance_mm, straddling)) for side in tips)
    return ToothedPair(driving, driven, kind)


def _flank_share(pitch: PitchPair, form: ToothForm) -> float:
    """Share of the tolerance that flanks get: two chords astray by t turn the driven gear by 2 t / (r cos(angle)).

    The angle is the pressure angle between the flanks' normal and the driven pitch point's way.
    """
    angle = form.rack.pressure_angle_rad + pitch.largest_tangent_angle_rad.value
    return min(1.0, MOST_ASTRAY / 2.0 * max(cos(angle), LEAST_COSINE))


def pair_tips(pitch: PitchPair, form: ToothForm, advance_mm: float) -> tuple[CutterKind, tuple[Tips, Tips]]:
    """The tool and both gears' flanks at the heights it allows; raises as ``toothed_pair``."""
    kind = chosen_kind(pitch) if form.cutter.kind is CutterKind.AUTO else form.cutter.kind
    tips = _tips(pitch, form, kind, advance_mm)
    if kind is CutterKind.PINION:
        for gear in tips:
            _refuse_fouled(gear)
    return kind, tips


def _refuse_fouled(tips: Tips) -> None:
    cut = np.nonzero(fouled(tips))[0]
    if cut.size:
        raise NoSuchMechanism(
            f"the pinion cutter's tip cuts {tooth_name(tips.flanks, int(cut[0]))} on its way out of the space; fewer "
            "cutter teeth, or kind: mate, are needed",
            key="gears.cutter.teeth",
        )


def _tips(pitch: PitchPair, form: ToothForm, kind: CutterKind, advance: float) -> tuple[Tips, Tips]:
    racks, equivalent = shifted_racks(pitch, form), form.equivalent
    for_driving, for_driven = _tools(pitch, form, kind)
    size, middle = pitch.size, racks[1].pitch_mm / 2.0
    # Shifts that do not cancel would press or part the flanks that push: both gears' teeth stand back by as much.
    eased = (racks[0].shift_mm + racks[1].shift_mm) / 2.0 * tan(form.rack.pressure_angle_rad)
    start = advance + eased, advance + middle - eased
    # Arc length runs against the driving gear's turning: it pushes with its back flanks, onto the driven front ones.
    return fitted_pair(
        flanks_of(pitch.driving, racks[0], size.driving_teeth, for_driving, start[0], -1.0, equivalent=equivalent),
        flanks_of(pitch.driven, racks[1], size.driven_teeth, for_driven, start[1], 1.0, equivalent=equivalent),
        form.limits,
    )


def _tools(pitch: PitchPair, form: ToothForm, kind: CutterKind) -> tuple[Tool, Tool]:
    """What cuts the driving and what cuts the driven gear."""
    match kind:
        case CutterKind.MATE:
            return pitch.driven, pitch.driving
        case CutterKind.PINION:
            cutter: PinionCircle = pinion_cutter(pitch, form.rack, form.cutter.teeth)
            return cutter, cutter
        case _:
            rack: RackLine = rack_cutter(pitch)
            return rack, rack


def _gear(tips: Tips, chords: ChordTolerance) -> ToothedGear:
    """One gear; teeth are numbered along growing arc length, tooth 1 of the driving gear at phi1 = 0."""
    flanks = tips.flanks
    sides, irregular = regular_sides(tips)
    refuse_folded_lands(flanks, sides)
    sides = trimmed_sides(flanks, sides, irregular)
    outline = outline_points(tips, sides, chords)
    simple_polygon(outline, f"gears.{flanks.curve.gear.value}")
    return ToothedGear(tips, sides, outline)
