"""Whether the point that a stage works at is the knee of its curve, and what the points beside it would cost."""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.precision.study import Measured, Method, Point

NEARLY_LEAST = 10.0
"""An error within so much of the least that any method reaches is as good: one digit of rounding."""

SAME_TIME = 1.5
"""Times that differ by less count as equal: the least of repeated runs scatters by so much on a machine at work."""

Found = tuple[Method, Point]


@dataclass(frozen=True)
class Knee:
    """The chosen point among all.

    ``error`` is the largest that counts as enough, ``quickest`` the quickest point that keeps it; ``cheaper`` and
    ``dearer`` are the chosen point's neighbours among those that no other beats in both time and error.
    """

    chosen: Found
    error: float
    quickest: Found
    cheaper: Found | None
    dearer: Found | None

    @property
    def slowness(self) -> float:
        """Time of the chosen point as a multiple of the quickest one's."""
        return self.chosen[1].seconds / self.quickest[1].seconds

    @property
    def is_chosen(self) -> bool:
        """Whether the chosen point keeps the error, and no point that keeps it is clearly quicker."""
        return self.chosen[1].error <= self.error and self.slowness <= SAME_TIME


def knee(found: Measured, unaided: bool = False) -> Knee:
    """The knee of a study: the quickest point whose error is enough, or nearly the least where none is so exact.

    ``unaided``: among methods that find by themselves how fine they must be.  The points of the others are chosen with
    the exact result at hand, which no program has.
    """
    points = tuple(one for one in found.of_all if one[0].unaided or not unaided)
    least = min(point.error for _, point in points)
    error = found.study.enough if least <= found.study.enough else NEARLY_LEAST * least
    quickest = min((one for one in points if one[1].error <= error), key=_seconds)
    front, chosen = _front(points), found.chosen
    cheaper = [one for one in front if _seconds(one) < _seconds(chosen) and one[1].error > chosen[1].error]
    dearer = [one for one in front if _seconds(one) > _seconds(chosen) and one[1].error < chosen[1].error]
    neighbours = max(cheaper, key=_seconds, default=None), min(dearer, key=_seconds, default=None)
    return Knee(chosen, error, quickest, *neighbours)


def _front(points: tuple[Found, ...]) -> list[Found]:
    """Points that no other beats in both, from quick to slow."""
    front: list[Found] = []
    for one in sorted(points, key=_seconds):
        if not front or one[1].error < front[-1][1].error:
            front.append(one)
    return front


def _seconds(one: Found) -> float:
    return one[1].seconds
