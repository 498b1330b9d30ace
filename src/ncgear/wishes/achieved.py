"""What a motion achieves, whatever is wished of it: even speed, time ratio, near-dwells; and the outcome of wishes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import floor, log10

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import End, Stroke, about_end, taken_rad, time_ratio
from ncgear.kinematics.even_speed import EvenStretch, longest_even_stretch
from ncgear.kinematics.motion import Machine
from ncgear.wishes.wish import Outcome, Wish

EVEN = 0.005
"""Share of a speed within which it counts as constant."""

NEAR = 1e-3
"""Share of the stroke, rounded down to 1, 2 or 5 of a decimal place, within which the output counts as standing."""


@dataclass(frozen=True)
class Achieved:
    """What a motion achieves, whatever is wished, and the outcome of every wish.

    ``even`` has the longest stretch of each stroke over which the speed stays within EVEN of one value; ``dwell_rad``
    the driving angle for which the displacement stays within ``near_mm`` of each end.  Gears that turn less than once
    have the way forth alone: no time ratio, which is None, and no dwells.
    """

    even: Mapping[Stroke, EvenStretch]
    time_ratio: float | None
    near_mm: float
    dwell_rad: Mapping[End, float]
    outcomes: tuple[Outcome, ...]


def achieved(machine: Machine, wishes: Sequence[Wish]) -> Achieved:
    """What a machine's motion achieves at its constant driving speed."""
    near = near_mm(machine.linkage.stroke_mm)
    if not machine.transmission.lobes.repeats:
        forth = Stroke.WORKING
        return Achieved({forth: longest_even_stretch(machine, forth, EVEN)}, None, near, {}, ())
    return Achieved(
        even={stroke: longest_even_stretch(machine, stroke, EVEN) for stroke in Stroke},
        time_ratio=time_ratio(machine),
        near_mm=near,
        dwell_rad={end: taken_rad(machine, about_end(machine.linkage, end, near)) for end in End},
        outcomes=tuple(wish.outcome(machine) for wish in wishes),
    )


def near_mm(stroke_mm: float) -> float:
    """The distance from an end within which the output counts as standing: NEAR of the stroke in round figures."""
    share = NEAR * stroke_mm
    unit = 10.0 ** floor(log10(share))
    # Rounding errors must not bring 1, 2 or 5 down to the next figure.
    return unit * max(figure for figure in (1.0, 2.0, 5.0) if figure <= share / unit * (1.0 + 1e-9))
