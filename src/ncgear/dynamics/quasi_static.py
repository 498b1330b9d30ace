"""Loaded contact of the teeth: rest position of the driven gear under a torque while the driving gear turns slowly.

At each position the forces of all pairs, which grow with the depth by the law of impact at rest, balance the torque.
Their moment grows as the driven gear yields, so exactly one driven angle balances the torque.

Only the flanks that the torque presses can bear load: the others open as the driven gear yields, and without load they
touch at most.  Where there is no backlash, errors of the tables would press them by some 1e-6 mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ncgear.contact.designed.as_designed import ALIKE_RAD
from ncgear.dynamics.meshing import Meshing, ToothForces
from ncgear.errors import NoSuchMechanism, Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_from
from ncgear.numerics.zeros import zeros_between

FIRST_STEP_RAD = 1e-7
CLEAR_RAD = 1e-12
DOUBLINGS = 24
"""First step of the search for the balancing driven angle, which begins clear of the first touch, and most doublings of
the step: up to a radian, farther than any tooth yields."""

BALANCED = 1e-6
"""Share of the largest torque that a balance may miss.  A driven angle of some rad is known to 1e-15, so that the depth
is known to some 1e-8 even for teeth a million times as stiff as steel."""

ROUNDING_RAD = 1e-14
"""Driven angle to either side within which the torque counts as met where its own tolerance is below rounding, as with
torques next to 0."""


TOUCHING_MM, TOUCHING = 1e-10, 1e-3
"""Depth up to which a pair only touches: rounding errors of the driven angle, at the teeth of large gears.  A length is
enough, since an atom is a thousand times as wide.  Under next to no load it is this share of the deepest pair's
depth."""


def touching_mm(deepest_mm: Array) -> Array:
    """Depth up to which pairs only touch, for the depth of the deepest pair; of its shape."""
    return np.minimum(TOUCHING_MM, TOUCHING * np.maximum(deepest_mm, 0.0))


@dataclass(frozen=True, eq=False)
class LoadedContact:
    """The teeth under load at n positions.

    ``error_rad`` (shape (n,)) is the driven angle beyond the law's; ``forces`` have shape (n, slots), and the drive
    must supply their moments on the driving gear.
    """

    phi1_rad: Array
    error_rad: Array
    forces: ToothForces

    @property
    def transmission_error_rad(self) -> float:
        """Peak to peak variation of the driven angle beyond the law's."""
        return float(np.ptp(self.error_rad))

    @property
    def driving_torque_n_mm(self) -> Array:
        """Torque on the driving shaft, shape (n,)."""
        torque: Array = -self.forces.driving_n_mm.sum(axis=-1)
        return torque

    @property
    def tooth_force_n(self) -> Array:
        """Largest normal force of any pair at each position, in all its sections, shape (n,)."""
        largest: Array = self.forces.near.of_pairs(self.forces.normal_n).max(axis=-1)
        return largest

    @property
    def pairs(self) -> IndexArray:
        """Number of loaded pairs at each position, shape (n,)."""
        depth = np.where(self.forces.near.urge == 0.0, NO_DEPTH_MM, self.forces.depth_mm)
        loaded = depth > touching_mm(depth.max(axis=-1, keepdims=True))
        counted: IndexArray = np.sum(self.forces.near.of_pairs(loaded.astype(float)) > 0.0, axis=-1)
        return counted


def loaded_contact(meshing: Meshing, phi1_rad: Array, torque_n_mm: Array, speed_rad_s: Array | float) -> LoadedContact:
    """The teeth at driving angles in rad under torques in N mm on the driven shaft, shape (n,) each.

    The speed of the driving gear, everywhere or at each angle, gives the flanks' sliding, and so the sense of friction;
    0 means no friction.  Where the torque is 0 the gears stand on pushing flanks that just touch.  Raises Unanswered
    where no balance is found, and NoSuchMechanism where teeth would be pressed deeper into each other than the tables
    reach.
    """
    resting = replace(meshing, impact=replace(meshing.impact, damping_n_s_mm=0.0))
    ahead = meshing.gaps.play_rad(phi1_rad)[0]
    loaded = np.nonzero(torque_n_mm)[0]
    speed = np.broadcast_to(speed_rad_s, phi1_rad.shape)
    ahead[loaded] = _balanced(resting, phi1_rad[loaded], torque_n_mm[loaded], speed[loaded])
    meshing.require_reach(phi1_rad, ahead)
    return LoadedContact(phi1_rad, ahead, resting.beyond(phi1_rad, pressed_side(torque_n_mm), speed)(ahead))


def pressed_side(torque_n_mm: Array) -> Array:
    """+1 where pushing flanks bear a torque, -1 where their backs do, shape (n,)."""
    return np.where(torque_n_mm >= 0.0, 1.0, -1.0)


@dataclass(frozen=True)
class LoadedPeaks:
    """Largest values over all positions, with the driving angle of each; meaning as in ``LoadedContact``."""

    tooth_force_n: Extremum
    depth_mm: Extremum
    driving_torque_n_mm: Extremum
    transmission_error_rad: float
    most_pairs: int


def loaded_peaks(loaded_at: Callable[[Array], LoadedContact], phi1_rad: Array, pairs: int) -> LoadedPeaks:
    """The peaks between the first and the last of rising driving angles, shape (n,), of the teeth loaded at any angles.

    ``pairs`` is a number of pairs that are loaded together at some angle.  The angles must be so dense that there is
    one maximum between two of them.  Peaks are exact up to the rounding of angles.
    """

    def sizes(phi1: Array) -> Array:
        loaded = loaded_at(phi1)
        depth = np.maximum(loaded.forces.depth_mm.max(axis=-1), 0.0)
        error = loaded.error_rad
        further = _depth_of_next_mm(loaded.forces, pairs)
        return np.stack([loaded.tooth_force_n, depth, loaded.driving_torque_n_mm, error, -error, further])

    values, near = sizes(phi1_rad), loaded_at(phi1_rad[:1]).forces.near
    lever, stiffness = float(near.lever_mm.max()), float(near.stiffness.max())
    depth_mm = min(ALIKE_RAD * lever, TOLD * float(values[1].max()))
    told = np.array([stiffness * depth_mm, depth_mm, lever * stiffness * depth_mm, ALIKE_RAD, ALIKE_RAD, depth_mm])
    force, depth, torque, ahead, behind, further = largest_from(sizes, phi1_rad, values, told)
    if further.value > touching_mm(np.array(depth.value)):
        return loaded_peaks(loaded_at, np.union1d(phi1_rad, further.at), pairs + 1)
    return LoadedPeaks(force, depth, torque, ahead.value + behind.value, pairs)


def variation_rad(error_rad: Callable[[Array], Array], phi1_rad: Array) -> float:
    """Peak to peak variation of a driven angle beyond the law's, at angles as dense as those of ``loaded_peaks``."""

    def both(phi1: Array) -> Array:
        error = error_rad(phi1)
        return np.stack([error, -error])

    ahead, behind = largest_from(both, phi1_rad, both(phi1_rad), np.full(2, ALIKE_RAD))
    return ahead.value + behind.value


TOLD = 1e-5
"""Tolerance of peaks, as a share of the largest depth, under loads too small for the resolution of angles."""

NO_DEPTH_MM = -1e3
"""Depth of an absent pair: farther apart than teeth are followed."""


def _depth_of_next_mm(forces: ToothForces, pairs: int) -> Array:
    """Depth of the next pair after the ``pairs`` deepest pairs, shape (n,), negative where it bears no load.

    The number of loaded pairs jumps; this depth has a maximum between the jumps, however close they are.  Forces of
    helical teeth do not jump with it, since pairs come and go section by section.
    """
    there = np.where(forces.near.urge == 0.0, NO_DEPTH_MM, forces.depth_mm)
    if pairs >= there.shape[-1] or forces.near.number is not None:
        return np.full(len(there), NO_DEPTH_MM)
    depth: Array = np.sort(there, axis=-1)[:, -1 - pairs]
    return depth


def _balanced(meshing: Meshing, phi1_rad: Array, torque_n_mm: Array, speed_rad_s: Array) -> Array:
    """Driven angles beyond the law's at which the teeth balance torques other than 0."""
    forces = meshing.beyond(phi1_rad, pressed_side(torque_n_mm), speed_rad_s)

    def missing(ahead: Array) -> Array:
        moments: Array = forces(ahead).driven_n_mm.sum(axis=-1)
        return moments - torque_n_mm

    ahead = zeros_between(missing, *_bracket(missing, meshing, phi1_rad, torque_n_mm))
    balanced = np.abs(missing(ahead)) <= BALANCED * np.abs(torque_n_mm).max(initial=0.0)
    if not np.all(balanced | (np.sign(missing(ahead - ROUNDING_RAD)) * np.sign(missing(ahead + ROUNDING_RAD)) <= 0.0)):
        raise Unanswered("the forces of the teeth do not balance the torque")
    return ahead


def _bracket(
    missing: Callable[[Array], Array], meshing: Meshing, phi1_rad: Array, torque_n_mm: Array
) -> tuple[Array, Array]:
    """Driven angles beyond the law's that enclose the balance of the torque.

    Pushing flanks bear load at driven angles from their first touch backwards, backs from their first touch forwards.
    The first angle is a little before that touch, so that rounding errors of a depth of 0 bear no torque there.
    """
    pushing, back = meshing.gaps.play_rad(phi1_rad)
    push = torque_n_mm >= 0.0
    start = np.where(push, pushing + CLEAR_RAD, back - CLEAR_RAD)
    way = np.where(push, np.minimum(pushing, back), np.maximum(pushing, back)) - start
    step = np.where(push, -FIRST_STEP_RAD, FIRST_STEP_RAD)
    for _ in range(DOUBLINGS):
        end = start + way + step
        unmet = missing(end)
        short = np.where(push, unmet < 0.0, unmet > 0.0)
        if not short.any():
            return np.where(push, end, start), np.where(push, start, end)
        step = np.where(short, 2.0 * step, step)
    if meshing.stiffness_key and np.any((unmet + torque_n_mm)[short] * torque_n_mm[short] > 0.0):
        raise NoSuchMechanism(
            "no depth of the teeth bears the torque: they are too soft; a greater stiffness or less load is needed",
            key=meshing.stiffness_key,
        )
    raise NoSuchMechanism(
        "no depth of the teeth bears the torque: friction holds them; less of it is needed", key="simulation.friction"
    )
