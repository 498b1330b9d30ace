"""Rack and pinion: a pinion on the driven shaft moves a rack along its line, x = r phi2.

The rack never returns by itself: it is for gears that turn to and fro over a part of a turn.  Frame: the pinion's axis
is at the origin, it turns clockwise, and the rack moves along +x above it, at y = r.  Only the component of the teeth's
force along the rack's line counts; the component that pushes pinion and rack apart does not change torque or power and
is left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, pi, radians, sin, tan
from typing import ClassVar, Self

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import CrankBody, JointForces, Masses, Pace, crank_forces, moving_force
from ncgear.mechanisms.mechanism import Link, LinkShape, Mechanism, MovingMass, Output, Point
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector

TEETH = 20
"""Teeth of the drawn pinion; a design file does not give them."""

BACK = 3.0
"""Distance of the drawn rack's back from its pitch line in modules."""


@dataclass(frozen=True)
class RackPinion(Mechanism):
    """A rack on a pinion of a pitch radius, or many of them, with radii of shape (n,)."""

    NAME: ClassVar[str] = "a rack and pinion"
    OUTPUT: ClassVar[Output] = Output("rack")
    RETURNS: ClassVar[bool] = False
    PISTON: ClassVar[bool] = False
    UNIFORM: ClassVar[str] = "even gears"
    CRANK: ClassVar[str] = "pinion"
    STROKE_KEY: ClassVar[str] = "radius_mm"
    JOINTS: ClassVar[Mapping[str, str]] = {"teeth": "rack's teeth"}

    radius_mm: float

    @classmethod
    def of_stroke(cls, stroke_mm: float, **lengths: float) -> Self:
        """Raises WrongInput: a rack has no dead centres, so no law of a stroke gives its pinion."""
        raise WrongInput("a rack has no dead centres, and so no stroke to solve for; give it", key="linkage.radius_mm")

    @property
    def crank_mm(self) -> float:
        """The pitch radius of the pinion."""
        return self.radius_mm

    @property
    def stroke_mm(self) -> float:
        """The rack's travel in one turn."""
        return 2.0 * pi * self.radius_mm

    @property
    def nearest_mm(self) -> float:
        """Place of the rack at the start: over the pinion's axis."""
        return 0.0 * self.radius_mm

    @property
    def working_angle_rad(self) -> float:
        """One turn."""
        return 2.0 * pi + 0.0 * self.radius_mm

    @property
    def offset_mm(self) -> float:  # type: ignore[override]
        """The pitch radius: the rack's pitch line touches the pinion's pitch circle."""
        return self.radius_mm

    def displacement(self, crank_angle: Jet) -> Jet:
        """r phi2."""
        return crank_angle * self.radius_mm

    def working_angle(self, displacement_mm: Array, remaining_mm: Array) -> Array:
        """x / r."""
        return displacement_mm / self.radius_mm

    def regular_slope(self, displacement: Jet, root: Jet) -> Jet:
        """The root over r."""
        return root * (1.0 / self.radius_mm)

    def crank_angle(self, displacement_mm: Array, returning: Mask) -> Array:
        """Angle of the pinion in rad at displacements of shape (n,)."""
        return displacement_mm / self.radius_mm

    def crank_body(self, crank_angle: Jet, center_mm: float) -> CrankBody:
        """The pinion; its pin is the place where its teeth push the rack.  Its centre of mass begins on -x."""
        still = 0.0 * crank_angle
        sine, cosine = jet.sin_cos(self.crank_start_rad - crank_angle)
        return CrankBody(
            crank_angle, Vector(still, still + self.radius_mm), Vector(center_mm * cosine, center_mm * sine)
        )

    def links(self, crank_angle: Jet) -> Mapping[str, Link]:
        """Rack and pinion."""
        still = 0.0 * crank_angle
        rack = Vector(self.displacement(crank_angle), still + self.offset_mm)
        return {"rack": Link(rack, still), "crank": self.crank_link(crank_angle)}

    @property
    def discs_mm(self) -> Mapping[str, float]:
        """The pinion up to its pitch circle."""
        return {self.CRANK: self.radius_mm}

    @property
    def rod_lines_mm(self) -> Mapping[str, tuple[tuple[Point, Point], ...]]:
        """The rack's pitch line, long enough for one turn, as drawn."""
        return {"rack": (((-self.stroke_mm, 0.0), (0.0, 0.0)),)}

    def shapes(self) -> Mapping[str, LinkShape]:
        """A pinion with twenty straight teeth, and a rack long enough for one turn."""
        return {"rack": LinkShape(areas=(self._rack(),)), "crank": LinkShape(areas=(self._pinion(),))}

    @property
    def guides_mm(self) -> tuple[tuple[Point, Point], ...]:
        """The guide behind the rack."""
        back, half = self.radius_mm * (1.0 + 2.0 * BACK / TEETH), 1.3 * self.radius_mm
        return (((-half, back), (half, back)),)

    def _pinion(self) -> tuple[Point, ...]:
        """The pinion in its own frame; at the start one of its teeth points up, where the rack has a space."""
        module, points = 2.0 * self.radius_mm / TEETH, list[Point]()
        half = pi / (2.0 * TEETH)
        for tooth in range(TEETH):
            middle = 2.0 * pi * tooth / TEETH
            for height, angle in ((-1.25, -half * 1.45), (1.0, -half * 0.55), (1.0, half * 0.55), (-1.25, half * 1.45)):
                radius = self.radius_mm + height * module
                points.append((radius * cos(middle + angle), radius * sin(middle + angle)))
        return tuple(points)

    def _rack(self) -> tuple[Point, ...]:
        """The rack in its own frame: flanks of 20 deg along the pitch line, from a turn behind it to a little ahead."""
        module = 2.0 * self.radius_mm / TEETH
        pitch, lean = pi * module, tan(radians(20.0))
        points: list[Point] = []
        for number in range(-TEETH - 2, 3):
            middle = (number + 0.5) * pitch
            low, high = 0.25 * pitch - lean * module, 0.25 * pitch + 1.2 * lean * module
            points += [
                (middle - high, 1.2 * module),
                (middle - low, -module),
                (middle + low, -module),
                (middle + high, 1.2 * module),
            ]
        return (*points, (points[-1][0], BACK * module), (points[0][0], BACK * module))

    def moving_masses(self, crank_angle: Jet, masses: Masses) -> tuple[MovingMass, ...]:
        """The only mass is the rack."""
        rack = self.links(crank_angle)["rack"]
        return (MovingMass(masses.slider_kg, rack.origin, rack.angle),)

    def joint_forces(self, crank_angle: Jet, masses: Masses, pace: Pace, resistance_n: Term) -> JointForces:
        """Forces: the pinion's teeth push the rack along its line; the guide carries its weight across it."""
        rack = moving_force(masses, pace, masses.slider_kg, self.links(crank_angle)["rack"].origin)
        push = Vector(rack.x + resistance_n, 0.0 * rack.x)
        crank_axis, torque = crank_forces(self.crank_body(crank_angle, masses.crank_center_mm), masses, pace, push)
        return JointForces({"teeth": push}, crank_axis, rack.y, torque)
