"""What is told of the speed and error of a design's stages: figures, a table with a row per trial, the answer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ncgear.figures.answers.answer import Answer, Fault, Row
from ncgear.figures.numbers import fixed, micrometres, to_digits
from ncgear.figures.tables import rows_text
from ncgear.project.bench import BenchStage, dominating


def bench_figures(stages: Sequence[BenchStage], name: str) -> dict[str, Any]:
    """Plain values; a recommendation is None where no trial was fine enough."""
    slowest = dominating(list(stages))
    return {
        "design": {"name": name},
        "dominating_stage": slowest.name if slowest else None,
        "stages": {stage.name.replace(" ", "_"): _stage_figures(stage) for stage in stages},
    }


KEYS = ("varied", "varied_unit", "error_of", "error_unit", "reference", "asked_error", "asked_by", "used", "order")
COLUMNS = ("stage", "varied", "setting", "size", "time_s", "error", "error_unit", "asked_error", "recommended")


def _stage_figures(stage: BenchStage) -> dict[str, Any]:
    recommended = stage.recommended and vars(stage.recommended)
    trials = {"recommended": recommended, "trials": list(map(vars, stage.trials))}
    return {key: getattr(stage, key) for key in KEYS} | trials


def bench_csv(stages: Sequence[BenchStage]) -> str:
    """A row for each trial; ``recommended`` is 1 for the recommended trial, else 0."""
    told = (
        vars(of) | vars(trial) | {"stage": of.name, "recommended": int(trial is of.recommended)}
        for of in stages
        for trial in of.trials
    )
    return rows_text(COLUMNS, ([row[column] for column in COLUMNS] for row in told))


def setting_words(stage: BenchStage, setting: float) -> str:
    """A setting with its unit."""
    return f"{to_digits(setting, 3)} {stage.varied_unit}".rstrip()


def error_words(stage: BenchStage, error: float) -> str:
    """An error as a length or as a share."""
    return micrometres(error) if stage.error_unit == "mm" else f"{to_digits(100.0 * error, 2)} %"


def time_words(time_s: float) -> str:
    """A time in s or ms."""
    return f"{to_digits(time_s, 3)} s" if time_s >= 1.0 else f"{to_digits(1e3 * time_s, 2)} ms"


def bench_answer(stages: Sequence[BenchStage], name: str, then: str) -> Answer:
    """A row for each stage, what dominates, and the stages for which nothing tried was fine enough."""
    recommended = [(stage, stage.recommended) for stage in stages]
    asked = {stage.name: error_words(stage, stage.asked_error) for stage in stages}
    whole = sum(trial.time_s for _, trial in recommended if trial)
    rows = [
        Row(
            f"{stage.name}: {stage.varied}",
            (
                setting_words(stage, trial.setting),
                setting_words(stage, stage.used),
                error_words(stage, trial.error),
                asked[stage.name],
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
                f"{stage.name}: no {stage.varied} tried is within {asked[stage.name]}; the finest has "
                f"{error_words(stage, stage.trials[-1].error)}",
                ("a greater output.chord_tolerance_mm",) if stage.asked_by else (),
            )
            for stage, trial in recommended
            if trial is None
        ),
        "Recommended: the coarsest whose measured error, and that of all finer ones, is within what is asked",
        heads=("recommended", "a build uses", "error", "asked", "time", "share"),
        good="Every stage reaches what is asked.",
        then=then,
    )
