"""One thread per worker: tests run on all cores already, and linear algebra on threads of its own would only wait."""

from __future__ import annotations

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
