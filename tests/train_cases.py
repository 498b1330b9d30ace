"""Planetary trains that several tests share, and Newton's and Euler's equations of all their bodies."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import numpy as np

from ncgear.design.trains.planetary import Planetary
from ncgear.trains.loads import PutMass, body_of
from ncgear.trains.tip_path import WishedPath
from ncgear.trains.train import Train

GEARS = {"teeth": 18, "module_mm": 2.0, "face_width_mm": 8.0, "backlash_mm": 0.05}
UNEVEN = [1.3, 1.0, 0.8, 0.9, 1.0, 1.1]

POINTS = np.array([0.0, -32.0, -60.0, -85.0, -95.0, -80.0, -40.0, 10.0, 20.0, 15.0, 22.0, 24.0]) + 1j * np.array(
    [0.0, 20.0, 70.0, 130.0, 180.0, 212.0, 225.0, 215.0, 180.0, 130.0, 75.0, 22.0]
)
WISHED = WishedPath(POINTS, np.full(POINTS.size, 0.1))


def planetary(**keys: Any) -> Train:
    """The planetary train of keys, made once; gears that are not round where no ratio is given."""
    return _made(json.dumps({"speed_rpm": 60.0, "ratio": UNEVEN, "gears": GEARS, **keys}))


@cache
def _made(keys: str) -> Train:
    return Planetary.model_validate(json.loads(keys)).train()


STEP_RAD = 2e-3


class NewtonAndEuler:
    """Torque of the carrier and force on the frame, from each body's own equations, with the forces in all joints.

    Velocities and accelerations are differences of poses; the force between two gears acts in the pitch point, which
    divides the line of their axes by their speeds against the carrier, at 20 deg to the way of the pitch point in the
    first gear, and away from it.  ``teeth`` and ``axes`` have the forces in N as soon as all is solved.
    """

    def __init__(self, train: Train, density: float, tool_kg: float, driving: float) -> None:
        self.asked, self.driving = (train, density, tool_kg), driving
        self.teeth: dict[tuple[str, str], complex] = {}
        self.axes: dict[str, complex] = {}
        self.train, self.speed = train, train.speed_rpm * 2.0 * np.pi / 60.0
        poses = train.poses_at(driving + STEP_RAD * np.arange(-2, 3))
        self.place = {p.name: poses.x_mm[n] + 1j * poses.y_mm[n] for n, p in enumerate(train.parts)}
        self.angle = {p.name: poses.angle_rad[n] for n, p in enumerate(train.parts)}
        tools = [PutMass(t.part, complex(*t.at_mm), tool_kg) for t in train.traces]
        self.bodies = {p.name: body_of(p, density, [t for t in tools if t.part == p.name]) for p in train.parts}

    def rates(self, values: Any) -> tuple[Any, Any]:
        """First and second derivative by time, of five values."""
        a, b, c, d, e = values
        first, second = (a - 8 * b + 8 * d - e) / 12, (-a + 16 * b - 30 * c + 16 * d - e) / 12
        return first / STEP_RAD * self.speed, second / STEP_RAD**2 * self.speed**2

    def load(self, names: list[str], pivot: complex) -> tuple[float, complex]:
        """Moment about a pivot, and force, that bodies which are one need: mass times acceleration less weight."""
        turning, force = 0.0, 0.0j
        for name in names:
            body = self.bodies[name]
            center = self.place[name] + body.center_mm * np.exp(1j * self.angle[name])
            one = body.kg * (self.rates(center)[1] + 9806.65j)
            turning += ((center[2] - pivot).conjugate() * one).imag + body.kg_mm2 * self.rates(self.angle[name])[1]
            force += one
        return turning, force

    def pitch_point(self, first: str, second: str) -> complex:
        """The pitch point of two gears."""
        one, other = (self.rates(self.angle[name] - self.angle["carrier"])[0] for name in (first, second))
        start, end = self.place[first][2], self.place[second][2]
        return complex(start + (end - start) * other / (other - one))

    def mesh(self, first: str, second: str, turning: float) -> tuple[complex, complex]:
        """The force on the second gear that gives it a moment about its axis, and the pitch point."""
        point, ends = self.pitch_point(first, second), []
        for step in (-STEP_RAD, STEP_RAD):
            near = NewtonAndEuler(*self.asked, self.driving + step)
            seen = (near.pitch_point(first, second) - near.place[first][2]) * np.exp(-1j * near.angle[first][2])
            ends.append(seen * np.exp(1j * self.angle[first][2]))
        way = (ends[1] - ends[0]) / abs(ends[1] - ends[0])
        away = 1j * way
        if (away.conjugate() * (point - self.place[first][2])).real < 0.0:
            away = -away
        arm = point - self.place[second][2]
        pushed = [np.cos(np.radians(20.0)) * side + np.sin(np.radians(20.0)) * away for side in (way, -way)]
        sizes = [turning / (arm.conjugate() * push).imag for push in pushed]
        return next(size * push for size, push in zip(sizes, pushed, strict=True) if size >= 0.0), point

    def solved(self) -> tuple[float, complex, list[float]]:
        """Torque in N m, the force of inertia on the frame in N, and the moments of the meshes of the first arm in N m.

        These act on planet and idler, counter-clockwise about their axes.
        """
        axis = self.place["carrier"][2]
        torque = self.load(["carrier"], axis)[0]
        moments: list[float] = []
        for trace in self.train.traces:
            end = trace.name.removeprefix("path")
            sides = (
                ([f"planet{end}", f"arm{end}"], f"second_idler{end}"),
                ([f"idler{end}", f"second_idler{end}"], "sun"),
            )
            back, at = 0.0j, 0.0j
            for names, driver in sides:
                pivot = self.place[names[0]][2]
                turning, force = self.load(names, pivot)
                # What the gear before pushes, this body pushes back.
                turning -= ((at - pivot).conjugate() * back).imag
                moments.append(turning / 1e6)
                pushed, point = self.mesh(driver, names[0], turning)
                self.teeth[driver, names[0]] = pushed / 1e3
                self.axes[names[0]] = (force - back - pushed) / 1e3
                torque += ((pivot - axis).conjugate() * (force - back - pushed)).imag
                back, at = -pushed, point
        weights = 9806.65j * sum(body.kg for body in self.bodies.values())
        return torque / 1e6, (weights - self.load([*self.bodies], axis)[1]) / 1e3, moments[:2]
