"""A rough strength without teeth: one pair bears the whole load at the pitch point, on local replacement gears.

At every driving angle the pitch curves' curvatures k1 and k2 make two circular gears.  Flanks that touch at the pitch
point have the curvatures k / sin(alpha), so that Hertz's pressure is exact there.  Roots have Y_F and Y_S of ISO 6336-3
for 2 / (k m) teeth without shift, loaded at the outer point of single contact of a contact ratio of 1.5.  What is left
out: sharing of the load between pairs, places of contact away from the pitch point (beside a cusp the pressure is many
times larger), shifts, shortened tips, and what differs from tooth to tooth.  It is there to warn in milliseconds.
"""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.strength.conditions import Conditions, Running, dynamic_factor, face_load_factor_of_roots
from ncgear.strength.hertz import hertz_pressure_mpa
from ncgear.strength.holding import Damage
from ncgear.strength.iso6336 import RackTip, root_factors, root_section, single_contact_diameter
from ncgear.strength.material import Material

CONTACT_RATIO = 1.5
"""What pairs of such gears mostly have; the outer point of single contact follows from it."""

FEWEST, MOST = 12.0, 1000.0
"""Teeth of replacement gears: of fewer, other formulas hold, and more are a rack, as hollow pitch curves are taken."""


@dataclass(frozen=True, eq=False)
class PitchPointLoad:
    """The load of a pair at n driving angles: normal force in N, and curvature of both pitch curves in 1/mm.

    ``phi1_rad`` and ``force_n`` have shape (n,), ``curvature`` (shape (2, n)) is that of the driving and the driven
    gear, positive where the material is convex.
    """

    phi1_rad: Array
    force_n: Array
    curvature: Array


@dataclass(frozen=True)
class RoughSafety:
    """The least safety of a gear against a kind of damage, roughly, and where it is."""

    gear: Gear
    damage: Damage
    safety: float
    wanted: float
    stress_mpa: float
    phi1_rad: float


def rough_safeties(
    load: PitchPointLoad,
    rack: RackTip,
    addendum: float,
    pressure_angle_rad: float,
    running: Running,
    materials: tuple[Material, Material],
    conditions: Conditions,
) -> list[RoughSafety]:
    """Both gears' safeties against breakage and, where the material has figures, against pitting.

    ``rack`` and ``addendum`` are in modules.  Raises Unanswered for racks that the formulas do not cover.
    """
    line_load = conditions.application_factor * load.force_n / running.face_width_mm
    shaken = line_load * (conditions.dynamic_factor or dynamic_factor(running, float(line_load.mean())))
    flanks, roots = conditions.face_load_factor, face_load_factor_of_roots(running, conditions.face_load_factor)
    relative = np.maximum(load.curvature.sum(axis=0), 0.0) / sin(pressure_angle_rad)
    pressure = hertz_pressure_mpa(flanks * shaken, relative, materials)
    found = []
    for place, gear in enumerate(Gear):
        material = materials[place]
        turns = conditions.life_h * 3600.0 * running.speed_rad_s / (2.0 * pi) * running.teeth[0] / running.teeth[place]
        cycles = np.array(max(turns, 1.0))
        teeth = np.clip(2.0 / (np.maximum(load.curvature[place], 1e-12) * running.module_mm), FEWEST, MOST)
        tip = single_contact_diameter(teeth, teeth + 2.0 * addendum, CONTACT_RATIO, pressure_angle_rad)
        section = root_section(teeth, 0.0, rack, pressure_angle_rad)
        factors = root_factors(section, teeth, 0.0, tip, pressure_angle_rad)
        nominal = shaken * cos(pressure_angle_rad) / running.module_mm
        stress = {Damage.BENDING: (roots * nominal * factors.form * factors.notch, material.bending)}
        if material.contact is not None:
            stress[Damage.CONTACT] = (pressure, material.contact)
        for damage, (values, endured) in stress.items():
            row, wanted = int(np.argmax(values)), conditions.wanted_contact_safety(material)
            if damage is Damage.BENDING:
                wanted = conditions.wanted_bending_safety(material)
            largest = float(values[row])
            safety = float(endured.at(cycles)) / max(largest, 1e-12)
            found.append(RoughSafety(gear, damage, safety, wanted, largest, float(load.phi1_rad[row])))
    return found
