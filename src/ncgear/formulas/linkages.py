"""Mechanisms in closed form: the displacement at a driven angle, and the driven angle at a displacement.

The formulas come from ``ncgear.mechanisms`` and are regular at both dead centres.  ``gone`` and ``left`` are smooth
roots of the displacement and of the rest of the stroke.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sympy import Integer, atan, atan2, cos, sin, sqrt

from ncgear.formulas.written import FormulaWriter
from ncgear.mechanisms.crank_rocker import CrankRocker
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.driven_shaft import DrivenShaft
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.mechanisms.rack_pinion import RackPinion
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.mechanisms.slotted_lever import SlottedLever


def displacement(write: FormulaWriter, linkage: Mechanism, phi_2: Any) -> None:
    """Write x at a driven angle, in mm, or in rad for a turning output."""
    write.step("x", FORMS[type(linkage)][0](write, linkage, phi_2))


def driven_angle(write: FormulaWriter, linkage: Mechanism, x: Any, gone: Any, left: Any) -> None:
    """Write phi_2 in the working stroke, at a displacement and its two roots."""
    write.step("phi_2", FORMS[type(linkage)][1](write, linkage, x, gone, left))


def _slider(write: FormulaWriter, linkage: CrankSlider, phi_2: Any) -> Any:
    crank, rod = write.number("crank", linkage.crank_mm), write.number("rod", linkage.rod_mm)
    versine = write.step("versine", 2 * sin(phi_2 / 2) ** 2)
    if linkage.offset_mm == 0.0:
        advance, lateral, start = crank * versine, crank * sin(phi_2), rod
    else:
        offset, nearest = write.number("offset", linkage.offset_mm), write.number("nearest", linkage.nearest_mm)
        reach = rod - crank
        advance = crank * (nearest * versine - offset * sin(phi_2)) / reach
        lateral = (crank * (nearest * sin(phi_2) + offset * versine) - rod * offset) / reach
        start = rod * nearest / reach
    other = write.step("y", sqrt(rod**2 - lateral**2) + start - advance)
    return 2 * crank * (rod - crank) * versine / other


def _slider_angle(write: FormulaWriter, linkage: CrankSlider, x: Any, gone: Any, left: Any) -> Any:
    crank, rod = write.number("crank", linkage.crank_mm), write.number("rod", linkage.rod_mm)
    if linkage.offset_mm == 0.0:
        stretch = write.step("stretch", (x + 2 * rod) / (x + 2 * (rod - crank)))
        return 2 * atan2(write.step("rise", gone * sqrt(stretch)), left)
    offset, nearest = write.number("offset", linkage.offset_mm), write.number("nearest", linkage.nearest_mm)
    farthest = write.number("farthest", linkage.farthest_mm)
    place = write.step("place", x + nearest)
    apart = write.step("apart", sqrt(place**2 + offset**2))
    share = write.step("share", sqrt((place + nearest) / (place + farthest)))
    stretch = write.step("stretch", (apart + rod + crank) / (apart + rod - crank))
    tilt = write.step("tilt", x * offset / (place * nearest + offset**2))
    return 2 * atan2(write.step("rise", gone * share * stretch), left) + atan(tilt)


def _yoke(write: FormulaWriter, linkage: ScotchYoke, phi_2: Any) -> Any:
    return 2 * write.number("crank", linkage.crank_mm) * sin(phi_2 / 2) ** 2


def _yoke_angle(write: FormulaWriter, linkage: ScotchYoke, x: Any, gone: Any, left: Any) -> Any:
    return 2 * atan2(gone, left)


def _rack(write: FormulaWriter, linkage: RackPinion, phi_2: Any) -> Any:
    return write.number("radius", linkage.radius_mm) * phi_2


def _rack_angle(write: FormulaWriter, linkage: RackPinion, x: Any, gone: Any, left: Any) -> Any:
    return x / write.number("radius", linkage.radius_mm)


def _lever_lengths(write: FormulaWriter, linkage: SlottedLever) -> tuple[Any, Any, Any, Any]:
    crank, pivot = write.number("crank", linkage.crank_mm), write.number("pivot", linkage.pivot_mm)
    return crank, pivot, write.number("lever", linkage.lever_mm), sqrt((pivot - crank) * (pivot + crank))


def _lever(write: FormulaWriter, linkage: SlottedLever, phi_2: Any) -> Any:
    crank, pivot, lever, foot = _lever_lengths(write, linkage)
    across = write.step("across", 2 * crank * sin(phi_2 / 2) ** 2)
    along = write.step("along", crank * sin(phi_2) + foot)
    apart = write.step("apart", sqrt(across**2 + along**2))
    # Where the lever never turns beyond a right angle, the form without cancellation holds everywhere.
    beyond = across**2 / (apart + along) if linkage.pivot_mm > 1.5 * linkage.crank_mm else apart - along
    return (across * foot + beyond * crank) * lever / (pivot * apart)


def _lever_angle(write: FormulaWriter, linkage: SlottedLever, x: Any, gone: Any, left: Any) -> Any:
    crank, pivot, lever, foot = _lever_lengths(write, linkage)
    cosine = write.step("cosine", sqrt((1 + crank / pivot - x / lever) * (1 - crank / pivot + x / lever)))
    half = write.step("half", x / (lever * (cosine + foot / pivot)))
    return 2 * atan2(gone, left) + 2 * atan(half)


def _rocker_lengths(write: FormulaWriter, linkage: CrankRocker) -> tuple[Any, Any, Any, Any, Any]:
    names = ("crank", "coupler", "rocker", "ground")
    lengths = [write.number(name, getattr(linkage, f"{name}_mm")) for name in names]
    return (*lengths, write.number("nearest", linkage.nearest_mm))


def _rocker(write: FormulaWriter, linkage: CrankRocker, phi_2: Any) -> Any:
    crank, coupler, rocker, ground, nearest = _rocker_lengths(write, linkage)
    start = write.step("start", atan2(-rocker * sin(nearest), rocker * cos(nearest) - ground))
    turned = -Integer(round(linkage.side)) * phi_2
    raised = write.step("raised", 2 * sin(phi_2 / 2) ** 2 * crank * (coupler - crank) / rocker)
    across = write.step("across", ground * sin(nearest) - crank * sin(turned + start + nearest))
    opened = write.step("opened", 4 * crank * ground * cos((turned + start) / 2) ** 2)
    short = opened + (coupler + rocker) ** 2 - (ground + crank) ** 2
    long = (ground + crank) ** 2 - (coupler - rocker) ** 2 - opened
    return 2 * atan2(raised, across + sqrt(short * long) / (2 * rocker))


def _rocker_angle(write: FormulaWriter, linkage: CrankRocker, x: Any, gone: Any, left: Any) -> Any:
    crank, coupler, rocker, ground, nearest = _rocker_lengths(write, linkage)
    rest = write.step("rest", left**2)
    apart = write.step("apart", sqrt(4 * ground * rocker * sin((x + nearest) / 2) ** 2 + (ground - rocker) ** 2))
    farthest = write.number("farthest", linkage.farthest_mm)
    # sin(x/2)/(x/2) and the like, times the sine half way
    risen = write.step("risen", 2 * sin(x / 2) / x * sin(x / 2 + nearest))
    fallen = write.step("fallen", 2 * sin(rest / 2) / rest * sin(farthest - rest / 2))
    rise = write.step("rise", gone * sqrt(risen) * (apart + coupler + crank))
    fall = write.step("fall", left * sqrt(fallen) * (apart + coupler - crank))
    moved = write.step("moved", 2 * rocker * sin(x / 2))
    along, across = ground - rocker * cos(nearest), rocker * sin(nearest)
    turned = write.step("turned", moved * (sin(x / 2 + nearest) * across - cos(x / 2 + nearest) * along))
    facing = moved * (sin(x / 2 + nearest) * along + cos(x / 2 + nearest) * across)
    facing = write.step("facing", facing + apart * (coupler - crank) + (coupler - crank) ** 2)
    return 2 * atan2(rise, fall) + 2 * Integer(round(linkage.side)) * atan(turned / facing)


def _shaft(write: FormulaWriter, linkage: DrivenShaft, phi_2: Any) -> Any:
    return phi_2


def _shaft_angle(write: FormulaWriter, linkage: DrivenShaft, x: Any, gone: Any, left: Any) -> Any:
    return x


FORMS: dict[type[Mechanism], tuple[Callable[..., Any], Callable[..., Any]]] = {
    CrankSlider: (_slider, _slider_angle),
    ScotchYoke: (_yoke, _yoke_angle),
    RackPinion: (_rack, _rack_angle),
    SlottedLever: (_lever, _lever_angle),
    CrankRocker: (_rocker, _rocker_angle),
    DrivenShaft: (_shaft, _shaft_angle),
}
"""Displacement and driven angle of every mechanism."""
