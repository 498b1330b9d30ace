"""Commands of the documentation: ncgear in this process, everything else in a real shell."""

from __future__ import annotations

import io
import shlex
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from unittest.mock import patch

import ncgear.cli
from commands import signals_kept

OF_SHELL = set("|<>&;$*`\n")
"""Characters that need a shell."""

WIDTH = "120"
"""Columns of the terminal on which the pages were made."""


def run_line(command: str) -> tuple[int, str]:
    """Exit status of a command line and all it prints, stdout and stderr as they come."""
    words = shlex.split(command) if not OF_SHELL & set(command) else []
    if words[:1] == ["ncgear"]:
        return _in_this_process(words)
    return _in_a_shell(command)


def _in_this_process(words: list[str]) -> tuple[int, str]:
    printed = io.StringIO()
    # Pages show no line of progress, however slow the machine is.
    quiet = patch("ncgear.cli.progress.LINE_SECONDS", 1e6)
    with patch.object(sys, "argv", words), redirect_stdout(printed), redirect_stderr(printed), quiet, signals_kept():
        try:
            ncgear.cli.main()
        except SystemExit as exit_:
            return int(exit_.code or 0), printed.getvalue()
    raise AssertionError("the command line ends by SystemExit")


def _in_a_shell(command: str) -> tuple[int, str]:
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail\n{command}"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout
