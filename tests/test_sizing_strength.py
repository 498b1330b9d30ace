"""`ncgear size`: against all sizes tried one after the other with made-up strengths, and with the real estimate."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, cos, inf, pi, radians, sqrt
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from circular_pairs import CylindricalPair, elasticity_factor, nominal_contact_stress_mpa
from commands import Run, on_text
from drives import DESIGNS, drive, drive_of_text
from ncgear.design.reading.design_file import load
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures.answers.strong import parts_that_fail
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import Changes, changed_drive, changed_part, is_accepted, widths_mm, with_width
from ncgear.project.drive import Drive
from ncgear.project.sizing import (
    Accepted,
    GearRoom,
    Sized,
    _with_uneven_load,
    asked_design,
    in_herringbone,
    smallest_accepted,
    smallest_gears,
)
from ncgear.project.strengthening import CROWNING, SERIES_I_MM, Rating, helical_enough, largest_thrust_n, rating_of
from ncgear.strength.answer import Strength
from ncgear.strength.holding import Damage, Weakest, face_width_factor, module_factor
from ncgear.strength.loading import Loading
from ncgear.strength.surfaces import Surfaces
from strong import made_up, made_up_loading, made_up_surfaces

Fake: Any = SimpleNamespace

TEXT = """\
name: press
linkage: {crank_mm: 38, rod_mm: 96}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears: {teeth: 24, module_mm: 2, face_width_mm: 16}   # too small
resistance: {polynomial_n: [2000]}
"""

BENDING, CONTACT = 1.0, 0.8
"""Safeties of the gears in the file, which grow with their size by the laws of scaling."""

WANTED_BENDING, WANTED_CONTACT = 1.4, 1.0


def scale(teeth: int, module_mm: float) -> float:
    return teeth * module_mm / 48.0


def safeties(teeth: int, module_mm: float, width_mm: float) -> tuple[float, float]:
    wider, larger = width_mm / 16.0, scale(teeth, module_mm)
    return BENDING * wider * larger * module_mm / 2.0, CONTACT * larger * sqrt(wider)


@pytest.fixture
def pretend(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Let every drive have strengths that scale exactly; fewer than 20 teeth are refused.  Returns teeth asked for."""
    asked: list[int] = []

    def strength(drive: Drive, method: str) -> Strength:
        assert method == "estimate"
        size = drive.pitch.size
        asked.append(size.driving_teeth)
        if size.driving_teeth < 20:
            raise NoSuchMechanism("too few teeth", key="gears")
        return made_up(drive, *safeties(size.driving_teeth, size.module_mm, drive.gears.face_width_mm))

    def loading(drive: Drive, method: str) -> Loading:
        return made_up_loading(drive, made_up(drive))

    monkeypatch.setattr(Drive, "strength_by", strength)
    monkeypatch.setattr(Drive, "loading_by", loading)
    monkeypatch.setattr(Drive, "surfaces_by", lambda drive, method: made_up_surfaces())
    return asked


def least_width(teeth: int, module_mm: float) -> float:
    """By the closed form: the width in whole mm, at least 5 modules."""
    bending, contact = safeties(teeth, module_mm, 16.0)
    width = 16.0 * max(WANTED_BENDING / bending, (WANTED_CONTACT / contact) ** 2)
    return ceil(max(width, 5.0 * module_mm) - 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("space_mm", [inf, 120.0, 70.0])
def test_the_smallest_of_all_sizes_is_found(pretend: list[int], space_mm: float) -> None:
    """No number of teeth from 20 to 240 and no module of the series give 5 % less volume than the first answer."""
    found = smallest_gears(drive_of_text(TEXT), GearRoom(space_mm))
    every = [
        (teeth * module) ** 2 * width
        for module in SERIES_I_MM
        for teeth in range(20, 241)
        if (width := least_width(teeth, module)) <= 12.0 * module and teeth * module <= space_mm
    ]
    first = found[0]
    assert first.volume_mm3 <= 1.05 * min(every)
    for one in found:
        assert one.rating.holds
        assert one.drive.pitch.center_distance_mm <= space_mm
        assert one.face_width_mm == least_width(one.teeth, one.module_mm)
        assert one.module_mm in SERIES_I_MM
        assert 5.0 <= one.face_width_mm / one.module_mm <= 12.0
    assert [one.volume_mm3 for one in found] == sorted(one.volume_mm3 for one in found)


SHAFT = "bearing_a: {at_mm: -40}, bearing_b: {at_mm: 30}, steel: C45, key: {length_mm: 18}"

PARTS = (
    TEXT.replace(
        "face_width_mm: 16}",
        "face_width_mm: 16, measuring_pin_mm: 3.5, lead: {end_relief_um: 5, end_relief_length_mm: 12}, profile_shift: "
        "{per_tooth: [0.1, -0.1]}, driving: {bore_mm: 10, keyway: {width_mm: 3, depth_mm: 1.4}, web: {"
        "thickness_mm: 11, rim_mm: 2, hub_mm: 18}}, driven: {hub: {diameter_mm: 20, height_mm: 4}}}",
    )
    + f"""\
masses:
  slider_kg: 1
  rod: {{mass_kg: 1, center_mm: 1, inertia_kg_mm2: 1}}
  crank: {{mass_kg: 1, center_mm: 0, inertia_kg_mm2: 1}}
drivetrain: {{driven_shaft: {{{SHAFT}, diameter_mm: 10}}}}
"""
)


def test_parts_follow_a_width() -> None:
    """A key as long as its gear with the hub lets it be, a relief of half the face; none where they have room."""
    design = drive_of_text(PARTS).design
    key, relief = "drivetrain.driven_shaft.key.length_mm", "gears.lead.end_relief_length_mm"
    assert with_width(design, 12.0) == {"gears.face_width_mm": 12.0, key: 16.0, relief: 6.0}
    assert with_width(design, 16.0) == {"gears.face_width_mm": 16.0, relief: 8.0}
    assert with_width(design, 30.0) == {"gears.face_width_mm": 30.0}
    # Over the web, up to the hub that would reach into bearing b
    assert widths_mm(design) == (11.0, 52.0)
    for width in (11.5, 12.0, 52.0):
        assert is_accepted(design, with_width(design, width)), width
    for width in (11.0, 52.1):
        assert not is_accepted(design, with_width(design, width)), width
    assert not is_accepted(design, {"gears.face_width_mm": 12.0})


@at_once(("wider", "uneven", "scale"), [(1.0, 1.5, 1.0), (0.6, 1.3, 1.4), (1.8, 1.2, 0.9), (2.0, 1.0, 1.0)])
def test_a_width_is_guessed_with_the_face_load_that_it_brings(wider: float, uneven: float, scale: float) -> None:
    """What carries, width over K_Hbeta, is what was wanted, with K_Hbeta - 1 as width over force."""
    found = _with_uneven_load(wider, uneven, scale)
    assert found / (1.0 + (uneven - 1.0) * found * scale) == pytest.approx(wider / uneven, rel=1e-12)
    assert (found == pytest.approx(wider)) is (uneven == 1.0 or wider * scale == 1.0)
    # No width carries more than flanks that are pressed at one end only
    assert _with_uneven_load(1.01 * uneven / (uneven - 1.0) / scale if uneven > 1.0 else inf, uneven, scale) == inf


@pytest.mark.slow
def test_what_depends_on_sizes_follows_them(pretend: list[int]) -> None:
    """Keys, reliefs, pins and shifts of each tooth: no search ends at them, and what is found may be in the file."""
    wide = PARTS.replace("face_width_mm: 16", "face_width_mm: 50").replace("{length_mm: 18}", "{length_mm: 54}")
    drive = drive_of_text(wide)
    found = smallest_gears(drive, GearRoom())
    assert found
    for one in found:
        assert is_accepted(drive.design, one.changes)
        assert 11.0 < one.face_width_mm <= 52.0
        assert one.changes["drivetrain.driven_shaft.key.length_mm"] == one.face_width_mm + 4.0
        assert ("gears.profile_shift.per_tooth" in one.changes) is (one.teeth != 24)
        assert ("gears.measuring_pin_mm" in one.changes) is (one.module_mm != 2.0)


@pytest.mark.slow
def test_gears_that_are_accepted_with_more_teeth_only_lead_there(pretend: list[int]) -> None:
    """After too few teeth of a module, 15 % more at least are tried of this and smaller modules."""
    seen = list[Sized]()

    def accepted(one: Sized) -> Accepted:
        seen.append(one)
        return Accepted.YES if one.teeth >= 70 else Accepted.WITH_MORE_TEETH

    found = smallest_accepted(drive_of_text(TEXT), GearRoom(), accepted, 30, lambda done, most: None)
    few = [one for one in seen if one.teeth < 70]
    assert few
    for number, one in enumerate(few):
        assert all(one.teeth >= 1.15 * before.teeth or one.module_mm > before.module_mm for before in few[:number])
    assert found is not None
    assert 70 <= found.teeth < 70 * 1.15 * 1.06
    assert smallest_accepted(found.drive, GearRoom(), lambda one: Accepted.NO, 4, lambda done, most: None) is None


@pytest.mark.thorough
def test_as_many_sizes_are_computed_again_where_none_is_accepted(pretend: list[int]) -> None:
    """Of three that may be computed none is accepted, the fourth is."""
    seen = list[Sized]()

    def accepted(one: Sized) -> Accepted:
        seen.append(one)
        return Accepted.YES if len(seen) > 3 else Accepted.NO

    found = smallest_accepted(drive_of_text(TEXT), GearRoom(), accepted, 3, lambda done, most: None)
    assert found is seen[3]


@pytest.mark.thorough
def test_no_number_of_teeth_beside_the_smallest_accepted_gears_is_smaller(pretend: list[int]) -> None:
    """Of their module, by more than guesses of the width are off; steps of 6 % alone would leave 8 %."""
    room = GearRoom(modules_mm=(1.25,), fewest_teeth=40)
    found = smallest_accepted(drive_of_text(TEXT), room, lambda one: Accepted.YES, 12, lambda done, most: None)
    assert found is not None
    assert found.face_width_mm == least_width(found.teeth, 1.25)
    near = range(int(found.teeth / 1.06) + 1, int(found.teeth * 1.06) + 1)
    assert 0.95 * found.teeth**2 * found.face_width_mm <= min(one**2 * least_width(one, 1.25) for one in near)


def test_flanks_that_wear_away_do_not_hold(pretend: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    """Where wear decides, the width is that at which the limit of a tenth of the module is just reached."""

    def worn(teeth: int, module_mm: float, width_mm: float) -> float:
        return 2.0 * 16.0 / width_mm / scale(teeth, module_mm) * 2.0 / module_mm

    def surfaces(drive: Drive, method: str) -> Surfaces:
        size, found = drive.pitch.size, made_up_surfaces()
        depth = found.wear.limit_mm * worn(size.driving_teeth, size.module_mm, drive.gears.face_width_mm)
        first, second = (replace(one, value=depth) for one in found.wear.depth_mm)
        return replace(found, wear=replace(found.wear, depth_mm=(first, second)))

    monkeypatch.setattr(Drive, "surfaces_by", surfaces)
    for one in smallest_gears(drive_of_text(TEXT), GearRoom(modules_mm=(2.0, 3.0))):
        assert one.holds
        needed = one.face_width_mm * worn(one.teeth, one.module_mm, one.face_width_mm)
        assert one.face_width_mm == max(ceil(needed - 1e-9), least_width(one.teeth, one.module_mm))


@pytest.mark.tiers(slow=["None"], rest="long")
@pytest.mark.parametrize("own_um", [None, 3.0])
def test_crowning_is_among_what_changes_unless_it_is_given(own_um: float | None) -> None:
    """Of the one design whose shafts tell what it is worth; without it the same gears have less."""
    design = drive("baler-drivetrain").design
    assert design.gears is not None
    if own_um is not None:
        design = design.model_copy(update={"gears": changed_part(design.gears, {CROWNING: own_um})})
    first = smallest_gears(Drive(design), GearRoom())[0]
    if own_um is not None:
        assert CROWNING not in first.changes
        assert first.drive.gears.lead.crowning_um == own_um
        return
    assert 5.0 <= float(str(first.changes[CROWNING])) <= 12.0
    straight = rating_of(changed_drive(first.drive, {CROWNING: 0.0}))
    assert min(one.share for one in straight.weakest) < 0.98 * min(one.share for one in first.rating.weakest)


@pytest.mark.slow
def test_teeth_that_are_refused_are_asked_for_once(pretend: list[int]) -> None:
    smallest_gears(drive_of_text(TEXT), GearRoom())
    few = [teeth for teeth in pretend if teeth < 20]
    assert few
    assert len(few) == len(set(few))


@pytest.mark.slow
def test_a_diameter_holds_for_both_gears(pretend: list[int]) -> None:
    """Circular gears reach one module beyond their pitch circles."""
    for one in smallest_gears(drive_of_text(TEXT), GearRoom(diameter_mm=90.0)):
        assert one.diameter_mm == pytest.approx(one.teeth * one.module_mm + 2.0 * one.module_mm, rel=1e-3)
        assert one.diameter_mm <= 90.0


def test_no_room_is_told_with_what_comes_nearest(pretend: list[int]) -> None:
    with pytest.raises(NoSuchMechanism, match=r"nearest of .* come 24 teeth of module 2 mm"):
        smallest_gears(drive_of_text(TEXT), GearRoom(30.0))


def of_size(pair: CylindricalPair, torque_n_mm: float) -> float:
    force = 2.0 * torque_n_mm / (pair.module_mm * pair.teeth[0])
    return float(nominal_contact_stress_mpa(pair, force, elasticity_factor(206e3, 0.3), 1.0))


@pytest.mark.judges("strength")
@pytest.mark.parametrize("short", [0.5, 0.9, 1.3])
def test_factors_by_iso_6336_2(short: float) -> None:
    """Circular gears at one torque: with the factors the pressure of ISO 6336-2 becomes just the one wanted."""
    pair = CylindricalPair(2.0, (24, 24), 16.0)
    stress = of_size(pair, 1e5)
    weakest = [Weakest(Gear.DRIVING, Damage.CONTACT, 1, stress, 0.0, short, 1.0, 1.0, (1,))]
    wider = CylindricalPair(2.0, (24, 24), 16.0 * face_width_factor(weakest))
    larger = CylindricalPair(2.0 * module_factor(weakest), (24, 24), 16.0)
    for changed in (wider, larger):
        assert of_size(changed, 1e5) == pytest.approx(short * stress, rel=1e-12)


def test_factors_of_root_stress() -> None:
    """F / (b m) with F = T / r: twice the width, or a module larger by the root of 2, halve it."""
    weakest = [Weakest(Gear.DRIVEN, Damage.BENDING, 1, 100.0, 0.0, 0.7, 1.0, 1.4, (1,))]
    assert (face_width_factor(weakest), module_factor(weakest)) == pytest.approx((2.0, 2.0**0.5), rel=1e-15)


# The command.


@pytest.fixture
def run(run: Run) -> Run:
    """Find sizes for d.yaml, which holds the text."""
    return on_text(run, "size", "--verbose")


@pytest.mark.slow
def test_what_is_written_builds_what_was_found(run: Run, pretend: list[int]) -> None:
    status, out, err = run(TEXT, "--space", "100", "--out", "found/right.yaml", "--material", "C45")
    assert (status, err) == (0, "")
    text = Path("found/right.yaml").read_text()
    assert "# too small" in text
    design = load(Path("found/right.yaml")).design
    assert design.name == "press-sized"
    assert design.gears is not None
    assert design.gears.material is not None
    assert [one.name for one in design.gears.material.each] == ["C45", "C45"]
    sizes = (
        f"teeth: {design.gears.teeth}",
        f"module_mm: {design.gears.module_mm:g}",
        f"face_width_mm: {design.gears.face_width_mm:g}",
    )
    assert f" first {', '.join(f'gears.{size}' for size in sizes)} " in " ".join(out.split())
    assert rating_of(Drive(design), "estimate").holds


@pytest.mark.slow
def test_more_safety_makes_larger_gears(run: Run, pretend: list[int]) -> None:
    def volume(*options: str) -> float:
        assert run(TEXT, "--out", "d2.yaml", *options)[0] == 0
        gears = load(Path("d2.yaml")).design.gears
        assert gears is not None
        assert gears.teeth is not None
        assert gears.module_mm is not None
        return (gears.teeth * gears.module_mm) ** 2 * gears.face_width_mm

    assert volume("--bending-safety", "3", "--contact-safety", "1.5") > 1.5 * volume()
    assert load(Path("d2.yaml")).design.strength.bending_safety is None


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--material", "C44"], "--material: 'C44' given; did you mean C45?"),
        (["--out", "sized.txt"], "--out: sized.txt given; a file that ends in .yaml is right"),
    ],
)
def test_wrong_options(run: Run, options: list[str], said: str) -> None:
    status, out, err = run(TEXT, *options)
    assert (status, out, err) == (2, "", said + "\n")


@pytest.mark.slow
def test_gears_without_a_load_are_refused(run: Run) -> None:
    status, _, err = run(TEXT.replace("resistance: {polynomial_n: [2000]}\n", ""))
    assert status == 2
    assert "resistance: missing" in err


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.judges("strength")
def test_with_the_real_estimate() -> None:
    """All answers hold, and a mm narrower or with the next smaller module they do not."""
    given = drive_of_text(TEXT)
    assert not rating_of(given, "estimate").holds
    found = smallest_gears(given, GearRoom())
    first = found[0]
    for one in found:
        assert one.rating.holds
        less: list[Changes] = []
        if one.face_width_mm - 1.0 >= 5.0 * one.module_mm:
            less.append({"gears.face_width_mm": one.face_width_mm - 1.0})
        if one.module_mm > SERIES_I_MM[0]:
            less.append({"gears.module_mm": SERIES_I_MM[SERIES_I_MM.index(one.module_mm) - 1]})
        for changes in less:
            assert not rating_of(changed_drive(one.drive, changes), "estimate").holds, changes
    # The same gears, from the design file that is asked of the command, have the same safety.
    again = rating_of(changed_drive(given, first.changes), "estimate")
    assert [one.safety for one in again.weakest] == [one.safety for one in first.rating.weakest]


@pytest.mark.slow
def test_the_baler_that_holds() -> None:
    """At 60 r/min, with law and masses of designs/baler-half-dynamics.yaml, whose teeth do not hold."""
    holds, weak = (drive(name) for name in ("baler-holds", "baler-half-dynamics"))
    assert holds.design.masses == weak.design.masses
    assert holds.design.motion == weak.design.motion
    least = {one.damage: one.safety for one in sorted(rating_of(holds).weakest, key=lambda one: -one.safety)}
    assert least[Damage.BENDING] == pytest.approx(1.67, rel=0.05)
    assert least[Damage.CONTACT] == pytest.approx(1.17, rel=0.05)
    assert not rating_of(weak).holds


def test_gears_are_on_a_circle_of_their_module() -> None:
    """What the sizes of these tests rest on: a = m z for equal circular gears."""
    pitch = drive_of_text(TEXT).pitch
    assert pitch.center_distance_mm == pytest.approx(48.0, rel=1e-9)
    assert pitch.driving.length_mm == pytest.approx(48.0 * pi, rel=1e-9)


def curve_text(*parts: str) -> str:
    curve = "{law: pitch_curve, ellipse: {semi_major_mm: 23, axis_x_mm: 4, axis_y_mm: -4%s}, solve_for: %s%s}"
    text = TEXT.replace("linkage: {crank_mm: 38, rod_mm: 96}\n", "").replace(
        "polynomial_n: [2000]", "polynomial_n_m: [2]"
    )
    return text.replace("{law: uniform_crank}", curve % parts).replace("teeth: 24", "teeth: 47")


@pytest.mark.thorough
def test_a_curve_in_mm_has_no_smaller_size() -> None:
    text = curve_text("", "semi_minor", ", center_distance_mm: 40").replace(", module_mm: 2", "")
    with pytest.raises(WrongInput, match="motion: a curve in mm that gives gears of 40 mm centre distance"):
        smallest_gears(drive_of_text(text), GearRoom())


@pytest.mark.long
@pytest.mark.slow
def test_a_curve_that_grows_with_its_gears_is_sized() -> None:
    text = curve_text(", semi_minor_mm: 16.44", "scale", "").replace("module_mm: 2", "module_mm: 1")
    assert smallest_gears(drive_of_text(text), GearRoom())[0].rating.holds


@pytest.mark.long
@pytest.mark.slow
def test_gears_far_too_weak_to_be_rated_are_sized_all_the_same() -> None:
    """To what is found from gears that can be: the smallest of both are as small, within the steps that are tried."""
    text = TEXT.replace("width_mm: 16", "width_mm: {width}").replace("module_mm: 2", "module_mm: {module}")
    weak = drive_of_text(text.replace("{width}", "0.3").replace("{module}", "0.4"))
    with pytest.raises(NoSuchMechanism, match="presses the driven gear"):
        rating_of(weak, "estimate")
    found, others = smallest_gears(weak, GearRoom()), smallest_gears(drive_of_text(TEXT), GearRoom())
    assert all(one.rating.holds for one in found)
    assert found[0].volume_mm3 == pytest.approx(others[0].volume_mm3, rel=0.25)


@pytest.mark.long
@pytest.mark.slow
def test_parts_that_gears_break_are_told_with_them() -> None:
    """A key that is too short for the torque fails, and a long enough one does not."""
    text = (DESIGNS / "baler-drivetrain.yaml").read_text(encoding="utf-8")
    for given, fails in (("{length_mm: 20}", True), ("{}", False)):
        made = drive_of_text(text.replace("key: {}", f"key: {given}"))
        told = parts_that_fail(Sized({}, made, rating_of(made, "estimate")))
        assert any("the pressure on the key of the driving shaft" in one.what for one in told) == fails


@pytest.mark.long
@pytest.mark.slow
def test_herringbone_teeth_hold_in_less_width_and_where_they_cannot_be_made_there_are_none() -> None:
    design = drive("pump-both-ways").design
    first = smallest_gears(Drive(asked_design(design, {})), GearRoom())[0]
    found = in_herringbone(first)
    assert found is not None
    assert found.holds
    assert found.teeth == first.teeth
    assert found.face_width_mm < first.face_width_mm
    straight = changed_drive(first.drive, {"gears.face_width_mm": found.face_width_mm})
    assert not Sized({}, straight, rating_of(straight, "estimate")).holds
    assert in_herringbone(replace(first, drive=drive("internal-1-2"))) is None
    assert in_herringbone(found) is None


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "kind"), [("pusher", "helical"), ("baler-drivetrain", "herringbone")])
def test_helical_teeth_are_tried_where_they_can_be_made_and_may_hold(
    monkeypatch: pytest.MonkeyPatch, name: str, kind: str
) -> None:
    """The flatter angle first; none of teeth that lack far more, of rings, of racks, and of teeth that have a helix."""
    tried: list[Changes] = []

    def holds(drive: Drive, rating: Rating, changes: Changes) -> bool:
        tried.append(changes)
        return changes["gears.helix.angle_deg"] == 30.0

    monkeypatch.setattr("ncgear.project.strengthening._holds", holds)
    lacking = [Weakest(Gear.DRIVEN, Damage.CONTACT, 1, 100.0, 0.0, share, 1.0, 1.0, (1,)) for share in (0.75, 0.7)]
    hardly, hopeless = (Rating(Fake(), Fake(), (one,)) for one in lacking)
    straight = drive(name)
    found = helical_enough(straight, hardly)
    assert [one["gears.helix.angle_deg"] for one in tried] == [20.0, 30.0]
    assert found == {"gears.helix.angle_deg": 30.0, "gears.helix.kind": kind, "gears.helix.hand": "right"}
    assert not helical_enough(straight, hopeless)
    others = [drive("internal-1-2"), drive("rack-feed"), changed_drive(straight, found)]
    assert not any(helical_enough(one, hardly) for one in others)
    assert len(tried) == 2


@pytest.mark.judges("strength")
def test_the_thrust_is_that_of_the_torque_on_circular_gears() -> None:
    """2 N m on a radius of 24 mm: 83.33 N along the pitch circle, 30.33 N along the axis at 20 degrees."""
    angle = radians(20.0)
    contacts = Fake(position=np.array([0, 0, 1]), force_n=np.array([0.3, 0.7, 0.9]) * 2000.0 / 24.0 / cos(angle))
    rating = Rating(Fake(contacts=contacts), Fake(), ())
    assert largest_thrust_n(drive_of_text(TEXT), rating, angle) == pytest.approx(30.331, abs=1e-3)
