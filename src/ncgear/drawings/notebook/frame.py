"""The pieces of what a notebook shows: a frame with its style, figures, tables, charts, and what was refused.

Each output stands by itself and loads nothing.  Notebooks tell on the page around an output whether they are dark; the
style looks for the marks of JupyterLab, VS Code, Colab, marimo and pages of documentation, and is light without one.
All text that is not of this package is escaped: pieces are put together by ``Markup.format``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from hashlib import sha256

from markupsafe import Markup

from ncgear.drawings.charts.chart import Line
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.chart_svg import drawn
from ncgear.drawings.palette import DARK, LIGHT
from ncgear.errors import DesignError
from ncgear.figures.tables import Table
from ncgear.figures.terminal import labelled

NOTHING = Markup("")

DARK_PAGES = (
    'body[data-jp-theme-light="false"]',
    "body.vscode-dark",
    "body.vscode-high-contrast:not(.vscode-high-contrast-light)",
    'html[theme="dark"]',
    'html[data-theme="dark"]',
    'body[data-theme="dark"]',
    ".dark",
    ".dark-theme",
    '[data-md-color-scheme="slate"]',
)
"""What the page around an output has where it is dark: JupyterLab, VS Code, Colab, Sphinx themes, marimo, MkDocs."""

STYLE = """\
.ncgear { font: 14px/1.4 system-ui, "Segoe UI", Arial, sans-serif; font-variant-numeric: tabular-nums;
  color: var(--ink); background: var(--panel); border: 1px solid var(--rule); border-radius: 8px;
  padding: 0.7rem 0.9rem; max-width: 64rem; }
.ncgear :is(h3, p, dl, dd, figure, ul) { margin: 0; padding: 0; }
.ncgear h3 { font-size: 1.1rem; overflow-wrap: anywhere; color: inherit; }
.ncgear :is(.description, .extremes, dt, .unit, .note, caption) { color: var(--muted); font-weight: 400; }
.ncgear .description { overflow-wrap: anywhere; white-space: pre-line; }
.ncgear dl { display: flex; flex-wrap: wrap; gap: 0.3rem 1.5rem; margin: 0.5rem 0; }
.ncgear dt { font-size: 0.8rem; }
.ncgear dd { font-weight: 600; }
.ncgear .refused { border-left: 4px solid var(--warning); background: var(--warning-ground); color: var(--warning);
  padding: 0.35rem 0.7rem; margin: 0.4rem 0; overflow-wrap: anywhere; }
.ncgear .row { display: flex; flex-wrap: wrap; gap: 0.6rem 1rem; }
.ncgear .row > figure { flex: 1 1 19rem; min-width: 0; max-width: 30rem; }
.ncgear figcaption { font-size: 0.85rem; display: flex; flex-wrap: wrap; gap: 0 0.8rem; color: inherit; }
.ncgear figcaption b { font-weight: 600; }
.ncgear .key i { display: inline-block; width: 1.2rem; margin-right: 0.3rem; vertical-align: 0.25em;
  border-top: 2.5px solid var(--driving); }
.ncgear .key :is(.other, .uniform) i { border-top-color: var(--uniform); border-top-width: 2px; }
.ncgear .key .uniform i { border-top-style: dashed; }
.ncgear .key .limit i { border-top: 2px dotted var(--ink); }
.ncgear .plot svg { display: block; width: 100%; height: auto; stroke-linejoin: round; overflow: visible; }
.ncgear .shape svg { display: block; width: 100%; height: 20rem; }
.ncgear .shape :is(path, circle) { vector-effect: non-scaling-stroke; }
.ncgear .tables { overflow-x: auto; }
.ncgear table { border-collapse: collapse; margin: 0.5rem 0; color: inherit; background: none; font-size: 0.92em; }
.ncgear caption { text-align: left; caption-side: top; padding: 0.2rem 0; }
.ncgear :is(tr, tr:nth-child(odd), tr:hover) { background: none; }
.ncgear :is(th, td) { padding: 0.15rem 0.6rem; border: 0; border-top: 1px solid var(--grid); text-align: right;
  vertical-align: top; font-weight: 400; color: inherit; max-width: none; white-space: normal; }
.ncgear :is(th:first-child, .words) { text-align: left; }
.ncgear tr.note td { border-top: 0; text-align: left; padding-top: 0; }
.ncgear thead .unit { display: block; }
"""


def _colors(colors: Mapping[str, str]) -> str:
    return "".join(f"--{name}:{color};" for name, color in colors.items())


def style() -> str:
    """The style sheet of every output, without that of the scene."""
    dark = ", ".join(f"{page} .ncgear" for page in DARK_PAGES)
    return f".ncgear {{ {_colors(LIGHT)} }}\n{dark} {{ {_colors(DARK)} }}\n{STYLE}"


def framed(title: str, *pieces: Markup, description: str = "") -> str:
    """A whole output: its style, a title, a description in muted words, and the pieces below them."""
    told = Markup('<p class="description">{}</p>').format(description) if description else NOTHING
    head = Markup("<h3>{}</h3>{}").format(title, told)
    return Markup("<style>{}</style>{}").format(Markup(style()), in_frame(head, *pieces))


def in_frame(*pieces: Markup) -> Markup:
    """The pieces in the frame that the style is for."""
    return Markup('<div class="ncgear">{}</div>').format(NOTHING.join(pieces))


def made(piece: Callable[[], Markup]) -> Markup:
    """A piece, or the words with which it is refused; a fault of ncgear's own is told as one, and ends nothing."""
    try:
        return piece()
    except Exception as error:
        return not_made(error)


def not_made(error: Exception) -> Markup:
    """What an error tells: a refusal by its words, anything else as a fault."""
    if isinstance(error, DesignError):
        return refusal(str(error))
    return refusal(f"a fault in ncgear, please report it: {type(error).__name__}: {error}")


def refusal(words: str) -> Markup:
    """Words of what cannot be made."""
    return Markup('<p class="refused">{}</p>').format(words)


def facts(pairs: Iterable[tuple[str, str]]) -> Markup:
    """Names and values in a line that wraps."""
    entries = (Markup("<div><dt>{}</dt><dd>{}</dd></div>").format(name, value) for name, value in pairs)
    return Markup("<dl>{}</dl>").format(NOTHING.join(entries))


def figures(section: Mapping[str, object]) -> Markup:
    """A section of a summary as ``facts``, in the words that the terminal has for its keys."""
    return facts(labelled(section))


def table(content: Table) -> Markup:
    """A table with its notes."""
    heads = NOTHING.join(
        Markup('<th>{}<span class="unit">{}</span></th>').format(column.label, column.unit)
        for column in content.columns
    )
    top = Markup("<thead><tr>{}</tr></thead>").format(heads) if heads else NOTHING
    rows = [
        Markup("<tr><th>{}</th>{}</tr>").format(row.cells[0], _cells(row.cells[1:], row.span)) + _note(row.note)
        for row in content.html_rows
    ]
    below = NOTHING.join(Markup('<p class="note">{}</p>').format(note) for note in content.notes)
    return Markup('<div class="tables"><table><caption>{}</caption>{}<tbody>{}</tbody></table>{}</div>').format(
        content.title, top, NOTHING.join(rows), below
    )


def _cells(texts: Sequence[str], span: int) -> Markup:
    first = Markup(' colspan="{}"').format(span) if span > 1 else NOTHING
    return NOTHING.join(
        Markup("<td{}>{}</td>").format(first if number == 0 else NOTHING, text) for number, text in enumerate(texts)
    )


def _note(note: str) -> Markup:
    return Markup('<tr class="note"><td colspan="99">{}</td></tr>').format(note) if note else NOTHING


def charts(shown: Iterable[PageChart]) -> Markup:
    """Charts beside each other, as the report draws them, each with its extremes and the key of its lines."""
    return Markup('<div class="row">{}</div>').format(NOTHING.join(map(_chart, shown)))


def _chart(shown: PageChart) -> Markup:
    # Names within an SVG are those of the whole page: they follow from what is drawn, so equal names are equal things.
    plain = drawn(shown)
    key = f"ncgear-{digest(plain.drawing)}"
    drawing = plain.drawing.replace(f'"{shown.key}-', f'"{key}-').replace(f"#{shown.key}-", f"#{key}-")
    lines = shown.chart.lines
    keys = NOTHING.join(map(_key, lines)) if len(lines) > 1 else NOTHING
    unit = f" in {shown.chart.unit}" if shown.chart.unit else ""
    return Markup(
        '<figure class="plot" role="img" aria-label="{0}{1}: {2}"><figcaption><b>{0}</b>'
        '<span class="extremes">{2}</span><span class="key">{3}</span></figcaption>{4}</figure>'
    ).format(shown.chart.name, unit, plain.extremes, keys, Markup(drawing))


def _key(line: Line) -> Markup:
    return Markup('<span class="{}"><i></i>{} </span>').format(line.role.value, line.label)


def digest(text: str) -> str:
    """A short name that follows from a text."""
    return sha256(text.encode()).hexdigest()[:12]
