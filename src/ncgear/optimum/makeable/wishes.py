"""The wishes of a makeable law, and each as a level: limits hold levels down, goals make them as low as they go."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from enum import Enum
from math import atan, ceil, degrees, exp, inf, log, pi, radians, tan

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.optimum.certified.refusals import NOT_CONVEX
from ncgear.optimum.makeable import quantities
from ncgear.optimum.makeable.levels import (
    LevelKind,
    MachineScales,
    WishLevel,
    limit_offer,
    limited,
    of_figure,
    of_loads,
)
from ncgear.optimum.makeable.motion_wishes import of_motion_wishes
from ncgear.optimum.makeable.quantities import RatioPlace, Slider, Term
from ncgear.optimum.task import Limits, Prices, Task
from ncgear.wishes.wish import Offer, Wish


class Goal(Enum):
    """The value that is minimized."""

    ACCELERATION = "least_acceleration"
    POWER = "least_power"
    BRAKING_POWER = "least_braking_power"
    RMS_TORQUE = "least_rms_torque"
    FLYWHEEL = "least_flywheel"
    BEARING_FORCE = "least_bearing_force"
    SHAKING_FORCE = "least_shaking_force"
    TOOTH_FORCE = "least_tooth_force"
    FLANK_LOAD = "least_flank_load"
    SPEED = "least_speed"
    JERK = "least_jerk"
    PRESSURE_ANGLE = "least_pressure_angle"
    ACCELERATION_HARMONICS = "least_acceleration_harmonics"
    TORQUE_HARMONICS = "least_torque_harmonics"
    CENTER_DISTANCE = "least_center_distance"
    WEIGHTED = "weighted"


ALONE = {
    Goal.ACCELERATION: Prices(peak_acceleration_mm_s2=1.0),
    Goal.POWER: Prices(peak_power_w=1.0),
    Goal.BRAKING_POWER: Prices(braking_power_w=1.0),
    Goal.RMS_TORQUE: Prices(rms_torque_n_m=1.0),
    Goal.FLYWHEEL: Prices(flywheel_kg_mm2=1.0),
    Goal.BEARING_FORCE: Prices(bearing_force_n=1.0),
    Goal.SHAKING_FORCE: Prices(shaking_force_n=1.0),
    Goal.TOOTH_FORCE: Prices(tooth_force_n=1.0),
    Goal.FLANK_LOAD: Prices(flank_load_n_mm=1.0),
    Goal.SPEED: Prices(peak_speed_mm_s=1.0),
    Goal.JERK: Prices(peak_jerk_mm_s3=1.0),
    Goal.PRESSURE_ANGLE: Prices(tangent_rad=degrees(1.0)),
    Goal.ACCELERATION_HARMONICS: Prices(acceleration_harmonics_mm_s2=1.0),
    Goal.TORQUE_HARMONICS: Prices(torque_harmonics_n_m=1.0),
    Goal.CENTER_DISTANCE: Prices(center_distance_mm=1.0),
}
"""The minimized figure of each goal, without the weighted goal."""


class CurvatureWish(Enum):
    """The reason for a limit of the pitch curves' curvature: a radius in mm, or a number of teeth without undercut."""

    LEAST_RADIUS = "least_radius_mm"
    UNDERCUT = "free_of_undercut"


@dataclass(frozen=True)
class TwoStages:
    """The ratio divided over two pairs in series; ``pressure_angle_rad`` bounds the tangent angle of each, None: free.

    It replaces the limit of that name in ``Limits``, since no certified bound follows from it.
    """

    pressure_angle_rad: float | None = None


@dataclass(frozen=True)
class Wishes:
    """A goal and limits; None means no limit.

    A certified bound exists for ``limits``; the other fields restrict makeable laws only.  ``curvature_turns`` limits
    the curvature of both pitch curves, dents as well as bulges, times the length that they roll in one cycle: 2 pi on
    circles; with two stages, this limit and ``convex`` hold for each pair.  It follows from ``curvature_given``, the
    user's value for ``curvature_wish``.
    """

    limits: Limits
    goal: Goal = Goal.ACCELERATION
    weights: Prices | None = None
    peak_jerk_mm_s3: float | None = None
    acceleration_harmonics_mm_s2: float | None = None
    center_distance_mm: float | None = None
    driven_speed_rad_s: float | None = None
    convex: bool = True
    curvature_turns: float | None = None
    curvature_wish: CurvatureWish = CurvatureWish.LEAST_RADIUS
    curvature_given: float = 1.0
    knots: int = 180
    two_stages: TwoStages | None = None
    motion: tuple[Wish, ...] = ()

    @property
    def prices(self) -> Prices:
        """The goal to be least: a single figure, or the weighted sum."""
        if self.goal is Goal.WEIGHTED and self.weights is not None:
            return self.weights
        return ALONE[self.goal]

    @property
    def pairs(self) -> int:
        """Pairs of gears between the driving shaft and the crank."""
        return 1 if self.two_stages is None else 2


CONVEX = "convex"
"""A wish that is either kept or not: the depth of a dent means nothing to a user."""

STEEPEST = tan(radians(60.0))
"""Limit of the tangent of each pair of two stages without a given pressure angle: with its rack such a pair has 80
degrees and almost locks.  Without a limit the method drifts into ratios that only cancel each other."""

EASE = 0.3
"""Cost of a tangent of 1, in units of the goal, for two stages without a given pressure angle.  On the baler 2 % of
acceleration gain nine degrees; with a tenth of the cost the method takes five times as long, and sometimes fails."""

EVENLY = 1e-3
"""The same cost with a given pressure angle: it picks the way with the least angle, at almost no cost."""


NEXT_TO_LOCKED = radians(89.0)
"""Limit of the pressure angle if the force between teeth counts and the design limits no angle: at 90 degrees no force
would turn the driven gear, and beyond it the force changes its sign."""


@dataclass(frozen=True)
class Scales:
    """A task, and units of acceleration (mm/s2) and power (W) of the order of its machine's.

    ``loads`` has the units of forces with masses; None without masses.
    """

    task: Task
    acceleration_mm_s2: float
    power_w: float
    loads: MachineScales | None = None


def levels(wishes: Wishes, scales: Scales) -> list[WishLevel]:
    """The levels of all wishes that restrict or cost anything."""
    peaks = list(_of_peaks(wishes, scales))
    if wishes.two_stages is not None:
        # Weights with the sum 1, since costs of pressure angles are in units of the goal
        goal = sum(level.weight for level in peaks)
        peaks = [replace(level, weight=level.weight / goal) for level in peaks]
    motion = of_motion_wishes(scales.task, wishes.motion)
    return [*peaks, *_of_ratio(wishes, scales), *_of_curves(wishes), *motion]


def _of_peaks(wishes: Wishes, scales: Scales) -> Iterator[WishLevel]:
    limits, prices, task = wishes.limits, wishes.prices, scales.task
    unit, speed, output = scales.acceleration_mm_s2, task.speed_rad_s, task.linkage.OUTPUT
    told = output.acceleration
    yield from of_figure(
        f"peak_acceleration_{told.ending}",
        f"a peak acceleration of {{}} {told.text[:-1]}^2",
        unit,
        limits.peak_acceleration_mm_s2,
        prices.peak_acceleration_mm_s2,
        lambda at, slider, _: _both(quantities.acceleration(at, slider, speed) / unit),
    )
    if scales.loads is not None:
        yield from of_loads(task, scales.loads, limits, prices)
    else:
        yield from of_figure(
            "peak_power_w",
            "a peak power of {} W",
            scales.power_w,
            limits.peak_power_w,
            prices.peak_power_w,
            lambda at, slider, _: (quantities.power(at, slider, speed) / scales.power_w,),
        )
    jerk = wishes.peak_jerk_mm_s3 or unit * speed
    yield from of_figure(
        f"peak_jerk_{output.speed.ending}3",
        f"a peak jerk of {{}} {output.speed.text}^3",
        jerk,
        wishes.peak_jerk_mm_s3,
        prices.peak_jerk_mm_s3,
        lambda at, slider, _: _both(quantities.jerk(at, slider, speed) / jerk),
    )
    yield from of_figure(
        f"acceleration_harmonics_{told.ending}",
        f"an r.m.s. acceleration of {{}} {told.text[:-1]}^2 in high harmonics",
        unit,
        wishes.acceleration_harmonics_mm_s2,
        prices.acceleration_harmonics_mm_s2,
        lambda at, slider, _: (quantities.acceleration(at, slider, speed) / unit,),
        kind=LevelKind.RMS,
        order=task.harmonics_above,
        cycle_rad=task.cycle_rad,
    )
    most, price, size = wishes.center_distance_mm, prices.center_distance_mm, task.gears
    if size is not None and size.teeth is not None and size.module_mm is not None:
        around = size.teeth * pi * size.module_mm / task.lobes.driving
        distance = most or around / pi
        # The length of the curves over the length for 1 mm, the same at every place
        yield from of_figure(
            "center_distance_mm",
            "a centre distance of {} mm",
            distance,
            most,
            price,
            lambda at, slider, length: (around / length / distance,),
            stretch=CrankStretch(0.0, 0.0),
        )
    fastest = limits.peak_speed_mm_s or task.linkage.half_way * speed
    yield from of_figure(
        f"peak_speed_{output.speed.ending}",
        f"a peak speed of {{}} {output.speed.text}",
        fastest,
        limits.peak_speed_mm_s,
        prices.peak_speed_mm_s,
        lambda at, slider, _: _both(quantities.velocity(at, slider, speed) / fastest),
    )


def _of_ratio(wishes: Wishes, scales: Scales) -> Iterator[WishLevel]:
    low, high, free = wishes.limits.ratio_min, wishes.limits.ratio_max, 0.0

    def fast(at: RatioPlace, *_: object) -> tuple[Term, ...]:
        return (-at.log,)

    def slow(at: RatioPlace, *_: object) -> tuple[Term, ...]:
        return (at.log,)

    # With two stages the limits hold for the ratio of the whole and for each pair's
    for of_pairs in (False, True)[: wishes.pairs]:
        words, number = "a least ratio of {}", lambda level: shown_below(exp(-level))
        yield limited("ratio_min", words, number, -log(low), free, fast, of_pairs=of_pairs)
        words, number = "a greatest ratio of {}", lambda level: shown_above(exp(level))
        yield limited("ratio_max", words, number, log(high), free, slow, of_pairs=of_pairs)
    if wishes.driven_speed_rad_s is not None:
        top, rpm = log(wishes.driven_speed_rad_s / scales.task.speed_rad_s), scales.task.speed_rad_s / RAD_S_PER_RPM
        words = "a driven gear at {} r/min"
        yield limited("driven_speed_rpm", words, lambda level: shown_above(rpm * exp(level)), top, free, fast)


def _of_curves(wishes: Wishes) -> Iterator[WishLevel]:
    shared, limits, prices = wishes.two_stages, wishes.limits, wishes.prices
    rack, limited_rad = limits.rack_angle_rad, limits.pressure_angle_rad
    if prices.tangent_rad:
        given = limited_rad if shared is None else shared.pressure_angle_rad
        yield _pressure_angle(None if given is None else tan(given), 1.0, rack)
    elif shared is not None:
        given = shared.pressure_angle_rad
        yield _pressure_angle(STEEPEST, EASE, rack) if given is None else _pressure_angle(tan(given), EVENLY, rack)
    elif limited_rad is not None:
        yield _pressure_angle(tan(limited_rad), 0.0, rack)
    elif any(getattr(of, name) for of in (limits, prices) for name in ("tooth_force_n", "flank_load_n_mm")):
        yield _pressure_angle(tan(NEXT_TO_LOCKED - rack), 0.0, rack)
    if wishes.curvature_turns is not None:
        yield _curvature(wishes, wishes.curvature_turns)
    if wishes.convex:
        for bulge in (quantities.driving_bulge, quantities.driven_bulge):
            yield _convex(bulge)


def _pressure_angle(most: float | None, weight: float, rack_rad: float) -> WishLevel:
    return limited(
        "pressure_angle_deg",
        "a pressure angle of {} deg",
        lambda level: shown_above(degrees(atan(level) + rack_rad)),
        most,
        weight,
        lambda at, *_: _both(quantities.tangent(at)),
        of_pairs=True,
        widest=tan(pi / 2.0 - rack_rad) if rack_rad else inf,
    )


def _curvature(wishes: Wishes, turns: float) -> WishLevel:
    def sides(at: RatioPlace, slider: Slider, length: Term) -> tuple[Term, ...]:
        bulges = [
            curvature(at) * length / turns for curvature in (quantities.driving_curvature, quantities.driven_curvature)
        ]
        return (*bulges, *(-bulge for bulge in bulges)) if not wishes.convex else tuple(bulges)

    def shown(level: float) -> Offer:
        if wishes.curvature_wish is CurvatureWish.UNDERCUT:
            teeth = ceil(wishes.curvature_given * level)
            return Offer(f"{teeth} teeth in place of {wishes.curvature_given:g}", (("gears.teeth", teeth),))
        least = shown_below(wishes.curvature_given / level)
        return limit_offer("least_radius_mm", "a least radius of {} mm", least)

    return WishLevel(wishes.curvature_wish.value, 1.0, 0.0, sides, shown, of_pairs=True)


def _convex(bulge: Callable[[RatioPlace], Term]) -> WishLevel:
    return WishLevel(CONVEX, 0.0, 0.0, lambda at, *_: (-bulge(at),), lambda level: NOT_CONVEX, of_pairs=True)


def _both(term: Term) -> tuple[Term, Term]:
    return term, -term
