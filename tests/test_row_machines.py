"""A row of gears as a machine of gears by themselves: ``gears.idlers``, and the train ``chain`` in every command.

The judges are single round pairs with the same torque, the power of the last gear, and polygons: an idler is one gear,
whichever of its meshes it is seen in.
"""

from __future__ import annotations

from functools import cache
from math import cos, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from shapely import Polygon

from drives import DESIGNS, drive_of_text, loaded
from ncgear.design.reading.design_file import load, load_train
from ncgear.design.rewritten import design_copy
from ncgear.design.space import Space, checked_design, space_of, varied_of
from ncgear.drawings.scene.geared_pairs import SceneGear
from ncgear.drawings.scene.scene import scene_of_teeth
from ncgear.errors import NoSuchMechanism, WrongInput, located
from ncgear.figures.advice.values import Kind
from ncgear.figures.advice.verdict import KnownParts, State
from ncgear.figures.assembly import assembly_of
from ncgear.figures.sweep import swept_answer
from ncgear.figures.trains import judged_room
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import bridging_helix
from ncgear.project.drive import Drive
from ncgear.project.opened import loads
from ncgear.project.rough_strength import rough_strength
from ncgear.project.strengthening import rating_of
from ncgear.project.tolerance import _mesh_and_limits, lot_of
from ncgear.project.tolerance_limits import left_of_backlash, tolerances_of
from ncgear.screening.deeper import OF_WANTED, ROOM, deepened, deeper_names
from ncgear.screening.designs import Designs, Screening, as_in_file, screened_part
from ncgear.screening.overview import no_overview
from ncgear.screening.wanted import Objective, Wanted
from ncgear.strength.holding import Damage
from ncgear.strength.life import pressed_mpa
from ncgear.strength.material import MEAN_STRESS
from ncgear.trains.chain import same_flanks
from ncgear.trains.contact import distances_of
from verdicts import verdict_on

ROW = """\
name: row
operation: {{speed_rpm: 60}}
motion: {law}
gears:
  teeth: 24
  module_mm: 2
  face_width_mm: 12
  backlash_mm: {backlash}
  lobes: {{driving: 1, driven: {second}}}
  idlers: {idlers}
resistance: {{expression_n_m: "{torque}"}}
"""
UNEVEN = '{law: ratio_expression, ratio: "1 + 0.25*cos(phi)", scale_to_close: true}'
ROUND = "{law: uniform_crank}"
BENT = "{lobes: [1, 1], bends_deg: [40, -70]}"


@cache
def made(idlers: str, law: str = UNEVEN, torque: str = "12", second: int = 1, backlash: float = 0.08) -> Drive:
    return drive_of_text(ROW.format(idlers=idlers, law=law, torque=torque, second=second, backlash=backlash))


@cache
def single(first: int, second: int, torque: str, speed_rpm: int) -> Drive:
    text = ROW.format(idlers="", law=ROUND, torque=torque, second=second, backlash=0.0).replace("  idlers: \n", "")
    text = text.replace("driving: 1", f"driving: {first}").replace("teeth: 24", f"teeth: {24 * first}")
    return drive_of_text(text.replace("speed_rpm: 60", f"speed_rpm: {speed_rpm}"))


@pytest.mark.slow
@pytest.mark.parametrize("idlers", [BENT, "{lobes: [2], bends_deg: [35]}"])
def test_every_mesh_of_a_row_passes_the_power_of_the_last_gear(idlers: str) -> None:
    drive = made(idlers)
    phi1 = np.linspace(0.0, 6.2, 50)
    whole = drive.transmission.driven_angle(phi1, 1)
    angle, speed = phi1, np.ones_like(phi1)
    for pair in drive.by_stage:
        turned = pair.pair.transmission.driven_angle(angle, 1)
        speed = speed * turned.derivative(1)
        assert pair.tooth_load.torque_n_mm(angle) * speed == pytest.approx(12_000.0 * whole.derivative(1), rel=1e-9)
        angle = turned.value
    assert angle == pytest.approx(whole.value, abs=1e-12)


ROW_OF_ROUND = (
    "name: row\noperation: {{speed_rpm: 60}}\nmotion: {{law: ratio_expression, ratio: '1'}}\n"
    "gears: {{teeth: 40, module_mm: 2, face_width_mm: 10, backlash_mm: 0.1, "
    "idlers: {{lobes: [1], bends_deg: [{bend}]}}}}\n"
)


def seen(gear: SceneGear, shafts_rad: Array) -> Polygon:
    """A gear of the scene at one position of all shafts, shape (shafts, 1)."""
    places = gear.places(shafts_rad)
    points = gear.body.contours_mm[0] @ np.array([1.0, 1.0j]) * np.exp(1j * places.angle_rad[0])
    points = points + complex(*places.origin_mm[0])
    return Polygon(np.column_stack([points.real, points.imag]))


@pytest.mark.slow
@pytest.mark.parametrize("idlers", [BENT, "{lobes: [2], bends_deg: [35]}"])
def test_an_idler_is_one_gear_in_both_its_meshes_and_all_teeth_touch(idlers: str) -> None:
    """Both outlines are chords of one curve; the scene of an even number of pairs is seen from behind."""
    scene = scene_of_teeth(made(idlers))
    for phi1 in (0.3, 2.0):
        shafts = scene.shaft_angles_rad(np.array([phi1]))
        for pair in scene.pairs:
            one, other = seen(pair.driving, shafts), seen(pair.driven, shafts)
            assert one.intersection(other).area < 1e-3
            assert one.distance(other) < 0.01
        for before, after in zip(scene.pairs, scene.pairs[1:], strict=False):
            driven, driving = seen(before.driven, shafts), seen(after.driving, shafts)
            assert driven.symmetric_difference(driving).area < 2e-4 * driven.length
            assert driven.hausdorff_distance(driving) < 2.0 * made(idlers).by_stage[0].chord_tolerance_mm


@pytest.mark.slow
@pytest.mark.parametrize("idlers", [BENT, "{lobes: [2], bends_deg: [35]}"])
def test_the_pairs_of_a_row_are_put_together_by_their_assembly_files(idlers: str) -> None:
    """An idler of one pair covers that of the next, and teeth in mesh touch, where the files say that they stand."""
    before: Polygon | None = None
    for pair in made(idlers).by_stage:
        told = assembly_of(pair)["row"]
        gears = []
        for gear in Gear:
            points = pair.teeth.of(gear).outline_mm @ np.array([1.0, -1.0j if told["seen_from_behind"] else 1.0j])
            points = points * np.exp(1j * told["direction_rad"]) + complex(*told[f"{gear.value}_axis_mm"])
            gears.append(Polygon(np.column_stack([points.real, points.imag])))
        assert gears[0].intersection(gears[1]).area < 1e-3
        assert gears[0].distance(gears[1]) < 0.01
        if before is not None:
            assert before.hausdorff_distance(gears[0]) < 2.0 * pair.chord_tolerance_mm
        before = gears[1]


@pytest.mark.slow
def test_round_gears_of_a_row_are_as_strong_as_single_pairs_but_for_bending_both_ways() -> None:
    """24 : 48 : 24 teeth; the idler turns at half the speed and passes on twice the torque.

    In its second mesh tooth 1 stands elsewhere than in a single pair, and so do the positions computed: stresses of
    meetings are 0.2 % off there.  The force is even in single contact, so that where its largest value is found, and
    with it how high on the tooth, follows from rounding errors.
    """
    row = made("{lobes: [1]}", ROUND, "12", 2, 0.0).by_stage
    alone = single(1, 2, "24", 60), single(2, 1, "12", 30)
    found, wanted = ([{(w.gear, w.damage): w for w in rating_of(one).weakest} for one in of] for of in (row, alone))
    near = 1e-12, 2.5e-3
    for mesh, pair, idler, rel in zip(found, wanted, (Gear.DRIVEN, Gear.DRIVING), near, strict=True):
        for (gear, damage), one in mesh.items():
            if (gear, damage) != (idler, Damage.BENDING):
                assert one.safety == pytest.approx(pair[gear, damage].safety, rel=rel)
    stresses = [rating_of(one).strength.stresses for one in alone]
    assert rating_of(row[1]).strength.stresses.tension_mpa[1].max() == pytest.approx(
        stresses[1].tension_mpa[1].max(), rel=near[1]
    )
    tension = stresses[0].tension_mpa[1].max(), stresses[1].tension_mpa[0].max()
    pressed = stresses[1].compression_mpa[0].max(), stresses[0].compression_mpa[1].max()
    for place, idler in enumerate((Gear.DRIVEN, Gear.DRIVING)):
        both_ways = tension[place] / (tension[place] + MEAN_STRESS * pressed[place])
        one_way = wanted[place][idler, Damage.BENDING].safety
        assert found[place][idler, Damage.BENDING].safety == pytest.approx(both_ways * one_way, rel=0.01)
        assert 0.65 < both_ways < 0.75


@pytest.mark.slow
def test_a_tooth_of_an_idler_has_one_place_in_both_meshes() -> None:
    """Its flanks by their crossings of the pitch curve, a tooth's back with a back, in the middle of the same tooth."""
    row = made(BENT)
    first, second = row.by_stage[0].teeth.driven.flanks, row.by_stage[1].teeth.driving.flanks
    there = same_flanks(first, second, row.row.rolled_mm(1))
    back = same_flanks(second, first, -row.row.rolled_mm(1))
    assert back[there] == pytest.approx(np.arange(there.size))
    assert np.all(there % 2 == np.arange(there.size) % 2)


@pytest.mark.slow
def test_a_root_is_pressed_by_the_load_of_the_same_tooth_in_the_other_mesh() -> None:
    """Teeth are found again by their angles on the idler: as the driving gear it is seen from its other side, and the
    place that faces the first axis at 0 faces the next axis after 180 - 40 deg."""
    one, two = made(BENT).by_stage[:2]
    first, second = one.teeth.driven.flanks, two.teeth.driving.flanks
    seen = [np.angle(flanks.curve.at_length(flanks.crossing_mm).position @ [1.0, 1.0j]) for flanks in (first, second)]
    turned = np.exp(1j * (np.pi - seen[0] - np.radians(140.0)))
    there = np.abs(turned[:, None] - np.exp(1j * seen[1])).argmin(axis=1)
    assert np.abs(turned - np.exp(1j * seen[1][there])).max() < 1e-6
    alone = [pair._judged_alone("estimate").strength for pair in (one, two)]
    pressed = [
        pressed_mpa(found.stresses.compression_mpa[place], found.contacts.on(gear).flank, 24)
        for found, place, gear in ((alone[0], 1, Gear.DRIVEN), (alone[1], 0, Gear.DRIVING))
    ]
    assert one._pressed_elsewhere(Gear.DRIVEN, "estimate") == pytest.approx(pressed[1][there])
    from_second = two._pressed_elsewhere(Gear.DRIVING, "estimate")
    assert from_second is not None
    assert from_second[there] == pytest.approx(pressed[0])
    assert one._pressed_elsewhere(Gear.DRIVING, "estimate") is None
    assert np.ptp(pressed[1][pressed[1] > 0.0]) > 5.0


def test_the_check_of_a_row_leaves_idlers_to_the_teeth() -> None:
    found = rough_strength(made(BENT).by_stage[1])
    assert found is not None
    assert found.needs_teeth == "it needs the teeth to tell of idlers, which bend both ways"


@pytest.mark.slow
def test_a_train_of_a_chain_is_the_same_row_as_a_machine() -> None:
    file = DESIGNS / "idler-chain.yaml"
    design, train = load(file).design, load_train(file).file.train.train()
    drive = Drive(design)
    pitches = [pair.pitch for pair in drive.by_stage]
    assert [pitch.center_distance_mm for pitch in pitches] == train.told.figures["center_distances_mm"]
    low, high = drive.transmission.ratio_range
    assert (low.value, high.value) == (train.told.figures["ratio_min"], train.told.figures["ratio_max"])
    assert design.gears is not None
    assert (design.gears.driving.bore_mm, design.output.chord_tolerance_mm) == (10.0, 0.005)
    assert drive.machine.load.backwards_n(np.array([0.0]), np.array([False])) == pytest.approx([15_000.0])


def test_a_chain_is_varied_and_written_as_its_own_file(tmp_path: Path) -> None:
    """As sweeps compute their designs and write the best, and reports show the file."""
    given, file = loaded("idler-chain"), tmp_path / "changed.yaml"
    file.write_text(design_copy(given, {"train.gears.teeth": 40}), encoding="utf-8")
    again = load(file).design
    assert checked_design(given.data, ["train.gears.teeth"], [40.0]) == again
    assert screened_part(Screening(given.data, Space(()), (), 1), 0, np.empty((1, 0))).made.all()
    assert as_in_file(given.data, "gears.idlers.bends_deg.0: wide") == "train.bends_deg: wide"
    with pytest.raises(WrongInput, match=r"did you mean train\.gears\.teeth"):
        space_of(given, [varied_of("gears.teeth=36,40")])
    assert again.gears is not None
    assert given.design.gears is not None
    assert again.gears == given.design.gears.model_copy(update={"teeth": 40})
    assert again.motion == given.design.motion


OVERLAPPING = {
    "train.bends_deg.0": [110.0, 90.0, 40.0],
    "train.bends_deg.1": [110.0, 90.0, -70.0],
    "train.gears.face_width_mm": [12.0, 1.0, 12.0],
}
"""A row whose gears overlap, one that is weak and whose gears meet, and a straighter one."""


@cache
def bent_rows() -> tuple[Space, Designs]:
    """The rows, screened."""
    given = loaded("idler-chain")
    space = space_of(given, [varied_of(f"{key}=1,2") for key in OVERLAPPING])
    return space, screened_part(Screening(given.data, space, (), 3), 0, np.array(list(OVERLAPPING.values())).T)


def test_a_sweep_of_rows_makes_what_their_check_makes() -> None:
    _, screened = bent_rows()
    assert "overlap at every angle" in screened.verdicts[0]
    assert screened.made.tolist() == [False, True, True]


@pytest.mark.slow
def test_a_sweep_of_rows_tells_what_their_check_and_their_strength_tell(tmp_path: Path) -> None:
    """Negative control: the straighter row of the same width passes and holds."""
    data, (space, screened) = loaded("idler-chain").data, bent_rows()
    names = deeper_names(loaded("idler-chain").design, "strength")
    found = deepened(data, names, "strength", screened.at(screened.made))
    assert found.figures[ROOM].tolist() == [pytest.approx(-5.22, abs=0.01), np.inf]
    bent = {key: values[1] for key, values in OVERLAPPING.items()}
    file = tmp_path / "bent.yaml"
    file.write_text(design_copy(loaded("idler-chain"), bent), encoding="utf-8")
    train = load_train(file).file.train.train()
    room = judged_room(distances_of(train, {part.name: part.outline_mm for part in train.parts}))
    assert not room.holds
    assert "meet at 281.6 deg" in room.said
    weak, strong = found.figures[OF_WANTED]
    assert weak < 1.0 < strong
    rated = [rating_of(pair) for pair in Drive(load(file).design).by_stage]
    assert weak == pytest.approx(min(one.safety / one.wanted for rating in rated for one in rating.weakest))
    wanted = Wanted((), (Objective("train.bends_deg.0"),))
    answer = swept_answer(load(file).design, no_overview(space, wanted).with_part(found), None, "strength", "")
    assert answer.heads[:2] == ("bends_deg.0", "bends_deg.1")
    assert [(one.what, one.cures) for one in answer.faults] == [
        ("1 of the 2 designs above: gears that do not mesh meet", ("--keep-if 'room_mm > 0'",)),
        ("1 of the 2 designs above: a safety is under the wanted one", ("--keep-if 'safety_of_wanted_min >= 1'",)),
    ]


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("teeth: 36", "teeth: 37", 11, ""),
        ("[40, -70]", "[40]", 7, "1 given for two idlers of 4 gears; one for each is right"),
        ("module_mm: 2", "module_mm: 2\n    rack: {idle_pressure_angle_deg: 25}", 13, "both flanks of an idler push"),
    ],
)
def test_faults_of_a_chain_have_their_places(tmp_path: Path, old: str, new: str, line: int, said: str) -> None:
    file = tmp_path / "chain.yaml"
    file.write_text((DESIGNS / "idler-chain.yaml").read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    if not said:
        assert load(file).source.place("gears.teeth").line == line
        return
    with pytest.raises(WrongInput, match=said) as wrong:
        load(file)
    assert f"chain.yaml:{line}:" in str(wrong.value)


@pytest.mark.parametrize(
    ("key", "name", "line"),
    [
        ("gears.idlers", "train.lobes", 6),
        ("gears.teeth", "train.gears.teeth", 11),
        ("name", "name", 2),
        # Keys that the file may have and does not give, and keys that it cannot have.
        ("output.chord_tolerance_mm", "train.gears.chord_tolerance_mm", 10),
        ("strength.application_factor", "train.strength.application_factor", 4),
        ("gears.least_contact_ratio", "train.gears", 10),
        ("simulation.friction", "train", 4),
    ],
)
def test_refusals_of_a_chain_name_the_keys_of_its_file(key: str, name: str, line: int) -> None:
    with pytest.raises(WrongInput) as wrong, located(loaded("idler-chain").source):
        raise WrongInput("refused", key=key)
    assert wrong.value.key == name
    assert f"idler-chain.yaml:{line}:" in str(wrong.value)


@pytest.mark.parametrize(
    ("changed", "key"),
    [
        ("gears:\n  pairs: 2", "gears.pairs"),
        ("gears:\n  method: equivalent_gear", "gears.method"),
        ("gears:\n  material: {driving: C45, driven: POM}", "gears.material"),
        ("gears:\n  driving: {bore_mm: 10}", "gears.driven"),
        ("gears:\n  backlash_deg: 0.1", "gears.backlash_deg"),
        ("gears:\n  rack: {idle_pressure_angle_deg: 25}", "gears.rack.idle_pressure_angle_deg"),
        ("strength: {overload: {driving_torque_n_m: 20, times: 5}}\ngears:", "strength.overload"),
    ],
)
def test_keys_of_one_pair_are_refused_for_a_row(changed: str, key: str) -> None:
    text = ROW.format(idlers=BENT, law=UNEVEN, torque="12", second=1, backlash=0.0).replace("  backlash_mm: 0.0\n", "")
    with pytest.raises(WrongInput) as wrong:
        drive_of_text(text.replace("gears:", changed))
    assert wrong.value.key == key
    assert "not offered for a row of gears with idlers" in wrong.value.problem


@pytest.mark.thorough
def test_a_torque_that_other_gears_do_not_meet_again_is_refused() -> None:
    """The last gear has two lobes: one lobe of others meets either half of its turn."""
    assert made("{lobes: [2]}", UNEVEN, "12 + sin(2*x)").check.peak_power_w.value > 0.0
    with pytest.raises(WrongInput, match="repeats every 180 deg") as wrong:
        _ = made("{lobes: [2]}", UNEVEN, "12 + sin(x)").check
    assert wrong.value.key == "resistance"


@pytest.mark.thorough
def test_teeth_with_other_chords_stand_where_the_teeth_of_the_row_stand() -> None:
    """As assemblies are compared with finer outlines, and speeds with errors."""
    pair = made("{lobes: [1]}").by_stage[1]
    finer = pair.toothed(pair.chord_tolerance_mm / 4.0)
    for gear in Gear:
        coarse, fine = (Polygon(one.of(gear).outline_mm) for one in (pair.teeth, finer))
        assert coarse.hausdorff_distance(fine) < 2.0 * pair.chord_tolerance_mm


@pytest.mark.slow
def test_assemblies_of_a_row_have_no_keyways_in_idlers_and_want_gears_that_turn_alike() -> None:
    drive = made(BENT)
    given, _ = tolerances_of(drive)
    found = [_mesh_and_limits(pair, given)[1].index_rad for pair in drive.by_stage]
    assert [(one[0] > 0.0, one[1] > 0.0) for one in found] == [(True, False), (False, False), (False, True)]
    with pytest.raises(WrongInput, match="whose gears turn alike"):
        lot_of(made("{lobes: [2]}"), given)


def test_a_key_of_another_kind_of_train_names_the_kind(tmp_path: Path) -> None:
    file = tmp_path / "chain.yaml"
    file.write_text((DESIGNS / "idler-chain.yaml").read_text(encoding="utf-8") + "  arms: 2\n", encoding="utf-8")
    with pytest.raises(WrongInput, match="unknown key of kind chain; kind: planetary has it") as wrong:
        load_train(file)
    assert wrong.value.key == "train.arms"


def test_gears_of_a_row_that_overlap_are_refused() -> None:
    """Three axes 80 mm apart with a bend of 150 deg: the outer two are 2 80 cos(75 deg) = 41.411 mm apart."""
    row = ROW_OF_ROUND.format(bend=150)
    with pytest.raises(NoSuchMechanism, match=r"gears 1 and 3 of the row overlap.*41\.411 mm apart.*80 mm together"):
        _ = loads(row).row
    assert loads(ROW_OF_ROUND.format(bend=119)).row.count == 3


@pytest.mark.slow
def test_remedies_of_a_row_are_those_that_a_row_may_have() -> None:
    """12 : 24 : 12 round teeth of 20 deg are undercut: without it the small gears have 18 (2 / sin^2), the file 18."""
    row = drive_of_text(
        ROW.format(idlers="{lobes: [1]}", law=ROUND, torque="12", second=2, backlash=0.08).replace("24", "12")
    )
    (undercut, *_), shortened = (
        verdict_on(kind, row, KnownParts.TEETH).advices for kind in (Kind.UNDERCUT, Kind.SHORTENED)
    )
    last = verdict_on(Kind.UNDERCUT, row, KnownParts.TEETH).advices[-1]
    asked = [{change.key: change.value for change in one.changes} for one in (*undercut.remedies, *last.remedies)]
    assert [one["gears.teeth"] for one in asked if "gears.teeth" in one] == [18, 18]
    assert not any("profile_shift" in key for one in asked for key in one)
    assert shortened
    assert all("other mesh" in one.what and "helical" not in one.line for one in shortened)
    assert bridging_helix(row.by_stage[0]) == {}


def room_of(drive: Drive) -> tuple[State, list[str]]:
    verdict = verdict_on(Kind.ROOM, drive, KnownParts.TEETH)
    return verdict.rows[0].state, [one.what for one in verdict.advices]


@pytest.mark.slow
def test_gears_of_a_row_that_meet_are_told() -> None:
    """Round gears of 40 teeth, tips at 42 mm: outer axes 160 cos(bend / 2) apart, so 83.92 and 84.16 mm."""
    meeting, passing = (room_of(loads(ROW_OF_ROUND.format(bend=bend))) for bend in (116.7 + 0.6, 116.3))
    assert (meeting[0], passing[0]) == (State.BROKEN, State.KEPT)
    assert "gear 1 and gear 3 meet" in meeting[1][0]
    assert verdict_on(Kind.ROOM, made("{lobes: [1]}"), KnownParts.MOTION).rows[0].state is State.NOT_JUDGED


@pytest.mark.slow
@pytest.mark.parametrize("bend", [100, 110])
def test_gears_of_a_row_that_meet_at_some_angles_only_are_told(bend: int) -> None:
    """By polygons of the scene at places of their own: they overlap nowhere more than where they are told to meet."""
    drive = made(f"{{lobes: [1], bends_deg: [{bend}]}}")
    scene = scene_of_teeth(drive)

    def both(phi1: float) -> tuple[Polygon, Polygon]:
        shafts = scene.shaft_angles_rad(np.array([phi1]))
        return seen(scene.pairs[0].driving, shafts), seen(scene.pairs[1].driven, shafts)

    gears = [both(phi1) for phi1 in np.linspace(0.0, 2.0 * np.pi, 181)]
    overlap = max(one.intersection(other).area for one, other in gears)
    state, said = room_of(drive)
    assert (state is State.BROKEN) == (overlap > 0.0)
    assert max(one.distance(other) for one, other in gears) > 3.0
    for text in said:
        one, other = both(radians(float(text.rpartition("= ")[2].removesuffix(" deg"))))
        assert one.intersection(other).area > 0.999 * overlap


def test_a_row_needs_the_backlash_that_its_deviations_take() -> None:
    """Plays along the normal of 0.1 mm of which 0.03 are left: 0.07 mm would be enough."""
    pair: Any = loads(ROW_OF_ROUND.format(bend=40)).by_stage[0]
    base_mm = 40.0 * cos(radians(20.0))
    assert left_of_backlash(pair, np.array([0.03 / base_mm])) == pytest.approx([-0.07], abs=1e-9)
