"""The figures of designs: of many from their sampled laws, and of one by the computation of a check and a build.

They are the peaks of the motion, the range of the ratio and the pitch curves of external pairs; both ways give the same
keys.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import degrees, radians

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import Gears
from ncgear.errors import DesignError, WrongInput
from ncgear.mechanisms.resistance import Resistance
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import extremes, integrated, tails
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.optimum.makeable.quantities import driven_curvature, driving_curvature, length_rate, tangent
from ncgear.pitch.pair import STRAIGHT, solved_size
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.tooth_form import RIGHT_ANGLE_DEG, require_pushing_flanks
from ncgear.ratio.transmission import CLOSED, STANDSTILL, Lobes
from ncgear.screening.samples import Kind, Sampled, Samples, sampled

RESOLVED = 1e-12
"""Last coefficients, relative to a quantity's largest value, up to which a law counts as resolved: its least value, a
hundredth of that where the ratio varies by 1:100, still has ten digits (tests/test_screening.py)."""

SEEN = 2
"""Fewest samples of a law on a panel of the force; peaks between two samples make panels that are narrower still."""

Ranges = dict[str, tuple[Array, Array]]


@dataclass(frozen=True, eq=False)
class LawFigures:
    """Figures of n laws, shape (n,) each, per radian of the driving angle and at unit centre distance.

    ``ranges`` has the smallest and largest value of the ratio, the tangent of the pitch curves' inclination, their
    curvatures, the slider's velocity and acceleration over the cycle and over the working stroke, and the power.
    ``length`` is the pitch curves' over one turn of the driven gear, ``resolved`` says whose figures hold.
    """

    ranges: Ranges
    length: Array
    resolved: Mask

    def largest(self, name: str) -> Array:
        """Largest magnitude of a quantity."""
        low, high = self.ranges[name]
        magnitude: Array = np.maximum(-low, high)
        return magnitude


def law_figures(samples: Samples, force_n: Callable[[Array], Array]) -> LawFigures:
    """The figures of laws against a resistance, as a function of displacements in mm (any shape)."""
    working = samples.displacement_mm.shape[1]
    quantities = _quantities(samples, force_n)
    resolved = _resolved(samples, quantities)
    quantities["working_acceleration"] = samples.acceleration[:, :working]
    length = integrated(samples.turning * length_rate(samples.at))
    return LawFigures(_ranges(quantities, samples.there, resolved), length, resolved)


def _quantities(samples: Samples, force_n: Callable[[Array], Array]) -> dict[str, Array]:
    at, working = samples.at, samples.displacement_mm.shape[1]
    return {
        "ratio": at.ratio,
        "tangent": tangent(at),
        "driving_curvature": driving_curvature(at),
        "driven_curvature": driven_curvature(at),
        "velocity": samples.velocity,
        "acceleration": samples.acceleration,
        "power": force_n(samples.displacement_mm) * samples.velocity[:, :working],
    }


def _resolved(samples: Samples, quantities: dict[str, Array]) -> Mask:
    """Which laws are sound and close, with the last coefficients of all quantities and lengths died away."""
    rates = samples.turning * length_rate(samples.at)
    resolved = samples.sound.copy()
    for values in (*quantities.values(), rates, samples.turning):
        there = samples.there[:, : values.shape[1]]
        size = np.where(there, np.abs(values).max(axis=2), 0.0)
        small = tails(values) * size <= RESOLVED * size.max(axis=1, keepdims=True)
        resolved &= (small | ~there).all(axis=1)
    ratio = np.where(samples.there[..., None], samples.at.ratio, samples.at.ratio[:, :1])
    lowest, highest = ratio.min(axis=(1, 2)), ratio.max(axis=(1, 2))
    closed = np.abs(integrated(samples.turning) - 2.0 * np.pi) <= CLOSED
    answer: Mask = resolved & closed & (lowest > 2.0 * STANDSTILL * highest)
    return answer


def _ranges(quantities: dict[str, Array], there: Mask, resolved: Mask) -> Ranges:
    """Smallest and largest value of every quantity over the pieces that are there; zeros for laws not resolved."""
    laws = np.where(resolved[:, None], there, np.arange(there.shape[1]) == 0)
    rows, owners = [], []
    for number, values in enumerate(quantities.values()):
        law, piece = np.nonzero(laws[:, : values.shape[1]])
        rows.append(np.where(resolved[law][:, None], values[law, piece], 0.0))
        owners.append(law + number * len(laws))
    low, high = extremes(np.vstack(rows), np.concatenate(owners))
    lows, highs = (side.reshape(len(quantities), -1) for side in (low, high))
    return {name: (lows[number], highs[number]) for number, name in enumerate(quantities)}


def single_figures(design: Design) -> dict[str, float]:
    """Every figure of a design; raises WrongInput or NoSuchMechanism where it cannot be made."""
    drive = Drive(design)
    low, high = drive.transmission.ratio_range
    check, output = drive.check, drive.linkage.OUTPUT
    speed, acceleration = output.speed.ending, output.acceleration.ending
    figures = {
        "drive.law_speed_rpm": drive.law_speed_rpm,
        "closure.residual_rad": abs(drive.transmission.closure_error_rad),
        **{f"closure.{key}": value for key, value in drive.told_stroke_residual.items()},
        "ratio.min": low.value,
        "ratio.max": high.value,
        "check.peak_power_w": check.peak_power_w.value,
        "check.mean_power_w": check.mean_power_w,
        f"check.peak_speed_{speed}": check.peak_speed.value,
        f"check.peak_acceleration_working_{acceleration}": check.peak_acceleration_working.value,
        f"check.peak_acceleration_cycle_{acceleration}": check.peak_acceleration_cycle.value,
    }
    # With two stages each pair has its own curves, and only a build tells them apart.
    return figures if design.gears is None or design.stages > 1 else {**figures, **_pitch(drive)}


def _pitch(drive: Drive) -> dict[str, float]:
    pitch = drive.pitch
    require_pushing_flanks(pitch, drive.gears.rack)
    return {
        "pitch.center_distance_mm": pitch.center_distance_mm,
        "pitch.length_driving_mm": pitch.length_mm(Gear.DRIVING),
        "pitch.length_driven_mm": pitch.length_mm(Gear.DRIVEN),
        "pitch.driving_convex": float(pitch.convex(Gear.DRIVING)),
        "pitch.driven_convex": float(pitch.convex(Gear.DRIVEN)),
        "pitch.min_radius_driving_mm": pitch.least_radius_mm(Gear.DRIVING),
        "pitch.min_radius_driven_mm": pitch.least_radius_mm(Gear.DRIVEN),
        "pitch.max_tangent_angle_deg": degrees(pitch.largest_tangent_angle_rad.value),
        "pitch.max_pressure_angle_deg": pitch.largest_pressure_angle_deg(radians(drive.gears.carrying_angle_deg)),
    }


Row = dict[str, float] | DesignError
"""Figures of a design, or why it cannot be made."""


def rows_of(kind: Kind, designs: Sequence[Design], count: int) -> list[Row | None]:
    """The row of each design of a batch; None where the batch is not sure of it."""

    def fitted_n(displacement_mm: Array) -> Array:
        """The curve of the force with its negative stretches, as the exact peak of power uses it."""
        return kind.resistance.fitted_n(Jet(displacement_mm.reshape(1, -1))).value.reshape(displacement_mm.shape)

    # Designs that cannot be made give numbers that are not finite, and the batch is not sure of these.
    with np.errstate(all="ignore"):
        found = sampled(kind, designs, count)
        figures = law_figures(found.samples, fitted_n)
    known = figures.resolved & found.sound
    sure = np.nonzero(known & _force_is_seen(kind.resistance, found, known))[0]
    rows: list[Row | None] = [None] * len(designs)
    if sure.size:
        speed = np.array([designs[number].operation.speed_rpm for number in sure.tolist()]) * RAD_S_PER_RPM
        columns = {**_law_of_rows(found, figures, sure), **_check_of_rows(kind, found, figures, sure, speed)}
        shapes = _shapes(figures, sure)
        for place, number in enumerate(sure.tolist()):
            row = {name: float(column[place]) for name, column in columns.items()}
            shape = {name: float(column[place]) for name, column in shapes.items()}
            rows[number] = _sized(row, shape, designs[number].gears, kind.lobes)
    return rows


def _force_is_seen(resistance: Resistance, found: Sampled, known: Mask) -> Mask:
    """Whether every panel of the force's curve holds two samples of the law, so that none hides a peak."""
    displacement, stroke = found.samples.displacement_mm, found.stroke_mm[known]
    if not known.any() or not (panels := resistance.panels_mm(float(stroke.max()))).size:
        return known
    count = np.stack([np.searchsorted(np.sort(row, axis=None), panels) for row in displacement])
    seen: Mask = np.all((np.diff(count, axis=1) >= SEEN) | (panels[1:] > found.stroke_mm[:, None]), axis=1)
    return seen


def _law_of_rows(found: Sampled, figures: LawFigures, sure: IndexArray) -> dict[str, Array]:
    low, high = figures.ranges["ratio"]
    return {
        "drive.law_speed_rpm": found.law_speed_rpm[sure],
        "closure.residual_rad": np.abs(found.closing_error_rad[sure]),
        "closure.stroke_residual_mm": np.abs(found.stroke_error_mm[sure]),
        "ratio.min": low[sure],
        "ratio.max": high[sure],
    }


def _check_of_rows(
    kind: Kind, found: Sampled, figures: LawFigures, sure: IndexArray, speed_rad_s: Array
) -> dict[str, Array]:
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
    """Figures of the pitch curves at unit centre distance."""
    ranges = figures.ranges
    return {
        "length": figures.length[sure],
        "tangent_rad": np.arctan(figures.largest("tangent"))[sure],
        "driving_low": ranges["driving_curvature"][0][sure],
        "driving_high": ranges["driving_curvature"][1][sure],
        "driven_low": ranges["driven_curvature"][0][sure],
        "driven_high": ranges["driven_curvature"][1][sure],
    }


def _sized(row: dict[str, float], shape: dict[str, float], gears: Gears | None, lobes: Lobes) -> Row | None:
    """The row with its pitch curves at their size; the refusal where no teeth fill them.

    None where the pressure angle is too large, which only the exact computation says with its place.
    """
    if gears is None:
        return row
    driving_length = shape["length"] * lobes.driving / lobes.driven
    try:
        size = solved_size(driving_length, lobes, gears.teeth, gears.module_mm, gears.center_distance_mm)
    except WrongInput as error:
        return error
    tangent_deg = degrees(shape["tangent_rad"])
    pressure_deg = tangent_deg + gears.carrying_angle_deg
    if tangent_deg + max(gears.rack.angles_deg) >= RIGHT_ANGLE_DEG:
        return None
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
        "pitch.max_pressure_angle_deg": pressure_deg,
    }
