"""Lands that would fold: refused with gear, tooth, radius and angle, from the radius itself on."""

from __future__ import annotations

import re
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

from ncgear.errors import NoSuchMechanism
from ncgear.pitch.pair import sized_pair
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import ratio_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.flank import Flanks, flanks_of
from ncgear.teeth.form import ToothForm
from ncgear.teeth.gear import toothed_pair
from ncgear.teeth.sides import refuse_folded_lands, refuse_sharp_places, regular_sides
from ncgear.teeth.spaces import roots_of
from ncgear.teeth.tips import Tips, tip_crossing
from ncgear.teeth.tool import RackLine
from pairs import baler_law, pitch_pair, rack, sine_law

MODULE = 2.0


def ended(own: Flanks) -> Tips:
    """Tips that end where the flanks do."""
    top, at, met = tip_crossing(own)
    assert met.all()
    return Tips(own, top, at, np.zeros(own.count, dtype=int), ~met, np.full(own.count, np.inf))


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_root_land_of_a_circular_gear_folds_at_its_radius(share: float) -> None:
    """Of six teeth the radius is three modules; a rack's tip is put just above and below the axis."""
    curve = pitch_pair(uniform_law(Lobes()), 6).driving
    depth = share * 3.0
    own = flanks_of(curve, rack(5.1, dedendum=depth, root_radius=0.1), 6, RackLine(), 0.0)
    roots = roots_of(own)
    folding, limit = roots.folding(np.arange(6), roots.lands()[0])
    assert folding == pytest.approx(depth * MODULE, rel=1e-9)
    assert limit == pytest.approx(6.0, rel=1e-9)
    with (
        nullcontext()
        if share < 1.0
        else pytest.raises(NoSuchMechanism, match="root of the space after tooth 1 ") as caught
    ):
        refuse_folded_lands(own, regular_sides(ended(own))[0])
    if caught is not None:
        assert f"radius of {6.0:.4g} mm" in caught.value.problem
        assert f"depth of {depth * MODULE:.4g} mm" in caught.value.problem


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_tip_land_folds_at_the_hollows_radius(share: float) -> None:
    """The height is put just below and above the least radius of the hollow in whose middle tooth 1 stands."""
    curve, radius = (
        pitch_pair(sine_law(0.3), 26).driving,
        pitch_pair(sine_law(0.3), 26).least_concave_radius_mm(Gear.DRIVING),
    )
    assert radius is not None
    low = flanks_of(curve, rack(addendum=0.05), 26, RackLine(), 0.0)
    sides = regular_sides(ended(low))[0]
    high = replace(low, tip_height_mm=np.full(low.count, share * radius))
    with nullcontext() if share < 1.0 else pytest.raises(NoSuchMechanism, match="hollow with a radius of") as caught:
        refuse_folded_lands(high, sides)
    if caught is not None:
        assert f"{radius:.4g} mm" in caught.value.problem
        assert "phi1 = 0 rad" in caught.value.problem
        assert "of tooth 1 there" in caught.value.problem


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "teeth"),
    [(baler_law(), 6), (elliptical_law(0.3, 0.0, Lobes(3, 1)), 9), (sine_law(0.3), 6)],
    ids=["baler", "3:1", "sine"],
)
def test_far_too_few_teeth_are_refused_by_tooth_and_angle(law: Transmission, teeth: int) -> None:
    with pytest.raises(NoSuchMechanism, match=r"tooth \d+ of the (driving|driven) gear .*phi1 = ") as caught:
        toothed_pair(pitch_pair(law, teeth), ToothForm(rack()), 0.01)
    assert caught.value.key == "gears.teeth"
    assert "more teeth" in caught.value.problem


@pytest.mark.parametrize(("width", "sharp"), [(2e-4, True), (0.5, False)])
def test_places_too_sharp_for_any_flank_are_refused_however_short(width: float, sharp: bool) -> None:
    """A dent of 2.5 micrometres stands between the probes of every flank; its radius by (r - r'')/r^2 in its middle."""
    law = ratio_expression_law(f"1 - 8e-5*exp(-((phi - 2.4)/{width})**2)", Lobes(), scale_to_close=True)
    pitch = sized_pair(law, 40, 3.0, None)
    if not sharp:
        refuse_sharp_places(pitch)
        return
    radius = pitch.center_distance_mm / (2.0 * (1.0 + 2.0 * 8e-5 / width**2 / 2.0))
    with pytest.raises(NoSuchMechanism, match="no flank rolls over that") as caught:
        toothed_pair(pitch, ToothForm(rack(module=3.0)), 0.01)
    found = re.search(r"radius of ([\d.]+) mm at phi1 = 2\.4 rad", caught.value.problem)
    assert found is not None
    assert float(found[1]) == pytest.approx(radius, rel=1e-3)
