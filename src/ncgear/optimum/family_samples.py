"""Many laws of the published three-segment family at once: their shapes, sampled accelerations and driving powers.

Seven numbers describe a law of the family.  A stroke matters as a function of the driving angle only: speeds scale, so
the law speed is redundant, and v1, v2 and a1 are per radian.  What is left are six numbers, the shape,

    theta4 / period,  theta3 / theta4,  theta2 / theta3,  theta1 / theta2,  chi,  brake

and the skewness of the return.  The approach's velocity, a quartic with v' = 0 at theta1 and theta2, is given by the
factors of its derivative, v' ~ (1 - t)(rho - t)(cos chi + sin chi t), t = phi1/theta2, rho = theta1/theta2, which stays
regular where theta1 comes near theta2 and v1 near v2.  ``brake`` is -a1 (theta4 - theta3)/v2.

With masses the power comes from the one loaded machine (``ncgear.dynamics.loaded_machine``): what a crank's motion
asks of the driving shaft depends on the law only by the driven angle and its two derivatives, which are sampled.
"""

from __future__ import annotations

from enum import Enum
from functools import cached_property
from math import inf, pi

import numpy as np

from ncgear.dynamics.loaded_machine import RigidMachine
from ncgear.frozen import dataclass
from ncgear.kinematics.motion import Machine
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import shares
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.optimum.task import Task
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.sampled_strokes import (
    Motion,
    Points,
    ReturnSamples,
    return_samples,
    returns_with_skewness,
    working_angles,
    working_motions,
)
from ncgear.ratio.working_stroke import StrokeRequest, WorkingStrokes, shaped_strokes

BOX = np.array([[0.2, 0.9], [0.3, 0.995], [0.3, 1.0], [0.05, 0.98], [-1.55, 1.55], [0.02, 12.0], [-6.0, 6.0]])
"""Bounds of each number, the skewness in heights of the bump.  They are so wide that no optimum on the baler's linkage
lies at a bound, except at theta2 = theta3."""

SEGMENT_POINTS = 65, 17, 33
"""Points on each segment of the stroke, ends included; the accelerations are of degree 3, 0 and 2."""

RETURN_POINTS = Points(edges=(0.0, 1.0), count=97, steps=8)
"""Points on the return; four of Newton's steps give five digits."""

CLOSED = 1e-6
"""Miss of the cycle, relative to the return's driven angle, that the search may leave; laws are closed to rounding."""


class Peak(Enum):
    """What is to be least, or capped."""

    ACCELERATION = "peak acceleration"
    POWER = "peak power"


@dataclass(frozen=True)
class Family:
    """The family on a machine; ``inverse`` is the return's basis, as in a design file."""

    task: Task
    inverse: bool = False

    @cached_property
    def loaded(self) -> RigidMachine:
        """The machine with all masses, its crank turning evenly: the loads of any other motion are asked of it."""
        task = self.task
        return task.loaded(Machine(uniform_law(task.lobes), task.linkage, task.load, task.speed_rad_s))

    @property
    def return_takes_power(self) -> bool:
        """Whether the driving shaft is asked for power in the return as well."""
        return self.task.masses is not None or self.task.load.loads_return


@dataclass(frozen=True, eq=False)
class SampledLaws:
    """Sampled accelerations in mm/s^2 and driving powers in W, shape (n, points) each; infinite where there is no law.

    Power that flows back to the motor counts as zero.
    """

    acceleration: Array
    power: Array

    def of(self, peak: Peak) -> Array:
        """The samples of which ``peak`` is the largest magnitude."""
        return self.acceleration if peak is Peak.ACCELERATION else self.power


def sampled_laws(family: Family, points: Array) -> SampledLaws:
    """Samples of the laws at points of the unit box, shape (n, 7)."""
    strokes, skewness = strokes_at(family, points)
    task = family.task
    linkage, omega = task.linkage, task.speed_rad_s
    motions = working_motions(strokes, SEGMENT_POINTS)
    out = Motion(*(np.hstack(parts) for parts in zip(*motions, strict=True)))
    advancing = (motions[0].velocity[:, 1:].min(axis=1) > 0.0) & (strokes.approach_slope[0] > 0.0)
    with np.errstate(all="ignore"):
        asked = strokes, linkage, task.cycle_rad, skewness, RETURN_POINTS
        back = return_samples(returns_with_skewness(*asked, inverse=family.inverse), linkage, RETURN_POINTS, 1)
        miss = np.abs(back.end_driven_rad - 2.0 * pi)
        power = _power_w(family, strokes, out, back)
    closed = (back.slopes[0][:, 0].min(axis=1) > 0.0) & (miss <= CLOSED * (2.0 * pi - linkage.working_angle_rad))
    possible = (advancing & (strokes.pressing_mm_rad > 0.0) & closed)[:, None]
    acceleration = np.hstack([out.acceleration, back.acceleration[:, 0]]) * omega**2
    return SampledLaws(np.where(possible, acceleration, inf), np.where(possible, np.maximum(power, 0.0), inf))


def _power_w(family: Family, strokes: WorkingStrokes[Array], out: Motion, back: ReturnSamples) -> Array:
    """The power of the driving shaft in W, shape (n, points), negative where it brakes."""
    if family.task.masses is None:
        return _power_of_load_w(family.task, out, back)
    return _power_with_masses_w(family, strokes, out, back)


def _power_of_load_w(task: Task, out: Motion, back: ReturnSamples) -> Array:
    """The power of the load alone at all points of the working stroke, and of the return where anything loads it."""
    power = task.load.against_n(out.displacement, False) * out.velocity
    if task.load.loads_return:
        homeward = task.load.backwards_n(back.displacement[:, 0], True) * back.velocity[:, 0]
        power = np.hstack([power, homeward])
    return power * (task.speed_rad_s / 1000.0)


def _power_with_masses_w(family: Family, strokes: WorkingStrokes[Array], out: Motion, back: ReturnSamples) -> Array:
    """The power of the driving shaft with all masses at all points of the cycle."""
    task = family.task
    phi1, driven = working_angles(strokes, task.linkage, SEGMENT_POINTS, 2)
    start = strokes.theta4_rad[:, None]
    phi1 = np.hstack([phi1, start + (task.cycle_rad - start) * shares(RETURN_POINTS.count)])
    homeward = back.driven_rad, *back.slopes
    turned, slope, change = (np.hstack([one, two[:, 0]]) for one, two in zip(driven, homeward, strict=True))
    returning = np.broadcast_to(np.arange(phi1.shape[1]) >= out.displacement.shape[1], phi1.shape)
    resistance = task.load.backwards_n(np.hstack([out.displacement, back.displacement[:, 0]]), returning)
    angle = Jet(np.stack([turned.ravel(), slope.ravel(), change.ravel() / 2.0]))
    loads = family.loaded.loads(phi1.ravel(), angle, Jet(resistance.reshape(1, -1)), returning.ravel())
    return loads.driving_torque.value.reshape(phi1.shape) * (N_M_PER_N_MM * task.speed_rad_s)


def strokes_at(family: Family, points: Array) -> tuple[WorkingStrokes[Array], Array]:
    """The strokes of points of the unit box, shape (n, 7), at a law speed of 1 rad/s, and the returns' skewness."""
    *parts, chi, brake, skewness = (BOX[:, 0] + points * (BOX[:, 1] - BOX[:, 0])).T
    rho = parts[-1]
    theta = np.cumprod([parts[0] * family.task.cycle_rad, *parts[1:]], axis=0)[::-1]
    cosine, sine, both = np.cos(chi), np.sin(chi), 1.0 + rho
    rising = [rho * cosine, rho * sine - both * cosine, cosine - both * sine, sine]
    approach = np.stack(rising) / np.arange(1.0, 5.0)[:, None]
    return shaped_strokes(theta, approach / approach.sum(axis=0), brake, family.task.linkage.stroke_mm), skewness


def request_at(family: Family, point: Array) -> StrokeRequest:
    """The stroke of one point of the unit box as the solver of strokes takes it, v2 left to be found."""
    strokes, _ = strokes_at(family, point[None])
    one = {name: float(values[0]) for name, values in vars(strokes).items() if values.ndim == 1}
    omega = family.task.speed_rad_s
    return StrokeRequest(
        theta1_rad=one["theta1_rad"],
        theta2_rad=one["theta2_rad"],
        theta3_rad=max(one["theta3_rad"], one["theta2_rad"]),
        theta4_rad=one["theta4_rad"],
        v1_mm_s=one["v1_mm_s"] * omega,
        v2_mm_s=None,
        a1_mm_s2=one["a1_mm_s2"] * omega**2,
        law_speed_rad_s=omega,
        stroke_mm=one["stroke_mm"],
    )


def constant_at(family: Family, point: Array) -> float:
    """The e of the return of a point: its polynomial's value at phi1 = 0; not finite where there is none."""
    strokes, skewness = strokes_at(family, point[None])
    asked = strokes, family.task.linkage, family.task.cycle_rad, skewness, RETURN_POINTS
    with np.errstate(all="ignore"):
        return float(returns_with_skewness(*asked, inverse=family.inverse).at(-strokes.theta4_rad)[0])
