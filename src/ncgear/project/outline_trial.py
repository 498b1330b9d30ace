"""A trial pair of gears near an outline: its teeth, the places without contact, and the limits of the next pair.

Conditions on curvature only estimate where teeth can stand.  Where the contact of the made teeth is too short, the
limits of places nearby are tightened.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import partial
from math import pi
from typing import Any

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import Gears
from ncgear.errors import NoSuchMechanism, RefusedAt, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.optimum.outline.conditions import CurveLimits
from ncgear.optimum.outline.rolled import FINER, Rolled, SplineBasis, rays
from ncgear.pitch.curve import CurvePoints
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive

DRAWN_IN, MORE, MOST_DRAWN_IN = 0.05, 0.03, 0.3
"""Share by which limits are tightened where contact breaks off, on top of the length of the gap in pitches; its growth
with each refusal; and the most that limits are tightened."""

ROOMY, EASED = 1.25, 1.05
"""Arc of contact in pitches of all flanks near a place above which its limits are eased, and the factor of easing."""

BESIDE_PITCHES = 2.0
"""Distance in pitches from a pair of flanks over which its contact sets the limits."""

CLASH, SHORT = 0.15, 1.1
"""Lack of contact in pitches that counts for teeth that run into each other, and the arc of contact below which flanks
count as those that have no contact in written outlines."""

NO_TEETH = 0.9
"""Factor on all limits where teeth cannot be made at all."""

STUBBORN, LAST, FEW_LACKING = 3, 6, 8
"""Numbers of refusals after which slopes and room are tightened too: where teeth run into each other or contact is
short at many places, and where it is short at few.  More than ``FEW_LACKING`` places are many."""

ROUNDER, ROOMIER, MOST_ROOM = 0.85, 0.05, 0.35
"""Factor on the slopes, increase of the room, and its maximum."""

LEAST_SHARE, MOST_SHARE = 0.25, 1.3
"""Range of the shares of the limits."""


@dataclass(frozen=True, eq=False)
class Made:
    """A curve with the drive of its teeth, and their refusal if any.

    ``meetings_mm`` are arc lengths of the curve at which flanks meet, with their arcs of contact in pitches.
    ``lacking`` has rows of an arc length and of the missing contact there in pitches.
    """

    curve: Rolled
    limits: CurveLimits
    drive: Drive
    motion: Mapping[str, Any]
    refusal: NoSuchMechanism | None = None
    meetings_mm: Array = field(default_factory=lambda: np.empty(0))
    arcs: Array = field(default_factory=lambda: np.empty(0))
    lacking: Array = field(default_factory=lambda: np.empty((0, 2)))


def given_gear(motion: Mapping[str, Any]) -> Gear:
    """The gear whose pitch curve the keys of a law draw."""
    return Gear(motion.get("gear", Gear.DRIVING.value))


def gears_of(design: Design) -> Gears:
    """The design's gears; raises WrongInput for a design that cannot be fitted."""
    gears = design.gears
    if not design.motion.gives_outline:
        raise WrongInput(f"{design.motion.law} given; pitch_curve, which draws an outline, is right", key="motion.law")
    if gears is None:
        raise WrongInput("missing; a fit needs gears.teeth or gears.module_mm", key="gears")
    if gears.mesh == "internal":
        raise WrongInput("internal given; a fit is offered for gears side by side: leave it out", key="gears.mesh")
    if (gears.lobes.driving, gears.lobes.driven) != (1, 1):
        raise WrongInput("several lobes given; a fit is offered for one lobe each: leave it out", key="gears.lobes")
    if gears.teeth is None and (gears.module_mm is None or not design.motion.gives_center_distance):
        raise WrongInput("missing; a fit needs the number of teeth", key="gears.teeth")
    return gears


def control_points(curve: Rolled) -> Array:
    """Control points, shape (n, 2), of a closed uniform quintic B-spline in the plane, within 0.1 um of the curve."""
    count = 2 * curve.basis.count
    phi = 2.0 * pi * np.arange(count) / count
    radius = curve.basis.at(phi) @ curve.coefficients
    return SplineBasis(count).through(curve.axis_mm + radius[:, None] * rays(phi)[0])


def made_pair(design: Design, curve: Rolled, limits: CurveLimits) -> Made:
    """The teeth of a curve, and the lengths of their contact."""
    gears, motion = gears_of(design), design.motion.along(control_points(curve), curve.axis_mm)
    # The curve sets the size and the number of teeth; a phase would only turn it.
    size = {"teeth": curve.teeth} | ({"module_mm": None} if design.motion.gives_center_distance else {})
    keys = type(design.motion).model_validate({key: value for key, value in motion.items() if key[:5] != "phase"})
    changes = {"motion": keys, "masses": None, "gears": gears.model_copy(update=size)}
    drive = Drive(design.model_copy(update=changes))
    return judged(Made(curve, limits, drive, motion), partial(_with_contact, gears=gears))


def judged(made: Made, judge: Callable[[Made], Made | None]) -> Made:
    """The pair after a judge, or with the error that the judge raises and the places without contact."""
    found = made
    try:
        found = judge(made) or made
        found.drive.require_sound_teeth()
    except RefusedAt as refusal:
        pitch = made.drive.pitch.of(given_gear(made.motion))
        at = _places(made.curve, pitch.at_angle(np.array([refusal.phi1_rad])))
        rows = np.column_stack([at, np.full(1, CLASH)])
        return replace(found, refusal=refusal, lacking=np.vstack([found.lacking, rows]))
    except NoSuchMechanism as refusal:
        short = found.arcs < SHORT
        rows = np.column_stack([found.meetings_mm[short], SHORT - found.arcs[short]])
        return replace(found, refusal=refusal, lacking=np.vstack([found.lacking, rows]))
    return found


def _places(curve: Rolled, at: CurvePoints) -> Array:
    polar = np.mod(np.arctan2(at.position[:, 1], at.position[:, 0]), 2.0 * pi)
    return np.interp(polar, curve.phi_rad, curve.arc_mm, period=2.0 * pi)


def _with_contact(made: Made, gears: Gears) -> Made:
    gear = made.drive.teeth.of(given_gear(made.motion))
    contact, placement = made.drive.free_contact, made.drive.free_contact.placement
    sides, own = (contact.pushing, contact.back), gear.flanks.curve.gear.value
    crossing = np.concatenate([gear.flanks.crossing_mm[getattr(side.meetings, own)] for side in sides])
    places = _places(made.curve, gear.flanks.curve.at_length(crossing))
    phi1 = gear.flanks.curve.driving_angle(crossing)
    arcs = np.concatenate([side.pairs.arcs for side in sides])
    least = max(gears.least_contact_ratio, 1.0)
    lacking = [(place, least - arc) for place, arc in zip(places, arcs, strict=True) if arc < least]
    judged = sides if gears.drives == "both_ways" else sides[:1]
    for low, high in np.concatenate([side.pairs.gaps for side in judged]):
        middle = placement.phi1_rad[round((low + high) / 2.0) % placement.count]
        # The flanks that cross nearest to the places without contact.
        lacking.append((places[np.argmax(np.cos(phi1 - middle))], (high - low) / placement.per_tooth))
    return replace(made, meetings_mm=places, arcs=arcs, lacking=np.array(lacking).reshape(-1, 2))


def drawn_in(made: Made, refusals: int) -> CurveLimits:
    """Limits tightened where contact is too short and, the first time, eased where all flanks nearby touch for long."""
    curve, limits = made.curve, made.limits
    short = made.refusal is not None and made.refusal.key == "gears.least_contact_ratio"
    many = not short or len(made.lacking) > FEW_LACKING
    if refusals >= (STUBBORN if many else LAST):
        # The fault is not at a single place: a rounder curve everywhere has gentler slopes and more room.
        rounder, room = limits.steepest_rad * ROUNDER, min(limits.nearest + ROOMIER, MOST_ROOM)
        limits = replace(limits, steepest_rad=rounder, nearest=room)
    share = np.broadcast_to(limits.share, curve.arc_mm.shape)
    if not made.lacking.size:
        return replace(limits, share=np.maximum(share * NO_TEETH, LEAST_SHARE))
    reach = BESIDE_PITCHES * curve.length_mm / curve.teeth
    near = _beside(curve, made.lacking[:, 0])
    less = np.max(near * np.minimum(DRAWN_IN + MORE * refusals + made.lacking[:, 1], MOST_DRAWN_IN), axis=1)
    shortest = np.min(np.where(curve.apart_mm(made.meetings_mm) < reach, made.arcs, np.inf), axis=1, initial=np.inf)
    eased = np.where((refusals == 0) & (less == 0.0) & (shortest > ROOMY), EASED, 1.0)
    return replace(limits, share=np.clip(share * (1.0 - less) * eased, LEAST_SHARE, MOST_SHARE))


def most_lacking(made: Made) -> str:
    """The place in the drawing where a refused pair lacks most contact, in words; else that of the sharpest hollow."""
    points, _ = made.curve.points()
    own, mate = (curvature * made.curve.module_mm for curvature in made.curve.curvature)
    bent, said = np.minimum(own, mate), "their sharpest place is"
    nearest = int(np.argmin(bent))
    if made.lacking.size:
        place, said = made.lacking[np.argmax(made.lacking[:, 1]), 0], "their contact fails"
        nearest = int(np.argmin(made.curve.apart_mm(np.array([place]))[:, 0]))
    x, y = points[nearest * FINER]
    given = given_gear(made.motion)
    concave = given if own[nearest] <= mate[nearest] else next(gear for gear in Gear if gear is not given)
    hollow = (
        f", where the {concave.value} gear is concave, {bent[nearest]:.3g} per module" if bent[nearest] < 0.0 else ""
    )
    return f": {said} at ({x:.4g}, {y:.4g}) mm of the drawing{hollow}"


def between(kept: Made, refused: Made | None) -> CurveLimits:
    """Limits half-way between an accepted pair and a refused one; the wider of both away from where the latter lacks
    contact, if that is known; a little eased where no pair was refused."""
    share = np.asarray(kept.limits.share)
    if refused is None:
        return replace(kept.limits, share=np.minimum(share * EASED**2, MOST_SHARE))
    other, near = refused.limits, 1.0
    if refused.lacking.size:
        near = np.max(_beside(refused.curve, refused.lacking[:, 0]), axis=1)
    half = (share + np.asarray(other.share)) / 2.0
    return replace(
        kept.limits,
        share=near * half + (1.0 - near) * np.maximum(share, other.share),
        steepest_rad=(kept.limits.steepest_rad + other.steepest_rad) / 2.0,
        nearest=(kept.limits.nearest + other.nearest) / 2.0,
    )


def _beside(curve: Rolled, at_mm: Array) -> Array:
    """1 at arc lengths of shape (k,), falling to 0 at ``BESIDE_PITCHES`` from them: shape (m, k)."""
    reach = BESIDE_PITCHES * curve.length_mm / curve.teeth
    return np.maximum(1.0 - curve.apart_mm(at_mm) / reach, 0.0)
