"""Inversion of the working stroke through the linkage: displacement of the slider to angle of the crank.

Both dead centres are zero divided by zero in the textbook form.  Here the double zeros of the displacement at
phi1 = 0 and of the rest of the stroke at theta4 are divided out of the polynomials before anything is evaluated, so
phi2 and all its derivatives are regular up to and including both ends.
"""

from __future__ import annotations

from functools import partial

from ncgear.machine.linkage import CrankSlider, Linkages
from ncgear.machine.stroke import WorkingStroke, WorkingStrokes
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Number
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import Piece


def working_pieces(stroke: WorkingStroke, linkage: CrankSlider) -> tuple[Piece, ...]:
    """The driven angle on the three segments (two, when the constant-speed part is empty)."""
    pieces = [
        Piece(0.0, stroke.theta2_rad, partial(approach_angle, stroke, linkage)),
        Piece(stroke.theta2_rad, stroke.theta3_rad, partial(pressing_angle, stroke, linkage)),
        Piece(stroke.theta3_rad, stroke.theta4_rad, partial(braking_angle, stroke, linkage)),
    ]
    return tuple(piece for piece in pieces if piece.end_rad > piece.start_rad)


def approach_angle(stroke: WorkingStrokes[Number], linkage: Linkages[Number], phi1: Array, order: int) -> Jet:
    """phi2 in rad on [0, theta2], with derivatives, of one stroke or of one for each point."""
    angle = Jet.variable(phi1, order)
    quotient = jet.polynomial(stroke.approach_root, angle)
    displacement = angle * angle * quotient
    return linkage.working_angle(displacement, angle * jet.sqrt(quotient), jet.sqrt(stroke.stroke_mm - displacement))


def pressing_angle(stroke: WorkingStrokes[Number], linkage: Linkages[Number], phi1: Array, order: int) -> Jet:
    """The same on [theta2, theta3]."""
    beyond = Jet.variable(phi1 - stroke.theta2_rad, order)
    displacement = stroke.pressing_mm_rad * beyond + stroke.pressing_start_mm
    return linkage.working_angle(displacement, jet.sqrt(displacement), jet.sqrt(stroke.stroke_mm - displacement))


def braking_angle(stroke: WorkingStrokes[Number], linkage: Linkages[Number], phi1: Array, order: int) -> Jet:
    """The same on [theta3, theta4]."""
    before_end = -Jet.variable(phi1 - stroke.theta4_rad, order)
    quotient = jet.polynomial(stroke.braking_root, before_end)
    displacement = stroke.stroke_mm - before_end * before_end * quotient
    return linkage.working_angle(displacement, jet.sqrt(displacement), before_end * jet.sqrt(quotient))
