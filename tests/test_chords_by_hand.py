"""Chords near a place, reaches of contact, outlines read back, lobes and shafts between pairs, by hand."""

from __future__ import annotations

from itertools import pairwise
from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ncgear.contact.written.as_written as as_written
import ncgear.contact.written.play as play
import ncgear.figures.balance.parts as parts
import ncgear.files.read_back as read_back
import ncgear.pitch.lobed as lobed
import ncgear.project.forces as forces
import ncgear.project.vibration as vibration
import ncgear.screening.batch as batch
import ncgear.teeth.sides as sides
import ncgear.whole_machines.search as search
from at_once import at_once
from ncgear.contact.written.cells import Chords, cells_near, chords_of
from ncgear.design.laws import three_segment_stroke
from ncgear.errors import WrongInput
from ncgear.figures.answers.answer import Row
from ncgear.metrology.exact_outline import ExactOutline
from ncgear.numerics.units import N_PER_KG_MM_S2

Made: Any = SimpleNamespace


@pytest.mark.judges("contact")
def test_a_chord_has_its_middle() -> None:
    chords = Chords(np.array([1.0 + 2j, 3j]), np.array([1.0 + 0j, 0.6 + 0.8j]), np.array([4.0, 5.0]))
    assert chords.half_mm.tolist() == [2.0, 2.5]
    assert chords.middle == pytest.approx([3.0 + 2j, 1.5 + 5j])


@pytest.mark.judges("contact")
@at_once("offset", [0j, -37.0 + 11j])
@at_once(("near_mm", "cell_mm"), [(0.3, 0.5), (1.2, 0.5), (0.2, 1.7)])
def test_cells_name_all_chords_near_a_place_and_few_more(offset: complex, near_mm: float, cell_mm: float) -> None:
    """A long star of 60 corners ; the first and the last chord that a cell names are near it, over the seam too."""
    angle = 2.0 * pi * np.arange(60) / 60.0
    star = (8.0 + 2.0 * np.cos(15.0 * angle)) * np.exp(1j * angle)
    star = offset + 1.6 * star.real + 1j * star.imag
    chords = chords_of(star, 100.0)
    cells = cells_near(chords, near_mm, cell_mm)
    # Places just near enough to corners and middles of chords, places all around, and places far outside
    corners = np.concatenate([star, chords.middle])
    close = corners[:, None] + 0.999 * near_mm * np.exp(1j * pi * np.arange(6) / 3.0)
    x, y = np.meshgrid(np.linspace(-40.0, 40.0, 15), np.linspace(-30.0, 30.0, 15))
    places = np.concatenate([close.ravel(), (x + 1j * y).ravel() + offset])
    cell = cells.cell(places)
    step = np.roll(star, -1) - star
    share = np.clip(((places[:, None] - star) / step).real, 0.0, 1.0)
    away = np.abs(places[:, None] - star - share * step)
    first, beyond = cells.first[cell], cells.beyond[cell]
    named = ((np.arange(60) - first[:, None]) % 60) < (beyond - first)[:, None]
    assert np.all(named[away <= near_mm])
    assert (beyond - first).max() <= 30
    # Within a square of a cell on all sides of what is near a piece's middle; places outside are in the edge's cells
    row = np.flatnonzero((beyond > first) & (away.min(axis=1) < 5.0))
    ends = np.maximum(away[row, first[row] % 60], away[row, (beyond[row] - 1) % 60])
    assert ends.max() <= 1.42 * (near_mm + 3.0 * cell_mm)


@pytest.mark.judges("contact")
def test_tips_of_a_pinion_reach_as_far_as_they_pass_the_rings_tips(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two tips at four positions of half a turn, of which some are beyond the ring's; the pitch point goes along x."""
    tips = np.array([10.0 + 0j, 8j])
    beyond = np.array([[1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])
    monkeypatch.setattr(as_written, "POSITIONS", 4)
    monkeypatch.setattr(as_written, "_tip_curve", lambda gear: tips)
    monkeypatch.setattr(as_written, "passed_mm", lambda *_: beyond)
    lobes = Made(driving_period_rad=pi)
    pitch: Any = Made(
        transmission=Made(lobes=lobes), driving=None, pitch_point_mm=lambda phi1: np.array([9.0, 7.0, 6.0, 5.0])
    )
    turn = np.exp(1j * pi * np.arange(4) / 3.0)
    exact = max(abs(10.0 - 9.0), abs(8j * turn[1] - 7.0), abs(10.0 * turn[2] - 6.0))
    assert as_written.tips_overlap_mm(pitch, Made(driving=None, driven=None)) == pytest.approx(exact)
    beyond[:] = -1.0
    assert as_written.tips_overlap_mm(pitch, Made(driving=None, driven=None)) == 0.0


@pytest.mark.judges("contact")
@at_once(("longest_mm", "reaches"), [(2.0, [2.4, 3.6]), (2.3, [3.6]), (9.0, [3.6])])
def test_vertices_are_followed_farther_where_play_is_still_open(
    monkeypatch: pytest.MonkeyPatch, longest_mm: float, reaches: list[float]
) -> None:
    """Pitches of 6 mm.  Of three open positions one is deep and one not closed after the first reach of 0.4 pitches.

    Chords that are longer than the reach less a twentieth of a pitch hide vertices.
    """
    apart = Made(up_rad=np.zeros(4), down_rad=np.zeros(4), known=np.array([True, False, False, False]))
    asked = list[Any]()
    known = np.array([[1.0, 1.0, np.inf], [2.0, 2.0, 2.0], [0.29, 0.31, 0.0]])

    def block(setting: Any, position: Any) -> Any:
        asked.append((setting, position.tolist()))
        return known[:, position - 1]

    monkeypatch.setattr(play, "REACHES_IN_PITCHES", (0.4, 0.6))
    monkeypatch.setattr(play, "DEEP_IN_PITCHES", 0.05)
    monkeypatch.setattr(play, "apart_play", lambda *_: apart)
    monkeypatch.setattr(play, "_longest_chord_mm", lambda *_: longest_mm)
    monkeypatch.setattr(play, "_setting", lambda facing, placement, reach_mm, followed_mm: followed_mm)
    monkeypatch.setattr(play, "_block_play", block)
    placement: Any = Made(count=4, pitch_mm=6.0)
    found = play.outline_play(Made(driving=None, driven=None), placement, 20.0)
    assert [reach for reach, _ in asked] == pytest.approx(reaches)
    assert [position for _, position in asked] == ([[1, 2, 3], [2, 3]] if len(reaches) == 2 else [[1, 2, 3]])
    assert np.array(tuple(vars(found).values()))[:, 1:] == pytest.approx(known)


@pytest.mark.judges("figures")
def test_what_is_nearest_to_a_natural_frequency_is_told_first(monkeypatch: pytest.MonkeyPatch) -> None:
    def excitation(name: str, ratio: float, near: bool) -> dict[str, Any]:
        return {
            "source": name, "kind": "turns", "frequency_hz": 10.0 * ratio, "nearest_natural_hz": 10.0,
            "ratio": ratio, "near": near,
        }  # fmt: skip

    some = [
        excitation("far", 1.5, False),
        excitation("above", 1.06, True),
        excitation("below", 0.96, True),
        excitation("far below", 0.9, True),
    ]
    shaking = {"max_n": 30.0, "rms_n": 20.0}
    mechanisms = [{"name": "a", "shaking": shaking}, {"name": "b", "shaking": shaking, "even_crank": shaking}]
    monkeypatch.setattr(parts, "ROWS", {"rotor": lambda name: iter([Row(name, ())]), "chassis": None})
    found = parts.balance_answer({"name": "m", "mechanisms": mechanisms, "excitations": some, "rotor": "r"})
    assert [fault.what.partition(",")[0] for fault in found.faults] == ["below", "above", "far below"]
    assert "4.0 % from" in found.faults[0].what
    assert "6.0 % from" in found.faults[1].what
    assert [row.name for row in found.rows] == ["a", "b", "  on an even crank", "r"]
    assert found.head.startswith("m: 2 mechanisms, 4 excitations")
    assert "campbell.png" in found.then


@pytest.mark.judges("files")
@at_once("size", [0.01, 30.0])
@at_once("hole", [False, True])
def test_an_outline_that_is_read_back_has_corners_alone(
    monkeypatch: pytest.MonkeyPatch, size: float, hole: bool
) -> None:
    """A square with a corner twice, a point on an edge and one just beside it, in a larger or about a smaller ring."""
    near, beside = read_back.NEAR * size, 1e-3 * size
    square = np.array([[1.0, 0.0], [1.0, 1.0], [0.5, 1.0], [-1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0], [1.0, -1.0]]) * size
    doubled = np.insert(square, 2, square[1] + [0.0, 0.5 * near], axis=0)
    doubled[-3, 0] -= beside
    kept = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0], [1.0, -1.0]]) * size
    kept[2, 0] -= beside
    turned = np.array([[0.8, 0.6], [-0.6, 0.8]])
    square, doubled, kept = square @ turned, doubled @ turned, kept @ turned
    # A hole runs clockwise; other rings are smaller.
    rings = [0.1 * square, doubled[::-1] if hole else doubled, 0.1 * square[::-1]]
    monkeypatch.setattr(read_back, "mesh_of_stl", lambda data: Made(vertices=None, faces=None))
    monkeypatch.setattr(read_back, "section_rings", lambda vertices, faces, height: rings)
    found = read_back.outline_of_stl(b"", 1.0, hole=hole)
    assert len(found) == len(kept)
    assert np.sort(found @ [1.0, 10.0]) == pytest.approx(np.sort(kept @ [1.0, 10.0]), abs=2.0 * near)


@pytest.mark.judges("metrology")
def test_feet_are_looked_for_on_curves_of_their_own() -> None:
    """The nearest samples of two points, by their curves: 5, 5, 7, 5, 9 and 3, 4, 3, 4, 8."""
    nearest = np.array([[0, 1, 2, 3, 4], [5, 6, 7, 8, 9]])
    rows, shares = np.array([5, 5, 7, 5, 9, 3, 4, 3, 4, 8]), np.arange(10.0) / 10.0
    of: Any = Made(_tree=Made(query=lambda points, k: (None, nearest)), _sampled=(rows, shares))
    row, share = ExactOutline._candidates(of, np.zeros(2, dtype=complex))
    assert row.tolist() == [5, 7, 9, 3, 4, 8]
    assert share == pytest.approx([0.0, 0.2, 0.4, 0.5, 0.6, 0.9])


@pytest.mark.judges("pitch")
@at_once(("text", "said"), [
    ("3.2 - phi + 0*e", "goes from 3.2 to 0.0584.* over a lobe of 1/2 turn"),
    ("2.9 - phi + 0*e", "the radius is -0.24"),
    ("phi - 0.1 + 0*e", "the radius is -0.1 at phi = 0"),
    ("2 + e*sin(2*phi)", None),
])  # fmt: skip
def test_a_formula_is_judged_over_one_lobe(text: str, said: str | None) -> None:
    """Half a turn of two lobes: 3.2 - pi is 0.058."""
    if said is None:
        radius = lobed.formula_family(text, 2, "k")(50.0, 0.3, 2)
        phi = np.array([0.3, 0.3 + pi, 2.9, 9.4 * pi])
        assert radius(phi, 0).value == pytest.approx(50.0 * (2.0 + 0.3 * np.sin(2.0 * phi)))
        return
    with pytest.raises(WrongInput, match=said):
        lobed.formula_family(text, 2, "k")


@pytest.mark.judges("pitch")
def test_a_suns_curve_turns_against_its_planet(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sun of 20 mm that is the rounder the farther, about a planet of 5: it turns by 1/20 + 1/5 rad on each mm."""
    monkeypatch.setattr(lobed, "rolled_curve", lambda gear, mesh, lobes, ends, path, turning: (ends, turning))
    of: Any = Made(
        sun=lambda angle, order: (None, None, Made(value=0.05 + 0.01 * angle)), planet_radius_mm=5.0,
        sun_lobes=3, lobe_rad=2.0 * pi / 3.0,
    )  # fmt: skip
    ends, turning = lobed.LobedCurves.sun_curve.func(of)  # type: ignore[attr-defined]
    assert ends == pytest.approx([0.0, 2.0 * pi / 3.0])
    assert turning(np.array([0.0, 1.0])) == pytest.approx([0.25, 0.24])


@pytest.mark.judges("project")
def test_teeth_pass_by_the_speed_of_their_pitch_curves_over_half_a_module(monkeypatch: pytest.MonkeyPatch) -> None:
    """Curves that roll 0.4 of a distance of 50 mm a rad, at 3 rad/s, on a module of 2; two inertias of 800 kg mm2."""
    asked = Made(
        pair=Made(transmission=Made(driven_angle=lambda phi1, order: Made(differentiated=lambda: None))),
        place=Made(center_distance_mm=50.0, mesh=None, rack_angle_rad=0.3),
        arms_mm=lambda phi1, torque: np.array([[10.0, 20.0]] * phi1.size),
    )
    monkeypatch.setattr(vibration, "asked_of", lambda drive: asked)
    monkeypatch.setattr(
        vibration, "_inertias_of", lambda drive: lambda phi1: (np.full(phi1.size, 800.0), np.full(phi1.size, 800.0))
    )
    monkeypatch.setattr(vibration, "speed", lambda slope, gear, mesh: Made(value=np.full(2, 0.4)))
    monkeypatch.setattr(vibration, "_deviations_mm", lambda *_: None)
    monkeypatch.setattr(vibration, "Vibration", lambda *given: given)
    drive: Any = Made(running=Made(module_mm=2.0), pair_speed_rad_s=lambda phi1: np.full(2, 3.0))
    found: Any = vibration.vibration_of(drive)
    reduced_kg, passing_rad_s, *_ = found
    assert passing_rad_s(np.zeros(2)) == pytest.approx([60.0, 60.0])
    # 1 / (10^2 / 800 + 20^2 / 800)
    assert reduced_kg(np.zeros(2)) == pytest.approx([1.6, 1.6])


@pytest.mark.judges("project")
@at_once(("between", "pairs", "refused"), [
    ((5.0, 0.0), 3, True), ((5.0,), 3, True), ((), 2, True), ((5.0, 6.0), 3, False), ((), 1, False),
])  # fmt: skip
def test_every_shaft_between_pairs_has_an_inertia(
    monkeypatch: pytest.MonkeyPatch, between: Any, pairs: int, refused: bool
) -> None:
    """Each pair swings between the inertias before and after it: 1 N mm s2 on the driving shaft, 9 on the crank."""
    unit = N_PER_KG_MM_S2
    monkeypatch.setattr(forces, "crank_load", lambda *_: None)
    monkeypatch.setattr(forces, "mean_inertia", lambda load: 9.0)
    monkeypatch.setattr(forces, "swinging_inertia", lambda meshing, *ends: ends)
    monkeypatch.setattr(forces, "damped", lambda given, meshing, ends: ends)
    monkeypatch.setattr(forces, "ToothedMachine", lambda *given: given)
    masses, machine = Made(between_inertia_kg_mm2=between), Made(linkage=None, load=None)

    def made() -> Any:
        return forces.toothed_machine(None, Made(inertia_n_mm_s2=1.0), [None] * pairs, masses, machine)  # type: ignore[arg-type,list-item]

    if refused:
        with pytest.raises(WrongInput, match="has no inertia"):
            made()
        return
    _, last, _, before, told = made()
    ends = [1.0, *(unit * each for each in between), 9.0]
    assert [*before, last] == list(pairwise(ends))
    assert told == tuple(ends[1:-1])


@pytest.mark.judges("screening")
def test_strokes_that_may_differ_from_their_mechanism_are_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those that are off by more than half of what is the same stroke, of mechanisms that turn fully."""
    monkeypatch.setattr(batch, "refusals", lambda doubtful, require: doubtful.tolist())
    same = three_segment_stroke.SAME_STROKE
    off = np.array([0.0, 0.45, 0.55, -0.55, 0.55]) * same
    turns = np.array([True, True, True, True, False])
    mechanisms = Made(stroke_mm=np.full(5, 80.0), turns_fully=turns)
    of: Any = Made(given=lambda key: 80.0 * (1.0 + off), mechanisms=mechanisms)
    found: Any = batch.Batch.refused_strokes(of)
    assert found == [False, False, True, True, False]


@pytest.mark.judges("teeth")
def test_neighbouring_chords_of_a_side_make_no_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    """Chords 2 and 4 whose crossing is the point between them, next to each other but for rounding, and a loop."""
    first = np.array([2.5, 2.0 - 1e-12, 1.25, 2.9, 5.95])
    second = np.array([3.9, 3.0, 6.5, 4.2, 7.05])
    asked = list[Any]()

    def exact(paths: Any, row: Any, first: Any, second: Any) -> Any:
        asked.extend(zip(first.tolist(), second.tolist(), strict=True))
        return first, second, np.ones(first.size, dtype=bool)

    monkeypatch.setattr(sides, "chord_crossings", lambda *_: (np.zeros(5, dtype=int), first, second))
    monkeypatch.setattr(sides, "_exact_loops", exact)
    found = sides._loops(Made(points=None, owner=np.zeros(1)))
    # The other loops begin within the first one.
    assert asked == [(1.25, 6.5), (2.9, 4.2), (5.95, 7.05)]
    assert found == [[(1.25, 6.5)]]


@pytest.mark.judges("whole_machines")
@at_once(("stages", "limit", "key"), [(1, 2, "optimize.limits.stages"), (2, 1, "gears.stages"), (1, 1, "gears.helix")])
def test_machines_of_several_pairs_are_not_searched(
    monkeypatch: pytest.MonkeyPatch, stages: int, limit: int, key: str
) -> None:
    monkeypatch.setattr(search, "require", lambda *_: None)
    design: Any = Made(
        gears=Made(mesh="external", helix=1.0), stages=stages, stages_said=("two pairs", "gears.stages"),
        optimize=Made(limits=Made(stages=limit)),
    )  # fmt: skip
    with pytest.raises(WrongInput) as error:
        search.require_offered(design)
    assert error.value.key == key
