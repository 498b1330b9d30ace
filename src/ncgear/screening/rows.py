"""The figures of many designs from sampled laws, by the keys of ``screening.single``.

They are the peaks of the motion, the range of the ratio and the pitch curves of external pairs.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import pi

import numpy as np

from ncgear.design.keys.gears import SIZES
from ncgear.dynamics.sampled_shafts import torque_figures
from ncgear.errors import DesignError
from ncgear.frozen import dataclass
from ncgear.mechanisms.resistance import Resistance
from ncgear.numerics.arrays import Array, IndexArray, Mask, chosen
from ncgear.numerics.jet import Jet
from ncgear.numerics.sampled import Functions, Sought, extremes, integrated, integration, turning_points, values_at
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.pitch.pair import AS_STEEP, CONSISTENT, MOST_TEETH, STRAIGHT, refuse_many_teeth, solved_size
from ncgear.project.tooth_form import RIGHT_ANGLE_DEG, require_pushing
from ncgear.ratio.transmission import CLOSED, STANDSTILL, Lobes
from ncgear.screening.batch import Batch, refusals
from ncgear.screening.samples import Fineness, Laws, Sampled, Samples

RESOLVED = 1e-12
"""Largest last coefficients of a resolved law, relative to a quantity's largest value: its least value, a hundredth of
the largest where the ratio varies by 1:100, still has ten digits (tests/test_screening.py)."""

SEEN = 2
"""Fewest samples of a law on a panel of the force; peaks between two samples make even narrower panels."""

ERRS = 20.0
"""Largest error of a polynomial between its samples over its last coefficient.  It is under 2 / (r - 1) where
coefficients fall by a factor r (L. N. Trefethen, "Approximation Theory and Approximation Practice", SIAM 2013, theorem
8.2), and a last one of at most a twentieth of the first of 29 has r over 1.1."""

FAR_OFF = 100.0
"""Times a ratio at which the driven gear stands still that an unresolved law surely does not reach."""

ROUNDED_RAD = 1e-9
"""Driving angle that messages round to zero."""


@dataclass(frozen=True, eq=False)
class Curves:
    """The ratios and the shape of the pitch curves of n laws at their samples, shape (p, m, n) each.

    ``tangent`` belongs to the angle between the curves and the normal to the centre line, ``rates`` is the curves'
    length per share of a piece over the centre distance, ``driving`` and ``driven`` are their curvatures times it.
    """

    ratio: Functions
    tangent: Functions
    rates: Functions
    driving: Functions
    driven: Functions


def curves_of(samples: Samples) -> Curves:
    """The curves of laws: the equations of ``optimum.makeable.quantities`` with their common parts computed once.

    With r = 1 + i and t = f'/r, (r^2 + f'^2)^(1/2) is r (1 + t^2)^(1/2), and the root of the driven curve is the
    driving curve's times s: the curvatures are (1 + t^2)^(-3/2) times (r + s f'') and s (r + f'^2 - f'').
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


BOTH = 1.0, -1.0
"""Signs for the magnitude of a value."""


def _missed(quantities: Iterable[Functions], there: Mask) -> Array:
    """The largest last coefficient of any quantity over its size, of each law on the existing pieces, shape (n,).

    Infinite where a value is not finite.
    """
    missed = np.zeros(there.shape[1])
    for functions in quantities:
        counted = there[: len(functions.values)]
        last, size = (np.where(counted, figure, 0.0).max(axis=0) for figure in (functions.tails, functions.size))
        missed = np.maximum(missed, np.where(last > 0.0, last / size, 0.0))
    return np.where(np.isnan(missed), np.inf, missed)


def _closes(samples: Samples, ratio: Functions) -> Mask:
    """Which laws close, and do not nearly stand still."""
    closed = np.abs(integrated(samples.turning) - 2.0 * np.pi) <= CLOSED
    return closed & _turns(samples, ratio)


def _turns(samples: Samples, ratio: Functions, times: float = 2.0) -> Mask:
    """Which laws stay so many times over a ratio at which the driven gear counts as standing still."""
    lowest = np.where(samples.there, ratio.low, np.inf).min(axis=0)
    highest = np.where(samples.there, ratio.high, -np.inf).max(axis=0)
    return lowest > times * STANDSTILL * highest


def _blocked_at_start(found: Sampled, curves: Curves, missed: Array, batch: Batch, steeper_deg: Array) -> Mask:
    """Which strokes are steepest at the start of the cycle, so steep that teeth cannot push there.

    The slope there is exact at any fineness: it follows from the approach, and no closing of the return changes it.  It
    must exceed the slopes at all other samples by more than the polynomials, or a return that does not close exactly,
    may err; a return that comes near standing still, which is refused before, must be far off.
    """
    slopes = curves.tangent.values
    start = np.abs(slopes[0, 0])
    blocked = ~_pushes(start, steeper_deg)
    # With a given centre distance the length of the curves, which only resolved laws have, is judged before.
    if not (blocked.any() and batch.kind.has_return) or batch.given("gears.center_distance_mm") is not None:
        return np.zeros_like(blocked)
    doubt = ERRS * np.maximum(missed, np.abs(found.closing_error_rad))
    elsewhere = found.samples.there[:, None] & (np.abs(found.driven_rad - pi) < pi - ROUNDED_RAD)
    above = ~(elsewhere & (np.abs(slopes) >= (1.0 - doubt) * start)).any(axis=(0, 1))
    return blocked & above & _turns(found.samples, curves.ratio, FAR_OFF)


@dataclass(frozen=True, eq=False)
class BatchResults:
    """The sure results of a batch: rows of the makeable designs and their figures, shape (m,) each, and refusals.

    ``missed`` tells of all designs (shape (n,)) how far from resolved their laws are, as a share of their size.
    """

    missed: Array
    made: IndexArray
    figures: dict[str, Array]
    refused: dict[int, DesignError]


def found_of(batch: Batch, laws: Laws, rows: IndexArray, fineness: Fineness, together: int) -> BatchResults:
    """The figures and refusals of the rows of which a batch, sampled at a fineness, is sure.

    ``together`` samples are computed at once.  Whether teeth can roll on the pitch curves is tested before the motion,
    as for a single design: known curves are enough to refuse it.
    """
    count = max(1, together // fineness.samples(batch.kind))
    steeper_deg, speed_rad_s = _steeper_deg(batch), batch.column("operation.speed_rpm") * RAD_S_PER_RPM
    # Designs that cannot be made give infinity or NaN, and the batch is not sure of these.
    with np.errstate(all="ignore"):
        parts = [
            _measured(laws.sampled(block, fineness), batch, steeper_deg[block], speed_rad_s[block])
            for block in (rows[first : first + count] for first in range(0, rows.size, count))
        ]
        measured = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    made, refused = measured["resolved"] > 0.0, dict[int, DesignError]()
    known = np.nonzero(measured["drawn"])[0]
    if batch.written[0].gears is not None and known.size:
        rolling, refused = _rolling(batch.kept(rows[known]), {name: values[known] for name, values in measured.items()})
        refused = {int(rows[known[place]]): error for place, error in refused.items()}
        made[known[~rolling]] = False
    figures = {}
    if made.any():
        figures = _figures(batch.kept(rows[made]), {key: values[made] for key, values in measured.items()})
    return BatchResults(measured["missed"], rows[made], figures, refused)


def _steeper_deg(batch: Batch) -> Array:
    """The steeper of both flanks' angles, shape (n,); without gears nothing must push."""
    racks = [None if design.gears is None else design.gears.rack for design in batch.written]
    return np.array([-np.inf if rack is None else max(rack.angles_deg) for rack in racks])[batch.follows]


def _pushes(tangent: Array, steeper_deg: Array) -> Mask:
    """Whether teeth can push where the pitch curves are steepest."""
    return np.degrees(np.arctan(tangent)) + steeper_deg < RIGHT_ANGLE_DEG


def _measured(found: Sampled, batch: Batch, steeper_deg: Array, speed_rad_s: Array) -> dict[str, Array]:
    """The extremes and integrals of laws, shape (n,) each, by names of this module; power with masses by its keys.

    ``drawn`` is 1 where the figures of the pitch curves hold, or as much of them as refuses the law, ``resolved`` where
    all of them do.  ``steepest_rad`` is the driving angle at which curves are steepest, where teeth with flanks of
    ``steeper_deg`` could not push there.
    """
    samples, displacement, resistance = found.samples, found.displacement, batch.kind.resistance
    curves, there = curves_of(samples), samples.there
    missed = _missed((curves.ratio, curves.tangent, curves.rates, Functions(samples.turning)), there)
    drawn = _closes(samples, curves.ratio) & (missed <= RESOLVED)
    blocked = _blocked_at_start(found, curves, missed, batch, steeper_deg)
    force_n = resistance.fitted_n(Jet(displacement.reshape(1, -1))).value.reshape(displacement.shape)
    power = Functions(force_n * found.velocity[: len(displacement)])
    velocity, acceleration = Functions(found.velocity), Functions(found.acceleration)
    followed, torque = [curves.driving, curves.driven, velocity, acceleration, power], None
    if batch.crank is not None:
        asked = batch.crank.torque_n_mm(found.driven_rad, samples.slope, samples.first, speed_rad_s)
        asked[: len(displacement)] += power.values if resistance.keep_negative else np.maximum(power.values, 0.0)
        torque = Functions(asked)
        followed.append(torque)
    missed = np.maximum(missed, _missed(followed, there))
    resolved = drawn & (missed <= RESOLVED)
    resolved &= _force_is_seen(resistance, displacement, found.stroke_mm, resolved)
    drawn_there, there = there & drawn, there & resolved
    working = there & (np.arange(len(there)) < len(displacement))[:, None]
    sought = {
        "least_ratio": Sought(curves.ratio, drawn_there, (-1.0,)),
        "ratio": Sought(curves.ratio, drawn_there, (1.0,)),
        "tangent": Sought(curves.tangent, drawn_there, BOTH),
        "power": Sought(power, there[: len(displacement)], (1.0,)),
        "velocity": Sought(velocity, there, BOTH),
        "acceleration": Sought(acceleration, there, BOTH),
        "working_acceleration": Sought(acceleration, working, BOTH),
        "driving": Sought(curves.driving, there, (1.0,)),
        "hollow_driving": Sought(curves.driving, there, (-1.0,), limit=STRAIGHT),
        "driven": Sought(curves.driven, there, (1.0,)),
        "hollow_driven": Sought(curves.driven, there, (-1.0,), limit=STRAIGHT),
    }
    most = dict(zip(sought, extremes([*sought.values()]), strict=True))
    most["tangent"] = np.where(blocked, np.abs(curves.tangent.values[0, 0]), most["tangent"])
    steep = np.nonzero(drawn & ~blocked & ~_pushes(most["tangent"], steeper_deg))[0]
    steepest_rad = np.zeros(drawn.size)
    if steep.size:
        steepest_rad[steep] = _steepest(chosen(samples, steep), batch.kind.lobes)
    driven = {}
    if torque is not None:
        angles = samples.turning * samples.ratio
        driven = {f"check.{key}": values for key, values in torque_figures(torque, angles, there, speed_rad_s).items()}
    return {
        **most,
        **driven,
        "steepest_rad": steepest_rad,
        "missed": missed,
        "drawn": (drawn | blocked).astype(float),
        "resolved": resolved.astype(float),
        "length": integrated(curves.rates.values),
        "stroke_mm": found.stroke_mm,
        "law_speed_rpm": found.law_speed_rpm,
        "closing_error_rad": found.closing_error_rad,
        "stroke_error_mm": found.stroke_error_mm,
    }


def _rolling(batch: Batch, measured: dict[str, Array]) -> tuple[Mask, dict[int, DesignError]]:
    """Whether the teeth of each design fill the pitch curves and can push, and refusals by their rows.

    Designs that do not and are not refused are left to single computations.
    """
    _, fits = _distance(batch, measured["length"])
    racks = [design.gears.rack for design in batch.written if design.gears is not None]
    steepness, at_rad = np.arctan(measured["tangent"]), measured["steepest_rad"]
    pushes = _pushes(measured["tangent"], _steeper_deg(batch))
    unfit = refusals(~fits, lambda row: _require_size(batch, float(measured["length"][row]), row))
    blocked = refusals(
        fits & ~pushes,
        lambda row: require_pushing(float(steepness[row]), float(at_rad[row]), racks[batch.follows[row]]),
    )
    return fits & pushes, {**unfit, **blocked}


def _figures(batch: Batch, measured: dict[str, Array]) -> dict[str, Array]:
    """The figures of designs."""
    columns = {
        "drive.law_speed_rpm": measured["law_speed_rpm"],
        "closure.residual_rad": np.abs(measured["closing_error_rad"]),
        "closure.stroke_residual_mm": np.abs(measured["stroke_error_mm"]),
        "ratio.min": -measured["least_ratio"],
        "ratio.max": measured["ratio"],
        **_check_figures(batch, measured),
    }
    return columns if batch.written[0].gears is None else {**columns, **_pitch_figures(batch, measured)}


def _force_is_seen(resistance: Resistance, displacement_mm: Array, stroke_mm: Array, known: Mask) -> Mask:
    """Whether every panel of the force's curve has two samples of the law, so that no panel hides a peak."""
    if not known.any() or not (panels := resistance.panels_mm(float(stroke_mm[known].max()))).size:
        return known
    laws = displacement_mm.reshape(-1, stroke_mm.size).T
    count = np.stack([np.searchsorted(np.sort(row), panels) for row in laws])
    return np.all((np.diff(count, axis=1) >= SEEN) | (panels[1:] > stroke_mm[:, None]), axis=1)


def _check_figures(batch: Batch, measured: dict[str, Array]) -> dict[str, Array]:
    """Peaks of the motion and mean power at the speed of operation."""
    stroke_mm = measured["stroke_mm"]
    kind, speed_rad_s = batch.kind, batch.column("operation.speed_rpm") * RAD_S_PER_RPM
    resisted = np.maximum(measured["power"], 0.0) * speed_rad_s / 1000.0
    power = {"check.peak_power_w": resisted}
    if kind.masses is not None:
        with_masses = {name: values for name, values in measured.items() if name.startswith("check.")}
        power = {**with_masses, "check.peak_power_resistance_w": resisted}
    work = kind.resistance.work_n_mm(stroke_mm, float(stroke_mm.max())) / 1000.0
    return {
        **power,
        "check.mean_power_w": work * speed_rad_s / (kind.lobes.driven * kind.lobes.driving_period_rad),
        "check.peak_speed_mm_s": measured["velocity"] * speed_rad_s,
        "check.peak_acceleration_working_mm_s2": measured["working_acceleration"] * speed_rad_s**2,
        "check.peak_acceleration_cycle_mm_s2": measured["acceleration"] * speed_rad_s**2,
    }


def _pitch_figures(batch: Batch, measured: dict[str, Array]) -> dict[str, Array]:
    """Figures of the pitch curves at their size."""
    length = measured["length"]
    lobes, (distance, _) = batch.kind.lobes, _distance(batch, length)
    gears = [design.gears for design in batch.written if design.gears is not None]
    carrying = np.array([gear.carrying_angle_deg for gear in gears])[batch.follows]
    tangent_deg = np.degrees(np.arctan(measured["tangent"]))
    return {
        "pitch.center_distance_mm": distance,
        "pitch.length_driving_mm": length * lobes.driving / lobes.driven * distance,
        "pitch.driving_convex": (measured["hollow_driving"] <= STRAIGHT).astype(float),
        "pitch.min_radius_driving_mm": distance / measured["driving"],
        "pitch.length_driven_mm": length * distance,
        "pitch.driven_convex": (measured["hollow_driven"] <= STRAIGHT).astype(float),
        "pitch.min_radius_driven_mm": distance / measured["driven"],
        "pitch.max_tangent_angle_deg": tangent_deg,
        "pitch.max_pressure_angle_deg": tangent_deg + carrying,
    }


def _distance(batch: Batch, length: Array) -> tuple[Array, Mask]:
    """Centre distances in mm of pitch curves of a length at unit distance, and whether teeth fill them.

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


def _require_size(batch: Batch, length: float, row: int) -> None:
    """Refuse teeth that do not fill the pitch curves of one design; raises WrongInput."""
    lobes = batch.kind.lobes
    given = [batch.given(f"gears.{name}") for name in SIZES]
    teeth, module_mm, distance_mm = (None if values is None else float(values[row]) for values in given)
    size = solved_size(
        length * lobes.driving / lobes.driven, lobes, None if teeth is None else int(teeth), module_mm, distance_mm
    )
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
    at = starts[row] + values_at(integration(count) @ widths[:, row], share)
    # The end of a period is the beginning of the next one.
    period = lobes.driving_period_rad
    at = np.where(period - at % period > ROUNDED_RAD, at % period, 0.0)
    first = np.full(laws, np.inf)
    np.minimum.at(first, law[row], at)
    return first
