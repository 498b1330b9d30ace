"""Bodies by plain geometry: pockets and hubs, lofts, meshes that are open, room, checks of sections, parallels."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from shapely.geometry import Point, Polygon, box

from ncgear.pitch.shape import Gear
from ncgear.solids.helical import mesh as lofts
from ncgear.solids.helical import stack
from ncgear.solids.helical.mesh import lofted
from ncgear.solids.mesh.pair import finished
from ncgear.solids.mesh.slabs import Slab, facing, filling, slab_mesh
from ncgear.solids.mesh.triangles import TriangleMesh
from ncgear.solids.plan import plan as plans
from ncgear.solids.plan.areas import TooThick, moved_inwards, moved_outwards
from ncgear.solids.plan.body import BodyPlan, Bore, Hub, RoundHole, Web
from ncgear.solids.plan.room import around_axis, rim_hole

Made: Any = SimpleNamespace


@pytest.mark.judges("solids")
def test_a_body_has_its_pockets_and_its_hub() -> None:
    """A plate of 40 mm, 10 mm high, less two pockets of 8 mm by 6 mm down to 4 mm, and a square hub 5 mm high."""
    pockets = box(-18.0, -3.0, -10.0, 3.0), box(10.0, -3.0, 18.0, 3.0)
    plan = BodyPlan(box(-20.0, -20.0, 20.0, 20.0), 10.0, 0.01, web=Web(4.0, pockets), hub=Hub(12.0, 5.0))
    toothed = slab_mesh((Slab(plan.section, 0.0, 10.0),))
    found = finished(toothed, plan)
    assert found.volume == pytest.approx(1600.0 * 10.0 - 2.0 * 48.0 * 6.0 + 36.0 * pi * 5.0, rel=1e-3)
    assert found.extents == pytest.approx([40.0, 40.0, 15.0])
    assert found.is_watertight
    assert finished(toothed, replace(plan, web=None, hub=None)) is toothed


@pytest.mark.judges("solids")
def test_a_mesh_is_closed_where_each_edge_has_two_triangles_one_each_way() -> None:
    corners = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 5.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    solid = TriangleMesh(corners, faces)
    assert (solid.is_watertight, solid.is_winding_consistent, solid.volume) == (True, True, pytest.approx(10.0))
    assert solid.extents.tolist() == [3.0, 4.0, 5.0]
    assert not TriangleMesh(corners, faces[1:]).is_watertight
    turned = TriangleMesh(corners, np.vstack([faces[:3], faces[3:, ::-1]]))
    assert (turned.is_watertight, turned.is_winding_consistent) == (True, False)


@pytest.mark.judges("solids")
def test_a_loft_of_rings_with_holes_has_the_volume_of_a_frustum() -> None:
    """From a square of 20 mm to one of 30 mm over 6 mm, with two holes of 4 mm straight through."""
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    holes = [2.0 * square + [5.0, 0.0], 2.0 * square - [5.0, 0.0]]
    found = lofted(np.stack([10.0 * square, 15.0 * square]), np.array([0.0, 6.0]), holes)
    assert found.volume == pytest.approx(6.0 / 3.0 * (400.0 + 900.0 + 600.0) - 2.0 * 16.0 * 6.0)
    assert (found.is_watertight, found.is_winding_consistent) == (True, True)
    assert found.extents == pytest.approx([30.0, 30.0, 6.0])


@pytest.mark.judges("solids")
def test_a_herringbone_is_its_half_and_its_mirror_image(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[Any] = []
    monkeypatch.setattr(lofts, "planned_through", lambda *_: Made(bore=None, round_holes=()))
    monkeypatch.setattr(lofts, "lofted", lambda rings, heights, holes: told.append((rings, heights)))
    monkeypatch.setattr(lofts, "finished", lambda *_: None)
    rings = np.arange(3.0)[:, None, None] * np.ones((3, 4, 2))
    for herringbone in (False, True):
        helix = Made(herringbone=herringbone, face_width_mm=20.0)
        sections: Any = Made(helix=helix, pieces=lambda *_: [], form=Made(rack=Made(module_mm=2.0)))
        made: Any = Made(heights_mm=np.array([0.0, 4.0, 10.0]), counter_clockwise=lambda: rings)
        lofts._solid(sections, made, Gear.DRIVING, Made(), 0.01)
    assert [heights.tolist() for _, heights in told] == [[0.0, 4.0, 10.0], [0.0, 4.0, 10.0, 16.0, 20.0]]
    assert [given[:, 0, 0].tolist() for given, _ in told] == [[0.0, 1.0, 2.0], [0.0, 1.0, 2.0, 1.0, 0.0]]


@pytest.mark.judges("solids")
def test_triangles_of_points_in_line_use_every_point() -> None:
    """A square of 4 mm with points on its sides: as many triangles as corners less two, and its area."""
    side = np.linspace(0.0, 4.0, 5)[:-1]
    ring = np.concatenate(
        [
            np.column_stack([side, 0.0 * side]),
            np.column_stack([0.0 * side + 4.0, side]),
            np.column_stack([4.0 - side, 0.0 * side + 4.0]),
            np.column_stack([0.0 * side, 4.0 - side]),
        ]
    )
    triangles = filling(ring + 10.0, np.array([16]))
    assert triangles.shape == (14, 3)
    assert set(triangles.ravel().tolist()) == set(range(16))
    for up, sign in ((True, 1.0), (False, -1.0)):
        made = facing(np.column_stack([ring, np.zeros(16)]), triangles, up=up)
        a, b, c = made.triangles.transpose(1, 0, 2)
        areas = np.cross(b - a, c - a)[:, 2] / 2.0
        assert areas.sum() == pytest.approx(sign * 16.0)


@pytest.mark.judges("solids")
def test_steps_between_sections_stay_within_shares_of_the_tolerance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps by the share of the rise, chords and twists by theirs."""
    asked: list[float] = []
    told: list[Any] = []
    sections: Any = Made(
        steps_within=lambda size: asked.append(size) or 4,
        helix=Made(rise_mm=8.0),
        pieces=lambda gear, heights: told.append(heights.tolist()),
    )
    monkeypatch.setattr(stack, "spread_columns", lambda pieces, limits: told.append(limits) or Made())
    monkeypatch.setattr(stack, "stacked", lambda *_: Made())
    strays = {gear: np.zeros((1, 3)) for gear in Gear}
    monkeypatch.setattr(stack, "_checked", lambda *_: stack._Check(np.array([1.0]), strays, 0.1))
    assert set(stack.close_stacks(sections, 0.2)) == set(Gear)
    assert asked == [pytest.approx(stack.RISE * 0.2)]
    assert told[0] == [0.0, 2.0, 4.0, 6.0, 8.0]
    assert (told[1].sagitta_mm, told[1].twist_mm) == pytest.approx((0.2 * stack.SAGITTA, 0.2 * stack.TWIST))


@pytest.mark.judges("solids")
def test_a_check_names_heights_and_columns_that_stray() -> None:
    strays = {Gear.DRIVING: np.zeros((2, 20)), Gear.DRIVEN: np.zeros((2, 20))}
    strays[Gear.DRIVEN][1, 7] = 0.3
    check = stack._Check(np.array([1.0, 2.0]), strays, 0.1)
    assert check.failed.tolist() == [False, True]
    assert np.flatnonzero(check.wide(Gear.DRIVEN)).tolist() == [7]
    assert not check.wide(Gear.DRIVING).any()
    strays[Gear.DRIVEN][0, :] = 0.3
    assert not check.wide(Gear.DRIVEN).any()
    pieces = np.full(20, 3)
    pieces[7] = 2 * stack.PER_TOOTH + 1
    strays[Gear.DRIVEN][0, :] = 0.0
    stacks: Any = {Gear.DRIVEN: Made(columns=Made(piece=pieces))}
    sections: Any = Made(form=Made(limits=Made(avoid_undercut=True)))
    said = stack._too_abrupt(check, stacks, sections, 0.1).problem
    assert "z = 2 mm" in said
    assert "tooth 3 of the driven gear it strays by 0.3 mm" in said


@pytest.mark.judges("solids")
def test_no_more_steps_than_are_allowed_are_taken() -> None:
    def sections(steps: int) -> Any:
        helix = Made(largest_advance_mm=5.0, rise_mm=8.0)
        return Made(steps_within=lambda _: steps, helix=helix, sagitta_mm=lambda count: 0.012 / count)

    assert stack._first_heights(sections(stack.MOST_STEPS), 0.01).size == stack.MOST_STEPS + 1
    assert stack.finest_in_steps_mm(sections(1)) == pytest.approx(0.012 / stack.MOST_STEPS / stack.RISE)
    with pytest.raises(Exception, match="more than"):
        stack._first_heights(sections(stack.MOST_STEPS + 1), 0.01)


# --- room


@pytest.mark.judges("solids")
def test_the_axis_is_kept_free_by_hub_bore_or_itself() -> None:
    assert around_axis(Bore(8.0), 20.0, 2.0).area == pytest.approx(100.0 * pi, rel=0.01)
    assert around_axis(Bore(8.0), 0.0, 2.0).area == pytest.approx(16.0 * pi, rel=0.01)
    assert around_axis(None, 0.0, 2.0).is_empty is False
    assert around_axis(None, 0.0, 2.0).area == 0.0


@pytest.mark.judges("solids")
def test_holes_may_be_beside_bore_and_hub_or_in_pockets() -> None:
    room = box(-20.0, -20.0, 20.0, 20.0)
    plan = BodyPlan(room, 10.0, 0.001, bore=Bore(8.0), index_hole=RoundHole(15.0, 15.0, 2.0))
    assert plans._free(plan, room).area == pytest.approx(1600.0 - 17.0 * pi, rel=1e-3)
    assert plans._free(replace(plan, hub=Hub(16.0, 5.0)), room).area == pytest.approx(1600.0 - 65.0 * pi, rel=1e-3)
    pocket = box(10.0, -3.0, 18.0, 3.0)
    assert plans._free(replace(plan, web=Web(4.0, (pocket,))), room).area == pytest.approx(48.0)


@pytest.mark.judges("solids")
def test_a_parallel_inwards_is_refused_from_half_of_the_thinnest_part_on() -> None:
    """Two plates of 20 mm by 30 mm joined by a bar 4 mm wide: 2 mm is the most."""
    plates = box(-40.0, -15.0, -20.0, 15.0).union(box(20.0, -15.0, 40.0, 15.0))
    part = plates.union(box(-20.0, -2.0, 20.0, 2.0))
    assert moved_inwards(part, 1.9, 0.01, "key").area == pytest.approx(2.0 * 16.2 * 26.2 + (40.0 + 3.8) * 0.2, rel=1e-3)
    with pytest.raises(TooThick) as refused:
        moved_inwards(part, 2.5, 0.01, "key")
    assert refused.value.largest_mm == pytest.approx(2.0, abs=0.05)
    notch = part.envelope.difference(box(-2.0, 0.0, 2.0, 20.0))
    with pytest.raises(TooThick) as refused:
        moved_outwards(notch, 2.5, 0.01, "key")
    assert refused.value.largest_mm == pytest.approx(2.0, abs=0.05)
    assert "kerf of 4" in refused.value.problem or "kerf of 3.9" in refused.value.problem


@pytest.mark.judges("solids")
def test_a_ring_has_its_index_hole_near_the_teeth() -> None:
    """A ring from 30 to 50 mm: nearer to its opening than to its rim, on the ray that is asked for."""
    ring = Point(0.0, 0.0).buffer(50.0, quad_segs=64).difference(Point(0.0, 0.0).buffer(30.0, quad_segs=64))
    found = rim_hole(Polygon(ring.exterior, ring.interiors), pi / 2.0, 2.0)
    assert found is not None
    assert found.x_mm == pytest.approx(0.0, abs=1e-6)
    assert 30.0 + found.diameter_mm / 2.0 < found.y_mm < 40.0
