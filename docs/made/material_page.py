"""The page of materials, its tables from the program's own table and formulas."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ncgear.figures.tables import markdown
from ncgear.numerics.arrays import Array
from ncgear.strength.classes import LifePoint, Quality
from ncgear.strength.endurance import RELIABILITY_FACTORS, SHARES, limit_bending_mpa, limit_contact_mpa
from ncgear.strength.materials import ASSUMED, ROWS, TABLE, Bronze, Choice, Ferrous, Plastic
from ncgear.strength.plastics import (
    LUBRICATED_FRICTION,
    PLASTICS_FRICTION,
    flank_limit_mpa,
    root_limit_mpa,
)
from ncgear.strength.wear import usual_mm3_n_m

NAME = "materials.md"

INTRODUCTION = f"""\
# Materials

<!-- Made by `make docs` from the table of materials that the program has. -->

What flanks and roots of gears endure, by name. [`gears.material`](design-file/gears.md#gearsmaterial) takes one name
for both gears or one for each, and a person's own values in place of the table's:

| written | what it is |
|---|---|
| `material: 16MnCr5` | both gears |
| `material: {{driving: 16MnCr5, driven: POM}}` | each its own |
| `material: {{name: 42CrMo4, quality: ME, hardness: 350}}` | both, of a better grade and harder than usual |
| `material: {{name: C45, contact_limit_mpa: 600, bending_limit_mpa: 450}}` | own stresses, the rest as of C45 |

A design that names none is computed as if it were of {ASSUMED}, quenched and tempered, and what is told says that this
is assumed. All figures are from secondary sources: standards as transcribed by others, compared where there were two.
"""

METALS = """\
## Steel, iron and bronze

Stresses of endurance in MPa at the usual hardness and quality. That of flanks is &sigma;<sub>Hlim</sub>. That of roots
is the local one, &sigma;<sub>FE</sub> = 2 &sigma;<sub>Flim</sub>. Steel and iron follow the lines of
ISO 6336-5:2016, table 1, &sigma; = A x + B with the hardness x; those of bronze are AGMA 2001-D04's for 1e7 cycles, and
fewer cycles are given no more.
"""

LIFE = """\
### Life

Factors on the stresses of endurance for numbers of load cycles; between them, lines in logarithms (ISO 6336-2, table 2,
and ISO 6336-3, table 1). Fewer cycles than the first have its factor, more than the last have 0.85. No pits are
allowed for.
"""

FACTORS = """\
### Other factors

Pressures count where a pair of flanks bears the most of the load: ISO 6336-2 rates the pitch point and where single
contact begins. Where teeth begin and cease to touch, flanks near their base circles have small radii and high
pressures, in the gears that were tested as well.

Beyond the first point, flanks have the factors Z<sub>L</sub>, Z<sub>v</sub> and Z<sub>R</sub> of the oil's film, at the
mean speed along the pitch curves and the radius of circular gears of the same teeth; Z<sub>W</sub>, where a soft flank
runs against a hard one of R<sub>z</sub> 6 &micro;m or less; and Z<sub>X</sub> of the size. Roots have
Y<sub>RrelT</sub> of their roughness and Y<sub>X</sub> of the size; Y<sub>deltarelT</sub> is taken as 1. A root whose
tooth is loaded on both flanks counts 0.357 of the compression as tension, so that equal loads both ways leave 0.7 of
the stress, as in the annex of ISO 6336-3. Dry metal has no figures for pitting: its flanks wear, as below.

All stresses are divided by Y<sub>Z</sub> for the share of gears that shall live so long (AGMA 2101), 1 at the 99 % that
the figures of ISO 6336 are for:
"""

PLASTICS = """\
## Plastics

Strength falls with temperature, and there is no endurance limit. Polyacetal and polyamide 66 follow VDI 2736-2, as
public programs have its formulas, T in &deg;C and N load cycles, from 1e5 on and from 20 &deg;C to the highest
temperature given:

- roots of POM, twice &sigma;<sub>FlimN</sub> = 26 - 0.0025 T&sup2; + 400 N<sup>-0.2</sup>
- roots of PA66, twice &sigma;<sub>FlimN</sub> = 30 - 0.22 T + (4600 - 900 T<sup>0.3</sup>) N<sup>-1/3</sup>
- flanks of both, &sigma;<sub>HlimN</sub> = 36 - 0.0012 T&sup2; + (1000 - 0.025 T&sup2;) N<sup>-0.21</sup>

Beyond 1e8 cycles they are an extrapolation. Polyamide takes up water: moist and as moulded it differs in stiffness
here, not in strength. Prints are a rough, cautious guess (below).
"""

WEAR = """\
## Wear

Wear coefficients in mm&sup3; for each N and m of sliding, of flanks that no film parts ([how they
count](method.md#strength-strength)). They are known to the power of ten at best: of steel in oil, 5e-7 (A. Flodin, S.
Andersson, 1997) and 9.65e-10 (P. Bajpai, A. Kahraman, N. E. Anderson, 2004) were published, of dry steel K = 1.3e-4
over the hardness where it is hard (J. F. Archard, 1953) and K / 3 = 5e-4 where it is not (E. Rabinowicz), of plastics
a maker's tests on steel. Metal that runs on plastic loses next to nothing.
[`strength.wear_coefficient_mm3_n_m`](design-file/strength.md) takes a person's own.
"""

TEMPERATURES = 20.0, 40.0, 60.0, 80.0, 100.0

HEAT = """\
### Temperature of the teeth

T = T<sub>0</sub> + P k / (b z (v m)<sup>0.75</sup>) ED<sup>0.64</sup> after Hachmann and Strickle as in VDI 2736-2,
with the power P in W that friction takes on the loaded flanks, width b and module m in mm, speed v along the pitch
curves in m/s. k is 6300 at flanks and 895 at roots where one gear is of metal, 9000 and 2148 where both are of
plastic, in open gears. ED, `strength.duty_cycle`, is the largest share of ten minutes in which they run. Teeth in oil
have the oil's temperature. Coefficients of friction:
"""

PRINTED = """\
### Prints

No published fatigue tests of printed gears were found through which a curve over load and cycles could be drawn: tests
tell the life of one pair at one load, such as that PETG outlives PLA by a fifth (Tunalioglu and Agca, Polymers 14
(2022) 2064). The stresses of roots here are a cautious guess without a source: half of the usual strength of printed
bars in tension for a thousand cycles, a fifth for a million, an eighth for long, and falling in a line with temperature
to nothing where the plastic softens. Take twice the usual safety, and try. Flanks of prints wear and melt rather than
pit: of their flanks wear alone is told.

## What is not covered

Micropitting, fracture under a single blow beyond the static factors, creep of hot plastics and of others than POM and
moist PA66, and vibration beyond K<sub>V</sub>. ISO 6336 and VDI 2736 are written for circular gears; for others, what
follows is a local estimate.
"""


LUBRICATIONS = "oil", "grease", "dry"
METAL_HEADS = ("name", "material", "class", "hardness", "flanks", "roots", "E in GPa", "density in kg/m&sup3;")
PLASTIC_HEADS = ("name", "E in GPa", "density in kg/m&sup3;", "up to", "source")


def material_page() -> str:
    """The whole page."""
    return "\n".join([*_lines()]).rstrip() + "\n"


def _lines() -> Iterator[str]:
    yield from (INTRODUCTION, METALS)
    yield from markdown(METAL_HEADS, [_metal(row) for row in ROWS if not isinstance(row, Plastic)])
    yield from ("", "Quality MQ; by quality and at the ends of the range of hardness, flanks and roots:", "")
    yield from markdown(("class", "hardness", "ML", "MQ", "ME"), _classes())
    yield from ("", LIFE)
    yield from markdown(("class", "flanks: cycles and factor", "roots: cycles and factor"), _lives())
    yield from ("", FACTORS)
    shares, factors = (f"{share:g}" for share in SHARES), (f"{factor:g}" for factor in RELIABILITY_FACTORS)
    yield from markdown(("share", *shares), [["Y<sub>Z</sub>", *factors]])
    yield from ("", WEAR)
    yield from markdown(("flanks", *LUBRICATIONS), _coefficients())
    yield from ("", PLASTICS)
    yield "Stresses of roots and flanks in MPa after 1e6 and 1e8 cycles:\n"
    degrees = [f"{t:g} &deg;C" for t in TEMPERATURES]
    yield from markdown(("name", "material", "", *degrees), _plastics())
    yield ""
    yield from markdown(PLASTIC_HEADS, [_elastic(row) for row in ROWS if isinstance(row, Plastic)])
    yield from ("", HEAT)
    yield from markdown(("pair", "coefficient"), _frictions())
    yield from ("", PRINTED)


def _metal(row: Ferrous | Bronze) -> list[str]:
    choice, elastic = Choice(row), row.elastic
    if isinstance(row, Ferrous):
        group, hardness = row.group.abbreviation, f"{row.hardness:g} {row.group.scale}"
        roots = limit_bending_mpa(choice, row)
    else:
        group, hardness, roots = "bronze", "-", row.bending_mpa
    limits = [f"{limit_contact_mpa(choice):.0f}", f"{roots:.0f}"]
    modulus, density = f"{elastic.youngs_modulus_mpa / 1000.0:g}", f"{elastic.density_kg_m3:g}"
    return [f"`{row.name}`", row.meaning, group, hardness, *limits, modulus, density]


def _groups() -> list[Ferrous]:
    """One row of the table for each class."""
    return list({id(row.group): row for row in ROWS if isinstance(row, Ferrous)}.values())


def _classes() -> Iterator[list[str]]:
    for row in _groups():
        softest, hardest = row.group.hardnesses
        name, scale = f"{row.group.abbreviation}: {row.group.treatment}", row.group.scale
        if _stresses(row, softest) == _stresses(row, hardest):
            yield [name, f"{softest:g} to {hardest:g} {scale}", *_stresses(row, softest)]
        else:
            yield from ([name, f"{hardness:g} {scale}", *_stresses(row, hardness)] for hardness in (softest, hardest))


def _stresses(row: Ferrous, hardness: float) -> list[str]:
    """Of flanks and roots, for each quality."""
    contact, bending = row.group.contact, row.group.bending
    return [f"{contact[one].at(hardness):.0f}, {2.0 * bending[one].at(hardness):.0f}" for one in Quality]


def _lives() -> Iterator[list[str]]:
    for row in _groups():
        group = row.group
        yield [
            f"{group.abbreviation}: {group.treatment}",
            _points(group.contact_life),
            _points(group.bending_life),
        ]


def _points(points: tuple[LifePoint, ...]) -> str:
    return ", ".join(f"{point.cycles:.0e}: {point.factor:g}".replace("e+0", "e").replace("e+", "e") for point in points)


def _plastics() -> Iterator[list[str]]:
    cycles = np.array([1e6, 1e8])
    for row in ROWS:
        if not isinstance(row, Plastic):
            continue
        roots = [_pair(root_limit_mpa(row.root, t, cycles)) if t <= row.hottest_c else "-" for t in TEMPERATURES]
        yield [f"`{row.name}`", row.meaning, "roots", *roots]
        if row.pits:
            flanks = [_pair(flank_limit_mpa(t, cycles)) for t in TEMPERATURES]
            yield ["", "", "flanks", *flanks]


def _pair(stresses: Array) -> str:
    return ", ".join(f"{one:.0f}" for one in stresses)


def _elastic(row: Plastic) -> list[str]:
    modulus, density = f"{row.elastic.youngs_modulus_mpa / 1000.0:g}", f"{row.elastic.density_kg_m3:g}"
    return [f"`{row.name}`", modulus, density, f"{row.hottest_c:g} &deg;C", row.source]


def _coefficients() -> Iterator[list[str]]:
    kinds = {"hardened steel": "16MnCr5", "other steel and iron": "C45", "bronze": "CuSn12"}
    plastics = {f"`{row.name}`": row.name for row in ROWS if isinstance(row, Plastic)}
    for words, name in {**kinds, **plastics}.items():
        yield [words, *(f"{usual_mm3_n_m(TABLE[name], TABLE['16MnCr5'], one):.2g}" for one in LUBRICATIONS)]


def _frictions() -> Iterator[list[str]]:
    for row in ROWS:
        if isinstance(row, Plastic):
            yield [f"`{row.name}` on metal, dry", f"{row.friction:g}"]
    for (first, second), coefficient in PLASTICS_FRICTION.items():
        yield [f"{first} on {second}, dry", f"{coefficient:g}"]
    for lubrication, coefficient in LUBRICATED_FRICTION.items():
        yield [f"any, {lubrication}", f"{coefficient:g}"]
