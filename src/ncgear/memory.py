"""How seldom Python looks for rings of objects that nothing needs any more, and when freed memory goes back."""

from __future__ import annotations

import atexit
import gc
import sys

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


KEPT_BYTES, OWN_MAPPING_BYTES = 64 << 20, 32 << 20
"""Free memory that a process keeps, and size from which an array has a mapping of its own."""

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
"""Parameters of the GNU C library's ``mallopt``."""


def keep_freed_memory() -> None:
    """Make this process use the memory of its arrays again, where the C library is GNU's.

    Otherwise each array of some 100 kB may be given back to the system and asked for anew, page by page.  The library
    learns to keep it, but not where a variable MALLOC_TRIM_THRESHOLD_ is set, as Dask sets it for its workers: a sweep
    then takes three times as long (benchmarks/sweeping.md).
    """
    if sys.platform != "linux":
        return
    # Takes some milliseconds to load.
    import ctypes

    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_TRIM_THRESHOLD, KEPT_BYTES)
        mallopt(M_MMAP_THRESHOLD, OWN_MAPPING_BYTES)


def begin_worker() -> None:
    """Prepare a process that computes many tasks, one after the other."""
    collect_rarely()
    keep_freed_memory()
