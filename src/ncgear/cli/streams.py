"""The streams of a run: each is there, and takes every text, whatever its encoding.

Units have signs that many encodings lack: on Windows that of a file is the country's own, as GBK, which has no square.
"""

from __future__ import annotations

import codecs
import os
import sys

INSTEAD = {
    "\u00b0": "deg",
    "\u00b1": "+-",
    "\u00b5": "u",
    "\u00b7": "*",
    "\u00d7": "x",
    "\u00d8": "O",
    "\u03bc": "u",
    "\u03c0": "pi",
    "\u2013": "-",
    "\u2192": "->",
    "\u2212": "-",
}
"""What is said instead of a sign; accents and the heights of digits go, and all else becomes a question mark."""

SUBSTITUTED = "ncgear.substituted"
"""The name of the handler of errors that says one for the other."""

PLAIN = "ncgear_plain"
"""ASCII by another name: typer takes a stream of that encoding for a mistake, and writes UTF-8 there."""


def open_streams() -> None:
    """Make the streams take every text, and give the null device to those that a shell has closed (``2>&-``).

    Without it the next file that is opened would get the number of the stream, and what libraries say there.
    """
    codecs.register_error(SUBSTITUTED, _substituted)
    codecs.register(_plain)
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        stream = getattr(sys, name)
        if stream is None:
            # The lowest free number is that of the stream, since those before it are open by now.
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace" if mode == "r" else SUBSTITUTED)
            if mode == "w" and codecs.lookup(stream.encoding).name == "ascii":
                stream.reconfigure(encoding=PLAIN, errors=SUBSTITUTED)


def _substituted(error: UnicodeError) -> tuple[str, int]:
    """What is written instead of text that an encoding lacks, and where it ends."""
    from unicodedata import normalize

    if not isinstance(error, UnicodeEncodeError):
        raise error
    lacking = error.object[error.start : error.end]
    plain = (INSTEAD.get(one) or normalize("NFKD", one).encode("ascii", "ignore").decode() or "?" for one in lacking)
    return "".join(plain), error.end


def _plain(name: str) -> codecs.CodecInfo | None:
    if name != PLAIN:
        return None
    found = codecs.lookup("ascii")
    return codecs.CodecInfo(found.encode, found.decode, found.streamreader, found.streamwriter,
                            found.incrementalencoder, found.incrementaldecoder, PLAIN)  # fmt: skip
