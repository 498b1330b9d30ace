"""The drive of a design: from its file, a text, or a mapping of its keys, whose law may be a Python function.

Under the law ``ratio_expression`` a function of phi1 in rad stands for its formula: it is traced, and the law is proven
to follow that formula to 1e-12, like the law of a written formula (``numerics.proven``).  Under ``table`` it is called
at even driving angles of a cycle, twice as many until the law is as near as ``NEAR``.

Nothing can be proven about a function that is known only by its values.  Under ``table`` two things are measured
instead, both at angles that the law is not made from.  The first is the error of the law, at eight angles between every
two points and at all angles of the second.  The second is whether these eight angles miss anything: the cycle is cut
into pieces, halved until the Chebyshev series through 17 values of each dies away and agrees with the function at other
angles of the piece (L. N. Trefethen, "Approximation Theory and Approximation Practice", SIAM 2013, chapters 7 and 8).
If the function is analytic and bounded in an ellipse about each piece, of the size that the fall of the coefficients
gives, the series is off by no more than its tail.  Sampling cannot prove this; it is an assumption.  Where pieces
shrink to a corner, a jump or a narrow peak, that is told, with the greatest width of a peak that lies between all
angles.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi, sin
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import SIZES
from ncgear.design.reading.design_file import LoadedDesign, parsed, parsed_mapping, plain
from ncgear.design.reading.design_file import load as load_design
from ncgear.design.reading.places import with_value
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.bounds import shown_above
from ncgear.numerics.chebyshev import on_panels, panel_coefficients
from ncgear.numerics.formula import NotTraced, formula_of
from ncgear.project.drive import Drive
from ncgear.project.law import lobes_of
from ncgear.project.tooth_form import reach_in_pitches

Function = Callable[[Any], Any]

KEYS = {"ratio_expression": ("ratio", "driven_angle"), "table": ("ratio", "displacement_mm", "displacement_deg")}
"""The keys of each law that can be a function."""

FEWEST, MOST = 64, 1024
"""Least and greatest number of points that are tried."""

NEAR = 1e-9
"""Share of the greatest value by which the law may miss a function between the points."""

FARTHEST = 0.01
"""Share of the greatest value by which a law may miss a function with a corner.  Where it misses by more, the function
jumps, differs between start and end of the cycle, has a pole, or a peak between the points."""

BETWEEN = 8
"""Number of angles between two points at which the law is compared with the function."""

PIECES, HALVINGS = 256, 6
"""Number of pieces of a cycle at first, and how often they are halved: the last pieces are 0.02 deg."""

DEGREE = 16

WIDEST = sin(pi / (DEGREE + 1)) / (2.0 * PIECES)
"""Greatest distance of two neighbouring angles of the first pieces, as a share of a cycle: a narrower feature may lie
between them."""

DIED = 1e-10
"""Share of the greatest value under which a series has died away: a tenth of ``NEAR``."""

ASIDE = (-0.3819660112501051, 0.2360679774997898)
"""Places of a piece from -1 to 1 where its series is compared with the function, by the golden ratio: no nodes of the
piece or of its halves."""


@dataclass(frozen=True)
class FollowedFunction:
    """How a law follows a function: by its ``formula``, exactly; or through ``points``, up to ``error``.

    The error is the greatest that was measured at some ``angles``, as a share of the function's greatest value.
    ``tail`` is the greatest remainder of the function's series on ``pieces`` of the cycle, or their greatest difference
    from the function at other angles, as a share of the same value.  ``rough_rad`` has driving angles where the series
    do not die away.  Neighbouring angles are no further apart than ``step_rad``.
    """

    key: str
    formula: str = ""
    points: int = 0
    error: float = 0.0
    angles: int = 0
    step_rad: float = 0.0
    pieces: int = 0
    tail: float = 0.0
    rough_rad: tuple[float, ...] = ()

    def __repr__(self) -> str:
        if self.formula:
            return f"{self.key}: the function is the formula {self.formula}"
        return (
            f"{self.key}: {self.points} points of the function; between them the law is off by {self.error:.2g} of its "
            f"greatest value at most, measured at {self.angles} angles; {self._smoothness}"
        )

    @property
    def _smoothness(self) -> str:
        if self.rough_rad:
            more = " and elsewhere" if len(self.rough_rad) > 1 else ""
            return (
                f"near phi1 = {self.rough_rad[0]:.4g} rad{more} the function has a corner, a jump or a narrow peak, "
                "and the law may be off by more"
            )
        return (
            f"its series on {self.pieces} pieces die away to {self.tail:.2g}, and nothing wider than "
            f"{shown_above(self.step_rad, 2)} rad lies between the angles that they were made from"
        )


def drive_of(given: Mapping[str, Any]) -> Drive:
    """The drive of a mapping; raises WrongInput with the key of a fault, NoSuchMechanism as a law of points does."""
    data = plain(given)
    motion = data.get("motion")
    law = motion.get("law") if isinstance(motion, dict) else None
    functions = (
        {name: function for name, function in motion.items() if callable(function)} if isinstance(motion, dict) else {}
    )
    allowed = KEYS.get(law, ()) if isinstance(law, str) else ()
    for name, function in functions.items():
        if name not in allowed:
            raise WrongInput(
                "a function given; ratio or driven_angle of the law ratio_expression can be one of phi1 in rad, and "
                "ratio or a displacement of the law table",
                key=f"motion.{name}",
            )
        made = _formula if law == "ratio_expression" else _points
        return made(data, f"motion.{name}", function)
    return _drive(data)


def _drive(data: Mapping[str, Any], followed: FollowedFunction | None = None) -> Drive:
    loaded = parsed_mapping(data)
    return Drive(loaded.design, loaded=loaded, followed=followed)


def _formula(data: dict[str, Any], key: str, function: Function) -> Drive:
    try:
        formula = formula_of(function, "phi")
    except NotTraced as fault:
        raise WrongInput(
            f"the function has no formula: {fault}; arithmetic and functions of numpy have one, and the law table "
            "takes any function",
            key=key,
        ) from fault
    return _drive(with_value(data, key, formula), FollowedFunction(key, formula))


def _points(data: dict[str, Any], key: str, function: Function) -> Drive:
    lobes = data.get("gears", {}).get("lobes", {}) if isinstance(data.get("gears"), dict) else {}
    driving = lobes.get("driving", 1) if isinstance(lobes, dict) else 1
    cycle = 2.0 * pi / driving if isinstance(driving, int) and driving > 0 else 2.0 * pi
    seen: list[tuple[Array, Array]] = []

    def noted(angles: Array) -> Array:
        values = _called(function, angles, key)
        seen.append((angles, values))
        return values

    decay = _decay(noted, cycle)
    angles, wanted = (np.concatenate(parts) for parts in zip(*seen, strict=True))
    count = FEWEST
    while True:
        phi1 = np.arange(count) * cycle / count
        if not key.endswith("ratio"):
            phi1 = _with_top(phi1, _called(function, phi1, key), function, key)
        values = {"phi1_rad": phi1.tolist(), key.removeprefix("motion."): _called(function, phi1, key).tolist()}
        drive = _drive({**data, "motion": {**data["motion"], **values}})
        width = np.diff(np.append(phi1, cycle))
        between = (phi1[:, None] + width[:, None] * (np.arange(BETWEEN) + 0.5) / BETWEEN).ravel()
        at = np.concatenate([between, angles])
        off = _off(drive, at, np.concatenate([_called(function, between, key), wanted]), data["motion"], key)
        error, at_rad = float(np.max(off)), float(at[np.argmax(off)])
        if error <= NEAR or 2 * count > MOST:
            if not error <= FARTHEST:
                raise WrongInput(
                    f"through {phi1.size} points of the function the law is off by {error:.2g} of its greatest value "
                    f"near phi1 = {at_rad:.4g} rad: there it jumps, has a pole or a narrow peak, or does not come back "
                    f"at the end of the cycle; a function that the law follows to {FARTHEST:g} is right",
                    key=key,
                )
            followed = FollowedFunction(key, "", phi1.size, error, at.size, WIDEST * cycle, *decay)
            return Drive(drive.design, loaded=drive.loaded, followed=followed)
        count *= 2


def _decay(function: Callable[[Array], Array], cycle: float) -> tuple[int, float, tuple[float, ...]]:
    """Number of pieces on which a function's series die away, their greatest remainder, and the places of the others.

    The places are the middles of the narrowest pieces; neighbours count as one piece.  No piece ends at the end of the
    cycle, or at an even part of it, where corners would lie between pieces.
    """
    edges = (np.arange(PIECES + 1) + ASIDE[1]) * cycle / PIECES
    left, right, done, tail, greatest = edges[:-1], edges[1:], 0, 0.0, 0.0
    for halving in range(HALVINGS + 1):
        series = panel_coefficients(lambda at: function(at % cycle), left, right, DEGREE)
        local, each = np.repeat(ASIDE, left.size), np.tile(np.arange(left.size), len(ASIDE))
        at = (left[each] * (1.0 - local) + right[each] * (1.0 + local)) / 2.0
        wanted = function(at % cycle)
        greatest = max(greatest, float(np.max(np.abs(wanted))), float(np.max(np.abs(series[0]))))
        missed = np.abs(on_panels(series, each, local) - wanted).reshape(len(ASIDE), -1).max(axis=0)
        share = np.maximum(np.abs(series[-3:]).max(axis=0), missed) / (greatest or 1.0)
        rough = share > DIED
        done, tail = done + int(np.count_nonzero(~rough)), max(tail, float(np.max(share[~rough], initial=0.0)))
        left, right = left[rough], right[rough]
        middle = (left + right) / 2.0
        if not left.size or halving == HALVINGS:
            break
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
    places = np.sort(middle)
    apart = np.diff(places, prepend=-np.inf) > 2.0 * cycle / (PIECES * 2**HALVINGS)
    return done, tail, tuple((places[apart] % cycle).tolist())


def _called(function: Function, phi1: Array, key: str) -> Array:
    """The values of the function at all angles, called with the array, or angle by angle if it takes no arrays."""
    with np.errstate(all="ignore"):
        try:
            values = _real(function(phi1), phi1.shape)
        except (TypeError, ValueError):
            try:
                values = _real([function(angle) for angle in phi1.tolist()], phi1.shape)
            except (TypeError, ValueError) as error:
                raise WrongInput(
                    f"a function that gives a real number for phi1 in rad is right ({error})", key=key
                ) from error
    if not np.all(np.isfinite(values)):
        at = float(phi1[int(np.argmin(np.isfinite(values)))])
        raise WrongInput(f"the function has no finite value at phi1 = {at:.6g} rad", key=key)
    return values


def _real(given: Any, shape: tuple[int, ...]) -> Array:
    """Values as numbers; raises TypeError or ValueError where they are complex, texts, or another number of them."""
    found = np.asarray(given)
    if found.shape != shape or found.dtype.kind not in "fiubO":
        raise TypeError(f"it gives {type(given[0] if isinstance(given, list) else given).__name__}")
    return found.astype(float)


def _with_top(phi1: Array, values: Array, function: Function, key: str) -> Array:
    """The angles and the angle of the extended end, where the function is greatest: tables of displacements need it."""
    step, top = phi1[1] - phi1[0], float(phi1[int(np.argmax(values))])
    nodes = top + step * chebyshev.chebpts1(17)
    series = chebyshev.Chebyshev.fit(nodes, _called(function, nodes, key), 16, [nodes[0], nodes[-1]])
    roots = series.deriv().roots()
    real = roots[np.abs(roots.imag) < 1e-9 * step].real
    end = float(real[np.argmin(np.abs(real - top))]) if real.size else top
    return np.sort(np.append(phi1[np.abs(phi1 - end) > step / 4.0], end))


def _off(drive: Drive, at: Array, wanted: Array, motion: Mapping[str, Any], key: str) -> Array:
    """The differences of law and function at angles, as shares of the function's greatest value."""
    if key.endswith("ratio"):
        found = 1.0 / drive.transmission.driven_angle(at, 1).derivative(1)
        # A scale that closes the cycle belongs to the law
        found *= np.median(wanted / found) if motion.get("scale_to_close") else 1.0
    else:
        found = drive.linkage.OUTPUT.place.factor * drive.machine.displacement(at, 0).value
    return np.abs(found - wanted) / np.max(np.abs(wanted))


def load(given: str | Path | Mapping[str, Any]) -> Drive:
    """The drive of a design file, or of a mapping with its keys; its law, motion, teeth and more are attributes.

    A mapping may hold arrays for lists, and a function of phi1 in rad as ``ratio``, ``driven_angle`` or displacement of
    its ``motion``; ``drive.followed`` tells how the law follows it.

    Raises WrongInput, with ``FILE:LINE:COLUMN`` or the key, for each fault.  The attributes of the drive raise
    WrongInput or NoSuchMechanism, with places of the same kind, when they are first used.

    >>> drive = load("designs/baler.yaml")
    >>> drive
    Drive('baler', law three_segment_stroke, 20 r/min)
    >>> f"{drive.check.peak_power_w.value:.0f} W"
    '6315 W'
    >>> f"{drive.pitch.center_distance_mm:.3f} mm"
    '74.885 mm'
    """
    if isinstance(given, Mapping):
        return drive_of(given)
    if not isinstance(given, str | PathLike):
        raise WrongInput(
            f"{type(given).__name__} given; the path of a design file, or a mapping with its keys, is right"
        )
    loaded = load_design(Path(given))
    return Drive(loaded.design, loaded=loaded)


def loads(text: str, name: str = "text") -> Drive:
    """The drive of a design file's text; messages call it ``name``.  Otherwise the same as ``load``.

    >>> machine = "linkage: {crank_mm: 40, rod_mm: 90}, operation: {speed_rpm: 30}"
    >>> drive = loads(f"{{name: even, {machine}, motion: {{law: uniform_crank}}}}")
    >>> f"{drive.linkage.stroke_mm:g} mm"
    '80 mm'
    """
    loaded = parsed(text, Path(name))
    return Drive(loaded.design, loaded=loaded)


ALONG = ("face_width_mm", "material", "lead")
"""Keys that change nothing of straight teeth and of bodies in the plane across the axes."""

BODY = (*ALONG, "driving", "driven")
"""Keys that change nothing of straight teeth there."""

SAME_TEETH = ("pitch", "rack", "play", "tooth_form", "teeth", "free_contact")
"""Attributes of a drive that do not change with these keys, nor with lengths of the mechanism that the law does not
use."""


def drive_like(drive: Drive, design: Design, loaded: LoadedDesign | None = None) -> Drive:
    """The drive of another design; it takes law, pitch curves and teeth from ``drive`` where they are the same."""
    kept = _in_common(drive.design, design)

    def like(pair: Drive, whole: Drive | None = None) -> Drive:
        other = Drive(design, pair.stage, loaded, whole)
        vars(other).update({name: value for name, value in vars(pair).items() if name in kept})
        return other

    whole = like(drive)
    if kept and design.stages > 1 and drive.stage is None:
        vars(whole)["by_stage"] = tuple(like(pair, whole) for pair in drive.by_stage)
    return whole


def _in_common(given: Design, other: Design) -> tuple[str, ...]:
    """The attributes that drives of two designs have in common."""
    same_linkage = given.linkage == other.linkage
    laws = [(design.motion, lobes_of(design), *_series(design)) for design in (given, other)]
    if laws[0] != laws[1] or (not same_linkage and given.motion.gives_slider) or "safety" in laws[0]:
        return ()
    law = ("law",) if same_linkage else ()
    before, after = given.gears, other.gears
    if before is None or after is None:
        return law
    teeth, bodies = ({name: getattr(before, name) for name in names} for names in (BODY, ALONG))
    if before.helix is None and given.output == other.output and after.model_copy(update=teeth) == before:
        extremes = ("_free_extremes",) if given.operation == other.operation else ()
        rims = ("rims",) if same_linkage and after.model_copy(update=bodies) == before else ()
        # The gears' inertia counts among masses.
        same_load = given.masses is None and other.model_copy(update={"gears": before}) == given
        return *law, *SAME_TEETH, *extremes, *rims, *(("machine", "tooth_load") if same_load else ())
    sizes = [[getattr(gears, name) for name in (*SIZES, "mesh")] for gears in (before, after)]
    if sizes[0] == sizes[1] and reach_in_pitches(before) == reach_in_pitches(after):
        return *law, "pitch"
    return law


def _series(design: Design) -> tuple[object, ...]:
    """The keys that make pairs in series of a law."""
    gears = design.gears
    return (gears.pairs, gears.sharing, gears.parts, gears.idlers) if gears else (1, "even", None, None)
