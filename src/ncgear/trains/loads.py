"""Loads of a train with masses on its driving part and its frame while the driving part turns evenly.

Every part is a rigid body of one density: its outline times its width, without bore and holes; masses can be added at
points of parts.  The driving torque follows from virtual work: at each driving angle the driving part does the work of
the inertia forces and the weights of all bodies.  Forces of teeth and axes follow from the balance of each body, from
the last one to the sun.  Friction and play are left out.  Derivatives by the driving angle come from the Fourier series
through evenly spaced poses of a cycle, so the train must stand after a cycle as before it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import lru_cache
from math import pi

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.plane import as_complex
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.trains.train import GROUND, GearMesh, Part, Poses, Train

POSITIONS = 1440
"""Poses while the meshes come round once: a quarter of a degree, so that a thirtieth harmonic has 48 poses."""

MM_PER_M = 1000.0


@dataclass(frozen=True)
class PutMass:
    """A mass in kg at a point of a part, in the part's own frame in mm."""

    part: str
    at_mm: complex
    kg: float


@dataclass(frozen=True)
class RigidBody:
    """Mass in kg, its centre in the part's own frame in mm, and its moment of inertia about the centre in kg mm2."""

    kg: float
    center_mm: complex
    kg_mm2: float


@dataclass(frozen=True, eq=False)
class TrainLoads:
    """Loads over evenly spaced driving angles in rad of a cycle, shape (n,) each.

    ``torque_n_m`` is that of the driving part where nothing else is driven; ``force_n`` is the inertia force on the
    frame, as complex numbers in the frame of the ground, and ``moment_n_m`` the moment of the inertia forces on the
    frame about the driving axis.
    ``counterweight_kg_mm`` is the mass times distance, as a complex number in the ground's frame, that a carrier at
    angle 0 needs to make the mean square of the force least; ``left_n`` is the force that is left.
    """

    driving_rad: Array
    torque_n_m: Array
    force_n: ComplexArray
    moment_n_m: Array
    counterweight_kg_mm: complex
    left_n: ComplexArray
    mass_kg: float


@dataclass(frozen=True, eq=False)
class TrainForces:
    """Forces in N at the driving angles of ``TrainLoads``: complex numbers in the frame of the ground, shape (n,) each.

    ``teeth_n`` has the force of the first part's teeth on the second's for each mesh, by the names of both parts;
    ``axes_n`` has the force with which the carrier's axis holds a body, by the name of its first part; ``driven_n_m``
    has the torque, shape (n,), that turns a body about an axis of the frame, the carrier apart.
    """

    teeth_n: dict[tuple[str, str], ComplexArray]
    axes_n: dict[str, ComplexArray]
    driven_n_m: dict[str, Array]

    def largest_n(self) -> tuple[dict[str, float], dict[str, float]]:
        """Greatest forces between teeth and on axes, of all arms; their numbers are left out of the names."""
        teeth = ((f"{first} and {second}", force) for (first, second), force in self.teeth_n.items())
        return _largest(teeth), _largest(self.axes_n.items())


def _largest(forces: Iterable[tuple[str, ComplexArray]]) -> dict[str, float]:
    found: dict[str, float] = {}
    for name, force in forces:
        kind = re.sub(r"_\d+", "", name)
        found[kind] = max(found.get(kind, 0.0), float(np.abs(force).max()))
    return found


def moments_of(outline: ComplexArray) -> tuple[float, complex, float]:
    """Area in mm2, its first moment in mm3, and its second moment about the origin in mm4, of a closed polygon.

    The outline is counter-clockwise, shape (n,); sums over its triangles with the origin.
    """
    after = np.roll(outline, -1)
    cross = (outline.conj() * after).imag
    first = complex(np.sum(cross * (outline + after)) / 6.0)
    second = np.sum(cross * (np.abs(outline) ** 2 + np.abs(after) ** 2 + (outline.conj() * after).real))
    return float(cross.sum()) / 2.0, first, float(second) / 12.0


def body_of(part: Part, density_kg_m3: float, put: Sequence[PutMass] = ()) -> RigidBody:
    """A part as a rigid body, with the masses added to it."""
    area, first, second = moments_of(as_complex(part.outline_mm))
    if part.rim_mm is not None:
        whole = pi * part.reach_mm**2
        area, first, second = whole - area, -first, whole * part.reach_mm**2 / 2.0 - second
    holes = [(hole.x_mm + 1j * hole.y_mm, hole.diameter_mm) for hole in part.holes]
    for at, diameter in [*holes, *([] if part.bore_mm is None else [(0j, part.bore_mm)])]:
        gone = pi * diameter**2 / 4.0
        area, first, second = area - gone, first - gone * at, second - gone * (abs(at) ** 2 + diameter**2 / 8.0)
    per_mm2 = density_kg_m3 * part.face_width_mm / MM_PER_M**3
    kg = per_mm2 * area + sum(mass.kg for mass in put)
    center = (per_mm2 * first + sum(mass.kg * mass.at_mm for mass in put)) / kg
    about_origin = per_mm2 * second + sum(mass.kg * abs(mass.at_mm) ** 2 for mass in put)
    return RigidBody(kg, center, about_origin - kg * abs(center) ** 2)


@dataclass(frozen=True, eq=False)
class _Moving:
    """A part as a rigid body at evenly spaced driving angles, shape (n,), with derivatives by the driving angle."""

    body: RigidBody
    center: ComplexArray
    velocity: ComplexArray
    acceleration: ComplexArray
    spin: Array
    faster: Array

    def needed(self, axis: ComplexArray, speed_rad_s: float, gravity_mm_s2: complex) -> tuple[ComplexArray, Array]:
        """The force that the body needs at a driving speed, and its moment about an axis, shape (n,) each."""
        force = self.body.kg * (self.acceleration * speed_rad_s**2 - gravity_mm_s2)
        turning = ((self.center - axis).conj() * force).imag + self.body.kg_mm2 * self.faster * speed_rad_s**2
        return force, turning


def _moving(train: Train, poses: Poses, number: int, density_kg_m3: float, put: Sequence[PutMass]) -> _Moving:
    """The part ``number``; poses are those at even driving angles and at the end of the cycle."""
    part = train.parts[number]
    body = body_of(part, density_kg_m3, [mass for mass in put if mass.part == part.name])
    place, turn = poses.places(number)
    center = (place + body.center_mm * turn)[:-1]
    turned = poses.angle_rad[number]
    rate = float(turned[-1] - turned[0]) / train.cycle_rad
    velocity, acceleration = (_derivative(center, order, train.cycle_rad) for order in (1, 2))
    swing = (turned[:-1] - turned[0] - rate * _driving(train)).astype(complex)
    spin, faster = (_derivative(swing, order, train.cycle_rad).real for order in (1, 2))
    return _Moving(body, center, velocity, acceleration, spin + rate, faster)


def _driving(train: Train) -> Array:
    return np.linspace(0.0, train.cycle_rad, POSITIONS * train.repeats, endpoint=False)


@lru_cache(maxsize=1)
def _cycle(train: Train) -> Poses:
    """The poses at even driving angles and at the end of the cycle, which several loads take."""
    return train.poses_at(np.append(_driving(train), train.cycle_rad))


def loads_of(train: Train, density_kg_m3: float, put: Sequence[PutMass], gravity_mm_s2: complex) -> TrainLoads:
    """Loads of the driving part and the frame; ``gravity_mm_s2`` is a complex number in the ground's frame."""
    speed, driving = train.speed_rpm * RAD_S_PER_RPM, _driving(train)
    poses = _cycle(train)
    axis = complex(*(float(values[train.number(train.driving), 0]) for values in (poses.x_mm, poses.y_mm)))
    torque, moment = np.zeros(driving.size), np.zeros(driving.size)
    force: ComplexArray = np.zeros(driving.size, dtype=complex)
    total = 0.0
    for number in range(len(train.parts)):
        moving = _moving(train, poses, number, density_kg_m3, put)
        body, inertia = moving.body, moving.body.kg * moving.acceleration * speed**2
        turning = body.kg_mm2 * moving.faster * speed**2
        torque += ((inertia - body.kg * gravity_mm_s2).conj() * moving.velocity).real + turning * moving.spin
        force -= inertia
        moment -= ((moving.center - axis).conj() * inertia).imag + turning
        total += body.kg
    turned = poses.angle_rad[train.number(train.driving), :-1]
    pull = -_derivative(np.exp(1j * (turned - turned[0])), 2, train.cycle_rad) * speed**2
    weight = -complex(np.mean(force * pull.conj()) / np.mean(np.abs(pull) ** 2))
    left = force + weight * pull
    # kg mm2/s2 are uN m, kg mm/s2 are mN
    return TrainLoads(
        driving, torque / MM_PER_M**2, force / MM_PER_M, moment / MM_PER_M**2, weight, left / MM_PER_M, total
    )


@dataclass(frozen=True, eq=False)
class TurningLoad:
    """What a body needs about its axis, over evenly spaced driving angles of a cycle and its end, shape (n,) each.

    ``turned_rad`` is its turn against the driving part from the first angle on, in its own sense, ``rate`` the
    derivative by the driving angle.  ``torque_n_m`` in this sense makes it move as it does.  ``even_n_m`` would speed
    up its inertia ``kg_mm2`` about its axis if the driving part turned evenly.
    """

    turned_rad: Array
    rate: Array
    torque_n_m: Array
    even_n_m: Array
    kg_mm2: float


def turning_load(
    train: Train, name: str, density_kg_m3: float, put: Sequence[PutMass], gravity_mm_s2: complex
) -> TurningLoad:
    """The load of a part with all that is fixed to it about its axis, which may move (Newton and Euler)."""
    speed = train.speed_rpm * RAD_S_PER_RPM
    poses = _cycle(train)
    own, driving = train.number(name), train.number(train.driving)
    axis = poses.places(own)[0][:-1]
    moment, about_axis = np.zeros(axis.size), 0.0
    turning, around = (_moving(train, poses, number, density_kg_m3, ()) for number in (own, driving))
    rate = turning.spin - around.spin
    faster = (turning.faster - around.faster - rate / around.spin * around.faster) / around.spin**2
    for number, part in enumerate(train.parts):
        if train.body(part) != train.body(train.part(name)):
            continue
        moving = _moving(train, poses, number, density_kg_m3, put)
        body, arm = moving.body, moving.center - axis
        kg_mm2 = body.kg_mm2 + body.kg * float(np.abs(arm[0])) ** 2
        moment += moving.needed(axis, speed, gravity_mm_s2)[1]
        about_axis += kg_mm2
    turned = poses.angle_rad[own] - poses.angle_rad[driving]
    sense = float(np.sign(turned[-1] - turned[0]))
    even = about_axis * faster * speed**2
    rate, torque, even = (sense * np.append(quantity, quantity[0]) for quantity in (rate, moment, even))
    return TurningLoad(sense * (turned - turned[0]), rate, torque / MM_PER_M**2, even / MM_PER_M**2, about_axis)


def joint_forces(
    train: Train, rack_rad: float, density_kg_m3: float, put: Sequence[PutMass], gravity_mm_s2: complex
) -> TrainForces:
    """Forces of teeth and axes of a planetary train whose teeth have the rack's pressure angle ``rack_rad``.

    The moments about a body's axis give the force in its last mesh that is not known yet; its axis bears what is left
    of its forces, and the torque of a sun that turns bears what is left of its moments.  Teeth push in the pitch point,
    at the rack's angle to the tangent of the pitch curves, with the flanks that the moment asks for.
    """
    speed = train.speed_rpm * RAD_S_PER_RPM
    poses = _cycle(train)
    moving = [_moving(train, poses, number, density_kg_m3, put) for number in range(len(train.parts))]
    axes = [poses.places(number)[0][:-1] for number in range(len(train.parts))]
    force: dict[str, ComplexArray] = {}
    moment: dict[str, Array] = {}
    for part, moving_part in zip(train.parts, moving, strict=True):
        body = train.body(part)
        if body in (GROUND, train.body(train.part(train.driving))):
            continue
        needed, turning = moving_part.needed(axes[train.number(body)], speed, gravity_mm_s2)
        moment[body] = moment.get(body, 0.0) + turning
        if np.ptp(axes[train.number(body)].real) > 0.0:
            force[body] = force.get(body, 0.0) + needed
    teeth: dict[tuple[str, str], ComplexArray] = {}
    left = list(train.meshes)
    while left:
        meshes = {body: [mesh for mesh in left if body in _bodies(train, mesh)] for body in force}
        body, (mesh,) = next((name, own) for name, own in meshes.items() if len(own) == 1)
        left.remove(mesh)
        numbers = train.number(mesh.first), train.number(mesh.second)
        point, ways = _pushes([axes[n] for n in numbers], [moving[n].spin for n in numbers], train.cycle_rad, rack_rad)
        sides = dict(zip(_bodies(train, mesh), (-1.0, 1.0), strict=True))
        lever = [sides[body] * ((point - axes[train.number(body)]).conj() * way).imag for way in ways]
        sizes = [moment[body] / arm for arm in lever]
        found: ComplexArray = np.where(sizes[0] >= 0.0, sizes[0] * ways[0], sizes[1] * ways[1])
        teeth[mesh.first, mesh.second] = found / MM_PER_M
        for name in moment.keys() & sides.keys():
            moment[name] = moment[name] - sides[name] * ((point - axes[train.number(name)]).conj() * found).imag
            if name in force:
                force[name] = force[name] - sides[name] * found
    driven = {name: value / MM_PER_M**2 for name, value in moment.items() if name not in force}
    return TrainForces(teeth, {name: value / MM_PER_M for name, value in force.items()}, driven)


def _bodies(train: Train, mesh: GearMesh) -> tuple[str, str]:
    return train.body(train.part(mesh.first)), train.body(train.part(mesh.second))


def _pushes(
    axes: Sequence[ComplexArray], spins: Sequence[Array], period: float, rack_rad: float
) -> tuple[ComplexArray, tuple[ComplexArray, ComplexArray]]:
    """The pitch point, and where either flank of the first gear pushes the second one, shape (n,) each."""
    line = axes[1] - axes[0]
    turning = (line.conj() * _derivative(line, 1, period)).imag / np.abs(line) ** 2
    one, other = (spin - turning for spin in spins)
    arm = line * other / (other - one)
    radius = np.abs(arm)
    # The tangent of the first pitch curve, which the pitch point runs back as the gear turns on
    tangent = arm * (1j * radius - _derivative(radius.astype(complex), 1, period).real / one)
    tangent /= np.abs(tangent)
    return axes[0] + arm, (tangent * np.exp(-1j * rack_rad), -tangent * np.exp(1j * rack_rad))


def _derivative(values: ComplexArray, order: int, period: float) -> ComplexArray:
    """Derivative of a periodic function from evenly spaced values of a period, shape (n,)."""
    waves = np.fft.fftfreq(values.size, period / values.size) * 2j * pi
    # The highest wave has no derivative of odd order at these places.
    waves[values.size // 2] *= 1 - order % 2
    return np.fft.ifft(np.fft.fft(values) * waves**order)
