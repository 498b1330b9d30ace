"""Designs at random of sizes that people build: about half of them keep every condition of the verdict.

A seed is one design, whoever runs it.  ``ready`` gives the teeth of most of them the backlash that the advice about
jamming calls enough, as a person does who reads it.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from drives import design_of
from ncgear.errors import DesignError
from ncgear.project.drive import Drive
from ncgear.project.tolerance_limits import jamming_of

Data = dict[str, Any]

KINDS = ("crank_slider", "crank_slider", "crank_slider", "crank_slider", "yoke", "rocker", "plain", "ring", "helical")
MODULES = (0.1, 0.3, 0.5, 1.0, 1.5, 2.0, 2.0, 3.0, 4.0, 6.0, 10.0)
MATERIALS = ("C45", "42CrMo4", "42CrMo4", "18CrNiMo7-6", "GJS-600-3", "POM", "PLA-print")

STRESS_N_MM2 = {"POM": 0.6, "PLA-print": 0.4}
"""Tangential force for each mm of module and width that teeth of a material bear with ease; metals bear METAL."""

METAL_N_MM2 = 6.0

FROM_SHORT, FROM_SILENT = 300, 320
"""Seeds from which on designs are spoiled, by short tips and by forces that never act."""


def design(seed: int) -> Data:
    """The design of a seed, as a file's keys."""
    random = np.random.default_rng([83, seed])
    kind = str(random.choice(KINDS))
    lobes = _lobes(random, kind)
    data: Data = {"name": f"clean-{seed}", "operation": {"speed_rpm": _even(random, 10.0, 300.0)}}
    data["gears"] = gears = _gears(random, kind, lobes)
    data["motion"] = _motion(random, lobes, kind)
    radius = gears["module_mm"] * gears["teeth"] / 2.0
    distance = radius * (lobes[1] / lobes[0] + (-1.0 if kind == "ring" else 1.0))
    if kind in ("crank_slider", "ring", "helical"):
        crank = distance * _even(random, 0.3, 0.8)
        data["linkage"] = {"crank_mm": crank, "rod_mm": crank * _even(random, 2.5, 5.0)}
        if random.random() < 0.3:
            data["linkage"]["offset_mm"] = crank * _even(random, -0.5, 0.5)
    elif kind == "yoke":
        data["linkage"] = {"kind": "scotch_yoke", "crank_mm": distance * _even(random, 0.3, 0.8)}
    elif kind == "rocker":
        crank = distance * _even(random, 0.3, 0.6)
        rocker, ground = crank * _even(random, 2.0, 3.0), crank * _even(random, 3.0, 4.0)
        low, high = abs(ground - rocker) + crank, ground + rocker - crank
        coupler = low + (high - low) * _even(random, 0.3, 0.7)
        data["linkage"] = {"kind": "crank_rocker", "crank_mm": crank, "coupler_mm": coupler, "rocker_mm": rocker}
        data["linkage"]["ground_mm"] = ground
    if "linkage" in data and random.random() < 0.8:
        data["fit"] = {"driving_shaft": "ends"}
        if random.random() < 0.3:
            data["fit"]["rod_width_mm"] = 0.1 * distance
    _loaded(random, data, kind, lobes)
    _toleranced(random, data)
    if "linkage" in data and kind != "rocker" and random.random() < 0.15:
        data["wishes"] = {"time_ratio": {"at_least": _even(random, 0.9, 1.15)}}
    _spoiled(np.random.default_rng([84, seed]), data, seed)
    return data


def _spoiled(random: np.random.Generator, data: Data, seed: int) -> None:
    """From FROM_SHORT on tips are so short that many flanks part, from FROM_SILENT on forces never act."""
    if FROM_SHORT <= seed < FROM_SILENT:
        gears = data["gears"]
        gears |= {"least_contact_ratio": 0.0, "rack": {**gears.get("rack", {}), "addendum": _even(random, 0.4, 0.6)}}
        data["output"] = {"chord_tolerance_mm": 1e-4 * gears["module_mm"]}
    elif seed >= FROM_SILENT and "resistance" in data:
        key = "polynomial_n" if "polynomial_n" in data["resistance"] else "polynomial_n_m"
        silent, load = {key: [-1.0], "where_negative": "zero"}, data["resistance"]
        if random.random() < 0.5:
            load["returning"] = silent
        if random.random() < 0.7:
            load |= silent


def ready(seed: int, data: Data | None = None) -> Drive:
    """The drive of a seed; three of four get the backlash that is enough, where it can be told."""
    data = design(seed) if data is None else data
    one = Drive(design_of(data))
    if seed % 4 == 3:
        return one
    try:
        found = jamming_of(one)
    except DesignError:
        return one
    if found.given >= found.enough or not found.fits:
        return one
    return Drive(design_of({**data, "gears": {**data["gears"], "backlash_mm": found.enough}}))


def _even(random: np.random.Generator, low: float, high: float) -> float:
    return float(f"{random.uniform(low, high):.4g}")


def _lobes(random: np.random.Generator, kind: str) -> tuple[int, int]:
    if kind == "ring":
        return 1, int(random.choice([2, 3]))
    return ((1, 1), (1, 1), (1, 1), (2, 2), (1, 2))[int(random.integers(5))]


def _gears(random: np.random.Generator, kind: str, lobes: tuple[int, int]) -> Data:
    module, teeth = float(random.choice(MODULES)), lobes[0] * int(random.integers(24, 60) // lobes[0])
    radius = module * teeth / 2.0
    gears: Data = {
        "teeth": teeth,
        "module_mm": module,
        "face_width_mm": float(f"{module * random.uniform(5.0, 11.0):.3g}"),
        "lobes": {"driving": lobes[0], "driven": lobes[1]},
        "driving_axis_deg": float(random.choice([180.0, 180.0, 90.0, 0.0])),
        "backlash_mm": float(f"{module * random.uniform(0.0, 0.06):.3g}"),
        "driving": {"bore_mm": float(f"{radius * random.uniform(0.2, 0.35):.2g}")},
        "driven": {"bore_mm": float(f"{radius * random.uniform(0.2, 0.35):.2g}")},
    }
    if kind == "ring":
        gears |= {"mesh": "internal", "driven": {"rim_mm": 4.0 * module}}
    if kind == "helical":
        hand, sort = (
            str(random.choice(["left", "right"])),
            str(random.choice(["herringbone", "herringbone", "helical"])),
        )
        gears["helix"] = {"angle_deg": _even(random, 8.0, 20.0), "kind": sort, "hand": hand}
    if random.random() < 0.7:
        gears["material"] = str(random.choice(MATERIALS))
    if random.random() < 0.2:
        gears["rack"] = {"pressure_angle_deg": float(random.choice([14.5, 25.0]))}
    if random.random() < 0.15 and kind != "helical":
        gears["drives"] = "both_ways"
    if random.random() < 0.1:
        gears["profile_shift"] = {"driving": _even(random, -0.3, 0.3)}
    return gears


def _motion(random: np.random.Generator, lobes: tuple[int, int], kind: str) -> Data:
    """A law whose ratio swings by up to a half, now and then by more than gears follow well."""
    middle, swing = (
        lobes[1] / lobes[0],
        float(f"{random.choice([0.1, 0.2, 0.3, 0.5, 0.9]) * random.uniform(0.3, 1):.3g}"),
    )
    swing *= min(1.0, 2.0 / lobes[0]) * (0.4 if kind == "ring" else 1.0)
    form = int(random.integers(6))
    if form == 0 and lobes[0] == lobes[1]:
        return {"law": "uniform_crank"}
    if form == 1 and lobes == (1, 1):
        return {"law": "ellipse", "eccentricity": 0.6 * swing, "phase_deg": _even(random, 0.0, 360.0)}
    if form == 2 and lobes == (1, 1):
        return {"law": "harmonic_ratio", "cosine": [0.5 * swing], "sine": [0.3 * swing, 0.2 * swing]}
    if form == 3:
        wave = f"{swing / (2.0 * lobes[1])!r}*sin({lobes[0]}*phi)"
        return {"law": "ratio_expression", "driven_angle": f"phi*{1.0 / middle!r} - {wave}"}
    if form == 4 and lobes == (1, 1) and kind == "crank_slider":
        phi = np.arange(24) * 15.0
        ratio = 1.0 + 0.6 * swing * np.cos(np.radians(phi)) + 0.2 * swing * np.sin(2.0 * np.radians(phi))
        return {"law": "table", "phi1_deg": phi.tolist(), "ratio": ratio.tolist(), "scale_to_close": True}
    wave = f"{swing!r}*cos({lobes[0]}*phi + {_even(random, 0.0, 6.0)})"
    return {"law": "ratio_expression", "ratio": f"{middle!r}*(1 + {wave})", "scale_to_close": True}


def _loaded(random: np.random.Generator, data: Data, kind: str, lobes: tuple[int, int]) -> None:
    """A resistance of what the teeth bear with ease to a few times of it, and masses in half of all machines."""
    gears = data["gears"]
    module, width, teeth = gears["module_mm"], gears["face_width_mm"], gears["teeth"]
    ease = STRESS_N_MM2.get(gears.get("material", ""), METAL_N_MM2)
    force = ease * module * width * float(10.0 ** random.uniform(-1.0, 0.7))
    radius = module * teeth / 2.0 * lobes[1] / lobes[0]
    torque = float(f"{1e-3 * force * radius:.3g}")
    if random.random() > 0.75:
        return
    if kind == "plain":
        data["resistance"] = {"polynomial_n_m": [torque]}
        return
    if kind == "rocker":
        data["resistance"] = {"polynomial_n_m": [torque], "returning": {"polynomial_n_m": [0.3 * torque]}}
        return
    crank = data["linkage"]["crank_mm"]
    size = float(f"{force * radius / crank:.3g}")
    shape = int(random.integers(4))
    data["resistance"] = (
        {"polynomial_n": [size]},
        {"polynomial_n": [0.3 * size, 0.7 * size / (2.0 * crank)], "returning": {"polynomial_n": [0.2 * size]}},
        {"polynomial_n": [size], "friction_n": 0.1 * size},
        {"polynomial_n": [0.5 * size, -0.4 * size / crank]},
    )[shape]
    if random.random() < 0.5 or kind == "helical":
        return
    omega = data["operation"]["speed_rpm"] * pi / 30.0 * lobes[0] / lobes[1]
    mass = float(f"{size / (1e-3 * crank * omega**2) * random.uniform(0.05, 0.6):.3g}")
    data["masses"] = {"slider_kg": mass, "crank": _link(0.2 * mass, 0.3 * crank), "density_kg_m3": 7850}
    if kind != "yoke":
        data["masses"]["rod"] = _link(0.3 * mass, 0.4 * data["linkage"]["rod_mm"])


def _link(mass: float, center: float) -> Data:
    """A body whose moment of inertia is more than its mass at its centre has, about whatever axis it is counted."""
    return {"mass_kg": mass, "center_mm": center, "inertia_kg_mm2": 1.5 * mass * center**2}


def _toleranced(random: np.random.Generator, data: Data) -> None:
    """Own tolerances, where no grade knows the module and now and then; a band of thickness in some files."""
    gears = data["gears"]
    module = gears["module_mm"]
    fine = 0.01 * module + 0.002
    if module < 0.5 or random.random() < 0.25:
        own = {"single_pitch_mm": 0.5 * fine, "profile_mm": 0.5 * fine, "eccentricity_mm": 0.5 * fine}
        data["tolerances"] = {"center_distance_mm": fine, "driving": own, "driven": own}
    if random.random() < 0.2:
        upper = -float(f"{module * random.uniform(0.0, 0.02):.2g}")
        more = {"tooth_thickness_upper_mm": upper, "tooth_thickness_lower_mm": upper - 0.02 * module}
        if random.random() < 0.5:
            more["center_distance_mm"] = float(f"{random.uniform(1.0, 3.0) * fine:.2g}")
        gears["tolerances"] = more
