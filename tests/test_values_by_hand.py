"""Values of many rooms on a few numbers that are done by hand: meetings, frames, limits, digits, sizes, dimensions."""

from __future__ import annotations

from math import cos, pi, radians, sin, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from ncgear.contact.designed.flanks import FlankContacts
from ncgear.design.keys.strength import PairMaterial
from ncgear.drawings.scene.scene import Scene
from ncgear.dynamics import quasi_static
from ncgear.dynamics.crank_load import _Stroke
from ncgear.dynamics.driven_side import DrivenSide
from ncgear.dynamics.quasi_static import touching_mm
from ncgear.errors import NoSuchMechanism
from ncgear.figures.advice import strength_advice
from ncgear.figures.advice.law_advice import _as_tight
from ncgear.figures.answers.answer import difference
from ncgear.figures.balance import shaking
from ncgear.figures.strong import knock_figures
from ncgear.figures.tables import Column, Table
from ncgear.files.workshop.drawing import Polyline
from ncgear.files.workshop.sheets.frame import first_angle
from ncgear.files.workshop.sheets.sheet import FREE_MM
from ncgear.files.workshop.sheets.sheet import length as dimension
from ncgear.files.workshop.svg import _steps
from ncgear.optimum.certified.ranges import _greatest_ratio
from ncgear.optimum.makeable.demanded import _least_flank_load_n_mm
from ncgear.project.strengthening import Rating
from ncgear.screening.rows import _distance
from ncgear.screening.wanted import rounded_to
from ncgear.strength.film import Regime
from ncgear.strength.surfaces import ContactValue, Wear
from ncgear.whole_machines.told import difference_words

Made: Any = SimpleNamespace


@pytest.mark.judges("contact")
def test_a_meeting_is_whole_where_its_arc_begins_and_ends_within_the_positions() -> None:
    """Three meetings over two steps from positions 4, 0 and 8 of ten; others count by their crossing."""
    enters = np.array([[[0.2, 0.0], [0.0, 0.0], [0.3, 0.0], [1.0, 1.0], [1.0, 1.0]]])
    leaves = np.array([[[1.0, 0.6], [1.0, 0.5], [1.0, 1.0], [0.0, 0.0], [0.0, 0.0]]])
    position = np.array([[4, 5, 6], [0, 1, 2], [8, 9, 10], [3, 4, 5], [3, 4, 5]])
    ahead = np.array([[0.0, 0.0, 0.0]] * 3 + [[-1.0, 1.0, -1.0], [-1.0, -1.0, -1.0]])
    side = Made(
        placement=Made(toothed=(0.0, 1.0), steps=10),
        meetings=Made(position=position, driving_ahead_mm=ahead, side=np.zeros(5)),
        _reaching=(enters, leaves),
        _steps_there=np.ones((5, 2), dtype=bool),
    )
    whole = FlankContacts.whole.func  # type: ignore[attr-defined]
    assert whole(side).tolist() == [True, False, False, True, False]
    side.placement.toothed = None
    assert whole(side).all()


@pytest.mark.judges("drawings")
def test_frames_go_on_or_forth_and_back_evenly() -> None:
    scene: Any = Made(loop_rad=8.0, swings=False)
    assert Scene.evenly_in_time(scene, 4).tolist() == [0.0, 2.0, 4.0, 6.0]
    scene.swings = True
    assert Scene.evenly_in_time(scene, 4).tolist() == [0.0, 4.0, 8.0, 4.0]


@pytest.mark.judges("figures")
@at_once(
    ("key", "given", "wanted", "tight"),
    [
        ("ratio_min", 0.5, 0.4, True),
        ("ratio_min", 0.3, 0.4, False),
        ("ratio_max", 2.0, 3.0, True),
        ("ratio_max", 4.0, 3.0, False),
        ("ratio_max", None, 3.0, False),
        ("convex", True, True, True),
        ("convex", False, True, False),
    ],
)
def test_a_limit_is_as_tight_as_another(key: str, given: Any, wanted: Any, tight: bool) -> None:
    assert _as_tight(key, given, wanted) is tight


@pytest.mark.judges("figures")
def test_the_second_cell_of_a_short_row_fills_the_columns_that_lack() -> None:
    table = Table("t", tuple(Column(name) for name in "abc"), (("x", "y", "z"), ("x", "y"), ("x",)))
    assert [row.span for row in table.html_rows] == [1, 2, 3]
    assert [row.span for row in Table("t", (), (("x", "y"),)).html_rows] == [1]


@pytest.mark.judges("screening")
def test_values_are_rounded_to_digits_of_their_own_size() -> None:
    told = rounded_to(np.array([1234.5, -0.012345, 0.0, np.nan, 99.96]), 3)
    assert told == pytest.approx([1230.0, -0.0123, 0.0, np.nan, 100.0], nan_ok=True)


@pytest.mark.judges("screening")
def test_sizes_of_many_designs_follow_from_any_two_of_three() -> None:
    """Round gears at unit distance, 40 of 2 to 1: pi/3 and 2 pi/3 long over radii of a sixth and a third."""
    length = np.full(3, 4.0 * pi / 3.0)

    def found(**given: Any) -> Any:
        kind = Made(lobes=Made(driving=1, driven=2))
        return _distance(Made(kind=kind, given=lambda key: given.get(key.removeprefix("gears."))), length)

    teeth, module = np.array([20.0, 30.0, 30.0]), np.array([2.0, 2.0, 3.0])
    distance = 1.5 * teeth * module
    for given in ({"teeth": teeth, "module_mm": module}, {"teeth": teeth, "center_distance_mm": distance}):
        told, fits = found(**given)
        assert told == pytest.approx(distance)
        assert fits.all()
    told, fits = found(module_mm=module, center_distance_mm=distance * [1.0, 1.0, 1.01])
    assert told[:2] == pytest.approx(distance[:2])
    assert fits.tolist() == [True, True, False]


@pytest.mark.judges("dynamics")
def test_a_stroke_lies_between_its_dead_centres_and_pairs_only_touch_up_to_a_thousandth() -> None:
    linkage: Any = Made(working_angle_rad=3.5)
    assert _Stroke(linkage, Made(), True).ends_rad == pytest.approx((3.5, 2.0 * pi))
    assert _Stroke(linkage, Made(), False).ends_rad == (0.0, 3.5)
    assert touching_mm(np.array([-1.0, 0.0, 1e-8, 1.0])) == pytest.approx([0.0, 0.0, 1e-11, 1e-10], abs=1e-20)


@pytest.mark.judges("dynamics")
def test_the_driven_side_swings_on_two_pairs_as_stiff_as_the_one() -> None:
    """2 k r^2 over the inertia: twice 500 N/mm at 30 mm on 9e5 N mm s^2 are 1 in a second."""
    near = Made(stiffness=np.array([[500.0]]), lever_mm=np.array([[30.0]]))
    gaps = Made(at=lambda phi1: near, of_sections=lambda turning: turning[:, 0])
    side: Any = Made(meshing=Made(gaps=gaps), inertia=lambda phi1: np.full(1, 9e5))
    assert DrivenSide.swings_rad_s(side, np.array([0.3])) == pytest.approx(1.0)


@pytest.mark.judges("optimum")
def test_a_flank_load_is_at_least_what_the_work_of_a_turn_needs() -> None:
    """16 W over (2 pi + cycle) (cos + t sin) of the flank with the larger lever; of no work, gears or limit nothing."""
    gears = Made(rack_angle_rad=radians(20.0), idle_angle_rad=radians(25.0))
    task: Any = Made(gears=gears, work_n_mm=9000.0, cycle_rad=pi)
    lever = max(cos(angle) + 0.5 * sin(angle) for angle in (radians(20.0), radians(25.0)))
    assert _least_flank_load_n_mm(task, 0.5) == pytest.approx(16.0 * 9000.0 / (3.0 * pi * lever))
    assert _least_flank_load_n_mm(task, float("inf")) == 0.0
    task.work_n_mm = -1.0
    assert _least_flank_load_n_mm(task, 0.5) == 0.0


@pytest.mark.judges("optimum")
def test_the_greatest_ratio_of_a_stretch_solves_its_own_sine() -> None:
    """I = (1 + M)/cos(I l/2) - 1; where there is no such ratio below the greatest of all, that one."""
    ends, length = np.array([1.0, 2.0, 1.0]), np.array([0.2, 0.1, 2.0])
    found = _greatest_ratio(ends, length, 5.0)
    assert found[2] == 5.0
    near = found[:2]
    assert (1.0 + ends[:2]) / np.cos(near * length[:2] / 2.0) - 1.0 == pytest.approx(near, rel=1e-5)
    assert (near > ends[:2]).all()
    assert (near < 5.0).all()


@pytest.mark.judges("files")
def test_an_arc_in_a_drawing_of_scales_goes_round_by_its_own_side() -> None:
    """Three quarters of a circle of 10 mm and the chord of the rest: the larger arc, counter-clockwise, then a line."""
    chain = Polyline(np.array([[10.0, 0.0], [0.0, -10.0]]), np.array([tan(3.0 * pi / 8.0), 0.0]))
    arc, line = _steps(chain, 3)
    assert arc.split() == ["A10,10", "0", "1", "1", "0,-10"]
    assert line == "L10,0"
    clockwise = Polyline(np.array([[10.0, 0.0], [0.0, -10.0]]), np.array([-tan(pi / 8.0), 0.0]))
    assert next(iter(_steps(clockwise, 3))).split() == ["A10,10", "0", "0", "0", "0,-10"]
    aside = Polyline(np.array([[17.0, 3.0], [7.0, -7.0]]), np.array([tan(3.0 * pi / 8.0), 0.0]))
    assert next(iter(_steps(aside, 3))).split() == ["A10,10", "0", "1", "1", "7,-7"]
    flat = Polyline(np.array([[10.0, 0.0], [0.0, -10.0]]), np.array([tan(0.95 * pi / 4.0), 0.0]))
    assert next(iter(_steps(flat, 3))).split()[2] == "0"


@pytest.mark.judges("files")
@at_once(("apart", "side"), [(8.0, 1.0), (-8.0, -1.0)])
def test_a_dimension_stands_beside_its_length(apart: float, side: float) -> None:
    """To the left of the way for a positive distance, with its text in the middle, read from below."""
    found = dimension(np.array([[0.0, 0.0], [60.0, 0.0]]), apart, "60", 1.0)
    lines = [line.points for line in found.lines if hasattr(line, "points")]
    across = [line for line in lines if np.ptp(line[:, 1]) == 0.0 and np.ptp(line[:, 0]) >= 59.0]
    assert [line[0, 1] for line in across] == [8.0 * side]
    assert found.text.place[0] == pytest.approx(30.0)
    assert found.text.place[1] - 8.0 * side == pytest.approx(FREE_MM)


@pytest.mark.judges("whole_machines")
def test_machines_differ_in_words_by_what_counts() -> None:
    def words(own: Any, beside: Any) -> str:
        one, other = (Made(value=values.__getitem__) for values in (own, beside))
        return difference_words(one, other, list(own))

    names = "peak_power_w", "gear_volume_mm3", "driven_flywheel_kg_mm2"

    def machine(*values: float) -> Any:
        return dict(zip(names, values, strict=True))

    assert words(machine(100.0, 5.0, 1.0), machine(100.4, 5.0, 1.0)) == "the same"
    assert words(machine(80.0, 5.0, 1.0), machine(100.0, 5.0, 1.0)) == "20 % less motor"
    assert words(machine(80.0, 6.0, 1.0), machine(100.0, 5.0, 1.0)) == "20 % less motor for 20 % larger gears"
    assert words(machine(100.0, 15.0, 1.0), machine(100.0, 5.0, 1.0)) == "3 times the gears"
    assert words(machine(100.0, 5.0, 0.0), machine(100.0, 5.0, 1.0)) == "no flywheel"
    assert words(machine(100.0, 5.0, 1.0), machine(100.0, 5.0, 0.0)) == "a flywheel"


@pytest.mark.judges("figures")
def test_a_figure_differs_by_its_share_up_to_twice_and_in_times_beyond() -> None:
    pairs = [(210.0, 100.0), (199.0, 100.0), (80.0, 100.0), (100.04, 100.0), (5.0, 0.0), (0.0, 4.0)]
    told = ["2.1 times", "99.0 % higher", "20.0 % lower", "the same", "", "100.0 % lower"]
    assert [difference(*pair) for pair in pairs] == told


@pytest.mark.judges("figures")
@at_once(
    ("safety", "holds", "boundary", "told"),
    [
        (2.0, True, False, []),
        (0.9, True, False, ["scuff"]),
        (None, True, True, ["film"]),
        (0.9, False, True, ["scuff", "wear", "film"]),
    ],
)
def test_flanks_are_told_of_where_they_scuff_wear_or_are_hardly_parted(
    safety: float | None, holds: bool, boundary: bool, told: list[str]
) -> None:
    film = Made(regime=Regime.BOUNDARY if boundary else Regime.FULL)
    found = Made(film=film, scuffing_safety=safety, wear=Made(holds=holds))
    drive: Any = Made(surfaces_by=lambda _: found, conditions=Made(lubrication="oil"))
    with pytest.MonkeyPatch.context() as patch:
        rating = object.__new__(Rating)
        object.__setattr__(rating, "strength", Made(method=""))
        patch.setattr(strength_advice, "known_rating", lambda _: rating)
        patch.setattr(strength_advice, "unfollowed_motion", lambda _: "")
        for name, word in (("_scuffing", "scuff"), ("_wear", "wear"), ("_boundary", "film")):
            patch.setattr(strength_advice, name, lambda *_, word=word: word)
        assert list(strength_advice.flanks(drive)) == told


@pytest.mark.judges("figures")
def test_the_gear_that_wears_most_is_told_with_its_tooth_and_what_helps_its_material() -> None:
    """Oil helps dry flanks; only steel and iron can be hardened, once."""
    depths = tuple(ContactValue(value, 0.1, 3, 5) for value in (0.02, 0.5))
    wear = Wear((1.0, 1.0), depths, 0.6, 0.25, 1000.0)
    larger = strength_advice.LARGER_GEARS.text
    for lubrication, material, remedies in (
        ("dry", "C45", ["let oil part the flanks", "harden the flanks", larger]),
        ("grease", "C45", ["harden the flanks", larger]),
        ("grease", "16MnCr5", [larger]),
        ("dry", "POM", ["let oil part the flanks", larger]),
    ):
        gears = Made(material=PairMaterial.model_validate({"driving": "C45", "driven": material}))
        drive: Any = Made(gears=gears, conditions=Made(lubrication=lubrication))
        advice = strength_advice._wear(wear, drive)
        assert "tooth 5 of the driven gear loses 0.5 mm" in advice.meaning
        assert "the tenth is 0.25 mm" in advice.meaning
        assert "by up to 0.6 mm" in str(advice)
        assert [one.text for one in advice.remedies] == remedies


@pytest.mark.judges("figures")
def test_knocks_are_counted_and_the_fastest_is_told() -> None:
    knocks: Any = [Made(speed_mm_s=speed, phi1_rad=phi) for speed, phi in ((3.0, 0.1), (9.0, 0.2), (5.0, 0.3))]
    assert knock_figures(knocks) == {"knocks": 3, "knock_max_mm_s": 9.0, "knock_max_at_rad": 0.2}
    assert knock_figures([]) == {"knocks": 0}
    assert knock_figures(None) == {"knocks": None}


@pytest.mark.judges("figures")
def test_cranks_of_a_machine_have_the_moments_of_their_masses(monkeypatch: pytest.MonkeyPatch) -> None:
    """5 kg that rotate and 3 that go to and fro on a crank of 40 mm, at 0.5 rad or mirrored at its negative."""
    masses = Made(rotating_kg=5.0, reciprocating_kg=3.0)
    monkeypatch.setattr(shaking, "joint_masses", lambda linkage, of: masses)
    one: Any = Made(mechanism=Made(linkage=Made(crank_mm=40.0), masses=None), mirrored=False, phase_rad=0.5)
    crank = shaking._crank(one)
    assert sorted(vars(crank).values(), key=str)[:2] == [0.5, 1]
    (joints,) = [value for value in vars(crank).values() if not isinstance(value, int | float)]
    assert (joints.rotating_kg, joints.reciprocating_kg) == (200.0, 120.0)
    one.mirrored = True
    assert sorted(value for value in vars(shaking._crank(one)).values() if isinstance(value, int | float)) == [-1, -0.5]
    assert shaking._massive(one)
    masses.rotating_kg = 0.0
    assert not shaking._massive(one)


@pytest.mark.judges("dynamics")
@at_once(("torque", "low", "high"), [(5.0, -0.03, 1e-9), (-5.0, 0.0, 0.032)])
def test_a_balance_is_enclosed_from_the_first_touch_on(torque: float, low: float, high: float) -> None:
    """Pushing flanks touch at 0 and bear backwards, backs at 0.002 and bear forwards, by 200 N mm a rad."""
    meshing: Any = Made(
        gaps=Made(play_rad=lambda phi: (np.zeros(phi.size), np.full(phi.size, 0.002))), stiffness_key=""
    )

    def missing(ahead: np.ndarray) -> np.ndarray:
        bears = 200.0 * np.maximum(-ahead, 0.0) - 200.0 * np.maximum(ahead - 0.002, 0.0)
        return bears - torque

    first, last = quasi_static._bracket(missing, meshing, np.zeros(1), np.array([torque]))
    assert first[0] <= last[0]
    assert missing(first)[0] >= 0.0 >= missing(last)[0]
    assert 2.1 * low <= first[0] <= last[0] <= 2.1 * high
    with pytest.raises(NoSuchMechanism):
        quasi_static._bracket(lambda ahead: np.full(1, -torque), meshing, np.zeros(1), np.array([torque]))


@pytest.mark.judges("dynamics")
def test_the_next_pair_is_the_one_after_the_deepest() -> None:
    near = Made(urge=np.array([[1.0, 1.0, 0.0, -1.0]] * 2), number=None)
    forces: Any = Made(near=near, depth_mm=np.array([[0.3, 0.1, 9.0, 0.2], [0.1, -0.4, 9.0, -0.2]]))
    told = [quasi_static._depth_of_next_mm(forces, pairs).tolist() for pairs in (1, 2)]
    assert told == [[0.2, -0.2], [0.1, -0.4]]
    assert (quasi_static._depth_of_next_mm(forces, 4) < -100.0).all()


@pytest.mark.judges("files")
def test_the_sign_of_first_angle_projection_has_its_cone_before_its_circles() -> None:
    cone, axis, *rings = list(first_angle(10.0, 20.0))
    assert np.ptp(cone.points[:, 0]) == 7.0
    assert axis.points.tolist() == [[5.5, 20.0], [15.5, 20.0]]
    assert [(one.center, one.radius) for one in rings[:2]] == [((23.0, 20.0), 1.5), ((23.0, 20.0), 3.0)]
    across, upright = (one.points for one in rings[2:])
    assert across.tolist() == [[19.0, 20.0], [27.0, 20.0]]
    assert upright.tolist() == [[23.0, 16.0], [23.0, 24.0]]
