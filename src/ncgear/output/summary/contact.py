"""The contact analysis as plain values, keys ending in their unit: the section ``contact`` of a summary."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Any

import numpy as np

from ncgear.contact.as_designed import AsDesigned, SideContact
from ncgear.contact.as_written import AsWritten
from ncgear.contact.pair_contact import PairContact
from ncgear.contact.placement import Placement
from ncgear.numerics.arrays import Array


def contact_summary(contact: PairContact, speed: Callable[[Array], Array]) -> dict[str, Any]:
    """Figures of a pair as designed and as written; its driving gear's ``speed`` in rad/s, of its angle in rad."""
    designed = contact.as_designed
    speed_rad_s = speed(designed.placement.phi1_rad)
    return {
        "positions": designed.placement.count,
        "transmission_error_rad": contact.transmission_error_rad,
        "contact_ratio_min": contact.contact_ratio,
        "penetration_max_mm": contact.penetration_mm,
        "as_designed": _as_designed(designed, speed_rad_s),
        "as_written": {written.source: _as_written(written, designed) for written in contact.as_written},
    }


def _as_designed(designed: AsDesigned, speed_rad_s: Array) -> dict[str, Any]:
    pushing, back = designed.pushing, designed.back
    return {
        "transmission_error_rad": pushing.transmission_error_rad,
        "transmission_error_back_rad": back.transmission_error_rad,
        **_by_tooth(pushing, pushing.error_rad),
        **_range("backlash", "rad", designed.backlash_rad, designed.placement),
        **_ratios(pushing, ""),
        **_ratios(back, "_back"),
        **_greatest("sliding_velocity_max", "mm_s", designed.largest_sliding_mm * speed_rad_s, designed.placement),
        **_range("pressure_angle", "deg", np.degrees(pushing.first.pressure_angle_rad), designed.placement),
        **_range("pressure_angle_back", "deg", np.degrees(back.first.pressure_angle_rad), designed.placement),
        **_penetration(designed.overlap_mm, designed.placement),
        **_clearances(designed),
    }


def _by_tooth(side: SideContact, error_rad: Array) -> dict[str, Any]:
    by_tooth = side.variation_by_tooth(error_rad)
    return {"transmission_error_by_tooth_rad": [by_tooth[tooth] for tooth in sorted(by_tooth)]}


def _ratios(side: SideContact, suffix: str) -> dict[str, Any]:
    return {
        f"contact_ratio{suffix}_min": float(side.arcs.min()),
        f"contact_ratio{suffix}_mean": float(side.arcs.mean()),
        f"simultaneous_contacts{suffix}_min": int(side.simultaneous.min()),
    }


def _clearances(designed: AsDesigned) -> dict[str, Any]:
    """None where no tip of a gear stands over a root of the other."""
    least = {}
    for gear in ("driving", "driven"):
        both = [getattr(side, f"{gear}_tips") for side in (designed.pushing, designed.back)]
        over_root = min(tips.over_root_mm for tips in both)
        least[f"clearance_{gear}_tips_mm"] = over_root if isfinite(over_root) else None
        least[f"clearance_{gear}_tips_from_fillets_mm"] = min(tips.from_fillet_mm for tips in both)
    return least


def _as_written(written: AsWritten, designed: AsDesigned) -> dict[str, Any]:
    astray = np.maximum(
        np.abs(written.pushing_rad - designed.pushing.error_rad), np.abs(written.back_rad - designed.back.error_rad)
    )
    return {
        "transmission_error_rad": written.transmission_error_rad,
        "transmission_error_back_rad": float(np.ptp(written.back_rad)),
        **_by_tooth(designed.pushing, written.pushing_rad),
        **_greatest("from_design_max", "rad", astray, designed.placement),
        **_range("backlash", "rad", written.backlash_rad, designed.placement),
        **_penetration(written.overlap_mm, designed.placement),
        "clearance_driving_tips_mm": written.driving_tips_mm,
        "clearance_driven_tips_mm": written.driven_tips_mm,
    }


def _penetration(overlap_mm: Array, placement: Placement) -> dict[str, Any]:
    """The deepest overlap, its driving angle, and the teeth that then stand at the pitch point; None without any."""
    deepest = _greatest("penetration_max", "mm", overlap_mm, placement)
    driving, driven = placement.teeth_at(int(np.argmax(overlap_mm)))
    where = {"penetration_tooth_driving": driving, "penetration_tooth_driven": driven}
    if deepest["penetration_max_mm"] == 0.0:
        return {**deepest, "penetration_max_at_rad": None, **dict.fromkeys(where)}
    return {**deepest, **where}


def _range(name: str, unit: str, values: Array, placement: Placement) -> dict[str, Any]:
    return {
        **_at(f"{name}_min", unit, values, int(np.argmin(values)), placement),
        **_greatest(f"{name}_max", unit, values, placement),
    }


def _greatest(name: str, unit: str, values: Array, placement: Placement) -> dict[str, Any]:
    return _at(name, unit, values, int(np.argmax(values)), placement)


def _at(name: str, unit: str, values: Array, place: int, placement: Placement) -> dict[str, Any]:
    """A value over the positions, and the driving angle at which it is taken."""
    return {f"{name}_{unit}": float(values[place]), f"{name}_at_rad": float(placement.phi1_rad[place])}
