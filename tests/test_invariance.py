"""The same design written otherwise: in other units, larger, from another start, mirrored, run backwards.

What has no dimension must come out the same.  Each change is made to the design file's values, so that reading,
law, linkage, peaks and pitch curves all take part.
"""

from __future__ import annotations

from copy import deepcopy
from math import cos, pi, sin
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from hard.case import FOLDER, drive_of, read
from hard.condition import conditions
from hard.figures import reported
from hard.judged import EPSILON, FACTOR
from ncgear.pitch.pair import largest_tangent_angle_rad
from ncgear.project.drive import Drive

SAME = 1e-11
"""Relative: a thousand rounding errors of inputs whose conditions here are below a hundred."""

Data = dict[str, Any]

ANGLES = np.linspace(0.02, 0.98, 25) * 2.0 * pi


def dimensionless(drive: Drive) -> dict[str, float]:
    """Figures without a unit; force is measured in that of the extended slider, speed in crank length and speed."""
    low, high = drive.transmission.ratio_range
    omega, check = drive.machine.speed_rad_s, drive.check
    speed = omega * drive.linkage.crank_mm
    force = float(drive.machine.load.working.force_n(np.array([drive.linkage.stroke_mm]))[0]) or 1.0
    return {
        "ratio min": low.value,
        "ratio max": high.value,
        "tangent angle": largest_tangent_angle_rad(drive.transmission).value,
        "pitch length": drive.pitch.arc.period,
        "speed": check.peak_speed.value / speed,
        "acceleration": check.peak_acceleration_cycle.value / (speed * omega),
        "power": 1000.0 * check.peak_power_w.value / (force * speed),
    }


def assert_same(one: Drive, other: Drive, without: tuple[str, ...] = ()) -> None:
    first, second = dimensionless(one), dimensionless(other)
    for name in set(first) - set(without):
        assert second[name] == pytest.approx(first[name], rel=SAME), name


def driven(drive: Drive, phi1: np.ndarray = ANGLES) -> np.ndarray:
    return drive.transmission.driven_angle(phi1).value


def design(motion: Data, linkage: Data | None = None, lobes: tuple[int, int] = (1, 1)) -> Data:
    gears = {"teeth": 60, "module_mm": 2.0, "face_width_mm": 20.0}
    return {
        "name": "same",
        "linkage": linkage or {"crank_mm": 380.0, "rod_mm": 960.0, "offset_mm": 70.0},
        "operation": {"speed_rpm": 20.0},
        "motion": motion,
        "gears": {**gears, "lobes": {"driving": lobes[0], "driven": lobes[1]}},
        "resistance": {"polynomial_n": [500.0, 20.0, 0.05]},
    }


STROKE: Data = {
    "law": "three_segment_stroke",
    "solve_for": "law_speed",
    "theta1_pi": 0.4,
    "theta2_pi": 0.7,
    "theta3_pi": 1.0,
    "theta4_pi": 1.3,
    "v1_mm_s": 1600.0,
    "v2_mm_s": 1100.0,
    "a1_mm_s2": -1500.0,
    "a1_speed_rpm": 20.0,
    "return": {"basis": "ratio", "e": 0.0},
}
NODES = tuple(15.0 * k for k in range(24))

small = st.floats(-0.15, 0.15).map(lambda value: round(value, 6))
waves = st.lists(small, min_size=1, max_size=3)
PROFILES = {"few": settings(deadline=None, max_examples=4), "many": settings(deadline=None, max_examples=30)}
quick_and_slow = pytest.mark.parametrize("examples", ["few", pytest.param("many", marks=pytest.mark.slow)])


def laws(cosine: list[float], sine: list[float]) -> dict[str, Data]:
    """One series as every law that can say it: by the driven angle, by the driving angle, and point by point."""
    terms = [f"{a!r}*cos({k}*phi)" for k, a in enumerate(cosine, 1)]
    terms += [f"{b!r}*sin({k}*phi)" for k, b in enumerate(sine, 1)]
    return {
        "harmonics": {"law": "harmonic_ratio", "cosine": cosine, "sine": sine},
        "expression": {"law": "ratio_expression", "ratio": f"exp({' + '.join(terms)})", "scale_to_close": True},
        "table": table([float(np.exp(series(cosine, sine, at * pi / 180.0))) for at in NODES]),
    }


def table(ratios: list[float]) -> Data:
    return {"law": "table", "phi1_deg": list(NODES), "ratio": ratios, "scale_to_close": True}


def series(cosine: list[float], sine: list[float], at: float) -> float:
    in_phase = sum(a * cos(k * at) for k, a in enumerate(cosine, 1))
    return in_phase + sum(b * sin(k * at) for k, b in enumerate(sine, 1))


# --- units -------------------------------------------------------------------------------------------------------


def in_unit(motion: Data, unit: str) -> Data:
    """Angles in multiples of pi written in another unit."""
    factor = {"deg": 180.0, "rad": pi}[unit]
    written = {key: value for key, value in motion.items() if not key.endswith("_pi")}
    angles = {key.removesuffix("_pi"): value for key, value in motion.items() if key.endswith("_pi")}
    return written | {f"{name}_{unit}": value * factor for name, value in angles.items()}


@pytest.mark.slow
@pytest.mark.parametrize("unit", ["deg", "rad"])
@pytest.mark.parametrize("law", ["stroke", "ellipse"])
def test_angles_in_other_units(unit: str, law: str) -> None:
    motion = STROKE if law == "stroke" else {"law": "ellipse", "eccentricity": 0.3, "phase_pi": 0.37}
    one, other = drive_of(design(motion)), drive_of(design(in_unit(motion, unit)))
    assert_same(one, other)
    assert driven(other) == pytest.approx(driven(one), rel=SAME)


# --- size --------------------------------------------------------------------------------------------------------


def scaled(data: Data, factor: float) -> Data:
    """Every length multiplied; a force that is the same at the same place of the stroke."""
    result = deepcopy(data)
    for key in data["linkage"]:
        result["linkage"][key] *= factor
    for key in ("v1_mm_s", "v2_mm_s", "a1_mm_s2"):
        if key in data["motion"]:
            result["motion"][key] *= factor
    force = [c / factor**k for k, c in enumerate(data["resistance"]["polynomial_n"])]
    return {**result, "resistance": {"polynomial_n": force}}


@pytest.mark.tiers(slow=["-260.0-0.001"], rest="long")
@pytest.mark.parametrize("factor", [1e-3, 1e3])
@pytest.mark.parametrize("e", [0.0, -260.0])
def test_a_stroke_a_thousand_times_larger(factor: float, e: float) -> None:
    data = design({**STROKE, "return": {"basis": "ratio", "e": e}})
    one, other = drive_of(data), drive_of(scaled(data, factor))
    assert_same(one, other)
    assert driven(other) == pytest.approx(driven(one), rel=SAME)


@pytest.mark.tiers(slow=["1000.0-few"], rest="long")
@quick_and_slow
@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_any_ratio_law_on_a_linkage_a_thousand_times_larger(examples: str, factor: float) -> None:
    @PROFILES[examples]
    @given(waves, waves)
    def same(cosine: list[float], sine: list[float]) -> None:
        for motion in laws(cosine, sine).values():
            assert_same(drive_of(design(motion)), drive_of(scaled(design(motion), factor)))

    same()


@pytest.mark.tiers(slow=["0.1"], rest="long")
@pytest.mark.parametrize("factor", [1e-3, 0.1, 7.0])
def test_another_speed_scales_the_peaks(factor: float) -> None:
    data = design(STROKE)
    faster = {**data, "operation": {"speed_rpm": 20.0 * factor}}
    assert_same(drive_of(data), drive_of(faster))


@pytest.mark.tiers(slow=["0.001-rod-1-0001"], rest="long")
@pytest.mark.parametrize("name", ["offset-near-limit", "offset-near-limit-negative", "rod-1-0001"])
@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_where_the_condition_is_large_scaling_costs_what_it_says(name: str, factor: float) -> None:
    """The one place where 1e-11 does not hold: lengths times 1000 are rounded, conditions up to 1e6 magnify it."""
    data = read(FOLDER / f"{name}.yaml")
    one, other = (reported(drive_of(values)) for values in (data, scaled(data, factor)))
    condition = conditions(data)
    lengths = ("ratio min", "ratio max", "pitch length", *(figure for figure in one if figure.startswith("phi2")))
    for figure in lengths:
        off = abs(other[figure].value / one[figure].value - 1.0)
        assert off <= 2.0 * FACTOR * EPSILON * condition[figure], figure
    off = abs(other["peak acceleration"].value / (factor * one["peak acceleration"].value) - 1.0)
    assert off <= 2.0 * FACTOR * EPSILON * condition["peak acceleration"]


# --- seam --------------------------------------------------------------------------------------------------------

GEARS_ALONE = ("speed", "acceleration", "power")
"""What the slider does depends on where it is when the law begins; the gears' figures do not."""


def from_another_start(motion: Data, steps: int) -> Data:
    """The law begun later, by whole steps of the table's 24 of its own variable."""
    shift = 2.0 * pi * steps / 24
    match motion:
        case {"law": "harmonic_ratio"}:
            pairs = list(zip(motion["cosine"], motion["sine"], strict=True))
            turned = [complex(a, -b) * np.exp(1j * k * shift) for k, (a, b) in enumerate(pairs, 1)]
            return {**motion, "cosine": [t.real for t in turned], "sine": [-t.imag for t in turned]}
        case {"law": "table"}:
            return table(motion["ratio"][steps:] + motion["ratio"][:steps])
    return {**motion, "ratio": motion["ratio"].replace("phi", f"(phi + {shift!r})")}


def start_of(drive: Drive, driven_rad: float) -> float:
    """The driving angle at a driven one, by which harmonics are shifted."""
    return float(brentq(lambda at: driven(drive, np.array([at]))[0] - driven_rad, 0.0, 2.0 * pi - 1e-9, xtol=1e-15))


@pytest.mark.tiers(slow=["expression-few"], rest="long")
@quick_and_slow
@pytest.mark.parametrize("law", ["harmonics", "expression", "table"])
def test_the_seam_may_be_anywhere(examples: str, law: str) -> None:
    @PROFILES[examples]
    @given(st.lists(small, min_size=3, max_size=3), st.lists(small, min_size=3, max_size=3), st.integers(1, 23))
    def same(cosine: list[float], sine: list[float], steps: int) -> None:
        motion = laws(cosine, sine)[law]
        one, other = drive_of(design(motion)), drive_of(design(from_another_start(motion, steps)))
        assert_same(one, other, GEARS_ALONE)
        start = start_of(one, 2.0 * pi * steps / 24) if law == "harmonics" else 2.0 * pi * steps / 24
        begun = driven(one, np.array([start]))[0]
        assert driven(other) + begun == pytest.approx(driven(one, ANGLES + start), rel=SAME)

    same()


# --- mirrored, backwards -----------------------------------------------------------------------------------------


def backwards(motion: Data) -> Data:
    """The law run from its end to its beginning."""
    match motion:
        case {"law": "harmonic_ratio"}:
            return {**motion, "sine": [-b for b in motion["sine"]]}
        case {"law": "table"}:
            return table([motion["ratio"][0], *motion["ratio"][:0:-1]])
    return {**motion, "ratio": motion["ratio"].replace("phi", "(-phi)")}


@pytest.mark.tiers(slow=["expression-few"], rest="long")
@quick_and_slow
@pytest.mark.parametrize("law", ["harmonics", "expression", "table"])
def test_a_law_run_backwards(examples: str, law: str) -> None:
    """Its driven angle is the other's from the end on; in line the slider does the same, backwards."""

    @PROFILES[examples]
    @given(waves, waves)
    def same(cosine: list[float], sine: list[float]) -> None:
        motion, linkage = laws(cosine, sine)[law], {"crank_mm": 380.0, "rod_mm": 960.0}
        one, other = drive_of(design(motion, linkage)), drive_of(design(backwards(motion), linkage))
        assert_same(one, other, ("power",))
        assert driven(other) == pytest.approx(2.0 * pi - driven(one, 2.0 * pi - ANGLES), rel=SAME)

    same()


@pytest.mark.tiers(slow=["expression-few"], rest="long")
@quick_and_slow
@pytest.mark.parametrize("law", ["harmonics", "expression", "table"])
def test_a_mirrored_machine_run_backwards(examples: str, law: str) -> None:
    """The offset on the other side and the law backwards: the same machine in a mirror, its return now the work."""

    @PROFILES[examples]
    @given(waves, waves)
    def same(cosine: list[float], sine: list[float]) -> None:
        motion = laws(cosine, sine)[law]
        lengths = {"crank_mm": 380.0, "rod_mm": 960.0, "offset_mm": 70.0}
        one = drive_of(design(motion, lengths))
        other = drive_of(design(backwards(motion), {**lengths, "offset_mm": -70.0}))
        assert_same(one, other, ("power",))
        moved, mirrored = one.machine.motion(2.0 * pi - ANGLES), other.machine.motion(ANGLES)
        stroke = one.linkage.stroke_mm
        assert mirrored.displacement == pytest.approx(moved.displacement, rel=SAME, abs=SAME * stroke)

    same()


# --- the comparison sees differences ------------------------------------------------------------------------------


@pytest.mark.thorough
@pytest.mark.parametrize("law", ["harmonics", "expression", "table"])
def test_a_law_that_differs_in_the_tenth_digit_is_seen(law: str) -> None:
    one = drive_of(design(laws([0.1, 0.05], [0.03, 0.0])[law]))
    other = drive_of(design(laws([0.1 + 1e-9, 0.05], [0.03, 0.0])[law]))
    with pytest.raises(AssertionError):
        assert_same(one, other)


def test_a_seam_that_moves_less_than_it_says_is_seen() -> None:
    motion = laws([0.1, 0.05, 0.0], [0.03, 0.0, 0.0])["expression"]
    one, other = drive_of(design(motion)), drive_of(design(from_another_start(motion, 5)))
    shift = 2.0 * pi * 5 / 24 + 1e-9
    wrong = driven(one, ANGLES + shift) - driven(one, np.array([shift]))[0]
    assert driven(other) != pytest.approx(wrong, rel=SAME)
