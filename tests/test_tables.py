"""Tables as aligned text, as Markdown, and as the cells of HTML."""

from __future__ import annotations

from ncgear.figures.tables import Column, Table, aligned, cell_text, markdown, markdown_text


def test_columns_are_as_wide_as_their_widest_text() -> None:
    rows = [["", "power", "speed"], ["crank", "1234567", "1"], ["rod", "1", "22"]]
    assert aligned(rows, left=1) == [
        "           power  speed",
        "  crank  1234567      1",
        "  rod          1     22",
    ]


def test_columns_have_a_least_width_and_no_blanks_at_the_end() -> None:
    assert aligned([["a", "1"], ["b", ""]], left=2, least=3, indent="") == ["a    1", "b"]
    assert aligned([["a", "1"]], least=(0, 4), indent="") == ["a     1"]
    assert aligned([]) == []


def test_markdown_has_a_rule_below_its_heads() -> None:
    assert markdown(("key", "unit"), [("a", "mm")]) == ["| key | unit |", "|---|---|", "| a | mm |"]


def test_text_in_markdown_stays_text() -> None:
    assert markdown_text("a|b\n<i>") == r"a\|b \<i>"
    assert markdown_text(None) == ""


def test_numbers_are_read_to_the_decimals_of_their_unit_on_a_drawing() -> None:
    assert [cell_text(value) for value in (1.0 / 3.0, 12345678, True, None)] == ["0.33333", "12345678", "True", ""]
    assert [cell_text(value, "mm") for value in (74.88525421, 3.0, -3e-12, 120.0)] == ["74.8853", "3", "0", "120"]
    assert [cell_text(value, "deg") for value in (5.2434836, -7.1e-14)] == ["5.24348", "0"]


def test_the_second_cell_of_a_short_row_fills_the_columns_that_are_missing() -> None:
    columns = Column("", ""), Column("driving"), Column("driven"), Column("", "")
    table = Table("Sizes", columns, (("module", 2.0, "mm"), ("teeth", 25, 25, "")), row_notes=("as given", ""))
    assert [(row.cells, row.span, row.note) for row in table.html_rows] == [
        (("module", "2", "mm"), 2, "as given"),
        (("teeth", "25", "25", ""), 1, ""),
    ]
    assert Column("span", "mm").heading == "span in mm"
