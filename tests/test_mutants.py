"""What `make mutants` breaks: known texts, whose mutations are written down by hand."""

from __future__ import annotations

from at_once import at_once
from mutants.mutations import mutations


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
        ("return a[b + 1]", []),
        ("raise ValueError(f'{a + 1}')", []),
        ("return sin(a)", []),
    ],
)
def test_mutations_of_a_line(line: str, broken: list[str]) -> None:
    source = f"def f(a, b=1 + 1):\n    {line}\n".encode()
    found = [one.applied(source).decode().splitlines()[1].strip() for one in mutations(source)]
    assert sorted(found) == sorted(broken)
