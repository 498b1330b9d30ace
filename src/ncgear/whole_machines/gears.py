"""From a law to a whole machine: the smallest gears of a material that hold, with a clean verdict, as a design file.

The gears' own inertia belongs to the machine, so the law is found again with the inertia of its gears.
"""

from __future__ import annotations

from math import ceil
from pathlib import Path
from typing import Any, NamedTuple

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import SIZES
from ncgear.design.keys.optimize import Choices, Process
from ncgear.design.keys.strength import GearMaterial, PairMaterial
from ncgear.design.laws.registry import found_values
from ncgear.design.reading.design_file import LoadedDesign, parsed
from ncgear.design.reading.text import whole
from ncgear.design.rewritten import design_copy
from ncgear.errors import DesignError
from ncgear.figures.advice.verdict import KnownParts, judged
from ncgear.project.alternatives import Changes, changed_drive, is_given, with_width
from ncgear.project.drive import Drive
from ncgear.project.law import kept_size
from ncgear.project.sizing import FEWEST_TEETH, Accepted, GearRoom, Sized, is_finer, smallest_accepted, stated_inertias
from ncgear.project.strengthening import SERIES_I_MM, sized
from ncgear.project.tolerance_limits import TURNING, jamming_of
from ncgear.whole_machines.laws import FoundLaw, law_keys, settled_law
from ncgear.whole_machines.machine import (
    WEAK,
    MachineFigures,
    Unfit,
    WholeMachine,
    ask_for_more_teeth,
    broken,
    judged_machine,
)

MOST_COMPUTED = 8
"""Most gears that are computed for one law and material, at a second each."""

MENDED = 4
"""Most remedies of the verdict that are taken, one after the other."""

ROUNDS = 4
"""Most pairs of law and face width that are tried until both agree."""

SHAPED = {"gears.cutter.kind": "pinion", "gears.rack.profile": "D"}
"""Keys of gears whose spaces a shaper cuts, as far as the file gives none.  Its fillets reach higher than those of a
hob, and the deeper profile of ISO 53 leaves them room."""

ROOM_OF_CAP = 1.002
"""Ratio by which the peak power may grow when the law is found with the gears' own inertia."""

SIZE_KEYS = {f"gears.{key}" for key in (*SIZES, "face_width_mm", "material")}
"""Keys that the choice of sizes sets: no remedy changes them."""


class GearJob(NamedTuple):
    """A law, a material (None: the file's material) and ways of making teeth, from which a machine is to be made.

    The search begins with the gears of ``near``, a machine of another law, grown or shrunk with the flank load; without
    it at the size of the file.
    """

    law: FoundLaw
    material: GearMaterial | None
    processes: tuple[Process, ...]
    near: MachineFigures | None = None


def machine_of(text: str, job: GearJob) -> WholeMachine | Unfit:
    """The smallest machine of a law, by the first way of making teeth that works, or why none; ``text`` is the file."""
    loaded = parsed(text, Path("design.yaml"))
    made: WholeMachine | Unfit = Unfit(("no way of making teeth that may be chosen suits this material",))
    for process in job.processes:
        made = _Making(loaded, job, process).made()
        if isinstance(made, WholeMachine):
            break
    return made


def started(design: Design, law: FoundLaw, material: GearMaterial | None) -> Drive:
    """The drive of a law with the sizes of the file, another material, and the law's own flywheel."""
    assert design.gears is not None
    sizes = dict(zip(SIZES, kept_size(design), strict=True))
    gears = design.gears.model_copy(update=sizes)
    if material is not None:
        gears = gears.model_copy(update={"material": PairMaterial(driving=material)})
    update: dict[str, Any] = {"motion": law_keys(law), "gears": gears}
    if design.masses is not None:
        left_out = {key.removeprefix("masses."): None for key in stated_inertias(design)}
        update["masses"] = design.masses.model_copy(update={"driven_flywheel_kg_mm2": law.flywheel_kg_mm2, **left_out})
    return Drive(design.model_copy(update=update))


def room_of(choices: Choices, fewest_teeth: int) -> GearRoom:
    """The room that the choices leave for gears."""
    widths = choices.face_width_modules
    distance, diameter = choices.center_distance_mm, choices.diameter_mm
    return GearRoom(
        **({} if distance is None else {"center_distance_mm": distance}),
        **({} if diameter is None else {"diameter_mm": diameter}),
        width_modules=widths.most,
        least_width_modules=widths.least,
        modules_mm=choices.modules_mm or SERIES_I_MM,
        fewest_teeth=fewest_teeth,
    )


def fewest_teeth(drive: Drive) -> int:
    """The least number of driving teeth without undercut at any place of the pitch curves."""
    from ncgear.teeth.gear import teeth_free_of_undercut

    lobes = drive.gears.lobes.driving
    least = max(FEWEST_TEETH, teeth_free_of_undercut(drive.pitch, drive.rack, drive.rack))
    return -(-least // lobes) * lobes


def more_backlash(drive: Drive) -> Changes:
    """The backlash with which 99.9 % of the assemblies turn by the estimate; empty where they do, or are not judged.

    Drawn one by one, up to three times as many jam as are estimated (a baler: 1.12 for 0.41 %), and 1 % at most may.
    """
    try:
        found = jamming_of(drive)
    except DesignError:
        return {}
    return {found.key: found.enough} if found.given and found.fits and found.share > 1.0 - TURNING else {}


class _Weakened(Exception):
    """Teeth do not hold after remedies of the verdict; ``drive`` has the remedies, ``changes`` are their keys."""

    def __init__(self, drive: Drive, changes: Changes) -> None:
        super().__init__()
        self.drive, self.changes = drive, changes


class _Making:
    """The search for one machine: one law, one material and one way of making teeth."""

    def __init__(self, loaded: LoadedDesign, job: GearJob, process: Process) -> None:
        self.loaded, self.job, self.process = loaded, job, process
        self.choices = loaded.design.choices or Choices()
        self.mended: Changes = {}
        shaped = SHAPED if process == "shaped" else {}
        self.kept: Changes = {key: value for key, value in shaped.items() if not is_given(loaded.design, key)}
        self.coarse: list[Sized] = []
        self.why: tuple[str, ...] = ("no gears of these modules and face widths hold",)

    def made(self) -> WholeMachine | Unfit:
        """The machine, or why there is none."""
        try:
            drive = changed_drive(started(self.loaded.design, self.job.law, self.job.material), self.kept)
            room = room_of(self.choices, fewest_teeth(drive))
            if (near := self.job.near) is not None:
                grown = (self.job.law.flank_load_n_mm / near.flank_load_n_mm) ** (1.0 / 3.0)
                size = sized(drive, max(near.teeth, room.fewest_teeth), grown * near.module_mm)
                drive = changed_drive(drive, {**size, **with_width(drive.design, grown * near.face_width_mm)})
            for _ in range(MENDED):
                try:
                    found = smallest_accepted(drive, room, self.is_clean, MOST_COMPUTED, lambda done, most: None)
                    made = Unfit(self.why) if found is None else self.finished(found)
                    if found is None or isinstance(made, WholeMachine) or not made.finer:
                        return made
                    self.coarse.append(found)
                    self.why = made.why
                except _Weakened as weakened:
                    # Teeth that the changes make thinner or lower have to be larger
                    self.kept = {**self.kept, **weakened.changes}
                    drive = weakened.drive
        except (DesignError, ArithmeticError) as error:
            return Unfit((getattr(error, "problem", str(error)),))
        return Unfit(self.why)

    def is_clean(self, sized: Sized) -> Accepted:
        """Whether the verdict on gears is clean, after its own remedies; the remedies are kept.

        Gears no finer than those that made no machine with the law of their own inertia are not.  Raises _Weakened
        where teeth do not hold with these remedies.
        """
        if not all(is_finer(size, sized.teeth, sized.module_mm) for size in self.coarse):
            return Accepted.WITH_MORE_TEETH
        drive, taken = sized.drive, Changes()
        try:
            for _ in range(MENDED):
                rows = broken(judged(drive, KnownParts.TEETH, seconds=0.0), self.process)
                changes = {} if rows else more_backlash(drive)
                if not rows and not changes:
                    self.mended = taken
                    return Accepted.YES
                if rows:
                    self.why = tuple(
                        f"{row.kind}: {advice.what}" for row in rows for advice in row.advices if advice.matters
                    )
                    if taken and rows[0].kind in WEAK:
                        raise _Weakened(drive, taken)
                    remedies = [remedy for advice in rows[0].advices for remedy in advice.remedies]
                    changes = next((made for remedy in remedies if (made := _taken(remedy.changes))), {})
                if not changes:
                    return Accepted.WITH_MORE_TEETH if ask_for_more_teeth(rows) else Accepted.NO
                drive = changed_drive(drive, changes)
                taken |= changes
        except DesignError as error:
            self.why = (error.problem,)
        return Accepted.NO

    def finished(self, sized: Sized) -> WholeMachine | Unfit:
        """The machine with a law found with its own gears, widened until its teeth hold with this law."""
        law, values = self.job.law, self.values(sized)
        power_w = law.found.peak_power_w
        motors = (motor.power_w for motor in self.choices.motors or () if motor.power_w >= power_w)
        cap_w = min((ROOM_OF_CAP * power_w, *motors))
        made: WholeMachine | Unfit = Unfit(self.why)
        for _ in range(ROUNDS):
            design = parsed(design_copy(self.loaded, values), Path("machine.yaml")).design
            if design.masses is not None:
                law = settled_law(design, sized.teeth, law.motion, cap_w) or law
                values["motion"] = found_values(law.ratio, None)
            made = judged_machine(design_copy(self.loaded, values), self.process, self.choices)
            if isinstance(made, Unfit) and made.finer:
                # Tips that the law of these gears' inertia shortens may do with the law as it was
                values["motion"] = found_values(self.job.law.ratio, None)
                made = judged_machine(design_copy(self.loaded, values), self.process, self.choices)
            if isinstance(made, WholeMachine):
                return made
            if made.wider is not None:
                width_mm = values["gears.face_width_mm"]
                values["gears.face_width_mm"] = whole(float(ceil(max(width_mm * made.wider, width_mm + 1.0) - 1e-9)))
            else:
                break
        return made

    def values(self, sized: Sized) -> dict[str, Any]:
        """The keys of the machine's file that differ from the file with the choices."""
        design, law = self.loaded.design, self.job.law
        chosen = {**self.kept, **sized.changes, **self.mended}
        values: dict[str, Any] = {
            "motion": found_values(law.ratio, None),
            **{key: whole(value) if isinstance(value, float) else value for key, value in chosen.items()},
            **dict.fromkeys(stated_inertias(design)),
        }
        # Where the nearest gears are the file's gears nothing is changed
        size = dict(zip(("gears.teeth", "gears.module_mm"), (sized.teeth, sized.module_mm), strict=True))
        values = {**size, "gears.face_width_mm": whole(sized.face_width_mm), **values}
        if design.gears is not None and design.gears.center_distance_mm is not None:
            values["gears.center_distance_mm"] = None
        if self.job.material is not None:
            material = self.job.material.model_dump(exclude_unset=True)
            values["gears.material"] = material["name"] if set(material) == {"name"} else material
        if design.masses is not None and design.free_flywheel is not None:
            values["masses.driven_flywheel_kg_mm2"] = whole(law.flywheel_kg_mm2)
        return values


def _taken(changes: tuple[Any, ...]) -> Changes:
    """The changes of a remedy, if all are of the gears or of what passes them and none is a size; else none."""
    keys = [change.key for change in changes]
    if not keys or any(not key.startswith(("gears.", "fit.")) or key in SIZE_KEYS for key in keys):
        return {}
    return {change.key: change.value for change in changes}
