"""Gears as they wear: circular ones by closed forms, and as a file with the backlash of the worn gears rates them."""

from __future__ import annotations

from math import cos, degrees, radians

import numpy as np
import pytest

from drives import drive_of_text
from ncgear.figures.answers.strong import worn_fault, worn_figures, worn_rows
from ncgear.project.drive import Drive
from ncgear.project.strengthening import rating_of
from ncgear.project.worn import worn_over_life

BACKLASH_MM, CRANK_MM, ROD_MM, MODULE_MM, TEETH = 0.05, 30.0, 120.0, 2.0, 24

TEXT = f"""name: wears
linkage: {{crank_mm: {CRANK_MM}, rod_mm: {ROD_MM}}}
operation: {{speed_rpm: 60}}
motion: {{law: uniform_crank}}
gears: {{teeth: {TEETH}, module_mm: {MODULE_MM}, face_width_mm: 15, BACKLASH, material: 42CrMo4}}
resistance: {{polynomial_n: [200]}}
strength: {{life_h: 20000WEAR}}
"""


def worn_text(backlash: str = f"backlash_mm: {BACKLASH_MM}", wear: str = "") -> Drive:
    return drive_of_text(TEXT.replace("WEAR", wear).replace("BACKLASH", backlash))


@pytest.mark.judges("project")
@pytest.mark.parametrize("unit", [pytest.param("mm", marks=pytest.mark.slow), "deg"])
def test_circular_gears_wear_evenly(unit: str) -> None:
    """Without masses their load is that of the law: wear and play grow with time, and nothing else changes much."""
    arm_mm = MODULE_MM * TEETH / 2.0 * cos(radians(20.0))
    backlash = f"backlash_mm: {BACKLASH_MM}" if unit == "mm" else f"backlash_deg: {degrees(BACKLASH_MM / arm_mm)!r}"
    drive = worn_text(backlash)
    new, wear = rating_of(drive), drive.surfaces_by("estimate").wear
    found = list(worn_over_life(drive, new))
    assert [one.hours for one in found] == [5000.0, 10_000.0, 20_000.0]
    turned = np.linspace(0.0, 2.0 * np.pi, 20_001)
    place = CRANK_MM * np.cos(turned) + np.sqrt(ROD_MM**2 - (CRANK_MM * np.sin(turned)) ** 2)
    fastest = float(np.abs(np.gradient(place, turned)).max())
    for one in found:
        share = one.hours / 20_000.0
        assert one.depth_mm == pytest.approx(share * wear.deepest_mm, rel=0.02)
        assert one.backlash_mm == pytest.approx(BACKLASH_MM + share * wear.play_mm, rel=0.01)
        assert one.free == pytest.approx(one.backlash_mm / arm_mm * fastest, rel=1e-4)
    assert new.holds
    assert worn_fault(found) == []
    assert found[0].backlash_mm == pytest.approx(BACKLASH_MM + wear.play_mm / 4.0, rel=1e-12)
    rated = rating_of(worn_text(f"backlash_mm: {found[-1].backlash_mm!r}"))
    assert found[-1].rating is not None
    for one, again, before in zip(found[-1].rating.weakest, rated.weakest, new.weakest, strict=True):
        assert one.safety == pytest.approx(again.safety, rel=1e-9)
        assert one.safety < before.safety or one.damage == "contact"


def test_worn_gears_end_where_no_teeth_are_left() -> None:
    """With flanks so soft that wear takes all of a tooth."""
    drive = worn_text(wear=", wear_coefficient_mm3_n_m: 1e-4")
    found = list(worn_over_life(drive, rating_of(drive)))
    assert found[-1].rating is None
    assert "thickness" in found[-1].why
    assert "no gears any more" in worn_rows(drive, found)[-1][1]
    assert worn_fault(found)[0].startswith("worn")
    told = worn_figures(drive, found)["worn"]
    assert list(told.values())[-1]["ended"] == found[-1].why
    assert worn_fault([]) == worn_rows(drive, []) == []
