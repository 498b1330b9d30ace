"""The balance file: mechanisms, gears, rotors and natural frequencies, and the questions about them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ncgear.design.keys.base import (
    FILE_FORMAT,
    LONGEST_MM,
    Faults,
    FileFormat,
    FileName,
    Length,
    Model,
    Place,
    Several,
    Share,
    Speed,
    fault,
    given,
    optional,
    required,
)
from ncgear.design.keys.machine import Linkage
from ncgear.design.keys.masses import HEAVIEST_KG, Mass, Masses
from ncgear.design.words import NAME_PATTERN, listed

MOST_COUNT = 10_000
MOST_ITEMS = 200

Angle = Annotated[float, Field(ge=-3600.0, le=3600.0)]
Amplitude = Annotated[float, Field(ge=0.0, le=1e9)]

HIGHEST_ORDER, HIGHEST_HZ = 1e4, 1e9
"""Far above any machine: products of them stay far from overflow."""

Frequency = Annotated[float, Field(ge=1e-8, le=HIGHEST_HZ)]
Effect = Annotated[float, Field(ge=1e-9, le=1e9)]


class Fixed(Model):
    """A counterweight that the mechanism already has."""

    on: Literal["crank", "rod"] = required("crank or rod")
    mass_kg: Mass = required("its mass in kg")
    arm_mm: Length = required("distance from the crank axis, or on the rod from the crank pin, in mm")
    angle_deg: Angle = optional(
        "direction in degrees counter-clockwise from that to the pin, or on the rod to the slider; left out: opposite",
        180.0,
    )


class Complete(Model):
    """Complete balance by two counterweights, in addition to the existing counterweights."""

    rod_arm_mm: Length = required("arm of the rod's counterweight beyond the crank pin in mm")
    crank_arm_mm: Length = required("arm of the crank's counterweight beyond the axis in mm")


class Partial(Model):
    """Partial balance by a counterweight on the crank, in addition to the existing counterweights."""

    arm_mm: Length = required("arm of the counterweight in mm")
    shares: Annotated[Several[Share], Field(min_length=1, max_length=MOST_ITEMS)] = optional(
        "shares k of the reciprocating mass that are balanced, 0 to 1", (1.0 / 3.0, 0.5)
    )
    rotating_kg: Mass | None = optional("mass at the crank pin in kg; left out: mass of the parts there")
    reciprocating_kg: Mass | None = optional("mass at the slider in kg; left out: mass of the parts there")


class Best(Model):
    """The best counterweight on the crank for the actual motion, in addition to the existing counterweights."""

    arm_mm: Length = required("arm of the counterweight in mm")


class Sweep(Model):
    """Counterweights that are tried one after the other, in addition to the existing counterweights."""

    arm_mm: Length = required("arm of the counterweight in mm")
    angle_deg: Angle = optional("its direction in degrees as above; left out: opposite the pin", 180.0)
    masses_kg: Annotated[Several[Mass], Field(min_length=1, max_length=MOST_ITEMS)] = required("masses in kg")


class Mechanism(Model):
    """A crank-slider in the frame."""

    RULES = ("one of linkage design",)

    name: str = required("its name", min_length=1, max_length=100)
    linkage: Linkage | None = optional("its linkage, with a crank that turns evenly")
    design: str | None = optional(
        "a design file instead, whose linkage and law are taken; its path counts from this file", min_length=1
    )
    masses: Masses | None = optional("its masses; left out: masses of the design file")
    counterweights: Annotated[Several[Fixed], Field(max_length=MOST_ITEMS)] = optional(
        "counterweights that the mechanism already has, a list; complete, partial, best and sweep add to them", ()
    )
    direction_deg: Angle = optional("direction of the slider's way out in the frame in degrees", 0.0)
    phase_deg: Angle = optional("driving angle in degrees by which it is ahead of the shaft", 0.0)
    mirrored: bool = optional("true: its crank turns counter-clockwise", False)
    x_mm: Place = optional("place of its crank axis in the frame in mm", 0.0)
    y_mm: Place = optional("place of its crank axis in the frame in mm", 0.0)
    complete: Complete | None = optional(
        "what would balance its forces completely, beside the counterweights that it has"
    )
    partial: Partial | None = optional("what would balance them in part, beside the counterweights that it has")
    best: Best | None = optional("the counterweight that leaves least, beside those that it has")
    sweep: Sweep | None = optional("counterweights to try, beside those that it has")

    def _faults(self) -> Faults:
        if self.linkage is not None and self.linkage.crank_mm is None:
            yield fault("linkage.crank_mm", "missing; give the length of the crank in mm")
        if self.linkage is not None and self.masses is None:
            yield fault("masses", "missing; a linkage given here needs slider_kg, rod and crank")
        if self.masses and not self.masses.slider_kg + self.masses.rod.mass_kg + self.masses.crank.mass_kg > 0.0:
            yield fault("masses", "nothing has a mass; give the slider, the rod or the crank a mass")


class Chassis(Model):
    """Counterweight at the tail of a chassis on two supports."""

    mechanism: str = required("name of the mechanism whose inertia force it is to hold")
    support_mm: Length = required("distance of either support from the centre of gravity in mm")
    counterweight_mm: Length = required("distance of the counterweight from the centre of gravity in mm")
    tilt_deg: float = required("slope of the slider's line against the ground in degrees", gt=0.0, le=90.0)
    slider_kg: Mass = optional("weight of the slider on the support in kg", 0.0)
    weight_kg: Mass = optional("dead weight in front of the supports in kg", 0.0)
    weight_lever_mm: float = optional("its lever in mm", 0.0, ge=0.0, le=LONGEST_MM)


class Shaft(Model):
    """A shaft that may shake the machine."""

    name: str = required("its name", min_length=1, max_length=100)
    speed_rpm: Speed = required("its speed in r/min")
    rollers: int | None = optional("rolling elements of its bearing", ge=1, le=MOST_COUNT)
    roller_ratio: Annotated[float, Field(gt=0.0, lt=1.0)] | None = optional(
        "diameter of a rolling element by that of the pitch circle, times the cosine of the contact angle; left out: "
        "as many passes as rolling elements in each turn"
    )
    teeth: int | None = optional("teeth of its sprocket or gear", ge=1, le=MOST_COUNT)


class Engine(Model):
    """A reciprocating engine."""

    name: str = optional("its name", "engine", min_length=1, max_length=100)
    speed_rpm: Speed = required("its speed in r/min")
    cylinders: int = required("number of cylinders", ge=1, le=100)
    strokes: int = optional("strokes of a cycle, 2 or 4", 4, ge=2, le=4)
    inertia_order: float = optional("order of its strongest free inertia force", 2.0, ge=0.001, le=HIGHEST_ORDER)


class Excitations(Model):
    """Frequencies that shake the machine, compared with its natural frequencies."""

    natural_hz: Several[Frequency] = required("natural frequencies in Hz", min_length=1, max_length=MOST_ITEMS)
    band: float = optional("share of a natural frequency within which an excitation is near it", 0.2, gt=0.0, lt=1.0)
    shafts: Annotated[Several[Shaft], Field(max_length=MOST_ITEMS)] = optional("shafts, a list", ())
    engines: Annotated[Several[Engine], Field(max_length=MOST_ITEMS)] = optional("engines, a list", ())
    harmonics: int = optional("harmonics of the slider's acceleration of each mechanism", 0, ge=0, le=1000)

    def _faults(self) -> Faults:
        if not self.shafts and not self.engines and not self.harmonics:
            yield fault("", "nothing shakes; give shafts, engines or harmonics")


class Holes(Model):
    """Through holes that may be drilled."""

    RULES = ("smallest_mm <= largest_mm",)

    largest_mm: Length = required("diameter of the largest in mm")
    smallest_mm: Length = required("diameter of the smallest in mm")
    wall_mm: Length = required("least wall between holes and to every edge in mm")


class Boss(Model):
    """A boss on the upper face."""

    height_mm: Length = required("its height over the face in mm")
    wall_mm: Length = required("its distance from every edge in mm")


class Correction(Model):
    """Means to correct a gear: holes first, a boss for the rest."""

    holes: Holes | None = optional("through holes; left out: none")
    boss: Boss | None = optional("a boss; left out: none")


class GearBalance(Model):
    """Balance of the gears of a design."""

    design: str = required("the design file; its path counts from this file", min_length=1)
    density_kg_m3: float = optional("density of both gears in kg/m3", 7850.0, gt=0.0, le=30000.0)
    grade: float = optional("grade of balance quality of ISO 21940-11 in mm/s: 6.3 for G 6.3", 6.3, gt=0.0, le=4000.0)
    driving: Correction | None = optional("correction of the driving gear; left out: none")
    driven: Correction | None = optional("correction of the driven gear; left out: none")


class Reading(Model):
    """The reading of an instrument."""

    amplitude: Amplitude = required("amplitude, in the same unit for all")
    phase_deg: Angle = required("phase in degrees, as the instrument counts it")


Readings = Annotated[Several[Reading], Field(min_length=1, max_length=MOST_ITEMS)]


class Trial(Model):
    """A run with a trial weight in one plane; the weight is taken off again afterwards."""

    mass_g: float = required("mass of the trial weight in g", ge=0.0, le=1e9)
    angle_deg: Angle = required("its angle in degrees, counted as the instrument counts phases")
    readings: Readings = required("what every sensor shows, a list")


class Rotor(Model):
    """Field balancing from trial weights."""

    RULES = ("mass_kg with radius_mm",)

    speed_rpm: Speed = required("speed of the runs in r/min")
    first: Readings | None = optional("readings of every sensor without trial weights, a list")
    trials: Several[Trial] | None = optional("one run for each plane, a list", min_length=1, max_length=20)
    file: FileName | None = optional(
        "CSV file of both instead, one reading in each row, with columns plane (0: without trial weight), mass_g, "
        "angle_deg, sensor, amplitude, phase_deg; its path counts from this file"
    )
    mass_kg: float | None = optional(
        "mass of the rotor in kg; left out: the permissible unbalance is not told", gt=0.0, le=HEAVIEST_KG
    )
    radius_mm: Length | None = optional("radius of the weights in mm, with mass_kg")
    grade: float = optional("grade of balance quality of ISO 21940-11 in mm/s: 16 for G 16", 16.0, gt=0.0, le=4000.0)

    def _faults(self) -> Faults:
        for key in ("first", "trials"):
            if getattr(self, key) is None:
                yield fault(key, "missing; give first and trials, or a file of them")


class ChainRun(Model):
    """A run with the weight at one phase."""

    weight_deg: Angle = required("phase of the weight in degrees")
    amplitude: Amplitude = required("amplitude of the reading")
    phase_deg: Angle = required("phase of the reading in degrees")


class ChainDrive(Model):
    """Equivalent unbalance of a chain drive from runs with one weight at several phases."""

    wrap_deg: Angle = required("phase of the middle of the chain's wrap in degrees")
    tight_deg: Angle = required("phase of the tight side's equivalent unbalance in degrees")
    slack_deg: Angle = required("phase of the slack side's equivalent unbalance in degrees")
    runs: Annotated[Several[ChainRun], Field(min_length=3, max_length=1000)] | None = optional("runs, a list")
    file: FileName | None = optional(
        "CSV file of runs instead, with columns weight_deg, amplitude, phase_deg; its path counts from this file"
    )
    predict_deg: Annotated[Several[Angle], Field(max_length=MOST_ITEMS)] = optional(
        "phases of the weight in degrees for which readings are predicted", ()
    )
    effect_per_g: Effect | None = optional("amplitude per g of a weight, for corrections; left out: none")

    def _faults(self) -> Faults:
        if self.runs is None:
            yield fault("runs", "missing; give runs, or a file of them")


QUESTIONS = ("excitations", "gears", "rotor", "chain_drive")


class Balance(Model):
    """A balance file: the person's values, and nothing computed."""

    name: str = required("name of the file's subject and of its output folder", pattern=NAME_PATTERN)
    description: str = optional("free text", "", max_length=10_000)
    format: FileFormat = optional(FILE_FORMAT, 1)
    speed_rpm: Speed | None = optional("speed in r/min of the shaft that drives the mechanisms and the gears")
    mechanisms: Annotated[Several[Mechanism], Field(max_length=50)] = optional("crank-sliders on one frame, a list", ())
    move_phase_of: str | None = optional("name of the mechanism whose best phase is looked for; left out: none")
    chassis: Chassis | None = optional("counterweight at the tail of a chassis")
    excitations: Excitations | None = optional(
        "frequencies that shake the machine, compared with its natural frequencies"
    )
    gears: GearBalance | None = optional("balance of a design's gears")
    rotor: Rotor | None = optional("field balancing from trial weights")
    chain_drive: ChainDrive | None = optional("equivalent unbalance of a chain drive")

    def _asks_something(self) -> Faults:
        if not self.mechanisms and not given(self, QUESTIONS):
            yield fault("", f"nothing is asked; give mechanisms, {listed(QUESTIONS)}")
        if self.excitations and self.excitations.harmonics and not self.mechanisms:
            yield fault("excitations.harmonics", "given, but no mechanism, whose slider has harmonics; give mechanisms")
        if self.speed_rpm is None and (self.mechanisms or self.gears):
            yield fault("speed_rpm", "missing; mechanisms and gears need the speed of their shaft in r/min")

    def _names_are_known_and_differ(self) -> Faults:
        names = [mechanism.name for mechanism in self.mechanisms]
        for number, name in enumerate(names):
            if name in names[:number]:
                yield fault(
                    f"mechanisms.{number}.name", f"{name!r} is the name of an earlier mechanism; choose another name"
                )
        asked = {"move_phase_of": self.move_phase_of}
        asked["chassis.mechanism"] = self.chassis.mechanism if self.chassis else None
        for key, asked_name in asked.items():
            if asked_name is not None and asked_name not in names:
                yield fault(key, f"{asked_name!r} is no mechanism of this file; {listed(names) or 'none'} is right")
        if self.move_phase_of is not None and len(names) < 2:
            yield fault("move_phase_of", "a single mechanism has no best phase; give a second one, or leave it out")
