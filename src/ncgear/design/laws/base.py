"""A motion law in a design file: a model of its keys that can make the law, and its part of a new design file.

A law needs only fields, the method ``transmission``, ``CHOICE`` and ``BEGINS``.  All other members of ``LawKeys`` have
defaults that suit a law of the gear ratio.  A law of the slider's stroke, or a law of two pairs of gears, overrides
some of them.  A law imports the numerical rooms when it is made, so that reading a design file does not load them.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from inspect import get_annotations
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from ncgear.design.keys.base import Model, fault, required
from ncgear.frozen import dataclass

if TYPE_CHECKING:
    from ncgear.design.keys.pitch_shapes import DrawnContour
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.numerics.arrays import Array
    from ncgear.ratio.laws.over_driven_angle import StagedLaw
    from ncgear.ratio.transmission import Law, Lobes, Transmission


SHORTEST_RANGE_DEG, LONGEST_RANGE_DEG = 5.0, 355.0
"""Limits of the turning range, in degrees, for less than one turn: less is no gear, and more leaves no body."""


def _less_than_a_turn(value: object) -> object:
    if isinstance(value, int | float) and value > LONGEST_RANGE_DEG:
        raise fault(
            "",
            f"{value:g} deg given, but over a whole turn the teeth of a gear lie over each other, and spiral gears in "
            f"two planes are not made; {LONGEST_RANGE_DEG:g} or under is right",
        )
    return value


RangeDeg = Annotated[float, Field(ge=SHORTEST_RANGE_DEG, le=LONGEST_RANGE_DEG), BeforeValidator(_less_than_a_turn)]


@dataclass(frozen=True)
class DraggedPoint:
    """A point of a law on the curve of a quantity, for a user who drags it there instead of typing its keys.

    It stands at ``phi1_rad``, or where the driven gear has turned by a share of its period, ``driven_share``.  Dragging
    it along the angle changes ``angle_key``, along the quantity ``value_key`` from ``value``; an empty key does not
    change, and keys count from ``motion``.  ``value`` holds at ``speed_rpm``; None stands for the speed of the law. A
    point of a series has ``coefficients`` instead: keys of lists, the lists, and their change per change of the
    quantity's logarithm.
    """

    name: str
    quantity: Literal["displacement", "velocity", "acceleration", "ratio"]
    phi1_rad: float | None = None
    driven_share: float | None = None
    angle_key: str = ""
    value_key: str = ""
    value: float = 0.0
    speed_rpm: float | None = None
    coefficients: tuple[tuple[str, tuple[float, ...], tuple[float, ...]], ...] = ()


@dataclass(frozen=True)
class LawNumber:
    """A number that shapes a law, with the name of its handle: alone under its key, or within a formula.

    ``before`` and ``after`` are the parts of the formula around it.  Keys count from ``motion``.
    """

    name: str
    key: str
    value: float
    before: str = ""
    after: str = ""

    def written(self, value: float) -> float | str:
        """The value of the key with another number."""
        return f"{self.before}{value:.12g}{self.after}" if self.before or self.after else value


class Begins(StrEnum):
    """The thing that a person who takes a law begins with: the machine, a wish, a shape, a formula, or points."""

    MACHINE = "machine"
    WISH = "wish"
    SHAPE = "shape"
    FORMULA = "formula"
    POINTS = "points"


class LawKeys(Model):
    """The keys under ``motion``, completed by the class of each law, and the law's part of a new design file."""

    CHOICE: ClassVar[str]
    """The words for the law in the menu of ``ncgear new``."""
    BEGINS: ClassVar[Begins]
    """The beginning of a person who takes the law; gears of a shape or a formula have no linkage at first."""
    ASKED_LENGTH: ClassVar[Literal["crank_mm", "stroke_mm"]] = "crank_mm"
    """The length that ``ncgear new`` asks for; the other length follows from it."""
    GROWS_WITH_MACHINE: ClassVar[tuple[str, ...]] = ()
    """Keys of a new file that must grow with stroke and speed, by their units, so that the law keeps its form."""
    EXAMPLES: ClassVar[Mapping[str, str]] = {}
    """Examples for ``ncgear explain``, in the form of a file, for keys that the template leaves out."""
    NARROWER_RATIO: ClassVar[str] = ""
    """Advice for a range of the ratio that is too wide; empty if there is no advice."""
    law: str

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Give the law the name of its module."""
        if cls.__base__ is LawKeys:
            name = cls.__module__.rpartition(".")[2]
            cls.__annotations__ = {"law": Literal[name], **get_annotations(cls)}
            cls.law = required(f"the name of this law: {name}")
        super().__init_subclass__(**kwargs)

    @property
    def gives_slider(self) -> bool:
        """Whether the law prescribes the motion of the slider; most prescribe the ratio of the gears."""
        return False

    @property
    def gives_stroke(self) -> bool:
        """Whether the stroke, and so the length of the crank, follows from the law."""
        return False

    @property
    def solves_shape(self) -> bool:
        """Whether the law finds a quantity of a shape at a given centre distance; this does not suit a ring."""
        return False

    @property
    def gives_center_distance(self) -> bool:
        """Whether the distance of the gears' axes follows from the law; most laws hold for gears of any size."""
        return False

    @property
    def contour(self) -> DrawnContour | None:
        """The contour of a file that gives the pitch curve; most laws have none."""
        return None

    @property
    def gives_outline(self) -> bool:
        """Whether the law draws a pitch curve, for which ``ncgear fit`` finds the nearest curve that can be made."""
        return False

    def outline_mm(self) -> tuple[Array, Array, str]:
        """Points of the drawn outline, shape (n, 2), the axis in it, shape (2,), and the key that draws it.

        Only for a law that ``gives_outline``; raises WrongInput if there is no such outline.
        """
        raise NotImplementedError(self.law)

    def along(self, control_mm: Array, axis_mm: Array) -> dict[str, Any]:
        """The keys of the same law with a closed uniform quintic B-spline in place of its outline.

        ``control_mm`` are its control points in the drawing, shape (n, 2), ``axis_mm`` is the gear's axis there.
        """
        raise NotImplementedError(self.law)

    @property
    def is_open(self) -> bool:
        """Whether the law holds for a range of the driving angle, so that the gears turn to and fro, less than once."""
        return False

    @property
    def prescribed(self) -> str:
        """The law's prescription for the slider's motion, in words; empty if there is none."""
        return ""

    @property
    def even_rad(self) -> tuple[float, float] | None:
        """The driving angles in rad between which the law prescribes a constant speed; None without constant speed."""
        return None

    @property
    def pairs_in_series(self) -> int:
        """Pairs of gears that make the ratio: 2 for a law with a ``second_stage``, else 1."""
        return 1 if getattr(self, "second_stage", None) is None else 2

    @property
    def pairs_key(self) -> str:
        """The key that gives a law several pairs of gears."""
        return "second_stage"

    def solved_stroke_mm(self, mechanism: type[Mechanism]) -> float:
        """The stroke in mm or rad for a law that ``gives_stroke``.

        Raises WrongInput if the law's keys do not suit the mechanism, NoSuchMechanism if there is no stroke.
        """
        raise NotImplementedError(self.law)

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """The driven angle as a function of the driving angle.

        Raises WrongInput for values that contradict each other, NoSuchMechanism if no such motion exists.
        """
        raise NotImplementedError(self.law)

    def law_on(self, linkage: Mechanism, lobes: Lobes, *, ring: bool = False) -> Law:
        """The closed law on its mechanism; the driven gear may be a ring; raises the errors of ``transmission``.

        A law that prescribes a stroke overrides this method; a law that can have two pairs of gears has ``staged``.
        """
        from ncgear.ratio.transmission import Law, single

        if self.pairs_in_series == 2:
            return Law(linkage, self.staged().train)
        return Law(linkage, single(self.transmission(linkage, lobes)))

    def staged(self) -> StagedLaw:
        """The law of both pairs in series; raises the errors of ``transmission``."""
        raise NotImplementedError(self.law)

    @property
    def law_points(self) -> tuple[DraggedPoint, ...]:
        """The points that make the law; a law of a formula or of a few numbers has none."""
        return ()

    @property
    def law_numbers(self) -> tuple[LawNumber, ...]:
        """The numbers that shape a law without points."""
        return ()

    def gentler(self, share: float, even_turn: str) -> dict[str, Any]:
        """Values of keys that leave ``share`` (0 to 1) of the swing of the ratio; empty for a law without such keys.

        ``even_turn`` is the formula for the driven angle per driving angle of evenly turning gears.
        """
        return {}
