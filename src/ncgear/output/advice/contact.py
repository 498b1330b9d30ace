"""Advices about the contact of the teeth and the thrust of helical ones."""

from __future__ import annotations

from math import atan, degrees

from ncgear.contact.as_designed import AsDesigned, SideContact
from ncgear.drive import Drive
from ncgear.output.advice.values import Advice, Change, Kind, Remedy, Where

WIDER = 1.02
"""What the overlap of helical teeth shall be beyond the gap that they bridge: their sections differ a little."""

STEEPEST_HELIX_DEG = 30.0
"""Helix angle beyond which the thrust, its tangent, exceeds 0.58 of the tangential force; commonly not gone beyond."""


def contact_ratio(drive: Drive) -> Advice | None:
    """Flanks that lose contact, unless helical teeth overlap by more than that."""
    designed = drive.designed_contact
    sides = designed.pushing, designed.back
    if designed.longest_gap_pitches <= drive.overlap_ratio:
        return None
    error = max(side.transmission_error_rad for side in sides)
    return Advice(
        Kind.CONTACT_RATIO,
        (Where(angles_deg=tuple(_worst(designed, side) for side in sides if side.simultaneous.min() < 1)),),
        f"contact ratio: the shortest contact of a flank pair lasts {_shortest(designed):.3g} pitches, and at some "
        "positions no flanks touch",
        f"the driven gear is carried by an edge there, off the law by up to {error:.2g} rad; it knocks and wears",
        (*_helix(drive), Remedy("take more teeth of a smaller module")),
    )


def _shortest(designed: AsDesigned) -> float:
    return float(min(side.arcs.min() for side in (designed.pushing, designed.back)))


def _worst(designed: AsDesigned, side: SideContact) -> tuple[float, float]:
    """The first position without contact of flanks, in degrees of the driving gear."""
    at = degrees(float(designed.placement.phi1_rad[int(side.simultaneous.argmin())]))
    return at, at


def _helix(drive: Drive) -> tuple[Remedy, ...]:
    """Helical teeth whose overlap bridges the gap, where they need not be too steep for it."""
    if drive.helix is not None or drive.pitch.driven.is_ring or drive.gears.method != "exact":
        return ()
    gap_mm = WIDER * drive.designed_contact.longest_gap_pitches * drive.rack.pitch_mm
    angle = degrees(atan(gap_mm / drive.gears.face_width_mm))
    if angle > STEEPEST_HELIX_DEG:
        return ()
    changes = (
        Change("gears.helix.angle_deg", angle),
        Change("gears.helix.kind", "helical"),
        Change("gears.helix.hand", "right"),
    )
    return (Remedy("make the teeth helical, so that the next ones touch before these part", changes),)


def thrust(drive: Drive) -> Advice | None:
    """What helical teeth push along their axes."""
    helix = drive.helix
    if helix is None or not helix.thrust_share:
        return None
    towards, away = ("growing", "falling") if helix.hand == "right" else ("falling", "growing")
    return Advice(
        Kind.THRUST,
        (Where(),),
        f"axial thrust: {helix.thrust_share:.3g} of the tangential force at the pitch point pushes the driving gear "
        f"towards {towards} z and the driven one towards {away} z",
        "the bearings of both shafts must take it",
        (Remedy("herringbone teeth cancel it", (Change("gears.helix.kind", "herringbone"),)),),
    )
