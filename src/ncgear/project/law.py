"""From keys to values: the closed law of a design on its mechanism, the lobes of its gears, the load of its slider."""

from __future__ import annotations

from math import degrees

from ncgear.design.keys.design import Design
from ncgear.design.keys.machine import StrokeForce
from ncgear.design.mechanisms import mechanism_of, mechanism_of_stroke
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.mechanisms.resistance import FormulaResistance, PolynomialResistance, Resistance, TableResistance
from ncgear.mechanisms.slider_load import NO_RESISTANCE, SliderLoad
from ncgear.ratio.transmission import CLOSED, Law, Lobes


def law_of(design: Design) -> Law:
    """The design's closed law on its mechanism.

    Raises WrongInput for values that contradict each other, NoSuchMechanism when no such motion exists.
    """
    motion, lobes = design.motion, lobes_of(design)
    if motion.gives_stroke:
        return motion.law_on(mechanism_of_stroke(design.linkage, motion.solved_stroke_mm()), lobes)
    law = motion.law_on(mechanism_of(design.linkage), lobes)
    covered = law.transmission.lobes.range
    if covered is not None and covered.driven_rad > law.linkage.working_angle_rad * (1.0 + CLOSED):
        raise NoSuchMechanism(
            f"the driven gear turns by {degrees(covered.driven_rad):.5g} deg and the crank's working stroke is "
            f"{degrees(law.linkage.working_angle_rad):.5g} deg: gears that turn less than once stay within it; a "
            "smaller range, or a greater ratio, is right",
            key="motion",
        )
    return law


def require_whole_turns(design: Design, what: str) -> None:
    """Raise WrongInput where the gears turn less than once; ``what`` is not offered for these."""
    if design.motion.is_open:
        raise WrongInput(
            f"{design.motion.law} over a range, with which gears turn to and fro, less than once; {what} is offered "
            "for gears that turn on and on",
            key="motion.law",
        )


def lobes_of(design: Design) -> Lobes:
    """Lobes of both gears; one each where the file has no gears."""
    return Lobes(design.gears.lobes.driving, design.gears.lobes.driven) if design.gears else Lobes()


def load_of(design: Design) -> SliderLoad:
    """The load of the slider; without force where the file has none."""
    given = design.resistance
    if given is None:
        return SliderLoad()
    return SliderLoad(
        working=_resistance_of(given, "resistance"),
        returning=_resistance_of(given.returning, "resistance.returning"),
        friction_n=given.friction_n,
    )


def _resistance_of(given: StrokeForce | None, key: str) -> Resistance:
    """The resistance of one stroke, whose keys are below ``key``."""
    if given is None:
        return NO_RESISTANCE
    keep = given.where_negative == "keep"
    if given.table is not None:
        return TableResistance(given.table.displacement_mm or (), given.table.force_n or (), keep)
    if given.expression_n is not None:
        return FormulaResistance(given.expression_n, keep, f"{key}.expression_n")
    return PolynomialResistance(given.polynomial_n, keep) if given.polynomial_n else NO_RESISTANCE
