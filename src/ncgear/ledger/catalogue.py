"""The papers of the ledger."""

from __future__ import annotations

from ncgear.ledger.entry import Paper
from ncgear.ledger.gear_baler import paper as gear_baler
from ncgear.ledger.track_chassis import paper as track_chassis

PAPERS: tuple[Paper, ...] = (gear_baler.PAPER, track_chassis.PAPER)
