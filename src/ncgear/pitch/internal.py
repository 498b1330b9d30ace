"""Which laws let the driven gear be a ring with its teeth inside."""

from __future__ import annotations

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.angles import in_words
from ncgear.ratio.transmission import Lobes, Transmission

LEAST_RATIO = 1.001
"""Ratio below which no internal gear is made: the pitch radii would be a thousand centre distances, which is 2000 teeth
for every module of centre distance, and tips clear one another only where that is several modules."""


def require_ring(transmission: Transmission) -> None:
    """Refuse a law that a ring cannot be driven by.

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
