"""Tables: files that a group of a design or balance file names in place of some of its keys.

The reader takes tables as spreadsheets, measuring machines and people write them: rows of cells, and columns of
numbers.  It keeps the line of each row, so that a fault has its place.

Columns are separated by commas, semicolons, tabs, bars or spaces, as the first row shows or a line ``sep=`` says; if
they are not separated by commas, a comma may stand for the decimal point.  Empty lines and comments are passed over.
The text may be UTF-8, or UTF-16 with or without its mark; XLSX, XLS and ODS files give their first visible sheet.
"""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain
from math import isfinite
from pathlib import Path
from typing import Any

from ncgear.design.reading.places import Document, FilePlace, FromFile, named_by
from ncgear.design.reading.text import plain_number, quoted, read_bytes, read_text
from ncgear.design.words import listed
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass

COMMENTS = ("#", "%", "//", "!")
"""Beginnings of lines that are not rows."""

ERROR_VALUE = re.compile(r"#(N/A|NV|[^\s,;|]+[!?])\s*([,;|\t]|$)")
"""A cell of a spreadsheet whose formula failed, such as ``#DIV/0!``, which is no comment."""

SHEETS = (".xlsx", ".xlsm", ".xls", ".ods")
"""Files of spreadsheets, by their endings."""

MINUS = str.maketrans(dict.fromkeys("\u2212\u2013\u2012\ufe63\uff0d", "-"))
"""The minus sign of typography, and dashes that stand for it."""

RULE = re.compile(r"[\s|+:]*(-{2,}|={2,})[-=\s|+:]*")
"""A line drawn under the head of a table."""

THOUSANDS = re.compile(r"[-+]?[1-9][0-9]{0,2}\.[0-9]{3}")
"""A number whose point may separate thousands."""

DECIMAL_POINT = re.compile(r"\s*[-+]?[0-9]*\.[0-9]+([eE][-+]?[0-9]+)?\s*")
DECIMAL_COMMA = re.compile(r"\s*[-+]?[0-9]*,[0-9]+([eE][-+]?[0-9]+)?\s*")


@dataclass(frozen=True)
class FileRow:
    """The cells of a line of the file; ``comma`` says that commas separate them."""

    line: int
    cells: list[str]
    comma: bool = False

    def column(self, number: int) -> int:
        """Column at which a cell begins in its line, from 1; cells in quotes, which numbers do not need, shift it."""
        return 1 + sum(len(cell) + 1 for cell in self.cells[:number])


def read_rows(path: Path, *, limit_mb: int) -> Iterator[FileRow]:
    """The rows of a table; raises WrongInput if the file cannot be read, with the line of a text that is no row."""
    if path.suffix.lower() in SHEETS:
        return _of_sheet(path, limit_mb)
    return _of_text(_text(path, limit_mb), path)


def _is_comment(text: str) -> bool:
    return text.startswith(COMMENTS) and not ERROR_VALUE.match(text)


def column_name(head: str) -> str:
    """The name that a head stands for: ``X (mm)``, ``x [mm]`` and ``x_mm`` are ``x_mm``.

    Letters and signs with a meaning, such as in ``Force (µN)`` and ``force (-N)``, stay, so that no key has that name.
    """
    return re.sub(r"[\s()\[\]{}/,;:·*^_]+|(?<=\w)-(?=\w)", "_", head.casefold().replace("°", " deg ")).strip("_")


def _text(path: Path, limit_mb: int) -> str:
    content = read_bytes(path, limit_mb=limit_mb)
    coding = _utf_16(content[:LOOKED_AT])
    if not coding and b"\0" in content[:LOOKED_AT]:
        problem = f"is no text; CSV in UTF-8 is right, or a spreadsheet by its ending: {listed(SHEETS)}"
        raise WrongInput(problem, location=str(path))
    if not coding:
        return read_text(path, limit_mb=limit_mb)
    try:
        return content.decode(coding)
    except UnicodeDecodeError as error:
        raise WrongInput("is not UTF-16 text; save the file as UTF-8", location=str(path)) from error


LOOKED_AT = 64
"""Bytes at the beginning of a file that show its coding: in UTF-16, heads and digits have a zero byte each."""


def _utf_16(begins: bytes) -> str:
    """The kind of UTF-16 of a file, by its mark or by its zero bytes; empty if it is none."""
    if begins.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    halves = {"utf-16-le": begins[1::2], "utf-16-be": begins[::2]}
    return next((coding for coding, half in halves.items() if half and not any(half)), "")


def _of_text(text: str, path: Path) -> Iterator[FileRow]:
    separator, first, decimals = "", 1, dict[str, int]()
    lines = text.translate(MINUS).splitlines()
    if lines and re.fullmatch(r'"?sep=(.|\\t)"?', lines[0].strip(), re.IGNORECASE):
        separator, first = lines[0].strip().strip('"')[4:].replace("\\t", "\t"), 2
    for line, content in enumerate(lines[first - 1 :], first):
        stripped = content.strip()
        if not stripped or _is_comment(stripped) or RULE.fullmatch(stripped):
            continue
        separator = separator or next((mark for mark in (";", "\t", "|", ",") if mark in content), " ")
        cells = content.split() if separator == " " else _cells(content, separator, path, line)
        if separator != "," and any(sign in content and sign not in decimals for sign in (".", ",")):
            _refuse_both(cells, line, decimals, path)
        if any(map(str.strip, cells)):
            yield FileRow(line, cells if separator == "," else [_with_point(cell) for cell in cells], separator == ",")


def _cells(content: str, separator: str, path: Path, line: int) -> list[str]:
    if '"' not in content:
        return content.split(separator)
    try:
        (cells,) = csv.reader([content], delimiter=separator, strict=True, skipinitialspace=True)
    except (csv.Error, ValueError) as error:
        problem = f"is not CSV: {error}; numbers separated by commas, semicolons or tabs are right"
        raise WrongInput(problem, location=f"{path}:{line}:1") from error
    return cells


def _refuse_both(cells: Sequence[str], line: int, decimals: dict[str, int], path: Path) -> None:
    """Refuse numbers with points beside numbers with commas: one of the signs separates thousands.

    ``decimals`` has the first line of each sign, and gets the line of ``cells``.
    """
    for sign, pattern in ((".", DECIMAL_POINT), (",", DECIMAL_COMMA)):
        if any(sign in cell and pattern.fullmatch(cell) for cell in cells):
            decimals.setdefault(sign, line)
    if len(decimals) == len({".", ","}):
        problem = (
            f"numbers with commas (line {decimals[',']}) and with points (line {decimals['.']}); one sign is right"
        )
        raise WrongInput(f"{problem}, and none between thousands", location=f"{path}:{line}:1")


def _with_point(cell: str) -> str:
    return cell.replace(",", ".") if "," in cell and DECIMAL_COMMA.fullmatch(cell) else cell


def _of_sheet(path: Path, limit_mb: int) -> Iterator[FileRow]:
    """The rows of the first visible sheet; hidden rows count, as the library does not mark them."""
    from ncgear.extras import require

    require("python_calamine", "tables", str(path))
    from python_calamine import CalamineError, SheetVisibleEnum, load_workbook

    read_bytes(path, limit_mb=limit_mb)
    try:
        book = load_workbook(str(path))
        shown = [sheet.name for sheet in book.sheets_metadata if sheet.visible == SheetVisibleEnum.Visible]
        rows = book.get_sheet_by_name(shown[0]).to_python(skip_empty_area=False)
    except (CalamineError, IndexError, OSError) as error:
        said = " ".join(str(error).split())[:80]
        raise WrongInput(f"is no spreadsheet that can be read: {said}; save it as CSV", location=str(path)) from error
    for line, values in enumerate(rows, 1):
        cells = [repr(value) if isinstance(value, float) else str(value) for value in values]
        if any(cell.strip() for cell in cells) and not _is_comment(cells[0].strip()):
            yield FileRow(line, cells)


LARGEST_MB = 20


@dataclass(frozen=True)
class FileColumns:
    """The columns of a file, one of each kind, and the largest number of points; a kind is a list of possible names."""

    kinds: tuple[tuple[str, ...], ...]
    most_points: int

    @property
    def names(self) -> tuple[str, ...]:
        """All names."""
        return tuple(name for kind in self.kinds for name in kind)


@dataclass(frozen=True)
class PointsFile:
    """Columns of a CSV file by name, with the line of the header and the line of each row."""

    file: str
    header: int
    values: dict[str, list[float]]
    lines: list[int]

    def row(self, row: int | None) -> FilePlace:
        """The place where a row begins; None stands for the header."""
        return FilePlace(self.file, self.header if row is None else self.lines[row], 1)

    def place(self, key: str) -> FilePlace:
        """The place of a column (``ratio``) or of a number in it (``ratio.12``)."""
        row = key.partition(".")[2]
        return self.row(int(row) if row else None)


@dataclass(frozen=True)
class PointsKind:
    """The purpose of a group's file: the keys that it replaces, and the function that reads it.

    ``read`` takes the file and the other keys of the group.  If ``law`` is not empty, only a group with this law may
    name a file.
    """

    keys: tuple[str, ...]
    read: Callable[[Path, Mapping[str, Any]], FromFile]
    law: str = ""


def columns_kind(columns: FileColumns, law: str = "") -> PointsKind:
    """The columns of a CSV file in place of keys of the same names."""

    def read(file: Path, _: Mapping[str, Any]) -> FromFile:
        points = read_points(file, columns)
        return FromFile(points.values, points.place)

    return PointsKind(columns.names, read, law)


def values_from_files(document: Document, path: Path, kinds: Mapping[str, PointsKind]) -> dict[str, FromFile]:
    """The values of the files that groups name by their key ``file``; ``kinds`` are by the group's dotted key.

    Files must be beside ``path``.  The schema refuses a name of a file that is not text.  Raises WrongInput for a wrong
    or missing file, and for keys that are given beside it.
    """
    found: dict[str, FromFile] = {}
    for group, kind in kinds.items():
        given = document.at(group)
        if not isinstance(given, dict) or not isinstance(given.get("file"), str):
            continue
        if kind.law and given.get("law") != kind.law:
            continue
        for key in (f"{group}.{name}" for name in kind.keys if given.get(name) is not None):
            raise WrongInput("given beside file; keep one of them", key=key, location=str(document.place(key)))
        file = path.parent / given["file"]
        with named_by(document, f"{group}.file", file):
            found[group] = kind.read(file, given)
    return found


def read_points(path: Path, columns: FileColumns) -> PointsFile:
    """Read the columns and pass over all others; WrongInput names the line of a cell that is no number."""
    rows = read_rows(path, limit_mb=LARGEST_MB)
    header, first = next(rows, FileRow(1, [])), next(rows, None)
    if first is not None and (joined := _with_units(header, first, columns)) is not None:
        header, first = joined, None
    places = _places(header, str(path), columns)
    points = PointsFile(str(path), header.line, {name: [] for name in places}, [])
    width, forms = len(header.cells), {name: set[str]() for name in places}
    for row in rows if first is None else chain([first], rows):
        _append(points, places, width, row, columns.most_points)
        if not row.comma:
            for name, i in places.items():
                if CLEAR not in forms[name]:
                    forms[name].add(_form(row.cells[i].strip()))
    for name, found in forms.items():
        if found == {SMALL, GROUPED}:
            problem = "may have points between thousands or before decimals: 1.200 beside 971; write 1200 or 1.2000"
            raise WrongInput(f"column {name} {problem}", location=f"{path}:{header.line}:1")
    return points


SMALL, GROUPED, CLEAR = "small", "grouped", "clear"
"""Forms of numbers: below a thousand without a point, with a point before three digits, and any other."""


def _form(cell: str) -> str:
    if "." not in cell:
        return SMALL if len(cell.lstrip("+-")) <= len("999") else CLEAR
    return GROUPED if THOUSANDS.fullmatch(cell) else CLEAR


def _with_units(header: FileRow, row: FileRow, columns: FileColumns) -> FileRow | None:
    """The header with units of the row below it; None where that row holds no units of the columns."""
    if len(row.cells) != len(header.cells) or any(plain_number(cell.strip()) is not None for cell in row.cells):
        return None
    heads = [column_name(cell) for cell in header.cells]
    units = [column_name(cell) for cell in row.cells]
    joined = [
        head if head.endswith(f"_{unit}") or not unit else f"{head}_{unit}"
        for head, unit in zip(heads, units, strict=True)
    ]
    known = set(columns.names)
    if not known & set(joined) or not known & set(heads) <= set(joined):
        return None
    return FileRow(header.line, joined, header.comma)


def _places(header: FileRow, file: str, columns: FileColumns) -> dict[str, int]:
    """The requested columns by name, in the order of the file."""
    names = [column_name(cell) for cell in header.cells]
    for i, name in enumerate(names):
        if name in columns.names and name in names[:i]:
            raise _wrong(file, header, i, f"column given twice: {quoted(name)}")
    named = [name for name in names if name]
    if named and all(plain_number(cell.strip()) is not None for cell in header.cells if cell.strip()):
        kinds = ", and ".join(map(listed, columns.kinds))
        raise WrongInput(
            f"its first row has numbers; names of columns are right: {kinds}", location=f"{file}:{header.line}:1"
        )
    for kind in columns.kinds:
        if len(set(kind) & set(names)) == 1:
            continue
        for i, name in enumerate(names):
            if name and name not in columns.names:
                known = f"columns can be {listed(columns.names)}"
                raise _wrong(file, header, i, f"unknown column: {quoted(header.cells[i].strip())}; {known}")
        problem = f"the header must name one of the columns {listed(kind)}; it names {listed(named, 'and') or 'none'}"
        raise WrongInput(problem, location=f"{file}:{header.line}:1")
    return {name: i for i, name in enumerate(names) if name in columns.names}


def _append(points: PointsFile, places: Mapping[str, int], width: int, row: FileRow, most: int) -> None:
    cells = row.cells
    while len(cells) > width and not cells[-1].strip():
        cells = cells[:-1]
    if len(cells) != width:
        decimals = ", its decimals after a point," if row.comma else ""
        problem = f"{len(cells)} values for {width} columns; one number for each{decimals} is right"
        raise WrongInput(problem, location=f"{points.file}:{row.line}:1")
    if len(points.lines) == most:
        raise WrongInput(f"over {most} points; fewer are right", location=f"{points.file}:{row.line}:1")
    points.lines.append(row.line)
    for name, i in places.items():
        number = plain_number(cells[i].strip())
        if number is None or not isfinite(number):
            raise _wrong(points.file, row, i, f"{quoted(cells[i])} is not a finite number; one is needed", name)
        points.values[name].append(float(number))


def _wrong(file: str, row: FileRow, i: int, problem: str, key: str = "") -> WrongInput:
    return WrongInput(problem, key=key, location=f"{file}:{row.line}:{row.column(i)}")
