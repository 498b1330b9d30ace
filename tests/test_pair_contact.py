"""Contact as written against contact as designed: bounds, convergence, and outlines that must not pass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import cos, radians, sqrt

import numpy as np
import pytest
from shapely import Polygon

from drives import drive
from engaged import MODULE, TOLERANCE, designed, least_driven_radius, made, outlines, read, written
from ncgear.contact.pair import PairContact, pair_contact, refuse_bad_outlines
from ncgear.contact.placement import placed
from ncgear.contact.written.as_written import Outlines, as_written, reach_mm
from ncgear.errors import NoSuchMechanism
from ncgear.pitch.shape import Gear
from ncgear.teeth.flank import Flanks

ALPHA = radians(20.0)

Array = np.ndarray

PAIRS = [("uniform", 25), ("uniform 1:2", 24), ("ellipse", 37), ("sine", 25), ("long ellipse", 60), ("baler", 86)]


def contact_of(name: str, teeth: int, found: Outlines) -> PairContact:
    pitch, pair = made(name, teeth)
    return pair_contact(pitch, pair, designed(name, teeth), [found])


def grown(outline: Array, by_mm: float) -> Array:
    return np.array(Polygon(outline).buffer(by_mm, join_style="mitre").exterior.coords)[:-1][::-1]


# --- what outlines within the chord tolerance keep -------------------------------------------------------------------


@pytest.mark.tiers(thorough=["uniform-8"], slow=["uniform*", "sine-25", "long ellipse-60", "deep sine-72"], rest="long")
@pytest.mark.parametrize(("name", "teeth"), [*PAIRS, ("baler", 25), ("uniform", 8), ("deep sine", 72), ("ring", 40)])
def test_written_outlines_touch_where_the_exact_curves_do(name: str, teeth: int) -> None:
    """Within three chord tolerances at the pitch radius, and none deeper than one inside the other."""
    exact, found = designed(name, teeth), written(name, teeth)
    bound = 3.0 * TOLERANCE / exact.placement.driven_radius_mm
    assert np.all(np.abs(found.pushing_rad - exact.pushing.error_rad) <= bound)
    assert np.all(np.abs(found.back_rad - exact.back.error_rad) <= bound)
    assert found.overlap_mm.max() <= TOLERANCE
    contact = contact_of(name, teeth, outlines(made(name, teeth)[1]))
    refuse_bad_outlines(contact, TOLERANCE)
    assert contact.extremes[0].from_design_rad.value <= bound.max()
    assert found.transmission_error_rad <= contact.transmission_error_rad
    assert found.overlap_mm.max() <= contact.penetration_mm <= TOLERANCE


@pytest.mark.parametrize(("name", "teeth", "every"), [("uniform", 25, 1), ("ring", 40, 40), ("sine", 32, 16)])
def test_outlines_that_repeat_are_compared_once(name: str, teeth: int, every: int) -> None:
    """One point a nanometre off its place, and all teeth are compared: they are the same to that nanometre."""
    (pitch, pair), once = made(name, teeth), written(name, teeth)
    at = placed(pitch)
    assert once.repeat == every * at.per_tooth < at.count
    moved = pair.driven.outline_mm.copy()
    moved[17] *= 1.0 + 1e-6 / np.hypot(*moved[17])
    whole = read(replace(outlines(pair), driven_mm=moved), pitch, pair, at)
    assert whole.repeat == at.count
    for key in ("pushing_rad", "back_rad"):
        np.testing.assert_allclose(
            getattr(once, key), getattr(whole, key), rtol=0.0, atol=3e-6 / at.driven_radius_mm.min()
        )
    np.testing.assert_allclose(once.overlap_mm, whole.overlap_mm, rtol=0.0, atol=3e-6)
    assert once.driving_tips_mm == pytest.approx(whole.driving_tips_mm, abs=2e-6)
    assert once.driven_tips_mm == pytest.approx(whole.driven_tips_mm, abs=2e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), [("uniform", 25), ("uniform 1:2", 24), ("uniform 3:2", 30)])
def test_transmission_error_of_circular_outlines_vanishes_with_the_tolerance(name: str, teeth: int) -> None:
    tolerances = 2e-2 * 10.0 ** -np.array([0.0, 0.5, 1.0, 1.5, 2.0])
    found = [written(name, teeth, tolerance) for tolerance in tolerances]
    base = least_driven_radius(designed(name, teeth).placement) * cos(ALPHA)
    errors = np.array([one.transmission_error_rad for one in found])
    assert np.all(errors <= 2.0 * tolerances / base)
    # Chords of convex flanks lie inside the teeth; only those of hollow fillets stand out, if they are very coarse.
    assert max(one.overlap_mm.max() for one in found[2:]) == 0.0
    # Linear, with the scatter of whole numbers of chords and of where the positions fall on them.
    assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] == pytest.approx(1.0, abs=0.2)
    assert errors[-1] < errors[0] / 25.0


@pytest.mark.tiers(slow=["ellipse", "baler"], rest="long")
@pytest.mark.parametrize("name", ["ellipse", "sine", "baler"])
def test_transmission_error_of_other_outlines_vanishes_too(name: str) -> None:
    """Within three tolerances over the driven pitch radius at every position, and in proportion."""
    tolerances = np.array([2e-2, 4e-3, 8e-4])
    exact = designed(name, 86)
    radius = np.abs(exact.placement.pitch_point)
    off = [np.abs(written(name, 86, t).pushing_rad - exact.pushing.error_rad) for t in tolerances]
    assert all(np.all(astray <= 3.0 * t / radius) for astray, t in zip(off, tolerances, strict=True))
    assert off[2].max() < off[1].max() / 2.0 < off[0].max() / 4.0


@pytest.mark.slow
@pytest.mark.parametrize(("name", "teeth"), [("uniform", 25), ("ellipse", 37), ("sine", 100)])
def test_tips_clear_roots_by_what_the_rack_says(name: str, teeth: int) -> None:
    found = written(name, teeth)
    for clearance in (found.driving_tips_mm, found.driven_tips_mm):
        assert clearance == pytest.approx(0.25 * MODULE, abs=2.0 * TOLERANCE)


@pytest.mark.parametrize("tooth", [0, 7, 24])
def test_a_bump_on_one_tip_is_that_much_less_clearance(tooth: int) -> None:
    """A vertex 0.03 mm above the middle of one land's arc: the other gear's tips have as much as before."""
    bump_mm, pitch, pair = 0.03, *made("uniform", 25)
    outline = pair.driving.outline_mm
    radius, angle = np.hypot(*outline.T), np.unwrap(np.arctan2(outline[:, 1], outline[:, 0]))
    land = np.flatnonzero(radius > radius.max() - TOLERANCE)
    number = np.rint((angle[land] - angle[land[0]]) / (2.0 * np.pi / 25.0))
    middle = angle[land[number == tooth]][[0, -1]].mean()
    top = (radius.max() + bump_mm) * np.array([[np.cos(middle), np.sin(middle)]])
    bumped = np.insert(outline, int(np.searchsorted(angle, middle)), top, axis=0)
    found = read(replace(outlines(pair), driving_mm=bumped), pitch, pair, placed(pitch))
    assert found.driving_tips_mm == pytest.approx(0.25 * MODULE - bump_mm, abs=2.0 * TOLERANCE)
    assert found.driven_tips_mm == pytest.approx(0.25 * MODULE, abs=2.0 * TOLERANCE)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["baler", "baler-86", "internal-1-2"])
def test_clearance_over_roots_that_slope_is_that_of_the_polygons(name: str) -> None:
    """Where the mate's tips have cut them roots slope: a land then stands over another place than it was cut from."""
    one = drive(name)
    designed, tolerance_mm = one.designed_contact, one.chord_tolerance_mm
    reach = reach_mm(one.pitch, one.teeth)
    found = as_written(outlines(one.teeth), one.teeth, designed.placement, reach)
    for gear in Gear:
        said = min(getattr(side, f"{gear.value}_tips").over_root_mm for side in (designed.pushing, designed.back))
        assert getattr(found, f"{gear.value}_tips_mm") == pytest.approx(said, abs=tolerance_mm)
    if name == "baler":
        # The negative control: over the places that they were cut from the least is more than twice as much.
        roots = one.teeth.driving.sides.roots
        assert np.abs(roots.feet()[0] - np.stack(roots.lands(), axis=1)).max() > 10.0 * tolerance_mm


def met_along_normal(outline_mm: Array, flanks: Flanks, sigma_mm: Array, sense: float) -> Array:
    """Distances from the pitch curve to any chord of an outline along the normal, the nearest first."""
    at = flanks.curve.at_length(sigma_mm)
    start, step = outline_mm, np.roll(outline_mm, -1, axis=0) - outline_mm
    found = []
    for origin, normal in zip(at.position, sense * at.normal, strict=True):
        # origin + d normal = start + share step
        across = normal[0] * step[:, 1] - normal[1] * step[:, 0]
        aside = start - origin
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (aside[:, 1] * normal[0] - aside[:, 0] * normal[1]) / -across
            distance = (aside[:, 0] * step[:, 1] - aside[:, 1] * step[:, 0]) / across
        found.append(distance[(share >= 0.0) & (share <= 1.0) & (distance > 0.0)].min())
    return np.array(found)


@pytest.mark.slow
def test_no_place_of_a_tip_is_nearer_to_its_root_than_told() -> None:
    """The tightest lands held against every chord, at their ends and at irrational shares of hundredths of them.

    Nine places to a land that leave out a thousandth of it at its ends, the negative control, miss 0.3 micrometres.
    """
    one = drive("baler-86")
    designed, (driving, driven) = one.designed_contact, (one.teeth.driving, one.teeth.driven)
    written_mm = outlines(one.teeth)
    told = as_written(written_mm, one.teeth, designed.placement, reach_mm(one.pitch, one.teeth)).driving_tips_mm

    def least(shares: Array, teeth: Sequence[int]) -> Array:
        """Of driving tooth n over the driven space before driven tooth n."""
        found = []
        for tooth in teeth:
            own, mate, z = driving.flanks.crossing_mm, driven.flanks.crossing_mm, driven.teeth
            space = (tooth - 1) % z
            following = mate[2 * space + 2] if space < z - 1 else mate[0] + driven.flanks.curve.length_mm
            ahead = (mate[2 * space + 1] + following) / 2.0 - (own[2 * tooth] + own[2 * tooth + 1]) / 2.0
            first, last = driving.sides.tip_mm[2 * tooth : 2 * tooth + 2]
            begin, end = driven.sides.roots.feet()[0][space] - ahead
            low, high = max(first, begin), min(last, end)
            sigma = low + (high - low) * shares
            height = met_along_normal(written_mm.driving_mm, driving.flanks, sigma, 1.0)
            depth = met_along_normal(written_mm.driven_mm, driven.flanks, sigma + ahead, -1.0)
            found.append((depth - height).min())
        return np.array(found)

    nine = least(np.linspace(0.001, 0.999, 9), range(driving.teeth))
    tightest = [int(tooth) for tooth in np.argsort(nine)[:6]]
    inner = (np.arange(100) + (sqrt(5.0) - 1.0) / 2.0) / 100.0
    fine = least(np.array([1e-7, *inner, 1.0 - 1e-7]), tightest)
    assert told <= fine.min() + 1e-9
    assert told == pytest.approx(fine.min(), abs=1e-6)
    assert nine.min() > told + 1e-4


# --- negative controls -----------------------------------------------------------------------------------------------


@pytest.mark.tiers(thorough=["uniform"], rest="slow")
@pytest.mark.parametrize("name", ["uniform", "ellipse", "sine", "baler"])
def test_straight_sided_teeth_do_not_pass_for_conjugate_ones(name: str) -> None:
    """A tolerance so coarse that every curve is one chord; the bound that sampled exact flanks keep is missed."""
    straight = written(name, 25, 10.0)
    bound = 2.0 * TOLERANCE / (least_driven_radius(designed(name, 25).placement) * cos(ALPHA))
    assert straight.transmission_error_rad > 20.0 * bound
    contact = contact_of(name, 25, outlines(made(name, 25, 10.0)[1]))
    with pytest.raises(NoSuchMechanism):
        refuse_bad_outlines(contact, TOLERANCE)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["uniform", "baler"])
@pytest.mark.parametrize("gear", ["driving", "driven"])
def test_an_outline_grown_by_a_fiftieth_of_a_millimetre_is_refused(name: str, gear: str) -> None:
    found = outlines(made(name, 25)[1])
    wrong = replace(found, **{f"{gear}_mm": grown(getattr(found, f"{gear}_mm"), 0.02)})
    contact = contact_of(name, 25, wrong)
    # A chord of a hollow flank may stand out by its tolerance, and a tenth for the mitred corners of what was grown.
    assert contact.penetration_mm == pytest.approx(0.02, abs=1.1 * TOLERANCE)
    lost = written(name, 25).driving_tips_mm - contact.as_written[0].driving_tips_mm
    assert lost == pytest.approx(0.02, abs=2.0 * TOLERANCE)
    with pytest.raises(NoSuchMechanism, match=r"run into each other by 0\.0[12]\d* mm"):
        refuse_bad_outlines(contact, TOLERANCE)


@pytest.mark.parametrize("name", ["sine", pytest.param("baler", marks=pytest.mark.slow)])
def test_whether_outlines_may_overlap_is_told_as_the_deepest_overlap_tells(name: str) -> None:
    """Below and above the deepest overlap of outlines that were grown."""
    found = outlines(made(name, 25)[1])
    contact = contact_of(name, 25, replace(found, driven_mm=grown(found.driven_mm, 0.02)))
    deepest = contact.penetration_mm
    assert deepest > TOLERANCE
    assert contact.may_overlap(0.9 * deepest)
    assert not contact.may_overlap(1.1 * deepest)


def test_an_outline_shrunk_as_much_is_refused() -> None:
    """It overlaps nothing, but lets the driven gear lag."""
    found = outlines(made("sine", 25)[1])
    contact = contact_of("sine", 25, replace(found, driven_mm=grown(found.driven_mm, -0.03)))
    assert contact.penetration_mm == 0.0
    said = r"written as test touch 0\.03\d* mm off the exact teeth near tooth \d+ of the driving gear at phi1 = .*more"
    with pytest.raises(NoSuchMechanism, match=said):
        refuse_bad_outlines(contact, TOLERANCE)


@pytest.mark.parametrize("name", ["uniform", "sine"])
def test_a_gear_written_turned_by_a_ten_thousandth_is_seen(name: str) -> None:
    """The outline turned backwards, that is on for the driven gear, is ahead of the law by less: as found before."""
    found = outlines(made(name, 25)[1])
    turned = (found.driven_mm @ [1, 1j]) * np.exp(1j * 1e-4)
    before, after = (
        contact_of(name, 25, one).as_written[0]
        for one in (found, replace(found, driven_mm=np.column_stack([turned.real, turned.imag])))
    )
    assert after.pushing_rad - before.pushing_rad == pytest.approx(np.full(500, 1e-4), abs=1e-12)
    assert after.back_rad - before.back_rad == pytest.approx(np.full(500, 1e-4), abs=1e-12)


def test_a_missing_tooth_is_refused() -> None:
    _, pair = made("uniform", 25)
    found = outlines(pair)
    z = found.driven_mm @ [1, 1j]
    without = found.driven_mm[~((np.abs(np.angle(-z * np.exp(-1j * np.pi / 25))) < 0.1) & (np.abs(z) > 23.0))]
    with pytest.raises(NoSuchMechanism, match="do not reach each other"):
        contact_of("uniform", 25, replace(found, driven_mm=without))


def test_outlines_that_do_not_reach_each_other_are_refused() -> None:
    pitch, pair = made("uniform", 25)
    small = replace(outlines(pair), driven_mm=pair.driven.outline_mm * 0.8)
    with pytest.raises(NoSuchMechanism, match="written as test do not reach each other"):
        read(small, pitch, pair, placed(pitch))


@pytest.mark.slow
def test_the_worst_of_several_outlines_counts() -> None:
    pitch, pair = made("sine", 25)
    found = outlines(pair)
    coarse = Outlines("coarse", *(gear.outline_mm for gear in (made("sine", 25, 0.02)[1].driving, pair.driven)))
    contact = pair_contact(pitch, pair, designed("sine", 25), [found, coarse])
    assert contact.transmission_error_rad == contact.extremes[1].pushing_rad.width
    assert contact.transmission_error_rad > written("sine", 25).transmission_error_rad
