"""Mutations of a room at random.  Those of lines that nobody has changed stay the same, whatever else has changed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path

from mutants.mutations import Mutation, mutations

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"


@dataclass(frozen=True)
class Mutant:
    """A module, named from ``src`` on, its source, one mutation of it, and what the line says before and after."""

    module: str
    whole: bytes
    mutation: Mutation
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

    @property
    def line(self) -> int:
        """The line that is mutated."""
        return self.mutation.line

    @cached_property
    def source(self) -> bytes:
        """The mutated source."""
        return self.mutation.applied(self.whole)

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
        start, end = source.rfind(b"\n", 0, one.start) + 1, source.index(b"\n", one.end)
        line = source[start:end], source[start : one.start] + one.new.encode() + source[one.end : end]
        before, after = (text.decode().strip() for text in line)
        yield Mutant(module, source, one, before, after, seen[before, after])
        seen[before, after] += 1
