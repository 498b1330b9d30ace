"""``ncgear schema --vscode``: settings are kept to the letter and name the files; a parser of others reads them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import json5
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from commands import ROOT
from documented.shell import run_line
from ncgear.errors import WrongInput
from ncgear.files.editor import SCHEMAS, NotEditable, editor_files, parsed, plain, with_member

DESIGN = "name: x\nmotion: {law: uniform_crank}\n"
BALANCE = "name: y\nspeed_rpm: 20\nmechanisms: []\n"
TRAIN = "name: z\ntrain:\n  kind: chain\n"

SETTINGS = """\
{ // of the team
  "editor.rulers": [100, 120,], /* "yaml.schemas": {} */
  "files.eol": "// no comment }",
  "yaml.schemas": {
    "https://example.org/other.json": "other/*.yaml", // stays
  },
  // at the end
}
"""


def told(folder: Path) -> tuple[int, str]:
    """Exit status and words of the command for a folder."""
    return run_line(f"ncgear schema --vscode {folder}")


def applies(pattern: str, path: str) -> bool:
    """Whether the extension takes a pattern for a file: a star is anything, and the pattern is an end of the path.

    Source: ``FilePatternAssociation`` and ``convertSimple2RegExpPattern`` of its language server, told in words.
    """
    return re.search(f"{re.escape(pattern).replace(re.escape('*'), '.*')}$", f"/folder/{path}") is not None


def written(folder: Path) -> dict[str, Any]:
    return json5.loads((folder / ".vscode" / "settings.json").read_text(encoding="utf-8"))


def put(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")


@pytest.mark.slow
def test_a_folder_gets_schemas_and_settings_once(tmp_path: Path) -> None:
    put(tmp_path, {"a.yaml": DESIGN, "sub/b.yaml": DESIGN})
    assert told(tmp_path)[0] == 0
    assert written(tmp_path) == {"yaml.schemas": {"./.vscode/ncgear.schema.json": ["*.yaml"]}}
    before = {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in (tmp_path / ".vscode").iterdir()}
    assert {path.name for path in before} == {"ncgear.schema.json", "settings.json"}
    status, said = told(tmp_path)
    assert status == 0
    assert said.startswith("nothing to change")
    assert before == {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in (tmp_path / ".vscode").iterdir()}


@pytest.mark.slow
def test_each_file_has_the_schema_of_its_kind_and_others_have_none(tmp_path: Path) -> None:
    mine = {"a/x.yaml": DESIGN, "a/c.yaml": "services: {}\n", "b/y.yaml": DESIGN, "b/in/z.yaml": DESIGN}
    put(tmp_path, {**mine, "c/1.yaml": BALANCE, "c/d/2.yaml": DESIGN, "c/e/3.yaml": TRAIN, ".hidden/3.yaml": DESIGN})
    found = editor_files(tmp_path).patterns
    kinds = dict(zip(SCHEMAS, (DESIGN, BALANCE, TRAIN), strict=True))
    assert list(found) == list(kinds)
    for path in ("a/x.yaml", "a/c.yaml", "b/y.yaml", "b/in/z.yaml", "c/1.yaml", "c/d/2.yaml", "c/e/3.yaml"):
        text = (tmp_path / path).read_text()
        for name, patterns in found.items():
            assert any(applies(pattern, path) for pattern in patterns) is (text == kinds[name]), (path, name)
    assert "b/*.yaml" in found["ncgear.schema.json"]


@pytest.mark.slow
def test_every_setting_and_comment_stays(tmp_path: Path) -> None:
    put(tmp_path, {"x.yaml": DESIGN, ".vscode/settings.json": SETTINGS})
    assert told(tmp_path)[0] == 0
    text = (tmp_path / ".vscode" / "settings.json").read_text()
    found, before = written(tmp_path), json5.loads(SETTINGS)
    assert found["yaml.schemas"].pop("./.vscode/ncgear.schema.json") == ["*.yaml"]
    assert found == before
    # What is new is one stretch; without it the text is as it was, but for white space.
    rest = iter(re.sub(r"\s", "", text))
    assert all(sign in rest for sign in re.sub(r"\s", "", SETTINGS))
    for comment in ("// of the team", '/* "yaml.schemas": {} */', "// stays", "// at the end"):
        assert comment in text


@pytest.mark.slow
def test_files_that_a_person_has_added_stay(tmp_path: Path) -> None:
    given_files = {"yaml.schemas": {"./.vscode/ncgear.schema.json": "mine/*.yaml"}}
    put(tmp_path, {"a/x.yaml": DESIGN, "b.yaml": "k: 1\n", ".vscode/settings.json": json.dumps(given_files)})
    assert told(tmp_path)[0] == 0
    assert written(tmp_path)["yaml.schemas"] == {"./.vscode/ncgear.schema.json": ["mine/*.yaml", "a/*.yaml"]}


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [
        '{"a": 1',
        "[1]",
        '{"yaml.schemas": 3}',
        '{"yaml.schemas": {}, "yaml.schemas": {}}',
        '{"a": 1} x',
        "{'a': 1}",
        "\xff",
    ],
)
def test_settings_that_cannot_be_changed_safely_are_left_with_the_lines_to_paste(tmp_path: Path, text: str) -> None:
    place = tmp_path / ".vscode" / "settings.json"
    place.parent.mkdir()
    place.write_bytes(text.encode("latin-1"))
    with pytest.raises(WrongInput, match=r"(?s)settings\.json: .*by hand:.*\./\.vscode/ncgear\.schema\.json"):
        editor_files(tmp_path)
    assert place.read_bytes() == text.encode("latin-1")


@pytest.mark.slow
def test_a_link_is_not_replaced_by_a_file(tmp_path: Path) -> None:
    put(tmp_path, {"kept.json": "{}"})
    (tmp_path / ".vscode").mkdir()
    (tmp_path / ".vscode" / "settings.json").symlink_to(tmp_path / "kept.json")
    assert told(tmp_path)[0] == 2
    assert (tmp_path / ".vscode" / "settings.json").is_symlink()


def test_a_folder_that_is_none_is_refused(tmp_path: Path) -> None:
    status, said = told(tmp_path / "none")
    assert status == 2
    assert "is no folder" in said


@pytest.mark.slow
def test_the_schema_takes_every_design_and_no_misspelt_one(tmp_path: Path) -> None:
    put(tmp_path, {"x.yaml": DESIGN, "b/y.yaml": BALANCE, "c/z.yaml": TRAIN})
    import jsonschema

    assert told(tmp_path)[0] == 0
    yaml = YAML(typ="safe")
    for name, folder, trains in (
        ("ncgear", "designs", False),
        ("ncgear-train", "designs", True),
        ("ncgear-balance", "designs/balance", False),
    ):
        schema = json.loads((tmp_path / ".vscode" / f"{name}.schema.json").read_text())
        judge = jsonschema.Draft202012Validator(schema)
        for path in sorted((ROOT / folder).glob("*.yaml")):
            data = yaml.load(path.read_text(encoding="utf-8"))
            if ("train" in data) is not trains:
                continue
            assert judge.is_valid(data), path.name
            assert not judge.is_valid({**data, "nmae": 1}), path.name


def test_a_bracket_in_a_comment_ends_nothing() -> None:
    assert parsed('{"a": [1, // }\n2, /* ] */ 3, /* } */], // x\n}') == {"a": [1, 2, 3]}


COMMENTS = st.sampled_from(["", " ", "\n", "// a } \n", "/* , ] */", '\n  // "k": {\n  ', "/**/ "])
VALUES = st.recursive(
    st.one_of(
        st.none(), st.booleans(), st.integers(-5, 5), st.text(max_size=6), st.sampled_from(["//", "/*", "}", '"'])
    ),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=4), inner, max_size=3)),
    max_leaves=6,
)


@st.composite
def commented(draw: st.DrawFn, value: Any) -> str:
    """A value as JSON with comments and trailing commas in between."""
    if isinstance(value, dict):
        parts = [
            f"{json.dumps(key, ensure_ascii=False)}{draw(COMMENTS)}:{draw(commented(one))}"
            for key, one in value.items()
        ]
        ends = "{}"
    elif isinstance(value, list):
        parts, ends = [draw(commented(one)) for one in value], "[]"
    else:
        return f"{draw(COMMENTS)}{json.dumps(value, ensure_ascii=False)}{draw(COMMENTS)}"
    trailing = "," if parts and draw(st.booleans()) else ""
    return f"{draw(COMMENTS)}{ends[0]}{','.join(parts)}{trailing}{draw(COMMENTS)}{ends[1]}{draw(COMMENTS)}"


@pytest.mark.slow
@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.data(), st.dictionaries(st.text(max_size=4), VALUES, max_size=4), VALUES)
def test_any_settings_are_read_and_changed_as_another_parser_reads_them(
    data: st.DataObject, before: Any, new: Any
) -> None:
    text = data.draw(commented(before))
    assert parsed(text) == before == json5.loads(text)
    assert len(plain(text)) == len(text)
    path = (data.draw(st.sampled_from(["new", *before])), "inner")
    if isinstance(before.get(path[0], {}), dict):
        after = with_member(text, path, new)
        assert json5.loads(after) == {**before, path[0]: {**before.get(path[0], {}), path[1]: new}}
        assert with_member(after, path, new) == after
        assert after.count("// a }") == text.count("// a }")
    else:
        with pytest.raises(NotEditable):
            with_member(text, path, new)
