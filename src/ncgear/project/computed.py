"""What a drive computes when it is first asked for, and then keeps."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Self, TypeVar, overload

from ncgear.errors import located

Value = TypeVar("Value", covariant=True)


class computed(cached_property[Value]):
    """A cached property of a drive, whose errors name the place in the design file, whoever asks for it.

    The drive's ``places`` say where the values of its design stand; None for a design that came from no file.
    """

    @overload
    def __get__(self, instance: None, owner: type[Any] | None = None) -> Self: ...

    @overload
    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Value: ...

    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Self | Value:
        if instance is None:
            return self
        with located(instance.places):
            found: Value = super().__get__(instance, owner)
            return found
