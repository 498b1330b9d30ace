"""The figures of designs: of many from their sampled laws, and of one by the computation of a check and a build.

They are the peaks of the motion, the range of the ratio and the pitch curves of external pairs; both ways give the same
keys.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import degrees, pi, radians

import numpy as np

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import SIZES
from ncgear.design.mechanisms import entry_of
from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.kinematics.check import OF_MASSES, power_figures
from ncgear.mechanisms.resistance import Resistance
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import Functions, extremes, integrated, integration, sums_at, turning_points
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.pitch.pair import AS_STEEP, CONSISTENT, MOST_TEETH, STRAIGHT, refuse_many_teeth, solved_size
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.tooth_form import RIGHT_ANGLE_DEG, require_pushing, require_pushing_flanks
from ncgear.ratio.transmission import CLOSED, STANDSTILL, Lobes
from ncgear.screening.batch import Batch, refusals
from ncgear.screening.samples import Fineness, Sampled, Samples, sampled

RESOLVED = 1e-12
"""Last coefficients, relative to a quantity's largest value, up to which a law counts as resolved: its least value, a
hundredth of that where the ratio varies by 1:100, still has ten digits (tests/test_screening.py)."""

SEEN = 2
"""Fewest samples of a law on a panel of the force; peaks between two samples make panels that are narrower still."""

ROUNDED_RAD = 1e-9
"""Driving angle that messages round to zero."""


@dataclass(frozen=True, eq=False)
class Curves:
    """The ratios and the shape of the pitch curves of n laws at their samples, shape (p, m, n) each.

    ``tangent`` is that of the angle between the curves and the normal to the centre line, ``rates`` the curves' length
    per share of a piece over the centre distance, ``driving`` and ``driven`` their curvatures times it.
    """

    ratio: Functions
    tangent: Functions
    rates: Functions
    driving: Functions
    driven: Functions


def curves_of(samples: Samples) -> Curves:
    """The curves of laws: the equations of ``optimum.makeable.quantities`` with their common parts computed once.

    With r = 1 + i and t = f'/r, (r^2 + f'^2)^(1/2) is r (1 + t^2)^(1/2), and the root of the driven curve is that of
    the driving one times s:  the curvatures are (1 + t^2)^(-3/2) times (r + s f'') and s (r + f'^2 - f'').
    """
    across = 1.0 + samples.ratio
    steep = samples.first / across
    square = steep * steep + 1.0
    root = np.sqrt(square)
    rates = samples.ratio * root
    rates /= across
    rates *= samples.turning
    square *= root
    driven = samples.first * samples.first
    driven += across
    driven -= samples.second
    driven *= samples.slope
    driven /= square
    driving = samples.slope * samples.second
    driving += across
    driving /= square
    return Curves(*map(Functions, (samples.ratio, steep, rates, driving, driven)))


@dataclass(frozen=True, eq=False)
class CurveFigures:
    """What n ratios and the shape of their pitch curves are, shape (n,) each; ``resolved`` says whose figures hold.

    ``steepest`` is the largest tangent of the pitch curves' inclination, ``length`` theirs over one turn of the driven
    gear at unit centre distance.
    """

    ratio: tuple[Array, Array]
    steepest: Array
    length: Array
    resolved: Mask


def curve_figures(samples: Samples, curves: Curves) -> CurveFigures:
    """The figures of ratios and pitch curves."""
    asked = curves.ratio, curves.tangent, curves.rates, Functions(samples.turning)
    resolved = _died_away(asked, samples.there) & _closes(samples, curves.ratio)
    there = samples.there & resolved
    low, high, steepest = extremes(
        [(curves.ratio, there, (-1.0,)), (curves.ratio, there, (1.0,)), (curves.tangent, there, BOTH)]
    )
    return CurveFigures((-low, high), steepest, integrated(curves.rates.values), resolved)


BOTH = 1.0, -1.0
"""Signs of a value of which the magnitude is asked."""


def _died_away(quantities: Iterable[Functions], there: Mask) -> Mask:
    """Of which laws the last coefficients of all quantities have died away on the pieces that are there."""
    resolved = np.ones(there.shape[1], dtype=bool)
    for functions in quantities:
        counted = there[: len(functions.values)]
        size = np.where(counted, functions.size, 0.0).max(axis=0)
        resolved &= (((functions.tails <= RESOLVED * size) & np.isfinite(size)) | ~counted).all(axis=0)
    return resolved


def _closes(samples: Samples, ratio: Functions) -> Mask:
    """Which laws close, and do not nearly stand still."""
    lowest = np.where(samples.there, ratio.low, np.inf).min(axis=0)
    highest = np.where(samples.there, ratio.high, -np.inf).max(axis=0)
    closed = np.abs(integrated(samples.turning) - 2.0 * np.pi) <= CLOSED
    answer: Mask = closed & (lowest > 2.0 * STANDSTILL * highest)
    return answer


def single_figures(design: Design) -> dict[str, float]:
    """Every figure of a design; raises WrongInput or NoSuchMechanism where it cannot be made."""
    drive = Drive(design)
    low, high = drive.transmission.ratio_range
    # With two stages each pair has its own curves, and only a build tells them apart.  Whether teeth can roll on the
    # curves is asked before the peaks of the motion, which take longest.
    pitch = _pitch(drive) if _has_pitch(design) else {}
    check, output = drive.check, drive.linkage.OUTPUT
    speed, acceleration = output.speed.ending, output.acceleration.ending
    return {
        "drive.law_speed_rpm": drive.law_speed_rpm,
        "closure.residual_rad": abs(drive.transmission.closure_error_rad),
        **{f"closure.{key}": value for key, value in drive.told_stroke_residual.items()},
        "ratio.min": low.value,
        "ratio.max": high.value,
        **{f"check.{key}": value for key, value in power_figures(check).items() if not key.endswith("_at_rad")},
        f"check.peak_speed_{speed}": check.peak_speed.value,
        f"check.peak_acceleration_working_{acceleration}": check.peak_acceleration_working.value,
        f"check.peak_acceleration_cycle_{acceleration}": check.peak_acceleration_cycle.value,
        **pitch,
    }


WITH_MASSES = tuple(f"check.{key}" for key in OF_MASSES if not key.endswith("_at_rad"))
"""Keys of the figures that only designs with masses have."""


PITCH: dict[str, Callable[[Drive], float]] = {
    "pitch.center_distance_mm": lambda drive: drive.pitch.center_distance_mm,
    "pitch.length_driving_mm": lambda drive: drive.pitch.length_mm(Gear.DRIVING),
    "pitch.length_driven_mm": lambda drive: drive.pitch.length_mm(Gear.DRIVEN),
    "pitch.driving_convex": lambda drive: drive.pitch.convex(Gear.DRIVING),
    "pitch.driven_convex": lambda drive: drive.pitch.convex(Gear.DRIVEN),
    "pitch.min_radius_driving_mm": lambda drive: drive.pitch.least_radius_mm(Gear.DRIVING),
    "pitch.min_radius_driven_mm": lambda drive: drive.pitch.least_radius_mm(Gear.DRIVEN),
    "pitch.max_tangent_angle_deg": lambda drive: degrees(drive.pitch.largest_tangent_angle_rad.value),
    "pitch.max_pressure_angle_deg": lambda drive: drive.pitch.largest_pressure_angle_deg(
        radians(drive.gears.carrying_angle_deg)
    ),
}
"""Keys of the figures of a pair of pitch curves, and what computes each."""


def _has_pitch(design: Design) -> bool:
    return design.gears is not None and design.stages == 1


def _pitch(drive: Drive) -> dict[str, float]:
    require_pushing_flanks(drive.pitch, drive.gears.rack)
    return {name: float(figure(drive)) for name, figure in PITCH.items()}


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
        *(() if Drive(design).masses_left_out else WITH_MASSES),
        "check.mean_power_w",
        f"check.peak_speed_{output.speed.ending}",
        f"check.peak_acceleration_working_{output.acceleration.ending}",
        f"check.peak_acceleration_cycle_{output.acceleration.ending}",
    )
    return (*names, *PITCH) if _has_pitch(design) else names


@dataclass(frozen=True, eq=False)
class Found:
    """What a batch is sure of: rows of the designs that are made and their figures, shape (m,) each, and refusals."""

    made: IndexArray
    figures: dict[str, Array]
    refused: dict[int, DesignError]


def found_of(batch: Batch, fineness: Fineness) -> Found:
    """The figures and refusals of a batch of the designs that it is sure of when sampled so finely.

    Whether teeth can roll on the pitch curves is asked first, as for a design by itself: the motion of a slider that no
    teeth can drive is not computed.
    """
    # Designs that cannot be made give numbers that are not finite, and the batch is not sure of these.
    with np.errstate(all="ignore"):
        found = sampled(batch, fineness)
        shapes = curves_of(found.samples)
        curves = curve_figures(found.samples, shapes)
    left, refused = np.nonzero(curves.resolved)[0], dict[int, DesignError]()
    if batch.written[0].gears is not None and left.size:
        left, refused = _rolling(batch, found, curves, left)
    if not left.size:
        return Found(left, {}, refused)
    with np.errstate(all="ignore"):
        sure, columns = _figures_of_rows(batch, found, shapes, curves, left)
    return Found(left[sure], {name: values[sure] for name, values in columns.items()}, refused)


def _rolling(
    batch: Batch, found: Sampled, curves: CurveFigures, known: IndexArray
) -> tuple[IndexArray, dict[int, DesignError]]:
    """Those of some designs whose teeth fill the pitch curves and can push, and why others are refused.

    Those that are in neither are left to a single computation.
    """
    _, fits = _distance(batch.kept(known), curves.length[known])
    steepness = np.arctan(curves.steepest[known])
    racks = [design.gears.rack for design in batch.written if design.gears is not None]
    steeper = np.array([max(rack.angles_deg) for rack in racks])[batch.follows[known]]
    pushes = np.degrees(steepness) + steeper < RIGHT_ANGLE_DEG
    steep, at_rad = fits & ~pushes, np.zeros(known.size)
    at_rad[steep] = _steepest(found.samples.kept(known[steep]), batch.kind.lobes)
    unfit = refusals(~fits, lambda place: _require_size(batch, curves, int(known[place])))
    blocked = refusals(
        steep,
        lambda place: require_pushing(
            float(steepness[place]), float(at_rad[place]), racks[batch.follows[known[place]]]
        ),
    )
    return known[fits & pushes], {int(known[place]): error for place, error in {**unfit, **blocked}.items()}


def _figures_of_rows(
    batch: Batch, found: Sampled, shapes: Curves, curves: CurveFigures, rows: IndexArray
) -> tuple[Mask, dict[str, Array]]:
    """Whose figures hold, of some designs, and the figures."""
    kind, displacement, there = batch.kind, found.displacement, found.samples.there
    force_n = kind.resistance.fitted_n(Jet(displacement.reshape(1, -1))).value.reshape(displacement.shape)
    power = Functions(force_n * found.velocity[: len(displacement)])
    velocity, acceleration = Functions(found.velocity), Functions(found.acceleration)
    asked = np.zeros(len(batch), dtype=bool)
    asked[rows] = True
    asked &= _died_away((shapes.driving, shapes.driven, velocity, acceleration, power), there)
    asked &= _force_is_seen(kind.resistance, displacement, found.stroke_mm, asked)
    there = there & asked
    working = there & (np.arange(len(there)) < len(displacement))[:, None]
    sought = {
        "power": (power, there[: len(displacement)], (1.0,)),
        "velocity": (velocity, there, BOTH),
        "acceleration": (acceleration, there, BOTH),
        "working_acceleration": (acceleration, working, BOTH),
    }
    if batch.written[0].gears is not None:
        sought |= {
            "driving": (shapes.driving, there, (1.0,)),
            "hollow_driving": (shapes.driving, there, (-1.0,)),
            "driven": (shapes.driven, there, (1.0,)),
            "hollow_driven": (shapes.driven, there, (-1.0,)),
        }
    most = {name: values[rows] for name, values in zip(sought, extremes([*sought.values()]), strict=True)}
    kept = batch.kept(rows)
    columns = {
        "drive.law_speed_rpm": found.law_speed_rpm[rows],
        "closure.residual_rad": np.abs(found.closing_error_rad[rows]),
        "closure.stroke_residual_mm": np.abs(found.stroke_error_mm[rows]),
        "ratio.min": curves.ratio[0][rows],
        "ratio.max": curves.ratio[1][rows],
        **_check_of_rows(kept, most, found.stroke_mm[rows]),
    }
    if batch.written[0].gears is not None:
        columns |= _pitch_of_rows(kept, most, curves.length[rows], curves.steepest[rows])
    return asked[rows], columns


def _force_is_seen(resistance: Resistance, displacement_mm: Array, stroke_mm: Array, known: Mask) -> Mask:
    """Whether every panel of the force's curve holds two samples of the law, so that none hides a peak."""
    if not known.any() or not (panels := resistance.panels_mm(float(stroke_mm[known].max()))).size:
        return known
    laws = displacement_mm.reshape(-1, stroke_mm.size).T
    count = np.stack([np.searchsorted(np.sort(row), panels) for row in laws])
    seen: Mask = np.all((np.diff(count, axis=1) >= SEEN) | (panels[1:] > stroke_mm[:, None]), axis=1)
    return seen


def _check_of_rows(batch: Batch, most: dict[str, Array], stroke_mm: Array) -> dict[str, Array]:
    """Peaks of the motion and mean power at the speed of operation."""
    kind, speed_rad_s = batch.kind, batch.column("operation.speed_rpm") * RAD_S_PER_RPM
    cycle = kind.lobes.driven * kind.lobes.driving_period_rad
    work = kind.resistance.work_n_mm(stroke_mm, float(stroke_mm.max())) / 1000.0
    return {
        "check.peak_power_w": np.maximum(most["power"], 0.0) * speed_rad_s / 1000.0,
        "check.mean_power_w": work * speed_rad_s / cycle,
        "check.peak_speed_mm_s": most["velocity"] * speed_rad_s,
        "check.peak_acceleration_working_mm_s2": most["working_acceleration"] * speed_rad_s**2,
        "check.peak_acceleration_cycle_mm_s2": most["acceleration"] * speed_rad_s**2,
    }


def _pitch_of_rows(batch: Batch, most: dict[str, Array], length: Array, steepest: Array) -> dict[str, Array]:
    """Figures of the pitch curves at their size."""
    lobes, (distance, _) = batch.kind.lobes, _distance(batch, length)
    gears = [design.gears for design in batch.written if design.gears is not None]
    carrying = np.array([one.carrying_angle_deg for one in gears])[batch.follows]
    tangent_deg = np.degrees(np.arctan(steepest))
    return {
        "pitch.center_distance_mm": distance,
        "pitch.length_driving_mm": length * lobes.driving / lobes.driven * distance,
        "pitch.length_driven_mm": length * distance,
        "pitch.driving_convex": (most["hollow_driving"] <= STRAIGHT).astype(float),
        "pitch.driven_convex": (most["hollow_driven"] <= STRAIGHT).astype(float),
        "pitch.min_radius_driving_mm": distance / most["driving"],
        "pitch.min_radius_driven_mm": distance / most["driven"],
        "pitch.max_tangent_angle_deg": tangent_deg,
        "pitch.max_pressure_angle_deg": tangent_deg + carrying,
    }


def _distance(batch: Batch, length: Array) -> tuple[Array, Mask]:
    """Centre distances in mm of pitch curves of a length at unit distance, and whose teeth fill them.

    The formulas are those of ``pitch.pair.solved_size``, which refuses one pair.
    """
    lobes = batch.kind.lobes
    driving_length = length * lobes.driving / lobes.driven
    teeth, module_mm, distance_mm = (batch.given(f"gears.{name}") for name in SIZES)
    fits = np.ones(length.size, dtype=bool)
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
    return distance, fits


def _require_size(batch: Batch, curves: CurveFigures, row: int) -> None:
    """Refuse teeth that do not fill the pitch curves of one design; raises WrongInput."""
    lobes = batch.kind.lobes
    given = [batch.given(f"gears.{name}") for name in SIZES]
    teeth, module_mm, distance_mm = (None if values is None else float(values[row]) for values in given)
    length = float(curves.length[row]) * lobes.driving / lobes.driven
    size = solved_size(length, lobes, None if teeth is None else int(teeth), module_mm, distance_mm)
    refuse_many_teeth(size.driving_teeth)


def _steepest(samples: Samples, lobes: Lobes) -> Array:
    """The first driving angle in rad at which the pitch curves of each law are steepest, shape (n,)."""
    pieces, count, laws = samples.ratio.shape
    piece, law = np.nonzero(samples.there)
    steepness = (samples.first / (1.0 + samples.ratio))[piece, :, law].T
    # dphi1 per share of a piece is i times dphi2 per share.
    widths = (samples.turning * samples.ratio)[piece, :, law].T
    ends = np.zeros((pieces, laws))
    ends[piece, law] = integration(count)[-1] @ widths
    starts = (np.cumsum(ends, axis=0) - ends)[piece, law]
    row, share, values = turning_points(steepness)
    values = np.abs(values)
    largest = np.full(laws, -np.inf)
    np.maximum.at(largest, law[row], values)
    steepest = values >= largest[law[row]] * (1.0 - AS_STEEP)
    row, share = row[steepest], share[steepest]
    at = starts[row] + sums_at(integration(count) @ widths[:, row], share)
    # The end of a period is the beginning of the next one.
    period = lobes.driving_period_rad
    at = np.where(period - at % period > ROUNDED_RAD, at % period, 0.0)
    first = np.full(laws, np.inf)
    np.minimum.at(first, law[row], at)
    return first
