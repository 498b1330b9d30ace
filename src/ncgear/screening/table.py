"""What a screening gives: figures of the designs that can be made, and of the others which condition they fail."""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.numerics.arrays import Array, IndexArray, Mask

CHECK_FIGURES = (
    "drive.law_speed_rpm",
    "closure.residual_rad",
    "closure.stroke_residual_mm",
    "ratio.min",
    "ratio.max",
    "check.peak_power_w",
    "check.mean_power_w",
    "check.peak_speed_mm_s",
    "check.peak_acceleration_working_mm_s2",
    "check.peak_acceleration_cycle_mm_s2",
)
"""Keys of ``summary.json`` that every design has."""

PITCH_FIGURES = (
    "pitch.center_distance_mm",
    "pitch.length_driving_mm",
    "pitch.length_driven_mm",
    "pitch.driving_convex",
    "pitch.driven_convex",
    "pitch.min_radius_driving_mm",
    "pitch.min_radius_driven_mm",
    "pitch.max_tangent_angle_deg",
    "pitch.max_pressure_angle_deg",
)
"""Those of designs that say how their gears are; convex is 1 or 0."""

MADE = "made"


@dataclass(frozen=True, eq=False)
class Screened:
    """Of n designs, the m that can be made.

    ``figures`` has an array of shape (m,) for each key, in the order of the designs; ``verdicts`` a word for each of
    the n: ``made``, or the key at fault and what is wrong.  ``one_by_one`` (shape (n,)) marks those that were computed
    by themselves, because the batch could not be sure of them or has no form for their law.
    """

    figures: dict[str, Array]
    made: Mask
    verdicts: tuple[str, ...]
    one_by_one: Mask

    @property
    def rows(self) -> IndexArray:
        """Numbers of the designs that the figures belong to, shape (m,)."""
        numbers: IndexArray = self.made.nonzero()[0]
        return numbers
