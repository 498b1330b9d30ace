"""A small reader of DXF files that knows group codes and nothing of the library that wrote them.

Source: Autodesk, DXF Reference (AutoCAD 2010): LWPOLYLINE (10, 20, 42, 70), CIRCLE (10, 20, 40), LINE (10, 20, 11, 21).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import atan, cos, hypot, pi, sin

Pair = tuple[int, str]


@dataclass
class Entity:
    kind: str
    codes: list[Pair] = field(default_factory=list)

    def values(self, code: int) -> list[str]:
        return [value for key, value in self.codes if key == code]

    @property
    def layer(self) -> str:
        return self.values(8)[0]

    @property
    def closed(self) -> bool:
        return self.kind == "CIRCLE" or bool(int(self.values(70)[0]) & 1)

    def number(self, code: int) -> float:
        return float(self.values(code)[0])

    def vertices(self) -> list[list[float]]:
        """x, y and bulge of a polyline, whose codes come vertex by vertex."""
        found: list[list[float]] = []
        for code, value in self.codes:
            if code == 10:
                found.append([float(value), 0.0, 0.0])
            elif found and code in (20, 42):
                found[-1][{20: 1, 42: 2}[code]] = float(value)
        return found

    def points(self, step_rad: float = 0.001) -> list[tuple[float, float]]:
        """Points all along it, arcs in small steps."""
        if self.kind == "CIRCLE":
            x, y, radius = self.number(10), self.number(20), self.number(40)
            count = round(2.0 * pi / step_rad)
            return [(x + radius * cos(2 * pi * k / count), y + radius * sin(2 * pi * k / count)) for k in range(count)]
        corners = self.vertices()
        return [
            point
            for start, end in zip(corners, [*corners[1:], corners[0]], strict=True)
            for point in _along(start, end, step_rad)
        ]


def _along(start: list[float], end: list[float], step: float) -> list[tuple[float, float]]:
    """From a vertex up to the next one, that one left out."""
    (x, y, bulge), (u, v, _) = start, end
    if bulge == 0.0:
        return [(x, y)]
    turned = 4.0 * atan(bulge)
    radius = hypot(u - x, v - y) / 2.0 / sin(turned / 2.0)
    # The centre lies to the left of the chord by radius cos(turned / 2).
    off, length = radius * cos(turned / 2.0), hypot(u - x, v - y)
    center = ((x + u) / 2.0 - off * (v - y) / length, (y + v) / 2.0 + off * (u - x) / length)
    count = max(2, round(abs(turned) / step))
    arm = (x - center[0], y - center[1])
    angles = [turned * k / count for k in range(count)]
    return [
        (center[0] + arm[0] * cos(a) - arm[1] * sin(a), center[1] + arm[0] * sin(a) + arm[1] * cos(a)) for a in angles
    ]


def pairs(text: str) -> Iterator[Pair]:
    lines = text.splitlines()
    yield from ((int(code), value.strip()) for code, value in zip(lines[::2], lines[1::2], strict=True))


def header(text: str) -> dict[str, str]:
    """The first value of each variable of the header."""
    found, name = {}, ""
    for code, value in pairs(text):
        if (code, value) == (0, "ENDSEC"):
            break
        if code == 9:
            name = value
        elif name:
            found.setdefault(name, value)
    return found


def entities(text: str) -> list[Entity]:
    """What is drawn."""
    found: list[Entity] = []
    inside = False
    for code, value in pairs(text):
        if code == 2 and value in ("ENTITIES", "OBJECTS", "BLOCKS"):
            inside = value == "ENTITIES"
        elif inside and code == 0:
            found.append(Entity(value))
        elif inside and found:
            found[-1].codes.append((code, value))
    return [one for one in found if one.kind in ("LWPOLYLINE", "CIRCLE", "LINE")]
