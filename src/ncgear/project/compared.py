"""Gears measured by a coordinate measuring machine: compared with the exact gears, and run together.

Each gear is brought into the pose of best fit; then its points are compared flank by flank.  The pair as measured,
beside the exact outlines, is run through the contact of written outlines, like the outlines of files.  Helical gears
are compared in the measured section (``project.workshop_measures.measured_section``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from enum import StrEnum
from pathlib import Path

import numpy as np

from ncgear.contact.placement import Placement, placed
from ncgear.contact.written.as_written import AsWritten, Outlines, as_written, reach_mm
from ncgear.contact.written.extremes import PlayExtremes, play_extremes
from ncgear.design.reading.measured_file import MeasuredFile
from ncgear.errors import DesignError, WrongInput
from ncgear.frozen import dataclass
from ncgear.metrology.best_fit import BestFit, best_fit, nearness_mm
from ncgear.metrology.deviations import GearDeviations, deviations, outline_as_measured
from ncgear.metrology.exact_outline import ExactOutline, exact_outline
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.plane import as_complex
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.workshop_measures import measured_section
from ncgear.teeth.backlash import idle_arms_mm
from ncgear.teeth.gear import ToothedPair


class FittedQuantities(StrEnum):
    """Fitted quantities: only the angle, about the bore at (0, 0) of the file, or the place of the axis too."""

    ROTATION = "rotation"
    RIGID = "rigid"


SUSPECT_IN_MODULES = 0.02
"""R.m.s.  distance above which other readings of a file are tried, also where most of its points are far off."""

MOST_IN_MODULES = 0.1
"""R.m.s.  distance above which a gear surely is not the gear of the design."""

MUCH_NEARER = 0.5
"""Another reading is named if the distance of its points is at most this share."""

INCH_MM = 25.4

MIRRORED = "they fit its mirror image; look at the gear from its other side, or change the sign of x"


@dataclass(frozen=True, eq=False)
class ComparedGear:
    """A measured gear in its pose of best fit: its deviations, and its outline as measured (mm, shape (n, 2))."""

    gear: Gear
    file: MeasuredFile
    outline: ExactOutline
    fit: BestFit
    deviations: GearDeviations
    outline_mm: Array


@dataclass(frozen=True, eq=False)
class ComparedPair:
    """Measured gears, the contact of the pair as measured, and the contact of the exact outlines.

    A gear that was not measured is exact.  ``measured_extremes`` and ``exact_extremes`` are also searched between the
    positions.  ``lever_mm`` is the arm that turns an angle of the driven gear into the least normal backlash of the
    design.
    """

    gears: tuple[ComparedGear, ...]
    teeth: ToothedPair
    placement: Placement
    measured: AsWritten
    exact: AsWritten
    measured_extremes: PlayExtremes
    exact_extremes: PlayExtremes
    lever_mm: float

    @property
    def jams(self) -> list[tuple[int, int]]:
        """Driving and driven tooth, counted from 1, of each pitch where the teeth have no room, the tightest first."""
        play = self.measured.backlash_rad
        tight = np.flatnonzero(play < -JAM_RAD)
        pairs = [self.placement.teeth_at(int(place)) for place in tight[np.argsort(play[tight], kind="stable")]]
        if self.measured_extremes.backlash_rad.low.value < -JAM_RAD:
            pairs.insert(0, self.measured_extremes.tightest_teeth)
        return list(dict.fromkeys(pairs))

    @property
    def needed_backlash_mm(self) -> float:
        """Increase of ``backlash_mm`` that the measured pair needs in order to turn; 0 if it turns."""
        return max(0.0, -self.measured_extremes.backlash_rad.low.value * self.lever_mm)


JAM_RAD = 1e-9
"""Overlap in rad that may come from rounding: a tenth of a nanometre at 100 mm."""


def compared_pair(
    drive: Drive, files: Mapping[Gear, MeasuredFile], fit: FittedQuantities, probe_mm: float
) -> ComparedPair:
    """Compare measured gears with the exact gears and run the pair as measured; ``drive`` has one pair of gears.

    Raises WrongInput with a file's name where it does not hold points of its gear in mm, NoSuchMechanism where the
    outlines as measured do not reach each other.
    """
    teeth, pitch = measured_section(drive), drive.pitch
    outlines = {gear: exact_outline(teeth.of(gear)) for gear in Gear}
    gears = tuple(compared_gear(outlines, gear, file, fit, probe_mm) for gear, file in files.items())
    placement, reach = placed(pitch), reach_mm(pitch, teeth)
    exact = {gear: teeth.of(gear).outline_mm for gear in Gear}
    named = {"measured points": {**exact, **{gear.gear: gear.outline_mm for gear in gears}}, "exact outlines": exact}
    both = [Outlines(name, of[Gear.DRIVING], of[Gear.DRIVEN]) for name, of in named.items()]
    contact = [_contact(outline, teeth, placement, reach) for outline in both]
    extremes = [play_extremes(outline, pitch, at, placement, reach) for outline, at in zip(both, contact, strict=True)]
    lever_mm = idle_arms_mm(pitch, drive.rack)[0].value
    return ComparedPair(gears, teeth, placement, contact[0], contact[1], extremes[0], extremes[1], lever_mm)


NEIGHBOURS = 5
"""Number of neighbouring positions from whose middle the play is searched again."""


def _contact(outlines: Outlines, teeth: ToothedPair, placement: Placement, reach: float) -> AsWritten:
    """Contact of outlines that may overlap at the law's angle, as outlines of thick teeth do.

    Play is searched on both sides of an angle.  Where the gears overlap at that angle, a corner that has passed its
    counterpart seems to touch it.  So play is searched a second time, on both sides of the middle of the play that was
    found around each position.  The wider of both is the play: it is free everywhere.
    """
    first = as_written(outlines, teeth, placement, reach)
    if not np.any(first.overlap_mm > 0.0):
        return first
    # By NumPy, since the median filter of SciPy 1.15.0 writes beyond its memory.
    around = np.pad(
        (first.pushing_rad + first.back_rad) / 2.0, NEIGHBOURS // 2, mode="edge" if placement.toothed else "wrap"
    )
    middle = np.median(np.lib.stride_tricks.sliding_window_view(around, NEIGHBOURS), axis=1)
    again = as_written(outlines, teeth, replace(placement, phi2_rad=placement.phi2_rad + middle), reach)
    wider = again.backlash_rad > first.backlash_rad
    return replace(
        first,
        pushing_rad=np.where(wider, again.pushing_rad + middle, first.pushing_rad),
        back_rad=np.where(wider, again.back_rad + middle, first.back_rad),
    )


def compared_gear(
    outlines: Mapping[Gear, ExactOutline], gear: Gear, file: MeasuredFile, fit: FittedQuantities, probe_mm: float
) -> ComparedGear:
    """Compare one measured gear with its exact outline; raises as ``compared_pair`` does."""
    outline, points = outlines[gear], as_complex(file.points_mm)
    module = outline.gear.flanks.rack.module_mm
    try:
        found = best_fit(outline, points, probe_mm, rigid=fit is FittedQuantities.RIGID)
    except DesignError as error:
        error.location = error.location or file.file
        if reading := _other_reading(outlines, gear, points, probe_mm):
            raise WrongInput(f"the points do not fit the {gear.value} gear: {reading}", location=file.file) from error
        raise
    away = found.rms_mm / module
    astray = 1.0 - np.count_nonzero(np.abs(found.feet.distance_mm) < SUSPECT_IN_MODULES * module) / points.size
    if (away > SUSPECT_IN_MODULES or astray > 0.5) and (reading := _other_reading(outlines, gear, points, probe_mm)):
        problem = f"the points are {found.rms_mm:.3g} mm off the {gear.value} gear after best fit: {reading}"
        raise WrongInput(problem, location=file.file)
    if away > MOST_IN_MODULES:
        raise WrongInput(
            f"the points are {found.rms_mm:.3g} mm off the {gear.value} gear after best fit (r.m.s.), more than a "
            f"tenth of its module of {module:g} mm; points of this gear, in mm, with its axis at (0, 0) or by --fit "
            "rigid, are right",
            location=file.file,
        )
    try:
        outline_mm = outline_as_measured(outline, found)
    except WrongInput as error:
        error.location = file.file
        raise
    return ComparedGear(gear, file, outline, found, deviations(outline, found), outline_mm)


def _other_reading(
    outlines: Mapping[Gear, ExactOutline], gear: Gear, points: ComplexArray, probe_mm: float
) -> str | None:
    """Another reading that fits the points much better, and its remedy; None where there is none."""
    other = Gear.DRIVEN if gear is Gear.DRIVING else Gear.DRIVING
    own = outlines[gear]
    readings = {
        f"they fit the {other.value} gear; give the file as --{other.value}": (outlines[other], points),
        MIRRORED: (own, -points.conj()),
        "they fit it in inches; give x and y in mm": (own, INCH_MM * points),
    }
    away = nearness_mm(own, points, probe_mm)
    tried = {words: nearness_mm(outline, some, probe_mm) for words, (outline, some) in readings.items()}
    best = min(tried, key=lambda words: tried[words])
    return best if tried[best] < MUCH_NEARER * away else None


def read_files(paths: Mapping[Gear, Path | None]) -> dict[Gear, MeasuredFile]:
    """The measured points of the given files; raises WrongInput where none is given, and as ``read_measured`` does."""
    from ncgear.design.reading.measured_file import read_measured

    files = {gear: read_measured(path) for gear, path in paths.items() if path is not None}
    if not files:
        raise WrongInput("missing; points of one gear or both are needed", key="--driving, --driven")
    return files
