"""The formulas of a design, each compared with the law's own numbers before it is told: text, LaTeX, programs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import pi, tau
from typing import Any

import numpy as np
import sympy

from ncgear.errors import Unanswered
from ncgear.formulas.laws import NoFormula, Sizes, is_first_of_two, mechanism, pieces_of
from ncgear.formulas.written import QUANTITIES, WrittenPiece, symbol
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
            over = whole if is_first_of_two(pair.transmission.pieces) else pair.transmission
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


def printed(formulas: Formulas, form: str) -> str:
    """The formulas as text, latex, python, c or matlab, without a line break at the end."""
    if form == "text":
        return "\n\n".join(["\n".join(_head(formulas)), *_blocks(formulas, _text_block)])
    if form == "latex":
        head = "\n".join(f"% {line}" for line in _head(formulas))
        return "\n\n".join([head, *_blocks(formulas, _latex_block)])
    return _source(formulas, LANGUAGES[form])


def figures(formulas: Formulas) -> dict[str, Any]:
    """The formulas for programs: numbers as numbers, expressions as text in Python's grammar."""
    return {
        "name": formulas.name,
        "law": formulas.law,
        "displacement_unit": formulas.unit,
        "radii_unit": "mm" if formulas.sized else "distance of the axes",
        "difference": formulas.difference,
        "sections": [
            {
                "name": section.name,
                **({"without": section.why} if section.why else {}),
                "pieces": [
                    {
                        "name": piece.name,
                        "variable": str(piece.variable),
                        "start_rad": piece.start_rad,
                        "end_rad": piece.end_rad,
                        "numbers": {str(name): value for name, value in _named(piece).items()},
                        "steps": {str(name): str(step) for name, step in piece.steps.items()},
                        "without": dict(piece.without),
                    }
                    for piece in section.pieces
                ],
            }
            for section in formulas.sections
        ],
    }


def _head(formulas: Formulas) -> list[str]:
    radii = "radii in mm" if formulas.sized else "radii as shares of the distance of the axes"
    units = ", ".join(["angles in rad", *([f"x in {formulas.unit}"] if formulas.unit else []), radii])
    return [
        f"{formulas.name}: the law {formulas.law} in closed form; {units}",
        f"The formulas differ from the numbers of the law by {formulas.difference:.1g} of these at most.",
        *(f"{section.name}: no closed form, since {section.why}" for section in formulas.sections if section.why),
    ]


def _blocks(formulas: Formulas, block: Callable[[str, WrittenPiece], str]) -> Iterator[str]:
    for section in formulas.sections:
        for piece in section.pieces:
            named = section.name if section.name == piece.name else f"{section.name}, {piece.name}"
            yield block(named, piece)


def _named(piece: WrittenPiece) -> dict[Any, float]:
    """The numbers whose names are not their digits."""
    return {name: value for name, value in piece.numbers.items() if not str(name)[0].isdigit()}


def _angle(value: float, times: str) -> str:
    """An angle in rad, as a multiple of pi where a short multiple equals it exactly."""
    share = f"{value / pi:.12g}"
    if float(share) * pi != value:
        return repr(value)
    if share == "0":
        return share
    return "pi" if share == "1" else f"{share}{times}pi"


def _text_block(named: str, piece: WrittenPiece) -> str:
    ends = f"{_angle(piece.start_rad, '*')} <= {piece.variable} <= {_angle(piece.end_rad, '*')}"
    lines = [f"{name} = {value!r}" for name, value in _named(piece).items()]
    lines += [f"{name} = {step}" for name, step in piece.steps.items()]
    lines += [f"no {name}: {why}" for name, why in piece.without.items()]
    return "\n".join([f"{named}: {ends}", *(f"  {line}" for line in lines)])


def _latex_block(named: str, piece: WrittenPiece) -> str:
    names = {name: _latex_name(str(name), piece) for name in (piece.variable, *piece.numbers, *piece.steps)}
    first, last = (_angle(end, " ").replace("pi", r"\pi") for end in (piece.start_rad, piece.end_rad))
    lines = [rf"&\text{{{named}: }} {first} \le {names[piece.variable]} \le {last}"]
    lines += [f"{names[name]} &= {_latex_number(repr(value))}" for name, value in _named(piece).items()]
    lines += [f"{names[name]} &= {sympy.latex(step, symbol_names=names)}" for name, step in piece.steps.items()]
    whys = [f"no {name}: {why}".replace("_", r"\_") for name, why in piece.without.items()]
    body = " \\\\\n".join([*lines, *(rf"&\text{{{why}}}" for why in whys)])
    return f"\\begin{{align*}}\n{body}\n\\end{{align*}}"


def _latex_name(name: str, piece: WrittenPiece) -> str:
    """A name in LaTeX: words upright, derivatives as quotients."""
    if name[0].isdigit():
        return _latex_number(name)
    if name.startswith("d") and symbol(name[1:]) in piece.steps:
        over, under = (_latex_name(part, piece) for part in (name[1:], str(piece.variable)))
        return rf"\frac{{\mathrm{{d}} {over}}}{{\mathrm{{d}} {under}}}"
    word, _, index = name.partition("_")
    letter = f"\\{word}" if word in GREEK else word if len(word) == 1 else rf"\mathrm{{{word}}}"
    return f"{letter}_{{{index}}}" if index else letter


GREEK = {"phi", "theta", "tau", "delta"}


def _latex_number(digits: str) -> str:
    mantissa, _, exponent = digits.partition("e")
    return rf"{mantissa} \cdot 10^{{{int(exponent)}}}" if exponent else mantissa


@dataclass(frozen=True)
class Language:
    """How a language writes a file of functions of one angle: templates of its statements."""

    expression: Callable[[Any], str]
    begin: str
    comment: str
    function: str
    refuse: str
    """The statement that says why there is no value."""

    when: str
    assign: str
    result: str
    end: str = ""


LANGUAGES = {
    "python": Language(
        sympy.pycode,
        "import math\n",
        comment="#",
        function="def {name}({angle}):",
        refuse='raise ValueError("{why}")',
        when="if {condition}:",
        assign="{name} = {value}",
        result="return {name}",
    ),
    "c": Language(
        sympy.ccode,
        "#include <math.h>\n",
        comment="//",
        function="double {name}(double {angle}) {{",
        refuse="return NAN; // {why}",
        when="if ({condition}) {{",
        assign="const double {name} = {value};",
        result="return {name};",
        end="}",
    ),
    "matlab": Language(
        sympy.octave_code,
        "function value = law_in_closed_form(quantity, angle)\n    functions = struct({handles});\n"
        "    value = functions.(quantity)(angle);\nend\n",
        comment="%",
        function="function value = {name}({angle})",
        refuse="error('{why}')",
        when="if {condition}",
        assign="{name} = {value};",
        result="value = {name}; return",
        end="end",
    ),
}


def functions_of(section: FormulaPieces) -> dict[str, str]:
    """The names of the functions of a section, and the quantity that each gives."""
    if not section.pieces:
        return {}
    stage = section.name.replace(" ", "_") + "_" if section.name.startswith("stage") else ""
    over = "_of_driven_angle" if str(section.pieces[0].variable) == "phi_2" else ""
    told = [name for name in QUANTITIES if any(name in piece.quantities for piece in section.pieces)]
    return {f"{stage}{QUANTITIES[name]}{over}": name for name in told}


def _source(formulas: Formulas, language: Language) -> str:
    functions = [(name, of, section) for section in formulas.sections for name, of in functions_of(section).items()]
    handles = ", ".join(f"'{name}', @{name}" for name, _, _ in functions)
    head = [*(f"{language.comment} {line}" for line in _head(formulas)), ""]
    parts = [line for function in functions for line in _function(language, *function)]
    return "\n".join([*head, language.begin.replace("{handles}", handles), *parts]).rstrip()


def _function(language: Language, name: str, of: str, section: FormulaPieces) -> Iterator[str]:
    """A function of one angle, piece after piece; on pieces without a closed form it raises an error."""
    first, last = section.pieces[0], section.pieces[-1]
    angle = str(first.variable)
    beyond = language.refuse.format(why=f"the angle lies outside {first.start_rad!r} to {last.end_rad!r} rad")
    yield language.function.format(name=name, angle=angle)
    yield from _block(language, f"{angle} < {first.start_rad!r}", [beyond])
    for piece in section.pieces:
        before = f"{angle} {'<=' if piece is last else '<'} {piece.end_rad!r}"
        yield from _block(language, before, _body(language, piece, of))
    yield f"    {beyond}"
    yield from [language.end, ""] if language.end else [""]


def _block(language: Language, condition: str, body: list[str]) -> Iterator[str]:
    yield f"    {language.when.format(condition=condition)}"
    yield from (f"        {line}" for line in body)
    if language.end:
        yield f"    {language.end}"


def _body(language: Language, piece: WrittenPiece, of: str) -> list[str]:
    if of not in piece.quantities:
        return [language.refuse.format(why=piece.without[of])]
    values = {name: repr(value) for name, value in _named(piece).items()}
    needed = [name for name in piece.needed(of) if name in values or name in piece.steps]
    lines = [(name, values[name] if name in values else language.expression(piece.steps[name])) for name in needed]
    return [*(language.assign.format(name=name, value=value) for name, value in lines), language.result.format(name=of)]
