"""Bounds of laws, energy and steps of machines, and what is told of loads and simulations, on a few numbers by hand."""

from __future__ import annotations

from dataclasses import dataclass as plain_dataclass
from math import cos, inf, pi, radians, sin, sqrt, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import integrate

import ncgear.figures.answers.simulated as told_simulated
import ncgear.figures.simulated as simulated
import ncgear.figures.strong as strong
import ncgear.optimum.certified.limit as limit
import ncgear.optimum.certified.refusals as refusals
import ncgear.optimum.certified.sums as sums
import ncgear.optimum.certified.sweeps as sweeps
from at_once import at_once
from ncgear.design.keys.machine import NoLinkage
from ncgear.dynamics.level import Level
from ncgear.dynamics.motion_in_time import ToothedMachine
from ncgear.dynamics.trains_in_time import train_steps
from ncgear.figures.data_sheet import sheet
from ncgear.optimum.certified.motion import MotionProgramme
from ncgear.optimum.outline.outline import Outline
from ncgear.optimum.outline.rolled import Rolled
from ncgear.pitch.shape import Gear

Made: Any = SimpleNamespace


@pytest.mark.judges("optimum")
def test_a_chord_of_the_root_lies_below_it_and_touches_it_at_both_ends() -> None:
    """s is the root of q; over a range of no width the chord is the tangent."""
    low, high = np.array([0.25, 1.0, 4.0]), np.array([4.0, 9.0, 3.0])

    def chord(q: Any) -> Any:
        return MotionProgramme._slower(Made(lowest=low, highest=high, q=q))

    assert chord(low) == pytest.approx(np.sqrt(low))
    assert chord(np.maximum(low, high)) == pytest.approx(np.sqrt(np.maximum(low, high)))
    assert np.all(chord((low + high) / 2.0)[:2] < np.sqrt((low + high) / 2.0)[:2])


@pytest.mark.judges("optimum")
@at_once("border", [1.5, 7.3, 99.0, 0.5])
def test_the_greatest_impossible_level_is_closed_in_from_below(border: float) -> None:
    """Levels from 1 to 100, of which those up to the border are impossible; two problems at once."""
    levels = sweeps.LEVELS
    of: Any = Made(possible=lambda limits: limits > np.repeat([border, 3.0], levels))
    made: Any = lambda level, problems: level  # noqa: E731
    found = sweeps._bisected(of, made, np.ones(2), np.full(2, 100.0))
    # A round divides the ratio into LEVELS - 1 equal steps.
    width = 100.0 ** ((levels - 1.0) ** -sweeps.ROUNDS)
    for value, end in zip(found, (border, 3.0), strict=True):
        assert value == 0.0 if end < 1.0 else end / width * 0.999 <= value <= end
    assert found[1] == pytest.approx(3.0, rel=0.01)


@pytest.mark.judges("optimum")
@at_once("floor", [0.0, 0.9925])
def test_a_curve_is_lowered_to_where_a_slope_is_possible(floor: float) -> None:
    """Slopes are possible up to 0.99 of the first place and anywhere of the second; near the floor it stays."""
    border = np.array([0.99, 2.0])
    barriers: Any = Made(slopes=lambda at, q: (np.where(q > border, 1.0, -1.0), np.zeros(2)))
    q = np.ones(2)
    of: Any = Made(_floor=np.full(2, floor))
    of._stuck = lambda *given: sweeps.Sweeps._stuck(of, *given)
    sweeps.Sweeps._lower(of, barriers, None, q)
    steps = 5 if not floor else 3
    # The last step is taken only where the next value has no slope either.
    assert q == pytest.approx([sweeps.LOWERED**steps, 1.0], abs=2.1e-3)
    assert q[0] > border[0] - 2e-3
    assert q[1] == 1.0


@pytest.mark.judges("optimum")
def test_the_least_sum_with_masses_is_that_of_the_best_interval_of_powers(monkeypatch: pytest.MonkeyPatch) -> None:
    """The least acceleration falls as 4000 / P to 1000 at 4 W: 0.01 a + 4 P is least where P is sqrt(10)."""

    class Programme(SimpleNamespace):
        pass

    def under(power_w: float) -> Any:
        found = max(4000.0 / power_w, 1000.0) if power_w < inf else 1000.0
        return Made(programme=lambda with_peak: Programme(acceleration=found / 2.0, acceleration_unit_mm_s2=2.0))

    problem: Any = Made(task=None, asked=None, under=under, on=Made(count=7))
    monkeypatch.setattr(limit, "least_of", lambda *_: Made(value=1.0))
    monkeypatch.setattr(limit, "tried", lambda made, value, told: Made(value=value, q=value))
    monkeypatch.setattr(limit, "motion_of", lambda on, q: q)
    found: Any = sums._sum_with_masses(problem, sums.PeakWeights(0.01, 4.0), 1e-3)
    exact = 2.0 * sqrt(0.01 * 4000.0 * 4.0)
    assert exact * (1.0 - 5e-3) <= found.value <= exact
    assert (found.places, found.motion) == (7, pytest.approx(2000.0 / sqrt(10.0), rel=1e-2))


@plain_dataclass(frozen=True)
class _Problem:
    asked: Any
    opened: Any

    def under(self, **demands: Any) -> Any:
        self.opened.append(demands)
        return Made(is_open=True)


@pytest.mark.judges("optimum")
@at_once(
    ("rack_deg", "asked_deg", "convex", "eased", "texts"),
    [
        (20.0, 30.0, False, tan(radians(35.0)), ["a pressure angle of 55 deg (of which the rack has 20)"]),
        (0.0, 30.0, True, tan(radians(35.0)), ["a pressure angle of 35 deg", str(refusals.NOT_CONVEX)]),
        (20.0, 70.0, False, 1.0, []),
        (20.0, 30.0, False, inf, []),
    ],
)
def test_a_steeper_angle_is_offered_up_to_where_teeth_push(
    monkeypatch: pytest.MonkeyPatch, rack_deg: float, asked_deg: float, convex: bool, eased: float, texts: list[str]
) -> None:
    tried = list[Any]()
    monkeypatch.setattr(refusals, "_eased", lambda problem, demands, guess: eased)
    asked = Made(
        steepness=tan(radians(asked_deg)),
        tangent_rad=radians(asked_deg),
        rack_angle_rad=radians(rack_deg),
        convex=convex,
    )
    found = refusals._other_curves(_Problem(asked, tried))  # type: ignore[arg-type]
    assert [str(one).replace("55.0001", "55").replace("35.0001", "35") for one in found] == texts
    if asked_deg < 70.0:
        # Without a rack up to a millionth of a radian from a right angle
        assert tried[0]["steepness"] == pytest.approx(tan(radians(90.0 - rack_deg)) if rack_deg else 1e6, rel=1e-6)


@pytest.mark.judges("optimum")
def test_points_of_a_mate_face_the_curve() -> None:
    """Radii of 10, 20 and 30 mm at 50 mm: the mate has 40, 30 and 20, from its axis to the left on."""
    corners = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0]])
    middles = Outline.with_middles.fget(Made(corners=corners))  # type: ignore[attr-defined]
    assert middles.tolist() == [[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [4.0, 1.0], [4.0, 2.0], [2.0, 1.0]]
    fine = np.array([10.0, 20.0, 30.0]), None, np.array([0.0, pi / 2.0, pi])
    found = Rolled.mate_points(Made(_mate_fine=fine, center_distance_mm=50.0))
    assert found == pytest.approx(np.array([[-40.0, 0.0], [0.0, 30.0], [20.0, 0.0]]))


@pytest.mark.judges("dynamics")
def test_energy_of_a_machine_is_that_of_its_shafts_load_and_teeth() -> None:
    """Shafts of 2, 6 and 10 N mm s2 at 3, 5 and 7 rad/s, a load of 100, and teeth that keep 1, 2, 3 and 4 N mm."""
    load = Made(energy_n_mm=lambda angle, speed: 10.0 * angle + speed)
    states = np.array([[9.0], [3.0], [8.0], [20.0], [0.0], [0.0], [0.5], [5.0], [0.5], [7.0]])

    def meshing(kept: Any) -> Any:
        impact = Made(energy_n_mm=lambda depth, stiffness: depth * stiffness)
        return Made(
            impact=impact,
            forces=lambda shafts: Made(depth_mm=np.array([kept]), near=Made(stiffness=np.array([[2.0, 1.0]]))),
        )

    of: Any = Made(
        drive=Made(inertia_n_mm_s2=2.0), load=load, between_n_mm_s2=(6.0, 10.0),
        pairs=lambda states: [(meshing([0.5, 2.0]), None), (meshing([1.5, 4.0]), None)],
    )  # fmt: skip
    kept = 9.0 + 75.0 + 245.0 + 100.0 + (1.0 + 2.0) + (3.0 + 4.0)
    assert ToothedMachine.stored_n_mm(of, states) == pytest.approx([kept])


@pytest.mark.judges("dynamics")
def test_steps_of_a_train_end_at_its_stops_and_at_the_driving_angle(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two shafts that turn evenly; the stops are at each whole 0.4 rad of the last one.

    LSODA may err by a third of the accuracy, of 0.01 rad and of a hundredth of the speed of 2 rad/s at small changes.
    """
    stops, errors = list[float](), list[Any]()
    solver = integrate.LSODA

    def recorded(*given: Any, **how: Any) -> Any:
        errors.append((how["rtol"], *how["atol"]))
        return solver(*given, **how)

    monkeypatch.setattr(integrate, "LSODA", recorded)

    def next_stop(angle: float) -> tuple[float, float]:
        stops.append(angle)
        return 0.4 * (int(angle / 0.4 + 1e-9) + 1), 0.4

    load: Any = Made(next_stop_rad=next_stop)

    def change(now: Any) -> Any:
        return np.array([now[1], 0.0, now[3], 0.0])

    last = 0.0
    for number, step in enumerate(train_steps(change, load, np.array([0.0, 2.0, 0.0, 1.0]), (2.0, 1.9), 1e-6)):
        assert step.shafts[[0, 2]] == pytest.approx([2.0 * step.time_s, step.time_s], abs=1e-9)
        shares = np.sort((step.inner[:, 2] - last) / (step.time_s - last))
        # The outermost of 13 Chebyshev points
        assert shares[[0, -1]] == pytest.approx([sin(pi / 52.0) ** 2, cos(pi / 52.0) ** 2], abs=1e-6)
        assert step.time_s - last <= 0.2 + 1e-9
        last = step.time_s
        if step.shafts[0] >= 1.9 - 1e-9 or number > 99:
            break
    assert last == pytest.approx(0.95)
    assert stops == pytest.approx([0.0, 0.4, 0.8], abs=1e-9)
    assert errors[-1] == pytest.approx((1e-6 / 3.0, *(1e-8 / 3.0, 2e-8 / 3.0) * 2))


@pytest.mark.judges("figures")
@at_once(("share", "idlers", "load", "said"), [
    (True, None, "masses", "the machine with its masses and a jam, at constant driving speed"),
    (False, None, "masses", "the machine with its masses, at constant driving speed"),
    (False, None, "resistance", "the resistance alone: no masses"),
    (True, None, "resistance", "the resistance and a jam: no masses"),
    (False, 2, "resistance", "the torque at the last gear"),
    (False, 2, "jam", "a jam alone"),
])  # fmt: skip
def test_what_loads_the_teeth_is_told(share: bool, idlers: Any, load: str, said: str) -> None:
    linkage = NoLinkage.model_construct()
    drive: Any = Made(conditions=Made(overload=share), design=Made(gears=Made(idlers=idlers), linkage=linkage))
    assert said in strong.load_words(drive, Made(load=load))


@pytest.mark.judges("figures")
@at_once("names", [("C45", "C45"), ("C45", "POM")])
@at_once("given", [None, "some"])
@at_once("hot", [None, 91.4])
def test_materials_are_told_once_where_they_are_the_same(names: Any, given: Any, hot: float | None) -> None:
    made = [Made(material=Made(name=name, too_hot_c=None)) for name in names]
    made[1].material.too_hot_c = hot
    strength: Any = Made(of=lambda gear: made[gear is Gear.DRIVEN], driving=made[0], driven=made[1])
    told = strong.materials_words(Made(gears=Made(material=given)), strength)
    assert told.startswith("C45" if names[0] == names[1] else "C45 on POM")
    assert ("C45 on C45" in told, "assumed" in told) == (False, given is None)
    assert ("the driven gear runs at 91 \u00b0C" in told) is (hot is not None)


@pytest.mark.judges("figures")
def test_shifts_of_teeth_are_told_in_modules_with_their_thickness() -> None:
    """Module 2: a tip of 2.5 mm is 0.5 mm out, 0.25 modules; its tooth pi + 2 x 0.5 tan(20 deg) wide."""

    def flanks(tips: list[float]) -> Any:
        return Made(flanks=Made(has_own_shifts=True, full_tip_mm=np.repeat(tips, 2)))

    rack = Made(addendum_mm=2.0, module_mm=2.0, angles_rad=(radians(20.0),) * 2)
    drive: Any = Made(teeth=Made(driving=flanks([2.5, 1.5]), driven=flanks([2.0])), rack=rack)
    (table,) = sheet.shifted_teeth(drive)
    more = tan(radians(20.0))
    assert [row[0] for row in table.rows] == [1, 2]
    assert table.rows[0][1:] == pytest.approx([0.25, pi + more, 0.0, pi])
    assert table.rows[1][1:3] == pytest.approx([-0.25, pi - more])
    assert table.rows[1][3:] == (None, None)


@pytest.mark.judges("figures")
@at_once("stages", [1, 2])
def test_figures_of_a_motion_in_time_have_their_units(monkeypatch: pytest.MonkeyPatch, stages: int) -> None:
    """From pi to 2 pi rad/s are 30 and 60 r/min; 5000 and 700 N mm of work and of loss are 5 and 0.7 J."""
    quantity = {
        name: Made(ending=ending, factor=factor)
        for name, ending, factor in (("place", "cm", 0.1), ("speed", "mm_s", 1.0), ("acceleration", "mm_s2", 1.0))
    }
    states = np.zeros((6, 3))
    states[1], states[4], states[5] = [pi, 5.0, 2.0 * pi], [0.0, 9.0, 5000.0], [0.0, 9.0, 700.0]
    course = Made(
        states=states, time_s=np.arange(3), energy_error=1e-5, machine=Made(before=[None] * (stages - 1), meshing=None)
    )
    for name, value in (
        ("_names_in_time", lambda *_: {"a": "crank_bearing"}), ("_about", lambda *_: {}), ("extreme", lambda *_: {}),
        ("_pair_in_time", lambda pair, *_: {"pair": pair}), ("_band", lambda of: "band"),
    ):  # fmt: skip
        monkeypatch.setattr(simulated, name, value)
    drive: Any = Made(
        course=course, by_stage=list(range(stages)), check=Made(peak_acceleration_cycle=None),
        linkage=Made(OUTPUT=Made(name="moving slider", **quantity)),
    )  # fmt: skip

    def peak(value: float) -> Any:
        return Made(value=value, phi1_rad=1.0)

    peaks: Any = Made(
        before=[None] * (stages - 1), of_pairs=[None] * stages, displacement_error=peak(3.0), velocity_error=peak(4.0),
        acceleration=peak(5.0), forces_n={"a": peak(6.0)}, most_torque_n_mm=peak(7000.0), least_torque_n_mm=peak(0.0),
    )  # fmt: skip
    found = simulated.dynamic_figures(drive, peaks, [(np.zeros((0, 2)),) * 2] * stages)
    assert found["moving_slider"]["largest_displacement_error_cm"] == pytest.approx(0.3)
    assert found["bearings"] == {"peak_crank_bearing_force_n": 6.0, "peak_crank_bearing_force_at_rad": 1.0}
    told = found["motion_in_time"]
    pairs = {"pair": 0} if stages == 1 else {"pairs": [{"pair": 0}, {"pair": 1}]}
    assert {name: told.pop(name) for name in pairs} == pairs
    assert told == pytest.approx({
        "start_speed_rpm": 30.0, "end_speed_rpm": 60.0, "peak_driving_torque_n_m": 7.0,
        "peak_driving_torque_at_rad": 1.0,
        "least_driving_torque_n_m": 0.0, "least_driving_torque_at_rad": None,
        "work_of_drive_j": 5.0, "loss_of_teeth_j": 0.7,
        "energy_error": 1e-5, "solver_steps": 2,
    })  # fmt: skip


@pytest.mark.judges("figures")
@at_once("stages", [1, 2])
@at_once("level", [Level.QUASI_STATIC, Level.DYNAMIC])
def test_pairs_in_series_are_told_of_a_simulation(monkeypatch: pytest.MonkeyPatch, stages: int, level: Level) -> None:
    """Pairs in series leave no room for the band of stiffness beside their figures."""
    for name, value in (("head_of", lambda drive: ""), ("faults_of", lambda verdict: ())):
        monkeypatch.setattr(told_simulated, name, value)
    design = Made(stages=stages, stages_said=("two pairs", ""), gears=None)
    drive: Any = Made(design=design, linkage=Made(OUTPUT=Made(name="slider")))
    loaded = dict.fromkeys((*told_simulated.IN_BAND, *told_simulated.LOADED), 1.0)
    moved = {**dict.fromkeys(told_simulated.MOVED, 1.0), "peak_driving_torque_n_m": 2.0}
    band = {"softer": {**loaded, "stiffness_factor": 0.8}, "stiffer": {"stiffness_factor": 1.25, "not_followed": "x"}}
    figures = {
        "loaded_contact": loaded, "band_of_stiffness": band, "motion_in_time": moved,
        "slider": {"peak_speed_mm_s": 3.0, "peak_speed_at_rad": 1.0}, "bearings": {},
    }  # fmt: skip
    verdict: Any = Made(good="", not_judged=())
    found = told_simulated.simulated_answer(drive, level, figures, verdict, "d.yaml")
    assert ("teeth of two pairs" in found.about) is (stages == 2)
    assert any("1.25 times their stiffness" in row.texts[0] for row in found.rows)
    if level is Level.QUASI_STATIC:
        assert len(found.heads) == len(found.rows[0].texts) == (3 if stages == 1 else 1)
    else:
        # The output's peak without its place, the teeth, the driving torque and the band
        assert len(found.rows) == 1 + len(told_simulated.MOVED) + 1 + 1
