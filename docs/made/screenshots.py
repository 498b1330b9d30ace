"""Pictures of the report as a browser shows it; they need chromium and the extra ``dev``."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

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
