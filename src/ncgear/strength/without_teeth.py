"""Strength without teeth: places where teeth would touch while the pitch curves roll, and their loads there.

A rack's flank that crosses the pitch line at c touches at s = (sigma - c) cos(alpha) along the line of action when the
curves have rolled to sigma, and the flank that it leaves has sin(alpha) / k + s as its radius of curvature there, k
being the pitch curve's (``ncgear.teeth.flank``).  So the places of all pairs are known without a tooth; they end where
the tips of circular gears of these curvatures are.  Pairs share the load as springs: each as stiff as c' of ISO 6336-1
in its middle, softer towards its ends as the cosine of J. I. Pedrero, M. Pleguezuelos, M. Artes, J. A. Antona
(Mech. Mach. Theory 45, 2010), and beyond its ends by the gap there, since teeth that bend touch early.  Roots have
Y_F and Y_S of ISO 6336-3 for 2 / (k m) teeth, k being the mean over the tooth, loaded where they touch.

Helical teeth are divided into sections of the face width (``ncgear.strength.sections``), which cross the pitch line one
after the other and share the load.  Roots are those of the virtual spur gear of ISO 6336-3, the stiffness is that of
its teeth times the cosine of the helix angle, and lines of contact lean by the base helix angle.

It leaves out shortened tips, undercut flanks, fillets of other tools than a rack, and differences between both sides of
a tooth.  It takes milliseconds, and was compared with the strength of real teeth (docs/method.md).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import atan, ceil, cos, pi, sin, tan

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.pitch.shape import Gear
from ncgear.strength.conditions import Conditions, Running, face_load_factor_of_roots
from ncgear.strength.hertz import hertz_pressure_mpa
from ncgear.strength.holding import Damage
from ncgear.strength.iso6336 import RackTip, root_factors, root_section, single_stiffness_theoretical
from ncgear.strength.material import COMPRESSION_OVER_TENSION, MEAN_STRESS, Material
from ncgear.teeth.form import TipRelief

PER_TOOTH = 32
"""Positions in a tooth pitch, a multiple of four: flanks cross the pitch curve a quarter of it beside their teeth.
With four times as many, safeties mostly change by 1 %, and by at most 5 % where one tooth bears all for a moment."""

PITCHES = np.arange(-3, 5)
"""Crossings beside a position, in pitches: teeth as high as three modules touch over four pitches."""

PER_PITCH, FEWEST_SECTIONS = 6, 3
"""Sections for each pitch that helical teeth advance, and of teeth that hardly advance."""

FEWEST, MOST = 12.0, 1000.0
"""Teeth of replacement gears: of fewer, other formulas hold, and more are a rack, as hollow pitch curves are taken."""

STEEL_MPA = 206_000.0
"""Young's modulus for which ISO 6336-1 gives c'."""

LEAST_SINE = 0.02
"""Least rho k of a flank (usually sin(alpha) = 0.34): a flank is not followed closer to its base circle."""

MOST_LEAP = 0.12
"""Largest change of a pitch curve's curvature within a pitch, in 1/modules, for which one curvature stands for a tooth:
up to 0.11 safeties were 0.86 to 1.1 of the safeties with teeth, from 0.19 on 0.8 to 1.9."""

MOST_WAY = 0.12
"""Largest way in modules by which loaded teeth may yield: beyond it the second order places edges wrongly."""

PUSHING_AND_BACK = 1.0, -1.0
"""``RolledLoad.urge`` of the pushing flanks and of their backs."""

LOADED = 0.02
"""Share of the largest force under which a position is left out."""

ROUNDED = 1e-12
"""Step that counts as rounding, as a share of the way by which teeth yield."""

SOFTEST_RAD = 1.3
"""Angle at which the cosine of the stiffness ends, at about a quarter; usual pairs end at 1.2 or less."""


@dataclass(frozen=True, eq=False)
class RolledLoad:
    """The load of a pair at n positions that are PER_TOOTH to a pitch, from a tooth on the pitch point on; shape (n,).

    ``force_n`` is the normal force of all pairs together and ``urge`` +1 where pushing flanks bear it, -1 where their
    backs do.  ``curvature`` (shape (2, n)) belongs to the driving and the driven pitch curve in 1/mm, positive where
    the material is convex; ``turning_rad_s`` is the speed of the gears against each other.  ``closed`` tells that the
    last position leads to the first.
    """

    phi1_rad: Array
    force_n: Array
    urge: Array
    curvature: Array
    turning_rad_s: Array
    closed: bool

    def leap(self, module_mm: float) -> float:
        """Largest change of a curvature within a pitch about a loaded position, in 1/modules."""
        rows = np.flatnonzero(self.force_n > LOADED * self.force_n.max())
        around = self.curvature[:, self.place(rows + np.arange(-PER_TOOTH, PER_TOOTH + 1)[:, None])]
        return float(np.ptp(around, axis=1).max()) * module_mm

    def place(self, position: IndexArray) -> IndexArray:
        """Numbers of positions beyond the ends: round the cycle, or held at the ends of a range."""
        count = self.phi1_rad.size
        return position % count if self.closed else np.clip(position, 0, count - 1)


AtAngles = Callable[[Array], Array]
"""A value at driving angles in rad, shape (n,)."""


@dataclass(frozen=True)
class ToothPlan:
    """The plan of the teeth: rack and both gears' shifts in modules, angles of both sides, relief in mm.

    ``rims`` are Y_B of both gears by driving angles in rad, shape (n,).  ``advance_mm`` is the advance of helical teeth
    along the pitch line over the face width (of herringbone teeth: over half of it).  ``thinner`` is what play takes
    off the teeth of both gears, in modules.
    """

    rack: RackTip
    addendum: float
    shifts: tuple[float, float]
    angles_rad: tuple[float, float]
    relief: TipRelief | None
    rims: tuple[AtAngles, AtAngles] = (np.ones_like, np.ones_like)
    helix_rad: float = 0.0
    advance_mm: float = 0.0
    thinner: tuple[float, float] = (0.0, 0.0)

    def sections(self, pitch_mm: float) -> int:
        """Number of sections of the face width."""
        return max(ceil(PER_PITCH * self.advance_mm / pitch_mm), FEWEST_SECTIONS) if self.helix_rad else 1

    def lean(self, angle_rad: float) -> float:
        """Cosine of the base helix angle, by the pressure angle of a side."""
        return cos(atan(tan(self.helix_rad) * cos(angle_rad)))

    def virtual(self, teeth: Array, angle_rad: float) -> Array:
        """Teeth of the virtual spur gears of (replacement) gears."""
        return np.asarray(teeth / (self.lean(angle_rad) ** 2 * cos(self.helix_rad)))


@dataclass(frozen=True, eq=False)
class SharedLoad:
    """The load of each of p pairs on one side of the teeth at each of n positions.

    With ``sections``, the pairs of one section follow those of the section before.
    ``load`` holds those n positions, and ``angle_rad`` is the rack's angle on that side.  ``line_n_mm`` (p, n) is the
    normal force for each mm of width and ``way_mm`` (n,) the way by which the teeth yield along it; ``place_mm`` (p, n)
    is the place of contact along the line of action, from the pitch point towards the driving gear's tip;
    ``relative_curvature`` (p, n) is that of both flanks, and ``root_teeth`` (2, p, n) are the numbers of teeth of the
    circular gears with such roots.  ``tooth`` (p, n) counts the driving teeth in pitches from the first position on.
    """

    load: RolledLoad
    angle_rad: float
    line_n_mm: Array
    way_mm: Array
    place_mm: Array
    relative_curvature: Array
    root_teeth: Array
    tooth: IndexArray
    sections: int = 1

    def tooth_of(self, gear: Gear, teeth: int) -> IndexArray:
        """The number of the tooth of a gear with so many teeth that bears each load, shape (p, n)."""
        before = int(gear is Gear.DRIVEN and self.load.urge[0] > 0.0)
        return np.asarray((self.tooth - before) % teeth)

    @property
    def stiffness_n_mm2(self) -> Array:
        """The load of all pairs over their way of yielding, for each mm of width, shape (n,)."""
        return np.asarray(self.line_n_mm.sum(axis=0) / self.sections / self.way_mm)

    @property
    def bearing(self) -> Array:
        """Number of loaded pairs, as a mean over the sections, shape (n,)."""
        return np.asarray(np.sum(self.line_n_mm > 0.0, axis=0) / self.sections)


def shared_loads(
    load: RolledLoad, plan: ToothPlan, running: Running, materials: tuple[Material, Material]
) -> list[SharedLoad]:
    """The loads of pairs, on each loaded side of the teeth."""
    return [
        _shared(load, rows, (angle, urge), plan, running, materials)
        for angle, urge in zip(plan.angles_rad, PUSHING_AND_BACK, strict=True)
        if (rows := np.flatnonzero((load.urge == urge) & (load.force_n > 0.0))).size
    ]


def _shared(
    load: RolledLoad,
    rows: IndexArray,
    side: tuple[float, float],
    plan: ToothPlan,
    running: Running,
    materials: tuple[Material, Material],
) -> SharedLoad:
    (angle, urge), module = side, running.module_mm
    base_pitch, sine, cosine = pi * module * cos(angle), sin(angle), cos(angle)
    quarter = int(urge) * PER_TOOTH // 4
    sections = plan.sections(pi * module)
    ahead = plan.advance_mm / (pi * module) * PER_TOOTH * (np.arange(sections)[:, None, None] + 0.5) / sections
    if sections == 1:
        ahead = np.zeros((1, 1, 1), dtype=int)
    tooth = ((rows + quarter - ahead) // PER_TOOTH + PITCHES[:, None]).astype(int)
    crossing = (PER_TOOTH * tooth - quarter + ahead).reshape(-1, rows.size)
    tooth = tooth.reshape(-1, rows.size)
    rolled = urge * (rows - crossing) / PER_TOOTH * base_pitch
    k = load.curvature[:, rows]
    reach = np.stack([_reach_mm(k[i], k[1 - i], module * (plan.addendum + plan.shifts[i]), sine) for i in (0, 1)])
    place = np.clip(rolled, -reach[1], reach[0])
    turned = np.maximum(np.stack([sine + k[0] * place, sine - k[1] * place]), LEAST_SINE)
    relative = np.maximum(k[0] / turned[0] + k[1] / turned[1], 0.0)
    # An edge touches early or late: by how it leaves the mate's flank, to the second order.
    edge = np.where(rolled > place, turned[0], turned[1]) / cosine
    gap = (edge * (rolled - place)) ** 2 / 2.0 * relative + _relieved_mm(np.abs(place) * sine, plan.relief)
    middle, ratio = (reach[0] - reach[1]) / 2.0, reach.sum(axis=0) / base_pitch
    softening = 1.0 / np.sqrt(np.maximum((1.0 + ratio / 2.0) ** 2 / 2.0 - 1.0, 0.1))
    softer = np.cos(np.minimum(softening * np.abs(place - middle) / base_pitch, SOFTEST_RAD))
    first, second = (material.youngs_modulus_mpa for material in materials)
    virtual = plan.virtual(np.sort(_teeth(k, module), axis=0), angle)
    stiffest = 1e3 * single_stiffness_theoretical(virtual, (0.0, 0.0)) * cos(plan.helix_rad)
    stiffness = stiffest * 2.0 * first * second / (first + second) / STEEL_MPA * softer
    centres = np.rint(np.stack([crossing + quarter, crossing - quarter])).astype(int)
    around = np.mean([load.curvature[:, load.place(np.arange(load.phi1_rad.size) + i)] for i in _ROOT], axis=0)
    roots = np.stack([around[i][load.place(centres[i])] for i in (0, 1)])
    way, line = _borne(load.force_n[rows] / running.face_width_mm, stiffness / sections, gap)
    own = RolledLoad(load.phi1_rad[rows], load.force_n[rows], load.urge[rows], k, load.turning_rad_s[rows], load.closed)
    across = relative * plan.lean(angle)
    return SharedLoad(own, angle, sections * line, way, place, across, _teeth(roots, module), tooth, sections)


_ROOT = np.arange(-PER_TOOTH // 4, PER_TOOTH // 4 + 1)
"""Positions about a tooth's middle over which the curvature of its root is the mean: between its own crossings."""


def _teeth(curvature: Array, module_mm: float) -> Array:
    return np.clip(2.0 / (np.maximum(curvature, 1e-12) * module_mm), FEWEST, MOST)


def _reach_mm(own: Array, mate: Array, height_mm: float, sine: float) -> Array:
    """Distance from the pitch point to the contact of a circular gear's tip, at most to the mate's involute.

    (1/k + s sin(alpha))^2 + (s cos(alpha))^2 = (1/k + h)^2, solved for s without dividing by the curvature k.
    """
    raised = height_mm * (2.0 + own * height_mm)
    reach = raised / (sine + np.sqrt(np.maximum(sine**2 + own * raised, 0.0)))
    return np.asarray(np.where(mate * reach > sine, sine / np.where(mate > 0.0, mate, 1.0), reach))


def _relieved_mm(height_mm: Array, relief: TipRelief | None) -> Array:
    """The depth of tip relief along the normal at heights over the rack's pitch line of the relieved tooth."""
    if relief is None:
        return np.zeros_like(height_mm)
    over = np.maximum(height_mm - relief.start_mm, 0.0) / (relief.full_mm - relief.start_mm)
    return np.asarray(relief.amount_mm * over**2)


def _borne(line_n_mm: Array, stiffness: Array, gap_mm: Array) -> tuple[Array, Array]:
    """The way x by which p pairs yield under loads w, shape (n,), and their shares, (p, n): sum(c max(0, x - gap)) = w.

    The sum is convex in x, so that Newton's method descends to the zero from where one pair alone would bear the load.
    """
    at = np.min(gap_mm + line_n_mm / stiffness, axis=0)
    for _ in gap_mm:
        borne = np.sum(stiffness * np.maximum(at - gap_mm, 0.0), axis=0)
        step = (borne - line_n_mm) / np.sum(stiffness * (gap_mm <= at), axis=0)
        at = at - step
        if np.all(np.abs(step) <= ROUNDED * at):
            break
    return at, np.asarray(stiffness * np.maximum(at - gap_mm, 0.0))


def slid_w(sides: list[SharedLoad], positions: int, face_width_mm: float, coefficient: float) -> float:
    """The mean power in W that friction takes over a cycle of ``positions``; sliding follows from the turning."""
    rubbed = sum(
        float(np.sum(side.line_n_mm * np.abs(side.place_mm) * side.load.turning_rad_s)) / side.sections
        for side in sides
    )
    return coefficient * face_width_mm * rubbed / positions / 1000.0


@dataclass(frozen=True)
class RoughSafety:
    """The rough least safety of a gear against a kind of damage, and its place."""

    gear: Gear
    damage: Damage
    safety: float
    wanted: float
    stress_mpa: float
    phi1_rad: float


def rough_safeties(
    sides: list[SharedLoad],
    plan: ToothPlan,
    running: Running,
    materials: tuple[Material, Material],
    conditions: Conditions,
    uneven: list[Array],
    shaken: list[Array],
) -> list[RoughSafety]:
    """Both gears' safeties against breakage and, where the material has figures, against pitting, for the life wanted.

    ``uneven`` is K_Hbeta and ``shaken`` K_V at the positions of each side, shape (n,) each.

    Raises Unanswered for racks that the formulas do not cover.
    """
    found = []
    for gear, material in zip(Gear, materials, strict=True):
        met = running.meetings(conditions.life_h)[list(Gear).index(gear)]
        cycles, wanted = np.array(max(met, 1.0)), conditions.wanted_bending_safety(material)
        over = [
            v * _factors_of_roots(running, conditions, face_load) for face_load, v in zip(uneven, shaken, strict=True)
        ]
        root = [k * _root_stress(side, gear, plan, running) for side, k in zip(sides, over, strict=True)]
        counted = _alternating(sides, root, gear, running.teeth[list(Gear).index(gear)])
        found.append(_least(gear, Damage.BENDING, sides, counted, float(material.bending.at(cycles)), wanted))
        if material.contact is not None:
            wanted = conditions.wanted_contact_safety(material)
            over = [
                (v * conditions.application_factor * face_load) ** 0.5
                for face_load, v in zip(uneven, shaken, strict=True)
            ]
            pressed = [k * _pressure(side, materials) for side, k in zip(sides, over, strict=True)]
            found.append(_least(gear, Damage.CONTACT, sides, pressed, float(material.contact.at(cycles)), wanted))
    return found


def static_safeties(
    sides: list[SharedLoad],
    plan: ToothPlan,
    running: Running,
    materials: tuple[Material, Material],
    conditions: Conditions,
    uneven: list[Array],
) -> list[RoughSafety]:
    """Both gears' safeties against breaking at once: root stress over the static strength, without an estimated K_V.

    Vibration only adds to that stress, and fewer cycles are endured no better: less is safe in truth, never more.
    """
    given = conditions.dynamic_factor or 1.0
    over = [_factors_of_roots(running, conditions, face_load) for face_load in uneven]
    return [
        _least(
            gear,
            Damage.BENDING,
            sides,
            [given * k * _root_stress(side, gear, plan, running).max(0) for side, k in zip(sides, over, strict=True)],
            float(material.bending.stress_mpa[0]),
            conditions.wanted_bending_safety(material),
        )
        for gear, material in zip(Gear, materials, strict=True)
    ]


def _factors_of_roots(running: Running, conditions: Conditions, uneven: Array) -> Array:
    """K_A and K_Fbeta at positions, by K_Hbeta there."""
    return np.asarray(conditions.application_factor * face_load_factor_of_roots(running, uneven))


def _root_stress(side: SharedLoad, gear: Gear, plan: ToothPlan, running: Running) -> Array:
    """The root stress of a gear by each pair at each position, shape (p, n), without factors of load.

    A load below the pitch point counts as at the pitch point, where it bends a tooth more.
    """
    place, angle = list(Gear).index(gear), side.angle_rad
    teeth, slender = side.root_teeth[place], cos(plan.helix_rad)
    outwards = np.maximum(side.place_mm * (1.0 - 2.0 * place), 0.0) / running.module_mm
    over = 2.0 * np.hypot(teeth * sin(angle) / 2.0 + outwards, teeth * cos(angle) / 2.0) - teeth
    # In the section across the tooth, in its own modules; heights are the same there.
    teeth, across, shift = plan.virtual(teeth, angle), atan(tan(angle) * slender), plan.shifts[place] / slender
    rack = replace(plan.rack, dedendum=plan.rack.dedendum / slender)
    section = root_section(teeth, shift, rack, across)
    section = replace(section, chord=section.chord - plan.thinner[place] / slender)
    factors = root_factors(section, teeth, shift, teeth + over / slender, across)
    nominal = plan.rims[place](side.load.phi1_rad) * side.line_n_mm * cos(angle) / (running.module_mm * slender)
    return np.asarray(nominal * factors.form * factors.notch)


def _alternating(sides: list[SharedLoad], root: list[Array], gear: Gear, teeth: int) -> list[Array]:
    """The largest root stress at each position of each side, shape (n,), as it counts where loads reverse.

    ``root`` are the stresses by each pair.  Loads of a tooth's other flank press the root (``BOTH_WAYS``).
    """
    pressed = {urge: np.zeros(teeth) for urge in PUSHING_AND_BACK}
    for side, stress in zip(sides, root, strict=True):
        np.maximum.at(pressed[-side.load.urge[0]], side.tooth_of(gear, teeth), COMPRESSION_OVER_TENSION * stress)
    more = [MEAN_STRESS * pressed[side.load.urge[0]][side.tooth_of(gear, teeth)] for side in sides]
    return [np.where(own > 0.0, own + other, 0.0).max(axis=0) for own, other in zip(root, more, strict=True)]


def _pressure(side: SharedLoad, materials: tuple[Material, Material]) -> Array:
    """The largest Hertz's pressure at each position of the most loaded pairs of the sections, shape (n,).

    It is without factors of load.
    """
    line, curvature = (x.reshape(side.sections, -1, x.shape[-1]) for x in (side.line_n_mm, side.relative_curvature))
    most = line.argmax(axis=1)[:, None]
    line, curvature = (np.take_along_axis(x, most, axis=1)[:, 0] for x in (line, curvature))
    return np.asarray(hertz_pressure_mpa(line, curvature, materials).max(axis=0))


def _least(
    gear: Gear, damage: Damage, sides: list[SharedLoad], stress: list[Array], endured_mpa: float, wanted: float
) -> RoughSafety:
    values, angles = np.concatenate(stress), np.concatenate([side.load.phi1_rad for side in sides])
    row = int(np.argmax(values))
    largest = max(float(values[row]), 1e-12)
    return RoughSafety(gear, damage, endured_mpa / largest, wanted, largest, float(angles[row]))
