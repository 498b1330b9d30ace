"""The files of ncgear balance: figures as JSON, pictures, corrected gears as STL."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ncgear.balance.counterweights import least_squares, minimax
from ncgear.balance.mechanism import Counterweight, DrivenCrank, accelerations
from ncgear.balance.shaking import Shaking, shaking, track
from ncgear.drawings.plots.balance_plots import campbell, loops
from ncgear.figures.balance.shaking import excitations_of
from ncgear.figures.numbers import json_text
from ncgear.files.meshes import stl_bytes
from ncgear.numerics.arrays import Array
from ncgear.project.balancing import Balancing, crank_counterweight

POINTS = 721
"""Points of a force's curve over one cycle."""


def balance_files(balancing: Balancing, figures: dict[str, Any]) -> dict[str, bytes]:
    """File names to contents."""
    return {"balance.json": json_text(figures).encode(), **_pictures(balancing), **_solids(balancing)}


def _pictures(balancing: Balancing) -> dict[str, bytes]:
    balance, files = balancing.balance, {}
    for number, (given, one) in enumerate(zip(balance.mechanisms, balancing.mounted, strict=True), start=1):
        files[f"shaking-{number}.png"] = loops(_forces(one.mechanism), "N", f"{given.name}: shaking force")
        if given.sweep is not None:
            tried = [replace(crank_counterweight(given.sweep), mass_kg=mass) for mass in given.sweep.masses_kg]
            tracks = {f"{added.mass_kg:g} kg": _track(one.mechanism, added) for added in tried}
            files[f"tracks-{number}.png"] = loops(
                tracks, "mm", f"{given.name}: tracks of the centre of mass about their middles"
            )
    if balance.excitations is not None:
        asked, title = balance.excitations, f"{balance.name}: excitations and natural frequencies"
        files["campbell.png"] = campbell(excitations_of(balancing), asked.natural_hz, asked.band, title)
    return files


def _forces(mechanism: DrivenCrank) -> dict[str, Array]:
    """Curves of the shaking force, without and with the best counterweights."""
    known, crank = accelerations(mechanism), mechanism.linkage.crank_mm
    curves = {"as given": _curve(shaking(mechanism, known))}
    if mechanism.wrist_kg == 0:
        return curves
    for name, best in (("least squares", least_squares), ("least peak", minimax)):
        added = best(mechanism, known).at(crank)
        curves[name] = _curve(shaking(mechanism.with_counterweight(added), known))
    return curves


def _curve(of: Shaking) -> Array:
    angle = np.linspace(0.0, of.along.cycle_rad, POINTS)
    return np.column_stack([of.along(angle), of.across(angle)])


def _track(mechanism: DrivenCrank, added: Counterweight) -> Array:
    """The track with a counterweight, moved so that its middle is the origin: the picture shows sizes, not places."""
    points = track(mechanism.with_counterweight(added)).points_mm
    return np.asarray(points - (points.min(axis=0) + points.max(axis=0)) / 2.0)


def _solids(balancing: Balancing) -> dict[str, bytes]:
    """The corrected gears as STL, read back and checked."""
    if balancing.balance.gears is None:
        return {}
    made = {f"{gear}-balanced.stl": one.corrected for gear, one in balancing.gears.items()}
    return {name: stl_bytes(found.mesh) for name, found in made.items() if found is not None}
