"""A build: all steps of the drive one after the other, then all its files at once.

The files of a pair of gears are tables, solids, the assembly, the contact as written, the workshop formats asked for,
pictures, and last the summary.  Two pairs in series have their files in the folders ``stage-1`` and ``stage-2``.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ncgear.contact.pair import PairContact
from ncgear.contact.written.as_written import Outlines
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.drawings.beside import GEAR_PICTURES, HERE, LOAD_PICTURES, MOTION_PICTURE, Drawer
from ncgear.drawings.page import REPORT_FILE
from ncgear.drawings.pictures import gear_pictures, load_pictures, motion_picture
from ncgear.figures.advice.verdict import KnownParts, Verdict, judged, together
from ncgear.figures.assembly import assembly_of
from ncgear.figures.data_sheet.measured_tables import pitch_csv
from ncgear.figures.data_sheet.sheet import data_sheet, sheet_text
from ncgear.figures.numbers import json_text
from ncgear.figures.summary.build_summary import build_summary, with_files
from ncgear.figures.summary.check_summary import check_summary
from ncgear.figures.tables import contact_csv, law_csv, outline_csv
from ncgear.files.manifest import publish_run
from ncgear.files.publish import prepare
from ncgear.files.read_back import ERRORS, error_of_step_mm, exact_outlines, stl_bytes, written_outlines
from ncgear.files.workshop.formats import WRITERS, Format, all_made, begun_workshop_files
from ncgear.frozen import dataclass
from ncgear.project.drive import Drive

STEPS = {
    "motion": ("motion", "uniform_motion"),
    "pitch curves": ("pitch",),
    "teeth": ("teeth",),
    "contact": ("designed_contact",),
    "solids": ("solids",),
}
"""The steps in their order, each with the attributes of the drive that it computes."""

WRITTEN_STEPS = (*STEPS, "files", "written contact")
PAIR_STEPS = (*WRITTEN_STEPS, "workshop files", "plots")
"""The steps of one pair of gears: first the steps up to its contact as written, then the steps for its other files."""


@dataclass(frozen=True)
class Built:
    """The paths of the files that a build wrote, of other people's files that it kept, and its results: the summary of
    every pair, and the verdict on the whole machine.
    """

    paths: list[Path]
    kept: list[Path]
    summaries: list[dict[str, Any]]
    verdict: Verdict


def build(
    drive: Drive,
    folder: Path,
    on_step: Callable[[str], None],
    formats: Collection[Format] = (),
    reported: LoadedDesign | None = None,
    drawer: Drawer = HERE,
) -> Built:
    """Compute everything, and write all files into ``folder``, which is created where it does not exist.

    Files of the kinds ``formats`` are written beside CSV and STL.  A report is written if ``reported``, the design as
    loaded, is given.  Both pairs of two stages are written at the same instant.  Files that an earlier build wrote and
    this build does not write (of another number of stages, or of other kinds) are removed; other people's files stay.
    ``on_step`` is called with the name of each step before the step begins.  ``drawer`` draws the pictures, and the
    charts of the report.  Raises WrongInput or NoSuchMechanism from the steps, and WrongInput when the folder cannot be
    written; whatever fails, the last good build stays.
    """
    prepare(folder)
    pairs = {
        folder_of(pair.stage): _made(pair, naming_stage(pair, on_step), formats, drawer) for pair in drive.by_stage
    }
    files = {place + name: content for place, pair in pairs.items() for name, content in pair.files.items()}
    verdict = together(pair.verdict for pair in pairs.values())
    if reported is not None:
        from ncgear.drawings.page.page import report_page

        with _timed(drive, "report", on_step):
            contacts = [pair.contact for pair in pairs.values()]
            files[REPORT_FILE] = report_page(drive, reported, contacts, verdict, drawer)
    run = publish_run(folder, files, "build")
    return Built(run.paths, run.kept, [pair.summary for pair in pairs.values()], verdict)


def step_count(drive: Drive, *, report: bool) -> int:
    """The number of steps of a build."""
    return len(PAIR_STEPS) * drive.design.stages + report


def contacts_as_written(drive: Drive, on_step: Callable[[str], None]) -> list[PairContact]:
    """The contact of every pair as a build finds it in its files, without writing any; raises the errors of steps."""
    contacts = []
    for pair in drive.by_stage:
        named = naming_stage(pair, on_step)
        list(_computed(pair, named))
        contacts.append(_written(pair, named)[1])
    return contacts


def verdicts_of(drive: Drive) -> list[Verdict]:
    """The verdict on every pair with its machine, or on a design without gears."""
    if drive.design.gears is None:
        return [judged(drive, KnownParts.MOTION)]
    return [judged(pair, KnownParts.TEETH) for pair in drive.by_stage]


def summaries_without_files(
    drive: Drive, contacts: Sequence[PairContact], verdicts: Sequence[Verdict]
) -> list[dict[str, Any]]:
    """The summary of every pair from its written contact and its verdict: that of a build without errors of files.

    A design without gears has no contacts; its summary is the summary of its check.
    """
    if not contacts:
        return [check_summary(drive, *verdicts)]
    return [
        with_files(build_summary(pair, contact, verdict), {}, pair.timing_s)
        for pair, contact, verdict in zip(drive.by_stage, contacts, verdicts, strict=True)
    ]


def folder_of(stage: int | None) -> str:
    """The folder of a pair's files, as the beginning of their names; empty with a single pair."""
    return "" if stage is None else f"stage-{stage}/"


def naming_stage(pair: Drive, on_step: Callable[[str], None]) -> Callable[[str], None]:
    """An ``on_step`` that adds the number of the pair to the name of the step, if there are two pairs."""
    return on_step if pair.stage is None else lambda done: on_step(f"stage {pair.stage}: {done}")


@dataclass(frozen=True)
class _Pair:
    """The files of one pair of gears, its summary, its contact as written and the verdict on it and the machine."""

    files: dict[str, bytes]
    summary: dict[str, Any]
    contact: PairContact
    verdict: Verdict


def _made(drive: Drive, on_step: Callable[[str], None], formats: Collection[Format], drawer: Drawer) -> _Pair:
    drawn: list[Callable[[], dict[str, bytes]]] = []
    # The second process draws finished values while this process computes the others.
    for step in _computed(drive, on_step):
        if step == "motion":
            drawn.append(drawer.begun(MOTION_PICTURE, *motion_picture(drive)))
        if step == "teeth":
            drawn.append(drawer.begun(GEAR_PICTURES, *gear_pictures(drive)))
    with drive.stopwatch("workshop files"):
        exact = exact_outlines(drive.teeth)
        # A process that takes its clearance from outlines makes parallels of them.
        shared = drawer, exact if drive.gears.process_clearance_mm == 0.0 else None
        slow = [kind for kind in formats if WRITERS[kind].is_slow]
        slow_files = begun_workshop_files(drive, slow, *shared)
    files, contact, outlines = _written(drive, on_step)
    drawn.append(drawer.begun(LOAD_PICTURES, *load_pictures(drive, contact)))
    with drive.stopwatch("workshop files"):
        other_files = begun_workshop_files(drive, set(formats).difference(slow), *shared)
        both = {outline.source: (outline.driving_mm, outline.driven_mm) for outline in outlines}
        measured = drawer.offered(ERRORS, exact, both)
    verdict = judged(drive, KnownParts.TEETH)
    figures = build_summary(drive, contact, verdict)
    with _timed(drive, "workshop files", on_step):
        errors_mm = measured()
        # This process makes the files that the second process has not begun, the last file first.
        workshop = all_made([*other_files, *slow_files])
        files.update(workshop.files)
        errors_mm.update(workshop.errors_mm)
        if "pair.step" in files:
            errors_mm["step"] = error_of_step_mm(files["pair.step"])
    with _timed(drive, "plots", on_step):
        for pictures in drawn:
            files.update(pictures())
    # Only now all timings are known.
    summary = with_files(figures, errors_mm, drive.timing_s)
    return _Pair({**files, "summary.json": json_text(summary).encode()}, summary, contact, verdict)


def _computed(drive: Drive, on_step: Callable[[str], None]) -> Iterator[str]:
    """The name of each step of one pair of gears after it is computed."""
    for step, attributes in STEPS.items():
        on_step(step)
        for attribute in attributes:
            getattr(drive, attribute)
        yield step


def _written(drive: Drive, on_step: Callable[[str], None]) -> tuple[dict[str, bytes], PairContact, list[Outlines]]:
    """Tables and solids of one pair of gears, the contact found in them, and the outlines read back."""
    with _timed(drive, "files", on_step):
        files = {
            "law.csv": law_csv(drive.motion, drive.linkage.OUTPUT).encode(),
            "driving.csv": outline_csv(drive.teeth.driving.outline_mm).encode(),
            "driven.csv": outline_csv(drive.teeth.driven.outline_mm).encode(),
            "pitch.csv": pitch_csv(drive.pitch).encode(),
            "data_sheet.md": sheet_text(data_sheet(drive)).encode(),
            "driving.stl": stl_bytes(drive.solids.driving.mesh),
            "driven.stl": stl_bytes(drive.solids.driven.mesh),
            "assembly.json": json_text(assembly_of(drive)).encode(),
        }
    with _timed(drive, "written contact", on_step):
        outlines = written_outlines(files, drive.solids, helical=drive.helix is not None)
        contact = drive.contact(outlines)
        files["contact.csv"] = contact_csv(contact).encode()
    return files, contact, outlines


@contextmanager
def _timed(drive: Drive, step: str, on_step: Callable[[str], None]) -> Iterator[None]:
    on_step(step)
    with drive.stopwatch(step):
        yield
