"""Shares of inertia and of ratios, even wishes, mates of outlines, forces beside a pair and flywheels, by hand."""

from __future__ import annotations

from dataclasses import dataclass as plain_dataclass
from math import atan, pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ncgear.pitch.pair as pitch_pair
import ncgear.project.best_law as best_law
import ncgear.project.drivetrain as drivetrain
import ncgear.project.face_load as face_load
import ncgear.project.law as law
import ncgear.project.motor as motor
import ncgear.project.outline_fit as outline_fit
from at_once import at_once
from ncgear.errors import NoSuchMechanism
from ncgear.optimum.outline.nearest import LOOSE
from ncgear.project.gear_solids import _hub
from ncgear.project.tolerance_limits import SMALLEST_MM, USUAL, Process, _usual
from ncgear.solids.plan.body import SetScrew

Made: Any = SimpleNamespace


@pytest.mark.judges("project")
@at_once(
    ("between", "driven", "share"),
    [((6.0, 4.0), 20.0, 0.0), ((6.0, 1.0), 19.0, 0.3), ((7.0, 4.0), 24.0, 0.4), ((7.0, 5.0), 21.0, 0.2)],
)
def test_gears_differ_by_their_larger_inertia_over_all_that_the_crank_turns(
    monkeypatch: pytest.MonkeyPatch, between: Any, driven: float, share: float
) -> None:
    """Shafts between count together: 10 kg mm2 in use beside 20 of the driven gear, of 10 kg mm2 in the mean."""
    monkeypatch.setattr(best_law, "mean_inertia_kg_mm2", lambda task: 10.0)
    used, made = (Made(between_kg_mm2=some, driven_kg_mm2=own) for some, own in (((6.0, 4.0), 20.0), (between, driven)))
    assert best_law._change(None, used, made) == pytest.approx(share)  # type: ignore[arg-type]


@pytest.mark.judges("project")
@at_once(
    ("low", "high", "hard", "stroke", "kept"),
    [
        (1.5, 3.0, True, "working", True),
        (0.2, 1.1, True, "working", True),
        (2.1, 3.0, True, "working", False),
        (0.2, 0.9, True, "working", False),
        (1.5, 3.0, False, "working", False),
        (1.5, 3.0, True, "return", False),
    ],
)
def test_a_hard_wish_on_the_even_stretch_of_a_law_tells_which_part_is_needed(
    monkeypatch: pytest.MonkeyPatch, low: float, high: float, hard: bool, stroke: str, kept: bool
) -> None:
    """The law is even from 0.5 to 1 rad, where its output goes from 10 to 20 mm; wishes are in cm."""
    output = Made(place=Made(factor=0.1))
    linkage = Made(OUTPUT=output, displacement=lambda crank: Made(value=10.0 * crank))
    made = Made(linkage=linkage, transmission=Made(driven_angle=lambda phi1: 2.0 * phi1))
    monkeypatch.setattr(law, "law_of", lambda _: made)
    wish = Made(hard=hard, stroke=stroke, place={"from": low, "to": high}.get)
    asked: Any = Made(motion=Made(even_rad=(0.5, 1.0)), wishes=Made(constant_speed=[wish]))
    assert law.keeps_even_speed(asked) is kept


@pytest.mark.judges("project")
def test_parts_at_which_all_pairs_lean_alike_are_found_or_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tangents of 1, 3 and 6 times the part are alike with parts of 6/9, 2/9 and 1/9; tangents that stay never are."""
    grows = {"power": 1.0}

    def shared_out(_: Any, parts: Any) -> Any:
        slopes = (each * part ** grows["power"] for each, part in zip((1.0, 3.0, 6.0), parts, strict=True))
        return Made(pairs=[Made(transmission=slope) for slope in slopes])

    monkeypatch.setattr(law, "_shared_out", shared_out)
    monkeypatch.setattr(pitch_pair, "largest_tangent_angle_rad", lambda slope: Made(value=atan(slope)))
    assert law.evenly_steep(None, [1 / 3] * 3) == pytest.approx([6 / 9, 2 / 9, 1 / 9], rel=1e-3)  # type: ignore[arg-type]
    grows["power"] = 0.0
    with pytest.raises(NoSuchMechanism, match="all 3 pairs"):
        law.evenly_steep(None, [1 / 3] * 3)  # type: ignore[arg-type]


@pytest.mark.judges("project")
@at_once(("start", "speed_rad_s"), [("on_law", 7.0), ("at_rest", 0.0)])
def test_a_motor_starts_at_rest_or_at_the_speed_of_the_law(
    monkeypatch: pytest.MonkeyPatch, start: str, speed_rad_s: float
) -> None:
    asked = list[Any]()
    monkeypatch.setattr(motor, "stall_of", lambda *given: asked.extend(given))
    drive: Any = Made(design=Made(simulation=Made(start=start, turns=3.0)))
    motor._stops(drive, Made(speed_rad_s=7.0), Made(torque_n_mm=None))
    assert asked[2:] == [speed_rad_s, pytest.approx(6.0 * pi)]


@pytest.mark.judges("project")
@at_once(("teeth", "module_mm", "share"), [(24, 2.0, 48.0 * pi / 150.0), (None, 2.0, None), (24, None, None)])
def test_teeth_and_module_give_a_curve_of_a_length_of_its_own(teeth: Any, module_mm: Any, share: Any) -> None:
    given: Any = Made(asked_gears=Made(teeth=teeth, module_mm=module_mm), outline=Made(hull_length_mm=150.0))
    assert outline_fit.OutlineFit.length_by_size.fget(given) == pytest.approx(share)  # type: ignore[attr-defined]


@pytest.mark.judges("project")
@at_once(("of_outline", "bound_rad"), [(True, 2.0), (False, 1.0)])
def test_a_mate_is_told_in_the_size_of_its_drawing(
    monkeypatch: pytest.MonkeyPatch, of_outline: bool, bound_rad: float
) -> None:
    """The mate is twice its drawing; the curve's point that is nearest to the greatest deviation tells what binds."""
    points = np.array([[20.0, 0.0], [0.0, 20.0], [-20.0, 0.0]])
    place = Made(scale=2.0, axis_mm=np.array([3.0, 5.0]))
    curve: Any = Made(
        mate_place=place, mate_in_drawing=lambda: (points, None), basis=Made(phi_rad=np.array([0.0, 1.0, 2.0]))
    )
    away = Made(of_outline=of_outline, toward_mm=[-9.0, 1.0], at_mm=[1.0, 11.0])
    monkeypatch.setattr(outline_fit, "mate_deviation", lambda *_: away)
    monkeypatch.setattr(outline_fit, "_binding", lambda made, at: at)
    monkeypatch.setattr(outline_fit, "MateFit", lambda *given: given)
    found: Any = outline_fit._mate_fit(Made(curve=curve), Made(outline="drawn"))
    assert found[0] == "drawn"
    assert found[2] == pytest.approx(points / 2.0)
    assert found[3] == pytest.approx([1.5, 2.5])
    assert found[4:] == (2.0, bound_rad)


@plain_dataclass(frozen=True)
class _Limits:
    share: Any


@pytest.mark.judges("project")
def test_more_teeth_go_on_with_the_limits_of_the_curve_that_was_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shares of limits go over to the finer angles; sizes that miss a condition are left out."""
    own = Made(teeth=20, arc_mm=np.zeros(4), phi_rad=np.array([0.0, 1.0, 2.0, 3.0]))
    made: Any = Made(curve=own, limits=_Limits(np.array([1.0, 2.0, 3.0, 4.0])))
    asked = list[Any]()

    def nearest(outline: Any, teeth: int, limits: Any, wanted: Any, start: Any) -> Any:
        asked.append((teeth, limits.share))
        if len(asked) == 1:
            raise NoSuchMechanism("none")
        return Made(teeth=teeth, module_mm=50.0 / teeth)

    monkeypatch.setattr(outline_fit, "NEXT_TEETH", (1.3, 2.0, 4.0, 6.0))
    monkeypatch.setattr(
        outline_fit, "_with_teeth", lambda curve, teeth: Made(teeth=teeth, phi_rad=np.array([0.5, 2.25, 5.0]))
    )
    monkeypatch.setattr(outline_fit, "nearest_curve", nearest)
    off = {40: 0.0, 80: LOOSE * 1.01, 120: LOOSE * 0.99}
    monkeypatch.setattr(outline_fit, "missed", lambda found, limits, wanted: off[found.teeth])
    monkeypatch.setattr(
        outline_fit, "deviation", lambda _, found: Made(root_mean_square_mm=1.0, greatest_mm=float(found.teeth))
    )
    found = outline_fit._next_sizes(None, made, Made(mate=None))  # type: ignore[arg-type]
    assert [teeth for teeth, _ in asked] == [26, 40, 80, 120]
    assert all(share == pytest.approx([1.5, 3.25, 4.0 - 6.0 / (2.0 * pi - 3.0)]) for _, share in asked)
    assert [(one.teeth, one.module_mm, one.greatest_mm) for one in found] == [
        (40, 1.25, 40.0),
        (120, pytest.approx(50.0 / 120.0), 120.0),
    ]


@pytest.mark.judges("project")
@at_once(
    ("count", "number", "crank", "before", "after"),
    [
        (3, 0, False, 0j, -2j), (3, 1, False, 1j, -3j), (3, 2, False, 2j, 0j), (3, 2, True, 2j, 8.0 + 0j),
        (2, 0, False, 0j, -2j), (2, 1, False, 1j, 0j), (1, 0, True, 0j, 8.0 + 0j),
    ],
)  # fmt: skip
def test_the_gears_beside_press_on_both_shafts_of_a_pair(
    monkeypatch: pytest.MonkeyPatch, count: int, number: int, crank: bool, before: complex, after: complex
) -> None:
    """Three pairs in series with forces of 1, 2 and 3 N up; the last one may turn the crank, 10 - 2 N mm of torque."""
    angle = np.array([0.0, 1.0])
    meshes = [Made(force=(np.zeros(2), np.full(2, each))) for each in (1.0, 2.0, 3.0)[:count]]
    asked: Any = Made(
        pair=Made(shaft_rad=lambda at: at), number=number, turns_crank=crank, torque_n_mm=lambda at: np.full(2, 2.0)
    )
    machine = Made(places=meshes, at=lambda at: Made(meshes=meshes))
    monkeypatch.setattr(face_load, "complex_of", lambda force: force[0] + 1j * force[1])
    monkeypatch.setattr(face_load, "_crank_n", lambda asked, at, torque: torque.astype(complex))
    found = face_load.FaceLoading._beside_n(Made(asked=asked, machine=machine), angle, np.full(2, 10.0))
    assert [one.tolist() for one in found] == [[before] * 2, [after] * 2]


@pytest.mark.judges("project")
@at_once(("given", "over_mm"), [(None, 20.0), (4.0, 16.0)])
def test_the_screw_of_a_hub_is_above_the_face(given: float | None, over_mm: float) -> None:
    """A face of 12 mm under a hub of 16 mm: its middle is at 20 mm."""
    screw = Made(diameter_mm=3.0, height_mm=given, direction_deg=90.0)
    made: Any = _hub(Made(diameter_mm=30.0, height_mm=16.0, set_screw=screw), 12.0)
    assert made.set_screw == SetScrew(3.0, over_mm, pi / 2.0)


@pytest.mark.judges("project")
@at_once("share", [0.25, 0.999, 1.0, 1.1])
def test_small_gears_are_made_as_much_more_exactly(share: float) -> None:
    for process in Process:
        found, taken = _usual(process, share * SMALLEST_MM), USUAL[process]
        kept = 1.0 if process is Process.PRINTED else min(share, 1.0)
        assert found.center_distance_mm == pytest.approx(kept * taken.center_distance_mm)
        for gear in ("driving", "driven"):
            assert getattr(found, gear).eccentricity_mm == pytest.approx(kept * getattr(taken, gear).eccentricity_mm)


@pytest.mark.judges("project")
@at_once(
    ("own", "added", "diameter", "disc"), [(30.0, 20.0, 200.0, 50.0), (60.0, 50.0, 200.0, None), (0.0, 0.0, None, None)]
)
def test_a_flywheel_is_what_the_driving_shaft_lacks(
    monkeypatch: pytest.MonkeyPatch, own: float, added: float, diameter: float | None, disc: float | None
) -> None:
    """100 kg mm2 are needed; the shaft has some of its own, and the motor adds some."""
    demand = Made(
        cycle=None, fluctuation=Made(flywheel_kg_mm2=lambda share: 5.0 / share), added_kg_mm2=added, speed_rad_s=6.0
    )
    for name, value in (
        ("WantedLife", lambda *_: None), ("cycle_of", lambda _: None), ("_loss_factors", lambda *_: None),
        ("demand_of", lambda *_: demand), ("disc", lambda missing, *_: missing), ("_shaft", lambda *_: None),
        ("DrivetrainResult", lambda **told: Made(**told)),
    ):  # fmt: skip
        monkeypatch.setattr(drivetrain, name, value)
    given = Made(life_h=1.0, reliability_percent=90.0, flywheel_diameter_mm=diameter, motor=None, pto=None)
    masses = Made(flywheel=Made(speed_fluctuation=0.05))
    design: Any = Made(drivetrain=given, masses=masses, shafts=[])
    rigid: Any = Made(machine=Made(masses=Made(driving_shaft_kg_mm2=own)))
    found: Any = drivetrain.drivetrain_of(design, rigid, [], None, None)
    assert found.flywheel_kg_mm2 == pytest.approx(100.0)
    assert found.disc == (None if disc is None else pytest.approx(disc))
