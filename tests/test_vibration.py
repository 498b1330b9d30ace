"""The vibration of a mesh: method B of ISO 6336-1 by hand, oscillators of another solver, and what is told of it."""

from __future__ import annotations

import re
from dataclasses import replace
from math import cos, pi, radians, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import mathieu_a, mathieu_b

from at_once import at_once
from drives import drive_of_text
from ncgear.dynamics.swinging_mesh import SwingingMesh, swings
from ncgear.figures.advice import strength_advice
from ncgear.figures.advice.values import Advice
from ncgear.figures.flanks import speeds_csv, vibration_of_rating
from ncgear.project.drive import Drive
from ncgear.project.rough_strength import rough_strength
from ncgear.project.strengthening import rating_of
from ncgear.project.vibration import SpeedSweep, mesh_stiffness, speed_sweep
from ncgear.strength.vibration import MeshStiffness, dynamic_factor

TURN = 2.0 * pi


def by_hand(n: float, w: float, c_gamma: float, across: float, f_pb: float, f_f: float, overlap: float = 0.0) -> float:
    """K_V of a pair as the standard writes it: c in N/(mm um), f in um, w in N/mm."""
    c, e = c_gamma / (0.75 * across + 0.25), across + overlap
    bp, bf = c * f_pb / w, c * f_f / w
    if e <= 2.0:
        cv = 0.32, 0.34, 0.23, 0.90, 0.47, 0.47
    else:
        cv = 0.32, 0.57 / (e - 0.3), 0.096 / (e - 1.56), (0.57 - 0.05 * e) / (e - 1.44), 0.47, 0.12 / (e - 1.74)
    cv7 = 0.75 if e <= 1.5 else 1.0 if e > 2.5 else 0.125 * np.sin(pi * (e - 2.0)) + 0.875
    ns = 0.85 if w >= 100.0 else 0.5 + 0.35 * sqrt(w / 100.0)
    if n <= ns:
        return float(n * (cv[0] * bp + cv[1] * bf + cv[2]) + 1.0)
    at, above = cv[0] * bp + cv[1] * bf + cv[3] + 1.0, cv[4] * bp + cv[5] * bf + cv7
    if n <= 1.15:
        return float(at)
    return float(above if n >= 1.5 else above + (at - above) / 0.35 * (1.5 - n))


@pytest.mark.judges("strength")
@at_once(("e", "overlap"), [(1.4, 0.0), (1.7, 0.0), (2.3, 0.0), (1.4, 0.3), (1.5, 1.2)])
@at_once("line", [40.0, 300.0])
def test_dynamic_factor_by_hand(e: float, overlap: float, line: float) -> None:
    """Of straight and helical teeth, and one figure worked on paper.

    N 0.5, w 200, c_gamma 20, e 1.6: c' 13.793, Bp 0.8276, Bf 0.6897, K_V 1.36465.
    """
    ratios = np.array([0.01, 0.4, 0.6, 0.84, 0.9, 1.14, 1.2, 1.4, 1.6, 4.0])
    same = np.full(ratios.shape, 1.0)
    found = dynamic_factor(ratios, line * same, 20e3 * same, e * same, (0.012, 0.010), overlap)
    expected = [max(by_hand(n, line, 20.0, e, 12.0, 10.0, overlap), 1.0) for n in ratios]
    assert found == pytest.approx(expected, rel=1e-12)
    one = np.ones(1)
    assert dynamic_factor(0.5 * one, 200.0 * one, 2e4 * one, 1.6 * one, (0.012, 0.010))[0] == pytest.approx(
        1.36465, abs=1e-4
    )


ROUND = """\
name: round
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 900}
motion: {law: uniform_crank}
gears: {teeth: 40, module_mm: 2, face_width_mm: 20, material: 42CrMo4}
resistance: {polynomial_n: [4000], returning: {polynomial_n: [4000]}}
"""
ELLIPSE = ROUND.replace("law: uniform_crank", "law: ellipse, eccentricity: 0.3")


@pytest.mark.slow
def test_round_gears_have_one_resonance_ratio_by_hand() -> None:
    """Two discs of 80 mm: 1/m = 2 r_b^2 / J with J = rho pi b r^4 / 2; at most the teeth's own variation remains."""
    drive = drive_of_text(ROUND)
    rating = rating_of(drive)
    mesh = mesh_stiffness(rating.loading, drive.running)
    assert mesh is not None
    inertia = 7.85e-6 * pi * 20.0 * 40.0**4 / 2.0
    reduced = inertia / (2.0 * (40.0 * cos(radians(20.0))) ** 2)
    own = np.sqrt(1e3 * mesh.stiffness_n_mm / reduced)
    found = drive.vibration.resonance(mesh.phi1_rad, mesh)
    assert found == pytest.approx(TURN * 40.0 * 900.0 / 60.0 / own, rel=2e-3)
    # A pair of grade 8 by hand, where a tooth bears most: f_pt 2^1.5 (0.001 d + 0.4 m + 5), f_fa 2^1.5 (0.55 m + 5).
    step, limit = 2.0**1.5, min(160.0 / 719.0, 1.0)
    pitch, form = step * (0.08 + 0.8 + 5.0) * cos(radians(20.0)), step * (1.1 + 5.0)
    contacts, row = rating.strength.contacts, int(rating.strength.contacts.force_n.argmax())
    whole = contacts.force_n[contacts.position == contacts.position[row]].sum()
    at = int(np.abs(mesh.phi1_rad - contacts.phi1_rad[row]).argmin())
    kept = drive.vibration.deviations_mm[0] / (pitch / 1e3)
    assert 0.6 < kept < 1.0 - limit * 0.8
    expected = by_hand(
        found[at],
        whole * cos(radians(20.0)) / 20.0,
        mesh.stiffness_n_mm[at] / 20e3,
        mesh.contact_ratio[at],
        kept * pitch,
        kept * form,
    )
    assert rating.strength.stresses.dynamic_factor[row] == pytest.approx(expected, rel=0.02)


@pytest.mark.thorough
def test_an_ellipse_passes_its_teeth_at_a_speed_that_changes_by_its_radii() -> None:
    """ds/dphi1 = sqrt(r r') / cos of no angle but r itself at both ends of the long axis: (1 + e) / (1 - e) apart."""
    drive = drive_of_text(ELLIPSE)
    phi1 = np.linspace(0.0, TURN, 4001)
    passing = drive.vibration.passing_rad_s(phi1)
    length = drive.pitch.length_mm(next(iter(drive.pitch.curvature_range)))
    assert float(np.mean(passing[:-1])) / (TURN * 15.0) == pytest.approx(40.0, rel=1e-6)
    points = drive.pitch.driving.at_angle(phi1).position
    apart = np.hypot(*np.diff(points, axis=0).T)
    assert float(apart.sum()) == pytest.approx(length, rel=1e-5)
    middle = (passing[1:] + passing[:-1]) / 2.0
    assert apart / np.diff(phi1) == pytest.approx(middle * 2.0 / 2.0 / (TURN * 15.0), rel=1e-4)
    assert passing.max() / passing.min() > 1.7  # The mean pitch speed, as method C took it, knows nothing of this.


@pytest.mark.slow
def test_a_mesh_is_said_to_resonate_where_it_does_and_nowhere_else() -> None:
    """At a speed within the critical ones; below them it is not.  A check says the same without teeth."""
    drive = drive_of_text(ELLIPSE)
    told = vibration_of_rating(drive, rating_of(drive))
    assert told is not None
    assert told.resonates_between_deg == []
    assert told.critical_rpm is not None
    low, high = told.critical_rpm
    assert list(strength_advice.vibration(drive)) == []
    for speed in (1.2 * low, 0.8 * high):
        fast = drive_of_text(ELLIPSE.replace("900", f"{speed:.0f}"))
        (advice,) = strength_advice.vibration(fast)
        assert isinstance(advice, Advice)
        assert advice.matters
        assert advice.what.startswith("the mesh resonates (N from 0.85 to 1.15) between phi1 = ")
        assert advice.what.endswith(f" at {round(speed)} r/min")
        rough = rough_strength(fast)
        assert rough is not None
        assert rough.vibration is not None
        assert rough.vibration.resonance_ratio_max == pytest.approx(told.resonance_ratio_max * speed / 900.0, rel=0.1)
        assert any(isinstance(one, Advice) for one in strength_advice.rough_vibration(fast))
        first = [float(end) for end in re.findall(r"\d+", advice.what.partition("phi1 = ")[2])[:2]]
        inside = drive.vibration.resonance(np.radians([np.mean(first)]), _mesh(drive))
        assert 0.85 <= float(inside[0]) * speed / 900.0 <= 1.15
    still = drive_of_text(ELLIPSE.replace("900", f"{0.9 * low:.0f}"))
    assert list(strength_advice.vibration(still)) == []


def _mesh(drive: Drive) -> MeshStiffness:
    mesh = mesh_stiffness(rating_of(drive).loading, drive.running)
    assert mesh is not None
    return mesh


@pytest.mark.thorough
def test_a_slider_counts_where_it_is_fast() -> None:
    """The reduced mass of a heavy slider is next to none at its dead centres, from whose first one the angle goes."""
    text = ROUND + "masses: {slider_kg: 50, rod: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}, "
    text += (
        "crank: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 100000}, driving_gear_kg_mm2: 1e12, driven_gear_kg_mm2: 1}\n"
    )
    drive = drive_of_text(text)
    dead, fast = drive.vibration.reduced_kg(np.array([0.0, 1.3]))
    arm = 40.0 * cos(radians(20.0))
    assert dead == pytest.approx(100001.0 / arm**2, rel=1e-6)
    slope = 40.0 * np.sin(1.3) * (1.0 - 40.0 * np.cos(1.3) / sqrt(150.0**2 - (40.0 * np.sin(1.3)) ** 2))
    assert fast == pytest.approx((100001.0 + 50.0 * slope**2) / arm**2, rel=1e-6)


def mathieu(a: float, q: float) -> float:
    """By how much solutions of y'' + (a - 2 q cos 2t) y = 0 grow in a period."""
    phi1 = np.linspace(0.0, pi, 2000, endpoint=False)
    stiffness = a - 2.0 * q * np.cos(2.0 * phi1)
    one = np.ones(phi1.size)
    return float(swings(SwingingMesh(phi1, pi, stiffness, one, 0.0 * one, one, 0.0), np.ones(1)).multiplier[0])


@pytest.mark.judges("dynamics")
@pytest.mark.parametrize("q", [0.1, 0.25])
def test_swings_grow_between_mathieus_characteristic_numbers(q: float) -> None:
    """The first tongue of Hill's equation lies between b_1 and a_1; beside it nothing grows."""
    low, high = float(mathieu_b(1, q)), float(mathieu_a(1, q))
    assert mathieu(low + 0.01, q) > 1.001
    assert mathieu(high - 0.01, q) > 1.001
    assert mathieu(low - 0.01, q) == pytest.approx(1.0, abs=1e-9)
    assert mathieu(high + 0.01, q) == pytest.approx(1.0, abs=1e-9)


def test_a_mesh_that_is_even_does_not_swing() -> None:
    phi1, one = np.linspace(0.0, TURN, 400, endpoint=False), np.ones(400)
    found = swings(
        SwingingMesh(phi1, TURN, 1e6 * one, 0.01 * one, -2e-4 * one, 300.0 * one, 0.07), np.geomspace(1, 1e4, 9)
    )
    assert found.load_factor == pytest.approx(np.ones(9), abs=1e-9)
    assert np.all(found.multiplier < 1.0)


@pytest.mark.parametrize("share", [0.3, 0.9, 1.6])
def test_an_even_mesh_that_errs_by_waves_swings_as_in_closed_form(share: float) -> None:
    """J y.. + C y. + K y = -J e.. - C e. of e = h (cos(n w t) + cos(2 n w t) / 2): teeth bear T - K y, y = x - e."""
    teeth, stiff, inertia, damping, height, torque = 8, 1e6, 0.01, 0.05, 1e-4, 500.0
    phi1, one = np.linspace(0.0, TURN, 4000, endpoint=False), np.ones(4000)
    wave, friction = sqrt(stiff / inertia) * share, 2.0 * damping * sqrt(inertia * stiff)
    error, borne = 0.0 * phi1, torque * one
    for order, size in ((1.0, height), (2.0, height / 2.0)):
        fast = order * wave
        answer = size * (inertia * fast**2 - 1j * friction * fast) / (stiff - inertia * fast**2 + 1j * friction * fast)
        error = error + size * np.cos(order * teeth * phi1)
        borne = borne - stiff * np.real(answer * np.exp(1j * order * teeth * phi1))
    mesh = SwingingMesh(phi1, TURN, stiff * one, inertia * one, error, torque * one, damping)
    found = swings(mesh, np.array([wave / teeth]))
    assert found.load_factor[0] == pytest.approx(np.abs(borne).max() / torque, rel=2e-3)
    fading = np.exp(-damping * sqrt(stiff / inertia) * TURN * teeth / wave)
    assert found.multiplier[0] == pytest.approx(fading, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.3, 0.52, 0.9, 1.02, 1.6])
def test_swings_against_another_solver(share: float) -> None:
    """DOP853 over 60 turns: stiffness from tooth to tooth and along the curve, inertia that changes, a driven error."""
    teeth, stiff, inertia, damping = 8, 1e6, 0.01, 0.05
    speed = sqrt(stiff / inertia) / teeth * share

    def at(phi1: np.ndarray | float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        k = stiff * (1.0 + 0.2 * np.cos(teeth * phi1) + 0.05 * np.cos(phi1))
        e = 1e-4 * np.cos(teeth * phi1) + 2e-5 * np.sin(2 * teeth * phi1)
        return np.asarray(k), np.asarray(inertia * (1.0 + 0.3 * np.cos(phi1))), np.asarray(e)

    phi1 = np.linspace(0.0, TURN, 4000, endpoint=False)
    found = swings(SwingingMesh(phi1, TURN, *at(phi1), np.full(4000, 500.0), damping), np.array([speed]))

    def slope(time: float, state: np.ndarray) -> list[float]:
        k, j, e = at(speed * time)
        rate = state[1] / j
        return [float(rate), float(-k * (state[0] - e) - 2.0 * damping * np.sqrt(j * k) * rate)]

    period = TURN / speed
    course = solve_ivp(slope, (0.0, 60.0 * period), [0.0, 0.0], "DOP853", rtol=1e-9, atol=1e-14, dense_output=True)
    time = np.linspace(59.0 * period, 60.0 * period, 40_001)
    k, _, e = at(speed * time)
    most = np.abs(500.0 - k * (course.sol(time)[0] - e)).max() / 500.0
    assert found.load_factor[0] == pytest.approx(most, rel=1e-3)


@pytest.mark.thorough
def test_a_sweep_of_speed() -> None:
    """Far under the critical speeds the mesh bears its load, and most within them or at a part of them; K_V is its
    own at its own speed."""
    drive = drive_of_text(ELLIPSE)
    rating = rating_of(drive)
    sweep, told = speed_sweep(drive, drive.vibration, rating.loading), vibration_of_rating(drive, rating)
    assert sweep is not None
    assert told is not None
    assert told.critical_rpm is not None
    own = int(np.flatnonzero(sweep.speed_rpm == 900.0)[0])
    contacts = rating.strength.contacts
    leading = contacts.force_n >= 0.98 * contacts.force_n.max()
    assert sweep.factor[own] >= rating.strength.stresses.dynamic_factor[leading].min()
    assert sweep.greatest / sweep.speed_rpm == pytest.approx(told.resonance_ratio_max / 900.0)
    assert sweep.load_factor is not None
    assert sweep.load_factor[sweep.speed_rpm <= 1.01 * sweep.speed_rpm[0]] == pytest.approx(1.0, abs=0.15)
    assert 1.3 < sweep.load_factor.max() < 6.0
    assert sweep.speed_rpm[sweep.load_factor.argmax()] < told.critical_rpm[1]


def test_swings_without_end_leave_their_cell_empty() -> None:
    one = np.ones(2)
    sweep = SpeedSweep(np.array([10.0, 20.0]), one, one, one, np.array([1.5, np.inf]))
    assert [line.rpartition(",")[2] for line in speeds_csv(sweep).split()] == ["load_factor_swinging", "1.5", ""]
    assert speeds_csv(replace(sweep, load_factor=None)).endswith("1.0,1.0,1.0,\n")


@pytest.mark.slow
def test_a_dynamic_factor_that_is_given_is_taken_everywhere() -> None:
    drive = drive_of_text(ELLIPSE + "strength: {dynamic_factor: 1.4}\n")
    factors = rating_of(drive).strength.stresses.dynamic_factor
    assert set(factors.tolist()) == {1.4}
    free = rating_of(drive_of_text(ELLIPSE)).strength.stresses.dynamic_factor
    assert np.ptp(free) > 0.05


HELIX = "42CrMo4, helix: {angle_deg: 20, kind: helical, hand: left}}"


@pytest.mark.slow
def test_round_helical_gears_have_one_resonance_ratio_and_the_stiffness_of_iso_6336() -> None:
    """c_gamma = c' (0.75 e + 0.25) with c' = 0.8 C_B cos(beta) / (0.04723 + 0.15551 2 / z_n), as for solid gears; the
    estimate of teeth has no C_M of 0.8."""
    drive = drive_of_text(ROUND.replace("42CrMo4}", HELIX))
    mesh, beta = _mesh(drive), radians(20.0)
    assert list(strength_advice.rough_vibration(drive)) == []
    assert list(strength_advice.vibration(drive)) == []
    found = drive.vibration.resonance(mesh.phi1_rad, mesh)
    # Where the crank asks for little, teeth bend less and fewer touch early.
    assert np.ptp(found) < 0.05 * found.mean()
    tip, base = 42.0, 40.0 * cos(radians(20.0))
    across = 2.0 * (sqrt(tip**2 - base**2) - 40.0 * np.sin(radians(20.0))) / (2.0 * pi * cos(radians(20.0)))
    # Under load a few more pairs bear, as teeth that bend touch early.
    assert across <= mesh.contact_ratio.mean() <= 1.15 * across
    single = cos(beta) / (0.04723 + 0.15551 * 2.0 / (40.0 / cos(beta) ** 3))
    assert mesh.stiffness_n_mm.mean() / 20e3 == pytest.approx(single * (0.75 * across + 0.25), rel=0.2)
    contacts, shaken = rating_of(drive).strength.contacts, rating_of(drive).strength.stresses.dynamic_factor
    row = int(contacts.force_n.argmax())
    whole = contacts.force_n[contacts.position == contacts.position[row]].sum()
    at = int(np.abs(mesh.phi1_rad - contacts.phi1_rad[row]).argmin())
    overlap = 20.0 * np.tan(beta) / (2.0 * pi)
    expected = by_hand(
        found[at],
        whole * cos(radians(20.0)) / 20.0,
        mesh.stiffness_n_mm[at] / 20e3,
        mesh.contact_ratio[at],
        *(1e3 * one for one in drive.vibration.deviations_mm),
        overlap,
    )
    # What vibration adds presses all sections evenly, whatever they bear.
    here = (contacts.position == contacts.position[row]) & (contacts.section == contacts.section[row])
    even = whole * contacts.share[row] / contacts.force_n[here].sum()
    assert shaken[row] == pytest.approx(1.0 + (expected - 1.0) * even, rel=1e-3)
    told = vibration_of_rating(drive, rating_of(drive))
    assert told is not None
    # The largest force is that of a pair in all its sections.
    assert told.peak_tooth_force_vibrating_n == pytest.approx(
        rating_of(drive).strength.peak_pair_n * told.dynamic_factor, rel=0.02
    )


SECTORS = """\
name: sectors
linkage: {kind: rack_pinion, radius_mm: 40}
operation: {speed_rpm: 900}
motion: {law: function_generator, function: "x", x_from: 0, x_to: 1, driving_range_deg: 200, driven_range_deg: 200}
gears: {module_mm: 2, center_distance_mm: 80, face_width_mm: 20, material: 42CrMo4}
resistance: {polynomial_n: [2000], friction_n: 200}
"""


@pytest.mark.slow
def test_sectors_that_swing_to_and_fro_have_the_resonance_of_the_whole_gears() -> None:
    """Out and back, by teeth and without, but for inertias, which are those of the discs in their range."""
    drive, whole = drive_of_text(SECTORS), drive_of_text(ROUND)
    mesh, of_whole = _mesh(drive), _mesh(whole)
    assert mesh.cycle_rad is None
    assert np.all(np.diff(mesh.phi1_rad) > 0.0)
    assert drive.vibration.passing_rad_s(mesh.phi1_rad) == pytest.approx(TURN * 40.0 * 900.0 / 60.0, rel=1e-6)
    inner = (mesh.phi1_rad > 0.3) & (mesh.phi1_rad < radians(200.0) - 0.3)
    # Another load bends the teeth otherwise, so that others touch early.
    assert mesh.contact_ratio[inner] == pytest.approx(of_whole.contact_ratio.mean(), rel=0.06)
    assert mesh.stiffness_n_mm[inner] == pytest.approx(of_whole.stiffness_n_mm.mean(), rel=0.06)
    rough = rough_strength(drive)
    told = vibration_of_rating(drive, rating_of(drive))
    assert told is not None
    assert rough is not None
    assert rough.vibration is not None
    assert rough.vibration.resonance_ratio_max == pytest.approx(told.resonance_ratio_max, rel=0.15)
    assert rough.vibration.dynamic_factor == pytest.approx(told.dynamic_factor, rel=0.05)
    assert speed_sweep(drive, drive.vibration, rating_of(drive).loading) is None
