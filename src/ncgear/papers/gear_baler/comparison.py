"""Sections 4.3.2 and 4.3.3, Figs. 13 and 14: power and acceleration beside those of other mechanisms."""

from __future__ import annotations

from ncgear.papers.entry import Computed, Entry, Printed, Verdict, equations, of
from ncgear.papers.gear_baler.motion import NOT_THERE
from ncgear.papers.gear_baler.published import (
    EARLIER_ACCELERATION_MM_S2,
    EARLIER_POWER_W,
    EARLIER_RPM,
    PROPOSED_POWER_W,
    SIMULATION_RPM,
    at_speed,
    law_rpm,
    other_at_speed,
    uniform_at_speed,
)


def power(rpm: float) -> Computed:
    """Largest power of the working stroke in W."""
    return of(at_speed(rpm).peak_power_w.value)


def saving(one_w: float, other_w: float) -> Computed:
    """Percent by which one power is below the other."""
    return of(100.0 * (1.0 - one_w / other_w))


def other_reading() -> Computed:
    """Largest power in W and acceleration of the working stroke in mm/s^2, at 20 r/min, of the other reading."""
    found = other_at_speed(SIMULATION_RPM)
    return of(found.peak_power_w.value, found.peak_acceleration_working_mm_s2.value)


def acceleration(rpm: float, *, whole_cycle: bool) -> float:
    """Largest acceleration in mm/s^2, in the working stroke or over the cycle."""
    found = at_speed(rpm)
    peak = found.peak_acceleration_cycle_mm_s2 if whole_cycle else found.peak_acceleration_working_mm_s2
    return peak.value


A1_AT_20 = "a1 is read at the simulation's 20 r/min, and v1 and v2 at the 52.81 r/min that closes the stroke"

POWER = (
    Entry(
        ("Fig. 13", *equations("4.1", "4.2")), "largest power", Printed(("6300",), "W"), Verdict.UNDER_READING,
        lambda: power(SIMULATION_RPM),
        f"At 20 r/min; {A1_AT_20}. The resistance is negative below 33.7 mm and counts as zero there.",
    ),
    Entry(
        ("Fig. 13",), "largest power at the speed at which v1 and v2 hold", Printed(("6300",), "W"),
        Verdict.NOT_REPRODUCIBLE, lambda: power(law_rpm()),
        "Power is proportional to speed, and the printed one belongs to 20 r/min.",
    ),
    Entry(
        ("Fig. 13", "Fig. 14"), "largest power and acceleration with a1 read at the speed of v1 and v2",
        Printed(("6300", "1500"), "W, mm/s2"), Verdict.NOT_REPRODUCIBLE, other_reading,
        "The stroke then closes at 51.31 r/min, and the ratio runs from 0.12 to 7.65: no gears to use.",
    ),
    Entry(
        ("Fig. 13",), "earlier mechanism: largest power", Printed(("18750",), "W"), Verdict.NEEDS_DATA, None, NOT_THERE
    ),
    Entry(
        ("section 1",), "power of the earlier mechanism below that of an even crank", Printed(("28.6",), "%"),
        Verdict.NEEDS_DATA,
        lambda: saving(EARLIER_POWER_W, uniform_at_speed(EARLIER_RPM).peak_power_w.value),
        "The speed is not given. Computed with this linkage and resistance at 60 r/min, the round number that comes "
        "nearest.",
    ),
    Entry(
        ("Fig. 13",), "power saved, from the two printed powers", Printed(("66.4",), "%"), Verdict.UNDER_READING,
        lambda: saving(PROPOSED_POWER_W, EARLIER_POWER_W),
        "The quotient of the printed numbers, which belong to 20 r/min and to about 60 r/min.",
    ),
    Entry(
        ("Fig. 13",), "power saved at equal productivity", Printed(("66.4",), "%"), Verdict.NOT_REPRODUCIBLE,
        lambda: saving(at_speed(EARLIER_RPM).peak_power_w.value, EARLIER_POWER_W),
        "At the 60 r/min that the earlier mechanism's power belongs to, the new one needs no less.",
    ),
)  # fmt: skip

ACCELERATION = (
    Entry(
        ("Fig. 14",), "largest acceleration, in the working stroke", Printed(("1500",), "mm/s2"),
        Verdict.UNDER_READING, lambda: of(acceleration(SIMULATION_RPM, whole_cycle=False)), f"{A1_AT_20}.",
    ),
    Entry(
        ("Fig. 14",), "largest acceleration, over the whole cycle", Printed(("1500",), "mm/s2"),
        Verdict.NOT_REPRODUCIBLE, lambda: of(acceleration(SIMULATION_RPM, whole_cycle=True)),
        "The largest is in the return, which the printed curve leaves out.",
    ),
    Entry(
        ("Fig. 14",), "earlier mechanism: largest acceleration", Printed(("45000",), "mm/s2"), Verdict.NEEDS_DATA,
        None, NOT_THERE,
    ),
    Entry(
        ("Fig. 14",), "acceleration by that of the earlier mechanism, at equal speed and over the whole cycle",
        Printed(("0.1",)), Verdict.NOT_REPRODUCIBLE,
        lambda: of(acceleration(EARLIER_RPM, whole_cycle=True) / EARLIER_ACCELERATION_MM_S2),
        "An order of magnitude is what 20 r/min and the working stroke alone make of it.",
    ),
)  # fmt: skip
