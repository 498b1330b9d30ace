"""The results of a simulation at each level: a table over the driving angle, and figures in sections of plain values.

- Rigid: torques and forces by inverse dynamics, beside those of the uniform crank with the same masses.
- Quasi-static: the teeth under load, beside the torque of the rigid level.
- Dynamic: the motion in time, beside the law.

Columns of a table have one length; names of columns and keys of figures end in their unit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from math import atan2, degrees, hypot
from typing import Any

import numpy as np

from ncgear.design.words import ORDINALS
from ncgear.dynamics.history import BETWEEN_BEARING, CRANK_BEARING, MESH_BEFORE, History, MotionPeaks, Peak
from ncgear.dynamics.level import Level
from ncgear.dynamics.loaded_machine import Loads
from ncgear.dynamics.meshing import Meshing
from ncgear.dynamics.quasi_static import LoadedContact
from ncgear.dynamics.rigid import LoadPeaks, Rigid
from ncgear.errors import NoSuchMechanism
from ncgear.figures.summary.check_summary import uniform_key
from ncgear.figures.tables import load_column, motion_columns
from ncgear.kinematics.check import KinematicCheck, power_figures
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import extreme
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import KG_M2, N_M_PER_N_MM, RAD_S_PER_RPM
from ncgear.project.drive import Drive
from ncgear.strength.stiffness import SOFTER, STIFFER

SAME_AS_MESH = "peak_driving_bearing_force_n"
"""The bearings of the driving shaft bear the mesh force together."""


def rigid_table(drive: Drive, own: Loads, uniform: Loads) -> dict[str, Array]:
    """The motion, the loads of the design's own machine, and the loads of the uniform crank."""
    motion, output = drive.motion, drive.linkage.OUTPUT
    return {
        "phi1_rad": motion.phi1_rad,
        "phi2_rad": motion.phi2_rad,
        **motion_columns(motion, output),
        **load_column(motion, output),
        **_load_columns(drive.linkage, own),
        **{f"uniform_{name}": column for name, column in _load_columns(drive.linkage, uniform).items()},
    }


def bearing_name(linkage: Mechanism) -> str:
    """The name of the bearing of the shaft that the driven gear turns, in columns and figures."""
    return f"{linkage.CRANK}_bearing".replace(" ", "_")


def _load_columns(linkage: Mechanism, loads: Loads) -> dict[str, Array]:
    columns = {
        "driving_torque_n_m": N_M_PER_N_MM * loads.driving_torque.value,
        "driven_torque_n_m": N_M_PER_N_MM * loads.driven_torque.value,
        **{key: column for name, force in loads.joints.items() for key, column in _components(name, force).items()},
        **_components(bearing_name(linkage), loads.crank_bearing),
        **({"guide_n": loads.guide.value} if linkage.GUIDED else {}),
    }
    if loads.mesh is not None:
        columns |= _components("mesh", loads.mesh.force)
        columns |= {"mesh_n": loads.mesh.size_n.value, "pressure_angle_rad": loads.mesh.pressure_angle_rad.value}
    for (mesh, bearing), before, force in zip(
        _names_before(len(loads.meshes_before)), loads.meshes_before, loads.between_bearings, strict=True
    ):
        columns |= _components(mesh, before.force) | _components(bearing, force)
    return columns


def _names_before(count: int) -> list[tuple[str, str]]:
    """The names of the meshes before the last, and of the bearings of the shafts that they turn, from the first on."""
    shaft = "shaft_between_bearing"
    return [(f"{ordinal}_mesh", shaft if count == 1 else f"{ordinal}_{shaft}") for ordinal in ORDINALS[:count]]


def _components(name: str, force: Vector) -> dict[str, Array]:
    return {f"{name}_x_n": force.x.value, f"{name}_y_n": force.y.value}


def rigid_figures(drive: Drive) -> dict[str, Any]:
    """The masses, and the peaks of both machines."""
    design = drive.design
    assert design.masses is not None
    wanted = design.masses.flywheel.speed_fluctuation
    return {
        **_about(drive, Level.RIGID),
        "masses": _masses(drive),
        "this_design": _loads(drive.rigid, drive.check, wanted),
        uniform_key(drive): _loads(drive.uniform_rigid, drive.uniform_check, wanted),
    }


def _about(drive: Drive, level: Level) -> dict[str, Any]:
    design = drive.design
    return {
        "design": {"name": design.name, "description": design.description, "level": level.value},
        "drive": {"speed_rpm": design.operation.speed_rpm},
    }


def _masses(drive: Drive) -> dict[str, Any]:
    """The moving masses; what turns with the driven shaft has the mechanism's own name, and none that it has not."""
    linkage, found = drive.linkage, asdict(drive.masses)
    along, across = found.pop("gravity_m_s2")
    between = found["between_inertia_kg_mm2"]
    found["between_inertia_kg_mm2"] = between[0] if len(between) == 1 else list(between)
    absent = {name for name in ("slider_kg",) if "slider" not in linkage.POINTS}
    absent |= {"crank_kg", "crank_center_mm"} if not linkage.HAS_CRANK else set()
    absent |= {"between_inertia_kg_mm2"} if drive.design.stages == 1 else set()
    found = {name: value for name, value in found.items() if name not in absent}
    found = {name.replace("crank_", f"{linkage.CRANK}_".replace(" ", "_")): value for name, value in found.items()}
    gravity = {"gravity_m_s2": hypot(along, across), "gravity_direction_deg": degrees(atan2(across, along))}
    return {**found, **gravity} if gravity["gravity_m_s2"] else found


def _loads(rigid: Rigid, check: KinematicCheck, coefficient: float) -> dict[str, Any]:
    swing = rigid.fluctuation
    least, most = rigid.driving.torque_range_n_mm
    return {
        **extreme("peak_driving_torque", "n_m", most, N_M_PER_N_MM),
        **extreme("least_driving_torque", "n_m", least, N_M_PER_N_MM),
        "mean_driving_torque_n_m": check.mean_power_w / swing.speed_rad_s,
        **power_figures(check),
        "flank_changes_deg": [degrees(angle) for angle in swing.flank_changes_rad],
        "speed_fluctuation": coefficient,
        "inertia_for_speed_fluctuation_kg_m2": KG_M2 * swing.flywheel_kg_mm2(coefficient),
        **force_figures(rigid.machine.machine.linkage, rigid.peaks),
    }


def force_figures(linkage: Mechanism, peaks: LoadPeaks) -> dict[str, Any]:
    """The peak forces of the mesh, of each joint of the mechanism by its words, of crank bearing and guide."""
    joints = dict[str, float]()
    for name, peak in peaks.joints_n.items():
        words = linkage.JOINTS[name].replace("'s ", " ").replace(" ", "_")
        joints.update(extreme(f"peak_{words}_force", "n", peak))
    return {
        **_mesh(peaks),
        **joints,
        **extreme(f"peak_{bearing_name(linkage)}_force", "n", peaks.crank_bearing_n),
        **(extreme("peak_guide_force", "n", peaks.guide_n) if linkage.GUIDED else {}),
    }


def _mesh(peaks: LoadPeaks) -> dict[str, Any]:
    """The forces of meshes; the bearings of the driving shaft bear the first unchanged; empty without gears."""
    if peaks.mesh is None:
        return {}
    before, told = _names_before(len(peaks.meshes_before)), dict[str, Any]()
    found = zip(("mesh", *(name for name, _ in before)), (peaks.mesh, *peaks.meshes_before), strict=True)
    for name, mesh in found:
        told |= extreme(f"peak_{name}_force", "n", mesh.force_n)
        told[f"pressure_angle_at_peak_{name}_force_deg"] = degrees(mesh.pressure_angle_rad)
    told |= extreme(SAME_AS_MESH.removesuffix("_n"), "n", (*peaks.meshes_before, peaks.mesh)[0].force_n)
    for (_, bearing), peak in zip(before, peaks.between_bearings_n, strict=True):
        told |= extreme(f"peak_{bearing}_force", "n", peak)
    return told


def quasi_static_table(drive: Drive, rigid_torque_n_m: Array) -> dict[str, Array]:
    """Angles, forces and depths of the loaded teeth, with the driving torque beside the rigid level's.

    Of pairs in series the error is that of all together, and forces and depths without a number are the last pair's.
    """
    each, motion = [pair.loaded_contact for pair in drive.by_stage], drive.motion
    names, error = (
        (*(f"{ordinal}_" for ordinal in ORDINALS[: len(each) - 1]), ""),
        drive.loaded_error_at(motion.phi1_rad),
    )
    return {
        "phi1_rad": motion.phi1_rad,
        "phi2_rad": motion.phi2_rad + error,
        "error_rad": error,
        **{
            f"{of}{key}": values
            for of, pair in zip(names, each, strict=True)
            for key, values in _teeth_at_rest(pair).items()
        },
        "driving_torque_n_m": N_M_PER_N_MM * each[0].driving_torque_n_mm,
        "rigid_driving_torque_n_m": rigid_torque_n_m,
    }


def _teeth_at_rest(loaded: LoadedContact) -> dict[str, Array]:
    """The columns of a pair's loaded teeth."""
    return {
        "pairs": loaded.pairs.astype(float),
        "tooth_force_n": loaded.tooth_force_n,
        "depth_mm": np.maximum(loaded.forces.depth_mm.max(axis=-1), 0.0),
    }


def quasi_static_figures(drive: Drive) -> dict[str, Any]:
    """The stiffness of the contact, and the peaks of the loaded teeth with the driving angles at which they are.

    The figures of several pairs are in ``pairs``, each with its own driving torque and its own driven angle's error.
    """
    pairs = [_pair_at_rest(pair) for pair in drive.by_stage]
    told = pairs[0]
    if len(pairs) > 1:
        torque = {key: value for key, value in told.items() if key.startswith("peak_driving_torque")}
        told = {"transmission_error_rad": drive.transmission_error_with(1.0), **torque, "pairs": pairs}
    return {
        **_about(drive, Level.QUASI_STATIC),
        "loaded_contact": told,
        "band_of_stiffness": _band(lambda factor: _loaded_with(drive, factor)),
    }


def _pair_at_rest(drive: Drive) -> dict[str, Any]:
    """The teeth of a pair under load."""
    peaks, designed = drive.loaded_peaks, drive.designed_contact
    sides = drive.pairs_under_load or (designed.pushing.pairs, designed.back.pairs)
    return {
        **_stiffness(drive),
        "transmission_error_rad": peaks.transmission_error_rad,
        **extreme("peak_tooth_force", "n", peaks.tooth_force_n),
        **extreme("peak_depth", "mm", peaks.depth_mm),
        **extreme("peak_driving_torque", "n_m", peaks.driving_torque_n_mm, N_M_PER_N_MM),
        "most_pairs": peaks.most_pairs,
        "contact_ratio_mean": min(pairs.contact_ratio for pairs in sides),
        "contact_ratio_min": min(pairs.least_arc for pairs in sides),
    }


def _stiffness(drive: Drive) -> dict[str, float]:
    found, gaps = drive.stiffness_range, drive.meshing.gaps
    return {
        **extreme("least_pair_stiffness", "n_per_mm", found.low),
        "mean_pair_stiffness_n_per_mm": gaps.sections * float(np.mean(gaps.touching_stiffness)),
        **extreme("largest_pair_stiffness", "n_per_mm", found.high),
    }


def _band(peaks_with: Callable[[float], dict[str, float]]) -> dict[str, dict[str, Any]]:
    """The peaks with softer and with stiffer teeth, or in place of them why those cannot be followed."""
    band: dict[str, dict[str, Any]] = {}
    for name, factor in (("softer", SOFTER), ("stiffer", STIFFER)):
        band[name] = {"stiffness_factor": factor}
        try:
            band[name] |= peaks_with(factor)
        except NoSuchMechanism as error:
            band[name]["not_followed"] = error.problem
    return band


def _loaded_with(drive: Drive, factor: float) -> dict[str, float]:
    pairs = [pair.loaded_peaks_with(factor) for pair in drive.by_stage]
    return {
        "peak_tooth_force_n": max(pair.tooth_force_n.value for pair in pairs),
        "peak_depth_mm": max(pair.depth_mm.value for pair in pairs),
        "transmission_error_rad": drive.transmission_error_with(factor),
    }


def dynamic_table(history: History, linkage: Mechanism) -> dict[str, Array]:
    """The motion in time, the motion by the law, and the forces between the teeth and in the joints."""
    columns = {"time_s": history.time_s, "phi1_rad": history.phi1_rad, "phi2_rad": history.phi2_rad}
    for prefix, slide in (("", history.slide), ("law_", history.law)):
        columns.update({f"{prefix}{name}": values for name, values in motion_columns(slide, linkage.OUTPUT).items()})
    joints: dict[str, Array] = {}
    names = _names_in_time(linkage, len(history.before))
    for joint, force in history.forces.items():
        name = names.get(joint, joint)
        joints.update({f"{name}_x_n": force.x, f"{name}_y_n": force.y})
    return {
        **columns,
        "error_rad": history.error_rad,
        "pushing_force_n": history.pushing_n,
        "back_force_n": history.back_n,
        **{
            f"{pair}_{side}_force_n": force
            for pair, forces in zip(ORDINALS, history.before, strict=False)
            for side, force in (("pushing", forces.pushing_n), ("back", forces.back_n))
        },
        "driving_torque_n_m": N_M_PER_N_MM * history.torque_n_mm,
        **joints,
        **({"guide_n": np.asarray(history.joints.guide_n)} if linkage.GUIDED else {}),
    }


def _names_in_time(linkage: Mechanism, before: int) -> dict[str, str]:
    """The names of forces of ``History`` in columns and figures, with as many pairs before the last."""
    names = {CRANK_BEARING: bearing_name(linkage)}
    for number, (mesh, bearing) in enumerate(_names_before(before)):
        names |= {f"{MESH_BEFORE} {number}": mesh, f"{BETWEEN_BEARING} {number}": bearing}
    return names


def dynamic_figures(drive: Drive, peaks: MotionPeaks, partings_s: Sequence[tuple[Array, Array]]) -> dict[str, Any]:
    """The slider beside its law, the bearings, and the teeth, with the driving angle of each peak.

    ``partings_s`` are those of pushing flanks, and of any flanks, of each pair.  The figures of several pairs are in
    ``pairs``.
    """
    course, work, output = drive.course, drive.course.states[4:6, -1], drive.linkage.OUTPUT
    names = _names_in_time(drive.linkage, len(peaks.before))
    meshings = (*course.machine.before, course.machine.meshing)
    pairs = [
        _pair_in_time(pair, meshing, of_pair, parted)
        for pair, meshing, of_pair, parted in zip(drive.by_stage, meshings, peaks.of_pairs, partings_s, strict=True)
    ]
    return {
        **_about(drive, Level.DYNAMIC),
        output.name.replace(" ", "_"): {
            **_peak_at(
                "largest_displacement_error", output.place.ending, peaks.displacement_error, output.place.factor
            ),
            **_peak_at("largest_velocity_error", output.speed.ending, peaks.velocity_error),
            **_peak_at("peak_acceleration", output.acceleration.ending, peaks.acceleration),
            **extreme("peak_acceleration_of_law", output.acceleration.ending, drive.check.peak_acceleration_cycle),
        },
        "bearings": {
            key: value
            for name, peak in peaks.forces_n.items()
            for key, value in _peak_at(f"peak_{names.get(name, name)}_force", "n", peak).items()
        },
        "motion_in_time": {
            "start_speed_rpm": float(course.states[1, 0]) / RAD_S_PER_RPM,
            "end_speed_rpm": float(course.states[1, -1]) / RAD_S_PER_RPM,
            **_peak_at("peak_driving_torque", "n_m", peaks.most_torque_n_mm, N_M_PER_N_MM),
            **_peak_at("least_driving_torque", "n_m", peaks.least_torque_n_mm, N_M_PER_N_MM),
            "work_of_drive_j": N_M_PER_N_MM * float(work[0]),
            "loss_of_teeth_j": N_M_PER_N_MM * float(work[1]),
            **(pairs[0] if len(pairs) == 1 else {"pairs": pairs}),
            "energy_error": course.energy_error,
            "solver_steps": int(course.time_s.size - 1),
        },
        "band_of_stiffness": _band(lambda factor: _motion_with(drive, factor)),
    }


def pairs_in_time(figures: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """The figures of teeth in the motion in time of each pair, from the driving shaft on."""
    moved = figures["motion_in_time"]
    found: list[Mapping[str, Any]] = moved.get("pairs", [moved])
    return found


def _pair_in_time(
    pair: Drive, meshing: Meshing, peaks: tuple[Peak, Peak], partings_s: tuple[Array, Array]
) -> dict[str, Any]:
    """The teeth of a pair in the motion in time."""
    pushing_parted, parted = partings_s
    return {
        **_stiffness(pair),
        "damping_n_s_mm": meshing.gaps.sections * meshing.impact.damping_n_s_mm,
        **_peak_at("peak_pushing_force", "n", peaks[0]),
        **_peak_at("peak_back_force", "n", peaks[1]),
        "partings_of_pushing_flanks": len(pushing_parted),
        "time_with_pushing_flanks_apart_s": _lasting_s(pushing_parted),
        "losses_of_contact": len(parted),
        "time_without_contact_s": _lasting_s(parted),
    }


BAND_ACCURACY = 4e-6
"""Accuracy of the motions of the band: two thirds of the time, and peaks to some thousandths."""


def _motion_with(drive: Drive, factor: float) -> dict[str, float]:
    peaks = drive.peaks_of(drive.course_with(factor, BAND_ACCURACY))
    pushing, back = (max(force.value for force in side) for side in zip(*peaks.of_pairs, strict=True))
    return {
        "peak_pushing_force_n": pushing,
        "peak_back_force_n": back,
        "peak_mesh_force_n": peaks.forces_n["mesh"].value,
        f"peak_acceleration_{drive.linkage.OUTPUT.acceleration.ending}": peaks.acceleration.value,
    }


def _peak_at(name: str, unit: str, found: Peak, factor: float = 1.0) -> dict[str, float | None]:
    """A peak with its driving angle; one of 0 is at no place of its own."""
    place = found.phi1_rad if found.value else None
    return {f"{name}_{unit}": factor * found.value, f"{name}_at_rad": place}


def _lasting_s(spans_s: Array) -> float:
    """Sum of spans of time, shape (k, 2)."""
    return float(np.sum(spans_s[:, 1] - spans_s[:, 0]))
