"""What is told of a train of gears: the answer of a command, and the figures of its summary."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import degrees
from typing import Any

from ncgear.figures.advice.verdict import GOOD, GOOD_AS_JUDGED, State
from ncgear.figures.answers.answer import Answer, Fault, Row
from ncgear.figures.numbers import micrometres, placed, to_digits
from ncgear.trains.contact import Distance, MeshContact, distances_of, worst
from ncgear.trains.train import Train, TrainCondition

ALLOWED_TOLERANCES = 3.0
"""Penetration and gap that chords may leave, in chord tolerances: one of each outline, and one of the place between."""


def train_figures(name: str, description: str, train: Train, conditions: Sequence[TrainCondition]) -> dict[str, Any]:
    """The figures of a train: what it is made of, what its kind tells, and whether its conditions hold."""
    parts = [
        {
            "name": part.name,
            "teeth": part.teeth,
            "face_width_mm": part.face_width_mm,
            "low_mm": part.low_mm,
            "bore_mm": part.bore_mm,
            "fixed_to": part.fixed_to or None,
            "reach_mm": part.reach_mm,
        }
        for part in train.parts
    ]
    return {
        "design": {"name": name, "description": description},
        "train": {"driving": train.driving, "speed_rpm": train.speed_rpm, **train.told.figures},
        "parts": parts,
        "verdict": [_row(condition) for condition in conditions],
    }


def _row(condition: TrainCondition) -> dict[str, Any]:
    """A condition, with the keys that conditions of machines have, and what would help."""
    state = State.NOT_JUDGED if condition.holds is None else State.KEPT if condition.holds else State.BROKEN
    return {
        "condition": condition.name,
        "stage": None,
        "holds": condition.holds,
        "says": f"{condition.name}: {condition.said}",
        "verdict": str(state),
        "because": "; ".join(condition.cures),
        "remark": "",
    }


def contact_figures(contacts: Sequence[MeshContact], distances: Sequence[Distance]) -> dict[str, Any]:
    """The meshes and the room between other parts as written, by polygons."""
    return {"meshes": list(map(vars, contacts)), "room": list(map(vars, distances))}


def judged_contacts(
    train: Train, contacts: Sequence[MeshContact], distances: Sequence[Distance]
) -> tuple[TrainCondition, ...]:
    """Whether all meshes touch without overlap, and whether all other parts pass each other."""
    allowed = ALLOWED_TOLERANCES * train.tolerance_mm
    clashing = [contact for contact in contacts if contact.clashes(allowed)]
    parted = [contact for contact in contacts if contact.parts(allowed)]
    deepest, widest = worst(contacts)
    met = f"teeth overlap by {micrometres(deepest)} and part by {micrometres(widest)} at most"
    said = [
        *(
            _meets(contact, "overlap by", contact.penetration_max_mm, contact.penetration_max_at_rad)
            for contact in clashing
        ),
        *(_meets(contact, "part by", contact.gap_max_mm, contact.gap_max_at_rad) for contact in parted),
    ]
    return TrainCondition("meshes", not said, "; ".join(said) or met), judged_room(distances), TEETH


def judged_room(distances: Sequence[Distance]) -> TrainCondition:
    """Whether all parts that do not mesh pass each other."""
    touching = [distance for distance in distances if distance.least_distance_mm <= 0.0]
    room = [
        f"{distance.first} and {distance.second} meet at {placed(degrees(distance.at_rad))} deg"
        for distance in touching
    ]
    least = min(distances, key=lambda distance: distance.least_distance_mm, default=None)
    passing = "no parts at one height come near to each other"
    if least is not None:
        near = f"{least.first} and {least.second} pass at {to_digits(least.least_distance_mm, 3)} mm"
        passing = f"{near}, all others farther apart"
    return TrainCondition("room", not room, "; ".join(room) or passing)


def _meets(contact: MeshContact, how: str, value_mm: float, at_rad: float) -> str:
    return f"{contact.first} and {contact.second} {how} {to_digits(value_mm, 3)} mm at {placed(degrees(at_rad))} deg"


TEETH = TrainCondition(
    "teeth", None, "undercut, tips and strength: for chains and planetary trains without a ring, ncgear strength"
)
"""What neither a check nor a build of a train says of its teeth."""


def checked_conditions(train: Train) -> tuple[TrainCondition, ...]:
    """What a check without files judges, and what it leaves to a build."""
    room = judged_room(distances_of(train, {part.name: part.outline_mm for part in train.parts}))
    return *train.told.conditions, room, TEETH, TrainCondition("meshes", None, "polygons are compared in a build")


def train_answer(name: str, description: str, train: Train, conditions: Sequence[TrainCondition], then: str) -> Answer:
    """The answer about a train on one screen."""
    rows = [Row(label, (text,)) for label, text in train.told.rows]
    rows += [Row(condition.name, (condition.said,)) for condition in conditions if condition.holds]
    unknown = [f"{condition.name} ({condition.said})" for condition in conditions if condition.holds is None]
    return Answer(
        f"{name}: {train.told.head}",
        tuple(rows),
        tuple(
            Fault(f"{condition.name}: {condition.said}", condition.cures)
            for condition in conditions
            if condition.holds is False
        ),
        about=description,
        good=GOOD_AS_JUDGED if unknown else GOOD,
        not_judged=f"Not judged: {', '.join(unknown)}." if unknown else "",
        then=then,
    )


def poses_figures(train: Train, driving_rad: Any) -> Mapping[str, Any]:
    """The poses of all parts at driving angles, for ``assembly.json``."""
    poses = train.poses_at(driving_rad)
    return {
        "driving": train.driving,
        "driving_rad": driving_rad.tolist(),
        "meshes": [{"first": mesh.first, "second": mesh.second, "kind": mesh.kind.value} for mesh in train.meshes],
        "parts": [
            {
                "name": part.name,
                "fixed_to": part.fixed_to or None,
                "z_mm": part.low_mm,
                "x_mm": poses.x_mm[number].tolist(),
                "y_mm": poses.y_mm[number].tolist(),
                "angle_rad": poses.angle_rad[number].tolist(),
            }
            for number, part in enumerate(train.parts)
        ],
    }
