"""The answers about strength: whether teeth hold, and the smallest gears that do."""

from __future__ import annotations

from collections.abc import Sequence
from math import radians
from typing import Any, Literal

from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.reading.text import whole
from ncgear.design.rewritten import told_copy
from ncgear.design.words import listed
from ncgear.figures import strong
from ncgear.figures.advice.drivetrain_advice import around
from ncgear.figures.advice.values import Advice, Kind, Remedy, changed, in_file
from ncgear.figures.advice.verdict import State, Verdict
from ncgear.figures.answers.answer import Answer, Fault, Row, faults_of, told_once
from ncgear.figures.answers.machine import gear_rows
from ncgear.figures.flanks import hours_words, surfaces_rows, vibration_of_rating, vibration_words
from ncgear.figures.numbers import figure, known, name_of, shown, teeth_words, to_digits
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.figures import figures_of
from ncgear.project.sizing import Sized, may_be_narrower, stated_inertias
from ncgear.project.strengthening import HELIX_DEG, Rating, largest_thrust_n
from ncgear.project.worn import Worn
from ncgear.strength.holding import Damage, worst

HOLD_NOT = "The teeth do not hold: these are under the wanted safety, the weakest first"


def strength_answer(
    pairs: Sequence[tuple[Drive, Rating, Sequence[Remedy], Rating | None, Sequence[Worn]]],
    verdict: Verdict,
    then: str = "",
) -> Answer:
    """Whether the teeth of all pairs hold: each with its rating, its remedies, the rating of another method, and worn.

    ``verdict`` is that on the whole machine; its other warnings follow.
    """
    drive, first, _, beside, _ = pairs[0]
    heads = [f"{head.label}, {head.unit}" if head.unit else head.label for head in strong.HEADS[2:]]
    if beside is not None:
        heads.insert(1, f"by {beside.strength.method}")
    rows, weak, worn_out, lasting, about = [], list[tuple[float, Fault]](), list[Fault](), list[Row](), list[Row]()
    for pair, rating, remedies, other, worn in pairs:
        rows += _rows(pair.of, rating, other)
        cures = [remedy.brief for remedy in remedies]
        under = sorted((weakest for weakest in rating.weakest if not weakest.holds), key=lambda weakest: weakest.share)
        for weakest in under:
            what = f"{pair.of}{weakest.gear.value} gear, {weakest.damage.words}: {teeth_words(weakest.too_weak)}"
            # Each remedy helps all teeth of its pair
            weak.append((weakest.share, Fault(what, tuple(cures) if weakest is under[0] else ())))
        about += _about(pair, rating)
        lasting += [Row(f"{pair.of}{name}", (words,)) for name, words in worn_rows(pair, worn)]
        worn_out += [] if under else [Fault(f"{pair.of}{fault}") for fault in worn_fault(worn)]
    design = drive.design
    faults = [*told_once(fault for _, fault in sorted(weak, key=lambda ranked: ranked[0])), *worn_out]
    others = faults_of(verdict.without(Kind.STRENGTH))
    judged = all(row.state is not State.NOT_JUDGED for row in verdict.rows if row.kind is Kind.STRENGTH)
    held = strong.holding_words(wears=any(rating.strength.wears for _, rating, *_ in pairs), judged=judged)
    return Answer(
        f"{design.name}: strength of the teeth at {design.operation.speed_rpm:g} r/min",
        # What was asked for stays where a screen is too small
        (*lasting, *rows, Row("method", (strong.METHODS[first.strength.method].partition(",")[0],)), *about),
        (*faults, *others),
        f"Load: {strong.load_words(drive, first.strength)}",
        heads=tuple(heads),
        good=f"{held} {verdict.good}",
        wrong=HOLD_NOT if faults else f"{held} Other warnings",
        not_judged=verdict.not_judged,
        then=then if faults else "",
    )


def _rows(of: str, rating: Rating, beside: Rating | None) -> list[Row]:
    found = []
    for place, weakest in enumerate(rating.weakest):
        gear, damage, *cells = strong.weakest_cells(weakest, rating.strength.wears)
        if beside is not None:
            cells.insert(1, to_digits(beside.weakest[place].safety, 3))
        found.append(Row(f"{of}{gear}, {damage}", tuple(cells)))
    return found


def _about(drive: Drive, rating: Rating) -> list[Row]:
    loading, strength, error = rating.loading, rating.strength, "transmission_error_rad"
    told, force = vibration_of_rating(drive, rating), figure("force_n", strength.peak_pair_n)
    under_load = "not judged, because only a jam presses the teeth"
    if loading.contact_ratio:
        off = f"{name_of(error)} {figure(error, loading.transmission_error_rad)}"
        under_load = f"contact ratio {shown(loading.contact_ratio)}, {off}"
    joints = (
        f"{name_of(key)} {figure(key, most)} by {strong.DECIDING[load]}"
        for key, (most, load) in strong.deciding_forces(drive).items()
    )
    # What lowers the safeties most is told where a screen is too small for all
    rows = [
        ("jam", strong.jam_words(drive, rating)),
        ("material", strong.materials_words(drive, strength)),
        ("force", f"up to {force} on one pair of teeth, times {strong.jolts_words(drive)}"),
        ("face load", strong.face_load_words(drive, rating)),
        *surfaces_rows(drive, drive.surfaces_by(strength.method)),
        ("knocks", strong.knock_words(loading.knocks)),
        ("decided", strong.deciding_words(drive, rating)),
        ("vibration", vibration_words(told) if told else ""),
        ("rim", strong.rim_words(drive, rating)),
        ("teeth", gear_rows(drive)["teeth"]),
        ("under load", under_load),
        ("joints", ", ".join(joints)),
    ]
    return [Row(f"{drive.of}{name}", (words,)) for name, words in rows if words]


def _helical_words(first: Sized, herringbone: Sized | Literal["none", False]) -> str:
    """What a helix does for the first gears: herringbone teeth that were found, or the offer to look for them."""
    if herringbone == "none":
        return "no herringbone teeth that are narrower were found, or none can be made"
    if herringbone:
        keys = ", ".join(map(str, changed(herringbone.changes)))
        return f"herringbone teeth that are {herringbone.face_width_mm:g} mm wide do: {keys}"
    if not may_be_narrower(first):
        return ""
    angle = HELIX_DEG[0]
    thrust = to_digits(largest_thrust_n(first.drive, first.rating, radians(angle)), 2)
    return (
        f"may do with less width: --herringbone finds how much less, without thrust; helical teeth of {angle:g} deg "
        f"thrust up to {thrust} N along the shafts"
    )


def sized_answer(
    found: Sequence[Sized],
    then: str = "",
    left_out: Sequence[str] = (),
    herringbone: Sized | Literal["none", False] = False,
) -> Answer:
    """The smallest gears that hold, one row each, as ``in_order`` puts them, and the keys of the first.

    ``left_out`` are the keys of the file that hold what follows from its own gears; ``herringbone`` are the first gears
    with herringbone teeth, where these were looked for.
    """
    first = found[0]
    smaller = any(sized.volume_mm3 < first.volume_mm3 for sized in found)
    design, strength, lead = first.drive.design, first.rating.strength, first.drive.told_face_load_by("estimate")
    wanted = dict.fromkeys(f"{weakest.wanted:g} against {weakest.damage.words}" for weakest in first.rating.weakest)
    failing = dict[Advice, list[str]]()
    for sized in (*found, *([herringbone] if isinstance(herringbone, Sized) else [])):
        for told in parts_that_fail(sized):
            failing.setdefault(told, []).append(f"{sized.module_mm:g}")
    faults = [
        Fault(f"module {listed(modules, 'and')} mm: {told.what}", tuple(remedy.brief for remedy in told.remedies))
        for told, modules in failing.items()
    ]
    return Answer(
        f"{design.name}: the smallest gears that hold at {design.operation.speed_rpm:g} r/min, by the estimate",
        (
            *(Row(f"module {cells[0]} mm", tuple(cells[1:])) for cells in map(sized_row, found)),
            Row("material", (strong.materials_words(first.drive, strength),)),
            Row("wanted", (f"safeties of {listed(wanted, 'and')}",)),
            Row("first", (", ".join(map(str, in_file(design, changed(first.changes)))),)),
            *(
                [Row("order", ("what stands around smaller gears does not hold, so they come last",))]
                if smaller
                else []
            ),
            *([Row("lead", (strong.better_lead_words(lead),))] if lead else []),
            *([Row("helix", (helix,))] if (helix := _helical_words(first, herringbone)) else []),
            *([Row("left out", (f"{listed(left_out, 'and')}: of other gears",))] if left_out else []),
        ),
        tuple(faults),
        f"Load: {strong.load_words(first.drive, strength)}",
        heads=SIZED,
        good="",
        wrong="The gears hold; around them this does not",
        then=then,
    )


SIZED = ("teeth", "width, mm", "centres, mm", "diameter, mm", "breakage", "pitting", "weakest")
"""Heads of the smallest gears: sizes, least safeties, the weakest tooth."""


def worn_figures(drive: Drive, found: Sequence[Worn]) -> dict[str, Any]:
    """A section for each time, with the keys of new gears; ``ended`` says why no gears are left."""
    place = drive.linkage.OUTPUT.place
    told: dict[str, Any] = {}
    for worn in found:
        section: dict[str, Any] = {"worn_h": worn.hours, "depth_max_mm": worn.depth_mm, "backlash_mm": worn.backlash_mm}
        if worn.rating is None:
            section["ended"] = worn.why
        else:
            free = {f"free_way_{place.ending}": place.factor * worn.free} if worn.free else {}
            strength = worn.rating.strength
            least = {
                f"{damage.value}_safety_min": known(most) for damage, most in strong.least_safeties(strength).items()
            }
            section |= free | strong.knock_figures(worn.rating.loading.knocks)
            section |= {"peak_tooth_force_n": strength.peak_pair_n, **least}
        told[f"after_{round(worn.hours)}_h"] = section
    return {"worn": told}


def worn_rows(drive: Drive, found: Sequence[Worn]) -> list[tuple[str, str]]:
    """The same in a line for each time."""
    output, rows = drive.linkage.OUTPUT, list[tuple[str, str]]()
    for worn in found:
        words = f"{to_digits(worn.depth_mm, 2)} mm off the flanks, backlash {to_digits(worn.backlash_mm, 2)} mm, "
        if worn.rating is None:
            words += f"no gears any more: {worn.why}"
        else:
            free, knocks = to_digits(output.place.factor * worn.free, 2), strong.knock_words(worn.rating.loading.knocks)
            words += f"{output.name} free by {free} {output.place.text}; up to " if worn.free else "up to "
            words += f"{figure('force_n', worn.rating.strength.peak_pair_n)} on one pair of teeth, safety "
            words += strong.least_words(worn.rating.strength) + (f"; knocks {knocks}" if knocks else "")
        rows.append((f"after {hours_words(worn.hours)}", words))
    return rows


def worn_fault(found: Sequence[Worn]) -> list[str]:
    """When worn gears are under a wanted safety first, and which one; empty where they never are."""
    for worn in found:
        if worn.rating is None:
            return [f"worn away after {hours_words(worn.hours)}: {worn.why}"]
        least = min(worn.rating.weakest, key=lambda weak: weak.share)
        if not least.holds:
            safety = f"safety {to_digits(least.safety, 3)}, {least.wanted:g} wanted"
            return [f"worn for {hours_words(worn.hours)}, {least.gear.value} gear, {least.damage.words}: {safety}"]
    return []


SUFFIX = "-sized"


def sized_row(sized: Sized) -> list[str]:
    """The texts: module, teeth, face width, centre distance, diameter, both safeties, the weakest tooth."""
    size, weak = sized.drive.pitch.size, worst(sized.rating.weakest)
    least = [
        min((each.safety for each in sized.rating.weakest if each.damage is damage), default=None) for damage in Damage
    ]
    return [
        f"{size.module_mm:g}",
        f"{size.driving_teeth}:{size.driven_teeth}",
        f"{sized.face_width_mm:g}",
        shown(round(size.center_distance_mm, 2)),
        shown(round(sized.diameter_mm, 1)),
        *("-" if safety is None else to_digits(safety, 3) for safety in least),
        f"{weak.gear.value} {weak.tooth}",
    ]


def parts_that_fail(sized: Sized) -> list[Advice]:
    """What of shafts, keys, bearings and couplings around the gears does not hold with them."""
    if sized.drive.design.drivetrain is None:
        return []
    return [told for told in around(sized.drive) if isinstance(told, Advice) and told.matters]


def in_order(found: Sequence[Sized]) -> list[Sized]:
    """The smallest gears first around which all holds, then the others, each in their order."""
    return sorted(found, key=lambda sized: bool(parts_that_fail(sized)))


def sized_figures(found: Sequence[Sized], herringbone: Sized | None = None) -> dict[str, Any]:
    """The smallest gears that hold as plain values whose keys end in their unit, in their order.

    Then those with herringbone teeth, if there are any.
    """
    first = found[0]
    design, rating = first.drive.design, first.rating
    wanted = strong.of_weakest(rating, lambda weakest: {"safety_wanted": weakest.wanted})
    materials = {
        gear.value: {"material": rating.strength.of(gear).material.name, **wanted[gear.value]} for gear in Gear
    }
    return {
        "design": {"name": design.name, "description": design.description},
        "load": {"speed_rpm": design.operation.speed_rpm},
        **materials,
        "smallest": [_sizes(sized) for sized in found],
        **({"herringbone": _sizes(herringbone)} if herringbone else {}),
    }


def _sizes(sized: Sized) -> dict[str, Any]:
    return {
        **figures_of(sized.drive, "module_mm", "teeth_driving", "teeth_driven", "face_width_mm", "center_distance_mm"),
        "largest_diameter_mm": sized.diameter_mm,
        "strength": strong.strength_summary(sized.rating, sized.drive),
        "parts_that_fail": [told.what for told in parts_that_fail(sized)],
        "keys": dict(sized.changes),
    }


def sized_design(loaded: LoadedDesign, sized: Sized, asked: dict[str, float | str]) -> str:
    """The text of a design file with other gears and with what was asked for, its name and description saying so."""
    design = loaded.design
    chosen = {
        key: whole(value) if isinstance(value, float) else value for key, value in (asked | sized.changes).items()
    }
    keys = listed(map(str, in_file(design, changed(chosen))), "and")
    said = f"Sized: {design.name} with {keys}, so that its teeth hold."
    values = {**chosen, **dict.fromkeys(stated_inertias(design))}
    return told_copy(loaded, SUFFIX, said, {design.key_in_file(key) or key: value for key, value in values.items()})
