"""What a motion achieves of what a person may wish of it: even speed, time ratio, near-dwells, and each wish itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import floor, inf, log10, pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.kinematics.even_speed import EvenStretch, longest_even_stretch, velocity
from ncgear.kinematics.motion import Machine, Stretch, stretches
from ncgear.kinematics.wishes import (
    NEGLIGIBLE,
    ConstantSpeed,
    CrankStretch,
    Dwell,
    End,
    ExtremeSpeed,
    GentleSpeed,
    GentleStop,
    GentleStretch,
    Position,
    SpeedAt,
    Stroke,
    TimeRatio,
    Wish,
    WorkingStroke,
    about_end,
    by_stroke,
    place_of,
)
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum, extremes
from ncgear.numerics.jet import Jet

EVEN = 0.005
"""Share of a speed within which it counts as constant."""

NEAR = 1e-3
"""Share of the stroke, rounded down to 1, 2 or 5 of a decimal place, within which the output counts as standing."""


@dataclass(frozen=True)
class Outcome:
    """What a motion achieves of one wish, and the bounds that the wish sets to it.

    The unit is that of the wish: a share of the speed, a ratio of times, a driving angle in rad, a speed in mm/s, a
    deceleration in mm/s^2, a displacement in mm.  ``missed_by`` is how far what is achieved lies beyond the bounds, 0
    within them.  ``speed_mm_s`` is the speed that a wish for a constant one is judged against.  A place that is passed
    in the other stroke (``other_stroke``) is missed by the way from there, over the dead centre between.
    """

    wish: Wish
    achieved: float
    least: float
    most: float
    missed_by: float
    speed_mm_s: float | None = None
    other_stroke: bool = False

    @property
    def kept(self) -> bool:
        """Whether the wish is kept but for rounding of a law's numbers."""
        return self.missed_by <= NEGLIGIBLE * max(1.0, abs(self.achieved))


@dataclass(frozen=True)
class Achieved:
    """What a motion achieves, whatever is wished, and the outcome of every wish.

    ``even`` has the longest stretch of each stroke over which the speed stays within EVEN of one value; ``dwell_rad``
    the driving angle for which the displacement stays within ``near_mm`` of each end.  Gears that turn less than once
    have the way forth alone: no time ratio, which is None, and no dwells.
    """

    even: Mapping[Stroke, EvenStretch]
    time_ratio: float | None
    near_mm: float
    dwell_rad: Mapping[End, float]
    outcomes: tuple[Outcome, ...]


def achieved(machine: Machine, wishes: Sequence[Wish]) -> Achieved:
    """What a machine's motion achieves at its constant driving speed."""
    near = near_mm(machine.linkage.stroke_mm)
    if not machine.transmission.lobes.repeats:
        forth = Stroke.WORKING
        return Achieved({forth: longest_even_stretch(machine, forth, EVEN)}, None, near, {}, ())
    return Achieved(
        even={stroke: longest_even_stretch(machine, stroke, EVEN) for stroke in Stroke},
        time_ratio=time_ratio(machine),
        near_mm=near,
        dwell_rad={end: taken_rad(machine, about_end(machine.linkage, end, near)) for end in End},
        outcomes=tuple(outcome(machine, wish) for wish in wishes),
    )


def near_mm(stroke_mm: float) -> float:
    """The distance from an end within which the output counts as standing: NEAR of the stroke in round figures."""
    share = NEAR * stroke_mm
    unit = 10.0 ** floor(log10(share))
    # Rounding errors must not bring 1, 2 or 5 down to the next figure.
    return unit * max(figure for figure in (1.0, 2.0, 5.0) if figure <= share / unit * (1.0 + 1e-9))


def time_ratio(machine: Machine) -> float:
    """Time of the working stroke over the time of the return."""
    working = machine.extended_rad
    return working / (machine.transmission.cycle_rad - working)


def driving_rad(machine: Machine, crank_rad: float) -> float:
    """Driving angle at a crank angle of any turn, counted from the retracted dead centre."""
    turns, local = divmod(crank_rad, 2.0 * pi)
    whole = turns * machine.transmission.cycle_rad
    found = machine.driving_angles(np.array([local])) if local > 0.0 else np.zeros(1)
    return whole + (float(found[0]) if found.size else machine.transmission.cycle_rad)


def taken_rad(machine: Machine, stretch: CrankStretch) -> float:
    """Driving angle that a stretch of the crank angle takes."""
    return driving_rad(machine, stretch.end_rad) - driving_rad(machine, stretch.start_rad)


def speeds_mm_s(machine: Machine, stretch: CrankStretch) -> tuple[float, float]:
    """Least and greatest speed on a stretch of crank angles, at stationary points and both ends."""
    if not stretch.start_rad < stretch.end_rad:
        at = np.array([driving_rad(machine, stretch.start_rad)])
        speed = abs(float(machine.displacement(at, 1).derivative(1)[0])) * machine.speed_rad_s
        return speed, speed
    values = _extremes_of(machine, stretch, lambda part, phi1: velocity(part, phi1, 1))
    return min(values) * machine.speed_rad_s, max(values) * machine.speed_rad_s


def deceleration_mm_s2(machine: Machine, stretch: CrankStretch) -> float:
    """The greatest fall of the speed in a second on a stretch of crank angles, 0 where the speed never falls."""
    values = _extremes_of(machine, stretch, lambda part, phi1: -velocity(part, phi1, 2).differentiated())
    return max(0.0, max(values) * machine.speed_rad_s**2)


def _extremes_of(machine: Machine, stretch: CrankStretch, function: Callable[[Stretch, Array], Jet]) -> list[float]:
    """Least and greatest values of a function of smooth stretches of the motion, on a stretch of crank angles."""
    found: list[Extremum] = []
    for one, stroke in by_stroke(machine.linkage, stretch):
        start, end = driving_rad(machine, one.start_rad), driving_rad(machine, one.end_rad)
        for whole in stretches(machine):
            part = replace(whole, start_rad=max(start, whole.start_rad), end_rad=min(end, whole.end_rad))
            # Rounding must not bring in the other side of a dead centre
            if part.working is (stroke is Stroke.WORKING) and part.start_rad < part.end_rad:
                found += extremes(partial(function, part), part.start_rad, part.end_rad, np.array(part.knots_rad))
    return [extremum.value for extremum in found]


def outcome(machine: Machine, wish: Wish) -> Outcome:
    """What the motion achieves of a wish; raises TypeError for a wish of no known kind."""
    linkage = machine.linkage
    match wish:
        case ConstantSpeed():
            least, most = speeds_mm_s(machine, wish.stretch(linkage))
            return _constant(wish, least, most)
        case SpeedAt():
            speed, _ = speeds_mm_s(machine, place_of(linkage, wish.at_mm, wish.stroke))
            return _between(wish, speed, wish.least_mm_s, wish.most_mm_s)
        case ExtremeSpeed():
            return _between(wish, speeds_mm_s(machine, wish.place(linkage))[0])
        case GentleSpeed():
            return _between(wish, speeds_mm_s(machine, _gentle(machine, wish))[1], most=wish.most_mm_s)
        case GentleStop():
            return _between(wish, deceleration_mm_s2(machine, _gentle(machine, wish)), most=wish.most_mm_s2)
        case TimeRatio():
            return _between(wish, time_ratio(machine), wish.at_least)
        case WorkingStroke():
            angle, within = wish.angle_rad, wish.tolerance_rad
            return _between(wish, machine.extended_rad, angle - within, angle + within)
        case Dwell():
            taken = taken_rad(machine, about_end(linkage, wish.end, wish.within_mm))
            return _between(wish, taken, wish.for_rad)
        case Position():
            return _passed(machine, wish)
    raise TypeError(f"{type(wish).__name__} is no known kind of wish")


def crank_rad(machine: Machine, phi1_rad: float) -> float:
    """Crank angle at a driving angle of any cycle, counted from the retracted dead centre."""
    turns, local = divmod(phi1_rad, machine.transmission.cycle_rad)
    return 2.0 * pi * turns + float(machine.transmission.driven_angle(np.array([local]), 0).value[0])


def _gentle(machine: Machine, wish: GentleStretch) -> CrankStretch:
    """The crank angles of a gentle stretch: of a driving range, those that the motion passes in it."""
    if wish.driving is None:
        return wish.stretch(machine.linkage)
    return CrankStretch(crank_rad(machine, wish.driving.start_rad), crank_rad(machine, wish.driving.end_rad))


def _between(
    wish: Wish, achieved: float, least: float = 0.0, most: float = inf, speed_mm_s: float | None = None
) -> Outcome:
    missed = max(least - achieved, achieved - most, 0.0)
    return Outcome(wish, achieved, least, most, missed, speed_mm_s)


def _constant(wish: ConstantSpeed, least: float, most: float) -> Outcome:
    """The share by which the speed leaves the wished one, or, where none is wished, the one that suits it best."""
    speed = wish.speed_mm_s
    if speed is None:
        mean = (most + least) / 2.0
        return _between(wish, (most - least) / (most + least), most=wish.tolerance, speed_mm_s=mean)
    share = max(most / speed - 1.0, 1.0 - least / speed)
    return _between(wish, share, most=wish.tolerance, speed_mm_s=speed)


def _passed(machine: Machine, wish: Position) -> Outcome:
    """The place at the driving angle, judged by the way from the retracted end, which grows in the return too."""
    stroke_mm = float(machine.linkage.stroke_mm)
    place = float(machine.displacement(np.array([wish.phi1_rad]), 0).value[0])
    working = wish.phi1_rad <= machine.extended_rad
    gone = place if working else 2.0 * stroke_mm - place
    missed = float(max(abs(gone - wish.way_mm(machine.linkage)) - wish.tolerance_mm, 0.0))
    least, most = wish.at_mm - wish.tolerance_mm, wish.at_mm + wish.tolerance_mm
    return Outcome(wish, place, least, most, missed, other_stroke=working is not (wish.stroke is Stroke.WORKING))
