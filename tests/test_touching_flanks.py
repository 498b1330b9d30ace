"""The contact ratio beside a count of touching flanks on fine outlines, which shares no code with the contact rooms."""

from __future__ import annotations

from dataclasses import replace
from math import lcm, pi

import numpy as np
import pytest

from engaged import MODULE, designed, made
from loaded import frictionless, meshing
from ncgear.contact.designed.as_designed import as_designed, pairs_under_load
from ncgear.contact.designed.flanks import TOUCHING_IN_PITCHES, PairsInContact
from ncgear.contact.placement import placed
from ncgear.dynamics.quasi_static import LoadedContact, loaded_contact
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair
from ncgear.teeth.form import TipRelief, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from oracles.touching_flanks import gear, poses, touching
from pairs import rack

CHORDS_MM = 2e-5
"""Chord tolerance of the outlines that are counted on: a fiftieth of the distance at which flanks count as touching."""

POSITIONS = 400
GOLDEN = 0.6180339887498949

SLACK = 0.01
"""What the ends of each arc may fall between two of some twenty positions in a pitch, on average over all arcs."""

LIGHT, DEEP = TipRelief(0.004, 1.2, MODULE), TipRelief(0.05, 0.4, MODULE)


def positions(pitch: PitchPair) -> tuple[Array, Array]:
    """Angles of both gears at places of the cycle that keep no step with the teeth."""
    meetings, number = lcm(pitch.size.driving_teeth, pitch.size.driven_teeth), np.arange(POSITIONS)
    pitches = number % meetings + (number * GOLDEN + 0.123) % 1.0
    phi1 = pitch.driving.driving_angle(pitches * pitch.driving.length_mm / pitch.size.driving_teeth)
    return phi1, pitch.transmission.driven_angle(phi1).value


def counted(pitch: PitchPair, pair: ToothedPair, side: float) -> tuple[Array, Array]:
    """The fewest and the most pairs of flanks that may touch on the outlines at each position."""
    ring = pitch.driven.is_ring
    gears = gear(pair.driving.outline_mm), gear(pair.driven.outline_mm, ring=ring)
    at = poses(*positions(pitch), pitch.center_distance_mm, 1.0 if ring else -1.0)
    return touching(gears, at, side, TOUCHING_IN_PITCHES * pi * MODULE, 2.0 * CHORDS_MM, 1.3 * pi * MODULE)


def agrees(pairs: PairsInContact, few: Array, many: Array) -> bool:
    """Whether the contact ratio and the least number of pairs are those that were counted."""
    mean = few.mean() - SLACK <= pairs.contact_ratio <= many.mean() + SLACK
    return bool(mean and few.min() <= pairs.fewest <= many.min())


@pytest.mark.tiers(slow=["baler-25-None"], rest="long")
@pytest.mark.parametrize(
    ("name", "teeth", "relief"),
    [
        ("uniform", 25, None),
        ("ellipse", 25, None),
        ("ellipse", 25, DEEP),
        ("ellipse", 25, LIGHT),
        ("baler", 25, None),  # shortened tips, sloped lands, concave curves
        ("baler", 25, LIGHT),
        ("deep sine", 72, None),
        ("ring", 40, None),
        ("ring", 40, DEEP),
    ],
)
def test_the_contact_ratio_is_what_a_count_on_the_outlines_finds(
    name: str, teeth: int, relief: TipRelief | None
) -> None:
    pitch, pair = made(name, teeth, CHORDS_MM, relief=relief)
    contact = designed(name, teeth, relief=relief)
    for side, found in ((1.0, contact.pushing), (-1.0, contact.back)):
        assert agrees(found.pairs, *counted(pitch, pair, side))


@pytest.mark.long
@pytest.mark.slow
def test_the_count_sees_another_relief_and_shorter_tips() -> None:
    """Negative controls: the count on outlines of other teeth is not that of these."""
    pitch, pair = made("ellipse", 25, CHORDS_MM)
    plain, relieved = designed("ellipse", 25), designed("ellipse", 25, relief=LIGHT)
    count = counted(pitch, pair, 1.0)
    assert agrees(plain.pushing.pairs, *count)
    assert not agrees(relieved.pushing.pairs, *count)
    low = toothed_pair(pitch, ToothForm(replace(rack(), addendum_mm=0.95 * MODULE)), CHORDS_MM)
    assert not agrees(plain.pushing.pairs, *counted(pitch, low, 1.0))
    assert agrees(as_designed(low, placed(pitch)).pushing.pairs, *counted(pitch, low, 1.0))


# --- under load ------------------------------------------------------------------------------------------------------


PRESSED = TipRelief(0.03, 1.2, MODULE)
"""Relief of 4 to 5 micrometres where the contact ends, at three quarters of the addendum."""


def under_load(name: str, torque_n_mm: float) -> tuple[PairsInContact, LoadedContact]:
    """Pairs of pushing flanks with relief under an even torque, and the forces at places off their positions."""
    pitch, pair = made(name, 25, relief=PRESSED)
    at, bearing = placed(pitch), frictionless(meshing(name, 25, relief=PRESSED))
    loaded = loaded_contact(bearing, at.phi1_rad, np.full(at.count, torque_n_mm), 1.0)
    phi1, _ = positions(pitch)
    phi1 = np.sort(phi1)
    return pairs_under_load(pair, at, loaded.error_rad)[0], loaded_contact(
        bearing, phi1, np.full(phi1.size, torque_n_mm), 1.0
    )


@pytest.mark.tiers(slow=["uniform"], rest="long")
@pytest.mark.parametrize("name", ["uniform", "ellipse"])
def test_pairs_under_load_are_those_that_bear_it(name: str) -> None:
    """Forces of the teeth come from tables of gaps, at other places.  More load brings more flanks into contact.

    The loads press flanks in by two and by three micrometres, less than the relief at the tips: no corner bears load.
    """
    rigid = designed(name, 25, relief=PRESSED).pushing
    ratios = [rigid.pairs.contact_ratio]
    for torque in (13.0, 33.0):
        pairs, loaded = under_load(name, torque)
        assert pairs.contact_ratio == pytest.approx(loaded.pairs.mean(), abs=2.0 * SLACK)
        assert pairs.fewest == loaded.pairs.min()
        ratios.append(pairs.contact_ratio)
    assert ratios == sorted(ratios)
    assert ratios[0] + 2.0 * SLACK < ratios[-1] <= rigid.reaches.mean() + 1e-9


@pytest.mark.thorough
def test_a_side_without_load_counts_as_rigid() -> None:
    """A load on pushing flanks brings no backs into contact; a great one closes the whole relief."""
    _, pair = made("ellipse", 25, relief=DEEP)
    contact = designed("ellipse", 25, relief=DEEP)
    resting, _ = pairs_under_load(pair, contact.placement, contact.pushing.error_rad)
    assert np.array_equal(resting.arcs, contact.pushing.pairs.arcs)
    closed, idle = pairs_under_load(pair, contact.placement, contact.pushing.error_rad - 1e-2)
    assert closed.arcs == pytest.approx(contact.pushing.reaches, abs=1e-9)
    assert np.array_equal(idle.arcs, contact.back.pairs.arcs)
