"""All that a build finds, as plain values: what summary.json holds and reports print."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ncgear.drive import Drive
from ncgear.output.advice.collected import build_advice

if TYPE_CHECKING:
    from ncgear.contact.pair_contact import PairContact
from ncgear.output.summary.check import check_summary


def build_summary(drive: Drive, contact: PairContact) -> dict[str, Any]:
    """All of the check, and pitch curves, teeth, contact and bodies."""
    from ncgear.output.summary.bodies import bodies_summary
    from ncgear.output.summary.contact import contact_summary
    from ncgear.output.summary.pitch import pitch_summary
    from ncgear.output.summary.teeth import teeth_summary

    summary = check_summary(drive)
    comparison, warnings = summary.pop("comparison"), summary.pop("warnings")
    return {
        **summary,
        "pitch": pitch_summary(drive),
        "teeth": teeth_summary(drive),
        "contact": {**contact_summary(contact, drive.pair_speed_rad_s), **_overlap(drive, contact)},
        "bodies": bodies_summary(drive),
        "comparison": comparison,
        "warnings": warnings + [advice.line for advice in build_advice(drive)],
        "timing_s": {stage: round(seconds, 6) for stage, seconds in drive.timing_s.items()},
    }


def _overlap(drive: Drive, contact: PairContact) -> dict[str, float]:
    """What the advance of helical teeth adds to the least contact ratio of their sections."""
    if drive.helix is None:
        return {}
    least = min(drive.section_contact_ratio, contact.contact_ratio)
    return {
        "section_contact_ratio_min": least,
        "overlap_ratio": drive.overlap_ratio,
        "total_contact_ratio": least + drive.overlap_ratio,
    }
