"""A mechanism other than the usual one goes all the way through ncgear: a Scotch yoke, of the shortest module.

It is judged by its closed forms: x = r (1 - cos q), x' = r sin q, x'' = r cos q by the crank's angle q, and for forces
by Lagrange's equation with the inertia J + m x'^2.
"""

from __future__ import annotations

import csv
import json
import pickle
from pathlib import Path

import numpy as np
import pytest
from pyarrow import parquet

import ncgear
from at_once import at_once
from commands import Run
from ncgear.design.keys.design import json_schema
from ncgear.design.laws.registry import LawName as Law
from ncgear.design.mechanisms import MECHANISMS
from ncgear.design.reading.design_file import load, parsed
from ncgear.drawings.page.assets import scene_script
from ncgear.drawings.page.data import scene_data
from ncgear.drawings.page.scene_svg import scene_svg
from ncgear.drawings.scene.scene import scene_of
from ncgear.errors import WrongInput
from ncgear.mechanisms.scotch_yoke import BAR as BAR_SHARE
from ncgear.mechanisms.scotch_yoke import ScotchYoke
from ncgear.numerics.arrays import Array
from ncgear.numerics.jet import Jet
from ncgear.project.drive import Drive
from ncgear.screening.single import single_figures
from scenes import in_a_browser
from test_scene_page import hermite, text_of

RADIUS, RPM = 380.0, 20.0
BAR = BAR_SHARE * RADIUS
OMEGA = RPM * np.pi / 30.0
LINKAGE = f"{{kind: scotch_yoke, crank_mm: {RADIUS}}}"
STROKE = """
  law: three_segment_stroke
  solve_for: law_speed
  theta1_pi: 0.4
  theta2_pi: 0.7
  theta3_pi: 1.0
  theta4_pi: 1.3
  v1_mm_s: 1600
  v2_mm_s: 1100
  a1_mm_s2: -1500
  a1_speed_rpm: 20
  return: {basis: ratio, e: 0}
"""
LAWS = {
    "three_segment_stroke": STROKE,
    "ratio_expression": '{law: ratio_expression, ratio: "1 + 0.3*cos(phi)", scale_to_close: true}',
    "harmonic_ratio": "{law: harmonic_ratio, cosine: [0.2, 0.1], sine: [0.05]}",
    "spline_ratio": "{law: spline_ratio, ratio: [1.2, 1.1, 0.9, 0.8, 0.9, 1.1]}",
    "ellipse": "{law: ellipse, eccentricity: 0.3}",
    "table": "{law: table, phi1_deg: [0, 90, 180, 270, 360], displacement_mm: [0, 300, 760, 350, 0]}",
    "pitch_curve": "{law: pitch_curve, ellipse: {semi_major_mm: 3, semi_minor_mm: 2, axis_x_mm: 1}, solve_for: scale}",
    "uniform_crank": "{law: uniform_crank}",
    "in_series": "{law: in_series, pairs: [{law: ellipse, eccentricity: 0.2}, {law: harmonic_ratio, sine: [0.1]}]}",
}
GEARS = "gears: {teeth: 35, module_mm: 2, face_width_mm: 20, driving: {bore_mm: 16}, driven: {bore_mm: 16}}"
RESISTANCE = "resistance: {polynomial_n: [400, 3]}"
SLIDER_KG, CRANK_KG, CRANK_MM, INERTIA = 150.0, 60.0, -100.0, 4e6
MASSES = f"""
masses:
  slider_kg: {SLIDER_KG}
  crank: {{mass_kg: {CRANK_KG}, center_mm: {CRANK_MM}, inertia_kg_mm2: {INERTIA}}}
  driving_gear_kg_mm2: 0
  driven_gear_kg_mm2: 0
  gravity: {{direction_deg: -60}}
"""


def text(law: str, *others: str, linkage: str = LINKAGE) -> str:
    head = f"name: yoke\nlinkage: {linkage}\noperation: {{speed_rpm: {RPM}}}\nmotion: {LAWS[law]}\n"
    return "\n".join([head, RESISTANCE, *others])


def drive(law: str, *others: str, linkage: str = LINKAGE) -> Drive:
    loaded = parsed(text(law, *others, linkage=linkage), Path("yoke.yaml"))
    return Drive(loaded.design, loaded=loaded)


every_law = pytest.mark.parametrize("law", LAWS)


OPEN = {"spiral", "function_generator"}
"""Laws of gears that turn less than once, which move no output to and fro."""


def test_the_laws_are_all_there_are() -> None:
    assert set(LAWS) | OPEN == {law.value for law in Law}


def test_nothing_but_its_module_the_list_and_the_papers_names_the_crank_slider() -> None:
    source = Path(ncgear.__file__).parent
    found = {str(path.relative_to(source)) for path in source.rglob("*.py") if "CrankSlider" in path.read_text("utf-8")}
    elsewhere = {name for name in found if not name.startswith("papers/")}
    assert elsewhere == {"mechanisms/crank_slider.py", "formulas/linkages.py"}


# --- the contract itself


def test_a_constant_crank_moves_the_yoke_harmonically() -> None:
    """Displacement, velocity, acceleration and power of the uniform crank in closed form."""
    made = drive("uniform_crank")
    time = made.motion.phi1_rad / OMEGA
    position = RADIUS * (1.0 - np.cos(OMEGA * time))
    velocity = RADIUS * OMEGA * np.sin(OMEGA * time)
    assert made.motion.displacement == pytest.approx(position, abs=1e-10)
    assert made.motion.velocity == pytest.approx(velocity, abs=1e-10)
    assert made.motion.acceleration == pytest.approx(RADIUS * OMEGA**2 * np.cos(OMEGA * time), abs=1e-9)
    working = made.motion.phi1_rad < np.pi
    assert made.motion.power_w == pytest.approx(np.where(working, (400.0 + 3.0 * position) * velocity / 1000.0, 0.0))
    assert made.check.peak_speed.value == pytest.approx(RADIUS * OMEGA, rel=1e-12)
    assert made.check.peak_acceleration_cycle.value == pytest.approx(RADIUS * OMEGA**2, rel=1e-12)
    work_j = (400.0 * 760.0 + 1.5 * 760.0**2) / 1000.0
    assert made.check.mean_power_w == pytest.approx(work_j * OMEGA / (2.0 * np.pi), rel=1e-12)


@every_law
def test_every_law_closes_and_moves_the_yoke_as_its_crank_turns(law: str) -> None:
    made = drive(law)
    driven = made.transmission.driven_angle(np.linspace(0.0, 2.0 * np.pi, 500), 2)
    q, speed, change = (driven.derivative(order) for order in range(3))
    assert q[-1] == pytest.approx(2.0 * np.pi, abs=1e-9)
    motion = made.machine.motion(np.linspace(0.0, 2.0 * np.pi, 500))
    assert motion.displacement == pytest.approx(RADIUS * (1.0 - np.cos(q)), abs=1e-9)
    assert motion.velocity == pytest.approx(RADIUS * np.sin(q) * speed * OMEGA, abs=1e-8)
    expected = RADIUS * (np.cos(q) * speed**2 + np.sin(q) * change) * OMEGA**2
    assert motion.acceleration == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


@pytest.mark.slow
def test_a_stroke_turns_the_crank_as_its_displacement_asks() -> None:
    """x is the law's, whatever mechanism makes it, so that cos q = 1 - x/r; the segment of pressing is straight."""
    made, slider = drive("three_segment_stroke"), drive("three_segment_stroke", linkage="{crank_mm: 380, rod_mm: 960}")
    phi1 = np.linspace(0.0, 1.3 * np.pi, 400)
    position = slider.machine.motion(phi1).displacement
    q = made.transmission.driven_angle(phi1).value
    assert np.cos(q) == pytest.approx(1.0 - position / RADIUS, abs=1e-12)
    pressing = made.machine.motion(np.linspace(0.7, 1.0, 50) * np.pi).displacement
    assert np.diff(pressing, 2) == pytest.approx(0.0, abs=1e-10)
    assert made.check.peak_power_w.value == pytest.approx(slider.check.peak_power_w.value, rel=1e-9)


def test_a_stroke_that_is_solved_for_gives_the_radius() -> None:
    motion = LAWS["three_segment_stroke"].replace("solve_for: law_speed", "solve_for: stroke\n  law_speed_rpm: 50")
    head = "name: yoke\nlinkage: {kind: scotch_yoke}\noperation: {speed_rpm: 20}\n"
    found = Drive(parsed(f"{head}motion: {motion}", Path("yoke.yaml")).design)
    linkage = found.linkage
    assert isinstance(linkage, ScotchYoke)
    assert 2.0 * linkage.crank_mm == pytest.approx(found.machine.displacement(np.array([1.3 * np.pi]), 0).value[0])


def test_many_yokes_are_as_each_by_itself() -> None:
    radii, angle = np.array([1.0, 30.0, 380.0]), Jet.variable([0.3, 2.0, 5.0], 2)
    found = ScotchYoke.many(crank_mm=radii).displacement(angle).coefficients
    each = [ScotchYoke(radius).displacement(Jet(angle.coefficients[:, [i]])) for i, radius in enumerate(radii)]
    assert found == pytest.approx(np.hstack([one.coefficients for one in each]), rel=1e-15)


# --- the design file


@pytest.mark.slow
def test_every_kind_is_in_the_schema() -> None:
    assert set(MECHANISMS) <= set(json.dumps(json_schema()).replace('"', " ").split())


@pytest.mark.parametrize(
    "linkage", ["{crank_mm: 380, rod_mm: 960}", "{kind: crank_slider, crank_mm: 380, rod_mm: 960}"]
)
def test_the_crank_slider_stays_the_usual_one(linkage: str) -> None:
    found = drive("ellipse", linkage=linkage)
    assert type(found.linkage).__name__ == "CrankSlider"


@at_once(
    ("linkage", "key", "said"),
    [
        ("{kind: scotch_yok, crank_mm: 380}", "linkage.kind", "crank_slider, scotch_yoke"),
        (
            "{kind: scotch_yoke}",
            "linkage.crank_mm",
            "missing; give it (length of the crank in mm; may be left out only",
        ),
        ("{kind: scotch_yoke, crank_mm: 380, rod_mm: 900}", "linkage.rod_mm", "unknown key"),
        ("{kind: crank_slider, coupler_mm: 380}", "linkage.coupler_mm", "unknown key"),
    ],
)
def test_wrong_keys_are_refused_at_their_place(linkage: str, key: str, said: str) -> None:
    with pytest.raises(WrongInput) as caught:
        drive("ellipse", linkage=linkage)
    assert "yoke.yaml:2:" in str(caught.value)
    assert key in str(caught.value)
    assert said in str(caught.value)


@every_law
def test_a_design_can_be_sent_to_another_process(law: str) -> None:
    made = drive(law, GEARS, MASSES).design
    assert pickle.loads(pickle.dumps(made)) == made


@pytest.mark.slow
def test_keys_of_both_mechanisms_are_explained(run: Run) -> None:
    for key in ("linkage.crank_mm", "linkage.rod_mm", "linkage.kind", "masses.rod"):
        assert run("explain", key)[0] == 0


def test_another_stroke_than_the_yokes_is_refused_by_its_own_key() -> None:
    motion = LAWS["three_segment_stroke"].replace("v1_mm_s", "stroke_mm: 700\n  v1_mm_s")
    head = f"name: yoke\nlinkage: {LINKAGE}\noperation: {{speed_rpm: 20}}\n"
    with pytest.raises(WrongInput, match=r"change linkage\.crank_mm"):
        _ = Drive(parsed(f"{head}motion: {motion}", Path("yoke.yaml")).design).law


# --- forces


@pytest.mark.slow
@every_law
def test_torque_is_lagranges(law: str) -> None:
    """(J + m x'^2) q.. + m x' x'' q.^2 + F x' less the weights' moment, all by the crank's angle."""
    made = drive(law, MASSES)
    phi1 = np.linspace(0.01, 6.27, 300)
    driven = made.transmission.driven_angle(phi1, 2)
    q, speed, turning = driven.value, driven.derivative(1) * OMEGA, driven.derivative(2) * OMEGA**2
    slope, bend = RADIUS * np.sin(q), RADIUS * np.cos(q)
    inertia = (INERTIA + SLIDER_KG * slope**2) * turning + SLIDER_KG * slope * bend * speed**2
    force = np.where(q < np.pi, 400.0 + 3.0 * RADIUS * (1.0 - np.cos(q)), 0.0)
    along, across = 9.80665 * np.cos(np.radians(-60.0)), 9.80665 * np.sin(np.radians(-60.0))
    # The pin stands at pi - q: d/dq (cos, sin)(pi - q) = (sin q, -(-cos q)) = (sin(pi - q), -cos(pi - q))
    weight = SLIDER_KG * along * slope + CRANK_KG * CRANK_MM * (along * np.sin(q) + across * np.cos(q))
    expected = inertia / 1000.0 + force * slope - weight
    found = made.rigid.machine.at(phi1)
    assert found.driven_torque.value == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())
    assert found.driving_torque.value == pytest.approx(
        expected * driven.derivative(1), abs=1e-9 * np.abs(expected).max()
    )
    pin = SLIDER_KG * (slope * turning + bend * speed**2) / 1000.0 - SLIDER_KG * along + force
    assert found.joints["pin"].x.value == pytest.approx(pin, abs=1e-10 * np.abs(pin).max())
    assert found.guide.value == pytest.approx(-SLIDER_KG * across * np.ones_like(q))


@pytest.mark.slow
@every_law
def test_the_drives_work_of_a_cycle_is_that_of_the_resistance(law: str) -> None:
    made = drive(law, MASSES)
    assert made.rigid.fluctuation.work_n_mm == pytest.approx(400.0 * 760.0 + 1.5 * 760.0**2, rel=1e-9)


def test_masses_of_a_yoke_have_no_rod() -> None:
    with pytest.raises(WrongInput, match="rod: unknown key"):
        drive("ellipse", MASSES.replace("  crank:", "  rod: {mass_kg: 1, center_mm: 0, inertia_kg_mm2: 0}\n  crank:"))
    with pytest.raises(WrongInput, match="forces need slider_kg and crank"):
        _ = drive("ellipse").rigid


def test_balance_is_refused_of_what_has_no_rod(run: Run) -> None:
    Path("yoke.yaml").write_text(text("ellipse", MASSES), encoding="utf-8")
    Path("b.yaml").write_text(
        "name: b\nspeed_rpm: 20\nmechanisms: [{name: one, design: yoke.yaml}]\n", encoding="utf-8"
    )
    status, _, err = run("balance", "b.yaml")
    assert status == 2
    assert "a Scotch yoke, and balance is computed only where one rod moves the slider" in err


# --- pictures

ANGLES = np.array([0.001, 0.5, 1.7, 3.0, 4.4, 6.0, 7.9, -2.2])


def places(q: Array) -> dict[str, tuple[Array, Array, Array]]:
    """x, y and angle of every link in closed form."""
    still, advance = 0.0 * q, RADIUS * (1.0 - np.cos(q))
    return {
        "slider": (BAR - RADIUS + advance, still, still),
        "crank": (still, still, np.pi - q),
        "block": (-RADIUS * np.cos(q), RADIUS * np.sin(q), still),
    }


@pytest.mark.parametrize("law", ["ellipse", "three_segment_stroke"])
def test_the_scene_puts_every_link_where_the_crank_has_it(law: str) -> None:
    scene = scene_of(drive(law))
    poses = scene.poses(ANGLES)
    assert [body.name for body in scene.links] == ["slider", "crank", "block"]
    for name, (x, y, angle) in places(scene.machine.transmission.driven_angle(ANGLES).value).items():
        found = poses.places[name]
        assert found.origin_mm == pytest.approx(np.stack([x, y], -1), abs=1e-10)
        assert found.angle_rad == pytest.approx(angle, abs=1e-12)
    slot = scene.links[0].contours_mm[0]
    assert slot[:, 0].min() < -BAR < slot[:, 0].max()
    assert np.abs(slot[:, 1]).max() >= 1.2 * RADIUS


@pytest.mark.slow
def test_the_page_is_told_the_places_as_tables() -> None:
    data = scene_data(scene_of(drive("ellipse")))["linkage"]
    q = np.random.default_rng(3).uniform(-7.0, 13.0, 5000)
    for name, expected in places(q).items():
        for key, values in zip(("x", "y", "angle"), expected, strict=True):
            assert hermite(data["links"][name][key], q) == pytest.approx(values, abs=2e-7 * RADIUS)
    assert data["pins"] == {"crank-pin": "block"}


SCRIPT = """<!doctype html><div>{svg}</div><script>{script}
const scene = createScene(document.querySelector("svg"), {data});
const names = ["slider", "crank", "block", "crank-pin"];
const found = {angles}.map((phi1) => {{
  scene.show(phi1);
  return {{ driven: scene.driven_angle(phi1), places: names.map((name) => scene.place(name, phi1)) }};
}});
document.body.innerHTML = ""; document.body.textContent = JSON.stringify(found);</script>"""


@in_a_browser
@pytest.mark.slow
def test_the_page_moves_the_yoke() -> None:
    scene = scene_of(drive("ellipse"))
    page = SCRIPT.format(
        svg=scene_svg(scene), script=scene_script(), data=json.dumps(scene_data(scene)), angles=ANGLES.tolist()
    )
    q = scene.machine.transmission.driven_angle(ANGLES).value
    for row, told in enumerate(json.loads(text_of(page))):
        assert told["driven"] == pytest.approx(q[row], abs=1e-6)
        slider, crank, block, pin = told["places"]
        for place, (x, y, angle) in zip((slider, crank, block), places(q).values(), strict=True):
            assert [place["x"], place["y"]] == pytest.approx([x[row], y[row]], abs=1e-6 * RADIUS)
            assert np.sin((place["angle"] - angle[row]) / 2.0) == pytest.approx(0.0, abs=5e-7)
        assert (pin["x"], pin["y"]) == (block["x"], block["y"])


# --- commands


@pytest.mark.long
@pytest.mark.slow
def test_check_simulate_and_report_run(run: Run) -> None:
    Path("d.yaml").write_text(text("three_segment_stroke", GEARS, MASSES), encoding="utf-8")
    status, out, err = run("check", "d.yaml", "--verbose")
    assert (status, err) == (0, "")
    assert "stroke                                            760 mm" in out
    status, out, _ = run("simulate", "d.yaml", "--level", "rigid", "--out", "forces", "--verbose")
    assert status == 0
    assert "peak crank pin force" in out
    assert "wrist" not in out
    with Path("forces/simulation.csv").open(encoding="utf-8", newline="") as file:
        columns = next(csv.reader(file))
    assert {"pin_x_n", "crank_bearing_x_n", "guide_n"} <= set(columns)
    assert "rod_kg" not in Path("forces/simulation.json").read_text(encoding="utf-8")
    status, _, err = run("report", "d.yaml", "--out", "page")
    assert (status, err) == (0, "")
    page = Path("page/report.html").read_text(encoding="utf-8")
    assert 'id="scene-block"' in page
    assert 'id="scene-rod"' not in page


@pytest.mark.slow
@pytest.mark.parametrize("law", ["three_segment_stroke", "harmonic_ratio"])
def test_a_sweep_is_as_each_design_by_itself(run: Run, law: str) -> None:
    Path("d.yaml").write_text(text(law), encoding="utf-8")
    status, out, _ = run("sweep", "d.yaml", "--vary", "linkage.crank_mm=370:390:3", "--out", "s")
    assert status == 0
    assert out.startswith("3 designs, of which 3 can be made\n")
    for row in parquet.read_table("s/sweep.parquet").to_pylist():
        own = drive(law, linkage=f"{{kind: scotch_yoke, crank_mm: {row['linkage.crank_mm']}}}")
        figures = single_figures(own.design)
        assert {name: row[name] for name in figures} == pytest.approx(figures, rel=1e-7, abs=1e-9)


@pytest.mark.slow
def test_the_optimum_is_bounded_by_full_push_and_full_pull(run: Run) -> None:
    """Half the way at +a, the other half at -a: H = a (T/2)^2 / 4, so that no law has less than 16 H / T^2."""
    pytest.importorskip("casadi")
    asked = "optimize: {goal: least_acceleration, knots: 36, limits: {ratio_min: 0.05, ratio_max: 20}}"
    Path("d.yaml").write_text(text("uniform_crank", asked), encoding="utf-8")
    status, _, err = run("optimize", "d.yaml", "--out", "o")
    assert (status, err) == (0, "")
    certificate = json.loads(Path("o/certificate.json").read_text(encoding="utf-8"))
    least = 16.0 * 760.0 / (60.0 / RPM) ** 2
    # Convex curves take a little more than full push and full pull
    assert least * (1.0 - 1e-3) <= certificate["goal"]["limit"] <= 1.01 * least
    written = Drive(load(Path("o/yoke-optimized.yaml")).design)
    assert isinstance(written.linkage, ScotchYoke)
    assert certificate["goal"]["limit"] <= written.check.peak_acceleration_cycle.value <= 1.1 * least
