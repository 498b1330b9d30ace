"""Places, bounds and counts on a few numbers that are done by hand: cuts, excesses, normals, stretches, ends."""

from __future__ import annotations

import os
import signal
from math import pi
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
from scipy.sparse.linalg import splu
from shapely import LinearRing, Point, Polygon, box, points

from ncgear.cli.lookup import _into_settings
from ncgear.cli.progress import Lines
from ncgear.drivetrain.shafts import STEELS, BentShaft, ShaftSection, shaft_safety
from ncgear.dynamics import train_knocks
from ncgear.errors import Unanswered
from ncgear.figures.advice.law_advice import stretches_in_words
from ncgear.files import measured
from ncgear.files.read_back import flattened
from ncgear.files.workshop.drawing import bore_shape
from ncgear.metrology.round_tool import _Outline
from ncgear.numerics.sampled import HIGHER, Functions
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Mesh
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes
from ncgear.solids.plan.body import Bore, Keyway
from ncgear.strength.elements import plane
from ncgear.strength.elements.mesh import Topology
from ncgear.studio import server
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import toothed_pair
from pairs import rack

Made: Any = SimpleNamespace


@pytest.mark.judges("numerics")
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_curve_that_bends_to_one_side_exceeds_its_points_by_its_bend(sign: float) -> None:
    """1, 4, 9, 16 bend by 2 everywhere; 1, 4, 9, 18 by 4 at the end."""
    values = sign * np.array([[[1.0, 1.0], [4.0, 4.0], [9.0, 9.0], [16.0, 18.0]]])
    assert Functions(values).higher == pytest.approx(HIGHER * np.array([[2.0, 4.0]]))


@pytest.mark.judges("cli")
@pytest.mark.parametrize(("total", "count"), [(None, ""), (1, ""), (2, " (1 of 2 done)")])
def test_a_line_of_progress_counts_steps_from_two_on(total: int | None, count: str) -> None:
    lines = Lines("starting", total, lambda: 5.0)
    lines.update("teeth", 1, total)
    assert lines.line == f"0 s: teeth{count}"


@pytest.mark.judges("figures")
def test_a_stretch_over_the_end_of_the_period_is_told_as_one() -> None:
    assert stretches_in_words([(0.0, 20.0), (350.0, 360.0)], 360.0) == "350..20"
    assert stretches_in_words([(0.0, 20.0), (100.0, 110.0), (350.0, 360.0)], 360.0) == "100..110, 350..20"
    assert stretches_in_words([(0.0, 360.0)], 360.0) == "0..360"


@pytest.mark.judges("studio")
@pytest.mark.parametrize(("sig", "status"), [(signal.SIGINT, 0), (signal.SIGTERM, 143)])
def test_a_studio_that_hangs_at_its_end_leaves_with_the_status_of_its_signal(
    monkeypatch: pytest.MonkeyPatch, sig: int, status: int
) -> None:
    """143 = 128 + 15, as a shell counts; Ctrl-C is no fault."""
    set_handlers: dict[int, Any] = {}
    left: list[int] = []
    monkeypatch.setattr(signal, "signal", set_handlers.__setitem__)
    monkeypatch.setattr(signal, "setitimer", lambda *_: None)
    monkeypatch.setattr(os, "_exit", left.append)
    monkeypatch.setattr("uvicorn.Server.handle_exit", lambda *_: None)
    made = object.__new__(server._Server)
    made.handle_exit(sig, None)
    set_handlers[signal.SIGALRM]()
    assert left == [status]


@pytest.mark.judges("cli")
def test_the_settings_of_an_editor_are_written_below_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    found = Made(files={"settings.json": b"{}"}, patterns={"yaml": ["a.yaml"]})
    monkeypatch.setattr("ncgear.files.editor.editor_files", lambda _: found)
    _into_settings(tmp_path)
    place = tmp_path / ".vscode" / "settings.json"
    assert place.read_bytes() == b"{}"
    assert capsys.readouterr().out.startswith(f"{place}\nthe extension")


@pytest.mark.judges("strength")
def test_displacements_that_do_not_balance_their_load_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A solver whose answer is leaves a force at one of all nodes."""
    first: Any = splu

    def off(*given: Any, **options: Any) -> Any:
        right = first(*given, **options)

        def solve(load: Any) -> Any:
            alone = np.zeros_like(load)
            alone[0] = 1.0
            return right.solve(load) + right.solve(alone)

        return Made(solve=solve)

    none = np.zeros(0, dtype=int)
    cells, held = np.array([[0, 1, 2, 3]]), np.array([True, True, False, False])
    topology = Topology(1, cells, none, held, none[None], 0, none)
    nodes, at, force = (
        np.array([[0.0, 1.0, 1.0j, 1.0 + 1.0j]]),
        np.array([[0.0, 0.0, 1.0, 0.0]]),
        np.array([[1.0 + 0.0j]]),
    )
    material: Any = Made(youngs_modulus_mpa=2.1e5, poisson=0.3)
    plane.displacements(topology, nodes, material, at, force)
    monkeypatch.setattr(plane, "splu", off)
    with pytest.raises(Unanswered, match="do not balance"):
        plane.displacements(topology, nodes, material, at, force)


@pytest.mark.judges("metrology")
@pytest.mark.parametrize("lobes", [Lobes(), pytest.param(Lobes(1, 2), marks=pytest.mark.slow)])
def test_normals_for_a_round_tool_lead_out_of_the_material(lobes: Lobes) -> None:
    """A thousandth of a module along the normals and against them, by shapely; a ring's material is outside."""
    mesh = Mesh.EXTERNAL if lobes == Lobes() else Mesh.INTERNAL
    pair = toothed_pair(sized_pair(uniform_law(lobes), 24, 2.0, None, mesh), ToothForm(rack()), 0.005)
    for gear in (pair.driving, pair.driven):
        outline = _Outline(gear)
        ring = Polygon(
            LinearRing(outline.at(np.linspace(0.0, outline.kind.size, 8 * outline.kind.size, endpoint=False))[0])
        )
        # Middles of curves, away from their edges
        point, normal = outline.at(np.arange(0.5, outline.kind.size))
        for side, inside in ((2e-3, gear.flanks.curve.is_ring), (-2e-3, not gear.flanks.curve.is_ring)):
            assert (ring.contains(points(point + side * normal)) == inside).mean() > 0.9


@pytest.mark.judges("drivetrain")
def test_a_shafts_torsion_swings_about_the_middle_of_its_least_and_largest_torque() -> None:
    """1 to 3 N m on a shaft of 20 mm: pi 20^3 / 16 = 1570.8 mm3, so 1.273 MPa about 1.273, and no bending."""
    section = ShaftSection(20.0, 20.0, STEELS["C45"])
    found = shaft_safety(section, BentShaft(np.zeros(1, dtype=complex), 0.0, (1000.0, 3000.0))).stresses
    unit = 1000.0 / (pi * 20.0**3 / 16.0)
    assert found.torsion_amplitude_mpa == pytest.approx(unit)
    assert found.torsion_mean_mpa == pytest.approx(2.0 * unit)
    assert found.bending_amplitude_mpa == 0.0


@pytest.mark.judges("files")
def test_a_drawn_bore_is_its_circle_and_keyway_to_the_drawn_width() -> None:
    """30 mm with a keyway 8 wide and 3.3 deep: the circle's area, and beyond it a slot to x = 18.3, by shapely."""
    drawn: Any = bore_shape(Bore(30.0, Keyway(8.0, 3.3)))
    area = Polygon(flattened(drawn.points, drawn.bulges))
    circle, slot = Point(0.0, 0.0).buffer(15.0, 4096), box(0.0, -4.0, 18.3, 4.0)
    assert area.symmetric_difference(circle.union(slot)).area < 1e-3


@pytest.mark.judges("dynamics")
def test_two_bodies_swing_on_the_teeth_of_their_pairs() -> None:
    """The shaft between turns at 3/2 rad/s, so that the ratio 0.5 asks for 0.75 of the crank, which does 6/4."""
    along: Any = Made(slope=np.array([[1.0], [0.5]]), inertia=np.array([[2.0], [4.0]]), own=np.array([[2.0], [10.0]]))
    state: Any = Made(momentum=[3.0, 6.0])
    assert train_knocks._momenta(state, along, slice(None)) == pytest.approx([3.0, 10.0 * (1.5 - 0.75)])


@pytest.mark.judges("files")
def test_excess_of_metal_is_drawn_out_of_the_gear(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two points, 0.5 mm of excess and 0.25 mm missing, on a right and on an upper flank."""
    foot, outwards = np.array([10.0 + 0j, 20j]), np.array([1.0 + 0j, 1j])
    feet: Any = Made(foot=foot, outwards=outwards, distance_mm=np.array([0.5, -0.25]))
    flanks = Made(rack=Made(module_mm=1.0), curve=Made(is_ring=False))
    outline = Made(gear=Made(outline_mm=np.array([[-30.0, -30.0], [30.0, 30.0]]), flanks=flanks))
    one: Any = Made(outline=outline, fit=Made(feet=Made(kept=lambda _: feet), counted=None))
    drawn = list[Any]()
    axes = MagicMock()
    axes.add_collection = lambda lines, **_: drawn.append(lines)
    for name in ("_along_flanks", "_number"):
        monkeypatch.setattr(measured, name, lambda *_: [])
    monkeypatch.setattr("ncgear.drawings.plots.canvas.area", lambda *_: None)
    measured._draw_gear(MagicMock(add_axes=lambda _: axes), one, 0.5)
    (right, upper) = drawn[0].get_segments()
    assert right == pytest.approx(np.array([[10.0, 0.0], [11.0, 0.0]]))
    assert upper == pytest.approx(np.array([[0.0, 20.0], [0.0, 19.5]]))
