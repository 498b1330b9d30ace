"""Mechanisms of every kind for tests, by their lengths and masses as ``ncgear`` and the oracle both take them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from ncgear.design.mechanisms import MECHANISMS
from ncgear.mechanisms.forces import Masses
from ncgear.mechanisms.mechanism import Mechanism
from oracles.linkages import LINKAGES, Linkage

GRAVITY_M_S2 = (3.1, -9.2)
CRANK = {"crank_kg": 6.0, "crank_center_mm": -20.0, "crank_inertia_kg_mm2": 9000.0, "driven_inertia_kg_mm2": 1500.0}
MASSES = {
    "crank_slider": {"slider_kg": 12.0, "rod_kg": 4.0, "rod_center_mm": 60.0, "rod_inertia_kg_mm2": 30000.0},
    "scotch_yoke": {"slider_kg": 15.0},
    "crank_rocker": {
        "rocker_kg": 7.0,
        "rocker_center_mm": 35.0,
        "rocker_inertia_kg_mm2": 22000.0,
        "coupler_kg": 3.0,
        "coupler_center_mm": 45.0,
        "coupler_inertia_kg_mm2": 4000.0,
    },
    "slotted_lever": {
        "slider_kg": 20.0,
        "block_kg": 1.5,
        "lever_kg": 9.0,
        "lever_center_mm": 140.0,
        "lever_inertia_kg_mm2": 300000.0,
    },
    "rack_pinion": {"slider_kg": 3.0},
}


@dataclass(frozen=True)
class Case:
    """One mechanism."""

    kind: str
    lengths: Mapping[str, float]
    near_its_end: bool = field(default=False, kw_only=True)
    """Whether it comes so close to not turning that numbers of it are large."""

    def __str__(self) -> str:
        return f"{self.kind} {' '.join(f'{length:g}' for length in self.lengths.values())}"

    @property
    def mechanism(self) -> Mechanism:
        """As ncgear has it."""
        return MECHANISMS[self.kind].load()(**self.lengths)

    @property
    def oracle(self) -> Linkage:
        """As plain geometry has it, with its masses."""
        masses = {**CRANK, **MASSES[self.kind]}
        return LINKAGES[self.kind](self.lengths, masses, complex(*GRAVITY_M_S2))

    @property
    def masses(self) -> Masses:
        """As ncgear has them."""
        made = self.mechanism.MASSES(**CRANK, **MASSES[self.kind])
        return replace(made, gravity_m_s2=GRAVITY_M_S2)


def rocker(crank: float, coupler: float, rocker: float, ground: float, side: int = 1, **more: bool) -> Case:
    lengths = {"crank_mm": crank, "coupler_mm": coupler, "rocker_mm": rocker, "ground_mm": ground, "side": side}
    return Case("crank_rocker", lengths, **more)


def lever(crank: float, pivot: float, length: float, **more: bool) -> Case:
    return Case("slotted_lever", {"crank_mm": crank, "pivot_mm": pivot, "lever_mm": length}, **more)


RETURNING = [
    Case("crank_slider", {"crank_mm": 50.0, "rod_mm": 150.0, "offset_mm": -30.0}),
    Case("scotch_yoke", {"crank_mm": 50.0}),
    rocker(40.0, 100.0, 80.0, 110.0),
    rocker(40.0, 100.0, 80.0, 110.0, -1),
    rocker(20.0, 30.0, 70.0, 75.0),
    rocker(40.0, 110.0, 60.0, 125.0, near_its_end=True),
    lever(60.0, 150.0, 300.0),
    lever(95.0, 100.0, 200.0, near_its_end=True),
]
"""Every kind with dead centres; a rocker whose crank pin passes the rocker's line, and ones next to a change point."""

CASES = [*RETURNING, Case("rack_pinion", {"radius_mm": 40.0})]
