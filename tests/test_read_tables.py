"""Tables as spreadsheets, measuring machines and people write them are the same table, wherever one is taken."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

from at_once import at_once
from ncgear import extras
from ncgear.design.reading.measured_file import read_measured
from ncgear.design.reading.points import FileColumns, column_name, read_points
from ncgear.errors import WrongInput
from ncgear.project.opened import load

WANTED = FileColumns((("x_mm",), ("force_n", "force_kn")), 100)
PLAIN = "x_mm,force_n\n0,1.5\n10.25,-2e-3\n20,3\n"
VALUES = {"x_mm": [0.0, 10.25, 20.0], "force_n": [1.5, -2e-3, 3.0]}
POINTS = [(0.0, 1.5), (10.25, -2e-3), (20.0, 3.0)]

FORMS: dict[str, bytes] = {
    "semicolons and decimal commas": PLAIN.replace(",", ";").replace(".", ",").encode(),
    "tabs": PLAIN.replace(",", "\t").encode(),
    "tabs and decimal commas": PLAIN.replace(",", "\t").replace(".", ",").encode(),
    "bars": PLAIN.replace(",", "|").encode(),
    "minus signs of typography": PLAIN.replace("1.5\n10.25,-", "1.5\n10.25,\u2212").encode(),
    "dashes for minus signs": PLAIN.replace("1.5\n10.25,-", "1.5\n10.25,\u2013").encode(),
    "a table of Markdown": b"| x_mm | force_n |\n|---|---:|\n| 0 | 1.5 |\n| 10.25 | -2e-3 |\n| 20 | 3 |\n",
    "units below heads": b"x;force_n;note\n[mm];N;-\n0;1,5;a\n10,25;-2e-3;b\n20;3;c\n",
    "spaces": PLAIN.replace(",", "   ").encode(),
    "sep=": b"sep=;\r\n" + PLAIN.replace(",", ";").encode(),
    "lines of Windows": PLAIN.replace("\n", "\r\n").encode(),
    "mark of UTF-8": b"\xef\xbb\xbf" + PLAIN.encode(),
    "UTF-16": PLAIN.encode("utf-16"),
    "UTF-16 without its mark": PLAIN.encode("utf-16-le"),
    "UTF-16 of large ends without its mark": PLAIN.encode("utf-16-be"),
    "separators at ends": PLAIN.replace("\n", ",\n").encode(),
    "separators after ends": PLAIN.replace("\n", ",,\n").replace("n,,", "n").encode(),
    "quotes": b'"x_mm","force_n"\n"0","1.5"\n10.25,-2e-3\n20,3\n',
    "comments": b"# from the press\n\n" + PLAIN.replace("20", "% pause\n// and\n! on\n20").encode(),
    "units in heads": PLAIN.replace("x_mm,force_n", "X (mm), Force [N]").encode(),
    "an index": b",x_mm,force_n\n0,0,1.5\n1,10.25,-2e-3\n2,20,3\n",
    "further columns": b"time_s,x_mm,note,force_n\n0,0,begins,1.5\n1,10.25,,-2e-3\n2,20,ends,3\n",
}


FURTHER = "further columns", "an index", "a table of Markdown", "units below heads"
"""Forms with cells beside the wanted columns, or below their heads."""

CODINGS = {
    "UTF-16": "utf-16",
    "UTF-16 without its mark": "utf-16-le",
    "UTF-16 of large ends without its mark": "utf-16-be",
}


@pytest.mark.parametrize("form", FORMS)
def test_every_form_is_the_plain_table(tmp_path: Path, form: str) -> None:
    file = tmp_path / "t.csv"
    file.write_bytes(FORMS[form])
    found = read_points(file, WANTED)
    assert found.values == VALUES
    # The line of each row: faults have their place.
    lines = FORMS[form].decode(CODINGS.get(form, "utf-8")).splitlines()
    assert all(
        str(value).rstrip("0").rstrip(".")[:2] in lines[line - 1].replace(",", ".") or value == 20.0
        for line, value in zip(found.lines[1:], VALUES["x_mm"][1:], strict=True)
    )


@pytest.mark.parametrize("form", [name for name in FORMS if name not in FURTHER])
def test_measured_points_are_read_by_the_same_reader(tmp_path: Path, form: str) -> None:
    file = tmp_path / "t.csv"
    content = FORMS[form].decode(CODINGS.get(form, "utf-8"))
    for name in ("force_n", "Force [N]"):
        content = content.replace(name, "y_mm")
    file.write_text(content, encoding="utf-16" if form == "UTF-16" else "utf-8", newline="")
    np.testing.assert_array_equal(read_measured(file).points_mm, POINTS)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (
            "1,2\n3,4\n",
            "t.csv:1:1: its first row has numbers; names of columns are right: x_mm, and force_n or force_kn",
        ),
        ("x_mm,force_n\n#DIV/0!,2\n", "t.csv:2:1: x_mm: '#DIV/0!' is not a finite number"),
        ("x_mm,force_n\n#N/A,2\n", "t.csv:2:1: x_mm: '#N/A' is not a finite number"),
        ("PK\x03\x04\0\0", "t.csv: is no text; CSV in UTF-8 is right, or a spreadsheet by its ending: .xlsx"),
        ("x_cm,force_n\n1,2\n", "t.csv:1:1: unknown column: 'x_cm'; columns can be x_mm, force_n or force_kn"),
        ("x_mm,x (mm),force_n\n1,2,3\n", "t.csv:1:6: column given twice: 'x_mm'"),
        ("x_mm,force_n\n1,5,2\n", "t.csv:2:1: 3 values for 2 columns; one number for each, its decimals after a point"),
        ("x_mm;force_n\n1,5;2,5,0\n", "t.csv:2:5: force_n: '2,5,0' is not a finite number"),
        ("x_mm;force_n\n1\n", "t.csv:2:1: 1 values for 2 columns; one number for each is right"),
        (
            "x_mm;force_n\n0;0\n25;1,000\n50.5;1,200\n",
            "t.csv:4:1: numbers with commas (line 3) and with points (line 4)",
        ),
        ("x_mm\tforce_n\n50,5\t1.200\n", "t.csv:2:1: numbers with commas (line 2) and with points (line 2)"),
        (
            "x_mm;force_n\n0;971\n1;1.200\n",
            "t.csv:1:1: column force_n may have points between thousands or before decimals",
        ),
        ("x_mm;force_n\nmm;kN\n0;1\n", "t.csv:2:1: x_mm: 'mm' is not a finite number"),
        ("x_mm,Force (µN)\n1,2\n", "unknown column: 'Force (µN)'"),
        ("x_mm,force (-N)\n1,2\n", "unknown column: 'force (-N)'"),
        ("Δx_mm,force_n\n1,2\n", "unknown column: 'Δx_mm'"),
        ("x_mm,force_n\n1,2\n\n3,x\n", "t.csv:4:3: force_n: 'x' is not a finite number"),
    ],
)
def test_what_is_no_table_has_its_line_and_column(tmp_path: Path, content: str, said: str) -> None:
    file = tmp_path / "t.csv"
    file.write_text(content)
    with pytest.raises(WrongInput) as refused:
        read_points(file, WANTED)
    assert said in str(refused.value)


@pytest.mark.parametrize("column", ["0.971 1.200", "971.000 1.200", "971 1.2", "1971 1.200"])
def test_a_point_that_separates_no_thousands_is_the_decimal_point(tmp_path: Path, column: str) -> None:
    file = tmp_path / "t.csv"
    file.write_text("x_mm;force_n\n" + "".join(f"{i};{one}\n" for i, one in enumerate(column.split())))
    assert read_points(file, WANTED).values["force_n"] == [float(one) for one in column.split()]


def test_text_that_ends_in_half_a_letter_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    file.write_bytes(PLAIN.encode("utf-16") + b"\x00")
    with pytest.raises(WrongInput, match="is not UTF-16 text"):
        read_points(file, WANTED)


@at_once(
    ("head", "name"),
    [("x_mm", "x_mm"), ("Kraft [N]", "kraft_n"), ("phi (°)", "phi_deg"), ("v, mm/s", "v_mm_s"), ("  ", "")],
)
def test_heads_are_names_of_keys(head: str, name: str) -> None:
    assert column_name(head) == name


def workbook(file: Path) -> None:
    """The table as the first of two sheets of a workbook, its XML by hand (ECMA-376, the least that there must be)."""
    head, *rows = [line.split(",") for line in PLAIN.splitlines()]
    cells = "".join(f'<c t="inlineStr"><is><t>{name}</t></is></c>' for name in head)
    lines = [f"<row>{cells}</row>", *(f"<row>{''.join(f'<c><v>{one}</v></c>' for one in row)}</row>" for row in rows)]
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    of = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006"
    sheet = f'<worksheet xmlns="{main}"><sheetData>{{}}</sheetData></worksheet>'
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types">'
        '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        '<Default Extension="xml" ContentType="application/xml"/></Types>',
        "_rels/.rels": f'<Relationships xmlns="{package}/relationships">'
        f'<Relationship Id="a" Type="{of}/officeDocument" '
        'Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{main}" xmlns:r="{of}"><sheets><sheet name="one" sheetId="1" r:id="a"/>'
        '<sheet name="two" sheetId="2" r:id="b"/></sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships">'
        f'<Relationship Id="a" Type="{of}/worksheet" Target="worksheets/one.xml"/>'
        f'<Relationship Id="b" Type="{of}/worksheet" Target="worksheets/two.xml"/></Relationships>',
        "xl/worksheets/one.xml": sheet.format("".join(lines)),
        "xl/worksheets/two.xml": sheet.format(""),
    }
    with zipfile.ZipFile(file, "w") as archive:
        for name, content in parts.items():
            archive.writestr(name, content)


def open_document(file: Path) -> None:
    """The same as an ODS file."""
    head, *rows = [line.split(",") for line in PLAIN.splitlines()]
    names = "".join(
        f'<table:table-cell office:value-type="string"><text:p>{name}</text:p></table:table-cell>' for name in head
    )
    lines = [
        f"<table:table-row>{''.join(f'{START}{float(one)!r}{END}' for one in row)}</table:table-row>" for row in rows
    ]
    urn = "urn:oasis:names:tc:opendocument:xmlns:"
    content = (
        f'<office:document-content xmlns:office="{urn}office:1.0" xmlns:table="{urn}table:1.0" '
        f'xmlns:text="{urn}text:1.0"><office:body><office:spreadsheet><table:table table:name="one">'
        f"<table:table-row>{names}</table:table-row>{''.join(lines)}"
        "</table:table></office:spreadsheet></office:body></office:document-content>"
    )
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
        archive.writestr("META-INF/manifest.xml", f'<manifest:manifest xmlns:manifest="{urn}manifest:1.0"/>')
        archive.writestr("content.xml", content)


START, END = '<table:table-cell office:value-type="float" office:value="', '"/>'


@pytest.mark.parametrize("ending", ["xlsx", "ods"])
def test_spreadsheets_are_read_and_damaged_ones_refused(tmp_path: Path, ending: str) -> None:
    pytest.importorskip("python_calamine")
    file = tmp_path / f"t.{ending}"
    (workbook if ending == "xlsx" else open_document)(file)
    assert read_points(file, WANTED).values == VALUES
    file.write_bytes(file.read_bytes()[:200])
    with pytest.raises(WrongInput, match="is no spreadsheet that can be read"):
        read_points(file, WANTED)


def test_a_hidden_sheet_is_passed_over(tmp_path: Path) -> None:
    """The same workbook, its sheets in the other order, the empty one first and hidden."""
    pytest.importorskip("python_calamine")
    workbook(tmp_path / "t.xlsx")
    with zipfile.ZipFile(tmp_path / "t.xlsx") as archive:
        parts = {name: archive.read(name).decode() for name in archive.namelist()}
    one, two = '<sheet name="one" sheetId="1" r:id="a"/>', '<sheet name="two" sheetId="2" r:id="b"/>'
    for attribute, found in (('state="hidden" ', VALUES), ("", None)):
        swapped = two.replace("sheetId", f"{attribute}sheetId") + one
        with zipfile.ZipFile(tmp_path / "u.xlsx", "w") as archive:
            for name, content in parts.items():
                archive.writestr(name, content.replace(one + two, swapped))
        if found:
            assert read_points(tmp_path / "u.xlsx", WANTED).values == found
        else:
            with pytest.raises(WrongInput):
                read_points(tmp_path / "u.xlsx", WANTED)


def test_a_spreadsheet_names_the_extra_that_reads_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras, "installed", lambda library: False)
    workbook(tmp_path / "t.xlsx")
    with pytest.raises(WrongInput, match=r"needs python_calamine.*'ncgear\[tables\]' installs it"):
        read_points(tmp_path / "t.xlsx", WANTED)


def test_a_design_takes_its_law_and_its_resistance_from_tables_of_a_spreadsheet_s_csv(tmp_path: Path) -> None:
    (tmp_path / "force.csv").write_bytes(b"Weg;displacement [mm];Force (N)\r\n1;0;0\r\n2;40;12,5\r\n3;80;25\r\n")
    (tmp_path / "d.yaml").write_text(
        "name: d\nlinkage: {crank_mm: 40, rod_mm: 150}\noperation: {speed_rpm: 60}\nmotion: {law: uniform_crank}\n"
        "resistance: {table: {file: force.csv}}\n"
    )
    table = load(tmp_path / "d.yaml").design.resistance.table
    assert (table.displacement_mm, table.force_n) == ((0.0, 40.0, 80.0), (0.0, 12.5, 25.0))


def test_a_decimal_comma_in_a_design_is_named(tmp_path: Path) -> None:
    (tmp_path / "d.yaml").write_text(
        "name: d\nlinkage: {crank_mm: 40, rod_mm: 150}\noperation:\n  speed_rpm: 60,5\nmotion: {law: uniform_crank}\n"
    )
    with pytest.raises(WrongInput, match="'60,5' given; a number is needed, with a decimal point in"):
        load(tmp_path / "d.yaml")
