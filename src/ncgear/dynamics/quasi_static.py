"""Loaded contact of the teeth: where the driven gear comes to rest under a torque while the driving gear turns slowly.

At each position the forces of all pairs, which grow with the depth by the law of impact at rest, balance the torque.
Their moment grows as the driven gear gives way, so exactly one driven angle balances the torque.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ncgear.contact.designed.as_designed import ALIKE_RAD
from ncgear.dynamics.meshing import Meshing, ToothForces, TwoShafts
from ncgear.errors import NoSuchMechanism, Unanswered
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.units import N_M_PER_N_MM, in_words
from ncgear.numerics.zeros import zeros_between

FIRST_STEP_RAD = 1e-7
CLEAR_RAD = 1e-12
DOUBLINGS = 24
"""The search for a driven angle that bears the torque begins clear of the first touch and with this step, and doubles
it at most so often: up to a radian, farther than any tooth gives way."""

BALANCED = 1e-6
"""Share of the largest torque that a balance may miss.  A driven angle of some rad is known to 1e-15, so that the depth
is known to some 1e-8 even for teeth a million times as stiff as steel."""

ROUNDING_RAD = 1e-14
"""Driven angle to either side of which the torque is met if a smaller share of it is within rounding errors only, as
where all torques are next to nothing."""


TOUCHING_MM = 1e-10
"""Depth up to which a pair only touches: rounding errors of the driven angle, at the teeth of large gears.  It is a
length, since no teeth are so small: an atom is a thousand times as wide."""


@dataclass(frozen=True, eq=False)
class LoadedContact:
    """The teeth under load at n positions.

    ``error_rad`` (shape (n,)) is the driven angle beyond the law's; ``forces`` have shape (n, slots), their moments on
    the driving gear are what the drive has to bring.
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
        """Largest normal force of any pair at each position, shape (n,)."""
        largest: Array = self.forces.normal_n.max(axis=-1)
        return largest

    @property
    def pairs(self) -> IndexArray:
        """Number of pairs that bear load at each position, shape (n,)."""
        counted: IndexArray = np.sum(self.forces.depth_mm > TOUCHING_MM, axis=-1)
        return counted


def loaded_contact(meshing: Meshing, phi1_rad: Array, torque_n_mm: Array, speed_rad_s: float) -> LoadedContact:
    """The teeth at driving angles in rad that bring torques in N mm to the driven shaft, shape (n,) each.

    The speed of the driving shaft tells how the flanks slide, and so which way they rub; 0 means no friction.  Where
    the torque is 0 the gears stand on pushing flanks that just touch.  Raises Unanswered where no balance is
    found, and NoSuchMechanism where teeth would be pressed deeper into each other than the tables follow.
    """
    resting = replace(meshing, impact=replace(meshing.impact, damping_n_s_mm=0.0))
    ahead = meshing.gaps.play_rad(phi1_rad)[0]
    loaded = np.nonzero(torque_n_mm)[0]
    ahead[loaded] = _balanced(resting, phi1_rad[loaded], torque_n_mm[loaded], speed_rad_s)
    meshing.require_reach(phi1_rad, ahead)
    return LoadedContact(phi1_rad, ahead, _forces(resting, phi1_rad, ahead, speed_rad_s))


WEDGED = 0.1
"""Share of the largest torque that teeth may bear against each other beyond what the torque asks for: exact teeth bear
none so, but the tables of their contacts err by some 1e-6 mm, which very stiff ones feel."""


def require_no_wedge(meshing: Meshing, loaded: LoadedContact, torque_n_mm: Array) -> None:
    """Refuse a given stiffness that is so great that errors of the teeth's places decide what they bear.

    ``torque_n_mm`` are the torques of the load, shape (n,).  Raises NoSuchMechanism with a stiffness that is not.
    """
    moments, most = loaded.forces.driven_n_mm, float(np.abs(torque_n_mm).max(initial=0.0))
    wedged = np.abs(moments).sum(axis=-1) - np.abs(moments.sum(axis=-1))
    worst = int(np.argmax(wedged))
    if meshing.stiffness_key and wedged[worst] > WEDGED * most:
        right = WEDGED * most / wedged[worst] * float(loaded.forces.near.stiffness[worst].max())
        raise NoSuchMechanism(
            f"the teeth are so stiff that at phi1 = {in_words(float(loaded.phi1_rad[worst]))} errors of a millionth of "
            f"a millimetre bear {N_M_PER_N_MM * wedged[worst]:.3g} N m against each other, and the load brings "
            f"{N_M_PER_N_MM * most:.3g} N m at most; {0.5 * right:.1g} or less is right",
            key=meshing.stiffness_key,
        )


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

    ``pairs`` is a number of pairs that bear load together at some angle.  Between two angles the loaded teeth are taken
    to have one top: the angles have to be dense enough for that.  Peaks are told from rounding as far as angles are.
    """

    def sizes(phi1: Array) -> Array:
        loaded = loaded_at(phi1)
        depth = np.maximum(loaded.forces.depth_mm.max(axis=-1), 0.0)
        error = loaded.error_rad
        further = _depth_of_next_mm(loaded.forces, pairs)
        return np.stack([loaded.tooth_force_n, depth, loaded.driving_torque_n_mm, error, -error, further])

    near = loaded_at(phi1_rad[:1]).forces.near
    lever, stiffness = float(near.lever_mm.max()), float(near.stiffness.max())
    depth_mm = ALIKE_RAD * lever
    told = np.array([stiffness * depth_mm, depth_mm, lever * stiffness * depth_mm, ALIKE_RAD, ALIKE_RAD, depth_mm])
    force, depth, torque, ahead, behind, further = largest_of_each(sizes, phi1_rad, told)
    if further.value > TOUCHING_MM:
        return loaded_peaks(loaded_at, np.union1d(phi1_rad, further.at), pairs + 1)
    return LoadedPeaks(force, depth, torque, ahead.value + behind.value, pairs)


NO_DEPTH_MM = -1e3
"""Depth of a pair that is not there: farther apart than teeth are followed."""


def _depth_of_next_mm(forces: ToothForces, pairs: int) -> Array:
    """Depth of the pair that would bear load after the ``pairs`` deepest ones, shape (n,), negative where it does not.

    How many pairs bear load jumps; this depth has a top between the jumps, however close they are.
    """
    there = np.where(forces.near.urge == 0.0, NO_DEPTH_MM, forces.depth_mm)
    if pairs >= there.shape[-1]:
        return np.full(len(there), NO_DEPTH_MM)
    depth: Array = np.sort(there, axis=-1)[:, -1 - pairs]
    return depth


def _forces(meshing: Meshing, phi1_rad: Array, ahead_rad: Array, speed_rad_s: float) -> ToothForces:
    angle, ratio = meshing.law.at(phi1_rad)
    return meshing.forces(TwoShafts(phi1_rad, speed_rad_s, angle + ahead_rad, ratio * speed_rad_s))


def _balanced(meshing: Meshing, phi1_rad: Array, torque_n_mm: Array, speed_rad_s: float) -> Array:
    """Driven angles beyond the law's at which the teeth bear torques other than 0."""

    def missing(ahead: Array) -> Array:
        moments: Array = _forces(meshing, phi1_rad, ahead, speed_rad_s).driven_n_mm.sum(axis=-1)
        return moments - torque_n_mm

    ahead = zeros_between(missing, *_bracket(missing, meshing, phi1_rad, torque_n_mm))
    balanced = np.abs(missing(ahead)) <= BALANCED * np.abs(torque_n_mm).max(initial=0.0)
    if not np.all(balanced | (np.sign(missing(ahead - ROUNDING_RAD)) * np.sign(missing(ahead + ROUNDING_RAD)) <= 0.0)):
        raise Unanswered("the forces of the teeth do not balance the torque")
    return ahead


def _bracket(
    missing: Callable[[Array], Array], meshing: Meshing, phi1_rad: Array, torque_n_mm: Array
) -> tuple[Array, Array]:
    """Driven angles beyond the law's between which the torque is met.

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
