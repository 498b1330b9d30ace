"""Which tool leaves the fillets: as asked for, or the first that fits of rack, pinion cutter and mating gear."""

from __future__ import annotations

from math import ceil, pi, sqrt

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.crossing import chord_crossings
from ncgear.numerics.units import in_words
from ncgear.pitch.pair import STRAIGHT, PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.form import CutterKind
from ncgear.teeth.rack import BasicRack
from ncgear.teeth.tips import Tips
from ncgear.teeth.tool import PinionCircle, RackLine

FEWER_TEETH = 10
"""Teeth that a pinion cutter must have less than the concave stretch it works in would have all round: with fewer of a
difference its tips foul the gear's on their way out (the rule for internal gears of full height at 20 degrees); what is
chosen is then checked on the curves."""

MOST_TEETH = 40
"""A chosen pinion cutter has no more: common cutters have 20 to 40."""

PROBES = 25
"""Points on a flank."""

STEPS = 12
"""Points per pitch of a cutter tip's path."""

TANGENT = 0.15
"""Pitches after the end of the flank within which the cutter's tip is not looked at: at first it is still tangent."""

BEYOND = 1.2
"""Share of the way a tip takes out of the space, by the radii of the sharpest hollow, to which it is followed."""

NEIGHBOURS = 2
"""Teeth on either side of a space whose tips the cutter may cut on its way."""


def least_concave_radius_mm(pitch: PitchPair) -> float | None:
    """Least radius at which material of either gear is concave, a ring all around; None where both gears are convex."""
    low = min(pitch.curvature_range[gear][0].value for gear in Gear)
    return -1.0 / low if low * pitch.center_distance_mm < -STRAIGHT else None


def chosen_kind(pitch: PitchPair) -> CutterKind:
    """A rack for convex curves, else the mating gear: no rack goes into a concave stretch."""
    return CutterKind.RACK if least_concave_radius_mm(pitch) is None else CutterKind.MATE


def most_teeth(pitch: PitchPair, rack: BasicRack) -> int:
    """Most teeth of a pinion cutter that works in the concave stretches; may be less than one."""
    radius = least_concave_radius_mm(pitch)
    return MOST_TEETH if radius is None else min(MOST_TEETH, int(2.0 * radius / rack.module_mm) - FEWER_TEETH)


def rack_cutter(pitch: PitchPair) -> RackLine:
    """The rack; raises NoSuchMechanism on a concave curve, whose hollow flanks no straight edge can leave."""
    _refuse_gouging(pitch, 0.0, "a rack", "kind: mate, or kind: pinion, is needed", "gears.cutter.kind")
    return RackLine()


def pinion_cutter(pitch: PitchPair, rack: BasicRack, teeth: int | None) -> PinionCircle:
    """The pinion cutter of given or chosen teeth; raises NoSuchMechanism where it is larger than a concave stretch."""
    wanted = teeth if teeth is not None else max(most_teeth(pitch, rack), 3)
    cutter = PinionCircle(wanted, rack.module_mm)
    _refuse_gouging(
        pitch,
        1.0 / cutter.radius_mm,
        f"a pinion cutter of {wanted} teeth (pitch radius {cutter.radius_mm:.4g} mm)",
        "fewer cutter teeth, kind: mate, or more teeth of a smaller module are needed",
        "gears.cutter.teeth",
    )
    return cutter


def _refuse_gouging(pitch: PitchPair, curvature: float, cutter: str, remedy: str, key: str) -> None:
    """Refuse a cutter flatter than a concave stretch: its flanks would be flatter than the gear's there."""
    for gear in Gear:
        low = pitch.curvature_range[gear][0]
        if (curvature + low.value) * pitch.center_distance_mm < -STRAIGHT:
            raise NoSuchMechanism(
                f"{cutter} does not go into the {gear.value} pitch curve, which is concave with a radius of "
                f"{-1.0 / low.value:.4g} mm at phi1 = {in_words(low.at)}; {remedy}",
                key=key,
            )


def fouled(tips: Tips) -> Mask:
    """Which flanks' fillets the tip of a pinion cutter leaves by cutting teeth on its way out; shape (2 z,)."""
    flanks, every = tips.flanks, np.arange(tips.flanks.count)
    pitch, length = flanks.rack.pitch_mm, _way_out_mm(tips)
    start = flanks.rolled_mm(every, -flanks.flank_depth_mm)
    rolled = np.linspace(TANGENT * pitch, length, ceil(STEPS * length / pitch))
    path = flanks.fillet(every[:, None], start[:, None] + flanks.side[:, None] * rolled)[0]
    teeth, hit = _teeth(tips), np.zeros(flanks.count, dtype=bool)
    for neighbour in range(-NEIGHBOURS, NEIGHBOURS + 1):
        hit[chord_crossings(path, teeth[(every // 2 + neighbour) % len(teeth)])[0]] = True
    return hit


def _way_out_mm(tips: Tips) -> float:
    """Rolled length after which a cutter tooth is out of its space, half a turn of the cutter at most.

    It rises by s^2 / 2 times the difference of the curvatures.
    """
    flanks, tool = tips.flanks, tips.flanks.tool
    assert isinstance(tool, PinionCircle)
    depth = float(np.max(flanks.root_depth_mm) + np.max(flanks.tip_height_mm))
    turning = 1.0 / tool.radius_mm + flanks.curve.curvature_bounds[0]
    half_turn = pi * tool.radius_mm
    return half_turn if turning <= 0.0 else min(half_turn, BEYOND * sqrt(2.0 * depth / turning))


def _teeth(tips: Tips) -> Array:
    """Working flanks of the teeth, up the back and down the front; shape (z, points, 2)."""
    flanks, share = tips.flanks, np.linspace(0.0, 1.0, PROBES)
    heights = -flanks.flank_depth_mm[:, None] * (1.0 - share) + tips.height_mm[:, None] * share
    side = flanks.flank(np.arange(flanks.count)[:, None], heights)[0]
    return np.concatenate([side[::2], side[1::2, ::-1]], axis=1)
