"""How fast the picture may run: at a pace that the eye follows, or by the machine's own speed."""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.output.numbers import shown

READABLE_DEG_S = 30.0
"""Pace at which the eye follows a tooth through the mesh: a turn of the driving gear in twelve seconds."""

PACES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
"""Multiples of the operating speed to choose from."""

DEG_S_PER_RPM = 6.0


@dataclass(frozen=True)
class Pace:
    """How fast the picture runs, in degrees of the driving gear per second."""

    name: str
    deg_s: float


def paces(speed_rpm: float) -> list[Pace]:
    """The paces of a machine, the readable one first."""
    multiples = [Pace(f"{times:g}\u00d7 ({shown(times * speed_rpm)} r/min)", times * speed_rpm) for times in PACES]
    by_speed = [Pace(pace.name, pace.deg_s * DEG_S_PER_RPM) for pace in multiples]
    return [Pace(f"readable ({READABLE_DEG_S:g}\u00b0/s)", READABLE_DEG_S), *by_speed]
