"""What `ncgear optimize` says of the law found: its distance from the limit, and what it does not keep."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from commands import Run
from drives import DESIGNS

EVEN_WISH = "constant_speed: [{{from_mm: 50, to_mm: 90, tolerance: 0.02, stroke: {}, hard: {}}}]"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wishes", "lost"),
    [
        (EVEN_WISH.format("working", "true"), False),
        (EVEN_WISH.format("working", "false"), True),
        (EVEN_WISH.format("return", "true"), True),
        ("time_ratio: {at_least: 1.2}", True),
    ],
)
def test_an_even_speed_that_a_hard_wish_keeps_is_not_lost(run: Run, wishes: str, lost: bool) -> None:
    """The pusher's own law is even from 90 to 180 deg of the driving gear, which takes its slider from 40 to 118 mm."""
    text = (DESIGNS / "pusher.yaml").read_text()
    Path("d.yaml").write_text(f"{text}\noptimize: {{knots: 24}}\nwishes:\n  {wishes}\n")
    status, said, err = run("optimize", "d.yaml")
    assert status == 0, err
    assert ("not kept of the design as given: the constant speed v2" in said) is lost
    found = json.loads(Path("export/pusher-optimized/certificate.json").read_text())
    assert (found["not_kept"] != "") is lost
    # A soft wish bends the law: its distance from the limit of hard wishes says nothing of its quality.
    soft = "hard: false" in wishes
    assert ("% above the limit" in said) is not soft
    assert ("bent by soft wishes; the limit of hard wishes and limits alone is" in said) is soft
    assert (found["goal"]["gap"] is None) is soft
    assert ("soft wishes" in found["goal"]["not_covered_by_limit"]) is soft
