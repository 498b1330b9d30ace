"""`ncgear optimize` as a user meets it: files, exit status, and what is said about a wrong block."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from at_once import at_once
from commands import Run, loaded_by, on_text, python
from ncgear.design.reading.design_file import load
from ncgear.errors import NoSuchMechanism
from ncgear.figures.best_law import not_closed, starts_text
from ncgear.mechanisms.resistance import PolynomialResistance
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.optimum.certified.demands import Demands
from ncgear.optimum.certified.limit import Bound, least_acceleration
from ncgear.optimum.certified.proof import ConicAnswer
from ncgear.optimum.certified.sums import PeakWeights, least_weighted_sum
from ncgear.optimum.certified.tree import Effort
from ncgear.optimum.makeable import law as makeable
from ncgear.optimum.makeable.demanded import start_motion
from ncgear.optimum.makeable.law import MakeableLaw
from ncgear.optimum.makeable.levels import Level
from ncgear.optimum.makeable.search import searched
from ncgear.optimum.task import Task
from ncgear.project.best_law import BestLaw
from ncgear.project.drive import Drive
from published import BALER_LINKAGE

HEAD = """\
# the press of hall 2
name: press
linkage: {crank_mm: 380, rod_mm: 960}   # measured
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
resistance: {polynomial_n: [-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7]}  # of the paper
"""
GEARS = "gears: {teeth: 40, module_mm: 4, face_width_mm: 30}\n"
FEW = "optimize: {knots: 36, limits: {peak_power_w: 12000}}  # as wished\n"


@pytest.fixture
def run(run: Run) -> Run:
    """Optimise d.yaml, which holds the text."""

    return on_text(run, "optimize", "--verbose")


def numbers(value: object) -> Iterator[float]:
    """All numbers of a JSON value."""
    if isinstance(value, dict):
        for part in value.values():
            yield from numbers(part)
    elif isinstance(value, list):
        for part in value:
            yield from numbers(part)
    elif isinstance(value, (int, float)):
        yield float(value)


@pytest.mark.slow
def test_what_is_written(run: Run) -> None:
    """A design that loads and builds its law, comments kept, and a certificate of finite numbers."""
    status, out, err = run(HEAD + FEW)
    assert (status, err) == (0, "")
    folder = Path("export/press-optimized")
    files = ["certificate.json", "frontier.png", "manifest.json", "press-optimized.yaml"]
    assert sorted(path.name for path in folder.iterdir()) == files
    assert all(str(path) in out for path in folder.iterdir())
    text = (folder / "press-optimized.yaml").read_text()
    assert all(comment in text for comment in ("# the press of hall 2", "# measured", "# of the paper", "# as wished"))
    drive = Drive(load(folder / "press-optimized.yaml").design)
    found = json.loads((folder / "certificate.json").read_text())
    assert all(math.isfinite(value) for value in numbers(found))
    assert found["goal"]["gap"] >= 0.0
    assert found["goal"]["law"] == found["law"]["peak_acceleration_mm_s2"] >= found["goal"]["limit"]
    assert found["law"]["peak_power_w"] <= 12_000.0
    assert found["law"]["convex"]
    # What the certificate says is what a check of the written design says, bit for bit.
    assert drive.check.peak_acceleration_cycle.value == found["law"]["peak_acceleration_mm_s2"]
    assert drive.check.peak_power_w.value == found["law"]["peak_power_w"]
    assert found["uniform_crank"] == found["design_as_given"]


@pytest.mark.long
@pytest.mark.slow
def test_the_written_file_gives_the_same_law_again(run: Run) -> None:
    run(HEAD + FEW)
    folder = Path("export/press-optimized")
    text, certificate = (folder / "press-optimized.yaml").read_text(), (folder / "certificate.json").read_text()
    assert run(text)[0] == 0
    assert (folder / "press-optimized.yaml").read_text() == text
    again = json.loads((folder / "certificate.json").read_text())
    assert again["law"] == json.loads(certificate)["law"] == again["design_as_given"]


@pytest.mark.long
@pytest.mark.slow
def test_several_starts_lead_to_one_law_on_any_number_of_processes(run: Run) -> None:
    written = []
    for processes in ("1", "2"):
        status, out, err = run(HEAD + FEW, "--starts", "3", "--processes", processes)
        assert (status, err) == (0, "")
        assert " 3 led to this law" in out
        folder = Path("export/press-optimized")
        written.append([(folder / name).read_bytes() for name in ("press-optimized.yaml", "certificate.json")])
        starts = json.loads(written[-1][1])["starts"]
        assert (starts["count"], starts["without_law"]) == (3, 0)
        assert starts["apart"] < 1e-6
    assert written[0] == written[1]


@pytest.mark.parametrize(
    ("goals", "best", "said"),
    [
        ([5.0, 4.0, None, 6.0], 4.0, "the best of 3 laws, 33.333 % below the worst; from 1 of 4 none was found"),
        ([5.0, None, None, None], 5.0, "1 law; from 3 of 4 none was found"),
        ([5.0, 5.0, 5.0, 5.0], 5.0, "4 led to this law"),
        ([0.0, 0.0, 0.0, 0.0], 0.0, "4 led to this law"),
        ([2.0, 2.0, 0.0, 2.0], 0.0, "the best of 4 laws, 100 % below the worst"),
    ],
)
def test_the_best_law_of_all_starts_is_kept(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, goals: list[float | None], best: float, said: str
) -> None:
    """With laws of goals that are made up: the usual start's first."""
    level = Level("goal", None, 1.0, lambda *_: (), str)

    def law(goal: float | None) -> MakeableLaw | None:
        return None if goal is None else MakeableLaw(np.zeros(3), np.ones(3), [level], np.array([goal]))

    monkeypatch.setattr(makeable, "makeable_law", lambda *_: law(goals[0]))
    monkeypatch.setattr(makeable, "law_from", lambda *given: law(goals[given[-1]]))
    path = tmp_path / "d.yaml"
    path.write_text(HEAD, encoding="utf-8")
    found = BestLaw(load(path).design, starts=4, processes=1)
    assert found.law.goal == best
    assert found.starts.without_law == goals.count(None)
    assert starts_text(found).startswith(said)


@pytest.mark.parametrize(
    ("bound", "said"),
    [
        (Bound(99.5, 120, None), None),
        (Bound(80.0, 120, None, reach=80.5), None),
        (
            Bound(80.0, 120, None),
            "not closed further: that needs one pair with convex pitch curves or a limit of the pressure angle",
        ),
        (
            Bound(90.0, 120, None, effort=Effort(2412, 7, 120, False)),
            "not closed further by 2412 programmes in 7 parts",
        ),
        (
            Bound(98.0, 240, None, effort=Effort(90, 1, 120, True)),
            "as near as 120 places of the crank allow, by 90 programmes in 1 part",
        ),
    ],
)
def test_how_near_the_limit_was_brought_to_the_law_is_said(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, bound: Bound, said: str | None
) -> None:
    """Beside a law of 100, with bounds that are made up."""
    path = tmp_path / "d.yaml"
    path.write_text(HEAD, encoding="utf-8")
    monkeypatch.setattr(BestLaw, "limit", bound)
    monkeypatch.setattr(BestLaw, "goal", 100.0)
    assert not_closed(BestLaw(load(path).design)) == said


@pytest.mark.long
@pytest.mark.slow
def test_starts_are_apart_and_the_same_again() -> None:
    """Ratios of other starts are up to twice and three times the usual ones, and never these themselves."""
    best = BestLaw(load(Path(__file__).parents[1] / "designs" / "baler-66-two-stage.yaml").design)
    search = searched(best.task, best.wishes)
    usual = search.begun(start_motion(best.task, best.wishes, best.bound))
    starts = [search.elsewhere(usual, number) - usual for number in range(1, 9)]
    assert np.array_equal(starts[2], search.elsewhere(usual, 3) - usual)
    factors = np.exp([np.abs(added).max() for added in starts])
    assert 1.2 < factors.min() < factors.max() < 5.0
    apart = [np.abs(one - other).max() for one, other in combinations(starts, 2)]
    assert min(apart) > 0.2


@pytest.mark.slow
def test_without_a_block_the_least_acceleration_is_looked_for(run: Run) -> None:
    status, out, _ = run(HEAD)
    assert status == 0
    assert out.startswith("press: least acceleration at 60 r/min")


@pytest.mark.slow
def test_a_long_name_stays_a_name(run: Run) -> None:
    name = "x" * 64
    assert run(HEAD.replace("name: press", f"name: {name}") + FEW)[0] == 0
    (written,) = Path("export").glob("*/*.yaml")
    assert load(written).design.name == written.stem == written.parent.name
    assert written.stem.endswith("-optimized")


@pytest.mark.slow
def test_points_of_another_file_come_along(run: Run, tmp_path: Path) -> None:
    """The written design stands in another folder, where the file of points is not."""
    Path(tmp_path, "force.csv").write_text("displacement_mm,force_n\n0,0\n300,1000\n760,20000\n")
    lines = [line for line in HEAD.splitlines() if not line.startswith("resistance")]
    text = "\n".join([*lines, "resistance: {table: {file: force.csv}}", "optimize: {knots: 24}", ""])
    assert run(text)[0] == 0
    design = load(Path("export/press-optimized/press-optimized.yaml")).design
    assert design.resistance is not None
    assert design.resistance.table is not None
    assert design.resistance.table.force_n == (0.0, 1000.0, 20000.0)


def test_output_folder_is_a_file(run: Run, tmp_path: Path) -> None:
    Path(tmp_path, "taken").write_text("")
    status, out, err = run(HEAD + FEW, "--out", "taken")
    assert (status, out) == (2, "")
    assert "taken: is no folder" in err


WITHOUT_SOLVER = """
import sys
sys.modules["casadi"] = None  # no import of it succeeds any more, and it is not found
import ncgear.cli
sys.argv = ["ncgear", *{arguments}]
ncgear.cli.main()
"""


@pytest.mark.tiers(slow=["optimize"], rest="long")
@pytest.mark.parametrize("command", ["optimize", "frontier"])
def test_a_missing_solver_is_named_with_the_command(command: str, tmp_path: Path) -> None:
    """In a process of its own, since what this one has already imported would hide an import made too early."""
    Path(tmp_path, "d.yaml").write_text(HEAD + FEW)
    done = python("-c", WITHOUT_SOLVER.format(arguments=[command, "d.yaml"]), folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"ncgear {command}: needs casadi" in done.stderr
    assert "python -m pip install 'ncgear[optimize]'" in done.stderr
    assert not list(Path(tmp_path, "export").glob("*/*"))


@pytest.mark.tiers(
    slow=[
        "peak_power_w: 3000-3-d.yaml:8:32: optimize.limits.peak_power_w: 3000 W is too little",
        "peak_power_w: 9000, peak_acceleration_mm_s2: 9000-3-optimize.limits.peak_acceleration_mm_s2: 9000 mm/s",
        "driven_speed_rpm: 61, peak_power_w: 12000-3-12000 W is too little at any acceleration; at least",
    ],
    rest="long",
)
@pytest.mark.parametrize(
    ("limits", "status", "said"),
    [
        ("peak_power_w: 3000", 3, "d.yaml:8:32: optimize.limits.peak_power_w: 3000 W is too little"),
        ("ratio_min: 1.0, ratio_max: 1.0", 2, "optimize.limits.ratio_max: 1 given; a ratio over ratio_min"),
        ("peak_power_w: 9000, peak_acceleration_mm_s2: 9000", 3, "optimize.limits.peak_acceleration_mm_s2: 9000 mm/s"),
        ("driven_speed_rpm: 60", 3, "optimize.limits.driven_speed_rpm: 60 r/min leaves nothing to choose"),
        ("driven_speed_rpm: 61, peak_power_w: 12000", 3, "12000 W is too little at any acceleration; at least"),
    ],
)
def test_what_cannot_be_is_said_at_its_line(run: Run, limits: str, status: int, said: str) -> None:
    got, out, err = run(f"{HEAD}\noptimize: {{knots: 24, limits: {{{limits}}}}}\n")
    assert (got, out) == (status, "")
    assert err.startswith("d.yaml:8:")
    assert said in err
    assert not Path("export").exists()


WRONG: dict[str, tuple[str, str, str]] = {
    "weights without weighted": ("weights: {acceleration_mm_s2: 1, power_w: 1}", "weights", "leave weights out"),
    "weighted without weights": ("goal: weighted", "weights", "missing; give it: a weighted goal"),
    "zero weight": (
        "goal: weighted, weights: {acceleration_mm_s2: 0, power_w: 1}",
        "weights.acceleration_mm_s2",
        "over 0",
    ),
    "endless weight": (
        "goal: weighted, weights: {acceleration_mm_s2: 1.0e-320, power_w: 1}",
        "weights.acceleration_mm_s2",
        "a positive number is needed",
    ),
    "one weight": ("goal: weighted, weights: {braking_power_w: 900}", "weights", "two or more figures"),
    "tooth force without gears": ("limits: {tooth_force_n: 9000}", "limits.tooth_force_n", "give gears.teeth and"),
    "no flywheel": ("limits: {flywheel_kg_mm2: 0}", "limits.flywheel_kg_mm2", "a number over 0"),
    "unknown goal": ("goal: least_noise", "goal", "'least_noise' given"),
    "pressure angle of the rack": ("limits: {pressure_angle_deg: 20}", "limits.pressure_angle_deg", "the rack alone"),
    "radius without sizes": ("limits: {least_radius_mm: 10}", "limits.least_radius_mm", "gears.teeth and"),
    "undercut without teeth": ("limits: {free_of_undercut: true}", "limits.free_of_undercut", "give gears.teeth"),
    "high ratio_min": ("limits: {ratio_min: 1.5}", "limits.ratio_min", "1.5 given; a number of 1 or under"),
    "ratio_min of zero": ("limits: {ratio_min: 0}", "limits.ratio_min", "a number of 0.01 or over"),
    "low ratio_max": ("limits: {ratio_max: 0.5}", "limits.ratio_max", "a number of 1 or over"),
    "negative power": ("limits: {peak_power_w: -1}", "limits.peak_power_w", "a number over 0"),
    "misspelt limit": ("limits: {peak_power: 1}", "limits.peak_power", "did you mean peak_power_w?"),
    "few knots": ("knots: 11", "knots", "a number of 12 or over"),
    "many knots": ("knots: 721", "knots", "a number of 720 or under"),
    "a second mass": ("slider_mass_kg: 12", "slider_mass_kg", "unknown key"),
}


MASSES = """\
masses:
  slider_kg: 80
  rod: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}
  crank: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}
"""


@pytest.mark.long
@pytest.mark.slow
def test_the_power_of_limit_law_and_comparison_counts_the_mass_of_the_slider(run: Run) -> None:
    """One mass for every command; the power is the greatest of (F + m a) v over the whole cycle, sampled anew."""
    status, out, _ = run(HEAD + MASSES + "optimize: {goal: least_power, knots: 36}\n")
    assert status == 0
    assert "the slider has 80 kg" in out
    found = json.loads(Path("export/press-optimized/certificate.json").read_text())
    assert found["masses"]["slider_kg"] == 80.0
    written = Drive(load(Path("export/press-optimized/press-optimized.yaml")).design)
    uniform = Drive(load(Path("d.yaml")).design)
    for drive, told in ((written, found["law"]), (uniform, found["uniform_crank"])):
        motion = drive.machine.motion(np.linspace(0.0, 2.0 * np.pi, 40_001))
        force = motion.load + 80.0 * motion.acceleration / 1000.0
        assert told["peak_power_w"] == pytest.approx(np.max(force * motion.velocity) / 1000.0, rel=1e-6)
    assert found["law"]["peak_power_w"] == found["goal"]["law"] > found["goal"]["limit"]


@pytest.mark.tiers(
    slow=[
        "{law: table, phi1_deg: [0, 90, 180, 270], displacement_mm: [0, 370, 760, 390]}-the displacements of the table"
    ],
    rest="long",
)
@pytest.mark.parametrize(
    ("motion", "lost"),
    [
        ("{law: uniform_crank}", ""),
        (
            "{law: table, phi1_deg: [0, 90, 180, 270], displacement_mm: [0, 370, 760, 390]}",
            "the displacements of the table",
        ),
        (
            "{law: three_segment_stroke, solve_for: law_speed, theta1_pi: 0.4, theta2_pi: 0.6, theta3_pi: 0.95, "
            "theta4_pi: 1.3, v1_mm_s: 1500, v2_mm_s: 1100, a1_mm_s2: -1500, a1_speed_rpm: 20}",
            "the constant speed v2 from theta2 to theta3 (108 to 171 deg)",
        ),
    ],
)
def test_what_the_law_does_not_keep_of_the_given_motion_is_said(run: Run, motion: str, lost: str) -> None:
    status, out, err = run(HEAD.replace("{law: uniform_crank}", motion) + "optimize: {knots: 24}\n")
    assert (status, err) == (0, "")
    assert lost in " ".join(out.split())
    certificate = json.loads(Path("export/press-optimized/certificate.json").read_text())
    assert certificate["not_kept"] == lost


@at_once(("block", "key", "said"), WRONG.values())
def test_wrong_blocks_are_refused_at_their_line(run: Run, block: str, key: str, said: str) -> None:
    status, out, err = run(f"{HEAD}\noptimize: {{{block}}}\n")
    assert (status, out) == (2, "")
    assert err.startswith("d.yaml:8:")
    assert f": optimize.{key}" in err
    assert said in err.splitlines()[0]
    assert not Path("export").exists()


@pytest.mark.parametrize(
    ("gears", "limits", "key", "said"),
    [
        ("teeth: 40, module_mm: 4", "least_radius_mm: 80", "limits.least_radius_mm", "under 80 mm is right"),
        ("teeth: 12, module_mm: 4", "free_of_undercut: true", "limits.free_of_undercut", "undercut even on a circle"),
        (
            "teeth: 40, module_mm: 4, rack: {pressure_angle_deg: 25}",
            "pressure_angle_deg: 24",
            "limits.pressure_angle_deg",
            "the rack alone has 25",
        ),
    ],
)
def test_what_no_gears_can_keep_is_refused(run: Run, gears: str, limits: str, key: str, said: str) -> None:
    status, _, err = run(f"{HEAD}gears: {{{gears}, face_width_mm: 9}}\noptimize: {{limits: {{{limits}}}}}\n")
    assert status == 2
    assert f"d.yaml:8:{err.split(':')[2]}: optimize.{key}: " in err
    assert said in err


@pytest.mark.slow
def test_a_pressure_angle_counts_the_rack(run: Run) -> None:
    block = "optimize: {knots: 180, limits: {pressure_angle_deg: 27}}\n"
    assert run(HEAD + GEARS + block)[0] == 0
    found = json.loads(Path("export/press-optimized/certificate.json").read_text())
    assert found["law"]["tangent_deg"] == pytest.approx(7.0, abs=1e-3)
    assert found["law"]["tangent_deg"] <= 7.0


@pytest.mark.slow
def test_an_optimisation_loads_no_meshes(tmp_path: Path) -> None:
    Path(tmp_path, "d.yaml").write_text(HEAD + "optimize: {knots: 24}\n")
    assert loaded_by("optimize", "d.yaml", folder=tmp_path) & {"trimesh", "casadi"} == {"casadi"}


@pytest.mark.slow
def test_a_check_and_help_load_no_solver(tmp_path: Path) -> None:
    Path(tmp_path, "d.yaml").write_text(HEAD + FEW)
    assert "casadi" not in loaded_by("check", "d.yaml", folder=tmp_path)
    assert loaded_by("optimize", "--help") & {"casadi", "numpy"} == set()


@pytest.mark.long
@pytest.mark.slow
def test_an_improvement_is_computed_once_and_knots_count(tmp_path: Path) -> None:
    """Twice the knots are never worse, and what is asked for twice is the same."""
    path = Path(tmp_path, "d.yaml")
    path.write_text(HEAD + FEW)
    one = BestLaw(load(path).design)
    assert one.law is one.law
    path.write_text(HEAD + FEW.replace("knots: 36", "knots: 72"))
    two = BestLaw(load(path).design)
    assert two.goal <= one.goal * (1.0 + 1e-12)


@at_once("goal", ["least_acceleration", "least_power", "weighted"])
@at_once(("limit", "side"), [("ratio_min", "under 1"), ("ratio_max", "over 1")])
def test_a_limit_at_the_mean_ratio_leaves_no_law_to_search(run: Run, goal: str, limit: str, side: str) -> None:
    weights = ", weights: {acceleration_mm_s2: 900, power_w: 70}" if goal == "weighted" else ""
    status, out, err = run(f"{HEAD}optimize: {{goal: {goal}{weights}, limits: {{{limit}: 1.0}}}}\n")
    assert (status, out) == (3, "")
    assert f"optimize.limits.{limit}: 1 leaves nothing to choose" in err
    assert f"{side} is right" in err


@pytest.mark.slow
def test_limits_that_no_programme_can_keep_are_refused_by_what_was_given(monkeypatch: pytest.MonkeyPatch) -> None:
    """No peak is named that nobody gave."""
    task = Task(BALER_LINKAGE, SliderLoad(PolynomialResistance((50.0,))), 3.0)
    asked = Demands(0.8, 1.3)
    assert least_acceleration(task, asked).value > 0.0
    for module in ("limit", "problem"):
        monkeypatch.setattr(f"ncgear.optimum.certified.{module}.least", lambda *_: ConicAnswer(math.inf, None))
    for sought in (
        lambda: least_acceleration(task, asked),
        lambda: least_weighted_sum(task, asked, PeakWeights(1e-3, 1e-2)),
    ):
        with pytest.raises(NoSuchMechanism, match="no law keeps the limits of ratio and curves") as refused:
            sought()
        assert refused.value.key == "optimize.limits"
