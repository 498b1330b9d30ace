"""All advices of a drive, in the order in which a design is worked out."""

from __future__ import annotations

from ncgear.figures.advice import law as motion
from ncgear.figures.advice.values import Advice
from ncgear.project.drive import Drive


def check_advice(drive: Drive) -> tuple[Advice, ...]:
    """Advices that need no pitch curve."""
    ranges = [motion.ratio_range(pair) for pair in drive.by_stage]
    return _given(*ranges, motion.speeds(drive), motion.negative_resistance(drive))


def build_advice(drive: Drive) -> tuple[Advice, ...]:
    """Advices about pitch curves, teeth and contact of one pair of gears; raises as the drive's stages do."""
    from ncgear.figures.advice import law as curves
    from ncgear.figures.advice import teeth
    from ncgear.figures.advice import teeth as contact
    from ncgear.pitch.shape import Gear

    of_curves = [curves.pressure_angle(drive), curves.ring(drive), *(curves.concave(drive, gear) for gear in Gear)]
    of_teeth = [teeth.undercut(drive), teeth.pointed(drive), *teeth.shortened(drive)]
    return _given(*of_curves, *of_teeth, contact.contact_ratio(drive), contact.thrust(drive))


def _given(*advices: Advice | None) -> tuple[Advice, ...]:
    return tuple(advice for advice in advices if advice is not None)
