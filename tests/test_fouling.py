"""What tips run into on concave stretches: paths against teeth by shapely, reaches by how pitch curves part."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from ncgear.pitch.pair import sized_pair
from ncgear.teeth.flank import Flanks, flanks_of, mating_flanks
from ncgear.teeth.fouling import CLEAR, PLACES, _parted_mm, _reach_mm, _running_into, paths_near_concave
from ncgear.teeth.tool import RackLine
from pairs import rack, sine_law

pytestmark = pytest.mark.judges("teeth")


def concave_gears() -> tuple[Flanks, Flanks]:
    pitch = sized_pair(sine_law(0.2), 30, 2.0, None)
    return flanks_of(pitch.driving, rack(), 30, RackLine(), 0.0), flanks_of(pitch.driven, rack(), 30, RackLine(), 3.0)


@pytest.mark.parametrize("beside", [0, 1])
def test_paths_run_into_the_teeth_that_they_cross(beside: int) -> None:
    """Of random polylines, those of the path's number and of its neighbours, also around the seam."""
    generator = np.random.default_rng(2)
    middles = 10.0 * np.exp(2j * np.pi * np.arange(12) / 12)
    teeth = middles[:, None] + generator.normal(size=(12, 6)) + 1j * generator.normal(size=(12, 6))
    number = np.arange(40) % 12
    paths = middles[number, None] + 2.0 * (generator.normal(size=(40, 5)) + 1j * generator.normal(size=(40, 5)))
    lines = [shapely.LineString(np.stack([one.real, one.imag], axis=-1)) for one in teeth]
    wanted = [
        any(
            shapely.LineString(np.stack([path.real, path.imag], axis=-1)).crosses(lines[(own + off) % 12])
            for off in range(-beside, beside + 1)
        )
        for path, own in zip(paths, number, strict=True)
    ]
    shaped = (np.stack([array.real, array.imag], axis=-1) for array in (paths, teeth))
    found = _running_into(*shaped, number, beside)
    assert found.tolist() == wanted
    assert 0 < sum(wanted) < 40


def test_paths_that_are_followed_are_those_beside_a_hollow() -> None:
    """Of either curve, within a reach beyond which the tips of both gears have parted."""
    gears = concave_gears()
    mates = mating_flanks(30, 30)
    reach = _reach_mm(*gears)
    far = CLEAR * sum(float(one.tip_height_mm.max()) for one in gears)
    sigma = np.arange(0.0, gears[0].curve.length_mm, gears[0].rack.pitch_mm / PLACES)
    hollow = np.any([one.curve.at_length(sigma).curvature < 0.0 for one in gears], axis=0)
    half = gears[0].curve.length_mm / 2.0
    assert 0 < hollow.sum() < hollow.size
    parted = [
        _parted_mm(*gears, sigma[hollow], np.array([-way, way]))
        for way in (reach, reach - gears[0].rack.pitch_mm / PLACES)
    ]
    assert reach == half or parted[0].min() >= far > parted[1].min()
    (first, second) = paths_near_concave(gears, (mates, mates[::-1]))
    for own, other, found in ((gears[0], gears[1], first), (gears[1], gears[0], second)):
        places = own.crossing_mm[:, None] + np.linspace(-reach, reach, 401)
        near = np.any([one.curve.at_length(places).curvature < 0.0 for one in (own, other)], axis=(0, 2))
        assert sorted(set(found.own.tolist())) == np.flatnonzero(near).tolist()
