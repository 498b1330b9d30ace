"""The driven shaft by itself: gears without a linkage, whose output is the turning shaft.

The place of the output is the driven angle.  It grows without end and has no dead centre; the torque repeats every
turn.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import ClassVar, Self

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import CrankBody, JointForces, Masses, Pace, crank_forces
from ncgear.mechanisms.mechanism import Link, Mechanism, MovingMass, Output
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector


@dataclass(frozen=True)
class DrivenShaft(Mechanism):
    """The shaft of the driven gear; its stroke is one turn in rad."""

    NAME: ClassVar[str] = "the driven shaft by itself"
    OUTPUT: ClassVar[Output] = Output("driven shaft", angular=True)
    RETURNS: ClassVar[bool] = False
    UNIFORM: ClassVar[str] = "even gears"
    PISTON: ClassVar[bool] = False
    POINTS: ClassVar[tuple[str, ...]] = ()
    CRANK: ClassVar[str] = "driven shaft"
    HAS_CRANK: ClassVar[bool] = False
    GUIDED: ClassVar[bool] = False
    JOINTS: ClassVar[Mapping[str, str]] = {}

    @classmethod
    def of_stroke(cls, stroke_mm: float, **lengths: float) -> Self:
        """Raises WrongInput: a shaft has no stroke."""
        raise WrongInput("there is no linkage, and so no stroke to solve for; give linkage", key="motion.solve_for")

    @property
    def crank_mm(self) -> float:
        """A shaft has no crank: 0."""
        return 0.0

    @property
    def turns_fully(self) -> Mask:
        """True: a shaft always turns fully."""
        return np.asarray(True)

    @property
    def stroke_mm(self) -> float:
        """One turn, 2 pi rad."""
        return 2.0 * pi

    @property
    def nearest_mm(self) -> float:
        """The angle from which places are counted: 0."""
        return 0.0

    @property
    def working_angle_rad(self) -> float:
        """One whole turn."""
        return 2.0 * pi

    def displacement(self, crank_angle: Jet) -> Jet:
        """The driven angle itself."""
        return crank_angle

    def working_angle(self, displacement_mm: Array, remaining_mm: Array) -> Array:
        """The displacement itself."""
        return displacement_mm

    def regular_slope(self, displacement: Jet, root: Jet) -> Jet:
        """The root itself."""
        return root

    def crank_angle(self, displacement_mm: Array, returning: Mask) -> Array:
        """The displacement itself."""
        return displacement_mm

    def crank_body(self, crank_angle: Jet, center_mm: float) -> CrankBody:
        """The shaft, with its centre of mass on its axis."""
        still = 0.0 * crank_angle
        return CrankBody(crank_angle, Vector(still, still), Vector(still, still))

    def links(self, crank_angle: Jet) -> Mapping[str, Link]:
        """No bodies: only the gears are drawn."""
        return {}

    def moving_masses(self, crank_angle: Jet, masses: Masses) -> tuple[MovingMass, ...]:
        """A single body without mass, on the axis: nothing moves that does not turn with the shaft."""
        still = 0.0 * crank_angle
        return (MovingMass(0.0, Vector(still, still), crank_angle),)

    def joint_forces(self, crank_angle: Jet, masses: Masses, pace: Pace, resistance_n: Term) -> JointForces:
        """No joints; the load and everything that turns with the shaft make its torque."""
        body = self.crank_body(crank_angle, 0.0)
        axis, torque = crank_forces(body, masses, pace, Vector(0.0 * resistance_n, 0.0 * resistance_n))
        return JointForces({}, axis, 0.0 * resistance_n, torque + resistance_n)
