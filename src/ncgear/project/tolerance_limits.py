"""From keys to values: the limits of a pair's deviations, the backlash left in its assemblies, and how many jam.

The usual deviations of each process are taken where a design gives no tolerances.

Sources, all for ordinary care, not for the best work of a process:

- hobbed or shaped: class 8 of ISO 1328-1, which these leave without finishing (classes 7 to 9 in gear handbooks, from
secondary sources); - wire-cut: class 7.  Small brass gears came to DIN 5 in experiments (K. Gupta, N. K. Jain,
Manufacturing of high quality miniature gears by wire electric discharge machining, DAAAM International Scientific Book
2013, chapter 40); two classes coarser are taken for work without such care.  Bore and teeth are cut in one set-up; -
printed: service providers promise 0.2 mm either way for a whole part of calibrated machines that lay filament.  A
quarter of it is taken for a flank against its neighbour, since all flanks swell alike, and for the bore.  No gears were
measured for this: it is a rough guess.

Centre distance and keyways are for housings and shafts that are milled, or printed with the gears.
"""

from __future__ import annotations

from enum import StrEnum
from functools import lru_cache
from math import cos, degrees, radians, sqrt

import numpy as np

from ncgear.design.keys.gears import Gears
from ncgear.design.keys.tolerances import AssemblyTolerances, GearTolerances
from ncgear.errors import DesignError, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.bounds import rounded_up, shown_above, shown_below
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import Changes, changed_drive, widths_mm, with_width
from ncgear.project.drive import Drive
from ncgear.project.service import choices_of
from ncgear.project.tooth_form import thickness_limits_mm
from ncgear.teeth.backlash import idle_arms_mm
from ncgear.teeth.gear import ToothedGear
from ncgear.tolerances.drawn import DeviationLimits
from ncgear.tolerances.estimate import EstimatedBacklash, Teeth, enough, needed, plays_of
from ncgear.tolerances.iso286 import distance_deviation_mm
from ncgear.tolerances.iso1328 import DIAMETERS_MM, MODULES_MM, TEETH, flank_tolerances, tooth_diameters_mm

TURNING = 0.999
"""Share of the assemblies that must turn."""

MOST_JAMMED = 0.01
"""Share of the assemblies that may jam without a warning: such an assembly gets other gears."""


def limits_of(drive: Drive, given: AssemblyTolerances) -> DeviationLimits:
    """The limits in mm and rad; raises WrongInput where a grade does not hold for the gears."""
    # The grades of helical teeth are for the normal module.
    module = drive.pitch.size.module_mm * cos(drive.helix.angle_rad if drive.helix else 0.0)
    each = given.driving, given.driven
    pitch, profile = [], []
    for gear, own in zip(Gear, each, strict=True):
        one, other = _of_teeth(drive.teeth.of(gear), own, given.grade, module, f"tolerances.{gear.name.lower()}")
        pitch.append(one)
        profile.append(other)
    warm = given.temperature
    range_c = (warm.least_c, warm.largest_c) if warm else (20.0, 20.0)
    driving, driven = (choice.entry.elastic.expansion_per_k for choice in choices_of(drive.gears))
    return DeviationLimits(
        center_distance_mm=given.center_distance_mm,
        eccentricity_mm=(given.driving.eccentricity_mm, given.driven.eccentricity_mm),
        tilt_rad=(radians(given.driving.tilt_deg), radians(given.driven.tilt_deg)),
        index_rad=(radians(given.driving.index_deg), radians(given.driven.index_deg)),
        pitch_mm=np.concatenate(pitch),
        profile_mm=np.concatenate(profile),
        temperature_c=range_c,
        warmer_k=warm.warmer_k if warm else 0.0,
        expansions=(driving, driven, 1e-6 * given.housing_expansion_um_m_k),
        wear_mm=(given.driving.wear_mm, given.driven.wear_mm),
    )


def _of_teeth(
    gear: ToothedGear, own: GearTolerances, grade: int | None, module_mm: float, key: str
) -> tuple[Array, Array]:
    """Single pitch and total profile deviation of each flank of a gear, from its grade or as given."""
    grade = own.grade or grade
    told = own.single_pitch_mm is not None and own.profile_mm is not None
    pitch = profile = np.zeros(gear.flanks.count)
    if grade is not None and not told:
        _require_graded(gear, module_mm, f"{key}.grade" if own.grade else "tolerances.grade")
        limits = flank_tolerances(grade, tooth_diameters_mm(gear), module_mm)
        pitch, profile = limits.single_pitch_mm, limits.total_profile_mm
    if own.single_pitch_mm is not None:
        pitch = np.full(gear.flanks.count, own.single_pitch_mm)
    if own.profile_mm is not None:
        profile = np.full(gear.flanks.count, own.profile_mm)
    return pitch, profile


def _require_graded(gear: ToothedGear, module_mm: float, key: str) -> None:
    largest = 2.0 * float(np.linalg.norm(gear.outline_mm, axis=1).max())
    for name, value, (least, most) in (
        ("the module in mm is", module_mm, MODULES_MM),
        ("the teeth are", gear.teeth, TEETH),
        ("the diameter in mm is", largest, DIAMETERS_MM),
    ):
        if not least <= value <= most:
            raise WrongInput(
                f"{name} {value:g}, but ISO 1328-1 has grades from {least:g} to {most:g} only; give "
                "single_pitch_mm and profile_mm under tolerances.driving and tolerances.driven in place of a grade",
                key=key,
            )


def backlash_key(gears: Gears) -> str:
    """The key under ``gears`` by which a design gives its backlash."""
    return "backlash_mm" if gears.backlash_deg is None else "backlash_deg"


def left_of_backlash(pair: Drive, least_play_rad: Array) -> Array:
    """The backlash left in assemblies with given least plays if the backlash were 0, in the unit of its key.

    The plays are for teeth in the middle of their thickness, the result is for the thickest teeth that the file allows.
    Along the normal they are measured where its arm is least, like the key.  Gears of a row have as much play along the
    normal everywhere, so that they turn least where its arm is greatest: the result is then too little, if anything.
    """
    least_arm_mm = idle_arms_mm(pair.pitch, pair.rack)[0].value
    unit = degrees(1.0) if pair.gears.backlash_deg is not None else least_arm_mm
    lower, upper = thickness_limits_mm(pair.gears) or (0.0, 0.0)
    thicker_rad = (upper - lower) * cos(pair.rack.angles_rad[1]) / least_arm_mm
    given_rad = pair.play.driven_rad
    if pair.gears.idlers is not None:
        given_rad, thicker_rad = pair.play.least_normal_mm.value / least_arm_mm, 0.0
    return np.asarray(unit * (least_play_rad - given_rad - thicker_rad))


class Process(StrEnum):
    """The process that makes gears, in words that stand before "gears"."""

    GENERATED = "hobbed or shaped"
    CUT = "wire-cut"
    PRINTED = "printed"


_GENERATED = GearTolerances(eccentricity_mm=0.02, tilt_deg=0.02, index_deg=0.1)
_CUT = GearTolerances(eccentricity_mm=0.01, tilt_deg=0.02, index_deg=0.1)
_PRINTED = GearTolerances(single_pitch_mm=0.05, profile_mm=0.05, eccentricity_mm=0.05, tilt_deg=0.1, index_deg=0.5)

USUAL = {
    Process.GENERATED: AssemblyTolerances(grade=8, center_distance_mm=0.03, driving=_GENERATED, driven=_GENERATED),
    Process.CUT: AssemblyTolerances(grade=7, center_distance_mm=0.03, driving=_CUT, driven=_CUT),
    Process.PRINTED: AssemblyTolerances(center_distance_mm=0.1, driving=_PRINTED, driven=_PRINTED),
}
"""The tolerances of each process."""


def process_of(drive: Drive) -> Process:
    """The process given in the file by a printed material, or by keys for prints, for kerfs or for a cutter.

    Without such keys: hobbed or shaped, if a hob can cut every gear, else wire-cut.
    """
    gears = drive.gears
    materials = () if gears.material is None else [choice.name for choice in gears.material.each]
    printed = any(name.endswith("-print") for name in materials)
    if printed or gears.process_clearance_mm > 0.0 or gears.first_layer_chamfer_mm > 0.0:
        return Process.PRINTED
    if gears.cutter.kind in ("rack", "pinion"):
        return Process.GENERATED
    if gears.process_clearance_mm < 0.0 or gears.cutter.kind == "mate":
        return Process.CUT
    hobbed = all(
        not pair.pitch.driven.is_ring and all(pair.pitch.least_concave_radius_mm(gear) is None for gear in Gear)
        for pair in drive.whole.by_stage
    )
    return Process.GENERATED if hobbed else Process.CUT


def tolerances_of(drive: Drive) -> tuple[AssemblyTolerances, Process | None]:
    """The tolerances of the assemblies of a design: as given, or as usual for its process, then returned.

    Housings are made to the drawing.  So a deviation of the centre distance on the drawing comes before both, and where
    the drawing has JS7 by default, the usual deviation is no smaller.
    """
    drawn_mm, given = drive.gears.tolerances.center_distance_mm, drive.design.tolerances
    process = process_of(drive) if given is None else None
    apart_mm = [pair.pitch.center_distance_mm for pair in drive.whole.by_stage]
    taken = given if process is None else _usual(process, min(apart_mm))
    assert taken is not None
    if drawn_mm is None and (process is not None or "center_distance_mm" not in taken.model_fields_set):
        drawn_mm = max(taken.center_distance_mm, *(distance_deviation_mm(distance) or 0.0 for distance in apart_mm))
    return taken if drawn_mm is None else taken.model_copy(update={"center_distance_mm": drawn_mm}), process


SMALLEST_MM = 10.0
"""Centre distance above which the usual tolerances of the table hold.  Smaller gears that are cut have tolerances
smaller in proportion, as watchmakers need them.  A printer does not become finer."""


def _usual(process: Process, distance_mm: float) -> AssemblyTolerances:
    """The tolerances of a process for gears at a centre distance in mm."""
    taken, share = USUAL[process], distance_mm / SMALLEST_MM
    if process is Process.PRINTED or share >= 1.0:
        return taken
    gears = {
        gear.value: (one := getattr(taken, gear.value)).model_copy(
            update={"eccentricity_mm": share * one.eccentricity_mm}
        )
        for gear in Gear
    }
    return taken.model_copy(update={"center_distance_mm": share * taken.center_distance_mm, **gears})


MOST_BACKLASH = 0.25
"""Backlash in modules above which teeth are thinner than in any standard of backlash."""

LEAST_FACE, NEAR = 1e-3, 1.005
"""Least share of a face width in the search for a narrower face, and the factor to which it is found."""

SURELY = 1.1
"""Factor on the backlash that the estimate finds enough.  The estimate is off by a tenth at most
(tests/test_jamming.py), and the told backlash must be enough for the assemblies of ncgear tolerance."""

STEP = 0.005
"""Step to which the needed backlash in mm or degrees is rounded up; a smaller one is rounded up to two digits.  Nobody
makes teeth of usual size to finer steps."""


@dataclass(frozen=True)
class Jamming:
    """The estimated need of assemblies for backlash, and the backlash of their design.

    ``share`` is the share of jamming assemblies of one pair.  ``key`` of the design file gives the backlash, ``given``
    is its value, and with ``enough`` 99.9 % of all machines turn.  ``fits`` is false where this backlash leaves no
    teeth.  Where a usual backlash is not enough, ``narrower`` changes the face to the widest for which it is enough;
    otherwise, and where no face helps, it is empty.  ``process`` is the process with the assumed usual tolerances; None
    where the file gives ``tolerances``.
    """

    share: float
    key: str
    given: float
    enough: float
    fits: bool
    narrower: Changes
    tolerances: AssemblyTolerances
    process: Process | None


def jamming_of(drive: Drive) -> Jamming:
    """The estimate for one pair of gears; raises WrongInput where a grade does not hold for the gears.

    One key gives the backlash of two pairs in series, so ``enough`` is enough for both.
    """
    tolerances, process = tolerances_of(drive)
    of_pairs = backlash_needed(drive.whole)
    key = backlash_key(drive.gears)
    given = float(getattr(drive.gears, key))
    value = _made_up(SURELY * enough(of_pairs, TURNING))
    share = of_pairs[(drive.stage or 1) - 1].jammed(given)
    usual = value <= MOST_BACKLASH * drive.pitch.size.module_mm
    return Jamming(
        share=share,
        key=f"gears.{key}",
        given=given,
        enough=value,
        fits=given >= value or _leaves_teeth(drive.whole, {f"gears.{key}": value}),
        narrower={} if share <= MOST_JAMMED or usual else _narrower(drive, key, given),
        tolerances=tolerances,
        process=process,
    )


def _made_up(backlash: float) -> float:
    return float(shown_above(backlash, 2)) if 0.0 < backlash < STEP else rounded_up(backlash, STEP)


def _narrower(drive: Drive, key: str, given: float) -> Changes:
    """The widest face, to three digits, for which a usual backlash is enough, and that backlash; empty if none is.

    Wider tilted teeth need more backlash; helical teeth need their width to keep contact.
    """
    design, own, high = drive.design, drive.gears.face_width_mm, 1.0
    # Three digits may be less by a hundredth.
    low = max(LEAST_FACE, NEAR**3 * widths_mm(design)[0] / own)
    most = max(given, MOST_BACKLASH * drive.pitch.size.module_mm)
    if drive.helix is not None or key != "backlash_mm":
        return {}

    def enough_for(width_mm: float) -> float:
        narrower = changed_drive(drive.whole, with_width(design, width_mm))
        return _made_up(SURELY * enough(backlash_needed(narrower), TURNING))

    if low >= high or enough_for(low * own) > most:
        return {}
    while high > NEAR * low:
        middle = sqrt(low * high)
        low, high = (middle, high) if enough_for(middle * own) <= most else (low, middle)
    width = float(shown_below(low * own, 3))
    changes = with_width(design, width)
    if (value := enough_for(width)) > given:
        changes[f"gears.{key}"] = value
    return changes


@lru_cache(maxsize=1)
def backlash_needed(drive: Drive) -> tuple[EstimatedBacklash, ...]:
    """The backlash that assemblies of each pair need, in the unit of its key; raises as ``jamming_of``.

    The result of the last machine is kept, since each of its pairs asks for it.
    """
    tolerances, _ = tolerances_of(drive)
    return tuple(_needed(pair, tolerances, seed) for seed, pair in enumerate(drive.by_stage))


def _needed(pair: Drive, tolerances: AssemblyTolerances, seed: int) -> EstimatedBacklash:
    teeth = Teeth(
        pair.teeth,
        pair.designed_contact,
        limits_of(pair, tolerances),
        pair.gears.face_width_mm,
        pair.overlap_ratio,
        pair.gears.drives == "both_ways",
    )
    plays = plays_of(teeth, seed)
    return needed(-left_of_backlash(pair, plays.least_rad), plays.shared)


def _leaves_teeth(whole: Drive, changes: Changes) -> bool:
    """Whether all pairs have teeth with another backlash: they are made."""
    try:
        for pair in changed_drive(whole, changes).by_stage:
            _ = pair.teeth
    except DesignError:
        return False
    return True
