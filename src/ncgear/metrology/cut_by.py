"""Tools that can cut a gear, of hob, shaper, wire and end mill, and the reasons why others cannot.

A hob is the basic rack, a shaper a pinion cutter of the same rack.  Flanks are the same for every tool; depth and
fillets are not.  A tool other than the design's is tried on the exact flanks: it must go into the pitch curve, reach as
deep as the mate touches and as its tips go, undercut nothing, reach the gear's own tips, and leave the space freely.
Its fillets off the line of action are not tried: build with it as ``gears.cutter`` for that.
"""

from __future__ import annotations

from dataclasses import replace
from enum import Enum
from math import degrees

import numpy as np

from ncgear.errors import NoSuchMechanism
from ncgear.frozen import dataclass
from ncgear.metrology.round_tool import RoundTool
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.flank import Flanks, made_mates
from ncgear.teeth.fouling import refuse_fouling_cutter
from ncgear.teeth.gear import ToothedPair
from ncgear.teeth.spaces import cut_spaces
from ncgear.teeth.tool import FEWER_TEETH, HARMLESS, MOST_TEETH, PinionCircle, RackLine, gouged_mm

SAME = 1e-9
"""Largest difference of equal depths and radii, as a share of the module."""

FEWEST_TEETH = 12
"""Fewest teeth of a tried shaper; such cutters have 15 or more."""

SMALLER = (1.0, 0.75, 0.5)
"""Shares of the most teeth that are tried, one after the other, while a cutter fouls on its way out: there smaller
cutters do better.  Elsewhere they do worse, since they are less deep and their involutes shorter."""

OUT = "on its way out"
"""Words of the refusal of a cutter that fouls on its way out of a space."""

FINEST_MM = 0.02
"""Diameter in mm of the thinnest wires for spark erosion (value from secondary sources)."""


class Tool(Enum):
    """Kinds of tools."""

    HOB = "hob"
    SHAPER = "shaper"
    WIRE = "wire"
    END_MILL = "end mill"


class CutVerdict(Enum):
    """Result of a tool on a gear."""

    CUTS = "cuts it"
    FLANKS = "cuts the flanks; leaves its own fillets"
    NOT = "does not cut it"


@dataclass(frozen=True)
class CutBy:
    """Result of one tool on a gear, and the reason where it does not cut all.

    ``teeth`` is the number of a shaper's teeth, ``diameter_mm`` the greatest diameter of a wire, its spark gap
    included, or of an end mill; None where the tool has no such number or does not cut.
    """

    tool: Tool
    verdict: CutVerdict
    reason: str = ""
    teeth: int | None = None
    diameter_mm: float | None = None


def cut_by(pitch: PitchPair, teeth: ToothedPair, gear: Gear, round_tool: RoundTool, *, helix: str = "") -> list[CutBy]:
    """Results of all kinds of tools on one gear; ``helix`` is the kind of its helical teeth, empty if straight."""
    if teeth.driving.flanks.has_own_shifts:
        uneven = "its teeth stand evenly, while every space has a profile shift of its own"
        hob, shaper = CutBy(Tool.HOB, CutVerdict.NOT, uneven), CutBy(Tool.SHAPER, CutVerdict.NOT, uneven)
    else:
        hob, shaper = _hob(pitch, teeth, gear), _shaper(pitch, teeth, gear)
    if helix == "herringbone":
        hob = CutBy(Tool.HOB, CutVerdict.NOT, "herringbone teeth leave it no way out")
    hob, shaper = (_passes(tool, teeth.of(gear).flanks) for tool in (hob, shaper))
    return [hob, shaper, *(_round(tool, round_tool, helix) for tool in (Tool.WIRE, Tool.END_MILL))]


def _round(tool: Tool, largest: RoundTool, helix: str) -> CutBy:
    if helix:
        return CutBy(tool, CutVerdict.NOT, "helical teeth do not stand upright")
    if largest.diameter_mm < FINEST_MM:
        takes = f"takes {largest.diameter_mm:.3g} mm at most, and the finest have {FINEST_MM:g} mm"
        return CutBy(tool, CutVerdict.NOT, f"the space after tooth {largest.space} {takes}")
    by = "both sides" if largest.passage else "the fillet"
    return CutBy(
        tool, CutVerdict.CUTS, f"held by {by} of the space after tooth {largest.space}", None, largest.diameter_mm
    )


def _passes(generated: CutBy, flanks: Flanks) -> CutBy:
    """A second pass for idle flanks that stand turned, with the gear turned by as much."""
    if generated.verdict is CutVerdict.NOT or not flanks.is_turned:
        return generated
    turn = degrees(float(np.ptp(flanks.turn_rad)))
    second = f"idle flanks in a second pass, the gear turned by {turn:.4g} deg"
    return replace(generated, reason=f"{generated.reason}; {second}" if generated.reason else second)


def _hob(pitch: PitchPair, teeth: ToothedPair, gear: Gear) -> CutBy:
    if pitch.of(gear).is_ring:
        return CutBy(Tool.HOB, CutVerdict.NOT, "the teeth of a ring point inwards")
    rack = teeth.of(gear).flanks.rack
    radius = pitch.least_concave_radius_mm(gear)
    if radius is not None and (depth := gouged_mm(pitch.of(gear), rack)) > HARMLESS * rack.module_mm:
        hollow = f"the pitch curve is concave with a radius of {radius:.4g} mm"
        return CutBy(Tool.HOB, CutVerdict.NOT, f"{hollow}: a hob cuts {depth:.3g} mm too deep there")
    return CutBy(Tool.HOB, *_tried(teeth, gear, RackLine()))


def _shaper(pitch: PitchPair, teeth: ToothedPair, gear: Gear) -> CutBy:
    """The shaper of the design, else the working shaper of most teeth."""
    own = teeth.of(gear).flanks.tool
    if isinstance(own, PinionCircle):
        verdict, reason = _tried(teeth, gear, own)
        return CutBy(Tool.SHAPER, verdict, reason, own.teeth)
    radius = pitch.least_concave_radius_mm(gear)
    module = pitch.size.module_mm
    most = MOST_TEETH if radius is None else min(MOST_TEETH, int(2.0 * radius / module) - FEWER_TEETH)
    if most < FEWEST_TEETH:
        return CutBy(Tool.SHAPER, CutVerdict.NOT, f"the concave stretch takes cutters of {max(most, 0)} teeth at most")
    first = ""
    for count in (max(int(share * most), FEWEST_TEETH) for share in SMALLER):
        verdict, why = _tried(teeth, gear, PinionCircle(count, module))
        if verdict is not CutVerdict.NOT:
            return CutBy(Tool.SHAPER, verdict, why, count)
        first = first or f"with {count} teeth {why}"
        if OUT not in why:
            break
    return CutBy(Tool.SHAPER, CutVerdict.NOT, first)


def _tried(teeth: ToothedPair, gear: Gear, tool: RackLine | PinionCircle) -> tuple[CutVerdict, str]:
    """Result of a rack or a pinion cutter of the gear's rack, and the reason where it does not cut all."""
    own, mate = teeth.of(gear), teeth.of(Gear.DRIVEN if gear is Gear.DRIVING else Gear.DRIVING)
    flanks, rack = own.flanks, own.flanks.rack
    radius = np.full(flanks.count, rack.root_radius_mm)
    depth = flanks.full_root_mm - radius * (1.0 - flanks.slant.sine)
    full = replace(flanks, tool=tool, flank_depth_mm=depth, root_radius_mm=radius)
    try:
        cut, undercut = cut_spaces(full, avoid_undercut=False)
        if isinstance(tool, PinionCircle):
            refuse_fouling_cutter(replace(own.tips, flanks=cut))
    except NoSuchMechanism as refusal:
        return CutVerdict.NOT, refusal.problem.split(";")[0]
    near = SAME * rack.module_mm
    made = flanks.is_made
    if type(flanks.tool) is type(tool) and not _differ(cut.flank_depth_mm[made], flanks.flank_depth_mm[made], near):
        if _differ(cut.root_radius_mm[made], cut.root_radius_mm[:1], near):
            return CutVerdict.NOT, "its tip would need other roundings from tooth to tooth"
        return CutVerdict.CUTS, ""
    undercut &= flanks.is_made
    if undercut.any():
        return CutVerdict.NOT, f"at full depth it undercuts tooth {flanks.tooth[undercut][0]}"
    if isinstance(tool, PinionCircle) and np.any(own.tips.height_mm > tool.radius_mm * flanks.slant.sine**2):
        return CutVerdict.NOT, "its involutes end at its base circle before they reach the tips"
    pairs = made_mates(teeth.driving.flanks, teeth.driven.flanks)
    mine, its = pairs if gear is Gear.DRIVING else pairs[::-1]
    shallow = (cut.flank_depth_mm < own.tips.met_depth_mm - near)[mine]
    shallow |= cut.root_depth_mm[mine] < mate.flanks.tip_height_mm[its] + near
    if shallow.any():
        tooth = flanks.tooth[mine[shallow]].min()
        return CutVerdict.NOT, f"it is not as deep beside tooth {tooth} as the mate's tips reach"
    return CutVerdict.FLANKS, ""


def _differ(one: Array, other: Array, by: float) -> bool:
    return bool(np.any(np.abs(one - other) > by))
