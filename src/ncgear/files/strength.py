"""The strength of a pair of gears as files: figures, a table with a row per tooth, pictures.

Pictures show both gears in mesh, each tooth with its number, coloured by its safety or by its stress.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Colormap, LinearSegmentedColormap, LogNorm, Normalize
from matplotlib.figure import Figure

from ncgear.drawings.assembled import Assembled, AssembledPosition
from ncgear.drawings.charts.chart import joints_up_to
from ncgear.drawings.charts.drawer import STRENGTH_COLUMN, STRENGTH_LOOK, column_png
from ncgear.drawings.charts.teeth_charts import speed_charts, strength_charts
from ncgear.drawings.palette import HOLDING, STRESS
from ncgear.drawings.pictures import assembled_teeth, positions_at, titled
from ncgear.drawings.plots import canvas
from ncgear.drawings.plots.assembled_pair import draw_body
from ncgear.figures.flanks import film_csv, speeds_csv
from ncgear.figures.numbers import json_text, to_digits
from ncgear.figures.strong import strength_csv
from ncgear.files.build import folder_of
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray, largest_rows
from ncgear.numerics.plane import as_points, signed_area
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Rating
from ncgear.project.vibration import speed_sweep
from ncgear.strength.holding import lives_of, worst
from ncgear.teeth.gear import ToothedGear

if TYPE_CHECKING:
    from ncgear.strength.elements.teeth import Painted

SPREAD = 4.0
"""The scale of colours goes from the wanted safety divided by this factor to the wanted safety times this factor."""

ROOM_IN = 0.2
"""Where teeth stand less than so many inches apart, only every fifth tooth and the named tooth have numbers."""

BELOW_IN = 0.13
"""Distance in inches of a number from the root of its tooth."""

HOLDING_SCALE = LinearSegmentedColormap.from_list("holding", HOLDING)
STRESS_SCALE = LinearSegmentedColormap.from_list("stress", STRESS)

SIZE_IN, REST_IN = (9.6, 7.0), 1.55
"""Width and greatest height of the picture, and the height of its heading and scale."""


@dataclass(frozen=True, eq=False)
class ColouredGear:
    """The safety of each tooth of a gear divided by the wanted safety, shape (z,), and the named tooth.

    It is infinite for a tooth without load.
    """

    share: Array
    named: int


def coloured_teeth_png(drive: Drive, gears: dict[Gear, ColouredGear], position: AssembledPosition, title: str) -> bytes:
    """PNG of both gears in a position, each tooth coloured by its safety; the named teeth have a mark."""
    view = PairPicture.of(drive, title)
    norm = LogNorm(1.0 / SPREAD, SPREAD)
    for gear, coloured in gears.items():
        _draw(view, drive.teeth.of(gear), gear, position, coloured, norm)
    bar = view.with_scale(
        norm, HOLDING_SCALE, "least safety of a tooth, as a share of the wanted one (under 1: too weak)"
    )
    ticks = [1.0 / SPREAD, 0.5, 1.0, 2.0, SPREAD]
    bar.set_ticks(ticks, labels=[f"{tick:g}" for tick in ticks])
    bar.minorticks_off()
    return canvas.png(view.made)


def stress_field_png(
    drive: Drive, fields: Mapping[Gear, Painted], largest_mpa: float, position: AssembledPosition, title: str
) -> bytes:
    """Both gears in a position, coloured by von Mises' stress up to ``largest_mpa``."""
    view, norm = PairPicture.of(drive, title), Normalize(0.0, largest_mpa)
    for gear, field in fields.items():
        placed = view.body(drive.teeth.of(gear), gear, position, 0.3)
        colors = STRESS_SCALE(norm(field.von_mises_mpa[field.triangles].mean(axis=1)))
        triangles = list(placed(as_points(field.place_mm))[field.triangles])
        # Edges of their own colour, since gaps between triangles would shine through.
        view.axes.add_collection(
            PolyCollection(triangles, facecolors=colors, edgecolors=colors, linewidths=0.2), autolim=False
        )
    view.with_scale(norm, STRESS_SCALE, "von Mises' stress in MPa, each tooth alone at its worst place of contact")
    return canvas.png(view.made)


@dataclass(frozen=True, eq=False)
class PairPicture:
    """A picture of both gears that fills its width, unless that makes it higher than a screen."""

    made: Figure
    axes: Axes
    pair: Assembled
    height_in: float
    mm_per_in: float

    @classmethod
    def of(cls, drive: Drive, title: str) -> PairPicture:
        """The empty picture, with the axes of both gears."""
        pair = assembled_teeth(drive)
        left, right, top = pair.frame
        width, most = SIZE_IN
        height = min(most, REST_IN + width * 2.0 * top / (right - left))
        made = canvas.figure(width, height, title)
        axes = made.add_axes((0.0, 1.05 / height, 1.0, 1.0 - REST_IN / height))
        axes.plot([0.0, pair.center_distance_mm], [0.0, 0.0], "+", color=canvas.INK, markersize=9, zorder=5.0)
        canvas.look_at(axes, (left, -top, right - left, 2.0 * top))
        return cls(made, axes, pair, height, max((right - left) / width, 2.0 * top / (height - REST_IN)))

    def body(
        self, gear: ToothedGear, which: Gear, position: AssembledPosition, line: float
    ) -> Callable[[Array], Array]:
        """Draw a gear's body; return the function that moves points of the gear's frame (shape (n, 2)) to their
        place."""
        placed = partial(self.pair.placed, which, position=position)
        draw_body(self.axes, self.pair, which, placed(gear.outline_mm), canvas.REFERENCE, line)
        return placed

    def with_scale(self, norm: Normalize, scale: Colormap, label: str) -> Colorbar:
        """The scale of colours below the gears."""
        box, ends = (0.2, 0.62 / self.height_in, 0.6, 0.16 / self.height_in), isinstance(norm, LogNorm)
        return canvas.color_bar(self.made, norm, scale, box, label, extend="both" if ends else "max")


def _draw(
    view: PairPicture,
    gear: ToothedGear,
    which: Gear,
    position: AssembledPosition,
    coloured: ColouredGear,
    norm: LogNorm,
) -> None:
    """One gear in its place: its body, its teeth in their colours, their numbers below the roots."""
    placed = view.body(gear, which, position, 0.5)
    teeth = [placed(gear.outline_mm[rows]) for rows in tooth_rows(gear)]
    colors = HOLDING_SCALE(norm(np.clip(coloured.share, 1.0 / SPREAD, SPREAD)))
    view.axes.add_collection(
        PolyCollection(teeth, facecolors=colors, edgecolors=canvas.INK, linewidths=0.4), autolim=False
    )
    crowded = gear.flanks.curve.length_mm / len(teeth) < ROOM_IN * view.mm_per_in
    for number, tooth in enumerate(teeth, 1):
        named = number == coloured.named
        if not crowded or number % 5 == 0 or named:
            root, (back, down) = (tooth[0] + tooth[-1]) / 2.0, tooth[0] - tooth[-1]
            # This chord closes the tooth.  The tooth lies to its left where the outline runs counter-clockwise.
            inwards = np.sign(signed_area(tooth)) * np.array([down, -back]) / np.hypot(back, down)
            place = root + BELOW_IN * view.mm_per_in * inwards
            box = {"boxstyle": "circle,pad=0.15", "facecolor": "white", "edgecolor": canvas.INK, "linewidth": 1.0}
            style: canvas.Style = {"weight": "bold", "bbox": box} if named else {}
            canvas.number(view.axes, place, str(number), zorder=4.0, **style)


NEAR_MODULES = 3.0
"""Largest distance from the pitch curve, in modules, at which the roots of teeth are searched."""


def tooth_rows(gear: ToothedGear) -> list[IndexArray]:
    """The rows of the outline that belong to each tooth, from the middle of one space to the middle of the next.

    The middle of a space is halfway along the pitch curve between its two flanks.  Gears that turn less than once have
    teeth on a part of their curve only.
    """
    flanks, outline = gear.flanks, gear.outline_mm
    back, front = flanks.crossing_mm[0::2], flanks.crossing_mm[1::2]
    before = (back + np.roll(front, 1)) / 2.0
    before[0] = (back[0] + front[-1] - flanks.curve.length_mm) / 2.0
    middles = flanks.curve.at_length(before[: gear.teeth + 1]).position @ np.array([1.0, 1.0j])
    points = outline @ np.array([1.0, 1.0j])
    off = np.abs(np.angle(points[None, :] / middles[:, None]))
    if gear.teeth < back.size:
        # The heel may lie at the same angle.
        off[np.abs(points[None, :] - middles[:, None]) > NEAR_MODULES * flanks.rack.module_mm] = np.inf
    rows = np.argmin(off, axis=1)
    ends = np.roll(rows, -1)
    # Arc length grows against the outline's sense on one of the two gears.
    along = np.sum(np.angle(np.roll(middles, -1) / middles)) > 0.0
    pairs = list(zip(rows, ends, strict=True) if along else zip(ends, rows, strict=True))[: gear.teeth]
    return [(start + np.arange((end - start) % len(outline) + 1)) % len(outline) for start, end in pairs]


def strength_pictures(drive: Drive, rating: Rating) -> dict[str, bytes]:
    """The gears coloured by the safety of each tooth, and loads and stresses over the cycle."""
    charts = strength_charts(rating.strength, rating.weakest)
    joints = np.degrees(joints_up_to(drive.pair.transmission, np.radians(charts[0].end)))
    charts = [replace(chart, joints_deg=joints) for chart in charts]
    pictures = {
        "strength.png": _gears(drive, rating),
        "strength-cycle.png": column_png(charts, _titled(drive, "loads of the teeth"), STRENGTH_LOOK, STRENGTH_COLUMN),
    }
    if (sweep := speed_sweep(drive, drive.vibration, rating.loading)) is not None:
        what = _titled(drive, "dynamic load over the driving speed")
        pictures["strength-speeds.png"] = column_png(speed_charts(sweep), what, STRENGTH_LOOK, STRENGTH_COLUMN)
    return pictures if rating.strength.method == "estimate" else {**pictures, "strength-stress.png": _field(drive)}


def _field(drive: Drive) -> bytes:
    """The stress by finite elements, each tooth at the place of contact with its largest root stress."""
    from ncgear.strength.elements.teeth import Elements

    judged = drive.judged_teeth("elements")
    contacts, roots = judged.strength.contacts, judged.strength.stresses.tension_mpa
    fields = {}
    for place, (gear, method) in enumerate(zip(Gear, (method.each[0] for method in judged.methods), strict=True)):
        assert isinstance(method, Elements)
        places = contacts.on(gear)
        worst_of_tooth = largest_rows(roots[place], places.tooth - 1, drive.teeth.of(gear).teeth)
        rows = worst_of_tooth[worst_of_tooth >= 0]
        chosen = places.kept(rows)
        load_n_mm = roots[place, rows] / method.root_stress(chosen).tension_mpa
        fields[gear] = method.painted(chosen, load_n_mm)
    row = int(np.argmax(roots.max(axis=0)))
    (position,) = positions_at(drive, contacts.phi1_rad[[row]])
    return stress_field_png(drive, fields, float(roots.max()), position, _titled(drive, "stress in the teeth"))


def _gears(drive: Drive, rating: Rating) -> bytes:
    """The pair at the driving angle of the largest stress of its weakest tooth."""
    strength, found = rating.strength, rating.weakest
    wanted = {(weakest.gear, weakest.damage): weakest.wanted for weakest in found}
    gears = {}
    for gear in Gear:
        shares = [life.safety / wanted[gear, damage] for damage, life in lives_of(strength, gear).items()]
        gears[gear] = ColouredGear(
            np.min(shares, axis=0), worst([weakest for weakest in found if weakest.gear is gear]).tooth
        )
    weakest = worst(found)
    (position,) = positions_at(drive, np.array([weakest.phi1_rad]))
    least, tooth = to_digits(weakest.safety, 3), f"tooth {weakest.tooth} of the {weakest.gear.value} gear"
    what = f"least safety {least} against {weakest.damage.words}, {tooth},"
    return coloured_teeth_png(drive, gears, position, _titled(drive, what))


def _titled(drive: Drive, what: str) -> str:
    return titled(drive, what if drive.stage is None else f"stage {drive.stage}, {what}")


def strength_files(drive: Drive, rating: Rating, figures: Mapping[str, Any]) -> dict[str, bytes]:
    """Pictures and table of a rating, and its figures, as files by name; of a stage, in a folder of its own."""
    film = drive.surfaces_by(rating.strength.method).film
    files = {
        **strength_pictures(drive, rating),
        "strength.csv": strength_csv(rating.strength, film).encode(),
        "strength.json": json_text(figures).encode(),
    }
    if film is not None:
        files["strength-film.csv"] = film_csv(film).encode()
    if (sweep := speed_sweep(drive, drive.vibration, rating.loading)) is not None:
        files["strength-speeds.csv"] = speeds_csv(sweep).encode()
    return {folder_of(drive.stage) + name: content for name, content in files.items()}
