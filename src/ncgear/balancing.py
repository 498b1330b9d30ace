"""A balance file and all that follows from it; each part is computed when it is first asked for."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from ncgear.balance.frame import Mounted
from ncgear.design.balance import Balance
from ncgear.design.balance_mechanism import Mechanism as Given
from ncgear.design.load_balance import LoadedBalance
from ncgear.drive import Drive
from ncgear.errors import DesignError, WrongInput
from ncgear.machine.linkage import CrankSlider
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.recipe.balance import means_of, mechanism_of, mounted_of
from ncgear.recipe.masses import masses_of

if TYPE_CHECKING:
    from ncgear.balance.gear_body import GearBody
    from ncgear.balance.gear_correction import Corrected


@dataclass(frozen=True, eq=False)
class BalancedGear:
    """A gear as designed, its highest speed, and itself corrected where the file says how."""

    body: GearBody
    speed_rad_s: float
    corrected: Corrected | None


class Balancing:
    """A balance file whose parts are attributes; they raise WrongInput or NoSuchMechanism with key or place."""

    def __init__(self, loaded: LoadedBalance) -> None:
        self.loaded = loaded

    @property
    def balance(self) -> Balance:
        """What the file says."""
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

    def _mounted(self, number: int, given: Given) -> Mounted:
        assert self.balance.speed_rpm is not None
        if given.linkage is not None and given.linkage.crank_mm is not None and given.masses is not None:
            with under(f"mechanisms.{number}"):
                linkage = CrankSlider(given.linkage.crank_mm, given.linkage.rod_mm, given.linkage.offset_mm)
            driven_by = linkage, uniform_law(Lobes())
            masses = masses_of(given.masses, 0.0, given.masses.driven_gear_kg_mm2 or 0.0)
        else:
            drive = self._drive(f"mechanisms.{number}.design")
            driven_by = drive.linkage, drive.transmission
            masses = drive.masses if given.masses is None else masses_of(given.masses, 0.0, 0.0)
        return mounted_of(given, mechanism_of(given, driven_by, masses, self.balance.speed_rpm))

    def _drive(self, key: str) -> Drive:
        """The drive of a design that the file names; its faults are told with their place in that design's file."""
        loaded = self.loaded.designs[key]
        return Drive(loaded.design, loaded=loaded)

    def _gear(self, drive: Drive, gear: str, speed_rad_s: float) -> BalancedGear:
        from ncgear.balance.gear_body import mesh_body, plate_body
        from ncgear.balance.gear_correction import corrected

        asked = self.balance.gears
        assert asked is not None
        correction = asked.driving if gear == "driving" else asked.driven
        if drive.helix is not None:
            if correction is not None:
                raise WrongInput("helical gears are not corrected; leave it out", key=f"gears.{gear}")
            return BalancedGear(mesh_body(getattr(drive.solids, gear).mesh, asked.density_kg_m3), speed_rad_s, None)
        solid, width, density = getattr(drive.solids, gear), drive.gears.face_width_mm, asked.density_kg_m3
        plan = solid.plan
        body = plate_body(plan.section, width, density) if plan.is_plate else mesh_body(solid.mesh, density)
        if correction is None:
            return BalancedGear(body, speed_rad_s, None)
        if not plan.is_plate:
            problem = "gears with a hub, a web or a chamfer are not corrected; leave it out, or those"
            raise WrongInput(problem, key=f"gears.{gear}")
        tolerance = drive.design.output.chord_tolerance_mm
        made = corrected(plan.section, width, density, means_of(correction), tolerance, f"gears.{gear}")
        return BalancedGear(body, speed_rad_s, made)


@contextmanager
def under(group: str) -> Iterator[None]:
    """Errors raised within know their key below ``group`` only; they get it as the file has it."""
    try:
        yield
    except DesignError as error:
        if not error.location:
            error.key = f"{group}.{error.key}" if error.key else group
        raise
