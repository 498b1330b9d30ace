"""How far teeth reach and spaces go: against polygons read back, circles in closed form, and the middles of lands."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import trimesh

from commands import new_folder
from drives import design_of, drive_of_text, loaded
from ncgear.figures.data_sheet.sheet import sizes
from ncgear.files.build import build
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.teeth.reach import reach_of

Array = np.ndarray

CHORD_MM = 2e-4
NAMES = ["oval-flow-meter", "ellipse", "pump-1-2", "spiral-pair", "internal-1-2", "log-generator", "traced-egg"]


@cache
def finely(name: str) -> Drive:
    """A design with chords so short that its polygons are as good as its curves."""
    data = loaded(name).data
    return Drive(design_of({**data, "output": {"chord_tolerance_mm": CHORD_MM}}))


@pytest.mark.judges("teeth")
@pytest.mark.tiers(slow=["oval-flow-meter-*", "pump-1-2-*"], rest="long")
@pytest.mark.parametrize("gear", Gear)
@pytest.mark.parametrize("name", NAMES)
def test_the_greatest_radius_is_that_of_a_dense_polygon(name: str, gear: Gear) -> None:
    toothed = finely(name).teeth.of(gear)
    reach, radii = reach_of(toothed), np.hypot(*toothed.outline_mm.T)
    assert reach.farthest_mm == pytest.approx(radii.max(), abs=2.0 * CHORD_MM)
    nearest, farthest = reach.tip_mm, reach.root_mm
    if toothed.flanks.curve.is_ring:
        assert (nearest.min(), farthest.max()) == pytest.approx((radii.min(), radii.max()), abs=2.0 * CHORD_MM)
        return
    assert nearest.max() == pytest.approx(radii.max(), abs=2.0 * CHORD_MM)
    if toothed.flanks.made is None:
        assert farthest.min() == pytest.approx(radii.min(), abs=2.0 * CHORD_MM)


@pytest.mark.slow
def test_every_tooth_and_space_is_as_far_as_its_part_of_the_polygon() -> None:
    """Parts of the polygon between the middles of spaces, and between those of teeth, by their polar angles."""
    toothed = finely("oval-flow-meter").teeth.driven
    outline, flanks = toothed.outline_mm @ np.array([1.0, 1j]), toothed.flanks
    middles = (flanks.crossing_mm[1::2] + np.append(flanks.crossing_mm[2::2], flanks.crossing_mm[0])) / 2.0
    middles[-1] += flanks.curve.length_mm / 2.0
    teeth = np.angle(flanks.curve.at_length(flanks.crossing_mm.reshape(-1, 2).mean(axis=1)).position @ [1.0, 1j])
    spaces = np.angle(flanks.curve.at_length(middles).position @ [1.0, 1j])
    reach = reach_of(toothed)
    for number in range(toothed.teeth):
        of_tooth = _between(outline, spaces[number - 1], spaces[number])
        of_space = _between(outline, teeth[number], teeth[(number + 1) % toothed.teeth])
        assert reach.tip_mm[number] == pytest.approx(np.abs(of_tooth).max(), abs=2.0 * CHORD_MM)
        assert reach.root_mm[number] == pytest.approx(np.abs(of_space).min(), abs=2.0 * CHORD_MM)


def _between(points: Array, start_rad: float, end_rad: float) -> Array:
    """Points whose polar angle is between two, which are less than half a turn apart."""
    middle = np.exp(0.5j * (start_rad + end_rad))
    middle *= 1.0 if abs(np.angle(np.exp(1j * start_rad) / middle)) < np.pi / 2.0 else -1.0
    half = abs(np.angle(np.exp(1j * end_rad) / middle))
    return np.asarray(points[np.abs(np.angle(points / middle)) <= half])


@pytest.mark.slow
def test_middles_of_lands_reach_less_far() -> None:
    """The negative control: what is taken in the middle of each land misses the greatest radius by hundredths."""
    toothed = finely("oval-flow-meter").teeth.driving
    at, height = (values.reshape(-1, 2).mean(axis=1) for values in (toothed.sides.tip_mm, toothed.flanks.tip_height_mm))
    middles = np.linalg.norm(toothed.flanks.offset(at, height)[0], axis=1)
    assert reach_of(toothed).farthest_mm - middles.max() > 0.02
    assert reach_of(toothed).farthest_mm == pytest.approx(42.0677, abs=5e-5)


@pytest.mark.tiers(slow=["oval-flow-meter"], rest="long")
@pytest.mark.parametrize("name", ["oval-flow-meter", "helical-ellipse"])
def test_sheet_housing_and_written_solid_have_one_greatest_radius(name: str) -> None:
    data = loaded(name).data
    housing = {"housing": {"clearance_mm": 0.07}} if name == "oval-flow-meter" else {}
    one = Drive(design_of({**data, "gears": {**data["gears"], **housing}}))
    folder = new_folder()
    build(one, folder, lambda step: None)
    rows = {row.label: row for row in sizes(one)}
    for gear in Gear:
        solid = trimesh.load(folder / f"{gear.value}.stl")
        read = float(np.hypot(*np.asarray(solid.vertices).T[:2]).max())
        said = getattr(rows["greatest radius over all"], gear.value)
        assert said == pytest.approx(read, abs=1e-3)
        assert said >= read - 1e-5
        if housing:
            assert getattr(rows["bore of the housing"], gear.value) == pytest.approx(2.0 * (said + 0.07), rel=1e-12)


@pytest.mark.slow
def test_circular_gears_are_as_large_as_their_rack_says() -> None:
    gears = "gears: {teeth: 31, module_mm: 2.5, face_width_mm: 5, profile_shift: {driving: 0.2}}"
    teeth = drive_of_text(
        f"name: round\noperation: {{speed_rpm: 60}}\nmotion: {{law: ratio_expression, ratio: '1'}}\n{gears}\n"
    ).teeth
    for gear, shift in ((teeth.driving, 0.5), (teeth.driven, -0.5)):
        np.testing.assert_allclose(reach_of(gear).tip_mm, 38.75 + 2.5 + shift, rtol=1e-12)
        np.testing.assert_allclose(reach_of(gear).root_mm, 38.75 - 3.125 + shift, rtol=1e-12)
