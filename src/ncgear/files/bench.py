"""Speed against error as files: figures, a table with a row per trial, a picture of error over time per stage."""

from __future__ import annotations

from collections.abc import Sequence

from ncgear.drawings.plots import canvas
from ncgear.figures.bench import bench_csv, bench_figures, error_words, setting_words
from ncgear.figures.numbers import json_text
from ncgear.project.bench import BenchStage

WIDTH_IN, HEIGHT_IN = 7.2, 4.6

ROOM = 2.5
"""Room around the points, as a factor."""

LEAST = 1e-16
"""Smallest error that a picture shows; smaller errors stand here, since a logarithmic scale has no zero."""


def stage_png(stage: BenchStage, name: str) -> bytes:
    """PNG of the errors of a stage's trials over their times, named by their settings, with the wanted error."""
    made = canvas.figure(
        WIDTH_IN, HEIGHT_IN, f"{name}: {stage.name}, by {stage.varied}", canvas.Margins(left=0.9, right=0.3, top=0.75)
    )
    axes = made.add_subplot()
    times = [1e3 * trial.time_s for trial in stage.trials]
    errors = [max(trial.error, LEAST) for trial in stage.trials]
    axes.plot(times, errors, color=canvas.DRIVING, linewidth=1.4, marker="o", markersize=5, label="tried")
    axes.axhline(
        stage.asked_error,
        color=canvas.REFERENCE,
        linewidth=1.1,
        linestyle="--",
        label=f"asked: {error_words(stage, stage.asked_error)}",
    )
    if best := stage.recommended:
        axes.plot(
            [1e3 * best.time_s],
            [max(best.error, LEAST)],
            "o",
            markersize=12,
            markerfacecolor="none",
            markeredgecolor=canvas.HIGHLIGHT,
            markeredgewidth=1.8,
            label="recommended",
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    canvas.plain_log(axes.xaxis, (1.0, 2.0, 5.0))
    axes.set_xlim(min(times) / ROOM, max(times) * ROOM)
    axes.set_ylim(min(*errors, stage.asked_error) / ROOM, max(*errors, stage.asked_error) * ROOM)
    for time, error, trial in zip(times, errors, stage.trials, strict=True):
        axes.annotate(
            setting_words(stage, trial.setting),
            (time, error),
            xytext=(7.0, 5.0),
            textcoords="offset points",
            size=canvas.SMALL,
            color=canvas.INK,
        )
    unit = f" in {stage.error_unit}" if stage.error_unit == "mm" else f", share {stage.error_unit}"
    canvas.dress(axes, "time in ms", f"error of the {stage.name}{unit}")
    canvas.legend_above(axes)
    return canvas.png(made)


def bench_files(stages: Sequence[BenchStage], name: str) -> dict[str, bytes]:
    """The files by their names."""
    return {
        "bench.json": json_text(bench_figures(stages, name)).encode(),
        "bench.csv": bench_csv(stages).encode(),
        **{f"bench-{stage.name.replace(' ', '-')}.png": stage_png(stage, name) for stage in stages},
    }
