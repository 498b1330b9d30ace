"""What moving pictures and notebooks show, read from their artists and texts: layout, poses, rooms, cameras."""

from __future__ import annotations

import gzip
import re
from base64 import b64decode
from functools import cache
from itertools import combinations
from math import pi, radians, tan

import numpy as np
import pytest
import shapely
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch, Polygon
from scipy.spatial import KDTree

from drives import drive
from ncgear.design.trains.planetary import Planetary
from ncgear.drawings.animation.moving_picture import Picture, picture
from ncgear.drawings.notebook.pieces import picture as outlines_picture
from ncgear.drawings.notebook.pieces import pitch_outlines, running, tooth_outlines
from ncgear.drawings.plots import canvas
from ncgear.drawings.scene.standing import views
from ncgear.drawings.solid_pair import DISTANCE, FIELD_DEG, solid_view
from ncgear.drawings.train_pictures import color_of, meshes_picture, train_frames, train_picture
from ncgear.files.workshop.solid_files import _chunks
from ncgear.numerics.arrays import Array
from ncgear.trains.train import Train
from scenes import drive_of, scene, standing

pytestmark = pytest.mark.judges("drawings")

PUMP = "pump-1-2"

# --- the machine -----------------------------------------------------------------------------------------------------


@cache
def made(name: str, width_px: int) -> Picture:
    return picture(scene(name), width_px)


@pytest.mark.parametrize(("name", "width_px"), [(PUMP, 641), ("askew", 480), ("gearless", 300)])
def test_views_and_charts_stand_beside_and_below_each_other(name: str, width_px: int) -> None:
    """Inside the picture, in both directions to one scale, which is the same for views of one kind of place."""
    found = made(name, width_px)
    figure, boxes = found.figure, [axes.get_position() for axes in found.figure.axes]
    width, height = (size * figure.dpi for size in figure.get_size_inches())
    assert (round(width) % 2, round(height) % 2) == (0, 0)
    assert abs(width - width_px) <= 1.0 + 1e-9
    for one in boxes:
        assert 0.0 < one.x0 < one.x1 < 1.0
        assert 0.0 < one.y0 < one.y1 < 1.0
    for one, other in combinations(boxes, 2):
        assert one.x1 < other.x0 + 1e-9 or other.x1 < one.x0 + 1e-9 or one.y1 < other.y0 or other.y1 < one.y0
    *panels, first, second = figure.axes
    assert len(panels) == (1 if name == "gearless" else 2)
    assert (first.get_position().y0, first.get_position().height) == pytest.approx(
        (second.get_position().y0, second.get_position().height)
    )
    assert min(axes.get_position().y0 for axes in panels) > first.get_position().y1
    # Words above the charts, and the heading above the views.
    assert figure.get_figheight() * (1.0 - max(box.y1 for box in boxes)) > 0.4
    found_views = views(scene(name))
    large = name != "gearless" and found_views["gears"][2] > 0.4 * found_views["machine"][2]
    for axes, key in zip(panels, ("machine", "mesh" if large else "gears"), strict=False):
        left, bottom, wide, high = found_views[key]
        scale = axes.transData.transform([(0.0, 0.0), (1.0, 1.0)])
        across, up = scale[1] - scale[0]
        assert across == pytest.approx(up, rel=1e-9)
        (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
        assert (x0 <= left + 1e-9, x1 >= left + wide - 1e-9, y0 <= bottom + 1e-9, y1 >= bottom + high - 1e-9) == (
            (True,) * 4
        )
        # The box fills its axes in one direction, unless the views are as high as they may be.
        assert (x1 - x0) / wide == pytest.approx(1.0) or (y1 - y0) / high == pytest.approx(1.0)


def test_moving_parts_take_the_pose_of_their_frame() -> None:
    found, one = made(PUMP, 640), scene(PUMP)
    phi1 = np.array([0.3, 2.0, 7.5])
    poses = one.poses(phi1)
    machine, beside, *charts = found.figure.axes
    for row in range(3):
        for moving in found.moving:
            moving.pose(poses, row)
        numbers = [text for text in found.figure.texts if re.fullmatch(r"-?\d+\.\d", text.get_text())]
        phi2 = drive_of(PUMP).pair.transmission.driven_angle(phi1[[row]]).value[0]
        assert [float(text.get_text()) for text in numbers] == pytest.approx(
            np.degrees([phi1[row], phi2]).tolist(), abs=0.0501
        )
        # In their words: each before its own sign of degrees, of letters that are all as wide.
        (words,) = (text for text in found.figure.texts if text.get_text().startswith("phi1 "))
        letter = words.get_window_extent().width / len(words.get_text())
        # In the upper right corner, an eighth of an inch from both edges or so, like the heading in the left one.
        corner = found.figure.bbox.corners()[3] - np.array([words.get_window_extent().x1, words.get_window_extent().y1])
        assert corner == pytest.approx(0.12 * found.figure.dpi, abs=0.06 * found.figure.dpi)
        end = words.get_window_extent().x1
        for text, place in zip(
            numbers, (i for i, sign in enumerate(words.get_text()) if sign == "\u00b0"), strict=True
        ):
            assert text.get_window_extent().x1 == pytest.approx(
                end - letter * (len(words.get_text()) - place), abs=0.6 * letter
            )
        motion = drive_of(PUMP).machine.motion(phi1[[row]])
        for axes, value in zip(charts, (motion.displacement[0], motion.velocity[0]), strict=True):
            (dot,) = (line for line in axes.get_children() if isinstance(line, Line2D) and line.get_marker() == "o")
            x, y = np.array(dot.get_xydata())[0]
            assert x == pytest.approx(np.degrees(phi1[row]))
            most = np.abs(np.concatenate([line.get_ydata() for line in axes.lines if len(line.get_ydata()) > 9])).max()
            assert y == pytest.approx(value, abs=0.006 * most)
            assert any(
                text.get_text() and float(text.get_text()) == pytest.approx(y)
                for text in axes.texts
                if re.fullmatch(r"-?[\d.]+", text.get_text())
            )
        # Every body where its pose says, and the gears of the mesh about the pitch point.
        for axes, middle in ((machine, np.zeros(2)), (beside, poses.pitch_points_mm[-1][row])):
            paths = [on_axes(axes, patch) for patch in axes.patches if isinstance(patch, PathPatch)]
            for name, contours in bodies().items():
                wanted = KDTree(standing(poses.places[name], contours, row) - middle)
                off = [wanted.query(path)[0].max() for path in paths]
                assert (axes is beside and not name.startswith("driv")) or min(off) < 1e-9, (name, row)


def on_axes(axes: Axes, patch: PathPatch) -> Array:
    """The points of a path in mm of the view."""
    return axes.transData.inverted().transform(patch.get_transform().transform(patch.get_path().vertices))


def bodies() -> dict[str, Array]:
    """The points of links and gears, by their names."""
    one = scene(PUMP)
    return {body.name: np.vstack(body.contours_mm) for body in (*one.links, *(gear.body for gear in one.gears))}


def test_outlines_lose_points_but_stray_by_less_than_a_pixel() -> None:
    machine = made(PUMP, 640).figure.axes[0]
    pixel_mm = np.ptp(machine.get_xlim()) / machine.bbox.width
    paths = [patch.get_path().vertices for patch in machine.patches if isinstance(patch, PathPatch)]
    for gear in scene(PUMP).gears:
        exact = gear.body.contours_mm[0]
        (drawn,) = (path for path in paths if (path[0] == exact[0]).all())
        ring = drawn[: 2 + int(np.argmin(np.hypot(*(drawn[1:] - drawn[0]).T)))]
        away = shapely.distance(shapely.points(exact), shapely.LineString(ring))
        assert 0.0 < away.max() <= 0.1 * pixel_mm
        assert len(ring) < 0.8 * len(exact)


def test_numbers_of_teeth_stand_below_their_own_teeth() -> None:
    """On the pitch curve halfway between both flanks, and 2.2 modules below it."""
    for gear in scene(PUMP).gears:
        own = drive_of(PUMP).teeth.of(gear.gear)
        module = own.flanks.rack.module_mm
        hand = np.array([1.0, gear.mounting.hand])
        sides = own.flanks.flank(np.arange(2 * own.teeth), np.zeros(2 * own.teeth))[0].reshape(-1, 2, 2) * hand
        assert np.hypot(*(gear.teeth_mm - sides.mean(axis=1)).T).max() < 0.05 * module
        down = np.hypot(*(gear.numbers_mm - gear.teeth_mm).T)
        assert down == pytest.approx(2.2 * module, rel=1e-9)
        assert (np.hypot(*gear.numbers_mm.T) < np.hypot(*gear.teeth_mm.T)).all()


# --- trains ----------------------------------------------------------------------------------------------------------


@cache
def train() -> Train:
    gears = {"teeth": 18, "module_mm": 2.0, "face_width_mm": 8.0, "backlash_mm": 0.05}
    keys = {"speed_rpm": 60.0, "ratio": [1.2, 1.0, 0.9, 1.0], "gears": gears, "idler": "shared", "sun_turns": 0.0}
    return Planetary.model_validate(keys).train()


def test_a_train_is_shown_with_all_its_parts_in_the_pose_of_the_frame() -> None:
    one = train()
    figure = train_frames(one, "title", 401)
    frames = figure(3)
    next(frames), next(frames)
    axes = frames.gi_frame.f_locals["drawn"].figure.axes[0]  # type: ignore[attr-defined]
    width, height = (size * axes.figure.dpi for size in axes.figure.get_size_inches())
    assert (round(width) % 2, round(height) % 2, abs(width - 401) <= 1.0 + 1e-9) == (0, 0, True)
    across, up = axes.transData.transform((1.0, 1.0)) - axes.transData.transform((0.0, 0.0))
    assert across == pytest.approx(up, rel=1e-9)
    # The heading is above the axes, which the room of all poses fills.
    assert axes.figure.get_figheight() * (1.0 - axes.get_position().y1) == pytest.approx(0.4, rel=0.1)
    box = axes.get_position(original=True)
    filled = (box.height * height) / (box.width * width)
    assert filled == pytest.approx(np.ptp(axes.get_ylim()) / np.ptp(axes.get_xlim()), rel=0.01)
    turned = one.poses_at(np.array([one.cycle_rad / 3.0]))
    patches = [patch for patch in axes.patches if isinstance(patch, Polygon)]
    assert len(patches) == len(one.parts)
    left, right = axes.get_xlim()
    low, high = axes.get_ylim()
    for patch, part in zip(patches, sorted(one.parts, key=lambda part: part.low_mm), strict=True):
        number = one.number(part.name)
        (axis,), (turn,) = turned.places(number)
        wanted = axis + turn * (part.outline_mm @ np.array([1.0, 1.0j]))
        points = axes.transData.inverted().transform(patch.get_transform().transform(patch.get_xy()))
        assert points[: len(wanted)] == pytest.approx(np.column_stack([wanted.real, wanted.imag]), abs=1e-9)
        assert (left < points[:, 0].min(), points[:, 0].max() < right) == (True, True)
        assert (low < points[:, 1].min(), points[:, 1].max() < high) == (True, True)
    for mesh in one.meshes:
        assert color_of(one, one.part(mesh.first)) != color_of(one, one.part(mesh.second))


def test_pictures_of_a_train_show_each_mesh_once_and_every_part(monkeypatch: pytest.MonkeyPatch) -> None:
    one, kept = train(), []
    monkeypatch.setattr(canvas, "png", lambda made: kept.append(made) or b"")
    outlines = {part.name: part.outline_mm for part in one.parts}
    train_picture(one, outlines, 0.7, "title")
    meshes_picture(one, outlines, "title")
    whole, meshes = kept
    (axes,) = whole.axes
    poses = one.poses_at(np.array([0.7]))
    outlines_drawn = [np.array(line.get_xydata()) for line in axes.lines if line.get_marker() == "None"]
    for number, part in enumerate(one.parts):
        (axis,), (turn,) = poses.places(number)
        placed = axis + turn * (part.outline_mm @ np.array([1.0, 1.0j]))
        wanted = np.column_stack([placed.real, placed.imag])
        (drawn,) = (line for line in outlines_drawn if len(line) == len(wanted) + 1 and np.allclose(line[:-1], wanted))
        assert (drawn[0] == drawn[-1]).all()
    assert len(meshes.axes) == len(one.meshes)
    for cell, mesh in zip(meshes.axes, one.meshes, strict=True):
        first, second = cell.get_title().splitlines()
        for said, name in ((first, mesh.first), (second, mesh.second)):
            angle = np.degrees(one.poses_at(np.zeros(1)).angle_rad[one.number(name), 0])
            match = re.fullmatch(rf"{name}, 18 teeth, at ([\d.]+) deg", said)
            assert match
            assert (float(match[1]) - angle + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=6e-4)
    rows = sorted({round(cell.get_position().y0, 6) for cell in meshes.axes})
    assert len(rows) == -(-len(one.meshes) // 3)


# --- notebooks -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [PUMP, "internal-1-2"])
def test_outlines_in_a_notebook_fit_in_their_box_with_y_up(name: str) -> None:
    one = drive(name)
    for outlines in (pitch_outlines(one.pitch), *([tooth_outlines(one.teeth)] if name == PUMP else [])):
        html = str(outlines_picture(outlines, "gears"))
        (box,) = re.findall(r'viewBox="([^"]+)"', html)
        left, top, width, height = map(float, box.split())
        points = np.vstack([one.contours_mm[0] + np.array([one.axis_mm, 0.0]) for one in outlines])
        low, high = points.min(axis=0), points.max(axis=0)
        assert (left + width / 2.0, -top - height / 2.0) == pytest.approx(
            tuple((low + high) / 2.0), abs=1e-5 * np.ptp(points)
        )
        assert (width, height) == pytest.approx(tuple(1.04 * (high - low)), rel=1e-5)
        # The larger one behind, as a ring is, which is a tenth larger than its curve.
        (behind, *_) = re.findall(r'transform="translate\((\S+) 0\)"', html)
        assert float(behind) == pytest.approx(one.pitch.center_distance_mm, rel=1e-5)
        if name != PUMP:
            ring, curve = outlines[1].contours_mm
            assert np.hypot(*ring.T) == pytest.approx(1.1 * np.hypot(*curve.T).max())
        # Paths are in whole steps, of a five-thousandth of the picture or finer.
        steps = {float(step) for step in re.findall(r'transform="scale\((\S+)\)" d=', html)}
        assert 5e-6 * max(width, height) < max(steps) <= 2e-4 * max(width, height)


def test_a_machine_in_a_notebook_runs_a_turn_in_five_seconds() -> None:
    one = scene(PUMP)
    html = str(running(one))
    (seconds,) = {float(found) for found in re.findall(r"animation: ([\d.]+)s linear", html)}
    assert seconds == pytest.approx(10.0)
    frames = re.findall(r"@keyframes \S+-slider\{(.*?\})\}", html)
    (found,) = frames
    steps = re.findall(r"([\d.]+)%\{transform:translate\((\S+?)px,(\S+?)px\)", found)
    shares = np.array([float(share) for share, _, _ in steps]) / 100.0
    assert len(steps) == 2 * 96 + 1
    assert shares == pytest.approx(np.linspace(0.0, 1.0, 193), abs=6e-6)
    motion = drive_of(PUMP).machine.motion(np.linspace(0.0, 4.0 * pi, 193))
    places = np.array([float(x) for _, x, _ in steps])
    assert places - drive_of(PUMP).linkage.nearest_mm == pytest.approx(motion.displacement, abs=1e-3)


# --- in 3D -----------------------------------------------------------------------------------------------------------


def test_the_camera_of_a_pair_sees_all_of_it_from_above_and_nearby() -> None:
    one = drive(PUMP)
    html = gzip.decompress(b64decode(solid_view(one.solids, one.pitch.center_distance_mm, "").packed)).decode()
    (data,) = re.findall(r'base64_data="([^"]+)"', html)
    content, _ = _chunks(b64decode(data))
    nodes = {
        node.get("name"): np.array(node.get("matrix", np.eye(4).ravel())).reshape(4, 4).T for node in content["nodes"]
    }
    camera = nodes["camera"]
    assert camera[:3, :3] @ camera[:3, :3].T == pytest.approx(np.eye(3), abs=1e-9)
    corners = []
    for name, solid in (("driving", one.solids.driving), ("driven", one.solids.driven)):
        points = np.asarray(solid.mesh.vertices)
        corners.append(points @ nodes[name][:3, :3].T + nodes[name][:3, 3])
    points = np.vstack(corners)
    seen = (points - camera[:3, 3]) @ camera[:3, :3]
    away = -seen[:, 2]
    assert (away > 0.0).all()
    assert np.abs(seen[:, 0] / away).max() < tan(radians(FIELD_DEG[0] / 2.0))
    assert np.abs(seen[:, 1] / away).max() < tan(radians(FIELD_DEG[1] / 2.0))
    low, high = points.min(axis=0), points.max(axis=0)
    assert np.hypot(*[np.linalg.norm(camera[:3, 3] - (low + high) / 2.0), 0.0]) == pytest.approx(
        DISTANCE * np.linalg.norm(high - low), rel=1e-4
    )
    # y is up in glTF: the camera is above the gears, which lie.
    assert camera[1, 3] > high[1]
