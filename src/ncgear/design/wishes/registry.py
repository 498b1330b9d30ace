"""The kinds of wishes that a design file can name, one line each, in the order in which they are judged and told.

To add a kind ``<name>``:

1. ``wishes/<name>.py``: its value, which keeps the contract of ``wishes/wish.py``: what it asks of a law, what a motion
   achieves of it, its words, and what it would have to ask for instead;
2. ``design/wishes/<name>.py``: its keys, and how they make the value (``design/wishes/base.py``);
3. a line in ``KINDS`` below.

The group ``wishes`` of design files, its JSON Schema and its faults, checks, the search for laws and the certified
limit all follow from these lines.
"""

from __future__ import annotations

from ncgear.design.wishes.base import WishKeys
from ncgear.design.wishes.constant_speed import ConstantSpeed
from ncgear.design.wishes.dwell import Dwell
from ncgear.design.wishes.gentle_stop import GentleStop
from ncgear.design.wishes.positions import Position
from ncgear.design.wishes.speed_at import SpeedAt
from ncgear.design.wishes.time_ratio import TimeRatio
from ncgear.design.wishes.working_stroke import WorkingStroke

KINDS: tuple[type[WishKeys], ...] = (
    ConstantSpeed,
    TimeRatio,
    WorkingStroke,
    Dwell,
    SpeedAt,
    GentleStop,
    Position,
)
