"""Lengths of the mechanism that are free: found before all else, for the least flank load with a middle flywheel."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from ncgear.design.reading.design_file import LoadedDesign, parsed
from ncgear.design.rewritten import design_copy
from ncgear.project.free_lengths import best_lengths, changed_keys
from ncgear.whole_machines.laws import flywheel_sizes, law_design


def with_best_lengths(loaded: LoadedDesign, tell: Callable[[int], None]) -> tuple[LoadedDesign, Mapping[str, float]]:
    """The design with the lengths that were chosen, and these by their keys under ``optimize.lengths``.

    ``tell`` is called with the number of mechanisms looked at.  Raises NoSuchMechanism where no lengths of the ranges
    have a law.
    """
    design = loaded.design
    assert design.optimize is not None
    sizes = flywheel_sizes(design)
    sought = law_design(design, sizes[len(sizes) // 2])
    assert sought.optimize is not None
    free = sought.optimize.model_copy(update={"lengths": design.optimize.lengths})
    found = best_lengths(sought.model_copy(update={"optimize": free}), None, tell)
    text = design_copy(loaded, changed_keys(design, found.design))
    return parsed(text, Path("machine.yaml")), found.values
