"""What a person wishes of the motion: even speed, quick return, dwells, speeds and positions; hard or soft.

Places and speeds of an output that slides are in mm and mm/s, those of one that turns in deg and rad/s.  A wish with a
place has a twin for an output that turns, whose keys and words follow from its own.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from ncgear.design.keys.base import Model, angle, fault, given, key_of, listed, optional, require, required
from ncgear.design.keys.types import LONGEST_MM, Item, Length, Positive, Several
from ncgear.design.words import spellings

MOST_WISHES = 50
"""Wishes of a kind: more than a person writes."""

LEAST_TOLERANCE = 1e-4
"""A hundredth of a percent of the speed: a hundredth of the usual tolerance, and more than teeth hold."""

GENTLE_STOPS = (
    "greatest decelerations, or speeds, over stretches of the stroke or of the whole cycle, a list; over the whole "
    "cycle optimize.limits.peak_acceleration_mm_s2 and peak_jerk_mm_s3 hold too, and dwell keeps close to an end"
)

Way = Annotated[float, Field(ge=0.0, le=LONGEST_MM)]
StrokeName = Literal["working", "return"]
Wished = Annotated[Several[Item], Field(max_length=MOST_WISHES)]

TURNED = {"Way": Annotated[float, Field(ge=0.0, lt=360.0)], "Length": Annotated[float, Field(gt=0.0, lt=360.0)]}
"""The types of places in deg, by the names of those of places in mm; speeds have one type."""


class Wish(Model):
    """What every wish has: whether it must be kept.

    A class with ``turns=True`` is that of an output that turns: places and speeds of its base are in deg and rad/s.
    """

    PLACE: ClassVar[str] = "mm"
    SPEED: ClassVar[str] = "mm_s"
    """The units of places and of speeds, at the ends of keys; a 2 follows in those of decelerations."""

    hard: bool = optional("true: the law must keep it; false: it has a weight in the goal", True)
    weight: Positive | None = optional(
        "of a soft wish: 1 percent missed, of the speed, the deceleration or the cycle's driving angle, counts like so "
        "many percent of what is to be least; left out: 1"
    )

    def __init_subclass__(cls, turns: bool = False, **kwargs: Any) -> None:
        """Annotate the fields of an output that turns, before pydantic reads the annotations.

        A field in mm of the base is one in deg or rad/s here, and its own name is no field any more.
        """
        if turns:
            cls.PLACE, cls.SPEED = "deg", "rad_s"
            base: Any = cls.__mro__[1]
            for name, annotation in base.__annotations__.items():
                key = re.sub("_mm$", "_deg", re.sub("_mm(?=_s)", "_rad", name))
                if key != name:
                    kind, _, absent = annotation.partition(" | ")
                    of: Any = TURNED.get(kind, Positive)
                    words = re.sub(r"\bmm\b(?=/)", "rad", base.model_fields[name].description)
                    words = words.replace(" mm", " deg").replace("slider", "output")
                    cls.__annotations__ |= {name: ClassVar[None], key: of | None if absent else of}
                    setattr(cls, key, optional(words) if absent else required(words))
        super().__init_subclass__(**kwargs)

    def place(self, quantity: str) -> Any:
        """The value of a key of a place, such as ``from`` or ``at``, in the unit of the file; None where left out."""
        return getattr(self, f"{quantity}_{self.PLACE}")

    def speed(self, quantity: str) -> float | None:
        """The value of a key of a speed, in the unit of the file; None where it is left out."""
        found: float | None = getattr(self, f"{quantity}_{self.SPEED}")
        return found

    @property
    def soft_weight(self) -> float | None:
        """The weight of a soft wish; None for a hard one."""
        return None if self.hard else self.weight or 1.0

    @model_validator(mode="after")
    def _weight_of_the_soft(self) -> Self:
        if self.hard and self.weight is not None:
            raise fault("weight", "given, but the wish is hard; hard: false is right with a weight, or leave it out")
        return self


class ConstantSpeed(Wish):
    """Even speed from one place to another."""

    from_mm: Length = required("displacement in mm where the even speed begins, the smaller of both")
    to_mm: Length = required("displacement in mm where the even speed ends, the larger of both")
    tolerance: Annotated[float, Field(ge=LEAST_TOLERANCE, le=0.5)] = optional(
        "how far the speed may be from one value, as a share of it: 0.005 is half a percent", 0.005
    )
    stroke: StrokeName = optional("on the way out (working) or on the way back (return)", "working")
    speed_mm_s: Positive | None = optional("that one value in mm/s; left out: whatever the law makes of it")

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        require(self, f"to_{self.PLACE} > from_{self.PLACE}")
        return self

    def agrees(self, next_one: ConstantSpeed) -> bool:
        """Whether both speeds can be had at the one place where this stretch ends and the next begins."""
        own, other = self.speed("speed"), next_one.speed("speed")
        if own is None or other is None:
            return True
        (slower, loose), (faster, tight) = sorted(((own, self.tolerance), (other, next_one.tolerance)))
        return slower * (1.0 + loose) >= faster * (1.0 - tight)


class TurningConstantSpeed(ConstantSpeed, turns=True, first=True):
    """Even speed of an output that turns from one place to another."""


class TimeRatio(Wish):
    """A quick return: the time of the working stroke over that of the return."""

    at_least: float = required(
        "the working stroke takes at least so many times the time of the return", ge=0.01, le=100.0
    )


class Dwell(Wish):
    """A near-dwell: the slider stays close to an end for a driving angle."""

    at: Literal["retracted", "extended"] = required("the end that it stays close to")
    within_mm: Way = required("how far in mm from the end it may be; 0 would be an exact dwell")
    for_angle_rad: float = angle("driving angle {unit} of the dwell", "for", needed=True, of=Positive)


class TurningDwell(Dwell, turns=True, first=True):
    """A near-dwell of an output that turns."""


class SpeedAt(Wish):
    """The speed at one place: bounds, or as low or as high as may be."""

    at_mm: Length = required("displacement in mm at which the speed counts")
    at_least_mm_s: Positive | None = optional("least speed there in mm/s")
    at_most_mm_s: Positive | None = optional("greatest speed there in mm/s")
    stroke: StrokeName = optional("on the way out (working) or on the way back (return)", "working")
    make: Literal["slowest", "fastest"] | None = optional(
        "in place of bounds: as slow or as fast there as the goal allows, which needs hard: false"
    )

    @model_validator(mode="after")
    def _bounds_or_make(self) -> Self:
        low, high = (f"{bound}_{self.SPEED}" for bound in ("at_least", "at_most"))
        bounds = given(self, (low, high))
        if self.make is None and not bounds:
            raise fault("", f"says nothing of the speed; give {low}, {high} or make")
        if self.make is not None and bounds:
            raise fault(bounds[0], f"given, and make: {self.make} too, but only one of them can count; keep one")
        if self.make is not None and self.hard:
            raise fault("make", f"{self.make} has no bound that could be kept; hard: false is right with it")
        require(self, f"{high} >= {low}")
        return self


class TurningSpeedAt(SpeedAt, turns=True, first=True):
    """The speed of an output that turns at one place."""


class GentleStop(Wish):
    """A gentle stop: the greatest deceleration, or speed, over a stretch of the stroke or of the whole cycle."""

    from_mm: Way | None = optional(
        "displacement in mm where the stretch begins, the smaller; left out: the retracted end"
    )
    to_mm: Length | None = optional("displacement in mm where the stretch ends, the larger; left out: the extended end")
    deceleration_at_most_mm_s2: Positive | None = optional(
        "greatest deceleration over the stretch in mm/s^2: by how much the speed falls"
    )
    speed_at_most_mm_s: Positive | None = optional("in place of it: greatest speed over the stretch in mm/s")
    stroke: Literal["working", "return", "both"] = optional(
        "on the way out (working), on the way back (return), or on both ways, about one end or all round", "working"
    )
    from_rad: float = angle(
        "in place of places: driving angle {unit} where the stretch begins, the smaller; negative before the retracted "
        "end, where phi1 is 0",
        "from_phi1",
    )
    to_rad: float = angle("driving angle {unit} where the stretch ends, the larger", "to_phi1")

    @property
    def driving_rad(self) -> tuple[float, float] | None:
        """Both driving angles in rad; None for a stretch between places."""
        return (self.from_rad, self.to_rad) if key_of(self, "from_phi1") else None

    @property
    def bound(self) -> tuple[str, float]:
        """What is bounded, ``speed`` or ``deceleration``, and its greatest value in the unit of the file."""
        speed = getattr(self, self.bound_key("speed"))
        return ("deceleration", getattr(self, self.bound_key("deceleration"))) if speed is None else ("speed", speed)

    def bound_key(self, quantity: str) -> str:
        """The key of a bound of ``speed`` or ``deceleration``."""
        return f"{quantity}_at_most_{self.SPEED}{'2' if quantity == 'deceleration' else ''}"

    def ends(self, stroke: float) -> tuple[float, float]:
        """Both places in the unit of the file, on a stroke in that unit."""
        end = self.place("to")
        return self.place("from") or 0.0, stroke if end is None else end

    @model_validator(mode="after")
    def _one_bound_and_a_length(self) -> Self:
        require(self, f"one of {self.bound_key('deceleration')} {self.bound_key('speed')}")
        require(self, f"to_{self.PLACE} > from_{self.PLACE}")
        start, end = self.place("from"), self.place("to")
        if self.stroke == "both" and start and end is not None:
            raise fault(
                "stroke",
                f"both given from {start:g} to {end:g} {self.PLACE}; a wish for each stroke is right, or leave out "
                f"from_{self.PLACE} or to_{self.PLACE}, so that both ways meet at an end",
            )
        return self

    @model_validator(mode="after")
    def _places_or_driving_angles(self) -> Self:
        ends, places = [spellings(f"{end}_phi1") for end in ("from", "to")], (f"from_{self.PLACE}", f"to_{self.PLACE}")
        angles = given(self, (*ends[0], *ends[1]))
        if not angles:
            return self
        if beside := given(self, places):
            raise fault(
                beside[0],
                f"{listed((*beside, *angles), 'and')} are given: places and driving angles are mixed; "
                f"{' and '.join(places)}, or from_phi1_deg and to_phi1_deg, are right",
            )
        for names in ends:
            require(self, f"one of {' '.join(names)}")
        if "stroke" in self.model_fields_set:
            raise fault("stroke", "given with driving angles, which tell the stroke themselves; leave it out")
        if not self.from_rad < self.to_rad:
            start, end = (key_of(self, f"{end}_phi1") for end in ("from", "to"))
            raise fault(end, f"{getattr(self, end):g} given, which is not over {start}; a larger angle is right")
        return self


class TurningGentleStop(GentleStop, turns=True, first=True):
    """A gentle stop of an output that turns."""


class Position(Wish):
    """A place that the slider passes at a driving angle."""

    at_mm: Way = required("displacement in mm to pass")
    tolerance_mm: Length = required("how far in mm the slider may be from it at that angle")
    driving_rad: float = angle("driving angle {unit} at which it is passed", "phi1", needed=True, of=Positive)
    stroke: StrokeName | None = optional(
        "on the way out (working) or on the way back (return); left out: out, until a displacement of the list is "
        "smaller than the one before it"
    )


class TurningPosition(Position, turns=True, first=True):
    """A place that an output that turns passes at a driving angle."""


class WorkingStroke(Wish):
    """The driving angle that the working stroke takes."""

    driving_rad: float = angle("driving angle {unit}", "angle", needed=True, of=Positive)
    within_rad: float = angle("how far {unit} it may be from that", "tolerance", of=Annotated[float, Field(ge=0.0)])


class Wishes(Model):
    """What a person wishes of the motion."""

    time_ratio: TimeRatio | None = optional("time of the working stroke over the time of the return; left out: free")
    working_stroke: WorkingStroke | None = optional("driving angle that the working stroke takes; left out: free")
    constant_speed: Wished[ConstantSpeed] = optional("stretches of even speed, a list", ())
    dwell: Wished[Dwell] = optional("near-dwells at the ends of the stroke, a list", ())
    speed_at: Wished[SpeedAt] = optional("slow or fast at places, a list", ())
    gentle_stop: Wished[GentleStop] = optional(GENTLE_STOPS, ())
    positions: Wished[Position] = optional("places to pass at driving angles, a list in the order of the angle", ())

    @model_validator(mode="after")
    def _even_stretches_are_apart(self) -> Self:
        for stroke in ("working", "return"):
            own = [(number, wish) for number, wish in enumerate(self.constant_speed) if wish.stroke == stroke]
            own.sort(key=lambda one: one[1].place("from"))
            for (_, low), (number, high) in pairwise(own):
                (start, end), begins = (low.place("from"), low.place("to")), high.place("from")
                if begins < end or (begins == end and not low.agrees(high)):
                    raise fault(
                        f"constant_speed.{number}.from_{high.PLACE}",
                        f"{begins:g} given, but even speed is wished from {start:g} to {end:g} {high.PLACE} of "
                        f"the same stroke too; over {end:g} is right",
                    )
        return self

    @model_validator(mode="after")
    def _positions_follow_each_other(self) -> Self:
        strokes = list(strokes_of(self.positions))
        ways = list(zip(self.positions, strokes, strict=True))
        for number, ((before, earlier), (after, later)) in enumerate(pairwise(ways), 1):
            if not before.driving_rad < after.driving_rad:
                name = key_of(after, "phi1")
                raise fault(
                    f"positions.{number}.{name}",
                    f"{getattr(after, name):g} given, which is not over the angle before it; the driving angles of the "
                    "list must rise",
                )
            if earlier == "return" and later == "working":
                raise fault(
                    f"positions.{number}.stroke", "working given after a position on the return; return is right"
                )
            back = later == "return"
            there, here = before.place("at"), after.place("at")
            if earlier == later and not (here < there if back else here > there):
                raise fault(
                    f"positions.{number}.at_{after.PLACE}",
                    f"{here:g} follows {there:g} in the {later} stroke, where displacements "
                    f"{'fall' if back else 'rise'}",
                )
        return self


class TurningWishes(Wishes):
    """What a person wishes of the motion of an output that turns."""

    constant_speed: Wished[TurningConstantSpeed] = optional("stretches of even speed, a list", ())
    dwell: Wished[TurningDwell] = optional("near-dwells at the ends of the stroke, a list", ())
    speed_at: Wished[TurningSpeedAt] = optional("slow or fast at places, a list", ())
    gentle_stop: Wished[TurningGentleStop] = optional(GENTLE_STOPS, ())
    positions: Wished[TurningPosition] = optional(
        "places to pass at driving angles, a list in the order of the angle", ()
    )


def strokes_of(positions: Sequence[Position]) -> Iterator[StrokeName]:
    """The stroke of each position: as given, or the working one until a displacement falls."""
    stroke: StrokeName = "working"
    for before, position in zip((None, *positions), positions, strict=False):
        if position.stroke is not None:
            stroke = position.stroke
        elif before is not None and position.place("at") < before.place("at"):
            stroke = "return"
        yield stroke
