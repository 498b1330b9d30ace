"""Frozen dataclasses of ncgear beside those that ``dataclasses`` makes of the same classes."""

from __future__ import annotations

import ast
import copy
import dataclasses
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, field
from functools import cached_property
from typing import Any

import pytest

from at_once import at_once
from commands import ROOT
from ncgear.frozen import dataclass

Maker = Callable[..., Any]


class Bare:
    """A point with a name that does not count, and a length that is computed once."""

    x: float
    y: float = 0.0
    name: str = field(default="", compare=False)
    hidden: list[int] = field(default_factory=list, repr=False, compare=False)

    @cached_property
    def length(self) -> float:
        """The distance from the origin."""
        return float((self.x**2 + self.y**2) ** 0.5)


def of(maker: Maker, **options: bool) -> Any:
    """The class of a maker, from a fresh copy of the bare one."""
    inner = {name: value for name, value in vars(Bare).items() if name not in ("__dict__", "__weakref__")}
    own = type("Point", (), inner)
    # A cached property learns its name from the class that it is made in.
    return maker(frozen=True, **options)(own)


BOTH = [pytest.param(dataclass, id="ncgear"), pytest.param(dataclasses.dataclass, id="dataclasses")]

Kept = of(dataclass)
"""One class by its name in a module, which is what pickle looks for."""
Kept.__qualname__ = "Kept"


@pytest.mark.parametrize("maker", BOTH)
def test_behaves_as_a_frozen_dataclass(maker: Maker) -> None:
    point = of(maker)
    one, same, other = point(3.0, 4.0, "a"), point(3.0, y=4.0, name="b"), point(3.0)
    assert one == same != other
    assert one.__eq__(object()) is NotImplemented
    assert hash(one) == hash(same) == hash((3.0, 4.0))
    assert repr(one) == "Point(x=3.0, y=4.0, name='a')"
    assert one.length == 5.0 == vars(one)["length"]
    assert dataclasses.replace(one, x=0.0) == point(0.0, 4.0)
    assert dataclasses.asdict(other) == {"x": 3.0, "y": 0.0, "name": "", "hidden": []}
    assert point(1.0).hidden is not point(1.0).hidden
    assert copy.deepcopy(one) == copy.copy(one) == one
    assert point.__match_args__ == ("x", "y", "name", "hidden")
    with pytest.raises(TypeError):
        point()


@at_once("maker", BOTH)
@at_once("name", ["x", "hidden", "length", "new"])
def test_nothing_can_be_changed(maker: Maker, name: str) -> None:
    one = of(maker)(1.0)
    with pytest.raises(FrozenInstanceError, match=name):
        setattr(one, name, 2.0)
    with pytest.raises(FrozenInstanceError, match=name):
        delattr(one, name)
    assert vars(one) == {"x": 1.0, "y": 0.0, "name": "", "hidden": []}


@pytest.mark.parametrize("maker", BOTH)
def test_without_equality_each_is_its_own(maker: Maker) -> None:
    point = of(maker, eq=False)
    one, twin = point(1.0), point(1.0)
    assert one != twin
    assert len({one, twin}) == 2


@pytest.mark.parametrize("maker", BOTH)
def test_own_functions_of_a_class_stay(maker: Maker) -> None:
    class Angle:
        turns: float

        def __eq__(self, other: object) -> bool:
            return isinstance(other, Angle) and self.turns % 1.0 == other.turns % 1.0

        def __repr__(self) -> str:
            return f"{self.turns % 1.0} turns"

    made: Any = maker(frozen=True)(Angle)
    assert made(0.25) == made(1.25) != made(0.5)
    assert repr(made(1.25)) == "0.25 turns"
    assert hash(made(0.25)) == hash((0.25,))


@at_once("maker", BOTH)
@at_once("base_maker", BOTH)
def test_fields_of_a_base_class_come_first(maker: Maker, base_maker: Maker) -> None:
    base = of(base_maker)

    class Named(base):  # type: ignore[misc, valid-type]
        unit: str = "mm"

        def __post_init__(self) -> None:
            if not self.unit:
                raise ValueError("a unit is missing")

    made: Any = maker(frozen=True)(Named)
    one = made(1.0, 2.0, "a", unit="m")
    assert repr(one).endswith("Named(x=1.0, y=2.0, name='a', unit='m')")
    assert one == dataclasses.replace(one, name="b") != made(1.0, 2.0)
    assert one != base(1.0, 2.0)
    for name in ("x", "unit", "new"):
        with pytest.raises(FrozenInstanceError, match=name):
            setattr(one, name, 2.0)
    with pytest.raises(ValueError, match="missing"):
        made(1.0, unit="")


@pytest.mark.parametrize("maker", BOTH)
def test_no_class_that_can_be_changed_inherits_from_it(maker: Maker) -> None:
    base = of(maker)
    with pytest.raises(TypeError, match="cannot inherit"):
        dataclasses.dataclass(type("Loose", (base,), {}))


@pytest.mark.parametrize("maker", BOTH)
def test_arguments_by_name_alone(maker: Maker) -> None:
    point = of(maker, kw_only=True)
    assert point(x=1.0).x == 1.0
    with pytest.raises(TypeError):
        point(1.0)


@pytest.mark.parametrize("maker", BOTH)
def test_a_ring_of_objects_can_be_shown(maker: Maker) -> None:
    point = of(maker)
    one = point([])
    one.x.append(one)
    assert repr(one) == "Point(x=[...], y=0.0, name='')"


def test_pickles() -> None:
    one = Kept(1.0, 2.0, "a")
    assert pickle.loads(pickle.dumps(one)) == one


def test_classes_that_can_be_changed_are_refused() -> None:
    with pytest.raises(TypeError, match=r"dataclasses\.dataclass"):
        dataclass(frozen=False)


@pytest.mark.slow
def test_every_frozen_class_of_a_module_without_others_is_made_here() -> None:
    """Files with dataclasses that can be changed take both from ``dataclasses``."""
    for path in sorted((ROOT / "src").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        # Most files take none from there, and need not be parsed.
        tree = ast.parse(text if "from dataclasses import" in text else "")
        taken = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module == "dataclasses"]
        if path.name == "frozen.py" or not any(name.name == "dataclass" for node in taken for name in node.names):
            continue
        decorators = [one for node in ast.walk(tree) if isinstance(node, ast.ClassDef) for one in node.decorator_list]
        assert any("dataclass" in (said := ast.unparse(one)) and "frozen" not in said for one in decorators), path
