"""The group ``wishes`` of a design file: a key for each kind, hard or soft, alone or a list."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from ncgear.design.keys.base import Faults, Model, optional
from ncgear.design.keys.types import Several
from ncgear.design.wishes.base import Kind
from ncgear.design.wishes.registry import KINDS

MOST_WISHES = 50
"""Wishes of a kind: more than a person writes."""


class KeysOfKinds(Model):
    """The base that gives a class a key for each kind; with ``turns=True`` those of an output that turns."""

    def __init_subclass__(cls, turns: bool = False, **kwargs: Any) -> None:
        """Annotate the fields before pydantic reads the annotations; kinds of which there is one come first."""
        for kind in sorted(KINDS, key=lambda kind: kind.SEVERAL):
            keys: Any = kind.TURNING if turns else kind
            several = Annotated[Several[keys], Field(max_length=MOST_WISHES)]
            cls.__annotations__[kind.KIND] = several if kind.SEVERAL else keys | None
            setattr(cls, kind.KIND, optional(kind.MEANING, () if kind.SEVERAL else None))
        super().__init_subclass__(**kwargs)


class Wishes(KeysOfKinds):
    """What a person wishes of the motion."""

    if TYPE_CHECKING:

        def __getattr__(self, kind: str) -> Any: ...

    def of(self, kind: type[Kind]) -> Sequence[Kind]:
        """The wishes of a kind."""
        found = getattr(self, kind.KIND)
        if kind.SEVERAL:
            several: Sequence[Kind] = found
            return several
        return () if found is None else (found,)

    def _faults(self) -> Faults:
        for kind in KINDS:
            yield from kind.disagreements(self.of(kind))


class TurningWishes(Wishes, turns=True):
    """What a person wishes of the motion of an output that turns."""
