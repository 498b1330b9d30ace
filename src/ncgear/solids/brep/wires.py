"""Closed wires in the plane z = 0: tooth outlines, bores, circles."""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, cos, sin

import numpy as np
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex, BRepBuilderAPI_MakeWire
from OCP.collections import Array1_double, Array1_gp_Pnt, Array1_int
from OCP.GC import GC_MakeArcOfCircle, GC_MakeSegment
from OCP.Geom import Geom_BSplineCurve, Geom_Curve
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt
from OCP.TopoDS import TopoDS_Vertex, TopoDS_Wire

from ncgear.numerics.arrays import Array
from ncgear.solids.bore import Bore
from ncgear.teeth.arcs import Arc, Line
from ncgear.teeth.contour import Curve, Spline
from ncgear.teeth.splines import DEGREE

UP = gp_Dir(0.0, 0.0, 1.0)


def wire_of(curves: Sequence[Curve], height_mm: float = 0.0) -> TopoDS_Wire:
    """A closed wire of curves, each of which begins where the last one ends; they share vertices there.

    Raises RuntimeError, a fault of ncgear, where the kernel finds them apart.
    """
    vertices = [BRepBuilderAPI_MakeVertex(_point(curve.start, height_mm)).Vertex() for curve in curves]
    maker = BRepBuilderAPI_MakeWire()
    for curve, start, end in zip(curves, vertices, [*vertices[1:], vertices[0]], strict=True):
        maker.Add(_edge(_geometry(curve, height_mm), start, end).Edge())
        if not maker.IsDone():
            raise RuntimeError(f"a curve that begins at {curve.start.tolist()} mm does not close an outline")
    return maker.Wire()


def circle_wire(x_mm: float, y_mm: float, radius_mm: float) -> TopoDS_Wire:
    """A whole circle as one edge."""
    circle = gp_Circ(gp_Ax2(gp_Pnt(x_mm, y_mm, 0.0), UP), radius_mm)
    return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire()


def bore_wire(bore: Bore) -> TopoDS_Wire:
    """The bore's circle, or its arc and the three sides of the keyway."""
    return circle_wire(0.0, 0.0, bore.diameter_mm / 2.0) if bore.keyway is None else wire_of(_keyed(bore))


def _keyed(bore: Bore) -> list[Curve]:
    assert bore.keyway is not None
    radius, half, reach = bore.diameter_mm / 2.0, bore.keyway.width_mm / 2.0, bore.reach_mm
    begin = asin(half / radius)
    upper, lower = radius * np.array([[cos(begin), sin(begin)], [cos(begin), -sin(begin)]])
    floor = np.array([[reach, -half], [reach, half]])
    return [Arc(upper, np.array([-radius, 0.0]), lower), Line(lower, floor[0]), Line(*floor), Line(floor[1], upper)]


def _edge(curve: Geom_Curve, start: TopoDS_Vertex, end: TopoDS_Vertex) -> BRepBuilderAPI_MakeEdge:
    return BRepBuilderAPI_MakeEdge(curve, start, end, curve.FirstParameter(), curve.LastParameter())


def _geometry(curve: Curve, height: float) -> Geom_Curve:
    match curve:
        case Line():
            return GC_MakeSegment(_point(curve.start, height), _point(curve.end, height)).Value()
        case Arc():
            return GC_MakeArcOfCircle(*(_point(at, height) for at in (curve.start, curve.middle, curve.end))).Value()
        case Spline():
            return _bspline(curve, height)


def _bspline(curve: Spline, height: float) -> Geom_BSplineCurve:
    poles = Array1_gp_Pnt(1, len(curve.poles_mm))
    for number, pole in enumerate(curve.poles_mm, 1):
        poles.SetValue(number, _point(pole, height))
    return Geom_BSplineCurve(poles, *knots_of(curve.knots), DEGREE)


def knots_of(knots: Array) -> tuple[Array1_double, Array1_int]:
    """Distinct knots and how often each stands, from knots of shape (n,)."""
    distinct, times = np.unique(knots, return_counts=True)
    values, multiplicities = Array1_double(1, distinct.size), Array1_int(1, distinct.size)
    for number, (knot, count) in enumerate(zip(distinct, times, strict=True), 1):
        values.SetValue(number, float(knot))
        multiplicities.SetValue(number, int(count))
    return values, multiplicities


def _point(at: Array, height: float) -> gp_Pnt:
    return gp_Pnt(float(at[0]), float(at[1]), height)
