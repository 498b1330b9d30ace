"""Reports of designs, made once for all tests of a process, and designs to report on."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from drives import drive, loaded
from ncgear.contact.pair import PairContact
from ncgear.design.reading.design_file import load
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.charts import motion_charts
from ncgear.drawings.page.page import report_page
from ncgear.figures.advice.verdict import together
from ncgear.files.build import contacts_as_written, verdicts_of
from ncgear.project.drive import Drive


@cache
def contacts(name: str) -> list[PairContact]:
    made = drive(name)
    return contacts_as_written(made, lambda step: None) if made.design.gears is not None else []


@cache
def motion(name: str) -> list[PageChart]:
    """Charts of the motion over one cycle of the slider."""
    return motion_charts(drive(name), drive(name).transmission.cycle_rad)


@cache
def page(name: str) -> str:
    return report_page(drive(name), loaded(name), contacts(name), together(verdicts_of(drive(name)))).decode()


def page_of(path: Path) -> str:
    """The report of a file without gears."""
    found = load(path)
    one = Drive(found.design)
    return report_page(one, found, [], together(verdicts_of(one))).decode()
