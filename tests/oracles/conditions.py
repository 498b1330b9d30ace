"""Judges of the conditions of a verdict, by polygons, finite differences and sampling.

They know what a file says in plain numbers, driven angles on a grid, outlines and the distance of the axes; nothing of
flanks, plays, closed forms or extremes.  Lengths in mm, angles in rad, masses in kg, power in W.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from scipy.optimize import minimize_scalar
from shapely import LinearRing, LineString, Polygon, contains_xy

from oracles.meshing import Pair

Array = np.ndarray
Data = dict[str, Any]

POSITIONS, WIDE_POSITIONS, TURNS = 61, 12, 16
"""Driving angles at which outlines must pass, a prime number, so that teeth stand differently at each; those at which
they must hold; steps of a pitch there."""


@dataclass(frozen=True, eq=False)
class Law:
    """Driven angles at driving angles over a cycle, evenly spaced, the end included; shape (n,)."""

    phi1: Array
    phi2: Array

    @cached_property
    def slope(self) -> Array:
        """dphi2/dphi1 by central differences."""
        return np.gradient(self.phi2, self.phi1, edge_order=2)

    @property
    def ratio_range(self) -> tuple[float, float]:
        """Least and largest ratio dphi1/dphi2."""
        return float(1.0 / self.slope.max()), float(1.0 / self.slope.min())


# --- pitch curves


def pitch_radii(law: Law, distance_mm: float, *, internal: bool) -> tuple[Array, Array]:
    """Pitch radii of both gears: the point on the line of centres at which both have one velocity."""
    driven = distance_mm / (1.0 - law.slope) if internal else distance_mm / (1.0 + law.slope)
    return law.slope * driven, driven


def pressure_angle_deg(law: Law, rack_deg: float, *, internal: bool) -> float:
    """The largest angle of the flank's normal to the driven point's way: rack's and pitch tangent's together."""
    own, _ = pitch_radii(law, 1.0, internal=internal)
    tangent = np.arctan(np.abs(np.gradient(own, law.phi1, edge_order=2)) / own)
    return float(np.degrees(tangent.max()) + rack_deg)


def least_bend(radii: Array, angles: Array) -> float:
    """The least curvature of a closed polyline in polar form, times its mean radius; negative where it is dented."""
    every = slice(None, None, max(1, len(radii) // 2000))
    points = (radii * np.exp(1j * angles))[every]
    sides = np.diff(points)
    turned = np.angle(sides[1:] / sides[:-1])
    length = (np.abs(sides[1:]) + np.abs(sides[:-1])) / 2.0
    return float((turned / length).min() * radii.mean())


# --- outlines


def passes(pair: Pair, phi1: Array, phi2: Array, reach_rad: float, tolerance_mm: float) -> tuple[float, float]:
    """The deepest of the least overlaps at driving angles, and that angle; the driven gear turns by up to a reach."""
    worst = (0.0, float(phi1[0]))
    last = 0.0
    for one, other in zip(phi1.tolist(), phi2.tolist(), strict=True):
        area, depth = pair.overlap(one, other + last)
        if area and depth > tolerance_mm:
            found = _least(lambda turn, one=one, other=other: pair.overlap(one, other + turn)[0], reach_rad)
            depth, last = pair.overlap(one, other + found)[1], found
        worst = max(worst, (depth, one))
    return worst


def _least(area: Callable[[float], float], reach_rad: float) -> float:
    """Where the overlap is least: it grows to both sides of that."""
    grid = np.linspace(-reach_rad, reach_rad, 9)
    place = grid[int(np.argmin([area(turn) for turn in grid]))]
    bounds = place - reach_rad / 4.0, place + reach_rad / 4.0
    return float(minimize_scalar(area, bounds=bounds, method="bounded", options={"xatol": 1e-4 * reach_rad}).x)


def holds(pair: Pair, phi1: Array, phi2: Array, pitch_rad: float, tolerance_mm: float) -> bool:
    """Whether the driven gear cannot be turned by a pitch at any of some driving angles without an overlap."""
    turns = np.linspace(0.0, pitch_rad, TURNS)
    return all(
        any(pair.overlap(one, other + turn)[1] > tolerance_mm for turn in turns)
        for one, other in zip(phi1.tolist(), phi2.tolist(), strict=True)
    )


def apart(pair: Pair, by_mm: float) -> Pair:
    """The pair with its axes further apart."""
    return replace(pair, center_distance=pair.center_distance + by_mm)


# --- the machine


@dataclass(frozen=True, eq=False)
class Places:
    """Where a linkage's parts are at crank angles (n,): the pin and its rods' ends, complex, and the output's place."""

    pin: Array
    rods: tuple[tuple[Array, Array], ...]
    output: Array
    working_rad: float
    """Crank angle of the extended dead centre."""


def places(linkage: Data, crank_rad: Array) -> Places:
    """By circles that meet, in the frame in which the crank's axis is at 0 and it turns clockwise."""
    crank = linkage["crank_mm"]
    kind = linkage.get("kind", "crank_slider")
    if kind == "scotch_yoke":
        pin = -crank * np.exp(-1j * crank_rad)
        slot = pin.real
        yoke = (slot - 1j * crank, slot + 1j * crank), (slot + 0j, slot + 2.7 * crank + 0j)
        return Places(pin, yoke, slot + crank, np.pi)
    if kind == "crank_rocker":
        return _rocker(linkage, crank_rad)
    rod, offset = linkage["rod_mm"], linkage.get("offset_mm", 0.0)
    start = np.pi + np.arcsin(offset / (rod - crank))
    pin = crank * np.exp(1j * (start - crank_rad))
    wrist = pin.real + np.sqrt(rod**2 - (offset - pin.imag) ** 2) + 1j * offset
    retracted = np.sqrt((rod - crank) ** 2 - offset**2)
    return Places(pin, ((pin, wrist),), wrist.real - retracted, float(start - np.arcsin(offset / (rod + crank))))


def _rocker(linkage: Data, crank_rad: Array) -> Places:
    crank, coupler, rocker, ground = (linkage[f"{name}_mm"] for name in ("crank", "coupler", "rocker", "ground"))

    def dead(distance: float) -> complex:
        x = (ground**2 + distance**2 - rocker**2) / (2.0 * ground)
        return complex(x, np.sqrt(distance**2 - x**2))

    start = np.angle(-dead(coupler - crank)) % (2.0 * np.pi)
    pin = crank * np.exp(1j * (start - crank_rad))
    between = ground - pin
    far = np.abs(between)
    along = (far**2 + coupler**2 - rocker**2) / (2.0 * far)
    end = pin + between / far * (along + 1j * np.sqrt(coupler**2 - along**2))
    swing = np.abs(np.angle((end - ground) / -1.0))
    first = abs(np.angle((dead(coupler - crank) - ground) / -1.0))
    return Places(
        pin,
        ((pin, end), (end, 0.0 * pin + ground)),
        swing - first,
        float((start - np.angle(dead(coupler + crank))) % (2.0 * np.pi)),
    )


Force = Callable[[Array], Array]


def polynomial(load: Data | None) -> Force:
    """The force of a file's polynomial in N or N mm over mm or rad, zero where it would be negative."""
    if load is None:
        return lambda x: 0.0 * x
    scale = 1.0 if "polynomial_n" in load else 1e3
    own = load.get("polynomial_n") or load["polynomial_n_m"]
    return lambda x: np.maximum(scale * np.polynomial.polynomial.polyval(x, own), 0.0)


def peak_power_w(data: Data, law: Law, driven_kg_mm2: float) -> float:
    """The driving shaft's largest power at an even speed: work against the load and the rise of all kinetic energy."""
    omega = data["operation"]["speed_rpm"] * np.pi / 30.0
    rate = omega / (law.phi1[1] - law.phi1[0])
    load, masses = data["resistance"], data.get("masses")
    if "linkage" not in data:
        return float(1e-3 * (polynomial(load)(law.phi2) * law.slope).max() * omega)
    at = places(data["linkage"], law.phi2)
    working = np.mod(law.phi2, 2.0 * np.pi) < at.working_rad
    friction = load.get("friction_n", 0.0)
    force = np.where(working, polynomial(load)(at.output), polynomial(load.get("returning"))(at.output)) + friction
    power = 1e-3 * force * np.abs(np.gradient(at.output) * rate)
    if masses:
        power = power + 1e-6 * np.gradient(_energy(data, at, law, rate, driven_kg_mm2)) * rate
    return float(power[2:-2].max())


def _energy(data: Data, at: Places, law: Law, rate: float, driven_kg_mm2: float) -> Array:
    """Kinetic energy in kg mm2/s2 of all that the crank moves."""
    masses = data["masses"]

    def square(place: Array) -> Array:
        return np.abs(np.gradient(place) * rate) ** 2

    turning = masses["crank"]["inertia_kg_mm2"] + driven_kg_mm2
    total = turning * square(law.phi2) + masses["slider_kg"] * square(at.output)
    if (rod := masses.get("rod")) is not None:
        ((_, wrist),) = at.rods
        way = (wrist - at.pin) / data["linkage"]["rod_mm"]
        total = total + rod["mass_kg"] * square(at.pin + rod["center_mm"] * way) + rod["inertia_kg_mm2"] * square(way)
    return total / 2.0


def second_moment_mm4(outline: Array, bore_mm: float) -> float:
    """About the origin, of a polygon (n, 2) counter-clockwise less a round bore."""
    x, y = outline.T
    u, v = np.roll(x, -1), np.roll(y, -1)
    own = (x * v - u * y) @ (x * x + x * u + u * u + y * y + y * v + v * v) / 12.0
    return float(own - np.pi * bore_mm**4 / 32.0)


def nearest_mm(at: Places, axis: complex) -> tuple[float, float]:
    """How near the crank pin and the middles of the rods come to an axis; infinite where there is no rod."""
    shares, every = np.linspace(0.0, 1.0, 400), slice(None, None, max(1, len(at.pin) // 4000))
    lines = (start[every, None] + shares * (end - start)[every, None] for start, end in at.rods)
    rods = min((float(np.abs(line - axis).min()) for line in lines), default=np.inf)
    return float(np.abs(at.pin - axis).min()), rods


def narrowed_mm(outline: Array, pitch: Array, module_mm: float) -> float:
    """By how much the teeth of an outline are narrower somewhere below than above that, at most; both (n, 2).

    Teeth are where the outline is half a module and more outside the pitch curve; widths are measured along the pitch
    curve's tangent at the middle of the tip, of what is solid about that middle.
    """
    solid, curve = Polygon(outline), LinearRing(pitch)
    inside = contains_xy(Polygon(pitch), *outline.T)
    away = shapely.distance(shapely.points(outline), curve) * np.where(inside, -1.0, 1.0)
    high = away > 0.5 * module_mm
    starts = np.nonzero(high & ~np.roll(high, 1))[0]
    return max(
        (_narrowed(solid, curve, np.roll(outline, -at, axis=0), np.roll(high, -at), module_mm) for at in starts),
        default=0.0,
    )


def _narrowed(solid: Polygon, curve: LinearRing, outline: Array, high: Array, module_mm: float) -> float:
    """The same of the tooth whose points above come first."""
    count = int(np.argmin(high)) if not high.all() else len(high)
    if count < 2:
        return 0.0
    middle = (outline[0] + outline[count - 1]) / 2.0
    at = curve.project(shapely.Point(middle))
    foot = np.array(curve.interpolate(at).coords[0])
    ahead = np.array(curve.interpolate((at + 1e-3 * module_mm) % curve.length).coords[0])
    along = (ahead - foot) / np.linalg.norm(ahead - foot)
    outwards = middle - foot - along * ((middle - foot) @ along)
    outwards /= np.linalg.norm(outwards)
    reach = 5.0 * module_mm
    near = shapely.clip_by_rect(solid, *(foot - reach), *(foot + reach))
    widths = []
    for height in np.linspace(0.6, -1.25, 75) * module_mm:
        center = foot + height * outwards
        line = LineString([center - 3.0 * module_mm * along, center + 3.0 * module_mm * along]).intersection(near)
        parts = [part for part in shapely.get_parts(line) if part.distance(shapely.Point(center)) < 1e-9]
        widths.append(max((part.length for part in parts), default=0.0))
    return float((np.maximum.accumulate(widths) - widths).max())
