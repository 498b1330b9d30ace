"""The text of a design with other values: what is not the value itself stays, character by character."""

from __future__ import annotations

import re
from collections.abc import Mapping
from difflib import ndiff
from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from at_once import at_once
from ncgear.design import rewritten as rewriting
from ncgear.design.reading.places import Document, with_value
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.rewritten import document_of, rewritten
from ncgear.errors import WrongInput
from ncgear.studio.editing import edited, in_line_ends_of
from ncgear.studio.on_disk import design_on_disk

TEXT = """\
# head
name: pusher   # name
description: >
  Folded text with: colon
  second line   # not a comment

# before linkage
linkage:   # on the map
  crank_mm: 60   # crank

  # between
  rod_mm: 220
  # end of linkage

operation: {speed_rpm: 30}   # flow

# before motion
motion:
  law: 'ellipse'
  theta2_pi: 0x0C
gears:
    teeth: 48         # odd indent
    displacement_mm: [0, 40,  # one
      45, 120]
    driving: {bore_mm: 10,   # in flow
              index_holes: false}
    driven:
      bore_mm: 10.00
points:
  force_n:
  - 10  # a
  # b
  - 10
  - 60
  - 80 # last
fit:   # nothing yet
# tail
"""


def data_of(text: str) -> Any:
    return read_yaml(text, "d").data


def lines_changed(before: str, after: str) -> list[str]:
    """The lines that differ, with - and + before them and the signs of their ends in them."""
    lines = [[repr(line) for line in text.splitlines(keepends=True)] for text in (before, after)]
    return [f"{line[0]} {eval(line[2:]).rstrip()}" for line in ndiff(*lines) if line[0] in "+-"]


CHANGES: list[tuple[dict[str, Any], list[str]]] = [
    ({"operation.speed_rpm": 31}, ["- operation: {speed_rpm: 30}   # flow", "+ operation: {speed_rpm: 31}   # flow"]),
    ({"linkage.crank_mm": 61}, ["-   crank_mm: 60   # crank", "+   crank_mm: 61   # crank"]),
    ({"motion.law": "table"}, ["-   law: 'ellipse'", "+   law: 'table'"]),
    ({"points.force_n": [10, 10, 61, 80]}, ["-   - 60", "+   - 61"]),
    ({"points.force_n": [10, 60, 80]}, ["-   - 10"]),
    ({"points.force_n": [10, 10, 60, 80, 90]}, ["+   - 90"]),
    ({"points.force_n.3": None}, ["-   - 80 # last"]),
    ({"gears.backlash_mm": 0.05}, ["+     backlash_mm: 0.05"]),
    ({"gears.driven.bore_mm": 10}, []),
    ({"gears.driven.bore_mm": None}, ["-     driven:", "-       bore_mm: 10.00", "+     driven: {}"]),
    ({"gears.displacement_mm": [0, 45, 120]}, [
        "-     displacement_mm: [0, 40,  # one", "+     displacement_mm: [0, # one"
    ]),
    ({"gears.displacement_mm.3": None}, ["-       45, 120]", "+       45]"]),
    ({"gears.driving.index_holes": None}, [
        "-     driving: {bore_mm: 10,   # in flow", "-               index_holes: false}",
        "+     driving: {bore_mm: 10   # in flow", "+               }",
    ]),
    ({"gears.driving.bore_mm": 11}, [
        "-     driving: {bore_mm: 10,   # in flow", "+     driving: {bore_mm: 11,   # in flow"
    ]),
    ({"operation": None}, ["- operation: {speed_rpm: 30}   # flow"]),
    ({"fit": "ends"}, ["- fit:   # nothing yet", "+ fit: ends   # nothing yet"]),
    ({"fit.side": "ends"}, ["- fit:   # nothing yet", "+ fit: {side: ends}   # nothing yet"]),
    ({"new.one": 1, "new.two": [1.5, True]}, ["+ new: {one: 1, two: [1.5, true]}"]),
    ({"description": "a: b"}, [
        "- description: >", "-   Folded text with: colon", "-   second line   # not a comment", '+ description: "a: b"'
    ]),
    ({"linkage": {"kind": "yoke"}}, [
        "-   crank_mm: 60   # crank", "- ", "-   # between", "-   rod_mm: 220", "+   kind: yoke"
    ]),
]  # fmt: skip


@at_once(
    ("changes", "lines", "end"),
    [(*case, "\n") for case in CHANGES] + [(*case, end) for case in CHANGES[::3] for end in ("\r\n", "\r")],
)
def test_only_lines_of_changed_values_differ(changes: Mapping[str, Any], lines: list[str], end: str) -> None:
    text = TEXT.replace("\n", end)
    made = rewritten(text, changes)
    assert sorted(lines_changed(text, made)) == sorted(lines)
    assert not re.search({"\n": "\r", "\r\n": "[^\r]\n|\r[^\n]", "\r": "\n"}[end], made)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_text_without_a_last_line_end_gets_none(end: str) -> None:
    assert rewritten(f"a:{end}  - 1{end}b: 2", {"b": 3}) == f"a:{end}  - 1{end}b: 3"
    assert rewritten(f"a: 1{end}b: 2", {"c": 3}) == f"a: 1{end}c: 3{end}b: 2"
    assert rewritten(f"b:{end}  a: 2", {"b.c": 3}) == f"b:{end}  a: 2{end}  c: 3"
    assert rewritten("b: 2", {"c": 3, "d": 4}) == "b: 2\nc: 3\nd: 4"


SPACES = st.sampled_from(["", " ", "   "])
COMMENT = st.sampled_from(["", "", "  # c, d: [e]", " # 'x\""])
NUMBERS = st.one_of(st.integers(-999, 999), st.floats(-1e6, 1e6).filter(lambda value: value == value))
WORDS = st.text(st.characters(blacklist_categories=("Cs", "Cc")), max_size=12)


@st.composite
def flows(draw: st.DrawFn, slots: list[str], path: str, indent: str, depth: int) -> str:
    """A row of a list or a group, in lines that are broken anywhere, with slots for its numbers."""
    if depth == 0 or draw(st.booleans()):
        slots.append(path)
        return f"@{path}@"
    group = draw(st.booleans())
    made = ""
    for place in range(draw(st.integers(1, 3))):
        name = f"k{place}" if group else str(place)
        gap = draw(st.sampled_from([" ", "  ", f"  # in, a: row\n{indent}     ", f"\n{indent}    "]))
        made += ("," if place else "") + gap + (f"{name}: " if group else "")
        made += draw(flows(slots, f"{path}.{name}", indent, depth - 1))
    made += draw(SPACES)
    return "{" + made + "}" if group else "[" + made + "]"


@st.composite
def blocks(draw: st.DrawFn, slots: list[str], path: str, indent: str, depth: int) -> str:
    """The lines of a group or a list, with comments anywhere."""
    group = depth == 3 or draw(st.booleans())
    made = ""
    for place in range(draw(st.integers(1, 3))):
        name = f"k{place}" if group else str(place)
        inner = f"{path}.{name}".lstrip(".")
        made += draw(st.sampled_from(["", "", "\n", f"{indent}# before\n", "# far, [left\n"]))
        head = indent + (f"{name}:" if group else "-")
        if depth and draw(st.booleans()):
            deeper = indent + draw(st.sampled_from(["  ", "    "]))
            made += f"{head}{draw(COMMENT)}\n{draw(blocks(slots, inner, deeper, depth - 1))}"
        elif draw(st.booleans()):
            made += f"{head} |\n{indent}    some: words\n{indent}    # of a text\n"
        else:
            value = draw(flows(slots, inner, indent, 2))
            own = draw(st.sampled_from([" ", "   ", f"  # above\n{indent}  "]))
            made += f"{head}{own}{value}{draw(COMMENT)}\n"
    return made


@st.composite
def texts(draw: st.DrawFn) -> tuple[str, list[str]]:
    """A text of some lines with a slot for each number, and their paths."""
    slots: list[str] = []
    made = draw(st.sampled_from(["", "# head\n", "---\n"])) + draw(blocks(slots, "", "", 3))
    made += draw(st.sampled_from(["", "# tail\n", "...\n"]))
    made = made if draw(st.booleans()) else made.rstrip()
    assume(slots)
    return made.replace("\n", draw(st.sampled_from(["\n", "\r\n", "\r"]))), slots


def filled(text: str, values: Mapping[str, str]) -> str:
    return re.sub("@(.*?)@", lambda slot: values[slot[1]], text)


@pytest.mark.slow
@given(texts(), st.data())
@settings(max_examples=120, deadline=None)
def test_of_one_changed_number_its_characters_alone_differ(drawn: tuple[str, list[str]], data: st.DataObject) -> None:
    """The same lines are written by hand with the one number and with the other."""
    text, slots = drawn
    values = {slot: str(data.draw(st.integers(-99, 99))) for slot in slots}
    key, new = data.draw(st.sampled_from(slots)), data.draw(st.integers(100, 9999))
    before, after = filled(text, values), filled(text, values | {key: str(new)})
    assert rewritten(before, {key: new}) == after
    assert rewritten(after, {key: int(values[key])}) == before


@pytest.mark.long
@pytest.mark.slow
@given(texts(), st.data())
@settings(max_examples=120, deadline=None)
def test_a_key_that_is_added_or_left_out_leaves_comments_where_they_are(
    drawn: tuple[str, list[str]], data: st.DataObject
) -> None:
    """What is written means what was asked for; a new key of a group in lines is one line more."""
    text = filled(drawn[0], dict.fromkeys(drawn[1], "7"))
    key = data.draw(st.sampled_from(drawn[1]))
    group = key.rpartition(".")[0]
    parent = data_of(text)
    for name in group.split(".") if group else ():
        parent = parent[int(name) if isinstance(parent, list) else name]
    if isinstance(parent, dict):
        added = rewritten(text, {f"{group}.new".lstrip("."): 5})
        assert data_of(added) == with_value(data_of(text), f"{group}.new".lstrip("."), 5)
        assert comments(added) == comments(text)
    less = rewritten(text, {key: None})
    assert data_of(less) == with_value(data_of(text), key, None)
    assert len(comments(less)) >= len(comments(text)) - text.count("above") - 1


def comments(text: str) -> list[str]:
    return re.findall("#[^\r\n]*", text)


@pytest.mark.slow
@given(st.one_of(WORDS, NUMBERS, st.booleans(), st.lists(WORDS, min_size=1)))
@example("no: b")
@example("a #b")
@example("- a")
@example("1e3")
@example("...")
@example("x]")
@example("tab\tnew\nline\u2028\x85\ufeff")
@settings(max_examples=150, deadline=None)
def test_any_value_is_read_back_as_it_was_given(value: Any) -> None:
    for text in ("name: x # c\n", "a: {name: x} # c\n", "name: 'x'\n", 'name: "x"\n', "name:\n", "b: [{name: x}]\n"):
        key = {"a": "a.name", "b": "b.0.name"}.get(text[0], "name")
        made = rewritten(text, {key: value})
        assert data_of(made) == with_value(data_of(text), key, value)


def test_long_lists_are_broken_into_lines_in_their_group() -> None:
    row = [round(1.0 + 0.001 * step, 3) for step in range(40)]
    made = rewritten("motion:\n  law: table\n  ratio: [1, 2]\nname: x\n", {"motion": {"law": "table", "ratio": row}})
    assert max(map(len, made.splitlines())) <= 118
    assert data_of(made) == {"motion": {"law": "table", "ratio": row}, "name": "x"}
    again = rewritten(made, {"motion.ratio.7": 2})
    assert lines_changed(made, again)[0].replace("1.007", "2") == lines_changed(made, again)[1].replace("+", "-")


@pytest.mark.parametrize("text", ["name: *a\nb: &a 1\n", "a: {b, c\n"])
def test_what_cannot_be_read_has_no_places(text: str) -> None:
    with pytest.raises(WrongInput, match=r"anchor|YAML"):
        edited(text, {"b": 2})


# --- line ends of typed texts, and of the file


@given(st.lists(st.tuples(st.sampled_from("abc"), st.sampled_from(["\n", "\r\n", "\r"])), max_size=9))
@settings(max_examples=100, deadline=None)
def test_a_typed_text_keeps_the_line_ends_of_its_file(lines: list[tuple[str, str]]) -> None:
    text = "".join(line + end for line, end in lines)
    seen = re.sub("\r\n|\r", "\n", text)
    assert in_line_ends_of(text, seen) == text
    first = (re.findall("\r\n|\r|\n", text) or ["\n"])[0]
    assert in_line_ends_of(text, f"new\n{seen}") == f"new{first}{text}"


def test_lines_about_an_exchanged_part_keep_their_ends() -> None:
    """However long it is."""
    about, former = "x: 1\r\ny: 2\n{}y: 2\nx: 1\r\n", "".join(f"{number}\r" for number in range(2000))
    typed = "".join(f"{number % 100}!\n" for number in range(2000))
    found = in_line_ends_of(about.format(former), f"x: 1\ny: 2\n{typed}y: 2\nx: 1\n")
    assert found == about.format(typed.replace("\n", "\r\n"))


def test_a_text_is_read_once_for_several_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []

    def noted(text: str, file: str) -> Document:
        read.append(text)
        return read_yaml(text, file)

    monkeypatch.setattr(rewriting, "read_yaml", noted)
    document_of.cache_clear()
    texts = ["a: 1\nb: 2\n"]
    for number in range(3):
        texts.append(edited(texts[-1], {"a": number + 5}))
    assert read == texts


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_saving_keeps_the_line_ends_and_the_mark_of_a_file(tmp_path: Path, end: str, mark: str) -> None:
    path = tmp_path / "a.yaml"
    before = (mark + TEXT.replace("\n", end)).encode()
    path.write_bytes(before)
    file = design_on_disk(path)
    file.saved(edited(file.text, {"operation.speed_rpm": 31}))
    assert path.read_bytes() == before.replace(b"speed_rpm: 30", b"speed_rpm: 31")
