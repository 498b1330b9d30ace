"""From keys to values: bearings, shafts, keys, motor and couplings around the gears of a design, and their loads."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, replace
from math import inf

from ncgear.design.keys.design import Design
from ncgear.design.keys.drivetrain import PowerTakeOff
from ncgear.drivetrain.bearings import BearingLife, Bend, Seats, WantedLife
from ncgear.drivetrain.cycle import Cycle, cycle_of, loads_at, with_knocks
from ncgear.drivetrain.jam import Jam, JammedShaft, Load, deciding, jammed_shaft
from ncgear.drivetrain.losses import Demand, TouchingTeeth, mesh_loss_factor
from ncgear.drivetrain.peaks import ShaftPeaks, shaft_peaks
from ncgear.drivetrain.pto import Excursion, running_ahead, slipping
from ncgear.drivetrain.shafts import (
    FREE_HEIGHT_MM,
    LEAST_SAFETY,
    STEELS,
    KeySafety,
    ShaftKey,
    ShaftSafety,
    ShaftSection,
    Steel,
    key_safety,
    shaft_safety,
)
from ncgear.drivetrain.speed import FlywheelDisc, disc
from ncgear.dynamics.knocking import KnockingMachine
from ncgear.dynamics.rigid import Rigid
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.project.face_load import diameter_of, seats_of
from ncgear.project.motor import MotorResult, demand_of, motor_of
from ncgear.ratio.transmission import Pair

N_MM_PER_N_M = 1000.0


@dataclass(frozen=True, eq=False)
class ShaftResult:
    """The bearings, the shaft with its largest moment, and its weakest key; each None where it is not given.

    They are the results of the law or of knocks, whichever are worse.  ``decided_by`` has the deciding load of each
    part, or the jam where a part is loaded most by it.  ``enough_mm`` is the diameter with which a failing shaft would
    hold; None where it holds, and where none is enough.  ``jammed`` and ``jammed_key`` are shaft, bearings and key in a
    jam; None where no jam counts.
    """

    words: str
    bearings: tuple[BearingLife, BearingLife] | None
    most_bent: Bend | None
    shaft: ShaftSafety | None
    key: KeySafety | None
    enough_mm: float | None = None
    jammed: JammedShaft | None = None
    jammed_key: KeySafety | None = None
    decided_by: Mapping[str, Load] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class PowerTakeOffResult:
    """The angles where the limiter slips and where the clutch lets the machine run ahead; None without them."""

    slips: list[Excursion] | None
    runs_ahead: list[Excursion] | None


@dataclass(frozen=True, eq=False)
class DrivetrainResult:
    """The machine parts around the gears of a design; ``shafts`` from the driving shaft on.

    ``flywheel_kg_mm2`` is the inertia on the driving shaft, including its gear and the motor, that the wanted
    coefficient of fluctuation ``wanted_fluctuation`` needs for the torque with losses.  ``disc`` gives the part of it
    that the machine lacks.
    """

    wanted: WantedLife
    demand: Demand
    shafts: tuple[ShaftResult | None, ...]
    wanted_fluctuation: float
    flywheel_kg_mm2: float
    disc: FlywheelDisc | None
    motor: MotorResult | None
    pto: PowerTakeOffResult | None


def drivetrain_of(
    design: Design,
    rigid: Rigid,
    touching: Sequence[tuple[TouchingTeeth, Pair]],
    knocking: KnockingMachine | None,
    jam: Jam | None,
) -> DrivetrainResult:
    """The drivetrain of a design that has the section; ``touching`` are its pairs, none where teeth are helical.

    Shafts, keys and bearings carry the loads of the law, or of ``knocking`` where these are worse, and besides them the
    ``jam``.  The motor does not feel the knocks: its shaft turns evenly.  Raises WrongInput where a part needs a value
    of the gears that is missing.
    """
    given, masses = design.drivetrain, design.masses
    assert given is not None
    assert masses is not None
    wanted = WantedLife(given.life_h, given.reliability_percent)
    smooth = cycle_of(rigid)
    demand = demand_of(design, smooth, _loss_factors(touching, smooth))
    cycles: dict[Load, Cycle] = {"law": demand.cycle}
    if knocking:
        cycles["knocks"] = with_knocks(demand.cycle, knocking)
    seats = [seats_of(shaft.given) for shaft in design.shafts]
    known = {number: seat for number, seat in enumerate(seats) if seat is not None}
    peaks = {load: shaft_peaks(cycle, known, wanted) for load, cycle in cycles.items()}
    needed = demand.fluctuation.flywheel_kg_mm2(masses.flywheel.speed_fluctuation)
    missing = needed - rigid.machine.masses.driving_shaft_kg_mm2 - demand.added_kg_mm2
    diameter = given.flywheel_diameter_mm
    return DrivetrainResult(
        wanted=wanted,
        demand=demand,
        shafts=tuple(_shaft(design, number, seat, peaks, jam) for number, seat in enumerate(seats)),
        wanted_fluctuation=masses.flywheel.speed_fluctuation,
        flywheel_kg_mm2=needed,
        disc=disc(missing, diameter, demand.speed_rad_s) if diameter and missing > 0.0 else None,
        motor=motor_of(design, given.motor, demand) if given.motor else None,
        pto=_pto(given.pto, demand) if given.pto else None,
    )


def _loss_factors(touching: Sequence[tuple[TouchingTeeth, Pair]], cycle: Cycle) -> tuple[float, ...]:
    """H of all pairs of gears, each by the angles of its own driving gear."""
    found = []
    for number, (teeth, pair) in enumerate(touching):

        def torques(angle_rad: Array, number: int = number, pair: Pair = pair) -> tuple[Array, Array]:
            shafts = loads_at(cycle.rigid, pair.shaft_rad(angle_rad)).shafts
            return shafts[number].gears[-1].torque_n_mm, shafts[number + 1].gears[0].torque_n_mm

        breaks = cycle.rigid.angles(cycle.breaks_rad, 0)[number].value
        found.append(mesh_loss_factor(teeth, torques, breaks))
    return tuple(found)


def _shaft(
    design: Design, number: int, seats: Seats | None, peaks: Mapping[Load, Mapping[int, ShaftPeaks]], jam: Jam | None
) -> ShaftResult | None:
    """A shaft under the worst of all loads; raises WrongInput where diameter or keyway is missing."""
    if design.shafts[number].given is None:
        return None
    if seats is None:
        return ShaftResult(design.shafts[number].words, None, None, None, None)
    results = {load: _shaft_of(design, number, of_load[number]) for load, of_load in peaks.items()}
    sizes = {load: _sizes(result) for load, result in results.items()}
    law, *knocks = results.values()
    found = _worse(law, *knocks) if knocks else law
    if jam is not None:
        section = found.shaft.section if found.shaft else None
        jammed = jammed_shaft(jam, number, seats, section)
        key = _key(design, number, section, [(most, most) for most in jammed.torques_n_mm]) if section else None
        found = replace(found, jammed=jammed, jammed_key=key)
        sizes["jam"] = _sizes_in_jam(jammed, key)
    decided = {part: deciding({load: of[part] for load, of in sizes.items() if part in of}) for part in sizes["law"]}
    return replace(found, decided_by=decided)


def _sizes(found: ShaftResult) -> dict[str, float]:
    """The load of each part, as forces and stresses that grow as the part becomes weaker."""
    sizes = dict[str, float]()
    for letter, bearing in zip("ab", found.bearings or (), strict=False):
        sizes |= {f"bearing_{letter}_life": bearing.equivalent_n, f"bearing_{letter}_force": bearing.static_n}
    if found.shaft is not None:
        sizes |= {"fatigue": 1.0 / found.shaft.fatigue, "yielding": 1.0 / found.shaft.yielding}
    return sizes if found.key is None else {**sizes, "key": found.key.pressure_mpa}


def _sizes_in_jam(jammed: JammedShaft, key: KeySafety | None) -> dict[str, float]:
    """The same for the parts that a jam loads: no part tires from it."""
    sizes = {f"bearing_{letter}_force": most for letter, most in zip("ab", jammed.static_n, strict=True)}
    if jammed.yielding is not None:
        sizes["yielding"] = 1.0 / jammed.yielding
    return sizes if key is None else {**sizes, "key": key.pressure_mpa}


def _worse(law: ShaftResult, knocks: ShaftResult) -> ShaftResult:
    """For each part the worse result: a knock may also unload a bearing."""
    assert law.bearings is not None
    assert knocks.bearings is not None
    first, second = (_worse_bearing(*of) for of in zip(law.bearings, knocks.bearings, strict=True))
    bends = [result.most_bent for result in (law, knocks) if result.most_bent is not None]
    found = replace(knocks, bearings=(first, second), most_bent=max(bends, key=lambda bend: bend.moment_n_mm))
    if law.shaft is not None and knocks.shaft is not None:
        shafts = law.shaft, knocks.shaft
        tired = min(shafts, key=lambda shaft: shaft.fatigue)
        weaker = min(
            (law, knocks), key=lambda result: min(result.shaft.fatigue, result.shaft.yielding) if result.shaft else inf
        )
        safety = replace(tired, yielding=min(shaft.yielding for shaft in shafts))
        found = replace(found, shaft=safety, enough_mm=weaker.enough_mm)
    if law.key is not None and knocks.key is not None:
        key = min(law.key, knocks.key, key=lambda key: key.safety)
        found = replace(found, key=replace(key, both_senses=law.key.both_senses or knocks.key.both_senses))
    return found


def _worse_bearing(law: BearingLife, knocks: BearingLife) -> BearingLife:
    lives = max(law, knocks, key=lambda bearing: bearing.equivalent_n)
    across = max(law.largest_n, knocks.largest_n, key=lambda most: most.value)
    bears = max(law, knocks, key=lambda bearing: bearing.static_n)
    along = max(law.thrust_n, knocks.thrust_n, key=lambda most: most.value)
    found = replace(lives, largest_n=across, thrust_n=along)
    return replace(found, static_n=bears.static_n, static_safety=bears.static_safety)


def _shaft_of(design: Design, number: int, peaks: ShaftPeaks) -> ShaftResult:
    words, name, given = design.shafts[number]
    assert given is not None
    if not given.has_strength:
        return ShaftResult(words, peaks.bearings, peaks.bent, None, None)
    if (diameter := diameter_of(design, number)) is None:
        raise WrongInput(
            f"missing; a gear of the {words} has no bore that tells it", key=f"drivetrain.{name}.diameter_mm"
        )
    steel = STEELS[given.steel] if given.steel else Steel(given.tensile_mpa or 0.0, given.yield_mpa or 0.0)
    section = ShaftSection(diameter, given.blank_mm or diameter, steel)

    def of_diameter(diameter_mm: float) -> ShaftSafety:
        thick = ShaftSection(diameter_mm, max(diameter_mm, section.blank_mm), steel)
        found = (shaft_safety(thick, section) for section in peaks.sections)
        return min(found, key=lambda safety: min(safety.fatigue, safety.yielding))

    safety = of_diameter(diameter)
    key = _key(design, number, section, peaks.torques_n_mm)
    return ShaftResult(words, peaks.bearings, peaks.bent, safety, key, _thick_enough_mm(of_diameter, diameter, safety))


MOST_TIMES, GROWN = 10.0, 1.002
"""The thickest shaft that is tried, in diameters of the given shaft, and the least factor between trials."""


def _thick_enough_mm(of_diameter: Callable[[float], ShaftSafety], given_mm: float, safety: ShaftSafety) -> float | None:
    """The least diameter with which a shaft that is too thin holds, to GROWN, by trials; None for a shaft that holds.

    The safety grows nearly with the third power of the diameter.
    """
    diameter_mm = given_mm
    while (least := min(safety.fatigue, safety.yielding)) < LEAST_SAFETY and diameter_mm < MOST_TIMES * given_mm:
        diameter_mm *= max((LEAST_SAFETY / least) ** (1.0 / 3.0), GROWN)
        safety = of_diameter(diameter_mm)
    return diameter_mm if diameter_mm > given_mm and least >= LEAST_SAFETY else None


def _key(
    design: Design, number: int, section: ShaftSection, torques_n_mm: Sequence[tuple[float, float]]
) -> KeySafety | None:
    """The least safe key of a shaft's gears, by the least and the largest torque of each."""
    _, name, given = design.shafts[number]
    key, gears, where = given.key if given else None, design.gears, f"drivetrain.{name}.key"
    if key is None or gears is None:
        return None
    found = []
    for gear, (least, most) in zip(design.gears_on(number), torques_n_mm, strict=True):
        body = getattr(gears, gear)
        height, keyway = key.height_mm, body.keyway
        if height is None:
            if keyway is None:
                raise WrongInput(f"given, but gears.{gear} has no keyway; give one, or height_mm", key=where)
            height = keyway.depth_mm - FREE_HEIGHT_MM
            if height <= 0.0:
                raise WrongInput(
                    f"missing; a keyway {keyway.depth_mm:g} mm deep leaves nothing over {FREE_HEIGHT_MM:g} mm of play",
                    key=f"{where}.height_mm",
                )
        longest = gears.face_width_mm + gears.hub_mm(gear)
        yields, length = section.yield_mpa, key.length_mm or gears.face_width_mm
        made = ShaftKey(section.diameter_mm, height, length, min(yields, key.yield_mpa or yields), longest)
        found.append(key_safety(made, most, least))
    weakest = min(found, key=lambda key: key.safety)
    return replace(weakest, both_senses=any(key.both_senses for key in found))


def _pto(given: PowerTakeOff, demand: Demand) -> PowerTakeOffResult:
    limit = given.torque_limiter_n_m
    return PowerTakeOffResult(
        slipping(demand, N_MM_PER_N_M * limit) if limit is not None else None,
        running_ahead(demand) if given.overrunning_clutch else None,
    )
