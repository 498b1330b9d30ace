"""A simulation of any level: its table, figures and pictures, as files and as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ncgear.drawings.charts.simulation_charts import dynamic_pictures, quasi_static_pictures, rigid_pictures
from ncgear.dynamics.history import PER_TURN, even_times_s, history
from ncgear.dynamics.level import Level
from ncgear.dynamics.peaks import motion_peaks
from ncgear.dynamics.touching import pushing_parted_s
from ncgear.figures.advice.drivetrain_advice import SMOOTH_GUIDE
from ncgear.figures.advice.verdict import Known, Verdict, judged
from ncgear.figures.csv_text import csv_text
from ncgear.figures.drivetrain import drivetrain_figures
from ncgear.figures.numbers import json_text
from ncgear.figures.simulated import (
    dynamic_figures,
    dynamic_table,
    quasi_static_figures,
    quasi_static_table,
    rigid_figures,
    rigid_table,
)
from ncgear.figures.summary.check_summary import verdict_summary
from ncgear.figures.terminal import SIDE_BY_SIDE, beside_lines, summary_text, written_lines
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.project.drive import Drive


@dataclass(frozen=True, eq=False)
class Simulated:
    """The results of a simulation.

    ``table`` holds columns of one length by name, ``figures`` sections of plain values, ``pictures`` PNGs by file name.
    Names of columns and keys of figures end in their unit.  ``verdict`` is that on the machine, whose warnings the
    figures have too.
    """

    table: Mapping[str, Array]
    figures: Mapping[str, Any]
    pictures: Mapping[str, bytes]
    verdict: Verdict


def simulate(drive: Drive, level: Level) -> Simulated:
    """Simulate a machine at a level; raises WrongInput where the design lacks what the level needs.

    Its verdict is that of a build but for the rigid level, which makes no teeth unless a drivetrain asks for them.
    """
    table, figures, pictures = _at_level(drive, level)
    with_teeth = drive.design.gears is not None and (level is not Level.RIGID or drive.design.drivetrain is not None)
    rubs = level is Level.DYNAMIC and drive.rigid.machine.guide_friction
    verdict = judged(drive, Known.TEETH if with_teeth else Known.MOTION, [SMOOTH_GUIDE] if rubs else [])
    return Simulated(table, {**figures, **verdict_summary(verdict)}, pictures, verdict)


Results = tuple[Mapping[str, Array], Mapping[str, Any], Mapping[str, bytes]]
"""Table, figures and pictures of a level, before anything is judged."""


def _at_level(drive: Drive, level: Level) -> Results:
    match level:
        case Level.RIGID:
            phi1 = drive.motion.phi1_rad
            loads = drive.rigid.machine.at(phi1), drive.uniform_rigid.machine.at(phi1)
            figures = rigid_figures(drive)
            if drive.design.drivetrain is not None:
                figures |= {"drivetrain": drivetrain_figures(drive.drivetrain)}
            return rigid_table(drive, *loads), figures, rigid_pictures(drive, *loads)
        case Level.QUASI_STATIC:
            rigid = N_M_PER_N_MM * drive.rigid.machine.at(drive.motion.phi1_rad).driving_torque.value
            pictures = quasi_static_pictures(drive, rigid)
            return quasi_static_table(drive, rigid), quasi_static_figures(drive), pictures
        case Level.DYNAMIC:
            return _dynamic(drive)


def simulation_files(found: Simulated) -> dict[str, bytes]:
    """Table, pictures and figures as files."""
    return {
        "simulation.csv": csv_text(list(found.table), list(found.table.values())).encode(),
        **found.pictures,
        "simulation.json": json_text(found.figures).encode(),
    }


def simulation_text(found: Simulated, paths: Sequence[Path], kept: Sequence[Path] = ()) -> str:
    """The figures as text, those of both mechanisms side by side, the files written, and those kept."""
    compared = {key: found.figures[key] for key in SIDE_BY_SIDE if key in found.figures}
    around = found.figures.get("drivetrain", {})
    alone = {key: value for key, value in found.figures.items() if key not in compared and value is not around} | around
    beside = [*beside_lines("Torques and forces", compared), ""] if compared else []
    return "\n".join([summary_text(alone), "", *beside, *written_lines(paths, kept)])


def _dynamic(drive: Drive) -> Results:
    """The motion of a drive in time, beside its law: rows at even times, peaks from the solver's steps.

    Pictures have a point at each peak besides even ones, so that they show what the figures say.
    """
    course, rigid = drive.course, drive.rigid.machine
    peaks = motion_peaks(course, rigid)
    drawn = history(course, rigid, np.union1d(even_times_s(course, PER_TURN), peaks.times_s))
    apart_rad = np.stack([course.at(ends)[0] for ends in pushing_parted_s(course).T], axis=-1)
    table = dynamic_table(history(course, rigid, even_times_s(course)), drive.linkage)
    return table, dynamic_figures(drive, peaks), dynamic_pictures(drive, drawn, apart_rad)
