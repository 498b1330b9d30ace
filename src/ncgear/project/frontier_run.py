"""The computation of a design's frontier, point by point on all cores.

Finished points are kept in a file.  A run after an interrupted run continues from there.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any

from ncgear import __version__
from ncgear.design.keys.design import Design
from ncgear.errors import NoSuchMechanism, WrongInput, going_on
from ncgear.extras import require
from ncgear.frozen import dataclass
from ncgear.interrupts import uninterrupted
from ncgear.optimum.flywheels import FOLLOWED, FlywheelPoint, flywheel_points
from ncgear.optimum.frontier import FamilyPoint, LawPoint, caps_w, family_point, law_point
from ncgear.optimum.offers import Refused
from ncgear.optimum.task import Figures
from ncgear.project.law_task import GearsAsGiven, refuse_guide_friction, with_driven_flywheel
from ncgear.project.offered import may_be_asked
from ncgear.shown import Shown
from ncgear.workers import finished

POINTS_FILE = "frontier-points.jsonl"
"""File of finished points in the output folder, one line each."""

ENTRY = '{"key": "'
"""Beginning of each entry."""


@dataclass(frozen=True)
class Frontier(Shown):
    """Points in the order of their caps; a family point is the best point found at its cap or at a lower cap."""

    laws: list[LawPoint]
    families: list[FamilyPoint]


class FinishedPoints:
    """The points of one design in a file, which may also hold points of other designs or versions of ncgear."""

    def __init__(self, path: Path, design: Design) -> None:
        self.path = path
        self.key = sha256(f"{__version__} {design.model_dump_json()}".encode()).hexdigest()[:16]

    def found(self) -> dict[tuple[str, float], dict[str, Any]]:
        """Results by kind and cap.  Lines that are no entry, or were cut off when a run was killed, are skipped.

        Raises WrongInput where another kind of file has the path of the points.
        """
        results = {}
        for line in self._lines():
            try:
                entry = json.loads(line)
            except json.JSONDecodeError:
                continue
            if isinstance(entry, dict) and entry.get("key") == self.key:
                results[entry["kind"], entry["cap_w"]] = entry["result"]
        return results

    def _lines(self) -> list[str]:
        if not os.path.lexists(self.path):
            return []
        text = ""
        with self._refused():
            text = self.path.read_text(encoding="utf-8", errors="replace") if self.path.is_file() else "no file"
        lines = text.splitlines()
        # A run that was killed at its first entry has left an incomplete line.
        if any(lines) and not any(line.startswith(ENTRY[: len(line)]) for line in lines if line):
            problem = "is no file of finished points; move it away, or choose another folder with --out"
            raise WrongInput(problem, location=str(self.path))
        return lines

    def add(self, kind: str, cap_w: float, result: dict[str, Any]) -> None:
        """Write one more line; raises WrongInput where the disk refuses it."""
        entry = {"key": self.key, "kind": kind, "cap_w": cap_w, "result": result}
        with going_on(), self._refused(), uninterrupted():
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as file:
                # The first line break separates the entry from an incomplete line.
                file.write(f"\n{json.dumps(entry)}\n")

    @contextmanager
    def _refused(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            problem = f"cannot be read or written ({error.strerror or error}); choose another folder with --out"
            raise WrongInput(problem, location=str(self.path)) from error


def frontier(
    design: Design,
    count: int,
    folder: Path,
    on_point: Callable[[int, int], None],
    scheduler: str | None = None,
    processes: int | None = None,
) -> Frontier:
    """The frontier of a design at ``count`` caps; calls ``on_point`` with the numbers of finished and of all points.

    ``scheduler`` and ``processes`` say where the points are computed, as in ``ncgear.workers``.

    Raises WrongInput where there is no load, where the guide has friction, or where the optimiser is not installed, and
    NoSuchMechanism where no law keeps the limits.
    """
    require("casadi", "optimize", "ncgear frontier")
    if design.resistance is None:
        raise WrongInput("missing; without it there is no power to set against acceleration", key="resistance")
    refuse_guide_friction(design, "the power that is capped")
    _refuse_holding_teeth(design)
    kept = FinishedPoints(folder / POINTS_FILE, design)
    found = kept.found()
    caps = found["caps", float(count)]["caps_w"] if ("caps", float(count)) in found else _caps(design, count, kept)
    jobs = [(kind, cap) for cap in caps for kind in ("law", "family")]
    missing = [job for job in jobs if job not in found]
    on_point(len(jobs) - len(missing), len(jobs))
    computed = finished(partial(_point, design), missing, scheduler, processes)
    for done, ((kind, cap), result) in enumerate(computed, start=len(jobs) - len(missing) + 1):
        kept.add(kind, cap, result)
        found[kind, cap] = result
        on_point(done, len(jobs))
    return _assembled(caps, found)


def over_flywheels(design: Design, count: int, on_law: Callable[[int, int], None]) -> list[FlywheelPoint]:
    """Least power with ``count`` sizes of the flywheel on the driven shaft, from the least to the greatest.

    ``on_law`` is called with the numbers of laws done and in all.  Raises WrongInput where the design has no range of
    sizes, where the guide has friction, or where the optimiser is not installed, and NoSuchMechanism where no law is
    found with any size.
    """
    require("casadi", "optimize", "ncgear frontier")
    asked = design.free_flywheel
    if asked is None:
        problem = "missing; give the range of sizes, as {most: 150e6}, to set power against the flywheel"
        raise WrongInput(problem, key="optimize.driven_flywheel_kg_mm2")
    refuse_guide_friction(design, "the power that is set against the flywheel")
    _refuse_holding_teeth(design)
    machine = GearsAsGiven(with_driven_flywheel(design, 0.0))
    return flywheel_points(
        machine.task, machine.wishes, asked.least, asked.most, count, lambda laws: on_law(laws, FOLLOWED * count)
    )


def _refuse_holding_teeth(design: Design) -> None:
    """Refuse laws whose teeth must hold: the gears of a point are not rated."""
    if design.holding_teeth:
        raise WrongInput(
            "true, but the gears of a frontier's points are not rated; leave it out here, and give it with one of the "
            "caps to ncgear optimize",
            key="optimize.limits.teeth_hold",
        )


def _caps(design: Design, count: int, kept: FinishedPoints) -> list[float]:
    """The caps of a frontier of ``count`` points; they are kept in the file as well."""
    machine = GearsAsGiven(design)
    caps = caps_w(machine.task, machine.wishes, count)
    kept.add("caps", float(count), {"caps_w": caps})
    return caps


def _point(design: Design, job: tuple[str, float]) -> dict[str, Any]:
    """One point, computed in its own process; where no law keeps the limits, the error."""
    kind, cap_w = job
    machine = GearsAsGiven(design)
    if kind == "family":
        return asdict(family_point(machine.task, cap_w))
    try:
        return asdict(law_point(machine.task, machine.wishes, cap_w))
    except Refused as refusal:
        return {"refused": refusal.among(lambda offers: may_be_asked(design, offers)).problem}
    except NoSuchMechanism as refusal:
        return {"refused": refusal.problem}


def _assembled(caps: list[float], found: dict[tuple[str, float], dict[str, Any]]) -> Frontier:
    results = [found["law", cap] for cap in caps if "refused" not in found["law", cap]]
    laws = [LawPoint(result["cap_w"], result["limit_mm_s2"], Figures(**result["law"])) for result in results]
    if not laws:
        raise NoSuchMechanism(found["law", caps[0]]["refused"], key="optimize.limits")
    return Frontier(laws, _best_so_far([FamilyPoint(**found["family", cap]) for cap in caps]))


def _best_so_far(points: list[FamilyPoint]) -> list[FamilyPoint]:
    """The best point at each cap or at a lower cap: a law that keeps a cap also keeps every higher cap."""
    best: list[FamilyPoint] = []
    for point in points:
        before = best[-1] if best else None
        if before is not None and before.peak_acceleration_mm_s2 is not None:
            own = point.peak_acceleration_mm_s2
            if own is None or own > before.peak_acceleration_mm_s2:
                point = replace(before, cap_w=point.cap_w)
        best.append(point)
    return best
