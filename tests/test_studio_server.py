"""The studio's server as a process: who may talk to it, what it answers, and what is left when it is gone."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import webbrowser
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import psutil
import pytest
import uvicorn
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.exceptions import InvalidState, InvalidStatus
from websockets.protocol import State

from commands import environment, fresh
from drives import DESIGNS
from ncgear.studio import chains
from ncgear.studio.chains import AnswerProcess, chains_by_process
from ncgear.studio.open_page import OpenPage, _files_of
from ncgear.studio.server import Conversation, open_in_browser
from studios import Studio, children, is_running, running

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    folder = tmp_path_factory.mktemp("studio")
    path = folder / "ellipse.yaml"
    shutil.copy(DESIGNS / "ellipse.yaml", path)
    (folder / "export" / "one").mkdir(parents=True)
    (folder / "export" / "one" / "a.txt").write_text("a file", encoding="utf-8")
    (folder / "export" / "one" / ".hidden").write_text("secret", encoding="utf-8")
    (folder / "export" / "out.txt").symlink_to(path)
    (folder / "secret.txt").write_text("secret", encoding="utf-8")
    with running(path, folder / "export") as made:
        yield made


# --- who may talk to it


def test_the_page_is_there_for_whoever_has_the_address(studio: Studio) -> None:
    status, headers, content = studio.get("/")
    policy = headers["content-security-policy"]
    assert status == 200
    assert "default-src 'none'" in policy
    assert "unsafe-eval" not in policy
    assert "script-src 'sha256-" in policy
    assert headers["referrer-policy"] == "no-referrer"
    assert b"ncgear studio" in content


@pytest.mark.tiers(slow=["/TOKEN"], rest="long")
@pytest.mark.parametrize("path", ["/", "/talk", "/x/", "/TOKEN", "//TOKEN/", "/export/one/a.txt", f"/{'0' * 32}/"])
def test_without_the_token_there_is_nothing(studio: Studio, path: str) -> None:
    other = studio.token[:-1] + ("-" if studio.token.endswith("_") else "_")
    assert studio.get(path.replace("TOKEN", other), Cookie=f"ncgear-{studio.port}={other}")[0] == 403


def test_the_address_gives_a_cookie_that_no_script_reads_and_no_other_site_uses(studio: Studio) -> None:
    status, headers, content = studio.get(f"/{studio.token}/", Cookie="")
    given, *rest = headers["set-cookie"].split("; ")
    assert (status, given) == (200, studio.cookie)
    assert {"HttpOnly", "SameSite=strict"} <= set(rest)
    assert b'content="0;url=/"' in content
    assert studio.get("/", Cookie="")[0] == 403
    assert studio.get("/", Cookie=given)[0] == 200


def test_a_browser_is_led_by_a_file_that_only_its_owner_reads(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its name is all that stands on the command line of the browser."""
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    open_in_browser("http://127.0.0.1:1/the-token/")
    file = Path(opened[0].removeprefix("file://"))
    assert opened == [file.as_uri()]
    assert "the-token" not in opened[0]
    assert file.stat().st_mode & 0o777 == 0o600
    assert 'content="0;url=http://127.0.0.1:1/the-token/"' in file.read_text(encoding="utf-8")
    file.unlink()


@pytest.mark.tiers(slow=["localhost:1"], rest="long")
@pytest.mark.parametrize("host", ["example.org", "127.0.0.1", "localhost:1", "127.0.0.1.example.org:PORT", ""])
def test_another_host_name_is_refused(studio: Studio, host: str) -> None:
    """A page of another site whose name leads to this computer sends that name."""
    given = host.replace("PORT", str(studio.port))
    assert studio.get("/", Host=given)[0] in (400, 403)
    assert studio.get("/", Host=f"localhost:{studio.port}")[0] == 200


@pytest.mark.tiers(slow=["None"], rest="long")
@pytest.mark.parametrize("origin", ["http://example.org", "null", None, "https://127.0.0.1:PORT", "http://127.0.0.1:1"])
def test_another_page_cannot_talk(studio: Studio, origin: str | None) -> None:
    given = None if origin is None else origin.replace("PORT", str(studio.port))
    with pytest.raises(InvalidStatus), studio.page(origin=given):
        pass


def test_a_wrong_token_cannot_talk(studio: Studio) -> None:
    with pytest.raises(InvalidStatus), studio.page(cookie=f"ncgear-{studio.port}={'0' * 32}"):
        pass


def test_other_computers_cannot_reach_it(studio: Studio) -> None:
    """It listens on the loopback address alone."""
    own = socket.gethostbyname(socket.gethostname())
    if own.startswith("127."):
        listed = Path("/proc/net/tcp")
        if not listed.exists():
            pytest.skip("this computer has no other address")
        rows = [line.split()[1] for line in listed.read_text().splitlines()[1:]]
        assert [row for row in rows if row.endswith(f":{studio.port:04X}")] == [f"0100007F:{studio.port:04X}"] * sum(
            row.endswith(f":{studio.port:04X}") for row in rows
        )
        return
    with pytest.raises(OSError), socket.create_connection((own, studio.port), timeout=2):  # noqa: PT011
        pass


def test_files_of_the_export_folder_alone_are_shown(studio: Studio) -> None:
    status, headers, content = studio.get("/export/one/a.txt")
    assert (status, content) == (200, b"a file")
    assert headers["content-security-policy"].startswith("sandbox")
    for path in ("../secret.txt", "%2e%2e/secret.txt", "one/.hidden", "..%2f..%2fetc/passwd", "out.txt", "one", ""):
        assert studio.get(f"/export/{path}")[0] in (403, 404), path


# --- what it answers


def test_a_page_hears_all_parts_and_then_of_a_change(studio: Studio) -> None:
    with studio.page("parts") as page:
        state = page.until("state")
        assert state["content"]["saved"]
        heard = page.settled(state["n"])
        assert {"motion", "figures", "chart", "scene", "teeth", "verdict"} <= {one["is"] for one in heard}
        page.send("change", changes={"operation.speed_rpm": 77})
        asked = page.until("asked")
        figures = next(one for one in page.settled(asked["n"]) if one["is"] == "figures")
        assert ["speed", "77 r/min"] in figures["content"]["facts"]
        page.send("keep")
        assert "+operation: {speed_rpm: 77}" in page.until("state")["content"]["difference"]
    with studio.page("parts") as page:
        assert "speed_rpm: 77" in page.until("state")["content"]["text"]
        page.send("undo")
        assert page.until("state")["content"]["saved"]


def test_a_page_without_a_name_is_told_so(studio: Studio) -> None:
    with studio.page("") as page:
        assert "page" in (said := page.until("said")["content"])
        assert "are open" not in said


def test_pages_do_not_share_what_is_edited(studio: Studio) -> None:
    with studio.page("one") as one, studio.page("two") as two:
        one.until("state"), two.until("state")
        one.send("set", changes={"operation.speed_rpm": 11})
        assert "speed_rpm: 11" in one.until("state")["content"]["text"]
        two.send("redo")
        assert "speed_rpm: 11" not in two.until("state")["content"]["text"]
        one.send("undo")
        assert one.until("state")["content"]["saved"]


@pytest.mark.tiers(slow=["message7"], rest="long")
@pytest.mark.parametrize(
    "message",
    [
        {},
        {"do": "no_such"},
        {"do": "set"},
        {"do": "set", "changes": {}},
        {"do": "set", "changes": {f"k{i}": 1 for i in range(300)}},
        {"do": "set", "changes": {"motion.law": "__import__"}},
        {"do": "set", "changes": {"name.x": 1}},
        {"do": "text", "text": 5},
        {"do": "text", "text": "x" * 1_100_000},
        {"do": "run", "command": "sh -c true"},
        {"do": "run", "command": None},
        {"do": "cancel", "job": 99},
        {"do": "adopt", "job": "../x"},
        {"do": "point", "power_w": "many"},
    ],
)
def test_messages_that_ask_for_nonsense_are_told_so(studio: Studio, message: dict[str, object]) -> None:
    with studio.page(f"nonsense{hash(str(message))}") as page:
        saved = page.until("state")["content"]["saved"]
        page.socket.send(json.dumps(message))
        said = page.until("said")["content"]
        assert said
        assert "None" not in said or "do" in message
        page.send("redo")
        assert page.until("state")["content"]["saved"] == saved


LONE_SURROGATE = '"\\ud800"'
NO_MESSAGES = [
    b"\x00\xff",
    b'{"do": "undo"}',
    "",
    "{",
    "[]",
    "5",
    '{"do": NaN}',
    "[" * 5000,
    '{"do": "change", "changes": {"operation.speed_rpm": 1e400}}',
    f'{{"do": "change", "changes": {{"operation.speed_rpm": {"9" * 4000}}}}}',
    f'{{"do": "set", "changes": {{"description": {LONE_SURROGATE}}}}}',
    f'{{"do": "text", "text": {LONE_SURROGATE}}}',
    f'{{"do": {LONE_SURROGATE}}}',
]


def test_what_is_no_message_is_told_and_the_conversation_goes_on(studio: Studio) -> None:
    with studio.page("noise") as page:
        saved = page.until("state")["content"]["saved"]
        for data in NO_MESSAGES:
            page.socket.send(data)
            # A page may first be told of a draft that an earlier studio left.
            while "here again" in (said := page.until("said")["content"]):
                pass
            assert "message" in said, data
        page.send("redo")
        assert page.until("state")["content"]["saved"] == saved


@pytest.mark.parametrize(
    "text",
    ["motion: {law: []}\n", "linkage: {kind: {}}\n", "motion: {law: {a: 1}}\ngears: [1]\n", "1: 2\n", "- a\n", "x"],
)
def test_texts_of_any_form_are_told_their_fault(studio: Studio, text: str) -> None:
    with studio.page(f"form{hash(text)}") as page:
        before = page.until("state")["content"]["text"]
        page.send("text", text=text)
        assert page.until("state")["content"]["text"] == text
        assert "internal fault" not in page.until("refused")["content"]["problem"]
        page.send("undo")
        assert page.until("state")["content"]["text"] == before


def test_names_that_no_file_can_have_are_not_found(studio: Studio) -> None:
    for name in ("x" * 300, "x" * 5000, "a%00b", "%ff"):
        assert studio.get(f"/export/{name}")[0] == 404, name


def test_a_design_that_has_become_a_folder_is_told(tmp_path: Path) -> None:
    path = tmp_path / "ellipse.yaml"
    shutil.copy(DESIGNS / "ellipse.yaml", path)
    with running(path, tmp_path / "export") as studio, studio.page() as page:
        page.until("state")
        page.send("set", changes={"operation.speed_rpm": 88})
        page.until("state")
        path.unlink()
        path.mkdir()
        page.send("save", over=True)
        assert "ellipse.yaml" in page.until("said")["content"]
        assert "speed_rpm: 88" in page.until("state")["content"]["text"]
        with studio.page("other") as other:
            assert "is a folder" in other.until("said")["content"]


def test_a_design_that_is_no_yaml_is_shown_with_its_fault(studio: Studio) -> None:
    with studio.page("broken") as page:
        page.until("state")
        page.send("text", text="name: [1, 2\n")
        state = page.until("state")
        assert state["content"]["form"] is None
        assert "not YAML" in page.until("refused")["content"]["problem"]
        page.send("set", changes={"name": "x"})
        assert "mend the text" in page.until("said")["content"]
        page.send("undo")
        while not page.until("state")["content"]["saved"]:
            pass


def test_a_file_that_has_gone_is_said_to_a_new_page(tmp_path: Path) -> None:
    path = tmp_path / "ellipse.yaml"
    shutil.copy(DESIGNS / "ellipse.yaml", path)
    with running(path, tmp_path / "export") as studio:
        path.unlink()
        with studio.page() as page:
            assert "cannot be read" in page.until("said")["content"]
        shutil.copy(DESIGNS / "ellipse.yaml", path)
        with studio.page() as page:
            assert page.until("state")["content"]["saved"]


# --- what is left of it


def test_a_page_that_is_closed_leaves_no_process(studio: Studio) -> None:
    with studio.page("closed") as page:
        page.settled(page.until("state")["n"])
        end = time.monotonic() + 20
        # Those of pages of other tests may still be on their way out.
        while len(before := studio.workers) != len(chains_by_process()):
            assert time.monotonic() < end, before
    wait_until_gone(before)


def test_a_page_that_is_loaded_anew_leaves_no_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It connects while its last connection still ends, which takes long here, and it follows what is dragged."""
    ended, path, told = AnswerProcess.close, tmp_path / "ellipse.yaml", list[str]()
    shutil.copy(DESIGNS / "ellipse.yaml", path)

    async def ended_late(process: AnswerProcess) -> None:
        await ended(process)
        await asyncio.sleep(1.0)

    async def send(text: str) -> None:
        told.append(text)

    async def load_anew() -> list[int]:
        page = OpenPage(path, tmp_path / "export")
        await page.connected(send)
        await asyncio.gather(page.disconnected(send), page.connected(send))
        told.clear()
        await page.hear(json.dumps({"do": "change", "changes": {"operation.speed_rpm": 55}}))
        while not any('"is": "asked"' in one for one in told):
            await asyncio.sleep(0.05)
        # Not the processes of other tests, nor the one that lists them.
        begun = [one for one in children(os.getpid()) if is_running(one) and one not in before]
        await page.closed()
        return begun

    monkeypatch.setattr(AnswerProcess, "close", ended_late)
    before = children(os.getpid())
    begun = asyncio.run(asyncio.wait_for(load_anew(), 60.0))
    assert len(begun) == len(chains_by_process())
    wait_until_gone(begun)


def wait_until_gone(processes: list[int]) -> None:
    end = time.monotonic() + 20
    while any(map(is_running, processes)):
        assert time.monotonic() < end, processes
        time.sleep(0.05)


@pytest.mark.slow
def test_a_server_that_is_killed_leaves_the_file_whole_and_no_process(tmp_path: Path) -> None:
    path = tmp_path / "ellipse.yaml"
    shutil.copy(DESIGNS / "ellipse.yaml", path)
    before = path.read_text(encoding="utf-8")
    with running(path, tmp_path / "export") as studio, studio.page() as page:
        page.until("motion")
        processes = children(studio.process.pid)
        assert len(processes) == len(chains_by_process())
        page.send("set", changes={"operation.speed_rpm": 88})
        page.send("save")
        time.sleep(0.05)
        studio.process.send_signal(signal.SIGKILL)
        studio.process.wait()
        assert path.read_text(encoding="utf-8") in (before, before.replace("speed_rpm: 90", "speed_rpm: 88"))
        wait_until_gone(processes)


@pytest.mark.slow
def test_ctrl_c_ends_it_and_its_commands(tmp_path: Path) -> None:
    path = tmp_path / "ellipse.yaml"
    shutil.copy(DESIGNS / "ellipse.yaml", path)
    with running(path, tmp_path / "export") as studio:
        with studio.page() as page:
            page.until("state")
            page.send("run", command="animate")
            end = time.monotonic() + 60.0
            while not any("animate" in psutil.Process(one).cmdline() for one in children(studio.process.pid)):
                assert time.monotonic() < end
                time.sleep(0.02)
            processes = children(studio.process.pid)
        studio.process.send_signal(signal.SIGINT)
        # An impatient hand ends it no other way.
        time.sleep(0.05)
        studio.process.send_signal(signal.SIGINT)
        assert studio.process.wait(30) == 0
        wait_until_gone(processes)


@pytest.mark.parametrize("kind", [Conversation, WebSocketsSansIOProtocol])
def test_the_end_of_the_server_while_a_page_closes_is_no_fault(kind: type[WebSocketsSansIOProtocol]) -> None:
    """The page's word that it closes is there, the answer is not yet sent; uvicorn alone raises then."""

    async def ended() -> bool:
        config = uvicorn.Config(MagicMock(), ws=kind, log_config=None)
        server = uvicorn.Server(config)
        talk = kind(config, server.server_state, {})
        transport = MagicMock(**{"get_extra_info.return_value": None})
        talk.connection_made(transport)
        talk.handshake_complete = True
        talk.conn.state = State.CLOSING
        talk.shutdown()
        return bool(transport.close.called)

    if kind is Conversation:
        assert asyncio.run(ended())
    else:
        with pytest.raises(InvalidState):
            asyncio.run(ended())


@pytest.mark.slow
def test_a_command_writes_what_the_command_line_writes(studio: Studio, tmp_path: Path) -> None:
    with studio.page("made") as page:
        page.until("state")
        page.send("set", changes={"operation.speed_rpm": 95})
        page.send("run", command="report")
        while (job := page.until("job"))["content"]["running"]:
            pass
        assert job["content"]["done"], job
        assert "ellipse/report.html" in job["content"]["files"]
        page.send("undo")
        page.until("state")
    text = (DESIGNS / "ellipse.yaml").read_text(encoding="utf-8")
    other = tmp_path / "ellipse.yaml"
    other.write_text(text.replace("speed_rpm: 90", "speed_rpm: 95"), encoding="utf-8")
    done = fresh("report", str(other), f"--out={tmp_path / 'out'}")
    assert done.returncode == 0, done.stderr
    made = (studio.out / "ellipse" / "report.html").read_bytes()
    assert made == (tmp_path / "out" / "report.html").read_bytes()


@pytest.mark.slow
def test_a_second_command_into_the_same_folder_is_refused_and_names_the_first(studio: Studio) -> None:
    with studio.page("first") as page, studio.page("second") as other:
        page.until("state"), other.until("state")
        page.send("run", command="build")
        job = page.until("job")["content"]
        assert {"build", "report", "animate"} == set(job["alike"])
        for asking, command in ((page, "build"), (other, "build"), (other, "report")):
            asking.send("run", command=command)
            said = asking.until("said")["content"]
            assert "Build all files runs already and writes into ellipse" in said
            assert [one["job"] for one in asking.until("state")["content"]["jobs"]] == ([1] if asking is page else [])
        page.send("cancel", job=job["job"])
        while page.until("job")["content"]["running"]:
            pass


def test_what_is_hidden_is_no_file_that_was_made(tmp_path: Path) -> None:
    folder = tmp_path / "pusher"
    for name in ("a.csv", ".hidden", ".ncgear-1/new/b.csv", "shown/c.stl"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    assert _files_of(folder, tmp_path) == ["pusher/a.csv", "pusher/shown/c.stl"]


@pytest.mark.slow
def test_a_command_is_cancelled(studio: Studio) -> None:
    with studio.page("cancelled") as page:
        page.until("state")
        page.send("run", command="build")
        job = page.until("job")["content"]["job"]
        page.send("cancel", job=job)
        while (heard := page.until("job")["content"])["running"]:
            pass
        assert heard["cancelled"]


# --- the processes that compute


def test_a_computation_that_takes_too_long_is_ended_and_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chains, "LONGEST_S", 0.05)
    heard: list[dict[str, Any]] = []

    async def told(line: str) -> None:
        heard.append(json.loads(line))

    async def asked() -> None:
        chain = AnswerProcess(("gears",), told)
        await chain.ask(1, (DESIGNS / "baler.yaml").read_text(encoding="utf-8"), {}, "d.yaml")
        process = chain._process
        assert process is not None
        while not heard:
            await asyncio.sleep(0.01)
        assert await process.wait() != 0
        monkeypatch.setattr(chains, "LONGEST_S", 60.0)
        await chain.ask(2, (DESIGNS / "uniform-crank.yaml").read_text(encoding="utf-8"), {}, "d.yaml")
        while heard[-1]["is"] != "done":
            await asyncio.sleep(0.01)
        await chain.close()

    asyncio.run(asked())
    assert (heard[0]["is"], heard[0]["n"]) == ("refused", 1)
    assert "without an answer" in heard[0]["content"]["problem"]
    assert {one["n"] for one in heard[1:]} == {2}


def test_the_newest_request_is_answered_and_older_ones_are_broken_off() -> None:
    text = (DESIGNS / "ellipse.yaml").read_text(encoding="utf-8")
    command = [sys.executable, "-m", "ncgear.studio.worker", "motion"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, text=True, env=environment(), **pipes) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        for number in range(120):
            changes = {"operation.speed_rpm": 20 + number}
            request = {"n": number, "changes": changes, "path": "d.yaml"} | ({} if number else {"text": text})
            process.stdin.write(json.dumps(request) + "\n")
            process.stdin.flush()
        heard = []
        while not heard or (heard[-1]["is"], heard[-1]["n"]) != ("done", 119):
            heard.append(json.loads(process.stdout.readline()))
        process.stdin.close()
        assert process.wait(20) == 0
    numbers = [one["n"] for one in heard]
    assert numbers == sorted(numbers)
    assert len(set(numbers)) < 60
    figures = [one for one in heard if one["is"] == "figures"]
    assert ["speed", "139 r/min"] in figures[-1]["content"]["facts"]


def test_chains_of_one_process_show_a_request_in_both_while_newer_ones_come() -> None:
    """Requests that come from the gears' picture on wait for the strength; the last one then gets all."""
    text = (DESIGNS / "pusher.yaml").read_text(encoding="utf-8")
    # Where cores are busy, a picture takes longer than the worker's patience, and the hand seems to rest.
    patient = "from ncgear.studio import worker; worker.PATIENCE_S = worker.RESTING_S = 100.0; worker.main()"
    command = [sys.executable, "-c", patient, "gears", "contact"]
    with subprocess.Popen(
        command, text=True, env=environment(), stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        # What never comes is no reason to wait for ever.
        watch = threading.Timer(120.0, process.kill)
        watch.start()
        asked, over = [0], threading.Event()

        def ask(number: int) -> None:
            assert process.stdin is not None
            changes = {"motion.theta2_pi": 0.5 + number / 1e5}
            process.stdin.write(json.dumps({"n": number, "changes": changes, "path": "d.yaml", "text": text}) + "\n")
            process.stdin.flush()

        def move() -> None:
            while not over.wait(0.02):
                asked.append(asked[-1] + 1)
                ask(asked[-1])

        def heard_until(kind: str, number: int) -> list[tuple[str, str, int]]:
            assert process.stdout is not None
            heard: list[tuple[str, str, int]] = []
            while not heard or heard[-1][0::2] != (kind, number):
                one = json.loads(process.stdout.readline())
                heard.append((one["is"], one["from"], one["n"]))
            return heard

        hand = threading.Thread(target=move)
        ask(0)
        try:
            heard_until("scene", 0)
            hand.start()
            assert {number for _, _, number in heard_until("strength", 0)} == {0}
        finally:
            over.set()
        hand.join()
        kinds = [(kind, chain) for kind, chain, number in heard_until("verdict", asked[-1]) if number == asked[-1]]
        assert kinds[:3] == [("scene", "gears"), ("scene", "gears"), ("done", "gears")]
        assert ("strength", "contact") in kinds
        assert process.stdin is not None
        process.stdin.close()
        assert process.wait(20) == 0
        watch.cancel()


@pytest.mark.tiers(slow=["arguments1-is a folder"], rest="long")
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["missing.yaml"], "ncgear new missing"),
        (["."], "is a folder"),
        ([str(DESIGNS / "ellipse.yaml"), "--port={}"], "--port"),
    ],
)
def test_what_cannot_be_opened_is_refused(arguments: list[str], said: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        done = fresh("studio", "--no-browser", *(one.replace("{}", port) for one in arguments))
    assert done.returncode == 2
    assert said in done.stderr


# --- a studio without a file


def test_a_studio_without_a_file_asks_what_to_begin_with_and_opens_it(tmp_path: Path) -> None:
    with running(None, tmp_path / "export") as studio:
        status, headers, content = studio.get("/")
        assert status == 200
        assert "form-action 'self'" in headers["content-security-policy"]
        # Without its origin a browser's form is one of another page.
        assert headers["referrer-policy"] == "same-origin"
        assert all(one in content for one in (b"A machine", b"A wish", b"A shape", b"A formula", b"A worked design"))
        other = {"Origin": "http://example.org"}
        assert studio.post("/begin", "begin=a-machine/pump", **other)[0] == 403
        assert b"one of the choices" in studio.post("/begin", "begin=x/../y")[2]
        assert list(tmp_path.glob("*.yaml")) == []
        status, headers, _ = studio.post("/begin", "begin=a-machine%2Fpump")
        assert (status, headers["location"]) == (303, "./")
        assert [path.name for path in tmp_path.glob("*.yaml")] == ["pump.yaml"]
        assert b"pump.yaml" in studio.get("/")[2]
        with studio.page() as page:
            assert page.until("state")["content"]["file"] == "pump.yaml"


def test_a_zip_is_of_one_folder_that_was_made(studio: Studio) -> None:
    status, headers, content = studio.get("/zip/one")
    assert (status, content[:2]) == (200, b"PK")
    assert "one.zip" in headers["content-disposition"]
    for wrong in ("no-such", "..", ".hidden", "%2e%2e", "out.txt"):
        assert studio.get(f"/zip/{wrong}")[0] == 404
