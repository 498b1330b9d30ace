"""The studio as a process of its own, and the requests and messages that tests send to it."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection, connect

from commands import environment
from ncgear.cli.run import BY_SIGNAL, LAST_WORDS
from ncgear.studio.worker import CHAINS


@dataclass
class Studio:
    """A running studio of a file; files are made in the folder ``out``."""

    process: Any
    path: Path
    out: Path
    address: str

    @property
    def port(self) -> int:
        return int(self.address.split(":")[2].split("/")[0])

    @property
    def token(self) -> str:
        return self.address.rstrip("/").rpartition("/")[2]

    @property
    def cookie(self) -> str:
        """The cookie with which a browser that has been at the address comes back."""
        return f"ncgear-{self.port}={self.token}"

    def get(self, path: str, **headers: str) -> tuple[int, Mapping[str, str], bytes]:
        """Status, headers and content that answer a request with the studio's cookie and the headers that are given."""
        with closing(HTTPConnection("127.0.0.1", self.port, timeout=20)) as made:
            made.putrequest("GET", path, skip_host="Host" in headers)
            for name, value in {"Cookie": self.cookie, **headers}.items():
                made.putheader(name, value)
            made.endheaders()
            answer = made.getresponse()
            return answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read()

    def post(self, path: str, body: str, **headers: str) -> tuple[int, Mapping[str, str], bytes]:
        """The same of a form that is sent."""
        with closing(HTTPConnection("127.0.0.1", self.port, timeout=20)) as made:
            made.request(
                "POST",
                path,
                body,
                {"Content-Type": "application/x-www-form-urlencoded", "Cookie": self.cookie, **headers},
            )
            answer = made.getresponse()
            return answer.status, {name.lower(): value for name, value in answer.getheaders()}, answer.read()

    @contextmanager
    def page(self, name: str = "test", **more: Any) -> Iterator[Page]:
        """A page's conversation."""
        origin = more.pop("origin", f"http://127.0.0.1:{self.port}")
        given = {"Cookie": more.pop("cookie", self.cookie)}
        place = f"ws://127.0.0.1:{self.port}/talk?page={name}"
        with connect(place, origin=origin, additional_headers=given, max_size=None, **more) as socket:
            yield Page(socket)

    @property
    def workers(self) -> list[int]:
        """The processes that the studio has started and that still run."""
        return children(self.process.pid)


@dataclass
class Page:
    """The messages of a page, and those that it has been sent."""

    socket: ClientConnection

    def send(self, do: str, **more: Any) -> None:
        self.socket.send(json.dumps({"do": do, **more}))

    def hear(self, timeout: float = 90.0) -> dict[str, Any]:
        message: dict[str, Any] = json.loads(self.socket.recv(timeout))
        return message

    def until(self, *kinds: str, timeout: float = 90.0) -> dict[str, Any]:
        """The next message of one of some kinds."""
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            message = self.hear(end - time.monotonic())
            if message["is"] in kinds:
                return message
        raise TimeoutError(kinds)

    def settled(self, number: int) -> list[dict[str, Any]]:
        """All messages until all chains have answered all of a text."""
        heard, done = [], set()
        while done != set(CHAINS):
            heard.append(self.hear())
            if heard[-1]["is"] == "done" and heard[-1]["n"] == number:
                done.add(heard[-1]["from"])
        return heard


def children(process: int) -> list[int]:
    """Processes that run as children of another, or in its group, without those that are only not waited for."""
    listed = subprocess.run(["ps", "-eo", "pid,ppid,stat,args"], capture_output=True, text=True, check=True).stdout
    rows = [line.split(None, 3) for line in listed.splitlines()[1:]]
    return [int(row[0]) for row in rows if int(row[1]) == process and not row[2].startswith("Z")]


@contextmanager
def running(path: Path | None, out: Path) -> Iterator[Studio]:
    """A studio that is ended by Ctrl-C; it must end by itself then, and say nothing of a fault."""
    opened = [] if path is None else [str(path)]
    command = [sys.executable, "-m", "ncgear", "studio", *opened, "--no-browser", f"--out={out}"]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=out.parent, env=environment()
    )
    assert process.stdout is not None
    assert process.stderr is not None
    said = process.stdout.readline()
    found = re.search(r"http://\S+", said)
    assert found, said + process.stderr.read()
    try:
        yield Studio(process, path or out.parent, out, found[0])
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        try:
            _, errors = process.communicate(timeout=30)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
    ended = process.returncode, errors
    by_signal = [(BY_SIGNAL + number, f"{LAST_WORDS}\n") for number in (signal.SIGTERM, signal.SIGHUP)]
    assert ended in ((0, ""), (-signal.SIGKILL, ""), *by_signal), ended


def is_running(process: int) -> bool:
    """Whether a process runs; one that has ended and is only not waited for does not."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    stat = Path(f"/proc/{process}/stat")
    return not (stat.exists() and stat.read_text().rpartition(")")[2].split()[0] == "Z")
