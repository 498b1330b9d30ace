"""The value of every motion law: a function phi2(phi1), its gears, and the mechanism that they drive.

A ``Transmission`` gives the driven angle with derivatives on consecutive pieces of one period.  With lobes n1:n2 the
driving gear repeats its curve n1 times a turn and the driven gear n2 times; one period takes 2 pi / n1 of the driving
angle and 2 pi / n2 of the driven angle.  An open law, of gears that turn to and fro over less than a turn, has a range
of both angles in place of lobes; teeth stand on its closed continuation to whole turns (ncgear.pitch.continued), and
only the range is made.  A ``PairsInSeries`` is one pair of gears, or two in series, between the driving shaft and the
crank.  A ``Law`` is these pairs and the mechanism that they drive, with the facts of a prescribed stroke.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from itertools import pairwise
from math import degrees, fsum, gcd, pi
from operator import attrgetter

import numpy as np

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum, bounds_on, extremes_on, grid_between
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import integrated_slope
from ncgear.numerics.units import in_words
from ncgear.shown import Shown

JetFunction = Callable[[Array, int], Jet]
"""Function of driving angles in rad, shape (n,), and an order: the driven angle in rad with its derivatives."""

OfSlope = Callable[[Jet], Jet]
"""Function of the jet of dphi2/dphi1 by phi1: the jet of a quantity, of lower order if it takes derivatives."""

CLOSED = 1e-12
"""Closure error in rad that counts as zero: about 500 rounding errors of a full turn (tests/test_compensation.py)."""

STANDSTILL = 1e-6
"""Share of its largest speed below which the driven gear counts as standing still.

The pitch radius would be as small a share of the centre distance; teeth cannot even follow a ratio of 1:100.
"""


@dataclass(frozen=True)
class Lobes:
    """How often each gear's pitch curve repeats in a turn."""

    driving: int = 1
    driven: int = 1

    def require_one_cycle(self) -> None:
        """Refuse a driven gear of several lobes for a law that is one cycle of the slider; raises WrongInput."""
        if self.driven != 1:
            raise WrongInput(
                f"{self.driven} lobes of the driven gear, but a slider's law is one cycle of the crank, "
                "which is one turn of the driven gear; 1 is right",
                key="gears.lobes.driven",
            )

    @property
    def teeth_step(self) -> int:
        """Divisor of the number of driving teeth that makes the number of driven teeth whole."""
        return self.driving // gcd(self.driving, self.driven)

    @property
    def driving_period_rad(self) -> float:
        """Driving angle of one period."""
        return 2.0 * pi / self.driving

    @property
    def driven_period_rad(self) -> float:
        """Driven angle of one period."""
        return 2.0 * pi / self.driven

    @property
    def even_slope(self) -> float:
        """dphi2/dphi1 of gears that turn evenly."""
        return self.driving / self.driven

    @property
    def range(self) -> OpenRange | None:
        """The range of both angles of an open law, or of its continuation; None where gears turn on and on."""
        return None

    @property
    def repeats(self) -> bool:
        """Whether the law goes on after a period as it began; an open law ends."""
        return True


@dataclass(frozen=True)
class OpenRange(Lobes):
    """The range of an open law: both angles from 0 to these, which take the place of a period."""

    driving_rad: float = field(kw_only=True)
    driven_rad: float = field(kw_only=True)

    @property
    def driving_period_rad(self) -> float:
        """The driving angle of the range."""
        return self.driving_rad

    @property
    def driven_period_rad(self) -> float:
        """The driven angle of the range."""
        return self.driven_rad

    @property
    def even_slope(self) -> float:
        """dphi2/dphi1 of gears that turn evenly."""
        return self.driven_rad / self.driving_rad

    @property
    def range(self) -> OpenRange:
        """The range itself."""
        return self

    @property
    def repeats(self) -> bool:
        """An open law ends."""
        return False


@dataclass(frozen=True)
class WholeTurns(Lobes):
    """The period of an open law's continuation: whole turns of both gears; only the range ``of`` is made."""

    of: OpenRange = field(kw_only=True)
    driving_turns: int = field(kw_only=True)
    driven_turns: int = field(kw_only=True)

    @property
    def driving_period_rad(self) -> float:
        """Driving angle of one period."""
        return 2.0 * pi * self.driving_turns

    @property
    def driven_period_rad(self) -> float:
        """Driven angle of one period."""
        return 2.0 * pi * self.driven_turns

    @property
    def range(self) -> OpenRange:
        """The range that is made."""
        return self.of


@dataclass(frozen=True)
class Piece:
    """A stretch of the period on which the driven angle is smooth, ends included as one-sided limits.

    ``knots_rad`` are inner points where only a high derivative jumps, as in a spline.  ``driven_angle`` is a function
    of its module bound to the law's numbers by ``partial``, or the method of a value, so that ``ncgear.formulas`` knows
    its formula.
    """

    start_rad: float
    end_rad: float
    driven_angle: JetFunction
    knots_rad: tuple[float, ...] = ()

    @property
    def turned_rad(self) -> float:
        """The integral of dphi2/dphi1, which judges the driven angle's growth."""
        breaks = np.array([self.start_rad, *self.knots_rad, self.end_rad])
        return integrated_slope(lambda phi1: self.driven_angle(phi1, 1), breaks)

    def slope(self, phi1: Array, order: int) -> Jet:
        """dphi2/dphi1 = 1/i12 with derivatives by phi1."""
        return self.driven_angle(phi1, order + 1).differentiated()

    def extremes(self, quantities: Sequence[OfSlope], lost: int) -> list[tuple[Extremum, Extremum]]:
        """Smallest and largest values on the piece of quantities that take ``lost`` derivatives of dphi2/dphi1.

        A quantity maps the jet of dphi2/dphi1 to a jet whose order is less by ``lost``, which is 0, 1 or 2.
        """
        grid, known = self._sampled_slope

        def by_angle(phi1: Array) -> list[Jet]:
            # Extremes are searched on one grid, at which the law is computed once.
            slope = known.truncated(lost + 1) if phi1 is grid else self.slope(phi1, lost + 1)
            return [quantity(slope) for quantity in quantities]

        return extremes_on(by_angle, grid)

    @property
    def slope_bounds(self) -> tuple[float, float]:
        """Bounds of dphi2/dphi1 on the piece, as ``bounds_on``."""
        return bounds_on(*self._sampled_slope)

    @cached_property
    def _sampled_slope(self) -> tuple[Array, Jet]:
        """Driving angles between which extremes are searched, and dphi2/dphi1 there with three derivatives."""
        grid = grid_between(self.start_rad, self.end_rad, np.array(self.knots_rad))
        return grid, self.slope(grid, 3)


class DrivenGearStops(NoSuchMechanism):
    """A law whose driven gear does not advance everywhere; ``at_rad`` is the driving angle where it advances least."""

    def __init__(self, slope: Extremum) -> None:
        super().__init__(
            f"the driven gear stops or turns back at phi1 = {in_words(slope.at)}, where "
            f"dphi2/dphi1 = {slope.value:.4g}; the ratio must stay positive and finite",
            key="motion",
        )
        self.at_rad = slope.at


@dataclass(frozen=True, eq=False)
class Transmission(Shown):
    """A law phi2(phi1); raises NoSuchMechanism where the ratio is not positive and finite."""

    pieces: tuple[Piece, ...]
    lobes: Lobes

    def __post_init__(self) -> None:
        low, high = zip(*(piece.slope_bounds for piece in self.made_pieces), strict=True)
        if min(low) > STANDSTILL * max(high):
            return
        fastest = self.slope_range[1].value
        for extremum in self.slope_range:
            if not (np.isfinite(extremum.value) and extremum.value > STANDSTILL * abs(fastest)):
                raise DrivenGearStops(extremum)

    def __repr__(self) -> str:
        low, high = (extremum.value for extremum in self.ratio_range)
        covered = self.lobes.range
        lobes = f"{self.lobes.driving}:{self.lobes.driven} lobes"
        if covered is not None:
            lobes = f"open, {degrees(covered.driving_rad):.4g} to {degrees(covered.driven_rad):.4g} deg"
        return f"Transmission(ratio {low:.4g} to {high:.4g}, {lobes}, {len(self.pieces)} pieces)"

    @property
    def joints_rad(self) -> Array:
        """Driving angles between which the law is analytic: ends of pieces and their knots, from 0 to the period."""
        starts = [angle for piece in self.pieces for angle in (piece.start_rad, *piece.knots_rad)]
        return np.array([*starts, self.pieces[-1].end_rad])

    @property
    def made_pieces(self) -> tuple[Piece, ...]:
        """The pieces on which gears are made: of an open law's continuation only the pieces of its range."""
        covered = self.lobes.range
        if covered is None or not self.lobes.repeats:
            return self.pieces
        return tuple(piece for piece in self.pieces if piece.start_rad < covered.driving_rad)

    @property
    def made(self) -> Transmission:
        """The law on which gears are made: itself, or for the continuation of an open law the law on its range."""
        covered = self.lobes.range
        return self if covered is None else Transmission(self.made_pieces, covered)

    @property
    def meeting_pieces(self) -> list[tuple[Piece, Piece]]:
        """Neighbouring pieces on which gears are made, the earlier piece first, also across a seam that is made."""
        pieces = self.made_pieces
        if self.lobes.range is not None:
            return list(pairwise(pieces))
        return list(zip((pieces[-1], *pieces[:-1]), pieces, strict=True))

    @property
    def cycle_rad(self) -> float:
        """Driving angle of one turn of the driven gear, which is one cycle of the slider."""
        return self.lobes.driven * self.lobes.driving_period_rad

    @cached_property
    def closure_error_rad(self) -> float:
        """Difference of the driven angle at the end of the driving period from its period.

        Two judges compute it, and the worse result counts: the driven angle there, and the integral of 1/i12 over the
        period at points that no law uses.
        """
        last, period = self.pieces[-1], self.lobes.driven_period_rad
        there = float(last.driven_angle(np.array([last.end_rad]), 0).value[0])
        turned = fsum(piece.turned_rad for piece in self.pieces)
        return max(there - period, turned - period, key=abs)

    @cached_property
    def slope_range(self) -> tuple[Extremum, Extremum]:
        """Smallest and largest dphi2/dphi1 over the period."""
        return self.extremes(lambda slope: slope, 0)

    def extremes(self, quantity: OfSlope, lost: int) -> tuple[Extremum, Extremum]:
        """Smallest and largest value of a quantity of dphi2/dphi1, as in ``Piece``, over the pieces that are made."""
        return self.extremes_of_each([quantity], lost)[0]

    def extremes_of_each(self, quantities: Sequence[OfSlope], lost: int) -> list[tuple[Extremum, Extremum]]:
        """As ``extremes``, for several quantities, in less time than one by one."""
        by_piece = [piece.extremes(quantities, lost) for piece in self.made_pieces]
        value = attrgetter("value")
        return [
            (min((low for low, _ in found), key=value), max((high for _, high in found), key=value))
            for found in zip(*by_piece, strict=True)
        ]

    @property
    def ratio_range(self) -> tuple[Extremum, Extremum]:
        """Smallest and largest i12 over the period."""
        slowest, fastest = self.slope_range
        return Extremum(1.0 / fastest.value, fastest.at), Extremum(1.0 / slowest.value, slowest.at)

    def driven_angle(self, phi1: Array, order: int = 0) -> Jet:
        """phi2 in rad, with derivatives by phi1, at any driving angles (shape (n,)); right-hand limits at joints.

        An open law goes on beyond its ends as its first and last piece do.
        """
        points = np.asarray(phi1, dtype=float)
        cycles, local = np.divmod(points, self.lobes.driving_period_rad)
        if not self.lobes.repeats:
            cycles, local = np.zeros_like(points), points
        if len(self.pieces) == 1:
            return self.pieces[0].driven_angle(local, order) + cycles * self.lobes.driven_period_rad
        starts = [piece.start_rad for piece in self.pieces]
        index = np.maximum(np.searchsorted(starts, local, side="right") - 1, 0)
        masks = [(index == number, piece) for number, piece in enumerate(self.pieces)]
        parts = [(mask, piece.driven_angle(local[mask], order)) for mask, piece in masks if mask.any()]
        return jet.joined(parts) + cycles * self.lobes.driven_period_rad


@dataclass(frozen=True, eq=False)
class Pair:
    """The law of one pair over its own driving angle, and how its driving gear turns.

    ``speed`` gives the gear's speed over the driving shaft's, and ``shaft_rad`` the driving shaft's angle in rad; both
    take the gear's own angles in rad, shape (n,) to shape (n,).
    """

    transmission: Transmission
    speed: Callable[[Array], Array] = field(repr=False)
    shaft_rad: Callable[[Array], Array] = field(repr=False)


@dataclass(frozen=True, eq=False)
class PairsInSeries:
    """The law phi2(phi1) of the whole, and its pairs from the driving shaft on; a single pair has the whole law."""

    whole: Transmission
    pairs: tuple[Pair, ...]


def turned_after(laws: Sequence[Transmission], phi1: Array, order: int) -> list[Jet]:
    """The angles in rad of the driven gears of pairs in series with these laws, by the angle of the first shaft."""
    angles = [Jet.variable(phi1, order)]
    for law in laws:
        outer = law.driven_angle(angles[-1].value, order)
        angles.append(jet.polynomial(outer.coefficients, angles[-1] - angles[-1].value))
    return angles[1:]


def on_driving_shaft(transmission: Transmission) -> Pair:
    """A pair whose driving gear is on the driving shaft."""
    return Pair(transmission, np.ones_like, np.asarray)


def single(transmission: Transmission) -> PairsInSeries:
    """One pair between the driving shaft and the crank."""
    return PairsInSeries(transmission, (on_driving_shaft(transmission),))


@dataclass(frozen=True)
class PrescribedStroke:
    """Facts, besides the ratio, of a law that prescribes the slider's stroke."""

    law_speed_rad_s: float
    """Speed of the driving gear at which the law's velocities hold."""

    closing_error_mm: float
    """Difference of the sum of the stroke's parts from the stroke; rounding error only."""

    facts: Mapping[str, float | str | None]
    """Figures of the stroke and the return for the summary; their names end in their unit; None: the law has none."""


@dataclass(frozen=True, eq=False)
class Law(Shown):
    """A closed law on its mechanism, the pairs of gears that make it, and its stroke where the law prescribes one."""

    linkage: Mechanism
    train: PairsInSeries
    stroke: PrescribedStroke | None = None
    center_distance_mm: float | None = None
    """Distance of the axes that follows from a law whose sizes are in mm; None for a law of gears of any size."""

    facts: Mapping[str, float | str | None] = field(default_factory=dict)
    """Figures, besides the stroke's, found with the law, for the summary; their names end in their unit."""

    def __repr__(self) -> str:
        pairs = f", {len(self.train.pairs)} pairs in series" if len(self.train.pairs) > 1 else ""
        return f"Law({self.transmission!r} on {self.linkage!r}{pairs})"

    @property
    def transmission(self) -> Transmission:
        """The law of the whole, phi2(phi1)."""
        return self.train.whole
