"""Uneven load along the width of a design's teeth: from keys and loads to ``ncgear.strength.face_load``.

Where the file gives the bearings and diameters of both shafts, K_Hbeta is computed at every position; else it is the
given factor or ASSUMED. A bearing has the stiffness of its key, or of its static rating at its largest force of the
cycle; where neither is given it is rigid.  Where teeth carry more than the law needs, as in knocks, the crank presses
with the force that the surplus accelerates (``ncgear.dynamics.knocking``).  The application factor counts for all
forces, K_V for the forces of the teeth.  Of pairs in series, the other gear on a shaft presses with the law's force.

Flanks are misaligned by the helix slope that the grade allows for each gear (ISO 1328-1) and by the tilt of its bore,
all independent: they add as the root of the sum of squares, as in ISO 6336-1 (secondary source).  Where the section
``tolerances`` is left out, both gears have the grade for which K_V is estimated.  Running in reduces it by the mean of
the reductions of both materials.  Not counted: play in the bearings, and shafts that are not parallel.
"""

from __future__ import annotations

from dataclasses import replace
from math import hypot, isinf, radians, tan
from typing import TYPE_CHECKING, Literal

import numpy as np

from ncgear.design.keys import drivetrain as keys
from ncgear.drivetrain.bearings import Bearing, Seats, bearing_forces, stiffness_n_mm
from ncgear.drivetrain.cycle import ShaftLoads, complex_of, shafts_of
from ncgear.dynamics.knocking import hurried_loads
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import sample_angles
from ncgear.numerics.arrays import Array, ComplexArray, largest_rows
from ncgear.pitch.shape import Gear
from ncgear.project.service import choices_of
from ncgear.project.tooth_load import ToothLoad, asked_of
from ncgear.strength.conditions import GRADE, Running
from ncgear.strength.contacts import LoadedContacts
from ncgear.strength.endurance import running_in
from ncgear.strength.face_load import ASSUMED, FaceLoads, FaceModel, LeadForm, SteelShaft, Support, best_fall_mm
from ncgear.strength.without_teeth import SharedLoad
from ncgear.tolerances.iso1328 import helix_slope_mm

if TYPE_CHECKING:
    from ncgear.design.keys.design import Design
    from ncgear.project.geared import Geared
    from ncgear.strength.answer import Strength

MM_PER_UM = 1e-3
N_PER_MM_PER_UM = 1000.0


@dataclass(frozen=True, eq=False)
class FaceLoading:
    """The source of K_Hbeta of a pair.

    ``basis`` names it: given, assumed (``why`` says which value is missing), or computed by ``model`` from the loads
    ``asked`` and those of the whole ``machine`` with its gears.  ``constant`` is the given or assumed factor, and
    ``shafts`` are both shafts in words.  Loads count with an application factor.
    """

    basis: Literal["given", "assumed", "computed"]
    constant: float = ASSUMED
    why: str = ""
    model: FaceModel | None = None
    asked: ToothLoad | None = None
    machine: RigidMachine | None = None
    shafts: tuple[str, str] = ("driving shaft", "driven shaft")

    @property
    def rigid_bearings(self) -> list[str]:
        """The bearings that count as rigid, since neither their stiffness nor their static rating is given."""
        if self.model is None:
            return []
        return [
            f"{name} of the {words}"
            for words, shaft in zip(self.shafts, self.model.shafts, strict=True)
            for name, support in zip(("bearing_a", "bearing_b"), shaft.supports, strict=True)
            if isinf(support.stiffness_n_mm)
        ]

    def of_contacts(self, contacts: LoadedContacts, application_factor: float, shaken: Array) -> Array:
        """K_Hbeta of contacts with K_V ``shaken``, shape (n,) each; raises as ``FaceModel.factors`` does."""
        if self.model is None:
            return np.full(contacts.force_n.shape, self.constant)
        return self.model.factors(self.loads_of(contacts, application_factor, shaken))[contacts.position]

    def loads_of(self, contacts: LoadedContacts, application_factor: float, shaken: Array) -> FaceLoads:
        """Forces that press flanks together at every position of loaded contacts with K_V ``shaken``, shape (n,)."""
        each = contacts.force_n, contacts.stiffness_n_mm
        force, stiffness = (np.bincount(contacts.position, values).astype(float) for values in each)
        phi1, urge, factor = np.zeros(force.size), np.ones(force.size), np.ones(force.size)
        phi1[contacts.position], urge[contacts.position] = contacts.phi1_rad, 1.0 - 2.0 * contacts.side
        factor[contacts.position] = shaken
        assert self.model is not None
        return self.pressing(phi1, urge, force, stiffness / self.model.width_mm, application_factor, factor)

    def of_side(self, load: SharedLoad, application_factor: float, shaken: Array) -> Array:
        """K_Hbeta for a load that is known without teeth, with K_V ``shaken``, shape (n,) each."""
        if self.model is None:
            return np.full(load.load.force_n.shape, self.constant)
        at = load.load.phi1_rad, load.load.urge, load.load.force_n
        return self.model.factors(self.pressing(*at, load.stiffness_n_mm2, application_factor, shaken))

    def pressing(
        self,
        phi1_rad: Array,
        urge: Array,
        force_n: Array,
        stiffness_n_mm2: Array,
        application_factor: float,
        shaken: Array,
    ) -> FaceLoads:
        """The forces that press the flanks together at driving angles, shape (n,).

        ``urge`` is +1 where pushing flanks carry, -1 where backs carry.  ``force_n`` is the normal force of all pairs
        without factors, ``stiffness_n_mm2`` their stiffness.  K_V, ``shaken``, applies to the teeth only: the crank
        does not feel it.
        """
        assert self.asked is not None
        asked, mesh = self.asked, self.asked.mesh_force(phi1_rad, urge)
        towards = complex_of(mesh.force) / mesh.size_n.value
        arms = asked.arms_mm(phi1_rad, urge)
        torque = urge * force_n * arms[:, 1]
        forces = np.stack(self._beside_n(phi1_rad, torque), axis=-1)
        beside = np.real(forces * np.conj(towards)[:, None]) * np.array([-1.0, 1.0])
        driving, driven = asked.place.couples_mm(asked.slope(phi1_rad))
        along = np.stack([-driving, driven], axis=-1) * np.conj(towards)[:, None]
        couples = np.real(along) * (mesh.thrust_n.value / mesh.size_n.value)[:, None]
        over = application_factor * shaken
        return FaceLoads(over * force_n, stiffness_n_mm2, application_factor * beside, arms, couples)

    def _beside_n(self, angle_rad: Array, torque_n_mm: Array) -> tuple[ComplexArray, ComplexArray]:
        """The forces as x + i y of a second gear or the crank on both shafts, where teeth bear a torque, shape (n,)."""
        asked, machine = self.asked, self.machine
        assert asked is not None
        before = after = np.zeros(angle_rad.shape, dtype=complex)
        if machine is not None and len(machine.places) > 1:
            meshes = machine.at(asked.pair.shaft_rad(angle_rad)).meshes
            before = complex_of(meshes[asked.number - 1].force) if asked.number else before
            after = -complex_of(meshes[asked.number + 1].force) if asked.number + 1 < len(meshes) else after
        if asked.turns_crank:
            after = _crank_n(asked, asked.pair.shaft_rad(angle_rad), torque_n_mm - asked.torque_n_mm(angle_rad))
        return before, after


def _crank_n(asked: ToothLoad, phi1_rad: Array, beyond_n_mm: Array) -> ComplexArray:
    """The force of the crank on its shaft in N as x + i y; the force between the teeth is not part of it.

    Teeth carry ``beyond_n_mm`` (shape (n,)) more than the law asks of the driven gear.
    """
    return -complex_of(hurried_loads(asked.machine, phi1_rad, beyond_n_mm).crank_bearing)


def face_loading_of(drive: Geared) -> FaceLoading:
    """The source of K_Hbeta for a drive's pair."""
    design = drive.design
    if (own := design.strength.face_load_factor) is not None:
        return FaceLoading("given", own)
    if design.drivetrain is None:
        return FaceLoading("assumed", why="drivetrain is not given")
    number, gears = (drive.stage or 1) - 1, drive.gears
    driving, driven = _Around.of(design, number, Gear.DRIVING), _Around.of(design, number + 1, Gear.DRIVEN)
    if isinstance(driving, str) or isinstance(driven, str):
        return FaceLoading("assumed", why=driving if isinstance(driving, str) else str(driven))
    *before, last = drive.whole.mesh_places
    machine = replace(drive.loaded_machine(drive.machine), place=last, places_before=tuple(before))
    asked = replace(asked_of(drive), place=machine.places[number])
    phi1 = sample_angles(machine.machine.transmission)
    idle, meshes = np.zeros(phi1.size), machine.at(phi1).meshes
    crank = _crank_n(asked, phi1, idle)
    # The arm of the force is about the radius of the roots.
    angle = sample_angles(asked.pair.transmission)
    arms = asked.arms_mm(angle, np.ones(angle.size)).min(axis=0)
    first, second = (material.youngs_modulus_mpa for material in drive.materials)
    loads = shafts_of(machine.places, meshes, machine.angles(phi1, 1), [(idle, idle)] * len(meshes), crank)
    shafts = driving.shaft((arms[0], first), loads[number]), driven.shaft((arms[1], second), loads[number + 1])
    askew, running = _askew_mm(design, drive.running), drive.running
    worn = sum(running_in(choice, running, askew) for choice in choices_of(gears)) / 2.0
    lead = gears.lead
    form = LeadForm(
        MM_PER_UM * lead.crowning_um, MM_PER_UM * (lead.end_relief_um or 0.0), lead.end_relief_length_mm or 0.0
    )
    places = driving.beside_mm if number else None, driven.beside_mm
    model = FaceModel(shafts, places, gears.face_width_mm, askew - worn, form)
    words = design.shafts[number].words, design.shafts[number + 1].words
    return FaceLoading("computed", model=model, asked=asked, machine=machine, shafts=words)


def seats_of(shaft: keys.DrivingShaft | None) -> Seats | None:
    """The places along a shaft from its keys; None where its bearings are not given."""
    if shaft is None or shaft.bearing_a is None or shaft.bearing_b is None:
        return None
    both = _bearing(shaft.bearing_a, shaft.thrust_on == "a"), _bearing(shaft.bearing_b, shaft.thrust_on == "b")
    if isinstance(shaft, keys.ShaftBetween):
        return Seats(both, (0.0, shaft.second_gear_at_mm))
    return Seats(both, crank_at_mm=shaft.crank_at_mm if isinstance(shaft, keys.DrivenShaft) else 0.0)


def diameter_of(design: Design, number: int) -> float | None:
    """The diameter of a shaft, counted from the driving shaft on: as given, or the least bore of its gears."""
    given = design.shafts[number].given
    if given is not None and given.diameter_mm is not None:
        return given.diameter_mm
    bores = [getattr(design.gears, gear).bore_mm for gear in design.gears_on(number)]
    return None if None in bores else min(bores)


def _bearing(given: keys.Bearing, bears_thrust: bool) -> Bearing:
    stiffness = None if given.stiffness_n_per_um is None else N_PER_MM_PER_UM * given.stiffness_n_per_um
    ratings = given.dynamic_rating_n, given.static_rating_n
    return Bearing(given.at_mm, given.kind, *ratings, stiffness, given.contact_angle_deg, bears_thrust)


@dataclass(frozen=True)
class _Around:
    """The parts around one gear: the seats on its shaft, the shaft's diameter, and the gear's number on it."""

    seats: Seats
    diameter_mm: float
    gear: int

    @classmethod
    def of(cls, design: Design, number: int, gear: Gear) -> _Around | str:
        """The surroundings by the keys of a shaft, or the words for a key that is missing."""
        words, _, given = design.shafts[number]
        if (seats := seats_of(given)) is None:
            return f"drivetrain gives no bearings of the {words}"
        if (diameter := diameter_of(design, number)) is None:
            return f"the diameter of the {words} is not given"
        return cls(seats, diameter, design.gears_on(number).index(gear.value))

    @property
    def beside_mm(self) -> float:
        """The place of the other gear, or else of the crank, from the middle of this gear."""
        places = self.seats.gears_mm
        beside = places[1 - self.gear] if len(places) > 1 else self.seats.crank_at_mm
        return beside - places[self.gear]

    def shaft(self, body: tuple[float, float], loads: ShaftLoads) -> SteelShaft:
        """The shaft on springs under its loads over the cycle; ``body``: the body's radius and E."""
        first, second = (
            Support(bearing.at_mm - self.seats.gears_mm[self.gear], stiffness_n_mm(bearing, float(np.abs(force).max())))
            for bearing, force in zip(self.seats.bearings, bearing_forces(loads, self.seats), strict=True)
        )
        return SteelShaft(self.diameter_mm, 2.0 * float(body[0]), (first, second), body[1])


def _askew_mm(design: Design, running: Running) -> float:
    """Misalignment of the flanks over the face width, in either direction."""
    given, width = design.tolerances, running.face_width_mm
    slopes = []
    for gear, teeth, grade in zip(Gear, running.whole, grades_of(design), strict=True):
        own = None if given is None else getattr(given, gear.value)
        slopes.append(0.0 if grade is None else helix_slope_mm(grade, running.module_mm * teeth, width))
        slopes.append(0.0 if own is None else width * tan(radians(own.tilt_deg)))
    return hypot(*slopes)


def grades_of(design: Design) -> tuple[int | None, int | None]:
    """The accuracy grades of both gears: GRADE without the section ``tolerances``, None if the section has none."""
    given = design.tolerances
    if given is None:
        return GRADE, GRADE
    return given.driving.grade or given.grade, given.driven.grade or given.grade


@dataclass(frozen=True)
class ToldFaceLoad:
    """Figures of the load along the width: the least and the greatest K_Hbeta of the teeth, and the decisive one.

    Each has the tooth of the driving gear, counted from 1, the decisive one its driving angle too.  Teeth count if
    their load per mm of width is at least LEADING of the largest; the decisive tooth has most load per mm of width.
    ``decisive_factor_by_shafts`` is its factor without misalignment, ``best_crowning_factor`` with the best crowning,
    ``best_end_relief_factor`` with the best end relief, all else of the flanks as it is.  ``askew_um`` includes running
    in, and ``crowning_um`` is the crowning of the design.
    """

    factor_min: float
    factor_min_tooth: int
    factor_max: float
    factor_max_tooth: int
    decisive_factor: float
    decisive_factor_at_rad: float
    decisive_tooth: int
    decisive_factor_by_shafts: float
    askew_um: float
    crowning_um: float
    best_crowning_um: float
    best_crowning_factor: float
    best_end_relief_um: float
    best_end_relief_length_mm: float
    best_end_relief_factor: float


LEADING = 0.5
"""Share of the largest load above which teeth and positions count for these figures and for the best crowning.  At
small loads few flanks touch, and factors are high without harm."""


def _loads_of(loading: FaceLoading, strength: Strength, over: float) -> FaceLoads:
    """The loads of a strength with K_A ``over``, which a jam is not multiplied by."""
    return loading.loads_of(
        strength.contacts, 1.0 if strength.load == "jam" else over, strength.stresses.dynamic_factor
    )


def best_crowning_um(loading: FaceLoading, strength: Strength, over: float) -> float | None:
    """The best crowning in whole um for loads of a strength with K_A ``over``; None where no K_Hbeta is computed."""
    contacts = strength.contacts
    if loading.model is None or not contacts.force_n.size:
        return None
    lead, loads = loading.model.lead, _heavy(_loads_of(loading, strength, over), strength)
    fall_mm, _ = best_fall_mm(loading.model, *loads, lambda mm: replace(lead, crowning_mm=mm))
    return float(round(fall_mm / MM_PER_UM))


def _heavy(loads: FaceLoads, strength: Strength) -> tuple[FaceLoads, Array]:
    """The loads that count for the best form of the flanks, and the force on the most loaded pair of each."""
    most = np.zeros(loads.force_n.size)
    np.maximum.at(most, strength.contacts.position, strength.stresses.dynamic_factor * strength.contacts.over_width_n)
    heavy = most >= LEADING * most.max()
    return loads.kept(heavy), most[heavy]


RELIEVED = (0.1, 0.2, 0.3, 0.4, 0.5)
"""Lengths of end reliefs that are tried, as shares of the face width."""


def _best_end_relief(model: FaceModel, heavy: tuple[FaceLoads, Array]) -> LeadForm:
    """The lead with the best end relief in whole um, of the lengths RELIEVED."""

    def best(share: float) -> tuple[float, LeadForm]:
        lead = replace(model.lead, relief_length_mm=share * model.width_mm)
        fall_mm, load = best_fall_mm(model, *heavy, lambda mm: replace(lead, relief_mm=mm))
        return load, replace(lead, relief_mm=round(fall_mm / MM_PER_UM) * MM_PER_UM)

    return min(map(best, RELIEVED), key=lambda relief: relief[0])[1]


def told_face_load(loading: FaceLoading, strength: Strength, over: float, best_um: float | None) -> ToldFaceLoad | None:
    """Figures of loads of a strength with K_A ``over`` and of their best crowning; None as ``best_crowning_um``."""
    model, contacts, stresses = loading.model, strength.contacts, strength.stresses
    if model is None or best_um is None:
        return None
    factors, place = stresses.face_load_factor, contacts.position
    loads, force = _loads_of(loading, strength, over), stresses.dynamic_factor * contacts.over_width_n
    tooth = contacts.on(Gear.DRIVING).tooth
    line = factors * force
    rows = largest_rows(line, tooth, int(tooth.max()) + 1)
    rows = rows[(rows >= 0) & (line[rows] >= LEADING * line.max())]
    relieved = _best_end_relief(model, _heavy(loads, strength))
    leads = replace(model.lead, crowning_mm=best_um * MM_PER_UM), relieved
    crowned, ends = (float(np.max(replace(model, lead=lead).factors(loads)[place] * force)) for lead in leads)
    least, greatest, decisive = rows[factors[rows].argmin()], rows[factors[rows].argmax()], int(line.argmax())
    straight = replace(model, askew_mm=0.0).factors(loads.kept(place[decisive : decisive + 1]))
    return ToldFaceLoad(
        *(float(factors[least]), int(tooth[least])),
        *(float(factors[greatest]), int(tooth[greatest])),
        float(factors[decisive]),
        float(contacts.phi1_rad[decisive]),
        int(tooth[decisive]),
        float(straight[0]),
        model.askew_mm / MM_PER_UM,
        model.lead.crowning_mm / MM_PER_UM,
        best_um,
        crowned / force[decisive],
        float(round(relieved.relief_mm / MM_PER_UM)),
        relieved.relief_length_mm,
        ends / force[decisive],
    )
