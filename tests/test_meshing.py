"""Forces of the teeth: no energy may come from the tables, whatever the gears do."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from loaded import Giving, frictionless, meshing, uneven_meshing
from ncgear.dynamics.gaps import Gaps, Near
from ncgear.dynamics.meshing import Meshing, TwoShafts

Array = np.ndarray
PAIRS = [("uniform", 24), ("sine", 31), ("baler", 25)]


def shafts(found: Meshing, count: int = 4000) -> TwoShafts:
    """Driven gears up to 4 mrad ahead of and behind the law, at speeds up to twice the law's either way."""
    random = np.random.default_rng(7)
    phi1 = random.uniform(0.0, 20.0, count)
    angle, _ = found.law.at(phi1)
    speed1, speed2 = random.uniform(-5.0, 5.0, (2, count))
    return TwoShafts(phi1, speed1, angle + random.uniform(-4e-3, 4e-3, count), speed2)


def imbalance(found: Meshing) -> Array:
    """Power of both moments, what is lost, and what is stored: their sum, relative to the largest power."""
    at, step = shafts(found), 1e-7
    forces = found.forces(at)
    given = forces.driving_n_mm.sum(axis=-1) * at.speed1_rad_s + forces.driven_n_mm.sum(axis=-1) * at.speed2_rad_s
    moved = [
        replace(at, phi1_rad=at.phi1_rad + way * at.speed1_rad_s, phi2_rad=at.phi2_rad + way * at.speed2_rad_s)
        for way in (step, -step)
    ]
    more, less = (
        found.impact.energy_n_mm(teeth.depth_mm, teeth.near.stiffness).sum(axis=-1)
        for teeth in (found.forces(there) for there in moved)
    )
    return (given + (more - less) / (2.0 * step) + forces.loss_n_mm_s.sum(axis=-1)) / np.abs(given).max()


@pytest.mark.tiers(thorough=["uniform-24"], rest="slow")
@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_moments_give_what_is_stored_and_lost(name: str, teeth: int) -> None:
    # A difference over a joint of the tables is off by as much as the slopes jump there.
    assert np.quantile(np.abs(imbalance(meshing(name, teeth))), 0.99) < 1e-7
    assert np.abs(imbalance(meshing(name, teeth))).max() < 1e-4


@pytest.mark.tiers(thorough=["uniform-24"], rest="slow")
@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_moments_give_what_is_stored_where_pairs_get_stiffer_and_softer_on_their_way(name: str, teeth: int) -> None:
    found = uneven_meshing(name, teeth)
    assert np.quantile(np.abs(imbalance(found)), 0.99) < 1e-7
    assert np.abs(imbalance(found)).max() < 1e-4


class Unfelt(Gaps):
    """A change of stiffness that the driving gear does not feel."""

    def at(self, phi1_rad: Array | float) -> Near:
        near = super().at(phi1_rad)
        return replace(near, slopes=(*near.slopes[:2], 0.0 * near.slopes[2]))


def test_a_change_of_stiffness_that_no_gear_feels_is_told_by_the_balance() -> None:
    found = uneven_meshing("uniform", 24)
    wrong = replace(found, gaps=Unfelt(*(getattr(found.gaps, one.name) for one in fields(found.gaps))))
    assert np.quantile(np.abs(imbalance(wrong)), 0.99) > 1e-5


def test_a_wrong_sign_of_the_damping_is_told_by_the_balance() -> None:
    found = meshing("uniform", 24)
    wrong = replace(found, impact=Giving(*vars(found.impact).values()))
    assert np.abs(imbalance(wrong)).max() > 0.1


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), PAIRS)
def test_what_the_teeth_take_is_never_given_back(name: str, teeth: int) -> None:
    found = meshing(name, teeth)
    assert found.forces(shafts(found)).loss_n_mm_s.min() >= 0.0


def test_a_driven_gear_behind_the_law_is_pushed_and_one_ahead_is_held() -> None:
    found = frictionless(meshing("uniform", 24), damping_n_s_mm=0.0)
    phi1 = np.linspace(0.0, 6.0, 101)
    for ahead, sense in ((-1e-3, 1.0), (1e-3, -1.0)):
        moments = found.forces(TwoShafts(phi1, 1.0, phi1 + ahead, 1.0)).driven_n_mm.sum(axis=-1)
        assert np.all(sense * moments > 0.0)


def test_without_friction_both_moments_are_in_the_ratio_of_the_law() -> None:
    """On circular gears of one size the moments are opposite but for how the lever changes along a corner's way."""
    found = frictionless(meshing("uniform", 24), damping_n_s_mm=0.0)
    phi1 = np.linspace(0.0, 6.0, 1001)
    forces = found.forces(TwoShafts(phi1, 1.0, phi1 - 1e-5, 1.0))
    driving, driven = forces.driving_n_mm.sum(axis=-1), forces.driven_n_mm.sum(axis=-1)
    assert np.median(np.abs(driving + driven) / driven) < 1e-9


def test_friction_resists_sliding_on_both_gears() -> None:
    rough, smooth = meshing("uniform", 24), frictionless(meshing("uniform", 24))
    phi1 = np.linspace(0.0, 6.0, 301)
    at = TwoShafts(phi1, 2.0, phi1 - 1e-3, 2.0)
    rubbed, free = rough.forces(at), smooth.forces(at)
    drop = [
        (rub - clean).sum(axis=-1)
        for rub, clean in ((rubbed.driving_n_mm, free.driving_n_mm), (rubbed.driven_n_mm, free.driven_n_mm))
    ]
    assert np.all(2.0 * (drop[0] + drop[1]) <= 1e-9)
    lost = (rubbed.loss_n_mm_s - free.loss_n_mm_s).sum(axis=-1)
    np.testing.assert_allclose(-2.0 * (drop[0] + drop[1]), lost, rtol=1e-9, atol=1e-9)
