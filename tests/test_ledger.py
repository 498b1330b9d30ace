"""The reproduction ledger: verdicts are computed, none is typed; the page in docs is today's."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import replace
from itertools import chain, groupby
from math import pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import drives
from at_once import at_once
from commands import ROOT, fresh
from ncgear.figures.ledger import PAGE, ledger_page
from ncgear.papers.entry import (
    AGREEING,
    HOLDS,
    Below,
    Computed,
    Entry,
    Finding,
    Paper,
    Printed,
    Relation,
    computed,
    from_readings,
    half_step,
    texts,
)
from ncgear.papers.gear_baler import simulation as gear_baler
from ncgear.papers.gear_baler.simulation import INFERRED
from ncgear.papers.judgement import PAPERS, Contradicted, judged, judgement
from ncgear.papers.track_chassis.measurements import LINE_HZ
from ncgear.papers.track_chassis.slider import LINKAGE
from printed_figures import ANYWHERE, BALER, CHASSIS, CLAIMS, DRUM, LINES, NUMBERS, SHAPED, SIEVE

ENTRIES = [entry for paper in PAPERS for entry in paper.entries]


@pytest.mark.tiers(quick=["Threshing drum with a side chain drive"], rest="long")
@pytest.mark.parametrize("paper", PAPERS, ids=lambda paper: paper.title)
def test_every_verdict_is_borne_out(paper: Paper) -> None:
    assert len(judgement(paper).entries) == len(paper.entries) > 0


def figures_by_place(paper: Paper) -> dict[str, Counter[str]]:
    """Numbers that the ledger has for each place: those judged, and those left out with a reason."""
    found: dict[str, Counter[str]] = defaultdict(Counter)
    for entry in paper.entries:
        for place in set(entry.places) if isinstance(entry.published, Printed) else ():
            found[place] += Counter(entry.published.texts)
    for item in paper.left_out:
        for place in item.places:
            found[place] += Counter(item.figures)
    return found


def missing_numbers(paper: Paper) -> list[str]:
    """Numbers of tests/printed_figures.py that the ledger neither judges nor leaves out with a reason."""
    found = figures_by_place(paper)
    anywhere = set(chain.from_iterable(found.values()))
    lacking = [
        f"{place}: {text}"
        for place, line in NUMBERS[paper.title].items()
        for text in (Counter(line.split()) - found[place])
        if place != ANYWHERE
    ]
    return lacking + [text for text in NUMBERS[paper.title][ANYWHERE].split() if text not in anywhere]


def missing_claims(paper: Paper) -> list[str]:
    """Claims of tests/printed_figures.py that have no line in the ledger at their place."""
    named = {(place, entry.what) for entry in paper.entries for place in entry.places}
    return [
        f"{place}: {claim}"
        for place, claims in CLAIMS[paper.title].items()
        for claim, what in claims.items()
        if (place, what) not in named
    ]


@pytest.mark.judges("papers")
@at_once("paper", PAPERS)
def test_every_printed_figure_and_claim_is_in_the_ledger(paper: Paper) -> None:
    assert missing_numbers(paper) == []
    assert missing_claims(paper) == []


@at_once("paper", PAPERS)
def test_a_figure_or_claim_taken_out_is_missed(paper: Paper) -> None:
    """Whatever is left out of the ledger's list of what it leaves out, or of its claims, is found to be missing."""
    for item in paper.left_out:
        rest = tuple(other for other in paper.left_out if other is not item)
        assert not item.figures or missing_numbers(replace(paper, left_out=rest)), item.content
    for claims in CLAIMS[paper.title].values():
        for what in claims.values():
            rest_of_entries = tuple(entry for entry in paper.entries if entry.what != what)
            assert missing_claims(replace(paper, entries=rest_of_entries)), what


@at_once(("title", "count"), [(BALER, 46), (CHASSIS, 391), (DRUM, 388), (SIEVE, 213), (LINES, 40), (SHAPED, 58)])
def test_numbers_listed(title: str, count: int) -> None:
    """How many numbers each paper prints, so that none is lost from the list."""
    assert sum(len(line.split()) for line in NUMBERS[title].values()) == count


def unnamed(paper: Paper) -> set[str]:
    """Tables, equations and figures that neither an entry nor what is given names."""
    named = set(chain.from_iterable(one.places for one in (*paper.entries, *paper.left_out)))
    return set(paper.promised) - named


@at_once("paper", PAPERS)
def test_every_place_is_named(paper: Paper) -> None:
    assert unnamed(paper) == set()
    assert unnamed(replace(paper, entries=paper.entries[1:], left_out=())) != set()


@at_once("paper", PAPERS)
def test_no_figure_is_there_twice(paper: Paper) -> None:
    figures = [(entry.places, entry.what) for entry in paper.entries]
    assert len(set(figures)) == len(figures)


@pytest.mark.slow
def test_the_other_verdict_is_refused() -> None:
    """Whatever the computation says, claiming the contrary fails."""
    computed = [entry for entry in ENTRIES if entry.compute]
    assert len(computed) > 100
    for entry in computed:
        other = Finding.NOT_REPRODUCIBLE if entry.verdict in AGREEING else Finding.REPRODUCED
        with pytest.raises(Contradicted):
            judged(replace(entry, verdict=other, words="typed"))


@at_once("entry", [entry for entry in ENTRIES if entry.verdict in AGREEING])
def test_what_is_printed_comes_out_and_another_last_digit_is_refused(entry: Entry) -> None:
    """Two steps off in any printed digit, a thousandth in an equation, or a claim the other way round: it falls."""
    computed = judged(entry).computed
    assert computed is not None
    if isinstance(entry.published, Below):
        pairs = zip(computed.values[1::2], computed.values[::2], strict=True)
        assert not entry.published.agrees(replace(computed, values=tuple(chain.from_iterable(pairs))))
        return
    if isinstance(entry.published, Relation):
        off = replace(computed, values=tuple(value + 1e-3 for value in computed.values))
        assert not entry.published.agrees(off)
        return
    for place, text in enumerate(entry.published.texts):
        step = 4.0 * half_step(text) + 2.0 * computed.leeway[place]
        values = tuple(value + step * (k == place) for k, value in enumerate(computed.values))
        assert not entry.published.agrees(replace(computed, values=values))


def test_what_is_off_by_more_than_rounding_has_words() -> None:
    assert all(entry.words for entry in ENTRIES if entry.verdict is not Finding.REPRODUCED)
    with pytest.raises(ValueError, match="without a word"):
        Entry("eq. 1", "x", Relation(), Finding.NOT_REPRODUCIBLE, lambda: computed(1.0))
    with pytest.raises(ValueError, match="nothing is computed"):
        Entry("eq. 1", "x", Relation(), Finding.REPRODUCED)


def test_what_is_made_of_printed_numbers_is_right_or_wrong() -> None:
    """One rule: no sum or quotient of printed numbers is held to be read, given back, or short of data."""
    for verdict in (Finding.UNDER_READING, Finding.GIVEN_BACK, Finding.NEEDS_DATA):
        with pytest.raises(ValueError, match="of printed numbers"):
            Entry("eq. 1", "x", Printed(("1",)), verdict, lambda: computed(1.0), "words", of_printed=True)


def test_a_claim_of_more_or_less_holds_for_all_pairs() -> None:
    claim = Below("less")
    assert claim.agrees(computed(1.0, 2.0, -3.0, 0.5))
    assert not claim.agrees(computed(1.0, 2.0, 3.0, 3.0))
    assert claim.computed_text(computed(1.0, 2.0, 5.0, 3.0)) == "5 > 3; holds for 1 of 2"


def test_the_acceleration_at_the_retracted_end_by_plain_equations() -> None:
    """v as a polynomial of degree 4 from eqs. 3.3 and 3.4, at the law's speed; its slope at phi1 = 0, at 20 r/min."""
    t1, t2 = 0.4 * pi, 0.7 * pi
    rows = [[at**k for k in range(5)] for at in (0.0, t1, t2)]
    rows += [[k * at ** max(k - 1, 0) for k in range(5)] for at in (t1, t2)]
    omega = 52.80854482726039 * pi / 30.0
    found = np.linalg.solve(np.array(rows), [0.0, 1600.0 / omega, 1100.0 / omega, 0.0, 0.0])[1]
    entry = next(one for one in ENTRIES if one.what == "acceleration where the return ends")
    assert entry.computed().values[0] == pytest.approx(found * (20.0 * pi / 30.0) ** 2, rel=1e-9)


def test_the_earlier_mechanisms_speed_is_inferred() -> None:
    """60.44 r/min follow from 28.6 % below an even crank with this linkage; its power is sampled here."""
    crank, rod = gear_baler.LINKAGE.crank_mm, gear_baler.LINKAGE.rod_mm
    angle = np.linspace(0.0, pi, 200_001)
    root = np.sqrt(rod**2 - (crank * np.sin(angle)) ** 2)
    place = rod + crank * np.cos(pi - angle) - (rod - crank) - (rod - root)
    slope = crank * np.sin(angle) * (1.0 - crank * np.cos(angle) / root)
    force = np.polynomial.Polynomial([-131.2779, 3.447, 1.846e-2, -1.575e-4, 2.498e-7])(place)
    watts_per_rpm = float((force * slope).max()) * (pi / 30.0) / 1000.0
    inferred = gear_baler.EARLIER_POWER_W / (1.0 - 0.286) / watts_per_rpm
    assert f"{inferred:.2f}" == "60.44"
    assert "60.44 r/min" in INFERRED
    assert round(inferred) == gear_baler.EARLIER_RPM


@at_once(("text", "half"), [("6300", 50.0), ("182", 0.5), ("0.4", 0.05), ("9.50", 0.005), ("0", 0.5), ("-2.08", 0.005)])
def test_half_step(text: str, half: float) -> None:
    assert half_step(text) == pytest.approx(half, rel=1e-15)


@pytest.mark.thorough
@given(st.decimals(-1000, 1000, places=2, allow_nan=False))
def test_rounding_agrees_with_what_it_was_rounded_from(number: object) -> None:
    printed = Printed((f"{float(str(number)):.1f}",))
    assert printed.agrees(computed(float(str(number))))


def test_a_decimal_half_is_not_lost_to_its_binary_form() -> None:
    """4.38 - 1.185 and the like end on halves that no binary number is."""
    assert Printed(("0.2",)).agrees(computed(0.1 + 0.05))
    assert not Printed(("0.2",)).agrees(computed(0.149999))


def test_rounding_of_readings_is_allowed_for() -> None:
    """0.12 + 0.17 may be 0.28 or 0.30 once each is rounded, but not 0.32."""
    total = from_readings(lambda one, other: (one + other,), "0.12", "0.17")
    assert total.input_rounding == pytest.approx((0.01,))
    assert Printed(("0.30",)).agrees(total)
    assert not Printed(("0.31",)).agrees(total)


def test_an_equation_holds_to_rounding_errors_only() -> None:
    assert Relation().agrees(computed(0.5 * HOLDS))
    assert not Relation().agrees(Computed((0.0, 2.0 * HOLDS)))


@at_once("entry", [e for e in ENTRIES if isinstance(e.published, Relation) and e.compute])
def test_equations_hold_to_rounding_errors_or_fail_by_far(entry: Entry) -> None:
    """What HOLDS parts: nothing lies within three orders of it."""
    worst = max(map(abs, entry.computed().values))
    assert worst < 1e-3 * HOLDS if entry.verdict in AGREEING else worst > 1e3 * HOLDS


def test_numbers_in_words_are_todays() -> None:
    assert f"{gear_baler.law_rpm():.2f}" == "52.81"
    assert f"{gear_baler.other_law().stroke.law_speed_rad_s * 30.0 / pi:.2f}" == "51.31"
    low, high = gear_baler.other_law().transmission.slope_range
    assert (f"{1.0 / high.value:.2f}", f"{1.0 / low.value:.2f}") == ("0.12", "7.65")
    assert f"{gear_baler.RESISTANCE.zeros_mm(gear_baler.STROKE_MM)[0]:.1f}" == "33.7"
    assert f"{LINKAGE.crank_mm / LINKAGE.rod_mm:.3f}" == "0.473"


@pytest.mark.thorough
def test_the_gear_balers_reading_is_the_design_file() -> None:
    """The ledger's own Table 1 makes the law of designs/baler.yaml."""
    drive = drives.drive("baler")
    assert gear_baler.law_rpm() == pytest.approx(drive.law_speed_rpm, rel=1e-12)
    speed = drive.design.operation.speed_rpm
    found, wanted = gear_baler.at_speed(speed), drive.check
    assert found.peak_power_w.value == pytest.approx(wanted.peak_power_w.value, rel=1e-12)
    cycle = "peak_acceleration_cycle"
    assert getattr(found, cycle).value == pytest.approx(getattr(wanted, cycle).value, rel=1e-12)
    assert gear_baler.law().stroke.theta4_rad == pytest.approx(1.3 * pi)


@pytest.mark.judges("papers")
@at_once(
    ("title", "what", "verdict", "values"),
    [
        # Computed apart from this program before any of it was written
        (BALER, "largest power", Finding.FITTED, "6315"),
        (BALER, "largest power at the speed at which v1 and v2 hold", Finding.NOT_REPRODUCIBLE, "16675"),
        (BALER, "largest acceleration, in the working stroke", Finding.GIVEN_BACK, "1500.0"),
        (BALER, "centre distance, from teeth and module", Finding.NOT_REPRODUCIBLE, "74.885"),
        (BALER, "power saved", Finding.REPRODUCED, "66.4"),
        (CHASSIS, "counterweight beyond the crank pin, and mass at the pin", Finding.REPRODUCED, "182.0 247.0"),
        (CHASSIS, "counterweight beyond the crank axis", Finding.FITTED, "261.82"),
        (CHASSIS, "weight against the slider's inertia", Finding.FITTED, "4.86"),
        (CHASSIS, "weight against the slider's largest inertia force", Finding.NOT_REPRODUCIBLE, "13.6"),
        (CHASSIS, "weight against the dead weight", Finding.REPRODUCED, "259.05"),
        (CHASSIS, "two terms for the exact acceleration of this linkage", Finding.NOT_REPRODUCIBLE, "0.043"),
        (DRUM, "range of the weight's amplitude, at 700 r/min", Finding.REPRODUCED, "0.0743 0.2136"),
        (DRUM, "largest amplitude of the tight side", Finding.REPRODUCED, "2.045"),
        # 0.483 mm/s at 209 deg, weight 0.2136 mm/s: 0.483 cos 29 + 0.2136 sin 60 + 2.0449 cos 15
        (DRUM, "largest amplitude of the slack side, with two slips at 300 deg", Finding.FITTED, "2.58"),
        (CHASSIS, "largest amplitude without the weight", Finding.NOT_REPRODUCIBLE, "7.56"),
        (CHASSIS, "points that move least", Finding.NOT_REPRODUCIBLE, "5 6 7"),
        (SIEVE, "pan: counterweight", Finding.REPRODUCED, "5.40 6.11"),
        (SIEVE, "sieve: counterweight, from the printed masses", Finding.REPRODUCED, "16.64 20.04"),
        (SIEVE, "sieve: counterweight, from its dimensions", Finding.NOT_REPRODUCIBLE, "16.88 20.28"),
        (SIEVE, "eta1 at 45 deg", Finding.NOT_REPRODUCIBLE, "0.714"),
        (SIEVE, "eta1 at 90 deg", Finding.UNDER_READING, "0.653"),
        (SIEVE, "eta1 at 0 deg", Finding.NOT_REPRODUCIBLE, "0.845"),
        (SIEVE, "eta2 at 45 deg", Finding.NOT_REPRODUCIBLE, "0.742"),
        (SIEVE, "eta2 at 0 deg", Finding.NOT_REPRODUCIBLE, "0.742"),
        (LINES, "semi-minor axis, turning about the centre", Finding.NOT_REPRODUCIBLE, "17.207"),
        (LINES, "semi-minor axis, axis at x = 4", Finding.UNDER_READING, "16.733"),
        (LINES, "semi-minor axis, axis at y = -4", Finding.UNDER_READING, "16.911"),
        (LINES, "semi-minor axis, axis at x = 4, y = -4", Finding.UNDER_READING, "16.440"),
        (SHAPED, "module at the printed centre distance", Finding.NOT_REPRODUCIBLE, "4.9231"),
        (SHAPED, "centre distance at the printed module", Finding.REPRODUCED, "149.620"),
    ],
)
def test_figures_that_were_computed_independently(title: str, what: str, verdict: Finding, values: str) -> None:
    paper = next(paper for paper in PAPERS if paper.title == title)
    found = judged(next(entry for entry in paper.entries if entry.what == what))
    assert found.entry.verdict is verdict
    assert found.computed is not None
    assert Printed(texts(values)).agrees(Computed(found.computed.values))


@pytest.mark.tiers(slow=["Threshing drum with a side chain drive-counts2"], rest="long")
@pytest.mark.parametrize(
    ("title", "counts"),
    [
        (BALER, (10, 4, 2, 4, 12, 5)),
        (CHASSIS, (29, 2, 4, 0, 17, 3)),
        (DRUM, (17, 2, 5, 0, 11, 8)),
        (SIEVE, (16, 6, 1, 0, 17, 24)),
        (LINES, (5, 4, 0, 1, 1, 1)),
        (SHAPED, (7, 0, 0, 0, 1, 0)),
    ],
)
def test_counts(title: str, counts: tuple[int, ...]) -> None:
    paper = next(paper for paper in PAPERS if paper.title == title)
    assert tuple(judgement(paper).count(verdict) for verdict in Finding) == counts


def test_spectra_have_lines() -> None:
    """The frequencies of Table 5 of the track chassis, but for the one that the ledger names, are multiples of 1.95 Hz;
    twice that spacing has not half of them, and neither setting of the measurement gives it."""
    table = [float(text) for text in texts("87.89 335.94 332.03 5.86 13.67 417.97 27.34 160.16 80.08 76.17 74.22")]
    table += [float(text) for text in texts("78.13 156.25 525.39 748.05 537.1")]

    def on_lines(spacing_hz: float) -> int:
        return sum(abs(one - round(one / spacing_hz) * spacing_hz) < 0.006 for one in table)

    assert on_lines(LINE_HZ) == len(table) - 1  # 537.1 is printed with one decimal
    assert Printed(("537.1",)).agrees(computed(round(537.1 / LINE_HZ) * LINE_HZ))
    assert on_lines(2.0 * LINE_HZ) <= len(table) / 2
    assert LINE_HZ not in (2000.0 / 512.0, 2000.0 / 8192.0)
    assert abs(80.78 - round(80.78 / LINE_HZ) * LINE_HZ) > 0.5


@pytest.mark.slow
def test_the_command_writes_the_page(tmp_path: Path) -> None:
    done = fresh("reproduce", "--out", str(tmp_path))
    written = PAGE, "reproduction.json", "manifest.json"
    assert done.stdout.splitlines()[-3:] == [f"  {tmp_path / name}" for name in written]
    assert f"{BALER}\n    10  reproduced\n" in done.stdout
    assert (tmp_path / PAGE).read_bytes() == (ROOT / "docs" / PAGE).read_bytes()


def test_no_cell_breaks_the_tables() -> None:
    """Every row of a table has as many cells as its head."""
    lines = (ROOT / "docs" / PAGE).read_text(encoding="utf-8").splitlines()
    tables = [list(rows) for is_row, rows in groupby(lines, lambda line: line.startswith("|")) if is_row]
    assert len(tables) == 1 + len(PAPERS)
    assert all(line.count("|") == table[0].count("|") for table in tables for line in table)


@pytest.mark.slow
def test_the_page_is_todays() -> None:
    """``make docs`` writes it anew."""
    page = (ROOT / "docs" / PAGE).read_text(encoding="utf-8")
    assert page == ledger_page([judgement(paper) for paper in PAPERS])
