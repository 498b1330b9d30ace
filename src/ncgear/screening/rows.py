"""The figures of designs: of many from their sampled laws, and of one by the computation of a check and a build.

They are the peaks of the motion, the range of the ratio and the pitch curves of external pairs; both ways give the same
keys.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import degrees, pi, radians

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import SIZES
from ncgear.design.mechanisms import entry_of
from ncgear.errors import DesignError
from ncgear.mechanisms.resistance import Resistance
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import extremes, integrated, integration, sums_at, tails, turning_points
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.optimum.makeable.quantities import driven_curvature, driving_curvature, length_rate, tangent
from ncgear.pitch.pair import AS_STEEP, CONSISTENT, MOST_TEETH, STRAIGHT, refuse_many_teeth, solved_size
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.tooth_form import RIGHT_ANGLE_DEG, require_pushing, require_pushing_flanks
from ncgear.ratio.transmission import CLOSED, STANDSTILL, Lobes
from ncgear.screening.batch import Batch, Kind
from ncgear.screening.samples import Fineness, Sampled, Samples, sampled

RESOLVED = 1e-12
"""Last coefficients, relative to a quantity's largest value, up to which a law counts as resolved: its least value, a
hundredth of that where the ratio varies by 1:100, still has ten digits (tests/test_screening.py)."""

SEEN = 2
"""Fewest samples of a law on a panel of the force; peaks between two samples make panels that are narrower still."""

Ranges = dict[str, tuple[Array, Array]]


ROUNDED_RAD = 1e-9
"""Driving angle that messages round to zero."""


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
    """Which laws close, with the last coefficients of all quantities and lengths died away."""
    rates = samples.turning * length_rate(samples.at)
    resolved = np.ones(len(samples.there), dtype=bool)
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
    """Smallest and largest value of every quantity over the pieces that are there; infinite for laws not resolved."""
    laws = there & resolved[:, None]
    return {name: extremes(values, laws[:, : values.shape[1]]) for name, values in quantities.items()}


def single_figures(design: Design) -> dict[str, float]:
    """Every figure of a design; raises WrongInput or NoSuchMechanism where it cannot be made."""
    drive = Drive(design)
    low, high = drive.transmission.ratio_range
    # With two stages each pair has its own curves, and only a build tells them apart.  Whether teeth can roll on the
    # curves is asked before the peaks of the motion, which take longest.
    pitch = {} if design.gears is None or design.stages > 1 else _pitch(drive)
    check, output = drive.check, drive.linkage.OUTPUT
    speed, acceleration = output.speed.ending, output.acceleration.ending
    return {
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
        **pitch,
    }


PITCH = (
    "pitch.center_distance_mm",
    "pitch.length_driving_mm",
    "pitch.length_driven_mm",
    "pitch.driving_convex",
    "pitch.driven_convex",
    "pitch.min_radius_driving_mm",
    "pitch.min_radius_driven_mm",
    "pitch.max_tangent_angle_deg",
    "pitch.max_pressure_angle_deg",
)
"""Keys of the figures of a pair of pitch curves."""


def figure_names(design: Design) -> tuple[str, ...]:
    """The keys of the figures of a design and of those that differ from it in numbers, in their order."""
    mechanism = entry_of(design.linkage).load()
    output = mechanism.OUTPUT
    stroke = (f"closure.stroke_residual_{output.place.ending}",) if mechanism.RETURNS else ()
    names = (
        "drive.law_speed_rpm",
        "closure.residual_rad",
        *stroke,
        "ratio.min",
        "ratio.max",
        "check.peak_power_w",
        "check.mean_power_w",
        f"check.peak_speed_{output.speed.ending}",
        f"check.peak_acceleration_working_{output.acceleration.ending}",
        f"check.peak_acceleration_cycle_{output.acceleration.ending}",
    )
    return names if design.gears is None or design.stages > 1 else (*names, *PITCH)


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


@dataclass(frozen=True, eq=False)
class Found:
    """What a batch is sure of: rows of the designs that are made and their figures, shape (m,) each, and refusals."""

    made: IndexArray
    figures: dict[str, Array]
    refused: dict[int, DesignError]


def found_of(batch: Batch, fineness: Fineness) -> Found:
    """The figures and refusals of a batch of the designs that it is sure of when sampled so finely."""
    kind = batch.kind

    def fitted_n(displacement_mm: Array) -> Array:
        """The curve of the force with its negative stretches, as the exact peak of power uses it."""
        return kind.resistance.fitted_n(Jet(displacement_mm.reshape(1, -1))).value.reshape(displacement_mm.shape)

    # Designs that cannot be made give numbers that are not finite, and the batch is not sure of these.
    with np.errstate(all="ignore"):
        found = sampled(batch, fineness)
        figures = law_figures(found.samples, fitted_n)
    sure = np.nonzero(figures.resolved & _force_is_seen(kind.resistance, found, figures.resolved))[0]
    if not sure.size:
        return Found(sure, {}, {})
    speed = batch.column("operation.speed_rpm")[sure] * RAD_S_PER_RPM
    columns = {**_law_of_rows(found, figures, sure), **_check_of_rows(kind, found, figures, sure, speed)}
    gears = batch.written[0].gears
    if gears is None:
        return Found(sure, columns, {})
    pitch, unsized = _pitch_of_rows(batch.kept(sure), figures, sure)
    tangent = np.arctan(figures.largest("tangent"))[sure]
    racks = [design.gears.rack for design in batch.written if design.gears is not None]
    steeper = np.array([max(rack.angles_deg) for rack in racks])[batch.follows[sure]]
    steep = np.nonzero((np.degrees(tangent) + steeper >= RIGHT_ANGLE_DEG) & ~unsized)[0]
    refused: dict[int, DesignError] = {}
    for place in np.nonzero(unsized)[0].tolist():
        if (error := _refusal(partial(_require_size, batch, figures, int(sure[place])))) is not None:
            refused[int(sure[place])] = error
    where = _steepest(found.samples.kept(sure[steep]), kind.lobes)
    for place, at_rad in zip(steep.tolist(), where.tolist(), strict=True):
        rack = racks[batch.follows[sure[place]]]
        if (error := _refusal(partial(require_pushing, float(tangent[place]), at_rad, rack))) is not None:
            refused[int(sure[place])] = error
    made = ~unsized
    made[steep] = False
    return Found(sure[made], {name: values[made] for name, values in {**columns, **pitch}.items()}, refused)


def _refusal(require: Callable[[], object]) -> DesignError | None:
    """The error that a demand raises; None where it is met after all, which a single computation decides."""
    try:
        require()
    except DesignError as error:
        return error
    return None


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


def _pitch_of_rows(batch: Batch, figures: LawFigures, sure: IndexArray) -> tuple[dict[str, Array], Mask]:
    """Figures of the pitch curves at their size, and whose teeth do not fill them.

    The formulas are those of ``pitch.pair.solved_size``, which refuses one pair.
    """
    lobes, ranges = batch.kind.lobes, figures.ranges
    length = figures.length[sure]
    driving_length = length * lobes.driving / lobes.driven
    teeth, module_mm, distance_mm = (batch.given(f"gears.{name}") for name in SIZES)
    fits = np.ones(sure.size, dtype=bool)
    if teeth is None:
        assert module_mm is not None
        assert distance_mm is not None
        exact = driving_length * distance_mm / (pi * module_mm)
        teeth = np.maximum(np.round(exact), 1.0)
        fits &= np.abs(exact - teeth) <= CONSISTENT * np.maximum(exact, teeth)
    if module_mm is None:
        assert distance_mm is not None
        module_mm = driving_length * distance_mm / (teeth * pi)
    distance = teeth * pi * module_mm / driving_length
    if distance_mm is not None:
        fits &= np.abs(distance - distance_mm) <= CONSISTENT * np.maximum(distance, distance_mm)
    fits &= (teeth * lobes.driven % lobes.driving == 0.0) & (teeth <= MOST_TEETH)
    gears = [design.gears for design in batch.written if design.gears is not None]
    carrying = np.array([one.carrying_angle_deg for one in gears])[batch.follows]
    tangent_deg = np.degrees(np.arctan(figures.largest("tangent")))[sure]
    driving, driven = ([side[sure] for side in ranges[f"{gear}_curvature"]] for gear in ("driving", "driven"))
    found = {
        "pitch.center_distance_mm": distance,
        "pitch.length_driving_mm": driving_length * distance,
        "pitch.length_driven_mm": length * distance,
        "pitch.driving_convex": (driving[0] >= -STRAIGHT).astype(float),
        "pitch.driven_convex": (driven[0] >= -STRAIGHT).astype(float),
        "pitch.min_radius_driving_mm": distance / driving[1],
        "pitch.min_radius_driven_mm": distance / driven[1],
        "pitch.max_tangent_angle_deg": tangent_deg,
        "pitch.max_pressure_angle_deg": tangent_deg + carrying,
    }
    return found, ~fits


def _require_size(batch: Batch, figures: LawFigures, row: int) -> None:
    """Refuse teeth that do not fill the pitch curves of one design; raises WrongInput."""
    lobes = batch.kind.lobes
    given = [batch.given(f"gears.{name}") for name in SIZES]
    teeth, module_mm, distance_mm = (None if values is None else float(values[row]) for values in given)
    length = float(figures.length[row]) * lobes.driving / lobes.driven
    size = solved_size(length, lobes, None if teeth is None else int(teeth), module_mm, distance_mm)
    refuse_many_teeth(size.driving_teeth)


def _steepest(samples: Samples, lobes: Lobes) -> Array:
    """The first driving angle in rad at which the pitch curves of each law are steepest, shape (n,)."""
    laws, pieces, count = samples.at.ratio.shape
    law, piece = np.nonzero(samples.there)
    steepness = tangent(samples.at)[law, piece]
    # dphi1 per share of a piece is i times dphi2 per share.
    widths = (samples.turning * samples.at.ratio)[law, piece]
    ends = np.zeros((laws, pieces))
    ends[law, piece] = widths @ integration(count)[-1]
    starts = (np.cumsum(ends, axis=1) - ends)[law, piece]
    row, share, values = turning_points(steepness)
    values = np.abs(values)
    largest = np.full(laws, -np.inf)
    np.maximum.at(largest, law[row], values)
    steepest = values >= largest[law[row]] * (1.0 - AS_STEEP)
    row, share = row[steepest], share[steepest]
    at = starts[row] + sums_at(widths[row] @ integration(count).T, share)
    # The end of a period is the beginning of the next one.
    period = lobes.driving_period_rad
    at = np.where(period - at % period > ROUNDED_RAD, at % period, 0.0)
    first = np.full(laws, np.inf)
    np.minimum.at(first, law[row], at)
    return first
