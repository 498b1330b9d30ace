"""A build: every step of the drive in turn, then all its files at once."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ncgear.contact.pair import PairContact
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.drawings.page import REPORT_FILE
from ncgear.drawings.pictures import pictures
from ncgear.figures.csv_text import contact_csv, law_csv, outline_csv
from ncgear.figures.data_sheet.pitch_table import pitch_csv
from ncgear.figures.data_sheet.sheet import data_sheet, sheet_text
from ncgear.figures.numbers import json_text
from ncgear.figures.summary.build_summary import build_summary
from ncgear.files.meshes import stl_bytes, written_outlines
from ncgear.files.publish import prepare, publish
from ncgear.files.workshop.formats import NAMES, workshop_files
from ncgear.files.workshop.kinds import Format
from ncgear.pitch.curve import PitchCurve
from ncgear.project.drive import Drive
from ncgear.solids.assembly import Placed, assembly_report

STEPS = {
    "motion": ("motion", "uniform_motion"),
    "pitch curves": ("pitch",),
    "teeth": ("teeth",),
    "contact": ("designed_contact",),
    "solids": ("solids",),
}
"""Steps in order and the attributes of the drive whose first use computes them."""

WRITTEN_STEPS = (*STEPS, "files", "written contact")
PAIR_STEPS = (*WRITTEN_STEPS, "workshop files", "plots")
"""What is told of one pair of gears until its contact as written is known, and until all its files are made."""


@dataclass(frozen=True)
class Built:
    """What a build has done: the files it wrote and the summary of every pair of gears that it wrote among them."""

    paths: list[Path]
    summaries: list[dict[str, Any]]


@dataclass(frozen=True)
class _Pair:
    """What is made of one pair of gears: its files, the summary among them, and the contact as written."""

    files: dict[str, bytes]
    summary: dict[str, Any]
    contact: PairContact


def build(
    drive: Drive,
    folder: Path,
    on_step: Callable[[str], None],
    formats: Collection[Format] = (),
    reported: LoadedDesign | None = None,
) -> Built:
    """Compute everything, and write all files into ``folder``, which is created if need be.

    Files of the kinds ``formats`` are written beside CSV and STL and, given the design as it was loaded, which is then
    ``reported`` on, a report.  Two stages go into folders ``stage-1`` and ``stage-2``, at the same instant.
    ``on_step`` is told what is done before it begins.  Raises WrongInput or NoSuchMechanism from the steps, and
    WrongInput when the folder cannot be written; whatever fails, the last good build in ``folder`` stays.
    """
    prepare(folder)
    pairs = {_place(pair.stage): _made(pair, _named(pair, on_step), formats) for pair in drive.by_stage}
    files = {place + name: content for place, pair in pairs.items() for name, content in pair.files.items()}
    if reported is not None:
        files[REPORT_FILE] = _report(drive, reported, [pair.contact for pair in pairs.values()], on_step)
    # A folder may hold an earlier build of the other number of stages, of other kinds of files, or with a report.
    names = {*NAMES, *(name for pair in pairs.values() for name in pair.files)}
    obsolete = [_place(stage) + name for stage in (None, 1, 2) for name in sorted(names)]
    return Built(publish(folder, files, [*obsolete, REPORT_FILE]), [pair.summary for pair in pairs.values()])


def step_count(drive: Drive, *, report: bool) -> int:
    """How often a build tells what is done."""
    return len(PAIR_STEPS) * drive.design.stages + report


def contacts_as_written(drive: Drive, on_step: Callable[[str], None]) -> list[PairContact]:
    """The contact of every pair as a build finds it in its files, none of which is written; raises as ``build``."""
    return [_written(pair, _named(pair, on_step))[1] for pair in drive.by_stage]


def _report(
    drive: Drive, reported: LoadedDesign, contacts: Sequence[PairContact], on_step: Callable[[str], None]
) -> bytes:
    from ncgear.drawings.page.page import report_page

    with _timed(drive, "report", on_step):
        return report_page(drive, reported, contacts)


def _place(stage: int | None) -> str:
    """What stands before the names of a pair's files."""
    return "" if stage is None else f"stage-{stage}/"


def _named(pair: Drive, on_step: Callable[[str], None]) -> Callable[[str], None]:
    """Tell which of two pairs is at work."""
    return on_step if pair.stage is None else lambda done: on_step(f"stage {pair.stage}: {done}")


def _made(drive: Drive, on_step: Callable[[str], None], formats: Collection[Format]) -> _Pair:
    """All of one pair of gears."""
    files, contact = _written(drive, on_step)
    with _timed(drive, "workshop files", on_step):
        files.update(workshop_files(drive, formats))
    with _timed(drive, "plots", on_step):
        files.update(pictures(drive, contact))
    # Last: only now are the timings known, and a summary is then never newer in its folder than what it sums up.
    summary = build_summary(drive, contact)
    return _Pair({**files, "summary.json": json_text(summary).encode()}, summary, contact)


def _written(drive: Drive, on_step: Callable[[str], None]) -> tuple[dict[str, bytes], PairContact]:
    """Tables and solids of one pair of gears, and its contact as they have it."""
    for step, attributes in STEPS.items():
        on_step(step)
        for attribute in attributes:
            getattr(drive, attribute)
    with _timed(drive, "files", on_step):
        files = {**_tables(drive), **_meshes(drive), "assembly.json": json_text(_assembly(drive)).encode()}
    with _timed(drive, "written contact", on_step):
        contact = drive.contact(written_outlines(files, drive.solids, helical=drive.helix is not None))
        files["contact.csv"] = contact_csv(contact).encode()
    return files, contact


@contextmanager
def _timed(drive: Drive, step: str, on_step: Callable[[str], None]) -> Iterator[None]:
    on_step(step)
    with drive.stopwatch(step):
        yield


def _tables(drive: Drive) -> dict[str, bytes]:
    return {
        "law.csv": law_csv(drive.motion).encode(),
        "driving.csv": outline_csv(drive.teeth.driving.outline_mm).encode(),
        "driven.csv": outline_csv(drive.teeth.driven.outline_mm).encode(),
        "pitch.csv": pitch_csv(drive).encode(),
        "data_sheet.md": sheet_text(data_sheet(drive)).encode(),
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
