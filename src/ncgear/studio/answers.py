"""What the studio tells of a design, part by part, each as soon as it is computed, as plain values for the page.

There are three chains, which three processes follow side by side: that of the motion needs no gear, that of the gears
makes teeth, that of the contact judges them.  Each yields pairs of a name and a content.  Where a part does not exist,
the last pair is ``refused`` with the condition and its place; the other chains are not affected.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from ncgear.errors import located
from ncgear.project.drive import Drive
from ncgear.studio.faults import refusal

Answer = tuple[str, Any]

Answers = Callable[[Drive], Iterator[Answer]]


def guarded(answers: Answers, drive: Callable[[], Drive]) -> Iterator[Answer]:
    """The answers about a drive, and a refusal in the place of those that cannot be given, whatever the reason."""
    part = "design"
    try:
        made = drive()
        with located(made.places):
            for name, content in answers(made):
                part = name
                yield name, content
    except Exception as error:
        yield "refused", refusal(error, part)
