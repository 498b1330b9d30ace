"""The answer about speed and error: for each stage what to set, what that costs, and which stage takes longest."""

from __future__ import annotations

from collections.abc import Sequence

from ncgear.figures.answers.answer import Answer, Fault, Row
from ncgear.figures.bench import error_words, setting_words, time_words
from ncgear.figures.numbers import fixed
from ncgear.project.bench import BenchStage, dominating

HEADS = ("recommended", "a build uses", "error", "asked", "time", "share")


def bench_answer(stages: Sequence[BenchStage], name: str, then: str) -> Answer:
    """A row for each stage, what dominates, and the stages for which nothing tried was fine enough."""
    recommended = [(stage, stage.recommended) for stage in stages]
    whole = sum(trial.time_s for _, trial in recommended if trial)
    rows = [
        Row(
            f"{stage.name}: {stage.varied}",
            (
                setting_words(stage, trial.setting),
                setting_words(stage, stage.used),
                error_words(stage, trial.error),
                error_words(stage, stage.asked),
                time_words(trial.time_s),
                f"{fixed(100.0 * trial.time_s / whole, 0)} %",
            ),
        )
        for stage, trial in recommended
        if trial is not None
    ]
    slowest = dominating(list(stages))
    if slowest is not None:
        rows.append(Row("takes longest", (f"{slowest.name}, as recommended",)))
    return Answer(
        f"{name}: speed against error of each stage",
        tuple(rows),
        tuple(
            Fault(
                f"{stage.name}: no {stage.varied} tried is within {error_words(stage, stage.asked)}; the finest has "
                f"{error_words(stage, stage.trials[-1].error)}",
                ("a greater output.chord_tolerance_mm",) if stage.key else (),
            )
            for stage, trial in recommended
            if trial is None
        ),
        "Recommended: the coarsest whose measured error, and that of all finer ones, is within what is asked",
        heads=HEADS,
        good="Every stage reaches what is asked.",
        then=then,
    )
