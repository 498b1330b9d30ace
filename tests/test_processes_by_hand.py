"""Commands and the studio, piece by piece without a process of their own: signals, places, answers, patience."""

from __future__ import annotations

import asyncio
import io
import json
import os
import signal
import threading
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from at_once import at_once
from ncgear.cli import arguments, machine, mending, progress, run, study, train
from ncgear.errors import NoSuchMechanism, Unanswered, WrongInput
from ncgear.files import publish
from ncgear.studio import chains, jobs, page, server, worker
from ncgear.studio.worker import CONTACT, GEARS, MOTION

Made: Any = SimpleNamespace


class Stopped(Exception):
    """The part of a function that a test looks at has run."""


# --- commands


@pytest.mark.judges("cli")
@at_once(
    ("samples", "right"),
    [(1000, 1024), (3000, 4096), (4097, 8192), (1, study.FEWEST), (0, study.FEWEST), (10**9, study.MOST)],
)
def test_the_power_of_two_above_a_number_of_assemblies_is_offered(samples: int, right: int) -> None:
    with pytest.raises(WrongInput) as refused:
        study.tolerance(Path("x.yaml"), samples=samples)
    assert refused.value.problem.endswith(f"; {right} is right")


@pytest.mark.judges("cli")
def test_powers_of_two_within_both_ends_are_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    def opened(*_: Any, **__: Any) -> Any:
        raise Stopped

    monkeypatch.setattr(arguments, "opened", opened)
    for samples in (study.FEWEST, 4096, study.MOST):
        with pytest.raises(Stopped):
            study.tolerance(Path("x.yaml"), samples=samples)
    for samples in (study.FEWEST // 2, 2 * study.MOST):
        with pytest.raises(WrongInput):
            study.tolerance(Path("x.yaml"), samples=samples)


@pytest.mark.judges("cli")
@at_once(
    ("refusal", "of_curve"),
    [
        (NoSuchMechanism("x", key="gears.teeth"), True),
        (NoSuchMechanism("x", key="gears.least_contact_ratio"), True),
        (NoSuchMechanism("x", key="motion.outline"), True),
        (NoSuchMechanism("x", key="motion"), True),
        (NoSuchMechanism("x", key="gears.helix"), False),
        (NoSuchMechanism("x", key="linkage.motion"), False),
        (Unanswered("x", key="gears.teeth"), False),
    ],
)
def test_a_curve_is_refused_by_its_law_or_by_the_teeth_on_it(refusal: NoSuchMechanism, of_curve: bool) -> None:
    assert arguments._is_of_curve(refusal) is of_curve


@pytest.mark.judges("cli")
def test_files_go_below_the_folder_of_exports_unless_a_place_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Path] = []

    def prepare(path: Path) -> None:
        asked.append(path)
        raise Stopped

    monkeypatch.setattr(publish, "prepare", prepare)
    monkeypatch.setattr(publish, "prepare_file", prepare)
    monkeypatch.setattr("ncgear.design.reading.design_file.load_train", lambda _: Made(file=Made(name="lift")))
    monkeypatch.setattr(
        arguments, "opened", lambda _: __import__("contextlib").nullcontext(Made(design=Made(name="pump")))
    )
    form: Any = (10, 1.0, 100)
    for out in (None, Path("elsewhere")):
        for begin in (
            lambda out=out: arguments.prepared(out, "pump-x"),
            lambda out=out: train.animated_train(Path("x.yaml"), out, Made(), form),
            lambda out=out: machine._animated_machine(Path("x.yaml"), out, Made(), form),
        ):
            with pytest.raises(Stopped):
                begin()
    export = arguments.EXPORT
    assert asked[:3] == [export / "pump-x", export / "lift" / "train.gif", export / "pump" / "mechanism.gif"]
    assert asked[3:] == [Path("elsewhere")] * 3


@pytest.mark.judges("cli")
def test_a_run_that_is_ended_by_a_signal_says_so_with_its_status(monkeypatch: pytest.MonkeyPatch) -> None:
    """143 is the status of a process that SIGTERM ends; a run that had ended well before keeps its status."""
    said: list[str] = []
    for name in ("open_streams", "collect_rarely"):
        monkeypatch.setattr(run, name, lambda: None)
    monkeypatch.setattr(run, "_say", said.append)
    monkeypatch.setattr("sys.unraisablehook", None)

    def leave(status: int) -> None:
        raise SystemExit(1000 + status)

    monkeypatch.setattr(run, "_leave", leave)
    for came, own, status, words in (
        (0, (0, ""), 0, []),
        (0, (3, "wrong"), 3, ["wrong"]),
        (int(signal.SIGTERM), (1, "broken"), 1000 + 143, [run.LAST_WORDS]),
        (int(signal.SIGTERM), (0, ""), 1000, []),
    ):
        said.clear()
        monkeypatch.setattr(run, "_End", lambda came=came: Made(came=came, ignore=lambda: None))
        monkeypatch.setattr(run, "_run", lambda own=own: own)
        with pytest.raises(SystemExit) as ended:
            run.main()
        assert (ended.value.code, said) == (status, words)


@pytest.mark.judges("cli")
def test_what_nohup_has_begun_does_not_hear_that_its_terminal_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Handlers are set for Ctrl-C and where a signal has its default; one that is ignored stays so."""
    kept = dict.fromkeys(run.ENDING, signal.SIG_DFL)
    kept[signal.SIGINT] = signal.default_int_handler  # type: ignore[assignment]
    ignored = next(number for number in run.ENDING if number != signal.SIGINT)
    kept[ignored] = signal.SIG_IGN  # type: ignore[assignment]
    heard: list[int] = []
    monkeypatch.setattr(signal, "getsignal", kept.__getitem__)
    monkeypatch.setattr(signal, "signal", lambda number, handler: heard.append(number))
    run._End()
    assert set(heard) == set(run.ENDING) - {ignored}


@pytest.mark.judges("cli")
@at_once(
    ("error", "status", "said"),
    [
        (ImportError(f"x: {run.NOT_LOADED[0]}"), run.WRONG_INPUT, "install what it needs"),
        (ImportError("no module x"), run.FAULT, "ncgear: "),
        (OSError(28, "No space left", "a.stl"), run.WRONG_INPUT, "a.stl: No space left"),
        (SystemExit(run.INTERRUPTED), run.INTERRUPTED, run.LAST_WORDS),
        (SystemExit(2), 2, ""),
        (KeyboardInterrupt(), run.INTERRUPTED, run.LAST_WORDS),
    ],
)
def test_each_end_of_a_run_has_its_status(error: BaseException, status: int, said: str) -> None:
    def app() -> None:
        raise error

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ncgear.cli.app.app", app)
        found, words = run._run()
    assert found == status
    assert words == said if not said or said == run.LAST_WORDS else said in words


@pytest.mark.judges("cli")
def test_help_is_searched_where_the_teeth_are_refused_for_the_same_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    found: list[Any] = []
    monkeypatch.setattr("ncgear.project.mending.refusal_of_teeth", lambda _: found[-1])
    monkeypatch.setattr("ncgear.project.mending.searched", lambda *_: "search")
    error = NoSuchMechanism("x", key="gears.teeth")
    for refusal, searched in (
        (NoSuchMechanism("y", key="gears.teeth"), "search"),
        (NoSuchMechanism("y", key="gears.helix"), None),
        (Unanswered("y", key="gears.teeth"), None),
        (None, None),
    ):
        found.append(refusal)
        assert mending._search(Made(), error) == searched


@pytest.mark.judges("cli")
def test_steps_are_counted_from_nothing_done() -> None:
    told: list[Any] = []
    steps = progress.Steps(Made(update=lambda *given: told.append(given)), 3)
    steps("law")
    steps("gears")
    steps.within("half")
    assert told == [("law", 0, 3), ("gears", 1, 3), ("gears, half", 1, 3)]


# --- studio


@pytest.mark.judges("studio")
@pytest.mark.parametrize(("cores", "processes"), [(1, 2), (2, 2), (3, 3)])
def test_a_third_process_follows_where_a_third_core_is_free(
    cores: int, processes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(chains, "core_count", lambda: cores)
    found = chains.chains_by_process()
    assert len(found) == processes
    assert sorted(chain for chains_ in found for chain in chains_) == sorted([MOTION, GEARS, CONTACT])


@pytest.mark.judges("studio")
def test_chains_are_owed_until_they_are_done_with_the_last_question() -> None:
    told: list[str] = []

    async def tell(line: str) -> None:
        told.append(line)

    def done(number: int, chain: str) -> bytes:
        return json.dumps({"is": "done", "n": number, "from": chain}, separators=(",", ":")).encode() + b"\n"

    lines = [done(6, GEARS), b'{"is":"chart"}\n', done(7, GEARS), b""]

    async def readline() -> bytes:
        return lines.pop(0)

    asked = chains.AnswerProcess((GEARS, CONTACT), tell)
    asked._asked, asked._open = 7, (GEARS, CONTACT)
    asyncio.run(asked._listen(Made(stdout=Made(readline=readline))))
    assert asked._open == (CONTACT,)
    assert len(told) == 3


@pytest.mark.judges("studio")
def test_a_command_writes_its_file_or_folder_in_a_session_of_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[Any] = []

    async def begin(*line: str, **how: Any) -> Any:
        begun.append((line, how))
        raise Stopped

    monkeypatch.setattr(asyncio, "create_subprocess_exec", begin)
    monkeypatch.setattr(jobs, "_copied", lambda *_: tmp_path / "copy.yaml")
    for name, command in jobs.COMMANDS.items():
        job = jobs.Job(1, name, "", "pump", tmp_path, lambda _: None)
        with pytest.raises(Stopped):
            asyncio.run(job.run(tmp_path, tmp_path / "x.yaml"))
        line, how = begun[-1]
        wanted = tmp_path / command.file if command.file else tmp_path
        assert line[-1] == f"--out={wanted}"
        assert how["start_new_session"] is (os.name == "posix")


@pytest.mark.judges("studio")
def test_a_command_is_interrupted_first_and_killed_with_all_its_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    sent: list[Any] = []
    monkeypatch.setattr(os, "killpg", lambda *given: sent.append(given))
    monkeypatch.setattr(jobs, "GRACE_S", 0.0)

    async def wait() -> int:
        await asyncio.sleep(0.0 if sent[-1][1] == signal.SIGKILL else 0.01)
        return 9

    job = jobs.Job(1, next(iter(jobs.COMMANDS)), "", "pump", Path(), lambda _: None)
    job._process = Made(returncode=None, pid=12345, wait=wait)
    assert asyncio.run(job._stopped()) == 9
    assert sent == [(12345, signal.SIGINT), (12345, signal.SIGKILL)]
    job._process.returncode = 1
    job._kill()
    assert (asyncio.run(job._stopped()), len(sent)) == (0, 2)


@pytest.mark.judges("studio")
def test_a_new_design_gets_the_first_name_that_is_free(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = Made(key="k", name="press", text=lambda name: f"name: {name}\n")
    monkeypatch.setattr(page, "beginnings", lambda: [Made(key="other"), chosen])
    names = [page.begin("k", tmp_path).name for _ in range(3)]
    assert names == ["press.yaml", "press-2.yaml", "press-3.yaml"]
    assert (tmp_path / "press-2.yaml").read_text() == "name: press-2\n"
    with pytest.raises(WrongInput):
        page.begin("none", tmp_path)


@pytest.mark.judges("studio")
def test_files_below_the_exports_are_given_out_unless_they_are_hidden(tmp_path: Path) -> None:
    (tmp_path / "out" / "pump" / ".kept").mkdir(parents=True)
    (tmp_path / "else").mkdir()
    (tmp_path / "out" / "away").symlink_to(tmp_path / "else")
    studio: Any = Made(out=tmp_path / "out")
    found = [
        asyncio.run(server.Studio._made(studio, name)) for name in ("pump", "pump/.kept", "away", "none", "..", ".")
    ]
    assert found == [tmp_path / "out" / "pump", *[None] * 5]


@pytest.mark.judges("studio")
def test_a_page_without_a_name_and_one_too_many_are_sent_away() -> None:
    told: list[Any] = []

    async def nothing(*_: Any, **__: Any) -> None:
        return None

    async def said(text: str) -> None:
        told.append(json.loads(text)["content"])

    def page_of(name: str) -> Any:
        raise ValueError(f"opened {name}")

    socket: Any = Made(query_params={}, accept=nothing, send_text=said, close=nothing)
    some = {str(number): None for number in range(server.MOST_PAGES)}
    for path, name, pages in (
        (Path("x"), "", {}),
        (None, "a", {}),
        (Path("x"), "a", some),
        (Path("x"), "3", some),
        (Path("x"), "a", dict(list(some.items())[1:])),
    ):
        socket.query_params = {"page": name}
        asyncio.run(server.Studio.talk(Made(path=path, open=pages, page_of=page_of), socket))
    assert ["without a name" in one for one in told] == [True, True, False, False, False]
    assert ["pages are open" in one for one in told] == [False, False, True, False, False]


@pytest.mark.judges("studio")
def test_answers_go_on_until_they_are_done_or_a_newer_request_waits_for_pictures(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    chain, others = GEARS, ("one", "two")
    pictures = worker.PICTURES[chain]

    def names(newer: bool, is_last: bool = True, fault: bool = False) -> tuple[list[str], int]:
        shown: list[int] = []
        requests: Any = Made(newer=newer, computing=False, shown=lambda: shown.append(1))

        def found() -> Any:
            yield others[0], {}
            if fault:
                yield others[0], {"x": float("nan")}
            yield pictures, {}
            yield others[1], {}

        out = io.BytesIO()
        worker._answer(requests, out, (chain, 5, is_last), found())
        told = [json.loads(line) for line in out.getvalue().splitlines()]
        assert {one["n"] for one in told} == {5}
        assert requests.computing is False
        return [one["is"] for one in told], len(shown)

    assert names(False) == ([others[0], pictures, others[1], worker.DONE[0]], 1)
    assert names(True) == ([others[0], pictures], 1)
    assert names(False, is_last=False) == ([others[0], pictures, others[1], worker.DONE[0]], 0)
    assert names(False, fault=True) == ([others[0], "refused", worker.DONE[0]], 0)


@pytest.mark.judges("studio")
def test_each_chain_has_its_answers() -> None:
    from ncgear.studio.gear_answers import contact_answers, gear_answers
    from ncgear.studio.motion_answers import motion_answers

    assert [worker.answers_of(chain) for chain in (MOTION, GEARS, CONTACT)] == [
        motion_answers,
        gear_answers,
        contact_answers,
    ]


@pytest.mark.judges("studio")
def test_a_newer_request_waits_as_long_as_the_older_one_may_take(monkeypatch: pytest.MonkeyPatch) -> None:
    """Until its pictures are due, or the newer one has rested; never where the older one was broken off before."""
    clock = Made(now=100.0)
    woken: list[float] = []
    monkeypatch.setattr(worker.time, "monotonic", lambda: clock.now)
    monkeypatch.setattr(worker.Requests, "_wake", lambda self, wait_s: woken.append(wait_s))

    def read(requests: worker.Requests, number: int) -> None:
        requests._lines = io.BytesIO(json.dumps({"n": number, "text": "a"}).encode() + b"\n")
        requests.read_all()

    requests = worker.Requests(io.BytesIO())
    read(requests, 1)
    assert requests.next()["n"] == 1
    assert requests._due_s == min(100.0 + worker.PATIENCE_S, 100.0 + worker.RESTING_S)
    clock.now = 100.1
    woken.clear()
    read(requests, 2)
    assert woken == [pytest.approx(min(worker.PATIENCE_S - 0.1, worker.RESTING_S))]
    requests.interrupt(2, None)
    assert len(woken) == 1
    clock.now = requests._due_s
    requests.interrupt(2, None)
    assert woken[1:] == [worker.AGAIN_S]
    requests.computing = True
    with pytest.raises(worker.Superseded):
        requests.interrupt(2, None)
    requests.next()
    assert requests._due_s == inf
    woken.clear()
    read(requests, 3)
    assert woken == []
    requests.next()
    requests.shown()
    assert requests._patient_until_s == 0.0
    assert not requests.newer
    read(requests, 4)
    assert requests.newer
    assert woken[-1] == 0.0


@pytest.mark.judges("studio")
@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 0), (signal.SIGTERM, 143)])
def test_a_studio_remembers_the_first_signal_that_ends_it(
    number: signal.Signals, status: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    left: list[int] = []
    handlers: dict[int, Any] = {}
    monkeypatch.setattr(signal, "signal", handlers.__setitem__)
    monkeypatch.setattr(signal, "setitimer", lambda *_: None)
    monkeypatch.setattr(server.uvicorn.Server, "handle_exit", lambda self, sig, frame: left.append(sig))
    monkeypatch.setattr(os, "_exit", left.append)
    ended = object.__new__(server._Server)
    ended.handle_exit(number, None)
    ended.handle_exit(signal.SIGTERM, None)
    assert (ended.ended_by, left) == (number, [number])
    handlers[signal.SIGALRM]()
    assert left == [number, status]
    assert threading.current_thread() is threading.main_thread()
