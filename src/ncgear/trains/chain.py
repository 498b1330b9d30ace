"""A row of gears on fixed axes (``ratio/laws/row.py``): its teeth, and the row as a train.

The first mesh of an idler decides where its teeth stand.  The arc length of its second mesh begins at the place that
faces the next axis at theta_k = 0; from there the teeth are farther by the arc that rolls as the idler turns by beta.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from math import cos, degrees, gcd, lcm, pi

import numpy as np

from ncgear.errors import NoSuchMechanism, renamed
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.units import placed_rad
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.row import beta_rad, laws_in_series
from ncgear.ratio.transmission import Transmission
from ncgear.solids.plan.room import INNER_WALL_IN_MODULES
from ncgear.teeth.backlash import require_teeth
from ncgear.teeth.fitting import PairTips, least_contact_ratio
from ncgear.teeth.flank import Flanks
from ncgear.teeth.form import Backlash, Cutter, CutterKind, ToothForm
from ncgear.teeth.gear import ToothedGear, pair_tips, toothed_gear
from ncgear.teeth.outline import ChordTolerance
from ncgear.teeth.tips import Tips, held_below
from ncgear.teeth.tool import least_concave_radius_mm, most_teeth
from ncgear.trains.train import MORE_TEETH, GearMesh, Part, Poses, Train, TrainFigures, contact_condition, mirrored


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

    def require_apart(self, key: str) -> None:
        """Raise NoSuchMechanism, with ``key``, where two gears that do not mesh overlap at every angle."""
        driven = [pair.radius_range_mm(Gear.DRIVEN)[0] for pair in self.pairs]
        least, axes = (self.pairs[0].radius_range_mm(Gear.DRIVING)[0], *driven), self.axes_mm
        for first, last in combinations(range(self.count), 2):
            apart, needed = float(np.abs(axes[last] - axes[first])), least[first] + least[last]
            if last > first + 1 and apart < needed:
                raise NoSuchMechanism(
                    f"gears {first + 1} and {last + 1} of the row overlap at every angle: their axes are {apart:.5g} "
                    f"mm apart, and the least radii of their pitch curves are {needed:.5g} mm together; smaller bends, "
                    "or bends to both sides, spread the row",
                    key=key,
                )

    @property
    def cycle_rad(self) -> float:
        """Driving angle after which all gears have made whole turns."""
        lobes = [self.pairs[0].transmission.lobes.driving, *(pair.transmission.lobes.driven for pair in self.pairs)]
        return 2.0 * pi * lcm(*(count // gcd(count, lobes[0]) for count in lobes))

    def rolled_mm(self, number: int) -> float:
        """The arc that rolls while an idler, by its number from 1 on, turns from the axis before it to the next."""
        pair, turned = self.pairs[number], np.array([beta_rad(self.directions_rad, number)])
        return float(pair.arc.length(turned)[0]) * pair.center_distance_mm

    def turned_rad(self, driving_rad: Array) -> Array:
        """theta_k of all gears, shape (gears, n)."""
        found = [driving_rad]
        for pair in self.pairs:
            found.append(pair.transmission.driven_angle(found[-1]).value)
        return np.array(found)


def row_of(laws: Sequence[Transmission], directions_rad: Sequence[float], teeth: int, module_mm: float) -> PairRow:
    """The row of meshes with these laws, from the teeth of the driving gear and the module.

    Raises NoSuchMechanism where pitch curves are no gears, and WrongInput for numbers of teeth that are not whole.
    """
    pairs = list[PitchPair]()
    for law in laws:
        pairs.append(sized_pair(law, pairs[-1].size.driven_teeth if pairs else teeth, module_mm, None))
    return PairRow(tuple(pairs), tuple(directions_rad))


def row_form(row: PairRow, form: ToothForm) -> ToothForm:
    """The form of all teeth of a row, with its tool and with thinner teeth.

    A rack cuts gears whose curves are all convex, else a pinion with as many teeth as fit into all hollows.  Half of
    the play thins the idle flanks of each gear; in an idler's next mesh these flanks push.
    """
    cutter = Cutter(CutterKind.RACK)
    if any(least_concave_radius_mm(pair) is not None for pair in row.pairs):
        cutter = Cutter(CutterKind.PINION, max(min(most_teeth(pair, form.rack) for pair in row.pairs), 3))
    thinner = form.backlash.least_normal_mm / cos(form.rack.angles_rad[1]) / 2.0
    require_teeth(form.backlash, thinner, form.rack)
    return replace(form, cutter=cutter, backlash=Backlash(thickness_mm=(-thinner, -thinner)))


def row_tips(row: PairRow, form: ToothForm) -> list[tuple[CutterKind, PairTips]]:
    """The tool and the flanks of both gears of each mesh, for the form of ``row_form``.

    An idler is in two meshes, and its tips are as high as both allow.  Raises NoSuchMechanism, naming gear and tooth,
    where no tooth can stand.
    """
    thinner, pitch_mm = -form.backlash.thickness_mm[0], form.rack.pitch_mm
    advance, made = 0.0, list[tuple[CutterKind, PairTips]]()
    for number, pair in enumerate(row.pairs):
        rolled = row.rolled_mm(number) if number else 0.0
        if number:
            advance = (advance + pitch_mm / 2.0 + rolled + thinner) % pitch_mm
        # No file of a row gives its cutter
        with renamed("gears.cutter.teeth", "gears.teeth", MORE_TEETH):
            tool, (own, mate) = pair_tips(pair, form, advance)
        if not number:
            made.append((tool, (own, mate)))
            continue
        kind, (first, idler) = made[-1]
        made[-1] = kind, (first, _as_low_as_both(idler, own, rolled))
        made.append((tool, (_as_low_as_both(own, idler, -rolled), mate)))
    return made


def same_flanks(own: Flanks, other: Flanks, rolled_mm: float) -> IndexArray:
    """The numbers in its other mesh of an idler's flanks, which cross the pitch point there ``rolled_mm`` later."""
    length = own.curve.length_mm
    apart = (own.crossing_mm + rolled_mm)[:, None] - other.crossing_mm
    return np.abs(apart - length * np.round(apart / length)).argmin(axis=1)


def _as_low_as_both(own: Tips, other: Tips, rolled_mm: float) -> Tips:
    """An idler of one mesh, its tips no higher than in its other, where its flanks cross ``rolled_mm`` later."""
    there = same_flanks(own.flanks, other.flanks, rolled_mm)
    lower = held_below(own, other.flanks.tip_height_mm[there])
    return replace(lower, met_depth_mm=np.maximum(own.met_depth_mm, other.met_depth_mm[there]))


def chain_train(
    row: PairRow, form: ToothForm, width_mm: float, bore_mm: float | None, speed_rpm: float, tolerance_mm: float
) -> Train:
    """The row as a train; raises as ``row_tips``."""
    made = [tips for _, tips in row_tips(row, row_form(row, form))]
    chords = ChordTolerance(tolerance_mm, tolerance_mm)
    gears = [toothed_gear(gear, chords) for gear in (made[0][0], *(driven for _, driven in made))]
    told = _told(row, min(least_contact_ratio(both) for both in made))
    return train_of_gears(row, gears, width_mm, bore_mm, speed_rpm, tolerance_mm, told)


def train_of_gears(
    row: PairRow,
    gears: Sequence[ToothedGear],
    width_mm: float,
    bore_mm: float | None,
    speed_rpm: float,
    tolerance_mm: float,
    told: TrainFigures,
) -> Train:
    """The row as a train, of the driving gear of its first mesh and the driven gears of all."""
    parts, axes, wall_mm = [], row.axes_mm, INNER_WALL_IN_MODULES * row.pairs[0].size.module_mm
    for number, gear in enumerate(gears):
        # The outline is made for a driven gear, which turns clockwise; gears 2, 4, ... turn counter-clockwise.
        outline = mirrored(gear.outline_mm) if number and number % 2 == 0 else gear.outline_mm
        parts.append(Part(f"gear_{number + 1}", outline, width_mm, gear.teeth, bore_mm=bore_mm, wall_mm=wall_mm))
    sense = np.where(np.arange(row.count) % 2, -1.0, 1.0)[:, None]
    standing = np.array([row.directions_rad[0], *row.directions_rad])[:, None]

    def poses_at(driving_rad: Array) -> Poses:
        turned = row.turned_rad(np.asarray(driving_rad, dtype=float))
        place = np.broadcast_to(axes[:, None], turned.shape)
        return Poses(place.real, place.imag, standing + sense * turned)

    meshes = tuple(GearMesh(one.name, other.name) for one, other in pairwise(parts))
    return Train(tuple(parts), meshes, poses_at, parts[0].name, row.cycle_rad, speed_rpm, tolerance_mm, told)


def _told(row: PairRow, contact_ratio: float) -> TrainFigures:
    low, high = laws_in_series([pair.transmission for pair in row.pairs]).whole.ratio_range
    distances = [pair.center_distance_mm for pair in row.pairs]
    convex = [pair.convex(gear) for pair in row.pairs for gear in Gear]
    rows = (
        ("gears", f"{', '.join(map(str, row.teeth))} teeth, module {row.pairs[0].size.module_mm:.6g} mm"),
        ("axes", f"{', '.join(f'{distance:.6g}' for distance in distances)} mm apart"),
        (
            "ratio",
            f"{low.value:.5g} at {degrees(placed_rad(low.at)):.4g} deg to {high.value:.5g} at "
            f"{degrees(placed_rad(high.at)):.4g} deg from the "
            "first gear to the last",
        ),
        ("pitch curves", "all convex" if all(convex) else "some concave: a pinion cuts all gears"),
    )
    figures = {
        "teeth": list(row.teeth),
        "center_distances_mm": distances,
        "ratio_min": low.value,
        "ratio_max": high.value,
        "contact_ratio_min": contact_ratio,
    }
    condition = contact_condition(contact_ratio, "more teeth (train.gears.teeth)")
    return TrainFigures(f"{row.count} gears in a row", rows, figures, (condition,))
