"""The nearest pair that can be made: a pitch curve near an outline, its teeth made, and limits set by them in turn.

Conditions on curvature only tell about where teeth can stand.  So the teeth of each curve are made, and where flanks
touch over too little of a pitch the limits of the places nearby are drawn in; where there is room they are eased.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.pitch_shapes import FEWEST_POINTS, MOST_POINTS
from ncgear.design.reading.design_file import parsed_mapping
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.outline.conditions import Kind, Limits, conditions
from ncgear.optimum.outline.nearest import Deviation, coefficients_for, deviation, nearest_curve, polar_angle
from ncgear.optimum.outline.outline import Outline, outline_of
from ncgear.optimum.outline.programme import Wanted
from ncgear.optimum.outline.rolled import Basis, Rolled, rays
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive

TRIALS, AFTER_MADE = 7, 3
"""Curves whose teeth are made at most, and from how many on the first pair that can be made ends the search."""

ENOUGH, MORE, ROOMY = 1.12, 0.04, 1.2
"""Arc of contact in pitches under which limits are drawn in, by how much it rises with each pair that cannot be made,
and arc over which limits are eased."""

DRAWN_IN, EASED, MOST_EASED = 0.8, 0.3, 1.06
"""Share of the missing arc by which limits are drawn in, of the free one by which they are eased, and the most of it."""

BESIDE_PITCHES = 2.0
"""How far from a pair of flanks its arc of contact sets the limits, in pitches."""

NO_TEETH = 0.9
"""By what limits are drawn in everywhere where teeth cannot be made at all."""

LEAST_SHARE, MOST_SHARE = 0.25, 1.3
"""Range of the shares of the limits."""

NEXT_TEETH = (1.5, 2.0)
"""Numbers of teeth that are tried beside the wanted one, by it."""

BINDS = 0.02
"""By how much a condition may be missed or kept to bind there, and over how many pitches beside a place it is sought."""


@dataclass(frozen=True)
class NextSize:
    """What another number of teeth would cost and bring; its teeth are not made."""

    teeth: int
    module_mm: float
    root_mean_square_mm: float
    greatest_mm: float


@dataclass(frozen=True, eq=False)
class OutlineFit:
    """The nearest pair that can be made: the outline, the curve, and the drive of the fitted design.

    ``bound_by`` are the kinds of conditions that bind where the deviation is greatest, the most binding first.
    ``next_sizes`` are those with more teeth, found without making their teeth.  ``motion`` has the keys of the fitted
    law; ``drive`` is that of the design with them.
    """

    outline: Outline
    curve: Rolled
    deviation: Deviation
    drive: Drive
    motion: Mapping[str, Any]
    contact_ratio: float
    bound_by: tuple[Kind, ...]
    next_sizes: tuple[NextSize, ...]

    @property
    def points_mm(self) -> Array:
        """Points of the pitch curve in the drawing, counter-clockwise, shape (n, 2)."""
        return self.curve.points()[0]

    @property
    def mate_points_mm(self) -> Array:
        """Points of the mate's pitch curve in its own frame, shape (n, 2): at the first point +x faces the given gear."""
        return self.curve.mate_points()

    @property
    def given_gear(self) -> Gear:
        """The gear whose pitch curve is drawn."""
        return Gear(self.motion.get("gear", Gear.DRIVING.value))

    @property
    def greatest_at_rad(self) -> float:
        """Polar angle of the greatest deviation about the axis."""
        return polar_angle(self.curve, self.deviation.at_mm)


@dataclass(frozen=True, eq=False)
class _Made:
    """The drive of a curve; ``places_mm`` are arc lengths of the curve, with the arcs of contact of flanks there."""

    drive: Drive
    motion: Mapping[str, Any]
    refusal: NoSuchMechanism | None
    places_mm: Array
    arcs: Array


def fitted(design: Design, on_trial: Callable[[int, int], None] = lambda done, most: None) -> OutlineFit:
    """The nearest pair that can be made for a design whose law draws a pitch curve.

    Raises WrongInput for a design that has no outline, no size, or several lobes; NoSuchMechanism where no pair near
    the outline can be made.  ``on_trial`` is called with the numbers of pairs made and at most to be made.
    """
    asked, gears = design.outline, design.gears
    if not design.motion.gives_outline:
        raise WrongInput(f"{design.motion.law} given; pitch_curve with an outline is right", key="motion.law")
    if gears is None:
        raise WrongInput("missing; a fit needs gears.teeth or gears.module_mm", key="gears")
    if (gears.lobes.driving, gears.lobes.driven) != (1, 1):
        raise WrongInput("several lobes given; a fit is offered for one lobe each: leave it out", key="gears.lobes")
    points, axis, key = design.motion.outline_mm()
    outline = outline_of(points, key)
    fixed = asked is not None and asked.axis == "fixed"
    if fixed and not outline.holds(axis):
        raise WrongInput(
            f"the axis at ({axis[0]:g}, {axis[1]:g}) mm is outside the outline; move it inside, or give outline.axis: free",
            key=key,
        )
    wanted = Wanted(asked is not None and asked.criterion == "greatest", fixed)
    start, curve = (axis if fixed else None), None
    teeth = gears.teeth
    if teeth is None:
        if gears.module_mm is None or not design.motion.gives_center_distance:
            raise WrongInput("missing; a fit needs the number of teeth", key="gears.teeth")
        about = max(round(outline.hull_length_mm / (pi * gears.module_mm)), FEWEST_TEETH)
        free = nearest_curve(outline, about, Limits(), wanted, start)
        teeth = max(round(free.length_mm / (pi * gears.module_mm)), FEWEST_TEETH)
        curve = _with_teeth(free, teeth)
    if gears.module_mm is not None and design.motion.gives_center_distance:
        wanted = replace(wanted, module_mm=gears.module_mm)
    limits, best, failed = Limits(), None, 0
    for trial in range(TRIALS):
        on_trial(trial, TRIALS)
        curve = nearest_curve(outline, teeth, limits, wanted, start, curve)
        made = _made(design, curve)
        if made.refusal is None:
            found = deviation(outline, curve)
            value = found.greatest_mm if wanted.greatest else found.root_mean_square_mm
            if best is None or value < best[0]:
                best = value, curve, found, made, limits
            if trial + 1 >= AFTER_MADE:
                break
        else:
            last, failed = made.refusal, failed + 1
            if best is not None and trial + 1 >= AFTER_MADE + 1:
                break
        limits = _limits_after(curve, limits, made, ENOUGH + MORE * failed)
    if best is None:
        raise NoSuchMechanism(
            f"no pair near the outline can be made with {teeth} teeth; at last: {last.problem}", key=last.key
        )
    _, curve, found, made, limits = best
    contact = made.drive.designed_contact.contact_ratio
    bound = _binding(curve, limits, found)
    return OutlineFit(
        outline, curve, found, made.drive, made.motion, contact, bound, _next_sizes(outline, curve, limits, wanted)
    )


FEWEST_TEETH = 12
"""Fewest teeth that a module is turned into."""


def control_points(curve: Rolled) -> Array:
    """Control points of a closed uniform quintic B-spline in the plane that is the curve to under 0.1 um."""
    count = 2 * curve.basis.count
    phi = 2.0 * pi * np.arange(count) / count
    radius = curve.basis.at(phi) @ curve.coefficients
    points = curve.axis_mm + radius[:, None] * rays(phi)[0]
    return Basis(count).through(points)


def _made(design: Design, curve: Rolled) -> _Made:
    """The teeth of a curve and how long its flanks touch."""
    motion = design.motion.along(control_points(curve), curve.axis_mm)
    gears = design.gears
    assert gears is not None
    keys = type(design.motion).model_validate({key: value for key, value in motion.items() if key[:5] != "phase"})
    changed = design.model_copy(
        update={
            "motion": keys,
            "masses": None,
            "gears": gears.model_copy(
                update={
                    "teeth": curve.teeth,
                    "module_mm": gears.module_mm
                    if gears.module_mm and not design.motion.gives_center_distance
                    else None,
                }
            ),
        }
    )
    drive = Drive(changed)
    gear = Gear(motion.get("gear", Gear.DRIVING.value))
    try:
        flanks = drive.teeth.of(gear).flanks
        sides = drive.free_contact.pushing, drive.free_contact.back
    except NoSuchMechanism as refusal:
        return _Made(drive, motion, refusal, np.empty(0), np.empty(0))
    crossing = [flanks.crossing_mm[getattr(side.meetings, gear.value)] for side in sides]
    at = flanks.curve.at_length(np.concatenate(crossing)).position
    polar = np.mod(np.arctan2(at[:, 1], at[:, 0]), 2.0 * pi)
    places = np.interp(polar, curve.phi_rad, curve.arc_mm, period=2.0 * pi)
    arcs = np.concatenate([side.pairs.arcs for side in sides])
    try:
        drive.designed_contact
    except NoSuchMechanism as refusal:
        return _Made(drive, motion, refusal, places, arcs)
    return _Made(drive, motion, None, places, arcs)


def _limits_after(curve: Rolled, limits: Limits, made: _Made, enough: float) -> Limits:
    """Limits drawn in where flanks touch too shortly, and eased where they have room."""
    share = np.broadcast_to(limits.share, curve.arc_mm.shape)
    if not made.arcs.size:
        return replace(limits, share=np.maximum(share * NO_TEETH, LEAST_SHARE))
    apart = curve.apart_mm(made.places_mm) / (curve.length_mm / curve.teeth)
    near = np.maximum(1.0 - apart / BESIDE_PITCHES, 0.0)
    missing = np.max(near * np.clip(enough - made.arcs, 0.0, 0.3), axis=1)
    least = np.min(np.where(apart < BESIDE_PITCHES, made.arcs, np.inf), axis=1)
    eased = np.where(least > enough + ROOMY - ENOUGH, np.minimum(1.0 + EASED * (least - ROOMY), MOST_EASED), 1.0)
    return replace(limits, share=np.clip(share * (1.0 - DRAWN_IN * missing) * eased, LEAST_SHARE, MOST_SHARE))


def _binding(curve: Rolled, limits: Limits, found: Deviation) -> tuple[Kind, ...]:
    """The conditions that bind within a pitch of where the deviation is greatest, the most binding first."""
    there = polar_angle(curve, found.toward_mm if found.of_outline else found.at_mm)
    at = np.interp(there, curve.phi_rad, curve.arc_mm, period=2.0 * pi)
    near = curve.apart_mm(np.array([at]))[:, 0] < 1.5 * curve.length_mm / curve.teeth
    values: dict[Kind, float] = {}
    for one in conditions(curve, limits):
        values[one.kind] = max(values.get(one.kind, -np.inf), float(np.max(one.value[near])))
    return tuple(sorted((kind for kind, value in values.items() if value > -BINDS), key=lambda kind: -values[kind]))


def _with_teeth(curve: Rolled, teeth: int) -> Rolled:
    """The same curve for another number of teeth."""
    basis = Basis(coefficients_for(teeth))
    phi = 2.0 * pi * np.arange(basis.count) / basis.count
    radius = basis.through(curve.basis.at(phi) @ curve.coefficients)
    return Rolled(basis, radius, curve.axis_mm, curve.center_distance_mm, teeth)


def _next_sizes(outline: Outline, curve: Rolled, limits: Limits, wanted: Wanted) -> tuple[NextSize, ...]:
    """The same with more teeth of a smaller module, from the curve that was found."""
    sizes = list[NextSize]()
    share = np.broadcast_to(limits.share, curve.arc_mm.shape)
    for times in NEXT_TEETH:
        teeth = round(times * curve.teeth)
        start = _with_teeth(curve, teeth)
        phi = start.phi_rad
        kept = np.interp(phi, 2.0 * pi * np.arange(share.size) / share.size, share, period=2.0 * pi)
        free = replace(wanted, module_mm=None)
        try:
            found = nearest_curve(outline, teeth, replace(limits, share=kept), free, start=start)
        except NoSuchMechanism:
            continue
        away = deviation(outline, found)
        sizes.append(NextSize(teeth, found.module_mm, away.root_mean_square_mm, away.greatest_mm))
    return tuple(sizes)


def fit(
    outline_mm: Array,
    *,
    teeth: int | None = None,
    module_mm: float | None = None,
    axis_mm: tuple[float, float] | None = None,
    criterion: str = "root_mean_square",
    gears: Mapping[str, Any] | None = None,
    name: str = "outline",
) -> OutlineFit:
    """The nearest pair of gears that can be made to a closed outline, points of shape (n, 2) in mm in either sense.

    The size of its teeth is given by ``teeth`` or ``module_mm``.  The axis is held at ``axis_mm`` where it is given.
    ``criterion`` is root_mean_square or greatest, ``gears`` has further keys of the section ``gears`` of a design file.

    Raises WrongInput for what is wrong, and NoSuchMechanism where no pair near the outline can be made.
    """
    outline = outline_of(outline_mm, "outline_mm")
    corners = outline.corners if len(outline.corners) >= FEWEST_POINTS else outline.with_middles
    if len(corners) > MOST_POINTS:
        corners = outline.even(MOST_POINTS)
    x, y = corners.T.tolist()
    axis = {} if axis_mm is None else {"axis_x_mm": axis_mm[0], "axis_y_mm": axis_mm[1]}
    sizes = {key: value for key, value in (("teeth", teeth), ("module_mm", module_mm)) if value is not None}
    data = {
        "name": name,
        "operation": {"speed_rpm": 60.0},
        "motion": {"law": "pitch_curve", "points": {"x_mm": x, "y_mm": y, "tolerance_mm": 1.0, **axis}},
        "outline": {"axis": "free" if axis_mm is None else "fixed", "criterion": criterion},
        "gears": {"face_width_mm": max(outline.size_mm / 8.0, 1.0), **sizes, **(gears or {})},
    }
    return fitted(parsed_mapping(data).design)
