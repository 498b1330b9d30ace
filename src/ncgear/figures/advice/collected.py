"""All advices of a drive, in the order in which a design is worked out."""

from __future__ import annotations

from ncgear.figures.advice import law
from ncgear.figures.advice.values import Advice
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive


def check_advice(drive: Drive) -> tuple[Advice, ...]:
    """Advices that need no pitch curve."""
    ranges = [law.ratio_range(pair) for pair in drive.by_stage]
    return _given(*ranges, law.speeds(drive), law.negative_resistance(drive))


def build_advice(drive: Drive) -> tuple[Advice, ...]:
    """Advices about pitch curves, teeth and contact of one pair of gears; raises as the drive does."""
    # What makes teeth is slow to import, and a check has no need of it.
    from ncgear.figures.advice import teeth

    of_curves = [law.pressure_angle(drive), law.ring(drive), *(law.concave(drive, gear) for gear in Gear)]
    of_teeth = [teeth.undercut(drive), teeth.pointed(drive), *teeth.shortened(drive)]
    return _given(*of_curves, *of_teeth, teeth.contact_ratio(drive), teeth.thrust(drive))


def _given(*advices: Advice | None) -> tuple[Advice, ...]:
    return tuple(advice for advice in advices if advice is not None)
