"""Section 2 and eqs. 3.3 to 3.7: the linkage's inversion, and the three segments of the working stroke.

Section 4.3.1, Figs. 4 and 9 to 12: displacement and speeds of the slider.
"""

from __future__ import annotations

from math import degrees

import numpy as np
from numpy.polynomial import Chebyshev

from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import extremes
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.papers.entry import Computed, Entry, Printed, Relation, Verdict, equations, of
from ncgear.papers.gear_baler.published import (
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


def working_speeds(rpm: float) -> Computed:
    """Largest speed of the working stroke and the speed of pressing in mm/s, at a driving speed."""
    _, theta2, theta3, _ = THETAS_RAD
    fastest = extremes(lambda phi1: displacement(0, phi1, 3).differentiated(), 0.0, theta2)[1].value
    pressing = float(displacement(1, np.array([0.5 * (theta2 + theta3)]), 1).derivative(1)[0])
    return of(*(speed * rpm * RAD_S_PER_RPM for speed in (fastest, pressing)))


def largest_displacement() -> Computed:
    """Displacement at the end of the working stroke."""
    return of(float(displacement(2, np.array([THETAS_RAD[3]]), 0).value[0]))


NOT_THERE = "It is taken from an earlier paper, whose law and speed are not given."

SPEED_ENTRIES = (
    Entry(
        ("Fig. 9", "Fig. 11"), "largest displacement", Printed(("760",), "mm"), Verdict.REPRODUCED,
        largest_displacement,
    ),
    Entry(
        ("Fig. 4", "Fig. 10", "Fig. 12"), "largest speed of the working stroke and speed of pressing",
        Printed(("1600", "1100"), "mm/s"), Verdict.UNDER_READING, lambda: working_speeds(law_rpm()),
        "At 52.81 r/min, where Table 1 closes with a1 at 20 r/min.",
    ),
    Entry(
        ("Fig. 12",), "speeds of the slider at 20 r/min, the speed of Figs. 13 and 14",
        Printed(("1600", "1100"), "mm/s"), Verdict.NOT_REPRODUCIBLE, lambda: working_speeds(SIMULATION_RPM),
        "Speeds, power and acceleration are printed for different driving speeds.",
    ),
    Entry(
        ("section 4.3.1",), "earlier mechanism: largest speed and speed of pressing", Printed(("2100", "820"), "mm/s"),
        Verdict.NEEDS_DATA, None, NOT_THERE,
    ),
    Entry(
        ("section 4.3.1",), "driving angle of the working stroke, and of a crank that turns evenly",
        Printed(("234", "180"), "deg"), Verdict.REPRODUCED,
        lambda: of(degrees(THETAS_RAD[3]), degrees(LINKAGE.working_angle_rad)),
    ),
    Entry(
        ("section 4.3.1",), "longer time of pressing than on a crank that turns evenly", Printed(("30",), "%"),
        Verdict.REPRODUCED, lambda: of(100.0 * (THETAS_RAD[3] / LINKAGE.working_angle_rad - 1.0)),
    ),
)  # fmt: skip
