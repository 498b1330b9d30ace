"""The keys of one gear's body: bore, keyway, hub, web, holes, and the rim of a ring."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ncgear.design.keys.base import Faults, Length, Model, fault, optional, required

MOST_HOLES = 100


class Keyway(Model):
    """A keyway in the bore."""

    width_mm: Length = required("width of the keyway in mm, under the bore")
    depth_mm: Length = required("depth of the keyway in mm, from the bore outwards")


class SetScrew(Model):
    """A radial hole through one side of the hub, down to the bore."""

    diameter_mm: Length = required("diameter of the hole in mm: the tap drill's, or with clearance")
    height_mm: Length | None = optional("height of its axis over the face in mm; left out: half the hub's height")
    direction_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = optional(
        "direction in degrees, counter-clockwise from the keyway's side; left out: through to the keyway", 0.0
    )


class Hub(Model):
    """A cylinder about the axis on the upper face."""

    RULES = ("set_screw.diameter_mm < height_mm",)

    diameter_mm: Length = required("diameter of the hub in mm, over the bore and under the tooth roots")
    height_mm: Length = required("height of the hub over the face in mm")
    set_screw: SetScrew | None = optional("hole for a set screw in the hub; left out: none")

    def _faults(self) -> Faults:
        screw, height = self.set_screw, self.height_mm
        if screw is None:
            return
        low, high = screw.diameter_mm / 2.0, height - screw.diameter_mm / 2.0
        if screw.height_mm is not None and not low < screw.height_mm < high:
            problem = f"at {screw.height_mm:g} mm the hole leaves the hub; between {low:g} and {high:g} mm is right"
            yield fault("set_screw.height_mm", problem)


class Web(Model):
    """Pockets in the upper face between rim and hub, down to a web."""

    thickness_mm: Length = required("thickness of the web in mm, from z = 0 up; under the face width")
    rim_mm: Length = required("least wall in mm between the pockets and the tooth roots")
    hub_mm: Length | None = optional("diameter in mm of the full part about the axis; left out: diameter of the hub")


class LighteningHoles(Model):
    """Round through holes about the axis: in the pockets of a web, or in the full gear."""

    count: int = required("number of holes, in evenly spread directions, a whole number", ge=1, le=MOST_HOLES)
    least_wall_mm: Length = required(
        "least wall in mm to tooth outline, bore, hub, pocket sides, index hole and between the holes"
    )
    diameter_mm: Length | None = optional(
        "diameter of the holes in mm; left out: the largest that keeps the walls, 2 mm or more"
    )


class EndStop(Model):
    """An arc slot about the axis; in it, a pin of the frame stops a gear that turns less than once."""

    pin_mm: Length = required("diameter of the pin in mm; it stands in the frame, away from the other gear")
    radius_mm: Length = required("distance in mm of the pin, and of the slot's middle, from the gear's axis")
    clearance_mm: Annotated[float, Field(ge=0.0, le=10.0)] = optional(
        "by how much the slot is wider than the pin in mm; its ends meet the pin where the range ends", 0.2
    )


class CrankPin(Model):
    """A hole for the crank pin in the gear itself, which is the crank then."""

    diameter_mm: Length = required(
        "diameter of the hole in mm; its centre is the crank's length from the axis, in the direction of the crank at "
        "phi1 = 0"
    )


class GearBody(Model):
    """Cuts in one gear around its axis, and the parts that stand on it."""

    RULES = (
        "keyway needs bore_mm",
        "keyway.width_mm < bore_mm",
        "hub.set_screw needs bore_mm",
        "hub.set_screw.diameter_mm < bore_mm",
        "web needs web.hub_mm hub",
        "web.hub_mm >= hub.diameter_mm",
    )

    bore_mm: Length | None = optional("diameter of the bore in mm; left out: no bore")
    keyway: Keyway | None = optional("keyway in the bore; left out: none")
    hub: Hub | None = optional("hub on the upper face; left out: none")
    web: Web | None = optional("web under pockets in the upper face; left out: none")
    lightening_holes: LighteningHoles | None = optional("round holes that save weight; left out: none")

    end_stop: EndStop | None = optional("arc slot for a pin that stops gears which turn less than once; left out: none")


class DrivenBody(GearBody):
    """Cuts in the driven gear around its axis or, for a ring, the body around its teeth."""

    rim_mm: Length | None = optional(
        "of a ring (mesh: internal): thickness in mm outside its deepest root; left out: 3.5 modules"
    )
    crank_pin: CrankPin | None = optional(
        "hole for the crank pin in the gear, which then is the crank itself; of two pairs in series it is in the last "
        "gear; left out: none"
    )

    @property
    def about_axis(self) -> list[str]:
        """The given keys that do not suit a ring, because it is open about its axis."""
        return [
            name
            for name in ("bore_mm", "hub", "web", "lightening_holes", "end_stop", "crank_pin")
            if getattr(self, name) is not None
        ]


def chamfer_fault(name: str, body: GearBody, face_width: float, chamfer: float) -> tuple[str, str] | None:
    """Key and fault of a chamfer of the lower edges as high as the web or the gear; None for a lower chamfer."""
    web = body.web
    lowest, part = (face_width, "gear") if web is None else (web.thickness_mm, f"{name} gear's web")
    if chamfer < lowest:
        return None
    return "first_layer_chamfer_mm", f"{chamfer:g} mm is as high as the {part}; under {lowest:g} mm is right"
