"""Tables 6 and 7: readings on the track beam, and the columns that the paper makes of them."""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.papers.entry import Computed, Entry, Printed, Verdict, computed, half_step, texts


@dataclass(frozen=True)
class Readings:
    """Largest displacement upwards and downwards in mm at the sixteen points, as printed."""

    up: tuple[str, ...]
    down: tuple[str, ...]

    def combined(self, up: float, down: float) -> Computed:
        """Sum of both columns with factors, and how far their rounding may move it."""
        pairs = list(zip(self.up, self.down, strict=True))
        values = tuple(up * float(one) + down * float(other) for one, other in pairs)
        return Computed(values, tuple(abs(up) * half_step(one) + abs(down) * half_step(other) for one, other in pairs))

    @property
    def steadiest(self) -> Computed:
        """Number of the point that moves least."""
        peaks = self.combined(1.0, -1.0).values
        return computed(1 + peaks.index(min(peaks)))


WITHOUT = Readings(
    texts("4.9 1.85 1.43 1.34 0.97 0.85 1.04 1.77 2.14 3.27 4.81 4.78 5.54 6.62 6.4 7.4"),
    texts("-3.86 -2.77 -2.42 -2.12 -1.4 -1.2 -1.42 -2.81 -2.51 -3.7 -4.67 -4.97 -5.74 -6.69 -6.32 -7.56"),
)
MADE_WITHOUT = (
    texts("8.76 4.62 3.85 3.46 2.37 2.05 2.46 4.58 4.65 6.97 9.48 9.75 11.28 13.31 12.72 14.96"),
    texts("4.38 2.31 1.925 1.73 1.185 1.025 1.23 2.29 2.325 3.485 4.74 4.875 5.64 6.655 6.36 7.48"),
    texts("1.04 -0.92 -0.99 -0.78 -0.43 -0.35 -0.38 -1.04 -0.37 -0.43 0.14 -0.19 -0.2 -0.07 0.08 -0.16"),
)

WITH = Readings(
    texts("0.09 0.05 0.07 0.11 0.07 0.07 0.06 0.25 0.42 0.44 0.18 0.56 0.23 0.14 0.09 0.12"),
    texts("-0.07 -0.07 -0.05 -0.09 -0.07 -0.07 -0.08 -0.18 -0.47 -0.47 -0.17 -0.55 -0.30 -0.21 -0.11 -0.17"),
)
MADE_WITH = (
    texts("0.16 0.13 0.12 0.20 0.14 0.14 0.13 0.43 0.88 0.91 0.35 1.11 0.53 0.35 0.20 0.30"),
    texts("0.08 0.06 0.06 0.10 0.07 0.07 0.07 0.21 0.44 0.46 0.17 0.56 0.27 0.17 0.10 0.15"),
    texts("0.02 -0.02 0.02 0.02 0.00 0.01 -0.02 0.07 -0.05 -0.03 0.00 0.00 -0.08 -0.07 -0.03 -0.05"),
)
"""Columns of peaks, means and differences that the paper makes of the readings."""


def _table(
    place: str, readings: Readings, peak: tuple[str, ...], mean: tuple[str, ...], difference: tuple[str, ...]
) -> tuple[Entry, ...]:
    """Entries of a table with its columns of peaks, means and differences."""
    reproduced = Verdict.REPRODUCED
    return (
        Entry(
            (place,), "amplitudes up and down at sixteen points", Printed((readings.up[-1], readings.down[-1]), "mm"),
            Verdict.NEEDS_DATA, None, "The records of the measurement; the last point's stand for all.",
        ),
        Entry((place,), "peak to peak", Printed(peak, "mm"), reproduced, lambda: readings.combined(1.0, -1.0)),
        Entry((place,), "means of up and down", Printed(mean, "mm"), reproduced, lambda: readings.combined(0.5, -0.5)),
        Entry(
            (place,), "differences of up and down", Printed(difference, "mm"), reproduced,
            lambda: readings.combined(1.0, 1.0),
        ),
    )  # fmt: skip


ENTRIES = (
    *_table("Table 6", WITHOUT, *MADE_WITHOUT),
    *_table("Table 7", WITH, *MADE_WITH),
    Entry(("Fig. 16",), "point that moves least", Printed(("6",)), Verdict.REPRODUCED, lambda: WITHOUT.steadiest),
    Entry(
        ("section 4",), "vibration left at the point that moves most", Printed(("0",), "mm"),
        Verdict.NOT_REPRODUCIBLE, lambda: computed(max(WITH.combined(1.0, -1.0).values)),
        "Said to be gone completely; Table 7 says otherwise.",
    ),
)  # fmt: skip
