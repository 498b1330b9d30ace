"""High-precision references of every motion law: driven angle, its first two derivatives, and what follows from them.

A law is built from the plain values of a design file by its definition alone: the stroke by the law of cosines, the
return by partial fractions, ratios by quadrature, tables by collocation of B-splines.  Angles in rad, lengths in mm.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

from mpmath import mp

from oracles import pitch_curves
from oracles.log_ratios import Harmonics, LogRatio, Splined, spline
from oracles.quadrature import integral
from oracles.stroke import Linkage, Stroke, StrokeParameters, exact, polynomial, solve

Real = Any  # mpf
Motion = tuple[Real, Real, Real]
"""phi2, dphi2/dphi1, d2phi2/dphi1^2."""

DIGITS = 40


@dataclass(frozen=True)
class Piece:
    """A smooth stretch of a law: phi2(phi1), and its first two derivatives, which often are to be had without it."""

    driven: Callable[[Real], Real]
    slopes: Callable[[Real], tuple[Real, Real]]

    def rolled(self, phi1: Real) -> Real:
        """Speed of the pitch point along the driving curve: r1 = s/(1 + s) at unit centre distance."""
        slope, bend = self.slopes(phi1)
        return mp.sqrt((slope / (1 + slope)) ** 2 + (bend / (1 + slope) ** 2) ** 2)


@dataclass(frozen=True)
class Law:
    """One period on consecutive pieces that end at ``joints``, the first at 0; lobes n1, n2."""

    linkage: Linkage
    joints: tuple[Real, ...]
    pieces: tuple[Piece, ...]
    lobes: tuple[int, int] = (1, 1)

    def motion(self, phi1: Real, *, from_left: bool = False) -> Motion:
        """phi2 and derivatives at 0 <= phi1 <= the cycle; at a joint of the piece after it, or before it."""
        period = self.joints[-1]
        cycles = mp.floor(phi1 / period)
        if from_left and phi1 == cycles * period:
            cycles -= 1
        local = phi1 - cycles * period
        inner = self.joints[1:-1]
        index = sum(local > joint if from_left else local >= joint for joint in inner)
        piece = self.pieces[index]
        return piece.driven(local) + cycles * 2 * mp.pi / self.lobes[1], *piece.slopes(local)

    def slider(self, phi1: Real, *, from_left: bool = False) -> Motion:
        """Displacement, and its first two derivatives by phi1."""
        driven, slope, bend = self.motion(phi1, from_left=from_left)
        first, second = bends(self.linkage, driven)
        return self.linkage.displacement(driven), first * slope, second * slope**2 + first * bend

    @cached_property
    def period_length(self) -> Real:
        """Length of one period of the pitch curve at unit centre distance."""
        with mp.workdps(DIGITS):
            stretches = zip(self.pieces, self.joints[:-1], self.joints[1:], strict=True)
            return sum(integral(piece.rolled, start, end) for piece, start, end in stretches)


def bends(linkage: Linkage, driven: Real) -> tuple[Real, Real]:
    """First and second derivative of the slider's displacement by phi2."""
    crank, rod, offset = linkage.lengths()
    angle = linkage.crank_angle(driven)
    sine, cosine = crank * mp.sin(angle), crank * mp.cos(angle)
    lateral = sine - offset
    along = mp.sqrt(rod**2 - lateral**2)
    second = -cosine - (cosine**2 - lateral * sine) / along - (lateral * cosine) ** 2 / along**3
    return sine + lateral * cosine / along, second


def crank_angle(linkage: Linkage, displacement: Real) -> Real:
    """phi2 in the working stroke, by the law of cosines in the triangle of crank, rod and crank axis to slider."""
    crank, rod, offset = linkage.lengths()
    position = displacement + mp.sqrt((rod - crank) ** 2 - offset**2)
    distance = mp.hypot(position, offset)
    at_crank = mp.acos((crank**2 + distance**2 - rod**2) / (2 * crank * distance))
    return mp.pi + mp.asin(offset / (rod - crank)) - mp.atan2(offset, position) - at_crank


def returning_angle(linkage: Linkage, displacement: Real) -> Real:
    """phi2 in the return: the mirrored triangle."""
    crank, rod, offset = linkage.lengths()
    position = displacement + mp.sqrt((rod - crank) ** 2 - offset**2)
    tilt = mp.asin(offset / (rod - crank)) - mp.atan2(offset, position)
    return 2 * mp.pi + 2 * tilt - crank_angle(linkage, displacement)


# --- laws --------------------------------------------------------------------------------------------------------


class Asked(NamedTuple):
    """What a law is made from: values under ``motion``, the linkage, lobes n1 and n2, and ``closing`` of ``law``."""

    motion: dict[str, Any]
    linkage: Linkage
    lobes: tuple[int, int]
    closing: tuple[float, float]


def law(data: dict[str, Any], closing: tuple[float, float] = (0.0, 0.0)) -> Law:
    """The law of a design file's values.

    ``closing``, of a stroke, are the multiples of tau^2 (1 - tau)^2 and of (2 tau - 1) times it in the return: the
    first only a start of the search for the one that closes, the second taken as it is where the file gives no e.
    """
    motion, lobes = data["motion"], data.get("gears", {}).get("lobes", {"driving": 1, "driven": 1})
    asked = Asked(motion, linkage_of(data), (lobes["driving"], lobes["driven"]), closing)
    with mp.workdps(DIGITS):
        return REFERENCES[motion["law"]](asked)


def linkage_of(data: dict[str, Any]) -> Linkage:
    """The linkage of a design file's values."""
    lengths = data["linkage"]
    return Linkage(lengths["crank_mm"], lengths["rod_mm"], lengths.get("offset_mm", 0.0))


def angle(group: dict[str, Any], name: str) -> str:
    """A file's angle in rad as an exact product."""
    units = {"rad": "1", "deg": "pi/180", "pi": "pi"}
    unit = next((unit for unit in units if f"{name}_{unit}" in group), None)
    return "0" if unit is None else f"{Decimal(group[f'{name}_{unit}'])}*{units[unit]}"


def _stroke_law(motion: dict[str, Any], linkage: Linkage, closing: tuple[float, float]) -> Law:
    angles = [angle(motion, f"theta{k}") for k in (1, 2, 3, 4)]
    speed = motion.get("a1_speed_rpm")
    reference = None if speed is None else f"{Decimal(speed)}*pi/30"
    sizes = motion["v1_mm_s"], motion["v2_mm_s"], motion["a1_mm_s2"], linkage.crank, linkage.rod, linkage.offset
    stroke = Stroke(StrokeParameters(*angles, *sizes, reference))
    theta = solve(stroke.parameters).theta
    joints = [mp.mpf(0), theta[1], theta[2], theta[3], 2 * mp.pi]
    back = _Return.of(stroke, motion.get("return", {}).get("e"), closing)
    working = [_working(stroke, segment) for segment in range(3)]
    stretches = zip([*working, Piece(back.driven, back.slopes)], joints[:-1], joints[1:], strict=True)
    pieces = tuple(piece for piece, start, end in stretches if end > start)
    return Law(linkage, tuple(dict.fromkeys(joints)), pieces)


def _working(stroke: Stroke, segment: int) -> Piece:
    """The inverted stroke; at both dead centres by the limits of zero by zero."""
    solved, linkage = solve(stroke.parameters), stroke.linkage
    end = solved.theta[3]

    def driven(phi1: Real) -> Real:
        if phi1 in (0, end):
            return linkage.working_angle() if phi1 else mp.mpf(0)
        return crank_angle(linkage, polynomial(solved.segments[segment], phi1))

    def slopes(phi1: Real) -> tuple[Real, Real]:
        if phi1 in (0, end):
            ratio, bend = stroke.ratio(phi1), stroke.ratio_slope_at_dead_centre(bool(phi1))
            return 1 / ratio, -bend / ratio**2
        _, speed, bend = (polynomial(solved.segments[segment], phi1, order) for order in range(3))
        first, second = bends(linkage, driven(phi1))
        return speed / first, (bend - second * (speed / first) ** 2) / first

    return Piece(driven, slopes)


@dataclass(frozen=True)
class _Return:
    """i12 as a polynomial of tau in rising powers."""

    coefficients: tuple[Real, ...]
    start: Real
    driven_start: Real

    @classmethod
    def of(cls, stroke: Stroke, e: Any, closing: tuple[float, float]) -> _Return:
        start, turned = stroke.theta4, stroke.linkage.working_angle()
        length = 2 * mp.pi - start
        ends = [(stroke.ratio(start), stroke.ratio_slope_at_dead_centre(True)),
                (stroke.ratio(0), stroke.ratio_slope_at_dead_centre(False))]  # fmt: skip
        base = _hermite([(value, slope * length) for value, slope in ends])
        bump, skewed = (0, 0, 1, -2, 1, 0), (0, 0, -1, 4, -5, 2)
        origin = -start / length

        def skewness(multiple: Real) -> Real:
            if not isinstance(e, int | float):
                return mp.mpf(closing[1])
            missing = e - polynomial(base, origin) - multiple * polynomial(bump, origin)
            return missing / polynomial(skewed, origin)

        def shape(multiple: Real) -> tuple[Real, ...]:
            k = skewness(multiple)
            return tuple(b + multiple * p + k * q for b, p, q in zip(base, bump, skewed, strict=True))

        def excess(multiple: Real) -> Real:
            return length * _inverted_integral(shape(multiple), mp.mpf(1)) - (2 * mp.pi - turned)

        first = mp.mpf(closing[0])
        multiple = mp.findroot(excess, (first, first * (1 + mp.mpf(10) ** -9)), solver="secant", tol=1e-60)
        return cls(shape(multiple), start, turned)

    @property
    def length(self) -> Real:
        """Driving angle of the return."""
        return 2 * mp.pi - self.start

    def driven(self, phi1: Real) -> Real:
        """phi2."""
        return self.driven_start + self.length * _inverted_integral(
            self.coefficients, (phi1 - self.start) / self.length
        )

    def slopes(self, phi1: Real) -> tuple[Real, Real]:
        """dphi2/dphi1 and its slope."""
        tau = (phi1 - self.start) / self.length
        value, slope = polynomial(self.coefficients, tau), polynomial(self.coefficients, tau, 1) / self.length
        return 1 / value, -slope / value**2


def _hermite(ends: list[tuple[Real, Real]]) -> tuple[Real, ...]:
    """Cubic on 0..1, padded to degree five."""
    (value0, slope0), (value1, slope1) = ends
    rise = value1 - value0
    return value0, slope0, 3 * rise - 2 * slope0 - slope1, slope0 + slope1 - 2 * rise, mp.mpf(0), mp.mpf(0)


def _inverted_integral(coefficients: Sequence[Real], end: Real) -> Real:
    """Integral of 1/polynomial from 0 to ``end``, by partial fractions over its roots."""
    roots = mp.polyroots(list(coefficients)[::-1], maxsteps=200, extraprec=200)
    return mp.re(sum(mp.log(1 - end / root) / polynomial(tuple(coefficients), root, 1) for root in roots))


def _ratio_law(slope: Callable[[Real], Real], knots: list[Real], linkage: Linkage, lobes: tuple[int, int]) -> Law:
    """The law whose dphi2/dphi1 is the slope times the constant that closes it; analytic between knots."""
    parts = [integral(slope, a, b) for a, b in pairwise(knots)]
    factor = 2 * mp.pi / lobes[1] / sum(parts)

    def piece(index: int) -> Piece:
        before, start = sum(parts[:index]), knots[index]
        return Piece(
            lambda phi1: factor * (before + (integral(slope, start, phi1) if phi1 > start else 0)),
            lambda phi1: (factor * slope(phi1), factor * mp.diff(slope, phi1)),
        )

    return Law(linkage, tuple(knots), tuple(piece(k) for k in range(len(parts))), lobes)


WORDS = {name: getattr(mp, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "pi")}


def _by_slope(asked: Asked, slope: Callable[[Real], Real]) -> Law:
    """The law of dphi2/dphi1, which is analytic and may lack a constant factor."""
    return _ratio_law(slope, [mp.mpf(0), 2 * mp.pi / asked.lobes[0]], asked.linkage, asked.lobes)


def _formula_slope(motion: dict[str, Any]) -> Callable[[Real], Real]:
    if "driven_angle" in motion:
        return lambda phi: mp.diff(lambda at: _formula(motion["driven_angle"], at), phi)
    return lambda phi: 1 / _formula(motion["ratio"], phi)


def _formula(text: str, phi: Real) -> Real:
    return eval(text, {"__builtins__": {}}, {**WORDS, "phi": phi})


def _elliptical(motion: dict[str, Any], lobes: tuple[int, int]) -> Callable[[Real], Real]:
    """i12 = a/r1 - 1 with r1 = 1/(1 + e cos x); a closes it: mean of 1/i12 is n1/n2 = 1/sqrt((a-1)^2 - (a e)^2)."""
    eccentricity, phase = mp.mpf(motion["eccentricity"]), exact(angle(motion, "phase"))
    wanted = mp.mpf(lobes[1]) / lobes[0]
    size = mp.findroot(lambda a: (a - 1) ** 2 - (a * eccentricity) ** 2 - wanted**2, (1 + wanted) / (1 - eccentricity))
    return lambda phi: 1 / (size * (1 + eccentricity * mp.cos(lobes[0] * (phi - phase))) - 1)


def _table_law(asked: Asked) -> Law:
    if "displacement_mm" in asked.motion:
        return _displacement_table(asked.motion, asked.linkage)
    angles, slopes = _table(asked.motion, "ratio", lambda value: 1 / mp.mpf(value))
    period = 2 * mp.pi / asked.lobes[0]
    knots = [mp.mpf(0), *(at for at in angles if 0 < at < period), period]
    return _ratio_law(spline(angles, slopes), knots, asked.linkage, asked.lobes)


def _table(motion: dict[str, Any], column: str, of: Callable[[Any], Real]) -> tuple[list[Real], list[Real]]:
    units = {"phi1_rad": mp.mpf(1), "phi1_deg": mp.pi / 180, "phi1_pi": mp.pi}
    key = next(key for key in units if key in motion)
    return [mp.mpf(at) * units[key] for at in motion[key]], [of(value) for value in motion[column]]


def _displacement_table(motion: dict[str, Any], linkage: Linkage) -> Law:
    angles, displacements = _table(motion, "displacement_mm", mp.mpf)
    top = max(range(len(angles)), key=lambda k: displacements[k])
    cranks = [
        mp.mpf(0) if k == 0 else linkage.working_angle() if k == top
        else (crank_angle if k < top else returning_angle)(linkage, x)
        for k, x in enumerate(displacements)
    ]  # fmt: skip
    excess = spline(angles, [crank - at for crank, at in zip(cranks, angles, strict=True)])

    start = excess(mp.mpf(0))
    piece = Piece(lambda phi1: phi1 + excess(phi1) - start, lambda phi1: (1 + excess(phi1, 1), excess(phi1, 2)))
    return Law(linkage, (*angles, 2 * mp.pi), (piece,) * len(angles))


@dataclass(frozen=True)
class OverDriven(Law):
    """A law whose pitch curve is measured over the driven angle, which needs no inverse."""

    log_ratio: LogRatio = field(kw_only=True)

    @cached_property
    def period_length(self) -> Real:
        """Length of one period of the pitch curve at unit centre distance."""
        n1, n2 = self.lobes

        def rolled(t: Real) -> Real:
            speed, bend = self.log_ratio.speed(t)
            slope, bend = speed * n1 / n2, bend * n1**2 / mp.mpf(n2)
            return mp.sqrt((slope / (1 + slope)) ** 2 + (bend / (1 + slope) ** 2) ** 2) / (speed * n1)

        with mp.workdps(DIGITS):
            return sum(integral(rolled, start, end) for start, end in pairwise(self.log_ratio.knots))


def _over_driven(asked: Asked, log_ratio: LogRatio) -> Law:
    """The law of ln i12 over t = n2 phi2, analytic between its knots."""
    n1, n2 = asked.lobes

    def slopes(phi1: Real) -> tuple[Real, Real]:
        speed, bend = log_ratio.speed(log_ratio.inverse(phi1 * n1))
        return speed * n1 / n2, bend * n1**2 / mp.mpf(n2)

    piece = Piece(lambda phi1: log_ratio.inverse(phi1 * n1) / n2, slopes)
    inner = [log_ratio.turned(t) / log_ratio.mean / n1 for t in log_ratio.knots[1:-1]]
    joints = mp.mpf(0), *inner, 2 * mp.pi / n1
    return OverDriven(asked.linkage, joints, (piece,) * (len(joints) - 1), asked.lobes, log_ratio=log_ratio)


def _harmonic_law(asked: Asked) -> Law:
    return _over_driven(asked, Harmonics(tuple(asked.motion.get("cosine", ())), tuple(asked.motion.get("sine", ()))))


def _spline_ratio_law(asked: Asked) -> Law:
    values = [mp.log(mp.mpf(ratio)) for ratio in asked.motion["ratio"]]
    units = {"driven_angle_rad": mp.mpf(1), "driven_angle_deg": mp.pi / 180, "driven_angle_pi": mp.pi}
    even = [2 * mp.pi * k / len(values) for k in range(len(values))]
    given = [[mp.mpf(at) * unit for at in asked.motion[key]] for key, unit in units.items() if key in asked.motion]
    return _over_driven(asked, Splined.through(given[0] if given else even, values))


def _pitch_curve_law(asked: Asked) -> Law:
    """The mate of a driving gear's pitch curve; the search for what closes it starts at a figure in doubles."""
    motion, (own, mate) = asked.motion, asked.lobes
    start = asked.closing[0] or _rough_distance(motion, asked.lobes)
    made = pitch_curves.closed(motion, asked.lobes, exact(angle(motion, "phase")), _formula, start)
    joints = [joint for joint in made.curve.joints if joint <= 2 * mp.pi / own]

    def slope(phi1: Real) -> Real:
        radius = made.curve.radius(phi1)
        return radius / (made.distance - radius)

    ends = [*joints, 2 * mp.pi / own] if joints[-1] < 2 * mp.pi / own else joints
    return _ratio_law(slope, ends, asked.linkage, (own, mate))


def _rough_distance(motion: dict[str, Any], lobes: tuple[int, int]) -> Real:
    """A centre distance to start from: (1 + m/n) times the mean of the greatest and the mean radius."""
    curve = pitch_curves.curve(motion, _formula)
    radii = [curve.radius(2 * mp.pi * k / 40) for k in range(40)]
    return (1 + mp.mpf(lobes[1]) / lobes[0]) * (max(radii) + sum(radii) / 40) / 2


def _open_law(asked: Asked, driven: Callable[[Real], Real], end: Real) -> Law:
    """The law of a driven angle over a range, which has one piece."""
    piece = Piece(driven, lambda phi1: (mp.diff(driven, phi1), mp.diff(driven, phi1, 2)))
    return Law(asked.linkage, (mp.mpf(0), end), (piece,))


def _spiral(asked: Asked) -> Law:
    """dphi2 = r1 / (1 - r1) dphi1 with r1 = r0 exp(m phi1), by quadrature."""
    start, end = (1 / (1 + mp.mpf(asked.motion[key])) for key in ("ratio_start", "ratio_end"))
    turned = exact(angle(asked.motion, "range"))
    growth = mp.log(end / start) / turned

    def radius(phi1: Real) -> Real:
        return start * mp.exp(growth * phi1)

    return _open_law(asked, lambda phi1: integral(lambda at: radius(at) / (1 - radius(at)), mp.mpf(0), phi1), turned)


def _function_generator(asked: Asked) -> Law:
    """Both angles as scales of x and of y."""
    first, last = (mp.mpf(asked.motion[key]) for key in ("x_from", "x_to"))
    ranges = [exact(angle(asked.motion, name)) for name in ("driving_range", "driven_range")]

    def y(x: Real) -> Real:
        return eval(asked.motion["function"], {"__builtins__": {}}, {**WORDS, "x": x})

    def driven(phi1: Real) -> Real:
        return ranges[1] * (y(first + (last - first) * phi1 / ranges[0]) - y(first)) / (y(last) - y(first))

    return _open_law(asked, driven, ranges[0])


def _in_series(asked: Asked) -> Law:
    """Analytic laws one after the other, by the chain rule."""
    laws = [REFERENCES[pair["law"]](asked._replace(motion=pair, lobes=(1, 1))) for pair in asked.motion["pairs"]]
    assert all(len(each.joints) == 2 for each in laws), "a joint within a turn is a joint of the whole"

    def turned(phi1: Real) -> Motion:
        driven, slope, bend = phi1, mp.mpf(1), mp.mpf(0)
        for each in laws:
            driven, speed, change = each.motion(driven)
            slope, bend = speed * slope, change * slope**2 + speed * bend
        return driven, slope, bend

    piece = Piece(lambda phi1: turned(phi1)[0], lambda phi1: turned(phi1)[1:])
    return Law(asked.linkage, (mp.mpf(0), 2 * mp.pi), (piece,))


REFERENCES: dict[str, Callable[[Asked], Law]] = {
    "three_segment_stroke": lambda asked: _stroke_law(asked.motion, asked.linkage, asked.closing),
    "ratio_expression": lambda asked: _by_slope(asked, _formula_slope(asked.motion)),
    "harmonic_ratio": _harmonic_law,
    "spline_ratio": _spline_ratio_law,
    "ellipse": lambda asked: _by_slope(asked, _elliptical(asked.motion, asked.lobes)),
    "table": _table_law,
    "pitch_curve": _pitch_curve_law,
    "uniform_crank": lambda asked: _by_slope(asked, lambda phi: mp.mpf(1)),
    "spiral": _spiral,
    "function_generator": _function_generator,
    "in_series": _in_series,
}
"""By the name of the law."""
