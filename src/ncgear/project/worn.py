"""A pair of gears as it wears: its play, knocks, forces and safeties over the wanted life.

The play grows everywhere by the largest growth along the normal of ``ncgear.strength.surfaces``, and comes off the idle
flanks: pushing flanks keep their form.  Until the next time the gears wear by the loads that they have with the play of
the last, knocks included, so that harder knocks wear them faster.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees

import numpy as np
from pydantic import ValidationError

from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import sample_angles
from ncgear.project.alternatives import changed_drive
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Rating, rating_of
from ncgear.project.tolerance_limits import backlash_key
from ncgear.teeth.backlash import idle_arms_mm

SHARES = 0.25, 0.5, 1.0
"""Parts of the wanted life after which worn gears are rated."""


@dataclass(frozen=True, eq=False)
class Worn:
    """Gears after some hours: the deepest wear and the backlash along the normal in mm, and their rating.

    ``free`` is the way that the play leaves the output where it moves fastest, in mm or, of a turning output, rad; 0
    where the gears turn nothing.
    The rating is None where no teeth are left that turn; ``why`` then says so.
    """

    hours: float
    depth_mm: float
    backlash_mm: float
    free: float = 0.0
    rating: Rating | None = None
    why: str = ""


def worn_over_life(drive: Drive, rating: Rating) -> Iterator[Worn]:
    """The pair of a drive after SHARES of its wanted life; it ends where no teeth are left, and is empty without wear.

    ``rating`` is the rating of the new pair.
    """
    key, arm_mm = backlash_key(drive.gears), idle_arms_mm(drive.pitch, drive.rack)[0].value
    given, unit = float(getattr(drive.gears, key)), 1.0 if key == "backlash_mm" else degrees(1.0 / arm_mm)
    pair, before, depth_mm, added_mm = drive, 0.0, 0.0, 0.0
    for share in SHARES:
        wear = pair.surfaces_by(rating.strength.method).wear
        depth_mm += (share - before) * wear.deepest_mm
        added_mm += (share - before) * wear.play_mm
        if not added_mm:
            return
        worn, before = (share * wear.wanted_h, depth_mm, given / unit + added_mm), share
        try:
            pair = changed_drive(drive, {f"gears.{key}": given + unit * added_mm})
            found = rating_of(pair, rating.strength.method)
        except ValidationError:
            yield Worn(*worn, why="the play is larger than any gears have")
            return
        except DesignError as error:
            yield Worn(*worn, why=error.problem)
            return
        yield Worn(*worn, _free(pair), found)


def _free(pair: Drive) -> float:
    """The way of the output for the play of the driven gear, where it moves most by the angle of that gear."""
    own, angle = pair.pair, sample_angles(pair.pair.transmission)
    turned = own.transmission.driven_angle(angle, 1).derivative(1) * own.speed(angle)
    way = pair.machine.displacement(own.shaft_rad(angle), 1).derivative(1) / turned
    return pair.play.driven_rad * float(np.abs(way).max())
