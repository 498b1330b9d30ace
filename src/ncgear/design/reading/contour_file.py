"""DXF files that a design file names for the contour of a pitch curve: lines, arcs and splines, as rational B-splines.

Circles, arcs, ellipses and bulges of polylines become rational curves of degree 2, which represent them exactly.  Files
of all systems are read: ASCII with both kinds of line ends, in their own code page, and binary files.
"""

from __future__ import annotations

import codecs
import struct
from collections.abc import Iterable, Iterator, Mapping
from decimal import Decimal
from io import StringIO
from itertools import islice
from math import floor, isfinite, log10, radians, tau
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ncgear.design.keys.pitch_shapes import MOST_CURVES
from ncgear.design.reading.long_chains import MARK, DxfText
from ncgear.design.reading.places import FromFile
from ncgear.design.reading.text import quoted, read_bytes
from ncgear.design.words import listed
from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.entities import DXFEntity, Line, LWPolyline, Polyline, Spline
    from ezdxf.math import BSpline
    from numpy.typing import ArrayLike

LARGEST_MB = 20

LARGE = 100_000
"""Bytes of a file from which on long chains are read by themselves."""

READ = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE")
"""Entities of a contour; blocks are taken apart, and all other entities of a drawing are passed over."""

UNITS = {1: "inch", 4: "mm", 5: "cm", 6: "m"}
"""Units of ``$INSUNITS`` that a design can name."""

MOST_ENTITIES = 100_000
"""Most entities of a drawing; the entities of a block count as often as the block is placed."""

NEVER_PLOTTED = "defpoints"
"""The layer on which programs keep points of their dimensions."""

DEEPEST = 16
"""Deepest nesting of blocks that is taken apart."""

SPLINE_FRAME = 16
"""Flag of a vertex of a smoothed polyline of R12 that is a control point, and not a point of the curve."""

FULL = 1e-5
"""Largest difference in rad of a whole ellipse from a full turn: programs write 6.28318 for 2 pi."""

CUT_OFF = (StopIteration, struct.error)
"""Errors of the library where a file ends too early."""

POINT = 1e-9
"""A circle or an arc with a smaller radius, in the drawing's unit, has no length."""

FLAT = 1e-9
"""An arc with a smaller bulge is a line: its height is less than a thousand-millionth of half its length."""


def contour_of(file: Path, given: Mapping[str, Any]) -> FromFile:
    """The parts of the ``given`` layer, or of all visible layers; raises WrongInput if there is none.

    They keep the order and sense of the file; the law decides whether they make one closed contour.  With them come the
    unit that the drawing names and the largest gap between ends that its digits explain.
    """
    from ezdxf.lldxf.const import DXFError

    layer = given.get("layer")
    try:
        document, chains = _document(file)
        every = list(islice(_apart(_whole(document.modelspace(), chains), file), MOST_ENTITIES + 1))
        if len(every) > MOST_ENTITIES:
            raise WrongInput(f"holds over {MOST_ENTITIES} entities; a contour alone is right", location=str(file))
        hidden = {_name(layer.dxf.name) for layer in document.layers if layer.is_off() or layer.is_frozen()}
        if layer is None:
            hidden |= {NEVER_PLOTTED, *(_name(layer.dxf.name) for layer in document.layers if not layer.dxf.plot)}
        shown = [
            entity for entity in every if _name(entity.dxf.layer) not in hidden and not entity.dxf.get("invisible", 0)
        ]
        named = [entity for entity in shown if layer is None or _name(entity.dxf.layer) == _name(str(layer))]
        read = [entity for entity in named if entity.dxftype() in READ]
        curves = chords_joined((_values(curve, entity, file) for entity in read for curve in _curves(entity)), file)
        if not curves:
            raise WrongInput(_holds_none(document, every, shown, layer), location=str(file))
        found = {"curves": curves, "near": _near(read)}
        unit = UNITS.get(document.header.get("$INSUNITS", 0))
    except (DXFError, ValueError, ArithmeticError, TypeError, LookupError, AttributeError, *CUT_OFF) as error:
        said = " ".join(str(error).split())
        problem = f"is no DXF file that can be read: {quoted(said)}; save it as DXF again"
        if isinstance(error, CUT_OFF) or "missing E" in said:
            problem = "has no EOF at its end: it is cut off; save it again"
        raise WrongInput(problem, location=str(file)) from error
    return FromFile(found if unit is None else {**found, "drawn_in": unit})


def _document(file: Path) -> tuple[Drawing, list[Array]]:
    """The drawing, and the long chains that are cut out of it; a file that only looks like a drawing is refused with
    the reason."""
    import ezdxf
    from ezdxf.filemanagement import dxf_file_info
    from ezdxf.lldxf.validator import is_binary_dxf_file, is_dxf_file

    content = read_bytes(file, limit_mb=LARGEST_MB)
    if content[:4] in (b"AC10", b"AC1."):
        raise WrongInput("is a DWG file, which is not read; save it as DXF", location=str(file))
    try:
        if content.startswith(codecs.BOM_UTF8):
            return ezdxf.read(StringIO(content.decode("utf-8-sig"), newline=None)), []
        if len(content) < LARGE or is_binary_dxf_file(str(file)) or not is_dxf_file(str(file)):
            return ezdxf.readfile(str(file)), []
        cut = DxfText(content.decode(dxf_file_info(str(file)).encoding, errors="surrogateescape"))
        return ezdxf.read(StringIO(cut.text)), cut.chains
    except OSError as error:
        begins = content[:40].decode("ascii", errors="replace").split("\n")[0]
        raise WrongInput(
            f"is no DXF file that can be read: it begins with {quoted(begins)}", location=str(file)
        ) from error


def _whole(entities: Iterable[DXFEntity], chains: list[Array]) -> Iterator[DXFEntity]:
    """The entities, with long chains whole again."""
    from ezdxf.entities import Line, LWPolyline, Polyline

    for entity in entities:
        if not isinstance(entity, Line | LWPolyline | Polyline) or entity.dxf.get("thickness", 0.0) < MARK:
            yield entity
            continue
        line = entity if isinstance(entity, LWPolyline) else _light(entity)
        line.lwpoints.values = chains[round(entity.dxf.thickness / MARK) - 1]
        yield line


def _light(entity: Line | Polyline) -> LWPolyline:
    """A polyline of R12, or a line, as a polyline of later files, still without vertices."""
    from ezdxf.entities import LWPolyline, Polyline

    found = {key: entity.dxf.get(key) for key in ("layer", "invisible")}
    if isinstance(entity, Polyline):
        height = entity.vertices[0].dxf.location.z if entity.vertices else 0.0
        found |= {"extrusion": entity.dxf.extrusion, "flags": int(entity.is_closed)}
    else:
        height = entity.dxf.start.z
    return LWPolyline.new(dxfattribs={**found, "elevation": height})


def _decoded(name: str) -> str:
    """The name of a layer or a block; the file may give letters by their numbers."""
    from ezdxf.lldxf.encoding import decode_dxf_unicode

    return str(decode_dxf_unicode(name))


def _name(name: str) -> str:
    """The name of a layer or a block for comparisons: case does not count."""
    return _decoded(name).casefold()


def _apart(entities: Iterable[DXFEntity], file: Path, within: tuple[str, ...] = ()) -> Iterator[DXFEntity]:
    """The entities, with the content of blocks in place of the blocks; ``within`` are the blocks around them.

    Raises WrongInput for a block that holds itself.
    """
    from ezdxf.entities import Insert

    for entity in entities:
        if not isinstance(entity, Insert) or len(within) == DEEPEST:
            yield entity
            continue
        name = _name(entity.dxf.name)
        if name in within:
            problem = f"block {quoted(_decoded(entity.dxf.name))} holds itself; explode it in the drawing"
            raise WrongInput(problem, location=str(file))
        if entity.mcount > 1:
            yield from _apart(entity.multi_insert(), file, within)
        else:
            for part in _apart(entity.virtual_entities(), file, (*within, name)):
                # The content of layer 0 of a block lies on the layer of the block.
                if part.dxf.layer == "0":
                    part.dxf.layer = entity.dxf.layer
                yield part


def _holds_none(document: Drawing, every: list[DXFEntity], shown: list[DXFEntity], layer: object) -> str:
    """The reason why a drawing gives no part of a contour."""

    def layers_of(entities: Iterable[DXFEntity]) -> str:
        names = sorted({_decoded(entity.dxf.layer) for entity in entities if entity.dxftype() in READ})
        return listed([quoted(name) for name in names], "and") if names else ""

    on_layer = "" if layer is None else f" on layer {quoted(layer)}"
    if held := layers_of(shown):
        why = f"layers with such parts are {held}"
    elif off := layers_of(every):
        why = f"layers with such parts are off, frozen or not plotted: {off}; switch them on in the drawing"
    elif any(entity.dxftype() in READ for page in document.layouts if page.is_any_paperspace for entity in page):
        why = "such parts are in its paper space only; draw in the model space"
    else:
        kinds = sorted({entity.dxftype() for entity in every})
        why = f"it has {listed(kinds, 'and')} only; explode them in the drawing" if kinds else "it has none"
    return f"holds no {listed(READ)}{on_layer}; {why}"


def _curves(entity: DXFEntity) -> Iterator[BSpline | Array]:
    """The entity as rational B-splines and chains of chords (shape (n, 3)), one after the other; some may have no
    length."""
    from ezdxf import entities as kinds
    from ezdxf.math import ConstructionEllipse, Vec3, rational_bspline_from_ellipse

    if isinstance(entity, kinds.Polyline) and not entity.is_2d_polyline:
        for part in entity.virtual_entities():
            yield from _curves(part)
    elif isinstance(entity, kinds.LWPolyline | kinds.Polyline):
        line, rows = entity if isinstance(entity, kinds.LWPolyline) else _light(entity), _rows(entity)
        # Doubled vertices have no length, and flat arcs are lines.
        rows = rows[np.append(np.any(np.diff(rows[:, :2], axis=0) != 0.0, axis=1), True)] if len(rows) else rows
        rows[:, 4] = np.where(np.abs(rows[:, 4]) < FLAT, 0.0, rows[:, 4])
        if np.any(rows[:, 4]):
            line = line.copy()
            line.lwpoints.set(rows)
            for part in line.virtual_entities():
                yield from _curves(part)
        elif len(rows) > 1:
            # A traced outline may have many chords: one chain has them all.
            points = np.column_stack([rows[:, :2], np.full(len(rows), line.dxf.elevation)])
            if (ocs := line.ocs()).transform:
                points = np.array([tuple(point) for point in ocs.points_to_wcs(Vec3.generate(points))])
            yield np.concatenate([points, points[:1]]) if line.closed else points
    elif isinstance(entity, kinds.Line):
        yield np.array([tuple(entity.dxf.start), tuple(entity.dxf.end)])
    elif isinstance(entity, kinds.Spline):
        yield _through_fit_points(entity) if not entity.control_points and entity.closed else entity.construction_tool()
    elif isinstance(entity, kinds.Ellipse):
        whole = entity.construction_tool()
        if abs(whole.param_span - tau) < FULL or whole.param_span < FULL:
            whole.start_param, whole.end_param = 0.0, tau
        yield rational_bspline_from_ellipse(whole)
    elif isinstance(entity, kinds.Circle) and abs(entity.dxf.radius) > POINT:
        start, end = (entity.dxf.start_angle, entity.dxf.end_angle) if isinstance(entity, kinds.Arc) else (0.0, 360.0)
        around = ConstructionEllipse.from_arc(
            Vec3(entity.dxf.center), entity.dxf.radius, Vec3(entity.dxf.extrusion), start, end
        )
        yield rational_bspline_from_ellipse(around)


def _rows(entity: LWPolyline | Polyline) -> Array:
    """x, y, both widths and bulge of the vertices, shape (n, 5), without control points of a smoothed polyline."""
    from ezdxf.entities import LWPolyline

    if isinstance(entity, LWPolyline):
        return np.array(entity.lwpoints.values).reshape(-1, 5)
    kept = (vertex.dxf for vertex in entity.vertices if not vertex.dxf.flags & SPLINE_FRAME)
    return np.array([(*vertex.location.vec2, 0.0, 0.0, vertex.get("bulge", 0.0)) for vertex in kept]).reshape(-1, 5)


def _through_fit_points(entity: Spline) -> BSpline:
    """The closed cubic spline through fit points without stored control points: smooth at its end, too."""
    from ezdxf.math import BSpline
    from scipy.interpolate import make_interp_spline

    points = np.array([tuple(point) for point in entity.fit_points])
    # A doubled point, as the first one at the end, counts once.
    after = np.roll(points, -1, axis=0)
    points = points[np.linalg.norm(after - points, axis=1) > POINT * np.ptp(points)]
    points = np.vstack([points, points[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    spline = make_interp_spline(along, points, k=3, bc_type="periodic")
    return BSpline(spline.c.tolist(), order=4, knots=spline.t.tolist())


def _values(curve: BSpline | Array, entity: DXFEntity, file: Path) -> dict[str, Any]:
    """The curve as the keys of a part; refuses a curve that leaves the plane."""
    points = curve if isinstance(curve, np.ndarray) else np.array([tuple(point) for point in curve.control_points])
    size = np.max(np.abs(points))
    if not isfinite(size):
        raise WrongInput("holds a coordinate that is no finite number", location=str(file))
    if np.ptp(points[:, 2]) > 1e-6 * size:
        raise WrongInput(
            "holds a part that leaves the plane of the drawing; a flat contour is needed", location=str(file)
        )
    x, y, _ = points.T.tolist()
    part = {"layer": _decoded(entity.dxf.layer), "degree": 1, "x": x, "y": y}
    if isinstance(curve, np.ndarray):
        return part
    weights = [float(weight) for weight in curve.weights()]
    # Some programs write -1 for the weights of a spline without weights.
    weights = weights if any(weight > 0.0 for weight in weights) else [1.0] * len(x)
    return {**part, "degree": curve.degree, "knots": [float(knot) for knot in curve.knots()], "weights": weights}


def chords_of(x: list[float], y: list[float]) -> dict[str, Any]:
    """The keys of a part that is a chain of chords through points."""
    count = len(x)
    knots = [0.0, *map(float, range(count)), count - 1.0]
    return {"degree": 1, "knots": knots, "x": x, "y": y, "weights": [1.0] * count}


def chords_joined(parts: Iterable[dict[str, Any]], file: Path) -> list[dict[str, Any]]:
    """The parts in order; each run of lines that follow each other becomes one chain of chords.

    Lines need no knots and weights.  Parts that are drawn twice come last, by themselves.  Raises WrongInput for too
    many parts.
    """
    found, left = list[dict[str, Any]](), list(parts)
    while left:
        seen, doubled, begun = set[tuple[object, ...]](), list[dict[str, Any]](), len(found)
        for part in left:
            if (drawn := _drawn(part)) in seen:
                doubled.append(part)
                continue
            seen.add(drawn)
            last = found[-1] if len(found) > begun else {}
            joins = part["degree"] == last.get("degree") == 1 and part["layer"] == last["layer"]
            if joins and (part["x"][0], part["y"][0]) == (last["x"][-1], last["y"][-1]):
                last["x"] += part["x"][1:]
                last["y"] += part["y"][1:]
            else:
                found.append(part)
        left = doubled
    if len(found) > MOST_CURVES:
        problem = (
            f"holds {len(found)} lines, arcs and curves; at most {MOST_CURVES} are right: join lines to a polyline"
        )
        raise WrongInput(f"{problem}, or simplify the curve", location=str(file))
    return [{**curve, **chords_of(curve["x"], curve["y"])} if curve["degree"] == 1 else curve for curve in found]


def _drawn(part: dict[str, Any]) -> tuple[object, ...]:
    """What two parts have in common that are the same curve, in either sense."""
    points = list(zip(part["x"], part["y"], strict=True))
    return (part["degree"], *min(points, points[::-1]), *part.get("weights", ()))


END_STEPS = 3.0
"""Number of steps of a drawing's numbers by which two ends may miss each other: half a step in x and y of both, and as
much in the centre and the radius of an arc, are 2.9."""


def _near(entities: Iterable[DXFEntity]) -> float:
    """Largest gap between ends that comes from the rounding of the drawing's numbers, in the drawing's unit."""
    lengths, angles, turned, radius = [np.zeros(0)], list[float](), list[float](), 0.0
    for entity in entities:
        found = entity.dxfattribs()
        lengths += [np.array(found[key].vec2) for key in ("start", "end", "center", "major_axis") if key in found]
        angles += [found[key] for key in ("start_angle", "end_angle") if key in found]
        turned += [found[key] for key in ("start_param", "end_param") if key in found]
        radius = max(radius, found["major_axis"].magnitude if "major_axis" in found else 0.0)
        if "radius" in found:
            lengths.append(np.array([found["radius"]]))
            radius = max(radius, found["radius"])
        lengths.append(_vertices(entity).ravel())
    return END_STEPS * _step(np.concatenate(lengths)) + radius * (radians(_step(angles)) + _step(turned))


def _vertices(entity: DXFEntity) -> Array:
    from ezdxf import entities as kinds

    if isinstance(entity, kinds.LWPolyline | kinds.Polyline):
        return _rows(entity)[:, :2]
    return np.array(entity.control_points).reshape(-1, 3)[:, :2] if isinstance(entity, kinds.Spline) else np.zeros(0)


MOST_SEEN = 2000
"""Number of the largest numbers of a drawing that show its digits."""


def _step(values: ArrayLike) -> float:
    """The step of rounded numbers, by the digits of the large ones: six digits or three decimals are a step of 0.001
    for numbers over 100.

    Numbers of one power of ten share the least step among them; the coarser step of the two highest powers counts.
    """
    sizes = np.unique(np.abs(np.array(values, dtype=float)))
    sizes = sizes[np.isfinite(sizes) & (sizes > 0.0)][-MOST_SEEN:]
    largest, finest = max(sizes, default=0.0), dict[int, float]()
    for value in sizes.tolist():
        if value >= largest / 10.0:
            exponent = Decimal(repr(value)).normalize().as_tuple().exponent
            power = floor(log10(value))
            assert isinstance(exponent, int)
            finest[power] = min(10.0**exponent, finest.get(power, np.inf))
    return max(finest.values(), default=0.0)
