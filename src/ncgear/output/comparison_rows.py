"""The mechanisms a design is set beside: at its own speed, and, marked as such, figures at mixed speeds."""

from __future__ import annotations

from typing import Any

from ncgear.design.machine import Published
from ncgear.drive import Drive
from ncgear.kinematics.check import KinematicCheck
from ncgear.output.numbers import shown


def comparison_rows(drive: Drive) -> list[dict[str, Any]]:
    """This design, the uniform crank, and published mechanisms scaled to the operating speed; then mixed speeds.

    Each row has ``name``, ``note``, ``same_speed`` (whether it holds at the operating speed) and figures in the units
    that its keys end in, None where one is not known.
    """
    speed = drive.design.operation.speed_rpm
    rows = [
        _checked("this design", drive.check, speed, ""),
        _checked("uniform crank", drive.uniform_check, speed, _against(drive, drive.uniform_check.peak_power_w.value)),
    ]
    published = drive.design.comparison.published if drive.design.comparison else ()
    rows += [_scaled(drive, mechanism) for mechanism in published]
    for mechanism in published:
        rows += _mixed(drive, mechanism)
    return rows


def _against(drive: Drive, other_power_w: float | None) -> str:
    """Saving of peak power by this design against another mechanism at the same speed."""
    if not other_power_w:
        return ""
    saving = 100.0 * (1.0 - drive.check.peak_power_w.value / other_power_w)
    return f"this design's peak power is {abs(saving):.1f} % {'lower' if saving >= 0 else 'higher'}"


def _checked(name: str, check: KinematicCheck, speed: float, note: str) -> dict[str, Any]:
    return {
        "name": name,
        "speed_rpm": speed,
        "peak_power_w": check.peak_power_w.value,
        "mean_power_w": check.mean_power_w,
        "peak_acceleration_cycle_mm_s2": check.peak_acceleration_cycle_mm_s2.value,
        "peak_speed_mm_s": check.peak_speed_mm_s.value,
        "same_speed": True,
        "note": note,
    }


def _row(
    name: str, speed: float, power: float | None, acceleration: float | None, velocity: float | None
) -> dict[str, Any]:
    return {
        "name": name,
        "speed_rpm": speed,
        "peak_power_w": power,
        "mean_power_w": None,
        "peak_acceleration_cycle_mm_s2": acceleration,
        "peak_speed_mm_s": velocity,
    }


def _times(value: float | None, factor: float) -> float | None:
    return None if value is None else value * factor


def _scaled(drive: Drive, published: Published) -> dict[str, Any]:
    """Published figures at the operating speed: power and velocity go with the speed, acceleration with its square."""
    speed = drive.design.operation.speed_rpm
    factor = speed / published.speed_rpm
    power = _times(published.peak_power_w, factor)
    acceleration = _times(published.peak_acceleration_mm_s2, factor**2)
    velocity = _times(published.peak_speed_mm_s, factor)
    pressing = _times(published.compression_speed_mm_s, factor)
    notes = [_against(drive, power), f"compression speed {pressing:.4g} mm/s" if pressing else ""]
    row = _row(published.name, speed, power, acceleration, velocity)
    return {**row, "same_speed": True, "note": "; ".join(note for note in notes if note)}


def _mixed(drive: Drive, published: Published) -> list[dict[str, Any]]:
    """The publication's own comparison, where it set one speed's figure against another's."""
    if published.quoted_power_w is None or published.quoted_speed_rpm is None:
        return []
    acceleration, velocity = published.peak_acceleration_mm_s2, published.peak_speed_mm_s
    theirs = _row(published.name, published.speed_rpm, published.peak_power_w, acceleration, velocity)
    quoted = _row("set against it in the publication", published.quoted_speed_rpm, published.quoted_power_w, None, None)
    same = drive.check.peak_power_w.value * published.speed_rpm / drive.design.operation.speed_rpm
    note = f"at {published.speed_rpm:g} r/min this design needs {shown(same)} W"
    if published.peak_power_w:
        saving = 100.0 * (1.0 - published.quoted_power_w / published.peak_power_w)
        note = f"the {saving:.1f} % between the two rows is a difference of speed; {note}"
    return [{**theirs, "same_speed": False, "note": ""}, {**quoted, "same_speed": False, "note": note}]
