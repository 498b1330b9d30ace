"""The verdict on one condition, without the time that all others take."""

from __future__ import annotations

import pytest

from ncgear.figures.advice import verdict
from ncgear.figures.advice.values import Kind
from ncgear.figures.advice.verdict import KnownParts, Verdict
from ncgear.project.drive import Drive


def verdict_on(kind: Kind, drive: Drive, known: KnownParts) -> Verdict:
    """What is judged of one condition, of each pair of gears where it is of pairs, without trials of remedies."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(verdict, "CONDITIONS", {kind: verdict.CONDITIONS[kind]})
        return verdict.judged(drive, known, seconds=0.0)
