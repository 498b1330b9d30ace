"""A drive's output in a browser: the machine runs only when it is asked to, and stands where the law puts it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drives
from ncgear.drawings.scene.scene import scene_of
from scenes import in_a_browser

pytestmark = [pytest.mark.slow, in_a_browser]

LIGHT, DARK = '<body data-jp-theme-light="true">', '<body data-jp-theme-light="false">'

PLACES = """share => {
  const groups = [...document.querySelectorAll("svg.scene g[id]")];
  const world = document.querySelector("svg.scene .world").getCTM().inverse();
  for (const one of document.getAnimations()) one.currentTime = share * one.effect.getTiming().duration;
  return Object.fromEntries(groups.map(group => {
    const m = world.multiply(group.getCTM());
    return [group.id.split("-").slice(2).join("-"), [m.e, m.f, Math.atan2(m.b, m.a)]];
  }));
}"""
"""Where every moving group is, in mm and rad, at a share of the loop; the browser's own matrices."""


@pytest.fixture(scope="module")
def page(browser: Any) -> Any:
    return browser.new_context(offline=True).new_page()


def shown(page: Any, name: str, body: str, folder: Path) -> None:
    path = folder / "output.html"
    path.write_text(f'<!DOCTYPE html><meta charset="utf-8">{body}{drives.drive(name)._repr_html_()}', encoding="utf-8")
    page.goto(path.as_uri())


@pytest.mark.parametrize("name", ["pusher", "pump-1-2", "spiral-pair", "log-generator"])
def test_every_body_is_where_the_law_puts_it(page: Any, name: str, tmp_path: Path) -> None:
    """At frames and between them; between, a gear may be astray by what the page says of itself."""
    shown(page, name, LIGHT, tmp_path)
    scene = scene_of(drives.drive(name))
    for share in (0.0, 0.125, 0.3, 0.501, 0.77):
        phi1 = scene.loop_rad * ((1.0 - abs(1.0 - 2.0 * share)) if scene.swings else share)
        found, poses = page.evaluate(PLACES, share), scene.poses(np.array([phi1]))
        assert set(poses.places) <= set(found)
        for body, places in poses.places.items():
            x, y, angle = found[body]
            assert np.hypot(*(np.array([x, y]) - places.origin_mm[0])) < 3e-3 * scene.machine.linkage.crank_mm + 1e-3
            assert abs(np.angle(np.exp(1j * (angle - places.angle_rad[0])))) < 2e-3, body


def test_it_stands_until_it_is_asked_to_run(page: Any, tmp_path: Path) -> None:
    shown(page, "pusher", LIGHT, tmp_path)
    states = "document.getAnimations().map(one => one.playState)"
    assert set(page.evaluate(states)) == {"paused"}
    page.get_by_label("run the machine").check()
    assert set(page.evaluate(states)) == {"running"}
    page.get_by_label("run the machine").uncheck()
    assert set(page.evaluate(states)) == {"paused"}


def test_it_is_light_or_dark_as_its_notebook_and_never_wider(page: Any, tmp_path: Path) -> None:
    color = "getComputedStyle(document.querySelector('.ncgear h3')).color"
    found = []
    for body in (LIGHT, DARK):
        shown(page, "pusher", body, tmp_path)
        found.append(page.evaluate(color))
        page.set_viewport_size({"width": 390, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert found == ["rgb(27, 31, 36)", "rgb(232, 235, 239)"]
