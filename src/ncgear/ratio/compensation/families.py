"""Returns with the ends given and one coefficient free, in either basis."""

from __future__ import annotations

from collections.abc import Callable

from numpy.polynomial import Polynomial

from ncgear.ratio.compensation.closing import closed_ratio, polished
from ncgear.ratio.compensation.ends import ReturnEnds, not_positive
from ncgear.ratio.compensation.law import ReturnLaw
from ncgear.ratio.compensation.polynomials import lowest, unit_integral

BUMP = Polynomial([0.0, 0.0, 1.0, -2.0, 1.0])
SKEW = Polynomial([-1.0, 2.0])


def return_with_constant(ends: ReturnEnds, constant: float) -> ReturnLaw:
    """The published return: i12 polynomial whose value extrapolated to phi1 = 0 is ``constant`` (the paper's e).

    Raises NoSuchMechanism when no such polynomial closes the cycle with a positive ratio.
    """
    base, direction = published_family(ends, constant)
    return polished(closed_ratio(ends, base, direction), direction)


def published_family(ends: ReturnEnds, constant: float) -> tuple[Polynomial, Polynomial]:
    """Polynomials in tau with the ends and the e of a return: the first one plus any multiple of the second."""
    origin = -ends.start_rad / ends.length_rad
    base = hermite(ends)
    lift = (constant - base(origin)) / BUMP(origin)
    return base + lift * BUMP, BUMP * Polynomial([-origin, 1.0])


def hermite(ends: ReturnEnds) -> Polynomial:
    """Cubic in tau with the values and slopes of the two ends."""
    slope0, slope1 = ends.start_ratio_slope * ends.length_rad, ends.end_ratio_slope * ends.length_rad
    rise = ends.end_ratio - ends.start_ratio
    return Polynomial([ends.start_ratio, slope0, 3.0 * rise - 2.0 * slope0 - slope1, slope0 + slope1 - 2.0 * rise])


def ratio_family(ends: ReturnEnds) -> Callable[[float], ReturnLaw]:
    """The ratio's returns by their skewness, each closed; they raise NoSuchMechanism where none closes."""
    base = hermite(ends)
    return lambda skewness: closed_ratio(ends, base + skewness * SKEW * BUMP, BUMP)


def inverse_family(ends: ReturnEnds) -> Callable[[float], ReturnLaw]:
    """The same of the inverse of the ratio, which closes by a linear equation."""
    base = hermite(ends.inverted())

    def closed(skewness: float) -> ReturnLaw:
        shape = base + skewness * SKEW * BUMP
        missing = ends.driven_length_rad / ends.length_rad - unit_integral(shape)
        polynomial = shape + BUMP * (missing / unit_integral(BUMP))
        least, at = lowest(polynomial)
        if not least > 0.0:
            raise not_positive(ends.start_rad + at * ends.length_rad, ends)
        return ReturnLaw(ends, polynomial, inverse=True)

    return closed
