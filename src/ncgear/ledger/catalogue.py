"""The papers of the ledger."""

from __future__ import annotations

from ncgear.ledger.entry import Paper
from ncgear.ledger.gear_baler import paper as gear_baler

PAPERS: tuple[Paper, ...] = (gear_baler.PAPER,)
