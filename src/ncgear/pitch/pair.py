"""Both pitch curves of a pair at their real size, and figures to judge them.

Teeth must fill closed pitch curves, so any two of centre distance, module and number of teeth give the third.  The
curves of gears that turn less than once need not be filled: any module suits any centre distance.
"""

from __future__ import annotations

from functools import cached_property, partial
from math import atan, degrees, floor, isclose, pi

import numpy as np

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, distinct
from ncgear.numerics.extrema import Extremum, stationary_points
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import in_words
from ncgear.numerics.zeros import zeros_between
from ncgear.pitch import shape
from ncgear.pitch.arc_length import ArcLength, arc_length, period_length
from ncgear.pitch.continued import continued
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.internal import require_ring, require_room
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.transmission import Lobes, OpenRange, Piece, Transmission
from ncgear.shown import Shown

STRAIGHT = 1e-9
"""Curvature times centre distance below which a curve counts as straight: a radius of 1e9 centre distances."""


@dataclass(frozen=True)
class CurvatureJump:
    """A joint of the law: curvatures in 1/mm just before and after it, of both gears."""

    phi1_rad: float
    driving_before: float
    driving_after: float
    driven_before: float
    driven_after: float


BESIDE_IN_PITCHES = 0.25
"""Distance of a tooth's flank from its middle, in pitches: half its thickness."""

RACK_REACH_IN_PITCHES = 1.0
"""Rolled length in pitches, to each side of the pitch point, over which teeth as high as the module touch at 20 deg."""


@dataclass(frozen=True)
class ToothedArc:
    """The teeth that are made on both curves of an open law; ``around`` teeth would stand on the continued curves.

    These are all teeth whose flanks can touch while the pitch point is in the range, which is ``covered_mm`` long and
    takes ``covered_rad`` of the driving angle.  ``before`` teeth of each gear come before the range: the middle of
    driving tooth n, from 1, crosses the pitch point n - 1 - before pitches after the range's beginning, the middle of
    driven tooth n half a pitch later.
    """

    before: int
    driving_teeth: int
    driven_teeth: int
    around: int
    covered_mm: float
    covered_rad: float

    def teeth(self, gear: Gear) -> int:
        """The number of teeth of a gear."""
        return self.driving_teeth if gear is Gear.DRIVING else self.driven_teeth


@dataclass(frozen=True, eq=False)
class PitchPair(Shown):
    """Two curves that roll on each other; if gears turn less than once, continued curves with teeth on ``toothed``."""

    transmission: Transmission
    arc: ArcLength
    size: Size
    mesh: Mesh
    toothed: ToothedArc | None = None

    def __repr__(self) -> str:
        size = self.size
        teeth = f"{size.driving_teeth}:{size.driven_teeth} teeth of module {size.module_mm:.4g} mm"
        return f"PitchPair({self.mesh.value}, a = {size.center_distance_mm:.3f} mm, {teeth})"

    @property
    def center_distance_mm(self) -> float:
        """Distance between the gears' axes."""
        return self.size.center_distance_mm

    @cached_property
    def driving(self) -> PitchCurve:
        """The driving gear's pitch curve."""
        return PitchCurve(Gear.DRIVING, self.transmission, self.arc, self.center_distance_mm, self.mesh)

    @cached_property
    def driven(self) -> PitchCurve:
        """The driven gear's pitch curve."""
        return PitchCurve(Gear.DRIVEN, self.transmission, self.arc, self.center_distance_mm, self.mesh)

    def of(self, gear: Gear) -> PitchCurve:
        """The driving or the driven gear's curve."""
        return self.driving if gear is Gear.DRIVING else self.driven

    def pitch_point_mm(self, phi1: Array) -> Array:
        """Place where the curves touch on the line of centres, from the driving axis, at driving angles in rad,
        (n,)."""
        return -self.mesh.sense * np.linalg.norm(self.driving.at_angle(phi1).position, axis=-1)

    def length_mm(self, gear: Gear) -> float:
        """Length of a gear's curve, integrated on that gear's own curve; of an open law, over its range."""
        return self._lengths_mm[gear]

    @cached_property
    def _lengths_mm(self) -> dict[Gear, float]:
        made, size = self.transmission.made, self.center_distance_mm
        return {gear: self.of(gear).periods * period_length(made, gear, self.mesh) * size for gear in Gear}

    def radius_range_mm(self, gear: Gear) -> tuple[float, float]:
        """Least and greatest pitch radius, r1 = a / (i - s) and r2 = a i / (i - s), monotonic in the ratio."""
        a, sense = self.center_distance_mm, self.mesh.sense
        ratios = [end.value for end in self.transmission.ratio_range]
        low, high = sorted((a if gear is Gear.DRIVING else a * i) / (i - sense) for i in ratios)
        return low, high

    @cached_property
    def curvature_range(self) -> dict[Gear, tuple[Extremum, Extremum]]:
        """Smallest and largest curvature of each curve's material in 1/mm, with driving angles; a ring's is hollow."""
        size = self.center_distance_mm
        found = self.transmission.extremes_of_each(
            [partial(shape.curvature, gear=gear, mesh=self.mesh) for gear in Gear], 2
        )
        return {
            gear: (Extremum(low.value / size, low.at), Extremum(high.value / size, high.at))
            for gear, (low, high) in zip(Gear, found, strict=True)
        }

    def _bend_range(self, gear: Gear) -> tuple[float, float]:
        """Smallest and largest curvature of the closed curve, positive where it bulges outwards, also on a ring."""
        low, high = (extremum.value for extremum in self.curvature_range[gear])
        return (-high, -low) if shape.is_ring(gear, self.mesh) else (low, high)

    def convex(self, gear: Gear) -> bool:
        """Whether the closed curve is nowhere dented.  A ring's may be convex too, though its material is concave."""
        return self._bend_range(gear)[0] * self.center_distance_mm >= -STRAIGHT

    def least_radius_mm(self, gear: Gear) -> float:
        """Smallest radius of curvature where the closed curve bulges."""
        return 1.0 / self._bend_range(gear)[1]

    def least_concave_radius_mm(self, gear: Gear) -> float | None:
        """Smallest radius of curvature where the closed curve is dented, None on a convex curve."""
        return None if self.convex(gear) else -1.0 / self._bend_range(gear)[0]

    def concave_ranges(self, gear: Gear) -> list[tuple[float, float]]:
        """Stretches of the driving angle within one period on which the closed curve is dented, with exact ends."""
        return list(self._concave[gear])

    @cached_property
    def _concave(self) -> dict[Gear, list[tuple[float, float]]]:
        found: dict[Gear, list[tuple[float, float]]] = {gear: [] for gear in Gear}
        for gear, own in found.items():
            for piece in self.transmission.made_pieces:
                for start, end in self._concave_on(piece, gear):
                    first = own.pop()[0] if own and start == own[-1][1] else start
                    own.append((first, end))
        return found

    def _concave_on(self, piece: Piece, gear: Gear) -> list[tuple[float, float]]:
        """The dented stretches of a piece: between two stationary points the curvature passes a value once at most."""
        outwards = -1.0 if shape.is_ring(gear, self.mesh) else 1.0

        def bulge(phi1: Array) -> Jet:
            return shape.curvature(piece.slope(phi1, 3), gear, self.mesh) * outwards + STRAIGHT

        points = stationary_points(bulge, piece.start_rad, piece.end_rad, np.array(piece.knots_rad))
        sign = np.sign(bulge(points).value)
        change = np.nonzero(sign[:-1] * sign[1:] < 0.0)[0]
        edges = points[[0, -1]]
        if change.size:
            zeros = zeros_between(lambda phi1: bulge(phi1).value, points[change], points[change + 1])
            edges = distinct(np.concatenate([edges, zeros]))
        dented = bulge((edges[:-1] + edges[1:]) / 2.0).value < 0.0
        return [(low, high) for low, high in np.column_stack([edges[:-1], edges[1:]])[dented].tolist()]

    @cached_property
    def leanings(self) -> list[Extremum]:
        """Where the curves lean most against the normal to the centre line, as ``leanings``."""
        return leanings(self.transmission, self.mesh)

    @property
    def largest_tangent_angle_rad(self) -> Extremum:
        """Largest angle between the curves' tangent and the normal to the centre line."""
        return _largest_angle(self.leanings)

    def largest_pressure_angle_deg(self, rack_angle_rad: float) -> float:
        """Largest angle between the force on a flank and the driven pitch point's velocity, on the worse flank."""
        return degrees(self.largest_tangent_angle_rad.value + rack_angle_rad)

    def curvature_jumps(self) -> list[CurvatureJump]:
        """Every joint of the law, the seam at phi1 = 0 first, with the curvatures on both sides."""
        found = []
        for before, after in self.transmission.meeting_pieces:
            slopes = before.slope(np.array([before.end_rad]), 2), after.slope(np.array([after.start_rad]), 2)
            bends = [shape.curvature(slope, gear, self.mesh).value[0] for gear in Gear for slope in slopes]
            found.append(CurvatureJump(after.start_rad, *(float(bend) / self.center_distance_mm for bend in bends)))
        return found


def largest_tangent_angle_rad(transmission: Transmission, mesh: Mesh = Mesh.EXTERNAL) -> Extremum:
    """Largest angle between the pitch curves' tangent and the normal to the centre line, whatever their size."""
    return _largest_angle(leanings(transmission, mesh))


def leanings(transmission: Transmission, mesh: Mesh) -> list[Extremum]:
    """Least and largest slope of both curves' tangent against the normal to the centre line, piece by piece."""
    slopes = [lambda slope: shape.tangent_slope(slope, mesh)]
    return [extremum for piece in transmission.made_pieces for extremum in piece.extremes(slopes, 1)[0]]


def _largest_angle(found: list[Extremum]) -> Extremum:
    worst = max(abs(extremum.value) for extremum in found)
    first = min(extremum.at for extremum in found if abs(extremum.value) >= worst * (1.0 - AS_STEEP))
    return Extremum(atan(worst), first)


AS_STEEP = 1e-10
"""Relative difference of slopes that are equal but for rounding; the first of these places is named."""


CORNER_RAD = 1e-4
"""Corner of a pitch curve that no tooth notices: it moves a tip 10 mm off the curve by a micrometre."""


def refuse_corners(transmission: Transmission, mesh: Mesh = Mesh.EXTERNAL) -> None:
    """Refuse corners of pitch curves, where the ratio's slope jumps; raises NoSuchMechanism with the angle."""
    for before, after in transmission.meeting_pieces:
        slopes = before.slope(np.array([before.end_rad]), 2), after.slope(np.array([after.start_rad]), 2)
        left, right = (atan(float(shape.tangent_slope(slope, mesh).value[0])) for slope in slopes)
        if abs(left - right) <= CORNER_RAD:
            continue
        was, becomes = (float((1.0 / slope).derivative(1)[0]) for slope in slopes)
        where = ", where the cycle begins again," if after is transmission.pieces[0] else ""
        raise NoSuchMechanism(
            f"the pitch curves have a corner of {degrees(abs(left - right)):.4g} deg at phi1 = "
            f"{in_words(after.start_rad)}{where} since the slope of the ratio jumps there from {was:.4g} to "
            f"{becomes:.4g} per rad; no teeth roll over a corner, a ratio with a continuous slope is needed",
            key="motion",
        )


MOST_TEETH = 10_000
"""Most teeth of the driving gear, as the key for their number allows; with more a computer is busy for minutes before
it says that no tooth can be seen."""


def refuse_many_teeth(pitches: float) -> None:
    """Refuse a driving gear of over MOST_TEETH teeth; raises WrongInput."""
    if pitches > MOST_TEETH:
        raise WrongInput(
            f"the driving gear has {pitches:.6g} tooth pitches of that size; {MOST_TEETH} at most are right: a larger "
            "module, or a smaller centre distance",
            key="gears.module_mm",
        )


def sized_pair(
    transmission: Transmission,
    teeth: int | None,
    module_mm: float | None,
    center_distance_mm: float | None,
    mesh: Mesh = Mesh.EXTERNAL,
    reach_in_pitches: float = RACK_REACH_IN_PITCHES,
    *,
    by_law: bool = False,
) -> PitchPair:
    """The pitch curves of a law at the size that any two of teeth, module and centre distance give.

    The law may give the centre distance (``by_law``); messages then advise no other.  For an open law ``teeth`` counts
    the pitches in its range; ``reach_in_pitches`` is the rolled length over which flanks touch to each side of the
    pitch point, and decides which teeth are made.  Raises WrongInput as ``solved_size`` does, for over MOST_TEETH
    teeth, and for a ring that turns less than once; NoSuchMechanism for curves too sharp to be computed, for a law that
    cannot drive a ring, and for a driving curve that does not fit into its ring.
    """
    if mesh is Mesh.INTERNAL:
        require_ring(transmission)
    refuse_corners(transmission, mesh)
    covered = transmission.lobes.range
    if covered is not None:
        if mesh is Mesh.INTERNAL:
            raise WrongInput(
                "internal, but gears that turn less than once are made as external pairs only", key="gears.mesh"
            )
        return _open_pair(transmission, covered, (teeth, module_mm, center_distance_mm), reach_in_pitches)
    arc = arc_length(transmission, mesh)
    size = solved_size(
        transmission.lobes.driving * arc.period, transmission.lobes, teeth, module_mm, center_distance_mm, by_law=by_law
    )
    refuse_many_teeth(size.driving_teeth)
    pair = PitchPair(transmission, arc, size, mesh)
    if mesh is Mesh.INTERNAL:
        require_room(pair.driving, pair.driven)
    return pair


def _open_pair(
    transmission: Transmission, covered: OpenRange, given: tuple[int | None, float | None, float | None], reach: float
) -> PitchPair:
    """The pitch curves of an open law, continued to whole turns."""
    length = arc_length(transmission, Mesh.EXTERNAL).period
    teeth, module_mm, distance_mm = given
    _require_two(*given)
    if module_mm is None:
        assert teeth is not None
        assert distance_mm is not None
        module_mm = length * distance_mm / (teeth * pi)
    elif distance_mm is None:
        assert teeth is not None
        distance_mm = teeth * pi * module_mm / length
    elif teeth is not None:
        _refuse_disagreement(length, teeth, module_mm, distance_mm, 1, by_law=False)
    refuse_many_teeth(length * distance_mm / (pi * module_mm))
    whole = continued(transmission, covered, pi * module_mm / distance_mm)
    arc = arc_length(whole, Mesh.EXTERNAL)
    share = distance_mm / (pi * module_mm)
    beside, pitches, around = reach + BESIDE_IN_PITCHES, length * share, round(arc.period * share)
    before = floor(beside + 0.5)
    driving, driven = (before + 1 + floor(pitches + beside - middle) for middle in (0.0, 0.5))
    toothed = ToothedArc(before, driving, driven, around, length * distance_mm, covered.driving_rad)
    if max(driving, driven) + 1 >= around:
        raise NoSuchMechanism(
            f"{around} tooth pitches on the continued curves are too few for the {max(driving, driven)} teeth that are "
            "made; a smaller module is right",
            key="gears.module_mm",
        )
    return PitchPair(whole, arc, Size(driving, driven, module_mm, distance_mm), Mesh.EXTERNAL, toothed)


CONSISTENT = 1e-6
"""Relative disagreement of three given values that counts as rounding in the design file: seven digits."""


@dataclass(frozen=True)
class Size:
    """A consistent set: teeth of both gears, module and centre distance."""

    driving_teeth: int
    driven_teeth: int
    module_mm: float
    center_distance_mm: float


def solved_size(
    driving_length: float,
    lobes: Lobes,
    teeth: int | None,
    module_mm: float | None,
    center_distance_mm: float | None,
    *,
    by_law: bool = False,
) -> Size:
    """The size from any two of teeth, module and centre distance.

    ``driving_length`` is the driving pitch curve's length at unit centre distance; times the centre distance it is
    teeth x pi x module.  Raises WrongInput when fewer than two are given, when three disagree, or when a number of
    teeth is not whole.  Messages advise consistent values, and no centre distance where it follows from the law.
    """
    _require_two(teeth, module_mm, center_distance_mm)
    each = lobes.teeth_step
    if teeth is None:
        assert module_mm is not None
        assert center_distance_mm is not None
        teeth = _whole_teeth(driving_length, module_mm, center_distance_mm, each, by_law=by_law)
    if module_mm is None:
        assert center_distance_mm is not None
        module_mm = driving_length * center_distance_mm / (teeth * pi)
    elif center_distance_mm is not None:
        _refuse_disagreement(driving_length, teeth, module_mm, center_distance_mm, each, by_law=by_law)
    fitting = teeth * pi * module_mm / driving_length
    return Size(teeth, _driven_teeth(teeth, lobes), module_mm, fitting)


def _require_two(*given: float | None) -> None:
    if sum(value is None for value in given) > 1:
        raise WrongInput("two of teeth, module_mm and center_distance_mm are needed; the third follows", key="gears")


def _whole_teeth(driving_length: float, module_mm: float, distance_mm: float, each: int, *, by_law: bool) -> int:
    """The number of teeth, a multiple of ``each``, for a module and a centre distance."""
    exact = driving_length * distance_mm / (pi * module_mm)
    whole = _nearest_teeth(exact, each)
    if not isclose(exact, whole, rel_tol=CONSISTENT):
        module = f"module_mm: {driving_length * distance_mm / (pi * whole):.9g}"
        distance = f"center_distance_mm: {whole * pi * module_mm / driving_length:.9g}"
        multiple = "" if each == 1 else f" and a multiple of {each}"
        raise WrongInput(
            f"module {module_mm:g} mm and centre distance {distance_mm:g} mm make {exact:.6g} teeth, not a whole number"
            f"{multiple}; with {whole} teeth {module if by_law else f'either {module} or {distance}'} is right",
            key="gears.module_mm" if by_law else "gears.center_distance_mm",
        )
    return whole


def _nearest_teeth(exact: float, each: int) -> int:
    return max(round(exact / each), 1) * each


def _driven_teeth(teeth: int, lobes: Lobes) -> int:
    if teeth * lobes.driven % lobes.driving:
        each = lobes.teeth_step
        raise WrongInput(
            f"{teeth} teeth on the driving gear make {teeth * lobes.driven / lobes.driving:.4g} on the driven gear at "
            f"{lobes.driving}:{lobes.driven} lobes; a multiple of {each} is needed, as {_nearest_teeth(teeth, each)}",
            key="gears.teeth",
        )
    return teeth * lobes.driven // lobes.driving


def _refuse_disagreement(
    driving_length: float, teeth: int, module_mm: float, distance_mm: float, each: int, *, by_law: bool
) -> None:
    fitting = teeth * pi * module_mm / driving_length
    if isclose(fitting, distance_mm, rel_tol=CONSISTENT):
        return
    circle = driving_length * distance_mm / pi
    exact = circle / module_mm
    whole = _nearest_teeth(exact, each)
    other = "" if isclose(exact, whole, rel_tol=CONSISTENT) else f" with module_mm: {circle / whole:.9g}"
    resized = "" if whole == teeth else f", or teeth: {whole}{other}"
    raise WrongInput(
        f"{teeth} teeth of module {module_mm:g} mm do not fit a centre distance of {distance_mm:g} mm"
        f"{', which follows from the law' if by_law else ''}; consistent would be "
        f"{'' if by_law else f'center_distance_mm: {fitting:.9g}, or '}module_mm: {circle / teeth:.9g}{resized}",
        key="gears.module_mm" if by_law else "gears.center_distance_mm",
    )
