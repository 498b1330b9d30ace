"""Tolerances: eccentric circular gears in closed form, polygons that turn until they touch, another program."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from math import acos, cos, pi, radians, sin, sqrt, tan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import Polygon, affinity

from at_once import at_once
from commands import Run
from drives import DESIGNS, design_of, drive, drive_of_text, loaded
from ncgear.contact.placement import BACK, PUSHING, Placement, placed
from ncgear.design.keys.tolerances import AssemblyTolerances, GearTolerances, Temperatures
from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.tolerance import PER_TOOTH, face_of, lot_of, tolerated
from ncgear.project.tolerance_limits import USUAL, Process, limits_of
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Pair, on_driving_shaft
from ncgear.teeth.form import Backlash, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from ncgear.tolerances.assemblies import (
    Assemblies,
    BetweenAngles,
    Lot,
    PairLot,
    Smoothed,
    Waves,
    computed,
    lot_of_pairs,
)
from ncgear.tolerances.drawn import (
    COUNT,
    SOURCES,
    Chances,
    DeviationLimits,
    DeviationSource,
    active,
    drawn,
    reachable,
    rows_of,
    sources_of,
    spread,
)
from ncgear.tolerances.iso1328 import flank_tolerances, rounded_um
from ncgear.tolerances.mesh import RIGID, Deviations, Face, LinearMesh, arc_rates, mesh_of, straight_face
from ncgear.tolerances.outlines import exact_of, linear_errors, on_sides
from ncgear.tolerances.study import (
    Workers,
    assemblies_of,
    between_positions,
    drawn_at_random,
    drawn_evenly,
    enough_samples,
    first_order,
    jammed,
    signs_of,
    sobol_indices_of,
    sobol_tasks,
    surpassed,
)
from pairs import rack

ALPHA = radians(20.0)

Made: Any = SimpleNamespace

ASSUMED = USUAL[Process.GENERATED]

# --- grades ------------------------------------------------------------------------------------------------------


@pytest.mark.judges("tolerances")
def test_grades_are_those_of_iso_1328() -> None:
    """The worked example of another program after ISO 1328-1:2013: class 6, 40 teeth of module 3."""
    found = flank_tolerances(6, np.array(120.0), 3.0)
    assert 1e3 * found.single_pitch_mm == pytest.approx((0.12 + 1.2 + 5.0) * sqrt(2.0), rel=1e-12)
    figures = found.single_pitch_mm, found.total_profile_mm
    assert [rounded_um(float(one)) for one in figures] == [9.0, 12.0]


@pytest.mark.judges("tolerances")
def test_grades_of_large_gears_are_those_of_the_formulas() -> None:
    """By hand, class 5, 900 mm and module 40: 0.9 + 16 + 5; 16 + 0.9 + 4; 22 + 5 micrometres."""
    found = flank_tolerances(5, np.array(900.0), 40.0)
    each = found.single_pitch_mm, found.profile_slope_mm, found.profile_form_mm
    assert [1e3 * float(one) for one in each] == pytest.approx([21.9, 20.9, 27.0], rel=1e-12)
    assert 1e3 * float(found.total_profile_mm) == pytest.approx(sqrt(20.9**2 + 27.0**2), rel=1e-12)


@at_once("expansions", [(12e-6, 80e-6, 23e-6), (80e-6, 12e-6, 23e-6), (12e-6, 11e-6, 60e-6)])
def test_flanks_are_displaced_by_no_more_than_is_told(expansions: tuple[float, float, float]) -> None:
    """Radii that grow with their gears at both temperatures, a centre distance that grows with its housing."""
    none = np.zeros(8)
    limits = DeviationLimits(0.04, (0.01, 0.02), (0, 0), (0, 0), none, none, (-10.0, 90.0), 15.0, expansions, (0, 0))
    driving, driven, housing = expansions
    told = limits.displaced_mm(100.0) - 0.07
    for share in (0.2, 0.5, 0.8):
        for warm in (-30.0, 70.0):
            for warmer in (0.0, 15.0):
                radii = 100.0 * (share * driving + (1.0 - share) * driven) * (warm + warmer)
                assert abs(radii - 100.0 * housing * warm) <= told
    assert told <= 100.0 * max(expansions) * 85.0 * (1.0 + 1e-12)


@at_once(("value_um", "told"), [(4.94, 4.9), (4.96, 5.0), (7.3, 7.5), (10.4, 10.0), (28.8, 29.0)])
def test_grades_are_rounded_as_on_drawings(value_um: float, told: float) -> None:
    assert rounded_um(1e-3 * value_um) == told


def test_two_grades_are_a_factor_of_two_apart() -> None:
    coarse, fine = (flank_tolerances(grade, np.array([20.0, 400.0]), 2.0) for grade in (9, 7))
    assert coarse.total_profile_mm == pytest.approx(2.0 * fine.total_profile_mm, rel=1e-14)


# --- eccentric circular gears, in closed form --------------------------------------------------------------------

TEETH, DRIVEN_TEETH, MODULE, PLAY_MM, WIDTH_MM = 30, 60, 2.0, 0.4, 20.0
BASES_MM = TEETH * MODULE / 2.0 * cos(ALPHA), DRIVEN_TEETH * MODULE / 2.0 * cos(ALPHA)
DISTANCE_MM = (TEETH + DRIVEN_TEETH) * MODULE / 2.0


@cache
def circular() -> tuple[PitchPair, ToothedPair, Placement, LinearMesh]:
    """A pair of circular gears, 1:2."""
    pitch = sized_pair(uniform_law(Lobes(1, 2)), TEETH, MODULE, None)
    teeth = toothed_pair(pitch, ToothForm(rack(), backlash=Backlash(PLAY_MM)), 0.005)
    placement = placed(pitch, 8)
    return pitch, teeth, placement, mesh_of(straight_face(teeth, WIDTH_MM), placement, 0.3)


def deviations(flanks: int, count: int, **moved: Array | float) -> Deviations:
    """Assemblies that deviate only as a whole, by the names of RIGID."""
    rigid = np.zeros((len(RIGID), count))
    for name, size in moved.items():
        rigid[RIGID.index(name)] = size
    return Deviations(
        rigid, np.zeros((4, count)), np.zeros((flanks, count)), np.zeros((flanks, count)), np.zeros(count)
    )


def of_circular(**moved: Array | float) -> Deviations:
    return deviations(2 * (TEETH + DRIVEN_TEETH), 1, **moved)


def involute(angle: Array | float) -> Array:
    return np.asarray(np.tan(angle) - angle)


def closed_form(of: Deviations, placement: Placement, nominal_mm: tuple[float, float] = BASES_MM) -> Array:
    """Leads of both sides from the common tangents of the base circles about the true centres, shape (2, p).

    With base radii r1, r2, the distance A and direction b of the centres and cos(w) = (r1 + r2) / A, unwinding both
    involutes along the tangent gives r2 phi2 = r1 phi1 - (r1 + r2) (b + inv w) + constant for one side of the teeth and
    the same with -inv w for the other.
    """
    moved = dict(zip(RIGID, of.rigid[:, 0], strict=True))
    turn = np.exp(1j * placement.phi1_rad), np.exp(-1j * placement.phi2_rad)
    first = (moved["driving_x"] + 1j * moved["driving_y"]) * turn[0]
    second = (moved["driven_x"] + 1j * moved["driven_y"]) * turn[1]
    between = DISTANCE_MM * (1.0 + moved["housing_growth"]) + moved["center_distance"] + second - first
    bases = nominal_mm[0] * (1.0 + moved["driving_growth"]), nominal_mm[1] * (1.0 + moved["driven_growth"])
    working = np.arccos(sum(bases) / np.abs(between))
    share = sum(bases) / bases[1]
    ratio = bases[0] / bases[1]
    turned = (ratio - nominal_mm[0] / nominal_mm[1]) * placement.phi1_rad + ratio * moved["driving_index"]
    ahead = turned - share * np.angle(between)
    play = PLAY_MM / nominal_mm[1]
    opened = share * (involute(working) - involute(ALPHA))
    return np.stack([ahead - opened, -(ahead + opened + play)])


CASES: dict[str, dict[str, float]] = {
    "centre distance": {"center_distance": 0.04},
    "closer": {"center_distance": -0.04},
    "driving bore": {"driving_x": 0.03, "driving_y": -0.02},
    "driven bore": {"driven_x": -0.02, "driven_y": 0.035},
    "index": {"driving_index": 0.002},
    "housing": {"housing_growth": 4e-4},
    "everything": {"center_distance": 0.02, "driving_x": 0.02, "driven_y": 0.02, "driving_index": 0.001},
}


def error_of(moved: dict[str, float]) -> tuple[float, float]:
    """Largest difference of the mesh from the closed form, and the largest displacement, as driven angles."""
    _, _, placement, mesh = circular()
    of = of_circular(**moved)
    found, nominal = mesh.leads(of)[:, :, 0], mesh.leads(of_circular())[:, :, 0]
    exact = closed_form(of, placement)
    assert nominal[0] == pytest.approx(0.0, abs=1e-11)
    return float(np.abs(found - exact).max()), float(np.abs(exact - closed_form(of_circular(), placement)).max())


@pytest.mark.judges("tolerances")
@at_once("name", CASES)
def test_displaced_circular_gears_touch_as_in_closed_form(name: str) -> None:
    """What is left is of second order: a quarter of the deviation leaves a sixteenth of it, and it is some per cent."""
    error, size = error_of(CASES[name])
    assert error < 0.05 * size
    quarter, _ = error_of({key: value / 4.0 for key, value in CASES[name].items()})
    assert quarter < error / 12.0 + 1e-11


def test_an_eccentricity_of_the_wrong_sign_fails() -> None:
    """Negative control."""
    _, _, placement, mesh = circular()
    found = mesh.leads(of_circular(driving_x=-0.03, driving_y=0.02))[:, :, 0]
    exact = closed_form(of_circular(driving_x=0.03, driving_y=-0.02), placement)
    assert np.abs(found - exact).max() > 1.5 * np.abs(exact[PUSHING]).max()


def test_an_eccentric_gear_errs_by_twice_its_eccentricity_over_the_base_radius() -> None:
    _, _, _, mesh = circular()
    error = mesh.leads(of_circular(driving_x=0.03))[PUSHING, :, 0]
    assert np.ptp(error) == pytest.approx(2.0 * 0.03 / BASES_MM[1], rel=1e-3)


def test_growth_of_gears_is_that_of_their_base_circles() -> None:
    """Both gears and the housing alike change no angle; the gears alone act as a centre distance that is too small."""
    _, _, _, mesh = circular()
    alike = mesh.leads(of_circular(driving_growth=5e-4, driven_growth=5e-4, housing_growth=5e-4))
    assert alike == pytest.approx(mesh.leads(of_circular()), abs=1e-9)
    error, size = error_of({"driving_growth": 4e-4, "driven_growth": 4e-4})
    assert error < 0.05 * size


def test_worn_pushing_flanks_let_the_driven_gear_fall_back() -> None:
    _, _, _, mesh = circular()
    lead = mesh.leads(of_circular(driving_wear=0.03, driven_wear=0.02)) - mesh.leads(of_circular())
    assert lead[PUSHING] == pytest.approx(-0.05 / BASES_MM[1], rel=1e-9)
    assert lead[BACK] == pytest.approx(0.0, abs=1e-12)


def test_one_tooth_that_stands_out_carries_alone() -> None:
    """By x along the pitch circle it pushes the driven gear on by x cos(alpha) over the base radius, and one does."""
    _, _, _, mesh = circular()
    of = of_circular()
    flank = 4
    # The driving gear pushes with its back flanks, which have even numbers.
    of.pitch[flank] = 0.02
    gained = (mesh.leads(of) - mesh.leads(of_circular()))[PUSHING, :, 0]
    assert gained.max() == pytest.approx(0.02 * cos(ALPHA) / BASES_MM[1], rel=1e-9)
    pitches = np.count_nonzero(gained > 0.5 * gained.max()) / 8.0
    arc = mesh.arcs.min()
    # Each of the meetings of two driving turns, over its own arc and a little by its corners.
    assert 2.0 * arc < pitches < 2.0 * (arc + 0.5)


def test_tilted_bores_touch_first_at_one_end() -> None:
    """A tilt t of the driving bore runs the end sections out by t b/2: the normal's part of it, never less than 0."""
    _, _, _, mesh = circular()
    of = of_circular()
    of.tilt[0] = 1e-3
    gained = (mesh.leads(of) - mesh.leads(of_circular()))[PUSHING, :, 0]
    peak = 1e-3 * WIDTH_MM / 2.0 / BASES_MM[1]
    assert gained.min() >= 0.0
    assert gained.max() == pytest.approx(peak, rel=2e-3)
    # |cos| has the mean 2 / pi.
    assert gained.mean() == pytest.approx(2.0 / pi * peak, rel=2e-2)


@pytest.mark.parametrize("moved_mm", [0.08, -0.08])
def test_the_arc_of_contact_changes_with_the_centre_distance_as_in_closed_form(moved_mm: float) -> None:
    _, _, _, mesh = circular()

    def ratio(distance: float) -> float:
        working = acos(sum(BASES_MM) / distance)
        tips = (teeth * MODULE / 2.0 + MODULE for teeth in (TEETH, DRIVEN_TEETH))
        reach = sum(sqrt(tip**2 - base**2) for tip, base in zip(tips, BASES_MM, strict=True))
        return (reach - distance * sin(working)) / (pi * MODULE * cos(ALPHA))

    found = float(mesh.least_arcs(of_circular(center_distance=moved_mm))[0])
    change = ratio(DISTANCE_MM + moved_mm) - ratio(DISTANCE_MM)
    assert float(mesh.arcs.min()) == pytest.approx(ratio(DISTANCE_MM), rel=1e-6)
    assert found - mesh.arcs.min() == pytest.approx(change, rel=2e-2)


# --- two pairs in series -----------------------------------------------------------------------------------------

BETWEEN_RAD = 1e-3
"""Keyway of the gear that is driven on the shaft between."""


@cache
def two_circular() -> tuple[Placement, Placement, Lot]:
    """A pair of 30 and 60 teeth, then one of 60 and 30: the crank turns as fast as the driving shaft."""
    placements, made = [], []
    for lobes, turns in ((Lobes(1, 2), 1.0), (Lobes(2, 1), 2.0)):
        law = uniform_law(lobes)
        pitch = sized_pair(law, TEETH * lobes.driving, MODULE, None)
        placement = placed(pitch, 8)
        teeth = toothed_pair(pitch, ToothForm(rack(), backlash=Backlash(PLAY_MM)), 0.005)
        none = np.zeros(2 * (TEETH + DRIVEN_TEETH))
        limits = DeviationLimits(0.0, (0, 0), (0, 0), (0, 0), none, none, (20.0, 20.0), 0.0, (0.0, 0.0, 0.0), (0, 0))
        pair = Pair(law, np.ones_like, lambda angle, turns=turns: turns * angle)  # type: ignore[misc]
        placements.append(placement)
        made.append((mesh_of(straight_face(teeth, WIDTH_MM), placement, 0.3), limits, np.arange(placement.count), pair))
    machine = replace(drive("ellipse").machine, transmission=uniform_law(Lobes()))
    return (*placements, lot_of_pairs(machine, made, TEETH, 1.0))  # type: ignore[return-value]


@pytest.mark.judges("tolerances")
def test_two_eccentric_pairs_err_by_the_ratio_times_the_first_and_by_the_second() -> None:
    """Against the common tangents of each pair, the second one turned by the first; nothing in it is linear."""
    first, second, lot = two_circular()
    of = of_circular(driving_x=0.02, driven_y=0.03), of_circular(driving_y=-0.03, center_distance=0.02)
    of[0].output_rad[:] = BETWEEN_RAD
    positions = np.linspace(0.0, 4.0 * pi, 400, endpoint=False)
    before = replace(first, phi1_rad=positions, phi2_rad=positions / 2.0)
    ahead = closed_form(of[0], before)[PUSHING] + BETWEEN_RAD
    turned = positions / 2.0 + ahead
    after = replace(second, phi1_rad=turned, phi2_rad=2.0 * turned)
    exact = 2.0 * ahead + closed_form(of[1], after, BASES_MM[::-1])[PUSHING]
    found = lot.assembled(of)
    assert found.transmission_error_rad[0] == pytest.approx(np.ptp(exact), rel=0.02)
    # Negative controls: errors that are added as they are, and the keyway between left out of the output's error.
    assert found.transmission_error_rad[0] != pytest.approx(np.ptp(exact - ahead), rel=0.1)
    without = lot.assembled((replace(of[0], output_rad=np.zeros(1)), of[1]))
    assert found.motion_error[0] > 1.2 * without.motion_error[0]
    plays = [pair.least_play_rad[0] for pair in found.pairs]
    assert found.play_max_rad[0] > 2.0 * plays[0] + plays[1]
    single = closed_form(of[0], first)
    assert plays[0] == pytest.approx(float(-single.sum(axis=0).max()), rel=5e-3)


def test_a_source_is_exchanged_in_its_own_pair_and_what_both_share_in_both() -> None:
    limits = all_limits(4), all_limits(6)
    names = [source.key for source in sources_of(limits)]
    assert len(names) == len(set(names)) == 2 * (len(SOURCES) + 2) - 2
    assert {"stage_1_pitch", "stage_2_pitch", "stage_2_center_distance", "temperature", "wear"} <= set(names)
    one, other = drawn_evenly(128, 1, 2)
    plain = one.chances([4, 6])
    assert [chances.teeth.shape[1] for chances in plain] == [4, 6]
    shared = [rows_of(name) for name in ("temperature", "wear")]
    assert all(np.array_equal(plain[0].pair[rows], plain[1].pair[rows]) for rows in shared)
    for source, changed in (
        (DeviationSource("tilt_driven", 2), [False, True]),
        (DeviationSource("temperature"), [True, True]),
    ):
        swapped = replace(one, source=source, other=other).chances([4, 6])
        assert [not np.array_equal(a.pair, b.pair) for a, b in zip(plain, swapped, strict=True)] == changed


STAGED = """\
name: staged
linkage: {{crank_mm: 38, rod_mm: 96}}
operation: {{speed_rpm: 60}}
motion: {{law: harmonic_ratio, cosine: {first}, sine: [0.1]{second}}}
gears: {{teeth: 24, module_mm: 1.5, face_width_mm: 10, backlash_mm: 0.08}}
resistance: {{polynomial_n: [400]}}
"""
RATIO = "[-0.3, 0.05]"


@pytest.mark.slow
@pytest.mark.judges("tolerances")
def test_the_crank_of_two_pairs_stands_where_their_outlines_turn_it() -> None:
    """Polygons of both pairs, the second turned by what the first was pushed to, laid over each other by shapely."""
    one = drive_of_text(STAGED.format(first="[-0.2]", second=", second_stage: {cosine: [-0.25], sine: [-0.1]}"))
    lot = lot_of(one, ASSUMED)
    moved = {"center_distance": 0.02, "driving_x": 0.015, "driven_y": -0.02, "driving_index": 1.5e-3}
    of = tuple(deviations(pair.limits.flanks, 1, **moved) for pair in lot.pairs)
    of[0].output_rad[:] = BETWEEN_RAD
    polygons, places = [], []
    for pair in one.by_stage:
        teeth = toothed_pair(pair.pitch, pair.tooth_form, 2e-3, flank_tolerance_mm=FINE_MM)
        places.append(placed(pair.pitch, PER_TOOTH))
        driving, driven = (Polygon(teeth.of(gear).outline_mm) for gear in Gear)
        first = affinity.rotate(affinity.translate(driving, 0.015, 0.0), moved["driving_index"], (0, 0), True)
        polygons.append((first, affinity.translate(driven, 0.0, -0.02)))
    leads = [pair.mesh.leads(own)[:, :, 0] for pair, own in zip(lot.pairs, of, strict=True)]
    laws = [pair.pair.transmission for pair in one.by_stage]

    def pushed(stage: int, angle: float) -> float:
        law = laws[stage].driven_angle(np.array([angle]), 1)
        at = places[stage]
        near = int(np.argmin(np.abs(at.phi1_rad - angle % (2.0 * pi))))
        apart = replace(
            at, center_distance_mm=at.center_distance_mm + 0.02, phi1_rad=np.array([angle]), phi2_rad=law.value
        )
        return float(law.value[0] + turned_until_touching(*polygons[stage], apart, 0, leads[stage][:, near])[PUSHING])

    errors = [
        pair.carried(lead[PUSHING, :, None] + off)[:, 0]
        for pair, lead, off in zip(lot.pairs, leads, (BETWEEN_RAD, 0.0), strict=True)
    ]
    shafts = [pair.pair.shaft_rad(at.phi1_rad) for pair, at in zip(one.by_stage, places, strict=True)]
    position = np.unique(np.concatenate(shafts))
    looked = np.arange(5, position.size, position.size // 12)
    crank = np.array([pushed(1, pushed(0, angle) + BETWEEN_RAD) for angle in position[looked]])
    exact = crank - one.transmission.driven_angle(position[looked]).value
    found = (errors[0] + errors[1])[looked]
    assert np.abs(found - exact).max() < 0.02 * np.abs(exact).max()
    # Negative control: the first pair's error as it is, without the second one's law.
    plain = (errors[0] / lot.pairs[0].slope + errors[1])[looked]
    assert np.abs(plain - exact).max() > 0.1 * np.abs(exact).max()


def test_beside_an_exact_pair_that_turns_evenly_the_other_is_a_single_one() -> None:
    single, staged = (drive_of_text(STAGED.format(first=RATIO, second=second)) for second in ("", ", second_stage: {}"))
    alone, both = lot_of(single, ASSUMED), lot_of(staged, ASSUMED)
    (of,) = alone.drawn(drawn_evenly(64, 1)[0])
    # The keyway of the driven gear is that of the shaft between.
    exact = deviations(both.flanks[1], 64)
    mine, other = both.assembled((of, exact)), alone.assembled((of,))
    for name in ("least_play_rad", "largest_play_mm", "transmission_error_rad", "least_arc"):
        assert getattr(mine.pairs[0], name) == pytest.approx(getattr(other.pairs[0], name), rel=1e-6, abs=1e-9)
    for name in ("transmission_error_rad", "motion_error", "peak_acceleration"):
        assert getattr(mine, name) == pytest.approx(getattr(other, name), rel=2e-3)


# --- between the positions ---


@pytest.mark.slow
def test_what_positions_miss_covers_others_that_are_not_among_them() -> None:
    """Of 112 positions a pitch 16 are among the 80; the table has 10."""
    one = drive("ellipse")
    lot = lot_of(one, ASSUMED)
    (of,), (pair,) = lot.drawn(drawn_evenly(64, 1)[0]), lot.pairs
    fine, other = (
        mesh_of(face_of(one), placed(one.pitch, per_tooth), 0.1 * one.pitch.size.module_mm) for per_tooth in (80, 112)
    )
    found = between_positions(pair, fine, of)
    play_mm = -other.leads(of).sum(axis=0) * other.arm_mm[BACK][:, None]
    told = pair.mesh.leads(of).sum(axis=0) * -pair.mesh.arm_mm[BACK][:, None]
    less, more = (told.min(axis=0) - play_mm.min(axis=0)).max(), (play_mm.max(axis=0) - told.max(axis=0)).max()
    assert 0.0 < less <= 1.2 * found.least_play_mm
    assert 0.0 < more <= 1.2 * found.largest_play_mm
    # Negative control: the same positions miss nothing of themselves.
    assert between_positions(pair, pair.mesh, of).least_play_mm == 0.0


# --- gears that turn to and fro ----------------------------------------------------------------------------------

SECTOR = """\
name: sector
operation: {speed_rpm: 10}
motion: {law: function_generator, function: x, x_from: 0, x_to: 1, driving_range_deg: 240, driven_range_deg: 120}
gears: {module_mm: 2, center_distance_mm: 90, face_width_mm: 20, backlash_mm: 0.4}
"""
"""Circular gears as those above, of which only some teeth are made."""


@cache
def sector() -> tuple[Drive, Lot]:
    one = drive_of_text(SECTOR)
    return one, lot_of(one, ASSUMED)


@pytest.mark.judges("tolerances")
def test_sectors_of_eccentric_gears_touch_as_in_closed_form_up_to_their_ends() -> None:
    one, lot = sector()
    (pair,), placement = lot.pairs, placed(one.pitch, PER_TOOTH)
    flanks = pair.limits.flanks
    moved = {"center_distance": 0.02, "driving_x": 0.02, "driven_y": 0.02, "driving_index": 1e-3}
    found, nominal = (pair.mesh.leads(deviations(flanks, 1, **own))[:, :, 0] for own in (moved, {}))
    exact, bare = (closed_form(deviations(flanks, 1, **own), placement) for own in (moved, {}))
    size = np.abs(exact - bare).max()
    # The driven gear is a little thinner where the play is told of the least arm.
    assert found - nominal == pytest.approx(exact - bare, abs=0.05 * size)
    # Negative control: a range that is taken the other way round.
    assert np.abs((found - nominal)[:, ::-1] - (exact - bare)).max() > 0.3 * size


def test_the_slow_part_over_a_range_is_that_of_a_slow_error_up_to_its_ends() -> None:
    """Of the closed form of an eccentric gear; waves that go round see a jump from the end to the beginning."""
    angle = np.linspace(0.0, 4.0 * pi / 3.0, 400)
    exact = np.stack([np.sin(angle + 1.0), np.cos(angle + 1.0), -np.sin(angle + 1.0)])
    tooth = 0.01 * np.sin(30.0 * angle)
    found = Smoothed(float(angle[-1]), 5.0).of((exact[0] + tooth)[:, None])[:, :, 0]
    # Less than half of a tooth's wave is left at the ends, and a hundredth of its second derivative, which is 9.
    assert found[0] == pytest.approx(exact[0], abs=0.005)
    assert found[2] == pytest.approx(exact[2], abs=0.1)
    assert found[2, 40:-40] == pytest.approx(exact[2, 40:-40], abs=0.03)
    round_ = Waves(float(angle[-1]), 5).of(exact[0][:, None])[:, :, 0]
    assert np.abs(round_[2] - exact[2]).max() > 5.0


def test_half_of_the_waves_at_the_limit_are_left() -> None:
    angle = np.linspace(0.0, 10.0, 2000)
    for waves in (10.0, 20.0, 40.0):
        wave = np.cos(2.0 * pi * waves * angle / 10.0)
        found = Smoothed(10.0, 20.0).of(wave[:, None])[0, :, 0]
        middle = slice(500, 1500)
        assert found[middle] == pytest.approx(wave[middle] / (1.0 + (waves / 20.0) ** 6), abs=2e-3)


@pytest.mark.slow
def test_gears_that_turn_to_and_fro_are_told_as_their_outlines_are() -> None:
    found = tolerated(drive("spiral-pair"), 64, 1, Workers(), lambda done, total: None)
    (pair,) = found.pairs
    assert all(one.error_mm < 0.06 * one.displaced_mm for one in pair.errors)
    assert found.assemblies.least_play_mm.max() < 0.06
    # The resistance is one way all along; the gears turn back at both ends.
    assert pair.lot.reversals.tolist() == [0, pair.lot.mesh.phi1_rad.size - 1]
    assert np.all(pair.assemblies.reversal_play_mm <= pair.assemblies.largest_play_mm)


# --- helical teeth -----------------------------------------------------------------------------------------------


@cache
def leaning(overlap: float, sections: int) -> tuple[LinearMesh, float]:
    """The mesh of the circular pair with helical teeth that advance by so many pitches, and its overlap."""
    pitch, _, placement, _ = circular()
    form = ToothForm(rack(), backlash=Backlash(PLAY_MM))
    shares = np.linspace(0.0, 1.0, sections)
    made = tuple(toothed_pair(pitch, form, 0.005, advance_mm=share * overlap * pi * MODULE) for share in shares)
    heights = tuple(WIDTH_MM * (shares - 0.5))
    return mesh_of(Face(made, heights, mirrored=False, overlap=overlap), placement, 0.3), overlap


@pytest.mark.judges("tolerances")
def test_helical_teeth_without_any_lean_are_straight_ones() -> None:
    _, _, _, straight = circular()
    mesh, _ = leaning(1e-9, 2)
    limits = all_limits(2 * (TEETH + DRIVEN_TEETH))
    of = drawn(limits, random_chances(8, limits.flanks))
    assert of.tilt.any()
    assert mesh.leads(of) == pytest.approx(straight.leads(of), abs=1e-9)


@pytest.mark.slow
@pytest.mark.judges("tolerances")
def test_a_helical_tooth_that_stands_out_carries_longer_by_the_overlap() -> None:
    """And displaced gears touch as straight ones do, by the common tangents of their base circles."""
    mesh, overlap = leaning(0.75, 7)
    _, _, placement, straight = circular()
    of = of_circular(center_distance=0.02, driving_x=0.02, driven_y=0.02, driving_index=0.001)
    nominal = mesh.leads(of_circular())
    exact = closed_form(of, placement)
    size = np.abs(exact - closed_form(of_circular(), placement)).max()
    assert mesh.leads(of)[:, :, 0] == pytest.approx(exact, abs=0.05 * size)
    alone = of_circular()
    alone.pitch[4] = 0.02
    lasts = []
    for one in (straight, mesh):
        gained = (one.leads(alone) - one.leads(of_circular()))[PUSHING, :, 0]
        assert gained.max() == pytest.approx(0.02 * cos(ALPHA) / BASES_MM[1], rel=1e-9)
        lasts.append(np.count_nonzero(gained > 0.5 * gained.max()) / 8.0)
    # Each of two meetings in the cycle, by the overlap longer.
    assert lasts[1] - lasts[0] == pytest.approx(2.0 * overlap, abs=0.26)
    assert nominal[PUSHING] == pytest.approx(0.0, abs=1e-11)
    assert mesh.arcs.min() == pytest.approx(straight.arcs.min() + overlap, rel=1e-6)


@pytest.mark.tiers(slow=["herringbone"], rest="long")
@pytest.mark.judges("tolerances")
@pytest.mark.parametrize("kind", ["helical", "herringbone"])
def test_helical_gears_touch_where_the_outlines_of_a_stepped_gear_do(kind: str) -> None:
    """With twice as many steps as the mesh has sections, tilted bores and deviations of every tooth."""
    data = loaded("helical-ellipse").design.model_dump(exclude_unset=True, by_alias=True)
    data["gears"]["helix"]["kind"] = kind
    one = Drive(design_of(data))
    given = ASSUMED.model_copy(update={"driving": GearTolerances(eccentricity_mm=0.02, tilt_deg=0.15)})
    lot = lot_of(one, given)
    (of,) = lot.drawn(drawn_at_random(1, 5)[0])
    mesh = lot.pairs[0].mesh
    finer = stepped(one, 2 * len(face_of(one).sections) - 1)
    exact = exact_of(one.pitch, finer, placed(one.pitch, PER_TOOTH), mesh, 20)
    (found,) = linear_errors(exact, [of])
    assert found.displaced_mm > 0.02
    assert found.error_mm < 0.02 * found.displaced_mm
    # Negative controls: the first section alone, as if its teeth were straight, and a bore tilted the other way.
    plain = mesh_of(straight_face(one.teeth, one.gears.face_width_mm), placed(one.pitch, PER_TOOTH), 0.2)
    (other,) = linear_errors(replace(exact, mesh=plain), [of])
    assert other.error_mm > 0.04 * found.displaced_mm
    (tilted,) = linear_errors(replace(exact, mesh=replace(mesh, tilt=-mesh.tilt)), [of])
    assert (tilted.error_mm > 0.1 * found.displaced_mm) == (kind == "helical")


def stepped(one: Drive, count: int) -> Face:
    """So many even sections of a helical pair."""
    assert one.helix is not None
    width, rise, herringbone = one.gears.face_width_mm, one.helix.rise_mm, one.helix.herringbone
    heights = np.linspace(0.0, rise, count)
    fine = 1e-4 * one.pitch.size.module_mm
    made = tuple(
        toothed_pair(
            one.pitch, one.tooth_form, 10.0 * fine, flank_tolerance_mm=fine, advance_mm=one.helix.advance_mm(height)
        )
        for height in heights
    )
    middle = width / 2.0
    return Face(made, tuple(middle - heights if herringbone else heights - middle), mirrored=herringbone)


# --- polygons of non-circular gears ------------------------------------------------------------------------------

FINE_MM = 2e-4


@cache
def fine_pair(name: str) -> tuple[PitchPair, ToothedPair]:
    one = drive(name)
    return one.pitch, toothed_pair(one.pitch, one.tooth_form, 2e-3, flank_tolerance_mm=FINE_MM)


def turned_until_touching(driving: Polygon, driven: Polygon, at: Placement, position: int, lead: Array) -> Array:
    """Leads by bisection: how far the driven polygon turns either way before it overlaps the driving one, shape (2,).

    It begins in the middle of the play that ``lead`` (shape (2,)) expects.
    """
    first = affinity.rotate(driving, float(at.phi1_rad[position]), (0, 0), use_radians=True)
    sense, middle = at.mesh.sense, (lead[PUSHING] - lead[BACK]) / 2.0

    def overlaps(ahead: float) -> bool:
        angle = sense * (float(at.phi2_rad[position]) + ahead)
        second = affinity.rotate(driven, angle, (0, 0), use_radians=True)
        return bool(first.intersects(affinity.translate(second, at.center_distance_mm)))

    assert not overlaps(middle)
    found = []
    for urge in (1.0, -1.0):
        free, held = 0.0, 0.02
        while held - free > 1e-7:
            way = (free + held) / 2.0
            free, held = (free, way) if overlaps(middle - urge * way) else (way, held)
        found.append(urge * (middle - urge * free))
    return np.array(found)


@pytest.mark.judges("tolerances")
def test_non_circular_gears_touch_where_their_polygons_do() -> None:
    """Eccentric bores, another centre distance, growth and wear of both flanks, laid over each other by shapely."""
    pitch, teeth = fine_pair("ellipse")
    placement = placed(pitch, 4)
    mesh = mesh_of(straight_face(teeth, 12.0), placement, 0.15, both_ways=True)
    moved = {
        "center_distance": 0.05, "driving_x": 0.012, "driving_y": -0.02, "driven_x": 0.01, "driven_y": 0.015,
        "driving_growth": -4e-4, "driven_growth": 3e-4, "housing_growth": 2e-4, "driving_wear": 0.02,
        "driven_wear": 0.01,
    }  # fmt: skip
    of = deviations(teeth.driving.flanks.count + teeth.driven.flanks.count, 1, **moved)
    leads = mesh.leads(of)[:, :, 0]
    polygons = [Polygon(gear.outline_mm) for gear in (teeth.driving, teeth.driven)]
    made = []
    for gear, polygon in zip(("driving", "driven"), polygons, strict=True):
        worn = polygon.buffer(-moved[f"{gear}_wear"], quad_segs=2)
        grown = affinity.scale(worn, *(2 * (1.0 + moved[f"{gear}_growth"],)), origin=(0, 0))
        made.append(affinity.translate(grown, moved[f"{gear}_x"], moved[f"{gear}_y"]))
    distance = placement.center_distance_mm * (1.0 + moved["housing_growth"]) + moved["center_distance"]
    apart = replace(placement, center_distance_mm=distance)
    for position in range(0, placement.count, placement.count // 6):
        found = turned_until_touching(made[0], made[1], apart, position, leads[:, position])
        off_mm = np.abs(found - leads[:, position]) * mesh.arm_mm[:, position]
        # Chords and the second order, of some 0.07 mm by which the flanks are displaced.
        assert off_mm.max() < 2e-3
        bare = mesh.leads(deviations(of.pitch.shape[0], 1))[:, position, 0]
        assert (np.abs(found - bare) * mesh.arm_mm[:, position]).max() > 0.015


@pytest.mark.slow
@pytest.mark.judges("tolerances")
def test_teeth_with_errors_touch_where_their_outlines_do() -> None:
    """Pitch, profile and tilt of every tooth, by the outlines that the command itself checks with."""
    one = drive("ellipse")
    pitch, teeth = fine_pair("ellipse")
    placement = placed(pitch, 4)
    mesh = mesh_of(straight_face(teeth, 12.0), placement, 0.15)
    limits = replace(limits_of(one, ASSUMED), center_distance_mm=0.0, index_rad=(0.0, 0.0))
    (chances,) = drawn_at_random(2, 5)[0].chances([limits.flanks])
    found = linear_errors(
        exact_of(pitch, straight_face(teeth, 12.0), placement, mesh, 40), [drawn(limits, chances).one(0)]
    )[0]
    assert found.displaced_mm > 0.02
    assert found.error_mm < 3e-3


def test_flanks_that_deviate_the_wrong_way_fail() -> None:
    """Negative control of the check: the mesh of one assembly beside the outlines of the opposite one."""
    one = drive("ellipse")
    pitch, teeth = one.pitch, one.teeth
    placement = placed(pitch, 2)
    mesh = mesh_of(straight_face(teeth, 12.0), placement, 0.15)
    limits = limits_of(one, AssemblyTolerances(grade=8))
    of = drawn(limits, *drawn_at_random(2, 5)[0].chances([limits.flanks])).one(0)
    opposite = replace(of, pitch=-of.pitch, profile=-of.profile)
    exact = exact_of(pitch, straight_face(teeth, 12.0), placement, mesh, 12)
    bare = replace(of, pitch=0.0 * of.pitch, profile=0.0 * of.profile)
    linear = (mesh.leads(of) - mesh.leads(bare))[:, exact.rows, 0]
    for sign, other in ((1.0, of), (-1.0, opposite)):
        off_mm = np.abs(exact.leads(other) - exact.leads(bare) - linear).max() * float(mesh.arm_mm.min())
        assert (off_mm < 0.008) == (sign > 0.0)


@pytest.mark.judges("tolerances")
def test_points_on_involutes_have_heights_and_normals_in_closed_form() -> None:
    """The rack's height is sin(a) (sqrt(r^2 - b^2) - b tan(a)) at a radius r; normals touch the base circle."""
    gear, base = circular()[1].driving, BASES_MM[0]
    found = on_sides(gear, ring=False)
    point, body = found.outline[found.vertex], Polygon(gear.outline_mm)
    flank = found.share > -0.5
    assert {*found.flank[flank].tolist()} == set(range(2 * TEETH))
    top, bottom = (ends[found.flank] for ends in gear.sides.flank_range())
    height = sin(ALPHA) * (np.sqrt(np.maximum(np.abs(point) ** 2 - base**2, 0.0)) - base * tan(ALPHA))
    # The flanks' own setback for the backlash turns them, which changes no radius.
    assert found.share[flank] == pytest.approx(((height - bottom) / (top - bottom) - 0.5)[flank], abs=2e-3)
    arms = np.abs((np.conj(point) * found.normal).imag)
    assert arms[flank] == pytest.approx(base, rel=1e-3)
    assert np.abs(found.normal) == pytest.approx(1.0)
    outside = shapely.points(*(point + 0.02 * found.normal).view(float).reshape(-1, 2).T)
    assert not shapely.contains(body, outside).any()
    inside = shapely.points(*(point - 0.02 * found.normal).view(float).reshape(-1, 2).T)
    assert shapely.contains(body, inside).all()
    # A turned involute moves along its normals by the base radius times the turn: into more material on every flank.
    turned, added, slope = (np.zeros(2 * TEETH) for _ in range(3))
    turned[4:6], added[8], slope[12] = 1e-4, 0.03, 0.04
    moved = (np.conj(found.normal) * (found.deviating(turned, added, slope)[found.vertex] - point)).real
    for own, wanted in (
        (np.isin(found.flank, [4, 5]), base * 1e-4),
        (found.flank == 8, 0.03),
        (found.flank == 12, 0.04 * found.share),
        (~np.isin(found.flank, [4, 5, 8, 12]), 0.0),
    ):
        chosen = own & flank
        assert moved[chosen] == pytest.approx(np.broadcast_to(wanted, moved.shape)[chosen], rel=2e-3, abs=1e-9)


@pytest.mark.judges("tolerances")
def test_outlines_of_displaced_circular_gears_touch_as_in_closed_form() -> None:
    """Not to first order but as they are, to their chords of 5 um."""
    pitch, teeth, placement, mesh = circular()
    exact = exact_of(pitch, straight_face(teeth, WIDTH_MM), placement, mesh, 4)
    moved = {**CASES["everything"], "driven_x": -0.03, "housing_growth": 2e-4}
    moved |= {"driving_growth": 3e-4, "driven_growth": 3e-4}
    of = of_circular(**moved)
    at = replace(placement, phi1_rad=placement.phi1_rad[exact.rows], phi2_rad=placement.phi2_rad[exact.rows])
    found = exact.leads(of) - exact.leads(of_circular())
    wanted = closed_form(of, at) - closed_form(of_circular(), at)
    assert np.abs(found - wanted).max() * BASES_MM[1] < 0.006
    assert np.abs(wanted).max() * BASES_MM[1] > 0.05
    worn = exact.leads(of_circular(driving_wear=0.03, driven_wear=0.02)) - exact.leads(of_circular())
    assert worn[PUSHING] * BASES_MM[1] == pytest.approx(-0.05, abs=0.003)
    assert worn[BACK] * BASES_MM[1] == pytest.approx(0.0, abs=0.003)


# --- what is drawn -----------------------------------------------------------------------------------------------


def all_limits(flanks: int = 4) -> DeviationLimits:
    teeth = np.linspace(0.01, 0.02, flanks)
    return DeviationLimits(
        0.05, (0.03, 0.02), (1e-3, 2e-3), (2e-3, 3e-3), teeth, 2.0 * teeth, (-10.0, 50.0), 5.0,
        (1e-4, 8e-5, 1e-5), (0.04, 0.06),
    )  # fmt: skip


def random_chances(count: int, flanks: int = 4) -> Chances:
    random = np.random.default_rng(3)
    return Chances(random.random((COUNT, count)), random.random((2, flanks, count)))


def test_deviations_keep_their_limits_and_have_the_variance_of_the_closed_form() -> None:
    limits = all_limits()
    found, known = drawn(limits, random_chances(40_000)), spread(limits)
    sizes = np.abs(found.rigid)
    assert sizes[0].max() <= 0.05
    assert np.hypot(*found.rigid[1:3]).max() <= 0.03
    assert np.hypot(*found.tilt[2:]).max() <= 2e-3
    assert np.all(sizes[9:].max(axis=1) <= limits.wear_mm)
    assert found.rigid[7].min() == pytest.approx(-30.0 * 1e-5, rel=1e-3)
    assert found.rigid[5].max() == pytest.approx(35.0 * 1e-4, rel=1e-3)
    covariance = known.rigid @ known.rigid.T
    size = np.sqrt(np.diag(covariance))
    scale = np.outer(size, size)
    assert np.cov(found.rigid) / scale == pytest.approx(covariance / scale, abs=0.03)
    assert found.pitch.std(axis=1) == pytest.approx(known.pitch_mm, rel=0.02)
    assert found.profile.std(axis=1) == pytest.approx(known.profile_mm, rel=0.02)
    # Two neighbours are a pitch apart that is off by the tolerance, at three standard deviations.
    assert np.std(found.pitch[1] - found.pitch[0]) == pytest.approx(
        float(np.hypot(*limits.pitch_mm[:2])) / sqrt(2) / 3, rel=0.03
    )


def test_only_what_has_a_limit_is_active() -> None:
    none = np.zeros(4)
    limits = DeviationLimits(
        0.1, (0.0, 0.1), (0.0, 0.0), (0.0, 0.0), none, none, (20.0, 20.0), 0.0, (1.0, 1.0, 1.0), (0.0, 0.0)
    )
    assert active(limits) == ("center_distance", "eccentricity_driven")
    assert len(active(all_limits())) == len(SOURCES) + 2


def test_what_is_left_out_of_a_mesh_comes_first_at_no_limit() -> None:
    """Every source at one of its limits, by lot: the contacts that are kept lead by as much as all of them."""
    mesh, flanks, count = circular()[3], 2 * (TEETH + DRIVEN_TEETH), 200
    pitch, profile = np.full(flanks, 0.08), np.full(flanks, 0.03)
    limits = DeviationLimits(0.1, (0, 0), (0, 0), (0, 0), pitch, profile, (20.0, 20.0), 0.0, (0.0, 0.0, 0.0), (0, 0))
    found = reachable(mesh, limits)
    assert found.lead.size < mesh.lead.size
    either = np.random.default_rng(3).choice([-1.0, 1.0], (2 * flanks + 1, count))
    of = replace(
        deviations(flanks, count, center_distance=0.1 * either[-1]),
        pitch=pitch[:, None] / sqrt(2.0) * either[:flanks],
        profile=profile[:, None] * either[flanks:-1],
    )
    np.testing.assert_array_equal(found.leads(of), mesh.leads(of))


def test_a_value_that_nearly_all_surpass_is_told_from_enough_samples_only() -> None:
    """The least of n surpasses the quantile with the chance 0.999^n, which is under 5 % from 2995 on (Wilks)."""
    assert enough_samples(0.999) == 2995
    values = np.random.default_rng(1).permutation(np.arange(4096.0))
    assert surpassed(values[:2994], 0.999) is None
    assert surpassed(values, 0.999) == 0.0
    assert surpassed(np.arange(1e5), 0.999) == pytest.approx(100.0 - 1.645 * 10.0, abs=2.0)


def test_the_spread_of_play_to_first_order_is_that_of_the_centre_distance() -> None:
    """Along the normal the play of circular gears grows by 2 sin(a) times the distance."""
    _, _, placement, mesh = circular()
    none = np.zeros(2 * (TEETH + DRIVEN_TEETH))
    limits = DeviationLimits(0.03, (0, 0), (0, 0), (0, 0), none, none, (20.0, 20.0), 0.0, (0.0, 0.0, 0.0), (0, 0))
    positions = np.arange(placement.count)
    way = BetweenAngles(positions, positions, np.zeros(positions.size))
    lot = Lot((PairLot(mesh, limits, positions[:0], way, np.ones(positions.size)),), Made())
    tasks = drawn_evenly(128, 1)
    found = first_order(lot, 0, tasks)
    size = float(np.std(np.concatenate([lot.drawn(task)[0].rigid[0] for task in tasks])))
    assert found.by_source["center_distance"] == pytest.approx(2.0 * sin(ALPHA) * size, rel=0.02)
    assert found.linear_mm == pytest.approx(found.by_source["center_distance"])
    assert found.drawn_mm == pytest.approx(found.linear_mm, rel=0.02)
    assert found.difference == pytest.approx(np.abs(found.linear_mm - found.drawn_mm).max() / found.drawn_mm.max())
    pitched = replace(limits, pitch_mm=none + 0.02, profile_mm=none + 0.01)
    other = first_order(replace(lot, pairs=(replace(lot.pairs[0], limits=pitched),)), 0, tasks[:1])
    known = spread(pitched).pitch_mm[0]
    # One flank of each gear on each side: four deviations along the pitch circles, cos(a) of each along the normal.
    assert other.by_source["pitch"] == pytest.approx(2.0 * cos(ALPHA) * known, rel=1e-3)
    assert other.linear_mm == pytest.approx(np.sqrt(sum(one**2 for one in other.by_source.values())))
    # The same positions miss nothing.
    same = between_positions(lot.pairs[0], mesh, lot.drawn(tasks[0])[0])
    assert (same.assemblies, same.least_play_mm, same.largest_play_mm, same.transmission_error_mm) == (64, 0, 0, 0)


def test_tasks_of_indices_exchange_one_source_each() -> None:
    """Saltelli's: A, B, and A with the numbers of one source from B, in their order."""
    sources = DeviationSource("pitch"), DeviationSource("wear"), DeviationSource("tilt_driven")
    tasks = sobol_tasks(Made(pairs=(1, 2), sources=sources), 128, 5)
    assert [task.number for task in tasks] == list(range(2 * 5))
    own, others, swapped = tasks[:2], tasks[2:4], tasks[4:]
    assert all(task.pairs.shape == (2 * COUNT, 64) for task in tasks)
    assert not np.array_equal(own[0].pairs, others[0].pairs)
    for place, task in enumerate(swapped):
        assert task.source == sources[place // 2]
        assert np.array_equal(task.pairs, own[place % 2].pairs)
        assert task.other is not None
        assert np.array_equal(task.other.pairs, others[place % 2].pairs)
    # Both halves are points of one sequence, evenly spread in all numbers.
    every = np.concatenate([np.concatenate([task.pairs for task in half], axis=1) for half in (own, others)])
    assert every.mean(axis=1) == pytest.approx(0.5, abs=0.01)


# --- assemblies of a design --------------------------------------------------------------------------------------


@cache
def ellipse_lot() -> Lot:
    """Assemblies of the ellipse with the tolerances that are assumed."""
    return lot_of(drive("ellipse"), ASSUMED)


@pytest.mark.slow
def test_assemblies_are_the_same_however_they_are_drawn() -> None:
    """Scrambled points of Sobol and plain random numbers: means agree within what chance explains."""
    one, lot = drive("ellipse"), ellipse_lot()
    evenly = assemblies_of(lot, drawn_evenly(256, 1), Workers())
    plain = assemblies_of(lot, drawn_at_random(256, 1), Workers())
    for name in ("least_play_mm", "transmission_error_rad", "motion_error", "peak_acceleration"):
        first, second = getattr(evenly, name), getattr(plain, name)
        doubt = sqrt(first.var() / first.size + second.var() / second.size)
        assert abs(first.mean() - second.mean()) < 3.0 * doubt
    assert one.play.least_normal_mm.value > evenly.least_play_mm.mean()


@pytest.mark.slow
def test_indices_are_those_of_another_program() -> None:
    """SALib 1.5 on the same assemblies; and the total of a source that does nothing is 0."""
    other = pytest.importorskip("SALib.analyze.sobol")

    lot = ellipse_lot()
    names, count = active(lot.pairs[0].limits), 64
    tasks = sobol_tasks(lot, count, 1)
    found = assemblies_of(lot, tasks, Workers())
    own = {one.source.key: one for one in sobol_indices_of(lot, found)["least_play_mm"]}
    # A, B and one set for each source; SALib has A, the sets, and B of each point after each other.
    values = found.least_play_mm.reshape(len(names) + 2, count)
    ordered = np.concatenate([values[:1], values[2:], values[1:2]]).T.ravel()
    problem = {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}
    theirs = other.analyze(problem, ordered, calc_second_order=False, num_resamples=10, seed=1)
    assert [own[name].total for name in names] == pytest.approx(theirs["ST"], abs=0.01)
    assert [own[name].first for name in names] == pytest.approx(theirs["S1"], abs=0.03)
    assert own["index_driven"].total == pytest.approx(0.0, abs=1e-12)


@pytest.mark.slow
def test_indices_of_two_causes_are_their_shares_of_the_variance() -> None:
    """Of circular gears, the play is 2 a inv-like in the centre distance and even in the growth: both shares known."""
    _, _, _, mesh = circular()
    flanks = 2 * (TEETH + DRIVEN_TEETH)
    none = np.zeros(flanks)
    limits = DeviationLimits(0.03, (0, 0), (0, 0), (0, 0), none, none, (0.0, 40.0), 0.0, (1.1e-4, 1.1e-4, 1e-5), (0, 0))
    machine = replace(drive("ellipse").machine, transmission=uniform_law(Lobes(1, 2)))
    law = on_driving_shaft(machine.transmission)
    lot = lot_of_pairs(machine, [(mesh, limits, np.arange(1), law)], TEETH, 1.0)
    found = sobol_indices_of(lot, assemblies_of(lot, sobol_tasks(lot, 256, 1), Workers()))["least_play_mm"]
    deviation = 0.03 * 0.98658 / 3.0, DISTANCE_MM * 1e-4 * 40.0 / sqrt(12.0)
    wanted = deviation[1] ** 2 / (deviation[0] ** 2 + deviation[1] ** 2)
    own = {one.source.key: one.total for one in found}
    assert own["temperature"] == pytest.approx(wanted, rel=0.05)
    assert own["center_distance"] == pytest.approx(1.0 - wanted, abs=0.05)


@pytest.mark.long
@pytest.mark.slow
def test_the_backlash_that_is_needed_lets_fresh_assemblies_turn() -> None:
    """And half of what the gears lack of it does not."""

    def with_backlash(size_mm: float) -> Drive:
        design = loaded("ellipse").design
        assert design.gears is not None
        gears = design.gears.model_copy(update={"backlash_mm": size_mm})
        return Drive(design.model_copy(update={"gears": gears}))

    found = tolerated(with_backlash(0.02), 4096, 2, Workers(), lambda done, total: None)
    assert found.needed is not None
    assert found.needed.jammed is not None
    assert found.needed.jammed.value <= 1e-3
    assert found.jam.value > 0.05
    assert 0.03 < found.needed.value < 0.08
    half = (found.needed.value + 0.02) / 2.0
    fresh = assemblies_of(lot_of(with_backlash(half), ASSUMED), drawn_at_random(4096, 9), Workers())
    assert jammed(fresh.pairs).least > 1e-3
    (pair,) = found.pairs
    assert pair.first_order.difference < 0.25
    assert all(one.error_mm < 0.05 * one.displaced_mm for one in pair.errors)


@pytest.mark.slow
def test_results_are_the_same_whatever_the_workers() -> None:
    lot = ellipse_lot()
    tasks = drawn_evenly(128, 1)
    alone, two = (assemblies_of(lot, tasks, Workers(None, count)) for count in (1, 2))
    for one, other in ((alone, two), (alone.pairs[0], two.pairs[0])):
        arrays = {name: values for name, values in vars(one).items() if name != "pairs"}
        assert all(np.array_equal(values, getattr(other, name)) for name, values in arrays.items())


@pytest.mark.slow
def test_places_that_no_assembly_reaches_may_be_left_out() -> None:
    """Even where everything is at its limit; and most of the others are reached by some."""
    one, lot = drive("ellipse"), ellipse_lot()
    whole = mesh_of(face_of(one), placed(one.pitch, PER_TOOTH), 0.25)
    random = np.random.default_rng(4)
    chances = Chances(
        random.choice([1e-9, 1.0 - 1e-9], (COUNT, 64)), random.choice([1e-9, 1.0 - 1e-9], (2, *lot.flanks, 64))
    )
    (pair,) = lot.pairs
    of = drawn(pair.limits, chances)
    assert np.array_equal(whole.leads(of), pair.mesh.leads(of))
    assert pair.mesh.lead.size < 0.8 * whole.lead.size


@pytest.mark.slow
def test_twice_as_many_positions_change_little() -> None:
    one = drive("ellipse")
    coarse = ellipse_lot()
    (of,) = coarse.drawn(drawn_evenly(64, 1)[0])
    fine = mesh_of(face_of(one), placed(one.pitch, 4 * PER_TOOTH), 0.2)
    for side, sign in ((PUSHING, 1.0), (BACK, -1.0)):
        errors = [sign * mesh.leads(of)[side] for mesh in (coarse.pairs[0].mesh, fine)]
        spans = [np.ptp(error, axis=0) for error in errors]
        assert np.abs(spans[0] - spans[1]).max() < 0.06 * spans[1].max()


# --- what the file says ------------------------------------------------------------------------------------------


@pytest.mark.thorough
def test_materials_and_housing_grow() -> None:
    one = drive("desk-toy")
    given = AssemblyTolerances(temperature=Temperatures(least_c=0.0, largest_c=40.0, warmer_k=10.0))
    limits = limits_of(one, given)
    assert limits.expansions == pytest.approx((68e-6, 68e-6, 11.5e-6))
    found = drawn(limits, random_chances(100, limits.flanks))
    assert found.rigid[5] - 68e-6 * 10.0 == pytest.approx(68e-6 / 11.5e-6 * found.rigid[7], rel=1e-9)


def test_own_values_replace_a_grade() -> None:
    one = drive("ellipse")
    limits = limits_of(one, AssemblyTolerances(grade=8, driven=GearTolerances(single_pitch_mm=0.1, profile_mm=0.2)))
    count = one.teeth.driving.flanks.count
    assert limits.pitch_mm[:count].max() < 0.02
    assert set(limits.pitch_mm[count:]) == {0.1}
    assert set(limits.profile_mm[count:]) == {0.2}


def test_small_modules_have_no_grade() -> None:
    data = loaded("ellipse").design.model_dump(exclude_unset=True, by_alias=True)
    data["gears"]["module_mm"] = 0.4
    data["gears"]["backlash_mm"] = 0.02
    for name in ("driving", "driven"):
        data["gears"][name]["bore_mm"] = 2.0
    with pytest.raises(WrongInput, match="single_pitch_mm"):
        limits_of(Drive(design_of(data)), ASSUMED)


@pytest.mark.slow
def test_the_command_writes_its_files(run: Run, tmp_path: Path) -> None:
    status, said, _ = run("tolerance", str(DESIGNS / "ellipse.yaml"), "--samples", "64", "--out", "made")
    assert status == 0
    assert "not told of so few; --samples 4096" in said
    figures = json.loads((tmp_path / "made" / "tolerance.json").read_text(encoding="utf-8"))
    table = np.genfromtxt(tmp_path / "made" / "assemblies.csv", delimiter=",", names=True)
    assert figures["assemblies"] == table.size == 64
    assert figures["figures"]["least_play_mm"]["median"] == pytest.approx(float(np.median(table["least_play_mm"])))
    assert figures["jam"]["value"] == np.mean(table["least_play_mm"] < 0.0)


@pytest.mark.long
@pytest.mark.slow
def test_the_command_tells_both_pairs_and_the_machine(run: Run, tmp_path: Path) -> None:
    text = STAGED.format(first="[-0.2]", second=", second_stage: {cosine: [-0.25], sine: [-0.1]}")
    (tmp_path / "two.yaml").write_text(text.replace("backlash_mm: 0.08", "backlash_mm: 0.025"), encoding="utf-8")
    status, said, _ = run("tolerance", "two.yaml", "--samples", "64", "--out", "made")
    assert status == 0
    assert "stage 2: least play" in said
    figures = json.loads((tmp_path / "made" / "tolerance.json").read_text(encoding="utf-8"))
    table = np.genfromtxt(tmp_path / "made" / "assemblies.csv", delimiter=",", names=True)
    plays = [table[f"stage_{number}_least_play_mm"] for number in (1, 2)]
    assert np.array_equal(table["least_play_mm"], np.minimum(*plays))
    jam = [play < 0.0 for play in plays]
    assert figures["jam"]["value"] == np.mean(jam[0] | jam[1])
    assert [figures["stages"][f"stage_{number}"]["jam"]["value"] for number in (1, 2)] == [*map(np.mean, jam)]
    assert max(map(np.mean, jam)) < figures["jam"]["value"] <= sum(map(np.mean, jam))
    sources = {one["source"] for one in figures["indices"]["motion_error"]}
    assert {"stage_1_index_driven", "stage_2_index_driving"} <= sources
    assert {path.name for path in (tmp_path / "made").glob("stage-*/*")} == {"spread.png"}


SINGLE = {
    "center_distance": "center_distance_mm: 0.015",
    "eccentricity_driving": "driving: {eccentricity_mm: 0.03}",
    "eccentricity_driven": "driven: {eccentricity_mm: 0.01}",
    "tilt_driving": "driving: {tilt_deg: 0.07}",
    "tilt_driven": "driven: {tilt_deg: 0.2}",
    "index_driving": "driving: {index_deg: 0.3}",
    "index_driven": "driven: {index_deg: 0.05}",
    "temperature": "temperature: {least_c: 5, largest_c: 45}, housing_expansion_um_m_k: 23.5",
    "wear": "driving: {wear_mm: 0.03}",
    "pitch": "driven: {single_pitch_mm: 0.025}",
    "profile": "driving: {profile_mm: 0.01}",
}
"""A section with each source by itself."""

DECIDES = {"index_driven": {"motion_error", "peak_acceleration"}}
"""What a single source makes vary, where it is not everything: the driven keyway only sets off the output."""


@pytest.mark.tiers(slow=["index_driving", "temperature", "pitch"], rest="long")
@pytest.mark.parametrize("source", SINGLE)
def test_all_of_the_variance_is_that_of_a_single_source(source: str, run: Run, tmp_path: Path) -> None:
    """By definition of the total index; and the spread of the play by first order is that source's alone."""
    text = (DESIGNS / "ellipse.yaml").read_text(encoding="utf-8")
    # Left out, the centre distance deviates by the standard's limit.
    exact = "" if source == "center_distance" else "center_distance_mm: 0, "
    (tmp_path / "one.yaml").write_text(f"{text}\ntolerances: {{{exact}{SINGLE[source]}}}\n", encoding="utf-8")
    status, said, err = run("tolerance", "one.yaml", "--samples", "64", "--out", "made")
    assert (status, err) == (0, "")
    told = json.loads((tmp_path / "made" / "tolerance.json").read_text(encoding="utf-8"))
    decided = DECIDES.get(source, {"transmission_error_mm", "motion_error", "peak_acceleration"})
    assert decided <= set(told["indices"]) <= decided | {"least_play_mm"}
    for found in told["indices"].values():
        assert [(one["source"], one["first"], one["total"]) for one in found] == [(source, 1.0, 1.0)]
    assert "100 %" in said
    assert "Tolerances: none" not in said
    # What deviates is named once
    (named,) = (line for line in said.splitlines() if line.startswith("Tolerances: "))
    words = [word.removeprefix("single ") for word in named.removeprefix("Tolerances: ").split(", ")]
    assert len({word.partition(" ")[0] for word in words}) == len(words)
    # Each figure told to vary does so in the single assemblies, and no other does.
    table = np.genfromtxt(tmp_path / "made" / "assemblies.csv", delimiter=",", names=True)
    for name in ("least_play_mm", "transmission_error_mm"):
        assert (np.ptp(table[name]) > 1e-6) == (name in told["indices"])
    first = told["first_order"]
    assert sum(size > 0.0 for size in first["by_source_mm"].values()) <= 1
    assert first["difference"] == 0.0 or first["play_deviation_drawn_mm"] > 0.0


@at_once(("samples", "right"), [(100, 128), (5000, 8192), (-3, 64)])
def test_a_number_of_samples_that_is_no_power_of_two_is_refused(samples: int, right: int, run: Run) -> None:
    status, _, said = run("tolerance", str(DESIGNS / "ellipse.yaml"), "--samples", str(samples))
    assert status == 2
    assert f"{right} is right" in said


def test_assemblies_join_in_their_order() -> None:
    lot = ellipse_lot()
    tasks = drawn_evenly(128, 1)
    parts = [computed(lot, task) for task in tasks]
    assert Assemblies.joined(parts).count == 128
    (swapped,) = replace(tasks[0], source=DeviationSource("pitch"), other=tasks[1]).chances(lot.flanks)
    (own,), (other,) = (task.chances(lot.flanks) for task in tasks)
    assert np.array_equal(swapped.teeth[0], other.teeth[0])
    assert np.array_equal(swapped.teeth[1], own.teeth[1])
    assert np.array_equal(swapped.pair, own.pair)


def test_rounding_errors_do_not_turn_a_torque_round() -> None:
    """Where it is none, as in a stretch without load, it has the side that it had before."""
    turned = signs_of(np.array([1.0, 2.0, -1e-13, 3.0, 0.0, 0.0, -2.0, -1.0, 0.0]))
    assert turned.tolist() == [1, 1, 1, 1, 1, 1, -1, -1, -1]
    assert signs_of(np.array([0.0, -1e-20, 5.0, 4.0])).tolist() == [1, 1, 1, 1]
    assert signs_of(np.zeros(3)).tolist() == [0, 0, 0]


@pytest.mark.slow
def test_the_shortest_contact_is_that_of_a_build() -> None:
    """Of the worse side of the teeth, whichever pushes: here the backs."""
    made = drive("pump-1-2")
    arcs, _ = arc_rates(made.teeth, placed(made.pitch))
    assert arcs.min() == pytest.approx(made.designed_contact.least_arc, rel=1e-6)
    assert made.designed_contact.least_arc < 0.999 * made.designed_contact.pushing.pairs.least_arc
