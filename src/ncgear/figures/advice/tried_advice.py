"""Remedies whose value only trials tell: the least number of teeth, face width or module, the material that does."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from math import radians
from time import process_time

from ncgear.figures.advice.values import Advice, Remedy, RemedySearch, changed
from ncgear.figures.numbers import to_digits
from ncgear.interrupts import TimeIsOver, at_most
from ncgear.project import strengthening
from ncgear.project.alternatives import Changes
from ncgear.project.drive import Drive

FINER = Remedy("try more teeth of a smaller module", search=RemedySearch.FINER)

FLATTER = Remedy("try a smaller helix angle", search=RemedySearch.FLATTER)

CLOSER = Remedy("try less backlash", search=RemedySearch.CLOSER)

MOST_SECONDS = 5.0
"""Most processor time of the trials of one verdict: who waits for it does not wait longer."""

ENOUGH: dict[RemedySearch, tuple[Callable[[Drive, strengthening.Rating], Changes], str]] = {
    RemedySearch.CROWNED: (strengthening.crowned_enough, "crown the flanks"),
    RemedySearch.WIDER: (strengthening.wide_enough, "make the gears wider"),
    RemedySearch.LARGER: (strengthening.large_enough, "take a larger module"),
    RemedySearch.HELICAL: (strengthening.helical_enough, "cut helical teeth"),
    RemedySearch.STRONGER: (strengthening.strong_enough, "take a stronger material"),
}
"""What is tried of teeth that do not hold, and the words for what does."""

Good = Callable[[Drive], bool]


def with_values(advice: Advice, again: Good, drive: Drive, seconds: float) -> Advice:
    """The advice on a pair with the values of remedies that trials tell, within some processor time.

    ``again`` says of a changed pair whether nothing is found of it any more.  A remedy that does not do when it is
    tried is left out.
    """
    ends, told = process_time() + seconds, []
    for remedy in advice.remedies:
        found = remedy if remedy.search is None else _valued(remedy, remedy.search, again, drive, ends - process_time())
        if found is not None:
            told.append(found)
    return replace(advice, remedies=tuple(told))


def is_without_value(advice: Advice) -> bool:
    """Whether trials may tell more of a remedy."""
    return any(remedy.search is not None for remedy in advice.remedies)


def _valued(remedy: Remedy, search: RemedySearch, again: Good, drive: Drive, seconds: float) -> Remedy | None:
    if search not in ENOUGH:
        return _of_teeth(remedy, search, again, drive, seconds)
    rating = strengthening.known_rating(drive)
    with suppress(TimeIsOver), at_most(seconds):
        return enough(search, drive, rating) if isinstance(rating, strengthening.Rating) else None
    return remedy


def enough(search: RemedySearch, drive: Drive, rating: strengthening.Rating) -> Remedy | None:
    """The least change of one of ENOUGH with which rated teeth hold; None where none does."""
    found, words = ENOUGH[search]
    changes = found(drive, rating)
    if changes.get("gears.helix.kind") == "helical":
        thrust_n = strengthening.largest_thrust_n(drive, rating, radians(float(str(changes["gears.helix.angle_deg"]))))
        words += f", which thrust up to {to_digits(thrust_n, 2)} N along the shafts"
    return Remedy(words, changed(changes)) if changes else None


def _of_teeth(remedy: Remedy, search: RemedySearch, again: Good, drive: Drive, seconds: float) -> Remedy | None:
    """More teeth, helical ones of a smaller angle, or less backlash; None where none helps of all that were tried."""
    from ncgear.project.finer import fewest_teeth, most_backlash, steepest_helix

    tried = {RemedySearch.FINER: fewest_teeth, RemedySearch.FLATTER: steepest_helix, RemedySearch.CLOSER: most_backlash}
    found = tried[search](drive, again, seconds)
    if found.changes:
        return Remedy(f"take {search}", changed(found.changes))
    if found.is_whole:
        return None
    last = ", ".join(map(str, changed(found.beyond)))
    return Remedy(f"{remedy.text} than {last}, which does not do") if last else remedy
