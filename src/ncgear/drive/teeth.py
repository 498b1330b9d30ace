"""The stages of a drive from the pitch curves to the contact of the teeth."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ncgear.drive.motion import MotionStages
from ncgear.drive.stage import stage
from ncgear.machine.rack import BasicRack
from ncgear.recipe.gears import helix_of, rack_of, tooth_form

if TYPE_CHECKING:
    from ncgear.contact.as_designed import AsDesigned
    from ncgear.contact.as_written import Outlines
    from ncgear.contact.pair_contact import PairContact
    from ncgear.pitch.pair import PitchPair
    from ncgear.solids.helix import Helix
    from ncgear.teeth.form import ToothForm
    from ncgear.teeth.gear import ToothedPair


class ToothStages(MotionStages):
    """Pitch curves, teeth, and their contact."""

    @stage
    def pitch(self) -> PitchPair:
        """Both pitch curves at their size."""
        from ncgear.pitch.pair import sized_pair
        from ncgear.pitch.shape import Mesh

        gears, transmission = self.gears, self.pair.transmission
        with self.stopwatch("pitch curves"):
            size = gears.teeth, gears.module_mm, gears.center_distance_mm
            return sized_pair(transmission, *size, Mesh(gears.mesh))

    @stage
    def rack(self) -> BasicRack:
        """The basic rack at the module."""
        return rack_of(self.gears, self.pitch.size.module_mm)

    @property
    def helix(self) -> Helix | None:
        """The helix of the teeth; None where they are straight."""
        return helix_of(self.gears)

    @property
    def overlap_ratio(self) -> float:
        """What the helix adds to the contact ratio: its advance in pitches."""
        return self.helix.largest_advance_mm / self.rack.pitch_mm if self.helix else 0.0

    @stage
    def tooth_form(self) -> ToothForm:
        """Everything asked of the teeth, at the module; of helical ones, that their tips do not jump with height."""
        from ncgear.solids.even_tips import with_even_tips

        form, pitch = tooth_form(self.gears, self.pitch.size.module_mm), self.pitch
        if self.helix is None:
            return form
        with self.stopwatch("teeth"):
            return with_even_tips(pitch, form, self.helix)

    @stage
    def teeth(self) -> ToothedPair:
        """Both toothed gears."""
        from ncgear.teeth.gear import toothed_pair

        pitch, form = self.pitch, self.tooth_form
        with self.stopwatch("teeth"):
            return toothed_pair(pitch, form, self.design.output.chord_tolerance_mm)

    @stage
    def designed_contact(self) -> AsDesigned:
        """Contact of the exact teeth, which must not overlap."""
        from ncgear.contact.as_designed import as_designed
        from ncgear.contact.pair_contact import refuse_overlap
        from ncgear.contact.placement import placed
        from ncgear.contact.shortness import refuse_short_contact

        pitch, teeth = self.pitch, self.teeth
        with self.stopwatch("contact"):
            contact = as_designed(teeth, placed(pitch))
            refuse_overlap(contact, self.design.output.chord_tolerance_mm)
            refuse_short_contact(contact, teeth, self._asked_of_section(contact.longest_gap_pitches))
            return contact

    def require_sound_teeth(self) -> None:
        """Raise WrongInput or NoSuchMechanism where the contact of the exact teeth is not sound."""
        _ = self.designed_contact

    @property
    def sound_teeth(self) -> ToothedPair:
        """Both toothed gears, once their contact is found sound."""
        self.require_sound_teeth()
        return self.teeth

    def contact(self, written: Sequence[Outlines]) -> PairContact:
        """Contact of the exact teeth and of outlines that were written, which must touch where the teeth do."""
        from ncgear.contact.pair_contact import pair_contact, refuse_bad_outlines

        designed, pitch, teeth = self.designed_contact, self.pitch, self.teeth
        with self.locating(), self.stopwatch("written contact"):
            contact = pair_contact(pitch, teeth, designed, written)
            refuse_bad_outlines(contact, self.design.output.chord_tolerance_mm)
            return contact

    @stage
    def section_contact_ratio(self) -> float:
        """Least arc of contact of any pair of flanks in the sections of helical teeth, in pitches."""
        from ncgear.solids.section_contact import least_section_contact
        from ncgear.solids.sections import Sections

        assert self.helix is not None
        pitch, form, tolerance = self.pitch, self.tooth_form, self.design.output.chord_tolerance_mm
        return least_section_contact(Sections(pitch, form, self.helix, tolerance))

    def _asked_of_section(self, gap: float) -> float:
        """The contact ratio that a section must have, which loses contact over ``gap`` pitches.

        Of helical teeth, what the overlap leaves to it; at least that contact never ceases where it is less than the
        gap.
        """
        least = self.gears.least_contact_ratio
        return least if gap > self.overlap_ratio and least <= 1.0 else least - self.overlap_ratio
