"""Designs of a kind that are computed together: a few written designs, and columns of numbers that differ from them.

A row that differs from a written design only in columns of a batch needs no model.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from ncgear.design.keys.base import Model, key_of
from ncgear.design.keys.design import Design
from ncgear.design.laws import three_segment_stroke
from ncgear.design.laws.harmonic_ratio import HarmonicRatio
from ncgear.design.mechanisms import entry_of, lengths_of
from ncgear.design.words import UNITS, spellings
from ncgear.dynamics.crank_load import crank_angles_rad
from ncgear.dynamics.sampled_shafts import CrankTable, crank_table
from ncgear.errors import DesignError, WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import Masses
from ncgear.mechanisms.mechanism import Mechanism, Mechanisms, Output
from ncgear.mechanisms.resistance import Resistance, TableResistance
from ncgear.numerics.arrays import Array, IndexArray, Mask
from ncgear.project.law import load_of, lobes_of
from ncgear.project.moving import masses_of, stated_inertia, states_inertia
from ncgear.ratio.transmission import Lobes

STROKE, HARMONIC = "three_segment_stroke", "harmonic_ratio"

COLUMNS = {"linkage", "operation.speed_rpm", "gears.teeth", "gears.module_mm", "gears.center_distance_mm"}
"""Keys, or groups of keys, whose numbers a batch of any law reads as columns."""

LAW_COLUMNS = {
    STROKE: {
        *(f"motion.{name}" for number in (1, 2, 3, 4) for name in spellings(f"theta{number}")),
        *(
            f"motion.{name}"
            for name in ("v1_mm_s", "v2_mm_s", "a1_mm_s2", "a1_speed_rpm", "law_speed_rpm", "stroke_mm")
        ),
        "motion.return.e",
    },
    HARMONIC: {"motion.cosine", "motion.sine"},
}
"""Further columns of a batch by its law."""


@dataclass(frozen=True)
class BatchKind:
    """The common properties of the designs of a batch; ``linkage`` is the model of its mechanism's keys."""

    linkage: type[Model]
    law: tuple[Hashable, ...]
    lobes: Lobes
    resistance: Resistance
    masses: Masses | None

    @property
    def has_return(self) -> bool:
        """Whether a polynomial return closes the laws."""
        return self.law[0] == STROKE

    def reads(self, key: str) -> bool:
        """Whether a batch reads the numbers at a key of the file as a column."""
        known = COLUMNS | LAW_COLUMNS[str(self.law[0])]
        return key in known or key.rpartition(".")[0] in known


def kind_of(design: Design) -> BatchKind | None:
    """The kind of batch of a design; None where the design must be computed alone."""
    law, entry = _law(design), entry_of(design.linkage)
    # Batches know outputs that slide and return.
    if law is None or entry.turns or not entry.load().RETURNS:
        return None
    if design.gears is not None and design.gears.mesh == "internal":
        return None
    load, given, around = load_of(design), design.masses, design.drivetrain
    made = given is not None and design.gears is not None and not states_inertia(given, design.stages)
    # Only a single computation makes the bodies of gears, and counts a guide that rubs.
    if made or (given is not None and around is not None and around.guide_friction):
        return None
    if load.loads_return or isinstance(load.working, TableResistance):
        # Batches know the displacement in the working stroke only.  The bend of a table's force jumps at its points,
        # which no series along a piece resolves.
        return None
    masses = None if given is None else masses_of(given, entry.load(), stated_inertia(given))
    return BatchKind(type(design.linkage), law, lobes_of(design), load.working, masses)


def _law(design: Design) -> tuple[Hashable, ...] | None:
    motion = design.motion
    if isinstance(motion, three_segment_stroke.ThreeSegmentStroke):
        found, inverse = motion.return_.e == "least_acceleration", motion.return_.basis == "inverse_ratio"
        if motion.turns or motion.solve_for == "stroke" or found or inverse:
            return None
        return STROKE, motion.solve_for, motion.a1_speed_rpm is None, motion.stroke_mm is None
    if isinstance(motion, HarmonicRatio) and motion.second_stage is None and (motion.cosine or motion.sine):
        return (HARMONIC,)
    return None


@dataclass(frozen=True, eq=False)
class Batch:
    """n designs of a kind, which all give the same keys.

    ``follows`` (shape (n,)) numbers the ``written`` design of each row; ``columns`` (shape (n,) each) are the numbers
    at keys of the file that replace the numbers of that design.
    """

    kind: BatchKind
    written: tuple[Design, ...]
    follows: IndexArray
    columns: Mapping[str, Array]

    def __len__(self) -> int:
        return self.follows.size

    def kept(self, rows: IndexArray) -> Batch:
        """Some of the designs."""
        columns = {key: values[rows] for key, values in self.columns.items()}
        used, follows = np.unique(self.follows[rows], return_inverse=True)
        return replace(self, written=tuple(self.written[number] for number in used), follows=follows, columns=columns)

    def column(self, key: str) -> Array:
        """The numbers at a key, shape (n,)."""
        if key in self.columns:
            return self.columns[key]
        values = np.array([_value(design, key) for design in self.written], dtype=float)
        return values[self.follows]

    def given(self, key: str, unit: float = 1.0) -> Array | None:
        """The numbers at a key in a unit, shape (n,); None where the designs leave it out."""
        return None if _value(self.written[0], key) is None else self.column(key) * unit

    def angle_rad(self, name: str) -> Array:
        """An angle of the motion in rad, shape (n,), however its key spells it."""
        factors = {"rad": 1.0, "deg": np.pi / 180.0, "pi": np.pi}
        for unit in UNITS:
            if (key := f"motion.{name}_{unit}") in self.columns:
                return self.columns[key] * factors[unit]
        return np.array([getattr(design.motion, name) for design in self.written])[self.follows]

    def series(self, name: str) -> Array:
        """A list of numbers of the motion as rows, shape (n, longest list), padded with zeros."""
        lists = [getattr(design.motion, name) for design in self.written]
        rows = np.zeros((len(lists), max(map(len, lists))))
        for row, values in zip(rows, lists, strict=True):
            row[: len(values)] = values
        found: Array = rows[self.follows]
        for key, values in self.columns.items():
            group, _, place = key.rpartition(".")
            if group == f"motion.{name}":
                found[:, int(place)] = values
        return found

    def parts(self) -> list[IndexArray]:
        """The rows of batches that can be sampled together.

        Harmonic laws share one working angle; with masses, all designs have one mechanism.
        """
        rows = np.arange(len(self))
        if not len(self) or (self.kind.has_return and self.kind.masses is None):
            return [rows]
        with np.errstate(all="ignore"):
            same = [self.mechanisms.working_angle_rad] if self.kind.masses is None else [*self._lengths.values()]
        _, number = np.unique([np.broadcast_to(array, rows.shape) for array in same], axis=1, return_inverse=True)
        return [rows[number.ravel() == part] for part in range(number.max() + 1)]

    @property
    def _mechanism_class(self) -> type[Mechanism]:
        return entry_of(self.written[0].linkage).load()

    @property
    def output(self) -> Output:
        """The output of the mechanisms."""
        return self._mechanism_class.OUTPUT

    @cached_property
    def _lengths(self) -> dict[str, Array]:
        return {name: self.column(f"linkage.{name}") for name in lengths_of(self.written[0].linkage)}

    @cached_property
    def mechanisms(self) -> Mechanisms[Array]:
        """The mechanisms; a crank that cannot turn fully is not refused here."""
        with np.errstate(all="ignore"):
            return self._mechanism_class.many(**self._lengths)

    def _mechanism(self, row: int) -> Mechanism:
        return self._mechanism_class(**{name: float(values[row]) for name, values in self._lengths.items()})

    @cached_property
    def crank(self) -> CrankTable | None:
        """The load of masses on the cranks, which all belong to one mechanism; None without masses."""
        return None if self.kind.masses is None else crank_table(self._mechanism(0), self.kind.masses)

    @cached_property
    def kinks_mm(self) -> Array:
        """Displacements at which the force begins or ends, where masses add to it, shape (k,)."""
        if self.kind.masses is None or self.kind.resistance.keep_negative:
            return np.empty(0)
        return self.kind.resistance.zeros_mm(self._mechanism(0).stroke_mm)

    @cached_property
    def kinks_rad(self) -> Array:
        """Crank angles of the working stroke there."""
        return crank_angles_rad(self._mechanism(0), self.kinks_mm, returning=False)

    def refused_angles(self) -> dict[int, DesignError]:
        """Why theta1 to theta4 are out of order, by the rows."""
        angles = np.stack([self.angle_rad(name) for name in three_segment_stroke.THETAS])
        rising = (angles[0] > 0.0) & (angles[1] > angles[0]) & (angles[2] >= angles[1]) & (angles[3] > angles[2])
        refused: dict[int, DesignError] = {}
        for row in np.nonzero(~(rising & (angles[3] < 2.0 * np.pi)))[0].tolist():
            if (wrong := three_segment_stroke.out_of_order(angles[:, row].tolist())) is not None:
                name, problem = wrong
                key = key_of(self.written[0].motion, name)
                refused[row] = WrongInput(problem, key=f"motion.{key}")
        return refused

    def refused_mechanisms(self) -> dict[int, DesignError]:
        """Why cranks cannot turn, by the rows."""
        return refusals(~self.mechanisms.turns_fully, self._mechanism)

    def refused_strokes(self) -> dict[int, DesignError]:
        """The refusals of strokes in the file that no turning mechanism has, by the rows."""
        given = self.given("motion.stroke_mm")
        if given is None:
            return {}
        doubtful = ~np.isclose(given, self.mechanisms.stroke_mm, rtol=three_segment_stroke.SAME_STROKE / 2.0, atol=0.0)
        return refusals(
            doubtful & self.mechanisms.turns_fully,
            lambda row: three_segment_stroke.require_stroke_of(float(given[row]), self._mechanism(row)),
        )


def refusals(doubtful: Mask, require: Callable[[int], object]) -> dict[int, DesignError]:
    """The errors that a demand raises for doubtful rows, shape (n,); rows that meet it after all are left out.

    Tracebacks would keep the arrays of the batch.
    """
    refused: dict[int, DesignError] = {}
    for row in np.nonzero(doubtful)[0].tolist():
        try:
            require(row)
        except DesignError as error:
            refused[row] = error.with_traceback(None)
    return refused


def _value(design: Design, key: str) -> Any:
    """The value at a dotted key of a design; None for a missing key."""
    value: Any = design
    for part in key.split("."):
        value = value[int(part)] if isinstance(value, tuple) else getattr(value, part, getattr(value, f"{part}_", None))
    return value
