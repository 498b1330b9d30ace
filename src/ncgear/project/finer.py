"""The search for the least change of a size, for example a number of teeth, with which gears are good.

Each trial makes the changed gears.  Numbers grow until a number is good.  Then the interval is halved until the number
just below the found number is known not to be good.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from math import ceil
from time import process_time

from ncgear.design.keys.gears import MOST_TEETH
from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.interrupts import TimeIsOver, at_most
from ncgear.project.alternatives import Changes, changed_drive, is_accepted, resized
from ncgear.project.drive import Drive
from ncgear.project.tolerance_limits import MOST_JAMMED, backlash_key, jamming_of

MOST_FINER = 10
"""Most teeth that are tried, as a multiple of the design's: teeth a tenth as large are another pair of gears."""

FINER_STEP = 1.5
"""Factor between the numbers of teeth that are tried from an estimate on, until one works: smaller numbers cost time
and are refused."""


def require_made(drive: Drive) -> None:
    """Raise WrongInput or NoSuchMechanism where teeth, their contact or their outlines are refused; makes no body."""
    from ncgear.contact.written.as_written import Outlines

    for pair in drive.by_stage:
        pair.require_sound_teeth()
        teeth = pair.teeth
        pair.contact([Outlines("points", teeth.driving.outline_mm, teeth.driven.outline_mm)])


Does = Callable[[int], bool | None]
"""Whether a number works; None where the time is over before that is known."""


def fewest(does: Does, low: int, most: int, each: int = 1, needed: float = 0.0, about: float = FINER_STEP - 1.0) -> int:
    """The least multiple of ``each`` over ``low`` that works, up to ``most``; 0 where none was found.

    The trials begin at ``needed``; the least number is expected within a share ``about`` of it.
    """
    high, found = most + each, 0

    def more() -> int:
        step = 1.0 + about if low >= needed else FINER_STEP
        return min(_up(max(needed, step * low), each), most)

    def between() -> int:
        return _up(max((low + high - each) / 2.0, (1.0 - about) * high - each), each)

    count = more()
    while low < count < high:
        answer = does(count)
        if answer is None:
            break
        if answer:
            high = found = count
        else:
            low = count
        count = between() if found else more()
    return found


def _up(count: float, each: int) -> int:
    return ceil(count / each) * each


@dataclass(frozen=True)
class Least:
    """Changes that work, and the greatest change that does not; ``is_whole`` is false where time ended the search.

    ``changes`` are empty where none was found.
    """

    changes: Changes
    beyond: Changes
    is_whole: bool


Good = Callable[[Drive], bool]


def fewest_teeth(pair: Drive, good: Good, seconds: float) -> Least:
    """The least number of teeth, at the same centre distance, with which a pair is good and can be made."""
    each, low = pair.transmission.lobes.teeth_step, pair.pitch.size.driving_teeth
    most = min(MOST_FINER * low, MOST_TEETH // each * each)
    return _least(pair, lambda count: resized(pair, count), good, seconds, (low, most, each))


def steepest_helix(pair: Drive, good: Good, seconds: float) -> Least:
    """The greatest helix angle in whole degrees, below the given angle, with which a pair is good and can be made."""
    angle = pair.gears.helix.angle_deg if pair.gears.helix else 0.0
    whole = ceil(angle) - 1

    def flatter(step: int) -> Changes:
        return {"gears.helix.angle_deg": whole + 1 - step}

    return _least(pair, flatter, good, seconds, (0, whole, 1))


TENTHS = 10
"""Parts of its backlash by which a pair is tried with less."""


def most_backlash(pair: Drive, good: Good, seconds: float) -> Least:
    """The greatest backlash, in tenths of the given one, with which a pair is good, can be made, and jams no more."""
    key = backlash_key(pair.gears)
    given, jammed = getattr(pair.gears, key), max(_jammed(pair), MOST_JAMMED)

    def less(tenths: int) -> Changes:
        return {f"gears.{key}": float(f"{given * (TENTHS - tenths) / TENTHS:.3g}")}

    def turns(changed: Drive) -> bool:
        return good(changed) and _jammed(changed) <= jammed

    return _least(pair, less, turns, seconds, (0, TENTHS, 1))


def _jammed(pair: Drive) -> float:
    """The share of assemblies that jam; 0 where no grade of tolerances holds for the gears, so that none is known."""
    try:
        return jamming_of(pair).share
    except DesignError:
        return 0.0


def _least(
    pair: Drive, changes: Callable[[int], Changes], good: Good, seconds: float, numbers: tuple[int, int, int]
) -> Least:
    """The least number, from ``low`` on, with whose changes a pair is good, can be made, and may be in the file."""
    begun, failed, is_whole = process_time(), list[int](), True

    def does(count: int, is_so: Good) -> bool | None:
        nonlocal is_whole
        try:
            with suppress(DesignError), at_most(seconds - (process_time() - begun)):
                if is_so(changed_drive(pair.whole, changes(count))):
                    return True
        except TimeIsOver:
            is_whole = False
            return None
        failed.append(count)
        return False

    def is_good(whole: Drive) -> bool:
        return good(whole.of_stage(pair.stage))

    def is_made(whole: Drive) -> bool:
        require_made(whole)
        return True

    low, most, each = numbers
    if not is_accepted(pair.design, changes(low + each)):
        return Least({}, {}, True)
    # Contact of the outlines takes longest, and hardly ever refuses good gears
    while found := fewest(lambda count: does(count, is_good), low, most, each, needed=float(low + each)):
        answer = does(found, is_made)
        if answer:
            break
        low = found if answer is False else most
    beyond = max((fault for fault in failed if not found or fault < found), default=None)
    return Least(changes(found) if found else {}, {} if beyond is None else changes(beyond), is_whole)
