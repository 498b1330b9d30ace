"""Random laws, sizes, racks, shifts and cutters: gears that never overlap, or a refusal that names a place."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, radians, tan

import numpy as np
import pytest
from shapely import Polygon

from ncgear.errors import DesignError, NoSuchMechanism
from ncgear.machine.rack import BasicRack, TipRelief
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.expression import driven_angle_expression_law
from ncgear.ratio.laws.uniform import uniform_law
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.form import Cutter, CutterKind, TipLimits, ToothForm
from ncgear.teeth.gear import ToothedPair, toothed_pair
from oracles import meshing
from pairs import baler_law

POSITIONS = 97

LOBES = [(1, 1)] * 4 + [(1, 2), (2, 1), (2, 3), (3, 1)]


@dataclass(frozen=True, eq=False)
class Wanted:
    """A random design at module 2."""

    law: Transmission
    teeth: int
    form: ToothForm
    advance_mm: float

    def made(self) -> tuple[PitchPair, ToothedPair]:
        pitch = sized_pair(self.law, self.teeth, 2.0, None)
        return pitch, toothed_pair(pitch, self.form, 0.005, advance_mm=self.advance_mm)


def random_law(random: np.random.Generator) -> Transmission:
    """From even to as uneven as machines are, and beyond; hollow curves among them."""
    lobes = Lobes(*LOBES[random.integers(len(LOBES))])
    match random.integers(5):
        case 0:
            return uniform_law(lobes)
        case 1:
            return elliptical_law(random.uniform(0.0, 0.8), random.uniform(0.0, 2.0 * pi), lobes)
        case 2:
            waves = random.integers(1, 4)
            return driven_angle_expression_law(f"phi - {random.uniform(0.0, 0.6) / waves}*sin({waves}*phi)", Lobes())
        case 3:
            first, second, phase = random.uniform([0.0, 0.0, 0.0], [0.4, 0.15, 6.0])
            return driven_angle_expression_law(
                f"phi - {first}*sin(phi) - {second}*(sin(2*phi + {phase}) - sin({phase}))", Lobes()
            )
        case _:
            return baler_law()


def random_rack(random: np.random.Generator) -> BasicRack:
    """Common angles and heights; the root radius up to what fits."""
    angle = radians(random.choice([14.5, 20.0, 20.0, 22.5, 25.0]))
    addendum = random.choice([0.8, 1.0, 1.0, 1.1])
    dedendum = addendum + random.choice([0.25, 0.25, 0.4])
    largest = (pi / 4.0 - dedendum * tan(angle)) / (1.0 / cos(angle) - tan(angle))
    radius = min(random.choice([0.0, 0.2, 0.38]), 0.9 * largest)
    relief = TipRelief(2.0 * random.uniform(0.005, 0.03), 1.0, 2.0 * addendum) if random.random() < 0.15 else None
    sizes = (2.0 * addendum, 2.0 * dedendum, 2.0 * radius)
    return BasicRack(2.0, angle, *sizes, random.choice([0.0, 0.0, 0.1]), relief=relief)


def random_form(random: np.random.Generator) -> ToothForm:
    """Any cutter, any limits, shifts that cancel."""
    kind = random.choice([CutterKind.AUTO, CutterKind.AUTO, CutterKind.RACK, CutterKind.PINION, CutterKind.MATE])
    teeth = int(random.integers(8, 60)) if kind is CutterKind.PINION and random.random() < 0.6 else None
    shift = random.choice([0.0, 0.0, random.uniform(-1.2, 1.2)])
    return ToothForm(
        random_rack(random),
        driving_shift_mm=float(shift),
        driven_shift_mm=-float(shift),
        shift_for_undercut=bool(shift == 0.0 and random.random() < 0.3),
        cutter=Cutter(kind, teeth),
        limits=TipLimits(random.choice([0.0, 0.4, 0.8]), bool(random.random() < 0.7)),
    )


def wanted(seed: int) -> Wanted:
    """The design of a number."""
    random = np.random.default_rng(seed)
    law = random_law(random)
    teeth = int(np.exp(random.uniform(np.log(8.0), np.log(120.0))))
    teeth = max(teeth // law.lobes.driving, 3) * law.lobes.driving
    advance = random.uniform(-6.0, 20.0) if random.random() < 0.2 else 0.0
    return Wanted(law, teeth, random_form(random), float(advance))


def judge(seed: int) -> bool:
    """Whether gears were made; those that were are judged, and refusals must say where."""
    try:
        pitch, pair = wanted(seed).made()
    except DesignError as refusal:
        assert refusal.key.startswith("gears.")
        assert isinstance(refusal, NoSuchMechanism), f"{seed}: {refusal}"
        assert "tooth" in refusal.problem or "phi1 = " in refusal.problem, f"{seed}: {refusal}"
        return False
    phi1 = np.linspace(0.0, pitch.driving.turn_rad, POSITIONS + 1)
    phi2 = pitch.transmission.driven_angle(phi1).value
    outlines = Polygon(pair.driving.outline_mm), Polygon(pair.driven.outline_mm)
    report = meshing.Pair(*outlines, phi1, phi2, pitch.center_distance_mm).report(POSITIONS)
    assert report.overlap_depth.max() <= 1.2 * 0.005, f"{seed}: {report.overlap_depth.max()} mm"
    return True


@pytest.mark.parametrize("first", range(0, 32, 8))
def test_random_designs_are_made_or_refused_by_name(first: int) -> None:
    assert sum(judge(seed) for seed in range(first, first + 8)) >= 3


@pytest.mark.slow
@pytest.mark.parametrize("first", range(32, 832, 50))
def test_many_random_designs_are_made_or_refused_by_name(first: int) -> None:
    assert sum(judge(seed) for seed in range(first, first + 50)) >= 25
