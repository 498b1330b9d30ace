"""SVG files and pictures that a design file names for the contour of a pitch curve, as rational B-splines.

Curves of SVG are Bezier curves and elliptical arcs, which rational B-splines represent exactly; the outline of a
picture is a chain of chords, which a smooth curve follows later.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from io import BytesIO
from itertools import groupby, pairwise
from math import ceil, cos, pi, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np

from ncgear.design.reading.contour_file import chords_joined, chords_of
from ncgear.design.reading.long_chains import svg_chain, svg_points
from ncgear.design.reading.places import FromFile
from ncgear.design.reading.text import quoted, read_bytes
from ncgear.design.words import listed
from ncgear.errors import WrongInput
from ncgear.extras import require
from ncgear.numerics.arrays import Array

if TYPE_CHECKING:
    from svgelements import SVG, Arc, PathSegment, Point, Shape

LARGEST_MB = 20

PX_PER_INCH = 96.0
MM_PER_PX = 25.4 / PX_PER_INCH
"""Unit of CSS and SVG for numbers without a unit; the library converts numbers with a unit."""

LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
"""The name of a layer, as its program shows it."""

NAME, WANTED, CHAIN = "ncgear-name", "ncgear-wanted", "ncgear-chain"
"""Attributes for the name of an element, for the wanted one, and for the number of a long chain of chords."""

UNREADABLE = (ValueError, ArithmeticError, TypeError, LookupError, AttributeError, SyntaxError, RecursionError)
"""Errors of the libraries for files that they cannot read."""

CUT_OFF = 3, 5, 6, 20
"""Codes of expat for files that end before the first element, a token, a character or a section ends."""

SHORT = {"d": "M0,0 1,0", "points": "0,0 1,0"}
"""What stands in place of a long chain of chords."""

REFERRED = ("symbol", "mask", "marker")
HIDDEN = ("hidden", "collapse")
NO_CURVES = {
    "text": "text has to become paths in the drawing",
    "image": "a picture in it is no curve: give its file under picture",
}
"""What stands in a drawing without curves."""

SAME = 1e-6
"""Share of an element's size within which one of its curves begins where another ends."""

PER_CURVE = 16
"""Chords of a curve that show whether a contour encloses another one."""

SMALLEST_SHARE = 0.01
"""Share of a picture's pixels; a smaller patch counts as dust beside the silhouette."""

MOST_PIXELS = 25_000_000


def svg_contour_of(file: Path, given: Mapping[str, Any]) -> FromFile:
    """The curves of the ``given`` element, or of all elements; raises WrongInput if there is none.

    x runs to the right and y up from the lower left corner of the page, in mm.
    """
    require("svgelements", "svg", str(file))
    from svgelements import SVG, Shape

    content, wanted = read_bytes(file, limit_mb=LARGEST_MB), given.get("element")
    try:
        tree = ElementTree.fromstring(content)
        if _kind(tree) != "svg":
            raise WrongInput(f"is no SVG file: its first element is {quoted(_kind(tree))}", location=str(file))
        text, chains = _marked(tree, wanted)
        document = SVG.parse(BytesIO(text), reify=False, ppi=PX_PER_INCH)
        drawn = [element for element in document.elements() if isinstance(element, Shape)]
        shapes = [element for element in drawn if element.values.get("visibility") not in HIDDEN]
        mm = MM_PER_PX * _sharpened(document)
        height_mm = mm * float(document.height)
    except UNREADABLE as error:
        said = " ".join(str(error).split())
        if getattr(error, "code", None) in CUT_OFF:
            raise WrongInput("ends in the middle; the whole file is right", location=str(file)) from error
        if isinstance(error, RecursionError):
            said = "elements use each other without end"
        raise WrongInput(f"is no SVG file that can be read: {quoted(said)}", location=str(file)) from error
    curves, holes = list[dict[str, Any]](), 0
    with np.errstate(over="ignore", invalid="ignore"):
        for shape in shapes:
            if wanted is None or WANTED in shape.values:
                outer, left_out = _without_holes(list(_parts(shape, chains, height_mm, mm, file)))
                curves, holes = [*curves, *outer], holes + left_out
    curves = chords_joined(curves, file)
    if not curves:
        names = sorted({shape.values[NAME] for shape in shapes if NAME in shape.values})
        held = f"; elements with curves are {listed([quoted(name) for name in names], 'and')}" if names else ""
        others = sorted({_kind(element) for element in tree.iter()} & set(NO_CURVES)) if not shapes else []
        held += "".join(f"; {NO_CURVES[kind]}" for kind in others)
        of = "" if wanted is None else f" of the element {quoted(wanted)}"
        raise WrongInput(f"holds no curve{of}{held}", location=str(file))
    return FromFile({"curves": curves, "holes": holes} if holes else {"curves": curves})


def _kind(element: ElementTree.Element) -> str:
    return element.tag.rpartition("}")[2]


def _marked(tree: ElementTree.Element, wanted: str | None) -> tuple[bytes, list[Array]]:
    """The file with the names of elements and the mark of the wanted one, which the library hands down to their parts,
    and with long chains of chords cut out, whose points have shape (n, 2) each.

    What is drawn only where another element refers to it goes to the definitions, since the library draws it.  A page
    within the page that only moves its content becomes a group, since the library does not move it.
    """
    chains = list[Array]()
    for element in list(tree.iter()):
        names = [name for key in ("id", LABEL) if (name := element.get(key))]
        element.attrib.update({NAME: names[0]} if names else {})
        element.attrib.update({WANTED: ""} if wanted in names else {})
        if (points := _long_chain(element)) is not None:
            element.set(CHAIN, str(len(chains)))
            element.attrib |= {key: text for key, text in SHORT.items() if key in element.attrib}
            chains.append(points)
        for number, part in enumerate(element):
            if _kind(part) == "svg" and part.get("viewBox") is None:
                part.tag = part.tag.removesuffix("svg") + "g"
                part.set("transform", f"translate({part.get('x', '0')},{part.get('y', '0')})")
            if _kind(part) in REFERRED:
                element[number] = ElementTree.Element("defs")
                element[number].append(part)
    return ElementTree.tostring(tree), chains


def _long_chain(element: ElementTree.Element) -> Array | None:
    """The vertices of an element that is a long chain of chords; None for another one."""
    if _kind(element) == "path":
        return svg_chain(element.get("d", ""))
    if _kind(element) not in ("polygon", "polyline") or (points := svg_points(element.get("points", ""))) is None:
        return None
    return np.concatenate([points, points[:1]]) if _kind(element) == "polygon" else points


def _parts(shape: Shape, chains: list[Array], height_mm: float, mm: float, file: Path) -> Iterator[dict[str, Any]]:
    """The parts of an element in mm (of a pixel) from the lower left corner of the page; affine maps keep weights."""
    on = shape.transform
    linear, offset = mm * np.array([[on.a, -on.b], [on.c, -on.d]]), np.array([mm * on.e, height_mm - mm * on.f])
    cut = [(chains[int(shape.values[CHAIN])], None)] if CHAIN in shape.values else None
    for points, weights in cut or _curves(shape.segments(transformed=False)):
        moved = points @ linear + offset
        # Lines along each other are one chain of chords, with each vertex once.
        kept = moved if weights is not None else moved[np.append(np.any(np.diff(moved, axis=0) != 0.0, axis=1), True)]
        if np.all(kept == kept[0]):
            continue
        if not np.all(np.isfinite(kept)):
            raise WrongInput("holds a coordinate that is no finite number", location=str(file))
        x, y = kept.T.tolist()
        part = {"layer": shape.values.get(NAME, ""), "degree": 1, "x": x, "y": y}
        knots = [0.0] * len(points) + [1.0] * len(points)
        yield part if weights is None else {**part, "degree": len(points) - 1, "knots": knots, "weights": weights}


def _without_holes(parts: list[dict[str, Any]]) -> tuple[list[dict[str, Any]], int]:
    """The parts of an element without the closed contours that its largest one encloses, and the number of these."""
    from shapely import Polygon

    if not parts:
        return parts, 0
    lines = [_along(part) for part in parts]
    near = SAME * float(np.max(np.ptp(np.concatenate(lines), axis=0)))
    starts = [i for i, line in enumerate(lines) if not i or np.max(np.abs(line[0] - lines[i - 1][-1])) > near]
    contours = list(pairwise([*starts, len(parts)]))
    closed = all(np.max(np.abs(lines[begin][0] - lines[end - 1][-1])) <= near for begin, end in contours)
    if len(contours) == 1 or not closed:
        return parts, 0
    areas = [Polygon(np.concatenate(lines[begin:end])) for begin, end in contours]
    outer = int(np.argmax([area.area for area in areas]))
    if not all(area.is_valid and areas[outer].contains(area) for area in areas):
        return parts, 0
    begin, end = contours[outer]
    return parts[begin:end], len(contours) - 1


def _along(part: dict[str, Any]) -> Array:
    """Points along a part, shape (n, 2): corners of lines, and the ends of PER_CURVE chords of a curve."""
    points = np.column_stack([part["x"], part["y"]])
    if part["degree"] == 1:
        return points
    from ncgear.numerics.rational import RationalSpline

    return RationalSpline(part["degree"], np.array(part["knots"]), points, np.array(part["weights"])).chords(PER_CURVE)


def _curves(segments: Iterable[PathSegment]) -> Iterator[tuple[Array, list[float] | None]]:
    """Control points of each curve (shape (degree + 1, 2)) and their weights; a run of lines has none."""
    from svgelements import Arc, CubicBezier, Linear, QuadraticBezier

    for kind, run in groupby(segments, type):
        if issubclass(kind, Linear):
            lines = [segment for segment in run if segment.start is not None and segment.end is not None]
            if lines:
                yield np.array([_xy(lines[0].start), *(_xy(line.end) for line in lines)]), None
            continue
        for segment in run:
            if isinstance(segment, Arc):
                yield from _arcs(segment)
            elif isinstance(segment, CubicBezier):
                yield (
                    np.array([_xy(at) for at in (segment.start, segment.control1, segment.control2, segment.end)]),
                    [1.0] * 4,
                )
            elif isinstance(segment, QuadraticBezier):
                yield np.array([_xy(at) for at in (segment.start, segment.control, segment.end)]), [1.0] * 3


def _arcs(arc: Arc) -> Iterator[tuple[Array, list[float]]]:
    """Parts of up to a quarter of an ellipse, rational curves whose middle weight is the cosine of half their angle."""
    center, along, across = (np.array(_xy(point)) for point in (arc.center, arc.prx, arc.pry))
    along, across = along - center, across - center
    start, count = float(arc.get_start_t()), max(ceil(abs(arc.sweep) / (pi / 2.0) - 1e-9), 1)
    step = float(arc.sweep) / count
    for number in range(count):
        turns = (start + step * (number + share) for share in (0.0, 0.5, 1.0))
        begin, middle, end = (center + cos(turn) * along + sin(turn) * across for turn in turns)
        weight = cos(step / 2.0)
        yield np.array([begin, center + (middle - center) / weight, end]), [1.0, weight, 1.0]


def _xy(point: Point) -> tuple[float, float]:
    return float(point.x), float(point.y)


def _sharpened(document: SVG) -> float:
    """The correction of the library's factor for mm, which has six digits."""
    sized = re.fullmatch(
        r"\s*([0-9.]+(?:e[-+]?[0-9]+)?)\s*(mm|cm)\s*", str(document.values.get("width", "")), re.IGNORECASE
    )
    if sized is None or not float(document.width) > 0.0:
        return 1.0
    return float(sized[1]) * (10.0 if sized[2].lower() == "cm" else 1.0) / MM_PER_PX / float(document.width)


def picture_contour_of(file: Path, given: Mapping[str, Any]) -> FromFile:
    """The outline of the largest dark patch of a picture, or of the largest light one, as chords of ``width_mm``.

    x runs to the right and y up from the middle of the outline's box.  Raises WrongInput if there is no outline, and if
    the silhouette reaches the edge of the picture.
    """
    from contourpy import contour_generator
    from PIL import Image, UnidentifiedImageError

    read_bytes(file, limit_mb=LARGEST_MB)
    width_mm, threshold = given.get("width_mm"), given.get("threshold", 0.5)
    if not isinstance(width_mm, int | float) or not isinstance(threshold, int | float):
        # The faults of these keys are found with all others.
        return FromFile({})
    try:
        with Image.open(file) as image:
            if image.width * image.height > MOST_PIXELS:
                raise WrongInput(
                    f"has {image.width} by {image.height} pixels; at most {MOST_PIXELS / 1e6:g} million are right",
                    location=str(file),
                )
            seen = image.convert("RGBA")
            paper = Image.new("RGBA", seen.size, "white")
            paper.alpha_composite(seen)
            light = np.asarray(paper.convert("L"), dtype=float) / 255.0
    except (UnidentifiedImageError, OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise WrongInput("is no picture that can be read; PNG or JPEG is right", location=str(file)) from error
    bright = given.get("light") is True
    ink, over = (light, threshold) if bright else (1.0 - light, 1.0 - threshold)
    if max(ink[0].max(), ink[-1].max(), ink[:, 0].max(), ink[:, -1].max()) > over:
        raise WrongInput(
            "has a silhouette that reaches the edge of the picture; leave room around it, or give light: true if it is "
            "light on dark",
            location=str(file),
        )
    lines = contour_generator(z=ink).lines(over)
    closed = [np.asarray(line) for line in lines if line is not None and len(line) > 3 and np.all(line[0] == line[-1])]
    if not closed:
        raise WrongInput(f"has no outline at a threshold of {threshold:g}; another one may have", location=str(file))
    outline = max(closed, key=_area)
    low, high = outline.min(axis=0), outline.max(axis=0)
    if _area(outline) < SMALLEST_SHARE * ink.size:
        raise WrongInput(
            f"has no silhouette: its largest patch has {100.0 * _area(outline) / ink.size:.2g} % of the picture",
            location=str(file),
        )
    points = (outline - (low + high) / 2.0) * (width_mm / float(high[0] - low[0])) * np.array([1.0, -1.0])
    return FromFile({"curves": [{**chords_of(points[:, 0].tolist(), points[:, 1].tolist()), "layer": ""}]})


def _area(outline: Array) -> float:
    x, y = outline.T
    return abs(float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))) / 2.0
