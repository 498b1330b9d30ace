"""Many laws of the three-segment stroke at once, sampled; each step as one law is made in ``ratio/laws``."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.machine.linkage import Linkages
from ncgear.machine.stroke import WorkingStrokes
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import extremes, integration, shares
from ncgear.optimum.makeable.quantities import Place
from ncgear.ratio.inversion import approach_angle, braking_angle, pressing_angle
from ncgear.screening.returns import PIECES, Returns
from ncgear.screening.samples import Samples, place_of, repeated, stacked

CLEAR = 1e-9
"""Share of its largest value by which v/phi1 must stay over zero: a million rounding errors.  What is nearer to zero is
left to the solver of one stroke."""

AngleFunction = Callable[[WorkingStrokes[Array], Linkages[Array], Array, int], Jet]


def stroke_samples(strokes: WorkingStrokes[Array], linkage: Linkages[Array], returns: Returns, count: int) -> Samples:
    """The working stroke's segments and the return, ``count`` points each."""
    width2, width3 = strokes.theta3_rad - strokes.theta2_rad, strokes.theta4_rad - strokes.theta3_rad
    starts = (0.0 * width2, strokes.theta2_rad, strokes.theta3_rad)
    widths = (strokes.theta2_rad, width2, width3)
    angles = (approach_angle, pressing_angle, braking_angle)
    phi1 = [_across(start, width, count) for start, width in zip(starts, widths, strict=True)]
    places = [_place(angle, strokes, linkage, at) for angle, at in zip(angles, phi1, strict=True)]
    motion = _motion(repeated(strokes, count), phi1)
    back, back_motion = _return(returns, linkage, count)
    at = Place(*(np.concatenate(column, axis=1) for column in zip(stacked(places), back, strict=True)))
    velocity, acceleration = (
        np.concatenate([np.stack(part, axis=1), last], axis=1)
        for part, last in zip(motion[1:], back_motion, strict=True)
    )
    every = np.stack([*widths, *[returns.length_rad / PIECES] * PIECES], axis=1)
    return Samples(
        at,
        velocity,
        acceleration,
        np.stack(motion[0], axis=1),
        at.slope * every[..., None],
        every > 0.0,
        _sound(strokes, count),
    )


def _across(start: Array, width: Array, count: int) -> Array:
    return start[:, None] + width[:, None] * shares(count)


def _place(angle: AngleFunction, strokes: WorkingStrokes[Array], linkage: Linkages[Array], phi1: Array) -> Place:
    """The ratio on one segment, from the inversion through the linkage."""
    count = phi1.shape[1]
    driven = angle(repeated(strokes, count), repeated(linkage, count), phi1.ravel(), 3)
    return place_of(*(driven.derivative(k).reshape(phi1.shape) for k in (1, 2, 3)))


def _motion(strokes: WorkingStrokes[Array], phi1: list[Array]) -> tuple[list[Array], list[Array], list[Array]]:
    """Displacement, velocity and acceleration on the three segments, from their polynomials."""
    approach, pressing, braking = (part.ravel() for part in phi1)
    advancing, ending = Jet.variable(approach, 1), -Jet.variable(braking - strokes.theta4_rad, 1)
    begun = advancing.value**2 * jet.polynomial(strokes.approach_root, advancing).value
    pressed = strokes.pressing_start_mm + strokes.pressing_mm_rad * (pressing - strokes.theta2_rad)
    left = ending.value**2 * jet.polynomial(strokes.braking_root, ending).value
    fast = advancing * jet.polynomial(strokes.approach_slope, advancing)
    slow = ending * jet.polynomial(strokes.braking_slope, ending)
    motions = (
        (begun, pressed, strokes.stroke_mm - left),
        (fast.value, strokes.pressing_mm_rad, slow.value),
        (fast.derivative(), 0.0 * pressing, slow.derivative()),
    )
    shaped = ([part.reshape(phi1[0].shape) for part in parts] for parts in motions)
    displacement, velocity, acceleration = shaped
    return displacement, velocity, acceleration


def _return(returns: Returns, linkage: Linkages[Array], count: int) -> tuple[Place, tuple[Array, Array]]:
    """Ratio, velocity and acceleration on the return."""
    slope, first, second = returns.slopes(count)
    turned = slope @ integration(count).T * returns.length_rad[:, None, None] / PIECES
    before = np.cumsum(turned[:, :, -1:], axis=1) - turned[:, :, -1:]
    driven = turned + before + linkage.working_angle_rad[:, None, None]
    rows = np.stack([driven, slope, first / 2.0]).reshape(3, -1)
    motion = repeated(linkage, PIECES * count).displacement(Jet(rows))
    velocity, acceleration = (motion.derivative(k).reshape(slope.shape) for k in (1, 2))
    return place_of(slope, first, second), (velocity, acceleration)


def _sound(strokes: WorkingStrokes[Array], count: int) -> Mask:
    """Whether the slider advances all the way, by far more than rounding: as ``machine/stroke.py`` asks for."""
    positive = (strokes.v1_mm_s > 0.0) & (strokes.v2_mm_s > 0.0) & (strokes.a1_mm_s2 < 0.0)
    finite = (strokes.law_speed_rad_s > 0.0) & np.isfinite(strokes.law_speed_rad_s)
    powers = (strokes.theta2_rad[:, None] * shares(count)) ** np.arange(4.0)[:, None, None]
    slope = (strokes.approach_slope[..., None] * powers).sum(axis=0)
    known = positive & finite & np.isfinite(slope).all(axis=1)
    low, high = extremes(np.where(known[:, None], slope, 1.0), np.arange(known.size))
    sound: Mask = known & (low > CLEAR * high)
    return sound
