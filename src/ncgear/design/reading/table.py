"""Tables in files as spreadsheets, measuring machines and people write them: rows of cells, each with its line.

Columns are separated by commas, semicolons, tabs or spaces, as the first row shows or a line ``sep=`` says; where they
are separated by anything but commas, a comma may stand for the decimal point.  Empty lines and comments are passed
over.  UTF-8 is read, and UTF-16 with its mark or without; of XLSX, XLS and ODS the first sheet that is not hidden.
"""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from ncgear.design.reading.text import read_bytes, read_text
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass

COMMENTS = ("#", "%", "//", "!")
"""How a line begins that is no row."""

SHEETS = (".xlsx", ".xlsm", ".xls", ".ods")
"""Files of spreadsheets, by their endings."""

DECIMAL_POINT = re.compile(r"\s*[-+]?[0-9]*\.[0-9]+([eE][-+]?[0-9]+)?\s*")
DECIMAL_COMMA = re.compile(r"\s*[-+]?[0-9]*,[0-9]+([eE][-+]?[0-9]+)?\s*")


@dataclass(frozen=True)
class Row:
    """The cells of a line of the file; ``comma`` says that commas separate them."""

    line: int
    cells: list[str]
    comma: bool = False

    def column(self, number: int) -> int:
        """Where a cell begins in its line, from 1, as long as no cell is in quotes, which numbers do not need."""
        return 1 + sum(len(cell) + 1 for cell in self.cells[:number])


def read_rows(path: Path, *, limit_mb: int) -> Iterator[Row]:
    """The rows of a table; raises WrongInput where the file cannot be read, with the line of what is no row."""
    if path.suffix.lower() in SHEETS:
        return _of_sheet(path, limit_mb)
    return _of_text(_text(path, limit_mb), path)


def column_name(head: str) -> str:
    """The name that a head stands for: ``X (mm)``, ``x [mm]`` and ``x_mm`` are ``x_mm``.

    Letters and signs that mean more, as of ``Force (µN)`` and ``force (-N)``, stay, so that no key has that name.
    """
    return re.sub(r"[\s()\[\]{}/,;:·*^_]+|(?<=\w)-(?=\w)", "_", head.casefold().replace("°", " deg ")).strip("_")


def _text(path: Path, limit_mb: int) -> str:
    content = read_bytes(path, limit_mb=limit_mb)
    coding = _utf_16(content[:LOOKED_AT])
    if not coding:
        return read_text(path, limit_mb=limit_mb)
    try:
        return content.decode(coding)
    except UnicodeDecodeError as error:
        raise WrongInput("is not UTF-16 text; save the file as UTF-8", location=str(path)) from error


LOOKED_AT = 64
"""Bytes at the beginning of a file that show its coding: heads and digits have a byte of nought each in UTF-16."""


def _utf_16(begins: bytes) -> str:
    """The kind of UTF-16 that a file is, by its mark or by its bytes of nought; empty where it is none."""
    if begins.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    halves = {"utf-16-le": begins[1::2], "utf-16-be": begins[::2]}
    return next((coding for coding, half in halves.items() if half and not any(half)), "")


def _of_text(text: str, path: Path) -> Iterator[Row]:
    separator, first, decimals = "", 1, dict[str, int]()
    lines = text.splitlines()
    if lines and re.fullmatch(r'"?sep=(.|\\t)"?', lines[0].strip(), re.IGNORECASE):
        separator, first = lines[0].strip().strip('"')[4:].replace("\\t", "\t"), 2
    for line, content in enumerate(lines[first - 1 :], first):
        stripped = content.strip()
        if not stripped or stripped.startswith(COMMENTS):
            continue
        separator = separator or next((one for one in (";", "\t", ",") if one in content), " ")
        cells = content.split() if separator == " " else _cells(content, separator, f"{path}:{line}:1")
        if separator != ",":
            _refuse_both(cells, line, decimals, path)
        if any(cell.strip() for cell in cells):
            yield Row(line, cells if separator == "," else [_with_point(cell) for cell in cells], separator == ",")


def _cells(content: str, separator: str, location: str) -> list[str]:
    if '"' not in content:
        return content.split(separator)
    try:
        (cells,) = csv.reader([content], delimiter=separator, strict=True, skipinitialspace=True)
    except (csv.Error, ValueError) as error:
        problem = f"is not CSV: {error}; numbers separated by commas, semicolons or tabs are right"
        raise WrongInput(problem, location=location) from error
    return cells


def _refuse_both(cells: Sequence[str], line: int, decimals: dict[str, int], path: Path) -> None:
    """Refuse numbers with points beside numbers with commas: in one of both the sign parts thousands.

    ``decimals`` has the first line of each sign, and gets that of ``cells``.
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


def _of_sheet(path: Path, limit_mb: int) -> Iterator[Row]:
    """The rows of the first sheet that is not hidden; hidden rows count, as the library does not tell them."""
    from ncgear.extras import require

    require("python_calamine", "tables", str(path))
    from python_calamine import CalamineError, SheetVisibleEnum, load_workbook

    read_bytes(path, limit_mb=limit_mb)
    try:
        book = load_workbook(str(path))
        shown = [one.name for one in book.sheets_metadata if one.visible == SheetVisibleEnum.Visible]
        rows = book.get_sheet_by_name(shown[0]).to_python(skip_empty_area=False)
    except (CalamineError, IndexError, OSError) as error:
        said = " ".join(str(error).split())[:80]
        raise WrongInput(f"is no spreadsheet that can be read: {said}; save it as CSV", location=str(path)) from error
    for line, values in enumerate(rows, 1):
        cells = [repr(value) if isinstance(value, float) else str(value) for value in values]
        if any(cell.strip() for cell in cells) and not cells[0].strip().startswith(COMMENTS):
            yield Row(line, cells)
