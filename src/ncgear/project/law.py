"""The linkage and the closed law of a design."""

from __future__ import annotations

from dataclasses import dataclass
from math import isclose

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.motion import (
    Ellipse,
    HarmonicRatio,
    RatioExpression,
    SecondStage,
    TableLaw,
    ThreeSegmentStroke,
    UniformCrank,
)
from ncgear.design.mechanisms import mechanism_of, mechanism_of_stroke
from ncgear.errors import WrongInput
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.mechanisms.resistance import FormulaResistance, PolynomialResistance, Resistance
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import driven_angle_expression_law, ratio_expression_law
from ncgear.ratio.laws.harmonic import harmonic_law, staged_law
from ncgear.ratio.laws.three_segment import StrokeLaw, stroke_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Train, Transmission, single
from ncgear.ratio.working_stroke import StrokeRequest, solved_stroke

SAME_STROKE = 1e-6
"""Relative difference of the file's stroke from the linkage's that counts as rounding in the file: seven digits."""


@dataclass(frozen=True, eq=False)
class Law:
    """A closed law on its linkage with the pairs that make it, and the stroke it came from where one was given."""

    linkage: Mechanism
    train: Train
    stroke_law: StrokeLaw | None = None

    def __repr__(self) -> str:
        pairs = f", {len(self.train.pairs)} pairs in series" if len(self.train.pairs) > 1 else ""
        return f"Law({self.transmission!r} on {self.linkage!r}{pairs})"

    @property
    def transmission(self) -> Transmission:
        """The law of the whole, phi2(phi1)."""
        return self.train.whole


def law_of(design: Design) -> Law:
    """The design's linkage and law.

    Raises WrongInput for values that contradict each other, NoSuchMechanism when no such motion exists.
    """
    motion, lobes = design.motion, lobes_of(design)
    if isinstance(motion, ThreeSegmentStroke):
        return _stroke_law(design, motion, lobes)
    linkage = mechanism_of(design.linkage)
    if isinstance(motion, HarmonicRatio) and motion.second_stage is not None:
        return Law(linkage, _staged(motion, motion.second_stage))
    return Law(linkage, single(_direct_law(motion, linkage, lobes)))


def lobes_of(design: Design) -> Lobes:
    """Lobes of both gears; one each where the file says nothing."""
    return Lobes(design.gears.lobes.driving, design.gears.lobes.driven) if design.gears else Lobes()


def resistance_of(design: Design) -> Resistance:
    """The resistance; none where the file says nothing."""
    given = design.resistance
    if given is None:
        return PolynomialResistance()
    keep = given.where_negative == "keep"
    if given.table is not None:
        # Of SciPy's splines, which load slowly, only tables have need.
        from ncgear.mechanisms.resistance import TableResistance

        return TableResistance(given.table.displacement_mm or (), given.table.force_n or (), keep)
    if given.expression_n is not None:
        return FormulaResistance(given.expression_n, keep)
    return PolynomialResistance(given.polynomial_n or (0.0,), keep)


def _direct_law(
    motion: RatioExpression | HarmonicRatio | Ellipse | TableLaw | UniformCrank, linkage: Mechanism, lobes: Lobes
) -> Transmission:
    match motion:
        case UniformCrank():
            return uniform_law(lobes)
        case HarmonicRatio():
            return harmonic_law(np.array(motion.cosine), np.array(motion.sine), lobes)
        case Ellipse():
            return elliptical_law(motion.eccentricity, motion.phase, lobes)
        case RatioExpression(ratio=str() as text):
            return ratio_expression_law(text, lobes, scale_to_close=motion.scale_to_close)
        case RatioExpression(driven_angle=str() as text):
            return driven_angle_expression_law(text, lobes)
        case TableLaw():
            return _table_law(motion, linkage, lobes)
    raise AssertionError(f"no law for {motion.law}")


def _table_law(motion: TableLaw, linkage: Mechanism, lobes: Lobes) -> Transmission:
    from ncgear.ratio.laws.table import displacement_table_law, ratio_table_law

    match motion:
        case TableLaw(displacement_mm=tuple() as displacements):
            return displacement_table_law(np.array(motion.phi1), np.array(displacements), linkage, lobes)
        case TableLaw(ratio=tuple() as ratios):
            return ratio_table_law(np.array(motion.phi1), np.array(ratios), lobes, scale_to_close=motion.scale_to_close)
    raise AssertionError(f"no law for {motion.law}")


def _staged(motion: HarmonicRatio, second: SecondStage) -> Train:
    coefficients = motion.cosine, motion.sine, second.cosine, second.sine
    return staged_law(*(np.array(values) for values in coefficients)).train


def _stroke_law(design: Design, motion: ThreeSegmentStroke, lobes: Lobes) -> Law:
    if motion.solve_for == "stroke":
        stroke = solved_stroke(_request(motion, None))
        linkage = mechanism_of_stroke(design.linkage, stroke.stroke_mm)
    else:
        linkage = mechanism_of(design.linkage)
        _refuse_other_stroke(motion.stroke_mm, linkage)
        stroke = solved_stroke(_request(motion, linkage.stroke_mm))
    law = stroke_law(
        stroke,
        linkage,
        lobes,
        constant=None if motion.return_.e == "least_acceleration" else motion.return_.e,
        inverse_basis=motion.return_.basis == "inverse_ratio",
    )
    return Law(linkage, single(law.transmission), law)


def _request(motion: ThreeSegmentStroke, stroke_mm: float | None) -> StrokeRequest:
    return StrokeRequest(
        theta1_rad=motion.theta1,
        theta2_rad=motion.theta2,
        theta3_rad=motion.theta3,
        theta4_rad=motion.theta4,
        v1_mm_s=motion.v1_mm_s,
        v2_mm_s=motion.v2_mm_s,
        a1_mm_s2=motion.a1_mm_s2,
        law_speed_rad_s=None if motion.law_speed_rpm is None else motion.law_speed_rpm * RAD_S_PER_RPM,
        stroke_mm=stroke_mm,
        a1_speed_rad_s=None if motion.a1_speed_rpm is None else motion.a1_speed_rpm * RAD_S_PER_RPM,
    )


def _refuse_other_stroke(stroke_mm: float | None, linkage: Mechanism) -> None:
    if stroke_mm is not None and not isclose(stroke_mm, linkage.stroke_mm, rel_tol=SAME_STROKE):
        relation = "longer" if stroke_mm > linkage.stroke_mm else "shorter"
        raise WrongInput(
            f"{stroke_mm:.9g} mm is {relation} than the linkage's stroke of {linkage.stroke_mm:.9g} mm; give that one, "
            f"leave the key out, or change linkage.{linkage.STROKE_KEY}",
            key="motion.stroke_mm",
        )
