"""Answers of strength made up for tests of what tells them: simple stresses over a cycle, with known least safeties."""

from __future__ import annotations

from dataclasses import replace
from math import inf, lcm, pi

import numpy as np

from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.strength.answer import ContactStresses, GearStrength, Strength, ToothLife
from ncgear.strength.contacts import LoadedContacts
from ncgear.strength.loading import Loading
from ncgear.strength.material import EnduredStress, Material, MaterialFamily
from ncgear.strength.surfaces import ContactValue, Film, Surfaces, Wear

STEEL = Material(
    "some steel",
    MaterialFamily.STEEL,
    206000.0,
    0.3,
    7850.0,
    EnduredStress(np.array([1e5, 5e7]), np.array([1600.0, 1000.0])),
    EnduredStress(np.array([1e3, 3e6]), np.array([900.0, 400.0])),
    "made up",
)
PLASTIC = Material(
    "some plastic",
    MaterialFamily.PLASTIC,
    2800.0,
    0.35,
    1400.0,
    None,
    EnduredStress(np.array([1e5, 1e8]), np.array([60.0, 25.0])),
    "made up",
)

PER_PITCH = 8
"""Positions in a tooth pitch; the pair behind bears load too at the first half of them."""


def made_up(drive: Drive, bending: float = 2.0, contact: float | None = 1.5) -> Strength:
    """An answer for a drive whose least safeties are these, on the driving gear's tooth 2 (the last one is unloaded).

    The driven gear's are a tenth greater.  Without a safety against pitting, the gears are of plastic.
    """
    size = drive.pitch.size
    contacts = _contacts(size.driving_teeth, size.driven_teeth)
    load = 1.0 + np.cos(contacts.phi1_rad - 2.0 * pi / size.driving_teeth)
    end = 2.0 * pi * lcm(size.driving_teeth, size.driven_teeth) / size.driving_teeth
    pressure = np.where(contacts.flanks, 500.0 * np.sqrt(load), np.nan)
    roots = np.stack([100.0 * load, 90.0 * load]), np.stack([110.0 * load, 99.0 * load])
    stresses = ContactStresses(pressure, *roots, np.full(load.shape, 1.3), np.full(load.shape, 1.1))
    gears = {
        gear: _gear(count, gear, bending * factor, None if contact is None else contact * factor)
        for gear, count, factor in ((Gear.DRIVING, size.driving_teeth, 1.0), (Gear.DRIVEN, size.driven_teeth, 1.1))
    }
    return Strength("estimate", "masses", contacts, stresses, gears[Gear.DRIVING], gears[Gear.DRIVEN], end)


def made_up_loading(drive: Drive, strength: Strength) -> Loading:
    """The loads behind such an answer, with an error of 120 microrad."""
    count = PER_PITCH * drive.pitch.size.driving_teeth
    phi1 = 2.0 * pi * np.arange(count) / count
    return Loading(
        contacts=strength.contacts,
        between=lambda rolled_mm: strength.contacts.kept(np.isin(strength.contacts.position, rolled_mm)),
        rolled_mm=np.arange(count, dtype=float),
        cycle_mm=float(count),
        phi1_rad=phi1,
        torque_n_mm=np.full(count, 1e5),
        error_rad=60e-6 * np.cos(phi1),
        even=np.ones(count, dtype=bool),
        transmission_error_rad=120e-6,
        contact_ratio=1.5,
        cycle_rad=2.0 * pi,
        borne=None,
    )


def made_up_surfaces() -> Surfaces:
    """Flanks of metal in oil that lose a hundredth of a millimetre, of a limit of a fifth."""
    place = ContactValue(0.01, 1.0, 2, 2)
    contacts = _contacts(19, 19)
    films = 0.5 + 0.1 * contacts.phi1_rad
    film = Film(replace(place, value=0.5), 1.0, 40.0, 41.0, replace(place, value=9.0), contacts, films)
    return Surfaces(film, 300.0, (0.9, 0.9), Wear((1e-8, 1e-8), (place, place), 0.02, 0.2, 20_000.0), (None, None))


def _contacts(driving: int, driven: int) -> LoadedContacts:
    positions = np.arange(PER_PITCH * driving)
    behind = positions[positions % PER_PITCH < PER_PITCH // 2]
    position = np.concatenate([positions, behind])
    tooth = np.concatenate([positions // PER_PITCH, behind // PER_PITCH - 1])
    order = np.argsort(position, kind="stable")
    position, tooth = position[order], tooth[order]
    phi1 = 2.0 * pi * position / (PER_PITCH * driving)
    count = position.size
    some: Array = np.ones(count)
    return LoadedContacts(
        position,
        phi1,
        np.zeros(count, dtype=np.intp),
        1000.0 * (2.0 + np.cos(phi1)),
        1e5 * some,
        0.1 * some,
        np.ones(count, dtype=bool),
        np.stack([some, 2.0 * some], axis=1),
        2 * (tooth % driving) + 1,
        some + 0j,
        -some + 0j,
        2 * (-tooth % driven),
        some + 0j,
        -some + 0j,
        np.zeros(count, dtype=np.intp),
        some,
    )


def _gear(teeth: int, gear: Gear, bending: float, contact: float | None) -> GearStrength:
    material = STEEL if contact is not None else PLASTIC
    lives = _life(teeth, bending, 200.0), None if contact is None else _life(teeth, contact, 700.0)
    return GearStrength(gear, material, *lives)


def _life(teeth: int, least: float, stress_mpa: float) -> ToothLife:
    """Stresses that fall away from tooth 2 on both sides; the last tooth bears nothing."""
    place = 2.0 * pi * np.arange(teeth) / teeth
    share = 0.6 + 0.4 * np.cos(place - place[1])
    share[-1] = 0.0
    safety = np.divide(least, share, out=np.full(teeth, inf), where=share > 0.0)
    life = np.where(safety > 2.0, inf, 1e4 * safety**6)
    return ToothLife(stress_mpa * share, place, safety, life)
