"""Tables 6 and 7: readings on the track beam, and the columns that the paper makes of them."""

from __future__ import annotations

from functools import partial

from ncgear.frozen import dataclass
from ncgear.papers.entry import Below, Computed, Entry, Printed, Verdict, computed, half_step, texts


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
    def peaks(self) -> tuple[float, ...]:
        """Peak to peak in mm at the sixteen points."""
        return self.combined(1.0, -1.0).values

    def steadiest(self, count: int) -> Computed:
        """Numbers of the points that move least, in their order."""
        return computed(*sorted(sorted(range(1, 17), key=lambda point: self.peaks[point - 1])[:count]))

    @property
    def largest(self) -> Computed:
        """The largest displacement in mm, whether up or down."""
        return computed(max(abs(float(text)) for text in (*self.up, *self.down)))


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
    columns = (
        ("peak to peak", peak, (1.0, -1.0)),
        ("means of up and down", mean, (0.5, -0.5)),
        ("differences of up and down", difference, (1.0, 1.0)),
    )
    return tuple(
        Entry(
            (place,), what, Printed(column, "mm"), Verdict.REPRODUCED, partial(readings.combined, *factors),
            of_printed=True,
        )
        for what, column, factors in columns
    )  # fmt: skip


def ends_and_middle() -> Computed:
    """Peak to peak of the points 4 to 6 below that of either end."""
    middle = max(WITHOUT.peaks[3:6])
    return computed(middle, WITHOUT.peaks[0], middle, WITHOUT.peaks[15])


def with_below_without() -> Computed:
    """Peak to peak with the weight below that without it, at all points."""
    return computed(*(one for pair in zip(WITH.peaks, WITHOUT.peaks, strict=True) for one in pair))


ENTRIES = (
    *_table("Table 6", WITHOUT, *MADE_WITHOUT),
    *_table("Table 7", WITH, *MADE_WITH),
    Entry(
        ("Fig. 16", "section 3.5"), "point that moves least", Printed(("6",)), Verdict.REPRODUCED,
        lambda: WITHOUT.steadiest(1), of_printed=True,
    ),
    Entry(
        ("Fig. 16", "section 3.5", "section 4"), "points that move least", Printed(("4", "5", "6")),
        Verdict.NOT_REPRODUCIBLE, lambda: WITHOUT.steadiest(3),
        "Point 7 with 2.46 mm moves less than point 4 with 3.46 mm.", of_printed=True,
    ),
    Entry(
        ("section 3.5",), "both ends move more than the points 4 to 6", Below("much larger at the ends"),
        Verdict.REPRODUCED, ends_and_middle, of_printed=True,
    ),
    Entry(
        ("section 3.5",), "largest amplitude without the weight", Printed(("7.40",), "mm"), Verdict.NOT_REPRODUCIBLE,
        lambda: WITHOUT.largest, "7.4 mm is the largest upwards; downwards Table 6 has 7.56 mm.", of_printed=True,
    ),
    Entry(
        ("section 3.5",), "largest amplitude with the weight", Printed(("0.56",), "mm"), Verdict.REPRODUCED,
        lambda: WITH.largest, of_printed=True,
    ),
    Entry(
        ("section 3.5",), "less movement with the weight than without, at every point", Below("obviously decreased"),
        Verdict.REPRODUCED, with_below_without, of_printed=True,
    ),
    Entry(
        ("section 3.5",), "points 1 to 7 move less than points 8 to 14 with the weight", Below("grounded at 1 to 7"),
        Verdict.REPRODUCED, lambda: computed(max(WITH.peaks[:7]), min(WITH.peaks[7:14])),
        "What is called tiny at points 8 to 14 is the largest that is left.", of_printed=True,
    ),
    Entry(
        ("section 4",), "vibration left at the point that moves most", Printed(("0",), "mm"),
        Verdict.NOT_REPRODUCIBLE, lambda: computed(max(WITH.peaks)),
        "Said to be gone completely; Table 7 says otherwise.", of_printed=True,
    ),
)  # fmt: skip
