"""A stage of a drive: an attribute that is computed when it is first asked for, and once."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Self, TypeVar, overload

Value = TypeVar("Value", covariant=True)


class stage(cached_property[Value]):
    """A cached property of a drive, whose errors name the place in the design file, whoever asks for it."""

    @overload
    def __get__(self, instance: None, owner: type[Any] | None = None) -> Self: ...

    @overload
    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Value: ...

    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Self | Value:
        if instance is None:
            return self
        with instance.locating():
            found: Value = super().__get__(instance, owner)
            return found
