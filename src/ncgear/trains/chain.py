"""A row of gears on fixed axes: each gear meshes with the next, so an idler meshes with two mates.

Gear 0 drives; gear k turns by theta_k, in the sense of the driving gear where k is even.  The law of the first mesh is
given, and gives the curve of gear 1.  A place of an idler that faces the axis before it faces the next axis after the
idler has turned by beta = pi + bend or pi - bend, where bend is the turn of the line of centres at the idler.  So the
curve of gear 1, later by beta, is the curve of the driving gear of the second mesh; the mate's curve and the centre
distance at which it closes follow, and so on along the row.

The first mesh of an idler decides where its teeth stand.  The arc length of its second mesh begins at the place that
faces the next axis at theta_k = 0; from there the teeth are farther by the arc that rolls as the idler turns by beta.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import cos, degrees, gcd, lcm, pi

import numpy as np

from ncgear.errors import below, renamed
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import extremes
from ncgear.numerics.jet import Jet
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.closed_curve import ClosedCurve, SmoothPart
from ncgear.ratio.laws.pitch_curve import GivenCurve, closed_law
from ncgear.ratio.transmission import Lobes, Piece, Transmission
from ncgear.teeth.backlash import require_teeth
from ncgear.teeth.fitting import PairTips, least_contact_ratio
from ncgear.teeth.form import Backlash, Cutter, CutterKind, ToothForm
from ncgear.teeth.gear import ToothedGear, pair_tips, toothed_gear
from ncgear.teeth.outline import ChordTolerance
from ncgear.teeth.tips import Tips, held_below
from ncgear.teeth.tool import least_concave_radius_mm, most_teeth
from ncgear.trains.train import GearMesh, Part, Poses, Train, TrainFigures, contact_condition, mirrored

BENDS = "train.bends_deg"


@dataclass(frozen=True, eq=False)
class PairRow:
    """The pairs of a row, from the driving gear on, and the directions in rad of the lines of centres."""

    pairs: tuple[PitchPair, ...]
    directions_rad: tuple[float, ...]

    @property
    def count(self) -> int:
        """Number of gears."""
        return len(self.pairs) + 1

    @property
    def teeth(self) -> tuple[int, ...]:
        """Teeth of all gears."""
        return (self.pairs[0].size.driving_teeth, *(pair.size.driven_teeth for pair in self.pairs))

    @property
    def axes_mm(self) -> Array:
        """The axes as complex numbers, shape (gears,)."""
        steps = [
            pair.center_distance_mm * np.exp(1j * direction)
            for pair, direction in zip(self.pairs, self.directions_rad, strict=True)
        ]
        return np.cumsum([0j, *steps])

    @property
    def cycle_rad(self) -> float:
        """Driving angle after which all gears have made whole turns."""
        lobes = [self.pairs[0].transmission.lobes.driving, *(pair.transmission.lobes.driven for pair in self.pairs)]
        return 2.0 * pi * lcm(*(one // gcd(one, lobes[0]) for one in lobes))

    def turned_rad(self, driving_rad: Array) -> Array:
        """theta_k of all gears, shape (gears, n)."""
        found = [driving_rad]
        for pair in self.pairs:
            found.append(pair.transmission.driven_angle(found[-1]).value)
        return np.array(found)

    def slope(self, driving_rad: Array, order: int) -> Jet:
        """dtheta/dphi of the last gear with its derivative; ``order`` is 1."""
        whole, bend, angle = np.ones(driving_rad.size), np.zeros(driving_rad.size), driving_rad
        for pair in self.pairs:
            one = pair.transmission.driven_angle(angle, 2)
            bend = bend + one.derivative(2) / one.derivative(1) * whole
            whole, angle = whole * one.derivative(1), one.value
        return Jet(np.stack([whole, whole * bend])).truncated(order)


def _beta(directions_rad: Sequence[float], number: int) -> float:
    """beta of the idler ``number``, from 1 on."""
    bend = directions_rad[number] - directions_rad[number - 1]
    return (pi + (bend if number % 2 == 0 else -bend)) % (2.0 * pi)


def row_of(
    first: Transmission, lobes: Sequence[int], directions_rad: Sequence[float], teeth: int, module_mm: float
) -> PairRow:
    """The row of gears with ``lobes``, from the law of the first pair, the teeth of the driving gear and the module.

    Raises NoSuchMechanism where a mate does not close, and WrongInput for numbers of teeth that are not whole.
    """
    with below("train"), renamed("motion", "ratio"):
        pairs = [sized_pair(first, teeth, module_mm, None)]
    for number in range(1, len(lobes) - 1):
        before = pairs[-1]
        given = GivenCurve(
            lambda _, before=before: _driven_curve(before),  # type: ignore[misc]
            None,
            drawn=False,
            driven=False,
            phase_rad=_beta(directions_rad, number),
            key=BENDS,
        )
        law = closed_law(given, Lobes(lobes[number], lobes[number + 1]), None)
        with below("train"), renamed("motion", "ratio"):
            pairs.append(sized_pair(law.transmission, before.size.driven_teeth, module_mm, None))
    return PairRow(tuple(pairs), tuple(directions_rad))


def _driven_curve(pair: PitchPair) -> ClosedCurve:
    """The driven gear's curve over a turn, by the gear's turn at which a place faces the driving gear."""
    law = pair.transmission

    def part(piece: Piece, lobe: int) -> SmoothPart:
        def polar(phi: Array, order: int) -> tuple[Jet, Jet]:
            whole = piece.driven_angle(phi, order + 1)
            radius = pair.center_distance_mm / (whole.differentiated() + 1.0)
            return whole.truncated(order) + lobe * law.lobes.driven_period_rad, radius

        return SmoothPart(piece.start_rad, piece.end_rad, polar, piece.knots_rad)

    return ClosedCurve(tuple(part(piece, lobe) for lobe in range(law.lobes.driven) for piece in law.pieces))


def row_gears(row: PairRow, form: ToothForm, tolerance_mm: float) -> tuple[list[ToothedGear], float]:
    """All gears with teeth, each in its frame as the driven gear of its mesh, and the least contact ratio.

    A rack cuts gears whose curves are all convex, else a pinion with as many teeth as fit into all hollows.  An idler's
    tips are as high as both its meshes allow.  Raises NoSuchMechanism, naming gear and tooth, where no tooth can stand.
    """
    cutter = Cutter(CutterKind.RACK)
    if any(least_concave_radius_mm(pair) is not None for pair in row.pairs):
        cutter = Cutter(CutterKind.PINION, max(min(most_teeth(pair, form.rack) for pair in row.pairs), 3))
    # Half of the play thins the idle flanks of each gear; in an idler's next mesh these flanks push.
    thinner = form.backlash.least_normal_mm / cos(form.rack.angles_rad[1]) / 2.0
    require_teeth(form.backlash, thinner, form.rack)
    form = replace(form, cutter=cutter, backlash=Backlash(thickness_mm=(-thinner, -thinner)))
    advance, made = 0.0, list[PairTips]()
    tips = list[Tips]()
    for number, pair in enumerate(row.pairs):
        rolled = 0.0
        if number:
            turned = np.array([_beta(row.directions_rad, number)])
            rolled = float(pair.arc.length(turned)[0]) * pair.center_distance_mm
            advance = (advance + form.rack.pitch_mm / 2.0 + rolled + thinner) % form.rack.pitch_mm
        both = pair_tips(pair, form, advance)[1]
        made.append(both)
        tips = [*tips[:-1], _as_low_as_both(tips[-1], both[0], rolled), both[1]] if number else list(both)
    chords = ChordTolerance(tolerance_mm, tolerance_mm)
    return [toothed_gear(one, chords) for one in tips], min(least_contact_ratio(both) for both in made)


def _as_low_as_both(first: Tips, second: Tips, rolled_mm: float) -> Tips:
    """An idler of its first mesh, its tips no higher than in its second, where its flanks cross ``rolled_mm`` later."""
    length = first.flanks.curve.length_mm
    apart = (first.flanks.crossing_mm + rolled_mm)[:, None] - second.flanks.crossing_mm
    there = np.abs(apart - length * np.round(apart / length)).argmin(axis=1)
    lower = held_below(first, second.flanks.tip_height_mm[there])
    return replace(lower, met_depth_mm=np.maximum(first.met_depth_mm, second.met_depth_mm[there]))


def chain_train(
    row: PairRow, form: ToothForm, width_mm: float, bore_mm: float | None, speed_rpm: float, tolerance_mm: float
) -> Train:
    """The row as a train; raises as ``row_gears``."""
    with below("train"), renamed("motion", "ratio"):
        gears, ratio = row_gears(row, form, tolerance_mm)
    parts, axes = [], row.axes_mm
    for number, gear in enumerate(gears):
        # The outline is made for a driven gear, which turns clockwise; gears 2, 4, ... turn counter-clockwise.
        outline = mirrored(gear.outline_mm) if number and number % 2 == 0 else gear.outline_mm
        parts.append(Part(f"gear_{number + 1}", outline, width_mm, gear.teeth, bore_mm=bore_mm))
    sense = np.where(np.arange(row.count) % 2, -1.0, 1.0)[:, None]
    standing = np.array([row.directions_rad[0], *row.directions_rad])[:, None]

    def poses_at(driving_rad: Array) -> Poses:
        turned = row.turned_rad(np.asarray(driving_rad, dtype=float))
        place = np.broadcast_to(axes[:, None], turned.shape)
        return Poses(place.real, place.imag, standing + sense * turned)

    meshes = tuple(GearMesh(one.name, other.name) for one, other in pairwise(parts))
    told = _told(row, ratio)
    return Train(tuple(parts), meshes, poses_at, parts[0].name, row.cycle_rad, speed_rpm, tolerance_mm, told)


def _told(row: PairRow, contact_ratio: float) -> TrainFigures:
    # Speed of the last gear over the speed of the first
    slow, fast = extremes(lambda driving: row.slope(driving, 1), 0.0, row.cycle_rad)
    distances = [pair.center_distance_mm for pair in row.pairs]
    convex = [pair.convex(gear) for pair in row.pairs for gear in Gear]
    rows = (
        ("gears", f"{', '.join(map(str, row.teeth))} teeth, module {row.pairs[0].size.module_mm:.6g} mm"),
        ("axes", f"{', '.join(f'{one:.6g}' for one in distances)} mm apart"),
        (
            "ratio",
            f"{1.0 / fast.value:.5g} at {degrees(fast.at):.4g} deg to {1.0 / slow.value:.5g} at "
            f"{degrees(slow.at):.4g} deg from the first gear to the last",
        ),
        ("pitch curves", "all convex" if all(convex) else "some concave: a pinion cuts all gears"),
    )
    figures = {
        "teeth": list(row.teeth),
        "center_distances_mm": distances,
        "ratio_min": 1.0 / fast.value,
        "ratio_max": 1.0 / slow.value,
        "contact_ratio_min": contact_ratio,
    }
    condition = contact_condition(contact_ratio, "more teeth (train.gears.teeth)")
    return TrainFigures(f"{row.count} gears in a row", rows, figures, (condition,))
