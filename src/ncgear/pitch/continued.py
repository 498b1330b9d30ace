"""The pitch curves of gears that turn less than once, continued to closed curves, on which teeth are made as always.

An open law covers a range of both angles.  Teeth mesh a little beyond both its ends, and everything that makes and
judges teeth goes around closed curves.  So the law is continued beyond its range until both gears have turned by whole
turns, one to three of each, and everything closes.  Where a gear has turned more than once, its curve lies over itself
like the threads of a screw: only the teeth of the range are made, and they lie within one turn.

The logarithm u of dphi2/dphi1 keeps its first three derivatives at both ends, levels off, and changes from one level to
the other. Two bumps are added: one closes the driven angle, the other makes the whole curve a whole number of tooth
pitches long. So an open pair may have any module at any centre distance: its teeth need not fill their curves.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import ceil, floor, pi

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev, jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import in_words
from ncgear.pitch import shape
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.laws.integrated import Slope, stretched
from ncgear.ratio.transmission import OpenRange, Piece, Transmission, WholeTurns

MOST_TURNS = 3
"""Most turns of a gear in the continuation: more would only make its curves longer."""

LEAST_WAY_RAD = pi / 3.0
"""Least angle of either gear over which the law is continued: over less, its curves would bend too sharply."""

LEVELLING_SHARE, MOST_LEVELLING_RAD = 0.25, 1.0
"""Share of the continuation, and largest driving angle, over which u levels off at each end of the range."""

LEVELLINGS = (1.0, 0.5, 0.25)
"""Shares of that angle that are tried: over a shorter angle u changes less, and bends more."""

STEP = 0.1
"""Step of the tried sizes of the second bump, which makes a whole number of pitches."""

WAVES, GREAT_WAVES = STEP * np.arange(-10, 11), STEP * np.arange(-30, 31)
"""Sizes that are tried first, and sizes for curves of few pitches, whose length the first sizes change by less than a
pitch.  The length grows about as the square of the size."""

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(96)
"""Gauss points of a part of the continuation; u is a polynomial of degree 12 or less there."""

GENTLE = 6.0
"""Largest curvature times centre distance of a gentle continuation, however gentle the range is."""

HOLLOW = 3.0
"""Factor by which hollow curves count as sharper: tips foul there."""

TRIED = 4
"""Number of the gentlest continuations that are tried for a whole number of pitches."""


@dataclass(frozen=True, eq=False)
class _Part:
    """u on a part of the continuation: a polynomial of x, which runs from -1 at ``start_rad`` to 1 at its end."""

    start_rad: float
    width_rad: float
    coefficients: Array

    def slope(self, phi1: Array, order: int) -> Jet:
        """dphi2/dphi1 with derivatives by phi1."""
        x = (Jet.variable(phi1, order) - self.start_rad) * (2.0 / self.width_rad) - 1.0
        return jet.exp(jet.polynomial(self.coefficients, x))

    @property
    def points_rad(self) -> Array:
        """The Gauss points."""
        return self.start_rad + self.width_rad * (1.0 + POINTS) / 2.0


@dataclass(frozen=True, eq=False)
class _Way:
    """A continuation by given turns, from the end of the range to its beginning a number of turns later."""

    turns: tuple[int, int]
    run_out: _Part
    over: _Part
    run_in: _Part
    driven_rad: float
    """Angle by which the driven gear turns on the continuation."""

    def with_bumps(self, lift: float, wave: float) -> tuple[_Part, _Part, _Part]:
        """The parts with u raised by ``lift`` and ``wave`` times the bumps on the middle part."""
        raised = np.zeros(WAVE.size)
        raised[: self.over.coefficients.size] = self.over.coefficients
        raised[: LIFT.size] += lift * LIFT
        middle = _Part(self.over.start_rad, self.over.width_rad, raised + wave * WAVE)
        return self.run_out, middle, self.run_in


_X = np.polynomial.Polynomial([0.0, 1.0])

_BUMP = (1.0 - _X**2) ** 4
"""With it u keeps three continuous derivatives."""

LIFT: Array = np.asarray(_BUMP.coef, dtype=float)
WAVE: Array = np.asarray((_BUMP * (1.0 - 8.0 * _X**2 + 8.0 * _X**4)).coef, dtype=float)
"""The bump, and the bump times the fourth Chebyshev polynomial, by powers of x."""

CHANGE = np.array([16.0, 35.0, 0.0, -35.0, 0.0, 21.0, 0.0, -5.0]) / 32.0
"""The polynomial from 0 to 1 with three derivatives that vanish at both ends."""


def continued(law: Transmission, covered: OpenRange, pitch_share: float) -> Transmission:
    """An open law continued to whole turns and tooth pitches (``pitch_share``); raises NoSuchMechanism if too sharp."""
    known = _length(law)
    for at_rad, piece in ((0.0, law.pieces[0]), (covered.driving_rad, law.pieces[-1])):
        if not np.all(np.isfinite(piece.slope(np.array([at_rad]), 3).coefficients)):
            raise NoSuchMechanism(
                f"the ratio has no finite slope, curvature or third derivative at phi1 = {in_words(at_rad)}, an end of "
                "the range, so that the pitch curves do not go on beyond it as the teeth there need it; a range that "
                "ends before that place is right",
                key="motion",
            )
    gentle = max(GENTLE, *(abs(value) for value in _range_sharpness(law)))
    ways = [(sharpness, way) for way in _ways(law, covered) if np.isfinite(sharpness := _sharpness(way, 0.0))]
    ranked = [way for _, way in sorted(ways, key=lambda tried: (max(tried[0] / gentle, 1.0), sum(tried[1].turns)))]
    found: list[tuple[float, _Way, float, int]] = []
    for way, waves in (*product(ranked[:TRIED], [WAVES]), *product(ranked, [GREAT_WAVES])):
        if found and (waves is GREAT_WAVES or min(found, key=_choice)[0] == 1.0):
            break
        for wave, pitches in _whole(way, waves, pitch_share, known):
            found.append((max(_sharpness(way, wave) / gentle, 1.0), way, wave, pitches))
    if not found:
        raise NoSuchMechanism(
            f"the pitch curves cannot be continued beyond the range from {in_words(0.0)} to "
            f"{in_words(covered.driving_rad)}: their slope changes too fast at its ends, or too few tooth pitches are "
            "left for it; a gentler law or a smaller module is right",
            key="motion",
        )
    _, way, near, pitches = min(found, key=_choice)

    from scipy.optimize import brentq

    def missing(wave: float) -> float:
        return _count(way, _lift(way, wave), wave, pitch_share, known) - pitches

    wave = float(brentq(missing, near, near + STEP, xtol=1e-15, rtol=4 * np.finfo(float).eps))
    parts = way.with_bumps(_lift(way, wave), wave)
    lobes = WholeTurns(of=covered, driving_turns=way.turns[0], driven_turns=way.turns[1])
    ends = *(part.start_rad for part in parts[1:]), lobes.driving_period_rad
    slopes = [_slope(part, end) for part, end in zip(parts, ends, strict=True)]
    pieces: list[Piece] = []
    start = covered.driven_rad
    for slope in slopes:
        pieces.append(stretched(slope, start, 1.0))
        start += slope.integral.final
    return Transmission((*law.pieces, *pieces), lobes)


def _choice(found: tuple[float, _Way, float, int]) -> tuple[float, float]:
    """Order of choice: the sharpness beyond gentle curves, then the size of the wave."""
    return found[0], abs(found[2])


def _slope(part: _Part, end_rad: float) -> Slope:
    breaks = [part.start_rad, end_rad]
    return Slope(part.slope, chebyshev.fitted(lambda phi1: part.slope(phi1, 0).value, breaks).integrated())


def _ways(law: Transmission, covered: OpenRange) -> Iterator[_Way]:
    first, last = law.pieces[0], law.pieces[-1]
    leaving = jet.log(last.slope(np.array([last.end_rad]), 3)).coefficients[:, 0]
    entering = jet.log(first.slope(np.array([first.start_rad]), 3)).coefficients[:, 0]
    for driving_turns in range(1, MOST_TURNS + 1):
        for driven_turns in range(1, MOST_TURNS + 1):
            driving = 2.0 * pi * driving_turns - covered.driving_rad
            driven = 2.0 * pi * driven_turns - covered.driven_rad
            if min(driving, driven) < LEAST_WAY_RAD:
                continue
            for share in LEVELLINGS:
                width = share * min(LEVELLING_SHARE * driving, MOST_LEVELLING_RAD)
                out = _levelling(leaving, width)
                # Seen backwards, odd derivatives change their sign.
                back = _levelling(entering * np.array([1.0, -1.0, 1.0, -1.0]), width)
                level, other = float(out.sum()), float(back.sum())
                start = covered.driving_rad
                over = CHANGE * (other - level)
                over[0] += level
                yield _Way(
                    (driving_turns, driven_turns),
                    _Part(start, width, _composed(out, (_X + 1.0) / 2.0)),
                    _Part(start + width, driving - 2.0 * width, over),
                    _Part(start + driving - width, width, _composed(back, (1.0 - _X) / 2.0)),
                    driven,
                )


def _composed(coefficients: Array, of: np.polynomial.Polynomial) -> Array:
    return np.asarray(np.polynomial.Polynomial(coefficients)(of).coef, dtype=float)


def _levelling(taylor: Array, width: float) -> Array:
    """Coefficients of u by the share of a way of ``width`` rad, from given Taylor coefficients to a level stretch.

    du/dt is the polynomial of degree 5 with the given values and two derivatives at t = 0, and zeros at t = 1.
    """
    slope, bend, third = taylor[1] * width, 2.0 * taylor[2] * width**2, 6.0 * taylor[3] * width**3
    by_powers = np.array(
        [
            slope,
            bend,
            third / 2.0,
            -10.0 * slope - 6.0 * bend - 1.5 * third,
            15.0 * slope + 8.0 * bend + 1.5 * third,
            -6.0 * slope - 3.0 * bend - 0.5 * third,
        ]
    )
    return np.concatenate([[taylor[0]], by_powers / np.arange(1.0, 7.0)])


def _integral(part: _Part, function: Array) -> float:
    return float(WEIGHTS @ function) * part.width_rad / 2.0


def _lift(way: _Way, wave: float) -> float:
    """The size of the first bump that brings the driven gear round; its angle grows with the bump."""
    from scipy.optimize import brentq

    ends = (_integral(part, part.slope(part.points_rad, 0).value) for part in (way.run_out, way.run_in))
    rest, middle = way.driven_rad - sum(ends), way.with_bumps(0.0, wave)[1]
    still, raised = (np.polynomial.polynomial.polyval(POINTS, powers) for powers in (middle.coefficients, LIFT))

    def missing(lift: float) -> float:
        return _integral(middle, np.exp(still + lift * raised)) - rest

    low, high = -MOST_LIFT, MOST_LIFT
    if not (rest > 0.0 and missing(low) < 0.0 < missing(high)):
        return np.nan
    return float(brentq(missing, low, high, xtol=1e-15, rtol=4 * np.finfo(float).eps))


MOST_LIFT = 4.0
"""Most that u is raised or lowered: a factor of 55 of the ratio, at which no teeth stand."""


def _whole(way: _Way, waves: Array, pitch_share: float, known: float) -> Iterator[tuple[float, int]]:
    lifts = [_lift(way, wave) for wave in waves]
    counts = [
        _count(way, lift, wave, pitch_share, known) if np.isfinite(lift) else np.nan
        for lift, wave in zip(lifts, waves, strict=True)
    ]
    for wave, before, after in zip(waves, counts, counts[1:], strict=False):
        if not (np.isfinite(before) and np.isfinite(after)):
            continue
        low, high = min(before, after), max(before, after)
        for pitches in range(ceil(low), floor(high) + 1):
            if low < high:
                yield float(wave), pitches


def _count(way: _Way, lift: float, wave: float, pitch_share: float, known: float) -> float:
    length = known
    for part in way.with_bumps(lift, wave):
        length += _integral(part, shape.speed(part.slope(part.points_rad, 1), Gear.DRIVING, Mesh.EXTERNAL).value)
    return length / pitch_share


def _length(law: Transmission) -> float:
    speed = chebyshev.fitted(
        lambda phi1: shape.speed(law.driven_angle(phi1, 2).differentiated(), Gear.DRIVING, Mesh.EXTERNAL).value,
        law.joints_rad,
    )
    return speed.integrated().final


def _sharpness(way: _Way, wave: float) -> float:
    """The greatest curvature of either curve at unit centre distance, at 96 points of each part; NaN without a lift."""
    lift = _lift(way, wave)
    if not np.isfinite(lift):
        return np.nan
    return max(
        _sharper(float(bend.min()), float(bend.max()))
        for part in way.with_bumps(lift, wave)
        for gear in Gear
        for bend in (shape.curvature(part.slope(part.points_rad, 2), gear, Mesh.EXTERNAL).value,)
    )


def _sharper(low: float, high: float) -> float:
    return max(high, -HOLLOW * low)


def _range_sharpness(law: Transmission) -> list[float]:
    def sharpness(gear: Gear) -> float:
        low, high = law.extremes(lambda slope: shape.curvature(slope, gear, Mesh.EXTERNAL), 2)
        return _sharper(low.value, high.value)

    return [sharpness(gear) for gear in Gear]
