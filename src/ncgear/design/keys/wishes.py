"""What a person wishes of the motion: even speed, quick return, dwells, speeds and positions; hard or soft."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Annotated, Literal, Self

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

Place = Annotated[float, Field(ge=0.0, le=LONGEST_MM)]
StrokeName = Literal["working", "return"]


class Wish(Model):
    """What every wish has: whether it must be kept."""

    hard: bool = Field(default=True, description="true: the law must keep it; false: it has a weight in the goal")
    weight: Positive | None = Field(
        default=None,
        description="of a soft wish: 1 percent missed, of the speed or of the cycle's driving angle, counts like so "
        "many percent of what is to be least; left out: 1",
    )

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

    from_mm: Length = Field(description="displacement in mm where the even speed begins, the smaller of both")
    to_mm: Length = Field(description="displacement in mm where the even speed ends, the larger of both")
    tolerance: float = Field(
        default=0.005,
        ge=LEAST_TOLERANCE,
        le=0.5,
        description="how far the speed may be from one value, as a share of it: 0.005 is half a percent",
    )
    stroke: StrokeName = Field(default="working", description="on the way out (working) or on the way back (return)")
    speed_mm_s: Positive | None = Field(
        default=None, description="that one value in mm/s; left out: whatever the law makes of it"
    )

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if not self.from_mm < self.to_mm:
            raise fault(
                "to_mm", f"{self.to_mm:g} given after from_mm: {self.from_mm:g}; a larger displacement is right"
            )
        return self

    def agrees(self, next_one: ConstantSpeed) -> bool:
        """Whether both speeds can be had at the one place where this stretch ends and the next begins."""
        if self.speed_mm_s is None or next_one.speed_mm_s is None:
            return True
        slower, faster = sorted((self, next_one), key=lambda wish: wish.speed_mm_s or 0.0)
        return (slower.speed_mm_s or 0.0) * (1.0 + slower.tolerance) >= (faster.speed_mm_s or 0.0) * (
            1.0 - faster.tolerance
        )


class TimeRatio(Wish):
    """A quick return: the time of the working stroke over that of the return."""

    at_least: float = Field(
        ge=0.01, le=100.0, description="the working stroke takes at least so many times the time of the return"
    )


class Dwell(Wish):
    """A near-dwell: the slider stays close to an end for a driving angle."""

    at: Literal["retracted", "extended"] = Field(description="the end that the slider stays close to")
    within_mm: Place = Field(description="how far in mm from the end it may be; 0 would be an exact dwell")
    for_rad: Positive | None = Field(default=None, description="driving angle in rad of the dwell")
    for_deg: Positive | None = Field(default=None, description="driving angle in degrees of the dwell")
    for_pi: Positive | None = Field(default=None, description="driving angle in multiples of pi of the dwell")

    @property
    def for_angle_rad(self) -> float:
        """Driving angle of the dwell in rad."""
        return angle_rad(self, "for")

    @model_validator(mode="after")
    def _one_angle(self) -> Self:
        require_one(self, spellings("for"))
        return self


class SpeedAt(Wish):
    """The speed at one place: bounds, or as low or as high as may be."""

    at_mm: Length = Field(description="displacement in mm at which the speed counts")
    stroke: StrokeName = Field(default="working", description="on the way out (working) or on the way back (return)")
    at_least_mm_s: Positive | None = Field(default=None, description="least speed there in mm/s")
    at_most_mm_s: Positive | None = Field(default=None, description="greatest speed there in mm/s")
    make: Literal["slowest", "fastest"] | None = Field(
        default=None,
        description="in place of bounds: as slow or as fast there as the goal allows, which needs hard: false",
    )

    @model_validator(mode="after")
    def _bounds_or_make(self) -> Self:
        bounds = given(self, ("at_least_mm_s", "at_most_mm_s"))
        if self.make is None and not bounds:
            raise fault("", "says nothing of the speed; give at_least_mm_s, at_most_mm_s or make")
        if self.make is not None and bounds:
            raise fault(bounds[0], f"given with make: {self.make}, which is in its place; keep one")
        if self.make is not None and self.hard:
            raise fault("make", f"{self.make} has no bound that could be kept; hard: false is right with it")
        least, most = self.at_least_mm_s or 0.0, self.at_most_mm_s
        if most is not None and not least <= most:
            raise fault("at_most_mm_s", f"{most:g} given, under at_least_mm_s: {least:g}; {least:g} or over is right")
        return self


class Position(Wish):
    """A place that the slider passes at a driving angle."""

    at_mm: Place = Field(description="displacement in mm to pass")
    phi1_rad: Positive | None = Field(default=None, description="driving angle in rad at which it is passed")
    phi1_deg: Positive | None = Field(default=None, description="driving angle in degrees at which it is passed")
    phi1_pi: Positive | None = Field(default=None, description="driving angle in multiples of pi at which it is passed")
    tolerance_mm: Length = Field(description="how far in mm the slider may be from it at that angle")
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


class Wishes(Model):
    """What a person wishes of the motion."""

    constant_speed: Annotated[tuple[ConstantSpeed, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="stretches of even speed, a list"
    )
    time_ratio: TimeRatio | None = Field(
        default=None, description="time of the working stroke over the time of the return; left out: free"
    )
    dwell: Annotated[tuple[Dwell, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="near-dwells at the ends of the stroke, a list"
    )
    speed_at: Annotated[tuple[SpeedAt, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="slow or fast at places, a list"
    )
    positions: Annotated[tuple[Position, ...], Strict(False), Field(max_length=MOST_WISHES)] = Field(
        default=(), description="places to pass at driving angles, a list in the order of the angle"
    )
    working_stroke: WorkingStroke | None = Field(
        default=None, description="driving angle that the working stroke takes; left out: free"
    )

    @model_validator(mode="after")
    def _even_stretches_are_apart(self) -> Self:
        for stroke in ("working", "return"):
            own = [(number, wish) for number, wish in enumerate(self.constant_speed) if wish.stroke == stroke]
            own.sort(key=lambda one: one[1].from_mm)
            for (_, low), (number, high) in pairwise(own):
                if high.from_mm < low.to_mm or (high.from_mm == low.to_mm and not low.agrees(high)):
                    raise fault(
                        f"constant_speed.{number}.from_mm",
                        f"{high.from_mm:g} given, but even speed is wished from {low.from_mm:g} to {low.to_mm:g} mm of "
                        f"the same stroke too; over {low.to_mm:g} is right",
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
            if earlier == later and not (after.at_mm < before.at_mm if back else after.at_mm > before.at_mm):
                raise fault(
                    f"positions.{number}.at_mm",
                    f"{after.at_mm:g} follows {before.at_mm:g} in the {later} stroke, where displacements "
                    f"{'fall' if back else 'rise'}",
                )
        return self


def strokes_of(positions: Sequence[Position]) -> Iterator[StrokeName]:
    """The stroke of each position: as given, or the working one until a displacement falls."""
    stroke: StrokeName = "working"
    for before, position in zip((None, *positions), positions, strict=False):
        if position.stroke is not None:
            stroke = position.stroke
        elif before is not None and position.at_mm < before.at_mm:
            stroke = "return"
        yield stroke
