"""Z. Tang, Y. Li, Y. Zhou, H. Zhang: the crank-slider of a baling machine on tracks."""

from __future__ import annotations

from ncgear.papers.entry import Given, Paper, counted, equations
from ncgear.papers.track_chassis import frequencies, slider, vibration

PAPER = Paper(
    "Crank-slider on a track chassis",
    "Z. Tang, Y. Li, Y. Zhou, H. Zhang, Inertial Vibration Characteristics of Track Chassis Caused by Reciprocating "
    "Motion of Crank Slider, Shock and Vibration, 2019",
    promised=(*counted("Table", 7), *equations(*range(1, 21))),
    entries=(
        *slider.MOTION,
        *frequencies.SHAFTS_AND_ENGINE,
        *slider.COUNTERWEIGHTS,
        *frequencies.NATURAL,
        *frequencies.SPECTRUM,
        *vibration.ENTRIES,
    ),
    given=(
        Given(("Table 1",), "speeds of the shafts, rollers, teeth"),
        Given(("Table 2",), "instruments"),
        Given(equations("14", "15"), "root mean square of a record, and of three directions together"),
        Given(
            ("section 3.1", "section 3.5"),
            "65 kg; crank 265, rod 560, rod extended by 200 mm; 96.5 r/min; levers 370, 370, 1000, 470 mm; 8 deg; "
            "500 kg",
        ),
    ),
)
