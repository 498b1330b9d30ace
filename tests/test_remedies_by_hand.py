"""Remedies and measured pairs by stand-ins whose answers are known: motors, herringbones, least numbers, jams."""

from __future__ import annotations

from math import pi, radians
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.project import compared, face_load, finer, outline_fit, outline_trial, sizing, vibration
from ncgear.project.compared import ComparedPair

pytestmark = pytest.mark.judges("project")

Made: Any = SimpleNamespace


@pytest.mark.parametrize(("least", "found"), [(21.3, 22.0), (38.0, 38.0), (39.5, None), (9.0, 10.0)])
def test_herringbones_are_as_narrow_as_holds(
    least: float, found: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Straight teeth of 2 mm are 40 mm wide; herringbones of 30 deg hold from ``least`` on, at least 10."""
    straight: Any = Made(
        design=Made(motion=Made(is_open=False), key_in_file=str, gears=None),
        helix=None,
        pitch=Made(driven=Made(is_ring=False)),
        gears=Made(idlers=None, method="exact"),
    )
    monkeypatch.setattr("ncgear.project.gear_solids.PROCESS", ())
    widths: list[float] = []

    def changed(drive: Any, changes: Any) -> Any:
        return Made(angle=changes["gears.helix.angle_deg"], width=changes["gears.face_width_mm"])

    def sized(changes: Any, drive: Any, rating: Any) -> Any:
        assert drive.angle == 30.0
        widths.append(drive.width)
        return Made(face_width_mm=drive.width, share=drive.width / least, holds=drive.width >= least)

    monkeypatch.setattr(sizing, "widths_mm", lambda design: (0.0, np.inf))
    monkeypatch.setattr(sizing, "changed_drive", changed)
    monkeypatch.setattr(sizing, "rating_of", lambda *_: None)
    monkeypatch.setattr(sizing, "Sized", sized)
    monkeypatch.setattr(sizing, "_roughly", lambda drive: 1.0 if drive is straight else drive.angle / 20.0)
    one: Any = Made(drive=straight, changes={}, face_width_mm=40.0, module_mm=2.0, share=1.0)
    best = sizing.in_herringbone(one)
    assert all(10.0 <= width < 40.0 and width == round(width) for width in widths)
    assert len(widths) <= sizing.TRIES
    if found is None:
        assert best is None
    else:
        assert best is not None
        assert found <= best.face_width_mm <= found + sizing.NEAR_MM
    monkeypatch.setattr(sizing, "_roughly", lambda drive: 1.0)
    assert sizing.in_herringbone(one) is None


@pytest.mark.parametrize(("least", "made"), [(33, 33), (33, 41), (99, 99)])
def test_the_least_number_is_good_and_can_be_made(least: int, made: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Good from one number on, made from another; below the least that does stands the greatest that does not."""
    monkeypatch.setattr(finer, "changed_drive", lambda whole, changes: Made(of_stage=lambda _: changes, n=changes["n"]))

    def require_made(whole: Any) -> None:
        if whole.n < made:
            raise NoSuchMechanism("not made", key="gears")

    monkeypatch.setattr(finer, "require_made", require_made)
    monkeypatch.setattr(finer, "is_accepted", lambda design, changes: True)
    pair: Any = Made(whole=None, stage=0, design=None)
    found = finer._least(pair, lambda n: {"n": n}, lambda changes: changes["n"] >= least, 60.0, (20, 80, 1))
    enough = max(least, made)
    if enough > 80:
        assert found.changes == {}
    else:
        assert found.changes == {"n": enough}
        assert found.beyond["n"] < enough
    assert found.is_whole


def test_measured_pairs_jam_where_they_have_no_play() -> None:
    """Tightest first, each pair of teeth once; what is lacking is the overlap at the pitch radius of the flanks."""

    def pair(least: float) -> Any:
        play = np.array([1e-4, -2e-4, -3e-10, -5e-4, -4e-4])
        return Made(
            measured=Made(backlash_rad=play),
            placement=Made(teeth_at=lambda place: (place // 3, place // 3)),
            measured_extremes=Made(backlash_rad=Made(low=Made(value=least)), tightest_teeth=(9, 9)),
            lever_mm=50.0,
        )

    jams, needed = ComparedPair.jams.fget, ComparedPair.needed_backlash_mm.fget  # type: ignore[attr-defined]
    assert jams(pair(-6e-4)) == [(9, 9), (1, 1), (0, 0)]
    assert jams(pair(-5e-10)) == [(1, 1), (0, 0)]
    assert needed(pair(-6e-4)) == pytest.approx(0.03)
    assert needed(pair(2e-4)) == 0.0


def test_play_is_searched_again_about_the_middle_of_the_neighbours(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where it is wider there it counts, from the law's angle on; a single odd place does not move the middle."""
    count = 8
    first = Made(
        overlap_mm=np.append(np.zeros(count - 1), 0.1),
        pushing_rad=np.full(count, -0.01),
        back_rad=np.full(count, 0.03),
        backlash_rad=np.full(count, 0.04),
    )
    first.pushing_rad[3], first.back_rad[3] = 5.0, 7.0
    asked: list[Any] = []

    def as_written(outlines: Any, teeth: Any, placement: Any, reach: float) -> Any:
        asked.append(placement.phi2_rad)
        if len(asked) == 1:
            return first
        wider = np.where(np.arange(count) == 5, 0.06, 0.02)
        return Made(backlash_rad=wider, pushing_rad=np.full(count, -0.03), back_rad=np.full(count, 0.03))

    monkeypatch.setattr(compared, "as_written", as_written)
    monkeypatch.setattr(compared, "replace", lambda one, **changes: Made(**{**vars(one), **changes}))
    found = compared._contact(Made(), Made(), Made(toothed=None, phi2_rad=np.zeros(count)), 1.0)
    assert asked[1] == pytest.approx(np.full(count, 0.01))
    assert (found.pushing_rad[5], found.back_rad[5]) == (pytest.approx(-0.02), pytest.approx(0.04))
    assert (found.pushing_rad[4], found.back_rad[4]) == (-0.01, 0.03)


def test_curves_near_an_outline_have_the_nearest_number_of_teeth(monkeypatch: pytest.MonkeyPatch) -> None:
    """A hull of 200 mm is 32 pitches of module 2; the free curve of 170 mm is 27 of them."""
    search: Any = Made(design=None, outline=Made(hull_length_mm=200.0), limits=None, wanted=None, axis_mm=None)
    asked: list[int] = []
    monkeypatch.setattr(outline_trial, "gears_of", lambda design: Made(module_mm=2.0))
    monkeypatch.setattr(
        outline_fit, "nearest_curve", lambda outline, teeth, *_: asked.append(teeth) or Made(length_mm=170.0)
    )
    monkeypatch.setattr(outline_fit, "_with_teeth", lambda curve, teeth: teeth)
    assert outline_fit._Search.with_module(search) == 27
    assert asked == [32]
    assert outline_fit._steepest_rad(60.0, Made(carrying_angle_deg=20.0)) == pytest.approx(radians(40.0))
    with pytest.raises(WrongInput, match="60 deg given, of which the rack has 60"):
        outline_fit._steepest_rad(60.0, Made(carrying_angle_deg=60.0))


def test_a_mesh_swings_by_the_stiffness_and_mass_of_its_positions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two contacts of 100 and 50 N/mm on an arm of 3 mm; 0.2 kg of reduced mass; none where flanks change sides."""
    contacts = Made(
        side=np.array([0, 0, 0]), position=np.array([0, 0, 2]), stiffness_n_mm=np.array([100.0, 50.0, 70.0])
    )
    loads: Any = Made(
        contacts=contacts,
        even=np.array([True, True, True]),
        phi1_rad=np.array([0.1, 0.2, 0.3]),
        torque_n_mm=np.array([5.0, 6.0, 7.0]),
        error_rad=np.array([0.01, 0.02, 0.03]),
        cycle_rad=2.0 * pi,
    )
    made: list[Any] = []
    monkeypatch.setattr(vibration, "asked_of", lambda _: Made(arms_mm=lambda phi, urge: np.full((phi.size, 2), 3.0)))
    monkeypatch.setattr(vibration, "SwingingMesh", lambda *given: made.append(given) or given)
    monkeypatch.setattr(vibration, "swings", lambda mesh, speeds: Made(load_factor=speeds))
    given: Any = Made(reduced_kg=lambda phi: np.full(phi.size, 0.2))
    speeds = np.array([1.0, 2.0])
    drive: Any = Made(design=Made(simulation=Made(damping_ratio=0.03)))
    assert vibration._load_factor(drive, given, loads, speeds) is speeds
    phi1, cycle, stiffness, inertia, error, torque, damping = made[0]
    assert damping == 0.03
    assert (phi1.tolist(), cycle) == ([0.1, 0.3], 2.0 * pi)
    assert stiffness == pytest.approx([150.0 * 9.0, 70.0 * 9.0])
    # 1 kg is 1e-3 N s2/mm.
    assert inertia == pytest.approx([0.2e-3 * 9.0] * 2)
    assert (error.tolist(), torque.tolist()) == ([0.01, 0.03], [5.0, 7.0])
    contacts.side = np.array([0, 1, 0])
    assert vibration._load_factor(drive, given, loads, speeds) is None


def test_numbers_of_teeth_and_helix_angles_are_tried_in_their_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Teeth in multiples of the lobes, up to some times as many; whole degrees below the angle that is given."""
    monkeypatch.setattr(finer, "_least", lambda pair, changes, good, seconds, numbers: (changes, numbers))
    monkeypatch.setattr(finer, "resized", lambda pair, count: {"gears.teeth": count})
    lobes = Made(lobes=Made(teeth_step=3))
    pair: Any = Made(transmission=lobes, pitch=Made(size=Made(driving_teeth=30)))
    changes, numbers = finer.fewest_teeth(pair, Made(), 1.0)
    assert numbers == (30, finer.MOST_FINER * 30, 3)
    assert changes(42) == {"gears.teeth": 42}
    pair.pitch.size.driving_teeth = finer.MOST_TEETH
    assert finer.fewest_teeth(pair, Made(), 1.0)[1][1] == finer.MOST_TEETH // 3 * 3
    for angle, steps in ((24.6, 24), (24.0, 23)):
        pair.gears = Made(helix=Made(angle_deg=angle))
        changes, numbers = finer.steepest_helix(pair, Made(), 1.0)
        assert numbers == (0, steps, 1)
        told = [changes(step)["gears.helix.angle_deg"] for step in (1, 2, steps)]
        assert told == [steps, steps - 1, 1]


def test_teeth_too_weak_to_be_rated_begin_with_the_first_larger_module_that_can(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of 2 mm, where 7 mm are enough: 8, and a face as many modules wide as is usual, or as wide as it was."""

    def rated(drive: Any, method: str) -> str:
        if drive.pitch.size.module_mm < 7.0:
            raise NoSuchMechanism("too weak", key=sizing.TOO_WEAK)
        return "rated"

    def changed(drive: Any, changes: Any) -> Any:
        size = Made(module_mm=changes["module"], driving_teeth=20)
        return Made(pitch=Made(size=size), gears=Made(face_width_mm=changes["gears.face_width_mm"]))

    monkeypatch.setattr(sizing, "rating_of", rated)
    monkeypatch.setattr(sizing, "changed_drive", changed)
    monkeypatch.setattr(sizing, "sized", lambda drive, teeth, module: {"module": module})
    monkeypatch.setattr(sizing, "Sized", lambda changes, drive, rating: Made(changes=changes, drive=drive))
    for face, expected in ((10.0, 8.0 * sizing.WIDEST_MODULES), (500.0, 500.0)):
        drive: Any = Made(pitch=Made(size=Made(module_mm=2.0, driving_teeth=20)), gears=Made(face_width_mm=face))
        begun: Any = sizing._begun(drive)
        assert begun.changes == {"module": 8.0, "gears.face_width_mm": expected}
    strong: Any = Made(pitch=Made(size=Made(module_mm=7.0, driving_teeth=20)), gears=Made(face_width_mm=10.0))
    assert sizing._begun(strong).changes == {}
    strong.pitch.size.module_mm = 1e-9
    with pytest.raises(NoSuchMechanism, match="too weak"):
        sizing._begun(strong)


def test_gears_without_room_for_a_hub_begin_with_more_teeth(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hubs of 50 mm: 20 teeth of 2 mm have no room, 40 have; a larger module would need thicker walls."""

    def rated(drive: Any, method: str) -> str:
        if drive.pitch.size.module_mm * drive.pitch.size.driving_teeth < 60.0:
            raise NoSuchMechanism("no room", key="gears.driven.hub.diameter_mm")
        return "rated"

    def changed(drive: Any, changes: Any) -> Any:
        return Made(pitch=Made(size=Made(module_mm=changes["module"], driving_teeth=changes["teeth"])))

    monkeypatch.setattr(sizing, "rating_of", rated)
    monkeypatch.setattr(sizing, "changed_drive", changed)
    monkeypatch.setattr(sizing, "sized", lambda drive, teeth, module: {"teeth": teeth, "module": module})
    monkeypatch.setattr(sizing, "Sized", lambda changes, drive, rating: Made(changes=changes, drive=drive))
    drive: Any = Made(pitch=Made(size=Made(module_mm=2.0, driving_teeth=20)), gears=Made(face_width_mm=10.0))
    begun: Any = sizing._begun(drive, any_size=True)
    assert (begun.changes["teeth"], begun.changes["module"]) == (40, 2.0)


@pytest.mark.parametrize(("accepted", "found"), [(0, (20, 3.0)), (130.0, (20, 4.0)), (1e9, None)])
def test_the_smallest_of_all_sizes_is_computed_and_accepted(accepted: float, found: tuple[int, float] | None) -> None:
    """Volumes z m^2, guessed a tenth too small; sizes below 150 are too weak where they are computed."""
    computed: list[tuple[int, float]] = []

    def widened(teeth: int, module: float) -> Any:
        computed.append((teeth, module))
        volume = teeth * module**2
        return None if volume < 150.0 else Made(teeth=teeth, module_mm=module, volume_mm3=volume)

    search: Any = Made(trials=0, most_computed=10, weak={(40, 2.0)}, teeth=lambda: [20, 40], widened=widened)
    search.space, search.volume = Made(modules_mm=[2.0, 3.0, 4.0]), lambda teeth, module: 0.9 * teeth * module**2

    def accepts(one: Any) -> sizing.Accepted:
        return sizing.Accepted.YES if one.volume_mm3 > accepted + 150.0 else sizing.Accepted.NO

    search.polished = lambda found, accepts: found
    best = sizing._Search.smallest_of_all(search, accepts)
    assert (best and (best.teeth, best.module_mm)) == found
    assert computed[0] == (20, 2.0)
    assert (40, 2.0) not in computed
    if found == (20, 3.0):
        # A guess that is no smaller than what is found ends the search.
        assert computed == [(20, 2.0), (20, 3.0)]


def test_face_loads_are_told_of_the_teeth_that_bear_most() -> None:
    """Factors 1.5 and 1.2 at two positions with 100 and 90 N/mm, a third with little; straight 1.1, crowned 1.05."""
    factors = {"straight": [1.1, 1.1, 1.1], "best": [1.05, 1.3, 1.0]}

    class Model(SimpleNamespace):
        def factors(self, loads: Any) -> np.ndarray:
            return np.array(factors["straight" if self.askew_mm == 0.0 else "best"])

    class Contacts(SimpleNamespace):
        def on(self, gear: Any) -> Any:
            return Made(tooth=np.array([3, 4, 5]))

    model = Model(askew_mm=0.012, lead=Made(crowning_mm=0.002, relief_length_mm=0.0), width_mm=40.0)
    loads = Made(force_n=np.ones(3), kept=lambda mask: mask)
    loading: Any = Made(model=model, loads_of=lambda *_: loads)
    over = np.array([100.0, 90.0, 1.0])
    angles = np.array([0.7, 0.8, 0.9])
    contacts: Any = Contacts(force_n=np.ones(3), position=np.arange(3), over_width_n=over, phi1_rad=angles)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(face_load, "replace", lambda one, **changes: type(one)(**{**vars(one), **changes}))
        asked: list[Any] = []
        loads_by_length = {0.1: 5.0, 0.2: 3.0, 0.3: 4.0, 0.4: 4.0, 0.5: 4.0}

        def best(model: Any, heavy: Any, most: Any, lead: Any) -> tuple[float, float]:
            asked.append((heavy, most))
            length = lead(0.001).relief_length_mm
            return 0.0083, loads_by_length.get(length and length / 40.0, 1.0)

        patch.setattr(face_load, "best_fall_mm", best)
        stresses = Made(dynamic_factor=np.ones(3), face_load_factor=np.array([1.5, 1.2, 9.0]))
        strength: Any = Made(contacts=contacts, stresses=stresses, load="masses")
        best_um = face_load.best_crowning_um(loading, strength, 1.0)
        told: Any = face_load.told_face_load(loading, strength, 1.0, best_um)
        assert face_load.best_crowning_um(Made(model=None), strength, 1.0) is None
        assert face_load.told_face_load(loading, strength, 1.0, None) is None
    assert (told.factor_min, told.factor_min_tooth) == (1.2, 4)
    assert (told.factor_max, told.factor_max_tooth) == (told.decisive_factor, told.decisive_tooth) == (1.5, 3)
    assert told.decisive_factor_at_rad == contacts.phi1_rad[0] == 0.7
    assert asked[0][0].tolist() == [True, True, False]
    others = told.decisive_factor_by_shafts, told.askew_um, told.crowning_um, told.best_crowning_um
    assert others == pytest.approx((1.1, 12.0, 2.0, 8.0))
    # 1.3 times 90 N/mm over the 100 of the decisive tooth is more than 1.05.
    assert told.best_crowning_factor == told.best_end_relief_factor == pytest.approx(1.17)
    assert (told.best_end_relief_um, told.best_end_relief_length_mm) == (8.0, 8.0)
