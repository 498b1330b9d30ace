"""The keys of forces: moving masses, direction of gravity, load on the teeth, motor.

Coefficients of friction come from the publication on the baler, which does not give the speeds at which friction
changes. Stiffness and damping follow by default from the form and width of the gears' teeth, not from the multi-body
program of the publication; its law, with any exponent, can be given. The default damping ratio is in the middle of the
measured range of gears in mesh, 0.03 to 0.17 (R. Kasuba, J. W. Evans, J. Mech. Des. 103 (1981), 398-409, from a
secondary source).
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ncgear.design.keys.base import Faults, Model, Place, Positive, Several, Speed, counts, fault, optional, required
from ncgear.design.words import COUNTS
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.units import STANDARD_GRAVITY_M_S2

HEAVIEST_KG = 1e7
"""Ten thousand tonnes: beyond any machine."""

LARGEST_INERTIA_KG_MM2 = 1e16

Mass = Annotated[float, Field(ge=0.0, le=HEAVIEST_KG)]
Inertia = Annotated[float, Field(ge=0.0, le=LARGEST_INERTIA_KG_MM2)]


class Rod(Model):
    """The connecting rod as a rigid body."""

    mass_kg: Mass = required("mass of the rod in kg")
    center_mm: Place = required("distance of its centre of mass from the crank pin towards the slider in mm")
    inertia_kg_mm2: Inertia = required("moment of inertia about its centre of mass in kg mm2")

    def _faults(self) -> Faults:
        if self.inertia_kg_mm2 > 0.0 and self.mass_kg == 0.0:
            yield fault("mass_kg", "0 given, but a body without mass has no moment of inertia; give both or neither")


class Crank(Model):
    """The crank with all parts that turn with it, except the driven gear."""

    mass_kg: Mass = required("mass of the crank in kg")
    center_mm: Place = required(
        "distance of its centre of mass from its axis towards the crank pin in mm; negative beyond the axis"
    )
    inertia_kg_mm2: Inertia = required("moment of inertia about its axis in kg mm2")

    def _faults(self) -> Faults:
        least = self.mass_kg * self.center_mm**2
        if self.inertia_kg_mm2 < least:
            yield fault(
                "inertia_kg_mm2",
                f"{self.inertia_kg_mm2:g} kg mm2 is less than the mass at its centre alone has about the axis; "
                f"{shown_above(least)} or over is right",
            )


class Swinging(Crank):
    """A rocker or a lever with all parts that turn with it, as a rigid body on its own axis."""

    mass_kg: Mass = required("its mass in kg")
    center_mm: Place = required(
        "distance of its centre of mass from its axis towards its pin in mm; negative beyond the axis"
    )
    inertia_kg_mm2: Inertia = required("moment of inertia about its axis in kg mm2")


class Flywheel(Model):
    """A flywheel on the driving shaft: its inertia, and the required evenness of the shaft's turning."""

    inertia_kg_mm2: Inertia = optional("moment of inertia in kg mm2; left out: no flywheel", 0.0)
    speed_fluctuation: Annotated[float, Field(gt=0.0, le=0.2)] = optional(
        "coefficient of speed fluctuation, largest less smallest speed over the mean, for which the inertia that is "
        "needed is told",
        0.05,
    )


class Gravity(Model):
    """The direction of gravity."""

    acceleration_m_s2: float = optional("acceleration of gravity in m/s2", STANDARD_GRAVITY_M_S2, ge=0.0, le=1000.0)
    direction_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = optional(
        "direction of gravity in degrees from the slider's way out, counter-clockwise; left out: across it", -90.0
    )


SLIDER = "mass of the slider in kg, with all that moves with it"


class GearMasses(Model):
    """Moments of inertia of the parts that turn with the gears."""

    driving_gear_kg_mm2: Inertia | None = optional(
        "moment of inertia of the driving shaft with its gear in kg mm2, its flywheel apart; left out: the "
        "gear's own body"
    )
    driven_gear_kg_mm2: Inertia | None = optional(
        "moment of inertia of the driven gear in kg mm2, the last one of two pairs; left out: its own body"
    )
    shaft_between_kg_mm2: Inertia | Several[Inertia] | None = optional(
        "moment of inertia in kg mm2 of the shaft between two pairs of gears in series, with its gears; between more "
        "pairs a list of them, from the driving shaft on; left out: these gears' own bodies"
    )
    density_kg_m3: float | None = optional(
        "density of all gears in kg/m3; left out: densities of gears.material, 7850 without it", gt=0.0, le=30000.0
    )
    flywheel: Flywheel = optional("flywheel on the driving shaft; left out: none", Flywheel)
    driven_flywheel_kg_mm2: Inertia = optional(
        "moment of inertia in kg mm2 of a flywheel on the driven shaft; left out: none", 0.0
    )

    @property
    def shafts_between_kg_mm2(self) -> tuple[float, ...]:
        """The given moments of inertia of all shafts between; empty where they are left out."""
        given = self.shaft_between_kg_mm2
        return given if isinstance(given, tuple) else () if given is None else (given,)


def shafts_counted(masses: GearMasses | None, pairs: int) -> Faults:
    """The fault of a list of moments of inertia that is not one for each shaft between pairs of gears in series."""
    given, of = len(masses.shafts_between_kg_mm2) if masses else 0, f"{COUNTS[pairs]} pair{'s' * (pairs != 1)} of gears"
    yield from counts("masses.shaft_between_kg_mm2", given, pairs - 1, "shaft", f"between {of}")


class DrivenShaftMasses(GearMasses, first=True):
    """Moments of inertia of the parts that turn with the shafts of gears without a linkage."""

    shaft_kg_mm2: Inertia = required(
        "moment of inertia in kg mm2 of the driven shaft and all it drives, the driven gear apart"
    )

    @property
    def crank(self) -> Crank:
        """The driven shaft with the parts that it drives, balanced."""
        return Crank(mass_kg=0.0, center_mm=0.0, inertia_kg_mm2=self.shaft_kg_mm2)

    @property
    def gravity(self) -> None:
        """Weights do nothing where all bodies turn about their centres."""
        return


class CrankMasses(GearMasses, first=True):
    """Masses of the parts that turn with the crank and with the driving shaft."""

    crank: Crank = required("the crank with all that turns with it, the driven gear apart")


class ShaftMasses(CrankMasses):
    """The same masses, and gravity."""

    gravity: Gravity | None = optional("gravity; left out: none")


class SlidingMasses(ShaftMasses, first=True):
    """Masses and moments of inertia of the moving parts of a mechanism with no link between crank and slider."""

    slider_kg: Mass = required(SLIDER)


class Masses(ShaftMasses, first=True):
    """Masses and moments of inertia of the moving parts."""

    slider_kg: Mass = required(SLIDER)
    rod: Rod = required("the connecting rod")


class RockerMasses(ShaftMasses, first=True):
    """Masses and moments of inertia of the moving parts of a crank-rocker."""

    rocker: Swinging = required("the rocker of a crank_rocker with all that turns with it")
    coupler: Rod = required("the coupler of a crank_rocker; its centre from the crank pin to the rocker's")


class LeverMasses(ShaftMasses, first=True):
    """Masses and moments of inertia of the moving parts of a slotted lever; the slider is the ram."""

    slider_kg: Mass = required(SLIDER)
    lever: Swinging = required("the lever of a slotted_lever")
    block_kg: Mass = optional("mass of a slotted_lever's block in kg", 0.0)


STEEPEST = 10.0
"""Largest exponent: with a larger one the contact is nearly rigid, and the level rigid computes that already."""

MOST_TURNS = 100.0


class Friction(Model):
    """Coulomb's friction with a coefficient that depends on the sliding speed."""

    RULES = ("static >= dynamic", "dynamic_speed_mm_s > static_speed_mm_s")

    static: float = optional("coefficient at rest", 0.08, ge=0.0, le=2.0)
    dynamic: float = optional("coefficient in motion", 0.05, ge=0.0, le=2.0)
    static_speed_mm_s: Positive = optional("sliding speed at which friction reaches the coefficient at rest", 1.0)
    dynamic_speed_mm_s: Positive = optional(
        "sliding speed at which friction is down to the coefficient in motion", 10.0
    )


class Motor(Model):
    """A motor whose torque falls linearly with its speed; its flywheel is the flywheel of the masses."""

    no_load_speed_rpm: Speed = required("speed at which it has no torque left, in r/min at the driving gear")
    stall_torque_n_m: Positive = required("torque at rest in N m at the driving gear")


class Simulation(Model):
    """Settings of the levels quasi_static and dynamic."""

    stiffness_n_mm: Positive | None = optional(
        "force in N of a pair of teeth 1 mm deep in each other, k of k d^exponent; left out: each pair's own "
        "stiffness, from its teeth, their material and the face width"
    )
    exponent: float = optional(
        "exponent of the depth in the force; other than 1 only with stiffness_n_mm", 1.0, ge=1.0, le=STEEPEST
    )
    damping_n_s_mm: float | None = optional(
        "damping of a pair of teeth in N s/mm, where it is full; left out: by damping_ratio", ge=0.0
    )
    damping_ratio: float = optional(
        "damping as a share of the critical damping of one pair of teeth between both shafts", 0.07, ge=0.0, le=1.0
    )
    full_damping_depth_mm: Positive | None = optional(
        "depth in mm from which on damping is full; left out: 1/1500 of the module"
    )
    friction: Friction = optional("friction between the teeth", Friction)
    motor: Motor | None = optional("motor of the level dynamic; left out: operation.speed_rpm, at any torque")
    start: Literal["on_law", "rest"] = optional(
        "on_law: both gears run as the law says, the driving one at operation.speed_rpm; rest: both stand still, and "
        "motor starts them",
        "on_law",
    )
    turns: float = optional("turns of the driving gear in level dynamic", 1.0, gt=0.0, le=MOST_TURNS)

    @property
    def of_own_stiffness(self) -> Simulation:
        """The same friction and damping for teeth with their own stiffness, as they are rated.

        Damping beside a given stiffness belongs to that law of contact.
        """
        if self.stiffness_n_mm is None:
            return self
        law = {"stiffness_n_mm": None, "exponent": 1.0, "damping_n_s_mm": None, "full_damping_depth_mm": None}
        return self.model_copy(update=law)

    def _faults(self) -> Faults:
        if self.exponent != 1.0 and self.stiffness_n_mm is None:
            yield fault(
                "exponent",
                f"{self.exponent:g} given without stiffness_n_mm, but the teeth's own stiffness is linear; leave it "
                "out, or give stiffness_n_mm as well",
            )
        if self.start == "rest" and self.motor is None:
            yield fault(
                "start",
                "rest given without motor, but a drive at constant speed never stands still: it would strike the "
                "resting driven gear at full speed; give motor as well, or on_law",
            )
