"""Gears of exact faces with a stand-in for the kernel, whose solids shapely cuts at every height.

The kernel takes longer to load than quick tests have; what it makes of the same numbers is read back in
``test_step.py``.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import asin, cos, pi, sin, sqrt
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import Polygon

from ncgear.errors import Unanswered
from ncgear.solids.plan.body import ArcSlot, BodyPlan, Bore, Hub, Keyway, RoundHole, SetScrew, Web
from ncgear.teeth.contour import Arc, Line

Made: Any = SimpleNamespace
Array = np.ndarray
NAME = "ncgear.solids.brep.gear"


class Kernel(ModuleType):
    """A module in which every name is there."""

    __path__: Sequence[str] = ()

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return lambda *given: given


@dataclass(frozen=True)
class Solid:
    """A solid by its section at a height."""

    at: Callable[[float], Any]


def region(curves: Sequence[Any], height_mm: float = 0.0) -> Polygon:
    """The inside of closed curves, each of which begins where the one before it ends; arcs by 2000 chords."""
    assert height_mm == 0.0
    points = []
    for curve, after in zip(curves, [*curves[1:], curves[0]], strict=True):
        assert curve.end == pytest.approx(after.start, abs=1e-12)
        points.append(through(curve) if isinstance(curve, Arc) else [curve.start])
    return Polygon(np.concatenate(points))


def through(arc: Arc) -> Array:
    """Points of the arc through three points, the last left out."""
    a, b, c = (complex(*at) for at in (arc.start, arc.middle, arc.end))
    u, v = b - a, c - a
    middle = a + u * v * (u - v).conjugate() / (u.conjugate() * v - u * v.conjugate())
    turned = np.angle((b - middle) / (a - middle)), np.angle((c - middle) / (b - middle))
    shares = np.concatenate([turned[0] * np.arange(1000), turned[0] * 1000 + turned[1] * np.arange(1000)]) / 1000
    around = middle + (a - middle) * np.exp(1j * shares)
    return np.column_stack([around.real, around.imag])


def disc(x_mm: float, y_mm: float, radius_mm: float) -> Any:
    return shapely.Point(x_mm, y_mm).buffer(radius_mm, quad_segs=500)


def prism(outer: Any, holes: Sequence[Any], low_mm: float, high_mm: float) -> Solid:
    section = outer.difference(shapely.union_all(holes))
    return Solid(lambda height: section if low_mm < height < high_mm else Polygon())


def drill(start_mm: Array, direction: Array, radius_mm: float, length_mm: float) -> Solid:
    """A level cylinder."""
    assert direction[2] == 0.0

    def at(height: float) -> Any:
        half = sqrt(max(radius_mm**2 - (height - start_mm[2]) ** 2, 0.0))
        line = shapely.LineString([start_mm[:2], start_mm[:2] + length_mm * direction[:2]])
        return line.buffer(half, cap_style="flat") if half else Polygon()

    return Solid(at)


def cut(shape: Solid, tools: Sequence[Solid]) -> Solid:
    return Solid(lambda height: shape.at(height).difference(shapely.union_all([tool.at(height) for tool in tools])))


@pytest.fixture(scope="module")
def brep() -> Iterator[Any]:
    """The module, with the stand-in where the kernel is not loaded already."""
    parent, new = importlib.import_module("ncgear.solids.brep"), NAME not in sys.modules
    names = "BRepAlgoAPI BRepBuilderAPI BRepCheck BRepGProp BRepLib BRepPrimAPI GC GProp Geom ShapeFix ShapeUpgrade"
    makers = {"wire_of": region, "circle_wire": disc, "prism": prism, "cylinder": drill, "cut": cut}
    makers |= {"fused": lambda one, other: Solid(lambda height: one.at(height).union(other.at(height)))}
    with pytest.MonkeyPatch.context() as patch:
        for name in f"{names} TopAbs TopExp TopLoc TopoDS collections gp".split() if new else []:
            patch.setitem(sys.modules, "OCP", Kernel("OCP"))
            patch.setitem(sys.modules, f"OCP.{name}", Kernel(name))
        module = importlib.import_module(NAME)
        patch.setattr(module, "kernel_s_prism", module.prism, raising=False)
        for name, made in (makers | {"sound": lambda shape: shape}).items():
            patch.setattr(module, name, made)
        yield module
        if new:
            del sys.modules[NAME], parent.gear


SIDE = 40.0
CORNERS = SIDE / 2.0 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
SQUARE: Any = Made(curves=tuple(Line(*ends) for ends in zip(CORNERS, np.roll(CORNERS, -1, axis=0), strict=True)))


def ring(radius_mm: float, corners: int) -> Array:
    around = radius_mm * np.exp(2j * pi * np.arange(corners) / corners)
    return np.column_stack([around.real, around.imag])


def within(radius_mm: float, half_mm: float) -> float:
    """Area between a diameter and its circle, up to a distance to both sides of a ray."""
    return half_mm * sqrt(radius_mm**2 - half_mm**2) + radius_mm**2 * asin(half_mm / radius_mm)


def bored(diameter_mm: float, width_mm: float, reach_mm: float) -> float:
    """Area of a bore with a keyway."""
    radius, half = diameter_mm / 2.0, width_mm / 2.0
    return pi * radius**2 + width_mm * reach_mm - within(radius, half)


@pytest.mark.judges("solids")
def test_a_body_of_exact_faces_has_the_sections_of_its_plan(brep: Any) -> None:
    """A square of 40 mm with pocket, hub, keyway, slot, hole and set screw, its areas in closed form at each height."""
    # The pocket's inner wall stops 0.03 mm short of the hub, whose side goes on down to the web.
    pocket = Polygon(ring(16.0, 240), [ring(9.03, 240)])
    plan = BodyPlan(
        Polygon(CORNERS), 10.0, 0.01, Bore(10.0, Keyway(3.0, 1.4)), RoundHole(17.5, 17.5, 2.0),
        hub=Hub(18.0, 8.0, SetScrew(3.0, 14.0, 2.0)), web=Web(4.0, (pocket,)), slot=ArcSlot(18.0, 1.0, -0.3, 0.2),
    )  # fmt: skip
    shape = brep.gear_shape(SQUARE, plan)
    hole = bored(10.0, 3.0, 6.4)
    through = SIDE**2 - hole - pi - (18.0 * 0.5 + pi / 4.0)
    pockets = pi * (16.0**2 - 9.0**2)
    for height, area in ((0.01, through), (3.99, through), (4.01, through - pockets), (9.99, through - pockets)):
        assert shape.at(height).area == pytest.approx(area, rel=2e-5)
    for height in (10.01, 12.4, 15.6, 17.99):
        assert shape.at(height).area == pytest.approx(pi * 81.0 - hole, rel=2e-5)
    # The screw's hole reaches from the bore to beyond the hub on one side only.
    drilled = shape.at(14.0)
    for radius in (5.5, 8.9):
        rays = [drilled.contains(shapely.Point(radius * cos(at), radius * sin(at))) for at in (2.0, 2.0 + pi)]
        assert rays == [False, True]
    for height, half in ((14.0, 1.5), (15.0, sqrt(1.25))):
        gone = within(9.0, half) - within(5.0, half)
        assert pi * 81.0 - hole - shape.at(height).area == pytest.approx(gone, rel=1e-3)
    assert shape.at(-0.5).is_empty
    assert shape.at(18.01).is_empty


@pytest.mark.judges("solids")
def test_a_ring_of_exact_faces_stands_within_its_circle(brep: Any) -> None:
    plan = BodyPlan(Polygon(CORNERS), 10.0, 0.01, index_hole=RoundHole(0.0, 28.0, 4.0))
    shape = brep.ring_shape(SQUARE, plan, 32.0)
    area = pi * (32.0**2 - 4.0) - SIDE**2
    assert [shape.at(height).area for height in (0.1, 9.9)] == pytest.approx([area, area], rel=1e-5)
    assert shape.at(10.1).is_empty


@pytest.mark.judges("solids")
@pytest.mark.parametrize(("short", "radius"), [(0.039, 9.0), (-0.039, 9.0), (0.041, 8.959)])
def test_a_pocket_that_stops_short_of_the_hub_by_four_tolerances_at_most_goes_on_from_it(
    short: float, radius: float, brep: Any
) -> None:
    plan = BodyPlan(Polygon(CORNERS), 10.0, 0.01, hub=Hub(18.0, 8.0))
    found = brep._round(shapely.LinearRing(ring(9.0 - short, 240)), plan)
    assert found.area == pytest.approx(pi * radius**2, rel=1e-5)


@pytest.mark.judges("solids")
def test_a_pocket_s_circle_is_in_the_middle_of_its_corners(brep: Any) -> None:
    """Corners in turn at 16 mm and 6 micrometres farther out, each 3 micrometres off the circle."""
    corners = ring(16.0, 240) * np.tile([1.0, 1.0 + 0.006 / 16.0], 120)[:, None]
    found = brep._round(shapely.LinearRing(corners), BodyPlan(Polygon(CORNERS), 10.0, 0.01))
    assert found.area == pytest.approx(pi * 16.003**2, rel=1e-5)


@pytest.mark.judges("solids")
def test_a_wall_that_is_no_circle_becomes_lines_and_arcs_within_half_a_tolerance(brep: Any) -> None:
    """A square with rounded corners; the circle between its nearest and farthest point would be 3 mm off."""
    wall = shapely.box(-10.0, -10.0, 10.0, 10.0).buffer(2.0, quad_segs=30)
    found = brep._round(wall.exterior, BodyPlan(Polygon(CORNERS), 10.0, 0.01))
    assert found.hausdorff_distance(wall) < 0.01 * 8.0 / 17.0 + 0.01 * 0.1


@pytest.mark.judges("solids")
def test_the_upper_half_of_a_herringbone_is_the_lower_one_seen_in_a_mirror(
    brep: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Poles of one surface over two heights, from 0 to 6 mm: the mirror lies at 6 mm, and heights go on upwards."""
    poles = np.zeros((1, 2, 2, 3))
    poles[0, :, :, 0], poles[0, :, :, 1] = [[1.0, 2.0], [3.0, 4.0]], 7.0
    poles[0, :, 1, 2] = 6.0
    sides: list[Array] = []
    ends: list[Array] = []
    monkeypatch.setattr(brep, "_side", lambda patches, one: sides.append(one))
    monkeypatch.setattr(brep, "_end", lambda patches, one: ends.append(one))
    monkeypatch.setattr(brep, "_sewn", len)
    assert brep._helical_shape(Made(poles_mm=poles), herringbone=True) == 4
    assert sides[1][..., 0].tolist() == [[2.0, 1.0], [4.0, 3.0]]
    assert sides[1][..., 1].tolist() == [[7.0, 7.0], [7.0, 7.0]]
    assert sides[1][..., 2].tolist() == [[6.0, 12.0], [6.0, 12.0]]
    assert [end[0, 0].tolist() for end in ends] == [[1.0, 7.0, 0.0], [1.0, 7.0, 12.0]]
    assert brep._helical_shape(Made(poles_mm=poles), herringbone=False) == 3
    assert ends[-1][0, 0].tolist() == [2.0, 7.0, 6.0]


@pytest.mark.judges("solids")
def test_helical_teeth_are_drilled_through_and_bored(brep: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    blank = prism(disc(0.0, 0.0, 20.0), [], 0.0, 10.0)
    monkeypatch.setattr(brep, "_helical_shape", lambda patches, herringbone: blank)
    plan = BodyPlan(Polygon(CORNERS), 10.0, 0.01, Bore(8.0), lightening_holes=(RoundHole(12.0, 0.0, 6.0),))
    shape = brep.helical_gear_shape(None, plan, herringbone=False)
    for height in (0.01, 5.0, 9.99):
        assert shape.at(height).area == pytest.approx(pi * (400.0 - 16.0 - 9.0), rel=1e-5)


# --- what the kernel is asked for


@pytest.mark.judges("solids")
@pytest.mark.parametrize(
    ("low", "high", "asked"), [(0.0, 5.0, ((0, 0, 5), None)), (-1.0, 11.0, ((0, 0, 12), (0, 0, -1)))]
)
def test_a_prism_is_swept_by_its_height_and_moved_to_its_foot(
    low: float, high: float, asked: Any, brep: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    face = Made(Add=lambda hole: None, Face=lambda: None, FixOrientation=lambda: None)
    for name, made in {
        "BRepBuilderAPI_MakeFace": lambda *_: face,
        "ShapeFix_Face": lambda _: face,
        "gp_Vec": lambda *step: step,
        "moved_by": lambda step: step,
        "BRepPrimAPI_MakePrism": lambda _, step: Made(Shape=lambda: Swept(step)),
    }.items():
        monkeypatch.setattr(brep, name, made)
    found = brep.kernel_s_prism(None, ["hole"], low, high)
    assert (found.step, found.at) == asked


@dataclass(frozen=True)
class Swept:
    """A shape that is swept by a step and then moved."""

    step: Any
    at: Any = None

    def Moved(self, at: Any) -> Swept:
        return Swept(self.step, at)


@pytest.mark.judges("solids")
def test_poles_of_a_surface_are_numbered_from_one(brep: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    poles = np.arange(18.0).reshape(2, 3, 3)
    grid: dict[tuple[int, int], Any] = {}
    array = Made(SetValue=lambda row, column, point: grid.update({(row, column): point}))
    monkeypatch.setattr(brep, "Array2_gp_Pnt", lambda *_: array)
    monkeypatch.setattr(brep, "gp_Pnt", lambda *at: at)
    monkeypatch.setattr(brep, "knots_of", lambda knots: (knots, knots))
    monkeypatch.setattr(brep, "Geom_BSplineSurface", lambda *_: None)
    monkeypatch.setattr(brep, "BRepBuilderAPI_MakeFace", lambda *_: Made(Face=lambda: None))
    brep._side(Made(along=None, up=None), poles)
    assert grid == {(row + 1, column + 1): tuple(poles[row, column]) for row in range(2) for column in range(3)}


@pytest.mark.judges("solids")
@pytest.mark.parametrize(("count", "fine"), [(0, False), (1, True), (2, False)])
def test_what_is_left_is_one_solid(count: int, fine: bool, brep: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    sewing = Made(Add=None, Perform=lambda: None, SewedShape=lambda: None, NbFreeEdges=lambda: 0)
    monkeypatch.setattr(brep, "parts_of", lambda shape, kind: ["part"] * count)
    monkeypatch.setattr(brep, "BRepBuilderAPI_Sewing", lambda _: sewing)
    monkeypatch.setattr(brep, "TopoDS", Made(Shell=lambda shell: shell))
    monkeypatch.setattr(brep, "BRepBuilderAPI_MakeSolid", lambda shell: Made(Solid=lambda: shell))
    monkeypatch.setattr(brep, "BRepLib", Made(OrientClosedSolid_s=lambda solid: None))
    done = Made(IsDone=lambda: True, Shape=lambda: None)
    for made in (lambda: brep._one(done), lambda: brep._sewn([])):
        try:
            assert made() == "part"
            assert fine
        except Unanswered:
            assert not fine
