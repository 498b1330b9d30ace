"""Blocks of designs against each of them computed by itself: the figures, and which are refused and why."""

from __future__ import annotations

import gc
from collections.abc import Callable
from copy import deepcopy
from math import inf, nextafter
from types import FrameType
from typing import Any

import numpy as np
import pytest

from drives import loaded
from ncgear.design.keys.design import Design, design_model
from ncgear.design.space import accepted, checked_design
from ncgear.errors import DesignError, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.numerics.sampled import integrated
from ncgear.screening import designs as block_module
from ncgear.screening import rows as figures_module
from ncgear.screening.batch import Batch, kind_of
from ncgear.screening.designs import MADE, Block, screened_block
from ncgear.screening.samples import Fineness, laws_of
from ncgear.screening.single import single_figures

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
    "pitch.driving_convex",
    "pitch.min_radius_driving_mm",
    "pitch.length_driven_mm",
    "pitch.driven_convex",
    "pitch.min_radius_driven_mm",
    "pitch.max_tangent_angle_deg",
    "pitch.max_pressure_angle_deg",
)
"""Those of designs that say how their gears are; convex is 1 or 0."""

AGREEMENT = 1e-9
"""Relative, of figures screened together and singly; both are exact to rounding, so that 2e-12 is what is found."""

RESIDUALS = ("closure.residual_rad", "closure.stroke_residual_mm")


def data_of(name: str) -> dict[str, Any]:
    """The content of a design file without masses."""
    data = deepcopy(loaded(name).source.document.data)
    return {key: value for key, value in data.items() if key not in ("masses", "drivetrain")}


def singly(data: dict[str, Any], keys: list[str], values: list[float]) -> dict[str, float] | str:
    design = checked_design(data, keys, values)
    try:
        return str(design) if isinstance(design, WrongInput) else single_figures(design)
    except DesignError as error:
        return str(error)


def disagreement(found: Block, data: dict[str, Any], keys: list[str], values: Array, every: int = 1) -> float:
    """Largest of any figure, relative, of residuals, which are rounding errors, absolute; verdicts must be the same."""
    worst = 0.0
    for row in range(0, len(values), every):
        alone = singly(data, keys, values[row].tolist())
        assert found.verdicts[row] == (MADE if isinstance(alone, dict) else alone)
        figures = {name: column[row] for name, column in found.figures.items()}
        assert found.made[row] == isinstance(alone, dict)
        if isinstance(alone, str):
            assert np.isnan(list(figures.values())).all()
            continue
        assert tuple(alone) == tuple(figures)
        for name, value in alone.items():
            size = 1.0 if name in RESIDUALS or value == 0.0 else abs(value)
            worst = max(worst, abs(figures[name] - value) / size)
            assert np.isfinite(figures[name])
    return worst


def in_box(box: dict[str, tuple[float, float]], count: int, seed: int) -> Array:
    random = np.random.default_rng(seed)
    return np.column_stack([random.uniform(low, high, count) for low, high in box.values()])


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch) -> list[Design]:
    """The designs that no batch was sure of."""
    seen: list[Design] = []

    def counted(design: Design) -> dict[str, float]:
        seen.append(design)
        return single_figures(design)

    monkeypatch.setattr(block_module, "single_figures", counted)
    return seen


@pytest.mark.judges("screening")
@pytest.mark.parametrize("name", ["baler", "baler-drivetrain"])
def test_shipped_designs_are_screened_together(name: str, alone: list[Design]) -> None:
    data, keys, values = data_of(name), ["operation.speed_rpm"], np.array([[20.0], [-1.0]])
    found = screened_block(data, keys, values)
    assert not alone
    assert disagreement(found, data, keys, values) <= AGREEMENT
    assert tuple(found.figures) == CHECK_FIGURES + PITCH_FIGURES


def with_masses(name: str, **more: Any) -> dict[str, Any]:
    """The content of a design file whose gears have stated inertias, with weights aslant."""
    gears = {"driving_gear_kg_mm2": 800.0, "driven_gear_kg_mm2": 900.0}
    masses = loaded(name).source.document.data["masses"]
    return {**data_of(name), "masses": {**masses, **gears, "gravity": {"direction_deg": -60.0}, **more}}


MOVED = {"operation.speed_rpm": (5.0, 60.0), "motion.v1_mm_s": (1500.0, 1700.0), "motion.return.e": (-0.3, 0.3)}
WAVED = {"operation.speed_rpm": (5.0, 60.0), "motion.cosine.0": (-0.5, 0.5), "motion.sine.0": (-0.3, 0.3)}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "box"), [("baler-dynamics", MOVED), ("baler-drivetrain", WAVED)])
def test_designs_with_masses_are_screened_together(
    name: str, box: dict[str, tuple[float, float]], alone: list[Design]
) -> None:
    """Batches by Lagrange's equation, single designs by the forces in all joints; the straw sets in within a stroke."""
    data, values = with_masses(name), in_box(box, 6, 5)
    found = screened_block(data, list(box), values)
    assert not alone
    assert disagreement(found, data, list(box), values) <= AGREEMENT
    assert np.ptp(found.figures["check.peak_power_w"] / found.figures["check.peak_power_resistance_w"]) > 0.1


def test_a_rack_on_harmonics_is_screened_alone(alone: list[Design]) -> None:
    """It has no dead centres, and no stroke that may miss its place."""
    data = data_of("baler-drivetrain") | {"linkage": {"kind": "rack_pinion", "radius_mm": 100.0}}
    wishes = ("wishes", "comparison", "fit", "optimize", "simulation")
    data = {key: value for key, value in data.items() if key not in wishes}
    values = np.array([[20.0]])
    found = screened_block(data, ["operation.speed_rpm"], values)
    assert len(alone) == 1
    assert disagreement(found, data, ["operation.speed_rpm"], values) == 0.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "data",
    [
        # The rod is hardly longer than the crank: M bends within a hundredth of a turn, which no table follows.
        with_masses("baler-drivetrain") | {"linkage": {"crank_mm": 380.0, "rod_mm": 380.5}},
        with_masses("baler-drivetrain", driven_gear_kg_mm2=None),
        with_masses("baler-drivetrain") | {"drivetrain": {"guide_friction": 0.1}},
    ],
)
def test_masses_of_which_no_batch_is_sure_are_counted_alone(data: dict[str, Any], alone: list[Design]) -> None:
    screened_block(data, ["operation.speed_rpm"], np.array([[20.0]]))
    assert len(alone) == 1


BORDER = {"motion.theta1_pi": (0.36, 0.42), "motion.theta2_pi": (0.66, 0.74)}
"""About the baler: its slider turns back on the way, or its ratio swings too steeply, in one of twelve."""

WIDE = {
    "motion.theta1_pi": (0.2, 0.6),
    "motion.theta2_pi": (0.4, 1.0),
    "motion.theta3_pi": (0.6, 1.2),
    "motion.theta4_pi": (0.9, 1.7),
    "motion.v1_mm_s": (-10.0, 2200.0),
    "motion.v2_mm_s": (600.0, 1600.0),
    "motion.a1_mm_s2": (-6000.0, 100.0),
    "motion.return.e": (-3.0, 3.0),
}
"""Far from the baler: angles out of order, no law speed, reversals, returns next to a zero of their ratio."""


@pytest.mark.slow
def test_refusals_are_told_by_batches(alone: list[Design]) -> None:
    """Nearly all: what is left to single computations takes a hundred times as long."""
    data, values = data_of("baler"), in_box(BORDER, 300, 3)
    found = screened_block(data, list(BORDER), values)
    assert (~found.made).sum() > 15
    assert len(alone) <= 3
    refused = np.nonzero(~found.made)[0][::8]
    chosen = screened_block(data, list(BORDER), values[refused])
    assert chosen.verdicts == tuple(found.verdicts[row] for row in refused)
    assert disagreement(chosen, data, list(BORDER), values[refused]) == 0.0


@pytest.mark.tiers(slow=["box0-11-120"], rest="long")
@pytest.mark.parametrize(
    ("box", "seed", "count"),
    [
        (BORDER, 11, 120),
        (WIDE, 12, 300),
        *(pytest.param(WIDE, seed, 1500, marks=pytest.mark.long) for seed in (13, 14)),
    ],
)
def test_random_strokes_agree_with_single_designs(box: dict[str, tuple[float, float]], seed: int, count: int) -> None:
    data, values = data_of("baler"), in_box(box, count, seed)
    found = screened_block(data, list(box), values)
    assert disagreement(found, data, list(box), values) <= AGREEMENT
    assert 0.02 * count < found.made.sum() < 0.98 * count


SOLVED: dict[str, tuple[dict[str, Any], dict[str, tuple[float, float]]]] = {
    "v1": (
        {"v1_mm_s": None, "law_speed_rpm": 52.0},
        {"motion.law_speed_rpm": (20.0, 90.0), "motion.theta1_pi": (0.1, 0.7)},
    ),
    "v2": (
        {"v2_mm_s": None, "law_speed_rpm": 52.0},
        {"motion.law_speed_rpm": (20.0, 90.0), "motion.theta1_pi": (0.1, 0.7)},
    ),
    "a1": (
        {"a1_mm_s2": None, "law_speed_rpm": 52.0},
        {"motion.law_speed_rpm": (45.0, 60.0), "motion.theta4_pi": (1.0, 2.1)},
    ),
    "law_speed": ({"a1_speed_rpm": None}, {"motion.a1_mm_s2": (-40000.0, 10.0), "motion.theta1_pi": (0.05, 0.75)}),
}
"""What is solved for: changes of the baler, and keys whose numbers make all its refusals."""


@pytest.mark.slow
@pytest.mark.parametrize("solved", SOLVED)
def test_every_refusal_of_a_stroke_is_that_of_the_single_design(solved: str, alone: list[Design]) -> None:
    changes, box = SOLVED[solved]
    data, values = data_of("baler"), in_box(box, 30, 5)
    data["motion"] = {
        key: one for key, one in {**data["motion"], **changes, "solve_for": solved}.items() if one is not None
    }
    found = screened_block(data, list(box), values)
    assert len(alone) <= 3
    refused = np.nonzero(~found.made)[0]
    assert refused.size >= 5
    for row in refused.tolist():
        assert found.verdicts[row] == singly(data, list(box), values[row].tolist())


MISFITS: dict[str, tuple[dict[str, Any], dict[str, float], str]] = {
    "teeth that do not fit": (
        {"gears": {"center_distance_mm": 74.885}},
        {"gears.center_distance_mm": 80.0},
        "25 teeth",
    ),
    "no whole teeth": (
        {"gears": {"teeth": None, "center_distance_mm": 74.885}},
        {"gears.module_mm": 2.9},
        "module 2.9",
    ),
    "too many teeth": (
        {"gears": {"teeth": None, "center_distance_mm": 74.885}},
        {"gears.module_mm": 75.0 / 25000.0, "gears.center_distance_mm": 74.8852542062},
        "the driving gear has",
    ),
    "a crank that cannot turn": ({}, {"linkage.rod_mm": 300.0}, "the crank cannot turn"),
    "another stroke": ({}, {"linkage.crank_mm": 381.0}, "760 mm is shorter"),
    "no room for a return": ({"gears": {"lobes": {"driving": 2}}}, {"motion.theta1_pi": 0.41}, "theta4 is"),
    "half a tooth": ({}, {"gears.teeth": 24.5}, "24.5 given; a whole number"),
    "angles out of order": ({}, {"motion.theta2_pi": 0.3}, "theta2 must be over theta1"),
    "no number of lobes": (
        {"gears": {"lobes": {"driving": 1}}},
        {"gears.lobes.driving": 0.0},
        "0 given; a number of 1 or over",
    ),
}


@pytest.mark.parametrize(("changes", "numbers", "said"), MISFITS.values(), ids=MISFITS)
def test_each_condition_is_told_as_by_itself(
    changes: dict[str, dict[str, Any]], numbers: dict[str, float], said: str, alone: list[Design]
) -> None:
    data = data_of("baler")
    for group, changed in changes.items():
        data[group] = {key: one for key, one in {**data[group], **changed}.items() if one is not None}
    keys, values = list(numbers), np.array([list(numbers.values())])
    found = screened_block(data, keys, values)
    assert not alone
    assert said in found.verdicts[0]
    assert disagreement(found, data, keys, values) == 0.0


NUMBERS = {
    "baler": [
        "linkage.crank_mm",
        "operation.speed_rpm",
        "motion.v1_mm_s",
        "motion.a1_mm_s2",
        "motion.a1_speed_rpm",
        "motion.stroke_mm",
        "motion.return.e",
        "gears.teeth",
        "gears.module_mm",
    ],
    "baler-drivetrain": ["motion.cosine.0", "motion.sine.3", "gears.teeth"],
}


@pytest.mark.parametrize("name", NUMBERS)
def test_limits_as_arrays_are_those_of_the_models(name: str) -> None:
    """On both sides of every limit, by one rounding error."""
    data = data_of(name)
    limits = [0.0, 1e-6, 3.0, 10.0, -10.0, 1e4, 1e7]
    values = np.array(
        [*limits, *(nextafter(limit, side) for limit in limits for side in (-inf, inf)), 2.5, -7.0, 1e300]
    )
    wrong = 0
    for key in NUMBERS[name]:
        given = accepted(design_model(data), data, key, values)
        one_by_one = [isinstance(checked_design(data, [key], [value]), Design) for value in values.tolist()]
        assert given.tolist() == one_by_one, key
        wrong += len(values) - sum(one_by_one)
    assert wrong > 20


@pytest.mark.slow
def test_keys_that_no_batch_reads_have_designs_of_their_own(alone: list[Design]) -> None:
    """Their values may make another kind, as lobes and a resistance do."""
    keys = ["gears.lobes.driving", "resistance.polynomial_n.0", "motion.v1_mm_s"]
    values = np.array([[1, -131.2779, 1600.0], [1, -100.0, 1610.0], [2, -100.0, 1600.0], [1, -100.0, -5.0]])
    data = data_of("baler")
    data["gears"] |= {"lobes": {"driving": 1}}
    found = screened_block(data, keys, values)
    assert not alone
    assert disagreement(found, data, keys, values) <= AGREEMENT
    assert found.made.tolist() == [True, True, False, False]


@pytest.mark.parametrize(("width_mm", "batch"), [(90.0, True), (0.02, False)])
@pytest.mark.slow
def test_a_narrow_peak_of_the_resistance_is_not_left_to_a_batch(
    width_mm: float, batch: bool, alone: list[Design]
) -> None:
    """The samples of a batch see nothing of it, and their series is resolved all the same."""
    data = data_of("baler")
    data["resistance"] = {"expression_n": f"500 + 3e3*exp(-((x - 401.77)/{width_mm})**2)"}
    keys, values = ["operation.speed_rpm"], np.array([[20.0]])
    found = screened_block(data, keys, values)
    assert (not alone) == batch
    assert disagreement(found, data, keys, values) <= AGREEMENT
    assert found.figures["check.peak_power_w"][0] > 1000.0


def swinging() -> dict[str, Any]:
    return {
        "name": "swinging",
        "linkage": {"crank_mm": 40, "rod_mm": 150},
        "operation": {"speed_rpm": 90},
        "motion": {"law": "harmonic_ratio", "cosine": [0.05, 0.0], "sine": [0, 0, 0, 0, 0, 0.2]},
        "gears": {"teeth": 120, "module_mm": 2, "face_width_mm": 9, "rack": {"pressure_angle_deg": 20.0}},
    }


@pytest.mark.slow
def test_no_design_is_made_whose_flanks_push_beyond_a_right_angle(alone: list[Design]) -> None:
    """Of ratios that swing ever more; the angle counts the rack's own, and a rack of less pushes further."""
    keys = ["motion.sine.5", "gears.rack.pressure_angle_deg"]
    values = np.array([[swing, rack] for swing in (0.2, 0.5, 0.9, 1.3) for rack in (15.0, 25.0)])
    data = swinging()
    found = screened_block(data, keys, values)
    assert len(alone) <= 2
    assert disagreement(found, data, keys, values) <= AGREEMENT
    assert 0 < found.made.sum() < len(values)
    steep = [verdict for verdict in found.verdicts if verdict != MADE]
    assert all("the pressure angle reaches" in verdict and "under 90 deg is needed" in verdict for verdict in steep)
    # The steepest made with the smaller rack is refused with the larger one.
    assert found.made.reshape(-1, 2)[:, 0].sum() > found.made.reshape(-1, 2)[:, 1].sum()


@pytest.mark.slow
def test_a_stroke_too_steep_at_its_start_is_refused_there_only_where_nothing_is_steeper(alone: list[Design]) -> None:
    """Coarse samples are enough for the first design; the return of the second is steeper by a thirtieth."""
    keys = [f"motion.{name}" for name in ("v1_mm_s", "theta1_pi", "theta2_pi", "theta4_pi", "return.e")]
    steeper = [1851.5004217624664, 0.36491423230618236, 0.6372020528651774, 1.113950853794813, 4.737706796033308]
    values = np.array([[1600.0, 0.41, 0.676, 1.3, 0.0], steeper])
    found = screened_block(data_of("baler"), keys, values)
    assert not alone
    assert "deg at phi1 = 0 rad" in found.verdicts[0]
    assert "93.13 deg at phi1 = 3.49958 rad" in found.verdicts[1]
    assert disagreement(found, data_of("baler"), keys, values) == 0.0


HARMONIES = {
    "motion.cosine.0": (-0.9, 0.9),
    "motion.cosine.1": (-0.5, 0.5),
    "motion.sine.5": (-0.2, 0.2),
    "linkage.rod_mm": (30.0, 300.0),
    "gears.teeth": (2.0, 200.0),
}


@pytest.mark.tiers(slow=["1-0.0", "2-0.0"], rest="long")
@pytest.mark.parametrize("offset_mm", [0.0, 12.0])
@pytest.mark.parametrize("lobes", [1, 2])
def test_random_harmonics_agree_with_single_designs(offset_mm: float, lobes: int) -> None:
    data, values = swinging(), in_box(HARMONIES, 40, 2)
    values[:, -1] = np.round(values[:, -1])
    data["linkage"]["offset_mm"] = offset_mm
    data["gears"]["lobes"] = {"driving": 1, "driven": lobes}
    found = screened_block(data, list(HARMONIES), values)
    assert disagreement(found, data, list(HARMONIES), values) <= AGREEMENT
    assert found.made.sum() >= 8


@pytest.mark.slow
def test_too_few_points_send_every_design_the_single_way(monkeypatch: pytest.MonkeyPatch, alone: list[Design]) -> None:
    monkeypatch.setattr(block_module.computed_together, "__defaults__", ((Fineness(9),),))
    for name in ("baler", "baler-drivetrain"):
        assert screened_block(data_of(name), ["operation.speed_rpm"], np.array([[20.0]])).made.all()
    assert len(alone) == 2


@pytest.mark.slow
def test_too_few_points_would_not_agree(monkeypatch: pytest.MonkeyPatch, alone: list[Design]) -> None:
    """Without the look at the last coefficients, figures would be wrong: the comparison above can fail."""
    monkeypatch.setattr(figures_module, "RESOLVED", np.inf)
    monkeypatch.setattr(figures_module, "CLOSED", np.inf)
    monkeypatch.setattr(block_module.computed_together, "__defaults__", ((Fineness(9),),))
    data, keys, values = data_of("baler"), ["operation.speed_rpm"], np.array([[20.0]])
    found = screened_block(data, keys, values)
    assert not alone
    assert disagreement(found, data, keys, values) > 1e-6


def test_rows_and_their_neighbours_do_not_matter() -> None:
    """Neither their order nor the sizes of batches change a digit beyond rounding."""
    data, values = data_of("baler"), in_box(BORDER, 300, 8)
    whole, half = (screened_block(data, list(BORDER), rows) for rows in (values, values[::-2]))
    assert half.verdicts == whole.verdicts[::-2]
    for name, column in whole.figures.items():
        assert half.figures[name] == pytest.approx(column[::-2], rel=1e-12, abs=1e-12, nan_ok=True)


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
    data, keys, values = {**data_of("baler"), "resistance": resistance}, ["operation.speed_rpm"], np.array([[20.0]])
    assert disagreement(screened_block(data, keys, values), data, keys, values) <= AGREEMENT


@pytest.mark.slow
def test_no_part_at_constant_speed(alone: list[Design]) -> None:
    data, keys, values = data_of("baler"), ["motion.theta2_pi", "motion.theta3_pi"], np.array([[0.9, 0.9]])
    found = screened_block(data, keys, values)
    assert not alone
    assert disagreement(found, data, keys, values) <= AGREEMENT


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["ellipse", "feeder-table", "internal-1-2", "baler-66", "baler-66-two-stage", "uniform-crank", "rocker-drive"],
)
def test_laws_without_a_batch_are_computed_by_themselves(name: str, alone: list[Design]) -> None:
    data, keys, values = loaded(name).data, ["operation.speed_rpm"], np.array([[20.0]])
    found = screened_block(data, keys, values)
    assert len(alone) == 1
    assert found.made.all()
    assert disagreement(found, data, keys, values) == 0.0


@pytest.mark.slow
def test_designs_without_gears_have_the_figures_of_a_check(alone: list[Design]) -> None:
    data, keys, values = data_of("baler"), ["operation.speed_rpm"], np.array([[20.0]])
    del data["gears"], data["fit"]
    found = screened_block(data, keys, values)
    assert not alone
    assert tuple(found.figures) == CHECK_FIGURES
    assert disagreement(found, data, keys, values) <= AGREEMENT


def test_designs_that_differ_in_other_keys_keep_their_places(alone: list[Design]) -> None:
    """Those of one face width are computed together, and put back between the others."""
    keys, speeds = ["motion.v1_mm_s", "gears.face_width_mm"], np.linspace(1500.0, 1650.0, 6)
    values = np.column_stack([speeds, [20.0, 9.0, 20.0, 30.0, 9.0, 9.0]])
    found = screened_block(data_of("baler"), keys, values)
    assert not alone
    only = screened_block(data_of("baler"), keys[:1], values[:, :1])
    for name, column in only.figures.items():
        assert found.figures[name] == pytest.approx(column, rel=1e-12, abs=1e-12)


def test_no_designs_give_an_empty_block() -> None:
    found = screened_block(data_of("baler"), list(BORDER), np.empty((0, 2)))
    assert tuple(found.figures) == CHECK_FIGURES + PITCH_FIGURES
    assert found.verdicts == ()


@pytest.mark.parametrize("name", ["baler-drivetrain", "baler"])
def test_the_closing_residual_is_taken_at_other_points_than_the_law(name: str) -> None:
    """Where the points of a piece are too few, a law closes at its own points and not at others."""
    design = loaded(name).design.model_copy(update={"masses": None})
    kind = kind_of(design)
    assert kind is not None
    batch = Batch(kind, (design,), np.zeros(1, dtype=int), {})
    few, enough = (laws_of(batch).sampled(np.zeros(1, dtype=int), Fineness(count)) for count in (7, 129))
    assert abs(float(enough.closing_error_rad[0])) < 1e-12
    assert abs(float(few.closing_error_rad[0])) > 1e-8
    if name == "baler-drivetrain":
        assert abs(float(integrated(few.samples.turning)[0]) - 2.0 * np.pi) < 1e-12


def frames_left_by(function: Callable[[], object]) -> int:
    """How many frames, with all their arrays, only a search for rings of objects would free."""
    # What is there already is not looked through.
    gc.freeze()
    gc.disable()
    gc.set_debug(gc.DEBUG_SAVEALL)
    try:
        function()
        gc.collect()
        return sum(isinstance(one, FrameType) for one in gc.garbage)
    finally:
        gc.set_debug(0)
        gc.garbage.clear()
        gc.enable()


@pytest.mark.tiers(slow=["wide", "border"], rest="quick")
@pytest.mark.parametrize(
    ("box", "refusals"),
    [(BORDER, 2), (WIDE, 5), ({"linkage.crank_mm": (300.0, 1200.0)}, 2)],
    ids=["border", "wide", "crank"],
)
def test_refusals_keep_no_arrays(box: dict[str, tuple[float, float]], refusals: int) -> None:
    """Or a process would grow from block to block, by 37 MB each with 4096 designs at the border."""
    data, values = data_of("baler"), in_box(box, 100, 5)
    told: set[str] = set()
    assert frames_left_by(lambda: told.update(screened_block(data, list(box), values).verdicts)) == 0
    assert len({verdict[:30] for verdict in told - {MADE}}) >= refusals


def test_an_error_kept_where_it_was_caught_is_found() -> None:
    """Negative control."""

    def keeping() -> None:
        kept = []
        try:
            raise DesignError("no such gears")
        except DesignError as error:
            kept.append(error)

    assert frames_left_by(keeping) > 0
