"""End stops of gears that turn less than once: an arc slot in the body, and the pin of the frame that stands in it.

The judge is the pin as a polygon in the slot's, which the gear carries round.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from io import StringIO
from math import cos, degrees, pi, radians, sin

import ezdxf
import ezdxf.path
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Point, Polygon, affinity

from drives import drive_of_text
from ncgear.errors import WrongInput
from ncgear.figures.assembly import assembly_of
from ncgear.files.workshop.drawing import pair_drawings, pitch_points
from ncgear.files.workshop.dxf import dxf_files
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.solids.plan.body import ArcSlot, EndStop, slot_points

TEXT = """
name: stopped
operation: {speed_rpm: 10}
motion: {law: spiral, range_deg: 200, ratio_start: 1.6, ratio_end: 0.7}
gears:
  module_mm: 2
  center_distance_mm: 110
  face_width_mm: 8
  index_holes: true
  driving: {bore_mm: 10, end_stop: {pin_mm: 4, radius_mm: 16, clearance_mm: 0.3}}
  driven: {bore_mm: 8, end_stop: {pin_mm: 3, radius_mm: 14}}
"""


@cache
def stopped() -> Drive:
    return drive_of_text(TEXT)


def depth(slot: Polygon, pin: Point, turned_rad: float, radius_mm: float) -> float:
    """How far the pin, a point with a radius, is over the edge of a slot that its gear has turned; under 0: inside."""
    carried = affinity.rotate(slot, degrees(turned_rad), origin=(0.0, 0.0))
    return radius_mm - float(carried.exterior.distance(pin)) if carried.contains(pin) else np.inf


@pytest.mark.slow
@pytest.mark.parametrize("gear", list(Gear))
def test_the_pin_is_free_in_the_range_and_stops_the_gear_at_both_ends(gear: Gear) -> None:
    made = stopped()
    plan = made.solids.of(gear).plan
    end_rad = assembly_of(made)["end_stops"][f"{gear.value}_rad"][1]
    told = assembly_of(made)["end_stops"][f"{gear.value}_pin"]
    assert plan.slot is not None
    slot = Polygon(slot_points(plan.slot, 1e-7))
    pin, radius = Point(told["x_mm"], told["y_mm"]), told["diameter_mm"] / 2.0
    play = (plan.slot.width_mm - told["diameter_mm"]) / 2.0
    share = np.mod(0.618 * np.arange(1, 60), 1.0)
    inside = [depth(slot, pin, end_rad * part, radius) for part in share if 0.03 < part < 0.97]
    # The place of the pin has four decimals.
    assert inside == pytest.approx([-play] * len(inside), abs=2e-4)
    for end, beyond in ((0.0, -1.0), (end_rad, 1.0)):
        assert depth(slot, pin, end, radius) == pytest.approx(0.0, abs=2e-4)
        # A hundredth of a degree farther, the pin is in the wall by that much of its way.
        over = depth(slot, pin, end + np.sign(end_rad) * beyond * radians(0.01), radius)
        assert over == pytest.approx(radians(0.01) * plan.slot.radius_mm, abs=2e-4)


@pytest.mark.thorough
@settings(max_examples=60, deadline=None)
@given(st.floats(1.0, 20.0), st.floats(0.0, 2.0), st.floats(10.0, 80.0), st.floats(0.6, 5.0), st.booleans())
def test_ends_meet_the_pin_exactly_with_any_clearance(
    pin: float, clearance: float, radius: float, turned: float, clockwise: bool
) -> None:
    stop = EndStop(pin, radius, clearance, -turned if clockwise else turned)
    slot, at = stop.slot(0.3), stop.pin_rad(0.3)
    for angle, end in ((at, slot.high_rad), (at - stop.turned_rad, slot.low_rad)):
        nearest = (end, slot.high_rad, slot.low_rad)
        centers = [radius * complex(cos(one), sin(one)) for one in nearest]
        apart = min(abs(center - radius * complex(cos(angle), sin(angle))) for center in centers)
        assert apart == pytest.approx(clearance / 2.0, abs=1e-9)


def exact_area(slot: ArcSlot) -> float:
    """An arc of a ring, and a circle."""
    return slot.radius_mm * slot.width_mm * (slot.high_rad - slot.low_rad) + pi * slot.width_mm**2 / 4.0


@pytest.mark.slow
def test_solid_and_drawing_lack_the_slot() -> None:
    bare = drive_of_text(TEXT.replace(", end_stop: {pin_mm: 4, radius_mm: 16, clearance_mm: 0.3}", ""))
    plan = stopped().solids.driving.plan
    assert plan.slot is not None
    lost = bare.solids.driving.mesh.volume - stopped().solids.driving.mesh.volume
    assert lost == pytest.approx(8.0 * exact_area(plan.slot), rel=2e-3)
    assert stopped().solids.driving.mesh.is_watertight
    drawn = ezdxf.read(StringIO(dxf_files(pair_drawings(stopped()))["driving.dxf"].decode()))
    (line,) = drawn.modelspace().query('LWPOLYLINE[layer=="END_STOP"]')
    flat = Polygon([(point.x, point.y) for point in ezdxf.path.make_path(line).flattening(1e-4)])
    assert flat.area == pytest.approx(exact_area(plan.slot), rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("gear", list(Gear))
def test_the_pitch_curve_that_is_drawn_is_the_sector_of_the_range(gear: Gear) -> None:
    curve = stopped().pitch.of(gear)
    *points, axis = pitch_points(curve, 0.005)
    covered = stopped().transmission.lobes.range
    assert covered is not None
    exact = curve.at_angle(np.linspace(0.0, covered.driving_rad, 20_001)).position
    assert np.array(points)[[0, -1]] == pytest.approx(exact[[0, -1]], abs=1e-9)
    assert Polygon([*points, axis]).symmetric_difference(Polygon([*exact, axis])).area < 0.005 * curve.length_mm
    assert axis.tolist() == [0.0, 0.0]


@pytest.mark.slow
def test_a_kerf_narrows_the_slot_and_a_clearance_widens_it() -> None:
    width = stopped().solids.driving.plan.slot.width_mm  # type: ignore[union-attr]
    for given_mm, wanted in ((0.1, width + 0.2), (-0.1, width - 0.2)):
        made = drive_of_text(TEXT.replace("face_width_mm: 8", f"face_width_mm: 8\n  process_clearance_mm: {given_mm}"))
        plan = made.solids.driving.plan
        assert plan.slot is not None
        assert plan.slot.width_mm == pytest.approx(wanted)
        assert (plan.slot.low_rad, plan.slot.high_rad) == pytest.approx(
            (stopped().solids.driving.plan.slot.low_rad, stopped().solids.driving.plan.slot.high_rad)  # type: ignore[union-attr]
        )


@pytest.mark.tiers(slow=["4", "60"], rest="long")
@pytest.mark.parametrize("radius", [4, 7, 60])
def test_a_slot_without_room_is_refused_with_a_radius_that_fits(radius: float) -> None:
    text = TEXT.replace("radius_mm: 16", f"radius_mm: {radius}")
    with pytest.raises(
        WrongInput, match=r"gears.driving.end_stop.radius_mm: a slot of 4.3 mm for a turn of 200 deg"
    ) as caught:
        _ = drive_of_text(text).solids
    right = float(caught.value.problem.split()[-3])
    assert drive_of_text(TEXT.replace("radius_mm: 16", f"radius_mm: {right}")).solids.driving.mesh.is_watertight


@pytest.mark.slow
def test_a_slot_that_would_meet_itself_has_no_radius() -> None:
    text = TEXT.replace("range_deg: 200, ratio_start: 1.6", "range_deg: 330, ratio_start: 1.05").replace("0.7", "0.95")
    with pytest.raises(WrongInput, match="no radius fits; a thinner pin"):
        _ = drive_of_text(text.replace("pin_mm: 4", "pin_mm: 20")).solids


def test_gears_that_turn_on_and_on_have_no_end_stop() -> None:
    text = TEXT.replace(
        "{law: spiral, range_deg: 200, ratio_start: 1.6, ratio_end: 0.7}", "{law: ellipse, eccentricity: 0.3}"
    )
    with pytest.raises(WrongInput, match=r"gears.driving.end_stop: given, but gears of ellipse turn on and on"):
        drive_of_text(text)


@pytest.mark.slow
def test_pockets_holes_and_the_index_hole_keep_away_from_the_slot() -> None:
    body = "{bore_mm: 10, end_stop: {pin_mm: 3, radius_mm: 22}, web: {thickness_mm: 3, rim_mm: 3, hub_mm: 18},"
    body += " lightening_holes: {count: 3, least_wall_mm: 1}}"
    text = TEXT.replace("{bore_mm: 10, end_stop: {pin_mm: 4, radius_mm: 16, clearance_mm: 0.3}}", body)
    text = text.replace("center_distance_mm: 110", "center_distance_mm: 160")
    plan = drive_of_text(text).solids.driving.plan
    assert plan.slot is not None
    assert plan.web is not None
    assert plan.index_hole is not None
    slot = Polygon(slot_points(plan.slot, 1e-4))
    assert min(pocket.distance(slot) for pocket in plan.web.pockets) >= 2.0 - 1e-3
    holes = [Point(hole.x_mm, hole.y_mm).buffer(hole.diameter_mm / 2.0) for hole in plan.round_holes]
    assert min(hole.distance(slot) for hole in holes) >= 1.0
    assert replace(plan, slot=None).section.area - plan.section.area == pytest.approx(slot.area, rel=1e-2)
