"""A law by the pitch curve of one gear: its mate is the curve that rolls on it, at the distance that closes it.

With r(phi) the radius of the given curve where it faces the mate, phi the angle that its gear has turned, and a the
centre distance, the mate turns by dpsi = r / (a - r) dphi (F. L. Litvin et al., "Noncircular Gears", Cambridge 2009,
chapter 2; A. Pogacnik, "Non-circular gears", KISSsoft AG 2022, section 2).  With n lobes of the given gear and m of its
mate, the mate closes where

    integral of r / (a - r) over 2 pi / n  =  2 pi / m.

The integral falls strictly with a, from infinity where a is the greatest radius, and by Jensen's inequality the
integral is still too large at a = (1 + m / n) times the mean radius, and too small at (1 + m / n) times the greatest
one: one distance closes, and it lies between.  Where a is given, curves that lie inside each other make the integral
grow with the shape parameter that is sought, so again at most one value closes the mate.

In an internal pair the mate's radius is r + a where the mate is the ring, and r - a where the curve is the ring's (the
same sources).  The integral of r / (r + a) falls strictly with a, of r / (r - a) it grows, and Jensen's inequality
puts the one distance that closes between |m / n - 1| times the least radius and as many times the mean one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from functools import partial
from math import inf, tau
from typing import TypeVar

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev, jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.chebyshev import NotSmooth, PiecewiseChebyshev
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import in_words
from ncgear.numerics.zeros import zeros_between
from ncgear.ratio.laws.closed_curve import JOINED, ClosedCurve, Radius, SmoothPart
from ncgear.ratio.laws.integrated import Slope, integrated_law, smooth_or_refused
from ncgear.ratio.transmission import Lobes, Piece, Transmission

NEAREST = 1.0001
"""Least centre distance over the greatest radius: nearer, the mate would turn 10 000 times as fast as the gear."""

ROUNDING = 1e-12
"""Largest relative difference of equal places and turns: far more than their rounding errors."""

ALIKE = 200
"""Angles of a lobe at which it is compared with the other lobes."""


Radii = TypeVar("Radii", Array, Jet)


class Mate(Enum):
    """Where the mate of a gear lies, and the signs of its radius by the centre distance and the gear's radius."""

    BESIDE = (1.0, -1.0)
    ABOUT = (1.0, 1.0)
    WITHIN = (-1.0, 1.0)

    def turned_per(self, radius: Radii, center_distance_mm: float) -> Radii:
        """Speed of the mate over the gear's speed, for radii in mm."""
        distance, own = self.value
        return radius / (distance * center_distance_mm + own * radius)


@dataclass(frozen=True)
class ShapeSearch:
    """A shape parameter between two values; a greater value makes the curve larger throughout, or smaller."""

    low: float
    high: float
    key: str
    unit: str = " mm"


@dataclass(frozen=True, eq=False)
class GivenCurve:
    """A gear's curve as a function of the value that is found; without a ``search`` every value gives the same curve.

    Angles of a ``drawn`` curve are polar angles in the gear; other curves have the gear's turn at which the place faces
    the mate.  The gear has turned by ``phase_rad`` when angle 0 faces the mate.
    """

    curve_of: Callable[[float], ClosedCurve]
    search: ShapeSearch | None
    drawn: bool
    driven: bool
    phase_rad: float
    key: str
    internal: bool = False

    @property
    def mate(self) -> Mate:
        """Where the mate lies."""
        return (Mate.WITHIN if self.driven else Mate.ABOUT) if self.internal else Mate.BESIDE

    def facing(self, value: float) -> ClosedCurve:
        """The curve by the angle that its gear has turned.

        A place at a polar angle faces the mate of a driving gear, or of a ring, when the gear has turned back by it,
        and the mate of another driven gear, which turns the other way, when the gear has turned on by it.
        """
        curve = self.curve_of(value)
        curve.require_gear(self.key)
        mirrored = self.drawn and (self.internal or not self.driven)
        return (curve.mirrored() if mirrored else curve).turned(self.phase_rad)


@dataclass(frozen=True, eq=False)
class ClosedLaw:
    """A law, its centre distance in mm, and the value of the shape or the scale that closes it (1 for no scaling)."""

    transmission: Transmission
    center_distance_mm: float
    value: float


def closed_law(given: GivenCurve, lobes: Lobes, center_distance_mm: float | None) -> ClosedLaw:
    """The law of a curve and its mate.

    Without a given centre distance, the distance closes the mate; with one, the scale of the curve closes it, or the
    value that is searched.  Raises NoSuchMechanism for a curve that is no gear, and where nothing closes the mate.
    """
    own = (lobes.driven, lobes.driving) if given.driven else (lobes.driving, lobes.driven)
    make = partial(driven_curve_law if given.driven else driving_curve_law, lobes=lobes, key=given.key, mate=given.mate)
    if given.search is not None and center_distance_mm is not None:
        value = closing_value(given.curve_of, given.search, center_distance_mm, own)
        return ClosedLaw(make(given.facing(value), center_distance_mm), center_distance_mm, value)
    curve = given.facing(1.0)
    closing = closing_distance_mm(curve, *own, given.key, given.mate)
    transmission = make(curve, closing)
    if center_distance_mm is None:
        return ClosedLaw(transmission, closing, 1.0)
    # Curve and mate have the same law at any size.
    return ClosedLaw(transmission, center_distance_mm, center_distance_mm / closing)


@dataclass(frozen=True, eq=False)
class TurnedBy:
    """The mate's whole turn while a gear with a curve makes one turn, as a function of the centre distance.

    ``weighted`` (two columns) are radius in mm and d angle by a common parameter of all stretches.
    """

    weighted: PiecewiseChebyshev
    least_mm: float
    greatest_mm: float
    mate: Mate = Mate.BESIDE

    @property
    def limits_mm(self) -> tuple[float, float]:
        """The centre distances between which the mate has a radius everywhere."""
        match self.mate:
            case Mate.BESIDE:
                return NEAREST * self.greatest_mm, inf
            case Mate.ABOUT:
                return 0.0, inf
            case Mate.WITHIN:
                return 0.0, self.least_mm / NEAREST

    def at(self, center_distance_mm: float) -> float:
        """The mate's turn in rad; infinite beyond the limits of the centre distance."""
        least, most = self.limits_mm
        if not least <= center_distance_mm <= most:
            return inf

        def slope(at: Array) -> Array:
            radius, angle = self.weighted(at).T
            return self.mate.turned_per(radius, center_distance_mm) * angle

        return chebyshev.fitted(slope, self.weighted.breaks).integrated().final

    @property
    def mean_mm(self) -> float:
        """Mean radius over the angle."""
        form = self.weighted
        product = chebyshev.fitted(lambda at: form(at).prod(axis=1), form.breaks)
        return product.integrated().final / tau


def turned_by(curve: ClosedCurve, key: str, mate: Mate = Mate.BESIDE) -> TurnedBy:
    """The mate's turn for a curve; raises NoSuchMechanism for a curve that cannot be resolved."""
    forms, start = [], 0.0
    for stretch in curve.stretches:
        columns = _columns(stretch, stretch.start - start)
        try:
            forms.append(chebyshev.fitted(columns, stretch.breaks - stretch.start + start))
        except NotSmooth as fault:
            at = float(stretch.polar(np.array([fault.at + stretch.start - start]), 0)[0].value[0])
            raise NoSuchMechanism(
                f"the pitch curve is not smooth near the polar angle {in_words(at % tau)}", key=key
            ) from fault
        start += stretch.end - stretch.start
    return TurnedBy(chebyshev.joined(forms), *curve.radius_range_mm, mate)


def _columns(stretch: SmoothPart, shift: float) -> Callable[[Array], Array]:
    def columns(at: Array) -> Array:
        angle, radius = stretch.polar(at + shift, 1)
        return np.column_stack([radius.value, angle.derivative(1)])

    return columns


def closing_distance_mm(
    curve: ClosedCurve, repeats: int, mate_repeats: int, key: str, mate: Mate = Mate.BESIDE
) -> float:
    """The centre distance at which the mate closes, from the lobes of the curve and of the mate.

    Raises NoSuchMechanism where no centre distance turns the mate far enough, and for a ring that has no more lobes
    than the gear within.
    """
    turned, wanted = turned_by(curve, key, mate), tau * repeats / mate_repeats
    share = _share(repeats, mate_repeats, mate)
    least, most = turned.limits_mm
    radii = (turned.mean_mm, turned.greatest_mm) if mate is Mate.BESIDE else (turned.least_mm, turned.mean_mm)
    # The mean, the least and the greatest radius of a circle are the same but for rounding errors.
    low, high = max(least, share * radii[0] * (1.0 - ROUNDING)), min(most, share * radii[1] * (1.0 + ROUNDING))
    # The mate turns furthest where its least radius is smallest: beside or within the curve at the limit.
    furthest, place = (high, "least") if mate is Mate.WITHIN else (low, "greatest")
    if not turned.at(furthest) >= wanted * (1.0 - ROUNDING):
        raise NoSuchMechanism(
            f"the mate does not close: even at a centre distance of {furthest:.6g} mm, next to the curve's {place} "
            f"radius, it turns by {turned.at(furthest):.4g} rad where it must turn by {wanted:.4g}; a curve of less "
            "varying radius is needed",
            key=key,
        )
    return _zero(lambda distance: wanted / turned.at(distance) - 1.0, low, high)


def _share(repeats: int, mate_repeats: int, mate: Mate) -> float:
    """Centre distance of circles over the given one's radius; raises NoSuchMechanism for a ring with too few lobes."""
    if mate is Mate.BESIDE:
        return 1.0 + mate_repeats / repeats
    inner, ring = (repeats, mate_repeats) if mate is Mate.ABOUT else (mate_repeats, repeats)
    if ring <= inner:
        raise NoSuchMechanism(
            f"internal, but with {inner}:{ring} lobes the ring would be no larger than the gear within; more lobes of "
            "the driven gear than of the driving one are needed",
            key="gears.mesh",
        )
    return abs(mate_repeats / repeats - 1.0)


def closing_value(
    curve_of: Callable[[float], ClosedCurve], search: ShapeSearch, center_distance_mm: float, lobes: tuple[int, int]
) -> float:
    """The value of a shape parameter that closes the mate at a given centre distance; ``lobes`` of gear and mate.

    Raises NoSuchMechanism where no value of the range closes it.
    """
    wanted = tau * lobes[0] / lobes[1]

    def missing(value: float) -> float:
        return wanted / turned_by(curve_of(value), search.key).at(center_distance_mm) - 1.0

    ends = missing(search.low), missing(search.high)
    if not min(ends) <= 0.0 <= max(ends):
        ever = "too far" if max(ends) < 0.0 else "not far enough"
        raise NoSuchMechanism(
            f"no value closes the mate at a centre distance of {center_distance_mm:g} mm: from {search.low:.6g} to "
            f"{search.high:.6g}{search.unit} the mate turns {ever}; a centre distance further "
            f"{'apart' if max(ends) < 0.0 else 'together'} is needed, or another size of the curve",
            key=search.key,
        )
    return _zero(missing, search.low, search.high)


def _zero(function: Callable[[float], float], low: float, high: float) -> float:
    ends = np.array([low]), np.array([high])
    return float(zeros_between(lambda at: np.array([function(float(at[0]))]), *ends)[0])


def driving_curve_law(
    curve: ClosedCurve, center_distance_mm: float, lobes: Lobes, key: str, mate: Mate = Mate.BESIDE
) -> Transmission:
    """The law of a driving gear whose curve's angle is the driving angle at which that place faces the mate.

    Raises NoSuchMechanism for a curve with fewer lobes than the gear, or a mate that does not close.
    """
    radii = _one_lobe(curve, lobes.driving, key)
    slopes = [_slope(radius, center_distance_mm, key, mate) for radius in radii]
    return integrated_law(slopes, lobes, scale_to_close=False, key=key)


def driven_curve_law(
    curve: ClosedCurve, center_distance_mm: float, lobes: Lobes, key: str, mate: Mate = Mate.BESIDE
) -> Transmission:
    """The law of a driven gear whose curve's angle is the driven angle; the inverse of the mate's law.

    Raises NoSuchMechanism for a curve with fewer lobes than the gear, or a mate that does not close.
    """
    radii = _one_lobe(curve, lobes.driven, key)
    swapped = Lobes(lobes.driven, lobes.driving)
    slopes = [_slope(radius, center_distance_mm, key, mate) for radius in radii]
    by_driven = integrated_law(slopes, swapped, scale_to_close=False, key=key)
    with smooth_or_refused(key):
        return Transmission(
            tuple(_inverse(piece, slope) for piece, slope in zip(by_driven.pieces, slopes, strict=True)), lobes
        )


def _one_lobe(curve: ClosedCurve, repeats: int, key: str) -> tuple[Radius, ...]:
    """The radius over the first lobe; refuses a curve whose lobes differ."""
    period = tau / repeats
    with smooth_or_refused(key):
        first = curve.radii(0.0, period)
        for number in range(1, repeats):
            other = curve.radii(number * period, (number + 1) * period)
            _require_alike(first, other, period, number, key)
    return first


def _require_alike(first: Sequence[Radius], other: Sequence[Radius], period: float, number: int, key: str) -> None:
    angles: Array = np.linspace(0.5, ALIKE - 0.5, ALIKE) * (period / ALIKE)
    radii = _values(first, angles), _values(other, np.add(angles, number * period, dtype=float))
    differing = np.abs(radii[1] - radii[0])
    worst = int(np.argmax(differing))
    if differing[worst] > JOINED * np.max(radii[0]):
        turns = number * period
        raise NoSuchMechanism(
            f"the gear shall have {round(tau / period)} equal lobes, but the radius of the pitch curve is "
            f"{radii[0][worst]:.6g} mm at phi = {in_words(float(angles[worst]))} and {radii[1][worst]:.6g} mm at "
            f"{in_words(float(angles[worst]) + turns)}; give lobes that the curve has, or another curve",
            key=key,
        )


def _values(radii: Sequence[Radius], angles: Array) -> Array:
    which = np.searchsorted([radius.start_rad for radius in radii[1:]], angles, side="right")
    values = np.empty_like(angles)
    for number, radius in enumerate(radii):
        values[which == number] = radius.at(angles[which == number], 0).value
    return values


def _slope(radius: Radius, center_distance_mm: float, key: str, mate: Mate) -> Slope:
    jets = partial(rolled, radius, center_distance_mm, mate)
    with smooth_or_refused(key):
        return Slope(jets, chebyshev.fitted(lambda phi: jets(phi, 0).value, radius.breaks_rad).integrated())


def rolled(radius: Radius, center_distance_mm: float, mate: Mate, phi: Array, order: int) -> Jet:
    """Speed of the mate over the gear's, with derivatives by the angle of the gear whose radius is given."""
    return mate.turned_per(radius.at(phi, order), center_distance_mm)


def _inverse(piece: Piece, slope: Slope) -> Piece:
    """The driven angle by the driving angle, from the driving angle by the driven angle."""
    breaks = np.array([piece.start_rad, *piece.knots_rad, piece.end_rad])
    driving = piece.driven_angle(breaks, 0).value

    def angle(phi1: Array) -> Array:
        place = np.clip(np.searchsorted(driving, phi1, side="right"), 1, breaks.size - 1)
        ends = driving[place - 1] - phi1, driving[place] - phi1
        return zeros_between(
            lambda phi2: piece.driven_angle(phi2, 0).value - phi1, breaks[place - 1], breaks[place], ends
        )

    form = chebyshev.fitted(angle, driving)
    knots = tuple(form.breaks[1:-1].tolist())
    return Piece(float(driving[0]), float(driving[-1]), partial(inverted_angle, form, piece), knots)


def inverted_angle(form: PiecewiseChebyshev, mate: Piece, phi1: Array, order: int) -> Jet:
    """phi2 in rad with derivatives; ``mate`` is phi1 over phi2, ``form`` its inverse."""
    values = form(phi1)
    if not order:
        return Jet(values[None, :])
    speed = 1.0 / mate.driven_angle(values, order).differentiated()
    return jet.by_other(values, speed, speed)
