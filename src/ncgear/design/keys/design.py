"""The whole design file as one model, and the JSON Schema of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache, reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, Union

from pydantic import Field, PrivateAttr, TypeAdapter, create_model

from ncgear.design.keys.base import FILE_FORMAT, Faults, FileFormat, Model, counts, fault, given, optional, required
from ncgear.design.keys.drivetrain import Drivetrain, NamedShaft, bodies_on, named_shafts, shaft_faults
from ncgear.design.keys.gear_rows import row_faults
from ncgear.design.keys.gears import SIZES, Gears
from ncgear.design.keys.machine import Comparison, Fit, Linkage, NoLinkage, Operation, Output, Resistance
from ncgear.design.keys.masses import Masses, Simulation, shafts_counted
from ncgear.design.keys.optimize import Choices, FlywheelRange, FollowedOutline, Lengths, Optimize, Range
from ncgear.design.keys.strength import StrengthKeys
from ncgear.design.keys.tolerances import AssemblyTolerances
from ncgear.design.laws.base import LawKeys
from ncgear.design.laws.registry import law_models
from ncgear.design.mechanisms import MECHANISMS, NO_LINKAGE, entry_of, kind_named
from ncgear.design.reading.text import quoted
from ncgear.design.trains.registry import TrainFile, train_models
from ncgear.design.wishes.registry import Wishes
from ncgear.design.words import COUNTS, LONGEST_DESCRIPTION, NAME_PATTERN, listed
from ncgear.errors import WrongInput
from ncgear.shown import Shown

JSON_SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"

if TYPE_CHECKING:
    Motion = LawKeys
else:
    # This union is made at run time, so that only the registry lists the laws; type checkers cannot follow it.
    Motion = Annotated[
        Union[tuple(law_models().values())],  # noqa: UP007
        Field(
            discriminator="law", description="how the slider moves, or how the ratio runs; `law` says which law it is"
        ),
    ]


class Design(Model, Shown):
    """A design file: the person's values, and nothing computed."""

    RULES = (
        "drivetrain.driving_shaft.diameter_mm <= gears.driving.bore_mm",
        "drivetrain.driven_shaft.diameter_mm <= gears.driven.bore_mm",
        "fit needs gears",
        "choices needs gears",
        "drivetrain needs gears",
        "drivetrain needs masses",
        "at most one of simulation.motor drivetrain.motor.no_load_speed_rpm",
    )

    name: str = required("name of the design and of its output folder", pattern=NAME_PATTERN)
    description: str = optional("free text", "", max_length=LONGEST_DESCRIPTION)
    format: FileFormat = optional(FILE_FORMAT, 1)
    linkage: Linkage = required("the mechanism that the driven gear turns; left out: gears by themselves")
    operation: Operation = required("how the machine is run")
    motion: Motion
    gears: Gears | None = optional("the pair of gears; a check does without, a build needs it")
    resistance: Resistance | None = optional("the force or torque against the output; left out: none")
    wishes: Wishes = optional(
        "wishes for the motion: a check tells which of them it keeps, ncgear optimize looks for a law that keeps them",
        Wishes,
    )
    masses: Masses | None = optional(
        "masses of the moving parts: all power counts them, ncgear simulate needs them; left out: none"
    )
    simulation: Simulation = optional(
        "how the teeth bear load in ncgear simulate; left out: as in the published baler's simulation", Simulation
    )
    fit: Fit | None = optional(
        "parts that stand or move beside the gears: a build tells whether rods pass them; left out: not known"
    )
    strength: StrengthKeys = optional(
        "running conditions and safeties of the teeth; left out: 20 000 h in oil", StrengthKeys
    )
    tolerances: AssemblyTolerances | None = optional(
        "permissible deviations of gears and assembly, for ncgear tolerance and for the load along the face width; "
        "left out: grade 8 and more, which its answer tells"
    )
    drivetrain: Drivetrain | None = optional(
        "bearings, shafts, motor and more around the gears, which ncgear simulate judges; left out: none"
    )
    comparison: Comparison | None = optional("published mechanisms to compare with")
    optimize: Optimize | None = optional("what ncgear optimize looks for; check and build take no notice")
    choices: Choices | None = optional(
        "what ncgear design may choose of a whole machine, and what counts; check and build take no notice"
    )
    outline: FollowedOutline | None = optional("how ncgear fit follows a drawn outline; check and build take no notice")
    output: Output = optional("how finely the results are written", Output)

    _of_train: frozenset[str] | None = PrivateAttr(default=None)

    def of_train(self, keys: Iterable[str]) -> Self:
        """The design as the machine of a train, whose file has only ``keys``, and has them below ``train``."""
        made = self.model_copy()
        made._of_train = frozenset(keys)
        return made

    def key_in_file(self, key: str) -> str | None:
        """The key by which the file changes a key of the design and nothing else; None where it has none."""
        if self._of_train is None:
            return key
        return f"train.{key}" if key in self._of_train else None

    def __reduce_ex__(self, protocol: Any) -> Any:
        """Pickle a model that was made for a mechanism by its data, because pickle cannot find its class by name."""
        return _restored, (self.model_dump(by_alias=True, exclude_unset=True),)

    @property
    def stages(self) -> int:
        """Number of pairs of gears in series that make the ratio."""
        gears = self.gears
        if gears and gears.idlers:
            return 1 + len(gears.idlers.lobes)
        return gears.pairs if gears and gears.pairs > 1 else self.motion.pairs_in_series

    @property
    def stages_said(self) -> tuple[str, str]:
        """Several pairs in words, as ``two pairs of gears``, and the key that asks for them."""
        gears = self.gears
        given = gears and ("gears.idlers" if gears.idlers else "gears.pairs" if gears.pairs > 1 else "")
        key = given or f"motion.{self.motion.pairs_key}"
        return f"{COUNTS[self.stages]} pairs of gears", key

    @property
    def shafts(self) -> list[NamedShaft]:
        """The shafts of all gears, from the driving shaft on."""
        return named_shafts(self.drivetrain, self.stages)

    def gears_on(self, number: int) -> tuple[str, ...]:
        """The keys below ``gears`` of the bodies on a shaft, counted from the driving shaft on; the driven first."""
        return bodies_on(number, self.stages)

    @property
    def can_be_fitted(self) -> bool:
        """Whether ``ncgear fit`` takes the file: one machine, its gears side by side, of one lobe each, one drawn."""
        gears = self.gears
        if gears is None or self._of_train is not None or not self.motion.gives_outline:
            return False
        return gears.mesh != "internal" and (gears.lobes.driving, gears.lobes.driven) == (1, 1)

    @property
    def loads_teeth(self) -> bool:
        """Whether the file gives loads on the teeth: a resistance, masses or a jam."""
        return any(load is not None for load in (self.resistance, self.masses, self.strength.overload))

    def _crank_is_known(self) -> Faults:
        key = entry_of(self.linkage).stroke_key
        if key is not None and getattr(self.linkage, key) is None and not self.motion.gives_stroke:
            meaning = type(self.linkage).model_fields[key].description
            yield fault(f"linkage.{key}", f"missing; give it ({meaning})")

    def _gears_by_themselves_move_no_slider(self) -> Faults:
        if not isinstance(self.linkage, NoLinkage):
            return
        if self.motion.gives_slider:
            yield fault(
                "linkage",
                f"missing; motion.law {self.motion.law} tells how a slider moves: give linkage, or a law of the ratio "
                "or of the driven angle",
            )
        for name in ("wishes", "optimize", "choices", "comparison"):
            if name in self.model_fields_set and getattr(self, name) is not None:
                yield fault(name, "given, but without linkage nothing moves to and fro; leave it out, or give linkage")

    def _a_crank_pin_has_a_crank(self) -> Faults:
        pin = self.gears.driven.crank_pin if self.gears else None
        alone = isinstance(self.linkage, NoLinkage)
        fit = {"fit": self.fit} if alone else {"fit.rod_width_mm": self.fit and self.fit.rod_width_mm}
        for key, value in {"gears.driven.crank_pin": pin, **fit}.items():
            if value is not None and not entry_of(self.linkage).has_crank_pin:
                yield fault(
                    key, "given, but the driven shaft turns no crank here; leave it out, or give a linkage with a crank"
                )

    def _an_outline_is_drawn(self) -> Faults:
        if self.outline is not None and not self.motion.gives_outline:
            yield fault("outline", f"given, but the law {self.motion.law} draws no pitch curve; leave it out")

    def _limits_are_those_of_the_output(self) -> Faults:
        if self.optimize is None:
            return
        ways = ("mm", "rad") if entry_of(self.linkage).turns else ("rad", "mm")
        groups = {
            "limits": ("peak_speed_{}_s", "peak_acceleration_{}_s2", "peak_jerk_{}_s3", "acceleration_harmonics_{}_s2"),
            "weights": ("acceleration_{}_s2", "jerk_{}_s3"),
        }
        for group, names in groups.items():
            for name in names:
                wrong, right = (name.format(way) for way in ways)
                if getattr(getattr(self.optimize, group), wrong, None) is not None:
                    does = "turns" if ways[1] == "rad" else "slides"
                    yield fault(f"optimize.{group}.{wrong}", f"given, but the output {does}; {right} is right")

    @property
    def free_flywheel(self) -> FlywheelRange | None:
        """The range in which the size of a flywheel on the driven shaft is sought; None if the masses give the size."""
        return None if self.optimize is None else self.optimize.driven_flywheel_kg_mm2

    @property
    def holding_teeth(self) -> bool:
        """Whether the teeth must hold with the law that is sought."""
        return self.optimize is not None and self.optimize.limits.teeth_hold

    def _a_free_flywheel_has_masses(self) -> Faults:
        if self.free_flywheel is not None and self.masses is None:
            yield fault(
                "optimize.driven_flywheel_kg_mm2",
                "given, but without masses there is nothing that a flywheel could take up; give masses",
            )

    @property
    def free_lengths(self) -> Mapping[str, Range]:
        """The ranges in which the best lengths of the mechanism are sought, by their keys."""
        asked = self.optimize and self.optimize.lengths
        return asked.ranges if asked else {}

    def _free_lengths_are_those_of_the_mechanism(self) -> Faults:
        entry = entry_of(self.linkage)
        own = [name for name in type(self.linkage).model_fields if name in Lengths.model_fields]
        own.append("stroke_deg" if entry.turns else "stroke_mm")
        for name in self.free_lengths:
            if name not in own:
                yield fault(f"optimize.lengths.{name}", f"given, but this mechanism has {listed(own, 'and')}")

    def _gears_have_a_size(self) -> Faults:
        if self.gears is None:
            return
        names, needed = (SIZES[:2], "one") if self.motion.gives_center_distance else (SIZES, "two")
        found = given(self.gears, names)
        if len(found) < len(names) - 1:
            said = f"only {found[0]} is given" if found else "no size is given"
            needed = f"{needed} of {listed(names, 'and')} {'is' if needed == 'one' else 'are'} needed"
            follows = ", since the centre distance follows from the law" if self.motion.gives_center_distance else ""
            yield fault("gears", f"{said}; {needed}{follows}")
        if self.motion.solves_shape and self.gears.mesh == "internal":
            yield fault(
                "gears.mesh",
                "internal given, but a quantity of a shape is found for a mate beside it only; leave mesh out, or give "
                "motion.solve_for: center_distance or scale",
            )

    def _slider_law_has_one_driven_lobe(self) -> Faults:
        if self.gears and self.motion.gives_slider and self.gears.lobes.driven != 1:
            yield fault(
                "gears.lobes.driven",
                f"{self.gears.lobes.driven} given, but a law of the slider's motion drives one crank; 1 is right",
            )

    def _shafts_fit_their_gears(self) -> Faults:
        if self.drivetrain is not None and self.gears is not None:
            yield from shaft_faults(self.shafts, self.gears, self.stages)

    def _not_offered(self) -> Faults:
        """Gears that turn less than once are plain pairs; keys that are not offered for them are refused.

        Only they have end stops.
        """
        gears = self.gears
        if not self.motion.is_open:
            for body in ("driving", "driven"):
                if gears is not None and getattr(gears, body).end_stop is not None:
                    yield fault(
                        f"gears.{body}.end_stop",
                        f"given, but gears of {self.motion.law} turn on and on; leave it out, or give a law over a "
                        "range (range_deg, spiral or function_generator)",
                    )
            return
        asked = {
            "gears.mesh": gears is not None and gears.mesh != "external",
            "gears.helix": gears is not None and gears.helix is not None,
            "gears.lobes": gears is not None and (gears.lobes.driving, gears.lobes.driven) != (1, 1),
            "gears.method": gears is not None and gears.method != "exact",
            "masses": self.masses is not None,
            "drivetrain": self.drivetrain is not None,
            "comparison": self.comparison is not None,
            "wishes": self.wishes != type(self.wishes)(),
            "optimize": self.optimize is not None,
            "choices": self.choices is not None,
        }
        said = "given, but it is not offered for gears that turn to and fro, less than once; leave it out"
        yield from (fault(key, said) for key, is_given in asked.items() if is_given)

    def _stages_have_one_lobe(self) -> Faults:
        wished = self.optimize.limits.stages if self.optimize else 1
        lobes = (self.gears.lobes.driving, self.gears.lobes.driven) if self.gears else (1, 1)
        if self.gears and self.gears.idlers:
            return
        if (stages := max(self.stages, wished)) > 1 and lobes != (1, 1):
            said = f"{lobes[0]}:{lobes[1]} given, but {COUNTS[stages]} stages have one lobe each; leave it out"
            yield fault("gears.lobes", said)

    @property
    def prescribes_row(self) -> bool:
        """Whether the law is that of the last gear of a row, from which that of its first pair is found."""
        idlers = self.gears.idlers if self.gears else None
        return idlers is not None and (idlers.law_of == "row" or self.motion.gives_slider)

    def _a_row_is_offered(self) -> Faults:
        if self.gears is not None and self.gears.idlers is not None:
            yield from row_faults(self, self.gears, self.gears.idlers)

    def _shared_out(self) -> Faults:
        if self.gears is None:
            return
        pairs, shared = self.gears.pairs, [key for key in ("sharing", "parts") if key in self.gears.model_fields_set]
        if pairs == 1:
            for key in shared:
                said = "given, but one pair has the whole ratio; leave it out, or give gears.pairs"
                yield fault(f"gears.{key}", said)
            return
        if self.gears.sharing == "safety" and not self.loads_teeth:
            yield fault("gears.sharing", "safety given, but a load of the teeth (resistance) is missing")
        if len(shared) > 1:
            yield fault("gears.parts", "given, and gears.sharing; leave one of them out")
        yield from counts("gears.parts", len(self.gears.parts or ()), pairs, "part", f"of {COUNTS[pairs]} pairs")
        reasons = {
            f"{self.motion.law} gives the gears over a range, less than a turn": self.motion.is_open,
            f"the distance of the axes follows from {self.motion.law}": self.motion.gives_center_distance,
            f"motion.{self.motion.pairs_key} shares the ratio already": self.motion.pairs_in_series > 1,
            "optimize.limits.stages has the ratio shared by the search": self.optimize is not None
            and self.optimize.limits.stages > 1,
        }
        found = (why for why, holds in reasons.items() if holds)
        yield from (fault("gears.pairs", f"{pairs} given, but {why}; leave one of them out") for why in found)

    def _shafts_between_have_inertia(self) -> Faults:
        wished = self.optimize.limits.stages if self.optimize else 1
        yield from shafts_counted(self.masses, max(self.stages, wished))


def design_model(data: Any) -> type[Design]:
    """The model of a design file's data, with the keys of the mechanism that ``linkage.kind`` names."""
    names = tuple(MECHANISMS)
    name = kind_named(data)
    return _design_of(name if name in names else names[0], names)


def require_known_kind(data: Mapping[str, Any]) -> None:
    """Refuse a linkage of no known kind, or with keys that only another kind has, as these lead to other faults."""
    name, linkage = kind_named(data), data.get("linkage")
    if name not in tuple(MECHANISMS):
        raise WrongInput(f"{quoted(name)} given; {listed(MECHANISMS)} is needed", key="linkage.kind")
    if not isinstance(linkage, Mapping):
        return
    keys = {name: {"kind", *entry.linkage.model_fields} for name, entry in MECHANISMS.items()}
    foreign = [key for key in linkage if key not in keys[name]]
    others = [name for name, known in keys.items() if known.issuperset(linkage)]
    if foreign and others:
        problem = f"unknown key of kind {name}; kind: {listed(others)} has {listed(foreign, 'and')}"
        raise WrongInput(problem, key=f"linkage.{foreign[0]}")


def design_models() -> dict[str, type[Design]]:
    """The model of design files for each mechanism, by its name."""
    names = tuple(MECHANISMS)
    return {name: _design_of(name, names) for name in names}


def _restored(data: dict[str, Any]) -> Design:
    return design_model(data).model_validate(data)


@cache
def _design_of(name: str, names: tuple[str, ...]) -> type[Design]:
    entry, usual, title = MECHANISMS[name], names[0], name.title().replace("_", "")
    named: Any = Literal[names]
    masses: Any = entry.masses | None
    resistance: Any = entry.resistance | None
    wishes: Any = entry.wishes
    description = f"which mechanism the driven gear turns; left out: {usual}"
    told: Any = Field(default=usual, description=description) if name == usual else Field(description=description)
    linkage: Any = create_model(f"{title}Linkage", __base__=entry.linkage, kind=(named, told))
    words = {key: field.description for key, field in Design.model_fields.items()}
    # Gears without a linkage have the group only if the file says so explicitly.
    group: Any = Field(description=words["linkage"])
    if name == NO_LINKAGE:
        group = Field(default_factory=lambda: linkage(kind=NO_LINKAGE), description=words["linkage"])
    return create_model(
        f"{title}Design",
        __base__=Design,
        linkage=(linkage, group),
        masses=(masses, Field(default=None, description=words["masses"])),
        resistance=(resistance, Field(default=None, description=words["resistance"])),
        wishes=(wishes, Field(default_factory=wishes, description=words["wishes"])),
    )


def json_schema(of: type[Model] = Design) -> dict[str, Any]:
    """The JSON Schema of a design file or another file, for editors that complete and check while typing."""
    title = f"ncgear {of.__name__.lower()} file"
    kinds: dict[type[Model], Callable[[], Mapping[str, type[Model]]]]
    kinds = {Design: design_models, TrainFile: train_models}
    if of in kinds:
        either: Any = reduce(or_, kinds[of]().values())
        return {"$schema": JSON_SCHEMA_DIALECT, **TypeAdapter(either).json_schema(), "title": title}
    return {"$schema": JSON_SCHEMA_DIALECT, **of.model_json_schema(), "title": title}
