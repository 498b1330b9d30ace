"""Common keys of every kind of wish, and how they make its value.

A sliding output has places in mm and speeds in mm/s, a turning output in deg and rad/s.  A kind with a place has a twin
for a turning output, whose keys and words follow from its own.  Values are imported when they are made, so that reading
a design file loads no numerical library.
"""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple, Protocol, Self, TypeVar

from pydantic import Field

from ncgear.design.keys.base import LONGEST_MM, Faults, Model, Positive, fault, optional, required

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.wishes.wish import Wish

Way = Annotated[float, Field(ge=0.0, le=LONGEST_MM)]
StrokeName = Literal["working", "return"]

TURNED = {"Way": Annotated[float, Field(ge=0.0, lt=360.0)], "Length": Annotated[float, Field(gt=0.0, lt=360.0)]}
"""The types of places in deg, by the names of the types of places in mm; all speeds have the same type."""


class On(NamedTuple):
    """The machine of the wishes: its mechanism, the driving angle of a cycle, the greatest ratio."""

    linkage: Mechanism
    cycle_rad: float
    ratio_max: float

    @property
    def stroke(self) -> float:
        """The stroke in the unit of the file."""
        return self.linkage.OUTPUT.place.factor * self.linkage.stroke_mm

    def mm(self, place: float) -> float:
        """A place of the file in mm, or in rad."""
        return place / self.linkage.OUTPUT.place.factor


class WishKeys(Model):
    """The common key of all wishes: whether the law must keep the wish."""

    KIND: ClassVar[str]
    """The key of the kind under ``wishes``."""

    MEANING: ClassVar[str]
    """The words for that key."""

    SEVERAL: ClassVar[bool] = True
    """Whether a design has a list of them."""

    INSIDE: ClassVar[tuple[str, ...]] = ()
    REACHING: ClassVar[tuple[str, ...]] = ()
    """Keys, without unit, of places that must be under the stroke, and of places that may also be the whole stroke."""

    ANGLES: ClassVar[tuple[tuple[str, str], ...]] = ()
    """Keys, without unit, of driving angles that must be under the cycle, and their values in rad."""

    PLACE: ClassVar[str] = "mm"
    SPEED: ClassVar[str] = "mm_s"
    """The units of places and of speeds, at the ends of keys; keys of decelerations add a 2."""

    hard: bool = optional("true: the law must keep it; false: it has a weight in the goal", True)
    weight: Positive | None = optional(
        "of a soft wish: a miss of 1 percent of the speed, the deceleration or the cycle's driving angle counts like "
        "this many percent of the goal; left out: 1"
    )

    @classmethod
    @cache
    def turning(cls) -> type[WishKeys]:
        """The class for a turning output, with places in deg and speeds in rad/s; the class itself without such
        keys."""
        made: dict[str, Any] = {}
        annotations: dict[str, Any] = {}
        for name, annotation in cls.__annotations__.items():
            key = re.sub("_mm$", "_deg", re.sub("_mm(?=_s)", "_rad", name))
            if key != name:
                kind, _, absent = annotation.partition(" | ")
                of: Any = TURNED.get(kind, Positive)
                words = re.sub(r"\bmm\b(?=/)", "rad", cls.model_fields[name].description or "")
                words = words.replace(" mm", " deg").replace("slider", "output")
                # A field of the base is not a field of the class any more
                annotations |= {name: ClassVar[None], key: of | None if absent else of}
                made[key] = optional(words) if absent else required(words)
        if not made:
            return cls
        words = (cls.__doc__ or "").replace("slider", "output")
        made |= {"PLACE": "deg", "SPEED": "rad_s", "__annotations__": annotations}
        made |= {"__doc__": words, "__module__": cls.__module__, "__qualname__": f"Turning{cls.__name__}"}
        of_models: Any = type(cls)
        return of_models(f"Turning{cls.__name__}", (cls,), made, first=True)

    def place(self, quantity: str) -> Any:
        """The value of a place's key, such as ``from`` or ``at``, in the unit of the file; None if it is left out."""
        return getattr(self, f"{quantity}_{self.PLACE}")

    def speed(self, quantity: str) -> float | None:
        """The value of a speed's key, in the unit of the file; None if it is left out."""
        return getattr(self, f"{quantity}_{self.SPEED}")

    @property
    def soft_weight(self) -> float | None:
        """The weight of a soft wish; None for a hard one."""
        return None if self.hard else self.weight or 1.0

    def _faults(self) -> Faults:
        if self.hard and self.weight is not None:
            yield fault("weight", "given, but the wish is hard; hard: false is right with a weight, or leave it out")

    def refuse(self, key: str, on: On) -> None:
        """Refuse other values that no motion can reach; raises WrongInput."""

    @classmethod
    def disagreements(cls, own: Sequence[Self]) -> Faults:
        """The faults of wishes of the kind that contradict each other; keys count from ``wishes``."""
        yield from ()

    @classmethod
    def refuse_together(cls, wishes: Wished, on: On) -> None:
        """Refuse a wish that no motion can keep together with other wishes; raises WrongInput or NoSuchMechanism."""

    @classmethod
    def completed(cls, own: Sequence[Self]) -> Sequence[Self]:
        """Wishes of the kind, completed by their order."""
        return own

    @abstractmethod
    def value(self, on: On, **common: Any) -> Wish:
        """The wish of the keys; ``common`` is its key, its weight and its output."""


class Wished(Protocol):
    """All wishes of a design."""

    def of(self, kind: type[Kind]) -> Sequence[Kind]:
        """The wishes of a kind."""


Kind = TypeVar("Kind", bound=WishKeys)
