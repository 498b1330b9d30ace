"""The verdict on designs at random beside judges that share nothing with it: polygons, differences, samples, elements.

Each condition has a judge.  Where the verdict says that it is kept, the judge must not find it broken, and where it is
said to be broken, the judge must not find it kept; what both allow each other stands in the constants.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import pytest
from shapely import Polygon

from at_once import at_once
from clean_designs import design, ready
from drives import design_of
from ncgear.errors import DesignError
from ncgear.figures.advice.values import Advice, Kind
from ncgear.figures.advice.verdict import JudgedCondition, KnownParts, State, judged
from ncgear.metrology.pins import over_two_pins
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.strengthening import rating_of
from ncgear.project.tolerance_limits import jamming_of, limits_of, tolerances_of
from ncgear.strength.holding import Damage
from oracles import conditions as outside
from oracles.meshing import Pair
from oracles.pins import over_pins as laid_pins

SEEDS = 340
SOON = (1, 19, 308, 326)
"""Seeds that are judged in every run of the tests."""

SAMPLES = 20_001
CHORDS = 2.0
"""Overlap in chord tolerances that is no overlap: each outline is off by one."""

OF_POWER = 2e-4
"""Share of the peak power by which differences on SAMPLES miss it, where a force or an acceleration jumps."""

NEARLY = 1e-5
"""Relative error of differences and samples of curves without a jump."""

ELEMENTS_KEPT, ELEMENTS_BROKEN = 0.9, 1.1
"""Shares of the wanted safety that plane elements find: at least of teeth that hold, at most of those that do not."""

OFF_THE_MIDDLE = 0.15
"""Half widths of a band of thickness by which a reading over pins may be off its middle, beside chords."""

HARDLY_NARROWER = 0.015
"""Modules by which straight lines across teeth on bent pitch curves find these narrower below where they are not."""

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Seen:
    """A design as judges see it: its keys, its driven angles on a grid, outlines and the distance of the axes."""

    data: dict[str, Any]
    drive: Drive

    @cached_property
    def law(self) -> outside.Law:
        phi1 = np.linspace(0.0, self.drive.transmission.cycle_rad, SAMPLES)
        return outside.Law(phi1, self.drive.transmission.driven_angle(phi1).value)

    @property
    def internal(self) -> bool:
        return self.data["gears"].get("mesh") == "internal"

    @property
    def module_mm(self) -> float:
        return float(self.data["gears"]["module_mm"])

    @property
    def distance_mm(self) -> float:
        return float(self.drive.pitch.center_distance_mm)

    @property
    def chord_mm(self) -> float:
        return CHORDS * self.drive.chord_tolerance_mm

    @cached_property
    def pair(self) -> Pair:
        return self.pair_of(self.drive)

    def pair_of(self, drive: Drive) -> Pair:
        driving, driven = (np.asarray(drive.teeth.of(gear).outline_mm) for gear in Gear)
        ring = Polygon(driven)
        if self.internal:
            around = 1.2 * float(np.abs(driven).max())
            ring = Polygon(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * around, [driven])
        sense = 1.0 if self.internal else -1.0
        return Pair(Polygon(driving), ring, self.law.phi1, self.law.phi2, self.distance_mm, sense)

    def angles(self, count: int) -> tuple[Array, Array]:
        rows = self.pair.rows(count)
        return self.law.phi1[rows], self.law.phi2[rows]

    @property
    def off_mm(self) -> float:
        """How far the centre distance may be off: as the estimate of jamming takes it, and as the drawing says."""
        drawn = self.data["gears"].get("tolerances", {}).get("center_distance_mm", 0.0)
        return max(tolerances_of(self.drive)[0].center_distance_mm, float(drawn))

    @property
    def pitch_rad(self) -> float:
        """A pitch at the driven gear where its radius is least."""
        return float(
            np.pi * self.module_mm / outside.pitch_radii(self.law, self.distance_mm, internal=self.internal)[1].min()
        )

    def thickest(self) -> Drive:
        """The same with the thickest teeth that the file allows."""
        limits = self.data["gears"].get("tolerances", {})
        if "tooth_thickness_upper_mm" not in limits:
            return self.drive
        thick = {**limits, "tooth_thickness_lower_mm": limits["tooth_thickness_upper_mm"]}
        given = {**self.data["gears"], "backlash_mm": self.drive.gears.backlash_mm, "tolerances": thick}
        return ready(3, {**self.data, "gears": given})


Finding = str | None
"""What is wrong with what the verdict says of a condition."""


def assembly(seen: Seen, row: JudgedCondition) -> Finding:
    """Thickest teeth pass at the least distance; where they are said to jam, the worst assembly does not pass."""
    phi1, phi2 = seen.angles(outside.POSITIONS)
    reach = 0.4 * seen.pitch_rad
    toward = 1.0 if seen.internal else -1.0
    if row.state is State.KEPT:
        pair = outside.apart(seen.pair_of(seen.thickest()), toward * seen.off_mm)
        depth, at = outside.passes(pair, phi1, phi2, reach, seen.chord_mm)
        if depth > seen.chord_mm and not row.advices:
            return f"jams at the least centre distance by {depth / seen.module_mm:.2g} modules at phi1 = {at:.4g}"
        far = outside.apart(seen.pair_of(seen.drive), -toward * seen.off_mm)
        few = (one[:: outside.POSITIONS // outside.WIDE_POSITIONS] for one in (phi1, phi2))
        if not outside.holds(far, *few, seen.pitch_rad, seen.chord_mm):
            return "teeth are out of mesh at the largest centre distance"
        return None
    pair = _worst(seen)
    one_by_one = (
        outside.passes(pair, *of, reach, seen.chord_mm)[0] for of in zip(phi1[:, None], phi2[:, None], strict=True)
    )
    return None if any(depth > seen.chord_mm for depth in one_by_one) else "the worst assembly turns"


def _worst(seen: Seen) -> Pair:
    """Axes as near as distance and runout let them be, outlines grown by pitch and profile deviations."""
    given = tolerances_of(seen.drive)[0]
    own = limits_of(seen.drive, given)
    grown = float(own.pitch_mm.max() + own.profile_mm.max()) + max(own.tilt_rad) * seen.drive.gears.face_width_mm
    near = own.center_distance_mm + sum(own.eccentricity_mm)
    pair = outside.apart(seen.pair, near if seen.internal else -near)
    return Pair(
        pair.driving.buffer(grown),
        pair.driven.buffer(grown),
        pair.phi1,
        pair.phi2,
        pair.center_distance,
        pair.driven_sense,
    )


def contact(seen: Seen, row: JudgedCondition) -> Finding:
    """Flanks touch at the law's angles, but for chords, or part about the angle that is told."""
    if row.state is not State.KEPT:
        told = re.findall(r"[\d.]+", re.findall("phi1 = (.*?) deg, since", row.advices[0].meaning)[0])
        gap = max(_gaps(seen, angle, angle).max() for angle in map(float, told))
        return None if gap > seen.chord_mm or _hidden(seen) else f"flanks part by {gap:.2g} mm only where it is told"
    phi1, phi2 = seen.angles(outside.POSITIONS)
    found = [seen.pair._judged(one, other) for one, other in zip(phi1.tolist(), phi2.tolist(), strict=True)]
    _, depth, gap = np.array(found).T
    share = seen.data["gears"].get("backlash_share", 0.0)
    if depth.max() > seen.chord_mm:
        return f"outlines overlap by {depth.max():.2g} mm at the law's angles"
    if gap.max() > seen.chord_mm and not share and not seen.drive.tooth_form.backlash.thickness_mm[0]:
        return f"a gap of {gap.max():.2g} mm at the law's angles"
    return None


def _gaps(seen: Seen, from_deg: float, to_deg: float) -> Array:
    """Gaps of the outlines at the law's angles between driving angles and half a pitch to both sides."""
    half = np.pi / seen.data["gears"]["teeth"]
    phi1 = np.linspace(np.radians(from_deg) - half, np.radians(to_deg) + half, outside.POSITIONS)
    phi1 = phi1[(phi1 >= 0.0) & (phi1 <= seen.law.phi1[-1])]
    phi2 = np.interp(phi1, seen.law.phi1, seen.law.phi2)
    return np.array([seen.pair._judged(*at)[2] for at in zip(phi1.tolist(), phi2.tolist(), strict=True)])


def _hidden(seen: Seen) -> bool:
    """Whether the gap that is told is one that chords may hide."""
    error = seen.drive.designed_contact.pushing.transmission_error_rad
    return error * seen.distance_mm < 4.0 * seen.chord_mm


def strength(seen: Seen, row: JudgedCondition) -> Finding:
    """The safeties that plane elements find."""
    try:
        found = rating_of(seen.drive, "elements")
    except DesignError:
        return None
    least = min(one.share for one in found.weakest if one.damage is Damage.BENDING)
    least_of_all = min(one.share for one in found.weakest)
    if row.state is State.KEPT and least < ELEMENTS_KEPT:
        return f"elements find a bending safety of {least:.3g} of the wanted one"
    if row.state is State.BROKEN and least_of_all > ELEMENTS_BROKEN:
        return f"elements find {least_of_all:.3g} of the wanted safety"
    return None


def pressure(seen: Seen, row: JudgedCondition) -> Finding:
    rack = seen.data["gears"].get("rack", {}).get("pressure_angle_deg", 20.0)
    angle = outside.pressure_angle_deg(seen.law, rack, internal=seen.internal)
    return _beside(row, angle, 60.0)


def ratio(seen: Seen, row: JudgedCondition) -> Finding:
    low, high = seen.law.ratio_range
    return _beside(row, max(high, 1.0 / low), 5.0)


def _beside(row: JudgedCondition, value: float, limit: float, error: float = 1e-4) -> Finding:
    """What is wrong where a value beyond a limit is said to be kept, or the other way about."""
    if row.state is State.KEPT and value > limit * (1.0 + error):
        return f"{value:.6g} is beyond {limit:g}"
    if row.state is State.BROKEN and value < limit * (1.0 - error):
        return f"{value:.6g} is within {limit:g}"
    return None


def _gears_of(row: JudgedCondition) -> set[str]:
    """The gears that the advices of a row name."""
    return {gear.value for gear in Gear for advice in row.advices if gear.value in advice.what}


def concave(seen: Seen, row: JudgedCondition) -> Finding:
    """The least bend of the pitch polylines; what is nearly straight is left to either."""
    own, mate = outside.pitch_radii(seen.law, seen.distance_mm, internal=seen.internal)
    bends = {"driving": outside.least_bend(own, seen.law.phi1)}
    if not seen.internal:
        bends["driven"] = outside.least_bend(mate, seen.law.phi2)
    told = _gears_of(row)
    for gear, bend in bends.items():
        if gear in told and bend > 1e-3:
            return f"the {gear} curve bends by {bend:.3g} at least and is told to be concave"
        if gear not in told and bend < -1e-3:
            return f"the {gear} curve bends by {bend:.3g} and is not told to be concave"
    return None


def rod(seen: Seen, row: JudgedCondition) -> Finding:
    """Rods beside the driving shaft, sampled."""
    ends = seen.data.get("fit", {}).get("driving_shaft") == "ends"
    at = outside.places(seen.data["linkage"], seen.law.phi2)
    turn = np.radians(seen.data["gears"]["driving_axis_deg"])
    _, near = outside.nearest_mm(at, complex(seen.distance_mm * np.exp(1j * turn)))
    taken = seen.data["gears"]["driving"]["bore_mm"] / 2.0 + seen.data.get("fit", {}).get("rod_width_mm", 0.0) / 2.0
    meets = near < taken and not ends
    if ground := seen.data["linkage"].get("ground_mm"):
        _, own = outside.nearest_mm(replace(at, rods=at.rods[:1]), complex(ground))
        meets |= own < seen.data.get("fit", {}).get("rod_width_mm", 0.0) / 2.0
    if abs(near - taken) < 0.01 * taken or (row.state is State.BROKEN) == meets:
        return None
    return f"the rod passes the shaft at {near:.5g} mm, of which {taken:.5g} mm are taken"


def pin(seen: Seen, row: JudgedCondition) -> Finding:
    """The crank pin, as thick as its shaft, beside both axes, sampled."""
    gears = seen.data["gears"]
    at = outside.places(seen.data["linkage"], seen.law.phi2)
    turned = np.exp(2j * np.pi * np.arange(720) / 720)
    shaft = gears["driven"].get("bore_mm")
    thick = shaft or gears["driving"]["bore_mm"]
    near, own = (outside.nearest_mm(at, seen.distance_mm * complex(one))[0] for one in (1.0, 0.0))
    near = min(float(np.abs(at.pin[0] * turned - seen.distance_mm).min()), near)
    ends = seen.data.get("fit", {}).get("driving_shaft") == "ends"
    hits = (not ends and near < (gears["driving"]["bore_mm"] + thick) / 2.0) or (
        shaft is not None and own < (shaft + thick) / 2.0
    )
    return f"the pin passes at {near:.5g} mm and {own:.5g} mm" if (row.state is State.BROKEN) != hits else None


def wishes(seen: Seen, row: JudgedCondition) -> Finding:
    """The time ratio by where the driven angle reaches the extended dead centre."""
    at = outside.places(seen.data["linkage"], seen.law.phi2)
    turns = round(seen.law.phi2[-1] / (2.0 * np.pi))
    ends = np.interp(at.working_rad + 2.0 * np.pi * np.arange(turns), seen.law.phi2, seen.law.phi1)
    begins = np.interp(2.0 * np.pi * np.arange(turns), seen.law.phi2, seen.law.phi1)
    out = float(np.mean(ends - begins))
    back = float(seen.law.phi1[-1]) / turns - out
    return _beside(row, seen.data["wishes"]["time_ratio"]["at_least"] * back / out, 1.0)


def resistance(seen: Seen, row: JudgedCondition) -> Finding:
    """The polynomial over the way that the output goes."""
    loads = (seen.data["resistance"], seen.data["resistance"].get("returning"))
    linkage = seen.data.get("linkage")
    way = outside.places(linkage, seen.law.phi2).output if linkage else seen.law.phi2
    told = (load for load in loads if load and "where_negative" not in load)
    own = [load.get("polynomial_n") or load["polynomial_n_m"] for load in told]
    least = min((float(np.polynomial.polynomial.polyval(way, one).min()) for one in own), default=0.0)
    return f"the least resistance is {least:.4g}" if (row.state is State.BROKEN) != (least < 0.0) else None


def given(seen: Seen, row: JudgedCondition) -> Finding:
    """Forces at samples of the way out and back: those that are nowhere above zero are told, and no others."""
    load = seen.data.get("resistance", {})
    crank_rad = seen.law.phi2 if "linkage" in seen.data else None
    way = seen.law.phi2 if crank_rad is None else outside.places(seen.data["linkage"], crank_rad).output
    parts = {"resistance": load, "resistance.returning": load.get("returning")}
    silent = {key for key, one in parts.items() if one and not outside.polynomial(one)(way).any()}
    words = " ".join(advice.what for advice in row.advices)
    every = "resistance never acts" in words
    told = {key for key, one in parts.items() if one and (every or f"{key}.polynomial" in words)}
    return None if silent == told else f"{silent or 'no force'} is silent, and {told or 'none'} is told"


def undercut(seen: Seen, row: JudgedCondition) -> Finding:
    """Teeth cut at full depth are narrower below where they are told to be undercut, and nowhere else."""
    short = seen.data["gears"].get("rack", {}).get("addendum", 1.0) < 1.0  # of these no tooth stands out far enough
    if seen.internal or short or (row.advices and row.state is State.KEPT):
        return None
    given = {**seen.data["gears"], "backlash_mm": seen.drive.gears.backlash_mm, "undercut": "allow"}
    cut = Drive(design_of({**seen.data, "gears": {**given, "least_contact_ratio": 0.0}}))
    radii = outside.pitch_radii(seen.law, seen.distance_mm, internal=False)
    turned = (np.exp(-1j * seen.law.phi1), -np.exp(1j * seen.law.phi2))
    found = {}
    try:
        _ = cut.teeth
    except DesignError:
        return None
    for gear, radius, way in zip(Gear, radii, turned, strict=True):
        place = (radius * way)[: _once(seen, gear)]
        outline = np.asarray(cut.teeth.of(gear).outline_mm)
        found[gear.value] = outside.narrowed_mm(outline, np.column_stack([place.real, place.imag]), seen.module_mm)
    told = _gears_of(row)
    narrower = {gear for gear, by in found.items() if by > HARDLY_NARROWER * seen.module_mm}
    wrong = not narrower <= told or (told and not narrower)
    return f"teeth are narrower below by {found}, told of {sorted(told)}" if wrong else None


def _once(seen: Seen, gear: Gear) -> int:
    """Samples of the law in which a gear turns once."""
    angle = seen.law.phi1 if gear is Gear.DRIVING else seen.law.phi2
    return int(np.searchsorted(angle, 2.0 * np.pi - 1e-9))


JUDGES: dict[Kind, Callable[[Seen, JudgedCondition], Finding]] = {
    Kind.JAMS: assembly,
    Kind.CONTACT_RATIO: contact,
    Kind.STRENGTH: strength,
    Kind.PRESSURE_ANGLE: pressure,
    Kind.RATIO_RANGE: ratio,
    Kind.CONCAVE: concave,
    Kind.UNDERCUT: undercut,
    Kind.ROD: rod,
    Kind.CRANK_PIN: pin,
    Kind.MISSED_WISH: wishes,
    Kind.NEGATIVE_RESISTANCE: resistance,
    Kind.WITHOUT_EFFECT: given,
}


def power(seen: Seen) -> Finding:
    """The peak power of a check beside energies and work."""
    if "resistance" not in seen.data or seen.data.get("linkage", {}).get("kind") == "crank_rocker":
        return None
    gears = seen.data["gears"]
    inertia = 0.0
    if "masses" in seen.data and not seen.internal:
        outline = np.asarray(seen.drive.teeth.driven.outline_mm)
        moment = outside.second_moment_mm4(outline, gears["driven"]["bore_mm"])
        inertia = 1e-9 * seen.data["masses"]["density_kg_m3"] * gears["face_width_mm"] * moment
    elif "masses" in seen.data:
        inertia = seen.drive.gear_inertia.driven_kg_mm2
    own = outside.peak_power_w(seen.data, seen.law, inertia)
    told = seen.drive.check.peak_power_w.value
    return (
        None
        if abs(own - told) <= OF_POWER * abs(told) + 1e-12
        else f"peak power {told:.6g} W, and {own:.6g} W by energies"
    )


def over_pins(seen: Seen) -> Finding:
    """Pins that shapely lays into the outlines read what the sheet's band has in its middle."""
    if "tooth_thickness_upper_mm" not in seen.data["gears"].get("tolerances", {}) or seen.drive.helix is not None:
        return None
    for one in seen.drive.measured:
        thin, thick = (over_two_pins(working, pins) for working, pins in one.at_limits)
        if len(thin.first) < 3 or not np.array_equal(thin.first, thick.first):
            continue
        place = {int(space): at for space, at in zip(one.pins.space, one.pins.center_mm, strict=True)}
        if not {*thin.first.tolist(), *thin.second.tolist()} <= set(place):
            continue
        first, second = (np.array([place[int(space)] for space in of]) for of in (thin.first, thin.second))
        ring = one.working.is_ring
        read = laid_pins(np.asarray(one.toothed.outline_mm), one.pins.diameter_mm, first, second, ring=ring)
        middle, half = (thin.distance_mm + thick.distance_mm) / 2.0, np.abs(thick.distance_mm - thin.distance_mm) / 2.0
        off = np.abs(read - middle) - 2.0 * seen.chord_mm
        if (off > OFF_THE_MIDDLE * half).any():
            return f"pins read {off.max():.2g} mm off the middle of a band of {2.0 * half.min():.2g} mm"
    return None


def findings(seed: int) -> tuple[str, list[str]]:
    """What the verdict on a design says, and all that judges hold against it."""
    data = design(seed)
    try:
        drive = ready(seed)
        verdict = judged(drive, KnownParts.TEETH)
    except DesignError as refusal:
        return f"refused: {refusal.problem[:80]}", []
    seen = Seen(data, drive)
    found = {"power": power(seen), "over pins": over_pins(seen)}
    for row in verdict.rows:
        if (judge := JUDGES.get(row.kind)) is not None and row.state is not State.NOT_JUDGED:
            found[f"{row.kind} {row.state}"] = judge(seen, row)
    told = ", ".join(str(one.kind) for one in verdict.warnings) or "clean"
    return told, [f"{name}: {finding}" for name, finding in found.items() if finding]


@pytest.mark.judges("figures")
@pytest.mark.slow
@pytest.mark.parametrize(
    "seed", [pytest.param(seed, marks=[] if seed in SOON else pytest.mark.long) for seed in range(SEEDS)]
)
def test_nothing_outside_speaks_against_the_verdict(seed: int) -> None:
    assert findings(seed)[1] == []


# --- what the judges can see -------------------------------------------------------------------------------------


def row_of(seen: Seen, kind: Kind) -> JudgedCondition:
    """A condition of a design as the verdict has it."""
    (row,) = (row for row in judged(seen.drive, KnownParts.TEETH).rows if row.kind is kind)
    return row


def kept(kind: Kind) -> JudgedCondition:
    """What a verdict that sees nothing would say."""
    return JudgedCondition(kind, None, ())


def broken(kind: Kind) -> JudgedCondition:
    """What a verdict that sees everything would say."""
    return JudgedCondition(kind, None, (Advice(kind, "it is wrong", "it breaks"),))


def seen_of(seed: int, **gears: Any) -> Seen:
    """A design of a seed whose gears are given otherwise; as it is given, not made ready."""
    data = design(seed)
    data["gears"] |= gears
    return Seen(data, Drive(design_of(data)))


SILENT = Advice(Kind.WITHOUT_EFFECT, "resistance never acts", "no force")

CLEAN = 126
"""A crank-slider with masses that keeps everything."""


@pytest.mark.slow
def test_gears_whose_backlash_is_taken_away_jam_for_the_judge() -> None:
    ready_made = Seen(design(CLEAN), ready(CLEAN))
    assert assembly(ready_made, kept(Kind.JAMS)) is None
    assert "jams" in str(assembly(seen_of(CLEAN, backlash_mm=0.0), kept(Kind.JAMS)))


@pytest.mark.slow
def test_teeth_that_are_too_thin_are_out_of_mesh_for_the_judge() -> None:
    """Axes so far apart that a tooth passes the other's tips."""
    data = design(CLEAN)
    data["gears"]["tolerances"] = {"center_distance_mm": min(10.0, 2.4 * data["gears"]["module_mm"])}
    far = Seen(data, Drive(design_of(data)))
    pair = outside.apart(far.pair, far.off_mm)
    assert not outside.holds(pair, *far.angles(4), far.pitch_rad, far.chord_mm)
    assert outside.holds(far.pair, *far.angles(4), far.pitch_rad, far.chord_mm)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("load", [60.0, 0.01])
def test_elements_see_loads_that_are_wrongly_judged(load: float) -> None:
    data = design(CLEAN)
    data.pop("masses", None)
    data["resistance"] = {"polynomial_n": [load * float(data["resistance"]["polynomial_n"][0])]}
    seen = Seen(data, Drive(design_of(data)))
    said = kept(Kind.STRENGTH) if load > 1.0 else broken(Kind.STRENGTH)
    assert "elements find" in str(strength(seen, said))


@pytest.mark.slow
@at_once("kind", [Kind.PRESSURE_ANGLE, Kind.RATIO_RANGE, Kind.CRANK_PIN, Kind.ROD])
def test_a_verdict_that_always_warns_is_seen(kind: Kind) -> None:
    assert JUDGES[kind](seen_of(CLEAN), broken(kind)) is not None


@pytest.mark.thorough
def test_a_verdict_that_never_warns_is_seen() -> None:
    data = design(CLEAN)
    data["motion"] = {"law": "ratio_expression", "ratio": "exp(1.8*cos(2*phi))", "scale_to_close": True}
    data["gears"] |= {"driving_axis_deg": 0.0, "driving": {"bore_mm": 1.2 * data["linkage"]["crank_mm"]}}
    data["resistance"] = {"polynomial_n": [1.0, -1.0]}
    data["wishes"] = {"time_ratio": {"at_least": 5.0}}
    data.pop("fit", None)
    seen = Seen(data, Drive(design_of(data)))
    blind = (Kind.PRESSURE_ANGLE, Kind.RATIO_RANGE, Kind.ROD, Kind.CRANK_PIN, Kind.MISSED_WISH, Kind.CONCAVE)
    assert [str(kind) for kind in (*blind, Kind.NEGATIVE_RESISTANCE) if JUDGES[kind](seen, kept(kind)) is None] == []


@pytest.mark.slow
def test_contact_that_is_lost_and_forces_that_never_act_are_seen() -> None:
    lost, silent = (Seen(design(seed), ready(seed)) for seed in (308, 326))
    assert "a gap of" in str(contact(lost, kept(Kind.CONTACT_RATIO)))
    assert "is silent" in str(given(silent, kept(Kind.WITHOUT_EFFECT)))
    assert "told" in str(given(seen_of(CLEAN), replace(broken(Kind.WITHOUT_EFFECT), advices=(SILENT,))))


@pytest.mark.thorough
def test_masses_that_are_left_out_of_the_power_are_seen() -> None:
    seen = seen_of(CLEAN)
    assert power(seen) is None
    assert power(replace(seen, data={**seen.data, "masses": {**seen.data["masses"], "slider_kg": 0.0}})) is not None


# --- limits that only the drawing tells ---------------------------------------------------------------------------


DRAWN: dict[str, dict[str, float]] = {
    "distance": {"center_distance_mm": 0.14},
    "thickness": {"tooth_thickness_upper_mm": 0.0, "tooth_thickness_lower_mm": -0.13},
}


@pytest.mark.slow
@pytest.mark.judges("tolerances")
@pytest.mark.parametrize("name", DRAWN)
def test_what_the_drawing_lets_through_is_judged(name: str) -> None:
    """The backlash that is enough without a limit on the drawing lets polygons jam, and the advice says so."""
    data = {
        "name": name,
        "operation": {"speed_rpm": 70},
        "motion": {"law": "ellipse", "eccentricity": 0.25},
        "gears": {"teeth": 33, "module_mm": 2.5, "face_width_mm": 14},
        "output": {"chord_tolerance_mm": 0.001},
    }
    gears = data["gears"]
    assert isinstance(gears, dict)
    plain = jamming_of(Drive(design_of(data))).enough
    # Teeth in the middle of their band are thinner, so that less backlash is enough for them
    gears |= {"tolerances": DRAWN[name], "backlash_mm": plain if name == "distance" else 0.005}
    before = Seen(data, Drive(design_of(data)))
    assert row_of(before, Kind.JAMS).state is State.BROKEN
    assert "jams" in str(assembly(before, kept(Kind.JAMS)))
    enough = jamming_of(before.drive).enough
    assert enough > plain
    gears["backlash_mm"] = enough
    after = Seen(data, Drive(design_of(data)))
    assert row_of(after, Kind.JAMS).state is State.KEPT
    assert assembly(after, kept(Kind.JAMS)) is None
