"""A drive from a design file."""

from __future__ import annotations

from pathlib import Path

from ncgear.design.load import LoadedDesign, parsed
from ncgear.design.load import load as load_design
from ncgear.drive.drive import Drive


def load(path: str | Path) -> Drive:
    """The drive of a design file, whose stages are attributes.

    Raises WrongInput, with ``FILE:LINE:COLUMN``, for a file that is wrong; stages raise it or NoSuchMechanism, with
    the same places, once they are asked for.

    >>> drive = load("designs/baler.yaml")
    >>> drive
    Drive('baler', law three_segment_stroke, 20 r/min)
    >>> f"{drive.check.peak_power_w.value:.0f} W"
    '6315 W'
    >>> f"{drive.pitch.center_distance_mm:.3f} mm"
    '74.885 mm'
    """
    return _drive(load_design(Path(path)))


def loads(text: str, name: str = "text") -> Drive:
    """The drive of a design file's text, which messages call ``name``; otherwise as ``load``.

    >>> machine = "linkage: {crank_mm: 40, rod_mm: 90}, operation: {speed_rpm: 30}"
    >>> drive = loads(f"{{name: even, {machine}, motion: {{law: uniform_crank}}}}")
    >>> f"{drive.linkage.stroke_mm:g} mm"
    '80 mm'
    """
    return _drive(parsed(text, Path(name)))


def _drive(loaded: LoadedDesign) -> Drive:
    return Drive(loaded.design, loaded=loaded)
