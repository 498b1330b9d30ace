"""A pitch curve that is known by its points: the curve of a gear whose mate's axis moves.

Two gears of any motion roll on each other's centrodes: the paths of their instantaneous centre in the frame of each.
Flanks need only the centrodes, so teeth stand on them as on the curves of a law.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.plane import across, as_points
from ncgear.pitch.arc_length import ArcMaps, arc_maps, too_sharp
from ncgear.pitch.curve import ClosedPitchCurve, CurvePoints, outside
from ncgear.pitch.shape import Gear, Mesh

Path = Callable[[Array], tuple[ComplexArray, ComplexArray, ComplexArray]]
"""Function of driving angles in rad, shape (n,), that gives points in mm as complex numbers and two derivatives."""


TRIED = 1024
"""Steps per lobe in the test of a curve for cusps: a curve that turns by over 90 deg in a step bears no tooth, and its
arc length cannot be inverted beside the cusp."""


@dataclass(frozen=True, eq=False)
class RolledCurve(ClosedPitchCurve):
    """A closed pitch curve of ``lobes`` equal lobes; ``path`` gives its points by the driving angle.

    With growing angle it runs clockwise on the driving gear and on a ring, against the clock on other gears.
    ``turning`` is the sum of its own and its mate's curvature in 1/mm at driving angles.
    """

    gear: Gear
    mesh: Mesh
    arc: ArcMaps
    lobes: int
    path: Path
    turning: Callable[[Array], Array]
    starts_rad: Array

    @property
    def periods(self) -> int:
        """Lobes of the curve."""
        return self.lobes

    @property
    def unit_mm(self) -> float:
        """Arc lengths are in mm."""
        return 1.0

    @property
    def joints_rad(self) -> Array:
        """Driving angles within one lobe, 0 first, at which smooth pieces begin."""
        return self.starts_rad

    def at_angle(self, phi1: Array) -> CurvePoints:
        """The curve at driving angles in rad, of any shape."""
        point, slope, bend = (coordinates.reshape(np.shape(phi1)) for coordinates in self.path(np.ravel(phi1)))
        tangent = slope / np.abs(slope)
        side = outside(self.gear)
        curvature = -side * across(slope, bend) / np.abs(slope) ** 3
        return CurvePoints(as_points(point), as_points(tangent), side, curvature)

    def mate_curvature(self, sigma_mm: float) -> float:
        """Curvature in 1/mm of the mate beside the curve, positive where the mate is convex."""
        sigma = np.array([sigma_mm])
        return float(self.turning(self.driving_angle(sigma))[0] - self.at_length(sigma).curvature[0])


def rolled_curve(
    gear: Gear, mesh: Mesh, lobes: int, breaks_rad: Array, path: Path, turning: Callable[[Array], Array]
) -> RolledCurve:
    """The curve of smooth pieces between driving angles, 0 first, the lobe's end last; raises as ``arc_maps``."""
    tried = np.linspace(breaks_rad[0], breaks_rad[-1], TRIED + 1)
    slope = path(tried)[1]
    turns_back = (slope[1:] * slope[:-1].conj()).real <= 0.0
    if turns_back.any():
        raise too_sharp(float(tried[np.argmax(turns_back)]), "a smaller range of the distances, or of the ratio,")
    arc = arc_maps(lambda phi1: np.abs(path(phi1)[1]), breaks_rad)
    return RolledCurve(gear, mesh, arc, lobes, path, turning, breaks_rad[:-1])


def circle(gear: Gear, mesh: Mesh, radius_mm: float, mate_curvature: float) -> RolledCurve:
    """A round gear's pitch circle by its angle, touching at 0 where its mate is; ``mate_curvature`` is for messages."""
    turn = -1j if gear is Gear.DRIVING else 1j

    def path(angle: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        point = -radius_mm * np.exp(turn * angle)
        return point, turn * point, -point

    total = 1.0 / radius_mm + mate_curvature
    return rolled_curve(
        gear, mesh, 1, np.array([0.0, 2.0 * np.pi]), path, lambda angle: np.full(np.shape(angle), total)
    )
