"""The plan of the house, held against the code: who may import whom, and what a command must not load."""

from __future__ import annotations

import ast
import re
import subprocess
from pathlib import Path

import networkx
import pytest

from at_once import at_once
from commands import ROOT, loaded_by, modules_after
from drives import loaded
from every_command import completing
from ncgear import shown
from ncgear.figures.summary.check_summary import check_summary
from ncgear.figures.terminal import figures_text
from ncgear.project.drive import Drive

SOURCE = ROOT / "src" / "ncgear"

LAYERS = [
    {"errors", "extras", "frozen", "interrupts", "memory", "shown", "workers", "numerics"},
    {"mechanisms"},
    {"ratio"},
    {"kinematics"},
    {"wishes"},
    {"pitch"},
    {"teeth"},
    {"contact", "metrology"},
    {"solids"},
    {"trains"},
    {"dynamics"},
    {"optimum"},
    {"balance", "strength", "drivetrain", "tolerances", "formulas"},
    {"papers"},
    {"design"},
    {"project"},
    {"screening"},
    {"figures"},
    {"whole_machines"},
    {"drawings"},
    {"files"},
    {"studio"},
    {"cli", "plots", "cad"},
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
            parts = (f"{node.module}.{alias.name}" for alias in node.names)
            names.update(part for part in parts if (SOURCE.parent / f"{part.replace('.', '/')}.py").exists())
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


@pytest.mark.slow
def test_imports_go_down_only() -> None:
    assert upward_imports(package_imports()) == []


def test_an_import_that_goes_up_is_seen() -> None:
    assert upward_imports({"numerics": {"ncgear.teeth.flank"}}) == ["numerics imports ncgear.teeth.flank"]


@pytest.mark.slow
def test_every_room_has_a_layer() -> None:
    assert set(package_imports()) == set(HEIGHT)


DOORS = {"ncgear.drawings.notebook.values": ["shown.py"]}
"""Modules that are imported by their names in text, and what does so: values reach what draws them in a notebook."""


@pytest.mark.thorough
def test_the_only_door_upwards_is_that_of_notebooks() -> None:
    """An import by a name in text escapes the test above; ``__init__`` says where public names live."""
    named: dict[str, list[str]] = {}
    for path in SOURCE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if "import_module" in text and path != SOURCE / "__init__.py":
            for name in re.findall(r'"(ncgear\.[\w.]+)"', text):
                named.setdefault(name, []).append(str(path.relative_to(SOURCE)))
    assert named == DOORS
    assert shown.DRAWER in DOORS


def circles(files: dict[str, set[str]]) -> list[list[str]]:
    """Modules that import each other in a circle, from each module to those that it imports."""
    graph = networkx.DiGraph([(module, name) for module, names in files.items() for name in names if name in files])
    return [sorted(circle) for circle in networkx.strongly_connected_components(graph) if len(circle) > 1]


def modules() -> dict[str, set[str]]:
    """Every module of the package and those that it imports anywhere, for types too."""
    paths = [path for path in SOURCE.rglob("*.py") if path.name != "__init__.py"]
    return {".".join(path.relative_to(SOURCE.parent).with_suffix("").parts): imports_of(path) for path in paths}


@pytest.mark.slow
def test_no_modules_import_each_other_in_a_circle() -> None:
    assert circles(modules()) == []


def test_a_circle_is_seen() -> None:
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}) == [["a", "b", "c"]]


def twice_named(found: dict[Path, str]) -> set[str]:
    """Public classes of one name; the keys of a design file may have the name of the value that is made from them."""
    rooms: dict[str, list[bool]] = {}
    for path, text in found.items():
        for name in re.findall(r"^class ([A-Za-z]\w*)", text, flags=re.MULTILINE):
            rooms.setdefault(name, []).append("design" in path.parts)
    return {name for name, of_keys in rooms.items() if of_keys.count(True) > 1 or of_keys.count(False) > 1}


def test_a_name_of_a_class_means_one_thing() -> None:
    assert not twice_named({path.relative_to(SOURCE): path.read_text() for path in SOURCE.rglob("*.py")})


def test_a_second_meaning_of_a_name_is_seen() -> None:
    keys, value, other = (Path(room) / "a.py" for room in ("design", "ratio", "pitch"))
    text = "class Law: ..."
    assert not twice_named({keys: text, value: text})
    assert twice_named({keys: text, value: text, other: text}) == {"Law"}


def test_no_file_gives_a_constant_twice() -> None:
    """What was written for the first value would take the second."""
    twice = []
    for file in [*SOURCE.rglob("*.py"), *(ROOT / "tests").glob("*.py")]:
        names = re.findall(r"^([A-Z]\w+)(?:: .+)? = ", file.read_text(encoding="utf-8"), re.MULTILINE)
        twice += [f"{file.name}: {name}" for name in {*names} if names.count(name) > 1]
    assert twice == []


def test_the_page_of_the_house_has_every_room_in_order() -> None:
    """A room's place in docs/house.md is not above that of a room which it may import."""
    page = (ROOT / "docs" / "house.md").read_text(encoding="utf-8")
    told = re.findall(r"^\| `(\w+)/` \|", page, flags=re.MULTILINE)
    folders = {path.name for path in SOURCE.iterdir() if (path / "__init__.py").exists()}
    assert set(told) == folders
    assert [HEIGHT[room] for room in told] == sorted(HEIGHT[room] for room in told)


WRITES = {"write_bytes", "write_text", "write", "savetxt", "tofile", "export"}

WRITERS = {
    "files/one_file.py",
    "project/frontier_run.py",
    "files/train.py",
    "files/workshop/dxf.py",
    "files/workshop/solid_files.py",
    "drawings/solid_pair.py",
    "studio/chains.py",
    "studio/server.py",
    "studio/worker.py",
}
"""What may write files: whole sets of files; a new design file, of which the path is free; lines of finished points;
the temporary file that leads a browser to the studio.  And what calls the same of a library, for a text in memory, or
of a pipe between two processes."""


def writes_to_paths(text: str) -> bool:
    """Whether a module calls what writes files."""
    calls = [node.func for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    return any(isinstance(call, ast.Attribute) and call.attr in WRITES for call in calls)


@pytest.mark.slow
def test_files_are_written_in_few_places() -> None:
    assert writes_to_paths("path.write_text(text)")
    found = {str(path.relative_to(SOURCE)) for path in SOURCE.rglob("*.py") if writes_to_paths(path.read_text())}
    assert found == WRITERS


SOLVERS = {"sympy", "scipy", "casadi", "clarabel"}
LIBRARIES = SOLVERS | {
    "trimesh",
    "matplotlib",
    "shapely",
    "mapbox_earcut",
    "networkx",
    "ezdxf",
    "lxml",
    "jinja2",
    "OCP",
    "skfem",
}
"""Every solver and algebra; meshes, plots, planes, drawings, pages, exact solids."""


@pytest.mark.slow
def test_help_loads_no_library_at_all() -> None:
    assert loaded_by("--help") & (LIBRARIES | {"numpy", "pydantic", "ruamel", "rich"}) == set()


@pytest.mark.tiers(slow=["baler", "ellipse"], rest="long")
@pytest.mark.parametrize("name", ["baler", "baler-66", "ellipse", "uniform-crank"])
def test_a_check_loads_neither_meshes_nor_plots_nor_solvers(name: str) -> None:
    assert loaded_by("check", f"designs/{name}.yaml") & LIBRARIES == set()


@pytest.mark.slow
def test_only_formulas_load_algebra() -> None:
    """And these are loaded where they are asked for."""
    loading = {
        path.relative_to(SOURCE).parts[0]
        for path in SOURCE.rglob("*.py")
        if re.search(r"^ *(import|from) (sympy|mpmath)\b", path.read_text(encoding="utf-8"), re.MULTILINE)
    }
    assert loading == {"formulas"}
    assert modules_after("import ncgear.project.drive, ncgear.cli.app") & {"sympy", "mpmath"} == set()


@pytest.mark.slow
def test_a_check_of_a_table_loads_splines_and_nothing_more() -> None:
    """So the list above can be failed by what a design needs."""
    assert loaded_by("check", "designs/feeder-table.yaml") & LIBRARIES == {"scipy"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments", [("explain", "gears.module_mm"), ("explain", "--of", "balance"), ("new", "mine")], ids=" ".join
)
def test_what_looks_up_and_begins_loads_no_library_at_all(arguments: tuple[str, ...], tmp_path: Path) -> None:
    """Nor do completions, which read the same table of keys: pydantic alone takes as long as all of it."""
    assert loaded_by(*arguments, folder=tmp_path) & (LIBRARIES | {"numpy", "pydantic", "ruamel", "rich"}) == set()


@pytest.mark.slow
def test_completion_loads_no_library_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in completing("ncgear explain gears.").items():
        monkeypatch.setenv(name, value)
    assert loaded_by() & (LIBRARIES | {"numpy", "pydantic", "ruamel", "rich"}) == set()


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("command", ["build", "report"])
def test_a_build_leaves_plots_to_a_second_process(command: str, tmp_path: Path) -> None:
    free = "import ncgear.drawings.beside\nncgear.drawings.beside.free_cores = lambda: 2\n"
    loaded = loaded_by(command, "designs/baler.yaml", "--out", str(tmp_path), before=free)
    assert loaded & {"matplotlib", "sympy", "casadi", "clarabel", "OCP", "skfem"} == set()


@pytest.mark.slow
def test_a_sweep_loads_plots_for_its_pictures_and_neither_meshes_nor_solvers(tmp_path: Path) -> None:
    vary = ["--vary", "motion.v1_mm_s=1600:1610:2", "--out", str(tmp_path)]
    assert loaded_by("sweep", "designs/baler.yaml", *vary) & LIBRARIES == {"matplotlib"}


VALUES = ("law", "machine", "check", "uniform_check", "pitch", "teeth", "designed_contact", "solids", "motion")
"""Of a drive; each is computed when it is first asked for."""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ellipse", "baler"])
def test_a_check_makes_no_tooth(name: str) -> None:
    """It judges pitch curves, and strength roughly."""
    drive = Drive(loaded(name).design)
    figures_text(check_summary(drive))
    made = [value for value in VALUES if value in vars(drive)]
    assert made == ["law", "machine", "check", "uniform_check", "pitch"]


@at_once("name", [name for name in VALUES if name != "solids"])
def test_asking_twice_for_a_value_computes_once(name: str) -> None:
    drive = Drive(loaded("ellipse").design)
    first = getattr(drive, name)
    counts = dict(drive.timing_s)
    assert getattr(drive, name) is first
    assert drive.timing_s == counts


@pytest.mark.slow
def test_nothing_is_lost_where_python_leaves_assertions_out() -> None:
    """``python -O`` skips them: they may tell a type checker what is known, and must not be what checks the teeth."""
    stated = [
        (path.relative_to(SOURCE), node.lineno)
        for path in SOURCE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Assert) and not _tells_a_type(node.test)
    ]
    assert stated == []


def _tells_a_type(test: ast.expr) -> bool:
    """``... is not None``, ``isinstance(...)``, or ``not isinstance(...)``."""
    text = ast.unparse(test)
    return text.endswith(" is not None") or text.removeprefix("not ").startswith("isinstance(")


@pytest.mark.parametrize("word", ["/work", "/root", "/home"])
def test_no_path_of_one_machine_is_in_the_tree(word: str) -> None:
    tracked = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True, cwd=ROOT).stdout.split()
    texts = [ROOT / name for name in tracked if Path(name).suffix in {".py", ".md", ".toml", ".yaml", ".csv", ""}]
    naming = [path.name for path in texts if path != Path(__file__) and f"{word}/" in path.read_text(encoding="utf-8")]
    assert naming == []
