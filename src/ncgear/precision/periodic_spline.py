"""Periodic quintic splines around a turn, as matrices on their coefficients: a form that ncgear does not use."""

from __future__ import annotations

from math import pi

import numpy as np
from scipy.interpolate import BSpline

from ncgear.numerics.arrays import Array
from ncgear.optimum.makeable.reached import Basis

DEGREE = 5
"""Its second derivative, which curvature needs, is smooth."""


def periodic_spline(angle_rad: Array, count: int) -> Basis:
    """Values and two derivatives at angles of all but one of the B-splines with ``count`` + 1 even knots.

    They sum up to one, and the programme of a makeable law has a constant of its own.
    """
    count = count + 1
    step = 2.0 * pi / count
    knots = step * np.arange(-DEGREE, count + DEGREE + 1)
    rows = np.zeros((3, angle_rad.size, count))
    for number in range(count + DEGREE):
        bump = BSpline.basis_element(knots[number : number + DEGREE + 2], extrapolate=False)
        for order in range(3):
            curve = bump.derivative(order) if order else bump
            rows[order, :, number % count] += np.nan_to_num(curve(angle_rad))
    return Basis(*rows[:, :, :-1])
