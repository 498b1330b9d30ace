"""What a design says of its machine, as values to compute with: linkage, lobes, resistance, and the closed law."""

from __future__ import annotations

from ncgear.design.keys.design import Design
from ncgear.errors import WrongInput
from ncgear.mechanisms.crank_slider import CrankSlider, crank_of_stroke_mm
from ncgear.mechanisms.resistance import FormulaResistance, PolynomialResistance, Resistance
from ncgear.ratio.transmission import Law, Lobes


def law_of(design: Design) -> Law:
    """The design's law on its linkage.

    Raises WrongInput for values that contradict each other, NoSuchMechanism when no such motion exists.
    """
    motion, lobes = design.motion, lobes_of(design)
    if motion.gives_stroke:
        return motion.law_on(_linkage_of_stroke(design, motion.solved_stroke_mm()), lobes)
    return motion.law_on(linkage_of(design), lobes)


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


def linkage_of(design: Design) -> CrankSlider:
    """The linkage of a design that gives its crank; raises WrongInput where it does not."""
    if design.linkage.crank_mm is None:
        raise WrongInput("missing; only a stroke that is solved for gives the crank", key="linkage.crank_mm")
    return CrankSlider(design.linkage.crank_mm, design.linkage.rod_mm, design.linkage.offset_mm)


def _linkage_of_stroke(design: Design, stroke_mm: float) -> CrankSlider:
    """The linkage whose crank gives the stroke that the law came out with."""
    rod, offset = design.linkage.rod_mm, design.linkage.offset_mm
    if design.linkage.crank_mm is not None:
        raise WrongInput(
            f"{design.linkage.crank_mm:g} mm is given, but the crank follows from the stroke that is "
            "solved for; leave it out",
            key="linkage.crank_mm",
        )
    longest = (rod - abs(offset)) * (1.0 - 1e-9)
    if not 0.0 < stroke_mm < CrankSlider(longest, rod, offset).stroke_mm:
        raise WrongInput(
            f"a rod of {rod:g} mm cannot give the stroke of {stroke_mm:.6g} mm that follows from the law",
            key="linkage.rod_mm",
        )
    return CrankSlider(crank_of_stroke_mm(stroke_mm, rod, offset), rod, offset)
