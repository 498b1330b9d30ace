"""The load along the face width, against finite elements of beams, closed forms, a ring of balls, other commands."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from math import inf, pi, sqrt

import numpy as np
import pytest

import drives
from at_once import at_once
from commands import Run
from drives import DESIGNS, design_of
from ncgear.drivetrain.bearings import Bearing, stiffness_n_mm
from ncgear.drivetrain.cycle import cycle_of
from ncgear.errors import NoSuchMechanism
from ncgear.figures.advice.given_advice import without_effect
from ncgear.figures.data_sheet.entries import tolerances
from ncgear.figures.strong import _rigid_words, strength_summary
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import changed_drive
from ncgear.project.drive import Drive
from ncgear.project.face_load import RELIEVED, FaceLoading, _best_end_relief
from ncgear.project.rough_strength import rolled_load, rough_mesh, tooth_plan
from ncgear.project.strengthening import crowned_enough, rating_of
from ncgear.strength.conditions import Running
from ncgear.strength.endurance import running_in
from ncgear.strength.face_load import (
    FaceLoads,
    FaceModel,
    LeadForm,
    SteelShaft,
    Support,
    best_fall_mm,
    largest_line_load,
    places_mm,
)
from ncgear.strength.materials import TABLE, Choice
from ncgear.strength.without_teeth import shared_loads
from ncgear.tolerances.iso1328 import helix_slope_mm, rounded_um

E_MPA, G_MPA, SHEARED = 206_000.0, 79_300.0, 10.0 / 9.0

RIGID = SteelShaft(1e5, 1e5, (Support(-100.0), Support(100.0)))

WIDTH = 100.0


def pressed(
    force_n: float,
    stiffness: float = 2e4,
    crank_n: float = 0.0,
    arm_mm: float = 1e6,
    couples_mm: tuple[float, float] = (0.0, 0.0),
) -> FaceLoads:
    each = np.array([force_n]), np.array([stiffness]), np.array([[0.0, crank_n]])
    return FaceLoads(*each, np.array([[arm_mm, arm_mm]]), np.array([couples_mm]))


def factor(model: FaceModel, loads: FaceLoads) -> float:
    return float(model.factors(loads)[0])


@pytest.mark.judges("strength")
@at_once("force_n", [20_000.0, 10_000.0, 9_999.0, 2_000.0, 100.0])
def test_rigid_shafts_with_flanks_askew(force_n: float) -> None:
    """ISO 6336-1, method C: 1 + F c b / (2 F) where all flanks touch, sqrt(2 F c b / F) where a part does."""
    askew, stiffness = 0.01, 2e4
    model = FaceModel((RIGID, RIGID), (None, 0.0), WIDTH, askew, LeadForm())
    over = askew * stiffness * WIDTH / force_n
    expected = 1.0 + over / 2.0 if over <= 2.0 else sqrt(2.0 * over)
    assert factor(model, pressed(force_n, stiffness)) == pytest.approx(expected, rel=1e-6)


def test_perfect_gears_on_rigid_shafts_bear_evenly() -> None:
    model = FaceModel((RIGID, RIGID), (None, 0.0), WIDTH, 0.0, LeadForm())
    assert factor(model, pressed(5000.0)) == pytest.approx(1.0, abs=1e-6)
    assert factor(model, pressed(0.0)) == 1.0


def test_crowned_flanks_on_rigid_shafts() -> None:
    """A parabola C (2 z / b)^2 that touches over the width a: F = 2 c C a^3 / (3 b^2), w = c C (a / b)^2."""
    for reach in (0.3, 0.8):
        force = 2.0 * 2e4 * 0.02 * reach**3 * WIDTH / 3.0
        model = FaceModel((RIGID, RIGID), (None, 0.0), WIDTH, 0.0, LeadForm(crowning_mm=0.02))
        assert factor(model, pressed(force)) == pytest.approx(2e4 * 0.02 * reach**2 * WIDTH / force, rel=0.03)


def test_end_relief_alone() -> None:
    """Ends that fall back by more than the load presses bear nothing: K is b over what is left between them."""
    lead = LeadForm(relief_mm=10.0, relief_length_mm=25.0)
    model = FaceModel((RIGID, RIGID), (None, 0.0), WIDTH, 0.0, lead)
    assert factor(model, pressed(1000.0)) == pytest.approx(2.0, rel=1e-3)


@at_once("askew", [0.0, 0.005, 0.02])
def test_flanks_relieved_up_to_their_middle_bear_worst_if_not_askew(askew: float) -> None:
    """They touch along an edge of slope s = 2 relief / b: F = w^2 / (c s), and on one side of it if askew."""
    relief, force = 0.02, 2000.0
    model = FaceModel((RIGID, RIGID), (None, 0.0), WIDTH, askew, LeadForm(0.0, relief, WIDTH / 2.0))
    assert factor(model, pressed(force)) == pytest.approx(sqrt(2e4 * 2.0 * relief * WIDTH / force), rel=1e-3)


@at_once(
    ("at", "loaded", "expected"),
    [
        # Simply supported, in the middle, and at a quarter of a load in the middle.
        (0.0, 0.0, 200.0**3 / 48.0),
        (-50.0, 0.0, 50.0 * (3.0 * 200.0**2 - 4.0 * 50.0**2) / 48.0),
        # Overhung by 80: its end under a load there, the middle under a load at the end.
        (180.0, 180.0, 80.0**2 * 280.0 / 3.0),
        (0.0, 180.0, -80.0 * 200.0**2 / 16.0),
    ],
)
def test_bent_shafts_by_formulas(at: float, loaded: float, expected: float) -> None:
    """P L^3 / (48 E I) and its like of textbooks, on shafts so slender that shear does not count."""
    shaft = SteelShaft(2.0, 2.0, (Support(-100.0), Support(100.0)))
    inertia = pi * 2.0**4 / 64.0
    found = shaft.compliance(np.array([at]), np.array([loaded]))[0, 0]
    assert found == pytest.approx(expected / (E_MPA * inertia), rel=1e-3)


def test_springs_of_bearings_lean_a_shaft() -> None:
    """A force of 1 N over bearing a presses that spring alone; one in the middle halves both."""
    shaft = SteelShaft(1e5, 1e5, (Support(-100.0, 1e3), Support(100.0, 2e3)))
    found = shaft.compliance(np.array([-100.0, 0.0]), np.array([-100.0, 0.0]))
    assert found == pytest.approx(np.array([[1e-3, 0.5e-3], [0.5e-3, (1e-3 + 0.5e-3) / 4.0]]), rel=1e-6)


# Finite elements: two beams node by node, springs between them; nothing is shared with the model.


def beam_matrix(nodes: Array, diameter: float, supports: tuple[Support, Support]) -> Array:
    """The stiffness of a shaft by Timoshenko's elements with two unknowns at each node, way and slope."""
    inertia, area = pi * diameter**4 / 64.0, pi * diameter**2 / 4.0
    whole = np.zeros((2 * nodes.size, 2 * nodes.size))
    for number, (start, end) in enumerate(pairwise(nodes)):
        length = end - start
        shear = 12.0 * E_MPA * inertia * SHEARED / (G_MPA * area * length**2)
        a, b = 12.0, 6.0 * length
        c, d = (4.0 + shear) * length**2, (2.0 - shear) * length**2
        element = np.array([[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]])
        rows = slice(2 * number, 2 * number + 4)
        whole[rows, rows] += E_MPA * inertia / (length**3 * (1.0 + shear)) * element
    for one in supports:
        row = 2 * int(np.argmin(np.abs(nodes - one.at_mm)))
        whole[row, row] += min(one.stiffness_n_mm, 1e10)
    return whole


def by_elements(model: FaceModel, loads: FaceLoads, count: int = 80) -> float:
    """K_Hbeta by direct stiffness with ``count`` springs along the width, those that would pull taken off in turn.

    Teeth stand on the shaft itself, or on a straight bar that the shaft carries as evenly as it can.
    """
    width = model.width_mm
    across = (np.arange(count) + 0.5) * width / count - width / 2.0
    shafts, matrices, teeth, beside_rows = model.shafts, [], [], []
    for shaft, place in zip(shafts, model.beside_mm, strict=True):
        spans, beside = [one.at_mm for one in shaft.supports], 0.0 if place is None else place
        nodes = np.unique(np.concatenate([across, spans, [beside], np.linspace(-200.0, 200.0, 41)]))
        beside_rows.append(2 * int(np.searchsorted(nodes, beside)))
        matrices.append(beam_matrix(nodes, shaft.diameter_mm, shaft.supports))
        rows = 2 * np.searchsorted(nodes, across)
        pick = np.zeros((count, 2 * nodes.size))
        pick[np.arange(count), rows] = 1.0
        if shaft.body_mm > 10.0 * shaft.diameter_mm:
            line = np.stack([np.ones(count), across], axis=1)
            pick = line @ np.linalg.pinv(line) @ pick
        teeth.append(pick)
    sizes = [len(one) for one in matrices]
    whole = np.zeros((sum(sizes) + 1, sum(sizes) + 1))
    whole[: sizes[0], : sizes[0]], whole[sizes[0] : -1, sizes[0] : -1] = matrices
    force, stiffness = float(loads.force_n[0]), float(loads.stiffness_n_mm2[0]) * width / count
    largest = []
    for sense in (0.0, 1.0, -1.0):
        gap = model.lead.gap_mm(across, width) + sense * model.askew_mm * across / width
        # Approach of both gears: unknown x less the ways of both shafts apart from each other.
        closing = np.concatenate([-teeth[0], -teeth[1], np.ones((count, 1))], axis=1)
        bears = np.ones(count, dtype=bool)
        for _ in range(200):
            held = closing[bears]
            system = whole + stiffness * held.T @ held
            right = stiffness * held.T @ gap[bears]
            right[-1] += force
            right[beside_rows[0]] += float(loads.beside_n[0, 0])
            right[sizes[0] + beside_rows[1]] += float(loads.beside_n[0, 1])
            tilts = across / float(across @ across) * force * loads.couples_mm[0][:, None]
            right[:-1] += np.concatenate([one.T @ tilt for one, tilt in zip(teeth, tilts, strict=True)])
            ways = np.linalg.solve(system, right)
            load = stiffness * (closing @ ways - gap)
            if np.array_equal(load > 0.0, bears):
                break
            bears = load > 0.0
        assert np.array_equal(load > 0.0, bears)
        assert load[bears].sum() == pytest.approx(force, rel=1e-6)
        ends = 1.5 * load[[0, -1]] - 0.5 * load[[1, -2]]
        largest.append(float(max(load.max(), *ends)))
    return max(largest) * count / force


SUPPORTS = (Support(-110.0, 1.5e5), Support(110.0, 1.5e5)), (Support(-120.0, 7e5), Support(130.0, inf))


@at_once("bodies", [1.0, 100.0])
@at_once(
    ("force_n", "crank_n", "askew_mm", "lead", "couples_mm"),
    [
        (20_000.0, 30_000.0, 0.0, LeadForm(), (0.0, 0.0)),
        (20_000.0, -30_000.0, 0.02, LeadForm(), (0.0, 0.0)),
        (3000.0, 9000.0, 0.02, LeadForm(), (0.0, 0.0)),
        (20_000.0, 30_000.0, 0.01, LeadForm(0.01, 0.01, 20.0), (0.0, 0.0)),
        (20_000.0, 0.0, 0.0, LeadForm(), (60.0, 0.0)),
        (20_000.0, 10_000.0, 0.01, LeadForm(), (40.0, -80.0)),
    ],
)
def test_shafts_on_bearings_against_finite_elements(
    force_n: float, crank_n: float, askew_mm: float, lead: LeadForm, couples_mm: tuple[float, float], bodies: float
) -> None:
    """Within 1 %: both have other places along the width and another way to what presses."""
    shafts = [
        SteelShaft(diameter, bodies * diameter, supports)
        for diameter, supports in zip((60.0, 80.0), SUPPORTS, strict=True)
    ]
    model = FaceModel((shafts[0], shafts[1]), (None, 160.0), WIDTH, askew_mm, lead)
    # Bodies that hardly twist, which the elements do not know, by arms that are long.
    loads = pressed(force_n, crank_n=crank_n, couples_mm=couples_mm)
    found, expected = factor(model, loads), by_elements(model, loads)
    assert expected > 1.05
    assert found == pytest.approx(expected, rel=0.01 if bodies == 1.0 else 0.003)


@at_once(
    ("second_n", "second_mm", "crank_n"),
    [(25_000.0, -70.0, 0.0), (-25_000.0, 90.0, 10_000.0), (8000.0, -160.0, -20_000.0)],
)
def test_a_second_gear_on_the_driving_shaft_against_finite_elements(
    second_n: float, second_mm: float, crank_n: float
) -> None:
    """As above, between its bearings and beyond; without its force K_Hbeta is another."""
    shafts = SteelShaft(60.0, 60.0, SUPPORTS[0]), SteelShaft(80.0, 80.0, SUPPORTS[1])
    model = FaceModel(shafts, (second_mm, 160.0), WIDTH, 0.01, LeadForm())
    loads = replace(pressed(20_000.0), beside_n=np.array([[second_n, crank_n]]))
    found = factor(model, loads)
    assert found == pytest.approx(by_elements(model, loads), rel=0.01)
    assert abs(found / factor(model, replace(loads, beside_n=np.array([[0.0, crank_n]]))) - 1.0) > 0.03


def test_a_straight_body_on_a_slender_shaft() -> None:
    """Its load reaches the shaft as evenly as its place follows it: by elements, where that makes a third."""
    slender = SteelShaft(25.0, 2500.0, (Support(-70.0), Support(55.0)))
    model = FaceModel((slender, slender), (None, 160.0), WIDTH, 0.02, LeadForm())
    loads = pressed(20_000.0, crank_n=8000.0)
    assert factor(model, loads) == pytest.approx(by_elements(model, loads), rel=0.003)


def test_bodies_twist_by_a_closed_form() -> None:
    """A pinion on a rigid shaft: (G J / r^2) (x - w / c)'' = w; the driven gear twists from its other end.

    With w = c v, v'' = k^2 v where only the driving gear twists, and v' = 0 at the far end: cosh.
    """
    radius, stiffness = 25.0, 2e4
    pinion = SteelShaft(40.0, 2.0 * radius, (Support(-100.0), Support(100.0)))
    pinion = replace(pinion, diameter_mm=2.0 * radius, body_mm=2.0 * radius, supports=(Support(-51.0), Support(51.0)))
    model = FaceModel((pinion, RIGID), (None, 0.0), WIDTH, 0.0, LeadForm())
    bent = FaceModel((replace(pinion, body_mm=2e3), RIGID), (None, 0.0), WIDTH, 0.0, LeadForm())
    at = places_mm(WIDTH, LeadForm())
    twisting = model._twist(at, np.array([[radius, inf]]))[0]
    # The driving gear twists against its end away from the crank, the driven gear against the crank's.
    crank_far = replace(model, beside_mm=(None, 60.0))
    ends = crank_far._twist(at, np.array([[radius, inf], [inf, radius]]))
    assert (ends[0, 0, 0], ends[1, -1, -1]) == (0.0, 0.0)
    assert min(ends[0, -1, -1], ends[1, 0, 0]) > 0.0
    k = sqrt(stiffness * radius**2 / (G_MPA * pi * radius**4 / 2.0)) * WIDTH
    expected = k / np.tanh(k)
    force = np.array([1000.0])
    found = largest_line_load(at, np.zeros((1, 1, 17)), twisting[None], np.array([stiffness]), force) * WIDTH / force
    assert found[0, 0] == pytest.approx(expected, rel=1e-3)
    assert expected > 1.05
    assert factor(bent, pressed(1000.0)) < factor(model, pressed(1000.0, arm_mm=radius))


def test_a_body_of_plastic_bends_with_its_shaft() -> None:
    """Twice as thick, (2^4 - 1) times I of the shaft: of steel it leaves 1/16 of the bending, of POM 1 / 1.2."""
    steel = SteelShaft(40.0, 80.0, SUPPORTS[0])
    assert steel.bent_teeth == pytest.approx(1.0 / 16.0, rel=1e-12)
    assert replace(steel, body_mpa=E_MPA / 75.0).bent_teeth == pytest.approx(1.0 / 1.2, rel=1e-12)
    assert replace(steel, body_mm=30.0).bent_teeth == 1.0


def test_wider_spans_are_worse() -> None:
    spans = [SteelShaft(60.0, 60.0, (Support(-half), Support(half))) for half in (100.0, 150.0, 200.0)]
    found = [factor(FaceModel((one, RIGID), (None, 0.0), WIDTH, 0.0, LeadForm()), pressed(20_000.0)) for one in spans]
    crank = [
        factor(
            FaceModel((RIGID, replace(one, body_mm=600.0)), (None, 260.0), WIDTH, 0.0, LeadForm()),
            pressed(2e4, crank_n=2e4),
        )
        for one in spans
    ]
    assert 1.0 < found[0] < found[1] < found[2]
    assert min(crank) > 1.05


def test_what_is_not_balanced_is_refused() -> None:
    """A compliance that is no number, as no shaft has, is not passed on."""
    with pytest.raises(NoSuchMechanism, match="along the face width is not found"):
        largest_line_load(
            np.arange(17.0), np.zeros((1, 1, 17)), np.full((1, 17, 17), np.nan), np.array([2e4]), np.array([1e3])
        )


@pytest.mark.slow
def test_the_best_crowning_and_end_reliefs_against_a_scan() -> None:
    """Two positions whose loads lean to different ends; a scan in steps of 0.2 um, and none for perfect gears."""
    shafts = RIGID, SteelShaft(80.0, 300.0, SUPPORTS[1])
    model = FaceModel(shafts, (None, 260.0), WIDTH, 0.015, LeadForm())
    each = np.array([2e4, 1.5e4]), np.array([2e4, 1.4e4]), np.array([[0.0, 3e4], [0.0, -1e4]])
    loads = FaceLoads(*each, np.full((2, 2), 1e6), np.zeros((2, 2)))
    most = np.array([1.8e4, 1.5e4])

    def largest(lead: LeadForm) -> float:
        return float(np.max(replace(model, lead=lead).factors(loads) * most))

    perfect = FaceModel((RIGID, RIGID), (None, 0.0), WIDTH, 0.0, LeadForm())
    forms: list[Callable[[float], LeadForm]] = [LeadForm]
    forms += [lambda mm, share=share: LeadForm(0.0, mm, share * WIDTH) for share in RELIEVED]
    for form in forms:
        found, load = best_fall_mm(model, loads, most, form)
        scanned = min(np.arange(0.0, 0.05, 2e-4), key=lambda mm, form=form: largest(form(mm)))
        assert found == pytest.approx(scanned, abs=5e-4)
        assert load == largest(form(found))
        assert load < 0.97 * largest(LeadForm())
        assert best_fall_mm(perfect, loads, most, form)[0] == 0.0
    ends = _best_end_relief(model, (loads, most))
    assert ends.relief_length_mm / WIDTH in RELIEVED
    assert largest(ends) < 1.01 * min(largest(form(mm)) for form in forms[1:] for mm in np.arange(0.0, 0.03, 1e-3))
    # Ends that a great crowning leaves alone gain nothing by a relief
    crowned = LeadForm(0.5)
    both = _best_end_relief(replace(model, lead=crowned), (loads, most))
    assert both.crowning_mm == 0.5
    assert largest(both) == pytest.approx(largest(crowned), rel=1e-3)


def ball_way_mm(force_n: float, balls: int, ball_mm: float) -> float:
    """How far a ring of balls gives way by Hertz, with races of 0.52 of the ball and a pitch circle of 5.5 of it.

    Elliptic integrals by B. J. Hamrock and D. Brewe, Trans. ASME F 105 (1983).
    """
    plane = E_MPA / (1.0 - 0.3**2)
    ways = 0.0
    for race in (1.0 / (5.5 - 1.0) * 2.0, -1.0 / (5.5 + 1.0) * 2.0):
        along = 1.0 / (2.0 / ball_mm + race / ball_mm)
        aside = 1.0 / (2.0 / ball_mm - 1.0 / (0.52 * ball_mm))
        radius, ratio = along * aside / (along + aside), aside / along
        ellipse, first, second = (
            1.0339 * ratio**0.636,
            1.5277 + 0.6023 * np.log(ratio),
            1.0003 + 0.5968 / ratio,
        )
        stiffness = pi * ellipse * plane * sqrt(2.0 * second * radius / (4.5 * first**3)) / 2.0**0.5
        ways += (1.0 / stiffness) ** (2.0 / 3.0)
    angles = 2.0 * pi * np.arange(balls) / balls
    shares = np.maximum(np.cos(angles), 0.0) ** 2.5
    return float((force_n / shares.sum()) ** (2.0 / 3.0) * ways)


def test_balls_give_way_as_by_hertz() -> None:
    """Within a third of a ring of balls without play, softer as usual play makes it; sizes of 6210 from its rating."""
    bearing = Bearing(0.0, "ball", None, 23_200.0)
    expected = 10_000.0 / ball_way_mm(10_000.0, 10, 12.7)
    found = stiffness_n_mm(bearing, 10_000.0)
    assert 0.67 * expected < found < 1.1 * expected
    assert stiffness_n_mm(replace(bearing, stiffness_n_mm=5e5), 1e4) == 5e5
    assert stiffness_n_mm(replace(bearing, static_rating_n=None), 1e4) == inf


def test_rollers_give_way_as_by_palmgren() -> None:
    """16 rollers of 11 x 12 mm, 69 500 N by ISO 76: 44 (1 - 0.15) 16 11 12 = 79 000; within a tenth."""
    expected = 1e4 / (7.68e-5 * (5.0 * 1e4 / 16.0) ** 0.9 / 12.0**0.8)
    assert stiffness_n_mm(Bearing(0.0, "roller", None, 69_500.0), 1e4) == pytest.approx(expected, rel=0.1)


def test_helix_slopes_of_iso_1328() -> None:
    """d = 100, b = 20, class 5: 0.5 + 1.565 + 4 um; sqrt(2) of it a class."""
    assert rounded_um(helix_slope_mm(5, 100.0, 20.0)) == 6.0
    assert helix_slope_mm(7, 100.0, 20.0) == pytest.approx(2.0 * helix_slope_mm(5, 100.0, 20.0), rel=1e-14)


def test_running_in_of_materials() -> None:
    slow, fast = Running(10.0, (50, 50), 100.0, 6.3), Running(10.0, (50, 50), 100.0, 30.0)

    def worn(name: str, running: Running = slow, askew: float = 0.02) -> float:
        return running_in(Choice(TABLE[name]), running, askew)

    assert worn("GJL-250") == pytest.approx(0.011, rel=1e-12)
    assert worn("18CrNiMo7-6") == pytest.approx(0.003, rel=1e-12)
    assert worn("18CrNiMo7-6", askew=0.1) == pytest.approx(0.006, rel=1e-12)
    assert worn("POM") == 0.0
    own = Choice(TABLE["42CrMo4"], contact_limit_mpa=640.0)
    assert running_in(own, slow, 0.02) == pytest.approx(0.01, rel=1e-12)
    assert running_in(own, fast, 0.2) == pytest.approx(25.6 / 640.0, rel=1e-12)


# The whole drive.


DATA = drives.loaded("baler-drivetrain").data


def changed(**sections: dict[str, object]) -> Drive:
    """The drive of baler-drivetrain with other keys in some sections."""
    data = DATA
    for name, values in sections.items():
        data = {**data, name: {**data.get(name, {}), **values}}
    return Drive(design_of(data))


def test_what_is_missing_is_assumed_and_told() -> None:
    """Negative controls: no drivetrain, bearings of one shaft only, a factor of the person's own."""
    plain = drives.drive("pusher").face_loading
    assert (plain.basis, plain.constant, plain.why) == ("assumed", 1.3, "drivetrain is not given")
    without = {key: value for key, value in DATA["drivetrain"].items() if key != "driving_shaft"}
    half = Drive(design_of({**DATA, "drivetrain": without})).face_loading
    assert (half.basis, half.why) == ("assumed", "drivetrain gives no bearings of the driving shaft")
    own = changed(strength={"face_load_factor": 1.1}).face_loading
    assert (own.basis, own.constant) == ("given", 1.1)


def test_the_data_sheet_has_the_form_along_the_width() -> None:
    lead = {"crowning_um": 8.0, "end_relief_um": 12.0, "end_relief_length_mm": 10.0}
    rows = {entry.label: entry.pair for entry in tolerances(changed(gears={"lead": lead}))}
    assert rows["lead crowning of both gears together"] == 8.0
    assert rows["end relief of both gears together"] == 12.0
    assert rows["length of the end relief"] == 10.0
    straight = [entry.label for entry in tolerances(drives.drive("baler-drivetrain"))]
    assert not any("crowning" in label or "end relief" in label for label in straight)


def test_flanks_askew_by_grade_tilt_and_running_in() -> None:
    """Grade 8 of either gear is assumed; a section without a grade has the tilts alone; 750 MPa of 42CrMo4."""

    def askew(**tolerances: object) -> float:
        model = (changed(tolerances=tolerances) if tolerances else changed()).face_loading.model
        assert model is not None
        return model.askew_mm

    slope = helix_slope_mm(8, 500.0, 100.0)
    kept = askew() / (slope * 2.0**0.5)
    assert 0.5 < kept < 0.65
    assert askew(grade=6) == pytest.approx(askew() / 2.0, rel=1e-12)
    assert askew(center_distance_mm=0.1) == 0.0
    tilted = askew(driving={"tilt_deg": 0.01})
    assert tilted == pytest.approx(kept * 100.0 * np.tan(np.radians(0.01)), rel=1e-12)


def test_keys_without_effect_are_told() -> None:
    """A diameter counts where bearings do, without any steel; a stiffness not beside a factor of one's own."""
    shafts = {name: dict(DATA["drivetrain"][name]) for name in ("driving_shaft", "driven_shaft")}
    for shaft in shafts.values():
        del shaft["steel"], shaft["key"]
        shaft["diameter_mm"] = 50.0
    shafts["driving_shaft"]["bearing_a"] = {"at_mm": -110.0, "stiffness_n_per_um": 300.0}

    def told(**strength: object) -> str:
        drive = changed(drivetrain=shafts, strength=strength)
        return " ".join(one.what for one in without_effect(drive))

    assert "stiffness" not in told()
    assert "diameter" not in told()
    assert "driving_shaft.bearing_a.stiffness_n_per_um" in told(face_load_factor=1.2)
    assert "driven_shaft.diameter_mm" in told(face_load_factor=1.2)


@pytest.mark.slow
class TestBalerDrivetrain:
    """The one worked design with bearings, and what its shafts make of its teeth."""

    def test_the_forces_press_as_the_teeth_touch(self) -> None:
        """The direction of the mesh force is that of the flanks' normals, turned into the mechanism's frame."""
        drive = drives.drive("baler-drivetrain")
        contacts, loading = drive.strength_by("estimate").contacts, drive.face_loading
        assert loading.asked is not None
        normal = contacts.driving_inwards * np.exp(1j * contacts.phi1_rad)
        mesh = loading.asked.mesh_force(contacts.phi1_rad, 1.0 - 2.0 * contacts.side)
        force = mesh.force.x.value + 1j * mesh.force.y.value
        turned = normal / (-force / np.abs(force))
        flanks = contacts.flanks
        assert np.abs(turned[flanks] - 1.0).max() < 2e-2

    def test_the_crank_presses_as_its_bearings_feel(self) -> None:
        """Beside the loads of bearings, which follow from the machine with its gears in their places."""
        drive = drives.drive("baler-drivetrain")
        loads = cycle_of(drive.rigid).loads
        (first,), (second,) = (shaft.gears for shaft in loads.shafts)
        urge = np.where(second.torque_n_mm < 0.0, -1.0, 1.0)
        force = np.abs(second.force_n)
        found = drive.face_loading.pressing(loads.phi1_rad, urge, force, urge, 1.5, np.full(force.shape, 2.0))
        assert found.force_n == pytest.approx(3.0 * force)
        towards = second.force_n / np.abs(second.force_n)
        expected = 1.5 * np.real(loads.shafts[1].crank_n * np.conj(towards))
        assert found.beside_n[:, 1] == pytest.approx(expected, rel=1e-9, abs=1e-6 * np.abs(expected).max())
        assert not found.beside_n[:, 0].any()
        turning = np.abs(found.arms_mm * np.abs(second.force_n)[:, None])
        assert turning[:, 1] == pytest.approx(np.abs(second.torque_n_mm), rel=1e-9, abs=1.0)
        assert turning[:, 0] == pytest.approx(np.abs(first.torque_n_mm), rel=1e-9, abs=1.0)

    def test_the_load_along_the_width(self) -> None:
        """The leaning of the crank's overhang alone makes little, flanks askew by grade 8 more, crowning cures most."""
        drive = drives.drive("baler-drivetrain")
        told = drive.told_face_load_by("estimate")
        assert told is not None
        assert 1.0 < told.decisive_factor_by_shafts < 1.2
        assert 1.5 < told.decisive_factor < 1.8
        assert told.factor_min < 0.9 * told.decisive_factor
        assert told.factor_max > 1.1 * told.decisive_factor
        assert drive.face_loading.model is not None
        for gear, shaft in zip(Gear, drive.face_loading.model.shafts, strict=True):
            least = 2.0 * drive.pitch.radius_range_mm(gear)[0]
            assert 0.6 * least < shaft.body_mm < least
        assert 4.0 <= told.best_crowning_um <= 10.0
        assert told.best_crowning_factor < 0.85 * told.decisive_factor

    def test_crowning_is_what_would_help(self) -> None:
        """With grade 10 flanks pit; the remedy is the best crowning, and its teeth hold."""
        coarse = changed(tolerances={"grade": 10})
        rating = rating_of(coarse, "estimate")
        assert not rating.holds
        changes = crowned_enough(coarse, rating)
        assert set(changes) == {"gears.lead.crowning_um"}
        assert rating_of(changed_drive(coarse, changes), "estimate").holds

    def test_every_place_against_finite_elements(self) -> None:
        """Twelve positions of the cycle, bodies as straight as they nearly are."""
        drive = drives.drive("baler-drivetrain")
        loading: FaceLoading = drive.face_loading
        assert loading.model is not None
        strength = drive.strength_by("estimate")
        loads = loading.loads_of(strength.contacts, 1.0, strength.stresses.dynamic_factor)
        heavy = np.flatnonzero(loads.force_n > 0.3 * loads.force_n.max())[::25]
        assert heavy.size > 5
        loads = replace(loads, arms_mm=np.full(loads.arms_mm.shape, 1e6))
        straight = [replace(one, body_mm=1e4) for one in loading.model.shafts]
        model = replace(loading.model, shafts=(straight[0], straight[1]))
        found = loading.model.factors(loads.kept(heavy))
        for row, one in zip(heavy, found, strict=True):
            assert one == pytest.approx(by_elements(model, loads.kept(np.array([row]))), rel=0.02)

    @pytest.mark.long
    def test_all_commands_tell_the_same(self, run: Run) -> None:
        """The factor of the place that bears most, in strength, build and what size and remedies rate."""
        drive = drives.drive("baler-drivetrain")
        path = str(DESIGNS / "baler-drivetrain.yaml")
        told = json.loads(run("strength", path, "--json")[1])
        summary = drives.built("baler-drivetrain").summary["strength"]
        assert {key: summary[key] for key in told["strength"]} == told["strength"]
        assert told["strength"]["face_load"] == "computed"
        assert told["face_load"]["decisive_factor"] == told["strength"]["face_load_factor"]
        again = changed_drive(drive, {"gears.backlash_share": 0.5})
        assert strength_summary(rating_of(again, "estimate"), again) == told["strength"]

    def test_without_teeth_it_is_as_uneven(self) -> None:
        """K_Hbeta of a rough strength where the load is the largest, within a tenth of that with teeth."""
        drive = drives.drive("baler-drivetrain")
        load = rolled_load(drive)
        sides = shared_loads(load, tooth_plan(drive), drive.running, drive.materials)
        mesh = rough_mesh(drive, sides, load)
        model, strength = drive.face_loading.model, drive.strength_by("estimate")
        assert model is not None
        contacts, factors = strength.contacts, strength.stresses.face_load_factor
        for one in sides:
            row = int(one.load.force_n.argmax())
            shaken = drive.vibration.factors(one.load.phi1_rad, one.load.force_n, mesh, drive.conditions)
            rough = float(drive.face_loading.of_side(one, 1.0, shaken)[row])
            loads = drive.face_loading.loads_of(contacts, 1.0, np.ones(contacts.force_n.size))
            near = np.abs(contacts.phi1_rad - one.load.phi1_rad[row])
            same = (contacts.side == (0 if one.load.urge[0] > 0.0 else 1)) & (near < 0.05)
            similar = np.abs(loads.force_n[contacts.position] / one.load.force_n[row] - 1.0) < 0.05
            assert np.any(same & similar)
            assert rough == pytest.approx(float(np.median(factors[same & similar])), rel=0.1)


def test_bearings_without_a_rating_are_told() -> None:
    """They count as rigid, each by its key; none where nothing is computed."""
    stiff, soft = Support(-50.0), Support(60.0, 2e5)
    shafts = SteelShaft(40.0, 80.0, (stiff, soft)), SteelShaft(40.0, 80.0, (soft, stiff))
    found = FaceLoading("computed", model=FaceModel(shafts, (None, 90.0), 30.0, 0.0, LeadForm()))
    assert found.rigid_bearings == ["bearing_a of the driving shaft", "bearing_b of the driven shaft"]
    assert _rigid_words(found).endswith("bearing_b of the driven shaft count as rigid")
    assert FaceLoading("assumed").rigid_bearings == []
    assert _rigid_words(FaceLoading("assumed")) == ""
