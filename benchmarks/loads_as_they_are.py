"""What each load takes off the safety of teeth, from the law's forces alone to all that strength counts.

Run as ``make bench`` or ``python benchmarks/loads_as_they_are.py``.  Writes benchmarks/loads-as-they-are.md.  The jam
is not that of a design: it is twice the largest torque of its driving gear.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf
from pathlib import Path
from time import process_time

from ruamel.yaml import YAML

import ncgear
from ncgear.figures.numbers import to_digits
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.face_load import FaceLoading
from ncgear.project.tooth_strength import judged_teeth
from ncgear.strength.answer import Strength
from ncgear.strength.conditions import Conditions
from ncgear.strength.holding import Damage, lives_of
from ncgear.strength.loading import Loading

ROOT = Path(__file__).parents[1]
DESIGNS = (
    ("baler-holds", None),
    ("baler-holds", 0.15),
    ("baler-drivetrain", None),
    ("pusher", None),
    ("pump-both-ways", None),
    ("rocker-drive", None),
)
"""Worked designs, and backlash in mm where it is not that of the file."""

JAM_TIMES, JAM_SHARE = 100, 2.0
"""How often the jam comes, and its torque in largest torques of the driving gear."""

ALONE = "jam alone"

PAGE = """\
# Loads as they are

Written by `python benchmarks/loads_as_they_are.py`: the least safety of any tooth of either gear against pitting and
against breakage, each row with one load more than the row above it, up to what `ncgear strength` tells. "Rigid" is
what the law asks of teeth at constant speed, on flanks without the factors of oil, speed and roughness, which the next
row has. "Worth" is the safety over that of the row above. The jam stands for itself: {jam:g} times the largest torque
of the driving gear, {times} times in the wanted life.

| machine | load | pitting | worth | breakage | worth |
|---|---|---|---|---|---|
{rows}

What the flanks have under the same loads:

| machine | film, roughnesses | safety against scuffing | wear, mm | of the module | s of a processor |
|---|---|---|---|---|---|
{flanks}
"""


def cases(drive: Drive) -> Iterator[tuple[str, dict[Damage, float]]]:
    """The loads one after the other, and the least safety against each damage under all up to that one."""
    judged = drive.judged_teeth("estimate")
    loading, conditions, load = judged.loading, drive.conditions, judged.strength.load
    still = replace(loading.still or loading, jammed=None)
    knocking, calm = replace(loading, jammed=None), replace(conditions, dynamic_factor=1.0)
    even = FaceLoading("given", 1.0)

    def under(loads: Loading, uneven: FaceLoading, with_what: Conditions) -> dict[Damage, float]:
        service = with_what, drive.running, load, uneven, drive.vibration
        return least(judged_teeth("estimate", drive.gears, judged.methods, loads, *service).strength)

    first = under(still, even, calm)
    film = min(drive.surfaces_by("estimate").pitting_factor)
    yield "rigid", {**first, Damage.CONTACT: first[Damage.CONTACT] / film}
    yield "film", first
    yield "knocks", under(knocking, even, calm)
    yield "local K_V", under(knocking, even, conditions)
    yield f"K_Hbeta, {drive.face_loading.basis}", under(knocking, drive.face_loading, conditions)
    assert judged.jammed is not None
    yield f"{ALONE}, {to_digits(N_M_PER_N_MM * jam_n_mm(drive), 3)} N m", least(judged.jammed)


def least(strength: Strength) -> dict[Damage, float]:
    """The least safety of both gears."""
    found = dict.fromkeys(Damage, inf)
    for gear in Gear:
        for damage, life in lives_of(strength, gear).items():
            found[damage] = min(found[damage], life.safety_min)
    return found


def jam_n_mm(drive: Drive) -> float:
    """The torque of the jam."""
    overload = drive.conditions.overload
    assert overload is not None
    return overload.driving_n_mm


def jammed(name: str, backlash_mm: float | None) -> Drive:
    """A worked design with the jam."""
    design = YAML(typ="safe").load(ROOT / "designs" / f"{name}.yaml")
    if backlash_mm is not None:
        design["gears"]["backlash_mm"] = backlash_mm
    plain = ncgear.load(design)
    torque = JAM_SHARE * plain.check.peak_power_w.value / plain.machine.speed_rad_s
    design["strength"] = {**design.get("strength", {}), "overload": {"driving_torque_n_m": torque, "times": JAM_TIMES}}
    return ncgear.load(design)


def main() -> None:
    """Compute all and write the page."""
    rows, flanks = [], []
    for name, backlash_mm in DESIGNS:
        begun = process_time()
        drive, before = jammed(name, backlash_mm), dict[Damage, float]()
        machine = name if backlash_mm is None else f"{name}, backlash {backlash_mm:g} mm"
        for load, found in cases(drive):
            cells = []
            for damage in (Damage.CONTACT, Damage.BENDING):
                told = before and not load.startswith(ALONE)
                worth = f"{found[damage] / before[damage]:.2f}" if told else "-"
                cells += [to_digits(found[damage], 3), worth]
            rows.append(f"| {' | '.join([machine, load, *cells])} |")
            before = found
        flank = drive.surfaces_by("estimate")
        assert flank.film is not None
        wear = flank.wear.deepest_mm
        cells = [
            to_digits(flank.film.thickness.value, 2),
            to_digits(flank.scuffing_safety or inf, 3),
            to_digits(wear, 2),
            to_digits(wear / drive.running.module_mm, 2),
            f"{process_time() - begun:.1f}",
        ]
        flanks.append(f"| {' | '.join([machine, *cells])} |")
        print(*rows[-6:], flanks[-1], sep="\n", flush=True)
    page = PAGE.format(rows="\n".join(rows), flanks="\n".join(flanks), jam=JAM_SHARE, times=JAM_TIMES)
    (ROOT / "benchmarks" / "loads-as-they-are.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
