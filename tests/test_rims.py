"""Walls under the roots of teeth, by hand on circular gears, and what they do to root stress: Y_B of ISO 6336-3."""

from __future__ import annotations

from math import log

import numpy as np
import pytest

from drives import drive_of_text
from ncgear.errors import WrongInput
from ncgear.figures.advice import strength_advice
from ncgear.figures.advice.values import NotJudged
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.rough_strength import rough_strength, tooth_plan
from ncgear.strength.holding import Damage

TEXT = """\
name: press
linkage: {crank_mm: 20, rod_mm: 90}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
gears: {teeth: 24, module_mm: 2, face_width_mm: 12, driving: {bore_mm: 16}, driven: {bore_mm: 16}}
resistance: {polynomial_n: [200]}
strength: {dynamic_factor: 1.0}
"""
HEIGHT_MM, ROOT_MM = 2.25 * 2.0, 24.0 - 2.5


def made(driven: str) -> Drive:
    return drive_of_text(TEXT.replace("driven: {bore_mm: 16}", f"driven: {{{driven}}}"))


@pytest.mark.judges("solids")
def test_walls_of_circular_gears_by_hand() -> None:
    """From the root circle to the bore, its keyway (bottom or corner, by where roots are), and a web's pockets."""
    plain, key, web, bare = (
        made(one).rims[1]
        for one in (
            "bore_mm: 36",
            "bore_mm: 30, keyway: {width_mm: 6, depth_mm: 2.8}",
            "bore_mm: 10, web: {thickness_mm: 4, rim_mm: 4, hub_mm: 20}",
            "bore_mm: 8",
        )
    )
    assert plain.wall_mm == pytest.approx(np.full(24, ROOT_MM - 18.0), abs=2e-2)
    corner = np.hypot(15.0 + 2.8, 3.0)
    assert ROOT_MM - corner - 0.02 <= key.wall_mm.min() <= ROOT_MM - 17.8 + 0.02
    assert key.wall_mm.max() == pytest.approx(ROOT_MM - 15.0, abs=2e-2)
    assert web.wall_mm.min() == pytest.approx(4.0, abs=2e-2)
    assert bare.wall_mm == pytest.approx(np.full(24, ROOT_MM - 4.0), abs=2e-2)


@pytest.mark.slow
@pytest.mark.judges("strength")
def test_root_stresses_grow_by_the_factor_and_flanks_do_not_know_it() -> None:
    thick, thin = made("bore_mm: 16").strength, made("bore_mm: 36").strength
    raised = 1.6 * log(2.242 * HEIGHT_MM / (ROOT_MM - 18.0))
    assert raised > 1.4
    assert thin.driven.bending.stress_mpa == pytest.approx(raised * thick.driven.bending.stress_mpa, rel=5e-3)
    assert thin.driving.bending.stress_mpa == pytest.approx(thick.driving.bending.stress_mpa, rel=1e-9)
    assert thin.driven.contact is not None
    assert thick.driven.contact is not None
    assert thin.driven.contact.stress_mpa == pytest.approx(thick.driven.contact.stress_mpa, rel=1e-9)
    # A keyway weakens the teeth over it alone.
    keyed = made("bore_mm: 30, keyway: {width_mm: 6, depth_mm: 2.8}")
    weak = keyed.rims[1].factor > 1.0
    assert 0 < weak.sum() < 12
    weakened = keyed.strength.driven.bending.stress_mpa
    assert weakened == pytest.approx(keyed.rims[1].factor * thick.driven.bending.stress_mpa, rel=1e-6)


@pytest.mark.slow
def test_a_wall_thinner_than_what_is_known_is_not_judged() -> None:
    """No safety is told, and 0.5 tooth heights are asked for by the key."""
    drive = made("bore_mm: 38.9")
    assert np.all(np.isinf(drive.rims[1].factor))
    assert drive.rims[1].thinnest_mm == pytest.approx(0.5 * HEIGHT_MM)
    with pytest.raises(WrongInput, match="thinner than ISO 6336-3") as refused:
        _ = drive.strength
    assert refused.value.key == "gears.driven.bore_mm"
    found = strength_advice.strength(drive)
    assert isinstance(found, NotJudged)
    assert "thinner than ISO 6336-3 has a factor for" in found.why
    assert strength_advice.strength(made("bore_mm: 16")) is None


def test_a_check_knows_the_walls_that_keys_give() -> None:
    rims = tooth_plan(made("bore_mm: 10, web: {thickness_mm: 4, rim_mm: 4, hub_mm: 20}")).rims
    told = [float(rim(np.zeros(1))[0]) for rim in rims]
    assert told == pytest.approx((1.0, 1.6 * log(2.242 * HEIGHT_MM / 4.0)))


@pytest.mark.judges("project")
@pytest.mark.tiers(slow=["bore_mm: 46"], rest="quick")
@pytest.mark.parametrize("bore", ["bore_mm: 46", "bore_mm: 36, keyway: {width_mm: 8, depth_mm: 4.6}"])
def test_a_check_knows_the_wall_over_a_bore_of_gears_that_are_not_round(bore: str) -> None:
    """Its least wall is that under the teeth's own roots, and its safety that of the teeth."""
    text = TEXT.replace("teeth: 24, module_mm: 2", "teeth: 31, module_mm: 2, material: 42CrMo4")
    text = text.replace("uniform_crank", "harmonic_ratio, cosine: [0.2]").replace("bore_mm: 16", bore, 1)
    one = drive_of_text(text)
    (driving, _), (rim, _), phi1 = tooth_plan(one).rims, one.rims, np.linspace(0.0, 2.0 * np.pi, 2001)
    assert float(driving(phi1).max()) > 1.0
    # No root need stand where the wall is the thinnest, as over a corner of the keyway.
    assert 0.98 < float(driving(phi1).max()) / rim.factor.max() < 1.06
    found = rough_strength(one)
    assert found is not None
    rough = min(tooth.safety for tooth in found.safeties if tooth.damage is Damage.BENDING)
    exact = min(one.strength.of(gear).bending.safety_min for gear in Gear)
    assert rough / exact == pytest.approx(1.0, abs=0.15)


def test_a_check_does_not_judge_walls_that_nothing_is_known_of() -> None:
    found = strength_advice.rough(made("bore_mm: 10, web: {thickness_mm: 4, rim_mm: 0.3, hub_mm: 20}"))
    assert isinstance(found, NotJudged)
    assert "a wall of 0.3 mm of the driven gear is thinner than ISO 6336-3" in found.why
