"""What the studio's guard lets through: requests made by hand, without a server."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from at_once import at_once

pytest.importorskip("starlette", reason="starlette is not installed")

HOST, TOKEN = "127.0.0.1:8000", "a" * 32
COOKIE = f"ncgear-8000={TOKEN}"
GOOD = {"host": HOST, "origin": f"http://{HOST}", "cookie": COOKIE}


def answered(kind: str, path: str, **headers: str) -> Any:
    """Whether the guarded application is asked; else the status or code of the refusal."""
    from ncgear.studio.server import Guard

    asked, sent = [], []

    async def application(scope: Any, receive: Any, send: Any) -> None:
        asked.append(scope["path"])

    async def receive() -> dict[str, Any]:
        return {"type": f"{kind}.connect"}

    async def send(message: dict[str, Any]) -> None:
        sent.append(message)

    given = [(name.encode(), value.encode()) for name, value in headers.items()]
    scope = {"type": kind, "path": path, "method": "GET", "headers": given, "query_string": b""}
    asyncio.run(Guard(application, frozenset({HOST}), TOKEN)(scope, receive, send))
    return True if asked else sent[0].get("status", sent[0].get("code"))


@pytest.mark.parametrize("kind", ["http", "websocket"])
def test_the_own_page_with_its_cookie_is_let_through(kind: str) -> None:
    assert answered(kind, "/", **GOOD) is True


def test_a_request_without_an_origin_may_ask_for_a_page_and_not_talk() -> None:
    """Browsers name no origin where a person follows an address; a web socket of a page has one."""
    given = {"host": HOST, "cookie": COOKIE}
    assert answered("http", "/", **given) is True
    assert answered("websocket", "/", **given) == 1008


@at_once(
    "wrong",
    [{"host": "example.org:8000"}, {"origin": "http://example.org"}, {"origin": "null"}, {"cookie": "ncgear-8000=b"}],
)
def test_others_are_refused(wrong: dict[str, str]) -> None:
    assert answered("http", "/", **{**GOOD, **wrong}) == 403
    assert answered("websocket", "/", **{**GOOD, **wrong}) == 1008


def test_the_address_with_its_token_gives_the_cookie() -> None:
    assert answered("http", f"/{TOKEN}/", host=HOST) == 200
