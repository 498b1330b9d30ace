"""The crank-slider against its vector loop (sympy, mpmath) and plain geometry."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from math import hypot, inf, nan, pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp

from at_once import at_once
from ncgear.errors import WrongInput
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from oracles import stroke as oracle

LENGTHS = [
    (380.0, 960.0, 0.0),
    (380.0, 960.0, 100.0),
    (380.0, 960.0, -100.0),
    (40.0, 150.0, 12.0),
    (100.0, 130.0, 0.0),
    (100.0, 130.0, -29.0),
]
"""Crank, rod, offset in mm; the last one comes within 1 mm of not turning."""

every_linkage = at_once("lengths", LENGTHS)

Lengths = tuple[float, float, float]


def exact_linkage(lengths: Lengths) -> oracle.Linkage:
    """The oracle's linkage of the same lengths."""
    return oracle.Linkage(*lengths)


@cache
def loop_derivatives() -> tuple[Callable[..., Any], ...]:
    """Derivatives 0 to 4 of the slider's position in the vector loop, by sympy, evaluated by mpmath."""
    import sympy

    crank, rod, offset, phi = sympy.symbols("crank rod offset phi")
    angle = sympy.pi + sympy.asin(offset / (rod - crank)) - phi
    position = crank * sympy.cos(angle) + sympy.sqrt(rod**2 - (crank * sympy.sin(angle) - offset) ** 2)
    forms = [position - sympy.sqrt((rod - crank) ** 2 - offset**2)]
    while len(forms) < 5:
        forms.append(sympy.diff(forms[-1], phi))
    return tuple(sympy.lambdify((crank, rod, offset, phi), form, modules="mpmath") for form in forms)


def exact_taylor(linkage: oracle.Linkage, phi2: Any, order: int) -> list[Any]:
    """Taylor coefficients of the exact displacement."""
    return [value / mp.factorial(k) for k, value in enumerate(linkage.derivatives(phi2, order))]


def crank_pins_mm(linkage: CrankSlider, crank_angle_rad: Array) -> Array:
    """Crank pin (x, y) from the crank axis, shape (n, 2)."""
    pin = linkage.rod(Jet.variable(crank_angle_rad, 0)).pin
    return np.column_stack([pin.x.value, pin.y.value])


@pytest.mark.judges("mechanisms")
@pytest.mark.tiers(quick=["(380.0, 960.0, 100.0)", "(100.0, 130.0, -29.0)"], rest="slow")
@pytest.mark.parametrize("lengths", LENGTHS, ids=str)
def test_displacement_and_four_derivatives_against_the_vector_loop(lengths: Lengths) -> None:
    points = np.concatenate([np.linspace(0.0, 2.0 * pi, 9), [1e-9, 0.01, 3.0, 3.3, 6.2]])
    series = CrankSlider(*lengths).displacement(Jet.variable(points, 4))
    with mp.workdps(40):
        for k, exact in enumerate(loop_derivatives()):
            values = np.array([float(exact(*map(mp.mpf, lengths), mp.mpf(float(point)))) for point in points])
            # About thirty operations; near its least rod projection the almost stuck linkage divides by 1/10 of the rod
            assert np.max(np.abs(series.derivative(k) - values)) <= 1e-13 * max(np.abs(values).max(), lengths[0])


@every_linkage
@at_once("angle", [1e-12, 1e-9, 1e-6, 1e-3, 0.1])
def test_displacement_is_relatively_exact_near_the_retracted_end(lengths: Lengths, angle: float) -> None:
    found = CrankSlider(*lengths).displacement(Jet.variable(angle, 0)).value[0]
    with mp.workdps(60):
        exact = exact_linkage(lengths).displacement(mp.mpf(angle))
        # No difference of nearly equal numbers is left: some ten rounding errors
        assert abs(found / exact - 1) < 2e-15


@pytest.mark.parametrize("rod", [380.038, 380.0001])
def test_a_rod_hardly_longer_than_the_crank_loses_no_digits(rod: float) -> None:
    """Where the slider is extended, the form that is exact when it is retracted would lose four digits and six."""
    exact, phi2 = exact_linkage((380.0, rod, 0.0)), np.linspace(1.8, 4.4, 53)
    found = CrankSlider(380.0, rod).displacement(Jet.variable(phi2, 1))
    with mp.workdps(40):
        wanted = [(exact.displacement(mp.mpf(at)), exact.slope(mp.mpf(at))) for at in phi2.tolist()]
        errors = [abs(mp.mpf(float(x)) / value - 1) for x, (value, _) in zip(found.value, wanted, strict=True)]
        steep = [abs(mp.mpf(float(v)) - slope) for v, (_, slope) in zip(found.derivative(1), wanted, strict=True)]
    assert max(errors) <= 8 * 2.2e-16
    assert max(steep) <= 1e-14 * 380.0


@every_linkage
def test_textbook_form_would_fail_the_same_comparison(lengths: Lengths) -> None:
    crank, rod, offset = lengths
    angle = pi + np.arcsin(offset / (rod - crank)) - 1e-6
    textbook = crank * np.cos(angle) + np.sqrt(rod**2 - (crank * np.sin(angle) - offset) ** 2)
    textbook -= np.sqrt((rod - crank) ** 2 - offset**2)
    with mp.workdps(60):
        assert abs(textbook / exact_linkage(lengths).displacement(mp.mpf(1e-6)) - 1) > 1e-6


@every_linkage
def test_stroke_and_working_angle_against_the_stretched_triangles(lengths: Lengths) -> None:
    linkage = CrankSlider(*lengths)
    with mp.workdps(40):
        exact = exact_linkage(lengths)
        # The almost stuck linkage has (reach - offset) = 1 mm of 30 mm, exact in binary; some ten rounding errors
        assert abs(linkage.stroke_mm / exact.stroke() - 1) < 2e-15
        assert abs(linkage.working_angle_rad - exact.working_angle()) < 2e-15
        assert linkage.farthest_mm - linkage.nearest_mm == pytest.approx(linkage.stroke_mm, rel=1e-14)


@every_linkage
def test_dead_centres_are_where_the_slider_stands_and_crank_and_rod_align(lengths: Lengths) -> None:
    linkage = CrankSlider(*lengths)
    ends = np.array([0.0, linkage.working_angle_rad])
    series = linkage.displacement(Jet.variable(ends, 1))
    assert series.value == pytest.approx([0.0, linkage.stroke_mm], abs=1e-13 * linkage.stroke_mm)
    assert series.derivative(1) == pytest.approx([0.0, 0.0], abs=1e-13 * linkage.stroke_mm)
    pins = crank_pins_mm(linkage, ends)
    sliders = np.column_stack([[linkage.nearest_mm, linkage.farthest_mm], [lengths[2]] * 2])
    areas = pins[:, 0] * sliders[:, 1] - pins[:, 1] * sliders[:, 0]
    assert areas == pytest.approx([0.0, 0.0], abs=1e-14 * lengths[0] * lengths[1] * 4)
    along = np.sum(pins * sliders, axis=1)
    assert along[0] < 0.0 < along[1]  # folded at the retracted end, stretched at the extended one


@every_linkage
def test_mpmath_finds_the_same_dead_centre(lengths: Lengths) -> None:
    with mp.workdps(40):
        position, slope = (partial(of, *map(mp.mpf, lengths)) for of in loop_derivatives()[:2])
        start = max(np.linspace(0.5, 6.0, 56).tolist(), key=position)
        extended = mp.findroot(slope, (start - 0.1, start + 0.1), solver="anderson")
        assert abs(CrankSlider(*lengths).working_angle_rad - extended) < 2e-15


def test_sign_of_the_offset_decides_which_stroke_is_longer() -> None:
    angles = [CrankSlider(380.0, 960.0, offset).working_angle_rad for offset in (-100.0, 0.0, 100.0)]
    assert angles[0] < pi == angles[1] < angles[2]
    assert angles[0] + angles[2] == pytest.approx(2.0 * pi, rel=1e-15)  # mirror images, run through backwards


@every_linkage
def test_the_rod_keeps_its_length_and_the_crank_turns_clockwise(lengths: Lengths) -> None:
    linkage = CrankSlider(*lengths)
    angles = np.linspace(0.0, 2.0 * pi, 73)
    pins = crank_pins_mm(linkage, angles)
    position = linkage.displacement(Jet.variable(angles, 0)).value + linkage.nearest_mm
    rods = np.hypot(position - pins[:, 0], lengths[2] - pins[:, 1])
    assert rods == pytest.approx(np.full(73, lengths[1]), rel=1e-14)
    assert np.hypot(*pins.T) == pytest.approx(np.full(73, lengths[0]), rel=1e-14)
    assert np.all(pins[:-1, 0] * pins[1:, 1] - pins[:-1, 1] * pins[1:, 0] < 0.0)


@every_linkage
def test_working_angle_undoes_displacement_up_to_both_dead_centres(lengths: Lengths) -> None:
    linkage, exact = CrankSlider(*lengths), exact_linkage(lengths)
    end = linkage.working_angle_rad
    near = np.array([1e-9, 1e-7, 1e-5, 1e-3])
    angles = np.concatenate([near, np.linspace(0.02, end - 0.02, 30), end - near])
    with mp.workdps(60):
        displaced = [exact.displacement(mp.mpf(float(angle))) for angle in angles]
        parts = [[float(x) for x in row] for row in (displaced, [exact.stroke() - x for x in displaced])]
    found = linkage.working_angle(*map(np.array, parts))
    assert np.max(np.abs(found / angles - 1.0)) <= 1e-12  # the accuracy promised; relative, so 1e-21 rad at 1e-9 rad
    assert np.max(np.abs((found - angles)[-4:])) <= 1e-15 * 4  # four rounding errors of pi, next to the extended end


@every_linkage
def test_working_angle_as_a_series_is_the_identity(lengths: Lengths) -> None:
    linkage = CrankSlider(*lengths)
    angles = np.linspace(0.3, linkage.working_angle_rad - 0.3, 12)
    displaced = linkage.displacement(Jet.variable(angles, 4))
    remaining = linkage.stroke_mm - displaced
    root = jet.sqrt(displaced * remaining)
    slope = displaced.differentiated() / root.truncated(3) * linkage.regular_slope(displaced, root).truncated(3)
    found = slope.integrated(linkage.working_angle(displaced.value, remaining.value))
    exact = Jet.variable(angles, 4).coefficients
    # Two inverse series after each other, of coefficients up to some tens: thousands of rounding errors
    assert np.max(np.abs(found.coefficients - exact)) <= 1e-11


def root_series(series: list[Any], sign: int) -> list[Any]:
    """Taylor coefficients of h sqrt(f/h^2) for f = series[2] h^2 + series[3] h^3 + ..., times sign."""
    root = [mp.sqrt(series[2])]
    for k in range(1, len(series) - 2):
        root.append((series[2 + k] - mp.fsum(root[j] * root[k - j] for j in range(1, k))) / (2 * root[0]))
    return [mp.mpf(0), *(sign * value for value in root)]


@every_linkage
@at_once("extended", [False, True])
def test_working_angle_is_regular_at_the_dead_centres_themselves(lengths: Lengths, extended: bool) -> None:
    linkage, exact, order = CrankSlider(*lengths), exact_linkage(lengths), 4
    with mp.workdps(40):
        at = exact.working_angle() if extended else mp.mpf(0)
        series = exact_taylor(exact, at, order + 1)
        series[1] = mp.mpf(0)
        other = [exact.stroke() - series[0], *(-c for c in series[1:])]
        vanishing, full = (other, series) if extended else (series, other)
        vanishing_root = root_series(vanishing, -1 if extended else 1)
        full_root = mp.taylor(lambda h: mp.sqrt(mp.polyval(full[::-1], h)), 0, order)
    displaced, vanishing, whole = (
        Jet(np.array([[float(c)] for c in part[: order + 1]])) for part in (series, vanishing_root, full_root)
    )
    root = vanishing * whole
    # Both are zero here: their powers of h are one less after the division
    rate = Jet(displaced.differentiated().coefficients[1:]) / Jet(root.coefficients[1:order])
    slope = rate * linkage.regular_slope(displaced, root).truncated(order - 2)
    assert slope.coefficients[:, 0] == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)
    ends = np.array([linkage.stroke_mm, 0.0] if extended else [0.0, linkage.stroke_mm])[:, None]
    assert linkage.working_angle(*ends) == pytest.approx(linkage.working_angle_rad if extended else 0.0, abs=1e-15)


@every_linkage
def test_crank_angle_of_both_strokes(lengths: Lengths) -> None:
    linkage, exact = CrankSlider(*lengths), exact_linkage(lengths)
    end = linkage.working_angle_rad
    angles = np.concatenate([np.linspace(0.02, end - 0.02, 20), np.linspace(end + 0.02, 2.0 * pi - 0.02, 20)])
    with mp.workdps(40):
        displaced = np.array([float(exact.displacement(mp.mpf(float(angle)))) for angle in angles])
    found = linkage.crank_angle(displaced, angles > end)
    # A rounding error of x moves phi2 by 1e-16 stroke / (dx/dphi2), and dx/dphi2 is 1/1000 stroke or more here
    assert np.max(np.abs(found - angles)) <= 1e-12


@every_linkage
def test_crank_angle_at_the_ends(lengths: Lengths) -> None:
    linkage = CrankSlider(*lengths)
    ends = np.array([0.0, linkage.stroke_mm, linkage.stroke_mm, 0.0])
    found = linkage.crank_angle(ends, np.array([False, False, True, True]))
    extended = linkage.working_angle_rad
    assert found == pytest.approx([0.0, extended, extended, 2.0 * pi], abs=2e-15)


turning = st.tuples(st.floats(10.0, 500.0), st.floats(0.05, 3.0), st.floats(-0.95, 0.95)).map(
    lambda t: (t[0], t[0] * (1.0 + t[1]), t[0] * t[1] * t[2])
)
"""Linkages whose crank turns: the rod exceeds the crank, the offset stays below the difference."""


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(turning, st.floats(1e-3, 1e3), st.floats(0.0, 2.0 * pi))
def test_a_scaled_linkage_moves_alike(lengths: Lengths, scale: float, angle: float) -> None:
    small = CrankSlider(*lengths)
    large = CrankSlider(*(scale * length for length in lengths))
    variable = Jet.variable(angle, 3)
    # rod - crank is 1/20 of the crank at least and the offset 19/20 of that at most: rounding grows 20 x 20-fold
    assert large.working_angle_rad == pytest.approx(small.working_angle_rad, rel=1e-13)
    assert large.stroke_mm == pytest.approx(scale * small.stroke_mm, rel=1e-13)
    first, second = large.displacement(variable).coefficients, scale * small.displacement(variable).coefficients
    assert np.allclose(first, second, rtol=0.0, atol=1e-12 * float(np.abs(second).max() + scale * lengths[0]))


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(turning, st.floats(0.0, 2.0 * pi))
def test_the_slider_stays_between_its_ends(lengths: Lengths, angle: float) -> None:
    linkage = CrankSlider(*lengths)
    moved = float(linkage.displacement(Jet.variable(angle, 0)).value[0])
    assert -1e-12 * linkage.stroke_mm <= moved <= linkage.stroke_mm * (1.0 + 1e-12)
    pin: Array = crank_pins_mm(linkage, np.array([angle]))[0]
    rod = hypot(linkage.nearest_mm + moved - pin[0], linkage.offset_mm - pin[1])
    assert rod == pytest.approx(linkage.rod_mm, rel=1e-12)


@at_once(
    ("lengths", "key", "said"),
    [
        ((0.0, 960.0, 0.0), "linkage.crank_mm", "0 is not a length"),
        ((-380.0, 960.0, 0.0), "linkage.crank_mm", "-380 is not a length"),
        ((nan, 960.0, 0.0), "linkage.crank_mm", "nan"),
        ((380.0, 370.0, 0.0), "linkage.rod_mm", "over 380 mm"),
        ((380.0, 380.0, 0.0), "linkage.rod_mm", "over 380 mm"),
        ((380.0, 480.0, 100.0), "linkage.rod_mm", "over 480 mm"),
        ((380.0, 400.0, -100.0), "linkage.rod_mm", "over 480 mm"),
        ((380.0, nan, 0.0), "linkage.rod_mm", "nan"),
        ((inf, 960.0, 0.0), "linkage.rod_mm", "inf"),
    ],
)
def test_linkages_that_cannot_turn_are_refused(lengths: Lengths, key: str, said: str) -> None:
    with pytest.raises(WrongInput) as caught:
        CrankSlider(*lengths)
    assert caught.value.key == key
    assert said in caught.value.problem


@pytest.mark.slow
@given(rod=st.floats(10.0, 1e4), share=st.floats(0.01, 0.95), offset=st.floats(-0.9, 0.9))
def test_the_crank_follows_from_the_stroke(rod: float, share: float, offset: float) -> None:
    """In closed form, back from the stroke that the dead centres give."""
    crank = share * rod * (1.0 - abs(offset))
    linkage = CrankSlider(crank, rod, offset * rod * (1.0 - share))
    found = CrankSlider.of_stroke(linkage.stroke_mm, rod_mm=rod, offset_mm=linkage.offset_mm)
    assert found.crank_mm == pytest.approx(crank, rel=1e-12)
