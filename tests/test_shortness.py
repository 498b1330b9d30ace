"""Flanks that lose contact: refused with the teeth and what limits them, and only where no flanks touch indeed."""

from __future__ import annotations

import numpy as np
import pytest
from shapely import Polygon

from engaged import designed, made
from ncgear.contact.designed.as_designed import AsDesigned, pairs_under_load
from ncgear.contact.pair import SidesInContact, refuse_short_contact, short_contacts
from ncgear.errors import NoSuchMechanism
from ncgear.teeth.form import TipRelief
from ncgear.teeth.gear import ToothedPair
from oracles import meshing

FINE = 2e-4
"""Chord tolerance in mm of outlines that shapely judges: corners take over within some micrometres."""

REFUSED = [
    (24, r"no flanks touch at phi1 = .* driving tooth (\d+) and driven tooth (\d+) .* would undercut the mate"),
    (
        25,
        r"no flanks touch at phi1 = .* driving tooth (\d+) and driven tooth (\d+) .* would slope too much.* would foul",
    ),
    (37, r"no flanks touch at phi1 = .* driving tooth (\d+) and driven tooth (\d+) .* would foul the mate's tips"),
]
"""phi1 - 0.3 sin 2 phi1 by teeth: the driven nose, or the driving bowl, leaves flanks too short."""


def refuse(name: str, teeth: int, least: float) -> None:
    judge(designed(name, teeth), made(name, teeth)[1], least)


def judge(contact: AsDesigned, pair: ToothedPair, least: float, loaded: SidesInContact | None = None) -> None:
    """Refuse what either side of the teeth lacks."""
    refuse_short_contact(short_contacts(contact, pair, least, 0.0, loaded), both_ways=True)


@pytest.mark.slow
@pytest.mark.parametrize(("teeth", "message"), REFUSED)
def test_a_pair_that_loses_contact_is_refused_with_its_teeth_and_limits(teeth: int, message: str) -> None:
    with pytest.raises(NoSuchMechanism, match=message) as caught:
        refuse("deep sine", teeth, 1.0)
    assert caught.value.key == "gears.least_contact_ratio"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "teeth"),
    [
        pytest.param("deep sine", 72, marks=pytest.mark.slow),
        ("baler", 25),
        ("baler", 86),
        pytest.param("deep sine", 48, marks=pytest.mark.slow),
        pytest.param("deep sine", 144, marks=pytest.mark.slow),
    ],
)
def test_hard_pairs_that_are_made_keep_the_law_on_both_sides(name: str, teeth: int) -> None:
    refuse(name, teeth, 1.0)
    contact = designed(name, teeth)
    for side in (contact.pushing, contact.back):
        assert side.transmission_error_rad <= 1e-10
        assert side.simultaneous.min() >= 1
    assert contact.overlap_mm.max() == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [24, 37])
def test_flanks_that_are_refused_do_stand_apart(teeth: int) -> None:
    """By shapely on fine outlines, where the refusal says that no flanks touch: corners hold the gears, off the law."""
    pitch, pair = made("deep sine", teeth, FINE)
    contact = designed("deep sine", teeth)
    side = contact.pushing if contact.pushing.simultaneous.min() == 0 else contact.back
    row = int(np.argmax(np.abs(side.error_rad) * side.first.lever_mm))
    assert side.simultaneous[row] == 0
    assert abs(side.error_rad[row]) * side.first.lever_mm[row] > 20.0 * FINE
    phi1 = contact.placement.phi1_rad[row : row + 1]
    phi2 = pitch.transmission.driven_angle(phi1).value
    outlines = Polygon(pair.driving.outline_mm), Polygon(pair.driven.outline_mm)
    back, on = meshing.Pair(*outlines, phi1, phi2, pitch.center_distance_mm).driven_play(0, tolerance=1e-6)
    expected = contact.pushing.error_rad[row], contact.back.error_rad[row]
    assert (-back, on) == pytest.approx(expected, abs=3.0 * FINE / contact.placement.driven_radius_mm[row])


@pytest.mark.slow
def test_a_least_ratio_over_one_names_the_shortest_contact() -> None:
    shortest = min(side.pairs.arcs.min() for side in (designed("baler", 25).pushing, designed("baler", 25).back))
    refuse("baler", 25, float(shortest))
    with pytest.raises(
        NoSuchMechanism, match=rf"touch over {shortest:.3g} pitches only, less than {shortest + 0.1:.3g}"
    ):
        refuse("baler", 25, float(shortest) + 0.1)


def test_flanks_that_a_relief_holds_apart_do_not_count_unless_a_load_closes_it() -> None:
    relief = TipRelief(0.05, 0.4, 2.0)
    contact, (_, pair) = designed("ellipse", 25, relief=relief), made("ellipse", 25, relief=relief)
    judge(contact, pair, 1.0)
    with pytest.raises(NoSuchMechanism, match=r"touch over 1\.0\d pitches only.* reach over 1\.6.*; less tip relief"):
        judge(contact, pair, 1.2)
    closed = pairs_under_load(pair, contact.placement, contact.pushing.error_rad - 1e-2)[0]
    judge(contact, pair, 1.2, loaded=(closed, closed))
    with pytest.raises(NoSuchMechanism, match=r"touch over 1\.6\d* pitches only, less than 1\.7: the driving tip ends"):
        judge(contact, pair, 1.7, loaded=(closed, closed))


@pytest.mark.slow
@pytest.mark.parametrize(("undercut", "pitches"), [(False, "1.16"), (True, "0.83")])
def test_the_published_baler_touches_over_as_many_pitches_as_the_method_says(undercut: bool, pitches: str) -> None:
    """25 teeth with shortened tips, and undercut by a tool of full depth: docs/method.md."""
    contact = designed("baler", 25, undercut=True) if undercut else designed("baler", 25)
    assert f"{min(side.pairs.arcs.min() for side in (contact.pushing, contact.back)):.2f}" == pitches
    assert min(side.simultaneous.min() for side in (contact.pushing, contact.back)) == (0 if undercut else 1)


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [24, 37])
def test_below_one_nothing_is_asked(teeth: int) -> None:
    refuse("deep sine", teeth, 0.99)


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [24, 37])
def test_what_idle_flanks_lack_is_refused_only_where_they_are_to_hold(teeth: int) -> None:
    short = short_contacts(designed("deep sine", teeth), made("deep sine", teeth)[1], 1.0)
    assert None not in short
    with pytest.raises(NoSuchMechanism, match="drives: both_ways"):
        refuse_short_contact((None, short[1]), both_ways=True)
    refuse_short_contact((None, short[1]), both_ways=False)
    with pytest.raises(NoSuchMechanism):
        refuse_short_contact((short[0], None), both_ways=False)
