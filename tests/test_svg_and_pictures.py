"""Contours of SVG files and of pictures against the same curves by their own keys."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from PIL import Image, ImageDraw

from drives import drive_of_text
from ncgear.errors import WrongInput
from ncgear.figures.advice.machine_advice import drawing
from ncgear.project.drive import Drive
from ncgear.project.opened import load

pytest.importorskip("svgelements")

TEXT = """\
name: drawn
linkage: {crank_mm: 30, rod_mm: 120}
operation: {speed_rpm: 60}
motion: {law: pitch_curve, SHAPE}
gears: {teeth: 32, face_width_mm: 8}
"""

ELLIPSE = "ellipse: {semi_major_mm: 30, semi_minor_mm: 24, axis_x_mm: -3, axis_y_mm: 1}"

ARCS = '<path id="p" d="M 60 0 A 60 48 0 0 1 -60 0 A 60 48 0 0 1 60 0 Z"/>'
KAPPA = 0.5522847498
CUBICS = (
    f'<path id="p" d="M60,0 C60,{48 * KAPPA} {60 * KAPPA},48 0,48 S -60,{48 * KAPPA} -60,0 '
    f'S {-60 * KAPPA},-48 0,-48 S 60,{-48 * KAPPA} 60,0 z"/>'
)


def page(inner: str, size: str = 'width="100mm" height="80mm" viewBox="0 0 200 160"') -> str:
    """The ellipse about (103, -1) in units of half a millimetre from the middle, y down: its axis is at (50, 40) mm."""
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}><g transform="translate(106,82)">{inner}</g></svg>'


def from_svg(folder: Path, content: str, more: str = "") -> Drive:
    (folder / "c.svg").write_text(content, encoding="utf-8")
    (folder / "d.yaml").write_text(
        TEXT.replace("SHAPE", f"svg: {{file: c.svg, axis_x_mm: 50, axis_y_mm: 40{more}}}"), encoding="utf-8"
    )
    return load(folder / "d.yaml")


@cache
def given() -> Drive:
    """The ellipse by its key."""
    return drive_of_text(TEXT.replace("SHAPE", ELLIPSE))


@cache
def alone_mm() -> float | None:
    """The centre distance of the ellipse with nothing beside it."""
    with TemporaryDirectory() as folder:
        return from_svg(Path(folder), page(ARCS)).law.center_distance_mm


def from_picture(folder: Path, image: Image.Image, name: str = "c.png", more: str = "tolerance_mm: 0.12") -> Drive:
    image.save(folder / name)
    shape = f"picture: {{file: {name}, width_mm: 60, {more}}}"
    (folder / "d.yaml").write_text(TEXT.replace("SHAPE", shape), encoding="utf-8")
    return load(folder / "d.yaml")


@pytest.mark.parametrize(
    "inner",
    [
        ARCS,
        '<ellipse id="p" rx="60" ry="48"/>',
        '<circle id="p" r="48" transform="scale(1.25,1)"/>',
        '<g transform="rotate(90)"><ellipse id="p" rx="48" ry="60"/></g>',
        '<defs><circle id="hole" r="5"/></defs><text x="1" y="2">a gear</text>' + ARCS,
    ],
    ids=["arcs", "ellipse", "scaled circle", "turned", "beside text"],
)
def test_a_drawn_ellipse_is_the_ellipse_of_its_key(tmp_path: Path, inner: str) -> None:
    drawn, exact = from_svg(tmp_path, page(inner)), given()
    assert drawn.law.center_distance_mm == pytest.approx(exact.law.center_distance_mm, rel=1e-9)
    phi1 = np.linspace(0.0, 6.2, 40)
    expected = exact.transmission.driven_angle(phi1, 2).coefficients
    assert drawn.transmission.driven_angle(phi1, 2).coefficients == pytest.approx(expected, abs=1e-7)


def test_curves_and_pixels_are_read_as_they_are_written(tmp_path: Path) -> None:
    """Four cubics are within 3e-4 of a circle's radius; a page in pixels has 96 of them in an inch."""
    expected = drive_of_text(TEXT.replace("SHAPE", ELLIPSE)).law.center_distance_mm
    assert from_svg(tmp_path, page(CUBICS)).law.center_distance_mm == pytest.approx(expected, rel=3e-4)
    px = 96.0 / 25.4
    pixels = f'width="{100 * px}" height="{80 * px}" viewBox="0 0 200 160"'
    for size in (pixels, 'width="10cm" height="8cm" viewBox="0 0 200 160"'):
        assert from_svg(tmp_path, page(ARCS, size)).law.center_distance_mm == pytest.approx(expected, rel=1e-9)


def test_an_element_is_picked_and_what_is_missing_is_named(tmp_path: Path) -> None:
    two = page(ARCS + '<circle id="hole" r="5"/>')
    with pytest.raises(WrongInput, match="layers that hold one closed contour are hole and p"):
        from_svg(tmp_path, two).law  # noqa: B018
    assert from_svg(tmp_path, two, ", element: p").law.center_distance_mm
    with pytest.raises(WrongInput, match="holds no curve of the element 'q'; elements with curves are 'hole' and 'p'"):
        from_svg(tmp_path, two, ", element: q")
    with pytest.raises(WrongInput, match="ends in the middle; the whole file is right"):
        from_svg(tmp_path, "<svg><path")
    with pytest.raises(WrongInput, match="is no SVG file that can be read"):
        from_svg(tmp_path, "<svg></path>")
    with pytest.raises(WrongInput, match="holds no curve"):
        from_svg(tmp_path, page("<text>nothing</text>"))


@pytest.mark.parametrize(
    "beside",
    [
        '<circle visibility="hidden" r="5"/>',
        '<style>.no, .other {display: none}</style><circle class="no" r="5"/>',
        '<symbol id="s"><circle r="5"/></symbol>',
        '<mask id="m"><circle r="5"/></mask>',
        '<defs><marker id="m"><path d="M 0 0 L 5 5"/></marker></defs>',
    ],
    ids=["hidden", "style", "symbol", "mask", "marker"],
)
def test_what_is_not_drawn_is_no_part_of_the_contour(tmp_path: Path, beside: str) -> None:
    """By the specification of SVG 1.1: symbols, masks and markers are drawn only where an element refers to them."""
    assert from_svg(tmp_path, page(beside + ARCS)).law.center_distance_mm == alone_mm()


def test_a_symbol_is_drawn_where_it_is_used(tmp_path: Path) -> None:
    used = '<symbol id="s">' + ARCS + '</symbol><use href="#s"/>'
    assert from_svg(tmp_path, page(used)).law.center_distance_mm == alone_mm()


def test_a_layer_is_picked_by_its_id_and_by_its_name(tmp_path: Path) -> None:
    space = 'xmlns:i="http://www.inkscape.org/namespaces/inkscape"'
    layers = page(f'<g id="layer1" {space} i:label="Rim">{ARCS}</g><g id="layer2"><circle r="5"/></g>')
    alone = from_svg(tmp_path, page(ARCS)).law.center_distance_mm
    for name in ("layer1", "Rim", "p"):
        assert from_svg(tmp_path, layers, f", element: {name}").law.center_distance_mm == alone
    with pytest.raises(WrongInput, match="elements with curves are 'layer2' and 'p'"):
        from_svg(tmp_path, layers, ", element: layer3")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("<html><svg/></html>", "is no SVG file: its first element is 'html'"),
        (page("<text>nothing</text>"), "holds no curve; text has to become paths in the drawing"),
        (page('<image href="a.png"/>'), "holds no curve; a picture in it is no curve"),
        (
            page('<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>'),
            "is no SVG file that can be read: 'elements use each other without end'",
        ),
        (page('<path d="M -9 0 H 0 V 9 Z M 9 0 H 20 V 9 Z"/>'), "3 further parts|1 further part"),
        (page('<circle r="1e308"/><circle r="1"/>'), "holds a coordinate that is no finite number"),
        (page('<circle r="9"/><circle r="1"/>'), "one closed contour is needed: name its layer or element, or remove"),
    ],
    ids=["page of the web", "text", "picture", "circle of references", "side by side", "infinite", "two contours"],
)
def test_a_file_without_one_contour_is_refused_with_the_reason(tmp_path: Path, content: str, said: str) -> None:
    with pytest.raises(WrongInput, match=said):
        from_svg(tmp_path, content).law  # noqa: B018


def test_a_letter_with_holes_is_its_outer_contour_and_says_so(tmp_path: Path) -> None:
    """Holes before and after the contour in one path; the dot of another element counts as before."""
    alone = from_svg(tmp_path, page(ARCS))
    hole = "M {} 0 A 5 5 0 1 0 {} 0 A 5 5 0 1 0 {} 0 Z"
    path = ARCS.replace(' d="', ' d="' + hole.format(-15, -5, -15)).replace('"/>', hole.format(5, 15, 5) + '"/>')
    found = from_svg(tmp_path, page(path))
    assert found.law.center_distance_mm == alone.law.center_distance_mm
    assert [one.what for one in drawing(found)] == ["the contour encloses 2 more of its element: they are left out"]
    assert not list(drawing(alone))


@pytest.mark.parametrize("size", ["", ' width="30" height="20"', ' width="50%" height="50%"'])
def test_a_page_in_the_page_moves_what_it_holds(tmp_path: Path, size: str) -> None:
    """By the specification of SVG 1.1, section 5.1.2: without viewBox a page moves its content by x and y."""
    alone = from_svg(tmp_path, page(ARCS)).law.center_distance_mm
    inner = f'<svg x="-7" y="4"{size}><g transform="translate(7,-4)">{ARCS}</g></svg>'
    assert from_svg(tmp_path, page(inner)).law.center_distance_mm == pytest.approx(alone, rel=1e-12)


def silhouette(pixels: int = 400, ink: int = 0, paper: int = 255) -> Image.Image:
    """An ellipse of 30 by 24 mm on 60 mm."""
    image = Image.new("L", (pixels, pixels), paper)
    unit = pixels / 400.0
    ImageDraw.Draw(image).ellipse([round(unit * at) for at in (50, 80, 350, 320)], fill=ink)
    return image


def test_the_outline_of_a_picture_is_the_ellipse_to_a_share_of_a_pixel(tmp_path: Path) -> None:
    expected = drive_of_text(TEXT.replace("SHAPE", "ellipse: {semi_major_mm: 30, semi_minor_mm: 24}")).law
    for name in ("c.png", "c.jpg"):
        found = from_picture(tmp_path, silhouette(), name).law
        assert found.center_distance_mm == pytest.approx(expected.center_distance_mm, abs=0.03)
    light = from_picture(tmp_path, silhouette(400, 255, 0), more="tolerance_mm: 0.12, light: true").law
    assert light.center_distance_mm == pytest.approx(expected.center_distance_mm, abs=0.03)
    clear = Image.new("RGBA", (400, 400), (0, 0, 0, 0))
    clear.paste((10, 20, 30, 255), mask=silhouette(400, 255, 0))
    assert from_picture(tmp_path, clear).law.center_distance_mm == pytest.approx(expected.center_distance_mm, abs=0.03)


def test_a_picture_without_a_silhouette_is_refused(tmp_path: Path) -> None:
    cut = silhouette().crop((100, 0, 400, 400))
    with pytest.raises(WrongInput, match="reaches the edge of the picture; leave room around it, or give light: true"):
        from_picture(tmp_path, cut)
    with pytest.raises(WrongInput, match=r"has no outline at a threshold of 0\.5"):
        from_picture(tmp_path, Image.new("L", (100, 100), 255))
    dust = Image.new("L", (400, 400), 255)
    ImageDraw.Draw(dust).ellipse((100, 100, 105, 105), fill=0)
    with pytest.raises(WrongInput, match="has no silhouette: its largest patch has"):
        from_picture(tmp_path, dust)
    silhouette().save(tmp_path / "c.png")
    (tmp_path / "c.png").write_bytes(b"\x89PNG" + bytes(40))
    with pytest.raises(WrongInput, match="is no picture that can be read"):
        load(tmp_path / "d.yaml")
