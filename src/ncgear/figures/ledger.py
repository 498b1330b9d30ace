"""The reproduction ledger as a page in Markdown, and its summary as text."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ncgear.figures.tables import markdown
from ncgear.figures.terminal import written_lines
from ncgear.papers.entry import Finding, Paper, Reason
from ncgear.papers.judgement import JudgedEntry, Judgement

PAGE = "reproduction.md"

HEAD = """# Reproduction ledger

Every figure of six publications that can be computed, computed by ncgear from what they give themselves. Written by
`ncgear reproduce`; a test holds this page against the code, and every verdict against its computation.

- **reproduced**: the computed number is within half a step of the last digit printed. Zeros at the end of a whole
  number do not count as digits. Dimensions are taken as exact. Where a number is made of others that the paper prints
  rounded, readings or results, their rounding is allowed for as well.
- **reproduced under a stated reading**: the same, with something that the paper leaves open, or says otherwise, read as
  stated, for a reason that would stand without the figure.
- **reproduced under a reading chosen because it fits**: the same, but the figure itself told which reading to take. It
  shows that the figure can be explained, not that it is so.
- **an input given back**: the figure is one of those that the computation starts from. That it comes out again says
  that the computation keeps to its input, and no more.
- **not reproducible**: the computed number is another, or a claim does not hold, for the reason given.
- **needs data the paper does not give**: nothing can be computed, or only with an assumption that is stated.

What the paper makes of numbers that it prints itself (sums, differences, quotients, comparisons) is computed from these
as printed; such a line says "of printed numbers". It judges the paper's arithmetic; the numbers that go into it have
lines of their own, or stand in the list of what is left out, with the reason, below each table. A claim of more or less
shows the pair of numbers that bears it out least. An equation is reproduced where it agrees with the exact motion or
with what it is derived from to 1e-9 of its largest term.

`tests/printed_figures.py` lists, by table and section, what the papers print, made from their texts and not from this
page; a test holds that every number and every claim of it stands here."""

COLUMNS = ("place", "figure", "published", "computed", "difference", "verdict", "reading, reason or missing data")

KEYS = (*COLUMNS[:-1], "words")
"""The same columns as keys."""


def ledger_page(judgements: Sequence[Judgement]) -> str:
    """The whole page."""
    counts = [
        (judgement.paper.title, *(str(judgement.count(verdict)) for verdict in Finding)) for judgement in judgements
    ]
    overview = "\n".join(markdown(("paper", *Finding), counts))
    return "\n\n".join([HEAD, overview, *map(_section, judgements)]) + "\n"


def ledger_figures(judgements: Sequence[Judgement]) -> dict[str, Any]:
    """Every paper with its counts by verdict and its figures: the cells of the page, and the numbers computed."""
    return {
        "papers": [
            {
                "title": judgement.paper.title,
                "reference": judgement.paper.reference,
                "verdicts": {verdict.value: judgement.count(verdict) for verdict in Finding},
                "figures": [
                    {
                        **dict(zip(KEYS, _row(judged), strict=True)),
                        "computed_values": list(judged.computed.values) if judged.computed else [],
                    }
                    for judged in judgement.entries
                ],
            }
            for judgement in judgements
        ]
    }


def ledger_text(judgements: Sequence[Judgement], paths: Sequence[Path], kept: Sequence[Path] = ()) -> str:
    """Counts by paper and verdict, the files written, and those kept."""
    blocks = [
        "\n".join([judgement.paper.title, *(f"  {judgement.count(verdict):>4}  {verdict}" for verdict in Finding)])
        for judgement in judgements
    ]
    return "\n\n".join([*blocks, "\n".join(written_lines(paths, kept))])


def _section(judgement: Judgement) -> str:
    paper, table = judgement.paper, markdown(COLUMNS, map(_row, judgement.entries))
    return "\n".join([f"## {paper.title}", "", f"{paper.reference}.", "", *table, *_left_out(paper)])


def _left_out(paper: Paper) -> list[str]:
    """What is not computed, by reason, with how many numbers it is."""
    lines = []
    for reason in Reason:
        items = [item for item in paper.left_out if item.reason is reason]
        if items:
            lines += ["", f"Left out, {reason}:", ""]
        for item in items:
            count = f" ({len(item.figures)} numbers)" if len(item.figures) > 1 else ""
            lines.append(f"- {_places(item.places)}: {item.content}{count}")
    return lines


def _row(judged: JudgedEntry) -> tuple[str, ...]:
    entry, computed = judged.entry, judged.computed
    published = entry.published
    found = published.computed_text(computed) if computed else "-"
    difference = published.difference_text(computed) if computed else "-"
    what = f"{entry.what}, of printed numbers" if entry.of_printed else entry.what
    return (_places(entry.places), what, published.text, found, difference, entry.verdict, entry.words)


def _places(places: Sequence[str]) -> str:
    """The places on one line, each kind named once: ``eq. 1``, ``eq. 2`` -> ``eq. 1, 2``."""
    texts: list[str] = []
    kind = ""
    for place in places:
        name, _, number = place.rpartition(" ")
        texts.append(number if name == kind else place)
        kind = name
    return ", ".join(texts)
