"""What is told of the strength of teeth: figures, a table with a row for each gear and tooth, and a screen of text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from math import degrees, inf, isfinite
from typing import Any

import numpy as np

from ncgear.design.keys.machine import NoLinkage
from ncgear.design.words import listed
from ncgear.drivetrain.jam import Load, deciding
from ncgear.dynamics.driven_side import Knock
from ncgear.dynamics.rigid import LoadPeaks
from ncgear.figures import flanks
from ncgear.figures.advice.verdict import Verdict
from ncgear.figures.numbers import figure, fixed, known, to_digits
from ncgear.figures.simulated import SAME_AS_MESH, force_figures
from ncgear.figures.summary.check_summary import stages_summary, verdict_summary
from ncgear.figures.tables import Table, columns_of, rows_text
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.face_load import FaceLoading, ToldFaceLoad
from ncgear.project.strengthening import Rating, deciding_loads
from ncgear.strength.answer import Strength
from ncgear.strength.conditions import GRADE
from ncgear.strength.holding import Damage, Weakest, lives_of
from ncgear.strength.surfaces import Film

LOADS = {
    "masses": "the machine with its masses{jam}, at constant driving speed",
    "resistance": "the resistance{alone}: no masses are given, so forces of inertia are not counted",
    "row": "the torque at the last gear; every mesh passes on its power",
    "jam": "a jam alone: nothing else that is given loads the teeth",
}
"""The words for what a load follows from, without a jam beside it or with one."""


def load_words(drive: Drive, strength: Strength) -> str:
    """What the load of the teeth follows from."""
    jam = " and a jam" if drive.conditions.overload else ""
    gears = drive.design.gears
    alone = strength.load == "resistance" and isinstance(drive.design.linkage, NoLinkage)
    by = "row" if alone and gears is not None and gears.idlers is not None else strength.load
    return LOADS[by].format(jam=jam, alone=jam or " alone")


METHODS = {
    "estimate": "local estimate after ISO 6336 and VDI 2736, which cover circular gears, on the outline of each tooth",
    "elements": "plane finite elements, on the outline of each tooth; a local estimate for what the material endures",
}
"""The words for a method, the name of it before the first comma, and how far the standards cover it."""

ERRORS = {
    "estimate": "finite elements find 0.9 to 1 times these root stresses on regular teeth, 0.7 to 1.3 times on "
    "undercut ones",
    "elements": "root stresses within 2 % of finer meshes; thin rims and what loaded teeth do to their neighbours are "
    "left out",
}
"""The words for the errors that were measured (docs/method.md, tests/test_elements.py)."""


def strength_figures(drive: Drive, rating: Rating, verdict: Verdict, beside: Rating | None = None) -> dict[str, Any]:
    """The figures of a strength as sections of plain values whose keys end in their unit.

    A life is None where the tooth lasts for ever, or until it is worn.  ``verdict`` is that on the pair and what
    it is part of, ``beside`` that on the teeth by another method, to compare with.
    """
    strength, loading, contacts = rating.strength, rating.loading, rating.strength.contacts.of_pairs()
    most, decided = int(np.argmax(contacts.force_n)), deciding_loads(drive, rating)
    loads = {
        "speed_rpm": drive.design.operation.speed_rpm,
        "peak_tooth_force_n": float(contacts.force_n[most]),
        "peak_tooth_force_at_rad": float(contacts.phi1_rad[most]),
        "contact_ratio_under_load_mean": loading.contact_ratio or None,
        "transmission_error_under_load_rad": loading.transmission_error_rad if loading.contact_ratio else None,
        **knock_figures(loading.knocks),
        **_jam_figures(drive, rating),
        "decided_by": {f"{gear.value}_{damage.value}": load for (gear, damage), load in decided.items()},
        **_force_figures(drive),
    }
    told = drive.told_face_load_by(rating.strength.method)
    found = {
        "design": {"name": drive.design.name, "description": drive.design.description},
        **stages_summary(drive),
        "load": loads,
        "gears": {"module_mm": drive.pitch.size.module_mm, "face_width_mm": drive.gears.face_width_mm},
        "strength": strength_summary(rating, drive),
        **flanks.surfaces_figures(drive.surfaces_by(strength.method)),
        "face_load": (
            {**asdict(told), "rigid_bearings": drive.face_loading.rigid_bearings} if told is not None else {}
        ),
        "vibration": flanks.vibration_figures(flanks.vibration_of_rating(drive, rating)),
    }
    if beside is not None:
        found["strength_beside"] = strength_summary(beside, drive)
    weakest = of_weakest(rating, _stress_and_life)
    for gear, rim in zip(Gear, drive.rims, strict=True):
        material = strength.of(gear).material
        made_of = {"material": material.name, "source": material.source, "rim_factor_max": float(rim.factor.max())}
        found[gear.value] = {**made_of, **weakest[gear.value]}
    return found | verdict_summary(verdict)


DECIDING: dict[Load, str] = {
    "law": "what the law asks",
    "knocks": "knocks",
    "swings": "swings of the driven side on its teeth",
    "jam": "the jam",
}
"""The words for the load under which a part is the weakest."""


def deciding_words(drive: Drive, rating: Rating) -> str:
    """The same in a line; empty where there is nothing beside the law."""
    found = deciding_loads(drive, rating)
    if not rating.loading.knocks and drive.conditions.overload is None and set(found.values()) == {"law"}:
        return ""
    return decided_words({f"{gear.value} {damage.words}": load for (gear, damage), load in found.items()}, "rows")


def decided_words(found: Mapping[str, Load], parts: str) -> str:
    """By which load each of the ``parts`` is decided, in a line."""
    by = Counter(found.values())
    (most, _), *others = by.most_common()
    if not others:
        return f"by {DECIDING[most]}, in all {parts}"
    named = [
        f"{listed([part for part in found if found[part] == load], 'and')} by {DECIDING[load]}" for load, _ in others
    ]
    return f"{', '.join(named)}; all other {parts} by {DECIDING[most]}"


def deciding_forces(drive: Drive) -> dict[str, tuple[float, Load]]:
    """The largest forces of meshes, joints and bearings of law, knocks and jam, by their keys, each with its load.

    Empty where there are neither knocks nor a jam, and without masses, where the forces of the law are not known.
    """
    beside = _peaks_beside_the_law(drive)
    if not beside:
        return {}
    found = {load: force_figures(drive.linkage, peaks) for load, peaks in beside.items()}
    found = {"law": force_figures(drive.linkage, drive.rigid.peaks), **found}
    sizes = {
        key: {load: float(of[key]) for load, of in found.items()}
        for key in found["law"]
        if key.endswith("_force_n") and key != SAME_AS_MESH
    }
    return {key: (max(of.values()), deciding(of)) for key, of in sizes.items()}


def _peaks_beside_the_law(drive: Drive) -> dict[Load, LoadPeaks]:
    """The peaks of knocks and of a jam, as far as there are any; none without masses."""
    found: dict[Load, LoadPeaks] = {}
    if drive.design.masses is not None and drive.knocking_peaks is not None:
        found["knocks"] = drive.knocking_peaks
    if drive.design.masses is not None and drive.jam is not None:
        found["jam"] = drive.jam.peaks()
    return found


def _force_figures(drive: Drive) -> dict[str, Any]:
    """The forces in joints and bearings with knocks and in a jam, and which load makes the largest."""
    names = {"knocks": "with_knocks", "jam": "in_jam"}
    told = {names[load]: force_figures(drive.linkage, of) for load, of in _peaks_beside_the_law(drive).items()}
    decided = {key.removesuffix("_n"): load for key, (_, load) in deciding_forces(drive).items()}
    return {**told, "forces_decided_by": decided} if told else {}


def knock_figures(knocks: Sequence[Knock] | None) -> dict[str, Any]:
    """How often teeth knock in a turn of the driven gear, and how fast where they do it fastest."""
    if knocks is None:
        return {"knocks": None}
    fastest = max(knocks, key=lambda knock: knock.speed_mm_s, default=None)
    told = {} if fastest is None else {"knock_max_mm_s": fastest.speed_mm_s, "knock_max_at_rad": fastest.phi1_rad}
    return {"knocks": len(knocks), **told}


def jolts_words(drive: Drive) -> str:
    """The application factor, and whether anybody gave it."""
    assumed = "" if "application_factor" in drive.design.strength.model_fields_set else ", assumed"
    return f"an application factor of {drive.conditions.application_factor:g}{assumed}"


def _jam_figures(drive: Drive, rating: Rating) -> dict[str, Any]:
    """The torque of a jam, how often it comes, and the least safeties under it alone; empty without a jam."""
    jam, jammed = drive.conditions.overload, drive.judged_teeth(rating.strength.method).jammed
    if jam is None or jammed is None:
        return {}
    told = {"driving_torque_n_m": N_M_PER_N_MM * jam.driving_n_mm, "times": jam.times}
    least: dict[str, Any] = {
        gear.value: {f"{damage.value}_safety_min": life.safety_min for damage, life in lives_of(jammed, gear).items()}
        for gear in Gear
    }
    return {"jam": {**told, "peak_tooth_force_n": jammed.peak_pair_n, **least}}


def jam_words(drive: Drive, rating: Rating) -> str:
    """What the teeth bear in a jam, and how safely; empty without a jam."""
    jam, jammed = drive.conditions.overload, drive.judged_teeth(rating.strength.method).jammed
    if jam is None or jammed is None:
        return ""
    torque, force = figure("torque_n_m", N_M_PER_N_MM * jam.driving_n_mm), figure("force_n", jammed.peak_pair_n)
    return (
        f"{torque} at the driving shaft, {jam.times:g} times: up to {force} on one pair of teeth, safety "
        f"{least_words(jammed)}; the table has what is worse"
    )


def least_safeties(strength: Strength) -> dict[Damage, float]:
    """The least safety of both gears for each kind of damage."""
    least = dict[Damage, float]()
    for damage, life in (life for gear in Gear for life in lives_of(strength, gear).items()):
        least[damage] = min(life.safety_min, least.get(damage, inf))
    return least


def least_words(strength: Strength) -> str:
    """The same in words."""
    found = least_safeties(strength).items()
    return ", ".join(f"{to_digits(safety, 3)} against {damage.words}" for damage, safety in found)


def rim_words(drive: Drive, rating: Rating) -> str:
    """By how much thin walls raise the stresses at the weakest roots; empty where these have thick ones."""
    found = []
    rims = dict(zip(Gear, drive.rims, strict=True))
    for weakest in rating.weakest:
        rim, row = rims[weakest.gear], weakest.tooth - 1
        if weakest.damage is Damage.BENDING and rim.factor[row] > 1.0:
            wall, raised = to_digits(float(rim.wall_mm[row]), 2), to_digits(float(rim.factor[row]), 3)
            found.append(
                f"{wall} mm under tooth {weakest.tooth} of the {weakest.gear.value} gear, stress times {raised}"
            )
    return f"thin wall of {'; '.join(found)}" if found else ""


def knock_words(knocks: Sequence[Knock] | None) -> str:
    """How often and how fast teeth knock; empty where they do not, or where nobody knows."""
    if not knocks:
        return ""
    fastest = max(knocks, key=lambda knock: knock.speed_mm_s)
    speed, place = figure("knock_mm_s", fastest.speed_mm_s), _degrees(fastest.phi1_rad)
    return f"{len(knocks)} in a turn of the driven gear, at up to {speed} at phi1 = {place} deg"


ALIKE = 0.01
"""Share by which a crowning or an end relief has to lower the factor that it is told."""


def face_load_words(drive: Drive, rating: Rating) -> str:
    """How unevenly teeth bear along their width, and whether that is given, assumed or computed."""
    loading, told = drive.face_loading, drive.told_face_load_by(rating.strength.method)
    if told is None:
        factor = f"factor {to_digits(loading.constant, 3)}"
        return f"{factor} as given" if loading.basis == "given" else f"{factor}, assumed since {loading.why}"
    names = "factor_min", "factor_max", "decisive_factor", "decisive_factor_by_shafts"
    least, greatest, decisive, by_shafts = (to_digits(getattr(told, name), 3) for name in names)
    grade = "" if drive.design.tolerances else f", grade {GRADE} assumed"
    return (
        f"computed: {decisive} at tooth {told.decisive_tooth}, phi1 = {_degrees(told.decisive_factor_at_rad)} deg, "
        f"most loaded, {by_shafts} if not askew{grade}; {least} to {greatest} of all; "
        f"{better_lead_words(told)}{_rigid_words(loading)}"
    )


def better_lead_words(told: ToldFaceLoad) -> str:
    """The crowning and the end relief that lower the factor most, each by itself, with the factor."""
    ends = f"end relief {told.best_end_relief_um:g} \u00b5m over {to_digits(told.best_end_relief_length_mm, 3)} mm"
    forms = {
        f"crowning {told.best_crowning_um:g} \u00b5m": told.best_crowning_factor,
        ends: told.best_end_relief_factor,
    }
    better = [
        f"{form}: {to_digits(factor, 3)}"
        for form, factor in forms.items()
        if factor < (1.0 - ALIKE) * told.decisive_factor
    ]
    return ", ".join(better) or "no other crowning or end relief is better"


def _rigid_words(loading: FaceLoading) -> str:
    names, count = loading.rigid_bearings, "counts" if len(loading.rigid_bearings) == 1 else "count"
    return f"; without static_rating_n, {listed(names, 'and')} {count} as rigid" if names else ""


def strength_summary(rating: Rating, drive: Drive) -> dict[str, Any]:
    """The method, the load, and the least safeties of both gears with the numbers of their teeth.

    ``face_load_factor`` belongs to the place that bears the largest force for each mm of width.
    """
    strength = rating.strength
    return {
        "method": strength.method,
        "load": strength.load,
        "face_load": drive.face_loading.basis,
        "face_load_factor": strength.stresses.decisive_face_load(strength.contacts),
        **of_weakest(rating, lambda weakest: {"safety_min": weakest.safety, "tooth": weakest.tooth}),
    }


def of_weakest(rating: Rating, told: Callable[[Weakest], dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Figures of the weakest teeth by gear; their keys begin with the kind of damage."""
    found: dict[str, dict[str, Any]] = {gear.value: {} for gear in Gear}
    for weakest in rating.weakest:
        found[weakest.gear.value] |= {f"{weakest.damage}_{key}": value for key, value in told(weakest).items()}
    return found


def _stress_and_life(weakest: Weakest) -> dict[str, Any]:
    """What is told of a weakest tooth beside its safety."""
    return {
        "safety_wanted": weakest.wanted,
        "stress_mpa": weakest.stress_mpa,
        "stress_at_rad": weakest.phi1_rad,
        "endured_mpa": weakest.endured_mpa,
        "life_h": known(weakest.life_h),
        "too_weak_teeth": sorted(weakest.too_weak),
    }


OF_TOOTH = ("stress_mpa", "phi1_rad", "safety", "life_h")
"""The columns of each kind of damage."""


def strength_csv(strength: Strength, film: Film | None) -> str:
    """A row for each gear and tooth, with the place of its thinnest film.

    Cells are empty where a safety or a life is without end or nothing is known.
    """
    rows: list[list[object]] = []
    for gear in Gear:
        lives = lives_of(strength, gear)
        films = flanks.film_of_teeth(film, gear)
        for row in range(lives[Damage.BENDING].safety.size):
            of_kinds = [(lives.get(kind), name) for kind in Damage for name in OF_TOOTH]
            cells = (known(float(getattr(life, name)[row])) if life else None for life, name in of_kinds)
            rows.append([gear.value, row + 1, *cells, *films.get(row + 1, [None] * len(flanks.FILM))])
    return rows_text(("gear", "tooth", *(f"{kind}_{name}" for kind in Damage for name in OF_TOOTH), *flanks.FILM), rows)


def life_words(hours: float, wears: bool = False) -> str:
    """Hours of life, to two digits, or the words for none and for no end of it, which teeth that wear have."""
    if not isfinite(hours):
        return "until worn" if wears else "no end"
    return flanks.hours_words(hours)


def materials_words(drive: Drive, strength: Strength) -> str:
    """The materials of both gears, once where they are the same, whether they are assumed, and which run too hot."""
    hot = [
        f"; the {gear.value} gear runs at {fixed(hot_c, 0)} \u00b0C, too hot for its material"
        for gear in Gear
        if (hot_c := strength.of(gear).material.too_hot_c) is not None
    ]
    names = dict.fromkeys((strength.driving.material.name, strength.driven.material.name))
    assumed = ", assumed since gears.material is not given" if drive.gears.material is None else ""
    return " on ".join(names) + assumed + "".join(hot)


HEADS = columns_of("", "", "safety", "wanted", "tooth", "phi1, deg", "stress, MPa", "endured, MPa", "life")
"""Columns of the table of weakest teeth."""


def weakest_table(drive: Drive, rating: Rating) -> Table:
    """The weakest tooth of each gear for each kind of damage, with notes on load, method and material."""
    strength = rating.strength
    by = METHODS[strength.method], ERRORS[strength.method]
    notes = [load_words(drive, strength), *by, materials_words(drive, strength)]
    surfaces = flanks.surfaces_rows(drive, drive.surfaces_by(strength.method))
    notes += [f"{name.capitalize()}: {words}" for name, words in surfaces]
    cells = tuple(weakest_cells(weakest, strength.wears) for weakest in rating.weakest)
    return Table("Weakest teeth", HEADS, cells, tuple(f"{note}." for note in notes))


def weakest_cells(weakest: Weakest, wears: bool) -> tuple[str, ...]:
    """The texts below ``HEADS``; ``wears`` as of the strength."""
    return (
        weakest.gear.value,
        weakest.damage.words,
        to_digits(weakest.safety, 3),
        f"{weakest.wanted:g}",
        str(weakest.tooth),
        _degrees(weakest.phi1_rad),
        to_digits(weakest.stress_mpa, 3),
        to_digits(weakest.endured_mpa, 3),
        life_words(weakest.life_h, wears),
    )


HOLD = "The teeth hold: no safety is under the wanted one."
WEAR = "No tooth breaks: no safety is under the wanted one; dry metal wears."


AS_FOLLOWED = "No safety is under the wanted one, by the loads that are followed."


def holding_words(*, wears: bool, judged: bool) -> str:
    """What is said of teeth that hold, of metal that run dry (``wears``), or whose strength is not judged."""
    return AS_FOLLOWED if not judged else WEAR if wears else HOLD


def _degrees(angle_rad: float) -> str:
    return fixed(degrees(float(angle_rad)), 1)
