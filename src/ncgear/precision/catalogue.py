"""All studies, in the order of the stages."""

from __future__ import annotations

from collections.abc import Callable

from ncgear.precision.study import Study

STUDIES: tuple[Callable[[], Study], ...] = ()
"""Each is made when its turn comes, with the references that it needs."""
