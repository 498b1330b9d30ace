"""A design file keeps every version of everybody: saves at the same time, editors, kills, read-only files, drafts."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from errno import EBUSY, EPERM
from pathlib import Path
from threading import Barrier
from types import SimpleNamespace
from typing import cast

import pytest

from conftest import Run
from disk import Disk, Fault, calls_of
from ncgear.cli.arguments import opened as opened_by_a_command
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.files import one_file
from ncgear.files.one_file import locked
from ncgear.files.publish import _new_staging, exchange, opened, real_place
from ncgear.studio import on_disk, server
from ncgear.studio.drafts import Draft, draft_left
from ncgear.studio.on_disk import NotSaved, design_on_disk, require_same_place
from ncgear.studio.open_page import OpenPage

OLD, OWN, THEIRS = "name: old\n", "name: own\n", "name: theirs\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    made = tmp_path / "d.yaml"
    made.write_text(OLD, encoding="utf-8")
    return made


@pytest.fixture
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """No waiting for programs that write late, nor for the disk."""
    monkeypatch.setattr(on_disk, "LATE_S", 0.0)
    monkeypatch.setattr(os, "fsync", lambda handle: None)


def names(path: Path) -> list[str]:
    return sorted(os.listdir(path.parent))


def test_a_file_is_saved_whole_and_not_over_others_work(path: Path, soon: None) -> None:
    path.chmod(0o660)
    link = path.with_name("link.yaml")
    link.symlink_to(path)
    saved = design_on_disk(link).saved(OWN)
    assert path.read_text(encoding="utf-8") == OWN
    assert (link.is_symlink(), path.stat().st_mode & 0o777) == (True, 0o660)
    path.write_text(THEIRS, encoding="utf-8")
    path.chmod(0o440)
    with pytest.raises(NotSaved, match=r"changed by another program.*read-only") as asked:
        saved.saved("name: again\n")
    path.chmod(0o660)
    assert asked.value.there.content == THEIRS.encode()
    assert path.read_text(encoding="utf-8") == THEIRS
    asked.value.there.saved("name: again\n")
    assert path.read_text(encoding="utf-8") == "name: again\n"
    assert names(path) == ["d.yaml", "link.yaml"]


@pytest.mark.parametrize("asked", ["_belong_as", "written_beside"])
def test_a_file_that_is_moved_away_in_the_midst_of_a_save_is_asked_about(
    path: Path, soon: None, monkeypatch: pytest.MonkeyPatch, asked: str
) -> None:
    own = getattr(on_disk, asked)

    def late(*given: object) -> object:
        path.rename(path.with_name("elsewhere.yaml"))
        return own(*given) if asked == "written_beside" else path.stat()

    monkeypatch.setattr(on_disk, asked, late)
    with pytest.raises(NotSaved, match="removed"):
        design_on_disk(path).saved(OWN)
    assert names(path) == ["elsewhere.yaml"]


@pytest.mark.parametrize(("number", "said"), [(EBUSY, "mounted by itself"), (EPERM, "cannot be written")])
def test_a_file_that_the_disk_does_not_exchange_is_named_and_nothing_is_left(
    path: Path, soon: None, monkeypatch: pytest.MonkeyPatch, number: int, said: str
) -> None:
    """A file that is a mount of its own, as containers have them, or one that may not be changed."""

    def swap(new: Path, place: Path) -> None:
        new.with_name(f"{new.name}.part").write_text("", encoding="utf-8")
        raise OSError(number, os.strerror(number), str(new))

    monkeypatch.setattr(on_disk, "swap", swap)
    with pytest.raises(WrongInput, match=said) as refused:
        design_on_disk(path).saved(OWN)
    assert str(refused.value.location) == str(path)
    assert names(path) == ["d.yaml"]
    assert path.read_text(encoding="utf-8") == OLD


@pytest.mark.parametrize("kind", ["another link", "a file", "nothing"])
def test_a_link_that_stands_for_another_file_by_now_is_asked_about(path: Path, kind: str) -> None:
    link, other = path.with_name("link.yaml"), path.with_name("other.yaml")
    link.symlink_to(path)
    opened = design_on_disk(link)
    require_same_place(opened, link)
    link.unlink()
    other.write_text(THEIRS, encoding="utf-8")
    if kind == "another link":
        link.symlink_to(other)
    elif kind == "a file":
        link.write_text(THEIRS, encoding="utf-8")
    with pytest.raises(NotSaved, match=f"another file.*, not {re.escape(str(path))}") as asked:
        require_same_place(opened, link)
    require_same_place(asked.value.there, link)
    assert asked.value.there.content == (None if kind == "nothing" else THEIRS.encode())
    asked.value.there.saved(OWN)
    assert link.read_text(encoding="utf-8") == OWN
    assert path.read_text(encoding="utf-8") == OLD


@pytest.mark.parametrize("save", range(5))
def test_of_saves_at_the_same_time_one_is_saved_and_the_other_is_told(path: Path, soon: None, save: int) -> None:
    opened_twice = [design_on_disk(path), design_on_disk(path)]
    begin = Barrier(2)

    def saved(number: int) -> str:
        begin.wait()
        try:
            return opened_twice[number].saved(f"name: of {number}\n").text
        except NotSaved as problem:
            return problem.problem

    with ThreadPoolExecutor(2) as both:
        said = sorted(both.map(saved, range(2)))
    assert said[0] == "has been changed by another program since it was opened"
    assert path.read_text(encoding="utf-8") == said[1]


def test_a_file_that_was_removed_is_not_made_again_unasked(path: Path, soon: None) -> None:
    file = design_on_disk(path)
    path.unlink()
    with pytest.raises(NotSaved, match="removed") as asked:
        file.saved(OWN)
    assert names(path) == []
    assert asked.value.there.saved(OWN).text == path.read_text(encoding="utf-8") == OWN


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with a name")
@pytest.mark.parametrize("make", [os.mkdir, getattr(os, "mkfifo", None)])
def test_what_is_no_file_is_neither_replaced_nor_waited_for(
    path: Path, soon: None, make: Callable[[Path], None]
) -> None:
    """A save would take it away, and a pipe to which nobody writes never ends."""
    file = design_on_disk(path)
    path.unlink()
    make(path)
    before = path.stat()
    with pytest.raises(WrongInput, match="is a folder, a device or a pipe, not a file"):
        file.saved(OWN, protected_too=True)
    with pytest.raises(WrongInput):
        design_on_disk(path)
    after = path.stat()
    assert (before.st_mode, before.st_ino) == (after.st_mode, after.st_ino)


@pytest.mark.parametrize("mode", [0o444, 0o400])
def test_a_read_only_file_is_saved_only_when_that_is_said(path: Path, soon: None, mode: int) -> None:
    path.chmod(mode)
    file = design_on_disk(path)
    with pytest.raises(NotSaved, match="read-only"):
        file.saved(OWN)
    assert path.read_text(encoding="utf-8") == OLD
    file.saved(OWN, protected_too=True)
    assert (path.read_text(encoding="utf-8"), path.stat().st_mode & 0o777) == (OWN, mode)


def test_a_hard_link_is_parted_only_when_that_is_said(path: Path, soon: None) -> None:
    """The other name keeps what it has, also after kills; a symbolic link goes on to lead to the file."""
    other, link = path.with_name("other.yaml"), path.with_name("link.yaml")
    os.link(path, other)
    link.symlink_to(other)
    file = design_on_disk(link)
    with pytest.raises(NotSaved, match=r"has another name, a hard link, which keeps the former text") as asked:
        file.saved(OWN)
    assert (asked.value.there.content, path.samefile(other)) == (OLD.encode(), True)
    path.chmod(0o444)
    with pytest.raises(NotSaved, match="is read-only and has another name"):
        file.saved(OWN)
    path.chmod(0o644)
    saved = file.saved(OWN, protected_too=True)
    assert [one.read_text(encoding="utf-8") for one in (path, other, link)] == [OLD, OWN, OWN]
    assert (link.is_symlink(), saved.saved(THEIRS).text) == (True, other.read_text(encoding="utf-8"))
    assert names(path) == ["d.yaml", "link.yaml", "other.yaml"]


@pytest.mark.parametrize("protected_too", [False, True])
def test_a_save_of_a_hard_link_that_is_killed_at_any_call_loses_neither_name(
    path: Path, soon: None, protected_too: bool
) -> None:
    def save() -> None:
        with suppress(NotSaved):
            design_on_disk(path).saved(OWN, protected_too=protected_too)

    other = path.with_name("other.yaml")
    os.link(path, other)
    calls, texts = len(calls_of(save)), set()
    for call in range(1, calls + 1):
        path.write_text(OLD, encoding="utf-8")
        other.unlink()
        os.link(path, other)
        with Disk(Fault.DEATH, call).used():
            save()
        found = design_on_disk(path)
        texts.add(found.text)
        assert (other.read_text(encoding="utf-8"), found.kept) == (OLD, ())
        found.saved("name: next\n", protected_too=True)
        assert names(path) == ["d.yaml", "other.yaml"]
    assert texts == ({OLD, OWN} if protected_too else {OLD})


def test_a_second_name_that_a_killed_run_has_left_is_no_hard_link(path: Path, soon: None) -> None:
    os.link(path, path.with_name(".d.yaml.part"))
    design_on_disk(path).saved(OWN)
    assert (path.read_text(encoding="utf-8"), names(path)) == (OWN, ["d.yaml"])


def test_a_design_that_cannot_be_saved_is_not_advised_another_folder(
    path: Path, soon: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    file = design_on_disk(path)
    monkeypatch.setattr(on_disk, "written_beside", full)
    with pytest.raises(WrongInput, match="No space left") as refused:
        file.saved(OWN)
    assert "--out" not in str(refused.value)
    assert "save again" in str(refused.value)
    assert path.read_text(encoding="utf-8") == OLD


def test_a_file_with_a_long_name_is_saved_and_has_a_draft(tmp_path: Path, soon: None) -> None:
    path = tmp_path / f"{'n' * 250}.yaml"
    path.write_text(OLD, encoding="utf-8")
    file = design_on_disk(path)
    draft = Draft(file, OLD)
    draft.follow(file, OWN)
    draft.let_go()
    assert file.saved(THEIRS).text == path.read_text(encoding="utf-8")
    found = draft_left(file)
    assert found is not None
    assert found.text == OWN
    found.let_go()


# --- editors, which know no lock


def in_place(path: Path) -> None:
    path.write_text(THEIRS, encoding="utf-8")


def by_move(path: Path) -> None:
    path.with_name("theirs").write_text(THEIRS, encoding="utf-8")
    path.with_name("theirs").replace(path)


@pytest.mark.parametrize("editor", [in_place, by_move])
@pytest.mark.parametrize("moment", ["sleep", "swap"])
def test_an_editor_that_writes_in_the_midst_of_a_save_loses_nothing(
    path: Path, soon: None, monkeypatch: pytest.MonkeyPatch, editor: Callable[[Path], None], moment: str
) -> None:
    """Just before the exchange, after the comparison; and right after the exchange."""
    really, written = getattr(on_disk, moment), list[bool]()

    def meanwhile(*arguments: object) -> None:
        if not written:
            editor(path)
        written.append(True)
        really(*arguments)

    monkeypatch.setattr(on_disk, moment, meanwhile)
    with pytest.raises(NotSaved, match="another program") as asked:
        design_on_disk(path).saved(OWN)
    assert asked.value.there.content == THEIRS.encode()
    assert path.read_text(encoding="utf-8") == THEIRS
    assert names(path) == ["d.yaml"]


def test_an_editor_that_had_the_file_open_before_a_save_loses_nothing(
    path: Path, soon: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    with path.open("r+", encoding="utf-8") as editor:

        def write(_: float) -> None:
            editor.write(THEIRS)
            editor.flush()

        monkeypatch.setattr(on_disk, "sleep", write)
        with pytest.raises(NotSaved):
            design_on_disk(path).saved(OWN)
    assert path.read_text(encoding="utf-8") == THEIRS


def test_without_an_exchange_at_one_instant_versions_change_places_too(
    path: Path, soon: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(one_file, "_exchanged", lambda one, other: False)
    design_on_disk(path).saved(OWN)
    assert (path.read_text(encoding="utf-8"), names(path)) == (OWN, ["d.yaml"])
    other = path.with_name("other")
    other.write_text(THEIRS, encoding="utf-8")
    one_file.swap(other, path)
    assert (path.read_text(encoding="utf-8"), other.read_text(encoding="utf-8")) == (THEIRS, OWN)


# --- kills


def test_a_save_that_is_killed_at_any_call_leaves_the_file_whole_and_the_next_one_clears_up(
    path: Path, soon: None
) -> None:
    calls = len(calls_of(design_on_disk(path).saved, OWN))
    texts = set()
    for call in range(1, calls + 1):
        path.write_text(OLD, encoding="utf-8")
        file = design_on_disk(path)
        with Disk(Fault.DEATH, call).used():
            file.saved(OWN)
        texts.add(path.read_text(encoding="utf-8"))
        assert not path.is_symlink()
        found = design_on_disk(path)
        found.saved("name: next\n")
        assert (path.read_text(encoding="utf-8"), found.kept, names(path)) == ("name: next\n", (), ["d.yaml"])
    assert texts == {OLD, OWN}


def killed_over(path: Path) -> None:
    """What a save leaves that is killed after it has taken a version of an editor away."""
    path.write_text(OWN, encoding="utf-8")
    digests = "-".join(on_disk._digest(text.encode()) for text in (OLD, OWN))
    path.with_name(f".{path.name}.{digests}{on_disk.SAVING}").write_text(THEIRS, encoding="utf-8")


def test_a_version_of_an_editor_that_a_killed_save_took_away_is_kept(
    path: Path, soon: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = design_on_disk(path)

    def killed(_: float) -> None:
        raise KeyboardInterrupt

    really = on_disk.swap

    def late(new: Path, place: Path) -> None:
        in_place(place)
        really(new, place)

    monkeypatch.setattr(on_disk, "swap", late)
    monkeypatch.setattr(on_disk, "sleep", killed)
    with pytest.raises(KeyboardInterrupt):
        file.saved(OWN)
    left = {one.name: one.read_bytes() for one in path.parent.iterdir()}
    found = design_on_disk(path)
    assert (found.text, found.kept) == (OWN, (path.with_name("d-kept.yaml"),))
    assert found.kept[0].read_text(encoding="utf-8") == THEIRS
    found.kept[0].unlink()
    killed_over(path)
    assert {one.name: one.read_bytes() for one in path.parent.iterdir()} == left


@pytest.mark.parametrize("fault", [Fault.NO_SPACE, Fault.BROKEN, Fault.BROKEN_FOR_GOOD])
def test_a_save_that_fails_at_any_call_tells_what_it_has_kept(path: Path, soon: None, fault: Fault) -> None:
    file, kept = design_on_disk(path), path.with_name("d-kept.yaml")

    def save() -> None:
        replace(file, content=OWN.encode()).saved("name: next\n")

    killed_over(path)
    calls, failed = len(calls_of(save)), 0
    for call in range(1, calls + 1):
        kept.unlink(missing_ok=True)
        killed_over(path)
        said = ""
        with Disk(fault, call).used():
            try:
                save()
            except WrongInput as error:
                said = str(error)
        failed += bool(said) and kept.exists()
        assert not said or kept.exists() == ("is kept as d-kept.yaml" in said), call
    assert failed > 3


def test_the_command_leaves_to_the_page_what_a_killed_save_has_left(
    path: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server, "serve", lambda *_: None)
    killed_over(path)
    assert run("studio", str(path), "--no-browser")[0] == 0
    assert design_on_disk(path).kept == (path.with_name("d-kept.yaml"),)


def test_an_opening_that_fails_tells_what_it_has_kept(path: Path, soon: None) -> None:
    killed_over(path)
    path.write_bytes(b"\xff")
    with pytest.raises(WrongInput, match=r"UTF-8.*is kept as d-kept\.yaml"):
        design_on_disk(path)


def test_a_link_that_a_killed_run_has_left_is_settled_and_never_followed(tmp_path: Path, soon: None) -> None:
    """The design is one of many files that a run exchanges; the run dies at each of its calls."""
    files = {name: {"d.yaml": f"name: {name}\n".encode(), "e.csv": name.encode()} for name in ("old", "new")}

    def run(folder: Path, which: str) -> None:
        with opened(folder):
            exchange(folder, files[which])

    run(tmp_path / "counted", "old")
    calls, linked = len(calls_of(run, tmp_path / "counted", "new")), 0
    for call in range(1, calls + 1, 3):
        folder = tmp_path / str(call)
        run(folder, "old")
        with Disk(Fault.DEATH, call).used():
            run(folder, "new")
        linked += (folder / "d.yaml").is_symlink()
        if call % 2:
            with suppress(NoSuchMechanism, WrongInput), opened_by_a_command(folder / "d.yaml"):
                pass
            assert not (folder / "d.yaml").is_symlink()
        found = design_on_disk(folder / "d.yaml")
        assert (found.path, found.path.is_symlink()) == (folder / "d.yaml", False)
        assert found.content in (files["old"]["d.yaml"], files["new"]["d.yaml"])
        found.saved(OWN)
        assert (folder / "d.yaml").read_text(encoding="utf-8") == OWN
    assert linked > 2


def test_a_staging_folder_is_no_place_for_a_design(tmp_path: Path) -> None:
    left = _new_staging(tmp_path)
    left.rmdir()
    (tmp_path / "d.yaml").symlink_to(left / "new" / "d.yaml")
    for place in (tmp_path / "d.yaml", left / "new" / "d.yaml"):
        with pytest.raises(WrongInput, match="give the file itself"):
            real_place(place)


def test_one_file_alone_is_exchanged_without_links(tmp_path: Path, soon: None) -> None:
    with opened(tmp_path):
        assert "symlink" not in calls_of(exchange, tmp_path, {"a.txt": b"a"})
        assert "symlink" in calls_of(exchange, tmp_path, {"a.txt": b"b", "b.txt": b"b"})
    assert names(tmp_path / "x") == ["a.txt", "b.txt"]


def test_a_free_place_is_taken_once(tmp_path: Path) -> None:
    one_file.put_at_free_place(tmp_path / "a", b"first")
    with pytest.raises(FileExistsError):
        one_file.put_at_free_place(tmp_path / "a", b"second")
    assert ((tmp_path / "a").read_bytes(), names(tmp_path / "a")) == (b"first", ["a"])


# --- what is not saved


def test_a_draft_is_there_until_it_is_saved_or_undone(path: Path, soon: None) -> None:
    file = design_on_disk(path)
    draft = Draft(file, file.text)
    draft.follow(file, OWN)
    assert draft_left(file) is None, "its studio runs"
    assert len(names(path)) == 2
    draft.follow(file, OLD)
    assert names(path) == ["d.yaml"]
    draft.follow(file, OWN)
    draft.follow(file.saved(OWN), OWN)
    assert names(path) == ["d.yaml"]


def test_each_time_that_no_draft_can_be_written_is_told_once(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Once for a stretch of edits, and again when the disk is full for a second time."""
    file, full = design_on_disk(path), [False]

    def write(*_: object) -> None:
        if full[0]:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(Draft, "_write", write)
    page = SimpleNamespace(file=file, draft=Draft(file, file.text), _draft_refused=False)
    told = []
    for number, is_full in enumerate((True, True, False, True)):
        full[0] = is_full
        told.append(bool(OpenPage._draft_problem(cast(OpenPage, page), f"{OWN}# {number}")))
    assert told == [True, False, False, True]


def test_a_draft_of_a_studio_that_has_ended_is_found_with_the_file_that_it_was_of(path: Path) -> None:
    file = design_on_disk(path)
    for text in ("name: first\n", "name: second\n"):
        draft = Draft(file, file.text)
        draft.follow(file, OWN)
        draft.follow(file, text)
        os.utime(draft._place, (1.0, len(text)))
        draft.let_go()
    in_place(path)
    found = draft_left(design_on_disk(path))
    assert found is not None
    assert (found.text, found.file.text) == ("name: second\n", OLD)
    with pytest.raises(NotSaved):
        found.file.saved(found.text)
    other = draft_left(file)
    assert other is not None
    assert other.text == "name: first\n"
    assert draft_left(file) is None
    found.let_go(), other.let_go()


def test_a_draft_that_was_saved_or_is_none_is_not_taken(path: Path) -> None:
    file = design_on_disk(path)
    draft = Draft(file, file.text)
    draft.follow(file, OWN)
    draft.let_go()
    path.write_text(OWN, encoding="utf-8")
    assert draft_left(design_on_disk(path)) is None
    assert names(path) == ["d.yaml"]
    path.with_name(".d.yaml.unsaved-0.part").write_bytes(b"{")
    assert draft_left(file) is None
    assert names(path) == ["d.yaml"]
    for number, content in enumerate((b"", b"[]", b'{"file": 1, "text": 2}', b'{"file": "a"}')):
        path.with_name(f".d.yaml.unsaved-{number}").write_bytes(content)
    assert draft_left(file) is None


def test_a_lock_is_held_by_one(path: Path) -> None:
    with path.open("rb") as one, path.open("rb") as other:
        assert locked(one.fileno(), wait=False)
        assert not locked(other.fileno(), wait=False)
        one.close()
        assert locked(other.fileno(), wait=False)


@pytest.mark.skipif(not hasattr(os, "setxattr") or os.geteuid() != 0, reason="only root gives files away")
def test_a_saved_file_belongs_to_whom_it_belonged(path: Path, soon: None) -> None:
    os.chown(path, 1000, 1000)
    os.utime(path, (1.0, 1.0))
    with suppress(OSError):
        # Not every file system has attributes.
        os.setxattr(path, "user.kept", b"yes")
    before, attributes = path.stat(), os.listxattr(path)
    design_on_disk(path).saved("name: again\n")
    after = path.stat()
    assert (after.st_uid, after.st_gid, after.st_mode) == (1000, 1000, before.st_mode)
    assert after.st_mtime > 1e9
    assert os.listxattr(path) == attributes
