"""The rough strength of a design, for a check: from its law, its pitch curves and its loads, without making teeth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from math import ceil, cos, inf, isfinite, lcm, pi, radians, sin
from typing import TYPE_CHECKING

import numpy as np

from ncgear.errors import DesignError, Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.plane import as_complex
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project.drive import Drive
from ncgear.project.service import choices_of
from ncgear.project.tooth_form import tooth_form_of
from ncgear.project.tooth_load import asked_of
from ncgear.project.vibration import ToldVibration, told_vibration
from ncgear.strength.conditions import Conditions
from ncgear.strength.endurance import materials_of
from ncgear.strength.iso6336 import RackTip, rim_factor, thinnest_rim_mm
from ncgear.strength.material import Material
from ncgear.strength.materials import Plastic
from ncgear.strength.plastics import friction, temperatures_of
from ncgear.strength.vibration import MeshStiffness
from ncgear.strength.without_teeth import (
    MOST_LEAP,
    MOST_WAY,
    PER_TOOTH,
    PUSHING_AND_BACK,
    RolledLoad,
    RoughSafety,
    SharedLoad,
    ToothPlan,
    rough_safeties,
    shared_loads,
    slid_w,
    static_safeties,
)

if TYPE_CHECKING:
    from ncgear.dynamics.flank_changes import BorneTorque


@dataclass(frozen=True)
class RoughStrength:
    """Both gears' safeties, roughly.

    ``unjudged`` says why the teeth are not judged for the wanted life.  ``at_once`` means that the safeties are against
    breaking at once instead; there are no safeties where even these are not known.  ``needs_teeth`` says why the
    safeties are right only within a factor of two and a half.  Both texts follow "because", and are empty without such
    a reason.  ``jammed`` are the safeties in a jam, with ``jam_needs_teeth`` as their reason.  ``vibration`` has the
    figures of the mesh where the life of its teeth is judged.
    """

    safeties: tuple[RoughSafety, ...]
    unjudged: str = ""
    needs_teeth: str = ""
    at_once: bool = False
    vibration: ToldVibration | None = None
    jammed: tuple[RoughSafety, ...] = ()
    jam_needs_teeth: str = ""

    def needs_teeth_for(self, safety: RoughSafety) -> str:
        """Why one of the safeties is right only within a factor; empty without such a reason."""
        return self.jam_needs_teeth if safety in self.jammed else self.needs_teeth

    def share(self, safety: RoughSafety) -> float:
        """A safety over the safety below which teeth certainly do not hold."""
        return safety.safety / (safety.wanted * (0.4 if self.needs_teeth_for(safety) else CERTAINLY))

    @property
    def holds(self) -> bool:
        """Whether every safety is the wanted one, and no reason asks to look at the teeth; rings hold by RINGS_HOLD."""
        reasons = {self.needs_teeth, self.jam_needs_teeth} - {""}
        by_ring = all(safety.safety >= RINGS_HOLD * safety.wanted for safety in self.safeties)
        enough = all(safety.safety >= safety.wanted for safety in self.safeties)
        return enough and not self.unjudged and (not reasons or (reasons == {OF_A_RING} and by_ring))

    @property
    def weak(self) -> list[RoughSafety]:
        """The safeties of teeth that do not hold, the weakest first."""
        return sorted((safety for safety in self.safeties if self.share(safety) < 1.0), key=self.share)


CERTAINLY = 0.85
"""Share of the wanted safety under which teeth do not hold: rough safeties are 0.86 to 1.14 of those by the teeth, of
helical teeth 0.83 to 1.04 (docs/method.md), so that teeth between this share and the wanted safety may hold."""

RINGS_HOLD = 1.5
"""Ratio to the wanted safety from which a pinion and its ring hold without being looked at tooth by tooth: rough
safeties of a dozen such pairs in a jam are 0.73 to 1.23 of those by the teeth."""


@lru_cache(maxsize=2)
def rough_strength(drive: Drive) -> RoughStrength | None:
    """The rough strength of a pair; None without gears or load, and for two pairs without a stage.

    The results of the last two pairs are kept, since several conditions ask for them.
    """
    design = drive.design
    if design.gears is None or not design.loads_teeth:
        return None
    if design.stages > 1 and drive.stage is None:
        return None
    try:
        load, plan = rolled_load(drive), tooth_plan(drive)
    except DesignError as error:
        # Pitch curves and forces may be refused; a check does not need them.
        return RoughStrength((), error.problem)
    if not load.force_n.any() and design.strength.overload is None:
        return RoughStrength((), "no given load presses the teeth at any angle")
    if np.any(load.force_n < 0.0):
        return RoughStrength((), "the teeth cannot push the driven gear at every angle")
    running, conditions = drive.running, drive.conditions
    sides = shared_loads(load, plan, running, drive.materials)
    asked, borne = asked_of(drive), None
    if asked.knocks_are_judged:
        # Checks of machines without masses load no module of contact.
        from ncgear.project.forces import borne_by
        from ncgear.project.rough_meshing import rough_meshing

        borne = borne_by(design.simulation, asked, rough_meshing(drive, asked, sides))
        each = [rolled_load(drive, partial(borne.hardest, urge)) for urge in PUSHING_AND_BACK]
        sides = [side for pair in each for side in shared_loads(pair, plan, running, drive.materials)]
        load = replace(load, force_n=np.maximum(*(load.force_n for load in each)))
    in_series = asked.load == "masses" and not asked.knocks_are_judged and len(sides) > 1 and design.stages > 1
    if asked.loads_return:
        sides = [*sides, *shared_loads(rolled_load(drive, asked.returning_n_mm), plan, running, drive.materials)]
    needs_teeth = _needs_teeth(drive, plan, load, sides) if sides else ""
    jam_needs_teeth = needs_teeth
    if in_series:
        needs_teeth = needs_teeth or "it needs the teeth to tell how hard pairs in series knock"
    warm, why = _warm(drive, sides, load.phi1_rad.size), _no_life(drive, load.phi1_rad)
    jammed = list[RoughSafety]()
    try:
        if (jam := conditions.overload) is not None:
            pressed = rolled_load(drive, partial(asked.passed_on_n_mm, jam.driving_n_mm))
            jams_h = jam.times * drive.transmission.cycle_rad / running.speed_rad_s / 3600.0
            few = replace(conditions, application_factor=1.0, dynamic_factor=1.0, life_h=jams_h)
            in_jam = shared_loads(pressed, plan, running, drive.materials)
            still = _even(in_jam, 1.0)
            uneven = _uneven(drive, in_jam, few, still)
            if why:
                jammed = static_safeties(in_jam, plan, running, warm, few, uneven)
            else:
                jammed = rough_safeties(in_jam, plan, running, warm, few, uneven, still)
            if not sides:
                needs_teeth = _needs_teeth(drive, plan, pressed, in_jam)
                return RoughStrength(tuple(jammed), why, needs_teeth, bool(why), None, tuple(jammed), needs_teeth)
        if not why:
            mesh = rough_mesh(drive, sides, load)
            shaken = [_shaken(drive, side.load, mesh, borne) for side in sides]
            uneven = _uneven(drive, sides, conditions, shaken)
            found = rough_safeties(sides, plan, running, warm, conditions, uneven, shaken)
            phi1, force = (np.concatenate([getattr(side.load, of) for side in sides]) for of in ("phi1_rad", "force_n"))
            told = None
            if mesh is not None:
                told = told_vibration(drive, drive.vibration, mesh, phi1, np.concatenate(shaken), force)
            every = *found, *jammed
            return RoughStrength(every, "", needs_teeth, False, told, tuple(jammed), jam_needs_teeth)
        uneven = _uneven(drive, sides, conditions, _even(sides, conditions.dynamic_factor or 1.0))
        found = static_safeties(sides, plan, running, warm, conditions, uneven)
        return RoughStrength((*found, *jammed), why, needs_teeth, True, None, tuple(jammed), jam_needs_teeth)
    except Unanswered as error:
        return RoughStrength((), error.problem)


def beside_refusal(drive: Drive, refusal: DesignError | None) -> RoughStrength | None:
    """The rough strength of a pair whose strength is refused, or was not computed (None)."""
    found = rough_strength(drive)
    return found if found is None or refusal is None else replace(found, unjudged=refusal.problem)


def rough_mesh(drive: Drive, sides: list[SharedLoad], load: RolledLoad) -> MeshStiffness | None:
    """The rough mean stiffness of a pair's teeth over a pitch."""
    width_mm = drive.running.face_width_mm
    each = ((side.load.phi1_rad, width_mm * side.stiffness_n_mm2, side.bearing) for side in sides)
    phi1, stiffness, pairs = (np.concatenate(parts) for parts in zip(*each, strict=True))
    cycle = 2.0 * pi * round(load.phi1_rad.size / PER_TOOTH / drive.running.teeth[0]) if load.closed else None
    per_pitch = PER_TOOTH * (2 if asked_of(drive).loads_return else 1)
    return MeshStiffness.of(phi1, stiffness, pairs, cycle, per_pitch)


def rough_damage(found: RoughStrength, safety: RoughSafety) -> str:
    """The damage of a tooth, in words that follow "against"."""
    return "breaking at once" if found.at_once else safety.damage.words


def _no_life(drive: Drive, phi1_rad: Array) -> str:
    """Why the life of these teeth is unknown under any load."""
    for gear in Gear:
        wall_mm = float(_walls_mm(drive, gear, phi1_rad).min())
        if wall_mm < _known_wall_mm(drive, gear):
            wall = f"a wall of {max(wall_mm, 0.0):.2g} mm"
            return f"{wall} of the {gear.value} gear is thinner than ISO 6336-3 has a factor for"
    return ""


def _needs_teeth(drive: Drive, plan: ToothPlan, load: RolledLoad, sides: list[SharedLoad]) -> str:
    module = drive.running.module_mm
    if abs(sum(plan.shifts)) > LEAST_SHIFT:
        return "it needs the teeth to tell where both profile shifts are not opposite"
    if drive.gears.idlers is not None:
        return "it needs the teeth to tell of idlers, which bend both ways"
    pushing, idle = plan.angles_rad
    if abs(pushing - idle) > MOST_UNEQUAL_RAD:
        return "it needs the teeth to tell of unequal pressure angles"
    if _would_be_undercut(drive):
        return "it needs the teeth to tell where they would be undercut"
    if load.leap(module) > MOST_LEAP:
        return "it needs the teeth to tell where the curvature of the pitch curves changes so much within a tooth"
    if max(float(side.way_mm.max()) for side in sides) > MOST_WAY * module:
        return "it needs the teeth to tell where they give way so far under the load"
    return OF_A_RING if drive.pitch.mesh is Mesh.INTERNAL else ""


OF_A_RING = "it needs the teeth to tell of a ring"


def _shaken(drive: Drive, load: RolledLoad, mesh: MeshStiffness | None, borne: BorneTorque | None) -> Array:
    """K_V at the positions of a load, shape (n,): for the law's part of it, or for the computed motion with knocks."""
    shaken, conditions = drive.vibration.factors, drive.conditions
    if borne is None or not borne.phi1_rad.size or conditions.dynamic_factor is not None:
        return shaken(load.phi1_rad, load.force_n, mesh, conditions)
    most_n_mm = load.force_n / asked_of(drive).mesh_force(load.phi1_rad, load.urge).size_n.value
    share = np.clip(load.urge * borne.asked(load.phi1_rad) / most_n_mm, LEAST_SHARE, 1.0)
    still = share * shaken(load.phi1_rad, share * load.force_n, mesh, conditions)
    return np.maximum(still, shaken(load.phi1_rad, load.force_n, mesh, conditions, followed=True))


LEAST_SHARE = 1e-9
"""Least share of the law's torque in a followed torque: K_V divides by loads."""


def _even(sides: list[SharedLoad], factor: float) -> list[Array]:
    """A factor that is the same at all positions of each side, shape (n,) each."""
    return [np.full(side.load.force_n.shape, factor) for side in sides]


def _uneven(drive: Drive, sides: list[SharedLoad], conditions: Conditions, shaken: list[Array]) -> list[Array]:
    """K_Hbeta at the positions of each side with K_V ``shaken`` there, shape (n,) each."""
    over = conditions.application_factor
    return [drive.face_loading.of_side(side, over, factor) for side, factor in zip(sides, shaken, strict=True)]


def _would_be_undercut(drive: Drive) -> bool:
    """Whether the straight edge of the rack reaches beyond the foot of the normal from the centre of curvature."""
    rack = tooth_form_of(drive.gears, drive.pitch.size.module_mm).rack
    most = max(drive.pitch.curvature_range[gear][1].value for gear in Gear) / drive.pitch.center_distance_mm
    return rack.flank_depth_mm * most > sin(min(rack.angles_rad)) ** 2


MOST_UNEQUAL_RAD = radians(5.0)
"""Difference of both pressure angles above which roots differ from the roots of a rack with either angle."""

LEAST_SHIFT = 1e-9
"""Sum of both shifts in modules up to which it counts as zero."""


def _warm(drive: Drive, sides: list[SharedLoad], positions: int) -> tuple[Material, Material]:
    choices, conditions, running = choices_of(drive.gears), drive.conditions, drive.running
    if not any(isinstance(choice.entry, Plastic) for choice in choices):
        return drive.materials
    lost = slid_w(sides, positions, running.face_width_mm, friction(choices, conditions.lubrication))
    return materials_of(choices, conditions, running, temperatures_of(choices, conditions, running, lost))


def tooth_plan(drive: Drive) -> ToothPlan:
    """How the teeth of a pair would be cut."""
    rack, form = drive.gears.rack, tooth_form_of(drive.gears, drive.pitch.size.module_mm)
    module, (pushing, idle) = form.rack.module_mm, rack.angles_deg
    shifts = form.driving_shift_mm / module, form.driven_shift_mm / module
    tip = RackTip(rack.dedendum, rack.root_radius)
    rims = partial(_rims, drive, Gear.DRIVING), partial(_rims, drive, Gear.DRIVEN)
    helix = (drive.helix.angle_rad, drive.helix.largest_advance_mm) if drive.helix else (0.0, 0.0)
    play = drive.play
    both_mm, own_mm = play.largest_normal_mm.value / cos(radians(idle)), play.setback_mm - play.thicker_mm
    # The deviation of both thicknesses is in the play already
    thinner = own_mm / module, (both_mm - own_mm) / module
    angles = radians(pushing), radians(idle)
    return ToothPlan(tip, rack.addendum, shifts, angles, form.rack.relief, rims, *helix, thinner)


def _rims(drive: Drive, gear: Gear, phi1_rad: Array) -> Array:
    """Y_B of a gear at driving angles, shape (n,); only a lower bound where walls are thinner than its known range."""
    module, ring = drive.running.module_mm, drive.pitch.of(gear).is_ring
    walls = np.maximum(_walls_mm(drive, gear, phi1_rad), _known_wall_mm(drive, gear))
    return np.asarray(rim_factor(walls, _height_mm(drive), module, internal=ring))


def _height_mm(drive: Drive) -> float:
    return drive.running.module_mm * (drive.gears.rack.addendum + drive.gears.rack.dedendum)


def _known_wall_mm(drive: Drive, gear: Gear) -> float:
    return thinnest_rim_mm(_height_mm(drive), drive.running.module_mm, internal=drive.pitch.of(gear).is_ring)


def _walls_mm(drive: Drive, gear: Gear, phi1_rad: Array) -> Array:
    """The walls that the keys of a gear give under the roots at driving angles, shape (n,).

    Walls of a web, a ring, lightening holes and the bore with its keyway; infinite where no key gives a wall: a rim
    that the file leaves out is thick enough.  All helical teeth count as the tooth with the thinnest wall.
    """
    body, curve = getattr(drive.gears, gear.value), drive.pitch.of(gear)
    if curve.is_ring:
        from ncgear.project.gear_solids import rim_mm_of

        cycle = np.linspace(0.0, drive.transmission.cycle_rad, PER_TOOTH * drive.pitch.size.driven_teeth)
        farthest_mm = float(np.abs(_roots_mm(drive, gear, cycle)).max())
        rim_mm = rim_mm_of(drive.gears, drive.pitch.size.module_mm)
        return np.asarray(farthest_mm + rim_mm - np.abs(_roots_mm(drive, gear, phi1_rad)))
    given = [body.web.rim_mm] if body.web else []
    given += [body.lightening_holes.least_wall_mm] if body.lightening_holes else []
    walls = np.full(phi1_rad.shape, min(given, default=inf))
    if not body.bore_mm:
        return walls
    bored = _bored_mm(drive, gear, phi1_rad)
    if body.keyway:
        # The keyway is near few roots: both roots of a touching tooth are within a pitch.
        step_rad = 2.0 * pi / drive.pitch.size.driving_teeth * AROUND
        turns = phi1_rad + step_rad[:, None]
        end = drive.pitch.toothed.covered_rad if drive.pitch.toothed is not None else inf
        bored = _bored_mm(drive, gear, np.clip(turns, 0.0 if isfinite(end) else -inf, end)).min(axis=0)
    return np.asarray(np.minimum(walls, bored.min() if drive.helix else bored))


AROUND = np.linspace(-1.0, 1.0, 9)
"""Distances in pitches from the contact at which walls over a keyway are computed."""


def _bored_mm(drive: Drive, gear: Gear, phi1_rad: Array) -> Array:
    """The walls between the roots at driving angles, of any shape, and a bore with its keyway along +x."""
    body, roots = getattr(drive.gears, gear.value), _roots_mm(drive, gear, phi1_rad)
    radius_mm = body.bore_mm / 2.0
    wall = np.abs(roots) - radius_mm
    if body.keyway is None:
        return np.asarray(wall)
    beyond = np.maximum(roots.real - radius_mm - body.keyway.depth_mm, 0.0)
    beside = np.maximum(np.abs(roots.imag) - body.keyway.width_mm / 2.0, 0.0)
    return np.asarray(np.where(roots.real > 0.0, np.minimum(wall, np.hypot(beyond, beside)), wall))


def _roots_mm(drive: Drive, gear: Gear, phi1_rad: Array) -> ComplexArray:
    """The bottoms of spaces at driving angles in the gear's frame, of any shape."""
    at = drive.pitch.of(gear).at_angle(phi1_rad)
    form = tooth_form_of(drive.gears, drive.pitch.size.module_mm)
    shift_mm = form.driving_shift_mm if gear is Gear.DRIVING else form.driven_shift_mm
    deep_mm = drive.gears.rack.dedendum * drive.running.module_mm - shift_mm
    return as_complex(at.position) - deep_mm * as_complex(at.normal)


def rolled_load(drive: Drive, torque_n_mm: Callable[[Array], Array] | None = None) -> RolledLoad:
    """The load of a pair while its pitch curves roll; raises as pitch curves and forces do.

    The torque is ``torque_n_mm`` at driving angles, shape (n,), or else the torque that the law asks for.
    """
    asked, pitch = asked_of(drive), drive.pitch
    size, toothed = pitch.size, pitch.toothed
    step_mm = pi * size.module_mm / PER_TOOTH
    count, end_mm, end_rad = lcm(size.driving_teeth, size.driven_teeth) * PER_TOOTH, np.inf, np.inf
    if toothed is not None:
        end_mm, end_rad = toothed.covered_mm, toothed.covered_rad
        count = ceil(end_mm / step_mm) + 1
    rolled: Array = np.minimum(step_mm * np.arange(count, dtype=float), end_mm)
    # Rounding must not put the first position before the seam of the law, or the last position beyond a range.
    phi1 = np.clip(pitch.driving.driving_angle(rolled), 0.0, end_rad)
    speed = pitch.transmission.driven_angle(phi1, 1).derivative(1)
    curvature = np.stack([pitch.of(gear).at_angle(phi1).curvature for gear in Gear])
    torque = (torque_n_mm or asked.torque_n_mm)(phi1)
    urge = np.where(torque < 0.0, -1.0, 1.0)
    turning = np.abs(drive.pair_speed_rad_s(phi1) * (1.0 - pitch.mesh.sense * speed))
    force = asked.mesh_force(phi1, torque).size_n.value
    return RolledLoad(phi1, force, urge, curvature, turning, toothed is None)
