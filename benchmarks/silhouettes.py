"""How near gears come to drawn outlines: fits of a folder of silhouettes, with their deviation and time.

Run as ``python benchmarks/silhouettes.py FOLDER``; writes benchmarks/silhouettes.md in two minutes.  The folder holds
outlines as text files of pairs ``x y``, separated by commas, as those of the public repository
xuhaocuhk/non-circular-gears (H. Xu and others, Eurographics 2020) have them; none of its files is kept here.
Deviations are measured by shapely, between the outline and the pitch curve of the teeth that are made.
"""

from __future__ import annotations

import os
import platform
import sys
from pathlib import Path
from time import process_time
from typing import Any

os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}

import numpy as np
import shapely

import ncgear
from ncgear.project.outline_fit import OutlineFit

PAGE = Path(__file__).parent / "silhouettes.md"

SIZE_MM, TEETH = 64.0, 64

TWO = "heart", "fish"
"""Outlines of a gear and of its mate."""

PYTHON = platform.python_version()

POINTS, CURVE = 4000, 4000
"""Even points of outline and curve whose distances are measured, and points of the curve."""

FEWEST = 6
"""Corners under which an outline gets the middles of its sides as well."""


def outline(path: Path) -> np.ndarray:
    """The corners of a file, shape (n, 2), the greater of width and height being SIZE_MM."""
    corners = np.array([pair.split() for pair in path.read_text(encoding="utf-8").split(",") if pair.strip()], float)
    corners *= SIZE_MM / np.ptp(corners, axis=0).max()
    if len(corners) < FEWEST:
        corners = np.stack([corners, (corners + np.roll(corners, -1, axis=0)) / 2.0], axis=1).reshape(-1, 2)
    # Files have the axis of pictures, down.
    return corners * (1.0, -1.0)


def measured(outline_mm: np.ndarray, curve_mm: np.ndarray) -> tuple[float, float, str]:
    """Root of the mean square over even points of both, the greatest distance, and its place, by shapely."""
    rings = shapely.LinearRing(outline_mm), shapely.LinearRing(curve_mm)
    square, greatest, place = 0.0, 0.0, ""
    for one, other, of in zip(rings, rings[::-1], ("outline", "curve"), strict=True):
        even = shapely.line_interpolate_point(one, (np.arange(POINTS) + 0.5) / POINTS, normalized=True)
        square += float(np.mean(shapely.distance(even, other) ** 2)) / 2.0
        points = np.concatenate([even, shapely.points(shapely.get_coordinates(one))])
        away = shapely.distance(points, other)
        if away.max() > greatest:
            at = points[away.argmax()]
            greatest, place = float(away.max()), f"({at.x:.1f}, {at.y:.1f}) of the {of}"
    return square**0.5, greatest, place


def fitted(path: Path, **options: Any) -> tuple[OutlineFit, float]:
    """A fit, and its processor time in s, that of the teeth included."""
    begun = process_time()
    found = ncgear.fit(outline(path), teeth=TEETH, gears={"drives": "both_ways"}, **options)
    return found, process_time() - begun


def of_teeth(found: OutlineFit) -> np.ndarray:
    """The pitch curve on which the teeth stand, in the drawing, shape (n, 2)."""
    return found.drive.pitch.driving.drawn(CURVE).position + found.curve.axis_mm


def row(path: Path) -> str:
    """A fit as a row of the table."""
    try:
        found, seconds = fitted(path)
    except ncgear.NoSuchMechanism as refused:
        return f"| {path.stem} | refused: {refused.problem} | | | | |"
    cells = told(measured(outline(path), of_teeth(found)))
    return f"| {path.stem} | {' | '.join(cells)} | {found.contact_ratio:.2f} | {seconds:.1f} |"


def row_of_two(folder: Path) -> str:
    """Both gears follow an outline, with equal weights."""
    own, mate = (folder / f"{name}.txt" for name in TWO)
    found, seconds = fitted(own, mate_mm=outline(mate))
    other = found.mate
    assert other is not None
    one = measured(outline(own), of_teeth(found))
    two = measured(other.scale * outline(mate), other.scale * other.points_mm)
    roots, greatest, places = (" and ".join(pair) for pair in zip(*map(told, (one, two)), strict=True))
    names = f"{TWO[0]}, its mate a {TWO[1]} of {other.size_mm:.0f} mm"
    return f"| {names} | {roots} | {greatest} | {places} | {found.contact_ratio:.2f} | {seconds:.1f} |"


def told(figures: tuple[float, float, str]) -> tuple[str, str, str]:
    """Measured figures as text."""
    root, greatest, place = figures
    return f"{root:.3f}", f"{greatest:.1f}", place


def page(folder: Path) -> str:
    """The whole page."""
    rows = [row(path) for path in sorted(folder.glob("*.txt"))]
    rows.append(row_of_two(folder))
    load = f"while it ran, {os.getloadavg()[2]:.0f} processes wanted the cores at once."
    lines = [
        "# Outlines and the nearest gears",
        "",
        f"Written by `python benchmarks/silhouettes.py FOLDER`: {os.cpu_count()} cores, Python {PYTHON};",
        f"silhouettes of {SIZE_MM:g} mm, {TEETH} teeth whose flanks work on both sides, the axis free. Outlines are of",
        "the repository xuhaocuhk/non-circular-gears (H. Xu and others, Eurographics 2020). Deviations count from the",
        "outline to the pitch curve of the teeth and from that to the outline, and are measured by shapely. Places are",
        "in the drawing. The time is of the fit with its teeth, their written outlines and two further sizes;",
        f"{load}",
        "",
        "| outline | r.m.s., mm | greatest, mm | where, mm | contact ratio | processor, s |",
        "| --- | --- | --- | --- | --- | --- |",
        *rows,
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    text = page(Path(sys.argv[1]))
    PAGE.write_text(text, encoding="utf-8")
    print(text)
