"""The pages of every key of a design file and of a balance file, read from the models that check them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby

from ncgear.design.keys.balance import Balance
from ncgear.design.keys.design import Design
from ncgear.design.reference import Key, allowed, default_words, keys_of, unit_of
from ncgear.design.trains.registry import TrainFile, train_models
from ncgear.design.words import listed
from ncgear.figures.tables import markdown
from ncgear.mechanisms.resistance import MOST_TURNS
from ncgear.numerics.formula import DEEPEST, FUNCTIONS, LARGEST_POWER, LONGEST
from ncgear.numerics.proven import MOST_CHOICES, MOST_PANELS


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


MADE = "<!-- Made by `make docs` from the models that check such files. -->"

FOLDER, FORMULAS_PAGE = "design-file", "design-file/formulas.md"
"""Where the pages of a design file's sections are."""

DESIGN_INTRODUCTION = f"""\
# The design file

{MADE}

Every key of a design file, a page for each section. Files are YAML: `ncgear new NAME` writes one with comments, [the
tutorial](tutorial.md) fills one in, `ncgear explain KEY` tells about one key, `ncgear schema` prints the JSON Schema
for editors. A key that is not here is refused, and the message names the nearest that is. A key's end is its unit; an
angle can be given in degrees (`_deg`), radians (`_rad`) or multiples of pi (`_pi`), by one of these keys.
"""

FORMULAS = f"""\
# Formulas in a design file

{MADE}

The keys [`motion.ratio`, `motion.driven_angle`](motion-ratio_expression.md),
[`motion.expression_mm`](motion-pitch_curve.md) and [`resistance.expression_n`](resistance.md) are formulas in
Python's notation: powers are `**`, the decimal sign is a point, angles are in radians.

| what | for instance |
|---|---|
| the variable: `phi`, the driving angle in rad, or `x`, the displacement in mm | `1 + 0.3*cos(phi)` |
| numbers, `pi`, `+ - * /`, brackets | `200 + 3*x/80` |
| powers with a number as exponent, at most {LARGEST_POWER} | `x**2`, `(1.2 + cos(phi))**0.5` |
| {_listed(FUNCTIONS)} of one argument | `exp(0.3*cos(phi))` |
| `abs`, `sign` of one argument, `min`, `max` of two | `max(0, x - 30)` |
| one expression or another: `a if u < v else b`, also with `<=`, `>`, `>=` | `1 if sin(phi) < 0 else 1 + sin(phi)**2` |

`sign(0)` is 1. Roots of even powers are absolute values: `sqrt(u**2)` is `abs(u)`.

Where a formula goes over from one expression to another, the law has a joint.

- **A ratio** must not jump there, and its slope must not either, nor where the cycle begins again: the pitch curves
  would have a corner, and no teeth roll around one. `max(0, sin(phi))**2` has no corner, `max(0, sin(phi))` has one;
  `sqrt(u**2 + 0.01)` in the place of `abs(u)` rounds it. Its curvature may jump, but not be infinite, as that of
  `abs(sin(phi))**1.5` is at 0.
- **A driven angle** must keep its dphi2/dphi1 free of both.
- **A resistance** may have corners, but no jumps: the slider would meet a wall. Powers over 1 may begin anywhere, as
  `max(0, x - 30)**1.5` does; `sqrt(x)` is refused, since its slope is infinite at 0. Steep steps such as
  `100*tanh((x - 20)/0.5) + 100` are right.

Every formula is proven to have no feature, however narrow, that the numbers miss, or it is refused with the place.
Bounds are {LONGEST} characters, {DEEPEST} levels of nesting, {MOST_PANELS} panels for a smooth stretch (a wave needs
two), {MOST_CHOICES} joints, and {MOST_TURNS} ups and downs of a resistance over the stroke.
"""

TABLES = """\
## Tables in files of their own

Where a key `file` stands for columns (of `motion.points`, a law's table, `resistance.table`, a motor's curve, the
runs of a balance file), and in [`ncgear measured`](commands/measured.md), a table is read as spreadsheets, measuring
machines and people write it: columns separated by commas, semicolons, tabs, bars or spaces, with a decimal comma
where they are not separated by commas; a line `sep=;`; lines that begin with `#`, `%`, `//` or `!` as comments; UTF-8
or UTF-16; and of XLSX, XLS and ODS the first sheet (`pip install 'ncgear[tables]'`). The first row names the
columns as the keys are called: `x_mm`, `X (mm)` and `x [mm]` are the same. Other columns, and one without a name, are
passed over.
"""

BALANCE_INTRODUCTION = f"""\
# The balance file

{MADE}

Every key of a balance file, which [`ncgear balance`](commands/balance.md) reads. A key's end is its unit. Worked
files are in [`designs/balance`](../designs/balance).
"""

TRAIN_INTRODUCTION = f"""\
# The file of a train

{MADE}

Every key of the design file of a [train of gears](trains.md), which [`ncgear check`](commands/check.md) and
[`ncgear build`](commands/build.md) read. A key's end is its unit.
"""

HEADS = ("key", "unit", "meaning", "value", "left out")

PICTURES = {
    "`motion`, law `three_segment_stroke`": "![The speed of a slider over the driving angle: theta1 to theta4, v1, v2, "
    "a1 and the stroke are marked on it](../images/stroke-keys.png)"
}
"""Pictures that explain the keys of a section, by its title."""

SPECIAL = str.maketrans({"|": "&#124;", "*": "\\*", "<": "&lt;"})
"""What would be more than a letter in a table of Markdown."""


def key_pages() -> dict[str, str]:
    """The pages, by their places in the folder of the documentation."""
    keys = keys_of(Design)
    groups = [key for key in _inside(keys, "") if key.group]
    sections = {
        f"{FOLDER}/{'-'.join(filter(None, (group.path, law)))}.md": (group, law, title)
        for group in groups
        for law, title in _titles(keys, group)
    }
    contents = ",\n".join(f"[{title}]({place})" for place, (_, _, title) in sections.items())
    also = f"[formulas]({FORMULAS_PAGE}) and [materials](materials.md)"
    first = [DESIGN_INTRODUCTION, f"Sections:\n{contents}.\nWhat keys take: {also}.", ""]
    first += [*_own(keys, "", "", "Top of the file", 2), TABLES]
    pages = {"design-file.md": first, FORMULAS_PAGE: [FORMULAS]}
    for place, (group, law, title) in sections.items():
        about = f"The section {title} of a [design file](../design-file.md): {group.meaning}."
        pages[place] = [f"# {title}", "", MADE, "", about, "", *_section(keys, group.path, law, title, 1)]
    balance = keys_of(Balance)
    pages["balance-file.md"] = [BALANCE_INTRODUCTION, *_section(balance, "", "", "Top of the file", 2)]
    pages["train-file.md"] = [
        TRAIN_INTRODUCTION,
        *_own(keys_of(TrainFile), "", "", "Top of the file", 2),
        *_of_trains(),
    ]
    return {place: "\n".join(lines).rstrip() + "\n" for place, lines in pages.items()}


def _of_trains() -> Iterator[str]:
    """The tables below ``train``, each once with the kinds of trains that have just this table."""
    tables: dict[tuple[str, tuple[tuple[str, ...], ...]], list[str]] = {}
    models = train_models()
    for kind, model in models.items():
        keys = keys_of(model)
        for path in ["train", *(key.path for key in keys if key.group and key.path.startswith("train."))]:
            rows = tuple(tuple(_row(key)) for key in _inside(keys, path))
            tables.setdefault((path, rows), []).append(kind)
    for (path, rows), kinds in tables.items():
        of_kinds = "" if len(kinds) == len(models) else f" of kind {listed([f'`{kind}`' for kind in kinds], 'and')}"
        yield from (f"{'#' * min(path.count('.') + 2, 4)} `{path}`{of_kinds}", "", *markdown(HEADS, rows), "")


def _section(keys: Sequence[Key], above: str, law: str, title: str, level: int) -> Iterator[str]:
    """The table of a group's own keys, then the groups in it; a title of the first level stands already."""
    yield from _own(keys, above, law, title, level)
    for group in _inside(keys, above):
        if group.group and group.law == law:
            for its_law, its_title in _titles(keys, group):
                yield from _section(keys, group.path, its_law, its_title, level + bool(above))


def _own(keys: Sequence[Key], above: str, law: str, title: str, level: int) -> Iterator[str]:
    """A title and the table of a group's own keys."""
    yield from [] if level == 1 else (f"{'#' * min(level, 4)} {title}", "")
    yield from [PICTURES[title], ""] if title in PICTURES else []
    yield from (*markdown(HEADS, (_row(key) for key in _inside(keys, above) if key.law == law)), "")


def _titles(keys: Sequence[Key], group: Key) -> Iterator[tuple[str, str]]:
    """The titles of a group's sections by their laws; of the motion one for each law."""
    inside = [key for key in _inside(keys, group.path) if not group.law or key.law == group.law]
    for law, _ in groupby(inside, lambda key: key.law):
        yield law, f"`{group.path}`" + (f", law `{law}`" if law else "")


def _inside(keys: Sequence[Key], above: str) -> list[Key]:
    return [key for key in keys if key.path.rpartition(".")[0] == above]


def _row(key: Key) -> list[str]:
    left_out = default_words(key).removeprefix("none: it ").removeprefix("may be left out; ")
    cells = key.meaning, allowed(key), "-" if left_out == "may be left out" else left_out
    return [f"`{key.name}`", unit_of(key.name), *(cell.translate(SPECIAL) for cell in cells)]
