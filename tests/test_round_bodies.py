"""Bodies of round gears, where every section, wall and place has a closed form; no teeth and hardly a mesh is made."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from math import asin, cos, hypot, pi, sin

import numpy as np
import pytest
import shapely
from shapely import MultiPolygon, Point, Polygon

from at_once import at_once
from ncgear.errors import WrongInput
from ncgear.pitch.shape import Gear
from ncgear.solids.mesh.pair import gear_plan, solid_of_plan
from ncgear.solids.mesh.slabs import Bevel
from ncgear.solids.mesh.triangles import TriangleMesh
from ncgear.solids.plan.body import (
    Blank,
    BodyPlan,
    Bore,
    EndStop,
    HoleSet,
    Hub,
    Keyway,
    RingBlank,
    RoundHole,
    WebSize,
    body_kg_mm2,
    circle_points,
    slot_points,
)
from ncgear.solids.plan.plan import planned_ring
from ncgear.solids.plan.room import require_crank_pin_room, require_slot_room

RADIUS, BORE, WIDTH, MODULE = 40.0, 10.0, 12.0, 2.0
FINE = 1e-3
DENSITY = 7850.0


def plan_of(blank: Blank, tolerance: float = FINE) -> BodyPlan:
    return gear_plan(Gear.DRIVING, circle_points(RADIUS, tolerance), blank, MODULE, tolerance)


def ring_kg_mm2(outer: float, inner: float, height: float) -> float:
    """Of steel, about its axis."""
    return pi / 2.0 * (outer**4 - inner**4) * height * DENSITY * 1e-9


def largest_told(make: Callable[[], object], key: str) -> float:
    with pytest.raises(WrongInput, match="largest that fits is") as refused:
        make()
    assert str(refused.value.key).endswith(key)
    return float(re.findall(r"fits is (\S+) mm", refused.value.problem)[0])


# --- hub, pockets, chamfer -------------------------------------------------------------------------------------------


@pytest.mark.judges("solids")
def test_inertia_of_hub_web_and_rim_is_that_of_rings() -> None:
    """A web of 4 mm between a hub of 24 mm and a rim of 6 mm; the pockets' corners have no place in a ring."""
    plan = plan_of(Blank(WIDTH, Bore(BORE), hub=Hub(24.0, 7.0), web=WebSize(4.0, 6.0, 24.0)))
    assert [(slab.low_mm, slab.high_mm) for slab in plan.slabs] == [(0.0, 4.0), (4.0, WIDTH), (WIDTH, WIDTH + 7.0)]
    assert plan.height_mm == WIDTH + 7.0
    areas = [RADIUS**2 - 25.0, RADIUS**2 - 34.0**2 + 144.0 - 25.0, 144.0 - 25.0]
    assert [slab.section.area for slab in plan.slabs] == pytest.approx([pi * area for area in areas], rel=1e-3)
    whole = ring_kg_mm2(RADIUS, 5.0, WIDTH) - ring_kg_mm2(34.0, 12.0, 8.0) + ring_kg_mm2(12.0, 5.0, 7.0)
    assert body_kg_mm2(plan, DENSITY) == pytest.approx(whole, rel=1e-3)
    assert plan.web is not None
    (pocket,) = plan.web.pockets
    far, near = pocket.hausdorff_distance(Point(0.0, 0.0)), pocket.distance(Point(0.0, 0.0))
    assert (RADIUS - far, near - 12.0) == pytest.approx((6.0, 0.0), abs=5.0 * FINE)
    assert RADIUS - far >= 6.0
    assert near >= 12.0


def test_a_round_chamfer_is_a_cone() -> None:
    blank = Blank(WIDTH, Bore(BORE))
    solid = solid_of_plan(plan_of(replace(blank, chamfer_mm=1.0), 0.02))
    outer = RADIUS**2 - (RADIUS**2 + RADIUS * (RADIUS - 1.0) + (RADIUS - 1.0) ** 2) / 3.0
    inner = (25.0 + 30.0 + 36.0) / 3.0 - 25.0
    lost = plan_of(blank, 0.02).section.area * WIDTH - solid.triangles.volume
    assert lost == pytest.approx(pi * (outer + inner), rel=5e-3)
    # Under a slope from a corner at 0 over two at 3 mm, whose base is half of 4 by 6: a third of the prism is missing.
    slope = TriangleMesh(np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 3.0], [0.0, 6.0, 3.0]]), np.array([[0, 1, 2]]))
    assert Bevel(Polygon(), 3.0, (slope,)).below_mm3 == pytest.approx(12.0 * 2.0)


def test_pockets_beside_a_thick_rim_are_told_the_thickest() -> None:
    """A pocket is as wide as its round corners of a module each way, and two tolerances on either side."""
    web = WebSize(4.0, 30.0, 24.0)
    largest = largest_told(lambda: plan_of(Blank(WIDTH, Bore(BORE), web=web)), "web.rim_mm")
    assert largest == pytest.approx(RADIUS - 12.0 - 2.0 * MODULE - 4.0 * FINE, abs=0.02)


# --- holes -----------------------------------------------------------------------------------------------------------


def test_many_holes_leave_the_wall_to_each_other() -> None:
    """On the circle of centres R - w - d/2 neighbours stand 2 (R - w - d/2) sin(pi/n) apart, which is d + w."""
    half = sin(pi / 12.0)
    expected = (2.0 * (RADIUS - 2.0) * half - 2.0) / (1.0 + half)
    holes = plan_of(Blank(WIDTH, Bore(BORE), holes=HoleSet(12, 2.0)), 0.01).lightening_holes
    assert [hole.diameter_mm for hole in holes] == pytest.approx([expected] * 12, abs=0.03)
    angles = np.sort(np.arctan2([hole.y_mm for hole in holes], [hole.x_mm for hole in holes]))
    assert np.diff(angles) == pytest.approx(np.full(11, pi / 6.0), abs=1e-6)
    assert [hypot(hole.x_mm, hole.y_mm) for hole in holes] == pytest.approx(
        [RADIUS - 2.0 - expected / 2.0] * 12, abs=0.05
    )


def test_holes_without_room_are_told_the_largest() -> None:
    """Between bore and edge is room for 1.7 mm: too small to save weight, and taken where it is given."""
    wall = (RADIUS - BORE / 2.0 - 1.7) / 2.0
    blank = Blank(WIDTH, Bore(BORE), holes=HoleSet(3, wall))
    assert largest_told(lambda: plan_of(blank), "lightening_holes") == pytest.approx(1.7, abs=0.02)
    given = replace(blank, holes=HoleSet(3, wall, 1.9))
    assert largest_told(lambda: plan_of(given), "diameter_mm") == pytest.approx(1.7, abs=0.02)
    assert plan_of(replace(blank, holes=HoleSet(3, wall, 1.6))).lightening_holes[0].diameter_mm == 1.6
    assert plan_of(replace(blank, holes=HoleSet(3, wall - 0.2))).lightening_holes[0].diameter_mm == pytest.approx(
        2.1, abs=0.03
    )


def test_the_index_hole_stands_a_module_and_a_half_from_the_edge() -> None:
    """And a module from the hub; where there is less room it is smaller, and then it is left out."""
    marked = Blank(WIDTH, Bore(BORE), index_hole=True)
    hole = plan_of(marked).index_hole
    assert hole is not None
    assert (hole.x_mm, hole.y_mm, hole.diameter_mm) == pytest.approx((RADIUS - 1.0 - 1.5 * MODULE, 0.0, 2.0), abs=0.02)
    # Walls of 2.5 modules leave 2 mm beside a hub of 66 mm, and 1 mm beside one of 68 mm.
    for hub_mm, diameter in ((65.8, 2.0), (66.2, 1.0), (67.8, 1.0), (68.2, None)):
        found = plan_of(replace(marked, hub=Hub(hub_mm, 3.0))).index_hole
        assert (found and found.diameter_mm) == diameter


def test_a_hole_for_the_crank_pin_keeps_a_module_to_everything() -> None:
    """15 mm from the bore's side and 20 mm from the edge, or 4 mm from a slot."""
    disc = Polygon(circle_points(RADIUS, FINE))
    axis = Polygon(circle_points(BORE / 2.0, FINE))
    slot = Point(0.0, 30.0).buffer(6.0, quad_segs=64)

    def largest(hole: RoundHole, *others: Polygon) -> float:
        return largest_told(
            lambda: require_crank_pin_room(disc, hole, shapely.union_all([axis, *others]), MODULE, 0.1, "gears.driven"),
            "crank_pin.diameter_mm",
        )

    assert largest(RoundHole(12.0, 16.0, 26.0)) == pytest.approx(2.0 * (15.0 - MODULE - 0.1), abs=0.02)
    assert largest(RoundHole(0.0, -32.0, 26.0)) == pytest.approx(2.0 * (8.0 - MODULE - 0.1), abs=0.02)
    assert largest(RoundHole(0.0, 20.0, 26.0), slot) == pytest.approx(2.0 * (4.0 - MODULE - 0.1), abs=0.02)
    with pytest.raises(WrongInput, match="none fits there"):
        require_crank_pin_room(disc, RoundHole(0.0, 45.0, 1.0), axis, MODULE, 0.0, "gears.driven")
    with pytest.raises(WrongInput, match="none fits there"):
        require_crank_pin_room(disc, RoundHole(1.0, 0.0, 1.0), axis, MODULE, 0.0, "gears.driven")
    made = plan_of(Blank(WIDTH, Bore(BORE), crank_pin=RoundHole(12.0, 16.0, 6.0), clearance_mm=0.1)).crank_pin
    assert made == RoundHole(12.0, 16.0, 6.2)


# --- bore and what stands about the axis -----------------------------------------------------------------------------


def test_bores_and_hubs_without_room_are_told_the_largest() -> None:
    assert largest_told(lambda: plan_of(Blank(WIDTH, Bore(78.0))), "bore_mm") == pytest.approx(
        2.0 * (RADIUS - MODULE - FINE), abs=0.02
    )
    assert largest_told(lambda: plan_of(Blank(WIDTH, Bore(BORE), hub=Hub(90.0, 3.0))), "hub.diameter_mm") == (
        pytest.approx(2.0 * RADIUS, abs=0.02)
    )
    # Twice the way to the keyway's corner, hypot(8, 3), and two modules.
    keyed = Blank(WIDTH, Bore(8.0, Keyway(6.0, 4.0)))
    least = 2.0 * (hypot(8.0, 3.0) + MODULE)
    for blank, key in (
        (replace(keyed, hub=Hub(least - 0.02, 3.0)), "hub.diameter_mm"),
        (replace(keyed, web=WebSize(4.0, 6.0, least - 0.02)), "web.hub_mm"),
    ):
        with pytest.raises(WrongInput, match=rf"{np.ceil(100.0 * least) / 100.0:g} mm or more is right") as refused:
            plan_of(blank)
        assert str(refused.value.key).endswith(key)
    plan_of(replace(keyed, hub=Hub(least + 0.01, 3.0)))


def test_bore_and_keyway_take_their_area() -> None:
    """Circle and rectangle, less the segment that both have; widened by the clearance, and narrowed by half a kerf."""
    for move in (0.0, 0.2, -0.2):
        blank = Blank(WIDTH, Bore(30.0, Keyway(8.0, 3.3)), clearance_mm=move)
        radius, half, reach = 15.0 + move, 4.0 + move, 18.3 + move
        chord = (radius**2 - half**2) ** 0.5
        cut = pi * radius**2 + 2.0 * half * (reach - chord) - (radius**2 * asin(half / radius) - half * chord)
        assert plan_of(blank).section.area == pytest.approx(pi * (RADIUS - move) ** 2 - cut, rel=5e-5)


# --- the slot of an end stop -----------------------------------------------------------------------------------------


@at_once("turned", [1.0, -2.5])
def test_a_slot_is_a_bent_strip_with_round_ends(turned: float) -> None:
    """As long as the pin's way, and longer by what the clearance lets the pin rest beyond; about the far side."""
    stop = EndStop(4.0, 20.0, 0.3, turned)
    plan = plan_of(Blank(WIDTH, Bore(BORE), end_stop=stop))
    assert plan.slot is not None
    cut = Polygon(slot_points(plan.slot, 1e-5))
    span = abs(turned) - 2.0 * 2.0 * asin(0.3 / 4.0 / 20.0)
    assert cut.area == pytest.approx(4.3 * 20.0 * span + pi / 4.0 * 4.3**2, rel=1e-4)
    assert plan.section.area == pytest.approx(pi * (RADIUS**2 - 25.0) - cut.area, rel=1e-4)
    assert cut.centroid.y == pytest.approx(0.0, abs=1e-6)
    assert cut.centroid.x < 0.0
    assert plan.pin_mm == pytest.approx((20.0 * cos(pi + turned / 2.0), 20.0 * sin(pi + turned / 2.0)))
    # Its arcs for drawings are on it: each long side in two, by bulges of a quarter of the angle.
    ends = plan.slot.points
    assert [cut.exterior.distance(Point(end)) for end in ends] == pytest.approx([0.0] * 6, abs=1e-4)
    for start, end, bulge in zip(ends, np.roll(ends, -1, axis=0), plan.slot.bulges, strict=True):
        middle, step = (start + end) / 2.0, end - start
        top = middle + bulge / 2.0 * np.array([step[1], -step[0]])
        assert cut.exterior.distance(Point(top)) < 1e-4


def test_a_slot_keeps_a_module_to_the_edge_the_bore_and_its_own_other_end() -> None:
    """Refused a hundredth beyond each, and taken a hundredth within."""
    disc, axis = Polygon(circle_points(RADIUS, 1e-4)), Point(0.0, 0.0).buffer(BORE / 2.0, quad_segs=256)
    stop = EndStop(4.0, 20.0, 0.0, 1.0)

    def fits(**values: float) -> bool:
        try:
            require_slot_room(disc, replace(stop, **values), axis, pi, MODULE, "gears.driven")
        except WrongInput:
            return False
        return True

    outer, inner = RADIUS - 2.0 - MODULE, BORE / 2.0 + 2.0 + MODULE
    assert [fits(radius_mm=outer + more) for more in (-0.05, 0.05)] == [True, False]
    assert [fits(radius_mm=inner + more) for more in (-0.05, 0.05)] == [False, True]
    # Both ends of 4 mm stand a module from each other where their middles' chord is 6 mm.
    closed = 2.0 * pi - 2.0 * asin(6.0 / 2.0 / 20.0)
    assert [fits(turned_rad=closed + more) for more in (-0.01, 0.01)] == [True, False]
    assert not fits(radius_mm=1.5)
    # Clearance takes the whole of so short a way.
    assert not fits(turned_rad=0.01, clearance_mm=0.5)
    with pytest.raises(WrongInput, match=r"; (\S+) mm fits") as refused:
        require_slot_room(disc, replace(stop, radius_mm=39.0), axis, pi, MODULE, "gears.driven")
    told = float(re.findall(r"; (\S+) mm fits", refused.value.problem)[0])
    assert outer - 2.0 * RADIUS / 60.0 < told <= outer
    assert fits(radius_mm=told)


# --- rings and kerf --------------------------------------------------------------------------------------------------


def test_a_ring_leaves_its_rim_and_marks_it_beside_the_teeth() -> None:
    plan = planned_ring(circle_points(RADIUS, FINE), RingBlank(WIDTH, 12.0, True, clearance_mm=0.2), MODULE, FINE)
    assert plan.is_ring
    assert plan.disc.area == pytest.approx(pi * (52.0**2 - (RADIUS + 0.2) ** 2), rel=1e-4)
    hole = plan.index_hole
    assert hole is not None
    assert (hypot(hole.x_mm, hole.y_mm), hole.diameter_mm) == pytest.approx(
        (RADIUS + 0.2 + 1.0 + 1.5 * MODULE, 2.0), abs=0.02
    )


def test_all_that_is_cut_through_is_drawn_narrower_by_the_kerf() -> None:
    blank = Blank(
        WIDTH,
        Bore(BORE, Keyway(3.0, 1.4)),
        True,
        holes=HoleSet(3, 2.0, 4.0),
        end_stop=EndStop(3.0, 28.0, 0.2, 1.0),
        crank_pin=RoundHole(0.0, 20.0, 5.0),
    )
    plain, cut = plan_of(blank), plan_of(replace(blank, clearance_mm=-0.1))
    assert plain.slot is not None
    assert cut.slot == replace(plain.slot, width_mm=plain.slot.width_mm - 0.2)
    assert [one.diameter_mm for one in cut.round_holes] == pytest.approx(
        [one.diameter_mm - 0.2 for one in plain.round_holes]
    )
    assert len(cut.round_holes) == 5
    grown = MultiPolygon([cut.section]).buffer(-0.1, join_style="mitre")
    assert grown.symmetric_difference(plain.section).area < 0.05
    for narrow in (
        replace(blank, end_stop=EndStop(0.7, 28.0, 0.1, 1.0)),
        replace(blank, crank_pin=RoundHole(0, 20, 0.8)),
    ):
        with pytest.raises(WrongInput, match=r"of 0\.8 mm; over -0\.4 mm is right"):
            plan_of(replace(narrow, clearance_mm=-0.4))
