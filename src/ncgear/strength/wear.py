"""Slow wear of flanks: the depth of material that sliding under load takes off, by Archard's equation.

A place of a flank is pressed while the contact passes over it.  With the load w for each mm of width, the speed v of
sliding and the speed u at which the contact moves along the flank, the integral of pressure times sliding over that
time is w v / u for any course of the pressure, so that a meeting takes off

    depth = k w v / u

(A. Flodin, S. Andersson, Wear 207, 1997).  Coefficients k are known to the power of ten at best: they follow from
secondary sources and are rounded.  Worn flanks have less load where they are worn most.  This is left out: the result
holds for new flanks, which wear most.
"""

from __future__ import annotations

import numpy as np

from ncgear.errors import Unanswered
from ncgear.numerics.arrays import Array
from ncgear.strength.conditions import Conditions
from ncgear.strength.film import Pressed
from ncgear.strength.materials import Bronze, Choice, Entry, Ferrous, Plastic

Coefficients = dict[str, float]
"""Wear coefficients in mm3 for each N and m of sliding, by lubrication; with oil or grease for flanks without a film
between them."""

HARDENED: Coefficients = {"oil": 1e-9, "grease": 1e-9, "dry": 1.5e-5}
"""Hardened steel on metal: ground gears in transmission fluid 9.65e-10 (P. Bajpai, A. Kahraman, N. E. Anderson, Journal
of Tribology 126, 2004); dry tool steel on itself, K = 1.3e-4 over a hardness of 8.5 GPa (J. F. Archard, 1953)."""

SOFT: Coefficients = {"oil": 1e-8, "grease": 1e-8, "dry": 2e-4}
"""Steel and iron without hardening: with oil ten times the value of hardened steel, a guess between it and the 5e-7 of
Flodin and Andersson; dry Rabinowicz's K / 3 = 5e-4 of clean like metals, over 2.5 GPa."""

BRONZE: Coefficients = {"oil": 1e-7, "grease": 1e-7, "dry": 2e-4}
"""Bronze on steel: with oil a guess, ten times the value of soft steel; dry K / 3 = 1.7e-4 of partly compatible metals,
over 1 GPa (Rabinowicz)."""

ON_PLASTIC = 0.0
"""Metal on plastic, which takes off next to nothing."""

LUBRICATED_PLASTIC = 0.1
"""Share of its dry wear that a plastic has with oil or grease: a guess."""

PLASTICS = {"POM": 1e-6, "PA66": 3e-6, "PA66-dry": 3e-6, "PA66-GF30": 5e-6, "PLA-print": 1e-5, "PETG-print": 1e-5}
"""Dry plastics: rounded up from a maker's thrust washer tests (RTP: 0.3e-6 to 1.2e-6 of POM, 2.7e-6 of PA66, 4.6e-6
with glass fibre); prints by a guess."""


def coefficient_mm3_n_m(choice: Choice, mate: Choice, conditions: Conditions) -> float:
    """The wear coefficient of the flanks of a gear on those of its mate, where no film parts them."""
    if conditions.wear_coefficient_mm3_n_m is not None:
        return conditions.wear_coefficient_mm3_n_m
    return usual_mm3_n_m(choice.entry, mate.entry, conditions.lubrication)


def usual_mm3_n_m(entry: Entry, mate: Entry, lubrication: str) -> float:
    """As ``coefficient_mm3_n_m``, by material and lubrication."""
    match entry:
        case Plastic(name=name):
            return PLASTICS[name] * (1.0 if lubrication == "dry" else LUBRICATED_PLASTIC)
        case _ if isinstance(mate, Plastic):
            return ON_PLASTIC
        case Ferrous(group=group):
            return (HARDENED if group.hardened else SOFT)[lubrication]
        case Bronze():
            return BRONZE[lubrication]
    raise Unanswered(f"{entry} is of no known kind")


COMPOSITE = 1.77
"""Composite root mean square roughness of two flanks over their mean Ra: 1.25 sqrt(2)."""


def share_unparted(thickness: Array) -> Array:
    """The share of wear that a film leaves, any shape: 1 up to 0.5 composite roughnesses, in a line to 0 at 4.

    ``thickness`` is the specific film thickness lambda, in mean roughnesses Ra (M. Priest, C. M. Taylor, Wear 241,
    2000, as Bajpai and others take it for gears).
    """
    return np.asarray(np.clip((4.0 - thickness / COMPOSITE) / 3.5, 0.0, 1.0))


MOST_SLIDING = 10.0
"""Largest ratio of sliding to the way of the contact along a flank.  Where the contact reverses on an undercut flank
the formula has no limit; there wear spreads over the width of the contact."""


def depth_mm(pressed: Pressed, unparted: Array, coefficients_mm3_n_m: tuple[float, float]) -> Array:
    """Depth that a meeting takes off both flanks at n places, (2, n); ``unparted`` (n,) is the share without film."""
    sliding, rolling = pressed.sliding_m_s, np.abs(pressed.rolling_m_s).T
    slid = np.divide(sliding, rolling, out=np.full_like(rolling, np.inf), where=rolling > 0.0)
    slid = np.minimum(np.where(sliding > 0.0, slid, 0.0), MOST_SLIDING)
    return np.asarray(1e-3 * np.array(coefficients_mm3_n_m)[:, None] * unparted * pressed.line_n_mm * slid)


LIMIT_MODULES = 0.1
"""Depth in modules that flanks may lose: a tooth is then 6 % thinner at the pitch line, and a root worn so deep would
have 14 % more stress.  VDI 2736 allows this for plastics, and up to twice as much."""
