"""All results of a build as plain values whose keys end in their unit, for summary.json and for the terminal.

The sections are those of a check, and pitch curves, teeth, contact and bodies of both gears.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from math import degrees, pi, radians
from typing import TYPE_CHECKING, Any

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned, SideContact
from ncgear.contact.designed.extremes import ContactExtremes, Range
from ncgear.contact.designed.flanks import PairsInContact
from ncgear.contact.pair import PairContact
from ncgear.contact.written.as_written import AsWritten
from ncgear.contact.written.extremes import WrittenExtremes
from ncgear.errors import DesignError
from ncgear.figures.advice.verdict import Verdict
from ncgear.figures.data_sheet.entries import passed_summary
from ncgear.figures.flanks import surfaces_figures
from ncgear.figures.numbers import known
from ncgear.figures.quantities import extreme
from ncgear.figures.strong import strength_summary
from ncgear.figures.summary.check_summary import check_summary
from ncgear.figures.thickness import play_figures, thickness_summary
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.units import CM3_PER_MM3
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.strengthening import known_rating
from ncgear.teeth.gear import ToothedGear, teeth_free_of_undercut
from ncgear.teeth.lost import shortening, undercutting
from ncgear.teeth.shifts import thickness_mm
from ncgear.teeth.tips import Limit

if TYPE_CHECKING:
    from ncgear.solids.mesh.pair import GearSolid
    from ncgear.solids.plan.body import BodyPlan, Hub

LEAST_JUMP = 1e-6
"""The least jump of curvature in the summary, times the centre distance.

Smooth joints differ by rounding, 1e-8 at most; others differ by 1e-3 and more.
"""


def build_summary(drive: Drive, contact: PairContact, verdict: Verdict) -> dict[str, Any]:
    """The summary of the check, and pitch curves, teeth, contact and bodies; files and timings are left empty."""
    summary = check_summary(drive, verdict)
    last = {key: summary.pop(key) for key in ("comparison", "warnings", "remarks", "verdict")}
    return {
        **summary,
        "pitch": pitch_summary(drive),
        "teeth": teeth_summary(drive),
        "contact": {
            **contact_summary(contact, drive.contact_extremes),
            **_under_load(drive),
            **_overlap(drive, contact),
        },
        **({"thickness": thickness_summary(drive)} if drive.thickness_band else {}),
        **_strength(drive),
        **_pumped(drive),
        "bodies": bodies_summary(drive),
        **passed_summary(drive),
        "files": {},
        **last,
        "timing_s": {},
    }


def with_files(
    summary: dict[str, Any], outline_errors_mm: Mapping[str, float], timing_s: Mapping[str, float]
) -> dict[str, Any]:
    """The summary with what is known once all files are made: how far outlines in them are from the exact ones, by
    the kinds of files, and how long each step took.
    """
    return {
        **summary,
        "files": {f"{kind}_outline_error_max_mm": error for kind, error in outline_errors_mm.items()},
        "timing_s": {step: round(seconds, 6) for step, seconds in timing_s.items()},
    }


def _strength(drive: Drive) -> dict[str, Any]:
    """The section of strength: nothing where no load is known, and the refusal where there is one."""
    rating = known_rating(drive)
    if isinstance(rating, DesignError):
        return {"strength": {"refused": rating.problem}}
    if rating is None:
        return {}
    return {
        "strength": {**strength_summary(rating, drive), **surfaces_figures(drive.surfaces_by(rating.strength.method))}
    }


L_PER_MM3 = 1e-3 * CM3_PER_MM3


def _pumped(drive: Drive) -> dict[str, Any]:
    """What the gears displace in their housing; nothing where the design has none."""
    found, radii = drive.pumped, drive.housing_radii_mm
    if found is None or radii is None:
        return {}
    per_minute = L_PER_MM3 * drive.design.operation.speed_rpm
    return {
        "displacement": {
            "per_turn_cm3": CM3_PER_MM3 * found.per_turn_mm3,
            "mean_flow_l_min": per_minute * found.per_turn_mm3,
            "least_flow_l_min": per_minute * 2.0 * pi * found.least.value,
            "least_flow_at_rad": found.least.at,
            "largest_flow_l_min": per_minute * 2.0 * pi * found.most.value,
            "largest_flow_at_rad": found.most.at,
            "pulsation_percent": 100.0 * found.pulsation,
            **{f"housing_bore_{gear.value}_mm": 2.0 * radius for gear, radius in radii.items()},
        }
    }


def _under_load(drive: Drive) -> dict[str, float]:
    """The contact ratio under load, where a load is known that brings more flanks into contact."""
    sides = drive.pairs_under_load
    if sides is None:
        return {}
    return {
        "contact_ratio_under_load_mean": min(pairs.contact_ratio for pairs in sides),
        "contact_ratio_under_load_min": min(pairs.least_arc for pairs in sides),
    }


def _overlap(drive: Drive, contact: PairContact) -> dict[str, float]:
    """The contact ratio of helical teeth: the least one of their sections, the overlap, and the sum."""
    if drive.helix is None:
        return {}
    least = min(drive.section_contact_ratio, contact.as_designed.least_arc)
    return {
        "section_contact_ratio_min": least,
        "overlap_ratio": drive.overlap_ratio,
        "total_contact_ratio": least + drive.overlap_ratio,
    }


def pitch_summary(drive: Drive) -> dict[str, Any]:
    """Sizes, convexity, pressure angle, and the jumps of curvature."""
    pitch = drive.pitch
    result: dict[str, Any] = {"mesh": pitch.mesh.value, "center_distance_mm": pitch.center_distance_mm}
    for gear in Gear:
        name = gear.value
        result[f"length_{name}_mm"] = pitch.length_mm(gear)
        result[f"{name}_convex"] = pitch.convex(gear)
        result[f"min_radius_{name}_mm"] = pitch.least_radius_mm(gear)
        result[f"min_concave_radius_{name}_mm"] = pitch.least_concave_radius_mm(gear)
        result[f"concave_{name}_rad"] = [list(stretch) for stretch in pitch.concave_ranges(gear)]
    tangent = pitch.largest_tangent_angle_rad
    result["max_tangent_angle_deg"] = degrees(tangent.value)
    result["max_pressure_angle_deg"] = pitch.largest_pressure_angle_deg(radians(drive.gears.carrying_angle_deg))
    result["max_pressure_angle_at_rad"] = tangent.at
    result["curvature_jumps"] = _jumps(pitch)
    return result


def _jumps(pitch: PitchPair) -> list[dict[str, float]]:
    """The places where the curvature of a gear jumps."""
    found = []
    for jump in pitch.curvature_jumps():
        height = max(abs(jump.driving_after - jump.driving_before), abs(jump.driven_after - jump.driven_before))
        if height * pitch.center_distance_mm > LEAST_JUMP:
            found.append(
                {
                    "phi1_rad": jump.phi1_rad,
                    "driving_before_1_mm": jump.driving_before,
                    "driving_after_1_mm": jump.driving_after,
                    "driven_before_1_mm": jump.driven_before,
                    "driven_after_1_mm": jump.driven_after,
                }
            )
    return found


def teeth_summary(drive: Drive) -> dict[str, Any]:
    """Numbers, sizes, undercut, shortened tips."""
    teeth, size, toothed = drive.teeth, drive.pitch.size, drive.pitch.toothed
    return {
        "driving": size.driving_teeth,
        "driven": size.driven_teeth,
        "module_mm": size.module_mm,
        **({"pitches_in_range": toothed.covered_mm / drive.rack.pitch_mm} if toothed else {}),
        **play_figures(drive.play, *drive.play_range_rad),
        **_helix(drive),
        "undercut_driving": teeth.driving.undercut,
        "undercut_driven": teeth.driven.undercut,
        **_undercut_depth(teeth.driving),
        **_undercut_depth(teeth.driven),
        **_free_of_undercut(drive),
        "method": drive.gears.method,
        "cutter": teeth.cutter.value,
        **_flank_angles(drive),
        **_shifts(drive),
        "tips_driving": _tips(teeth.driving),
        "tips_driven": _tips(teeth.driven),
        "points_driving": len(teeth.driving.outline_mm),
        "points_driven": len(teeth.driven.outline_mm),
    }


def _free_of_undercut(drive: Drive) -> dict[str, Any]:
    """From how many teeth on none is undercut; nothing where teeth have shifts of their own, which more would lack."""
    driving, driven = drive.teeth.driving.flanks, drive.teeth.driven.flanks
    if driving.has_own_shifts:
        return {}
    return {"free_of_undercut_from_driving_teeth": teeth_free_of_undercut(drive.pitch, driving.rack, driven.rack)}


DECIMALS = 9
"""Decimals of shifts that are told, in modules: what comes after is rounding."""


def _flank_angles(drive: Drive) -> dict[str, Any]:
    pushing, idle = map(degrees, drive.rack.angles_rad)
    return {} if pushing == idle else {"rack_angle_pushing_deg": pushing, "rack_angle_idle_deg": idle}


def _shifts(drive: Drive) -> dict[str, Any]:
    """Profile shifts; of teeth with shifts of their own those of each tooth, and their thickness on the pitch curve."""
    rack, result = drive.rack, {}
    for gear in (drive.teeth.driving, drive.teeth.driven):
        name, flanks = gear.flanks.curve.gear.value, gear.flanks
        if not drive.teeth.driving.flanks.has_own_shifts:
            result[f"profile_shift_{name}_mm"] = flanks.rack.shift_mm
            continue
        shift = rack.module_mm * np.round((flanks.full_tip_mm[::2] - rack.addendum_mm) / rack.module_mm, DECIMALS)
        result[f"profile_shift_{name}_mm"] = shift.tolist()
        result[f"tooth_thickness_{name}_mm"] = thickness_mm(rack.module_mm, shift, rack.angles_rad).tolist()
    return result


def _tips(gear: ToothedGear) -> dict[str, Any]:
    """Least height of the tips, how much they are shortened at most, and the teeth with shortened tips by reason."""
    result: dict[str, Any] = {"least_height_mm": float(gear.flanks.tip_height_mm[gear.flanks.is_made].min())}
    for reason in Limit:
        if reason is not Limit.FULL and (numbers := gear.shortened(reason)):
            result[f"shortened_for_{reason.name.lower()}"] = numbers
    marked = gear.tips.limit != Limit.FULL
    if marked.any():
        loss = shortening(gear, marked)
        result.update(most_shortened_um=1e3 * loss.amount_mm, most_shortened_tooth=loss.tooth)
    return result


def _undercut_depth(gear: ToothedGear) -> dict[str, Any]:
    """How much of a flank's depth is undercut at most, as in ``undercutting``, and at which tooth."""
    if not gear.undercut:
        return {}
    loss, name = undercutting(gear), gear.flanks.curve.gear.value
    return {f"most_undercut_{name}_um": 1e3 * loss.amount_mm, f"most_undercut_{name}_tooth": loss.tooth}


def _helix(drive: Drive) -> dict[str, Any]:
    helix = drive.helix
    if helix is None:
        return {}
    kind = "herringbone" if helix.herringbone else "helical"
    return {"helix_angle_deg": degrees(helix.angle_rad), "helix_kind": kind, "hand_driving": helix.hand}


def contact_summary(contact: PairContact, extremes: ContactExtremes) -> dict[str, Any]:
    """Figures of the contact as designed, with its extremes, and as written."""
    designed = contact.as_designed
    return {
        "positions": designed.placement.count,
        "transmission_error_rad": contact.transmission_error_rad,
        "contact_ratio_mean": designed.contact_ratio,
        "contact_ratio_min": designed.least_arc,
        "penetration_max_mm": contact.penetration_mm,
        "as_designed": designed_contact(designed, extremes),
        "as_written": {
            written.source: _as_written(written, found, designed)
            for written, found in zip(contact.as_written, contact.extremes, strict=True)
        },
    }


def designed_contact(designed: AsDesigned, extremes: ContactExtremes) -> dict[str, Any]:
    """Figures of the contact of the exact teeth, each with its unit at the end of its key."""
    pushing, back = designed.pushing, designed.back
    return {
        "transmission_error_rad": extremes.pushing_error_rad.width,
        "transmission_error_back_rad": extremes.back_error_rad.width,
        **_by_tooth(pushing, pushing.error_rad),
        **_between("backlash", "rad", extremes.backlash_rad),
        **_ratios(pushing.pairs, ""),
        **_ratios(back.pairs, "_back"),
        **extreme("sliding_velocity_max", "mm_s", extremes.sliding_mm_s),
        **_between("pressure_angle", "deg", extremes.pushing_pressure_angle_rad, degrees(1.0)),
        **_between("pressure_angle_back", "deg", extremes.back_pressure_angle_rad, degrees(1.0)),
        **_deepest(extremes.overlap_mm, extremes.overlap_teeth),
        **_clearances(designed),
    }


def _between(name: str, unit: str, found: Range, factor: float = 1.0) -> dict[str, Any]:
    """The least and the greatest value, each with its driving angle."""
    low, high = (extreme(f"{name}_{end}", unit, one, factor) for end, one in (("min", found.low), ("max", found.high)))
    return {**low, **high}


def _by_tooth(side: SideContact, error_rad: Array) -> dict[str, Any]:
    by_tooth = side.variation_by_tooth(error_rad)
    return {"transmission_error_by_tooth_at_positions_rad": [by_tooth[tooth] for tooth in sorted(by_tooth)]}


def _ratios(pairs: PairsInContact, suffix: str) -> dict[str, Any]:
    """The contact ratio: mean number of pairs of flanks that touch, and least arc of any pair in pitches."""
    return {
        f"contact_ratio{suffix}_mean": pairs.contact_ratio,
        f"contact_ratio{suffix}_min": pairs.least_arc,
        f"pairs_in_contact{suffix}_min": pairs.fewest,
    }


def _clearances(designed: AsDesigned) -> dict[str, Any]:
    """The least clearances of the tips; the one over roots is None where no tip meets a root of the other gear."""
    least = {}
    for gear in ("driving", "driven"):
        both = [getattr(side, f"{gear}_tips") for side in (designed.pushing, designed.back)]
        over_root = min(tips.over_root_mm for tips in both)
        least[f"clearance_{gear}_tips_mm"] = known(over_root)
        least[f"clearance_{gear}_tips_from_fillets_mm"] = min(tips.from_fillet_mm for tips in both)
    return least


def _as_written(written: AsWritten, extremes: WrittenExtremes, designed: AsDesigned) -> dict[str, Any]:
    return {
        "transmission_error_rad": extremes.transmission_error_rad,
        "transmission_error_back_rad": extremes.back_rad.width,
        **_by_tooth(designed.pushing, written.pushing_rad),
        **extreme("from_design_max", "rad", extremes.from_design_rad),
        **_between("backlash", "rad", extremes.backlash_rad),
        **_deepest(extremes.overlap_mm, extremes.overlap_teeth),
        **{
            f"clearance_{gear}_tips_mm": known(clearance)
            for gear, clearance in (("driving", written.driving_tips_mm), ("driven", written.driven_tips_mm))
        },
    }


def _deepest(overlap_mm: Extremum, teeth: tuple[int, int]) -> dict[str, Any]:
    """The deepest overlap, its driving angle, and the teeth at the pitch point there; None without an overlap."""
    deepest = extreme("penetration_max", "mm", overlap_mm)
    where = {"penetration_tooth_driving": teeth[0], "penetration_tooth_driven": teeth[1]}
    if overlap_mm.value == 0.0:
        return {**deepest, "penetration_max_at_rad": None, **dict.fromkeys(where)}
    return {**deepest, **where}


def bodies_summary(drive: Drive) -> dict[str, Any]:
    """Both bodies as written, and the lag of the driven gear if parts come out exactly as written.

    A process that adds material as thick as its clearance leaves the gears as designed.  A process that adds none
    leaves a gap of two clearances along the normal.  The largest lag is this gap divided by the lever of the force.
    A negative clearance is half a kerf: what is written is larger than the gears, and does not go together uncut.
    """
    clearance, solids = drive.gears.process_clearance_mm, drive.solids
    lever_mm = drive.contact_extremes.least_lever_mm.value
    return {
        "process_clearance_mm": clearance,
        **(
            {"kerf_mm": -2.0 * clearance}
            if clearance < 0.0
            else {"lag_max_without_process_rad": 2.0 * clearance / lever_mm}
        ),
        "first_layer_chamfer_mm": drive.gears.first_layer_chamfer_mm,
        "driving": _body(solids.driving),
        "driven": _body(solids.driven),
    }


def _body(solid: GearSolid) -> dict[str, Any]:
    plan = solid.plan
    return {
        "volume_mm3": solid.mesh.volume,
        "height_mm": plan.height_mm,
        **({"bore_mm": plan.bore.diameter_mm} if plan.bore else {}),
        **(_hub(plan.hub) if plan.hub else {}),
        **_cuts(plan),
    }


def _hub(hub: Hub) -> dict[str, Any]:
    found: dict[str, Any] = {"hub_diameter_mm": hub.diameter_mm, "hub_height_mm": hub.height_mm}
    if hub.set_screw is not None:
        screw = hub.set_screw
        found["set_screw"] = {
            "diameter_mm": screw.diameter_mm,
            "height_mm": screw.height_mm,
            "direction_deg": degrees(screw.direction_rad),
        }
    return found


def _cuts(plan: BodyPlan) -> dict[str, Any]:
    found: dict[str, Any] = {}
    if plan.web is not None:
        found["web_mm"] = plan.web.thickness_mm
        found["pocket_areas_mm2"] = [float(pocket.area) for pocket in plan.web.pockets]
    if plan.crank_pin is not None:
        found["crank_pin_hole"] = asdict(plan.crank_pin)
    if plan.lightening_holes:
        found["lightening_holes"] = [asdict(hole) for hole in plan.lightening_holes]
    if plan.slot is not None:
        found["end_stop_slot_width_mm"] = plan.slot.width_mm
        found["end_stop_slot_radius_mm"] = plan.slot.radius_mm
    return found
