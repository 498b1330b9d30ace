"""The keys of a wished path: points, angles of the tool and pace of stretches, for an arm on a planet."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, Strict

from ncgear.design.keys.base import Faults, Length, Model, Place, Several, fault, optional, required

if TYPE_CHECKING:
    from ncgear.trains.pace import PacedStretch
    from ncgear.trains.tip_path import WishedPath

Point = Annotated[tuple[Place, Place], Strict(False)]


class ToolAngle(Model):
    """The angle of the tool at a point of the path."""

    point: int = required("number of the point, from 1", ge=1)
    angle_deg: float = required(
        "angle of the tool there in degrees, counter-clockwise from the x axis", ge=-360.0, le=360.0
    )


class PaceKeys(Model):
    """The pace of the tip on a stretch of its path."""

    RULES = ("at least one of share speed_mm_s",)

    from_point: int = required("number of the point at which the stretch begins, from 1", ge=1)
    to_point: int = required("number of the point at which it ends, on the way of the tip", ge=1)
    share: Annotated[float, Field(gt=0.0, lt=1.0)] | None = optional(
        "share of a turn of the driving shaft that the stretch takes; left out: any"
    )
    speed_mm_s: Annotated[float, Field(gt=0.0, le=1e6)] | None = optional(
        "greatest speed of the tip on it in mm/s; left out: any"
    )


class TipPathKeys(Model):
    """The wished path of the arm's tip: a closed path in the frame of the machine."""

    points_mm: Annotated[Several[Point], Field(min_length=6, max_length=200)] = required(
        "points [x, y] in mm in the order in which the tip passes them; the path is closed"
    )
    tolerance_mm: Annotated[float, Field(gt=0.0, le=100.0)] = optional(
        "how far the path may be from each point in mm", 0.1
    )
    tolerances_mm: Several[Annotated[float, Field(gt=0.0, le=100.0)]] | None = optional(
        "the same, one for each point; left out: tolerance_mm for all"
    )
    straight: Several[Annotated[int, Field(ge=1)]] | None = optional(
        "numbers of points from which the tip goes straight to the next one; left out: smooth from point to point"
    )
    pace: Several[PaceKeys] | None = optional(
        "stretches that take their time or are passed slowly; the carrier then turns unevenly, as a pair of gears with "
        "the found ratio drives it; left out: it turns evenly"
    )
    tool: Several[ToolAngle] | None = optional("angles of the tool at some points; left out: any angle")
    tool_tolerance_deg: Annotated[float, Field(gt=0.0, le=180.0)] = optional(
        "how far the tool may be from these angles, in degrees", 5.0
    )
    axis_mm: Point | None = optional("place [x, y] of the carrier's axis in mm; left out: it is sought")
    axis_from_mm: Point | None = optional(
        "corner [x, y] in mm of a rectangle in which the axis is sought; left out: anywhere"
    )
    axis_to_mm: Point | None = optional("the opposite corner, with greater x and y")
    longest_mm: Length = optional("greatest length of carrier and arm in mm", 1000.0)
    pressure_angle_deg: Annotated[float, Field(gt=20.0, lt=85.0)] = optional(
        "largest pressure angle of the gears that is sought, the rack's included, in degrees", 65.0
    )
    forward_mm_s: Annotated[float, Field(ge=-1e5, le=1e5)] = optional(
        "speed of the machine over the ground in mm/s, along x; left out: it stands", 0.0
    )

    RULES = (
        "tolerances_mm as many as points_mm",
        "axis_from_mm with axis_to_mm",
        "at most one of axis_mm axis_from_mm",
    )

    def wished(self) -> WishedPath:
        """The path of the keys."""
        import numpy as np

        from ncgear.trains.tip_path import WishedPath

        points = np.array(self.points_mm) @ np.array([1.0, 1.0j])
        tolerances = np.array(self.tolerances_mm or [self.tolerance_mm] * len(points))
        tools = tuple((tool_angle.point - 1, radians(tool_angle.angle_deg)) for tool_angle in self.tool or ())
        path = WishedPath(points, tolerances, tools, radians(self.tool_tolerance_deg))
        return path.straightened([number - 1 for number in self.straight]) if self.straight else path

    def stretches(self, wished: WishedPath) -> list[PacedStretch]:
        """The stretches with their pace."""
        from ncgear.trains.pace import PacedStretch

        return [
            PacedStretch(
                wished.place(stretch.from_point), wished.place(stretch.to_point), stretch.share, stretch.speed_mm_s
            )
            for stretch in self.pace or ()
        ]

    def _corners_are_apart(self) -> Faults:
        if self.axis_from_mm is not None and self.axis_to_mm is not None:
            for low, high in zip(self.axis_from_mm, self.axis_to_mm, strict=True):
                if high <= low:
                    yield fault("axis_to_mm", f"{high:g} given, but axis_from_mm has {low:g} there; more is right")

    def _points_are_there(self) -> Faults:
        for number, tool_angle in enumerate(self.tool or ()):
            if tool_angle.point > len(self.points_mm):
                yield fault(f"tool.{number}.point", f"{tool_angle.point} given; 1 to {len(self.points_mm)} are right")
        for place, number in enumerate(self.straight or ()):
            if number > len(self.points_mm):
                yield fault(f"straight.{place}", f"{number} given; 1 to {len(self.points_mm)} are right")
        for place, pace in enumerate(self.pace or ()):
            for name in ("from_point", "to_point"):
                if getattr(pace, name) > len(self.points_mm):
                    said = f"{getattr(pace, name)} given; 1 to {len(self.points_mm)} are right"
                    yield fault(f"pace.{place}.{name}", said)
