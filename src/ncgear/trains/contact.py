"""Contact of the parts of a train: teeth in mesh must touch and not overlap, all other parts must stay apart.

The judge compares polygons, the outlines as written in the files, at the poses of the train; it does not know how teeth
were made.  Penetration is the depth of a corner of one outline in the other part; the gap is the least distance of the
two outlines at a position.  Both are taken at evenly spaced driving angles, and the worst places are then searched.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, Mask
from ncgear.numerics.highest import golden_section
from ncgear.numerics.plane import as_complex, as_points
from ncgear.pitch.shape import Mesh
from ncgear.trains.train import Part, Train

if TYPE_CHECKING:
    from shapely import Polygon

POSITIONS = 241
"""Driving angles of a cycle at which a mesh is judged: a prime, so that few tooth passages are struck at one phase."""

FEW_MESHES, LEAST_POSITIONS = 4, 61
"""With more than FEW_MESHES, which are alike at other phases, each is judged at fewer positions, down to this prime."""

SEARCHED = 3
"""Number of worst positions around which the extreme is searched."""

NARROWED = 8e-3
"""Final width of the search for an extreme, as a share of the step between positions."""


@dataclass(frozen=True)
class MeshContact:
    """How two parts in mesh meet over a cycle: greatest penetration (or 0) and gap in mm, with driving angles."""

    first: str
    second: str
    penetration_max_mm: float
    penetration_max_at_rad: float
    gap_max_mm: float
    gap_max_at_rad: float

    def clashes(self, allowed_mm: float) -> bool:
        """Whether the teeth overlap by more than is allowed."""
        return self.penetration_max_mm > allowed_mm

    def parts(self, allowed_mm: float) -> bool:
        """Whether the teeth come apart by more than is allowed."""
        return self.gap_max_mm > allowed_mm


@dataclass(frozen=True)
class Distance:
    """The least distance in mm of two parts not in mesh, negative where they overlap, and its driving angle."""

    first: str
    second: str
    least_distance_mm: float
    at_rad: float


def contacts_of(train: Train, outlines_mm: Mapping[str, Array]) -> list[MeshContact]:
    """How all meshes of a train meet, by outlines of its parts in mm, shape (n, 2), as they were written."""
    return [_contact(train, mesh.first, mesh.second, mesh.kind, outlines_mm) for mesh in train.meshes]


def _contact(train: Train, first: str, second: str, kind: Mesh, outlines_mm: Mapping[str, Array]) -> MeshContact:
    meeting = _Meeting(outlines_mm[first], outlines_mm[second], ring=kind is Mesh.INTERNAL)
    relative = _relative(train, first, second)
    angles = _angles(train)
    places = [*zip(*relative(angles), strict=True)]
    ends = []
    for measure in (meeting.depth_mm, meeting.gap_mm):

        def value(angle: float, measure: Callable[[complex, complex], float] = measure) -> float:
            (place,), (turn,) = relative(np.array([angle]))
            return measure(place, turn)

        ends.append(_greatest(value, angles, np.array([measure(*pose) for pose in places])))
    (deepest, deepest_at), (gap, gap_at) = ends
    return MeshContact(first, second, deepest, deepest_at, gap, gap_at)


def _angles(train: Train) -> Array:
    count = max(LEAST_POSITIONS, POSITIONS * FEW_MESHES // max(len(train.meshes), FEW_MESHES))
    return np.linspace(0.0, train.cycle_rad / train.repeats, count, endpoint=False)


def _greatest(value: Callable[[float], float], angles: Array, found: Array) -> tuple[float, float]:
    """The greatest value and its driving angle: the worst positions are searched by golden sections."""
    best, at = float(found.max()), float(angles[np.argmax(found)])
    step = float(angles[1] - angles[0])
    for number in np.argsort(found)[::-1][:SEARCHED]:
        middle = float(angles[number])
        near = golden_section(lambda angle: -value(angle), middle - step, middle + step, NARROWED * step)
        least = min(near, key=lambda extremum: extremum.value)
        if -least.value > best:
            best, at = -least.value, least.at
    return best, at


def _relative(train: Train, first: str, second: str) -> Callable[[Array], tuple[ComplexArray, ComplexArray]]:
    """Place and turn of the second part in the frame of the first, as complex numbers at driving angles."""
    numbers = train.number(first), train.number(second)

    def at(driving_rad: Array) -> tuple[ComplexArray, ComplexArray]:
        poses = train.poses_at(driving_rad)
        (axis, turn), (other_axis, other_turn) = (poses.places(number) for number in numbers)
        return (other_axis - axis) / turn, other_turn / turn

    return at


class _Meeting:
    """Two outlines; only their points near both parts are examined."""

    def __init__(self, first_mm: Array, second_mm: Array, *, ring: bool) -> None:
        import shapely

        self._first, self._second = map(as_complex, (first_mm, second_mm))
        self._reach = float(np.abs(self._first).max()), float(np.abs(self._second).max())
        self._inner = float(np.abs(self._second).min())
        self._ring = ring
        self._areas: tuple[Polygon, Polygon] = shapely.Polygon(first_mm), shapely.Polygon(second_mm)
        for area in self._areas:
            shapely.prepare(area)

    def depth_mm(self, place: complex, turn: complex) -> float:
        """Penetration where the second part's axis and turn are these in the frame of the first."""
        import shapely

        second, near, inside_own = self._near(place, turn)
        back = (self._first[inside_own] - place) / turn
        of_second = shapely.contains_xy(self._areas[0], second[near].real, second[near].imag)
        of_first = shapely.contains_xy(self._areas[1], back.real, back.imag)
        if self._ring:
            # The ring's material is outside its outline.
            of_first = ~of_first
        deep = [
            float(shapely.distance(shapely.points(points[within].real, points[within].imag), _lines(*other)).max())
            for points, within, other in (
                (second[near], of_second, (self._first, inside_own)),
                (self._first[inside_own], of_first, (second, near)),
            )
            if within.any() and near.any() and inside_own.any()
        ]
        return max(deep, default=0.0)

    def gap_mm(self, place: complex, turn: complex) -> float:
        """The gap there."""
        import shapely

        second, near, inside_own = self._near(place, turn)
        if not near.any() or not inside_own.any():
            return float(np.abs(self._first[:, None] - second[None, :]).min())
        return float(shapely.distance(_lines(self._first, inside_own), _lines(second, near)))

    def _near(self, place: complex, turn: complex) -> tuple[ComplexArray, Mask, Mask]:
        """The second outline there, and which points of it and of the first are near both parts."""
        second = place + self._second * turn
        near, away = np.abs(second) <= self._reach[0] + NEAR_MM, np.abs(self._first - place)
        inside_own = away >= self._inner - NEAR_MM if self._ring else away <= self._reach[1] + NEAR_MM
        return second, near, inside_own


NEAR_MM = 1e-6
"""Margin beyond both reaches, so that rounding does not lose a tip that just touches."""


def _lines(outline: ComplexArray, kept: Mask) -> object:
    """The pieces of a closed outline, complex of shape (n,), whose points are kept, each with a point at either end."""
    import shapely

    if kept.all():
        return shapely.LineString(as_points(np.append(outline, outline[:1])))
    wide = kept.copy()
    wide[1:] |= kept[:-1]
    wide[:-1] |= kept[1:]
    wide[0] |= kept[-1]
    wide[-1] |= kept[0]
    start = 0 if wide.all() else int(np.argmin(wide))
    # From a point that is not kept on, if there is one, so that no piece goes on over the end
    order = np.flatnonzero(wide)
    order = np.concatenate([order[order >= start], order[order < start]])
    piece = np.cumsum(np.diff(order, prepend=order[:1] - 1) % outline.size != 1)
    points = outline[order]
    return shapely.multilinestrings(shapely.linestrings(points.real, points.imag, indices=piece - piece[0]))


def distances_of(train: Train, outlines_mm: Mapping[str, Array]) -> list[Distance]:
    """The least distance of all parts that have heights in common and are neither in mesh nor one body."""
    meshing = {frozenset((mesh.first, mesh.second)) for mesh in train.meshes}
    found = []
    for number, first in enumerate(train.parts):
        for second in train.parts[number + 1 :]:
            if frozenset((first.name, second.name)) in meshing or not first.overlaps(second):
                continue
            one_body = train.body(first) == train.body(second)
            if one_body or first.rim_mm is not None or second.rim_mm is not None:
                continue
            distance = _distance(train, first, second, outlines_mm)
            if distance is not None:
                found.append(distance)
    return found


def _distance(train: Train, first: Part, second: Part, outlines_mm: Mapping[str, Array]) -> Distance | None:
    """The least distance of two parts; None where circles about their axes that hold the parts never meet."""
    import shapely

    angles = _angles(train)
    relative = _relative(train, first.name, second.name)
    place, turn = relative(angles)
    apart = np.abs(place) - first.reach_mm - second.reach_mm
    if apart.min() > 0.0:
        return None
    area = shapely.Polygon(outlines_mm[first.name])
    other = as_complex(outlines_mm[second.name])

    def inward(at: complex, turned: complex) -> float:
        return -_signed_distance(area, at + other * turned)

    each = zip(apart, place, turn, strict=True)
    found = np.array([-np.inf if far > 0.0 else inward(at, turned) for far, at, turned in each])
    worst, at_rad = _greatest(lambda angle: inward(*np.ravel(relative(np.array([angle])))), angles, found)
    return Distance(first.name, second.name, -worst, at_rad)


def _signed_distance(area: Polygon, points: ComplexArray) -> float:
    """Distance of two polygons, the second of complex points; where they overlap, minus the root of the common area."""
    import shapely

    other = shapely.Polygon(as_points(points))
    distance = float(area.distance(other))
    return distance if distance > 0.0 else -(float(area.intersection(other).area) ** 0.5)


def worst(found: Sequence[MeshContact]) -> tuple[float, float]:
    """The greatest penetration and the greatest gap of several meshes, in mm."""
    return max(contact.penetration_max_mm for contact in found), max(contact.gap_max_mm for contact in found)
