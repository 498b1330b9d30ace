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
    """Open an address in the browser; the file that leads there goes with this process."""
    file = leading_to(address)
    atexit.register(_remove, file)
    webbrowser.open(file.as_uri())


def leading_to(address: str) -> Path:
    """A file of mode 0600 that leads to an address."""
    leads = f'<meta http-equiv="refresh" content="0;url={escape(address)}">'
    # Only its owner may read a file of ``tempfile``.
    with tempfile.NamedTemporaryFile("w", prefix="ncgear-studio-", suffix=".html", delete=False) as made:
        made.write(f"<!DOCTYPE html><title>ncgear studio</title>{leads}")
    return Path(made.name)


def _remove(file: Path) -> None:
    with suppress(OSError):
        file.unlink()
