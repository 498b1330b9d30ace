"""The law ``table``: displacement of the slider, or gear ratio, point by point over the driving angle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field

from ncgear.design.keys.base import (
    CSV_FILE,
    FULL_TURN,
    Faults,
    FileName,
    Numbers,
    angle,
    fault,
    given,
    key_of,
    not_rising,
    optional,
    unkept,
)
from ncgear.design.laws.base import Begins, DraggedPoint, LawKeys
from ncgear.design.words import spellings
from ncgear.errors import WrongInput
from ncgear.numerics.bounds import shown_below

if TYPE_CHECKING:
    from ncgear.mechanisms.mechanism import Mechanism
    from ncgear.ratio.transmission import Lobes, Transmission

MOST_POINTS = 200_000
FEWEST_POINTS = 4
NEAREST_TURNS = 1e-10
"""Least distance of driving angles, in turns: a gear of a metre moves by a third of a nanometre.  Nearer angles leave
no digits to the splines through them."""

ANGLE_COLUMNS = spellings("phi1")
VALUE_COLUMNS = ("displacement_mm", "displacement_deg", "ratio")

Column = Annotated[Numbers, Field(min_length=FEWEST_POINTS, max_length=MOST_POINTS)]


class Table(LawKeys):
    """Points of the law. Points from a CSV file become the same columns when the file is loaded."""

    CHOICE = "the ratio or the displacement point by point"
    BEGINS = Begins.POINTS
    EXAMPLES: ClassVar[dict[str, str]] = {
        "phi1_rad": "[0, 1.5, 3, 4.5]",
        "phi1_deg": "[0, 90, 180, 270]",
        "phi1_pi": "[0, 0.5, 1, 1.5]",
        "displacement_mm": "[0, 380, 760, 380]",
        "displacement_deg": "[0, 20, 40, 20]",
    }
    RULES = (f"one of {' '.join(VALUE_COLUMNS)}",)

    phi1: tuple[float, ...] = angle(
        "driving angles {unit}, strictly rising, 0 to {turn}", needed=True, of=Column, absent=()
    )
    displacement_mm: Column | None = optional("slider displacements in mm from the retracted end, one for each angle")
    displacement_deg: Column | None = optional(
        "displacements in deg of an output that turns, from its retracted end, one for each angle"
    )
    ratio: Column | None = optional("transmission ratios i12 = dphi1/dphi2, one for each angle")
    file: FileName | None = optional(CSV_FILE.format("the"))
    scale_to_close: bool = optional(
        "true: multiply the ratio by the constant that makes the driven gear come round", False
    )

    def _columns(self) -> Faults:
        if self.scale_to_close and self.ratio is None:
            yield fault("scale_to_close", "true, but there is no ratio to scale; leave it out, or give ratio")
        yield from unkept(self, f"{given(self, VALUE_COLUMNS)[0]} as many as {key_of(self, 'phi1')}")

    def _angles_rise_within_a_turn(self) -> Faults:
        key = key_of(self, "phi1")
        angles: tuple[float, ...] = getattr(self, key)
        turn = FULL_TURN[key.removeprefix("phi1_")]
        for i, turned in enumerate(angles):
            if not 0.0 <= turned <= turn:
                yield fault(f"{key}.{i}", f"{turned:g} is outside the cycle; 0 to {shown_below(turn)} is right")
        yield from not_rising(key, angles, NEAREST_TURNS * turn)

    @property
    def gives_slider(self) -> bool:
        """Points of the displacement prescribe the slider's motion; points of the ratio do not."""
        return self.displacement_mm is not None or self.displacement_deg is not None

    @property
    def prescribed(self) -> str:
        """The points of the displacement."""
        return "the displacements of the table" if self.gives_slider else ""

    @property
    def law_points(self) -> tuple[DraggedPoint, ...]:
        """Every point in the design file itself."""
        if self.file is not None:
            return ()
        key = given(self, VALUE_COLUMNS)[0]
        quantity: Literal["ratio", "displacement"] = "ratio" if key == "ratio" else "displacement"
        return tuple(
            DraggedPoint(f"point {place + 1}", quantity, phi1, value_key=f"{key}.{place}", value=value)
            for place, (phi1, value) in enumerate(zip(self.phi1, getattr(self, key), strict=True))
        )

    def transmission(self, linkage: Mechanism, lobes: Lobes) -> Transmission:
        """The law through the points."""
        import numpy as np

        # The splines of a table come from SciPy, which loads slowly.
        from ncgear.ratio.laws.table import displacement_table_law, ratio_table_law

        phi1 = np.array(self.phi1)
        if self.gives_slider:
            key = f"displacement_{linkage.OUTPUT.place.ending}"
            places = getattr(self, key)
            if places is None:
                wrong, does = given(self, VALUE_COLUMNS)[0], "turns" if linkage.OUTPUT.angular else "slides"
                problem = f"given, but the {linkage.OUTPUT.name} of {linkage.NAME} {does}; {key} is right"
                raise WrongInput(problem, key=f"motion.{wrong}")
            displacement = np.array(places) / linkage.OUTPUT.place.factor
            return displacement_table_law(phi1, displacement, linkage, lobes)
        return ratio_table_law(phi1, np.array(self.ratio), lobes, scale_to_close=self.scale_to_close)
