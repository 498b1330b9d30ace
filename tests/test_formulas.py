"""Laws in closed form: against derivatives, integrals and products of theirs, and as files that other languages run."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from math import tau
from pathlib import Path
from typing import TYPE_CHECKING

import mpmath
import numpy as np
import pytest

import ncgear
from at_once import at_once
from commands import Run
from drives import DESIGNS, MACHINES, drive, drive_of_text
from later import Later
from mechanism_cases import CASES, Case
from ncgear.design.laws.registry import LawName
from ncgear.design.template import template
from ncgear.errors import Unanswered
from ncgear.numerics import jet
from ncgear.numerics.jet import Jet
from ncgear.project.drive import Drive

if TYPE_CHECKING:
    from ncgear.formulas.written import WrittenPiece

sympy = Later("sympy")
checked, laws, linkages, writing = (
    Later(f"ncgear.formulas.{name}") for name in ("checked", "laws", "linkages", "written")
)

MACHINE = "name: a\nlinkage: {crank_mm: 40, rod_mm: 90}\noperation: {speed_rpm: 30}\n"
ALONE = "name: a\noperation: {speed_rpm: 30}\n"
MOTIONS = {
    "ratio by formula": MACHINE + "motion: {law: ratio_expression, ratio: 1 + 0.3*cos(phi)**3, scale_to_close: true}\n",
    "ratio with choices": MACHINE
    + 'motion: {law: ratio_expression, ratio: "1.5 + max(0.1*sin(phi), -0.2*sin(phi))", scale_to_close: true}\n',
    "driven angle": MACHINE + "motion: {law: ratio_expression, driven_angle: phi - 0.08*sin(2*phi)/(2 + cos(phi))}\n",
    "open ratio": ALONE + "motion: {law: ratio_expression, ratio: sqrt(1 + phi/7), range_deg: 200}\n",
    "table of ratios": MACHINE
    + "motion: {law: table, phi1_deg: [10, 80, 140, 200, 270, 330], ratio: [1, 1.2, 1.3, 1, 0.8, 0.9], "
    "scale_to_close: true}\n",
    "falling function": ALONE
    + "motion: {law: function_generator, function: 1/x, x_from: 1, x_to: 3, driving_range_deg: 200, "
    "driven_range_deg: 250}\n",
    "two stages": MACHINE
    + "motion: {law: harmonic_ratio, cosine: [-0.2, 0.05], sine: [0.1], second_stage: {sine: [0.1, 0.03]}}\n",
    "series in series": ALONE
    + "motion: {law: in_series, pairs: [{law: harmonic_ratio, sine: [0.2]}, {law: harmonic_ratio, cosine: [0.1]}]}\n",
    "series in a row": ALONE
    + "motion: {law: harmonic_ratio, cosine: [0.2, 0.1]}\n"
    + "gears: {teeth: 40, module_mm: 2, face_width_mm: 9, idlers: {lobes: [1]}}\n",
    "lobes": ALONE
    + "motion: {law: ellipse, eccentricity: 0.3, phase_deg: 20}\n"
    + "gears: {lobes: {driving: 2, driven: 3}, teeth: 40, module_mm: 2, face_width_mm: 9, "
    "driving: {bore_mm: 9}, driven: {bore_mm: 9}}\n",
}
"""Kinds of laws that no template is of."""


def complete(found: Drive) -> bool:
    """Whether every section has pieces, or says why not."""
    sections = found.formulas.sections
    return all(bool(one.pieces) != bool(one.why) for one in sections) and 0.0 < found.formulas.difference < 1e-13


@pytest.mark.parametrize("law", LawName)
def test_every_law_has_formulas_or_says_why_not(law: LawName) -> None:
    """A new law needs a line in FORMS or in NO_FORMULA of formulas/laws.py."""
    found = drive_of_text(template("a", law))
    assert complete(found)
    assert bool(found.formulas.sections[0].why) == (law in (LawName.PITCH_CURVE, LawName.IN_SERIES))


@at_once("kind", MOTIONS)
def test_kinds_of_laws(kind: str) -> None:
    assert complete(drive_of_text(MOTIONS[kind]))


@pytest.mark.slow
@pytest.mark.parametrize("name", MACHINES)
def test_every_worked_design(name: str) -> None:
    found = drive(name)
    sections = found.formulas.sections
    assert all(bool(one.pieces) != bool(one.why) for one in sections)
    assert found.formulas.difference < 2e-15


# --- judges


def numeric(piece: WrittenPiece, expression: object) -> Callable[[np.ndarray], np.ndarray]:
    """An expression of a piece as a function of arrays, by numpy."""
    return np.vectorize(sympy.lambdify(piece.variable, expression, "numpy"), otypes=[float])


def inside(piece: WrittenPiece, count: int = 7) -> np.ndarray:
    """Places of a piece that neither the law nor the check has."""
    return np.random.default_rng(5).uniform(piece.start_rad, piece.end_rad, count)


@pytest.mark.judges("formulas")
def test_derivatives_of_the_displacement_are_those_of_the_machine() -> None:
    """sympy's derivatives of the polynomials by themselves, the machine's by the mechanism from the driven angle."""
    found = drive("pusher")
    for piece in found.formulas.sections[0].pieces[:3]:
        at = inside(piece)
        x = piece.expression("x")
        assert sympy.Poly(x, piece.variable).degree() == {"approach": 5, "constant speed": 1, "braking": 4}[piece.name]
        moved = found.machine.displacement(at, 2)
        for order in range(3):
            own = numeric(piece, x.diff(piece.variable, order))(at)
            assert own == pytest.approx(moved.derivative(order), rel=1e-11, abs=1e-11 * found.linkage.stroke_mm)


@pytest.mark.slow
@pytest.mark.judges("formulas")
@pytest.mark.parametrize("basis", ["ratio", "inverse_ratio"])
def test_the_return_covers_what_is_left_of_the_turn(basis: str) -> None:
    """The integral of its polynomial by mpmath; of the inverse ratio the driven angle besides is its antiderivative."""
    text = (DESIGNS / "pusher.yaml").read_text()
    text = text.replace("basis: inverse_ratio", f"basis: {basis}")
    found = drive_of_text(text)
    piece = found.formulas.sections[0].pieces[-1]
    start, end = mpmath.mpf(piece.start_rad), mpmath.mpf(piece.end_rad)
    with mpmath.workdps(30):
        slope = sympy.lambdify(piece.variable, 1 / piece.expression("i_12"), "mpmath")
        covered = mpmath.quad(slope, mpmath.linspace(start, end, 9))
        left = 2 * mpmath.pi - mpmath.mpf(found.transmission.driven_angle(np.array([piece.start_rad])).value[0])
    assert float(abs(covered - left)) < 1e-12
    assert ("phi_2" in piece.quantities) == (basis == "inverse_ratio")
    assert ("phi_2" in piece.without) == (basis == "ratio")


@pytest.mark.judges("formulas")
def test_the_ratios_of_two_stages_multiply_to_the_whole() -> None:
    whole, first, second, _ = drive_of_text(MOTIONS["two stages"]).formulas.sections
    at = inside(whole.pieces[0])
    ratios = [numeric(one.pieces[0], one.pieces[0].expression("i_12"))(at) for one in (whole, first, second)]
    assert ratios[0] == pytest.approx(ratios[1] * ratios[2], rel=1e-14)


@pytest.mark.judges("formulas")
def test_radii_of_an_ellipse_about_its_focus() -> None:
    """r1 (1 + e cos(phi1 - phase)) is the semi-latus rectum, and both radii make up the distance of the axes."""
    found = drive("ellipse")
    (piece,) = found.formulas.sections[0].pieces
    at = inside(piece)
    r_1, r_2 = (numeric(piece, piece.expression(name))(at) for name in ("r_1", "r_2"))
    e, phase = found.design.motion.eccentricity, found.design.motion.phase
    assert r_1 * (1.0 + e * np.cos(at - phase)) == pytest.approx(
        np.full(7, found.pitch.center_distance_mm / 2.0 * (1.0 - e**2))
    )
    assert r_1 + r_2 == pytest.approx(np.full(7, found.pitch.center_distance_mm), rel=1e-14)


@pytest.mark.tiers(slow=["crank_rocker 20*", "crank_rocker*-1"], rest="quick")
@pytest.mark.parametrize("case", CASES, ids=str)
def test_mechanisms_there_and_back(case: Case) -> None:
    """The driven angle at x = phi_1^2, and the displacement at that angle, which is x again."""
    linkage, write = case.mechanism, writing.FormulaWriter("phi_1")
    x = write.step("x", write.variable**2)
    left = write.step("left", sympy.sqrt(write.number("stroke", linkage.stroke_mm) - x))
    linkages.driven_angle(write, linkage, x, write.step("gone", write.variable), left)
    write.step("i_12", 1 / write.slope(writing.symbol("phi_2")))
    there = write.written("there", (0.0, linkage.stroke_mm**0.5), {})
    back, at = laws.mechanism(linkage, tau), checked.places_of(there, 9)
    values = there.values(at.tolist())
    again = back.values(values["phi_2"])["x"]
    assert [float(one) for one in again] == pytest.approx((at**2).tolist(), rel=1e-13)
    by = Jet.variable(at, 1)
    rest = jet.sqrt(linkage.stroke_mm - by * by)
    turned = linkage.regular_slope(by * by, by * rest).value * 2.0 / rest.value
    assert [float(1 / one) for one in values["i_12"]] == pytest.approx(turned.tolist(), rel=1e-12)


@pytest.mark.thorough
def test_numbers_are_those_of_the_law() -> None:
    found = drive("pusher")
    stroke = found.design.motion.stroke_law(found.linkage, found.transmission.lobes).stroke
    numbers = {str(name): value for name, value in found.formulas.sections[0].pieces[0].numbers.items()}
    assert [numbers[f"q_{k}"] for k in range(4)] == stroke.approach_root.tolist()
    written = drive_of_text(MOTIONS["ratio by formula"]).formulas.sections[0].pieces[0]
    assert str(written.steps[writing.symbol("i_12")]) == "(0.3*cos(phi_1)**3 + 1)/factor"


# --- what the comparison finds


@pytest.mark.slow
def test_a_number_that_is_changed_by_a_billionth_is_found() -> None:
    """Negative control, of every number of every piece that a told quantity needs."""
    found = drive("pusher")
    pieces, law, sizes = (
        found.formulas.sections[0].pieces,
        found.transmission,
        laws.Sizes(found.pitch.center_distance_mm),
    )
    assert checked.missed(pieces, law, law, found.linkage, sizes) < 1e-14
    changes = 0
    for place, piece in enumerate(pieces):
        for name, value in piece.numbers.items():
            spoiled = list(pieces)
            spoiled[place] = replace(piece, numbers={**piece.numbers, name: value * (1.0 + 1e-9)})
            with pytest.raises(Unanswered, match="differ by"):
                checked.missed(spoiled, law, law, found.linkage, sizes)
            changes += 1
    assert changes > 30


@pytest.mark.slow
def test_a_formula_that_differs_is_not_told(monkeypatch: pytest.MonkeyPatch, run: Run) -> None:
    monkeypatch.setattr("ncgear.formulas.checked.AGREED", 1e-18)
    status, out, err = run("formulas", str(DESIGNS / "pusher.yaml"))
    assert (status, out) == (3, "")
    assert "so it is not told" in err


# --- files of other languages


def functions(found: Drive) -> dict[str, tuple[str, list[WrittenPiece]]]:
    """The functions of a file, each with its quantity and the pieces that have it."""
    return {
        name: (of, [piece for piece in section.pieces if of in piece.quantities])
        for section in found.formulas.sections
        for name, of in checked.functions_of(section).items()
    }


def compare(found: Drive, call: Callable[[str, float], float]) -> None:
    """What a file says, at places of every piece, with the formulas."""
    told = functions(found)
    assert {"ratio", "ratio_of_driven_angle"} & set(told)
    for name, (of, pieces) in told.items():
        for piece in pieces[:4]:
            places = inside(piece, 4).tolist()
            right = [float(one) for one in piece.values(places)[of]]
            assert [call(name, at) for at in places] == pytest.approx(right, rel=2e-12), name


def as_python(text: str) -> Callable[[str, float], float]:
    names: dict[str, Callable[[float], float]] = {}
    exec(text, names)
    return lambda name, at: names[name](at)


def as_c(text: str, folder: Path) -> Callable[[str, float], float]:
    (folder / "law.c").write_text(text)
    flags = ["-std=c99", "-pedantic", "-Wall", "-Wno-unused-variable", "-Werror", "-shared", "-fPIC"]
    subprocess.run(["cc", *flags, "law.c", "-o", "law.so", "-lm"], check=True, cwd=folder)
    library = ctypes.CDLL(str(folder / "law.so"))

    def call(name: str, at: float) -> float:
        function = library[name]
        function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double]
        return function(at)

    return call


def as_matlab(text: str) -> Callable[[str, float], float]:
    """The file with MATLAB's words in the place of Python's; its first function only calls the others."""
    _, _, rest = text.partition("\nend\n\n")
    rest = re.sub(r"function value = (\w+)\((\w+)\)", r"def \1(\2):", rest)
    rest = re.sub(r"^( *)end$", "", rest, flags=re.MULTILINE)
    rest = re.sub(r"^( *if .*)$", r"\1:", rest, flags=re.MULTILINE)
    rest = re.sub(r"value = (\w+); return", r"return \1", rest)
    rest = re.sub(r"error\('(.*)'\)", r"raise ValueError('\1')", rest)
    return as_python(
        "from math import *\n" + rest.replace(".^", "**").replace("^", "**").replace("./", "/").replace(".*", "*")
    )


SOURCES = ["pusher", "ellipse", "harmonic", "open ratio", "driven angle"]


def of_kind(kind: str) -> Drive:
    return drive_of_text(MOTIONS[kind]) if kind in MOTIONS else drive({"harmonic": "printed-pump"}.get(kind, kind))


@pytest.mark.tiers(thorough=["pusher"], rest="slow")
@pytest.mark.parametrize("kind", SOURCES)
def test_python_runs(kind: str) -> None:
    call = as_python(checked.printed(of_kind(kind).formulas, "python"))
    compare(of_kind(kind), call)
    with pytest.raises(ValueError, match="outside"):
        call("ratio" if kind != "harmonic" else "ratio_of_driven_angle", 7.0)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cc") is None, reason="no compiler of C")
@pytest.mark.parametrize("kind", SOURCES)
def test_c_runs(kind: str, tmp_path: Path) -> None:
    call = as_c(checked.printed(of_kind(kind).formulas, "c"), tmp_path)
    compare(of_kind(kind), call)
    assert np.isnan(call("ratio" if kind != "harmonic" else "ratio_of_driven_angle", -0.1))


@pytest.mark.slow
@pytest.mark.parametrize("kind", SOURCES)
def test_matlab_says_the_same(kind: str) -> None:
    text = checked.printed(of_kind(kind).formulas, "matlab")
    assert text.count("function") + text.count("if ") - text.count("functions") == len(re.findall(r"\bend\b", text))
    compare(of_kind(kind), as_matlab(text))


@pytest.mark.slow
def test_a_quantity_without_closed_form_says_so_where_it_is_asked_for() -> None:
    text = (DESIGNS / "pusher.yaml").read_text().replace("basis: inverse_ratio", "basis: ratio")
    found = drive_of_text(text)
    call = as_python(checked.printed(found.formulas, "python"))
    assert call("driven_angle", 2.0) == pytest.approx(found.transmission.driven_angle(np.array([2.0])).value[0])
    with pytest.raises(ValueError, match="integral of 1/i_12"):
        call("driven_angle", 5.0)


def test_latex_is_balanced_and_names_every_number() -> None:
    text = checked.printed(drive("pusher").formulas, "latex")
    assert text.count("{") == text.count("}")
    assert text.count(r"\begin{align*}") == text.count(r"\end{align*}") == 5
    for piece in drive("pusher").formulas.sections[0].pieces:
        assert all(repr(value).partition("e")[0] in text for value in piece.numbers.values())
    small = MACHINE + "motion: {law: ratio_expression, ratio: 1 + 1.5e-7*cos(phi), scale_to_close: true}\n"
    assert r"1.5 \cdot 10^{-7} \cos" in checked.printed(drive_of_text(small).formulas, "latex")


# --- the command


@pytest.mark.thorough
def test_a_law_without_closed_form_says_so(run: Run) -> None:
    status, out, err = run("formulas", str(DESIGNS / "traced-egg.yaml"))
    assert (status, err) == (0, "")
    assert "law: no closed form, since the pitch curve is followed point by point" in out


@pytest.mark.slow
def test_ends_are_told_in_pi_where_they_are(run: Run) -> None:
    status, out, _ = run("formulas", str(DESIGNS / "pusher.yaml"))
    assert status == 0
    assert re.findall(r"^law, (.*)$", out, re.MULTILINE) == [
        "approach: 0 <= phi_1 <= 0.5*pi",
        "constant speed: 0.5*pi <= phi_1 <= pi",
        "braking: pi <= phi_1 <= 1.3*pi",
        "return: 1.3*pi <= phi_1 <= 2*pi",
    ]


@pytest.mark.thorough
def test_without_gears_radii_are_shares() -> None:
    found = ncgear.loads(MOTIONS["ratio by formula"]).formulas
    assert not found.sized
    assert "radii as shares of the distance of the axes" in checked.printed(found, "text")
