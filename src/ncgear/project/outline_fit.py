"""The nearest pair that can be made: a pitch curve near an outline, and trials of its teeth, one after another.

Other pairs are tried between a pair with sound exact teeth and a refused pair.  The nearest pair is also judged by its
written outlines.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import pi, radians
from typing import Any, Literal

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import Gears
from ncgear.design.keys.optimize import FollowedOutline, MateOutline
from ncgear.design.keys.pitch_shapes import FEWEST_POINTS, MOST_POINTS
from ncgear.design.laws.base import LawKeys
from ncgear.design.reading.design_file import parsed_mapping
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.outline.conditions import CurveLimits, Subject, conditions
from ncgear.optimum.outline.nearest import (
    LOOSE,
    Deviation,
    away_mm,
    coefficients_for,
    deviation,
    mate_deviation,
    nearest_curve,
    polar_angle,
)
from ncgear.optimum.outline.outline import Outline, outline_of
from ncgear.optimum.outline.programme import MateWanted, OutlineAim, missed
from ncgear.optimum.outline.rolled import Rolled, SplineBasis
from ncgear.pitch.shape import Gear
from ncgear.project import outline_trial
from ncgear.project.drive import Drive
from ncgear.project.finer import require_made

TRIALS, NEARER = 10, 3
"""Most pairs that are made until one is accepted, and how many more are tried between it and the last refused pair if
it came soon; else one more."""

WORTH = 0.005
"""Least share of the deviation that another pair must promise to save."""

NEXT_TEETH = (1.5, 2.0)
"""Numbers of teeth that are tried as well, as multiples of the wanted number."""

FEWEST_TEETH = 12
"""Least number of teeth that a module may lead to."""

BINDS, BINDS_WITHIN_PITCHES = 0.02, 1.5
"""Distance from its limit within which a condition binds, and distance in pitches from a place along the curve."""

OnTrial = Callable[[int, int], None]
"""Called with the numbers of pairs made and at most to be made."""


@dataclass(frozen=True)
class NextSize:
    """The result of another number of teeth; its teeth are not made."""

    teeth: int
    module_mm: float
    root_mean_square_mm: float
    greatest_mm: float
    mate_root_mean_square_mm: float | None = None
    mate_greatest_mm: float | None = None


@dataclass(frozen=True, eq=False)
class MateFit:
    """Distances of the mate from an outline of its own: distances in mm of the pair, places in mm of its drawing.

    ``scale`` is the size of the gears over the size of the drawing; ``bound_by`` is as in ``OutlineFit``.
    """

    outline: Outline
    deviation: Deviation
    points_mm: Array
    axis_mm: Array
    scale: float
    bound_by: tuple[Subject, ...]

    @property
    def size_mm(self) -> float:
        """Size of the outline, scaled to the pair."""
        return self.scale * self.outline.size_mm


@dataclass(frozen=True, eq=False)
class OutlineFit:
    """The nearest pair that can be made: the outline, the curve, and the drive of the fitted design.

    ``motion`` has the keys of the fitted law.  ``bound_by`` are the kinds of conditions that bind where the deviation
    is greatest, the most binding first; ``next_sizes`` are the results with more teeth.  ``mate`` is given where the
    mate follows an outline, too.
    """

    outline: Outline
    curve: Rolled
    deviation: Deviation
    drive: Drive
    motion: Mapping[str, Any]
    bound_by: tuple[Subject, ...]
    next_sizes: tuple[NextSize, ...]
    asked_gears: Gears
    mate: MateFit | None = None

    @property
    def points_mm(self) -> Array:
        """Points of the pitch curve in the drawing, counter-clockwise, shape (n, 2)."""
        return self.curve.points()[0]

    @property
    def mate_points_mm(self) -> Array:
        """Points of the mate's pitch curve about its axis, shape (n, 2); its first point faces the curve's first."""
        return self.curve.mate_points()

    @property
    def given_gear(self) -> Gear:
        """The gear whose pitch curve is drawn."""
        return outline_trial.given_gear(self.motion)

    @property
    def contact_ratio(self) -> float:
        """Contact ratio of the exact teeth, on the side where it is less."""
        return self.drive.designed_contact.contact_ratio

    @property
    def shortest_contact(self) -> float:
        """Shortest arc of contact of any pair of flanks, in pitches."""
        return self.drive.designed_contact.least_arc

    @property
    def length_by_size(self) -> float | None:
        """Length of the pitch curve from teeth and module over the length of the outline's hull; None if one is free.

        Where both are given, the curve cannot have the size of the outline.
        """
        gears = self.asked_gears
        if gears.teeth is None or gears.module_mm is None:
            return None
        return pi * gears.teeth * gears.module_mm / self.outline.hull_length_mm

    @property
    def pressure_angle_deg(self) -> float:
        """Greatest pressure angle of the driving flanks, including the rack's angle."""
        return self.drive.largest_pressure_angle_deg

    @property
    def greatest_at_rad(self) -> float:
        """Polar angle of the greatest deviation about the axis."""
        return polar_angle(self.curve, self.deviation.at_mm)


def fit(
    outline_mm: Array,
    *,
    teeth: int | None = None,
    module_mm: float | None = None,
    axis_mm: tuple[float, float] | None = None,
    mate_mm: Array | None = None,
    mate_weight: float = 0.5,
    criterion: Literal["root_mean_square", "greatest"] = "root_mean_square",
    pressure_angle_deg: float = 75.0,
    gears: Mapping[str, Any] | None = None,
    name: str = "outline",
) -> OutlineFit:
    """The nearest pair of gears that can be made to a closed outline, points of shape (n, 2) in mm in either direction.

    ``teeth`` or ``module_mm`` gives the size of the teeth.  ``axis_mm`` holds the axis in place.  ``mate_mm`` are
    points of an outline for the mate, seen from the same side, shape (k, 2); it is scaled to the best size.
    ``mate_weight`` is its share in the squared distances of both.  ``pressure_angle_deg`` is the greatest pressure
    angle, including the rack's angle.  ``criterion`` tells whether the root mean square of the distances or the
    greatest distance is minimised; ``gears`` has further keys of the section ``gears`` of a design file.

    Raises WrongInput for wrong values, and NoSuchMechanism where no pair near the outline can be made.
    """
    outline = outline_of(outline_mm, "outline_mm")
    mate = (
        {} if mate_mm is None else {"mate": {"points": _points(outline_of(mate_mm, "mate_mm")), "weight": mate_weight}}
    )
    axis = {} if axis_mm is None else {"axis_x_mm": axis_mm[0], "axis_y_mm": axis_mm[1]}
    sizes = {key: value for key, value in (("teeth", teeth), ("module_mm", module_mm)) if value is not None}
    data = {
        "name": name,
        "operation": {"speed_rpm": 60.0},
        "motion": {"law": "pitch_curve", "points": {**_points(outline), **axis}},
        "outline": {
            "axis": "free" if axis_mm is None else "fixed",
            "criterion": criterion,
            "pressure_angle_deg": pressure_angle_deg,
            **mate,
        },
        "gears": {"face_width_mm": max(outline.size_mm / 8.0, 1.0), **sizes, **(gears or {})},
    }
    return fitted(parsed_mapping(data).design)


def _points(outline: Outline) -> dict[str, Any]:
    corners = outline.corners if len(outline.corners) >= FEWEST_POINTS else outline.with_middles
    x, y = (corners if len(corners) <= MOST_POINTS else outline.even(MOST_POINTS)).T.tolist()
    return {"x_mm": x, "y_mm": y, "tolerance_mm": 1.0}


def fitted(design: Design, on_trial: OnTrial = lambda done, most: None) -> OutlineFit:
    """The nearest pair that can be made for a design whose law draws a pitch curve.

    Raises WrongInput for a design without outline or size, or with several lobes, and for a fixed axis outside;
    NoSuchMechanism where no pair near the outline can be made.
    """
    gears = outline_trial.gears_of(design)
    asked = design.outline
    outline, axis = _outline_and_axis(design.motion, asked is not None and asked.axis == "fixed", "outline.axis")
    wanted = OutlineAim(asked is not None and asked.criterion == "greatest", axis is not None, mate=_mate_wanted(asked))
    limits = CurveLimits()
    if asked is not None:
        limits = CurveLimits(steepest_rad=_steepest_rad(asked.pressure_angle_deg, gears))
    search = _Search(design, outline, wanted, axis, limits)
    start, teeth = None, gears.teeth
    if teeth is None:
        start = search.with_module()
        teeth = start.teeth
    if gears.module_mm is not None and design.motion.gives_center_distance:
        search = replace(search, wanted=replace(wanted, module_mm=gears.module_mm))
    best = search.best(teeth, start, on_trial)
    curve, away = best.curve, deviation(outline, best.curve)
    sizes = _next_sizes(outline, best, replace(wanted, module_mm=None))
    there = polar_angle(curve, away.toward_mm if away.of_outline else away.at_mm)
    bound_by = _binding(best, there)
    mate = _mate_fit(best, wanted.mate)
    return OutlineFit(outline, curve, away, best.drive, best.motion, bound_by, sizes, gears, mate)


def has_outline(design: Design) -> bool:
    """Whether a design draws an outline that a fit can follow."""
    try:
        _outline_and_axis(design.motion, fixed=False, key="")
    except (WrongInput, NoSuchMechanism):
        return False
    return True


def _outline_and_axis(drawn: LawKeys | MateOutline, fixed: bool, key: str) -> tuple[Outline, Array | None]:
    """The outline, and its axis if that is fixed; raises WrongInput for an axis outside."""
    points, axis, shape = drawn.outline_mm()
    outline = outline_of(points, shape)
    if fixed and not outline.holds(axis):
        raise WrongInput(
            f"the axis at ({axis[0]:g}, {axis[1]:g}) mm is outside the outline; a place inside is right, or "
            f"{key}: free",
            key=shape,
        )
    return outline, axis if fixed else None


def _mate_wanted(asked: FollowedOutline | None) -> MateWanted | None:
    if asked is None or asked.mate is None:
        return None
    outline, axis = _outline_and_axis(asked.mate, asked.mate.axis == "fixed", "outline.mate.axis")
    return MateWanted(outline, asked.mate.weight, axis, asked.mate.size == "fixed")


def _mate_fit(made: outline_trial.Made, wanted: MateWanted | None) -> MateFit | None:
    curve, place = made.curve, made.curve.mate_place
    if wanted is None or place is None:
        return None
    away, points = mate_deviation(wanted.outline, curve), curve.mate_in_drawing()[0] / place.scale
    nearest = np.argmin(np.hypot(*(points - np.array(away.toward_mm if away.of_outline else away.at_mm)).T))
    bound_by = _binding(made, float(curve.basis.phi_rad[nearest]))
    return MateFit(wanted.outline, away, points, place.axis_mm / place.scale, place.scale, bound_by)


def _steepest_rad(pressure_angle_deg: float, gears: Gears) -> float:
    """The greatest angle of the pitch curve; raises WrongInput where the rack's angle leaves none."""
    left = pressure_angle_deg - gears.carrying_angle_deg
    if left <= 0.0:
        raise WrongInput(
            f"{pressure_angle_deg:g} deg given, of which the rack has {gears.carrying_angle_deg:g}; more is right",
            key="outline.pressure_angle_deg",
        )
    return radians(left)


@dataclass(frozen=True, eq=False)
class _Search:
    """The task: the design, its outline, and the axis if it is fixed."""

    design: Design
    outline: Outline
    wanted: OutlineAim
    axis_mm: Array | None
    limits: CurveLimits

    def with_module(self) -> Rolled:
        """A near curve for the whole number of teeth that comes nearest to the design's module."""
        gears = outline_trial.gears_of(self.design)
        assert gears.module_mm is not None
        pitch = pi * gears.module_mm
        about = max(round(self.outline.hull_length_mm / pitch), FEWEST_TEETH)
        free = nearest_curve(self.outline, about, self.limits, self.wanted, self.axis_mm)
        return _with_teeth(free, max(round(free.length_mm / pitch), FEWEST_TEETH))

    def best(self, teeth: int, start: Rolled | None, on_trial: OnTrial) -> outline_trial.Made:
        """The nearest of the pairs that were made; raises NoSuchMechanism where all pairs are refused."""
        limits, curve, left = self.limits, start, TRIALS
        good = list[outline_trial.Made]()
        refused, written_refused = None, False
        for trial in range(TRIALS + NEARER):
            on_trial(trial, TRIALS + NEARER)
            curve = nearest_curve(self.outline, teeth, limits, self.wanted, self.axis_mm, curve)
            made = outline_trial.made_pair(self.design, curve, limits)
            left -= 1
            if made.refusal is not None:
                refused = made
            elif not good:
                good, left = [made], NEARER if trial < outline_trial.STUBBORN else 1
            elif self._away_mm(made) < self._away_mm(good[-1]):
                good.append(made)
            near = good and refused is not None and self._away_mm(good[-1]) < (1 + WORTH) * self._away_mm(refused)
            if near or left == 0:
                # Written outlines hardly ever refuse sound exact teeth, and take as long as these.
                while good:
                    made = outline_trial.judged(good.pop(), lambda trial: require_made(trial.drive))
                    if made.refusal is None:
                        return made
                    refused = made
                # Once only where they are too short, then everywhere.
                limits = outline_trial.drawn_in(made, trial if written_refused else outline_trial.STUBBORN - 1)
                left, written_refused = TRIALS + NEARER - 1 - trial, True
            else:
                limits = outline_trial.between(good[-1], refused) if good else outline_trial.drawn_in(made, trial)
        assert refused is not None
        assert refused.refusal is not None
        raise NoSuchMechanism(
            f"no pair near the outline can be made with {teeth} teeth{outline_trial.most_lacking(refused)}; more teeth "
            f"of a smaller module, or a rounder outline there, are right; at last: {refused.refusal.problem}",
            key=refused.refusal.key,
        )

    def _away_mm(self, made: outline_trial.Made) -> float:
        return away_mm(self.outline, made.curve, self.wanted)


def _binding(made: outline_trial.Made, there: float) -> tuple[Subject, ...]:
    """The conditions that bind beside a polar angle of the curve, the most binding first."""
    curve = made.curve
    at = np.interp([there], curve.phi_rad, curve.arc_mm, period=2.0 * pi)
    near = curve.apart_mm(at)[:, 0] < BINDS_WITHIN_PITCHES * curve.length_mm / curve.teeth
    values: dict[Subject, float] = {}
    for condition in conditions(curve, made.limits):
        values[condition.kind] = max(values.get(condition.kind, -np.inf), float(np.max(condition.value[near])))
    return tuple(sorted((kind for kind, value in values.items() if value > -BINDS), key=lambda kind: -values[kind]))


def _with_teeth(curve: Rolled, teeth: int) -> Rolled:
    basis = SplineBasis(coefficients_for(teeth))
    phi = 2.0 * pi * np.arange(basis.count) / basis.count
    radius = basis.through(curve.basis.at(phi) @ curve.coefficients)
    return Rolled(basis, radius, curve.axis_mm, curve.center_distance_mm, teeth, curve.mate_place)


def _next_sizes(outline: Outline, made: outline_trial.Made, wanted: OutlineAim) -> tuple[NextSize, ...]:
    """The results with more teeth of a smaller module, from the curve that was found; none whose conditions fail."""
    sizes = list[NextSize]()
    share = np.broadcast_to(made.limits.share, made.curve.arc_mm.shape)
    for times in NEXT_TEETH:
        start = _with_teeth(made.curve, round(times * made.curve.teeth))
        kept = np.interp(start.phi_rad, made.curve.phi_rad, share, period=2.0 * pi)
        limits = replace(made.limits, share=kept)
        try:
            found = nearest_curve(outline, start.teeth, limits, wanted, start=start)
        except NoSuchMechanism:
            continue
        if missed(found, limits, wanted) > LOOSE:
            continue
        away = deviation(outline, found)
        size = NextSize(found.teeth, found.module_mm, away.root_mean_square_mm, away.greatest_mm)
        if wanted.mate is not None:
            other = mate_deviation(wanted.mate.outline, found)
            size = replace(size, mate_root_mean_square_mm=other.root_mean_square_mm, mate_greatest_mm=other.greatest_mm)
        sizes.append(size)
    return tuple(sizes)
