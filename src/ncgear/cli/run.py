"""A run of the command line, from the signals that end it to the exit status.

This module imports almost nothing, so that the process handles Ctrl-C from the first moment on.
"""

from __future__ import annotations

import atexit
import codecs
import os
import signal
import sys
from contextlib import suppress
from importlib.machinery import ExtensionFileLoader
from types import FrameType
from typing import NoReturn

from ncgear.errors import DesignError, fault_words
from ncgear.interrupts import ENDING, quiet_of_interrupts
from ncgear.memory import collect_rarely

BY_SIGNAL = 128
"""Number that a shell adds to the signal that has ended a command: Ctrl-C gives 130, ``kill`` 143."""

INTERRUPTED = BY_SIGNAL + signal.SIGINT
READER_LEFT = 141
"""Exit status of a program that SIGPIPE ends: the reader of the output, for example ``head``, has closed it."""

WRONG_INPUT = 2
FAULT = 1

NOT_LOADED = "cannot open shared object", "Library not loaded", "DLL load failed"
"""Messages of Linux, macOS and Windows where the system lacks a file that a compiled library needs."""

AGAIN_SECONDS = 0.2

COMPILED_IMPORT = {ExtensionFileLoader.create_module.__code__, ExtensionFileLoader.exec_module.__code__}
"""The functions that import a compiled library; some of these libraries abort the process if Ctrl-C is raised there."""

LAST_WORDS = "interrupted; what earlier runs have written is untouched"


class _End:
    """Handles the signals that end a run, each like Ctrl-C, and repeats the first signal until the run ends.

    Some libraries swallow the signal, for example while they import optional parts, or turn it into another error.
    While a compiled library is imported, the interrupt only waits for its repetition.
    """

    def __init__(self) -> None:
        self.came = 0
        for number in ENDING:
            # A run that was started with ``nohup`` continues when its terminal is closed.
            if number == signal.SIGINT or signal.getsignal(number) is signal.SIG_DFL:
                signal.signal(number, self)

    def __call__(self, number: int, frame: FrameType | None) -> None:
        self.came = self.came or number
        if hasattr(signal, "setitimer"):
            signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
            signal.setitimer(signal.ITIMER_REAL, AGAIN_SECONDS)
            if _imports_compiled(frame):
                return
        raise KeyboardInterrupt

    def ignore(self) -> None:
        """Ignore these signals from now on, so that none can interrupt the end of the interpreter."""
        if self.came and hasattr(signal, "setitimer"):
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        for number in ENDING:
            signal.signal(number, signal.SIG_IGN)


def _imports_compiled(frame: FrameType | None) -> bool:
    """Whether a compiled library is being imported in this frame or around it."""
    while frame is not None:
        if frame.f_code in COMPILED_IMPORT:
            return True
        frame = frame.f_back
    return False


def main() -> NoReturn:
    """Run the command line and exit with its status; at the end the process ignores the signals of ``ENDING``."""
    open_streams()
    collect_rarely()
    # pydantic would search all installed packages for plugins, which takes a tenth of a check.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    end = _End()
    sys.unraisablehook = quiet_of_interrupts
    status, last_words = 1, ""
    # A signal that ends the run comes again and again: once more, maybe, when the run is over
    with suppress(KeyboardInterrupt):
        status, last_words = _run()
        end.ignore()
    end.ignore()
    if end.came and status:
        status, last_words = BY_SIGNAL + end.came, LAST_WORDS
    if last_words:
        _say(last_words)
    if end.came:
        _leave(status)
    sys.exit(status)


def _leave(status: int) -> NoReturn:
    """End an interrupted run with a status.

    Under ``python -m``, Python remembers an interrupt and would end by SIGINT with any status.
    """
    with suppress(OSError, ValueError):
        sys.stdout.flush()
        sys.stderr.flush()
    atexit._run_exitfuncs()
    os._exit(status)


def _say(last_words: str) -> None:
    """Print to stderr; where it accepts nothing (a full disk), only the exit status tells."""
    try:
        print(last_words, file=sys.stderr, flush=True)
    except OSError:
        # Text left in the buffer would fail again at the end of the interpreter, and change the exit status.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())


def _run() -> tuple[int, str]:
    """The exit status, and the last message."""
    try:
        # Ctrl-C can come even during the import of the application.
        from ncgear.cli.app import app

        app()
    except SystemExit as exit_:
        if isinstance(exit_.__context__, BrokenPipeError):
            # typer gives status 1 for it, which stands for a fault.
            return READER_LEFT, ""
        status = int(exit_.code or 0)
        return status, LAST_WORDS if status == INTERRUPTED else ""
    except KeyboardInterrupt:
        return INTERRUPTED, LAST_WORDS
    except DesignError as error:
        return error.exit_status, str(error)
    except OSError as error:
        parts = [str(part) for part in (error.filename, error.strerror or error) if part]
        return WRONG_INPUT, f"{': '.join(parts)}; give a path that can be read or written"
    except Exception as error:
        if isinstance(error, ImportError) and any(words in str(error) for words in NOT_LOADED):
            return WRONG_INPUT, f"{error}; install what it needs of the system, or do without this output"
        return FAULT, f"ncgear: {fault_words(error)}"
    return 0, ""


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
"""Replacements for signs; accents are dropped, raised and lowered digits become plain, the rest becomes ``?``."""

SUBSTITUTED = "ncgear.substituted"
"""The name of the error handler that writes these replacements."""

PLAIN = "ncgear_plain"
"""ASCII under another name: typer takes a stream with ASCII for a mistake, and writes UTF-8 there."""


def open_streams() -> None:
    """Make the streams take every text, and give the null device to those that a shell has closed (``2>&-``).

    Without it the next file that is opened would get the number of the stream, and the output of libraries.
    """
    codecs.register_error(SUBSTITUTED, _substituted)
    codecs.register(_plain)
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        stream = getattr(sys, name)
        if stream is None:
            # The lowest free number is the number of the stream, since the streams before it are open by now.
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace" if mode == "r" else SUBSTITUTED)
            if mode == "w" and codecs.lookup(stream.encoding).name == "ascii":
                stream.reconfigure(encoding=PLAIN, errors=SUBSTITUTED)


def _substituted(error: UnicodeError) -> tuple[str, int]:
    """The replacement of text that an encoding lacks, and the index of its end."""
    from unicodedata import normalize

    if not isinstance(error, UnicodeEncodeError):
        raise error
    lacking = error.object[error.start : error.end]
    plain = (INSTEAD.get(mark) or normalize("NFKD", mark).encode("ascii", "ignore").decode() or "?" for mark in lacking)
    return "".join(plain), error.end


def _plain(name: str) -> codecs.CodecInfo | None:
    if name != PLAIN:
        return None
    found = codecs.lookup("ascii")
    return codecs.CodecInfo(found.encode, found.decode, found.streamreader, found.streamwriter,
                            found.incrementalencoder, found.incrementaldecoder, PLAIN)  # fmt: skip
