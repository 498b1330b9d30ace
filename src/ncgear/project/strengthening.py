"""Whether the teeth of a design hold, and a face width, a module or a material that would make them hold by itself.

Each change is first guessed by how stresses scale (``ncgear.strength.holding``), then computed with the changed design
and made larger until the teeth hold.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, cos, tan
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import ValidationError

from ncgear.errors import DesignError, WrongInput
from ncgear.frozen import dataclass
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import Changes, changed_drive, is_accepted, may_be_helical, with_helix
from ncgear.project.drive import Drive
from ncgear.strength.answer import Strength
from ncgear.strength.holding import (
    NOTHING_MPA,
    Damage,
    Weakest,
    face_width_factor,
    lives_of,
    module_factor,
    weakest_under,
)
from ncgear.strength.materials import ASSUMED

if TYPE_CHECKING:
    from ncgear.drivetrain.jam import Load
    from ncgear.strength.loading import Loading

SERIES_I_MM = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 32.0, 40.0, 50.0)
"""Modules of ISO 54, series I (secondary source)."""

MOST_TEETH = 240
"""Most driving teeth in the search for sizes: strength never needs more."""

CROWNING = "gears.lead.crowning_um"
"""The key of the lead crowning."""

WIDEST_MODULES = 12.0
"""Face width in modules above which straight teeth do not carry over their whole width, because shafts bend and axes
are misaligned: makers of machines keep to 10 or 12."""

STRONGER = ("PETG-print", "PLA-print", "PA66", "POM", "C45", "42CrMo4", "34CrNiMo6", "42CrMo4-nitrided", "18CrNiMo7-6")
"""Materials of the table by their endurance, the weakest first."""

HELIX_DEG = 20.0, 30.0
"""Helix angles that are tried: usual values in machines."""

HELIX_GAIN = 1.4
"""Most safety of helical teeth over that of straight ones: 0.8 to 1.38 of pump-both-ways, pusher and baler-holds."""

TRIALS = 4
"""How often a guess is made larger.  The second guess is mostly right: load factors change little with the size."""


@dataclass(frozen=True, eq=False)
class Rating:
    """The strength of a drive's teeth, the loads behind it, and each gear's weakest tooth for each kind of damage."""

    strength: Strength
    loading: Loading
    weakest: tuple[Weakest, ...]

    @property
    def holds(self) -> bool:
        """Whether no safety is under the wanted safety."""
        return all(weakest.holds for weakest in self.weakest)


def rating_of(drive: Drive, method: Literal["estimate", "elements"] | None = None) -> Rating:
    """The rating of a drive's teeth by a method, or by the method of its design.

    Raises WrongInput, with the missing keys, where strength is not known, and where the teeth carry no load.
    """
    if (why := unknown(drive)) is not None:
        raise why
    method = method or drive.design.strength.method
    strength, loading = drive.strength_by(method), drive.loading_by(method)
    area_mm2 = drive.gears.face_width_mm * drive.pitch.size.module_mm
    if strength.peak_pair_n < NOTHING_MPA * area_mm2:
        raise WrongInput("the teeth carry no load at any angle, so their strength is unknown", key="resistance")
    return Rating(strength, loading, tuple(weakest_under(strength, drive.conditions)))


def known_rating(drive: Drive) -> Rating | DesignError | None:
    """The rating of a drive's teeth by its design's method; None where no load is known or no strength is computed.

    An error, for example about a load that teeth cannot carry at all, is returned as the answer.
    """
    if unknown(drive) is not None:
        return None
    try:
        return rating_of(drive)
    except DesignError as error:
        # Some gears can be made but not rated.
        return error


def unknown(drive: Drive) -> WrongInput | None:
    """Why the strength of a design is not known, before anything is computed; None where it can be computed."""
    design = drive.design
    if design.gears is None:
        return WrongInput("missing; gears need teeth, module_mm, face_width_mm and more", key="gears")
    if not design.loads_teeth:
        return WrongInput("missing; the load of the teeth needs it, or masses", key="resistance")
    if design.stages > 1 and drive.stage is None:
        said, key = design.stages_said
        each = "`ncgear strength` rates each, and `ncgear sweep --stage strength` tries other sizes"
        return WrongInput(f"{said}, each with a strength of its own; one pair is right here: {each}", key=key)
    return None


def crowned_enough(drive: Drive, rating: Rating) -> Changes:
    """The best lead crowning in whole um, if teeth hold with it; else, or where it is not known, empty."""
    best_um = drive.best_crowning_um_by(rating.strength.method)
    if best_um is None or best_um == drive.gears.lead.crowning_um:
        return {}
    changes: Changes = {CROWNING: best_um}
    return changes if _holds(drive, rating, changes) else {}


def wide_enough(drive: Drive, rating: Rating) -> Changes:
    """The face width in whole mm with which the teeth hold; empty where it is over WIDEST_MODULES."""
    most = WIDEST_MODULES * drive.pitch.size.module_mm

    def changes(width_mm: float) -> Changes | None:
        return {"gears.face_width_mm": float(ceil(width_mm))} if ceil(width_mm) <= most else None

    return _enough(drive, rating, drive.gears.face_width_mm, face_width_factor, changes)


def large_enough(drive: Drive, rating: Rating) -> Changes:
    """The module of series I with which the same number of teeth and face width hold; empty where there is none."""
    teeth = drive.whole.by_stage[0].pitch.size.driving_teeth

    def changes(module_mm: float) -> Changes | None:
        module = next((module for module in SERIES_I_MM if module >= module_mm), None)
        return None if module is None else sized(drive, teeth, module)

    return _enough(drive, rating, drive.pitch.size.module_mm, module_factor, changes)


def helical_enough(drive: Drive, rating: Rating) -> Changes:
    """The first of HELIX_DEG with which the teeth hold; empty where none does, or where teeth stay straight.

    Teeth are helical, or herringbone ones where bearings are given, which were chosen without thrust.
    """
    if not may_be_helical(drive) or HELIX_GAIN * min(weakest.share for weakest in rating.weakest) < 1.0:
        return {}
    kind = "helical" if drive.design.drivetrain is None else "herringbone"
    tried = (with_helix(angle, kind) for angle in HELIX_DEG)
    return next((changes for changes in tried if _holds(drive, rating, changes)), {})


def largest_thrust_n(drive: Drive, rating: Rating, helix_rad: float) -> float:
    """The thrust of helical teeth along their axes in N under the largest load of a rating: F_t tan(beta).

    F_t is the load's tangential part at the pitch point, by the pressure angle of the flanks that push.
    """
    contacts = rating.strength.contacts
    most_n = float(np.bincount(contacts.position, contacts.force_n).max())
    return most_n * cos(drive.rack.angles_rad[0]) * tan(helix_rad)


def strong_enough(drive: Drive, rating: Rating) -> Changes:
    """The weakest material of STRONGER with which both gears hold; empty where none does.

    A material that holds is assumed to be no worse than every weaker material, so that few are computed.
    """
    given = drive.gears.material
    names = [ASSUMED] if given is None else [material.name for material in given.each]
    above = max((STRONGER.index(name) + 1 for name in names if name in STRONGER), default=0)
    low, high, found = above, len(STRONGER), Changes()
    while low < high:
        # The strongest material first: mostly it holds, or none holds.
        middle = high - 1 if high == len(STRONGER) and not found else (low + high) // 2
        tried: Changes = {"gears.material": STRONGER[middle]}
        if _holds(drive, rating, tried):
            high, found = middle, tried
        elif found:
            low = middle + 1
        else:
            return {}
    return found


def _holds(drive: Drive, rating: Rating, changes: Changes) -> bool:
    if not is_accepted(drive.design, changes):
        return False
    try:
        return rating_of(changed_drive(drive, changes), rating.strength.method).holds
    except (DesignError, ValidationError):
        return False


def sized(drive: Drive, teeth: int, module_mm: float) -> Changes:
    """The changes that give a design a number of driving teeth and a module.

    Left out are a centre distance, pins that measure another module, and shifts of each of other teeth.
    """
    gears, size = drive.gears, drive.pitch.size
    left_out = {
        "gears.center_distance_mm": gears.center_distance_mm is not None,
        "gears.measuring_pin_mm": gears.measuring_pin_mm is not None and module_mm != size.module_mm,
        "gears.profile_shift.per_tooth": gears.profile_shift.per_tooth is not None and teeth != size.driving_teeth,
    }
    return {"gears.teeth": teeth, "gears.module_mm": module_mm, **{key: None for key, out in left_out.items() if out}}


def _enough(
    drive: Drive,
    rating: Rating,
    size_mm: float,
    factor: Callable[[tuple[Weakest, ...]], float],
    changes: Callable[[float], Changes | None],
) -> Changes:
    """The changes for the least size that holds, found by computing; empty where a size is not allowed or refused."""
    found = rating
    for _ in range(TRIALS):
        size_mm *= factor(found.weakest)
        tried = changes(size_mm)
        if tried is None or not is_accepted(drive.design, tried):
            return {}
        try:
            found = rating_of(changed_drive(drive, tried), rating.strength.method)
        except (DesignError, ValidationError):
            # Larger teeth may be refused, and a hub may be too short for a wider gear.
            return {}
        if found.holds:
            return tried
    return {}


def deciding_loads(drive: Drive, rating: Rating) -> dict[tuple[Gear, Damage], Load]:
    """The deciding load of the weakest tooth of each gear, by damage: the law, knocks, swings or a jam."""
    from ncgear.drivetrain.jam import Load, deciding

    judged, found = drive.judged_teeth(rating.strength.method), dict[tuple[Gear, Damage], Load]()
    for weakest in rating.weakest:
        jammed = None if judged.jammed is None else lives_of(judged.jammed, weakest.gear)[weakest.damage]
        borne, here = rating.loading.borne, np.array([weakest.phi1_rad])
        if jammed is not None and jammed.safety[weakest.tooth - 1] == weakest.safety:
            found[weakest.gear, weakest.damage] = "jam"
        elif borne is None:
            found[weakest.gear, weakest.damage] = "law"
        else:
            followed: Load = "knocks" if borne.knocks else "swings"
            torques: dict[Load, float] = {"law": abs(borne.asked(here)[0]), followed: abs(borne.at(here)[0])}
            found[weakest.gear, weakest.damage] = deciding(torques)
    return found
