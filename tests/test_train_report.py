"""The report of trains that are no machine by themselves: figures and contact of a build, and the train running."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands import Run
from drives import DESIGNS
from ncgear.design.reading.design_file import load_train
from scenes import in_a_browser

MOVING = DESIGNS / "moving-axis.yaml"


def test_a_report_of_a_train_tells_what_a_build_tells(run: Run, tmp_path: Path) -> None:
    assert run("build", str(MOVING), "--out", str(tmp_path / "built"))[0] == 0
    status, out, _ = run("report", str(MOVING), "--out", str(tmp_path / "told"), "--json")
    assert status == 0
    figures = json.loads((tmp_path / "built" / "summary.json").read_text())
    assert json.loads(out) == figures
    page = (tmp_path / "told" / "report.html").read_text()
    for row in figures["verdict"]:
        assert row["says"].replace("&", "&amp;") in page, row["condition"]
    (mesh,) = figures["meshes"]
    assert f"<td>{round(1e3 * mesh['gap_max_mm'], 2):g}</td>" in page
    assert figures["design"]["description"] in page
    assert "speed_rpm: 60" in page
    # Nothing is loaded from outside, and no chart is announced where there is none.
    assert not re.search(r"""(?:src|href)=["']https?:""", page)
    assert 'id="curves"' not in page


def test_a_report_of_a_train_takes_no_times(run: Run) -> None:
    status, _, error = run("report", str(MOVING), "--timing")
    assert status == 2
    assert "--timing" in error
    assert "not offered for a train" in error


@pytest.mark.slow
@in_a_browser
def test_a_train_runs_in_its_report(browser: Any, run: Run, tmp_path: Path) -> None:
    assert run("report", str(MOVING), "--out", str(tmp_path))[0] == 0
    page, faults = browser.new_page(), list[str]()
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.goto((tmp_path / "report.html").as_uri())
    train = load_train(MOVING).file.train.train()
    for phi1 in (0.0, 1.1, 4.4):
        page.evaluate("phi1 => ncgear.show(phi1)", phi1)
        poses = train.poses_at(np.array([phi1]))
        for number in range(2):
            moved = re.findall(r"-?\d[-\d.e]*", page.locator(f"#scene-part-{number}").get_attribute("transform"))
            found = [float(one) for one in moved]
            assert found[:2] == pytest.approx([poses.x_mm[number, 0], poses.y_mm[number, 0]], abs=1e-3)
            assert np.radians(found[2]) == pytest.approx(poses.angle_rad[number, 0], abs=1e-4)
    page.screenshot(path=tmp_path / "report.png")
    assert faults == []
    page.close()
