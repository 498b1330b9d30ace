"""Designs screened together, against each of them computed by itself: the figures, and which are refused and why."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
import pytest

from drives import drive_of_text, loaded
from ncgear.design.keys.design import Design
from ncgear.errors import DesignError
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.sampled import integrated
from ncgear.screening import rows as figures_module
from ncgear.screening.rows import single_figures
from ncgear.screening.samples import kind_of, sampled
from ncgear.screening.screen import COUNTS, MADE, Screened, computed_together, screened

CHECK_FIGURES = (
    "drive.law_speed_rpm",
    "closure.residual_rad",
    "closure.stroke_residual_mm",
    "ratio.min",
    "ratio.max",
    "check.peak_power_w",
    "check.mean_power_w",
    "check.peak_speed_mm_s",
    "check.peak_acceleration_working_mm_s2",
    "check.peak_acceleration_cycle_mm_s2",
)
"""Keys of ``summary.json`` that every design has."""

PITCH_FIGURES = (
    "pitch.center_distance_mm",
    "pitch.length_driving_mm",
    "pitch.length_driven_mm",
    "pitch.driving_convex",
    "pitch.driven_convex",
    "pitch.min_radius_driving_mm",
    "pitch.min_radius_driven_mm",
    "pitch.max_tangent_angle_deg",
    "pitch.max_pressure_angle_deg",
)
"""Those of designs that say how their gears are; convex is 1 or 0."""

AGREEMENT = 1e-9
"""Relative, of figures screened together and singly; both are exact to rounding, so that 2e-12 is what is found."""

RESIDUALS = ("closure.residual_rad", "closure.stroke_residual_mm")


def data_of(name: str) -> dict[str, Any]:
    return deepcopy(loaded(name).source.document.data)


def stroke_design(random: np.random.Generator) -> Design:
    """A stroke about the baler's, solved for one quantity or another; half of them cannot be made."""
    data = data_of("baler")
    motion = data["motion"]
    angles = np.sort(random.uniform([0.2, 0.4, 0.6, 0.9], [0.6, 1.0, 1.2, 1.6]))
    motion |= {f"theta{number}_pi": float(angle) for number, angle in enumerate(angles, start=1)}
    motion |= {"v1_mm_s": random.uniform(1200.0, 2200.0), "v2_mm_s": random.uniform(600.0, 1600.0)}
    motion |= {"a1_mm_s2": -random.uniform(200.0, 6000.0), "law_speed_rpm": random.uniform(40.0, 70.0)}
    motion["solve_for"] = str(random.choice(["law_speed", "v1", "v2", "a1"]))
    motion.pop({"law_speed": "law_speed_rpm", "a1": "a1_mm_s2"}.get(motion["solve_for"], f"{motion['solve_for']}_mm_s"))
    motion["return"] = {"basis": "ratio", "e": random.uniform(-3.0, 3.0)}
    if random.random() < 0.5:
        del motion["a1_speed_rpm"]
    if random.random() < 0.4:
        del motion["stroke_mm"]
        data["linkage"] = {
            "crank_mm": 380,
            "rod_mm": random.uniform(600.0, 3000.0),
            "offset_mm": random.uniform(-90, 90),
        }
    return Design.model_validate(data)


def together(designs: list[Design], counts: tuple[int, ...] = COUNTS) -> Mask:
    """Which of the designs a batch is sure of."""
    found: dict[int, Any] = {}
    computed_together(designs, counts, found.update)
    sure: Mask = np.isin(np.arange(len(designs)), list(found))
    return sure


def singly(design: Design) -> dict[str, float] | str:
    try:
        return single_figures(design)
    except DesignError as error:
        return str(error)


def disagreement(found: Screened, designs: list[Design]) -> float:
    """Largest of any figure, relative; verdicts must be the same."""
    alone = [singly(design) for design in designs]
    assert found.verdicts == tuple(MADE if isinstance(row, dict) else row for row in alone)
    assert found.made.tolist() == [isinstance(row, dict) for row in alone]
    figures = [row for row in alone if isinstance(row, dict)]
    return max((difference(name, values, figures) for name, values in found.figures.items()), default=0.0)


def difference(name: str, values: Array, figures: list[dict[str, float]]) -> float:
    """Largest of one figure, relative; of residuals, which are rounding errors, absolute."""
    size = 1.0 if name in RESIDUALS else np.where(values == 0.0, 1.0, np.abs(values))
    return float(np.max(np.abs(values - [row[name] for row in figures]) / size))


@pytest.mark.judges("screening")
@pytest.mark.tiers(quick=["baler-drivetrain"], rest="slow")
@pytest.mark.parametrize("name", ["baler", "baler-drivetrain"])
def test_shipped_designs_are_screened_together(name: str) -> None:
    designs = [loaded(name).design] * 2
    found = screened(designs)
    assert together(designs).all()
    assert disagreement(found, designs[:1] * 2) <= AGREEMENT
    assert tuple(found.figures) == CHECK_FIGURES + PITCH_FIGURES


@pytest.mark.slow
@pytest.mark.parametrize(("width_mm", "batch"), [(90.0, True), (0.02, False)])
def test_a_narrow_peak_of_the_resistance_is_not_left_to_a_batch(width_mm: float, batch: bool) -> None:
    """The samples of a batch see nothing of it, and their series is resolved all the same."""
    data = data_of("baler")
    data["resistance"] = {"expression_n": f"500 + 3e3*exp(-((x - 401.77)/{width_mm})**2)"}
    designs = [Design.model_validate(data)]
    assert together(designs).all() == batch
    found = screened(designs)
    assert disagreement(found, designs) <= AGREEMENT
    assert found.figures["check.peak_power_w"][0] > 1000.0


@pytest.mark.slow
def test_no_design_is_made_whose_flanks_push_beyond_a_right_angle() -> None:
    """Of ratios that swing ever more; the angle counts the rack's own, and a rack of less pushes further."""
    texts = [
        "name: swinging\nlinkage: {crank_mm: 40, rod_mm: 150}\noperation: {speed_rpm: 90}\n"
        f"motion: {{law: harmonic_ratio, cosine: [0.05], sine: [0, 0, 0, 0, 0, {swing}]}}\n"
        f"gears: {{teeth: 120, module_mm: 2, face_width_mm: 9, rack: {{pressure_angle_deg: {rack}}}}}\n"
        for swing in (0.2, 0.5, 0.9, 1.3)
        for rack in (15.0, 25.0)
    ]
    designs = [drive_of_text(text).design for text in texts]
    found = screened(designs)
    assert disagreement(found, designs) <= AGREEMENT
    assert 0 < found.made.sum() < len(designs)
    assert (found.figures["pitch.max_pressure_angle_deg"] < 90.0).all()
    steep = [verdict for verdict in found.verdicts if verdict != MADE]
    assert all("the pressure angle reaches" in verdict and "under 90 deg is needed" in verdict for verdict in steep)
    # The steepest made with the smaller rack is refused with the larger one.
    assert found.made.reshape(-1, 2)[:, 0].sum() > found.made.reshape(-1, 2)[:, 1].sum()


def random_strokes(seed: int, count: int) -> list[Design]:
    random = np.random.default_rng(seed)
    return [stroke_design(random) for _ in range(count)]


@pytest.mark.slow
def test_random_strokes_agree_with_single_designs() -> None:
    designs = random_strokes(11, 20)
    found = screened(designs)
    assert disagreement(found, designs) <= AGREEMENT
    assert (found.made & together(designs)).sum() >= 6
    assert (~found.made).sum() >= 4


def harmonic_design(random: np.random.Generator) -> Design:
    """A law of a few harmonics of any strength, some with lobes, some on a linkage with an offset."""
    data = data_of("baler-66")
    strength = random.uniform(0.0, 1.2) / np.arange(1.0, random.integers(2, 7)) ** 1.5
    cosine, sine = (random.normal(0.0, 1.0, strength.size) * strength for _ in range(2))
    data["motion"] = {"law": "harmonic_ratio", "cosine": cosine.tolist(), "sine": sine[1:].tolist()}
    lobes = {"driving": 1, "driven": int(random.choice([1, 1, 2]))}
    data["gears"] = {"teeth": 40, "module_mm": 4, "face_width_mm": 30, "lobes": lobes}
    if random.random() < 0.5:
        data["linkage"] = {
            "crank_mm": 380,
            "rod_mm": random.uniform(600.0, 3000.0),
            "offset_mm": random.choice([0.0, 60.0]),
        }
    return Design.model_validate(data)


def random_harmonics(seed: int, count: int) -> list[Design]:
    random = np.random.default_rng(seed)
    return [harmonic_design(random) for _ in range(count)]


@pytest.mark.slow
def test_random_harmonics_agree_with_single_designs() -> None:
    designs = random_harmonics(1, 15)
    found = screened(designs)
    assert disagreement(found, designs) <= AGREEMENT
    assert (found.made & together(designs)).sum() >= 10


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, *(pytest.param(seed, marks=pytest.mark.long) for seed in (3, 4))])
def test_hundreds_of_random_harmonics_agree_with_single_designs(seed: int) -> None:
    designs = random_harmonics(seed, 100)
    assert disagreement(screened(designs), designs) <= AGREEMENT


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("seed", [2, 3, 4, 5])
def test_hundreds_of_random_strokes_agree_with_single_designs(seed: int) -> None:
    designs = random_strokes(seed, 100)
    assert disagreement(screened(designs), designs) <= AGREEMENT


def test_too_few_points_send_every_design_the_single_way() -> None:
    designs = [loaded(name).design for name in ("baler", "baler-drivetrain")]
    assert not together(designs, counts=(9,)).any()


@pytest.mark.slow
def test_too_few_points_would_not_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the look at the last coefficients, figures would be wrong: the comparison above can fail."""
    monkeypatch.setattr(figures_module, "RESOLVED", np.inf)
    monkeypatch.setattr(figures_module, "CLOSED", np.inf)
    designs = [loaded("baler").design]
    found = screened(designs, counts=(9,))
    assert together(designs, counts=(9,)).all()
    assert disagreement(found, designs) > 1e-6


@pytest.mark.slow
def test_the_order_of_designs_and_their_neighbours_do_not_matter() -> None:
    designs = [*random_strokes(8, 10), *random_harmonics(8, 10)]
    whole, half = screened(designs), screened(designs[::-2])
    mirrored = np.isin(whole.numbers, np.arange(len(designs))[::-2])
    for name in whole.figures:
        assert half.figures[name][::-1] == pytest.approx(whole.figures[name][mirrored], rel=1e-12, abs=1e-12)


@pytest.mark.slow
def test_figures_hold_no_gap() -> None:
    found = screened([*random_strokes(9, 10), *random_harmonics(9, 10)])
    assert all(np.isfinite(values).all() for values in found.figures.values())
    assert all(len(values) == found.made.sum() for values in found.figures.values())


@pytest.mark.slow
def test_teeth_that_do_not_fit_are_refused_as_a_build_refuses_them() -> None:
    data = data_of("baler")
    data["gears"] = {**data["gears"], "center_distance_mm": 80.0}
    design = Design.model_validate(data)
    found = screened([design])
    assert found.verdicts == (singly(design),)
    assert together([design]).all()


RESISTANCES: dict[str, dict[str, Any]] = {
    "kept negative": {"polynomial_n": [-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7], "where_negative": "keep"},
    "expression": {"expression_n": "200 + 3*exp(x/90)"},
    "with a pole": {"expression_n": "1/(x - 100)"},
    "with a corner": {"expression_n": "sqrt((x - 100)^2)"},
    "no expression": {"expression_n": "x +"},
}


@pytest.mark.slow
@pytest.mark.parametrize("resistance", RESISTANCES.values(), ids=RESISTANCES)
def test_resistances_of_other_forms(resistance: dict[str, Any]) -> None:
    designs = [Design.model_validate({**data_of("baler"), "resistance": resistance})]
    assert disagreement(screened(designs), designs) <= AGREEMENT


@pytest.mark.thorough
def test_no_part_at_constant_speed() -> None:
    data = data_of("baler")
    data["motion"] |= {"theta2_pi": 0.9, "theta3_pi": 0.9}
    designs = [Design.model_validate(data)]
    found = screened(designs)
    assert disagreement(found, designs) <= AGREEMENT
    assert together(designs).all()


@pytest.mark.slow
def test_several_lobes_of_the_driving_gear() -> None:
    data = data_of("baler")
    data["gears"] |= {"lobes": {"driving": 2, "driven": 1}, "teeth": 50}
    for number in (1, 2, 3, 4):
        data["motion"][f"theta{number}_pi"] /= 2.0
    designs = [Design.model_validate(data)]
    assert disagreement(screened(designs), designs) <= AGREEMENT


@pytest.mark.tiers(thorough=["internal-1-2"], rest="thorough")
@pytest.mark.parametrize(
    "name", ["ellipse", "feeder-table", "internal-1-2", "baler-66", "baler-66-two-stage", "uniform-crank"]
)
def test_laws_without_a_batch_are_computed_by_themselves(name: str) -> None:
    designs = [loaded(name).design]
    found = screened(designs)
    assert not together(designs).any()
    assert found.made.all()
    assert disagreement(found, designs) == 0.0


@pytest.mark.thorough
def test_designs_without_gears_have_the_figures_of_a_check() -> None:
    data = data_of("baler")
    del data["gears"]
    designs = [Design.model_validate(data)]
    found = screened(designs)
    assert tuple(found.figures) == CHECK_FIGURES
    assert disagreement(found, designs) <= AGREEMENT


def test_no_designs_give_an_empty_table() -> None:
    found = screened([])
    assert found.figures == {}
    assert found.verdicts == ()


@pytest.mark.parametrize("name", ["baler-drivetrain", "baler"])
def test_the_closing_residual_is_taken_at_other_points_than_the_law(name: str) -> None:
    """Where the points of a piece are too few, a law closes at its own points and not at others."""
    design = loaded(name).design
    kind = kind_of(design)
    assert kind is not None
    few, enough = (sampled(kind, [design], count) for count in (7, 129))
    assert abs(float(enough.closing_error_rad[0])) < 1e-12
    assert abs(float(few.closing_error_rad[0])) > 1e-8
    if name == "baler-drivetrain":
        assert abs(float(integrated(few.samples.turning)[0]) - 2.0 * np.pi) < 1e-12
