"""The motion laws that a design file can name, one line each, and the motions that ncgear itself gives a design.

To add a law ``<name>``:

1. its mathematics, a function that returns a ``Transmission``, in ``ratio/laws``;
2. ``design/laws/<name>.py``: a class called by the law's name, with its keys, how the law is made from them, and the
   words of the menu (``design/laws/base.py`` explains each of them); the law's part of a new design file,
   ``design/templates/laws/<name>.yaml``;
3. a line in ``LawName`` below;
4. its closed form, or the reason why it has none: a line in ``formulas/laws.py``;
5. ``make docs``, which writes its keys in words;
6. a line in ``REFERENCES`` of ``tests/oracles/laws.py``: the same law, computed independently of ncgear.

All lists of laws follow from this one: the models of ``motion`` and the JSON Schema, error messages, ``ncgear
explain``, the menu and the choices of ``ncgear new``, and the tests of all laws.  This module imports no other module
until a law is asked for, so that the command line can complete the names of laws without loading pydantic.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ncgear.design.laws.base import LawKeys


class LawName(StrEnum):
    """The values of ``motion.law``; each is also the name of the module that describes the law."""

    THREE_SEGMENT_STROKE = "three_segment_stroke"
    RATIO_EXPRESSION = "ratio_expression"
    HARMONIC_RATIO = "harmonic_ratio"
    SPLINE_RATIO = "spline_ratio"
    ELLIPSE = "ellipse"
    TABLE = "table"
    PITCH_CURVE = "pitch_curve"
    UNIFORM_CRANK = "uniform_crank"
    SPIRAL = "spiral"
    FUNCTION_GENERATOR = "function_generator"
    IN_SERIES = "in_series"


DEFAULT_LAW = LawName.THREE_SEGMENT_STROKE
"""The law of a new design if no other one is asked for."""

SOUGHT_LAW = LawName.HARMONIC_RATIO
"""The law of a new design whose wishes tell what is sought; the best law replaces it."""


def law_keys(name: LawName) -> type[LawKeys]:
    """The keys and the questions of a law: the class with its name in words, such as ``HarmonicRatio``."""
    return getattr(import_module(f"{__package__}.{name}"), name.title().replace("_", ""))


def law_models() -> dict[str, type[LawKeys]]:
    """The model of the keys of each law, by the law's name."""
    return {str(name): law_keys(name) for name in LawName}


def even_motion(pairs: int) -> LawKeys:
    """A crank that turns evenly, by one pair of round gears or two."""
    law = LawName.HARMONIC_RATIO
    return law_keys(law).model_validate({"law": str(law), "second_stage": {} if pairs > 1 else None})


def found_values(ratio: Sequence[float], second: Sequence[float] | None) -> dict[str, Any]:
    """The block ``motion`` of a design file with the ratios of a found law, and of its second pair if it has one."""
    stage = {} if second is None else {"second_stage": {"ratio": list(second)}}
    return {"law": str(LawName.SPLINE_RATIO), "ratio": list(ratio), **stage}


def found_motion(ratio: Sequence[float], second: Sequence[float] | None) -> LawKeys:
    """The same motion as keys of a design."""
    return law_keys(LawName.SPLINE_RATIO).model_validate(found_values(ratio, second))
