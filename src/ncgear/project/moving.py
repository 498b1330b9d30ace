"""The moving parts of a design without its gears: law, mechanism, motion; how a drive keeps what it has computed."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import replace
from functools import cached_property, wraps
from typing import Any, Self, TypeVar, overload

from ncgear.design.keys.design import Design
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.errors import DesignError, Places, WrongInput, located
from ncgear.kinematics.check import KinematicCheck, kinematic_check, stroke_error_mm
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.project.law import law_of, load_of, motion_wishes_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Law, Pair, Transmission
from ncgear.shown import Shown
from ncgear.stopwatch import Stopwatch
from ncgear.wishes.wish import Achieved, Outcome, Wish, achieved

Value = TypeVar("Value", covariant=True)
Found = TypeVar("Found")
By = TypeVar("By", bound=str)


class computed(cached_property[Value]):
    """A cached property of a drive; its errors give their place in the design file.

    The place comes from the attribute ``places`` of the drive, which is None for a design that came from no file.
    """

    @overload
    def __get__(self, instance: None, owner: type[Any] | None = None) -> Self: ...

    @overload
    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Value: ...

    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Self | Value:
        if instance is None:
            return self
        with located(instance.places):
            return super().__get__(instance, owner)


def computed_by(method: Callable[[Any, By], Found]) -> Callable[[Any, By], Found]:
    """A method of a drive that is computed once for each value of its argument; an error is kept too."""

    @wraps(method)
    def known(drive: Any, by: By) -> Found:
        results: dict[str, Found | DesignError] = vars(drive).setdefault(f"_{method.__name__}", {})
        if by not in results:
            try:
                with located(drive.places):
                    results[by] = method(drive, by)
            except DesignError as refusal:
                results[by] = refusal
        found = results[by]
        if isinstance(found, DesignError):
            raise copy(found)
        return found

    return known


class Moving(Shown):
    """A design, and the motion of its machine; see ``ncgear.project.drive.Drive``."""

    def __init__(
        self,
        design: Design,
        stage: int | None = None,
        loaded: LoadedDesign | None = None,
        whole: Self | None = None,
        followed: object = None,
    ) -> None:
        self.design = design
        self.stage = stage
        self.loaded = loaded
        self.stopwatch = Stopwatch()
        self._whole = whole
        self.followed = followed
        """How the law follows a function given in a mapping; None without a function."""

    def __repr__(self) -> str:
        stage = "" if self.stage is None else f", stage {self.stage}"
        speed = self.design.operation.speed_rpm
        return f"Drive({self.design.name!r}, law {self.design.motion.law}, {speed:g} r/min{stage})"

    @property
    def title(self) -> str:
        """The name of the design, with the number of the pair where there are two."""
        return self.design.name if self.stage is None else f"{self.design.name}, stage {self.stage}"

    @property
    def stem(self) -> str:
        """The same for names of files."""
        return self.title.replace(", stage ", "-stage-")

    @property
    def of(self) -> str:
        """The beginning of what is said of one pair of two: ``stage 1: ``; else empty."""
        return "" if self.stage is None else f"stage {self.stage}: "

    @property
    def places(self) -> Places | None:
        """The places of the design's values in its file; None where it came from no file."""
        return self.loaded.source if self.loaded else None

    @property
    def timing_s(self) -> dict[str, float]:
        """Seconds spent so far in each step of the computation."""
        return dict(self.stopwatch.seconds)

    @computed
    def whole(self) -> Self:
        """The drive of the whole machine; a drive with a stage is one pair of its gears."""
        if self.stage is None:
            return self
        return self._whole or type(self)(self.design, loaded=self.loaded)

    @computed
    def law(self) -> Law:
        """Linkage and closed law."""
        if self._whole is not None:
            return self._whole.law
        with self.stopwatch("law"):
            return law_of(self.design)

    @property
    def linkage(self) -> Mechanism:
        """The mechanism that the driven gear turns."""
        return self.law.linkage

    @property
    def transmission(self) -> Transmission:
        """The closed law phi2(phi1)."""
        return self.law.transmission

    @computed
    def pair(self) -> Pair:
        """The law of one pair of gears; raises WrongInput where there are several and this drive has no stage."""
        if self.stage is None and self.design.stages > 1:
            said, key = self.design.stages_said
            raise WrongInput(f"{said}, and one is asked for; Drive.by_stage has each", key=key)
        return self.law.train.pairs[(self.stage or 1) - 1]

    @property
    def law_speed_rpm(self) -> float:
        """Driving speed at which the law's velocities hold; for a law without velocities, the operating speed."""
        stroke = self.law.stroke
        return stroke.law_speed_rad_s / RAD_S_PER_RPM if stroke else self.design.operation.speed_rpm

    @computed
    def machine(self) -> Machine:
        """The mechanism at the operating speed."""
        speed = self.design.operation.speed_rpm * RAD_S_PER_RPM
        return Machine(self.transmission, self.linkage, load_of(self.design), speed)

    def pair_speed_rad_s(self, angle_rad: Array) -> Array:
        """Speed of the pair's driving gear at its own angles in rad, shape (n,)."""
        return self.pair.speed(angle_rad) * self.machine.speed_rad_s

    @computed
    def uniform_machine(self) -> Machine:
        """The same linkage on a crank that turns evenly, at the same number of strokes per minute."""
        return replace(self.machine, transmission=uniform_law(self.transmission.lobes))

    @computed
    def massless_check(self) -> KinematicCheck:
        """Exact peaks at the operating speed, with the power of the resistance alone."""
        with self.stopwatch("check"):
            return kinematic_check(self.machine)

    @computed
    def motion_wishes(self) -> tuple[Wish, ...]:
        """The wishes of the motion; raises WrongInput or NoSuchMechanism for wishes that no motion can keep."""
        return motion_wishes_of(self.design, self.linkage, self.transmission.cycle_rad)

    @computed
    def achieved(self) -> Achieved | None:
        """Figures of the motion, without a wish and for every wish; None for an output that never returns."""
        if not self.linkage.RETURNS:
            return None
        outcomes = self.outcomes
        with self.stopwatch("wishes"):
            return achieved(self.machine, outcomes)

    @computed
    def outcomes(self) -> tuple[Outcome, ...]:
        """What the motion achieves of every wish; none of an output that never returns."""
        wishes = self.motion_wishes if self.linkage.RETURNS else ()
        with self.stopwatch("wishes"):
            return tuple(wish.outcome(self.machine) for wish in wishes) if self.transmission.lobes.repeats else ()

    @computed
    def stroke_residual(self) -> float:
        """Difference in mm or rad of motion and stroke: by the output's integrated speed, or by a law's own parts."""
        prescribed = abs(self.law.stroke.closing_error_mm) if self.law.stroke else 0.0
        with self.stopwatch("check"):
            return max(abs(stroke_error_mm(self.machine)), prescribed)

    @property
    def told_stroke_residual(self) -> dict[str, float]:
        """The stroke's residual by its key, in the unit that people read; empty for an output that never returns."""
        place = self.linkage.OUTPUT.place
        if not self.linkage.RETURNS:
            return {}
        return {f"stroke_residual_{place.ending}": place.factor * self.stroke_residual}
