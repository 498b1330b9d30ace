"""The answers about best laws: one law beside its certified limit, and power set against acceleration."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees

from ncgear.design.keys.design import Design
from ncgear.design.words import listed
from ncgear.figures import best_law
from ncgear.figures.answers.answer import Answer, Fault, Row, row
from ncgear.figures.numbers import figure, finite, fixed, name_of, shown, to_digits
from ncgear.numerics.units import KG_M2, label_and_unit
from ncgear.optimum.flywheels import KNOTS, FlywheelPoint
from ncgear.optimum.makeable.wishes import Goal
from ncgear.optimum.task import Figures
from ncgear.project.best_law import BestLaw
from ncgear.project.frontier_run import Frontier
from ncgear.project.law_task import SoughtMachine

GOALS = {Goal.WEIGHTED: "least weighted sum"}
"""Words for goals whose own name says too little."""

POINTS = 8
"""Points of a frontier that are told."""


def optimized_answer(best: BestLaw, then: str) -> Answer:
    """The best law beside its limit, the design as given and the uniform crank."""
    found = {"this law": best.figures}
    if best.given_figures is not None:
        found["design as given"] = best.given_figures
    found["uniform crank"] = best.uniform_figures
    design = best.design
    goal = GOALS.get(best.wishes.goal, best.wishes.goal.value.replace("_", " "))
    return Answer(
        f"{design.name}: {goal} at {design.operation.speed_rpm:g} r/min",
        tuple(_rows(best, list(found.values()))),
        _lost(best),
        _limit(best),
        heads=tuple(found),
        good="Every hard wish and limit is kept; ncgear check judges the rest.",
        then=then,
    )


def _limit(best: BestLaw) -> str:
    """What the law comes to, and how far that is from the limit that no law goes below."""
    bound, law = best.limit, _in_unit(best, finite(best.goal, "the law"))
    if bound is None:
        return f"{law}; no limit is certified of this goal"
    limit = _in_unit(best, finite(bound.value, "the limit"))
    if best.soft:
        return f"{law}, bent by soft wishes; the limit of hard wishes and limits alone is {limit} (certified)"
    over = "beside " if best.gap is None else f"{fixed(100.0 * best.gap, 1)} % above "
    holds = ": no law of such gears has less" if best.task.masses else ", which no law goes below"
    return f"{law}, {over}the limit of {limit}{holds} (certified)"


def _in_unit(best: BestLaw, goal: float) -> str:
    return f"{shown(goal)} {'' if best.wishes.goal is Goal.WEIGHTED else best_law.unit_of_goal(best)}".rstrip()


def _rows(best: BestLaw, found: list[Figures]) -> list[Row]:
    rack = best.wishes.limits.rack_angle_rad
    told, above = [best_law.summary_of(figures, best) for figures in found], f" above order {best.task.harmonics_above}"
    rows = [
        Row(name_of(key) + above * ("harmonics" in key), tuple(figure(key, figures.get(key)) for figures in told))
        for key in best_law.in_units_of(dict.fromkeys(["peak_power_w", "peak_acceleration_mm_s2", *_asked(best)]), best)
    ]
    rows.append(Row("ratio", tuple(f"{fixed(law.ratio_min, 3)} to {fixed(law.ratio_max, 3)}" for law in found)))
    rows.append(row("max_pressure_angle_deg", *(degrees(law.tangent_rad + rack) for law in found)))
    rows.append(row("convex", *(law.convex for law in found)))
    rows += [
        row(key, *(best_law.felt(key, law) for law in found))
        for key in best_law.FELT
        if best_law.felt(key, best.figures) is not None
    ]
    said = [*_of_lengths(best), *_of_flywheel(best)]
    if best.starts.count > 1:
        said.append(("starts", best_law.starts_text(best)))
    if (distance := best_law.not_closed(best)) is not None:
        said.append(("the limit", distance))
    if best.not_covered:
        said.append(("the limit", f"knows nothing of {listed(best.not_covered, 'or')} and may lie higher"))
    if far := best_law.limits_not_reached(best):
        named = (f"{key} {shown(limit)} ({to_digits(value, 4)})" for key, (limit, value) in far.items())
        said.append(("not reached", f"by this law: {listed(list(named), 'and')}"))
    if best.task.masses is not None and best.design.masses is not None:
        gear = figure("driven_gear_kg_mm2", best.task.masses.driven_inertia_kg_mm2)
        relaxed = "" if distance is None else ", and may lie higher"
        said.append(("masses", f"count; the limit holds for a driven gear of {gear}{relaxed}"))
    return [*rows, *(Row(name, (text,)) for name, text in said), *_without_masses(best)]


MAY_BE_ASKED = ("peak_speed_mm_s", "peak_jerk_mm_s3", "flank_load_n_mm", "center_distance_mm")
"""Figures that are told where they are limited or have a price."""


def _asked(best: BestLaw) -> list[str]:
    """These figures as far as they are asked for, and the harmonics above the order of the file."""
    wishes, task = best.wishes, best.task
    groups = wishes, wishes.limits, wishes.prices
    asked = [key for key in MAY_BE_ASKED if any(getattr(group, key, None) for group in groups)]
    if task.harmonics_above is not None:
        asked += ["acceleration_harmonics_mm_s2", *(["torque_harmonics_n_m"] if task.masses is not None else [])]
    return asked


def _of_lengths(best: BestLaw) -> Iterator[tuple[str, str]]:
    """The lengths of the mechanism that were chosen, and the limit with any lengths."""
    if (chosen := best.lengths) is not None:
        sizes = []
        for key, value in chosen.values.items():
            (name, unit), asked = label_and_unit(key), best.given.free_lengths[key]
            sizes.append(f"{name} {to_digits(value, 4)} {unit} ({shown(asked.least)} to {shown(asked.most)})")
        sizes.append(f"crank {to_digits(best.task.linkage.crank_mm, 4)} mm")
        with_any = chosen.least_with_any
        least = f"; with any lengths none has less than {_in_unit(best, with_any)}" if with_any else ""
        yield "chosen", f"{listed(sizes, 'and')}; the limit above holds for these lengths{least}"


def _of_flywheel(best: BestLaw) -> Iterator[tuple[str, str]]:
    """The flywheel on the driven shaft that was chosen, and the limit with any flywheel of its range."""
    chosen, asked = best.flywheel, best.given.free_flywheel
    if chosen is not None and asked is not None:
        size = figure("driven_flywheel_kg_m2", KG_M2 * chosen.inertia_kg_mm2)
        among, with_any = f"{shown(KG_M2 * asked.least)} to {shown(KG_M2 * asked.most)}", chosen.least_with_any
        least = f"; with any of them none has less than {_in_unit(best, with_any)}" if with_any else ""
        holds = f"the limit above holds for this flywheel{least}"
        yield "chosen", f"a flywheel of {size} on the driven shaft, the best of {among}; {holds}"


def _without_masses(best: SoughtMachine) -> list[Row]:
    """That masses are not counted, where the design gives none and has a power."""
    if best.design.masses is not None or best.design.resistance is None:
        return []
    return [Row("masses", ("not counted in power: give them as masses",))]


def _lost(beside: SoughtMachine) -> tuple[Fault, ...]:
    return (Fault(f"not kept of the design as given: {beside.not_kept}"),) if beside.not_kept else ()


def frontier_answer(found: Frontier, beside: SoughtMachine, then: str) -> Answer:
    """Some points from least power to least acceleration, and the mechanisms beside them."""
    output = beside.task.linkage.OUTPUT.acceleration
    key = f"peak_acceleration_cycle_{output.ending}"
    points = best_law.points_of(found)
    count = min(len(points), POINTS)
    told = [points[round(place * (len(points) - 1) / max(count - 1, 1))] for place in range(count)]
    rows = []
    for point, family in told:
        law, limit = point.law.peak_acceleration_mm_s2, point.limit_mm_s2
        gap = "-" if beside.soft else f"{fixed(100.0 * (law / limit - 1.0), 1)} %"
        texts = figure(key, limit), figure(key, law), gap, figure(key, family.peak_acceleration_mm_s2)
        rows.append(Row(f"under {figure('power_cap_w', point.cap_w)}", texts))
    rows += [
        Row(
            mechanism.name,
            (f"{figure('peak_power_w', mechanism.peak_power_w)}, {figure(key, mechanism.peak_acceleration_mm_s2)}",),
        )
        for mechanism in best_law.other_mechanisms(beside)
    ]
    rows += _without_masses(beside)
    certified = "the limit counts hard wishes alone" if beside.soft else "no law goes below the limit"
    speed = beside.design.operation.speed_rpm
    return Answer(
        f"{beside.design.name}: least {name_of(key)} under caps on the power, at {speed:g} r/min",
        tuple(rows),
        _lost(beside),
        f"{len(points)} points in all; {certified} (certified)",
        heads=("limit", "best law", "above it", "published family"),
        then=then,
    )


def flywheel_answer(found: Sequence[FlywheelPoint], design: Design) -> Answer:
    """Least power with every size of the flywheel on the driven shaft."""
    rows = []
    for point in found:
        gap = f"{fixed(100.0 * (point.law.peak_power_w / point.limit_w - 1.0), 1)} %" if point.limit_w > 0.0 else "-"
        powers = [figure("peak_power_w", power) for power in (point.limit_w, point.law.peak_power_w)]
        braking, ratio = (
            point.law.braking_power_w,
            f"{fixed(point.law.ratio_min, 3)} to {fixed(point.law.ratio_max, 3)}",
        )
        texts = (*powers, gap, figure("braking_power_w", braking), ratio)
        rows.append(Row(figure("driven_flywheel_kg_m2", KG_M2 * point.flywheel_kg_mm2), texts))
    return Answer(
        f"{design.name}: least power with a flywheel on the driven shaft, at {design.operation.speed_rpm:g} r/min",
        tuple(rows),
        (),
        f"laws of {KNOTS} knots; with the flywheel of its row no law goes below a limit (certified)",
        heads=("limit", "best law", "above it", "it brakes", "ratio"),
        then="ncgear optimize finds the best size, with a law of all its knots",
    )
