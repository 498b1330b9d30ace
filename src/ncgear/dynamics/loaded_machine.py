"""The loaded machine: the forces and the driving torque that a motion at constant driving speed needs.

The law gives the crank's angle with its derivatives, the mechanism the forces in its joints, the pitch curves the force
between the teeth (inverse dynamics); all are closed forms, so peaks are located exactly: at stationary points, and on
both sides of every joint of the law.

With friction in the guide, the slider has the force mu |N| against its motion besides its load.  N is an affine
function of the whole force along the slider's line: with N_0 of a guide without friction and N_1 of a resistance of 1
N, |N| = |N_0| / (1 - mu N_1 sign(N_0)) on the way out, with a plus on the way back.  Where that is negative the slider
jams, and the machine is refused.

Shafts between pairs in series turn unevenly as well and take their part of the torque.  A pair passes on the driving
torque that everything behind it needs: R_k = R_k+1 + J S' S'' w^2, with S the angle of the shaft between by the driving
angle, J its inertia, and R of the last pair the torque on the crank times dphi2/dphi1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import degrees, floor, sqrt, tan
from operator import attrgetter

import numpy as np

from ncgear.dynamics.mesh_force import MeshForce, MeshPlace, mesh_force
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine, Stretch, angles_at, stretches
from ncgear.mechanisms.forces import CrankPace, EvenPace, JointForces, Masses
from ncgear.numerics.arrays import Array, Mask, distinct
from ncgear.numerics.chebyshev import fitted
from ncgear.numerics.extrema import Extremum, extremes_on, grid_between
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.numerics.zeros import all_zeros
from ncgear.ratio.transmission import Transmission, turned_after


@dataclass(frozen=True, eq=False)
class Loads:
    """The loads of a motion as jets by the driving angle; forces in N, torques in N mm.

    ``driving_torque`` is the torque on the driving shaft, ``driven_torque`` that on the driven gear.  ``joints`` are
    the forces between the bodies of the mechanism, by its names for them and on the body nearer to the slider;
    ``crank_bearing`` acts on the crank shaft, ``guide`` on the slider across its line, the mesh force on the driven
    gear that turns the crank.  ``meshes_before`` are the meshes of the pairs before it in series, from the driving
    shaft on, whose bearings exert the same force as the first mesh.  ``passed`` are the parts of the driving torque
    that the pairs pass on.  Without gears (``mesh`` None) the crank's bearing holds the mechanism alone.
    """

    driving_torque: Jet
    driven_torque: Jet
    joints: Mapping[str, Vector]
    crank_bearing: Vector
    guide: Jet
    mesh: MeshForce | None
    meshes_before: tuple[MeshForce, ...] = ()
    passed: tuple[Jet, ...] = ()

    @property
    def between_bearings(self) -> tuple[Vector, ...]:
        """The forces of their bearings on the shafts between pairs of gears, from the driving shaft on."""
        return tuple(after.force - mesh.force for mesh, after in pairwise(self.meshes))

    @property
    def meshes(self) -> tuple[MeshForce, ...]:
        """All meshes, from the driving shaft on."""
        return self.meshes_before if self.mesh is None else (*self.meshes_before, self.mesh)

    @property
    def mesh_force(self) -> MeshForce:
        """The mesh force of a machine that has gears."""
        assert self.mesh is not None
        return self.mesh


@dataclass(frozen=True, eq=False)
class RigidMachine:
    """A machine at constant driving speed with all that its design gives: all commands use this loaded machine.

    ``place`` is the arrangement of its gears, None without gears; of pairs in series that of the last, behind
    ``places_before``.  ``guide_friction`` is the coefficient of friction between the slider and its guide.
    ``laws_before`` are the laws of the pairs before the last, from the driving shaft on, as far as they are known.
    Computing loads raises NoSuchMechanism where the slider jams in its guide.
    """

    machine: Machine
    masses: Masses
    place: MeshPlace | None = None
    guide_friction: float = 0.0
    laws_before: tuple[Transmission, ...] = ()
    places_before: tuple[MeshPlace, ...] = ()

    @property
    def places(self) -> tuple[MeshPlace, ...]:
        """The places of all pairs of gears, from the driving shaft on."""
        return self.places_before if self.place is None else (*self.places_before, self.place)

    def angles(self, phi1: Array, order: int) -> list[Jet]:
        """The angles of all shafts, from the driving shaft on, as jets by the driving angle, shape (n,)."""
        first, last = Jet.variable(phi1, order), self.machine.transmission.driven_angle(phi1, order)
        return [first, *turned_after(self.laws_before, phi1, order), last]

    def loads(
        self,
        phi1: Array,
        driven_angle: Jet,
        resistance_n: Jet,
        returning: Mask,
        of_law: Jet | None = None,
        borne: Sequence[Array] = (),
    ) -> Loads:
        """The loads at driving angles, shape (n,), for a crank angle as a jet by them.

        Loads and resistance have two orders less than the angle; ``returning`` (shape (n,)) tells the stroke.
        ``of_law`` is the crank angle of the law that the gears were made for, where it is another angle, and ``borne``
        are the torques in N mm on the driven gears before the last, shape (n,), where these knock.
        """
        pace = EvenPace(self.machine.speed_rad_s)
        joints = self._joints(driven_angle, pace, resistance_n, returning)
        slope, torque = (of_law or driven_angle).differentiated(), joints.torque_n_mm
        between = turned_after(self.laws_before, phi1, driven_angle.order)
        passed = self._passed(slope.truncated(torque.order) * torque, between, pace)
        knocked = [Jet((torque * angle.derivative(1))[None]) for torque, angle in zip(borne, between, strict=False)]
        passed = (*knocked, *passed[len(knocked) :])
        mesh, meshes_before = self.meshes(slope, torque, between, passed)
        return Loads(
            driving_torque=passed[0],
            driven_torque=torque,
            joints=joints.joints,
            crank_bearing=joints.crank_axis if mesh is None else joints.crank_axis - mesh.force,
            guide=joints.guide_n,
            mesh=mesh,
            meshes_before=meshes_before,
            passed=passed,
        )

    def at(self, phi1: Array, beyond: Array | None = None, borne: Sequence[Array] = ()) -> Loads:
        """The loads at driving angles in rad, shape (n,); right-hand limits at joints of the law.

        ``beyond`` (shape (n,)) is the excess of d2phi2/dphi1^2 over the law's, as where teeth part and knock, and
        ``borne`` are the torques on the driven gears of the pairs before the last then.
        """
        driven = of_law = self.machine.transmission.driven_angle(phi1, 2)
        if beyond is not None:
            driven = of_law + Jet(np.stack([0.0 * beyond, 0.0 * beyond, beyond / 2.0]))
        returning = ~self.machine.working(driven.value)
        resistance_n = self._resistance_n(driven.truncated(0), returning)
        return self.loads(phi1, driven, resistance_n, returning, of_law, borne)

    def coming_back(self, phi1: Array) -> Loads:
        """The loads at driving angles in rad, shape (n,), on the way back of gears that turn less than once."""
        driven, returning = self.machine.transmission.driven_angle(phi1, 2), np.ones(phi1.shape, dtype=bool)
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
        """The forces in the joints, with the guide's friction added to the resistance."""
        linkage = self.machine.linkage
        smooth = linkage.joint_forces(driven_angle, self.masses, pace, resistance_n)
        if not self.guide_friction:
            return smooth
        rub, one, jams = self._rubbing(smooth, driven_angle, pace, resistance_n, returning)
        if np.any(jams):
            raise self._jammed(pace, driven_angle, resistance_n, returning)
        rubbing = smooth.guide_n * rub / (1.0 - one * rub)
        return linkage.joint_forces(driven_angle, self.masses, pace, resistance_n + rubbing)

    def _rubbing(
        self, smooth: JointForces, driven_angle: Jet, pace: EvenPace, resistance_n: Jet, returning: Mask
    ) -> tuple[Array, Jet, Mask]:
        """Friction against the way for each N on the guide, force on it for each N of load, and whether it jams."""
        linkage = self.machine.linkage
        one = linkage.joint_forces(driven_angle, linkage.MASSES(), pace, resistance_n * 0.0 + 1.0).guide_n
        side, way = np.where(smooth.guide_n.value < 0.0, -1.0, 1.0), np.where(returning, -1.0, 1.0)
        rub = self.guide_friction * way * side
        left = 1.0 - one.value * rub
        # A slider that presses on nothing does not jam, though it may be held once something presses
        return rub, one, (left <= 0.0) & ((smooth.guide_n.value != 0.0) | (left == 0.0))

    def _jammed(self, pace: EvenPace, driven_angle: Jet, resistance_n: Jet, returning: Mask) -> NoSuchMechanism:
        """The refusal of a slider that jams, at the even step of the cycle with the largest force on the guide.

        So every command names the same place, or one of the given angles where it jams between the steps only.
        """
        linkage, transmission = self.machine.linkage, self.machine.transmission
        driven = transmission.driven_angle(np.linspace(0.0, transmission.cycle_rad, JAM_STEPS, endpoint=False), 2)
        back = ~self.machine.working(driven.value)
        even = driven, self._resistance_n(driven.truncated(0), back), back
        for angle, load, returns in (even, (driven_angle, resistance_n, returning)):
            smooth = linkage.joint_forces(angle, self.masses, pace, load)
            _, one, jams = self._rubbing(smooth, angle, pace, load, returns)
            if np.any(jams):
                break
        worst = int(np.argmax(np.where(jams, np.abs(one.value), -np.inf)))
        at, pressed = degrees(float(angle.value[worst])) % 360.0, abs(float(one.value[worst]))
        slides = tan(linkage.least_transmission()[0])
        return NoSuchMechanism(
            f"the slider jams in its guide at a coefficient of friction of {self.guide_friction:g}: on its way "
            f"{'back' if returns[worst] else 'out'}, at a crank angle of {at:.4g} deg, the guide presses on it "
            f"with {pressed:.3g} times what it bears along its line; a longer rod, or a coefficient under "
            f"{floor(1e4 * slides) / 1e4:.4g}, is right",
            key="drivetrain.guide_friction",
        )

    def meshes(
        self, slope: Jet, torque: Jet, between: Sequence[Jet], passed: Sequence[Jet]
    ) -> tuple[MeshForce | None, tuple[MeshForce, ...]]:
        """The mesh that turns the crank, and those before it; ``slope`` and ``torque`` are the crank's."""
        if self.place is None:
            return None, ()
        if not between:
            return mesh_force(self.place, slope, torque), ()
        before, even = list[MeshForce](), slope * 0.0 + 1.0
        driving, turning = even, even.truncated(torque.order)
        for place, angle, passing in zip(self.places_before, between, passed, strict=False):
            speed = angle.differentiated()
            turned = speed.truncated(torque.order)
            before.append(mesh_force(place, speed / driving, passing / turned, turning))
            driving, turning = speed, turned
        return mesh_force(self.place, slope / driving, torque, turning), tuple(before)

    def _passed(self, last: Jet, between: Sequence[Jet], pace: EvenPace) -> tuple[Jet, ...]:
        """The parts of the driving torque in N mm that the pairs pass on, for that of the ``last``."""
        passed, inertias = [last], self.masses.between_inertia_kg_mm2 or (0.0,) * len(between)
        for angle, inertia in zip(reversed(between), reversed(inertias), strict=False):
            turning = angle.differentiated().truncated(last.order) * pace.second(angle)
            passed.append(passed[-1] + turning * (N_PER_KG_MM_S2 * inertia))
        return tuple(reversed(passed))

    def _resistance_n(self, driven_angle: Jet, returning: Mask) -> Jet:
        """The load of the slider along -x, with derivatives."""
        return self.machine.load.backwards_jet_n(self.machine.linkage.displacement(driven_angle), returning)


JAM_STEPS = 3600
"""Steps of a cycle in the search for the worst place of a jammed slider: tenths of a degree, as in the message."""

IDLE = 1e-9
"""Share of the largest torque below which flanks carry nothing: far above rounding errors, far below any real load."""

Broken = tuple[Stretch, Array]
"""A stretch with the driving angles between which its loads are smooth."""


def broken_cycle(rigid: RigidMachine) -> list[Broken]:
    """The stretches of one cycle."""
    return [(stretch, rigid.breaks(stretch)) for stretch in stretches(rigid.machine)]


def largest_over(rigid: RigidMachine, cycle: Sequence[Broken], vector: Callable[[Loads], Vector]) -> Extremum:
    """Largest length of a vector over the stretches, with the driving angle in rad."""
    highest = range_over(rigid, cycle, lambda loads: vector(loads).dot(vector(loads)))[1]
    return Extremum(sqrt(highest.value), highest.at)


def range_over(
    rigid: RigidMachine, cycle: Sequence[Broken], quantity: Callable[[Loads], Jet]
) -> tuple[Extremum, Extremum]:
    """Smallest and largest value over the stretches, with their driving angles in rad."""
    ranges = [ranges_on(rigid, part, lambda loads: [quantity(loads)])[0] for part in cycle]
    value = attrgetter("value")
    return min((low for low, _ in ranges), key=value), max((high for _, high in ranges), key=value)


def ranges_on(
    rigid: RigidMachine, part: Broken, quantities: Callable[[Loads], list[Jet]]
) -> list[tuple[Extremum, Extremum]]:
    """Smallest and largest value of each of several quantities of the loads on a stretch, with the driving angles."""
    stretch, breaks = part
    grid = grid_between(stretch.start_rad, stretch.end_rad, breaks)
    return extremes_on(lambda phi1: quantities(rigid.on(stretch, phi1)), grid)
