"""From loaded contacts to the answer: stresses with the factors of load, and safety and life of every tooth by Miner.

Each meeting of a tooth with a mate is a load cycle with the largest stress on its path: for pitting the largest
pressure on the flank while its pair has the largest load (``rated_for_pitting``), for breakage the largest tension at
the root of that flank.  The damage of a cycle is 1 over the number of cycles for which its stress is endured, and a
tooth breaks or pits when the damages sum to 1 (Miner's rule as in ISO 6336-6: stresses that are endured for ever do no
damage).
"""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import Literal, TypeVar

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, Mask, distinct, equal_rows
from ncgear.pitch.shape import Gear
from ncgear.strength.answer import ContactStresses, GearStrength, LoadBy, Strength, ToothLife
from ncgear.strength.conditions import Conditions, Running, face_load_factor_of_roots
from ncgear.strength.contacts import LoadedContacts
from ncgear.strength.hertz import hertz_pressure_mpa
from ncgear.strength.material import MEAN_STRESS, EnduredStress, Material
from ncgear.strength.sections import InSections


def stresses_of(
    contacts: LoadedContacts,
    methods: tuple[InSections, InSections],
    materials: tuple[Material, Material],
    conditions: Conditions,
    running: Running,
    face_load_factor: Array,
    dynamic_factor: Array,
) -> ContactStresses:
    """The stresses of all contacts, with the factors K_A, K_V and K_Hbeta or K_Fbeta.

    ``methods`` and ``materials`` belong to the driving and the driven gear.  ``contacts`` already share the load
    between pairs of teeth, so that K_Halpha is 1; ``face_load_factor`` is K_Hbeta of each contact, and
    ``dynamic_factor`` K_V, shape (n,).
    """
    shaken = shaken_n_mm(contacts, conditions, running, dynamic_factor)
    roots = face_load_factor_of_roots(running, face_load_factor)
    pressure = np.full_like(shaken, np.nan)
    on = contacts.flanks
    pressure[on] = hertz_pressure_mpa((face_load_factor * shaken)[on], contacts.relative_curvature[on], materials)
    of_unit = [method.root_stress(contacts.on(gear)) for method, gear in zip(methods, Gear, strict=True)]
    return ContactStresses(
        pressure_mpa=pressure,
        tension_mpa=np.array([roots * shaken * stress.tension_mpa for stress in of_unit]),
        compression_mpa=np.array([roots * shaken * stress.compression_mpa for stress in of_unit]),
        face_load_factor=face_load_factor,
        dynamic_factor=dynamic_factor,
    )


def shaken_n_mm(contacts: LoadedContacts, conditions: Conditions, running: Running, dynamic_factor: Array) -> Array:
    """The mean load for each mm of width, shape (n,), with K_A and the K_V of each contact."""
    return contacts.over_width_n * dynamic_factor * (conditions.application_factor / running.face_width_mm)


def strength_of(
    contacts: LoadedContacts,
    stresses: ContactStresses,
    materials: tuple[Material, Material],
    conditions: Conditions,
    cycle_rad: float,
    running: Running,
    method: Literal["estimate", "elements"],
    load: LoadBy,
    elsewhere_mpa: tuple[Array | None, Array | None] = (None, None),
) -> Strength:
    """Safety and life of every tooth of both gears.

    ``elsewhere_mpa`` are the compressions of roots by the loads of each flank in another mesh of the driving and the
    driven gear, shape (2 z,); None for a gear without another mesh.

    ``contacts`` cover a whole cycle of meetings, in which the driving gear turns by ``cycle_rad``: several turns where
    teeth meet other mates in each turn.
    """
    hours = cycle_rad / running.speed_rad_s / 3600.0
    driving, driven = (
        _gear_strength(gear, contacts, stresses, materials[place], conditions.life_h, cycle_rad, each, z, other)
        for place, (gear, z, other, each) in enumerate(
            zip(Gear, running.teeth, elsewhere_mpa, (hours / running.mates, hours), strict=True)
        )
    )
    end_rad = cycle_rad / 2.0 if running.around else cycle_rad
    return Strength(method, load, contacts, stresses, driving, driven, end_rad)


def _gear_strength(
    gear: Gear,
    contacts: LoadedContacts,
    stresses: ContactStresses,
    material: Material,
    life_h: float,
    cycle_rad: float,
    cycle_h: float,
    teeth: int,
    elsewhere_mpa: Array | None,
) -> GearStrength:
    place, flank, pressure = list(Gear).index(gear), contacts.on(gear).flank, stresses.pressure_mpa
    tension = stresses.tension_mpa[place]
    counted = alternating_mpa(tension, stresses.compression_mpa[place], flank, teeth, elsewhere_mpa)
    met = meetings_of(contacts, gear, tension, counted, cycle_rad)
    bending = tooth_life(met, material.bending, teeth, life_h, cycle_h)
    if material.contact is None:
        return GearStrength(gear, material, bending, None)
    rated = rated_for_pitting(contacts)
    rolled = meetings_of(contacts.kept(rated), gear, pressure[rated], pressure[rated], cycle_rad)
    return GearStrength(gear, material, bending, tooth_life(rolled, material.contact, teeth, life_h, cycle_h))


def worse_of(first: Strength, second: Strength, lives: bool = True) -> Strength:
    """The first strength, each tooth with the damage that it suffers by the worse of both loads.

    Without ``lives`` the second load comes a few times only: it ends the life at once, or not at all.
    """
    driving, driven = (
        replace(
            stresses,
            bending=_worse(stresses.bending, other.bending, lives),
            contact=_worse(stresses.contact, other.contact, lives),
        )
        for stresses, other in ((first.of(gear), second.of(gear)) for gear in Gear)
    )
    return replace(first, driving=driving, driven=driven)


_Life = TypeVar("_Life", ToothLife, ToothLife | None)


def _worse(first: _Life, second: _Life, lives: bool) -> _Life:
    if first is None or second is None:
        return first
    worse = second.safety < first.safety
    return ToothLife(
        stress_mpa=np.where(worse, second.stress_mpa, first.stress_mpa),
        phi1_rad=np.where(worse, second.phi1_rad, first.phi1_rad),
        safety=np.minimum(second.safety, first.safety),
        life_h=np.minimum(second.life_h, first.life_h) if lives else np.where(second.safety < 1.0, 0.0, first.life_h),
    )


def rated_for_pitting(contacts: LoadedContacts) -> Mask:
    """Whether the pressure of each contact counts, shape (n,): that of the most loaded flanks of their position.

    ISO 6336-2 compares the pressure at the pitch point, or where a pair begins to bear the load alone, with stresses
    that test gears endured at these places.  Where teeth begin and cease to touch, flanks near their base circles have
    small radii and high pressures over little width, in test gears as well, and are not compared; there another pair
    has a larger load.  Flanks that never have the largest load of their position count wherever they touch.  Each
    section of helical teeth is judged separately.
    """
    sections = int(contacts.section.max(initial=0)) + 1
    place = contacts.position * sections + contacts.section
    most = np.zeros(int(place.max(initial=-1)) + 1)
    np.maximum.at(most, place, contacts.force_n)
    leading = contacts.flanks & (contacts.force_n >= most[place])
    flanks = np.stack([contacts.driving_flank, contacts.driven_flank, contacts.section], axis=1)
    pair = equal_rows(flanks)[1]
    ever_leading = np.bincount(pair, weights=leading) > 0.0
    return np.asarray(leading | (contacts.flanks & ~ever_leading[pair]))


def pressed_mpa(compression: Array, flank: IndexArray, teeth: int) -> Array:
    """The largest compression of the root at each flank, shape (2 z,), by loads on the tooth's other flank."""
    pressed = np.zeros(2 * teeth)
    np.maximum.at(pressed, flank ^ 1, compression)
    return pressed


def alternating_mpa(
    tension: Array, compression: Array, flank: IndexArray, teeth: int, elsewhere: Array | None = None
) -> Array:
    """The pulsating tension with the same damage as each contact's tension and the root's compression.

    The other flank's load presses the root, in this mesh or ``elsewhere`` (shape (2 z,)); where it is never loaded,
    this is the tension itself.  A pulsating stress and a reversing stress of 0.7 of it do the same damage (ISO 6336-3,
    annex); linear in between.
    """
    pressed = pressed_mpa(compression, flank, teeth)
    return tension + MEAN_STRESS * np.maximum(pressed, 0.0 if elsewhere is None else elsewhere)[flank]


@dataclass(frozen=True, eq=False)
class ToothMeetings:
    """m meetings of the teeth of one gear with mates in a whole cycle; shape (m,) each.

    ``flank`` numbers the gear's flanks from 0, two for each tooth.  ``stress_mpa`` is the largest stress of each,
    ``phi1_rad`` the driving angle there, and ``counted_mpa`` the largest stress by which its damage counts.
    """

    flank: IndexArray
    stress_mpa: Array
    phi1_rad: Array
    counted_mpa: Array


def meetings_of(
    contacts: LoadedContacts, gear: Gear, stress_mpa: Array, counted_mpa: Array, cycle_rad: float
) -> ToothMeetings:
    """The meetings of one gear's flanks; stresses have the shape of ``contacts``.

    Two contacts of a pair of flanks belong to the same meeting where less than half a turn of the driving gear is
    between them, over the end of the cycle as well: teeth meet again after a turn or more.
    """
    own = contacts.on(gear).flank
    order = np.lexsort((contacts.phi1_rad, contacts.driven_flank, contacts.driving_flank))
    phi1, driving, driven = contacts.phi1_rad[order], contacts.driving_flank[order], contacts.driven_flank[order]
    new_pair = np.ones(order.size, dtype=bool)
    new_pair[1:] = (driving[1:] != driving[:-1]) | (driven[1:] != driven[:-1])
    begins = new_pair.copy()
    begins[1:] |= np.diff(phi1) > pi
    meeting = np.cumsum(begins) - 1
    first = np.flatnonzero(new_pair)
    last = np.append(first[1:], order.size)[: first.size] - 1
    goes_on = (phi1[first] + cycle_rad - phi1[last] <= pi) & (meeting[first] != meeting[last])
    renamed = np.arange(int(begins.sum()))
    renamed[meeting[last[goes_on]]] = meeting[first[goes_on]]
    meeting = renamed[meeting]
    by_stress = np.lexsort((stress_mpa[order], meeting))
    largest = order[by_stress[np.append(np.diff(meeting[by_stress]) > 0, True)]] if order.size else order
    counted = np.zeros(renamed.size)
    np.maximum.at(counted, meeting, counted_mpa[order])
    return ToothMeetings(own[largest], stress_mpa[largest], contacts.phi1_rad[largest], counted[distinct(meeting)])


HALVINGS = 60
"""Of an interval of life factors: e to the power of 1, or less, falls to rounding errors."""


def tooth_life(meetings: ToothMeetings, endured: EnduredStress, teeth: int, life_h: float, cycle_h: float) -> ToothLife:
    """Safety and life of the z teeth of a gear, on the worse side of each tooth.

    The safety is the largest factor on all stresses at which the damage of the wanted life is at most 1.  Damage grows
    with the factor, from 0 where all stresses are endured for ever to infinity where a stress is above the static
    stress; bisection finds the factor between.
    """
    flank, counted = meetings.flank, meetings.counted_mpa
    top = np.zeros(2 * teeth)
    np.maximum.at(top, flank, counted)

    def damage(factor: Array) -> Array:
        """Damage of one cycle of meetings, for each flank with its own factor on the stresses."""
        each = 1.0 / endured.cycles_to_failure(counted * factor[flank])
        return np.asarray(np.bincount(flank, weights=each, minlength=2 * teeth), dtype=float)

    loaded = top > 0.0
    # The static stress itself is endured for some cycles, and rounding must not lift a stress above it.
    safe = np.where(loaded, endured.stress_mpa[-1] / np.where(loaded, top, 1.0), 1.0)
    broken = np.where(loaded, endured.stress_mpa[0] / np.where(loaded, top, 1.0), 1.0) * (1.0 + 1e-12)
    with np.errstate(divide="ignore", over="ignore"):
        for _ in range(HALVINGS):
            middle = np.sqrt(safe * broken)
            holds = damage(middle) * (life_h / cycle_h) <= 1.0
            safe, broken = np.where(holds, middle, safe), np.where(holds, broken, middle)
        hours = cycle_h / damage(np.ones(2 * teeth))
    stress, phi1 = np.zeros(2 * teeth), np.zeros(2 * teeth)
    rising = np.argsort(meetings.stress_mpa, kind="stable")
    stress[flank[rising]] = meetings.stress_mpa[rising]
    phi1[flank[rising]] = meetings.phi1_rad[rising]
    sides, every = stress.reshape(teeth, 2), np.arange(teeth)
    higher = sides.argmax(axis=1)
    return ToothLife(
        stress_mpa=sides[every, higher],
        phi1_rad=phi1.reshape(teeth, 2)[every, higher],
        safety=np.where(loaded, safe, np.inf).reshape(teeth, 2).min(axis=1),
        life_h=hours.reshape(teeth, 2).min(axis=1),
    )
