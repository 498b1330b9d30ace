"""Study of the places at which a makeable law is held to its limits: what their number leaves between them.

A peak that lies between two places is missed by up to the square of their distance, and by less where it happens to lie
at one of them: what is left falls with the square, but not evenly, and no rate is fitted.
"""

from __future__ import annotations

from ncgear.precision.study import Method, Study

from ncgear.extras import require
from ncgear.optimum.makeable.reached import grid
from ncgear.optimum.task import figures
from ncgear.precision.makeable import BALER, HARMONICS, POWER_W, AtPlaces, at_places
from ncgear.ratio.laws.harmonic import harmonic_law
from ncgear.ratio.transmission import single

PLACES = (4, 6, 10, 16)
ENOUGH = 5e-4
"""Of a limit: two or three further rounds, which take ten steps each, then keep it everywhere."""

PROGRAMME = "even places, one round"


def study() -> Study:
    """By how much the baler's law of 24 harmonics oversteps between its places what it keeps at them.

    Raises WrongInput where the optimiser is not installed.
    """
    require("casadi", "optimize", "ncgear bench --only makeable-places")
    from ncgear.optimum.makeable.search import PLACES_PER_HARMONIC

    return Study(
        key="makeable-places",
        title="Makeable law between its places",
        unit="share",
        reference="the exact peaks of acceleration and power of the law that was found, located on its closed form",
        methods=(Method(PROGRAMME, "places per harmonic", PLACES, lambda count: at_places(grid, HARMONICS, count)),),
        error=overstepped,
        chosen=(PROGRAMME, PLACES_PER_HARMONIC),
        enough=ENOUGH,
        because="what is left between them is so little that tightening the limits by it takes two or three short "
        "rounds more; the time grows with the places",
    )


def overstepped(law: AtPlaces) -> float:
    """Share by which the larger of both exact peaks is over what the places were held to."""
    cosine, sine = law.coefficients.reshape(2, -1)
    exact = figures(BALER, single(harmonic_law(cosine, sine, BALER.lobes)))
    over = exact.peak_acceleration_mm_s2 / law.at_places_mm_s2, exact.peak_power_w / POWER_W
    return abs(max(over) - 1.0)
