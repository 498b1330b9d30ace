"""The page docs/speed-against-error.md: words about the measured points, tables, and one picture for each study."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from importlib.metadata import version
from itertools import cycle
from textwrap import fill

from ncgear.drawings.plots.canvas import DRIVEN, DRIVING, HIGHLIGHT, INK, REFERENCE, SMALL, Margins, dress, figure, png
from speed_against_error.study import SAME_TIME, Knee, Measured, Method, Point, PointOfMethod, knee, rates

PAGE = "speed-against-error.md"
PICTURES = "speed-against-error"
"""The folder of the pictures, beside the page."""

WIDTH_IN, HEIGHT_IN = 8.2, 4.4
KEY_IN = 2.45
"""Space for the key beside the axes."""

LINE = 42
"""Letters that fit along the axis of errors."""

COLORS = (DRIVING, DRIVEN, HIGHLIGHT, "#009E73", "#E69F00", "#56B4E9", REFERENCE)
MARKERS = ("o", "s", "D", "^", "v", "P", "X")
"""Lines differ in form as well as in colour."""


def page(found: Sequence[Measured]) -> str:
    """The whole page in Markdown."""
    parts = [_head(), _overview(found), *(_section(one) for one in found)]
    return "\n\n".join(parts) + "\n"


def _head() -> str:
    versions = f"Python {platform.python_version()}, numpy {version('numpy')}, scipy {version('scipy')}"
    machine = f"{os.cpu_count()} cores, {platform.system()} {platform.machine()}, {versions}"
    return (
        "# Speed against error\n\n"
        "What each number costs by the methods it could be computed with, written by `make bench` on "
        f"{machine}. Times are the least of repeated runs in one process; errors are against references that none "
        "of the methods made. The point that ncgear works at is **bold** in the tables and has a ring in the pictures. "
        "The knee is the quickest point whose error is small enough: as small as anybody can use, or, where no method "
        "gets so far, ten times the least error of all. Adaptive methods find by themselves how fine they must be."
    )


def _overview(found: Sequence[Measured]) -> str:
    rows = []
    for one in found:
        title, point = one.study.title, one.chosen[1]
        anchor = "".join(mark for mark in title.lower().replace(" ", "-") if mark.isalnum() or mark in "-_")
        rows.append((f"[{title}](#{anchor})", named(one.chosen), time_text(point), error_text(point), verdict(one)))
    return _table(("number", "ncgear's method", "time", "error", "knee"), rows)


def _section(found: Measured) -> str:
    study = found.study
    size = (study.size.name,) if study.size else ()
    parts = (
        f"## {study.title}",
        f"Reference: {study.reference}. Errors in {study.unit}; nothing is gained below {study.enough:g}.",
        f"![{study.title}: time against error]({PICTURES}/{study.key}.png)",
        _table(("method", "level", *size, "time", "error"), [_row(found, *one) for one in found.of_all]),
        _rates_text(found),
        _choice_text(found),
    )
    return "\n\n".join(part for part in parts if part)


def _row(found: Measured, method: Method, point: Point) -> tuple[str, ...]:
    size = () if point.size is None else (f"{point.size:.0f}",)
    cells = method.name, level_text(method, point), *size, time_text(point), error_text(point)
    return tuple(f"**{cell}**" for cell in cells) if (method, point) == found.chosen else cells


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


# --- words about points ----------------------------------------------------------------------------------------------


def summary(found: Measured) -> str:
    """The chosen point of a study in one line."""
    point = found.chosen[1]
    numbers = f"{time_text(point):>8}  {error_text(point):>8}"
    return f"{found.study.key:<20}  {numbers}  {named(found.chosen)}; knee: {verdict(found)}"


def time_text(point: Point) -> str:
    """The time to three digits, in s, ms or µs."""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if point.seconds >= size:
            return f"{point.seconds / size:.3g} {unit}"
    return f"{point.seconds / 1e-6:.3g} µs"


def error_text(point: Point) -> str:
    """The error to two digits."""
    return f"{point.error:.1e}" if point.error else "0"


def level_text(method: Method, point: Point) -> str:
    """The level with its name, a dash if it has none."""
    if not method.level:
        return "-"
    counted = method.level.split()[0].endswith("s")
    return f"{point.level:g} {method.level}" if counted else f"{method.level} {point.level:g}"


def named(one: PointOfMethod) -> str:
    """The method, with its level if it has one."""
    method, point = one
    return f"{method.name}, {level_text(method, point)}" if method.level else method.name


def verdict(found: Measured) -> str:
    """Whether ncgear works at the knee, in a few words."""
    told = knee(found)
    if told.is_chosen:
        return "yes"
    if told.chosen[1].error > told.error:
        return "no: not exact enough"
    slower = f"{told.slowness:.2g} times the time of {named(told.quickest)}"
    return f"among adaptive methods; {slower}" if _among_adaptive(found) else f"no: {slower}"


def _rates_text(found: Measured) -> str:
    """The fitted rates of convergence beside the theory's; empty if theory has none."""
    told = [f"{rate.method} {rate.fitted:.2f} (theory {rate.theory:g})" for rate in rates(found)]
    return f"Order of convergence, fitted above rounding: {', '.join(told)}." if told else ""


def _choice_text(found: Measured) -> str:
    """What ncgear uses and why, whether that is the knee, and what the neighbours cost."""
    told = knee(found)
    sides = (
        ("cheaper", told.cheaper, "Nothing quicker was measured"),
        ("dearer", told.dearer, "Nothing is more exact"),
    )
    neighbours = [f"Next {side}: {_beside(told, one)}." if one else f"{none}." for side, one, none in sides]
    return " ".join([f"ncgear uses {named(told.chosen)}: {found.study.because}.", _knee_text(found, told), *neighbours])


def _knee_text(found: Measured, told: Knee) -> str:
    quickest = f"{named(told.quickest)} ({time_text(told.quickest[1])})"
    bound = f"an error of at most {told.error:.1e}"
    if told.is_chosen:
        return f"That is the knee: with {bound}, no other point is quicker by a factor of {SAME_TIME:g}."
    if told.chosen[1].error > told.error:
        return f"That is not the knee: its error is larger than {told.error:.1e}, which {quickest} reaches."
    quicker = f"{quickest} has {bound} too, {told.slowness:.2g} times as fast"
    if _among_adaptive(found):
        return (
            f"That is the knee among methods that find by themselves how fine they must be; {quicker}, with its number "
            "of points chosen by the exact result."
        )
    return f"That is not the knee: {quicker}."


def _among_adaptive(found: Measured) -> bool:
    return found.chosen[0].unaided and knee(found, unaided=True).is_chosen


def _beside(told: Knee, one: PointOfMethod) -> str:
    """A neighbour, with its time and error as multiples of the chosen point's."""
    here, there = told.chosen[1], one[1]
    error = f"{there.error / here.error:.2g} times the error" if here.error else f"an error of {error_text(there)}"
    return f"{named(one)}, {there.seconds / here.seconds:.2g} times the time and {error}"


# --- the picture -----------------------------------------------------------------------------------------------------


def picture(found: Measured) -> bytes:
    """A PNG with logarithmic axes, a line for each method, and a ring around the point that ncgear uses."""
    made = figure(WIDTH_IN, HEIGHT_IN, found.study.title)
    made.subplots_adjust(**Margins(left=1.0, right=KEY_IN, top=0.45).shares(WIDTH_IN, HEIGHT_IN))
    axes = made.add_subplot()
    # A logarithmic axis has no zero: points without any error stand below the least one.
    foot = (found.least_error or 1.0) / 3.0

    def scaled(row: Sequence[Point]) -> tuple[list[float], list[float]]:
        """Milliseconds and errors."""
        return [1000.0 * point.seconds for point in row], [max(point.error, foot) for point in row]

    styles = zip(cycle(COLORS), cycle(MARKERS))
    for method, row, (color, marker) in zip(found.study.methods, found.points, styles, strict=False):
        axes.plot(*scaled(row), color=color, marker=marker, markersize=4.5, linewidth=1.3, label=method.name)
    axes.plot(
        *scaled([found.chosen[1]]),
        marker="o",
        markersize=13.0,
        markerfacecolor="none",
        markeredgecolor=INK,
        markeredgewidth=1.4,
        linestyle="none",
        zorder=5,
        label="what ncgear does",
    )
    axes.set(xscale="log", yscale="log")
    dress(axes, "time in ms", fill(f"error ({found.study.unit})", LINE))
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize=SMALL, borderaxespad=0.0)
    return png(made)
