"""I. Zarebski and T. Salacinski: gears of changing profile shift, of two pressure angles, and with concave sides."""

from __future__ import annotations

from functools import cache
from math import pi, radians, tan

import numpy as np

from ncgear.papers.entry import (  # fmt: skip
    Below,
    Computed,
    Entry,
    Finding,
    LeftOut,
    Paper,
    Reason,
    Relation,
    computed,
    counted,
    equations,
    from_readings,
    printed,
    texts,
)
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.curve_shapes import rounded_polygon
from ncgear.ratio.laws.pitch_curve import ClosedLaw, GivenCurve, ShapeSearch, closed_law
from ncgear.ratio.transmission import Lobes
from ncgear.teeth.shifts import thickness_mm

SIDES, TEETH, CORNER_MM, CENTER_DISTANCE_MM, MODULE_MM = 4, 32, 25.0, 150.0, 4.91
KEY = "side_mm"


@cache
def square_law(center_distance_mm: float | None, side_mm: float | None) -> ClosedLaw:
    """The rounded square and its mate: the side follows from the centre distance, or the distance from the side."""

    def search() -> ShapeSearch | None:
        slope = 2.0 * tan(pi / SIDES)
        return None if center_distance_mm is None else ShapeSearch(slope * CORNER_MM, slope * center_distance_mm, KEY)

    given = GivenCurve(
        lambda side: rounded_polygon(SIDES, side_mm or side, CORNER_MM, (0.0, 0.0), KEY), search(),
        drawn=True, driven=False, phase_rad=0.0, key=KEY,
    )  # fmt: skip
    return closed_law(given, Lobes(SIDES, SIDES), center_distance_mm)


@cache
def pair() -> PitchPair:
    """The pitch curves at the printed centre distance with the printed number of teeth."""
    return sized_pair(square_law(CENTER_DISTANCE_MM, None).transmission, TEETH, None, CENTER_DISTANCE_MM)


def _distance_of_the_module() -> Computed:
    """Centre distance at which the mate of the square closes; its sides and corners are 32 pitches of 4.91 mm."""
    side = (pi * MODULE_MM * TEETH - 2.0 * pi * CORNER_MM) / SIDES + 2.0 * CORNER_MM
    return computed(square_law(None, side).center_distance_mm)


def _thickness(module_text: str, *shifts: float, angles_deg: tuple[float, float] = (20.0, 20.0)) -> Computed:
    """Thickness on the pitch curve of teeth with profile shifts, from a module as printed."""
    one, other = map(radians, angles_deg)
    return from_readings(
        lambda module: tuple(thickness_mm(module, module * np.array(shifts), (one, other)).tolist()), module_text
    )


PAPER = Paper(
    "Gears of changing shift, angle and shape",
    "I. Zarebski, T. Salacinski, Designing of non-circular gears, The Archive of Mechanical Engineering 55(3), 2008",
    promised=(*counted("Table", 4), *equations(*range(1, 16))),
    entries=(
        Entry("eq. 4, eq. 6", "mate that closes over a lobe", Relation(), Finding.REPRODUCED,
              lambda: pair().transmission.closure_error_rad / (2.0 * pi)),
        Entry("eq. 15", "module from the length of the curve", Relation(), Finding.REPRODUCED,
              lambda: (*(pair().length_mm(gear) / (pi * TEETH * pair().size.module_mm) - 1.0 for gear in Gear),)),
        Entry("Table 1", "tooth thickness at the least and the greatest shift", printed("6.710 8.081 mm"),
              Finding.REPRODUCED, lambda: _thickness("4.71", -0.2, 0.2), of_printed=True),
        Entry("Table 3", "tooth thickness without shift", printed("7.396 mm"), Finding.REPRODUCED,
              lambda: _thickness("4.71", 0.0, angles_deg=(17.5, 22.5)), of_printed=True),
        Entry("Table 4", "tooth thickness of the square", printed("7.714 mm"), Finding.REPRODUCED,
              lambda: _thickness("4.91", 0.0), of_printed=True),
        Entry("Table 4", "module at the printed centre distance", printed("4.91 mm"), Finding.NOT_REPRODUCIBLE,
              lambda: pair().size.module_mm, "With straight sides, corners of 25 mm and 32 teeth, axes 150 mm apart "
              "make 4.923 mm."),
        Entry("section 9", "centre distance at the printed module", printed("150 mm"), Finding.REPRODUCED,
              _distance_of_the_module),
        Entry("section 9", "mate with concave sides", Below("0 < curvature of the dents"), Finding.REPRODUCED,
              lambda: (0.0, -pair().curvature_range[Gear.DRIVEN][0].value)),
    ),
    left_out=(
        LeftOut("section 9", "radius of the corners", Reason.GIVEN, texts("25")),
        LeftOut("Table 1", "module, teeth, pressure angle, shifts, height and clearance", Reason.GIVEN,
                texts("4.71 32 20 -0.2 0.2 1 0.25")),
        LeftOut("Table 2", "profile shifts of 32 teeth", Reason.GIVEN,
                texts("0 -0.1 -0.2 -0.1 0 0.1 0.2 0.1 0 0.1 0.2 0.1 0 -0.1 -0.2 -0.1 "
                      "0 -0.1 -0.2 -0.1 0 0.1 0.2 0.1 0 0.1 0.2 0.1 0 -0.1 -0.2 -0.1")),
        LeftOut("Table 3", "module, teeth, both pressure angles, shift, height and clearance", Reason.GIVEN,
                texts("4.71 32 17.5 22.5 0 1 0.25")),
        LeftOut("Table 4", "teeth, pressure angle, shift, height and clearance", Reason.GIVEN, texts("32 20 0 1 0.25")),
        LeftOut("eq. 5", "an example of a period of pi, without its curve", Reason.GIVEN),
        LeftOut("eq. 1, eq. 2, eq. 3", "ratio, sum of radii and rolling, which the first equations of the paper "
                "before are", Reason.DEFINED),
        LeftOut("eq. 7, eq. 8, eq. 9, eq. 10, eq. 11, eq. 12, eq. 13, eq. 14",
                "arcs of spirals that stand for a curve, and the rolling rack", Reason.DEFINED),
    ),
)  # fmt: skip
