"""From keys to values: the wishes of a design's motion, refused where the mechanism or each other contradict them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from math import degrees, inf, pi

from ncgear.design.keys.base import given, spellings
from ncgear.design.keys.design import Design
from ncgear.design.keys.optimize import Optimize
from ncgear.design.keys.wishes import Dwell, GentleStop, Position, Wishes, strokes_of
from ncgear.design.keys.wishes import WorkingStroke as WorkingStrokeKeys
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.kinematics import wishes as values
from ncgear.kinematics.wishes import End, Stroke, nearest_dwell_mm
from ncgear.mechanisms.mechanism import Mechanism, Output
from ncgear.numerics.bounds import shown_above, shown_below

DIGITS = 3
"""Significant digits of the nearest dwell; it is rounded up, so that it can be made."""


def motion_wishes_of(design: Design, linkage: Mechanism, cycle_rad: float) -> tuple[values.Wish, ...]:
    """The wishes of a design's motion, of a mechanism whose cycle takes a driving angle of ``cycle_rad``.

    Raises WrongInput for places outside the stroke, angles outside the cycle and wishes that contradict each other,
    NoSuchMechanism for an exact dwell.
    """
    asked = design.wishes
    _refuse_places(asked, linkage)
    _refuse_angles(asked, cycle_rad)
    ratio_max = (design.optimize or Optimize()).limits.ratio_max
    for number, dwell in enumerate(asked.dwell):
        if dwell.place("within") == 0.0:
            raise _exact_dwell(f"wishes.dwell.{number}.within_{dwell.PLACE}", dwell, linkage, ratio_max)
    output = linkage.OUTPUT
    return (
        *_constant_speeds(asked, output),
        *_times(asked),
        *_dwells(asked, output),
        *_speeds(asked, output),
        *_gentle(asked, linkage, cycle_rad),
        *_positions(asked, output),
    )


def _constant_speeds(asked: Wishes, output: Output) -> Iterator[values.Wish]:
    for number, wish in enumerate(asked.constant_speed):
        yield values.ConstantSpeed(
            key=f"wishes.constant_speed.{number}",
            weight=wish.soft_weight,
            output=output,
            from_mm=wish.place("from") / output.place.factor,
            to_mm=wish.place("to") / output.place.factor,
            tolerance=wish.tolerance,
            stroke=Stroke(wish.stroke),
            speed_mm_s=wish.speed("speed"),
        )


def _times(asked: Wishes) -> Iterator[values.Wish]:
    if (ratio := asked.time_ratio) is not None:
        yield values.TimeRatio(key="wishes.time_ratio", weight=ratio.soft_weight, at_least=ratio.at_least)
    if (stroke := asked.working_stroke) is not None:
        yield values.WorkingStroke(
            key="wishes.working_stroke",
            weight=stroke.soft_weight,
            angle_rad=stroke.driving_rad,
            tolerance_rad=stroke.within_rad,
        )


def _dwells(asked: Wishes, output: Output) -> Iterator[values.Wish]:
    for number, wish in enumerate(asked.dwell):
        yield values.Dwell(
            key=f"wishes.dwell.{number}",
            weight=wish.soft_weight,
            output=output,
            end=End(wish.at),
            within_mm=wish.place("within") / output.place.factor,
            for_rad=wish.for_angle_rad,
        )


def _speeds(asked: Wishes, output: Output) -> Iterator[values.Wish]:
    for number, wish in enumerate(asked.speed_at):
        key, stroke = f"wishes.speed_at.{number}", Stroke(wish.stroke)
        if wish.make is not None:
            fastest = wish.make == "fastest"
            at = wish.place("at") / output.place.factor
            yield values.ExtremeSpeed(
                key=key, weight=wish.soft_weight, output=output, at_mm=at, stroke=stroke, fastest=fastest
            )
        else:
            yield values.SpeedAt(
                key=key,
                weight=wish.soft_weight,
                output=output,
                at_mm=wish.place("at") / output.place.factor,
                stroke=stroke,
                least_mm_s=wish.speed("at_least") or 0.0,
                most_mm_s=wish.speed("at_most") or inf,
            )


def _gentle(asked: Wishes, linkage: Mechanism, cycle_rad: float) -> Iterator[values.Wish]:
    """Driving ranges are held over the crank angles of an even crank, until a law is known."""
    output, even = linkage.OUTPUT, 2.0 * pi / cycle_rad
    for number, wish in enumerate(asked.gentle_stop):
        start, end = (place / output.place.factor for place in wish.ends(output.place.factor * linkage.stroke_mm))
        key, stroke = f"wishes.gentle_stop.{number}", None if wish.stroke == "both" else Stroke(wish.stroke)
        driving = None
        if (ends := wish.driving_rad) is not None:
            driving = values.DrivingRange(*ends, values.CrankStretch(even * ends[0], even * ends[1]))
        bounded, most = wish.bound
        made: Callable[..., values.Wish]
        if bounded == "speed":
            made = partial(values.GentleSpeed, most_mm_s=most)
        else:
            made = partial(values.GentleStop, most_mm_s2=most)
        yield made(
            key=key,
            weight=wish.soft_weight,
            output=output,
            from_mm=start,
            to_mm=end,
            stroke=stroke,
            driving=driving,
        )


def _positions(asked: Wishes, output: Output) -> Iterator[values.Wish]:
    for number, (wish, stroke) in enumerate(zip(asked.positions, strokes_of(asked.positions), strict=True)):
        yield values.Position(
            key=f"wishes.positions.{number}",
            weight=wish.soft_weight,
            output=output,
            at_mm=wish.place("at") / output.place.factor,
            phi1_rad=wish.driving_rad,
            tolerance_mm=wish.place("tolerance") / output.place.factor,
            stroke=Stroke(stroke),
        )


def _refuse_places(asked: Wishes, linkage: Mechanism) -> None:
    """Refuse places beyond the stroke, and speeds at its very end, where the output stands still."""
    unit = linkage.OUTPUT.place
    stroke, end = unit.factor * linkage.stroke_mm, unit.ending
    inside = [
        *((f"constant_speed.{number}.to", wish.place("to")) for number, wish in enumerate(asked.constant_speed)),
        *((f"speed_at.{number}.at", wish.place("at")) for number, wish in enumerate(asked.speed_at)),
        *((f"dwell.{number}.within", wish.place("within")) for number, wish in enumerate(asked.dwell)),
    ]
    for number, gentle in enumerate(asked.gentle_stop):
        inside.append((f"gentle_stop.{number}.from", gentle.ends(stroke)[0]))
    for key, place in inside:
        if not place < stroke:
            raise WrongInput(
                f"{place:g} given, but the stroke is {shown_below(stroke)} {unit.text}; less is right",
                key=f"wishes.{key}_{end}",
            )
    reaching = [
        *((f"positions.{number}.at", wish.place("at")) for number, wish in enumerate(asked.positions)),
        *((f"gentle_stop.{number}.to", wish.ends(stroke)[1]) for number, wish in enumerate(asked.gentle_stop)),
    ]
    for key, place in reaching:
        if not place <= stroke:
            raise WrongInput(
                f"{place:g} given, but the stroke is {shown_below(stroke)} {unit.text}; at most that is right",
                key=f"wishes.{key}_{end}",
            )


def _refuse_angles(asked: Wishes, cycle_rad: float) -> None:
    """Refuse angles beyond the cycle, and angles that cannot be had together."""
    angles: list[tuple[str, Dwell | Position | WorkingStrokeKeys, str, float]] = [
        *((f"dwell.{number}", wish, "for", wish.for_angle_rad) for number, wish in enumerate(asked.dwell)),
        *((f"positions.{number}", wish, "phi1", wish.driving_rad) for number, wish in enumerate(asked.positions)),
    ]
    if asked.working_stroke is not None:
        angles.append(("working_stroke", asked.working_stroke, "angle", asked.working_stroke.driving_rad))
    for group, wish, quantity, angle in angles:
        if not angle < cycle_rad:
            name = given(wish, spellings(quantity))[0]
            raise WrongInput(
                f"{getattr(wish, name):g} given, but a cycle takes {degrees(cycle_rad):g} deg of the driving angle; "
                "less is right",
                key=f"wishes.{group}.{name}",
            )
    for number, gentle in enumerate(asked.gentle_stop):
        _refuse_driving_range(f"wishes.gentle_stop.{number}", gentle, cycle_rad)
    _refuse_ratio_and_angle(asked, cycle_rad)
    _refuse_two_dwells(asked, cycle_rad)


def _refuse_driving_range(key: str, wish: GentleStop, cycle_rad: float) -> None:
    """Refuse driving angles beyond the cycle to either side, and a stretch that leaves nothing of it."""
    if (ends := wish.driving_rad) is None:
        return
    start, end = ends
    for name, beyond in (("from", start <= -cycle_rad), ("to", end > cycle_rad), ("to", end - start >= cycle_rad)):
        if beyond:
            raise WrongInput(
                f"from {degrees(start):g} to {degrees(end):g} deg given, but a cycle takes {degrees(cycle_rad):g} deg "
                "of the driving angle from the retracted end on, and as many before it; a part of a cycle within them "
                "is right, or stroke: both without places for all of it",
                key=f"{key}.{given(wish, spellings(f'{name}_phi1'))[0]}",
            )


def _refuse_ratio_and_angle(asked: Wishes, cycle_rad: float) -> None:
    """Refuse a time ratio that the wished working stroke is too short for."""
    ratio, stroke = asked.time_ratio, asked.working_stroke
    if ratio is None or stroke is None or not (ratio.hard and stroke.hard):
        return
    longest = stroke.driving_rad + stroke.within_rad
    if longest * (1.0 + ratio.at_least) < cycle_rad * ratio.at_least * (1.0 - values.NEGLIGIBLE):
        raise WrongInput(
            f"{ratio.at_least:g} given, but a working stroke of {degrees(longest):g} deg takes "
            f"{shown_below(longest / (cycle_rad - longest))} times the time of the return; at most that is right, or "
            "another wishes.working_stroke",
            key="wishes.time_ratio.at_least",
        )


def _refuse_two_dwells(asked: Wishes, cycle_rad: float) -> None:
    """Refuse dwells at both ends that leave no driving angle to the ways between them."""
    longest = {
        end: max((wish.for_angle_rad for wish in asked.dwell if wish.hard and wish.at == end), default=0.0)
        for end in ("retracted", "extended")
    }
    together = sum(longest.values())
    if not together < cycle_rad:
        raise WrongInput(
            f"dwells at both ends for {degrees(together):g} deg together, but a cycle takes {degrees(cycle_rad):g} deg "
            "of the driving angle; less is right",
            key="wishes.dwell",
        )


def _exact_dwell(key: str, dwell: Dwell, linkage: Mechanism, ratio_max: float) -> NoSuchMechanism:
    """The refusal of an exact dwell, with the nearest one that can be made."""
    output = linkage.OUTPUT
    nearest = output.place.factor * nearest_dwell_mm(linkage, End(dwell.at), dwell.for_angle_rad, ratio_max)
    return NoSuchMechanism(
        f"0 given, an exact dwell, but gears of a finite ratio never let the crank stand still, and the {output.name} "
        f"stands still at its {dwell.at} end for an instant only; with ratios up to {ratio_max:g} "
        f"(optimize.limits.ratio_max) it can stay within {shown_above(nearest, DIGITS)} {output.place.text} for "
        f"{degrees(dwell.for_angle_rad):g} deg: that or more is right",
        key=key,
    )
