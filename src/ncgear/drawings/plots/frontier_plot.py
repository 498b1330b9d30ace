"""Power against acceleration: what no law can reach, what laws come to, and where mechanisms stand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ncgear.drawings.plots.canvas import (
    DRIVEN,
    DRIVING,
    HIGHLIGHT,
    INK,
    REFERENCE,
    SMALL,
    Margins,
    dress,
    figure,
    key_above,
    png,
)
from ncgear.figures.numbers import readable
from ncgear.numerics.arrays import Array

WIDTH_IN, HEIGHT_IN = 8.2, 5.8
ROOM = 1.6
"""Room above the highest mechanism, as a factor: the family's steep end may leave the picture."""

Named = tuple[str, float, float]
"""A mechanism: name, power in W, acceleration in mm/s2."""


def frontier(limit: Array, laws: Array, family: Array, mechanisms: Sequence[Named], title: str) -> bytes:
    """PNG of the frontier; ``limit``, ``laws`` and ``family`` have rows of power in W and acceleration in mm/s2."""
    (by_power, power_unit), (by_acceleration, acceleration_unit) = _units(limit, laws, mechanisms)
    factors = np.array([by_power, by_acceleration])
    made = figure(WIDTH_IN, HEIGHT_IN, title)
    made.subplots_adjust(**Margins(left=0.8, right=0.25, top=0.8).shares(WIDTH_IN, HEIGHT_IN))
    axes = made.add_subplot()
    named = [(name, by_power * power, by_acceleration * peak) for name, power, peak in mechanisms]
    _draw(axes, factors * limit, factors * laws, factors * family, named)
    dress(axes, f"peak power in {power_unit}", f"peak acceleration in {acceleration_unit}")
    key_above(axes)
    return png(made)


def _draw(axes: Axes, limit: Array, laws: Array, family: Array, mechanisms: Sequence[Named]) -> None:
    _impossible(axes, limit)
    axes.plot(*limit.T, color=INK, linewidth=1.6, label="certified limit")
    # A single law must show on top of the mechanism that it may be.
    size = 3.5 if len(laws) > 1 else 8.0
    style: dict[str, Any] = {"color": DRIVING, "linewidth": 1.8, "marker": "o", "markersize": size, "zorder": 4}
    axes.plot(*laws.T, label="laws that can be made", **style)
    if family.size:
        axes.plot(*family.T, color=DRIVEN, linewidth=1.4, marker="s", markersize=3.0, label="published family")
    for mechanism in mechanisms:
        _mechanism(axes, mechanism)
    _scales(axes, limit, laws, mechanisms)


def _units(limit: Array, laws: Array, mechanisms: Sequence[Named]) -> tuple[tuple[float, str], tuple[float, str]]:
    """Factor and name of the units of power and of acceleration in which all that must show is read."""
    shown = np.vstack([limit, laws, rows([mechanism[1:] for mechanism in mechanisms])])
    return readable("W", shown[:, 0]), readable("mm/s\u00b2", shown[:, 1])


def _impossible(axes: Axes, limit: Array) -> None:
    power, acceleration = limit.T
    axes.fill_between(power, acceleration, 1e-3, color=REFERENCE, alpha=0.14, linewidth=0.0)
    axes.text(
        0.03, 0.05, "impossible for any law", transform=axes.transAxes, size=SMALL, color=REFERENCE, style="italic"
    )


def _mechanism(axes: Axes, mechanism: Named) -> None:
    name, power, acceleration = mechanism
    axes.plot([power], [acceleration], color=HIGHLIGHT, marker="D", markersize=6.0, linestyle="none")
    # Names are free text: dollar signs are not formulas.
    axes.annotate(
        name,
        (power, acceleration),
        xytext=(6.0, 5.0),
        textcoords="offset points",
        size=SMALL,
        color=INK,
        parse_math=False,
    )


def _scales(axes: Axes, limit: Array, laws: Array, mechanisms: Sequence[Named]) -> None:
    powers = [*limit[:, 0], *laws[:, 0], *(power for _, power, _ in mechanisms)]
    accelerations = [*limit[:, 1], *laws[:, 1], *(acceleration for _, _, acceleration in mechanisms)]
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(min(powers) / 1.05, max(powers) * 1.35)
    axes.set_ylim(min(accelerations) / 1.25, max(accelerations) * ROOM)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0, 7.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def rows(points: Sequence[tuple[float, float]]) -> Array:
    """Points as rows, shape (n, 2)."""
    return np.array(points, dtype=float).reshape(-1, 2)
