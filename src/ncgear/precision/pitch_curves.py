"""The driving pitch curves that studies measure on, at unit centre distance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ncgear.numerics.arrays import Array
from ncgear.pitch import shape
from ncgear.pitch.shape import Gear, Mesh
from ncgear.precision import baler, exact_pitch
from ncgear.precision.exact import Real
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.transmission import Lobes, Transmission

DRIVING = Gear.DRIVING, Mesh.EXTERNAL

ECCENTRICITY = 0.5
"""i12 from 1/3 to 3."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A law's driving pitch curve, with its exact length and its exact curvatures at driving angles in rad."""

    name: str
    transmission: Transmission
    length: Callable[[], Real]
    curvature: Callable[[Array], Array]
    length_reference: str
    curvature_reference: str

    def radius(self, phi1: Array) -> Array:
        """Pitch radius, shape (n,)."""
        return shape.radius(self.transmission.driven_angle(phi1, 1).differentiated(), *DRIVING).value

    def speed(self, phi1: Array) -> Array:
        """Arc length per driving angle, shape (n,)."""
        return shape.speed(self.transmission.driven_angle(phi1, 2).differentiated(), *DRIVING).value


def of_ellipse() -> Curve:
    """One of two equal ellipses."""
    return Curve(
        f"ellipse of eccentricity {ECCENTRICITY:g}",
        elliptical_law(ECCENTRICITY, 0.0, Lobes()),
        lambda: exact_pitch.ellipse_length(ECCENTRICITY),
        lambda phi1: exact_pitch.ellipse_curvature(ECCENTRICITY, phi1),
        "4 a E(e), the complete elliptic integral in 50 digits",
        "the ellipse's closed form about a focus, in 50 digits",
    )


def of_baler() -> Curve:
    """The published baler's."""
    return Curve(
        "the baler",
        baler.law().transmission,
        exact_pitch.baler_length,
        exact_pitch.baler_curvature,
        "25-digit quadrature from joint to joint, of phi2 by the law of cosines and of the return's polynomial",
        "polar coordinates in 50 digits, of phi2 by the law of cosines and of the return's polynomial",
    )
