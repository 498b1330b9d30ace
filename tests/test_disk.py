"""Faults of the disk and death at every call of the file system: the old files are whole, or the new ones are."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from disk import Disk, Fault, calls_of, leftovers
from killed_runs import seen
from ncgear.errors import WrongInput
from ncgear.files.manifest import MANIFEST, publish_run

MINE = {"notes.txt": b"not of ncgear", "stage-1/photo.jpg": b"nor this", "pair.glb": b"nor this one"}
EARLIER = {
    "law.csv": b"earlier law",
    "driven.stl": bytes(range(256)) * 300,
    "stage-1/pitch.csv": b"one",
    "gone.dxf": b"-",
}
LATER = {
    "law.csv": b"later law",
    "driven.stl": bytes(range(255, -1, -1)) * 400,
    "stage-2/pitch.csv": b"2",
    "pair.glb": b"p",
}


def filled(folder: Path) -> Path:
    """A folder with an earlier build, in which a person has files of their own."""
    publish_run(folder, EARLIER, "build")
    for name, content in MINE.items():
        (folder / name).write_bytes(content)
    return folder


def without_manifest(folder: Path) -> dict[str, bytes]:
    return {name: content for name, content in seen(folder).items() if name != MANIFEST}


BEFORE = {**EARLIER, **MINE}
AFTER = {**MINE, **LATER, "pair-kept.glb": MINE["pair.glb"]}


def steps(place: Path, every: int) -> range:
    """The calls at which something goes wrong, a few more than a run makes, because faults bring calls of their own."""
    calls = calls_of(publish_run, filled(place / "counted"), LATER, "build")
    assert Counter(calls)["fsync"] > len(LATER)
    return range(1, len(calls) + 4 * every, every)


def struck(folder: Path, fault: Fault, at: int) -> bool:
    """Whether a fault at a call has struck a run; checks that what is there is whole, and mended by the next run."""
    said, ended = "", False
    with Disk(fault, at).used() as disk:
        try:
            publish_run(folder, LATER, "build")
            ended = True
        except WrongInput as refusal:
            said = refusal.problem
    found, where = without_manifest(folder), f"{fault} at call {at} of {len(disk.calls)}"
    if ended or "the new files are in place" in said:
        assert found == AFTER, where
    elif disk.dead:
        assert found in (BEFORE, AFTER), where
    else:
        assert "cannot be written" in said, where
        assert found == BEFORE, where
    if ended:
        assert leftovers(folder) == [], where
    # The next run has a sound disk.
    publish_run(folder, LATER, "build")
    assert without_manifest(folder) == AFTER, where
    assert leftovers(folder) == [], where
    return disk.struck


ALL = [
    pytest.param(1, marks=[pytest.mark.slow, pytest.mark.attack], id="all"),
    pytest.param(17, id="some", marks=pytest.mark.thorough),
]


MEMORY = Path("/dev/shm")


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder in memory, if there is one: which call goes wrong counts, not how long this machine's disk takes."""
    monkeypatch.setattr(os, "fsync", lambda handle: None)
    with TemporaryDirectory(prefix="ncgear-", dir=MEMORY if os.access(MEMORY, os.W_OK) else tmp_path) as name:
        yield Path(name)


@pytest.mark.tiers(slow=["half of a write is written-all"], rest="long")
@pytest.mark.parametrize("every", ALL)
@pytest.mark.parametrize("fault", Fault)
def test_a_fault_at_any_call_leaves_one_build_whole(place: Path, fault: Fault, every: int) -> None:
    hits = [struck(filled(place / str(step)), fault, step) for step in steps(place, every)]
    assert any(hits) or (every > 1 and "write" in fault)
