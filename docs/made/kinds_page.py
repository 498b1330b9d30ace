"""The page of kinds by capabilities: each cell is tried on a small design of the kind, and says what came of it.

A cell is ``yes`` where the capability was computed to its end, and else the number of the refusal's words below.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

from ncgear.balance.gears import mesh_body
from ncgear.design.reading.design_file import parsed
from ncgear.drawings.scene.scene import scene_of
from ncgear.errors import DesignError
from ncgear.figures.summary.check_summary import check_summary
from ncgear.figures.tables import markdown
from ncgear.kinematics.check import kinematic_check
from ncgear.mechanisms.mechanism import require_rod
from ncgear.project.best_law import BestLaw
from ncgear.project.drive import Drive
from ncgear.screening.single import single_figures

NAME = "kinds.md"

Data = dict[str, Any]

BODY = {"bore_mm": 12}
GEARS = {"teeth": 38, "module_mm": 2, "face_width_mm": 15, "driving": BODY, "driven": BODY}
OPEN_GEARS = {"module_mm": 2, "center_distance_mm": 80, "face_width_mm": 15, "driving": BODY, "driven": BODY}
RATIO = {"law": "harmonic_ratio", "cosine": [0.1]}
SPIRAL = {"law": "spiral", "range_deg": 160, "ratio_start": 1.3, "ratio_end": 0.8}
CURVE = {"law": "pitch_curve", "ellipse": {"semi_major_mm": 40, "semi_minor_mm": 36, "axis_x_mm": 6}}
CRANK = {"crank": {"mass_kg": 2, "center_mm": 10, "inertia_kg_mm2": 4000}, "driving_gear_kg_mm2": 900}
ROD = {"mass_kg": 1, "center_mm": 60, "inertia_kg_mm2": 3000}
SWINGING = {"mass_kg": 2, "center_mm": 45, "inertia_kg_mm2": 9000}
SLIDING: Data = {
    "resistance": {"polynomial_n": [300, 2]},
    "returning": {"polynomial_n": [100]},
    "wish": {"time_ratio": {"at_least": 0.5}},
}
TURNING: Data = {
    "resistance": {"expression_n_m": "8 + sin(x)"},
    "returning": {"polynomial_n_m": [3]},
    "wish": {"time_ratio": {"at_least": 0.5}},
}

KINDS: dict[str, Data] = {
    "crank-slider": {
        "linkage": {"crank_mm": 40, "rod_mm": 150},
        "masses": {"slider_kg": 5, "rod": ROD, **CRANK},
        **SLIDING,
    },
    "Scotch yoke": {
        "linkage": {"kind": "scotch_yoke", "crank_mm": 40},
        "masses": {"slider_kg": 5, **CRANK},
        **SLIDING,
    },
    "slotted lever": {
        "linkage": {"kind": "slotted_lever", "crank_mm": 40, "pivot_mm": 110, "lever_mm": 230},
        "masses": {"slider_kg": 5, "lever": SWINGING, **CRANK},
        **SLIDING,
    },
    "crank-rocker": {
        "linkage": {"kind": "crank_rocker", "crank_mm": 40, "coupler_mm": 130, "rocker_mm": 90, "ground_mm": 140},
        "masses": {"rocker": SWINGING, "coupler": ROD, **CRANK},
        **TURNING,
    },
    "gears by themselves": {"masses": {"shaft_kg_mm2": 9000, "driving_gear_kg_mm2": 900}, **TURNING},
    "a pitch curve and its mate": {
        "motion": CURVE,
        "gears": {"teeth": 38, "face_width_mm": 15, "driving": BODY, "driven": BODY},
        "masses": {"shaft_kg_mm2": 9000, "driving_gear_kg_mm2": 900},
        **TURNING,
    },
    "gears that turn less than once": {
        "motion": SPIRAL,
        "gears": OPEN_GEARS,
        "masses": {"shaft_kg_mm2": 9000, "driving_gear_kg_mm2": 900},
        **TURNING,
    },
    "rack and pinion": {
        "linkage": {"kind": "rack_pinion", "radius_mm": 25},
        "motion": SPIRAL,
        "gears": OPEN_GEARS,
        "masses": {"slider_kg": 5, **CRANK},
        **SLIDING,
    },
}
"""Of each kind what differs, the load of its output, its masses and a wish; the rest is the same for all."""


def tried(kind: str, *sections: str, gears: Data | None = None) -> Drive:
    """The drive of a kind with the named sections, and keys of ``gears`` besides; raises DesignError."""
    own = deepcopy(KINDS[kind])
    data: Data = {"name": "tried", "operation": {"speed_rpm": 60}, "motion": own.get("motion", RATIO)}
    if "linkage" in own:
        data["linkage"] = own["linkage"]
    data["gears"] = {**own.get("gears", GEARS), **(gears or {})}
    for section in sections:
        if section == "returning":
            data["resistance"] = {**own["resistance"], "returning": own["returning"]}
        elif section == "wish":
            data["wishes"] = own["wish"]
        elif section == "optimize":
            data["optimize"] = {"goal": "least_acceleration"}
        else:
            data[section] = own[section]
    if "masses" in sections:
        data["simulation"] = {"turns": 0.02}
    loaded = parsed(json.dumps(data), Path("tried.yaml"))
    return Drive(loaded.design, loaded=loaded)


def _built(drive: Drive) -> None:
    _ = drive.contact_extremes, drive.solids


def _shown(drive: Drive) -> None:
    drive.require_sound_pairs()
    scene_of(drive)


def _wished(drive: Drive) -> None:
    if not drive.motion_wishes:
        raise AssertionError("the wish is not there")


CAPABILITIES: dict[str, Callable[[str], object]] = {
    "check": lambda kind: check_summary(tried(kind)),
    "build: teeth, contact, solids": lambda kind: _built(tried(kind)),
    "report and animation": lambda kind: _shown(tried(kind)),
    "sweep": lambda kind: single_figures(tried(kind).design),
    "load on the output": lambda kind: kinematic_check(tried(kind, "resistance").machine),
    "load on its way back": lambda kind: kinematic_check(tried(kind, "returning").machine),
    "strength of the teeth": lambda kind: tried(kind, "resistance").strength,
    "strength of helical teeth": lambda kind: (
        tried(kind, "resistance", gears={"helix": {"angle_deg": 10, "kind": "helical", "hand": "right"}}).strength
    ),
    "forces with masses": lambda kind: tried(kind, "resistance", "masses").rigid,
    "teeth under load": lambda kind: tried(kind, "resistance", "masses").loaded_contact,
    "motion in time": lambda kind: tried(kind, "resistance", "masses").course,
    "wishes of the motion": lambda kind: _wished(tried(kind, "wish")),
    "best law with its limit": lambda kind: BestLaw(tried(kind, "optimize").design).bound,
    "balance of the gears": lambda kind: mesh_body(tried(kind).solids.driving.triangles, 7850.0),
    "balance of the mechanism": lambda kind: require_rod(tried(kind).linkage, "balance", "linkage"),
    "helical teeth": lambda kind: _built(
        tried(kind, gears={"helix": {"angle_deg": 10, "kind": "helical", "hand": "right"}})
    ),
    "pressure angles of both sides": lambda kind: _built(
        tried(kind, gears={"rack": {"pressure_angle_deg": 22, "idle_pressure_angle_deg": 19}})
    ),
    "profile shift of each tooth": lambda kind: _built(
        tried(kind, gears={"profile_shift": {"per_tooth": [0.05, *[0.0] * 18]}})
    ),
}
"""What is tried of a kind, by its words."""


def row(kind: str) -> dict[str, str]:
    """By capability ``yes``, or the words of the refusal."""
    found = {}
    for words, run in CAPABILITIES.items():
        try:
            run(kind)
            found[words] = "yes"
        except DesignError as refused:
            found[words] = f"{refused.key}: {refused.problem}".splitlines()[0] if refused.key else refused.problem
    return found


INTRODUCTION = """\
# Kinds by capabilities

<!-- Made by `make docs`: every cell is tried on a small design of its kind. -->

What ncgear offers for which kind of mechanism, law and gears. Each cell was computed to its end on a small design, or
has the number of the words with which it was refused.
"""


def kinds_page() -> str:
    """The page, from trying every cell."""
    rows = {kind: row(kind) for kind in KINDS}
    words = list(dict.fromkeys(cell for cells in rows.values() for cell in cells.values() if cell != "yes"))
    numbers = {cell: f"[{number}](#refusals)" for number, cell in enumerate(words, start=1)}
    table = markdown(
        ["", *KINDS],
        [[name, *(numbers.get(rows[kind][name], "yes") for kind in KINDS)] for name in CAPABILITIES],
    )
    refusals = [f"{number}. {cell}" for number, cell in enumerate(words, start=1)]
    return "\n".join([INTRODUCTION, *table, "", "## Refusals", "", *refusals, ""])
