"""What is told of gears as they wear: their play, knocks, forces and safeties after parts of the wanted life."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ncgear.figures.flanks import hours_words
from ncgear.figures.numbers import known, to_digits
from ncgear.figures.quantities import figure
from ncgear.figures.strong import knock_figures, knock_words, least_safeties, least_words
from ncgear.project.drive import Drive
from ncgear.project.worn import Worn


def worn_figures(drive: Drive, found: Sequence[Worn]) -> dict[str, Any]:
    """A section for each time, with the keys of new gears; ``ended`` says why no gears are left."""
    place = drive.linkage.OUTPUT.place
    told: dict[str, Any] = {}
    for one in found:
        section: dict[str, Any] = {"worn_h": one.hours, "depth_max_mm": one.depth_mm, "backlash_mm": one.backlash_mm}
        if one.rating is None:
            section["ended"] = one.why
        else:
            free = {f"free_way_{place.ending}": place.factor * one.free} if one.free else {}
            strength = one.rating.strength
            least = {f"{damage.value}_safety_min": known(most) for damage, most in least_safeties(strength).items()}
            section |= free | knock_figures(one.rating.loading.knocks)
            section |= {"peak_tooth_force_n": strength.peak_pair_n, **least}
        told[f"after_{round(one.hours)}_h"] = section
    return {"worn": told}


def worn_rows(drive: Drive, found: Sequence[Worn]) -> list[tuple[str, str]]:
    """The same in a line for each time."""
    output, rows = drive.linkage.OUTPUT, list[tuple[str, str]]()
    for one in found:
        words = f"{to_digits(one.depth_mm, 2)} mm off the flanks, backlash {to_digits(one.backlash_mm, 2)} mm, "
        if one.rating is None:
            words += f"no gears any more: {one.why}"
        else:
            free, knocks = to_digits(output.place.factor * one.free, 2), knock_words(one.rating.loading.knocks)
            words += f"{output.name} free by {free} {output.place.text}; up to " if one.free else "up to "
            words += f"{figure('force_n', one.rating.strength.peak_pair_n)} on one pair of teeth, safety "
            words += least_words(one.rating.strength) + (f"; knocks {knocks}" if knocks else "")
        rows.append((f"after {hours_words(one.hours)}", words))
    return rows


def worn_fault(found: Sequence[Worn]) -> list[str]:
    """When worn gears are under a wanted safety first, and which one; empty where they never are."""
    for one in found:
        if one.rating is None:
            return [f"worn away after {hours_words(one.hours)}: {one.why}"]
        least = min(one.rating.weakest, key=lambda weak: weak.share)
        if not least.holds:
            safety = f"safety {to_digits(least.safety, 3)}, {least.wanted:g} wanted"
            return [f"worn for {hours_words(one.hours)}, {least.gear.value} gear, {least.damage.words}: {safety}"]
    return []
