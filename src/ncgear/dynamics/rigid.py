"""The rigid level: the forces and the driving torque that a motion at constant driving speed needs (inverse dynamics).

The law gives the crank's angle with its derivatives, the mechanism the forces in its joints, the pitch curves the force
between the teeth; all are closed forms, so peaks are located exactly: at stationary points, and on both sides of every
joint of the law.

From the driving torque T follow its mean M, its swing about the mean, and the flywheel that keeps the speed even: the
driving shaft takes in M evenly, and what it stores over the cycle is E(phi1), the integral of M - T.  A flywheel of
inertia J keeps the coefficient of speed fluctuation C = (largest - smallest speed) / mean speed where
J C w^2 = E_max - E_min (e.g. R. L. Norton, "Design of Machinery", 5th edition, 2012, section 11.11).  The torque is the
one at constant speed, so this holds for small C.

Where the guide rubs, the slider bears mu |N| against its motion besides its load.  N follows from all that the slider
bears along its line, and is affine in it: with N_0 of a guide without friction and N_1 of a resistance of 1 N,
|N| = |N_0| / (1 - mu N_1 sign(N_0)) on the way out, with a plus on the way back.  Where that is not positive the slider
jams in its guide, and the machine is refused.

Of two pairs in series, the shaft between them turns unevenly as well and takes its part of the torque.

Gears whose carrying flanks cannot hold the torque, because their pressure angle reaches 90 degrees, are refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from math import degrees, pi, sqrt
from operator import attrgetter

import numpy as np

from ncgear.dynamics.mesh_force import MeshForce, MeshPlace, mesh_force
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.kinematics.check import KinematicCheck, WithMasses
from ncgear.kinematics.motion import Machine, Stretch, angles_at, stretches
from ncgear.mechanisms.forces import CrankPace, EvenPace, JointForces
from ncgear.mechanisms.masses import Masses
from ncgear.numerics.arrays import Array, Mask, distinct
from ncgear.numerics.chebyshev import PiecewiseChebyshev, fitted
from ncgear.numerics.extrema import Extremum, extremes, grid_between
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector
from ncgear.numerics.quadrature import gauss_points
from ncgear.numerics.units import N_M_PER_N_MM, N_PER_KG_MM_S2, in_words
from ncgear.numerics.zeros import all_zeros
from ncgear.ratio.transmission import Transmission


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
    """A machine at constant driving speed with all that its design gives: the one loaded machine of every command.

    ``place`` is how its gears lie, None without gears.  ``guide_friction`` is the coefficient of friction between the
    slider and its guide.  ``between`` is the angle of the shaft between two pairs of gears over the driving angle, None
    of a single pair.  Raises NoSuchMechanism, once loads are asked for, where the slider jams in its guide.
    """

    machine: Machine
    masses: Masses
    place: MeshPlace | None = None
    guide_friction: float = 0.0
    between: Transmission | None = None

    def loads(self, phi1: Array, driven_angle: Jet, resistance_n: Jet, returning: Mask) -> Loads:
        """The loads at driving angles, shape (n,), for a crank angle that is a jet by them.

        Loads and resistance have two orders less than the angle; ``returning`` (shape (n,)) says which stroke it is.
        """
        pace = EvenPace(self.machine.speed_rad_s)
        joints = self._joints(driven_angle, pace, resistance_n, returning)
        slope, torque = driven_angle.differentiated(), joints.torque_n_mm
        mesh = None if self.place is None else mesh_force(self.place, slope, torque)
        return Loads(
            driving_torque=slope.truncated(torque.order) * torque + self._of_shaft_between(phi1, pace, torque.order),
            driven_torque=torque,
            joints=joints.joints,
            crank_bearing=joints.crank_axis if mesh is None else joints.crank_axis - mesh.force,
            guide=joints.guide_n,
            mesh=mesh,
        )

    def at(self, phi1: Array) -> Loads:
        """The loads at driving angles in rad, shape (n,); right-hand limits at joints of the law."""
        driven = self.machine.transmission.driven_angle(phi1, 2)
        returning = ~self.machine.working(driven.value)
        return self.loads(phi1, driven, self._resistance_n(driven.truncated(0), returning), returning)

    def joints(self, crank_angle_rad: Array, pace: CrankPace) -> JointForces:
        """Forces in the joints for any motion of the crank, at crank angles in rad, shape (n,), by a smooth guide."""
        angle = Jet.variable(crank_angle_rad, 2)
        resistance = self._resistance_n(angle.truncated(0), ~self.machine.working(crank_angle_rad))
        return self.machine.linkage.joint_forces(angle, self.masses, pace, resistance.value)

    def on(self, stretch: Stretch, phi1: Array) -> Loads:
        """The loads with their slopes at driving angles on a stretch, shape (n,); one-sided at its ends."""
        driven, returning = stretch.driven_angle(phi1, 3), np.full(phi1.shape, not stretch.working)
        return self.loads(phi1, driven, self._resistance_n(driven.truncated(1), returning), returning)

    def breaks(self, stretch: Stretch) -> Array:
        """Driving angles of a stretch, ends included, between which loads are smooth and the resistance is monotone."""
        corners = self.machine.load.corners_mm(self.machine.linkage.stroke_mm, not stretch.working)
        passed = angles_at(stretch, corners)
        breaks = distinct([stretch.start_rad, *stretch.knots_rad, *passed, stretch.end_rad])
        if not self.guide_friction:
            return breaks
        # Friction has a kink where the slider passes from one side of its guide to the other
        smooth = replace(self, guide_friction=0.0)
        guide = fitted(lambda phi1: smooth.on(stretch, phi1).guide.value, breaks)
        return distinct([*breaks, *all_zeros(guide)])

    def _joints(self, driven_angle: Jet, pace: EvenPace, resistance_n: Jet, returning: Mask) -> JointForces:
        """The forces in the joints, with what the guide's friction adds to the resistance."""
        linkage = self.machine.linkage
        smooth = linkage.joint_forces(driven_angle, self.masses, pace, resistance_n)
        if not self.guide_friction:
            return smooth
        one = linkage.joint_forces(driven_angle, linkage.MASSES(), pace, resistance_n * 0.0 + 1.0).guide_n
        side, way = np.where(smooth.guide_n.value < 0.0, -1.0, 1.0), np.where(returning, -1.0, 1.0)
        left = 1.0 - one * (self.guide_friction * way * side)
        if np.any(left.value <= 0.0):
            raise NoSuchMechanism(
                f"the slider jams in its guide at a coefficient of friction of {self.guide_friction:g}: the guide "
                f"presses on it with {np.abs(one.value).max():.3g} times what it bears along its line; a longer rod, "
                "or less friction, is right",
                key="drivetrain.guide_friction",
            )
        rubbing = smooth.guide_n * (self.guide_friction * way * side) / left
        return linkage.joint_forces(driven_angle, self.masses, pace, resistance_n + rubbing)

    def _of_shaft_between(self, phi1: Array, pace: EvenPace, order: int) -> Jet | float:
        """What the shaft between two pairs asks of the driving shaft to turn unevenly, in N mm."""
        if self.between is None or not self.masses.between_inertia_kg_mm2:
            return 0.0
        angle = self.between.driven_angle(phi1, order + 2)
        inertia = N_PER_KG_MM_S2 * self.masses.between_inertia_kg_mm2
        return angle.differentiated().truncated(order) * pace.second(angle) * inertia

    def _resistance_n(self, driven_angle: Jet, returning: Mask) -> Jet:
        """The load of the slider along -x, with derivatives."""
        return self.machine.load.backwards_jet_n(self.machine.linkage.displacement(driven_angle), returning)


NODES = 25
"""Gauss points of a panel: exact for the square of a form of degree 24, the degree of ``numerics.chebyshev``."""

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

    @property
    def rms_n_mm(self) -> float:
        """Root of the mean over the driving angle of the squared torque."""
        points, weights = gauss_points(self.torque.breaks, NODES)
        return sqrt(float(np.sum(weights * self.torque(points) ** 2)) / float(np.ptp(self.torque.breaks)))

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
    """Largest sizes of forces in N, with the driving angles of each."""

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
    return LoadPeaks(
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
class DrivingShaft:
    """What the driving shaft of a machine is asked for over one cycle at constant speed, with all that the file gives.

    Every command takes torque and power of the driving shaft from here.  Power is torque times speed: positive where
    the motor drives, negative where it brakes.
    """

    machine: RigidMachine

    @cached_property
    def torque_range_n_mm(self) -> tuple[Extremum, Extremum]:
        """Least and largest torque, with their driving angles."""
        return range_over(self.machine, broken_cycle(self.machine), lambda loads: loads.driving_torque)

    @cached_property
    def fluctuation(self) -> Fluctuation:
        """The torque over the cycle, with its mean, its root mean square, its work and its swing."""
        return fluctuation(self.machine)

    @property
    def peak_power_w(self) -> Extremum:
        """Largest power that the motor delivers; 0 where it never drives."""
        most = self.torque_range_n_mm[1]
        return Extremum(max(0.0, most.value) * self._w_per_n_mm, most.at)

    @property
    def braking_power_w(self) -> Extremum:
        """Largest power that flows back to the motor, as a size; 0 where none does but for rounding."""
        least, most = self.torque_range_n_mm
        brakes = -least.value > IDLE * max(-least.value, most.value)
        return Extremum((-least.value if brakes else 0.0) * self._w_per_n_mm, least.at)

    @property
    def mean_power_w(self) -> float:
        """Mean over the cycle."""
        return self.fluctuation.mean_torque_n_mm * self._w_per_n_mm

    @property
    def rms_torque_n_m(self) -> float:
        """Root of the mean over the driving angle of the squared torque."""
        return N_M_PER_N_MM * self.fluctuation.rms_n_mm

    @property
    def energy_swing_j(self) -> float:
        """What the driving shaft stores and gives back in a cycle where the motor's torque is even."""
        return N_M_PER_N_MM * self.fluctuation.swing_n_mm

    @property
    def _w_per_n_mm(self) -> float:
        return N_M_PER_N_MM * self.machine.machine.speed_rad_s


def counting_masses(check: KinematicCheck, shaft: DrivingShaft) -> KinematicCheck:
    """A check of the same machine with the power that its masses, and friction in its guide, ask for as well."""
    return replace(
        check,
        peak_power_w=shaft.peak_power_w,
        mean_power_w=shaft.mean_power_w,
        with_masses=WithMasses(
            peak_power_resistance_w=check.peak_power_w,
            braking_power_w=shaft.braking_power_w,
            rms_torque_n_m=shaft.rms_torque_n_m,
            energy_swing_j=shaft.energy_swing_j,
        ),
    )


@dataclass(frozen=True, eq=False)
class Rigid:
    """A machine, what its driving shaft is asked for, and its peaks; ``machine.at`` gives the curves."""

    machine: RigidMachine
    driving: DrivingShaft
    peaks: LoadPeaks

    @property
    def fluctuation(self) -> Fluctuation:
        """The driving torque of one cycle."""
        return self.driving.fluctuation


def rigid_level(driving: DrivingShaft, place: MeshPlace | None) -> Rigid:
    """The forces in a machine by its driving shaft and how its gears lie, None without gears.

    Raises NoSuchMechanism where its teeth cannot hold the torque.
    """
    machine = replace(driving.machine, place=place)
    refuse_locked(machine)
    return Rigid(machine, driving, load_peaks(machine))
