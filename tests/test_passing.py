"""How near crank pin and rods pass what stands beside the gears: least distances, where they are, and what is told.

The judges are polygons of shapely at thousands of angles, closed forms, and scenes whose links move by other code.
"""

from __future__ import annotations

from functools import cache
from math import asin, cos, hypot, pi, radians, sin, sqrt

import numpy as np
import pytest
from pydantic import ValidationError
from shapely import LineString, MultiLineString, Point

from at_once import at_once
from drives import design_of, drive, drive_of_text
from ncgear.errors import WrongInput
from ncgear.figures.advice.law_advice import NO_BORE, crank_pin, pin_beside_hub, rods
from ncgear.figures.advice.values import Advice
from ncgear.figures.data_sheet.entries import passed_rows, passed_summary
from ncgear.figures.data_sheet.sheet import data_sheet
from ncgear.kinematics.motion import Machine
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.project.drive import Drive
from ncgear.project.passing import CRANK_PIN, Passing, center_lines, from_segment, least_distance

LINKAGES = {
    "in front": "{crank_mm: 40, rod_mm: 150}",
    "offset": "{crank_mm: 40, rod_mm: 150, offset_mm: 22}",
    "short rod": "{crank_mm: 40, rod_mm: 60}",
    "rocker": "{kind: crank_rocker, crank_mm: 30, coupler_mm: 110, rocker_mm: 80, ground_mm: 120}",
    "lever": "{kind: slotted_lever, crank_mm: 26, pivot_mm: 80, lever_mm: 150}",
    "yoke": "{kind: scotch_yoke, crank_mm: 30}",
}

TEXT = """
name: passing
linkage: {linkage}
operation: {{speed_rpm: 60}}
motion: {{law: ratio_expression, ratio: "1 - 0.2*cos(2*phi) + 0.1*sin(phi)", scale_to_close: true}}
gears: {{teeth: 40, module_mm: 2, face_width_mm: 10, driving_axis_deg: {axis}, driving: {{bore_mm: 12}}}}
{more}
"""


@cache
def made(kind: str, axis: float, more: str = "") -> Drive:
    return drive_of_text(TEXT.format(linkage=LINKAGES[kind], axis=axis, more=more))


def axis_mm(found: Drive) -> Point:
    """The driving axis in the frame of the mechanism."""
    at = radians(found.gears.driving_axis_deg)
    return Point(found.pitch.center_distance_mm * cos(at), found.pitch.center_distance_mm * sin(at))


def lines_at(found: Drive, part: str, phi1: Array) -> list[LineString | MultiLineString | Point]:
    """The middle of a part at driving angles, by the joints that the mechanism's own bodies have."""
    machine: Machine = found.machine
    if part == "slider":  # a yoke's slot and bar, by the pin's place
        pins = -machine.linkage.crank_mm * np.exp(-1j * machine.transmission.driven_angle(phi1).value)
        r = machine.linkage.crank_mm
        return [MultiLineString([[(x, -r), (x, r)], [(x, 0.0), (x + 2.7 * r, 0.0)]]) for x in pins.real]
    if part == "ram":  # its slot at the lever's far pin, by the crank pin's direction from the lever's axis
        r, d, long = 26.0, 80.0, 150.0
        pins = 1j * d + r * np.exp(1j * (pi + asin(r / d) - machine.transmission.driven_angle(phi1).value))
        tips, low = long * pins / np.abs(pins), sqrt(long**2 - (long * r / d) ** 2) - d
        top, bar = long - d, 1.35 * 2.0 * long * r / d
        return [MultiLineString([[(x, low), (x, top)], [(x, top), (x + bar, top)]]) for x in tips.real]
    links = machine.linkage.links(Jet(machine.transmission.driven_angle(phi1).value[None, :]))
    link = links["crank"] if part == CRANK_PIN else links[part]
    x, y, angle = link.origin.x.value, link.origin.y.value, link.angle.value
    length = machine.linkage.crank_mm if part == CRANK_PIN else getattr(machine.linkage, f"{part}_mm")
    ends = np.stack([x + length * np.cos(angle), y + length * np.sin(angle)], axis=-1)
    if part == CRANK_PIN:
        return [Point(end) for end in ends]
    return [LineString([start, end]) for start, end in zip(np.stack([x, y], axis=-1), ends, strict=True)]


PIVOTS = {"rocker": (120.0, 0.0), "lever": (0.0, -80.0)}
KINDS = [("in front", 30.0), ("offset", 5.0), ("short rod", 90.0), ("rocker", 20.0), ("lever", -100.0), ("yoke", 180.0)]


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "axis"), KINDS)
def test_nothing_is_nearer_at_thousands_of_angles(kind: str, axis: float) -> None:
    found = made(kind, axis)
    phi1 = np.linspace(0.0, found.transmission.cycle_rad, 4001)
    assert {one.part for one in found.passings} == {CRANK_PIN, *found.linkage.rod_lines_mm}
    for one in found.passings:
        center = axis_mm(found) if one.standing.about_driving_axis else Point(PIVOTS[kind])
        sampled = np.array([line.distance(center) for line in lines_at(found, one.part, phi1)])
        assert sampled.min() >= one.distance_mm - 1e-9
        assert sampled.min() <= one.distance_mm + 0.1
        (there,) = lines_at(found, one.part, np.array([one.phi1_rad]))
        assert there.distance(center) == pytest.approx(one.distance_mm, abs=1e-9)


@pytest.mark.slow
def test_a_pin_passes_the_driving_axis_at_the_difference_of_both_lengths() -> None:
    for kind, axis in KINDS:
        found = made(kind, axis)
        pin = next(one for one in found.passings if one.part == CRANK_PIN)
        assert pin.distance_mm == pytest.approx(abs(found.pitch.center_distance_mm - found.linkage.crank_mm), abs=1e-12)


@pytest.mark.slow
def test_a_shaft_as_wide_as_told_is_just_passed() -> None:
    """A circle and a rod as polygons: they touch with the width that is told, and overlap with a tenth more."""
    found = made("offset", -25.0)
    rod = next(one for one in found.passings if one.part == "rod")
    assert rod.room_mm is not None
    assert rod.room_mm == pytest.approx(2.0 * (rod.distance_mm - 6.0))
    shaft, phi1 = axis_mm(found).buffer(6.0, quad_segs=256), np.linspace(0.0, 2.0 * pi, 1441)
    lines = lines_at(found, "rod", np.append(phi1, rod.phi1_rad))
    for width, meets in ((rod.room_mm - 0.01, False), (rod.room_mm + 0.1, True)):
        assert any(line.buffer(width / 2.0, quad_segs=64).intersects(shaft) for line in lines) == meets


@pytest.mark.slow
def test_a_narrow_passage_between_two_samples_is_not_missed() -> None:
    """A rod hardly longer than its crank swings round within a tenth of a degree, near a point in its way."""
    found = drive_of_text(TEXT.format(linkage="{crank_mm: 40, rod_mm: 40.0004}", axis=180.0, more=""))
    lines, transmission = center_lines(found.linkage)["rod"], found.transmission
    center = 3.0, 39.0
    least, at = least_distance(lines, center, transmission)
    dense = np.linspace(0.0, transmission.cycle_rad, 400_001)
    start, stop, _ = lines(transmission.driven_angle(dense).value)
    sampled = from_segment(complex(*center), start[0], stop[0])
    assert least <= sampled.min() + 1e-12
    assert least >= sampled.min() - 0.05
    assert 0.0 <= at <= transmission.cycle_rad


def test_distance_from_a_segment_is_shapely_s() -> None:
    rng = np.random.default_rng(1)
    points = rng.normal(size=(200, 3, 2))
    for point, start, stop in points:
        own = from_segment(complex(*point), np.array([complex(*start)]), np.array([complex(*stop)]))
        assert own[0] == pytest.approx(LineString([start, stop]).distance(Point(point)), abs=1e-12)
    assert from_segment(1j, np.zeros(1, complex), np.zeros(1, complex))[0] == 1.0


def meeting(more: str, axis: float = 0.0) -> list[str]:
    return [advice.line for advice in rods(made("in front", axis, more))]


@pytest.mark.slow
def test_a_rod_that_meets_the_shaft_is_told_unless_the_file_says_that_it_ends() -> None:
    assert meeting("fit: {driving_shaft: ends}") == []
    (told,) = meeting("fit: {}")
    assert meeting("") == [told]
    assert "the rod meets the driving shaft" in told
    assert "at phi1 = 0 deg; its middle passes the centre at 0 mm" in told
    assert meeting("fit: {rod_width_mm: 20}", 180.0) == []
    (wide,) = rods(made("in front", 180.0, "fit: {rod_width_mm: 80}"))
    room = next(one.room_mm for one in made("in front", 180.0).passings if one.part == "rod")
    assert f"no wider than {np.floor(100.0 * room) / 100.0:g} mm" in wide.remedies[0].text


def test_a_driving_shaft_that_ends_is_not_in_the_pin_s_way() -> None:
    text = TEXT.format(linkage="{crank_mm: 78, rod_mm: 300}", axis=180.0, more="{}")
    told = crank_pin(drive_of_text(text.replace("{}", "")))
    assert len([one for one in told if isinstance(one, Advice)]) == 1
    assert NO_BORE in told
    # The driven gear has no bore, and so no shaft of known size
    assert crank_pin(drive_of_text(text.replace("{}", "fit: {driving_shaft: ends}"))) == [NO_BORE]


def test_a_pin_of_its_own_diameter_is_judged_by_it() -> None:
    text = TEXT.format(linkage="{crank_mm: 30, rod_mm: 150}", axis=180.0, more="")
    found = drive_of_text(text.replace("driving: {bore_mm: 12}", "driven: {bore_mm: 10, crank_pin: {diameter_mm: 8}}"))
    pin = next(one for one in found.passings if one.part == CRANK_PIN)
    assert pin.half_mm == 4.0
    assert pin.room_mm is None
    assert pin.clearance_mm is None


def test_a_pin_beside_a_hub_is_remarked() -> None:
    text = TEXT.format(linkage="{crank_mm: 30, rod_mm: 150}", axis=180.0, more="")
    body = "driven: {bore_mm: 10, crank_pin: {diameter_mm: 8}, hub: {diameter_mm: 30, height_mm: 6}}"
    told = pin_beside_hub(drive_of_text(text.replace("driving: {bore_mm: 12}", body)))
    assert told is not None
    assert not told.matters
    assert "6 mm high" in told.meaning
    assert pin_beside_hub(drive_of_text(text)) is None


@pytest.mark.slow
def test_summary_and_data_sheet_tell_the_same() -> None:
    found = made("in front", 180.0, "fit: {rod_width_mm: 18}")
    section = passed_summary(found)["fit"]
    rod: Passing = next(one for one in found.passings if one.part == "rod")
    assert section["rod_to_driving_shaft_min_mm"] == rod.distance_mm
    assert section["rod_to_driving_shaft_clearance_mm"] == pytest.approx(rod.distance_mm - 6.0 - 9.0)
    rows = {entry.label: entry for entry in passed_rows(found)}
    clearance = rows["rod to driving shaft: clearance, under 0 where they meet"]
    assert clearance.pair == section["rod_to_driving_shaft_clearance_mm"]
    assert "Beside the gears" in [group.title for group in data_sheet(found).groups]


def test_pins_of_end_stops_stand_where_the_frame_has_them() -> None:
    """In the frame of the pair the driven axis is on +x; with the driving axis behind the crank both frames agree."""
    found = drive("spiral-pair")
    stop = next(one.standing for one in found.passings if "end stop" in one.standing.name)
    x, y = found.solids.driving.plan.pin_mm
    assert stop.center_mm == pytest.approx((x - found.pitch.center_distance_mm, y))
    assert hypot(x, y) == pytest.approx(found.gears.driving.end_stop.radius_mm)


def test_gears_without_a_linkage_have_nothing_to_pass() -> None:
    assert drive("desk-toy").passings == ()
    assert passed_summary(drive("desk-toy")) == {}


@pytest.mark.tiers(quick=["-90-*"], rest="slow")
@pytest.mark.parametrize(
    ("axis", "radius", "met"),
    [(-90, 111.9, []), (-90, 112.1, ["pinion"]), (0, 111.9, []), (90, 111.9, []), (90, 112.1, ["pinion", "rack"])],
)
def test_pinion_and_rack_are_judged_against_the_driving_shaft(axis: float, radius: float, met: list[str]) -> None:
    """At 120 mm the shaft of 16 mm leaves 112 mm for the pinion, and for the rack's line over it."""
    gears = {"driving_axis_deg": axis}
    keys = drive("rack-feed").design.model_dump(exclude_unset=True)
    keys["linkage"]["radius_mm"], keys["gears"] = radius, {**keys["gears"], **gears}
    found = Drive(design_of(keys))
    told = [advice.what.partition(" at phi1")[0] for advice in rods(found)]
    assert told == [f"the {part} meets the driving shaft" for part in met]
    assert rods(Drive(design_of({**keys, "fit": {"driving_shaft": "ends"}}))) == []
    with pytest.raises(ValidationError, match="turns no crank"):
        design_of({**keys, "fit": {"rod_width_mm": 3.0}})


@pytest.mark.parametrize(
    "text",
    [
        "name: a\noperation: {speed_rpm: 1}\nmotion: {law: ellipse, eccentricity: 0.2}\nfit: {rod_width_mm: 3}\n",
        "name: a\nlinkage: {crank_mm: 4, rod_mm: 20}\noperation: {speed_rpm: 1}\n"
        "motion: {law: ellipse, eccentricity: 0.2}\nfit: {rod_width_mm: 3}\n",
    ],
)
def test_fit_without_a_crank_or_gears_is_refused(text: str) -> None:
    with pytest.raises(WrongInput) as told:
        drive_of_text(text)
    assert told.value.key == "fit"


LEVER = "{{kind: slotted_lever, crank_mm: 30, pivot_mm: {pivot}, lever_mm: 90}}"


@pytest.mark.slow
@pytest.mark.parametrize(("pivot", "meets"), [(31, True), (35.9, True), (36.1, False), (45, False)])
def test_a_crank_pin_that_covers_the_lever_s_axis_is_told(pivot: float, meets: bool) -> None:
    """The pin, 12 mm thick as the shaft, comes within pivot - crank of the axis, whatever the driving shaft does."""
    text = TEXT.format(linkage=LEVER.format(pivot=pivot), axis=180.0, more="fit: {driving_shaft: ends}")
    told = [one.meaning for one in crank_pin(drive_of_text(text)) if isinstance(one, Advice)]
    assert told == ([f"it passes {pivot - 30:g} mm from its middle"] if meets else [])


@pytest.mark.slow
@pytest.mark.parametrize(("width", "meets"), [(1.01, True), (0.99, False)])
def test_a_coupler_that_covers_the_rocker_s_axis_is_told(width: float, meets: bool) -> None:
    """By sampled triangles of crank pin, rocker's pin and its axis; the rocker itself may lie over its own axis."""
    linkage = "{kind: crank_rocker, crank_mm: 15, coupler_mm: 50, rocker_mm: 65.5, ground_mm: 100}"
    theta = np.linspace(0.0, 2.0 * pi, 200_001)
    pin = 15.0 * np.exp(1j * theta)
    reach = np.abs(pin - 100.0)
    share = (65.5**2 + reach**2 - 50.0**2) / (2.0 * reach)
    joint = 100.0 + (pin - 100.0) / reach * (share + 1j * np.sqrt(65.5**2 - share**2))
    least = from_segment(100.0 + 0.0j, pin, joint).min()
    fit = f"fit: {{driving_shaft: ends, rod_width_mm: {2.0 * least * width}}}"
    found = drive_of_text(TEXT.format(linkage=linkage, axis=180.0, more=fit))
    assert ["coupler meets the rocker's axis" in advice.what for advice in rods(found)] == [True] * meets


@at_once(("axis", "width", "meets"), [(0.0, 1, True), (180.0, 1, False), (90.0, 87.3, True), (90.0, 87.2, False)])
def test_a_yoke_s_bar_and_slot_meet_what_stands_in_their_way(axis: float, width: float, meets: bool) -> None:
    """The bar runs along the slider's line; the slot ends 43.63 mm from the shaft across it."""
    found = made("yoke", axis, f"fit: {{rod_width_mm: {width}}}")
    assert found.pitch.center_distance_mm - 30.0 - 6.0 == pytest.approx(43.629, abs=1e-3)
    assert [advice.what.partition(" at phi1")[0] for advice in rods(found)] == [
        "the slider meets the driving shaft"
    ] * meets


@pytest.mark.slow
@pytest.mark.parametrize(("axis", "radius", "told"), [(0.0, 36.0, 1), (0.0, 35.0, 0), (180.0, 36.0, 0)])
def test_a_crank_pin_that_sweeps_over_an_end_stop_is_told(axis: float, radius: float, told: int) -> None:
    """A pin of 14 mm at 45 mm and a stop of 5 mm touch within 9.5 mm; with the axis behind the crank stays opposite."""
    keys = drive("spiral-pair").design.model_dump(exclude_unset=True)
    stop = {"bore_mm": 14, "end_stop": {"pin_mm": 5, "radius_mm": radius}}
    keys["linkage"]["crank_mm"], keys["gears"] = 45.0, {**keys["gears"], "driving_axis_deg": axis, "driven": stop}
    found = crank_pin(Drive(design_of(keys)))
    assert ["driven gear's end stop" in advice.what for advice in found] == [True] * told


@pytest.mark.slow
@pytest.mark.parametrize(("axis", "met"), [(90.0, ["lever", "ram"]), (180.0, []), (-90.0, ["lever"])])
def test_a_lever_s_ram_meets_a_shaft_in_its_way(axis: float, met: list[str]) -> None:
    """The ram's line is 70 mm over the crank's axis, the shaft's middle 79.6 mm: a bar 24 mm wide reaches it."""
    found = rods(made("lever", axis, "fit: {rod_width_mm: 24}"))
    assert [advice.what.partition(" at phi1")[0] for advice in found] == [
        f"the {part} meets the driving shaft" for part in met
    ]


@pytest.mark.parametrize(
    ("driven", "told", "mended"),
    [
        ("bore_mm: 56", "make the shaft with its crank pin no more than 28 mm thick", "bore_mm: 28"),
        (
            "bore_mm: 20, crank_pin: {diameter_mm: 40}",
            "make the shaft no more than 16 mm thick",
            "bore_mm: 16, crank_pin: {diameter_mm: 40}",
        ),
        (
            "bore_mm: 20, crank_pin: {diameter_mm: 60}",
            "make the crank pin no more than 36 mm thick",
            "bore_mm: 20, crank_pin: {diameter_mm: 36}",
        ),
    ],
)
def test_the_crank_s_own_shaft_and_pin_are_told_sizes_that_pass(driven: str, told: str, mended: str) -> None:
    """They stand a crank's length apart, so that nothing can be farther off."""
    text = (
        "name: own\nlinkage: {crank_mm: 28, rod_mm: 100}\noperation: {speed_rpm: 60}\n"
        "motion: {law: harmonic_ratio, cosine: [-0.2]}\n"
        "gears: {teeth: 40, module_mm: 2, face_width_mm: 20, driving: {bore_mm: 12}, driven: {DRIVEN}}\n"
    )
    found = [one for one in crank_pin(drive_of_text(text.replace("DRIVEN", driven))) if isinstance(one, Advice)]
    assert [remedy.text for advice in found for remedy in advice.remedies] == [told]
    assert not [one for one in crank_pin(drive_of_text(text.replace("DRIVEN", mended))) if isinstance(one, Advice)]


@pytest.mark.parametrize(("linkage", "width", "told"), [("scotch_yoke", 12, 1), ("scotch_yoke", 12.1, 0), ("", 5, 0)])
def test_a_slot_has_room_for_the_crank_pin(linkage: str, width: float, told: int) -> None:
    """The yoke's slot is in a bar of the width that fit gives; the rod of a crank-slider has an eye about the pin."""
    of = "kind: scotch_yoke, crank_mm: 40" if linkage else "crank_mm: 40, rod_mm: 150"
    made = drive_of_text(
        f"name: slot\nlinkage: {{{of}}}\noperation: {{speed_rpm: 60}}\n"
        "motion: {law: harmonic_ratio, cosine: [-0.2]}\n"
        "gears: {teeth: 60, module_mm: 2, face_width_mm: 20, driving: {bore_mm: 12}, driven: {bore_mm: 12}}\n"
        f"fit: {{rod_width_mm: {width}}}\n"
    )
    found = [one for one in crank_pin(made) if isinstance(one, Advice) and "slot of a part" in one.what]
    assert len(found) == told


@pytest.mark.parametrize("kind", ["in front", "short rod"])
def test_the_data_sheet_tells_how_wide_a_part_may_be(kind: str) -> None:
    """Twice the distance of its middle from what stands there, less that body's diameter; none where there is none."""
    found = made(kind, 90.0)
    told = {row.label: row.pair for row in passed_rows(found)}
    widest = {name: value for name, value in told.items() if "widest" in name}
    assert widest
    for name, value in widest.items():
        passed = next(one for one in found.passings if name.startswith(f"{one.part} to {one.standing.name}"))
        assert passed.room_mm is not None
        assert value == (passed.room_mm if passed.room_mm > 0.0 else "none")
