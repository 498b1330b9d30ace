"""Use from Python: what a person types who has never seen the code."""

from __future__ import annotations

import doctest
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import ncgear
import ncgear.plots
from commands import ROOT, modules_after, python
from ncgear.design.template import template
from ncgear.drawings.assembled import Assembled

BALER = ROOT / "designs" / "baler.yaml"

EXAMPLES = """
import doctest, importlib, sys
modules = map(importlib.import_module, ("ncgear.project.opened", "ncgear.project.mending", "ncgear.plots"))
sys.exit(sum(doctest.testmod(module).failed for module in modules))
"""
"""In a process of its own, as the examples open figures of pyplot's."""


@pytest.mark.slow
def test_the_examples_in_docstrings_are_true() -> None:
    done = python("-c", EXAMPLES, MPLBACKEND="Agg")
    assert (done.returncode, done.stdout) == (0, "")


def test_there_are_examples() -> None:
    finder = doctest.DocTestFinder()
    assert all(finder.find(thing)[0].examples for thing in (ncgear.load, ncgear.mending, ncgear.plots))


def test_importing_the_package_loads_no_library() -> None:
    assert modules_after("import ncgear") & {"numpy", "pydantic", "matplotlib", "typer"} == set()


def test_every_public_name_is_there_and_explained() -> None:
    """All but one, which loads the kernel of CAD programs."""
    assert [name for name in ncgear.__all__ if name != "cad" and not getattr(ncgear, name).__doc__] == []
    assert [name for name in ncgear.plots.__all__ if not getattr(ncgear.plots, name).__doc__] == []
    assert set(ncgear.__all__) <= set(dir(ncgear))


@pytest.mark.slow
def test_the_names_of_cad_are_explained() -> None:
    pytest.importorskip("OCP", reason="the kernel for STEP is not installed")
    assert ncgear.cad.__doc__
    assert [name for name in ncgear.cad.__all__ if not getattr(ncgear.cad, name).__doc__] == []


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'laod'"):
        ncgear.laod  # noqa: B018


@pytest.mark.parametrize("path", [BALER, str(BALER)], ids=["path", "text"])
def test_load_takes_a_path_or_a_text(path: str | Path) -> None:
    assert ncgear.load(path).design.name == "baler"


def wrong(folder: Path, old: str, new: str) -> Path:
    """The template's file with its only ``old`` replaced."""
    text = template("mine")
    assert text.count(old) == 1
    (folder / "mine.yaml").write_text(text.replace(old, new))
    return folder / "mine.yaml"


def test_a_wrong_file_is_refused_with_its_place(tmp_path: Path) -> None:
    with pytest.raises(ncgear.WrongInput, match=r"mine\.yaml:10:3: linkage\.rod_m: unknown key; did you mean rod_mm\?"):
        ncgear.load(wrong(tmp_path, "rod_mm", "rod_m"))


def test_a_value_that_cannot_be_made_names_the_place_in_the_file(tmp_path: Path) -> None:
    """As the command line does, whether the value is asked for itself or needed by another."""
    path = wrong(tmp_path, "stroke_mm: 760", "stroke_mm: 700")
    for value in ("law", "check", "teeth"):
        with pytest.raises(ncgear.WrongInput) as caught:
            getattr(ncgear.load(path), value)
        assert str(caught.value).startswith(f"{path}:30:3: motion.stroke_mm: 700 mm is shorter than the linkage's")


def test_values_of_a_design_without_a_file_name_their_key() -> None:
    design = ncgear.load(BALER).design.model_copy(update={"gears": None})
    with pytest.raises(ncgear.WrongInput, match=r"^gears: missing"):
        ncgear.Drive(design).pitch  # noqa: B018


def test_each_stage_of_two_names_the_place_in_the_file(tmp_path: Path) -> None:
    text = (ROOT / "designs" / "baler-66-two-stage.yaml").read_text()
    (tmp_path / "two.yaml").write_text(text.replace("gears:\n", "gears:\n  center_distance_mm: 1\n"))
    with pytest.raises(ncgear.DesignError, match=r"two\.yaml:\d+:\d+: gears\.center_distance_mm"):
        ncgear.load(tmp_path / "two.yaml").by_stage[1].pitch  # noqa: B018


@pytest.fixture(scope="module")
def drive() -> ncgear.Drive:
    return ncgear.load(BALER)


REPRS = {
    "law": r"Law\(Transmission\(ratio 0\.4406 to 2\.055, 1:1 lobes, 4 pieces\) on CrankSlider\(crank_mm=380\.0, .*\)\)",
    "machine": r"Machine\(20 r/min, CrankSlider\(.*\),\n  Transmission\(.*\)\)",
    "motion": r"OutputMotion\(2001 driving angles up to 360 deg\)",
    "check": r"KinematicCheck\(peaks at 20 r/min:\n  power 6315\.1 W at 202\.1 deg.*",
    "pitch": r"PitchPair\(external, a = 74\.885 mm, 25:25 teeth of module 3 mm\)",
    "teeth": r"ToothedPair\(cutter mate,\n  driving: ToothedGear\(25 teeth, .*\),\n  driven: ToothedGear\(25 .*\)\)",
    "designed_contact": r"AsDesigned\(at 500 positions: transmission error .* rad, backlash up to .* rad, overlap .*\)",
    "solids": r"SolidPair\(\n  driving: GearSolid\(.* x 20 mm, \d+ triangles, with index hole\),\n  driven: .*\)",
}


@pytest.mark.slow
@pytest.mark.parametrize("name", REPRS)
def test_values_say_in_a_few_lines_what_they_are_and_compute_nothing_more(drive: ncgear.Drive, name: str) -> None:
    value = getattr(drive, name)
    made, within = set(vars(drive)), set(vars(value))
    shown = repr(value)
    assert re.fullmatch(REPRS[name], shown, flags=re.DOTALL), shown
    assert len(shown.splitlines()) <= 5
    assert (set(vars(drive)), set(vars(value))) == (made, within)


def axes() -> Axes:
    made = Figure()
    FigureCanvasAgg(made)
    return made.subplots()


OVER_ANGLE = {
    "displacement": "displacement",
    "velocity": "velocity",
    "acceleration": "acceleration",
    "force": "load",
    "power": "power_w",
}


@pytest.mark.parametrize("name", OVER_ANGLE)
def test_a_plot_of_motion_draws_the_drives_values_onto_the_axes_given(drive: ncgear.Drive, name: str) -> None:
    given, column = axes(), OVER_ANGLE[name]
    assert getattr(ncgear.plots, name)(drive, given) is given
    own, uniform = given.get_lines()[:2]
    # The table's angles, and those of the peaks between them.
    table = np.isin(own.get_xdata(), np.degrees(drive.motion.phi1_rad))
    assert table.sum() == drive.motion.phi1_rad.size < table.size
    np.testing.assert_allclose(own.get_ydata()[table], getattr(drive.motion, column))
    np.testing.assert_allclose(uniform.get_ydata()[table], getattr(drive.uniform_motion, column))
    assert given.get_xlabel() == "driving angle phi1 in deg"


@pytest.mark.parametrize("name", ["flanks_in_contact", "pressure_angles", "sliding", "backlash"])
def test_a_plot_of_contact_is_over_the_whole_cycle(drive: ncgear.Drive, name: str) -> None:
    given = axes()
    assert getattr(ncgear.plots, name)(drive, given) is given
    assert given.get_xlim() == (0.0, 360.0)
    assert all(line.get_xdata().size == drive.designed_contact.placement.count for line in given.get_lines())


@pytest.mark.parametrize("draw", [ncgear.plots.pair_at, ncgear.plots.mesh_at])
def test_the_gears_are_drawn_at_the_angle_asked_for(
    drive: ncgear.Drive, draw: Callable[[ncgear.Drive, float, Axes], Axes]
) -> None:
    given, phi1 = draw(drive, 1.0, axes()), 1.0
    turned = np.column_stack([np.cos([0.0, phi1]), np.sin([0.0, phi1])])[1]
    first = drive.teeth.driving.outline_mm[0]
    expected = first[0] * turned[0] - first[1] * turned[1], first[0] * turned[1] + first[1] * turned[0]
    np.testing.assert_allclose(given.patches[0].get_path().vertices[0], expected, atol=1e-9)


def test_pitch_curves_are_drawn_where_they_touch(drive: ncgear.Drive) -> None:
    given = axes()
    assert ncgear.plots.pitch_curves(drive, given) is given
    driving, driven = (patch.get_path().vertices for patch in given.patches[:2])
    assert driving[0] == pytest.approx(driven[0], abs=1e-9)


def test_assembled_frames_hold_both_gears() -> None:
    square = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    left, right, top = Assembled(square, 2.0 * square, 3.0).frame
    assert left < -np.sqrt(2.0)
    assert right > 3.0 + np.sqrt(8.0)
    assert top > np.sqrt(8.0)
