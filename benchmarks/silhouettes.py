"""How near gears come to drawn outlines: fits of a folder of silhouettes, with their deviation and time.

Run as ``python benchmarks/silhouettes.py FOLDER``; writes benchmarks/silhouettes.md in two minutes.  The folder holds
outlines as text files of pairs ``x y``, separated by commas, as those of the public repository
xuhaocuhk/non-circular-gears (H. Xu and others, Eurographics 2020) have them; none of its files is kept here.
"""

from __future__ import annotations

import os
import platform
import sys
from pathlib import Path
from time import process_time

os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}

import numpy as np

import ncgear

PAGE = Path(__file__).parent / "silhouettes.md"

SIZE_MM, TEETH = 64.0, 64

TWO = "heart", "fish"
"""Outlines of a gear and of its mate."""

PYTHON = platform.python_version()

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


def row(path: Path) -> str:
    """A fit as a row of the table."""
    begun = process_time()
    try:
        found = ncgear.fit(outline(path), teeth=TEETH, gears={"drives": "both_ways"})
    except ncgear.NoSuchMechanism as refused:
        return f"| {path.stem} | refused: {refused.problem} | | | {process_time() - begun:.1f} |"
    away = found.deviation
    deviations = f"{away.root_mean_square_mm:.3f} | {away.greatest_mm:.1f}"
    return f"| {path.stem} | {deviations} | {found.contact_ratio:.2f} | {process_time() - begun:.1f} |"


def row_of_two(folder: Path) -> str:
    """Both gears follow an outline, with equal weights."""
    begun = process_time()
    own, mate = (outline(folder / f"{name}.txt") for name in TWO)
    found = ncgear.fit(own, teeth=TEETH, mate_mm=mate, gears={"drives": "both_ways"})
    other = found.mate
    assert other is not None
    two = [found.deviation, other.deviation]
    root, greatest = (
        " and ".join(f"{getattr(one, name):.{digits}f}" for one in two)
        for name, digits in (("root_mean_square_mm", 3), ("greatest_mm", 1))
    )
    names = f"{TWO[0]}, its mate a {TWO[1]} of {other.size_mm:.0f} mm"
    return f"| {names} | {root} | {greatest} | {found.contact_ratio:.2f} | {process_time() - begun:.1f} |"


def page(folder: Path) -> str:
    """The whole page."""
    rows = [row(path) for path in sorted(folder.glob("*.txt"))]
    rows.append(row_of_two(folder))
    lines = [
        "# Outlines and the nearest gears",
        "",
        f"Written by `python benchmarks/silhouettes.py FOLDER`: {os.cpu_count()} cores, Python {PYTHON};",
        f"silhouettes of {SIZE_MM:g} mm, {TEETH} teeth whose flanks work on both sides, the axis free. Outlines are of",
        "the repository xuhaocuhk/non-circular-gears (H. Xu and others, Eurographics 2020). Deviations count from the",
        "outline to the curve and from the curve to the outline.",
        "",
        "| outline | r.m.s., mm | greatest, mm | contact ratio | processor, s |",
        "| --- | --- | --- | --- | --- |",
        *rows,
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    text = page(Path(sys.argv[1]))
    PAGE.write_text(text, encoding="utf-8")
    print(text)
