"""The vibration of a design's mesh: from masses, pitch curves and grades to ``ncgear.strength.vibration``.

The inertias belong to both shafts of the pair: everything that turns with the driving gear, and everything that the
driven gear moves, reduced to its shaft, so that a slider counts most where it is fastest.  For two pairs in series, the
vibration of each pair ends at the shaft between.  Without masses both gears are discs within their pitch curves.  Gears
that turn less than once are as stiff at an angle as the mean of the way out and the way back.  Not counted: the twist
of shafts, which isolates heavy masses behind them and raises the frequency.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, degrees, pi
from typing import TYPE_CHECKING, Literal

import numpy as np

from ncgear.dynamics.crank_load import reduced_inertia
from ncgear.dynamics.swinging_mesh import SwingingMesh, swings
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Mask
from ncgear.numerics.jet import Jet
from ncgear.numerics.units import N_PER_KG_MM_S2, RAD_S_PER_RPM
from ncgear.pitch.shape import Gear, speed
from ncgear.project.face_load import grades_of
from ncgear.project.moving import disc_kg_mm2
from ncgear.project.service import choices_of, densities_kg_m3
from ncgear.project.tooth_load import ToothLoad, asked_of
from ncgear.strength.conditions import GRADE, Running
from ncgear.strength.endurance import running_in
from ncgear.strength.vibration import RESONANCE, MeshStiffness, Vibration
from ncgear.tolerances.iso1328 import flank_tolerances

if TYPE_CHECKING:
    from ncgear.project.geared import Geared
    from ncgear.strength.loading import Loading


def vibration_of(drive: Geared) -> Vibration:
    """The values on which the vibration of a drive's pair depends; raises as ``asked_of``."""
    asked, inertias = asked_of(drive), _inertias_of(drive)
    pair, place, module_mm = asked.pair, asked.place, drive.running.module_mm

    def reduced_kg(phi1: Array) -> Array:
        arms, moved = asked.arms_mm(phi1, np.ones(phi1.size)), np.stack(inertias(phi1))
        with np.errstate(divide="ignore"):
            return np.asarray(1.0 / np.sum(arms.T**2 / moved, axis=0))

    def passing_rad_s(phi1: Array) -> Array:
        slope = pair.transmission.driven_angle(phi1, 2).differentiated()
        per_rad = place.center_distance_mm * speed(slope, Gear.DRIVING, place.mesh).value
        return np.asarray(2.0 / module_mm * per_rad * drive.pair_speed_rad_s(phi1))

    return Vibration(reduced_kg, passing_rad_s, _deviations_mm(drive, asked), place.rack_angle_rad, drive.running)


def _inertias_of(drive: Geared) -> Callable[[Array], tuple[Array, Array]]:
    """A function from driving angles to the inertias in kg mm2 of both shafts of a pair, shape (n,) each."""
    asked, gears, pitch = asked_of(drive), drive.gears, drive.pitch
    if asked.load != "masses":
        discs = [
            disc_kg_mm2(gears, pitch.of(gear), pitch.size.module_mm, density)
            for gear, density in zip(Gear, densities_kg_m3(None, gears), strict=True)
        ]
        return lambda phi1: (np.full(phi1.shape, discs[0]), np.full(phi1.shape, discs[1]))
    masses, machine = asked.machine.masses, asked.machine.machine
    shafts = masses.driving_shaft_kg_mm2, *masses.between_inertia_kg_mm2

    def inertias(phi1: Array) -> tuple[Array, Array]:
        driving = np.full(phi1.shape, shafts[asked.number])
        if not asked.turns_crank:
            return driving, np.full(phi1.shape, shafts[asked.number + 1])
        crank = machine.transmission.driven_angle(asked.pair.shaft_rad(phi1), 0).value
        moving = machine.linkage.moving_masses(Jet.variable(crank, 2), masses)
        return driving, reduced_inertia(moving, masses)[0]

    return inertias


def _deviations_mm(drive: Geared, asked: ToothLoad) -> tuple[float, float]:
    """Deviations of base pitch and of profile form that the grades allow, the larger of both gears', less running in.

    Running in reduces them by half of its value for misaligned flanks, the mean of both materials (ISO 6336-1,
    y_alpha).
    """
    running, given, found = drive.running, drive.design.tolerances, []
    for gear, grade, teeth in zip(Gear, grades_of(drive.design), running.whole, strict=True):
        allowed = flank_tolerances(grade or GRADE, np.array(running.module_mm * teeth), running.module_mm)
        own = None if given is None else getattr(given, gear.value)
        pitch, profile = (None, None) if own is None else (own.single_pitch_mm, own.profile_mm)
        found.append(
            (
                float(allowed.single_pitch_mm if pitch is None else pitch) * cos(asked.place.rack_angle_rad),
                float(allowed.profile_form_mm if profile is None else profile),
            )
        )
    choices, larger = choices_of(drive.gears), np.max(found, axis=0)
    pitch, profile = (
        deviation - sum(running_in(choice, running, deviation) for choice in choices) / 4.0 for deviation in larger
    )
    return float(pitch), float(profile)


def mesh_stiffness(loading: Loading, running: Running) -> MeshStiffness | None:
    """The mean stiffness of a loading's teeth over a pitch; None without load."""
    contacts, even = loading.contacts, loading.even
    stiffness, pairs = (
        np.bincount(contacts.position, values, even.size)[even].astype(float)
        for values in (contacts.stiffness_n_mm, contacts.share)
    )
    cycle_rad = loading.cycle_rad if loading.closed else None
    pitches = running.whole[0] * (cycle_rad or running.stroke_rad / 2.0) / (2.0 * pi)
    per_pitch = max(round(int(even.sum()) / pitches), 1)
    return MeshStiffness.of(loading.phi1_rad[even], stiffness, pairs, cycle_rad, per_pitch)


@dataclass(frozen=True)
class ToldVibration:
    """Figures of a mesh's vibration.

    ``dynamic_factor`` is K_V at the largest load of a pair, and its driving angle.  The peak force is the largest of a
    pair with its own K_V, which may be elsewhere: the part from deviations does not grow with the load.  The resonance
    ratios are those of a turn.  The mesh resonates between pairs of driving angles in degrees, and somewhere in the
    turn at speeds of ``critical_rpm``; None without inertia.
    """

    dynamic_factor: float
    dynamic_factor_at_rad: float
    peak_tooth_force_vibrating_n: float
    dynamic_factor_is: Literal["given", "computed"]
    resonance_ratio_min: float
    resonance_ratio_max: float
    resonates_between_deg: list[tuple[float, float]]
    critical_rpm: tuple[float, float] | None


def told_vibration(
    drive: Geared, vibration: Vibration, mesh: MeshStiffness, phi1_rad: Array, factors: Array, force_n: Array
) -> ToldVibration:
    """Figures of a mesh of known stiffness with K_V under forces at driving angles, shape (n,) each."""
    turn = mesh.phi1_rad < 2.0 * pi
    phi1, most = mesh.phi1_rad[turn], int(force_n.argmax())
    ratios = vibration.resonance(phi1, mesh)
    least, greatest = float(ratios.min()), float(ratios.max())
    rpm = drive.machine.speed_rad_s / RAD_S_PER_RPM
    return ToldVibration(
        float(factors[most]),
        float(phi1_rad[most]),
        float((factors * force_n).max()),
        "computed" if drive.conditions.dynamic_factor is None else "given",
        least,
        greatest,
        _stretches_deg(phi1, (ratios >= RESONANCE[0]) & (ratios <= RESONANCE[1])),
        (rpm * RESONANCE[0] / greatest, rpm * RESONANCE[1] / least) if least > 0.0 else None,
    )


def _stretches_deg(phi1_rad: Array, inside: Mask) -> list[tuple[float, float]]:
    """The stretches of driving angles in degrees, shape (n,) and rising, where ``inside`` is true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int)))
    return [
        (degrees(float(phi1_rad[first])), degrees(float(phi1_rad[last - 1]))) for first, last in edges.reshape(-1, 2)
    ]


LEADING = 0.5
"""Share of the largest force above which places count for the greatest K_V of a turn: at small loads, deviations add
many times as much."""

SPEEDS, SLOWER, FASTER = 121, 4.0, 1.5
"""Number of speeds of a sweep, and its least range below and above the critical speeds.  Neighbouring speeds are about
a seventh of the width of a resonance with usual damping apart."""

MOST_TURNS = 2
"""Most turns of the driving gear that are computed in a sweep; teeth may need more to meet all their mates."""


@dataclass(frozen=True, eq=False)
class SpeedSweep:
    """A mesh at s driving speeds under the loads of the design's own speed; shape (s,) each.

    ``least`` and ``greatest`` are the resonance ratios of a turn, ``factor`` the greatest K_V of places with at least
    LEADING of the largest load.  ``load_factor`` is as in ``ncgear.dynamics.swinging_mesh``; None where the load
    changes flanks, so that the teeth part.
    """

    speed_rpm: Array
    least: Array
    greatest: Array
    factor: Array
    load_factor: Array | None


def speed_sweep(drive: Geared, vibration: Vibration, loading: Loading) -> SpeedSweep | None:
    """The sweep of a pair under its loads without knocks; None without inertia or load.

    None also for gears that turn less than once: they have no constant speed.
    """
    loads, running = loading.still or loading, drive.running
    mesh, contacts = mesh_stiffness(loads, running), loads.contacts
    if mesh is None or not loads.closed:
        return None
    pair_force = np.bincount(contacts.position, contacts.force_n, loads.even.size).astype(float)
    phi1, force = loads.phi1_rad[loads.even], pair_force[loads.even]
    told = told_vibration(drive, vibration, mesh, phi1, np.ones(phi1.size), force)
    if told.critical_rpm is None:
        return None
    own_rpm = drive.machine.speed_rad_s / RAD_S_PER_RPM
    ends = min(own_rpm, told.critical_rpm[0] / SLOWER), max(own_rpm, told.critical_rpm[1] * FASTER)
    speeds = np.unique(np.append(np.geomspace(*ends, SPEEDS), own_rpm))
    faster, leading = speeds / own_rpm, force >= LEADING * force.max()
    over = drive.conditions.application_factor
    factors = vibration.factors_at_speeds(phi1[leading], force[leading], mesh, over, faster)
    load_factor = _load_factor(drive, vibration, loads, faster * drive.machine.speed_rad_s)
    return SpeedSweep(
        speeds, faster * told.resonance_ratio_min, faster * told.resonance_ratio_max, factors.max(axis=1), load_factor
    )


def _load_factor(drive: Geared, vibration: Vibration, loads: Loading, speeds_rad_s: Array) -> Array | None:
    """Factor on the load of teeth that swing at driving speeds, shape (s,); None where the load changes flanks."""
    if loads.contacts.side.min() != loads.contacts.side.max():
        return None
    rows = np.flatnonzero(loads.even & (loads.phi1_rad < 2.0 * pi * MOST_TURNS))
    rows = rows[np.isin(rows, loads.contacts.position)]
    phi1, urge = loads.phi1_rad[rows], np.sign(loads.torque_n_mm[rows])
    arm = asked_of(drive).arms_mm(phi1, np.where(urge < 0.0, -1.0, 1.0))[:, 1]
    stiffness = np.bincount(loads.contacts.position, loads.contacts.stiffness_n_mm, loads.even.size)[rows]
    swinging = SwingingMesh(
        phi1,
        min(loads.cycle_rad, 2.0 * pi * MOST_TURNS),
        stiffness * arm**2,
        N_PER_KG_MM_S2 * vibration.reduced_kg(phi1) * arm**2,
        loads.error_rad[rows],
        loads.torque_n_mm[rows],
        drive.design.simulation.damping_ratio,
    )
    return swings(swinging, speeds_rad_s).load_factor
