"""From keys to values: the goal and limits of an optimised law, and the machine that the law is made for."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi, radians, sin
from typing import NamedTuple

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import Gears
from ncgear.design.keys.optimize import Limits, Optimize
from ncgear.design.mechanisms import mechanism_of
from ncgear.errors import WrongInput
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.optimum import task
from ncgear.optimum.certified.limit import Weights
from ncgear.optimum.makeable.wishes import CurvatureWish, Goal, TwoStages, Wishes
from ncgear.project.law import lobes_of, resistance_of
from ncgear.project.tooth_form import rack_of

RACK_ANGLE_DEG = 20.0
"""Pressure angle of the rack where a design has no gears; it is the one of ISO 53."""


def task_of(design: Design) -> task.Task:
    """The machine: mechanism, resistance, speed and lobes."""
    speed = design.operation.speed_rpm * RAD_S_PER_RPM
    return task.Task(mechanism_of(design.linkage), resistance_of(design), speed, lobes_of(design))


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
    curvature = min(curvatures, default=free, key=lambda one: one.turns or 0.0)
    weights = asked.weights
    return Wishes(
        limits=task.Limits(
            ratio_min=limits.ratio_min,
            ratio_max=limits.ratio_max,
            peak_power_w=limits.peak_power_w,
            peak_acceleration_mm_s2=limits.peak_acceleration_mm_s2,
            working_rad=limits.working_angle,
            pressure_angle_rad=None if shared else tangent_rad,
            rack_angle_rad=radians(_rack_angle_deg(design.gears)),
            mass_kg=design.masses.slider_kg if design.masses else 0.0,
        ),
        goal=Goal(asked.goal),
        weights=Weights(1.0 / weights.acceleration_mm_s2, 1.0 / weights.power_w) if weights else None,
        peak_jerk_mm_s3=limits.peak_jerk_mm_s3,
        driven_speed_rad_s=None if limits.driven_speed_rpm is None else limits.driven_speed_rpm * RAD_S_PER_RPM,
        convex=limits.convex,
        curvature_turns=curvature.turns,
        curvature_wish=curvature.wish,
        curvature_given=curvature.given,
        harmonics=asked.harmonics,
        two_stages=TwoStages(tangent_rad) if shared else None,
    )


def _tangent_rad(limits: Limits, gears: Gears | None) -> float | None:
    """The greatest tangent angle of the pitch curves: the limit of the pressure angle less the angle of the rack."""
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
    return gears.rack.pressure_angle_deg if gears else RACK_ANGLE_DEG


class _Curvature(NamedTuple):
    """A limit of the curvature: ``turns`` is the curvature times the length rolled in one cycle.

    ``wish`` says which limit of the file it comes from, and ``given`` is the number in the file.
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
            f"{limits.least_radius_mm:g} mm is what a circular driven gear has at most: under {largest:g} mm is right",
            key="optimize.limits.least_radius_mm",
        )
    yield _Curvature(turns, CurvatureWish.LEAST_RADIUS, limits.least_radius_mm)


def _of_undercut(limits: Limits, gears: Gears | None) -> Iterator[_Curvature]:
    """No tooth is undercut where k h < sin^2(alpha), with curvature k and the depth h of the rack's flank."""
    if not limits.free_of_undercut:
        return
    if gears is None or gears.teeth is None:
        raise WrongInput("true, but of how many teeth? give gears.teeth", key="optimize.limits.free_of_undercut")
    rack = rack_of(gears, 1.0)
    turns = sin(rack.pressure_angle_rad) ** 2 * gears.teeth / gears.lobes.driving * pi / rack.flank_depth_mm
    if not turns > 2.0 * pi:
        raise WrongInput(
            f"{gears.teeth} teeth are undercut even on a circle; more teeth are needed",
            key="optimize.limits.free_of_undercut",
        )
    yield _Curvature(turns, CurvatureWish.UNDERCUT, float(gears.teeth))
