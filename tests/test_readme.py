"""The README's commands are those of CI and of the program; the figures of docs/baler.md are those of today's run."""

from __future__ import annotations

import json
import re
from functools import cache
from typing import Any

import pytest

from commands import ROOT, fresh
from ncgear.cli.app import COMMANDS

README = (ROOT / "README.md").read_text(encoding="utf-8")
BALER = (ROOT / "docs" / "baler.md").read_text(encoding="utf-8")


def shell_blocks() -> list[str]:
    return re.findall(r"```sh\n(.*?)\n```", README, flags=re.DOTALL)


def test_the_two_commands() -> None:
    build, test = shell_blocks()
    assert build.startswith("python3 -m venv .venv && ")
    assert build.endswith(".venv/bin/ncgear build designs/baler.yaml")
    assert test in (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()


@cache
def checked(design: str) -> dict[str, Any]:
    return json.loads(fresh("check", f"designs/{design}.yaml", "--json").stdout)


def table_rows() -> dict[str, tuple[float, float]]:
    rows = re.findall(r"^\| ([^|]+) \| (\d+) \| (\d+) \|$", BALER, flags=re.MULTILINE)
    return {name: (float(power), float(acceleration)) for name, power, acceleration in rows}


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("row", "name"),
    [
        ("the paper's mechanism", "this design"),
        ("uniform crank, same linkage", "uniform crank"),
        ("earlier mechanism (its figures brought from 60 to 20 r/min)", "Lei et al. 2012"),
    ],
)
def test_the_comparison_is_todays(row: str, name: str) -> None:
    found = next(r for r in checked("baler")["comparison"] if r["name"] == name and r["same_speed"])
    power, acceleration = table_rows()[row]
    assert round(found["peak_power_w"]) == power
    assert round(found["peak_acceleration_cycle_mm_s2"]) == acceleration


@pytest.mark.parametrize(("name", "words"), [("uniform crank", "27.3 %"), ("Lei et al. 2012", "1.0 %")])
def test_the_savings_are_todays(name: str, words: str) -> None:
    row = next(r for r in checked("baler")["comparison"] if r["name"] == name and r["same_speed"])
    assert words in row["note"]
    assert words in BALER


@pytest.mark.slow
def test_what_is_possible_is_todays() -> None:
    """The table of docs/baler.md, whose thin spaces part thousands."""
    rows = re.findall(r"^\| `designs/([\w-]+)\.yaml`[^|]*\| ([\d ]+) \| ([\d ]+) \|", BALER, flags=re.MULTILINE)
    told = {name: (int(power.replace(" ", "")), int(peak.replace(" ", ""))) for name, power, peak in rows}
    found = {name: checked(name)["check"] for name in told}
    assert len(told) == 4
    assert told == {
        name: (round(check["peak_power_w"]), round(check["peak_acceleration_cycle_mm_s2"]))
        for name, check in found.items()
    }


def test_every_command_of_the_readme_exists() -> None:
    named = set(re.findall(r"^\| \[`ncgear (\w+)`\]", README, flags=re.MULTILINE))
    assert named == {command.__name__ for command in COMMANDS}
