"""From keys to values: the wishes of a design's motion, refused where the mechanism or each other contradict them."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees

from ncgear.design.keys.base import key_of
from ncgear.design.keys.design import Design
from ncgear.design.keys.optimize import Optimize
from ncgear.design.wishes.base import On, WishKeys
from ncgear.design.wishes.registry import KINDS, Wishes
from ncgear.errors import WrongInput
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.bounds import shown_below
from ncgear.wishes.wish import Wish


def motion_wishes_of(design: Design, linkage: Mechanism, cycle_rad: float) -> tuple[Wish, ...]:
    """The wishes of a design's motion, of a mechanism whose cycle takes a driving angle of ``cycle_rad``.

    Raises WrongInput for places outside the stroke, angles outside the cycle and wishes that contradict each other,
    NoSuchMechanism for an exact dwell.
    """
    on = On(linkage, cycle_rad, (design.optimize or Optimize()).limits.ratio_max)
    wished = dict(_wished(design.wishes))
    _refuse_places(wished, on)
    _refuse_angles(wished, on)
    for key, keys in wished.items():
        keys.refuse(key, on)
    for kind in KINDS:
        kind.refuse_together(design.wishes, on)
    output = linkage.OUTPUT
    return tuple(keys.value(on, key=key, weight=keys.soft_weight, output=output) for key, keys in wished.items())


def _wished(wishes: Wishes) -> Iterator[tuple[str, WishKeys]]:
    """The dotted keys of all wishes, and their values."""
    for kind in KINDS:
        for number, keys in enumerate(kind.completed(wishes.of(kind))):
            yield f"wishes.{kind.KIND}.{number}" if kind.SEVERAL else f"wishes.{kind.KIND}", keys


def _refuse_places(wished: dict[str, WishKeys], on: On) -> None:
    """Refuse places beyond the stroke, and at its very end also places where the output has to move."""
    unit, stroke = on.linkage.OUTPUT.place, on.stroke
    for reaches in (False, True):
        for key, keys in wished.items():
            for name in keys.REACHING if reaches else keys.INSIDE:
                place = keys.place(name)
                if place is not None and not (place <= stroke if reaches else place < stroke):
                    right = "at most that" if reaches else "less"
                    raise WrongInput(
                        f"{place:g} given, but the stroke is {shown_below(stroke)} {unit.text}; {right} is right",
                        key=f"{key}.{name}_{unit.ending}",
                    )


def _refuse_angles(wished: dict[str, WishKeys], on: On) -> None:
    """Refuse angles beyond the cycle."""
    for key, keys in wished.items():
        for quantity, in_rad in keys.ANGLES:
            if not getattr(keys, in_rad) < on.cycle_rad:
                name = key_of(keys, quantity)
                raise WrongInput(
                    f"{getattr(keys, name):g} given, but a cycle takes {degrees(on.cycle_rad):g} deg of the driving "
                    "angle; less is right",
                    key=f"{key}.{name}",
                )
