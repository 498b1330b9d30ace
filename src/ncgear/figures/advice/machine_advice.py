"""Advices about a machine: a linkage that may lock, gears that a build refuses, missed wishes, a drawing's unit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import atan, copysign, degrees, exp, log, pi, radians, sin

from ncgear.design.keys.pitch_shapes import UNIT_MM, DxfContour, SvgContour
from ncgear.design.mechanisms import lengths_of
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.figures.advice.values import ONLY_TEETH, Advice, Kind, NotJudged, Remedy
from ncgear.figures.numbers import fixed, placed, to_digits
from ncgear.figures.wished import missed_by
from ncgear.kinematics.crank_stretches import driving_rad
from ncgear.mechanisms.mechanism import Mechanism, RodMechanism
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.project.drive import Drive
from ncgear.project.tooth_form import require_pushing_flanks
from ncgear.ratio.laws.closed_curve import JOINED

FRICTION = 0.25
"""Coefficient of friction of steel on steel at rest without grease, which is 0.15 to 0.3."""

FLATTEST_DEG = round(degrees(atan(FRICTION)))
"""Transmission angle in degrees, under which friction may lock: the angle of friction.

A rod at angle b to a slider's line pushes it by F cos(b), and its guide rubs by FRICTION F sin(b), which is as much
where tan(90 deg - b) = FRICTION.  The same holds of a lever's pin in the slot of its ram.  A rocker rubs at its axis,
on a shorter arm; there less than a quarter of the coupler's force turns it, and small errors of lengths lock it.
Textbooks recommend 40 deg and more (e.g. R. L. Norton, "Design of Machinery", 5th edition, 2012, section 3.3), for
quiet and light machines: between these angles friction costs power, but does not lock.
"""

FARTHEST = log(4.0)
"""Logarithm of the largest factor in the search for another length."""

HALVINGS = 20
"""Steps of that search; they leave a millionth of a length, and told are three digits."""


def transmission_angle(drive: Drive) -> Advice | None:
    """A linkage whose output is hardly pushed along its way, of the crank angles that it turns through.

    Where the file says how a rod's slider rubs in its guide, it is judged by that: under its angle of friction, mu or
    more of the push is eaten whatever the load is, so that a slider at rest stays there, though one that runs may be
    carried through by its mass.  The angle is least where the linkage says, or where an open law ends.
    """
    linkage, covered = drive.linkage, drive.transmission.lobes.range
    end = covered.driven_rad if covered else 2.0 * pi
    least_rad, crank_rad = linkage.least_transmission(end)
    friction = guide_friction(drive)
    limit, angle = degrees(atan(friction)) if friction else FLATTEST_DEG, degrees(least_rad)
    if angle >= limit:
        return None
    at, output = degrees(driving_rad(drive.machine, crank_rad)), linkage.OUTPUT.name
    share = fixed(100.0 * sin(least_rad), 0)
    locks = "friction may lock"
    meaning = f"only {share} % of the force on the {output} moves it there; the rest loads its guide"
    if friction:
        locks = f"started there, the slider jams in its guide at a friction of {friction:g}"
        meaning = (
            f"the angle of friction of drivetrain.guide_friction is {to_digits(limit, 3)} deg: the slider jams against "
            "a load, however hard the rod pushes it"
        )
    return Advice(
        Kind.TRANSMISSION_ANGLE,
        f"transmission angle down to {to_digits(angle, 3)} deg (at phi1 = {placed(at)} deg): {locks}",
        meaning,
        tuple(_other_lengths(drive, radians(limit), end)),
    )


def guide_friction(drive: Drive) -> float:
    """The friction that the file gives of a guide in which a rod's slider is pressed; else 0."""
    around = drive.design.drivetrain
    return around.guide_friction if around and isinstance(drive.linkage, RodMechanism) else 0.0


def _other_lengths(drive: Drive, least_rad: float, end_rad: float) -> Iterator[Remedy]:
    """Each length that alone keeps the transmission angle large enough, the nearest to its own first, to three digits.

    That which sets the stroke comes last.  They are words and no changes: which linkage a machine has is asked of it.
    """
    linkage, lengths = drive.linkage, lengths_of(drive.design.linkage)
    own = {key: float(getattr(linkage, key)) for key, given in lengths.items() if key.endswith("_mm") and given}
    found = []
    for key, length in own.items():
        for sign in (1.0, -1.0):
            if value := _enough(drive, key, length, sign * FARTHEST, least_rad, end_rad):
                found.append((key == linkage.STROKE_KEY, abs(log(value / length)), key, value))
    for _, _, key, value in sorted(found):
        yield Remedy(f"linkage.{key}: {to_digits(value, 6)}")


def _enough(drive: Drive, key: str, length: float, way: float, least_rad: float, end_rad: float) -> float | None:
    """The length nearest to its own, on one side of it, with which the angle is large enough; None where none is."""
    low, high = 0.0, 1.0
    if not _clears(drive, key, length * exp(way), least_rad, end_rad):
        return None
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        low, high = (
            (low, middle) if _clears(drive, key, length * exp(middle * way), least_rad, end_rad) else (middle, high)
        )
    shown = shown_above if way > 0.0 else shown_below
    value = copysign(float(shown(abs(length) * exp(high * way), 3)), length)
    return value if _clears(drive, key, value, least_rad, end_rad) else None


def _clears(drive: Drive, key: str, value: float, least_rad: float, end_rad: float) -> bool:
    """Whether the transmission angle is large enough with another length; a crank that follows keeps the stroke."""
    linkage, given = drive.linkage, lengths_of(drive.design.linkage)
    try:
        if given[linkage.STROKE_KEY] is None:
            others = {name: value for name, value in given.items() if name != linkage.STROKE_KEY}
            changed: Mechanism = type(linkage).of_stroke(linkage.stroke_mm, **{**others, key: value})
        else:
            changed = replace(linkage, **{key: value})  # type: ignore[type-var]
    except WrongInput:
        return False
    return changed.least_transmission(end_rad)[0] >= least_rad


def made(drive: Drive) -> Advice | NotJudged:
    """The refusal of the pitch curves, or of gears that were made for their inertia; else only teeth can tell."""
    try:
        require_pushing_flanks(drive.pitch, drive.gears.rack)
        # Chords out of proportion to the teeth, or to the band of their thickness, are refused
        _ = drive.chord_tolerance_mm
    except DesignError as refusal:
        # A build would try no other teeth, and has no more to say
        return _refused(refusal, _nearest(drive))
    if drive.design.masses is not None and not drive.design.motion.is_open:
        # The masses of the machine ask for bodies where they leave out the inertia of the gears
        _ = drive.masses
    refused = drive.gear_refusal
    return NotJudged(ONLY_TEETH) if refused is None else _refused(refused, (*_nearest(drive), ASK_BUILD))


def bodies(drive: Drive) -> Advice | None:
    """The refusal of the bodies of gears whose teeth are made."""
    try:
        _ = drive.finished_plans
    except DesignError as refusal:
        return _refused(refusal, (), "what is told here is of their teeth alone")
    return None


ASK_BUILD = Remedy("ncgear build")

FIT = Remedy("ncgear fit")


def _nearest(drive: Drive) -> tuple[Remedy, ...]:
    return (FIT,) if drive.design.can_be_fitted else ()


WITHOUT_THEM = "what is told here is the motion without them"


def _refused(refusal: DesignError, remedies: tuple[Remedy, ...], meaning: str = WITHOUT_THEM) -> Advice:
    return Advice(Kind.MADE, f"a build refuses these gears: {refusal.problem}", meaning, remedies)


NAMED = 3
"""Missed wishes that are named in brief, the first with what it misses; how many more there are is told."""


def missed_wishes(drive: Drive) -> Advice | None:
    """The hard wishes that the motion misses, and by how much."""
    hard = [outcome for outcome in drive.outcomes if outcome.wish.hard]
    missed = [outcome for outcome in hard if not outcome.kept]
    if not missed:
        return None
    count = f"{len(missed)} of {len(hard)} {'' if len(hard) == len(drive.outcomes) else 'hard '}wishes"
    named = ", ".join(f"{outcome.wish.key} (by {missed_by(outcome)})" for outcome in missed)
    shortly = [f"{missed[0].wish.key} by {missed_by(missed[0])}"]
    shortly += [outcome.wish.key.removeprefix("wishes.") for outcome in missed[1:NAMED]]
    more = [f"{len(missed) - NAMED} more by --verbose"] if len(missed) > NAMED else []
    return Advice(
        Kind.MISSED_WISH,
        f"{count} missed: {', '.join([*shortly, *more])}",
        f"the {drive.linkage.OUTPUT.name} moves otherwise than is wished: {named}",
        (Remedy("ncgear optimize"),),
    )


def drawing(drive: Drive) -> Iterator[Advice]:
    """The size by both units, and the greatest gap between parts that count as joined."""
    given, facts = drive.design.motion.contour, drive.law.facts
    gap_mm, doubled_mm, *sides_mm = (
        float(facts[f"contour_{name}_mm"] or 0.0) for name in ("gap", "doubled", "width", "height")
    )
    if isinstance(given, DxfContour) and given.drawn_in not in (None, given.unit):
        yield _of_unit(given, given.drawn_in or "", sides_mm)
    if gap_mm > JOINED * max(sides_mm):
        missed = f"parts of the contour miss each other by up to {to_digits(gap_mm, 2)} mm, as its rounded numbers do"
        yield _remark(f"{missed}: they are put together")
    if doubled_mm:
        yield _remark(f"{to_digits(doubled_mm, 3)} mm of the contour are drawn twice: they count once")
    if isinstance(given, SvgContour) and given.holes:
        yield _remark(f"the contour encloses {given.holes} more of its element: they are left out")


def _of_unit(given: DxfContour, drawn_in: str, sides_mm: Sequence[float]) -> Advice:
    def size(unit: str) -> str:
        return " by ".join(to_digits(UNIT_MM[unit] / given.unit_mm * side, 3) for side in sides_mm) + " mm"

    return _remark(
        f"the drawing names {drawn_in} as its unit, and motion.dxf.unit is {given.unit}: the contour is taken as about "
        f"{size(given.unit)}; in {drawn_in} it would be {size(drawn_in)}"
    )


_remark = partial(Advice, Kind.DRAWING, matters=False)


def room_of_pitch_curves(drive: Drive) -> Advice | NotJudged:
    """Gears of a row that overlap at every angle; all others are left to the teeth."""
    try:
        _ = drive.whole.row
    except NoSuchMechanism as refusal:
        what, _, cure = refusal.problem.partition("; ")
        return Advice(Kind.ROOM, what, "the row cannot be built", (Remedy(cure),))
    return NotJudged(ONLY_TEETH)
