"""Frequencies that shake a machine, beside its natural frequencies.

A shaft at n r/min shakes at n/60, its bearings and sprockets at that times their rollers and teeth; for these and for
engines see Z. Tang, Y. Li, Y. Zhou, H. Zhang, Shock and Vibration 2019, eqs. 9 to 13.  The slider shakes at the
harmonics of its acceleration, which are the Fourier coefficients of the actual motion, integrated panel by panel.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ncgear.balance.mechanism import WRIST, DrivenCrank, accelerations
from ncgear.balance.waveform import Waveform
from ncgear.frozen import dataclass
from ncgear.numerics.chebyshev import PiecewiseChebyshev

NEGLIGIBLE = 1e-9
"""Harmonics below this share of the strongest are left out: where symmetry forbids them they are 1e-14 by rounding."""


@dataclass(frozen=True)
class Excitation:
    """One frequency: its source and kind; the amplitude is known for harmonics of the slider only."""

    source: str
    kind: str
    frequency_hz: float
    amplitude_m_s2: float | None = None


@dataclass(frozen=True)
class Shaft:
    """A shaft, with the number of rollers in its bearing and of teeth on its sprocket or gear, if any.

    ``roller_ratio`` is the diameter of a roller divided by the diameter of the rollers' pitch circle, times the cosine
    of the contact angle.
    """

    name: str
    speed_rpm: float
    rollers: int | None = None
    teeth: int | None = None
    roller_ratio: float | None = None


@dataclass(frozen=True)
class Engine:
    """A piston engine; ``inertia_order`` of its strongest free inertia force is 2 for four cylinders in line."""

    name: str
    speed_rpm: float
    cylinders: int
    strokes: int
    inertia_order: float = 2.0


@dataclass(frozen=True)
class Margin:
    """An excitation and the natural frequency nearest to it by ratio; ``ratio`` is excitation / natural frequency."""

    excitation: Excitation
    nearest_natural_hz: float
    ratio: float
    near: bool


def of_shaft(shaft: Shaft) -> list[Excitation]:
    """Rotation, passing of the bearing's z rollers, and meshing of the teeth.

    Without ``roller_ratio`` the rollers pass z times a turn, as if the cage turned with the shaft (the paper's equation
    11, about twice the true frequency).  With it they pass z/2 (1 - ratio) times a turn over the outer race and
    z/2 (1 + ratio) times over the inner race, which turns.
    """
    turning = shaft.speed_rpm / 60.0
    found = [Excitation(shaft.name, "rotation", turning)]
    if shaft.rollers is not None and shaft.roller_ratio is None:
        found.append(Excitation(shaft.name, "rollers", shaft.rollers * turning))
    elif shaft.rollers is not None and shaft.roller_ratio is not None:
        half = shaft.rollers / 2.0 * turning
        found.append(Excitation(shaft.name, "rollers, outer race", half * (1.0 - shaft.roller_ratio)))
        found.append(Excitation(shaft.name, "rollers, inner race", half * (1.0 + shaft.roller_ratio)))
    if shaft.teeth is not None:
        found.append(Excitation(shaft.name, "teeth", shaft.teeth * turning))
    return found


def of_engine(engine: Engine) -> list[Excitation]:
    """Rotation n / 60, combustion 2 n i / (60 c) with i cylinders and c strokes, and inertia of order Q, Q n / 60."""
    turning = engine.speed_rpm / 60.0
    combustion = 2.0 * turning * engine.cylinders / engine.strokes
    return [
        Excitation(engine.name, "rotation", turning),
        Excitation(engine.name, "combustion", combustion),
        Excitation(engine.name, "inertia", engine.inertia_order * turning),
    ]


def of_slider(name: str, mechanism: DrivenCrank, count: int) -> list[Excitation]:
    """Harmonics of the slider's acceleration in m/s^2, of the first ``count``, that are not negligible."""
    form = accelerations(mechanism).form
    scale = mechanism.linkage.crank_mm * mechanism.speed_rad_s**2 / 1000.0
    waves = Waveform(PiecewiseChebyshev(form.breaks, scale * form.coefficients[:, :, WRIST])).harmonics(count)
    cycles = mechanism.speed_rad_s / mechanism.transmission.cycle_rad
    sizes = 2.0 * np.abs(waves)
    present = [k for k in range(1, count + 1) if sizes[k] > NEGLIGIBLE * sizes[1:].max()]
    return [Excitation(name, f"harmonic {k}", k * cycles, float(sizes[k])) for k in present]


def margins(excitations: Sequence[Excitation], natural_hz: Sequence[float], band: float) -> list[Margin]:
    """Each excitation beside its nearest natural frequency; near if they differ by at most its share ``band``."""
    natural = np.array(natural_hz)
    found = []
    for excitation in excitations:
        nearest = float(natural[np.argmin(np.abs(np.log(excitation.frequency_hz / natural)))])
        ratio = excitation.frequency_hz / nearest
        found.append(Margin(excitation, nearest, ratio, abs(ratio - 1.0) <= band))
    return found


def critical_speed_rpm(natural_hz: float) -> float:
    """Speed in r/min at which a shaft's rotation meets a natural frequency."""
    return 60.0 * natural_hz
