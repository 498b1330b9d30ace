"""STEP files, read by a reader that knows nothing of who wrote them, and by two builds of OpenCASCADE."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from dataclasses import replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from shapely import Polygon

from closeness import farthest, farthest_from_pieces
from commands import Run
from drives import DESIGNS, drive, drive_of_text, loaded
from later import Later
from ncgear.errors import Unanswered, WrongInput
from ncgear.files.read_back import error_of_step_mm
from ncgear.numerics.plane import signed_area
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.solids.helical import patches
from ncgear.solids.helical.sections import Sections
from ncgear.solids.plan.body import BodyPlan
from ncgear.teeth.contour import CURVES_SHARE, Contour, Spline, contour_of
from ncgear.teeth.gear import ToothedGear
from oracles.part21 import Entity, Part21
from pairs import exact_ring

if find_spec("OCP") is None:
    pytest.skip("python -m pip install 'ncgear[step]' installs what writes STEP", allow_module_level=True)

writer, brep = (Later(f"ncgear.{name}") for name in ("files.workshop.step", "solids.brep.gear"))

FINE = 1e-5
"""Chord tolerance of the outlines that files are held against."""
DENSE, VERY_DENSE = 24, 192
"""Points on each curve of a file: between those at which it was fitted; and so many that chords stray by nothing."""

Array = NDArray[np.float64]

CONCAVE = """\
name: concave
linkage: {crank_mm: 40, rod_mm: 160}
operation: {speed_rpm: 60}
motion: {law: ratio_expression, ratio: "1/(1 - 0.4*cos(2*phi))", scale_to_close: true}
gears:
  teeth: 40
  module_mm: 1
  face_width_mm: 6
  driving: {bore_mm: 5}
  driven: {bore_mm: 5}
"""


@cache
def files(name: str) -> dict[str, bytes]:
    return writer.step_files(drive(name))


def sections(file: Part21, solid: Entity, samples: int = DENSE) -> dict[float, list[Array]]:
    """The loops of the faces across z by their heights, the longest first."""
    flat = [face for face in file.faces(solid) if file.surface(face).name == "PLANE"]
    heights = {height: face for face in flat if (height := file.height(file.surface(face))) is not None}
    return {
        height: sorted((loop[:, :2] for loop in file.loops(face, samples)), key=lambda loop: -abs(signed_area(loop)))
        for height, face in heights.items()
    }


def solid_of(data: bytes) -> tuple[Part21, Entity]:
    file = Part21(data)
    (solid,) = file.of("MANIFOLD_SOLID_BREP")
    return file, solid


def require_agreement(data: bytes, gear: ToothedGear, tolerance: float, width: float, *, ring: bool = False) -> None:
    """Both ends of the solid hold the exact outline, and its walls stand straight on them."""
    file, solid = solid_of(data)
    exact = exact_ring(gear, FINE)
    coarse = sections(file, solid)
    assert sorted(coarse) == [0.0, width]
    for height in coarse:
        assert farthest(coarse[height][int(ring)], exact) <= tolerance + FINE
    assert farthest(exact, sections(file, solid, VERY_DENSE)[0.0][int(ring)]) <= 1.01 * tolerance
    walls = [file.surface(face) for face in file.faces(solid)]
    extruded = [wall.arguments for wall in walls if wall.name == "SURFACE_OF_LINEAR_EXTRUSION"]
    ways = np.array([file.triple(file[vector].arguments[1]) for _, _, vector in extruded])
    np.testing.assert_allclose(np.abs(ways), np.broadcast_to([0.0, 0.0, 1.0], ways.shape), rtol=0.0, atol=1e-15)
    splines = [file.spline(file.basis(curve)) for _, curve, _ in extruded]
    swept = np.concatenate([spline(np.linspace(spline.t[0], spline.t[-1], DENSE)) for spline in splines])
    assert farthest(swept[:, :2], exact) <= tolerance + FINE


def require_both(name: str) -> None:
    own = drive(name)
    tolerance, width = CURVES_SHARE * own.chord_tolerance_mm, own.gears.face_width_mm
    require_agreement(files(name)["driving.step"], own.teeth.driving, tolerance, width)
    require_agreement(files(name)["driven.step"], own.teeth.driven, tolerance, width)


@pytest.mark.long
@pytest.mark.slow
def test_ellipse_sections_are_the_exact_outlines() -> None:
    require_both("ellipse")


@pytest.mark.slow
@pytest.mark.long
def test_baler_sections_are_the_exact_outlines() -> None:
    require_both("baler")


@pytest.mark.long
@pytest.mark.slow
def test_the_ring_s_section_is_its_exact_outline() -> None:
    gear = drive("internal-1-2").teeth.driven
    require_agreement(files("internal-1-2")["driven.step"], gear, 5e-4, 14.0, ring=True)


@pytest.mark.long
@pytest.mark.slow
def test_concave_sections_are_the_exact_outlines() -> None:
    own = drive_of_text(CONCAVE)
    assert not own.pitch.convex(Gear.DRIVING)
    require_agreement(writer.step_files(own)["driving.step"], own.teeth.driving, 5e-4, 6.0)


def plate(width: float) -> BodyPlan:
    """A gear without anything cut into it."""
    return BodyPlan(Polygon(drive("ellipse").teeth.driving.outline_mm), width, 0.005)


def moved(contour: Contour, off: float) -> Contour:
    """The contour with the inner poles of its longest spline moved across it."""
    longest = max(
        (curve for curve in contour.curves if isinstance(curve, Spline)),
        key=lambda curve: float(np.linalg.norm(curve.end - curve.start)),
    )
    step = longest.end - longest.start
    poles = longest.poles_mm.copy()
    poles[1:-1] += off * np.array([-step[1], step[0]]) / np.hypot(*step)
    curves = tuple(replace(one, poles_mm=poles) if one is longest else one for one in contour.curves)
    return replace(contour, curves=curves)


@pytest.mark.slow
def test_a_face_that_is_moved_by_two_tolerances_is_seen() -> None:
    gear = drive("ellipse").teeth.driving
    contour = contour_of(gear, 5e-4)
    for off, seen in ((0.0, False), (1e-3, True)):
        data = writer.part_bytes(writer.StepSolid("driving", brep.gear_shape(moved(contour, off), plate(12.0))), "")
        if seen:
            with pytest.raises(AssertionError):
                require_agreement(data, gear, 5e-4, 12.0)
        else:
            require_agreement(data, gear, 5e-4, 12.0)


@pytest.mark.slow
def test_baler_has_a_face_for_every_curve_and_no_more() -> None:
    """Two ends, bore and three sides of the keyway, index hole; and six faces a tooth, parted at joints of the law."""
    file, solid = solid_of(files("baler")["driving.step"])
    kinds = Counter(file.surface(face).name for face in file.faces(solid))
    curves = len(contour_of(drive("baler").teeth.driving, 5e-4).curves)
    assert kinds.total() == 2 + 4 + 1 + curves
    assert curves < 7 * 25
    assert kinds["PLANE"] == 2 + 3
    round_ = [file.surface(face) for face in file.faces(solid) if file.surface(face).name == "CYLINDRICAL_SURFACE"]
    radii = [surface.arguments[2] for surface in round_]
    assert radii.count(8.0) == 1
    assert radii.count(1.0) == 1


@pytest.mark.long
@pytest.mark.slow
def test_a_ring_stands_within_a_cylinder() -> None:
    file, solid = solid_of(files("internal-1-2")["driven.step"])
    outer, hole, mark = sections(file, solid, VERY_DENSE)[0.0]
    deepest = float(np.hypot(*drive("internal-1-2").teeth.driven.outline_mm.T).max())
    np.testing.assert_allclose(np.hypot(*outer.T), deepest + 8.0, rtol=0.0, atol=1e-9)
    assert len(hole) > len(outer)
    assert abs(signed_area(mark)) == pytest.approx(np.pi, rel=1e-6)


@pytest.mark.slow
def test_the_pair_stands_as_it_goes_together() -> None:
    file = Part21(files("ellipse")["pair.step"])
    names = [product.arguments[0] for product in file.of("PRODUCT")]
    assert names == ["ellipse", "driving", "driven"]
    places = [file[use.arguments[3]] for use in file.of("ITEM_DEFINED_TRANSFORMATION")]
    origins = [file.triple(place.arguments[1]) for place in places]
    distance = drive("ellipse").pitch.center_distance_mm
    np.testing.assert_allclose(origins, [[0.0, 0.0, 0.0], [distance, 0.0, 0.0]], rtol=1e-14, atol=0.0)
    assert len(file.of("MANIFOLD_SOLID_BREP")) == 2
    units = [one for entity in file.entities.values() if not entity.name for one in entity.arguments]
    assert {tuple(unit.arguments) for unit in units if unit.name == "SI_UNIT"} >= {(".MILLI.", ".METRE.")}


@pytest.mark.slow
def test_the_header_says_how_close_and_nothing_of_clock_or_machine() -> None:
    header = " ".join(files("ellipse")["driving.step"].decode().split("ENDSEC", 1)[0].split())
    assert "'ellipse: tooth faces within 4.0e-04 mm of the exact ones'" in header
    assert error_of_step_mm(files("ellipse")["pair.step"]) == 4.0e-4
    assert "FILE_NAME('driving','1970-01-01T00:00:00',(''),(''), 'Open CASCADE STEP processor" in header
    assert header.endswith("'ncgear',''); FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));")


@pytest.mark.slow
def test_the_same_design_gives_the_same_bytes(capfd: pytest.CaptureFixture[str]) -> None:
    assert writer.step_files(Drive(loaded("ellipse").design)) == files("ellipse")
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "line"),
    [
        ("first_layer_chamfer_mm", "first_layer_chamfer_mm: 0.2"),
        ("process_clearance_mm", "process_clearance_mm: 0.1"),
    ],
)
def test_what_only_meshes_have_is_refused(key: str, line: str) -> None:
    own = drive_of_text(f"{CONCAVE}  {line}\n")
    with pytest.raises(
        WrongInput,
        match=rf"gears\.{key}: given, but solids with exact faces, as in STEP files, have no .*; leave it out",
    ):
        writer.step_files(own)


@pytest.mark.slow
def test_helical_teeth_that_do_not_go_up_smoothly_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the baler's law, whose joints part flanks at other places in every section."""
    text = (DESIGNS / "baler.yaml").read_text(encoding="utf-8")
    helix = "  helix: {angle_deg: 10, kind: herringbone, hand: left}"
    own = drive_of_text(text.replace("  face_width_mm: 20", f"  face_width_mm: 4\n{helix}"))
    monkeypatch.setattr(patches, "GRIDS", patches.GRIDS[:2])
    with pytest.raises(WrongInput, match=r"gears\.helix: the helical teeth of the driving gear do not go up smoothly"):
        patches.patches_of(Sections(own.pitch, own.tooth_form, own.helix, 0.005), Gear.DRIVING, 5e-4)


def test_a_missing_library_is_named_before_the_file_is_read(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """By its option, with the command that installs it."""
    monkeypatch.setattr("ncgear.extras.find_spec", lambda library: None)
    status, out, err = run("build", "none.yaml", "--format", "step")
    assert (status, out) == (2, "")
    assert err.startswith("--format step: needs OCP, which is not installed; python -m pip install 'ncgear[step]'")
    assert not Path("out").exists()


@pytest.mark.slow
def test_a_file_of_another_solid_is_a_fault() -> None:
    contour = contour_of(drive("ellipse").teeth.driving, 5e-4)
    own, wider = (brep.gear_shape(contour, plate(width)) for width in (12.0, 12.001))
    data = writer.part_bytes(writer.StepSolid("driving", own), "")
    writer.require_same(data, [own])
    with pytest.raises(Unanswered, match="a STEP file holds 224 faces"):
        writer.require_same(data, [wider])
    with pytest.raises(Unanswered, match="cannot be read back"):
        writer.require_same(b"nothing", [own])


def volumes(name: str) -> list[float]:
    """Areas of the files' sections by very many chords, times the face width."""
    solids = (solid_of(files(name)[f"{gear}.step"]) for gear in ("driving", "driven"))
    rings = [sections(*solid, VERY_DENSE)[0.0] for solid in solids]
    areas = [2.0 * abs(signed_area(ring[0])) - sum(abs(signed_area(one)) for one in ring) for ring in rings]
    return [float(area) * drive(name).gears.face_width_mm for area in areas]


BODIES = """\
  driving:
    bore_mm: 8
    keyway: {width_mm: 2, depth_mm: 1.4}
    hub: {diameter_mm: 14, height_mm: 9, set_screw: {diameter_mm: 4, direction_deg: 90}}
    web: {thickness_mm: 2.5, rim_mm: 2}
  driven:
    bore_mm: 5
    hub: {diameter_mm: 10, height_mm: 6}
    lightening_holes: {count: 3, least_wall_mm: 1.5}
"""


@pytest.fixture(scope="module")
def bodied() -> tuple[Drive, dict[str, bytes]]:
    """Hollow gears with all that can be made of their bodies."""
    text = CONCAVE.split("  driving:", 1)[0] + BODIES
    own = drive_of_text(text)
    return own, writer.step_files(own)


UP = [0.0, 0.0, 1.0]


def cylinders(data: bytes) -> list[tuple[float, list[float]]]:
    """Radius and axis of every cylindrical face."""
    file, solid = solid_of(data)
    walls = [surface for face in file.faces(solid) if (surface := file.surface(face)).name == "CYLINDRICAL_SURFACE"]
    axes = [file.triple(file[wall.arguments[1]].arguments[2]) for wall in walls]
    return [(wall.arguments[2], np.abs(axis).round(12).tolist()) for wall, axis in zip(walls, axes, strict=True)]


@pytest.mark.long
@pytest.mark.slow
def test_hub_screw_and_holes_are_cylinders_of_one_face_each(bodied: tuple[Drive, dict[str, bytes]]) -> None:
    own, made = bodied
    driving, driven = cylinders(made["driving.step"]), cylinders(made["driven.step"])
    assert driving.count((2.0, [0.0, 1.0, 0.0])) == 1
    for found, radius in ((driving, 7.0), (driving, 4.0), (driven, 5.0), (driven, 2.5)):
        assert found.count((radius, UP)) == 1
    holes = own.solids.driven.plan.lightening_holes
    assert len(holes) == 3
    assert sum(abs(radius - holes[0].diameter_mm / 2.0) < 1e-9 for radius, _ in driven) == 3


@pytest.mark.long
@pytest.mark.slow
def test_helical_gears_have_bodies_too() -> None:
    """Hub, screw and holes of straight gears, of one face each, on teeth that go round."""
    head = (DESIGNS / "helical-ellipse.yaml").read_text(encoding="utf-8").split("  driving:", 1)[0]
    body = "{bore_mm: 6, hub: {diameter_mm: 11, height_mm: 5, set_screw: {diameter_mm: 2}}}"
    own = drive_of_text(f"{head}  driving: {body}\n  driven: {{bore_mm: 6}}\n")
    made = writer.step_files(own)
    found = cylinders(made["driving.step"])
    assert found.count((1.0, [1.0, 0.0, 0.0])) == found.count((3.0, UP)) == found.count((5.5, UP)) == 1
    mesh = own.solids.driving.mesh
    assert abs(brep.volume_mm3(writer.read_back(made["driving.step"])) - mesh.volume) <= 0.005 * mesh.area


@pytest.mark.slow
def test_bodies_stand_on_the_heights_of_their_plans(bodied: tuple[Drive, dict[str, bytes]]) -> None:
    own, made = bodied
    assert sorted(sections(*solid_of(made["driving.step"]))) == [0.0, 2.5, 6.0, 15.0]
    assert sorted(sections(*solid_of(made["driven.step"]))) == [0.0, 6.0, 12.0]
    file, solid = solid_of(made["driving.step"])
    (pocket,) = own.solids.driving.plan.web.pockets if own.solids.driving.plan.web else ()
    floor, hub = sections(file, solid)[2.5]
    allowed = own.chord_tolerance_mm
    assert farthest(np.asarray(pocket.exterior.coords), floor) <= allowed
    assert farthest(floor, np.asarray(pocket.exterior.coords)) <= allowed
    np.testing.assert_allclose(np.hypot(*hub.T), 7.0, rtol=0.0, atol=1e-9)


@pytest.mark.slow
def test_bodies_hold_what_their_meshes_hold(bodied: tuple[Drive, dict[str, bytes]]) -> None:
    own, made = bodied
    for gear, mesh in (("driving", own.solids.driving.mesh), ("driven", own.solids.driven.mesh)):
        found = brep.volume_mm3(writer.read_back(made[f"{gear}.step"]))
        assert abs(found - mesh.volume) <= own.chord_tolerance_mm * mesh.area


def levels(data: bytes, height: float, samples: int) -> Array:
    """Sections of the surfaces that a height meets, shape (k, samples + 1, 2)."""
    file, solid = solid_of(data)
    walls = [surface for face in file.faces(solid) if (surface := file.surface(face)).name.startswith("B_SPLINE")]
    # Points of a surface whose heights the level is not between lie elsewhere.
    points = np.array([file.level(wall, height, samples) for wall in walls if file.meets(wall, height)])
    np.testing.assert_allclose(points[..., 2], height, rtol=0.0, atol=1e-12)
    return points[..., :2]


@pytest.mark.tiers(slow=["helical"], rest="long")
@pytest.mark.parametrize("kind", ["helical", "herringbone"])
def test_helical_sections_at_any_height_are_the_exact_ones(kind: str) -> None:
    text = (DESIGNS / "helical-ellipse.yaml").read_text(encoding="utf-8")
    own = drive_of_text(text.replace("kind: helical", f"kind: {kind}"))
    made, exact_sections = writer.step_files(own), Sections(own.pitch, own.tooth_form, own.helix, FINE)
    for gear in Gear:
        data, height = made[f"{gear.value}.step"], 8.3 if gear is Gear.DRIVING else 3.14
        mirrored = 10.0 - height if kind == "herringbone" and height > 5.0 else height
        exact = exact_ring(exact_sections.at(mirrored).of(gear), FINE)
        found = levels(data, height, DENSE)
        assert len(found) == 6 * 19
        assert farthest(found.reshape(-1, 2), exact) <= 5e-4 + FINE
        assert farthest_from_pieces(exact, levels(data, height, VERY_DENSE)) <= 1.01 * 5e-4
        # The teeth a hundredth of a millimetre farther up stand elsewhere by a third of it.
        assert farthest(levels(data, height + 0.01, DENSE).reshape(-1, 2), exact) > 2e-3
        mesh = own.solids.of(gear).mesh
        assert abs(brep.volume_mm3(writer.read_back(data)) - mesh.volume) <= 0.005 * mesh.area


@pytest.mark.tiers(slow=["baler"], rest="long")
@pytest.mark.parametrize("name", ["ellipse", "baler", "internal-1-2"])
def test_volumes_are_those_of_the_meshes_and_of_the_kernel(name: str) -> None:
    """Walls of a mesh stray by the chord tolerance at most, all to one side or not: its area measures them."""
    own = drive(name)
    meshes = own.solids.driving.mesh, own.solids.driven.mesh
    solids = [writer.read_back(files(name)[f"{gear}.step"]) for gear in ("driving", "driven")]
    for volume, mesh, shape in zip(volumes(name), meshes, solids, strict=True):
        assert abs(volume - mesh.volume) <= own.chord_tolerance_mm * mesh.area
        assert brep.volume_mm3(shape) == pytest.approx(volume, rel=writer.VOLUME_TOLERANCE)


@pytest.mark.long
@pytest.mark.slow
def test_a_build_writes_the_kind_that_is_asked_for(run: Run, tmp_path: Path) -> None:
    status, _, err = run("build", str(DESIGNS / "ellipse.yaml"), "--format", "step", "--out", "made")
    assert status == 0, err
    assert {path.name for path in (tmp_path / "made").glob("*.step")} == set(files("ellipse"))
    for name, content in files("ellipse").items():
        assert (tmp_path / "made" / name).read_bytes() == content
    assert not list((tmp_path / "made").glob("*.dxf"))


@pytest.mark.slow
def test_nothing_but_steps_needs_the_library() -> None:
    """Its module is loaded only when these files are asked for."""
    code = "import sys, ncgear.files.build, ncgear.files.workshop.formats; sys.exit('OCP' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
