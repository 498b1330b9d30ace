"""Speed against error as files: figures, a table with a row per trial, a picture per stage."""

from __future__ import annotations

from collections.abc import Sequence

from ncgear.drawings.bench_pictures import bench_pictures
from ncgear.figures.bench import bench_csv, bench_figures
from ncgear.figures.numbers import json_text
from ncgear.project.bench import Stage


def bench_files(stages: Sequence[Stage], name: str) -> dict[str, bytes]:
    """The files by their names."""
    return {
        "bench.json": json_text(bench_figures(stages, name)).encode(),
        "bench.csv": bench_csv(stages).encode(),
        **bench_pictures(stages, name),
    }
