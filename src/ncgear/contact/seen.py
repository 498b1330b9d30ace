"""Both gears as the driven gear sees them: itself at rest, the driving gear placed anew in each position."""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.contact.meetings import Meetings
from ncgear.contact.placement import Placement
from ncgear.contact.side_paths import SidePaths
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.plane import as_complex


@dataclass(frozen=True, eq=False)
class SeenGear:
    """One gear's sides and the flank of each meeting; ``moving`` is true of the driving gear."""

    paths: SidePaths
    flank: IndexArray
    placement: Placement
    moving: bool

    @property
    def rootwards_out(self) -> bool:
        """Whether the way from a tooth's tip to its root leads away from the driven axis."""
        return self.moving is not self.placement.driven_inside

    def points(self, points: ComplexArray, position: IndexArray) -> ComplexArray:
        """Points of the gear's own frame as seen at positions; shapes broadcast."""
        return self.placement.driving_points(points, position) if self.moving else points

    def directions(self, vectors: ComplexArray, position: IndexArray) -> ComplexArray:
        """Directions of the gear's own frame as seen at positions; shapes broadcast."""
        return self.placement.driving_directions(vectors, position) if self.moving else vectors

    def curve(self, run: IndexArray, parameter: Array, position: IndexArray) -> tuple[ComplexArray, ComplexArray]:
        """Points of exact curves as seen, and derivatives; ``run`` has shape (n,), the others (n, ...)."""
        point, slope = (as_complex(array) for array in self.paths.curve(run, parameter))
        return self.points(point, position), self.directions(slope, position)


def seen_pair(
    driving: SidePaths, driven: SidePaths, placement: Placement, meetings: Meetings
) -> tuple[SeenGear, SeenGear]:
    """The driving and the driven gear in given meetings."""
    return (
        SeenGear(driving, meetings.driving, placement, moving=True),
        SeenGear(driven, meetings.driven, placement, moving=False),
    )
