"""The figures a case is judged by, as ncgear reports them and as the high-precision reference has them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
from mpmath import mp

from ncgear.design.laws.three_segment_stroke import ThreeSegmentStroke
from ncgear.numerics.extrema import Extremum
from ncgear.pitch.pair import PitchPair
from ncgear.project.drive import Drive
from oracles import laws

SHARES = (0.013, 0.171, 0.322, 0.489, 0.631, 0.787, 0.938)
"""Of the period: angles at which phi2 is looked at, near no joint of any case."""

ASIDE = mp.mpf("1e-9")
"""Of the period: distance of the parabola's points about a reported peak.  At 40 digits its value is good to 20."""

AT_JOINT = 1e-12
"""Distance in rad from a joint of the law within which a peak is taken to be at the joint, from either side."""


@dataclass(frozen=True)
class Figure:
    """A reported value; ``at`` is where a peak is, or the angle that was asked for."""

    value: float
    at: float = 0.0


def reported(drive: Drive) -> dict[str, Figure]:
    """What ncgear says of a design."""
    low, high = drive.transmission.ratio_range
    check = drive.check
    figures = {
        **_driven(drive),
        "ratio min": _peak(low),
        "ratio max": _peak(high),
        "peak acceleration": _peak(check.peak_acceleration_cycle),
        "peak power": _peak(check.peak_power_w),
    }
    # Pitch curves of pairs in series are those of each pair
    if drive.design.stages == 1:
        figures["pitch length"] = Figure(_length(drive.pitch))
    return {name: figure for name, figure in figures.items() if figure.value}


def _length(pitch: PitchPair) -> float:
    """Length of a period of the pitch curves at unit centre distance, or of the range of gears that turn less."""
    return pitch.arc.period if pitch.toothed is None else pitch.toothed.covered_mm / pitch.center_distance_mm


def _driven(drive: Drive) -> dict[str, Figure]:
    angles = np.array(SHARES) * drive.transmission.lobes.driving_period_rad
    driven = drive.transmission.driven_angle(angles).value
    return {f"phi2 at {at:.3g} rad": Figure(float(v), float(at)) for at, v in zip(angles, driven, strict=True)}


def _peak(extremum: Extremum) -> Figure:
    return Figure(extremum.value, extremum.at)


def reference(drive: Drive, data: dict[str, Any]) -> dict[str, Any]:
    """The same figures at 40 digits; of peaks the stationary value next to the reported place."""
    law = laws.law(data, _closing(drive))
    omega = mp.mpf(data["operation"]["speed_rpm"]) * mp.pi / 30
    along: dict[str, Callable[[Any, bool], Any]] = {
        "ratio min": lambda phi, left: 1 / law.motion(phi, from_left=left)[1],
        "ratio max": lambda phi, left: 1 / law.motion(phi, from_left=left)[1],
        "peak acceleration": lambda phi, left: abs(law.slider(phi, from_left=left)[2]) * omega**2,
        "peak power": lambda phi, left: _power(data, law.slider(phi, from_left=left)) * omega / 1000,
    }
    with mp.workdps(laws.DIGITS):
        exact: dict[str, Any] = {}
        for name, figure in reported(drive).items():
            if name.startswith("phi2"):
                exact[name] = law.motion(mp.mpf(figure.at))[0]
            elif name == "pitch length":
                exact[name] = law.period_length
            else:
                exact[name] = _stationary(along[name], law, figure.at, smallest=name == "ratio min")
        return exact


def _closing(drive: Drive) -> tuple[float, float]:
    """Multiples of the return's polynomial: where the reference begins its own search."""
    motion = drive.design.motion
    if not isinstance(motion, ThreeSegmentStroke):
        return 0.0, 0.0
    coefficients = motion.stroke_law(drive.linkage, drive.transmission.lobes).return_law.polynomial.coef
    return float(coefficients[4] + 2.5 * coefficients[5]), float(coefficients[5] / 2.0)


def _power(data: dict[str, Any], slider: laws.Motion) -> Any:
    position, speed, _ = slider
    force = laws.polynomial(tuple(mp.mpf(c) for c in data["resistance"]["polynomial_n"]), position)
    return force * speed


def _stationary(along: Callable[[Any, bool], Any], law: laws.Law, at: float, *, smallest: bool) -> Any:
    """Extreme value of the parabola through three points about a place, or of both sides of a joint."""
    joint = _joint(law, at)
    if joint is not None:
        return (min if smallest else max)(along(joint, False), along(joint, True) if joint else along(joint, False))
    place, step = mp.mpf(at), ASIDE * law.joints[-1]
    before, middle, after = (along(place + k * step, False) for k in (-1, 0, 1))
    slope, bend = (after - before) / 2, after - 2 * middle + before
    return middle - slope**2 / (2 * bend) if bend else middle


def _joint(law: laws.Law, at: float) -> Any:
    """The joint that a place is at, in any period; None where it is at none."""
    period = law.joints[-1]
    found = [joint + k * period for k in range(law.lobes[1]) for joint in law.joints]
    return next((joint for joint in found if abs(joint - at) <= AT_JOINT), None)


def sampled_peak(drive: Drive, samples: int = 20_001) -> float:
    """Largest acceleration in mm/s^2 among dense samples of every piece, which no reported peak may be below."""
    omega = drive.design.operation.speed_rpm * pi / 30.0
    lobes, largest = drive.transmission.lobes, 0.0
    for cycle in range(lobes.driven):
        for piece in drive.transmission.pieces:
            driven = piece.driven_angle(np.linspace(piece.start_rad, piece.end_rad, samples), 2)
            moved = drive.linkage.displacement(driven + cycle * lobes.driven_period_rad)
            largest = max(largest, float(np.abs(moved.derivative(2)).max()) * omega**2)
    return largest
