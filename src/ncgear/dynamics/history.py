"""Results of a motion in time and their peaks: the slider beside its law, forces of the teeth, torque, loss of contact.

Without backlash the backs carry as soon as pushing flanks part; with backlash the driven gear runs free in between.

An impact lasts some milliseconds and may fall between rows at even times; the solver makes its steps shorter there.  A
resistance may have a narrow peak that no step meets: the places at which it turns are tested as well.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import chain, pairwise

import numpy as np

from ncgear.dynamics.crank_load import crank_angles_rad
from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.dynamics.mesh_force import MeshPlace
from ncgear.dynamics.meshing import Meshing, ToothForces, TwoShafts, force_on_driven
from ncgear.dynamics.motion_in_time import Course, unheard
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.forces import CrankPace, JointForces
from ncgear.numerics.arrays import Array
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector
from ncgear.numerics.zeros import zeros_between

PER_TURN = 2000
"""Samples in a turn of the driving gear."""


CRANK_BEARING = "crank_bearing"
"""The name of the bearing of the shaft that the driven gear turns, among the joints."""


MESH_BEFORE, BETWEEN_BEARING = "mesh_before", "between_bearing"
"""The names, before its number from 0, of a mesh before the last, and of the bearings of the shaft that it turns."""


@dataclass(frozen=True, eq=False)
class TeethInTime:
    """Teeth of a pair before the last at n times: largest normal forces of pairs of teeth, and the force of all."""

    pushing_n: Array
    back_n: Array
    mesh: Vector


@dataclass(frozen=True, eq=False)
class Slide:
    """Displacement, velocity and acceleration of the output, shape (n,) each, in units of ``OutputMotion``."""

    displacement: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True, eq=False)
class History:
    """A motion at n times, shape (n,) each.

    ``slide`` is the slider's motion, ``law`` its motion if the driven gear kept the law at the same angles of the
    driving gear; ``error_rad`` is the driven angle beyond the law's.  ``pushing_n`` and ``back_n`` are the largest
    normal forces of a pair, in all its sections, on either side of the teeth, ``torque_n_mm`` is the drive's.
    ``joints`` are the forces in the mechanism, ``mesh`` is the force of all teeth on the driven gear; the driving
    shaft's bearings exert the same force.  Of pairs in series ``error_rad`` is that of all together, other figures of
    teeth are those of the last, and ``before`` are those of the pairs before it, from the driving shaft on.
    """

    time_s: Array
    phi1_rad: Array
    phi2_rad: Array
    error_rad: Array
    slide: Slide
    law: Slide
    pushing_n: Array
    back_n: Array
    torque_n_mm: Array
    joints: JointForces
    mesh: Vector
    before: tuple[TeethInTime, ...] = ()

    @property
    def crank_bearing(self) -> Vector:
        """Force of its bearing on the crank shaft in N."""
        return self.joints.crank_axis - self.mesh

    @property
    def forces(self) -> Mapping[str, Vector]:
        """The forces in the joints and between the teeth, by the names that columns and figures give them."""
        meshes = [*(pair.mesh for pair in self.before), self.mesh]
        first = {f"{MESH_BEFORE} {pair}": mesh for pair, mesh in enumerate(meshes[:-1])}
        between = {f"{BETWEEN_BEARING} {pair}": two - one for pair, (one, two) in enumerate(pairwise(meshes))}
        return {**self.joints.joints, CRANK_BEARING: self.crank_bearing, "mesh": self.mesh, **first, **between}


def even_times_s(course: Course, least: int = 0) -> Array:
    """Even times over a course, PER_TURN intervals in each turn of the driving gear and at least ``least`` in all."""
    turns = float(course.states[0, -1] - course.states[0, 0]) / (2.0 * np.pi)
    return np.linspace(0.0, float(course.time_s[-1]), max(1, least, round(PER_TURN * turns)) + 1)


def history(course: Course, rigid: RigidMachine, time_s: Array) -> History:
    """The motion at times of shape (n,) from a course of this machine, which has gears."""
    toothed = course.machine
    assert rigid.place is not None
    states = course.at(time_s)
    answer = toothed.answer(states)
    phi1, speed1, phi2, speed2 = states[:4]
    *before, last = (
        _teeth(forces, meshing.law.at(shafts.phi1_rad)[1], place)
        for forces, (meshing, shafts), place in zip(answer.teeth, toothed.pairs(states), rigid.places, strict=True)
    )
    return History(
        time_s,
        phi1,
        phi2,
        phi2 - toothed.law_rad(phi1),
        _slide(rigid.machine.linkage.displacement(Jet.variable(phi2, 2)), speed2, answer.acceleration2_rad_s2),
        _slide(rigid.machine.displacement(phi1, 2), speed1, answer.acceleration1_rad_s2),
        last.pushing_n,
        last.back_n,
        answer.torque_n_mm,
        rigid.joints(phi2, CrankPace(speed2, answer.acceleration2_rad_s2)),
        last.mesh,
        tuple(before),
    )


def _teeth(forces: ToothForces, ratio: Array, place: MeshPlace) -> TeethInTime:
    urge, normal = forces.near.urge, forces.near.of_pairs(forces.normal_n)
    pushing, back = (np.where(side * urge > 0.0, normal, 0.0).max(axis=-1) for side in (1.0, -1.0))
    return TeethInTime(pushing, back, force_on_driven(forces, ratio, place))


def _slide(displacement: Jet, speed_rad_s: Array, acceleration_rad_s2: Array) -> Slide:
    """The slider's motion, from its displacement as a jet by an angle, and the angle's speed and acceleration."""
    slope, bend = displacement.derivative(1), displacement.derivative(2)
    return Slide(displacement.value, slope * speed_rad_s, bend * speed_rad_s**2 + slope * acceleration_rad_s2)


NEAR_RAD = 1e-6
"""Driven angle within which flanks count as touching: the error of the tables of first touches is some millionths of a
radian (tests/test_gaps.py), and may show as play."""


def pressed_rad(meshing: Meshing, shafts: TwoShafts) -> Array:
    """Angle by which the driven gear is pressed beyond the first contact of pushing flanks and of backs, shape (2, n).

    It is negative where they are apart; ``shafts`` are those of the pair, shape (n,).
    """
    phi1 = np.asarray(shafts.phi1_rad)
    pushing, back = meshing.gaps.play_rad(phi1)
    error = shafts.phi2_rad - meshing.law.at(phi1)[0]
    return np.stack([pushing - error, error - back])


def meetings_s(pressed: Callable[[Array], Array], time_s: Array, known: Array | None = None) -> Array:
    """Times, between rising times of shape (n,), at which flanks meet or part.

    ``pressed`` gives the angles by which they are pressed into each other, zero or negative where they are apart; at
    the times these may be ``known``.
    """
    change = np.flatnonzero(np.diff((pressed(time_s) if known is None else known) > 0.0))
    return zeros_between(pressed, time_s[change], time_s[change + 1]) if change.size else np.empty(0)


def partings_s(course: Course, pair: int = -1) -> tuple[Array, Array]:
    """Starts and ends of the times without contact of pushing flanks, and of any flanks, shape (k, 2) each.

    ``pair`` numbers the pair, from 0 at the driving shaft.
    """

    def pressed(time_s: Array, side: int | slice) -> Array:
        found: Array = pressed_rad(*course.machine.pairs(course.at(time_s))[pair])[side]
        return found

    edges, found = course.time_s[[0, -1]], list[Array]()
    for side, known in enumerate(pressed(course.fine_s, slice(None))):
        edges = np.union1d(edges, meetings_s(partial(pressed, side=side), course.fine_s, known))
        apart = pressed((edges[1:] + edges[:-1]) / 2.0, slice(side + 1)).max(axis=0) < -NEAR_RAD
        found.append(np.column_stack([edges[:-1][apart], edges[1:][apart]]))
    return found[0], found[1]


@dataclass(frozen=True)
class Peak:
    """A value with its time in s and its driving angle in rad."""

    value: float
    time_s: float
    phi1_rad: float


@dataclass(frozen=True)
class MotionPeaks:
    """Largest sizes over a motion; names and meaning are those of ``History``.

    ``forces_n`` are the forces in the joints and between the teeth, by their names.  ``before`` are the largest forces
    of a pair on pushing flanks and on backs, of each pair in series before the last.
    """

    displacement_error: Peak
    velocity_error: Peak
    acceleration: Peak
    pushing_n: Peak
    back_n: Peak
    most_torque_n_mm: Peak
    least_torque_n_mm: Peak
    forces_n: Mapping[str, Peak]
    before: tuple[tuple[Peak, Peak], ...] = ()

    @property
    def of_pairs(self) -> tuple[tuple[Peak, Peak], ...]:
        """The largest forces on pushing flanks and on backs of all pairs, from the driving shaft on."""
        return *self.before, (self.pushing_n, self.back_n)

    @property
    def times_s(self) -> Array:
        """The times of all peaks, shape (n,)."""
        alone = [peak for peak in vars(self).values() if isinstance(peak, Peak)]
        return np.unique([peak.time_s for peak in (*alone, *chain(*self.before), *self.forces_n.values())])


def motion_peaks(course: Course, rigid: RigidMachine, on_share: Callable[[float], None] = unheard) -> MotionPeaks:
    """The peaks of a course of this machine; ``on_share`` receives the finished share of it."""
    names = list(_sizes(history(course, rigid, course.time_s[:1])))
    places = np.union1d(course.fine_s, _turns_s(course, rigid.machine))

    def sizes(time_s: Array) -> Array:
        on_share(float(time_s[0] / places[-1]))
        return np.stack(list(_sizes(history(course, rigid, time_s)).values()))

    found = largest_of_each(sizes, places)
    phi1 = course.at(np.array([extremum.at for extremum in found]))[0]
    peaks = {
        name: Peak(extremum.value, extremum.at, float(angle))
        for name, extremum, angle in zip(names, found, phi1, strict=True)
    }
    forces = {name.removesuffix(FORCE): peaks.pop(name) for name in names if name.endswith(FORCE)}
    braking = peaks.pop("least_torque_n_mm")
    least = Peak(0.0 - braking.value, braking.time_s, braking.phi1_rad)
    of_teeth = [peaks.pop(name) for name in names if name.startswith(BEFORE)]
    before = tuple(zip(of_teeth[::2], of_teeth[1::2], strict=True))
    return MotionPeaks(**peaks, least_torque_n_mm=least, forces_n=forces, before=before)


FORCE, BEFORE = " force", "before "


def _sizes(shown: History) -> dict[str, Array]:
    """The quantities whose peaks are searched, shape (n,) each; the least torque with the other sign."""
    return {
        "displacement_error": np.abs(shown.slide.displacement - shown.law.displacement),
        "velocity_error": np.abs(shown.slide.velocity - shown.law.velocity),
        "acceleration": np.abs(shown.slide.acceleration),
        "pushing_n": shown.pushing_n,
        "back_n": shown.back_n,
        "most_torque_n_mm": shown.torque_n_mm,
        "least_torque_n_mm": -shown.torque_n_mm,
        **{
            f"{BEFORE}{pair} {side}": force
            for pair, pair_forces in enumerate(shown.before)
            for side, force in enumerate((pair_forces.pushing_n, pair_forces.back_n))
        },
        **{name + FORCE: np.hypot(force.x, force.y) for name, force in shown.forces.items()},
    }


def _turns_s(course: Course, machine: Machine) -> Array:
    """Times at which the slider passes a place of either stroke where the resistance turns."""
    stroke = machine.linkage.stroke_mm
    crank_rad = [
        crank_angles_rad(machine.linkage, machine.load.turns_mm(stroke, returning), returning)
        for returning in (False, True)
    ]
    return np.concatenate([np.empty(0), *(_passings_s(course, angle) for angle in np.concatenate(crank_rad))])


def _passings_s(course: Course, crank_rad: float) -> Array:
    """Times at which the crank passes an angle, in any turn."""
    # Half the angle, so that the sine changes its sign at each passing and nowhere else
    return meetings_s(lambda time_s: np.sin((course.at(time_s)[2] - crank_rad) / 2.0), course.time_s)
