"""Text about whole machines: a table, gains and costs of each beside the recommended one, figures for files."""

from __future__ import annotations

import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from ncgear import __version__
from ncgear.figures.answers.answer import Answer, Row
from ncgear.figures.numbers import fixed, known, to_digits
from ncgear.numerics.units import KG_M2, label_and_unit
from ncgear.whole_machines.limits import OUTSIDE
from ncgear.whole_machines.machine import MM3_PER_DM3, WholeMachine
from ncgear.whole_machines.search import WholeMachines

WORDS = {
    "peak_power_w": ("less motor", "more motor"),
    "gear_volume_mm3": ("smaller gears", "larger gears"),
    "driven_flywheel_kg_mm2": ("less flywheel", "more flywheel"),
    "center_distance_mm": ("less centre distance", "more centre distance"),
    "cost": ("less cost", "more cost"),
}
"""Words for less and for more of each figure that counts."""

ALIKE = 0.005
"""Relative difference below which figures are told as equal."""

HEADS = ("motor, W", "gears, dm3", "flywheel, kg m2", "teeth", "width, mm", "centres, mm")


def difference_words(machine: WholeMachine, other: WholeMachine, objectives: Sequence[str]) -> str:
    """The gains and the costs of a machine beside another one, in words."""
    gains, losses = list[str](), list[str]()
    for name in objectives:
        own, beside = machine.value(name), other.value(name)
        less, more = WORDS[name]
        if abs(own - beside) <= ALIKE * beside:
            continue
        if beside == 0.0 or own == 0.0:
            (gains if own < beside else losses).append(f"no {less.split()[-1]}" if own == 0.0 else "a flywheel")
        elif own < beside:
            gains.append(f"{fixed(100.0 * (1.0 - own / beside), 0)} % {less}")
        elif own > 2.0 * beside:
            losses.append(f"{to_digits(own / beside, 2)} times the {more.split()[-1]}")
        else:
            losses.append(f"{fixed(100.0 * (own / beside - 1.0), 0)} % {more}")
    if gains and losses:
        return f"{_listed(gains)} for {_listed(losses)}"
    return _listed(gains or losses) or "the same"


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(words[:-1]), *words[-1:])))


def machines_answer(found: WholeMachines, then: str = "") -> Answer:
    """The machines side by side; the text tells the recommended machine first."""
    best = found.machines[found.recommended]
    rows = [
        Row(f"{machine.name} *" if machine is best else machine.name, _cells(machine)) for machine in found.machines
    ]
    others = (machine for machine in found.machines if machine is not best)
    rows += [Row(machine.name, (difference_words(machine, best, _told(found)),)) for machine in others]
    rows.append(Row("made", (f"{best.material}, {best.process.replace('_', ' ')}: {best.cut}",)))
    rows += [Row("motor", (best.motor.name,))] if best.motor else []
    rows += [Row("cost", (to_digits(best.cost, 4),))] if best.cost is not None else []
    if found.lengths:
        sizes = [f"{name} {to_digits(size, 4)} {unit}" for name, unit, size in _sizes(found.lengths)]
        said = "the best for the flank load; limits hold for these lengths"
        rows.append(Row("lengths", (f"{_listed(sizes)}: {said}",)))
    rows += _limit_rows(found)
    rows += [Row("wishes", (prices_words(found),))] if found.prices else []
    count = len(found.machines)
    return Answer(
        f"{found.design.name}: {count} whole machine{'s' if count > 1 else ''} at "
        f"{found.design.operation.speed_rpm:g} r/min; recommended: {best.name}",
        tuple(rows),
        heads=HEADS,
        good="Each builds with a clean verdict; its figures follow from its file only.",
        then=then,
    )


def _sizes(lengths: Mapping[str, float]) -> Iterator[tuple[str, str, float]]:
    for key, value in lengths.items():
        yield (*label_and_unit(key), value)


def _limit_rows(found: WholeMachines) -> list[Row]:
    """How near the recommended machine, and the least power, come to the certified limits."""
    limits = found.limits
    if limits is None:
        return []
    own = limits.each[found.recommended]
    rows = [
        Row(
            "least power",
            (f"{to_digits(limits.power_w, 4)} W at least by gears of such inertia, whatever the law (certified)",),
        )
    ]
    if own.flank_load_n_mm > 0.0:
        gap = fixed(100.0 * own.flank_load_gap, 1)
        rows.append(Row("flank load", (f"{gap} % over a limit that no law of this power goes below",)))
    if own.gear_volume_mm3 > 0.0:
        gap = fixed(100.0 * own.gear_volume_gap, 1)
        rows.append(Row("gears", (f"{gap} % over that limit at the estimate's level of strength",)))
    if limits.cost is not None:
        rows.append(Row("least cost", (f"{to_digits(limits.cost, 4)} at least, at that level",)))
    return rows


def prices_words(found: WholeMachines) -> str:
    """The price of each wish and limit, in words."""
    return "; ".join(
        f"{price.key.removeprefix('optimize.limits.')} costs {fixed(100.0 * max(price.motor, 0.0), 0)} % of motor or "
        f"{fixed(100.0 * max(price.gears, 0.0), 0)} % of gears"
        for price in found.prices
    )


def _told(found: WholeMachines) -> tuple[str, ...]:
    has_cost = all(machine.cost is not None for machine in found.machines) and "cost" not in found.objectives
    return (*found.objectives, "cost") if has_cost else found.objectives


def _cells(machine: WholeMachine) -> tuple[str, ...]:
    has = machine.figures
    return (
        to_digits(has.peak_power_w, 4),
        to_digits(has.gear_volume_mm3 / MM3_PER_DM3, 4),
        to_digits(KG_M2 * has.driven_flywheel_kg_mm2, 3),
        f"{has.teeth} x {has.module_mm:g}",
        f"{has.face_width_mm:g}",
        to_digits(has.center_distance_mm, 4),
    )


def machines_figures(found: WholeMachines) -> dict[str, Any]:
    """The machines and the other results of the search, as plain values with keys that end in their unit."""
    best = found.machines[found.recommended]
    return {
        "design": found.design.name,
        "speed_rpm": found.design.operation.speed_rpm,
        "least": list(found.objectives),
        "recommended": best.name,
        "lengths": dict(found.lengths),
        "machines": [
            {
                "name": machine.name,
                **{key: value if key == "teeth" else known(value) for key, value in asdict(machine.figures).items()},
                "material": machine.material,
                "process": machine.process,
                "cut": machine.cut,
                "motor": machine.motor.name if machine.motor else None,
                "cost": machine.cost,
                "beside_recommended": "" if machine is best else difference_words(machine, best, _told(found)),
            }
            for machine in found.machines
        ],
        "limits": None if found.limits is None else _limits_figures(found),
        "wishes": [price._asdict() for price in found.prices],
        "laws": len(found.laws),
        "unfit": sorted({why for gears in found.unfit for why in gears.why}),
        "made_by": {"ncgear": __version__, "python": platform.python_version()},
    }


def _limits_figures(found: WholeMachines) -> dict[str, Any]:
    limits = found.limits
    assert limits is not None
    return {
        "peak_power_w": limits.power_w,
        "peak_power_gap": known(limits.power_gap),
        "cost": limits.cost,
        "cost_gap": limits.cost_gap,
        "machines": [
            {"name": machine.name, **{key: known(value) for key, value in asdict(own).items()}}
            for machine, own in zip(found.machines, limits.each, strict=True)
        ],
        "outside_the_proof": list(OUTSIDE),
    }
