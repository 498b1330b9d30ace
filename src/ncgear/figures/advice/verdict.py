"""The verdict on a machine: one list of conditions, and of each whether it is kept, broken or not judged, and why.

Every command that tells whether something is wrong with a machine takes it from here.  What a condition is called, when
it concerns a design and what judges it stands in ``CONDITIONS``; their order is that of ``Kind``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from enum import IntEnum, StrEnum
from time import process_time
from typing import Any

from ncgear.design.keys.design import Design
from ncgear.design.words import listed
from ncgear.errors import DesignError
from ncgear.figures.advice import (
    drivetrain_advice,
    given_advice,
    law_advice,
    machine_advice,
    strength_advice,
    tried_advice,
)
from ncgear.figures.advice.values import ONLY_TEETH, Advice, Kind, NotJudged, Remedy, in_file
from ncgear.frozen import dataclass
from ncgear.project.alternatives import is_accepted, is_given
from ncgear.project.drive import Drive

MEANS = ("motion", "gears")
"""Groups of keys that say by what means a machine does its work: these are what advices are about.  All others say what
it has to do, and what a person has given there is changed by no remedy."""


class KnownParts(IntEnum):
    """What is known of a machine when it is judged: its motion and pitch curves, as a check has them, or its teeth."""

    MOTION = 1
    TEETH = 2


TEETH = KnownParts.TEETH


GOOD, GOOD_AS_JUDGED = "No warnings.", "No warnings of what was judged."


class State(StrEnum):
    """What was found of a condition."""

    KEPT = "kept"
    BROKEN = "broken"
    NOT_JUDGED = "not judged"


Found = Advice | NotJudged | None

Judge = Callable[[Drive], Found | Iterable[Found]]
"""What finds the faults of a condition, or one; None where it is kept."""


def _gears(drive: Drive) -> bool:
    return drive.design.gears is not None


def _bears(drive: Drive) -> bool:
    return _gears(drive) and drive.design.loads_teeth


def _loaded(drive: Drive) -> bool:
    return _gears(drive) and (drive.design.resistance is not None or drive.design.masses is not None)


def _motor(drive: Drive) -> bool:
    """Whether there is a motor: behind a gearbox, or of a simulation, which follows one pair of gears."""
    design, around = drive.design, drive.design.drivetrain
    simulated = design.simulation.motor is not None and design.stages == 1
    geared = around is not None and around.motor is not None
    return _gears(drive) and drive.masses_left_out is None and (simulated or geared)


def _always(_: Drive) -> bool:
    return True


@dataclass(frozen=True, eq=False)
class Condition:
    """A condition: its name in a list, what is true where it is kept, what judges it from when on, whom it concerns.

    Without a ``judge`` it is the function of ``teeth_advice`` with the kind's name.  ``roughly`` judges it where less
    is known; without it, such a condition is not judged then.  ``of_pair`` says that it is judged of each pair, else of
    the whole machine.
    """

    name: str
    kept: str
    judge: Judge | None = None
    needs: KnownParts = KnownParts.MOTION
    roughly: Judge | None = None
    concerns: Callable[[Drive], bool] = _gears
    of_pair: bool = True

    def judge_of(self, kind: Kind) -> Judge:
        """What judges it once enough is known; a check does not load ``teeth_advice``, which is slow."""
        if self.judge is not None:
            return self.judge
        from ncgear.figures.advice import teeth_advice

        return getattr(teeth_advice, kind.value)


CONDITIONS: dict[Kind, Condition] = {
    Kind.MADE: Condition(
        "making the gears", "the gears can be made", machine_advice.bodies, TEETH, machine_advice.made
    ),
    Kind.STRENGTH: Condition(
        "strength", "the teeth hold their load", strength_advice.strength, TEETH, strength_advice.rough, _bears
    ),
    Kind.FLANKS: Condition(
        "film and wear", "flanks neither scuff nor wear away", strength_advice.flanks, TEETH, concerns=_loaded
    ),
    Kind.VIBRATION: Condition(
        "vibration",
        "the mesh resonates at no place of the turn",
        strength_advice.vibration,
        TEETH,
        strength_advice.rough_vibration,
        _loaded,
    ),
    Kind.ROOM: Condition(
        "room",
        "gears of a row that do not mesh pass each other",
        needs=TEETH,
        roughly=machine_advice.room_of_pitch_curves,
        concerns=lambda drive: _gears(drive) and drive.gears.idlers is not None,
        of_pair=False,
    ),
    Kind.JAMS: Condition("assembly", "the gears can be put together and turn", needs=TEETH),
    Kind.CONTACT_RATIO: Condition("contact", "flanks touch at every position", needs=TEETH),
    Kind.PRESSURE_ANGLE: Condition(
        "pressure angle", f"the pressure angle stays within {law_advice.STEEPEST_DEG:g} deg", law_advice.pressure_angle
    ),
    Kind.TRANSMISSION_ANGLE: Condition(
        "transmission angle",
        f"the transmission angle stays over the angle of friction, {machine_advice.FLATTEST_DEG:g} deg unless "
        "drivetrain.guide_friction is given",
        machine_advice.transmission_angle,
        concerns=lambda drive: bool(drive.linkage.RODS),
        of_pair=False,
    ),
    Kind.CRANK_PIN: Condition(
        "crank pin",
        "the crank pin, as thick as the file says or else as the shaft of its crank, passes shafts and hubs",
        lambda drive: (*law_advice.crank_pin(drive), law_advice.pin_beside_hub(drive)),
        concerns=lambda drive: _gears(drive) and drive.turns_crank and drive.linkage.RETURNS,
    ),
    Kind.ROD: Condition(
        "rods",
        "the rods, as wide as fit.rod_width_mm says or else their centre lines, pass what stands in their plane",
        law_advice.rods,
        concerns=lambda drive: _gears(drive) and drive.moves_output and bool(drive.linkage.rod_lines_mm),
    ),
    Kind.MOTOR: Condition(
        "motor",
        "the motor moves the machine at its speed and is not overloaded",
        drivetrain_advice.motor,
        TEETH,
        drivetrain_advice.motor_without_teeth,
        _motor,
        of_pair=False,
    ),
    Kind.DRIVETRAIN: Condition(
        "drivetrain",
        "shafts, keys, bearings and couplings hold",
        drivetrain_advice.around,
        TEETH,
        lambda drive: (*drivetrain_advice.of_bores(drive), NotJudged(ONLY_TEETH)),
        lambda drive: drive.design.drivetrain is not None,
        of_pair=False,
    ),
    Kind.MISSED_WISH: Condition(
        "wishes",
        "the motion keeps every hard wish",
        machine_advice.missed_wishes,
        concerns=lambda drive: bool(drive.outcomes),
        of_pair=False,
    ),
    Kind.SPEEDS: Condition(
        "speed",
        "the law's velocities are told at the machine's speed",
        law_advice.speeds,
        concerns=lambda drive: drive.law.stroke is not None,
        of_pair=False,
    ),
    Kind.DRAWING: Condition(
        "drawing",
        "the drawing names the unit of the design, and its parts meet",
        machine_advice.drawing,
        concerns=lambda drive: drive.design.motion.contour is not None,
        of_pair=False,
    ),
    Kind.NEGATIVE_RESISTANCE: Condition(
        "resistance",
        "the resistance is nowhere negative",
        lambda drive: [law_advice.negative_resistance(drive, returning) for returning in (False, True)],
        concerns=lambda drive: drive.design.resistance is not None,
        of_pair=False,
    ),
    Kind.WITHOUT_EFFECT: Condition(
        "what is given",
        "what is given acts",
        given_advice.with_teeth,
        TEETH,
        given_advice.before_teeth,
        _always,
        of_pair=False,
    ),
    Kind.RATIO_RANGE: Condition(
        "ratio",
        f"the ratio stays within 1:{law_advice.WIDEST_RATIO:g} and {law_advice.WIDEST_RATIO:g}:1",
        law_advice.ratio_range,
        concerns=_always,
    ),
    Kind.INDEX_HOLES: Condition(
        "index holes",
        "both gears have their index hole",
        needs=TEETH,
        concerns=lambda drive: _gears(drive) and drive.gears.index_holes,
    ),
    Kind.UNDERCUT: Condition("undercut", "no tooth is undercut", needs=TEETH),
    Kind.POINTED: Condition("points", "no tip is pointed", needs=TEETH),
    Kind.SHORTENED: Condition("tips", "tips have their height", needs=TEETH),
    Kind.CONCAVE: Condition("hob", "no pitch curve is concave", law_advice.concave),
    Kind.RING: Condition(
        "ring",
        "no gear is internal",
        law_advice.ring,
        concerns=lambda drive: _gears(drive) and drive.gears.mesh == "internal",
    ),
    Kind.THRUST: Condition(
        "thrust",
        "bearings are given for the thrust, if there is any",
        concerns=lambda drive: _gears(drive) and drive.helix is not None,
    ),
    Kind.IDLE_FLANKS: Condition(
        "idle flanks",
        "idle flanks hold as pushing ones do",
        needs=TEETH,
        concerns=lambda drive: _gears(drive) and drive.gears.drives != "both_ways",
    ),
}
"""All conditions, the most serious first, as ``Kind`` has them."""


@dataclass(frozen=True, eq=False)
class JudgedCondition:
    """What was found of a condition, of one pair where there are two; ``why`` it was not judged, else empty."""

    kind: Kind
    stage: int | None
    advices: tuple[Advice, ...]
    why: str = ""

    @property
    def state(self) -> State:
        """Broken where something matters, whatever else was not judged."""
        if any(advice.matters for advice in self.advices):
            return State.BROKEN
        return State.NOT_JUDGED if self.why else State.KEPT

    @property
    def of(self) -> str:
        """The beginning of what is said of the pair of a stage."""
        return "" if self.stage is None else f"stage {self.stage}: "


@dataclass(frozen=True, eq=False)
class Verdict:
    """What was found of every condition that concerns a design, the most serious first."""

    rows: tuple[JudgedCondition, ...]

    @property
    def advices(self) -> list[Advice]:
        """All that was found."""
        return [advice for row in self.rows for advice in row.advices]

    @property
    def warnings(self) -> list[Advice]:
        """What matters."""
        return [advice for advice in self.advices if advice.matters]

    def lines(self, *, matter: bool) -> list[str]:
        """The sentences of warnings, or of remarks; where several pairs are judged, each names its pair."""
        several = len({row.stage for row in self.rows} - {None}) > 1
        found = [(row.of * several, advice) for row in self.rows for advice in row.advices]
        return [f"{of}{advice.line}" for of, advice in found if advice.matters is matter]

    def without(self, kind: Kind) -> Verdict:
        """The same but for one condition."""
        return Verdict(tuple(row for row in self.rows if row.kind is not kind))

    @property
    def not_judged(self) -> str:
        """What was not judged, and why, in a sentence; empty where all was."""
        left: dict[str, list[JudgedCondition]] = {}
        for row in self.rows:
            if row.state is State.NOT_JUDGED:
                left.setdefault(row.why, []).append(row)
        parts = [f"{listed(self._names(rows), 'and')} ({why})" for why, rows in left.items()]
        return f"Not judged: {'; '.join(parts)}" if parts else ""

    def _names(self, rows: Sequence[JudgedCondition]) -> list[str]:
        """The names of conditions, each once where it was found so of all pairs."""
        pairs = Counter(row.kind for row in self.rows)
        of_all = Counter(row.kind for row in rows)
        names = (
            CONDITIONS[row.kind].name if pairs[row.kind] == of_all[row.kind] else f"{row.of}{CONDITIONS[row.kind].name}"
            for row in rows
        )
        return list(dict.fromkeys(names))

    @property
    def good(self) -> str:
        """What is said where no condition is broken."""
        return GOOD_AS_JUDGED if self.not_judged else GOOD

    @property
    def table(self) -> list[dict[str, Any]]:
        """A row for each condition, for files; ``because`` says what broke it or why it was not judged."""
        return [
            {
                "condition": str(row.kind),
                "stage": row.stage,
                "says": CONDITIONS[row.kind].kept,
                "verdict": str(row.state),
                "because": "; ".join(advice.what for advice in row.advices if advice.matters) or row.why,
                "remark": "; ".join(advice.what for advice in row.advices if not advice.matters),
            }
            for row in self.rows
        ]


def together(verdicts: Iterable[Verdict]) -> Verdict:
    """The verdict on a machine from the verdicts on its pairs; each of them says the same of the whole machine."""
    rows = {(row.kind, row.stage): row for verdict in verdicts for row in verdict.rows}
    serious = list(CONDITIONS)
    return Verdict(tuple(sorted(rows.values(), key=lambda row: (serious.index(row.kind), row.stage or 0))))


def judged(
    drive: Drive, known: KnownParts, found: Sequence[Advice] = (), seconds: float = tried_advice.MOST_SECONDS
) -> Verdict:
    """The verdict on a machine and its pairs of gears, or on one pair and the whole machine.

    ``found`` is what a command itself has found of the whole machine.  Values of remedies that only trials tell are
    searched for with so many ``seconds`` of processor time at the most.

    Raises as the drive does where teeth are known.
    """
    rows = []
    for kind, condition in CONDITIONS.items():
        also = tuple(advice for advice in found if advice.kind is kind)
        for pair in drive.by_stage if condition.of_pair else (drive,):
            if condition.concerns(pair):
                row = _judged(pair, kind, condition, known)
                if any(map(tried_advice.is_without_value, row.advices)):
                    begun = process_time()
                    row = _tried(pair, row, condition.judge_of(kind), seconds)
                    seconds -= process_time() - begun
                told = (_as_the_file_has_it(advice, drive.design) for advice in row.advices)
                rows.append(replace(row, advices=(*told, *also)))
    return Verdict(tuple(rows))


NO_CURVES = "there are no such pitch curves"
"""Why a condition is not judged where pitch curves are refused."""


def _judged(drive: Drive, kind: Kind, condition: Condition, known: KnownParts) -> JudgedCondition:
    stage = drive.stage if condition.of_pair else None
    judge = condition.judge_of(kind) if known >= condition.needs else condition.roughly
    if judge is None:
        return JudgedCondition(kind, stage, (), ONLY_TEETH)
    try:
        found = _found(judge, drive)
    except DesignError:
        if known is KnownParts.TEETH:
            raise
        return JudgedCondition(kind, stage, (), NO_CURVES)
    advices = tuple(_within_what_is_asked(answer, drive.design) for answer in found if isinstance(answer, Advice))
    return JudgedCondition(
        kind, stage, advices, "; ".join(answer.why for answer in found if isinstance(answer, NotJudged))
    )


def _found(judge: Judge, drive: Drive) -> list[Advice | NotJudged]:
    found = judge(drive)
    return [answer for answer in (found if isinstance(found, Iterable) else (found,)) if answer is not None]


def _tried(drive: Drive, row: JudgedCondition, judge: Judge, seconds: float) -> JudgedCondition:
    """What was found of a pair, with the values of remedies that trials tell."""

    def again(changed: Drive) -> bool:
        return not any(isinstance(advice, Advice) and advice.matters for advice in _found(judge, changed))

    advices = (tried_advice.with_values(advice, again, drive, seconds) for advice in row.advices)
    return replace(row, advices=tuple(_within_what_is_asked(advice, drive.design) for advice in advices))


def _within_what_is_asked(advice: Advice, design: Design) -> Advice:
    """The advice without remedies that undo what is asked of the machine, or that its file may not have; first changes
    that leave every given key.
    """
    kept = [
        remedy
        for remedy in advice.remedies
        if all(key.partition(".")[0] in MEANS for key in _overwritten(remedy, design))
        and is_accepted(design, {change.key: change.value for change in remedy.changes})
    ]
    kept.sort(key=lambda remedy: not remedy.changes or bool(_overwritten(remedy, design)))
    return replace(advice, remedies=tuple(kept))


def _as_the_file_has_it(advice: Advice, design: Design) -> Advice:
    """The advice with the keys of the file in its remedies."""
    remedies = (replace(remedy, changes=in_file(design, remedy.changes)) for remedy in advice.remedies)
    return replace(advice, remedies=tuple(remedies))


def _overwritten(remedy: Remedy, design: Design) -> list[str]:
    return [change.key for change in remedy.changes if is_given(design, change.key)]
