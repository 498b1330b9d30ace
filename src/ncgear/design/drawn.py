"""A pitch curve from the file of a drawing: the keys that name the file, and the findings of its reading."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

from ncgear.design.keys.pitch_shapes import DrawnContour, drawn_points
from ncgear.design.reading.design_file import parsed
from ncgear.design.rewritten import rewritten
from ncgear.design.words import listed
from ncgear.errors import WrongInput

PICTURE: dict[str, Any] = {"width_mm": 80, "tolerance_mm": 0.2}
TABLE: dict[str, Any] = {"tolerance_mm": 0.1}
KINDS: dict[str, tuple[str, dict[str, Any]]] = {
    ".svg": ("svg", {}),
    ".dxf": ("dxf", {"unit": "mm"}),
    **dict.fromkeys((".png", ".jpg", ".jpeg"), ("picture", PICTURE)),
    **dict.fromkeys((".csv", ".xlsx", ".ods"), ("points", TABLE)),
}
"""The shape of the law and its keys beside ``file``, by the ending of the file."""

MANY_CHORDS, SMOOTHED_MM = 100, 0.1
"""A contour with more chords than this, as a traced outline has, is smoothed within this tolerance in mm."""


def shape_of_file(file: str, key: str) -> tuple[str, dict[str, Any]]:
    """The shape of the law ``pitch_curve`` and its keys for a file; raises WrongInput at ``key`` for another ending."""
    found = KINDS.get(Path(file).suffix.lower())
    if found is None:
        right = f"heart, square, star or a file that ends in {listed(KINDS)}"
        raise WrongInput(f"{file!r} given; {right} is right", key=key)
    kind, keys = found
    return kind, {"file": Path(file).as_posix(), **keys}


def as_read(text: str, path: Path) -> str:
    """The text of a design with a drawing, with the unit of the drawing, a tolerance for many chords, and the axis in
    the middle of a curve that does not go round the axis given.

    Raises WrongInput where the design or its drawing cannot be read.
    """
    from ncgear.ratio.laws.curve_shapes import goes_round, middle_mm

    motion, changes = parsed(text, path).design.motion, dict[str, Any]()
    kind = next(kind for kind, _ in KINDS.values() if getattr(motion, kind, None) is not None)
    shape = getattr(motion, kind)
    if isinstance(shape, DrawnContour):
        if (unit := getattr(shape, "drawn_in", None)) is not None:
            changes["unit"] = unit
        chords = sum(len(curve.x) - 1 for curve in shape.curves or () if curve.degree == 1)
        if shape.tolerance_mm is None and chords > MANY_CHORDS:
            changes["tolerance_mm"] = SMOOTHED_MM
    elif not shape.in_plane:
        return text
    with suppress(WrongInput):
        points_mm = drawn_points(shape.model_copy(update=changes), f"motion.{kind}")
        if not goes_round(points_mm, shape.axis_mm) and (middle := middle_mm(points_mm)) is not None:
            changes["axis_x_mm"], changes["axis_y_mm"] = middle
    return rewritten(text, {f"motion.{kind}.{key}": value for key, value in changes.items()})
