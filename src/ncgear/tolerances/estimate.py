"""The share of assemblies that jam, estimated in milliseconds from the contact that a build has found.

It is the linear mesh of ``ncgear.tolerances.mesh`` with few positions and few assemblies.  Its places of contact touch
as designed, at two positions per pitch; ``ncgear tolerance`` takes ten positions, and also the places that nearly
touch.  A few assemblies tell how the needed backlash depends on centre distance, temperature and wear, and how far all
other deviations spread it.  A gamma distribution with that spread then gives the share for which a backlash is too
small, and the backlash that is enough.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import prod, sqrt
from typing import Any, TypeVar

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned
from ncgear.contact.designed.curves import Contacts
from ncgear.contact.placement import Placement
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, counted_up
from ncgear.teeth.gear import ToothedPair
from ncgear.tolerances.drawn import COUNT, SIGMAS, DeviationLimits, deviating, rows_of
from ncgear.tolerances.mesh import ContactPlaces, Deviations, LinearMesh, mesh_at, places_of

PER_PITCH = 2
"""Positions per tooth pitch.  With twice as many, the mean backlash that assemblies need changes by a hundredth."""

LEAST_ASSEMBLIES, MOST_ASSEMBLIES, AT_ONCE = 128, 512, 160_000
"""Least and most assemblies that are drawn; in between, assemblies times places of contact are AT_ONCE, which takes
some three milliseconds."""

SHAPE = 16.0
"""Shape of the gamma distribution of the backlash that bores, tilts and teeth need.  Its skewness is 2 / sqrt(SHAPE) =
0.5: the greatest value at many teeth has a longer tail than a normal distribution."""

FARTHEST = 12.0
"""Standard deviations above the mean beyond which a gamma distribution of that shape holds nothing that matters."""

NORMAL_95 = 1.645
"""Standard deviations above the mean of a normal distribution with 95 % of it below."""

TINY = 1e-12
"""Deviation in mm or degrees that counts as zero."""


@dataclass(frozen=True, eq=False)
class Teeth:
    """The teeth of a pair in contact as designed, and their limits; ``overlap`` is the overlap ratio of a helix."""

    pair: ToothedPair
    contact: AsDesigned
    limits: DeviationLimits
    face_width_mm: float
    overlap: float
    both_ways: bool


@dataclass(frozen=True, eq=False)
class Plays:
    """Least plays in rad of N driven gears, and ``shared`` (3, N): centre distance, temperature and wear."""

    least_rad: Array
    shared: Array


def plays_of(teeth: Teeth, seed: int) -> Plays:
    """The least plays of some assemblies."""
    mesh = _mesh_of(teeth)
    count = int(np.clip(AT_ONCE // mesh.lead.size, LEAST_ASSEMBLIES, MOST_ASSEMBLIES))
    random = np.random.default_rng(seed)
    # Each number of the pair is drawn once in each of as many layers (a Latin hypercube, McKay 1979).
    layers = random.permuted(np.broadcast_to(np.arange(count), (COUNT, count)), axis=1)
    pair = (layers + random.random((COUNT, count))) / count
    # The three in a thousand beyond the limit are kept, which makes the spread greater by a hundredth.
    flanks: Any = random.standard_normal((2, teeth.limits.flanks, count), dtype=np.float32) / np.float32(SIGMAS)
    of = deviating(teeth.limits, pair, flanks)
    play = -mesh.leads(_in_short(of)).sum(axis=0).max(axis=0)
    shared = np.stack([of.rigid[0], pair[rows_of("temperature")][0], pair[rows_of("wear")][0]])
    return Plays(play.astype(float), shared)


def _mesh_of(teeth: Teeth) -> LinearMesh:
    """The linear mesh of the places that touch as designed; the overlap of helical teeth carries along the face width.

    Another section touches with the flanks of another position.  The deviations of these flanks count, with the
    displacements of this position.
    """
    every = teeth.contact.placement
    found = Contacts.joined([teeth.contact.pushing.touching, teeth.contact.back.touching])
    chosen = _tightest(np.bincount(found.position, minlength=every.count), round(every.per_tooth / PER_PITCH))
    placement = replace(
        every,
        rolled_mm=every.rolled_mm[chosen],
        phi1_rad=every.phi1_rad[chosen],
        phi2_rad=every.phi2_rad[chosen],
        speed=every.speed[chosen],
    )
    number = np.full(every.count, -1)
    number[chosen] = np.arange(chosen.size)
    found = found.kept(number[found.position] >= 0)
    found = replace(found, position=number[found.position])
    places = places_of(teeth.pair, teeth.face_width_mm / 2.0, found, placement, both_ways=teeth.both_ways)
    places = places.kept(np.argsort(places.place, kind="stable"))
    arm_mm = np.stack([side.first.lever_mm[chosen] for side in (teeth.contact.pushing, teeth.contact.back)])
    places = _overlapping(places, placement, int(PER_PITCH * teeth.overlap))
    return _in_short(mesh_at(places, placement, arm_mm, mirrored=True))


Values = TypeVar("Values", LinearMesh, Deviations)


def _in_short(values: Values) -> Values:
    """The same teeth in numbers of seven digits: they take half the time."""
    every = vars(values).items()
    long = {name: array for name, array in every if isinstance(array, np.ndarray) and array.dtype == float}
    short: dict[str, Any] = {name: array.astype(np.float32) for name, array in long.items()}
    return replace(values, **short)


def _tightest(touching: IndexArray, stretch: int) -> IndexArray:
    """In each ``stretch`` of positions, the position at which most places touch; ``touching`` is their number."""
    padded = np.append(touching, np.full(-touching.size % stretch, -1)).reshape(-1, stretch)
    return np.arange(0, touching.size, stretch) + padded.argmax(axis=1)


def _overlapping(places: ContactPlaces, placement: Placement, further: int) -> ContactPlaces:
    """Sorted places; each position also has the places of the position that lies ``further`` positions on."""
    if not further:
        return places
    first = np.searchsorted(places.place, np.arange(2 * placement.count))
    counts = np.diff(first, append=places.place.size)
    side, position = np.divmod(np.repeat(np.arange(2 * placement.count), further + 1), placement.count)
    position += np.tile(np.arange(further + 1), 2 * placement.count)
    position = position % placement.count if placement.toothed is None else np.minimum(position, placement.count - 1)
    group = side * placement.count + position
    of, rows = counted_up(first[group], counts[group])
    here: IndexArray = first[of // (further + 1)]
    return replace(places.kept(rows), place=places.place[here], rigid=places.rigid[here], tilt=places.tilt[here])


@dataclass(frozen=True, eq=False)
class EstimatedBacklash:
    """The backlash that assemblies need, in its unit.

    ``shared`` (shape (N,)) is the mean backlash for each assembly's centre distance, temperature and wear.  All other
    deviations add to it with the standard deviation ``deviation``.
    """

    shared: Array
    deviation: float

    def jammed(self, given: float) -> float:
        """The share of assemblies that need more than is given."""
        from scipy.special import gammaincc

        left = given - self.shared
        if self.deviation < TINY * (1.0 + abs(given)):
            return float(np.mean(left < 0.0))
        return float(np.mean(gammaincc(SHAPE, np.maximum(SHAPE + sqrt(SHAPE) * left / self.deviation, 0.0))))


def needed(backlash: Array, shared: Array) -> EstimatedBacklash:
    """The needed backlash from drawn assemblies: the backlash of each, shape (N,), and the numbers of ``Plays.shared``.

    The backlash is linear in these numbers, by least squares.
    """
    from scipy.linalg import lstsq

    terms = np.vstack([np.ones(backlash.size), *(need / max(np.ptp(need), TINY) for need in shared)]).T
    found = terms @ lstsq(terms, backlash, lapack_driver="gelsy")[0]
    return EstimatedBacklash(found, float(np.std(backlash - found)))


def enough(of_pairs: Sequence[EstimatedBacklash], turning: float) -> float:
    """The least backlash with which the share ``turning`` of machines turns, with 95 % confidence.

    Pairs jam independently.  With n assemblies, the variance of the mean is 1/n of the assemblies' variance, and the
    variance of the standard deviation is 1/(2 n) of it.  A value K standard deviations above the mean has both errors.
    """
    from scipy.optimize import brentq

    def lacking(given: float) -> float:
        return turning - prod(1.0 - pair.jammed(given) for pair in of_pairs)

    if lacking(0.0) <= 0.0:
        return 0.0
    widest = max(pair.deviation for pair in of_pairs)
    most = max(0.0, *(float(pair.shared.max()) for pair in of_pairs)) + FARTHEST * widest
    found = float(brentq(lacking, 0.0, most, xtol=1e-3 * widest + TINY))
    spread = max(float(np.hypot(pair.shared.std(), pair.deviation)) for pair in of_pairs)
    above = max((found - float(pair.shared.mean())) / spread for pair in of_pairs) if spread else 0.0
    count = min(pair.shared.size for pair in of_pairs)
    return found + NORMAL_95 * spread * sqrt((1.0 + above**2 / 2.0) / count)
