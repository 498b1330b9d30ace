"""How much gentler a law must be: its ratio drawn towards the mean until a condition holds, or a law that is sought."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ncgear.design.motion import Ellipse, HarmonicRatio, RatioExpression
from ncgear.design.schema import Design
from ncgear.drive import Drive
from ncgear.errors import DesignError
from ncgear.output.advice.values import Change, Remedy
from ncgear.ratio.transmission import Transmission

STEPS = 100
"""Hundredths of the law's swing in which a gentler one is sought: finer ones nobody would choose."""

OPTIMIZE = "ncgear optimize"


def optimised(drive: Drive, **limits: float | bool) -> Remedy:
    """A law that is sought within limits, by their keys under optimize.limits."""
    changes = tuple(Change(f"optimize.limits.{key}", value) for key, value in limits.items())
    return Remedy("let the best law within this limit be found", changes, OPTIMIZE)


def tempered(drive: Drive, harmful: Callable[[Transmission], bool]) -> tuple[Remedy, ...]:
    """The design's own law, its swing reduced until it is no longer ``harmful``; none where the law has no such way.

    A lesser swing is taken to be no more harmful, so that halving finds the largest one of whole hundredths.
    """
    low, high = 0, STEPS
    while high - low > 1:
        middle = (low + high) // 2
        if _is_sound(drive.design, middle / STEPS, harmful):
            low = middle
        else:
            high = middle
    if low == 0:
        return ()
    changes = gentler(drive.design, low / STEPS)
    return (Remedy(f"keep {low} % of the law's swing, which moves the slider more evenly", changes),)


def _is_sound(design: Design, share: float, harmful: Callable[[Transmission], bool]) -> bool:
    changes = gentler(design, share)
    if not changes:
        return False
    try:
        return not harmful(Drive(_with_motion(design, changes)).pair.transmission)
    except DesignError:
        return False


def _with_motion(design: Design, changes: tuple[Change, ...]) -> Design:
    values = {change.key.removeprefix("motion."): change.value for change in changes}
    return design.model_copy(update={"motion": design.motion.model_copy(update=values)})


def gentler(design: Design, share: float) -> tuple[Change, ...]:
    """The changes that leave ``share`` (0 to 1) of the swing of a law's ratio; none where it has no such measure.

    The logarithm of the ratio keeps that share, or the driven angle's deviation from an even turn, or the ellipse's
    eccentricity.
    """
    if design.stages > 1:
        return ()
    match design.motion:
        case Ellipse(eccentricity=eccentricity):
            values: dict[str, Any] = {"eccentricity": share * eccentricity}
        case HarmonicRatio(cosine=cosine, sine=sine):
            values = {"cosine": tuple(share * c for c in cosine), "sine": tuple(share * s for s in sine)}
        case RatioExpression(ratio=str(formula)):
            values = {"ratio": f"({formula})**{share:g}", "scale_to_close": True}
        case RatioExpression(driven_angle=str(formula)):
            values = {"driven_angle": f"{1.0 - share:g}*{_even_turn(design)}*phi + {share:g}*({formula})"}
        case _:
            values = {}
    return tuple(Change(f"motion.{key}", value) for key, value in values.items() if value != ())


def _even_turn(design: Design) -> str:
    """Driven angle per driving angle of gears that turn evenly, as a formula."""
    lobes = design.gears.lobes if design.gears else None
    return f"{lobes.driving}/{lobes.driven}" if lobes else "1"
