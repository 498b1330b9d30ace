"""Whether the crank pin and the rods pass the bodies beside the gears: the driving shaft with its hub, end stops, axes
about which other links turn.

The model is plane.  Crank pin and rods move in one plane beside the gears, viewed along the axes.  The driving gear's
shaft (as thick as its bore) or hub, the pins of end stops, and the axes of rocker and lever can stand in this plane.
The axes count as lines, since no key gives their thickness.  A rod is the straight line between its joints, with half
its width on both sides and round ends; a yoke is two such lines, slot and bar, a rack its pitch line, and a pinion a
disc.  The driven shaft cannot be in the plane: at a dead centre every rod lies over the crank's axis.

Over the cycle the distance of an axis from such a line is a continuous function of the driving angle, which changes no
faster than the ends of the line move.  So a step between two samples is skipped only if it cannot have the least
distance; all other steps are searched.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import cos, hypot, pi, radians, sin

import numpy as np

from ncgear.design.keys.bodies import GearBody
from ncgear.errors import Unanswered
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project.geared import Geared
from ncgear.ratio.transmission import Transmission

CRANK_PIN = "crank pin"


@dataclass(frozen=True)
class Standing:
    """A round body beside the gears: its name, its centre in the mechanism's frame, its radius in mm.

    The radius is None where the design does not give it, 0 for a line.  ``carries`` is the link that turns about it, if
    any.
    """

    name: str
    center_mm: tuple[float, float]
    radius_mm: float | None
    carries: str = ""

    @property
    def about_driving_axis(self) -> bool:
        """Whether it is the driving gear's shaft or hub, which may end below the moving parts."""
        return self.name.startswith("driving")


@dataclass(frozen=True)
class Passing:
    """The least distance from the middle of a moving part to the centre of a standing body, and its driving angle.

    ``part`` is the crank pin or a rod by its name, ``half_mm`` half its width or diameter, None where it is not given.
    """

    part: str
    standing: Standing
    distance_mm: float
    phi1_rad: float
    half_mm: float | None

    @property
    def room_mm(self) -> float | None:
        """The widest part that passes, or the negative of the missing room; None where the radius is not known."""
        return None if self.standing.radius_mm is None else 2.0 * (self.distance_mm - self.standing.radius_mm)

    @property
    def meets(self) -> bool | None:
        """Whether the part meets the standing body; a part without width, at any width; None where it is not known."""
        return None if self.room_mm is None else self.room_mm < 2.0 * (self.half_mm or 0.0)

    @property
    def clearance_mm(self) -> float | None:
        """The gap between both, negative where they meet; None where a size is not known."""
        if self.half_mm is None or self.standing.radius_mm is None:
            return None
        return self.distance_mm - self.standing.radius_mm - self.half_mm


def passings_of(drive: Geared) -> tuple[Passing, ...]:
    """All passings of a pair's moving parts and standing bodies; empty where no linkage moves."""
    linkage = drive.linkage
    if not (drive.moves_output and linkage.rod_lines_mm):
        return ()
    standing = standing_of(drive)
    discs = [
        Passing(disc, body, hypot(*body.center_mm), 0.0, radius_mm)
        for disc, radius_mm in linkage.discs_mm.items()
        for body in standing
    ]
    lines = [
        Passing(part, body, *least_distance(lines, body.center_mm, drive.transmission), _half_mm(drive, part))
        for part, lines in center_lines(linkage).items()
        if part != CRANK_PIN or drive.turns_crank
        for body in standing
        if body.carries != part
    ]
    return (*discs, *lines)


def _half_mm(drive: Geared, part: str) -> float | None:
    if part == CRANK_PIN:
        pin = drive.gears.driven.crank_pin
        return pin.diameter_mm / 2.0 if pin else None
    width_mm = drive.design.fit.rod_width_mm if drive.design.fit else None
    return None if width_mm is None else width_mm / 2.0


def standing_of(drive: Geared) -> tuple[Standing, ...]:
    """The bodies beside the gears: shaft or hub of the driving gear, axes of other links, and the pins of end stops."""
    gears, distance_mm = drive.gears, drive.pitch.center_distance_mm
    axis_rad = radians(gears.driving_axis_deg)
    driving = distance_mm * cos(axis_rad), distance_mm * sin(axis_rad)
    name, radius_mm = about_axis(gears.driving)
    axes = [Standing(f"{link}'s axis", center, 0.0, link) for link, center in drive.linkage.pivots_mm.items()]
    found = [Standing(f"driving {name}", driving, radius_mm), *axes]
    if drive.pitch.mesh is Mesh.INTERNAL:
        return tuple(found)
    for gear, body, (x, y) in ((Gear.DRIVING, gears.driving, driving), (Gear.DRIVEN, gears.driven, (0.0, 0.0))):
        pin = drive.finished_plans[gear is Gear.DRIVEN].pin_mm if body.end_stop else None
        if pin is not None and body.end_stop is not None:
            # The frame of the pair has the driven axis on +x of the driving axis.
            turned = complex(*pin) * np.exp(1j * (axis_rad - pi))
            center = x + float(turned.real), y + float(turned.imag)
            found.append(Standing(f"pin of the {gear.value} gear's end stop", center, body.end_stop.pin_mm / 2.0))
    return tuple(found)


def about_axis(body: GearBody) -> tuple[str, float | None]:
    """The body about a gear's axis, hub or shaft, and its radius in mm; None where neither hub nor bore is given."""
    if body.hub is not None:
        return "hub", body.hub.diameter_mm / 2.0
    return "shaft", None if body.bore_mm is None else body.bore_mm / 2.0


CenterLines = Callable[[Array], tuple[Array, Array, float]]
"""From crank angles in rad (n,): both ends of a part's m lines in mm, complex (m, n) each, and their greatest speed in
mm/rad."""


def center_lines(linkage: Mechanism) -> Mapping[str, CenterLines]:
    """The middle of the crank pin, a line without length, and of each rod, by their names."""

    def pin(crank_rad: Array) -> tuple[Array, Array, float]:
        at = linkage.crank_body(Jet(crank_rad[None, :]), 0.0).pin
        place = at.x.value + 1j * at.y.value
        return place[None], place[None], linkage.crank_mm

    def rod(name: str) -> CenterLines:
        # Both ends of all lines, shape (2, m, 1)
        own = (np.array(linkage.rod_lines_mm[name]) @ (1.0, 1j)).T[..., None]

        def ends(crank_rad: Array) -> tuple[Array, Array, float]:
            link = linkage.links(Jet.variable(crank_rad, 1))[name]
            way = np.exp(1j * link.angle.value)
            origin = link.origin.x.value + 1j * link.origin.y.value
            slide = link.origin.x.derivative(1) + 1j * link.origin.y.derivative(1)
            turn = 1j * link.angle.derivative(1) * way
            start, stop = origin + way * own
            return start, stop, float(np.abs(slide + turn * own).max())

        return ends

    return {CRANK_PIN: pin, **{name: rod(name) for name in linkage.rod_lines_mm}}


STEPS, PARTS, LEVELS = 720, 16, 2
"""Steps of a cycle, parts into which a step is divided if it may have the least distance, and how often it is
divided."""

FASTER = 1.5
"""The ends of a line move no faster between samples than this factor times the greatest speed at samples."""

NARROWEST_RAD = 1e-12
"""Interval of angles at which the search for a least distance ends."""


def least_distance(
    lines: CenterLines, center_mm: tuple[float, float], transmission: Transmission
) -> tuple[float, float]:
    """The least distance in mm of a point from a moving line over a cycle, and its driving angle in rad.

    Between two samples the distance changes by less than the path of the line's ends.  This gives a bound for each
    step; a step with a bound above the least value found cannot have the least distance.  Raises Unanswered for a
    distance that is not finite.
    """
    lobes, point = transmission.lobes, complex(*center_mm)
    end = transmission.cycle_rad if lobes.repeats else lobes.driving_period_rad

    def sampled(phi1_rad: Array) -> tuple[Array, Array]:
        """Distances, and bounds of the path of the line's ends from each angle to the next, along the last axis."""
        crank = transmission.driven_angle(phi1_rad.ravel()).value
        start, stop, speed = lines(crank)
        way = FASTER * speed * np.abs(np.diff(crank.reshape(phi1_rad.shape), axis=-1))
        return from_segment(point, start, stop).min(axis=0).reshape(phi1_rad.shape), way

    edges = np.linspace(0.0, end, STEPS + 1)
    steps = np.stack([edges[:-1], edges[1:]], axis=-1)
    for level in range(LEVELS + 1):
        grid = steps if level == 0 else steps[:, :1] + np.diff(steps) * np.linspace(0.0, 1.0, PARTS + 1)
        distance, way = sampled(grid)
        if not np.isfinite(distance).all():
            raise Unanswered("the distance of a rod from a shaft is no finite number")
        lowest = (distance[:, :-1] + distance[:, 1:] - way) / 2.0
        held = lowest < distance.min()
        steps = np.stack([grid[:, :-1][held], grid[:, 1:][held]], axis=-1)
        if not len(steps):
            place = np.unravel_index(np.argmin(distance), distance.shape)
            return float(distance[place]), float(grid[place])
    parted = np.nonzero(steps[1:, 0] > steps[:-1, 1] + NARROWEST_RAD)[0] + 1
    runs = [(float(run[0, 0]), float(run[-1, 1])) for run in np.split(steps, parted)]
    return min(_narrowed(lambda phi1: sampled(phi1)[0], low, high) for low, high in runs)


def _narrowed(distance: Callable[[Array], Array], low: float, high: float) -> tuple[float, float]:
    """The least distance between two angles, where it has one minimum, and its angle."""
    while True:
        grid = np.linspace(low, high, 2 * PARTS + 1)
        found = distance(grid)
        place = int(np.argmin(found))
        if high - low < NARROWEST_RAD:
            return float(found[place]), float(grid[place])
        low, high = float(grid[max(place - 1, 0)]), float(grid[min(place + 1, 2 * PARTS)])


def from_segment(point: complex, start: Array, stop: Array) -> Array:
    """Distance of a point from the segments between complex ends, of their shape."""
    along = stop - start
    square = np.abs(along) ** 2
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.clip(np.where(square > 0.0, (np.conj(along) * (point - start)).real / square, 0.0), 0.0, 1.0)
    return np.abs(point - start - share * along)
