"""From keys to values: how many assemblies of a pair jam, and how much backlash is enough."""

from __future__ import annotations

from functools import lru_cache
from math import sqrt

from ncgear.design.keys.tolerances import AssemblyTolerances
from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.numerics.bounds import rounded_up, shown_above, shown_below
from ncgear.project.alternatives import Changes, changed_drive
from ncgear.project.drive import Drive
from ncgear.project.tolerance_limits import (
    MOST_JAMMED,
    TURNING,
    Process,
    backlash_key,
    left_of_backlash,
    limits_of,
    tolerances_of,
)
from ncgear.tolerances.estimate import EstimatedBacklash, Teeth, enough, needed, plays_of

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
    own, low, high = drive.gears.face_width_mm, LEAST_FACE, 1.0
    most = max(given, MOST_BACKLASH * drive.pitch.size.module_mm)
    if drive.helix is not None or key != "backlash_mm":
        return {}

    def enough_for(width_mm: float) -> float:
        narrower = changed_drive(drive.whole, {"gears.face_width_mm": width_mm})
        return _made_up(SURELY * enough(backlash_needed(narrower), TURNING))

    if enough_for(low * own) > most:
        return {}
    while high > NEAR * low:
        middle = sqrt(low * high)
        low, high = (middle, high) if enough_for(middle * own) <= most else (low, middle)
    width = float(shown_below(low * own, 3))
    changes: Changes = {"gears.face_width_mm": width}
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
