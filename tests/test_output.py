"""The output side: exact tables, files that arrive together or not at all, readable reports, pictures that show."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Callable
from hashlib import sha256
from io import BytesIO
from math import pi
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image, ImageColor

from at_once import at_once
from commands import Run
from disk import leftovers
from drives import drive, drive_of_text
from killed_runs import seen
from ncgear.drawings.charts.chart import EMPTY, LOAD, MOTION, ChartLine, Role, motion_chart, over_displacement
from ncgear.drawings.charts.drawer import MOTION_COLUMN, MOTION_LOOK, beside_png, column_png, mark_extreme
from ncgear.drawings.plots import assembled_pair as gears
from ncgear.drawings.plots.canvas import DRIVEN, DRIVING, HIGHLIGHT
from ncgear.errors import NoSuchMechanism, Unanswered, WrongInput
from ncgear.figures.numbers import json_text, shown
from ncgear.figures.summary.build_summary import pitch_summary
from ncgear.figures.summary.check_summary import MIXED_SPEEDS, SAME_SPEED
from ncgear.figures.tables import WIDTH, cell_text, law_csv, outline_csv, rows_text
from ncgear.figures.terminal import figures_text, timing_text
from ncgear.files.build import build
from ncgear.files.manifest import MANIFEST, publish_run
from ncgear.files.publish import STAGING_PREFIX, prepare
from ncgear.files.sweep_run import TABLE
from ncgear.files.workshop.formats import Format
from ncgear.kinematics.motion import OutputMotion
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.mechanisms.mechanism import Output
from ncgear.numerics.units import label_and_unit
from ncgear.pitch.shape import Gear
from ncgear.project.frontier_run import POINTS_FILE
from plane import wave_ring
from tiers import long_but

FILES = {"a.txt": b"first", "b.txt": b"second", "summary.json": b"{}"}


def motion(rows: int = 2001, amplitude: float = 1.0) -> OutputMotion:
    """A made-up motion of realistic size, 20 r/min."""
    phi = np.linspace(0.0, 2.0 * pi, rows)
    speed = 2.0 * pi / 3.0
    displacement = 380.0 * (1.0 - np.cos(phi)) + 20.0 * amplitude * np.sin(phi) ** 2
    velocity = speed * (380.0 * np.sin(phi) + 20.0 * amplitude * np.sin(2.0 * phi))
    force = np.where(velocity > 0.0, 1e-9 * displacement**4, 0.0)
    return OutputMotion(
        linkage=CRANK_SLIDER,
        phi1_rad=phi,
        phi2_rad=phi - 0.1 * amplitude * np.sin(phi),
        ratio=1.0 / (1.0 - 0.1 * amplitude * np.cos(phi)),
        displacement=displacement,
        velocity=velocity,
        acceleration=speed**2 * (380.0 * np.cos(phi) + 40.0 * amplitude * np.cos(2.0 * phi)),
        load=force,
        power_w=force * velocity / 1e3,
    )


# --- tables


def read(text: str) -> tuple[str, np.ndarray]:
    header, *lines = text.removesuffix("\n").split("\n")
    return header, np.array([[float(cell) for cell in line.split(",")] for line in lines])


def test_law_table_reads_back_exactly() -> None:
    table = motion()
    header, values = read(law_csv(table, Output("slider")))
    assert header == ("phi1_rad,phi2_rad,ratio,displacement_mm,velocity_mm_s,acceleration_mm_s2,force_n,power_w")
    np.testing.assert_array_equal(values, np.column_stack(list(vars(table).values())[1:9]))


def test_outline_table_reads_back_exactly() -> None:
    outline = np.random.default_rng(1).normal(size=(500, 2)) * 10.0 ** np.arange(-150, 350, 1)[:, None].clip(-150, 150)
    header, values = read(outline_csv(outline))
    assert header == "x_mm,y_mm"
    np.testing.assert_array_equal(values, outline)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_tables_hold_finite_numbers_only(bad: float) -> None:
    with pytest.raises(ValueError, match="y_mm"):
        outline_csv(np.array([[0.0, 1.0], [2.0, bad]]))


# --- publishing


def contents(folder: Path) -> dict[str, bytes]:
    """What is in a folder but for the manifest."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name != MANIFEST}


def test_publish_creates_the_folder_and_writes_every_file(tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "down"
    assert publish_run(folder, FILES, "build").paths == [folder / name for name in (*FILES, MANIFEST)]
    assert contents(folder) == FILES


def test_publish_replaces_earlier_files_and_leaves_others(tmp_path: Path) -> None:
    publish_run(tmp_path, {"a.txt": b"old"}, "build")
    (tmp_path / "mine.txt").write_bytes(b"keep")
    publish_run(tmp_path, FILES, "build")
    assert contents(tmp_path) == {**FILES, "mine.txt": b"keep"}


@pytest.mark.parametrize("action", ["write", "symlink", "replace"])
@pytest.mark.parametrize("fault", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_failure_in_the_middle_leaves_the_last_good_build(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, action: str, fault: BaseException
) -> None:
    old = {"a.txt": b"old first", "summary.json": b"old"}
    publish_run(tmp_path, old, "build")
    real, calls = getattr(os, action), []

    def failing(*arguments: Any, **named: Any) -> Any:
        calls.append(arguments)
        if len(calls) == 3:
            raise fault
        return real(*arguments, **named)

    monkeypatch.setattr(os, action, failing)
    with pytest.raises((WrongInput, KeyboardInterrupt)):
        publish_run(tmp_path, FILES, "build")
    monkeypatch.undo()
    assert contents(tmp_path) == old
    # The negative control: without the fault the same call does change the folder.
    publish_run(tmp_path, FILES, "build")
    assert contents(tmp_path) == FILES


def without_links(*_: Any, **__: Any) -> None:
    raise OSError(95, "Operation not supported")


def test_without_symbolic_links_files_are_moved_one_by_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Path, "symlink_to", without_links)
    publish_run(tmp_path, {"a.txt": b"old", "gone.txt": b"old"}, "build")
    (tmp_path / "mine.txt").write_bytes(b"keep")
    publish_run(tmp_path, FILES, "build")
    assert contents(tmp_path) == {**FILES, "mine.txt": b"keep"}


def test_without_symbolic_links_a_failure_leaves_the_last_good_build(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = {"a.txt": b"old first", "summary.json": b"old"}
    publish_run(tmp_path, old, "build")
    monkeypatch.setattr(Path, "symlink_to", without_links)
    real = Path.replace

    def failing(self: Path, target: Path) -> Path:
        if target.name == "summary.json" and self.parent.name == "new":
            raise PermissionError(13, "open in another program", str(target))
        return real(self, target)

    monkeypatch.setattr(Path, "replace", failing)
    with pytest.raises(WrongInput, match="open in another program"):
        publish_run(tmp_path, FILES, "build")
    assert contents(tmp_path) == old


def test_failure_because_a_folder_is_in_the_way_of_a_file(tmp_path: Path) -> None:
    publish_run(tmp_path, {"a.txt": b"old"}, "build")
    (tmp_path / "b.txt").mkdir()
    with pytest.raises(WrongInput, match="cannot be written"):
        publish_run(tmp_path, FILES, "build")
    assert (tmp_path / "a.txt").read_bytes() == b"old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.txt", "b.txt", MANIFEST]


def test_hidden_folders_of_others_stay(tmp_path: Path) -> None:
    """A name like that of a staging folder is not enough, with and without files."""
    others = [f"{STAGING_PREFIX}mine", f"{STAGING_PREFIX}0123456789ab-0123456789ab", f"{STAGING_PREFIX}abcdefgh"]
    for name in others:
        (tmp_path / name / "new").mkdir(parents=True)
        (tmp_path / name / "new" / "a.txt").write_bytes(b"precious")
    (tmp_path / f"{STAGING_PREFIX}empty").mkdir()
    publish_run(tmp_path, FILES, "build")
    assert {name: (tmp_path / name).read_bytes() for name in FILES} == FILES
    assert [(tmp_path / name / "new" / "a.txt").read_bytes() for name in others] == [b"precious"] * 3
    assert (tmp_path / f"{STAGING_PREFIX}empty").is_dir()


# --- the manifest


STAGED = {"stage-1/law.csv": b"1, 2", "stage-2/law.csv": b"3, 4", "pair.step": b"ISO-10303-21", "rack.txt": b"old"}


def test_a_run_takes_away_only_what_the_manifest_says_and_nobody_changed(tmp_path: Path) -> None:
    publish_run(tmp_path, STAGED, "build")
    publish_run(tmp_path, {"page.html": b"of another command"}, "report")
    (tmp_path / "pair.step").write_bytes(b"changed in another program")
    (tmp_path / "stage-2" / "photo.png").write_bytes(b"mine")
    run = publish_run(tmp_path, FILES, "build")
    assert (run.paths, run.kept) == ([tmp_path / name for name in (*FILES, MANIFEST)], [])
    left = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert left == {*FILES, MANIFEST, "page.html", "pair.step", "stage-2/photo.png"}
    assert (tmp_path / "pair.step").read_bytes() == b"changed in another program"
    assert not (tmp_path / "stage-1").exists()
    named = json.loads((tmp_path / MANIFEST).read_bytes())["files"]
    assert {name: entry["command"] for name, entry in named.items()} == {
        **dict.fromkeys(FILES, "build"),
        "page.html": "report",
    }
    for name, entry in named.items():
        assert sha256((tmp_path / name).read_bytes()).hexdigest() == entry["sha256"]


def test_files_of_others_in_the_places_of_new_ones_are_kept_beside_them(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_bytes(b"mine")
    (tmp_path / "b.txt").write_bytes(FILES["b.txt"])
    assert publish_run(tmp_path, FILES, "build").kept == [tmp_path / "a-kept.txt"]
    assert publish_run(tmp_path, FILES, "build").kept == []
    (tmp_path / "a.txt").write_bytes(b"mine again")
    assert publish_run(tmp_path, {**FILES, "b.txt": b"other"}, "build").kept == [tmp_path / "a-kept-2.txt"]
    kept = {"a-kept.txt": b"mine", "a-kept-2.txt": b"mine again"}
    assert contents(tmp_path) == {**FILES, "b.txt": b"other", **kept}
    assert not set(kept) & set(json.loads((tmp_path / MANIFEST).read_bytes())["files"])


@pytest.mark.parametrize(
    "text",
    [
        b"",
        b"[]",
        b"{",
        b"\xff",
        b'{"files": {"rack.txt": "mine"}}',
        b'{"name": "a page", "icons": []}',
        b"[" * 100_000,
        b'{"ncgear": "1", "files": {"../rack.txt": {"command": "build", "sha256": "DIGEST"}}}',
        b'{"ncgear": "1", "files": {"below/rack.txt/": {"command": "build", "sha256": "DIGEST"}}}',
        b'{"ncgear": "1", "files": {"rack.txt": {"command": "build", "sha256": "DIGEST", "more": 1}}}',
    ],
    ids=lambda text: text[:60].decode("latin-1"),
)
def test_a_manifest_that_is_none_takes_nothing_away(tmp_path: Path, text: bytes) -> None:
    """Not out of the folder either, whatever it names."""
    folder = tmp_path / "out"
    folder.mkdir()
    text = text.replace(b"DIGEST", sha256(b"mine").hexdigest().encode())
    for place in (tmp_path / "rack.txt", folder / "rack.txt"):
        place.write_bytes(b"mine")
    (folder / MANIFEST).write_bytes(text)
    assert publish_run(folder, FILES, "build").kept == [folder / "manifest-kept.json"]
    assert (folder / "manifest-kept.json").read_bytes() == text
    assert [place.read_bytes() for place in (tmp_path / "rack.txt", folder / "rack.txt")] == [b"mine", b"mine"]


def pipe(place: Path) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("this system has no pipes with a name")
    os.mkfifo(place)


def link_to_nothing(place: Path) -> None:
    place.symlink_to("nowhere")


def link_to_itself(place: Path) -> None:
    place.symlink_to(place.name)


@pytest.mark.parametrize("make", [Path.mkdir, pipe, link_to_nothing, link_to_itself])
@pytest.mark.parametrize("name", ["b.txt", MANIFEST])
def test_what_is_no_file_is_neither_replaced_nor_waited_for(
    tmp_path: Path, name: str, make: Callable[[Path], None]
) -> None:
    (tmp_path / "a.txt").write_bytes(b"mine")
    make(tmp_path / name)
    with pytest.raises(WrongInput, match="cannot be written") as caught:
        publish_run(tmp_path, FILES, "build")
    assert caught.value.location == str(tmp_path / name)
    assert sorted(os.listdir(tmp_path)) == sorted(["a.txt", name])
    assert (tmp_path / "a.txt").read_bytes() == b"mine"


EVERY_COMMAND = {
    "report": "report pump.yaml --out OUT",
    "animate": "animate pump.yaml --out OUT/film.gif --frames 2 --width 320",
    "rigid": "simulate pump.yaml --verbose --out OUT",
    "balance": "balance machine.yaml --verbose --out OUT",
    "sweep": "sweep pump.yaml --vary operation.speed_rpm=40:50:2 --verbose --out OUT",
    "optimize": "optimize pump.yaml --verbose --out OUT",
    "reproduce": "reproduce --out OUT",
}


LOADED = """
resistance: {expression_n: 200 + x}
masses:
  slider_kg: 3
  rod: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}
  crank: {mass_kg: 0, center_mm: 0, inertia_kg_mm2: 0}
optimize: {knots: 12}
"""


@pytest.mark.tiers(slow=["rigid"], rest="long")
@pytest.mark.parametrize(
    "command", long_but([command for command in EVERY_COMMAND if command != "optimize"], EVERY_COMMAND)
)
def test_no_command_loses_a_file_of_others(tmp_path: Path, command: str, run: Run) -> None:
    Path("pump.yaml").write_text(DESIGN + LOADED)
    Path("machine.yaml").write_text("name: machine\nspeed_rpm: 60\nmechanisms: [{name: pump, design: pump.yaml}]\n")
    out = tmp_path / "out"

    def done() -> str:
        status, said, complaint = run(*EVERY_COMMAND[command].replace("OUT", str(out)).split())
        assert status == 0, complaint
        return said

    assert "Kept" not in done()
    # Finished points and parts are gone on with, or refused; test_frontier.py and test_sweeping.py judge that.
    kept = MANIFEST, POINTS_FILE, f"{TABLE}/"
    names = [name for name in seen(out) if not name.startswith(kept)]
    assert names
    shutil.rmtree(out)
    others = {name: b"of others: " + name.encode() for name in [*names, "notes.txt", "below/notes.txt"]}
    for name, content in others.items():
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_bytes(content)
    said = done()
    assert set(others.values()) <= set(seen(out).values())
    assert all(str(place) in said for place in out.rglob("*-kept.*"))
    # Made anew, nothing more is kept.
    assert "Kept" not in done()
    assert set(others.values()) <= set(seen(out).values())
    assert leftovers(out) == []


def test_results_of_one_folder_stay_beside_each_other(tmp_path: Path) -> None:
    publish_run(tmp_path, {"a.gif": b"a"}, "animate a.gif")
    publish_run(tmp_path, {"b.gif": b"b"}, "animate b.gif")
    publish_run(tmp_path, {"a-optimized.yaml": b"a", "certificate.json": b"a"}, "optimize a-optimized")
    run = publish_run(tmp_path, {"b-optimized.yaml": b"b", "certificate.json": b"b"}, "optimize b-optimized")
    assert run.kept == []
    stay = {"a.gif": b"a", "b.gif": b"b", "a-optimized.yaml": b"a"}
    assert contents(tmp_path) == {**stay, "b-optimized.yaml": b"b", "certificate.json": b"b"}


def test_a_link_of_others_is_kept_by_what_it_shows(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").write_bytes(b"precious")
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "a.txt").symlink_to(tmp_path / "elsewhere")
    assert publish_run(folder, FILES, "build").kept == [folder / "a-kept.txt"]
    assert contents(folder) == {**FILES, "a-kept.txt": b"precious"}
    assert (tmp_path / "elsewhere").read_bytes() == b"precious"


def test_folder_that_is_a_file_is_refused(tmp_path: Path) -> None:
    place = tmp_path / "out"
    place.write_bytes(b"precious")
    for folder in (place, place / "below"):
        for refuse in (prepare, lambda target: publish_run(target, FILES, "build")):
            with pytest.raises(WrongInput, match="--out") as caught:
                refuse(folder)
            assert caught.value.location == str(place)
    assert place.read_bytes() == b"precious"


def test_folder_that_cannot_be_written_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Root may write everywhere, so the system's answer is simulated.
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(WrongInput, match="cannot be written"):
        prepare(tmp_path / "new")


def test_prepare_creates_nothing(tmp_path: Path) -> None:
    prepare(tmp_path / "deep" / "down")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["", ".", "..", "../a", "a/../b", "a/b/c", "a\\b", "/a", "a\0", f"{STAGING_PREFIX}x"])
def test_names_that_would_escape_are_refused_before_anything_is_written(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match="plain"):
        publish_run(tmp_path / "out", {"a.txt": b"", name: b""}, "build")
    assert not list(tmp_path.iterdir())


# --- reports


ROW = {
    "peak_power_w": 6315.1,
    "mean_power_w": 1043.4,
    "peak_acceleration_cycle_mm_s2": 7341.1,
    "peak_speed_mm_s": 1874.1,
}
SUMMARY: dict[str, Any] = {
    "design": {"name": "baler"},
    "ratio": {"min": 0.44058, "max": 2.0545, "min_at_rad": pi, "max_at_rad": 0.5},
    "teeth": {"undercut_driving": [1, 2, 3, 7], "undercut_driven": [], "module_mm": 3.0},
    "pitch": {
        "driving_convex": False,
        "min_concave_radius_driven_mm": None,
        "concave_driving_rad": [[0.0, 0.1], [2.0, 3.0]],
    },
    "comparison": [
        {"name": "this design", "speed_rpm": 20.0, **ROW, "same_speed": True, "note": ""},
        {
            "name": "quoted elsewhere",
            "speed_rpm": 60.0,
            **ROW,
            "mean_power_w": None,
            "same_speed": False,
            "note": "so ",
        },
        {"name": "a mechanism " * 9, "speed_rpm": 20.0, **ROW, "same_speed": True, "note": "a note " * 30},
    ],
    "warnings": ["something to know " * 12, "short"],
    "timing_s": {"teeth": 0.1},
}


def test_rows_at_other_speeds_are_set_apart() -> None:
    text = figures_text(SUMMARY)
    same, mixed = text.split(MIXED_SPEEDS)
    assert SAME_SPEED in same
    assert "this design" in same
    assert "a mechanism" in same
    assert "quoted elsewhere" not in same
    assert "quoted elsewhere" in mixed
    assert "this design" not in mixed


def test_no_heading_without_rows_at_other_speeds() -> None:
    rows = [row for row in SUMMARY["comparison"] if row["same_speed"]]
    assert MIXED_SPEEDS not in figures_text({**SUMMARY, "comparison": rows})
    assert SAME_SPEED not in figures_text({**SUMMARY, "comparison": []})


def test_report_is_aligned_and_not_too_wide() -> None:
    lines = figures_text(SUMMARY).split("\n")
    assert max(map(len, lines)) <= WIDTH
    rows = [line for line in lines if line.endswith("1874.1")]
    assert len(rows) == 3
    assert len({len(line) for line in rows if "quoted" not in line}) == 1
    assert sum(line.startswith("warning: ") for line in lines) == 2


@at_once(
    "line",
    [
        "min                         0.44058 at phi1 = 180 deg",
        "undercut driving            1-3, 7",
        "undercut driven             none",
        "module                      3 mm",
        "driving convex              no",
        "min concave radius driven   -",
        "concave driving             0..5.7296, 114.59..171.89 deg",
    ],
)
def test_values_are_shown_as_a_person_reads_them(line: str) -> None:
    assert " ".join(line.split()) in [" ".join(shown_line.split()) for shown_line in figures_text(SUMMARY).split("\n")]


def test_numbers_and_units() -> None:
    assert label_and_unit("peak_acceleration_cycle_mm_s2") == ("peak acceleration cycle", "mm/s2")
    assert label_and_unit("volume_mm3") == ("volume", "mm3")
    assert label_and_unit("teeth") == ("teeth", "")
    assert [shown(value) for value in (123456.7, 12345.6, 1.5e-15, 0.0, True, None)] == [
        "123457", "12346", "0", "0", "yes", "-",
    ]  # fmt: skip
    assert shown(list(np.arange(20.0))).endswith("and 8 more")


@pytest.mark.parametrize(("force", "said"), [(0.0, "zero throughout"), (2.0, "2 kN at 0\u00b0")])
def test_a_curve_without_values_says_so(force: float, said: str) -> None:
    axes = Figure().subplots()
    mark_extreme(axes, ChartLine(Role.OWN, "this design", np.linspace(0.0, 360.0, 5), np.full(5, force)), "kN")
    assert [text.get_text() for text in axes.texts] == [said]


@pytest.mark.tiers(thorough=["internal*"], rest="quick")
@pytest.mark.parametrize(
    ("name", "angles_pi"), [("ellipse", []), ("internal-1-2", []), ("pusher", [0.0, 0.5, 1.0, 1.3])]
)
def test_curvature_jumps_are_counted_only_where_it_jumps(name: str, angles_pi: list[float]) -> None:
    """A smooth law's seam is no jump; a law in segments jumps at its joints."""
    jumps = pitch_summary(drive(name))["curvature_jumps"]
    assert [jump["phi1_rad"] / pi for jump in jumps] == pytest.approx(angles_pi)


def test_timing_adds_up() -> None:
    drive: Any = SimpleNamespace(timing_s={"teeth": 0.25, "pitch curves": 0.5}, of="", by_stage=())
    assert timing_text(drive).split("\n")[-1].split() == ["sum", "0.750"]


# --- pictures


def wavy(radius: float, phase: float) -> np.ndarray:
    return wave_ring(radius, 2.0, 40, 4000, phase)


def shades(png: bytes) -> np.ndarray:
    """The picture as RGB, shape (height, width, 3)."""
    image = Image.open(BytesIO(png))
    assert image.format == "PNG"
    return np.asarray(image.convert("RGB"), dtype=float)


def near(pixels: np.ndarray, color: str) -> int:
    """Number of pixels of about that colour."""
    return int(np.sum(np.abs(pixels - np.array(ImageColor.getrgb(color))).max(axis=2) < 25))


@pytest.mark.slow
def test_pitch_curves_show_both_gears_and_concave_stretches_only_where_there_are_any() -> None:
    driving, driven = wavy(50.0, 0.0), wavy(50.0, pi)
    pair = gears.Assembled(driving, driven, 100.0)
    none, some = np.zeros(4000, dtype=bool), np.arange(4000) < 1000
    plain = shades(gears.pitch_curves_png(pair, (none, none), "pitch curves"))
    assert min(near(plain, DRIVING), near(plain, DRIVEN)) > 500
    assert near(plain, HIGHLIGHT) == 0
    assert near(shades(gears.pitch_curves_png(pair, (some, none), "pitch curves")), HIGHLIGHT) > 500


@pytest.mark.slow
def test_tooth_pair_shows_every_position() -> None:
    positions = [gears.AssembledPosition(angle, angle, 50.0) for angle in (0.0, 1.0, 2.0)]
    pixels = shades(gears.teeth_png(gears.Assembled(wavy(50.0, 0.0), wavy(50.0, pi), 100.0), 2.5, positions, "teeth"))
    for column in np.array_split(pixels[:, : pixels.shape[1] // 3 * 3], 3, axis=1):
        assert min(near(column, DRIVING), near(column, DRIVEN)) > 300


def test_gears_turn_opposite_ways() -> None:
    pair, at = (
        gears.Assembled(wavy(50.0, 0.0), wavy(50.0, pi), 100.0),
        gears.AssembledPosition(pi / 2.0, pi / 2.0, 50.0),
    )
    for gear, place in ((Gear.DRIVING, [0.0, 1.0]), (Gear.DRIVEN, [100.0, -1.0])):
        np.testing.assert_allclose(pair.placed(gear, np.array([[1.0, 0.0]]), at), [place], atol=1e-13)


CRANK_SLIDER = CrankSlider(380.0, 960.0)


def motion_png(own: OutputMotion, uniform: OutputMotion, title: str, joints_deg: np.ndarray = EMPTY) -> bytes:
    charts = [motion_chart(quantity, CRANK_SLIDER, own, uniform, joints_deg) for quantity in MOTION]
    return column_png(charts, title, MOTION_LOOK, MOTION_COLUMN)


def power_png(own: OutputMotion, uniform: OutputMotion, title: str, joints_deg: np.ndarray = EMPTY) -> bytes:
    charts = [motion_chart(quantity, CRANK_SLIDER, own, uniform, joints_deg) for quantity in LOAD]
    return beside_png(
        [(chart, over_displacement(chart, CRANK_SLIDER.OUTPUT, (own, uniform))) for chart in charts], title
    )


@pytest.mark.slow
@pytest.mark.parametrize("draw", [motion_png, power_png])
@pytest.mark.parametrize("joints", [np.empty(0), np.array([57.0, 115.0])])
def test_curves_are_drawn(draw: Any, joints: np.ndarray) -> None:
    pixels = shades(draw(motion(), motion(amplitude=0.0), "baler: 20 r/min", joints))
    assert near(pixels, DRIVING) > 1000
    assert pixels.shape[0] > 500


@pytest.mark.slow
def test_power_without_resistance_and_a_name_with_dollar_signs_can_be_drawn() -> None:
    idle = motion()
    idle = OutputMotion(**{**vars(idle), "load": 0.0 * idle.load, "power_w": 0.0 * idle.power_w})
    assert near(shades(power_png(idle, idle, "a $ and $\\frac")), DRIVING) > 500


@pytest.mark.slow
def test_pictures_are_the_same_bytes_each_time() -> None:
    assert motion_png(motion(), motion(), "a") == motion_png(motion(), motion(), "a")


@pytest.mark.slow
def test_no_global_plotting_state_is_touched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "matplotlib.pyplot", raising=False)
    motion_png(motion(), motion(), "a")
    assert "matplotlib.pyplot" not in sys.modules


# --- a whole build


DESIGN = """
name: small
linkage: {crank_mm: 380, rod_mm: 960}
operation: {speed_rpm: 20}
motion: {law: uniform_crank}
gears:
  teeth: 24
  module_mm: 3
  face_width_mm: 20
  driving: {bore_mm: 16, keyway: {width_mm: 5, depth_mm: 2.3}}
"""


@pytest.mark.slow
def test_build_writes_a_whole_set_of_files(tmp_path: Path) -> None:
    steps: list[str] = []
    out = tmp_path / "out"
    paths = build(drive_of_text(DESIGN), out, steps.append).paths
    assert steps == [
        "motion",
        "pitch curves",
        "teeth",
        "contact",
        "solids",
        "files",
        "written contact",
        "workshop files",
        "plots",
    ]
    assert sorted(path.name for path in out.iterdir()) == sorted(path.name for path in paths)
    assert [path.name for path in paths[-2:]] == ["summary.json", MANIFEST]
    assembly = json.loads((out / "assembly.json").read_text())
    assert (assembly["driving"]["on_line_of_centers"], assembly["driven"]["on_line_of_centers"]) == ("tooth", "space")
    summary = json.loads((out / "summary.json").read_text())
    assert {"plots", "files", "written contact"} <= summary["timing_s"].keys()
    assert len((out / "law.csv").read_text().splitlines()) >= 2002


@pytest.mark.slow
def test_a_build_leaves_what_it_did_not_write_and_takes_away_what_it_did(tmp_path: Path) -> None:
    """Two stages and STEP-like names of a person, then one pair with fewer kinds of files."""
    mine = {"report.html", "driving.step", "gears.3mf", "stage-1/contact.csv", "stage-2/driven.svg", ".ncgear-old/a"}
    for name in mine:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(f"mine: {name}")
    drive = drive_of_text(DESIGN)
    first = build(drive, tmp_path, lambda _: None, (Format.DXF, Format.SVG))
    build(drive, tmp_path, lambda _: None, (Format.SVG,))
    left = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert left == mine | {path.name for path in first.paths if path.suffix != ".dxf"}
    assert all((tmp_path / name).read_text() == f"mine: {name}" for name in mine)


def test_build_into_a_file_is_refused_before_any_step(tmp_path: Path) -> None:
    place, steps = tmp_path / "out", list[str]()
    place.write_bytes(b"")
    with pytest.raises(WrongInput):
        build(drive_of_text(DESIGN), place, steps.append)
    assert not steps


@pytest.mark.slow
def test_failing_build_leaves_the_last_good_one(tmp_path: Path) -> None:
    out = tmp_path / "out"
    build(drive_of_text(DESIGN), out, lambda _: None)
    good = contents(out)
    with pytest.raises(WrongInput, match="largest that fits") as caught:
        build(drive_of_text(DESIGN.replace("bore_mm: 16", "bore_mm: 70")), out, lambda _: None)
    assert caught.value.key == "gears.driving.bore_mm"
    assert contents(out) == good


@pytest.mark.slow
def test_gears_that_are_written_wrong_never_replace_good_ones(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is judged is what is written: here a solid whose teeth are a little too thick, beside a true table."""
    from shapely import Polygon

    from ncgear.files import build as build_module
    from ncgear.files.read_back import stl_bytes
    from ncgear.solids.mesh.slabs import slab_mesh
    from ncgear.solids.plan.body import Slab

    out = tmp_path / "out"
    build(drive_of_text(DESIGN), out, lambda _: None)
    good, drive = contents(out), drive_of_text(DESIGN)

    def thick(mesh: Any) -> bytes:
        if mesh is drive.solids.driven.mesh:
            return stl_bytes(mesh)
        outline = drive.teeth.driving.outline_mm
        section = Polygon(outline).buffer(0.02, join_style="mitre")
        return stl_bytes(slab_mesh((Slab(section, 0.0, 20.0),)).as_trimesh())

    monkeypatch.setattr(build_module, "stl_bytes", thick)
    with pytest.raises(NoSuchMechanism, match="run into each other"):
        build(drive, out, lambda _: None)
    assert contents(out) == good


@pytest.mark.slow
def test_contact_table_has_a_row_per_position_and_agrees_with_the_summary(tmp_path: Path) -> None:
    out = tmp_path / "out"
    summary = build(drive_of_text(DESIGN), out, lambda _: None).summaries[0]["contact"]
    table = np.genfromtxt(out / "contact.csv", delimiter=",", names=True)
    assert table.size == summary["positions"] == 480
    designed, written = summary["as_designed"], summary["as_written"]
    for column, key in (("error_rad", "transmission_error_rad"), ("back_error_rad", "transmission_error_back_rad")):
        assert np.ptp(table[column]) <= 1e-12
        assert designed[key] == 0.0
    assert table["backlash_rad"].max() <= 1e-12
    assert designed["backlash_max_rad"] == 0.0
    assert table["contacts"].min() == designed["pairs_in_contact_min"] == 1
    assert np.degrees(table["pressure_angle_rad"].max()) == pytest.approx(designed["pressure_angle_max_deg"], rel=1e-12)
    assert set(table["edge"]) == {0.0}
    for source in ("csv", "stl"):
        told = written[source]
        assert 0.7 < np.ptp(table[f"{source}_error_rad"]) / told["transmission_error_rad"] <= 1.0
        astray = np.maximum(
            np.abs(table[f"{source}_error_rad"] - table["error_rad"]),
            np.abs(table[f"{source}_back_error_rad"] - table["back_error_rad"]),
        )
        assert 0.7 < astray.max() / told["from_design_max_rad"] <= 1.0
    assert summary["transmission_error_rad"] == max(one["transmission_error_rad"] for one in written.values())
    assert (designed["penetration_max_mm"], designed["penetration_max_at_rad"]) == (0.0, None)
    assert designed["clearance_driving_tips_mm"] == pytest.approx(0.25 * 3.0, abs=1e-9)
    # Circular gears, 24 teeth each: the tip circle cuts the line of action this far from the pitch point.
    base, radius = 36.0 * np.cos(np.radians(20.0)), 36.0
    reach = np.sqrt((radius + 3.0) ** 2 - base**2) - radius * np.sin(np.radians(20.0))
    speed = 20.0 * pi / 30.0
    # Corners count as touching until they are a micrometre apart, a little beyond.
    assert 0.999 <= designed["sliding_velocity_max_mm_s"] / (2.0 * speed * reach) <= 1.03


@pytest.mark.long
@pytest.mark.slow
def test_contact_is_drawn_with_and_without_backlash(tmp_path: Path) -> None:
    plain, thin = (
        shades(
            (build(drive_of_text(text), tmp_path / name, lambda _: None).paths[0].parent / "contact.png").read_bytes()
        )
        for name, text in (("plain", DESIGN), ("thin", DESIGN + "  backlash_mm: 0.1\n"))
    )
    for pixels in (plain, thin):
        assert min(near(pixels, DRIVING), near(pixels, HIGHLIGHT)) > 300
    # A row more, for the backlash.
    assert thin.shape[0] > plain.shape[0] + 100


@at_once("wrong", [float("nan"), float("inf"), -float("inf"), np.float64("nan")])
def test_what_is_no_finite_number_is_never_told_or_written(wrong: float) -> None:
    """In text, in a cell, deep in JSON and in tables alike; what is finite passes unchanged."""
    ways = shown, cell_text, json_text, lambda value: rows_text(("a", "b"), [(1, value)])
    for way in ways:
        with pytest.raises(Unanswered):
            way(wrong)
        assert "2.5" in way(2.5)
    with pytest.raises(Unanswered, match=r"check\.peaks\.1\.power_w is -?(nan|inf)"):
        json_text({"check": {"peaks": [{"power_w": 1.0}, {"power_w": wrong}]}})
    with pytest.raises(Unanswered):
        shown([1.0, (2.0, wrong)])
