"""Pieces of a working stroke as formulas, thinned teeth of trains and costs of whole machines, on numbers by hand."""

from __future__ import annotations

from math import cos, inf, pi, sqrt, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import Polynomial

import ncgear.formulas.laws as laws
import ncgear.trains.lobed_motor as lobed_motor
import ncgear.trains.moving_axis as moving_axis
import ncgear.whole_machines.limits as limits
from ncgear.pitch.shape import Gear
from ncgear.teeth.form import BasicRack

Made: Any = SimpleNamespace

PIECE: Any = Made(start_rad=0.0, end_rad=1.0)


def values(part: Any, phi1: float) -> dict[str, float]:
    """Values of all steps of a piece at a driving angle, each from the steps before."""
    found = {**part.write.numbers, part.write.variable: phi1}
    for name, step in part.write.steps.items():
        found[name] = float(step.subs(found))
    return {str(name): value for name, value in found.items()}


# --- formulas


@pytest.mark.judges("formulas")
@pytest.mark.parametrize("about", [0.0, 0.3])
@pytest.mark.parametrize("inverse", [True, False])
def test_a_return_is_a_polynomial_of_its_share_and_its_integral(inverse: bool, about: float) -> None:
    """c over tau - about and d over tau, from 2 rad on over 4 rad; 5 rad of the crank are covered before."""
    local, fine = Polynomial([0.8, 0.5, -0.2]), Polynomial([0.05, 0.1])
    law: Any = Made(
        ends=Made(start_rad=2.0, length_rad=4.0, start_driven_rad=5.0),
        about=about,
        local=local,
        correction=fine,
        inverse=inverse,
    )
    (part,) = laws._return(PIECE, law)
    for phi1 in (2.0, 3.1, 6.0):
        tau = (phi1 - 2.0) / 4.0
        value = local(tau - about) + fine(tau)
        found = values(part, phi1)
        assert found["i_12"] == pytest.approx(1.0 / value if inverse else value)
        if inverse:
            whole = local(Polynomial([-about, 1.0])) + fine
            assert found["phi_2"] == pytest.approx(5.0 + 4.0 * float(whole.integ()(tau)))
        else:
            assert "phi_2" not in found


@pytest.mark.judges("formulas")
def test_pieces_of_a_working_stroke_have_the_roots_of_what_is_gone_and_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """x = phi^2 q, then x2 + v (phi - theta2), then a stroke of 100 mm less (theta4 - phi)^2 q."""
    stroke: Any = Made(
        approach_root=np.array([3.0, 0.5]),
        braking_root=np.array([4.0, -0.3]),
        stroke_mm=100.0,
        pressing_start_mm=20.0,
        pressing_mm_rad=25.0,
        theta2_rad=1.2,
        theta4_rad=4.0,
    )
    seen: list[Any] = []
    monkeypatch.setattr(
        laws.linkages, "driven_angle", lambda write, linkage, x, gone, left: seen.append((x, gone, left))
    )
    linkage: Any = None
    for made, phi1, way in (
        (laws._approach, 1.1, 1.1**2 * (3.0 + 0.5 * 1.1)),
        (laws._pressing, 2.0, 20.0 + 25.0 * 0.8),
        (laws._braking, 3.2, 100.0 - 0.8**2 * (4.0 - 0.3 * 0.8)),
    ):
        (part,) = made(PIECE, stroke, linkage)
        found = values(part, phi1)
        x, gone, left = (found[str(name)] for name in seen.pop())
        assert (x, gone, left) == pytest.approx((way, sqrt(way), sqrt(100.0 - way)))


# --- trains


def flanks_asked(module: Any, patch: pytest.MonkeyPatch) -> list[Any]:
    """What is asked of all flanks of a train's gears; the rest of its teeth is left out."""
    asked: list[Any] = []
    tips = Made(flanks=Made(tip_height_mm=np.array([2.0, 1.5]), count=2), met_depth_mm=np.array([1.0, 1.2]))
    patch.setattr(module, "flanks_of", lambda *given: asked.append(given))
    patch.setattr(module, "fitted_pair", lambda first, second, bounds: (tips, tips))
    for name in ("refuse_sharp_curve", "require_teeth", "toothed_gear", "least_contact_ratio"):
        patch.setattr(module, name, lambda *_: 1.5)
    return asked


RACK = BasicRack(2.0, pi / 9.0, 2.0, 2.5, 0.5)


@pytest.mark.judges("trains")
@pytest.mark.parametrize("dented", [False, True])
def test_gears_on_a_moving_axis_share_their_play(dented: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """A quarter of a pitch on each side, and on idle flanks half of 0.1 mm along the pitch curve less."""
    asked = flanks_asked(moving_axis, monkeypatch)
    curves = {Gear.DRIVING: Made(is_dented=dented), Gear.DRIVEN: Made(is_dented=False)}
    axes: Any = Made(lobes=Made(driving=2, driven=3), curve=curves.get)
    form: Any = Made(rack=RACK, backlash=Made(least_normal_mm=0.1), limits=None)
    moving_axis.moving_gears(axes, 24, form, 0.01)
    quarter, thinner = pi / 2.0, pi / 2.0 - 0.05 / cos(pi / 9.0)
    (first, _, teeth, tool, start, halves), (second, _, mates, other, behind, back) = asked
    assert (teeth, mates, start, behind) == (24, 36, 0.0, pytest.approx(pi))
    assert (halves, back) == (pytest.approx((quarter, thinner)), pytest.approx((thinner, quarter)))
    assert (first, second) == (curves[Gear.DRIVING], curves[Gear.DRIVEN])
    if dented:
        assert (tool, other) == (curves[Gear.DRIVEN], curves[Gear.DRIVING])


@pytest.mark.judges("trains")
def test_a_moving_axis_is_told_by_its_ends_and_its_greatest_speed() -> None:
    """40 + 3 cos(phi) mm apart: 3 mm/rad, at 30 r/min 9.425 mm/s; the pitch point is up to 2 mm beside."""
    extremes = iter([(Made(value=37.0, at=pi), Made(value=43.0, at=0.0)), (Made(value=-3.0), Made(value=2.5)),
                     (Made(value=-1.0), Made(value=2.0))])  # fmt: skip
    axes: Any = Made(
        distance=None,
        extremes=lambda of: next(extremes),
        transmission=Made(ratio_range=(Made(value=0.5), Made(value=2.0))),
    )
    gear = Made(teeth=20, undercut=())
    gears: Any = Made(driving=gear, driven=gear, contact_ratio=1.4)
    told = moving_axis._told(axes, gears, 2.0, 30.0, None)
    figures = told.figures
    assert figures["axis_speed_max_mm_s"] == pytest.approx(3.0 * pi)
    assert (figures["center_distance_min_mm"], figures["center_distance_max_mm"]) == (37.0, 43.0)
    assert (figures["pitch_point_offset_max_mm"], figures["contact_ratio_min"]) == (2.0, 1.4)
    rows = dict(told.rows)
    assert "37 mm apart at 180 deg to 43 mm at 0 deg" in rows["axes"]
    assert "up to 3 mm per rad, 9.425 mm/s" in rows["axes"]


@pytest.mark.judges("trains")
@pytest.mark.parametrize("planet_teeth", [12, 13])
def test_planets_of_a_motor_are_thicker_by_their_shift_and_others_thinner_by_the_play(
    planet_teeth: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A shift of 0.3 mm makes halves 0.3 tan(20 deg) wider; 0.1 mm of play is taken off idle flanks of sun and ring."""
    asked = flanks_asked(lobed_motor, monkeypatch)
    monkeypatch.setattr(lobed_motor, "_cutter", lambda curve, teeth: "cutter")
    monkeypatch.setattr(lobed_motor, "circle", lambda gear, mesh, radius, bound: (gear, radius, bound))
    held: list[Any] = []
    monkeypatch.setattr(lobed_motor, "held_below", lambda tips, heights: held.append(heights) or tips)
    monkeypatch.setattr(lobed_motor, "_as_high_as_both", lambda planet, inner: planet)
    monkeypatch.setattr(lobed_motor, "refuse_fouling_cutter", lambda tips: None)
    curves: Any = Made(
        planet_radius_mm=12.0,
        sun_curve=Made(curvature_bounds=(0.01, 0.1)),
        ring_curve=Made(curvature_bounds=(-0.2, 0.0)),
        sun_lobes=4,
        ring_lobes=6,
    )
    teeth: Any = Made(rack=RACK, planet_shift_mm=0.3, backlash_mm=0.1, teeth_per_lobe=5, planet_teeth=planet_teeth)
    lobed_motor.motor_gears(curves, teeth, 0.01)
    wide, play = 0.3 * tan(pi / 9.0), 0.1 / cos(pi / 9.0)
    thick, thin = pi / 2.0 + wide, pi / 2.0 - wide
    sun, outer, inner, ring = asked
    assert (sun[2], outer[2], inner[2], ring[2]) == (20, planet_teeth, planet_teeth, 30)
    assert (sun[1].shift_mm, outer[1].shift_mm, inner[1].shift_mm) == (-0.3, 0.3, 0.3)
    assert (sun[5], ring[5]) == (pytest.approx((thin, thin - play)), pytest.approx((thin - play, thin)))
    assert outer[5] == inner[5] == pytest.approx((thick, thick))
    assert (sun[4], outer[4], inner[4]) == (0.0, pytest.approx(pi), 0.0)
    assert ring[4] == pytest.approx(0.0 if planet_teeth == 12 else pi)
    assert outer[0] == (Gear.DRIVEN, 12.0, 0.01)
    assert inner[0] == (Gear.DRIVING, 12.0, -0.2)
    assert held[0].tolist() == [1.5, 1.5]


# --- whole machines


@pytest.mark.judges("whole_machines")
def test_a_machines_volume_is_limited_by_its_flank_load() -> None:
    """Volume over share^2 and load is a constant: half the load and a share of 1.25 are 0.32 of the volume."""
    figures = Made(contact_share=1.25, gear_volume_mm3=1000.0, flank_load_n_mm=50.0)
    found = limits.machine_limit(Made(figures=figures), 25.0)
    kept = [getattr(found, name) for name in type(found).__dataclass_fields__]
    assert kept == pytest.approx([25.0, 1.0, 320.0, 2.125])
    none = limits.machine_limit(Made(figures=figures), 0.0)
    assert [getattr(none, name) for name in type(none).__dataclass_fields__] == [0.0, inf, 0.0, inf]
    figures.contact_share = inf
    wide = limits.machine_limit(Made(figures=figures), 25.0)
    assert [getattr(wide, name) for name in type(none).__dataclass_fields__][2:] == [0.0, inf]


@pytest.mark.judges("whole_machines")
def test_the_least_cost_is_that_of_a_part_of_the_powers_and_flywheels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts of powers from 40 to 90 W and beyond, each with its least power, its flywheel and its bound of the load."""
    asked: list[Any] = []

    def load(sweeps: Any, power: Any, flywheel: Any, most: Any, share: float) -> Any:
        asked.append((power, flywheel, most))
        return 1000.0 / np.where(np.isfinite(power), power, 500.0) + flywheel[0]

    monkeypatch.setattr(limits, "least_flank_load", load)
    machines = [
        Made(figures=Made(gear_volume_mm3=volume, contact_share=share, flank_load_n_mm=50.0))
        for volume, share in ((1000.0, 2.0), (1200.0, 1.0))
    ]
    parts = np.array([[-2.0, 1.0], [1.0, 4.0]])
    own: Any = Made(
        design=Made(choices=Made(materials=None)),
        machines=machines,
        laws=[Made(flank_load_n_mm=load, found=Made(peak_power_w=peak)) for load, peak in ((70.0, 60.0), (80.0, 90.0))],
        sweeps=None,
        _flywheel_parts=lambda: parts,
        _cost=lambda choices, power, wheel, volume: power + 10.0 * wheel + volume,
    )
    found = limits.MachineLimits.cost(own, 40.0)
    ends = np.geomspace(40.0, 90.0, limits.POWERS + 1)
    power, flywheel, most = asked[0]
    assert power == pytest.approx(np.repeat(np.append(ends[1:], inf), 2))
    assert flywheel == pytest.approx(np.tile(parts, limits.POWERS + 1))
    assert set(most) == {80.0}
    # The least constant: 1000 mm3 over 2^2 and 50 N/mm.
    each = [
        low + 10.0 * max(wheel, 0.0) + 5.0 * (1000.0 / (cap if cap < inf else 500.0) + wheel)
        for low, cap in zip(ends, [*ends[1:], inf], strict=True)
        for wheel in parts[0]
    ]
    assert found == pytest.approx(min(each))
