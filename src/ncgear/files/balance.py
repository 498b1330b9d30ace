"""The files of ncgear balance: figures as JSON, corrected gears as STL, and pictures.

Pictures show shaking forces round a cycle, tracks of the centre of mass, and a Campbell plot.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ncgear.balance.counterweights import least_squares, minimax
from ncgear.balance.excitation import Excitation
from ncgear.balance.mechanism import Counterweight, DrivenCrank, accelerations
from ncgear.balance.shaking import Shaking, shaking, track
from ncgear.drawings.plots import canvas
from ncgear.drawings.plots.canvas import Style
from ncgear.figures.balance.shaking import excitations_of
from ncgear.figures.numbers import json_text, to_digits
from ncgear.files.read_back import stl_bytes
from ncgear.numerics.arrays import Array
from ncgear.project.balancing import Balancing, crank_counterweight

COLORS = (canvas.DRIVING, canvas.DRIVEN, canvas.HIGHLIGHT, canvas.REFERENCE)
"""Colours of closed curves; further curves have the same colours, dashed."""

MOST_CURVES = 8
"""Most closed curves in one picture, evenly chosen: nobody could tell more curves apart."""

WIDEST_AND_THINNEST = 2.6, 1.2
"""Widths in points of the first and of the last of several closed curves."""

SLOWEST, FASTEST = 0.2, 1.25
"""The range of speeds of a Campbell plot, as shares of the given speed."""

SAMPLES = 61
"""Points of a line in a Campbell plot; the logarithmic scale bends lines."""

LEAST_GAP = 0.03
"""Least distance of two numbers beside a Campbell plot, as a share of its height."""

CAUSES = {
    "rotation": canvas.DRIVING,
    "rollers and teeth": canvas.REFERENCE,
    "engine": canvas.HIGHLIGHT,
    "slider": canvas.DRIVEN,
}
"""Colours of excitations in a Campbell plot, by their cause."""


def loops(curves: Mapping[str, Array], unit: str, title: str) -> bytes:
    """PNG of closed curves (shape (n, 2)) at equal scales, by their names; ``unit`` names both axes."""
    width, height = 7.2, 6.6
    made = canvas.figure(width, height, title, canvas.Margins(top=0.9))
    axes = made.add_subplot()
    names = list(curves)
    places = np.unique(np.linspace(0, len(names) - 1, min(len(names), MOST_CURVES)).round().astype(int))
    for number, name in enumerate(names[place] for place in places):
        color, style = COLORS[number % len(COLORS)], "-" if number < len(COLORS) else "--"
        # Later curves are thinner: where two of them agree, both show.
        width = np.interp(number, (0, max(len(places) - 1, 1)), WIDEST_AND_THINNEST)
        axes.plot(*curves[name].T, color=color, linestyle=style, linewidth=width, label=name)
    axes.set_aspect("equal", adjustable="datalim")
    canvas.dress(axes, f"along the slider's line in {unit}", f"across it in {unit}")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, frameon=False, fontsize=canvas.SMALL)
    return canvas.png(made)


def campbell(excitations: Sequence[Excitation], natural_hz: Sequence[float], band: float, title: str) -> bytes:
    """PNG of the frequencies of excitations over the machine's speed, with the natural frequencies across.

    ``band`` is a share of a natural frequency: an excitation that is nearer counts as meeting that frequency.  All
    shafts are assumed to speed up and slow down together.
    """
    width, height = 8.6, 6.2
    made = canvas.figure(width, height, title, canvas.Margins(right=1.3, top=0.8))
    axes = made.add_subplot()
    for natural in natural_hz:
        axes.axhspan((1.0 - band) * natural, (1.0 + band) * natural, color=canvas.INK, alpha=0.06, linewidth=0.0)
        axes.axhline(natural, color=canvas.INK, linewidth=1.0)
    share = np.linspace(SLOWEST, FASTEST, SAMPLES)
    for excitation in excitations:
        color = CAUSES[_cause(excitation)]
        axes.plot(100.0 * share, share * excitation.frequency_hz, color=color, linewidth=0.9)
        axes.plot(100.0, excitation.frequency_hz, "o", color=color, markersize=3.0)
    lowest = min(excitation.frequency_hz for excitation in excitations)
    axes.set_ylim(min(min(natural_hz) / 4.0, lowest / 2.0), 1.6 * max(natural_hz))
    axes.set_yscale("log")
    axes.set_xlim(100.0 * SLOWEST, 100.0 * FASTEST)
    axes.axvline(100.0, color=canvas.INK, linewidth=0.8, linestyle=":")
    causes = set(map(_cause, excitations))
    for cause, color in CAUSES.items():
        if cause in causes:
            axes.plot([], [], color=color, label=cause)
    _name_natural(axes, natural_hz)
    canvas.dress(axes, "speed in % of the one given", "frequency in Hz")
    canvas.legend_above(axes)
    return canvas.png(made)


def _cause(excitation: Excitation) -> str:
    if excitation.kind.startswith("harmonic"):
        return "slider"
    if excitation.kind in ("combustion", "inertia"):
        return "engine"
    return "rotation" if excitation.kind == "rotation" else "rollers and teeth"


def _name_natural(axes: Axes, natural_hz: Sequence[float]) -> None:
    """Natural frequencies at the right end, moved apart where they are close, and plain numbers on the scale."""
    canvas.plain_log(axes.yaxis, (1.0, 2.0, 5.0))
    low, high = np.log(axes.get_ylim())
    heights = (np.log(sorted(natural_hz)) - low) / (high - low)
    note: Style = {"transform": axes.transAxes, "size": canvas.SMALL, "color": canvas.INK, "va": "center"}
    for natural, height in zip(sorted(natural_hz), spread(heights, LEAST_GAP), strict=True):
        axes.text(1.01, height, f"{to_digits(natural, 4)} Hz", **note)


def spread(heights: Array, gap: float) -> Array:
    """Rising heights (shape (n,)) moved apart so that each is at least a gap above the height before it.

    A height that is far enough from its neighbours stays where it is.
    """
    steps = gap * np.arange(len(heights))
    raised = np.maximum.accumulate(heights - steps)
    lowered = np.minimum.accumulate((heights - steps)[::-1])[::-1]
    return (raised + lowered) / 2.0 + steps


POINTS = 721
"""Points of a force's curve over one cycle."""


def balance_files(balancing: Balancing, figures: dict[str, Any]) -> dict[str, bytes]:
    """File names to contents."""
    return {"balance.json": json_text(figures).encode(), **_pictures(balancing), **_solids(balancing)}


def _pictures(balancing: Balancing) -> dict[str, bytes]:
    balance, files = balancing.balance, {}
    for number, (given, in_frame) in enumerate(zip(balance.mechanisms, balancing.mounted, strict=True), start=1):
        files[f"shaking-{number}.png"] = loops(_forces(in_frame.mechanism), "N", f"{given.name}: shaking force")
        if given.sweep is not None:
            tried = [replace(crank_counterweight(given.sweep), mass_kg=mass) for mass in given.sweep.masses_kg]
            tracks = {f"{added.mass_kg:g} kg": _track(in_frame.mechanism, added) for added in tried}
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
    made = {f"{gear}-balanced.stl": balanced.corrected for gear, balanced in balancing.gears.items()}
    return {name: stl_bytes(found.mesh.as_trimesh()) for name, found in made.items() if found is not None}
