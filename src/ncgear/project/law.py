"""From keys to values: the closed law of a design on its mechanism, the lobes of its gears, and the resistance."""

from __future__ import annotations

from ncgear.design.keys.design import Design
from ncgear.design.mechanisms import mechanism_of, mechanism_of_stroke
from ncgear.mechanisms.resistance import FormulaResistance, PolynomialResistance, Resistance, TableResistance
from ncgear.ratio.transmission import Law, Lobes


def law_of(design: Design) -> Law:
    """The design's closed law on its mechanism.

    Raises WrongInput for values that contradict each other, NoSuchMechanism when no such motion exists.
    """
    motion, lobes = design.motion, lobes_of(design)
    if motion.gives_stroke:
        return motion.law_on(mechanism_of_stroke(design.linkage, motion.solved_stroke_mm()), lobes)
    return motion.law_on(mechanism_of(design.linkage), lobes)


def lobes_of(design: Design) -> Lobes:
    """Lobes of both gears; one each where the file has no gears."""
    return Lobes(design.gears.lobes.driving, design.gears.lobes.driven) if design.gears else Lobes()


def resistance_of(design: Design) -> Resistance:
    """The resistance; without force where the file has none."""
    given = design.resistance
    if given is None:
        return PolynomialResistance()
    keep = given.where_negative == "keep"
    if given.table is not None:
        return TableResistance(given.table.displacement_mm or (), given.table.force_n or (), keep)
    if given.expression_n is not None:
        return FormulaResistance(given.expression_n, keep)
    return PolynomialResistance(given.polynomial_n or (0.0,), keep)
