"""How values show themselves in notebooks: the one door through which a value reaches what stands above it.

Notebooks ask a value for ``_repr_html_``.  What a value looks like is made of figures and drawings, which know the
values and not the other way round.  So a value says only that it is shown, and ``ncgear.drawings.notebook`` is loaded
when a notebook asks.
"""

from __future__ import annotations

from importlib import import_module

DRAWER = "ncgear.drawings.notebook.values"
"""The module whose function ``html`` draws every value that is shown."""


class Shown:
    """A value that notebooks show as figures and pictures; elsewhere its ``repr`` is what is seen."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        """The value as HTML that stands by itself; what cannot be made of it is shown as its refusal."""
        text: str = import_module(DRAWER).html(self)
        return text
