"""DXF files that a design file names for the contour of a pitch curve: lines, arcs and splines, as rational B-splines.

Circles, arcs, ellipses and bulges of polylines become rational curves of degree 2, which are exactly these shapes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from io import StringIO
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ncgear.design.reading.places import FromFile
from ncgear.design.reading.text import quoted, read_text
from ncgear.design.words import listed
from ncgear.errors import WrongInput

if TYPE_CHECKING:
    from ezdxf.entities import DXFEntity
    from ezdxf.math import BSpline

LARGEST_MB = 20

READ = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE")
NOTES = ("POINT", "TEXT", "MTEXT", "DIMENSION", "LEADER", "MULTILEADER")
PASSED_OVER = (*NOTES, "HATCH", "VIEWPORT", "IMAGE", "XLINE", "RAY")
"""What a drawing may hold beside the contour: it is no part of one."""


def contour_of(file: Path, given: Mapping[str, Any]) -> FromFile:
    """The parts of the layer that is ``given``, or of all; raises WrongInput for what holds none.

    Their order and sense are those of the file; whether they make one closed contour is for the law to say.
    """
    import ezdxf
    from ezdxf.lldxf.const import DXFError

    text, layer = read_text(file, limit_mb=LARGEST_MB), given.get("layer")
    try:
        document = ezdxf.read(StringIO(text))
        entities = list(document.modelspace())
        named = [one for one in entities if layer is None or one.dxf.layer.casefold() == str(layer).casefold()]
        unread = sorted({one.dxftype() for one in named} - {*READ, *PASSED_OVER})
        if unread:
            problem = (
                f"holds {listed(unread, 'and')}; a contour of {listed(READ)} is read (explode blocks in the drawing)"
            )
            raise WrongInput(problem, location=str(file))
        curves = [_values(curve, file) for one in named if one.dxftype() in READ for curve in _curves(one)]
    except (DXFError, ValueError, ArithmeticError, TypeError, KeyError, IndexError, AttributeError) as error:
        said = " ".join(str(error).split())
        raise WrongInput(
            f"is no DXF file that can be read: {said}; save it as ASCII DXF", location=str(file)
        ) from error
    if not curves:
        layers = sorted({one.dxf.layer for one in entities if one.dxftype() in READ})
        held = (
            f"layers with such parts are {listed([quoted(one) for one in layers], 'and')}" if layers else "it has none"
        )
        on_layer = "" if layer is None else f" on layer {quoted(layer)}"
        raise WrongInput(f"holds no {listed(READ)}{on_layer}; {held}", location=str(file))
    return FromFile({"curves": curves})


def _curves(entity: DXFEntity) -> Iterator[BSpline]:
    """The entity as rational B-splines, one after the other; what has no length may be among them."""
    from ezdxf import entities as kinds
    from ezdxf.math import BSpline, ConstructionEllipse, Vec3, rational_bspline_from_ellipse

    if isinstance(entity, kinds.LWPolyline | kinds.Polyline):
        for part in entity.virtual_entities():
            yield from _curves(part)
    elif isinstance(entity, kinds.Line):
        yield BSpline([entity.dxf.start, entity.dxf.end], order=2)
    elif isinstance(entity, kinds.Spline):
        yield entity.construction_tool()
    elif isinstance(entity, kinds.Ellipse):
        yield rational_bspline_from_ellipse(entity.construction_tool())
    elif isinstance(entity, kinds.Circle):
        start, end = (entity.dxf.start_angle, entity.dxf.end_angle) if isinstance(entity, kinds.Arc) else (0.0, 360.0)
        around = ConstructionEllipse.from_arc(
            Vec3(entity.dxf.center), entity.dxf.radius, Vec3(entity.dxf.extrusion), start, end
        )
        yield rational_bspline_from_ellipse(around)


def _values(curve: BSpline, file: Path) -> dict[str, Any]:
    """The curve as the keys of a part; refuses one that leaves the plane."""
    points = [tuple(point) for point in curve.control_points]
    numbers = [value for point in points for value in point]
    size = max(map(abs, numbers), default=0.0)
    if not isfinite(size):
        raise WrongInput("holds a coordinate that is no finite number", location=str(file))
    heights = [z for _, _, z in points]
    if max(heights) - min(heights) > 1e-6 * size:
        raise WrongInput(
            "holds a part that leaves the plane of the drawing; a flat contour is needed", location=str(file)
        )
    weights = [float(weight) for weight in curve.weights()] or [1.0] * len(points)
    return {
        "degree": curve.degree,
        "knots": [float(knot) for knot in curve.knots()],
        "x": [float(x) for x, _, _ in points],
        "y": [float(y) for _, y, _ in points],
        "weights": weights,
    }
