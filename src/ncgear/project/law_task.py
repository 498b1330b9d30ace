"""From keys to values: the machine for which laws are searched, its goal and limits, and the comparison of its laws."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from functools import cached_property
from math import pi, radians, sin
from typing import TYPE_CHECKING, NamedTuple

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import SIZES, Gears
from ncgear.design.keys.masses import Flywheel
from ncgear.design.keys.optimize import Limits, Optimize
from ncgear.design.laws.base import LawKeys
from ncgear.design.laws.registry import even_motion
from ncgear.design.mechanisms import mechanism_of
from ncgear.errors import DesignError, WrongInput
from ncgear.mechanisms.forces import Masses
from ncgear.numerics.bounds import shown_below
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.optimum import task
from ncgear.optimum.makeable.wishes import ALONE, CurvatureWish, Goal, TwoStages, Wishes
from ncgear.optimum.task import Figures, Task, figures
from ncgear.project import law
from ncgear.project.moving import TrainInertia, masses_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import PairsInSeries, single

if TYPE_CHECKING:
    from ncgear.project.drive import Drive

RACK_ANGLE_DEG = 20.0
"""Pressure angle of the rack where a design has no gears, as in ISO 53."""


def task_of(design: Design, gears: TrainInertia) -> task.Task:
    """The machine: mechanism, load, masses with the moments of inertia of its gears, speed and lobes.

    Raises WrongInput for gears that turn less than once, for a mechanism whose output never returns (limits and laws of
    strokes know dead centres), and where friction in the guide would change limited figures.
    """
    law.require_whole_turns(design, "the search for a best law")
    if design.gears is not None and design.gears.pairs > 1:
        # The limits would be those of one pair with the law
        raise WrongInput(
            f"{design.gears.pairs} given; a best law is for one pair, or for two by optimize.limits.stages: leave it "
            "out, and give it in the file that is written",
            key="gears.pairs",
        )
    if design.gears is not None and design.gears.idlers is not None:
        raise WrongInput(
            "given, but a best law is for one pair: leave it out, and give it, with law_of: row, in the file that is "
            "written",
            key="gears.idlers",
        )
    linkage, given, limits = mechanism_of(design.linkage), design.masses, (design.optimize or Optimize()).limits
    if not linkage.RETURNS:
        problem = f"{linkage.NAME} moves nothing to and fro, and the search for a best law takes strokes only"
        raise WrongInput(f"{problem}; a mechanism with dead centres is right", key="linkage")
    _refuse_guide_friction(design)
    return task.Task(
        linkage,
        law.load_of(design),
        design.operation.speed_rpm * RAD_S_PER_RPM,
        law.lobes_of(design),
        masses=_masses_of(design, gears),
        gears=_size_of(design, limits),
        speed_fluctuation=(given.flywheel if given else Flywheel()).speed_fluctuation,
        guide_friction=design.drivetrain.guide_friction if design.drivetrain else 0.0,
        harmonics_above=_harmonics_above(design.optimize or Optimize()),
    )


def _harmonics_above(asked: Optimize) -> int | None:
    """The order above which harmonics count; None where they are neither minimised nor limited."""
    of_law = _prices(asked)
    priced = of_law.torque_harmonics_n_m or of_law.acceleration_harmonics_mm_s2
    limited = any(value is not None for name, value in asked.limits if "_harmonics_" in name)
    return asked.harmonics_above if priced or limited else None


def _masses_of(design: Design, gears: TrainInertia) -> Masses | None:
    """All moving masses.  Without masses: zero masses where a figure of forces is asked for, else None."""
    linkage, asked = mechanism_of(design.linkage), design.optimize or Optimize()
    if design.masses is not None:
        return masses_of(design.masses, linkage, gears)
    return linkage.MASSES() if _limited_loads(asked.limits) or _prices(asked).of_loads else None


def _limited_loads(limits: Limits) -> list[str]:
    """The keys of the given limits of loads."""
    return [name for name in (*task.LOAD_LIMITS, "teeth_hold") if getattr(limits, name)]


def _refuse_guide_friction(design: Design) -> None:
    """Refuse limits and goals of loads with friction in the guide."""
    asked = design.optimize or Optimize()
    limited = [*(["peak_power_w"] if asked.limits.peak_power_w else []), *_limited_loads(asked.limits)]
    prices = _prices(asked)
    if limited or prices.of_loads or prices.peak_power_w:
        refuse_guide_friction(design, f"optimize.limits.{limited[0]}" if limited else "optimize.goal")


def refuse_guide_friction(design: Design, changed: str) -> None:
    """Refuse friction in the guide: it changes ``changed``, and the search for a law does not include it."""
    if design.drivetrain is not None and design.drivetrain.guide_friction:
        raise WrongInput(
            f"given, but the search for a law does not know friction in the guide, which changes {changed}; "
            "leave the friction out to search, and give it again to check, simulate and build",
            key="drivetrain.guide_friction",
        )


def inertia_with(design: Design, motion: LawKeys) -> TrainInertia:
    """The moments of inertia of a design's gears made for another motion; as given where all are given.

    Raises as pitch curves and laws do.
    """
    return TrainInertia() if design.masses is None else drive_with(design, motion).train_inertia


def drive_with(design: Design, motion: LawKeys) -> Drive:
    """The drive of a design with another motion and the size of its gears kept."""
    from ncgear.project.drive import Drive

    gears = design.gears
    if gears is not None:
        gears = gears.model_copy(update=dict(zip(SIZES, law.kept_size(design), strict=True)))
    return Drive(design.model_copy(update={"motion": motion, "gears": gears}))


def inertia_as_given(design: Design) -> TrainInertia:
    """The moments of inertia of a design's gears with its own law.

    Round gears are taken where the law cannot be made, and where it is for more or fewer pairs than are searched.
    """
    pairs = design.optimize.limits.stages if design.optimize else 1
    even = even_motion(pairs)
    if pairs != design.stages:
        return inertia_with(design, even)
    try:
        return inertia_with(design, design.motion)
    except DesignError:
        return inertia_with(design, even)


def with_driven_flywheel(design: Design, inertia_kg_mm2: float) -> Design:
    """The design with a flywheel in kg mm2 on its driven shaft; the design must give masses."""
    assert design.masses is not None
    masses = design.masses.model_copy(update={"driven_flywheel_kg_mm2": inertia_kg_mm2})
    return design.model_copy(update={"masses": masses})


def _size_of(design: Design, limits: Limits) -> task.GearSize | None:
    """The size of an external pair; raises WrongInput where the force between its teeth is limited but not known."""
    gears = design.gears
    prices = _prices(design.optimize or Optimize())
    names = ("tooth_force_n", "flank_load_n_mm", "center_distance_mm")
    limited = [name for name in ("teeth_hold", *names) if getattr(limits, name)]
    if limited or any(getattr(prices, name) for name in names):
        key = f"optimize.limits.{limited[0]}" if limited else "optimize.goal"
        if gears is None:
            problem = "given, but it needs the gears' size: give gears.teeth and gears.module_mm"
            raise WrongInput(problem, key=key)
        if gears.mesh == "internal":
            raise WrongInput("given, but it is computed of external pairs only; leave it out of a ring", key=key)
        if limits.stages > 1:
            raise WrongInput("given, but it is computed of one pair only; leave it out of two stages", key=key)
        sized = gears.teeth is not None and gears.module_mm is not None
        if not sized and (names[-1] in limited or prices.center_distance_mm):
            problem = "given, but gears.center_distance_mm says what it is; give gears.teeth and gears.module_mm"
            raise WrongInput(problem, key=key)
    if gears is None or gears.mesh == "internal":
        return None
    return task.GearSize(*law.kept_size(design), *map(radians, gears.rack.angles_deg))


def _prices(asked: Optimize) -> task.Prices:
    goal, weights = Goal(asked.goal), asked.weights
    if goal is not Goal.WEIGHTED or weights is None:
        return ALONE[goal]
    alike = {name.replace("_rad_s", "_mm_s"): 1.0 / value for name, value in weights if value is not None}
    peaks = {name for name in alike if hasattr(task.Prices, f"peak_{name}")}
    return task.Prices(**{f"peak_{name}" if name in peaks else name: price for name, price in alike.items()})


def wishes_of(design: Design) -> Wishes:
    """Goal and limits of a design; without the group ``optimize``, the defaults of its keys.

    Raises WrongInput for a limit that needs gears where the design has none, or that no curve can keep.
    """
    asked = design.optimize or Optimize()
    limits = asked.limits
    shared = limits.stages > 1
    tangent_rad = _tangent_rad(limits, design.gears)
    # The tighter of both limits.
    curvatures = [*_of_radius(limits, design.gears), *_of_undercut(limits, design.gears)]
    free = _Curvature(None, CurvatureWish.LEAST_RADIUS, 1.0)
    curvature = min(curvatures, default=free, key=lambda wish: wish.turns or 0.0)
    return Wishes(
        limits=task.Limits(
            ratio_min=limits.ratio_min,
            ratio_max=limits.ratio_max,
            peak_power_w=limits.peak_power_w,
            peak_acceleration_mm_s2=limits.peak_acceleration_mm_s2 or limits.peak_acceleration_rad_s2,
            peak_speed_mm_s=limits.peak_speed_mm_s or limits.peak_speed_rad_s,
            pressure_angle_rad=None if shared else tangent_rad,
            rack_angle_rad=radians(_rack_angle_deg(design.gears)),
            **{name: getattr(limits, name) for name in task.LOAD_LIMITS},
        ),
        goal=Goal(asked.goal),
        weights=_prices(asked) if asked.weights else None,
        peak_jerk_mm_s3=limits.peak_jerk_mm_s3 or limits.peak_jerk_rad_s3,
        acceleration_harmonics_mm_s2=limits.acceleration_harmonics_mm_s2 or limits.acceleration_harmonics_rad_s2,
        center_distance_mm=limits.center_distance_mm,
        driven_speed_rad_s=None if limits.driven_speed_rpm is None else limits.driven_speed_rpm * RAD_S_PER_RPM,
        convex=limits.convex,
        curvature_turns=curvature.turns,
        curvature_wish=curvature.wish,
        curvature_given=curvature.given,
        knots=asked.knots,
        two_stages=TwoStages(tangent_rad) if shared else None,
        motion=law.motion_wishes_of(design, mechanism_of(design.linkage), law.lobes_of(design).driving_period_rad),
    )


def _tangent_rad(limits: Limits, gears: Gears | None) -> float | None:
    """The greatest tangent angle of the pitch curves: the limit of the pressure angle less the rack's angle."""
    if limits.pressure_angle_deg is None:
        return None
    rack = _rack_angle_deg(gears)
    if not limits.pressure_angle_deg > rack:
        raise WrongInput(
            f"{limits.pressure_angle_deg:g} deg leaves nothing to the pitch curves: the rack alone has {rack:g} deg",
            key="optimize.limits.pressure_angle_deg",
        )
    return radians(limits.pressure_angle_deg - rack)


def _rack_angle_deg(gears: Gears | None) -> float:
    return gears.carrying_angle_deg if gears else RACK_ANGLE_DEG


class _Curvature(NamedTuple):
    """A limit of the curvature: ``turns`` is the curvature times the length rolled in one cycle.

    ``wish`` names the limit in the file, and ``given`` is its number there.
    """

    turns: float | None
    wish: CurvatureWish
    given: float


def _of_radius(limits: Limits, gears: Gears | None) -> Iterator[_Curvature]:
    if limits.least_radius_mm is None:
        return
    if gears is None or gears.teeth is None or gears.module_mm is None:
        raise WrongInput(
            "given, but a radius in mm needs the length of the pitch curves: give gears.teeth and gears.module_mm",
            key="optimize.limits.least_radius_mm",
        )
    driven_teeth = gears.teeth / gears.lobes.driving
    turns = driven_teeth * pi * gears.module_mm / limits.least_radius_mm
    if not turns > 2.0 * pi:
        largest = driven_teeth * gears.module_mm / 2.0
        raise WrongInput(
            f"{limits.least_radius_mm:g} mm given; under {shown_below(largest)} mm is right, which a circular "
            "driven gear has",
            key="optimize.limits.least_radius_mm",
        )
    yield _Curvature(turns, CurvatureWish.LEAST_RADIUS, limits.least_radius_mm)


def _of_undercut(limits: Limits, gears: Gears | None) -> Iterator[_Curvature]:
    """No tooth is undercut where k h < sin^2(alpha), with curvature k and the depth h of the rack's flank."""
    if not limits.free_of_undercut:
        return
    if gears is None or gears.teeth is None:
        raise WrongInput("true, but of how many teeth? give gears.teeth", key="optimize.limits.free_of_undercut")
    rack = gears.rack.in_mm(1.0)
    # The flanks with the angle that is undercut first.
    undercut = (
        sin(angle) ** 2
        * gears.teeth
        / gears.lobes.driving
        * pi
        / (rack.dedendum_mm - rack.root_radius_mm * (1.0 - sin(angle)))
        for angle in rack.angles_rad
    )
    turns = min(undercut)
    if not turns > 2.0 * pi:
        raise WrongInput(
            f"{gears.teeth} teeth are undercut even on a circle; over {gears.teeth * 2.0 * pi / turns:.4g} are right",
            key="optimize.limits.free_of_undercut",
        )
    yield _Curvature(turns, CurvatureWish.UNDERCUT, float(gears.teeth))


class SoughtMachine(ABC):
    """A design's machine and its wishes, with other mechanisms that have the same masses and the same speed.

    Every attribute may raise WrongInput for wishes that contradict each other or the design.
    """

    def __init__(self, design: Design) -> None:
        self.given = design

    @property
    def design(self) -> Design:
        """The design of the machine: the given design, where nothing of the machine is free."""
        return self.given

    @property
    @abstractmethod
    def task(self) -> Task:
        """The machine; all figures count its masses."""

    @cached_property
    def wishes(self) -> Wishes:
        """Goal and limits."""
        return wishes_of(self.given)

    @property
    def not_kept(self) -> str:
        """Motion that the design's own law prescribes but no wish asks for, in words; empty where there is none."""
        return "" if law.keeps_even_speed(self.design) else self.design.motion.prescribed

    @property
    def soft(self) -> bool:
        """Whether soft wishes count in the goal: they change the law, and the limit is for hard wishes only."""
        return any(not wish.hard for wish in self.wishes.motion)

    @property
    def sizing(self) -> PairsInSeries | None:
        """The law whose gears give the centre distance of the uniform crank's gears; None: their own size gives it."""
        return None

    @cached_property
    def uniform_figures(self) -> Figures:
        """Exact figures of a uniform crank on the same machine."""
        return figures(self.task, single(uniform_law(self.task.lobes)), self.sizing)

    @cached_property
    def given_figures(self) -> Figures | None:
        """Exact figures of the design's own law and gears at the same speed; None where that law cannot be made."""
        try:
            return figures(task_of(self.given, inertia_as_given(self.given)), law.law_of(self.given).train)
        except DesignError:
            return None


class GearsAsGiven(SoughtMachine):
    """The machine with its gears as given: laws under different caps are compared with the same masses."""

    @cached_property
    def task(self) -> Task:
        """The machine; an inertia that is left out is the inertia of the gear made for the design's own law."""
        return task_of(self.design, inertia_as_given(self.design))
