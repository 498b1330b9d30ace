"""A run of the command line: what was asked for, and how it ended."""

from __future__ import annotations

import os
import signal
import sys
import threading
from types import FrameType
from typing import NoReturn

from ncgear.errors import DesignError

INTERRUPTED = 130
WRONG_INPUT = 2
FAULT = 1

AGAIN_SECONDS = 0.01

LAST_WORDS = "interrupted; what earlier runs have written is untouched"


class _Hearing:
    """Hears Ctrl-C, and knows afterwards that it came: a library may make another error of it."""

    def __init__(self) -> None:
        self.came = False

    def __call__(self, number: int, frame: FrameType | None) -> NoReturn:
        self.came = True
        raise KeyboardInterrupt


def main() -> NoReturn:
    """Run the command line and exit with its status; from then on the process hears no Ctrl-C."""
    hearing = _Hearing()
    signal.signal(signal.SIGINT, hearing)
    sys.unraisablehook = _heard_again
    status, last_words = _run()
    # What is done is done: the interpreter's own end is not interrupted.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hearing.came and status:
        status, last_words = INTERRUPTED, LAST_WORDS
    if last_words:
        print(last_words, file=sys.stderr)
    sys.exit(status)


def _heard_again(unraisable: sys.UnraisableHookArgs) -> None:
    """Where the interpreter can raise no error, as while it frees an object, Ctrl-C is heard again a little later."""
    if issubclass(unraisable.exc_type, KeyboardInterrupt):
        later = threading.Timer(AGAIN_SECONDS, os.kill, (os.getpid(), signal.SIGINT))
        later.daemon = True
        later.start()
    else:
        sys.__unraisablehook__(unraisable)


def _run() -> tuple[int, str]:
    """Exit status, and what is left to be said."""
    try:
        # Even the import of what reads the command line can be interrupted.
        from ncgear.cli.app import app

        app()
    except SystemExit as exit_:
        status = int(exit_.code or 0)
        return status, LAST_WORDS if status == INTERRUPTED else ""
    except KeyboardInterrupt:
        return INTERRUPTED, LAST_WORDS
    except DesignError as error:
        return error.exit_status, str(error)
    except OSError as error:
        return WRONG_INPUT, _of_system(error)
    except Exception as error:
        return FAULT, _internal_fault(error)
    return 0, ""


def _of_system(error: OSError) -> str:
    parts = [str(part) for part in (error.filename, error.strerror or error) if part]
    return f"{': '.join(parts)}; give a path that can be read or written"


def _internal_fault(error: Exception) -> str:
    if os.environ.get("NCGEAR_DEBUG"):
        import traceback

        traceback.print_exception(error)
    reason = " ".join(f"{type(error).__name__}: {error}".split())
    return f"ncgear: internal fault: {reason}, please report"
