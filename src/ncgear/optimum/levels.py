"""What is limited or made least, as levels: each a number that bounds some quantity at all places of the crank.

A limit holds its level down; a goal makes it as low as it will go.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import atan, degrees, exp, log, pi, radians, tan

from ncgear.optimum import quantities
from ncgear.optimum.quantities import Place, Slider, Term
from ncgear.optimum.stages import pairs
from ncgear.optimum.wishes import Goal, Wishes

STEEPEST = tan(radians(60.0))
"""Of two stages, where no pressure angle is given: a pair of 80 degrees with its rack all but locks.  The method needs
some limit, or it strays into ratios that only cancel each other."""

EASE = 0.3
"""Of two stages, where no pressure angle is given: what a tangent of one is worth in units of the goal.  On the baler
2 % of acceleration buy nine degrees; at a tenth the method takes five times as long, and at times finds nothing."""

EVENLY = 1e-3
"""The same where one is given: of ways to share one law that of the least angle, and next to nothing off the goal."""

Sides = Callable[[Place, Slider, Term], tuple[Term, ...]]
"""Place, slider, and length of the driving curve over the centre distance, to terms that stay at or below the level."""


@dataclass(frozen=True)
class Level:
    """One of them: the ``wish`` it comes from, its ``limit`` (None: none) and its ``weight`` in the goal.

    Terms and limit are in units in which they are of the order of one; ``shown`` puts a level into the user's words.
    ``of_pairs`` tells levels of every pair of gears from those of the machine as a whole.
    """

    wish: str
    limit: float | None
    weight: float
    sides: Sides
    shown: Callable[[float], str]
    of_pairs: bool = False

    def terms(self, ratios: Sequence[Place], slider: Slider, lengths: Sequence[Term]) -> tuple[Term, ...]:
        """All that stays at or below the level, from i12, and iB where there are two pairs, and every pair's length."""
        if not self.of_pairs:
            return self.sides(ratios[0], slider, lengths[0])
        return tuple(
            side for at, length in zip(pairs(ratios), lengths, strict=True) for side in self.sides(at, slider, length)
        )


@dataclass(frozen=True)
class Scales:
    """The machine's driving speed in rad/s, and units of acceleration (mm/s2) and power (W) of its order."""

    speed_rad_s: float
    acceleration_mm_s2: float
    power_w: float


def levels(wishes: Wishes, scales: Scales) -> list[Level]:
    """The levels of all wishes that say anything."""
    return [*_of_motion(wishes, scales), *_of_ratio(wishes, scales), *_of_curves(wishes)]


def _of_motion(wishes: Wishes, scales: Scales) -> Iterator[Level]:
    weights = _weights(wishes, scales)
    if wishes.limits.peak_acceleration_mm_s2 is not None or weights[0]:
        yield _acceleration(wishes, scales, weights[0])
    if wishes.limits.peak_power_w is not None or weights[1]:
        yield _power(wishes, scales, weights[1])
    if wishes.peak_jerk_mm_s3 is not None:
        yield _jerk(wishes.peak_jerk_mm_s3, scales)


def _weights(wishes: Wishes, scales: Scales) -> tuple[float, float]:
    """Weights of acceleration and power in their units."""
    match wishes.goal:
        case Goal.ACCELERATION:
            return 1.0, 0.0
        case Goal.POWER:
            return 0.0, 1.0
    assert wishes.weights is not None
    return scales.acceleration_mm_s2 * wishes.weights.per_mm_s2, scales.power_w * wishes.weights.per_w


def _acceleration(wishes: Wishes, scales: Scales, weight: float) -> Level:
    unit, limit = scales.acceleration_mm_s2, wishes.limits.peak_acceleration_mm_s2

    def sides(at: Place, slider: Slider, length: Term) -> tuple[Term, ...]:
        return _both(quantities.acceleration(at, slider, scales.speed_rad_s) / unit)

    return Level(
        "peak_acceleration_mm_s2", _over(limit, unit), weight, sides, lambda level: f"{level * unit:.6g} mm/s2"
    )


def _power(wishes: Wishes, scales: Scales, weight: float) -> Level:
    unit = scales.power_w

    def sides(at: Place, slider: Slider, length: Term) -> tuple[Term, ...]:
        return (quantities.power(at, slider, scales.speed_rad_s, wishes.limits.mass_kg) / unit,)

    return Level(
        "peak_power_w", _over(wishes.limits.peak_power_w, unit), weight, sides, lambda level: f"{level * unit:.6g} W"
    )


def _jerk(limit: float, scales: Scales) -> Level:
    def sides(at: Place, slider: Slider, length: Term) -> tuple[Term, ...]:
        return _both(quantities.jerk(at, slider, scales.speed_rad_s) / limit)

    return Level("peak_jerk_mm_s3", 1.0, 0.0, sides, lambda level: f"{level * limit:.6g} mm/s3")


def _of_ratio(wishes: Wishes, scales: Scales) -> Iterator[Level]:
    # Of two stages both the whole's ratio and each pair's
    for of_pairs in (False, True)[: wishes.pairs]:
        yield _least_ratio(wishes.limits.ratio_min, of_pairs)
        yield _greatest_ratio(wishes.limits.ratio_max, of_pairs)
    if wishes.driven_speed_rad_s is not None:
        top = log(wishes.driven_speed_rad_s / scales.speed_rad_s)
        rpm = scales.speed_rad_s * 30.0 / pi
        yield Level(
            "driven_speed_rpm", top, 0.0, lambda at, *_: (-at.log,), lambda level: f"{rpm * exp(level):.6g} r/min"
        )


def _least_ratio(limit: float, of_pairs: bool) -> Level:
    return Level("ratio_min", -log(limit), 0.0, lambda at, *_: (-at.log,), lambda top: f"{exp(-top):.6g}", of_pairs)


def _greatest_ratio(limit: float, of_pairs: bool) -> Level:
    return Level("ratio_max", log(limit), 0.0, lambda at, *_: (at.log,), lambda top: f"{exp(top):.6g}", of_pairs)


def _of_curves(wishes: Wishes) -> Iterator[Level]:
    shared = wishes.two_stages
    if shared is not None:
        yield _angle_of_each(shared.pressure_angle_rad)
    elif wishes.limits.pressure_angle_rad is not None:
        yield _pressure_angle(tan(wishes.limits.pressure_angle_rad), 0.0)
    if wishes.curvature_turns is not None:
        yield _curvature(wishes.curvature_turns, dents=not wishes.convex)
    if wishes.convex:
        for bulge in (quantities.driving_bulge, quantities.driven_bulge):
            yield _convex(bulge)


def _angle_of_each(given_rad: float | None) -> Level:
    return _pressure_angle(STEEPEST, EASE) if given_rad is None else _pressure_angle(tan(given_rad), EVENLY)


def _pressure_angle(most: float, weight: float) -> Level:
    return Level(
        "pressure_angle_deg",
        most,
        weight,
        lambda at, *_: _both(quantities.tangent(at)),
        lambda level: f"a pitch curve {degrees(atan(level)):.4g} deg off the normal to the centre line",
        of_pairs=True,
    )


def _curvature(turns: float, *, dents: bool) -> Level:
    def sides(at: Place, slider: Slider, length: Term) -> tuple[Term, ...]:
        bulges = [
            curvature(at) * length / turns for curvature in (quantities.driving_curvature, quantities.driven_curvature)
        ]
        return (*bulges, *(-bulge for bulge in bulges)) if dents else tuple(bulges)

    return Level(
        "least_radius_mm",
        1.0,
        0.0,
        sides,
        lambda level: f"radii of {1.0 / level:.4g} times the wished one",
        of_pairs=True,
    )


def _convex(bulge: Callable[[Place], Term]) -> Level:
    return Level("convex", 0.0, 0.0, lambda at, *_: (-bulge(at),), lambda level: "a dent", of_pairs=True)


def _both(term: Term) -> tuple[Term, Term]:
    return term, -term


def _over(limit: float | None, unit: float) -> float | None:
    return None if limit is None else limit / unit
