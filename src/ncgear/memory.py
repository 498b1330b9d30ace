"""How often Python searches for unused cycles of objects, and when freed memory goes back to the system."""

from __future__ import annotations

import atexit
import gc
import sys

COLLECTED_AFTER = 500_000
"""Number of new objects after which Python searches for unused cycles.

Libraries load hundreds of thousands of objects that stay.  Searching them after every 700 new objects, the default,
takes an eighth of a build, and searching them again at the end takes as much again."""


def collect_rarely() -> None:
    """Make this process search for unused cycles after ``COLLECTED_AFTER`` new objects.

    At the end it does not search: the system frees the memory of the process.
    """
    gc.set_threshold(COLLECTED_AFTER)
    atexit.register(gc.freeze)


KEPT_BYTES, OWN_MAPPING_BYTES = 64 << 20, 32 << 20
"""Free memory that a process keeps, and size from which an array gets its own memory mapping."""

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
"""Parameters of the GNU C library's ``mallopt``."""


def keep_freed_memory() -> None:
    """Make this process reuse the memory of its arrays, if the C library is GNU's.

    Otherwise the memory of each array of some 100 kB may be returned to the system and requested anew, page by page.
    The library learns to keep it, but not where a variable MALLOC_TRIM_THRESHOLD_ is set, as Dask sets it for its
    workers: a sweep then takes three times as long (benchmarks/sweeping.md).
    """
    if sys.platform != "linux":
        return
    # Loading it takes some milliseconds.
    import ctypes

    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_TRIM_THRESHOLD, KEPT_BYTES)
        mallopt(M_MMAP_THRESHOLD, OWN_MAPPING_BYTES)


def begin_worker() -> None:
    """Prepare a process that computes many tasks, one after the other."""
    collect_rarely()
    keep_freed_memory()
