"""The drive of a design: of its file, of a text, or of a mapping of its keys."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from ncgear.design.reading.design_file import load as load_design
from ncgear.design.reading.design_file import parsed
from ncgear.errors import WrongInput
from ncgear.project.drive import Drive
from ncgear.project.function_laws import drive_of


def load(given: str | Path | Mapping[str, Any]) -> Drive:
    """The drive of a design file, or of a mapping with its keys; its law, motion, teeth and more are attributes.

    A mapping may hold arrays for lists, and a function of phi1 in rad as ``ratio``, ``driven_angle`` or displacement of
    its ``motion``; ``drive.followed`` tells how the law follows it (``ncgear.project.function_laws``).

    Raises WrongInput, with ``FILE:LINE:COLUMN`` or the key, for what is wrong.  The attributes of the drive raise
    WrongInput or NoSuchMechanism, with places of the same kind, once they are asked for.

    >>> drive = load("designs/baler.yaml")
    >>> drive
    Drive('baler', law three_segment_stroke, 20 r/min)
    >>> f"{drive.check.peak_power_w.value:.0f} W"
    '6315 W'
    >>> f"{drive.pitch.center_distance_mm:.3f} mm"
    '74.885 mm'
    """
    if isinstance(given, Mapping):
        return drive_of(given)
    if not isinstance(given, str | PathLike):
        raise WrongInput(
            f"{type(given).__name__} given; the path of a design file, or a mapping with its keys, is right"
        )
    loaded = load_design(Path(given))
    return Drive(loaded.design, loaded=loaded)


def loads(text: str, name: str = "text") -> Drive:
    """The drive of a design file's text; messages call it ``name``.  Otherwise the same as ``load``.

    >>> machine = "linkage: {crank_mm: 40, rod_mm: 90}, operation: {speed_rpm: 30}"
    >>> drive = loads(f"{{name: even, {machine}, motion: {{law: uniform_crank}}}}")
    >>> f"{drive.linkage.stroke_mm:g} mm"
    '80 mm'
    """
    loaded = parsed(text, Path(name))
    return Drive(loaded.design, loaded=loaded)
