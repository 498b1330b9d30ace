"""The page of the studio as one file of HTML, and the first page of a studio without a file, with choices."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import partial
from importlib.resources import files
from itertools import count
from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

import ncgear
from ncgear import __version__
from ncgear.design.beginning import begun
from ncgear.design.laws.base import Begins
from ncgear.design.laws.registry import SOUGHT_LAW, LawName, law_keys
from ncgear.design.mechanisms import NO_LINKAGE
from ncgear.design.reading.design_file import LoadedDesign, as_it_is
from ncgear.design.rewritten import design_copy
from ncgear.design.template import CHOICES, SHAPES, MachineName, shape_template
from ncgear.drawings.page.assets import PACKAGE, hash_of, in_own_scope, page_style, shared_script
from ncgear.errors import WrongInput
from ncgear.files.one_file import put_at_free_place
from ncgear.frozen import dataclass
from ncgear.studio.editing import edited
from ncgear.studio.jobs import COMMANDS

WEB = "ncgear.studio.web"

SCRIPTS = ("link", "machine", "lines", "handles", "drawing", "board", "form", "told", "making", "saving", "studio")
"""Files of web/script/; each may use the files before it."""

VIEWS = ("machine", "gears", "mesh")


def page(file_name: str) -> tuple[str, str]:
    """The page and its content security policy: it runs only its own script, and talks only to its own server."""
    loader = ChoiceLoader([PackageLoader(WEB, ""), PackageLoader(PACKAGE, "")])
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined)
    script = in_own_scope(shared_script(), *(_asset(f"script/{name}.js") for name in SCRIPTS))
    content = environment.get_template("studio.html.j2").render(
        file_name=file_name,
        ncgear_version=__version__,
        commands=COMMANDS,
        views=VIEWS,
        gears=(("driving", "driving", 1), ("driven", "driven", 1)),
        cycle_deg=360,
        paces=(),
        css=Markup(page_style() + _asset("studio.css")),
        script=Markup(script),
    )
    policy = (
        f"default-src 'none'; script-src {hash_of(script)}; style-src 'unsafe-inline'; connect-src 'self'; "
        "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
    return content, policy


def start_page(folder: str, problem: str = "") -> tuple[str, str]:
    """The first page of a studio without a file, and its policy: no script, and its form goes to its own server."""
    environment = Environment(loader=PackageLoader(WEB, ""), autoescape=True, undefined=StrictUndefined)
    choices = beginnings()
    content = environment.get_template("start.html.j2").render(
        groups=[(group, [choice for choice in choices if choice.group == group]) for group in GROUPS],
        folder=folder,
        problem=problem,
        ncgear_version=__version__,
        css=Markup(page_style() + _asset("studio.css")),
    )
    policy = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'self'"
    return content, f"{policy}; frame-ancestors 'none'"


def _asset(name: str) -> str:
    return (files(WEB) / name).read_text(encoding="utf-8")


WISHES: dict[str, tuple[str, dict[str, Any]]] = {
    "even-speed": ("push or cut at constant speed", {"constant_speed": [{"from_mm": 60, "to_mm": 130}]}),
    "linger": ("linger at an end", {"dwell": [{"at": "extended", "within_mm": 1, "for_deg": 24}]}),
    "quick-return": ("come back quickly", {"time_ratio": {"at_least": 1.5}}),
    "slow-place": ("pass a place slowly", {"speed_at": [{"at_mm": 150, "make": "slowest", "hard": False}]}),
    "places": ("be at places at angles", {"positions": [{"at_mm": 80, "phi1_deg": 70, "tolerance_mm": 1}]}),
}
"""Wishes of a slider with a stroke of 200 mm, by the names of the designs that begin with them."""

GROUPS = ("A machine", "A wish", "A shape", "A formula or points", "A worked design")

SHIPPED = Path(ncgear.__file__).parents[2] / "designs"
"""The worked designs, beside the sources."""


@dataclass(frozen=True)
class Beginning:
    """A choice in a group: a name, which the new file gets, words for it, and a function from a name to a text."""

    group: str
    name: str
    words: str
    text: Callable[[str], str]

    @property
    def key(self) -> str:
        """The key of the choice among all choices; two groups may have a choice with the same name."""
        return f"{self.group}/{self.name}".lower().replace(" ", "-")


def beginnings() -> list[Beginning]:
    """All choices, group by group."""
    machine, wish, shape, formula, worked = GROUPS
    by_law = {
        Begins.MACHINE: (machine, _of_law),
        Begins.WISH: (wish, _of_law),
        Begins.SHAPE: (shape, _of_gears),
        Begins.FORMULA: (formula, _of_gears),
        Begins.POINTS: (formula, _of_law),
    }
    found = [
        *(
            Beginning(machine, name.value, CHOICES[name], partial(begun, beginning=name, answers={}))
            for name in MachineName
        ),
        *(_by_law(law, *by_law[law_keys(law).BEGINS]) for law in LawName),
        *(
            Beginning(shape, outline, f"a {outline} to print, and its mate", partial(_of_shape, outline))
            for outline in SHAPES
        ),
        *(Beginning(wish, name, words, partial(_of_wish, wishes)) for name, (words, wishes) in WISHES.items()),
        *(Beginning(worked, path.stem, words, partial(_copied, path)) for path, words in _worked()),
    ]
    return sorted(found, key=lambda beginning: GROUPS.index(beginning.group))


def begin(key: str, folder: Path) -> Path:
    """Write the design of a choice into a folder, under its name or the first free name after it.

    Raises WrongInput for an unknown choice, and where the file cannot be written.
    """
    chosen = next((beginning for beginning in beginnings() if beginning.key == key), None)
    if chosen is None:
        raise WrongInput(f"{key!r} given; one of the choices is right", key="begin")
    for number in count(1):
        free = chosen.name if number == 1 else f"{chosen.name}-{number}"
        path = folder / f"{free}.yaml"
        try:
            put_at_free_place(path, chosen.text(free).encode())
            return path
        except FileExistsError:
            continue
        except OSError as error:
            raise WrongInput(f"cannot be written ({error.strerror})", location=str(path)) from error
    raise AssertionError


def _by_law(law: LawName, group: str, text: Callable[[LawName, str], str]) -> Beginning:
    return Beginning(group, law.value.replace("_", "-"), law_keys(law).CHOICE, partial(text, law))


def _of_law(law: LawName, name: str) -> str:
    return begun(name, law, {})


def _of_gears(law: LawName, name: str) -> str:
    """A design of gears only; their shaft does not move anything yet."""
    return edited(begun(name, law, {}), {"linkage.kind": NO_LINKAGE})


def _of_shape(shape: str, name: str) -> str:
    return shape_template(name, shape)


def _of_wish(wishes: dict[str, Any], name: str) -> str:
    """A design of a slider with some friction, whose law is searched."""
    text = begun(name, SOUGHT_LAW, {"stroke_mm": 200, "speed_rpm": 40}, wishes)
    return edited(text, {"resistance": {"friction_n": 50}})


def _worked() -> Iterator[tuple[Path, str]]:
    """The worked designs with their own descriptions; none where ncgear was installed without its sources."""
    for path in sorted(SHIPPED.glob("*.yaml")):
        # Reading all of them as designs would take seconds.
        said = re.search(r'^description: *"?(.*?)"?$', path.read_text(encoding="utf-8"), re.MULTILINE)
        yield path, said[1] if said else ""


def _copied(path: Path, name: str) -> str:
    """A worked design under another name, without other files that it needs."""
    loaded = as_it_is(text := path.read_text(encoding="utf-8"), path)
    if isinstance(loaded, LoadedDesign) and loaded.source.from_files:
        text = design_copy(loaded, {})
    return text if name == loaded.source.data["name"] else edited(text, {"name": name})
