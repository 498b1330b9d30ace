"""Numbers that stand for many: handles of curves, vibration in a turn, sizes of gears nearby, paces of carriers."""

from __future__ import annotations

from math import cos, degrees, pi, radians, sin
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from at_once import at_once
from ncgear.errors import WrongInput
from ncgear.project import forces, law, sizing, vibration
from ncgear.studio import handles
from ncgear.trains import loads, pace
from ncgear.trains.train import Part, PinHole, Poses


class Made(SimpleNamespace):
    """A stand-in, itself and no other."""

    __hash__ = object.__hash__


# --- studio


def points(count: int, *, over_driven: bool = False, quantity: str = "ratio") -> list[Any]:
    return [
        Made(
            driven_share=number / count if over_driven else None,
            phi1_rad=None if over_driven else 2.0 * pi * number / count,
            quantity=quantity,
            value=float(number),
            value_key=f"points.{number}",
        )
        for number in range(count)
    ]


def few(given: list[Any], monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    monkeypatch.setattr(handles, "_placed", lambda drive, some: [(one, 0.0, 0.0) for one in some])
    monkeypatch.setattr(handles, "_of_point", lambda drive, one, *_: {"of": one.value_key, "moves": {"y": {}}})
    lobes = Made(driving_period_rad=2.0 * pi, driven_period_rad=2.0 * pi)
    transmission = Made(lobes=lobes, driven_angle=lambda angle: Made(value=angle))
    return list(handles._of_few(Made(transmission=transmission), given))


@pytest.mark.judges("studio")
@pytest.mark.parametrize("over_driven", [False, True])
@pytest.mark.parametrize(("quantity", "by"), [("ratio", "power"), ("velocity", "sum")])
def test_points_between_two_handles_move_with_both(
    over_driven: bool, quantity: str, by: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 90 points every fifth has a handle.  The shares of both handles of a point add up to one, a half half way."""
    made = few(points(90, over_driven=over_driven, quantity=quantity), monkeypatch)
    assert [one["of"] for one in made] == [f"points.{5 * number}" for number in range(18)]
    shares: dict[str, list[float]] = {}
    for one in made:
        along = one["moves"]["y"]["along"]
        assert len(along) == 8
        for other in along:
            assert set(other) == {"key", "base", by}
            assert other["key"] == f"motion.points.{other['base']:.0f}"
            shares.setdefault(other["key"], []).append(other[by])
    assert len(shares) == 72
    assert_allclose([sum(some) for some in shares.values()], 1.0)
    first = {one["key"]: one[by] for one in made[0]["moves"]["y"]["along"]}
    for far, share in ((1, cos(pi / 10.0) ** 2), (2, cos(pi / 5.0) ** 2), (3, sin(pi / 5.0) ** 2)):
        assert first[f"motion.points.{far}"] == pytest.approx(share)
        assert first[f"motion.points.{90 - far}"] == pytest.approx(share)


@pytest.mark.judges("studio")
@pytest.mark.parametrize(
    ("count", "made"),
    [
        (18 * 90, 18),
        (18 * 90 + 18, 36),
        (36 * 90 + 36, handles.MOST_HANDLES),
        (handles.MOST_HANDLES * 90 + 60, 0),
        (handles.MOST_HANDLES * 180 + 1, 0),
    ],
)
def test_a_handle_moves_ninety_points_to_each_side_at_most(
    count: int, made: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert len(few(points(count), monkeypatch)) == made


@pytest.mark.judges("studio")
def test_numbers_are_held_where_they_change_the_ratio_most(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ratio is 2 + a cos(phi1) + b + d cos(phi1) of which the last is held beside the first; c does nothing."""
    values = {"a": 0.5, "b": 0.0, "c": 3.0, "d": 0.1}
    numbers = [Made(key=name, value=value) for name, value in values.items()]

    def ratio(of: dict[str, float], angle: np.ndarray) -> np.ndarray:
        return 2.0 + (of["a"] + of["d"]) * np.cos(angle) + of["b"] * np.cos(angle - radians(90.0)) + 1e-9 * of["c"]

    monkeypatch.setattr(handles, "_ratio", ratio)
    monkeypatch.setattr(handles, "_with", lambda drive, number, value: {**values, number.key: value})
    drive: Any = Made(transmission=values, design=Made(motion=Made(law_numbers=numbers)))
    values["lobes"] = 0.0
    drive.transmission = type("Law", (dict,), {"lobes": Made(driving_period_rad=2.0 * pi)})(values)
    first, second, last = handles.grips(drive)
    assert [one.number.key for one in (first, second, last)] == ["a", "b", "d"]
    assert (first.angle_deg, first.factor) == (pytest.approx(0.0), pytest.approx(1.0))
    assert second.angle_deg == pytest.approx(90.0)
    assert second.factor == pytest.approx(1.0)
    # Next to the places about the first handle, at 18 + 1 steps of two degrees, or the opposite one.
    assert last.angle_deg == pytest.approx(180.0)
    assert last.factor == pytest.approx(-1.0)


# --- project


@pytest.mark.judges("project")
def test_stretches_are_told_from_their_first_to_their_last_place() -> None:
    phi1 = np.radians([0.0, 10.0, 20.0, 30.0, 40.0])
    inside = np.array([True, False, True, True, False])
    found = vibration._stretches_deg(phi1, inside)
    assert found == [pytest.approx((0.0, 0.0)), pytest.approx((20.0, 30.0))]
    assert vibration._stretches_deg(phi1, ~inside) == [pytest.approx((10.0, 10.0)), pytest.approx((40.0, 40.0))]


@pytest.mark.judges("project")
def test_vibration_is_told_of_the_largest_force_and_of_a_turn() -> None:
    """At 60 r/min ratios from 0.5 to 2.0: 0.85 of the critical speed is met at 25.5 r/min, 1.15 of it at 138."""
    ratios = np.array([0.5, 1.0, 2.0, 9.0])
    mesh: Any = Made(phi1_rad=np.array([0.0, 1.0, 2.0, 7.0]))
    asked: list[Any] = []
    given: Any = Made(resonance=lambda phi1, _: asked.append(phi1) or ratios[: phi1.size])
    drive: Any = Made(machine=Made(speed_rad_s=2.0 * pi), conditions=Made(dynamic_factor=None))
    force, factors = np.array([4.0, 9.0, 5.0]), np.array([2.0, 1.1, 1.9])
    told = vibration.told_vibration(drive, given, mesh, np.array([0.1, 0.2, 0.3]), factors, force)
    assert asked[0].tolist() == [0.0, 1.0, 2.0]
    assert (told.dynamic_factor, told.dynamic_factor_at_rad) == (1.1, 0.2)
    assert told.peak_tooth_force_vibrating_n == pytest.approx(9.9)
    assert (told.resonance_ratio_min, told.resonance_ratio_max) == (0.5, 2.0)
    assert told.dynamic_factor_is == "computed"
    low, high = vibration.RESONANCE
    assert told.critical_rpm == pytest.approx((60.0 * low / 2.0, 60.0 * high / 0.5))
    assert told.resonates_between_deg == [pytest.approx((degrees(1.0), degrees(1.0)))]
    still = vibration.told_vibration(
        drive, Made(resonance=lambda phi1, _: 0.0 * phi1), mesh, np.array([0.1]), np.ones(1), np.ones(1)
    )
    assert still.critical_rpm is None


@pytest.mark.judges("project")
@at_once(
    ("lobes", "period", "refused"),
    [((2, 4, 2), 2.0, False), ((3, 2), 2.0, False), ((3, 2), 1.0, True), ((4, 3), 3.0, False), ((4, 3), 2.0, True)],
)
def test_a_torque_is_met_again_by_gears_with_a_multiple_of_its_lobes(
    lobes: tuple[int, ...], period: float, refused: bool
) -> None:
    """A torque that repeats ``period`` times in a turn of the last gear."""
    torque: Any = Made(force_n=lambda turn: 5.0 + np.cos(period * turn))
    if not refused:
        law._refuse_uneven_turns(torque, lobes)
        return
    with pytest.raises(WrongInput) as said:
        law._refuse_uneven_turns(torque, lobes)
    assert f"every {360.0 / lobes[-1]:g} deg" in said.value.problem


@pytest.mark.judges("project")
@at_once(("peak_n", "share"), [(1e-6, None), (2000.0, 1.0), (4000.0, 2.0), (1e12, 5e8)])
def test_teeth_are_followed_some_times_as_deep_as_their_load_presses_them(peak_n: float, share: Any) -> None:
    """20 N/mm/um of steel over 20 mm: 2000 N press 0.005 mm at a modulus of half."""
    load: Any = Made(load="resistance", peak_n=peak_n)
    soft = [Made(youngs_modulus_mpa=forces.STEEL_MPA), Made(youngs_modulus_mpa=forces.STEEL_MPA / 2.0)]
    found = forces.followed_modules(load, 20.0, soft, 2.0)
    pressed = 2000.0 / (1e3 * forces.ISO_N_MM_UM * 0.5 * 20.0)
    most, least = forces.WITHIN_IN_MODULES, forces.LEAST_IN_MODULES
    wanted = least if share is None else min(max(forces.DEEPER * pressed * share / 2.0, least), most)
    assert found == pytest.approx(wanted)
    load.load = "masses"
    assert forces.followed_modules(load, 20.0, soft, 2.0) == most


@pytest.mark.judges("project")
def test_the_volume_of_gears_grows_with_their_scale_within_the_space() -> None:
    """20 teeth of 2 mm have 60 mm between axes and reach over 90 mm; 30 teeth of 3 mm 135 mm and over 199.5 mm."""
    first = Made(drive=Made(pitch=Made(center_distance_mm=60.0)), diameter_mm=90.0, module_mm=2.0)

    def volume(center: float = 135.0, diameter: float = 199.5, small: float = 89.0, modules: float = 10.0) -> float:
        space = Made(center_distance_mm=center, diameter_mm=diameter)
        search: Any = Made(
            computed=[first],
            space=space,
            too_small_mm=small,
            scale=lambda teeth, module: teeth * module / 40.0,
            width=lambda teeth, module: 30.0,
            widths_mm=lambda module: (1.0, modules * module),
        )
        return sizing._Search.volume(search, 30, 3.0)

    assert volume() == pytest.approx(135.0**2 * 30.0)
    for refused in (volume(center=134.9), volume(diameter=199.4), volume(small=90.0), volume(modules=9.9)):
        assert refused == float("inf")


# --- trains


@pytest.mark.judges("trains")
def test_a_tip_passes_points_where_it_is_nearest() -> None:
    """A carrier that turns by w - sin(w) / 10 behind its tip, which goes round a circle of 50 mm."""
    motion: Any = Made(
        tip=lambda w: 50.0 * np.exp(1j * w),
        carrier_rad=lambda w, order=0: w - 0.1 * np.sin(w) + 0.3 if order == 0 else 1.0 - 0.1 * np.cos(w),
    )
    at = np.array([0.7, 2.3, 6.0])
    path: Any = Made(points=np.array([48.0, 50.0, 53.0]) * np.exp(1j * at))
    assert pace._passed_at(motion, path) == pytest.approx(at - 0.1 * np.sin(at), abs=1e-6)


@pytest.mark.judges("trains")
@pytest.mark.parametrize("arms", [1, 2])
def test_a_stretch_takes_its_share_of_the_cycle(arms: int) -> None:
    """The integral of the pace over a tenth of a turn, by Simpson's rule; its mean is one; arms take turns."""
    motion: Any = Made(
        tip=lambda w: 50.0 * np.exp(1j * w),
        carrier_rad=lambda w, order=0: w if order == 0 else np.ones_like(w),
        carrier_mm=50.0,
        arm_mm=0.0,
    )
    path: Any = Made(points=50.0 * np.exp(1j * np.array([1.0, 1.0 + 0.2 * pi, 4.0])))
    found = pace.carrier_pace(motion, path, [pace.PacedStretch(0, 1, share=0.13)], arms, 1.0)
    c = np.linspace(0.0, 2.0 * pi, pace.PLACES + 1)
    assert found.mean() == pytest.approx(1.0)
    fine = np.linspace(1.0, 1.0 + 0.2 * pi, 2001)
    values = np.interp(fine, c, np.append(found, found[0]))
    share = float(np.sum((values[1:] + values[:-1]) / 2.0 * np.diff(fine))) / (2.0 * pi)
    assert share == pytest.approx(0.13, abs=1e-4)
    half = pace.PLACES // 2
    assert bool(np.abs(found[:half] - found[half:]).max() < 1e-9) is (arms == 2)


@pytest.mark.judges("trains")
def test_a_tip_is_under_its_speed_along_a_stretch() -> None:
    """50 mm at 2 rad/s are 100 mm/s; under 80 mm/s the pace is a quarter over one and a little more."""
    motion: Any = Made(
        tip=lambda w: 50.0 * np.exp(1j * w),
        carrier_rad=lambda w, order=0: w if order == 0 else np.ones_like(w),
        carrier_mm=50.0,
        arm_mm=0.0,
    )
    path: Any = Made(points=50.0 * np.exp(1j * np.array([1.0, 2.0, 4.0])))
    found = pace.carrier_pace(motion, path, [pace.PacedStretch(0, 1, speed_mm_s=80.0)], 1, 2.0)
    c = np.linspace(0.0, 2.0 * pi, pace.PLACES, endpoint=False)
    inside = found[(c >= 1.0) & (c <= 2.0)]
    assert 1.25 <= inside.min() < 1.26
    assert found.min() >= pace.LEAST_PACE - 1e-6
    assert found.min() < 1.0
    with pytest.raises(Exception, match=r"take 1\.\d+ cycles"):
        pace.carrier_pace(motion, path, [pace.PacedStretch(0, 0, speed_mm_s=80.0)], 1, 2.0)


@pytest.mark.judges("trains")
def test_a_rigid_part_is_its_area_less_holes_with_what_is_put_on_it() -> None:
    """A plate of 40 mm by 20 mm, 5 mm thick, with a hole at (10, 3) and a bore; 2 kg put at (-4, 6)."""
    outline = np.array([[-20.0, -10.0], [20.0, -10.0], [20.0, 10.0], [-20.0, 10.0]])
    part = Part("plate", outline, 5.0, bore_mm=6.0, holes=(PinHole(10.0, 3.0, 4.0),))
    found = loads.body_of(part, 8000.0, [Made(at_mm=-4.0 + 6.0j, kg=2.0)])
    per = 8000.0 * 5.0 / 1e9
    hole, bore = 4.0 * pi, 9.0 * pi
    kg = per * (800.0 - hole - bore) + 2.0
    center = (-per * hole * (10.0 + 3.0j) + 2.0 * (-4.0 + 6.0j)) / kg
    second = per * (800.0 * (40.0**2 + 20.0**2) / 12.0 - hole * (109.0 + 2.0) - bore * 4.5) + 2.0 * 52.0
    assert (found.kg, found.center_mm) == (pytest.approx(kg), pytest.approx(center))
    assert found.kg_mm2 == pytest.approx(second - kg * abs(center) ** 2)
    ring = loads.body_of(Part("ring", outline, 5.0, teeth=9, rim_mm=3.0), 8000.0)
    reach = np.hypot(20.0, 10.0) + 3.0
    assert ring.kg == pytest.approx(per * (pi * reach**2 - 800.0))
    assert ring.kg_mm2 == pytest.approx(per * (pi * reach**4 / 2.0 - 800.0 * 2000.0 / 12.0))


@pytest.mark.judges("trains")
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_swinging_arm_needs_the_torque_of_newton_and_euler(sense: float) -> None:
    """It turns by s (phi + 0.2 sin 2 phi) against a frame that stands still, as its driving part turns evenly."""
    n, speed = loads.POSITIONS, 3.0
    square = np.array([[0.0, -5.0], [40.0, -5.0], [40.0, 5.0], [0.0, 5.0]])
    arm = Part("arm", square, 5.0)
    wheel = Part("wheel", square - [20.0, 0.0], 5.0, teeth=8)
    parts = (arm, wheel)

    def poses_at(phi: np.ndarray) -> Poses:
        turned = sense * (phi + 0.2 * np.sin(2.0 * phi))
        zero = np.zeros((2, phi.size))
        return Poses(zero, zero, np.array([turned + 2.0 * phi, 2.0 * phi]))

    train: Any = Made(
        speed_rpm=speed * 30.0 / pi,
        cycle_rad=2.0 * pi,
        repeats=1,
        parts=parts,
        driving="wheel",
        poses_at=poses_at,
        number=lambda name: [one.name for one in parts].index(name),
        part=lambda name: next(one for one in parts if one.name == name),
        body=lambda part: part.name,
    )
    train_loads = loads.turning_load(train, "arm", 8000.0, (), -9810.0j)
    phi = np.linspace(0.0, 2.0 * pi, n + 1)
    body = loads.body_of(arm, 8000.0)
    inertia = body.kg_mm2 + body.kg * abs(body.center_mm) ** 2
    assert train_loads.kg_mm2 == pytest.approx(inertia)
    assert train_loads.turned_rad == pytest.approx(phi + 0.2 * np.sin(2.0 * phi))
    # The wheel turns by two for one of the cycle.
    assert train_loads.rate == pytest.approx(1.0 + 0.4 * np.cos(2.0 * phi), abs=1e-9)
    faster = -0.8 * sense * np.sin(2.0 * phi)
    turned = sense * (phi + 0.2 * np.sin(2.0 * phi)) + 2.0 * phi
    weight = 9810.0 * body.kg * (body.center_mm.real * np.cos(turned) - body.center_mm.imag * np.sin(turned))
    assert train_loads.torque_n_m == pytest.approx(sense * (inertia * faster * speed**2 + weight) / 1e6, abs=1e-9)
    assert train_loads.even_n_m == pytest.approx(sense * inertia * faster / 4.0 * speed**2 / 1e6, abs=1e-9)
