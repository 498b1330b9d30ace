"""Borders at which a thing is refused, and drawings of a few lines: by hand, where whole designs seldom come."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ncgear.contact.written.as_written import require_reached
from ncgear.drawings.charts.teeth_charts import backlash, transmission_error
from ncgear.drawings.scene.standing import SUPPORT, supports_mm
from ncgear.errors import NoSuchMechanism

Made: Any = SimpleNamespace


@pytest.mark.judges("contact")
@pytest.mark.parametrize("place", range(3))
def test_one_clearance_that_is_no_number_is_refused(place: int) -> None:
    """Play upwards or downwards at one of three positions, or one of two tips."""
    values = [np.array([0.1, 0.1, 0.1]), np.array([0.1, 0.1, 0.1]), np.array([0.2, 0.2])]
    outlines = Made(source="csv")
    require_reached(outlines, Made(up_rad=values[0], down_rad=values[1]), *values[2])
    values[place][1] = np.nan if place == 2 else np.inf
    with pytest.raises(NoSuchMechanism, match="do not reach each other"):
        require_reached(outlines, Made(up_rad=values[0], down_rad=values[1]), *values[2])


@pytest.mark.judges("drawings")
def test_a_support_stands_evenly_under_its_axis() -> None:
    linkage = Made(crank_mm=100.0, pivots_mm={"first": (0.0, 5.0), "rocker": (210.0, -20.0)}, guides_mm=())
    lines = supports_mm(linkage)
    assert len(lines) == 4
    for (x, y), wedge, ground in zip(linkage.pivots_mm.values(), lines[::2], lines[1::2], strict=True):
        assert wedge[1] == pytest.approx([x, y])
        for line in (wedge, ground):
            assert line[0] + line[-1] == pytest.approx([2.0 * x, 2.0 * (y - SUPPORT * 100.0)])
            assert line[0, 0] < x < line[-1, 0]
        assert wedge[2, 0] - wedge[0, 0] == pytest.approx(2.0 * SUPPORT * 100.0)


@pytest.mark.judges("drawings")
def test_errors_and_play_are_drawn_in_millionths_of_a_rad() -> None:
    angle = np.array([0.0, 1.0, 2.0])
    placement = Made(phi1_rad=angle, cycle_rad=3.0)
    designed = Made(
        placement=placement,
        phi1_rad=angle,
        pushing=Made(error_rad=np.array([1e-5, 2e-5, 3e-5])),
        backlash_rad=np.array([4e-4, 5e-4, 6e-4]),
    )
    written = [Made(transmission_error_rad=worst, pushing_rad=worst * np.ones(3)) for worst in (1e-6, 7e-6)]
    chart = transmission_error(Made(as_designed=designed, as_written=written))
    assert chart.lines[0].values == pytest.approx([10.0, 20.0, 30.0])
    assert chart.lines[1].values == pytest.approx([7.0, 7.0, 7.0])
    assert backlash(designed).lines[0].values == pytest.approx([400.0, 500.0, 600.0])
