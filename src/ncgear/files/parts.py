"""A table of designs in parts: a folder of Parquet files, each written at one instant, from which a run continues.

A part's bytes depend on its rows alone: no time, no name of a computer, no order of completion.  Checksums, the digest
of the run and the number of the part reveal a file that is cut off or damaged, or belongs to another run or place.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ncgear.errors import WrongInput, going_on
from ncgear.files.one_file import UNFINISHED, is_there, locked, put_in_place
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.screening.designs import Designs

if TYPE_CHECKING:
    import pyarrow

NUMBER, VERDICT = "number", "verdict"

RUN, PART = b"ncgear.run", b"ncgear.part"
"""Keys of a file's metadata that hold the digest of its run, and the number of the part."""

PLAN = "_run.json"
"""The file that describes the run of a folder's parts; readers of Parquet folders ignore names that begin with "_"."""


def table_bytes(designs: Designs, digest: str, part: int) -> bytes:
    """The designs of a part as a Parquet file: number, keys, figures (null where not known), verdict."""
    import pyarrow as arrow
    from pyarrow import parquet

    columns = {
        NUMBER: arrow.Array.from_buffers(
            arrow.int64(), len(designs.numbers), [None, _buffer(designs.numbers.astype(np.int64))]
        ),
        **{name: _numbers(values) for name, values in {**designs.values, **designs.figures}.items()},
        VERDICT: _texts(designs.verdicts.tolist()),
    }
    table = arrow.table(columns).replace_schema_metadata(_belonging(digest, part))
    made = BytesIO()
    # Figures of designs hardly repeat: a dictionary would be tried for each column, and given up.
    parquet.write_table(table, made, compression="zstd", use_dictionary=[VERDICT], write_page_checksum=True)
    return made.getvalue()


def _belonging(digest: str, part: int) -> dict[bytes, bytes]:
    """The metadata of a file that name its run and its part."""
    return {RUN: digest.encode(), PART: str(part).encode()}


def _numbers(values: Array) -> pyarrow.Array:
    """Numbers as a column, null where not known; ``pyarrow.array`` would load pandas in every process."""
    import pyarrow as arrow

    known = ~np.isnan(values)
    valid = None if known.all() else _buffer(np.packbits(known, bitorder="little"))
    return arrow.Array.from_buffers(arrow.float64(), values.size, [valid, _buffer(values.astype(float))])


def _read(column: pyarrow.ChunkedArray, kind: type[Any]) -> np.ndarray[Any, Any]:
    """A column's numbers, NaN where they are not known; its own ``to_numpy`` would load pandas, 50 MB."""
    whole = column.combine_chunks()
    valid, data = whole.buffers()
    here = slice(whole.offset, whole.offset + len(whole))
    values: np.ndarray[Any, Any] = np.frombuffer(data, dtype=kind)[here].copy()
    if whole.null_count:
        known = np.unpackbits(np.frombuffer(valid, dtype=np.uint8), bitorder="little")[here]
        values[known == 0] = np.nan
    return values


def _texts(texts: Sequence[str]) -> pyarrow.Array:
    import pyarrow as arrow

    encoded = [text.encode() for text in texts]
    ends = np.cumsum([0, *map(len, encoded)]).astype(np.int32)
    content = arrow.py_buffer(b"".join(encoded))
    return arrow.Array.from_buffers(arrow.string(), len(encoded), [None, _buffer(ends), content])


def _buffer(values: np.ndarray[Any, Any]) -> pyarrow.Buffer:
    import pyarrow as arrow

    return arrow.py_buffer(np.ascontiguousarray(values))


@dataclass(frozen=True)
class Parts:
    """The parts of one run in a folder; ``plan`` tells in words and numbers what the run is."""

    folder: Path
    plan: Mapping[str, Any]
    keys: tuple[str, ...]

    @property
    def text(self) -> str:
        """The plan as text."""
        return json.dumps(dict(self.plan), indent=2, ensure_ascii=False) + "\n"

    @property
    def digest(self) -> str:
        """A digest that all parts of this run share, and no other run has."""
        return sha256(self.text.encode()).hexdigest()[:16]

    def path(self, part: int) -> Path:
        """The file of a part."""
        return self.folder / f"part-{part:06d}.parquet"

    def add(self, part: int, content: bytes) -> None:
        """Write a part; raises WrongInput when that cannot be done."""
        with going_on():
            put_in_place(self.path(part), content)

    def begun(self, counts: Sequence[int]) -> list[int]:
        """Make the folder ready, and return the numbers of the parts that it lacks; part i has ``counts[i]`` rows.

        A file that is no whole part of this run counts as lacking.  Raises WrongInput where the folder has another run.
        """
        path = self.folder / PLAN
        if is_there(path):
            self._require_same(path)
        elif is_there(self.folder) and any(self.folder.iterdir()):
            raise WrongInput(
                f"is no folder of a sweep; choose another folder with --out, or remove {self.folder.name}",
                location=str(self.folder),
            )
        else:
            put_in_place(path, self.text.encode())
        for left in self.folder.glob(f".part-*{UNFINISHED}"):
            left.unlink(missing_ok=True)
        return [part for part, count in enumerate(counts) if not self._is_whole(part, count)]

    def _require_same(self, path: Path) -> None:
        remedy = f"choose another folder with --out, or remove {self.folder.name} there"
        try:
            there = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise WrongInput(f"cannot be read ({error}); {remedy}", location=str(path)) from error
        other = [
            f"{key} {_brief(there.get(key))} there, {_brief(self.plan.get(key))} now"
            for key in dict.fromkeys([*self.plan, *there])
            if there.get(key) != self.plan.get(key)
        ]
        if other:
            raise WrongInput(f"holds another run ({'; '.join(other)}); {remedy}", location=str(self.folder))

    def _is_whole(self, part: int, count: int) -> bool:
        if not is_there(self.path(part)):
            return False
        table = self._table(part)
        return table is not None and len(table) == count

    def _table(self, part: int) -> pyarrow.Table | None:
        """A part as a table; None where its file is damaged, of another run, or another part."""
        import pyarrow as arrow
        from pyarrow import parquet

        try:
            with parquet.ParquetFile(self.path(part), page_checksum_verification=True) as file:
                known = file.schema_arrow.metadata or {}
                belongs = _belonging(self.digest, part).items() <= known.items()
                return file.read(use_threads=False) if belongs else None
        except (OSError, arrow.ArrowException, ValueError):
            return None

    def designs(self, part: int) -> Designs:
        """The rows of a part; raises WrongInput where its file has been changed since the run began."""
        table = self._table(part)
        if table is None:
            raise WrongInput("has changed while the sweep ran; run it again", location=str(self.path(part)))
        columns = {name: table.column(name) for name in table.column_names}
        numbers = _read(columns.pop(NUMBER), np.int64)
        verdicts = np.array(columns.pop(VERDICT).to_pylist(), dtype=object)
        values = {name: _read(column, np.float64) for name, column in columns.items()}
        return Designs(numbers, {key: values.pop(key) for key in self.keys}, values, verdicts)


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """A context of a folder that one run at a time can enter; raises WrongInput where another run works there."""
    with (folder / PLAN).open("rb") as held:
        if not locked(held.fileno(), wait=False):
            problem = "another run is at work here; wait for it, or choose another folder with --out"
            raise WrongInput(problem, location=str(folder))
        yield


def _brief(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False) if value is not None else "none"
    return text if len(text) <= 60 else f"{text[:57]}..."
