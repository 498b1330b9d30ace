"""What tests of commands share: the type of the fixture that runs them in this process, and changed files."""

from __future__ import annotations

import re
from collections.abc import Callable

from ncgear.errors import NoSuchMechanism

Outcome = tuple[int, str, str]
"""Exit status, stdout and stderr."""

Run = Callable[..., Outcome]


def changed(text: str, old: str, new: str) -> str:
    """``text`` with its only ``old`` replaced."""
    assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times"
    return text.replace(old, new)


def stated_angle(fault: NoSuchMechanism) -> float:
    """The driving angle that a message names, in rad."""
    found = re.search(r"phi1 = ([-0-9.e]+) rad", fault.problem)
    assert found is not None, fault.problem
    return float(found.group(1))
