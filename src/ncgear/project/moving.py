"""The moving parts of a design without its gears: law, mechanism, motion, masses; how a drive keeps what it computes.

Where a design leaves out a gear's moment of inertia, the gear's own body gives it: slab by slab, from the plan of the
gear as it comes out of the process, without changes of the written solid for the process (bevels, and moved outlines).
Gears that cannot be made as given have no body; then a disc within the pitch curve takes its place, with bore and hub,
and the answer says so.  On a circle such a disc is heavier than the toothed gear by about one module's width in ten of
its rim, or 0.4 module over the radius (tests/test_one_machine.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import copy
from dataclasses import replace
from functools import cached_property, wraps
from math import cos, pi, radians, sin
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple, Self, TypeVar, overload

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import Gears
from ncgear.design.keys.masses import DrivenShaftMasses, Gravity, ShaftMasses
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.errors import DesignError, Places, WrongInput, located
from ncgear.frozen import dataclass
from ncgear.kinematics.check import KinematicCheck, kinematic_check, stroke_error_mm
from ncgear.kinematics.motion import Machine
from ncgear.mechanisms.forces import Masses
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.project.law import law_of, load_of, motion_wishes_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Law, Pair, Transmission
from ncgear.shown import Shown
from ncgear.wishes.wish import Achieved, Outcome, Wish, achieved

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


class Stopwatch:
    """Adds up seconds by step; while an inner step runs, the time of the outer step does not count.

    ``within`` is called with the progress of a long step; a display of progress puts its own function there.
    """

    def __init__(self) -> None:
        self.within: Callable[[str], None] = lambda _said: None
        self.seconds: dict[str, float] = {}
        self._inner: list[float] = []

    @contextmanager
    def __call__(self, step: str) -> Iterator[None]:
        """Time the body as ``step``."""
        start = perf_counter()
        self._inner.append(0.0)
        try:
            yield
        finally:
            whole = perf_counter() - start
            self.seconds[step] = self.seconds.get(step, 0.0) + whole - self._inner.pop()
            if self._inner:
                self._inner[-1] += whole


def left_words(seconds: float, share: float) -> str:
    """How long a step takes that has done a share of its work in so many seconds; empty for less than a minute."""
    left_min = seconds * (1.0 / share - 1.0) / 60.0 if share > 0.0 else 0.0
    return f", about {left_min:.0f} min left" if left_min >= 1.0 else ""


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
