"""The law ``three_segment_stroke``: the slider's working stroke in three segments, and a return that closes the cycle.

All quantities together would over-determine the stroke, so a file leaves one of them out, and the law solves for it.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, isclose, pi, radians
from sys import float_info
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator

from ncgear.design.keys.base import (
    Faults,
    Length,
    Model,
    Positive,
    Speed,
    angle,
    fault,
    given,
    key_of,
    optional,
    required,
)
from ncgear.design.laws.base import Begins, DraggedPoint, LawKeys
from ncgear.design.reading.text import quoted
from ncgear.design.words import listed
from ncgear.errors import WrongInput

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism, Output
    from ncgear.ratio.laws.three_segment import StrokeLaw
    from ncgear.ratio.transmission import Law, Lobes
    from ncgear.ratio.working_stroke import ClosedStroke

SAME_STROKE = 1e-6
"""Largest relative difference of the file's stroke from the mechanism's stroke that counts as rounding."""

SolveFor = Literal["law_speed", "v1", "v2", "a1", "stroke"]

SOLVED_KEYS: dict[str, tuple[str, str]] = {
    "law_speed": ("law_speed_rpm", "law_speed_rpm"),
    "v1": ("v1_mm_s", "v1_rad_s"),
    "v2": ("v2_mm_s", "v2_rad_s"),
    "a1": ("a1_mm_s2", "a1_rad_s2"),
    "stroke": ("stroke_mm", "stroke_deg"),
}
"""The key that is left out for each value of ``solve_for``, for a sliding and for a turning output."""


def _number_or_word(value: Any) -> Any:
    """Refuse other values in one sentence; pydantic would have a message for each type of the union."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if value != "least_acceleration" and not (is_number and abs(value) <= float_info.max):
        raise fault("", f"{quoted(value)} given; a finite number or the word least_acceleration is needed")
    return value


class ReturnOptions(Model):
    """The return of the slider: the form of the ratio over the return stroke and its one free coefficient."""

    basis: Literal["ratio", "inverse_ratio"] = optional(
        "quantity that is a polynomial of phi1 over the return stroke: ratio or inverse_ratio", "ratio"
    )
    e: Annotated[float | Literal["least_acceleration"], BeforeValidator(_number_or_word)] = optional(
        "free coefficient of the return stroke, the value at phi1 = 0 of the polynomial that is its basis: a number, "
        "or least_acceleration to have it found",
        "least_acceleration",
    )


class ThreeSegmentStroke(LawKeys):
    """The working stroke in three segments: by way of v1 to v2, constant v2, down to rest; then the return."""

    CHOICE = "the slider works in three segments: it goes, presses at constant speed, slows down"
    BEGINS = Begins.WISH
    ASKED_LENGTH = "stroke_mm"
    GROWS_WITH_MACHINE = ("v2_mm_s", "a1_mm_s2", "law_speed_rpm")
    NARROWER_RATIO = "move theta4, or change a1 or the speed at which a1 is stated (a1_speed_rpm), in small steps"
    solve_for: SolveFor = required(
        "the quantity found from the others, its own key left out: law_speed, v1, v2, a1 or stroke"
    )
    theta1: float = angle(
        "driving angle {unit} at which the slider's speed is v1 and its acceleration zero", needed=True
    )
    theta2: float = angle("driving angle {unit} from which the slider's speed is v2; over theta1", needed=True)
    theta3: float = angle("driving angle {unit} up to which the slider's speed is v2; theta2 or over", needed=True)
    theta4: float = angle("driving angle {unit} of the extended dead centre; over theta3, under a cycle", needed=True)
    v1_mm_s: Positive | None = optional("slider speed v1 at theta1 in mm/s, at the law speed")
    v2_mm_s: Positive | None = optional("constant slider speed v2 from theta2 to theta3 in mm/s, at the law speed")
    a1_mm_s2: float | None = optional("slider acceleration a1 at theta4 in mm/s2, negative, at a1_speed_rpm")
    a1_speed_rpm: Speed | None = optional("driving speed in r/min at which a1_mm_s2 is stated; left out: the law speed")
    law_speed_rpm: Speed | None = optional("driving speed in r/min at which v1 and v2 hold")
    stroke_mm: Length | None = optional("stroke in mm; left out: the stroke of the linkage")
    v1_rad_s: Positive | None = optional("speed v1 in rad/s of an output that turns, in the place of v1_mm_s")
    v2_rad_s: Positive | None = optional("speed v2 in rad/s of an output that turns, in the place of v2_mm_s")
    a1_rad_s2: float | None = optional("acceleration a1 in rad/s2 of an output that turns, in the place of a1_mm_s2")
    stroke_deg: float | None = optional(
        "stroke in deg of an output that turns; left out: the stroke of the linkage", gt=0.0, lt=360.0
    )
    return_: ReturnOptions = optional("the return stroke", ReturnOptions, alias="return")

    @property
    def turns(self) -> bool:
        """Whether the keys belong to a turning output."""
        return bool(given(self, [turning for sliding, turning in SOLVED_KEYS.values() if turning != sliding]))

    @property
    def stroke(self) -> float | None:
        """The stroke in mm or rad; None if it is left out."""
        return radians(self.stroke_deg) if self.stroke_deg is not None else self.stroke_mm

    def _angles_rise(self) -> Faults:
        if wrong := out_of_order([getattr(self, quantity) for quantity in THETAS]):
            quantity, problem = wrong
            yield fault(key_of(self, quantity), problem)

    def _only_the_solved_one_is_absent(self) -> Faults:
        keys = [pair[self.turns] for pair in SOLVED_KEYS.values()]
        other = given(self, [pair[not self.turns] for pair in SOLVED_KEYS.values() if pair[0] != pair[1]])
        if other:
            yield fault(other[0], "given beside keys of an output that turns; keep keys in rad or keys in mm")
        solved = SOLVED_KEYS[self.solve_for][self.turns]
        if getattr(self, solved) is not None:
            yield fault(solved, f"given, but solve_for: {self.solve_for} says to find it; leave {solved} out")
        # The stroke can always be left out, because the mechanism has one.
        needed = [key for key in keys if key not in (solved, SOLVED_KEYS["stroke"][self.turns])]
        absent = [key for key in needed if getattr(self, key) is None]
        if absent:
            yield fault(absent[0], f"missing; give it: solve_for: {self.solve_for} needs {listed(needed, 'and')}")

    @property
    def gives_slider(self) -> bool:
        """The working stroke is the slider's motion."""
        return True

    @property
    def prescribed(self) -> str:
        """The constant speed, if it has a stretch."""
        if self.even_rad is None:
            return ""
        start, end = map(degrees, self.even_rad)
        return f"the constant speed v2 from theta2 to theta3 ({start:.5g} to {end:.5g} deg)"

    @property
    def even_rad(self) -> tuple[float, float] | None:
        """theta2 and theta3, if there is a stretch between them."""
        return (self.theta2, self.theta3) if self.theta3 > self.theta2 else None

    @property
    def gives_stroke(self) -> bool:
        """Whether the stroke is solved for."""
        return self.solve_for == "stroke"

    @property
    def law_points(self) -> tuple[DraggedPoint, ...]:
        """theta1 to theta4 with v1 and v2, and a1; no point changes the unknown quantity."""
        found = []
        speeds = {"theta1": "v1", "theta2": "v2", "theta3": "v2", "theta4": ""}
        for theta, speed in speeds.items():
            key = SOLVED_KEYS[speed][self.turns] if speed else ""
            value = getattr(self, key) if key else None
            name, at = f"{theta}, {speed}" if speed else theta, key_of(self, theta)
            value_key = key if value is not None else ""
            found.append(DraggedPoint(name, "velocity", getattr(self, theta), None, at, value_key, value or 0.0))
        key = SOLVED_KEYS["a1"][self.turns]
        if (value := getattr(self, key)) is not None:
            # Just before the return, which may begin with another acceleration.
            before = self.theta4 * (1.0 - 1e-9)
            found.append(DraggedPoint("a1", "acceleration", before, None, "", key, value, self.a1_speed_rpm))
        return tuple(found)

    def solved_stroke_mm(self, mechanism: type[Mechanism]) -> float:
        """The stroke in mm or rad that follows from the other quantities.

        Raises WrongInput if the keys do not suit the mechanism's output, NoSuchMechanism if there is no stroke.
        """
        self._refuse_other_units(mechanism)
        return self._stroke(None, mechanism.OUTPUT).stroke_mm

    def law_on(self, linkage: Mechanism, lobes: Lobes, *, ring: bool = False) -> Law:
        """The closed law, with the figures of its stroke and its return.

        Raises WrongInput if the strokes of the mechanism and the file differ.
        """
        from ncgear.ratio.transmission import Law, PrescribedStroke, single

        law = self.stroke_law(linkage, lobes)
        stroke, back, output = law.stroke, law.return_law, linkage.OUTPUT
        facts = {
            "solved_for": self.solve_for,
            f"v1_{output.speed.ending}": stroke.v1,
            f"v2_{output.speed.ending}": stroke.v2,
            f"a1_{output.acceleration.ending}": stroke.a1,
            "return_basis": "inverse_ratio" if back.inverse else "ratio",
            "return_constant_e": back.extrapolated_ratio,
        }
        prescribed = PrescribedStroke(stroke.law_speed_rad_s, stroke.closing_error_mm, facts)
        return Law(linkage, single(law.transmission), prescribed)

    def stroke_law(self, linkage: Mechanism, lobes: Lobes) -> StrokeLaw:
        """The law with the polynomials of its stroke and its return; raises the errors of ``law_on``."""
        from ncgear.ratio.laws.three_segment import stroke_law

        self._refuse_other_units(type(linkage))
        if not self.gives_stroke:
            require_stroke_of(self.stroke, linkage)
        return stroke_law(
            self._stroke(None if self.gives_stroke else linkage.stroke_mm, linkage.OUTPUT),
            linkage,
            lobes,
            constant=None if self.return_.e == "least_acceleration" else self.return_.e,
            inverse_basis=self.return_.basis == "inverse_ratio",
        )

    def _stroke(self, stroke_mm: float | None, output: Output) -> ClosedStroke:
        """The working stroke with its unknown quantity solved for; None makes the stroke the unknown quantity."""
        from ncgear.numerics.units import RAD_S_PER_RPM
        from ncgear.ratio.working_stroke import StrokeRequest, solved_stroke

        request = StrokeRequest(
            theta1_rad=self.theta1,
            theta2_rad=self.theta2,
            theta3_rad=self.theta3,
            theta4_rad=self.theta4,
            v1=self.v1_rad_s if self.turns else self.v1_mm_s,
            v2=self.v2_rad_s if self.turns else self.v2_mm_s,
            a1=self.a1_rad_s2 if self.turns else self.a1_mm_s2,
            law_speed_rad_s=None if self.law_speed_rpm is None else self.law_speed_rpm * RAD_S_PER_RPM,
            stroke_mm=stroke_mm,
            a1_speed_rad_s=None if self.a1_speed_rpm is None else self.a1_speed_rpm * RAD_S_PER_RPM,
            output=output,
        )
        return solved_stroke(request)

    def _refuse_other_units(self, mechanism: type[Mechanism]) -> None:
        """Refuse speeds in mm/s for a turning output, and in rad/s for a sliding output; raises WrongInput."""
        output = mechanism.OUTPUT
        if self.turns is output.angular:
            return
        for pair in SOLVED_KEYS.values():
            wrong, right = pair[self.turns], pair[not self.turns]
            if wrong != right and getattr(self, wrong) is not None:
                does = "turns" if output.angular else "slides"
                raise WrongInput(
                    f"given, but the {output.name} of {mechanism.NAME} {does}; {right} is right", key=f"motion.{wrong}"
                )


def require_stroke_of(stroke: float | None, linkage: Mechanism) -> None:
    """Refuse a stroke in the file, in mm or rad, that differs from the mechanism's stroke; raises WrongInput."""
    if stroke is not None and not isclose(stroke, linkage.stroke_mm, rel_tol=SAME_STROKE):
        relation, place = "longer" if stroke > linkage.stroke_mm else "shorter", linkage.OUTPUT.place
        told, right = (f"{place.factor * length:.9g} {place.text}" for length in (stroke, linkage.stroke_mm))
        raise WrongInput(
            f"{told} is {relation} than the linkage's stroke of {right}; give "
            f"{right}, leave the key out, or change linkage.{linkage.STROKE_KEY}",
            key=f"motion.stroke_{place.ending}",
        )


THETAS = ("theta1", "theta2", "theta3", "theta4")


def out_of_order(angles_rad: Sequence[float]) -> tuple[str, str] | None:
    """The name of the angle of theta1 to theta4, in rad, that is out of order, and words for it; None if they rise."""
    theta1, theta2, theta3, theta4 = angles_rad
    if theta1 <= 0.0:
        wrong, needed = "theta1", "over 0"
    elif theta2 <= theta1:
        wrong, needed = "theta2", "over theta1"
    elif theta3 < theta2:
        wrong, needed = "theta3", "theta2 or over"
    elif not theta3 < theta4 < 2.0 * pi:
        wrong, needed = "theta4", "between theta3 and 2 pi"
    else:
        return None
    in_pi = [f"{angle / pi:.6g}" for angle in angles_rad]
    return wrong, (
        f"{wrong} must be {needed}; the angles, in multiples of pi, are {', '.join(in_pi)}; "
        "0 < theta1 < theta2 <= theta3 < theta4 < 2 is right"
    )
