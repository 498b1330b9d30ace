"""The type of the fixture that runs the command line in this process."""

from __future__ import annotations

from collections.abc import Callable

Outcome = tuple[int, str, str]
"""Exit status, stdout and stderr."""

Run = Callable[..., Outcome]
