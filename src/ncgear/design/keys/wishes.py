"""What a person wishes of the motion: even speed, quick return, dwells, speeds and positions; hard or soft.

Places and speeds of an output that slides are in mm and mm/s, those of one that turns in deg and rad/s.  Each kind of
wish with a place has one model for either, and shares its rules in a base.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

from pydantic import Field, Strict, model_validator

from ncgear.design.keys.base import (
    LONGEST_MM,
    Length,
    Model,
    Positive,
    allow_one,
    angle_rad,
    fault,
    given,
    require_one,
    spellings,
)

MOST_WISHES = 50
"""Wishes of a kind: more than a person writes."""

LEAST_TOLERANCE = 1e-4
"""A hundredth of a percent of the speed: a hundredth of the usual tolerance, and more than teeth hold."""

GENTLE_STOPS = (
    "greatest decelerations, or speeds, over stretches of the stroke or of the whole cycle, a list; over the whole "
    "cycle optimize.limits.peak_acceleration_mm_s2 and peak_jerk_mm_s3 hold too, and dwell keeps close to an end"
)

Place = Annotated[float, Field(ge=0.0, le=LONGEST_MM)]
StrokeName = Literal["working", "return"]


class Wish(Model):
    """What every wish has: whether it must be kept."""

    PLACE: ClassVar[str] = "mm"
    SPEED: ClassVar[str] = "mm_s"
    """The units of places and of speeds, at the ends of keys; a 2 follows in those of decelerations."""

    hard: bool = Field(default=True, description="true: the law must keep it; false: it has a weight in the goal")
    weight: Positive | None = Field(
        default=None,
        description="of a soft wish: 1 percent missed, of the speed, the deceleration or the cycle's driving angle, "
        "counts like so many percent of what is to be least; left out: 1",
    )

    def place(self, quantity: str) -> float:
        """The value of a key of a place, such as ``from`` or ``at``, in the unit of the file."""
        found: float = getattr(self, f"{quantity}_{self.PLACE}")
        return found

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


class Turning(Wish):
    """A wish of an output that turns."""

    PLACE: ClassVar[str] = "deg"
    SPEED: ClassVar[str] = "rad_s"


Angle = Annotated[float, Field(ge=0.0, lt=360.0)]
Swing = Annotated[float, Field(gt=0.0, lt=360.0)]


class EvenSpeed(Wish):
    """Even speed from one place to another."""

    tolerance: float = Field(
        default=0.005,
        ge=LEAST_TOLERANCE,
        le=0.5,
        description="how far the speed may be from one value, as a share of it: 0.005 is half a percent",
    )
    stroke: StrokeName = Field(default="working", description="on the way out (working) or on the way back (return)")

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        start, end = self.place("from"), self.place("to")
        if not start < end:
            raise fault(
                f"to_{self.PLACE}",
                f"{end:g} given after from_{self.PLACE}: {start:g}; a larger displacement is right",
            )
        return self

    def agrees(self, next_one: EvenSpeed) -> bool:
        """Whether both speeds can be had at the one place where this stretch ends and the next begins."""
        own, other = self.speed("speed"), next_one.speed("speed")
        if own is None or other is None:
            return True
        (slower, loose), (faster, tight) = sorted(((own, self.tolerance), (other, next_one.tolerance)))
        return slower * (1.0 + loose) >= faster * (1.0 - tight)


class EvenPlaces(Wish):
    """Places in mm."""

    from_mm: Length = Field(description="displacement in mm where the even speed begins, the smaller of both")
    to_mm: Length = Field(description="displacement in mm where the even speed ends, the larger of both")


class EvenAngles(Turning):
    """Places in deg."""

    from_deg: Swing = Field(description="displacement in deg where the even speed begins, the smaller of both")
    to_deg: Swing = Field(description="displacement in deg where the even speed ends, the larger of both")


# Keys come from the last base to the first, so places stand before what all have, here and below.
class ConstantSpeed(EvenSpeed, EvenPlaces):
    """Even speed from one place to another."""

    speed_mm_s: Positive | None = Field(
        default=None, description="that one value in mm/s; left out: whatever the law makes of it"
    )


class TurningConstantSpeed(EvenSpeed, EvenAngles):
    """Even speed of an output that turns from one place to another."""

    speed_rad_s: Positive | None = Field(
        default=None, description="that one value in rad/s; left out: whatever the law makes of it"
    )


class TimeRatio(Wish):
    """A quick return: the time of the working stroke over that of the return."""

    at_least: float = Field(
        ge=0.01, le=100.0, description="the working stroke takes at least so many times the time of the return"
    )


class Dwelling(Wish):
    """A near-dwell: the output stays close to an end for a driving angle."""

    for_rad: Positive | None = Field(default=None, description="driving angle in rad of the dwell")
    for_deg: Positive | None = Field(default=None, description="driving angle in degrees of the dwell")
    for_pi: Positive | None = Field(default=None, description="driving angle in multiples of pi of the dwell")

    if TYPE_CHECKING:
        at: Literal["retracted", "extended"]

    @property
    def for_angle_rad(self) -> float:
        """Driving angle of the dwell in rad."""
        return angle_rad(self, "for")

    @model_validator(mode="after")
    def _one_angle(self) -> Self:
        require_one(self, spellings("for"))
        return self


class DwellPlace(Wish):
    """Where it dwells, in mm."""

    at: Literal["retracted", "extended"] = Field(description="the end that the slider stays close to")
    within_mm: Place = Field(description="how far in mm from the end it may be; 0 would be an exact dwell")


class DwellAngle(Turning):
    """Where it dwells, in deg."""

    at: Literal["retracted", "extended"] = Field(description="the end that the output stays close to")
    within_deg: Angle = Field(description="how far in deg from the end it may be; 0 would be an exact dwell")


class Dwell(Dwelling, DwellPlace):
    """A near-dwell: the slider stays close to an end for a driving angle."""


class TurningDwell(Dwelling, DwellAngle):
    """A near-dwell of an output that turns."""


class PlaceSpeed(Wish):
    """The speed at one place: bounds, or as low or as high as may be."""

    stroke: StrokeName = Field(default="working", description="on the way out (working) or on the way back (return)")
    make: Literal["slowest", "fastest"] | None = Field(
        default=None,
        description="in place of bounds: as slow or as fast there as the goal allows, which needs hard: false",
    )

    @model_validator(mode="after")
    def _bounds_or_make(self) -> Self:
        low, high = (f"{bound}_{self.SPEED}" for bound in ("at_least", "at_most"))
        bounds = given(self, (low, high))
        if self.make is None and not bounds:
            raise fault("", f"says nothing of the speed; give {low}, {high} or make")
        if self.make is not None and bounds:
            raise fault(bounds[0], f"given with make: {self.make}, which is in its place; keep one")
        if self.make is not None and self.hard:
            raise fault("make", f"{self.make} has no bound that could be kept; hard: false is right with it")
        least, most = self.speed("at_least") or 0.0, self.speed("at_most")
        if most is not None and not least <= most:
            raise fault(high, f"{most:g} given, under {low}: {least:g}; {least:g} or over is right")
        return self


class SpeedPlace(Wish):
    """The place and the bounds in mm and mm/s."""

    at_mm: Length = Field(description="displacement in mm at which the speed counts")
    at_least_mm_s: Positive | None = Field(default=None, description="least speed there in mm/s")
    at_most_mm_s: Positive | None = Field(default=None, description="greatest speed there in mm/s")


class SpeedAngle(Turning):
    """The place and the bounds in deg and rad/s."""

    at_deg: Swing = Field(description="displacement in deg at which the speed counts")
    at_least_rad_s: Positive | None = Field(default=None, description="least speed there in rad/s")
    at_most_rad_s: Positive | None = Field(default=None, description="greatest speed there in rad/s")


class SpeedAt(PlaceSpeed, SpeedPlace):
    """The speed at one place: bounds, or as low or as high as may be."""


class TurningSpeedAt(PlaceSpeed, SpeedAngle):
    """The speed of an output that turns at one place."""


class Gentle(Wish):
    """A gentle stop: the greatest deceleration, or speed, over a stretch of the stroke or of the whole cycle."""

    stroke: Literal["working", "return", "both"] = Field(
        default="working",
        description="on the way out (working), on the way back (return), or on both ways, about one end or all round",
    )
    from_phi1_rad: float | None = Field(
        default=None, description="in place of places: driving angle in rad where the stretch begins, the smaller"
    )
    from_phi1_deg: float | None = Field(
        default=None, description="the same in degrees; negative before the retracted end, where phi1 is 0"
    )
    from_phi1_pi: float | None = Field(default=None, description="the same in multiples of pi")
    to_phi1_rad: float | None = Field(
        default=None, description="driving angle in rad where the stretch ends, the larger"
    )
    to_phi1_deg: float | None = Field(default=None, description="the same in degrees")
    to_phi1_pi: float | None = Field(default=None, description="the same in multiples of pi")

    @property
    def driving_rad(self) -> tuple[float, float] | None:
        """Both driving angles in rad; None for a stretch between places."""
        if not given(self, spellings("from_phi1")):
            return None
        return angle_rad(self, "from_phi1"), angle_rad(self, "to_phi1")

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
        start, end = self._given_ends()
        return start or 0.0, stroke if end is None else end

    def _given_ends(self) -> tuple[float | None, float | None]:
        return getattr(self, f"from_{self.PLACE}"), getattr(self, f"to_{self.PLACE}")

    @model_validator(mode="after")
    def _one_bound_and_a_length(self) -> Self:
        require_one(self, (self.bound_key("deceleration"), self.bound_key("speed")))
        start, end = self._given_ends()
        if start is not None and end is not None and not start < end:
            raise fault(
                f"to_{self.PLACE}",
                f"{end:g} given after from_{self.PLACE}: {start:g}; a larger displacement is right",
            )
        if self.stroke == "both" and start and end is not None:
            raise fault(
                "stroke",
                f"both given from {start:g} to {end:g} {self.PLACE}; a wish for each stroke is right, or leave out "
                f"from_{self.PLACE} or to_{self.PLACE}, so that both ways meet at an end",
            )
        return self

    @model_validator(mode="after")
    def _places_or_driving_angles(self) -> Self:
        ends = [spellings(f"{end}_phi1") for end in ("from", "to")]
        if not any(given(self, names) for names in ends):
            return self
        for names in ends:
            require_one(self, names)
        if beside := [name for name in (f"from_{self.PLACE}", f"to_{self.PLACE}") if getattr(self, name) is not None]:
            raise fault(beside[0], "given with driving angles, which are in its place; keep one")
        if "stroke" in self.model_fields_set:
            raise fault("stroke", "given with driving angles, which tell the stroke themselves; leave it out")
        if not angle_rad(self, "from_phi1") < angle_rad(self, "to_phi1"):
            (start,), (end,) = (given(self, names) for names in ends)
            raise fault(end, f"{getattr(self, end):g} given, which is not over {start}; a larger angle is right")
        return self


class GentlePlaces(Wish):
    """Places and bounds in mm, mm/s and mm/s^2."""

    from_mm: Place | None = Field(
        default=None,
        description="displacement in mm where the stretch begins, the smaller; left out: the retracted end",
    )
    to_mm: Length | None = Field(
        default=None, description="displacement in mm where the stretch ends, the larger; left out: the extended end"
    )
    deceleration_at_most_mm_s2: Positive | None = Field(
        default=None, description="greatest deceleration over the stretch in mm/s^2: by how much the speed falls"
    )
    speed_at_most_mm_s: Positive | None = Field(
        default=None, description="in place of it: greatest speed over the stretch in mm/s"
    )


class GentleAngles(Turning):
    """Places and bounds in deg, rad/s and rad/s^2."""

    from_deg: Angle | None = Field(
        default=None,
        description="displacement in deg where the stretch begins, the smaller; left out: the retracted end",
    )
    to_deg: Swing | None = Field(
        default=None, description="displacement in deg where the stretch ends, the larger; left out: the extended end"
    )
    deceleration_at_most_rad_s2: Positive | None = Field(
        default=None, description="greatest deceleration over the stretch in rad/s^2: by how much the speed falls"
    )
    speed_at_most_rad_s: Positive | None = Field(
        default=None, description="in place of it: greatest speed over the stretch in rad/s"
    )


class GentleStop(Gentle, GentlePlaces):
    """A gentle stop: the greatest deceleration, or speed, over a stretch of the stroke or of the whole cycle."""


class TurningGentleStop(Gentle, GentleAngles):
    """A gentle stop of an output that turns."""


class Passing(Wish):
    """A place that the output passes at a driving angle."""

    phi1_rad: Positive | None = Field(default=None, description="driving angle in rad at which it is passed")
    phi1_deg: Positive | None = Field(default=None, description="driving angle in degrees at which it is passed")
    phi1_pi: Positive | None = Field(default=None, description="driving angle in multiples of pi at which it is passed")
    stroke: StrokeName | None = Field(
        default=None,
        description="on the way out (working) or on the way back (return); left out: out, until a displacement of the "
        "list is smaller than the one before it",
    )

    @property
    def driving_rad(self) -> float:
        """Driving angle in rad."""
        return angle_rad(self, "phi1")

    @model_validator(mode="after")
    def _one_angle(self) -> Self:
        require_one(self, spellings("phi1"))
        return self


class PassedPlace(Wish):
    """The place in mm."""

    at_mm: Place = Field(description="displacement in mm to pass")
    tolerance_mm: Length = Field(description="how far in mm the slider may be from it at that angle")


class PassedAngle(Turning):
    """The place in deg."""

    at_deg: Angle = Field(description="displacement in deg to pass")
    tolerance_deg: Swing = Field(description="how far in deg the output may be from it at that angle")


class Position(Passing, PassedPlace):
    """A place that the slider passes at a driving angle."""


class TurningPosition(Passing, PassedAngle):
    """A place that an output that turns passes at a driving angle."""


class WorkingStroke(Wish):
    """The driving angle that the working stroke takes."""

    angle_rad: Positive | None = Field(default=None, description="driving angle in rad")
    angle_deg: Positive | None = Field(default=None, description="driving angle in degrees")
    angle_pi: Positive | None = Field(default=None, description="driving angle in multiples of pi")
    tolerance_rad: float | None = Field(default=None, ge=0.0, description="how far in rad it may be from that")
    tolerance_deg: float | None = Field(default=None, ge=0.0, description="how far in degrees it may be from that")
    tolerance_pi: float | None = Field(default=None, ge=0.0, description="the same in multiples of pi")

    @property
    def driving_rad(self) -> float:
        """Driving angle in rad."""
        return angle_rad(self, "angle")

    @property
    def within_rad(self) -> float:
        """Tolerance in rad."""
        return angle_rad(self, "tolerance")

    @model_validator(mode="after")
    def _one_angle(self) -> Self:
        require_one(self, spellings("angle"))
        allow_one(self, spellings("tolerance"))
        return self


class Timing(Model):
    """Wishes of times, and the rules of all lists."""

    time_ratio: TimeRatio | None = Field(
        default=None, description="time of the working stroke over the time of the return; left out: free"
    )
    working_stroke: WorkingStroke | None = Field(
        default=None, description="driving angle that the working stroke takes; left out: free"
    )

    if TYPE_CHECKING:
        constant_speed: tuple[EvenSpeed, ...]
        dwell: tuple[Dwelling, ...]
        speed_at: tuple[PlaceSpeed, ...]
        gentle_stop: tuple[Gentle, ...]
        positions: tuple[Passing, ...]

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
                name = given(after, spellings("phi1"))[0]
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


class Wishes(Timing):
    """What a person wishes of the motion."""

    constant_speed: Annotated[tuple[ConstantSpeed, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="stretches of even speed, a list"
    )
    dwell: Annotated[tuple[Dwell, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="near-dwells at the ends of the stroke, a list"
    )
    speed_at: Annotated[tuple[SpeedAt, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="slow or fast at places, a list"
    )
    gentle_stop: Annotated[tuple[GentleStop, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description=GENTLE_STOPS
    )
    positions: Annotated[tuple[Position, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="places to pass at driving angles, a list in the order of the angle"
    )


class TurningWishes(Timing):
    """What a person wishes of the motion of an output that turns."""

    constant_speed: Annotated[tuple[TurningConstantSpeed, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="stretches of even speed, a list"
    )
    dwell: Annotated[tuple[TurningDwell, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="near-dwells at the ends of the stroke, a list"
    )
    speed_at: Annotated[tuple[TurningSpeedAt, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="slow or fast at places, a list"
    )
    gentle_stop: Annotated[tuple[TurningGentleStop, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description=GENTLE_STOPS
    )
    positions: Annotated[tuple[TurningPosition, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="places to pass at driving angles, a list in the order of the angle"
    )


def strokes_of(positions: Sequence[Passing]) -> Iterator[StrokeName]:
    """The stroke of each position: as given, or the working one until a displacement falls."""
    stroke: StrokeName = "working"
    for before, position in zip((None, *positions), positions, strict=False):
        if position.stroke is not None:
            stroke = position.stroke
        elif before is not None and position.place("at") < before.place("at"):
            stroke = "return"
        yield stroke
