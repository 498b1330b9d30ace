"""The slider's way: its guide and, where it presses against something, the chamber with the material in it.

A design file tells the force, not the chamber: width, length of the slider and what the fullest stroke leaves in front
of it are chosen in proportion to the stroke.  The material lies where the force acts: from where it first does to the
chamber's end.  On its way back the slider leaves it behind, pressed; the next stroke begins with another charge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ncgear.machine.linkage import CrankSlider
from ncgear.machine.resistance import Resistance
from ncgear.numerics.arrays import Array, Mask

SLIDER_LENGTH = 0.30
HEIGHT = 0.42
REST = 0.14
"""Length of the slider, height of the chamber and least depth of the material, as shares of the stroke."""


@dataclass(frozen=True)
class Chamber:
    """A rectangle about the slider's line y = ``offset_mm``; places along it count from the crank's axis.

    ``begins_mm`` is the slider's displacement at which it meets the material, None where there is none.
    """

    linkage: CrankSlider
    begins_mm: float | None

    @property
    def face_mm(self) -> float:
        """From the pin of the slider to its face."""
        return SLIDER_LENGTH / 2.0 * self.linkage.stroke_mm

    @property
    def height_mm(self) -> float:
        """Across the slider's line; the slider fills it."""
        return HEIGHT * self.linkage.stroke_mm

    @property
    def start_mm(self) -> float:
        """Where the retracted slider's back is."""
        return self.linkage.nearest_mm - self.face_mm

    @property
    def end_mm(self) -> float:
        """The wall against which the material is pressed."""
        return self.linkage.farthest_mm + self.face_mm + REST * self.linkage.stroke_mm

    def material_mm(self, displacement_mm: Array, working: Mask) -> Array:
        """Depth of the material before the chamber's end, shape (n,); nan nowhere, 0 where there is none."""
        if self.begins_mm is None:
            return np.zeros_like(displacement_mm)
        pressed = np.where(working, np.maximum(displacement_mm, self.begins_mm), self.linkage.stroke_mm)
        depth: Array = self.end_mm - self.face_mm - self.linkage.nearest_mm - pressed
        return depth


def chamber_of(linkage: CrankSlider, resistance: Resistance | None) -> Chamber:
    """The chamber of a linkage that works against a resistance; an empty guide where that is None or nowhere acts."""
    return Chamber(linkage, None if resistance is None else _begins_mm(resistance, linkage.stroke_mm))


def _begins_mm(resistance: Resistance, stroke_mm: float) -> float | None:
    edges = np.concatenate([[0.0], resistance.zeros_mm(stroke_mm), [stroke_mm]])
    acting = np.nonzero(resistance.force_n((edges[:-1] + edges[1:]) / 2.0) > 0.0)[0]
    return float(edges[acting[0]]) if acting.size else None
