"""J. Wang, C. Wang, L. Miao: the non-circular gears of a baler."""

from __future__ import annotations

from ncgear.papers.entry import LeftOut, Paper, Reason, counted, equations, texts
from ncgear.papers.gear_baler import simulation, synthesis

_EQUATIONS = [*(f"2.{k}" for k in range(1, 13)), *(f"3.{k}" for k in range(1, 13)), "4.1", "4.2"]

PAPER = Paper(
    "Non-circular gears of a baler",
    "J. Wang, C. Wang, L. Miao, Design of a Non-Circular Gear-Crank Slider Baler Mechanism Considering Slider "
    "Acceleration, 2024",
    promised=("Table 1", *counted("Fig.", 14), *equations(*_EQUATIONS)),
    entries=(*synthesis.ENTRIES, *simulation.ENTRIES),
    left_out=(
        LeftOut("Fig. 1, Fig. 2, Fig. 3, Fig. 5", "the principle and the quantities", Reason.DRAWN),
        LeftOut("Fig. 6, Fig. 7", "the pitch curves (`ncgear build designs/baler.yaml` draws them)", Reason.DRAWN),
        LeftOut("Table 1", "angles in parts of pi, lengths, speeds, a1, teeth, module, e", Reason.GIVEN,
                texts("2 5 7 10 13 10 380 960 200 1600 1100 -1500 760 25 3 0")),
        LeftOut("eq. 4.2", "resistance", Reason.GIVEN, texts("2.498e-7 -1.575e-4 1.846e-2 3.447 -131.2779")),
        LeftOut("section 4.2", "contact of the simulation: 201 GPa, 0.29, 100 N s/mm, exponent 2.2, 0.1 mm, friction "
                "0.05 and 0.08, 20 r/min", Reason.GIVEN, texts("201 0.29 100 2.2 0.1 0.05 0.08 20")),
        LeftOut("section 1", "cost of transport, 70 % less for baled hay", Reason.ELSEWHERE, ("70",)),
        LeftOut("section 4.1, section 4.2", "curves that match those wished, but for differences that impacts and "
                "gaps are said to make", Reason.VAGUE),
        LeftOut("section 5", "a baling time as short as one likes, in theory", Reason.VAGUE),
    ),
)  # fmt: skip
