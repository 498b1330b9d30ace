"""Modules that few tests need, imported when the first of them uses them: each process imports all files of tests."""

from __future__ import annotations

from importlib import import_module
from typing import Any


class Later:
    """A module by its name: ``Later("sympy").sin`` imports it."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        # pytest asks all that stands in a file for marks and tests.
        if attribute.startswith("_"):
            raise AttributeError(attribute)
        return getattr(import_module(self._name), attribute)
