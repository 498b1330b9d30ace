"""The keys of the machine around the gears: operation, resistance, mechanisms to compare with, output, linkage.

Keys under ``linkage`` of the same name mean the same in all mechanisms.
"""

from __future__ import annotations

from math import inf
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from ncgear.design.keys.base import (
    CSV_FILE,
    FORMULA,
    Expression,
    Faults,
    FileName,
    Length,
    Model,
    Numbers,
    Place,
    Positive,
    Several,
    Speed,
    fault,
    given,
    not_rising,
    optional,
    required,
    unkept,
)
from ncgear.design.words import listed
from ncgear.errors import WrongInput
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.numerics.units import label_and_unit

FIGURES = {"peak_power_w": 1, "peak_acceleration_mm_s2": 2, "peak_speed_mm_s": 1, "compression_speed_mm_s": 1}
"""Figures of a published mechanism, each with the power of the driving speed to which it is proportional."""


class Operation(Model):
    """Operation of the machine."""

    speed_rpm: Speed = required("speed of the driving gear in r/min")


class Published(Model):
    """A published mechanism and its figures, at the speed for which they hold."""

    RULES = ("quoted_power_w with quoted_speed_rpm",)

    name: str = required("name of the mechanism or its publication", min_length=1, max_length=200)
    speed_rpm: Speed = required("driving speed in r/min that the figures belong to")
    peak_power_w: Positive | None = optional("greatest driving power in W")
    peak_acceleration_mm_s2: Positive | None = optional("greatest slider acceleration in mm/s2")
    peak_speed_mm_s: Positive | None = optional("greatest slider speed in mm/s")
    compression_speed_mm_s: Positive | None = optional("slider speed during compression in mm/s")
    quoted_power_w: Positive | None = optional(
        "power in W that the publication set against its own; needs quoted_speed_rpm"
    )
    quoted_speed_rpm: Speed | None = optional("driving speed in r/min that quoted_power_w belongs to")

    def at_speed(self, speed_rpm: float) -> Published:
        """The same mechanism at another speed: power and velocities follow the speed, acceleration its square."""
        factor = speed_rpm / self.speed_rpm
        scaled = {key: getattr(self, key) * factor ** FIGURES[key] for key in given(self, FIGURES)}
        return self.model_copy(update={"speed_rpm": speed_rpm, **scaled})

    def _faults(self) -> Faults:
        if not given(self, FIGURES):
            yield fault("", f"no figure to compare; give at least one of {listed(FIGURES)}")


class Comparison(Model):
    """Mechanisms to compare with at equal speed."""

    published: Several[Published] = required("published mechanisms, a list", min_length=1, max_length=100)


MOST_RESISTANCE_POINTS = 1000
FEWEST_POINTS = 2

STRONGEST_N = 1e15
"""Far beyond any machine, and far below forces whose slopes between two points overflow."""

NEAREST_MM = 1e-9
"""Far below measurable lengths, and far above distances of points whose slopes overflow."""

Points = Field(min_length=FEWEST_POINTS, max_length=MOST_RESISTANCE_POINTS)
Displacements = Annotated[Several[Place], Points]
Forces = Annotated[Several[Annotated[float, Field(ge=-STRONGEST_N, le=STRONGEST_N)]], Points]


class LoadTable(Model):
    """Points of a load over the output's way: two columns of the same length, with strictly rising places."""

    COLUMNS: ClassVar[tuple[str, str]]
    """The keys of the places and of the loads."""

    def _faults(self) -> Faults:
        for key in self.COLUMNS:
            if getattr(self, key) is None:
                needed = listed(self.COLUMNS, "and")
                yield fault(key, f"missing; give it: a table needs {needed}, or a file that has both")
        places, loads = self.COLUMNS
        yield from unkept(self, f"{loads} as many as {places}")
        yield from not_rising(places, getattr(self, places), NEAREST_MM, f"{label_and_unit(places)[0]}s")


class ResistanceTable(LoadTable):
    """Points of the force. Points from a CSV file become the same columns when the file is loaded."""

    COLUMNS: ClassVar[tuple[str, str]] = ("displacement_mm", "force_n")

    displacement_mm: Displacements | None = optional("displacements in mm from the retracted end, strictly rising")
    force_n: Forces | None = optional("forces in N, one for each displacement")
    file: FileName | None = optional(CSV_FILE.format("both"))


class TorqueTable(LoadTable):
    """Points of the torque. Points from a CSV file become the same columns when the file is loaded."""

    COLUMNS: ClassVar[tuple[str, str]] = ("angle_deg", "torque_n_m")

    angle_deg: Displacements | None = optional(
        "angles of the output in deg from its start or its retracted end, strictly rising"
    )
    torque_n_m: Forces | None = optional("torques in N m, one for each angle")
    file: FileName | None = optional(CSV_FILE.format("both"))


class Load(Model):
    """A load over the output's way in one of three forms; ``FORMS`` names their keys."""

    FORMS: ClassVar[tuple[str, str, str]]
    """The keys of a polynomial, a table and an expression."""

    FRICTION: ClassVar[str] = ""
    """The key of a load against motion in either sense; with it, or with a load on the way back, no form is needed."""

    def _faults(self) -> Faults:
        beside = getattr(self, "returning", None) is not None or self.FRICTION in self.model_fields_set
        yield from unkept(self, f"{'at most one' if beside else 'one'} of {' '.join(self.FORMS)}")


class TurningLoad(Load):
    """The torque against a turning output; one of polynomial_n_m, table and expression_n_m."""

    FORMS: ClassVar[tuple[str, str, str]] = ("polynomial_n_m", "table", "expression_n_m")

    polynomial_n_m: Annotated[Numbers, Field(min_length=1, max_length=50)] | None = optional(
        "coefficients of the torque in N m, in rising powers of the output's angle in rad"
    )
    table: TorqueTable | None = optional(
        "the torque point by point, joined by monotone cubics (PCHIP), which never overshoot the points; it keeps its "
        "end values beyond the table's ends"
    )
    expression_n_m: Expression | None = optional(
        'torque in N m as a formula of x (= angle of the output in rad): "12 + 3*sin(2*x)", '
        f"{FORMULA}; it may have corners, but no jumps"
    )
    where_negative: Literal["zero", "keep"] = optional(
        "where the torque is negative: keep, it drives the output there, or zero", "keep"
    )


class ShaftTorque(TurningLoad):
    """The torque against the driven shaft over one of its turns; it repeats every turn."""


class StrokeForce(Load):
    """The force against the slider over one of its strokes; one of polynomial_n, table and expression_n."""

    FORMS: ClassVar[tuple[str, str, str]] = ("polynomial_n", "table", "expression_n")

    polynomial_n: Annotated[Numbers, Field(min_length=1, max_length=50)] | None = optional(
        "coefficients of the force in N, in rising powers of the displacement in mm"
    )
    table: ResistanceTable | None = optional(
        "the force point by point, joined by monotone cubics (PCHIP), which never overshoot the points; it keeps its "
        "end values beyond the table's ends"
    )
    expression_n: Expression | None = optional(
        'force in N as a formula of x (= displacement in mm): "200 + 3*exp(x/90)", '
        f"{FORMULA}; it may have corners, as max(0, x - 30) has, but no jumps"
    )
    where_negative: Literal["zero", "keep"] = optional(
        "where the force is negative: zero (a fit says nothing there) or keep", "zero"
    )


class Resistance(StrokeForce):
    """The force against the slider: over its working stroke, over its way back, and friction on both."""

    FRICTION: ClassVar[str] = "friction_n"

    returning: StrokeForce | None = optional(
        "force against the slider on its way back, over the displacement like the other; left out: none"
    )
    friction_n: float = optional("constant force in N against the slider's motion, on both strokes", 0.0, ge=0.0)
    shown_as: Literal["load", "straw", "carton", "sheet"] = optional(
        "what pictures show where the force acts: load, a plain block in a chamber; straw, as in a baler; carton or "
        "sheet, pushed along a table",
        "load",
    )


class RockerTorque(TurningLoad):
    """The torque against a swinging output: over its working stroke, over its way back, and friction on both."""

    FRICTION: ClassVar[str] = "friction_n_m"

    returning: TurningLoad | None = optional(
        "torque against the output on its way back, over the angle like the other; left out: none"
    )
    friction_n_m: float = optional("constant torque in N m against the output's motion, on both strokes", 0.0, ge=0.0)


CHORD_MM = 0.005
"""Chord tolerance in mm if none is given: finer than the accuracy of any printer, laser or wire."""

CHORD_OF_LARGE_IN_MODULES = 1e-4
"""The same for large teeth, from a module of 50 mm on; 0.005 mm would take ever more points there."""

CHORD_IN_MODULES = 0.002
"""The same for small teeth, so that they turn like large teeth: it is the smaller value up to a module of 2.5 mm."""

FINEST_IN_MODULES, COARSEST_IN_MODULES = 1e-7, 0.05
"""Limits of given chord tolerances: finer chords are lost in the single precision of STL; coarser outlines, which may
overlap by as much, are no teeth: the limit is a fifth of a usual tip clearance."""

NARROWEST_IN_MODULES = 5e-4
"""The narrowest band of tooth thickness: a micrometre at module 2, the accuracy of ground master gears.  Outlines
within a tenth of it have ten times the usual points."""

COARSEST_IN_BAND = 0.2
"""The coarsest chord tolerance, in widths of the band of tooth thickness: chords c inside both flanks of a tooth reduce
its thickness by 2 c / cos(alpha) and let pins sink as far, at alpha = 20 deg by 0.85 of half the band. The default
tolerance is half of this, so that pins stay in the middle half of the band."""


class Output(Model):
    """Fineness of the written results."""

    chord_tolerance_mm: Length | None = optional(
        "greatest distance in mm of a written outline's chords from the exact curve, "
        f"{FINEST_IN_MODULES:g} (with many teeth more, as a refusal then tells) to {COARSEST_IN_MODULES:g} "
        f"modules and up to {COARSEST_IN_BAND:g} of the width of the "
        f"band that gears.tolerances gives the tooth thickness; left out: the least of {CHORD_MM:g} mm (or "
        f"{CHORD_OF_LARGE_IN_MODULES:g} modules, if more), {CHORD_IN_MODULES:g} modules and {COARSEST_IN_BAND / 2.0:g} "
        "of that width"
    )

    def chord_mm(self, module_mm: float, band_mm: float | None = None) -> float:
        """The chord tolerance for a module and the width of the band of tooth thickness, None for teeth without a band.

        Raises WrongInput if the given tolerance is out of proportion to either.
        """
        given, band = self.chord_tolerance_mm, inf if band_mm is None else band_mm
        coarsest = COARSEST_IN_MODULES * module_mm
        in_band, narrowest = COARSEST_IN_BAND * band, NARROWEST_IN_MODULES * module_mm
        if band < narrowest:
            raise WrongInput(
                f"the band of tooth thickness is {band:.3g} mm wide, which no process holds, and too narrow for chords "
                f"of outlines; {shown_above(narrowest, 3)} mm or more, or twice the same limit, is right",
                key="gears.tolerances.tooth_thickness_lower_mm",
            )
        if given is None:
            usual = max(CHORD_MM, CHORD_OF_LARGE_IN_MODULES * module_mm)
            return min(usual, CHORD_IN_MODULES * module_mm, in_band / 2.0)
        if given > coarsest:
            raise WrongInput(
                f"{given:g} mm are {given / module_mm:.3g} of the module of {module_mm:.4g} mm; "
                f"{shown_below(min(coarsest, in_band), 3)} mm or less is right",
                key="output.chord_tolerance_mm",
            )
        if given > in_band:
            raise WrongInput(
                f"{given:g} mm are {given / band:.3g} of the band of tooth thickness, {band:.4g} mm wide, so that pins "
                f"in written outlines lie outside of it; {shown_below(in_band, 3)} mm or less is right, or a band of "
                f"{shown_above(given / COARSEST_IN_BAND, 3)} mm or more between "
                "gears.tolerances.tooth_thickness_lower_mm and tooth_thickness_upper_mm",
                key="output.chord_tolerance_mm",
            )
        return given


class CrankKeys(Model):
    """A mechanism with a crank."""

    crank_mm: Length | None = optional(
        "length of the crank in mm; may be left out only when motion.solve_for is stroke"
    )


class Linkage(CrankKeys):
    """The crank-slider that the driven gear turns."""

    rod_mm: Length = required("length of the connecting rod in mm")
    offset_mm: Place = optional("distance of the slider's line from the crank axis in mm", 0.0)


class NoLinkage(Model):
    """Gears without a linkage: the driven shaft is the output."""


class YokeKeys(CrankKeys):
    """The Scotch yoke that the driven gear turns."""


class RockerKeys(CrankKeys):
    """The crank-rocker (four-bar linkage) that the driven gear turns."""

    coupler_mm: Length = required("length of the coupler of a crank_rocker, from crank pin to rocker pin, in mm")
    rocker_mm: Length = required("length of the rocker of a crank_rocker, from its axis to its pin, in mm")
    ground_mm: Length = required("distance of a crank_rocker's axes, crank to rocker, in mm")
    side: Literal[1, -1] = optional(
        "side of the rocker's pin as seen from the crank's axis to the rocker's, with the crank turning clockwise: 1 "
        "on the left, -1 on the right",
        1,
    )


class LeverKeys(CrankKeys):
    """The slotted lever with its ram that the driven gear turns."""

    pivot_mm: Length = required("distance of a slotted_lever's axis from the crank's in mm, over crank_mm")
    lever_mm: Length = required(
        "length of a slotted_lever from its axis to the pin of the ram in mm, over pivot_mm + crank_mm"
    )


class RackKeys(Model):
    """The pinion on the shaft of the driven gear, and the rack that it moves."""

    radius_mm: Length | None = optional("pitch radius of a rack_pinion's pinion in mm; needed")


class Fit(Model):
    """Sizes that tell a build whether rod and crank pin pass the shafts."""

    rod_width_mm: Length | None = optional(
        "width of the rod in mm, or of coupler, rocker, lever, and bar and slot of yoke or ram, across its length and "
        "the axes; left out: none is assumed, and a build tells the widest that passes"
    )
    driving_shaft: Literal["through", "ends"] = optional(
        "through: shaft and hub of the driving gear stand in the plane in which rod and crank pin move; ends: they "
        "end below it, or are on the other side of the gears",
        "through",
    )
