"""Wishes for whole machines, each by one command.  Writes benchmarks/whole_machines.md.

Run as ``python benchmarks/whole_machines.py`` or with names of wishes to run these alone; the others keep their rows.
Needs the extra ``optimize``.  Every machine that is found is rated anew from its file by ``ncgear check`` and ``ncgear
strength``.  Seconds are of processor time, of all processes together: half of them pass on two free cores.
"""

from __future__ import annotations

import json
import platform
import resource
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ncgear.design.rewritten import rewritten

ROOT = Path(__file__).parents[1]
KEPT = Path(__file__).with_suffix(".json")
MACHINES = ROOT / "src" / "ncgear" / "design" / "templates" / "machines"

STEEL: Mapping[str, Any] = {"choices": {"materials": ["42CrMo4", "18CrNiMo7-6"]}}
PRINTED: Mapping[str, Any] = {"choices": {"processes": ["printed"]}}

WISHES: dict[str, tuple[Path, Mapping[str, Any]]] = {
    "pump": (MACHINES / "pump.yaml", {}),
    "pump, two steels by cost": (
        MACHINES / "pump.yaml",
        {
            "choices": {
                "materials": ["42CrMo4", {"material": "18CrNiMo7-6", "cost_factor": 1.6}],
                "cost": {"motor_per_w": 0.5, "gears_per_dm3": 400},
            }
        },
    ),
    "press feeder with a dwell": (MACHINES / "press-feeder.yaml", {}),
    "press feeder, dwell of 60 deg": (
        MACHINES / "press-feeder.yaml",
        {"wishes.dwell": [{"at": "extended", "within_mm": 0.5, "for_deg": 60}]},
    ),
    "pusher": (MACHINES / "pusher.yaml", {}),
    "pusher, gears within 30 mm": (MACHINES / "pusher.yaml", {"choices": {"center_distance_mm": 30}}),
    "pusher, shaped": (MACHINES / "pusher.yaml", {"choices": {"processes": ["shaped"]}}),
    "pusher, wire cut": (MACHINES / "pusher.yaml", {"choices": {"processes": ["wire_cut"]}}),
    "carton pusher without masses": (ROOT / "designs" / "pusher.yaml", STEEL),
    "desk toy, printed": (MACHINES / "desk-toy.yaml", PRINTED),
    "shaper with an even cut": (ROOT / "designs" / "quick-return-shaper.yaml", {}),
    "rocker": (ROOT / "designs" / "rocker-drive.yaml", STEEL),
    "rocker with three motors": (
        ROOT / "designs" / "rocker-drive.yaml",
        {
            "choices": {
                "motors": [
                    {"name": "90 W", "power_w": 90, "cost": 80},
                    {"name": "120 W", "power_w": 120, "cost": 95},
                    {"name": "180 W", "power_w": 180, "cost": 110},
                ],
                "cost": {"gears_per_dm3": 500},
            }
        },
    ),
    "yoke pump": (ROOT / "designs" / "scotch-yoke-pump.yaml", {}),
    "printed pump": (ROOT / "designs" / "printed-pump.yaml", PRINTED),
    "feeder with a kept motion": (
        ROOT / "designs" / "feeder-kept.yaml",
        {
            "gears": {"teeth": 48, "module_mm": 2, "face_width_mm": 15, "backlash_mm": 0.1},
            "resistance": {"polynomial_n": [200]},
        },
    ),
    "baler, a low cap of power": (MACHINES / "baler.yaml", {"optimize.limits.peak_power_w": 1200}),
    "baler of a template": (MACHINES / "baler.yaml", {}),
    "baler-real": (ROOT / "designs" / "baler-real.yaml", {}),
    "baler-holds, its power and acceleration": (
        ROOT / "designs" / "baler-holds.yaml",
        {
            "gears.backlash_mm": 0.05,
            "optimize": {"limits": {"peak_power_w": 10855, "peak_acceleration_mm_s2": 19143, "pressure_angle_deg": 60}},
        },
    ),
    "baler with a free flywheel": (
        ROOT / "designs" / "baler-flywheel.yaml",
        {"optimize.driven_flywheel_kg_mm2": {"most": 150e6}},
    ),
}


def text_of(name: str) -> str:
    """The design file of a wish."""
    path, values = WISHES[name]
    text = path.read_text(encoding="utf-8")
    named = text if path.parent.name == "designs" else f"name: {path.stem}\n{text}"
    return rewritten(named, values)


def command(*words: str) -> subprocess.CompletedProcess[str]:
    """A command of ncgear."""
    return subprocess.run([sys.executable, "-m", "ncgear", *words], capture_output=True, text=True, check=False)


def ran(name: str) -> dict[str, Any]:
    """What one wish ends in."""
    with TemporaryDirectory() as folder:
        file, out = Path(folder) / "wish.yaml", Path(folder) / "out"
        file.write_text(text_of(name), encoding="utf-8")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = command("design", str(file), "--out", str(out), "--json")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        if done.returncode:
            said = done.stderr.strip().splitlines()[-1:] or [""]
            return {"seconds": seconds, "status": done.returncode, "said": said[0].replace(str(file), "wish.yaml")}
        figures = json.loads(done.stdout)
        apart = [rated_apart(out / f"{one['name']}.yaml", one) for one in figures["machines"]]
        place = [one["name"] for one in figures["machines"]].index(figures["recommended"])
        limits = figures["limits"]
        return {
            "seconds": seconds,
            "status": 0,
            "machines": len(figures["machines"]),
            "best": figures["machines"][place],
            "power_gap": limits["peak_power_gap"],
            "flank_load_gap": min(one["flank_load_gap"] for one in limits["machines"]),
            "best_flank_load_gap": limits["machines"][place]["flank_load_gap"],
            "gear_volume_gap": limits["machines"][place]["gear_volume_gap"],
            "apart": max(apart),
        }


def rated_apart(file: Path, told: Mapping[str, Any]) -> float:
    """The greatest share by which power and safeties of a file, rated anew, differ from those that were told."""
    check = json.loads(command("check", str(file), "--json").stdout)
    strength = json.loads(command("strength", str(file), "--json", "--out", str(file.parent / "strength")).stdout)
    shares: dict[str, list[float]] = {"bending": [], "contact": []}
    for gear in ("driving", "driven"):
        for damage, found in shares.items():
            part = strength[gear]
            if f"{damage}_stress_mpa" in part:
                safety = part[f"{damage}_endured_mpa"] / part[f"{damage}_stress_mpa"]
                found.append(safety / part[f"{damage}_safety_wanted"])
    pairs = [(check["check"]["peak_power_w"], told["peak_power_w"])]
    pairs += [(min(found), told[f"{damage}_share"]) for damage, found in shares.items() if found]
    return float(max(abs(one / other - 1.0) for one, other in pairs))


def percent(value: float | None) -> str:
    """A share in a table."""
    return "-" if value is None else f"{100.0 * value:.1f}"


def report(rows: Mapping[str, Mapping[str, Any]]) -> str:
    """The whole page."""
    lines = [
        "# Whole machines",
        "",
        f"Written by `python benchmarks/whole_machines.py`: Python {platform.python_version()}. One `ncgear design`",
        "for each wish; seconds of processor time of all its processes, of which half pass on two free cores; some",
        "were taken while the computer did other work, which makes them up to three times as many. Gaps to",
        "the certified limits are in percent: of the least power of all machines; of the flank load, the least of all",
        "machines and the recommended one's; of its gears' volume at the estimate's level of strength. Power and",
        "safeties that `check` and `strength` tell of each file differ from those of `design` by `apart`.",
        "",
        "| wish | s | machines | recommended | power | flank load | its own | gears | apart |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for name in WISHES:
        row = rows.get(name)
        if row is None:
            lines.append(f"| {name} | not run | | | | | | | |")
        elif row["status"]:
            lines.append(
                f"| {name} | {row['seconds']:.0f} | refused, status {row['status']}: {row['said']} | | | | | | |"
            )
        else:
            best = row["best"]
            teeth = f"{best['teeth']:.0f} x {best['module_mm']:g} x {best['face_width_mm']:g} mm"
            size = f"{best['peak_power_w']:.4g} W, {teeth}"
            gaps = (row[key] for key in ("power_gap", "flank_load_gap", "best_flank_load_gap", "gear_volume_gap"))
            cells = [f"{row['seconds']:.0f}", str(row["machines"]), size, *map(percent, gaps), f"{row['apart']:.0e}"]
            lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    rows: dict[str, Any] = {}
    for wish in sys.argv[1:] or WISHES:
        row = ran(wish)
        print(wish, row, flush=True)
        rows = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
        rows[wish] = row
        KEPT.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    Path(__file__).with_suffix(".md").write_text(report(rows), encoding="utf-8")
