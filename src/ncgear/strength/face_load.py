"""The load along the face width, as bending and twisting shafts, yielding bearings and misaligned flanks spread it.

At a position of the gears the pairs that touch are one row of springs along the width, c N/mm for each mm of width and
mm of way.  Both gears follow their shafts, so the gap between the flanks at a place z along the width is

    g(z) = g_0(z) + integral of A(z, s) w(s) ds,   w(z) = c max(0, x - g(z)),   integral of w(z) dz = F

with w the load for each mm of width, x the approach of the gears along the normal, g_0 the gap without the mesh force
(flanks askew, crowning, end relief, the shafts bent by the crank or a second gear and the couples of helical teeth's
thrust, which press over the width as its length from the middle) and A(z, s) the way by which both gears yield at z
under a force of 1 N at s.  Flanks only press, so w is never below 0.  The face load factor is K_Hbeta = max(w) b / F.
That is the method of ISO 6336-1:2019, annex E (secondary sources), with these choices:

- A shaft is a beam of one diameter on two springs, by Timoshenko: A is the sum over the shaft of M_z M_s / (E I) +
  10/9 Q_z Q_s / (G S), M and Q the bending moment and the transverse force of a force of 1 N at z and at s, S the area
  of the section, and of R_z R_s / k over its bearings, R being their reactions (theorem of Castigliano).  The gear's
  body does not stiffen it: ISO 6336-1 expects no stiffening from a body on a key.
- The teeth stand on the body, a cylinder up to their roots.  It leans as its shaft does in the mean of the width, and
  bends with it by E I / (E I + E_body I_body), since both resist bending together: the teeth of a wheel stay straight,
  those of a pinion follow its shaft.  The mean line of a form y(z) is P y, the least squares of y; loads reach the
  shaft by P's transpose, so that energy is kept.
- The body twists as a cylinder of the arm of the mesh force, against the end at which the torque comes in or leaves:
  by 2 / (pi G r^2) times the length that carries both forces, r being the arm.
- Neighbouring teeth do not support each other, so that the peaks are on the safe side.

**Solution.**  Between M + 1 places the load of the spring, u = c (x - g), is taken as linear.  Its zeros bound the
pressing part, and its forces on the places are integrals with the hat functions over that part, so that linear gaps are
met exactly.  With the part known, u and x are the solution of linear equations; the part is computed anew until it
stays (Newton's method, since the forces have a continuous slope).  Equilibrium and all w are checked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf, pi

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns
from ncgear.numerics.highest import golden_section

ASSUMED = 1.3
"""K_Hbeta where nothing is known of the shafts: own choice, because gears as wide as suits their shafts have it."""

PARTS = 16
"""Parts of the width.  With 64, factors of baler-drivetrain change by 0.05 %, and by 1 % with a crowning of 20 um."""

STEEL_MPA = 206_000.0
SHEAR_MPA = 79_300.0
"""Moduli of shafts, of steel."""

SHEARED = 10.0 / 9.0
"""Factor of the transverse force's energy, of a round section."""

GAUSS = (1.0 - 1.0 / 3.0**0.5) / 2.0, (1.0 + 1.0 / 3.0**0.5) / 2.0
"""Gauss points of a part of a shaft: exact for products of two moments, which are parabolas."""


@dataclass(frozen=True)
class Support:
    """A bearing with its seat: its place along the shaft in mm and its stiffness in N/mm, infinite where rigid."""

    at_mm: float
    stiffness_n_mm: float = inf


@dataclass(frozen=True)
class SteelShaft:
    """A round shaft of steel on two bearings, and its gear's body below the teeth: diameter and Young's modulus.

    Places along it in mm count from the middle of the gear.
    """

    diameter_mm: float
    body_mm: float
    supports: tuple[Support, Support]
    body_mpa: float = STEEL_MPA

    @property
    def bent_teeth(self) -> float:
        """Share of the shaft's bending that the teeth follow: 1 where the body is no thicker than its shaft."""
        thicker = max((self.body_mm / self.diameter_mm) ** 4 - 1.0, 0.0)
        return 1.0 / (1.0 + self.body_mpa / STEEL_MPA * thicker)

    def reactions(self, at_mm: Array) -> Array:
        """Reactions of both bearings to 1 N at places, shape (2, n)."""
        first, second = (support.at_mm for support in self.supports)
        on_second = (at_mm - first) / (second - first)
        return np.stack([1.0 - on_second, on_second])

    def compliance(self, at_mm: Array, loaded_mm: Array) -> Array:
        """Deflection of the shaft in mm at n places under 1 N at each of k places; shape (n, k)."""
        forces = np.concatenate([at_mm, loaded_mm])
        borne = self.reactions(forces)
        ends = np.unique(np.concatenate([forces, [support.at_mm for support in self.supports]]))
        length = np.diff(ends)
        point = (ends[:-1, None] + length[:, None] * GAUSS).ravel()

        def beyond(places: Array) -> Array:
            """Arms of forces of 1 N beyond points of the shaft, shape (places, points)."""
            return np.asarray(np.maximum(places[:, None] - point, 0.0))

        moment, across = beyond(forces), (forces[:, None] > point).astype(float)
        for support, reaction in zip(self.supports, borne, strict=True):
            moment -= reaction[:, None] * np.maximum(support.at_mm - point, 0.0)
            across -= reaction[:, None] * (support.at_mm > point)
        weight = np.repeat(length / 2.0, 2)
        area = pi * self.diameter_mm**2 / 4.0
        bending = weight / (STEEL_MPA * area * self.diameter_mm**2 / 16.0)
        shear = SHEARED * weight / (SHEAR_MPA * area)
        yielding = np.array([1.0 / support.stiffness_n_mm for support in self.supports])
        near, far = slice(0, at_mm.size), slice(at_mm.size, None)
        return np.asarray(
            (moment[near] * bending) @ moment[far].T
            + (across[near] * shear) @ across[far].T
            + (borne[:, near].T * yielding) @ borne[:, far]
        )


@dataclass(frozen=True)
class LeadForm:
    """How the flanks of a pair fall back along the width, both gears together, in mm.

    The crowning is a parabola with ``crowning_mm`` at both ends; the end relief begins ``relief_length_mm`` from each
    end and is ``relief_mm`` there, along a line.
    """

    crowning_mm: float = 0.0
    relief_mm: float = 0.0
    relief_length_mm: float = 0.0

    def gap_mm(self, at_mm: Array, width_mm: float) -> Array:
        """The gap at places from the middle of the width, of the shape of the places."""
        share = 2.0 * at_mm / width_mm
        gap = self.crowning_mm * share**2
        if self.relief_length_mm > 0.0:
            into = np.abs(at_mm) - (width_mm / 2.0 - self.relief_length_mm)
            gap = gap + self.relief_mm * np.maximum(into, 0.0) / self.relief_length_mm
        return np.asarray(gap)


@dataclass(frozen=True, eq=False)
class FaceLoads(Columns):
    """The forces that press flanks together at n positions, shape (n,) each.

    ``force_n`` is the normal force of all pairs together and ``stiffness_n_mm2`` their stiffness for each mm of width.
    ``beside_n`` (shape (n, 2)) are the parts of the forces of crank or second gear on both shafts in the directions in
    which the teeth press these.
    ``arms_mm`` (shape (n, 2)) are the arms of the mesh force about both axes.  ``couples_mm`` (shape (n, 2)) are the
    parts of the couples of thrust on both shafts in the directions in which the teeth press these, over ``force_n``.
    """

    force_n: Array
    stiffness_n_mm2: Array
    beside_n: Array
    arms_mm: Array
    couples_mm: Array


def places_mm(width_mm: float, lead: LeadForm) -> Array:
    """The places along the width at which gaps are given, shape (PARTS + 1,), from its middle.

    They are equally distant, but the places nearest to the beginnings of an end relief stand exactly there.
    """
    places = np.linspace(-width_mm / 2.0, width_mm / 2.0, PARTS + 1)
    begins = width_mm / 2.0 - lead.relief_length_mm
    if 0.0 < begins < width_mm / 2.0:
        for sign in (-1.0, 1.0):
            places[1 + int(np.abs(places[1:-1] - sign * begins).argmin())] = sign * begins
    return places


@dataclass(frozen=True)
class FaceModel:
    """A pair on its shafts: ``shafts`` of the driving and the driven gear, and what else presses on these.

    ``beside_mm`` are the places of a second gear or of the crank, None where nothing else presses.  ``askew_mm`` is
    the greatest misalignment of the flanks over the width, in either sense.
    """

    shafts: tuple[SteelShaft, SteelShaft]
    beside_mm: tuple[float | None, float]
    width_mm: float
    askew_mm: float
    lead: LeadForm

    def factors(self, loads: FaceLoads) -> Array:
        """K_Hbeta at n positions, shape (n,), for the worst of no misalignment and of both senses; 1 without force.

        Raises as ``largest_line_load`` does.
        """
        pressed = np.flatnonzero(loads.force_n > 0.0)
        found = np.ones(loads.force_n.size)
        if not pressed.size:
            return found
        at = places_mm(self.width_mm, self.lead)
        force, stiffness = loads.force_n[pressed], loads.stiffness_n_mm2[pressed]
        straight, twist = _mean_line(at), self._twist(at, loads.arms_mm[pressed])
        bodies = [
            shaft.bent_teeth * bent + (1.0 - shaft.bent_teeth) * straight @ bent @ straight.T
            for shaft, bent in ((shaft, shaft.compliance(at, at)) for shaft in self.shafts)
        ]
        compliance = twist + sum(bodies)
        gap = np.zeros((force.size, at.size))
        for shaft, place, beside in zip(self.shafts, self.beside_mm, loads.beside_n[pressed].T, strict=True):
            if place is not None:
                bent = shaft.compliance(at, np.array([place]))[:, 0]
                bent = shaft.bent_teeth * bent + (1.0 - shaft.bent_teeth) * straight @ bent
                gap = gap + bent * beside[:, None]
        gap = gap + self.lead.gap_mm(at, self.width_mm)
        if loads.couples_mm.any():
            # A load in proportion to the place, of which the couple is 1.
            couple = _over_width(at) @ at
            tilts = np.stack([body @ couple for body in bodies]) / (at @ couple)
            gap = gap + (force[:, None] * loads.couples_mm[pressed]) @ tilts
        askew = self.askew_mm * at / self.width_mm
        senses = (0.0, 1.0, -1.0) if self.askew_mm else (0.0,)
        gaps = np.stack([gap + sense * askew for sense in senses])
        found[pressed] = largest_line_load(at, gaps, compliance, stiffness, force).max(axis=0) * self.width_mm / force
        return found

    def _twist(self, at_mm: Array, arms_mm: Array) -> Array:
        """Way by which teeth yield along the normal as their bodies twist, shape (n, places, places).

        The torque enters and leaves the gears on the side of what stands beside them, and the first gear from the side
        opposite to the second's.
        """
        entering, leaving = self.beside_mm
        side = 1.0 if leaving >= 0.0 else -1.0
        enters = -side if entering is None else 1.0 if entering >= 0.0 else -1.0
        twist = np.zeros((len(arms_mm), at_mm.size, at_mm.size))
        for shaft, arm, end in zip(self.shafts, arms_mm.T, (enters, side), strict=True):
            far, shear = self.width_mm / 2.0 - end * at_mm, SHEAR_MPA * shaft.body_mpa / STEEL_MPA
            twist += (2.0 / (pi * shear * arm**2))[:, None, None] * np.minimum(far[:, None], far)
        return twist


RESOLVED_MM = 2.5e-4
"""Tolerance of the best crowning in mm: a quarter of the accuracy of workshops."""


def best_fall_mm(
    model: FaceModel, loads: FaceLoads, most_n: Array, lead: Callable[[float], LeadForm]
) -> tuple[float, float]:
    """The crowning or relief in mm for the least largest load in N over the width, and that load; 0 if 0 is best.

    ``lead`` is the form of the flanks by the size that is sought.  ``most_n`` (shape (n,)) is the force on the most
    loaded pair at the positions of ``loads``; other positions do not count.  The largest load falls with the size and
    rises again, since too much leaves the middle of the width alone; a golden section finds the least.  Raises as
    ``largest_line_load`` does.
    """

    def largest(fall_mm: float) -> float:
        return float(np.max(replace(model, lead=lead(fall_mm)).factors(loads) * most_n))

    low, high = 0.0, float(np.max(loads.force_n / loads.stiffness_n_mm2)) / model.width_mm
    while largest(2.0 * high) < largest(high):
        high *= 2.0
    high *= 2.0
    first, second = golden_section(largest, low, high, RESOLVED_MM)
    found = (first.at + second.at) / 2.0
    return min(((at, largest(at)) for at in (0.0, found)), key=lambda tried: tried[1])


def _mean_line(at_mm: Array) -> Array:
    """From a form at places along the width to the line of its least squares there, shape (places, places)."""
    mass = _over_width(at_mm)
    lines = np.stack([np.ones(at_mm.size), at_mm])
    return np.asarray(lines.T @ np.linalg.solve(lines @ mass @ lines.T, lines @ mass))


def _over_width(at_mm: Array) -> Array:
    """From a load for each mm of width at places to its forces on the places, shape (places, places)."""
    (own,), (beside,) = _hats(np.tile([0.0, 1.0], (1, at_mm.size - 1, 1)), np.diff(at_mm))
    return np.diag(own) + np.diag(beside, 1) + np.diag(beside, -1)


STEPS = 40
"""Most steps to the part of the width that presses; four or five do as a rule.  From HALVED on, halves of them."""

HALVED = 12

STAYS = 1e-5
"""Change of the pressing part, in parts of the width, that counts as none: a force changes with its square."""

BALANCED = 1e-8
"""Largest error of the equations of forces and gaps, as a share of the mean load; rounding errors are 1e-11 of it."""


def largest_line_load(at_mm: Array, gap_mm: Array, compliance: Array, stiffness: Array, force_n: Array) -> Array:
    """The largest load for each mm of width in N/mm at n positions, shape (k, n), of each of k gaps.

    ``gap_mm`` (shape (k, n, m)) is g_0 at the places ``at_mm`` (m,) from one end of the width to the other,
    ``compliance`` (n, m, m) is A in mm/N, ``stiffness`` (n,) is c in N/mm2 and ``force_n`` (n,) is above 0.
    Raises NoSuchMechanism where the equations cannot be met.
    """
    kinds, count, places = gap_mm.shape
    # The loads that gaps and ways by which both gears yield take off a spring.
    yielding = stiffness[:, None, None] * compliance
    off = (stiffness[:, None] * gap_mm).reshape(-1, places)
    part_mm, force = np.diff(at_mm), np.tile(force_n, kinds)
    whole = np.broadcast_to([0.0, 1.0], (1, places - 1, 2))
    matrix = _equations(yielding, _hats(whole, part_mm))
    right = np.concatenate([-off, force[:, None]], axis=1)
    # Where all of the width presses, all gaps have the same matrix.
    sides = right.reshape(kinds, count, places + 1).transpose(1, 2, 0)
    load = np.linalg.solve(matrix, sides)[:, :-1].transpose(2, 0, 1).reshape(-1, places)
    active = np.repeat(whole, len(load), axis=0)
    todo = np.arange(len(load))
    for step in range(STEPS):
        pressing = _pressing(load[todo])
        stays = np.abs(pressing - active[todo]).max(axis=(1, 2)) < STAYS
        active[todo] = pressing
        todo = todo[~stays]
        if not todo.size:
            break
        matrix = _equations(yielding[todo % count], _hats(active[todo], part_mm))
        found = np.linalg.solve(matrix, right[todo][..., None])[:, :-1, 0]
        load[todo] = found if step < HALVED else (found + load[todo]) / 2.0
    own, beside = _hats(active, part_mm)
    borne = own * load
    borne[:, 1:] += beside * load[:, :-1]
    borne[:, :-1] += beside * load[:, 1:]
    short = np.abs(borne.sum(axis=1) / force - 1.0)
    # The approach x is the same at all places.
    yields = np.einsum("nij,knj->kni", yielding, borne.reshape(gap_mm.shape)).reshape(-1, places)
    approach = load + off + yields
    uneven = np.ptp(approach, axis=1) / (force / float(np.ptp(at_mm)) + np.abs(approach).max(axis=1))
    missed = np.flatnonzero(~((short < BALANCED) & (uneven < BALANCED)))
    if missed.size:
        raise NoSuchMechanism(
            f"the load along the face width is not found at {missed.size} of {len(load)} positions: gaps and forces "
            f"miss their equations by {max(short[missed].max(), uneven[missed].max()):.1g}; "
            "strength.face_load_factor may be given in its place",
            key="drivetrain",
        )
    return np.asarray(load.max(axis=1)).reshape(kinds, count)


def _equations(yielding: Array, hats: tuple[Array, Array]) -> Array:
    """The matrix of the equations of all places and of the force, shape (n, m + 1, m + 1)."""
    own, beside = hats
    places = own.shape[1]
    matrix = np.empty((len(yielding), places + 1, places + 1))
    loads = matrix[:, :-1, :-1]
    np.multiply(yielding, own[:, None], out=loads)
    loads[:, :, 1:] += yielding[:, :, :-1] * beside[:, None]
    loads[:, :, :-1] += yielding[:, :, 1:] * beside[:, None]
    loads[:, range(places), range(places)] += 1.0
    matrix[:, :-1, -1], matrix[:, -1, -1] = -1.0, 0.0
    matrix[:, -1, :-1] = own
    matrix[:, -1, 1:-1] += beside
    matrix[:, -1, :-2] += beside
    return matrix


def _pressing(load: Array) -> Array:
    """Begin and end of the pressing stretch of each part, as shares of it, shape (n, m - 1, 2); loads are (n, m)."""
    first, second = load[:, :-1], load[:, 1:]
    differ = np.where(first == second, 1.0, first - second)
    zero = np.clip(first / differ, 0.0, 1.0)
    begin = np.where(first > 0.0, 0.0, np.where(second > 0.0, zero, 1.0))
    end = np.where(second > 0.0, 1.0, np.where(first > 0.0, zero, 1.0))
    return np.stack([begin, end], axis=-1)


def _hats(active: Array, part_mm: Array) -> tuple[Array, Array]:
    """The integrals of products of hat functions over the pressing stretches: squares (n, m), neighbours (n, m - 1)."""
    first, squared = np.diff(active)[..., 0], active * active
    second, third = (np.diff(power)[..., 0] / k for power, k in ((squared, 2.0), (squared * active, 3.0)))
    own = np.zeros((active.shape[0], active.shape[1] + 1))
    own[:, :-1] = part_mm * (first - 2.0 * second + third)
    own[:, 1:] += part_mm * third
    return own, part_mm * (second - third)
