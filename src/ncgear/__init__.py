"""ncgear: non-circular gears from the motion of a slider.

``ncgear.load("design.yaml")`` gives the drive of a design file or of a mapping, with its law, motion, teeth and more as
attributes; ``ncgear.compare`` sets designs side by side, ``ncgear.plots`` draws them, ``ncgear.fit`` finds the nearest
pair to an outline, ``ncgear.cad`` makes parts of build123d.  Everything is imported when it is first used, so that
``import ncgear`` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import ncgear.cad as cad
    import ncgear.plots as plots
    from ncgear.design.template import examples
    from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
    from ncgear.figures.side_by_side import compare
    from ncgear.project.drive import Drive
    from ncgear.project.mending import mending
    from ncgear.project.opened import load, loads
    from ncgear.project.outline_fit import fit

__version__ = "1.0.0"

__all__ = [
    "DesignError",
    "Drive",
    "NoSuchMechanism",
    "WrongInput",
    "__version__",
    "cad",
    "compare",
    "examples",
    "fit",
    "load",
    "loads",
    "mending",
    "plots",
]

_MODULES = {
    "DesignError": "ncgear.errors",
    "Drive": "ncgear.project.drive",
    "NoSuchMechanism": "ncgear.errors",
    "WrongInput": "ncgear.errors",
    "compare": "ncgear.figures.side_by_side",
    "examples": "ncgear.design.template",
    "fit": "ncgear.project.outline_fit",
    "load": "ncgear.project.opened",
    "loads": "ncgear.project.opened",
    "mending": "ncgear.project.mending",
}
"""Module of each public name."""


def __getattr__(name: str) -> Any:
    if name in ("cad", "plots"):
        return import_module(f"ncgear.{name}")
    if name not in _MODULES:
        raise AttributeError(f"module 'ncgear' has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
