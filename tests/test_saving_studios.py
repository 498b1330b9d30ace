"""Studios that save at the same time as others, are killed, reloaded, and raced by an editor: nothing is lost."""

from __future__ import annotations

import os
import random
import shutil
import time
from contextlib import ExitStack
from pathlib import Path
from threading import Thread

import pytest
from websockets.exceptions import ConnectionClosed

from drives import DESIGNS
from ncgear.files.one_file import UNFINISHED
from ncgear.studio.drafts import DRAFT, draft_left
from ncgear.studio.on_disk import design_on_disk
from ncgear.studio.server import TAKEN_OVER
from saving_only import saving_only
from studios import Page, Studio

pytestmark = pytest.mark.slow

DOUBLE_KILLS = 100

FEW = pytest.mark.parametrize("times", [4, 100])


@pytest.fixture
def path(tmp_path: Path) -> Path:
    made = tmp_path / "ellipse.yaml"
    shutil.copy(DESIGNS / "ellipse.yaml", made)
    return made


def speed(number: float) -> dict[str, dict[str, float]]:
    return {"changes": {"operation.speed_rpm": number}}


def has(text: str, number: float) -> bool:
    return f"speed_rpm: {number}" in text


def versions(path: Path) -> list[str]:
    """The texts of a design and of the versions that were kept beside it."""
    return [place.read_text(encoding="utf-8") for place in path.parent.glob(f"{path.stem}*{path.suffix}")]


def answer(page: Page) -> str:
    """What a save was answered: ``saved``, or ``question``."""
    while True:
        heard = page.until("said", "question")
        if heard["is"] == "question" or heard["content"].startswith("saved"):
            return "question" if heard["is"] == "question" else "saved"


def edit(page: Page, number: float) -> None:
    page.send("set", **speed(number))
    while not has(page.until("state")["content"]["text"], number):
        pass


# --- at the same time


@FEW
@pytest.mark.tiers(slow=["1-4"], rest="long")
@pytest.mark.parametrize("studios", [1, 2])
def test_of_two_saves_one_is_saved_and_the_other_is_asked(path: Path, times: int, studios: int) -> None:
    with ExitStack() as ends:
        made = [ends.enter_context(saving_only(path)) for _ in range(studios)]
        pages = [ends.enter_context(made[side % studios].page(f"page{side}")) for side in (0, 1)]
        for page in pages:
            page.until("state")
        for turn in range(times):
            for side, page in enumerate(pages):
                edit(page, 100 + 2 * turn + side)
            pages[0].send("save")
            time.sleep(0.02 * (turn % 2))
            pages[1].send("save")
            said = [answer(page) for page in pages]
            assert sorted(said) == ["question", "saved"], turn
            winner = said.index("saved")
            assert has(path.read_text(encoding="utf-8"), 100 + 2 * turn + winner), turn
            pages[1 - winner].send("redo")
            assert has(pages[1 - winner].until("state")["content"]["text"], 100 + 2 * turn + 1 - winner), turn
            pages[1 - winner].send("anew")
            while not pages[1 - winner].until("state")["content"]["saved"]:
                pass


# --- kills


def killed(studio: Studio) -> None:
    studio.process.kill()
    studio.process.join()


@pytest.mark.long
def test_studios_that_are_killed_twice_while_they_save_lose_nothing(path: Path) -> None:
    """Whatever a page was told of stands in the file or is there again; a save of another design changes nothing."""
    other = path.with_name("other.yaml")
    shutil.copy(path, other)
    chance = random.Random(4)
    for turn in range(DOUBLE_KILLS):
        first, second = 100 + 2 * turn, 101 + 2 * turn
        with saving_only(path) as studio, studio.page() as page:
            page.until("state")
            edit(page, first)
            page.send("save")
            time.sleep(chance.uniform(0.0, 0.12))
            killed(studio)
        whole(path)
        with saving_only(path) as studio, studio.page() as page:
            assert has(page.until("state")["content"]["text"], first), turn
            edit(page, second)
            page.send("save")
            time.sleep(chance.uniform(0.0, 0.12))
            killed(studio)
        whole(path)
        with saving_only(other) as studio, studio.page() as page:
            page.until("state")
            edit(page, first)
            page.send("save")
            assert answer(page) == "saved"
        whole(path)
        assert has(other.read_text(encoding="utf-8"), first), turn
        with saving_only(path) as studio, studio.page() as page:
            assert has(page.until("state")["content"]["text"], second), turn
            page.send("save")
            assert answer(page) == "saved"
        assert has(path.read_text(encoding="utf-8"), second), turn
        assert [name for name in os.listdir(path.parent) if name.startswith(".")] == [], turn


def whole(path: Path) -> None:
    """A file of its own, with all its lines."""
    assert not path.is_symlink()
    count = len((DESIGNS / "ellipse.yaml").read_text(encoding="utf-8").splitlines())
    assert len(path.read_text(encoding="utf-8").splitlines()) == count


def test_edits_of_every_page_of_a_killed_studio_are_there_again_once(path: Path) -> None:
    with saving_only(path) as studio, studio.page("one") as one, studio.page("two") as two:
        one.until("state"), two.until("state")
        edit(one, 11)
        edit(two, 22)
        killed(studio)
    with saving_only(path) as studio, studio.page("a") as first, studio.page("b") as second, studio.page("c") as third:
        texts = [page.until("state")["content"]["text"] for page in (first, second, third)]
        assert [has(texts[0], 22), has(texts[1], 11), has(texts[2], 90)] == [True] * 3
        assert "here again" in first.until("said")["content"]
        first.send("undo")
        assert first.until("state")["content"]["saved"]
    # This one has ended by Ctrl-C; what the first page has undone is not wanted any more.
    left = draft_left(design_on_disk(path))
    assert left is not None
    assert has(left.text, 11)
    assert draft_left(design_on_disk(path)) is None
    left.let_go()


def test_a_drag_that_rests_is_there_again_after_the_studio_was_killed(path: Path) -> None:
    """At its last place, though no end of it was told."""
    with saving_only(path) as studio, studio.page() as page:
        page.until("state")
        for number in range(60):
            page.send("change", **speed(100 + number))
            time.sleep(1 / 60)
        end = time.monotonic() + 30.0
        while not any(has(text, 159) for text in drafts(path)) and time.monotonic() < end:
            time.sleep(0.01)
        killed(studio)
    with saving_only(path) as studio, studio.page() as page:
        assert has(page.until("state")["content"]["text"], 159)
        page.send("undo")
        assert page.until("state")["content"]["saved"]
    assert drafts(path) == []


def drafts(path: Path) -> list[str]:
    places = [place for place in path.parent.iterdir() if DRAFT in place.name and UNFINISHED not in place.name]
    return [place.read_text(encoding="utf-8") for place in places]


# --- reloads


def test_a_drag_whose_page_goes_before_its_end_is_one_step(path: Path) -> None:
    """Whether the page is closed, or loaded anew while its earlier connection is still there."""
    with saving_only(path) as studio, ExitStack() as ends:
        page = ends.enter_context(studio.page("same"))
        page.until("state")
        for number in (101, 102):
            page.send("change", **speed(number))
            page.until("asked")
            if number == 101:
                page.socket.close()
            page = ends.enter_context(studio.page("same"))
            assert has(page.until("state")["content"]["text"], number)
        page.send("undo")
        assert has(page.until("state")["content"]["text"], 101)


def code_at_the_end(page: Page) -> int | None:
    """The code with which the studio has closed a connection, once all that came before has been heard."""
    try:
        while True:
            page.hear(30.0)
    except ConnectionClosed as closed:
        return None if closed.rcvd is None else closed.rcvd.code


@FEW
@pytest.mark.tiers(slow=["4"], rest="long")
def test_a_page_that_is_loaded_anew_soon_after_a_change_goes_on_with_it(path: Path, times: int) -> None:
    """Every other time its earlier connection is still there, and is ended."""
    chance = random.Random(5)
    with saving_only(path) as studio, ExitStack() as ends:
        page = ends.enter_context(studio.page("same"))
        page.until("state")
        for turn in range(times):
            page.send("set", **speed(100 + turn))
            time.sleep(chance.uniform(0.0, 0.05))
            if turn % 2:
                page.socket.close()
            earlier, page = page, ends.enter_context(studio.page("same"))
            while not has(page.until("state", timeout=30.0)["content"]["text"], 100 + turn):
                pass
            assert turn % 2 or code_at_the_end(earlier) == TAKEN_OVER
        page.send("undo")
        while not has(page.until("state")["content"]["text"], 98 + times):
            pass


# --- an editor, and read-only files


@FEW
@pytest.mark.tiers(slow=["True-4"], rest="long")
@pytest.mark.parametrize("by_move", [False, True])
def test_a_save_that_races_an_editor_takes_nothing_from_it(path: Path, times: int, by_move: bool) -> None:
    chance, said = random.Random(6), list[str]()
    with saving_only(path) as studio, studio.page() as page:
        page.until("state")
        for turn in range(times):
            edit(page, 1000 + turn)
            text = path.read_text(encoding="utf-8").replace("speed_rpm", f"# editor {turn}\n    speed_rpm", 1)
            editor = Thread(target=written, args=(path, text, by_move, chance.uniform(0.0, 0.03)))
            editor.start()
            time.sleep(chance.uniform(0.0, 0.03))
            page.send("save")
            said.append(answer(page))
            editor.join()
            texts = versions(path)
            assert text in texts, turn
            assert said[-1] == "saved" or not any(has(one, 1000 + turn) for one in texts), turn
            page.send("anew")
            while not page.until("state")["content"]["saved"]:
                pass
        assert [name for name in os.listdir(path.parent) if name.startswith(".")] == []
    print(said.count("question"), "of", times, "were asked")


def written(path: Path, text: str, by_move: bool, late: float) -> None:
    """Write a file as an editor does: in its place, or beside it and moved there."""
    time.sleep(late)
    if by_move:
        beside = path.with_name("editor.tmp")
        beside.write_text(text, encoding="utf-8")
        beside.replace(path)
    else:
        path.write_text(text, encoding="utf-8")


def test_a_read_only_file_and_a_changed_one_are_asked_about_with_the_difference(path: Path) -> None:
    path.chmod(0o444)
    before = path.read_text(encoding="utf-8")
    with saving_only(path) as studio, studio.page() as page:
        page.until("state")
        edit(page, 33)
        page.send("save", over=True)
        question = page.until("question")["content"]
        assert "ellipse.yaml is read-only" in question["problem"]
        assert path.read_text(encoding="utf-8") == before
        page.send("save", over=True)
        assert answer(page) == "saved"
        assert (has(path.read_text(encoding="utf-8"), 33), path.stat().st_mode & 0o777) == (True, 0o444)
        path.chmod(0o644)
        path.write_text(before.replace("speed_rpm: 90", "speed_rpm: 44"), encoding="utf-8")
        edit(page, 55)
        page.send("save")
        question = page.until("question")["content"]
        lines = question["difference"].splitlines()
        assert "-operation: {speed_rpm: 44}" in lines
        assert "+operation: {speed_rpm: 55}" in lines
        # What was shown may be overwritten, and nothing that has come since.
        path.write_text(before.replace("speed_rpm: 90", "speed_rpm: 66"), encoding="utf-8")
        page.send("save", over=True)
        assert "-operation: {speed_rpm: 66}" in page.until("question")["content"]["difference"]
        page.send("anew")
        while not page.until("state")["content"]["saved"]:
            pass
        page.send("undo")
        state = page.until("state")["content"]
        assert (has(state["text"], 55), has(path.read_text(encoding="utf-8"), 66)) == (True, True)
