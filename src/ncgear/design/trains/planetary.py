"""The train ``planetary``: a sun, idlers and planets on a carrier, with an arm on each planet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from math import cos, degrees, pi, radians
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field

from ncgear.design.keys.base import Faults, Length, Model, Several, fault, optional, required
from ncgear.design.trains.base import RatedGears, RatedTrain, with_sound_bodies
from ncgear.design.trains.tip_path import TipPathKeys
from ncgear.errors import NoSuchMechanism, WrongInput, below, renamed
from ncgear.numerics.units import RAD_S_PER_RPM, STANDARD_GRAVITY_M_S2

if TYPE_CHECKING:
    from ncgear.numerics.arrays import Array
    from ncgear.pitch.pair import PitchPair
    from ncgear.ratio.laws.shared_idler import SharedIdler
    from ncgear.ratio.transmission import Transmission
    from ncgear.teeth.gear import ToothedPair
    from ncgear.trains.loads import PutMass
    from ncgear.trains.planetary import ArmChain, OfAngle
    from ncgear.trains.tip_path import TipMotion, WishedPath
    from ncgear.trains.train import Train

Ratio = Annotated[float, Field(gt=0.0, le=100.0)]


class TrainMasses(Model):
    """Masses of the parts of a train."""

    density_kg_m3: Annotated[float, Field(gt=0.0, le=25_000.0)] = required(
        "density of all parts in kg/m3, as 7850 of steel"
    )
    tool_kg: Annotated[float, Field(ge=0.0, le=1000.0)] = optional("mass at the tip of each arm in kg", 0.0)
    gravity_m_s2: Annotated[float, Field(ge=0.0, le=1000.0)] = optional(
        "acceleration of gravity in m/s2, against y", STANDARD_GRAVITY_M_S2
    )

    @property
    def gravity(self) -> complex:
        """Gravity in mm/s2 as a complex number."""
        return -1j * MM_PER_M * self.gravity_m_s2


class PlanetaryGears(RatedGears):
    """The teeth and the bodies of sun, idlers and planets."""

    teeth: int = required("teeth of every gear, a whole number; a ring has planet_turns times as many", ge=8, le=1000)
    rim_mm: Length | None = optional("of a ring: thickness in mm outside its farthest root")
    center_distance_mm: Length | None = optional("distance of the axes of each pair in mm, in place of module_mm")


class Planetary(RatedTrain):
    """Gears on a carrier."""

    KIND = "planetary"
    MEANING = "a sun, idlers and planets on a carrier, with an arm on each planet"
    TURNS_ALONE = False
    RULES = (
        "one of ratio path",
        "at most one of path arm_mm",
        "at most one of gears.module_mm gears.center_distance_mm",
        "at most one of resistance masses",
        "at most one of carrier_ratio path.pace",
    )
    WRITTEN_AS: ClassVar[dict[str, str]] = {
        "operation.speed_rpm": "speed_rpm",
        "motion": "ratio",
        "motion.ratio": "ratio",
        "gears.idlers": "idler",
        "gears.idlers.bends_deg": "bend_deg",
        "gears.driving.bore_mm": "gears.bore_mm",
        "gears.driven.bore_mm": "gears.bore_mm",
        "output.chord_tolerance_mm": "gears.chord_tolerance_mm",
        "resistance": "masses",
    }

    arms: int = optional("arms of the carrier, evenly spread, a whole number", 1, ge=1, le=6)
    idler: Literal["compound", "shared", "ring"] = optional(
        "compound: two gears on one shaft, which make any ratio; shared: one gear that meshes with sun and planet; "
        "ring: none, the planet is inside a ring in place of the sun",
        "compound",
    )
    planet_turns: int | None = optional(
        "of a ring: turns of the planet for one of the carrier against the ring, a whole number", ge=2, le=24
    )
    bend_deg: Annotated[float, Field(ge=-150.0, le=150.0)] | None = optional(
        "of a shared idler: angle in degrees from the line from sun to idler to the line from idler to planet; "
        "left out: straight, and with a path 42.492 to the side on which teeth have less pressure angle"
    )
    ratio: Annotated[Several[Ratio], Field(min_length=4, max_length=720)] | None = optional(
        "speed of the carrier against the sun over the speed of the planet (compound) or idler (shared), at evenly "
        "spaced angles of planet or idler, from 0 on; of a ring the speed of the planet over the carrier's, at evenly "
        "spaced angles of the carrier over a turn of the planet; a common factor closes the turn"
    )
    carrier_ratio: Annotated[Several[Ratio], Field(min_length=4, max_length=720)] | None = optional(
        "speed of the driving shaft over that of the carrier, at evenly spaced turns of the carrier, from 0 on; a "
        "common factor closes the turn; left out: the carrier turns evenly, or as path.pace asks"
    )
    path: TipPathKeys | None = optional("path of the arm's tip, in place of ratio: arm, carrier and ratio are found")
    arm_mm: Length | None = optional("length of the arm on each planet in mm; left out: no arm, or the path's arm")
    arm_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = optional(
        "angle of the arm from the carrier's line where the carrier stands at 0, in degrees", 0.0
    )
    sun_turns: Annotated[float, Field(gt=-10.0, lt=0.9)] = optional(
        "turns of the sun for one of the carrier; left out: the sun stands", 0.0
    )
    bar_width_mm: Length = optional("width of carrier and arms in mm", 20.0)
    masses: TrainMasses | None = optional(
        "what parts weigh, for the torque of the carrier and the forces on the frame; left out: not judged"
    )
    gears: PlanetaryGears = required("the teeth and bodies of all gears")

    def _a_shared_idler_is_bent(self) -> Faults:
        if self.bend_deg is not None and self.idler != "shared":
            yield fault("bend_deg", "given, but the place of a compound idler follows from its teeth; leave it out")

    def _a_ring_has_its_keys(self) -> Faults:
        for key, value in (("planet_turns", self.planet_turns), ("gears.rim_mm", self.gears.rim_mm)):
            if (value is None) is (self.idler == "ring"):
                yield fault(key, "missing; a ring needs it" if value is None else "given, but there is no ring")

    def _rated_keys_count(self) -> Faults:
        if "mates" in self.strength.model_fields_set:
            yield fault("strength.mates", "given, but it follows from arms; leave it out")
        if self.idler == "ring":
            for key, given in (
                ("resistance", self.resistance is not None),
                ("strength", "strength" in self.model_fields_set),
                ("tolerances", self.tolerances is not None),
                ("gears.material", self.gears.material is not None),
            ):
                if given:
                    why = "in a ring the planet drives, at an uneven speed, so its teeth are not rated"
                    yield fault(key, f"given, but {why}; leave it out")

    def _masses_come_back(self) -> Faults:
        from ncgear.trains.planetary import MOST_TURNS, whole_turns

        if self.masses is not None and whole_turns(self.sun_turns) is None:
            near = Fraction(self.sun_turns).limit_denominator(MOST_TURNS)
            yield fault(
                "sun_turns",
                f"{self.sun_turns:.10g} given, but with masses the sun must have made whole turns within {MOST_TURNS} "
                f"turns of the carrier: {float(near):.10g}, which is {near}, is right",
            )
        if self.masses is not None and self.masses.tool_kg and self.arm_mm is None and self.path is None:
            yield fault("masses.tool_kg", "given, but there is no arm that carries it; give arm_mm, or leave it out")

    def _a_cycle_is_a_turn(self) -> Faults:
        if self.carrier_ratio is not None and self.sun_turns != 0.0:
            yield fault("carrier_ratio", "given, but its turn is the cycle of a sun that stands; leave out one of both")

    def _a_path_has_its_gears(self) -> Faults:
        if self.path is None:
            if self.gears.module_mm is None and self.gears.center_distance_mm is None:
                yield fault("gears", "module_mm or center_distance_mm is missing; give one of them")
            return
        if self.idler == "ring":
            why = "a planet in a ring turns several times a cycle, and an arm along a path once"
            yield fault("idler", f"ring given, but {why}; compound or shared is right")
        for key in ("center_distance_mm", *["module_mm"] * (self.idler == "shared")):
            if getattr(self.gears, key) is not None:
                yield fault(f"gears.{key}", "given, but it follows from the path; leave it out")
        if self.sun_turns != 0.0:
            yield fault("sun_turns", "given, but the path is that of an arm about a sun that stands; leave it out")

    @property
    def alone(self) -> tuple[str, ...]:
        """A path finds another arm and ratio for other teeth; larger gears with masses are another load."""
        always = "gears.material.", "gears.backlash_mm.", "strength.", "tolerances."
        if self.path is not None:
            return always if self.masses is not None else (*always, "gears.face_width_mm.")
        return super().alone if self.masses is None else (*always, "gears.rack.")

    @classmethod
    def is_machine(cls, given: Mapping[str, Any]) -> bool:
        """Whether there is no ring, in which it is the planet that drives."""
        return given.get("idler") != "ring"

    def machine(self) -> dict[str, Any] | None:
        """The gears of one arm on fixed axes, as the carrier sees them: two pairs in series, or a row of three gears.

        None for a ring (``is_machine``).

        Where masses are given, they and the weight of all that the planet carries turn about its axis as Newton and
        Euler say; what is no moment of inertia there is a torque over the planet's angle.
        """
        if self.idler == "ring":
            return None
        if self.masses is not None and self.sun_turns != 0.0:
            problem = "given, but about a sun that turns the loads of teeth by masses change from turn to turn"
            raise WrongInput(f"{problem}; resistance, or a sun that stands, is right", key="train.masses")
        path = self._sought()
        made = with_sound_bodies(self._train(*path))
        given = self.model_dump(by_alias=True, exclude_unset=True)
        motion: dict[str, Any] = {"law": "spline_ratio", "ratio": self._ratio(path[0]).tolist()}
        kept = ("teeth", "module_mm", "center_distance_mm", "face_width_mm", "rack", "backlash_mm", "material")
        gears = {key: given["gears"][key] for key in kept if key in given["gears"]}
        if self.idler == "shared" and path[0] is not None:
            idler, pitch, bend_rad = self._led(path[0])
            series = idler.series
            motion = {"law": "harmonic_ratio", "cosine": series.cosine.tolist(), "sine": series.sine.tolist()}
            gears |= {"center_distance_mm": float(pitch.center_distance_mm)}
            gears |= {"idlers": {"lobes": [1], "bends_deg": [-degrees(bend_rad)]}}
        elif self.idler == "shared":
            bends = {"bends_deg": [-self.bend_deg]} if self.bend_deg else {}
            gears["idlers"] = {"lobes": [1], **bends}
        else:
            motion["second_stage"] = {"ratio": [coefficient**0.5 for coefficient in motion["ratio"]]}
            if path[0] is not None and self.gears.module_mm is None:
                raise WrongInput(
                    "missing, so each mesh has its own module; both have one where commands rate them: give it, in the "
                    "next larger size",
                    key="train.gears.module_mm",
                )
        body = {"bore_mm": self.gears.bore_mm} if self.gears.bore_mm else {}
        return {
            "operation": {"speed_rpm": self.speed_rpm * (1.0 - self.sun_turns)},
            "motion": motion,
            "gears": gears | {"driving": body, "driven": body},
            "output": {"chord_tolerance_mm": made.tolerance_mm},
            **{key: given[key] for key in ("resistance", "tolerances") if given.get(key) is not None},
            "strength": given.get("strength", {}) | {"mates": self.arms},
            **({} if self.masses is None else self._turning(made, self.masses)),
        }

    def _turning(self, made: Train, masses: TrainMasses) -> dict[str, Any]:
        """The load of the first planet as keys of a machine, with what its idler bears beside an inertia of its own."""
        from ncgear.trains.loads import turning_load

        end = "_1" if self.arms > 1 else ""
        put = masses.density_kg_m3, self._tools(made, masses), masses.gravity
        sun, idler, planet = (turning_load(made, name, *put) for name in ("sun", f"idler{end}", f"planet{end}"))
        torque, inertia = planet.torque_n_m + idler.torque_n_m * idler.rate / planet.rate, {}
        if self.idler == "compound":
            torque -= planet.even_n_m + idler.even_n_m * idler.rate / planet.rate
            moments = sun.kg_mm2, idler.kg_mm2, planet.kg_mm2, 0.0
            names = "driving_gear_kg_mm2", "shaft_between_kg_mm2", "driven_gear_kg_mm2", "shaft_kg_mm2"
            inertia = {"masses": dict(zip(names, moments, strict=True))}
        angles = [degrees(angle) for angle in planet.turned_rad[::TAKEN]]
        table = {"angle_deg": [0.0, *angles[1:-1], 360.0], "torque_n_m": torque[::TAKEN].tolist()}
        return {"resistance": {"table": table, "where_negative": "keep"}, **inertia}

    def _made(self) -> Train:
        return self._train(*self._sought())

    def _sought(self) -> tuple[TipMotion | None, WishedPath | None]:
        """The motion of a path and the path; None each where the ratio is given."""
        if self.path is None:
            return None, None
        with below("train"):
            wished = self.path.wished()
            return self._motion(self.path, wished), wished

    def _train(self, motion: TipMotion | None, wished: WishedPath | None) -> Train:
        """The train of the keys; raises NoSuchMechanism if no such gears exist."""
        from ncgear.solids.plan.room import INNER_WALL_IN_MODULES
        from ncgear.trains.loads import joint_forces, loads_of
        from ncgear.trains.planetary import Arm, Bodies, Stand, arm_of, planetary_train, stand_of
        from ncgear.trains.planetary_told import told_of

        with renamed("train.motion", "train.ratio" if self.path is None else "train.path"):
            pitches, chain = self._chain(motion)
        arm, stand = None, Stand()
        if motion is not None and wished is not None:
            arm, stand = arm_of(motion, wished), stand_of(motion)
        elif self.arm_mm is not None:
            arm = Arm(self.arm_mm, radians(self.arm_deg))
        pace = self._pace(motion, wished)
        wall_mm = INNER_WALL_IN_MODULES * max(pitch.size.module_mm for pitch in pitches)
        sizes = self.gears.face_width_mm, self.gears.bore_mm, self.bar_width_mm, self.gears.rim_mm
        bodies = Bodies(*sizes, wall_mm)
        chord_mm = max(self.gears.chord_mm(pitch.size.module_mm) for pitch in pitches)
        turned = _carrier_rad(pace)
        made = planetary_train(chain, arm, self.arms, bodies, self.speed_rpm, chord_mm, self.sun_turns, stand, turned)
        forward_mm_s = 0.0 if self.path is None else self.path.forward_mm_s
        masses, loads, rack_rad = self.masses, None, self.gears.pressure_angle_rad
        if masses is not None:
            weights = masses.density_kg_m3, self._tools(made, masses), masses.gravity
            loads = loads_of(made, *weights), joint_forces(made, rack_rad, *weights)
        told = told_of(made, self.idler, pitches, rack_rad, wished, motion, forward_mm_s, loads, pace)
        return replace(made, told=told)

    def _pace(self, motion: TipMotion | None, wished: WishedPath | None) -> Array | None:
        """Speeds of the driving shaft over those of the carrier at even turns of it, or None where both are alike."""
        import numpy as np

        from ncgear.trains.pace import carrier_pace

        if self.path is None or motion is None or wished is None or not self.path.pace:
            return None if self.carrier_ratio is None else np.array(self.carrier_ratio)
        with below("train"):
            speed = self.speed_rpm * RAD_S_PER_RPM
            return carrier_pace(motion, wished, self.path.stretches(wished), self.arms, speed)

    @staticmethod
    def _tools(made: Train, masses: TrainMasses) -> list[PutMass]:
        from ncgear.trains.loads import PutMass

        return [PutMass(trace.part, complex(*trace.at_mm), masses.tool_kg) for trace in made.traces if masses.tool_kg]

    def _motion(self, path: TipPathKeys, wished: WishedPath) -> TipMotion:
        from ncgear.trains.path_search import PathLimits, found_motion

        tangent = radians(path.pressure_angle_deg) - self.gears.pressure_angle_rad
        if tangent <= 0.0:
            rack = degrees(self.gears.pressure_angle_rad)
            raise WrongInput(
                f"{path.pressure_angle_deg:g} deg given, but the rack alone has {rack:g}; more is right",
                key="path.pressure_angle_deg",
            )
        apart_mm = self.bar_width_mm + ROOM_MM
        limits = PathLimits(tangent, self.gears.teeth, path.longest_mm, self.arms, apart_mm)
        if path.axis_from_mm is not None and path.axis_to_mm is not None:
            limits = replace(limits, low=complex(*path.axis_from_mm), high=complex(*path.axis_to_mm))
        return found_motion(wished, limits, None if path.axis_mm is None else complex(*path.axis_mm))

    def _ratio(self, motion: TipMotion | None) -> Array:
        """The ratio at even angles of planet or idler, shape (n,)."""
        import numpy as np

        return np.array(self.ratio) if motion is None else motion.ratio(RATIOS)[1]

    def _chain(self, motion: TipMotion | None) -> tuple[tuple[PitchPair, ...], ArmChain]:
        """The pitch curves of each pair, and the chain with its teeth."""
        import numpy as np

        from ncgear.ratio.laws.spline import even_steps, spline_ratio_law, spline_ratio_staged
        from ncgear.ratio.transmission import Lobes
        from ncgear.trains.planetary import compound_chain, ring_chain, shared_chain, straight_distances_mm

        ratio = self._ratio(motion)
        angles, gears = even_steps(ratio.size), self.gears
        if self.planet_turns is not None:
            law = spline_ratio_law(angles, ratio, Lobes(1, self.planet_turns))
            pitch = self._pitch(law, gears.center_distance_mm, ring=True)
            return (pitch,), ring_chain(pitch, self._teeth(pitch))
        if self.idler == "shared":
            if motion is None:
                law = spline_ratio_law(angles, ratio, Lobes())
                pitch, bend_rad = self._pitch(law, gears.center_distance_mm), radians(self.bend_deg or 0.0)
            else:
                _, pitch, bend_rad = self._led(motion)
            return (pitch,), shared_chain(pitch, self._teeth(pitch), bend_rad)
        laws = [pair.transmission for pair in spline_ratio_staged(angles, ratio, np.sqrt(ratio)).train.pairs]
        distances = [gears.center_distance_mm] * 2
        if motion is not None and gears.module_mm is None:
            distances = list(straight_distances_mm(laws, motion.carrier_mm))
        first, second = (self._pitch(law, distance) for law, distance in zip(laws, distances, strict=True))
        carrier_mm = first.center_distance_mm + second.center_distance_mm if motion is None else motion.carrier_mm
        return (first, second), compound_chain((first, second), (self._teeth(first), self._teeth(second)), carrier_mm)

    def _led(self, motion: TipMotion) -> tuple[SharedIdler, PitchPair, float]:
        """The idler that leads the tip along a path, sun and idler, and the bend in rad: of two that of less pressure.

        Raises NoSuchMechanism where no idler makes the path's law, or with more pressure angle than its limit.
        """
        from ncgear.ratio.laws.shared_idler import GOLDEN_RAD, shared_by_idler

        bends = [pi - GOLDEN_RAD, GOLDEN_RAD - pi] if self.bend_deg is None else [radians(self.bend_deg)]
        found: list[tuple[float, SharedIdler, PitchPair, float]] = []
        refusals: list[NoSuchMechanism] = []
        for bend_rad in bends:
            try:
                idler = shared_by_idler(motion.law, pi - bend_rad, "train.bend_deg")
            except NoSuchMechanism as refused:
                refusals.append(refused)
                continue
            pitch = self._pitch(idler.first, motion.carrier_mm / (2.0 * cos(bend_rad / 2.0)))
            found.append((pitch.largest_pressure_angle_deg(self.gears.pressure_angle_rad), idler, pitch, bend_rad))
        if not found:
            raise refusals[0]
        pressure, idler, pitch, bend_rad = min(found, key=lambda each: each[0])
        if self.path is not None and pressure > self.path.pressure_angle_deg:
            raise NoSuchMechanism(
                f"the gears of a shared idler have a pressure angle of {pressure:.4g} deg, and "
                f"{self.path.pressure_angle_deg:g} is the most; a compound idler is right, or a larger tolerance",
                key="train.path.pressure_angle_deg",
            )
        return idler, pitch, bend_rad

    def _pitch(self, transmission: Transmission, distance_mm: float | None, *, ring: bool = False) -> PitchPair:
        from ncgear.pitch.pair import sized_pair
        from ncgear.pitch.shape import Mesh

        mesh = Mesh.INTERNAL if ring else Mesh.EXTERNAL
        with below("train"):
            return sized_pair(transmission, self.gears.teeth, self.gears.module_mm, distance_mm, mesh)

    def _teeth(self, pitch: PitchPair) -> ToothedPair:
        from ncgear.teeth.gear import toothed_pair

        module_mm = pitch.size.module_mm
        chord_mm = self.gears.chord_mm(module_mm)
        with below("train"):
            return toothed_pair(pitch, self.gears.form(module_mm), chord_mm)


def _carrier_rad(pace: Array | None) -> OfAngle:
    """The carrier's turn by that of the driving shaft; an even one without a pace."""
    if pace is None:
        return lambda driving: driving
    from ncgear.ratio.laws.spline import even_steps, spline_ratio_law
    from ncgear.ratio.transmission import Lobes

    with renamed("motion.ratio", "train.carrier_ratio"):
        law = spline_ratio_law(even_steps(pace.size), pace, Lobes())
    return lambda driving: law.driven_angle(driving).value


MM_PER_M = 1000.0

ROOM_MM = 2.0
"""Least distance in mm between two arms in the search."""

TAKEN = 2
"""Every second of the computed loads makes the table of a machine, which may have 1000 rows."""

RATIOS = 120
"""Number of ratios in the law of a path: five for each wave of the highest harmonic, which are exact to 1e-6."""
