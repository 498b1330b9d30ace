"""The tool that leaves the fillets: a rack, a pinion cutter, or the mating gear itself with rounded tips.

A tool is described by the curve with which it rolls on the pitch curve, in the tool's own frame: a straight line, a
circle, or the mate's pitch curve.  Its teeth are conjugate to the gear's, so the working flanks are the same with every
tool; its rounded tip leaves the fillet.

In the tool's frame, with the pitch point at sigma: the flank touches at depth f below the pitch curves' tangent when
sigma = c + s f / (sin(alpha) cos(alpha)); one radius along the flank's normal from there is the rounding's centre
Q = P_t + u T_t - v N_t,  u = s cos(alpha) (rho - f / sin(alpha)),  v = rho sin(alpha) - f.  It is right under the pitch
point where Q is nearest to the tool's curve, and reaches one radius deeper than Q there.
"""

from __future__ import annotations

from math import ceil, cos, pi, sin

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import along, as_complex
from ncgear.numerics.units import in_words
from ncgear.pitch.curve import ClosedPitchCurve, CurvePoints, RollingCurve, nearest
from ncgear.pitch.pair import STRAIGHT, PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.form import BasicRack, CutterKind, Slant, ToothForm

AGREEMENT = 1e-11
"""Distance, in modules, at which two points or curves count as meeting: about 1000 rounding errors of a gear of 20
modules."""


@dataclass(frozen=True)
class RackLine:
    """The pitch line of a rack: the tool of a hob, and of every cutter that moves straight."""

    def at_length(self, sigma_mm: Array) -> CurvePoints:
        """The x axis; the rack's material lies above it."""
        position, tangent = np.zeros((2, *np.shape(sigma_mm), 2))
        position[..., 0], tangent[..., 0] = sigma_mm, 1.0
        return CurvePoints(position, tangent, -1.0, np.zeros(np.shape(sigma_mm)))

    def flank_depth_mm(self, slant: Slant, depth_mm: Array, radius_mm: Array) -> Array:
        """How deep the straight flank goes on a tool tooth of a depth and a tip radius."""
        return depth_mm - radius_mm * (1.0 - slant.sine)

    def flank_depth_per_radius(self, slant: Slant, depth_mm: Array, radius_mm: Array) -> Array:
        """How fast that depth grows with the radius."""
        return np.zeros_like(depth_mm) - (1.0 - slant.sine)


@dataclass(frozen=True)
class PinionCircle:
    """The pitch circle of a pinion cutter (shaper) with whole ``teeth``."""

    teeth: int
    module_mm: float

    @property
    def radius_mm(self) -> float:
        """Pitch radius."""
        return self.teeth * self.module_mm / 2.0

    def at_length(self, sigma_mm: Array) -> CurvePoints:
        """The circle about (0, 0), touched from below at sigma = 0 and run counter-clockwise."""
        angle = sigma_mm / self.radius_mm - pi / 2.0
        outward = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        tangent = np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
        return CurvePoints(self.radius_mm * outward, tangent, -1.0, np.full(np.shape(sigma_mm), 1.0 / self.radius_mm))

    def flank_depth_mm(self, slant: Slant, depth_mm: Array, radius_mm: Array) -> Array:
        """How deep the involute goes on a tool tooth of a depth and a tip radius.

        The rounding's centre runs on an involute of the same base circle R cos(alpha); at the depth f of the contact
        its distance to the base circle's tangent point is R sin(alpha) + f / sin(alpha) - rho.
        """
        tangent = self._tangent(slant, depth_mm, radius_mm)
        return slant.sine * (tangent - self.radius_mm * slant.sine + radius_mm)

    def flank_depth_per_radius(self, slant: Slant, depth_mm: Array, radius_mm: Array) -> Array:
        """How fast that depth grows with the radius."""
        out = self.radius_mm + depth_mm - radius_mm
        return slant.sine * (1.0 - out / self._tangent(slant, depth_mm, radius_mm))

    def _tangent(self, slant: Slant, depth_mm: Array, radius_mm: Array) -> Array:
        """Distance of the rounding's centre from the point where its flank's normal touches the base circle."""
        out, base = self.radius_mm + depth_mm - radius_mm, self.radius_mm * slant.cosine
        return np.sqrt(out**2 - base**2)


Tool = RackLine | PinionCircle | ClosedPitchCurve
"""The tool that leaves a gear's fillets; a pitch curve stands for the mating gear."""


@dataclass(frozen=True, eq=False)
class Rounding:
    """Roundings of the tool's tip, a rounding for each of n flanks.

    ``lowest_mm`` (shape (n,)) is the arc length at which the rounding is right under the pitch point, ``depth_mm``
    (shape (n,)) its depth below the pitch curve there, and ``center_mm`` (shape (n, 2)) its centre in the tool's frame.
    NaN where the tool's tooth is too pointed for such a rounding.
    """

    lowest_mm: Array
    depth_mm: Array
    center_mm: Array


def rounding_of(
    tool: RollingCurve,
    module_mm: float,
    slant: Slant,
    crossing_mm: Array,
    side: Array,
    flank_depth_mm: Array,
    radius_mm: Array,
) -> Rounding:
    """The roundings of flanks that cross at ``crossing_mm`` and end at ``flank_depth_mm``, all of shape (n,).

    ``side`` is -1 for back and +1 for front flanks, ``slant`` theirs; ``radius_mm`` is the radius of each rounding.
    """
    sigma = crossing_mm + side * flank_depth_mm / slant.height_per_rolled
    at = tool.at_length(sigma)
    u = side * slant.cosine * (radius_mm - flank_depth_mm / slant.sine)
    v = radius_mm * slant.sine - flank_depth_mm
    center = at.position + u[:, None] * at.tangent - v[:, None] * at.normal
    lowest, outwards = nearest(tool, center, sigma + u, AGREEMENT * module_mm)
    return Rounding(lowest, outwards + radius_mm, center)


def rounding_rates(
    tool: RollingCurve,
    slant: Slant,
    crossing_mm: Array,
    side: Array,
    depth: tuple[Array, Array],
    radius_mm: Array,
    rounding: Rounding,
) -> tuple[Array, Array]:
    """Slopes of ``lowest_mm`` and ``depth_mm`` of roundings by their radius, shape (n,) each.

    ``depth`` has the depths of the flanks' ends and their slopes by the radius; all else is as in ``rounding_of``.  A
    tool's tangent turns by its curvature k: dT = -k N, dN = k T for each mm of arc length.
    """
    flank_depth, deeper = depth
    sigma = crossing_mm + side * flank_depth / slant.height_per_rolled
    both = tool.at_length(np.concatenate([sigma, rounding.lowest_mm]))
    at, under = (both.kept(rows) for rows in np.arange(2 * sigma.size).reshape(2, -1))
    u = side * slant.cosine * (radius_mm - flank_depth / slant.sine)
    v = radius_mm * slant.sine - flank_depth
    moved = side * deeper / slant.height_per_rolled
    ahead = moved * (1.0 - v * at.curvature) + side * slant.cosine * (1.0 - deeper / slant.sine)
    inwards = moved * u * at.curvature + slant.sine - deeper
    center = ahead * as_complex(at.tangent) - inwards * as_complex(at.normal)
    arm = rounding.depth_mm - radius_mm
    lowest: Array = along(as_complex(under.tangent), center) / (1.0 + arm * under.curvature)
    return lowest, along(as_complex(under.normal), center) + 1.0


FEWER_TEETH = 10
"""A chosen pinion cutter has this many teeth fewer than a ring of the concave stretch's radius would have.  With a
smaller difference its tips foul the gear's on their way out (the rule for internal gears of full height at 20 degrees).
The chosen cutter is then checked on the curves."""

MOST_TEETH = 40
"""Most teeth of a chosen pinion cutter; common cutters have 20 to 40."""


def chosen_tools(pitch: PitchPair, form: ToothForm) -> tuple[CutterKind, tuple[Tool, Tool]]:
    """The kind of tool, and the tools that cut the driving and the driven gear.

    By default the tool is a rack for convex curves, else the mating gear, since no rack fits into a concave stretch.
    Raises NoSuchMechanism for a rack whose straight edge would cut more than HARMLESS modules into the hollow flanks of
    a concave stretch, and for a pinion cutter so large that it does the same.
    """
    kind = form.cutter.kind
    if kind is CutterKind.AUTO:
        concave = any(pitch.of(gear).bends_below(-STRAIGHT / pitch.center_distance_mm) for gear in Gear)
        kind = CutterKind.MATE if concave else CutterKind.RACK
    if kind is CutterKind.MATE:
        return kind, (pitch.driven, pitch.driving)
    if kind is CutterKind.RACK:
        _refuse_gouging(pitch, form.rack, 0.0, "a rack", "kind: mate, or kind: pinion, is needed", "gears.cutter.kind")
        return kind, (RackLine(), RackLine())
    teeth = form.cutter.teeth if form.cutter.teeth is not None else max(most_teeth(pitch, form.rack), 3)
    pinion = PinionCircle(teeth, form.rack.module_mm)
    _refuse_gouging(
        pitch,
        form.rack,
        1.0 / pinion.radius_mm,
        f"a pinion cutter of {teeth} teeth (pitch radius {pinion.radius_mm:.4g} mm)",
        "fewer cutter teeth, kind: mate, or more teeth of a smaller module are needed",
        "gears.cutter.teeth",
    )
    return kind, (pinion, pinion)


def least_concave_radius_mm(pitch: PitchPair) -> float | None:
    """Least concave radius of either gear's material, a ring's all around; None where both gears are convex."""
    low = min(pitch.curvature_range[gear][0].value for gear in Gear)
    return -1.0 / low if low * pitch.center_distance_mm < -STRAIGHT else None


def most_teeth(pitch: PitchPair, rack: BasicRack) -> int:
    """Most teeth of a pinion cutter that works in the concave stretches; may be less than 1."""
    radius = least_concave_radius_mm(pitch)
    return MOST_TEETH if radius is None else min(MOST_TEETH, int(2.0 * radius / rack.module_mm) - FEWER_TEETH)


HARMLESS = 1e-3
"""Depth in modules to which a tool may cut into hollow flanks: a micrometre at module 1, half the finest usual
tolerances of a profile's form."""

PER_MODULE = 16
"""Points of a pitch curve per module at which that depth is computed; its curvature is smooth over a module."""


def gouged_mm(curve: ClosedPitchCurve, rack: BasicRack, curvature: float = 0.0) -> float:
    """Depth to which a tool of a curvature in 1/mm (0 for a rack) cuts into the flanks of a curve's concave stretches.

    While the tool rolls from x to y it turns against the gear by the integral of K = k + curvature, and the place where
    its edge touches moves along the flank by about sin(alpha) for each mm.  So the edge that touches at x is below the
    point that is touched at y by sin(alpha) times the integral of (y - z) (-K(z)) from x to y.  Both places lie between
    the tip and the end of the straight edge, which takes a way of height / (sin(alpha) cos(alpha)).
    """
    if not curve.bends_below(-curvature):
        return 0.0
    step, depths = rack.module_mm / PER_MODULE, [0.0]
    for angle in dict.fromkeys(rack.angles_rad):
        way = ceil((rack.tip_height_mm + rack.flank_depth_mm) / (sin(angle) * cos(angle)) / step)
        around = step * np.arange(-way, ceil(curve.length_mm / step) + way + 1.0)
        turned = _summed(curve.at_length(around).curvature + curvature) * step
        sunk = _summed(turned) * step
        for steps in range(1, way + 1):
            farther = sunk[steps:] - sunk[:-steps]
            onwards, back = (at * steps * step - farther for at in (turned[:-steps], turned[steps:]))
            depths.append(sin(angle) * float(max(onwards.max(), -back.min())))
    return max(depths)


def _summed(values: Array) -> Array:
    """Integrals in steps, by trapezia, from the first of evenly spaced values to each."""
    return np.concatenate([[0.0], np.cumsum((values[1:] + values[:-1]) / 2.0)])


def _refuse_gouging(pitch: PitchPair, rack: BasicRack, curvature: float, cutter: str, remedy: str, key: str) -> None:
    """Refuse a cutter that is flatter than a concave stretch and so cuts too deep into its hollow flanks."""
    for gear in Gear:
        depth = gouged_mm(pitch.of(gear), rack, curvature)
        if not depth <= HARMLESS * rack.module_mm:
            low = pitch.curvature_range[gear][0]
            raise NoSuchMechanism(
                f"{cutter} does not go into the {gear.value} pitch curve, which is concave with a radius of "
                f"{-1.0 / low.value:.4g} mm at phi1 = {in_words(low.at)}: it would cut {depth:.3g} mm deep into the "
                f"flanks there, and {HARMLESS * rack.module_mm:.3g} mm is the most; {remedy}",
                key=key,
            )
