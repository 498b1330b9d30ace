"""J. Wang, C. Wang, L. Miao: the non-circular gears of a baler."""

from __future__ import annotations

from ncgear.papers.entry import Given, Paper, counted, equations
from ncgear.papers.gear_baler import gears, motion
from ncgear.papers.gear_baler.comparison import ACCELERATION, POWER

EQUATIONS = [*(f"2.{k}" for k in range(1, 13)), *(f"3.{k}" for k in range(1, 13)), "4.1", "4.2"]

GIVEN = (
    Given(("Fig. 1", "Fig. 2", "Fig. 3", "Fig. 5"), "drawings of the principle and of the quantities"),
    Given(("Table 1",), "angles, lengths, speeds, a1, teeth, module, e: taken as printed for everything above"),
    Given(
        ("Fig. 6", "Fig. 7"),
        "pitch curves without a number; ncgear draws them (`ncgear build designs/baler.yaml`)",
    ),
    Given(
        ("section 4.2",),
        "contact of the simulation: 201 GPa, 0.29, 100 N s/mm, exponent 2.2, 0.1 mm, friction 0.05 and 0.08, 20 r/min",
    ),
)

PAPER = Paper(
    "Non-circular gears of a baler",
    "J. Wang, C. Wang, L. Miao, Design of a Non-Circular Gear-Crank Slider Baler Mechanism Considering Slider "
    "Acceleration, 2024",
    ("Table 1", *counted("Fig.", 14), *equations(*EQUATIONS)),
    (*motion.ENTRIES, *gears.ENTRIES, *motion.SPEED_ENTRIES, *POWER, *ACCELERATION),
    GIVEN,
)
