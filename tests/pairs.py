"""Racks and laws that several tests cut teeth with."""

from __future__ import annotations

from math import radians
from typing import Any

from drives import drive
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.form import BasicRack
from ncgear.teeth.gear import ToothedGear, ToothedPair
from ncgear.teeth.outline import ChordTolerance, outline_points


def rack(
    angle_deg: float = 20.0,
    addendum: float = 1.0,
    dedendum: float = 1.25,
    root_radius: float = 0.38,
    *,
    module: float = 2.0,
) -> BasicRack:
    """A rack from its coefficients; ISO 53 profile A when nothing is said."""
    sizes = (addendum * module, dedendum * module, root_radius * module)
    return BasicRack(module, radians(angle_deg), *sizes)


def sine_law(depth: float, lobes: Lobes | None = None) -> Transmission:
    """phi2 = phi1 - depth sin 2 phi1."""
    return driven_angle_expression_law(f"phi - {depth}*sin(2*phi)", lobes or Lobes())


def baler_law() -> Transmission:
    """The published baler's law."""
    return drive("baler").transmission


def pitch_pair(law: Transmission, teeth: int) -> PitchPair:
    """Pitch curves of module 2 for so many driving teeth."""
    return sized_pair(law, teeth, 2.0, None)


def exact_ring(gear: ToothedGear, tolerance_mm: float) -> Array:
    """A gear's outline by chords so fine that it stands for the exact curves, shape (n, 2)."""
    return outline_points(gear.tips, gear.sides, ChordTolerance(tolerance_mm, tolerance_mm))


def one_of(pair: Any, gear: Gear) -> Any:
    """What a pair of pitch curves, toothed gears or solids has for one gear."""
    return pair.driving if gear is Gear.DRIVING else pair.driven


def both(pair: ToothedPair) -> tuple[ToothedGear, ToothedGear]:
    """The driving and the driven gear."""
    return pair.driving, pair.driven
