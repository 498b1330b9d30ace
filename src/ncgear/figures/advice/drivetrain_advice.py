"""Advices about what stands around the gears: a motor that does not do, parts and couplings that do not hold."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from math import degrees, inf
from typing import TYPE_CHECKING

from ncgear.design.words import listed
from ncgear.drivetrain.bearings import MOST_OF_RATING
from ncgear.drivetrain.shafts import LEAST_SAFETY
from ncgear.errors import NoSuchMechanism
from ncgear.figures.advice.values import Advice, Kind, NotJudged, Remedy
from ncgear.figures.numbers import five_digits, fixed, placed, to_digits
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.units import N_M_PER_N_MM, RAD_S_PER_RPM
from ncgear.project.drive import Drive

if TYPE_CHECKING:
    from ncgear.design.keys.drivetrain import NamedShaft
    from ncgear.drivetrain.shafts import KeySafety
    from ncgear.project.drivetrain import PowerTakeOffResult, ShaftResult
    from ncgear.project.motor import MotorResult


def around(drive: Drive) -> Iterator[Advice | NotJudged]:
    """What does not hold, with what would; raises as ``Drive.drivetrain`` does."""
    yield from of_bores(drive)
    found, given = drive.drivetrain, drive.design.drivetrain
    if given and given.flywheel_diameter_mm is not None and found.disc is None:
        what = "drivetrain.flywheel_diameter_mm is given, and no disc is needed: what turns has inertia enough"
        yield replace(_advice(what, "leave it out"), matters=False)
    for named, shaft in sorted(zip(drive.design.shafts, found.shafts, strict=True), key=_least_safety):
        if shaft is not None:
            yield from _of_bearings(named, shaft, found.wanted.hours)
            yield from _of_shaft(named, shaft)
            yield from _of_jam(named, shaft)
    yield from _of_keys(drive.design.shafts, found.shafts)
    yield from _of_crank(drive)
    if found.pto:
        yield from _of_pto(found.pto, N_M_PER_N_MM * found.demand.torque_range_n_mm[1].value)
    if drive.knocks is None and drive.rigid.fluctuation.flank_changes_rad.size:
        yield NotJudged(
            "shafts, keys and bearings are not judged for the knocks of teeth whose load changes flanks, which are "
            "followed of one pair or two with inertia only"
        )


def of_bores(drive: Drive) -> Iterator[Advice]:
    """Shafts that are thinner than the bores in which they stand; thicker ones are refused by their key."""
    for number, (words, key, given) in enumerate(drive.design.shafts if drive.design.gears else ()):
        for gear in drive.design.gears_on(number):
            bore_mm = getattr(drive.gears, gear).bore_mm
            if given and bore_mm and given.diameter_mm and given.diameter_mm < bore_mm:
                yield _advice(
                    f"the {words} of {given.diameter_mm:.10g} mm is loose in a bore of {bore_mm:.10g} mm",
                    f"drivetrain.{key}.diameter_mm: {bore_mm:.10g}, or gears.{gear}.bore_mm: {given.diameter_mm:.10g}",
                )


def _least_safety(named: tuple[NamedShaft, ShaftResult | None]) -> float:
    strong = named[1].shaft if named[1] else None
    return min(strong.fatigue, strong.yielding) if strong else inf


def motor(drive: Drive) -> Iterable[Advice | NotJudged]:
    """Whether the motor moves the machine at its speed, and bears it, with the friction between teeth as they are."""
    if not _behind_gearbox(drive):
        return _of_simulated(drive)
    found = drive.drivetrain.motor
    assert found is not None
    return _of_motor(drive, found, found)


def motor_without_teeth(drive: Drive) -> Iterable[Advice | NotJudged]:
    """The same without teeth: told where neither no friction nor the most that there can be says otherwise."""
    from ncgear.project.motor import motor_within

    if not _behind_gearbox(drive):
        return _of_simulated(drive)
    least, most = motor_within(drive)
    if least.faults == most.faults:
        return _of_motor(drive, least, most)
    return (*_of_motor(drive, least, most), NotJudged("the friction between the teeth decides: ncgear build"))


def _behind_gearbox(drive: Drive) -> bool:
    return drive.design.drivetrain is not None and drive.design.drivetrain.motor is not None


def _of_simulated(drive: Drive) -> Iterator[Advice]:
    from ncgear.project.motor import OFF_SPEED, fitting_simulated, steady_rad_s, told_words

    if (stall := drive.motor_stall) is not None:
        yield replace(_advice(stall.brief, told_words(fitting_simulated(drive)), Kind.MOTOR), meaning=stall.there)
        return
    try:
        runs = steady_rad_s(drive)
    except NoSuchMechanism as refusal:
        yield _advice(refusal.problem.rpartition("; ")[0], told_words(fitting_simulated(drive)), Kind.MOTOR)
        return
    wanted = drive.machine.speed_rad_s
    if runs is not None and abs(runs / wanted - 1.0) > OFF_SPEED:
        yield _advice(
            f"with its motor the machine runs at {_rpm(runs)} r/min, not at operation.speed_rpm: {_rpm(wanted)}; all "
            "else is told for that speed",
            told_words(fitting_simulated(drive)),
            Kind.MOTOR,
        )


def _rpm(speed_rad_s: float) -> str:
    return to_digits(speed_rad_s / RAD_S_PER_RPM, 4)


def _advice(what: str, helps: str = "", kind: Kind = Kind.DRIVETRAIN) -> Advice:
    return Advice(kind, what, remedies=(Remedy(helps),) if helps else ())


def _of_crank(drive: Drive) -> Iterator[Advice]:
    """A crank whose middle lies within the gear beside which it turns, so that the forces on its bearings differ."""
    around, half = drive.design.drivetrain, drive.gears.face_width_mm / 2.0
    given = around.driven_shaft if around else None
    if given and given.bearing_a and drive.linkage.HAS_CRANK and abs(given.crank_at_mm) < half:
        yield _advice(
            f"the crank's middle is {given.crank_at_mm:g} mm from that of the driven gear, which is {2.0 * half:g} mm "
            "wide: it would turn within the gear, and shaft and bearings are told for that",
            _at_least("drivetrain.driven_shaft.crank_at_mm", half),
        )
    if given and given.bearing_a and given.bearing_b and drive.linkage.HAS_CRANK:
        low, high = sorted((given.bearing_a.at_mm, given.bearing_b.at_mm))
        if half <= abs(given.crank_at_mm) and low <= given.crank_at_mm <= high:
            where = "between" if low < given.crank_at_mm < high else "in one of"
            told = _advice(
                f"the crank's middle, at {given.crank_at_mm:g} mm, is {where} the bearings at {low:g} and {high:g} mm: "
                "what it moves passes over the shaft's axis, which has to be cranked there",
                f"drivetrain.driven_shaft.crank_at_mm: over {high:g} or under {low:g}",
            )
            yield replace(told, matters=where != "between")


def _at_least(key: str, value: float) -> str:
    return f"{key}: {shown_above(value, 4)} or over"


def _of_bearings(shaft: NamedShaft, found: ShaftResult, hours: float) -> Iterator[Advice]:
    for letter, bearing in zip("ab", found.bearings or (), strict=False):
        which, key = f"bearing {letter} of the {shaft.words}", f"drivetrain.{shaft.key}.bearing_{letter}"
        if bearing.life_h is not None and bearing.life_h < hours:
            yield _advice(
                f"{which} lasts {five_digits(bearing.life_h)} h, and {five_digits(hours)} h are wanted",
                _at_least(f"{key}.dynamic_rating_n", bearing.needed_rating_n),
            )
        if bearing.within_iso_281 is False:
            yield _advice(
                f"the load of {which} is more than half its dynamic load rating, the limit of ISO 281",
                _at_least(f"{key}.dynamic_rating_n", bearing.equivalent_n / MOST_OF_RATING),
            )
        yield from _dented(shaft, letter, bearing.static_n, bearing.static_safety)


def _dented(shaft: NamedShaft, letter: str, most_n: float, safety: float | None, when: str = "") -> Iterator[Advice]:
    if safety is not None and safety < 1.0:
        load = f"{fixed(most_n, 0)} N, more than its static load rating: it would be dented"
        helps = _at_least(f"drivetrain.{shaft.key}.bearing_{letter}.static_rating_n", most_n)
        yield _advice(f"{when}the load of bearing {letter} of the {shaft.words} is {load}", helps)


def _crushed(shaft: NamedShaft, key: KeySafety | None, when: str = "") -> Iterator[Advice]:
    if key is not None and key.safety < 1.0:
        most, allowed = (fixed(pressure, 0) for pressure in (key.pressure_mpa, key.pressure_mpa * key.safety))
        needed = key.key.length_mm / key.safety
        longer = _at_least(f"drivetrain.{shaft.key}.key.length_mm", needed) if needed <= key.key.longest_mm else ""
        what = f"{when}the pressure on the key of the {shaft.words} is {most} MPa, and {allowed} MPa are allowed"
        yield _advice(
            what,
            f"{longer}, or a thicker shaft" if longer else f"a thicker {shaft.words}, or a hub with a longer key",
        )


def _of_shaft(shaft: NamedShaft, found: ShaftResult) -> Iterator[Advice]:
    if found.shaft is not None:
        safety, against = min((found.shaft.fatigue, "fatigue"), (found.shaft.yielding, "yielding"))
        if safety < LEAST_SAFETY:
            yield _advice(
                f"the {shaft.words} has an estimated safety of {to_digits(safety, 3)} against {against} at its keyway; "
                f"{LEAST_SAFETY:g} or over is right",
                "a stronger steel: no shaft ten times as thick holds"
                if found.enough_mm is None
                else _thicker(shaft, found.enough_mm),
            )
    yield from _crushed(shaft, found.key)


def _of_keys(named: Sequence[NamedShaft], found: Sequence[ShaftResult | None]) -> Iterator[NotJudged]:
    """The keys that work in their ways, of which the pressure tells too little, be it ever so low."""
    both = zip(named, found, strict=True)
    turned = [named.words for named, shaft in both if shaft and shaft.key and shaft.key.both_senses]
    if turned:
        yield NotJudged(
            f"the torque of the {listed(turned, 'and')} changes its sense, for which the pressure on a key is no "
            "proof: gears need a fit without play"
        )


def _thicker(shaft: NamedShaft, enough_mm: float) -> str:
    return f"{_at_least(f'drivetrain.{shaft.key}.diameter_mm', enough_mm)}, in a bore as wide, or a stronger steel"


def _of_jam(shaft: NamedShaft, found: ShaftResult) -> Iterator[Advice]:
    jammed = found.jammed
    if jammed is None:
        return
    for letter, most, safety in zip("ab", jammed.static_n, jammed.static_safety, strict=True):
        yield from _dented(shaft, letter, most, safety, "in a jam ")
    if jammed.yielding is not None and jammed.yielding < LEAST_SAFETY:
        assert found.shaft is not None
        thick = found.shaft.section.diameter_mm * (LEAST_SAFETY / jammed.yielding) ** (1.0 / 3.0)
        yield _advice(
            f"in a jam the {shaft.words} has a safety of {to_digits(jammed.yielding, 3)} against yielding at its "
            f"keyway; {LEAST_SAFETY:g} or over is right",
            _thicker(shaft, thick),
        )
    yield from _crushed(shaft, found.jammed_key, "in a jam ")


def _of_motor(drive: Drive, found: MotorResult, most: MotorResult) -> Iterator[Advice]:
    """The motor behind a gearbox: what it does not do, be there no friction between teeth or the ``most``.

    The motor that does is told once, and was tried with both; with the friction between teeth as they are, both are
    the same.
    """
    from ncgear.project.motor import fitting_geared, told_words

    if faults := found.faults & most.faults:
        helps = told_words(fitting_geared(drive.design, [found] if found is most else [found, most]))
        first, *others = _motor_words(found, most, faults)
        yield _advice(first, helps, Kind.MOTOR)
        yield from (_advice(other, kind=Kind.MOTOR) for other in others)


def _motor_words(found: MotorResult, most: MotorResult, faults: set[str]) -> Iterator[str]:
    """What a motor does not do, with its numbers, the most serious first."""
    given, course, peak = found.given, found.course, found.given.peak_torque_n_m

    def gives(value: float, other: float) -> str:
        if found is most:
            return f"{to_digits(value, 4)} N m"
        ends = (
            f"{to_digits(value, 4)} N m without friction between the teeth",
            f"{to_digits(other, 4)} N m with the most",
        )
        return " and ".join(ends) + " there can be"

    if "stops" in faults:
        yield found.stops.rpartition("; ")[0]
    if "hot" in faults:
        rms, rated = gives(found.rms_n_m, most.rms_n_m), given.rated_torque_n_m
        yield f"the motor gives, r.m.s., {rms}, more than its rated {rated:g} N m"
    if "weak" in faults:
        yield f"the motor gives up to {gives(found.most_n_m, most.most_n_m)}, more than its {peak:g} N m"
    if "fast" in faults:
        turns, rated = to_digits(found.turns_rpm, 4), given.rated_speed_rpm
        yield f"the motor turns at {turns} r/min, faster than the {rated:g} r/min of its rated torque"
    if course is not None and "off speed" in faults:
        yield (
            f"with this motor and gearbox the machine runs at {_rpm(course.mean_rad_s)} r/min, not at "
            f"operation.speed_rpm: {_rpm(found.demand.speed_rad_s)}; all else is told for that speed"
        )


def _of_pto(found: PowerTakeOffResult, most_n_m: float) -> Iterator[Advice]:
    if found.slips:
        stops = any(slip.end_rad is None for slip in found.slips)
        says = "and stops the machine" if stops else "in every cycle"
        yield _advice(
            f"the torque limiter slips from phi1 = {placed(degrees(found.slips[0].start_rad))} deg on, {says}",
            _at_least("drivetrain.pto.torque_limiter_n_m", most_n_m),
        )
    if found.runs_ahead and any(run.end_rad is None for run in found.runs_ahead):
        yield _advice(
            "the machine runs ahead of its clutch and is not caught again within a cycle",
            "drivetrain.pto.overrunning_clutch: false",
        )


SMOOTH_GUIDE = _advice(
    "the motion in time leaves out friction in the guide, which takes more torque and presses joints and teeth harder",
    "ncgear simulate --level rigid counts it",
)
