"""How the teeth bear load and what turns them; the defaults are those of the published baler's simulation.

The publication gives elastic constants, exponent, damping with its depth, and both coefficients of friction.  It does
not give a stiffness: Hertz's for two spheres as large as circular gears of the same length is taken, as users of
multi-body programs do.  Nor does it give the speeds at which friction changes over.
"""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from ncgear.design.base import Model, Positive, Speed
from ncgear.design.faults import fault

STEEPEST = 10.0
"""Exponent beyond which a contact is a gap with a wall behind it, which the rigid level has already."""

MOST_TURNS = 100.0


class Friction(Model):
    """Coulomb's friction, whose coefficient depends on the speed of sliding."""

    static: float = Field(default=0.08, ge=0.0, le=2.0, description="coefficient at rest")
    dynamic: float = Field(default=0.05, ge=0.0, le=2.0, description="coefficient in motion")
    static_speed_mm_s: Positive = Field(default=1.0, description="speed of sliding at which the one at rest is reached")
    dynamic_speed_mm_s: Positive = Field(
        default=10.0, description="speed of sliding from which on the one in motion holds"
    )

    @model_validator(mode="after")
    def _rest_comes_first(self) -> Self:
        if self.static < self.dynamic:
            raise fault(
                "static", f"{self.static:g} is less than the dynamic {self.dynamic:g}; as much or more is right"
            )
        if not self.static_speed_mm_s < self.dynamic_speed_mm_s:
            raise fault(
                "dynamic_speed_mm_s",
                f"{self.dynamic_speed_mm_s:g} mm/s is not beyond static_speed_mm_s; over {self.static_speed_mm_s:g} "
                "is right",
            )
        return self


class Motor(Model):
    """A motor whose torque falls in a line with its speed; the flywheel is that of the masses."""

    no_load_speed_rpm: Speed = Field(description="speed at which it has no torque left, in r/min at the driving gear")
    stall_torque_n_m: Positive = Field(description="torque at rest in N m at the driving gear")


class Simulation(Model):
    """How the levels quasi_static and dynamic are computed."""

    youngs_modulus_gpa: Positive = Field(default=201.0, description="Young's modulus of both gears in GPa")
    poisson: float = Field(default=0.29, gt=-1.0, le=0.5, description="Poisson's ratio of both gears")
    stiffness_n_mm: Positive | None = Field(
        default=None,
        description="force in N of a contact 1 mm deep, k of k d^exponent; left out: Hertz's for two spheres as large "
        "as circular gears of the same length",
    )
    exponent: float = Field(default=2.2, ge=1.0, le=STEEPEST, description="exponent of the depth in the contact force")
    damping_n_s_mm: float = Field(default=100.0, ge=0.0, description="damping of a contact in N s/mm, where it is full")
    full_damping_depth_mm: Positive = Field(default=0.1, description="depth in mm from which on damping is full")
    friction: Friction = Field(default_factory=Friction, description="friction between the teeth")
    motor: Motor | None = Field(
        default=None,
        description="what drives the level dynamic; left out: operation.speed_rpm, whatever torque it takes",
    )
    start: Literal["on_law", "rest"] = Field(
        default="on_law", description="on_law: both gears run as the law says; rest: the driven gear stands still"
    )
    turns: float = Field(default=1.0, gt=0.0, le=MOST_TURNS, description="turns of the driving gear in level dynamic")
