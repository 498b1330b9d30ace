"""Forces of the teeth for any motion of both gears: the touching pairs, their depth, and their moments on both gears.

The law of impact is that of multi-body programs (MSC, "Adams/Solver" documentation, function IMPACT; after K. H.
Hunt, F. R. E. Crossley, J. Appl. Mech. 42 (1975), 440-445):

    F = max(0, k d^n + c(d) d'),   c(d) = c u^2 (3 - 2 u),   u = min(1, d / d_full)

at the depth d > 0, with d' its rate.  The stiffness k belongs to the pair at its place and changes with phi1; for
elastic teeth the exponent n is 1.  Friction is Coulomb's with a coefficient that depends on the speed of sliding.

The depth of a pair is a function of both angles, d = u l(phi1) (law(phi1) + e(phi1) - phi2), with e and the lever l
from the tables and u = +1 on pushing flanks, -1 on their backs.  Its normal force acts on either gear along the
gradient of d.  A pair stores V = k d^(n + 1) / (n + 1); where k changes with phi1, the driving gear has the further
moment -k' d^(n + 1) / (n + 1).  So the tables create no energy: the gears lose exactly the energy that the contact
stores and that its damping and friction take.

The force of all teeth on the driven gear as a vector follows from the speeds at which both gears pass along the
tangent.  Let t be the unit tangent, z the place of contact, a the way from the driving to the driven axis, and s = -1,
on a ring +1.  The arm t.(z - a) is the lever, and t.z = s t.(z - a) dphi2/dphi1 by the law of gearing; their difference
is t.a.  The tangential speeds give the component of a across t in the same way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ncgear.dynamics.gaps import ERROR, LEVER, STIFFNESS, Gaps, Near
from ncgear.dynamics.mesh_force import MeshPlace
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.periodic_table import PeriodicTable
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import in_words
from ncgear.pitch.shape import Gear


def ramp(share: Array) -> Array:
    """A cubic from 0 to 1 with slope 0 at both ends, for shares from 0 to 1."""
    risen: Array = share * share * (3.0 - 2.0 * share)
    return risen


@dataclass(frozen=True)
class Impact:
    """Exponent of the depth, and damping in N s/mm, which reaches its full value at a depth in mm.

    ``stiffness`` in N/mm^exponent is each pair's own; arrays of depths, rates and stiffnesses broadcast.
    """

    exponent: float
    damping_n_s_mm: float
    full_damping_depth_mm: float

    def elastic_n(self, depth_mm: Array, stiffness: Array | float) -> Array:
        """Force from the depth alone; 0 where bodies do not touch."""
        pressed: Array = stiffness * np.maximum(depth_mm, 0.0) ** self.exponent
        return pressed

    def damping(self, depth_mm: Array) -> Array:
        """c(d) in N s/mm."""
        return self.damping_n_s_mm * ramp(np.clip(depth_mm / self.full_damping_depth_mm, 0.0, 1.0))

    def force_n(self, elastic_n: Array, damped_n: Array) -> Array:
        """Force that presses the bodies apart, from depth and damping; they never pull."""
        return np.maximum(elastic_n + damped_n, 0.0)

    def energy_n_mm(self, depth_mm: Array, stiffness: Array | float) -> Array:
        """Stored energy of the elastic force, linear in the stiffness: the slope of one gives that of the other."""
        return self.elastic_n(depth_mm, stiffness) * np.maximum(depth_mm, 0.0) / (self.exponent + 1.0)

    def loss_n_mm_s(self, elastic_n: Array, damped_n: Array, rate_mm_s: Array) -> Array:
        """Power that damping takes.

        Where bodies part so fast that they no longer press each other, it takes all power of the elastic force.
        """
        return (np.maximum(elastic_n + damped_n, 0.0) - elastic_n) * rate_mm_s


@dataclass(frozen=True)
class Friction:
    """Static and dynamic coefficients, and the speeds in mm/s at which they are reached.

    The coefficient rises from 0 to the static value at ``static_mm_s`` and falls to the dynamic value at
    ``dynamic_mm_s``, both along cubics, as in multi-body programs.
    """

    static: float
    dynamic: float
    static_mm_s: float
    dynamic_mm_s: float

    def coefficient(self, speed_mm_s: Array) -> Array:
        """Coefficient with the sign of the speed of sliding."""
        speed = abs(speed_mm_s)
        rising = np.minimum(speed / self.static_mm_s, 1.0)
        falling = np.clip((speed - self.static_mm_s) / (self.dynamic_mm_s - self.static_mm_s), 0.0, 1.0)
        drop = (self.static - self.dynamic) * ramp(falling)
        signed: Array = np.sign(speed_mm_s) * (self.static * ramp(rising) - drop)
        return signed


@dataclass(frozen=True, eq=False)
class TwoShafts:
    """Angles in rad and speeds in rad/s of the driving and of the driven shaft; floats or arrays of one shape s."""

    phi1_rad: Array | float
    speed1_rad_s: Array | float
    phi2_rad: Array | float
    speed2_rad_s: Array | float


@dataclass(frozen=True, eq=False)
class ToothForces:
    """Forces of the pairs near contact, arrays of shape s + (slots,).

    ``depth_mm`` is minus the gap where a pair does not touch; ``normal_n`` is 0 there.  ``driving_n_mm`` and
    ``driven_n_mm`` are the moments on the gears, each in the sense in which its gear turns; ``loss_n_mm_s`` is the
    power that damping and friction take.  ``rubbing_n`` is the friction on the driven gear along the tangent that leads
    outwards from its axis.
    """

    near: Near
    depth_mm: Array
    normal_n: Array
    rubbing_n: Array
    driving_n_mm: Array
    driven_n_mm: Array
    loss_n_mm_s: Array


TOO_WEAK = "gears.face_width_mm"
"""The key of teeth whose own stiffness is too small for their load."""


@dataclass(frozen=True, eq=False)
class Meshing:
    """A law, its pairs of teeth, and their law of impact.

    ``stiffness_key`` is the key of a given stiffness; None for the teeth's own stiffness.
    """

    law: PeriodicTable
    gaps: Gaps
    impact: Impact
    friction: Friction
    stiffness_key: str | None = None

    def require_reach(self, phi1_rad: Array, error_rad: Array) -> None:
        """Refuse driven angles beyond the law's, shape (n,), at which teeth are deeper than the range of the tables.

        Raises NoSuchMechanism for the given stiffness, or else for the face width.
        """
        found = self.gaps.too_deep(phi1_rad, error_rad)
        if found is None:
            return
        angle, pressed = found
        cure = "wider teeth, larger ones, a stiffer material or less load are needed"
        raise NoSuchMechanism(
            f"at phi1 = {in_words(angle)} the load presses the driven gear {pressed:.3g} rad into the driving one, "
            "deeper than their teeth can be followed into each other; "
            f"{'a greater stiffness or less load is needed' if self.stiffness_key else cure}",
            key=self.stiffness_key or TOO_WEAK,
        )

    def stiffened(self, factor: float) -> Meshing:
        """The same teeth, each pair as many times as stiff."""
        return replace(self, gaps=self.gaps.stiffened(factor))

    def forces(self, shafts: TwoShafts) -> ToothForces:
        """Forces of all pairs near contact."""
        angle, ratio = self.law.at(shafts.phi1_rad)
        near, speeds = self.gaps.at(shafts.phi1_rad), (shafts.speed1_rad_s, shafts.speed2_rad_s)
        return self._near(near, _column(angle - shafts.phi2_rad) + near.error_rad, ratio, speeds)

    def beyond(self, phi1_rad: Array, side: Array, speed_rad_s: Array | float) -> Callable[[Array], ToothForces]:
        """Forces of the flanks of one side, +1 or -1, by the driven gear's angle beyond the law's; shape (n,) each.

        The driving shaft turns at ``speed_rad_s``, the driven shaft by the law.  Depths are known to rounding errors
        of the angles beyond the law's, however far the gears have turned.
        """
        ratio, near = self.law.at(phi1_rad)[1], self.gaps.at(phi1_rad)
        near = replace(near, urge=np.where(near.urge == _column(side), near.urge, 0.0))
        speeds = speed_rad_s, ratio * speed_rad_s
        return lambda ahead_rad: self._near(near, near.error_rad - _column(ahead_rad), ratio, speeds)

    def _near(
        self, near: Near, behind: Array, ratio: Array, speeds_rad_s: tuple[Array | float, Array | float]
    ) -> ToothForces:
        """Forces of pairs that the driven gear is so far ``behind`` of."""
        urge, lever, driving, driven = near.urge, near.lever_mm, near.driving_mm, near.driven_mm
        drift, lever_slope, stiffening = near.slopes
        speed1, speed2 = map(_column, speeds_rad_s)
        arm = urge * lever
        depth = arm * behind
        by_driving = urge * lever_slope * behind + arm * (_column(ratio) + drift)
        closing = by_driving * speed1 - arm * speed2
        sliding = driving * speed1 - driven * speed2
        elastic, damped = self.impact.elastic_n(depth, near.stiffness), self.impact.damping(depth) * closing
        normal = self.impact.force_n(elastic, damped)
        rubbing = self.friction.coefficient(sliding) * normal
        return ToothForces(
            near,
            depth,
            normal,
            rubbing,
            -normal * by_driving - self.impact.energy_n_mm(depth, stiffening) - rubbing * driving,
            normal * arm + rubbing * driven,
            self.impact.loss_n_mm_s(elastic, damped, closing) + abs(rubbing * sliding),
        )


def _column(values: Array | float) -> Array:
    return np.asarray(values)[..., None]


def force_on_driven(teeth: ToothForces, ratio: Array, place: MeshPlace) -> Vector:
    """Force in N in the frame of the mechanism, shape (n,); ``ratio`` is the law's dphi2/dphi1, shape (n,)."""
    along = tangent(teeth.near, ratio, place)
    across = 1j * along * place.mesh.sense * teeth.near.urge
    force = np.sum(teeth.normal_n * across + teeth.rubbing_n * along, axis=-1)
    # Where the driven gear turns the other way than in the pair's own frame, its mesh is looked at from behind.
    seen = np.conj(force) if place.mesh.sense != place.driven_sense else force
    turned = -seen * np.exp(1j * place.driving_axis_rad)
    return Vector(turned.real, turned.imag)


def tangent(near: Near, ratio: Array, place: MeshPlace) -> ComplexArray:
    """Unit tangents at the contacts, outwards from the driven axis, which lies along +x from the driving axis."""
    sense, distance = place.mesh.sense, place.center_distance_mm
    own = ratio[..., None] + near.slopes[0]
    along: ComplexArray = near.lever_mm * (sense * own - 1.0) + 1j * (near.driving_mm - sense * near.driven_mm)
    return along / distance


HARDEST = 20.0
"""Largest torque of a knock for which pairs are counted, over the largest demanded torque."""

NearPairs = list[list[list[float]]] | Array
"""The arm, the touching angle, the stiffness, the rate of that angle in rad/s and the arm with friction of each of some
pairs, for either side of the teeth, the pairs that touch first before the others; of many, an array (5, pairs)."""

MANY = 16
"""Number of pairs, as of sections of helical teeth, from which arrays are faster than plain numbers."""


def near_sides(
    meshing: Meshing, phi1_rad: Array, speed_rad_s: Array | float, most_n_mm: float, turned: Gear = Gear.DRIVEN
) -> tuple[tuple[Array, Array], Array]:
    """The pairs on pushing flanks and on backs at n driving angles and speeds of the driving gear, their largest lever.

    Shape (n, pairs, 5) with the quantities of ``NearPairs``, and (n,).  Pairs count that a torque of HARDEST times the
    largest torque presses together.  Arms with friction are those of the gear that is ``turned``; the driving gear is
    turned back.
    """
    gaps, speed, slope = meshing.gaps, np.reshape(speed_rad_s, (-1, 1)), meshing.law.at(phi1_rad)[1][:, None]
    index, errors = gaps.table.place(phi1_rad)[1], gaps.table.values(phi1_rad, ERROR)
    sides = list[Array]()
    for side in (1.0, -1.0):
        slots = _reached(gaps, index, np.where(gaps.urge[index] == side, side * errors, -np.inf), most_n_mm)
        near = gaps.at(np.broadcast_to(phi1_rad[:, None], slots.shape), slots)
        # Empty places have no arm, so that they never touch.
        arm = np.where(near.urge == side, side * near.lever_mm, 0.0)
        rub = meshing.friction.coefficient((near.driving_mm - near.driven_mm * slope) * speed)
        turning = (arm + rub * near.driven_mm) if turned is Gear.DRIVEN else (slope * arm + rub * near.driving_mm)
        columns = arm, near.error_rad, near.stiffness, near.slopes[0] * speed, np.where(arm, turning, 0.0)
        sides.append(np.stack(columns, axis=-1))
    levers = np.max([np.abs(side[..., 0]).max(axis=-1) for side in sides], axis=0)
    return (sides[0], sides[1]), levers


def _reached(gaps: Gaps, index: IndexArray, ahead: Array, most_n_mm: float) -> IndexArray:
    """The slots, shape (n, pairs), that the hardest torque presses in intervals, the first to touch before the others.

    ``ahead`` (shape (n, slots)) is how far ahead the slots of a side touch, -inf for all others.  The pairs that touch
    before another bear Sum k a^2 (d - d_i) when this one touches at the depth d.  One slot is kept of a toothless side.
    """
    order = np.argsort(-ahead, axis=-1)
    own = np.take_along_axis(ahead, order, axis=-1)
    reached, behind = np.isfinite(own), np.zeros(own.shape)
    np.subtract(own[:, :1], own, out=behind, where=reached)
    turning = (gaps.table.coefficients[-1, ..., STIFFNESS] * gaps.table.coefficients[-1, ..., LEVER] ** 2)[index]
    turning = np.take_along_axis(turning, order, axis=-1)
    before = behind[:, 1:] * np.cumsum(turning, axis=1)[:, :-1] - np.cumsum(behind * turning, axis=1)[:, :-1]
    reached[:, 1:] &= before < HARDEST * most_n_mm
    return order[:, : max(1, int(np.count_nonzero(reached, axis=-1).max()))]


def in_numbers(sides: tuple[Array, Array]) -> NearPairs:
    """The pairs of both sides at one driving angle, shape (pairs, 5) each, as ``moments_n_mm`` takes them fastest."""
    if len(sides[0]) + len(sides[1]) > MANY:
        return np.concatenate(sides).T
    return [sides[0].tolist(), sides[1].tolist()]


def near_pairs(
    meshing: Meshing, phi1_rad: Array, speed_rad_s: Array | float, most_n_mm: float, turned: Gear = Gear.DRIVEN
) -> tuple[list[NearPairs], Array]:
    """The pairs of ``near_sides`` at each of n driving angles, and their largest levers, shape (n,)."""
    sides, levers = near_sides(meshing, phi1_rad, speed_rad_s, most_n_mm, turned)
    return [in_numbers(both) for both in zip(*sides, strict=True)], levers


def moments_of_arrays(
    impact: Impact, pairs: Array, ahead_rad: Array | float, speed_rad_s: Array | float, later_s: Array | float
) -> tuple[Array, Array]:
    """As ``moments_n_mm``, of pairs in an array (5, pairs) at one place, or (5, pairs, n) at n places, shape (n,)."""
    arms, errors, stiffnesses, rates, rubbed = pairs
    depths = arms * (errors + later_s * rates - ahead_rad)
    damped = impact.damping(depths) * arms * (rates - speed_rad_s)
    force = impact.force_n(impact.elastic_n(depths, stiffnesses), damped)
    return (arms * force).sum(axis=0), (rubbed * force).sum(axis=0)


def moments_n_mm(
    impact: Impact, pairs: NearPairs, ahead_rad: float, speed_rad_s: float, later_s: float = 0.0
) -> tuple[float, float]:
    """The moments of touching pairs on the driven side, of their normal forces and with friction.

    ``ahead_rad`` and ``speed_rad_s`` are the driven side's angle and speed beyond the law's.  The pairs are
    those of a time ``later_s`` ago.
    """
    if isinstance(pairs, np.ndarray):
        both = moments_of_arrays(impact, pairs, ahead_rad, speed_rad_s, later_s)
        return float(both[0]), float(both[1])
    # As Impact has them for arrays.
    exponent, full, deep = impact.exponent, impact.damping_n_s_mm, impact.full_damping_depth_mm
    normal = turning = 0.0
    for side in pairs:
        for arm, error_rad, stiffness, rate_rad_s, rubbed in side:
            depth = arm * (error_rad + later_s * rate_rad_s - ahead_rad)
            if depth <= 0.0:
                break
            share = depth / deep
            damping = full if share >= 1.0 else full * share * share * (3.0 - 2.0 * share)
            force = stiffness * depth**exponent + damping * arm * (rate_rad_s - speed_rad_s)
            if force > 0.0:
                normal += arm * force
                turning += rubbed * force
    return normal, turning
