"""Advices about what a file gives that changes nothing: loads that never act, wishes that every law keeps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ncgear.design.keys.base import Model, listed
from ncgear.design.keys.machine import LoadTable
from ncgear.figures.advice.values import Advice, Kind, Remedy, Where
from ncgear.figures.numbers import to_digits
from ncgear.kinematics.wishes import DecelerationWithin, EvenSpeed, Position, Requirement, TimeWithin
from ncgear.mechanisms.resistance import TableResistance
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.project.drive import Drive

BEYOND_ALL = 20.0
"""Ratio that no gears follow, nor its inverse: a wish that holds at any ratio between holds of every law."""

POINTS = 65
"""Points of a stretch at which slopes of the displacement are taken; between them they change by less than MARGIN."""

MARGIN = 1.05


def without_effect(drive: Drive) -> Iterator[Advice]:
    """What is given and changes nothing; points of a table that lie beyond the stroke are a remark."""
    if silent := _silent(drive):
        never = "never acts" if len(silent) == 1 else "never act"
        yield _advice(
            f"{listed(silent, 'and')} {never}: the force is zero over the whole stroke, 0..{_stroke(drive)}",
            "power and torque count no such force",
            f"give a force within 0..{_stroke(drive)}, in the file's displacement",
        )
    yield from _beyond(drive)
    if always := _kept_by_all(drive):
        yield _advice(
            f"{listed(always, 'and')}: every law keeps {'it' if len(always) == 1 else 'them'}",
            "it asks nothing of the law" if len(always) == 1 else "they ask nothing of the law",
            "give a narrower bound, or leave it out",
        )
    if drive.design.gears is None and drive.design.tolerances is not None:
        yield _advice("tolerances are given without gears", "no figure counts them", "give gears")
    if unloaded := given_without_load(drive):
        yield _advice(
            f"{listed(unloaded, 'and')} {'is' if len(unloaded) == 1 else 'are'} given without resistance and masses",
            "no tooth bears a load, so that no figure counts what is given of it",
            "give resistance or masses",
        )


def given_without_load(drive: Drive) -> list[str]:
    """The sections about teeth under load that differ from what they are left out, where nothing loads the teeth."""
    design = drive.design
    if design.resistance is not None or design.masses is not None:
        return []
    sections = {"strength": design.strength, "simulation": design.simulation}
    return [name for name, section in sections.items() if section != type(section)()]


def _advice(what: str, meaning: str, helps: str = "", *, matters: bool = True) -> Advice:
    remedies = (Remedy(helps),) if helps else ()
    return Advice(Kind.WITHOUT_EFFECT, (Where(),), what, meaning, remedies, matters, brief=what)


def _stroke(drive: Drive) -> str:
    place = drive.linkage.OUTPUT.place
    return f"{to_digits(place.factor * drive.linkage.stroke_mm, 5)} {place.text}"


def _forces(drive: Drive) -> list[tuple[str, bool, Model | None]]:
    """The keys of the forces out and back, whether it is the way back, and what the file says of them."""
    given = drive.design.resistance
    return [("resistance", False, given), ("resistance.returning", True, getattr(given, "returning", None))]


def _silent(drive: Drive) -> list[str]:
    """The keys of forces that are zero over the whole stroke; the whole section's where no friction acts either."""
    given = drive.design.resistance
    if given is None:
        return []
    silent = [(key, part) for key, returning, part in _forces(drive) if _is_silent(drive, returning)]
    if len(silent) == 2 and not drive.machine.load.friction_n:
        return ["resistance"]
    return [f"{key}.{form}" for key, part in silent for form in given.FORMS if getattr(part, form, None) is not None]


def _is_silent(drive: Drive, returning: bool) -> bool:
    """Whether the force of a stroke, friction apart, is zero all over it: between its turns it is monotone."""
    curve, stroke = drive.machine.load.on(returning), drive.linkage.stroke_mm
    places = np.concatenate([[0.0], curve.turns_mm(stroke), curve.zeros_mm(stroke), [stroke]])
    return not np.any(curve.force_n(places))


def _beyond(drive: Drive) -> Iterator[Advice]:
    """Points of a table that lie so far outside the stroke that the force within it does not know them."""
    stroke = drive.linkage.OUTPUT.place.factor * drive.linkage.stroke_mm
    for key, _, part in _forces(drive):
        table = getattr(part, "table", None)
        if not isinstance(table, LoadTable):
            continue
        places, forces = (tuple(getattr(table, column) or ()) for column in table.COLUMNS)
        idle = _idle_points(places, forces, stroke)
        if idle:
            aside = max(places) < 0.0 or min(places) > stroke
            which = "all" if aside else f"{idle} of"
            yield _advice(
                f"{which} {len(places)} points of {key}.table lie beyond the stroke of {_stroke(drive)}",
                "the force is that of the nearest one" if aside else "they change nothing",
                matters=not any(0.0 <= place <= stroke for place in places),
            )


def _idle_points(places: tuple[float, ...], forces: tuple[float, ...], stroke: float) -> int:
    """How many points at both ends of a table may go without a change of the force within the stroke."""
    at, count = np.linspace(0.0, stroke, POINTS), len(places)

    def force(first: int, last: int) -> Array:
        kept = slice(first, last)
        if last - first == 1:
            return np.full(POINTS, forces[first])
        return TableResistance(places[kept], forces[kept], keep_negative=True).force_n(at)

    whole, first, last = force(0, count), 0, count
    while last - first > 1 and places[last - 1] > stroke and np.array_equal(force(first, last - 1), whole):
        last -= 1
    while last - first > 1 and places[first] < 0.0 and np.array_equal(force(first + 1, last), whole):
        first += 1
    return count - (last - first)


def _kept_by_all(drive: Drive) -> list[str]:
    """The keys of wishes that ask for nothing, whatever the law is."""
    found = []
    for outcome in drive.achieved.outcomes if drive.achieved else ():
        wish = outcome.wish
        asked = wish.requirements(drive.linkage, drive.transmission.cycle_rad)
        # A position asks nothing where its tolerance is more than both strokes; of other wishes that is a goal.
        if (asked or isinstance(wish, Position)) and all(_is_empty(drive, one) for one in asked):
            found.append(wish.key)
    return found


def _is_empty(drive: Drive, asked: Requirement) -> bool:
    """Whether a requirement holds at every ratio within BEYOND_ALL."""
    if isinstance(asked, DecelerationWithin):
        return False
    stretch, cycle = asked.stretch, drive.transmission.cycle_rad
    if isinstance(asked, TimeWithin):
        length, rest = stretch.end_rad - stretch.start_rad, stretch.rest.end_rad - stretch.rest.start_rad
        least = max(length / BEYOND_ALL, cycle - rest * BEYOND_ALL)
        most = min(length * BEYOND_ALL, cycle - rest / BEYOND_ALL)
        return asked.least_rad <= least and asked.most_rad >= most
    crank = np.linspace(stretch.start_rad, stretch.end_rad, POINTS)
    slope = np.abs(drive.linkage.displacement(Jet.variable(crank, 1)).derivative(1))
    low, high = float(slope.min()) / (BEYOND_ALL * MARGIN), float(slope.max()) * BEYOND_ALL * MARGIN
    if isinstance(asked, EvenSpeed):
        return low > 0.0 and asked.spread >= high / low
    speed = drive.machine.speed_rad_s
    return asked.least_mm_s <= speed * low and asked.most_mm_s >= speed * high
