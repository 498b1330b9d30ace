"""How seldom Python looks for rings of objects that nothing needs any more."""

from __future__ import annotations

import atexit
import gc

COLLECTED_AFTER = 500_000
"""New objects after which Python looks for them.

Libraries load hundreds of thousands that stay: to look through them after every 700, as is usual, takes an eighth of a
build, and to look through them once more at the end as much again.
"""


def collect_rarely() -> None:
    """Make this process look for rings after ``COLLECTED_AFTER`` new objects.

    At the end it looks for none: what a process holds goes with the process.
    """
    gc.set_threshold(COLLECTED_AFTER)
    atexit.register(gc.freeze)
