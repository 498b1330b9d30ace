"""Gears in CAD programs: FreeCAD's macro runs in FreeCAD, parts of build123d are measured by build123d."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from importlib.util import find_spec
from math import pi
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import BSpline

from at_once import at_once
from commands import ROOT, Run
from drives import DESIGNS, drive
from later import Later
from ncgear.errors import Unanswered
from ncgear.files.freecad import COMMAND, answer, macro
from ncgear.pitch.shape import Gear
from ncgear.teeth.contour import Line

if find_spec("OCP") is None:
    pytest.skip("python -m pip install 'ncgear[step]' installs what makes exact solids", allow_module_level=True)

faces, shapes = Later("ncgear.files.workshop.step"), Later("ncgear.solids.brep.gear")

FREECAD = shutil.which("freecadcmd") or shutil.which("FreeCADCmd")

CIRCLES = """\
name: circles
operation: {speed_rpm: 60}
motion: {law: ratio_expression, ratio: "1"}
gears: {teeth: 20, module_mm: 2, face_width_mm: 6, driving: {bore_mm: 5}}
"""

IN_FREECAD = """
import json, FreeCAD
spaces = {"__name__": "macro"}
exec(open("ncgear.FCMacro").read(), spaces)
document = FreeCAD.newDocument("tried")
gears = spaces["Gears"]("design.yaml", document)

def told():
    solids = {one.Label: one for one in document.Objects if one.TypeId == "Part::Feature"}
    (sketch,) = [one for one in document.Objects if one.TypeId == "Sketcher::SketchObject"]
    return {
        "solids": {name: [one.Shape.isValid(), one.Shape.ShapeType, len(one.Shape.Faces), one.Shape.Volume,
                          one.Placement.Base.x] for name, one in solids.items()},
        "curves": [edge.Length for edge in sketch.Shape.Edges],
        "parts": [[one.Label, one.ncgear_design] for one in spaces["groups_of"](document)],
    }

def until(found):
    import time
    end = time.time() + 60.0
    while time.time() < end and not found():
        gears.followed()
        time.sleep(0.02)

gears.opened()
seen = [told()]
text = open("design.yaml").read()
open("design.yaml", "w").write(text.replace("face_width_mm: 6", "face_width_mm: 9.5"))
until(lambda: told() != seen[0])
seen.append(told())
open("design.yaml", "w").write(text.replace("face_width_mm: 6", "face_width_mm: -9"))
refused, show = [], gears.shown
gears.shown = lambda answer: (refused.append(answer), show(answer))
until(lambda: refused)
seen.append(told())
json.dump(seen, open("told.json", "w"))
gears.process.stdin.close()
"""


@pytest.mark.slow
@pytest.mark.skipif(FREECAD is None, reason="FreeCAD is not installed (apt-get install freecad-python3)")
def test_the_macro_shows_a_design_in_freecad_and_follows_it(tmp_path: Path) -> None:
    """Volumes by FreeCAD's kernel, pitch curves against circles; 1.5 times the face width, then a refused file."""
    # The macro leaves PYTHONPATH out, by which a checkout may be found.
    here = macro().replace("NCGEAR = [", f'NCGEAR = ["env", "PYTHONPATH={ROOT / "src"}", ')
    (tmp_path / "ncgear.FCMacro").write_text(here, encoding="utf-8")
    (tmp_path / "design.yaml").write_text(CIRCLES, encoding="utf-8")
    (tmp_path / "tried.py").write_text(IN_FREECAD, encoding="utf-8")
    # Debian's FreeCAD fails where another Python stands first on the path.
    own = {**os.environ, "PATH": "/usr/bin:/bin"}
    assert FREECAD is not None
    done = subprocess.run([FREECAD, "tried.py"], cwd=tmp_path, env=own, capture_output=True, text=True, timeout=120)
    first, followed, refused = json.loads((tmp_path / "told.json").read_text())
    assert followed == refused
    assert "gears.face_width_mm: -9 given" in done.stdout + done.stderr
    assert first["parts"] == [["circles", "design.yaml"]]
    assert first["curves"] == pytest.approx([40.0 * pi, 40.0 * pi], rel=1e-5)
    for name, x_mm in (("driving", 0.0), ("driven", 40.0)):
        assert first["solids"][name][:2] == [True, "Solid"]
        assert first["solids"][name][4] == pytest.approx(x_mm, abs=1e-12)
        assert followed["solids"][name][3] == pytest.approx(first["solids"][name][3] * 9.5 / 6.0, rel=1e-4)
    # The pitch cylinder of 20 mm: what teeth lack below it they have above it, within a few percent; less the bore.
    bored = first["solids"]["driven"][3] - first["solids"]["driving"][3]
    assert bored == pytest.approx(6.0 * pi * 2.5**2, rel=0.01)


@pytest.mark.slow
def test_an_answer_has_the_same_solids_and_pitch_curves() -> None:
    pytest.importorskip("OCP")
    from io import BytesIO

    from OCP.BRep import BRep_Builder
    from OCP.BRepTools import BRepTools
    from OCP.TopoDS import TopoDS_Shape

    own, told = drive("ellipse"), answer(DESIGNS / "ellipse.yaml")
    (pair,) = told["pairs"]
    assert pair["center_distance_mm"] == own.pitch.center_distance_mm
    for gear, (shape, _) in faces.exact_solids(own).items():
        found = next(one for one in pair["gears"] if one["name"] == gear.value)
        back = TopoDS_Shape()
        BRepTools.Read_s(back, BytesIO(found["brep"].encode()), BRep_Builder())
        assert shapes.volume_mm3(back) == pytest.approx(shapes.volume_mm3(shape), rel=1e-6)
        curve = found["pitch_curve"]
        assert sum(curve["times"]) == len(curve["poles"]) + 4


@at_once("name", ["ellipse", "rounded-square", "spiral-pair"])
@at_once("gear", list(Gear))
@pytest.mark.slow
def test_the_spline_of_a_pitch_curve_follows_it_also_at_joints(name: str, gear: Gear) -> None:
    """Distances by many chords of the exact curve at other places than the spline was judged at."""
    curve, within = drive(name).pitch.of(gear), 5e-4
    spline = faces.pitch_spline(curve, within)
    at = np.linspace(0.0, float(spline.knots[-1]), 4001)
    exact = curve.at_length(at).position
    assert np.linalg.norm(BSpline(spline.knots, spline.poles_mm, 3)(at) - exact, axis=1).max() <= 1.05 * within
    if name == "spiral-pair":
        assert spline.knots[-1] < 0.5 * curve.length_mm


@pytest.mark.slow
def test_a_face_whose_wire_crosses_itself_makes_no_solid() -> None:
    corners = np.array([[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]])
    crossing = shapes.wire_of([Line(*ends) for ends in zip(corners, np.roll(corners, -1, axis=0), strict=True)])
    with pytest.raises(Unanswered, match="not valid"):
        shapes.prism(crossing, [], 0.0, 5.0)


def test_the_macro_starts_this_python_and_is_plain_python(run: Run, tmp_path: Path) -> None:
    assert run("freecad", "--out", str(tmp_path / "new")) == (0, f"{tmp_path}/new/ncgear.FCMacro\n", "")
    written = (tmp_path / "new" / "ncgear.FCMacro").read_text(encoding="utf-8")
    compile(written, "ncgear.FCMacro", "exec")
    assert COMMAND not in written
    assert COMMAND in (ROOT / "src" / "ncgear" / "files" / "ncgear.FCMacro").read_text(encoding="utf-8")


@pytest.mark.slow
def test_parts_of_build123d_are_the_solids_at_their_places() -> None:
    pytest.importorskip("build123d", reason="python -m pip install 'ncgear[build123d]' installs build123d")
    from ncgear import cad

    own = drive("internal-1-2")
    made = cad.pair(own)
    assert made.label == "internal-1-2"
    assert [part.label for part in made.children] == ["driving", "driven"]
    meshes = own.solids.driving.mesh, own.solids.driven.mesh
    for part, mesh, x_mm in zip(made.children, meshes, (0.0, own.pitch.center_distance_mm), strict=True):
        assert part.is_valid
        assert part.volume == pytest.approx(mesh.volume, rel=1e-3)
        assert pytest.approx(mesh.center_mass[0] + x_mm, abs=1e-2) == part.center().X
    for gear in Gear:
        assert cad.pitch_curve(own, gear.value).length == pytest.approx(own.pitch.of(gear).length_mm, rel=1e-5)
