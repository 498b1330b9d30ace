"""The plan of the house, held against the code: who may import whom, and what a command must not load."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "ncgear"

LAYERS = [
    {"errors", "extras", "stopwatch", "numerics"},
    {"machine"},
    {"ratio"},
    {"kinematics"},
    {"pitch"},
    {"teeth"},
    {"contact"},
    {"solids"},
    {"optimum", "dynamics"},
    {"balance"},
    {"ledger"},
    {"design"},
    {"recipe"},
    {"drive", "improvement", "frontier", "balancing"},
    {"output"},
    {"cli"},
    {"__main__"},
]
"""From the bottom up; a room may import from its own layer and from those below."""

HEIGHT = {room: height for height, rooms in enumerate(LAYERS) for room in rooms}


def room_of(module: str) -> str | None:
    """The room of a dotted module of the package; None for the package's own __init__."""
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else None


def imports_of(path: Path) -> set[str]:
    """Dotted names of the package's modules that a file imports, anywhere in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
        elif isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
    return {name for name in names if name.split(".")[0] == "ncgear"}


def upward_imports(files: dict[str, set[str]]) -> list[str]:
    """Imports that go up, from each room to the modules its files import."""
    return [
        f"{room} imports {name}"
        for room, names in files.items()
        for name in names
        if (target := room_of(name)) is not None and HEIGHT[target] > HEIGHT[room]
    ]


def package_imports() -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for path in SOURCE.rglob("*.py"):
        relative = path.relative_to(SOURCE)
        room = relative.parts[0].removesuffix(".py")
        if room != "__init__":
            found.setdefault(room, set()).update(imports_of(path))
    return found


def test_imports_go_down_only() -> None:
    assert upward_imports(package_imports()) == []


def test_an_import_that_goes_up_is_seen() -> None:
    assert upward_imports({"numerics": {"ncgear.teeth.flank"}}) == ["numerics imports ncgear.teeth.flank"]


def test_every_room_has_a_layer() -> None:
    assert set(package_imports()) == set(HEIGHT)


def modules_after(code: str) -> set[str]:
    """Top-level modules loaded by a fresh interpreter that has run ``code``."""
    script = f"import sys, json\n{code}\nsys.stderr.write(json.dumps(sorted({{m.split('.')[0] for m in sys.modules}})))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, cwd=ROOT)
    return set(json.loads(done.stderr))


CHECK = """
from pathlib import Path
from ncgear.design.load import load
from ncgear.drive import Drive
from ncgear.output.report import check_text
drive = Drive(load(Path('designs/baler.yaml')).design)
print(check_text(drive))
"""


def test_a_check_loads_neither_meshes_nor_plots_nor_algebra() -> None:
    assert modules_after(CHECK) & {"trimesh", "matplotlib", "sympy", "shapely"} == set()


def test_a_check_makes_no_pitch_curve_and_no_tooth() -> None:
    code = f"{CHECK}\nassert not {{'pitch', 'teeth', 'designed_contact', 'solids'}} & set(vars(drive)), vars(drive)"
    assert "numpy" in modules_after(code)


def test_a_stage_is_computed_once() -> None:
    code = f"{CHECK}\nassert drive.check is drive.check and drive.transmission is drive.transmission"
    assert modules_after(code)


@pytest.mark.parametrize("word", ["/work", "/root", "/home"])
def test_no_path_of_one_machine_is_in_the_tree(word: str) -> None:
    tracked = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True, cwd=ROOT).stdout.split()
    texts = [ROOT / name for name in tracked if Path(name).suffix in {".py", ".md", ".toml", ".yaml", ".csv", ""}]
    naming = [path.name for path in texts if path != Path(__file__) and f"{word}/" in path.read_text(encoding="utf-8")]
    assert naming == []
