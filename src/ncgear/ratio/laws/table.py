"""A law given by points: displacements of the slider, or ratios, interpolated by a periodic quintic spline.

The mechanism first turns displacements into crank angles, point by point, and the driven angle is interpolated: it is
smooth at the dead centres, where the displacement's own spline would have to hit a double zero.
Ratios are interpolated as 1/i12, so that the driven angle is the spline's exact integral.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanism, Output
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import in_words
from ncgear.ratio.laws.integrated import integrated_law, splined_slope
from ncgear.ratio.transmission import DrivenGearStops, Lobes, Piece, Transmission

DEGREE = 5
MOST_POINTS = 2000
"""Most points of a cycle; with more the curvature of the pitch curves is lost. A spline through points h apart
magnifies their rounding by 1/h^3 there: 1e-7 for 16 digits and 4000 points (tests/test_laws.py)."""

AT_DEAD_CENTRE = 1e-6
"""Share of the stroke within which a point counts as the dead centre: a micrometre per metre, finer than tables are."""


def displacement_table_law(phi1_rad: Array, displacement_mm: Array, linkage: Mechanism, lobes: Lobes) -> Transmission:
    """The law through displacements (shape (n,)) at driving angles within one cycle.

    The first point must be phi1 = 0 at the retracted end, one point the extended end; displacements rise before and
    fall after it. Raises WrongInput for other points, NoSuchMechanism where the slider would turn back.
    """
    place = linkage.OUTPUT.place
    key = f"motion.displacement_{place.ending}"
    lobes.require_one_cycle()
    phi1, displacement = _without_closing_row(phi1_rad, displacement_mm, lobes, key)
    crank = linkage.crank_angle(*_strokes(phi1, displacement, linkage, key))

    def through(crank_rad: Array) -> Transmission:
        spline = _periodic_spline(phi1, crank_rad - phi1 * lobes.driving, lobes, key)
        driven_angle = partial(splined_angle, spline, lobes.driving)
        return Transmission((Piece(0.0, lobes.driving_period_rad, driven_angle, tuple(phi1[1:].tolist())),), lobes)

    def in_file(crank_rad: float) -> float:
        return place.factor * float(linkage.displacement(Jet(np.array([[crank_rad]]))).value[0])

    movable = np.nonzero((displacement > 0.0) & (displacement < np.max(displacement)))[0]
    points = TablePoints(phi1, crank, movable, phi1 * lobes.driving, in_file, place.text, key)
    return _with_advice(through, points, lobes)


def ratio_table_law(phi1_rad: Array, ratio: Array, lobes: Lobes, *, scale_to_close: bool) -> Transmission:
    """The law through ratios i12 (shape (n,)) at driving angles within one cycle.

    Raises WrongInput for ratios that are not positive, NoSuchMechanism when the cycle does not close.
    """
    key = "motion.ratio"
    phi1, values = _without_closing_row(phi1_rad, ratio, lobes, key)
    if not np.all(values > 0.0):
        worst = int(np.argmin(values))
        raise WrongInput(
            f"the ratio is {values[worst]:g} at phi1 = {phi1[worst]:.6g} rad; it must be positive", key=key
        )

    def through(inverse: Array) -> Transmission:
        spline = _periodic_spline(phi1, inverse, lobes, key)
        whole = splined_slope(partial(spline_jet, spline), phi1[phi1 > 0.0], lobes, key)
        return integrated_law([whole], lobes, scale_to_close=scale_to_close, key=key)

    points = TablePoints(
        phi1, 1.0 / values, np.arange(phi1.size), np.zeros_like(phi1), lambda value: 1.0 / value, "", key
    )
    return _with_advice(through, points, lobes)


def _without_closing_row(phi1: Array, values: Array, lobes: Lobes, key: str) -> tuple[Array, Array]:
    """The points without a last point that repeats the first; raises WrongInput where the two differ."""
    period = lobes.driving_period_rad
    if phi1[-1] > period * (1.0 + 1e-12):
        raise WrongInput(f"the last point is at {phi1[-1]:.6g} rad; one cycle ends at {period:.6g} rad", key=key)
    if phi1[-1] < period * (1.0 - 1e-12):
        return phi1, values
    if phi1[0] == 0.0 and abs(values[-1] - values[0]) > AT_DEAD_CENTRE * np.max(np.abs(values)):
        raise WrongInput(f"the cycle ends with {values[-1]:g} but begins with {values[0]:g}", key=key)
    return phi1[:-1], values[:-1]


def _strokes(phi1: Array, displacement: Array, linkage: Mechanism, key: str) -> tuple[Array, Mask]:
    """Displacements snapped to the dead centres, and a mask of the points of the return."""
    stroke, near = linkage.stroke_mm, AT_DEAD_CENTRE * linkage.stroke_mm
    top = int(np.argmax(displacement))
    unit, told = linkage.OUTPUT.place.text, linkage.OUTPUT.place.factor * displacement
    if phi1[0] != 0.0 or abs(displacement[0]) > near:
        raise WrongInput(
            f"the first point is ({phi1[0]:g} rad, {told[0]:g} {unit}); it must be (0, 0), the retracted end", key=key
        )
    if abs(displacement[top] - stroke) > near:
        raise WrongInput(
            f"the largest displacement is {told[top]:g} {unit}; one point must be the extended end, "
            f"{linkage.OUTPUT.place.factor * stroke:.9g} {unit}",
            key=key,
        )
    _refuse_turning(phi1, told, top, linkage.OUTPUT, key)
    snapped = np.clip(displacement, 0.0, stroke)
    snapped[0], snapped[top] = 0.0, stroke
    return snapped, np.arange(snapped.size) > top


def _refuse_turning(phi1: Array, displacement: Array, top: int, output: Output, key: str) -> None:
    """Refuse displacements that do not rise to the extended end and fall from there to 0 at the end of the cycle."""
    closed = np.append(displacement, 0.0)
    steps = np.diff(closed) * np.where(np.arange(displacement.size) < top, 1.0, -1.0)
    wrong = np.nonzero(steps <= 0.0)[0]
    if not wrong.size:
        return
    first = int(wrong[0])
    fixed = 0, top, displacement.size
    # Either end of the step can be moved, but no dead centre: the later end if its neighbours leave it room.
    moved = next((at for at in (first + 1, first) if at not in fixed and _between(closed, at, top)), None)
    unit = output.place.text
    between = "" if moved is None else f"{_between(closed, moved, top)} {unit}"
    room = "" if moved is None else f"; at {in_words(phi1[moved])} over {between} is right"
    if steps[first] < 0.0:
        done = f"turns back after phi1 = {in_words(phi1[first])}; it may only at both ends"
    else:
        done = f"stands still at {closed[first]:g} {unit} after phi1 = {in_words(phi1[first])}; no ratio is infinite"
    raise WrongInput(f"the {output.name} {done}{room}", key=key if moved is None else f"{key}.{moved}")


def _between(closed: Array, at: int, top: int) -> str:
    """``30 and under 70``: the room between a point's neighbours, empty where they leave none in its stroke."""
    low, high = (closed[at - 1], closed[at + 1]) if at < top else (closed[at + 1], closed[at - 1])
    return f"{low:g} and under {high:g}" if float(f"{low:g}") < float(f"{high:g}") else ""


@dataclass(frozen=True, eq=False)
class TablePoints:
    """Points at phi1 (shape (n,)), their interpolated ``values``, and the numbers of the movable points.

    ``values`` less ``trend`` are periodic.  ``in_file`` turns a value into the file's number, in its ``unit``.
    """

    phi1: Array
    values: Array
    movable: IndexArray
    trend: Array
    in_file: Callable[[float], float]
    unit: str
    key: str


NEAR = 6
"""Points blamed for a smooth curve that turns back: three on each side, as many as shape a piece of a quintic."""


def _with_advice(through: Callable[[Array], Transmission], points: TablePoints, lobes: Lobes) -> Transmission:
    """The law through the points; where the curve between them turns back, the refusal names a point to move."""
    try:
        return through(points.values)
    except DrivenGearStops as fault:
        problem, at = fault.problem, fault.at_rad
    moves = list(_moves(through, points, lobes, at))
    if not moves:
        advice = "no single point of the table mends that: points on a smoother curve are needed"
        raise NoSuchMechanism(f"{problem}. A smooth curve through the points does this; {advice}", key=points.key)
    _, number, value = max(moves)
    unit = f" {points.unit}" if points.unit else ""
    raise NoSuchMechanism(
        f"{problem}. A smooth curve through the points does this; with {value:.4g}{unit} in place of "
        f"{points.in_file(points.values[number]):.6g}{unit} at {in_words(points.phi1[number])} it does not",
        key=f"{points.key}.{number}",
    )


def _moves(
    through: Callable[[Array], Transmission], points: TablePoints, lobes: Lobes, at_rad: float
) -> Iterator[tuple[float, int, float]]:
    """Moves of one point near an angle onto the curve of the others, where a law then exists.

    Each has the least dphi2/dphi1 of that law, the point's number and its new value in the file.
    """
    period = lobes.driving_period_rad
    distance = np.abs((points.phi1[points.movable] - at_rad + period / 2.0) % period - period / 2.0)
    for number in points.movable[np.argsort(distance)[:NEAR]].tolist():
        kept = np.arange(points.phi1.size) != number
        others = _periodic_spline(points.phi1[kept], (points.values - points.trend)[kept], lobes, points.key)
        value = float(spline_jet(others, points.phi1[[number]], 0).value[0]) + points.trend[number]
        moved = np.where(kept, points.values, value)
        try:
            slowest = through(moved).slope_range[0].value
        except NoSuchMechanism:
            continue
        yield slowest, number, points.in_file(value)


def _periodic_spline(phi1: Array, values: Array, lobes: Lobes, key: str) -> BSpline:
    if phi1.size > MOST_POINTS:
        raise WrongInput(
            f"{phi1.size} points a cycle; a smooth curve through so many magnifies their rounding until the pitch "
            f"curves have no curvature. At most {MOST_POINTS} are right: keep every {-(-phi1.size // MOST_POINTS)}th",
            key=key,
        )
    degree = DEGREE if phi1.size > DEGREE else 3
    closed = np.append(phi1, phi1[0] + lobes.driving_period_rad), np.append(values, values[0])
    return make_interp_spline(*closed, k=degree, bc_type="periodic")


def splined_angle(spline: BSpline, lobes: int, phi1: Array, order: int) -> Jet:
    """phi2 in rad, with derivatives: a spline plus an even turn; ``lobes`` are the driving gear's."""
    return spline_jet(spline, phi1, order) + Jet.variable(phi1, order) * float(lobes)


def spline_jet(spline: BSpline, points: Array, order: int) -> Jet:
    """Values and derivatives; the spline is periodic, whatever its first knot."""
    rows, factorial = [], 1.0
    for k in range(order + 1):
        factorial *= max(k, 1)
        rows.append(np.asarray(spline(points, nu=k, extrapolate="periodic")) / factorial)
    return Jet(np.array(rows))
