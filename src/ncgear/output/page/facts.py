"""What a designer wants to know first, in a few words under the page's title."""

from __future__ import annotations

from ncgear.contact.pair_contact import PairContact
from ncgear.drive import Drive
from ncgear.output.numbers import shown


def facts(drive: Drive) -> list[tuple[str, str]]:
    """Of the machine."""
    low, high = drive.transmission.ratio_range
    return [
        ("law", drive.design.motion.law.replace("_", " ")),
        ("speed", f"{shown(drive.design.operation.speed_rpm)} r/min"),
        ("stroke", f"{shown(drive.linkage.stroke_mm)} mm"),
        ("ratio", f"{low.value:.3g} to {high.value:.3g}"),
        *_power(drive),
        ("peak acceleration", f"{shown(drive.check.peak_acceleration_cycle_mm_s2.value)} mm/s\u00b2"),
    ]


def _power(drive: Drive) -> list[tuple[str, str]]:
    if drive.design.resistance is None:
        return []
    return [("peak power", f"{shown(drive.check.peak_power_w.value)} W")]


def gear_facts(drive: Drive, contact: PairContact) -> list[tuple[str, str]]:
    """Of a pair of gears, named after its stage where there are two."""
    size, stage = drive.pitch.size, f"stage {drive.stage}: " if drive.stage else ""
    steepest = drive.pitch.largest_pressure_angle_deg(drive.rack.pressure_angle_rad)
    return [
        (f"{stage}teeth", f"{size.driving_teeth} : {size.driven_teeth}"),
        (f"{stage}module", f"{shown(size.module_mm)} mm"),
        (f"{stage}centre distance", f"{shown(size.center_distance_mm)} mm"),
        (f"{stage}pressure angle", f"up to {steepest:.3g}\u00b0"),
        (f"{stage}contact ratio", f"from {contact.contact_ratio:.3g}"),
    ]
