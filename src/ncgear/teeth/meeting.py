"""Which flanks meet: mating flanks cross the pitch curves at the same rolled length."""

from __future__ import annotations

from math import lcm

import numpy as np

from ncgear.numerics.arrays import IndexArray


def mating_flanks(driving_teeth: int, driven_teeth: int) -> tuple[IndexArray, IndexArray]:
    """Numbers of the driving and of the driven flank of every pair that ever meets, shape (2 lcm,) each.

    A driving tooth's front flank crosses a quarter pitch after its middle, where the back flank of the driven tooth
    half a pitch on stands; its back flank meets the front flank of the driven tooth half a pitch before.
    """
    meeting = np.arange(lcm(driving_teeth, driven_teeth))
    own, ahead, behind = meeting % driving_teeth, meeting % driven_teeth, (meeting - 1) % driven_teeth
    return np.concatenate([2 * own + 1, 2 * own]), np.concatenate([2 * ahead, 2 * behind + 1])
