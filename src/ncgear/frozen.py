"""Frozen dataclasses that are quick to define.

For a frozen dataclass the standard library writes and compiles six functions.  The commands of ncgear define up to 300
such classes when they start, which took a seventh of the time of a check.  Here all these classes share four of the six
functions.
"""

from __future__ import annotations

import dataclasses
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(cls: type | None = None, /, *, frozen: bool, eq: bool = True, **options: bool) -> Any:
        """The frozen class that ``dataclasses.dataclass`` makes, with the same options; ``frozen`` must be true.

        Fields, default values, order of arguments, ``replace``, equality, hash, text and copies work as in
        ``dataclasses``, which accepts the class as frozen.  ``dataclasses`` itself makes a class that inherits fields.
        """
        if not frozen:
            raise TypeError("dataclasses that can be changed are made by dataclasses.dataclass")
        if cls is None:
            return lambda cls: dataclass(cls, frozen=True, eq=eq, **options)
        if any(map(dataclasses.is_dataclass, cls.__mro__[1:])):
            return dataclasses.dataclass(cls, frozen=True, eq=eq, **options)
        shared = {"__setattr__": _set_once, "__delattr__": _delete}
        if "__repr__" not in vars(cls):
            shared["__repr__"] = _shown
        if eq and "__eq__" not in vars(cls):
            # Python sets __hash__ to None where a class defines __eq__ and no __hash__.
            shared["__eq__"] = _equal
        if eq and vars(cls).get("__hash__") is None:
            shared["__hash__"] = _hash
        for name, function in shared.items():
            setattr(cls, name, function)
        made = dataclasses.dataclass(cls, eq=False, repr=False, **options)
        # Frozen classes may inherit from frozen classes only.
        made.__dataclass_params__.frozen = True
        return made


def _set_once(self: Any, name: str, value: object) -> None:
    own = self.__dict__
    if name in own or name not in self.__dataclass_fields__:
        raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
    own[name] = value


def _delete(self: Any, name: str) -> None:
    raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")


@recursive_repr()
def _shown(self: Any) -> str:
    told = (f"{field.name}={getattr(self, field.name)!r}" for field in dataclasses.fields(self) if field.repr)
    return f"{type(self).__qualname__}({', '.join(told)})"


def _compared(self: Any) -> tuple[object, ...]:
    return tuple(getattr(self, field.name) for field in dataclasses.fields(self) if field.compare)


def _equal(self: Any, other: object) -> Any:
    return _compared(self) == _compared(other) if type(other) is type(self) else NotImplemented


def _hash(self: Any) -> int:
    return hash(_compared(self))
