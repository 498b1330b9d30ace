"""The best lengths of a design's mechanism: from ranges of lengths and a stroke to the design that has them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import ceil
from typing import TYPE_CHECKING, Any

from ncgear.design.keys.base import Model
from ncgear.design.keys.design import Design
from ncgear.design.keys.masses import Masses, Rod
from ncgear.design.mechanisms import lengths_of, mechanism_of
from ncgear.errors import NoSuchMechanism
from ncgear.extras import require
from ncgear.frozen import dataclass
from ncgear.optimum.lengths import LengthSearch, Unknown, Values, least_with_any_lengths
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Task
from ncgear.project.law_task import inertia_as_given, task_of, wishes_of, with_driven_flywheel

if TYPE_CHECKING:
    from ncgear.optimum.certified.limit import Motion

STROKE = ("stroke_mm", "stroke_deg")
"""The keys of the stroke, which is not a length of the linkage: the crank follows from it."""

FLYWHEEL = "driven_flywheel_kg_mm2"

DIGITS = 10
"""Digits of the masses of a rod that grows."""

CRANK_STEP = 1e-6
"""Step in mm to which the crank is rounded up, so that a place at the very end of a fixed stroke stays within it."""


@dataclass(frozen=True, eq=False)
class BestLengths:
    """Values of the free lengths, by their keys, and the design that has them.

    ``motion`` is the motion of the law found with them, ``least_with_any`` the limit of the goal with any lengths.
    Both are None where no lengths of the ranges have a law; the lengths are then as given.
    """

    values: Mapping[str, float]
    design: Design
    motion: Motion | None = None
    least_with_any: float | None = None


def best_lengths(given: Design, motion: Motion | None, tell: Callable[[int], None]) -> BestLengths:
    """The best lengths of a design that has ranges of them, with its gears as given.

    A free flywheel is searched with them, from the flywheel and the motion of the design.  ``tell`` is called with the
    number of laws searched.  Raises WrongInput where the optimiser is not installed.
    """
    require("casadi", "optimize", "ncgear optimize")
    ranges = dict(given.free_lengths)
    if given.free_flywheel is not None:
        ranges[FLYWHEEL] = given.free_flywheel
    inertia = inertia_as_given(given)

    def machine(values: Values) -> tuple[Task, Wishes]:
        design = with_lengths(given, dict(zip(ranges, values, strict=True)))
        return task_of(design, inertia), wishes_of(design)

    unknowns = [Unknown(span.least, span.most, _given(given, name)) for name, span in ranges.items()]
    try:
        best = LengthSearch(unknowns, machine, tell).best(motion)
    except NoSuchMechanism:
        return BestLengths({name: _given(given, name) for name in given.free_lengths}, given)
    values = dict(zip(ranges, best.values, strict=True))
    stroke = next((span.least / _per_stroke(given) for name, span in ranges.items() if name in STROKE), None)
    found = with_lengths(given, values)
    least = least_with_any_lengths(task_of(given, inertia), wishes_of(found), stroke)
    values.pop(FLYWHEEL, None)
    return BestLengths(values, found, best.law.motion, least)


def with_lengths(design: Design, values: Mapping[str, float]) -> Design:
    """The design with other values of unknowns, and the crank that gives its stroke; as given where none differ.

    A rod or coupler keeps its section: its mass grows with its length, its moment of inertia with the third power.  All
    other masses stay.  Raises WrongInput where no such mechanism has the stroke.
    """
    changed = {name: value for name, value in values.items() if value != _given(design, name)}
    if FLYWHEEL in changed:
        design = with_driven_flywheel(design, changed.pop(FLYWHEEL))
    if not changed:
        return design
    linkage, factor = mechanism_of(design.linkage), _per_stroke(design)
    stroke = next((changed.pop(name) / factor for name in STROKE if name in changed), linkage.stroke_mm)
    others = {**lengths_of(design.linkage), **changed}
    del others[linkage.STROKE_KEY]
    crank_mm = type(linkage).of_stroke(stroke, **others).crank_mm
    made = {**changed, linkage.STROKE_KEY: ceil(crank_mm / CRANK_STEP - CRANK_STEP) * CRANK_STEP}
    found: dict[str, Any] = {"linkage": design.linkage.model_copy(update=made)}
    if design.masses is not None:
        grown = dict(_grown(design.masses, changed, design.linkage))
        found["masses"] = design.masses.model_copy(update=grown)
    return design.model_copy(update=found)


def _grown(masses: Masses, lengths: Mapping[str, float], linkage: Model) -> Iterator[tuple[str, Rod]]:
    """Rods and couplers with other lengths, by their keys under ``masses``."""
    for name in type(masses).model_fields:
        rod, key = getattr(masses, name), f"{name}_mm"
        if isinstance(rod, Rod) and key in lengths:
            by = lengths[key] / getattr(linkage, key)
            powers = {"mass_kg": 1, "center_mm": 1, "inertia_kg_mm2": 3}
            grown = {field: float(f"{getattr(rod, field) * by**power:.{DIGITS}g}") for field, power in powers.items()}
            yield name, rod.model_copy(update=grown)


def _given(design: Design, name: str) -> float:
    """The value of an unknown in a design, in the unit of its key."""
    if name == FLYWHEEL:
        assert design.masses is not None
        return design.masses.driven_flywheel_kg_mm2
    if name in STROKE:
        return mechanism_of(design.linkage).stroke_mm * _per_stroke(design)
    return getattr(design.linkage, name)


def _per_stroke(design: Design) -> float:
    """Number of units of the stroke's key per mm or rad."""
    return mechanism_of(design.linkage).OUTPUT.place.factor


def changed_keys(given: Design, found: Design) -> dict[str, float]:
    """The dotted keys of lengths and rods in which two designs differ, with the values of the second design."""
    groups = {"linkage": (given.linkage, found.linkage)}
    if given.masses is not None and found.masses is not None:
        rods = [name for name in type(found.masses).model_fields if isinstance(getattr(found.masses, name), Rod)]
        groups |= {f"masses.{name}": (getattr(given.masses, name), getattr(found.masses, name)) for name in rods}
    return {
        f"{group}.{name}": getattr(after, name)
        for group, (before, after) in groups.items()
        for name in type(after).model_fields
        if getattr(before, name) != getattr(after, name)
    }
