"""Random designs of gears with deep laws: ratios that swing far and often, on few teeth and on many."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

Data = dict[str, Any]

LOBES = ((1, 1), (1, 1), (2, 2), (1, 2), (2, 1), (3, 1), (1, 3), (2, 3), (4, 1))
"""Lobes of the driving and the driven gear."""

GRID = np.linspace(0.0, 2.0 * pi, 720, endpoint=False)


def _waves(rng: np.random.Generator) -> tuple[list[int], list[float], list[float]]:
    """Orders, sizes and phases of one to four waves, whose sum comes down to between -0.9 and -0.15."""
    orders = sorted(rng.choice(np.arange(1, 7), size=rng.integers(1, 5), replace=False).tolist())
    sizes, phases = rng.uniform(-1.0, 1.0, len(orders)) / np.array(orders), rng.uniform(0.0, 2.0 * pi, len(orders))
    lowest = sum(a * np.sin(n * GRID + p) for n, a, p in zip(orders, sizes, phases, strict=True)).min()
    sizes *= rng.uniform(0.15, 0.9) / -lowest
    return orders, [float(f"{one:.4f}") for one in sizes], [float(f"{one:.3f}") for one in phases]


def _motion(rng: np.random.Generator, driving: int, driven: int) -> Data:
    """A law of as many lobes: mostly waves as ratio or as its logarithm, or an ellipse; shapes have one lobe."""
    kind = rng.integers(0, 8)
    if kind == 0:
        return {"law": "ellipse", "eccentricity": float(f"{rng.uniform(0.1, 0.75):.4f}")}
    if kind == 1:
        sides = int(rng.integers(3, 7))
        corner = float(f"{rng.uniform(2.0, 25.0):.2f}")
        shape = {"sides": sides, "side_mm": 100.0, "corner_radius_mm": corner}
        return {"law": "pitch_curve", "rounded_polygon": shape, "solve_for": "scale"}
    if kind == 2:
        return {"law": "pitch_curve", "points": _traced(rng), "solve_for": "scale"}
    waves = " + ".join(f"{a}*sin({n * driving}*phi + {p})" for n, a, p in zip(*_waves(rng), strict=True))
    form = f"1 + {waves}" if kind < 6 else f"exp({waves})"
    return {"law": "ratio_expression", "ratio": f"{driven}/{driving}*({form})", "scale_to_close": True}


def _traced(rng: np.random.Generator) -> Data:
    """A wavy round outline as a picture gives it: points that are some tenths of a millimetre off."""
    angle = np.linspace(0.0, 2.0 * pi, int(rng.integers(40, 160)), endpoint=False)
    radius = 40.0 + rng.normal(0.0, float(rng.choice([0.01, 0.1])), angle.size)
    for order, size, phase in zip(*_waves(rng), strict=True):
        radius += 12.0 * size * np.sin(order * angle + phase)
    points = np.round(radius * np.array([np.cos(angle), np.sin(angle)]), 2)
    tolerance = float(rng.choice([0.02, 0.1, 0.3]))
    return {"x_mm": points[0].tolist(), "y_mm": points[1].tolist(), "tolerance_mm": tolerance}


def deep_design(number: int) -> Data:
    """The design with a number, the same at each call."""
    rng = np.random.default_rng([number, 20])
    driving, driven = LOBES[rng.integers(0, len(LOBES))]
    motion = _motion(rng, driving, driven)
    if motion["law"] == "pitch_curve":
        driving = driven = 1
    rack: Data = {"pressure_angle_deg": float(rng.choice([14.5, 20.0, 20.0, 25.0]))}
    if rng.random() < 0.2:
        rack["addendum"] = float(rng.choice([0.6, 0.8, 1.2]))
    gears: Data = {
        "teeth": driving * int(rng.integers(8, 90) // driving + 1),
        "module_mm": float(rng.choice([1.0, 2.0, 3.0])),
        "face_width_mm": 10.0,
        "lobes": {"driving": driving, "driven": driven},
        "rack": rack,
        "undercut": str(rng.choice(["avoid", "allow", "allow"])),
        "least_contact_ratio": float(rng.choice([0.0, 1.0])),
    }
    if rng.random() < 0.2:
        gears["profile_shift"] = {"driving": float(rng.choice([-0.4, 0.4]))}
    if rng.random() < 0.15:
        gears["cutter"] = {"kind": str(rng.choice(["mate", "rack", "pinion"]))}
    if rng.random() < 0.2:
        gears["drives"] = "both_ways"
    return {"name": "deep", "operation": {"speed_rpm": 60.0}, "motion": motion, "gears": gears}
