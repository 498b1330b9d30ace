"""Mechanisms by plain geometry in mpmath: circles and lines that meet, energy, and nothing of the program's formulas.

Each linkage says where its bodies are at a direction of the crank, as complex numbers in mm in the frame of the scene:
the crank's axis at 0, the crank turning clockwise.  Bodies are ``name: (mass, inertia about the centre, place of the
centre, angle)``.  ``torque`` is Lagrange's: d/dt of the kinetic energy's slope less the energy's own slope, plus what
weights and load take.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from mpmath import mp

Body = tuple[Any, Any, Any, Any]


@dataclass(frozen=True)
class Linkage:
    """A linkage whose output is at ``place(q)`` when the crank has turned clockwise by q from ``start()``."""

    lengths: Mapping[str, Any]
    masses: Mapping[str, Any] = field(default_factory=dict)
    gravity: complex = 0j

    def __getattr__(self, name: str) -> Any:
        """A length by its key, a mass or 0 by its name."""
        if name.startswith("__"):
            raise AttributeError(name)
        found = self.lengths.get(name, self.masses.get(name, 0))
        return mp.mpf(found)

    def start(self) -> Any:
        """Direction of the crank at the retracted dead centre."""
        raise NotImplementedError

    def working_angle(self) -> Any:
        """Crank angle to the extended dead centre."""
        raise NotImplementedError

    def place(self, q: Any) -> Any:
        """Where the output is, in mm or rad."""
        raise NotImplementedError

    def others(self, q: Any) -> dict[str, Body]:
        """All bodies but the crank."""
        raise NotImplementedError

    def pin(self, q: Any) -> Any:
        """The crank's pin."""
        return self.crank_mm * mp.expj(self.start() - q)

    def displacement(self, q: Any) -> Any:
        """From the retracted dead centre."""
        return self.place(q) - self.place(0)

    def bodies(self, q: Any) -> dict[str, Body]:
        """All bodies, the crank with the inertia about its own centre."""
        center, mass = self.crank_center_mm, self.crank_kg
        own = self.crank_inertia_kg_mm2 + self.driven_inertia_kg_mm2 - mass * center**2
        angle = self.start() - q
        return {**self.others(q), "crank": (mass, own, center * mp.expj(angle), angle)}

    def torque(self, q: Any, speed: Any, acceleration: Any, load: Any) -> Any:
        """Torque on the crank in N mm at a crank's speed and acceleration, under a load in N or N mm on the output."""

        def inertia(angle: Any) -> Any:
            # Differences over a step of as many digits as are wanted, of numbers that have twice as many.
            step = mp.mpf(10) ** -mp.dps
            with mp.workdps(2 * mp.dps + 5):
                before, after = (self.bodies(angle + side * step) for side in (-1, 1))
                return sum(
                    mass * abs((after[name][2] - place) / (2 * step)) ** 2
                    + own * ((after[name][3] - turned) / (2 * step)) ** 2
                    for name, (mass, own, place, turned) in before.items()
                )

        def potential(angle: Any) -> Any:
            return -sum(mp.re(mass * mp.conj(self.gravity) * at) for mass, _, at, _ in self.bodies(angle).values())

        moved = inertia(q) * acceleration + mp.diff(inertia, q) * speed**2 / 2
        return moved / 1000 + mp.diff(potential, q) + load * mp.diff(self.place, q)


class CrankSlider(Linkage):
    """A circle about the crank's pin meets the slider's line."""

    def start(self) -> Any:
        return mp.pi + mp.asin(self.offset_mm / (self.rod_mm - self.crank_mm))

    def working_angle(self) -> Any:
        return self.start() - mp.asin(self.offset_mm / (self.rod_mm + self.crank_mm))

    def place(self, q: Any) -> Any:
        pin = self.pin(q)
        return mp.re(pin) + mp.sqrt(self.rod_mm**2 - (self.offset_mm - mp.im(pin)) ** 2)

    def others(self, q: Any) -> dict[str, Body]:
        pin, wrist = self.pin(q), mp.mpc(self.place(q), self.offset_mm)
        rod = (wrist - pin) / self.rod_mm
        return {
            "slider": (self.slider_kg, 0, wrist, mp.mpf(0)),
            "rod": (self.rod_kg, self.rod_inertia_kg_mm2, pin + self.rod_center_mm * rod, mp.arg(rod)),
        }


class ScotchYoke(Linkage):
    """The slider has the pin's place along its line."""

    def start(self) -> Any:
        return mp.pi

    def working_angle(self) -> Any:
        return mp.pi

    def place(self, q: Any) -> Any:
        return mp.re(self.pin(q))

    def others(self, q: Any) -> dict[str, Body]:
        return {"slider": (self.slider_kg, 0, mp.mpc(self.place(q)), mp.mpf(0))}


class CrankRocker(Linkage):
    """A circle about the crank's pin meets one about the rocker's axis."""

    def _at(self, distance: Any) -> Any:
        """The rocker's pin at a distance from the crank's axis."""
        x = (self.ground_mm**2 + distance**2 - self.rocker_mm**2) / (2 * self.ground_mm)
        return mp.mpc(x, self.side * mp.sqrt(distance**2 - x**2))

    def start(self) -> Any:
        return mp.arg(-self._at(self.coupler_mm - self.crank_mm)) % (2 * mp.pi)

    def working_angle(self) -> Any:
        return (self.start() - mp.arg(self._at(self.coupler_mm + self.crank_mm))) % (2 * mp.pi)

    def rocker_pin(self, q: Any) -> Any:
        """Of the two places where the circles meet, the one on the rocker's side."""
        pin = self.pin(q)
        between = self.ground_mm - pin
        far = abs(between)
        along = (far**2 + self.coupler_mm**2 - self.rocker_mm**2) / (2 * far)
        height = mp.sqrt(self.coupler_mm**2 - along**2)
        return pin + between / far * mp.mpc(along, self.side * height)

    def place(self, q: Any) -> Any:
        return abs(mp.arg((self.rocker_pin(q) - self.ground_mm) / -1))

    def others(self, q: Any) -> dict[str, Body]:
        pin, end = self.pin(q), self.rocker_pin(q)
        rocker, coupler = (end - self.ground_mm) / self.rocker_mm, (end - pin) / self.coupler_mm
        own = self.rocker_inertia_kg_mm2 - self.rocker_kg * self.rocker_center_mm**2
        center = pin + self.coupler_center_mm * coupler
        start = self.start() - mp.pi
        return {
            "rocker": (
                self.rocker_kg,
                own,
                self.ground_mm + self.rocker_center_mm * rocker,
                -self.side * self.place(q),
            ),
            "coupler": (
                self.coupler_kg,
                self.coupler_inertia_kg_mm2,
                center,
                mp.arg(coupler * mp.expj(-start)) + start,
            ),
        }


class SlottedLever(Linkage):
    """The line from the lever's axis through the crank's pin; the ram has the place of the lever's far pin."""

    def start(self) -> Any:
        return mp.pi + mp.asin(self.crank_mm / self.pivot_mm)

    def working_angle(self) -> Any:
        return self.start() + mp.asin(self.crank_mm / self.pivot_mm)

    def lever(self, q: Any) -> Any:
        """Direction of the lever."""
        along = self.pin(q) + mp.mpc(0, self.pivot_mm)
        return along / abs(along)

    def place(self, q: Any) -> Any:
        return self.lever_mm * mp.re(self.lever(q))

    def others(self, q: Any) -> dict[str, Body]:
        lever, axis = self.lever(q), mp.mpc(0, -self.pivot_mm)
        own = self.lever_inertia_kg_mm2 - self.lever_kg * self.lever_center_mm**2
        return {
            "ram": (self.slider_kg, 0, mp.mpc(self.place(q), self.lever_mm - self.pivot_mm), mp.mpf(0)),
            "lever": (self.lever_kg, own, axis + self.lever_center_mm * lever, mp.arg(lever)),
            "block": (self.block_kg, 0, self.pin(q), mp.arg(lever)),
        }


class RackPinion(Linkage):
    """The rack goes as far as the pitch circle rolls."""

    def start(self) -> Any:
        return mp.pi

    def working_angle(self) -> Any:
        return 2 * mp.pi

    def place(self, q: Any) -> Any:
        return self.radius_mm * q

    def others(self, q: Any) -> dict[str, Body]:
        return {"rack": (self.slider_kg, 0, mp.mpc(self.place(q), self.radius_mm), mp.mpf(0))}


LINKAGES: Mapping[str, Callable[..., Linkage]] = {
    "crank_slider": CrankSlider,
    "scotch_yoke": ScotchYoke,
    "crank_rocker": CrankRocker,
    "slotted_lever": SlottedLever,
    "rack_pinion": RackPinion,
}
