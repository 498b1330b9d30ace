"""From keys to values: the moving masses of a design, with the moments of inertia of its gears.

Where a design leaves out a gear's moment of inertia, the gear's own body gives it: slab by slab, from the plan of the
gear as it comes out of the process, without changes of the written solid for the process (bevels, and moved outlines).
Gears that cannot be made as given have no body; then a disc within the pitch curve takes its place, with bore and hub,
and the answer says so.  On a circle such a disc is heavier than the toothed gear by about one module's width in ten of
its rim, or 0.4 module over the radius (tests/test_one_machine.py).
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, radians, sin
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ncgear.design.keys.gears import Gears
from ncgear.design.keys.masses import DrivenShaftMasses, Gravity, ShaftMasses
from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import Masses
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array

if TYPE_CHECKING:
    from ncgear.pitch.curve import PitchCurve


@dataclass(frozen=True, eq=False)
class GearInertia:
    """Moments of inertia in kg mm2 of the bodies of a pair's gears about their axes.

    ``refusal`` says why the gears cannot be made as given, so that discs within their pitch curves replace them; None
    where they can be made.
    """

    driving_kg_mm2: float
    driven_kg_mm2: float
    refusal: DesignError | None = None


class TrainInertia(NamedTuple):
    """Moments of inertia in kg mm2 of everything that turns with driving shaft, shafts between, and last gear."""

    driving_kg_mm2: float = 0.0
    between_kg_mm2: tuple[float, ...] = ()
    driven_kg_mm2: float = 0.0


def masses_of(
    given: ShaftMasses | DrivenShaftMasses, mechanism: Mechanism | type[Mechanism], gears: TrainInertia
) -> Masses:
    """The masses that a design gives, with the moments of inertia of its gears."""
    rods = {name: getattr(given, name) for name in mechanism.RODS}
    return mechanism.MASSES(
        **{f"{name}_kg": getattr(given, f"{name}_kg") for name in mechanism.POINTS},
        **{f"{name}_kg": rod.mass_kg for name, rod in rods.items()},
        **{f"{name}_center_mm": rod.center_mm for name, rod in rods.items()},
        **{f"{name}_inertia_kg_mm2": rod.inertia_kg_mm2 for name, rod in rods.items()},
        crank_kg=given.crank.mass_kg,
        crank_center_mm=given.crank.center_mm,
        crank_inertia_kg_mm2=given.crank.inertia_kg_mm2 + given.driven_flywheel_kg_mm2,
        driven_inertia_kg_mm2=gears.driven_kg_mm2,
        driving_inertia_kg_mm2=gears.driving_kg_mm2,
        between_inertia_kg_mm2=gears.between_kg_mm2,
        flywheel_inertia_kg_mm2=given.flywheel.inertia_kg_mm2,
        gravity_m_s2=_vector(given.gravity),
    )


def _vector(gravity: Gravity | None) -> tuple[float, float]:
    if gravity is None:
        return 0.0, 0.0
    direction = radians(gravity.direction_deg)
    return gravity.acceleration_m_s2 * cos(direction), gravity.acceleration_m_s2 * sin(direction)


def states_inertia(given: ShaftMasses | DrivenShaftMasses, stages: int) -> bool:
    """Whether a file states the moments of inertia of all gears, so that their bodies are not needed."""
    single = None not in (given.driving_gear_kg_mm2, given.driven_gear_kg_mm2)
    return single and (stages == 1 or given.shaft_between_kg_mm2 is not None)


def stated_inertia(given: ShaftMasses | DrivenShaftMasses) -> TrainInertia:
    """The moments of inertia that a file states; moments that it leaves out are zero."""
    return TrainInertia(given.driving_gear_kg_mm2 or 0.0, given.shafts_between_kg_mm2, given.driven_gear_kg_mm2 or 0.0)


def train_inertia(
    given: ShaftMasses | DrivenShaftMasses,
    stages: int,
    bodies: Callable[[int], GearInertia] | None,
    *,
    shares_gears: bool = False,
) -> TrainInertia:
    """The moments of inertia of a design's gears, as given or from their bodies.

    ``bodies`` makes the gears' bodies of a pair by its place; it is called only where an inertia is left out, and is
    None without gears.  Pairs that share gears have one gear on a shaft between, else two.
    """
    driving, driven = given.driving_gear_kg_mm2, given.driven_gear_kg_mm2
    if bodies is None or states_inertia(given, stages):
        return stated_inertia(given)
    between = given.shafts_between_kg_mm2 if stages > 1 else ()
    if stages > 1 and given.shaft_between_kg_mm2 is None:
        between = tuple(
            bodies(place).driven_kg_mm2 + (0.0 if shares_gears else bodies(place + 1).driving_kg_mm2)
            for place in range(stages - 1)
        )
    return TrainInertia(
        bodies(0).driving_kg_mm2 if driving is None else driving,
        between,
        bodies(stages - 1).driven_kg_mm2 if driven is None else driven,
    )


KG_MM3 = 1e-9
"""One kg/m3 in kg/mm3."""

DISC_POINTS = 721
"""Points of a pitch curve as a polygon: its moment of inertia is within 3e-5 of the curve's."""


def disc_kg_mm2(gears: Gears, curve: PitchCurve, module_mm: float, density_kg_m3: float) -> float:
    """Moment of inertia of the disc within a pitch curve, or of the ring around it, with its bore and hub."""
    from ncgear.pitch.shape import Gear

    points = curve.drawn(DISC_POINTS).position
    body = gears.driving if curve.gear is Gear.DRIVING else gears.driven
    width, within = gears.face_width_mm, _polygon_mm4(points)
    if curve.is_ring:
        from ncgear.project.gear_solids import rim_mm_of

        whole = _circle_mm4(float(np.linalg.norm(points, axis=1).max()) + rim_mm_of(gears, module_mm))
        return KG_MM3 * density_kg_m3 * width * (whole - within)
    bore = 0.0 if body.bore_mm is None else min(_circle_mm4(body.bore_mm / 2.0), within)
    hub = (_circle_mm4(body.hub.diameter_mm / 2.0) - bore) * body.hub.height_mm if body.hub else 0.0
    return KG_MM3 * density_kg_m3 * (width * (within - bore) + max(hub, 0.0))


def _polygon_mm4(points: Array) -> float:
    """Polar moment of area of a closed polygon about the origin, its points of shape (n, 2)."""
    after = np.roll(points, -1, axis=0)
    across = points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0]
    return abs(float(np.sum(across * np.sum(points**2 + points * after + after**2, axis=1)))) / 12.0


def _circle_mm4(radius_mm: float) -> float:
    return pi * radius_mm**4 / 2.0
