"""Which tool leaves the fillets: as asked for, or the first that fits of rack, pinion cutter and mating gear."""

from __future__ import annotations

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.machine.rack import BasicRack
from ncgear.numerics.angles import in_words
from ncgear.numerics.arrays import Mask
from ncgear.numerics.crossing import chord_crossings
from ncgear.pitch.pair import STRAIGHT, PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.form import CutterKind
from ncgear.teeth.tips import Tips
from ncgear.teeth.tool import PinionCircle, RackLine

FEWER_TEETH = 10
"""Teeth that a pinion cutter must have less than the concave stretch it works in would have all round: with fewer of a
difference its tips foul the gear's on their way out (the rule for internal gears of full height at 20 degrees); what is
chosen is then checked on the curves."""

MOST_TEETH = 40
"""A chosen pinion cutter has no more: common cutters have 20 to 40."""

PROBES = 25
LEAVING = (0.15, 3.0)
"""Pitches after the end of the flank within which the cutter's tip is followed: at first it is still tangent."""


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
    """Which flanks the tip of a pinion cutter cuts on its way out of the space; shape (2 z,)."""
    flanks, every = tips.flanks, np.arange(tips.flanks.count)
    pitch = flanks.rack.pitch_mm
    start = flanks.rolled_mm(every, -flanks.flank_depth_mm)
    leaving = start[:, None] + flanks.side[:, None] * pitch * np.linspace(*LEAVING, 4 * PROBES)
    share = np.linspace(0.0, 1.0, PROBES)
    heights = -flanks.flank_depth_mm[:, None] * (1.0 - share) + tips.height_mm[:, None] * share
    path, side = flanks.fillet(every[:, None], leaving)[0], flanks.flank(every[:, None], heights)[0]
    hit = np.zeros(flanks.count, dtype=bool)
    hit[chord_crossings(path, side)[0]] = True
    return hit
