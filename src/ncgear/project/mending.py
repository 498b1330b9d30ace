"""The search for a change that makes refused teeth possible, as a good engineer would try: the least change first.

A design with good pitch curves may be refused for its teeth or their contact.  The search changes one or a few of the
keys below ``gears``, and each trial makes the teeth and their contact anew.  A trial without an answer does not help.
The search ends after some seconds of processor time, and tells so.  It runs only on request: the attributes of a drive
only raise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from enum import StrEnum
from functools import partial, reduce
from itertools import product
from math import ceil
from operator import or_
from time import process_time
from typing import assert_never

from ncgear.design.keys.gears import MOST_TEETH
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput, located
from ncgear.frozen import dataclass
from ncgear.interrupts import TimeIsOver, at_most
from ncgear.numerics import jet
from ncgear.numerics.jet import Jet
from ncgear.pitch import shape
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project import alternatives
from ncgear.project.drive import Drive
from ncgear.project.finer import FINER_STEP, MOST_FINER, fewest, require_made
from ncgear.project.tooth_form import require_pushing_flanks
from ncgear.shown import Shown

MOST_SECONDS = 5.0
"""Most processor time of a search: it is the longest wait for an error."""

BEFORE_FINER, AT_NOTCHES = 0.4, 0.1
"""Share of that time for the changes that keep the number of teeth, and the share where notches need more teeth: the
number takes the most trials, and teeth as small as notches need take the longest."""

OnTrial = Callable[[int, int], None]
"""Called with the numbers of trials done and in all."""

ROOT_RADIUS = "gears.rack.root_radius"

BACKLASH = ("gears.backlash_mm", "gears.backlash_deg")

SHIFT = "gears.profile_shift"


class MendingSubject(StrEnum):
    """Subjects of a change."""

    ROOT_RADIUS = "root_radius"
    BACKLASH = "backlash"
    UNSHIFTED = "unshifted"
    MATE = "mate"
    STEEPER = "steeper"
    STEEPEST = "steepest"
    SHIFTED = "shifted"
    UNDERCUT = "undercut"
    FINER = "finer"


ORDER = (
    (MendingSubject.ROOT_RADIUS,),
    (MendingSubject.UNSHIFTED,),
    (MendingSubject.MATE,),
    (MendingSubject.STEEPER,),
    (MendingSubject.SHIFTED,),
    (MendingSubject.UNDERCUT,),
    (MendingSubject.STEEPER, MendingSubject.MATE),
    (MendingSubject.MATE, MendingSubject.UNDERCUT),
    (MendingSubject.STEEPER, MendingSubject.UNDERCUT),
    (MendingSubject.SHIFTED, MendingSubject.MATE),
    (MendingSubject.SHIFTED, MendingSubject.UNDERCUT),
    (MendingSubject.STEEPER, MendingSubject.SHIFTED),
    (MendingSubject.STEEPEST, MendingSubject.MATE),
    (MendingSubject.STEEPER, MendingSubject.MATE, MendingSubject.UNDERCUT),
    (MendingSubject.FINER, MendingSubject.MATE),
    (MendingSubject.FINER, MendingSubject.STEEPER),
    (MendingSubject.FINER, MendingSubject.UNDERCUT),
    (MendingSubject.FINER, MendingSubject.STEEPER, MendingSubject.MATE),
)
"""Kinds of changes, alone and together, from the least change to the greatest.

Less backlash comes after the root radius, and is tried where a tenth of it lets the teeth be made.  More teeth come
after everything that keeps their number, first alone and then with other changes: they are two changes, of ``teeth``
and ``module_mm``, and smaller teeth carry less."""

TENTHS = 10
"""Number of steps in which less backlash is tried."""

STEEPER_DEG = (22.5, 25.0)
"""Pressure angles of commercial racks, over the usual 20 degrees."""

STEEPEST_DEG = 30.0
"""The pressure angle of splines.  From base circle to base circle of z : z teeth are z tan(alpha) / pi base pitches, so
that 6 : 6 teeth hold contact from 27.7 degrees on."""

SHIFTED_MODULES = (0.3, -0.3)
"""Profile shifts of the driving gear that are tried where the shift chosen against undercut would change nothing."""

FINER_TOGETHER = (1.5, 3.0)
"""Numbers of teeth, divided by the design's, that are tried together with another change."""

NOTCH_TEETH = 4.0
"""Approximate least difference of the teeth numbers of the circles at a notch of a pitch curve; with fewer, tips run
into each other as in an internal gear and its pinion.  The search for a number begins there, and trials correct it."""

NOTCH_SHARE = 0.1
"""Share by which the least number mostly differs from this number: it is 0.9 to 1 times this for squares with corners
of 4, 6 and 8 mm, 1 to 1.05 times for a pentagon and a hexagon, 0.95 to 1.1 times for notched formulas."""

SAME_SHIFT = 0.01
"""Least difference of two shifts, in modules, that is worth a trial."""


@dataclass(frozen=True)
class MendingWay:
    """A change of one kind or of several kinds, as keys of the design file."""

    kinds: tuple[MendingSubject, ...]
    changes: alternatives.Changes


@dataclass(frozen=True, eq=False)
class Mend(Shown):
    """A change with which the teeth can be made: the way, and the drive of the changed design."""

    way: MendingWay
    drive: Drive

    def __repr__(self) -> str:
        figures = f"contact ratio {self.contact_ratio:.3g}, pressure angle {self.pressure_angle_deg:.3g} deg"
        return f"Mend({self.way.changes}, {figures})"

    @property
    def contact_ratio(self) -> float:
        """The contact ratio of the exact teeth, including a helix; for two pairs of gears the worse value."""
        return min(pair.designed_contact.contact_ratio + pair.overlap_ratio for pair in self.drive.by_stage)

    @property
    def pressure_angle_deg(self) -> float:
        """The largest pressure angle, including the rack's angle; for two pairs of gears the worse value."""
        return max(pair.largest_pressure_angle_deg for pair in self.drive.by_stage)


@dataclass(frozen=True, eq=False)
class Mending(Shown):
    """The search for a change: the error, the ways that do not work in the order of the trials, and the way found.

    ``found`` is None where no way works.  ``is_whole`` is false where time ended the search before all ways were tried,
    or before one tooth less was known not to work.
    """

    refusal: DesignError
    failed: tuple[MendingWay, ...]
    found: Mend | None
    is_whole: bool = True


def mending(
    drive: Drive, on_trial: OnTrial = lambda done, total: None, seconds: float = MOST_SECONDS
) -> Mending | None:
    """The least change with which a design's teeth can be made; None where they can be made as they are.

    The search takes so many ``seconds`` of processor time at the most.  Raises WrongInput or NoSuchMechanism where
    something other than the teeth is refused, for example a law or pitch curves.

    >>> from ncgear.project.opened import loads
    >>> machine = "linkage: {crank_mm: 40, rod_mm: 90}, operation: {speed_rpm: 30}, motion: {law: uniform_crank}"
    >>> found = mending(loads(f"{{name: few, {machine}, gears: {{teeth: 8, module_mm: 5, face_width_mm: 9}}}}"))
    >>> found.found.way.changes
    {'gears.rack.pressure_angle_deg': 25.0, 'gears.cutter.kind': 'mate'}
    """
    refusal = refusal_of_teeth(drive)
    return None if refusal is None else searched(drive, refusal, on_trial, seconds)


def refusal_of_teeth(drive: Drive) -> DesignError | None:
    """The error that refuses the teeth of a design, their contact or their outlines; None where they can be made.

    Of wrong input, only a root radius that does not fit and too much backlash are about teeth.  Raises WrongInput or
    NoSuchMechanism where something else is refused: a law, pitch curves, or a pressure angle at which no flank pushes.
    """
    with located(drive.places):
        for pair in drive.by_stage:
            require_pushing_flanks(pair.pitch, pair.gears.rack)
        if drive.gears.idlers is not None:
            drive.whole.row  # noqa: B018
    try:
        require_made(drive)
    except NoSuchMechanism as error:
        return error
    except WrongInput as error:
        fitted = alternatives.fitted_root_radius(drive.gears, min(drive.gears.rack.angles_deg))
        if error.key not in BACKLASH and (error.key != ROOT_RADIUS or not fitted):
            raise
        return error
    return None


def searched(
    drive: Drive, refusal: DesignError, on_trial: OnTrial = lambda done, total: None, seconds: float = MOST_SECONDS
) -> Mending:
    """The least change with which refused teeth can be made; among equal changes the change with most contact."""
    every = list(ways(drive))
    trials = _Trials(drive, on_trial, sum(map(len, every)) + MOST_FINER, seconds)
    kept = [equals for equals in every if MendingSubject.FINER not in equals[0].kinds]
    share = AT_NOTCHES if trials.needed > FINER_STEP * drive.by_stage[0].pitch.size.driving_teeth else BEFORE_FINER
    radius, others = ([way for way in kept if (way[0].kinds == ORDER[0]) is so] for so in (True, False))
    found = next((mend for equals in radius if (mend := trials.best(equals, share))), None)
    found = found or trials.most_backlash()
    found = found or next((mend for equals in others if (mend := trials.best(equals, share))), None)
    found = found or trials.fewest()
    found = found or next((mend for equals in every[len(kept) :] if (mend := trials.best(equals))), None)
    if found is not None and found.way.kinds == (MendingSubject.BACKLASH,):
        key, given = _given_backlash(drive)
        refusal = _caused_by(key, f"{given:g} {key.rpartition('_')[2]} is too much", drive, refusal)
    if found is not None and found.way.kinds == (MendingSubject.UNSHIFTED,):
        refusal = _caused_by(SHIFT, "without this shift the teeth can be made", drive, refusal)
    return Mending(refusal, tuple(trials.failed), found, trials.is_whole)


def _given_backlash(drive: Drive) -> tuple[str, float]:
    """The key and the value of the backlash that a file gives; an empty key where it gives none."""
    given = ((key, getattr(drive.gears, key.removeprefix("gears."))) for key in BACKLASH)
    return next(((key, value) for key, value in given if value), ("", 0.0))


def _caused_by(key: str, said: str, drive: Drive, refusal: DesignError) -> DesignError:
    """The refusal at the given value that causes it, with words about this value in front."""
    error = refusal.saying(f"{said}: {refusal.problem}", key)
    if refusal.key == key:
        return error
    with suppress(DesignError), located(drive.places):
        raise error
    return error


class _Trials:
    """Trials of changes, one after the other, until their time is over."""

    def __init__(self, drive: Drive, on_trial: OnTrial, total: int, seconds: float) -> None:
        self._drive, self._on_trial, self._total, self._seconds = drive, on_trial, total, seconds
        self._begun = process_time()
        self.needed = _teeth_of_notches(drive.by_stage[0])
        self.failed: list[MendingWay] = []
        self.is_whole = True

    def best(self, equals: tuple[MendingWay, ...], share: float = 1.0) -> Mend | None:
        """The way with most contact among equal ways that work; None where none works within a share of the time."""
        try:
            sound = [mend for way in equals if (mend := self._sound(way, share))]
            for mend in sorted(sound, key=lambda tried: -tried.contact_ratio):
                with self._in_time(share):
                    require_made(mend.drive)
                    if MendingSubject.STEEPEST in mend.way.kinds:
                        # These teeth have the deepest roots, which may come too near to a bore.
                        _ = [pair.solids for pair in mend.drive.by_stage]
                    return mend
                self.failed.append(mend.way)
        except TimeIsOver:
            self.is_whole = False
        return None

    def fewest(self) -> Mend | None:
        """The least number of teeth that works: the number before it does not, unless time ends the search early.

        None for a file whose gears are others with other teeth: a path finds another arm.
        """
        pair, fitted, mends = self._drive.by_stage[0], _fitted(self._drive), dict[int, Mend]()
        each, low = pair.transmission.lobes.teeth_step, pair.pitch.size.driving_teeth
        if self._drive.design.key_in_file("gears.teeth") is None:
            return None

        def does(teeth: int) -> bool | None:
            way = MendingWay((MendingSubject.FINER,), fitted | alternatives.resized(pair, teeth))
            mend = self.best((way,))
            if mend is not None:
                mends[teeth] = mend
                return True
            return False if way in self.failed else None

        about = NOTCH_SHARE if self.needed > low else FINER_STEP - 1.0
        most = min(MOST_FINER * low, MOST_TEETH // each * each)
        return mends.get(fewest(does, low, most, each, self.needed, about))

    def most_backlash(self) -> Mend | None:
        """The most tenths of the given backlash that work, if any."""
        (key, given), fitted, mends = _given_backlash(self._drive), _fitted(self._drive), dict[int, Mend]()

        def does(off: int) -> bool:
            changes = {**fitted, key: float(f"{given * (TENTHS - off) / TENTHS:.6g}")}
            if mend := self.best((MendingWay((MendingSubject.BACKLASH,), changes),)):
                mends[off] = mend
            return mend is not None

        if not given or not does(TENTHS - 1):
            return None
        return mends[fewest(does, 0, TENTHS - 2, needed=1.0) or TENTHS - 1]

    def _sound(self, way: MendingWay, share: float) -> Mend | None:
        """The way, if teeth are sound with it; raises TimeIsOver."""
        changed = alternatives.changed_drive(self._drive, way.changes)
        with self._in_time(share):
            for pair in changed.by_stage:
                pair.require_sound_teeth()
            return Mend(way, changed)
        self.failed.append(way)
        self._on_trial(min(len(self.failed), self._total), self._total)
        return None

    @contextmanager
    def _in_time(self, share: float) -> Iterator[None]:
        """A context that ends where a design is refused; raises TimeIsOver when a share of the time is over."""
        with suppress(DesignError), at_most(share * self._seconds - (process_time() - self._begun)):
            yield


def _teeth_of_notches(drive: Drive) -> float:
    """Approximate number of driving teeth with tips free at notches of pitch curves; 0 for convex curves and rings.

    At a notch of radius r two circles roll on each other whose radii differ by about r^2 k, where k is the sum of both
    curvatures; their numbers of teeth differ by 2 r^2 k / m.
    """
    pitch = drive.pitch
    if pitch.mesh is Mesh.INTERNAL:
        return 0.0

    def bend(slope: Jet, gear: Gear) -> Jet:
        both = {gear: shape.curvature(slope, gear, pitch.mesh) for gear in Gear}
        return both[gear] / jet.sqrt(both[Gear.DRIVING] + both[Gear.DRIVEN])

    sharpest = min(pitch.transmission.extremes(partial(bend, gear=gear), 2)[0].value for gear in Gear)
    module_mm = 2.0 * pitch.center_distance_mm / (NOTCH_TEETH * sharpest**2)
    return pitch.size.driving_teeth * pitch.size.module_mm / module_mm if sharpest < 0.0 else 0.0


def ways(drive: Drive) -> Iterator[tuple[MendingWay, ...]]:
    """All ways except more teeth alone, the least change first; the ways in one tuple are equals."""
    fitted = _fitted(drive)
    for kinds in ORDER:
        options = [_options(drive, kind, alone=len(kinds) == 1) for kind in kinds]
        changes = (reduce(or_, chosen, fitted) for chosen in product(*options))
        found = [MendingWay(kinds, change) for change in changes if alternatives.is_accepted(drive.design, change)]
        if MendingSubject.FINER in kinds:
            # Fewer teeth are the lesser change.
            yield from ((way,) for way in found)
        elif found:
            yield tuple(found)


def _fitted(drive: Drive) -> alternatives.Changes:
    """The root radius that fits; empty where the design's root radius fits."""
    return alternatives.fitted_root_radius(drive.gears, min(drive.gears.rack.angles_deg))


def _options(drive: Drive, kind: MendingSubject, *, alone: bool) -> list[alternatives.Changes]:
    """The changes of one kind; together with changes of other kinds only the most promising."""
    gears = drive.gears
    match kind:
        case MendingSubject.ROOT_RADIUS:
            return [fitted] if (fitted := _fitted(drive)) else []
        case MendingSubject.BACKLASH:
            # The right amount is searched later
            return []
        case MendingSubject.UNSHIFTED:
            return [{SHIFT: None}] if gears.profile_shift.model_fields_set else []
        case MendingSubject.MATE:
            return _mate(drive)
        case MendingSubject.STEEPER:
            steeper = [
                alternatives.rack_at(gears, angle) for angle in STEEPER_DEG if angle > gears.rack.pressure_angle_deg
            ]
            return steeper if alone else steeper[-1:]
        case MendingSubject.STEEPEST:
            return [alternatives.rack_at(gears, STEEPEST_DEG)] if gears.rack.pressure_angle_deg < STEEPEST_DEG else []
        case MendingSubject.SHIFTED:
            shifted = _shifted(drive)
            return shifted if alone else shifted[:1]
        case MendingSubject.UNDERCUT:
            return [{"gears.undercut": "allow"}] if gears.undercut == "avoid" else []
        case MendingSubject.FINER:
            return _finer(drive)
    assert_never(kind)


def _mate(drive: Drive) -> list[alternatives.Changes]:
    """The mate as the tool; empty where it is the tool already."""
    from ncgear.teeth.tool import least_concave_radius_mm

    cutter = drive.gears.cutter
    by_itself = cutter.kind == "auto" and all(least_concave_radius_mm(pair.pitch) for pair in drive.by_stage)
    if cutter.kind == "mate" or by_itself:
        return []
    dropped: alternatives.Changes = {} if cutter.teeth is None else {"gears.cutter.teeth": None}
    return [{"gears.cutter.kind": "mate", **dropped}]


def _shifted(drive: Drive) -> list[alternatives.Changes]:
    """Equal and opposite profile shifts: the shift chosen against undercut or, if the design has it, two others."""
    from ncgear.teeth.gear import shift_against_undercut

    given = drive.gears.profile_shift
    gears = alternatives.changed_part(drive.gears, _fitted(drive))
    own = given.driving if given.driving is not None else -(given.driven or 0.0)
    sizes = [(pair.pitch, pair.pitch.size.module_mm) for pair in drive.by_stage]
    best = [shift_against_undercut(pitch, gears.rack.in_mm(module)) / module for pitch, module in sizes]
    if not given.against_undercut and any(abs(modules - own) > SAME_SHIFT for modules in best):
        return [alternatives.shifted_against_undercut(drive.gears)]
    dropped: alternatives.Changes = {f"gears.profile_shift.{key}": None for key in given.model_fields_set}
    return [dropped | {"gears.profile_shift.driving": modules} for modules in SHIFTED_MODULES if modules != own]


def _finer(drive: Drive) -> list[alternatives.Changes]:
    """More teeth of a smaller module at the same centre distance; whole numbers on both gears."""
    pair, lobes = drive.by_stage[0], drive.gears.lobes.driving
    teeth = pair.pitch.size.driving_teeth
    counts = dict.fromkeys(ceil(factor * teeth / lobes) * lobes for factor in FINER_TOGETHER)
    return [alternatives.resized(pair, count) for count in counts if teeth < count <= MOST_TEETH]
