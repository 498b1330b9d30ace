"""Scenes of design files, made once for all tests."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

from ncgear.design.load import load
from ncgear.drive import Drive
from ncgear.scene.made import scene_of
from ncgear.scene.scene import Scene
from test_designs import DESIGNS

TWO_STAGES = "baler-66-two-stage"

ASKEW = """
name: askew
linkage: {crank_mm: 40, rod_mm: 150, offset_mm: -25}
operation: {speed_rpm: 90}
motion: {law: ratio_expression, ratio: "1.5 + 0.2*cos(2*phi)", scale_to_close: true}
gears: {lobes: {driving: 2, driven: 3}, teeth: 22, module_mm: 2, face_width_mm: 12, driving_axis_deg: 55}
resistance: {expression_n: "500*(x - 20)"}
"""
"""Offset to the other side, gears up to the right, several lobes on both."""

GEARLESS = """
name: gearless
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 90}
motion: {law: ellipse, eccentricity: 0.3}
"""

TEXTS = {"askew": ASKEW, "gearless": GEARLESS}


@cache
def drive_of(name: str) -> Drive:
    """The drive of a file in designs, or of one of the texts above."""
    if name not in TEXTS:
        return Drive(load(DESIGNS / f"{name}.yaml").design)
    path = Path(mkdtemp()) / f"{name}.yaml"
    path.write_text(TEXTS[name], encoding="utf-8")
    return Drive(load(path).design)


@cache
def scene(name: str) -> Scene:
    """Its scene."""
    return scene_of(drive_of(name))
