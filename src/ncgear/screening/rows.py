"""From the figures of many laws to those of designs, as ``single.py`` has those of one."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees

import numpy as np

from ncgear.design.gears import Gears
from ncgear.design.schema import Design
from ncgear.errors import DesignError, WrongInput
from ncgear.machine.resistance import Resistance
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.pitch.pair import STRAIGHT
from ncgear.pitch.sizing import solved_size
from ncgear.ratio.transmission import Lobes
from ncgear.screening.batches import Kind, sampled
from ncgear.screening.figures import LawFigures, law_figures
from ncgear.screening.samples import Sampled

Row = dict[str, float] | DesignError
"""Figures of a design, or why it cannot be made."""


def rows_of(kind: Kind, designs: Sequence[Design], count: int) -> list[Row | None]:
    """Of each design of a batch; None for those of which the batch is not sure."""
    # What cannot be is computed along, and comes out as numbers that are not finite, of which the batch is not sure.
    with np.errstate(all="ignore"):
        found = sampled(kind, designs, count)
        figures = law_figures(found.samples, lambda displacement_mm: _fitted_n(kind.resistance, displacement_mm))
    sure = np.nonzero(figures.resolved & found.sound)[0]
    rows: list[Row | None] = [None] * len(designs)
    if sure.size:
        speed = np.array([designs[number].operation.speed_rpm for number in sure.tolist()]) * RAD_S_PER_RPM
        columns = {**_law(found, figures, sure), **_check(kind, found, figures, sure, speed)}
        shapes = _shapes(figures, sure)
        for place, number in enumerate(sure.tolist()):
            row = {name: float(column[place]) for name, column in columns.items()}
            shape = {name: float(column[place]) for name, column in shapes.items()}
            rows[number] = _sized(row, shape, designs[number].gears, kind.lobes)
    return rows


def _fitted_n(resistance: Resistance, displacement_mm: Array) -> Array:
    """The curve of the force with its negative stretches, as the exact peak of power has it."""
    return resistance.fitted_n(Jet(displacement_mm.reshape(1, -1))).value.reshape(displacement_mm.shape)


def _law(found: Sampled, figures: LawFigures, sure: IndexArray) -> dict[str, Array]:
    low, high = figures.ranges["ratio"]
    return {
        "drive.law_speed_rpm": found.law_speed_rpm[sure],
        "closure.residual_rad": np.abs(figures.closing_error_rad[sure]),
        "closure.stroke_residual_mm": np.abs(found.stroke_error_mm[sure]),
        "ratio.min": low[sure],
        "ratio.max": high[sure],
    }


def _check(kind: Kind, found: Sampled, figures: LawFigures, sure: IndexArray, speed_rad_s: Array) -> dict[str, Array]:
    stroke, cycle = found.stroke_mm[sure], kind.lobes.driven * kind.lobes.driving_period_rad
    work = kind.resistance.work_n_mm(stroke, float(stroke.max())) / 1000.0
    return {
        "check.peak_power_w": np.maximum(figures.ranges["power"][1][sure], 0.0) * speed_rad_s / 1000.0,
        "check.mean_power_w": work * speed_rad_s / cycle,
        "check.peak_speed_mm_s": figures.largest("velocity")[sure] * speed_rad_s,
        "check.peak_acceleration_working_mm_s2": figures.largest("working_acceleration")[sure] * speed_rad_s**2,
        "check.peak_acceleration_cycle_mm_s2": figures.largest("acceleration")[sure] * speed_rad_s**2,
    }


def _shapes(figures: LawFigures, sure: IndexArray) -> dict[str, Array]:
    """Of the pitch curves, at unit centre distance."""
    ranges = figures.ranges
    return {
        "length": figures.length[sure],
        "tangent_rad": np.arctan(figures.largest("tangent"))[sure],
        "driving_low": ranges["driving_curvature"][0][sure],
        "driving_high": ranges["driving_curvature"][1][sure],
        "driven_low": ranges["driven_curvature"][0][sure],
        "driven_high": ranges["driven_curvature"][1][sure],
    }


def _sized(row: dict[str, float], shape: dict[str, float], gears: Gears | None, lobes: Lobes) -> Row:
    """The row with its pitch curves at their size; the refusal where no teeth fill them."""
    if gears is None:
        return row
    driving_length = shape["length"] * lobes.driving / lobes.driven
    try:
        size = solved_size(driving_length, lobes, gears.teeth, gears.module_mm, gears.center_distance_mm)
    except WrongInput as error:
        return error
    distance = size.center_distance_mm
    return {
        **row,
        "pitch.center_distance_mm": distance,
        "pitch.length_driving_mm": driving_length * distance,
        "pitch.length_driven_mm": shape["length"] * distance,
        "pitch.driving_convex": float(shape["driving_low"] >= -STRAIGHT),
        "pitch.driven_convex": float(shape["driven_low"] >= -STRAIGHT),
        "pitch.min_radius_driving_mm": distance / shape["driving_high"],
        "pitch.min_radius_driven_mm": distance / shape["driven_high"],
        "pitch.max_tangent_angle_deg": degrees(shape["tangent_rad"]),
        "pitch.max_pressure_angle_deg": degrees(shape["tangent_rad"]) + gears.rack.pressure_angle_deg,
    }
