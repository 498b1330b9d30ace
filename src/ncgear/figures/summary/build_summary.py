"""All results of a build as plain values whose keys end in their unit, for summary.json and for the terminal.

The sections are those of a check, and pitch curves, teeth, contact and bodies of both gears.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from math import degrees, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned, SideContact
from ncgear.contact.designed.extremes import ContactExtremes, ValueRange
from ncgear.contact.designed.flanks import PairsInContact
from ncgear.contact.pair import PairContact
from ncgear.contact.written.as_written import AsWritten
from ncgear.contact.written.extremes import WrittenExtremes
from ncgear.errors import DesignError
from ncgear.figures.advice.verdict import Verdict
from ncgear.figures.data_sheet.entries import passed_summary
from ncgear.figures.data_sheet.measured_tables import play_figures, thickness_summary
from ncgear.figures.flanks import surfaces_figures
from ncgear.figures.numbers import known
from ncgear.figures.strong import strength_summary
from ncgear.figures.summary.check_summary import check_summary
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum, extreme
from ncgear.numerics.units import CM3_PER_MM3
from ncgear.pitch.pair import PitchPair
from ncgear.project.drive import Drive
from ncgear.project.figures import PITCH, figures_of
from ncgear.project.strengthening import known_rating
from ncgear.teeth.gear import ToothedGear, teeth_free_of_undercut
from ncgear.teeth.lost import shortening, undercutting
from ncgear.teeth.shifts import thickness_mm
from ncgear.teeth.tips import Limit

if TYPE_CHECKING:
    from ncgear.solids.mesh.pair import GearSolid

LEAST_JUMP = 1e-6
"""The least jump of curvature in the summary, times the centre distance.

Smooth joints differ by rounding, 1e-8 at most; others differ by 1e-3 and more.
"""


def build_summary(drive: Drive, contact: PairContact, verdict: Verdict) -> dict[str, Any]:
    """The summary of the check, and pitch curves, teeth, contact and bodies; files and timings are left empty."""
    summary = check_summary(drive, verdict)
    last = {key: summary.pop(key) for key in ("comparison", "warnings", "remarks", "verdict")}
    touching = contact_summary(contact, drive.contact_extremes)
    if drive.pairs_under_load is not None:
        touching |= figures_of(drive, "contact_ratio_under_load_mean", "contact_ratio_under_load_min")
    if drive.helix is not None:
        least = min(drive.section_contact_ratio, contact.as_designed.least_arc)
        touching["section_contact_ratio_min"] = least
        touching["overlap_ratio"] = drive.overlap_ratio
        touching["total_contact_ratio"] = least + drive.overlap_ratio
    summary |= {"pitch": pitch_summary(drive), "teeth": teeth_summary(drive), "contact": touching}
    if drive.thickness_band:
        summary["thickness"] = thickness_summary(drive)
    rating = known_rating(drive)
    if isinstance(rating, DesignError):
        summary["strength"] = {"refused": rating.problem}
    elif rating is not None:
        surfaces = surfaces_figures(drive.surfaces_by(rating.strength.method))
        summary["strength"] = {**strength_summary(rating, drive), **surfaces}
    summary |= _pumped(drive) | {"bodies": bodies_summary(drive)} | passed_summary(drive)
    return {**summary, "files": {}, **last, "timing_s": {}}


def with_files(
    summary: dict[str, Any], outline_errors_mm: Mapping[str, float], timing_s: Mapping[str, float]
) -> dict[str, Any]:
    """The summary once all files are made: how far outlines in files are from the exact ones, by the kinds of files,
    and how long each step took.
    """
    return {
        **summary,
        "files": {f"{kind}_outline_error_max_mm": error for kind, error in outline_errors_mm.items()},
        "timing_s": {step: round(seconds, 6) for step, seconds in timing_s.items()},
    }


def _pumped(drive: Drive) -> dict[str, Any]:
    """What the gears displace in their housing; nothing where the design has none."""
    found, radii = drive.pumped, drive.housing_radii_mm
    if found is None or radii is None:
        return {}
    per_minute = 1e-3 * CM3_PER_MM3 * drive.design.operation.speed_rpm
    flow = per_minute * 2.0 * pi
    return {
        "displacement": {
            "per_turn_cm3": CM3_PER_MM3 * found.per_turn_mm3,
            "mean_flow_l_min": per_minute * found.per_turn_mm3,
            **extreme("least_flow", "l_min", found.least, flow),
            **extreme("largest_flow", "l_min", found.most, flow),
            "pulsation_percent": 100.0 * found.pulsation,
            **{f"housing_bore_{gear.value}_mm": 2.0 * radius for gear, radius in radii.items()},
        }
    }


def pitch_summary(drive: Drive) -> dict[str, Any]:
    """Sizes, convexity, pressure angle, and the jumps of curvature."""
    return {**figures_of(drive, *PITCH), "curvature_jumps": _jumps(drive.pitch)}


def _jumps(pitch: PitchPair) -> list[dict[str, float]]:
    sides = [f"{gear}_{side}" for gear in ("driving", "driven") for side in ("before", "after")]
    found = []
    for jump in pitch.curvature_jumps():
        height = max(abs(jump.driving_after - jump.driving_before), abs(jump.driven_after - jump.driven_before))
        if height * pitch.center_distance_mm > LEAST_JUMP:
            found.append({"phi1_rad": jump.phi1_rad, **{f"{side}_1_mm": getattr(jump, side) for side in sides}})
    return found


DECIMALS = 9
"""Decimals of shifts that are told, in modules: what comes after is rounding."""


def teeth_summary(drive: Drive) -> dict[str, Any]:
    """Numbers, sizes, undercut, profile shifts, shortened tips.

    Of teeth with shifts of their own it tells those of each tooth, and their thickness on the pitch curve.  It does not
    tell then from how many teeth on none is undercut, which more teeth would lack.
    """
    teeth, size, toothed, rack, helix = drive.teeth, drive.pitch.size, drive.pitch.toothed, drive.rack, drive.helix
    both = {gear.flanks.curve.gear.value: gear for gear in (teeth.driving, teeth.driven)}
    found: dict[str, Any] = {"driving": size.driving_teeth, "driven": size.driven_teeth, "module_mm": size.module_mm}
    if toothed:
        found["pitches_in_range"] = toothed.covered_mm / rack.pitch_mm
    found |= play_figures(drive.play, *drive.play_range_rad)
    if helix is not None:
        found["helix_angle_deg"] = degrees(helix.angle_rad)
        found["helix_kind"] = "herringbone" if helix.herringbone else "helical"
        found["hand_driving"] = helix.hand
    found |= {f"undercut_{name}": gear.undercut for name, gear in both.items()}
    for name, gear in both.items():
        if gear.undercut:
            loss = undercutting(gear)
            found[f"most_undercut_{name}_um"] = 1e3 * loss.amount_mm
            found[f"most_undercut_{name}_tooth"] = loss.tooth
    own_shifts = teeth.driving.flanks.has_own_shifts
    if not own_shifts:
        racks = (gear.flanks.rack for gear in both.values())
        found["free_of_undercut_from_driving_teeth"] = teeth_free_of_undercut(drive.pitch, *racks)
    found |= {"method": drive.gears.method, "cutter": teeth.cutter.value}
    pushing, idle = map(degrees, rack.angles_rad)
    if pushing != idle:
        found |= {"rack_angle_pushing_deg": pushing, "rack_angle_idle_deg": idle}
    for name, gear in both.items():
        if not own_shifts:
            found[f"profile_shift_{name}_mm"] = gear.flanks.rack.shift_mm
            continue
        shift = (gear.flanks.full_tip_mm[::2] - rack.addendum_mm) / rack.module_mm
        shift_mm = rack.module_mm * np.round(shift, DECIMALS)
        found[f"profile_shift_{name}_mm"] = shift_mm.tolist()
        found[f"tooth_thickness_{name}_mm"] = thickness_mm(rack.module_mm, shift_mm, rack.angles_rad).tolist()
    found |= {f"tips_{name}": _tips(gear) for name, gear in both.items()}
    return found | {f"points_{name}": len(gear.outline_mm) for name, gear in both.items()}


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


def contact_summary(contact: PairContact, extremes: ContactExtremes) -> dict[str, Any]:
    """Figures of the contact as designed, with its extremes, and as written."""
    designed = contact.as_designed
    return {
        "positions": designed.placement.count,
        **({} if contact.repeated_teeth is None else {"teeth_repeat_every": contact.repeated_teeth}),
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
    """Figures of the contact of the exact teeth; the clearance over roots is None where no tip meets a root."""
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
        **{
            f"clearance_{gear}_tips{name}_mm": known(min(getattr(tips, key) for tips in both))
            for gear in ("driving", "driven")
            for both in [[getattr(side, f"{gear}_tips") for side in (pushing, back)]]
            for name, key in (("", "over_root_mm"), ("_from_fillets", "from_fillet_mm"))
        },
    }


def _between(name: str, unit: str, found: ValueRange, factor: float = 1.0) -> dict[str, Any]:
    """The least and the greatest value, each with its driving angle."""
    low, high = (
        extreme(f"{name}_{end}", unit, extremum, factor) for end, extremum in (("min", found.low), ("max", found.high))
    )
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
    found: dict[str, Any] = {"volume_mm3": solid.mesh.volume, "height_mm": plan.height_mm}
    if plan.bore:
        found["bore_mm"] = plan.bore.diameter_mm
    if plan.hub:
        found |= {"hub_diameter_mm": plan.hub.diameter_mm, "hub_height_mm": plan.hub.height_mm}
        if (screw := plan.hub.set_screw) is not None:
            sizes = {"diameter_mm": screw.diameter_mm, "height_mm": screw.height_mm}
            found["set_screw"] = sizes | {"direction_deg": degrees(screw.direction_rad)}
    if plan.web is not None:
        found["web_mm"] = plan.web.thickness_mm
        found["pocket_areas_mm2"] = [float(pocket.area) for pocket in plan.web.pockets]
    if plan.crank_pin is not None:
        found["crank_pin_hole"] = asdict(plan.crank_pin)
    if plan.lightening_holes:
        found["lightening_holes"] = [asdict(hole) for hole in plan.lightening_holes]
    if plan.slot is not None:
        found |= {"end_stop_slot_width_mm": plan.slot.width_mm, "end_stop_slot_radius_mm": plan.slot.radius_mm}
    return found
