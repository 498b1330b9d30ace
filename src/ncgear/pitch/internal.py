"""Conditions on a law whose driven gear is a ring with its teeth inside."""

from __future__ import annotations

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.highest import largest_of_each
from ncgear.numerics.plane import as_complex
from ncgear.numerics.units import in_words
from ncgear.pitch.curve import PitchCurve
from ncgear.ratio.transmission import Lobes, Transmission

LEAST_RATIO = 1.001
"""Ratio below which no internal gear is made: the pitch radii would be a thousand centre distances.  Each module of
centre distance then needs 2000 teeth, and tips clear each other only where the centre distance is several modules."""

POSITIONS = 181
"""Positions over a period of the law at which the search for the largest excess of the driving curve begins."""

POINTS = 721
"""Points of each curve over a period of the law, half a degree apart on a curve of one lobe."""

THROUGH = 1e-3
"""Least excess of the driving curve over the ring's curve that is refused, as a share of the ring's radius: a hundred
times the uncertainty of points half a degree apart.  The contact of the teeth shows a smaller excess."""


def require_ring(transmission: Transmission) -> None:
    """Refuse a law that cannot drive a ring.

    The pitch radii of an internal pair, a / (i12 - 1) and a i12 / (i12 - 1), exist only where i12 is over 1, and grow
    beyond all bounds as it nears 1.  Raises NoSuchMechanism with the least ratio, its driving angle and what to change.
    """
    least = transmission.ratio_range[0]
    if least.value >= LEAST_RATIO:
        return
    raise NoSuchMechanism(
        f"internal, but the ratio falls to {least.value:.6g} at phi1 = {in_words(least.at)}; a ring needs more than 1 "
        f"everywhere, and {LEAST_RATIO:g} is the least that makes a gear; {_remedy(transmission.lobes)}",
        key="gears.mesh",
    )


def _remedy(lobes: Lobes) -> str:
    said = f"{lobes.driving}:{lobes.driven} lobes"
    if lobes.driven > lobes.driving:
        return f"a smaller range of the ratio about the {lobes.driven / lobes.driving:.4g} of {said} is needed"
    return (
        f"with {said} its mean is {lobes.driven / lobes.driving:.4g}: more lobes of the driven gear than of the "
        "driving one are needed, or mesh: external (a law of the slider's motion has no other choice)"
    )


def require_room(driving: PitchCurve, ring: PitchCurve) -> None:
    """Refuse a driving pitch curve that does not stay inside the ring's while they roll.

    At the pitch point it always stays inside, since it is more curved; but its long side may not fit where the ring is
    narrow.  Raises NoSuchMechanism with the driving angle and the curve's excess.
    """
    phi1 = np.linspace(0.0, driving.transmission.lobes.driving_period_rad, POSITIONS)
    inner, outer = _points(driving), _points(ring)
    worst = largest_of_each(lambda at: passed_mm(inner, outer, driving, at).max(axis=1)[None], phi1)[0]
    if worst.value <= THROUGH * float(np.abs(outer).min()):
        return
    raise NoSuchMechanism(
        f"internal, but at phi1 = {in_words(worst.at)} the driving pitch curve, which reaches up to "
        f"{np.abs(inner).max():.4g} mm from its axis, would stand {worst.value:.4g} mm out of the ring's; a smaller "
        "range of the ratio is needed, or more lobes of the driven gear",
        key="gears.mesh",
    )


def _points(curve: PitchCurve) -> ComplexArray:
    """Points even in driving angle, and the ends of the curve's panels, which are close where it changes fast."""
    even = np.linspace(0.0, curve.turn_rad, curve.periods * POINTS, endpoint=False)
    panels = curve.driving_angle(curve.panels_mm[:-1])
    return as_complex(curve.at_angle(np.union1d(even, panels)).position)


def passed_mm(inner: ComplexArray, ring: ComplexArray, driving: PitchCurve, phi1: Array) -> Array:
    """Excess in mm of points of the driving gear over a ring's curve that each ray meets once, (positions, points)."""
    phi2 = driving.transmission.driven_angle(phi1).value
    seen = inner * np.exp(1j * phi1[:, None]) - driving.center_distance_mm
    from_ring_axis = seen * np.exp(-1j * phi2[:, None])
    there = np.interp(np.angle(from_ring_axis), np.angle(ring), np.abs(ring), period=2.0 * np.pi)
    return np.abs(from_ring_axis) - there
