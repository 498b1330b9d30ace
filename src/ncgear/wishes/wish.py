"""Methods of every kind of wish: its requirements on a law, its outcome for a motion, its words, its offer.

The search for laws, the certified limit and ``figures.wished`` use these methods alone; none of them knows a kind.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import replace
from math import degrees, floor, inf, log10
from typing import Self

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import (
    CrankStretch,
    End,
    EvenStretch,
    Stroke,
    about_end,
    longest_even_stretch,
    taken_rad,
    time_ratio,
)
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.mechanism import SLIDER, Mechanism, Output, Unit
from ncgear.wishes.requirements import DrivingRange, PushedSpeed, Requirement, passed_no_earlier, passed_no_later

NEGLIGIBLE = 1e-6
"""Largest miss of a kept wish, as a share of its bound and as an angle in rad: files hold the numbers of a law to some
ten digits."""

DEGREES = Unit("deg", "deg", degrees(1.0))
"""The unit of wishes for a driving angle."""

Written = Callable[[float], str]
"""Function that writes a number in a text."""

Value = float | bool


@dataclass(frozen=True)
class Offer:
    """Another request in place of a missed one, in words, and its values by their dotted keys in a design file.

    ``key`` is the key of the eased wish or limit, if messages name it.
    """

    said: str
    values: tuple[tuple[str, Value], ...] = ()
    key: str = ""

    def __str__(self) -> str:
        return f"{self.said} ({self.key})" if self.key else self.said


@dataclass(frozen=True)
class Outcome:
    """Outcome of one wish for a motion, and the bounds that the wish sets.

    The values are a share of the speed, a ratio of times, a driving angle in rad, a speed in mm/s, a deceleration in
    mm/s^2, or a displacement in mm, and are shown in ``unit``.  ``missed_by`` is the distance of ``achieved`` from the
    bounds, 0 within them.  ``speed_mm_s`` is the speed that judges a wish for a constant speed.  A place that is passed
    in the other stroke (``other_stroke``) is missed by the way from there, over the dead centre between.
    """

    wish: Wish
    unit: Unit
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


@dataclass(frozen=True, kw_only=True)
class Wish(ABC):
    """A wish: ``key`` is its dotted key in a design file, ``weight`` is None for a hard wish.

    ``output`` is the mechanism's output: where it turns, places are in rad and speeds in rad/s in place of mm and mm/s.

    A soft wish that is missed by p percent, of the speed or of the cycle's driving angle, counts in the goal of an
    optimised law like ``weight`` times p percent of the quantity to be least.
    """

    key: str = ""
    weight: float | None = None
    output: Output = SLIDER

    @property
    def hard(self) -> bool:
        """Whether the wish must be kept."""
        return self.weight is None

    @property
    def aim(self) -> str:
        """The wish in words, where no bound says it."""
        return ""

    @abstractmethod
    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The requirements on a mechanism whose cycle takes a driving angle of ``cycle_rad``."""

    def pushed(self, linkage: Mechanism) -> tuple[PushedSpeed, ...]:
        """Speeds that shall be as low or as high as possible, which only a soft wish can ask."""
        return ()

    @abstractmethod
    def outcome(self, machine: Machine) -> Outcome:
        """The outcome of the wish for a motion."""

    @abstractmethod
    def words(self, place: Written, angle: Written) -> str:
        """The wish by its kind and its place; places in mm and driving angles in rad are written without units."""

    @abstractmethod
    def offer(self, asked: Requirement, missed: float, cycle_rad: float) -> Offer:
        """Other values of the wish, which would keep the requirement ``asked`` that is missed by ``missed``.

        Speeds and their spread are missed by the logarithm of a factor, decelerations by a share, driving angles by an
        angle in rad.
        """

    def instead(self, linkage: Mechanism, ratio_max: float) -> tuple[Offer, ...]:
        """Other requests that would be kept, at the greatest ratio."""
        return ()

    def judged(self, unit: Unit, achieved: float, least: float = 0.0, most: float = inf) -> Outcome:
        """The outcome of a value between two bounds."""
        return Outcome(self, unit, achieved, least, most, max(least - achieved, achieved - most, 0.0))

    def eased(self, said: str, **values: str) -> Offer:
        """The offer of other values of the wish's keys."""
        return Offer(said, tuple((f"{self.key}.{name}", float(number)) for name, number in values.items()))


@dataclass(frozen=True, kw_only=True)
class DrivingWish(Wish, ABC):
    """A wish that bounds a quantity on a stretch or, if given, over a ``driving`` range, wherever the output is then.

    The law decides which crank angles it passes in the range: the search holds the bound over some angles, and the
    certified limit tells laws apart by the angles that they pass.
    """

    driving: DrivingRange | None = None

    @abstractmethod
    def bound(self, stretch: CrankStretch) -> Requirement:
        """The requirement on the stretch."""

    @abstractmethod
    def stretch(self, linkage: Mechanism) -> CrankStretch:
        """The stretch; for a driving range, the crank angles over which the bound is held."""

    def held_over(self, crank: CrankStretch) -> Self:
        """The wish with its driving range held over other crank angles."""
        return self if self.driving is None else replace(self, driving=self.driving._replace(crank=crank))

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        """The bound; for a driving range also that its crank angles begin no later, and end no earlier, than the range.

        This is enough for the range, but leaves only the laws that pass these crank angles so.
        """
        asked = self.bound(self.stretch(linkage))
        if self.driving is None:
            return (asked,)
        start, end, crank = self.driving
        return (asked, *passed_no_later(crank.start_rad, start), *passed_no_earlier(crank.end_rad, end))


def of_stroke(stroke: Stroke | None) -> str:
    """The stroke of a wish in words; None stands for both."""
    return " of both strokes" if stroke is None else " of the return" if stroke is Stroke.RETURN else ""


EVEN = 0.005
"""Share of a speed within which it counts as constant."""

NEAR = 1e-3
"""Share of the stroke, rounded down to 1, 2 or 5 of a decimal place, within which the output counts as standing."""


@dataclass(frozen=True)
class Achieved:
    """Results of a motion, whatever is wished, and the outcome of every wish.

    ``even`` has the longest stretch of each stroke over which the speed stays within EVEN of one value; ``dwell_rad``
    the driving angle for which the displacement stays within ``near_mm`` of each end.  Gears that turn less than once
    have only the way forth: no time ratio (None), and no dwells.
    """

    even: Mapping[Stroke, EvenStretch]
    time_ratio: float | None
    near_mm: float
    dwell_rad: Mapping[End, float]
    outcomes: tuple[Outcome, ...]


def achieved(machine: Machine, outcomes: tuple[Outcome, ...]) -> Achieved:
    """Results of a machine\'s motion at its constant driving speed, with the outcomes of its wishes."""
    near = near_mm(machine.linkage.stroke_mm)
    if not machine.transmission.lobes.repeats:
        forth = Stroke.WORKING
        return Achieved({forth: longest_even_stretch(machine, forth, EVEN)}, None, near, {}, outcomes)
    return Achieved(
        even={stroke: longest_even_stretch(machine, stroke, EVEN) for stroke in Stroke},
        time_ratio=time_ratio(machine),
        near_mm=near,
        dwell_rad={end: taken_rad(machine, about_end(machine.linkage, end, near)) for end in End},
        outcomes=outcomes,
    )


def near_mm(stroke_mm: float) -> float:
    """The distance from an end within which the output counts as standing: NEAR of the stroke in round figures."""
    share = NEAR * stroke_mm
    unit = 10.0 ** floor(log10(share))
    # Rounding errors must not bring 1, 2 or 5 down to the next figure.
    return unit * max(figure for figure in (1.0, 2.0, 5.0) if figure <= share / unit * (1.0 + 1e-9))
