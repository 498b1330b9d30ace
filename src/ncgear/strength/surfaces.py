"""The state of the flanks over a cycle and the wanted life: least film, greatest heat, and wear.

Extremes are searched between the positions of the loads too (``ncgear.numerics.highest``): a film is thinnest, and
sliding fastest, where a pair begins or ceases to touch.  Edges have no film, and are left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np

from ncgear.contact.placement import BOTH_SIDES
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, IndexArray
from ncgear.numerics.highest import largest_from
from ncgear.pitch.shape import Gear
from ncgear.strength.conditions import Conditions, Running
from ncgear.strength.contacts import LoadedContacts
from ncgear.strength.endurance import film_factor
from ncgear.strength.film import (
    BULK_SHARE,
    Oil,
    Pressed,
    Regime,
    film_um,
    flash_k,
    friction,
    roughness_um,
    scuffing_c,
)
from ncgear.strength.holding import NOTHING_MPA
from ncgear.strength.life import shaken_n_mm
from ncgear.strength.loading import Loading
from ncgear.strength.material import Material
from ncgear.strength.materials import Choice, Ferrous, Plastic
from ncgear.strength.plastics import ToothTemperature, creep_factor
from ncgear.strength.wear import LIMIT_MODULES, coefficient_mm3_n_m, depth_mm, share_unparted

LEAST_SCUFFING = 1.0
"""Safety under which flanks scuff: test gears scuffed at the formula's temperature.  ISO/TS 6336-20 calls the risk high
below 1, moderate up to 2."""

KNOWN = 1e-3
"""Relative tolerance of an extreme: its formulas are known to a tenth at best."""


@dataclass(frozen=True)
class ContactValue:
    """A value at its place of contact: the driving angle, and the teeth that touch there, from 1."""

    value: float
    phi1_rad: float
    driving_tooth: int
    driven_tooth: int

    def tooth(self, gear: Gear) -> int:
        """The tooth of a gear."""
        return self.driving_tooth if gear is Gear.DRIVING else self.driven_tooth


@dataclass(frozen=True, eq=False)
class Film:
    """The oil between metal flanks.

    ``thickness`` is the least specific film thickness lambda, in mean roughnesses Ra of ``roughness_um``; ``oil_c`` and
    ``bulk_c`` are the temperatures of the oil and of the teeth in it, ``flash_k`` is the rise of a contact over them.
    ``film_um`` (shape (n,)) is the thickness at ``contacts``: all computed places of contact, without edges.
    """

    thickness: ContactValue
    roughness_um: float
    oil_c: float
    bulk_c: float
    flash_k: ContactValue
    contacts: LoadedContacts
    film_um: Array

    @property
    def regime(self) -> Regime:
        """The lubrication of flanks where the film is thinnest."""
        return Regime.of(self.thickness.value)

    @property
    def hottest_c(self) -> float:
        """The highest temperature of a contact."""
        return self.bulk_c + self.flash_k.value


@dataclass(frozen=True)
class Wear:
    """Wear of the flanks over the wanted life, in mm along their normal.

    ``depth_mm`` has the deepest places of the driving and the driven gear.  ``play_mm`` is the largest growth of the
    play along the normal: the sum of both flanks at the worst place, of pushing flanks and of backs.  ``limit_mm`` is
    reached after ``life_h``, which is infinite without wear.
    """

    coefficients_mm3_n_m: tuple[float, float]
    depth_mm: tuple[ContactValue, ContactValue]
    play_mm: float
    limit_mm: float
    wanted_h: float

    @property
    def deepest_mm(self) -> float:
        """The deepest place of both gears."""
        return max(extremum.value for extremum in self.depth_mm)

    @property
    def life_h(self) -> float:
        """Hours until the limit is worn off at the deepest place."""
        return self.wanted_h * self.limit_mm / self.deepest_mm if self.deepest_mm > 0.0 else inf

    @property
    def holds(self) -> bool:
        """Whether the wear of the wanted life stays within the limit."""
        return self.deepest_mm <= self.limit_mm


@dataclass(frozen=True)
class Creep:
    """Way in mm by which a pair with plastic teeth yields under its largest load: at once, and after the wanted life.

    Each tooth is under load for ``loaded_h`` in that life, counted without a pause, and the whole way counts as
    plastic: both on the safe side.
    """

    at_once_mm: float
    after_mm: float
    loaded_h: float


@dataclass(frozen=True)
class Surfaces:
    """The state of a pair's flanks.

    ``film`` is None for dry and for plastic flanks, and where only a jam presses them; ``scuffing_c`` (the temperature
    at which the oil fails) is None for bronze, too.  ``pitting_factor`` is Z_L Z_v Z_R of the driving and the driven
    gear.  ``warm`` are the temperatures of both gears' teeth, None for metal; ``creep`` is None where it is not known.
    Flanks that only a jam presses are not ``judged``: it presses them a few times only.
    """

    film: Film | None
    scuffing_c: float | None
    pitting_factor: tuple[float, float]
    wear: Wear
    warm: tuple[ToothTemperature | None, ToothTemperature | None]
    judged: bool = True
    creep: Creep | None = None

    @property
    def scuffing_safety(self) -> float | None:
        """Safety against scuffing, the ratio of rises over the oil's temperature: (T_S - T_oil) / (T - T_oil)."""
        if self.film is None or self.scuffing_c is None:
            return None
        heated = self.film.hottest_c - self.film.oil_c
        return (self.scuffing_c - self.film.oil_c) / heated if heated > 0.0 else inf

    @property
    def share(self) -> float:
        """The smaller of safety against scuffing and life of the flanks, each over its wanted value."""
        scuffing = self.scuffing_safety
        lasting = self.wear.limit_mm / self.wear.deepest_mm if self.wear.deepest_mm > 0.0 else inf
        return lasting if scuffing is None else min(lasting, scuffing / LEAST_SCUFFING)


Factors = Callable[[LoadedContacts], tuple[Array, Array]]
"""K_V and K_Hbeta of n contacts, shape (n,) each, from all contacts of their positions."""

Touched = tuple[LoadedContacts, Array, Pressed]
"""The contacts of flanks among all contacts of some positions, their K_V, and as film and heat need them."""


@dataclass(frozen=True, eq=False)
class _Pair:
    """The common values of all places of contact of a pair.

    ``factors`` gives K_V and K_Hbeta of all contacts of some positions; ``bulk_c`` is the temperature of the teeth.
    """

    materials: tuple[Material, Material]
    conditions: Conditions
    running: Running
    coefficients_mm3_n_m: tuple[float, float]
    factors: Factors
    oil: Oil | None
    bulk_c: float = 0.0

    def touching(self, contacts: LoadedContacts) -> Touched:
        """The contacts of flanks among all contacts of some positions."""
        shaken, uneven = self.factors(contacts)
        load = uneven * shaken_n_mm(contacts, self.conditions, self.running, shaken)
        kept, load = contacts.kept(contacts.flanks), load[contacts.flanks]
        return kept, shaken[contacts.flanks], Pressed(load, kept.relative_curvature, kept.rolling_mm_s / 1000.0)

    def flash(self, pressed: Pressed, oil: Oil) -> Array:
        """The rise of each contact over the temperature of the teeth, in K."""
        return flash_k(pressed, friction(pressed, oil, self.conditions), self.materials)

    def film_um(self, pressed: Pressed, flash: Array, oil: Oil) -> Array:
        """The thickness of the film at each contact."""
        return film_um(pressed, flash, self.bulk_c, oil, self.materials)

    def quantities(self, side: IndexArray, shaken: Array, pressed: Pressed) -> Array:
        """The quantities whose largest values are searched, at n contacts of flanks of a side, shape (6, n).

        Roughness over film, heat in K, depths of wear in mm of both flanks over the wanted life, and their sum on
        pushing flanks and on backs.  Wear follows the mean load, which vibration does not change.
        """
        thin = flash = np.zeros(pressed.line_n_mm.size)
        unparted = np.ones_like(thin)
        if self.oil is not None:
            flash = self.flash(pressed, self.oil)
            film = self.film_um(pressed, flash, self.oil)
            thickness = np.maximum(film / roughness_um(self.conditions), LEAST_FILM)
            thin, unparted = 1.0 / thickness, share_unparted(thickness)
        # Each meeting counts as the worst meeting: exact where teeth always meet the same mates.
        met = self.running.meetings(self.conditions.life_h)
        depth = met[:, None] * depth_mm(pressed, unparted / shaken, self.coefficients_mm3_n_m)
        play = depth.sum(axis=0)
        return np.vstack([thin, flash, depth, *(np.where(side == flank, play, 0.0) for flank in BOTH_SIDES)])


LEAST_FILM = 1e-6
"""Specific film thickness where flanks draw in no oil at all."""


def surfaces_of(
    loading: Loading,
    choices: tuple[Choice, Choice],
    materials: tuple[Material, Material],
    warm: tuple[ToothTemperature, ToothTemperature],
    conditions: Conditions,
    running: Running,
    factors: Factors,
) -> Surfaces:
    """The state of the flanks under their loads, with all factors of load of the pressure."""
    mates = (choices, choices[::-1])
    plastic = [isinstance(choice.entry, Plastic) for choice in choices]
    oil = None if any(plastic) or conditions.lubrication == "dry" else Oil.of(conditions)
    first, second = (coefficient_mm3_n_m(*both, conditions) for both in mates)
    pair = _Pair(materials, conditions, running, (first, second), factors, oil)
    touched = pair.touching(loading.contacts)
    if oil is not None:
        pair = replace(pair, bulk_c=_bulk_c(pair, oil, loading, touched))
    thin, hot, *worn = _largest(pair, loading, touched)
    limit = LIMIT_MODULES * running.module_mm
    wear = Wear((first, second), (worn[0], worn[1]), worn[2].value + worn[3].value, limit, conditions.life_h)
    film, scuffs_c = None, None
    least_n = NOTHING_MPA * running.face_width_mm * running.module_mm
    judged = bool(loading.contacts.force_n.max(initial=0.0) > least_n)
    if oil is not None and judged:
        thickness = replace(thin, value=1.0 / thin.value if thin.value > 0.0 else inf)
        films = pair.film_um(touched[2], pair.flash(touched[2], oil), oil)
        degrees_c = conditions.oil_temperature_c, pair.bulk_c
        film = Film(thickness, roughness_um(conditions), *degrees_c, hot, touched[0], films)
        steels = [choice.entry.group.scuffing_structure for choice in choices if isinstance(choice.entry, Ferrous)]
        scuffs_c = scuffing_c(oil, conditions, min(steels)) if len(steels) == 2 else None
    pitting = [film_factor(*both, conditions, running) for both in mates]
    own = [temperatures if is_plastic else None for temperatures, is_plastic in zip(warm, plastic, strict=True)]
    return Surfaces(
        film,
        scuffs_c,
        (pitting[0], pitting[1]),
        wear,
        (own[0], own[1]),
        judged,
        _creep(loading, choices, conditions, running),
    )


def _creep(loading: Loading, choices: tuple[Choice, Choice], conditions: Conditions, running: Running) -> Creep | None:
    """The creep of a pair with at least one plastic gear, under the loads of its law."""
    contacts, even = (loading.still or loading).contacts, (loading.still or loading).even
    if not contacts.force_n.size:
        return None
    borne = float(contacts.share[even[contacts.position]].sum()) / int(even.sum())
    loaded_h = conditions.life_h * borne / min(running.teeth)
    plastics = [choice.entry.name for choice in choices if isinstance(choice.entry, Plastic)]
    factors = [creep_factor(name, loaded_h) for name in plastics]
    if not factors or None in factors:
        return None
    way = float((contacts.force_n / contacts.stiffness_n_mm).max())
    return Creep(way, way * max(factor for factor in factors if factor is not None), loaded_h)


def _bulk_c(pair: _Pair, oil: Oil, loading: Loading, touched: Touched) -> float:
    """The temperature of the teeth: the oil's, plus a share of the mean flash temperature over the cycle."""
    touching, _, pressed = touched
    flash = pair.flash(pressed, oil)[loading.even[touching.position]]
    share = BULK_SHARE[pair.conditions.lubrication]
    return pair.conditions.oil_temperature_c + share * float(flash.mean() if flash.size else 0.0)


def _largest(pair: _Pair, loading: Loading, touched: Touched) -> list[ContactValue]:
    """The largest value of each quantity over the cycle, with its place."""

    def over(touched: Touched, count: int) -> tuple[LoadedContacts, Array, Array]:
        touching, shaken, pressed = touched
        found = pair.quantities(touching.side, shaken, pressed)
        largest = np.zeros((len(found), count))
        for row, values in zip(largest, found, strict=True):
            np.maximum.at(row, touching.position, values)
        return touching, found, largest

    def at(rolled_mm: Array) -> Array:
        return over(pair.touching(loading.between(rolled_mm)), rolled_mm.size)[2]

    known = over(touched, loading.rolled_mm.size)[2]
    places, values = loading.rolled_mm, known
    if loading.closed:
        places, values = np.append(places, places[0] + loading.cycle_mm), np.hstack([known, known[:, :1]])
    extremes = largest_from(at, places, values, KNOWN * known.max(axis=1))
    rolled = np.array([extremum.at for extremum in extremes])
    touching, found, _ = over(pair.touching(loading.between(rolled)), rolled.size)
    return [_place(touching, np.where(touching.position == row, found[row], -1.0)) for row in range(rolled.size)]


def _place(touching: LoadedContacts, values: Array) -> ContactValue:
    """The place of the largest value at contacts; no place where only edges touch."""
    if not values.size or values.max() < 0.0:
        return ContactValue(0.0, 0.0, 1, 1)
    row = int(values.argmax())
    teeth = touching.on(Gear.DRIVING).tooth[row], touching.on(Gear.DRIVEN).tooth[row]
    return ContactValue(float(values[row]), float(touching.phi1_rad[row]), int(teeth[0]), int(teeth[1]))
