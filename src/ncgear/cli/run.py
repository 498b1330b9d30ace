"""A run of the command line: what was asked for, and how it ended."""

from __future__ import annotations

import os
import sys
from typing import NoReturn

import typer

from ncgear.cli.app import app
from ncgear.errors import DesignError

INTERRUPTED = 130
WRONG_INPUT = 2
FAULT = 1


def main() -> NoReturn:
    """Run the command line and exit with its status."""
    try:
        app()
        status = 0
    except KeyboardInterrupt:
        status = INTERRUPTED
    except DesignError as error:
        status = _say(str(error), error.exit_status)
    except OSError as error:
        status = _say(_of_system(error), WRONG_INPUT)
    except Exception as error:
        status = _internal_fault(error)
    sys.exit(status)


def _say(message: str, status: int) -> int:
    typer.echo(message, err=True)
    return status


def _of_system(error: OSError) -> str:
    parts = [str(part) for part in (error.filename, error.strerror or error) if part]
    return f"{': '.join(parts)}; give a path that can be read or written"


def _internal_fault(error: Exception) -> int:
    if os.environ.get("NCGEAR_DEBUG"):
        import traceback

        traceback.print_exception(error)
    reason = " ".join(f"{type(error).__name__}: {error}".split())
    return _say(f"ncgear: internal fault: {reason}, please report", FAULT)
