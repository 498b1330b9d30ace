"""What tests of commands share: the type of the fixture that runs them in this process, and changed files."""

from __future__ import annotations

from collections.abc import Callable

Outcome = tuple[int, str, str]
"""Exit status, stdout and stderr."""

Run = Callable[..., Outcome]


def changed(text: str, old: str, new: str) -> str:
    """``text`` with its only ``old`` replaced."""
    assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times"
    return text.replace(old, new)
