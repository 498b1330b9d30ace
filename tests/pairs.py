"""Racks and laws that several tests cut teeth with."""

from __future__ import annotations

from math import radians

from drives import drive
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.form import BasicRack


def rack(
    angle_deg: float = 20.0,
    addendum: float = 1.0,
    dedendum: float = 1.25,
    root_radius: float = 0.38,
    backlash_mm: float = 0.0,
    *,
    module: float = 2.0,
) -> BasicRack:
    """A rack from its coefficients; ISO 53 profile A when nothing is said."""
    sizes = (addendum * module, dedendum * module, root_radius * module)
    return BasicRack(module, radians(angle_deg), *sizes, backlash_mm)


def sine_law(depth: float, lobes: Lobes | None = None) -> Transmission:
    """phi2 = phi1 - depth sin 2 phi1."""
    return driven_angle_expression_law(f"phi - {depth}*sin(2*phi)", lobes or Lobes())


def baler_law() -> Transmission:
    """The published baler's law."""
    return drive("baler").transmission
