"""The multiple of a polynomial that closes the return, to rounding."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.polynomial import Polynomial

from ncgear.errors import NoSuchMechanism
from ncgear.numerics.angles import in_words
from ncgear.numerics.arrays import Array
from ncgear.numerics.bracketed import zeros_between
from ncgear.ratio.compensation.ends import ReturnEnds, not_positive, remedy
from ncgear.ratio.compensation.law import ReturnLaw
from ncgear.ratio.compensation.polynomials import lowest, panels
from ncgear.ratio.transmission import CLOSED

POLISHED = CLOSED / 20.0
"""Closure error in rad at which no further Newton step is taken: 25 rounding errors of a full turn. A step costs a
sixth of the time of the whole law, and would only move the rounding."""

TOUCHING = 1e-12
"""Share of the largest coefficient below which a value counts as none: 4500 rounding errors, of a touching point found
as a root of a polynomial of degree nine."""


def closed_ratio(ends: ReturnEnds, base: Polynomial, direction: Polynomial) -> ReturnLaw:
    """i12 = base + c direction with c such that the return covers its driven angle.

    ``direction`` is positive inside the return, so the covered angle falls as c grows; it grows without bound as c
    falls to where the polynomial touches zero.  Between the two there is exactly one solution.
    """
    for ratio, at_rad in ((ends.start_ratio, ends.start_rad), (ends.end_ratio, ends.end_rad)):
        if not ratio > 0.0:
            raise not_positive(at_rad, ends)
    least = _touching_multiple(base, direction)
    scale = max(1.0, abs(least), *np.abs(base.coef))
    target = ends.driven_length_rad / ends.length_rad
    nodes, weights = panels()
    base_values, direction_values = base(nodes), direction(nodes)

    def excess(log_step: Array) -> Array:
        covered: Array = (1.0 / (base_values + (least + np.exp(log_step)) * direction_values)) @ weights
        return np.atleast_1d(covered - target)

    low, high = np.array([np.log(scale) - 30.0]), np.array([np.log(scale) + 30.0])
    if not excess(low)[0] > 0.0 > excess(high)[0]:
        raise NoSuchMechanism(
            f"the return from phi1 = {in_words(ends.start_rad)} cannot close: no "
            f"polynomial of this basis covers a driven angle of {ends.driven_length_rad:.6g} rad; {remedy(ends)}",
            key="motion.return",
        )
    step = np.exp(zeros_between(excess, low, high)[0])
    local, about = _about_touching(base + least * direction)
    return ReturnLaw(ends, local + step * direction(Polynomial([about, 1.0])), inverse=False, about=about)


def _about_touching(polynomial: Polynomial) -> tuple[Polynomial, float]:
    """A polynomial that touches zero inside [0, 1], in powers about that place, which loses no digits beside it.

    Constant and linear term are zero but for rounding, and left out; what they were is made up for by what closes.
    """
    about = lowest(polynomial)[1]
    for _ in range(3):
        local = polynomial(Polynomial([about, 1.0]))
        _, slope, bend = local.coef[:3]
        if not bend > 0.0 or not 0.0 < about - 0.5 * slope / bend < 1.0:
            return polynomial, 0.0
        about -= 0.5 * slope / bend
    local = polynomial(Polynomial([about, 1.0]))
    noise = TOUCHING * np.max(np.abs(polynomial.coef))
    if max(abs(local.coef[0]), abs(local.coef[1])) > noise:
        return polynomial, 0.0
    return Polynomial([0.0, 0.0, *local.coef[2:]]), float(about)


def _touching_multiple(base: Polynomial, direction: Polynomial) -> float:
    """Smallest c for which base + c direction is not negative on [0, 1]."""
    inner = (base.deriv() * direction - base * direction.deriv()).roots()
    candidates = inner.real[(np.abs(inner.imag) < 1e-9) & (inner.real > 1e-9) & (inner.real < 1.0 - 1e-9)]
    samples = np.concatenate([candidates, np.linspace(0.02, 0.98, 97)])
    # Nearer to the ends than this the double zeros of the direction drown in rounding, and the base decides alone.
    samples = samples[direction(samples) > 1e-12]
    return float(np.max(-base(samples) / direction(samples)))


def polished(law: ReturnLaw, direction: Polynomial) -> ReturnLaw:
    """Newton steps on the spectral integral, which the fixed panels of the solve only approximate.

    Raises NoSuchMechanism when the ratio comes so near zero that closure cannot be reached to CLOSED.
    """
    best = law
    for _ in range(6):
        if abs(best.closure_error_rad) <= POLISHED:
            return best
        sensitivity = _closing_sensitivity(best.polynomial, direction)
        step = direction * (best.closure_error_rad / (sensitivity * best.ends.length_rad))
        candidate = replace(best, correction=best.correction + step)
        positive = lowest(candidate.polynomial)[0] > 0.0
        if not (positive and abs(candidate.closure_error_rad) < abs(best.closure_error_rad)):
            break
        best = candidate
    if abs(best.closure_error_rad) > CLOSED:
        raise NoSuchMechanism(
            f"the return closes only to {best.closure_error_rad:.2g} rad: its ratio comes too near zero; "
            f"{remedy(best.ends)}",
            key="motion.return",
        )
    return best


def _closing_sensitivity(polynomial: Polynomial, direction: Polynomial) -> float:
    """How fast the integral of 1/polynomial over [0, 1] falls as a multiple of ``direction`` is added.

    By the fixed panels: it only sets the length of a Newton step.
    """
    nodes, weights = panels()
    return float(weights @ (direction(nodes) / polynomial(nodes) ** 2))
