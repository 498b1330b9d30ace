"""Every size alike: a design scaled from a millionth of a millimetre of module to a metre has the same figures, scaled.

Every length of a design file is multiplied, forces and masses as they follow from lengths at one speed: a mass with the
third power of the factor, a force with the fourth, a power with the fifth.  What is then told is compared with what was
told before, divided by the same powers; what is written is read back by trimesh, ezdxf and shapely in modules.
"""

from __future__ import annotations

import json
from copy import deepcopy
from io import BytesIO, StringIO
from math import pi
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import trimesh
from ezdxf.path import make_path
from shapely import Polygon, affinity

from commands import Run
from hard.case import drive_of
from ncgear.design.keys import machine
from ncgear.errors import WrongInput
from ncgear.figures.answers.answer import COLUMNS
from ncgear.files.build import contacts_as_written, summaries_without_files, verdicts_of
from ncgear.files.read_back import stl_bytes
from ncgear.files.workshop.drawing import pair_drawings
from ncgear.files.workshop.dxf import dxf_files
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive

Data = dict[str, Any]

POWERS = {
    "_kg_mm2": 5,
    "_kg_m2": 5,
    "_n_m": 5,
    "_n_mm": 5,
    "_kg": 3,
    "_n": 4,
    "_w": 5,
    "_j": 5,
    "_1_mm": -1,
    "_cm3": 3,
    "_l_min": 3,
    "_mm_s2": 1,
    "_m_s2": 1,
    "_mm_s": 1,
    "_mm2": 2,
    "_mm3": 3,
    "_mm": 1,
    "_um": 1,
}
"""Powers of the factor with which figures grow by the ends of their keys, at the same speed in r/min; others stay."""

OF_POLYNOMIAL = {"polynomial_n": 4, "polynomial_n_m": 5}

REAL = ("index_hole", "volume", "mass", "inertia", "center_of_mass", "area", "weight", "density")
"""Parts of the keys of what an index hole changes: a drill has a size of its own, whatever the gear."""

WORDS = ("in_words", "warnings", "remarks", "timing_s", "note", "strength")
"""What is told in words, with its sizes, and what a material of its own endures.  Keys that begin with dwell are left
out too: dwells are told within a round length, 1, 2 or 5 of a power of ten."""

WHERE = ("_at_rad", "_at_mm", "_at_deg", "_tooth_driving", "_tooth_driven", "_by_tooth_rad")
"""Ends of keys that say where an extreme is: many teeth have the same, and rounding chooses among them."""

SINGLE = 3e-6
"""Modules within which STL files, whose numbers are of single precision, tell sizes of gears of a few dozen teeth."""

SEARCHED_DEG = 0.05
"""Accuracy in degrees to which extremes of pressure angles are searched: a thousandth of their range."""

OVAL: Data = {
    "name": "oval",
    "gears": {"teeth": 24, "lobes": {"driving": 2, "driven": 2}, "module_mm": 1.0, "face_width_mm": 5.0},
    "motion": {"law": "ratio_expression", "driven_angle": "phi - 0.08*sin(2*phi)"},
    "operation": {"speed_rpm": 60.0},
}

MACHINE: Data = {
    "name": "machine",
    "linkage": {"crank_mm": 30.0, "rod_mm": 110.0, "offset_mm": 4.0},
    "gears": {"teeth": 32, "module_mm": 1.0, "face_width_mm": 8.0, "backlash_mm": 0.03},
    "motion": {"law": "harmonic_ratio", "cosine": [-0.2, 0.06], "sine": [0.1]},
    "operation": {"speed_rpm": 45.0},
    "resistance": {"polynomial_n": [0.4, 0.02, -0.0001]},
    "masses": {
        "slider_kg": 0.006,
        "rod": {"mass_kg": 0.002, "center_mm": 50.0, "inertia_kg_mm2": 2.5},
        "crank": {"mass_kg": 0.003, "center_mm": 10.0, "inertia_kg_mm2": 1.5},
        "gravity": {"acceleration_m_s2": 0.4},
    },
}


def with_gears(data: Data, **keys: Any) -> Data:
    return {**data, "gears": {**data["gears"], **keys}}


CASES: dict[str, Data] = {
    "oval": with_gears(OVAL, backlash_mm=0.04),
    "shifted": with_gears(OVAL, teeth=18, backlash_deg=0.2, rack={"tip_relief": {"amount": 0.01, "start": 0.7}}),
    "machine": MACHINE,
    "equivalent": with_gears(
        {key: part for key, part in MACHINE.items() if key != "masses"}, method="equivalent_gear", backlash_mm=0.05
    ),
    "ring": {
        **OVAL,
        "gears": {
            "teeth": 20, "mesh": "internal", "lobes": {"driving": 1, "driven": 2}, "module_mm": 1.0,
            "face_width_mm": 6.0, "backlash_mm": 0.06,
        },
        "motion": {"law": "harmonic_ratio", "cosine": [0.1]},
    },
    "helical": with_gears(
        OVAL, teeth=20, face_width_mm=4.0, backlash_mm=0.05,
        helix={"angle_deg": 12.0, "hand": "right", "kind": "helical"},
    ),
    "sector": {
        **OVAL,
        "gears": {"teeth": 24, "module_mm": 1.0, "face_width_mm": 5.0, "backlash_mm": 0.05},
        "motion": {"law": "ratio_expression", "ratio": "1 + 0.2*cos(phi)", "range_deg": 180.0},
    },
}  # fmt: skip
"""Designs of module 1, of several laws and kinds of teeth; their chord tolerance is that of small teeth."""


def scaled(value: Any, factor: float, key: str = "") -> Any:
    """The values of a design with every length multiplied, and masses and forces as they follow."""
    if isinstance(value, dict):
        return {name: scaled(part, factor, name) for name, part in value.items()}
    if key in OF_POLYNOMIAL:
        return [part * factor ** (OF_POLYNOMIAL[key] - order) for order, part in enumerate(value)]
    if isinstance(value, float):
        return value * factor ** power_of(key)
    return deepcopy(value)


def power_of(key: str) -> int:
    return next((power for end, power in POWERS.items() if key.endswith(end)), 0)


def told(data: Data) -> Data:
    """The summary of a build, without files."""
    drive = drive_of(data)
    (summary,) = summaries_without_files(drive, contacts_as_written(drive, lambda step: None), verdicts_of(drive))
    return summary


def apart(one: Any, other: Any, factor: float, path: str = "", key: str = "") -> list[str]:
    """Where figures of a scaled design are not those of the design."""
    if any(part in key for part in REAL) or key in WORDS or key.endswith(WHERE) or key.startswith("dwell"):
        return []
    if isinstance(one, dict):
        assert one.keys() == other.keys(), path
        if one.get("condition") in ("jams", "strength", "flanks", "vibration"):
            # What workshops leave, what dry and small teeth endure, how stiff a material is, and roughness do not scale
            return []
        return [said for name in one for said in apart(one[name], other[name], factor, f"{path}.{name}", name)]
    if isinstance(one, list):
        assert len(one) == len(other), path
        pairs = enumerate(zip(one, other, strict=True))
        return [said for place, (a, b) in pairs for said in apart(a, b, factor, f"{path}.{place}", key)]
    if isinstance(one, float) and isinstance(other, float):
        near = SEARCHED_DEG if "pressure_angle" in key else SINGLE
        wanted = other / factor ** power_of(key)
        return [] if abs(wanted - one) <= 1e-6 * abs(one) + near else [f"{path}: {one} and {wanted}"]
    return [] if one == other else [f"{path}: {one} and {other}"]


@pytest.mark.tiers(slow=["1e-06-ring", "1e-06-machine", "1000.0-machine"], rest="long")
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("factor", [1e-6, 0.02, 1000.0], ids=["1e-06", "0.02", "1000.0"])
def test_a_scaled_design_has_the_same_figures_scaled(name: str, factor: float) -> None:
    # Of a metre of module the default tolerance stays that of a machine; here it is to grow as well.
    data = {**CASES[name], "output": {"chord_tolerance_mm": 0.002}}
    assert apart(told(data), told(scaled(data, factor)), factor) == []


def test_a_figure_that_does_not_scale_is_seen() -> None:
    """Negative control: with a force that stays, and with a module a hundredth off, figures differ."""
    data = {**MACHINE, "output": {"chord_tolerance_mm": 0.002}}
    (one,) = summaries_without_files(plain := drive_of({**data, "gears": None}), [], verdicts_of(plain))
    other = scaled({**data, "gears": None}, 0.1)
    other["resistance"] = {"polynomial_n": [0.4e-4, 2e-5 * 1.01, -1e-6]}
    (found,) = summaries_without_files(drive_of(other), [], verdicts_of(drive_of(other)))
    assert any("power" in said for said in apart(one, found, 0.1))


POSITIONS = 90


def overlaps(outlines: tuple[Polygon, Polygon], distance: float, depth: float) -> bool:
    """Whether gears overlap by more than a depth anywhere, of polygons in modules turned by the law of OVAL."""
    driving, driven = outlines
    thinner = driven.buffer(-depth)
    for phi1 in np.linspace(0.0, pi, POSITIONS, endpoint=False):
        phi2 = phi1 - 0.08 * np.sin(2.0 * phi1)
        first = affinity.rotate(driving, phi1, origin=(0, 0), use_radians=True)
        second = affinity.rotate(thinner, -phi2, origin=(0, 0), use_radians=True)
        if first.intersects(affinity.translate(second, distance)):
            return True
    return False


def of_stl(data: bytes, module: float) -> Polygon:
    """The section of a written solid half way up in modules, by trimesh."""
    mesh = trimesh.load(BytesIO(data), file_type="stl", process=False)
    mesh.apply_scale(1.0 / module)
    mesh.merge_vertices()
    section = mesh.section([0, 0, 1], [0, 0, mesh.bounds[:, 2].mean()])
    flat, to_world = section.to_2D(np.eye(4))
    assert to_world[:2, 3] == pytest.approx(0.0, abs=1e-9)
    return Polygon(max(flat.polygons_full, key=lambda one: one.area).exterior)


def of_dxf(data: bytes, module: float) -> Polygon:
    """The outline of a drawing in modules, by ezdxf."""
    entities = ezdxf.read(StringIO(data.decode())).modelspace()
    (outline,) = entities.query('LWPOLYLINE[layer=="OUTLINE"]')
    points = np.array([(point.x, point.y) for point in make_path(outline).flattening(1e-5 * module)])
    return Polygon(points / module)


def read_back(drive: Drive) -> dict[str, tuple[Polygon, Polygon]]:
    module = drive.pitch.size.module_mm
    drawings = dxf_files(pair_drawings(drive))
    stl = tuple(of_stl(stl_bytes(drive.solids.of(gear).mesh), module) for gear in Gear)
    dxf = tuple(of_dxf(drawings[f"{gear.value}.dxf"], module) for gear in Gear)
    table = tuple(Polygon(drive.teeth.of(gear).outline_mm / module) for gear in Gear)
    return {"stl": stl, "dxf": dxf, "csv": table}  # type: ignore[dict-item]


@pytest.mark.slow
@pytest.mark.parametrize("module", [1e-6, 1e-3, 0.02, 0.1, 2.0, 1e3], ids="{:g}".format)
def test_written_gears_overlap_by_their_tolerance_at_most(module: float) -> None:
    """1.1 chord tolerances of 0.002 modules, and what single precision adds."""
    drive = drive_of(scaled(OVAL, module))
    distance = drive.pitch.center_distance_mm / module
    for outlines in read_back(drive).values():
        assert not overlaps(outlines, distance, 0.0022 + SINGLE)


@pytest.mark.thorough
def test_a_tolerance_in_millimetres_lets_small_gears_overlap(monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative control: 0.005 mm are a quarter of a module of 0.02 mm, and shapely sees the teeth in each other."""
    monkeypatch.setattr(machine, "CHORD_IN_MODULES", 1.0)
    drive = drive_of(scaled(OVAL, 0.02))
    assert drive.chord_tolerance_mm == 0.005
    outlines, distance = read_back(drive), drive.pitch.center_distance_mm / 0.02
    assert overlaps(outlines["csv"], distance, 0.01)
    assert overlaps(outlines["stl"], distance, 0.01)


class TestTolerances:
    @pytest.mark.parametrize(
        ("module", "chord"), [(0.3, 0.0006), (2.4, 0.0048), (2.6, 0.005), (40.0, 0.005), (400.0, 0.04)]
    )
    def test_the_default_is_the_lesser_of_a_length_and_a_share_of_the_module(self, module: float, chord: float) -> None:
        assert drive_of(scaled(OVAL, module)).chord_tolerance_mm == pytest.approx(chord, rel=1e-12)

    @pytest.mark.parametrize(
        ("given", "right"), [(0.03, "0.025 mm or less is right"), (1e-8, r"\de-07 mm or more is right")]
    )
    def test_what_is_out_of_proportion_is_refused(self, given: float, right: str) -> None:
        drive = drive_of({**scaled(OVAL, 0.5), "output": {"chord_tolerance_mm": given}})
        with pytest.raises(WrongInput, match=right) as refused:
            _ = drive.teeth
        assert refused.value.key == "output.chord_tolerance_mm"


@pytest.mark.slow
@pytest.mark.parametrize("module", [0.00012, pytest.param(310.0, marks=pytest.mark.long)])
def test_the_command_tells_sizes_of_any_gear(module: float, run: Run, tmp_path: Path) -> None:
    """Sizes in assembly.json have digits, and the screen fits; what a kernel cannot hold is refused by key."""
    text = json.dumps(scaled(OVAL, module))
    (tmp_path / "own.yaml").write_text(text, encoding="utf-8")
    status, said, err = run("build", "own.yaml", "--out", "made", "--report")
    assert (status, [line for line in err.splitlines() if "workshop" not in line]) == (0, [])
    assert max(map(len, said.splitlines())) <= COLUMNS
    pose = json.loads((tmp_path / "made" / "assembly.json").read_text(encoding="utf-8"))
    size = json.loads((tmp_path / "made" / "summary.json").read_text(encoding="utf-8"))["pitch"]
    assert pose["center_distance_mm"] == pytest.approx(size["center_distance_mm"], rel=1e-7)
    assert pose["driving"]["pitch_radius_mm"] + pose["driven"]["pitch_radius_mm"] == pytest.approx(
        pose["center_distance_mm"], rel=2e-7
    )
    if module < 0.01:
        status, _, err = run("build", "own.yaml", "--format", "step")
        assert status == 2
        assert "gears.module_mm: the module of 0.00012 mm is too small for exact faces" in err


@pytest.mark.slow
def test_a_slot_about_whose_axis_no_pin_has_room_is_refused() -> None:
    """A pin and a clearance that are thicker than their distance from the axis, as of a design scaled down."""
    data = deepcopy(CASES["sector"])
    data["gears"]["driving"] = {"end_stop": {"pin_mm": 0.1, "radius_mm": 0.02, "clearance_mm": 0.2}}
    with pytest.raises(WrongInput, match=r"a slot of 0\.3 mm for a turn of 180 deg, 0.02 mm from the axis"):
        _ = drive_of(data).solids
