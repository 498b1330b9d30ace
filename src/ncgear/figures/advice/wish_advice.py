"""The advice about wishes of the motion that a law does not keep."""

from __future__ import annotations

from ncgear.figures.advice.values import Advice, Kind, Remedy, Where
from ncgear.figures.wished import missed_by
from ncgear.project.drive import Drive

NAMED = 3
"""Missed wishes that are named in brief, the first with what it misses; how many more there are is told."""


def missed_wishes(drive: Drive) -> Advice | None:
    """The hard wishes that the motion misses, and by how much."""
    outcomes = drive.achieved.outcomes if drive.achieved else ()
    hard = [outcome for outcome in outcomes if outcome.wish.hard]
    missed = [outcome for outcome in hard if not outcome.kept]
    if not missed:
        return None
    count = f"{len(missed)} of {len(hard)} {'' if len(hard) == len(outcomes) else 'hard '}wishes"
    named = ", ".join(f"{outcome.wish.key} (by {missed_by(outcome)})" for outcome in missed)
    shortly = [f"{missed[0].wish.key} by {missed_by(missed[0])}"]
    shortly += [outcome.wish.key.removeprefix("wishes.") for outcome in missed[1:NAMED]]
    more = [f"{len(missed) - NAMED} more by --verbose"] if len(missed) > NAMED else []
    return Advice(
        Kind.MISSED_WISH,
        (Where(),),
        f"the motion misses {count}: {named}",
        f"the {drive.linkage.OUTPUT.name} moves otherwise than is wished",
        (Remedy("let ncgear optimize look for a law that keeps every hard wish", short="ncgear optimize"),),
        brief=f"{count} missed: {', '.join([*shortly, *more])}",
    )
