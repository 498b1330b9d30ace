"""One whole machine: its design file, and the figures and the verdict that follow from this file only."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf
from pathlib import Path

from ncgear.design.keys.design import Design
from ncgear.design.keys.optimize import AvailableMotor, Choices, Costs, Optimize, Process
from ncgear.design.reading.design_file import parsed
from ncgear.design.rewritten import rewritten
from ncgear.errors import DesignError
from ncgear.figures.advice.values import Kind, RemedySearch
from ncgear.figures.advice.verdict import JudgedCondition, KnownParts, State, Verdict, judged
from ncgear.frozen import dataclass
from ncgear.metrology.cut_by import CutVerdict, Tool
from ncgear.numerics.units import KG_M2
from ncgear.optimum.task import Figures, by_limit, figures
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.law_task import inertia_as_given, task_of
from ncgear.project.service import choices_of
from ncgear.project.sizing import Sized
from ncgear.project.strengthening import rating_of
from ncgear.project.workshop_measures import cut_gears
from ncgear.strength.holding import Damage, face_width_factor
from ncgear.strength.materials import Plastic
from ncgear.whole_machines.laws import law_design

TOOLS: Mapping[Process, Tool | None] = {
    "hobbed": Tool.HOB,
    "shaped": Tool.SHAPER,
    "wire_cut": Tool.WIRE,
    "printed": None,
}
"""The tool of each way of making teeth; a printer has none."""

OF_HOBS = (Kind.CONCAVE,)
"""Conditions of the verdict that concern hobs only."""

WEAK = (Kind.STRENGTH, Kind.FLANKS)
"""Conditions that wider gears may satisfy."""

KEPT = 1e-6
"""Share of a limit by which a figure may exceed it: ten times the margin that laws keep below their limits."""

MM3_PER_DM3 = 1e6


@dataclass(frozen=True)
class MachineFigures:
    """The figures of a whole machine that count, from its design file only.

    ``gear_volume_mm3`` is the face width times the square of the centre distance.  ``safeties`` are the least ratios of
    safety to wanted safety for breakage and pitting (infinite where the material has no figures), and for film and
    wear.
    """

    peak_power_w: float
    peak_torque_n_m: float
    braking_power_w: float
    peak_acceleration: float
    peak_speed: float
    pressure_angle_deg: float
    gear_volume_mm3: float
    center_distance_mm: float
    diameter_mm: float
    teeth: int
    module_mm: float
    face_width_mm: float
    driven_flywheel_kg_mm2: float
    flank_load_n_mm: float
    bending_share: float
    contact_share: float
    flank_share: float


@dataclass(frozen=True, eq=False)
class WholeMachine:
    """A machine that builds with a clean verdict: the text of its design file, and the values that follow from it.

    ``motor`` is the cheapest of the available motors, ``cost`` the cost of the machine; each is None where the file
    gives none.  ``cut`` says how its teeth are made.
    """

    name: str
    text: str
    figures: MachineFigures
    material: str
    process: Process
    cut: str
    motor: AvailableMotor | None
    cost: float | None

    def named(self, name: str) -> WholeMachine:
        """The same machine with another name, in its file too."""
        return replace(self, name=name, text=rewritten(self.text, {"name": name}))

    def value(self, objective: str) -> float:
        """A figure that counts; the cost is zero where none is given."""
        return (self.cost or 0.0) if objective == "cost" else float(getattr(self.figures, objective))


@dataclass(frozen=True, eq=False)
class Unfit:
    """Why gears do not make a whole machine: the words of the verdict or of a limit.

    ``wider`` is the factor of the face width with which teeth and flanks may hold; None where they are not the cause.
    ``finer`` says whether more teeth may help.
    """

    why: tuple[str, ...]
    wider: float | None = None
    finer: bool = False


def machine_and_law_figures(drive: Drive) -> tuple[MachineFigures, Figures]:
    """The figures of a machine from its drive; raises as teeth and their strength do."""
    design, size = drive.design, drive.pitch.size
    made = law_design(design)
    found = figures(task_of(made, inertia_as_given(made)), drive.law.train)
    rating = rating_of(drive, "estimate")
    sized = Sized({}, drive, rating)
    shares = {
        damage: min((weakest.share for weakest in rating.weakest if weakest.damage is damage), default=inf)
        for damage in Damage
    }
    power = drive.check.peak_power_w.value
    return MachineFigures(
        peak_power_w=power,
        peak_torque_n_m=power / drive.machine.speed_rad_s,
        braking_power_w=found.braking_power_w or 0.0,
        peak_acceleration=found.peak_acceleration_mm_s2,
        peak_speed=found.peak_speed_mm_s,
        pressure_angle_deg=drive.largest_pressure_angle_deg,
        gear_volume_mm3=sized.volume_mm3,
        center_distance_mm=size.center_distance_mm,
        diameter_mm=sized.diameter_mm,
        teeth=size.driving_teeth,
        module_mm=size.module_mm,
        face_width_mm=drive.gears.face_width_mm,
        driven_flywheel_kg_mm2=design.masses.driven_flywheel_kg_mm2 if design.masses else 0.0,
        flank_load_n_mm=found.flank_load_n_mm or 0.0,
        bending_share=shares[Damage.BENDING],
        contact_share=shares[Damage.CONTACT],
        flank_share=sized.flank_share,
    ), found


def guessed_figures(law: Figures, flywheel_kg_mm2: float, volume_mm3: float, speed_rad_s: float) -> MachineFigures:
    """Figures of a machine before its gears are known: the law's figures, and a guess of the gears' volume."""
    return replace(
        MachineFigures(**dict.fromkeys(MachineFigures.__dataclass_fields__, 0.0)),  # type: ignore[arg-type]
        peak_power_w=law.peak_power_w,
        peak_torque_n_m=law.peak_power_w / speed_rad_s,
        gear_volume_mm3=volume_mm3,
        driven_flywheel_kg_mm2=flywheel_kg_mm2,
    )


def limits_missed(design: Design, found: Figures, pressure_angle_deg: float) -> list[str]:
    """The limits of ``optimize`` that figures exceed, in words."""
    limits = (design.optimize or Optimize()).limits
    missed = [
        f"{name} {value:.6g} over {limit:g}"
        for name, value in by_limit(found, pressure_angle_deg).items()
        if (limit := getattr(limits, name)) is not None and value is not None and value > limit * (1.0 + KEPT)
    ]
    return [
        *missed,
        *([f"ratio_min {found.ratio_min:.6g}"] if found.ratio_min < limits.ratio_min * (1.0 - KEPT) else []),
    ]


def broken(verdict: Verdict, process: Process) -> list[JudgedCondition]:
    """The conditions that a verdict finds broken, for gears that are made by a process."""
    return [
        row for row in verdict.rows if row.state is State.BROKEN and (process == "hobbed" or row.kind not in OF_HOBS)
    ]


def ask_for_more_teeth(rows: Sequence[JudgedCondition]) -> bool:
    """Whether the first of the broken conditions has more teeth among its remedies."""
    return any(
        remedy.search is RemedySearch.FINER for row in rows[:1] for advice in row.advices for remedy in advice.remedies
    )


def cut_words(drive: Drive, process: Process) -> tuple[bool, str]:
    """Whether a process makes both gears, and how, or why not, in words."""
    plastic = [isinstance(choice.entry, Plastic) for choice in choices_of(drive.gears)]
    if process == "printed" or process == "wire_cut":
        # Plastics do not conduct, and printers of this kind print plastics
        if any(plastic) != (process == "printed"):
            return False, "of plastic" if any(plastic) else "of metal"
        if process == "printed":
            return True, "printed"
    tool = TOOLS[process]
    cuts = [next(by for by in gear.by if by.tool is tool) for gear in cut_gears(drive)]
    for gear, by in zip(Gear, cuts, strict=True):
        if by.verdict is CutVerdict.NOT:
            return False, f"the {gear.value} gear: {by.reason}"
    worst = max((by.verdict for by in cuts), key=[CutVerdict.CUTS, CutVerdict.FLANKS].index)
    return True, f"a {tool.value if tool else ''} {worst.value}"


def motor_for(choices: Choices, found: MachineFigures) -> AvailableMotor | None:
    """The cheapest available motor that is strong enough; None where there is none, or where any power is available."""
    does = [
        motor
        for motor in choices.motors or ()
        if motor.power_w >= found.peak_power_w
        and (motor.torque_n_m is None or motor.torque_n_m >= found.peak_torque_n_m)
    ]
    return min(does, key=lambda motor: (motor.cost, motor.power_w), default=None)


def cost_of(
    choices: Choices, found: MachineFigures, motor: AvailableMotor | None, material: str, process: Process
) -> float | None:
    """The cost of a machine; None where the file gives no costs."""
    if choices.cost is None and not choices.motors:
        return None
    costs = choices.cost or Costs.model_construct()
    factors = {material.material.name: material.cost_factor for material in choices.materials or ()}
    return (
        costs.motor_per_w * found.peak_power_w
        + costs.motor_per_n_m * found.peak_torque_n_m
        + costs.gears_per_dm3 * found.gear_volume_mm3 / MM3_PER_DM3 * factors.get(material, 1.0)
        + costs.driven_flywheel_per_kg_m2 * KG_M2 * found.driven_flywheel_kg_mm2
        + float(getattr(costs.making, process))
        + (0.0 if motor is None else motor.cost)
    )


def judged_machine(text: str, process: Process, choices: Choices) -> WholeMachine | Unfit:
    """The machine that a design file's text gives, or why it is none; everything is computed anew."""
    loaded = parsed(text, Path("machine.yaml"))
    drive = Drive(loaded.design, loaded=loaded)
    try:
        rows = broken(judged(drive, KnownParts.TEETH, seconds=0.0), process)
        wrong = [f"{row.kind}: {advice.what}" for row in rows for advice in row.advices]
        if wrong:
            weak = any(row.kind in WEAK for row in rows)
            return Unfit(tuple(wrong), _wider(drive) if weak else None, ask_for_more_teeth(rows))
        found, law = machine_and_law_figures(drive)
        missed = limits_missed(loaded.design, law, found.pressure_angle_deg)
        wider = None
        if min(found.bending_share, found.contact_share, found.flank_share) < 1.0:
            wider = _wider(drive)
            missed.append("the teeth do not hold")
        is_cut, cut = cut_words(drive, process)
    except DesignError as error:
        return Unfit((error.problem,))
    if not is_cut:
        missed.append(f"gears of this kind cannot be {process.replace('_', ' ')} ({cut})")
    motor = motor_for(choices, found)
    if choices.motors and motor is None:
        missed.append(f"no motor that can be had gives {found.peak_power_w:.4g} W and {found.peak_torque_n_m:.4g} N m")
    if missed:
        return Unfit(tuple(missed), wider)
    material = choices_of(drive.gears)[0].entry.name
    cost = cost_of(choices, found, motor, material, process)
    return WholeMachine(loaded.design.name, text, found, material, process, cut, motor, cost)


def _wider(drive: Drive) -> float:
    """The factor of the face width with which teeth and flanks are expected to hold."""
    rating = rating_of(drive, "estimate")
    return max(face_width_factor(rating.weakest), 1.0 / drive.surfaces_by("estimate").share)
