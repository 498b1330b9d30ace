"""Sizes, plays and loads that a project chooses, on stand-ins: rolled loads, faces, backlash, shafts, racks, polish."""

from __future__ import annotations

from math import cos, degrees, pi, radians, sin
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ncgear.project.alternatives as alternatives
import ncgear.project.compared as compared
import ncgear.project.face_load as face_load
import ncgear.project.passing as passing
import ncgear.project.rough_meshing as rough_meshing
import ncgear.project.rough_strength as rough_strength
import ncgear.project.sizing as sizing
import ncgear.project.tolerance as tolerance
import ncgear.project.tolerance_limits as tolerance_limits
from at_once import at_once
from ncgear.design.keys.masses import Simulation
from ncgear.errors import WrongInput
from ncgear.pitch.shape import Gear, Mesh
from ncgear.strength.without_teeth import PER_TOOTH

Made: Any = SimpleNamespace


# --- loads


@pytest.mark.judges("project")
@pytest.mark.parametrize("covered", [None, 33.0])
def test_a_load_rolls_over_all_teeth_or_over_what_is_covered(
    covered: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """2 and 3 teeth of 2 mm meet anew after 6 pitches; the driven gear turns back at 2/3 of the speed."""
    curve = Made(driving_angle=lambda rolled: rolled / 4.0, at_angle=lambda phi: Made(curvature=0.1 + phi))
    pitch = Made(
        size=Made(module_mm=2.0, driving_teeth=2, driven_teeth=3),
        toothed=covered and Made(covered_mm=covered, covered_rad=covered / 4.0 - 1e-12),
        driving=curve,
        of=lambda gear: curve,
        transmission=Made(driven_angle=lambda phi, order: Made(derivative=lambda n: np.full(phi.shape, 2.0 / 3.0))),
        mesh=Made(sense=-1.0),
    )
    asked = Made(
        torque_n_mm=lambda phi: np.cos(phi), mesh_force=lambda phi, torque: Made(size_n=Made(value=np.abs(torque)))
    )
    monkeypatch.setattr(rough_strength, "asked_of", lambda drive: asked)
    drive: Any = Made(pitch=pitch, pair_speed_rad_s=lambda phi: np.full(phi.shape, 3.0))
    found = rough_strength.rolled_load(drive)
    step = pi * 2.0 / PER_TOOTH
    if covered is None:
        assert found.phi1_rad == pytest.approx(step * np.arange(6 * PER_TOOTH) / 4.0)
    else:
        inner = step * np.arange(int(covered / step) + 1)
        assert found.phi1_rad == pytest.approx(np.append(inner, covered) / 4.0)
    assert found.closed is (covered is None)
    assert found.urge == pytest.approx(np.where(np.cos(found.phi1_rad) < 0.0, -1.0, 1.0))
    assert found.force_n == pytest.approx(np.abs(np.cos(found.phi1_rad)))
    assert found.turning_rad_s == pytest.approx(np.full(found.phi1_rad.size, 5.0))
    assert found.curvature == pytest.approx(np.stack([0.1 + found.phi1_rad] * 2))


@pytest.mark.judges("project")
def test_a_rough_mesh_has_levers_play_and_stiffness_of_both_sides(monkeypatch: pytest.MonkeyPatch) -> None:
    """Levers of 20 mm on pushing flanks and 22 mm on backs, which grow with the angle; thicker teeth take play away."""
    kept: list[Any] = []
    monkeypatch.setattr(rough_meshing, "PeriodicTable", lambda phi, values: kept.append((phi, values)))
    for name in ("Gaps", "Meshing", "law_table", "friction_of"):
        monkeypatch.setattr(rough_meshing, name, lambda *given: given)
    monkeypatch.setattr(rough_meshing, "Impact", lambda *given: given)
    arms = {1.0: 20.0, -1.0: 22.0}
    load: Any = Made(mesh_force=lambda phi, urge: Made(size_n=Made(value=1.0 / (arms[float(urge[0])] + phi))))
    side: Any = Made(
        load=Made(urge=np.array([1.0])),
        line_n_mm=np.array([[1.0, 2.0], [1.0, 2.0]]),
        stiffness_n_mm2=np.array([10.0, 20.0]),
    )
    drive: Any = Made(
        pair=Made(transmission=Made(cycle_rad=2.0)),
        play=Made(thicker_mm=0.02, driven_rad=0.01),
        running=Made(face_width_mm=5.0, module_mm=2.0),
        rack=Made(angles_rad=(0.3, 0.4)),
        design=Made(simulation=Simulation()),
    )
    # The mean of springs of 10 and 20 under 2 and 4 N/mm, weighted by these: all deflections of 0.2 mm.
    mean = (4.0 + 16.0) / (4.0 / 10.0 + 16.0 / 20.0)
    assert rough_meshing._mean_stiffness(side) == pytest.approx(mean)
    rough_meshing.rough_meshing(drive, load, [side])
    ((phi, (rising, values)),) = kept
    at = phi[:-1]
    assert phi == pytest.approx(np.linspace(0.0, 2.0, rough_meshing.PLACES + 1))
    assert values[:, 0, rough_meshing.LEVER] == pytest.approx(20.0 + at)
    assert values[:, 1, rough_meshing.LEVER] == pytest.approx(22.0 + at)
    assert values[:, :, rough_meshing.STIFFNESS] == pytest.approx(np.full((at.size, 2), 5.0 * mean))
    assert values[:, 0, 0] == pytest.approx(np.zeros(at.size))
    assert values[:, 1, 0] == pytest.approx(0.01 - 0.04 * cos(0.4) / (22.0 + at))
    assert rising[:, 0, rough_meshing.LEVER] == pytest.approx(np.ones(at.size))


@pytest.mark.judges("project")
def test_forces_press_a_face_along_the_normal(monkeypatch: pytest.MonkeyPatch) -> None:
    """A force of 50 N along (0.6, 0.8), with a thrust of 10 N and its couples; the crank presses beside it."""
    mesh = Made(force=Made(x=30.0, y=40.0), size_n=Made(value=np.array([50.0])), thrust_n=Made(value=np.array([10.0])))
    asked: Any = Made(
        mesh_force=lambda phi, urge: mesh,
        arms_mm=lambda phi, urge: np.array([[15.0, 25.0]]),
        torque_n_mm=lambda phi: np.array([200.0]),
        place=Made(couples_mm=lambda slope: (np.array([2.0 + 1.0j]), np.array([3.0 - 1.0j]))),
        slope=lambda phi: None,
        turns_crank=True,
        pair=Made(shaft_rad=np.asarray),
    )
    monkeypatch.setattr(face_load, "complex_of", lambda force: np.array([force.x + 1j * force.y]))
    beyond: list[Any] = []
    monkeypatch.setattr(face_load, "_crank_n", lambda own, phi, torque: beyond.append(torque) or np.array([100.0 + 0j]))
    own: Any = face_load.FaceLoading("computed", asked=asked)
    found = own.pressing(np.array([0.1]), np.array([-1.0]), np.array([40.0]), np.array([7.0]), 1.25, np.array([1.2]))
    values = [getattr(found, name) for name in type(found).__dataclass_fields__]
    assert beyond[0] == pytest.approx([-40.0 * 25.0 - 200.0])
    assert values[0] == pytest.approx([1.25 * 1.2 * 40.0])
    assert values[1] == pytest.approx([7.0])
    assert values[2] == pytest.approx(np.array([[0.0, 1.25 * 100.0 * 0.6]]))
    assert values[3] == pytest.approx(np.array([[15.0, 25.0]]))
    assert values[4] == pytest.approx(np.array([[-(2.0 * 0.6 + 0.8), 3.0 * 0.6 - 0.8]]) * 0.2)


# --- tolerances


@pytest.mark.judges("project")
@pytest.mark.parametrize("herringbone", [False, True])
def test_a_helical_face_has_a_section_for_each_part_of_its_advance(
    herringbone: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """20 mm wide and an overlap of 0.4; of herringbone teeth a half is 10 mm, and its sections stand on both sides."""
    monkeypatch.setattr(tolerance, "PER_TOOTH", 8)
    rise = 10.0 if herringbone else 20.0
    helix = Made(rise_mm=rise, face_width_mm=20.0, herringbone=herringbone, advance_mm=lambda height: 0.3 * height)
    drive: Any = Made(
        helix=helix,
        overlap_ratio=0.4,
        chord_tolerance_mm=0.01,
        teeth="designed",
        toothed=lambda chord, flank, advance: (chord, flank, advance),
    )
    found = tolerance.face_of(drive)
    heights = np.linspace(0.0, rise, 5)
    assert found.sections[0] == "designed"
    assert [one[2] for one in found.sections[1:]] == pytest.approx((0.3 * heights[1:]).tolist())
    assert found.heights_mm == pytest.approx(10.0 - heights if herringbone else heights - 10.0)
    assert (found.mirrored, found.overlap) == (herringbone, 0.4)
    assert tolerance.face_of(drive, (0.02, 0.03)).sections[0] == (0.02, 0.03, 0.0)


@pytest.mark.judges("project")
@pytest.mark.parametrize(
    ("left", "least", "needs"),
    [([-0.0123, -0.02, 0.1], -0.0123, 0.013), ([0.3, 0.4], 0.3, 0.0), ([-0.00042], -0.00042, 0.00042)],
)
def test_a_needed_backlash_is_rounded_up_to_what_is_made(
    left: list[float], least: float, needs: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In thousandths of a millimetre, with two digits where it is less than ten of these."""
    monkeypatch.setattr(tolerance, "surpassed", lambda values, share: least)
    monkeypatch.setattr(tolerance, "left_of_backlash", lambda pair, play: np.array(left))
    monkeypatch.setattr(tolerance, "backlash_key", lambda gears: "backlash_mm")

    def refused(design: Any) -> Any:
        raise WrongInput("no teeth")

    monkeypatch.setattr(tolerance, "Drive", refused)
    gears = Made(backlash_deg=None, backlash_mm=0.1, model_copy=lambda update: None)
    drive: Any = Made(gears=gears, by_stage=[None], design=Made(model_copy=lambda update: None))
    nothing: Any = None
    found = tolerance._needed(drive, nothing, nothing, Made(pairs=[Made(least_play_rad=None)]), 8, 1, nothing, nothing)
    values = [getattr(found, name) for name in type(found).__dataclass_fields__]
    assert values[:3] == ["backlash_mm", pytest.approx(needs), 0.1]
    assert values[3] == (pytest.approx(needs),)


@pytest.mark.judges("project")
@pytest.mark.parametrize("key", ["backlash_mm", "backlash_deg"])
def test_backlash_that_is_left_is_without_what_was_given_and_without_the_thickest_teeth(
    key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Arms of 20 mm, 0.01 rad given, teeth from -0.06 to 0.02 mm thick under 20 deg."""
    monkeypatch.setattr(tolerance_limits, "idle_arms_mm", lambda pitch, rack: (Made(value=20.0),))
    monkeypatch.setattr(tolerance_limits, "thickness_limits_mm", lambda gears: (-0.06, 0.02))
    pair: Any = Made(
        pitch=None,
        rack=Made(angles_rad=(0.2, radians(20.0))),
        gears=Made(backlash_deg=0.5 if key == "backlash_deg" else None, idlers=None),
        play=Made(driven_rad=0.01, least_normal_mm=Made(value=0.3)),
    )
    unit = 20.0 if key == "backlash_mm" else degrees(1.0)
    thicker = 0.08 * cos(radians(20.0)) / 20.0
    assert tolerance_limits.left_of_backlash(pair, np.array([0.03])) == pytest.approx([unit * (0.02 - thicker)])
    pair.gears.idlers = object()
    assert tolerance_limits.left_of_backlash(pair, np.array([0.03])) == pytest.approx([unit * (0.03 - 0.015)])


@pytest.mark.judges("project")
@at_once(
    ("off", "near", "reads", "said"),
    [
        (0.04, 8, True, ""),
        (0.06, 8, True, "after best fit: other gear"),
        (0.04, 4, True, "after best fit: other gear"),
        (0.04, 5, True, ""),
        (0.06, 8, False, ""),
        (0.21, 8, False, "more than a tenth of its module"),
    ],
)
def test_points_off_their_gear_are_read_otherwise_or_refused(off: float, near: int, reads: bool, said: str) -> None:
    """Points that are off on average, or of which most are astray, belong to something else, if to anything."""
    far = compared.SUSPECT_IN_MODULES * 2.0
    away = np.where(np.arange(10) < near, 0.5 * far, -2.0 * far)
    found = Made(rms_mm=off / 0.05 * far, feet=Made(distance_mm=away))
    outline = Made(gear=Made(flanks=Made(rack=Made(module_mm=2.0))))
    file: Any = Made(points_mm=np.zeros((10, 2)), file="p.csv")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compared, "best_fit", lambda *_, **__: found)
        patch.setattr(compared, "_other_reading", lambda *_: "other gear" if reads else None)
        patch.setattr(compared, "MOST_IN_MODULES", 0.2 / 0.05 * compared.SUSPECT_IN_MODULES)
        for name in ("outline_as_measured", "deviations", "ComparedGear"):
            patch.setattr(compared, name, lambda *_: "compared")
        try:
            compared.compared_gear({Gear.DRIVING: outline}, Gear.DRIVING, file, Made(), 0.0)  # type: ignore[dict-item]
            told = ""
        except WrongInput as error:
            told = error.problem
    assert said in told
    assert bool(said) is bool(told)


# --- bodies, racks and sizes


@pytest.mark.judges("project")
@pytest.mark.parametrize("mesh", list(Mesh))
def test_bodies_stand_beside_the_gears_where_the_pair_is_turned(mesh: Mesh) -> None:
    """The driving axis 50 mm from the driven one at 30 deg; pins 10 mm from their gears' axes in the pair's frame."""
    stop = Made(pin_mm=4.0)
    bodies = [
        Made(hub=Made(diameter_mm=18.0), bore_mm=9.0, end_stop=stop),
        Made(hub=None, bore_mm=8.0, end_stop=stop),
    ]
    drive: Any = Made(
        gears=Made(driving_axis_deg=30.0, driving=bodies[0], driven=bodies[1]),
        pitch=Made(center_distance_mm=50.0, mesh=mesh),
        linkage=Made(pivots_mm={"rocker": (7.0, 8.0)}),
        finished_plans=(Made(pin_mm=(10.0, 0.0)), Made(pin_mm=(0.0, 10.0))),
    )
    found = [tuple(getattr(one, name) for name in type(one).__dataclass_fields__) for one in passing.standing_of(drive)]
    driving = (50.0 * cos(pi / 6.0), 50.0 * sin(pi / 6.0))
    assert found[0][0] == "driving hub"
    assert found[0][1] == pytest.approx(driving)
    assert found[0][2] == 9.0
    assert found[1][:3] == ("rocker's axis", (7.0, 8.0), 0.0)
    if mesh is Mesh.INTERNAL:
        assert len(found) == 2
        return
    # +x of the pair leads from the driving axis to the driven one, at 210 deg.
    way = np.exp(1j * radians(210.0))
    for (_, center, radius, *_rest), axis, pin in zip(found[2:], (complex(*driving), 0j), (10.0, 10.0j), strict=True):
        assert complex(*center) == pytest.approx(axis + pin * way)
        assert radius == 2.0


@pytest.mark.judges("project")
@at_once(
    ("needed", "steepest", "found"),
    [(21, 60.0, 21.0), (24, 60.0, 24.0), (24, 45.0, None), (24, 46.0, 24.0), (31, 90.0, None)],
)
def test_the_flattest_rack_that_undercuts_no_tooth_is_found(needed: int, steepest: float, found: float | None) -> None:
    """From 20.5 deg on in whole degrees, up to 30 and to what 22 deg of the pitch curve leave of the steepest."""
    form = Made(driving_shift_mm=0.2, driven_shift_mm=-0.2)
    drive: Any = Made(
        gears=Made(profile_shift=Made(per_tooth=None)),
        pitch=Made(largest_tangent_angle_rad=Made(value=radians(22.0 + 1e-9)), size=Made(driving_teeth=20)),
        tooth_form=form,
        rack=Made(angles_rad=(radians(20.5), radians(24.0)), module_mm=2.0),
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(alternatives, "rack_at", lambda gears, angle: {"angle": angle})
        patch.setattr(
            alternatives,
            "changed_part",
            lambda gears, changes: Made(
                rack=Made(in_mm=lambda module: Made(shifted=lambda shift: (changes["angle"], shift)))
            ),
        )
        patch.setattr(
            alternatives,
            "_enough",
            lambda drive, driving, driven: (
                20 if driving[0] >= needed and (driving[1], driven[1]) == (0.2, -0.2) else 21
            ),
        )
        assert alternatives.steeper_rack(drive, steepest + 0.5) == ({} if found is None else {"angle": found})


@pytest.mark.judges("project")
@pytest.mark.parametrize(("good", "teeth"), [({37}, 37), ({38, 36}, 36), (set(), 40), ({30}, 40)])
def test_gears_are_polished_by_fewer_or_more_teeth_nearby(
    good: set[int], teeth: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From 40 teeth on those within an eighth; gears of fewer teeth take less room here."""
    monkeypatch.setattr(sizing, "FINENESS", 8.0 / 7.0)
    monkeypatch.setattr(sizing, "POLISHED", 6)
    monkeypatch.setattr(sizing, "POLISH", 1.0)
    own: Any = Made(
        drive=Made(gears=Made(lobes=Made(driving=1))),
        _fewest_teeth=12,
        refused={36} - good,
        trials=5,
        volume=lambda one, module: 100.0 * one,
        widened=lambda one, module: Made(teeth=one, module_mm=module, volume_mm3=100.0 * one) if one in good else None,
    )
    begun: Any = Made(teeth=40, module_mm=2.0, volume_mm3=4000.0)
    found = sizing._Search.polished(own, begun, lambda made: sizing.Accepted.YES)
    assert found.teeth == teeth
    assert own.most == 6


@pytest.mark.judges("design")
def test_damping_beside_a_given_stiffness_belongs_to_that_law_of_contact() -> None:
    """A rating keeps the friction and the ratio, and the damping only of teeth with their own stiffness."""
    law = {"stiffness_n_mm": 1e6, "exponent": 2.2, "damping_n_s_mm": 100.0, "full_damping_depth_mm": 0.1}
    given = Simulation.model_validate({**law, "damping_ratio": 0.03, "friction": {"dynamic": 0.02}})
    rated = given.of_own_stiffness
    assert (rated.stiffness_n_mm, rated.exponent, rated.damping_n_s_mm, rated.full_damping_depth_mm) == (
        None,
        1.0,
        None,
        None,
    )
    assert (rated.damping_ratio, rated.friction.dynamic) == (0.03, 0.02)
    own = Simulation(damping_n_s_mm=5.0)
    assert own.of_own_stiffness is own
