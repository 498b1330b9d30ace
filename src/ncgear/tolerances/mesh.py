"""The mesh of a pair with small deviations, linear in each place of contact, over all positions and many assemblies.

At a position, a pair of teeth touches at the driven angle e beyond the law's.  Let n be the unit normal at the place of
contact, which leads into the driven tooth, L the arm of n about the driven axis, and ``urge`` +1 on pushing flanks and
-1 on their backs.  Small displacements u1 and u2 move the gears there, and m1 and m2 is excess material of their flanks
along n.  By the principle of virtual work, to first order, the pair then touches at

    urge e = urge e0 + (m1 + m2 - n . (u2 - u1)) / L.

On each side of the teeth, the pair with the greatest value touches.  This maximum is exact, so changes from pair to
pair are kept.  The play lies between both sides:

    play = - max over pushing (urge e) - max over backs (urge e),

A pair jams where its play is below zero.  Displacements are

    driving gear  c1 exp(i phi1) + P g1 + i P eps1,
    driven gear   da + c2 exp(i s phi2) + (P - a) g2 + a gh,

with the eccentricities c1 and c2 of the bores in each gear's frame, the deviation da of the centre distance a, the
growths g1, g2 and gh of gears and housing, the index error eps1 of the driving gear, and s the sense in which the
driven gear turns.  A tilted bore makes a section at height z run out by z tau.  As n . u is linear in z, the flanks
touch first at one end of the face width b, by b/2 |n . (tau2 exp(i s phi2) - tau1 exp(i phi1))| earlier.

Helical teeth are a pair of spur gears in each section, and their teeth stand farther along the pitch curves.  All
sections turn together, so their places of contact belong to one mesh, and the section that touches first carries.  A
tilted bore moves each section by its own height.  Material counts across the flank in the section.

A flank whose pitch deviates by x stands turned about its gear's axis, as an indexing error of the machine leaves it: by
x cos(alpha) / L0, where L0 is the arm of its normal where it crosses the pitch curve.  Deviations of the profile and
wear move a flank along its own normal; where a corner touches, their part along n counts.

Left out: the second order in the deviations, the load, and the crowning and lead of flanks.
"""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from ncgear.contact.designed.as_designed import contacts_within
from ncgear.contact.designed.curves import Contacts
from ncgear.contact.designed.flanks import FlankContacts, flank_contacts
from ncgear.contact.placement import PUSHING, Placement, meetings
from ncgear.dynamics.pair_places import fixed_tangents
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import across, along, as_complex
from ncgear.teeth.gear import ToothedGear, ToothedPair

RIGID = (
    "center_distance",
    "driving_x",
    "driving_y",
    "driven_x",
    "driven_y",
    "driving_growth",
    "driven_growth",
    "housing_growth",
    "driving_index",
    "driving_wear",
    "driven_wear",
)
"""Deviations that move whole gears or all their flanks alike, in mm, rad or shares: rows of ``Deviations.rigid``."""

DISPLACING = 8
"""Number of the first rows of RIGID: they move one gear against the other, and the contact ratio follows from them."""


@dataclass(frozen=True, eq=False)
class Deviations:
    """The deviations of N assemblies.

    ``rigid`` (shape (11, N)) has the quantities of RIGID.  ``tilt`` (shape (4, N)) is the tilt of the driving bore
    about both axes in its gear's frame, then of the driven bore, in rad.  ``pitch`` and ``profile`` (shape (flanks, N),
    the driving gear's flanks first) are each flank's deviations in mm: its place along the pitch curve, with added
    material positive, and its slope, the material at the tip less the material at the root.  ``output_rad`` (shape
    (N,)) is the index error of the driven gear on its shaft.
    """

    rigid: Array
    tilt: Array
    pitch: Array
    profile: Array
    output_rad: Array

    def one(self, number: int) -> Deviations:
        """The deviations of one of the assemblies, with N = 1."""
        return Deviations(*(values[..., number : number + 1] for values in vars(self).values()))


@dataclass(frozen=True, eq=False)
class Face:
    """The sections of a pair over its face width, at heights in mm above its middle.

    With ``mirrored`` each section also stands at the opposite height: straight teeth have one section for both ends of
    the face, and both halves of herringbone teeth are alike.  ``overlap`` is the overlap ratio of the helix.
    """

    sections: tuple[ToothedPair, ...]
    heights_mm: tuple[float, ...]
    mirrored: bool
    overlap: float = 0.0


def straight_face(teeth: ToothedPair, face_width_mm: float) -> Face:
    """The face of straight teeth."""
    return Face((teeth,), (face_width_mm / 2.0,), mirrored=True)


@dataclass(frozen=True, eq=False)
class LinearMesh:
    """The linear mesh of a pair at p positions, with r places of contact.

    ``first`` (shape (2 p,)) is the first row of each side and position, pushing flanks before backs.  ``lead`` is urge
    times e0.  The other arrays have a row for each place: ``rigid`` (shape (r, 11)), ``tilt`` (shape (r, 4)), and for
    the driving and the driven flank (shape (2, r) each) its ``flank``, numbered as in ``Deviations.pitch``, its
    ``pitch_share`` and its ``profile_share``: the change of the lead by its deviations, in rad per mm.

    ``radius_mm`` (shape (p,)) is the driven pitch radius, ``arm_mm`` (shape (2, p)) the arm of each side's normal. With
    ``mirrored`` each place also stands at the opposite height.  ``arcs`` (shape (k,)) are the arcs of contact in
    pitches of all pairs of flanks, with the overlap, ``arc_rates`` (shape (k, 8)) their rates by the first rows of
    RIGID.
    """

    phi1_rad: Array
    phi2_rad: Array
    cycle_rad: float
    radius_mm: Array
    arm_mm: Array
    first: IndexArray
    lead: Array
    rigid: Array
    tilt: Array
    flank: IndexArray
    pitch_share: Array
    profile_share: Array
    mirrored: bool
    arcs: Array
    arc_rates: Array

    def leads(self, of: Deviations) -> Array:
        """The lead of the first contact on both sides at each position, in rad, shape (2, p, N)."""
        lead = self.rigid @ of.rigid
        lead += self.lead[:, None]
        if of.tilt.any():
            tilted = self.tilt @ of.tilt
            lead += np.abs(tilted) if self.mirrored else tilted
        for flank, pitch, profile in zip(self.flank, self.pitch_share, self.profile_share, strict=True):
            lead += pitch[:, None] * of.pitch[flank]
            lead += profile[:, None] * of.profile[flank]
        return np.asarray(np.maximum.reduceat(lead, self.first, axis=0).reshape(2, self.phi1_rad.size, -1))

    def least_arcs(self, of: Deviations) -> Array:
        """Least arc of contact of any pair of flanks in pitches, (N,); inf where all touch at an end of a range."""
        arcs: Array = self.arcs[:, None] + self.arc_rates @ of.rigid[:DISPLACING]
        return np.asarray(np.maximum(arcs.min(axis=0, initial=np.inf), 0.0))

    def kept(self, rows: Mask) -> LinearMesh:
        """The mesh with some of its places of contact: at least one on each side at each position."""
        counts = np.add.reduceat(rows.astype(int), self.first)
        return replace(
            self,
            first=np.cumsum(counts) - counts,
            lead=self.lead[rows],
            rigid=self.rigid[rows],
            tilt=self.tilt[rows],
            flank=self.flank[:, rows],
            pitch_share=self.pitch_share[:, rows],
            profile_share=self.profile_share[:, rows],
        )

    @cached_property
    def foremost(self) -> IndexArray:
        """The row of the first contact of the pair without deviations, shape (2, p)."""
        side = np.repeat(np.arange(self.first.size), np.diff(self.first, append=self.lead.size))
        # The last of each group by rising lead.
        order = np.lexsort((self.lead, side))
        return order[np.append(self.first[1:], self.lead.size) - 1].reshape(2, -1)


def mesh_of(face: Face, placement: Placement, within_mm: float, *, both_ways: bool = False) -> LinearMesh:
    """The linear mesh of all places that touch when the first are pressed in ``within_mm``; ``both_ways``: worn
    backs."""
    found = []
    for teeth, height in zip(face.sections, face.heights_mm, strict=True):
        touching = Contacts.joined(contacts_within(teeth, placement, within_mm))
        found.append(places_of(teeth, height, touching, placement, both_ways=both_ways))
    rows = ContactPlaces.joined(found)
    rows = rows.kept(np.argsort(rows.place, kind="stable"))
    arcs, rates = zip(*(arc_rates(teeth, placement) for teeth in face.sections), strict=True)
    mesh = mesh_at(rows, placement, np.zeros((2, placement.count)), mirrored=face.mirrored)
    arm_mm = rows.lever_mm[mesh.foremost]
    return replace(mesh, arm_mm=arm_mm, arcs=np.concatenate(arcs) + face.overlap, arc_rates=np.concatenate(rates))


def mesh_at(rows: ContactPlaces, placement: Placement, arm_mm: Array, *, mirrored: bool) -> LinearMesh:
    """The linear mesh of places of contact, sorted by ``place``, without arcs of contact."""
    return LinearMesh(
        phi1_rad=placement.phi1_rad,
        phi2_rad=placement.phi2_rad,
        cycle_rad=placement.cycle_rad,
        radius_mm=placement.driven_radius_mm,
        arm_mm=arm_mm,
        first=np.searchsorted(rows.place, np.arange(2 * placement.count)),
        lead=rows.lead,
        rigid=rows.rigid,
        tilt=rows.tilt,
        flank=np.ascontiguousarray(rows.flank.T),
        pitch_share=np.ascontiguousarray(rows.pitch_share.T),
        profile_share=np.ascontiguousarray(rows.profile_share.T),
        mirrored=mirrored,
        arcs=np.zeros(0),
        arc_rates=np.zeros((0, DISPLACING)),
    )


@dataclass(frozen=True, eq=False)
class ContactPlaces(Columns):
    """Places of contact in one section: side and position as ``place``, and the rows of ``LinearMesh``, shape (r, ...).

    Both gears have a column each.  ``lever_mm`` is the arm of the normal about the driven axis.
    """

    place: IndexArray
    lever_mm: Array
    lead: Array
    rigid: Array
    tilt: Array
    flank: IndexArray
    pitch_share: Array
    profile_share: Array


def places_of(
    teeth: ToothedPair, height_mm: float, found: Contacts, placement: Placement, *, both_ways: bool
) -> ContactPlaces:
    """The places of contacts in a section at a height above the middle of the face width."""
    place, tangent = fixed_tangents(found, placement)
    normal = 1j * placement.mesh.sense * found.urge * tangent
    lever = found.lever_mm
    turned = np.exp(1j * placement.phi1_rad), np.exp(1j * placement.mesh.sense * placement.phi2_rad)
    first_turn, second_turn = (turn[found.position] for turn in turned)
    distance, from_driven = placement.center_distance_mm, place - placement.center_distance_mm
    arms = found.urge * along(normal, 1j * place), lever
    sides = (
        _side(teeth.driving, found.driving, found, placement, normal / first_turn, arms[0]),
        _side(teeth.driven, found.driven, found, placement, -normal / second_turn, arms[1]),
    )
    worn = [np.where((found.side == PUSHING) | both_ways, -side.along, 0.0) for side in sides]
    rigid = np.column_stack(
        [
            -normal.real,
            along(normal, first_turn),
            along(normal, 1j * first_turn),
            -along(normal, second_turn),
            -along(normal, 1j * second_turn),
            along(normal, place),
            -along(normal, from_driven),
            -normal.real * distance,
            along(normal, 1j * place),
            *worn,
        ]
    )
    return ContactPlaces(
        place=found.place(placement),
        lever_mm=lever,
        lead=found.lead_rad,
        rigid=rigid / lever[:, None],
        tilt=height_mm * rigid[:, 1:5] / lever[:, None],
        flank=np.column_stack([found.driving, found.driven + teeth.driving.flanks.count]),
        pitch_share=np.column_stack([side.pitch / lever for side in sides]),
        profile_share=np.column_stack([side.share * side.along / lever for side in sides]),
    )


@dataclass(frozen=True, eq=False)
class _Side:
    """Effect of the deviations of one gear's flanks along the common normal, shape (r,) each.

    ``pitch`` is the effect of a deviation along the pitch curve, ``share`` the place on the flank, from -1/2 at its
    root to 1/2 at its tip, and ``along`` the part of the flank's own normal.
    """

    pitch: Array
    share: Array
    along: Array


def _side(
    gear: ToothedGear, flank: IndexArray, found: Contacts, placement: Placement, outwards: ComplexArray, arm_mm: Array
) -> _Side:
    """The action at each place; ``outwards`` is the normal out of the gear, in the gear's frame, with its ``arm_mm``.

    The closed form gives the height of a place; beyond the ends of a flank the end counts.
    """
    flanks = gear.flanks
    length = flanks.curve.length_mm
    ahead = flanks.crossing_mm[flank] - placement.rolled_mm[found.position] % length
    ahead = (ahead + length / 2.0) % length - length / 2.0
    slant = flanks.slant.of(flank)
    top, bottom = (ends[flank] for ends in gear.sides.flank_range())
    height = np.clip(flanks.side[flank] * slant.height_per_rolled * ahead, bottom, top)
    slope = as_complex(flanks.flank(flank, height)[1])
    part = np.abs(across(slope, outwards)) / np.abs(slope)
    share = (height - (top + bottom) / 2.0) / (top - bottom)
    return _Side(slant.cosine * arm_mm / crossing_arms_mm(gear)[flank], share, part)


def crossing_arms_mm(gear: ToothedGear) -> Array:
    """Arm about the gear's axis of each flank's normal where it crosses the pitch curve, shape (flanks,)."""
    point, slope = gear.flanks.at_pitch_line
    return np.asarray(np.abs(along(slope, point)) / np.abs(slope))


STEP_IN_MODULES = 1e-4
"""Displacement, both ways, over which the change of an arc of contact is measured; the change is smooth."""


@dataclass(frozen=True, eq=False)
class Displaced(Placement):
    """Positions with the driven gear moved by ``moved_mm`` in the fixed frame, and the driving gear scaled."""

    moved_mm: complex = 0.0j
    scale: float = 1.0

    def driving_points(self, points: ComplexArray, row: IndexArray) -> ComplexArray:
        """The points at the positions, as a placement gives them."""
        shifted: ComplexArray = self.moved_mm * np.exp(-1j * self.mesh.sense * self.phi2_rad[row])
        return super().driving_points(self.scale * points, row) - shifted


def arc_rates(teeth: ToothedPair, placement: Placement) -> tuple[Array, Array]:
    """The arcs of contact of all pairs of flanks, in pitches (shape (k,)), and their rates (shape (k, 8)).

    An arc lasts as far as both flanks reach, even where other teeth hold them apart.  The rates are differences of the
    exact contact of displaced gears: begin and end of an arc each move by the displacement at their positions.
    """
    met = meetings(teeth, placement)
    step = STEP_IN_MODULES * teeth.driving.flanks.rack.module_mm
    distance = placement.center_distance_mm

    def contacts(moved_mm: complex, scale: float) -> FlankContacts:
        given: dict[str, Any] = {field.name: getattr(placement, field.name) for field in fields(placement)}
        return flank_contacts(teeth, Displaced(**given, moved_mm=moved_mm, scale=scale), met)

    def ends(moved_mm: complex, scale: float) -> Array:
        return contacts(moved_mm, scale).reach_ends[:, lasting]

    designed = contacts(0.0j, 1.0)
    nominal = designed.reach_ends
    # Flanks that touch at an end of a range do so over a part of their arc.
    lasting = np.isfinite(nominal).all(axis=0) & designed.whole
    nominal = nominal[:, lasting]
    changes = (step, 0.0), (1j * step, 0.0), (0.0, step / distance)
    rates = []
    for moved, grown in changes:
        after, before = (ends(sign * moved, 1.0 + sign * grown) for sign in (1.0, -1.0))
        change = (after - before) / (2.0 * (abs(moved) or grown))
        rates.append(np.where(np.isfinite(change), change, 0.0))
    x_rate, y_rate, growth_rate = rates
    position = (met.position[lasting, 0] + np.rint(nominal).astype(int)) % placement.count
    first = np.exp(1j * placement.phi1_rad)[position]
    second = np.exp(1j * placement.mesh.sense * placement.phi2_rad)[position]

    def moved_by(direction: ComplexArray) -> Array:
        return x_rate * direction.real + y_rate * direction.imag

    columns = np.stack(
        [
            x_rate,
            -moved_by(first),
            -moved_by(1j * first),
            moved_by(second),
            moved_by(1j * second),
            growth_rate,
            -growth_rate - distance * x_rate,
            distance * x_rate,
        ],
        axis=-1,
    )
    pitches = np.array([-1.0, 1.0]) / placement.per_tooth
    return pitches @ nominal, np.einsum("e,ekc->kc", pitches, columns)
