"""Teeth in the middle of the thickness that a file allows: written outlines, play and contact over the band.

Judges: pins that shapely lays into outlines read back by ezdxf and trimesh, or from the text of XML and Part 21, gears
that shapely turns until they meet, and the same designs without a deviation.
"""

from __future__ import annotations

import json
import re
from functools import cache
from importlib.util import find_spec
from math import cos, radians
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from zipfile import ZipFile

import ezdxf
import numpy as np
import pytest
import trimesh
from ezdxf import path as paths
from shapely import Polygon, affinity

from commands import new_folder
from drives import design_of, loaded
from ncgear.errors import WrongInput
from ncgear.figures.advice.machine_advice import made
from ncgear.figures.advice.values import Advice
from ncgear.files.build import build
from ncgear.files.workshop.formats import Format
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.teeth.gear import toothed_pair
from oracles.part21 import Part21
from oracles.pins import over_pins

Array = np.ndarray

BANDS = {
    "ellipse": (-0.09, -0.03),
    "pump-1-2": (-0.12, -0.06),
    "internal-1-2": (-0.1, -0.04),
    "rounded-square": (-0.2, -0.08),
    "asymmetric-ellipse": (-0.07, -0.02),
    "pusher": (-0.11, -0.04),
}
"""Lower and upper deviation of the tooth thickness that designs are given."""

CHORD_MM = 0.001


def changed(name: str, band: tuple[float, float] | None, **gears: Any) -> Drive:
    """A design of designs/ with a band of thickness, and chords that a reading over pins hardly shows."""
    data = loaded(name).data
    limits = {} if band is None else {"tooth_thickness_lower_mm": band[0], "tooth_thickness_upper_mm": band[1]}
    own = {**data["gears"], "tolerances": limits, **gears}
    return Drive(design_of({**data, "gears": own, "output": {"chord_tolerance_mm": CHORD_MM}}))


SOLIDS = (Format.THREEMF, Format.GLB, *([Format.STEP] if find_spec("OCP") else []))
"""Kinds of solids beside STL, as far as this installation writes them."""


@cache
def written(name: str, *, nominal: bool = False) -> Path:
    """The folder of a design as a user builds it, with its band or without a deviation."""
    folder = new_folder()
    build(changed(name, None if nominal else BANDS[name]), folder, lambda step: None, [Format.DXF, *SOLIDS])
    return folder


def read_dxf(folder: Path, gear: str) -> Array:
    """The tooth outline of a gear's DXF file, its arcs in short chords."""
    (line,) = ezdxf.readfile(folder / f"{gear}.dxf").modelspace().query("LWPOLYLINE[layer=='OUTLINE']")
    points = np.array([[at.x, at.y] for at in paths.make_path(line).flattening(1e-4)])
    return points[:-1] if np.allclose(points[0], points[-1]) else points


def middle(solid: trimesh.Trimesh) -> Array:
    """The tooth outline of an upright solid 2.5 mm above its lower end."""
    section = solid.section(plane_origin=[0.0, 0.0, 2.5], plane_normal=[0.0, 0.0, 1.0])
    rings = [np.asarray(ring)[:-1, :2] for ring in section.discrete]
    return max(rings, key=len)


def read_stl(folder: Path, gear: str) -> Array:
    return middle(trimesh.load(folder / f"{gear}.stl"))


def read_3mf(folder: Path, gear: str) -> Array:
    """The gear of the assembled print in its own frame, by the numbers that its XML holds."""
    root = ElementTree.fromstring(ZipFile(folder / "pair.3mf").read("3D/3dmodel.model"))
    assert root.get("unit") == "millimeter"
    (place,) = (one for one in root.findall(".//{*}item") if one.get("partnumber") == gear)
    (part,) = (one for one in root.findall(".//{*}object") if one.get("id") == place.get("objectid"))
    turned = (place.get("transform") or "1 0 0 0 1 0 0 0 1 0 0 0").split()[:9]
    assert [float(one) for one in turned] == np.eye(3).ravel().tolist()
    points = [[float(one.get(axis)) for axis in "xyz"] for one in part.findall(".//{*}vertex")]
    triangles = [[int(one.get(f"v{corner}")) for corner in (1, 2, 3)] for one in part.findall(".//{*}triangle")]
    return middle(trimesh.Trimesh(points, triangles))


def read_glb(folder: Path, gear: str) -> Array:
    """The gear of the scene, which has metres and y upwards, in its own frame."""
    distance = json.loads((folder / "summary.json").read_text())["pitch"]["center_distance_mm"]
    scene = trimesh.load(folder / "pair.glb")
    place, geometry = scene.graph[gear]
    x, y, z = 1000.0 * trimesh.transform_points(scene.geometry[geometry].vertices, place).T
    points = np.column_stack([x - (distance if gear == "driven" else 0.0), -z, y])
    return middle(trimesh.Trimesh(points, scene.geometry[geometry].faces))


def read_step(folder: Path, gear: str) -> Array:
    """The loop of most points of the lower end of the gear's STEP file."""
    file = Part21((folder / f"{gear}.step").read_bytes())
    (solid,) = file.of("MANIFOLD_SOLID_BREP")
    flat = [face for face in file.faces(solid) if file.surface(face).name == "PLANE"]
    (end,) = (face for face in flat if file.height(file.surface(face)) == 0.0)
    ring = max(file.loops(end, 33), key=len)[:, :2]
    return ring[np.append(True, np.abs(np.diff(ring, axis=0)).max(axis=1) > 1e-9)]


def read_csv(folder: Path, gear: str) -> Array:
    return np.loadtxt(folder / f"{gear}.csv", delimiter=",", skiprows=1)


READERS = {"dxf": read_dxf, "stl": read_stl, "csv": read_csv}

SOLID_READERS = {Format.THREEMF: read_3mf, Format.GLB: read_glb, Format.STEP: read_step}


def rows_of(sheet: str, title: str) -> Array:
    """The numbers of a table of the data sheet, by the beginning of its title."""
    lines = sheet.partition(f"## {title}")[2].partition("\n## ")[0].splitlines()
    return np.array([[float(cell) for cell in line.split("|")[1:-1]] for line in lines if re.match(r"\| \d", line)])


def told(folder: Path, gear: str) -> tuple[float, dict[int, Array], Array]:
    """What the sheet says: the pins' diameter, where they lie, and spaces, reading and limits of all pairs."""
    sheet = (folder / "data_sheet.md").read_text()
    (diameter,) = re.findall(rf"## Pins of (\S+) mm in the {gear} gear", sheet)
    places = {int(row[0]): row[1:3] for row in rows_of(sheet, f"Pins of {diameter} mm in the {gear} gear")}
    word = "between" if "## Measurement between" in sheet and gear == "driven" else "over"
    return float(diameter), places, rows_of(sheet, f"Measurement {word} two pins of {diameter} mm, {gear} gear")


def off_the_middle(folder: Path, gear: str, outline: Array, *, ring: bool) -> Array:
    """Readings over pins of an outline at all places of a sheet, from the middle of its band, in half widths of it."""
    diameter, places, rows = told(folder, gear)
    one, other = (np.array([places[int(space)] for space in rows[:, column]]) for column in (0, 1))
    read, (low, high) = over_pins(outline, diameter, one, other, ring=ring), rows[:, 3:5].T
    return np.asarray((read - (low + high) / 2.0) / ((high - low) / 2.0))


@pytest.mark.judges("files")
@pytest.mark.tiers(slow=["ellipse-*"], rest="long")
@pytest.mark.parametrize("gear", ["driving", "driven"])
@pytest.mark.parametrize("name", [name for name in BANDS if name != "asymmetric-ellipse"])
def test_written_outlines_lie_in_the_middle_of_the_sheets_band(name: str, gear: str) -> None:
    folder, ring = written(name), name.startswith("internal") and gear == "driven"
    assert len(told(folder, gear)[2]) > 5
    for read in (*READERS.values(), *(SOLID_READERS[kind] for kind in SOLIDS)):
        assert np.abs(off_the_middle(folder, gear, read(folder, gear), ring=ring)).max() < 0.15
    # The negative control: teeth without the deviation are outside everywhere.
    nominal = off_the_middle(folder, gear, read_csv(written(name, nominal=True), gear), ring=ring)
    assert np.abs(nominal).min() > 1.0


def with_chords(band: tuple[float, float], chord_mm: float | None, module_mm: float = 3.5) -> Drive:
    """The ellipse with a band, of another module, and with chords that are left out or given."""
    data = loaded("ellipse").data
    limits = {"tooth_thickness_lower_mm": band[0], "tooth_thickness_upper_mm": band[1]}
    gears = {**data["gears"], "module_mm": module_mm, "tolerances": limits}
    return Drive(
        design_of({**data, "gears": gears, "output": {} if chord_mm is None else {"chord_tolerance_mm": chord_mm}})
    )


@pytest.mark.judges("files")
@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("band", [(-0.062, -0.047), (-0.031, -0.027)])
def test_chords_that_are_left_out_keep_pins_in_the_middle_half_of_the_band(band: tuple[float, float]) -> None:
    drive, folder = with_chords(band, None), new_folder()
    build(drive, folder, lambda step: None, [Format.DXF])
    plain = with_chords((-0.5, 0.0), None)
    assert plain.chord_tolerance_mm == 0.005
    for gear in ("driving", "driven"):
        for read in READERS.values():
            assert np.abs(off_the_middle(folder, gear, read(folder, gear), ring=False)).max() < 0.5
    # The negative control: the same thickness in the chords of a design without a band is outside of that half.
    form, pitch = drive.tooth_form, drive.pitch
    coarse = toothed_pair(pitch, form, plain.chord_tolerance_mm).driving.outline_mm
    assert np.abs(off_the_middle(folder, "driving", coarse, ring=False)).max() > 0.7


@pytest.mark.parametrize(
    ("band", "chord_mm", "right"),
    [((-0.06, -0.045), 0.004, "0.003 mm or less is right"), ((-0.03, -0.026), 0.001, "0.0008 mm or less is right")],
)
def test_chords_too_coarse_for_the_band_are_refused(band: tuple[float, float], chord_mm: float, right: str) -> None:
    with pytest.raises(WrongInput) as refused:
        _ = with_chords(band, chord_mm).chord_tolerance_mm
    assert refused.value.key == "output.chord_tolerance_mm"
    assert f"{chord_mm:g} mm are" in str(refused.value)
    assert right in str(refused.value)
    # What is told to be right is taken, and so are equal limits, which leave no band that chords could keep.
    assert with_chords(band, 0.2 * (band[1] - band[0]) - 1e-9).chord_tolerance_mm > 0.0
    assert with_chords((band[0], band[0]), chord_mm).chord_tolerance_mm == chord_mm
    with pytest.raises(WrongInput, match="too narrow for chords") as narrow:
        _ = with_chords((band[0], band[0] + 1e-6), None).chord_tolerance_mm
    assert narrow.value.key == "gears.tolerances.tooth_thickness_lower_mm"
    said = made(with_chords((band[0], band[0] + 1e-6), None))
    assert isinstance(said, Advice)
    assert "too narrow for chords" in said.what


@cache
def drawn() -> Path:
    folder = new_folder()
    build(changed("ellipse", BANDS["ellipse"]), folder, lambda step: None, [Format.DRAWING])
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("gear", ["driving", "driven"])
def test_the_picture_dimensions_the_band_of_the_table(gear: str) -> None:
    folder = drawn()
    (found,) = re.findall(r"([\d.]+) to ([\d.]+) over 2 pins \u00d8([\d.]+) \((\d+), (\d+)\)", _texts(folder, gear))
    diameter, _, rows = told(folder, gear)
    (row,) = (row for row in rows if tuple(row[:2]) == (float(found[3]), float(found[4])))
    assert (float(found[0]), float(found[1]), float(found[2])) == (row[3], row[4], diameter)


def _texts(folder: Path, gear: str) -> str:
    return (folder / f"{gear}_drawing.svg").read_text()


@pytest.mark.slow
def test_without_a_deviation_outlines_are_the_same_to_the_last_bit() -> None:
    plain = Drive(loaded("ellipse").design).teeth
    for band in (None, (0.0, 0.0), (-0.03, 0.03)):
        data = loaded("ellipse").data
        limits = {} if band is None else {"tooth_thickness_lower_mm": band[0], "tooth_thickness_upper_mm": band[1]}
        tolerances = {"grade": "8", "bore_fit": "H8", **limits}
        other = Drive(design_of({**data, "gears": {**data["gears"], "tolerances": tolerances}})).teeth
        for gear in Gear:
            assert np.array_equal(plain.of(gear).outline_mm, other.of(gear).outline_mm)


def free_rad(outlines: dict[Gear, Array], drive: Drive, phi1: float) -> float:
    """How far shapely can turn the driven gear on from the law's angle until the outlines meet."""
    driving = affinity.rotate(Polygon(outlines[Gear.DRIVING]), phi1, origin=(0, 0), use_radians=True)
    phi2 = float(drive.transmission.driven_angle(np.array([phi1])).value[0])
    own = Polygon(outlines[Gear.DRIVEN])
    low, high = 0.0, 0.05
    while high - low > 1e-6:
        middle = (low + high) / 2.0
        turned = affinity.rotate(own, -phi2 - middle, origin=(0, 0), use_radians=True)
        met = driving.intersection(affinity.translate(turned, drive.pitch.center_distance_mm)).area > 1e-6
        low, high = (low, middle) if met else (middle, high)
    return low


@pytest.mark.slow
def test_play_over_the_band_is_what_shapely_finds_by_turning() -> None:
    one = changed("ellipse", BANDS["ellipse"])
    band = one.thickness_band
    assert [at.deviation_mm for at in band] == pytest.approx([-0.09, -0.06, -0.03])
    for at in band:
        other = changed("ellipse", (at.deviation_mm, at.deviation_mm))
        outlines = {gear: other.teeth.of(gear).outline_mm for gear in Gear}
        for end in (at.extremes.backlash_rad.low, at.extremes.backlash_rad.high):
            # Chords of both gears leave some thousandths of a millimetre.
            assert free_rad(outlines, one, end.at) == pytest.approx(end.value, abs=4.0 * CHORD_MM / 20.0)
    thinnest, middle, thickest = (at.extremes.backlash_rad.low.value for at in band)
    assert thinnest - middle == pytest.approx(middle - thickest, rel=0.02)
    assert thinnest > 1.5 * thickest


@pytest.mark.slow
def test_pushing_flanks_keep_the_law_over_the_whole_band() -> None:
    for at in changed("ellipse", BANDS["ellipse"]).thickness_band:
        assert at.extremes.pushing_error_rad.width < 1e-9
        assert at.contact.pushing.pairs.least_arc > 1.0
        # The play along the normal is the thickness of both gears beside the backlash that is asked for.
        least = 0.06 - 2.0 * at.deviation_mm * cos(radians(20.0))
        assert at.play.least_normal_mm.value == pytest.approx(least, rel=1e-12)


@pytest.mark.slow
def test_strength_simulation_and_assemblies_are_those_of_the_middle() -> None:
    """One truth: whoever asks the drive for teeth has those that are written."""
    one, same = changed("ellipse", (-0.09, -0.03)), changed("ellipse", (-0.06, -0.06))
    for gear in Gear:
        assert np.array_equal(one.teeth.of(gear).outline_mm, same.teeth.of(gear).outline_mm)
    assert one.play == same.play
    assert one.play_range_rad == same.play_range_rad
    assert one.play_range_rad[0] > changed("ellipse", None).play_range_rad[0] > 0.0


@pytest.mark.parametrize(
    ("band", "key", "remedy"),
    [
        ((-0.02, 0.05), "gears.tolerances.tooth_thickness_upper_mm", "0.0319 mm or less"),
        ((-2.7, -0.01), "gears.tolerances.tooth_thickness_lower_mm", "is right"),
    ],
)
def test_teeth_that_would_jam_or_vanish_are_refused(band: tuple[float, float], key: str, remedy: str) -> None:
    with pytest.raises(WrongInput) as refused:
        _ = changed("ellipse", band).teeth
    assert refused.value.key == key
    assert remedy in str(refused.value)


@pytest.mark.slow
def test_teeth_that_just_do_not_jam_are_made() -> None:
    """0.06 mm of backlash along the normal is 0.0319 mm along the pitch curve of each gear."""
    band = changed("ellipse", (-0.02, 0.0319)).thickness_band
    assert 0.0 < band[2].extremes.backlash_rad.low.value < 0.01 * band[0].extremes.backlash_rad.low.value
