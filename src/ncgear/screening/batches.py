"""From designs to samples: which designs can be computed together, and how."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from ncgear.design.keys.base import Model
from ncgear.design.keys.design import Design
from ncgear.design.keys.motion import HarmonicRatio, ThreeSegmentStroke
from ncgear.design.mechanisms import mechanisms_of
from ncgear.mechanisms.resistance import Resistance
from ncgear.numerics.arrays import Array
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.project.law import SAME_STROKE, lobes_of, resistance_of
from ncgear.ratio.transmission import Lobes
from ncgear.ratio.working_stroke import StrokeRequests, closed_strokes
from ncgear.screening.samples import Sampled, harmonic_samples, returns_with_constant, stroke_samples

STROKE, HARMONIC = "three_segment_stroke", "harmonic_ratio"


@dataclass(frozen=True)
class Kind:
    """What the designs of one batch share; ``linkage`` are the keys of its mechanism."""

    linkage: type[Model]
    law: tuple[Hashable, ...]
    lobes: Lobes
    resistance: Resistance


def kind_of(design: Design) -> Kind | None:
    """The batch that a design belongs to; None where it must be computed by itself."""
    law = _law(design)
    if law is None or (design.gears is not None and design.gears.mesh == "internal"):
        return None
    if design.resistance is not None and design.resistance.table is not None:
        # The bend of a table's force jumps at its points, which no series along a piece resolves.
        return None
    return Kind(type(design.linkage), law, lobes_of(design), resistance_of(design))


def sampled(kind: Kind, designs: Sequence[Design], count: int) -> Sampled:
    """The laws of a batch at ``count`` points a piece."""
    return _strokes(kind, designs, count) if kind.law[0] == STROKE else _harmonics(kind, designs, count)


def _law(design: Design) -> tuple[Hashable, ...] | None:
    motion = design.motion
    if isinstance(motion, ThreeSegmentStroke):
        if motion.solve_for == "stroke" or motion.return_.e == "least_acceleration":
            return None
        return STROKE, motion.solve_for, motion.a1_speed_rpm is None, motion.stroke_mm is None
    if isinstance(motion, HarmonicRatio) and motion.second_stage is None and (motion.cosine or motion.sine):
        return HARMONIC, _working_angle_rad(design)
    return None


def _working_angle_rad(design: Design) -> float | None:
    """That of the linkage, which a batch of harmonic laws shares; None where the crank cannot turn."""
    linkage = mechanisms_of([design.linkage])
    return float(linkage.working_angle_rad[0]) if linkage.turns_fully[0] else None


def _strokes(kind: Kind, designs: Sequence[Design], count: int) -> Sampled:
    """As ``recipe/law.py`` makes one; what it would refuse is not ``sound``."""
    linkage = mechanisms_of([design.linkage for design in designs])
    stroke_mm, period = linkage.stroke_mm, kind.lobes.driving_period_rad
    strokes = closed_strokes(_requests(designs, stroke_mm))
    returns = returns_with_constant(strokes, linkage, period, _column(designs, "motion.return_.e"), count)
    sound = linkage.turns_fully & (strokes.theta4_rad < period)
    if kind.law[-1] is False:
        sound &= np.isclose(_column(designs, "motion.stroke_mm"), stroke_mm, rtol=SAME_STROKE / 2.0, atol=0.0)
    samples = stroke_samples(strokes, linkage, returns, count)
    return Sampled(samples, sound, stroke_mm, strokes.law_speed_rad_s / RAD_S_PER_RPM, strokes.closing_error_mm)


def _harmonics(kind: Kind, designs: Sequence[Design], count: int) -> Sampled:
    """As ``recipe/law.py`` makes one; the law holds at any speed, and so at that of operation."""
    cosine, sine = _padded(designs, "motion.cosine", "motion.sine")
    linkage = mechanisms_of([design.linkage for design in designs])
    samples = harmonic_samples(cosine, sine, linkage, kind.lobes, count)
    speed = _column(designs, "operation.speed_rpm")
    return Sampled(samples, linkage.turns_fully, linkage.stroke_mm, speed, 0.0 * speed)


def _padded(designs: Sequence[Design], *names: str) -> list[Array]:
    """Lists of numbers as rows, shape (n, longest of them) for each name, zeros where they are shorter."""
    lists = [[attrgetter(name)(design) for design in designs] for name in names]
    longest = max(len(values) for column in lists for values in column)
    return [np.array([[*values, *[0.0] * (longest - len(values))] for values in column]) for column in lists]


def _requests(designs: Sequence[Design], stroke_mm: Array) -> StrokeRequests[Array]:
    theta1, theta2, theta3, theta4 = (_column(designs, f"motion.theta{number}") for number in (1, 2, 3, 4))
    return StrokeRequests(
        theta1_rad=theta1,
        theta2_rad=theta2,
        theta3_rad=theta3,
        theta4_rad=theta4,
        v1_mm_s=_given(designs, "v1_mm_s"),
        v2_mm_s=_given(designs, "v2_mm_s"),
        a1_mm_s2=_given(designs, "a1_mm_s2"),
        law_speed_rad_s=_given(designs, "law_speed_rpm", RAD_S_PER_RPM),
        stroke_mm=stroke_mm,
        a1_speed_rad_s=_given(designs, "a1_speed_rpm", RAD_S_PER_RPM),
    )


def _given(designs: Sequence[Design], name: str, unit: float = 1.0) -> Array | None:
    """A value of the motion that all designs of a batch have, or none."""
    if getattr(designs[0].motion, name) is None:
        return None
    return _column(designs, f"motion.{name}") * unit


def _column(designs: Sequence[Design], name: str) -> Array:
    """The values at a dotted name, shape (n,)."""
    value: Callable[[Any], float] = attrgetter(name)
    return np.array([value(design) for design in designs], dtype=float)
