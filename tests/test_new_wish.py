"""A kind of wish is what ``docs/house.md`` says: its value, its keys, one line; then nothing ignores it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from math import acos, degrees, pi
from pathlib import Path

import pytest

from commands import ROOT

pytestmark = [pytest.mark.judges("wishes"), pytest.mark.slow]

VALUE = '''"""Half of the way by a driving angle."""

from __future__ import annotations

from math import degrees

from ncgear.frozen import dataclass
from ncgear.kinematics.crank_stretches import CrankStretch, crank_at_way_rad
from ncgear.kinematics.motion import Machine
from ncgear.kinematics.crank_stretches import taken_rad
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.wishes.requirements import Requirement, TimeWithin
from ncgear.wishes.wish import DEGREES, Offer, Outcome, Wish, Written


@dataclass(frozen=True, kw_only=True)
class Halfway(Wish):
    by_rad: float

    def stretch(self, linkage: Mechanism) -> CrankStretch:
        return CrankStretch(0.0, crank_at_way_rad(linkage, linkage.stroke_mm / 2.0))

    def requirements(self, linkage: Mechanism, cycle_rad: float) -> tuple[Requirement, ...]:
        return (TimeWithin(self.stretch(linkage), most_rad=self.by_rad),)

    def outcome(self, machine: Machine) -> Outcome:
        return self.judged(DEGREES, taken_rad(machine, self.stretch(machine.linkage)), most=self.by_rad)

    def words(self, place: Written, angle: Written) -> str:
        return "half of the way"

    def offer(self, asked: Requirement, missed: float, cycle_rad: float) -> Offer:
        number = f"{degrees(self.by_rad + missed):.4g}"
        return self.eased(f"half of the way by {number} deg", by_deg=number)
'''

KEYS = '''"""The keys of half of the way."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ncgear.design.keys.base import angle
from ncgear.design.keys.base import Positive
from ncgear.design.wishes.base import On, WishKeys

if TYPE_CHECKING:
    from ncgear.wishes.wish import Wish


class Halfway(WishKeys):
    """Half of the way by a driving angle."""

    KIND = "halfway"
    MEANING = "driving angle by which half of the way is gone; left out: free"
    SEVERAL = False
    ANGLES = (("by", "passed_rad"),)

    passed_rad: float = angle("driving angle {unit}", "by", needed=True, of=Positive)

    def value(self, on: On, **common: Any) -> Wish:
        from ncgear.wishes.halfway import Halfway as Value

        return Value(by_rad=self.passed_rad, **common)
'''

ASKED = """
import json
from pathlib import Path
from ncgear.design.reading.design_file import load
from ncgear.optimum.makeable.demanded import certified_limit, demands_of
from ncgear.optimum.makeable.search import scales
from ncgear.optimum.makeable.wishes import levels
from ncgear.project.law_task import inertia_as_given, task_of, wishes_of

design = load(Path("d.yaml")).design
task, wishes = task_of(design, inertia_as_given(design)), wishes_of(design)
[level] = [one for one in levels(wishes, scales(task)) if one.key == "wishes.halfway"]
[demand] = demands_of(task, wishes).wishes
print(json.dumps([level.limit, level.shown(0.1).values, demand.shown(1.6).said, certified_limit(task, wishes).value]))
"""

DESIGN = """name: d
linkage: {crank_mm: 50, rod_mm: 200}
operation: {speed_rpm: 45}
motion: {law: uniform_crank}
wishes: {halfway: {by_deg: BY}}
optimize: {goal: least_acceleration, limits: {ratio_min: 0.5, ratio_max: 2.5}}
"""


class Package:
    """A copy of the package with the new kind, with its line in the registry or without."""

    def __init__(self, folder: Path, *, line: bool) -> None:
        self.folder = folder
        made = folder / "source" / "ncgear"
        shutil.copytree(ROOT / "src" / "ncgear", made, ignore=shutil.ignore_patterns("__pycache__"))
        (made / "wishes" / "halfway.py").write_text(VALUE, encoding="utf-8")
        (made / "design" / "wishes" / "halfway.py").write_text(KEYS, encoding="utf-8")
        registry = made / "design" / "wishes" / "registry.py"
        text = registry.read_text(encoding="utf-8")
        text = text.replace(
            "import GentleStop\n", "import GentleStop\nfrom ncgear.design.wishes.halfway import Halfway\n"
        )
        if line:
            registry.write_text(text.replace("    GentleStop,\n", "    GentleStop,\n    Halfway,\n"), encoding="utf-8")

    def run(self, *arguments: str, by: float = 60.0) -> subprocess.CompletedProcess[str]:
        """Python on a design with the wish, which is d.yaml."""
        (self.folder / "d.yaml").write_text(DESIGN.replace("BY", f"{by:g}"), encoding="utf-8")
        variables = {**os.environ, "PYTHONPATH": str(self.folder / "source")}
        command = [sys.executable, *arguments]
        return subprocess.run(command, cwd=self.folder, env=variables, capture_output=True, text=True, timeout=300)


def test_a_new_kind_is_read_judged_told_and_asked_of_a_law(tmp_path: Path) -> None:
    package = Package(tmp_path, line=True)
    # Read, and refused where no motion can do it
    refused = package.run("-m", "ncgear", "check", "d.yaml", by=400.0)
    assert refused.returncode == 2
    assert "wishes.halfway.by_deg: 400 given, but a cycle takes 360 deg" in refused.stderr
    assert '"halfway"' in package.run("-m", "ncgear", "schema").stdout
    # Judged and told
    told = package.run("-m", "ncgear", "check", "d.yaml").stdout
    # An even crank of r is half-way where the rod l ends at l from its axis: r / 2l is the cosine of what is left
    half = degrees(pi - acos(50.0 / (2.0 * 200.0)))
    assert f"missed: half of the way: {half:.2f} deg, at most 60 deg wished, missed by {half - 60.0:.1f} deg" in told
    assert "1 of 1 wishes missed" in told
    assert "kept: half of the way" in package.run("-m", "ncgear", "check", "d.yaml", by=100.0).stdout
    # Asked of laws that are looked for, and of the limit that no law goes below: it costs acceleration
    tight, loose = (json.loads(package.run("-c", ASKED, by=by).stdout) for by in (60.0, 100.0))
    assert tight[0] == 0.0
    assert tight[1] == [["wishes.halfway.by_deg", pytest.approx(65.73)]]
    assert tight[2] == "half of the way by 91.67 deg"
    assert tight[3] > 1.2 * loose[3]


def test_without_its_line_it_is_no_key(tmp_path: Path) -> None:
    refused = Package(tmp_path, line=False).run("-m", "ncgear", "check", "d.yaml")
    assert refused.returncode == 2
    assert "wishes.halfway" in refused.stderr
