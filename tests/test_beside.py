"""The second process that draws: the same pictures, its errors, its death, and what it cannot be asked."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from itertools import islice
from typing import Any

import pytest

from commands import ROOT
from ncgear.drawings import beside
from ncgear.drawings.beside import HERE, Drawer, drawing_beside

PRODUCT, FACTORIAL, RANGE = "math:prod", "math:factorial", "builtins:range"


@pytest.fixture
def drawer(monkeypatch: pytest.MonkeyPatch) -> Iterator[Drawer]:
    """A second process, whatever this one has loaded."""
    monkeypatch.setattr(beside, "LIBRARY", "no such library")
    monkeypatch.setattr(beside, "core_count", lambda: 2)
    with drawing_beside(PRODUCT) as made:
        assert made is not HERE
        yield made


def pid(made: Any) -> subprocess.Popen[bytes]:
    process: subprocess.Popen[bytes] = made._process
    return process


@pytest.mark.thorough
def test_drawings_come_from_the_second_process(drawer: Drawer) -> None:
    first, second = drawer.begun(PRODUCT, [2, 3]), drawer.begun("os:getpid")
    assert first() == 6
    assert second() == pid(drawer).pid
    assert list(drawer.each(RANGE, 4)) == [0, 1, 2, 3]


@pytest.mark.thorough
def test_its_errors_are_raised_here(drawer: Drawer) -> None:
    with pytest.raises(ValueError, match="negative"):
        drawer.begun(FACTORIAL, -1)()
    assert drawer.begun(PRODUCT, [5])() == 5


@pytest.mark.thorough
def test_where_it_dies_this_process_draws(drawer: Drawer) -> None:
    counted = drawer.each(RANGE, 10**6)
    assert list(islice(counted, 3)) == [0, 1, 2]
    pid(drawer).kill()
    assert list(islice(counted, 200_000))[-1] == 200_002
    assert drawer.begun(PRODUCT, [2, 5])() == 10


@pytest.mark.thorough
def test_what_cannot_be_pickled_is_drawn_here(drawer: Drawer) -> None:
    assert list(drawer.each("builtins:map", lambda value: value + 1, [1, 2])) == [2, 3]
    assert drawer.begun(PRODUCT, [7])() == 7


def test_it_ends_with_its_context(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever it still draws."""
    monkeypatch.setattr(beside, "LIBRARY", "no such library")
    monkeypatch.setattr(beside, "core_count", lambda: 2)
    with drawing_beside(PRODUCT) as made:
        process = pid(made)
        made.begun("time:sleep", 60)
    assert process.returncode is not None


def test_without_a_second_core_this_process_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beside, "core_count", lambda: 1)
    with drawing_beside(PRODUCT) as made:
        assert made is HERE
        assert made.begun(PRODUCT, [2, 2])() == 4


@pytest.mark.slow
def test_pictures_are_the_same_wherever_they_are_drawn(tmp_path: Any) -> None:
    """The same build by a process that has matplotlib already, and so draws by itself."""
    code = "import sys; {}sys.argv = ['ncgear', *sys.argv[1:]]; from ncgear.cli import main; main()"
    for name, before in (("beside", ""), ("here", "import matplotlib; ")):
        line = [sys.executable, "-c", code.format(before), "build", "designs/baler.yaml", "--report"]
        subprocess.run([*line, "--out", str(tmp_path / name)], cwd=ROOT, check=True, capture_output=True)
    one, other = ({path.name: path.read_bytes() for path in (tmp_path / name).iterdir()} for name in ("beside", "here"))
    assert one.keys() == other.keys()
    # These two tell how long it took.
    assert {name for name in one if one[name] != other[name]} <= {"summary.json", "manifest.json"}
