"""A balance file and everything that follows from it; each part is computed when it is first asked for.

The functions below the class turn the keys of the file into values for ``ncgear.balance``.
"""

from __future__ import annotations

from cmath import exp
from functools import cached_property
from math import radians
from typing import TYPE_CHECKING

from ncgear.balance.frame import Mounted
from ncgear.balance.gears import BossSize, Drills, Means
from ncgear.balance.mechanism import Carrier, Counterweight, DrivenCrank, JointMasses, joint_masses
from ncgear.balance.rotor import ChainPhases, TrialRun, WeightRun
from ncgear.design.keys import balance as keys
from ncgear.design.mechanisms import mechanism_of
from ncgear.design.reading.balance_file import LoadedBalance
from ncgear.errors import WrongInput, below, located
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import RodMasses
from ncgear.mechanisms.mechanism import require_rod
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.project.drive import Drive
from ncgear.project.law import require_whole_turns
from ncgear.project.moving import masses_of, stated_inertia
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.shown import Shown

if TYPE_CHECKING:
    from ncgear.balance.gears import Corrected, GearBody


@dataclass(frozen=True, eq=False)
class BalancedGear:
    """The body of a gear as designed, its highest speed, and its correction; None where the file asks for none."""

    body: GearBody
    speed_rad_s: float
    corrected: Corrected | None


class Balancing(Shown):
    """A balance file; its mechanisms and gears are attributes, which raise WrongInput or NoSuchMechanism."""

    def __init__(self, loaded: LoadedBalance) -> None:
        self.loaded = loaded

    @property
    def balance(self) -> keys.Balance:
        """The keys of the file."""
        return self.loaded.balance

    @cached_property
    def mounted(self) -> list[Mounted]:
        """The mechanisms in their places."""
        return [self._mounted(number, given) for number, given in enumerate(self.balance.mechanisms)]

    @cached_property
    def gears(self) -> dict[str, BalancedGear]:
        """Both gears of the design, driving and driven."""
        drive = self._drive("gears.design")
        slope = drive.pair.transmission.slope_range[1].value
        speeds = {"driving": self._speed_rad_s, "driven": self._speed_rad_s * slope}
        return {gear: self._gear(drive, gear, speed) for gear, speed in speeds.items()}

    @property
    def _speed_rad_s(self) -> float:
        assert self.balance.speed_rpm is not None
        return self.balance.speed_rpm * RAD_S_PER_RPM

    def _mounted(self, number: int, given: keys.Mechanism) -> Mounted:
        """A mechanism in its place, with the counterweights that it already has."""
        if given.linkage is not None and given.linkage.crank_mm is not None and given.masses is not None:
            with below(f"mechanisms.{number}"):
                linkage = require_rod(mechanism_of(given.linkage), "balance", "linkage")
            transmission = uniform_law(Lobes())
            masses = masses_of(given.masses, linkage, stated_inertia(given.masses))
        else:
            drive = self._drive(f"mechanisms.{number}.design")
            with located(drive.places):
                require_whole_turns(drive.design, "balance of a mechanism")
                linkage = require_rod(drive.linkage, "balance", "linkage")
            transmission = drive.transmission
            stated = given.masses
            masses = drive.masses if stated is None else masses_of(stated, linkage, stated_inertia(stated))
        added = tuple(
            Counterweight(Carrier(weight.on), weight.mass_kg, weight.arm_mm, radians(weight.angle_deg))
            for weight in given.counterweights
        )
        assert isinstance(masses, RodMasses)
        mechanism = DrivenCrank(linkage, transmission, self._speed_rad_s, masses, added)
        place = complex(given.x_mm, given.y_mm)
        return Mounted(mechanism, radians(given.direction_deg), radians(given.phase_deg), given.mirrored, place)

    def _drive(self, key: str) -> Drive:
        """The drive of a design that the file names; its errors give their place in the file of that design."""
        loaded = self.loaded.designs[key]
        return Drive(loaded.design, loaded=loaded)

    def _gear(self, drive: Drive, gear: str, speed_rad_s: float) -> BalancedGear:
        from ncgear.balance.gears import corrected, mesh_body, plate_body

        asked = self.balance.gears
        assert asked is not None
        correction, density = asked.driving if gear == "driving" else asked.driven, asked.density_kg_m3
        if drive.helix is not None and correction is not None:
            raise WrongInput("helical gears are not corrected; leave it out", key=f"gears.{gear}")
        solid = getattr(drive.solids, gear)
        if drive.helix is not None:
            return BalancedGear(mesh_body(solid.triangles, density), speed_rad_s, None)
        plan, width = solid.plan, drive.gears.face_width_mm
        body = plate_body(plan.section, width, density) if plan.is_plate else mesh_body(solid.triangles, density)
        if correction is None:
            return BalancedGear(body, speed_rad_s, None)
        if not plan.is_plate:
            problem = "gears with a hub, a web or a chamfer are not corrected; leave it out, or those"
            raise WrongInput(problem, key=f"gears.{gear}")
        holes, boss, tolerance = correction.holes, correction.boss, drive.chord_tolerance_mm
        drills = Drills(holes.largest_mm, holes.smallest_mm, holes.wall_mm) if holes else None
        means = Means(drills, BossSize(boss.height_mm, boss.wall_mm) if boss else None)
        made = corrected(plan.section, width, density, means, tolerance, f"gears.{gear}")
        return BalancedGear(body, speed_rad_s, made)


def joint_masses_of(given: keys.Partial, mechanism: DrivenCrank) -> JointMasses:
    """The masses at the joints: the given masses, or else the masses that follow from the parts."""
    parts = joint_masses(mechanism.linkage, mechanism.masses)
    return JointMasses(
        parts.rotating_kg if given.rotating_kg is None else given.rotating_kg,
        parts.reciprocating_kg if given.reciprocating_kg is None else given.reciprocating_kg,
    )


def crank_counterweight(given: keys.Sweep) -> Counterweight:
    """The counterweight to try, without its mass."""
    return Counterweight(Carrier.CRANK, 0.0, given.arm_mm, radians(given.angle_deg))


def readings_of(given: keys.Readings | None) -> tuple[complex, ...]:
    """Readings as complex numbers."""
    return tuple(_polar(reading.amplitude, reading.phase_deg) for reading in given or ())


def trial_runs_of(given: keys.Rotor) -> list[TrialRun]:
    """Runs with trial weights in g."""
    return [
        TrialRun(_polar(trial.mass_g, trial.angle_deg), readings_of(trial.readings)) for trial in given.trials or ()
    ]


def weight_runs_of(given: keys.ChainDrive) -> list[WeightRun]:
    """Runs with one weight at several phases."""
    return [WeightRun(radians(run.weight_deg), _polar(run.amplitude, run.phase_deg)) for run in given.runs or ()]


def chain_phases_of(given: keys.ChainDrive) -> ChainPhases:
    """Phases of a chain drive."""
    return ChainPhases(radians(given.wrap_deg), radians(given.tight_deg), radians(given.slack_deg))


def _polar(amplitude: float, phase_deg: float) -> complex:
    return amplitude * exp(1j * radians(phase_deg))
