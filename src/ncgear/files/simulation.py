"""A simulation of any level: its table, figures, and charts over the driving angle, as files and as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import degrees
from typing import Any

import numpy as np

from ncgear.design.words import ORDINALS
from ncgear.drawings.charts.chart import EMPTY, MOTION, NO_STRETCHES, Chart, ChartLine, Role, joints_up_to
from ncgear.drawings.charts.drawer import LOAD_LOOK, SIMULATION_COLUMN, TIME_LOOK, Look, column_png
from ncgear.drawings.pictures import titled
from ncgear.dynamics.history import PER_TURN, History, even_times_s, history, partings_s
from ncgear.dynamics.level import Level
from ncgear.dynamics.loaded_machine import Loads
from ncgear.figures.advice.drivetrain_advice import SMOOTH_GUIDE
from ncgear.figures.advice.strength_advice import pressed_in_time
from ncgear.figures.advice.teeth_advice import parted_in_time
from ncgear.figures.advice.values import Advice
from ncgear.figures.advice.verdict import KnownParts, Verdict, judged, together
from ncgear.figures.drivetrain import drivetrain_figures
from ncgear.figures.numbers import MICRORAD, json_text
from ncgear.figures.simulated import (
    dynamic_figures,
    dynamic_table,
    pairs_in_time,
    quasi_static_figures,
    quasi_static_table,
    rigid_figures,
    rigid_table,
)
from ncgear.figures.summary.check_summary import verdict_summary
from ncgear.figures.tables import csv_text
from ncgear.frozen import dataclass
from ncgear.kinematics.check import both_sides_rad
from ncgear.mechanisms.mechanism import Output
from ncgear.numerics.arrays import Array, distinct
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.project.drive import Drive


def simulated_chart(
    name: str,
    unit: str,
    phi1_rad: Array,
    own: tuple[str, Array],
    compared: tuple[str, Array] | None = None,
    joints_deg: Array = EMPTY,
    apart_deg: Array = NO_STRETCHES,
) -> Chart:
    """A quantity at driving angles in rad, shape (n,); ``own`` and ``compared`` are a label and values, shape (n,).

    ``joints_deg`` (shape (k,)) are joints of the law; in the stretches ``apart_deg`` (shape (k, 2)) the pushing flanks
    do not touch.
    """
    angle = np.degrees(phi1_rad)
    lines = [ChartLine(Role.OWN, own[0], angle, own[1])]
    if compared is not None:
        lines.append(ChartLine(Role.UNIFORM, compared[0], angle, compared[1]))
    return Chart(name, unit, tuple(lines), degrees(phi1_rad[-1]), None, joints_deg, apart_deg, names_extreme=True)


def driving_torque(drive: Drive, own: Loads, uniform: Loads) -> Chart:
    """The torque that the driving shaft needs, with its mean."""
    torques = (N_M_PER_N_MM * loads.driving_torque.value for loads in (own, uniform))
    chart = _load_chart(drive, "driving torque", "N m", *torques)
    mean = np.full(2, N_M_PER_N_MM * drive.rigid.fluctuation.mean_torque_n_mm)
    return replace(chart, lines=(*chart.lines, ChartLine(Role.MEAN, "mean", np.array([0.0, chart.end]), mean)))


def joint_forces(drive: Drive, own: Loads, uniform: Loads) -> list[Chart]:
    """Forces in the bearing of the crank, in the mechanism's joints from the crank on, and in the guide."""
    linkage, both = drive.linkage, (own, uniform)
    forces = {f"{linkage.CRANK} bearing": [_size(loads.crank_bearing) for loads in both]}
    forces |= {
        words: [_size(loads.joints[name]) for loads in both] for name, words in reversed([*linkage.JOINTS.items()])
    }
    if linkage.GUIDED:
        forces["guide"] = [loads.guide.value for loads in both]
    return [_load_chart(drive, name, "N", *sizes) for name, sizes in forces.items()]


def mesh_forces(drive: Drive, own: Loads, uniform: Loads) -> list[Chart]:
    """Force between the teeth and pressure angle; empty where there are no gears."""
    if own.mesh is None or uniform.mesh is None:
        return []
    before = list(zip(own.meshes_before, uniform.meshes_before, strict=True))
    names = [*(f"{ordinal} " for ordinal in ORDINALS[: len(before)]), "last " if before else ""]
    charts = []
    for of, both in zip(names, [*before, (own.mesh, uniform.mesh)], strict=True):
        angles = (np.degrees(mesh.pressure_angle_rad.value) for mesh in both)
        charts.append(_load_chart(drive, f"{of}mesh force", "N", *(mesh.size_n.value for mesh in both)))
        charts.append(replace(_load_chart(drive, f"{of}pressure angle", "deg", *angles), names_extreme=False))
    return charts


def drawn_angles_rad(drive: Drive) -> Array:
    """Rising driving angles of the charts of the rigid level, shape (n,): the angles of its table and of its peaks."""
    peaks, torque = drive.rigid.peaks, drive.rigid.driving.torque_range_n_mm
    mesh = [forces.force_n for forces in (peaks.mesh, *peaks.meshes_before) if forces is not None]
    found = [*peaks.joints_n.values(), peaks.crank_bearing_n, peaks.guide_n, *torque, *mesh]
    beside = both_sides_rad([peak.at for peak in found], drive.transmission.cycle_rad)
    return distinct(np.concatenate([drive.motion.phi1_rad, beside]))


def _load_chart(drive: Drive, name: str, unit: str, own: Array, uniform: Array) -> Chart:
    """A load of the rigid level at the driving angles of its charts, beside the load with a uniform crank."""
    phi1 = drawn_angles_rad(drive)
    joints = np.degrees(joints_up_to(drive.transmission, float(phi1[-1])))
    lines = ("this design", own), (f"{drive.linkage.UNIFORM}, same speed", uniform)
    return simulated_chart(name, unit, phi1, *lines, joints_deg=joints)


def _size(force: Vector) -> Array:
    return (force.x.value**2 + force.y.value**2) ** 0.5


def teeth_under_load(drive: Drive, rigid_n_m: Array) -> list[Chart]:
    """Driving torque, tooth force, and lead over the law; ``rigid_n_m``, shape (n,), is the torque of rigid teeth."""
    each = [pair.loaded_contact for pair in drive.by_stage]
    phi1, own = drive.motion.phi1_rad, "teeth give way"
    torque, error = N_M_PER_N_MM * each[0].driving_torque_n_mm, drive.loaded_error_at(phi1)
    names = (*(f"{ordinal} gears: " for ordinal in ORDINALS[: len(each) - 1]), "")
    return [
        simulated_chart("driving torque", "N m", phi1, (own, torque), ("rigid", rigid_n_m)),
        *(
            simulated_chart(f"{of}force of one pair", "N", phi1, (own, pair.tooth_force_n))
            for of, pair in zip(names, each, strict=True)
        ),
        simulated_chart("ahead of the law", MICRORAD, phi1, (own, 1e6 * error)),
    ]


SIMULATED = "simulated"


def output_in_time(shown: History, output: Output, apart_deg: Array) -> list[Chart]:
    """The output's motion beside the motion of the law; ``apart_deg`` (shape (k, 2)) as in ``Chart``."""
    charts = []
    for quantity in MOTION:
        own, law = (quantity.values(slide, output) for slide in (shown.slide, shown.law))
        lines, unit = ((SIMULATED, own), ("law", law)), quantity.unit_of(output).text
        charts.append(simulated_chart(quantity.name_of(output), unit, shown.phi1_rad, *lines, apart_deg=apart_deg))
    return charts


def teeth_in_time(shown: History) -> dict[str, tuple[str, Array]]:
    """Forces of the most loaded pair on both sides of the teeth, and the driving torque, each with its unit."""
    return {
        "pushing force, one pair": ("N", shown.pushing_n),
        "back force, one pair": ("N", shown.back_n),
        **{
            f"{pair} gears: {side} force, one pair": ("N", force)
            for pair, forces in zip(ORDINALS, shown.before, strict=False)
            for side, force in (("pushing", forces.pushing_n), ("back", forces.back_n))
        },
        "driving torque": ("N m", N_M_PER_N_MM * shown.torque_n_mm),
    }


def bearings_in_time(drive: Drive, shown: History) -> dict[str, tuple[str, Array]]:
    """Forces in the joints of the mechanism and between the teeth, each with its unit."""
    forces = {
        **{words: shown.joints.joints[name] for name, words in drive.linkage.JOINTS.items()},
        f"{drive.linkage.CRANK} bearing": shown.crank_bearing,
        "force of all pairs": shown.mesh,
    }
    return {name: ("N", np.hypot(force.x, force.y)) for name, force in forces.items()}


Columns = Mapping[str, tuple[Sequence[Chart], str]]
"""Charts below one another (perhaps empty) and their title, by file name."""


def _pictures(drive: Drive, look: Look, columns: Columns) -> dict[str, bytes]:
    return {
        file: column_png(charts, titled(drive, what), look, SIMULATION_COLUMN)
        for file, (charts, what) in columns.items()
        if charts
    }


@dataclass(frozen=True, eq=False)
class Simulated:
    """The results of a simulation.

    ``table`` holds columns of one length by name, ``figures`` sections of plain values, ``pictures`` PNGs by file name.
    Names of columns and keys of figures end in their unit.  ``verdict`` is the verdict on the machine; the figures have
    its warnings, too.
    """

    table: Mapping[str, Array]
    figures: Mapping[str, Any]
    pictures: Mapping[str, bytes]
    verdict: Verdict


def simulate(drive: Drive, level: Level) -> Simulated:
    """Simulate a machine at a level; raises WrongInput where the design lacks what the level needs.

    The verdict is that of a build, but for values of remedies that only trials of other gears tell; at the rigid level,
    which makes teeth only for a drivetrain, it is that of a check.
    """
    table, figures, pictures = _at_level(drive, level)
    with_teeth = drive.design.gears is not None and (level is not Level.RIGID or drive.design.drivetrain is not None)
    known = KnownParts.TEETH if with_teeth else KnownParts.MOTION
    found = [(pair, list[Advice]()) for pair in ((drive,) if level is Level.RIGID else drive.by_stage)]
    if level is Level.DYNAMIC:
        pairs = zip(drive.by_stage, pairs_in_time(figures), strict=True)
        found = [(pair, _found_in_time(pair, moved)) for pair, moved in pairs]
    verdict = together([judged(pair, known, advices, seconds=0.0) for pair, advices in found])
    return Simulated(table, {**figures, **verdict_summary(verdict)}, pictures, verdict)


def _found_in_time(pair: Drive, moved: Mapping[str, Any]) -> list[Advice]:
    """What the motion in time alone tells of a pair, and of the machine, by the pair's figures."""
    time_s = pair.whole.course.time_s
    parted = moved["partings_of_pushing_flanks"], moved["time_with_pushing_flanks_apart_s"]
    pressed = pressed_in_time(pair, max(moved["peak_pushing_force_n"], moved["peak_back_force_n"]))
    return [
        parted_in_time(*parted, float(time_s[-1] - time_s[0])),
        *([SMOOTH_GUIDE] if pair.rigid.machine.guide_friction else []),
        *([pressed] if pressed else []),
    ]


Results = tuple[Mapping[str, Array], Mapping[str, Any], Mapping[str, bytes]]
"""Table, figures and pictures of a level, before anything is judged."""


def _at_level(drive: Drive, level: Level) -> Results:
    match level:
        case Level.RIGID:
            machines = drive.rigid.machine, drive.uniform_rigid.machine
            loads, drawn = (
                [machine.at(phi1) for machine in machines] for phi1 in (drive.motion.phi1_rad, drawn_angles_rad(drive))
            )
            figures = rigid_figures(drive)
            if drive.design.drivetrain is not None:
                figures |= {"drivetrain": drivetrain_figures(drive.drivetrain)}
            charts: Columns = {
                "driving_torque.png": ([driving_torque(drive, *drawn)], "driving torque"),
                "bearing_forces.png": (joint_forces(drive, *drawn), "forces in the joints"),
                "mesh_force.png": (mesh_forces(drive, *drawn), "force between the teeth"),
            }
            return rigid_table(drive, *loads), figures, _pictures(drive, LOAD_LOOK, charts)
        case Level.QUASI_STATIC:
            rigid = N_M_PER_N_MM * drive.rigid.machine.at(drive.motion.phi1_rad).driving_torque.value
            charts = {"loaded_contact.png": (teeth_under_load(drive, rigid), "teeth under load")}
            pictures = _pictures(drive, TIME_LOOK, charts)
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


def _dynamic(drive: Drive) -> Results:
    """The motion of a drive in time, beside its law: rows at even times, peaks from the solver's steps.

    Pictures have points at even times and one at each peak, so that they show the peaks of the figures.
    """
    course, rigid = drive.course, drive.rigid.machine
    peaks, partings = drive.peaks_of(course), [partings_s(course, pair) for pair in range(drive.design.stages)]
    drawn = history(course, rigid, np.union1d(even_times_s(course, PER_TURN), peaks.times_s))
    apart_deg = np.degrees(np.stack([course.at(ends)[0] for ends in partings[-1][0].T], axis=-1))

    def in_time(quantities: Mapping[str, tuple[str, Array]]) -> list[Chart]:
        return [
            simulated_chart(name, unit, drawn.phi1_rad, (SIMULATED, values), apart_deg=apart_deg)
            for name, (unit, values) in quantities.items()
        ]

    table, output = dynamic_table(history(course, rigid, even_times_s(course)), drive.linkage), drive.linkage.OUTPUT
    charts = {
        f"{output.name.replace(' ', '_')}_motion.png": (output_in_time(drawn, output, apart_deg), output.name),
        "tooth_force.png": (in_time(teeth_in_time(drawn)), "teeth and torque"),
        "bearing_forces.png": (in_time(bearings_in_time(drive, drawn)), "bearings"),
    }
    return table, dynamic_figures(drive, peaks, partings), _pictures(drive, TIME_LOOK, charts)
