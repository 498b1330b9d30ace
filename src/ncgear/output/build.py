"""A build: every stage of the drive in turn, then all its files at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from ncgear.contact.pair_contact import PairContact
from ncgear.drive import Drive
from ncgear.output import plots
from ncgear.output.joints import joints_up_to
from ncgear.output.json_text import json_text
from ncgear.output.publish import prepare, publish
from ncgear.output.stl import stl_bytes
from ncgear.output.summary import build_summary
from ncgear.output.tables import contact_csv, law_csv, outline_csv
from ncgear.output.written import written_outlines
from ncgear.pitch.curve import CurvePoints, PitchCurve
from ncgear.recipe.gears import rim_mm_of
from ncgear.solids.assembly import Placed, assembly_report
from ncgear.solids.ring import outer_radius_mm

STAGES = {
    "motion": ("motion", "uniform_motion"),
    "pitch curves": ("pitch",),
    "teeth": ("teeth",),
    "contact": ("designed_contact",),
    "solids": ("solids",),
}
"""Stages in order and the attributes of the drive whose first use computes them."""

CURVE_POINTS = 1500
"""Points of a drawn pitch curve: 0.2 mm apart on a screen-wide gear of 300 mm."""

POSITIONS = 3
"""Positions of the pair in the picture of its teeth, evenly spread over a turn of the driving gear."""


@dataclass(frozen=True)
class Built:
    """What a build has done: the files it wrote and the summary of every pair of gears that it wrote among them."""

    paths: list[Path]
    summaries: list[dict[str, Any]]


def build(drive: Drive, folder: Path, on_stage: Callable[[str], None]) -> Built:
    """Compute everything, and write all files into ``folder``, which is created if need be.

    Two stages go into folders ``stage-1`` and ``stage-2`` of it, at the same instant. ``on_stage`` is told what is done
    before it begins. Raises WrongInput or NoSuchMechanism from the stages, and WrongInput when the folder cannot be
    written; whatever fails, the last good build in ``folder`` stays.
    """
    prepare(folder)
    pairs = {_place(pair.stage): _made(pair, _named(pair, on_stage)) for pair in drive.by_stage}
    files = {place + name: content for place, (own, _) in pairs.items() for name, content in own.items()}
    # A folder may hold an earlier build of the other number of stages.
    obsolete = [_place(stage) + name for stage in (None, 1, 2) for own, _ in pairs.values() for name in own]
    return Built(publish(folder, files, obsolete), [summary for _, summary in pairs.values()])


def _place(stage: int | None) -> str:
    """What stands before the names of a pair's files."""
    return "" if stage is None else f"stage-{stage}/"


def _named(pair: Drive, on_stage: Callable[[str], None]) -> Callable[[str], None]:
    """Tell which of two pairs is at work."""
    return on_stage if pair.stage is None else lambda done: on_stage(f"stage {pair.stage}: {done}")


def _made(drive: Drive, on_stage: Callable[[str], None]) -> tuple[dict[str, bytes], dict[str, Any]]:
    """The files of one pair of gears, the summary among them, and the summary itself."""
    for stage, attributes in STAGES.items():
        on_stage(stage)
        for attribute in attributes:
            getattr(drive, attribute)
    with _timed(drive, "files", on_stage):
        files = {**_tables(drive), **_meshes(drive), "assembly.json": json_text(_assembly(drive)).encode()}
    with _timed(drive, "written contact", on_stage):
        ring, helical = drive.pitch.driven.is_ring, drive.helix is not None
        contact = drive.contact(written_outlines(files, ring=ring, helical=helical))
        files["contact.csv"] = contact_csv(contact).encode()
    with _timed(drive, "plots", on_stage):
        files.update(_pictures(drive, contact))
    # Last: only now are the timings known, and a summary is then never newer in its folder than what it sums up.
    summary = build_summary(drive, contact)
    return {**files, "summary.json": json_text(summary).encode()}, summary


@contextmanager
def _timed(drive: Drive, stage: str, on_stage: Callable[[str], None]) -> Iterator[None]:
    on_stage(stage)
    with drive.stopwatch(stage):
        yield


def _tables(drive: Drive) -> dict[str, bytes]:
    return {
        "law.csv": law_csv(drive.motion).encode(),
        "driving.csv": outline_csv(drive.teeth.driving.outline_mm).encode(),
        "driven.csv": outline_csv(drive.teeth.driven.outline_mm).encode(),
    }


def _meshes(drive: Drive) -> dict[str, bytes]:
    return {
        "driving.stl": stl_bytes(drive.solids.driving.mesh),
        "driven.stl": stl_bytes(drive.solids.driven.mesh),
    }


def _assembly(drive: Drive) -> dict[str, Any]:
    """How the gears go together at phi1 = 0."""
    pitch, teeth, solids = drive.pitch, drive.teeth, drive.solids
    driven_radius, is_ring = _pitch_radius(pitch.driven), pitch.driven.is_ring
    return assembly_report(
        Placed(teeth.driving.outline_mm, _pitch_radius(pitch.driving), solids.driving.index_hole),
        Placed(teeth.driven.outline_mm, driven_radius, solids.driven.index_hole, is_ring),
        pitch.center_distance_mm,
        pitch.size.module_mm,
        pitch.mesh,
    )


def _pitch_radius(curve: PitchCurve) -> float:
    """On the line of centres at phi1 = 0."""
    return float(np.linalg.norm(curve.at_angle(np.zeros(1)).position))


def _ring_radius(drive: Drive) -> float | None:
    """Outer radius of a driven ring; None for an external pair."""
    if not drive.pitch.driven.is_ring:
        return None
    return outer_radius_mm(drive.teeth.driven.outline_mm, rim_mm_of(drive.gears, drive.pitch.size.module_mm))


def _pictures(drive: Drive, contact: PairContact) -> dict[str, bytes]:
    name, speed = drive.design.name, drive.design.operation.speed_rpm
    tables = drive.motion, drive.uniform_motion
    joints = joints_up_to(drive.transmission, float(drive.motion.phi1_rad[-1]))
    all_joints = joints_up_to(drive.pair.transmission, contact.as_designed.placement.cycle_rad)
    return {
        "pitch_curves.png": _pitch_curves(drive),
        "tooth_pair.png": _tooth_pair(drive),
        "motion.png": plots.motion(*tables, f"{name}: motion at {speed:.4g} r/min", joints),
        "contact.png": plots.contact(contact, f"{_title(drive)}: contact of the teeth", all_joints),
        "power.png": plots.power(*tables, f"{name}: force and power at {speed:.4g} r/min", joints),
    }


def _title(drive: Drive) -> str:
    """Of pictures that show one pair of gears."""
    return drive.design.name if drive.stage is None else f"{drive.design.name}, stage {drive.stage} by its own angles"


def _pitch_curves(drive: Drive) -> bytes:
    driving, driven = (_closed_curve(curve) for curve in (drive.pitch.driving, drive.pitch.driven))
    return plots.pitch_curves(
        driving.position,
        driven.position,
        drive.pitch.center_distance_mm,
        driving.curvature < 0.0,
        driven.curvature > 0.0 if drive.pitch.driven.is_ring else driven.curvature < 0.0,
        f"{_title(drive)}: pitch curves at phi1 = 0",
        ring_radius_mm=_ring_radius(drive),
    )


def _tooth_pair(drive: Drive) -> bytes:
    return plots.tooth_pair(
        drive.teeth.driving.outline_mm,
        drive.teeth.driven.outline_mm,
        drive.pitch.center_distance_mm,
        drive.pitch.size.module_mm,
        _positions(drive),
        f"{_title(drive)}: tooth outlines in mesh",
        ring_radius_mm=_ring_radius(drive),
    )


def _positions(drive: Drive) -> list[plots.Position]:
    phi1 = np.linspace(0.0, 2.0 * pi, POSITIONS, endpoint=False)
    phi2 = drive.pair.transmission.driven_angle(phi1).value
    point = drive.pitch.pitch_point_mm(phi1)
    return [plots.Position(float(a), float(b), float(x)) for a, b, x in zip(phi1, phi2, point, strict=True)]


def _closed_curve(curve: PitchCurve) -> CurvePoints:
    return curve.at_angle(np.linspace(0.0, curve.turn_rad, CURVE_POINTS))
