"""A. Pogacnik: gears by their pitch lines, and ellipses that turn about a point beside their centre."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.numerics.plane import as_complex
from ncgear.numerics.quadrature import gauss_points
from ncgear.papers.entry import (  # fmt: skip
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
    printed,
    texts,
)
from ncgear.pitch.moving_axes import MovingAxes, even_distances
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.curve_shapes import ellipse
from ncgear.ratio.laws.pitch_curve import ClosedLaw, GivenCurve, ShapeSearch, closed_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes

CENTER_DISTANCE_MM, SEMI_MAJOR_MM = 40.0, 23.0
"""Read off figure 4, whose curves are drawn to scale; the text gives neither length."""

READ_OFF = "Centre distance 40 mm and semi-major axis 23 mm are read off the figure; the text gives neither."

KEY = "semi_minor_mm"
ANGLES = np.linspace(0.1, 6.1, 25)


@cache
def ellipse_law(x_mm: float, y_mm: float) -> ClosedLaw:
    """The law of an ellipse that turns about a point; its semi-minor axis is chosen so that the mate closes."""

    def search() -> ShapeSearch:
        # At this semi-minor axis the ellipse passes through its axis of rotation.
        least = abs(y_mm) / (1.0 - (x_mm / SEMI_MAJOR_MM) ** 2) ** 0.5
        return ShapeSearch(max(1.01 * least, 1e-3 * SEMI_MAJOR_MM), CENTER_DISTANCE_MM, KEY)

    given = GivenCurve(
        lambda minor: ellipse(SEMI_MAJOR_MM, minor, (x_mm, y_mm), KEY), search(),
        drawn=True, driven=False, phase_rad=0.0, key=KEY,
    )  # fmt: skip
    return closed_law(given, Lobes(), CENTER_DISTANCE_MM)


@cache
def _pair() -> PitchPair:
    return sized_pair(ellipse_law(4.0, -4.0).transmission, 47, None, CENTER_DISTANCE_MM)


def _along(residual: Callable[[Array, Array, Array], Array]) -> Computed:
    """A residual of both pitch radii in mm, the driving gear's first, and of dphi2/dphi1, at points of both curves."""
    driving, driven = (np.linalg.norm(_pair().of(gear).at_angle(ANGLES).position, axis=-1) for gear in Gear)
    return computed(*residual(driving, driven, _pair().transmission.driven_angle(ANGLES, 1).derivative(1)))


def _integral() -> Computed:
    """Eqs.  5 and 6: the driven angle at 2 rad as the integral of the inverse ratio, by quadrature."""
    law, (points, weights) = _pair().transmission, gauss_points(np.linspace(0.0, 2.0, 9), 20)
    driving = np.linalg.norm(_pair().driving.at_angle(points).position, axis=-1)
    driven = float(law.driven_angle(np.array([2.0])).value[0])
    slope = law.driven_angle(points, 1).derivative(1)
    return computed(
        float(driving / (CENTER_DISTANCE_MM - driving) @ weights) / driven - 1.0, float(slope @ weights) / driven - 1.0
    )


def _semi_minor(x_mm: float, y_mm: float) -> Computed:
    return computed(ellipse_law(x_mm, y_mm).value)


def _moving_distances() -> Computed:
    """Distances of the axes at which both curves touch while the gears turn evenly, at the angles of figure 6."""
    axes = MovingAxes(uniform_law(Lobes()), even_distances(np.array([60.0, 64.5, 68.0, 64.5]), 1))
    phi: Array = np.arange(4.0) * np.pi / 2.0
    driving, driven = (as_complex(axes.curve(gear).at_angle(phi).position) for gear in Gear)
    return computed(*(driving * np.exp(1j * phi) - driven * np.exp(-1j * phi)).real.tolist())


PAPER = Paper(
    "Gears by their pitch lines",
    "A. Pogacnik, Non-circular gears, KISSsoft AG, 2022",
    promised=(*counted("Fig.", 16), *equations(*range(1, 10))),
    entries=(
        Entry("eq. 1", "ratio from both radii", Relation(), Finding.REPRODUCED,
              lambda: _along(lambda r1, r2, slope: 1.0 / slope * r1 / r2 - 1.0)),
        Entry("eq. 2", "radii that make the centre distance", Relation(), Finding.REPRODUCED,
              lambda: _along(lambda r1, r2, slope: (r1 + r2) / CENTER_DISTANCE_MM - 1.0)),
        Entry("eq. 3", "ratio from one radius", Relation(), Finding.REPRODUCED,
              lambda: _along(lambda r1, r2, slope: (CENTER_DISTANCE_MM - r1) / r1 * slope - 1.0)),
        Entry("eq. 4", "curves that roll on each other", Relation(), Finding.REPRODUCED,
              lambda: _along(lambda r1, r2, slope: r1 / (r2 * slope) - 1.0)),
        Entry("eq. 5, eq. 6", "driven angle as an integral", Relation(), Finding.REPRODUCED, _integral),
        Entry("eq. 7", "period of the ratio and of both gears", Relation(), Finding.UNDER_READING,
              lambda: _pair().transmission.closure_error_rad / (2.0 * np.pi),
              "The number 7 is printed twice; this is the one of section 2."),
        Entry("Fig. 4", "semi-minor axis, turning about the centre", printed("17.20 mm"), Finding.NOT_REPRODUCIBLE,
              lambda: _semi_minor(0.0, 0.0), f"{READ_OFF} 17.2067 is printed cut off."),
        Entry("Fig. 4", "semi-minor axis, axis at x = 4", printed("16.73 mm"), Finding.UNDER_READING,
              lambda: _semi_minor(4.0, 0.0), READ_OFF),
        Entry("Fig. 4", "semi-minor axis, axis at y = -4", printed("16.91 mm"), Finding.UNDER_READING,
              lambda: _semi_minor(0.0, -4.0), READ_OFF),
        Entry("Fig. 4", "semi-minor axis, axis at x = 4, y = -4", printed("16.44 mm"), Finding.UNDER_READING,
              lambda: _semi_minor(4.0, -4.0), READ_OFF),
        Entry("Fig. 6, Fig. 7", "centre distance that changes with the angle", printed("60.0 64.5 68.0 64.5 mm"),
              Finding.GIVEN_BACK, _moving_distances, "The curves are drawn without a number, and their ratio is not "
              "told. Of gears that turn evenly these are the distances at which both pitch curves touch; "
              "designs/moving-axis.yaml gives them teeth."),
        Entry("Fig. 14", "rack of a replacement gear, before and after its fit to one tooth",
              printed("1.6123 20 0.61 -0.05 1.6123 23 0.90 0.00"), Finding.NEEDS_DATA,
              words="The gears and the tooth are drawn without a number."),
    ),
    left_out=(
        LeftOut("Fig. 2", "lobes of six pairs", Reason.GIVEN, texts("1 1 1 2 1 3 1 1 1 1 1 1 2")),
        LeftOut("Fig. 4", "offsets of the axis", Reason.GIVEN, texts("0 4 0 0 -4 4 -4")),
        LeftOut("Fig. 6", "driving angles of four positions", Reason.GIVEN, texts("0 90 180 270")),
        LeftOut("Fig. 1, Fig. 3, Fig. 5, Fig. 8, Fig. 9, Fig. 10, Fig. 11, Fig. 12, Fig. 13, Fig. 15, Fig. 16",
                "curves, teeth, ratios and forces as pictures", Reason.DRAWN),
        LeftOut("eq. 8, eq. 9", "force and speed of a replacement gear", Reason.DEFINED),
        LeftOut("section 2.1", "an even ratio without an offset, where the figure's goes up and down alike twice a "
                "turn", Reason.VAGUE),
    ),
)  # fmt: skip
