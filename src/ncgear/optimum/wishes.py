"""What is asked of a law: the goal, the limits that must hold everywhere, and how finely the law may move."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Goal(Enum):
    """What is to be least."""

    ACCELERATION = "least_acceleration"
    POWER = "least_power"
    WEIGHTED = "weighted"


@dataclass(frozen=True)
class Weights:
    """The weighted goal: acceleration over ``acceleration_mm_s2`` plus power over ``power_w``."""

    acceleration_mm_s2: float
    power_w: float


@dataclass(frozen=True)
class Wishes:
    """A goal and limits; what is None is not limited.

    ``tangent_rad`` limits the angle between the pitch curves' tangent and the normal to the centre line, which is the
    pressure angle less the rack's.  ``curvature_turns`` limits the curvature of both pitch curves, taken positive on
    bulges and on dents, times the length of the driving curve: 2 pi on a circle.  ``working_rad`` is the driving angle
    of the working stroke.  ``mass_kg`` moves with the slider.
    """

    goal: Goal = Goal.ACCELERATION
    weights: Weights | None = None
    peak_power_w: float | None = None
    peak_acceleration_mm_s2: float | None = None
    peak_jerk_mm_s3: float | None = None
    driven_speed_rad_s: float | None = None
    ratio_min: float = 0.2
    ratio_max: float = 5.0
    tangent_rad: float | None = None
    convex: bool = True
    curvature_turns: float | None = None
    working_rad: float | None = None
    mass_kg: float = 0.0
    harmonics: int = 24
