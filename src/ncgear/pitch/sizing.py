"""Centre distance, module and number of teeth: two of them give the third, since teeth must fill the pitch curve."""

from __future__ import annotations

from dataclasses import dataclass
from math import isclose, pi

from ncgear.errors import WrongInput
from ncgear.ratio.transmission import Lobes

CONSISTENT = 1e-6
"""Relative disagreement of three given values that counts as rounding in the file: seven digits."""


@dataclass(frozen=True)
class Size:
    """A consistent set: teeth of both gears, module and centre distance."""

    driving_teeth: int
    driven_teeth: int
    module_mm: float
    center_distance_mm: float


def solved_size(
    driving_length: float, lobes: Lobes, teeth: int | None, module_mm: float | None, center_distance_mm: float | None
) -> Size:
    """The size from any two of teeth, module and centre distance.

    ``driving_length`` is the driving pitch curve's length at unit centre distance, so that teeth x pi x module is that
    times the centre distance.  Raises WrongInput when fewer than two are given, when three disagree, or when a number
    of teeth is not whole.
    """
    if sum(value is None for value in (teeth, module_mm, center_distance_mm)) > 1:
        raise WrongInput("two of teeth, module_mm and center_distance_mm are needed; the third follows", key="gears")
    if teeth is None:
        assert module_mm is not None
        assert center_distance_mm is not None
        teeth = _whole_teeth(driving_length, module_mm, center_distance_mm)
    if module_mm is None:
        assert center_distance_mm is not None
        module_mm = driving_length * center_distance_mm / (teeth * pi)
    elif center_distance_mm is not None:
        _refuse_disagreement(driving_length, teeth, module_mm, center_distance_mm)
    fitting = teeth * pi * module_mm / driving_length
    return Size(teeth, _driven_teeth(teeth, lobes), module_mm, fitting)


def _whole_teeth(driving_length: float, module_mm: float, center_distance_mm: float) -> int:
    exact = driving_length * center_distance_mm / (pi * module_mm)
    whole = max(round(exact), 1)
    if not isclose(exact, whole, rel_tol=CONSISTENT):
        raise WrongInput(
            f"module {module_mm:g} mm and centre distance {center_distance_mm:g} mm make {exact:.6g} "
            f"teeth, not a whole number; with {whole} teeth either module_mm: "
            f"{driving_length * center_distance_mm / (pi * whole):.9g} or center_distance_mm: "
            f"{whole * pi * module_mm / driving_length:.9g} is right",
            key="gears.center_distance_mm",
        )
    return whole


def _driven_teeth(teeth: int, lobes: Lobes) -> int:
    if teeth * lobes.driven % lobes.driving:
        raise WrongInput(
            f"{teeth} teeth on the driving gear make {teeth * lobes.driven / lobes.driving:.4g} on the driven gear at "
            f"{lobes.driving}:{lobes.driven} lobes; a multiple of {lobes.driving} is needed",
            key="gears.teeth",
        )
    return teeth * lobes.driven // lobes.driving


def _refuse_disagreement(driving_length: float, teeth: int, module_mm: float, center_distance_mm: float) -> None:
    fitting = teeth * pi * module_mm / driving_length
    if not isclose(fitting, center_distance_mm, rel_tol=CONSISTENT):
        raise WrongInput(
            f"{teeth} teeth of module {module_mm:g} mm do not fit a centre distance of {center_distance_mm:g} mm; "
            f"consistent would be center_distance_mm: {fitting:.9g}, or module_mm: "
            f"{driving_length * center_distance_mm / (teeth * pi):.9g}, or teeth: "
            f"{driving_length * center_distance_mm / (pi * module_mm):.6g}",
            key="gears.center_distance_mm",
        )
