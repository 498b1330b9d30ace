"""Python blocks: doctests where they show a prompt, else statements; names live on to the next block of the page."""

from __future__ import annotations

import doctest
import io
from typing import Any


def run_python(text: str, names: dict[str, Any], place: str) -> None:
    """Run a block with the page's ``names``; AssertionError says what it printed instead of what is shown."""
    if ">>>" not in text:
        exec(compile(text, place, "exec"), names)
        return
    test = doctest.DocTestParser().get_doctest(text, names, place, place, 0)
    said = io.StringIO()
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS, verbose=False)
    if runner.run(test, out=said.write, clear_globs=False).failed:
        raise AssertionError(said.getvalue())
    names.update(test.globs)
