"""Figures of a planetary train, and its conditions beside contact."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, pi
from typing import Any

import numpy as np

from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.plane import as_complex
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.trains.loads import TrainForces, TrainLoads
from ncgear.trains.path_search import tool_mount
from ncgear.trains.tip_path import TipMotion, WishedPath, distances_mm
from ncgear.trains.train import Train, TrainCondition, TrainFigures

PATH_POINTS = 2880
"""Chords of the path in each turn: of a path 1 m long each is a third of a millimetre."""

NOT_JUDGED = (
    TrainCondition("forces", None, "torque and forces need masses"),
    TrainCondition("balance", None, "the balance of the carrier needs masses"),
)


def told_of(
    train: Train,
    idler: str,
    pitches: Sequence[PitchPair],
    rack_rad: float,
    wished: WishedPath | None,
    motion: TipMotion | None,
    forward_mm_s: float,
    loads: tuple[TrainLoads, TrainForces] | None,
    pace: Array | None = None,
) -> TrainFigures:
    """Figures and conditions of a train, from the pairs of one arm, the pair of the sun first.

    ``pace`` has the speed of the driving shaft over that of the carrier, None where it turns evenly.
    """
    planets = [number for number, part in enumerate(train.parts) if part.name.startswith("planet")]
    arms, poses = len(planets), train.poses_at(np.zeros(1))
    sun, planet = (complex(poses.places(number)[0][0]) for number in (0, planets[0]))
    pressure = max(pitch.largest_pressure_angle_deg(rack_rad) for pitch in pitches)
    dented = [-1.0 / radius for pitch in pitches for gear in Gear if (radius := pitch.least_concave_radius_mm(gear))]
    figures: dict[str, Any] = {
        "idler": idler,
        "arms": arms,
        "carrier_mm": abs(planet - sun),
        "axis_x_mm": sun.real,
        "axis_y_mm": sun.imag,
        "center_distances_mm": [pitch.center_distance_mm for pitch in pitches],
        "modules_mm": [pitch.size.module_mm for pitch in pitches],
        "ratio_min": [pitch.transmission.ratio_range[0].value for pitch in pitches],
        "ratio_max": [pitch.transmission.ratio_range[1].value for pitch in pitches],
        "max_pressure_angle_deg": pressure,
        "convex": not dented,
    }
    module = " and ".join(f"{module:.4g}" for module in dict.fromkeys(round(p.size.module_mm, 6) for p in pitches))
    distance = " and ".join(f"{pitch.center_distance_mm:.6g}" for pitch in pitches)
    ratios = ", ".join(
        f"{low:.4g} to {high:.4g}" for low, high in zip(figures["ratio_min"], figures["ratio_max"], strict=True)
    )
    rows = [
        ("carrier", f"{abs(planet - sun):.6g} mm from sun to planet, its axis at {sun.real:.5g}, {sun.imag:.5g} mm"),
        ("gears", f"{pitches[0].size.driving_teeth} teeth, module {module} mm, centre distances {distance} mm"),
        ("ratio of each pair", ratios),
        ("pressure angle", f"{pressure:.4g} deg at most"),
    ]
    if pace is not None:
        closed = pace / pace.mean()
        said = f"the shaft that drives it turns {closed.min():.4g} to {closed.max():.4g} times as fast"
        rows.append(("pace of the carrier", said))
        figures["carrier_ratio"] = closed.tolist()
    conditions = [_closing(train)]
    if train.traces:
        path_rows, path_figures, condition = _of_path(train, wished, forward_mm_s)
        if wished is not None and motion is not None and wished.tool_rad:
            mount, missed = (degrees(angle) for angle in tool_mount(motion, wished))
            path_rows.append(("tool", f"{mount:.4g} deg from the arm, its angles missed by {missed:.3g} deg at most"))
            path_figures |= {"tool_mount_deg": mount, "tool_missed_max_deg": missed}
        rows += path_rows
        figures |= path_figures
        conditions += condition
    unknown: tuple[TrainCondition, ...] = NOT_JUDGED
    if loads is not None:
        load_rows, load_figures, unknown = _of_loads(train, *loads)
        rows += load_rows
        figures |= load_figures
    inside = "planets in a ring" if idler == "ring" else f"{idler} idler"
    head = f"planetary train, {inside}, {arms} arm{'s' * (arms > 1)}, {train.speed_rpm:g} turns a minute"
    return TrainFigures(head, tuple(rows), figures, (*conditions, *unknown))


def _closing(train: Train) -> TrainCondition:
    """Whether the train stands after a cycle as at first, but for whole turns, which the meshes of every arm need."""
    ends = train.poses_at(np.array([0.0, train.cycle_rad]))
    turned = np.diff(ends.angle_rad - ends.angle_rad[train.number("carrier")])[:, 0] / (2.0 * pi)
    missed = float(np.abs(turned - np.round(turned)).max()) * 2.0 * pi
    said = f"closes within {missed:.2g} rad; the gears of every arm are the same, for any number of teeth"
    return TrainCondition("assembly", missed < CLOSED_RAD, said)


CLOSED_RAD = 1e-9
"""Closure error that counts as rounding: a nanometre at a metre."""


WORTH = 0.1
"""Share of the greatest shaking force that a counterweight must remove to be worth its weight."""

FELT, GRAVITY_M_S2 = 1e-3, 9.80665
"""Share of the weight of all parts under which nobody feels that they shake their frame."""


def _of_loads(
    train: Train, loads: TrainLoads, joints: TrainForces
) -> tuple[list[tuple[str, str]], dict[str, Any], tuple[TrainCondition, ...]]:
    """The torques of carrier and sun, the forces of teeth, axes and frame, and whether a counterweight helps."""
    torque = carrier_torque_n_m(train, loads, joints)
    low, high = float(torque.min()), float(torque.max())
    suns = {name: (float(each.min()), float(each.max())) for name, each in joints.driven_n_m.items()}
    teeth, axes = joints.largest_n()
    now, left = float(np.abs(loads.force_n).max()), float(np.abs(loads.left_n).max())
    weight, where = abs(loads.counterweight_kg_mm), float(np.degrees(np.angle(loads.counterweight_kg_mm)))
    rows = [
        ("torque of the carrier", f"{low:.4g} to {high:.4g} N m at even speed, without friction"),
        *((f"torque of the {name}", f"{least:.4g} to {most:.4g} N m") for name, (least, most) in suns.items()),
        *(
            (where, "; ".join(f"{name} {most:.4g} N" for name, most in forces.items()) + " at most")
            for where, forces in (("between teeth", teeth), ("on the axes", axes))
            if forces
        ),
        ("on the frame", f"inertia forces to {now:.4g} N, moment to {np.abs(loads.moment_n_m).max():.4g} N m"),
    ]
    figures = {
        "mass_kg": loads.mass_kg,
        "torque_min_n_m": low,
        "torque_max_n_m": high,
        "torque_mean_n_m": float(torque.mean()),
        **{
            f"{name}_torque_{end}_n_m": value
            for name, ends in suns.items()
            for end, value in zip(("min", "max"), ends, strict=True)
        },
        "tooth_forces_max_n": teeth,
        "axis_forces_max_n": axes,
        "shaking_force_max_n": now,
        "shaking_moment_max_n_m": float(np.abs(loads.moment_n_m).max()),
        "counterweight_kg_mm": weight,
        "counterweight_deg": where,
        "shaking_force_left_max_n": left,
    }
    # Forces of a train that hardly moves are rounding beside its weight
    needed = left < (1.0 - WORTH) * now and now > FELT * loads.mass_kg * GRAVITY_M_S2
    would = f"{weight:.4g} kg mm on the carrier, at first at {where:.4g} deg, would leave {left:.4g} of {now:.4g} N"
    balanced = f"no counterweight on the carrier takes a tenth off its {now:.4g} N"
    balance = TrainCondition("balance", not needed, would if needed else balanced)
    forces = TrainCondition("forces", None, "a check rates no teeth, shafts and bearings; torque and forces are told")
    return rows, figures, (balance, forces)


def carrier_torque_n_m(train: Train, loads: TrainLoads, joints: TrainForces) -> Array:
    """The torque of the carrier at the driving angles of its loads, shape (n,), without what bodies of the frame bear.

    Virtual work gives the torque of all that is driven, each times its speed over that of the driving part.
    """
    torque, turns = loads.torque_n_m, train.poses_at(np.array([0.0, train.cycle_rad])).angle_rad
    for name, driven in joints.driven_n_m.items():
        start, end = turns[train.number(name)]
        torque = torque - float(end - start) / train.cycle_rad * driven
    return torque


def _of_path(
    train: Train, wished: WishedPath | None, forward_mm_s: float
) -> tuple[list[tuple[str, str]], dict[str, Any], list[TrainCondition]]:
    trace = train.traces[0]
    angles = np.linspace(0.0, train.cycle_rad, PATH_POINTS * train.turns + 1)
    path = train.trace_mm(trace, angles)
    places = as_complex(path)
    arm = float(np.hypot(*trace.at_mm))
    per_second = train.speed_rpm * 2.0 * pi / 60.0
    speed = np.gradient(places, angles) * per_second
    figures: dict[str, Any] = {
        "arm_mm": arm,
        "path_length_mm": float(np.abs(np.diff(places)).sum()),
        "tip_speed_max_mm_s": float(np.abs(speed).max()),
    }
    rows = [("arm", f"{arm:.6g} mm, its tip {np.abs(speed).max():.4g} mm/s at most")]
    conditions = []
    if wished is not None:
        missed = distances_mm(wished.points, places)
        passed = np.abs(wished.points[:, None] - places).argmin(axis=1)
        figures |= {"point_speeds_mm_s": np.abs(speed[passed]).tolist()}
        figures |= {"path_missed_mm": missed.tolist(), "path_missed_max_mm": float(missed.max())}
        worst = int(np.argmax(missed / wished.tolerance_mm))
        allowed = f"{missed[worst]:.3g} of {wished.tolerance_mm[worst]:g} mm allowed at point {wished.name(worst)}"
        said = f"passes {len(missed)} points, the worst with {allowed}"
        conditions.append(TrainCondition("path", bool((missed <= wished.tolerance_mm).all()), said))
    if forward_mm_s:
        row, more = _over_ground(places, speed, train, forward_mm_s)
        rows.append(row)
        figures |= more
    return rows, figures, conditions


def _over_ground(
    places: ComplexArray, speed: ComplexArray, train: Train, forward_mm_s: float
) -> tuple[tuple[str, str], dict[str, Any]]:
    """Motion of the tip over the ground at its lowest place, and the distance between such places on the ground."""
    lowest = int(np.argmin(places.imag))
    slip = float(speed[lowest].real + forward_mm_s)
    arms = len(train.traces)
    period_s = train.cycle_rad / (train.speed_rpm * 2.0 * pi / 60.0)
    spacing = abs(forward_mm_s) * period_s / arms
    said = f"lowest place every {spacing:.4g} mm of ground, there {slip:.4g} mm/s along it"
    figures = {"forward_mm_s": forward_mm_s, "spacing_mm": spacing, "lowest_speed_over_ground_mm_s": slip}
    return ("over the ground", said), figures
