"""Messages speak of the machine and of keys that there are, not of the code."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

import pytest

from commands import ROOT
from ncgear.design.keys.balance import Balance
from ncgear.design.keys.design import Design
from ncgear.design.reference import keys_of
from ncgear.design.words import quantity

SOURCE = ROOT / "src" / "ncgear"
RAISING = {"WrongInput", "NoSuchMechanism", "fault"}
"""What carries a message to the person who wrote the file."""

JARGON = re.compile(
    r"pydantic|\barrays?\b|(?-i:\bNone\b)|\btuples?\b|\bdicts?\b|\bexception|\bsolver|\bNewton|iterations?\b|converge|"
    r"jacobian|\bmatrix|\bdtype|\bjets?\b|\bipopt|\bpolygons?\b|\bsplines?\b|\battribute|\bboolean",
    re.IGNORECASE,
)


def texts_of(call: ast.Call) -> Iterator[str]:
    """The literal parts of a call's arguments."""
    for argument in (*call.args, *(keyword.value for keyword in call.keywords)):
        for node in ast.walk(argument):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield node.value


def messages() -> dict[str, str]:
    """What is said, by where."""
    found = {}
    for path in SOURCE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in RAISING:
                found[f"{path.relative_to(SOURCE)}:{node.lineno}"] = " ".join(texts_of(node))
    return found


def names_of_keys() -> set[str]:
    names = {key.name for root in (Design, Balance) for key in keys_of(root)}
    values = {str(value) for key in keys_of(Design) for value in key.rule.get("enum", [key.rule.get("const")])}
    return names | {quantity(name) for name in names} | values


UNITS = re.compile(r"\b[a-z]\w*_(?:mm|mm_s|mm_s2|deg|rad|pi|rpm|kg|kg_mm2|n|w|hz|g)\b")
"""Words that are keys, as they end in a unit."""


def unknown_keys(text: str) -> list[str]:
    """Keys that a text names and no file can have."""
    return [word for word in UNITS.findall(text) if word not in names_of_keys()]


@pytest.mark.slow
def test_there_are_messages() -> None:
    assert len(messages()) > 150


@pytest.mark.long
@pytest.mark.slow
def test_keys_that_messages_name_are_keys_of_files() -> None:
    assert {where: wrong for where, text in messages().items() if (wrong := unknown_keys(text))} == {}


@pytest.mark.slow
def test_messages_have_no_words_of_the_code() -> None:
    assert {where: text for where, text in messages().items() if JARGON.search(text)} == {}


@pytest.mark.slow
@pytest.mark.parametrize("text", ["give driven_inertia_kg_mm2", "the solver did not converge", "an array is needed"])
def test_what_should_not_be_said_is_seen(text: str) -> None:
    assert unknown_keys(text) or JARGON.search(text)
