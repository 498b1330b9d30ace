"""What is told of loaded teeth beside their stresses: film, heat and wear of flanks, and the vibration of the mesh."""

from __future__ import annotations

from math import degrees, floor, isfinite, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from ncgear.design.words import listed
from ncgear.figures.numbers import figure, fixed, known, placed, to_digits
from ncgear.figures.tables import rows_text
from ncgear.numerics.arrays import largest_rows
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.strength.film import Regime
from ncgear.strength.material import MaterialFamily
from ncgear.strength.plastics import CREEP_C, CREEP_MPA
from ncgear.strength.vibration import RESONANCE

if TYPE_CHECKING:
    from ncgear.project.strengthening import Rating
    from ncgear.project.vibration import SpeedSweep, ToldVibration
    from ncgear.strength.surfaces import ContactValue, Film, Surfaces

REGIMES = {Regime.FULL: "full film", Regime.MIXED: "mixed lubrication", Regime.BOUNDARY: "boundary lubrication"}
"""The words for a regime."""

ONLY_A_JAM = "not judged, because only a jam presses the flanks, a few times"


def surfaces_figures(found: Surfaces) -> dict[str, Any]:
    """Sections of film, scuffing and wear; None of what is not judged."""
    film, wear = found.film, found.wear
    figures: dict[str, Any] = {"film": None, "scuffing": None}
    if film is not None:
        safety = found.scuffing_safety
        figures["film"] = {
            "regime": film.regime.value,
            "specific_film_thickness_min": known(film.thickness.value),
            **_at("specific_film_thickness_min", film.thickness),
            "flank_roughness_ra_um": film.roughness_um,
            "oil_c": film.oil_c,
            "teeth_c": film.bulk_c,
            "pitting_film_factor": min(found.pitting_factor),
        }
        figures["scuffing"] = {
            "scuffing_safety": None if safety is None else known(safety),
            "contact_max_c": film.hottest_c,
            **_at("contact_max", film.flash_k),
            "scuffing_c": found.scuffing_c,
        }
    if not found.judged:
        return {**figures, "wear": None}
    figures["wear"] = {
        "wanted_h": wear.wanted_h,
        "limit_mm": wear.limit_mm,
        "until_limit_h": known(wear.life_h),
        "backlash_added_mm": wear.play_mm,
    }
    if (creep := found.creep) is not None:
        figures["creep"] = {
            "deflection_mm": creep.at_once_mm,
            "deflection_after_life_mm": creep.after_mm,
            "loaded_h": creep.loaded_h,
        }
    for gear, coefficient, depth in zip(Gear, wear.coefficients_mm3_n_m, wear.depth_mm, strict=True):
        figures["wear"][gear.value] = {
            "coefficient_mm3_n_m": coefficient,
            "depth_max_mm": depth.value,
            "depth_max_at_rad": depth.phi1_rad,
            "tooth": depth.tooth(gear),
        }
    return figures


def _at(name: str, place: ContactValue) -> dict[str, Any]:
    return {f"{name}_at_rad": place.phi1_rad, "driving_tooth": place.driving_tooth, "driven_tooth": place.driven_tooth}


FILM = ("film_um", "film_phi1_rad", "specific_film_thickness")
"""Columns of the oil's film at a place of contact."""


def _film_columns(film: Film) -> list[list[object]]:
    columns = film.film_um, film.contacts.phi1_rad, film.film_um / film.roughness_um
    return [column.tolist() for column in columns]


def film_csv(film: Film) -> str:
    """A row for each computed place of contact, with the numbers of both teeth and of the section of the width."""
    numbers = *(film.contacts.on(gear).tooth.tolist() for gear in Gear), (film.contacts.section + 1).tolist()
    rows = zip(*numbers, *_film_columns(film), strict=True)
    return rows_text(("driving_tooth", "driven_tooth", "section", *FILM), rows)


def film_of_teeth(film: Film | None, gear: Gear) -> dict[int, tuple[object, ...]]:
    """The cells below FILM of the thinnest film of each tooth of a gear that touches, by its number."""
    if film is None:
        return {}
    cells, tooth = list(zip(*_film_columns(film), strict=True)), film.contacts.on(gear).tooth
    thinnest = largest_rows(-film.film_um, tooth, int(tooth.max(initial=0)) + 1)
    return {number: cells[row] for number, row in enumerate(thinnest.tolist()) if row >= 0}


MUCH_PLAY = 0.25
"""Growth of the play, as a share of the play of new gears, from which teeth knock much harder."""


def surfaces_rows(drive: Drive, found: Surfaces) -> list[tuple[str, str]]:
    """Names and texts of what is told: wear of all, film and scuffing of metal in oil, heat of plastics."""
    wear, film, creep = found.wear, found.film, found.creep
    told = "none: a film parts the flanks"
    if not found.judged:
        told = ONLY_A_JAM
    elif wear.deepest_mm > 0.0:
        grows = f"backlash grows by up to {to_digits(wear.play_mm, 2)} mm"
        if drive.design.masses is not None and wear.play_mm > MUCH_PLAY * drive.play.least_normal_mm.value:
            grows += " (see --worn)"
        ends = grows if wear.holds else f"a tenth of the module is gone after {hours_words(wear.life_h)}"
        told = f"{to_digits(wear.deepest_mm, 2)} mm in {hours_words(wear.wanted_h)}, to a factor of ten; {ends}"
    rows = [("wear", told)]
    if not found.judged and drive.conditions.lubrication != "dry" and not any(found.warm):
        rows.append(("film", ONLY_A_JAM))
    if film is not None:
        rows += [("film", _film_words(drive, film)), ("scuffing", _scuffing_words(drive, film, found))]
    heat = [
        f"{gear.value} gear {fixed(warm.flank_c, 0)} \u00b0C at flanks, {fixed(warm.root_c, 0)} at roots"
        for gear, warm in zip(Gear, found.warm, strict=True)
        if warm is not None
    ]
    if not heat or not found.judged:
        return rows
    plastics = {material.name for material in drive.materials if material.family is MaterialFamily.PLASTIC}
    unknown = listed(sorted(plastics - CREEP_MPA.keys()), "and")
    gives_way = f"not judged, because no creep modulus of {unknown} is known here"
    if creep is not None:
        # No limit is known by which it is judged
        ways = f"{to_digits(creep.at_once_mm, 2)} mm at once, {to_digits(creep.after_mm, 2)} mm"
        lasting = f"after {hours_words(creep.loaded_h)} under load, at {CREEP_C:g} \u00b0C; more where they are warmer"
        gives_way = f"teeth give way by {ways} {lasting}"
    duty = drive.conditions.duty_cycle
    pauses = f", running {to_digits(100.0 * duty, 3)} % of ten minutes" if duty < 1.0 else ""
    return [*rows, ("heat", f"{'; '.join(heat)} (VDI 2736{pauses})"), ("creep", gives_way)]


def _film_words(drive: Drive, film: Film) -> str:
    assumed = " assumed" if drive.design.strength.temperature_c is None else ""
    least = to_digits(film.thickness.value, 2)
    oil = f"{drive.conditions.lubrication} at {film.oil_c:g} \u00b0C{assumed}"
    return f"{REGIMES[film.regime]}: {least} of the roughness at {angle_words(film.thickness)}, {oil}"


def _scuffing_words(drive: Drive, film: Film, found: Surfaces) -> str:
    hottest = f"{fixed(film.hottest_c, 0)} \u00b0C at {angle_words(film.flash_k)}"
    if found.scuffing_c is None or found.scuffing_safety is None:
        return f"{hottest}; where oil fails between bronze and steel is not known"
    assumed = "" if "oil_fzg_stage" in drive.design.strength.model_fields_set else " assumed"
    fails = f"oil fails at {fixed(found.scuffing_c, 0)} \u00b0C (FZG stage {drive.conditions.oil_fzg_stage:g}{assumed})"
    return f"safety {to_digits(found.scuffing_safety, 3)}, {hottest}, {fails}"


def angle_words(place: ContactValue) -> str:
    """``phi1 = 141.4 deg``."""
    return f"phi1 = {placed(degrees(place.phi1_rad))} deg"


def place_words(place: ContactValue) -> str:
    """``phi1 = 141.4 deg, teeth 18 : 17``."""
    return f"{angle_words(place)}, teeth {place.driving_tooth} : {place.driven_tooth}"


def hours_words(hours: float) -> str:
    """Hours to two digits."""
    return f"{to_digits(round(hours, 1 - floor(log10(hours))), 2)} h" if isfinite(hours) and hours >= 0.01 else "none"


def vibration_of_rating(drive: Drive, rating: Rating) -> ToldVibration | None:
    """What is told of the vibration of rated teeth; None where nothing bears."""
    from ncgear.project.vibration import mesh_stiffness, told_vibration

    mesh, strength = mesh_stiffness(rating.loading, drive.running), rating.strength
    if mesh is None:
        return None
    contacts, factor = strength.contacts, strength.stresses.dynamic_factor
    # Sections of helical teeth have factors of their own, of which the mean by their loads is told.
    whole, loaded = (np.bincount(contacts.position, forces) for forces in (factor * contacts.force_n, contacts.force_n))
    mean = (whole / np.maximum(loaded, np.finfo(float).tiny))[contacts.position]
    return told_vibration(drive, drive.vibration, mesh, contacts.phi1_rad, mean, contacts.pair_force_n)


def vibration_figures(told: ToldVibration | None) -> dict[str, Any]:
    """The dynamic factor, the resonance ratios of a turn, and the critical speeds."""
    if told is None:
        return {}
    critical = zip(("critical_speed_min_rpm", "critical_speed_max_rpm"), told.critical_rpm or (), strict=False)
    return {key: value for key, value in vars(told).items() if key != "critical_rpm"} | dict(critical)


def vibration_words(told: ToldVibration) -> str:
    """The dynamic factor where a pair bears most, the largest force with it, and the critical speeds."""
    factor = f"K_V {to_digits(told.dynamic_factor, 3)}{' as given' if told.dynamic_factor_is == 'given' else ''}"
    factor += f", up to {figure('force_n', told.peak_tooth_force_vibrating_n)} with it"
    if told.critical_rpm is None:
        return f"{factor}; nothing that moves has inertia"
    low, high = (to_digits(speed, 2) for speed in told.critical_rpm)
    return f"{factor}; resonance at {low} to {high} r/min"


def stretches_words(told: ToldVibration) -> str:
    """``between phi1 = 20 and 55 deg``, for each stretch in which a mesh resonates."""
    return "between phi1 = " + ", ".join(
        f"{fixed(low, 0)} and {fixed(high, 0)} deg" for low, high in told.resonates_between_deg
    )


BAND = f"N from {RESONANCE[0]:g} to {RESONANCE[1]:g}"
"""The words for the resonance ratios of a resonance."""

COLUMNS = ("speed_rpm", "resonance_ratio_min", "resonance_ratio_max", "dynamic_factor_max", "load_factor_swinging")
"""Columns of the table over the driving speed."""


def speeds_csv(sweep: SpeedSweep) -> str:
    """A row for each driving speed; the last column is empty of swings without end, and of loads that change flanks."""
    swinging = [None] * sweep.speed_rpm.size if sweep.load_factor is None else map(known, sweep.load_factor.tolist())
    columns = (column.tolist() for column in (sweep.speed_rpm, sweep.least, sweep.greatest, sweep.factor))
    return rows_text(COLUMNS, zip(*columns, swinging, strict=True))
