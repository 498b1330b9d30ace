"""What every command prints: its answer on one screen, every figure, or the figures as JSON for programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from ncgear.figures.answers.answer import Answer


def tell(
    answer: Answer,
    *of_pairs: Mapping[str, Any],
    as_json: bool,
    verbose: bool,
    paths: Sequence[Path] = (),
    kept: Sequence[Path] = (),
) -> None:
    """Print an answer with the files written and kept, or with ``verbose`` all of it and every figure, or JSON.

    The figures, and what is raised, are those of ``print_figures``.
    """
    from ncgear.figures.answers.answer import answer_text
    from ncgear.figures.every_figure import full_text

    if as_json:
        print_figures(*of_pairs, kept=kept)
    else:
        typer.echo(full_text(answer, of_pairs, paths, kept) if verbose else answer_text(answer, paths, kept))


def print_figures(*of_pairs: Mapping[str, Any], kept: Sequence[Path] = ()) -> None:
    """Print figures as one JSON document to stdout, and to stderr the files of others that were ``kept``.

    The figures are those of the JSON file that the command writes, to the digit.  Of two pairs in series that are told
    one by one they stand below ``stages``.  Raises Unanswered, before anything is printed, where a figure is no
    finite number.
    """
    from ncgear.figures.numbers import json_text

    by_stage = {f"stage_{number}": figures for number, figures in enumerate(of_pairs, start=1)}
    typer.echo(json_text(of_pairs[0] if len(of_pairs) == 1 else {"stages": by_stage}).rstrip())
    if kept:
        from ncgear.figures.terminal import kept_lines

        typer.echo("\n".join(kept_lines(kept)), err=True)
