"""The nearest pair to an outline: its figures, the fitted design file, and the words for what keeps it away."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import degrees
from typing import Any

from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.rewritten import design_copy
from ncgear.design.words import ending_in
from ncgear.optimum.outline.conditions import Kind
from ncgear.optimum.outline.nearest import Deviation
from ncgear.pitch.shape import Gear
from ncgear.project.outline_fit import OutlineFit

SUFFIX = "-fitted"

OTHER = {Gear.DRIVING: Gear.DRIVEN, Gear.DRIVEN: Gear.DRIVING}

WORDS = {
    Kind.HOLLOW_OWN: "the {own} gear is concave there: its tips would run into the {mate} gear's, as those of a ring "
    "and too large a pinion",
    Kind.HOLLOW_MATE: "the {mate} gear is concave there: its tips would run into the {own} gear's, as those of a ring "
    "and too large a pinion",
    Kind.HOLLOW_CORNER_OWN: "a concave corner of the {own} gear: no flank rolls in a sharper one",
    Kind.HOLLOW_CORNER_MATE: "a concave corner of the {mate} gear: no flank rolls in a sharper one",
    Kind.CORNER_OWN: "a convex corner of the {own} gear: no tooth stands on a sharper one",
    Kind.CORNER_MATE: "a convex corner of the {mate} gear: no tooth stands on a sharper one",
    Kind.STEEP: "the pressure angle: the curve may run no steeper against the ray from its axis",
    Kind.ROOM: "the room beside the axis of the {mate} gear",
}
"""What keeps a curve from its outline."""

UNBOUND = (
    "no condition of the teeth at this very place: it lies behind another part of the outline as seen from the axis, "
    "or the curve gives way for the places beside it"
)


def bound_words(found: OutlineFit, bound_by: Sequence[Kind]) -> str:
    """What keeps a curve from its outline where they are farthest apart, by the conditions that bind there."""
    own = found.given_gear
    words = [WORDS[kind].format(own=own.value, mate=OTHER[own].value) for kind in bound_by[:1]]
    return words[0] if words else UNBOUND


def fitted_design(loaded: LoadedDesign, found: OutlineFit) -> str:
    """The text of the design file with the fitted curve in place of its outline; comments elsewhere stay."""
    values: dict[str, Any] = {"name": ending_in(SUFFIX, loaded.design.name), "motion": dict(found.motion)}
    gears, asked = loaded.design.gears, loaded.design.outline
    if asked is not None and asked.mate is not None:
        # Both outlines are in the curve.
        values["outline.mate" if asked.model_fields_set - {"mate"} else "outline"] = None
    if gears is not None and loaded.design.motion.gives_center_distance:
        # The curve has the size: its teeth are counted, and the module follows.
        values |= {"gears.teeth": found.curve.teeth, "gears.module_mm": None, "gears.center_distance_mm": None}
    return design_copy(loaded, values)


def fit_figures(found: OutlineFit) -> dict[str, Any]:
    """Deviation with its place and cause, sizes, and what other sizes would cost."""
    mate = found.mate
    figures = {
        "outline": {"size_mm": found.outline.size_mm, "corners": len(found.outline.corners)},
        "deviation": _deviation(found.deviation, found.outline.size_mm, found.bound_by)
        | {"greatest_at_deg": degrees(found.greatest_at_rad)},
        "pair": {
            "given_gear": found.given_gear.value,
            "axis_mm": found.curve.axis_mm.tolist(),
            "center_distance_mm": found.curve.center_distance_mm,
            "teeth": found.curve.teeth,
            "module_mm": found.curve.module_mm,
            "contact_ratio": found.contact_ratio,
            "shortest_contact_pitches": found.shortest_contact,
            "max_pressure_angle_deg": found.pressure_angle_deg,
            "ratio_min": found.drive.transmission.ratio_range[0].value,
            "ratio_max": found.drive.transmission.ratio_range[1].value,
        },
        "next_sizes": [
            {name: value for name, value in asdict(one).items() if value is not None} for one in found.next_sizes
        ],
    }
    if mate is None:
        return figures
    figures["mate"] = {
        "outline": {"size_mm": mate.size_mm, "corners": len(mate.outline.corners), "scale": mate.scale},
        "axis_mm": mate.axis_mm.tolist(),
        "deviation": _deviation(mate.deviation, mate.size_mm, mate.bound_by),
    }
    return figures


def _deviation(away: Deviation, size_mm: float, bound_by: Sequence[Kind]) -> dict[str, Any]:
    return {
        "root_mean_square_mm": away.root_mean_square_mm,
        "root_mean_square_share": away.root_mean_square_mm / size_mm,
        "greatest_mm": away.greatest_mm,
        "greatest_share": away.greatest_mm / size_mm,
        "greatest_at_mm": list(away.at_mm),
        "greatest_of": "outline" if away.of_outline else "pitch curve",
        "bound_by": [kind.value for kind in bound_by],
    }
