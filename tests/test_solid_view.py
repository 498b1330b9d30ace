"""The gears in 3D in a report: what is packed into the page, what may run there, and what a browser shows of it."""

from __future__ import annotations

import gzip
import io
import re
from base64 import b64decode, b64encode
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

import reports
from drives import drive
from ncgear.drawings import solid_pair as module
from ncgear.drawings.solid_pair import SolidView, solid_view
from ncgear.pitch.shape import Gear
from scenes import CHROMIUM, GEARLESS, in_a_browser

WITH_WEBGL = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
WITHOUT = ["--no-sandbox", "--disable-gpu", "--disable-3d-apis"]


def view(name: str, title: str) -> SolidView:
    pair = drive(name)
    return solid_view(pair.solids, pair.pitch.center_distance_mm, title)


def unpacked(name: str) -> str:
    return gzip.decompress(b64decode(view(name, "").packed)).decode()


@pytest.mark.slow
def test_the_packed_page_holds_both_gears_and_one_script() -> None:
    html = unpacked("pump-1-2")
    (script,) = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    digest = b64encode(sha256(script.encode()).digest()).decode()
    assert view("pump-1-2", "").script_hash == f"'sha256-{digest}'"
    (data,) = re.findall(r'base64_data="([^"]+)"', script)
    scene = trimesh.load(io.BytesIO(b64decode(data)), file_type="glb")
    for name in ("driving", "driven"):
        mesh = drive("pump-1-2").solids.of(Gear(name)).mesh
        assert scene.geometry[name].volume == pytest.approx(mesh.volume, rel=1e-5)


@pytest.mark.slow
def test_the_same_gears_give_the_same_bytes() -> None:
    assert view("pump-1-2", "a") == view("pump-1-2", "a")


@pytest.mark.thorough
def test_a_view_that_is_too_large_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_BYTES", 1000)
    assert view("pump-1-2", "").packed == ""


@pytest.mark.slow
def test_the_page_names_the_hashes_of_what_it_may_run_and_asks_for_nothing_else() -> None:
    page = reports.page("pump-1-2")
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', page)
    rules = dict(rule.strip().split(" ", 1) for rule in policy.replace("&#39;", "'").split(";"))
    assert rules["default-src"] == "'none'"
    assert len(rules["script-src"].split()) == 2
    assert rules["connect-src"] == "data:"
    assert view("pump-1-2", "").script_hash in rules["script-src"]
    (packed,) = re.findall(r'<script type="application/gzip">([^<]*)<', page)
    assert len(packed) < 400_000


@pytest.mark.slow
def test_a_design_without_gears_has_no_view(tmp_path: Path) -> None:
    path = tmp_path / "gearless.yaml"
    path.write_text(GEARLESS, encoding="utf-8")
    page = reports.page_of(path)
    assert "application/gzip" not in page
    assert "connect-src" not in page


@pytest.fixture(scope="module")
def playwright() -> Iterator[Any]:
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with sync_api.sync_playwright() as started:
        yield started


def shown(playwright: Any, flags: list[str], tmp_path: Path) -> tuple[Any, list[str]]:
    """The page after its button is pressed, and what it has said."""
    path = tmp_path / "report.html"
    path.write_text(reports.page("pump-1-2"), encoding="utf-8")
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
    page, said = browser.new_context(offline=True, viewport={"width": 900, "height": 700}).new_page(), list[str]()
    page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(path.as_uri())
    assert page.locator("iframe").count() == 0
    button = page.get_by_role("button", name="both gears in 3D")
    button.focus()
    page.keyboard.press("Enter")
    return page, said


def colored(page: Any) -> tuple[float, float]:
    """Shares of the frame's pixels that are clearly blue, and clearly orange."""
    picture = Image.open(io.BytesIO(page.locator("iframe").screenshot())).convert("RGB")
    red, _, blue = np.moveaxis(np.asarray(picture, dtype=int), -1, 0)
    return float(np.mean(blue - red > 60)), float(np.mean(red - blue > 60))


@pytest.mark.slow
@in_a_browser
def test_a_browser_shows_both_gears(playwright: Any, tmp_path: Path) -> None:
    page, said = shown(playwright, WITH_WEBGL, tmp_path)
    frame = page.frame_locator("iframe")
    frame.locator("canvas").wait_for()
    for _ in range(40):
        if min(colored(page)) > 0.005:
            break
        page.wait_for_timeout(250)
    blue, orange = colored(page)
    assert blue > 0.01
    assert orange > 2.0 * blue
    assert said == []
    assert page.locator("iframe").get_attribute("title") == "both gears in 3D"
    page.context.browser.close()


@pytest.mark.slow
@in_a_browser
def test_a_browser_without_webgl_says_so(playwright: Any, tmp_path: Path) -> None:
    page, said = shown(playwright, WITHOUT, tmp_path)
    page.wait_for_timeout(300)
    assert "WebGL is missing" in page.locator(".solid output").inner_text()
    assert page.locator("iframe").count() == 0
    assert said == []
    page.context.browser.close()
