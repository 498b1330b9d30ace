"""C. Wei, L. Xu, J. Wang, Y. Li: the sieve and the return pan of a combine harvester."""

from __future__ import annotations

from ncgear.papers.entry import Given, Paper, counted, equations
from ncgear.papers.sieve_and_pan import formulas, sweeps

PAPER = Paper(
    "Sieve and return pan of a combine harvester",
    "C. Wei, L. Xu, J. Wang, Y. Li, Inertial force balance and ADAMS simulation of the oscillating sieve and return "
    "pan of a rice combine harvester, Int. J. Agric. & Biol. Eng. 11(1), 2018",
    promised=(*counted("Table", 3), *equations(*range(1, 17))),
    entries=(*formulas.ENTRIES, *sweeps.ENTRIES),
    given=(
        Given(
            ("section 2.2.2",),
            "cranks of 15 mm and 1.0 kg, centre at 12.3 mm; boards of 1045 mm and 23.7 kg, 1378 mm and 90.4 kg; "
            "rollers of 0.26 kg; counterweights at 45 mm; 350 r/min; shares of 1/3 to 1/2",
        ),
        Given(("Fig. 12", "Fig. 17", "Fig. 25"), "tracks and forces of the simulation, as curves"),
    ),
)
