"""The load of every tooth at every place of its flanks, over a whole cycle of meetings.

At even positions of the cycle the pairs of teeth share the torque of the driven gear as the linear springs that they
are: the driven gear gives way until their forces balance it.  There is no friction and no motion in time.  Between two
positions forces change by less than a thousandth of the largest one, but where a pair begins or ceases to bear load.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ncgear.contact.placement import BACK, PUSHING, Placement, placed
from ncgear.dynamics.meshing import Friction, Meshing
from ncgear.dynamics.quasi_static import loaded_contact
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import along, as_complex
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear, speed
from ncgear.strength.contacts import FlankPlaces, LoadedContacts
from ncgear.strength.stiffness import flank_heights_mm
from ncgear.teeth.gear import ToothedGear, ToothedPair

PER_TOOTH = 20
"""Positions in a tooth pitch, which divides those of the table of gaps: a pair with a contact ratio of 1.5 bears load
in thirty of them.  The largest force of each tooth is then met to 0.5 % (tests/test_loading.py)."""

IDLE = 1e-9
"""Share of the largest force below which a pair bears nothing."""


@dataclass(frozen=True, eq=False)
class Loading:
    """The teeth under load at n even positions of a cycle in which every tooth meets all its mates.

    ``torque_n_mm`` is asked of the driven gear and ``error_rad`` is its angle beyond the law's, shape (n,) each.
    ``cycle_turns`` is how often the driving gear turns in the cycle.
    """

    contacts: LoadedContacts
    phi1_rad: Array
    torque_n_mm: Array
    error_rad: Array
    cycle_turns: int

    @property
    def transmission_error_rad(self) -> float:
        """Peak to peak variation of the driven angle beyond the law's."""
        return float(np.ptp(self.error_rad))

    @property
    def pairs(self) -> IndexArray:
        """Number of pairs that bear load at each position, shape (n,)."""
        return np.bincount(self.contacts.position, minlength=self.phi1_rad.size)

    @property
    def contact_ratio(self) -> float:
        """Mean number of pairs that bear load, over the positions that have a load; 0 where none has."""
        pairs = self.pairs
        return float(pairs[pairs > 0].mean()) if pairs.any() else 0.0

    @property
    def fewest_pairs(self) -> int:
        """Least number of pairs that bear load, over the positions that have a load; 0 where none has."""
        pairs = self.pairs
        return int(pairs[pairs > 0].min(initial=pairs.max(initial=0)))


def loading_of(
    meshing: Meshing,
    teeth: ToothedPair,
    pitch: PitchPair,
    torque_n_mm: Callable[[Array], Array],
    speed_rad_s: float,
    per_tooth: int = PER_TOOTH,
) -> Loading:
    """The loads of straight teeth in ``meshing``, whose table of gaps tells where pairs touch.

    ``torque_n_mm`` gives the torque asked of the driven gear at driving angles (shape (n,)), of either sign;
    ``speed_rad_s`` is the speed of the driving gear.  Raises as ``loaded_contact`` does.
    """
    placement = placed(pitch, per_tooth)
    torque = torque_n_mm(placement.phi1_rad)
    smooth = replace(meshing, friction=Friction(0.0, 0.0, 1.0, 10.0))
    loaded = loaded_contact(smooth, placement.phi1_rad, torque, 0.0)
    forces = loaded.forces.normal_n
    position, slot = np.nonzero(forces > IDLE * forces.max(initial=0.0))
    found = _Touching.of(meshing, placement, position, slot)
    driving, driven = found.places(Gear.DRIVING), found.places(Gear.DRIVEN)
    fits = [Fit.of(teeth.of(gear), place) for gear, place in ((Gear.DRIVING, driving), (Gear.DRIVEN, driven))]
    flanks = fits[0].on_flank & fits[1].on_flank
    rolling = found.rolling_mm(pitch, (fits[0], fits[1]), flanks)
    contacts = LoadedContacts(
        position,
        placement.phi1_rad[position],
        found.side,
        forces[position, slot],
        np.where(flanks, fits[0].curvature + fits[1].curvature, np.inf),
        flanks,
        speed_rad_s * rolling,
        driving.flank,
        driving.point,
        driving.inwards,
        driven.flank,
        driven.point,
        driven.inwards,
    )
    return Loading(
        contacts, placement.phi1_rad, torque, loaded.error_rad, placement.meetings // placement.driving_teeth
    )


FITTING = 1e-6
"""How far a place may be from its flank, in modules, and its normal from the flank's, in rad: rounding errors of the
tables, and far less than where an edge bears load."""


@dataclass(frozen=True, eq=False)
class Fit:
    """How n places lie on the flanks of one gear, shape (n,) each.

    ``slope`` is the derivative of the flank by its height, in the gear's own frame, at the point of the flank nearest
    to each place; ``off_mm`` and ``tilt`` are the distance from it and the sine of the angle between both normals.
    """

    gear: ToothedGear
    flank: IndexArray
    slope: ComplexArray
    curvature: Array
    off_mm: Array
    tilt: Array

    @classmethod
    def of(cls, gear: ToothedGear, places: FlankPlaces) -> Fit:
        """The places on the flanks of a gear."""
        height = flank_heights_mm(gear, places)
        point, slope = (as_complex(part) for part in gear.flanks.flank(places.flank, height))
        off, tilt = np.abs(point - places.point), np.abs(along(slope / np.abs(slope), places.inwards))
        return cls(gear, places.flank, slope, gear.flanks.curvature(places.flank, height), off, tilt)

    @property
    def on_flank(self) -> Mask:
        """Whether the flank itself touches at each place, and no edge."""
        near: Mask = (self.off_mm <= FITTING * self.gear.flanks.rack.module_mm) & (self.tilt <= FITTING)
        return near

    @property
    def rolled(self) -> ComplexArray:
        """How the place of contact moves along the flank for each mm rolled."""
        flanks = self.gear.flanks
        return -flanks.side[self.flank] * flanks.rack.height_per_rolled * self.slope


@dataclass(frozen=True, eq=False)
class _Touching:
    """n pairs that bear load, in the fixed frame; each where it begins to touch, shape (n,) each.

    Let t be the unit tangent, w the way from the driven axis to the place of contact and s the sense of the mesh.  Then
    conj(t) w is the lever and, as its imaginary part, -s times the speed of the driven gear's point along t.
    ``sliding_mm`` is the speed of the driving gear's point against the driven one's along t, in mm per rad of phi1.
    """

    placement: Placement
    row: IndexArray
    teeth: IndexArray
    urge: Array
    error_rad: Array
    sliding_mm: Array
    tangent: ComplexArray
    point: ComplexArray

    @classmethod
    def of(cls, meshing: Meshing, placement: Placement, row: IndexArray, slot: IndexArray) -> _Touching:
        """The pairs in slots of the table at positions; shape (n,) each."""
        gaps, phi1, number = meshing.gaps, placement.phi1_rad[row], np.arange(row.size)
        near, sense, distance = gaps.at(phi1), placement.mesh.sense, placement.center_distance_mm
        urge, error, lever, driving, driven, drift = (
            part[number, slot]
            for part in (near.urge, near.error_rad, near.lever_mm, near.driving_mm, near.driven_mm, near.slopes[0])
        )
        along_x = lever * (sense * (placement.speed[row] + drift) - 1.0)
        tangent: ComplexArray = along_x + 1j * (driving - sense * driven)
        tangent = tangent / np.abs(tangent)
        point: ComplexArray = distance + tangent * (lever - 1j * sense * driven)
        pair = gaps.pair[gaps.table.place(phi1)[1], slot]
        return cls(placement, row, pair, urge, error, driving - placement.speed[row] * driven, tangent, point)

    @property
    def side(self) -> IndexArray:
        """PUSHING or BACK."""
        return np.where(self.urge > 0.0, PUSHING, BACK)

    def places(self, gear: Gear) -> FlankPlaces:
        """The places on one gear's flanks.

        Arc length grows against the turning of the driving gear, so its back flanks push the driven gear's front ones.
        """
        sense, row, pushing = self.placement.mesh.sense, self.row, self.urge > 0.0
        into_driven = 1j * sense * self.urge * self.tangent
        if gear is Gear.DRIVING:
            back = np.exp(-1j * self.placement.phi1_rad[row])
            flank = 2 * (self.teeth[:, 0] - 1) + np.where(pushing, 0, 1)
            return FlankPlaces(flank, self.point * back, -into_driven * back)
        back = np.exp(-1j * sense * (self.placement.phi2_rad[row] + self.error_rad))
        flank = 2 * (self.teeth[:, 1] - 1) + np.where(pushing, 1, 0)
        return FlankPlaces(flank, (self.point - self.placement.center_distance_mm) * back, into_driven * back)

    def rolling_mm(self, pitch: PitchPair, fits: tuple[Fit, Fit], flanks: Mask) -> Array:
        """How fast the contact moves along the driving and the driven flank, in mm per rad of phi1, shape (n, 2).

        Both are counted along the tangent; their difference is the sliding.  An edge stays where it is on its own gear.
        """
        slope = pitch.transmission.driven_angle(self.placement.phi1_rad, 2).differentiated()
        rolled = pitch.center_distance_mm * speed(slope, Gear.DRIVING, pitch.mesh).value[self.row]
        own, other = fits
        here = along(self.tangent, own.rolled * np.exp(1j * self.placement.phi1_rad[self.row])) * rolled
        # Where an edge touches a fillet, its own gear is the one on whose flank it still is.
        apart = np.maximum(own.off_mm, other.off_mm) > FITTING * own.gear.flanks.rack.module_mm
        own_edge = np.where(apart, own.off_mm < other.off_mm, own.tilt > other.tilt)
        first = np.where(flanks, here, np.where(own_edge, 0.0, -self.sliding_mm))
        return np.column_stack([first, first + self.sliding_mm])
