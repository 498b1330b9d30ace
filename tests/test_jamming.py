"""The estimate of a build beside the assemblies that ncgear tolerance draws, and what the advice about it says."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from functools import cache
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest

import ncgear
from at_once import at_once
from drives import design_of, drive, loaded
from ncgear.design.keys.tolerances import AssemblyTolerances, GearTolerances, Temperatures
from ncgear.errors import DesignError
from ncgear.figures.advice.teeth_advice import jams
from ncgear.figures.advice.values import Advice, Kind, NotJudged
from ncgear.numerics.arrays import Array
from ncgear.project.drive import Drive
from ncgear.project.tolerance import lot_of
from ncgear.project.tolerance_limits import (
    Process,
    backlash_needed,
    jamming_of,
    left_of_backlash,
    limits_of,
    process_of,
    tolerances_of,
)
from ncgear.tolerances.estimate import EstimatedBacklash, Teeth, enough, needed, plays_of
from ncgear.tolerances.study import Workers, assemblies_of, drawn_evenly

SAMPLES = 2048
SHARE_OFF, BACKLASH_OFF = 0.08, 0.10
"""How far the estimate may be off the drawn assemblies: in the share, at every backlash, and in the part of what is
enough for 99 in a hundred, or by NEAR_MM where that is little."""

NEAR_MM = 0.007


def toleranced(name: str, tolerances: AssemblyTolerances | None) -> Drive:
    """A worked design with other tolerances; None leaves those that it has."""
    design = loaded(name).design
    return drive(name) if tolerances is None else Drive(design.model_copy(update={"tolerances": tolerances}))


def drawn_needs(one: Drive) -> Array:
    """The backlash that each of many drawn assemblies of a machine needs, as ncgear tolerance finds it."""
    lot = lot_of(one, tolerances_of(one)[0])
    found = assemblies_of(lot, drawn_evenly(SAMPLES, 3, len(lot.pairs)), Workers())
    left = [left_of_backlash(p, own.least_play_rad) for p, own in zip(one.by_stage, found.pairs, strict=True)]
    return -np.minimum.reduce(left)


def off(of_pairs: tuple[EstimatedBacklash, ...], drawn: Array) -> tuple[float, float]:
    """How far shares and the backlash that is enough are off those of drawn assemblies."""
    places = np.quantile(drawn, np.linspace(0.02, 0.99, 30))
    shares = [1.0 - np.prod([1.0 - one.jammed(given) for one in of_pairs]) for given in places]
    true = np.array([np.mean(drawn > given) for given in places])
    size = float(np.quantile(drawn, 0.99))
    return float(np.abs(shares - true).max()), abs(enough(of_pairs, 0.99) - size) / max(size, NEAR_MM / BACKLASH_OFF)


def both(**own: float) -> dict[str, GearTolerances]:
    return {"driving": GearTolerances(**own), "driven": GearTolerances(**own)}


OTHERS = {
    "fine": AssemblyTolerances(grade=5, center_distance_mm=0.01, **both(eccentricity_mm=0.004)),
    "coarse": AssemblyTolerances(grade=10, center_distance_mm=0.06, **both(eccentricity_mm=0.045, tilt_deg=0.07)),
    "worn": AssemblyTolerances(grade=7, center_distance_mm=0.025, **both(eccentricity_mm=0.02, wear_mm=0.035)),
    "warm": AssemblyTolerances(
        grade=8,
        center_distance_mm=0.02,
        temperature=Temperatures(least_c=-15, largest_c=45, warmer_k=5),
        housing_expansion_um_m_k=23.5,
        **both(eccentricity_mm=0.03),
    ),
    "printed": AssemblyTolerances(
        center_distance_mm=0.08, **both(single_pitch_mm=0.06, profile_mm=0.03, eccentricity_mm=0.05)
    ),
}

USUAL_CASES = [
    (name, "usual")
    for name in (
        "pusher",
        "ellipse",
        "internal-1-2",
        "helical-ellipse",
        "asymmetric-ellipse",
        "baler-66-two-stage",
        "rack-feed",
        "desk-toy",
        "baler-real",
        "oval-flow-meter",
        "log-generator",
        "rounded-square",
    )
]
OTHER_CASES = [
    (name, kind) for name in ("pusher", "internal-1-2", "helical-ellipse", "spiral-pair", "pump-1-2") for kind in OTHERS
]


@pytest.mark.slow
@pytest.mark.judges("tolerances")
@pytest.mark.parametrize(
    ("name", "kind"),
    [
        pytest.param(*case, marks=[pytest.mark.long] * (number % 5 > 0))
        for number, case in enumerate(USUAL_CASES + OTHER_CASES)
    ],
)
def test_the_estimate_is_near_to_what_is_drawn(name: str, kind: str) -> None:
    one = toleranced(name, OTHERS.get(kind))
    share, backlash = off(backlash_needed(one), drawn_needs(one))
    assert share < SHARE_OFF
    assert backlash < BACKLASH_OFF


@cache
def of_the_scotch_yoke() -> tuple[Drive, Array]:
    one = toleranced("scotch-yoke-pump", OTHERS["coarse"])
    return one, drawn_needs(one)


def teeth_of(one: Drive, **changed: Any) -> Teeth:
    limits = replace(limits_of(one, tolerances_of(one)[0]), **changed)
    return Teeth(one.teeth, one.designed_contact, limits, one.gears.face_width_mm, 0.0, False)


@pytest.mark.slow
@pytest.mark.parametrize("forgotten", ["pitch_mm", "profile_mm", "eccentricity_mm", "center_distance_mm"])
def test_an_estimate_that_forgets_a_source_is_off(forgotten: str) -> None:
    """Negative control: each source counts for so much that the bounds see it, and with all of them they are kept."""
    one, drawn = of_the_scotch_yoke()
    none: Any = {"eccentricity_mm": (0.0, 0.0), "center_distance_mm": 0.0}.get(
        forgotten, np.zeros(limits_of(one, OTHERS["coarse"]).flanks)
    )

    def of(teeth: Teeth) -> tuple[float, float]:
        plays = plays_of(teeth, 0)
        return off((needed(-left_of_backlash(one, plays.least_rad), plays.shared),), drawn)

    share, backlash = of(teeth_of(one))
    assert share < SHARE_OFF
    assert backlash < BACKLASH_OFF
    share, backlash = of(teeth_of(one, **{forgotten: none}))
    assert share > SHARE_OFF or backlash > BACKLASH_OFF


# --- the distribution ------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_what_is_enough_is_enough_for_the_share_and_no_less() -> None:
    """By the share itself, with the confidence taken off: its backlash rises to nothing as numbers grow."""
    own = EstimatedBacklash(np.linspace(-0.01, 0.02, 100_000), 0.004)
    value = enough([own], 0.98)
    assert 1.0 - own.jammed(value) == pytest.approx(0.98, abs=2e-3)
    assert enough([own, own], 0.98) > value
    assert 1.0 - (1.0 - own.jammed(0.012)) ** 2 > own.jammed(0.012) > own.jammed(0.02)


def test_nothing_is_needed_where_nothing_deviates() -> None:
    assert enough([needed(np.full(200, -0.02), np.zeros((3, 200)))], 0.999) == 0.0
    assert needed(np.full(200, -0.02), np.zeros((3, 200))).jammed(0.0) == 0.0


def test_what_all_positions_share_is_told_from_the_rest() -> None:
    random = np.random.default_rng(5)
    shared = np.stack([0.03 * (random.random(300) - 0.5), random.random(300), np.zeros(300)])
    rest = 0.002 * np.array([NormalDist().inv_cdf(one) for one in random.random(300)])
    found = needed(0.01 - 0.7 * shared[0] + 0.02 * shared[1] + rest, shared)
    assert found.deviation == pytest.approx(0.002, rel=0.1)
    assert found.shared == pytest.approx(0.01 - 0.7 * shared[0] + 0.02 * shared[1], abs=5e-4)


# --- the advice ------------------------------------------------------------------------------------------------

SMALL: dict[str, Any] = {
    "name": "small",
    "linkage": {"crank_mm": 40, "rod_mm": 150},
    "operation": {"speed_rpm": 90},
    "motion": {"law": "ellipse", "eccentricity": 0.3},
    "gears": {"teeth": 31, "module_mm": 2, "face_width_mm": 12},
}


def small(**gears: Any) -> Drive:
    data = deepcopy(SMALL)
    data["gears"].update(gears)
    return Drive(design_of(data))


@pytest.mark.slow
def test_gears_without_backlash_jam_and_with_the_advised_one_do_not() -> None:
    found = jams(small())
    assert isinstance(found, Advice)
    assert (found.kind, found.matters) == (Kind.JAMS, True)
    ((change,),) = (remedy.changes for remedy in found.remedies)
    assert change.key == "gears.backlash_mm"
    assert isinstance(change.value, float)
    assert jams(small(backlash_mm=change.value)) is None
    assert isinstance(jams(small(backlash_mm=0.5 * change.value)), Advice)


@pytest.mark.slow
def test_teeth_that_are_made_thinner_need_no_backlash() -> None:
    """Where the limits of their thickness leave more room than the advised backlash; with a tenth of it they jam."""
    enough_mm = jamming_of(small()).enough
    for share, turns in ((1.0, True), (0.1, False)):
        thickness = {"tooth_thickness_upper_mm": -share * enough_mm, "tooth_thickness_lower_mm": -share * enough_mm}
        assert (jams(small(tolerances=thickness)) is None) is turns


@pytest.mark.slow
@pytest.mark.parametrize("key", ["backlash_mm", "backlash_deg"])
def test_a_backlash_of_0_that_is_written_down_is_wanted(key: str) -> None:
    found = jams(small(**{key: 0.0}))
    assert isinstance(found, NotJudged)
    assert "the exact pair jam" in found.why


@pytest.mark.slow
def test_degrees_are_told_where_the_file_has_them() -> None:
    """The advised angle times the least arm of the idle flanks is about the advised backlash in mm."""
    in_mm = jamming_of(small(backlash_mm=0.01))
    in_degrees = jamming_of(small(backlash_deg=0.01))
    arm = small(backlash_mm=1.0).play.least_normal_mm.value / small(backlash_mm=1.0).play.driven_rad
    assert in_degrees.key == "gears.backlash_deg"
    assert np.radians(in_degrees.enough) * arm == pytest.approx(in_mm.enough, abs=0.006)


@pytest.mark.thorough
def test_teeth_that_no_grade_knows_are_not_judged() -> None:
    found = jams(small(module_mm=0.3, driving={"bore_mm": 1}, driven={"bore_mm": 1}))
    assert isinstance(found, NotJudged)
    assert "module" in found.why


def test_teeth_too_small_for_the_backlash_are_told_another_way() -> None:
    found = jams(small(module_mm=0.1, teeth=60, first_layer_chamfer_mm=0.01))
    assert isinstance(found, Advice)
    assert [remedy.changes for remedy in found.remedies] == [()]


@pytest.mark.slow
@pytest.mark.parametrize(("width_mm", "backlash_mm"), [(5000.0, None), (5000.0, 0.05), (900.0, 0.05)])
def test_gears_too_wide_for_any_backlash_are_told_the_width_that_turns(
    width_mm: float, backlash_mm: float | None
) -> None:
    """Tilted by 0.02 deg, teeth 5 m wide are 1.7 mm off at an end: larger ones are no help.  A wider face jams."""
    given = {} if backlash_mm is None else {"backlash_mm": backlash_mm}
    found = jams(small(face_width_mm=width_mm, module_mm=1.5, **given))
    assert isinstance(found, Advice)
    changes = {one.key.removeprefix("gears."): one.value for one in found.remedies[0].changes}
    told = {key: value for key, value in changes.items() if isinstance(value, float)}
    assert told["face_width_mm"] < width_mm
    assert told.get("backlash_mm", backlash_mm) <= 0.375
    turned = {"module_mm": 1.5, **given, **told}
    assert jams(small(**turned)) is None
    wider = jams(small(**{**turned, "face_width_mm": 1.5 * told["face_width_mm"]}))
    assert isinstance(wider, Advice)


@pytest.mark.slow
@pytest.mark.parametrize(("eccentricity_mm", "fits"), [(0.3, True), (3.0, False)])
def test_a_backlash_with_which_teeth_are_pointed_is_not_advised(eccentricity_mm: float, fits: bool) -> None:
    """It leaves some of each tooth at the pitch curve, and yet the teeth with it are refused."""
    data = {**deepcopy(SMALL), "motion": {"law": "harmonic_ratio", "cosine": [-0.2]}}
    data["gears"] = {"teeth": 48, "module_mm": 1.5, "face_width_mm": 12, "backlash_mm": 0.05}
    data["tolerances"] = {"driving": {"wear_mm": 0.5}, "driven": {"eccentricity_mm": eccentricity_mm}}
    found = jamming_of(ncgear.Drive(design_of(data)))
    data["gears"]["backlash_mm"] = found.enough
    wider = ncgear.Drive(design_of(data))
    assert wider.play.driven_rad > 0.0
    assert found.fits is fits
    if fits:
        assert wider.teeth
    else:
        with pytest.raises(DesignError, match="pointed"):
            _ = wider.teeth


@at_once(
    ("gears", "process"),
    [
        ({}, Process.GENERATED),
        ({"material": {"driving": "42CrMo4", "driven": "PLA-print"}}, Process.PRINTED),
        ({"process_clearance_mm": 0.05}, Process.PRINTED),
        ({"process_clearance_mm": -0.1}, Process.CUT),
        ({"cutter": {"kind": "mate"}}, Process.CUT),
        ({"cutter": {"kind": "pinion"}}, Process.GENERATED),
    ],
)
def test_the_process_is_told_by_the_file(gears: dict[str, Any], process: Process) -> None:
    assert process_of(small(**gears)) is process


@pytest.mark.slow
def test_concave_gears_and_rings_are_not_hobbed() -> None:
    assert process_of(drive("internal-1-2")) is Process.CUT
    assert process_of(drive("baler")) is Process.CUT
    assert process_of(drive("baler-66-two-stage").by_stage[1]) is Process.GENERATED


@pytest.mark.slow
def test_finer_tolerances_of_the_file_need_less() -> None:
    loose = jamming_of(small())
    data = {**deepcopy(SMALL), "tolerances": {"grade": 5, "center_distance_mm": 0.01}}
    fine = jamming_of(ncgear.Drive(design_of(data)))
    assert fine.process is None
    assert fine.enough < loose.enough
