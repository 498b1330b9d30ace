"""The documentation as a site: ``make site`` builds it from the pages as they are, into export/site.

Sphinx with MyST and Furo, since all three are kept well, read Markdown as GitHub does, search without a server, and
load nothing from the network.  MkDocs has had no release since 2024 and the theme that most take with it is no longer
developed; its successor Zensical is younger than a year.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from ncgear import __version__
from ncgear.drawings.palette import DARK, LIGHT

ROOT = Path(__file__).parents[2]

project, author, language = "ncgear", "the ncgear authors", "en"
project_copyright = "MIT licence"
release = version = __version__

extensions = ["myst_parser"]
root_doc = "README"
include_patterns = ["CONTRIBUTING.md", "SECURITY.md", "README.md", "CHANGELOG.md", "docs/**.md", "benchmarks/*.md"]
exclude_patterns = ["export", "build", "**/.*", "**/__pycache__"]

# As many levels of headings as the pages have; names as GitHub gives them.
myst_heading_anchors = 4

html_theme = "furo"
html_title = f"ncgear {__version__}"
html_show_sphinx = False
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
    "Begin": ("docs/tutorial", "docs/gallery", "docs/words", "docs/abilities", "docs/python"),
    "Commands": tuple(f"docs/commands/{page.stem}" for page in sorted((ROOT / "docs" / "commands").glob("*.md"))),
    "What to write": (
        "docs/design-file",
        "docs/balance-file",
        "docs/mechanisms",
        "docs/gears-alone",
        "docs/open-gears",
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

LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(([^)#:\s]+)\)")


def _for_site(_: object, page: str, text: list[str]) -> None:
    """A page as the site shows it: folders of designs are the gallery, and the first page has the contents."""
    up = "../" * page.count("/")

    def without_folders(link: re.Match[str]) -> str:
        words, target = link.groups()
        place = (ROOT / page).parent / target
        if not place.is_dir():
            return link[0]
        return f"[{words}]({up}docs/gallery.md)" if "designs" in place.resolve().parts else words

    text[0] = LINK.sub(without_folders, text[0])
    if page == root_doc:
        text[0] += "".join(
            f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n" + "\n".join(f"/{one}" for one in pages) + "\n```\n"
            for caption, pages in CONTENTS.items()
        )


def setup(app: Any) -> None:
    """What Sphinx calls: pages are changed as they are read, and their files are not."""
    app.connect("source-read", _for_site)
