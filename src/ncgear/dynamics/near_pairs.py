"""The pairs of teeth that may touch as knocks are followed, and the moments of their forces.

Pairs are plain numbers where they are few: the knocks of a turn ask for their moments a hundred thousand times.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ncgear.dynamics.meshing import Impact, Meshing, ramp
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear

HARDEST = 20.0
"""Largest torque of a knock for which pairs are counted, over the largest demanded torque."""

NearPairs = list[list[list[float]]] | Array
"""The arm, the touching angle, the stiffness, the rate of that angle in rad/s and the arm with friction of each of some
pairs, for either side of the teeth, the pairs that touch first before the others; of many, an array (5, pairs)."""

MANY = 16
"""Number of pairs, as of sections of helical teeth, from which arrays are faster than plain numbers."""


def near_pairs(
    meshing: Meshing, phi1_rad: Array, speed_rad_s: Array | float, most_n_mm: float, turned: Gear = Gear.DRIVEN
) -> tuple[Sequence[NearPairs], Array]:
    """The pairs at driving angles and speeds of the driving gear, shape (n,), and their largest lever.

    Pairs count that a torque of HARDEST times the largest torque presses together.  Arms with friction are those of the
    gear that is ``turned``; the driving gear is turned back.
    """
    near = meshing.gaps.at(phi1_rad)
    arm, ahead = near.urge * near.lever_mm, near.urge * near.error_rad
    reach_rad = HARDEST * most_n_mm / float(np.where(arm, near.stiffness * arm**2, np.inf).min())
    speed = np.reshape(speed_rad_s, (-1, 1))
    slope = meshing.law.at(phi1_rad)[1][:, None]
    rub = meshing.friction.coefficient((near.driving_mm - near.driven_mm * slope) * speed)
    rubbed = arm + rub * near.driven_mm if turned is Gear.DRIVEN else slope * arm + rub * near.driving_mm
    pairs = np.stack([arm, near.error_rad, near.stiffness, near.slopes[0] * speed, rubbed], axis=-1)
    levers: Array = near.lever_mm.max(axis=-1)
    sides = list[Array]()
    for side in (1.0, -1.0):
        key = np.where(near.urge == side, ahead, -np.inf)
        reached = key >= key.max(axis=-1, keepdims=True) - reach_rad
        most = int(np.count_nonzero(reached & (near.urge == side), axis=-1).max())
        order = np.argsort(-key, axis=-1)[:, :most, None]
        # Empty places have no arm, so that they never touch.
        sides.append(np.take_along_axis(pairs * (near.urge == side)[..., None], order, axis=1))
    if sum(one.shape[1] for one in sides) > MANY:
        return list(np.swapaxes(np.concatenate(sides, axis=1), 1, 2)), levers
    return [list(both) for both in zip(*(one.tolist() for one in sides), strict=True)], levers


def moments_n_mm(
    impact: Impact, pairs: NearPairs, ahead_rad: float, speed_rad_s: float, later_s: float = 0.0
) -> tuple[float, float]:
    """The moments of touching pairs on the driven side, of their normal forces and with friction.

    ``ahead_rad`` and ``speed_rad_s`` are the driven side's angle and speed beyond the law's.  The pairs are
    those of a time ``later_s`` ago.
    """
    if isinstance(pairs, np.ndarray):
        arms, errors, _, rates, _ = pairs
        depths = arms * (errors + later_s * rates - ahead_rad)
        touching = depths > 0.0
        (arms, _, stiffnesses, rates, rubbed), depths = pairs[:, touching], depths[touching]
        damped = impact.damping(depths) * arms * (rates - speed_rad_s)
        force = impact.force_n(impact.elastic_n(depths, stiffnesses), damped)
        return float(arms @ force), float(rubbed @ force)
    # As Impact has them for arrays.
    exponent, full, deep = impact.exponent, impact.damping_n_s_mm, impact.full_damping_depth_mm
    normal, turning = 0.0, 0.0
    for side in pairs:
        for arm, error_rad, stiffness, rate_rad_s, rubbed in side:
            depth = arm * (error_rad + later_s * rate_rad_s - ahead_rad)
            if depth <= 0.0:
                break
            damping = full if depth >= deep else full * ramp(depth / deep)
            force = stiffness * depth**exponent + damping * arm * (rate_rad_s - speed_rad_s)
            if force > 0.0:
                normal += arm * force
                turning += rubbed * force
    return normal, turning
