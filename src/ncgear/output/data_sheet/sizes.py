"""Sizes of the pair: teeth, module, centre distance, and the radii of pitch, tip and root curves."""

from __future__ import annotations

from math import isclose

from ncgear.drive import Drive
from ncgear.metrology.radii import root_radii_mm, tip_radii_mm
from ncgear.numerics.arrays import Array
from ncgear.output.data_sheet.values import Group, Row
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear

ROUND = 1e-9
"""Relative range of the ratio below which a gear is called circular: rounding of a law that is constant."""


def sizes(drive: Drive) -> Group:
    """How large the gears are and how they lie to each other."""
    size, pitch = drive.pitch.size, drive.pitch
    rows = (
        Row("kind of gear", driving=_kind(pitch.driving), driven=_kind(pitch.driven)),
        Row("number of teeth", driving=size.driving_teeth, driven=size.driven_teeth),
        Row("module", "mm", pair=size.module_mm),
        Row("centre distance", "mm", pair=size.center_distance_mm),
        Row("face width", "mm", pair=drive.gears.face_width_mm),
        _of_both("length of pitch curve", pitch.length_mm(Gear.DRIVING), pitch.length_mm(Gear.DRIVEN)),
        *_radii(drive),
        _of_both("least radius of curvature", pitch.least_radius_mm(Gear.DRIVING), pitch.least_radius_mm(Gear.DRIVEN)),
    )
    return Group("Sizes", rows)


def _kind(curve: PitchCurve) -> str:
    low, high = curve.transmission.ratio_range
    form = "circular" if isclose(low.value, high.value, rel_tol=ROUND) else "non-circular"
    return f"{form}, internal" if curve.is_ring else form


def _of_both(label: str, driving: float, driven: float) -> Row:
    return Row(label, "mm", driving=driving, driven=driven)


def _radii(drive: Drive) -> list[Row]:
    gears = drive.teeth.driving, drive.teeth.driven
    return [
        *_ends("pitch radius", *_pitch_radii(drive)),
        *_ends("radius of tips", *(_range(tip_radii_mm(gear)) for gear in gears)),
        *_ends("radius of roots", *(_range(root_radii_mm(gear)) for gear in gears)),
    ]


def _range(values: Array) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def _ends(name: str, driving: tuple[float, float], driven: tuple[float, float]) -> list[Row]:
    words = ("least", "greatest")
    return [_of_both(f"{word} {name}", *ends) for word, *ends in zip(words, driving, driven, strict=True)]


def _pitch_radii(drive: Drive) -> tuple[tuple[float, float], tuple[float, float]]:
    """r1 = a / (i - s) and r2 = a i / (i - s) of both ends of the ratio's range (shape.py); both fall or r2 grows
    with i."""
    a, sense = drive.pitch.center_distance_mm, drive.pitch.mesh.sense
    ratios = [end.value for end in drive.pair.transmission.ratio_range]
    driving, driven = sorted(a / (i - sense) for i in ratios), sorted(a * i / (i - sense) for i in ratios)
    return (driving[0], driving[1]), (driven[0], driven[1])
