"""The formulas of a design; each is compared with the law's own numbers before it is told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import tau

import numpy as np

from ncgear.errors import Unanswered
from ncgear.formulas.laws import NoFormula, Sizes, mechanism, pieces_of
from ncgear.formulas.written import WrittenPiece
from ncgear.frozen import dataclass
from ncgear.mechanisms.driven_shaft import DrivenShaft
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.numerics.zeros import zeros_between
from ncgear.pitch import shape
from ncgear.pitch.shape import Gear, Mesh
from ncgear.ratio.transmission import Law, Transmission

AGREED = 1e-12
"""Largest relative difference from the law's numbers at which a formula is told: the law's own numbers keep to it."""

PLACES, FEWEST = 60, 3
"""Number of places of a law at which it is compared, and the least number for each of its pieces."""

TURN = (5.0**0.5 - 1.0) / 2.0
"""Step between places, as a share of a piece: by the golden ratio they are near no grid and no Chebyshev nodes."""

FROM_ZERO = {"x", "phi_2"}
"""Quantities that begin at zero, where rounding is as large as they are: compared relative to their greatest value."""


@dataclass(frozen=True, eq=False)
class FormulaPieces:
    """The pieces of the whole law, of one of its pairs, or of the mechanism; if there are none, ``why`` says why."""

    name: str
    pieces: tuple[WrittenPiece, ...]
    why: str = ""
    difference: float = 0.0


@dataclass(frozen=True, eq=False)
class Formulas:
    """The law of a design in closed form.

    ``unit`` is the unit of x, empty where there is no x.  The radii are in mm, or where ``sized`` is false, shares of
    the distance of the axes.
    """

    name: str
    law: str
    unit: str
    sized: bool
    sections: tuple[FormulaPieces, ...]

    @property
    def difference(self) -> float:
        """The greatest relative difference from the numbers of the law, at places that the law is not made from."""
        return max(section.difference for section in self.sections)

    def __repr__(self) -> str:
        told = ", ".join(f"{s.name}: {s.why or f'{len(s.pieces)} pieces'}" for s in self.sections)
        return f"Formulas({self.law}; {told}; within {self.difference:.1g} of the numbers)"


def formulas_of(name: str, kind: str, law: Law, sizes: Sequence[Sizes | None]) -> Formulas:
    """The formulas of a law, of each of its pairs where there are two, and of its mechanism.

    ``kind`` is the law's name; ``sizes`` has the sizes of each pair, None where the pair has none.  Raises Unanswered
    where a formula and the law's numbers differ.
    """
    linkage, whole, pairs = law.linkage, law.transmission, law.train.pairs
    sections = [_section("law", whole, whole, linkage, (sizes[0] or Sizes()) if len(pairs) == 1 else None)]
    if len(pairs) > 1:
        for number, (pair, size) in enumerate(zip(pairs, sizes, strict=True)):
            over = pair.transmission if number else whole
            sections.append(_section(f"stage {number + 1}", pair.transmission, over, None, size or Sizes()))
    unit = ""
    if not isinstance(linkage, DrivenShaft):
        covered = whole.lobes.range
        made = mechanism(linkage, covered.driven_rad if covered else tau)
        section = FormulaPieces("mechanism", (made,))
        sections.append(replace(section, difference=_mechanism_missed(made, linkage)))
        unit = "rad" if linkage.OUTPUT.angular else "mm"
    return Formulas(name, kind, unit, all(sizes), tuple(sections))


def _section(
    name: str, law: Transmission, over: Transmission, linkage: Mechanism | None, size: Sizes | None
) -> FormulaPieces:
    """The pieces of a law, compared; ``over`` is the law whose driven angle is phi_2."""
    try:
        pieces = tuple(pieces_of(law.pieces, linkage, size))
    except NoFormula as none:
        return FormulaPieces(name, (), str(none))
    return FormulaPieces(name, pieces, difference=missed(pieces, law, over, linkage, size))


def places_of(piece: WrittenPiece, count: int) -> Array:
    """Places inside a piece, shape (n,); no law is made from them."""
    share = np.arange(1.0, count + 1.0) * TURN % 1.0
    return piece.start_rad + (piece.end_rad - piece.start_rad) * share


def missed(
    pieces: Sequence[WrittenPiece], law: Transmission, over: Transmission, linkage: Mechanism | None, size: Sizes | None
) -> float:
    """The greatest relative difference of pieces from the law; raises Unanswered where it is over AGREED."""
    count = max(FEWEST, PLACES // len(pieces))
    phi1 = np.concatenate([places_of(piece, count) for piece in pieces])
    if str(pieces[0].variable) == "phi_2":
        low = np.zeros_like(phi1)
        wanted, high = phi1, low + law.lobes.driving_period_rad
        phi1 = zeros_between(lambda at: over.driven_angle(at).value - wanted, low, high)
    turned, own = over.driven_angle(phi1).value, law.driven_angle(phi1, 1)
    slope = Jet(own.derivative(1)[None, :])
    numbers = {"phi_2": own.value, "i_12": 1.0 / slope.value}
    if size is not None:
        mesh = Mesh.INTERNAL if size.sense > 0 else Mesh.EXTERNAL
        for name, gear in (("r_1", Gear.DRIVING), ("r_2", Gear.DRIVEN)):
            numbers[name] = size.center_distance * shape.radius(slope, gear, mesh).value
    if linkage is not None:
        numbers["x"] = linkage.displacement(Jet(turned[None, :])).value
    at = phi1 if str(pieces[0].variable) == "phi_1" else turned
    return _greatest(pieces, at, numbers)


def _mechanism_missed(piece: WrittenPiece, linkage: Mechanism) -> float:
    at = places_of(piece, PLACES)
    return _greatest([piece], at, {"x": linkage.displacement(Jet(at[None, :])).value})


def _greatest(pieces: Sequence[WrittenPiece], at: Array, numbers: dict[str, Array]) -> float:
    """The greatest difference of pieces from numbers at places, the same number of places in each piece."""
    worst, count = 0.0, at.size // len(pieces)
    for number, piece in enumerate(pieces):
        here = slice(number * count, (number + 1) * count)
        for name, values in piece.values(at[here].tolist()).items():
            wanted = numbers[name]
            scale = np.full_like(wanted, np.abs(wanted).max()) if name in FROM_ZERO else np.abs(wanted)
            off = [float(abs(value - right)) for value, right in zip(values, wanted[here].tolist(), strict=True)]
            difference = float(np.max(np.array(off) / scale[here]))
            if not difference <= AGREED:
                raise Unanswered(
                    f"the formula of {name} on the piece {piece.name!r} and the numbers of the law differ by "
                    f"{difference:.3g} of these, over {AGREED:g}; so it is not told",
                    key="motion",
                )
            worst = max(worst, difference)
    return worst
