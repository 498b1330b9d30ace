"""What a designer should know before cutting metal, in plain words: what it is, where, and what to change."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING

from ncgear.drive import Drive
from ncgear.output.numbers import shown

if TYPE_CHECKING:
    from ncgear.pitch.shape import Gear
    from ncgear.teeth.gear import ToothedGear

WIDEST_RATIO = 5.0
"""Ratio, or its inverse, beyond which the smaller gear's pitch radius is under a sixth of the centre distance."""

STEEPEST_DEG = 60.0
"""Pressure angle beyond which half of the force on a tooth bears on the shafts twice over (cos 60 deg = 0.5)."""


def check_warnings(drive: Drive) -> list[str]:
    """Warnings that need no pitch curve."""
    ranges = [_ratio_range(pair) for pair in drive.by_stage]
    return [warning for warning in (*ranges, _speeds(drive), _negative_resistance(drive)) if warning]


def build_warnings(drive: Drive) -> list[str]:
    """Warnings about pitch curves, teeth and contact."""
    from ncgear.pitch.shape import Gear

    curves = [_pressure_angle(drive), _ring(drive), *(_concave(drive, gear) for gear in Gear)]
    teeth = [_undercut(drive), *_shortened(drive), _contact(drive), _thrust(drive)]
    return [warning for warning in [*curves, *teeth] if warning]


def _ratio_range(drive: Drive) -> str:
    low, high = drive.pair.transmission.ratio_range
    if low.value >= 1.0 / WIDEST_RATIO and high.value <= WIDEST_RATIO:
        return ""
    return (
        f"the ratio runs from {low.value:.3g} (at {degrees(low.at):.4g} deg) to {high.value:.3g} (at "
        f"{degrees(high.at):.4g} deg); gears beyond 1:{WIDEST_RATIO:g} are hardly usable. Change theta4, a1 or the "
        "speed at which a1 is stated"
    )


def _speeds(drive: Drive) -> str:
    operating, law = drive.design.operation.speed_rpm, drive.law_speed_rpm
    if abs(operating / law - 1.0) < 1e-3:
        return ""
    held = f"the law's velocities hold at {law:.5g} r/min, but the machine runs at {operating:g} r/min"
    factor, sense = (law / operating, "slower") if law > operating else (operating / law, "faster")
    return f"{held}: there the slider is {factor:.3g} times {sense} than v1 and v2 say"


def _negative_resistance(drive: Drive) -> str:
    resistance = drive.machine.resistance
    stretches = resistance.negative_stretches_mm(drive.linkage.stroke_mm)
    if not stretches:
        return ""
    taken = "kept, so that it drives the slider" if resistance.keep_negative else "taken as zero there"
    named = ", ".join(f"{low:.3g}..{high:.3g}" for low, high in stretches)
    return f"the resistance is negative for displacements of {named} mm; it is {taken}"


def _pressure_angle(drive: Drive) -> str:
    angle = drive.pitch.largest_pressure_angle_deg(drive.rack.pressure_angle_rad)
    if angle <= STEEPEST_DEG:
        return ""
    at = degrees(drive.pitch.largest_tangent_angle_rad.at)
    return f"the pressure angle reaches {angle:.3g} deg at phi1 = {at:.4g} deg; a smaller range of the ratio lowers it"


def _ring(drive: Drive) -> str:
    if not drive.pitch.driven.is_ring:
        return ""
    return (
        "the driven gear is internal: no hob can cut it; wire, mill, print, or a shaper with a smaller cutter can; it "
        "is carried on its rim, or by a plate behind the driving gear"
    )


def _concave(drive: Drive, gear: Gear) -> str:
    radius = drive.pitch.least_concave_radius_mm(gear)
    if radius is None:
        return ""
    stretches = ", ".join(f"{degrees(a):.0f}..{degrees(b):.0f}" for a, b in drive.pitch.concave_ranges(gear))
    return (
        f"the {gear.value} pitch curve is concave for phi1 in {stretches} deg (radius {radius:.4g} mm): "
        "no hob can cut it; wire, mill, print, or a shaper with a smaller cutter can"
    )


def _undercut(drive: Drive) -> str:
    from ncgear.teeth.shift import teeth_free_of_undercut

    named = [_named(gear.undercut, name) for gear, name in _both(drive) if gear.undercut]
    if not named:
        return ""
    enough = teeth_free_of_undercut(drive.pitch, drive.teeth.driving.flanks.rack, drive.teeth.driven.flanks.rack)
    remedy = f"From {enough} driving teeth at this centre distance there is none"
    if drive.gears.undercut == "allow":
        return f"undercut: {'; '.join(named)}. {remedy}"
    return (
        f"undercut at full height: {'; '.join(named)}; the mating tips are shortened instead, so that all flanks are "
        f"exact. {remedy}"
    )


def _shortened(drive: Drive) -> list[str]:
    """Tips that are shortened for another reason than undercut."""
    from ncgear.teeth.tips import Limit

    reasons = {
        Limit.SLOPE: "would slope too much, the other edge of the tooth being lower",
        Limit.FILLET: "would reach into the mate's fillet",
        Limit.CUSP: "would end in a cusp, so concave is the pitch curve there",
        Limit.LAND: f"would have a land under {drive.gears.least_tip_land:g} modules",
        Limit.FOULING: "would run into the mate's tips, so concave is the pitch curve there",
        Limit.HELIX: "would jump between sections of the helical teeth",
    }
    found = []
    for reason, words in reasons.items():
        named = [_named(gear.shortened(reason), name) for gear, name in _both(drive) if gear.shortened(reason)]
        if named:
            found.append(f"tips shortened that {words}: {'; '.join(named)}")
    return found


def _both(drive: Drive) -> tuple[tuple[ToothedGear, str], ...]:
    return (drive.teeth.driving, "driving"), (drive.teeth.driven, "driven")


def _named(teeth: list[int], gear: str) -> str:
    return f"teeth {shown(teeth)} of the {gear} gear"


def _contact(drive: Drive) -> str:
    designed = drive.designed_contact
    sides = designed.pushing, designed.back
    if min(int(side.simultaneous.min()) for side in sides) >= 1:
        return ""
    error = max(side.transmission_error_rad for side in sides)
    return (
        f"contact ratio: the shortest contact of a flank pair lasts {min(side.arcs.min() for side in sides):.3g} "
        "pitches, and at some positions no flanks touch: the driven gear is carried by an edge there, off the law by "
        f"up to {error:.2g} rad"
    )


def _thrust(drive: Drive) -> str:
    helix = drive.helix
    if helix is None or not helix.thrust_share:
        return ""
    towards, away = ("growing", "falling") if helix.hand == "right" else ("falling", "growing")
    return (
        f"axial thrust: {helix.thrust_share:.3g} of the tangential force at the pitch point pushes the driving gear "
        f"towards {towards} z and the driven one towards {away} z; bearings must take it, herringbone teeth cancel it"
    )
