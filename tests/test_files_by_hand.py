"""Values that stand in written files, on a few numbers that are done by hand: settings, splines, bodies, charts."""

from __future__ import annotations

from math import degrees, hypot, pi
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import json5
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from shapely.geometry import Polygon, box

import ncgear.files.simulation as simulated
import ncgear.files.strength as rated
import ncgear.files.tolerance as tolerated
from ncgear.errors import WrongInput
from ncgear.figures.toleranced import SOURCES, source_words
from ncgear.files import editor, read_back, searched
from ncgear.files.sweep import _ticks
from ncgear.files.train import FRAMES, _glb, _solid, _trace_csv
from ncgear.files.workshop.sheets.body import finished
from ncgear.files.workshop.solid_files import _after, _chunks, _parted
from ncgear.numerics.plane import Vector
from ncgear.pitch.shape import Gear
from ncgear.solids.plan.body import ArcSlot, BodyPlan, Bore, Keyway, RoundHole
from ncgear.strength.holding import Damage
from ncgear.trains.train import Part, PinHole, Poses, Trace

Made: Any = SimpleNamespace


# --- settings of an editor


@pytest.mark.judges("files")
def test_files_of_one_kind_are_named_by_their_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder that holds two kinds, or another file, names each; hidden folders and huge files do not count."""
    design, train = "motion: {}\n", "train: {}\n"
    for name, text in {
        "a/x.yaml": design,
        "a/in/y.yaml": design,
        "b/x.yaml": design,
        "b/t.yaml": train,
        "c/huge.yaml": design + "#" * 100,
        "d/no.txt": train,
        ".hidden/x.yaml": design,
        "node_modules/x.yaml": design,
    }.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(editor, "LONGEST_BYTES", 100)
    monkeypatch.setattr(editor, "json_schema", lambda model: {"of": model.__name__})
    found = editor.editor_files(tmp_path)
    assert found.patterns == {"ncgear.schema.json": ["a/*.yaml", "b/x.yaml"], "ncgear-train.schema.json": ["b/t.yaml"]}
    assert set(found.files) == {*found.patterns, "settings.json"}
    place = tmp_path / ".vscode"
    place.mkdir()
    for name, content in found.files.items():
        (place / name).write_bytes(content)
    assert editor.editor_files(tmp_path).files == {}
    (place / "settings.json").write_text('{"yaml.schemas": {"./.vscode/ncgear.schema.json": "mine.yaml"}}')
    (new,) = editor.editor_files(tmp_path).files.values()
    assert json5.loads(new.decode())["yaml.schemas"] == {
        "./.vscode/ncgear.schema.json": ["mine.yaml", "a/*.yaml", "b/x.yaml"],
        "./.vscode/ncgear-train.schema.json": ["b/t.yaml"],
    }
    monkeypatch.setattr(editor, "with_member", lambda text, *_: text)
    with pytest.raises(WrongInput, match="reads otherwise"):
        editor.editor_files(tmp_path)


# --- curves and bodies


@pytest.mark.judges("files")
def test_an_outline_is_read_back_from_a_body_that_was_made_smaller(monkeypatch: pytest.MonkeyPatch) -> None:
    """A square of 40 mm is 0.1 mm inside its outline all around; a ring's opening is as much outside."""
    heights = []

    def of_stl(data: bytes, height: float, *, hole: bool) -> Any:
        heights.append((height, hole))
        off = -0.1 if hole else 0.1
        return np.array(box(off, off, 40.0 - off, 40.0 - off).exterior.coords)

    monkeypatch.setattr(read_back, "outline_of_stl", of_stl)
    for ring in (False, True):
        plan: Any = Made(is_ring=ring, clearance_mm=0.1, chamfer_mm=2.0, face_width_mm=10.0)
        found = read_back._outline_of_body(b"", plan, False)
        assert Polygon(found).bounds == pytest.approx((0.0, 0.0, 40.0, 40.0), abs=1e-9)
        assert Polygon(found).area == pytest.approx(1600.0, abs=0.01)
    assert heights == [(6.0, False), (6.0, True)]


@pytest.mark.judges("files")
@pytest.mark.parametrize(("off", "wider"), [(0.25, 0.0), (-0.25, 0.5)])
def test_a_finished_body_is_without_the_clearance_of_its_process(off: float, wider: float) -> None:
    """Bore, slot and keyway are as much wider as the outline is smaller, the pin less; holes change by a kerf alone."""
    outline = np.array(box(-21.0, -21.0, 21.0, 21.0).exterior.coords)
    plan = BodyPlan(
        box(-20.0, -20.0, 20.0, 20.0),
        face_width_mm=10.0,
        chord_tolerance_mm=0.01,
        bore=Bore(8.0, Keyway(2.0, 1.0)),
        slot=ArcSlot(12.0, 3.0, 0.1, 0.9),
        index_hole=RoundHole(3.0, 4.0, 5.0),
        crank_pin=RoundHole(6.0, 7.0, 4.0),
        lightening_holes=(RoundHole(-5.0, 0.0, 2.0),),
        clearance_mm=off,
    )
    bodies, teeth = Made(of=lambda gear: Made(plan=plan)), Made(of=lambda gear: Made(outline_mm=outline))
    found = finished(Made(solids=bodies, teeth=teeth), Gear.DRIVING)
    assert found.disc.bounds == (-21.0, -21.0, 21.0, 21.0)
    assert found.bore == Bore(8.0 - 2.0 * off, Keyway(2.0 - 2.0 * off, 1.0))
    assert found.slot == ArcSlot(12.0, 3.0 - 2.0 * off, 0.1, 0.9)
    assert found.index_hole == RoundHole(3.0, 4.0, 5.0 + wider)
    assert found.lightening_holes == (RoundHole(-5.0, 0.0, 2.0 + wider),)
    assert found.crank_pin == RoundHole(6.0, 7.0, 4.0 - 2.0 * off)
    assert found.clearance_mm == 0.0


@pytest.mark.judges("files")
def test_a_part_of_a_train_is_its_outline_less_its_holes() -> None:
    """A plate of 40 mm with a bore and a hole, and a rim of 5 mm about a square opening, both 6 mm high."""
    square = np.array([[-20.0, -20.0], [20.0, -20.0], [20.0, 20.0], [-20.0, 20.0]])
    plate = Part("plate", square, 6.0, bore_mm=10.0, holes=(PinHole(12.0, -3.0, 4.0),))
    solid = _solid(plate, square, 1e-4)
    assert solid.volume == pytest.approx(6.0 * (1600.0 - 25.0 * pi - 4.0 * pi), rel=1e-4)
    moment = -4.0 * pi * np.array([12.0, -3.0]) / (1600.0 - 29.0 * pi)
    assert solid.center_mass == pytest.approx([*moment, 3.0], abs=1e-3)
    ring = Part("ring", square, 6.0, teeth=20, rim_mm=5.0)
    around = hypot(20.0, 20.0) + 5.0
    assert _solid(ring, square, 1e-4).volume == pytest.approx(6.0 * (pi * around**2 - 1600.0), rel=1e-4)


@pytest.mark.judges("files")
def test_a_moving_train_is_in_metres_and_upright_at_the_speed_of_its_driving_part() -> None:
    """glTF has y up: a place (x, y, z) in mm is (x, z, -y) thousandths.  A turn at -30 r/min takes 2 s."""
    angles = np.linspace(0.0, 2.0 * pi, FRAMES + 1)
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    part = Part("wheel", square, 4.0, teeth=8, low_mm=7.0)
    poses = Poses(np.full((1, FRAMES + 1), 10.0), np.array([20.0 * np.cos(angles)]), np.array([angles]))
    train: Any = Made(cycle_rad=2.0 * pi, turns=1, parts=(part,), speed_rpm=-30.0, poses_at=lambda given: poses)
    content, binary = _chunks(_glb(train, {"wheel": _solid(part, square, 0.01)}))
    (animation,) = content["animations"]

    def numbers(accessor: int) -> np.ndarray:
        view = content["bufferViews"][content["accessors"][accessor]["bufferView"]]
        data = np.frombuffer(binary, "<f4", view["byteLength"] // 4, view["byteOffset"])
        return data.reshape(content["accessors"][accessor]["count"], -1)

    assert numbers(animation["samplers"][0]["input"])[[0, -1], 0] == pytest.approx([0.0, 2.0])
    moved = {
        one["target"]["path"]: numbers(animation["samplers"][one["sampler"]]["output"]) for one in animation["channels"]
    }
    wanted = np.column_stack([np.full(FRAMES + 1, 0.010), np.full(FRAMES + 1, 0.007), -0.020 * np.cos(angles)])
    assert moved["translation"] == pytest.approx(wanted, abs=1e-7)
    upright = Rotation.from_matrix([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    turned = upright * Rotation.from_rotvec(np.column_stack([0.0 * angles, 0.0 * angles, angles]))
    assert (turned.inv() * Rotation.from_quat(moved["rotation"])).magnitude() == pytest.approx(0.0, abs=1e-6)


@pytest.mark.judges("files")
def test_a_turned_node_is_parted_into_scale_quaternion_and_place() -> None:
    """As scipy has the quaternions, also of turns one after the other."""
    first, further = Rotation.from_euler("xyz", [0.3, -0.5, 1.1]), Rotation.from_euler("xyz", [[0.2, 0.4, -0.6]] * 2)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = 0.001 * first.as_matrix(), [1.0, 2.0, 3.0]
    node = {"matrix": matrix.T.ravel().tolist()}
    found = _parted(node)
    assert found == pytest.approx(first.as_quat())
    assert (node["translation"], node["scale"]) == ([1.0, 2.0, 3.0], pytest.approx([0.001] * 3))
    assert _after(found, further.as_quat()) == pytest.approx((first * further).as_quat())


@pytest.mark.judges("files")
def test_a_trace_is_written_with_its_angles() -> None:
    angles = np.array([0.0, 0.5])
    traces = [Trace("other", "arm", (0.0, 0.0)), Trace("pen", "arm", (1.0, 2.0))]
    places = {"pen": np.array([[1.0, 2.0], [3.0, 4.0]]), "other": np.zeros((2, 2))}
    train: Any = Made(traces=traces, trace_mm=lambda trace, _: places[trace.name])
    head, *rows = _trace_csv(train, "pen", angles).decode().splitlines()
    assert head == "driving_rad,x_mm,y_mm"
    assert [[float(cell) for cell in row.split(",")] for row in rows] == [[0.0, 1.0, 2.0], [0.5, 3.0, 4.0]]


# --- charts


@pytest.mark.judges("files")
def test_charts_of_teeth_under_load_are_in_the_units_of_their_axes() -> None:
    loaded = Made(
        driving_torque_n_mm=np.array([5e3, -2e3]), tooth_force_n=np.array([9.0, 8.0]), error_rad=np.array([3e-6, 0.0])
    )
    drive: Any = Made(
        by_stage=[Made(loaded_contact=loaded)],
        motion=Made(phi1_rad=np.array([0.0, pi])),
        loaded_error_at=lambda _phi1: loaded.error_rad,
    )
    torque, force, ahead = simulated.teeth_under_load(drive, np.array([4.0, -3.0]))
    assert [line.values.tolist() for line in torque.lines] == [[5.0, -2.0], [4.0, -3.0]]
    assert torque.lines[0].x == pytest.approx([0.0, 180.0])
    assert torque.end == pytest.approx(180.0)
    assert force.lines[0].values.tolist() == [9.0, 8.0]
    assert ahead.lines[0].values == pytest.approx([3.0, 0.0])


@pytest.mark.judges("files")
def test_charts_of_rigid_loads_have_sizes_means_and_degrees(monkeypatch: pytest.MonkeyPatch) -> None:
    angles = np.array([0.0, pi / 2.0])
    monkeypatch.setattr(simulated, "drawn_angles_rad", lambda drive: angles)
    monkeypatch.setattr(simulated, "joints_up_to", lambda law, end: np.array([end / 2.0]))

    def loads(torque: float) -> Any:
        force = Vector(Made(value=np.array([3.0, 5.0])), Made(value=np.array([4.0, -12.0])))
        mesh = Made(
            pressure_angle_rad=Made(value=np.array([pi / 9.0, -pi / 9.0])), size_n=Made(value=np.array([7.0, 8.0]))
        )
        return Made(
            driving_torque=Made(value=np.array([torque, -torque])),
            crank_bearing=force,
            joints={"pin": force, "wrist": force},
            guide=Made(value=np.array([1.0, -1.0])),
            mesh=mesh,
            meshes_before=(),
        )

    linkage = Made(CRANK="crank", JOINTS={"wrist": "wrist pin", "pin": "crank pin"}, GUIDED=True, UNIFORM="even crank")
    drive: Any = Made(linkage=linkage, transmission=None, rigid=Made(fluctuation=Made(mean_torque_n_mm=2500.0)))
    own, uniform = loads(4000.0), loads(6000.0)
    torque = simulated.driving_torque(drive, own, uniform)
    assert [line.values.tolist() for line in torque.lines] == [[4.0, -4.0], [6.0, -6.0], [2.5, 2.5]]
    assert torque.lines[-1].x == pytest.approx([0.0, 90.0])
    assert torque.joints_deg == pytest.approx([45.0])
    charts = simulated.joint_forces(drive, own, uniform)
    assert [chart.name for chart in charts] == ["crank bearing", "crank pin", "wrist pin", "guide"]
    assert [chart.lines[0].values.tolist() for chart in charts] == [[5.0, 13.0]] * 3 + [[1.0, -1.0]]
    size, angle = simulated.mesh_forces(drive, own, uniform)
    assert (size.lines[0].values.tolist(), angle.lines[0].values) == ([7.0, 8.0], pytest.approx([20.0, -20.0]))
    own.meshes_before = uniform.meshes_before = (own.mesh,)
    assert [chart.name for chart in simulated.mesh_forces(drive, own, uniform)] == [
        "first mesh force",
        "first pressure angle",
        "last mesh force",
        "last pressure angle",
    ]


@pytest.mark.judges("files")
def test_a_flywheels_picture_is_in_watts_over_square_metres(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Any] = []
    for name in ("flywheel_csv", "flywheel_figures", "json_text"):
        monkeypatch.setattr(searched, name, lambda *_: "")
    monkeypatch.setattr(searched, "flywheel_plot", lambda *given: drawn.append(given) or b"")
    points: Any = [Made(flywheel_kg_mm2=5e5, limit_w=7.0, law=Made(peak_power_w=8.0))]
    searched.flywheel_files(points, Made(name="x", operation=Made(speed_rpm=60.0)))
    limit, laws, title = drawn[0]
    assert (limit.tolist(), laws.tolist()) == ([[0.5, 7.0]], [[0.5, 8.0]])
    assert title == "x: least power at 60 r/min"


@pytest.mark.judges("files")
@pytest.mark.parametrize("pairs", [1, 2])
def test_pictures_of_tolerance_are_of_the_machine_and_of_each_pair(pairs: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Plays of two pairs in degrees, causes never below nothing; a pair whose torque turns round has its play there."""
    monkeypatch.setattr(tolerated, "spreads", lambda shown, title: (shown, title))
    monkeypatch.setattr(tolerated, "sources", lambda of, title: of)
    monkeypatch.setattr(tolerated, "tolerance_json", lambda _: {})
    monkeypatch.setattr(tolerated, "assemblies_csv", lambda _: "")
    values = {
        "least_play_mm": np.array([0.1]),
        "transmission_error_mm": np.array([0.02]),
        "play_max_rad": np.array([0.03]),
        "motion_error": np.array([0.4]),
        "reversal_play_mm": np.array([0.2]),
        "count": 1,
    }
    found, nominal = Made(**values), Made(**values | {"reversal_play_mm": np.array([0.1, 0.3])})
    pair = [
        Made(stage=stage, assemblies=found, nominal=nominal, knock="yes", knocking_mm=0.25)
        for stage in range(1, pairs + 1)
    ]
    place = Made(text="deg", factor=degrees(1.0))
    drive = Made(linkage=Made(OUTPUT=Made(place=place, name="shaft")), design=Made(name="x"))
    source = Made(name=next(iter(SOURCES)), stage=None)
    indices = {"motion_error": [Made(source=source, total=-0.1, error=0.01)]}
    files = tolerated.tolerance_files(
        Made(drive=drive, pairs=pair, assemblies=found, nominal=nominal, indices=indices, loaded=True)
    )
    (shown, _), causes = files["spread.png"], files["sources.png"]
    assert causes == {"motion error": {source_words(source): (0.0, 0.01)}}
    assert shown[-1].values == pytest.approx([degrees(0.4)])
    if pairs == 2:
        assert shown[1].values == pytest.approx([degrees(0.03)])
        assert {name for name in files if name.startswith("stage-")} == {"stage-1/spread.png", "stage-2/spread.png"}
    else:
        assert [one.values[0] for one in shown[:3]] == [0.1, 0.2, 0.02]
        assert (shown[1].designed, shown[1].limit) == (0.3, 0.25)
        assert not any("/" in name for name in files)


@pytest.mark.judges("files")
def test_teeth_are_coloured_by_their_least_share_of_the_safety_that_is_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    drawn: list[Any] = []
    monkeypatch.setattr(rated, "coloured_teeth_png", lambda *given: drawn.append(given) or b"")
    monkeypatch.setattr(rated, "positions_at", lambda drive, phi1: phi1.tolist())
    monkeypatch.setattr(rated, "_titled", lambda drive, what: what)
    root, pitting = Damage
    lives = {root: Made(safety=np.array([2.8, 4.2])), pitting: Made(safety=np.array([3.0, 1.2]))}
    monkeypatch.setattr(rated, "lives_of", lambda strength, gear: lives)
    wanted = {root: 1.4, pitting: 1.0}
    weakest = [
        Made(
            gear=gear,
            damage=damage,
            wanted=wanted[damage],
            safety=wanted[damage] * off,
            share=off,
            tooth=tooth,
            phi1_rad=off,
        )
        for gear, damage, tooth, off in (
            (Gear.DRIVING, root, 3, 2.0),
            (Gear.DRIVING, pitting, 4, 1.2),
            (Gear.DRIVEN, root, 5, 1.5),
            (Gear.DRIVEN, pitting, 6, 1.9),
        )
    ]
    rated._gears(Made(), Made(strength=None, weakest=weakest))
    _, gears, position, words = drawn[0]
    assert gears[Gear.DRIVING].share == pytest.approx([2.0, 1.2])
    assert (gears[Gear.DRIVING].named, gears[Gear.DRIVEN].named, position) == (4, 5, 1.2)
    assert "tooth 4 of the driving gear" in words


@pytest.mark.judges("files")
def test_marks_are_whole_where_all_values_are() -> None:
    assert _ticks(np.array([1.0, 2.0]))._integer
    assert not _ticks(np.array([1.0, 2.5]))._integer
