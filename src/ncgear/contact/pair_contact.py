"""Contact of a pair over the whole cycle, as designed and as written, and the refusal of teeth that overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ncgear.contact.as_designed import AsDesigned
from ncgear.contact.as_written import AsWritten, Outlines, as_written
from ncgear.contact.reach import reach_mm
from ncgear.errors import NoSuchMechanism
from ncgear.numerics.angles import in_words
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Mesh
from ncgear.teeth.gear import ToothedPair

CHORDS_OVERLAP = 1.1
"""Overlap in chord tolerances that outlines may show: chords stand out of a flank only where it is hollow, and of two
flanks that touch one is not.  A tenth is for rounding in the files."""

CHORDS_ASTRAY = 4.0
"""Distance in chord tolerances by which outlines may touch elsewhere than designed: twice what both chords can cost."""

CAUSES = {
    Mesh.EXTERNAL: "tips of a concave stretch foul the mating gear there; more teeth of a smaller module are needed, "
    "or a smaller range of the ratio",
    Mesh.INTERNAL: "tips foul the mating gear or, where a ring has too few teeth more than its driving gear, each "
    "other; a smaller addendum, more teeth of a smaller module, or more lobes of the driven gear are needed",
}
"""Why teeth overlap, and what helps."""


@dataclass(frozen=True, eq=False)
class PairContact:
    """Contact of the exact curves, and of the outlines in each of the forms in which they were written."""

    as_designed: AsDesigned
    as_written: tuple[AsWritten, ...]

    def __repr__(self) -> str:
        return (
            f"PairContact(contact ratio {self.contact_ratio:.3f}, as written: transmission error "
            f"{self.transmission_error_rad:.3g} rad, overlap {self.penetration_mm:.3g} mm,\n  {self.as_designed!r})"
        )

    @property
    def transmission_error_rad(self) -> float:
        """Peak to peak, of the worst outlines."""
        return max(written.transmission_error_rad for written in self.as_written)

    @property
    def contact_ratio(self) -> float:
        """Least arc of contact of any pair of flanks, in pitches."""
        return float(min(self.as_designed.pushing.arcs.min(), self.as_designed.back.arcs.min()))

    @property
    def penetration_mm(self) -> float:
        """Deepest overlap at the law's angle, of the worst outlines."""
        return max(float(written.overlap_mm.max()) for written in self.as_written)


def pair_contact(
    pitch: PitchPair, teeth: ToothedPair, designed: AsDesigned, written: Sequence[Outlines]
) -> PairContact:
    """Contact of a pair that was designed so and has been written in each of these forms; raises as ``as_written``."""
    reach = reach_mm(pitch, teeth)
    return PairContact(designed, tuple(as_written(one, teeth, designed.placement, reach) for one in written))


def refuse_overlap(designed: AsDesigned, tolerance_mm: float) -> None:
    """Refuse a pair whose exact curves overlap by more than the chord tolerance, below which nothing is written.

    Raises NoSuchMechanism with the worst angle and the tooth that meets another there.
    """
    _refuse(designed.overlap_mm, tolerance_mm, designed)


def refuse_bad_outlines(contact: PairContact, tolerance_mm: float) -> None:
    """Refuse outlines that overlap by more than their chords explain.

    Raises NoSuchMechanism as above, and RuntimeError where they touch elsewhere than designed, a fault of ncgear.
    """
    for written in contact.as_written:
        _refuse(written.overlap_mm, CHORDS_OVERLAP * tolerance_mm, contact.as_designed)
        _require_as_designed(written, contact.as_designed, CHORDS_ASTRAY * tolerance_mm)


def _refuse(overlap_mm: Array, allowed_mm: float, designed: AsDesigned) -> None:
    worst = int(np.argmax(overlap_mm))
    if overlap_mm[worst] <= allowed_mm:
        return
    phi1 = float(designed.placement.phi1_rad[worst])
    tooth, _ = designed.placement.teeth_at(worst)
    raise NoSuchMechanism(
        f"the teeth run into each other by {overlap_mm[worst]:.3g} mm near tooth {tooth} of the driving gear at phi1 = "
        f"{in_words(phi1)}: {CAUSES[designed.placement.mesh]}",
        key="gears.teeth",
    )


def _require_as_designed(written: AsWritten, designed: AsDesigned, allowed_mm: float) -> None:
    sides = (written.pushing_rad, designed.pushing.first), (written.back_rad, designed.back.first)
    for error, first in sides:
        astray = np.abs(error - first.error_rad) * first.lever_mm
        worst = int(np.argmax(astray))
        if astray[worst] > allowed_mm:
            phi1 = in_words(float(designed.placement.phi1_rad[worst]))
            raise RuntimeError(
                f"the outlines written as {written.source} touch {astray[worst]:.3g} mm off the design at phi1 = {phi1}"
            )
