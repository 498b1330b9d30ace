"""Handles of the studio's charts: of wishes on a Scotch yoke in closed form, and of dense points, which share moves."""

from __future__ import annotations

from math import acos, cos, degrees, pi, radians, sin
from typing import Any

import numpy as np
import pytest

from drives import drive, drive_of_text
from ncgear.studio.handles import handles

pytestmark = pytest.mark.judges("studio")

RADIUS, SPEED = 100.0, 2.0 * pi

YOKE = """\
name: yoke
linkage: {kind: scotch_yoke, crank_mm: 100}
operation: {speed_rpm: 60}
motion: {law: uniform_crank}
wishes:
"""


def placed(wishes: str) -> dict[str, dict[str, Any]]:
    """The handles of an even yoke by their keys."""
    found = handles(drive_of_text(YOKE + wishes))
    return {next(iter(one["moves"].values()))["key"].partition(".")[2]: one for one in found}


def at_deg(place_mm: float, *, back: bool = False) -> float:
    """Where r (1 - cos phi) is a place."""
    angle = degrees(acos(1.0 - place_mm / RADIUS))
    return 360.0 - angle if back else angle


def test_places_of_wishes_stand_on_the_curve_of_their_stroke() -> None:
    """Their middle has the bound of the speed, which is negative on the way back."""
    found = placed(
        "  constant_speed: [{from_mm: 20, to_mm: 100, tolerance: 0.05, speed_mm_s: 300, stroke: return}]\n"
        "  speed_at: [{at_mm: 60, at_least_mm_s: 50, at_most_mm_s: 900}]\n"
    )
    assert found["constant_speed.0.from_mm"]["x"] == pytest.approx(at_deg(20.0, back=True), abs=0.5)
    assert found["constant_speed.0.to_mm"]["x"] == pytest.approx(at_deg(100.0, back=True), abs=0.5)
    speed = found["constant_speed.0.speed_mm_s"]
    assert (speed["y"], speed["moves"]["y"]["factor"]) == (-300.0, -1.0)
    assert speed["x"] == pytest.approx(at_deg(60.0, back=True), abs=0.5)
    least, most = (found[f"speed_at.0.at_{bound}_mm_s"] for bound in ("least", "most"))
    assert (least["y"], most["y"]) == (50.0, 900.0)
    assert least["x"] == most["x"] == found["speed_at.0.at_mm"]["x"] == pytest.approx(at_deg(60.0), abs=0.5)


@pytest.mark.parametrize("back", [False, True])
def test_gentle_stretches_are_bounded_on_the_side_of_a_falling_speed(back: bool) -> None:
    """A deceleration is negative on the way out and positive on the way back, a speed the other way round."""
    stroke = "return" if back else "working"
    found = placed(
        f"  gentle_stop: [{{from_mm: 120, deceleration_at_most_mm_s2: 4000, stroke: {stroke}}},"
        f" {{to_mm: 80, speed_at_most_mm_s: 700, stroke: {stroke}}}]\n"
    )
    falling, slow = found["gentle_stop.0.deceleration_at_most_mm_s2"], found["gentle_stop.1.speed_at_most_mm_s"]
    assert (falling["y"], slow["y"]) == ((4000.0, -700.0) if back else (-4000.0, 700.0))
    assert falling["x"] == pytest.approx(at_deg(160.0, back=back), abs=0.5)
    assert slow["x"] == pytest.approx(at_deg(40.0, back=back), abs=0.5)
    assert found["gentle_stop.0.from_mm"]["y"] == 120.0
    assert {"gentle_stop.1.from_mm", "gentle_stop.0.to_mm"}.isdisjoint(found)


@pytest.mark.parametrize(("start_deg", "end_deg"), [(200.0, 260.0), (-160.0, -100.0), (40.0, 60.0)])
def test_driving_ranges_stand_at_their_angles(start_deg: float, end_deg: float) -> None:
    """The sign is that of the motion there; an angle moves by one degree for each degree of the chart."""
    found = placed(
        f"  gentle_stop: [{{from_phi1_deg: {start_deg}, to_phi1_deg: {end_deg}, speed_at_most_mm_s: 700}}]\n"
    )
    middle = found["gentle_stop.0.speed_at_most_mm_s"]
    sign = np.sign(sin(radians((start_deg + end_deg) / 2.0)))
    assert middle["x"] == pytest.approx(((start_deg + end_deg) / 2.0) % 360.0)
    for name, angle in (("from", start_deg), ("to", end_deg)):
        end = found[f"gentle_stop.0.{name}_phi1_deg"]
        assert (end["x"], end["y"]) == (pytest.approx(angle % 360.0), sign * 700.0)
        assert end["moves"]["x"] == {
            "key": f"wishes.gentle_stop.0.{name}_phi1_deg",
            "base": angle,
            "factor": pytest.approx(1.0),
            "unit": "\u00b0",
        }


def test_dense_points_go_alike_where_all_handles_do() -> None:
    """What goes with the handles of a spline of 180 ratios adds up to one at every point; halfway it is a half."""
    made = drive("baler-flywheel")
    found = handles(made)
    shares = dict.fromkeys(range(180), 0.0)
    for one in found:
        move = one["moves"]["y"]
        shares[int(move["key"].rpartition(".")[2])] += 1.0
        assert move["factor"] == pytest.approx(move["base"] / one["y"])
        for also in move["along"]:
            shares[int(also["key"].rpartition(".")[2])] += also["power"]
    assert len(found) == 18
    assert list(shares.values()) == pytest.approx([1.0] * 180)
    places = [int(one["moves"]["y"]["key"].rpartition(".")[2]) for one in found]
    # Half of the way of a cycle there and back is what the shares go by: even ones at even places
    steps = np.diff(places)
    first = [also["power"] for also in found[0]["moves"]["y"]["along"]]
    way = np.arange(1, steps[0]) / steps[0]
    assert sorted(first)[-1] == pytest.approx(cos(pi / 2.0 * way[0]) ** 2, abs=0.02)
    # The nearest points to even driving angles
    assert np.array([one["x"] for one in found]) == pytest.approx(20.0 * np.arange(18), abs=1.1)
