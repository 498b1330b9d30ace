"""Advices about the law, the speeds and the resistance."""

from __future__ import annotations

from math import degrees

from ncgear.design.motion import ThreeSegmentStroke
from ncgear.drive import Drive
from ncgear.output.advice.gentler import optimised, tempered
from ncgear.output.advice.values import Advice, Change, Kind, Remedy, Where
from ncgear.ratio.transmission import Transmission

WIDEST_RATIO = 5.0
"""Ratio, or its inverse, beyond which the smaller gear's pitch radius is under a sixth of the centre distance."""

SAME_SPEED = 1e-3
"""Relative difference of two speeds that no slider's reader notices: 1 mm/s in a metre per second."""


def ratio_range(drive: Drive) -> Advice | None:
    """A ratio beyond what gears can follow well; of two stages, of the one that the drive is."""
    low, high = drive.pair.transmission.ratio_range
    if not _too_wide(drive.pair.transmission):
        return None
    return Advice(
        Kind.RATIO_RANGE,
        (Where(angles_deg=tuple((degrees(end.at),) * 2 for end in (low, high))),),
        f"the ratio runs from {low.value:.3g} (at {degrees(low.at):.4g} deg) to {high.value:.3g} (at "
        f"{degrees(high.at):.4g} deg)",
        f"beyond 1:{WIDEST_RATIO:g} one gear has almost no radius where the other is large: few teeth carry there, and "
        "the shaft of the small side is thin",
        (*_wider_return(drive), *tempered(drive, _too_wide), _within_widest(drive)),
    )


def _within_widest(drive: Drive) -> Remedy:
    return optimised(drive, ratio_min=1.0 / WIDEST_RATIO, ratio_max=WIDEST_RATIO)


def _too_wide(transmission: Transmission) -> bool:
    low, high = transmission.ratio_range
    return low.value < 1.0 / WIDEST_RATIO or high.value > WIDEST_RATIO


def _wider_return(drive: Drive) -> tuple[Remedy, ...]:
    if not isinstance(drive.design.motion, ThreeSegmentStroke):
        return ()
    return (Remedy("move theta4, or change a1 or the speed at which a1 is stated (a1_speed_rpm), in small steps"),)


def speeds(drive: Drive) -> Advice | None:
    """A machine that runs at another speed than its law holds at."""
    operating, law = drive.design.operation.speed_rpm, drive.law_speed_rpm
    if abs(operating / law - 1.0) < SAME_SPEED:
        return None
    factor, sense = (law / operating, "slower") if law > operating else (operating / law, "faster")
    return Advice(
        Kind.SPEEDS,
        (Where(),),
        f"the law's velocities hold at {law:.5g} r/min, but the machine runs at {operating:g} r/min",
        f"there the slider is {factor:.3g} times {sense} than v1 and v2 say",
        (Remedy("run the machine at the law's speed", (Change("operation.speed_rpm", law),)),),
    )


def negative_resistance(drive: Drive) -> Advice | None:
    """A resistance that would drive the slider somewhere."""
    resistance = drive.machine.resistance
    stretches = resistance.negative_stretches_mm(drive.linkage.stroke_mm)
    if not stretches:
        return None
    named = ", ".join(f"{low:.3g}..{high:.3g}" for low, high in stretches)
    kept = resistance.keep_negative
    other = "take it as zero there" if kept else "count it, where the load really pulls the slider"
    return Advice(
        Kind.NEGATIVE_RESISTANCE,
        (Where(),),
        f"the resistance is negative for displacements of {named} mm",
        "it is kept, so that it drives the slider" if kept else "it is taken as zero there",
        (
            Remedy("give a resistance that is nowhere under zero, as a table or a formula"),
            Remedy(other, (Change("resistance.where_negative", "zero" if kept else "keep"),)),
        ),
    )
