"""From keys to values: the bodies of a design's gears, in mm and rad, and their solids with teeth."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from math import cos, pi, radians, sin
from typing import TYPE_CHECKING, TypeVar

from ncgear.design.keys.bodies import GearBody, chamfer_fault
from ncgear.design.keys.bodies import Hub as AskedHub
from ncgear.design.keys.gears import Gears
from ncgear.errors import WrongInput
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear, Mesh
from ncgear.solids.helical.helix import Helix
from ncgear.solids.helical.sections import Sections
from ncgear.solids.helical.stack import OUTLINE, finest_in_steps_mm
from ncgear.solids.plan.areas import TooThick
from ncgear.solids.plan.body import Blank, Bore, EndStop, HoleSet, Hub, Keyway, RingBlank, RoundHole, SetScrew, WebSize
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import ToothedPair, finest_tolerance_mm

if TYPE_CHECKING:
    from ncgear.solids.mesh.pair import SolidPair
    from ncgear.solids.plan.body import BodyPlan

Made = TypeVar("Made")

RIM_IN_MODULES = 3.5
"""Rim of a ring where the file gives none.

From this thickness on, ISO 6336-3 counts no weakening of internal teeth (value from secondary sources).
"""


def crank_direction_rad(linkage: Mechanism, driving_axis_deg: float) -> float:
    """Polar angle of the crank at phi1 = 0 in the frame of the driven gear of an external pair.

    In the frame of the mechanism the driving axis is at ``driving_axis_deg`` from the crank's axis; in the frame of the
    gear it is at pi.  Both frames are viewed from the side on which the crank turns clockwise.
    """
    return linkage.crank_start_rad - radians(driving_axis_deg) + pi


def crank_pin_hole(gears: Gears, linkage: Mechanism) -> RoundHole | None:
    """The hole for the crank pin that the file asks for in the driven gear; None without such a wish."""
    pin = gears.driven.crank_pin
    if pin is None:
        return None
    direction = crank_direction_rad(linkage, gears.driving_axis_deg)
    return RoundHole(linkage.crank_mm * cos(direction), linkage.crank_mm * sin(direction), pin.diameter_mm)


def straight_solids(
    gears: Gears, pitch: PitchPair, teeth: ToothedPair, tolerance_mm: float, crank_pin: RoundHole | None = None
) -> SolidPair:
    """Both gears with straight teeth as closed meshes.

    Raises WrongInput where a part of the body, or the chamfer that the process wants, has no room.
    """
    from ncgear.solids.mesh.pair import SolidPair, gear_solid, ring_solid

    for name, body in (("driving", gears.driving), ("driven", gears.driven)):
        if wrong := chamfer_fault(name, body, gears.face_width_mm, gears.first_layer_chamfer_mm):
            raise WrongInput(wrong[1], key=f"gears.{wrong[0]}")
    return SolidPair(*_straight(gears, pitch, teeth, tolerance_mm, crank_pin, (gear_solid, ring_solid)))


def finished_plans(
    gears: Gears, pitch: PitchPair, teeth: ToothedPair, tolerance_mm: float, crank_pin: RoundHole | None = None
) -> tuple[BodyPlan, BodyPlan]:
    """The bodies of both gears with straight teeth as they come out of the process, which may need other files.

    Raises WrongInput where a part of the body has no room.
    """
    from ncgear.solids.mesh.pair import gear_plan
    from ncgear.solids.plan.plan import planned_ring

    return _straight(finished(gears), pitch, teeth, tolerance_mm, crank_pin, (gear_plan, planned_ring))


def finished(gears: Gears) -> Gears:
    """The gears without changes that only the process needs: bevelled edges, and outlines moved in or out."""
    return gears.model_copy(update=dict.fromkeys(PROCESS, 0.0))


PROCESS = ("first_layer_chamfer_mm", "process_clearance_mm")
"""Keys of changes that only the process needs."""


GearMaker = Callable[[Gear, Array, Blank, float, float, Mesh], Made]
RingMaker = Callable[[Array, RingBlank, float, float], Made]


def _straight(
    gears: Gears,
    pitch: PitchPair,
    teeth: ToothedPair,
    tolerance_mm: float,
    crank_pin: RoundHole | None,
    makers: tuple[GearMaker[Made], RingMaker[Made]],
) -> tuple[Made, Made]:
    """Solids or plans of both gears with straight teeth, by functions that make a gear and a ring.

    Where neither gear has room for a change of the process, the gear with less room refuses it.
    """
    gear, ring = makers
    module, outline = pitch.size.module_mm, teeth.driven.outline_mm
    covered = pitch.transmission.lobes.range
    turned = (0.0, 0.0) if covered is None else (covered.driving_rad, pitch.mesh.sense * covered.driven_rad)
    blank = _blank(gears, gears.driving, turned[0])

    def driven() -> Made:
        if pitch.driven.is_ring:
            process = gears.first_layer_chamfer_mm, gears.process_clearance_mm
            body = RingBlank(gears.face_width_mm, rim_mm_of(gears, module), gears.index_holes, *process)
            return ring(outline, body, module, tolerance_mm)
        asked = replace(_blank(gears, gears.driven, turned[1]), crank_pin=crank_pin)
        return gear(Gear.DRIVEN, outline, asked, module, tolerance_mm, Mesh.EXTERNAL)

    try:
        driving = gear(Gear.DRIVING, teeth.driving.outline_mm, blank, module, tolerance_mm, pitch.mesh)
    except TooThick as first:
        try:
            driven()
        except TooThick as second:
            if second.key == first.key and second.largest_mm < first.largest_mm:
                raise second from first
        except WrongInput:
            pass
        raise
    return driving, driven()


def helical_solids(
    gears: Gears,
    pitch: PitchPair,
    form: ToothForm,
    helix: Helix,
    tolerance_mm: float,
    crank_pin: RoundHole | None = None,
) -> SolidPair:
    """Both gears with helical teeth as closed meshes; raises WrongInput as ``_helical_blanks``."""
    from ncgear.solids.helical.mesh import helical_pair

    return helical_pair(pitch, form, helix, _helical_blanks(gears, pitch, crank_pin), tolerance_mm)


def helical_plans(
    gears: Gears,
    pitch: PitchPair,
    sections: Sequence[ToothedPair],
    tolerance_mm: float,
    crank_pin: RoundHole | None = None,
) -> tuple[BodyPlan, BodyPlan]:
    """The bodies of both gears with helical teeth by some sections, the first at z = 0; raises as for their meshes."""
    from ncgear.solids.helical.mesh import planned_through

    blanks, module = _helical_blanks(gears, pitch, crank_pin), pitch.size.module_mm
    driving, driven = (
        planned_through([part.of(gear).outline_mm for part in sections], gear, blanks[gear], module, tolerance_mm)
        for gear in Gear
    )
    return driving, driven


def _helical_blanks(gears: Gears, pitch: PitchPair, crank_pin: RoundHole | None) -> dict[Gear, Blank]:
    """The bodies asked for of helical gears.

    Raises WrongInput for an internal pair, and for keys of the process: sections are made as designed.
    """
    for name in PROCESS:
        if getattr(gears, name) != 0.0:
            problem = "given, but helical teeth are made as designed, edges and all; leave it out"
            raise WrongInput(problem, key=f"gears.{name}")
    if pitch.driven.is_ring:
        raise WrongInput("helical teeth of internal pairs are not made; leave it out", key="gears.helix")
    driven = replace(_blank(gears, gears.driven), crank_pin=crank_pin)
    return {Gear.DRIVING: _blank(gears, gears.driving), Gear.DRIVEN: driven}


def _blank(gears: Gears, body: GearBody, turned_rad: float = 0.0) -> Blank:
    """The body that the file asks for of a gear that is not a ring; ``turned_rad`` is between its end stops."""
    stop = body.end_stop
    keyway = Keyway(body.keyway.width_mm, body.keyway.depth_mm) if body.keyway else None
    holes = body.lightening_holes
    return Blank(
        face_width_mm=gears.face_width_mm,
        bore=Bore(body.bore_mm, keyway) if body.bore_mm is not None else None,
        index_hole=gears.index_holes,
        hub=_hub(body.hub, gears.face_width_mm) if body.hub else None,
        web=_web(body),
        holes=HoleSet(holes.count, holes.least_wall_mm, holes.diameter_mm) if holes else None,
        end_stop=EndStop(stop.pin_mm, stop.radius_mm, stop.clearance_mm, turned_rad) if stop else None,
        chamfer_mm=gears.first_layer_chamfer_mm,
        clearance_mm=gears.process_clearance_mm,
    )


def _hub(asked: AskedHub, face_width_mm: float) -> Hub:
    """The hub; its screw is at half its height where the file gives no height."""
    screw = asked.set_screw
    if screw is None:
        return Hub(asked.diameter_mm, asked.height_mm)
    over_face = asked.height_mm / 2.0 if screw.height_mm is None else screw.height_mm
    drilled = SetScrew(screw.diameter_mm, face_width_mm + over_face, radians(screw.direction_deg))
    return Hub(asked.diameter_mm, asked.height_mm, drilled)


def _web(body: GearBody) -> WebSize | None:
    """The web; it ends at the given diameter about the axis, or else at the hub's."""
    if body.web is None:
        return None
    of_hub_mm = body.hub.diameter_mm if body.hub else 0.0
    return WebSize(body.web.thickness_mm, body.web.rim_mm, of_hub_mm if body.web.hub_mm is None else body.web.hub_mm)


def rim_mm_of(gears: Gears, module_mm: float) -> float:
    """Thickness in mm of a ring outside its deepest root."""
    return RIM_IN_MODULES * module_mm if gears.driven.rim_mm is None else gears.driven.rim_mm


SPARE = 1.05
"""Sections of helical teeth: the told tolerance is 5 % more than z = 0 needs.  With the height the number of points
changes by a few per cent at most, and the tolerance by twice that."""


SOON = 6_000
"""Points of an outline with which a build takes half a minute of processor time at most; with 28 000 it took 76 s.
Their number is inversely proportional to the root of the tolerance."""


def finest_chords_mm(made: Iterable[tuple[PitchPair, ToothForm, Helix | None]], from_mm: float) -> tuple[float, float]:
    """The finest tolerance, from ``from_mm`` on, with which pairs can be made, and the finest that makes them soon.

    Each pair has a form and the helix of its teeth.
    """
    finest_mm = soon_mm = from_mm
    for pitch, form, helix in made:
        if helix is None:
            finest_mm, points = finest_tolerance_mm(pitch, form, finest_mm)
        else:
            within_mm, points = finest_tolerance_mm(pitch, form, SPARE * OUTLINE * finest_mm)
            in_steps_mm = finest_in_steps_mm(Sections(pitch, form, helix, within_mm))
            finest_mm = max(within_mm / OUTLINE, in_steps_mm)
        soon_mm = max(soon_mm, finest_mm * max(points / SOON, 1.0) ** 2)
    return finest_mm, soon_mm
