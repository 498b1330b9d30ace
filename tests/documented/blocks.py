"""Fenced code blocks of a page, with the line on which each one's code begins."""

from __future__ import annotations

import re
from dataclasses import dataclass

FENCE = re.compile(r"^```(\S*)[ \t]*\n(.*?)^```[ \t]*$", flags=re.DOTALL | re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Block:
    """One fenced block: its language as written behind the fence, its text, the line its text begins on."""

    language: str
    text: str
    line: int


def blocks_of(page: str) -> list[Block]:
    """Every fenced block of a page of Markdown, in order."""
    if page.count("```") % 2:
        raise AssertionError("a fence is not closed")
    return [Block(found[1], found[2], page.count("\n", 0, found.start(2)) + 1) for found in FENCE.finditer(page)]
