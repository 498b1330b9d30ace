"""Losses by friction: between the teeth and at the slider's guide, the efficiency, and the demand on the shaft.

Between the teeth, as H. Ohlendorf, "Verlustleistung und Erwaermung von Stirnraedern", dissertation, TU Muenchen 1958
(from secondary sources), for circular gears, but integrated over the contacts of the exact teeth of any pair:

    loss = mu H |T1|,   H = integral of sum(F |v|) dphi1 / integral of |T1| dphi1

with the normal force F of each pair of flanks that touches, its speed of sliding v in mm per rad of phi1, and the
torque T1 of the driving shaft.  Pairs that touch together share the force alike, as in his closed form, which holds for
circular gears under an even load with 1 to 2 pairs in contact:

    H_V = pi (1/z1 + 1/z2) (1 - e1 - e2 + e1^2 + e2^2),   e1, e2: contact ratios before and behind the pitch point

The force is taken without friction between the teeth, so the loss is of first order in mu.  The guide takes mu |N|
times the slider's way, with the force N of the rigid level, which counts that friction itself.

The demand on the driving shaft: at the speed w_0 the torque is T = T1 + share |T1|, with the torque T1 of the rigid
level, which counts friction in the guide, and the share that the teeth take.  A machine that turns at another speed w
has the energy J(phi) w^2 / 2, with everything that moves in the inertia J reduced to the driving shaft,

    J = J_shaft + M(phi2) phi2'^2 + sum of J_between S'^2

where M is the crank's reduced inertia (``ncgear.dynamics.crank_load``) and S the angle of a shaft between two pairs.
The part of T that accelerates masses at constant speed is J' w_0^2 / 2; the rest, A = T - J' w_0^2 / 2, is needed at
any speed.  So

    d(J w^2 / 2) / dphi = T_drive - A

holds for any motion; friction is taken as at w_0.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import cos, radians

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned, PairTouch, touch_at
from ncgear.contact.designed.curves import Contacts
from ncgear.contact.placement import BACK, PUSHING, Placement, placed_at
from ncgear.drivetrain.cycle import Cycle, with_tooth_friction
from ncgear.dynamics.crank_load import reduced_inertia
from ncgear.dynamics.driving_shaft import Fluctuation
from ncgear.dynamics.loaded_machine import IDLE
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.chebyshev import fitted
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.highest import range_of
from ncgear.numerics.jet import Jet
from ncgear.numerics.quadrature import gauss_points
from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.gear import ToothedPair

HALVINGS = 16
"""Halvings to the angles at which a pair meets or parts: a twentieth of a pitch to less than 1e-6."""

NODES = 4
"""Gauss points between two angles at which pairs meet, part or pass the pitch point: loads are smooth there."""

BLOCK = 1024
"""Positions computed together, so that pairs with many meetings do not fill the memory."""


@dataclass(frozen=True, eq=False)
class Losses:
    """Work in N mm per cycle at even speed.

    ``useful_n_mm`` excludes the guide's.  ``mesh_loss_factors`` are H of all pairs of gears; empty where not known.
    """

    useful_n_mm: float
    moved_n_mm: float
    mesh_loss_factors: tuple[float, ...]
    mesh_friction: float
    guide_friction: float
    guide_n_mm: float

    @property
    def mesh_shares(self) -> tuple[float, ...]:
        """Shares of its torque's size that friction between the teeth of each pair takes."""
        return tuple(self.mesh_friction * factor for factor in self.mesh_loss_factors)

    @property
    def mesh_share(self) -> float:
        """Share of the driving torque's size that friction between all teeth takes."""
        return float(sum(self.mesh_shares))

    @property
    def mesh_loss_factor(self) -> float | None:
        """H of all pairs together; None where it is not known."""
        return float(sum(self.mesh_loss_factors)) if self.mesh_loss_factors else None

    @property
    def mesh_n_mm(self) -> float:
        """Work that friction between the teeth takes."""
        return self.mesh_share * self.moved_n_mm

    @property
    def efficiency(self) -> float | None:
        """Useful work over the work of the driving shaft; None for a machine that does no work but for rounding."""
        if self.useful_n_mm <= IDLE * self.moved_n_mm:
            return None
        return self.useful_n_mm / (self.useful_n_mm + self.mesh_n_mm + self.guide_n_mm)


def losses_of(cycle: Cycle, mesh_loss_factors: tuple[float, ...], mesh_friction: float) -> Losses:
    """The losses of a cycle whose loads do not count friction between the teeth."""
    loads, guide_friction = cycle.loads, cycle.rigid.guide_friction
    guide_n_mm = guide_friction * cycle.integral(np.abs(loads.guide_n * loads.way_mm))
    return Losses(
        useful_n_mm=cycle.integral(loads.driving_torque_n_mm) - guide_n_mm,
        moved_n_mm=cycle.integral(np.abs(loads.driving_torque_n_mm)),
        mesh_loss_factors=mesh_loss_factors,
        mesh_friction=mesh_friction,
        guide_friction=guide_friction,
        guide_n_mm=guide_n_mm,
    )


@dataclass(frozen=True, eq=False)
class TouchingTeeth:
    """Contacts at any rolled length of the cycle of meetings; flanks and backs each as if they alone bore load."""

    teeth: ToothedPair
    pitch: PitchPair
    designed: AsDesigned

    @property
    def even(self) -> Placement:
        """Evenly spaced positions of the cycle."""
        return self.designed.placement

    @cached_property
    def _touch(self) -> Callable[[Placement], PairTouch]:
        return touch_at(self.teeth)

    def at(self, rolled_mm: Array) -> list[PairTouch]:
        """The contacts at rolled lengths, shape (n,), in blocks of positions."""
        inside = np.mod(rolled_mm, self.even.cycle_mm)
        blocks = np.split(inside, range(BLOCK, inside.size, BLOCK))
        return [self._touch(placed_at(self.pitch, self.even, block)) for block in blocks]

    @cached_property
    def breaks_mm(self) -> Array:
        """Rolled lengths at which a pair meets, parts or passes the pitch point, from 0 to the cycle's end."""
        whole = self.even.cycle_mm
        own = self.teeth.driving.flanks.crossing_mm
        turns = self.pitch.driving.length_mm * np.arange(round(whole / self.pitch.driving.length_mm))
        crossings = np.mod(own + turns[:, None], whole).ravel()
        return np.unique(np.concatenate([[0.0, whole], crossings, self._changes_mm(PUSHING), self._changes_mm(BACK)]))

    def _changes_mm(self, side: int) -> Array:
        """Rolled lengths at which the number of touching pairs changes on a side of the teeth."""
        counts = (self.designed.pushing, self.designed.back)[side].simultaneous
        before = np.nonzero(counts != np.roll(counts, -1))[0]
        low, high = self.even.rolled_mm[before], self.even.rolled_mm[before] + self.even.step_mm
        for _ in range(HALVINGS if before.size else 0):
            middle = (low + high) / 2.0
            there = np.concatenate([_pairs(arms, side) for arms in self.at(middle)])
            same = there == counts[before]
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        return np.asarray((low + high) / 2.0)


def _touching(touch: PairTouch, side: int) -> Contacts:
    """The contacts that share the force at each position: flanks or, where no flanks touch, edges."""
    contacts = (touch.pushing, touch.back)[side].touching
    flanks = np.bincount(contacts.position[contacts.flanks], minlength=touch.placement.count)
    return contacts.kept(contacts.flanks | (flanks[contacts.position] == 0))


def _pairs(touch: PairTouch, side: int) -> IndexArray:
    contacts = (touch.pushing, touch.back)[side].touching
    return np.bincount(contacts.position[contacts.flanks], minlength=touch.placement.count)


def mesh_loss_factor(
    touching: TouchingTeeth, torques: Callable[[Array], tuple[Array, Array]], breaks_rad: Array
) -> float:
    """H over the cycle in which all teeth meet; 0 without torque.

    ``torques`` maps driving angles (n,) to both shafts' torques in N mm, smooth and of one sign between breaks
    (m,).
    """
    arc, distance, whole = touching.pitch.driving.arc, touching.pitch.center_distance_mm, touching.even.cycle_mm
    period = float(np.ptp(breaks_rad))
    starts = period * np.arange(max(round(touching.even.cycle_rad / period), 1))
    kinks = distance * arc.length((breaks_rad + starts[:, None]).ravel())
    points, weights = gauss_points(np.union1d(touching.breaks_mm, kinks[kinks < whole]), NODES)
    blocks = touching.at(points)
    phi1 = np.concatenate([block.placement.phi1_rad for block in blocks])
    driving, driven = torques(phi1)
    # Rolled length per rad of phi1
    rolled_mm = distance * arc.by_angle.differentiated()(np.mod(phi1, arc.angle_period_rad))
    parts = zip(blocks, np.split(driven, range(BLOCK, driven.size, BLOCK)), strict=True)
    rubbing = np.concatenate([_rubbing(touch, torque) for touch, torque in parts])
    moved = float(np.sum(weights / rolled_mm * np.abs(driving)))
    return float(np.sum(weights / rolled_mm * rubbing)) / moved if moved else 0.0


def most_mesh_loss_factor(pitch: PitchPair, reach_mm: float, rack_angle_rad: float) -> float:
    """A bound of H without teeth, for flanks that touch no farther than ``reach_mm`` from the pitch point.

    With q = dphi2/dphi1, F = |T1| / (r1 cos p) at the pressure angle p, and |v| = (1 +- q) s at the distance s from the
    pitch point, so that F |v| = |T1| s (1 +- q)^2 / (a q cos p), which is largest where q is least or largest.
    """
    steepest = radians(pitch.largest_pressure_angle_deg(rack_angle_rad))
    slopes = [1.0 / end.value for end in pitch.transmission.ratio_range]
    wedge = max((1.0 - pitch.mesh.sense * slope) ** 2 / slope for slope in slopes)
    return reach_mm * wedge / (pitch.center_distance_mm * cos(steepest))


def _rubbing(touch: PairTouch, torque_n_mm: Array) -> Array:
    """The sum of F |v| in N mm per rad of phi1 under torques on the driven gear, shape (n,)."""
    found = np.zeros(torque_n_mm.shape)
    for side, carries in ((PUSHING, torque_n_mm > 0.0), (BACK, torque_n_mm < 0.0)):
        contacts = _touching(touch, side)
        levers, sliding = (
            np.bincount(contacts.position, values, minlength=found.size)
            for values in (contacts.lever_mm, np.abs(contacts.sliding_mm(touch.placement)))
        )
        found = np.where(carries, np.abs(torque_n_mm) / levers * sliding, found)
    return found


@dataclass(frozen=True, eq=False)
class Demand:
    """The driving shaft's torque with losses, and its inertia; ``added_kg_mm2`` is the inertia of added parts."""

    cycle: Cycle
    losses: Losses
    added_kg_mm2: float = 0.0

    @property
    def speed_rad_s(self) -> float:
        """The speed w_0 at which the machine is run."""
        return self.cycle.speed_rad_s

    def torque_n_mm(self, phi1_rad: Array) -> Array:
        """T at driving angles in rad, shape (n,)."""
        return with_tooth_friction(self.cycle.rigid.at(phi1_rad).driving_torque.value, self.losses.mesh_share)

    def inertia(self, phi1_rad: Array) -> tuple[Array, Array]:
        """J in N mm s^2 and its slope by the driving angle, at driving angles in rad, shape (n,) each."""
        rigid = self.cycle.rigid
        *between, angle = rigid.angles(phi1_rad, 2)[1:]
        moving = rigid.machine.linkage.moving_masses(Jet.variable(angle.value, 2), rigid.masses)
        inertia, change = reduced_inertia(moving, rigid.masses)
        slope, bend = angle.derivative(1), angle.derivative(2)
        whole = rigid.masses.driving_shaft_kg_mm2 + self.added_kg_mm2 + inertia * slope**2
        change = change * slope**3 + 2.0 * inertia * slope * bend
        for one_kg_mm2, turned in zip(rigid.masses.between_inertia_kg_mm2, between, strict=False):
            whole = whole + one_kg_mm2 * turned.derivative(1) ** 2
            change = change + 2.0 * one_kg_mm2 * turned.derivative(1) * turned.derivative(2)
        return N_PER_KG_MM_S2 * whole, N_PER_KG_MM_S2 * change

    def at_any_speed_n_mm(self, phi1_rad: Array) -> Array:
        """A at driving angles in rad, shape (n,)."""
        accelerating: Array = self.inertia(phi1_rad)[1] * self.speed_rad_s**2 / 2.0
        return self.torque_n_mm(phi1_rad) - accelerating

    @cached_property
    def fluctuation(self) -> Fluctuation:
        """The torque over one cycle as a form, with its work and swing."""
        return Fluctuation(fitted(self.torque_n_mm, self.cycle.breaks_rad), self.speed_rad_s)

    @cached_property
    def torque_range_n_mm(self) -> tuple[Extremum, Extremum]:
        """Least and largest T with their driving angles."""
        return range_of(self.torque_n_mm, self.cycle.loads.phi1_rad)
