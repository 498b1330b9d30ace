"""An advice: what is special about a machine, what that means, and what to change, as a plain value."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from ncgear.figures.numbers import shown
from ncgear.project.alternatives import Changes, Setting

SHOWN = 3
"""Numbers of a list that a line of text has room for."""


class Kind(StrEnum):
    """What an advice is about."""

    RATIO_RANGE = "ratio_range"
    SPEEDS = "speeds"
    NEGATIVE_RESISTANCE = "negative_resistance"
    PRESSURE_ANGLE = "pressure_angle"
    RING = "ring"
    CONCAVE = "concave"
    UNDERCUT = "undercut"
    POINTED = "pointed"
    SHORTENED = "shortened"
    CONTACT_RATIO = "contact_ratio"
    THRUST = "thrust"


@dataclass(frozen=True)
class Change:
    """A key of the design file, dotted, and what to set it to."""

    key: str
    value: Setting

    def __str__(self) -> str:
        return f"leave {self.key} out" if self.value is None else f"{self.key}: {_written(self.value)}"


def changed(changes: Changes) -> tuple[Change, ...]:
    """Keys and their values as changes."""
    return tuple(Change(key, value) for key, value in changes.items())


@dataclass(frozen=True)
class Remedy:
    """One way out: in words, the changes of the design file that it takes, and the command that then does it.

    ``command`` is empty where the changes alone do it.
    """

    text: str
    changes: tuple[Change, ...] = ()
    command: str = ""

    def __str__(self) -> str:
        taken = ", ".join(map(str, self.changes))
        then = f", then {self.command}" if self.command else ""
        return f"{self.text} ({taken}{then})" if taken else self.text


@dataclass(frozen=True)
class Where:
    """What an advice is about: one gear or the pair, its teeth, stretches of the driving angle in degrees.

    ``gear`` is driving, driven or empty for the pair; a stretch of no length is a single angle.
    """

    gear: str = ""
    teeth: tuple[int, ...] = ()
    angles_deg: tuple[tuple[float, float], ...] = ()

    def __str__(self) -> str:
        word = "tooth" if len(self.teeth) == 1 else "teeth"
        teeth = f"{word} {shown(list(self.teeth))}" if self.teeth else ""
        of = f"{self.gear} gear" if self.gear else ""
        named = " of the ".join(part for part in (teeth, of) if part)
        return ", ".join(part for part in (named, _stretches(self.angles_deg)) if part)


@dataclass(frozen=True)
class Advice:
    """Something a designer should know before cutting metal.

    ``what`` says what there is and where, with its numbers; ``meaning`` what it means for the machine; ``remedies``
    what to change, the least costly first; none where nothing is wrong and only to be known.
    """

    kind: Kind
    where: tuple[Where, ...]
    what: str
    meaning: str
    remedies: tuple[Remedy, ...] = ()

    @property
    def line(self) -> str:
        """The whole advice in one line of text."""
        said = f"{self.what}; {self.meaning}"
        return f"{said}. To change it: {'; or '.join(map(str, self.remedies))}" if self.remedies else said


def _written(value: Setting) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        more = [f"and {len(value) - SHOWN} more"] if len(value) > SHOWN else []
        return f"[{', '.join([*(f'{number:.6g}' for number in value[:SHOWN]), *more])}]"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _stretches(angles_deg: tuple[tuple[float, float], ...]) -> str:
    named = ", ".join(f"{a:.4g}" if a == b else f"{a:.0f}..{b:.0f}" for a, b in angles_deg)
    return f"phi1 = {named} deg" if named else ""
