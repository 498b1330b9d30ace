"""The two bearings of a shaft: their forces over the cycle, and their life by ISO 281.

Gears and a crank press on the shaft at places along it; the moments about either bearing give the force on the other
one, in both directions across the shaft at once.  Gears and crank may sit between the bearings or beyond them.

The equivalent load is the mean of the forces over the angle that the shaft turns,

    P = (integral |F|^p dphi / integral dphi)^(1/p),   p = 3 for balls, 10/3 for rollers

and the life that a share of 90 % of the bearings reaches is (C/P)^p million turns.  For other shares S in per cent the
life is multiplied by the factor a_1 of the three-parameter Weibull distribution that ISO 281:2007 is based on,

    a_1 = 0.95 (ln(100/S) / ln(100/90))^(1/1.5) + 0.05

One bearing of a shaft bears the thrust of helical teeth, in both directions; the other gives way along the shaft.  Its
forces F_r across and F_a along the shaft count together, for the life and against dents, as

    F = max(F_r + Y_1 F_a, X_2 F_r + Y_2 F_a),   F_0 = max(F_r, X_0 F_r + Y_0 F_a)

where the larger of both terms is the right one on either side of the standard's limit F_a / F_r = e.

(ISO 281:2007, clauses 5 to 7 and table 3, and ISO/TR 1281-2 for the distribution; ISO 76:2006 for the static safety C_0
/ F_0; all from secondary sources).  Lubrication and dirt (the factor a_ISO) are not counted.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, log, pi, radians, tan

import numpy as np

from ncgear.drivetrain.cycle import Cycle, ShaftLoads
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.extrema import Extremum

EXPONENTS = {"ball": 3.0, "roller": 10.0 / 3.0}
"""Exponent of the life by the kind of bearing."""

MOST_OF_RATING = 0.5
"""Largest load for the life by ISO 281, as a share of the dynamic rating."""

MILLION = 1e6

SECONDS_PER_HOUR = 3600.0


@dataclass(frozen=True)
class Bearing:
    """A bearing: place along the shaft from the gear's middle, kind, ratings in N, stiffness with its housing.

    ``contact_angle_deg`` is that of two rows that bear thrust to both sides; without it balls run in deep grooves, and
    rollers are cylinders.  ``bears_thrust`` is true of the bearing that bears the thrust of its shaft.
    """

    at_mm: float
    kind: str
    dynamic_rating_n: float | None = None
    static_rating_n: float | None = None
    stiffness_n_mm: float | None = None
    contact_angle_deg: float | None = None
    bears_thrust: bool = False


@dataclass(frozen=True)
class Seats:
    """The places along a shaft in mm: its bearings, the middles of its gears, from the first of which all count, and
    its crank."""

    bearings: tuple[Bearing, Bearing]
    gears_mm: tuple[float, ...] = (0.0,)
    crank_at_mm: float = 0.0


@dataclass(frozen=True)
class WantedLife:
    """Hours of operation that a share of the bearings, in per cent, shall reach."""

    hours: float
    reliability_percent: float

    @property
    def factor(self) -> float:
        """a_1."""
        failing = log(100.0 / self.reliability_percent) / log(100.0 / 90.0)
        return float(0.95 * failing ** (1.0 / 1.5) + 0.05)


@dataclass(frozen=True)
class BearingLife:
    """Loads and life of a bearing.

    ``largest_n`` is its largest force across the shaft with the driving angle, ``thrust_n`` the same along the shaft,
    ``static_n`` the largest of both together; ``equivalent_n`` is its equivalent load at ``speed_rad_s``, its mean
    speed.  ``needed_rating_n`` is the dynamic rating for the wanted life.  ``life_h`` and ``static_safety`` need the
    ratings and a load; else they are None.  ``within_iso_281`` is false where the load is over half the rating.
    """

    bearing: Bearing
    largest_n: Extremum
    thrust_n: Extremum
    static_n: float
    equivalent_n: float
    speed_rad_s: float
    needed_rating_n: float
    life_h: float | None
    static_safety: float | None
    within_iso_281: bool | None


def bearing_forces(loads: ShaftLoads, seats: Seats) -> tuple[ComplexArray, ComplexArray]:
    """The forces as x + i y in N that press on both bearings, shape (n,) each."""
    first, second = (bearing.at_mm for bearing in seats.bearings)
    pressing = [*(gear.force_n for gear in loads.gears), loads.crank_n]
    arms = (at_mm - first for at_mm in (*seats.gears_mm, seats.crank_at_mm))
    couples = (gear.couple_n_mm for gear in loads.gears)
    on_second = sum((*(force * arm for force, arm in zip(pressing, arms, strict=True)), *couples)) / (second - first)
    return np.asarray(sum(pressing) - on_second), np.asarray(on_second)


DEEP_GROOVE = np.array(
    [[0.172, 0.345, 0.689, 1.03, 1.38, 2.07, 3.45, 5.17, 6.89], [2.3, 1.99, 1.71, 1.55, 1.45, 1.31, 1.15, 1.04, 1.0]]
)
"""f_0 F_a / C_0 of deep groove ball bearings and their Y_2; X_2 is 0.56."""

F_0 = 12.3
"""f_0 of deep groove ball bearings, 12 to 16 in ISO 76: the value of tables that take F_a / C_0 alone, on the
safe side."""

ANGULAR_BALLS = np.array(
    [[20.0, 30.0, 40.0], [1.09, 0.78, 0.55], [0.7, 0.63, 0.57], [1.63, 1.24, 0.93], [0.84, 0.66, 0.52]]
)
"""Contact angle in degrees of two rows of balls, and Y_1, X_2, Y_2 and Y_0: the least factors count beyond 40 deg."""


def combined_n(bearing: Bearing, across_n: Array, along_n: Array) -> tuple[Array, Array]:
    """F and F_0 in N of forces across the shaft and sizes of its thrust, shape (n,) each.

    A bearing that bears thrust is a ball bearing or has a contact angle, and balls in deep grooves a static rating.
    """
    if not bearing.bears_thrust or not along_n.any():
        return across_n, across_n
    angle = bearing.contact_angle_deg
    if angle is None:
        assert bearing.static_rating_n is not None
        y1, x2, x0, y0 = 0.0, 0.56, 0.6, 0.5
        y2 = np.interp(F_0 * along_n / bearing.static_rating_n, *DEEP_GROOVE)
    elif bearing.kind == "ball":
        (y1, x2, y2, y0), x0 = (np.interp(angle, ANGULAR_BALLS[0], row) for row in ANGULAR_BALLS[1:]), 1.0
    else:
        steep = 1.0 / tan(radians(angle))
        y1, x2, y2, x0, y0 = 0.45 * steep, 0.67, 0.67 * steep, 1.0, 0.44 * steep
    lasting = np.maximum(across_n + y1 * along_n, x2 * across_n + y2 * along_n)
    return lasting, np.maximum(across_n, x0 * across_n + y0 * along_n)


BALLS = 9
"""Balls of a usual bearing."""

BALL_RATING = 126.0
"""Static rating in N of a usual ball bearing for each square mm of a ball's diameter: ISO 76 with f_0 = 14."""

ROLLERS, ROLLER_LENGTH = 15, 1.2
"""Rollers of a usual bearing, and their length in diameters."""

ROLLER_RATING = 673.0
"""The same for rollers: 44 (1 - D / d_pw) Z l / D of ISO 76 with D / d_pw = 0.15."""

MOST_LOADED = 5.0
"""Load of the most loaded ball or roller over the mean load, with usual play."""


def stiffness_n_mm(bearing: Bearing, force_n: float) -> float:
    """The stiffness of a bearing across its axis in N/mm under its largest force; infinite where it is unknown.

    By A. Palmgren's approximations for steel (T. A. Harris, "Rolling Bearing Analysis", from secondary sources), with Q
    the force on the most loaded ball or roller, D its diameter and l its length: 4.36e-4 Q^(2/3) / D^(1/3) mm for
    balls, 7.68e-5 Q^0.9 / l^0.8 mm for rollers.  Number and size are those of usual bearings with this static rating:
    the balls of 6210 come out within a tenth.
    """
    if bearing.stiffness_n_mm is not None:
        return bearing.stiffness_n_mm
    if bearing.static_rating_n is None or force_n <= 0.0:
        return inf
    if bearing.kind == "ball":
        diameter, most = (bearing.static_rating_n / BALL_RATING) ** 0.5, MOST_LOADED * force_n / BALLS
        return float(force_n / (4.36e-4 * most ** (2.0 / 3.0) / diameter ** (1.0 / 3.0)))
    length, most = ROLLER_LENGTH * (bearing.static_rating_n / ROLLER_RATING) ** 0.5, MOST_LOADED * force_n / ROLLERS
    return float(force_n / (7.68e-5 * most**0.9 / length**0.8))


def bending_moment_n_mm(loads: ShaftLoads, seats: Seats, at_mm: float) -> ComplexArray:
    """The bending moment at a place along the shaft, (n,), as x + i y in the direction of the forces.

    The side with fewer forces is taken: beyond the outermost place it gives zero, without rounding errors.  A couple
    makes it leap at the middle of its gear; ``gear_sides`` are the places beside it.
    """
    on_first, on_second = bearing_forces(loads, seats)
    places = *seats.gears_mm, seats.crank_at_mm, seats.bearings[0].at_mm, seats.bearings[1].at_mm
    forces = *(gear.force_n for gear in loads.gears), loads.crank_n, -on_first, -on_second
    way = -1.0 if sum(place > at_mm for place in places) >= len(places) / 2 else 1.0
    beyond = (force * max(way * (place - at_mm), 0.0) for place, force in zip(places, forces, strict=True))
    gears = zip(seats.gears_mm, loads.gears, strict=True)
    couples = (way * gear.couple_n_mm for place, gear in gears if way * (at_mm - place) < 0.0)
    return np.asarray(sum((*couples, *beyond)))


BESIDE_MM = 1e-9
"""Way from the middle of a gear to the places beside it: less than rounding errors of moments."""


def gear_sides_mm(loads: ShaftLoads, at_mm: float = 0.0) -> tuple[float, ...]:
    """The places at which a shaft's bending is looked at by the gear at a place: two where thrust tilts a gear."""
    return (at_mm - BESIDE_MM, at_mm + BESIDE_MM) if loads.thrust_n.any() else (at_mm,)


@dataclass(frozen=True)
class Bend:
    """The largest bending moment along a shaft in N mm, and its place in mm from the middle of the gear."""

    moment_n_mm: float
    at_mm: float


def bending_places_mm(loads: ShaftLoads, seats: Seats) -> tuple[float, ...]:
    """The places along a shaft at which its bending may be largest: where forces press on it, gears from both sides."""
    sides = (at for gear_mm in seats.gears_mm for at in gear_sides_mm(loads, gear_mm))
    return tuple({*sides, seats.crank_at_mm, *(bearing.at_mm for bearing in seats.bearings)})


def most_bent(moments_n_mm: Mapping[float, float], seats: Seats) -> Bend:
    """The largest bending of a shaft, by its largest moments at places along it; beside a gear, at the gear."""
    most = max(moments_n_mm, key=lambda at: moments_n_mm[at])
    near = (at for at in seats.gears_mm if abs(most - at) <= BESIDE_MM)
    return Bend(moments_n_mm[most], next(near, most))


def equivalent_load_n(force_n: Array, weight: Array, exponent: float) -> float:
    """Mean of the forces (shape (n,)) to the power ``exponent``, weighted by the angle turned; 0 without forces."""
    largest = float(np.max(force_n, initial=0.0))
    if largest == 0.0:
        return 0.0
    mean = float(np.sum(weight * (force_n / largest) ** exponent) / np.sum(weight))
    root: float = mean ** (1.0 / exponent)
    return largest * root


def life_h(rating_n: float, load_n: float, kind: str, speed_rad_s: float, factor: float = 1.0) -> float:
    """Hours that a bearing lasts under an equivalent load over 0."""
    turns = factor * MILLION * (rating_n / load_n) ** EXPONENTS[kind]
    return float(turns * 2.0 * pi / speed_rad_s / SECONDS_PER_HOUR)


def rating_for_n(load_n: float, kind: str, speed_rad_s: float, wanted: WantedLife) -> float:
    """The dynamic rating with which a bearing reaches the wanted life."""
    turns = wanted.hours * SECONDS_PER_HOUR * speed_rad_s / (2.0 * pi)
    powered: float = (turns / (MILLION * wanted.factor)) ** (1.0 / EXPONENTS[kind])
    return load_n * powered


@dataclass(frozen=True)
class BornePeaks:
    """Largest loads of a bearing: force across the shaft, F_0, and thrust, in N with their driving angles."""

    across_n: Extremum
    denting_n: Extremum
    thrust_n: Extremum


def bearing_lives(
    cycle: Cycle, number: int, seats: Seats, wanted: WantedLife, peaks: tuple[BornePeaks, BornePeaks]
) -> tuple[BearingLife, BearingLife]:
    """Both bearings of a shaft, counted from the driving shaft on, with their largest loads."""
    whole = cycle.loads.shafts[number]
    weight = cycle.weight_rad * whole.slope
    speed = cycle.speed_rad_s * float(weight.sum()) / cycle.cycle_rad
    first, second = (
        _life(bearing, equivalent_load_n(lasting, weight, EXPONENTS[bearing.kind]), peak, speed, wanted)
        for bearing, (lasting, *_), peak in zip(seats.bearings, _borne(whole, seats), peaks, strict=True)
    )
    return first, second


def _borne(loads: ShaftLoads, seats: Seats) -> list[tuple[Array, Array, Array, Array]]:
    """F, the force across the shaft, F_0 and the thrust in N of both bearings, shape (n,) each."""
    found, thrust = [], np.abs(loads.thrust_n)
    for bearing, force in zip(seats.bearings, bearing_forces(loads, seats), strict=True):
        across, along = np.abs(force), thrust * bearing.bears_thrust
        lasting, denting = combined_n(bearing, across, along)
        found.append((lasting, across, denting, along))
    return found


def borne_sizes(loads: ShaftLoads, seats: Seats) -> list[Array]:
    """Force across the shaft, F_0 and thrust in N of the first bearing and then of the second, shape (n,) each."""
    return [size for _, *sizes in _borne(loads, seats) for size in sizes]


def _life(bearing: Bearing, load_n: float, peaks: BornePeaks, speed: float, wanted: WantedLife) -> BearingLife:
    rating, static = bearing.dynamic_rating_n, bearing.static_rating_n
    loaded, denting_n = load_n > 0.0, peaks.denting_n.value
    return BearingLife(
        bearing,
        peaks.across_n,
        peaks.thrust_n,
        denting_n,
        load_n,
        speed,
        rating_for_n(load_n, bearing.kind, speed, wanted),
        life_h(rating, load_n, bearing.kind, speed, wanted.factor) if rating and loaded else None,
        static / denting_n if static and loaded else None,
        load_n <= MOST_OF_RATING * rating if rating else None,
    )
