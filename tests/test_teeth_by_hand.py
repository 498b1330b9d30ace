"""Sides of teeth, deviations of a mesh, meetings and formulas by plain geometry: lines, circles, displacements."""

from __future__ import annotations

from functools import partial
from math import cos, exp, log, pi, sin
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline

import ncgear.contact.placement as placement
import ncgear.formulas.laws as laws
import ncgear.teeth.sides as sides
import ncgear.tolerances.mesh as mesh
from at_once import at_once
from ncgear.contact.placement import PUSHING
from ncgear.errors import RefusedAt
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws import table
from ncgear.teeth.contour import _perhaps_plain
from ncgear.teeth.flank import FILLET
from ncgear.teeth.spaces import of_spaces
from ncgear.wishes.wish import NEGLIGIBLE, Outcome

Made: Any = SimpleNamespace


# --- teeth


@pytest.mark.judges("teeth")
@at_once("within", [0.001, 0.02])
def test_points_of_lines_and_circles_may_be_lines_and_arcs(within: float) -> None:
    """Points off by 1.5 times what is allowed still may; points off by 2.5 times may not."""
    share = np.linspace(0.0, 1.0, 9)
    line = (2.0 + 1.0j) + share * (3.0 + 4.0j)
    arc = (5.0 - 2.0j) + 7.0 * np.exp(1j * (0.4 + 1.2 * share))
    off = np.where(np.arange(9) == 6, 1.0, 0.0)
    beside, outwards = 1j * (3.0 + 4.0j) / 5.0, np.exp(1j * (0.4 + 1.2 * share))
    rows = [
        line,
        line + 1.5 * within * off * beside,
        line + 2.5 * within * off * beside,
        arc,
        arc - 1.5 * within * off * outwards,
        arc + 2.5 * within * off * outwards,
        (5.0 - 2.0j) + 7.0 * np.exp(-1j * (0.4 + 1.2 * share)),
        line + 5.0j * share**3,
    ]
    assert _perhaps_plain(np.array(rows), within).tolist() == [True, True, False, True, True, False, True, False]


@pytest.mark.judges("teeth")
def test_a_space_has_the_lesser_value_of_its_flanks() -> None:
    """Spaces lie between flanks 1 and 2, 3 and 4, and 5 and 0."""
    assert of_spaces(np.array([9.0, 2.0, 3.0, 5.0, 4.0, 1.0])).tolist() == [1.0, 2.0, 2.0, 4.0, 4.0, 1.0]


def paths() -> sides._Paths:
    """Two sides of two curves of five points each: parameters rise on the first curve and fall on the second."""
    parameters = np.array([[[0.0, 1.0, 3.0, 6.0, 10.0], [9.0, 7.0, 4.0, 2.0, 1.0]]] * 2)
    along = parameters.reshape(2, -1)
    points = np.stack([2.0 * along, np.array([[0.0], [1.0]]) * along], axis=-1)
    return sides._Paths(Made(rack=Made(module_mm=2.0)), np.array([4, 7]), parameters, points)


@pytest.mark.judges("teeth")
def test_places_along_a_path_are_counted_by_its_points() -> None:
    """Between points parameters are interpolated; places beyond a curve are at its ends."""
    row = np.zeros(6, dtype=int)
    index = np.array([0.0, 1.5, 4.0, 5.0, 6.25, 9.9])
    kind, parameter = paths().place(row, index)
    assert kind.tolist() == [0, 0, 0, 1, 1, 1]
    assert parameter == pytest.approx([0.0, 2.0, 10.0, 9.0, 6.25, 1.0])
    assert paths().index(row, kind, parameter)[:5] == pytest.approx(index[:5])
    assert paths().place(row[:1], np.array([4.6]))[1] == pytest.approx([10.0])


@pytest.mark.judges("teeth")
def test_a_crossing_is_within_half_as_much_more_as_the_longer_chord() -> None:
    """Chords of 2 and 3 in their parameters on the second side, sqrt(5) times as long in mm."""
    row, first, second = np.array([1]), np.array([1.5]), np.array([6.25])
    own, other = paths().reaches(row, np.array([0]), first, np.array([1]), second)
    assert (own[0], other[0]) == pytest.approx((4.5, 4.5))
    own, other = paths().reaches(row, np.array([0]), np.array([3.0]), np.array([1]), np.array([8.0]))
    assert (own[0], other[0]) == pytest.approx((6.0, 6.0))
    step, length = paths()._chord(np.array([0]), np.array([1]), np.array([7.5]))
    assert (step[0], length[0]) == pytest.approx((2.0, 4.0))


@pytest.mark.judges("teeth")
@at_once(("start", "end", "folds"), [(2.0, 4.0, False), (2.0, 6.0, True), (6.0, 4.9, True), (4.0, 3.0, False)])
@at_once("kind", [0, FILLET])
def test_a_stretch_folds_where_any_place_inside_does(start: float, end: float, folds: bool, kind: int) -> None:
    """Curves that fold at parameters over 5 on the first kind, and where one tenth as large on the other."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            sides, "_folded", lambda flanks, owner, parameter, number: parameter > (5.0 if number == 0 else 0.5)
        )
        scale = 1.0 if kind == 0 else 0.1
        found = paths().folds(np.array([1]), np.array([kind]), np.array([scale * start]), np.array([scale * end]))
    assert found.tolist() == [folds]


def hollow(radius: float, tips: tuple[float, float]) -> tuple[Any, Any]:
    """Flanks of two teeth on a curve that is hollow with a radius at 30 mm alone, and their sides."""

    curve = Made(
        gear=Gear.DRIVEN,
        curvature_bounds=(-1.0 / radius, 0.1),
        curvature_at=lambda sigma: -np.exp(-(((sigma - 30.0) / 4.0) ** 2)) / radius,
        driving_angle=lambda sigma: sigma / 10.0,
    )
    heights = np.array([2.0, 2.0, tips[0], tips[1]])
    return Made(count=4, curve=curve, tip_height_mm=heights), Made(tip_mm=np.array([9.0, 11.0, 28.0, 32.0]))


@pytest.mark.judges("teeth")
@at_once(
    ("radius", "tips", "folds"),
    [(2.9, (3.0, 1.0), True), (2.9, (1.0, 3.0), True), (3.1, (3.0, 3.0), False), (1.9, (1.8, 1.8), False)],
)
def test_a_tip_land_folds_over_a_hollow_that_is_sharper_than_it_is_high(
    radius: float, tips: tuple[float, float], folds: bool
) -> None:
    """The second tooth stands over the hollow; the first one, where the curve is nearly straight, does not fold."""
    flanks, own = hollow(radius, tips)
    try:
        sides._refuse_folded_tips(flanks, own)
        said = ""
    except RefusedAt as error:
        said = error.problem
    assert bool(said) is folds
    if folds:
        assert f"radius of {radius:.4g} mm at phi1" in said
        assert "less than the height of 3 mm of tooth 2" in said


@pytest.mark.judges("teeth")
@at_once(("deep", "limit", "folds"), [(2.0, 2.1, False), (2.1, 2.0, True)])
def test_a_root_land_folds_where_gear_and_tool_turn_about_each_other_more_sharply_than_it_is_deep(
    deep: float, limit: float, folds: bool
) -> None:
    """The third of four lands, which is 20 to 22 mm along the curve."""
    starts = np.array([0.0, 10.0, 20.0, 30.0])

    def folding(row: Any, sigma: Any) -> Any:
        return np.where(row == 2, deep, 1.0) + 0.0 * sigma, np.full(sigma.shape, limit)

    roots = Made(lands=lambda: (starts, starts + 2.0), folding=folding)
    curve = Made(gear=Gear.DRIVING, driving_angle=lambda sigma: sigma / 10.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sides, "_refuse_folded_tips", lambda *_: None)
        try:
            sides.refuse_folded_lands(Made(curve=curve), Made(roots=roots))
            said = ""
        except RefusedAt as error:
            said, place = error.problem, error.phi1_rad
    assert bool(said) is folds
    if folds:
        assert "after tooth 3 of the driving gear" in said
        assert "radius of 2 mm there, less than its depth of 2.1 mm" in said
        assert 2.0 <= place <= 2.2


# --- deviations


DISTANCE, SENSE = 50.0, -1.0


@pytest.mark.judges("tolerances")
@pytest.mark.parametrize("urge", [1.0, -1.0])
def test_small_displacements_lead_a_contact_by_their_part_along_its_normal(
    urge: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """u1 = c1 e^(i phi1) + P g1 + i P eps, u2 = da + c2 e^(i s phi2) + (P - a) g2 + a gh, over the normal's arm."""
    place, tangent, phi1, phi2 = 24.0 + 3.0j, np.exp(1.4j), 0.7, 1.1
    at: Any = Made(
        mesh=Made(sense=SENSE),
        phi1_rad=np.array([0.0, phi1]),
        phi2_rad=np.array([0.0, phi2]),
        center_distance_mm=DISTANCE,
    )
    monkeypatch.setattr(mesh, "fixed_tangents", lambda found, at: (np.array([place]), np.array([tangent])))
    effect = Made(along=np.array([0.8]), pitch=np.array([0.6]), share=np.array([0.25]))
    asked: list[Any] = []
    monkeypatch.setattr(mesh, "_side", lambda *given: asked.append(given) or effect)
    found: Any = Made(
        urge=np.array([urge]),
        lever_mm=np.array([20.0]),
        position=np.array([1]),
        driving=np.array([3]),
        driven=np.array([5]),
        side=np.array([PUSHING if urge > 0.0 else 1 - PUSHING]),
        lead_rad=np.array([0.01]),
        place=lambda at: np.array([7]),
    )
    teeth: Any = Made(driving=Made(flanks=Made(count=40)), driven=None)
    rows = mesh.places_of(teeth, 6.0, found, at, both_ways=False)
    normal = 1j * SENSE * urge * tangent
    first, second = np.exp(1j * phi1), np.exp(1j * SENSE * phi2)
    moved: dict[str, tuple[complex, complex]] = {
        "center_distance": (0j, 1.0 + 0j),
        "driving_x": (first, 0j),
        "driving_y": (1j * first, 0j),
        "driven_x": (0j, second),
        "driven_y": (0j, 1j * second),
        "driving_growth": (place, 0j),
        "driven_growth": (0j, place - DISTANCE),
        "housing_growth": (0j, DISTANCE + 0j),
        "driving_index": (1j * place, 0j),
    }
    for name, (u1, u2) in moved.items():
        gap = (np.conj(normal) * (u2 - u1)).real
        assert rows.rigid[0, mesh.RIGID.index(name)] == pytest.approx(-gap / 20.0), name
    worn = -0.8 / 20.0 if urge > 0.0 else 0.0
    assert rows.rigid[0, -2:] == pytest.approx([worn, worn])
    assert mesh.places_of(teeth, 6.0, found, at, both_ways=True).rigid[0, -2:] == pytest.approx([-0.04, -0.04])
    assert rows.tilt == pytest.approx(6.0 * rows.rigid[:, 1:5])
    assert (rows.flank.tolist(), rows.place.tolist(), rows.lead.tolist()) == ([[3, 45]], [7], [0.01])
    assert rows.pitch_share == pytest.approx(np.array([[0.03, 0.03]]))
    assert rows.profile_share == pytest.approx(np.array([[0.25 * 0.8 / 20.0] * 2]))
    driving, driven = asked[:2]
    assert driving[4] == pytest.approx(np.array([normal / first]))
    assert driven[4] == pytest.approx(np.array([-normal / second]))
    assert driving[5] == pytest.approx([urge * (np.conj(normal) * 1j * place).real])


@pytest.mark.judges("tolerances")
@pytest.mark.parametrize("ahead", [4.0, -3.0, 96.5, 30.0])
def test_a_contact_is_as_high_on_its_flank_as_the_curve_has_rolled_past(
    ahead: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Flanks rise by 0.3 mm for each mm that they cross ahead, round a curve of 100 mm; ends are at 2 and -1 mm."""
    point = np.array([[30.0, 2.0]])
    flanks = Made(
        curve=Made(length_mm=100.0),
        crossing_mm=np.array([0.0, 10.0 + ahead]),
        side=np.array([1.0, 1.0]),
        slant=Made(of=lambda flank: Made(height_per_rolled=0.3, cosine=cos(0.35))),
        flank=lambda flank, height: (None, np.array([[0.6, 0.8]]) * 5.0),
        at_pitch_line=(np.array([3.0 + 4.0j, 6.0 + 8.0j]), np.array([1.0 + 0j, 2.0j])),
    )
    gear: Any = Made(
        flanks=flanks, sides=Made(flank_range=lambda: (np.array([0.0, 2.0]), np.array([0.0, -1.0]))), point=point
    )
    at: Any = Made(rolled_mm=np.array([110.0]))
    out = np.array([np.exp(1j * 0.5)])
    found = mesh._side(gear, np.array([1]), Made(position=np.array([0])), at, out, np.array([7.0]))
    nearest = (ahead + 50.0) % 100.0 - 50.0
    height = min(max(0.3 * nearest, -1.0), 2.0)
    assert found.share == pytest.approx([(height - 0.5) / 3.0])
    assert found.along == pytest.approx([abs(0.6 * sin(0.5) - 0.8 * cos(0.5))])
    assert found.pitch == pytest.approx([cos(0.35) * 7.0 / 8.0])
    assert mesh.crossing_arms_mm(gear) == pytest.approx([3.0, 8.0])


@pytest.mark.judges("tolerances")
def test_arcs_of_contact_change_as_both_of_their_ends_move(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ends that move evenly with the driven gear's shift and the driving gear's growth; the second arc has no end."""
    x_rate, y_rate, grown_rate = np.array([[2.0], [-1.0]]), np.array([[0.5], [3.0]]), np.array([[40.0], [-60.0]])
    nominal = np.array([[3.0, 1.0], [41.0, np.inf]])

    def contacts(teeth: Any, at: Any, met: Any) -> Any:
        moved = x_rate * at.moved_mm.real + y_rate * at.moved_mm.imag + grown_rate * (at.scale - 1.0)
        return Made(reach_ends=nominal + moved, whole=np.array([True, True]))

    class Displaced(SimpleNamespace):
        pass

    phi1 = np.linspace(0.0, 2.0 * pi, 64, endpoint=False)
    at: Any = Made(
        phi1_rad=phi1,
        phi2_rad=phi1 / 2.0,
        center_distance_mm=DISTANCE,
        count=64,
        per_tooth=32,
        mesh=Made(sense=SENSE),
    )
    monkeypatch.setattr(mesh, "fields", lambda placement: [])
    monkeypatch.setattr(mesh, "Displaced", Displaced)
    monkeypatch.setattr(mesh, "flank_contacts", contacts)
    monkeypatch.setattr(mesh, "meetings", lambda teeth, at: Made(position=np.array([[20], [0]])))
    teeth: Any = Made(driving=Made(flanks=Made(rack=Made(module_mm=2.0))))
    arcs, rates = mesh.arc_rates(teeth, at)
    assert arcs == pytest.approx([38.0 / 32.0])
    wanted = np.zeros(8)
    for end, sign in ((0, -1.0), (1, 1.0)):
        position = (20 + int(nominal[end, 0])) % 64
        first, second = np.exp(1j * phi1[position]), np.exp(1j * SENSE * phi1[position] / 2.0)
        # The driven gear's shift against the driving one, and the driving gear's growth against it, for each deviation.
        shifts = [1.0, -first, -1j * first, second, 1j * second, 0.0, -DISTANCE, DISTANCE]
        grown = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0]
        each = [
            x_rate[end, 0] * np.real(shift) + y_rate[end, 0] * np.imag(shift) + grown_rate[end, 0] * more
            for shift, more in zip(shifts, grown, strict=True)
        ]
        wanted += sign * np.array(each) / 32.0
    assert rates[0] == pytest.approx(wanted, rel=1e-6)


# --- meetings


@pytest.mark.judges("contact")
@pytest.mark.parametrize("toothed", [None, object()])
def test_meetings_near_positions_are_all_found(toothed: Any) -> None:
    """Within two pitches of 6 mm, round a cycle of 60 mm where gears turn on."""
    random = np.random.default_rng(4)
    crossing, rolled = random.uniform(-20.0, 130.0, 30), np.sort(random.uniform(0.0, 60.0, 40))
    at: Any = Made(rolled_mm=rolled, pitch_mm=6.0, toothed=toothed, cycle_mm=60.0)
    meeting, position = placement._near(crossing, at)
    away = np.abs(crossing[:, None] - rolled)
    if toothed is None:
        away = np.abs((crossing[:, None] - rolled + 30.0) % 60.0 - 30.0)
    wanted = np.argwhere(away <= 12.0)
    assert np.stack([meeting, position], axis=1).tolist() == wanted.tolist()


# --- formulas


def numbers_of(part: Any, phi1: float) -> dict[str, float]:
    """Values of all steps of a piece at a driving angle, each from the steps before."""
    values = {**part.write.numbers, part.write.variable: phi1}
    for name, step in part.write.steps.items():
        values[name] = float(step.subs(values))
    return {str(name): value for name, value in values.items()}


PIECE: Any = Made(start_rad=0.0, end_rad=1.0, knots_rad=(0.5,))


@pytest.mark.judges("formulas")
def test_a_spirals_ratio_is_one_more_than_its_falling_share() -> None:
    """i12 + 1 falls by e^(-m phi); the driven angle is the integral of 1 / i12 from 0 on."""
    (part,) = laws._spiral(PIECE, 2.0, 0.4)
    found = [numbers_of(part, phi) for phi in (0.0, 0.6, 1.0)]
    for phi, one in zip((0.0, 0.6, 1.0), found, strict=True):
        assert one["i_12"] == pytest.approx(3.0 * exp(-0.4 * phi) - 1.0)
        inner = np.linspace(0.0, phi, 2001)
        assert one["phi_2"] == pytest.approx(np.trapezoid(1.0 / (3.0 * np.exp(-0.4 * inner) - 1.0), inner), abs=1e-7)
    assert found[2]["phi_2"] == pytest.approx(-log(1.0 - (exp(0.4) - 1.0) / 2.0) / 0.4)


@pytest.mark.judges("formulas")
@pytest.mark.parametrize("factor", [1.0, 1.5])
def test_a_spline_of_speeds_is_integrated_knot_by_knot(factor: float) -> None:
    """A parabola 1 + phi^2 / 2 with a kink at 0.5, whose pieces begin with what those before have turned."""
    spline = BSpline(np.array([0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0]), np.array([1.0, 1.2, 1.4, 2.0]), 2)
    slope: Any = Made(jets=partial(table.spline_jet, spline))
    parts = list(laws._integrated(PIECE, slope, 0.25, factor))
    whole = spline.antiderivative()
    for part, phi in ((parts[0], 0.3), (parts[1], 0.5), (parts[1], 0.9)):
        one = numbers_of(part, phi)
        assert one["i_12"] == pytest.approx(1.0 / (factor * float(spline(phi))))
        assert one["phi_2"] == pytest.approx(factor * (0.25 + float(whole(phi) - whole(0.0))))


@pytest.mark.judges("formulas")
@at_once(("zero", "factor"), [(0.0, 1.0), (0.3, 1.0), (0.3, 1.7), (0.0, 1.7)])
def test_a_formula_begins_at_nothing_and_is_scaled(zero: float, factor: float) -> None:
    write = laws.FormulaWriter("phi_1")
    (part,) = laws._scaled(PIECE, write, 3 * write.variable, zero, factor)
    assert numbers_of(part, 0.8)["phi_2"] == pytest.approx((2.4 - zero) * factor)
    assert part.ends == (0.0, 1.0)


@pytest.mark.judges("wishes")
@at_once(
    ("missed", "achieved", "kept"),
    [(0.5, 0.2, True), (1.5, 0.2, False), (90.0, 100.0, True), (90.0, -100.0, True), (110.0, 100.0, False)],
)
def test_a_wish_is_kept_but_for_rounding_of_what_is_achieved(missed: float, achieved: float, kept: bool) -> None:
    """A millionth of values over 1, and a millionth itself of smaller ones."""
    unit: Any = None
    wish: Any = None
    assert Outcome(wish, unit, achieved, 0.0, 1.0, missed * NEGLIGIBLE).kept is kept
