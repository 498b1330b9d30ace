"""The advices about putting gears together: whether they jam within their tolerances, and what marks their pose."""

from __future__ import annotations

from ncgear.errors import DesignError
from ncgear.figures.advice.values import Advice, Change, Kind, NotJudged, Remedy, Where, changed
from ncgear.figures.numbers import to_digits
from ncgear.figures.tolerance_words import limit_words
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import is_given, room_for_index_hole
from ncgear.project.drive import Drive
from ncgear.project.jamming import Jamming, jamming_of
from ncgear.project.tolerance_limits import MOST_JAMMED
from ncgear.project.tooth_form import thickness_limits_mm

NEARLY_ALL = 0.995

OTHER_WAYS = Remedy(
    "take finer tolerances or larger teeth: so much backlash would leave no teeth",
    short="finer tolerances or larger teeth",
)


def jams(drive: Drive) -> Advice | NotJudged | None:
    """Assemblies of a pair that jam, as estimated; None where no more than one in a hundred does.

    Not judged where the file gives a backlash of 0, since the exact pair is wanted then, where no grade holds for the
    gears, and where another pair in series with these has no sound contact.
    """
    try:
        found = jamming_of(drive)
    except DesignError as error:
        return NotJudged(error.problem)
    if found.share <= MOST_JAMMED:
        return None
    share = "nearly all" if found.share > NEARLY_ALL else f"about {to_digits(100.0 * found.share, 2)} % of the"
    if found.given == 0.0 and is_given(drive.design, found.key):
        return NotJudged(f"a backlash of 0 is written down: {share} assemblies of the exact pair jam")
    unit = found.key.rpartition("_")[2]
    has = f"the backlash is {found.given:g} {unit}" if found.given else "the teeth have no backlash"
    if thickness_limits_mm(drive.gears):
        has += ", the teeth are the thickest that the file allows"
    return Advice(
        Kind.JAMS,
        (Where(),),
        f"{share} assemblies jam: {has}, and with {', '.join(limit_words(found.tolerances))} "
        f"({_made(found)}) it takes {found.enough:g} {unit} for 99.9 % to turn",
        "both flanks of a tooth are pressed somewhere; ncgear tolerance draws assemblies one by one",
        _ways_out(found),
        brief=f"{share} assemblies jam, {_made(found)}",
    )


def _made(found: Jamming) -> str:
    """By what tolerances the gears are made."""
    return "made as tolerances says" if found.process is None else f"{found.process} as usual"


def _ways_out(found: Jamming) -> tuple[Remedy, ...]:
    backlash = Remedy("give the teeth so much backlash", (Change(found.key, found.enough),))
    narrower = Remedy(
        "make the gears narrower: over their width tilted teeth take the backlash", changed(found.narrower)
    )
    ways = (*([narrower] if found.narrower else []), *([backlash] if found.fits else []))
    return ways or (OTHER_WAYS,)


def index_holes(drive: Drive) -> Advice | NotJudged | None:
    """The gears that have no room for the index hole that the file asks for; None where both have theirs."""
    try:
        plans = dict(zip(Gear, drive.finished_plans, strict=True))
    except DesignError as error:
        return NotJudged(error.problem)
    lacking = [gear for gear in Gear if plans[gear].index_hole is None]
    if not lacking:
        return None
    names = " and ".join(gear.value for gear in lacking)
    what = f"no room for the index hole of the {names} gear{'s' if lacking[1:] else ''}"
    found = [room_for_index_hole(drive, gear) for gear in lacking]
    room = [Remedy("make room for it", changed({key: one[key] for one in found for key in one}))] if all(found) else []
    without = Remedy("do without, and mark a tooth and its space by hand", (Change("gears.index_holes", value=False),))
    meaning = "nothing on them shows which teeth go together"
    return Advice(
        Kind.INDEX_HOLES, tuple(Where(gear.value) for gear in lacking), what, meaning, (*room, without), brief=what
    )
