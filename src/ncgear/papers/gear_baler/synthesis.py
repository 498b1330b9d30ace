"""Sections 2 and 3, Table 1: from the stroke in three segments to the pitch curves, and the size of the gears.

Equations are checked at driving angles inside each segment of the law; a residual is relative to the stroke, the ratio
or the centre distance, as stated.
"""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.polynomial import Chebyshev

from ncgear.numerics.arrays import Array
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.papers.entry import Computed, Entry, Finding, Relation, computed, equations, printed
from ncgear.papers.gear_baler.simulation import (
    A1_MM_S2,
    CENTER_DISTANCE_MM,
    LINKAGE,
    MODULE_MM,
    SIMULATION_RPM,
    STROKE_MM,
    TEETH,
    THETAS_RAD,
    V1_MM_S,
    V2_MM_S,
    law,
    law_rpm,
    pitch,
    slider_displacement,
    stroke_at,
)
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Gear

# --- section 2 and eqs. 3.3 to 3.7: crank angle and ratio from the slider's motion, the segments of the stroke -----


def crank_angle_residual() -> Computed:
    """Eq. 2.1 against the law."""
    crank, rod = LINKAGE.crank_mm, LINKAGE.rod_mm
    worst = []
    for segment in range(3):
        angle, s, _, _ = _from_axis(segment)
        formula = np.pi - np.arccos((crank**2 + s**2 - rod**2) / (2.0 * crank * s))
        worst.append(float(np.abs(formula - angle).max() / np.pi))
    return computed(*worst)


def ratio_residual() -> Computed:
    """Eq. 2.3 against the law."""
    crank, rod = LINKAGE.crank_mm, LINKAGE.rod_mm
    worst = []
    for segment in range(3):
        _, s, v, ratio = _from_axis(segment)
        root = np.sqrt(4.0 * crank**2 * s**2 - (crank**2 + s**2 - rod**2) ** 2)
        formula = s * root / ((s**2 - crank**2 + rod**2) * v)
        worst.append(float(np.abs(formula / ratio - 1.0).max()))
    return computed(*worst)


def segment_residual() -> Computed:
    """Eqs.  2.4, 2.7, 2.10: distance of each segment's displacement from a polynomial of the printed degree, over the
    stroke."""
    worst = []
    for segment, degree in enumerate((5, 1, 4)):
        angle = _inside(segment)
        along = slider_displacement(segment, angle, 0).value
        worst.append(float(np.abs(Chebyshev.fit(angle, along, degree)(angle) - along).max() / STROKE_MM))
    return computed(*worst)


def condition_residual() -> Computed:
    """Conditions 3.3 to 3.7, each on its own scale: speeds at the law's speed, a1 at the simulation's speed."""
    t1, t2, t3, t4 = THETAS_RAD
    omega, slow = law_rpm() * RAD_S_PER_RPM, SIMULATION_RPM * RAD_S_PER_RPM

    def at(segment: int, angle_rad: float, order: int) -> float:
        return float(slider_displacement(segment, np.array([angle_rad]), 2).derivative(order)[0])

    wanted = [
        (0, 0.0, 1, omega / V1_MM_S, 0.0), (0, t1, 1, omega / V1_MM_S, 1.0), (0, t2, 1, omega / V2_MM_S, 1.0),
        (0, t1, 2, 1.0 / STROKE_MM, 0.0), (0, t2, 2, 1.0 / STROKE_MM, 0.0),
        (1, t2, 1, omega / V2_MM_S, 1.0), (1, t2, 0, 1.0 / STROKE_MM, at(0, t2, 0) / STROKE_MM),
        (2, t3, 2, 1.0 / STROKE_MM, 0.0), (2, t4, 2, slow**2 / A1_MM_S2, 1.0),
        (2, t3, 1, omega / V2_MM_S, 1.0), (2, t4, 1, omega / V2_MM_S, 0.0),
        (2, t4, 0, 1.0 / STROKE_MM, 1.0), (2, t3, 0, 1.0 / STROKE_MM, at(1, t3, 0) / STROKE_MM),
    ]  # fmt: skip
    return computed(*(at(segment, angle, order) * scale - value for segment, angle, order, scale, value in wanted))


def _from_axis(segment: int) -> tuple[Array, Array, Array, Array]:
    """Crank angle, distance of the slider from the crank axis, its derivative by the driving angle, and the ratio."""
    driven = law().transmission.pieces[segment].driven_angle(_inside(segment), 1)
    slider = LINKAGE.displacement(driven)
    return driven.value, slider.value + LINKAGE.nearest_mm, slider.derivative(1), 1.0 / driven.derivative(1)


def _inside(segment: int) -> Array:
    """Driving angles inside a segment, without its ends."""
    piece = law().transmission.pieces[segment]
    return np.linspace(piece.start_rad, piece.end_rad, 23)[1:-1]


OVER_DETERMINED = (
    "The third segment has five coefficients for six conditions, and the speed at which v1 and v2 hold is not given: "
    "read with a1 at the 20 r/min of the simulation, v1 and v2 hold at the 52.81 r/min that closes the stroke. This "
    "reading is taken because the power of Fig. 13 and the acceleration of Fig. 14 come out of it."
)

STROKE = (
    Entry("eq. 2.1", "crank angle from the slider's place", Relation(), Finding.UNDER_READING, crank_angle_residual,
          "Here s counts from the crank axis; in eqs. 2.4 to 2.12 it counts from the retracted end."),
    Entry("eq. 2.2, eq. 2.3", "transmission ratio from the slider's motion", Relation(), Finding.UNDER_READING,
          ratio_residual, "s counts from the crank axis and v is taken per radian of the driving gear, as a ratio "
          "needs it. At both dead centres the formula is zero by zero; ncgear divides the double zeros out."),
    Entry(", ".join(equations(*(f"2.{k}" for k in range(4, 13)))), "segments are polynomials of degree 5, 1 and 4",
          Relation(), Finding.REPRODUCED, segment_residual),
    Entry("eq. 3.3, eq. 3.4, eq. 3.5, eq. 3.6, eq. 3.7", "end conditions of the three segments", Relation(),
          Finding.FITTED, condition_residual, OVER_DETERMINED),
    Entry("Table 1", "stroke that v1, v2 and a1 make, all at the simulation's 20 r/min", printed("760 mm"),
          Finding.NOT_REPRODUCIBLE, lambda: stroke_at(SIMULATION_RPM, None, None).stroke_mm,
          "The six conditions of the third segment contradict each other at any speed but one."),
    Entry("Table 1", "stroke of the crank", printed("760 mm"), Finding.REPRODUCED, lambda: LINKAGE.stroke_mm),
)  # fmt: skip

# --- eqs. 3.1, 3.2 and 3.8 to 3.12: pitch curves, the return and closure; the size of the gears in Table 1 ---------


def radius_residual() -> Computed:
    """Eqs.  3.1 and 3.2 against both pitch curves, relative to the centre distance."""
    worst = []
    for segment in range(4):
        angle = _inside(segment)
        first = CENTER_DISTANCE_MM / (1.0 + 1.0 / law().transmission.pieces[segment].slope(angle, 0).value)
        for curve, radius in ((pitch().driving, first), (pitch().driven, CENTER_DISTANCE_MM - first)):
            found = np.linalg.norm(curve.at_angle(angle).position, axis=-1)
            worst.append(float(np.abs(found - radius).max() / CENTER_DISTANCE_MM))
    return computed(*worst)


def return_residual() -> Computed:
    """Eq.  3.8 with its constant 0: distance of the return's ratio from a polynomial of degree 5 in phi1 without a
    constant term."""
    angle = _inside(3)
    ratio = 1.0 / law().transmission.pieces[3].slope(angle, 0).value
    # Divided by phi1 the polynomial without constant has degree 4
    form = Chebyshev.fit(angle, ratio / angle, 4)
    return computed(float(np.abs(form(angle) * angle / ratio - 1.0).max()))


def joint_residual() -> Computed:
    """Eq. 3.9: jumps of the ratio and of its derivative at theta4 and at the end of the turn."""
    pieces = law().transmission.pieces
    ends = ((pieces[2], pieces[3], pieces[2].end_rad, pieces[3].start_rad), (pieces[3], pieces[0], 2.0 * pi, 0.0))
    jumps = []
    for before, after, left, right in ends:
        one, other = (1.0 / piece.slope(np.array([at]), 1) for piece, at in ((before, left), (after, right)))
        jumps += [float((one.derivative(k) - other.derivative(k))[0]) for k in (0, 1)]
    return computed(*jumps)


def closure_residual() -> Computed:
    """Eqs.  3.10 to 3.12: rotation of the driven gear in the working stroke and in the whole turn."""
    pieces = law().transmission.pieces
    working = float(pieces[2].driven_angle(np.array([pieces[2].end_rad]), 0).value[0])
    whole = float(pieces[3].driven_angle(np.array([pieces[3].end_rad]), 0).value[0])
    return computed(working / LINKAGE.working_angle_rad - 1.0, whole / (2.0 * pi) - 1.0)


SIZE = (
    "Teeth, module and centre distance do not go together; the paper adjusts the centre distance and does not print it."
)

GEARS = (
    Entry("eq. 3.1, eq. 3.2", "radii of both pitch curves", Relation(), Finding.REPRODUCED, radius_residual),
    Entry("eq. 3.8, Table 1", "ratio of the return, with constant 0", Relation(), Finding.UNDER_READING,
          return_residual, "Degree 5 with the coefficients e and f0 to f4; the f5 named beside it has no place in the "
          "equation. Four end conditions and closure leave e free, so that its value is a choice and not a result."),
    Entry("eq. 3.9", "ratio joined smoothly at both ends", Relation(), Finding.REPRODUCED, joint_residual),
    Entry("eq. 3.10, eq. 3.11, eq. 3.12", "driven gear closes after one turn", Relation(), Finding.REPRODUCED,
          closure_residual),
    Entry("Table 1", "number of teeth, from module and centre distance", printed("25"), Finding.NOT_REPRODUCIBLE,
          lambda: pitch().length_mm(Gear.DRIVING) / (pi * MODULE_MM), SIZE),
    Entry("Table 1", "module, from teeth and centre distance", printed("3 mm"), Finding.NOT_REPRODUCIBLE,
          lambda: pitch().size.module_mm, SIZE),
    Entry("Table 1", "centre distance, from teeth and module", printed("200 mm"), Finding.NOT_REPRODUCIBLE,
          lambda: sized_pair(law().transmission, TEETH, MODULE_MM, None).center_distance_mm, SIZE),
    Entry("Fig. 8", "teeth mesh without interference", Relation("claim"), Finding.NEEDS_DATA, None,
          "Neither the rack's angle and proportions nor the size of the gears in the picture is given."),
)  # fmt: skip

ENTRIES = (*STROKE, *GEARS)
