"""The papers of the ledger."""

from __future__ import annotations

from ncgear.papers.entry import Paper
from ncgear.papers.gear_baler import paper as gear_baler
from ncgear.papers.sieve_and_pan import paper as sieve_and_pan
from ncgear.papers.threshing_drum import paper as threshing_drum
from ncgear.papers.track_chassis import paper as track_chassis

PAPERS: tuple[Paper, ...] = (gear_baler.PAPER, track_chassis.PAPER, threshing_drum.PAPER, sieve_and_pan.PAPER)
