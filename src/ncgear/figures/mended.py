"""What is told of mended designs: the change that makes refused teeth, the ways that do not, the mended design file."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from textwrap import wrap

from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.rewritten import told_copy
from ncgear.design.words import listed
from ncgear.errors import DesignError
from ncgear.figures.advice.values import Change, changed, in_file
from ncgear.figures.numbers import to_digits
from ncgear.figures.tables import WIDTH
from ncgear.figures.terminal import INDENT
from ncgear.project.mending import BACKLASH, ROOT_RADIUS, Mend, Mending, MendingSubject, MendingWay

SUFFIX = "-mended"


def refusal_with_help(mending: Mending, option: str = "") -> DesignError:
    """The refusal with the change that makes the teeth or, where there is none, with all ways that were tried.

    ``option`` is the option of the command that takes the change; without it none is named.
    """
    refusal, found = mending.refusal, mending.found
    if found is None:
        rest = "" if mending.is_whole else "; not searched further"
        told = f"none of the ways that were tried makes these teeth: {tried_words(mending.failed)}{rest}"
    else:
        told = f"what works: {found_words(found)}{_fewer_words(mending, found)}" + (
            f"; {option} takes it" if option else ""
        )
    return refusal.saying(f"{refusal.problem}; {told}")


def _fewer_words(mending: Mending, found: Mend) -> str:
    """What is known of fewer teeth where a change is a number of teeth, and time ended the search for the least one."""
    if mending.is_whole or found.way.kinds != (MendingSubject.FINER,):
        return ""
    count = found.drive.by_stage[0].pitch.size.driving_teeth
    fewer = [way.changes["gears.teeth"] for way in mending.failed if way.kinds == (MendingSubject.FINER,)]
    below = [number for number in fewer if isinstance(number, int) and number < count]
    refused = f"; {max(below)} are refused" if below else ""
    return f"{refused}; whether fewer do was not searched further"


def mended_words(mending: Mending, found: Mend) -> tuple[str, ...]:
    """What a command says that has taken a change, sentence by sentence."""
    return (
        "Mended: these are not the gears of the file, whose teeth are refused, but those "
        f"{_with_changes(found)} {_figures_words(found)}.",
        f"Refused: {mending.refusal.problem}",
    )


def in_lines(said: Sequence[str]) -> str:
    """Sentences in lines for a terminal."""
    return "\n".join(line for text in said for line in wrap(text, WIDTH, subsequent_indent=INDENT))


def found_words(found: Mend) -> str:
    """A change and its figures."""
    return f"{listed(map(str, _in_file(found)), 'and')} {_figures_words(found)}"


def _figures_words(found: Mend) -> str:
    ratio, angle = to_digits(found.contact_ratio, 3), to_digits(found.pressure_angle_deg, 3)
    return f"(contact ratio {ratio}, pressure angle {angle} deg)"


def _in_file(found: Mend) -> tuple[Change, ...]:
    return in_file(found.drive.design, changed(found.way.changes))


def _with_changes(found: Mend) -> str:
    """The keys that a change gives, with their values, and those that it leaves out, after a noun."""
    changes = _in_file(found)
    given = listed((str(change) for change in changes if change.value is not None), "and")
    out = listed((change.key for change in changes if change.value is None), "and")
    return " and ".join(f"{word} {keys}" for word, keys in (("with", given), ("without", out)) if keys)


def tried_words(ways: Sequence[MendingWay]) -> str:
    """Ways of the same kinds in a few words each."""
    return "; ".join(
        " with ".join(_words(kind, list(alike)) for kind in kinds)
        for kinds, alike in ((kinds, list(group)) for kinds, group in groupby(ways, lambda way: way.kinds))
    )


def _words(kind: MendingSubject, alike: Sequence[MendingWay]) -> str:
    def values(key: str) -> str:
        found = dict.fromkeys(way.changes[key] for way in alike if way.changes.get(key) is not None)
        return listed(to_digits(value, 4) if isinstance(value, float) else str(value) for value in found)

    match kind:
        case MendingSubject.ROOT_RADIUS:
            return f"a root radius of {values(ROOT_RADIUS)}"
        case MendingSubject.BACKLASH:
            return f"a backlash of {values(BACKLASH[0]) or values(BACKLASH[1])}"
        case MendingSubject.UNSHIFTED:
            return "no profile shift"
        case MendingSubject.MATE:
            return "the mate as tool"
        case MendingSubject.STEEPER | MendingSubject.STEEPEST:
            return f"a rack of {values('gears.rack.pressure_angle_deg')} deg"
        case MendingSubject.SHIFTED:
            driving = [way.changes.get("gears.profile_shift.driving") for way in alike]
            shifts = dict.fromkeys("against undercut" if radius is None else f"{radius:g}" for radius in driving)
            return f"profile shift {listed(shifts)}"
        case MendingSubject.UNDERCUT:
            return "undercut allowed"
        case MendingSubject.FINER:
            return f"{values('gears.teeth')} teeth of a smaller module"


def mended_design(loaded: LoadedDesign, found: Mend) -> str:
    """The text of a design file with a change, its name and description saying so; its comments stay."""
    said = f"Mended: {loaded.design.name} {_with_changes(found)}, a change without which its teeth are refused."
    return told_copy(loaded, SUFFIX, said, found.way.changes)
