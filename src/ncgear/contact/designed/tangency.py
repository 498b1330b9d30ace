"""The contact of two exact flanks: heights on both, and the driven angle.

Two flanks touch where their points coincide and their tangents are parallel.  For exact flanks the heights follow in
closed form, and the driven angle is the law's or, on idle flanks, beyond it by the play.  There Newton's method starts,
on the curves themselves, and checks the two conditions.  Flanks that are not conjugate (with relief, or by an
approximate method) touch at another angle, which is their transmission error.

Where the curvature jumps, the distance of such flanks may have two least values, or no point with a common tangent.
There the first touch is searched: points of the driving flank are followed along their circles about the driven axis to
the driven flank, and the search closes in on the point that arrives first.
"""

from __future__ import annotations

from dataclasses import fields
from typing import TypeVar

import numpy as np

from ncgear.contact.placement import Placement
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns, ComplexArray, IndexArray, Mask
from ncgear.numerics.plane import across, along, angle_between, as_complex, square
from ncgear.teeth.gear import ToothedPair
from ncgear.teeth.tool import AGREEMENT


@dataclass(frozen=True, eq=False)
class FacingFlanks(Columns):
    """n pairs of a driving and a driven flank, each in one position, shape (n,) each.

    ``driving_mm`` and ``driven_mm`` are the heights at which they touch by the closed form.  Where ``upward`` is +1,
    the driving gear is turned the farthest up at the first contact; where -1, the farthest down.
    """

    teeth: ToothedPair
    placement: Placement
    upward: Array
    driving: IndexArray
    driven: IndexArray
    position: IndexArray
    driving_mm: Array
    driven_mm: Array

    @property
    def module_mm(self) -> float:
        """Module of the pair."""
        return self.teeth.driving.flanks.rack.module_mm

    @property
    def turn_rad(self) -> Array:
        """The angle by which the driving gear is turned when flanks touch by the closed form."""
        return self.teeth.driven.flanks.turn_rad[self.driven]

    def driving_curve(self, height_mm: Array) -> tuple[ComplexArray, ComplexArray]:
        """Points of the driving flanks at heights (shape (n, ...)) and derivatives, at the law's driven angle."""
        flank, position = (_rows(numbers, height_mm) for numbers in (self.driving, self.position))
        point, slope = (as_complex(array) for array in self.teeth.driving.flanks.flank(flank, height_mm))
        return self.placement.driving_points(point, position), self.placement.driving_directions(slope, position)

    def driven_curve(self, height_mm: Array) -> tuple[ComplexArray, ComplexArray]:
        """Points of the driven flanks at heights (shape (n, ...)) and derivatives."""
        point, slope = self.teeth.driven.flanks.flank(_rows(self.driven, height_mm), height_mm)
        return as_complex(point), as_complex(slope)


def _rows(numbers: IndexArray, values: Array) -> IndexArray:
    """Numbers of shape (n,) in a shape that broadcasts with values of shape (n, ...)."""
    return np.reshape(numbers, (-1, *[1] * (values.ndim - 1)))


@dataclass(frozen=True, eq=False)
class Touches:
    """Contacts of n pairs of flanks: heights in mm, and the angle by which the driving gear is then turned.

    ``point`` and ``tangent`` (up the driving flank, of any length) are in the driven gear's frame as it then stands.
    Where ``found`` is false the other values mean nothing.  Shape (n,) each.
    """

    driving_mm: Array
    driven_mm: Array
    turn_rad: Array
    point: ComplexArray
    tangent: ComplexArray
    found: Mask


PARALLEL_RAD = 1e-9
"""Angle up to which tangents count as parallel: the driven angle is off by less than its square."""

NEWTON_STEPS = 8
"""Convergence is quadratic: from a tenth of a module four steps reach rounding errors."""

TURNING_STEP = 1e-5
"""Step, in modules, over which the turning of a tangent is measured.  The turning only steers the search."""

LONGEST_STEP = 0.25
"""Largest change of a height, in modules, in one step of the search."""

ABOUT_JOINTS = 3.0
"""The flanks beyond a joint of the law may touch first up to this distance from the joint, in lengths by which the two
flanks are rolled unequally."""


@dataclass(frozen=True, eq=False)
class _State(Columns):
    """The state of a search, (n,) each: heights in mm and the angle by which the driving gear is turned.

    ``point`` and ``slope`` (by the height) belong to the driving flank; ``gap`` leads to the driven point, ``bend_rad``
    is the angle from tangent to tangent.
    """

    driving_mm: Array
    driven_mm: Array
    turn_rad: Array
    point: ComplexArray
    slope: ComplexArray
    other_slope: ComplexArray
    gap: ComplexArray
    bend_rad: Array


@dataclass(frozen=True, eq=False)
class _Rates:
    """How the conditions change, in the directions along and across the driven tangent; shape (n,) each.

    ``own`` and ``other`` are the speeds of the driving and the driven point along the tangent, by their heights;
    ``slip`` is the driving point's speed across it.  ``spin_along`` and ``spin_across`` are the driving point's speeds
    by the angle.  ``own_bend`` and ``other_bend`` are how fast both tangents turn, by the heights.
    """

    own: Array
    other: Array
    slip: Array
    spin_along: Array
    spin_across: Array
    own_bend: Array
    other_bend: Array

    @property
    def relative_bend(self) -> Array:
        """How the driving tangent turns against the driven tangent as both points run along together."""
        return self.own_bend - self.other_bend * self.own / self.other


def tangencies(facing: FacingFlanks, limits_mm: Array) -> Touches:
    """Contacts of flanks near the heights of the closed form.

    Near jumps of the curvature another tangency may come first: it is searched between ``limits_mm`` (2, 2, n), least
    and greatest height of the driving and of the driven flanks.
    """
    state = _state(facing, facing.driving_mm, facing.driven_mm, facing.turn_rad)
    met = _met(state, facing.module_mm)
    for _ in range(NEWTON_STEPS):
        todo = np.flatnonzero(~met)
        if not todo.size:
            break
        nearer = _stepped(facing.kept(todo), state.kept(todo))
        state, met[todo] = _merged(state, todo, nearer), _met(nearer, facing.module_mm)
    doubtful = np.flatnonzero(_doubtful(facing, state, met))
    touches = _touches(state)
    if not doubtful.size:
        return touches
    return _merged(touches, doubtful, _first_touches(facing.kept(doubtful), limits_mm[..., doubtful]))


Merged = TypeVar("Merged", Touches, _State)


def _merged(older: Merged, rows: IndexArray, newer: Merged) -> Merged:
    columns = [getattr(older, field.name).copy() for field in fields(older)]
    for column, field in zip(columns, fields(older), strict=True):
        column[rows] = getattr(newer, field.name)
    return type(older)(*columns)


def _state(facing: FacingFlanks, driving_mm: Array, driven_mm: Array, turn_rad: Array) -> _State:
    (point, slope), (other, other_slope) = facing.driving_curve(driving_mm), facing.driven_curve(driven_mm)
    turned = np.exp(1j * turn_rad)
    point, slope = point * turned, slope * turned
    bend = angle_between(slope, other_slope)
    # Parallel tangents may point either way: up one flank is down the other, and beyond a cusp up again.
    bend = bend - np.pi * np.round(bend / np.pi)
    return _State(driving_mm, driven_mm, turn_rad, point, slope, other_slope, other - point, bend)


def _met(state: _State, module_mm: float) -> Mask:
    return (square(state.gap) <= (AGREEMENT * module_mm) ** 2) & (np.abs(state.bend_rad) <= PARALLEL_RAD)


def _stepped(facing: FacingFlanks, at: _State) -> _State:
    """One step of Newton's method, cut to the longest step."""
    rise, fall, turn = _correction(at, _rates(facing, at))
    longest = LONGEST_STEP * facing.module_mm
    share = longest / np.maximum(longest, np.maximum(np.abs(rise), np.abs(fall)))
    return _state(facing, at.driving_mm + share * rise, at.driven_mm + share * fall, at.turn_rad + share * turn)


def _correction(at: _State, by: _Rates) -> tuple[Array, Array, Array]:
    """Changes of both heights and of the angle that meet both conditions to first order.

    The gap along the driven tangent is closed by the driven height; across it, and in the angle between the tangents,
    by the driving height and the angle together.
    """
    unit = at.other_slope / by.other
    gap_along, gap_across = along(unit, at.gap), across(unit, at.gap)
    spin_bend = 1.0 - by.other_bend * by.spin_along / by.other
    bend = at.bend_rad - by.other_bend * gap_along / by.other
    determinant = by.slip * spin_bend - by.spin_across * by.relative_bend
    determinant = np.where(determinant == 0.0, np.inf, determinant)
    rise = (gap_across * spin_bend - by.spin_across * bend) / determinant
    turn = (by.slip * bend - by.relative_bend * gap_across) / determinant
    return rise, (by.own * rise + by.spin_along * turn - gap_along) / by.other, turn


def _rates(facing: FacingFlanks, at: _State) -> _Rates:
    step = TURNING_STEP * facing.module_mm
    speed = np.abs(at.other_slope)
    unit = at.other_slope / speed
    own_ahead = facing.driving_curve(at.driving_mm + step)[1] * np.exp(1j * at.turn_rad)
    other_ahead = facing.driven_curve(at.driven_mm + step)[1]
    return _Rates(
        own=along(unit, at.slope),
        other=speed,
        slip=across(unit, at.slope),
        spin_along=along(unit, 1j * at.point),
        spin_across=across(unit, 1j * at.point),
        own_bend=angle_between(at.slope, own_ahead) / step,
        other_bend=angle_between(at.other_slope, other_ahead) / step,
    )


def _doubtful(facing: FacingFlanks, state: _State, met: Mask) -> Mask:
    """Whether a tangency is not found, is not the first touch, or is near a joint that the flanks pass unequally.

    Points beside a first touch have farther to go: the tangents turn apart on both sides of it.
    """
    doubtful = ~met
    moved = np.nonzero(~doubtful & (np.abs(state.turn_rad - facing.turn_rad) > PARALLEL_RAD))[0]
    if moved.size:
        near, there = facing.kept(moved), state.kept(moved)
        by = _rates(near, there)
        behind = near.upward * by.own * by.relative_bend * by.spin_across <= 0.0
        doubtful[moved] = behind | _about_joints(near, there)
    return doubtful


def _about_joints(facing: FacingFlanks, state: _State) -> Mask:
    flanks = facing.teeth.driving.flanks
    joints = flanks.curve.joints_around_mm
    unequal = np.maximum(np.abs(state.driving_mm - facing.driving_mm), np.abs(state.driven_mm - facing.driven_mm))
    reach = ABOUT_JOINTS * unequal / flanks.slant.of(facing.driving).height_per_rolled
    rolled = flanks.rolled_mm(facing.driving, state.driving_mm)
    return np.searchsorted(joints, rolled + reach) > np.searchsorted(joints, rolled - reach)


def _touches(state: _State) -> Touches:
    """The result of the search, with the angle corrected by the remaining gap across the tangent."""
    lever = along(state.slope, state.point)
    found = lever != 0.0
    turn = state.turn_rad + across(state.slope, state.gap) / np.where(found, lever, 1.0)
    return Touches(state.driving_mm, state.driven_mm, turn, state.point, state.slope, found)


REACH_IN_PITCHES = 0.15
"""Rolled length to either side of the closed form's contact within which the first touch is looked for."""

SHARES = np.linspace(-1.0, 1.0, 33)

ROUNDS = 4
"""Places of the tried points as shares of the reach, and the number of rounds, each a sixteenth as wide as the round
before.  The height is then exact to some millionths of a module, and the driven angle, which is stationary there, to
rounding errors."""

CIRCLE_STEPS = 8
"""Steps of Newton's method to a circle; four do on flanks, which cross circles about their axis steeply."""

ON_CIRCLE = 1e-11
"""Relative error of the squared radius up to which a point counts as on its circle."""


def _first_touches(facing: FacingFlanks, limits_mm: Array) -> Touches:
    """The first touch of pairs of flanks between ``limits_mm`` (2, 2, n), as in ``tangencies``."""
    flanks, middle = facing.teeth.driving.flanks, facing.driving_mm
    slant = flanks.slant.of(facing.driving)
    far = REACH_IN_PITCHES * flanks.rack.pitch_mm * slant.sine * slant.cosine
    reach = np.broadcast_to(far, middle.shape)
    first = np.arange(middle.size), np.zeros(middle.size, dtype=int)
    for _ in range(ROUNDS):
        height = np.clip(middle[:, None] + reach[:, None] * SHARES, *limits_mm[0, ..., None])
        point, slope = facing.driving_curve(height)
        other_height, other = _on_circles(
            facing, square(point), (facing.driving_mm + facing.driven_mm)[:, None] - height
        )
        least, greatest = limits_mm[1, ..., None]
        there = np.isfinite(other_height) & (other_height >= least) & (other_height <= greatest)
        turn = angle_between(point, other)
        first = first[0], np.argmax(np.where(there, facing.upward[:, None] * turn, -np.inf), axis=1)
        middle, reach = height[first], reach * (SHARES[1] - SHARES[0])
    found = there[first]
    turn = np.where(found, turn[first], 0.0)
    turned = np.exp(1j * turn)
    return Touches(middle, other_height[first], turn, point[first] * turned, slope[first] * turned, found)


def _on_circles(facing: FacingFlanks, squared: Array, start_mm: Array) -> tuple[Array, ComplexArray]:
    """Heights (NaN where there is none) and points of the driven flanks with these squared radii, shape (n, m) each."""
    height = start_mm
    for _ in range(CIRCLE_STEPS):
        point, slope = facing.driven_curve(height)
        rate = 2.0 * along(point, slope)
        height = height + (squared - square(point)) / np.where(rate == 0.0, np.inf, rate)
    point, _ = facing.driven_curve(height)
    return np.where(np.abs(square(point) - squared) <= ON_CIRCLE * squared, height, np.nan), point
