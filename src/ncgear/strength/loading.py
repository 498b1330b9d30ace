"""The load of every tooth at every place of its flanks, over a whole cycle of meetings.

At each position of the cycle the pairs of teeth share the torque of the driven gear as linear springs: the driven gear
yields until their forces balance the torque.  There is no friction and no motion in time.  Where a pair begins or
ceases to bear load, the other forces change within a small part of a pitch; there positions are closer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ncgear.contact.designed.as_designed import ALIKE_RAD
from ncgear.contact.designed.extremes import over_cycle
from ncgear.contact.placement import BACK, BOTH_SIDES, PUSHING, Placement, placed, placed_at
from ncgear.dynamics.driven_side import Knock
from ncgear.dynamics.flank_changes import BorneTorque
from ncgear.dynamics.gaps import ERROR, LEVER, STIFFNESS
from ncgear.dynamics.meshing import Meshing
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask, largest_rows
from ncgear.numerics.highest import largest_from
from ncgear.numerics.plane import along
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.strength.contacts import FlankPlaces, LoadedContacts
from ncgear.strength.sections import FaceSections
from ncgear.strength.stiffness import nearest_on_flanks
from ncgear.teeth.gear import ToothedGear

PER_TOOTH = 20
"""Even positions in a tooth pitch: a pair with a contact ratio of 1.5 bears load in thirty of them."""

SOLVED_PER_TOOTH = 80
"""Positions in a tooth pitch at which the pairs' shares are computed, to find the largest force of each pair."""

JUMP = 0.01
"""Change of the force of the most loaded pair from one position to the next, as a share of the largest force, above
which it is searched between them, too; it is also searched wherever other pairs begin to bear load."""

BETWEEN = 8
"""Parts of such a step.  Where a tooth bears all load for a moment only, as with contact ratios near 2 or 3, the error
of its largest force is then 1 % (tests/test_loading.py); with even positions alone it may be a quarter."""

KNOWN = 1e-4
"""Largest error of the extremes of transmission error and force, as a share of their variation over the cycle."""

ROUNDING_RAD = 1e-15
"""Tolerance of the driven angle in rad: rounding."""

ROUNDED = 1e-12
"""Share of the largest torque up to which a torque counts as 0: rounding errors."""

IDLE = 1e-9
"""Share of the largest force below which a pair counts as unloaded."""


@dataclass(frozen=True, eq=False)
class Loading:
    """The teeth under load over a cycle in which every tooth meets all its mates.

    ``contacts`` are at n positions: even positions and, between them, the positions of the pairs' largest forces and
    those beside which more pairs bear load.
    ``phi1_rad``, ``torque_n_mm`` (demanded of the driven gear) and ``error_rad`` (its angle beyond the law's) have
    shape (n,); ``even`` marks the even positions.  ``transmission_error_rad`` is the peak to peak variation of the
    error.  ``contact_ratio`` is the mean number of pairs that bear load, where there is load.  ``cycle_rad`` is the
    turn of the driving gear in the cycle.  ``borne`` is the torque with the knocks of a turn of the driven gear; None
    where nothing is known of them.  Where a motion is followed, ``still`` is the loading by the torque of the law
    alone; ``jammed`` is the loading of a jam, if there is one.  Rolled lengths, ``rolled_mm`` of the positions (shape
    (n,)), go over ``cycle_mm``; ``between`` gives the contacts at any, shape (m,).

    Gears that turn less than once are not ``closed``: their cycle goes out and, where they bear load then, back.
    """

    contacts: LoadedContacts
    between: Callable[[Array], LoadedContacts]
    rolled_mm: Array
    cycle_mm: float
    phi1_rad: Array
    torque_n_mm: Array
    error_rad: Array
    even: Mask
    transmission_error_rad: float
    contact_ratio: float
    cycle_rad: float
    closed: bool = True
    borne: BorneTorque | None = None
    still: Loading | None = None
    jammed: Loading | None = None

    @property
    def knocks(self) -> tuple[Knock, ...] | None:
        """The knocks in a turn of the driven gear; None where they are not followed."""
        return None if self.borne is None else self.borne.knocks


@dataclass(frozen=True, eq=False)
class AskedTorque:
    """The torque demanded of the driven gear, at the positions of a cycle at which pairs' shares are computed.

    ``torque_n_mm`` (shape (n,)) is of either sign; ``at`` gives it at driving angles, shape (any,).  ``peaks``, of
    shape (2, m), are rolled lengths between positions at which it is larger than beside them, and the torques there.
    """

    placement: Placement
    torque_n_mm: Array
    at: Callable[[Array], Array]
    peaks: Array

    @classmethod
    def of(cls, pitch: PitchPair, at: Callable[[Array], Array], borne: BorneTorque | None = None) -> AskedTorque:
        """The torque of a function ``at`` of driving angles; a ``borne`` torque peaks within a step of positions."""
        placement = placed(pitch, SOLVED_PER_TOOTH)
        phi1, torque = placement.phi1_rad, at(placement.phi1_rad)
        nothing = ROUNDED * np.abs(torque).max()
        peaks = np.empty((2, 0))
        if borne is not None:
            places, knocks = borne.peaks(placement.cycle_rad)
            row, size = np.searchsorted(phi1, places, side="right") - 1, np.abs(knocks)
            steps, number = np.unique(2 * row + (knocks > 0.0), return_inverse=True)
            hardest = largest_rows(size, number, steps.size)
            beside = np.maximum(*(np.abs(torque)[(row[hardest] + step) % phi1.size] for step in (0, 1)))
            hardest = hardest[size[hardest] > beside + JUMP * size.max(initial=0.0)]
            ends = np.append(phi1, placement.cycle_rad), placement.step_mm * np.arange(phi1.size + 1)
            peaks = np.stack([np.interp(places[hardest], *ends), knocks[hardest]])
        return cls(placement, np.where(np.abs(torque) <= nothing, 0.0, torque), at, peaks)

    @property
    def sides(self) -> tuple[int, ...]:
        """The sides of the teeth that it presses: pushing flanks alone where it is never negative."""
        return (PUSHING,) if min(self.torque_n_mm.min(), self.peaks[1].min(initial=0.0)) >= 0.0 else BOTH_SIDES

    def between(self, phi1_rad: Array) -> Array:
        """The torque between positions, shape (n,); 0 where it would press a side that no position presses."""
        torque = self.at(phi1_rad)
        return torque if BACK in self.sides else np.maximum(torque, 0.0)


def loading_of(
    meshing: Meshing,
    sections: FaceSections,
    pitch: PitchPair,
    asked: AskedTorque,
    speed_rad_s: Callable[[Array], Array],
    borne: BorneTorque | None = None,
    per_tooth: int = PER_TOOTH,
) -> Loading:
    """The loads of teeth in ``meshing``, whose table of gaps tells where pairs touch in ``sections``.

    It follows the sides of the teeth that the torque presses.  At driving angles (shape (n,)) ``speed_rad_s`` gives the
    speed of the driving gear; ``borne`` has the knocks that the torque counts.  ``per_tooth`` is a divisor of
    SOLVED_PER_TOOTH.  Raises as ``shared`` does.
    """
    solved = asked.placement
    first = shared(meshing, solved.phi1_rad, asked.torque_n_mm)
    most = first.force_n.max(axis=1)
    bearing = _bearing(meshing, solved, first.force_n > 0.0)
    jumps = np.abs(np.roll(most, -1) - most) > JUMP * most.max()
    if len(sections.each) == 1:
        # In many sections pairs come and go all the time, each with a small part of the load.
        jumps |= np.roll(bearing, -1) != bearing
    if solved.toothed is not None:
        jumps[-1] = False
    # Where forces never change, as without a torque, one step is still searched.
    jumps[0] |= not jumps.any()
    inside = solved.rolled_mm[jumps][:, None] + solved.step_mm * np.arange(1, BETWEEN) / BETWEEN
    more_mm = np.setdiff1d(np.concatenate([inside.ravel(), asked.peaks[0]]), solved.rolled_mm)
    every, torque, found = _added(meshing, pitch, asked, (solved, asked.torque_n_mm, first), more_mm)
    extreme_mm = _extreme_places_mm(meshing, pitch, asked, every, found)
    every, torque, found = _added(meshing, pitch, asked, (every, torque, found), extreme_mm)
    idle_n = IDLE * found.force_n.max()
    loaded = found.force_n > idle_n
    position, slot = np.nonzero(loaded)
    largest = _largest_of_pairs(meshing, every.phi1_rad[position], slot, found.force_n[position, slot])
    even = np.isin(np.arange(every.count), np.arange(0, solved.count, SOLVED_PER_TOOTH // per_tooth))
    peaks = _peaks(every.rolled_mm, found.force_n.max(axis=1)) if borne and borne.phi1_rad.size else position[:0]
    alone = _beside_more(every.rolled_mm, loaded) if len(sections.each) == 1 else position[:0]
    chosen = np.flatnonzero(even | np.isin(np.arange(every.count), [*position[largest], *peaks, *alone]))
    chosen = chosen[np.argsort(every.rolled_mm[chosen])]
    phi1 = every.phi1_rad[chosen]
    row, slot = np.nonzero(loaded[chosen])
    touching = _Touching.of(meshing, every, chosen[row], slot)

    def between(rolled_mm: Array) -> LoadedContacts:
        placement = placed_at(pitch, asked.placement, rolled_mm)
        force = shared(meshing, placement.phi1_rad, asked.between(placement.phi1_rad)).force_n
        place, pair = np.nonzero(force > idle_n)
        numbers = place, placement.phi1_rad[place], force[place, pair]
        return _contacts(sections, _Touching.of(meshing, placement, place, pair), numbers, speed_rad_s)

    pairs = loaded[: solved.count] @ np.array([section.share for section in sections.each])[meshing.gaps.section]
    pairs = pairs[pairs > 0.0]
    return Loading(
        contacts=_contacts(sections, touching, (row, phi1[row], found.force_n[chosen[row], slot]), speed_rad_s),
        between=between,
        rolled_mm=every.rolled_mm[chosen],
        cycle_mm=solved.cycle_mm if solved.toothed is None else solved.toothed.covered_mm,
        phi1_rad=phi1,
        torque_n_mm=torque[chosen],
        error_rad=found.error_rad[chosen],
        even=even[chosen],
        transmission_error_rad=float(np.ptp(found.error_rad)),
        contact_ratio=float(pairs.mean()) if pairs.size else 0.0,
        cycle_rad=solved.cycle_rad if solved.toothed is None else 2.0 * solved.cycle_rad,
        closed=solved.toothed is None,
        borne=borne,
    )


def out_and_back(out: Loading, back: Loading) -> Loading:
    """The loads of gears that turn less than once on their way out and on their way back.

    Rolled lengths go on after the way out, a step beyond its end, and then from the end of the range to its beginning.
    """
    end, count = out.cycle_mm, out.rolled_mm.size
    turned, last = 2.0 * end + float(out.rolled_mm[1] - out.rolled_mm[0]), back.rolled_mm.size - 1

    def between(rolled_mm: Array) -> LoadedContacts:
        returning = rolled_mm > turned / 2.0
        parts = []
        for rows, way, place in (
            (np.flatnonzero(~returning), out, np.minimum(rolled_mm, end)),
            (np.flatnonzero(returning), back, np.minimum(turned - rolled_mm, end)),
        ):
            if rows.size:
                found = way.between(place[rows])
                parts.append(replace(found, position=rows[found.position]))
        both = LoadedContacts.joined(parts)
        return both.kept(np.argsort(both.position, kind="stable"))

    coming = back.contacts.kept(slice(None, None, -1))
    return replace(
        out,
        contacts=LoadedContacts.joined([out.contacts, replace(coming, position=count + last - coming.position)]),
        between=between,
        rolled_mm=np.concatenate([out.rolled_mm, turned - back.rolled_mm[::-1]]),
        cycle_mm=turned,
        phi1_rad=np.concatenate([out.phi1_rad, back.phi1_rad[::-1]]),
        torque_n_mm=np.concatenate([out.torque_n_mm, back.torque_n_mm[::-1]]),
        error_rad=np.concatenate([out.error_rad, back.error_rad[::-1]]),
        even=np.concatenate([out.even, back.even[::-1]]),
        transmission_error_rad=max(out.transmission_error_rad, back.transmission_error_rad),
    )


@dataclass(frozen=True, eq=False)
class Shared(Columns):
    """How pairs share torques: normal forces of shape (n, slots), and driven angles beyond the law's, shape (n,)."""

    force_n: Array
    error_rad: Array


def shared(meshing: Meshing, phi1_rad: Array, torque_n_mm: Array) -> Shared:
    """The pairs of ``meshing`` as linear springs under torques on the driven gear at driving angles, shape (n,) each.

    With stiffness k, lever l and touching angle e of each pair, sum(k l^2 max(0, e - x)) = T on pushing flanks, and so
    on backs with the other sign.  The left side falls with x and is convex, so Newton's method, which starts where the
    first pair alone would bear the torque, reaches the zero from one side, in as many steps as pairs are added.  Raises
    NoSuchMechanism where teeth would be pressed deeper into each other than the tables follow.
    """
    gaps, every = meshing.gaps, np.arange(phi1_rad.size)
    error_rad, lever_mm, stiffness = (gaps.table.values(phi1_rad, quantity) for quantity in (ERROR, LEVER, STIFFNESS))
    urge = np.where(torque_n_mm < 0.0, -1.0, 1.0)
    ours = gaps.urge[gaps.table.place(phi1_rad)[1]] == urge[:, None]
    ahead = np.where(ours, urge[:, None] * error_rad, -np.inf)
    turning, torque = stiffness * lever_mm**2, np.abs(torque_n_mm)
    first = ahead.argmax(axis=1)
    at = ahead[every, first] - torque / turning[every, first]
    for _ in range(ahead.shape[1]):
        active = ahead >= at[:, None]
        borne = np.sum(turning * np.maximum(ahead - at[:, None], 0.0), axis=1)
        step = (borne - torque) / np.sum(turning * active, axis=1)
        at = at + step
        if np.all(np.abs(step) <= ROUNDING_RAD):
            break
    error = urge * at
    meshing.require_reach(phi1_rad, error)
    return Shared(stiffness * lever_mm * np.maximum(ahead - at[:, None], 0.0), error)


Solved = tuple[Placement, Array, Shared]
"""Positions, the torques asked at them, and how pairs share these."""


def _added(meshing: Meshing, pitch: PitchPair, asked: AskedTorque, known: Solved, rolled_mm: Array) -> Solved:
    """The known solution, extended by further positions, if any."""
    if not rolled_mm.size:
        return known
    placement, torque, found = known
    added = placed_at(pitch, asked.placement, rolled_mm)
    added_torque = asked.between(added.phi1_rad)
    both = Shared.joined([found, shared(meshing, added.phi1_rad, added_torque)])
    return placement.followed_by(added), np.concatenate([torque, added_torque]), both


def _extreme_places_mm(
    meshing: Meshing, pitch: PitchPair, asked: AskedTorque, known: Placement, found: Shared
) -> Array:
    """Rolled lengths of the largest and the least error and of the largest force of a pair, if not known already.

    ``found`` is the solution at positions, in any order.
    """

    def sizes(load: Shared) -> Array:
        return np.stack([load.error_rad, -load.error_rad, load.force_n.max(axis=1)])

    def at(rolled_mm: Array) -> Array:
        phi1 = placed_at(pitch, asked.placement, rolled_mm).phi1_rad
        return sizes(shared(meshing, phi1, asked.between(phi1)))

    rolled, order = np.unique(known.rolled_mm, return_index=True)
    places, values = over_cycle(replace(known, rolled_mm=rolled), sizes(found)[:, order])
    told = np.array([ALIKE_RAD, ALIKE_RAD, 0.0])
    extremes = largest_from(at, places, values, np.maximum(KNOWN * np.ptp(values, axis=1), told))
    return np.setdiff1d([extremum.at for extremum in extremes], places)


def _bearing(meshing: Meshing, placement: Placement, loaded: Mask) -> IndexArray:
    """A number for the set of loaded pairs at each position, shape (n,); ``loaded`` has shape (n, slots)."""
    pair = meshing.gaps.pair[meshing.gaps.table.place(placement.phi1_rad)[1]]
    return np.asarray(np.sum((pair[..., 0] * (placement.driven_teeth + 1) + pair[..., 1]) * loaded, axis=-1))


def _peaks(rolled_mm: Array, force_n: Array) -> IndexArray:
    """The positions at which the force of the most loaded pair has a peak, as in each swing after a knock."""
    order = np.argsort(rolled_mm)
    sorted_n = force_n[order]
    rising = sorted_n > np.roll(sorted_n, 1)
    return np.asarray(order[rising & ~np.roll(rising, -1)])


def _beside_more(rolled_mm: Array, loaded: Mask) -> IndexArray:
    """The positions next to which more pairs bear load, where a root is stressed most; ``loaded`` is (n, slots)."""
    order, pairs = np.argsort(rolled_mm), loaded.sum(axis=1)
    around = pairs[order]
    return np.asarray(order[(around > 0) & (around < np.maximum(np.roll(around, 1), np.roll(around, -1)))])


def _largest_of_pairs(meshing: Meshing, phi1_rad: Array, slot: IndexArray, force_n: Array) -> IndexArray:
    """The row of the largest force of each pair of flanks in each section; each pair meets once in the cycle.

    A pair is given by its slot of the table and its driving angle; shape (n,) each.
    """
    gaps, interval = meshing.gaps, meshing.gaps.table.place(phi1_rad)[1]
    driving, driven = gaps.pair[interval, slot].T
    key = (driving * (gaps.pair.max() + 1) + driven) * gaps.sections + gaps.section[slot]
    pairs, number = np.unique(2 * key + (gaps.urge[interval, slot] > 0.0), return_inverse=True)
    return largest_rows(force_n, number, pairs.size)


def _contacts(
    sections: FaceSections,
    touching: _Touching,
    numbers: tuple[IndexArray, Array, Array],
    speed_rad_s: Callable[[Array], Array],
) -> LoadedContacts:
    """The loaded pairs, from their ``numbers`` of positions, driving angles and forces."""
    driving, driven = touching.places(Gear.DRIVING), touching.places(Gear.DRIVEN)
    position, phi1, force = numbers
    relative, flanks, rolling = np.empty_like(force), np.empty(force.size, dtype=bool), np.empty((force.size, 2))
    angles = sections.each[0].teeth.driving.flanks.rack.angles_rad
    across = np.array([sections.across_lines(angles[side]) for side in BOTH_SIDES])
    for number, section in enumerate(sections.each):
        rows = np.flatnonzero(touching.section == number)
        pair = section.teeth
        fits = FlankFit.of(pair.driving, driving.kept(rows)), FlankFit.of(pair.driven, driven.kept(rows))
        curvature = fits[0].curvature + fits[1].curvature
        # At a joint of the law curvatures jump, and both flanks' may belong to different sides: no pressure is known.
        flanks[rows] = fits[0].on_flank & fits[1].on_flank & (curvature > 0.0)
        relative[rows] = np.where(flanks[rows], curvature * across[touching.side[rows]], np.inf)
        rolling[rows] = touching.kept(rows).rolling_mm(fits, flanks[rows])
    return LoadedContacts(
        position,
        phi1,
        touching.side,
        force,
        touching.stiffness_n_mm,
        relative,
        flanks,
        speed_rad_s(phi1)[:, None] * rolling,
        driving.flank,
        driving.point,
        driving.inwards,
        driven.flank,
        driven.point,
        driven.inwards,
        touching.section,
        np.array([section.share for section in sections.each])[touching.section],
    )


FITTING = 1e-3
"""Largest distance of a place from its flank, in modules, and of its normal from the flank's, in rad, with which the
flank itself touches: loaded teeth turn by as much, and errors of tables between their positions are less."""


@dataclass(frozen=True, eq=False)
class FlankFit:
    """The fit of n places to the flanks of one gear, shape (n,) each.

    ``curvature`` is the flank's at its point nearest to each place; ``off_mm`` and ``tilt`` are the distance from that
    point and the sine of the angle between both normals.
    """

    gear: ToothedGear
    curvature: Array
    off_mm: Array
    tilt: Array

    @classmethod
    def of(cls, gear: ToothedGear, places: FlankPlaces) -> FlankFit:
        """The places on the flanks of a gear."""
        nearest = nearest_on_flanks(gear, places)
        off = np.abs(nearest.point - places.point)
        tilt = np.abs(along(nearest.slope / np.abs(nearest.slope), places.inwards))
        return cls(gear, gear.flanks.curvature(places.flank, nearest.height_mm), off, tilt)

    @property
    def on_flank(self) -> Mask:
        """Whether the flank touches at each place, and not an edge."""
        near: Mask = (self.off_mm <= FITTING * self.gear.flanks.rack.module_mm) & (self.tilt <= FITTING)
        return near


@dataclass(frozen=True, eq=False)
class _Touching(Columns):
    """n loaded pairs in the fixed frame, each at the angle where it begins to touch, shape (n,) each.

    Let t be the unit tangent, w the way from the driven axis to the place of contact and s the sense of the mesh.  Then
    conj(t) w is the lever and, as its imaginary part, -s times the speed of the driven gear's point along t.
    ``sliding_mm`` is the speed of the driving gear's point against the driven one's along t, in mm per rad of phi1,
    and ``speed`` is dphi2/dphi1 while the pair touches; ``stiffness_n_mm`` is the pair's.
    """

    placement: Placement
    row: IndexArray
    teeth: IndexArray
    urge: Array
    error_rad: Array
    stiffness_n_mm: Array
    speed: Array
    sliding_mm: Array
    tangent: ComplexArray
    point: ComplexArray
    section: IndexArray

    @classmethod
    def of(cls, meshing: Meshing, placement: Placement, row: IndexArray, slot: IndexArray) -> _Touching:
        """The pairs in slots of the table at positions; shape (n,) each."""
        gaps, phi1 = meshing.gaps, placement.phi1_rad[row]
        near, sense, distance = gaps.at(phi1, slot), placement.mesh.sense, placement.center_distance_mm
        urge, error, stiffness, drift = near.urge, near.error_rad, near.stiffness, near.slopes[0]
        lever, driving, driven = near.lever_mm, near.driving_mm, near.driven_mm
        speed = placement.speed[row] + drift
        along_x = lever * (sense * speed - 1.0)
        tangent: ComplexArray = along_x + 1j * (driving - sense * driven)
        tangent = tangent / np.abs(tangent)
        point: ComplexArray = distance + tangent * (lever - 1j * sense * driven)
        pair = gaps.pair[gaps.table.place(phi1)[1], slot]
        sliding = driving - speed * driven
        section = gaps.section[slot]
        return cls(placement, row, pair, urge, error, stiffness, speed, sliding, tangent, point, section)

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

    def rolling_mm(self, fits: tuple[FlankFit, FlankFit], flanks: Mask) -> Array:
        """Speed of the contact along the driving and the driven flank, in mm per rad of phi1, shape (n, 2).

        Both speeds v are counted along the tangent, and their difference is the sliding.  Where flanks touch they keep
        one tangent: it turns with each gear and with the contact along the curvature k of its flank.  Counted towards i
        t, k is u s times the driven flank's curvature and -u s times the driving flank's, with u the urge, so that

            1 - u s k1 v1 = s i21 + u s k2 v2,   v2 = v1 + sliding

        An edge stays where it is on its own gear.
        """
        own, other = fits
        turn = self.urge * self.placement.mesh.sense
        swing = 1.0 - self.placement.mesh.sense * self.speed - turn * other.curvature * self.sliding_mm
        total = np.where(flanks, turn * (own.curvature + other.curvature), 1.0)
        # Where an edge touches a fillet, it belongs to the gear whose flank still has the place.
        apart = np.maximum(own.off_mm, other.off_mm) > FITTING * own.gear.flanks.rack.module_mm
        own_edge = np.where(apart, own.off_mm < other.off_mm, own.tilt > other.tilt)
        first = np.where(flanks, swing / total, np.where(own_edge, 0.0, -self.sliding_mm))
        return np.column_stack([first, first + self.sliding_mm])
