"""What `make mutants` breaks: known texts, whose mutations are written down by hand."""

from __future__ import annotations

from re import fullmatch

from ruamel.yaml import YAML

from at_once import at_once
from mutants.mutations import mutations
from mutants.survivors import REASONS


@at_once(
    ("line", "broken"),
    [
        ("return a + b", ["return a - b"]),
        ("return -a", ["return a"]),
        ("return 2.0 * a", ["return 2.4 * a", "return 2.0 / a"]),
        ("return np.sin(a) < 1", ["return np.cos(a) < 1", "return np.sin(a) < 2", "return np.sin(a) > 1"]),
        ("return max(a, b)", ["return min(a, b)"]),
        ("a **= b", ["a *= b"]),
        # No text, no place in an array, no message, no function that is not there.
        ("return 'a' + b", []),
        ("return a + b'c'", []),
        ("a += [b]", []),
        ("a += [b] if c else d", []),
        ("return a[b + 1]", []),
        ("raise ValueError(f'{a + 1}')", []),
        ("return sin(a)", []),
    ],
)
def test_mutations_of_a_line(line: str, broken: list[str]) -> None:
    source = f"def f(a, b=1 + 1):\n    {line}\n".encode()
    found = [one.applied(source).decode().splitlines()[1].strip() for one in mutations(source)]
    assert sorted(found) == sorted(broken)


def test_reasons_stand_by_names_that_are_text() -> None:
    """A name of digits alone, or with one e among them, is a number in YAML unless it is quoted."""
    names = list(YAML(typ="safe").load(REASONS))
    assert [name for name in names if not (isinstance(name, str) and fullmatch("[0-9a-f]{12}", name))] == []
