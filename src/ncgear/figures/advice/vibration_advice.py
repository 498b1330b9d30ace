"""What is said of a mesh that resonates at some place of the turn, and of what is not known of that."""

from __future__ import annotations

from collections.abc import Iterator

from ncgear.figures.advice.values import Advice, Kind, NotJudged, Remedy, Where
from ncgear.figures.numbers import to_digits
from ncgear.figures.vibration import BAND, stretches_words, vibration_of_rating
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.project.drive import Drive
from ncgear.project.rough_strength import beside_refusal, rough_strength
from ncgear.project.strengthening import Rating, known_rating
from ncgear.project.vibration import ToldVibration

LOADS_UNKNOWN = "the loads of the teeth are not followed"
"""Why a mesh is not judged whose strength is not computed, where no other reason is known."""


def vibration(drive: Drive) -> Iterator[Advice | NotJudged]:
    """Where the rated teeth resonate."""
    rating = known_rating(drive)
    if isinstance(rating, Rating):
        yield from _resonance(drive, vibration_of_rating(drive, rating))
    elif (found := beside_refusal(drive, rating)) is not None:
        yield NotJudged(found.unjudged or found.needs_teeth or LOADS_UNKNOWN)


def rough(drive: Drive) -> Iterator[Advice | NotJudged]:
    """The same without teeth: the resonance ratio goes as the root of a stiffness that is known without them, too."""
    found = rough_strength(drive)
    if found is None:
        return
    if found.unjudged:
        yield NotJudged(found.unjudged)
    yield from _resonance(drive, found.vibration)


def _resonance(drive: Drive, told: ToldVibration | None) -> Iterator[Advice]:
    if told is None or not told.resonates_deg or told.critical_rpm is None:
        return
    speed, (low, high) = f"{drive.design.operation.speed_rpm:g} r/min", told.critical_rpm
    where = stretches_words(told)
    yield Advice(
        Kind.VIBRATION,
        (Where(angles_deg=told.resonates_deg),),
        f"the mesh resonates ({BAND}) {where} at {speed}: K_V is {to_digits(told.factor, 2)} where teeth bear most",
        "teeth part and hammer, and gears howl; K_V is least sure there, and is for gears that stay in the resonance",
        (
            Remedy(
                f"run under {shown_below(low, 2)} r/min or over {shown_above(high, 2)} r/min", short="another speed"
            ),
            Remedy("take lighter gears, or fewer and larger teeth, which pass more slowly", short="fewer teeth"),
        ),
        brief=f"the mesh resonates ({BAND}) {where} at {speed}",
    )
