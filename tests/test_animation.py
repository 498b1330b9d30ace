"""The moving picture: its frames show what the law says, its files are whole, and what cannot be written is refused."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from io import BytesIO
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from matplotlib.axes import Axes
from PIL import Image

from at_once import at_once
from commands import Run
from ncgear import extras
from ncgear.drawings.animation import AnimationFormat, packing, require_shown
from ncgear.drawings.animation import artists as looks
from ncgear.drawings.animation.moving_picture import Frame, Picture, picture
from ncgear.drawings.animation.packing import Loop, animated
from ncgear.drawings.scene.bodies import BodyKind
from ncgear.drawings.scene.scene import Scene
from ncgear.files.manifest import entries_in, publish_run
from ncgear.numerics.arrays import Array
from scenes import GEARLESS, TWO_STAGES, scene

MARK = (0.0, 1.0, 0.0)
"""A green that nothing else in the picture has."""

WIDTH = 640


def drawn(made: Picture, found: Scene, phi1: list[float]) -> list[Frame]:
    return list(made.frames(found.poses(np.array(phi1))))


def marked_mm(made: Picture, frame: Frame, within: tuple[float, float] = (-np.inf, np.inf)) -> Array:
    """Centre of the marked pixels of the machine's view, in mm, of those with x within bounds."""
    shade = frame.astype(float)
    share = np.clip((shade[..., 1] - np.maximum(shade[..., 0], shade[..., 2])) / 255.0, 0.0, 1.0)
    rows, columns = np.nonzero(share > 0.02)
    height = frame.shape[0]
    pixels = np.stack([columns + 0.5, height - (rows + 0.5)], axis=-1)
    box = machine_axes(made).bbox
    inside = (pixels[:, 0] > box.x0) & (pixels[:, 0] < box.x1) & (pixels[:, 1] > box.y0)
    places = machine_axes(made).transData.inverted().transform(pixels)
    kept = inside & (places[:, 0] > within[0]) & (places[:, 0] < within[1])
    assert kept.sum() > 4
    return np.average(places[kept], axis=0, weights=share[rows, columns][kept])


def machine_axes(made: Picture) -> Axes:
    return made.figure.axes[0]


def pixel_mm(made: Picture) -> float:
    left, right = machine_axes(made).get_xlim()
    return (right - left) / machine_axes(made).bbox.width


@pytest.fixture
def marked_pins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(looks, "PIN", {"facecolor": MARK, "edgecolor": "none"})


@pytest.mark.slow
@pytest.mark.usefixtures("marked_pins")
def test_the_pins_are_drawn_where_the_law_has_them() -> None:
    """To a third of a pixel; the law tells the crank's angle, plane trigonometry the rest."""
    found = scene("baler")
    made = picture(found, WIDTH)
    phi1 = [0.0, 0.7, 2.0, 3.3, 5.5]
    angle = np.pi - found.machine.transmission.driven_angle(np.array(phi1)).value
    pin = 380.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    slider = pin[:, 0] + np.sqrt(960.0**2 - pin[:, 1] ** 2)
    for row, frame in enumerate(drawn(made, found, phi1)):
        assert np.abs(marked_mm(made, frame, (-np.inf, 480.0)) - pin[row]).max() < pixel_mm(made) / 3.0
        expected = np.array([slider[row], 0.0])
        assert np.abs(marked_mm(made, frame, (480.0, np.inf)) - expected).max() < pixel_mm(made) / 3.0


@pytest.mark.tiers(slow=["pump-1-2-1.0"], rest="long")
@pytest.mark.parametrize(("name", "sense"), [("pump-1-2", 1.0), ("internal-1-2", -1.0)])
def test_a_point_of_the_driving_gear_turns_with_it(name: str, sense: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """A gear that is a square aside of its axis; as the crank turns clockwise, a ring's pinion does so, too."""
    monkeypatch.setitem(looks.BODIES, BodyKind.DRIVING, {"facecolor": MARK, "edgecolor": "none"})
    monkeypatch.setitem(looks.PITCH_CURVES, BodyKind.DRIVING, {"linestyle": "none"})
    for link in (BodyKind.CRANK, BodyKind.ROD):
        monkeypatch.setitem(looks.BODIES, link, {"facecolor": "none", "edgecolor": "none"})
    monkeypatch.setattr(looks, "PIN", {"facecolor": "none", "edgecolor": "none"})
    found, aside = scene(name), 12.0 + 5.0j
    made = picture(with_square(found, aside), WIDTH)
    phi1 = [0.0, 1.0, 3.0, 7.5]
    x, y = found.axes_mm[0]
    for angle, frame in zip(phi1, drawn(made, found, phi1), strict=True):
        expected = complex(x, y) + aside * np.exp(1j * sense * angle)
        assert np.abs(marked_mm(made, frame) - [expected.real, expected.imag]).max() < pixel_mm(made) / 3.0


def with_square(found: Scene, center: complex) -> Scene:
    corners = center + 2.0 * np.array([-1.0 - 1.0j, 1.0 - 1.0j, 1.0 + 1.0j, -1.0 + 1.0j])
    square = np.stack([corners.real, corners.imag], axis=-1)
    (pair,) = found.pairs
    body = replace(pair.driving.body, contours_mm=(square,))
    return replace(found, pairs=(replace(pair, driving=replace(pair.driving, body=body)),))


@pytest.mark.slow
def test_the_words_tell_the_pose() -> None:
    found = scene("uniform-crank")
    made = picture(found, WIDTH)
    drawn(made, found, [pi / 2.0])
    *by_chart, angles = made.moving[-3:]
    before, after, number = zip(*(chart.artists[-1].axes.texts for chart in by_chart), strict=True)
    assert [words.get_text() for words in (*before, *after)] == ["displacement ", "velocity ", " mm", " mm/s"]
    # sqrt(960^2 - 380^2) - (960 - 380); at 60 r/min 2 pi 380 mm/s.
    assert [words.get_text() for words in (*number, *angles.artists)] == ["302", "2388", "90.0", "90.0"]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["baler", "pump-1-2"])
def test_the_loop_closes(name: str) -> None:
    """After the last frame comes the first: all that moves is where it was, to the pixel."""
    found = scene(name)
    made = picture(found, WIDTH)
    first, last, middle = drawn(made, found, [1e-9, found.loop_rad + 1e-9, found.loop_rad / 2.0])
    # The charts below know the turns apart.
    rows = slice(30, round(first.shape[0] - machine_axes(made).bbox.y0))
    assert np.array_equal(first[rows], last[rows])
    assert not np.array_equal(first[rows], middle[rows])


def gif(name: str, frames: int = 5, seconds: float = 0.37, width: int = 401) -> Image.Image:
    loop = Loop(frames, seconds, width)
    return Image.open(BytesIO(animated(scene(name), AnimationFormat.GIF, loop, lambda done, total: None)))


@pytest.mark.tiers(slow=["baler", "baler-66-two-stage", "webbed"], rest="long")
@pytest.mark.parametrize(
    "name", ["baler", "internal-1-2", pytest.param(TWO_STAGES, marks=pytest.mark.slow), "gearless", "webbed"]
)
def test_a_gif_has_its_frames_its_time_and_its_size(name: str) -> None:
    made = gif(name)
    assert made.n_frames == 5  # type: ignore[attr-defined]
    assert made.width == 400
    assert made.height % 2 == 0
    assert made.info["loop"] == 0
    times, papers = [], []
    for number in range(5):
        made.seek(number)
        times.append(made.info["duration"])
        papers.append(made.convert("RGB").getpixel((200, 1)))
    assert sum(times) == 370
    assert max(times) - min(times) <= 10
    assert papers == [(255, 255, 255)] * 5


@pytest.mark.slow
def test_the_same_scene_gives_the_same_bytes() -> None:
    loop = Loop(3, 1.0, 320)
    once, again = (animated(scene("ellipse"), AnimationFormat.GIF, loop, lambda done, total: None) for _ in range(2))
    assert once == again


@pytest.mark.slow
@pytest.mark.parametrize("name", ["baler", "rocker-drive", "log-generator"])
def test_numbers_stand_between_their_words(name: str) -> None:
    """In every pose, and some pose leaves no more room than a letter."""
    found = scene(name)
    made = picture(found, WIDTH)
    *by_chart, angles = made.moving[-3:]
    poses, rooms = found.poses(found.evenly_in_time(24)), []
    for row in range(24):
        for one in (*by_chart, angles):
            one.pose(poses, row)
        for chart in by_chart:
            number = chart.artists[-1]
            before, after = (words.get_window_extent() for words in number.axes.texts if words is not number)
            box = number.get_window_extent()
            assert before.x1 <= box.x0 + 0.5 < box.x1 < after.x1
            assert box.x1 <= after.x0 + 0.5
            rooms.append(box.x0 - before.x1)
        (words,) = (text for text in made.figure.texts if text.get_text().startswith("phi1"))
        letter = words.get_window_extent().width / len(words.get_text())
        first, second = (number.get_window_extent() for number in angles.artists)
        sign, other = (words.get_window_extent().x0 + letter * place for place in (10, len(words.get_text()) - 1))
        assert (first.x1, second.x1) == (pytest.approx(sign, abs=1.0), pytest.approx(other, abs=1.0))
        assert max(first.width, second.width) < 5.5 * letter
    assert min(rooms) < 8.0


@pytest.mark.slow
def test_an_mp4_is_read_back() -> None:
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    loop, told = Loop(8, 0.5, 321), []
    found = scene("ellipse")
    once, again = (animated(found, AnimationFormat.MP4, loop, lambda *done: told.append(done)) for _ in range(2))
    assert once == again
    assert told == [(number, 8) for number in range(1, 9)] * 2
    (frame, *_) = drawn(picture(found, 321), found, [0.0])
    frames = read_back(ffmpeg.get_ffmpeg_exe(), once, frame.shape)
    assert len(frames) == 8
    # Half of the colours are lost and edges are blurred, but it is the same picture.
    assert np.abs(frames[0].astype(float) - frame).mean() < 3.0
    assert np.abs(frames[4].astype(float) - frame).mean() > 3.0


def read_back(ffmpeg: str, content: bytes, shape: tuple[int, ...]) -> list[Frame]:
    """The frames of a video at 16 a second, which is what it was written at."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "loop.mp4"
        path.write_bytes(content)
        command = [ffmpeg, "-i", str(path), "-r", "16", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
        raw = subprocess.run(command, capture_output=True, check=True).stdout
    return list(np.frombuffer(raw, np.uint8).reshape(-1, *shape))


@pytest.fixture
def gearless(tmp_path: Path) -> str:
    """The quickest of designs."""
    path = tmp_path / "design.yaml"
    path.write_text(GEARLESS, encoding="utf-8")
    return str(path)


QUICK = ["--frames", "2", "--width", "320"]


@pytest.mark.slow
def test_the_command_writes_where_it_is_told(run: Run, gearless: str) -> None:
    status, out, _ = run("animate", gearless, *QUICK)
    assert status == 0
    assert out.startswith("wrote export/gearless/mechanism.gif: 2 frames in 4 s")
    assert run("animate", gearless, *QUICK, "--out", "deep/er/one.GIF")[0] == 0
    assert Path("export/gearless/mechanism.gif").read_bytes() == Path("deep/er/one.GIF").read_bytes()


@pytest.mark.slow
def test_a_foreign_folder_gets_the_picture_alone(run: Run, gearless: str, tmp_path: Path) -> None:
    """And in one that ncgear has made, the picture gets its entry."""
    (tmp_path / "mine").mkdir()
    for frames in ("2", "3"):
        assert run("animate", gearless, "--frames", frames, "--out", "mine/film.gif")[0] == 0
        assert [path.name for path in (tmp_path / "mine").iterdir()] == ["film.gif"]
    publish_run(tmp_path / "ours", {"law.csv": b"a"}, "build")
    assert run("animate", gearless, "--frames", "2", "--out", "ours/film.gif")[0] == 0
    assert set(entries_in(tmp_path / "ours")) == {"law.csv", "film.gif"}


@pytest.mark.parametrize("name", ["one.png", "one", ".gif"])
def test_other_suffixes_are_refused(run: Run, gearless: str, name: str) -> None:
    status, _, err = run("animate", gearless, "--out", name)
    assert status == 2
    assert err.startswith(f"{name}: ")
    assert ".gif or .mp4 is right" in err


def test_a_missing_library_is_named_with_its_extra(run: Run, gearless: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda library: None)
    status, _, err = run("animate", gearless, "--out", "one.mp4")
    assert status == 2
    assert "imageio_ffmpeg" in err
    assert "pip install 'ncgear[video]'" in err


def test_a_place_that_cannot_be_written_is_refused(run: Run, gearless: str) -> None:
    Path("file").write_text("in the way")
    status, _, err = run("animate", gearless, "--out", "file/one.gif")
    assert status == 2
    assert err.startswith(str(Path("file")))


@pytest.mark.parametrize("name", ["fold\\er.gif", ".ncgear-a.gif", "x" * 300 + ".gif", "taken.gif"])
def test_a_name_that_no_file_can_have_is_refused_before_a_frame_is_drawn(
    run: Run, gearless: str, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    Path("taken.gif").mkdir()
    monkeypatch.setattr(packing, "animated", lambda *_: pytest.fail("a frame is drawn"))
    status, _, err = run("animate", gearless, *QUICK, "--out", name)
    assert (status, err.partition(":")[0]) == (2, name)


@pytest.mark.parametrize(("frames", "seconds"), [(51, 1.0), (9, 0.1), (600, 11.9), (90, 0.4)])
def test_a_gif_too_fast_for_its_viewers_is_refused(
    run: Run, gearless: str, monkeypatch: pytest.MonkeyPatch, frames: int, seconds: float
) -> None:
    monkeypatch.setattr(packing, "animated", lambda *_: pytest.fail("a frame is drawn"))
    status, _, err = run("animate", gearless, "--frames", str(frames), "--seconds", str(seconds))
    assert status == 2
    assert "--frames" in err


@at_once(("frames", "seconds"), [(50, 1.0), (2, 0.1), (600, 12.0), (37, 0.9), (72, 4.0)])
def test_every_frame_of_a_gif_is_shown_for_at_least_two_hundredths_of_a_second(frames: int, seconds: float) -> None:
    require_shown(AnimationFormat.GIF, frames, seconds)
    durations = Loop(frames, seconds, 320).durations_ms
    assert min(durations) >= 20
    assert sum(durations) == pytest.approx(1000.0 * seconds, abs=10.0)


@pytest.mark.slow
def test_an_interrupted_run_leaves_the_last_picture(run: Run, gearless: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run("animate", gearless, *QUICK, "--out", "one.gif")[0] == 0
    before = Path("one.gif").read_bytes()

    def interrupted(*_: object) -> bytes:
        raise KeyboardInterrupt

    monkeypatch.setitem(packing.PACKERS, AnimationFormat.GIF, interrupted)
    assert run("animate", gearless, *QUICK, "--out", "one.gif")[0] == 130
    assert Path("one.gif").read_bytes() == before
    assert [path.name for path in Path().iterdir() if path.name.startswith(".")] == []
