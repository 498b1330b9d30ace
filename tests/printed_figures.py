"""What the six publications print, by table and section: taken down from their texts, not from the ledger.

Numbers stand as printed.  Of a table every number of its body is here, as often as it is printed; of a section each
number once.  Left out are numbers of equations, figures, pages and references, of points, holes and parts, and the
factors within equations.  ``CLAIMS`` are what the texts say without a number of its own and what can be computed.
Figures of an abstract and of conclusions are those of the sections, or differ from them; they may be judged anywhere.
"""

from __future__ import annotations

BALER, CHASSIS, DRUM, SIEVE, LINES, SHAPED = (
    "Non-circular gears of a baler",
    "Crank-slider on a track chassis",
    "Threshing drum with a side chain drive",
    "Sieve and return pan of a combine harvester",
    "Gears by their pitch lines",
    "Gears of changing shift, angle and shape",
)

ANYWHERE = "abstract and conclusions"

NUMBERS = {
    BALER: {
        ANYWHERE: "66.4",
        "section 1": "70 30 28.6",
        "Table 1": "2 5 7 10 13 10 380 960 200 1600 1100 -1500 760 25 3 0",
        "section 4.2": "201 0.29 100 2.2 0.1 0.05 0.08 20",
        "section 4.3.1": "2100 820 760 1600 1100 234 180 30",
        "eq. 4.2": "2.498e-7 -1.575e-4 1.846e-2 3.447 -131.2779",
        "section 4.3.2": "6300 18750 66.4",
        "section 4.3.3": "45000 1500",
    },
    CHASSIS: {
        ANYWHERE: "261.82 4.62 17.26 29.82 63.85 83.73 141.58 3.77 6 265 11.3",
        "section 2.3": "40 80",
        "Table 1": """
            2400 40 15 600
            1354 22.57 14 315.98 32 722.24
            96.5 1.61 13 20.93 32 51.52
            96.5 1.61 13 20.93 32 51.52
            193 3.22 13 41.86 21 67.62
            391.7 6.53 15 97.95 73 476.69
            569.8 9.50 13 123.5 30 285
            341.8 5.70 13 74.1 21 119.7
            226 3.77 14 52.78
            141 2.35 13 30.55 58 136.3""",
        "section 2.4": "877 420 507 210 0.33 7850 235 4 139238 37703",
        "Table 2": "100 0.3 6 50 5 32 16 100 20 20 0.5",
        "section 2.5": "30 2 781.25 1 0 5 512 200 50 4 22 88 13",
        "section 2.6": "5 10 2 8192 16",
        "section 3.1": "65 560 200 182 247 261.82",
        "section 3.2": "4.62 17.26 29.82 63.85 83.73 141.58",
        "section 3.3": "1 11.3 0.8",
        "Table 3": "4.62 17.26 29.82 63.85 83.73 141.58",
        "Table 4": """
            4.62 4.39 5.2
            17.26 18.29 5.9
            29.82 29.41 1.4
            63.85 63.48 0.6
            83.73 82.03 2
            141.58 125.49 11.3""",
        "section 3.4": "1.46 39.06 3.61 2.21 74.22 9.26 87.89 17.53 19.40 335.94 0.299 0.234 0.460 48.83",
        "Table 5": """
            87.89 9.26 87.89 17.53 335.94 19.40
            332.03 1.11 5.86 1.59 13.67 1.49
            417.97 0.51 27.34 2.10 27.34 1.20
            160.16 0.68 80.08 2.83 80.08 0.70
            76.17 0.13 80.08 0.90 80.08 0.41
            74.22 0.15 78.13 0.58 156.25 0.41
            80.78 0.60 80.08 0.94 525.39 1.67
            80.08 0.48 80.08 0.84 748.05 0.86
            537.1 0.57 80.08 0.53 80.08 1.18""",
        "section 3.5": "6 4 5 65 265 560 370 1000 8 96.5 10.10 5 500 260 0.56 7.40",
        "Table 6": """
            4.9 -3.86 8.76 4.38 1.04
            1.85 -2.77 4.62 2.31 -0.92
            1.43 -2.42 3.85 1.925 -0.99
            1.34 -2.12 3.46 1.73 -0.78
            0.97 -1.4 2.37 1.185 -0.43
            0.85 -1.2 2.05 1.025 -0.35
            1.04 -1.42 2.46 1.23 -0.38
            1.77 -2.81 4.58 2.29 -1.04
            2.14 -2.51 4.65 2.325 -0.37
            3.27 -3.7 6.97 3.485 -0.43
            4.81 -4.67 9.48 4.74 0.14
            4.78 -4.97 9.75 4.875 -0.19
            5.54 -5.74 11.28 5.64 -0.2
            6.62 -6.69 13.31 6.655 -0.07
            6.4 -6.32 12.72 6.36 0.08
            7.4 -7.56 14.96 7.48 -0.16""",
        "Table 7": """
            0.09 -0.07 0.16 0.08 0.02
            0.05 -0.07 0.13 0.06 -0.02
            0.07 -0.05 0.12 0.06 0.02
            0.11 -0.09 0.20 0.10 0.02
            0.07 -0.07 0.14 0.07 0.00
            0.07 -0.07 0.14 0.07 0.01
            0.06 -0.08 0.13 0.07 -0.02
            0.25 -0.18 0.43 0.21 0.07
            0.42 -0.47 0.88 0.44 -0.05
            0.44 -0.47 0.91 0.46 -0.03
            0.18 -0.17 0.35 0.17 0.00
            0.56 -0.55 1.11 0.56 0.00
            0.23 -0.30 0.53 0.27 -0.08
            0.14 -0.21 0.35 0.17 -0.07
            0.09 -0.11 0.20 0.10 -0.03
            0.12 -0.17 0.30 0.15 -0.05""",
    },
    DRUM: {
        ANYWHERE: "32.64 4.6 1.24 270 1.4 120 1.587 286 0.856 0.674 161 58.8 240 108 105 2.04 2.58",
        "section 1": "70",
        "section 2.1": "1390 974 1006 0 1000 240 612 6 60 10 5 50 8.5",
        "Table 1": "10 5000 5 100 0.1 3.5 5.2 2 3000 2000 1 60000 5",
        "section 3.1": "143.76 8625.60 600 1000",
        "section 3.2": """
            600 1000 700 1.234 159 82.03 164 107.7 90 0.562 204 143.4 115 142.45 120 0.37 161 70 0.4 58.8 240 108""",
        "Table 2": "143.76 8625.60 143.77 8626.20 197.05 11823 293.1 17586 298.33 17899.80 198.41 11904.60",
        "section 3.2.1": """
            90 270 161.3 700 0.426 275 0.502 135 0.382 124 0.513 173 0.483 209 0.465 256 0.074 0.214 105 2.04 2.58""",
        "Table 3": """
            0.532 222 0.431 146 0.220 135 0.383 181 0.631 186 0.618 214
            0.426 275 0.502 135 0.382 124 0.513 173 0.483 209 0.465 256
            0.486 319 0.735 127 0.538 102 0.972 161 0.661 219 0.622 268
            1.160 27 1.869 121 2.028 114 1.487 159 1.271 180 0.861 341
            1.716 35 2.662 112 2.868 123 2.725 149 1.863 163 1.094 30""",
        "section 3.2.2": "161.3",
        "Table 4": """
            0.196 0.461 0.586 1.665 2.577 0.545 0.903 1.98 1.476 2.489 0.379 0.590 0.935 2.274 2.403
            0.179 0.492 0.632 1.952 2.399 0.619 1.222 1.844 3.030 4.337 0.334 0.446 1.112 1.467 2.915
            0.177 0.374 0.784 1.905 2.207 0.407 1.518 2.356 3.969 4.911 0.415 0.481 0.733 1.744 2.565
            0.129 0.631 0.764 1.391 2.32 0.416 1.728 1.825 3.782 4.367 0.302 0.350 0.647 1.353 2.073
            0.089 0.517 0.739 1.874 2.232 0.782 1.478 2.704 4.157 4.760 0.439 0.383 0.673 1.739 1.909
            0.232 0.657 0.954 2.011 4.452 0.601 1.314 2.212 3.225 3.992 0.278 0.317 0.501 1.182 2.129
            0.190 0.697 1.166 2.533 3.459 0.287 1.33 2.478 3.886 7.084 0.296 0.307 0.490 1.530 1.965
            0.142 0.656 0.981 3.109 3.416 0.477 1.543 1.778 3.475 4.615 0.233 0.232 0.813 1.301 1.915
            0.155 0.450 1.067 2.351 3.753 0.467 1.807 2.343 3.527 4.456 0.263 0.291 0.545 1.149 2.183
            0.158 0.639 1.218 2.907 3.360 0.366 0.757 2.814 3.419 4.980 0.195 0.262 0.500 1.540 1.983""",
        "section 3.2.3": "77.05 77.17 76.8 77.1 76.27 75.49 75.15 76.78 73.9 74.67",
        "Table 5": "0.216 163 0.234 20 3.378 59 4.122 67 5.624 102",
        "section 3.3": """
            700 500 161.3 2.13 103 2.48 274 270 1.24 152.3 90 1.97 106 2.79 120 1.4 165.8 300""",
        "eq. 11": "-0.434 0.185 -2.08 2.543",
        "eq. 13": "-0.528 0 -1.9 2.794",
        "Table 6": """
            1.587 286 1.264 148
            1.487 283 0.943 150
            1.24 270 1.4 120
            21.87 5.6 9.7 18.9
            16.6 4.6 32.64 20
            0.731 329 0.59 157
            0.682 335 0.453 152""",
    },
    SIEVE: {
        ANYWHERE: "15.5 90 14.0 5.4 6.1 16.0 20.1 5.9 18.0",
        "section 2.2": "100",
        "section 2.2.1": "0.01 1 3 2",
        "section 2.2.2": """
            15 1.0 12.3 350 1045 23.7 0.26 11.1 0.8 12.6 11.9 12.86 45 6.1 5.4 1378 448 90.4 29.5 61.26 16.7 20.1""",
        "section 2.2.3": "90 45 0 0.72 0.86 13.9 16.5 0.65 0.71 11.4 13.7 0.74 0.77 13.2 15.8",
        "section 3.1": """
            2100 350 5.4 6.1 5.5 5.7 5.9 0.5 0.01 0.17 14 1.1 21.9 9 11 11.1 0.2 0.6 1.7 850 1408 586 275""",
        "Table 1": """
            0 159 968 699 737 809
            5.5 524 681 612 614 157
            5.7 535 676 611 613 141
            5.9 546 678 610 611 132
            6.1 542 682 608 609 140""",
        "section 3.2": "16.7 20.1 16.8 17.4 18.0 18.6 19.2 19.8 1.0 0.01",
        "Table 2": """
            0 350 2587 1811 1995 2237
            16.8 941 2044 1455 1495 1103
            17.4 911 2046 1448 1491 1132
            18.0 881 2044 1442 1487 1163
            18.6 851 2051 1435 1486 1200
            19.2 822 2059 1429 1484 1237
            19.8 792 2070 1424 1484 1278""",
        "section 3.3": """
            45 13.9 16.5 13.5 14.0 14.5 15 15.5 16 16.6 1.0 0.01 18.0 0 90 2518 1611 1604 613 1828 697""",
        "Table 3": """
            14.0 1580 2510 1941 1965 930
            14.5 1593 2511 1937 1962 918
            15 1604 2513 1934 1959 909
            15.5 1612 2518 1930 1957 906
            16 1592 2523 1927 1956 931
            16.5 1568 2530 1925 1954 962""",
    },
    LINES: {
        ANYWHERE: "",
        "Fig. 2": "1 1 1 2 1 3 1 1 1 1 1 1 2",
        "Fig. 4": "0 17.20 4 0 16.73 0 -4 16.91 4 -4 16.44",
        "Fig. 6": "0 60.0 90 64.5 180 68.0 270 64.5",
        "Fig. 14": "1.6123 20 0.61 -0.05 1.6123 23 0.90 0.00",
    },
    SHAPED: {
        ANYWHERE: "",
        "section 9": "150 25",
        "Table 1": "4.71 32 20 -0.2 0.2 1 0.25 6.710 8.081",
        "Table 2": """
            0 -0.1 -0.2 -0.1 0 0.1 0.2 0.1
            0 0.1 0.2 0.1 0 -0.1 -0.2 -0.1
            0 -0.1 -0.2 -0.1 0 0.1 0.2 0.1
            0 0.1 0.2 0.1 0 -0.1 -0.2 -0.1""",
        "Table 3": "4.71 32 17.5 22.5 0 1 0.25 7.396",
        "Table 4": "4.91 32 20 0 1 0.25 7.714",
    },
}

CLAIMS = {
    BALER: {
        "Fig. 8": {"no interference of teeth": "teeth mesh without interference"},
        "section 4.2": {"the acceleration comes back to zero": "acceleration where the return ends"},
        "section 4.3.1": {
            "less fluctuation of the speed": "less fluctuation: largest speed by speed of pressing, in the working "
            "stroke",
            "and over the cycle": "less fluctuation: largest speed of the whole cycle by speed of pressing",
            "lower largest speed, higher pressing speed": "lower largest speed and higher speed of pressing, at equal "
            "driving speed",
        },
        "section 4.3.2": {"power is saved without loss of productivity": "power saved at equal productivity"},
        "section 4.3.3": {"an order of magnitude": "acceleration below that of the earlier mechanism, by its tenth"},
    },
    CHASSIS: {
        "section 2.6": {
            "sampling at least at twice": "sampling at least twice as fast as the highest frequency",
            "sampling at 5 to 10 times": "sampling at least five times as fast as the highest frequency",
        },
        "section 3.3": {"no other excitation meets a mode": "other excitations as near to a natural frequency as that"},
        "section 3.4": {
            "39.06 Hz is half of combustion": "half the frequency of combustion",
            "74.22 Hz is close to combustion": "frequency of combustion, said to be close",
            "87.89 Hz is a multiple of 22.57 Hz": "4th multiple of the drive shaft's frequency",
            "335.94 Hz is a multiple of 22.57 Hz": "15th multiple of the drive shaft's frequency",
            "48.83 Hz is half of 97.95 Hz": "half the frequency of the rollers of the gear transmission",
            "points 5 to 7 have 80 Hz and its double": "frequencies at points 5 to 7 that are 80 or 160 Hz",
            "the front has about 80 Hz": "frequencies at the front of the chassis that are about 80 Hz",
            "point 1 is the strongest": "largest amplitudes along x, y and z, and their points",
        },
        "section 3.5": {
            "much larger at the ends": "both ends move more than the points 4 to 6",
            "point 6 moves least": "point that moves least",
            "points 4 to 6 move least": "points that move least",
            "7.40 mm was the largest": "largest amplitude without the weight",
            "0.56 mm is the largest": "largest amplitude with the weight",
            "obviously decreased": "less movement with the weight than without, at every point",
            "grounded at 1 to 7": "points 1 to 7 move less than points 8 to 14 with the weight",
        },
        "section 4": {
            "completely eliminated": "vibration left at the point that moves most",
            "points 4 to 6 move least": "points that move least",
        },
    },
    DRUM: {
        "section 3.1": {"critical speed above working speeds": "working speeds below the first critical speed"},
        "section 3.2": {
            "between 161 and 240 deg": "least phase to expect once 58.8 g at 240 deg are added",
        },
        "section 3.2.2": {
            "the higher the speed, the greater": "amplitude grows with the speed, from each speed to the next",
            "holes 6 to 10 increase": "weights in holes 6 to 10 show more than in holes 1 to 5, at 900 and 1000 r/min",
            "little effect below 800 r/min": "hole matters less below 800 r/min than above: largest by least amplitude",
        },
        "section 3.2.3": {
            "much larger than a single mass": "spiral of weights shows more than any single weight",
            "rapid increase at 800 r/min": "amplitude of the spiral grows tenfold from 700 to 800 r/min",
        },
        "section 4": {
            "foretold are smaller than measured": "amplitudes foretold that are not below the measured ones",
            "largest and least error": "largest and least error of the table",
        },
    },
    SIEVE: {
        "section 2.2.3": {"90 deg is the best": "best phase of the pan"},
        "section 3.1": {
            "mean, r.m.s., peak to peak decrease": "mean, r.m.s. and peak to peak fall with every counterweight",
            "850 N decreases": "peak to peak along the slider's line falls with counterweights",
            "5.9 kg is the best": "pan's best counterweight",
        },
        "section 3.2": {
            "the force decreases": "mean, r.m.s. and peak to peak fall with every counterweight",
            "18.0 kg is the best": "sieve's best counterweight",
        },
        "section 3.3": {
            "15.5 kg is the best": "best counterweight for both at 45 deg",
            "seven masses are tried": "counterweights tried for both",
            "least force at 90 deg": "largest and least force are less at 90 deg than at 0 deg and at 45 deg",
            "less counterweight than for one": "less counterweight for both together than for the sieve alone",
        },
    },
    LINES: {},
    SHAPED: {"section 9": {"the mate has concave segments": "mate with concave sides"}},
}
