"""Pieces of the studio by themselves: choices in their groups, thinned lines, what a best law would save."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncIterator
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("starlette", reason="python -m pip install 'ncgear[studio]' installs the server")

from at_once import at_once
from drives import loaded
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.optimum.makeable.wishes import Goal
from ncgear.studio import drawing, editing, open_page, server
from ncgear.studio.handles import _factor
from ncgear.studio.jobs import COMMANDS, Job
from ncgear.studio.motion_answers import LIVE_POINTS, _thinned
from ncgear.studio.page import GROUPS, beginnings, start_page
from ncgear.studio.told import saved

pytestmark = pytest.mark.judges("studio")

Fake: Any = SimpleNamespace


def test_choices_stand_below_the_heading_of_their_group() -> None:
    content, _ = start_page("/somewhere", "")
    sections = re.findall(r"<h2[^>]*>(.*?)</h2>(.*?)</section>", content, re.DOTALL)
    assert [heading for heading, _ in sections] == list(GROUPS)
    keys = {heading: re.findall(r'value="([^"]+)"', body) for heading, body in sections}
    for one in beginnings():
        assert [heading for heading, of in keys.items() if one.key in of] == [one.group]


@at_once("count", [5, 399, 400, 1000, 4321])
def test_lines_that_follow_a_hand_keep_their_ends_and_both_sides_of_jumps(count: int) -> None:
    angles = np.sort(np.random.default_rng(count).uniform(0.0, 360.0, count))
    jumps = [count // 3, count - 3]
    for jump in jumps:
        angles[jump + 1] = angles[jump]
    angles = np.sort(angles)
    kept = _thinned(angles)
    assert (kept[0], kept[-1]) == (0, count - 1)
    assert {*jumps, *(jump + 1 for jump in jumps)} <= {*kept.tolist()}
    assert (np.diff(kept) > 0).all()
    step = max(count // LIVE_POINTS, 1)
    assert np.diff(kept).max() <= step
    assert len(kept) <= count / step + 6


@at_once(
    ("own", "words", "full"),
    [
        (100.0, "power up to 20.0 % lower", "power: 100 now, no law below 80 W"),
        (80.7, "power within 1 % of the limit", "power: 80.7 now, no law below 80 W"),
        (64.0, "power 25.0 % higher", "power: 64 now, no law below 80 W keeps every wish and limit"),
    ],
)
def test_a_best_law_saves_what_lies_above_the_limit(
    own: float, words: str, full: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    best = Fake(
        begun=Fake(bound=Fake(value=80.0)),
        given_figures=own,
        wishes=Fake(goal=Goal.POWER, prices=Fake(of=lambda given: given)),
    )
    monkeypatch.setattr("ncgear.project.best_law.BestLaw", lambda design: best)
    monkeypatch.setattr("ncgear.figures.best_law.unit_of_goal", lambda best: "W")
    assert saved(loaded("pump-1-2").design) == {"words": words, "in_full": full}


def test_nothing_is_said_where_no_limit_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    best = Fake(begun=Fake(bound=None), given_figures=1.0)
    monkeypatch.setattr("ncgear.project.best_law.BestLaw", lambda design: best)
    assert saved(loaded("pump-1-2").design) is None

    class Refused:
        def __init__(self, design: Any) -> None:
            pass

        @property
        def begun(self) -> Any:
            raise NoSuchMechanism("no law")

    monkeypatch.setattr("ncgear.project.best_law.BestLaw", Refused)
    assert saved(loaded("pump-1-2").design) is None


def test_pages_that_are_closed_are_forgotten_the_oldest_first(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Those that are open stay, and so do as many others as are remembered."""
    gone: list[int] = []
    opened = iter(range(1000))

    def page(path: Path, out: Path, ready: Any) -> Any:
        number = next(opened)
        return Fake(number=number, draft=Fake(let_go=lambda: gone.append(number)))

    monkeypatch.setattr(server, "OpenPage", page)
    monkeypatch.setattr(server, "MOST_REMEMBERED", 5)
    studio = server.Studio(tmp_path / "design.yaml", tmp_path)
    studio.open["page 1"] = Fake()
    for number in range(9):
        ready = studio.ready
        assert studio.page_of(f"page {number}") is studio.page_of(f"page {number}")
        assert studio.ready is not ready
        assert len(studio.pages) == min(number + 1, 5)
    assert [*studio.pages] == ["page 1", *(f"page {number}" for number in range(5, 9))]
    assert gone == [0, 2, 3, 4]


def test_a_drawing_that_comes_in_parts_is_dropped_as_a_whole(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    came: list[tuple[str, bytes]] = []

    async def dropped(name: str, content: bytes) -> None:
        came.append((name, content))

    def answer(page: str, *parts: bytes) -> Any:
        async def stream() -> AsyncIterator[bytes]:
            for part in parts:
                yield part

        request: Any = Fake(query_params={"page": page, "name": "heart.svg"}, stream=stream)
        return asyncio.run(studio.drop(request))

    monkeypatch.setattr(server, "LARGEST_DRAWING", 8)
    studio = server.Studio(tmp_path / "design.yaml", tmp_path)
    studio.open["one"], studio.pages["one"] = Fake(), Fake(dropped=dropped)
    assert answer("two", b"abc").status_code == 404
    assert (answer("one", b"abc", b"def", b"gh").status_code, came) == (200, [("heart.svg", b"abcdefgh")])
    assert answer("one", b"abc", b"def", b"ghi").status_code == 413
    assert len(came) == 1


@at_once(("quantity", "factor"), [("velocity", 2.5), ("acceleration", 6.25), ("ratio", 0.8)])
def test_a_point_moves_its_key_by_the_speed_of_the_law(quantity: str, factor: float) -> None:
    """A law at 50 r/min runs at 20: speeds there are 2.5 times those of the machine; a ratio goes by its own value."""
    drive = Fake(law_speed_rpm=50.0, design=Fake(operation=Fake(speed_rpm=20.0)))
    assert _factor(drive, Fake(speed_rpm=None, quantity=quantity, value=1.2), 1.5) == pytest.approx(factor)


# --- commands of a page ----------------------------------------------------------------------------------------------


def job(**changes: Any) -> Any:
    values = {"name": "build", "status": 0, "cancelled": False, "begun_s": 0.0, "folder": Path(), "as_plain": {}}
    return Fake(**values | changes)


def test_a_command_waits_for_another_of_its_folder_and_where_two_run_already(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[Any] = []
    monkeypatch.setattr(open_page, "running_jobs", {})
    monkeypatch.setattr(open_page, "as_it_is", lambda text, path: Fake(source=Fake(data={"name": "press"})))

    async def carried_out(one: Any) -> None:
        begun.append(one)
        await ended.wait()

    page: Any = Fake(out=tmp_path, file=Fake(path=None), jobs={}, _carried_out=carried_out, _job_told=lambda one: None)
    run = open_page.OpenPage._run

    async def asked() -> None:
        await run(page, "build", "")
        assert [(one.number, one.name, one.folder) for one in page.jobs.values()] == [(1, "build", tmp_path / "press")]
        with pytest.raises(WrongInput, match="runs already and writes into press"):
            await run(page, "build", "")
        open_page.running_jobs.clear()
        page.jobs[2] = Fake(name="frontier", status=None)
        with pytest.raises(WrongInput, match="run already; wait for one"):
            await run(page, "build", "")
        page.jobs[2].status = 1
        await run(page, "build", "")
        await asyncio.sleep(0.0)
        ended.set()

    ended = asyncio.Event()
    asyncio.run(asked())
    assert [one.number for one in begun] == [1, 3]


def test_a_finished_command_has_its_files_and_points_of_a_frontier(tmp_path: Path) -> None:
    folder = tmp_path / "press"
    (folder / ".hidden").mkdir(parents=True)
    for name in ("frontier.json", "a.csv", ".hidden/b.csv", ".c"):
        (folder / name).write_text('{"points": [1]}')
    page: Any = Fake(out=tmp_path)

    def told(**changes: Any) -> dict[str, Any]:
        return open_page.OpenPage._plain(page, job(folder=folder, as_plain={"x": 1}, **changes))

    files = ["press/a.csv", "press/frontier.json"]
    assert told(name="frontier") == {"x": 1, "files": files, "frontier": {"points": [1]}}
    assert told(name="build") == {"x": 1, "files": files}
    assert told(name="frontier", status=None) == told(name="frontier", status=2) == {"x": 1}


def test_whole_machines_are_those_that_a_command_wrote_since_it_began(tmp_path: Path) -> None:
    (tmp_path / "machines.json").write_text('{"machines": []}')
    written = (tmp_path / "machines.json").stat().st_mtime

    def found(**changes: Any) -> dict[str, Any]:
        return open_page._machines_of(job(**{"name": "design", "folder": tmp_path, "begun_s": written - 5.0} | changes))

    assert found() == found(status=2, cancelled=True) == {"machines": []}
    assert found(status=None) == found(status=2) == found(name="build") == found(begun_s=written + 5.0) == {}


def test_a_text_over_the_largest_size_is_refused() -> None:
    page: Any = Fake(history=Fake(now="", kept=lambda text: text))
    taken: list[str] = []

    async def step(text: str) -> None:
        taken.append(text)

    page._step = step
    largest = open_page.LARGEST_MB * 1_000_000
    asyncio.run(open_page.OpenPage.text(page, {"text": "a" * largest}))
    assert len(taken[0]) == largest
    for text in ("a" * (largest + 1), "\u00e4" * (largest // 2 + 1), None):
        with pytest.raises(WrongInput, match="a text of at most"):
            asyncio.run(open_page.OpenPage.text(page, {"text": text}))


def test_commands_that_write_into_one_folder_are_alike() -> None:
    one = Job(1, "build", "", "press", Path(), lambda _: None, lines=[str(number) for number in range(500)])
    assert "build" in one.as_plain["alike"]
    assert all(COMMANDS[name].out == COMMANDS["build"].out for name in one.as_plain["alike"])
    assert len(one.as_plain["alike"]) < len(COMMANDS)
    assert (one.as_plain["running"], one.as_plain["done"], one.as_plain["lines"][-1]) == (True, False, "499")
    one.status = 0
    assert (one.as_plain["running"], one.as_plain["done"]) == (False, True)
    one.status = 2
    assert (one.as_plain["running"], one.as_plain["done"]) == (False, False)


def test_files_of_a_name_that_is_taken_are_numbered_from_two(tmp_path: Path) -> None:
    assert drawing._placed(tmp_path, "a.dxf", b"1") == (tmp_path / "a.dxf", True)
    assert drawing._placed(tmp_path, "a.dxf", b"1") == (tmp_path / "a.dxf", False)
    assert drawing._placed(tmp_path, "a.dxf", b"2") == (tmp_path / "a-2.dxf", True)
    assert drawing._placed(tmp_path, "a.dxf", b"3") == (tmp_path / "a-3.dxf", True)
    assert drawing._placed(tmp_path, "a.dxf", b"2") == (tmp_path / "a-2.dxf", False)


def test_another_mechanism_has_the_same_crank_and_keeps_what_has_the_same_keys() -> None:
    text = "linkage: {crank_mm: 80, rod_mm: 200}\nmasses: {slider_kg: 1}\n"
    yoke = editing._another_mechanism(text, "scotch_yoke")
    assert yoke["linkage"]["kind"] == "scotch_yoke"
    assert yoke["linkage"]["crank_mm"] == 80
    assert yoke["masses"] is None
    back = editing._another_mechanism(text, "crank_slider")
    assert "kind" not in back["linkage"]
    assert back["linkage"]["crank_mm"] == 80
    assert "masses" not in back
    none = editing._another_mechanism(text, editing.NO_LINKAGE)
    assert none["linkage"] is none["masses"] is None


@pytest.mark.parametrize(
    ("changes", "design", "taken"),
    [
        ({"name": "optimize"}, None, "press-optimized.yaml"),
        ({"name": "optimize", "status": 2}, None, None),
        ({"name": "build"}, None, None),
        ({"name": "design"}, "machine-1", "machine-1.yaml"),
        ({"name": "design"}, "machine-9", None),
    ],
)
def test_what_a_command_has_found_is_taken_over(
    changes: dict[str, Any], design: str | None, taken: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "machines.json").write_text('{"machines": [{"name": "machine-1"}]}')
    (tmp_path / "press-optimized.yaml").write_text("")
    monkeypatch.setattr(open_page, "design_on_disk", lambda path: Fake(text=path.name))
    stepped: list[str] = []

    async def step(text: str) -> None:
        stepped.append(text)

    page: Any = Fake(_job=lambda message: job(folder=tmp_path, **changes), _step=step)
    page.history = Fake(kept=lambda text: text)
    with nullcontext() if taken else pytest.raises(WrongInput, match="has found no design"):
        asyncio.run(open_page.OpenPage.adopt(page, {"design": design}))
    assert stepped == ([taken] if taken else [])
