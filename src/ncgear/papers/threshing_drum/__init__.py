"""Z. Yu, Y. Li, X. Wang, Z. Tang, J. Lu: a threshing drum with a chain drive at its side."""

from __future__ import annotations

from ncgear.papers.entry import Given, Paper, counted, equations
from ncgear.papers.threshing_drum import chain, first_balancing

PAPER = Paper(
    "Threshing drum with a side chain drive",
    "Z. Yu, Y. Li, X. Wang, Z. Tang, J. Lu, Effects of Side Load Chains of a Combine Harvester on Unbalanced Dynamic "
    "Vibrations of Its Threshing Drum, 2021",
    promised=(*counted("Table", 6), *equations(*range(1, 14))),
    entries=(*first_balancing.ENTRIES, *chain.ENTRIES),
    given=(
        Given(("Table 1",), "instruments"),
        Given(equations("2", "8", "9"), "mass of a rotor along a line, balance of a rigid rotor, equation of torsion"),
        Given(
            ("section 3.2.1",),
            "weights of 161.3 g; wrap from 90 to 270 deg; phases of 105 deg for the tight and 270 deg for the slack "
            "side",
        ),
    ),
)
