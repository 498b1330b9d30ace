"""The rigid level: the forces and the driving torque that a motion at constant driving speed needs (inverse dynamics).

The law gives the crank's angle with its derivatives, the mechanism the forces in its joints, the pitch curves the force
between the teeth; all are closed forms, so peaks are located exactly: at stationary points, and on both sides of every
joint of the law.

From the driving torque T follow its mean M, its swing about the mean, and the flywheel that keeps the speed even: the
driving shaft takes in M evenly, and what it stores over the cycle is E(phi1), the integral of M - T.  A flywheel of
inertia J keeps the coefficient of speed fluctuation C = (largest - smallest speed) / mean speed where
J C w^2 = E_max - E_min (e.g. R. L. Norton, "Design of Machinery", 5th edition, 2012, section 11.11).  The torque is the
one at constant speed, so this holds for small C.

Gears whose carrying flanks cannot hold the torque, because their pressure angle reaches 90 degrees, are refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from math import degrees, pi, sqrt
from operator import attrgetter

import numpy as np

from ncgear.dynamics.mesh_force import MeshForce, MeshPlace, mesh_force
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine, Stretch, angles_at, stretches
from ncgear.mechanisms.forces import CrankPace, EvenPace, JointForces
from ncgear.mechanisms.masses import Masses
from ncgear.numerics.arrays import Array, Mask, distinct
from ncgear.numerics.chebyshev import PiecewiseChebyshev, fitted
from ncgear.numerics.extrema import Extremum, extremes, grid_between
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import in_words
from ncgear.numerics.zeros import all_zeros


@dataclass(frozen=True, eq=False)
class Loads:
    """What a motion needs, as jets by the driving angle; forces in N, torques in N mm.

    ``driving_torque`` is asked of the driving shaft, ``driven_torque`` of the driven gear.  ``joints`` are the forces
    between the bodies of the mechanism, by its names for them and on the body nearer to the slider; ``crank_bearing``
    acts on the crank shaft, ``guide`` on the slider across its line, the mesh force on the driven gear.  The driving
    shaft's bearings exert the same force as the mesh.  Without gears (``mesh`` None) the crank's bearing holds the
    mechanism alone.
    """

    driving_torque: Jet
    driven_torque: Jet
    joints: Mapping[str, Vector]
    crank_bearing: Vector
    guide: Jet
    mesh: MeshForce | None

    @property
    def mesh_force(self) -> MeshForce:
        """The mesh force of a machine that has gears."""
        assert self.mesh is not None
        return self.mesh


@dataclass(frozen=True, eq=False)
class RigidMachine:
    """A machine at constant driving speed and its moving masses; ``place`` is how its gears lie, None without gears."""

    machine: Machine
    masses: Masses
    place: MeshPlace | None = None

    def loads(self, driven_angle: Jet, resistance_n: Jet) -> Loads:
        """The loads for a crank angle that is a jet by the driving angle; loads and resistance have two orders less."""
        pace = EvenPace(self.machine.speed_rad_s)
        joints = self.machine.linkage.joint_forces(driven_angle, self.masses, pace, resistance_n)
        slope, torque = driven_angle.differentiated(), joints.torque_n_mm
        mesh = None if self.place is None else mesh_force(self.place, slope, torque)
        return Loads(
            driving_torque=slope.truncated(torque.order) * torque,
            driven_torque=torque,
            joints=joints.joints,
            crank_bearing=joints.crank_axis if mesh is None else joints.crank_axis - mesh.force,
            guide=joints.guide_n,
            mesh=mesh,
        )

    def at(self, phi1: Array) -> Loads:
        """The loads at driving angles in rad, shape (n,); right-hand limits at joints of the law."""
        driven = self.machine.transmission.driven_angle(phi1, 2)
        return self.loads(driven, self._resistance_n(driven.truncated(0), ~self.machine.working(driven.value)))

    def joints(self, crank_angle_rad: Array, pace: CrankPace) -> JointForces:
        """Forces in the joints for any motion of the crank, at crank angles in rad, shape (n,)."""
        angle = Jet.variable(crank_angle_rad, 2)
        resistance = self._resistance_n(angle.truncated(0), ~self.machine.working(crank_angle_rad))
        return self.machine.linkage.joint_forces(angle, self.masses, pace, resistance.value)

    def on(self, stretch: Stretch, phi1: Array) -> Loads:
        """The loads with their slopes at driving angles on a stretch, shape (n,); one-sided at its ends."""
        driven = stretch.driven_angle(phi1, 3)
        return self.loads(driven, self._resistance_n(driven.truncated(1), np.full(phi1.shape, not stretch.working)))

    def breaks(self, stretch: Stretch) -> Array:
        """Driving angles of a stretch, ends included, between which loads are smooth and the resistance is monotone."""
        corners = self.machine.load.corners_mm(self.machine.linkage.stroke_mm, not stretch.working)
        passed = angles_at(stretch, corners)
        return distinct([stretch.start_rad, *stretch.knots_rad, *passed, stretch.end_rad])

    def _resistance_n(self, driven_angle: Jet, returning: Mask) -> Jet:
        """The load of the slider along -x, with derivatives."""
        return self.machine.load.backwards_jet_n(self.machine.linkage.displacement(driven_angle), returning)


IDLE = 1e-9
"""Share of the largest torque below which flanks carry nothing: far above rounding errors, far below any real load."""

KG_MM2 = 1e3
"""One N mm s^2 in kg mm^2."""


@dataclass(frozen=True, eq=False)
class Fluctuation:
    """The driving torque in N mm over the driving angle, as piecewise Chebyshev forms of one cycle."""

    torque: PiecewiseChebyshev
    speed_rad_s: float

    @cached_property
    def work(self) -> PiecewiseChebyshev:
        """Work of the driving torque from phi1 = 0 on, in N mm."""
        return self.torque.integrated()

    @property
    def work_n_mm(self) -> float:
        """Work of one cycle."""
        return self.work.final

    @property
    def mean_torque_n_mm(self) -> float:
        """Mean over the cycle."""
        return self.work_n_mm / float(np.ptp(self.torque.breaks))

    @cached_property
    def stored_range_n_mm(self) -> tuple[Extremum, Extremum]:
        """Smallest and largest energy stored in the driving shaft, counted from phi1 = 0, in N mm."""
        breaks, mean = self.torque.breaks, self.mean_torque_n_mm

        def stored(phi1: Array) -> Jet:
            return Jet(np.stack([mean * (phi1 - breaks[0]) - self.work(phi1), mean - self.torque(phi1)]))

        return extremes(stored, float(breaks[0]), float(breaks[-1]), breaks)

    @property
    def swing_n_mm(self) -> float:
        """Largest less smallest energy stored."""
        low, high = self.stored_range_n_mm
        return high.value - low.value

    @cached_property
    def flank_changes_rad(self) -> Array:
        """Driving angles in the cycle at which the torque changes its sign, and the other flanks carry, shape (m,)."""
        places = np.union1d(all_zeros(self.torque), self.torque.breaks)
        middles = self.torque((places[1:] + places[:-1]) / 2.0)
        carried = np.abs(middles) > IDLE * np.abs(middles).max()
        starts, signs = places[:-1][carried], np.sign(middles[carried])
        changes: Array = starts[signs != np.roll(signs, 1)]
        return changes

    def flywheel_kg_mm2(self, coefficient: float) -> float:
        """Inertia on the driving shaft, its gear included, for a coefficient of speed fluctuation (0 to about 0.2)."""
        return KG_MM2 * self.swing_n_mm / (coefficient * self.speed_rad_s**2)


def fluctuation(rigid: RigidMachine) -> Fluctuation:
    """The driving torque of one cycle."""
    breaks = [rigid.breaks(stretch) for stretch in stretches(rigid.machine)]
    edges = np.concatenate([*(part[:-1] for part in breaks), breaks[-1][-1:]])
    torque = fitted(lambda phi1: rigid.at(phi1).driving_torque.value, edges)
    return Fluctuation(torque, rigid.machine.speed_rad_s)


def refuse_locked(rigid: RigidMachine) -> None:
    """Raises NoSuchMechanism, with the driving angle, where flanks carry at a pressure angle of 90 degrees or more."""
    for stretch in stretches(rigid.machine) if rigid.place else ():
        breaks = rigid.breaks(stretch)
        steepest = extremes(
            partial(_along, rigid, stretch, lambda loads: loads.mesh_force.pressure_angle_rad),
            stretch.start_rad,
            stretch.end_rad,
            breaks,
        )[1]
        phi1 = np.append(grid_between(stretch.start_rad, stretch.end_rad, breaks), steepest.at)
        loads = rigid.on(stretch, phi1)
        refuse_locked_at(phi1, loads.driven_torque.value, loads.mesh_force.pressure_angle_rad.value)


def refuse_locked_at(phi1_rad: Array, torque: Array, pressure_angle_rad: Array) -> None:
    """Raises as ``refuse_locked``, by torques on the driven gear and pressure angles at driving angles, shape (n,)."""
    locked = (np.abs(torque) > IDLE * np.abs(torque).max()) & (pressure_angle_rad >= pi / 2.0)
    if locked.any():
        worst = int(np.argmax(np.where(locked, pressure_angle_rad, 0.0)))
        flanks = "push the driven gear" if torque[worst] > 0.0 else "hold the driven gear back"
        raise NoSuchMechanism(
            f"the teeth cannot {flanks} at phi1 = {in_words(float(phi1_rad[worst]))}, where their pressure angle is "
            f"{degrees(pressure_angle_rad[worst]):.4g} deg; under 90 deg is needed: a law whose ratio changes more "
            "slowly there",
            key="motion",
        )


Broken = tuple[Stretch, Array]
"""A stretch with the driving angles between which its loads are smooth."""


@dataclass(frozen=True)
class MeshPeak:
    """Largest mesh force in N and the pressure angle in rad there."""

    force_n: Extremum
    pressure_angle_rad: float


@dataclass(frozen=True)
class LoadPeaks:
    """Extreme driving torques in N mm and largest sizes of forces in N, with the driving angles of each."""

    most_torque_n_mm: Extremum
    least_torque_n_mm: Extremum
    joints_n: Mapping[str, Extremum]
    crank_bearing_n: Extremum
    guide_n: Extremum
    mesh: MeshPeak | None


def broken_cycle(rigid: RigidMachine) -> list[Broken]:
    """The stretches of one cycle."""
    return [(stretch, rigid.breaks(stretch)) for stretch in stretches(rigid.machine)]


def load_peaks(rigid: RigidMachine) -> LoadPeaks:
    """Peaks over one cycle."""
    cycle = broken_cycle(rigid)
    least, most = range_over(rigid, cycle, lambda loads: loads.driving_torque)
    return LoadPeaks(
        most_torque_n_mm=most,
        least_torque_n_mm=least,
        joints_n={name: largest_over(rigid, cycle, _joint(name)) for name in rigid.machine.linkage.JOINTS},
        crank_bearing_n=largest_over(rigid, cycle, lambda loads: loads.crank_bearing),
        guide_n=largest_over(rigid, cycle, lambda loads: Vector(loads.guide, loads.guide * 0.0)),
        mesh=None if rigid.place is None else _mesh_peak(rigid, cycle),
    )


def _joint(name: str) -> Callable[[Loads], Vector]:
    return lambda loads: loads.joints[name]


def _mesh_peak(rigid: RigidMachine, cycle: Sequence[Broken]) -> MeshPeak:
    found = [(part, range_over(rigid, [part], lambda loads: loads.mesh_force.size_n)[1]) for part in cycle]
    (stretch, _), highest = max(found, key=lambda item: item[1].value)
    angle = rigid.on(stretch, np.array([highest.at])).mesh_force.pressure_angle_rad
    return MeshPeak(highest, float(angle.value[0]))


def largest_over(rigid: RigidMachine, cycle: Sequence[Broken], vector: Callable[[Loads], Vector]) -> Extremum:
    """Largest length of a vector over the stretches, with the driving angle in rad."""
    highest = range_over(rigid, cycle, lambda loads: vector(loads).dot(vector(loads)))[1]
    return Extremum(sqrt(highest.value), highest.at)


def range_over(
    rigid: RigidMachine, cycle: Sequence[Broken], quantity: Callable[[Loads], Jet]
) -> tuple[Extremum, Extremum]:
    """Smallest and largest value over the stretches, with their driving angles in rad."""
    ranges = [
        extremes(partial(_along, rigid, stretch, quantity), stretch.start_rad, stretch.end_rad, breaks)
        for stretch, breaks in cycle
    ]
    value = attrgetter("value")
    return min((low for low, _ in ranges), key=value), max((high for _, high in ranges), key=value)


def _along(rigid: RigidMachine, stretch: Stretch, quantity: Callable[[Loads], Jet], phi1: Array) -> Jet:
    return quantity(rigid.on(stretch, phi1))


@dataclass(frozen=True, eq=False)
class Rigid:
    """A machine, its peaks and the swing of its torque; ``machine.at`` gives the curves."""

    machine: RigidMachine
    peaks: LoadPeaks
    fluctuation: Fluctuation


def rigid_level(machine: RigidMachine) -> Rigid:
    """Peaks and torque swing of a machine; raises NoSuchMechanism where its teeth cannot hold the torque."""
    refuse_locked(machine)
    return Rigid(machine, load_peaks(machine), fluctuation(machine))
