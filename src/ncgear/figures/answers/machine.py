"""The answers about one machine and its gears: what a check and a build found, and the facts at the top of a report."""

from __future__ import annotations

from math import pi
from operator import itemgetter

from ncgear.design.words import COUNTS
from ncgear.figures.advice.law_advice import speeds
from ncgear.figures.advice.verdict import Verdict
from ncgear.figures.answers.answer import COLUMNS, INDENT, Answer, Row, difference, faults_of, in_one_line, row
from ncgear.figures.numbers import figure, labelled, name_of, shown, to_digits
from ncgear.figures.summary.check_summary import comparison_rows, masses_note, stages_summary
from ncgear.figures.wished import motion_facts, wish_line, wish_rows
from ncgear.kinematics.check import peak_figures
from ncgear.numerics.units import CM3_PER_MM3, label_and_unit
from ncgear.project.drive import Drive
from ncgear.project.figures import figures_of
from ncgear.project.rough_strength import beside_refusal, rough_damage
from ncgear.project.strengthening import Rating, known_rating
from ncgear.ratio.transmission import Transmission

Facts = list[tuple[str, str]]
"""Names of figures and their texts with units."""

WISHES = 4
"""Wishes that are told one by one, the missed ones first."""

PUBLISHED = 2
"""Published mechanisms that are told."""

THIS = "this design"


def check_answer(drive: Drive, verdict: Verdict, file: str, notes: tuple[str, ...] = ()) -> Answer:
    """What a check found; ``verdict`` is what it can judge, ``file`` what a build of it is given."""
    then = f"ncgear build {file}" if drive.design.gears is not None else "give gears in the file: ncgear explain gears"
    rows = *_published(drive), *_solved(drive), *_motion(drive), *_ratios(drive)
    return _answer(drive, rows, verdict, then, notes)


def build_answer(drive: Drive, verdict: Verdict, then: str, notes: tuple[str, ...] = ()) -> Answer:
    """What a build found; ``verdict`` is the verdict on all pairs, ``then`` is what to do next."""
    return _answer(
        drive, (*_gears_of_all(drive), *_published(drive), *_motion(drive), *_ratios(drive)[:1]), verdict, then, notes
    )


def _answer(drive: Drive, rows: tuple[Row, ...], verdict: Verdict, then: str, notes: tuple[str, ...]) -> Answer:
    return Answer(
        head_of(drive),
        (*compared_rows(drive), *rows),
        faults_of(verdict),
        in_one_line(drive.design.description),
        notes,
        (THIS, drive.linkage.UNIFORM),
        verdict.good,
        not_judged=verdict.not_judged,
        then=then,
    )


def head_of(drive: Drive) -> str:
    """What a design is: its name, mechanism, law, stroke and speed."""
    design, linkage = drive.design, drive.linkage
    place, turns = linkage.OUTPUT.place, design.operation.speed_rpm
    moved = [figure("speed_rpm", turns)]
    if linkage.RETURNS:
        strokes = shown(turns * 2.0 * pi / drive.transmission.cycle_rad)
        driven = [moved[0]] if strokes != shown(turns) else []
        stroke = f"stroke {shown(place.factor * linkage.stroke_mm)} {place.text}"
        moved = [stroke, f"{strokes} strokes a minute", *driven]
    mechanism = linkage.NAME.removeprefix("a ").removeprefix("the ")
    stages = f" in {COUNTS[design.stages]} stages" if design.stages > 1 else ""
    return f"{design.name}: {', '.join([mechanism + stages, *moved, f'law {design.motion.law}'])}"


IN_FULL = ("rms_torque_n_m", "energy_swing_j")
"""Figures of power that only --verbose, JSON and a simulation tell."""


def compared_rows(drive: Drive) -> list[Row]:
    """The peaks of the machine beside the peaks of the same machine with an even crank, at equal driving speed."""
    returns = drive.linkage.RETURNS
    own, uniform = (peak_figures(check, returns=returns) for check in (drive.check, drive.uniform_check))
    powered = _is_powered(drive)
    rows = [
        Row(name_of(key), (*row(key, own[key], uniform[key]).texts, difference(own[key], uniform[key])))
        for key in own
        if not key.endswith("_at_rad") and key not in IN_FULL and (powered or not key.endswith("_power_w"))
    ]
    # Where the largest acceleration is in the working stroke, its own row would say the same once more.
    texts = [row.texts for row in rows]
    told = [row for place, row in enumerate(rows) if row.texts not in texts[place + 1 :]]
    return [*told, *(Row(name, (text,)) for name, text in _masses(drive))]


def _masses(drive: Drive) -> Facts:
    return [("masses", note)] if (note := masses_note(drive)) else []


def _published(drive: Drive) -> list[Row]:
    found = [
        design for design in comparison_rows(drive)[2:] if design["same_speed"] and design["peak_power_w"] is not None
    ]
    own = drive.check.peak_power_resistance_w.value
    alone, rows = " of the resistance alone" if drive.check.with_masses else "", []
    for design in found[:PUBLISHED]:
        power = design["peak_power_w"]
        text = f"{name_of('peak_power_w')} {figure('peak_power_w', power)} at equal speed; this design's{alone}"
        rows.append(Row(in_one_line(str(design["name"]), 24), (f"{text}: {difference(own, power)}",)))
    return rows


def _solved(drive: Drive) -> list[Row]:
    """The quantity of a stroke that was solved for, and the law's velocities where the machine has another speed."""
    if drive.law.stroke is None or "solved_for" not in drive.law.stroke.facts:
        return []
    facts = {**drive.law.stroke.facts, "law_speed_rpm": drive.law_speed_rpm}
    words, remark = str(facts["solved_for"]).replace("_", " "), speeds(drive)
    held = "" if remark is None else f"; {remark.what}"
    found = {key: value for key, value in facts.items() if label_and_unit(key)[0] == words}
    return [Row("solved for", (f"{name_of(key)} {figure(key, value)}{held}",)) for key, value in found.items()]


def _motion(drive: Drive) -> list[Row]:
    """What the motion achieves, and of its wishes the missed ones first."""
    found = drive.achieved
    if found is None:
        return []
    rows = [Row(name, (text,)) for name, text in motion_facts(found, drive.linkage)]
    wishes = sorted(wish_rows(found), key=lambda wish: bool(wish["kept"]))
    told = wishes if len(wishes) <= WISHES else wishes[: WISHES - 1]
    # Where a line has no room for it, by how much a wish is missed follows from what is wished
    lines = (
        line if len(line) <= COLUMNS - len(INDENT) else line.partition(", missed by ")[0]
        for line in map(wish_line, told)
    )
    rows += [Row("", (line,)) for line in lines]
    if len(told) < len(wishes):
        rows.append(Row("", (f"of all {len(wishes)} wishes {sum(wish['kept'] for wish in wishes)} are kept",)))
    return rows


def _ratios(drive: Drive) -> list[Row]:
    """The ratio; where there are pairs in series, also the ratio and the greatest pressure angle of each pair."""
    rows, key = [Row("ratio", (_ratio(drive.transmission),))], "max_pressure_angle_deg"
    stages = stages_summary(drive).get("stages", {})
    if len(stages) > FEW_STAGES:
        ranges = [f"{to_digits(pair['ratio_min'], 3)} to {to_digits(pair['ratio_max'], 3)}" for pair in stages.values()]
        rows.append(Row("ratio of each pair", ("; ".join(ranges),)))
        angles = [to_digits(pair[key], 3) for pair in stages.values() if key in pair]
        if angles:
            rows.append(Row(name_of(key), (f"{', '.join(angles)} deg, pair by pair",)))
        return rows
    for stage, pair in stages.items():
        angle = f", {name_of(key)} {figure(key, pair[key])}" if key in pair else ""
        ratio = f"ratio {shown(pair['ratio_min'])} to {shown(pair['ratio_max'])}"
        rows.append(Row(stage.replace("_", " "), (ratio + angle,)))
    return rows


FEW_STAGES = 2
"""Most pairs of which each has rows of its own: more of them would fill a screen."""


def _ratio(transmission: Transmission) -> str:
    low, high = transmission.ratio_range
    return f"{shown(low.value)} to {shown(high.value)}"


OF_GEARS = (
    *("module_mm", "face_width_mm", "center_distance_mm"),
    *("max_pressure_angle_deg", "contact_ratio_mean", "contact_ratio_min"),
)
"""The main figures of a pair of gears."""

TOGETHER = {
    "teeth": (name_of("module_mm"), name_of("face_width_mm")),
    name_of("center_distance_mm"): (name_of("max_pressure_angle_deg"),),
    name_of("contact_ratio_mean"): (name_of("contact_ratio_min"),),
}
"""Facts of gears that are told in one row, behind the first."""


def _gears(drive: Drive) -> list[Row]:
    found, rows = safeties(drive), gear_rows(drive)
    if found is not None:
        held = [f"{safety} against {damage} ({wanted} wanted)" for damage, safety, wanted in found]
        rows = {"safety": ", ".join(held) or "not judged", **rows}
    return [Row(drive.of + name, (text,)) for name, text in rows.items()]


def _gears_of_all(drive: Drive) -> list[Row]:
    """The rows of each pair; of many pairs the least safety of all and what they have alike are told once."""
    if len(drive.by_stage) <= FEW_STAGES:
        return [gear for pair in drive.by_stage for gear in _gears(pair)]
    rows = [Row("safety", (told,)) for told in [_least_safety(drive)] if told]
    each = [gear_rows(pair) for pair in drive.by_stage]
    for name in each[0]:
        if len({of[name] for of in each}) == 1:
            rows.append(Row(name, (each[0][name],)))
        else:
            rows += [Row(pair.of + name, (of[name],)) for pair, of in zip(drive.by_stage, each, strict=True)]
    return rows


def _least_safety(drive: Drive) -> str:
    """The least safety of all pairs against each kind of damage with its pair; empty where no load is known."""
    least: dict[str, tuple[float, str]] = {}
    for number, pair in enumerate(drive.by_stage, 1):
        found = safeties(pair)
        if found is None:
            return ""
        if not found:
            return "not judged of every pair"
        for damage, safety, wanted in found:
            share = float(safety.removeprefix("about ")) / float(wanted)
            said = share, f"{safety} against {damage} in stage {number} ({wanted} wanted)"
            least[damage] = min(least.get(damage, said), said)
    return ", ".join(said for _, said in least.values())


def gear_rows(drive: Drive) -> dict[str, str]:
    """The main figures of a pair of gears, those that belong together in one text."""
    facts, rows = dict(gear_facts(drive)), dict[str, str]()
    for first, others in TOGETHER.items():
        more = [f"{name.removeprefix(f'{first}, ')} {facts.pop(name)}" for name in others]
        rows[first] = ", ".join([facts.pop(first), *more])
    return rows | facts


def safeties(drive: Drive) -> list[tuple[str, str, str]] | None:
    """The least safety against each kind of damage, in words, and the one wanted; rough ones are "about" so much.

    Empty where it cannot be judged, None where no load is known.
    """
    rating = known_rating(drive)
    if isinstance(rating, Rating):
        told = [
            (weakest.damage.words, weakest.share, to_digits(weakest.safety, 3), weakest.wanted)
            for weakest in rating.weakest
        ]
    else:
        found = beside_refusal(drive, rating)
        if found is None:
            return None
        if not found.safeties or found.needs_teeth:
            return []
        told = [
            (
                rough_damage(found, safety),
                safety.safety / safety.wanted,
                f"about {to_digits(safety.safety, 2)}",
                safety.wanted,
            )
            for safety in found.safeties
        ]
    least = [
        min((safety for safety in told if safety[0] == damage), key=itemgetter(1)) for damage, *_ in dict.fromkeys(told)
    ]
    return [(damage, safety, f"{wanted:g}") for damage, _, safety, wanted in dict.fromkeys(least)]


def machine_facts(drive: Drive) -> Facts:
    """The main figures of a machine; the peak power where the design has a resistance or masses."""
    linkage, place, peaks = drive.linkage, drive.linkage.OUTPUT.place, peak_figures(drive.check)
    moved = {"speed_rpm": drive.design.operation.speed_rpm}
    if linkage.RETURNS:
        moved[f"stroke_{place.ending}"] = place.factor * linkage.stroke_mm
    powers = ("peak_power_w", "peak_power_resistance_w") if _is_powered(drive) else ()
    power = {key: peaks[key] for key in powers if key in peaks}
    acceleration = f"peak_acceleration_cycle_{linkage.OUTPUT.acceleration.ending}"
    moving = [("law", drive.design.motion.law.replace("_", " ")), *labelled(moved)]
    loaded = [*labelled(power), *_masses(drive), *labelled({acceleration: peaks[acceleration]})]
    return [*moving, ("ratio", _ratio(drive.transmission)), *loaded]


def _is_powered(drive: Drive) -> bool:
    """Whether anything takes power: without resistance and masses none is told."""
    return drive.design.resistance is not None or drive.check.with_masses is not None


def gear_facts(drive: Drive) -> Facts:
    """The main figures of a pair of gears."""
    size = drive.pitch.size
    facts = [("teeth", f"{size.driving_teeth} : {size.driven_teeth}"), *labelled(figures_of(drive, *OF_GEARS))]
    if (pumped := drive.pumped) is not None:
        facts.append(("displacement", f"{figure('per_turn_cm3', CM3_PER_MM3 * pumped.per_turn_mm3)} a turn"))
        facts += labelled({"pulsation_percent": 100.0 * pumped.pulsation})
    return facts
