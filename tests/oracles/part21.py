"""A reader of STEP files that knows nothing of who wrote them: ISO 10303-21 text, and curves evaluated by scipy.

It takes in only what gears are made of: B-splines, circles, lines; planes, cylinders, extrusions, B-spline surfaces.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

Array = NDArray[np.float64]

TOKEN = re.compile(r"'(?:[^']|'')*'|#\d+|\.\w+\.|[A-Z_][A-Z0-9_]*|[-+]?\d+\.?\d*(?:E[-+]?\d+)?|[(),=;*$]")

ROUND = 16
"""How many times as many points a circle gets, since it may turn by that much more than a side of a tooth."""


@dataclass(frozen=True)
class Ref:
    """A reference to an entity."""

    number: int


@dataclass(frozen=True)
class Entity:
    """An entity's type and arguments; of several types together, ``name`` is empty and ``arguments`` are entities."""

    name: str
    arguments: list[Any]


class Part21:
    """The entities of a file, and points on its curves."""

    def __init__(self, data: bytes) -> None:
        text = data.decode("ascii")
        self.header, body = text.split("DATA;", 1)
        self.entities = dict(_entities(TOKEN.findall(body.split("ENDSEC;", 1)[0])))

    def __getitem__(self, ref: Ref) -> Entity:
        return self.entities[ref.number]

    def of(self, name: str) -> list[Entity]:
        """All entities of a type."""
        return [entity for entity in self.entities.values() if entity.name == name]

    def faces(self, solid: Entity) -> list[Entity]:
        """Faces of a MANIFOLD_SOLID_BREP."""
        return [self[face] for face in self[solid.arguments[1]].arguments[1]]

    def surface(self, face: Entity) -> Entity:
        """What a face lies on."""
        return self[face.arguments[2]]

    def triple(self, ref: Ref) -> Array:
        """Coordinates of a CARTESIAN_POINT or DIRECTION."""
        return np.array(self[ref].arguments[1], dtype=float)

    def height(self, plane: Entity) -> float | None:
        """Height over z = 0 of a PLANE across z; None for one along it."""
        origin, axis = self[plane.arguments[1]].arguments[1:3]
        return float(self.triple(origin)[2]) if abs(self.triple(axis)[2]) > 0.5 else None

    def loops(self, face: Entity, samples: int) -> list[Array]:
        """Points along each closed loop of edges of a face, first point not repeated, shape (n, 3) each."""
        bounds = [self[self[bound].arguments[1]] for bound in face.arguments[1]]
        return [np.concatenate([self._oriented(edge, samples)[:-1] for edge in loop.arguments[1]]) for loop in bounds]

    def _oriented(self, ref: Ref, samples: int) -> Array:
        _, _, _, edge, forward = self[ref].arguments
        points = self.edge(self[edge], samples)
        return points if forward == ".T." else points[::-1]

    def edge(self, edge: Entity, samples: int) -> Array:
        """Points from the first to the second vertex of an EDGE_CURVE, shape (n + 1, 3), of circles more."""
        _, first, last, curve, same = edge.arguments
        start, end = (self.triple(self[vertex].arguments[1]) for vertex in (first, last))
        begin, finish = (start, end) if same == ".T." else (end, start)
        basis = self.basis(curve)
        count = samples * (ROUND if basis.name == "CIRCLE" else 1)
        points = self._along(basis, begin, finish, np.linspace(0.0, 1.0, count + 1))
        return points if same == ".T." else points[::-1]

    def basis(self, ref: Ref) -> Entity:
        """A curve in space, also where it is given with curves on surfaces."""
        curve = self[ref]
        return self[curve.arguments[1]] if curve.name in ("SURFACE_CURVE", "SEAM_CURVE") else curve

    def _along(self, curve: Entity, start: Array, end: Array, share: Array) -> Array:
        if curve.name == "LINE":
            return start + share[:, None] * (end - start)
        if curve.name == "CIRCLE":
            return self._arc(curve, start, end, share)
        spline = self.spline(curve)
        low, high = spline.t[spline.k], spline.t[-spline.k - 1]
        assert np.allclose(spline([low, high]), [start, end], rtol=0.0, atol=1e-6), "a spline that is cut"
        return np.asarray(spline(low + share * (high - low)))

    def spline(self, curve: Entity) -> BSpline:
        """A B_SPLINE_CURVE_WITH_KNOTS."""
        assert curve.name == "B_SPLINE_CURVE_WITH_KNOTS", curve.name
        _, degree, poles, _, _, _, times, knots, _ = curve.arguments
        every = np.repeat(np.array(knots, dtype=float), np.array(times, dtype=int))
        return BSpline(every, np.array([self.triple(pole) for pole in poles]), int(degree))

    def meets(self, surface: Entity, height: float) -> bool:
        """Whether a height is among those of a B-spline surface's poles."""
        heights = [self.triple(pole)[2] for pole in surface.arguments[3][0]]
        return min(heights) <= height <= max(heights)

    def level(self, surface: Entity, height: float, samples: int) -> Array:
        """Points of a B_SPLINE_SURFACE_WITH_KNOTS, its second parameter rising, at a height; shape (samples + 1, 3)."""
        assert surface.name == "B_SPLINE_SURFACE_WITH_KNOTS", surface.name
        _, u_degree, v_degree, poles, _, _, _, _, u_times, v_times, u_knots, v_knots, _ = surface.arguments
        grid = np.array([[self.triple(pole) for pole in row] for row in poles])
        u, v = (
            np.repeat(np.array(knots, dtype=float), np.array(times, dtype=int))
            for knots, times in ((u_knots, u_times), (v_knots, v_times))
        )
        rising = BSpline(v, grid.swapaxes(0, 1), int(v_degree))
        share = (height - grid[0, 0, 2]) / (grid[0, -1, 2] - grid[0, 0, 2])
        along = BSpline(u, rising(v[0] + share * (v[-1] - v[0])), int(u_degree))
        return np.asarray(along(np.linspace(u[0], u[-1], samples + 1)))

    def _arc(self, circle: Entity, start: Array, end: Array, share: Array) -> Array:
        _, place, radius = circle.arguments
        origin, axis, x = (self.triple(ref) for ref in self[place].arguments[1:])
        y = np.cross(axis, x)
        begin, finish = (np.arctan2((at - origin) @ y, (at - origin) @ x) for at in (start, end))
        turn = (finish - begin) % (2.0 * np.pi) or 2.0 * np.pi
        angle = (begin + share * turn)[:, None]
        return np.asarray(origin + radius * (np.cos(angle) * x + np.sin(angle) * y))


def _entities(tokens: list[str]) -> list[tuple[int, Entity]]:
    found, place = [], 0
    while place < len(tokens):
        number, place = int(tokens[place][1:]), place + 2
        entity, place = _entity(tokens, place)
        assert tokens[place] == ";", tokens[place]
        found.append((number, entity))
        place += 1
    return found


def _entity(tokens: list[str], place: int) -> tuple[Entity, int]:
    if tokens[place] == "(":
        together, place = [], place + 1
        while tokens[place] != ")":
            one, place = _entity(tokens, place)
            together.append(one)
        return Entity("", together), place + 1
    arguments, after = _list(tokens, place + 1)
    return Entity(tokens[place], arguments), after


def _list(tokens: list[str], place: int) -> tuple[list[Any], int]:
    assert tokens[place] == "("
    found: list[Any] = []
    place += 1
    while tokens[place] != ")":
        if tokens[place] == ",":
            place += 1
        else:
            value, place = _value(tokens, place)
            found.append(value)
    return found, place + 1


def _value(tokens: list[str], place: int) -> tuple[Any, int]:
    token = tokens[place]
    if token == "(":
        return _list(tokens, place)
    if token.startswith("#"):
        return Ref(int(token[1:])), place + 1
    if token[0] == "'":
        return token[1:-1].replace("''", "'"), place + 1
    if token[0].isalpha():
        return _entity(tokens, place)
    return (token if token[0] in ".$*" else float(token)), place + 1
