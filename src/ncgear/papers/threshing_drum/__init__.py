"""Z. Yu, Y. Li, X. Wang, Z. Tang, J. Lu: a threshing drum with a chain drive at its side."""

from __future__ import annotations

from ncgear.papers.entry import LeftOut, Paper, Reason, counted, equations, texts
from ncgear.papers.threshing_drum import chain, first_balancing

PAPER = Paper(
    "Threshing drum with a side chain drive",
    "Z. Yu, Y. Li, X. Wang, Z. Tang, J. Lu, Effects of Side Load Chains of a Combine Harvester on Unbalanced Dynamic "
    "Vibrations of Its Threshing Drum, 2021",
    promised=(*counted("Table", 6), *equations(*range(1, 14))),
    entries=(*first_balancing.ENTRIES, *chain.RANGES, *first_balancing.OF_READINGS, *chain.PREDICTED, *chain.COMPARED),
    left_out=(
        LeftOut("section 2.1", "sizes of bench and drum, counterweight holes", Reason.GIVEN,
                texts("1390 974 1006 0 1000 240 612 6 60 10 5 50 8.5")),
        LeftOut("Table 1", "instruments", Reason.GIVEN, texts("10 5000 5 100 0.1 3.5 5.2 2 3000 2000 1 60000 5")),
        LeftOut("section 3.2, section 3.1", "speeds, and weights put on", Reason.GIVEN,
                texts("600 1000 700 107.7 90 142.45 120 58.8 240")),
        LeftOut("section 3.2", "readings before and with the trial weight", Reason.MEASURED,
                texts("1.234 159 0.562 204")),
        LeftOut("section 3.2.3", "weights of the spiral", Reason.GIVEN,
                texts("77.05 30 77.17 90 76.8 150 77.1 210 76.27 270 75.49 330 75.15 30 76.78 90 73.9 150 74.67 210")),
        *first_balancing.LEFT_OUT,
        *chain.LEFT_OUT,
        LeftOut("eq. 2, eq. 8, eq. 9", "mass of a rotor along a line, balance of a rigid rotor, equation of torsion",
                Reason.DEFINED),
        LeftOut("section 1", "share of vibration that comes from imbalance", Reason.ELSEWHERE, ("70",)),
        LeftOut("section 3.2.3, section 4", "phases of the unbalance, said to lie near those of the chain",
                Reason.VAGUE),
    ),
)  # fmt: skip
