"""The readings that the paper prints, and its chain drive."""

from __future__ import annotations

from functools import cache
from math import radians

from ncgear.balance.rotor import ChainPhases, ChainUnbalance, Prediction, Range, WeightRun, chain_unbalance
from ncgear.balance.rotor import predicted as predicted_from
from ncgear.papers.readings import polar

PHASES = ChainPhases(wrap_rad=radians(180.0), tight_rad=radians(105.0), slack_rad=radians(270.0))

RUNS = (
    (60.0, 0.426, 275.0),
    (120.0, 0.502, 135.0),
    (180.0, 0.382, 124.0),
    (240.0, 0.513, 173.0),
    (300.0, 0.483, 209.0),
    (360.0, 0.465, 256.0),
)
"""Table 3 at 700 r/min: phase of the weight in degrees, amplitude in mm/s and phase in degrees of the reading."""

PRINTED_RANGES = ChainUnbalance(Range(0.074, 0.214), Range(0.0, 2.04), Range(0.0, 2.58))
"""Amplitudes in mm/s of weight, tight side and slack side."""


@cache
def ranges() -> ChainUnbalance:
    """The same from the readings."""
    runs = [WeightRun(radians(weight), polar(amplitude, phase)) for weight, amplitude, phase in RUNS]
    return chain_unbalance(runs, PHASES)


@cache
def prediction(weight_deg: float) -> Prediction:
    """Bounds of the reading with the weight at a phase, from the printed ranges."""
    return predicted_from(PRINTED_RANGES, PHASES, radians(weight_deg))
