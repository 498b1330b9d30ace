"""The drawing of a pitch curve on the page: outline, points to drag, and the nearest pair where its teeth are refused.

A drawing is dropped onto the page: its file goes beside the design, which then names it.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from ncgear.design.drawn import KINDS, as_read, shape_of_file
from ncgear.design.words import listed
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.files.one_file import put_at_free_place
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from ncgear.studio.editing import edited
from ncgear.studio.messages import Answer

SHOWN_POINTS = 1200
"""Most points of an outline on the page: about one for each of its pixels."""

MOST_DRAGGED = 200
"""Most points that have a handle each; more could not be told apart."""

DECIMALS = 3
"""Decimals of a millimetre on the page."""

NAMES = range(1, 100)
"""Numbers that are tried in the name of a drawing whose own name another file has."""


def drawing_of(drive: Drive) -> Iterator[Answer]:
    """``drawing``: the outline, its axis, and its points if the design has them; nothing without a known outline.

    If a point ``of_file`` is dragged, the points replace the file's name in the design; the file does not change.
    """
    motion = drive.design.motion
    if not motion.gives_outline or motion.solves_shape:
        return
    outline, axis, key = motion.outline_mm()
    given = motion.model_dump(exclude_unset=True).get("points") or {}
    points = outline.tolist() if "x_mm" in given and len(outline) <= MOST_DRAGGED else []
    of_file = given.get("file") is not None
    yield (
        "drawing",
        {"outline": _shown(outline), "axis": axis.tolist(), "points": points, "of_file": of_file, "key": key},
    )


def nearest_pair(drive: Drive) -> Iterator[Answer]:
    """``fitted``: the curve of the nearest pair that can be made, its deviation, and the changes that use it.

    Nothing for a design without an outline, and where there is no pair near it.
    """
    if not drive.design.motion.gives_outline or drive.design.gears is None:
        return
    from ncgear.figures.numbers import to_digits
    from ncgear.figures.outline_fit import bound_words
    from ncgear.project.outline_fit import fitted

    try:
        found = fitted(drive.design)
    except DesignError:
        return
    away = found.deviation
    changes: dict[str, Any] = {"motion": dict(found.motion)}
    if drive.design.motion.gives_center_distance:
        changes |= {"gears.teeth": found.curve.teeth, "gears.module_mm": None, "gears.center_distance_mm": None}
    words = (
        f"The nearest pair that can be made is {to_digits(away.root_mean_square_mm, 2)} mm off (r.m.s.), "
        f"{to_digits(away.greatest_mm, 2)} mm at most: {bound_words(found, found.bound_by)}"
    )
    at = [list(away.at_mm), list(away.toward_mm)]
    yield "fitted", {"curve": _shown(found.points_mm), "greatest": at, "words": words, "changes": changes}


def require_or_fit(drive: Drive) -> Iterator[Answer]:
    """Raise the error about the teeth, after the nearest pair that can be made has been told."""
    try:
        drive.require_sound_pairs()
    except NoSuchMechanism:
        yield from nearest_pair(drive)
        raise


def with_dropped(text: str, design: Path, name: str, content: bytes) -> tuple[str, str]:
    """The text of a design whose pitch curve is a drawing that was dropped, and the name of the drawing's file.

    The file goes beside the design, under its name or the first free name after it; no file is overwritten.  If the
    content is no drawing, raises WrongInput and leaves no file.
    """
    plain = PurePosixPath(name.replace("\\", "/")).name
    if Path(plain).suffix.lower() not in KINDS or plain.startswith(".") or not plain.isprintable():
        raise WrongInput(f"{plain!r} dropped; a file that ends in {listed(KINDS)} is right", key="drop")
    place, is_new = _placed(design.parent, plain, content)
    try:
        kind, keys = shape_of_file(place.name, "drop")
        return as_read(edited(text, {"motion": {"law": "pitch_curve", kind: keys}}), design), place.name
    except WrongInput:
        if is_new:
            place.unlink(missing_ok=True)
        raise


def _placed(folder: Path, name: str, content: bytes) -> tuple[Path, bool]:
    """The path of a file with a content in a folder, and whether it was newly written."""
    for number in NAMES:
        place = folder / (name if number == 1 else f"{Path(name).stem}-{number}{Path(name).suffix}")
        try:
            put_at_free_place(place, content)
            return place, True
        except FileExistsError:
            if place.is_file() and place.read_bytes() == content:
                return place, False
        except OSError as error:
            raise WrongInput(f"cannot be written ({error.strerror})", location=str(place)) from error
    raise WrongInput("too many files of this name; another name is right", key="drop")


def _shown(points: Array) -> list[list[float]]:
    step = max(1, -(-len(points) // SHOWN_POINTS))
    return np.round(points[::step], DECIMALS).tolist()
