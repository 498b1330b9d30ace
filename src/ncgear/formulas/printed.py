"""Formulas as text: to read, for LaTeX, and as a file of Python, C or MATLAB with a function for each quantity."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import pi
from typing import Any

import sympy

from ncgear.formulas.checked import Formulas, Section
from ncgear.formulas.written import QUANTITIES, Written, symbol
from ncgear.frozen import dataclass


def printed(formulas: Formulas, form: str) -> str:
    """The formulas as text, latex, python, c or matlab, without a line break at the end."""
    if form == "text":
        return "\n\n".join(["\n".join(_head(formulas)), *_blocks(formulas, _text_block)])
    if form == "latex":
        head = "\n".join(f"% {line}" for line in _head(formulas))
        return "\n\n".join([head, *_blocks(formulas, _latex_block)])
    return _source(formulas, LANGUAGES[form])


def figures(formulas: Formulas) -> dict[str, Any]:
    """The formulas for programs: numbers as they are, expressions as text of Python's grammar."""
    return {
        "name": formulas.name,
        "law": formulas.law,
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
    return [
        f"{formulas.name}: the law {formulas.law} in closed form; angles in rad, x in {formulas.unit}, {radii}",
        f"The formulas differ from the numbers of the law by {formulas.difference:.1g} of these at most.",
        *(f"{section.name}: no closed form, since {section.why}" for section in formulas.sections if section.why),
    ]


def _blocks(formulas: Formulas, block: Callable[[str, Written], str]) -> Iterator[str]:
    for section in formulas.sections:
        for piece in section.pieces:
            named = section.name if section.name == piece.name else f"{section.name}, {piece.name}"
            yield block(named, piece)


def _named(piece: Written) -> dict[Any, float]:
    """The numbers that have other names than their digits."""
    return {one: value for one, value in _named(piece).items() if not str(one)[0].isdigit()}


def _angle(value: float, times: str) -> str:
    """An angle in rad, as a multiple of pi where a short one is it exactly."""
    share = f"{value / pi:.12g}"
    if float(share) * pi != value:
        return repr(value)
    if share == "0":
        return share
    return "pi" if share == "1" else f"{share}{times}pi"


def _text_block(named: str, piece: Written) -> str:
    ends = f"{_angle(piece.start_rad, '*')} <= {piece.variable} <= {_angle(piece.end_rad, '*')}"
    lines = [f"{name} = {value!r}" for name, value in _named(piece).items()]
    lines += [f"{name} = {step}" for name, step in piece.steps.items()]
    lines += [f"no {name}: {why}" for name, why in piece.without.items()]
    return "\n".join([f"{named}: {ends}", *(f"  {line}" for line in lines)])


def _latex_block(named: str, piece: Written) -> str:
    def name(one: Any) -> str:
        """Words upright, derivatives as quotients, exponents of ten as such."""
        text, by = str(one), str(piece.variable)
        if text[0].isdigit():
            digits, _, exponent = text.partition("e")
            return f"{digits} \\cdot 10^{{{int(exponent)}}}" if exponent else digits
        if text.startswith("d") and symbol(text[1:]) in piece.steps:
            return rf"\frac{{\mathrm{{d}} {name(text[1:])}}}{{\mathrm{{d}} {name(by)}}}"
        word, _, index = text.partition("_")
        letter = f"\\{word}" if word in {"phi", "theta", "tau", "delta"} else word
        letter = letter if len(word) == 1 or letter != word else rf"\mathrm{{{word}}}"
        return f"{letter}_{{{index}}}" if index else letter

    def written(expression: Any) -> str:
        return str(sympy.latex(expression, symbol_names={one: name(one) for one in expression.free_symbols}))

    lines = [
        f"{name(one)} &= {name(f'{abs(v)!r}') if v >= 0 else f'-{name(repr(-v))}'}" for one, v in _named(piece).items()
    ]
    lines += [f"{name(one)} &= {written(step)}" for one, step in piece.steps.items()]
    lines += [
        f"&\\text{{no }} {name(one)} \\text{{: {why.replace('_', chr(92) + '_')}}}"
        for one, why in piece.without.items()
    ]
    ends = rf"{_angle(piece.start_rad, ' ')} \le {name(piece.variable)} \le {_angle(piece.end_rad, ' ')}"
    ends = ends.replace(" pi", r" \pi")
    body = " \\\\\n".join([rf"&\text{{{named}: }} {ends}", *lines])
    return f"\\begin{{align*}}\n{body}\n\\end{{align*}}"


@dataclass(frozen=True)
class Language:
    """How a language writes a file of functions of one angle."""

    expression: Callable[[Any], str]
    comment: str
    begin: Callable[[str, list[str]], list[str]]
    """The beginning of the file, from the name of the design and those of the functions."""

    function: Callable[[str, str], str]
    refuse: Callable[[str], str]
    """The statement that says why there is no value."""

    when: Callable[[str], str]
    assign: Callable[[str, str], str]
    result: Callable[[str], list[str]]
    end: str = ""


def _python_begin(name: str, functions: list[str]) -> list[str]:
    return ["import math", ""]


def _c_begin(name: str, functions: list[str]) -> list[str]:
    return ["#include <math.h>", ""]


def _matlab_begin(name: str, functions: list[str]) -> list[str]:
    handles = ", ".join(f"'{one}', @{one}" for one in functions)
    identifier = "".join(letter if letter.isalnum() else "_" for letter in name)
    return [
        f"function value = law_of_{identifier}(quantity, angle)",
        f"    functions = struct({handles});",
        "    value = functions.(quantity)(angle);",
        "end",
        "",
    ]


LANGUAGES = {
    "python": Language(
        lambda step: str(sympy.pycode(step)),
        "#",
        _python_begin,
        lambda name, angle: f"def {name}({angle}):",
        lambda why: f"raise ValueError({why!r})",
        lambda condition: f"if {condition}:",
        lambda name, value: f"{name} = {value}",
        lambda name: [f"return {name}"],
    ),
    "c": Language(
        lambda step: str(sympy.ccode(step)),
        "//",
        _c_begin,
        lambda name, angle: f"double {name}(double {angle}) {{",
        lambda why: f"return NAN; // {why}",
        lambda condition: f"if ({condition}) {{",
        lambda name, value: f"const double {name} = {value};",
        lambda name: [f"return {name};"],
        "}",
    ),
    "matlab": Language(
        lambda step: str(sympy.octave_code(step)),
        "%",
        _matlab_begin,
        lambda name, angle: f"function value = {name}({angle})",
        lambda why: f"error('{why}')",
        lambda condition: f"if {condition}",
        lambda name, value: f"{name} = {value};",
        lambda name: [f"value = {name};", "return"],
        "end",
    ),
}


def functions_of(section: Section) -> dict[str, str]:
    """The names of the functions of a section, and the quantity of each."""
    if not section.pieces:
        return {}
    stage = section.name.replace(" ", "_") + "_" if section.name.startswith("stage") else ""
    over = "_of_driven_angle" if str(section.pieces[0].variable) == "phi_2" else ""
    told = [name for name in QUANTITIES if any(name in piece.quantities for piece in section.pieces)]
    return {f"{stage}{QUANTITIES[name]}{over}": name for name in told}


def _source(formulas: Formulas, language: Language) -> str:
    names = [(name, of, section) for section in formulas.sections for name, of in functions_of(section).items()]
    head = [f"{language.comment} {line}" for line in _head(formulas)]
    parts = [line for one in names for line in _function(language, *one)]
    begin = language.begin(formulas.name, [name for name, _, _ in names])
    return "\n".join([*head, "", *begin, *parts]).rstrip()


def _function(language: Language, name: str, of: str, section: Section) -> Iterator[str]:
    """A function of one angle, piece after piece; a quantity without closed form on a piece is refused there."""
    first, last = section.pieces[0], section.pieces[-1]
    angle = str(first.variable)
    yield language.function(name, angle)
    within = f"the angle lies outside {first.start_rad!r} to {last.end_rad!r} rad"
    yield from _block(language, f"{angle} < {first.start_rad!r}", [language.refuse(within)])
    for piece in section.pieces:
        before = f"{angle} <= {piece.end_rad!r}" if piece is last else f"{angle} < {piece.end_rad!r}"
        yield from _block(language, before, _body(language, piece, of))
    yield f"    {language.refuse(within)}"
    yield from [language.end, ""] if language.end else [""]


def _block(language: Language, condition: str, body: list[str]) -> Iterator[str]:
    yield f"    {language.when(condition)}"
    yield from (f"        {line}" for line in body)
    if language.end:
        yield f"    {language.end}"


def _body(language: Language, piece: Written, of: str) -> list[str]:
    if of not in piece.quantities:
        return [language.refuse(piece.without[of])]
    values = {one: repr(value) for one, value in _named(piece).items()}
    steps = {one: language.expression(step) for one, step in piece.steps.items()}
    lines = [language.assign(str(one), (values | steps)[one]) for one in piece.needed(of) if one in values | steps]
    return [*lines, *language.result(of)]
