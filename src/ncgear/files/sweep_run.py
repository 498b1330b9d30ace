"""The run of a sweep: parts on processes or on a cluster, each written when it is done; a killed run can be continued.

Workers send finished parts as the bytes of their files, and this process alone writes: workers of a cluster need no
common disk.  The choice and the pictures come afterwards from the files, in the order of their numbers.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from functools import partial
from hashlib import sha256
from math import ceil, log2
from pathlib import Path
from typing import Any

import numpy as np

from ncgear import __version__
from ncgear.design.keys.design import Design
from ncgear.design.reading.design_file import LoadedDesign
from ncgear.design.space import Ranged, Space
from ncgear.extras import require
from ncgear.files.parts import Parts, alone_in, table_bytes
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.project.law import lobes_of
from ncgear.project.moving import states_inertia
from ncgear.ratio.transmission import Lobes
from ncgear.screening.batch import kind_of
from ncgear.screening.deeper import deepened, deeper_names, require_stage
from ncgear.screening.designs import Counted, Designs, Screening, joined, screened_part
from ncgear.screening.overview import Overview, no_overview
from ncgear.screening.single import figure_names
from ncgear.screening.wanted import Wanted, best_rows
from ncgear.workers import finished

TABLE = "sweep.parquet"
"""The folder of all designs in the output folder."""

ROWS = 4096
"""Designs in a part where designs are computed together: about a second of work, and under a megabyte."""

MOST_ROWS = 16384
"""Designs in a part of the largest sweeps."""

PARTS = 1024
"""Largest number of parts before the parts become larger."""

ROWS_ALONE = 16
"""Fewest designs in a part where each design is computed alone: a second or two of work."""

ROWS_DEEPER = 4
"""Fewest designs in a part of a later stage: half a second of work, or a few seconds."""

STAGES = ("check", "pitch", "teeth", "contact", "strength")


@dataclass(frozen=True)
class Order:
    """The order of a sweep; ``keep`` is the number of designs that go on to a stage after the pitch curves."""

    space: Space
    stage: str = "pitch"
    keep: int = 100


def screening_of(design: Design, data: dict[str, Any], order: Order) -> Screening:
    """The screening of the first two stages; a stage ``check`` omits gears that change neither motion nor power."""
    check_only = order.stage == "check"
    needless = check_only and not _gears_count(design, order.space)
    screened = {key: value for key, value in data.items() if not (needless and key == "gears")}
    names = tuple(name for name in figure_names(design) if not (check_only and name.startswith("pitch.")))
    rows = rows_of_part(order.space.count, ROWS if kind_of(design) is not None else ROWS_ALONE)
    return Screening(screened, order.space, names, rows)


def _gears_count(design: Design, space: Space) -> bool:
    """Whether motion and power depend on the gears: by lobes or inertia, or because the sweep varies the gears."""
    varied = any(key.startswith("gears.") for key in space.keys)
    weighed = design.masses is not None and not states_inertia(design.masses, design.stages)
    return varied or weighed or lobes_of(design) != Lobes()


def rows_of_part(count: int, fewest: int) -> int:
    """Designs in a part: it depends on nothing but the sweep, so that parts are the same wherever they are computed."""
    for_parts = 1 << max(0, ceil(log2(max(count, 1) / PARTS)))
    return max(fewest, min(for_parts, MOST_ROWS))


def names_of(design: Design, screening: Screening, stage: str) -> tuple[str, ...]:
    """All figures of a sweep down to a stage, and the keys that vary."""
    deeper = deeper_names(design, stage) if _is_deep(stage) else ()
    return (*screening.figures, *deeper, *screening.space.keys)


def _is_deep(stage: str) -> bool:
    return STAGES.index(stage) > STAGES.index("pitch")


def plan_of(loaded: LoadedDesign, screening: Screening, stage: str) -> dict[str, Any]:
    """All values on which the parts of a sweep depend, in words and numbers."""
    space = screening.space
    varied = {
        quantity.key: [quantity.low, quantity.high] if isinstance(quantity, Ranged) else _few(list(quantity.values))
        for quantity in space.varied
    }
    sampled = {"samples": space.samples, "sampling": space.sampling, "seed": space.seed} if space.ranges else {}
    return {
        "ncgear": __version__,
        "design": loaded.design.name,
        "design_sha256": _digest(loaded.data),
        "varied": varied,
        **sampled,
        "stage": "check" if stage == "check" else "pitch",
        "designs": space.count,
        "designs_in_a_part": screening.rows,
    }


def _few(values: list[float]) -> Any:
    """The values; for very many values only a digest that distinguishes them from others."""
    if len(values) <= 100:
        return values
    return {"first": values[0], "last": values[-1], "count": len(values), "sha256": _digest(values)}


def _digest(content: Any) -> str:
    return sha256(json.dumps(content, ensure_ascii=False, default=str).encode()).hexdigest()


@dataclass(frozen=True)
class Swept:
    """A finished sweep: all designs, and the designs of a later stage, if any; each with the folder of its parts."""

    screened: Overview
    screened_parts: Parts
    deeper: Overview | None = None
    deeper_parts: Parts | None = None

    @property
    def last(self) -> Overview:
        """The overview of the last stage."""
        return self.deeper or self.screened

    @property
    def tables(self) -> list[Path]:
        """The folders of the tables."""
        return [parts.folder for parts in (self.screened_parts, self.deeper_parts) if parts is not None]


def swept(
    loaded: LoadedDesign,
    order: Order,
    screening: Screening,
    wanted: Wanted,
    folder: Path,
    on_done: Counted,
    scheduler: str | None = None,
    processes: int | None = None,
) -> Swept:
    """Run a sweep in a folder, or its missing parts.

    All designs are screened.  The makeable designs that keep the constraints on figures known by then can go on to a
    later stage; the ``keep`` best of them by the objectives known by then do.  ``scheduler`` and ``processes`` say
    where designs are computed, as in ``ncgear.workers``.  Raises WrongInput where pyarrow is not installed, where the
    folder has another run or cannot be written, and where no design can reach the stage.
    """
    require("pyarrow", "sweep", "ncgear sweep")
    if _is_deep(order.stage):
        require_stage(loaded.design, order.stage)
    plan = plan_of(loaded, screening, order.stage)
    parts = Parts(folder / TABLE, plan, screening.space.keys)
    counts = [min(screening.rows, screening.space.count - part * screening.rows) for part in range(screening.parts)]
    on = partial(finished, scheduler=scheduler, processes=processes)
    with ExitStack() as held:
        known = wanted.of((*screening.figures, *screening.space.keys))
        compute = partial(_screened_bytes, screening, parts.digest)
        _computed(parts, counts, compute, screening.values, on, on_done, held)
        overview, choice = _gathered(parts, len(counts), screening.space, known, chosen=_is_deep(order.stage))
        if not _is_deep(order.stage):
            return Swept(overview, parts)
        numbers = np.sort(choice[0][best_rows(choice[1], order.keep)])
        rows = rows_of_part(len(numbers), ROWS_DEEPER)
        deep_plan = {**plan, "stage": order.stage, "chosen": len(numbers), "chosen_sha256": _digest(numbers.tolist())}
        deep = Parts(folder / f"{order.stage}.parquet", {**deep_plan, "designs_in_a_part": rows}, parts.keys)
        taken = [numbers[first : first + rows] for first in range(0, len(numbers), rows)]
        tasks = partial(_chosen, parts, screening.rows, taken)
        names = deeper_names(loaded.design, order.stage)
        compute = partial(_deeper_bytes, screening.data, names, order.stage, deep.digest)
        _computed(deep, [len(part) for part in taken], compute, tasks, on, on_done, held)
        below, _ = _gathered(deep, len(taken), screening.space, wanted)
    return Swept(overview, parts, below, deep)


def _screened_bytes(screening: Screening, digest: str, task: tuple[int, Array]) -> bytes:
    return table_bytes(screened_part(screening, *task), digest, task[0])


def _deeper_bytes(
    data: dict[str, Any], names: Sequence[str], stage: str, digest: str, task: tuple[int, Designs]
) -> bytes:
    return table_bytes(deepened(data, names, stage, task[1]), digest, task[0])


def _chosen(parts: Parts, rows: int, taken: Sequence[Any], part: int) -> Designs:
    """The designs of a part that go deeper, read from the table of all."""
    numbers = taken[part]
    found = []
    for screened in np.unique(numbers // rows).tolist():
        designs = parts.designs(screened)
        found.append(designs.at(np.isin(designs.numbers, numbers)))
    return joined(found)


def _computed(
    parts: Parts,
    counts: Sequence[int],
    compute: Callable[[tuple[int, Any]], bytes],
    tasks: Callable[[int], Any],
    on: Callable[..., Iterator[tuple[tuple[int, Any], bytes]]],
    on_done: Counted,
    held: ExitStack,
) -> None:
    """Compute and write the parts that the folder lacks."""
    missing = parts.begun(counts)
    held.enter_context(alone_in(parts.folder))
    total, done = sum(counts), sum(counts) - sum(counts[part] for part in missing)
    on_done(done, total)
    if len(missing) <= 1 and on.keywords["scheduler"] is None:  # type: ignore[attr-defined]
        # A process of its own would take longer to begin than a single part takes.
        on = partial(on, processes=1)
    for (part, _), content in on(compute, ((part, tasks(part)) for part in missing), count=len(missing)):
        parts.add(part, content)
        done += counts[part]
        on_done(done, total)


def _gathered(
    parts: Parts, count: int, space: Space, wanted: Wanted, chosen: bool = False
) -> tuple[Overview, tuple[Any, Any]]:
    """The overview of all parts and, where a later stage is asked for, numbers and costs of the designs for it."""
    overview = no_overview(space, wanted)
    numbers, costs = [np.empty(0, dtype=np.intp)], [np.empty((0, len(wanted.objectives)))]
    for part in range(count):
        designs = parts.designs(part)
        overview = overview.with_part(designs)
        if chosen:
            kept = designs.at(wanted.kept(designs))
            numbers.append(kept.numbers)
            costs.append(wanted.costs(kept))
    return overview, (np.concatenate(numbers), np.vstack(costs))
