"""The figures of a single design as in a check and a build, and their keys, which many designs at once have too."""

from __future__ import annotations

from ncgear.design.keys.design import Design
from ncgear.design.mechanisms import entry_of
from ncgear.kinematics.check import OF_MASSES, peak_figures
from ncgear.project.drive import Drive
from ncgear.project.figures import PITCH, figures_of
from ncgear.project.tooth_form import require_pushing_flanks

WITH_MASSES = tuple(f"check.{key}" for key in OF_MASSES if not key.endswith("_at_rad"))
"""Keys of the figures that only designs with masses have."""


NO_NUMBERS = ("mesh", "concave", "_at_rad")
"""Parts of the keys of pitch curves' values that are not numbers of every pair."""

CURVES = tuple(key for key in PITCH if not any(word in key for word in NO_NUMBERS))
"""Keys of the numbers of a pair of pitch curves."""


def single_figures(design: Design) -> dict[str, float]:
    """All figures of a design; raises WrongInput or NoSuchMechanism where it cannot be made."""
    drive = Drive(design)
    if design.gears is not None and design.gears.idlers is not None:
        _ = drive.row
    low, high = drive.transmission.ratio_range
    # With two stages each pair has its own curves, and only a build distinguishes them.  Whether teeth can roll on the
    # curves is tested before the peaks of the motion, which take longest.
    pitch = _pitch(drive) if _has_pitch(design) else {}
    return {
        "drive.law_speed_rpm": drive.law_speed_rpm,
        "closure.residual_rad": abs(drive.transmission.closure_error_rad),
        **{f"closure.{key}": value for key, value in drive.told_stroke_residual.items()},
        "ratio.min": low.value,
        "ratio.max": high.value,
        **{f"check.{key}": value for key, value in peak_figures(drive.check).items() if not key.endswith("_at_rad")},
        **pitch,
    }


def _has_pitch(design: Design) -> bool:
    return design.gears is not None and design.stages == 1


def _pitch(drive: Drive) -> dict[str, float]:
    require_pushing_flanks(drive.pitch, drive.gears.rack)
    return {f"pitch.{key}": float(value) for key, value in figures_of(drive, *CURVES).items()}


def figure_names(design: Design) -> tuple[str, ...]:
    """The keys of the figures of a design, and of designs with other numbers, in their order."""
    mechanism = entry_of(design.linkage).load()
    output = mechanism.OUTPUT
    stroke = (f"closure.stroke_residual_{output.place.ending}",) if mechanism.RETURNS else ()
    names = (
        "drive.law_speed_rpm",
        "closure.residual_rad",
        *stroke,
        "ratio.min",
        "ratio.max",
        "check.peak_power_w",
        *(() if Drive(design).masses_left_out else WITH_MASSES),
        "check.mean_power_w",
        f"check.peak_speed_{output.speed.ending}",
        f"check.peak_acceleration_working_{output.acceleration.ending}",
        f"check.peak_acceleration_cycle_{output.acceleration.ending}",
    )
    return (*names, *(f"pitch.{key}" for key in CURVES)) if _has_pitch(design) else names
