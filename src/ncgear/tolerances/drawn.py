"""The deviations of assemblies, and their chances.

Each tolerance has a distribution, which is drawn by its percent point function from numbers between 0 and 1:

- centre distance, index errors, pitch and profile of each flank: normal, with the limit at three standard deviations
  and nothing beyond it;
- eccentricity and tilt of a bore: normal along both axes alike, so the size has a Rayleigh distribution; the limit is
  where 0.27 % would lie beyond, and nothing lies beyond it; all directions are equally likely;
- temperature: uniform between its two ends, the same for gears and housing;
- wear: uniform from none to the limit, at the same share of it on both gears.

All are independent of each other.  Each of two pairs in series has deviations of its own; only the temperature and the
share of the wear are the same for both.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log, pi, sqrt

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.tolerances.mesh import RIGID, Deviations, LinearMesh

SIGMAS = 3.0
"""Standard deviations in a limit."""

BEYOND = 0.0027
"""Share of a normal distribution beyond three standard deviations."""

MADE_C = 20.0
"""Temperature in degrees Celsius at which lengths are as the design says (ISO 1)."""


@dataclass(frozen=True, eq=False)
class DeviationLimits:
    """The limits of a pair's deviations; where both gears have a limit, the driving gear's comes first.

    ``pitch_mm`` and ``profile_mm`` (shape (flanks,), the driving gear's flanks first) are the tolerances of each flank:
    the single pitch deviation, between two neighbouring flanks, and the total profile deviation.  Expansions are shares
    per K, of the gears and the housing.  ``warmer_k`` is how much warmer gears run than their housing.
    """

    center_distance_mm: float
    eccentricity_mm: tuple[float, float]
    tilt_rad: tuple[float, float]
    index_rad: tuple[float, float]
    pitch_mm: Array
    profile_mm: Array
    temperature_c: tuple[float, float]
    warmer_k: float
    expansions: tuple[float, float, float]
    wear_mm: tuple[float, float]

    @property
    def flanks(self) -> int:
        """Number of flanks of both gears."""
        return self.pitch_mm.size

    @property
    def none(self) -> DeviationLimits:
        """The limits of the same pair without deviations."""
        none, pair = np.zeros(self.flanks), (0.0, 0.0)
        return DeviationLimits(0.0, pair, pair, pair, none, none, (MADE_C, MADE_C), 0.0, (0.0, 0.0, 0.0), pair)

    def displaced_mm(self, size_mm: float) -> float:
        """Estimate of the largest displacement of flanks against each other; ``size_mm`` is the centre distance."""
        driving, driven, housing = self.expansions
        warm = max(abs(temperature - MADE_C) for temperature in self.temperature_c)
        growth = size_mm * (max(driving, driven, housing) * warm + max(driving, driven) * self.warmer_k)
        tooth = sum(float(np.max(deviation, initial=0.0)) for deviation in (self.pitch_mm, self.profile_mm))
        return 2.0 * tooth + self.center_distance_mm + sum(self.eccentricity_mm) + growth

    @property
    def rigid(self) -> Array:
        """The largest sizes of RIGID, shape (11,)."""
        driving, driven, housing = self.expansions
        warm = max(abs(temperature - MADE_C) for temperature in self.temperature_c)
        gears = max(abs(temperature + self.warmer_k - MADE_C) for temperature in self.temperature_c)
        off = np.repeat(self.eccentricity_mm, 2)
        growth = driving * gears, driven * gears, housing * warm
        return np.concatenate([[self.center_distance_mm], off, growth, [self.index_rad[0]], self.wear_mm])


SOURCES = {
    "center_distance": 1,
    "eccentricity_driving": 2,
    "eccentricity_driven": 2,
    "tilt_driving": 2,
    "tilt_driven": 2,
    "index_driving": 1,
    "index_driven": 1,
    "temperature": 1,
    "wear": 1,
}
"""The sources of a whole pair in their order, and the count of numbers between 0 and 1 that each is drawn from."""

TOOTH_SOURCES = "pitch", "profile"
"""The sources of each flank, drawn from one number per flank."""

EVERY = (*SOURCES, *TOOTH_SOURCES)
COUNT = sum(SOURCES.values())
"""Count of the numbers that the whole pair is drawn from."""


@dataclass(frozen=True, eq=False)
class Chances:
    """Numbers from 0 to 1 that N assemblies are drawn from: ``pair`` (COUNT, N), ``teeth`` (2, flanks, N)."""

    pair: Array
    teeth: Array

    def with_source(self, source: str, other: Chances) -> Chances:
        """The same with the numbers of one source taken from others."""
        pair, teeth = self.pair.copy(), self.teeth
        if source in TOOTH_SOURCES:
            chosen = np.array([name == source for name in TOOTH_SOURCES])
            teeth = np.where(chosen[:, None, None], other.teeth, teeth)
        else:
            pair[rows_of(source)] = other.pair[rows_of(source)]
        return Chances(pair, teeth)


SHARED = "temperature", "wear"
"""The sources that the pairs of a machine share."""


@dataclass(frozen=True)
class DeviationSource:
    """A source of the pair ``stage`` of two pairs; the stage is None for a shared source and for a single pair."""

    name: str
    stage: int | None = None

    @property
    def key(self) -> str:
        """``stage_1_pitch``, or the plain name."""
        return self.name if self.stage is None else f"stage_{self.stage}_{self.name}"


def sources_of(pairs: Sequence[DeviationLimits]) -> tuple[DeviationSource, ...]:
    """The sources of deviations of a machine's pairs."""
    found = [
        DeviationSource(name, None if len(pairs) == 1 or name in SHARED else number)
        for number, limits in enumerate(pairs, start=1)
        for name in active(limits)
    ]
    return tuple(dict.fromkeys(found))


def chances_of(pairs: Array, teeth: Sequence[Array]) -> tuple[Chances, ...]:
    """The chances of s pairs, from numbers (s, COUNT, N) and of their teeth; SHARED come from the first pair."""
    pairs = pairs.copy()
    for name in SHARED:
        pairs[:, rows_of(name)] = pairs[0, rows_of(name)]
    return tuple(Chances(own, flanks) for own, flanks in zip(pairs, teeth, strict=True))


def with_source(pairs: Sequence[Chances], source: DeviationSource, others: Sequence[Chances]) -> tuple[Chances, ...]:
    """The same with the numbers of one source taken from others."""
    return tuple(
        own.with_source(source.name, other) if source.stage in (None, number) else own
        for number, (own, other) in enumerate(zip(pairs, others, strict=True), start=1)
    )


def rows_of(source: str) -> slice:
    """The rows of ``Chances.pair`` that a source is drawn from."""
    start = 0
    for name, count in SOURCES.items():
        if name == source:
            return slice(start, start + count)
        start += count
    raise KeyError(source)


def active(limits: DeviationLimits) -> tuple[str, ...]:
    """The sources with deviations."""
    low, high = limits.temperature_c
    sizes = {
        "center_distance": limits.center_distance_mm,
        "eccentricity_driving": limits.eccentricity_mm[0],
        "eccentricity_driven": limits.eccentricity_mm[1],
        "tilt_driving": limits.tilt_rad[0],
        "tilt_driven": limits.tilt_rad[1],
        "index_driving": limits.index_rad[0],
        "index_driven": limits.index_rad[1],
        "temperature": high - low,
        "wear": max(limits.wear_mm),
        "pitch": float(np.max(limits.pitch_mm, initial=0.0)),
        "profile": float(np.max(limits.profile_mm, initial=0.0)),
    }
    return tuple(name for name in EVERY if sizes[name] > 0.0)


def reachable(mesh: LinearMesh, limits: DeviationLimits) -> LinearMesh:
    """The mesh without places of contact that no deviations within limits can bring before the first place."""
    counts = np.diff(mesh.first, append=mesh.lead.size)
    leader = np.repeat(mesh.foremost.ravel(), counts)
    tooth = sum(
        share * size[flank]
        for share, size in (
            (mesh.pitch_share, limits.pitch_mm / sqrt(2.0)),
            (np.abs(mesh.profile_share), limits.profile_mm),
        )
        for share, flank in zip(share, mesh.flank, strict=True)
    )
    gained = (
        np.abs(mesh.rigid - mesh.rigid[leader]) @ limits.rigid
        + np.abs(mesh.tilt - mesh.tilt[leader]) @ np.repeat(limits.tilt_rad, 2)
        + tooth
        + tooth[leader]
    )
    return mesh.kept(mesh.lead + gained >= mesh.lead[leader])


def drawn(limits: DeviationLimits, chances: Chances) -> Deviations:
    """The deviations of assemblies."""
    return deviating(limits, chances.pair, _within_limit(chances.teeth))


def deviating(limits: DeviationLimits, pair: Array, teeth: Array) -> Deviations:
    """Deviations of assemblies from their pair's numbers (COUNT, N) and ``teeth`` (2, flanks, N) in limits."""

    def planar(source: str, limit: float) -> Array:
        size, direction = pair[rows_of(source)]
        length = limit * np.sqrt(np.log1p(-size * (1.0 - BEYOND)) / log(BEYOND))
        angle = 2.0 * pi * direction
        return np.stack([length * np.cos(angle), length * np.sin(angle)])

    def single(source: str) -> Array:
        return pair[rows_of(source)][0]

    low, high = limits.temperature_c
    housing = low + (high - low) * single("temperature") - MADE_C
    gears = housing + limits.warmer_k
    age = single("wear")
    first, second = limits.eccentricity_mm
    rigid = np.empty((len(RIGID), age.size))
    rigid[0] = limits.center_distance_mm * _within_limit(single("center_distance"))
    rigid[1:3], rigid[3:5] = planar("eccentricity_driving", first), planar("eccentricity_driven", second)
    driving, driven, about = limits.expansions
    rigid[5], rigid[6], rigid[7] = driving * gears, driven * gears, about * housing
    rigid[8] = limits.index_rad[0] * _within_limit(single("index_driving"))
    rigid[9], rigid[10] = (limit * age for limit in limits.wear_mm)
    tilts = zip(("tilt_driving", "tilt_driven"), limits.tilt_rad, strict=True)
    # Two neighbours that each deviate by f / sqrt(2) have a pitch between them that deviates by f.
    pitch, profile = (limits.pitch_mm / sqrt(2.0)).astype(teeth.dtype), limits.profile_mm.astype(teeth.dtype)
    return Deviations(
        rigid=rigid,
        tilt=np.concatenate([planar(source, limit) for source, limit in tilts]),
        pitch=pitch[:, None] * teeth[0],
        profile=profile[:, None] * teeth[1],
        output_rad=limits.index_rad[1] * _within_limit(single("index_driven")),
    )


def _within_limit(share: Array) -> Array:
    """Normal deviations that end at their limit, as shares of it, from numbers between 0 and 1."""
    from scipy.special import ndtr, ndtri

    low = float(ndtr(-SIGMAS))
    return np.asarray(ndtri(low + share * (1.0 - 2.0 * low)) / SIGMAS)


@dataclass(frozen=True, eq=False)
class DeviationSpread:
    """Independent causes of ``Deviations`` with their standard deviations; tilt, which has no slope at 0, is left out.

    ``rigid`` (shape (11, k)) is the change of RIGID by one standard deviation of each of k causes, and ``sources``
    names the source of each.  ``pitch_mm`` and ``profile_mm`` (shape (flanks,)) are the standard deviations of the
    flanks.
    """

    sources: tuple[str, ...]
    rigid: Array
    pitch_mm: Array
    profile_mm: Array


def spread(limits: DeviationLimits) -> DeviationSpread:
    """The standard deviations of the deviations that ``drawn`` gives, in closed form."""
    from scipy.stats import rayleigh, truncnorm

    normal = float(truncnorm.std(-SIGMAS, SIGMAS)) / SIGMAS
    # Each axis has half the mean square of a Rayleigh distribution that is cut off where BEYOND is left.
    axis = sqrt(1.0 + np.log(BEYOND) * BEYOND / (1.0 - BEYOND)) / float(rayleigh.ppf(1.0 - BEYOND))
    even = 1.0 / sqrt(12.0)
    low, high = limits.temperature_c
    causes = [
        ("center_distance", {0: limits.center_distance_mm * normal}),
        *(("eccentricity_driving", {row: limits.eccentricity_mm[0] * axis}) for row in (1, 2)),
        *(("eccentricity_driven", {row: limits.eccentricity_mm[1] * axis}) for row in (3, 4)),
        ("temperature", {5 + row: (high - low) * even * expansion for row, expansion in enumerate(limits.expansions)}),
        ("index_driving", {8: limits.index_rad[0] * normal}),
        ("wear", {9 + row: even * wear for row, wear in enumerate(limits.wear_mm)}),
    ]
    rigid = np.zeros((len(RIGID), len(causes)))
    for column, (_, moved) in enumerate(causes):
        for row, size in moved.items():
            rigid[row, column] = size
    sources = tuple(source for source, _ in causes)
    return DeviationSpread(sources, rigid, limits.pitch_mm / sqrt(2.0) * normal, limits.profile_mm * normal)
