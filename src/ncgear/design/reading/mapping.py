"""A design from a mapping of Python in place of a file: the same keys and checks, and arrays where a file has lists.

Faults name their key; there is no line.  Functions stay in ``plain``, for ``ncgear.project.function_laws``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ncgear.design.keys.design import design_model
from ncgear.design.reading.design_file import FILES, LoadedDesign
from ncgear.design.reading.messages import checked
from ncgear.design.reading.places import Document, Place, Source
from ncgear.design.reading.points import values_from_files
from ncgear.design.reading.yaml import DEEPEST
from ncgear.errors import WrongInput

NOWHERE = Place("", 0, 0)
"""The place of every value of a mapping."""

NAME = "mapping"
"""What stands in the place of a file's name; files that a mapping names are beside the working folder."""


def parsed_mapping(data: Mapping[str, Any]) -> LoadedDesign:
    """A design from plain values (``plain``); raises WrongInput with the key of each fault, up to ten."""
    document = Document(dict(data), {"": NOWHERE, **dict.fromkeys(_keys(data, ""), NOWHERE)})
    source = Source(document, values_from_files(document, Path(NAME), FILES))
    return LoadedDesign(checked(design_model(document.data), source), Path(NAME), source, "")


def plain(value: Any, key: str = "") -> Any:
    """A mapping with lists in place of arrays and tuples, and numbers of Python in place of those of numpy.

    Raises WrongInput for keys that are no text.
    """
    if key.count(".") >= DEEPEST:
        raise WrongInput(f"nested over {DEEPEST} levels deep; no key of ncgear needs over five", key=key.split(".")[0])
    if isinstance(value, Mapping):
        for name in value:
            if not isinstance(name, str):
                raise WrongInput(f"{name!r} is a key; keys are text", key=key)
        return {name: plain(inner, f"{key}.{name}".lstrip(".")) for name, inner in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return (
        [plain(one, f"{key}.{place}") for place, one in enumerate(value)] if isinstance(value, list | tuple) else value
    )


def _keys(value: Any, above: str) -> Iterator[str]:
    """The dotted keys of all groups and list items."""
    inner = value.items() if isinstance(value, Mapping) else enumerate(value) if isinstance(value, list) else ()
    for name, one in inner:
        key = f"{above}.{name}".lstrip(".")
        yield key
        yield from _keys(one, key)
