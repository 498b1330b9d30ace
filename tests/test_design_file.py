"""Loading design files: what they mean, where their values stand, points from CSV files, templates, JSON Schema."""

from __future__ import annotations

import json
from math import inf, pi
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from at_once import at_once
from ncgear.design.keys.design import Design, json_schema
from ncgear.design.keys.gears import PROFILES, Rack
from ncgear.design.laws.ellipse import Ellipse
from ncgear.design.laws.ratio_expression import RatioExpression
from ncgear.design.laws.registry import LawName
from ncgear.design.laws.table import MOST_POINTS, Table
from ncgear.design.laws.three_segment_stroke import SOLVED_KEYS, ThreeSegmentStroke
from ncgear.design.reading.design_file import LoadedDesign, load
from ncgear.design.reading.text import plain_value
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.template import template
from ncgear.errors import NoSuchMechanism, WrongInput, located

HEAD = "name: a\nlinkage: {crank_mm: 100, rod_mm: 300}\noperation: {speed_rpm: 60}\n"


def loaded(folder: Path, text: str) -> LoadedDesign:
    """Load ``text`` from a file d.yaml in ``folder``."""
    path = folder / "d.yaml"
    path.write_text(text, encoding="utf-8")
    return load(path)


def refusal(folder: Path, text: str) -> WrongInput:
    """The error that loading ``text`` raises."""
    with pytest.raises(WrongInput) as caught:
        loaded(folder, text)
    return caught.value


def test_baler_template_holds_what_it_says(tmp_path: Path) -> None:
    design = loaded(tmp_path, template("baler")).design
    motion = design.motion
    assert isinstance(motion, ThreeSegmentStroke)
    angles = (motion.theta1, motion.theta2, motion.theta3, motion.theta4)
    assert angles == pytest.approx((0.4 * pi, 0.7 * pi, pi, 1.3 * pi), rel=1e-15)
    assert (motion.v1_mm_s, motion.v2_mm_s, motion.a1_mm_s2, motion.a1_speed_rpm) == (None, 416.6, -1500, None)
    assert (motion.law_speed_rpm, motion.stroke_mm) == (20, 760)
    assert (motion.return_.basis, motion.return_.e) == ("ratio", "least_acceleration")
    assert design.resistance is not None
    assert design.resistance.polynomial_n == (-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7)
    assert design.motion.gives_slider


@pytest.mark.parametrize("law", LawName)
def test_every_template_loads(tmp_path: Path, law: LawName) -> None:
    design = loaded(tmp_path, template("mine", law)).design
    assert (design.name, design.motion.law) == ("mine", law.value)
    assert design.gears is not None


def test_defaults(tmp_path: Path) -> None:
    design = loaded(
        tmp_path, HEAD + "motion: {law: uniform_crank}\ngears: {teeth: 20, module_mm: 2, face_width_mm: 9}\n"
    )
    gears = design.design.gears
    assert gears is not None
    assert (gears.lobes.driving, gears.lobes.driven, gears.backlash_mm, gears.center_distance_mm) == (1, 1, 0.0, None)
    assert (gears.driving.bore_mm, gears.driven.keyway) == (None, None)
    assert (design.design.linkage.offset_mm, design.design.output.chord_tolerance_mm) == (0.0, None)
    assert (design.design.resistance, design.design.comparison, design.design.description) == (None, None, "")
    assert not design.design.motion.gives_slider


@at_once("profile", "ABCD")
def test_rack_takes_its_coefficients_from_the_profile(profile: str) -> None:
    rack = Rack.model_validate({"profile": profile, "root_radius": 0.1})
    assert (rack.addendum, rack.dedendum, rack.root_radius) == (1.0, PROFILES[profile].dedendum, 0.1)
    assert Rack.model_validate({"profile": profile}).root_radius == PROFILES[profile].root_radius


@at_once(
    ("asked", "radius"),
    [
        # (pi/4 - 1.25 tan 25) / tan 32.5 = 0.3178 and (pi/4 - 1.4 tan 25) / tan 32.5 = 0.2081, hundredths below.
        ({"pressure_angle_deg": 25.0}, 0.31),
        ({"pressure_angle_deg": 25.0, "profile": "D"}, 0.20),
        ({"pressure_angle_deg": 25.0, "profile": "C"}, 0.25),
        ({"pressure_angle_deg": 22.5}, 0.38),
        # (pi/4 - 1.6 tan 20) / tan 35 = 0.2899
        ({"dedendum": 1.6}, 0.28),
        # 0.2 / (1 - sin 20) = 0.3040: a greater one begins above the mid line.
        ({"dedendum": 0.2}, 0.30),
        # The cutter is pointed at 2.158 modules.
        ({"dedendum": 2.2}, 0.0),
        ({"pressure_angle_deg": 25.0, "root_radius": 0.38}, 0.38),
    ],
)
def test_a_root_radius_that_is_left_out_fits(asked: dict[str, object], radius: float) -> None:
    assert Rack.model_validate(asked).root_radius == radius


def test_wrong_profile_is_one_fault_not_four(tmp_path: Path) -> None:
    text = (
        HEAD + "motion: {law: uniform_crank}\ngears: {teeth: 20, module_mm: 2, face_width_mm: 9, rack: {profile: E}}\n"
    )
    assert str(refusal(tmp_path, text)).count("\n") == 0


SHAFT, UNIFORM = "name: a\nlinkage: {crank_mm: 100, rod_mm: 300}\n", "motion: {law: uniform_crank}\n"
SLIPS = {
    "key beside its empty group": (f"{SHAFT}operation:\nspeed_rpm: 60\n{UNIFORM}", "speed_rpm stands under operation"),
    "misspelt beside its group": (f"{SHAFT}operation:\nspeed_rmp: 60\n{UNIFORM}", "speed_rpm stands under operation"),
    "misspelt group and empty one": (
        f"{SHAFT}operation:\noperatoin: {{speed_rpm: 60}}\n{UNIFORM}",
        "unknown key; did you mean operation?",
    ),
    "angle without a unit": (
        f"{HEAD}{UNIFORM}wishes: {{gentle_stop: [{{from_phi1: 60, to_phi1_deg: 90, speed_at_most_mm_s: 100}}]}}\n",
        "did you mean from_phi1_rad, from_phi1_deg or from_phi1_pi?",
    ),
    "another law": (
        f"{HEAD}motion: {{law: uniform_crank, theta1_pi: 0.4, theta2_pi: 0.7, ratio: [1, 2], v2_mm_s: 3}}\n",
        "uniform_crank; law: three_segment_stroke has theta1_pi, theta2_pi and v2_mm_s, law: ratio_expression, "
        "spline_ratio or table has ratio: give that law, or leave them out",
    ),
    "lists in a list": (
        f"{HEAD}motion: {{law: table, phi1_deg: [0, 90, 180, 270], ratio: [[1], [2], [1], [2]]}}\n",
        "ratios i12 = dphi1/dphi2, one for each angle); 3 more items alike",
    ),
    "a long number": (HEAD.replace("60", "1e9") + UNIFORM, "1e+09 given; a number of 1e+07 or under"),
}


@pytest.mark.parametrize(("text", "said"), SLIPS.values(), ids=SLIPS.keys())
def test_one_slip_is_one_message(tmp_path: Path, text: str, said: str) -> None:
    error = refusal(tmp_path, text)
    assert said in error.problem
    assert error.others == ()


@pytest.mark.parametrize("spelling", ["phase_rad: 1.5707963267948966", "phase_deg: 90", "phase_pi: 0.5"])
def test_angle_in_any_unit(tmp_path: Path, spelling: str) -> None:
    motion = loaded(tmp_path, HEAD + f"motion: {{law: ellipse, eccentricity: 0, {spelling}}}\n").design.motion
    assert isinstance(motion, Ellipse)
    assert motion.phase == pytest.approx(pi / 2, rel=1e-15)


def test_crank_may_be_left_out_when_the_stroke_is_solved_for(tmp_path: Path) -> None:
    text = template("baler").replace("solve_for: v1 ", "solve_for: stroke ").replace("crank_mm: 380", "# gone")
    text = text.replace("# v1_mm_s: ", "v1_mm_s: 606 ").replace("stroke_mm: 760", "# gone")
    assert loaded(tmp_path, text).design.linkage.crank_mm is None


def test_theta2_and_theta3_may_coincide(tmp_path: Path) -> None:
    motion = loaded(tmp_path, template("baler").replace("theta3_pi: 1.0", "theta3_deg: 126 ")).design.motion
    assert isinstance(motion, ThreeSegmentStroke)
    assert motion.theta3 == motion.theta2


@pytest.mark.parametrize(("solved", "key"), [(name, keys[0]) for name, keys in SOLVED_KEYS.items()])
def test_each_quantity_can_be_solved_for(tmp_path: Path, solved: str, key: str) -> None:
    text = template("baler").replace("solve_for: v1 ", f"solve_for: {solved} ")
    text = text.replace("# v1_mm_s: ", "v1_mm_s: 606 ") if key != "v1_mm_s" else text
    motion = loaded(tmp_path, text.replace(f"  {key}:", f"  # {key}:")).design.motion
    assert isinstance(motion, ThreeSegmentStroke)
    assert [name for name in (keys[0] for keys in SOLVED_KEYS.values()) if getattr(motion, name) is None] == [key]


def test_both_formulas_are_allowed_alone(tmp_path: Path) -> None:
    motion = loaded(tmp_path, HEAD + 'motion: {law: ratio_expression, driven_angle: "phi"}\n').design.motion
    assert isinstance(motion, RatioExpression)
    assert (motion.ratio, motion.driven_angle, motion.scale_to_close) == (None, "phi", False)


def test_number_e_is_kept(tmp_path: Path) -> None:
    motion = loaded(tmp_path, template("baler").replace("e: least_acceleration", "e: 0 ")).design.motion
    assert isinstance(motion, ThreeSegmentStroke)
    assert motion.return_.e == 0.0


def test_design_cannot_be_changed(tmp_path: Path) -> None:
    design, field = loaded(tmp_path, HEAD + "motion: {law: uniform_crank}\n").design, "name"
    with pytest.raises(ValueError, match="frozen"):
        setattr(design, field, "b")


@at_once(
    ("text", "value"),
    [
        ("1e-3", 1e-3),
        ("-1.5E+2", -150.0),
        (".5", 0.5),
        ("010", 10),
        ("-.inf", -inf),
        ("true", True),
        ("~", None),
        ("", None),
        # Text: other dialects read these as truth values, a date, and numbers.
        ("no", "no"),
        ("on", "on"),
        ("2001-01-01", "2001-01-01"),
        ("0x10", "0x10"),
        ("1_000", "1_000"),
    ],
)
def test_plain_scalars_mean_what_yaml_1_2_says(text: str, value: object) -> None:
    assert plain_value(text) == value
    assert type(plain_value(text)) is type(value)


def place(design: LoadedDesign, key: str) -> str:
    """FILE:LINE:COLUMN of a key."""
    return str(design.source.place(key))


def test_keys_have_their_places(tmp_path: Path) -> None:
    design = loaded(tmp_path, template("baler"))
    file = tmp_path / "d.yaml"
    assert place(design, "linkage.rod_mm") == f"{file}:10:3"
    assert place(design, "linkage.nothing.below") == f"{file}:8:1"
    assert place(design, "nothing") == f"{file}:5:1"
    assert place(design, "") == f"{file}:5:1"
    assert place(design, "motion.theta2") == place(design, "motion.theta2_rad") == f"{file}:22:3"
    text = file.read_text(encoding="utf-8").splitlines()
    line = next(number for number, content in enumerate(text, 1) if "polynomial_n" in content)
    column = text[line - 1].index("3.447") + 1
    assert place(design, "resistance.polynomial_n.1") == f"{file}:{line}:{column}"


def test_errors_get_their_place_and_keep_a_known_one(tmp_path: Path) -> None:
    design = loaded(tmp_path, template("baler"))
    with pytest.raises(NoSuchMechanism) as caught, located(design.source):
        raise NoSuchMechanism("does not exist", key="motion.theta1")
    assert str(caught.value) == f"{tmp_path}/d.yaml:21:3: motion.theta1_pi: does not exist"
    with pytest.raises(WrongInput) as caught_elsewhere, located(design.source):
        raise WrongInput("x", key="motion", location="other:1:1")
    assert caught_elsewhere.value.location == "other:1:1"


def points(folder: Path, csv: str, more: str = "") -> Table:
    """The table law of a design file that names a CSV file holding ``csv``."""
    (folder / "p.csv").write_text(csv)
    motion = loaded(folder, f"{HEAD}motion:\n  law: table\n  file: p.csv\n{more}").design.motion
    assert isinstance(motion, Table)
    return motion


def test_points_from_a_file(tmp_path: Path) -> None:
    law = points(tmp_path, "displacement_mm, phi1_deg\n0,0\n\n10,90\n 20 ,180\n1e1,270\n")
    assert law.displacement_mm == (0.0, 10.0, 20.0, 10.0)
    assert law.phi1 == pytest.approx((0.0, pi / 2, pi, 3 * pi / 2), rel=1e-15)
    assert law.ratio is None


def test_points_file_lies_beside_the_design_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir("/")
    assert points(tmp_path, "phi1_pi,ratio\n0,1\n.5,1\n1,1\n1.5,1\n").phi1_pi == (0.0, 0.5, 1.0, 1.5)


@pytest.mark.slow
def test_many_points(tmp_path: Path) -> None:
    rows = "".join(f"{360 * i / MOST_POINTS!r},1\n" for i in range(MOST_POINTS))
    assert len(points(tmp_path, "phi1_deg,ratio\n" + rows).phi1) == MOST_POINTS
    with pytest.raises(WrongInput, match=rf"p.csv:{MOST_POINTS + 2}:1: over 200000 points"):
        points(tmp_path, "phi1_deg,ratio\n" + rows + "360,1\n")


ROWS = "0,1\n90,1\n180,1\n270,1\n"


@pytest.mark.parametrize(
    ("csv", "said"),
    [
        ("", "p.csv:1:1: the header must name one of the columns phi1_rad"),
        ("phi1_deg,ratio\n0,1\n90,x\n180,1\n", "p.csv:3:4: ratio: 'x' is not a finite number"),
        ("phi1_deg,ratio\n0,1\n\nnan,1\n", "p.csv:4:1: phi1_deg: 'nan' is not a finite number"),
        ("phi1_deg,ratio\n0,1e999\n", "p.csv:2:3: ratio: '1e999' is not a finite number"),
        ("phi1_deg,ratio\n0,\n", "p.csv:2:3: ratio: '' is not a finite number"),
        ("phi1_deg,ratio\n0,1,2\n", "p.csv:2:1: 3 values for 2 columns"),
        ("phi1_deg;ratio\n" + ROWS, "p.csv:2:1: 1 values for 2 columns; one number for each is right"),
        ("phi1_deg,speed\n" + ROWS, "p.csv:1:10: unknown column: 'speed'; columns can be phi1_rad"),
        ("ratio,ratio\n" + ROWS, "p.csv:1:7: column given twice: 'ratio'"),
        ("phi1_deg,phi1_rad\n" + ROWS, "p.csv:1:1: the header must name one of the columns phi1_rad"),
        ("phi1_deg\n0\n90\n180\n270\n", "p.csv:1:1: the header must name one of the columns displacement_mm"),
        ("\n\n \nphi1_deg,speed\n" + ROWS, "p.csv:4:10: unknown column: 'speed'"),
        ("\nratio\n1\n", "p.csv:2:1: the header must name one of the columns phi1_rad"),
        ("\n\nphi1_deg,ratio\n0,1\n90,1\n", "p.csv:3:1: motion.phi1_deg: a list of 2 given; a list of at least 4"),
        (
            f"phi1_deg,ratio\n0,{'5' * 333}\n",
            "p.csv:2:3: ratio: '55555555555555555555",
        ),
        ('phi1_deg,ratio\n0,"1\n', "p.csv:2:1: is not CSV"),
        ("phi1_deg,ratio\n0,1\n90,1\n\n90,1\n270,1\n", "p.csv:5:1: motion.phi1_deg.2: 90 follows 90"),
        ("phi1_deg,ratio\n0,1\n90,1\n", "p.csv:1:1: motion.phi1_deg: a list of 2 given; a list of at least 4"),
    ],
)
def test_fault_in_the_points_file_has_a_line_of_it(tmp_path: Path, csv: str, said: str) -> None:
    with pytest.raises(WrongInput) as caught:
        points(tmp_path, csv)
    assert str(caught.value).removeprefix(f"{tmp_path}/").startswith(said)


@pytest.mark.parametrize(
    ("unit", "near", "least"), [("deg", 5e-324, "3.6e-08"), ("rad", 3e-19, "6.3e-10"), ("pi", 1e-170, "2e-10")]
)
def test_angles_without_digits_between_them_are_refused(tmp_path: Path, unit: str, near: float, least: str) -> None:
    """Splines through them were no numbers, or other laws."""
    with pytest.raises(WrongInput, match=rf"p.csv:3:1: motion\.phi1_{unit}\.1: .* at least {least} apart is right"):
        points(tmp_path, f"phi1_{unit},ratio\n0,1\n{near!r},1\n0.5,1\n1,1\n1.5,1\n")
    law = points(tmp_path, f"phi1_{unit},ratio\n0,1\n{1.1 * float(least)!r},1\n0.5,1\n1,1\n1.5,1\n")
    assert len(law.phi1) == 5


def test_a_machine_that_never_turns_is_refused(tmp_path: Path) -> None:
    """Powers and forces divide by the square of the speed."""
    for slow in ("1e-300", "9e-7"):
        error = refusal(
            tmp_path, HEAD.replace("speed_rpm: 60", f"speed_rpm: {slow}") + "motion: {law: uniform_crank}\n"
        )
        assert "operation.speed_rpm" in str(error)
        assert "a number of 1e-06 or over is needed" in str(error)


def test_points_file_that_cannot_be_had_is_a_fault_of_the_design_file(tmp_path: Path) -> None:
    (tmp_path / "p.csv").mkdir()
    error = refusal(tmp_path, f"{HEAD}motion:\n  law: table\n  file: p.csv\n")
    assert str(error) == f"{tmp_path}/d.yaml:6:3: motion.file: {tmp_path}/p.csv is a folder; give a file"


def test_huge_points_file_is_refused_unread(tmp_path: Path) -> None:
    with (tmp_path / "p.csv").open("wb") as file:
        file.truncate(100_000_000)
    error = refusal(tmp_path, f"{HEAD}motion:\n  law: table\n  file: p.csv\n")
    assert "holds 100.0 MB; at most 20 MB is right" in str(error)


def test_points_beside_a_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(WrongInput, match=r"d\.yaml:7:3: motion\.ratio: given beside file; keep one"):
        points(tmp_path, "phi1_deg,ratio\n" + ROWS, more="  ratio: [1]\n")


def descriptions_missing(schema: Any) -> list[str]:
    """Paths of the properties in a JSON Schema that nothing is said about."""
    found = []
    for model, definition in schema["$defs"].items():
        for name, field in definition["properties"].items():
            if "description" not in field:
                found.append(f"{model}.{name}")
    return found


@pytest.mark.slow
def test_json_schema_describes_every_key() -> None:
    schema = json_schema()
    assert schema["title"] == "ncgear design file"
    alone = 0
    for one in schema["anyOf"]:
        kind = schema["$defs"][one["$ref"].removeprefix("#/$defs/")]
        assert set(kind["required"]) | {"linkage"} == {"name", "linkage", "operation", "motion"}
        alone += "linkage" not in kind["required"]
        assert set(kind["properties"]) == set(Design.model_fields)
        assert kind["additionalProperties"] is False
    assert alone == 1
    assert descriptions_missing(schema) == []


@pytest.mark.slow
def test_json_schema_knows_the_laws_and_the_keys_as_written() -> None:
    schema = json_schema()
    for one in schema["anyOf"]:
        kind = schema["$defs"][one["$ref"].removeprefix("#/$defs/")]
        assert set(kind["properties"]["motion"]["discriminator"]["mapping"]) == set(LawName)
    assert {"return", "theta1_pi", "law_speed_rpm"} <= set(schema["$defs"]["ThreeSegmentStroke"]["properties"])
    required = [keys["required"] for name, keys in schema["$defs"].items() if name == "CrankSliderLinkage"]
    assert required == [["rod_mm"]]


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(st.text(alphabet=" \n-:[]{}&*!|>'\"#%,?a1.\t\x00\ufeff\u2028é", max_size=40))
def test_any_text_is_read_or_refused_with_a_place(text: str) -> None:
    try:
        read_yaml(text, "d.yaml")
    except WrongInput as error:
        assert error.location.startswith("d.yaml:")


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["law", "e", "teeth", "x"]), inner),
    max_leaves=6,
)
KEYS = [*Design.model_fields, "zzz"]


@pytest.mark.long
@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(st.dictionaries(st.sampled_from(KEYS), JSON), st.sampled_from(list(LawName)), st.dictionaries(st.text(), JSON))
def test_any_values_are_refused_in_words(
    tmp_path_factory: pytest.TempPathFactory, data: dict[str, Any], law: str, motion: dict[str, Any]
) -> None:
    values = {**data, "motion": data.get("motion", {**motion, "law": law})}
    text = json.dumps(values).replace("NaN", ".nan").replace("Infinity", ".inf")
    error = refusal(tmp_path_factory.getbasetemp(), text)
    assert "d.yaml:1:" in error.location
    assert "Input should" not in str(error)
