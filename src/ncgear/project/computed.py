"""The attributes of a drive: each is computed when it is first asked for, and then kept."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import Any, Self, TypeVar, overload

from ncgear.errors import located

Value = TypeVar("Value", covariant=True)


class computed(cached_property[Value]):
    """A cached property of a drive; its errors give their place in the design file.

    The place comes from the attribute ``places`` of the drive, which is None for a design that came from no file.
    """

    @overload
    def __get__(self, instance: None, owner: type[Any] | None = None) -> Self: ...

    @overload
    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Value: ...

    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Self | Value:
        if instance is None:
            return self
        with located(instance.places):
            return super().__get__(instance, owner)


def take_over(names: Iterable[str], source: Any, target: Any) -> None:
    """Give a drive the named attributes that another drive has computed, where they are the same for both."""
    known = vars(source)
    vars(target).update({name: known[name] for name in names if name in known})
