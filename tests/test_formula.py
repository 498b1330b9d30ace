"""Expressions in phi: values and derivatives against mpmath, and refusal of everything outside the whitelist."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp

from at_once import at_once
from later import Later
from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.numerics.formula import CHOICES, FUNCTIONS, LONGEST, composed
from ncgear.numerics.jet import Jet

sympy = Later("sympy")

KEY = "motion.ratio"
ORDER = 4
TIMES = int(os.environ.get("NCGEAR_FUZZ", "1"))
POINTS = np.array([0.1, 0.7, 1.3, 2.9, 5.0])

Function = Callable[[Any], Any]

EXPRESSIONS: dict[str, Function] = {
    "phi": lambda x: x,
    "3": lambda x: mp.mpf(3) + 0 * x,
    "1 + 0.3*cos(phi)": lambda x: 1 + mp.mpf(0.3) * mp.cos(x),
    "2 + 0.5*cos(phi) + 0.1*sin(2*phi)": lambda x: 2 + mp.mpf(0.5) * mp.cos(x) + mp.mpf(0.1) * mp.sin(2 * x),
    "1/(1 + 0.3*cos(phi - pi/4))": lambda x: 1 / (1 + mp.mpf(0.3) * mp.cos(x - mp.pi / 4)),
    "-phi**2 + 4": lambda x: 4 - x**2,
    "2**3**2 * phi": lambda x: 512 * x,
    "phi**-1": lambda x: 1 / x,
    "phi**0.5": mp.sqrt,
    "(1 + phi)**(1/3)": lambda x: mp.cbrt(1 + x),
    "1 - 2 - 3 + phi/2/2": lambda x: x / 4 - 4,
    "+phi - -phi": lambda x: 2 * x,
    "sin(cos(phi))": lambda x: mp.sin(mp.cos(x)),
    "tan(phi/8)": lambda x: mp.tan(x / 8),
    "exp(-phi**2/4)": lambda x: mp.exp(-(x**2) / 4),
    "log(2 + phi)": lambda x: mp.log(2 + x),
    "sqrt(1 + sin(phi)**2)": lambda x: mp.sqrt(1 + mp.sin(x) ** 2),
    "atan(3*phi)": lambda x: mp.atan(3 * x),
    "sinh(phi/3)*cosh(phi/3) - tanh(phi)": lambda x: mp.sinh(x / 3) * mp.cosh(x / 3) - mp.tanh(x),
    "1.5e-3*phi + 1e2 + .5": lambda x: mp.mpf(1.5e-3) * x + 100.5,
    " ( phi +\n 1 ) ": lambda x: x + 1,
}


def compiled(text: str, key: str) -> Callable[[Array, int], Jet]:
    """A function of phi and an order that returns the expression's jet."""
    formula = composed(text, key, "phi")
    return lambda points, order: formula(Jet.variable(points, order))


def exact_taylor(function: Function, points: Array) -> Array:
    """Taylor coefficients from mpmath, shape (ORDER + 1, n)."""
    with mp.workdps(40):
        return np.array([[float(c) for c in mp.taylor(function, mp.mpf(float(x)), ORDER)] for x in points]).T


def assert_series(text: str, function: Function, points: Array) -> None:
    """Value and derivatives: a few dozen operations, whose partial results may exceed the sum some hundred times."""
    found, exact = compiled(text, KEY)(points, ORDER).coefficients, exact_taylor(function, points)
    assert found.shape == exact.shape
    assert np.max(np.abs(found - exact) / (np.abs(exact).max(axis=0) + 1.0)) <= 1e-13


@pytest.mark.judges("design")
@at_once("text", EXPRESSIONS)
def test_values_and_derivatives(text: str) -> None:
    assert_series(text, EXPRESSIONS[text], POINTS)


def test_the_comparison_would_see_another_expression() -> None:
    with pytest.raises(AssertionError):
        assert_series("phi + 1e-12*phi**4", lambda x: x, POINTS)


@pytest.mark.parametrize("order", [0, 1, 5])
def test_the_order_is_the_one_asked_for(order: int) -> None:
    series = compiled("7", KEY)(POINTS, order)
    assert series.coefficients.shape == (order + 1, POINTS.size)
    assert not series.coefficients[1:].any()


@at_once("name", FUNCTIONS)
def test_every_listed_function_is_its_mathematical_namesake(name: str) -> None:
    function = getattr(mp, name)
    assert_series(f"{name}(0.2*phi + 0.1)", lambda x: function(mp.mpf(0.2) * x + mp.mpf(0.1)), POINTS)


@pytest.mark.parametrize(("text", "where"), [("1/(phi - 0.7)", 1), ("log(0.7 - phi)", 1), ("sqrt(phi - 1)", 0)])
def test_points_without_a_value_are_not_finite(text: str, where: int) -> None:
    """Laws refuse them by their angle; there must be neither a warning nor a number."""
    value = compiled(text, KEY)(POINTS, 2).value
    assert not np.isfinite(value[where])
    assert np.isfinite(value).any()


# --- a grammar of formulas, against mpmath and as sympy rewrites them ------------------------------------------------
#
# Every operation keeps values moderate and away from poles, so that a text says what it should give to 1e-12.

LEAVES = ("phi", "pi", "2", "3", "0.5", "1.25", "0.07", "1e-3", "(2*phi - 3)", "sin(phi)", "cos(3*phi)")
UNARY = (
    "-({0})", "sin({0})", "cos({0})", "atan({0})", "tanh({0})", "exp(-({0})**2)", "log(1.5 + ({0})**2)",
    "sqrt(0.5 + ({0})**2)", "sinh(atan({0}))", "cosh(sin({0}))", "tan(atan({0})/2)", "1/(1 + ({0})**2)",
    "(2 + sin({0}))**-1.5", "sqrt(({0})**2)", "(({0})**2)**0.5", "(({0})**4)**0.25", "(({0})**2)**1.5",
    "abs({0})", "sqrt(3*cosh(sin({0})))", "sqrt(2*(1 + ({0})**2))", "(4*exp(atan({0})))**0.5",
    "(8*(1 + ({0})**2))**(1/3)",
    "sqrt(({0})*({0}))", "sign({0})*({0})", "log(exp(sin({0})))", "(sin({0}) + 2)**3", "-(-({0}))",
)  # fmt: skip
BINARY = (
    "({0}) + ({1})", "({0}) - ({1})", "({0})*({1})", "({0})/(2 + ({1})**2)", "min({0}, {1})", "max({0}, {1})",
    "sqrt(({0})**2 + ({1})**2 + 0.1)", "abs(({0}) - ({1}))", "({0}) if ({0}) < ({1}) else ({1})",
    "({1}) if ({0}) >= ({1}) else 2*({0}) - ({1})", "sin({0})**2 + cos({0})**2 + ({1})", "({0})*2/({1} - ({1}) + 4)",
)  # fmt: skip

PLAIN: dict[str, Any] = {
    **{name: getattr(mp, name) for name in FUNCTIONS},
    "pi": mp.pi,
    "abs": abs,
    "min": min,
    "max": max,
    "sign": lambda x: -1 if x < 0 else 1,
}


def drawn(random: Random, depth: int) -> str:
    """A random formula of the grammar."""
    if depth == 0 or random.random() < 0.1:
        return random.choice(LEAVES)
    form = random.choice(UNARY if random.random() < 0.6 else BINARY)
    return form.format(drawn(random, depth - 1), drawn(random, depth - 1))


def written(text: str, point: float) -> Any:
    """What the text says, read by Python and computed by mpmath; numbers are the floating-point ones."""
    return eval(re.sub(r"(?<![\w.])(\d+(?:\.\d+)?(?:e-?\d+)?)", r"number(\1)", text), PLAIN | names_at(point))


def names_at(point: float) -> dict[str, Any]:
    return {"number": mp.mpf, "phi": mp.mpf(point), "__builtins__": {}}


def assert_says(text: str, point: float) -> None:
    """The value, and the slope unless a kink may be near; some ten operations, each as good as its size."""
    found = compiled(text, KEY)(np.array([point]), 1).coefficients[:, 0]
    with mp.workdps(40):
        exact = written(text, point)
        step = mp.mpf(10) ** -15
        sides = [(written(text, mp.mpf(point) + side * step) - exact) / (side * step) for side in (1, -1)]
    # How much a rounding error of the argument or of a constant counts: by the slope, and by the size.
    assert abs(found[0] - float(exact)) <= 1e-12 * (1.0 + abs(float(exact)) + abs(float(sides[0]))), text
    if abs(sides[0] - sides[1]) <= 1e-9 * (1.0 + abs(sides[0])):
        assert abs(found[1] - float(sides[0])) <= 1e-8 * (1.0 + abs(float(sides[0]))), text


def rewritten(text: str) -> list[str]:
    """The same formula as sympy writes it, where the grammar has words for it."""
    phi = sympy.Symbol("phi", real=True)
    names = {"abs": sympy.Abs, "min": sympy.Min, "max": sympy.Max, "sign": sympy.sign, "phi": phi}
    try:
        whole = sympy.sympify(text, locals=names)
    except TypeError:  # a condition
        return []
    forms = (whole, sympy.expand(whole), sympy.together(whole), sympy.powdenest(whole))
    texts = {sympy.sstr(form).replace("Abs", "abs").replace("Min", "min").replace("Max", "max") for form in forms}
    known = {"phi", "pi", *FUNCTIONS, *CHOICES}
    return [text for text in texts if len(text) <= LONGEST and set(re.findall(r"[A-Za-z_]\w*", text)) <= known]


def judge_formulas(count: int, number: int) -> int:
    """Draws formulas and holds them, and what sympy makes of them, against mpmath; how many rewritten ones."""
    random, others = Random(number), 0
    for _ in range(count):
        text, point = drawn(random, random.choice((2, 3))), random.uniform(0.1, 6.2)
        if len(text) > LONGEST:
            continue
        assert_says(text, point)
        for other in rewritten(text) if len(text) < 80 else []:
            try:
                assert_says(other, point)
            except WrongInput as refusal:
                assert re.search("takes two arguments|not a finite real|a power must", refusal.problem), other
                continue
            others += other != text
    return others


@pytest.mark.slow
def test_formulas_say_what_they_say_however_they_are_written() -> None:
    assert judge_formulas(40, 1) >= 20


@pytest.mark.slow
@pytest.mark.attack
def test_many_formulas_say_what_they_say_however_they_are_written() -> None:
    assert judge_formulas(600 * TIMES, 2) >= 200


@pytest.mark.parametrize(("text", "other"), [("sqrt(phi**2 - 6*phi + 9)", "phi - 3"), ("abs(phi)", "phi + 1e-9")])
def test_the_judge_sees_another_formula(text: str, other: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(globals(), "written", lambda _, point: eval(other, PLAIN | {"phi": mp.mpf(point)}))
    with pytest.raises(AssertionError):
        assert_says(text, 2.0)


REFUSED = [
    # attributes, subscripts, calls of anything else
    "phi.__class__",
    "phi.__class__.__bases__[0]",
    "(1).__class__",
    "phi[0]",
    "phi(1)",
    "pi(phi)",
    "round(phi)",
    "eval(phi)",
    "__import__('os')",
    "sin.__call__(phi)",
    "(lambda: phi)()",
    "getattr(phi, 'name')",
    # wrong number or kind of arguments
    "abs()",
    "abs(phi, 1)",
    "min(phi)",
    "max(phi, 1, 2)",
    "max(*[phi, 1])",
    "min(phi, 1, key=abs)",
    "sign(phi)(phi)",
    "sin()",
    "sin(phi, phi)",
    "sin(x=phi)",
    "sin(phi, x=1)",
    "sin(phi, **{})",
    "sin(*[phi])",
    "sin(**{})",
    "sin(sin)",
    # names
    "x",
    "sin",
    "e",
    "nan",
    "inf",
    "I",
    "__builtins__",
    "None",
    "True",
    "phi + False",
    # other literals and constructs
    "'phi'",
    "f'{phi}'",
    "b'1'",
    "1j",
    "...",
    "[phi]",
    "(phi, 1)",
    "{phi}",
    "{}",
    "[phi for phi in (1,)]",
    "(phi for phi in (1,))",
    "lambda: 1",
    "(phi := 3)",
    "phi if phi else 1",
    "phi and 1",
    "not phi",
    "phi < 1",
    "phi == 1",
    "phi // 2",
    "phi % 2",
    "phi @ phi",
    "phi ^ 2",
    "phi | 1",
    "phi << 3",
    "~phi",
    "await phi",
    "yield phi",
    # not one expression
    "",
    "   ",
    "phi;1",
    "phi\n+1",
    "phi = 1",
    "import os",
    "phi +",
    "2phi",
    "phi phi",
    "phi!",
    "$",
    "phi\x00",
    "((phi)",
    # powers that are not numbers of moderate size
    "phi**phi",
    "2**phi",
    "phi**65",
    "phi**-65",
    "phi**64**2",
    "9**9**9",
    "9**9**9**9",
    "(2**64)**64",
    "((2**64)**64)**64",
    "10**300*10**300",
    "phi**exp(1000)",
    "phi**exp(exp(exp(9)))",
    "(-1)**0.5",
    "(-8)**(1/3)",
    "0**-1",
    # division by zero, infinite numbers
    "1/0",
    "phi/0",
    "1/(1 - 1)",
    "1/(phi - phi)",
    "1/sin(0)",
    "phi**(1/0)",
    "1e400",
    "phi + 1e999",
    # unicode
    "π",
    "φ",
    "рhi",  # noqa: RUF001  (the first letter is Cyrillic)
    "phi − 1",  # noqa: RUF001  (a minus sign)
    "phi\u00b2",
    "\u202ephi",
    "\ud800",
    # depth and length
    "(" * 450 + "phi" + ")" * 450,
    "(" * 1000 + "phi" + ")" * 1000,
    "-" * 900 + "phi",
    "~" * 900 + "phi",
    "phi" + "()" * 490,
    "phi" + ".real" * 190,
    "1 if " * 100 + "phi < 1" + " else 2" * 100,
    "abs(" * 60 + "phi" + ")" * 60,
    # conditions
    "1 if phi else 2",
    "1 if phi == 2 else 3",
    "1 if 1 < phi < 2 else 3",
    "1 if phi < 2 and phi > 1 else 3",
    "1 if phi != 1 else 3",
    "1 if phi < x else 3",
    "sin(" * 60 + "phi" + ")" * 60,
    # constants that are not real and finite, wherever they arise
    "9" * 400,
    "log(0) + phi",
    "2**tan(pi/2)",
    "phi**sqrt(-1)",
    "phi**log(0)",
    "sqrt(-1)*phi",
    "atan(sqrt(-1)) + phi",
    "log(-1) + phi",
    "phi+" * 2500,
    "9" * 10_000,
    "x" * 1000,
]


@at_once("text", REFUSED)
def test_anything_else_is_refused_by_its_key(text: str) -> None:
    with pytest.raises(WrongInput) as caught:
        compiled(text, "motion.driven_angle")
    assert caught.value.key == "motion.driven_angle"
    assert caught.value.exit_status == 2
    assert len(caught.value.problem) < 3000


@at_once(
    ("text", "named"),
    [
        ("phi + foo", "'foo'"),
        ("acos(phi)", "'acos'"),
        ("phi.real", "'phi.real'"),
        ("phi**99", "'99'"),
        ("phi/0", "division by zero"),
        ("1" * 1001, "1001 characters"),
    ],
)
def test_refusals_name_what_is_wrong(text: str, named: str) -> None:
    with pytest.raises(WrongInput) as caught:
        compiled(text, KEY)
    assert named in caught.value.problem


LONG = {
    "sum": ("1" + "+1" * 490, lambda phi: 491.0 + 0.0 * phi),
    "sum of terms": ("phi" + "+phi" * 240, lambda phi: 241.0 * phi),
    "big whole constants": ("phi + sqrt((10**14 + 31)*(10**14 + 67))", lambda phi: phi + 1e14 + 49.0),
}


@pytest.mark.parametrize("name", LONG)
def test_long_is_not_deep(name: str) -> None:
    text, function = LONG[name]
    assert compiled(text, KEY)(POINTS, 1).value == pytest.approx(function(POINTS), rel=1e-14)


@pytest.mark.parametrize(
    "text",
    ["*".join(f"(1+0.1*sin({k + 1}*phi))" for k in range(12)), "sin(" * 38 + "phi" + ")" * 38],
    ids=["product", "nest"],
)
def test_derivatives_cost_no_more_than_the_text_is_long(text: str) -> None:
    """Symbolic fifth derivatives of these take half a minute or do not end; jets take milliseconds."""
    assert np.isfinite(compiled(text, KEY)(POINTS, 5).coefficients).all()


def refusal(text: str) -> WrongInput | None:
    """Why a text is refused, None where it is not; any other exception goes through."""
    try:
        compiled(text, KEY)
    except WrongInput as fault:
        return fault
    return None


@pytest.mark.slow
@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.text(alphabet="phisncotael0123456789.+-*/()[]{}_ ,:='\"\\\n\t@", max_size=25))
def test_random_text_gives_a_series_or_a_refusal(text: str) -> None:
    fault = refusal(text)
    assert fault is None or fault.key == KEY
