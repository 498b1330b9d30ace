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
from ncgear.files.workshop.solid_files import moving
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.plane import as_complex, as_points
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.solids.mesh.slabs import slab_mesh
from ncgear.solids.plan.body import Slab, circle_points
from ncgear.trains.contact import contacts_of, distances_of
from ncgear.trains.train import Part, Train, TrainCondition

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from trimesh import Trimesh

POSES = 721
"""Driving angles of ``assembly.json``, from 0 to a cycle, both included."""

FRAMES = 241
"""Keys of the animation over a cycle."""

STEPS = ("outlines", "solids", "contact", "pictures")
"""The steps of a build of a train."""


@dataclass(frozen=True, eq=False)
class BuiltTrain:
    """The files of a train by their names, its figures, and its conditions with the conditions of the written files."""

    files: Mapping[str, bytes]
    figures: dict[str, Any]
    conditions: tuple[TrainCondition, ...]


def build_train(name: str, description: str, train: Train, on_step: Callable[[str], None]) -> BuiltTrain:
    """All files of a train; raises Unanswered where a solid is faulty or its file holds another solid."""
    on_step(STEPS[0])
    files = {f"{part.name}.csv": outline_csv(part.outline_mm).encode() for part in train.parts}
    outlines = {part.name: outline_of_csv(files[f"{part.name}.csv"]) for part in train.parts}
    on_step(STEPS[1])
    solids: dict[str, Trimesh] = {}
    alike: dict[object, Trimesh] = {}
    for part in train.parts:
        # Equal planets are made once.
        body = files[f"{part.name}.csv"], part.face_width_mm, part.bore_mm, part.rim_mm, part.holes
        if body not in alike:
            alike[body] = _solid(part, outlines[part.name], train.tolerance_mm)
        solids[part.name] = alike[body]
    files |= {f"{name}.stl": stl_bytes(solid) for name, solid in solids.items()}
    on_step(STEPS[2])
    contacts, distances = contacts_of(train, outlines), distances_of(train, outlines)
    conditions = (*train.told.conditions, *judged_contacts(train, contacts, distances))
    on_step(STEPS[3])
    from ncgear.drawings.train_pictures import meshes_picture, train_picture

    figures = train_figures(name, description, train, conditions) | contact_figures(contacts, distances)
    angles = np.linspace(0.0, train.cycle_rad, POSES)
    files |= {
        "assembly.json": json_text(poses_figures(train, angles)).encode(),
        "summary.json": json_text(figures).encode(),
        "train.png": train_picture(train, outlines, 0.0, name),
        "meshes.png": meshes_picture(train, outlines, f"{name}: every mesh as assembled"),
        "train.glb": _glb(train, solids),
        **{f"{trace.name}.csv": _trace_csv(train, trace.name, angles) for trace in train.traces},
    }
    return BuiltTrain(files, figures, conditions)


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


def _glb(train: Train, solids: Mapping[str, Trimesh]) -> bytes:
    """The whole train as binary glTF, moving over a cycle at the speed of its driving part."""
    from trimesh import Scene
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    scene, angles = Scene(), np.linspace(0.0, train.cycle_rad, FRAMES)
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
