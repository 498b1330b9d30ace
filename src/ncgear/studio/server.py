"""The server of the studio: for this computer only, and only for a browser that has its token.

Every request must name the server's own host; a page of another site, brought here by its name server, does not.  A web
socket must come from the studio's own page, and every request needs the token.  An address has the token once, and
gives it to the browser as a cookie, which no script can read and no page of another site can use.  The server reads and
writes only the opened design file, hidden files and dropped drawings beside it, and the export folder.
"""

from __future__ import annotations

import asyncio
import atexit
import json
import os
import secrets
import signal
import socket
import tempfile
import webbrowser
from collections.abc import Awaitable, Callable, MutableMapping
from contextlib import asynccontextmanager, suppress
from html import escape
from io import BytesIO
from pathlib import Path
from types import FrameType
from typing import Any
from urllib.parse import parse_qs, quote
from zipfile import ZIP_DEFLATED, ZipFile

import uvicorn
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import FileResponse, HTMLResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.exceptions import InvalidState

from ncgear.errors import DesignError, WrongInput
from ncgear.files.publish import real_place
from ncgear.studio.chains import Chains
from ncgear.studio.messages import words_of
from ncgear.studio.open_page import OpenPage
from ncgear.studio.page import begin, page, start_page

HOST = "127.0.0.1"
"""The loopback address; other computers cannot reach it."""

TOKEN_BYTES = 24

MOST_PAGES = 6
"""Most pages that are open at once; each has two processes."""

MOST_REMEMBERED = 30
"""Most pages that are remembered, so that a page that is loaded again continues where it was."""

TAKEN_OVER = 4001
"""Code that ends the connection of a page when another connection has taken it over; the page does not reconnect."""

LARGEST_MESSAGE = 2 << 20
"""Most bytes of a message from a page: a text of a megabyte, escaped."""

LARGEST_DRAWING = 20 << 20
"""Most bytes of a dropped drawing: a picture of many pixels."""

LONGEST_CHOICE = 1000
"""Most bytes of the answer of the first page."""

SANDBOX = "sandbox allow-scripts; frame-ancestors 'none'"
"""Files of the export folder are shown like files of another site: none of their scripts reaches the studio."""

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]


class Guard:
    """Lets a request through that names this host, comes from this page, and has the token; others get 403 or 404."""

    def __init__(self, app: Any, hosts: frozenset[str], token: str) -> None:
        self.app, self.hosts, self.token = app, hosts, token
        # A browser sends cookies to all ports of their host: so the name has the port.
        self.cookie = f"ncgear-{min(hosts).rpartition(':')[2]}"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer or refuse one request."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        problem = self._problem(scope)
        if problem is None and scope["path"] == f"/{self.token}/":
            # A page that leads to the studio: a cookie that is set in a redirect would not be sent at once.
            never_told_on = {"referrer-policy": "no-referrer", "cache-control": "no-store"}
            entered = HTMLResponse(leading_to("/"), headers=never_told_on)
            entered.set_cookie(self.cookie, self.token, httponly=True, samesite="strict")
            await entered(scope, receive, send)
        elif problem is None:
            await self.app(scope, receive, send)
        elif scope["type"] == "websocket":
            await WebSocket(scope, receive, send).close(code=1008)
        else:
            await PlainTextResponse(problem, status_code=403)(scope, receive, send)

    def _problem(self, scope: Scope) -> str | None:
        headers = [(name.decode("latin-1"), value.decode("latin-1")) for name, value in scope["headers"]]
        hosts = [value for name, value in headers if name == "host"]
        origins = [value for name, value in headers if name == "origin"]
        if len(hosts) != 1 or hosts[0] not in self.hosts:
            return "this server answers to its own address only"
        if any(origin.removeprefix("http://") not in self.hosts for origin in origins):
            return "asked by another page"
        if scope["type"] == "websocket" and not origins:
            return "asked by no page"
        cookies = HTTPConnection(scope).cookies
        given = scope["path"].strip("/"), cookies.get(self.cookie, "")
        known = any(secrets.compare_digest(token.encode(), self.token.encode()) for token in given)
        return None if known else "the address lacks its token; the studio has said it where it was started"


class Conversation(WebSocketsSansIOProtocol):
    """A web socket that can be ended while the page is ending it."""

    def shutdown(self) -> None:
        """End the connection with the server; if the page has begun to close it, no message is sent."""
        try:
            super().shutdown()
        except InvalidState:
            self.transport.close()


class Studio:
    """All pages of one design; without a path the first page offers beginnings."""

    def __init__(self, path: Path | None, out: Path) -> None:
        self.path, self.out = path, out.absolute()
        self.pages: dict[str, OpenPage] = {}
        self.open: dict[str, WebSocket] = {}
        self.ready = Chains()

    def page_of(self, name: str) -> OpenPage:
        """A page by the name that it has chosen; the oldest closed pages are forgotten."""
        assert self.path is not None
        if name not in self.pages:
            closed = [page for page in self.pages if page not in self.open]
            for old in closed[: max(len(self.pages) - MOST_REMEMBERED + 1, 0)]:
                self.pages.pop(old).draft.let_go()
            # The processes of the first page load their modules while the browser starts.
            self.pages[name] = OpenPage(self.path, self.out, self.ready)
            self.ready = Chains()
        return self.pages[name]

    async def index(self, request: Request) -> Response:
        """The page."""
        return self._begun_with() if self.path is None else self._shown(*page(self.path.name), "no-referrer")

    async def begin(self, request: Request) -> Response:
        """Make the choice of the first page the design, unless another page has chosen already."""
        chosen = parse_qs((await request.body())[:LONGEST_CHOICE].decode(errors="replace")).get("begin", [""])[0]
        if self.path is None:
            try:
                self.path = await asyncio.to_thread(begin, chosen, Path.cwd())
            except DesignError as error:
                return self._begun_with(str(error))
        return RedirectResponse("./", status_code=303)

    def _begun_with(self, problem: str = "") -> Response:
        # The form's own address must be sent with it, or the guard would refuse it as from another page.
        return self._shown(*start_page(str(Path.cwd()), problem), "same-origin")

    def _shown(self, content: str, policy: str, referrer: str) -> Response:
        headers = {
            "content-security-policy": policy,
            "referrer-policy": referrer,
            "cache-control": "no-store",
            "x-content-type-options": "nosniff",
        }
        return Response(content, media_type="text/html", headers=headers)

    async def file(self, request: Request) -> Response:
        """A file of the export folder."""
        place = await self._made(request.path_params["name"])
        if place is None or not place.is_file():
            return PlainTextResponse("no such file", status_code=404)
        headers = {"content-security-policy": SANDBOX, "x-content-type-options": "nosniff", "cache-control": "no-store"}
        return FileResponse(place, headers=headers)

    async def drop(self, request: Request) -> Response:
        """Make a dropped drawing the pitch curve of a page; faults in it are told."""
        page, name = (request.query_params.get(key, "") for key in ("page", "name"))
        if page not in self.open:
            return PlainTextResponse("no such page", status_code=404)
        content = bytearray()
        async for part in request.stream():
            content += part
            if len(content) > LARGEST_DRAWING:
                return PlainTextResponse(f"{name} is larger than {LARGEST_DRAWING >> 20} MB", status_code=413)
        try:
            await self.pages[page].dropped(name, bytes(content))
        except DesignError as error:
            return PlainTextResponse(words_of(error), status_code=400)
        return PlainTextResponse("")

    async def zip(self, request: Request) -> Response:
        """A folder of the export folder as one zip."""
        place = await self._made(request.path_params["name"])
        if place is None or not place.is_dir():
            return PlainTextResponse("no such folder", status_code=404)
        headers = {
            "content-disposition": f"attachment; filename*=UTF-8''{quote(place.name)}.zip",
            "cache-control": "no-store",
        }
        return Response(await asyncio.to_thread(zipped, place), media_type="application/zip", headers=headers)

    async def _made(self, name: str) -> Path | None:
        """The path of a name in the export folder; None for a name that is hidden, elsewhere, or not there."""
        root = self.out.resolve()
        try:
            place = await asyncio.to_thread(real_place, self.out / name)
            inside = place.exists() and root in place.parents
        except (WrongInput, OSError, ValueError):
            return None
        hidden = inside and any(part.startswith(".") for part in place.relative_to(root).parts)
        return place if inside and not hidden else None

    async def talk(self, socket: WebSocket) -> None:
        """The conversation with one page."""
        name = socket.query_params.get("page", "")[:64] if self.path is not None else ""
        await socket.accept()
        if not name or (name not in self.open and len(self.open) >= MOST_PAGES):
            problem = f"{MOST_PAGES} pages are open; close one" if name else "a page without a name; load it anew"
            await socket.send_text(json.dumps({"is": "said", "content": problem}))
            await socket.close(code=1013)
            return
        try:
            opened = self.page_of(name)
        except Exception as error:
            # The file has been removed since the studio was started, or is a folder.
            await socket.send_text(json.dumps({"is": "said", "content": words_of(error)}))
            await socket.close(code=1011)
            return
        former, self.open[name] = self.open.get(name), socket
        sending = asyncio.Lock()

        async def send(text: str) -> None:
            with suppress(RuntimeError, WebSocketDisconnect):
                async with sending:
                    await socket.send_text(text)

        try:
            await opened.connected(send)
            if former is not None:
                # A page that is loaded again may connect before its earlier connection has ended.
                with suppress(RuntimeError, WebSocketDisconnect):
                    await former.close(code=TAKEN_OVER)
            while (data := await _data_from(socket)) is not None:
                await opened.hear(data)
        finally:
            if self.open.get(name) is socket:
                del self.open[name]
            await opened.disconnected(send)

    async def close(self) -> None:
        """End all processes."""
        await asyncio.gather(self.ready.close(), *(page.closed() for page in self.pages.values()))


async def _data_from(socket: WebSocket) -> str | bytes | None:
    """The content of the next frame of a page; None once the page is gone, which starlette tells in two ways."""
    try:
        frame = await socket.receive()
    except RuntimeError:
        return None
    text: str | None = frame.get("text")
    return frame.get("bytes") if text is None else text


async def _told(_: Request, error: Exception) -> Response:
    """An answer with any fault in words."""
    return PlainTextResponse(words_of(error), status_code=500)


def application(studio: Studio, hosts: frozenset[str], token: str) -> Guard:
    """The whole application behind its guard."""

    @asynccontextmanager
    async def lifespan(_: Starlette) -> Any:
        await studio.ready.start()
        yield
        await studio.close()

    routes = [
        Route("/", studio.index),
        Route("/begin", studio.begin, methods=["POST"]),
        Route("/drop", studio.drop, methods=["POST"]),
        Route("/export/{name:path}", studio.file),
        Route("/zip/{name}", studio.zip),
        WebSocketRoute("/talk", studio.talk),
    ]
    faults = {Exception: _told}
    return Guard(Starlette(routes=routes, lifespan=lifespan, exception_handlers=faults), hosts, token)


def listening(port: int) -> socket.socket:
    """A socket on the loopback address; port 0 takes any free port.  Raises OSError where the port is taken."""
    made = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind((HOST, port))
    except OSError:
        made.close()
        raise
    return made


def serve(path: Path | None, out: Path, bound: socket.socket, begun: Callable[[str], None]) -> None:
    """Serve a design, or a design chosen first, until Ctrl-C; ``begun`` is called with the address once it answers."""
    port, token = bound.getsockname()[1], secrets.token_urlsafe(TOKEN_BYTES)
    hosts = frozenset({f"{HOST}:{port}", f"localhost:{port}"})
    config = uvicorn.Config(
        application(Studio(path, out), hosts, token),
        log_level="error",
        access_log=False,
        ws=Conversation,
        ws_max_size=LARGEST_MESSAGE,
        # On one computer, compressing a message takes longer than sending it.
        ws_per_message_deflate=False,
        server_header=False,
        timeout_graceful_shutdown=2,
    )
    server = _Server(config)
    hears_of_its_terminal = hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN
    if hears_of_its_terminal:
        # A closed terminal ends it as Ctrl-C does; uvicorn handles the other signals.
        before = signal.signal(signal.SIGHUP, server.handle_exit)

    async def run() -> None:
        serving = asyncio.create_task(server.serve(sockets=[bound]))
        while not server.started and not serving.done():
            await asyncio.sleep(0.01)
        if server.started:
            begun(f"http://{HOST}:{port}/{token}/")
        await serving

    try:
        asyncio.run(run())
    except KeyboardInterrupt:
        # Ctrl-C is the usual way to end it, not a fault.
        if server.ended_by not in (0, signal.SIGINT):
            raise
    if hears_of_its_terminal:
        signal.signal(signal.SIGHUP, before)
        if server.ended_by == signal.SIGHUP:
            signal.raise_signal(signal.SIGHUP)


LAST_SECONDS = 10.0
"""Time after the signal that ends a server, two seconds of it for its conversations, at which waiting stops."""


class _Server(uvicorn.Server):
    """A server that remembers the signal that ended it."""

    ended_by = 0

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """End within two seconds of the first signal; a second signal would only cut off the messages about the end."""
        if not self.ended_by:
            self.ended_by = sig
            if hasattr(signal, "setitimer"):
                # A thread that waits for a process that is gone would keep this process running for ever.
                status = 0 if sig == signal.SIGINT else 128 + sig
                signal.signal(signal.SIGALRM, lambda *_: os._exit(status))
                signal.setitimer(signal.ITIMER_REAL, LAST_SECONDS)
            super().handle_exit(sig, frame)


def zipped(folder: Path) -> bytes:
    """The files of a folder as a zip, below the folder's own name and in order, without hidden files.

    Raises OSError where a file cannot be read.
    """
    content = BytesIO()
    with ZipFile(content, "w", ZIP_DEFLATED) as made:
        for place in sorted(folder.rglob("*")):
            inside = place.relative_to(folder.parent)
            if place.is_file() and not place.is_symlink() and not any(part.startswith(".") for part in inside.parts):
                made.write(place, inside.as_posix())
    return content.getvalue()


def open_in_browser(address: str) -> None:
    """Open an address in the browser by a file of mode 0600, which is removed when this process ends."""
    # Only its owner may read a file of ``tempfile``.
    with tempfile.NamedTemporaryFile("w", prefix="ncgear-studio-", suffix=".html", delete=False) as made:
        made.write(leading_to(address))
    file = Path(made.name)
    atexit.register(_removed, file)
    webbrowser.open(file.as_uri())


def leading_to(address: str) -> str:
    """A page that leads to an address, and requests no icon."""
    leads = f'<link rel="icon" href="data:,"><meta http-equiv="refresh" content="0;url={escape(address)}">'
    return f"<!DOCTYPE html><title>ncgear studio</title>{leads}"


def _removed(file: Path) -> None:
    with suppress(OSError):
        file.unlink()
