"""The documentation as a site: ``make site`` builds it from the pages as they are, into export/site.

Sphinx with MyST and Furo, since all three are kept well, read Markdown as GitHub does, search without a server, and
load nothing from the network.  MkDocs has had no release since 2024 and the theme that most take with it is no longer
developed; its successor Zensical is younger than a year.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from html import escape, unescape
from pathlib import Path
from typing import Any

from ncgear import __version__
from ncgear.drawings.palette import DARK, LIGHT

ROOT = Path(__file__).parents[2]

project, author, language = "ncgear", "the ncgear authors", "en"
project_copyright = "MIT licence"
release = version = __version__

extensions = ["myst_parser"]
root_doc = "docs/index"
include_patterns = ["CONTRIBUTING.md", "SECURITY.md", "README.md", "CHANGELOG.md", "docs/**.md", "benchmarks/*.md"]
exclude_patterns = ["export", "build", "**/.*", "**/__pycache__"]

# As many levels of headings as the pages have; names as GitHub gives them.
myst_heading_anchors = 4

html_theme = "furo"
html_title = f"ncgear {__version__}"
html_show_sphinx = False
html_static_path = ["static"]
html_css_files = ["narrow.css"]
html_copy_source = False
html_theme_options = {
    f"{ground}_css_variables": {
        "color-brand-primary": colors["driving"],
        "color-brand-content": colors["driving"],
        "color-brand-visited": colors["driving"],
    }
    for ground, colors in (("light", LIGHT), ("dark", DARK))
}

CONTENTS = {
    "Begin": ("README", "docs/tutorial", "docs/gallery", "docs/words", "docs/abilities", "docs/python"),
    "Commands": tuple(f"docs/commands/{page.stem}" for page in sorted((ROOT / "docs" / "commands").glob("*.md"))),
    "What to write": (
        "docs/design-file",
        "docs/balance-file",
        "docs/train-file",
        "docs/mechanisms",
        "docs/gears-alone",
        "docs/open-gears",
        "docs/trains",
        "docs/lobed-motors",
        "docs/from-a-drawing-to-gears",
        "docs/pitch-curves",
        "docs/drivetrain",
        "docs/materials",
        "docs/kinds",
    ),
    "How far to trust it": (
        "docs/method",
        "docs/figures",
        "docs/conditions",
        "docs/baler",
        "docs/how-it-is-tested",
        "docs/speed-against-error",
        "docs/hard-cases",
        "docs/reproduction",
        *(f"benchmarks/{page.stem}" for page in sorted((ROOT / "benchmarks").glob("*.md"))),
    ),
    "Working on it": (
        "docs/house",
        "CONTRIBUTING",
        "SECURITY",
        "docs/promises",
        "docs/licences",
        "CHANGELOG",
        "docs/history",
    ),
}
"""The pages in the bar at the side, by its headings; a page that is missing here fails the build."""

LONGEST_ABOUT = 155
"""Letters that those who search show of what a page is about."""

NO_WORDS = "#", "|", "!", "<", "```", "-", "    "
"""Beginnings of what is no paragraph."""

LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(([^)#:\s]+)\)")


def _for_site(_: object, page: str, text: list[str]) -> None:
    """A page as the site shows it: folders of designs are the gallery, what it is about stands in its head.

    The first page has the contents, and the page of a design file those of its sections.
    """
    up = "../" * page.count("/")

    def without_folders(link: re.Match[str]) -> str:
        words, target = link.groups()
        place = (ROOT / page).parent / target
        if not place.is_dir():
            return link[0]
        return f"[{words}]({up}docs/gallery.md)" if "designs" in place.resolve().parts else words

    text[0] = LINK.sub(without_folders, text[0])
    if page == root_doc:
        text[0] += "".join(_contents(pages, f":caption: {caption}\n") for caption, pages in CONTENTS.items())
    if page == "docs/design-file":
        text[0] += _contents(sorted(f"{page}/{one.stem}" for one in (ROOT / page).glob("*.md")))
    text[0] = f"---\nmyst:\n  html_meta:\n    description: {json.dumps(about(text[0]))}\n---\n\n{text[0]}"


def _contents(pages: Iterable[str], options: str = "") -> str:
    return f"\n```{{toctree}}\n:hidden:\n{options}\n" + "\n".join(f"/{one}" for one in pages) + "\n```\n"


def about(text: str) -> str:
    """What a page is about, for those who search: its first paragraph in plain words, of at most 155 letters."""
    paragraphs = re.split(r"\n{2,}", re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL))
    first = next((one for one in map(str.strip, paragraphs) if one and not one.startswith(NO_WORDS)), text)
    named = re.sub(r"\[([^\]]*)\]\([^)]*\)|\*\*(\w[^*]*)\*\*", r"\1\2", first)
    plain = " ".join(named.replace("`", "").split())
    return plain if len(plain) <= LONGEST_ABOUT else plain[: LONGEST_ABOUT - 1].rsplit(" ", 1)[0].rstrip(",;:.") + "…"


HEAD = re.compile(r"<th[^>]*>(.*?)</th>", flags=re.DOTALL)
CELL = re.compile(r"<td( [^>]*)?>")


def _with_heads(_: object, __: str, ___: str, context: dict[str, Any], ____: object) -> None:
    """Each cell of a table says under which head it is; where a page is narrow, it stands beside it."""

    def table(found: re.Match[str]) -> str:
        heads = [unescape(re.sub(r"<[^>]+>", "", head)).strip() for head in HEAD.findall(found[0])]

        def row(cells: re.Match[str]) -> str:
            names = iter(heads)
            return CELL.sub(lambda cell: f'<td{cell[1] or ""} data-head="{escape(next(names, ""))}">', cells[0])

        return re.sub(r"<tr[^>]*>.*?</tr>", row, found[0], flags=re.DOTALL)

    if "body" in context:
        context["body"] = re.sub(r"<table.*?</table>", table, context["body"], flags=re.DOTALL)


def _first_page(app: Any, error: Exception | None) -> None:
    """What a server shows for the folder of the site leads to the first page."""
    if error is None:
        words = f'<!DOCTYPE html><meta http-equiv="refresh" content="0; url={root_doc}.html"><title>ncgear</title>'
        Path(app.outdir, "index.html").write_text(f'{words}<a href="{root_doc}.html">ncgear</a>\n', encoding="utf-8")


def setup(app: Any) -> None:
    """What Sphinx calls: pages are changed as they are read, and their files are not."""
    app.connect("source-read", _for_site)
    app.connect("html-page-context", _with_heads)
    app.connect("build-finished", _first_page)
