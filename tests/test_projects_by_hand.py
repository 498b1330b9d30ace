"""Steps from a design to its answers on stand-ins: gentler laws, worn gears, vibration, walls under roots, play."""

from __future__ import annotations

from math import cos, inf, pi, radians, sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ncgear.project.alternatives as alternatives
import ncgear.project.rough_strength as rough_strength
import ncgear.project.vibration as vibration
import ncgear.project.worn as worn
from at_once import at_once
from ncgear.errors import NoSuchMechanism
from ncgear.pitch.shape import Gear
from ncgear.project.rough_strength import OF_A_RING, RoughStrength
from ncgear.strength.vibration import MeshStiffness, Vibration

Made: Any = SimpleNamespace


# --- other laws, racks and sizes


@pytest.mark.judges("project")
@pytest.mark.parametrize("sound", [0.0, 0.005, 0.31, 0.5, 0.999])
def test_the_largest_sound_part_of_a_swing_is_found_in_hundredths(
    sound: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(alternatives, "_is_sound", lambda design, share, harmful: share <= sound)
    assert alternatives.kept_percent(Made(), lambda law: False) == int(100.0 * sound + 1e-9)


@pytest.mark.judges("project")
def test_limits_and_wishes_that_a_law_oversteps_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ratio from 0.5 to 2.5, 90 mm/s2 and 12 W."""
    check = Made(peak_acceleration_cycle=Made(value=90.0), peak_power_w=Made(value=12.0))
    outcomes = [
        Made(wish=Made(key=key, hard=hard), kept=kept)
        for key, hard, kept in (("a", True, False), ("b", False, False), ("c", True, True))
    ]
    law = Made(ratio_range=(Made(value=0.5), Made(value=2.5)))
    monkeypatch.setattr(alternatives, "Drive", lambda design: Made(outcomes=outcomes, transmission=law, check=check))
    for least, most, acceleration, power, found in (
        (0.4, 2.6, 91.0, 13.0, set()),
        (0.6, 2.4, 89.0, 11.0, {"ratio_min", "ratio_max", "peak_acceleration_mm_s2", "peak_power_w"}),
        (0.4, None, None, 11.0, {"peak_power_w"}),
    ):
        limits = Made(ratio_min=least, ratio_max=most, peak_power_w=power)
        limits = Made(**vars(limits), peak_acceleration_mm_s2=acceleration, peak_acceleration_rad_s2=None)
        wanted = {"a"} | {f"optimize.limits.{key}" for key in found}
        assert alternatives.overstepped(Made(optimize=Made(limits=limits))) == wanted


@pytest.mark.judges("project")
def test_a_flatter_rack_is_rounded_down_to_tenths_of_a_degree() -> None:
    gears = Made(carrying_angle_deg=25.0, rack=Made(pressure_angle_deg=25.0, idle_pressure_angle_deg=18.0))
    drive: Any = Made(gears=gears)
    assert alternatives.flatter_rack(drive, 4.07) == {"gears.rack.pressure_angle_deg": 20.9}
    assert set(alternatives.flatter_rack(drive, 9.0).values()) == {16.0}
    assert len(alternatives.flatter_rack(drive, 9.0)) == 2
    assert alternatives.flatter_rack(drive, 10.6) == {}
    assert alternatives.flatter_rack(drive, 10.5) != {}


@pytest.mark.judges("project")
@pytest.mark.parametrize(("module", "distance"), [(None, 90.0), (2.0, None), (2.0, 90.0)])
def test_more_teeth_at_the_same_centre_distance_have_a_smaller_module(module: Any, distance: Any) -> None:
    """The pair asked for is the second of two stages, 30 driving teeth where the first has 20: 25 of these for 37."""
    size = Made(driving_teeth=20, module_mm=2.0)
    drive: Any = Made(
        gears=Made(profile_shift=Made(per_tooth=(0.1,)), module_mm=module, center_distance_mm=distance),
        whole=Made(by_stage=[Made(pitch=Made(size=size))]),
        pitch=Made(size=Made(driving_teeth=30)),
    )
    found = alternatives.resized(drive, 37)
    wanted = {"gears.teeth": 25, "gears.profile_shift.per_tooth": None}
    if module:
        wanted["gears.module_mm"] = pytest.approx(1.6) if distance is None else None
    assert found == wanted


# --- worn gears


@pytest.mark.judges("project")
def test_wear_adds_up_over_parts_of_a_life_at_the_rate_of_each_part(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rates of 0.4, 0.8 and 1.2 mm a life over a quarter, another quarter, and half a life; half as much play."""
    rates = [0.4, 0.8, 1.2]
    wear = [Made(deepest_mm=rate, play_mm=rate / 2.0, wanted_h=1000.0) for rate in rates]
    pairs = [
        Made(surfaces_by=lambda method, one=one: Made(wear=one), gears=Made(backlash_mm=0.1), pitch=None, rack=None)
        for one in wear
    ]
    asked: list[Any] = []
    later = iter([*pairs[1:], pairs[2]])
    monkeypatch.setattr(worn, "changed_drive", lambda drive, changes: asked.append(changes) or next(later))
    monkeypatch.setattr(worn, "backlash_key", lambda gears: "backlash_mm")
    monkeypatch.setattr(worn, "idle_arms_mm", lambda *_: (Made(value=20.0),))
    monkeypatch.setattr(worn, "rating_of", lambda pair, method: "rated")
    monkeypatch.setattr(worn, "_free", lambda pair: 0.7)
    found = list(worn.worn_over_life(pairs[0], Made(strength=Made(method="estimate"))))
    assert [one.hours for one in found] == [250.0, 500.0, 1000.0]
    assert [one.depth_mm for one in found] == pytest.approx([0.1, 0.3, 0.9])
    assert [one.backlash_mm for one in found] == pytest.approx([0.15, 0.25, 0.55])
    assert [one["gears.backlash_mm"] for one in asked] == pytest.approx([0.15, 0.25, 0.55])
    assert [(one.free, one.rating) for one in found] == 3 * [(0.7, "rated")]


@pytest.mark.judges("project")
def test_worn_gears_with_play_as_an_angle_grow_by_the_angle_and_end_where_they_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """0.2 deg of play; 0.1 mm of wear at an arm of 20 mm is 0.2865 deg."""
    pair = Made(
        surfaces_by=lambda method: Made(wear=Made(deepest_mm=0.4, play_mm=0.4, wanted_h=8.0)),
        gears=Made(angle=0.2),
        pitch=None,
        rack=None,
    )
    asked: list[Any] = []

    def refused(drive: Any, changes: Any) -> Any:
        asked.append(changes)
        raise NoSuchMechanism("no teeth are left")

    monkeypatch.setattr(worn, "changed_drive", refused)
    monkeypatch.setattr(worn, "backlash_key", lambda gears: "angle")
    monkeypatch.setattr(worn, "idle_arms_mm", lambda *_: (Made(value=20.0),))
    (found,) = worn.worn_over_life(pair, Made(strength=Made(method="estimate")))
    assert asked[0]["gears.angle"] == pytest.approx(0.2 + np.degrees(0.1 / 20.0))
    assert found.backlash_mm == pytest.approx(radians(0.2) * 20.0 + 0.1)
    assert (found.hours, found.why, found.rating) == (2.0, "no teeth are left", None)


@pytest.mark.judges("project")
def test_play_moves_an_output_most_where_it_is_fastest_for_its_gear(monkeypatch: pytest.MonkeyPatch) -> None:
    """A slider of 30 sin(angle) mm on a shaft that turns half as fast as its gear, and the gear thrice the driver."""
    angle = np.linspace(0.0, 2.0 * pi, 9)
    monkeypatch.setattr(worn, "sample_angles", lambda law: angle)
    law = Made(driven_angle=lambda phi, order: Made(derivative=lambda n: np.full(phi.shape, 3.0)))
    own = Made(transmission=law, speed=lambda phi: np.full(phi.shape, 0.5), shaft_rad=lambda phi: phi)
    machine = Made(displacement=lambda phi, order: Made(derivative=lambda n: 30.0 * np.cos(phi)))
    pair: Any = Made(pair=own, machine=machine, play=Made(driven_rad=0.01))
    assert worn._free(pair) == pytest.approx(0.01 * 30.0 / 1.5)


# --- vibration


@pytest.mark.judges("project")
def test_a_mesh_is_told_by_its_largest_load_and_the_ends_of_its_resonance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ratios of resonance at six angles, of which the last is beyond a turn: the mesh resonates from 0.85 to 1.15."""
    phi = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 7.0])
    ratios = np.array([0.5, 0.9, 1.1, 1.3, 1.0, 9.0])
    mesh: Any = Made(phi1_rad=phi)
    asked: Any = Made(resonance=lambda phi1, mesh: ratios[: phi1.size])
    drive: Any = Made(machine=Made(speed_rad_s=6.0), conditions=Made(dynamic_factor=None))
    angles, factors, force = np.array([0.1, 0.2, 0.3]), np.array([1.5, 1.2, 1.1]), np.array([50.0, 60.0, 70.0])
    found = vibration.told_vibration(drive, asked, mesh, angles, factors, force)
    assert (found.dynamic_factor, found.dynamic_factor_at_rad) == (1.1, 0.3)
    assert found.peak_tooth_force_vibrating_n == pytest.approx(77.0)
    assert (found.resonance_ratio_min, found.resonance_ratio_max, found.dynamic_factor_is) == (0.5, 1.3, "computed")
    assert found.resonates_between_deg == [pytest.approx(np.degrees([1.0, 2.0])), pytest.approx(np.degrees([4.0, 4.0]))]
    low, high = vibration.RESONANCE
    rpm = 6.0 * 30.0 / pi
    assert found.critical_rpm == pytest.approx((rpm * low / 1.3, rpm * high / 0.5))


@pytest.mark.judges("project")
def test_a_mean_stiffness_is_that_of_all_contacts_over_a_pitch(monkeypatch: pytest.MonkeyPatch) -> None:
    """Contacts of eight positions of which six are even: on two turns with three pitches each one to a pitch."""
    asked: list[Any] = []
    monkeypatch.setattr(MeshStiffness, "of", lambda *given: asked.append(given) or "mesh")
    contacts = Made(
        position=np.array([0, 0, 1, 3, 7]),
        stiffness_n_mm=np.array([1.0, 2.0, 4.0, 8.0, 16.0]),
        share=np.array([0.5, 0.5, 1.0, 1.0, 1.0]),
    )
    even = np.array([True, True, True, False, True, True, False, True])
    loading: Any = Made(contacts=contacts, even=even, cycle_rad=4.0 * pi, closed=True, phi1_rad=np.arange(8.0))
    assert vibration.mesh_stiffness(loading, Made(whole=(3, 5))) == "mesh"
    phi1, stiffness, pairs, cycle, per_pitch = asked[0]
    assert phi1.tolist() == [0.0, 1.0, 2.0, 4.0, 5.0, 7.0]
    assert stiffness.tolist() == [3.0, 4.0, 0.0, 0.0, 0.0, 16.0]
    assert pairs.tolist() == [1.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    assert (cycle, per_pitch) == (4.0 * pi, 1)
    # Forth and back over a range that is half a turn with one and a half pitches.
    opened: Any = Made(**{**vars(loading), "closed": False})
    vibration.mesh_stiffness(opened, Made(whole=(3, 5), stroke_rad=2.0 * pi))
    assert asked[1][3:] == (None, 4)


@pytest.mark.judges("project")
def test_speeds_of_a_sweep_reach_beyond_both_critical_speeds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Critical from 40 to 90 r/min, its own 60 r/min: 10 to 135 r/min; places under half of the load do not count."""
    contacts = Made(position=np.array([0, 0, 1, 2]), force_n=np.array([30.0, 40.0, 34.0, 36.0]))
    loads = Made(still=None, contacts=contacts, even=np.array([True, True, True]), closed=True)
    loads.phi1_rad = np.array([0.1, 0.2, 0.3])
    told = Made(critical_rpm=(40.0, 90.0), resonance_ratio_min=0.6, resonance_ratio_max=1.2)
    monkeypatch.setattr(vibration, "mesh_stiffness", lambda loads, running: "mesh")
    monkeypatch.setattr(vibration, "told_vibration", lambda *given: told)
    seen: list[Any] = []
    monkeypatch.setattr(vibration, "_load_factor", lambda drive, own, loads, speeds: seen.append(speeds))

    def factors(phi1: Any, force: Any, mesh: Any, over: float, faster: Any) -> Any:
        seen.append((phi1, force, over))
        return np.stack([faster, 2.0 * faster], axis=1)

    drive: Any = Made(running=None, machine=Made(speed_rad_s=2.0 * pi), conditions=Made(application_factor=1.25))
    found = vibration.speed_sweep(drive, Made(factors_at_speeds=factors), loads)
    assert found is not None
    assert (found.speed_rpm.min(), found.speed_rpm.max()) == pytest.approx((10.0, 135.0))
    assert np.abs(found.speed_rpm - 60.0).min() < 1e-9
    assert np.diff(np.log(found.speed_rpm)).max() == pytest.approx(np.log(13.5) / (vibration.SPEEDS - 1))
    assert found.least == pytest.approx(0.6 * found.speed_rpm / 60.0)
    assert found.greatest == pytest.approx(1.2 * found.speed_rpm / 60.0)
    assert found.factor == pytest.approx(2.0 * found.speed_rpm / 60.0)
    (phi1, force, over), speeds = seen
    assert (phi1.tolist(), force.tolist(), over) == ([0.1, 0.3], [70.0, 36.0], 1.25)
    assert speeds == pytest.approx(found.speed_rpm * pi / 30.0)


@pytest.mark.judges("strength")
def test_a_mesh_swings_as_a_mass_on_a_spring() -> None:
    """4 kg on 250 N/um swing at 7906 rad/s, teeth pass at 3953 rad/s; the load of the line is K_A F cos(a) / b."""
    mesh: Any = Made(at=lambda phi: (np.full(phi.shape, 250e3), np.full(phi.shape, 1.6)))
    running: Any = Made(face_width_mm=20.0, overlap_ratio=0.0)
    own = Vibration(
        lambda phi: np.full(phi.shape, 4.0), lambda phi: np.full(phi.shape, 3952.85), (0.0, 0.0), 0.35, running
    )
    phi = np.zeros(1)
    assert own.resonance(phi, mesh) == pytest.approx(3952.85 / sqrt(250e6 / 4.0), rel=1e-5)
    resonance, line, stiffness, ratio = own._state(phi, np.array([-800.0]), mesh, 1.25)
    assert (resonance[0], ratio[0]) == (pytest.approx(0.5, rel=1e-4), 1.6)
    assert line == pytest.approx(1.25 * 800.0 * cos(0.35) / 20.0)
    assert stiffness == pytest.approx(12500.0)


# --- strength without teeth


def safety(of: float, wanted: float = 2.0) -> Any:
    return Made(safety=of, wanted=wanted)


@pytest.mark.judges("project")
@at_once(
    ("safeties", "reason", "holds", "weak"),
    [
        ([2.1, 3.0], "", True, []),
        ([1.69, 1.5], "", False, [1.5, 1.69]),
        ([1.9, 1.71], "", False, []),
        ([1.9, 3.0], "it needs the teeth", False, []),
        ([0.9, 0.7], "it needs the teeth", False, [0.7]),
        ([3.1, 3.5], OF_A_RING, True, []),
        ([2.9, 3.5], OF_A_RING, False, []),
    ],
)
def test_teeth_hold_by_the_rough_safety_alone_where_no_reason_is_left(
    safeties: list[float], reason: str, holds: bool, weak: list[float]
) -> None:
    """What needs the teeth is too weak below four tenths of what is wanted, what does not below 0.85; a ring holds by
    half as much more."""
    found = RoughStrength(tuple(map(safety, safeties)), needs_teeth=reason)
    assert found.holds is holds
    assert [one.safety for one in found.weak] == weak
    assert found.share(found.safeties[0]) == pytest.approx(safeties[0] / (2.0 * (0.4 if reason else 0.85)))


@pytest.mark.judges("project")
@at_once("place", [20.0 + 0j, 14.0 + 5.0j, 12.0 - 9.0j, -15.0 + 1.0j, 2.0 + 15.0j])
@at_once("keyway", [None, Made(width_mm=6.0, depth_mm=3.0)])
def test_a_wall_reaches_from_a_root_to_the_bore_or_its_keyway(place: complex, keyway: Any) -> None:
    """A bore of 20 mm; the keyway is a rectangle 6 mm wide from the axis to 13 mm along x."""
    drive: Any = Made(gears=Made(driving=Made(bore_mm=20.0, keyway=keyway)))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rough_strength, "_roots_mm", lambda drive, gear, phi1: np.array([place]))
        (found,) = rough_strength._bored_mm(drive, Gear.DRIVING, np.zeros(1))
    wall = abs(place) - 10.0
    if keyway and place.real > 0.0:
        nearest = complex(min(place.real, 13.0), np.clip(place.imag, -3.0, 3.0))
        wall = min(wall, abs(place - nearest))
    assert found == pytest.approx(wall)


@pytest.mark.judges("project")
@at_once(("web", "holes", "bore", "found"), [
    (None, None, None, [inf, inf]), (6.0, None, None, [6.0, 6.0]), (6.0, 4.0, None, [4.0, 4.0]),
    (6.0, None, 20.0, [5.0, 6.0]), (None, None, 20.0, [5.0, 8.0]),
])  # fmt: skip
def test_the_thinnest_given_wall_is_under_a_root(web: Any, holes: Any, bore: Any, found: list[float]) -> None:
    body = Made(web=web and Made(rim_mm=web), lightening_holes=holes and Made(least_wall_mm=holes), keyway=None)
    body.bore_mm = bore
    drive: Any = Made(gears=Made(driven=body), pitch=Made(of=lambda gear: Made(is_ring=False)), helix=None)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rough_strength, "_bored_mm", lambda drive, gear, phi1: np.array([5.0, 8.0]))
        assert rough_strength._walls_mm(drive, Gear.DRIVEN, np.zeros(2)).tolist() == found
        drive.helix = object()
        if bore and not web:
            assert rough_strength._walls_mm(drive, Gear.DRIVEN, np.zeros(2)).tolist() == [5.0, 5.0]


@pytest.mark.judges("project")
def test_a_rings_wall_is_what_its_rim_leaves_outside_a_root(monkeypatch: pytest.MonkeyPatch) -> None:
    """Roots 40 to 44 mm from the axis and a rim of 6 mm outside the farthest: 50 mm in all."""
    monkeypatch.setattr("ncgear.project.gear_solids.rim_mm_of", lambda gears, module: 3.0 * module)
    monkeypatch.setattr(rough_strength, "_roots_mm", lambda drive, gear, phi1: (42.0 + 2.0 * np.cos(phi1)) * 1j)
    pitch = Made(of=lambda gear: Made(is_ring=True), size=Made(driven_teeth=40, module_mm=2.0))
    drive: Any = Made(gears=Made(driven=None), pitch=pitch, transmission=Made(cycle_rad=2.0 * pi))
    found = rough_strength._walls_mm(drive, Gear.DRIVEN, np.array([0.0, pi / 2.0, pi]))
    assert found == pytest.approx([6.0, 8.0, 10.0])


@pytest.mark.judges("project")
@pytest.mark.parametrize(("teeth", "undercut"), [(16.0, True), (18.0, False)])
def test_round_gears_of_few_teeth_would_be_undercut(
    teeth: float, undercut: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A rack of 20 deg that is straight one module deep undercuts fewer than 2 / sin^2(20 deg) = 17.1 teeth."""
    rack = Made(flank_depth_mm=2.0, angles_rad=(radians(20.0), radians(25.0)))
    monkeypatch.setattr(rough_strength, "tooth_form_of", lambda gears, module: Made(rack=rack))
    curvature = {Gear.DRIVING: (None, Made(value=1.0 / teeth * 50.0)), Gear.DRIVEN: (None, Made(value=0.1))}
    pitch = Made(size=Made(module_mm=2.0), curvature_range=curvature, center_distance_mm=50.0)
    assert rough_strength._would_be_undercut(Made(gears=None, pitch=pitch)) is undercut


@pytest.mark.judges("project")
def test_a_rough_mean_stiffness_has_all_sides_of_the_teeth(monkeypatch: pytest.MonkeyPatch) -> None:
    """64 positions at 32 a pitch over two turns of one tooth: a cycle of 4 pi; twice as many where loads return."""
    asked: list[Any] = []
    monkeypatch.setattr(MeshStiffness, "of", lambda *given: asked.append(given) or "mesh")
    sides: Any = [
        Made(
            load=Made(phi1_rad=np.array([0.1, 0.2])), stiffness_n_mm2=np.array([3.0, 4.0]), bearing=np.array([1.0, 2.0])
        ),
        Made(load=Made(phi1_rad=np.array([0.3])), stiffness_n_mm2=np.array([5.0]), bearing=np.array([1.5])),
    ]
    drive: Any = Made(running=Made(face_width_mm=10.0, teeth=(1, 3)))
    for returns, closed, cycle in ((False, True, 4.0 * pi), (True, False, None)):
        monkeypatch.setattr(rough_strength, "asked_of", lambda drive, returns=returns: Made(loads_return=returns))
        rough_strength.rough_mesh(drive, sides, Made(phi1_rad=np.zeros(64), closed=closed))  # type: ignore[arg-type]
        phi1, stiffness, pairs, found, per_pitch = asked.pop()
        assert (phi1.tolist(), stiffness.tolist(), pairs.tolist()) == (
            [0.1, 0.2, 0.3],
            [30.0, 40.0, 50.0],
            [1.0, 2.0, 1.5],
        )
        assert (found, per_pitch) == (cycle, 64 if returns else 32)


@pytest.mark.judges("project")
def test_knocks_are_shaken_by_the_larger_of_the_laws_part_and_the_motions(monkeypatch: pytest.MonkeyPatch) -> None:
    """K_V of half the force for the law's half of the torque, or of the followed motion."""
    asked: list[Any] = []

    def factors(phi1: Any, force: Any, mesh: Any, conditions: Any, followed: bool = False) -> Any:
        asked.append((force.tolist(), followed))
        return np.array([1.1, 1.5]) if followed else np.array([2.4, 2.0])

    load: Any = Made(phi1_rad=np.array([0.1, 0.2]), force_n=np.array([100.0, 80.0]), urge=np.array([-1.0, 1.0]))
    borne: Any = Made(phi1_rad=np.array([0.0]), asked=lambda phi: np.array([-2.0, 1.0]))
    # Forces per torque by which the followed torque is 4 in both places.
    per = Made(mesh_force=lambda phi, urge: Made(size_n=Made(value=np.array([25.0, 20.0]))))
    monkeypatch.setattr(rough_strength, "asked_of", lambda drive: per)
    drive: Any = Made(vibration=Made(factors=factors), conditions=Made(dynamic_factor=None))
    found = rough_strength._shaken(drive, load, None, borne)
    assert found == pytest.approx([max(0.5 * 2.4, 1.1), max(0.25 * 2.0, 1.5)])
    assert asked == [([50.0, 20.0], False), ([100.0, 80.0], True)]
    assert rough_strength._shaken(drive, load, None, None).tolist() == [2.4, 2.0]
