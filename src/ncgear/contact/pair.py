"""Contact of a pair over the whole cycle, as designed and as written, and which pairs are refused.

Refused are teeth that overlap, as designed or as written, and flanks that do not touch long enough: the message names
the teeth, and the limits of their tips.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from ncgear.contact.designed.as_designed import AsDesigned, SideContact
from ncgear.contact.designed.extremes import ContactExtremes, contact_extremes
from ncgear.contact.designed.flanks import PairsInContact
from ncgear.contact.placement import Placement
from ncgear.contact.written.as_written import AsWritten, Outlines, as_written, reach_mm
from ncgear.contact.written.extremes import WrittenExtremes, may_overlap, written_extremes
from ncgear.errors import NoSuchMechanism, RefusedAt
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.units import in_words
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.teeth.gear import ToothedGear, ToothedPair
from ncgear.teeth.tips import Limit


@dataclass(frozen=True, eq=False)
class PairContact:
    """Contact of the exact curves, and of the ``outlines`` in each written form."""

    as_designed: AsDesigned
    as_written: tuple[AsWritten, ...]
    pitch: PitchPair
    teeth: ToothedPair
    outlines: tuple[Outlines, ...]

    def __repr__(self) -> str:
        return (
            f"PairContact(contact ratio {self.as_designed.contact_ratio:.3f}, as written: transmission error "
            f"{self.transmission_error_rad:.3g} rad, overlap {self.penetration_mm:.3g} mm,\n  {self.as_designed!r})"
        )

    @cached_property
    def extremes(self) -> tuple[WrittenExtremes, ...]:
        """The extremes of each form, between the positions as well; raises as ``as_written``."""
        reach, forms = reach_mm(self.pitch, self.teeth), zip(self.outlines, self.as_written, strict=True)
        fixed = self.pitch, self.teeth
        return tuple(written_extremes(form, *fixed, found, self.as_designed, reach) for form, found in forms)

    def may_overlap(self, allowed_mm: float) -> bool:
        """Whether any form overlaps by more than is allowed, which takes far less time than all ``extremes``."""
        reach, even = reach_mm(self.pitch, self.teeth), self.as_designed.placement
        forms = zip(self.outlines, self.as_written, strict=True)
        return any(may_overlap(allowed_mm, form, self.pitch, found, even, reach) for form, found in forms)

    @property
    def transmission_error_rad(self) -> float:
        """Peak to peak, of the worst outlines."""
        return max(found.transmission_error_rad for found in self.extremes)

    @property
    def repeated_teeth(self) -> int | None:
        """Teeth of either gear after which the outlines of every form meet as at first; None where they never do."""
        placement, after = self.as_designed.placement, max(found.repeat for found in self.as_written)
        return round(after / placement.per_tooth) if after < placement.count else None

    @property
    def penetration_mm(self) -> float:
        """Deepest overlap at the law's angle, of the worst outlines."""
        return max(found.overlap_mm.value for found in self.extremes)


def pair_contact(
    pitch: PitchPair, teeth: ToothedPair, designed: AsDesigned, written: Sequence[Outlines]
) -> PairContact:
    """Contact of a pair as designed and in each written form; raises as ``as_written``."""
    reach = reach_mm(pitch, teeth)
    found = tuple(as_written(form, teeth, designed.placement, reach) for form in written)
    return PairContact(designed, found, pitch, teeth, tuple(written))


CHORDS_OVERLAP = 1.1
"""Overlap, in chord tolerances, that outlines may show.  Chords of flanks stay within the material; chords of fillets
that a rack leaves may stand out by a tolerance where a mate's corner passes.  A tenth is for rounding in the files."""

CHORDS_ASTRAY = 4.0
"""Distance of contact, in chord tolerances, from the designed contact: twice the error of both chords."""

CAUSES = {
    Mesh.EXTERNAL: "tips of a concave stretch foul the mating gear there; more teeth of a smaller module are needed, "
    "a smaller range of the ratio or, where there is play, less of it",
    Mesh.INTERNAL: "tips foul the mating gear or, where a ring has too few teeth more than its driving gear, each "
    "other; a smaller addendum, more teeth of a smaller module, or more lobes of the driven gear are needed",
}
"""Why teeth overlap, and changes that help against it."""


def refuse_overlap(designed: AsDesigned, tolerance_mm: float) -> None:
    """Refuse a pair whose exact curves overlap by more than the chord tolerance; raises NoSuchMechanism."""
    _refuse(designed.overlap_mm, tolerance_mm, designed)


def refuse_cut_arcs(designed: AsDesigned) -> None:
    """Refuse gears turning less than once if no pair of flanks touches over its whole arc; raises NoSuchMechanism."""
    for side, name in ((designed.pushing, "pushing"), (designed.back, "idle")):
        if not side.pairs.whole.any():
            raise NoSuchMechanism(
                f"the range is {side.pairs.pitches:.3g} tooth pitches long, and no pair of {name} flanks both meets "
                "and parts within it; a smaller module or a greater range is right",
                key="gears.module_mm",
            )


BETWEEN_BODIES = 5
"""After this number of positions whole bodies are compared again; in between they move by a quarter of a pitch."""


def refuse_clashing_bodies(designed: AsDesigned, teeth: ToothedPair, tolerance_mm: float) -> None:
    """Refuse gears turning less than once whose bodies meet beyond their teeth; raises NoSuchMechanism."""
    from shapely import Polygon, affinity

    placement = designed.placement
    if placement.toothed is None:
        return
    driving, driven = (Polygon(teeth.of(gear).outline_mm) for gear in Gear)
    # Chords of touching flanks overlap by a tolerance at most, over a part of a flank.
    allowed_mm2 = tolerance_mm * teeth.driving.flanks.rack.module_mm
    for position in range(0, placement.count, BETWEEN_BODIES):
        phi1, phi2 = float(placement.phi1_rad[position]), float(placement.phi2_rad[position])
        first = affinity.rotate(driving, phi1, origin=(0, 0), use_radians=True)
        second = affinity.rotate(driven, -phi2, origin=(0, 0), use_radians=True)
        if first.intersection(affinity.translate(second, placement.center_distance_mm)).area > allowed_mm2:
            raise NoSuchMechanism(
                f"the gears' bodies run into each other at phi1 = {in_words(phi1)}, beyond their last teeth; a smaller "
                "range, or a ratio that changes less, is right",
                key="motion",
            )


def sound_extremes(
    pitch: PitchPair,
    teeth: ToothedPair,
    designed: AsDesigned,
    speed_rad_s: Callable[[Array], Array],
    tolerance_mm: float,
) -> ContactExtremes:
    """The extremes of the contact; raises as ``refuse_overlap`` where teeth overlap between its positions."""
    found = contact_extremes(teeth, pitch, designed, speed_rad_s)
    _refuse_between(found, tolerance_mm, designed)
    return found


def refuse_bad_outlines(contact: PairContact, tolerance_mm: float) -> None:
    """Refuse outlines that overlap more than chords do or touch elsewhere than designed; raises NoSuchMechanism."""
    for written in contact.as_written:
        _refuse(written.overlap_mm, CHORDS_OVERLAP * tolerance_mm, contact.as_designed)
        _require_as_designed(written, contact.as_designed, CHORDS_ASTRAY * tolerance_mm)
    if contact.may_overlap(CHORDS_OVERLAP * tolerance_mm):
        for found in contact.extremes:
            _refuse_between(found, CHORDS_OVERLAP * tolerance_mm, contact.as_designed)


def _refuse(overlap_mm: Array, allowed_mm: float, designed: AsDesigned) -> None:
    worst = int(np.argmax(overlap_mm))
    if overlap_mm[worst] <= allowed_mm:
        return
    deepest = Extremum(float(overlap_mm[worst]), float(designed.placement.phi1_rad[worst]))
    raise _overlapping(deepest, designed.placement.teeth_at(worst)[0], designed.placement.mesh)


def _refuse_between(found: ContactExtremes | WrittenExtremes, allowed_mm: float, designed: AsDesigned) -> None:
    if found.overlap_mm.value > allowed_mm:
        raise _overlapping(found.overlap_mm, found.overlap_teeth[0], designed.placement.mesh)


def _overlapping(deepest: Extremum, tooth: int, mesh: Mesh) -> NoSuchMechanism:
    return RefusedAt(
        f"the teeth run into each other by {deepest.value:.3g} mm near tooth {tooth} of the driving gear at phi1 = "
        f"{in_words(deepest.at)}: {CAUSES[mesh]}",
        phi1_rad=deepest.at,
        key="gears.teeth",
    )


def _require_as_designed(written: AsWritten, designed: AsDesigned, allowed_mm: float) -> None:
    sides = (written.pushing_rad, designed.pushing.first), (written.back_rad, designed.back.first)
    for error, first in sides:
        astray = np.abs(error - first.error_rad) * first.lever_mm
        worst = int(np.argmax(astray))
        if astray[worst] > allowed_mm:
            phi1 = float(designed.placement.phi1_rad[worst])
            tooth, _ = designed.placement.teeth_at(worst)
            raise RefusedAt(
                f"the outlines written as {written.source} touch {astray[worst]:.3g} mm off the exact teeth near tooth "
                f"{tooth} of the driving gear at phi1 = {in_words(phi1)}: {CAUSES[designed.placement.mesh]}",
                phi1_rad=phi1,
                key="gears.teeth",
            )


ROUNDING = 1e-9
"""Share of a pitch that rounding may cost a contact."""

REASONS = {
    Limit.FULL: "its full height",
    Limit.SLOPE: "higher its land would slope too much, the tooth's other edge being lower",
    Limit.FILLET: "higher it would reach into the mate's fillet",
    Limit.UNDERCUT: "higher it would undercut the mate",
    Limit.CUSP: "its flank ends in a cusp there",
    Limit.LAND: "higher its land would be too narrow",
    Limit.FOULING: "higher it would foul the mate's tips",
    Limit.HELIX: "higher it would jump between sections of the helical teeth",
    Limit.OTHER_MESH: "higher it would not suit the gear's other mesh",
}

REMEDY = (
    "more teeth of a smaller module, a smaller range of the ratio or a smaller least_tip_land help, or a smaller "
    "least_contact_ratio to have the gears all the same"
)


LESS_RELIEF = "less tip relief, or one that begins higher, helps"
EXACT_FLANKS = "exact flanks help"
"""Advice where flanks that could touch are held apart: with tip relief, and without."""

SidesInContact = tuple[PairsInContact, PairsInContact]
"""The pairs of pushing flanks in contact, and the pairs of their backs."""


def short_contacts(
    designed: AsDesigned, teeth: ToothedPair, least: float, overlap: float = 0.0, loaded: SidesInContact | None = None
) -> tuple[str | None, str | None]:
    """Words for pushing flanks and backs that touch over fewer than ``least`` pitches or lose contact; None if enough.

    Contact under load counts where ``loaded`` gives it, else the contact of rigid teeth without flanks that a tip
    relief holds apart.  ``overlap`` is the part that a helix adds, in pitches.  Neighbours may bridge the rest of a
    pitch: a ``least`` of exactly 1 asks only that contact never ceases, a ``least`` above 1 asks for both, below 1 for
    nothing.
    """
    sides = designed.pushing, designed.back
    pairs = loaded or (designed.pushing.pairs, designed.back.pairs)
    judged = (
        _Judged(designed.placement, side, own, loaded is not None, teeth)
        for side, own in zip(sides, pairs, strict=True)
    )
    pushing, back = (_lacking(side, least, overlap) for side in judged)
    return pushing, back


def refuse_short_contact(short: tuple[str | None, str | None], *, both_ways: bool) -> None:
    """Refuse short contacts of pushing flanks and, with ``both_ways``, of idle backs; raises NoSuchMechanism."""
    pushing, back = short
    if pushing is not None:
        raise NoSuchMechanism(pushing, key="gears.least_contact_ratio")
    if both_ways and back is not None:
        problem = f"idle flanks, which drives: both_ways asks to hold: {back}"
        raise NoSuchMechanism(problem, key="gears.least_contact_ratio")


@dataclass(frozen=True, eq=False)
class _Judged:
    """One side of the teeth, with the pairs of flanks that count as touching, ``loaded`` or not."""

    placement: Placement
    side: SideContact
    pairs: PairsInContact
    loaded: bool
    teeth: ToothedPair

    @property
    def shortest(self) -> int:
        """The meeting whose flanks touch over the least length."""
        return self.pairs.shortest


def _lacking(judged: _Judged, least: float, overlap: float) -> str | None:
    pairs, shortest = judged.pairs, judged.shortest
    arc = float(pairs.arcs[shortest])
    if least > 1.0 and arc + overlap < least - ROUNDING:
        helix = f" and {overlap:.3g} more by the helix" if overlap else ""
        reach = float(judged.side.reaches[shortest])
        cause = f"{_limits(judged)}; {REMEDY}"
        if reach + overlap >= least:
            helps = LESS_RELIEF if judged.teeth.driving.flanks.rack.relief else EXACT_FLANKS
            load = "the load there is too small" if judged.loaded else "no masses are given, so no load counts"
            cause = f"others hold them apart, though they reach over {reach:.3g} pitches; {helps} ({load})"
        return f"the flanks of {_pair(judged)} touch over {arc:.3g} pitches{helix} only, less than {least:.3g}: {cause}"
    if least >= 1.0 and pairs.longest_gap > overlap * judged.placement.per_tooth:
        at = in_words(float(judged.placement.phi1_rad[pairs.parted_at]))
        return (
            f"no flanks touch at phi1 = {at}: one pair parts before the next one meets; the shortest contact is "
            f"that of {_pair(judged)}, {arc:.3g} pitches: {_limits(judged)}; {REMEDY}"
        )
    return None


def _pair(judged: _Judged) -> str:
    met, shortest = judged.side.meetings, judged.shortest
    driving, driven = int(met.driving[shortest]), int(met.driven[shortest])
    flanks = judged.teeth.driving.flanks
    phi1 = float(flanks.curve.driving_angle(flanks.crossing_mm[driving : driving + 1])[0])
    return f"driving tooth {driving // 2 + 1} and driven tooth {driven // 2 + 1} (phi1 = {in_words(phi1)})"


def _limits(judged: _Judged) -> str:
    met, shortest = judged.side.meetings, judged.shortest
    driving = _limit(judged.teeth.driving, int(met.driving[shortest]))
    driven = _limit(judged.teeth.driven, int(met.driven[shortest]))
    return f"the driving tip ends {driving}, the driven one {driven}{_hollow(judged)}"


def _hollow(judged: _Judged) -> str:
    """Words for the gear that is concave where the flanks meet, and for its curvature; empty where neither is."""
    met, shortest = judged.side.meetings, judged.shortest
    told = ""
    for gear, number in ((judged.teeth.driving, met.driving[shortest]), (judged.teeth.driven, met.driven[shortest])):
        curve, module = gear.flanks.curve, gear.flanks.rack.module_mm
        hollow = module * float(curve.at_length(gear.flanks.crossing_mm[[int(number)]]).curvature[0])
        if hollow < 0.0:
            told += f"; there the {curve.gear.value} gear is concave, {hollow:.3g} per module"
    return told


def _limit(gear: ToothedGear, flank: int) -> str:
    height = float(gear.flanks.tip_height_mm[flank])
    return f"{height:.3g} mm above the pitch curve ({REASONS[Limit(int(gear.tips.limit[flank]))]})"
