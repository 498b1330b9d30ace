"""The search for the smallest gears that hold: module of series I, number of teeth and face width within a space.

They hold where no tooth has less than the wanted safety against breakage and pitting, and where flanks neither scuff
nor wear away.  Where K_Hbeta follows from the shafts and no crowning is given, flanks get the best lead crowning of the
nearest gears.

The law stays as it is, so a number of teeth and a module give gears of the same shape in another size.  The safety of a
size is guessed from the nearest gears that are computed already (``ncgear.strength.holding``).  For each module the
numbers of teeth are tried in the order of the guessed volume, and computations correct the face width, so that each
answer has been computed.  A number of teeth that is refused is refused for every module.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from enum import Enum, auto
from functools import cached_property
from math import ceil, floor, inf, log

import numpy as np
from pydantic import ValidationError

from ncgear.design.keys.design import Design
from ncgear.design.words import listed
from ncgear.dynamics.meshing import TOO_WEAK
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.project.alternatives import (
    Changes,
    changed_design,
    changed_drive,
    is_given,
    may_be_helical,
    widths_mm,
    with_helix,
    with_width,
)
from ncgear.project.drive import Drive
from ncgear.project.opened import drive_like
from ncgear.project.rough_strength import rough_strength
from ncgear.project.strengthening import (
    CROWNING,
    HELIX_DEG,
    MOST_TEETH,
    SERIES_I_MM,
    WIDEST_MODULES,
    Rating,
    rating_of,
    sized,
)
from ncgear.strength.holding import Damage, Weakest
from ncgear.strength.materials import TABLE, near_materials

GEAR_INERTIA = ("driving_gear_kg_mm2", "shaft_between_kg_mm2", "driven_gear_kg_mm2")
"""Keys of ``masses`` for values that follow from the gears' bodies."""


def stated_inertias(design: Design) -> list[str]:
    """The moments of inertia of gears that a design states, as dotted keys."""
    return [f"masses.{name}" for name in GEAR_INERTIA if getattr(design.masses, name, None) is not None]


OnTrial = Callable[[int, int], None]
"""Called with the numbers of computed gears so far and at most."""

MOST_COMPUTED = {"resistance": 24, "jam": 24, "masses": 11, "shafts": 8}
"""Most gears that are computed, by the source of their load.  With masses, which include knocks and the gears' bodies,
they take a second each, twice as long with shafts, else a fifth of it."""

MOST_NARROWED = {"resistance": 16, "jam": 16, "masses": 5, "shafts": 4}
"""Most gears of the same teeth that are computed to find the least widths, in half of that time each."""

BEST = 4
"""Number of answers."""

BODIES = "gears.driving.", "gears.driven."
"""Beginnings of the keys of bodies, which have no room in gears that are too small."""

DOUBLED = tuple(2.0**power for power in range(1, 9))
"""Factors on the module of teeth that are too weak to be rated, from which the search may begin."""

NEAR_MM = 3.0
"""Distance between a width that holds and a width that does not, below which the next mm is tried at once."""

GREATER = 2.5
"""Ratio to the smallest gears' volume above which gears are not computed."""

TRIES = 3
"""Number of tooth numbers that are tried for a module, and of face widths for a number of teeth."""

FEWEST_TEETH = 12
"""Least number of driving teeth that is tried: fewer are undercut on circular gears."""

FINENESS = 1.06
"""Ratio of the numbers of teeth that follow each other: 6 % of the size is less than a step of the modules."""

FINER_BY = 1.15
"""Ratio by which numbers of teeth grow where gears with too few are not accepted: each try takes a second."""

POLISHED = 3
"""Most numbers of teeth near the best that are tried, a second each, and how small they must be guessed to be."""

POLISH = 0.99

ROUGHLY = 0.85
"""Share of a width that holds up to which less is tried before the sizes are put in order: the least widths are found
for the first of them only."""

UNDERCUT = 0.5
"""Share of the teeth free of undercut below which no number is tried: of 24 designs none has answers under 0.59."""

NARROWEST_MODULES = 5.0
"""Least face width in modules: narrower gears tilt on their shafts."""


@dataclass(frozen=True)
class GearRoom:
    """The room for a pair: largest centre distance and largest diameter of a gear in mm, both infinite if not limited.

    ``width_modules`` and ``least_width_modules`` are the largest and the least face width in modules; ``modules_mm``
    are the modules to try, ``fewest_teeth`` is the least number of driving teeth.
    """

    center_distance_mm: float = inf
    diameter_mm: float = inf
    width_modules: float = WIDEST_MODULES
    least_width_modules: float = NARROWEST_MODULES
    modules_mm: tuple[float, ...] = SERIES_I_MM
    fewest_teeth: int = FEWEST_TEETH


class Accepted(Enum):
    """Whether gears are accepted, or may be accepted with more teeth of a smaller module."""

    YES = auto()
    NO = auto()
    WITH_MORE_TEETH = auto()


@dataclass(frozen=True, eq=False)
class Sized:
    """Gears that were computed: the changes of the design, its drive, and the safety of its teeth."""

    changes: Changes
    drive: Drive
    rating: Rating

    @cached_property
    def flank_share(self) -> float:
        """The least ratio of the flanks' safety to the wanted safety, against scuffing and wear."""
        return self.drive.surfaces_by(self.rating.strength.method).share

    @cached_property
    def uneven(self) -> float:
        """K_Hbeta of the most loaded tooth where it is computed; else 1, since it does not change with the width."""
        strength = self.rating.strength
        computed = self.drive.face_loading.basis == "computed"
        return strength.stresses.decisive_face_load(strength.contacts) if computed else 1.0

    @property
    def share(self) -> float:
        """The least ratio of any tooth's safety to the wanted safety, of flanks' too where the teeth hold."""
        least = min(weakest.share for weakest in self.rating.weakest)
        return min(least, self.flank_share) if self.rating.holds else least

    @property
    def holds(self) -> bool:
        """Whether teeth and flanks have the wanted safety."""
        return self.rating.holds and self.flank_share >= 1.0

    @cached_property
    def teeth(self) -> int:
        """Teeth of the driving gear."""
        return self.drive.pitch.size.driving_teeth

    @cached_property
    def module_mm(self) -> float:
        """The module."""
        return self.drive.pitch.size.module_mm

    @property
    def face_width_mm(self) -> float:
        """The face width."""
        return self.drive.gears.face_width_mm

    @property
    def volume_mm3(self) -> float:
        """Square of the centre distance times the face width, a measure of the volume of gears of one shape."""
        return self.drive.pitch.center_distance_mm**2 * self.face_width_mm

    @cached_property
    def diameter_mm(self) -> float:
        """Largest diameter of either gear about its axis."""
        return 2.0 * max(self.drive.outer_radii_mm.values())


def is_finer(coarse: Sized, teeth: int, module_mm: float) -> bool:
    """Whether a size may do what refused gears with too few teeth do not: ``FINER_BY`` more, or a larger module."""
    return teeth >= FINER_BY * coarse.teeth or module_mm > coarse.module_mm


def require_material(name: str, key: str) -> None:
    """Raise WrongInput, for an option ``key``, where the table has no such material."""
    if name not in TABLE:
        close = near_materials(name)
        hint = f"did you mean {close[0]}?" if close else f"one of {listed(TABLE)} is right"
        raise WrongInput(f"{name!r} given; {hint}", key=key)


def asked_design(design: Design, asked: Mapping[str, float | str]) -> Design:
    """The design with another material and other wanted safeties, by their keys.

    Moments of inertia of gears in the file are left out: they belong to gears of another size.
    """
    if design.masses is not None:
        design = design.model_copy(update={"masses": design.masses.model_copy(update=dict.fromkeys(GEAR_INERTIA))})
    strength = {key.removeprefix("strength."): value for key, value in asked.items() if key.startswith("strength.")}
    design = design.model_copy(update={"strength": design.strength.model_copy(update=strength)})
    if design.gears is None or "gears.material" not in asked:
        return design
    return changed_design(design, {"gears.material": asked["gears.material"]})


def smallest_gears(drive: Drive, space: GearRoom, on_trial: OnTrial = lambda done, total: None) -> list[Sized]:
    """The smallest gears that hold for each of a few modules, by the method ``estimate``, the smallest first.

    Each has the least width in whole mm: the same gears a mm narrower were computed, and do not hold.

    Raises NoSuchMechanism, with the nearest gears computed, where none are found, WrongInput where the law gives the
    gears' size, and as ``rating_of`` for the design as given, except for teeth that are too weak to be rated.
    """
    motion = drive.design.motion
    if motion.gives_center_distance:
        raise WrongInput(
            f"a curve in mm that gives gears of {drive.pitch.center_distance_mm:.6g} mm centre distance, so there is "
            "no smaller size to look for; with solve_for: scale and no center_distance_mm it grows with the gears, and "
            "`ncgear strength` says whether gears of this size hold",
            key="motion",
        )
    search = _Search(drive, space, on_trial, [_begun(drive)])
    found: list[Sized] = []
    modules = set(space.modules_mm)
    while modules:
        guessed, module = min((search.least_volume(module), module) for module in modules)
        volumes = sorted(gears.volume_mm3 for gears in found)
        if guessed == inf or (found and guessed > min([GREATER * volumes[0], *volumes[BEST - 1 : BEST]])):
            break
        modules.remove(module)
        best = search.smallest(module)
        if best is not None:
            found.append(best)
    if not found:
        near = max(search.computed, key=lambda gears: gears.share)
        raise NoSuchMechanism(
            f"no gears of series I up to {space.width_modules:g} modules wide were found that hold in this space; "
            f"nearest of {len(search.computed)} come {near.teeth} teeth of module {near.module_mm:g} mm, "
            f"{near.face_width_mm:g} mm wide, with {near.share:.2g} of the wanted safety; more space, a stronger "
            "material or less load is needed",
            key="gears",
        )
    found = [
        search.smallest(gears.module_mm, gears) or gears for gears in sorted(found, key=lambda gears: gears.volume_mm3)
    ]
    least_mm3 = min(gears.volume_mm3 for gears in found)
    found = sorted(
        (gears for gears in found if gears.volume_mm3 <= GREATER * least_mm3), key=lambda gears: gears.volume_mm3
    )
    narrow = [search.narrowed(gears) for gears in found[:BEST]]
    # If more gears remain than can be computed, gears without a known least width are left out.
    least = [gears for gears, known in narrow if known] or [narrow[0][0]]
    return sorted(least, key=lambda gears: gears.volume_mm3)


def _narrowest_mm(sized: Sized) -> float:
    return max(float(ceil(NARROWEST_MODULES * sized.module_mm - 1e-9)), floor(widths_mm(sized.drive.design)[0]) + 1.0)


def may_be_narrower(sized: Sized) -> bool:
    """Whether a helix can be cut into straight teeth that are wider than the narrowest."""
    return may_be_helical(sized.drive) and sized.face_width_mm > _narrowest_mm(sized)


def in_herringbone(sized: Sized) -> Sized | None:
    """The same teeth as herringbones, which carry more, in the least of a few widths that were computed and hold.

    The angle is the best of HELIX_DEG by the estimate without teeth.  None where such teeth cannot be made (rings,
    gears that turn less than once, other methods, keys of the process), where the design gives a helix angle, or where
    the tried teeth are not narrower.
    """
    if not may_be_narrower(sized):
        return None
    drive = sized.drive

    def herringbone(angle_deg: float, width_mm: float) -> Changes:
        return {**sized.changes, **with_helix(angle_deg, "herringbone"), **with_width(drive.design, width_mm)}

    straight = _roughly(drive)
    shares = {}
    with suppress(DesignError, ValidationError):
        for angle in HELIX_DEG:
            shares[angle] = _roughly(changed_drive(drive, herringbone(angle, sized.face_width_mm)))
    if not straight or not (better := max(shares.values(), default=0.0)) > straight:
        return None
    angle = max(shares, key=lambda key: shares[key])
    below, above = _narrowest_mm(sized) - 1.0, sized.face_width_mm
    guess, best = above / (sized.share * better / straight), None
    for _ in range(TRIES):
        if above - below <= 1.0:
            break
        width = below + 1.0 if best and above - below <= NEAR_MM else min(max(ceil(guess), below + 1.0), above - 1.0)
        try:
            made = changed_drive(drive, changes := herringbone(angle, float(width)))
            tried = Sized(changes, made, rating_of(made, "estimate"))
        except (DesignError, ValidationError):
            break
        if tried.holds:
            best, above = tried, tried.face_width_mm
        else:
            below = tried.face_width_mm
        guess = width / tried.share
    return best


def _roughly(drive: Drive) -> float:
    """The least ratio to the wanted safeties by the estimate without teeth; 0 where it gives none."""
    found = rough_strength(drive)
    if found is None or found.unjudged or found.needs_teeth:
        return 0.0
    return min((safety.safety / safety.wanted for safety in found.safeties), default=0.0)


def smallest_accepted(
    drive: Drive, space: GearRoom, accepted: Callable[[Sized], Accepted], most_computed: int, on_trial: OnTrial
) -> Sized | None:
    """The smallest gears that hold and are accepted, among a number that is computed; None where there are none.

    Where there are none, as many are computed again, by the guesses that those computed allow.  Where gears have too
    few teeth, no gears of the same or a smaller module with less than ``FINER_BY`` times as many teeth are tried any
    more.

    Sizes are tried in the order of the volume that all computed gears suggest, until no other size is guessed to need
    less than the smallest found.  Raises as ``rating_of`` does for the design as given where no larger module can be
    rated either.
    """
    search = _Search(drive, space, on_trial, [_begun(drive, any_size=True)], most=most_computed)
    found = search.smallest_of_all(accepted)
    if found is None:
        search.most = search.trials + most_computed
        found = search.smallest_of_all(accepted)
    return found


def _begun(drive: Drive, *, any_size: bool = False) -> Sized:
    """The design as given or, if its teeth cannot be rated, the first of twice, four times ... the size that can.

    The module grows, or the number of teeth where a body has no room: walls about bores are a module thick.  With
    ``any_size``, larger sizes are tried after any error of the given size.  Raises as ``rating_of`` does for the design
    as given.
    """
    try:
        return Sized({}, drive, rating_of(drive, "estimate"))
    except DesignError as error:
        if error.key != TOO_WEAK and not any_size:
            raise
        given = drive.pitch.size
        for times in DOUBLED:
            finer = times if error.key.startswith(BODIES) else 1.0
            teeth, module = int(finer * given.driving_teeth), times / finer * given.module_mm
            width = max(drive.gears.face_width_mm, WIDEST_MODULES * module)
            changes = {**sized(drive, teeth, module), "gears.face_width_mm": width}
            try:
                larger = changed_drive(drive, changes)
                return Sized(changes, larger, rating_of(larger, "estimate"))
            except (DesignError, ValidationError):
                continue
        raise


@dataclass(eq=False)
class _Search:
    """The knowledge so far: all gears that were computed, the initial gears first, and the refused sizes.

    ``refused`` are numbers of teeth, ``weak`` numbers and modules of teeth too weak to be rated.  Gears whose teeth
    times module are not over ``too_small_mm`` have no room for their bodies.
    """

    drive: Drive
    space: GearRoom
    on_trial: OnTrial
    computed: list[Sized]
    refused: set[int] = field(default_factory=set)
    weak: set[tuple[int, float]] = field(default_factory=set)
    too_small_mm: float = 0.0
    trials: int = 0
    most: int | None = None
    narrowings: int = 0

    @property
    def most_computed(self) -> int:
        """Gears that are computed at most."""
        return self.most or MOST_COMPUTED[self._loaded_by]

    @property
    def most_narrowed(self) -> int:
        """Gears that are computed at most to find the least widths of gears that hold."""
        return MOST_NARROWED[self._loaded_by]

    @property
    def _loaded_by(self) -> str:
        first = self.computed[0]
        return "shafts" if first.drive.face_loading.basis == "computed" else first.rating.strength.load

    def least_volume(self, module_mm: float) -> float:
        """The guessed volume of the smallest gears of a module; infinite without room."""
        return min((self.volume(teeth, module_mm) for teeth in self.teeth()), default=inf)

    def teeth(self) -> list[int]:
        """Numbers of driving teeth that may be tried, including the number of the design."""
        lobes = self.drive.gears.lobes.driving
        fewest = self._fewest_teeth
        steps = np.exp(np.arange(log(self.space.fewest_teeth), log(MOST_TEETH), log(FINENESS)))
        counts = {max(round(step / lobes), 1) * lobes for step in steps} | {self.computed[0].teeth}
        return sorted(count for count in counts if fewest <= count <= MOST_TEETH and count not in self.refused)

    def smallest_of_all(self, accepted: Callable[[Sized], Accepted]) -> Sized | None:
        """The smallest gears of any module and number of teeth that hold and are accepted."""
        found: Sized | None = None
        tried: set[tuple[int, float]] = set()
        coarse: list[Sized] = []
        while self.trials < self.most_computed:
            sizes = [
                (teeth, module)
                for module in self.space.modules_mm
                for teeth in self.teeth()
                if all(is_finer(size, teeth, module) for size in coarse)
            ]
            open_ = [(self.volume(*size), size) for size in sizes if size not in tried | self.weak]
            guessed, size = min(open_, default=(inf, None))
            if size is None or guessed >= (inf if found is None else found.volume_mm3):
                break
            tried.add(size)
            made = self.widened(*size)
            if made is None or (found is not None and made.volume_mm3 >= found.volume_mm3):
                continue
            match accepted(made):
                case Accepted.YES:
                    found = made
                case Accepted.WITH_MORE_TEETH:
                    coarse.append(made)
                case Accepted.NO:
                    pass
        # Where too few teeth were refused, fewer ones would come near to what refused them
        return found if found is None or coarse else self.polished(found, accepted)

    def polished(self, found: Sized, accepted: Callable[[Sized], Accepted]) -> Sized:
        """The smallest accepted gears of the same module with any number of teeth nearby, from a few tries."""
        lobes, tried = self.drive.gears.lobes.driving, {found.teeth}
        for _ in range(POLISHED):
            fewest, most = max(found.teeth / FINENESS, self._fewest_teeth), int(found.teeth * FINENESS)
            left = set(range(ceil(fewest / lobes) * lobes, most + 1, lobes)) - tried - self.refused
            guessed, teeth = min(((self.volume(count, found.module_mm), count) for count in left), default=(inf, 0))
            if guessed > POLISH * found.volume_mm3:
                break
            tried.add(teeth)
            self.most = self.trials + 1
            made = self.widened(teeth, found.module_mm)
            smaller = made is not None and made.volume_mm3 < found.volume_mm3
            if made is not None and smaller and accepted(made) is Accepted.YES:
                found = made
        return found

    def smallest(self, module_mm: float, best: Sized | None = None) -> Sized | None:
        """The first gears of a module that hold, or else the smallest besides ``best`` with other numbers of teeth.

        None where there are none within the space and the effort.
        """
        for _ in range(TRIES):
            tried = {(sized.teeth, sized.module_mm) for sized in self.computed[1:]} | self.weak
            open_ = [(self.volume(z, module_mm), z) for z in self.teeth() if (z, module_mm) not in tried]
            guessed, teeth = min(open_, default=(inf, 0))
            if guessed == inf or (best is not None and guessed > POLISH * self.volume(best.teeth, module_mm)):
                break
            found = self.widened(teeth, module_mm, ROUGHLY)
            if best is None and found is not None:
                return found
            if best is not None and found is not None and found.volume_mm3 < best.volume_mm3:
                best = found
        return best

    def widened(self, teeth: int, module_mm: float, near: float = 1.0) -> Sized | None:
        """The narrowest gears of a size that hold, in whole mm; None where they are refused or would be too wide.

        No less width is tried where it is guessed to be more than ``near`` of a width that holds.
        """
        best: Sized | None = None
        below = 0.0
        for _ in range(TRIES):
            width = self.width(teeth, module_mm)
            if width > self.widths_mm(module_mm)[1] or self.trials >= self.most_computed:
                break
            if best is not None and not below < width < near * best.face_width_mm:
                break
            self.trials += 1
            made = self.made(teeth, module_mm, width)
            if made is None:
                return best
            if made.holds:
                best = made
            else:
                below = made.face_width_mm
        return best

    def narrowed(self, sized: Sized) -> tuple[Sized, bool]:
        """The gears with the least width that holds, and whether a mm less is known not to hold."""
        teeth, module = sized.teeth, sized.module_mm
        least_mm = self.widths_mm(module)[0] - 1.0
        own = [other for other in self.computed[1:] if (other.teeth, other.module_mm) == (teeth, module)]
        while True:
            own.sort(key=lambda other: other.face_width_mm)
            row = next(row for row, other in enumerate(own) if other.holds)
            best, width, below = own[row], own[row].face_width_mm, own[row - 1].face_width_mm if row else least_mm
            if (known := width - below <= 1.0) or self.narrowings >= self.most_narrowed:
                return best, known
            if width - below <= NEAR_MM:
                guess = below + 1.0
            elif len(own) == 1:
                guess = self.width(teeth, module)
            else:
                # The share is a power of the width between two widths, and a little beyond them.
                other = own[row - 1 if row else 1]
                power = log(best.share / other.share) / log(width / other.face_width_mm)
                guess = float(ceil(width * best.share ** (-1.0 / power) if power > 0.0 else (width * below) ** 0.5))
            self.narrowings += 1
            made = self.made(teeth, module, min(max(guess, below + 1.0), width - 1.0))
            if made is None:
                return best, False
            own.append(made)

    def made(self, teeth: int, module_mm: float, width_mm: float) -> Sized | None:
        """The gears of a size, computed; None where they are refused or do not fit into the space."""
        design, crowned = self.drive.design, self.crowning(self.nearest(teeth, module_mm))
        changes: Changes = {**sized(self.drive, teeth, module_mm), **with_width(design, width_mm), **crowned}
        self.on_trial(self.trials + self.narrowings, self.most_computed + self.most_narrowed)
        # Teeth of earlier gears are not made again.
        same = [sized for sized in self.computed if (sized.teeth, sized.module_mm) == (teeth, module_mm)]
        try:
            changed = drive_like(same[-1].drive if same else self.drive, changed_design(design, changes))
            made = Sized(changes, changed, rating_of(changed, "estimate"))
        except (DesignError, ValidationError) as error:
            key = getattr(error, "key", "")
            if key == TOO_WEAK:
                self.weak.add((teeth, module_mm))
            elif key.startswith(BODIES):
                self.too_small_mm = max(self.too_small_mm, teeth * module_mm)
            else:
                # If so few teeth are refused, fewer are refused too, unless some were made.
                some = {sized.teeth for sized in self.computed}
                fewer = {count for count in self.teeth() if count < teeth} if min(some) > teeth else set[int]()
                self.refused |= {teeth} | fewer
            return None
        self.computed.append(made)
        inside = changed.pitch.center_distance_mm <= self.space.center_distance_mm
        most_mm = self.space.diameter_mm
        return made if inside and (most_mm == inf or made.diameter_mm <= most_mm) else None

    # Guesses from the nearest gears computed.

    def crowning(self, near: Sized) -> Changes:
        """The best lead crowning of gears; empty where it is not known, or the design gives its own."""
        if is_given(self.drive.design, CROWNING):
            return {}
        return {CROWNING: best_um} if (best_um := near.drive.best_crowning_um_by("estimate")) else {}

    def volume(self, teeth: int, module_mm: float) -> float:
        """Square of the centre distance times the guessed face width; infinite where the gears have no room."""
        first, scale = self.computed[0], self.scale(teeth, module_mm)
        distance = first.drive.pitch.center_distance_mm * scale
        # Pitch curves grow with the scale, addenda with the module.
        diameter = (first.diameter_mm - 2.0 * first.module_mm) * scale + 2.0 * module_mm
        roomy = distance <= self.space.center_distance_mm and diameter <= self.space.diameter_mm * (1.0 + 1e-9)
        if not roomy or teeth * module_mm <= self.too_small_mm:
            return inf
        width = self.width(teeth, module_mm)
        return distance**2 * width if width <= self.widths_mm(module_mm)[1] else inf

    def widths_mm(self, module_mm: float) -> tuple[float, float]:
        """The least face width in whole mm and the greatest, by the space, the bodies and the bearings."""
        low, high = self._widths_mm
        least = float(max(ceil(self.space.least_width_modules * module_mm - 1e-9), floor(low) + 1))
        return least, min(self.space.width_modules * module_mm, high)

    @cached_property
    def _fewest_teeth(self) -> int:
        from ncgear.teeth.gear import teeth_free_of_undercut

        free = teeth_free_of_undercut(self.drive.pitch, self.drive.rack, self.drive.rack)
        return max(self.space.fewest_teeth, ceil(UNDERCUT * free))

    @cached_property
    def _widths_mm(self) -> tuple[float, float]:
        return widths_mm(self.drive.design)

    def width(self, teeth: int, module_mm: float) -> float:
        """The guessed face width in whole mm, not under the least in the space."""
        near = self.nearest(teeth, module_mm)
        scale = self.scale(teeth, module_mm) / self.scale(near.teeth, near.module_mm)
        larger = module_mm / near.module_mm
        wider = [_wider(weakest, scale, larger) for weakest in near.rating.weakest]
        if near.rating.holds:
            # Wear is in proportion to force over width, and may be a share of the module; heat is assumed to follow the
            # same rule.
            wider.append(1.0 / (near.flank_share * scale * larger))
        width = _with_uneven_load(max(wider), near.uneven, scale) * near.face_width_mm
        return inf if width == inf else max(float(ceil(width - 1e-9)), self.widths_mm(module_mm)[0])

    def scale(self, teeth: int, module_mm: float) -> float:
        """The size of the pitch curves over their size in the design as given."""
        first = self.computed[0]
        return teeth * module_mm / (first.teeth * first.module_mm)

    def nearest(self, teeth: int, module_mm: float) -> Sized:
        """Among the gears with the most similar number of teeth and then module, the gears computed last."""
        return min(
            reversed(self.computed),
            key=lambda gears: (abs(log(gears.teeth / teeth)), abs(log(gears.module_mm / module_mm))),
        )


def _with_uneven_load(wider: float, uneven: float, scale: float) -> float:
    """The factor of a face width that carries as much as ``wider`` does with the same K_Hbeta; infinite where none.

    Flanks that are askew by the same way have K_Hbeta - 1, here ``uneven`` - 1, in proportion to the width over the
    force, which is in proportion to 1 over the scale.
    """
    even = wider / uneven
    rest = 1.0 - even * (uneven - 1.0) * scale
    return even / rest if rest > 0.0 else inf


def _wider(weakest: Weakest, scale: float, larger: float) -> float:
    """The factor of a face width with which a tooth, scaled and with another module, would just be safe enough.

    The force is in proportion to 1 over the scale; a root's stress to force over width and module; the square of the
    pressure to force over width and scale.
    """
    if weakest.damage is Damage.BENDING:
        return 1.0 / (weakest.share * scale * larger)
    return 1.0 / (weakest.share * scale) ** 2
