"""Advices about the pitch curves: how steeply they drive each other, and where they are hollow."""

from __future__ import annotations

from math import cos, degrees, radians

from ncgear.drive import Drive
from ncgear.output.advice.gentler import optimised, tempered
from ncgear.output.advice.values import Advice, Change, Kind, Remedy, Where
from ncgear.pitch import shape
from ncgear.pitch.pair import STRAIGHT, largest_tangent_angle_rad
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.transmission import Transmission

STEEPEST_DEG = 60.0
"""Pressure angle beyond which half of the force on a tooth bears on the shafts twice over (cos 60 deg = 0.5)."""

LEAST_RACK_DEG = 14.5
"""The least pressure angle that racks are commonly made with: below it teeth are undercut and weak at the root."""


def pressure_angle(drive: Drive) -> Advice | None:
    """Flanks that press on the shafts more than they turn the driven gear."""
    angle = drive.pitch.largest_pressure_angle_deg(drive.rack.pressure_angle_rad)
    if angle <= STEEPEST_DEG:
        return None
    at = degrees(drive.pitch.largest_tangent_angle_rad.at)
    return Advice(
        Kind.PRESSURE_ANGLE,
        (Where(angles_deg=((at, at),)),),
        f"the pressure angle reaches {angle:.3g} deg at phi1 = {at:.4g} deg",
        f"only {100.0 * cos(radians(angle)):.0f} % of the force between the teeth turns the driven gear there; the "
        "rest bears on the shafts, and friction may lock the pair",
        _less_steep(drive, angle),
    )


def _less_steep(drive: Drive, angle: float) -> tuple[Remedy, ...]:
    rack, mesh = drive.rack.pressure_angle_rad, drive.pitch.mesh

    def steep(transmission: Transmission) -> bool:
        return degrees(largest_tangent_angle_rad(transmission, mesh).value + rack) > STEEPEST_DEG

    sought = (optimised(drive, pressure_angle_deg=STEEPEST_DEG),) if mesh is Mesh.EXTERNAL else ()
    return (*_flatter_rack(drive, angle), *tempered(drive, steep), *sought)


def _flatter_rack(drive: Drive, angle: float) -> tuple[Remedy, ...]:
    """A rack of so much less pressure angle, where such racks are made."""
    flatter = degrees(drive.rack.pressure_angle_rad) - (angle - STEEPEST_DEG)
    if flatter < LEAST_RACK_DEG:
        return ()
    tenths = int(flatter * 10.0) / 10.0
    change = Change("gears.rack.pressure_angle_deg", tenths)
    return (Remedy("take a rack with a smaller pressure angle, of which more teeth may be undercut", (change,)),)


def ring(drive: Drive) -> Advice | None:
    """What an internal gear asks of the workshop."""
    if not drive.pitch.driven.is_ring:
        return None
    return Advice(
        Kind.RING,
        (Where(Gear.DRIVEN.value),),
        "the driven gear is internal: no hob can cut it",
        "wire, mill, print, or a shaper with a smaller cutter can; it is carried on its rim, or by a plate behind the "
        "driving gear",
    )


def concave(drive: Drive, gear: Gear) -> Advice | None:
    """A pitch curve that is dented."""
    radius = drive.pitch.least_concave_radius_mm(gear)
    if radius is None:
        return None
    stretches = tuple((degrees(a), degrees(b)) for a, b in drive.pitch.concave_ranges(gear))
    named = ", ".join(f"{a:.0f}..{b:.0f}" for a, b in stretches)
    return Advice(
        Kind.CONCAVE,
        (Where(gear.value, angles_deg=stretches),),
        f"the {gear.value} pitch curve is concave for phi1 in {named} deg (radius {radius:.4g} mm): no hob can cut it",
        "wire, mill, print, or a shaper with a smaller cutter can; the mate's teeth stand close together there and "
        "their tips may have to be shortened",
        _convex(drive, gear),
    )


def _convex(drive: Drive, gear: Gear) -> tuple[Remedy, ...]:
    mesh = drive.pitch.mesh

    def dented(transmission: Transmission) -> bool:
        low, high = transmission.extremes(lambda piece: lambda phi1: shape.curvature(piece.slope(phi1, 3), gear, mesh))
        return (-high.value if shape.is_ring(gear, mesh) else low.value) < -STRAIGHT

    sought = (optimised(drive, convex=True),) if mesh is Mesh.EXTERNAL else ()
    return (*tempered(drive, dented), *sought)
