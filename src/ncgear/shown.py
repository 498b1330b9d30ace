"""How values show themselves in notebooks: the only way by which a value reaches the rooms above it.

Notebooks ask a value for ``_repr_html_``.  Figures and drawings make the HTML; they know the values, but the values do
not know them.  So a value only declares that it can be shown, and ``ncgear.drawings.notebook`` is loaded when a
notebook asks.
"""

from __future__ import annotations

from importlib import import_module

DRAWER = "ncgear.drawings.notebook.values"
"""The module whose function ``html`` draws every value that is shown."""


class Shown:
    """A value that notebooks show as figures and pictures; elsewhere its ``repr`` is shown."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        """The value as self-contained HTML; for parts that cannot be made it shows the error."""
        return import_module(DRAWER).html(self)
