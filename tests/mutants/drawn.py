"""Mutations of a room at random.  Those of lines that nobody has changed stay the same, whatever else has changed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path

from mutants.mutations import mutations

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"


@dataclass(frozen=True)
class Mutant:
    """A module, named from ``src`` on, with one mutation: its source as mutated, the line, and what it says."""

    module: str
    source: bytes
    line: int
    before: str
    after: str
    again: int
    """Which one it is of mutations of this module that say the same."""

    @property
    def room(self) -> str:
        """The folder of ``ncgear`` that the module is in."""
        return self.module.split("/")[1]

    @property
    def key(self) -> str:
        """Its name, which changes only with the line itself."""
        return sha256(f"{self.module}\n{self.before}\n{self.after}\n{self.again}".encode()).hexdigest()[:12]

    @cached_property
    def written(self) -> str:
        """What stays the same while the whole module does."""
        return sha256(self.source).hexdigest()[:12]


def rooms() -> list[Path]:
    """The folders of ``ncgear``."""
    return [path for path in sorted((SOURCE / "ncgear").iterdir()) if path.is_dir() and path.name != "__pycache__"]


def drawn(room: Path, count: int, seed: int) -> list[Mutant]:
    """So many mutations of a room at random; fewer are the first ones of more."""
    every = [mutant for path in sorted(room.rglob("*.py")) for mutant in _of(path)]
    return sorted(every, key=lambda mutant: sha256(f"{seed} {mutant.key}".encode()).digest())[:count]


def _of(path: Path) -> Iterator[Mutant]:
    source, module = path.read_bytes(), str(path.relative_to(SOURCE))
    seen: Counter[tuple[str, str]] = Counter()
    for one in mutations(source):
        mutated = one.applied(source)
        before, after = _changed(source, mutated)
        yield Mutant(module, mutated, one.line, before, after, seen[before, after])
        seen[before, after] += 1


def _changed(source: bytes, mutated: bytes) -> tuple[str, str]:
    """The line before and after."""
    pairs = zip(source.decode().splitlines(), mutated.decode().splitlines(), strict=True)
    before, after = next((old, new) for old, new in pairs if old != new)
    return before.strip(), after.strip()
