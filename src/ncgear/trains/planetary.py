"""Planetary trains of non-circular gears: a sun, idlers and planets on a carrier, with an arm on each planet.

In the frame of the carrier every mesh is a pair on fixed axes.  The carrier turns by u against the sun; the idler turns
by f(u) and the planet by w(u) = g(f(u)), the planet in the sense of the sun: seen from the ground it turns by u - w.  A
compound idler is two gears on one shaft; its two pairs in series make any ratio.  A shared idler meshes with sun and
planet.  At equal centre distances the planet is then a gear like the sun, a line of centres later: with F the inverse
of f, w = F(f(u) + kappa) - F(kappa), where kappa is pi on a straight carrier.  With L(v) = ln F'(v), the logarithm of
the whole ratio du/dw at the idler's angle v is L(v) - L(v + pi): it has no even harmonics.

Every arm is the same chain at another angle of one sun, so all meshes of all arms close for any number of teeth.
Source of the arrangement: planetary transplanting mechanisms with non-circular gears (D.-C. Lee and others, Y. Zhao and
others, from 2000 on); the equations follow from closed vector loops.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field
from fractions import Fraction
from math import acos, ceil, pi

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import as_points
from ncgear.pitch.arc_length import arc_length
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Mesh
from ncgear.ratio.transmission import Transmission
from ncgear.teeth.gear import ToothedPair
from ncgear.trains.tip_path import TipMotion, WishedPath
from ncgear.trains.train import (
    GROUND,
    GearMesh,
    Part,
    PinHole,
    Poses,
    Trace,
    Train,
    TrainFigures,
    mirrored,
    seen_from_behind,
)

GAP_MM = 1.0
"""Gap between the heights of gears, carrier and arms that lie over each other."""

OfAngle = Callable[[Array], Array]
"""Function of angles in rad, shape (n,), whose values are angles in rad."""


@dataclass(frozen=True, eq=False)
class GearOfChain:
    """A gear of one chain: its name, outline in mm (shape (n, 2)), teeth, and how it stands in the frame of its arm.

    ``place`` is its axis as a complex number in mm, in a frame with the planet on the positive real axis; ``angle``
    gives its angle in that frame at angles u in rad.  ``layer`` counts the heights of gears from 0.
    """

    name: str
    outline_mm: Array
    teeth: int
    place: complex
    angle: OfAngle
    layer: int = 0
    fixed_to: str = ""


@dataclass(frozen=True, eq=False)
class ArmChain:
    """Sun, idlers and planet of one arm, the sun first and the planet last, and the meshes by their names.

    All meshes are of one ``kind``.  ``planet_rad`` is w(u).
    """

    gears: tuple[GearOfChain, ...]
    meshes: tuple[tuple[str, str], ...]
    planet_rad: OfAngle
    kind: Mesh = Mesh.EXTERNAL

    @property
    def carrier_mm(self) -> float:
        """Distance from the sun's axis to the planet's."""
        return abs(self.gears[-1].place)


def straight_distances_mm(laws: Sequence[Transmission], carrier_mm: float) -> tuple[float, float]:
    """Centre distances of two pairs on a straight carrier, both with one number of teeth and one module."""
    first, second = (arc_length(law, Mesh.EXTERNAL).period for law in laws)
    return carrier_mm * second / (first + second), carrier_mm * first / (first + second)


def compound_chain(
    pitches: tuple[PitchPair, PitchPair], teeth: tuple[ToothedPair, ToothedPair], carrier_mm: float
) -> ArmChain:
    """A chain with two gears on the idler's shaft, from the pairs of both meshes, with the planet at ``carrier_mm``.

    The idler stands beside the line from sun to planet where the sum of the centre distances is longer than that line.
    Raises NoSuchMechanism, with the key ``train.gears``, where they do not reach or do not fit.
    """
    first, second = (pitch.center_distance_mm for pitch in pitches)
    if not abs(first - second) < carrier_mm <= (first + second) * (1.0 + STRAIGHT):
        raise NoSuchMechanism(
            f"the centre distances {first:.6g} and {second:.6g} mm do not span the {carrier_mm:.6g} mm from sun to "
            f"planet; a module of {carrier_mm / (first + second) * pitches[0].size.module_mm:.6g} mm or more, or more "
            "teeth, is right",
            key="train.gears",
        )
    cosine = (carrier_mm**2 + first**2 - second**2) / (2.0 * carrier_mm * first)
    straight = carrier_mm >= (first + second) * (1.0 - STRAIGHT)
    before = 0.0 if straight else float(np.arccos(cosine))
    idler = first * np.exp(1j * before)
    after = float(np.angle(carrier_mm - idler))
    to_idler, to_planet = (pitch.transmission.driven_angle for pitch in pitches)

    def idler_rad(u: Array) -> Array:
        return to_idler(u).value

    def planet_rad(u: Array) -> Array:
        return to_planet(to_idler(u).value).value

    a, b = teeth
    gears = (
        GearOfChain("sun", mirrored(a.driving.outline_mm), a.driving.teeth, 0j, lambda u: before - u),
        GearOfChain("idler", mirrored(a.driven.outline_mm), a.driven.teeth, idler, lambda u: before + idler_rad(u)),
        GearOfChain(
            "second_idler", b.driving.outline_mm, b.driving.teeth, idler, lambda u: after + idler_rad(u), 1, "idler"
        ),
        GearOfChain(
            "planet", b.driven.outline_mm, b.driven.teeth, complex(carrier_mm), lambda u: after - planet_rad(u), 1
        ),
    )
    return ArmChain(gears, (("sun", "idler"), ("second_idler", "planet")), planet_rad)


STRAIGHT = 1e-9
"""Relative difference of carrier and sum of centre distances that counts as rounding: the carrier is straight."""


def shared_chain(pitch: PitchPair, teeth: ToothedPair, bend_rad: float) -> ArmChain:
    """A chain whose idler meshes with sun and planet at equal centre distances; the pair is sun and idler.

    ``bend_rad`` is the angle between the lines from sun to idler and from idler to planet.
    """
    distance = pitch.center_distance_mm
    planet = distance * (1.0 + np.exp(1j * bend_rad))
    before = -float(np.angle(planet))
    after = before + bend_rad
    kappa = pi - bend_rad
    inverse = _inverse(pitch)
    (start,) = inverse(np.array([kappa]))

    def idler_rad(u: Array) -> Array:
        return pitch.transmission.driven_angle(u).value

    def later(u: Array) -> Array:
        return inverse(idler_rad(u) + kappa)

    sun, idler = mirrored(teeth.driving.outline_mm), mirrored(teeth.driven.outline_mm)
    gears = (
        GearOfChain("sun", sun, teeth.driving.teeth, 0j, lambda u: before - u),
        GearOfChain(
            "idler", idler, teeth.driven.teeth, distance * np.exp(1j * before), lambda u: before + idler_rad(u)
        ),
        GearOfChain("planet", sun, teeth.driving.teeth, complex(abs(planet)), lambda u: after - pi - later(u)),
    )
    return ArmChain(gears, (("sun", "idler"), ("idler", "planet")), lambda u: later(u) - start)


def ring_chain(pitch: PitchPair, teeth: ToothedPair) -> ArmChain:
    """A planet inside a ring in place of the sun; the pair is planet and ring, the planet driving.

    Planet and ring turn to the same side against the carrier, the planet by the inverse of the law.
    """
    planet_rad = _inverse(pitch)
    ring, planet = mirrored(teeth.driven.outline_mm), mirrored(teeth.driving.outline_mm)
    gears = (
        GearOfChain("ring", ring, teeth.driven.teeth, 0j, lambda u: pi - u),
        GearOfChain(
            "planet", planet, teeth.driving.teeth, complex(pitch.center_distance_mm), lambda u: pi - planet_rad(u)
        ),
    )
    return ArmChain(gears, (("planet", "ring"),), planet_rad, Mesh.INTERNAL)


def _inverse(pitch: PitchPair) -> OfAngle:
    """The driving angle over the driven one, by Newton's method within brackets of a table."""
    law = pitch.transmission
    table = np.linspace(0.0, 2.0 * pi * law.lobes.driven, 721 * law.lobes.driven)
    turned = law.driven_angle(table).value
    whole, back = float(turned[-1]), float(table[-1])

    def at(driven: Array) -> Array:
        cycles, within = np.divmod(np.asarray(driven, dtype=float), whole)
        found = np.interp(within, turned, table)
        for _ in range(NEWTON_STEPS):
            jet = law.driven_angle(found, 1)
            found = found - (jet.value - within) / jet.derivative(1)
        missed = law.driven_angle(found).value - within
        if not np.abs(missed).max(initial=0.0) < INVERTED_RAD:
            raise NoSuchMechanism("the ratio of sun and idler could not be inverted", key="train.motion")
        return found + cycles * back

    return at


NEWTON_STEPS = 5
"""Steps from a table with half a degree between entries: each step squares the error."""

INVERTED_RAD = 1e-11
"""Error of an inverse that counts as rounding."""


@dataclass(frozen=True, eq=False)
class Arm:
    """The arm on a planet: its length in mm, its direction in rad less the planet's turn, and points for its tip.

    At u the arm stands at u - w(u) + ``angle_rad`` from the ground.  ``wished_mm`` has shape (m, 2).
    """

    length_mm: float
    angle_rad: float = 0.0
    wished_mm: Array = field(default_factory=lambda: np.empty((0, 2)))


@dataclass(frozen=True)
class Stand:
    """Position of the train: the sun's axis in mm, the carrier's angle in rad at first, and its sense of turning.

    Axis and angle hold for a carrier that turns counter-clockwise; ``clockwise`` is the same train seen from the other
    side, reflected in the x axis.
    """

    axis_mm: complex = 0j
    start_rad: float = 0.0
    clockwise: bool = False


STILL = Stand()
"""The sun's axis at the origin, the carrier along the x axis."""


def arm_of(motion: TipMotion, wished: WishedPath) -> Arm:
    """The arm of a path's motion, with the wished points as seen where the carrier turns counter-clockwise."""
    seen = wished.mirrored if motion.clockwise else wished
    return Arm(motion.arm_mm, 0.0, as_points(seen.points))


def stand_of(motion: TipMotion) -> Stand:
    """Where the carrier of a path's motion stands, and how it turns."""
    axis = motion.axis.conjugate() if motion.clockwise else motion.axis
    return Stand(axis, float(motion.carrier_rad(np.zeros(1))[0]), motion.clockwise)


@dataclass(frozen=True)
class Bodies:
    """Heights and bores of the parts in mm, the rim of a ring in place of the sun, walls of gears about bores."""

    face_width_mm: float
    bore_mm: float | None
    bar_width_mm: float
    rim_mm: float | None = None
    wall_mm: float = 0.0


def planetary_train(
    chain: ArmChain,
    arm: Arm | None,
    arms: int,
    bodies: Bodies,
    speed_rpm: float,
    tolerance_mm: float,
    sun_turns: float = 0.0,
    stand: Stand = STILL,
    carrier_rad: OfAngle = lambda driving: driving,
) -> Train:
    """The train of ``arms`` chains about one sun, evenly spread, each planet with its arm if there is one.

    ``sun_turns`` are turns of the sun per turn of the carrier: 0 where the sun is fixed.  The carrier turns
    by ``carrier_rad`` of the driving angle, a shaft's that turns evenly.  With a sun that turns, the cycle ends where
    sun and carrier have made whole turns; if that takes more than MOST_TURNS, after a turn against each other.
    """
    parts, meshes, ways = [], [], []
    width, step = bodies.face_width_mm, bodies.face_width_mm + GAP_MM
    layers = 1 + max(gear.layer for gear in chain.gears)
    sun, *others = chain.gears
    against = 1.0 - sun_turns

    def chain_rad(driving: Array, number: int) -> tuple[Array, Array]:
        turned, offset = carrier_rad(driving), 2.0 * pi * number / arms
        return turned + stand.start_rad + offset, against * turned + offset

    def way_of(place: complex, angle: OfAngle, number: int) -> Callable[[Array], tuple[Array, Array]]:
        def way(driving: Array) -> tuple[Array, Array]:
            direction, u = chain_rad(driving, number)
            return place * np.exp(1j * direction), direction + angle(u)

        return way

    fixed = GROUND if sun_turns == 0.0 else ""
    bore_mm = bodies.bore_mm if bodies.rim_mm is None else None
    wall_mm = bodies.wall_mm
    parts.append(Part(sun.name, sun.outline_mm, width, sun.teeth, 0.0, bore_mm, bodies.rim_mm, fixed, (), wall_mm))
    ways.append(way_of(sun.place, sun.angle, 0))
    traces = []
    for number in range(arms):
        end = f"_{number + 1}" if arms > 1 else ""
        named = {sun.name: sun.name} | {gear.name: gear.name + end for gear in others}
        for gear in others:
            body = f"{gear.fixed_to}{end}" if gear.fixed_to else ""
            made = named[gear.name], gear.outline_mm, width, gear.teeth, step * gear.layer
            parts.append(Part(*made, bodies.bore_mm, None, body, (), wall_mm))
            ways.append(way_of(gear.place, gear.angle, number))
        meshes += [GearMesh(named[gear], named[other], chain.kind) for gear, other in chain.meshes]
        if arm is not None:
            outline = _bar_mm([0j, complex(arm.length_mm)], bodies.bar_width_mm, tolerance_mm)
            name, low = f"arm{end}", step * layers
            parts.append(Part(name, outline, width, 0, low, bodies.bore_mm, None, named["planet"], (), wall_mm))
            ways.append(way_of(chain.carrier_mm, lambda u: arm.angle_rad - chain.planet_rad(u), number))
            traces.append(Trace(f"path{end}", name, (arm.length_mm, 0.0), arm.wished_mm))
    parts.append(_carrier(chain, arms, bodies, tolerance_mm))
    ways.append(lambda driving: (np.zeros_like(driving, dtype=complex), carrier_rad(driving) + stand.start_rad))

    def poses_at(driving_rad: Array) -> Poses:
        found = [way(np.asarray(driving_rad, dtype=float)) for way in ways]
        places = np.array([place for place, _ in found]) + stand.axis_mm
        angles = np.array([angle for _, angle in found])
        return Poses(places.real, places.imag, angles)

    cycle, repeats = 2.0 * pi / abs(against), 1
    if (turns := whole_turns(sun_turns)) is not None:
        cycle, repeats = 2.0 * pi * turns, round(turns * abs(against))
    train = Train(
        tuple(parts),
        tuple(meshes),
        poses_at,
        "carrier",
        cycle,
        speed_rpm,
        tolerance_mm,
        TrainFigures(""),
        tuple(traces),
        repeats,
    )
    return seen_from_behind(train) if stand.clockwise else train


MOST_TURNS, EXACT = 12, 1e-9
"""Most turns of the carrier in a cycle, and the rounding of a ratio of small whole numbers that a file gives."""


def whole_turns(sun_turns: float) -> int | None:
    """The fewest turns of the carrier after which the sun has made whole turns, too; None over MOST_TURNS."""
    near = Fraction(sun_turns).limit_denominator(MOST_TURNS)
    return near.denominator if abs(near - sun_turns) < EXACT else None


def _bar_mm(axes: Sequence[complex], width_mm: float, tolerance_mm: float) -> Array:
    """The outline of all points within half the width of the line through axes, shape (n, 2), counter-clockwise.

    Two or more axes, as complex numbers in mm; round ends are chords within the tolerance.
    """
    from shapely import LineString

    radius = width_mm / 2.0
    quarter = max(ceil(pi / 4.0 / acos(1.0 - min(tolerance_mm / radius, 0.5))), 4)
    area = LineString(as_points(np.asarray(axes))).buffer(radius, quad_segs=quarter)
    outline: Array = np.asarray(area.exterior.coords)[:-1]
    if area.exterior.is_ccw:
        return outline
    return outline[::-1]


def _carrier(chain: ArmChain, arms: int, bodies: Bodies, tolerance_mm: float) -> Part:
    """The carrier under all gears: bars along the axes of every arm, from the sun's axis on."""
    from shapely import Polygon, union_all
    from shapely.geometry.polygon import orient

    axes = list(dict.fromkeys(gear.place for gear in chain.gears))
    turns = [np.exp(2j * pi * number / arms) for number in range(arms)]
    bars = [_bar_mm([axis * turn for axis in axes], bodies.bar_width_mm, tolerance_mm) for turn in turns]
    whole = orient(union_all([Polygon(bar) for bar in bars]).simplify(NEGLIGIBLE_MM))
    holes: Sequence[complex] = [] if bodies.bore_mm is None else [axis * turn for turn in turns for axis in axes[1:]]
    low = -bodies.face_width_mm - GAP_MM
    drilled = tuple(PinHole(hole.real, hole.imag, bodies.bore_mm or 0.0) for hole in holes)
    return Part(
        "carrier",
        np.asarray(whole.exterior.coords)[:-1],
        bodies.face_width_mm,
        0,
        low,
        bodies.bore_mm,
        None,
        "",
        drilled,
        bodies.wall_mm,
    )


NEGLIGIBLE_MM = 1e-4
"""Tolerance that simplifies the outline of united bars: slivers of rounding go, which no mesh of triangles bears."""
