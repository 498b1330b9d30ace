"""Section 2 and eqs. 3.3 to 3.7: the linkage's inversion, and the three segments of the working stroke."""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Chebyshev

from ncgear.ledger.entry import Entry, Verdict, equations
from ncgear.ledger.gear_baler.published import (
    A1_MM_S2,
    LINKAGE,
    SIMULATION_RPM,
    STROKE_MM,
    THETAS_RAD,
    V1_MM_S,
    V2_MM_S,
    law,
    law_rpm,
    stroke_at,
)
from ncgear.ledger.printed import Computed, Printed, Relation, of
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import RAD_S_PER_RPM

SEGMENT_DEGREES = (5, 1, 4)
"""Degrees of eqs. 2.4, 2.7 and 2.10."""


def displacement(segment: int, phi1_rad: Array, order: int) -> Jet:
    """Displacement in mm on a segment of the working stroke, brought through gears and linkage."""
    return LINKAGE.displacement(law().transmission.pieces[segment].driven_angle(phi1_rad, order))


def inside(segment: int) -> Array:
    """Driving angles within a segment, both ends left out."""
    piece = law().transmission.pieces[segment]
    return np.linspace(piece.start_rad, piece.end_rad, 23)[1:-1]


def _from_axis(segment: int) -> tuple[Array, Array, Array, Array]:
    """Crank angle, distance of the slider from the crank axis, its derivative by the driving angle, and the ratio."""
    driven = law().transmission.pieces[segment].driven_angle(inside(segment), 1)
    slider = LINKAGE.displacement(driven)
    return driven.value, slider.value + LINKAGE.nearest_mm, slider.derivative(1), 1.0 / driven.derivative(1)


def crank_angle_residual() -> Computed:
    """Eq. 2.1 against the law."""
    crank, rod = LINKAGE.crank_mm, LINKAGE.rod_mm
    worst = []
    for segment in range(3):
        angle, s, _, _ = _from_axis(segment)
        formula = np.pi - np.arccos((crank**2 + s**2 - rod**2) / (2.0 * crank * s))
        worst.append(float(np.abs(formula - angle).max() / np.pi))
    return of(*worst)


def ratio_residual() -> Computed:
    """Eq. 2.3 against the law."""
    crank, rod = LINKAGE.crank_mm, LINKAGE.rod_mm
    worst = []
    for segment in range(3):
        _, s, v, ratio = _from_axis(segment)
        root = np.sqrt(4.0 * crank**2 * s**2 - (crank**2 + s**2 - rod**2) ** 2)
        formula = s * root / ((s**2 - crank**2 + rod**2) * v)
        worst.append(float(np.abs(formula / ratio - 1.0).max()))
    return of(*worst)


def segment_residual() -> Computed:
    """How far each segment's displacement is from a polynomial of the printed degree, by the stroke."""
    worst = []
    for segment, degree in enumerate(SEGMENT_DEGREES):
        angle = inside(segment)
        along = displacement(segment, angle, 0).value
        worst.append(float(np.abs(Chebyshev.fit(angle, along, degree)(angle) - along).max() / STROKE_MM))
    return of(*worst)


def condition_residual() -> Computed:
    """Conditions 3.3 to 3.7, each by its own scale: speeds at the law's speed, a1 at the simulation's."""
    t1, t2, t3, t4 = THETAS_RAD
    omega, slow = law_rpm() * RAD_S_PER_RPM, SIMULATION_RPM * RAD_S_PER_RPM
    wanted = [
        (0, 0.0, 1, omega / V1_MM_S, 0.0), (0, t1, 1, omega / V1_MM_S, 1.0), (0, t2, 1, omega / V2_MM_S, 1.0),
        (0, t1, 2, 1.0 / STROKE_MM, 0.0), (0, t2, 2, 1.0 / STROKE_MM, 0.0),
        (1, t2, 1, omega / V2_MM_S, 1.0), (1, t2, 0, 1.0 / STROKE_MM, _at(0, t2, 0) / STROKE_MM),
        (2, t3, 2, 1.0 / STROKE_MM, 0.0), (2, t4, 2, slow**2 / A1_MM_S2, 1.0),
        (2, t3, 1, omega / V2_MM_S, 1.0), (2, t4, 1, omega / V2_MM_S, 0.0),
        (2, t4, 0, 1.0 / STROKE_MM, 1.0), (2, t3, 0, 1.0 / STROKE_MM, _at(1, t3, 0) / STROKE_MM),
    ]  # fmt: skip
    return of(*(_at(segment, angle, order) * scale - value for segment, angle, order, scale, value in wanted))


def _at(segment: int, angle_rad: float, order: int) -> float:
    return float(displacement(segment, np.array([angle_rad]), 2).derivative(order)[0])


OVER_DETERMINED = (
    "The third segment has five coefficients for six conditions, and the speed at which v1 and v2 hold is not given: "
    "read with a1 at the 20 r/min of the simulation, v1 and v2 hold at the 52.81 r/min that closes the stroke."
)

ENTRIES = (
    Entry(
        equations("2.1"), "crank angle from the slider's place", Relation(), Verdict.UNDER_READING,
        crank_angle_residual,
        "Here s counts from the crank axis; in eqs. 2.4 to 2.12 it counts from the retracted end.",
    ),
    Entry(
        equations("2.2", "2.3"), "transmission ratio from the slider's motion", Relation(), Verdict.UNDER_READING,
        ratio_residual,
        "s counts from the crank axis and v is taken per radian of the driving gear, as a ratio needs it. At both dead "
        "centres the formula is zero by zero; ncgear divides the double zeros out.",
    ),
    Entry(
        equations(*(f"2.{k}" for k in range(4, 13))), "segments are polynomials of degree 5, 1 and 4", Relation(),
        Verdict.REPRODUCED, segment_residual,
    ),
    Entry(
        equations("3.3", "3.4", "3.5", "3.6", "3.7"), "end conditions of the three segments", Relation(),
        Verdict.UNDER_READING, condition_residual, OVER_DETERMINED,
    ),
    Entry(
        ("Table 1",), "stroke that v1, v2 and a1 make, all at the simulation's 20 r/min", Printed(("760",), "mm"),
        Verdict.NOT_REPRODUCIBLE, lambda: of(stroke_at(SIMULATION_RPM, None, None).stroke_mm),
        "The six conditions of the third segment contradict each other at any speed but one.",
    ),
    Entry(
        ("Table 1",), "stroke of the crank", Printed(("760",), "mm"), Verdict.REPRODUCED,
        lambda: of(LINKAGE.stroke_mm),
    ),
)  # fmt: skip
