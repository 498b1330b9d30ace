"""The keys of a place that the output passes at a driving angle."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Self

from ncgear.design.keys.base import Faults, Length, Positive, angle, fault, key_of, optional, required
from ncgear.design.wishes.base import On, StrokeName, Way, WishKeys

if TYPE_CHECKING:
    from ncgear.wishes.wish import Wish


class Position(WishKeys):
    """A place that the slider passes at a driving angle."""

    KIND = "positions"
    MEANING = "places to pass at driving angles, a list in the order of the angle"
    REACHING = ("at",)
    ANGLES = (("phi1", "driving_rad"),)

    at_mm: Way = required("displacement in mm to pass")
    tolerance_mm: Length = required("how far in mm the slider may be from it at that angle")
    driving_rad: float = angle("driving angle {unit} at which it is passed", "phi1", needed=True, of=Positive)
    stroke: StrokeName | None = optional(
        "on the way out (working) or on the way back (return); left out: out, until a displacement of the list is "
        "smaller than the one before it"
    )

    @classmethod
    def disagreements(cls, own: Sequence[Self]) -> Faults:
        """Faults of positions that do not follow each other by driving angle, and in each stroke by displacement."""
        strokes = list(strokes_of(own))
        ways = list(zip(own, strokes, strict=True))
        for number, ((before, earlier), (after, later)) in enumerate(pairwise(ways), 1):
            if not before.driving_rad < after.driving_rad:
                name = key_of(after, "phi1")
                yield fault(
                    f"{cls.KIND}.{number}.{name}",
                    f"{getattr(after, name):g} given, which is not over the angle before it; the driving angles of the "
                    "list must rise",
                )
            if earlier == "return" and later == "working":
                yield fault(
                    f"{cls.KIND}.{number}.stroke", "working given after a position on the return; return is right"
                )
            back = later == "return"
            there, here = before.place("at"), after.place("at")
            if earlier == later and not (here < there if back else here > there):
                yield fault(
                    f"{cls.KIND}.{number}.at_{after.PLACE}",
                    f"{here:g} follows {there:g} in the {later} stroke, where displacements "
                    f"{'fall' if back else 'rise'}",
                )

    @classmethod
    def completed(cls, own: Sequence[Self]) -> Sequence[Self]:
        """Every position with its stroke."""
        pairs = zip(own, strokes_of(own), strict=True)
        return [position.model_copy(update={"stroke": stroke}) for position, stroke in pairs]

    def value(self, on: On, **common: Any) -> Wish:
        """The place with its tolerance."""
        from ncgear.kinematics.crank_stretches import Stroke
        from ncgear.wishes.positions import Position as Value

        return Value(
            at_mm=on.mm(self.place("at")),
            phi1_rad=self.driving_rad,
            tolerance_mm=on.mm(self.place("tolerance")),
            stroke=Stroke(self.stroke),
            **common,
        )


def strokes_of(positions: Sequence[Position]) -> Iterator[StrokeName]:
    """The stroke of each position: the given stroke, or the working stroke until a displacement falls."""
    stroke: StrokeName = "working"
    for before, position in zip((None, *positions), positions, strict=False):
        if position.stroke is not None:
            stroke = position.stroke
        elif before is not None and position.place("at") < before.place("at"):
            stroke = "return"
        yield stroke
