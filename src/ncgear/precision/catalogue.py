"""All studies, in the order of the stages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ncgear.errors import WrongInput
from ncgear.precision import (
    bases,
    closure,
    contact,
    curvature,
    inversion,
    limit,
    makeable,
    makeable_places,
    outlines,
    pitch_length,
    quadrature,
    simulation,
    solids,
)
from ncgear.precision.study import Study

STUDIES: Mapping[str, Callable[[], Study]] = {
    "inversion": inversion.study,
    "closure": closure.study,
    "return-basis": bases.study,
    "driven-angle-ellipse": quadrature.of_ellipse,
    "driven-angle-return": quadrature.of_return,
    "pitch-length-ellipse": pitch_length.of_ellipse,
    "pitch-length-baler": pitch_length.of_baler,
    "curvature-ellipse": curvature.of_ellipse,
    "curvature-baler": curvature.of_baler,
    "outlines-circle": outlines.circular_outlines,
    "outlines-ellipse": outlines.elliptical_outlines,
    "contact-ratio": contact.ratio,
    "contact-angle": contact.angle,
    "solid-volume": solids.volume,
    "solid-surface": solids.surface,
    "simulation-baler": simulation.of_baler,
    "simulation-half": simulation.of_half,
    "limit": limit.study,
    "makeable": makeable.study,
    "makeable-places": makeable_places.study,
}
"""By their keys; each is made when its turn comes, with the references that it needs."""


def chosen(keys: Sequence[str]) -> Mapping[str, Callable[[], Study]]:
    """The studies of those keys in the order of the stages, all where none is given; raises WrongInput for others."""
    for key in keys:
        if key not in STUDIES:
            raise WrongInput(f"{key!r} is no study; known are {', '.join(STUDIES)}", key="--only")
    return {key: make for key, make in STUDIES.items() if not keys or key in keys}


def made(keys: Sequence[str]) -> tuple[list[Study], list[str]]:
    """The studies of those keys, or all that can be made here; and why others cannot.

    Raises WrongInput where one of the keys cannot be made.
    """
    studies, left_out = [], []
    for key, make in chosen(keys).items():
        try:
            studies.append(make())
        except WrongInput as error:
            if keys:
                raise
            left_out.append(f"{key} is left out: {error}")
    return studies, left_out
