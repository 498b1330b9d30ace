"""The kinds of wishes that a design file can name, one line each, in the order of their judgement and their words.

To add a kind ``<name>``:

1. ``wishes/<name>.py``: its value, which keeps the contract of ``wishes/wish.py``: its requirements on a law, its
   outcome for a motion, its words, and its offer of a wish that can be kept;
2. ``design/wishes/<name>.py``: its keys, and how they make the value (``design/wishes/base.py``);
3. a line in ``KINDS`` below.

The group ``wishes`` of design files, its JSON Schema and its faults, checks, the search for laws and the certified
limit all follow from these lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from ncgear.design.keys.base import Faults, Model, Several, optional
from ncgear.design.wishes.base import Kind, WishKeys
from ncgear.design.wishes.constant_speed import ConstantSpeed
from ncgear.design.wishes.dwell import Dwell
from ncgear.design.wishes.gentle_stop import GentleStop
from ncgear.design.wishes.positions import Position
from ncgear.design.wishes.speed_at import SpeedAt
from ncgear.design.wishes.time_ratio import TimeRatio
from ncgear.design.wishes.working_stroke import WorkingStroke

KINDS: tuple[type[WishKeys], ...] = (
    ConstantSpeed,
    TimeRatio,
    WorkingStroke,
    Dwell,
    SpeedAt,
    GentleStop,
    Position,
)


MOST_WISHES = 50
"""Most wishes of a kind: more than a person writes."""


class KeysOfKinds(Model):
    """The base that gives a class a key for each kind of wish; ``turns=True`` is for a turning output."""

    def __init_subclass__(cls, turns: bool = False, **kwargs: Any) -> None:
        """Annotate the fields before pydantic reads the annotations; kinds with a single wish come first."""
        for kind in sorted(KINDS, key=lambda kind: kind.SEVERAL):
            keys: Any = kind.turning() if turns else kind
            several = Annotated[Several[keys], Field(max_length=MOST_WISHES)]
            cls.__annotations__[kind.KIND] = several if kind.SEVERAL else keys | None
            setattr(cls, kind.KIND, optional(kind.MEANING, () if kind.SEVERAL else None))
        super().__init_subclass__(**kwargs)


class Wishes(KeysOfKinds):
    """A person's wishes for the motion."""

    if TYPE_CHECKING:

        def __getattr__(self, kind: str) -> Any: ...

    def of(self, kind: type[Kind]) -> Sequence[Kind]:
        """The wishes of a kind."""
        found = getattr(self, kind.KIND)
        if kind.SEVERAL:
            return found
        return () if found is None else (found,)

    def _faults(self) -> Faults:
        for kind in KINDS:
            yield from kind.disagreements(self.of(kind))


class TurningWishes(Wishes, turns=True):
    """A person's wishes for the motion of a turning output."""
