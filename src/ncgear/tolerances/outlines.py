"""The check of the linear mesh: the outlines of an assembly with all its deviations, turned until they touch.

The outlines belong to the exact teeth.  Points on flanks move along the normal by the flank's deviation.  The whole
outline grows, shifts from its bore and turns.  ``ncgear.contact.written`` then computes the turn of the driven gear
before chords touch.  None of this is linear.  With tilted bores both ends of the face width are checked.  The same
check without deviations gives the error of chords, which is subtracted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ncgear.contact.placement import BACK, PUSHING, Placement, placed_at
from ncgear.contact.written.as_written import reach_mm
from ncgear.contact.written.play import facing_outlines, outline_play
from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import along, as_complex, as_points, square
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Mesh
from ncgear.teeth.flank import FILLET, FLANK
from ncgear.teeth.gear import ToothedGear
from ncgear.tolerances.mesh import Deviations, Face, LinearMesh, crossing_arms_mm

ALONG = 64
"""Points along each run of a side; the nearest is sought for each vertex."""

ASTRAY = 0.01
"""Distance from a side, in modules, within which a vertex lies on it: more than chords stray, less than a tip land."""


@dataclass(frozen=True, eq=False)
class OnSides:
    """The outline of a gear (shape (n,)) and its points on the sides of teeth: on flanks and fillets.

    For these k points, shape (k,) each: ``vertex``, the ``flank`` of the side, its ``share`` of the flank's height from
    -1/2 at the root and on the fillet to 1/2 at the tip, and the unit ``normal`` that leads out of the material.
    """

    outline: ComplexArray
    vertex: IndexArray
    flank: IndexArray
    share: Array
    normal: ComplexArray

    def deviating(self, turned_rad: Array, added_mm: Array, profile_mm: Array) -> ComplexArray:
        """The outline, each side turned about the axis and given more material along normals: even part and slope."""
        point = self.outline[self.vertex]
        # Normals of fillets lead anywhere.
        on_flank = np.where(self.share > -0.5, along(self.normal, 1j * point), 0.0)
        outwards = np.sign(np.bincount(self.flank, on_flank, minlength=turned_rad.size))
        moved = added_mm[self.flank] + self.share * profile_mm[self.flank]
        outline = self.outline.copy()
        outline[self.vertex] = (point + moved * self.normal) * np.exp(1j * (outwards * turned_rad)[self.flank])
        return outline


def on_sides(gear: ToothedGear, *, ring: bool) -> OnSides:
    """The points of a gear's outline on sides of teeth; the material of a ``ring`` lies beyond its outline."""
    from scipy.spatial import cKDTree

    outline, sides, flanks = as_complex(gear.outline_mm), gear.sides, gear.flanks
    along_run = np.linspace(0.0, 1.0, ALONG)
    parameter = sides.start[:, None] + along_run * (sides.end - sides.start)[:, None]
    points, slopes = np.empty(parameter.shape, dtype=complex), np.empty(parameter.shape, dtype=complex)
    for kind, curve in ((FLANK, flanks.flank), (FILLET, flanks.fillet)):
        rows = np.flatnonzero(sides.kind == kind)
        if rows.size:
            points[rows], slopes[rows] = (
                as_complex(point) for point in curve(sides.owner[rows, None], parameter[rows])
            )
    _, nearest = cKDTree(as_points(points.ravel())).query(as_points(outline))
    run, column = np.divmod(nearest, ALONG)
    slope, between = slopes[run, column], outline - points[run, column]
    passed = along(slope, between) / square(slope)
    step = np.abs(sides.end - sides.start)[run] / (ALONG - 1)
    astray = np.abs(between - passed * slope)
    vertex = np.flatnonzero((astray <= ASTRAY * flanks.rack.module_mm) & (np.abs(passed) <= step))
    run, slope = run[vertex], slope[vertex]
    ahead = np.roll(outline, -1) - np.roll(outline, 1)
    normal = 1j * slope / np.abs(slope)
    normal = normal * np.where(along(normal, (1j if ring else -1j) * ahead[vertex]) >= 0.0, 1.0, -1.0)
    owner, height = sides.owner[run], parameter[run, column[vertex]] + passed[vertex]
    top, bottom = (ends[owner] for ends in sides.flank_range())
    share = np.where(sides.kind[run] == FLANK, (height - (top + bottom) / 2.0) / (top - bottom), -0.5)
    return OnSides(outline, vertex, owner, np.clip(share, -0.5, 0.5), normal)


ROOM_IN_MODULES = 0.02
"""Gap along the normal from which flanks are turned towards each other; other flanks get twice as much room."""


@dataclass(frozen=True, eq=False)
class OutlineSection:
    """The outlines of both gears in a section, at ``height_mm`` above the middle of the face width.

    ``turns`` is the turn of a flank, in rad per mm of its deviation along the pitch curve.
    """

    height_mm: float
    gears: tuple[OnSides, OnSides]
    turns: tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Exact:
    """Assemblies of a pair by their outlines at the positions ``rows`` of its ``mesh``.

    ``leads`` begins where flanks nearly touch by the linear mesh.  Flanks on the other side of the teeth are moved out
    of the way there, so that a pair without play is turned together like any other.
    """

    sections: tuple[OutlineSection, ...]
    mesh: LinearMesh
    placement: Placement
    rows: IndexArray
    reach_mm: float
    idle: tuple[Mask, Mask]
    module_mm: float
    both_ways: bool

    def leads(self, of: Deviations) -> Array:
        """The lead of the first contact in rad, (2, n); raises NoSuchMechanism where flanks do not meet nearby."""
        linear = self.mesh.leads(of)[:, self.rows, 0]
        ends = (-1.0, 1.0) if self.mesh.mirrored and of.tilt.any() else (1.0,)
        found = [self._in(section, of, linear, end * section.height_mm) for section in self.sections for end in ends]
        return np.asarray(np.maximum.reduce(found))

    def _in(self, section: OutlineSection, of: Deviations, linear: Array, height_mm: float) -> Array:
        distance, *moved = of.rigid[:, 0]
        first_x, first_y, second_x, second_y, *grown, housing, index, first_wear, second_wear = moved
        offsets = complex(first_x, first_y), complex(second_x, second_y)
        leaning = complex(*of.tilt[:2, 0]), complex(*of.tilt[2:, 0])
        arm = self.mesh.arm_mm[:, self.rows]
        gap = ROOM_IN_MODULES * self.module_mm
        lacking = max(float(np.max(linear.sum(axis=0) * arm)), 0.0) + 2.0 * gap
        leads = np.empty_like(linear)
        for side, urge in ((PUSHING, 1.0), (BACK, -1.0)):
            outlines, start = [], 0
            for place, gear in enumerate(section.gears):
                idle = self.idle[place]
                flanks = slice(start, start + idle.size)
                start = flanks.stop
                worn = np.where(self.both_ways | ~idle, (first_wear, second_wear)[place], 0.0)
                worn = worn + np.where(idle == (side == PUSHING), lacking, 0.0)
                outline = gear.deviating(of.pitch[flanks, 0] * section.turns[place], -worn, of.profile[flanks, 0])
                outlines.append(outline * (1.0 + grown[place]) + offsets[place] + height_mm * leaning[place])
            start_rad = urge * (linear[side] + gap / arm[side])
            placement = replace(
                self.placement,
                center_distance_mm=self.placement.center_distance_mm * (1.0 + housing) + distance,
                phi2_rad=self.placement.phi2_rad + start_rad,
            )
            turned = as_points(outlines[0] * np.exp(1j * index)), as_points(outlines[1])
            play = outline_play(facing_outlines(*turned, placement), placement, self.reach_mm)
            leads[side] = urge * (start_rad + placement.bounds_rad(play.up_rad, play.down_rad)[side])
        if not np.isfinite(leads).all():
            raise NoSuchMechanism(
                "the outlines of an assembly do not touch where its tolerances let expect it; smaller ones are needed",
                key="tolerances",
            )
        return leads


def exact_of(
    pitch: PitchPair, face: Face, placement: Placement, mesh: LinearMesh, positions: int, *, both_ways: bool = False
) -> Exact:
    """The outlines of a pair at ``positions`` or fewer of the positions of a mesh, evenly chosen."""
    rows = np.arange(0, placement.count, -(-placement.count // positions))
    ring = pitch.mesh is Mesh.INTERNAL
    sections = tuple(
        OutlineSection(
            height,
            (on_sides(teeth.driving, ring=False), on_sides(teeth.driven, ring=ring)),
            (_turns(teeth.driving), _turns(teeth.driven)),
        )
        for teeth, height in zip(face.sections, face.heights_mm, strict=True)
    )
    every = face.sections[0].driving.flanks, face.sections[0].driven.flanks
    return Exact(
        sections=sections,
        mesh=mesh,
        placement=placed_at(pitch, placement, placement.rolled_mm[rows]),
        rows=rows,
        reach_mm=max(reach_mm(pitch, teeth) for teeth in face.sections),
        idle=(every[0].idle, every[1].idle),
        module_mm=every[0].rack.module_mm,
        both_ways=both_ways,
    )


def _turns(gear: ToothedGear) -> Array:
    """Turn of each flank by a deviation along the pitch curve, in rad/mm, shape (flanks,)."""
    return np.asarray(gear.flanks.slant.of(np.arange(gear.flanks.count)).cosine / crossing_arms_mm(gear))


@dataclass(frozen=True)
class LinearError:
    """Largest error of the linear mesh against the outlines of an assembly, and of their displacement, in mm."""

    error_mm: float
    displaced_mm: float


def linear_errors(exact: Exact, assemblies: Sequence[Deviations]) -> list[LinearError]:
    """Errors of the linear mesh for assemblies along the normals, less the errors of chords without deviations."""
    mesh, arm = exact.mesh, exact.mesh.arm_mm[:, exact.rows]
    nothing = Deviations(*(np.zeros_like(values) for values in vars(assemblies[0]).values()))
    bare = exact.leads(nothing), mesh.leads(nothing)
    errors = []
    for assembly in assemblies:
        found, linear = exact.leads(assembly) - bare[0], (mesh.leads(assembly) - bare[1])[:, exact.rows, 0]
        errors.append(LinearError(float(np.max(np.abs(linear - found) * arm)), float(np.max(np.abs(found) * arm))))
    return errors
