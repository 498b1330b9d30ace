"""An advice as a plain value: a special feature of a machine, what it means, and what to change."""

from __future__ import annotations

from enum import StrEnum

from ncgear.design.keys.design import Design
from ncgear.figures.numbers import to_digits
from ncgear.frozen import dataclass
from ncgear.project.alternatives import Changes, Setting

SHOWN = 3
"""Numbers of a list that a line of text shows."""


class Kind(StrEnum):
    """The features that have an advice, the most serious first: what breaks or knocks, what moves wrongly, what costs
    work to make.
    """

    MADE = "made"
    STRENGTH = "strength"
    FLANKS = "flanks"
    VIBRATION = "vibration"
    ROOM = "room"
    JAMS = "jams"
    CONTACT_RATIO = "contact_ratio"
    PRESSURE_ANGLE = "pressure_angle"
    TRANSMISSION_ANGLE = "transmission_angle"
    CRANK_PIN = "crank_pin"
    ROD = "rod"
    MOTOR = "motor"
    DRIVETRAIN = "drivetrain"
    MISSED_WISH = "missed_wish"
    SPEEDS = "speeds"
    DRAWING = "drawing"
    NEGATIVE_RESISTANCE = "negative_resistance"
    WITHOUT_EFFECT = "without_effect"
    RATIO_RANGE = "ratio_range"
    INDEX_HOLES = "index_holes"
    UNDERCUT = "undercut"
    POINTED = "pointed"
    SHORTENED = "shortened"
    CONCAVE = "concave"
    RING = "ring"
    THRUST = "thrust"
    IDLE_FLANKS = "idle_flanks"


@dataclass(frozen=True)
class Change:
    """A key of the design file, dotted, and the value to set it to; None leaves the key out."""

    key: str
    value: Setting

    def __str__(self) -> str:
        return f"leave {self.key} out" if self.value is None else f"{self.key}: {_written(self.value)}"


def changed(changes: Changes) -> tuple[Change, ...]:
    """Changes from keys and their new values."""
    return tuple(Change(key, value) for key, value in changes.items())


def in_file(design: Design, changes: tuple[Change, ...]) -> tuple[Change, ...]:
    """Changes that a design's file may have, by the keys of the file."""
    return tuple(Change(design.key_in_file(change.key) or change.key, change.value) for change in changes)


class RemedySearch(StrEnum):
    """What trials may tell of a remedy that has no value, or a rough one."""

    FINER = "more, smaller teeth"
    FLATTER = "a smaller helix angle"
    CLOSER = "less backlash"
    CROWNED = "crowned flanks"
    WIDER = "a wider face"
    LARGER = "a larger module"
    HELICAL = "helical teeth"
    STRONGER = "a stronger material"


@dataclass(frozen=True)
class Remedy:
    """One way to cure what an advice tells: words, changes of the design file, and the command to run after them.

    ``command`` is empty where the changes are enough.
    ``search`` says which trials tell a value, or a better one; None where none is left to be told.
    """

    text: str
    changes: tuple[Change, ...] = ()
    command: str = ""
    search: RemedySearch | None = None

    @property
    def brief(self) -> str:
        """The remedy in a few words: its changes and command or, where it has none, its text."""
        if not self.changes:
            return self.text
        taken = ", ".join(map(str, self.changes))
        return f"{taken}, then {self.command}" if self.command else taken

    def __str__(self) -> str:
        taken = ", ".join(map(str, self.changes))
        then = f", then {self.command}" if self.command else ""
        return f"{self.text} ({taken}{then})" if taken else self.text


@dataclass(frozen=True)
class Advice:
    """Something a designer should know before cutting metal.

    ``what`` says in a part of a line what was found, with its chief number.  ``meaning`` says where and what that means
    for the machine, with all other numbers.  ``remedies`` say what to change, the least costly first; they are empty
    where nothing is wrong.  What does not matter is a remark, not a warning.
    """

    kind: Kind
    what: str
    meaning: str = ""
    remedies: tuple[Remedy, ...] = ()
    matters: bool = True

    @property
    def line(self) -> str:
        """The whole advice in one line of text."""
        said = f"{self.what}; {self.meaning}" if self.meaning else self.what
        return f"{said}. To change it: {'; or '.join(map(str, self.remedies))}" if self.remedies else said


@dataclass(frozen=True)
class NotJudged:
    """A condition that was not judged, and why not."""

    why: str


ONLY_TEETH = "only teeth can tell: ncgear build"
"""Why a condition is not judged before teeth are made."""


def _written(value: Setting) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        more = [f"and {len(value) - SHOWN} more"] if len(value) > SHOWN else []
        return f"[{', '.join([*(to_digits(number, 6) for number in value[:SHOWN]), *more])}]"
    return to_digits(value, 6) if isinstance(value, float) else str(value)
