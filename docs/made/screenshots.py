"""Pictures of the report and the studio as a browser shows them; they need chromium and the extra ``dev``."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image
from playwright.sync_api import ViewportSize, sync_playwright

ROOT = Path(__file__).parents[2]

SIZE: ViewportSize = {"width": 1200, "height": 800}
SHOWN_DEG = 120
"""Driving angle at which the machine stands: it pushes."""


def report() -> bytes:
    """The top of the pusher's report."""
    with TemporaryDirectory() as folder, sync_playwright() as playwright:
        command = [sys.executable, "-m", "ncgear", "report", "designs/pusher.yaml", "--out", folder]
        subprocess.run(command, cwd=ROOT, check=True)
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport=SIZE, color_scheme="light")
        page.goto((Path(folder) / "report.html").as_uri())
        angle = page.get_by_label("driving angle").last
        angle.fill(str(SHOWN_DEG))
        angle.press("Enter")
        picture = page.screenshot()
        browser.close()
        return picture


STUDIO_SIZE: ViewportSize = {"width": 1280, "height": 800}
GIF_WIDTH = 800
FRAME_MS = 90
DRAGGED = "theta2, v2"
"""The point that is dragged in the moving picture, and by how many pixels for each frame."""
STEPS = [(1.5, 0.0)] * 8 + [(-1.5, 0.0)] * 8


@contextmanager
def _studio(design: str) -> Iterator[Any]:
    """The page of a studio that has computed all of a design."""
    with TemporaryDirectory() as folder, sync_playwright() as playwright:
        path = Path(folder) / f"{design}.yaml"
        shutil.copy(ROOT / "designs" / path.name, path)
        command = [sys.executable, "-m", "ncgear", "studio", str(path), "--no-browser", "--out", f"{folder}/export"]
        with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            address = re.search(r"http://\S+", process.stdout.readline())
            assert address is not None
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            page = browser.new_page(viewport=STUDIO_SIZE, color_scheme="light")
            page.goto(address[0])
            page.wait_for_selector("body[data-done-gears][data-done-motion][data-done-contact]", timeout=60_000)
            yield page
            browser.close()
            process.terminate()


def studio() -> bytes:
    """The studio with the published baler, and a kept variant beside it."""
    with _studio("baler-86") as page:
        page.click("#hold")
        field = page.locator("#key-motion\\.theta3_pi")
        field.fill("1.02")
        field.press("Enter")
        page.wait_for_timeout(4000)
        page.evaluate("ncgear.show(2.2)")
        picture: bytes = page.screenshot()
        return picture


def studio_in_use() -> bytes:
    """A point of the speed curve is dragged there and back; machine and curves follow."""
    with _studio("baler-86") as page:
        dot = page.locator(f".handles circle[aria-label='{DRAGGED}']")
        box = dot.bounding_box()
        assert box is not None
        x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
        frames, angle = [], 0.0
        page.mouse.move(x, y)
        page.mouse.down()
        for right, down in STEPS:
            x, y, angle = x + right, y + down, angle + 0.35
            page.mouse.move(x, y)
            page.evaluate(f"ncgear.show({angle})")
            page.wait_for_timeout(900)
            frames.append(Image.open(BytesIO(page.screenshot())).convert("RGB"))
        page.mouse.up()
    height = round(GIF_WIDTH * STUDIO_SIZE["height"] / STUDIO_SIZE["width"])
    small = [frame.resize((GIF_WIDTH, height), Image.Resampling.LANCZOS) for frame in frames]
    # One palette for all, of a picture with pale and with full colours.
    both = Image.new("RGB", (GIF_WIDTH, 2 * height))
    both.paste(small[0], (0, 0))
    both.paste(small[len(small) // 2], (0, height))
    colors = both.quantize(128, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    made = [frame.quantize(palette=colors, dither=Image.Dither.NONE) for frame in small]
    content = BytesIO()
    made[0].save(content, "GIF", save_all=True, append_images=made[1:], duration=FRAME_MS, loop=0, optimize=True)
    return content.getvalue()
