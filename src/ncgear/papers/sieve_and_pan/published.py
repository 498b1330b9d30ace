"""What the paper gives of the oscillating sieve and of the return pan, and the two mechanisms that this makes."""

from __future__ import annotations

from ncgear.balance.mechanism import DrivenCrank
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.masses import RodMasses
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes

SPEED_RPM = 350.0
SPEED_RAD_S = SPEED_RPM * RAD_S_PER_RPM
CRANK_MM, ARM_MM = 15.0, 45.0
CRANK_KG, CRANK_CENTER_MM, ROLLER_KG = 1.0, 12.3, 0.26
USUAL_SHARES = (1.0 / 3.0, 1.0 / 2.0)
"""Least and largest share of the reciprocating mass that a counterweight usually balances."""

PAN_LINKAGE = CrankSlider(CRANK_MM, 1045.0)
PAN_BOARD_KG, PAN_BOARD_PRINTED_MM = 23.7, 12.3
PAN_PRINTED = ("11.9", "12.86")
"""Masses of the pan in kg at the pin and at the roller, as printed."""

SIEVE_LINKAGE = CrankSlider(CRANK_MM, 1378.0)
SIEVE_BOARD_KG, SIEVE_BOARD_FROM_ROLLER_MM = 90.4, 448.0
SIEVE_PRINTED = ("29.5", "61.26")
"""Masses of the sieve in kg at the pin and at the roller, as printed."""

PAN_BOARD_FITTING_MM = PAN_LINKAGE.rod_mm * 12.6 / PAN_BOARD_KG
"""Distance from the pin at which the printed masses of the board at pin and roller put its centre."""


def mechanism(linkage: CrankSlider, board_kg: float, center_mm: float) -> DrivenCrank:
    """Crank, board and roller, driven evenly at the printed speed; the board's own inertia is not given: left out."""
    masses = RodMasses(
        slider_kg=ROLLER_KG,
        rod_kg=board_kg,
        rod_center_mm=center_mm,
        crank_kg=CRANK_KG,
        crank_center_mm=CRANK_CENTER_MM,
    )
    return DrivenCrank(linkage, uniform_law(Lobes()), SPEED_RAD_S, masses)


PAN = mechanism(PAN_LINKAGE, PAN_BOARD_KG, PAN_BOARD_FITTING_MM)
SIEVE = mechanism(SIEVE_LINKAGE, SIEVE_BOARD_KG, SIEVE_LINKAGE.rod_mm - SIEVE_BOARD_FROM_ROLLER_MM)
