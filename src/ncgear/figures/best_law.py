"""Best laws: one law as a design file, a certificate and text; a frontier of laws as CSV, JSON and text.

Both are compared with the limit that no law goes below, and with other mechanisms at the same speed.
"""

from __future__ import annotations

import platform
from collections.abc import Sequence
from dataclasses import asdict
from math import degrees
from typing import Any

from ncgear import __version__
from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import SIZES
from ncgear.design.laws.registry import found_values
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.rewritten import design_copy
from ncgear.design.words import ending_in
from ncgear.figures.numbers import shown
from ncgear.figures.tables import rows_text
from ncgear.frozen import dataclass
from ncgear.numerics.units import KG_M2, label_and_unit
from ncgear.optimum.flywheels import KNOTS, FlywheelPoint
from ncgear.optimum.frontier import FamilyPoint, LawPoint
from ncgear.optimum.makeable.demanded import CLOSE
from ncgear.optimum.makeable.wishes import ALONE, Goal
from ncgear.optimum.task import Figures, by_limit
from ncgear.project.best_law import BestLaw
from ncgear.project.free_lengths import changed_keys
from ncgear.project.frontier_run import Frontier
from ncgear.project.law import kept_size
from ncgear.project.law_task import SoughtMachine

NO_UNITS = {Goal.PRESSURE_ANGLE: "deg beside the rack's", Goal.WEIGHTED: "1"}
"""What stands for the unit of a goal that is no figure by itself."""

ARGUMENT = (
    "Between places of the crank every motion keeps relations that are convex in the squared ratio of speeds, for "
    "acceleration, power, time, the driven curve, the pressure angle and wishes of the motion; the driving curve's is "
    "made so by ranges of this ratio that are narrowed in rounds and divided, and so are times and the power that "
    "masses take. The multipliers of a conic programme prove the least value of every part of the ranges, with all "
    "rounding errors charged. What the limit does not know stands under not_covered_by_limit."
)

SUFFIX = "-optimized"


def unit_of_goal(best: BestLaw) -> str:
    """The unit of what is least."""
    goal = best.wishes.goal
    if goal in NO_UNITS:
        return NO_UNITS[goal]
    (key,) = in_units_of({key: price for key, price in vars(ALONE[goal]).items() if price}, best)
    return label_and_unit(key)[1]


def in_units_of(values: dict[str, Any], beside: SoughtMachine) -> dict[str, Any]:
    """Plain values with keys that end in the units of the output; in the code keys end in the units of a slider."""
    if not beside.task.linkage.OUTPUT.angular:
        return values
    return {key.replace("_mm_s", "_rad_s"): value for key, value in values.items()}


def optimized_design(loaded: LoadedDesign, best: BestLaw) -> str:
    """The text of the design file with the optimised law in place of its motion; comments elsewhere stay."""
    ratio, second = best.law.ratio.tolist(), best.law.second
    motion = found_values(ratio, None if second is None else second.tolist())
    values: dict[str, Any] = {"name": ending_in(SUFFIX, best.design.name), "motion": motion}
    values |= changed_keys(best.given, best.design)
    if best.flywheel is not None:
        values["masses.driven_flywheel_kg_mm2"] = best.flywheel.inertia_kg_mm2
    if best.design.motion.gives_center_distance and best.design.gears is not None:
        values |= {f"gears.{key}": size for key, size in zip(SIZES, kept_size(best.design), strict=True)}
    return design_copy(loaded, values)


def certificate(best: BestLaw) -> dict[str, Any]:
    """The limit, the law beside it, and the mechanisms to compare with, all at one speed."""
    bound, given, lengths, flywheel = best.limit, best.given_figures, best.lengths, best.flywheel
    effort = bound and bound.effort
    return {
        "design": best.design.name,
        "speed_rpm": best.design.operation.speed_rpm,
        "goal": {
            "least": best.wishes.goal.value,
            "unit": unit_of_goal(best),
            "limit": bound and bound.value,
            "places": bound and bound.places,
            "not_covered_by_limit": [*best.not_covered, *(["soft wishes"] if best.soft else [])],
            "law": best.goal,
            "gap": best.gap,
            "programmes": effort and effort.programmes,
            "parts": effort and effort.parts,
            "argument": ARGUMENT,
        },
        "lengths": lengths
        and {
            "values": dict(lengths.values),
            "limit_with_any": lengths.least_with_any,
            "outside_the_proof": FREE_LENGTHS,
        },
        "driven_flywheel": flywheel
        and {
            "inertia_kg_mm2": flywheel.inertia_kg_mm2,
            "limit_with_any": flywheel.least_with_any,
            "outside_the_proof": FREE_FLYWHEEL,
        },
        "starts": asdict(best.starts),
        "masses": None if best.task.masses is None else asdict(best.task.masses),
        "speed_fluctuation": best.task.speed_fluctuation,
        "not_kept": best.not_kept,
        "limits_not_reached": sorted(limits_not_reached(best)),
        "wishes": best.asked.model_dump(mode="json") if best.design.optimize else {},
        "frontier": [
            in_units_of({"power_cap_w": power, "limit_acceleration_mm_s2": acceleration}, best)
            for power, acceleration in best.limit_points
        ],
        "law": summary_of(best.figures, best),
        "design_as_given": given and summary_of(given, best),
        "uniform_crank": summary_of(best.uniform_figures, best),
        "made_by": {"ncgear": __version__, "python": platform.python_version()},
    }


FREE = "goal.limit holds for the {} chosen; with {} only limit_with_any is certain"
FREE_FLYWHEEL = FREE.format("flywheel that was", "every flywheel of the range")
FREE_LENGTHS = FREE.format("lengths that were", "all lengths of the ranges")

REACHED = 0.99
"""From this share of a limit on, a law counts as near to the limit: laws of few knots stay a little under it."""


def limits_not_reached(best: BestLaw) -> dict[str, tuple[float, float]]:
    """The stated limits, by key, that the law stays away from, and so would be the same without; with what it has."""
    given, found = best.asked.limits, best.figures
    has = by_limit(found, degrees(found.tangent_rad + best.wishes.limits.rack_angle_rad))
    if best.wishes.pairs > 1:
        # Each pair has an angle of its own
        del has["pressure_angle_deg"]
    stated = {name: getattr(given, name) for name in given.model_fields_set}
    far = {
        name: (limit, value)
        for name, limit in stated.items()
        if limit is not None and (value := has.get(name)) is not None and value < REACHED * limit
    }
    least = stated.get("ratio_min")
    return {**far, "ratio_min": (least, found.ratio_min)} if least and found.ratio_min > least / REACHED else far


def figures_summary(found: Figures) -> dict[str, Any]:
    """Figures as plain values, angles in degrees beside radians; those that are not known are left out."""
    known = {name: value for name, value in asdict(found).items() if value is not None}
    return {**known, "working_deg": degrees(found.working_rad), "tangent_deg": degrees(found.tangent_rad)}


def summary_of(found: Figures, beside: SoughtMachine) -> dict[str, Any]:
    """The same in the units of the machine's output."""
    return in_units_of(figures_summary(found), beside)


ALIKE = 1e-6
"""Share of the goal within which laws are the same."""


def starts_text(best: BestLaw) -> str:
    """What the search found from several starts."""
    starts = best.starts
    found = starts.count - starts.without_law
    none = f"; from {starts.without_law} of {starts.count} none was found" if starts.without_law else ""
    if found == 1:
        return f"1 law{none}"
    if starts.apart <= ALIKE:
        within = f", within {starts.apart:.0e} of the goal" if starts.apart > 0.0 else ""
        return f"{found} led to this law{within}{none}"
    return f"the best of {found} laws, {shown(100.0 * starts.apart)} % below the worst{none}"


def not_closed(best: BestLaw) -> str | None:
    """Why the limit is not nearer to the law; None where it is near, or where only the law could come nearer."""
    bound, prices = best.limit, best.wishes.prices
    if bound is None or min(best.goal, bound.reach) <= CLOSE * bound.value:
        return None
    if (effort := bound.effort) is not None:
        proof = f"{effort.programmes} programmes in {effort.parts} part{'s' if effort.parts > 1 else ''}"
        near = f"as near as {effort.places} places of the crank allow, by {proof}"
        return near if effort.ended else f"not closed further by {proof}"
    if bound.places == 0:
        return "knows the stroke, the time and the work of a cycle alone, in closed form"
    if prices.tangent_rad or prices.peak_jerk_mm_s3 or prices.tooth_force_n or prices.flank_load_n_mm:
        return "not closed further"
    return "not closed further: that needs one pair with convex pitch curves or a limit of the pressure angle"


FELT = ("braking_power_w", "rms_torque_n_m", "flywheel_kg_m2", "bearing_force_n", "shaking_force_n", "tooth_force_n")
"""The keys of figures that need masses."""


def felt(key: str, found: Figures) -> float | None:
    """One of ``FELT`` in the unit of its key; None where it is not known."""
    value: float | None = getattr(found, key.replace("kg_m2", "kg_mm2"))
    return KG_M2 * value if key == "flywheel_kg_m2" and value is not None else value


@dataclass(frozen=True)
class OtherMechanism:
    """A single mechanism to compare with, at the operating speed."""

    name: str
    peak_power_w: float
    peak_acceleration_mm_s2: float


def other_mechanisms(beside: SoughtMachine) -> list[OtherMechanism]:
    """The design's own law, the uniform crank, and the published mechanisms whose two figures are known."""
    named = {"uniform crank": beside.uniform_figures}
    if beside.given_figures is not None and beside.design.motion.law != "uniform_crank":
        named = {"design as given": beside.given_figures, **named}
    found = [OtherMechanism(name, check.peak_power_w, check.peak_acceleration_mm_s2) for name, check in named.items()]
    comparison = beside.design.comparison
    for published in comparison.published if comparison else ():
        slower = published.at_speed(beside.design.operation.speed_rpm)
        if slower.peak_power_w is not None and slower.peak_acceleration_mm_s2 is not None:
            found.append(OtherMechanism(slower.name, slower.peak_power_w, slower.peak_acceleration_mm_s2))
    return found


def frontier_csv(found: Frontier, beside: SoughtMachine) -> str:
    """One line for each cap on the power; empty cells where nothing was found."""
    rows = [
        {
            "power_cap_w": point.cap_w,
            "limit_acceleration_mm_s2": point.limit_mm_s2,
            "law_power_w": point.law.peak_power_w,
            "law_acceleration_mm_s2": point.law.peak_acceleration_mm_s2,
            "law_tangent_deg": degrees(point.law.tangent_rad),
            "family_power_w": family.peak_power_w,
            "family_acceleration_mm_s2": family.peak_acceleration_mm_s2,
        }
        for point, family in points_of(found)
    ]
    return rows_text(tuple(in_units_of(rows[0], beside)), (list(row.values()) for row in rows))


def points_of(found: Frontier) -> list[tuple[LawPoint, FamilyPoint]]:
    """Each point of a law with the point of the family at the same cap."""
    families = {point.cap_w: point for point in found.families}
    return [(point, families[point.cap_w]) for point in found.laws]


def frontier_figures(found: Frontier, beside: SoughtMachine) -> dict[str, Any]:
    """The points with all figures of the laws, and the other mechanisms."""
    return {
        "design": beside.design.name,
        "speed_rpm": beside.design.operation.speed_rpm,
        "masses": None if beside.task.masses is None else asdict(beside.task.masses),
        "argument_of_limit": ARGUMENT,
        "points": [
            in_units_of(
                {
                    "power_cap_w": point.cap_w,
                    "limit_acceleration_mm_s2": point.limit_mm_s2,
                    "law": summary_of(point.law, beside),
                    "gap": None if beside.soft else point.law.peak_acceleration_mm_s2 / point.limit_mm_s2 - 1.0,
                    "family_power_w": family.peak_power_w,
                    "family_acceleration_mm_s2": family.peak_acceleration_mm_s2,
                    "family_motion": family.motion,
                },
                beside,
            )
            for point, family in points_of(found)
        ],
        "mechanisms": [in_units_of(vars(mechanism), beside) for mechanism in other_mechanisms(beside)],
    }


def flywheel_csv(found: Sequence[FlywheelPoint]) -> str:
    """One line for each size of the flywheel on the driven shaft."""
    rows = [
        {
            "flywheel_kg_mm2": point.flywheel_kg_mm2,
            "limit_power_w": point.limit_w,
            "law_power_w": point.law.peak_power_w,
            "law_braking_power_w": point.law.braking_power_w,
            "law_acceleration_mm_s2": point.law.peak_acceleration_mm_s2,
            "law_tangent_deg": degrees(point.law.tangent_rad),
        }
        for point in found
    ]
    return rows_text(tuple(rows[0]), (list(row.values()) for row in rows))


def flywheel_figures(found: Sequence[FlywheelPoint], design: Design) -> dict[str, Any]:
    """The points with all figures of the laws."""
    return {
        "design": design.name,
        "speed_rpm": design.operation.speed_rpm,
        "knots": KNOTS,
        "argument_of_limit": ARGUMENT,
        "points": [
            {
                "driven_flywheel_kg_mm2": point.flywheel_kg_mm2,
                "limit_power_w": point.limit_w,
                "law": figures_summary(point.law),
                "gap": point.law.peak_power_w / point.limit_w - 1.0 if point.limit_w > 0.0 else None,
            }
            for point in found
        ],
    }
