"""Remedies whose value only trials tell: the least number of teeth, or the greatest helix angle, that does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ncgear.figures.advice.values import Advice, Remedy, changed
from ncgear.project.drive import Drive

FINER = Remedy("try more teeth of a smaller module", short="try more, smaller teeth")

LESS_HELIX = Remedy("try a smaller helix angle or face width", short="try a smaller helix angle or face width")

MOST_SECONDS = 5.0
"""Most processor time of the trials of one verdict: who waits for it does not wait longer."""


def with_values(advice: Advice, again: Callable[[Drive], bool], drive: Drive, seconds: float) -> Advice:
    """The advice on a pair with values in the place of remedies that have none, as far as trials find them.

    ``again`` says of a changed pair whether nothing is found of it any more.
    """
    told = tuple(_valued(one, again, drive, seconds) for one in advice.remedies)
    return replace(advice, remedies=told)


def is_without_value(advice: Advice) -> bool:
    """Whether trials may tell more of a remedy."""
    return any(one in (FINER, LESS_HELIX) for one in advice.remedies)


def _valued(remedy: Remedy, again: Callable[[Drive], bool], drive: Drive, seconds: float) -> Remedy:
    from ncgear.project.finer import fewest_teeth, steepest_helix

    if remedy not in (FINER, LESS_HELIX):
        return remedy
    finer = remedy == FINER
    found = (fewest_teeth if finer else steepest_helix)(drive, again, seconds)
    if found.changes:
        rest = "" if found.is_whole else "; a lesser change was not searched further"
        taken = "take more teeth of a smaller module" if finer else "take a smaller helix angle"
        return Remedy(f"{taken}{rest}", changed(found.changes))
    if not found.beyond:
        return remedy
    last = ", ".join(map(str, changed(found.beyond)))
    if not found.is_whole:
        return Remedy(f"{remedy.text} than {last}, which does not do", short=f"{remedy.short} than {last}")
    return Remedy(f"neither {'more, smaller teeth' if finer else 'a smaller helix angle'} do, up to {last}")
