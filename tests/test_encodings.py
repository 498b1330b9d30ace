"""What the command line says on streams of any encoding: all of it, readable, and no fault."""

from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path

import pytest

from commands import ROOT, Run, environment
from every_command import COMMANDS
from ncgear.cli.run import SUBSTITUTED, open_streams

ENCODINGS = "gbk", "cp932", "cp1252", "ascii", "latin-1", "cp437", "koi8-r", "big5", "shift_jis"

NAME = "\u00c5ngstr\u00f6m-\u6a5f\u68b0-\u03c0\u00b2-\udcff"
SAID = f"{NAME} 3 mm\u00b2 \u00b1 2 \u00b5m, 7\u00b0 \u2192 \u22121 \u00d7 \u03a6"
"""A name that no encoding but UTF-8 has, with half a character of a wrong file name, and signs."""


class Everywhere(io.StringIO):
    """A stream that keeps what is written, and writes it in each encoding too."""

    def __init__(self) -> None:
        super().__init__()
        self.streams = {name: io.TextIOWrapper(io.BytesIO(), encoding=name) for name in ENCODINGS}

    def reconfigure(self, errors: str) -> None:
        for stream in self.streams.values():
            stream.reconfigure(errors=errors)

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return "utf-8"

    def write(self, text: str) -> int:
        for stream in self.streams.values():
            stream.write(text)
        return super().write(text)

    def said(self, encoding: str) -> str:
        stream = self.streams[encoding]
        stream.flush()
        return stream.buffer.getvalue().decode(encoding)  # type: ignore[attr-defined, no-any-return]


QUICK = """
check designs/baler.yaml --verbose | balance none.yaml | explain backlash_mm | explain | schema | new mine | bench none
optimize none.yaml | frontier none.yaml | sweep none.yaml --vary a=1:2 | measured none.yaml | tolerance none.yaml
fit none.yaml | size none.yaml | animate none.yaml | report none.yaml | simulate none.yaml | studio none.yaml
build none.yaml | design none.yaml | strength none.yaml | compare none.yaml none.yaml | formulas none.yaml
reproduce --out designs/pusher.yaml/x
"""
SLOW = """
compare designs/pusher.yaml designs/baler.yaml | strength designs/baler-holds.yaml --verbose
sweep designs/pusher.yaml --vary linkage.rod_mm=50:400:4 --verbose
animate designs/ellipse.yaml --frames=2 --width=320
"""
LONG = """
balance designs/balance/threshing-drum.yaml --verbose | build designs/printed-pump.yaml --verbose | reproduce
simulate designs/baler-dynamics.yaml | tolerance designs/ellipse.yaml --samples=256 --verbose | size designs/pusher.yaml
report designs/ellipse.yaml | optimize designs/pusher.yaml | frontier designs/baler-frontier.yaml --points=2
"""


def lines(text: str) -> list[str]:
    return [" ".join(line.split()) for line in text.replace("\n", "|").split("|") if line.strip()]


def test_every_command_is_asked() -> None:
    asked = {line.split()[0] for line in lines(QUICK)}
    assert asked == {*COMMANDS.split(), "studio"}


@pytest.mark.tiers(thorough=["check*"], slow=lines(SLOW), long=lines(LONG), rest="quick")
@pytest.mark.parametrize("line", lines(QUICK + SLOW + LONG))
def test_no_command_fails_by_what_it_prints(
    run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, line: str
) -> None:
    (tmp_path / "designs").symlink_to(ROOT / "designs")
    out, err = Everywhere(), Everywhere()
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "stderr", err)
    status, *_ = run(*line.split())
    assert status == (2 if "none" in line or "yaml/x" in line else 0), err.getvalue()
    for stream in (out, err):
        for encoding in ENCODINGS:
            said = stream.said(encoding)
            assert said.count("\n") == stream.getvalue().count("\n")
            # All signs that it lacks have a substitute.
            assert said.count("?") == stream.getvalue().count("?")


@pytest.mark.parametrize("encoding", [*ENCODINGS, "utf-8"])
def test_any_text_is_said(monkeypatch: pytest.MonkeyPatch, encoding: str) -> None:
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    monkeypatch.setattr(sys, "stdout", stream)
    open_streams()
    print(SAID, flush=True)
    assert stream.errors == SUBSTITUTED
    said = stream.buffer.getvalue().decode(encoding)  # type: ignore[attr-defined]
    if encoding == "ascii":
        assert said == "Angstrom-??-pi2-? 3 mm2 +- 2 um, 7deg -> -1 x ?\n"
    elif encoding == "utf-8":
        assert said == SAID.replace("\udcff", "?") + "\n"
    else:
        assert said.startswith(("Angstrom", "\u00c5ngstr\u00f6m", "Angstr\u00f6m"))


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["gbk", "ascii"])
def test_a_process_says_it_in_the_encoding_of_its_streams(encoding: str) -> None:
    """What no other stream than the process's own has: its encoding by the environment, and typer's own view of it."""
    line = [sys.executable, "-m", "ncgear", "check", "designs/baler.yaml", "--verbose"]
    done = subprocess.run(line, cwd=ROOT, env=environment(PYTHONIOENCODING=encoding), capture_output=True)
    assert done.returncode == 0
    assert "1500 mm/s2" in done.stdout.decode(encoding)
    assert done.stderr.decode(encoding) == ""
