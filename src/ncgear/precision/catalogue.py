"""All studies, in the order of the stages."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ncgear.precision import outlines, solids
from ncgear.precision.study import Study

STUDIES: Mapping[str, Callable[[], Study]] = {
    "outlines-circle": outlines.circular_outlines,
    "outlines-ellipse": outlines.elliptical_outlines,
    "solid-volume": solids.volume,
    "solid-surface": solids.surface,
}
"""By their keys; each is made when its turn comes, with the references that it needs."""
