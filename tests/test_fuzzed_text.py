"""Design files and expressions mangled at random, and made to do harm: they are read or refused with a place."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import Phase, given, seed, settings
from hypothesis import strategies as st

from at_once import at_once
from commands import environment
from drives import MACHINES
from ncgear.design.reading.design_file import LARGEST_MB, load
from ncgear.errors import DesignError, WrongInput
from ncgear.numerics.formula import CHOICES, FUNCTIONS, composed

SHIPPED = [path.read_text("utf-8") for path in MACHINES.values()]


LONGEST_MESSAGE = 6000
"""Characters of what is said of a file: ten faults, each with a shortened value and its meaning."""

SNIPPETS = [
    *"-?:,[]{}#&*!|>'\"%@`\\\t\n ",
    "1e999", "-" * 40, "9" * 500, "0x1F", ".nan", "-.inf", "null", "~", "yes", "1_000", "12:30:45", "é\u2028\ufeff",
    "&a ", "*a", "<<: *a", "!!python/object/apply:os.system ['touch owned']", "!!binary aGk=", "!<!> ", "%TAG ! x\n",
    "%YAML 1." + "9" * 5000 + "\n---\n", '"\\UFFFFFFFF"', '"\\U00110000"', "9" * 320,
    "---\n", "...\n", "? ", "- ", ": ", "\n  ", "\n\t", "|2-\n", ">+\n", "[[[[[[[[[[[[[[", "{a: " * 14, "x" * 2000,
    "\x00", "\x1b[31m", '"\\ud800"', '"\\x00"', "motion: {law: ", "name: again\n", "gears:\n",
]  # fmt: skip

edits = st.tuples(
    st.sampled_from(["insert", "delete", "swap", "repeat"]),
    st.integers(0, 10**4),
    st.integers(0, 60),
    st.sampled_from(SNIPPETS),
)


def mangled(text: str, changes: list[tuple[str, int, int, str]]) -> str:
    """The text after some edits."""
    for kind, place, length, snippet in changes:
        start = place % (len(text) + 1)
        before, part, after = text[:start], text[start : start + length], text[start + length :]
        match kind:
            case "insert":
                text = before + snippet + part + after
            case "delete":
                text = before + after
            case "swap":
                text = before + after[:length] + part + after[length:]
            case _:
                text = before + part + part + after
    return text


def read_or_refused(path: Path, content: bytes) -> str:
    """What loading such a file says, empty where it is a design; any other exception goes through."""
    path.write_bytes(content)
    try:
        load(path)
    except DesignError as error:
        assert error.exit_status == 2
        assert error.location.startswith(f"{path}:")
        assert len(str(error).replace(str(path), "")) < LONGEST_MESSAGE
        return str(error)
    return ""


def judge_texts(path: Path, count: int, number: int) -> None:
    @seed(number)
    @settings(max_examples=count, deadline=None, database=None, phases=(Phase.generate, Phase.shrink))
    @given(
        st.sampled_from(SHIPPED), st.lists(edits, min_size=1, max_size=4), st.binary(max_size=3), st.integers(0, 2000)
    )
    def judge(text: str, changes: list[tuple[str, int, int, str]], raw: bytes, place: int) -> None:
        content = mangled(text, changes).encode()
        read_or_refused(path, content[:place] + raw + content[place:] if len(raw) > 1 else content)

    judge()


@pytest.mark.slow
@pytest.mark.attack
def test_mangled_designs_are_read_or_refused_with_a_place(tmp_path: Path) -> None:
    judge_texts(tmp_path / "d.yaml", 150, 10**6)


@pytest.mark.tiers(slow=["2"], rest="long")
@pytest.mark.attack
@pytest.mark.parametrize("batch", range(4))
def test_many_mangled_designs_are_read_or_refused_with_a_place(tmp_path: Path, batch: int) -> None:
    judge_texts(tmp_path / "d.yaml", 600, batch)


MOST = 900_000 * LARGEST_MB
"""Bytes of a file that is nearly as large as one may be."""

LAUGHS = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join([f'*{before}'] * 9)}]\n" for before, name in zip("abcdefgh", "bcdefghi", strict=True)
)

HARMFUL: dict[str, tuple[str | bytes, str]] = {
    # name: (the file, what is said of it)
    "billion laughs": (LAUGHS, "&a is an anchor or alias"),
    "deep lists": ("[" * MOST, "nested over 12 levels deep"),
    "deep groups": ("{a: " * (MOST // 4), "nested over 12 levels deep"),
    "deep items": ("- " * (MOST // 2), "nested over 12 levels deep"),
    "deep keys": ("? " * (MOST // 2), "stands as a key"),
    "long list": ("a: [" + "1," * (MOST // 2) + "]", "over 100000 values in one file"),
    "long block": ("a:\n" + "- 1\n" * (MOST // 4), "over 100000 values in one file"),
    "many lists": ("a: [" + "[]," * (MOST // 3) + "]", "over 100000 values in one file"),
    "lists of lists": ("a: [" + f"[{'0,' * 9000}]," * (MOST // 18005) + "]", "over 100000 values in one file"),
    "many keys": ("".join(f"k{i}: 1\n" for i in range(MOST // 12)), "over 200 keys in one group"),
    "long anchor": ("a: &" + "x" * MOST, "is an anchor or alias"),
    "long tag": ("a: !" + "x" * MOST, "is a tag"),
    "long handle": ("a: !" + "x" * MOST + "!y z", "is a tag"),
    "long key": ("? " + "x" * MOST + "\n: 1", "characters; none has over 100"),
    "long number": ("name: " + "9" * MOST, "a finite number is needed"),
    "long text": ("name: '" + "x" * MOST + "'", "a name of letters"),
    "open quote": ("name: '" + "x" * MOST, "is open at the end of the file"),
    "blank lines": ("\n" * MOST, "is empty"),
    "documents": ("---\n" * (MOST // 4), "a second document begins"),
    "escapes": ('name: "' + "\\n" * (MOST // 2) + '"', "a name of letters"),
    "binary": (bytes(range(256)) * (MOST // 256), "is not UTF-8 text"),
    "not UTF-8": (b"name: \xff\xfe", "is not UTF-8 text"),
    "code": ("a: !!python/object/apply:os.system ['touch owned']", "!!python/object/apply:os.system is a tag"),
}


def limited() -> None:
    """One gigabyte and a minute for a child; a message of a kilobyte takes neither."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (10**9, 10**9))
    resource.setrlimit(resource.RLIMIT_CPU, (60, 60))


def test_code_in_a_file_is_not_run(tmp_path: Path) -> None:
    said = read_or_refused(tmp_path / "d.yaml", str(HARMFUL["code"][0]).encode())
    assert HARMFUL["code"][1] in said
    assert [path.name for path in tmp_path.iterdir()] == ["d.yaml"]


@pytest.mark.tiers(slow=["long tag"], rest="long")
@pytest.mark.attack
@pytest.mark.skipif(os.name != "posix", reason="this system limits no process")
@pytest.mark.parametrize("name", HARMFUL)
def test_harmful_files_are_refused_in_little_memory_and_time(tmp_path: Path, name: str) -> None:
    """The limits are the system's; files are as large as they may be."""
    content, said = HARMFUL[name]
    (tmp_path / "d.yaml").write_bytes(content if isinstance(content, bytes) else content.encode())
    done = subprocess.run(
        [sys.executable, "-m", "ncgear", "check", "d.yaml"],
        capture_output=True, text=True, cwd=tmp_path, timeout=300, preexec_fn=limited, env=environment(),
    )  # fmt: skip
    assert done.returncode == 2, done.stderr[:500]
    assert said in done.stderr
    assert len(done.stderr) < LONGEST_MESSAGE
    assert [path.name for path in tmp_path.iterdir()] == ["d.yaml"]


# --- expressions


TOKENS = [
    *FUNCTIONS, "phi", "pi", "x", "e", "I", "oo", "S", "Symbol", "eval", "exec", "open", "__import__", "getattr",
    "__class__", "__subclasses__()", "__builtins__", ".__class__", ".func", ".args", ".subs", ".evalf()", "lambda:",
    "lambda x: x", "for", "in", "if", "else", "and", "not", "is", "await", "yield", "None", "True", "...", "*phi",
    "0", "1", "2", "9", "64", "0.5", "1e-300", "1e300", "1e999", "9" * 400, "1j", "0x10", "1_0", "'os'", "f'{phi}'",
    "+", "-", "*", "/", "**", "//", "%", "@", "^", "|", "&", "~", "<<", "<", "==", ":=", "(", ")", "[", "]", "{", "}",
    ",", ":", ";", "=", "\n", "\t", "\\", "#", "\x00", "é", "𝜋",
]  # fmt: skip

ALLOWED = (
    ast.Expression, ast.Constant, ast.Name, ast.Load, ast.Call, ast.UnaryOp, ast.UAdd, ast.USub,
    ast.BinOp, ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow, ast.IfExp, ast.Compare, ast.Lt, ast.LtE, ast.Gt, ast.GtE,
)  # fmt: skip

MOST_OPERATIONS = 3
"""Operations for each character of the text; ``x if x<0 else x`` and ``abs(x)`` have no more."""

expressions = st.one_of(
    st.lists(st.sampled_from(TOKENS), min_size=1, max_size=12).map(" ".join),
    st.recursive(
        st.sampled_from(["phi", "pi", "2", "9", "0.3", "x", "phi.real", "1e300"]),
        lambda inner: st.one_of(
            st.builds("({} {} {})".format, inner, st.sampled_from(["+", "-", "*", "/", "**", "**-"]), inner),
            st.builds("{}({})".format, st.sampled_from([*FUNCTIONS, *CHOICES, "phi", "-"]), inner),
        ),
        max_leaves=25,
    ),
)


def innocent(text: str) -> bool:
    """Whether a text has only numbers, the variable, pi, listed functions by name, and arithmetic."""
    try:
        nodes = list(ast.walk(ast.parse(text.strip(), mode="eval")))
    except (SyntaxError, ValueError):
        return False
    conditions = sum(isinstance(node, ast.IfExp) and isinstance(node.test, ast.Compare) for node in nodes)
    if {conditions} != {sum(isinstance(node, kind) for node in nodes) for kind in (ast.IfExp, ast.Compare)}:
        return False
    names = {node.id for node in nodes if isinstance(node, ast.Name)}
    return all(isinstance(node, ALLOWED) for node in nodes) and names <= {"phi", "pi", *FUNCTIONS, *CHOICES}


def made_or_refused(text: str) -> None:
    """Judge of an expression: taken only if innocent, and as no more than its text has; else refused."""
    try:
        formula = composed(text, "motion.ratio", "phi")
    except WrongInput as error:
        assert error.key == "motion.ratio"
        assert len(error.problem) < LONGEST_MESSAGE
        return
    assert innocent(text)
    assert len(formula.tape.operations) <= MOST_OPERATIONS * len(text)


@at_once(
    "text",
    [
        "-" + "~" * 700 + "phi",
        "pi" + "()" * 480,
        "1 + phi" + ".real" * 190,
        "phi" + "[0]" * 300,
        "phi**(" + "~" * 700 + "phi)",
    ],
)
def test_what_is_refused_may_be_nested_as_deep_as_can_be_read(text: str) -> None:
    made_or_refused(text)


def test_the_judge_tells_innocent_texts_from_others() -> None:
    assert innocent("1 + 0.3*cos(phi)")
    assert innocent("1 if phi < 2 else abs(phi)")
    for text in (
        "phi.real",
        "x",
        "(lambda: phi)()",
        "phi[0]",
        "phi if pi else 1",
        "phi < 1",
        "[phi for phi in pi]",
        "phi//2",
    ):
        assert not innocent(text)


def judge_expressions(count: int, number: int) -> None:
    @seed(number)
    @settings(max_examples=count, deadline=None, database=None, phases=(Phase.generate, Phase.shrink))
    @given(expressions)
    def judge(text: str) -> None:
        made_or_refused(text)

    judge()


@pytest.mark.slow
def test_random_expressions_are_functions_or_refused() -> None:
    judge_expressions(100, 10**6)


@pytest.mark.tiers(slow=["2"], rest="long")
@pytest.mark.attack
@pytest.mark.parametrize("batch", range(4))
def test_many_random_expressions_are_functions_or_refused(batch: int) -> None:
    judge_expressions(1000, batch)


@at_once(
    "text",
    [
        "*".join(["(phi + 1)"] * 90),
        "(" * 30 + "phi" + " + phi)*2" * 30,
        "(" * 30 + "phi" + " + 1)**2" * 30,
        "*".join(["(phi + pi)**64"] * 60),
        "2*(" * 35 + "phi + 1" + ")" * 35,
    ],
)
def test_products_and_powers_of_sums_are_not_multiplied_out(text: str) -> None:
    made_or_refused(text)
