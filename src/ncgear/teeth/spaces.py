"""How deep the spaces are: as deep as the tool goes, or shallower where it would undercut the flanks.

The flank ends at a depth f, where the tool's rounded tip begins.  A rack or a pinion cutter has a depth of its own; the
mating gear as a tool is rounded where its own flanks end, so that it reaches as deep as its tips need.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import sin

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.pitch.curve import PitchCurve
from ncgear.teeth.flank import Flanks, tooth_name
from ncgear.teeth.regular import CLEAR_OF_CUSPS, regular_depth
from ncgear.teeth.tool import LEAST_FLAT, PinionCircle, RackLine, Rounding, fitting_radii, rounding_of

Depth = Callable[[Array, IndexArray], Array]
"""Radii and flank numbers to flank depths, shape (n,) each."""

ROUND_ENOUGH = 0.9
"""Share of f / sin(alpha), the way from the flank's end to the pitch point, that a rounding's radius may have: beyond
the whole way the rounding's centre would pass the pitch point and the fillet fold."""


def cut_spaces(flanks: Flanks, avoid_undercut: bool) -> tuple[Flanks, Mask]:
    """The flanks as deep as a rack or pinion cutter cuts them, and which of them it undercuts at full depth."""
    tool, rack = flanks.tool, flanks.rack
    assert not isinstance(tool, PitchCurve)
    full = np.full(flanks.count, rack.root_depth_mm)
    depth = tool.flank_depth_mm(rack, full, flanks.root_radius_mm)
    # Looked for so deep that spaces get shallower by degrees: those of helical teeth must not jump.
    regular = regular_depth(flanks, rack.root_depth_mm / CLEAR_OF_CUSPS)
    undercut = regular < depth
    allowed = CLEAR_OF_CUSPS * regular if avoid_undercut else np.full(flanks.count, np.inf)
    bound = of_spaces(allowed)
    radii = _largest_radii(flanks, np.minimum(bound, depth), rack.root_radius_mm)
    if not isinstance(tool, RackLine):
        radii = _fitted(flanks, radii, lambda r, i: np.minimum(bound[i], tool.flank_depth_mm(rack, full[i], r)))
    depth = np.minimum(bound, tool.flank_depth_mm(rack, full, radii))
    return replace(flanks, flank_depth_mm=depth, root_radius_mm=radii), undercut


def mated_spaces(flanks: Flanks, depth_mm: Array, radius_mm: float) -> Flanks:
    """The flanks as deep as their mates touch, rounded with ``radius_mm`` or the most that fits the mates' teeth."""
    radii = _largest_radii(flanks, depth_mm, radius_mm)
    deep = replace(flanks, flank_depth_mm=depth_mm)
    rounded = replace(deep, root_radius_mm=_fitted(deep, radii, lambda r, i: depth_mm[i]))
    lost = np.nonzero(np.isnan(rounded.root_depth_mm))[0]
    if lost.size:
        raise no_root(flanks, int(lost[0]), "no rounded tip fits the mate's tooth")
    return rounded


def of_spaces(values: Array) -> Array:
    """The lesser value of the two flanks of each space; a space lies between a front flank and the next back flank."""
    least = np.roll(values, -1).reshape(-1, 2).min(axis=1)
    return np.roll(np.repeat(least, 2), 1)


def _largest_radii(flanks: Flanks, depth: Array, wanted: float) -> Array:
    """Radii, at most the one wanted, with which the fillets do not fold.

    Raises NoSuchMechanism where no flank is left below the pitch curve.
    """
    if not np.all(depth > 0.0):
        raise no_root(flanks, int(np.nonzero(~(depth > 0.0))[0][0]), "no flank below the pitch curve is regular")
    most = ROUND_ENOUGH * depth / sin(flanks.rack.pressure_angle_rad)
    return of_spaces(np.minimum(wanted, most))


def _fitted(flanks: Flanks, radii: Array, depth_of: Depth) -> Array:
    """The radii, reduced where the tool's tooth is too narrow for them, or its tip would slope beyond 45 degrees."""
    front = np.arange(1, flanks.count, 2)
    back = (front + 1) % flanks.count
    turn = np.where(back == 0, flanks.curve.length_mm, 0.0)

    def flats(radius: Array, number: IndexArray) -> Array:
        trials = [_trial(flanks, flank[number], radius, depth_of(radius, flank[number])) for flank in (front, back)]
        flat = trials[1].lowest_mm + turn[number] - trials[0].lowest_mm
        return flat - np.abs(trials[1].depth_mm - trials[0].depth_mm)

    fitting = fitting_radii(flats, radii[front], LEAST_FLAT * flanks.rack.module_mm)
    if np.isnan(fitting).any():
        raise _pointed(flanks, int(front[np.isnan(fitting)][0]))
    fitted = np.empty(flanks.count)
    fitted[front] = fitted[back] = fitting
    return fitted


def _pointed(flanks: Flanks, flank: int) -> NoSuchMechanism:
    if not isinstance(flanks.tool, PinionCircle):
        return no_root(flanks, flank, "the mate's tooth is pointed before its depth")
    return NoSuchMechanism(
        f"a pinion cutter of {flanks.tool.teeth} teeth is pointed before it is as deep as the space beside "
        f"{tooth_name(flanks, flank)}; more cutter teeth, or kind: mate, are needed",
        key="gears.cutter.teeth",
    )


def _trial(flanks: Flanks, flank: IndexArray, radius: Array, depth: Array) -> Rounding:
    """The roundings of some flanks at trial radii and depths."""
    return rounding_of(flanks.tool, flanks.rack, flanks.crossing_mm[flank], flanks.side[flank], depth, radius)


def no_root(flanks: Flanks, flank: int, problem: str) -> NoSuchMechanism:
    """The refusal of the space beside a flank."""
    return NoSuchMechanism(
        f"the space beside {tooth_name(flanks, flank)} cannot be cut: {problem}; more teeth of a smaller module are "
        "needed",
        key="gears.teeth",
    )
