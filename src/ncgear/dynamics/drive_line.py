"""What turns the driving gear: a speed that nothing changes, or a motor with a flywheel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from ncgear.numerics.arrays import Array


class DriveLine(Protocol):
    """Answers a moment of the teeth in N mm at a driving speed in rad/s."""

    @property
    def speed_rad_s(self) -> float:
        """Speed without load."""
        ...

    @property
    def inertia_n_mm_s2(self) -> float:
        """Inertia of the driving shaft; 0 where nothing changes its speed."""
        ...

    @property
    def starting_rad_s(self) -> float:
        """Speed that the drive has where it is started from rest."""
        ...

    def answer(self, speed_rad_s: Array, moment_n_mm: Array) -> tuple[Array, Array]:
        """Acceleration of the driving shaft in rad/s^2, and torque of the drive in N mm."""
        ...


@dataclass(frozen=True)
class EvenDrive:
    """Turns at one speed, whatever torque that takes."""

    speed_rad_s: float
    inertia_n_mm_s2: float = 0.0

    @property
    def starting_rad_s(self) -> float:
        """Its one speed, from the first moment on."""
        return self.speed_rad_s

    def answer(self, speed_rad_s: Array, moment_n_mm: Array) -> tuple[Array, Array]:
        """No acceleration; the torque against the teeth's moment."""
        return 0.0 * moment_n_mm, -moment_n_mm


@dataclass(frozen=True)
class Motor:
    """Torque falls in a line from the stall torque at rest to nothing at ``speed_rad_s``, and brakes beyond it.

    ``inertia_n_mm_s2`` is that of the whole driving shaft, flywheel and driving gear included.
    """

    speed_rad_s: float
    stall_torque_n_mm: float
    inertia_n_mm_s2: float

    @property
    def starting_rad_s(self) -> float:
        """None."""
        return 0.0

    def answer(self, speed_rad_s: Array, moment_n_mm: Array) -> tuple[Array, Array]:
        """Acceleration by what the motor gives beyond the teeth's moment; the motor's torque."""
        torque = self.stall_torque_n_mm * (1.0 - speed_rad_s / self.speed_rad_s)
        return (torque + moment_n_mm) / self.inertia_n_mm_s2, torque
