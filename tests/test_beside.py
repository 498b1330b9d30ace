"""The second process that draws: the same pictures, its errors, its death, and what it cannot be asked."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from multiprocessing import active_children
from threading import enumerate as enumerate_threads
from typing import Any

import pytest

from commands import ROOT
from ncgear.drawings import beside
from ncgear.drawings.beside import HERE, Drawer, drawing_beside

PRODUCT, FACTORIAL = "math:prod", "math:factorial"


@pytest.fixture
def drawer(monkeypatch: pytest.MonkeyPatch) -> Iterator[Drawer]:
    """A second process, whatever this one has loaded."""
    monkeypatch.setattr(beside, "LIBRARY", "no such library")
    monkeypatch.setattr(beside, "free_cores", lambda: 2)
    with drawing_beside(PRODUCT) as made:
        assert made is not HERE
        yield made


def pid(made: Drawer) -> int:
    number: int = made.begun("os:getpid")()
    return number


@pytest.mark.thorough
def test_drawings_come_from_the_second_process(drawer: Drawer) -> None:
    first, second = drawer.begun(PRODUCT, [2, 3]), drawer.begun("os:getpid")
    assert first() == 6
    assert second() != os.getpid()
    # Its errors are raised here.
    with pytest.raises(ValueError, match="negative"):
        drawer.begun(FACTORIAL, -1)()
    assert drawer.begun(PRODUCT, [5])() == 5
    # What cannot be pickled is drawn here.
    assert list(drawer.begun("builtins:map", lambda value: value + 1, [1, 2])()) == [2, 3]
    assert drawer.begun(PRODUCT, [7])() == 7


@pytest.mark.thorough
def test_where_it_dies_this_process_draws(drawer: Drawer) -> None:
    number = pid(drawer)
    slept = drawer.begun("math:prod", [3, 4])
    os.kill(number, signal.SIGKILL)
    assert slept() == 12
    assert drawer.begun(PRODUCT, [2, 5])() == 10
    assert pid(drawer) == os.getpid()


@pytest.mark.thorough
def test_what_waits_is_drawn_here(drawer: Drawer) -> None:
    """An offer that the second process has begun stays there, and one that was drawn here it passes over."""
    pid(drawer)
    begun = drawer.offered("time:sleep", 0.25)
    waiting = [drawer.offered("os:getpid") for _ in range(3)]
    asked = drawer.begun("os:getpid")
    time.sleep(0.1)
    assert [one() for one in waiting[1:]] == [os.getpid()] * 2
    assert waiting[1]() == os.getpid()
    assert begun() is None
    assert asked() == pid(drawer) != os.getpid()
    # By now its turn has come.
    assert waiting[0]() == pid(drawer)


@pytest.mark.thorough
def test_offers_are_drawn_beside_where_nobody_asks_and_many(drawer: Drawer) -> None:
    offers = [drawer.offered("os:getpid") for _ in range(20)]
    number = pid(drawer)
    assert [one() for one in offers] == [number] * len(offers)


@pytest.mark.thorough
def test_offers_are_drawn_here_where_it_dies_or_cannot_be_asked(drawer: Drawer) -> None:
    assert list(drawer.offered("builtins:map", lambda value: value + 1, [1, 2])()) == [2, 3]
    number = pid(drawer)
    offers = [drawer.offered("time:sleep", 60), drawer.offered(PRODUCT, [3, 4])]
    time.sleep(0.1)
    os.kill(number, signal.SIGKILL)
    assert offers[1]() == 12
    assert drawer.offered(PRODUCT, [2, 5])() == 10


@pytest.mark.thorough
def test_it_ends_with_its_context(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever it still draws."""
    monkeypatch.setattr(beside, "LIBRARY", "no such library")
    monkeypatch.setattr(beside, "free_cores", lambda: 2)
    with drawing_beside(PRODUCT) as made:
        number = pid(made)
        (process,) = (one for one in active_children() if one.pid == number)
        made.begun("time:sleep", 60)
    process.join(10.0)
    assert not process.is_alive()


@pytest.mark.slow
@pytest.mark.parametrize("under_way", ["nothing", "a drawing", "many drawings", "its death"])
def test_no_thread_of_it_is_left(monkeypatch: pytest.MonkeyPatch, under_way: str) -> None:
    """A thread that still closes a pipe would meet the end of the interpreter, which writes to that pipe."""
    monkeypatch.setattr(beside, "LIBRARY", "no such library")
    monkeypatch.setattr(beside, "free_cores", lambda: 2)
    before = set(enumerate_threads())
    with drawing_beside(PRODUCT) as made:
        number = pid(made)
        for _ in range({"a drawing": 1, "many drawings": 20}.get(under_way, 0)):
            made.begun("time:sleep", 60)
        if under_way == "its death":
            os.kill(number, signal.SIGKILL)
    assert set(enumerate_threads()) <= before
    assert not active_children()


@pytest.mark.thorough
def test_it_may_end_before_it_has_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where the design file is wrong: the second process is still starting."""
    monkeypatch.setattr(beside, "LIBRARY", "no such library")
    monkeypatch.setattr(beside, "free_cores", lambda: 2)
    before = set(enumerate_threads())
    with drawing_beside(PRODUCT):
        pass
    assert set(enumerate_threads()) <= before
    assert not active_children()


def test_without_a_second_free_core_this_process_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beside, "free_cores", lambda: 1)
    with drawing_beside(PRODUCT) as made:
        assert made is HERE
        assert made.begun(PRODUCT, [2, 2])() == 4


@pytest.mark.long
@pytest.mark.slow
def test_pictures_are_the_same_wherever_they_are_drawn(tmp_path: Any) -> None:
    """The same build by a process that has matplotlib already, and so draws by itself."""
    code = "import sys; {}sys.argv = ['ncgear', *sys.argv[1:]]; from ncgear.cli import main; main()"
    free = "from ncgear import workers; workers.free_cores = lambda: 2; "
    for name, before in (("beside", free), ("here", f"{free}import matplotlib; ")):
        line = [sys.executable, "-c", code.format(before), "build", "designs/baler.yaml", "--report"]
        subprocess.run([*line, "--out", str(tmp_path / name)], cwd=ROOT, check=True, capture_output=True)
    one, other = ({path.name: path.read_bytes() for path in (tmp_path / name).iterdir()} for name in ("beside", "here"))
    assert one.keys() == other.keys()
    # These two tell how long it took.
    assert {name for name in one if one[name] != other[name]} <= {"summary.json", "manifest.json"}
