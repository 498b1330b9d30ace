"""The data of the page's script, as plain values for JSON: the pace, the scene, the lines of the charts.

``scene.js`` gets tables of the shafts' angles, the mechanism, the places of the gears, and the views.  The script gets
the samples of each chart and the places of its scales in its SVG.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial
from math import ceil, degrees, log10, pi
from typing import Any

import numpy as np

from ncgear.drawings.charts.chart import ChartLine
from ncgear.drawings.page.chart_figure import ChartFigure
from ncgear.drawings.scene.geared_pairs import SceneGear
from ncgear.drawings.scene.scene import Scene
from ncgear.drawings.scene.standing import views
from ncgear.figures.numbers import shown
from ncgear.frozen import dataclass
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import Piece, Transmission

READABLE_DEG_S = 30.0
"""A pace at which the eye follows a tooth through the mesh: one turn of the driving gear in twelve seconds."""

PACES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
"""Multiples of the operating speed that the page offers."""

DEG_S_PER_RPM = 6.0


@dataclass(frozen=True)
class PicturePace:
    """A pace of the picture, in degrees of the driving gear per second."""

    name: str
    deg_s: float


def paces(speed_rpm: float) -> list[PicturePace]:
    """The paces of a machine, the readable one first."""
    speeds = {times: times * speed_rpm for times in PACES}
    multiples = (
        PicturePace(f"{n:g}\u00d7 ({shown(speed)} r/min)", speed * DEG_S_PER_RPM) for n, speed in speeds.items()
    )
    return [PicturePace(f"readable ({READABLE_DEG_S:g}\u00b0/s)", READABLE_DEG_S), *multiples]


TABLE_ERROR_RAD = 1e-7
"""Largest error in rad of an interpolated angle at the places of LOOKED_AT.

Nowhere is the error twice as large (tests/test_scene_page.py).
"""

LOOKED_AT = (0.25, 0.5, 0.75)
"""Shares of every step at which the error is computed, the middle second.

The error of the cubics is greatest in the middle, or beside it where the law changes fast.
"""

SHARES = np.array(LOOKED_AT)[:, None]

FIRST_STEPS = 16
"""Number of steps on each piece of a law before any step is halved."""

TOOTH_DECIMALS = 5
"""Decimals of places of teeth: two more than on a drawing; places are in mm, or in modules under a millimetre."""

NUMBER_IN_MODULES = 0.85
"""Height of a tooth's number in modules: two digits are narrower than a tooth."""

LINK_DECIMALS = 9
"""Decimals of places in mm and angles in rad of links, of short cranks in cranks: finer than their tables' error."""


def scene_data(scene: Scene) -> dict[str, Any]:
    """All data that move the SVG of ``scene_svg``, ready for JSON; angles in rad, lengths in mm."""
    return {
        "loop": scene.loop_rad,
        "shafts": shaft_tables(scene),
        "gears": [_gear(gear, pair.module_mm) for pair in scene.pairs for gear in (pair.driving, pair.driven)],
        "pairs": [
            {
                "axes": [list(pair.mounting.driving_axis_mm), list(pair.mounting.driven_axis_mm)],
                "sense": pair.mounting.mesh.sense,
                "shaft": pair.shaft,
            }
            for pair in scene.pairs
        ],
        "linkage": _linkage(scene),
        "chamber": scene.chamber and {name: getattr(scene.chamber, f"{name}_mm") for name in CHAMBER},
        "views": {name: list(box) for name, box in views(scene).items()},
    }


def shaft_tables(scene: Scene) -> list[dict[str, Any]]:
    """Tables of the angles of all shafts after the driving shaft, each by the shaft before it; the crank's last."""
    shafts = [*(pair.transmission for pair in scene.train.pairs[:-1]), scene.train.whole]
    return [angle_table(transmission) for transmission in shafts]


def angle_table(transmission: Transmission) -> dict[str, Any]:
    """A law for Hermite's cubics: ascending driving angles over one period, the driven angles, and the slopes.

    Joints of the law are in it twice, with the slopes on both sides.
    """
    columns = [_tables(partial(_law, piece), piece.start_rad, piece.end_rad)[0] for piece in transmission.pieces]
    at, value, slope = np.concatenate(columns, axis=1).tolist()
    lobes = transmission.lobes
    periods = {"period": lobes.driving_period_rad, "rise": lobes.driven_period_rad}
    return {**periods, "at": at, "value": value, "slope": slope}


def _law(piece: Piece, phi1: Array) -> Array:
    return piece.driven_angle(phi1, 1).coefficients[:, None]


Curves = Callable[[Array], Array]
"""From places, shape (n,), to the values and slopes of k curves there, shape (2, k, n)."""


def _tables(curves: Curves, start_rad: float, end_rad: float) -> list[Array]:
    """Places, values and slopes of each of several curves for Hermite's cubics, shape (3, m) each.

    A step is halved where its error exceeds TABLE_ERROR_RAD at any of the places of LOOKED_AT.  The steps of all curves
    are tested together, since the curves share most of their computation.
    """
    at = np.linspace(start_rad, end_rad, FIRST_STEPS + 1)
    found = curves(at)
    count = found.shape[1]
    first = np.concatenate([np.broadcast_to(at, (1, count, at.size)), found])
    known, owners = [first.reshape(3, -1)], [np.repeat(np.arange(count), at.size)]
    low, high = (ends.reshape(3, -1) for ends in (first[..., :-1], first[..., 1:]))
    owner = np.repeat(np.arange(count), FIRST_STEPS)
    while owner.size:
        places = low[0] + SHARES * (high[0] - low[0])
        exact = curves(places.ravel()).reshape(2, count, *places.shape)[:, owner, :, np.arange(owner.size)]
        off = np.any(np.abs(_cubics(low, high) - exact[:, 0].T) > TABLE_ERROR_RAD, axis=0)
        low, high, owner = low[:, off], high[:, off], owner[off]
        middle = np.array([(low[0] + high[0]) / 2.0, *exact[off, :, 1].T])
        known.append(middle)
        owners.append(owner)
        low, high, owner = np.hstack([low, middle]), np.hstack([middle, high]), np.tile(owner, 2)
    columns, owner = np.hstack(known), np.concatenate(owners)
    order = np.lexsort((columns[0], owner))
    return np.split(columns[:, order], np.searchsorted(owner[order], np.arange(1, count)), axis=1)


def _cubics(low: Array, high: Array) -> Array:
    """Hermite's cubics at each of the shares of LOOKED_AT of each step, shape (shares, steps).

    The steps go from ``low`` to ``high``: places, values and slopes, shape (3, steps).
    """
    (width, rise, _), rest = high - low, 1.0 - SHARES
    straight = low[1] + rise * SHARES**2 * (3.0 - 2.0 * SHARES)
    return straight + width * SHARES * rest * (low[2] * rest - high[2] * SHARES)


CHAMBER = ("face", "start", "end", "begins", "behind", "level", "pushed")
"""The values of a chamber that scene.js has, in mm."""


def _gear(gear: SceneGear, module_mm: float) -> dict[str, Any]:
    mounting = gear.mounting
    return {
        "name": gear.body.name,
        "axis": list(gear.axis_mm),
        "start": mounting.turn_rad,
        "sense": mounting.sense(gear.gear),
        "shaft": gear.shaft,
        "facing": gear.facing_rad,
        "teeth": {
            "at": _places(gear.teeth_mm, module_mm),
            "label": _places(gear.numbers_mm, module_mm),
            "size": NUMBER_IN_MODULES * module_mm,
        },
    }


def _places(points_mm: Array, module_mm: float) -> list[list[float]]:
    return [_rounded(place, TOOTH_DECIMALS + _more(module_mm)) for place in points_mm]


def _more(size: float) -> int:
    """Number of decimals that a size under 1 has more than a size of 1 or more."""
    return max(0, ceil(-log10(size)))


def _linkage(scene: Scene) -> dict[str, Any]:
    linkage = scene.machine.linkage
    return {
        "links": _link_tables(linkage),
        "pins": dict(linkage.PINS),
        "output": linkage.OUTPUT.name,
        "offset": linkage.offset_mm,
        "nearest": linkage.nearest_mm,
        "stroke": linkage.stroke_mm,
        "working": linkage.working_angle_rad,
    }


@lru_cache(maxsize=16)
def _link_tables(linkage: Mechanism) -> dict[str, Any]:
    """Tables of the places and the angles of all links over a turn of the crank.

    Lengths are divided by the length of the crank, and are then as exact as the angles.  They depend on the mechanism
    alone, and are kept while its law changes.
    """
    names = tuple(linkage.links(Jet(np.zeros((1, 1)))))
    scales = {"x": linkage.crank_mm, "y": linkage.crank_mm, "angle": 1.0}
    shares = 1.0 / np.array(list(scales.values()) * len(names))

    def curves(angle: Array) -> Array:
        links = linkage.links(Jet.variable(angle, 1))
        found = [jet.coefficients for link in links.values() for jet in (link.origin.x, link.origin.y, link.angle)]
        return np.reshape(found, (shares.size, 2, angle.size)).swapaxes(0, 1) * shares[:, None]

    tables = iter(_tables(curves, 0.0, 2.0 * pi))
    return {name: {key: link_table(next(tables), scale) for key, scale in scales.items()} for name in names}


def link_table(table: Array, scale: float) -> dict[str, Any]:
    """A table of a link with the places and slopes times ``scale``; a link at rest needs only both ends."""
    at, value, slope = table if table[2].any() else table[:, [0, -1]]
    value, slope = scale * value, scale * slope
    rise = float(value[-1] - value[0])
    values, slopes = (_rounded(column, LINK_DECIMALS + _more(scale)) for column in (value, slope))
    return {"period": float(at[-1]), "rise": rise, "at": at.tolist(), "value": values, "slope": slopes}


ANGLE_DECIMALS = 9
"""Decimals of angles in degrees: a jump and the samples beside it are sixty units of the last one apart."""

MORE_DECIMALS = 3
"""Number of decimals in the tables beyond those that the page shows."""

GridKey = tuple[bytes, float]
"""The angles of a line and its period; lines that agree in both share a grid."""


def page_data(scene: Scene, figures: Sequence[ChartFigure]) -> dict[str, Any]:
    """All data of the script."""
    return {
        "cycle_deg": degrees(scene.loop_rad),
        "swings": scene.swings,
        "scene": scene_data(scene),
        **chart_data(figures),
    }


def chart_data(figures: Sequence[ChartFigure]) -> dict[str, Any]:
    """The charts and their grids: angles that several lines share are there once, and lines name them by number."""
    grids = {
        _grid_key(line, figure.page_chart.period_deg): line
        for figure in figures
        for line in figure.page_chart.chart.lines
    }
    numbers = {key: number for number, key in enumerate(grids)}
    return {
        "grids": [
            {"period_deg": period, "deg": _rounded(line.x, ANGLE_DECIMALS)} for (_, period), line in grids.items()
        ],
        "charts": [_chart(figure, numbers) for figure in figures],
    }


def _grid_key(line: ChartLine, period_deg: float) -> GridKey:
    return line.x.tobytes(), period_deg


def _chart(figure: ChartFigure, numbers: Mapping[GridKey, int]) -> dict[str, Any]:
    page_chart = figure.page_chart
    decimals, period = page_chart.decimals, page_chart.period_deg
    lines = [
        {"grid": numbers[_grid_key(line, period)], "values": _rounded(line.values, decimals + MORE_DECIMALS)}
        for line in page_chart.chart.lines
    ]
    scales = {name: getattr(figure, name) for name in ("angle_deg", "x", "values", "y")}
    return {"key": page_chart.key, "angle": page_chart.shaft, "decimals": decimals, **scales, "lines": lines}


def _rounded(values: Array, decimals: int) -> list[float]:
    return np.round(values, decimals).tolist()
