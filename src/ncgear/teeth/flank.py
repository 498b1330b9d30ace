"""The curves that bound a tooth, each the exact envelope of one part of a tool that rolls on the pitch curve.

Everything is written in the gear's own moving frame: P the pitch point at arc length sigma, T the unit tangent, N the
unit normal away from the gear.  A flank is named by the arc length c at which it crosses the pitch curve and by its
side s, +1 for the flank that faces growing arc length.

Flank: the rack's straight side touches where its normal goes through the pitch point, at height h above the tangent: X
= P + h (s cot(alpha) T + N), sigma = c - s h / (sin(alpha) cos(alpha)).  Its speed along itself by sigma is sin(alpha)
+ h k / sin(alpha), k being the pitch curve's curvature.  Where that vanishes (sin^2(alpha) + h k = 0), the flank has a
cusp and ends: below the pitch curve on convex stretches, where the tool cuts the part beyond away (undercut), above it
on concave stretches.

Fillet: the envelope of the rounded tip of a tool (tool.py) whose rolling curve has the curvature k_t.  The rounding's
centre rests in the tool.  With u T + v N from P to it, the point that touches lies on the line from P through the
centre, one radius rho beyond.  With K = k + k_t the centre moves by K (v T - u N) per unit of sigma, and the fillet
runs along itself with K (D + rho) - rho v / D^2, D being the distance from P to the centre; it bounds the tooth where
that is positive, and folds where the sign changes.

Source of the principle: F. L. Litvin and A. Fuentes, "Gear Geometry and Applied Theory", 2nd edition, Cambridge 2004,
chapters 6 (envelopes, singularities) and 12 (noncircular gears).

Equivalent-gear method, on request: each flank is the involute of the circular gear of the local radius of curvature,
where the flank crosses the pitch curve.  Exact where the curvature is constant; else the flank strays with the
curvature's change over the distance rolled.  J. Wang, C. Wang and L. Miao call it the conversion tooth profile method
and used it for their baler.

A flank, with its fillet and its rolling curve, may be turned about the gear's axis: so idle flanks make room for play
(backlash.py).  Heights, arc lengths and regularity do not depend on that.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from math import lcm, remainder

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import along, as_complex, as_points, cross
from ncgear.numerics.units import in_words
from ncgear.pitch.curve import ClosedPitchCurve, CurvePoints
from ncgear.pitch.shape import Gear
from ncgear.teeth.form import BasicRack, Slant
from ncgear.teeth.shifts import ToothShifts
from ncgear.teeth.tool import Rounding, Tool, rounding_of

FLANK, FILLET = 0, 1
"""The kinds of curve along a tooth's side, from the tip inwards."""


@dataclass(frozen=True, eq=False)
class SpaceTurn:
    """The change of the bottoms of spaces from the turn of a front flank to the turn of the back flank behind it.

    A place in a space is given by the arc length of its land, continued along both fillets: the fillet of a flank that
    ends at ``end_mm`` is at end - pace (sigma - end), at the speed of the land; shape (2 z,) each.  The turn of the
    bottom after each tooth changes about the place ``at_mm``, where it is deepest, within ``reach_mm`` to either side,
    shape (z,) each.
    """

    end_mm: Array
    pace: Array
    at_mm: Array
    reach_mm: Array


@dataclass(frozen=True, eq=False)
class Flanks:
    """All flanks of a gear in the order of arc length: back and front flank of tooth 1, of tooth 2, and so on.

    The arrays have shape (2 z,), z being the number of teeth.  ``crossing_mm`` is the arc length at which a flank
    crosses the pitch curve; ``side`` is -1 for back and +1 for front flanks.  ``tip_height_mm`` is the distance of the
    tip land from the pitch curve; ``flank_depth_mm`` is the depth below the rack's pitch line at which the flank passes
    into its fillet.  The fillet is left by ``tool``, with a tip rounded by ``root_radius_mm``.  ``turn_rad`` is the
    turn of a flank about the gear's axis, counter-clockwise; fillets turn like their flanks, but change to the turn of
    the other side of the space where ``sweep`` says so.  ``full_tip_mm`` and ``full_root_mm`` are the rack's height of
    the tip and depth of the space beside each flank, profile shift included.  With ``equivalent`` flanks roll on the
    circle of curvature at their crossing instead of on the pitch curve.  A gear that turns less than once has only the
    first ``made`` teeth.
    """

    curve: ClosedPitchCurve
    rack: BasicRack
    crossing_mm: Array
    side: Array
    tip_height_mm: Array
    flank_depth_mm: Array
    root_radius_mm: Array
    tool: Tool
    turn_rad: Array
    full_tip_mm: Array
    full_root_mm: Array
    equivalent: bool = False
    sweep: SpaceTurn | None = None
    made: int | None = None

    @property
    def count(self) -> int:
        """Number of flanks, twice the number of teeth."""
        return len(self.crossing_mm)

    @property
    def teeth(self) -> int:
        """Number of existing teeth."""
        return self.count // 2 if self.made is None else self.made

    @property
    def is_made(self) -> Mask:
        """Which flanks are made, shape (2 z,)."""
        return np.arange(self.count) < 2 * self.teeth

    @property
    def tooth(self) -> IndexArray:
        """Number of each flank's tooth, from 1."""
        return np.arange(self.count) // 2 + 1

    @property
    def has_own_shifts(self) -> bool:
        """Whether teeth have profile shifts of their own, besides the rack's."""
        return bool(np.any(self.full_tip_mm != self.rack.tip_height_mm))

    @cached_property
    def idle(self) -> Mask:
        """Which flanks do not push: the driving gear pushes with its back flanks onto the driven front flanks."""
        return self.side > 0.0 if self.curve.gear is Gear.DRIVING else self.side < 0.0

    @cached_property
    def slant(self) -> Slant:
        """The slants of all flanks."""
        return self.rack.slant(self.idle)

    @cached_property
    def rounding(self) -> Rounding:
        """The tool's rounded tip at each flank."""
        depth, radius = self.flank_depth_mm, self.root_radius_mm
        return rounding_of(self.tool, self.rack.module_mm, self.slant, self.crossing_mm, self.side, depth, radius)

    @cached_property
    def is_turned(self) -> bool:
        """Whether any flank is turned."""
        return bool(np.any(self.turn_rad))

    @property
    def unturned(self) -> Flanks:
        """The flanks without play: as they meet when each side touches."""
        return replace(self, turn_rad=np.zeros(self.count), sweep=None) if self.is_turned else self

    @property
    def pulling(self) -> Flanks:
        """The flanks in the position where the idle flanks touch; these are then at the law's angle."""
        return replace(self, turn_rad=self.turn_rad - self.turn_rad[0]) if self.is_turned else self

    def with_tips(self, height_mm: Array) -> Flanks:
        """The flanks with tips of other heights; the same flanks where no height differs."""
        return replace(self, tip_height_mm=height_mm) if np.any(height_mm != self.tip_height_mm) else self

    @property
    def lift_mm(self) -> Array:
        """Way by which the play moves the pitch curve in or out at each flank's crossing, shape (2 z,); 0 without."""
        at = self.crossings
        return np.abs(np.ptp(self.turn_rad) * cross(at.position, at.normal))

    @property
    def root_depth_mm(self) -> Array:
        """Depth of the root land below the pitch curve at each flank's end of it, shape (2 z,)."""
        return self.rounding.depth_mm

    @cached_property
    def crossings(self) -> CurvePoints:
        """Crossings of all flanks with the pitch curve, unturned, shape (2 z,)."""
        return self.curve.at_length(self.crossing_mm)

    @cached_property
    def at_pitch_line(self) -> tuple[ComplexArray, ComplexArray]:
        """Points of all flanks at the rack's pitch line, and their derivatives by the height, shape (2 z,)."""
        point, slope = self.flank(np.arange(self.count), np.zeros(self.count))
        return as_complex(point), as_complex(slope)

    def at_rolled(self, flank: IndexArray, sigma_mm: Array) -> CurvePoints:
        """Points of given flanks' rolling curves (the pitch curve or their circles), unturned; shapes broadcast."""
        if self.equivalent:
            return on_circles(self.crossings.kept(flank), sigma_mm - self.crossing_mm[flank])
        return self.curve.at_length(sigma_mm)

    def rolling_curvature(self, flank: IndexArray, height_mm: Array) -> Array:
        """Curvatures of the rolling curves in 1/mm where flanks touch at the given heights; shapes broadcast."""
        rolled = self.rolled_mm(flank, height_mm)
        if self.equivalent:
            return np.broadcast_to(self.crossings.curvature[flank], rolled.shape)
        return self.curve.curvature_at(rolled)

    @cached_property
    def _turn(self) -> ComplexArray:
        return np.exp(1j * self.turn_rad)

    def _standing(self, flank: IndexArray, point: ComplexArray, slope: ComplexArray) -> tuple[Array, Array]:
        """Unturned points and derivatives, turned as the given flanks; shapes broadcast."""
        if self.is_turned:
            turn = self._turn[flank]
            point, slope = point * turn, slope * turn
        return as_points(point), as_points(slope)

    def rolled_mm(self, flank: IndexArray, height_mm: Array) -> Array:
        """Arc length of the pitch point when the flank touches at the given heights; shapes broadcast."""
        return self.crossing_mm[flank] - self.side[flank] * height_mm / self.slant.of(flank).height_per_rolled

    def flank(self, flank: IndexArray, height_mm: Array) -> tuple[Array, Array]:
        """Points of flanks at heights over the rack's pitch line, and their derivatives by the height."""
        slant, side = self.slant.of(flank), self.side[flank]
        at = self.at_rolled(flank, self.rolled_mm(flank, height_mm))
        tangent, normal = as_complex(at.tangent), as_complex(at.normal)
        slope = (slant.sine + height_mm * at.curvature / slant.sine) / slant.height_per_rolled
        inwards = slant.cosine * normal - side * slant.sine * tangent
        point = as_complex(at.position) + height_mm * (side / slant.tangent * tangent + normal)
        if self.rack.relief is None:
            return self._standing(flank, point, slope * inwards)
        outwards = side * slant.cosine * tangent + slant.sine * normal
        taken, taken_slope = self._relieved(height_mm)
        slope = slope - taken * at.curvature / slant.height_per_rolled
        return self._standing(flank, point - taken * outwards, slope * inwards - taken_slope * outwards)

    def _relieved(self, height_mm: Array) -> tuple[Array, Array]:
        """Depth of the tip relief along the normal at given heights, and its derivative by the height."""
        relief = self.rack.relief
        assert relief is not None
        length = relief.full_mm - relief.start_mm
        share = np.maximum(height_mm - relief.start_mm, 0.0) / length
        return relief.amount_mm * share**2, 2.0 * relief.amount_mm * share / length

    def curvature(self, flank: IndexArray, height_mm: Array) -> Array:
        """Curvature of flanks in 1/mm at heights, positive where they bulge out of the tooth; shapes broadcast.

        The tangent turns with the rolling curve's tangent, by k per mm rolled, while the flank runs along itself.  On
        tip relief, the change of k also changes its slope, which is left out.
        """
        slant = self.slant.of(flank)
        turning = self.rolling_curvature(flank, height_mm)
        slope = (slant.sine + height_mm * turning / slant.sine) / slant.height_per_rolled
        turning = turning / slant.height_per_rolled
        relief = self.rack.relief
        if relief is None:
            return np.asarray(turning / slope)
        taken, taken_slope = self._relieved(height_mm)
        bend = np.where(
            height_mm > relief.start_mm, 2.0 * relief.amount_mm / (relief.full_mm - relief.start_mm) ** 2, 0.0
        )
        slope, change = slope - taken * turning, turning / slant.sine - taken_slope * turning
        squared = slope * slope + taken_slope * taken_slope
        return np.asarray((turning + (bend * slope - taken_slope * change) / squared) / np.sqrt(squared))

    def regularity(self, flank: IndexArray, height_mm: Array) -> Array:
        """sin^2(alpha) + h k: positive on a flank that exists, zero at a cusp."""
        return self.slant.of(flank).sine ** 2 + height_mm * self.rolling_curvature(flank, height_mm)

    def surely_regular(self, flank: IndexArray, height_mm: Array) -> Mask:
        """Which flanks bounds of the curvature prove regular from the pitch line to given heights, shape (n,)."""
        ends = np.sort([self.crossing_mm[flank], self.rolled_mm(flank, height_mm)], axis=0)
        least = np.min([height_mm * bound for bound in self.curve.curvature_between(*ends)], axis=0)
        return self.slant.of(flank).sine ** 2 + np.minimum(least, 0.0) > 0.0

    def fillet_regularity(self, flank: IndexArray, sigma_mm: Array) -> Array:
        """K (D + rho) - rho v / D^2: positive where the fillet bounds the tooth."""
        at, tool = self.at_rolled(flank, sigma_mm), self.tool.at_length(sigma_mm)
        _, v, distance = self._arm(flank, tool)
        return _fillet_regularity(at.curvature + tool.curvature, v, distance, self.root_radius_mm[flank])

    def _arm(self, flank: IndexArray, tool: CurvePoints) -> tuple[Array, Array, Array]:
        """u, v and D of the roundings' centres from the tool's rolling points."""
        arm = as_complex(self.rounding.center_mm)[flank] - as_complex(tool.position)
        u, v = along(as_complex(tool.tangent), arm), -along(as_complex(tool.normal), arm)
        return u, v, np.sqrt(u * u + v * v)

    def fillet(self, flank: IndexArray, sigma_mm: Array) -> tuple[Array, Array]:
        """Points cut by the tool's rounded tip when the pitch point is at sigma, and derivatives by sigma."""
        at, tool = self.at_rolled(flank, sigma_mm), self.tool.at_length(sigma_mm)
        (u, v, distance), radius = self._arm(flank, tool), self.root_radius_mm[flank]
        tangent, normal = as_complex(at.tangent), as_complex(at.normal)
        speed = _fillet_regularity(at.curvature + tool.curvature, v, distance, radius) / distance
        point = as_complex(at.position) + (1.0 + radius / distance) * (u * tangent + v * normal)
        slope = speed * (v * tangent - u * normal)
        if self.sweep is None:
            return self._standing(flank, point, slope)
        # A back flank is in the space after the tooth before; the first space begins before the seam.
        tooth, teeth = (flank - 1) // 2, self.count // 2
        end, pace = self.sweep.end_mm[flank], self.sweep.pace[flank]
        place = end - pace * (sigma_mm - end) - self.curve.length_mm * (tooth // teeth)
        return self.bottom(tooth % teeth, place, -pace, (as_points(point), as_points(slope)))

    def curve_of(self, kind: IndexArray, flank: IndexArray, parameter: Array) -> tuple[Array, Array]:
        """Points and derivatives of n mixed curves (kinds FLANK, FILLET) at parameters of shape (n, ...)."""
        point, slope = np.empty((*parameter.shape, 2)), np.empty((*parameter.shape, 2))
        rows = flank.reshape(-1, *[1] * (parameter.ndim - 1))
        for number, curve in ((FLANK, self.flank), (FILLET, self.fillet)):
            mask = kind == number
            if mask.any():
                point[mask], slope[mask] = curve(rows[mask], parameter[mask])
        return point, slope

    def offset(self, sigma_mm: Array, height_mm: Array | float, rise: Array | float = 0.0) -> tuple[Array, Array]:
        """Curves at distances, which grow by ``rise`` per mm, from the unturned pitch curve, and derivatives."""
        at = self.curve.at_length(sigma_mm)
        tangent, normal = as_complex(at.tangent), as_complex(at.normal)
        point = as_complex(at.position) + height_mm * normal
        return as_points(point), as_points((1.0 + height_mm * at.curvature) * tangent + rise * normal)

    def over_tip(self, tooth: IndexArray, share: Array, rate: Array, land: tuple[Array, Array]) -> tuple[Array, Array]:
        """Tip lands and derivatives (``land``), turned as the flanks at both ends.

        ``share`` grows by ``rate`` along each tooth, numbered from 0, from its back to its front flank.
        """
        first, last = self.turn_rad[2 * tooth], self.turn_rad[2 * tooth + 1]
        return _turned(land, first + (last - first) * share, (last - first) * rate) if self.is_turned else land

    def bottom(
        self, tooth: IndexArray, place_mm: Array, pace: Array | float, curve: tuple[Array, Array]
    ) -> tuple[Array, Array]:
        """Bottoms of spaces (``curve``) and derivatives, turned by ``sweep``, at places after numbered teeth.

        The places grow by ``pace``, teeth count from 0; shapes broadcast.
        """
        if self.sweep is None:
            return curve
        first, last = self.turn_rad[2 * tooth + 1], self.turn_rad[(2 * tooth + 2) % self.count]
        reach = self.sweep.reach_mm[tooth]
        way = np.clip((place_mm - self.sweep.at_mm[tooth]) / reach, -1.0, 1.0)
        # Even at both ends up to the curvature.
        share, rate = (8.0 + way * (15.0 - way**2 * (10.0 - 3.0 * way**2))) / 16.0, 15.0 * (1.0 - way**2) ** 2 / 16.0
        return _turned(curve, first + (last - first) * share, (last - first) * rate / reach * pace)


def _fillet_regularity(turning: Array, v: Array, distance: Array, radius: Array) -> Array:
    """K (D + rho) - rho v / D^2."""
    return turning * (distance + radius) - radius * v / (distance * distance)


def _turned(curve: tuple[Array, Array], angle_rad: Array, rate: Array | float) -> tuple[Array, Array]:
    turn = np.exp(1j * angle_rad)
    point, slope = (as_complex(array) * turn for array in curve)
    return as_points(point), as_points(slope + 1j * rate * point)


def on_circles(touched: CurvePoints, rolled_mm: Array) -> CurvePoints:
    """Points at arc lengths ``rolled_mm`` along the circles that touch a curve at ``touched``; shapes broadcast."""
    tangent, normal = as_complex(touched.tangent), as_complex(touched.normal)
    curvature = np.broadcast_to(touched.curvature, rolled_mm.shape)
    turned = rolled_mm * curvature
    # Along and across without dividing by the curvature, which may vanish: sin(x) / x and (1 - cos x) / x.
    ahead = rolled_mm * np.sinc(turned / np.pi)
    aside = rolled_mm * np.sin(turned / 2.0) * np.sinc(turned / (2.0 * np.pi))
    cosine, sine = np.cos(turned), np.sin(turned)
    return CurvePoints(
        as_points(as_complex(touched.position) + ahead * tangent - aside * normal),
        as_points(cosine * tangent - sine * normal),
        touched.outside,
        curvature,
    )


def flanks_of(
    curve: ClosedPitchCurve,
    rack: BasicRack,
    teeth: int,
    tool: Tool,
    start_mm: float,
    half_widths_mm: tuple[float, float] | None = None,
    idle_turn_rad: float = 0.0,
    *,
    shifts: ToothShifts | None = None,
    equivalent: bool = False,
    made: int | None = None,
) -> Flanks:
    """The flanks of a gear with ``teeth`` teeth at full height and depth.

    Tooth 1 stands at the arc length ``start_mm``, less whole turns, so that every tooth keeps its number.  From there
    its back and its front flank are ``half_widths_mm`` away, by default a quarter of a pitch.  The driven gear's idle
    flanks, which are its back flanks, are turned by ``idle_turn_rad``.  With ``shifts`` each tooth and each space has a
    profile shift of its own besides the rack's.
    """
    centers = remainder(start_mm, curve.length_mm) + np.arange(teeth) * (curve.length_mm / teeth)
    side = np.tile([-1.0, 1.0], teeth)
    quarter = rack.pitch_mm / 4.0
    half_width = np.tile(half_widths_mm or (quarter, quarter), teeth)
    every = np.ones(2 * teeth)
    tip, root = rack.tip_height_mm * every, rack.root_depth_mm * every
    if shifts is not None:
        half_width = half_width + shifts.outwards_mm
        tip, root = tip + np.repeat(shifts.tooth_mm, 2), root - shifts.beside_flanks_mm
    idle = side > 0.0 if curve.gear is Gear.DRIVING else side < 0.0
    return Flanks(
        curve,
        rack,
        np.repeat(centers, 2) + side * half_width,
        side,
        tip,
        root - rack.root_radius_mm * (1.0 - rack.slant(idle).sine),
        rack.root_radius_mm * every,
        tool,
        np.where(side < 0.0, idle_turn_rad, 0.0),
        tip,
        root,
        equivalent,
        made=made,
    )


def mating_flanks(driving_teeth: int, driven_teeth: int) -> tuple[IndexArray, IndexArray]:
    """Numbers of the driving and of the driven flank of every pair that ever meets, shape (2 lcm,) each.

    A driving tooth's front flank crosses a quarter pitch after its middle, and meets there the back flank of the driven
    tooth half a pitch later; its back flank meets the front flank of the driven tooth half a pitch before.
    """
    meeting = np.arange(lcm(driving_teeth, driven_teeth))
    own, ahead, behind = meeting % driving_teeth, meeting % driven_teeth, (meeting - 1) % driven_teeth
    return np.concatenate([2 * own + 1, 2 * own]), np.concatenate([2 * ahead, 2 * behind + 1])


def made_mates(driving: Flanks, driven: Flanks) -> tuple[IndexArray, IndexArray]:
    """``mating_flanks`` of two gears, for flanks that exist on both."""
    one, other = mating_flanks(driving.count // 2, driven.count // 2)
    both = driving.is_made[one] & driven.is_made[other]
    return one[both], other[both]


def flank_name(flanks: Flanks, flank: int) -> str:
    """A flank in the words of messages, with the driving angle at which it crosses the pitch point."""
    facing = "front" if flanks.side[flank] > 0 else "back"
    phi1 = float(flanks.curve.driving_angle(flanks.crossing_mm[flank : flank + 1])[0])
    gear = flanks.curve.gear.value
    return f"the {facing} flank of tooth {flanks.tooth[flank]} of the {gear} gear (phi1 = {in_words(phi1)})"
