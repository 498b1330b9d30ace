"""Figures and words made by hand: what is told of pumps, turning gears, best laws, flanks, cranks and clashes."""

from __future__ import annotations

from math import degrees, inf, pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from at_once import at_once
from drives import drive
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures.advice import drivetrain_advice, given_advice, strength_advice
from ncgear.figures.balance.parts import _gear
from ncgear.figures.best_law import felt, flywheel_figures, limits_not_reached
from ncgear.figures.explained import _meaning
from ncgear.figures.flanks import hours_words, surfaces_rows, vibration_of_rating
from ncgear.figures.mended import _fewer_words
from ncgear.figures.outline_fit import _deviation
from ncgear.figures.side_by_side import SideBySide
from ncgear.figures.simulated import quasi_static_table
from ncgear.figures.strong import face_load_words, jam_words, rim_words, strength_csv
from ncgear.figures.summary.build_summary import _pumped
from ncgear.figures.trains import judged_contacts
from ncgear.numerics.extrema import Extremum
from ncgear.pitch.shape import Gear
from ncgear.project.mending import MendingSubject as MendKind
from ncgear.solids.plan.body import RoundHole
from ncgear.strength.holding import Damage, lives_of
from strong import made_up, made_up_surfaces

pytestmark = pytest.mark.judges("figures")

Made: Any = SimpleNamespace


def test_a_pump_tells_volumes_in_cm3_and_flows_in_litres() -> None:
    """5000 mm3 a turn at 120 r/min are 0.6 l/min; 900 mm3/rad are 900 2 pi 120 mm3/min."""
    found = Made(per_turn_mm3=5000.0, least=Extremum(700.0, 0.3), most=Extremum(900.0, 1.3), pulsation=0.25)
    one = Made(pumped=found, housing_radii_mm={Gear.DRIVING: 20.5, Gear.DRIVEN: 30.0},
               design=Made(operation=Made(speed_rpm=120.0)))  # fmt: skip
    told = _pumped(one)["displacement"]
    assert (told["per_turn_cm3"], told["mean_flow_l_min"]) == pytest.approx((5.0, 0.6))
    assert told["least_flow_l_min"] == pytest.approx(700.0 * 2.0 * pi * 120.0 * 1e-6)
    assert (told["largest_flow_l_min"], told["largest_flow_at_rad"]) == pytest.approx((900.0 * 240.0 * pi * 1e-6, 1.3))
    assert (told["pulsation_percent"], told["housing_bore_driving_mm"], told["housing_bore_driven_mm"]) == (25, 41, 60)
    assert _pumped(Made(pumped=None, housing_radii_mm=None)) == {}


def body(mass: float, unbalance: complex) -> Any:
    return Made(mass_kg=mass, unbalance_kg_mm=unbalance, eccentricity_mm=abs(unbalance) / mass, inertia_kg_mm2=9.0,
                couple_kg_mm2=3.0 + 4.0j)  # fmt: skip


@at_once(("speed_rpm", "worth"), [(1500.0, True), (60.0, False)])
def test_a_gear_out_of_balance_pulls_with_the_square_of_its_speed(speed_rpm: float, worth: bool) -> None:
    """m e w^2 against ISO 21940-11: G is e w in mm/s; a slow gear's pull is nothing beside its weight."""
    speed = speed_rpm * pi / 30.0
    holes = [RoundHole(3.0, 4.0, 5.0)]
    corrected = Made(body=body(1.9, 0.02 + 0.0j), holes=holes, boss=Made(height_mm=2.0, section=Made(area=7.0)))
    told = _gear(Made(speed_rad_s=speed, body=body(2.0, 3.0 + 4.0j), corrected=corrected), 16.0)
    assert told["peak_speed_rpm"] == pytest.approx(speed_rpm)
    assert (told["unbalance_kg_mm"], told["direction_deg"]) == pytest.approx((5.0, degrees(np.arctan2(4.0, 3.0))))
    assert told["unbalance_force_n"] == pytest.approx(1e-3 * 5.0 * speed**2)
    assert told["torque_of_weight_n_m"] == pytest.approx(1e-3 * 9.80665 * 5.0)
    assert told["couple_kg_mm2"] == 5.0
    assert told["permissible_kg_mm"] == pytest.approx(2.0 * 16.0 / speed)
    assert told["permitted"] == (32.0 / speed >= 5.0)
    assert told["worth_correcting"] is worth
    left = told["corrected"]
    assert left["unbalance_kg_mm"] == 0.02
    assert left["force_removed_n"] == pytest.approx(1e-3 * (5.0 - 0.02) * speed**2)
    assert (left["holes"], left["boss_area_mm2"]) == ([{"x_mm": 3.0, "y_mm": 4.0, "diameter_mm": 5.0}], 7.0)


def test_limits_that_a_law_stays_away_from_are_told_with_what_it_has() -> None:
    """Of a tangent of 0.3 rad and a rack of 0.35: 37.2 deg of 60; a speed that is reached is left out."""
    given = Made(model_fields_set=["pressure_angle_deg", "peak_speed_mm_s", "peak_power_w", "ratio_min"],
                 pressure_angle_deg=60.0, peak_speed_mm_s=200.0, peak_power_w=None, ratio_min=0.2)  # fmt: skip
    names = ("peak_acceleration_mm_s2", "peak_jerk_mm_s3", "acceleration_harmonics_mm_s2", "center_distance_mm")
    loads = ("torque_fluctuation_n_m", "flywheel_kg_mm2", "bearing_force_n", "shaking_force_n", "tooth_force_n")
    figures = Figures(dict.fromkeys((*names, *loads), 1.0) | {
        "peak_speed_mm_s": 199.99, "tangent_rad": 0.3, "ratio_max": 2.0, "ratio_min": 0.5, "peak_power_w": 3.0,
    })  # fmt: skip
    best = Made(asked=Made(limits=given), figures=figures,
                wishes=Made(limits=Made(rack_angle_rad=0.35), pairs=1))  # fmt: skip
    found = limits_not_reached(best)
    assert found == {"pressure_angle_deg": (60.0, pytest.approx(degrees(0.65))), "ratio_min": (0.2, 0.5)}
    best.wishes.pairs = 2
    assert "pressure_angle_deg" not in limits_not_reached(best)
    figures.values["ratio_min"] = 0.2
    assert "ratio_min" not in limits_not_reached(best)
    best.asked.limits = Made(model_fields_set=[])
    assert limits_not_reached(best) == {}


class Figures:
    """Figures of a law by their names; those not given are not known."""

    def __init__(self, values: dict[str, float]) -> None:
        self.values = values

    def __getattr__(self, name: str) -> float | None:
        return self.__dict__["values"].get(name)


def test_flywheels_are_told_in_kg_m2_with_the_gap_to_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    assert felt("flywheel_kg_m2", Made(flywheel_kg_mm2=2.5e6)) == pytest.approx(2.5)  # type: ignore[arg-type]
    assert felt("flywheel_kg_m2", Made(flywheel_kg_mm2=None)) is None  # type: ignore[arg-type]
    monkeypatch.setattr("ncgear.figures.best_law.figures_summary", lambda law: {"power": law.peak_power_w})
    points = [Made(flywheel_kg_mm2=1.0, limit_w=limit, law=Made(peak_power_w=105.0)) for limit in (100.0, 0.0)]
    told = flywheel_figures(points, drive("ellipse").design)["points"]
    assert [one["gap"] for one in told] == [pytest.approx(0.05), None]


def test_a_law_under_load_is_behind_by_its_error() -> None:
    loaded = Made(error_rad=np.array([1e-3, -2e-3]), pairs=np.array([1, 2]), tooth_force_n=np.array([5.0, 6.0]),
                  forces=Made(depth_mm=np.array([[0.01, 0.02], [-0.5, -0.1]])),
                  driving_torque_n_mm=np.array([1500.0, -500.0]))  # fmt: skip
    motion = Made(phi1_rad=np.array([0.1, 0.2]), phi2_rad=np.array([0.15, 0.25]))
    drive = Made(by_stage=[Made(loaded_contact=loaded)], motion=motion, loaded_error_at=lambda _phi1: loaded.error_rad)
    told = quasi_static_table(drive, np.array([1.4, -0.4]))
    assert told["phi2_rad"] == pytest.approx([0.151, 0.248])
    assert told["depth_mm"].tolist() == [0.02, 0.0]
    assert told["driving_torque_n_m"] == pytest.approx([1.5, -0.5])


def test_figures_side_by_side_differ_by_percent_of_the_first() -> None:
    found = Made(keys=("a",), figures=[{"a": 8.0}, {"a": 10.0}, {"a": 6.0}, {}])
    assert SideBySide.percent(found, "a") == (pytest.approx(25.0), pytest.approx(-25.0), None)
    assert SideBySide.percent(Made(keys=("a",), figures=[{"a": 0.0}, {"a": 1.0}]), "a") == (None,)
    with pytest.raises(WrongInput, match="'b' is no figure"):
        SideBySide.percent(found, "b")


@at_once(
    ("at_mm", "said", "matters"),
    [
        (9.0, ["within the gear"], [True]),
        (-9.9, ["within the gear"], [True]),
        (15.0, ["between the bearings"], [False]),
        (40.0, ["in one of the bearings"], [True]),
        (45.0, [], []),
        (-30.0, [], []),
    ],
)
def test_a_crank_stands_beside_its_gear_and_beyond_its_bearings(
    at_mm: float, said: list[str], matters: list[bool]
) -> None:
    """The gear is 20 mm wide; its shaft's bearings are at -20 and 40 mm."""
    shaft = Made(crank_at_mm=at_mm, bearing_a=Made(at_mm=40.0), bearing_b=Made(at_mm=-20.0))
    one = Made(design=Made(drivetrain=Made(driven_shaft=shaft)), gears=Made(face_width_mm=20.0),
               linkage=Made(HAS_CRANK=True))  # fmt: skip
    found = list(drivetrain_advice._of_crank(one))
    words = [{True: "within the gear", False: "in one of the bearings"}["within the gear" in f"{advice.what}"] if
             "between" not in advice.what else "between the bearings" for advice in found]  # fmt: skip
    assert words == said
    assert [advice.matters for advice in found] == matters


def test_a_motor_that_runs_off_its_speed_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ncgear.project.motor.fitting_simulated", lambda drive: {"simulation.motor.x": 3.0})
    one = Made(motor_stall=None, machine=Made(speed_rad_s=2.0 * pi))
    for share, told in ((1.02, False), (0.98, False), (1.05, True), (0.9, True)):
        monkeypatch.setattr("ncgear.project.motor.steady_rad_s", lambda drive, share=share: share * 2.0 * pi)
        found = list(drivetrain_advice._of_simulated(one))
        assert bool(found) == told
        assert not found or f"runs at {60.0 * share:g} r/min, not at operation.speed_rpm: 60" in found[0].what

    def refused(drive: Any) -> float:
        raise NoSuchMechanism("it stands still; more torque is right")

    monkeypatch.setattr("ncgear.project.motor.steady_rad_s", refused)
    (found,) = drivetrain_advice._of_simulated(one)
    assert found.what == "it stands still"


def test_words_about_rims_jams_and_bearing_along_the_face() -> None:
    rims = Made(wall_mm=np.array([4.0, 1.234]), factor=np.array([1.0, 1.31]))
    one: Any = Made(rims=(rims, rims))
    weakest = [
        Made(gear=Gear.DRIVING, damage=Damage.BENDING, tooth=2),
        Made(gear=Gear.DRIVEN, damage=Damage.BENDING, tooth=1),
        Made(gear=Gear.DRIVEN, damage=Damage.CONTACT, tooth=2),
    ]
    assert rim_words(one, Made(weakest=weakest)) == (
        "thin wall of 1.2 mm under tooth 2 of the driving gear, stress times 1.31"
    )
    assert rim_words(one, Made(weakest=weakest[1:])) == ""
    known = Made(
        factor_min=1.1, factor_max=1.6, decisive_factor=1.5, decisive_tooth=7, decisive_factor_by_shafts=1.2,
        best_crowning_factor=1.3, best_crowning_um=8.0, decisive_factor_at_rad=0.5 * pi,
        best_end_relief_factor=1.25, best_end_relief_um=9.0, best_end_relief_length_mm=4.0,
    )  # fmt: skip
    loaded = Made(face_loading=Made(constant=1.25, basis="assumed", why="no bearings are given", rigid_bearings=["a"]),
                  told_face_load_by=lambda method: known, design=Made(tolerances=None))  # fmt: skip
    rating = Made(strength=Made(method="estimate"))
    words = face_load_words(loaded, rating)
    assert words.startswith("computed: 1.5 at tooth 7, phi1 = 90.0 deg, most loaded, 1.2 if not askew, ")
    assert "; 1.1 to 1.6 of all; " in words
    better = "crowning 8 \u00b5m: 1.3, end relief 9 \u00b5m over 4 mm: 1.25"
    assert f"; {better}; without static_rating_n, a counts as rigid" in words
    known.best_crowning_factor = 1.4999
    assert "; end relief 9 \u00b5m over 4 mm: 1.25; " in face_load_words(loaded, rating)
    known.best_end_relief_factor = 1.4999
    assert "no other crowning or end relief is better" in face_load_words(loaded, rating)
    loaded.told_face_load_by = lambda method: None
    assert face_load_words(loaded, rating) == "factor 1.25, assumed since no bearings are given"
    jammed = made_up(drive("ellipse"), 0.8, 0.7)
    in_jam: Any = Made(conditions=Made(overload=Made(driving_n_mm=2.5e5, times=3.0)),
                       judged_teeth=lambda method: Made(jammed=Holding(jammed, 4321.0)))  # fmt: skip
    told = jam_words(in_jam, rating)
    assert told.startswith("250 N m at the driving shaft, 3 times: up to 4321 N")
    least = {damage: min(life.safety_min for life in (lives_of(jammed, gear)[damage] for gear in Gear)) for damage in
             lives_of(jammed, Gear.DRIVEN)}  # fmt: skip
    assert all(f"{least[damage]:.3g} against {damage.words}" in told for damage in least)
    assert jam_words(Made(conditions=Made(overload=None), judged_teeth=lambda method: Made(jammed=None)), rating) == ""


class Holding:
    """An answer of strength with a largest force on a pair of teeth."""

    def __init__(self, strength: Any, most_n: float) -> None:
        self.strength, self.peak_pair_n = strength, most_n

    def __getattr__(self, name: str) -> Any:
        return getattr(self.__dict__["strength"], name)


def test_a_table_of_strength_has_a_row_for_each_tooth() -> None:
    found = made_up(drive("ellipse"), 2.0, 1.5)
    film = made_up_surfaces().film
    heads, *rows = [line.split(",") for line in strength_csv(found, film).splitlines()]
    assert [(row[0], row[1]) for row in rows] == [(gear.value, str(n)) for gear in Gear for n in range(1, 38)]
    for gear, own in zip(Gear, (rows[:37], rows[37:]), strict=True):
        for damage, life in lives_of(found, gear).items():
            cells = [row[heads.index(f"{damage}_safety")] for row in own]
            wanted = [value if value < inf else None for value in life.safety.tolist()]
            assert [float(cell) if cell else None for cell in cells] == pytest.approx(wanted)
    # The film grows with the angle, so that it is thinnest where a tooth begins to touch; only 19 teeth do.
    column = heads.index("film_phi1_rad")
    begins = [2.0 * pi * tooth / 19.0 for tooth in range(18)]
    assert [float(row[column]) for row in rows[:18]] == pytest.approx(begins)
    assert [float(row[column - 1]) for row in rows[:18]] == pytest.approx([0.5 + 0.1 * angle for angle in begins])
    assert rows[19][column - 1 : column + 2] == ["", "", ""]
    assert {row.count(",") for row in strength_csv(found, None).splitlines()} == {len(heads) - 1}


def test_words_about_wear_and_hours() -> None:
    """What is worn off within the wanted life, and when a tenth of the module would be gone."""
    found = made_up_surfaces()
    one: Any = Made(conditions=Made(lubrication="dry", oil_fzg_stage=10.0), design=drive("ellipse").design)
    rows = dict(surfaces_rows(one, found))
    assert rows["wear"].startswith("0.01 mm in 20000 h, to a factor of ten; backlash grows by up to 0.02 mm")
    assert "film" in rows
    assert "heat" not in rows
    assert [hours_words(hours) for hours in (12345.0, 87.6, 3.21, 0.004, inf)] == ["12000 h", "88 h", "3.2 h", "none",
                                                                                    "none"]  # fmt: skip


def test_the_dynamic_factor_of_a_position_is_the_mean_by_the_loads_of_its_pairs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    kept: dict[str, Any] = {}
    monkeypatch.setattr("ncgear.project.vibration.mesh_stiffness", lambda loading, running: "mesh")
    monkeypatch.setattr(
        "ncgear.project.vibration.told_vibration",
        lambda drive, vibration, mesh, phi1, mean, force: kept.update(mean=mean) or "told",
    )
    contacts = Made(position=np.array([0, 0, 1, 2]), force_n=np.array([100.0, 300.0, 50.0, 0.0]),
                    phi1_rad=np.zeros(4), pair_force_n=np.zeros(4))  # fmt: skip
    stresses = Made(dynamic_factor=np.array([1.2, 1.4, 1.1, 1.3]))
    rating: Any = Made(loading=None, strength=Made(contacts=contacts, stresses=stresses))
    assert vibration_of_rating(Made(running=None, vibration=None), rating) == "told"
    assert kept["mean"] == pytest.approx([1.35, 1.35, 1.1, 0.0])


def test_fewer_teeth_are_told_where_time_ended_the_search() -> None:
    def way(count: Any, *kinds: MendKind) -> Any:
        return Made(kinds=kinds, changes={"gears.teeth": count})

    found: Any = Made(way=way(30, MendKind.FINER), drive=Made(by_stage=[Made(pitch=Made(size=Made(driving_teeth=30)))]))
    failed = [way(20, MendKind.FINER), way(24, MendKind.FINER), way(40, MendKind.FINER), way(29, MendKind.BACKLASH)]
    no_more = "; whether fewer do was not searched further"
    assert _fewer_words(Made(is_whole=False, failed=failed), found) == f"; 24 are refused{no_more}"
    assert _fewer_words(Made(is_whole=False, failed=failed[2:]), found) == no_more
    assert _fewer_words(Made(is_whole=True, failed=failed), found) == ""


def test_how_far_a_curve_strays_is_told_in_mm_and_shares() -> None:
    away = Made(root_mean_square_mm=0.5, greatest_mm=2.0, at_mm=(1.0, 2.0), of_outline=True)
    told = _deviation(away, 40.0, ())
    assert (told["root_mean_square_share"], told["greatest_share"]) == (0.0125, 0.05)


def test_meshes_and_room_of_a_train_are_judged_by_the_worst() -> None:
    allowed = list[float]()

    def contact(deepest: float, gap: float, name: str) -> Any:
        def clashes(most: float) -> bool:
            allowed.append(most)
            return deepest > most

        return Made(first=name, second="sun", penetration_max_mm=deepest, gap_max_mm=gap,
                    penetration_max_at_rad=0.1, gap_max_at_rad=0.2,
                    clashes=clashes, parts=lambda most: gap > most)  # fmt: skip

    def distance(least: float, name: str) -> Any:
        return Made(first=name, second="bar", least_distance_mm=least, at_rad=0.5)

    train = Made(tolerance_mm=0.01)
    good = judged_contacts(train, [contact(0.001, 0.002, "a"), contact(0.004, 0.001, "b")], [distance(3.0, "c")])
    assert [one.holds for one in good] == [True, True, None]
    assert "c and bar pass at 3 mm" in good[1].said
    bad = judged_contacts(train, [contact(5.0, 0.0, "a"), contact(0.0, 7.0, "b")], [distance(-0.1, "c")])
    assert [one.holds for one in bad] == [False, False, None]
    assert "overlap by" in bad[0].said
    assert "part by" in bad[0].said
    assert len({*allowed}) == 1
    assert (
        judged_contacts(train, [contact(0.0, 0.0, "a")], [])[1].said == "no parts at one height come near to each other"
    )


@at_once(("root", "flank"), [((1.5, 0.9), (1.0, 1.2)), ((1.4, 0.9), (1.2, 0.2)), ((3.0, 0.3), (1.0, 0.9))])
def test_rough_sizes_are_enough_by_how_stresses_scale(root: tuple[float, float], flank: tuple[float, float]) -> None:
    """Root stress goes as 1/(b m^2), the stress of flanks as 1/(m sqrt(b)): the weakest just has its safety."""
    damages = (Damage.BENDING, next(one for one in Damage if one is not Damage.BENDING))
    weak = [Made(damage=of, wanted=one[0], safety=one[1]) for of, one in zip(damages, (root, flank), strict=True)]
    came: list[tuple[float, float]] = []
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(strength_advice, "_sizes", lambda _, wider, larger: came.append((wider, larger)) or [])
        strength_advice._rough_remedies(None, Made(safeties=weak, unjudged=""))  # type: ignore[arg-type]
    ((wider, larger),) = came
    for width, module in ((wider, 1.0), (1.0, larger)):
        factors = width * module**2, module * width**0.5
        safeties = [one.safety * factor / one.wanted for one, factor in zip(weak, factors, strict=True)]
        assert min(safeties) == pytest.approx(strength_advice.SAFE_SIDE)


def test_an_angle_is_meant_without_its_unit() -> None:
    """Both its spellings have one meaning; a length has one spelling, whose unit is told."""
    angles: Any = [
        Made(name=name, is_law_name=False, meaning="Phase, in rad, of a gear") for name in ("a_deg", "a_rad")
    ]
    assert _meaning([], angles) == "Phase, of a gear"
    assert _meaning([], angles[:1]) == "Phase, in rad, of a gear"
    keys: Any = [Made(path="motion", meaning="How it moves."), Made(path="gears", meaning="The gears.")]
    law: Any = [Made(name="law", path="motion.law", is_law_name=True, meaning="Its name.")]
    assert _meaning(keys, law) == "How it moves."


@at_once(("undercut", "clear", "told"), [("allow", (1, 1), 1), ("allow", (1, 0), 0), ("avoid", (1, 1), 0)])
def test_allowed_undercut_is_idle_where_no_tooth_of_any_pair_has_any(
    undercut: str, clear: tuple[int, ...], told: int
) -> None:
    one: Any = Made(design=Made(gears=1), gears=Made(undercut=undercut), by_stage=clear)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(given_advice, "without_effect", lambda _: iter(()))
        patched.setattr(given_advice, "_is_clear_of_undercut", bool)
        found = [*given_advice.with_teeth(one)]
        before = [*given_advice.before_teeth(one)]
    assert len(found) == told
    assert len(before) == (undercut == "allow")
    assert all("gears.undercut" in str(advice) for advice in found)
