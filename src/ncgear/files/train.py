"""The files of a train: outlines and solids of all parts, poses, pictures, the moving train, summary and verdict.

Contact is judged on the outlines as written, read back from the tables.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from shapely import Polygon

from ncgear.drawings.palette import LIGHT
from ncgear.drawings.solid_pair import METRE_PER_MM, SURFACE, Y_UP, linear_light
from ncgear.errors import Unanswered
from ncgear.figures.numbers import json_text
from ncgear.figures.tables import csv_text, outline_csv
from ncgear.figures.trains import contact_figures, judged_contacts, poses_figures, train_figures
from ncgear.files.read_back import outline_of_csv, stl_bytes
from ncgear.files.workshop.solid_files import PlacedBody, archive, mesh_text, moving
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.plane import as_complex, as_points
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.solids.mesh.slabs import slab_mesh
from ncgear.solids.mesh.triangles import TriangleMesh
from ncgear.solids.plan.body import Slab, circle_points
from ncgear.trains.contact import contacts_of, distances_of
from ncgear.trains.train import Part, Train, TrainCondition

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from trimesh import Trimesh

POSES = 720
"""Steps of ``assembly.json`` for each turn of the driving angle in a cycle, whose end is included."""

FRAMES = 240
"""Steps of the animation for each such turn."""

STEPS = ("outlines", "contact", "solids", "drawings", "pictures")
"""The steps of a build of a train."""

JUDGING = STEPS[:2]
"""The steps that judge a train."""


@dataclass(frozen=True, eq=False)
class JudgedTrain:
    """A train's outlines as written, its figures, and its conditions with those of the written outlines."""

    train: Train
    outlines_mm: Mapping[str, Array]
    figures: dict[str, Any]
    conditions: tuple[TrainCondition, ...]


def judged_train(name: str, description: str, train: Train, on_step: Callable[[str], None]) -> JudgedTrain:
    """A train with the contact of its outlines, which are written and read back."""
    on_step(STEPS[0])
    read = {first: outline_of_csv(_outline(train.part(first))) for first in {*train.alike.values()}}
    outlines = {name: read[first] for name, first in train.alike.items()}
    on_step(STEPS[1])
    contacts, distances = contacts_of(train, outlines), distances_of(train, outlines)
    conditions = (*train.told.conditions, *judged_contacts(train, contacts, distances))
    figures = train_figures(name, description, train, conditions) | contact_figures(contacts, distances)
    return JudgedTrain(train, outlines, figures, conditions)


def _outline(part: Part) -> bytes:
    return outline_csv(part.outline_mm).encode()


def train_files(name: str, judged: JudgedTrain, on_step: Callable[[str], None]) -> dict[str, bytes]:
    """All files of a train by their names.

    Raises Unanswered where a solid is faulty or its file holds another solid.
    """
    train, outlines = judged.train, judged.outlines_mm
    on_step(STEPS[2])
    # Equal planets are made once
    made = {first: _solid(train.part(first), outlines[first], train.tolerance_mm) for first in {*train.alike.values()}}
    written = {first: stl_bytes(solid) for first, solid in made.items()}
    solids = {name: made[first] for name, first in train.alike.items()}
    files = {f"{part.name}.csv": _outline(part) for part in train.parts}
    files |= {f"{name}.stl": written[first] for name, first in train.alike.items()}
    files |= {"train.3mf": _threemf(train, made), "train.glb": _glb(train, solids)}
    on_step(STEPS[3])
    from ncgear.files.workshop.dxf import dxf_bytes
    from ncgear.files.workshop.sheet_files import drawing_files
    from ncgear.files.workshop.svg import svg_bytes
    from ncgear.files.workshop.train_drawings import train_drawings

    drawings = train_drawings(name, train, outlines)
    for part, drawing in drawings.parts.items():
        files[f"{part}.dxf"] = dxf_bytes({"": drawing.cut}, drawing.notes, in_sight=False)
        files[f"{part}.svg"] = svg_bytes(drawing)
    files |= drawing_files(drawings.sheets)
    on_step(STEPS[4])
    from ncgear.drawings.train_pictures import meshes_picture, train_picture

    angles = np.linspace(0.0, train.cycle_rad, POSES * train.turns + 1)
    return files | {
        "assembly.json": json_text(poses_figures(train, angles)).encode(),
        "summary.json": json_text(judged.figures).encode(),
        "train.png": train_picture(train, outlines, 0.0, name),
        "meshes.png": meshes_picture(train, outlines, f"{name}: every mesh as assembled"),
        **{f"{trace.name}.csv": _trace_csv(train, trace.name, angles) for trace in train.traces},
    }


def _trace_csv(train: Train, name: str, angles: Array) -> bytes:
    trace = next(trace for trace in train.traces if trace.name == name)
    return csv_text(("driving_rad", "x_mm", "y_mm"), [angles, *train.trace_mm(trace, angles).T]).encode()


def _solid(part: Part, outline_mm: Array, tolerance_mm: float) -> Trimesh:
    """A part as a closed solid in its own frame, from z = 0 up; a ring is open inside its outline."""
    holes = [hole.x_mm + 1j * hole.y_mm + _circle(hole.diameter_mm, tolerance_mm) for hole in part.holes]
    if part.bore_mm is not None:
        holes.append(_circle(part.bore_mm, tolerance_mm))
    rings = [as_points(hole) for hole in holes]
    section = Polygon(outline_mm, rings)
    if part.rim_mm is not None:
        section = Polygon(circle_points(part.reach_mm, tolerance_mm), [outline_mm])
    try:
        return slab_mesh((Slab(section, 0.0, part.face_width_mm),)).as_trimesh()
    except Unanswered as fault:
        problem = f"{part.name}: {fault.problem}; module_mm and face_width_mm nearer to each other are right"
        raise Unanswered(problem, key="train.gears") from fault


def _circle(diameter_mm: float, tolerance_mm: float) -> ComplexArray:
    return as_complex(circle_points(diameter_mm / 2.0, tolerance_mm))


def _threemf(train: Train, made: Mapping[str, Trimesh]) -> bytes:
    """All parts in one file for slicers, as assembled at the driving angle 0."""
    poses = train.assembled
    bodies = [
        PlacedBody(
            part.name,
            train.alike[part.name],
            float(poses.x_mm[number, 0]),
            float(poses.y_mm[number, 0]),
            part.low_mm,
            float(poses.angle_rad[number, 0]),
        )
        for number, part in enumerate(train.parts)
    ]
    return archive({name: mesh_text(TriangleMesh(solid.vertices, solid.faces)) for name, solid in made.items()}, bodies)


def _glb(train: Train, solids: Mapping[str, Trimesh]) -> bytes:
    """The whole train as binary glTF, moving over a cycle at the speed of its driving part."""
    from trimesh import Scene
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    scene, angles = Scene(), np.linspace(0.0, train.cycle_rad, FRAMES * train.turns + 1)
    poses = train.poses_at(angles)
    ways = {}
    for number, part in enumerate(train.parts):
        mesh, place = solids[part.name].copy(), np.eye(4)
        color = LIGHT[COLORS[number % len(COLORS)] if part.teeth else "uniform"]
        mesh.visual = TextureVisuals(
            material=PBRMaterial(name=part.name, baseColorFactor=[*linear_light(color), 1.0], **SURFACE)
        )
        place[:3, :3] = METRE_PER_MM * Y_UP
        scene.add_geometry(mesh, node_name=part.name, geom_name=part.name, transform=place)
        low = np.full(angles.size, part.low_mm)
        shift = METRE_PER_MM * np.stack([poses.x_mm[number], poses.y_mm[number], low], axis=-1) @ Y_UP.T
        ways[part.name] = (poses.angle_rad[number], shift)
    seconds = angles / (abs(train.speed_rpm) * RAD_S_PER_RPM)
    return moving(scene.export(file_type="glb"), seconds, ways)


COLORS = ("driving", "driven", "highlight")
"""Names of the colours of gears, in turn."""
