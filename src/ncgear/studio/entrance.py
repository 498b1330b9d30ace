"""How a browser comes to the studio: by a file that leads there, which only whoever started the studio can read.

What stands on the command line of a browser, any user of the computer can read; so there is the name of a file alone.
"""

from __future__ import annotations

import atexit
import tempfile
import webbrowser
from contextlib import suppress
from html import escape
from pathlib import Path


def open_in_browser(address: str) -> None:
    """Open an address in the browser by a file of mode 0600, which goes with this process."""
    # Only its owner may read a file of ``tempfile``.
    with tempfile.NamedTemporaryFile("w", prefix="ncgear-studio-", suffix=".html", delete=False) as made:
        made.write(leading_to(address))
    file = Path(made.name)
    atexit.register(_remove, file)
    webbrowser.open(file.as_uri())


def leading_to(address: str) -> str:
    """A page that leads to an address, and asks for no icon of its own."""
    leads = f'<link rel="icon" href="data:,"><meta http-equiv="refresh" content="0;url={escape(address)}">'
    return f"<!DOCTYPE html><title>ncgear studio</title>{leads}"


def _remove(file: Path) -> None:
    with suppress(OSError):
        file.unlink()
