"""C. Wei, L. Xu, J. Wang, Y. Li: the sieve and the return pan of a combine harvester."""

from __future__ import annotations

from ncgear.papers.entry import LeftOut, Paper, Reason, counted, equations, texts
from ncgear.papers.sieve_and_pan import formulas, sweeps

PAPER = Paper(
    "Sieve and return pan of a combine harvester",
    "C. Wei, L. Xu, J. Wang, Y. Li, Inertial force balance and ADAMS simulation of the oscillating sieve and return "
    "pan of a rice combine harvester, Int. J. Agric. & Biol. Eng. 11(1), 2018",
    promised=(*counted("Table", 3), *equations(*range(1, 17))),
    entries=(*formulas.ENTRIES, *sweeps.ENTRIES),
    left_out=(
        LeftOut(("section 2.2.2",), "cranks of 15 mm and 1.0 kg, centre at 12.3 mm; boards of 1045 mm and 23.7 kg, "
                "1378 mm and 90.4 kg; rollers of 0.26 kg; counterweights at 45 mm; 350 r/min", Reason.GIVEN,
                texts("15 1.0 12.3 350 1045 12.3 23.7 0.26 45 15 1.0 12.3 350 1378 448 90.4 0.26 45")),
        LeftOut(("section 2.2.1", "section 2.2.2"), "shares of the reciprocating mass, in parts", Reason.GIVEN,
                texts("1 3 1 2")),
        LeftOut(("section 2.2.3",), "phases of sieve and pan", Reason.GIVEN, texts("90 45 90 0")),
        LeftOut(("section 3.1",), "counterweights tried, time and steps of the simulation", Reason.GIVEN,
                texts("350 5.4 6.1 5.5 5.7 5.9 6.1 0.5 0.01")),
        LeftOut(("section 3.2",), "counterweights tried, time and steps of the simulation", Reason.GIVEN,
                texts("16.7 20.1 16.8 17.4 18.0 18.6 19.2 19.8 1.0 0.01")),
        LeftOut(("section 3.3",), "counterweights tried, phases, time and steps of the simulation", Reason.GIVEN,
                texts("45 13.5 14.0 14.5 15 15.5 16 16.6 1.0 0.01 18.0 0 45 90")),
        LeftOut(("Table 1", "Table 2", "Table 3"), "counterweights tried", Reason.GIVEN,
                (*sweeps.PAN_TABLE.mass, *sweeps.SIEVE_TABLE.mass, *sweeps.BOTH_TABLE.mass)),
        LeftOut(("Fig. 12", "Fig. 17", "Fig. 25"), "tracks and forces of the simulation, as curves", Reason.DRAWN),
        LeftOut(("section 3.1", "section 3.2", "section 3.3"),
                "tracks that are shorter with one counterweight than with another", Reason.VAGUE),
    ),
)  # fmt: skip
