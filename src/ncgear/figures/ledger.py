"""The reproduction ledger as a page in Markdown, and its summary as text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from ncgear.figures.tables import markdown
from ncgear.papers.entry import Verdict
from ncgear.papers.judgement import Judged, Judgement

PAGE = "reproduction.md"

HEAD = """# Reproduction ledger

Every figure of the four papers that can be computed, computed by ncgear from what the paper itself gives. Written by
`ncgear reproduce --out docs`; a test holds this page against the code, and every verdict against its computation.

- **reproduced**: the computed number is within half a step of the last digit printed. Zeros at the end of a whole
  number do not count as digits. Where a number is made of readings that are printed rounded, their rounding is allowed
  for as well; dimensions are taken as exact.
- **reproduced under a stated reading**: the same, with something that the paper leaves open, or says otherwise, read as
  stated.
- **not reproducible**: the computed number is another, for the reason given.
- **needs data the paper does not give**: nothing can be computed, or only with an assumption that is stated.

An equation is reproduced where it agrees with the exact motion or with what it is derived from to 1e-9 of its largest
term. Nothing is tuned to match."""

COLUMNS = ("place", "figure", "published", "computed", "difference", "verdict", "reading, reason or missing data")


def ledger_page(judgements: Sequence[Judgement]) -> str:
    """The whole page."""
    counts = [(one.paper.title, *(str(one.count(verdict)) for verdict in Verdict)) for one in judgements]
    overview = "\n".join(markdown(("paper", *Verdict), counts))
    return "\n\n".join([HEAD, overview, *map(_section, judgements)]) + "\n"


def ledger_text(judgements: Sequence[Judgement], paths: Iterable[Path]) -> str:
    """Counts by paper and verdict, and the files written."""
    blocks = [
        "\n".join([one.paper.title, *(f"  {one.count(verdict):>4}  {verdict}" for verdict in Verdict)])
        for one in judgements
    ]
    return "\n\n".join([*blocks, *map(str, paths)])


def _section(one: Judgement) -> str:
    """A paper with the table of its figures, and the list of figures that are given and not computed."""
    paper, table = one.paper, markdown(COLUMNS, map(_row, one.entries))
    given = ["Given, not computed:", "", *(f"- {_places(item.places)}: {item.content}" for item in paper.given)]
    return "\n".join([f"## {paper.title}", "", f"{paper.reference}.", "", *table, "", *given])


def _row(judged: Judged) -> tuple[str, ...]:
    entry, computed = judged.entry, judged.computed
    published = entry.published
    found = published.computed_text(computed) if computed else "-"
    difference = published.difference_text(computed) if computed else "-"
    return (_places(entry.places), entry.what, published.text, found, difference, entry.verdict, entry.words)


def _places(places: Sequence[str]) -> str:
    """The places on one line, each kind named once: ``eq. 1``, ``eq. 2`` -> ``eq. 1, 2``."""
    texts: list[str] = []
    kind = ""
    for place in places:
        name, _, number = place.rpartition(" ")
        texts.append(number if name == kind else place)
        kind = name
    return ", ".join(texts)
