"""Sweeps without their figures: which designs there are, which are best, what matters, and parts that are kept.

Judges: scipy's own whole sequences, brute force over all pairs, closed forms of a linear function, and files that are
cut off, changed, or of another run.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from errno import ENOSPC
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from drives import DESIGNS
from ncgear.design.reading.design_file import LoadedDesign, load, parsed_mapping
from ncgear.design.space import Listed, Ranged, Space, varied_of
from ncgear.errors import WrongInput
from ncgear.files import sweep_run
from ncgear.files.parts import Parts, alone_in, table_bytes
from ncgear.files.sweep_run import Order, Swept, screening_of, swept
from ncgear.numerics.arrays import Array
from ncgear.numerics.sampled import Functions
from ncgear.screening import designs as designs_module
from ncgear.screening.designs import Block, Designs, joined
from ncgear.screening.overview import _bins, no_overview, rank_correlations
from ncgear.screening.rows import _closes
from ncgear.screening.single import figure_names
from ncgear.screening.wanted import Constraint, Objective, Wanted, best_rows, constraint_of, non_dominated, objective_of

# --- which designs there are


def test_grids_and_lists_are_combined_and_the_last_key_varies_fastest() -> None:
    space = Space((varied_of("a=1:3:3"), varied_of("b=5,-2.5e1")))
    assert space.values(0, space.count).tolist() == [[a, b] for a, b in product((1.0, 2.0, 3.0), (5.0, -25.0))]
    assert space.values(3, 2).tolist() == [[2.0, -25.0], [3.0, 5.0]]


def test_even_values_are_decimals_up_to_their_end() -> None:
    """In binary steps these end at 360.00000000000006, which no key of degrees takes, and zero is 2.2e-16."""
    assert varied_of("a=-169.2:360:4") == Listed("a", (-169.2, 7.2, 183.6, 360.0))
    assert varied_of("a=-1.2:0.4:9") == Listed("a", (-1.2, -1.0, -0.8, -0.6, -0.4, -0.2, 0.0, 0.2, 0.4))


@pytest.mark.parametrize("sampling", ["sobol", "latin-hypercube"])
def test_any_stretch_of_designs_is_that_of_all(sampling: Any) -> None:
    """Stretches begin and end anywhere, and run over the end of the samples, which begin anew for the next list."""
    varied = (Ranged("a", 2.0, 4.0), Listed("b", (1.0, 7.0)), Ranged("c", -1.0, 1.0))
    space = Space(varied, samples=50, sampling=sampling, seed=3)
    every = space.values(0, 100)
    assert every[:, 1].tolist() == [1.0] * 50 + [7.0] * 50
    assert every[:50, ::2].tolist() == every[50:, ::2].tolist()
    for first, count in ((0, 7), (13, 30), (40, 20), (49, 2), (99, 1)):
        assert space.values(first, count).tolist() == every[first : first + count].tolist()
    other = Space(varied, 50, sampling, seed=4).values(0, 100)
    assert other[0, 0] != every[0, 0]


def test_samples_are_those_of_scipy_and_fill_every_layer() -> None:
    from scipy.stats import qmc

    ranges = Ranged("a", 0.0, 1.0), Ranged("b", 0.0, 1.0)
    sobol = Space(ranges, 64, "sobol", 5).values(0, 64)
    assert sobol.tolist() == qmc.Sobol(2, rng=np.random.default_rng(5)).random(64).tolist()
    layers = np.floor(64 * Space(ranges, 64, "latin-hypercube", 5).values(0, 64)).astype(int)
    assert np.sort(layers, axis=0).tolist() == [[n, n] for n in range(64)]


# --- what is wanted


def designs(values: dict[str, Array], figures: dict[str, Array], first: int = 0) -> Designs:
    count = len(next(iter(figures.values())))
    made = ~np.isnan(next(iter(figures.values())))
    verdicts = np.array(["made" if one else f"a: number {n} is wrong" for n, one in enumerate(made)], dtype=object)
    return Designs(np.arange(first, first + count), values, figures, verdicts)


def dominated_by_pairs(costs: Array) -> list[int]:
    """The rows that no other row dominates, and which equal none before, by looking at every pair."""
    stay = []
    for one, row in enumerate(costs):
        dominated = any((other <= row).all() and (other < row).any() for other in costs)
        if not dominated and not any((other == row).all() for other in costs[:one]):
            stay.append(one)
    return stay


@pytest.mark.judges("screening")
@pytest.mark.parametrize("objectives", [1, 2, 3, 4])
def test_the_pareto_set_is_that_of_all_pairs(objectives: int) -> None:
    costs = np.random.default_rng(objectives).integers(0, 9, (60, objectives)).astype(float)
    many = np.random.default_rng(objectives).integers(0, 40, (150, objectives)).astype(float)
    assert non_dominated(many).tolist() == dominated_by_pairs(many)
    assert non_dominated(costs).tolist() == dominated_by_pairs(costs)
    ranked, left = list[int](), list(range(60))
    while left:
        front = [left[row] for row in dominated_by_pairs(costs[left])]
        ranked += sorted(front, key=lambda row: (*costs[row], row))
        left = [row for row in left if row not in front]
    if objectives > 1:
        assert best_rows(costs, 30).tolist() == ranked[:30]
    else:
        assert costs[best_rows(costs, 30), 0].tolist() == sorted(costs[:, 0].tolist())[:30]


@pytest.mark.parametrize("objectives", [2, 3, 4])
def test_a_set_of_which_every_design_is_a_choice_takes_no_square_of_its_number(objectives: int) -> None:
    # Points of a plane of which none is less in all coordinates than another.
    costs = np.random.default_rng(objectives).random((10_000 if objectives < 4 else 1_000, objectives))
    costs[:, -1] = -costs[:, :-1].sum(axis=1)
    assert len(non_dominated(costs)) == len(costs)
    worse = np.concatenate([costs, costs[::7] + 1e-3])
    assert np.array_equal(non_dominated(worse), np.arange(len(costs)))


def test_figures_that_differ_by_rounding_are_no_choice() -> None:
    figures = {"a": np.array([1.0, 1.0 + 1e-12, 2.0]), "b": np.array([5.0, 5.0 - 1e-12, 6.0])}
    wanted = Wanted((), (Objective("a"), Objective("b")))
    assert non_dominated(wanted.costs(designs({}, figures))).tolist() == [0]


def test_what_is_wanted_is_read_and_counts_only_where_it_is_known() -> None:
    names = ["check.peak_power_w", "ratio.min", "ratio.max"]
    assert constraint_of(" peak_power_w<=9e3 ", names) == Constraint("check.peak_power_w", "<=", 9000.0)
    assert objective_of("max:ratio.min", names) == objective_of("-ratio.min", names) == Objective("ratio.min", True)
    known = designs({"k": np.array([1.0, 2.0, 3.0])}, {"ratio.min": np.array([0.1, np.nan, 0.3])})
    assert Constraint("ratio.min", "!=", 7.0).kept(known).tolist() == [True, False, True]
    assert Constraint("k", ">", 1.5).kept(known).tolist() == [False, True, True]
    for wrong in ("ratio.min < 1 and 2", "ratio.min < ratio.max", "ratio.min", "ratio.min = 1", "f(1) < 2", "1 < 2"):
        with pytest.raises(WrongInput, match="--keep-if"):
            constraint_of(wrong, names)


# --- what matters


def linear(count: int) -> tuple[Space, Designs]:
    """y = 3 a + b of evenly spread keys, z = |a|, and w, which is the same but for rounding; a tenth refused."""
    space = Space((Ranged("a", -1.0, 1.0), Ranged("b", -1.0, 1.0)), count)
    values = dict(zip(space.keys, space.values(0, count).T, strict=True))
    a, b = values.values()
    refused = a > 0.8
    figures = {"y": 3.0 * a + b, "z": np.abs(a), "w": 4.0 + 1e-14 * b}
    return space, designs(values, {name: np.where(refused, np.nan, figure) for name, figure in figures.items()})


def overview_of(space: Space, parts: Sequence[Designs]) -> Any:
    overview = no_overview(space, Wanted((), (Objective("y"), Objective("z"), Objective("w"))))
    for part in parts:
        overview = overview.with_part(part)
    return overview


@pytest.mark.judges("screening")
def test_a_linear_function_is_explained_by_its_coefficients() -> None:
    """Without refusals, a key explains c^2 / (sum of c^2), less what varies in a tenth of its range: 1 % of it."""
    space, found = linear(8192)
    a, b = found.values.values()
    whole = designs(found.values, {"y": 3.0 * a + b, "z": np.abs(a), "w": 4.0 + 1e-14 * b})
    overview = overview_of(space, [whole])
    explained = overview.effects.explained
    assert explained[:, 0] == pytest.approx([0.99 * 0.9, 0.99 * 0.1], abs=2e-3)
    assert explained[:, 1] == pytest.approx([0.96, 0.0], abs=2e-3)
    assert np.isnan(explained[:, 2]).all()
    # Of a law that turns, rank correlation sees nothing; that is why both are told.
    assert abs(rank_correlations(overview)[0, 1]) < 0.05
    assert np.isnan(rank_correlations(overview)[:, 2]).all()


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_an_objective_that_varies_by_a_millionth_varies(size: float) -> None:
    """What explains it does not depend on its unit, nor on what stands beside its variation."""
    space, found = linear(8192)
    a, b = found.values.values()
    y = size * (1.0 + 1e-6 * (3.0 * a + b))
    overview = overview_of(space, [designs(found.values, {"y": y, "z": np.abs(a), "w": 4.0 + 1e-14 * b})])
    assert overview.effects.explained[:, 0] == pytest.approx([0.99 * 0.9, 0.99 * 0.1], abs=2e-3)


def test_what_is_gathered_in_parts_is_that_of_the_whole() -> None:
    space, found = linear(6000)
    whole = overview_of(space, [found])
    parts = overview_of(space, [found.at(slice(first, first + 700)) for first in range(0, 6000, 700)])
    assert (
        (parts.count, parts.made, parts.kept) == (whole.count, whole.made, whole.kept) == (6000, whole.made, whole.made)
    )
    assert whole.made == pytest.approx(5400, abs=5)
    assert parts.front.numbers.tolist() == whole.front.numbers.tolist()
    assert [one.numbers.tolist() for one in parts.best] == [one.numbers.tolist() for one in whole.best]
    assert parts.effects.explained == pytest.approx(whole.effects.explained, abs=1e-9, nan_ok=True)
    assert parts.effects.refused_share[0] == pytest.approx([0.0] * 9 + [1.0])
    assert len(parts.drawn.numbers) == 4000
    assert [(one.count, one.verdict) for one in parts.frequent_refusals] == [
        (6000 - whole.made, whole.frequent_refusals[0].verdict)
    ]


def test_refusals_that_differ_in_their_numbers_only_are_one() -> None:
    """A limit in the words tells two refusals of a key apart; an angle of 0 is told without degrees."""
    said = [
        "e: -0.5 given; 0 or over is needed",
        "e: 1.1 given; under 1 is needed",
        "law: it stops at phi1 = 0, there",
        "e: -1e-05 given; 0 or over is needed",
        "law: it stops at phi1 = 5.3 rad (306.5 deg), there",
        "law: it jumps at phi1 = 5.3 rad (306.5 deg), there",
    ]
    found = Designs(np.arange(6), {"a": np.arange(6.0)}, {}, np.array(said))
    overview = no_overview(Space((Listed("a", (0.0, 1.0)),), 6), Wanted((), ()))
    for rows in (slice(3), slice(3, 6)):
        overview = overview.with_part(found.at(rows))
    assert {one.verdict: (one.count, one.values["a"]) for one in overview.frequent_refusals} == {
        said[0]: (2, 0.0),
        said[1]: (1, 1.0),
        said[2]: (2, 2.0),
        said[5]: (1, 5.0),
    }


@pytest.mark.thorough
def test_rank_correlations_are_those_of_scipy() -> None:
    from scipy.stats import spearmanr

    space, found = linear(500)
    rounded = {**found.figures, "z": np.round(found.figures["z"], 1)}
    overview = overview_of(space, [designs(found.values, rounded)])
    drawn = overview.drawn
    expected = [[spearmanr(drawn.values[key], drawn.figures[name])[0] for name in "yz"] for key in "ab"]
    assert rank_correlations(overview)[:, :2] == pytest.approx(np.array(expected), abs=1e-12)


# --- parts


def some(first: int) -> Designs:
    numbers = np.arange(5.0) + first
    return designs({"a": numbers}, {"y": np.where(numbers == 3.0, np.nan, numbers**2)}, first)


def test_a_part_comes_back_as_it_was(tmp_path: Path) -> None:
    parts = Parts(tmp_path / "t.parquet", {"designs": 10}, ("a",))
    assert parts.begun([5, 5]) == [0, 1]
    for part in (1, 0):
        parts.add(part, table_bytes(some(5 * part), parts.digest, part))
    assert parts.begun([5, 5]) == []
    assert {path.name for path in parts.folder.iterdir()} == {"_run.json", "part-000000.parquet", "part-000001.parquet"}
    read, given = joined([parts.designs(0), parts.designs(1)]), joined([some(0), some(5)])
    assert read.numbers.tolist() == given.numbers.tolist()
    assert read.verdicts.tolist() == given.verdicts.tolist()
    np.testing.assert_array_equal(read.figures["y"], given.figures["y"])
    assert table_bytes(some(0), parts.digest, 0) == parts.path(0).read_bytes()


def cut_off(content: bytes) -> bytes:
    return content[: len(content) // 2]


def changed(content: bytes) -> bytes:
    """One bit of a number is another one."""
    place = len(content) // 8
    return content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]


def of_another_run(content: bytes) -> bytes:
    return table_bytes(some(0), "0" * 16, 0)


def short(content: bytes) -> bytes:
    digest = Parts(Path(), {"designs": 10}, ("a",)).digest
    return table_bytes(some(0).at(slice(4)), digest, 0)


@pytest.mark.parametrize("spoil", [cut_off, changed, of_another_run, short, lambda content: b""])
def test_a_damaged_part_is_computed_again(tmp_path: Path, spoil: Any) -> None:
    parts = Parts(tmp_path / "t.parquet", {"designs": 10}, ("a",))
    parts.begun([5, 5])
    for part in (0, 1):
        parts.add(part, table_bytes(some(5 * part), parts.digest, part))
    parts.path(0).write_bytes(spoil(parts.path(0).read_bytes()))
    assert parts.begun([5, 5]) == [0]


def test_parts_that_are_exchanged_are_computed_again(tmp_path: Path) -> None:
    """Each is whole and of this run, but of other designs; one that is exchanged while the run reads it is refused."""
    parts = Parts(tmp_path / "t.parquet", {"designs": 15}, ("a",))
    parts.begun([5, 5, 5])
    for part in range(3):
        parts.add(part, table_bytes(some(5 * part), parts.digest, part))
    one, other = (parts.path(part).read_bytes() for part in (0, 2))
    parts.path(0).write_bytes(other)
    parts.path(2).write_bytes(one)
    assert parts.begun([5, 5, 5]) == [0, 2]
    with pytest.raises(WrongInput, match="has changed while the sweep ran"):
        parts.designs(0)


def test_another_run_in_the_folder_is_refused_with_what_differs(tmp_path: Path) -> None:
    Parts(tmp_path / "t.parquet", {"designs": 10, "seed": 1}, ("a",)).begun([10])
    with pytest.raises(
        WrongInput, match=r"holds another run \(seed 1 there, 2 now\); choose another folder with --out"
    ):
        Parts(tmp_path / "t.parquet", {"designs": 10, "seed": 2}, ("a",)).begun([10])
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "mine.txt").touch()
    with pytest.raises(WrongInput, match="is no folder of a sweep"):
        Parts(tmp_path / "other", {"designs": 10}, ("a",)).begun([10])


def test_two_runs_at_once_in_a_folder_are_refused(tmp_path: Path) -> None:
    Parts(tmp_path, {"designs": 10}, ("a",)).begun([10])
    with (
        alone_in(tmp_path),
        pytest.raises(WrongInput, match="another run is at work here"),
        alone_in(tmp_path),
    ):
        pass


# --- runs, with a screening that costs nothing

TOUCHED: list[int] = []


def screened_block(data: dict[str, Any], keys: Sequence[str], values: Array) -> Block:
    """Designs whose figures are simple functions of v1; every seventh is refused."""
    TOUCHED.append(len(values))
    v1 = values[:, 0]
    made = np.arange(len(v1)) % 7 != 0
    names = figure_names(LOADED.design)
    figures = {name: np.where(made, v1 * (place + 1.0), np.nan) for place, name in enumerate(names)}
    return Block(figures, made, tuple("made" if one else "motion.theta1_rad: is wrong" for one in made))


LOADED: LoadedDesign = load(DESIGNS / "baler.yaml")


@pytest.fixture
def cheap(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(designs_module, "screened_block", screened_block)
    monkeypatch.setattr(sweep_run, "ROWS", 16)
    TOUCHED.clear()


def run(folder: Path, count: int = 100) -> Swept:
    order = Order(Space((Ranged("motion.v1_mm_s", 1500.0, 1700.0),), count))
    screening = screening_of(LOADED.design, LOADED.data, order)
    wanted = Wanted((), (Objective("check.peak_power_w"),))
    return swept(LOADED, order, screening, wanted, folder, lambda *_: None, processes=1)


@at_once("left_out", [(), ("driving_gear_kg_mm2",), ("driven_gear_kg_mm2",), ("masses",)])
def test_a_screening_without_pitch_curves_has_gears_only_where_their_bodies_count(left_out: tuple[str, ...]) -> None:
    gears = {"driving_gear_kg_mm2": 1e6, "driven_gear_kg_mm2": 1e6}
    rod, crank = ({"mass_kg": 9.0, "center_mm": 0.0, "inertia_kg_mm2": 1e5} for _ in range(2))
    given = {"slider_kg": 150.0, "rod": rod, "crank": crank}
    given |= {key: value for key, value in gears.items() if key not in left_out}
    data = {**LOADED.data} if "masses" in left_out else {**LOADED.data, "masses": given}
    order = Order(Space((Ranged("motion.v1_mm_s", 1500.0, 1700.0),), 4), "check")
    screening = screening_of(parsed_mapping(data).design, data, order)
    assert ("gears" in screening.data) == bool({*left_out} & {*gears})


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / "sweep.parquet").iterdir()}


@pytest.mark.thorough
@pytest.mark.usefixtures("cheap")
def test_a_run_goes_on_where_it_was_and_computes_nothing_twice(tmp_path: Path) -> None:
    found = run(tmp_path)
    assert TOUCHED == [16] * 6 + [4]
    whole = contents(tmp_path)
    table = tmp_path / "sweep.parquet"
    (table / "part-000002.parquet").unlink()
    (table / "part-000006.parquet").write_bytes(whole["part-000006.parquet"][:-9])
    (table / ".part-000003.parquet.part").write_bytes(b"what a killed run was writing")
    TOUCHED.clear()
    again = run(tmp_path)
    assert TOUCHED == [16, 4]
    assert contents(tmp_path) == whole
    assert again.screened.made == found.screened.made == 81
    with pytest.raises(WrongInput, match=r"holds another run \(samples 100 there, 101 now; designs 100 there, 101 now"):
        run(tmp_path, 101)


@pytest.mark.usefixtures("cheap")
def test_a_full_disk_ends_a_run_that_goes_on_with_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that takes three files and a half."""
    taken, write = [0], os.write

    def written(handle: int, content: memoryview) -> int:
        taken[0] += 1
        if taken[0] == 4:
            return write(handle, content[: len(content) // 2])
        if taken[0] > 4:
            raise OSError(ENOSPC, os.strerror(ENOSPC))
        return write(handle, content)

    with monkeypatch.context() as full:
        full.setattr(os, "write", written)
        with pytest.raises(WrongInput, match=r"No space left on device\).*the same command goes on$") as refusal:
            run(tmp_path)
    assert refusal.value.exit_status == 2
    assert TOUCHED == [16] * 3
    found = run(tmp_path)
    assert TOUCHED == [16] * 3 + [16] * 4 + [4]
    assert found.screened.made == 81
    assert not list(tmp_path.rglob(".*"))


@pytest.mark.usefixtures("cheap")
def test_rows_are_all_there_once_and_verdicts_spell_keys_as_the_file(tmp_path: Path) -> None:
    run(tmp_path)
    from pyarrow import parquet

    rows = parquet.read_table(tmp_path / "sweep.parquet").to_pylist()
    assert [row["number"] for row in rows] == [*range(100)]
    assert rows[0]["verdict"] == "motion.theta1_pi: is wrong"
    assert rows[0]["check.peak_power_w"] is None
    assert rows[1]["verdict"] == "made"
    plan = json.loads((tmp_path / "sweep.parquet" / "_run.json").read_text())
    assert plan["varied"] == {"motion.v1_mm_s": [1500.0, 1700.0]}


def test_parts_become_larger_with_the_sweep_alone() -> None:
    rows = [sweep_run.rows_of_part(count, sweep_run.ROWS) for count in (1, 10**6, 10**7, 10**9)]
    assert rows == [4096, 4096, 16384, 16384]
    assert sweep_run.rows_of_part(10**5, sweep_run.ROWS_DEEPER) == 128


def test_each_of_a_few_values_has_a_bin_of_its_own() -> None:
    """Whatever their order; a range is parted evenly, with places in the middles."""
    edges, places = _bins(Listed("k", (40.0, 10.0, 20.0)))
    bins = np.searchsorted(edges, [10.0, 14.9, 15.1, 20.0, 29.0, 31.0, 40.0], side="right") - 1
    assert bins.tolist() == [0, 0, 1, 1, 1, 2, 2]
    assert places[:3].tolist() == [10.0, 20.0, 40.0]
    assert np.isnan(places[3:]).all()


def test_rows_without_objectives_are_spread_evenly() -> None:
    assert best_rows(np.zeros((11, 0)), 3).tolist() == [0, 5, 10]
    assert best_rows(np.zeros((4, 0)), 9).tolist() == [0, 1, 2, 3]


def test_a_law_closes_that_turns_once_and_stands_still_nowhere() -> None:
    """Of four laws the first; the others nearly stand on one piece, turn by too little, or stand throughout."""
    count = 24
    there, ratio = np.ones((2, 4), dtype=bool), np.ones((2, count, 4))
    ratio[1, :, 1] = 1e-12
    turning = np.full((2, count, 4), np.pi)
    turning[0, :, 2] *= 0.99
    ratio[:, :, 3] = 0.0
    samples: Any = SimpleNamespace(there=there, turning=turning)
    assert _closes(samples, Functions(ratio)).tolist() == [True, False, False, False]
    there[1, 1] = False
    assert _closes(samples, Functions(ratio))[1]
