"""Advices about what a file gives that changes nothing: loads that never act, wishes that every law keeps."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from math import exp, log, pi

import numpy as np

from ncgear.design.keys.base import Model
from ncgear.design.keys.machine import LoadTable
from ncgear.design.words import listed
from ncgear.errors import DesignError
from ncgear.figures.advice.values import ONLY_TEETH, Advice, Kind, NotJudged, Remedy
from ncgear.figures.numbers import to_digits
from ncgear.kinematics.crank_stretches import CrankStretch
from ncgear.mechanisms.resistance import TableResistance
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import changed_drive, enough_teeth, is_given
from ncgear.project.drive import Drive
from ncgear.project.service import choices_of
from ncgear.strength.materials import Plastic
from ncgear.wishes.requirements import DecelerationWithin, EvenSpeed, Requirement, TimeWithin
from ncgear.wishes.wish import DrivingWish

BEYOND_ALL = 20.0
"""Ratio that no gears follow, nor its inverse: a wish that holds at any ratio between holds of every law.

Nor does a pitch curve turn from the circle about its axis by an angle of this tangent, 87 deg."""

STEEPEST = (1.0 + BEYOND_ALL) * BEYOND_ALL
"""Greatest slope by the crank angle of s = dphi2/dphi1, (1 + s) tan(t) of that angle t, and of its logarithm, (1 + 1/s)
tan(t)."""

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
    yield from (_idle(*given) for given in (*_idle_sections(drive), *_idle_keys(drive)))


Idle = tuple[list[str], str, str]
"""Keys that no figure counts, why not, and what would make them count."""


def before_teeth(drive: Drive) -> Iterator[Advice | NotJudged]:
    """What is given and changes nothing, as far as it is known before teeth are made."""
    yield from without_effect(drive)
    if _allows_undercut(drive):
        yield NotJudged(ONLY_TEETH)


def with_teeth(drive: Drive) -> Iterator[Advice]:
    """What is given and changes nothing, of the motion and of the teeth."""
    yield from without_effect(drive)
    if _allows_undercut(drive) and all(map(_is_clear_of_undercut, drive.by_stage)):
        yield _idle(["gears.undercut"], "without a tooth that would be undercut", "leave it out")


def _allows_undercut(drive: Drive) -> bool:
    return drive.design.gears is not None and drive.gears.undercut == "allow"


def _is_clear_of_undercut(pair: Drive) -> bool:
    """Whether teeth are the same where undercut is avoided; sections of helical ones stand anywhere on the curves."""
    if any(len(pair.teeth.of(gear).undercut) for gear in Gear):
        return False
    if pair.helix is not None:
        return enough_teeth(pair) <= pair.pitch.size.driving_teeth
    with suppress(DesignError):
        avoiding = changed_drive(pair.whole, {"gears.undercut": "avoid"}).of_stage(pair.stage).teeth
        return all(np.array_equal(pair.teeth.of(gear).outline_mm, avoiding.of(gear).outline_mm) for gear in Gear)
    return False


def _idle_sections(drive: Drive) -> Iterator[Idle]:
    """The sections about gears and about teeth under load that nothing reads, by what their design lacks."""
    design = drive.design
    sections = {"strength": design.strength, "simulation": design.simulation}
    given = [name for name, section in sections.items() if section != type(section)()]
    toleranced = ["tolerances"] if design.tolerances is not None else []
    if design.gears is None:
        found = [([*given, *toleranced], "without gears", "give gears")]
    elif not design.loads_teeth:
        helps = "give resistance" if design.motion.is_open else "give resistance or masses"
        found = [(given, "without resistance and masses, so that no tooth has a load", helps)]
    else:
        simulated = [name for name in given if name == "simulation"]
        why = {
            "with gears that turn less than once, which are not followed under load": design.motion.is_open,
            "without masses, of which ncgear simulate needs all": design.masses is None,
        }
        helps = "give masses" if design.masses is None and not design.motion.is_open else "leave it out"
        found = [(simulated, next((words for words, true in why.items() if true), ""), helps)]
    return (section for section in found if section[0] and section[1])


def _idle_keys(drive: Drive) -> Iterator[Idle]:
    design, around = drive.design, drive.design.drivetrain
    rub, gears, masses = design.simulation.friction, design.gears, design.masses
    shafts = {f"drivetrain.{shaft.key}": shaft.given for shaft in design.shafts if around}
    bearings = any(shaft and shaft.bearing_a for shaft in shafts.values())
    # With both shafts' bearings the load along the face width follows, unless its factor is given.
    along = bool(shafts) and all(shaft and shaft.bearing_a for shaft in shafts.values())
    along = along and design.strength.face_load_factor is None
    motor, line = around.motor if around else None, design.simulation.motor
    made = design.tolerances
    of = {"tolerances.driving": made.driving, "tolerances.driven": made.driven} if made else {}
    graded = {name: None in (deviations.single_pitch_mm, deviations.profile_mm) for name, deviations in of.items()}

    def tell(why: str, helps: str, *keys: str) -> Iterator[Idle]:
        if given := [key for key in keys if is_given(design, key)]:
            yield given, why, helps

    if design.simulation.damping_n_s_mm is not None:
        yield from tell("beside damping_n_s_mm, which holds alone", "keep one of the two", "simulation.damping_ratio")
    if rub.static == rub.dynamic:
        speeds = (f"simulation.friction.{name}_speed_mm_s" for name in ("static", "dynamic"))
        yield from tell("with the same friction at rest and in motion", "leave them out", *speeds)
    if not bearings:
        keys = "drivetrain.life_h", "drivetrain.reliability_percent"
        yield from tell("without bearings, which alone have a life", "give bearings of a shaft", *keys)
    if motor is not None and motor.no_load_speed_rpm is None and line is None:
        why = "without a line of the motor, so that it runs evenly"
        yield from tell(why, "give no_load_speed_rpm", "drivetrain.motor.overrunning_clutch")
    if around and around.guide_friction and _presses_on_no_guide(drive):
        why = f"with {drive.linkage.NAME}, of which nothing presses on a guide"
        yield from tell(why, "leave it out", "drivetrain.guide_friction")
    if design.strength.lubrication == "dry":
        oil = (f"strength.oil_{name}" for name in ("viscosity_mm2_s", "viscosity_100_mm2_s", "fzg_stage"))
        yield from tell("with dry teeth, which no oil parts", "leave it out, or choose oil", *oil)
    if design.stages == 1 and masses and None not in (masses.driving_gear_kg_mm2, masses.driven_gear_kg_mm2):
        yield from tell("beside the inertias of both gears, which hold alone", "leave it out", "masses.density_kg_m3")
    if gears is not None:
        plastic = any(isinstance(choice.entry, Plastic) for choice in choices_of(gears))
        if not plastic or design.strength.lubrication == "oil":
            why = "with teeth in oil, which takes their heat away" if plastic else "with gears of metal"
            yield from tell(f"{why}: pauses cool dry or greased plastics only", "leave it out", "strength.duty_cycle")
        if gears.driving.bore_mm is None and gears.driven.bore_mm is None:
            helps = "give gears.driving.bore_mm or gears.driven.bore_mm"
            yield from tell("without a bore", helps, "gears.tolerances.bore_fit")
        if not gears.index_holes:
            yield from tell("without index holes", "give gears.index_holes: true", "gears.tolerances.index_hole_fit")
        if not gears.backlash_mm and not gears.backlash_deg:
            why = "without a backlash that it could share out"
            yield from tell(why, "give gears.backlash_mm over 0", "gears.backlash_share")
    if made is not None and made.temperature is None:
        why = "without tolerances.temperature, so that nothing expands"
        yield from tell(why, "give temperature", "tolerances.housing_expansion_um_m_k")
    for key, returning, part in _forces(drive):
        if part and not drive.machine.load.on(returning).negative_stretches_mm(drive.linkage.stroke_mm):
            yield from tell("with a load that is nowhere negative", "leave it out", f"{key}.where_negative")
    for name, asks in graded.items():
        if not asks and not along:
            yield from tell("beside single_pitch_mm and profile_mm, which hold alone", "leave it out", f"{name}.grade")
    if not along and graded and not any(asks and of[name].grade is None for name, asks in graded.items()):
        why = "and each gear has its own grade, or single_pitch_mm and profile_mm"
        yield from tell(why, "leave it out", "tolerances.grade")
    for name, shaft in shafts.items():
        if shaft is not None and not shaft.has_strength:
            sizes = ("blank_mm",) if along else ("diameter_mm", "blank_mm")
            why = "without the shaft's steel, so that it is not looked at"
            yield from tell(why, "give steel", *(f"{name}.{size}" for size in sizes))
    if not along:
        why = "where bearings of {} are missing, or strength.face_load_factor is given"
        helps = "give the bearings of both shafts and no factor"
        lead = (f"gears.lead.{key}" for key in ("crowning_um", "end_relief_um", "end_relief_length_mm"))
        yield from tell(why.format("a shaft"), helps, *lead)
        for name in shafts:
            both = (f"{name}.bearing_{letter}.stiffness_n_per_um" for letter in "ab")
            yield from tell(why.format("one shaft"), helps, *both)
    if gears is None or gears.helix is None or gears.helix.kind != "helical":
        for name in shafts:
            thrust = "thrust_on", "bearing_a.contact_angle_deg", "bearing_b.contact_angle_deg"
            why = "without helical teeth, which alone press along a shaft"
            yield from tell(why, "leave it out", *(f"{name}.{key}" for key in thrust))
    for name, shaft in shafts.items():
        if shaft is not None and shaft.bearing_a is None:
            yield from tell("without bearings", "give them", f"{name}.crank_at_mm")


def _presses_on_no_guide(drive: Drive) -> bool:
    """Whether no load and no weight ever presses the output across its way."""
    if not drive.linkage.GUIDED:
        return True
    loads = drive.loaded_machine(drive.machine).at(np.linspace(0.0, drive.transmission.cycle_rad, POINTS))
    return not np.any(loads.guide.value)


def _idle(names: list[str], why: str, helps: str) -> Advice:
    are, them = ("is", "it") if len(names) == 1 else ("are", "them")
    return _advice(f"{listed(names, 'and')} {are} given {why}", f"no figure counts {them}", helps)


def _advice(what: str, meaning: str, helps: str = "", *, matters: bool = True) -> Advice:
    return Advice(Kind.WITHOUT_EFFECT, what, meaning, (Remedy(helps),) if helps else (), matters)


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
                f"give places within 0..{_stroke(drive)}" if aside else "",
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
    for outcome in drive.outcomes:
        wish = outcome.wish
        asked = wish.requirements(drive.linkage, drive.transmission.cycle_rad)
        if isinstance(wish, DrivingWish) and wish.driving is not None:
            # Where the output is over driving angles is the law's choice
            asked = (wish.bound(CrankStretch(0.0, 2.0 * pi)),)
        # A position asks nothing where its tolerance is more than both strokes; what is pushed is a goal.
        if not wish.pushed(drive.linkage) and all(_is_empty(drive, key) for key in asked):
            found.append(wish.key)
    return found


def _is_empty(drive: Drive, asked: Requirement) -> bool:
    """Whether a requirement holds at every ratio within BEYOND_ALL.

    A deceleration is w^2 (x'' s^2 + x' s ds/dphi2) with s = dphi2/dphi1 and ds/dphi2 = (1 + s) tan(t).
    """
    stretch, cycle = asked.stretch, drive.transmission.cycle_rad
    if isinstance(asked, TimeWithin):
        length, rest = stretch.end_rad - stretch.start_rad, stretch.rest.end_rad - stretch.rest.start_rad
        least = max(length / BEYOND_ALL, cycle - rest * BEYOND_ALL)
        most = min(length * BEYOND_ALL, cycle - rest / BEYOND_ALL)
        return asked.least_rad <= least and asked.most_rad >= most
    crank = np.linspace(stretch.start_rad, stretch.end_rad, POINTS)
    speed, moved = drive.machine.speed_rad_s, drive.linkage.displacement(Jet.variable(crank, 2))
    slope, bend = (np.abs(moved.derivative(order)) for order in (1, 2))
    if isinstance(asked, DecelerationWithin):
        most = BEYOND_ALL * float((bend * BEYOND_ALL + slope * STEEPEST).max())
        return asked.most_mm_s2 >= speed**2 * MARGIN * most
    low, high = float(slope.min()) / (BEYOND_ALL * MARGIN), float(slope.max()) * BEYOND_ALL * MARGIN
    if isinstance(asked, EvenSpeed):
        # From one end to the other the ratio itself changes by no more
        steep = min(STEEPEST * (stretch.end_rad - stretch.start_rad), 2.0 * log(BEYOND_ALL))
        return low > 0.0 and asked.spread >= MARGIN**2 * float(slope.max() / slope.min()) * exp(steep)
    return asked.least_mm_s <= speed * low and asked.most_mm_s >= speed * high
