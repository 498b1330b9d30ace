"""A toothed gear: its flanks, the sides that are left of them, its outline, and what is wrong with its teeth."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sin

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.machine.rack import BasicRack
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.flank import Flanks, flanks_of
from ncgear.teeth.outline import outline_points
from ncgear.teeth.sides import Sides, refuse_folded_lands, regular_sides, with_points
from ncgear.teeth.soundness import simple_polygon
from ncgear.teeth.trimming import trimmed_sides


@dataclass(frozen=True, eq=False)
class ToothedGear:
    """One gear with its outline in mm (shape (n, 2), counter-clockwise, own frame, pose of phi1 = 0)."""

    flanks: Flanks
    sides: Sides
    outline_mm: Array

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return self.flanks.count // 2

    @property
    def undercut(self) -> list[int]:
        """Numbers of the teeth whose working flanks have a cusp on the root side, from 1."""
        return _numbers(self.flanks, self.sides.undercut)

    @property
    def pointed(self) -> list[int]:
        """Numbers of the teeth without a tip land, from 1."""
        return _numbers(self.flanks, self.sides.pointed)

    @property
    def least_radius_from_axis_mm(self) -> float:
        """Smallest distance from the gear's axis to its outline, along chords."""
        start, step = self.outline_mm, np.roll(self.outline_mm, -1, axis=0) - self.outline_mm
        share = np.clip(-np.sum(start * step, axis=1) / np.sum(step * step, axis=1), 0.0, 1.0)
        return float(np.min(np.linalg.norm(start + share[:, None] * step, axis=1)))


@dataclass(frozen=True, eq=False)
class ToothedPair:
    """Both gears; a tooth of the driving gear stands in a space of the driven one on the line of centres."""

    driving: ToothedGear
    driven: ToothedGear


def toothed_pair(pitch: PitchPair, rack: BasicRack, tolerance_mm: float, advance_mm: float = 0.0) -> ToothedPair:
    """Exact teeth on both pitch curves, outlines sampled to ``tolerance_mm``.

    ``advance_mm`` moves the teeth of both gears along their pitch curves by the same rolled length, so that they mesh
    at the same driving and driven angles: the section of helical teeth at some height.  Raises NoSuchMechanism, naming
    gear and tooth, where no tooth can stand.
    """
    return ToothedPair(
        toothed_gear(pitch.driving, rack, pitch.size.driving_teeth, tolerance_mm, advance_mm),
        toothed_gear(pitch.driven, rack, pitch.size.driven_teeth, tolerance_mm, advance_mm),
    )


def toothed_gear(
    curve: PitchCurve, rack: BasicRack, teeth: int, tolerance_mm: float, advance_mm: float = 0.0
) -> ToothedGear:
    """One gear; teeth are numbered along growing arc length, tooth 1 of the driving gear at phi1 = 0."""
    flanks = flanks_of(curve, rack, teeth, tooth_at_zero=curve.gear is Gear.DRIVING, advance_mm=advance_mm)
    sides = sides_of(flanks)
    outline = outline_points(flanks, sides, tolerance_mm)
    simple_polygon(outline, f"gears.{curve.gear.value}")
    return ToothedGear(flanks, sides, outline)


def sides_of(flanks: Flanks) -> Sides:
    """The sides of all teeth: regular, trimmed where they must be, and pointed where they meet."""
    refuse_folded_lands(flanks)
    sides, irregular = regular_sides(flanks)
    return with_points(flanks, trimmed_sides(flanks, sides, irregular))


def teeth_free_of_undercut(pitch: PitchPair, rack: BasicRack) -> int:
    """Number of driving teeth from which no tooth can be undercut, wherever it stands on the curves.

    A flank is regular where k h_F < sin^2(alpha); curvature in modules falls as teeth are added at a fixed shape.
    """
    per_curvature = rack.flank_depth_mm / sin(rack.pressure_angle_rad) ** 2
    sharpest = max(pitch.curvature_range[gear][1].value for gear in Gear)
    lobes = pitch.transmission.lobes
    exact = pitch.size.driving_teeth * sharpest * per_curvature
    return lobes.driving * ceil(exact / lobes.driving)


def teeth_free_of_points(pitch: PitchPair, rack: BasicRack, limit: int = 4000) -> int | None:
    """Smallest number of driving teeth, above the present one, at which no tooth is pointed; None beyond ``limit``.

    Found by trial on the exact flanks at the same pitch curves: doubling until there is none, then halving the
    interval.
    """
    lobes = pitch.transmission.lobes.driving
    pointed = pitch.size.driving_teeth // lobes
    free = 2 * pointed
    while _any_pointed(pitch, rack, free * lobes):
        pointed, free = free, 2 * free
        if free * lobes > limit:
            return None
    while free - pointed > 1:
        middle = (free + pointed) // 2
        pointed, free = (middle, free) if _any_pointed(pitch, rack, middle * lobes) else (pointed, middle)
    return free * lobes


def _any_pointed(pitch: PitchPair, rack: BasicRack, teeth: int) -> bool:
    """Whether a tooth of either gear is pointed, or cannot stand at all, with another number of teeth on the curves."""
    scaled = rack.scaled(pitch.size.driving_teeth / teeth)
    driven = teeth * pitch.size.driven_teeth // pitch.size.driving_teeth
    try:
        driving_sides = sides_of(flanks_of(pitch.driving, scaled, teeth, tooth_at_zero=True))
        driven_sides = sides_of(flanks_of(pitch.driven, scaled, driven, tooth_at_zero=False))
    except NoSuchMechanism:
        return True
    return bool(driving_sides.pointed.any() or driven_sides.pointed.any())


def _numbers(flanks: Flanks, marked: np.ndarray) -> list[int]:
    return sorted({int(number) for number in flanks.tooth[marked]})
