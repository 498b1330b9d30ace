"""Z. Tang, Y. Li, Y. Zhou, H. Zhang: the crank-slider of a baling machine on tracks."""

from __future__ import annotations

from ncgear.papers.entry import LeftOut, Paper, Reason, counted, equations, texts
from ncgear.papers.track_chassis import measurements, slider

PAPER = Paper(
    "Crank-slider on a track chassis",
    "Z. Tang, Y. Li, Y. Zhou, H. Zhang, Inertial Vibration Characteristics of Track Chassis Caused by Reciprocating "
    "Motion of Crank Slider, Shock and Vibration, 2019",
    promised=(*counted("Table", 7), *equations(*range(1, 21))),
    entries=(
        *slider.MOTION,
        *slider.SHAFTS_AND_ENGINE,
        *slider.COUNTERWEIGHTS,
        *slider.NATURAL,
        *measurements.SETTINGS,
        *measurements.FOUND,
        *measurements.MOVEMENT,
    ),
    left_out=(
        LeftOut("Table 1", "speeds of the shafts, rollers, teeth", Reason.GIVEN,
                texts("2400 15 1354 14 32 96.5 13 32 96.5 13 32 193 13 21 391.7 15 73 569.8 13 30 341.8 13 21 "
                      "226 14 141 13 58")),
        LeftOut("section 2.4", "the piston's size and steel, and its mesh for finite elements", Reason.GIVEN,
                texts("877 420 507 210 0.33 7850 235 4 4 139238 37703")),
        LeftOut("Table 2", "instruments", Reason.GIVEN, texts("100 0.3 6 50 5 32 16 100 20 20 0.5")),
        LeftOut("section 2.5", "settings of the measurement", Reason.GIVEN, texts("30 2 1 0 5 512 50 4 22 2 200 1")),
        LeftOut("section 2.6", "settings of the measurement, places of the points", Reason.GIVEN,
                texts("5 10 2 8192 16 10")),
        LeftOut("section 3.1", "slider, crank, rod and its extension", Reason.GIVEN, texts("65 560 200")),
        LeftOut("section 3.5", "slider, linkage, levers, tilt, speed, dead weight", Reason.GIVEN,
                texts("65 265 560 370 1000 8 96.5 500")),
        LeftOut("eq. 14, eq. 15", "root mean square of a record and of three directions", Reason.DEFINED),
        LeftOut("Table 5", "frequencies and amplitudes at nine points", Reason.MEASURED,
                tuple(text for frequencies_hz, amplitudes in (measurements.X, measurements.Y, measurements.Z)
                      for text in (*frequencies_hz, *amplitudes))),
        LeftOut("section 3.4", "largest amplitudes and their frequencies with the engine alone", Reason.MEASURED,
                texts("1.46 39.06 3.61 39.06 2.21 74.22")),
        *(
            LeftOut(place, "amplitudes up and down at sixteen points", Reason.MEASURED, (*rows.up, *rows.down))
            for place, rows in (("Table 6", measurements.WITHOUT), ("Table 7", measurements.WITH))
        ),
        LeftOut("section 3.4", "accelerations of another baler's frame", Reason.ELSEWHERE, texts("0.299 0.234 0.460")),
        LeftOut("section 3.3, Fig. 13", "criterion of the shapes' likeness, close to 1", Reason.VAGUE, ("1",)),
        LeftOut("section 3.5", "points 4 to 6 that never leave the ground", Reason.VAGUE),
    ),
)  # fmt: skip
