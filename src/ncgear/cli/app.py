"""The application: its commands and options.

A run of the command line: what was asked for, and how it ended.
"""

from __future__ import annotations

import os
import signal
import sys
from types import FrameType
from typing import Annotated, NoReturn

import typer

from ncgear import __version__
from ncgear.cli.best_law import frontier, optimize, sweep
from ncgear.cli.design_files import explain, schema
from ncgear.cli.machines import balance, reproduce
from ncgear.cli.new import new
from ncgear.cli.one_design import animate, build, check, report, simulate
from ncgear.errors import DesignError

app = typer.Typer(
    name="ncgear",
    help="Non-circular gears from the motion of a slider. A design file says how it should move.",
    epilog="Exit status: 0 done, 2 wrong input, 3 no such mechanism exists, 1 a fault in ncgear.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

COMMANDS = (
    build,
    report,
    animate,
    check,
    simulate,
    optimize,
    frontier,
    sweep,
    balance,
    new,
    explain,
    reproduce,
    schema,
)
"""In the order of the help."""

for command in COMMANDS:
    app.command()(command)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"ncgear {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        # Eager and by callback: only so is it heeded before the missing command is.
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit."),
    ] = False,
) -> None:
    pass


INTERRUPTED = 130
WRONG_INPUT = 2
FAULT = 1

AGAIN_SECONDS = 0.2

LAST_WORDS = "interrupted; what earlier runs have written is untouched"


class _Hearing:
    """Hears Ctrl-C, and goes on telling of it until the run ends.

    Libraries swallow it here and there, as while optional parts of them are imported, or make another error of it.
    """

    def __init__(self) -> None:
        self.came = False

    def __call__(self, number: int, frame: FrameType | None) -> NoReturn:
        self.came = True
        if hasattr(signal, "setitimer"):
            signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
            signal.setitimer(signal.ITIMER_REAL, AGAIN_SECONDS)
        raise KeyboardInterrupt

    def end(self) -> None:
        """What is done is done: the interpreter's own end is not interrupted."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if self.came and hasattr(signal, "setitimer"):
            signal.setitimer(signal.ITIMER_REAL, 0.0)


def main() -> NoReturn:
    """Run the command line and exit with its status; from then on the process hears no Ctrl-C."""
    hearing = _Hearing()
    signal.signal(signal.SIGINT, hearing)
    sys.unraisablehook = _quiet_of_ctrl_c
    status, last_words = _run()
    hearing.end()
    if hearing.came and status:
        status, last_words = INTERRUPTED, LAST_WORDS
    if last_words:
        print(last_words, file=sys.stderr)
    sys.exit(status)


def _quiet_of_ctrl_c(unraisable: sys.UnraisableHookArgs) -> None:
    """Say nothing of a Ctrl-C that could not be raised, as while an object is freed: it comes again."""
    if not issubclass(unraisable.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(unraisable)


def _run() -> tuple[int, str]:
    """Exit status, and what is left to be said."""
    try:
        # Even the import of what reads the command line can be interrupted.

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
