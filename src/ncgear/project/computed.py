"""The attributes of a drive: each is computed when it is first asked for, and then kept."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from functools import cached_property, wraps
from typing import Any, Self, TypeVar, overload

from ncgear.errors import DesignError, located

Value = TypeVar("Value", covariant=True)
Found = TypeVar("Found")
By = TypeVar("By", bound=str)


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


def computed_by(method: Callable[[Any, By], Found]) -> Callable[[Any, By], Found]:
    """A method of a drive that is computed once for each value of its argument; an error is kept too."""

    @wraps(method)
    def known(drive: Any, by: By) -> Found:
        results: dict[str, Found | DesignError] = vars(drive).setdefault(f"_{method.__name__}", {})
        if by not in results:
            try:
                with located(drive.places):
                    results[by] = method(drive, by)
            except DesignError as refusal:
                results[by] = refusal
        found = results[by]
        if isinstance(found, DesignError):
            raise copy(found)
        return found

    return known
