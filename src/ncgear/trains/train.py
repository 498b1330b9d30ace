"""The value of every train of gears: parts, meshes, poses at any driving angle, and figures.

A kind of train is one module here, which returns a ``Train``, and one module of keys in ``design/trains``.  Checks,
files, pictures and answers take the value and need nothing else.  Angles are in rad, lengths in mm; all outlines and
poses are seen from +z, counter-clockwise positive.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import cached_property
from math import pi
from typing import Any

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.pitch.shape import Mesh

MARGIN = 0.04
"""Margin of pictures, as a share of their larger side."""

MORE_TEETH = "more teeth, or a smaller pressure angle, are needed"
"""What helps against a fault of the cutter, which no file of a train but that of a motor gives."""

GROUND = "ground"
"""``fixed_to`` of a part that stands still."""


@dataclass(frozen=True)
class PinHole:
    """A round hole through a part, its centre in the part's own frame."""

    x_mm: float
    y_mm: float
    diameter_mm: float


@dataclass(frozen=True, eq=False)
class Part:
    """A body of one outline: a gear, a ring, or a bar such as a carrier, which has no teeth.

    ``outline_mm`` (shape (n, 2), counter-clockwise, first point not repeated) is in the part's own frame, whose origin
    is the axis about which it turns.  For a ring it is the toothed hole, and ``rim_mm`` is the thickness outside the
    deepest root; other parts have None.  The part reaches from ``low_mm`` to ``low_mm + face_width_mm`` along z.
    ``fixed_to`` names the part, or GROUND, to which it is fixed as one body; empty if it is free.  ``wall_mm`` is the
    least material that the bore has to leave.
    """

    name: str
    outline_mm: Array
    face_width_mm: float
    teeth: int = 0
    low_mm: float = 0.0
    bore_mm: float | None = None
    rim_mm: float | None = None
    fixed_to: str = ""
    holes: tuple[PinHole, ...] = ()
    wall_mm: float = 0.0

    @property
    def reach_mm(self) -> float:
        """Greatest distance of the part from its axis."""
        return float(np.hypot(*self.outline_mm.T).max()) + (self.rim_mm or 0.0)

    def overlaps(self, other: Part) -> bool:
        """Whether both parts have heights in common."""
        return self.low_mm < other.low_mm + other.face_width_mm and other.low_mm < self.low_mm + self.face_width_mm


@dataclass(frozen=True)
class GearMesh:
    """Two parts whose teeth are in mesh, by their names; in an internal mesh the second part is the ring."""

    first: str
    second: str
    kind: Mesh = Mesh.EXTERNAL


@dataclass(frozen=True, eq=False)
class Poses:
    """Poses of all parts, in their order, at n driving angles: place of the axis and angle, shape (parts, n) each.

    A point p of a part's own frame, as a complex number, is at ``x + i y + p exp(i angle)``.
    """

    x_mm: Array
    y_mm: Array
    angle_rad: Array

    def places(self, number: int) -> tuple[ComplexArray, ComplexArray]:
        """Axis and turn of one part as complex numbers, shape (n,) each."""
        return self.x_mm[number] + 1j * self.y_mm[number], np.exp(1j * self.angle_rad[number])


@dataclass(frozen=True, eq=False)
class Trace:
    """A followed point of a part: the part's name, the point's place in the part's frame, and the points wished for it.

    ``wished_mm`` has shape (m, 2), also (0, 2), in the frame of the ground.
    """

    name: str
    part: str
    at_mm: tuple[float, float]
    wished_mm: Array = field(default_factory=lambda: np.empty((0, 2)))


@dataclass(frozen=True)
class TrainCondition:
    """A condition that the train has to keep: its name, whether it holds (None: not judged), words, and remedies."""

    name: str
    holds: bool | None
    said: str
    cures: tuple[str, ...] = ()


def contact_condition(contact_ratio: float, *cures: str) -> TrainCondition:
    """The condition that teeth follow each other without a gap, with remedies where they do not."""
    met, followed = f"{contact_ratio:.3g} pairs of teeth in mesh at least", contact_ratio > 1.0
    return TrainCondition("contact ratio", followed, met, () if followed else cures)


@dataclass(frozen=True)
class TrainFigures:
    """Figures and conditions of one train.

    ``head`` says in a few words what the train is; ``rows`` are names with a text each, the most telling first;
    ``figures`` stand in the summary, and their keys end in their unit; ``conditions`` are judged by the kind itself.
    """

    head: str
    rows: tuple[tuple[str, str], ...] = ()
    figures: Mapping[str, Any] = field(default_factory=dict)
    conditions: tuple[TrainCondition, ...] = ()


@dataclass(frozen=True, eq=False)
class Train:
    """Parts, meshes and poses.

    ``poses_at`` gives the poses at driving angles in rad, shape (n,).  ``driving`` names the part whose turning is the
    driving angle, or which is turned by a shaft whose turning it is; ``speed_rpm`` is its mean speed.  After
    ``cycle_rad`` all parts stand as at first, but for whole turns or for turns by whole periods of their teeth; all
    meshes come round ``repeats`` times in it.
    ``tolerance_mm`` is the largest deviation of outlines from the exact curves.
    """

    parts: tuple[Part, ...]
    meshes: tuple[GearMesh, ...]
    poses_at: Callable[[Array], Poses] = field(repr=False)
    driving: str
    cycle_rad: float
    speed_rpm: float
    tolerance_mm: float
    told: TrainFigures
    traces: tuple[Trace, ...] = ()
    repeats: int = 1

    def __post_init__(self) -> None:
        names = [part.name for part in self.parts]
        unknown = [name for mesh in self.meshes for name in (mesh.first, mesh.second) if name not in names]
        if len({*names}) != len(names) or unknown:
            raise ValueError(f"parts {names} are not all different, or {unknown} are none of them")

    def number(self, name: str) -> int:
        """The place of a part among the parts."""
        return next(number for number, part in enumerate(self.parts) if part.name == name)

    def part(self, name: str) -> Part:
        """A part by its name."""
        return self.parts[self.number(name)]

    def body(self, part: Part) -> str:
        """The body to which a part belongs: the name of the part, or GROUND, to which others are fixed."""
        names = {part.name for part in self.parts}
        while part.fixed_to in names:
            part = self.part(part.fixed_to)
        return part.fixed_to or part.name

    @property
    def turns(self) -> int:
        """Whole turns of the driving angle in a cycle, at least 1, of each of which curves and pictures have as many
        points."""
        return max(1, round(self.cycle_rad / (2.0 * pi)))

    @cached_property
    def assembled(self) -> Poses:
        """The poses at the driving angle 0, in which the train is put together."""
        return self.poses_at(np.zeros(1))

    @cached_property
    def alike(self) -> dict[str, str]:
        """The name of the first part that has the same body, by the name of each part."""
        firsts: dict[object, str] = {}
        found = {}
        for part in self.parts:
            body = part.outline_mm.tobytes(), part.face_width_mm, part.teeth, part.bore_mm, part.rim_mm, part.holes
            found[part.name] = firsts.setdefault(body, part.name)
        return found

    @cached_property
    def tints(self) -> dict[str, int]:
        """A small number of each part, by its name, that differs from those of all parts with which it meshes."""
        tints: dict[str, int] = {}
        for part in self.parts:
            taken = {
                tints.get(m.second if m.first == part.name else m.first, -1)
                for m in self.meshes
                if part.name in (m.first, m.second)
            }
            tints[part.name] = next(number for number in range(len(taken) + 1) if number not in taken)
        return tints

    def room_mm(self) -> tuple[Array, Array]:
        """The corners, shape (2,), of the smallest upright rectangle with a margin in which all parts stay."""
        poses, corners = self.poses_at(np.linspace(0.0, self.cycle_rad, 61)), []
        for number, part in enumerate(self.parts):
            axis, turn = poses.places(number)
            placed = axis[:, None] + turn[:, None] * (part.outline_mm @ np.array([1.0, 1.0j]))
            low, high = (np.array([end(placed.real), end(placed.imag)]) for end in (np.min, np.max))
            corners.append((low - (part.rim_mm or 0.0), high + (part.rim_mm or 0.0)))
        low, high = np.min(corners, axis=0)[0], np.max(corners, axis=0)[1]
        margin = MARGIN * float((high - low).max())
        return low - margin, high + margin

    def trace_mm(self, trace: Trace, driving_rad: Array) -> Array:
        """Places of a followed point at driving angles in rad, shape (n,), as points of shape (n, 2)."""
        axis, turn = self.poses_at(driving_rad).places(self.number(trace.part))
        there = axis + complex(*trace.at_mm) * turn
        return np.stack([there.real, there.imag], axis=-1)


def mirrored(points_mm: Array) -> Array:
    """A ring of points, shape (n, 2), reflected in the x axis, and in reversed order, so that it keeps its sense."""
    return (points_mm * [1.0, -1.0])[::-1]


def seen_from_behind(train: Train) -> Train:
    """The train reflected in the x axis: parts that turned counter-clockwise turn clockwise."""

    def poses_at(driving_rad: Array) -> Poses:
        poses = train.poses_at(driving_rad)
        return Poses(poses.x_mm, -poses.y_mm, -poses.angle_rad)

    parts = tuple(
        replace(
            part,
            outline_mm=mirrored(part.outline_mm),
            holes=tuple(replace(hole, y_mm=-hole.y_mm) for hole in part.holes),
        )
        for part in train.parts
    )
    traces = tuple(
        replace(trace, at_mm=(trace.at_mm[0], -trace.at_mm[1]), wished_mm=trace.wished_mm * [1.0, -1.0])
        for trace in train.traces
    )
    return replace(train, parts=parts, traces=traces, poses_at=poses_at)
