"""Motors of a lobed sun, round planets and a lobed ring: curves, poses, chambers, forces and teeth."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import cos, pi, radians, tan
from pathlib import Path

import numpy as np
import pytest
import trimesh
from mpmath import mp, mpf
from shapely import LineString, Point, Polygon

from drives import train_of
from ncgear.design.reading.design_file import load_train
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.files.train import judged_train, train_files
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.plane import as_points
from ncgear.pitch.chambers import Chambers
from ncgear.pitch.lobed import FAMILIES, LobedCurves, formula_family, lobed_curves
from ncgear.teeth.form import BasicRack
from ncgear.trains.contact import MeshContact, contacts_of
from ncgear.trains.lobed_motor import MotorBodies, MotorTeeth, motor_train, planet_path
from ncgear.trains.train import Poses, Train

DESIGN = Path(__file__).parents[1] / "designs" / "lobed-motor.yaml"
WIDTH, TOLERANCE = 20.0, 0.005
MOTOR = "ellipse", (4, 6), 14, 15
OTHERS = ("cosine", (3, 4), 9, 20), ("ellipse", (3, 5), 15, 16)
"""Motors of another curve, of lobes that have no factor in common, and of planets with an odd number of teeth."""

MOTORS = [MOTOR, *(pytest.param(one, marks=pytest.mark.slow) for one in OTHERS)]


@cache
def curves_of(family: str, lobes: tuple[int, int], planet_teeth: int, teeth_per_lobe: int) -> LobedCurves:
    return lobed_curves(FAMILIES[family], lobes, planet_teeth, teeth_per_lobe, 1.0)


@cache
def motor(family: str, lobes: tuple[int, int], planet_teeth: int, teeth_per_lobe: int) -> Train:
    rack = BasicRack(1.0, radians(25.0), 1.0, 1.25, 0.2)
    teeth = MotorTeeth(rack, planet_teeth, teeth_per_lobe, 0.0, None, 0.0)
    curves = curves_of(family, lobes, planet_teeth, teeth_per_lobe)
    return motor_train(curves, teeth, MotorBodies(WIDTH, 5.0, None), 60.0, 10.0, TOLERANCE)


def sun_mm(curves: LobedCurves, phi: Array) -> ComplexArray:
    return np.asarray(curves.radius(phi, 0).value * np.exp(1j * phi))


def ring_mm(curves: LobedCurves, count: int) -> ComplexArray:
    """So many points around the ring, whose place of 0 is a lobe's top."""
    phi = np.linspace(0.0, 2.0 * pi * curves.ring_lobes / curves.sun_lobes, count, endpoint=False)
    return np.asarray(curves.ring(phi, 0)[0].value * np.exp(-1j * curves.chi_rad(phi)))


@pytest.mark.judges("pitch")
def test_round_gears_are_a_planetary_gear_of_circles() -> None:
    """At 2 z / (N - n) teeth per lobe all gears are round, and planets go round by Willis' formula."""
    curves = lobed_curves(FAMILIES["ellipse"], (4, 6), 12, 12, 1.0)
    phi = np.linspace(0.0, 2.0 * pi, 9)
    assert curves.radius(phi, 0).value == pytest.approx(np.full(9, 24.0), rel=1e-9)
    assert curves.ring(phi, 0)[0].value == pytest.approx(np.full(9, 36.0), rel=1e-9)
    alpha = np.array([0.3])
    (centre,), (turn,) = planet_path(curves).at(-alpha, alpha)
    assert np.angle(centre) == pytest.approx(0.3 * 24.0 / 60.0, abs=1e-9)
    assert turn == pytest.approx(0.3 * 24.0 / 60.0 * (1.0 - 72.0 / 12.0), abs=1e-9)


@pytest.mark.slow
@pytest.mark.judges("pitch")
@pytest.mark.parametrize("case", MOTORS)
def test_the_ring_rolls_with_the_sun(case: tuple[str, tuple[int, int], int, int]) -> None:
    """By 30 digits: the ring's point on the line through O and P and on the planet's circle, and its angle by the equal
    lean of both curves; both lobes are as long as their teeth."""
    curves = curves_of(*case)
    family, (n, ring_lobes), planet_teeth, per_lobe = case
    with mp.workdps(30):
        r, rho = oracle_radius(curves, family), mpf(planet_teeth) / 2

        def whole(phi: mpf) -> mpf:
            """R: where the line meets the circle about the planet's centre again."""
            centre = r(phi) + rho * mp.exp(-1j * mp.atan(mp.diff(r, phi) / r(phi)))
            return 2 * centre.real - r(phi)

        def rate(phi: mpf) -> mpf:
            h = mpf(10) ** -8
            return r(phi) / whole(phi) * (whole(phi + h) - whole(phi - h)) / (r(phi + h) - r(phi - h))

        ends = [mpf("0.01"), mp.pi / n / 2, mp.pi / n - mpf("0.01")]
        turned = mp.quad(rate, ends)
        arc = mp.quad(lambda phi: mp.sqrt(r(phi) ** 2 + mp.diff(r, phi) ** 2), [0, mp.pi / n, 2 * mp.pi / n])
        places = [float(one) for one in (ends[0], ends[-1])]
        low, high = (float(whole(one)) for one in (ends[0], ends[-1]))
    found = curves.chi_rad(np.array(places))
    assert found[1] - found[0] == pytest.approx(float(turned), rel=1e-8)
    assert curves.ring(np.array(places), 0)[0].value == pytest.approx([low, high], rel=1e-12)
    assert float(arc) == pytest.approx(per_lobe * pi, rel=1e-9)
    assert curves.ring_curve.length_mm == pytest.approx(ring_lobes * per_lobe * pi, rel=1e-9)
    assert Polygon(as_points(ring_mm(curves, 40_000))).length == pytest.approx(curves.ring_curve.length_mm, rel=1e-7)


def oracle_radius(curves: LobedCurves, family: str) -> Callable[[mpf], mpf]:
    """The sun's radius by mpmath, from its greatest and its least radius."""
    n = curves.sun_lobes
    most, least = (mpf(float(one)) for one in curves.radius(np.array([0.0, pi / n]), 0).value)
    size, e = (most + least) / 2, (most - least) / (most + least)
    if family == "cosine":
        return lambda phi: size * (1 + e * mp.cos(n * phi))
    return lambda phi: size * (1 - e * e) / (1 - e * mp.cos(n * phi))


@pytest.mark.judges("trains")
@pytest.mark.parametrize("case", MOTORS)
def test_planets_roll_without_slip(case: tuple[str, tuple[int, int], int, int]) -> None:
    """The material points of planets at both contacts move as those of sun and ring; by differences of the poses."""
    curves, path = curves_of(*case), planet_path(curves_of(*case))
    alpha, step = 0.23, 1e-5
    times = alpha + step * np.array([-1.0, 0.0, 1.0])
    for number in range(curves.planets):
        axis, angle = path.at(2.0 * pi * number / curves.ring_lobes - times, times)
        turn = np.exp(1j * angle)
        phi = curves.places.angle(np.array([2.0 * pi * number / curves.ring_lobes - alpha]))
        ray = np.exp(1j * (phi[0] + alpha))
        for radius, speed in (curves.radius(phi, 0).value[0], 1.0), (curves.ring(phi, 0)[0].value[0], 0.0):
            contact = radius * ray
            own = (contact - axis[1]) / turn[1]
            assert abs(own) == pytest.approx(curves.planet_radius_mm, rel=1e-9)
            moved = (axis + own * turn)[[0, 2]]
            assert abs((moved[1] - moved[0]) / (2.0 * step) - 1j * contact * speed) < 1e-6


@pytest.mark.judges("pitch")
@pytest.mark.parametrize("case", MOTORS)
def test_chambers_are_what_is_left_between_the_curves(case: tuple[str, tuple[int, int], int, int]) -> None:
    """Areas by polygons of many points."""
    curves = curves_of(*case)
    chambers, alpha = Chambers(curves, WIDTH), 0.37
    places = chambers.places_rad(np.array([alpha]))[:, 0]
    sun = sun_mm(curves, np.linspace(0.0, 2.0 * pi, 8_000, endpoint=False)) * np.exp(1j * alpha)
    left = Polygon(as_points(ring_mm(curves, 8_000))).difference(Polygon(as_points(sun)))
    for centre in planet_path(curves).at(places, np.array(alpha))[0]:
        left = left.difference(Point(centre.real, centre.imag).buffer(curves.planet_radius_mm + 2e-4, quad_segs=512))
    areas = np.sort([one.area for one in left.geoms])[-chambers.count :]
    assert areas == pytest.approx(np.sort(chambers.area_mm2(places)), abs=0.02)


@pytest.mark.slow
@pytest.mark.judges("pitch")
@pytest.mark.parametrize("case", MOTORS)
def test_displacement_by_chambers_by_the_integral_and_by_rates(case: tuple[str, tuple[int, int], int, int]) -> None:
    curves = curves_of(*case)
    chambers = Chambers(curves, WIDTH)
    alpha = np.linspace(0.0, 2.0 * pi, 3_600 * 4 + 1)
    assert chambers.flow_mm3(alpha[:-1]).mean() * 2.0 * pi == pytest.approx(chambers.per_turn_mm3, rel=1e-6)
    starts = np.arange(chambers.count) * chambers.step_rad
    grown = sum(np.maximum(np.diff(chambers.area_mm2(start - alpha)), 0.0).sum() for start in starts)
    assert WIDTH * grown == pytest.approx(chambers.per_turn_mm3, rel=1e-6)
    places = np.linspace(0.0, chambers.cycle_rad, 50)
    rate = (chambers.area_mm2(places - 1e-5) - chambers.area_mm2(places + 1e-5)) / 2e-5
    assert rate == pytest.approx(chambers.rate_mm2(places), abs=1e-4)
    least, most = chambers.flow_range
    flow = chambers.flow_mm3(alpha)
    assert flow.min() == pytest.approx(least.value, rel=1e-6)
    assert flow.max() == pytest.approx(most.value, rel=1e-6)
    pulses = np.abs(np.fft.rfft(flow[:-1]))
    assert int(np.argmax(pulses[1:])) + 1 == chambers.pulses


@pytest.mark.judges("pitch")
def test_pressure_on_sun_and_planets_does_the_work_of_the_flow() -> None:
    """The moment of the pressure on the sun's own curve, by its chords, and half the push of each planet."""
    curves = curves_of(*MOTOR)
    chambers, alpha = Chambers(curves, WIDTH), 0.37
    places = chambers.places_rad(np.array([alpha]))[:, 0]
    phi = chambers.contact_rad(places)
    moment = 0.0
    for behind, place in zip(phi, places, strict=True):
        ahead = chambers.contact_rad(np.array([place + chambers.step_rad]))[0]
        if chambers.rate_mm2(np.array([place]))[0] > 0.0:
            chain = sun_mm(curves, np.linspace(behind, ahead, 20_000))
            chord, middle = np.diff(chain), (chain[1:] + chain[:-1]) / 2.0
            # The sun's material is on the left of the way: the pressure pushes to the left.
            moment += WIDTH * float(np.sum((np.conj(middle) * 1j * chord).imag))
    moment += float(chambers.push_n(places, 1.0) / 2.0 @ curves.radius(phi, 0).value)
    assert moment == pytest.approx(float(chambers.flow_mm3(np.array([alpha]))[0]), rel=1e-6)


def test_a_planet_is_held_by_both_of_its_teeth() -> None:
    """Push and both forces along the flanks' normals leave neither force nor moment."""
    curves = curves_of(*MOTOR)
    chambers, slant = Chambers(curves, WIDTH), radians(25.0)
    for place in np.linspace(0.05, chambers.cycle_rad, 7):
        at = np.array([place])
        push = chambers.push_n(at, 1.0)[0]
        phi = chambers.contact_rad(at)
        lean, force = curves.lean_rad(phi)[0], chambers.tooth_force_n(at, 1.0, slant)[0]
        # Along the ray: x outwards, y ahead.  The planet's centre, its contacts, and the inward normals there.
        centre, chord = np.exp(-1j * lean) * curves.planet_radius_mm, 2.0 * curves.planet_radius_mm * cos(lean)
        way = -np.sign(push)
        forces = []
        for contact, mirrored in ((0.0, False), (chord, True)):
            inward = np.exp(-1j * lean) if not mirrored else -np.exp(1j * lean)
            along = 1j * inward if not mirrored else -1j * inward
            forces.append((contact, force * (way * cos(slant) * along + np.sin(slant) * inward)))
        total = 1j * push + sum(one for _, one in forces)
        moment = sum((np.conj(contact - centre) * one).imag for contact, one in forces)
        assert abs(total) < 1e-9 * abs(force) + 1e-12
        assert abs(moment) < 1e-9 * abs(force) * chord + 1e-12


def test_ports_are_covered_at_both_dead_spaces() -> None:
    curves = curves_of(*MOTOR)
    chambers, covering = Chambers(curves, WIDTH), curves.planet_radius_mm - 1.25
    path, (least, most) = planet_path(curves), chambers.dead_spaces
    turn = 2.0 * pi / curves.ring_lobes
    for port in chambers.ports(covering):
        seen = []
        for dead in (least, most):
            alpha = np.array(-dead.place_rad)
            centres = path.at(chambers.places_rad(alpha[None])[:, 0], alpha)[0]
            places = [port.distance_mm * np.exp(1j * (port.direction_rad + k * turn)) for k in range(curves.ring_lobes)]
            seen.append(min(abs(centre - place) for centre in centres for place in places) + port.radius_mm)
        # It touches the edge of what is covered, at both.
        assert seen == pytest.approx([covering, covering], abs=1e-9)


def test_a_ring_that_crosses_itself_is_refused_where_it_does() -> None:
    with pytest.raises(NoSuchMechanism, match="crosses itself") as refused:
        lobed_curves(FAMILIES["ellipse"], (4, 6), 10, 12, 1.0)
    assert "0.523599 rad (30 deg) from a lobe's top" in str(refused.value)
    crossed = LobedCurves(FAMILIES["ellipse"](21.9, 0.16, 4), 4, 6, 5.0)
    rates = crossed.ring(np.array([pi / 4.0]), 0)[1].value
    assert rates[0] < 0.0
    loop = ring_mm(crossed, 6_000)
    assert not LineString(as_points(loop)).is_simple
    assert LineString(as_points(ring_mm(curves_of(*MOTOR), 6_000))).is_simple


def test_planets_larger_than_the_suns_hollows_and_too_many_teeth_are_refused() -> None:
    with pytest.raises(NoSuchMechanism, match="no curve of 4 lobes has 11 teeth per lobe"):
        lobed_curves(FAMILIES["ellipse"], (4, 6), 12, 11, 1.0)
    narrow = LobedCurves(FAMILIES["cosine"](20.0, 0.3, 4), 4, 6, 15.0)
    with pytest.raises(NoSuchMechanism, match="do not go into it"):
        narrow.require_whole()


def test_a_curve_by_a_formula_is_the_named_one_and_has_to_repeat() -> None:
    """The ellipse written out; with a second wave, humps of the ring get rounder."""
    written = lobed_curves(formula_family("(1 - e**2)/(1 - e*cos(4*phi))", 4, "train.radius"), (4, 6), 14, 15, 1.0)
    phi = np.linspace(-1.0, 7.0, 40)
    assert written.radius(phi, 1).value == pytest.approx(curves_of(*MOTOR).radius(phi, 1).value, rel=1e-9)
    rounder = lobed_curves(formula_family("1 + e*cos(4*phi) + 0.01*cos(8*phi)", 4, "train.radius"), (4, 6), 14, 15, 1.0)
    assert rounder.ring_curve.curvature_bounds[1] < curves_of("cosine", *MOTOR[1:]).ring_curve.curvature_bounds[1]
    with pytest.raises(WrongInput, match="must repeat with every lobe"):
        formula_family("1 + e*cos(3*phi)", 4, "train.radius")
    with pytest.raises(WrongInput, match="has no e"):
        formula_family("1 + 0.1*cos(4*phi)", 4, "train.radius")
    with pytest.raises(WrongInput, match=r"the radius is -0.1 at phi = 0.785398"):
        formula_family("e*cos(4*phi)", 4, "train.radius")


def test_a_wrong_ring_is_the_files_fault(tmp_path: Path) -> None:
    path = tmp_path / "motor.yaml"
    path.write_text(DESIGN.read_text().replace("ring_lobes: 6", "ring_lobes: 4"))
    with pytest.raises(WrongInput, match="the ring is around the sun"):
        load_train(path).file.train.train()
    path.write_text(DESIGN.read_text().replace("teeth_per_lobe: 15", "teeth_per_lobe: 14"))
    with pytest.raises(NoSuchMechanism, match="all gears round"):
        load_train(path).file.train.train()
    path.write_text(DESIGN.read_text().replace("rim_mm: 8", "rim_mm: 0.01"))
    with pytest.raises(WrongInput, match=r"less than one module outside the roots; 1\.5 mm or more"):
        load_train(path).file.train.train()
    path.write_text(DESIGN.read_text().replace("rim_mm: 8", "rim_mm: 8\n    backlash_mm: 5"))
    with pytest.raises(WrongInput, match="takes more than 80%") as fault:
        load_train(path).file.train.train()
    assert fault.value.key == "train.gears.backlash_mm"
    path.write_text(DESIGN.read_text().replace("speed_rpm: 60", "speed_rpm: 60\n  curve: cosine\n  radius: 1+e"))
    with pytest.raises(WrongInput, match="curve is given as well"):
        load_train(path).file.train.train()


def outlines_of(train: Train) -> dict[str, Array]:
    return {part.name: part.outline_mm for part in train.parts}


def worst(found: list[MeshContact]) -> tuple[float, float]:
    return max(one.penetration_max_mm for one in found), max(one.gap_max_mm for one in found)


@pytest.mark.slow
@pytest.mark.judges("trains")
@pytest.mark.parametrize("case", MOTORS)
def test_every_planet_meshes_with_sun_and_ring(case: tuple[str, tuple[int, int], int, int]) -> None:
    """All teeth of all planets touch without overlap, over a whole cycle; an even and an odd number of teeth."""
    train = motor(*case)
    deepest, widest = worst(contacts_of(train, outlines_of(train)))
    assert deepest < TOLERANCE
    assert widest < 3.0 * TOLERANCE


@pytest.mark.slow
def test_a_planet_in_a_wrong_phase_clashes() -> None:
    """Half a tooth off overlaps the sun's and the ring's teeth; so does a ring half a pitch off."""
    train = motor(*MOTOR)

    def turned(part: int, angle_rad: float) -> Train:
        def poses_at(driving_rad: Array) -> Poses:
            poses = train.poses_at(driving_rad)
            angle = poses.angle_rad.copy()
            angle[part] += angle_rad
            return replace(poses, angle_rad=angle)

        ends = {train.parts[part].name, "planet_1"}
        meshes = tuple(
            mesh
            for mesh in train.meshes
            if {mesh.first, mesh.second} & ends and "planet_1" in (mesh.first, mesh.second)
        )
        return replace(train, meshes=meshes, poses_at=poses_at)

    for part, angle in ((2, pi / 14.0), (1, pi / 90.0)):
        found = contacts_of(turned(part, angle), outlines_of(train))
        assert worst(found)[0] > 0.1


@pytest.mark.thorough
def test_planets_are_involute_gears_that_a_hob_cuts() -> None:
    """Their flanks by the formula of the involute."""
    planet = motor(*MOTOR).parts[2]
    slant, teeth = radians(25.0), planet.teeth
    radius = np.hypot(*planet.outline_mm.T)
    angle = np.arctan2(planet.outline_mm[:, 1], planet.outline_mm[:, 0])
    base = teeth / 2.0 * cos(slant)
    flank = (radius > base * 1.02) & (radius < teeth / 2.0 + 0.9)
    # Teeth stand half a pitch from the direction of the sun, which is at -x.
    apart = np.abs((angle[flank] - pi - pi / teeth + pi / teeth) % (2.0 * pi / teeth) - pi / teeth)
    at = np.arccos(base / radius[flank])
    half = pi / (2.0 * teeth) + (tan(slant) - slant) - (np.tan(at) - at)
    assert flank.sum() > 100
    assert apart * radius[flank] == pytest.approx(half * radius[flank], abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["lobed-motor", "moving-axis", "idler-chain"])
def test_worked_files_are_built_and_keep_every_condition(name: str) -> None:
    """Every part has its outline and its solid, of the volume of the outline, and everything meets."""
    file = load_train(DESIGN.with_name(f"{name}.yaml")).file
    train = file.train.train()
    judged = judged_train(file.name, file.description, train, lambda _: None)
    assert all(one.holds for one in judged.conditions if one.name != "teeth")
    built = train_files(file.name, judged, lambda _: None)
    assert {"assembly.json", "summary.json", "train.glb", "train.png", "meshes.png"} <= set(built)
    for part in train.parts:
        solid = trimesh.load(io.BytesIO(built[f"{part.name}.stl"]), file_type="stl")
        area = Polygon(part.outline_mm).area
        if part.rim_mm is not None:
            area = pi * part.reach_mm**2 - area
        elif part.bore_mm is not None:
            area -= pi * part.bore_mm**2 / 4.0
        assert solid.is_watertight
        assert solid.volume == pytest.approx(area * part.face_width_mm, rel=1e-3)


@pytest.mark.slow
def test_a_shift_that_parts_the_teeth_is_named_before_their_number() -> None:
    """14 teeth with -0.9 modules of shift; without a shift the same teeth follow each other (1.37)."""
    far = train_of("lobed-motor", (("  gears:\n", "  gears:\n    planet_shift: -0.9\n"),))
    (fault,) = (one for one in far.told.conditions if one.holds is False)
    assert (fault.name, fault.cures[0]) == ("contact ratio", "train.gears.planet_shift nearer to 0")
    assert all(one.holds for one in train_of("lobed-motor").told.conditions)
