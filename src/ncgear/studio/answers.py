"""What the studio tells of a design, part by part, each as soon as it is computed, as plain values for the page.

There are three chains, which three processes follow side by side: that of the motion needs no gear, that of the gears
makes teeth, that of the contact judges them.  Each yields pairs of a name and a content.  Where a part does not exist,
the last pair is ``refused`` with the condition and its place; the other chains are not affected.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from ncgear.errors import DesignError, WrongInput
from ncgear.project.drive import Drive
from ncgear.studio.faults import words_of

Answer = tuple[str, Any]

Answers = Callable[[Drive], Iterator[Answer]]


def guarded(answers: Answers, drive: Callable[[], Drive]) -> Iterator[Answer]:
    """The answers about a drive, and a refusal in the place of those that cannot be given, whatever the reason."""
    part = "design"
    try:
        for name, content in answers(drive()):
            part = name
            yield name, content
    except Exception as error:
        yield "refused", refusal(error, part)


def refusal(error: Exception, part: str = "") -> dict[str, Any]:
    """Why the parts after one do not exist."""
    design = error if isinstance(error, DesignError) else DesignError(words_of(error))
    place = design.location.rpartition(":")[0].rpartition(":")[2]
    return {
        "after": part,
        "wrong_input": isinstance(design, WrongInput),
        "problem": design.problem,
        "key": design.key,
        "line": int(place) if place.isdigit() else None,
    }
