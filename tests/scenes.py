"""Scenes of design files, made once for all tests."""

from __future__ import annotations

import shutil
from functools import cache

import numpy as np
import pytest

from drives import drive, drive_of_text
from ncgear.drawings.scene.bodies import BodyPlaces
from ncgear.drawings.scene.scene import Scene, scene_of
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive

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

WEBBED = """
name: webbed
linkage: {crank_mm: 40, rod_mm: 150}
operation: {speed_rpm: 90}
motion: {law: uniform_crank}
gears:
  teeth: 30
  module_mm: 2
  face_width_mm: 12
  driving:
    bore_mm: 10
    hub: {diameter_mm: 20, height_mm: 8}
    web: {thickness_mm: 4, rim_mm: 4}
    lightening_holes: {count: 4, least_wall_mm: 2}
"""

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]
in_a_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on the path")

BOTH_WAYS = """
name: both-ways
linkage: {crank_mm: 40, rod_mm: 150, offset_mm: 10}
operation: {speed_rpm: 90}
motion: {law: ellipse, eccentricity: 0.3}
resistance: {polynomial_n: [300], returning: {expression_n: "2*(60 - x)"}, friction_n: 20}
"""
"""Forces on both strokes, on the way back once there are 60 mm left."""

TEXTS = {"askew": ASKEW, "both ways": BOTH_WAYS, "gearless": GEARLESS, "webbed": WEBBED}


@cache
def drive_of(name: str) -> Drive:
    """The drive of a file in designs, or of one of the texts above."""
    if name not in TEXTS:
        return drive(name)
    return drive_of_text(TEXTS[name])


@cache
def scene(name: str) -> Scene:
    """Its scene."""
    return scene_of(drive_of(name))


def carried(places: BodyPlaces, point_mm: Array) -> Array:
    """Where one point of a body, shape (2,), is at each of its places, shape (n, 2)."""
    return places.origin_mm + flat((point_mm[0] + 1j * point_mm[1]) * np.exp(1j * places.angle_rad))


def standing(places: BodyPlaces, points_mm: Array, row: int) -> Array:
    """Where points of a body, shape (m, 2), are at one of its places, shape (m, 2)."""
    turned = (points_mm[:, 0] + 1j * points_mm[:, 1]) * np.exp(1j * places.angle_rad[row])
    return places.origin_mm[row] + flat(turned)


def flat(points: np.ndarray) -> Array:
    return np.stack([points.real, points.imag], axis=-1)
