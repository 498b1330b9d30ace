"""The documentation as a site: every page is in it, every link leads somewhere, and nothing comes from outside."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from html import unescape
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

from commands import ROOT
from documented.pages import PAGES
from scenes import in_a_browser

pytestmark = pytest.mark.skipif(find_spec("furo") is None, reason="the site needs .venv/bin/pip install -e '.[docs]'")

SITE = ["-q", "-W", "--keep-going", "-n", "-b", "html"]


def built(source: Path, out: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "sphinx", *SITE, "-c", str(source / "docs" / "site"), str(source), str(out)]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=source)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("site")
    done = built(ROOT, out)
    assert (done.returncode, done.stderr) == (0, "")
    return out


def targets(page: Path) -> list[str]:
    """What a page of the site links to, shows or loads."""
    text = page.read_text(encoding="utf-8")
    return [unescape(one) for one in re.findall(r'(?:href|src)="([^"]+)"', text)]


@pytest.mark.slow
def test_every_page_is_in_the_site_and_can_be_searched_for(site: Path) -> None:
    names = [page.relative_to(ROOT).with_suffix("") for page in PAGES]
    assert [name for name in names if not (site / f"{name}.html").exists()] == []
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    assert [name for name in names if f'"{name}"' not in index] == []
    assert "dwell" in index


@pytest.mark.slow
def test_every_link_of_the_site_leads_somewhere(site: Path) -> None:
    """Read from the pages that were written, anchors too; Sphinx itself only knows what it resolved."""
    lost, seen = [], 0
    for page in site.rglob("*.html"):
        for target in targets(page):
            path, _, anchor = target.partition("#")
            if "://" in path or path.startswith(("data:", "mailto:")) or page.name in ("genindex.html", "search.html"):
                continue
            file = page if not path else page.parent / unquote(path.partition("?")[0])
            seen += 1
            if not file.exists() or (anchor and file.suffix == ".html" and not has(file, unquote(anchor))):
                lost.append(f"{page.relative_to(site)}: {target}")
    assert lost == []
    assert seen > 1000


def has(page: Path, anchor: str) -> bool:
    return anchor in ids(page)


IDS: dict[Path, set[str]] = {}


def ids(page: Path) -> set[str]:
    if page not in IDS:
        IDS[page] = set(re.findall(r'id="([^"]+)"', page.read_text(encoding="utf-8")))
    return IDS[page]


@pytest.mark.slow
def test_the_site_loads_nothing_from_outside(site: Path) -> None:
    loads = re.compile(r'<(?:script|img|link|iframe)[^>]*(?:src|href)="(?:https?:)?//')
    assert [page for page in site.rglob("*.html") if loads.search(page.read_text(encoding="utf-8"))] == []
    styles = [path.read_text(encoding="utf-8") for path in site.rglob("*.css")]
    assert not any(re.search(r"(?:url\(|@import)\s*[\"']?(?:https?:)?//", style) for style in styles)


@pytest.mark.slow
def test_every_page_says_what_it_is_about_to_those_who_search(site: Path) -> None:
    said = {}
    for name in (page.relative_to(ROOT).with_suffix(".html") for page in PAGES):
        found = re.findall(r'<meta content="([^"]*)" name="description"', (site / name).read_text(encoding="utf-8"))
        said[str(name)] = unescape(found[0]) if len(found) == 1 else ""
    assert {name: words for name, words in said.items() if not 20 <= len(words) <= 155 or "](" in words} == {}
    assert len(set(said.values())) == len(said)


@pytest.mark.slow
def test_the_folder_of_the_site_leads_to_its_first_page(site: Path) -> None:
    (first,) = targets(site / "index.html")
    text = (site / first).read_text(encoding="utf-8")
    assert "What it costs" in text
    assert f"url={first}" in (site / "index.html").read_text(encoding="utf-8")


WIDE = """() => Array.from(document.querySelectorAll('article *'))
    .filter(one => one.getBoundingClientRect().right > innerWidth + 1 && !one.closest('pre, .math'))
    .map(one => one.outerHTML.slice(0, 80))"""
"""What goes over the right edge of a window; programs and equations are moved by a finger."""


@in_a_browser
@pytest.mark.slow
def test_on_a_phone_nothing_is_wider_than_the_page(site: Path, browser: Any) -> None:
    page = browser.new_page(viewport={"width": 390, "height": 844})
    wide = {}
    for name in (one.relative_to(ROOT).with_suffix(".html") for one in PAGES):
        page.goto((site / name).as_uri(), wait_until="domcontentloaded")
        wide[str(name)] = page.evaluate(WIDE)
    assert {name: found for name, found in wide.items() if found} == {}
    page.add_style_tag(content="article p { min-width: 30em }")
    assert page.evaluate(WIDE), "what is too wide is seen"


@pytest.mark.long
@pytest.mark.slow
def test_a_link_that_leads_nowhere_ends_the_build(tmp_path: Path) -> None:
    copied = tmp_path / "tree"
    for name in ("docs", "designs", "benchmarks", "src"):
        shutil.copytree(ROOT / name, copied / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "Makefile"):
        shutil.copy(ROOT / name, copied / name)
    with (copied / "docs" / "words.md").open("a", encoding="utf-8") as page:
        page.write("\n[gone](gone.md) and [nowhere](gallery.md#nowhere)\n")
    (copied / "docs" / "alone.md").write_text("# In no contents\n", encoding="utf-8")
    done = built(copied, tmp_path / "site")
    assert done.returncode != 0
    for words in ("gone.md", "nowhere", "alone.md"):
        assert words in done.stderr
