"""Eqs. 3.1, 3.2, 3.8 to 3.12 and the size of the gears in Table 1."""

from __future__ import annotations

from math import pi

import numpy as np

from ncgear.papers.entry import Computed, Entry, Printed, Relation, Verdict, equations, of
from ncgear.papers.gear_baler.motion import inside
from ncgear.papers.gear_baler.published import CENTER_DISTANCE_MM, LINKAGE, MODULE_MM, TEETH, law, pitch
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Gear


def radius_residual() -> Computed:
    """Eqs. 3.1 and 3.2 against both pitch curves, by the centre distance."""
    worst = []
    for segment in range(4):
        angle = inside(segment)
        first = CENTER_DISTANCE_MM / (1.0 + 1.0 / law().transmission.pieces[segment].slope(angle, 0).value)
        for curve, radius in ((pitch().driving, first), (pitch().driven, CENTER_DISTANCE_MM - first)):
            found = np.linalg.norm(curve.at_angle(angle).position, axis=-1)
            worst.append(float(np.abs(found - radius).max() / CENTER_DISTANCE_MM))
    return of(*worst)


def return_residual() -> Computed:
    """Eq. 3.8 with its constant: how far the return's ratio is from a polynomial of degree 5 in phi1 that is e at 0."""
    angle = inside(3)
    ratio = 1.0 / law().transmission.pieces[3].slope(angle, 0).value
    # Divided by phi1 the polynomial without constant has degree 4
    form = np.polynomial.Chebyshev.fit(angle, ratio / angle, 4)
    return of(float(np.abs(form(angle) * angle / ratio - 1.0).max()))


def joint_residual() -> Computed:
    """Eq. 3.9: jumps of the ratio and of its derivative at theta4 and at the end of the turn."""
    pieces = law().transmission.pieces
    ends = ((pieces[2], pieces[3], pieces[2].end_rad, pieces[3].start_rad), (pieces[3], pieces[0], 2.0 * pi, 0.0))
    jumps = []
    for before, after, left, right in ends:
        one, other = (1.0 / piece.slope(np.array([at]), 1) for piece, at in ((before, left), (after, right)))
        jumps += [float((one.derivative(k) - other.derivative(k))[0]) for k in (0, 1)]
    return of(*jumps)


def closure_residual() -> Computed:
    """Eqs. 3.10 to 3.12: working and return period of the driven gear against half turns."""
    pieces = law().transmission.pieces
    working = float(pieces[2].driven_angle(np.array([pieces[2].end_rad]), 0).value[0])
    whole = float(pieces[3].driven_angle(np.array([pieces[3].end_rad]), 0).value[0])
    return of(working / LINKAGE.working_angle_rad - 1.0, whole / (2.0 * pi) - 1.0)


def teeth_at_printed_size() -> Computed:
    """Teeth of the printed module that the pitch curve has room for at the printed centre distance."""
    return of(pitch().length_mm(Gear.DRIVING) / (pi * MODULE_MM))


def fitting_center_distance() -> Computed:
    """Centre distance at which the printed teeth fill the pitch curve."""
    return of(sized_pair(law().transmission, TEETH, MODULE_MM, None).center_distance_mm)


SIZE = (
    "Teeth, module and centre distance do not go together; the paper adjusts the centre distance and does not print it."
)

ENTRIES = (
    Entry(equations("3.1", "3.2"), "radii of both pitch curves", Relation(), Verdict.REPRODUCED, radius_residual),
    Entry(
        (*equations("3.8"), "Table 1"), "ratio of the return, with constant 0", Relation(), Verdict.UNDER_READING,
        return_residual,
        "Degree 5 with the coefficients e and f0 to f4; the f5 named beside it has no place in the equation. Four end "
        "conditions and closure leave e free, so that its value is a choice and not a result.",
    ),
    Entry(equations("3.9"), "ratio joined smoothly at both ends", Relation(), Verdict.REPRODUCED, joint_residual),
    Entry(
        equations("3.10", "3.11", "3.12"), "driven gear closes after one turn", Relation(), Verdict.REPRODUCED,
        closure_residual,
    ),
    Entry(
        ("Table 1",), "number of teeth, from module and centre distance", Printed(("25",)), Verdict.NOT_REPRODUCIBLE,
        teeth_at_printed_size, SIZE,
    ),
    Entry(
        ("Table 1",), "module, from teeth and centre distance", Printed(("3",), "mm"), Verdict.NOT_REPRODUCIBLE,
        lambda: of(pitch().size.module_mm), SIZE,
    ),
    Entry(
        ("Table 1",), "centre distance, from teeth and module", Printed(("200",), "mm"), Verdict.NOT_REPRODUCIBLE,
        fitting_center_distance, SIZE,
    ),
    Entry(
        ("Fig. 8",), "teeth mesh without interference", Relation("claim"), Verdict.NEEDS_DATA, None,
        "Neither the rack's angle and proportions nor the size of the gears in the picture is given.",
    ),
)  # fmt: skip
