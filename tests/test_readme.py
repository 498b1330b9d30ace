"""The README's commands are those of CI and of the program; the figures of docs/baler.md are those of today's run."""

from __future__ import annotations

import json
import re
from functools import cache
from math import degrees, floor, pi, radians
from runpy import run_path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import drives
from commands import ROOT, fresh
from ncgear.cli.app import COMMANDS
from ncgear.project.best_law import BestLaw

README = (ROOT / "README.md").read_text(encoding="utf-8")
BALER = (ROOT / "docs" / "baler.md").read_text(encoding="utf-8")


def shell_blocks() -> list[str]:
    return re.findall(r"```sh\n(.*?)\n```", README, flags=re.DOTALL)


def test_the_two_commands() -> None:
    build, test = shell_blocks()
    assert build.startswith("python3 -m venv .venv && ")
    assert build.endswith(".venv/bin/ncgear build designs/pusher.yaml")
    assert test in (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("source", [None, "https://forge.example/ncgear/"])
def test_an_index_of_packages_shows_no_path(source: str | None) -> None:
    """Each address is that of a file of this checkout at its version; without an address there is no link."""
    pytest.importorskip("hatchling", reason="what builds packages is not installed")
    shown = run_path(str(ROOT / ".ci" / "long_description.py"))["for_index"](README, source, "1.2.3")
    found = re.findall(r"(!?)\]\(([^)\s]+)\)", re.sub(r"(!?)\[[^\]]*\]", r"\1]", shown))
    paths = re.findall(r"(!?)\]\((?!\w+:)([^)\s]+)\)", re.sub(r"(!?)\[[^\]]*\]", r"\1]", README))
    assert len(paths) > 50
    if source is None:
        assert [address for _, address in found if "://" not in address or "forge" in address] == []
        return
    own = [(sign, address.removeprefix(source)) for sign, address in found if address.startswith(source)]
    assert [(sign, address.partition("/v1.2.3/")[2]) for sign, address in own] == paths
    for sign, address in own:
        kind, _, path = address.partition("/v1.2.3/")
        assert kind == ("raw" if sign else "blob")
        assert (ROOT / path.partition("#")[0]).exists(), path


@cache
def checked(design: str) -> dict[str, Any]:
    return json.loads(fresh("check", f"designs/{design}.yaml", "--json").stdout)


def table_rows() -> dict[str, tuple[float, float]]:
    rows = re.findall(r"^\| ([^|]+) \| (\d+) \| (\d+) \|$", BALER, flags=re.MULTILINE)
    return {name: (float(power), float(acceleration)) for name, power, acceleration in rows}


@pytest.mark.tiers(slow=["uniform crank, same linkage-uniform crank"], rest="long")
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


@pytest.mark.slow
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


def cells_of(first: str) -> list[str]:
    """The cells of a row of "What is possible", without thin spaces."""
    line = next(line for line in BALER.split("## What is possible")[1].splitlines() if line.startswith(f"| {first}"))
    return [cell.strip().replace(" ", "") for cell in line.strip("|").split("|")][1:]


@pytest.mark.tiers(slow=["baler-half"], rest="long")
@pytest.mark.parametrize(
    "name", ["baler-66", "baler-66-two-stage", "baler-half", pytest.param("baler-smooth", marks=pytest.mark.slow)]
)
def test_the_certified_limits_are_todays(name: str) -> None:
    """What no law has less than, rounded down; tests/test_limit.py judges the limit."""
    bound = BestLaw(drives.loaded(name).design).bound
    assert bound is not None
    assert floor(bound.value) == int(cells_of(f"`designs/{name}.yaml`")[2])


@pytest.mark.parametrize("name", ["baler-66", "baler-half", "baler-smooth"])
def test_the_pressure_angles_are_todays(name: str) -> None:
    """By SciPy's spline of the stored ratios: tan mu = |d ln i12 / dphi2| / (1 + i12), and the rack's 20 degrees."""
    stored = np.log(drives.loaded(name).design.motion.ratio)
    knots = np.linspace(0.0, 2.0 * pi, stored.size + 1)
    spline = CubicSpline(knots, np.append(stored, stored[0]), bc_type="periodic")
    angle = np.linspace(0.0, 2.0 * pi, 40_001)
    ratio = np.exp(spline(angle))
    # The mean of i12 over the driven angle is 1
    ratio = ratio / ratio[:-1].mean()
    found = 20.0 + degrees(np.arctan(np.abs(spline(angle, 1) / (1.0 + ratio)).max()))
    assert f"{found:.1f}°" == cells_of(f"`designs/{name}.yaml`")[3]


def test_the_pressure_angles_of_two_stages_are_todays() -> None:
    stages = drives.drive("baler-66-two-stage").by_stage
    found = [stage.pitch.largest_pressure_angle_deg(radians(20.0)) for stage in stages]
    assert cells_of("`designs/baler-66-two-stage.yaml`")[3] == "50.0°each"
    assert [f"{angle:.1f}" for angle in found] == ["50.0", "50.0"]


@pytest.mark.slow
def test_the_mechanisms_without_a_design_are_todays() -> None:
    """At 60 r/min by scaling from 20 r/min: power with the speed, acceleration with its square."""
    rows = {row["name"]: row for row in checked("baler")["comparison"] if row["same_speed"]}
    for first, name in (("the paper's mechanism", "this design"), ("uniform crank", "uniform crank")):
        row = rows[name]
        scaled = (3.0 * row["peak_power_w"], 9.0 * row["peak_acceleration_cycle_mm_s2"])
        assert [float(cell) for cell in cells_of(first)[:2]] == pytest.approx(scaled, abs=0.6)
    published = drives.loaded("baler").design.comparison.published[0]
    assert cells_of("earlier mechanism")[:2] == [
        f"{published.peak_power_w:.0f}",
        f"{published.peak_acceleration_mm_s2:.0f}",
    ]


def test_every_command_of_the_readme_exists() -> None:
    named = set(re.findall(r"^\| \[`ncgear (\w+)`\]", README, flags=re.MULTILINE))
    assert named == {command.__name__ for command in COMMANDS}
