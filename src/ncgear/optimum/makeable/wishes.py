"""What is asked of a makeable law: the goal, the limits that must hold everywhere, and how finely the law may move."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from ncgear.optimum.certified.weighted import Weights
from ncgear.optimum.task import Limits


class Goal(Enum):
    """What is to be least."""

    ACCELERATION = "least_acceleration"
    POWER = "least_power"
    WEIGHTED = "weighted"


class CurvatureWish(Enum):
    """What the curvature of pitch curves is limited for: a radius in mm, or a number of teeth without undercut."""

    LEAST_RADIUS = "least_radius_mm"
    UNDERCUT = "free_of_undercut"


@dataclass(frozen=True)
class TwoStages:
    """The ratio shared over two pairs in series; ``pressure_angle_rad`` bounds the tangent angle of each, None: free.

    It takes the place of the limit of that name on one pair, for no bound follows from it.
    """

    pressure_angle_rad: float | None = None


@dataclass(frozen=True)
class Wishes:
    """A goal and limits; what is None is not limited.

    ``limits`` are those that a certified bound exists for, the others restrict makeable laws only.
    ``curvature_turns`` limits the curvature of both pitch curves, dents as well as bulges, times the length that they
    roll in one cycle: 2 pi on circles; of two stages, that and ``convex`` hold for each.  It stands for
    ``curvature_given`` in the words of ``curvature_wish``.  ``rack_angle_rad`` is what the rack adds to the limited
    angle of the pitch curves.
    """

    limits: Limits
    goal: Goal = Goal.ACCELERATION
    weights: Weights | None = None
    peak_jerk_mm_s3: float | None = None
    driven_speed_rad_s: float | None = None
    convex: bool = True
    curvature_turns: float | None = None
    curvature_wish: CurvatureWish = CurvatureWish.LEAST_RADIUS
    curvature_given: float = 1.0
    rack_angle_rad: float = 0.0
    harmonics: int = 24
    two_stages: TwoStages | None = None

    @property
    def pairs(self) -> int:
        """Pairs of gears between the driving shaft and the crank."""
        return 1 if self.two_stages is None else 2
