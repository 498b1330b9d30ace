"""Two pairs in series at a place: the law of each by its own driven angle, from ln i12 and the second pair's ln iB.

Both are functions of the crank's angle phi2, which the second pair drives: by it, iB is a law of its own as it stands.
The first pair drives the shaft between, with dphim = iB dphi2, so that with f = ln i12, g = ln iB

    ln iA = f - g,   d/dphim = exp(-g) d/dphi2
    d ln iA/dphim = exp(-g) (f' - g'),   d2 ln iA/dphim2 = exp(-2g) (f'' - g'' - g' (f' - g'))
"""

from __future__ import annotations

from collections.abc import Sequence

from ncgear.optimum.makeable.quantities import Place, Term, length_rate


def pairs(ratios: Sequence[Place]) -> tuple[Place, ...]:
    """Every pair at a place, from the driving shaft on: of i12 alone that one pair, of i12 and iB both."""
    if len(ratios) == 1:
        return (ratios[0],)
    whole, second = ratios
    return _first_pair(whole, second), second


def length_rates(ratios: Sequence[Place]) -> tuple[Term, ...]:
    """Length of every pair's pitch curves per unit of phi2, each over its centre distance."""
    if len(ratios) == 1:
        return (length_rate(ratios[0]),)
    first, second = pairs(ratios)
    return length_rate(first) * second.ratio, length_rate(second)


def _first_pair(whole: Place, second: Place) -> Place:
    bend = whole.first - second.first
    return Place(
        whole.log - second.log,
        whole.ratio * second.slope,
        whole.slope * second.ratio,
        second.slope * bend,
        second.slope**2 * (whole.second - second.second - second.first * bend),
    )
