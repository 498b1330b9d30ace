"""The answers of a simulation at each level, from its figures."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain
from typing import Any

from ncgear.dynamics.level import Level
from ncgear.figures.advice.verdict import Verdict
from ncgear.figures.answers.answer import Answer, Row, difference, faults_of, row
from ncgear.figures.answers.machine import THIS, head_of
from ncgear.figures.numbers import PLACE, figure, name_of, to_digits
from ncgear.figures.simulated import SAME_AS_MESH
from ncgear.figures.strong import decided_words
from ncgear.figures.summary.check_summary import uniform_key
from ncgear.project.drive import Drive

LEVELS = {
    Level.RIGID: "Torques and forces of rigid bodies, constant driving speed",
    Level.QUASI_STATIC: "Teeth that yield under their load, constant driving speed",
    Level.DYNAMIC: "The motion in time, with teeth that yield, knock and part",
}
"""What each level computes."""

AFTER = {
    Level.RIGID: "ncgear simulate {file} --level quasi_static",
    Level.QUASI_STATIC: "ncgear simulate {file} --level dynamic",
    Level.DYNAMIC: "ncgear strength {file}",
}
"""What to run after each level, where the design has gears."""

COMPARED = (
    "peak_driving_torque_n_m",
    "least_driving_torque_n_m",
    "peak_power_w",
    "braking_power_w",
    "mean_power_w",
    "peak_power_resistance_w",
    "energy_swing_j",
    "inertia_for_speed_fluctuation_kg_m2",
    "peak_mesh_force_n",
)
"""What is told of both machines at the rigid level, besides the peaks of forces in joints."""

IN_BAND = ("peak_tooth_force_n", "peak_depth_mm", "transmission_error_rad")
LOADED = ("peak_driving_torque_n_m", "most_pairs", "contact_ratio_mean", "contact_ratio_min")
"""What is told of loaded teeth: with the band of their stiffness, and without; pairs in series leave no room for it."""

MOVED = (
    "peak_pushing_force_n",
    "peak_back_force_n",
    "partings_of_pushing_flanks",
    "time_with_pushing_flanks_apart_s",
    "losses_of_contact",
    "time_without_contact_s",
)
"""What is told of each pair in the motion in time, besides the output, the bearings and the driving torque."""


def simulated_answer(drive: Drive, level: Level, figures: Mapping[str, Any], verdict: Verdict, file: str) -> Answer:
    """What a simulation of a design ``file`` found; ``figures`` are all of it."""
    heads, about = tuple[str, ...](), LEVELS[level]
    match level:
        case Level.RIGID:
            uniform = uniform_key(drive)
            own, other = figures["this_design"], figures[uniform]
            heads = THIS, drive.linkage.UNIFORM
            about += _changing_flanks(drive, own)
            rows = [*_compared(own, other, drive.design.stages), *_around(figures.get("drivetrain", {}))]
        case Level.QUASI_STATIC:
            loaded, band = figures["loaded_contact"], figures["band_of_stiffness"]
            beside = [*band.values()] if drive.design.stages == 1 else []
            heads = "as computed", *(f"stiffness x {band['stiffness_factor']:g}" for band in beside)
            rows = [Row(name_of(key), tuple(_of_all(level, key) for level in (loaded, *beside))) for key in IN_BAND]
            rows += [Row(name_of(key), (_of_all(loaded, key),)) for key in LOADED] + _not_followed(band)
        case Level.DYNAMIC:
            moved = figures["motion_in_time"]
            output, bearings = figures[drive.linkage.OUTPUT.name.replace(" ", "_")], figures["bearings"]
            rows = [row(key, value) for key, value in output.items() if not key.endswith(PLACE)]
            rows += [Row(name_of(key), (_of_all(moved, key),)) for key in MOVED]
            rows += [row("peak_driving_torque_n_m", moved["peak_driving_torque_n_m"])]
            rows += [row(key, value) for key, value in bearings.items() if not key.endswith(PLACE)]
            rows += _not_followed(figures["band_of_stiffness"])
    if level is not Level.RIGID and drive.design.stages > 1:
        about += f"; teeth of {drive.design.stages_said[0]}, from the driving shaft on"
    return Answer(
        head_of(drive),
        tuple(rows),
        faults_of(verdict),
        about,
        heads=heads,
        good=verdict.good,
        not_judged=verdict.not_judged,
        then=AFTER[level].format(file=file) if drive.design.gears is not None else "",
    )


def _of_all(found: Mapping[str, Any], key: str) -> str:
    """A figure of the whole, or else of each pair in series; empty where there is neither."""
    told = [found] if key in found else found.get("pairs", [])
    return ", ".join(figure(key, level[key]) for level in told)


def _not_followed(band: Mapping[str, Any]) -> list[Row]:
    """What is said of a band of stiffness that could not be computed to one side."""
    return [
        Row("band", (f"with {level['stiffness_factor']:g} times their stiffness the teeth cannot be followed",))
        for level in band.values()
        if "not_followed" in level
    ]


def _changing_flanks(drive: Drive, own: Mapping[str, Any]) -> str:
    """What the forces of the law leave out where teeth change their flanks."""
    changes = len(own["flank_changes_deg"])
    if drive.design.gears is None or not changes:
        return ""
    return f"; without knocks where the load changes flanks, {changes} times a cycle (ncgear strength)"


def _compared(own: Mapping[str, Any], other: Mapping[str, Any], pairs: int) -> list[Row]:
    """Rows of both machines; forces of more than two pairs, for which a screen is too small, in a line of each kind."""
    together = {}
    if pairs > 2:
        last, *meshes = (key for key in own if key.startswith("peak_") and key.endswith("mesh_force_n"))
        together = {
            "mesh forces": [*meshes, last],
            "bearing forces": [key for key in own if key.endswith("bearing_force_n")],
        }
    told = {*COMPARED, SAME_AS_MESH}
    joints = [key for key in own if key.startswith("peak_") and key.endswith("_force_n") and key not in told]
    keys = [key for key in (*COMPARED, *joints) if key in own and key not in chain(*together.values())]
    rows = [_beside(key, own[key], other.get(key)) for key in keys]
    said = {name: ", ".join(figure(key, own[key]) for key in of) for name, of in together.items()}
    return [*rows, *(Row(name, (f"at most {text}, from the driving shaft on",)) for name, text in said.items())]


def _beside(key: str, own: float, other: float | None) -> Row:
    """A figure of both machines; of a torque that brakes, which has a sign, no difference is told."""
    told = "" if other is None or own < 0.0 or other < 0.0 else difference(own, other)
    return Row(name_of(key), (figure(key, own), figure(key, other), told))


def _around(found: Mapping[str, Any]) -> list[Row]:
    """What stands around the gears: losses, and the shortest life, the least safety and the motor's load."""
    if not found:
        return []
    losses, power = found["losses"], "mean_power_with_tooth_friction_w"
    named = {name.replace("_", " "): shaft for name, shaft in found.items() if "shaft" in name}
    shafts = [*named.values()]
    bearings = [bearing for shaft in shafts for name, bearing in shaft.items() if name.startswith("bearing")]
    lives = [bearing["life_h"] for bearing in bearings if bearing["life_h"] is not None]
    strong = [shaft["estimate_of_shaft"] for shaft in shafts if "estimate_of_shaft" in shaft]
    strong += [shaft["jam"] for shaft in shafts if "jam" in shaft]
    safeties = [part[key] for part in strong for key in ("fatigue_safety", "yield_safety") if part.get(key) is not None]
    said = [f"bearings last {figure('life_h', min(lives))} or more"] if lives else []
    said += [f"shaft safety {figure('safety', min(safeties))}"] if safeties else []
    if "motor" in found:
        turning = found["motor"].get("with_flywheel", found["motor"]["even_speed"])
        said.append(f"motor at {to_digits(turning['rms_torque_of_rated'], 3)} of its torque")
    efficiency = f"{figure('efficiency', losses['efficiency'])}, {name_of(power)} {figure(power, losses[power])}"
    decided = {
        f"{name} {part.replace('_', ' ')}": load
        for name, shaft in named.items()
        for part, load in shaft.get("decided_by", {}).items()
    }
    return [
        Row("efficiency", (efficiency,)),
        *([Row("drivetrain", (", ".join(said),))] if said else []),
        *([Row("decided", (decided_words(decided, "parts"),))] if set(decided.values()) - {"law"} else []),
    ]
