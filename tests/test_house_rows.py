"""The rows of "Where to go for a change" in docs/house.md, proven by doing.

The program is copied, a dummy of a kind is added by files that its row names, and the copy runs in its own process.
One file less, and the dummy is unknown, or the copy says what is missing.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands import ROOT, new_folder
from drives import drive
from ncgear.figures.summary.check_summary import check_summary

SOURCE = ROOT / "src" / "ncgear"
TOLD_KEYS = "design/told_keys.json"
EVEN, YOKE = "uniform-crank", "scotch-yoke-pump"


@dataclass(frozen=True, eq=False)
class Dummy:
    """What is added for a change: new files by their text, and in old files what is put before which line."""

    change: str
    new: Mapping[str, str] = field(default_factory=dict)
    lines: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    made: bool = False
    """Whether ``make docs`` belongs to it, which writes the keys in words."""

    @property
    def files(self) -> list[str]:
        """All of them."""
        return [*self.new, *self.lines, *([TOLD_KEYS] if self.made else [])]


class Copy:
    """The program with a dummy, ``without`` one of the dummy's files."""

    def __init__(self, dummy: Dummy, without: str = "") -> None:
        self.folder, self.without = new_folder(), without
        package = self.folder / "src" / "ncgear"
        shutil.copytree(SOURCE, package)
        for name, text in dummy.new.items():
            assert not (package / name).exists()
            if name != without:
                (package / name).write_text(text, encoding="utf-8")
        for name, added in dummy.lines.items():
            if name != without:
                put(package / name, added)

    def run(self, *arguments: str) -> str:
        """What a command of the copy says; raises AssertionError with its message where it refuses."""
        return self.python("-m", "ncgear", *arguments)

    def figures(self, command: str, text: str, *arguments: str) -> Any:
        """What a command tells of a design for programs."""
        return json.loads(self.run(command, self.design(text), *arguments, "--json"))

    def design(self, text: str) -> str:
        """A design file."""
        (self.folder / "d.yaml").write_text(text, encoding="utf-8")
        return "d.yaml"

    def explained(self, key: str) -> str:
        """What is told of a key, after ``make docs``."""
        if self.without != TOLD_KEYS:
            told = self.python("-c", "from made.__main__ import told_keys_text as text; print(text(), end='')")
            (self.folder / "src" / "ncgear" / TOLD_KEYS).write_text(told, encoding="utf-8")
        return self.run("explain", key)

    def python(self, *arguments: str) -> str:
        """What Python says in the copy; raises AssertionError where it fails."""
        paths = os.pathsep.join(map(str, (self.folder / "src", ROOT / "docs")))
        # All that is not changed is compiled once.
        environment = {**os.environ, "PYTHONPATH": paths, "PYTHONDONTWRITEBYTECODE": ""}
        done = subprocess.run(
            [sys.executable, *arguments], cwd=self.folder, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        return done.stdout


def put(path: Path, added: Mapping[str, str]) -> None:
    """Put texts before the lines that begin as said."""
    text = path.read_text(encoding="utf-8")
    for line, more in added.items():
        assert text.count(f"\n{line}") == 1, (path, line)
        text = text.replace(f"\n{line}", f"\n{more}\n{line}")
    path.write_text(text, encoding="utf-8")


def with_sections(name: str, **sections: str) -> str:
    """The text of a worked design with other sections."""
    text = (ROOT / "designs" / f"{name}.yaml").read_text(encoding="utf-8")
    for key, section in sections.items():
        text = re.sub(rf"^{key}:.*\n(?:[ #].*\n)*", "", text, flags=re.MULTILINE) + f"\n{key}: {section}\n"
    return text


LAW = Dummy(
    "a motion law",
    {
        "ratio/laws/dummy.py": '''\
"""phi2 = (x - swing sin x) / n2, x = n1 phi1."""

from functools import partial

from ncgear.numerics import jet
from ncgear.numerics.jet import Jet
from ncgear.ratio.transmission import Piece, Transmission


def swung_law(swing, lobes):
    return Transmission((Piece(0.0, lobes.driving_period_rad, partial(swung_angle, swing, lobes)),), lobes)


def swung_angle(swing, lobes, phi1, order):
    around = Jet.variable(phi1, order) * float(lobes.driving)
    return (around - swing * jet.sin_cos(around)[0]) * (1.0 / lobes.driven)
''',
        "design/laws/dummy.py": '''\
from ncgear.design.keys.base import required
from ncgear.design.laws.base import Begins, LawKeys


class Dummy(LawKeys):
    """A swing about an even ratio."""

    CHOICE = "a swing about an even ratio"
    BEGINS = Begins.FORMULA
    swing: float = required("swing of the inverse ratio, 0 to under 1", ge=0.0, lt=1.0)

    def transmission(self, linkage, lobes):
        from ncgear.ratio.laws.dummy import swung_law

        return swung_law(self.swing, lobes)
''',
        "design/templates/laws/dummy.yaml": "motion:                    # a swing\n  law: dummy\n  swing: 0.25\n",
    },
    {
        "design/laws/registry.py": {"    SPIRAL =": '    DUMMY = "dummy"'},
        "formulas/laws.py": {
            "from ncgear.ratio.laws.harmonic ": "from ncgear.ratio.laws.dummy import swung_angle",
            "def _spiral(": """\
def _swung(piece, swing, lobes):
    write = FormulaWriter("phi_1")
    x = lobes.driving * write.variable
    write.step("phi_2", (x - write.number("swing", swing) * sympy.sin(x)) / lobes.driven)
    yield PiecePart("swing", _ends(piece), write)

""",
            "    spiral.spiral_angle:": "    swung_angle: _swung,",
        },
    },
    made=True,
)

MECHANISM = Dummy(
    "a mechanism",
    {
        "mechanisms/dummy.py": '''\
"""A Scotch yoke with a bob on its slider."""

from dataclasses import replace
from typing import ClassVar

from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import Masses
from ncgear.mechanisms.scotch_yoke import ScotchYoke


@dataclass(frozen=True)
class BobMasses(Masses):
    bob_kg: float = 0.0


@dataclass(frozen=True)
class Dummy(ScotchYoke):
    NAME: ClassVar[str] = "a dummy"
    POINTS: ClassVar[tuple[str, ...]] = ("slider", "bob")
    MASSES: ClassVar[type[Masses]] = BobMasses

    def moving_masses(self, crank_angle, masses):
        return super().moving_masses(crank_angle, whole(masses))

    def joint_forces(self, crank_angle, masses, pace, resistance_n):
        return super().joint_forces(crank_angle, whole(masses), pace, resistance_n)


def whole(masses):
    return replace(masses, slider_kg=masses.slider_kg + masses.bob_kg)
''',
    },
    {
        "design/keys/machine.py": {"class RockerKeys(": "class DummyKeys(CrankKeys):\n    pass\n\n"},
        "design/keys/masses.py": {
            "class Masses(": """\
class DummyMasses(ShaftMasses, first=True):
    slider_kg: Mass = required(SLIDER)
    bob_kg: Mass = required("mass of a dummy's bob in kg")

"""
        },
        "design/mechanisms.py": {
            "from ncgear.errors ": "from ncgear.design.keys.machine import DummyKeys\n"
            "from ncgear.design.keys.masses import DummyMasses",
            '    "crank_rocker":': '    "dummy": MechanismEntry("dummy", DummyKeys, DummyMasses),',
        },
        "formulas/linkages.py": {
            "from ncgear.mechanisms.mechanism ": "from ncgear.mechanisms.dummy import Dummy",
            "    ScotchYoke:": "    Dummy: (_yoke, _yoke_angle),",
        },
    },
    made=True,
)

MATERIAL = Dummy(
    "a material",
    lines={
        "strength/materials.py": {
            '    Ferrous("E335",': '    Ferrous("Dummy", "a nodular iron", NODULAR, 200.0, STEEL),'
        }
    },
    made=True,
)

FORMAT = Dummy(
    "a file format",
    {
        "files/workshop/dummy.py": '''\
import numpy as np

from ncgear.files.workshop.drawing import Use


def dummy_files(shown):
    """The first chain of each gear's outline as text."""
    return {f"{one.name}.dummy": text(one) for one in (shown.driving, shown.driven)}


def text(drawing):
    (chain,) = next(shapes for layer, shapes in drawing.layers.items() if layer.name == "OUTLINE")
    return "\\n".join(f"{x!r} {y!r} {b!r}" for (x, y), b in zip(chain.points.tolist(), chain.bulges.tolist())).encode()
'''
    },
    {
        "files/workshop/formats.py": {
            "    STEP =": '    DUMMY = "dummy"',
            "    Format.STEP:": "    Format.DUMMY: _drawn("
            '"dummy:dummy_files", ("driving.dummy", "driven.dummy"), "outline_of_dummy"),',
        },
        "files/read_back.py": {
            "def flattened(": """\
def outline_of_dummy(data):
    rows = np.loadtxt(data.decode().splitlines())
    return flattened(rows[:, :2], rows[:, 2])

"""
        },
    },
)

FIGURE = Dummy(
    "a figure that several commands tell",
    lines={
        "kinematics/check.py": {
            '    "energy_swing_j": lambda': '    "dummy_j": lambda found: 2.0 * found.energy_swing_j,',
        }
    },
)

CONDITION = Dummy(
    "a condition that a machine has to keep",
    {
        "figures/advice/dummy_advice.py": """\
from ncgear.figures.advice.values import Advice, Kind


def quick(drive):
    rpm = drive.design.operation.speed_rpm
    if rpm > 100.0:
        return Advice(Kind.DUMMY, f"{rpm:g} r/min", "over 100")
"""
    },
    {
        "figures/advice/values.py": {"    SPEEDS =": '    DUMMY = "dummy"'},
        "figures/advice/verdict.py": {
            "from ncgear.figures.advice.values ": "from ncgear.figures.advice import dummy_advice",
            "    Kind.SPEEDS:": "    Kind.DUMMY: Condition("
            '"slowness", "it is slow", dummy_advice.quick, concerns=_always, of_pair=False),',
        },
    },
)

CHART = Dummy(
    "a chart",
    lines={
        "drawings/charts/teeth_charts.py": {
            "def sliding(": """\
def dummy(designed):
    line = ChartLine(Role.OWN, "as designed", _angle_deg(designed), np.ones(designed.placement.phi1_rad.size))
    return Chart("dummy", "", (line,), _cycle_deg(designed))

"""
        },
        "drawings/pictures.py": {
            "    if np.max(np.abs(designed.backlash_rad))": "    kinds.append(teeth_charts.dummy)"
        },
        "plots.py": {
            "def sliding(": "def dummy(drive, axes=None):\n"
            "    return _drawn(teeth_charts.dummy(drive.designed_contact), CONTACT_LOOK, axes)\n\n"
        },
        "drawings/page/page_charts.py": {
            "    charts = {chart.name.replace(": "    found = (*found, teeth_charts.dummy(drive.designed_contact))"
        },
    },
)

COMMAND = Dummy(
    "a command",
    {
        "cli/dummy.py": '''\
import typer


def dummy() -> None:
    """Say that it is a dummy."""
    typer.echo("a dummy")
'''
    },
    {"cli/app.py": {"from ncgear.cli.study ": "from ncgear.cli.dummy import dummy", "    balance,": "    dummy,"}},
)


def law_works(copy: Copy) -> None:
    ratio = copy.figures("check", with_sections(EVEN, motion="{law: dummy, swing: 0.25}"))["ratio"]
    # 1/i12 = 1 - swing cos phi1
    assert (ratio["min"], ratio["max"]) == pytest.approx((1.0 / 1.25, 1.0 / 0.75), rel=1e-12)
    assert "phi_2 = phi_1 - swing*sin(phi_1)" in copy.run("formulas", "d.yaml")
    with pytest.raises(AssertionError, match=r"motion\.swing: .*under 1 is needed"):
        copy.run("check", copy.design(with_sections(EVEN, motion="{law: dummy, swing: 1.5}")))
    copy.run("new", "mine", "--law", "dummy")
    assert "law dummy" in copy.run("check", "mine.yaml")
    assert "swing of the inverse ratio, 0 to under 1" in copy.explained("motion.swing")


BOB = "bob_kg: 0.5, "


def mechanism_works(copy: Copy) -> None:
    masses = f"{{slider_kg: 1.0, {BOB}crank: {{mass_kg: 0.8, center_mm: 12, inertia_kg_mm2: 500}}}}"
    text = with_sections(YOKE, linkage="{kind: dummy, crank_mm: 40}", masses=masses)
    # The worked design has a slider of 1.5 kg.
    found, expected = copy.figures("check", text)["check"], check_summary(drive(YOKE))["check"]
    assert found.pop("uniform_crank") == pytest.approx(expected.pop("uniform_crank"), rel=1e-12)
    assert found == pytest.approx(expected, rel=1e-12)
    with pytest.raises(AssertionError, match=r"masses\.bob_kg: missing"):
        copy.run("check", copy.design(text.replace(BOB, "")))
    assert "x = 2*crank*sin(phi_2/2)**2" in copy.run("formulas", copy.design(text))
    assert "mass of a dummy's bob" in copy.explained("masses.bob_kg")


def material_works(copy: Copy) -> None:
    text = with_sections(YOKE).replace("42CrMo4", "{driving: Dummy, driven: GJS-600-3}")
    found = copy.figures("strength", text)
    assert found["driving"]["source"].startswith("ISO 6336-5:2016, table 1, class GGG, MQ at 200 HBW")
    endured = [found[gear]["contact_endured_mpa"] for gear in ("driving", "driven")]
    # sigma_Hlim of the class is 1.434 HBW + 211; the factors of both gears are nearly the same.
    assert endured[0] / endured[1] == pytest.approx((1.434 * 200 + 211) / (1.434 * 230 + 211), rel=0.002)
    assert "Dummy" in copy.explained("gears.material")


def format_works(copy: Copy) -> None:
    copy.run("build", copy.design(with_sections(EVEN)), "--format", "dummy", "--out", "out")
    built = copy.folder / "out"
    rows = np.loadtxt(built / "driving.dummy")
    # Tips of the circular gear: half of 40 teeth and of two addenda, module 5
    assert np.hypot(rows[:, 0], rows[:, 1]).max() == pytest.approx(105.0, abs=0.01)
    error_mm = json.loads((built / "summary.json").read_text(encoding="utf-8"))["files"]["dummy_outline_error_max_mm"]
    assert 0.0 < error_mm < 0.005


def figure_works(copy: Copy) -> None:
    text = with_sections(YOKE)
    twice = 2.0 * drive(YOKE).driving.energy_swing_j
    vary = ("--vary", "operation.speed_rpm=100,120", "--stage", "check", "--processes", "1", "--out", "out")
    (best, *_) = copy.figures("sweep", text, *vary)["best"].values()
    told = {
        "check": copy.figures("check", text)["check"]["dummy_j"],
        "simulate": copy.figures("simulate", text)["this_design"]["dummy_j"],
        "sweep": best[-1]["check.dummy_j"],
    }
    assert told == pytest.approx(dict.fromkeys(told, twice), rel=1e-6)


def condition_works(copy: Copy) -> None:
    text = with_sections(YOKE)
    rows = [one for one in copy.figures("check", text)["verdict"] if one["condition"] == "dummy"]
    assert [(one["verdict"], one["because"], one["says"]) for one in rows] == [("broken", "120 r/min", "it is slow")]
    assert "1 warning\n  120 r/min" in copy.run("check", "d.yaml")
    slower = copy.figures("check", with_sections(YOKE, operation="{speed_rpm: 90}"))["verdict"]
    assert [one["verdict"] for one in slower if one["condition"] == "dummy"] == ["kept"]


CHARTS = """
from pathlib import Path
from ncgear import load, plots
from ncgear.contact.written.as_written import Outlines
from ncgear.drawings.page.page_charts import gear_charts
from ncgear.drawings.pictures import load_pictures

drive = load("d.yaml")
contact = drive.contact([Outlines("csv", drive.teeth.driving.outline_mm, drive.teeth.driven.outline_mm)])
assert "dummy" in [one.name for one in load_pictures(drive, contact)[1]], "no picture"
assert "dummy" in [one.key for one in gear_charts(drive, contact)], "not on the page"
plots.dummy(drive)
"""


def chart_works(copy: Copy) -> None:
    copy.design(with_sections(EVEN))
    copy.python("-c", CHARTS)


def command_works(copy: Copy) -> None:
    assert copy.run("dummy") == "a dummy\n"
    assert re.search("dummy +Say that it is a dummy", copy.run("--help"))


WORKS = {
    LAW: law_works,
    MECHANISM: mechanism_works,
    MATERIAL: material_works,
    FORMAT: format_works,
    FIGURE: figure_works,
    CONDITION: condition_works,
    CHART: chart_works,
    COMMAND: command_works,
}
EVERY = pytest.mark.parametrize("dummy", WORKS, ids=lambda dummy: dummy.change)


def named_in_row(change: str) -> list[str]:
    """The paths that a row of the table names, with what ``make docs`` makes of the package."""
    page = (ROOT / "docs" / "house.md").read_text(encoding="utf-8")
    (row,) = re.findall(rf"^\| {change} \| (.*) \|$", page, flags=re.MULTILINE)
    made = [TOLD_KEYS] if "make docs" in row else []
    return [*re.findall(r"`([\w/.]+)`", row), *made]


def forgotten(dummy: Dummy) -> list[str]:
    """The files of a dummy that its row does not name, neither by themselves nor by their folder."""
    named = set(named_in_row(dummy.change))
    return [one for one in dummy.files if not {one, f"{Path(one).parent}/"} & named]


@EVERY
def test_a_row_names_all_that_its_dummy_changes(dummy: Dummy) -> None:
    assert forgotten(dummy) == []


def test_a_file_that_a_row_forgets_is_seen() -> None:
    """Negative control: commands have no keys, and a material is no module of its own."""
    assert forgotten(Dummy("a command", {"cli/dummy.py": ""}, made=True)) == [TOLD_KEYS]
    assert forgotten(Dummy("a material", {"strength/dummy.py": ""})) == ["strength/dummy.py"]


@pytest.mark.tiers(slow=["a material", "a motion law"], rest="long")
@EVERY
def test_a_dummy_that_is_added_where_its_row_says_works(dummy: Dummy) -> None:
    WORKS[dummy](Copy(dummy))


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize(
    ("dummy", "without", "said"),
    [
        (LAW, "ratio/laws/dummy.py", "No module named 'ncgear.ratio.laws.dummy'"),
        (LAW, "design/laws/dummy.py", "No module named 'ncgear.design.laws.dummy'"),
        (LAW, "design/laws/registry.py", r"motion\.law: 'dummy' is no known law"),
        (LAW, "design/templates/laws/dummy.yaml", r"dummy\.yaml: No such file"),
        (LAW, "formulas/laws.py", "KeyError: <function swung_angle"),
        (LAW, TOLD_KEYS, r"motion\.swing: unknown key"),
        (MECHANISM, "mechanisms/dummy.py", "No module named 'ncgear.mechanisms.dummy'"),
        (MECHANISM, "design/keys/machine.py", "cannot import name 'DummyKeys'"),
        (MECHANISM, "design/keys/masses.py", "cannot import name 'DummyMasses'"),
        (MECHANISM, "design/mechanisms.py", r"linkage\.kind: 'dummy' given"),
        (MECHANISM, "formulas/linkages.py", "KeyError: <class 'ncgear.mechanisms.dummy.Dummy'>"),
        (MECHANISM, TOLD_KEYS, r"masses\.bob_kg: unknown key"),
        (MATERIAL, "strength/materials.py", r"gears\.material\.driving: Dummy is no material"),
        (MATERIAL, TOLD_KEYS, "assert 'Dummy' in"),
        (FORMAT, "files/workshop/dummy.py", "No module named 'ncgear.files.workshop.dummy'"),
        (FORMAT, "files/workshop/formats.py", "'dummy' is not one of"),
        (FORMAT, "files/read_back.py", "no attribute 'outline_of_dummy'"),
        (CONDITION, "figures/advice/dummy_advice.py", "cannot import name 'dummy_advice'"),
        (CONDITION, "figures/advice/values.py", "AttributeError: DUMMY"),
        # Told by no command: tests/test_verdict.py compares both lists.
        (CONDITION, "figures/advice/verdict.py", r"assert \[\] == "),
        (CHART, "drawings/charts/teeth_charts.py", "no attribute 'dummy'"),
        (CHART, "drawings/pictures.py", "no picture"),
        (CHART, "drawings/page/page_charts.py", "not on the page"),
        (CHART, "plots.py", "has no attribute 'dummy'"),
        (COMMAND, "cli/dummy.py", "No module named 'ncgear.cli.dummy'"),
        (COMMAND, "cli/app.py", "No such command 'dummy'"),
    ],
    ids=lambda value: value.change if isinstance(value, Dummy) else value,
)
def test_a_dummy_without_one_of_its_files_is_refused_or_unknown(dummy: Dummy, without: str, said: str) -> None:
    """Negative control: each file that a row names is needed."""
    assert without in dummy.files
    with pytest.raises(AssertionError, match=said):
        WORKS[dummy](Copy(dummy, without))
