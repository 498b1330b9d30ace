"""The local estimate: every tooth as a beam of its own exact outline, with the section and the notch of ISO 6336.

Each tooth has its own frame: y along its middle line towards the tip, x across, away from the middle on the analysed
side.  The middle line goes through the middle between both flanks' crossings of the pitch curve and halves the angle
between the flanks there.

**Root stress** (ISO 6336-3, method B, at any place of load; from secondary sources).  The section goes through the
points of both fillets at which the tangent leans by 30 degrees from the middle line.  With the chord s between them,
the load's moment M about the chord's middle and its part c across the middle line, h = M / c is the arm, and the stress
of a load of 1 is 6 c / s^2 times h Y_S.  The notch factor is Y_S = (1.2 + 0.13 L) q^(1 / (1.21 + 2.3 / L)), L = s / h,
q = s / (2 r), r the fillet's radius of curvature at its tangent point.  The standard counts bending alone for tension;
for compression the load's part d along the tooth adds d / s times 1.2 q^(1 / (1.21 + 2.3 / L)).  Where the pitch curve
is concave, and on rings, the tangent leans by 60 degrees, as in the standard for internal gears.  Where a fillet begins
with a greater lean, or ends with a smaller lean, its end counts.  The standard gives Y_S for q from 1 to 8 and loads at
the outer point of single contact; beyond that the formula continues, but q counts as 1 at least.

**Compliance**.  The energy of bending, shear and compression of the beam between the contact and the height at which
the first fillet passes into its root land, of the half-plane below it, and of the indentation at the contact: C.
Weber, K. Banaschek, "Formaenderung und Profilruecknahme bei gerad- und schraegverzahnten Raedern", Schriftenreihe
Antriebstechnik 11, Vieweg 1953 (from secondary sources), in plane strain.  The body that carries the teeth is a
half-plane: neither its twist nor its bore count, and neighbouring teeth that bear load do not feel each other.

**Helical teeth** are beams in the section across the tooth.  There a load of 1 for each mm of face width is a load of 1
across for each mm of tooth, and each mm of width has 1 / cos(beta) mm of tooth that yields.

ISO 6336 covers circular gears only.  On other gears all this is a local estimate.
"""

from __future__ import annotations

from functools import cached_property, lru_cache
from math import cos, pi, radians

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray
from ncgear.numerics.plane import along, as_complex
from ncgear.strength.contacts import FlankPlaces
from ncgear.strength.material import Material
from ncgear.strength.method import RootStress
from ncgear.teeth.flank import FILLET, FLANK, Flanks, flank_name
from ncgear.teeth.gear import ToothedGear

LEAN_RAD = radians(30.0)
"""Lean of the tangent at the critical section of external gears (ISO 6336-3)."""

LEAN_CONCAVE_RAD = radians(60.0)
"""The same for internal gears."""

SAMPLES = {FLANK: 33, FILLET: 65}
"""Points on each run of a side.  With five times as many compliances of the baler, a ring and an ellipse change by half
a per cent or less."""

STEP = 1e-4
"""Share of the module, in arc length, over which the fillet's turning is measured; a tenth changes radii by 1e-6."""

NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)
"""Gauss points along the beam; twice as many change compliances by 2e-4 or less."""

LEAST_REACH = 1e-3
"""Least half-width of a contact, in depths to the tooth's middle, so that an edge yields by a finite way."""

LEAST_ACROSS = 0.1
"""Least part of a load across its tooth that divides arms and depths.  Only edges touch with normals along the tooth
(beyond 84 degrees here); with this limit their loads neither bend the tooth nor meet its middle line far away."""


@dataclass(frozen=True, eq=False)
class ToothFrames:
    """The frames of z teeth: crossings of the middle lines and the pitch curve, and directions to the tips; (z,).

    Helical teeth are analysed in the section across them.  There all widths across the middle line are ``slender`` (the
    cosine of the helix angle) times the widths in the section across the axis.
    """

    origin: ComplexArray
    towards_tip: ComplexArray
    towards_front: ComplexArray
    slender: float = 1.0

    def height(self, tooth: IndexArray, point: ComplexArray) -> Array:
        """y of points of teeth (numbered from 0); shapes broadcast."""
        return along(self.towards_tip[tooth], point - self.origin[tooth])

    def outwards(self, flank: IndexArray) -> ComplexArray:
        """The direction across the middle line to the side of flanks."""
        return np.asarray(self.towards_front[flank // 2] * np.where(flank % 2 == 0, -1.0, 1.0))

    def aside(self, flank: IndexArray, point: ComplexArray) -> Array:
        """x of points, towards the side of flanks; shapes broadcast."""
        return self.slender * along(self.outwards(flank), point - self.origin[flank // 2])

    def own(self, flank: IndexArray, vector: ComplexArray) -> ComplexArray:
        """Vectors as x + i y in the frames of flanks; shapes broadcast."""
        return np.asarray(
            self.slender * along(self.outwards(flank), vector) + 1j * along(self.towards_tip[flank // 2], vector)
        )


@dataclass(frozen=True, eq=False)
class RootSections:
    """The critical sections of z teeth.

    ``tangent_point`` (2 z,) are the points of the fillets with the lean of ISO 6336-3, ``radius_mm`` (2 z,) the
    fillets' radii of curvature there, ``chord_mm`` (z,) the distances between both points of a tooth and ``middle``
    (z,) the points halfway.
    """

    tangent_point: ComplexArray
    radius_mm: Array
    chord_mm: Array

    @cached_property
    def middle(self) -> ComplexArray:
        """The middles of the chords."""
        return np.asarray((self.tangent_point[1::2] + self.tangent_point[::2]) / 2.0)


@dataclass(frozen=True, eq=False)
class Halves:
    """Both halves of all teeth: the distance of each side from the middle line over the height.

    ``key`` and ``aside_mm`` (shape (m,)) are the points of all sides, one side after the other and each from the root
    up; the key is the height plus the flank's number times ``apart_mm``.  ``low_mm`` and ``high_mm`` (2 z,) are the
    least and the greatest height of each side.
    """

    key: Array
    aside_mm: Array
    apart_mm: float
    low_mm: Array
    high_mm: Array

    def at(self, flank: IndexArray, height_mm: Array) -> Array:
        """Distances of sides from the middle line, at their ends beyond them; shapes broadcast."""
        held = np.clip(height_mm, self.low_mm[flank], self.high_mm[flank])
        return np.asarray(np.interp(held + flank * self.apart_mm, self.key, self.aside_mm))


@dataclass(frozen=True, eq=False)
class Compliance:
    """Ways in mm by which flanks yield for 1 N per mm of face width, by their causes; shape (n,) each."""

    tooth: Array
    foundation: Array
    contact: Array

    @property
    def total(self) -> Array:
        """The sum."""
        return np.asarray(self.tooth + self.foundation + self.contact)


@dataclass(frozen=True, eq=False)
class _Loads:
    """Loads of 1 at n places in the frames of their teeth, x towards the loaded side; shape (n,) each.

    ``across`` is the part of the load against x and ``down`` that against y, both positive as a rule.  For each mm
    along a helical tooth the first is that for each mm of face width, and the second less by the cosine of the helix.
    """

    tooth: IndexArray
    aside_mm: Array
    height_mm: Array
    across: Array
    down: Array


@dataclass(frozen=True, eq=False)
class Estimate:
    """The teeth of one gear as beams (``ncgear.strength.method.ToothMethod``)."""

    material: Material
    frames: ToothFrames
    halves: Halves
    sections: RootSections

    @property
    def name(self) -> str:
        """The method's word."""
        return "estimate"

    def compliance(self, places: FlankPlaces, reach_mm: Array) -> Array:
        """Way by which flanks yield along the load, shape (n,), see ``ToothMethod``."""
        return self.compliance_parts(places, reach_mm).total

    def compliance_parts(self, places: FlankPlaces, reach_mm: Array) -> Compliance:
        """As ``compliance``, divided by causes.

        Beam of sections w(y) of width 1, e(y) their middles: integral of M^2 / (E' w^3 / 12) + 1.2 c^2 / (G w)
        + d^2 / (E' w), c across and d along the middle line, E' = E / (1 - nu^2).  Foundation: (1 / E') (c^2 (18 / pi
        (u / s)^2 + 2 (1 - 2 nu) / (1 - nu) u / s + 4.8 / pi) + d^2 2 (1 - nu) / pi), s the width at the beam's foot and
        u the height over it at which the load meets the middle line.  Contact: 2 / (pi E') (ln(2 t / b) - nu / (2 (1 -
        nu))), t the depth to the middle line along the load and b the half-width ``reach_mm``.
        """
        youngs_mpa, poisson = self.material.youngs_modulus_mpa, self.material.poisson
        tooth, foundation, depth = _of_body(self.frames, self.halves, youngs_mpa, poisson, places)
        reach = np.maximum(reach_mm, LEAST_REACH * depth)
        pressed = np.maximum(np.log(2.0 * depth / reach) - poisson / (2.0 * (1.0 - poisson)), 0.0)
        modulus, wide = youngs_mpa / (1.0 - poisson**2), self.frames.slender
        return Compliance(tooth, foundation, 2.0 / (pi * modulus * wide) * pressed)

    def root_stress(self, places: FlankPlaces) -> RootStress:
        """Tension at the loaded flank's root, compression at the other root, shape (n,) each; see the module."""
        load = _loads(self.frames, places)
        chord, middle = self.sections.chord_mm[load.tooth], self.sections.middle[load.tooth]
        up = load.height_mm - self.frames.height(load.tooth, middle)
        off = load.aside_mm - self.frames.aside(places.flank, middle)
        # A load whose line passes below the section does not bend it to the other side.
        across = np.maximum(load.across, LEAST_ACROSS)
        arm = np.maximum((load.across * up - load.down * off) / across, 0.0)
        bent = 6.0 * across / chord**2

        def notch(flank: IndexArray) -> Array:
            """q^(1 / (1.21 + 2.3 / L)), written without dividing by the arm."""
            sharpness = np.maximum(chord / (2.0 * self.sections.radius_mm[flank]), 1.0)
            return np.asarray(sharpness ** (1.0 / (1.21 + 2.3 * arm / chord)))

        bending = bent * (1.2 * arm + 0.13 * chord)
        pressed = 1.2 * np.maximum(load.down, 0.0) / chord
        return RootStress(bending * notch(places.flank), (bending + pressed) * notch(places.flank ^ 1))


def _loads(frames: ToothFrames, places: FlankPlaces) -> _Loads:
    """The places and loads in the frames of their teeth."""
    tooth = places.flank // 2
    return _Loads(
        tooth,
        frames.aside(places.flank, places.point),
        frames.height(tooth, places.point),
        -along(frames.outwards(places.flank), places.inwards),
        -frames.slender * along(frames.towards_tip[tooth], places.inwards),
    )


@lru_cache(maxsize=128)
def _of_body(
    frames: ToothFrames, halves: Halves, youngs_mpa: float, poisson: float, places: FlankPlaces
) -> tuple[Array, Array, Array]:
    """The compliances of teeth and of their foundations, and the depths to the middle lines along the loads; (n,) each.

    Kept, like the places: only the contact's part changes with the load for each mm of width.
    """
    load = _loads(frames, places)
    modulus, shear = youngs_mpa / (1.0 - poisson**2), youngs_mpa / (2.0 * (1.0 + poisson))
    foot = halves.low_mm.reshape(-1, 2).max(axis=1)[load.tooth]
    length = np.maximum(load.height_mm - foot, 0.0)
    # A row for each node: heights of neighbouring loads differ little, so their places in the table are near.
    height = foot + length * (NODES[:, None] + 1.0) / 2.0
    near, far = (halves.at(flank, height) for flank in (places.flank, places.flank ^ 1))
    width, off = near + far, (near - far) / 2.0
    moment = load.across * (load.height_mm - height) - load.down * (load.aside_mm - off)
    bent, pressed_down = 12.0 / modulus * moment * moment, load.down**2 / modulus
    energy = (bent / (width * width) + pressed_down + 1.2 / shear * load.across**2) / width
    tooth = length / 2.0 * (WEIGHTS @ energy)

    root, other = (halves.at(flank, foot) for flank in (places.flank, places.flank ^ 1))
    # The moment about the foot's middle is the load's part across times its arm u.
    turning = load.across * length - load.down * (load.aside_mm - (root - other) / 2.0)
    slender = turning / (root + other)
    foundation = 18.0 / pi * slender**2 + 2.0 * (1.0 - 2.0 * poisson) / (1.0 - poisson) * slender * load.across
    foundation += 4.8 / pi * load.across**2 + 2.0 * (1.0 - poisson) / pi * load.down**2

    thick = halves.at(places.flank, load.height_mm) + halves.at(places.flank ^ 1, load.height_mm)
    depth = thick / 2.0 / np.maximum(load.across, LEAST_ACROSS)
    return tooth / frames.slender, foundation / (modulus * frames.slender), depth


def estimate_of(gear: ToothedGear, material: Material, helix_rad: float = 0.0) -> Estimate:
    """The estimate for the teeth of one gear, or of a section of a helical gear.

    Raises NoSuchMechanism for a flank without a fillet, and names the flank.
    """
    return Estimate(material, *_beams_of(gear, cos(helix_rad)))


@lru_cache(maxsize=4)
def _beams_of(gear: ToothedGear, slender: float) -> tuple[ToothFrames, Halves, RootSections]:
    """The teeth of a gear but for their material; kept as the compliance of their bodies, which depends on them."""
    flanks, sides = gear.flanks, gear.sides
    frames = _frames(flanks, slender)
    runs = {kind: np.flatnonzero(sides.kind == kind) for kind in SAMPLES}
    bare = np.flatnonzero(np.bincount(sides.owner[runs[FILLET]], minlength=flanks.count) == 0)
    if bare.size:
        raise NoSuchMechanism(
            f"{flank_name(flanks, int(bare[0]))} has no fillet left: the estimate finds no notch there; strength by "
            "elements is needed",
            key="gears",
        )
    sampled = []
    for kind, curve in ((FLANK, flanks.flank), (FILLET, flanks.fillet)):
        rows = runs[kind]
        # Close together at both ends, where a fillet turns fastest.
        share = (1.0 - np.cos(np.linspace(0.0, pi, SAMPLES[kind]))) / 2.0
        start, end = sides.start[rows, None], sides.end[rows, None]
        parameter = start + (end - start) * share
        owner = np.broadcast_to(sides.owner[rows, None], parameter.shape)
        point, slope = (as_complex(array) for array in curve(owner, parameter))
        # From the tip inwards a fillet's arc length and a flank's height run as the run does.
        lean = _lean(frames, owner, slope * np.sign(end - start))
        sampled.append((owner.ravel(), parameter.ravel(), point.ravel(), lean.ravel()))
    owner, _, point, lean = (np.concatenate(arrays) for arrays in zip(*sampled, strict=True))
    # Beyond a lean of a right angle, on rings, the fillet rises again.
    falling = lean < pi / 2.0
    halves = _halves(frames, owner[falling], point[falling], flanks.count)
    return frames, halves, _sections(flanks, frames, *sampled[1])


def _frames(flanks: Flanks, slender: float) -> ToothFrames:
    point, rise = flanks.at_pitch_line
    rise = rise / np.abs(rise)
    back, front = point[::2], point[1::2]
    tip = rise[::2] + rise[1::2]
    tip = tip / np.abs(tip)
    side = 1j * tip * np.sign(along(1j * tip, front - back))
    return ToothFrames((back + front) / 2.0, tip, side, slender)


def _lean(frames: ToothFrames, flank: IndexArray, inwards: ComplexArray) -> Array:
    """Angle in rad between sides and the middle line, positive where the tooth gets wider towards its root."""
    own = frames.own(flank, inwards)
    return np.arctan2(own.real, -own.imag)


def _halves(frames: ToothFrames, flank: IndexArray, point: ComplexArray, count: int) -> Halves:
    height, aside = frames.height(flank // 2, point), frames.aside(flank, point)
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, flank, height)
    np.maximum.at(high, flank, height)
    apart = 4.0 * float(np.max(np.abs(height)))
    key = height + flank * apart
    order = np.argsort(key, kind="stable")
    return Halves(key[order], aside[order], apart, low, high)


def _sections(
    flanks: Flanks, frames: ToothFrames, flank: IndexArray, sigma: Array, point: ComplexArray, lean: Array
) -> RootSections:
    """The critical sections from samples of the fillets, flank after flank, each from the tip inwards."""
    every = np.arange(flanks.count)
    concave = flanks.crossings.curvature.reshape(-1, 2).sum(axis=1) < 0.0
    wanted = np.where(np.repeat(concave, 2), LEAN_CONCAVE_RAD, LEAN_RAD)
    first = np.searchsorted(flank, every)
    last = np.searchsorted(flank, every, side="right") - 1
    # The last crossing of the wanted lean; the beginning or the end of the fillet where there is no crossing.
    passing = np.flatnonzero((lean[:-1] < wanted[flank[:-1]]) & (lean[1:] >= wanted[flank[1:]]) & (np.diff(flank) == 0))
    before = np.where(lean[first] >= wanted, first, last)
    before[flank[passing]] = passing
    after = before.copy()
    after[flank[passing]] = np.minimum(before[flank[passing]] + 1, last[flank[passing]])
    step = STEP * flanks.rack.module_mm
    way = np.sign(sigma[last] - sigma[first])

    def leaning(at: Array) -> tuple[ComplexArray, Array, Array]:
        """Points, leans and speeds of the fillets."""
        place, slope = (as_complex(array) for array in flanks.fillet(every, at))
        return place, _lean(frames, every, slope * way), np.abs(frames.own(every, slope))

    low, high = sigma[before], sigma[after]
    at = (low + high) / 2.0
    for _ in range(BISECTIONS):
        at = (low + high) / 2.0
        over = leaning(at)[1] >= wanted
        low, high = np.where(over, low, at), np.where(over, at, high)
    place, _, speed = leaning(at)
    turned = leaning(at + step * way / speed)[1] - leaning(at - step * way / speed)[1]
    chord = np.abs(frames.own(every[1::2], place[1::2] - place[::2]))
    return RootSections(place, 2.0 * step / np.abs(turned), chord)


BISECTIONS = 12
"""Halvings of a sample's span, which place the tangent point: chords and stresses are right to 3e-5."""
