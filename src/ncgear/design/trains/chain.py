"""The train ``chain``: a row of gears on fixed axes; each gear meshes with the next."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from ncgear.design.keys.base import FORMULA, Expression, Faults, Length, Several, counts, fault, optional, required
from ncgear.design.keys.gears import MOST_IDLERS, Bend, Lobe
from ncgear.design.keys.masses import DrivenShaftMasses, shafts_counted
from ncgear.design.trains.base import RatedGears, RatedTrain
from ncgear.errors import DesignError, below, renamed

if TYPE_CHECKING:
    from ncgear.ratio.transmission import Lobes, Transmission
    from ncgear.trains.train import Train

MOST_GEARS = 2 + MOST_IDLERS
BENDS = "bends_deg"


class ChainGears(RatedGears):
    """The teeth and the bodies of all gears."""

    module_mm: Length = required("module in mm; the distances of the axes follow")
    teeth: int = required("teeth of the first gear, a whole number", ge=8, le=1000)


class Chain(RatedTrain):
    """A row of gears."""

    KIND = "chain"
    RULES = ("at most one of idler_radius ratio",)
    MEANING = "a row of gears on fixed axes; each meshes with the next"
    WRITTEN_AS: ClassVar[dict[str, str]] = {
        "operation.speed_rpm": "speed_rpm",
        "motion.ratio": "ratio",
        "motion.expression_mm": "idler_radius",
        "gears.lobes": "lobes",
        "gears.idlers": "lobes",
        "gears.idlers.bends_deg": "bends_deg",
        "gears.driving.bore_mm": "gears.bore_mm",
        "gears.driven.bore_mm": "gears.bore_mm",
        "output.chord_tolerance_mm": "gears.chord_tolerance_mm",
    }

    lobes: Annotated[Several[Lobe], Field(min_length=2, max_length=MOST_GEARS)] = required(
        "lobes of every gear, from the driving gear on, whole numbers; their count is the number of gears"
    )
    bends_deg: Annotated[Several[Bend], Field(max_length=MOST_GEARS - 2)] = optional(
        "by how many degrees the line of centres turns at each idler, counter-clockwise; left out: a straight row", ()
    )
    ratio: Expression | None = optional(
        f"ratio of the first two gears as a formula of phi, {FORMULA}, times the factor that closes the cycle; left "
        "out: even"
    )
    idler_radius: Expression | None = optional(
        f"radius of the second gear's pitch curve, in any unit, as a formula of its polar angle phi, {FORMULA}, in "
        "place of a ratio; a circle about its axis makes all gears round"
    )
    gears: ChainGears = required("the teeth and the bodies of all gears")
    masses: DrivenShaftMasses | None = optional("inertia of what turns, which ncgear simulate needs; left out: none")

    def _both_flanks_of_idlers_push(self) -> Faults:
        pushing, idle = self.gears.rack.angles_deg
        if pushing != idle:
            yield fault(
                "gears.rack.idle_pressure_angle_deg",
                f"{idle:g} given, but both flanks of an idler push; leave it out, or {pushing:g} is right",
            )

    def _each_idler_has_its_bend(self) -> Faults:
        gears, bends = len(self.lobes), len(self.bends_deg)
        yield from counts("bends_deg", bends, gears - 2, "idler", f"of {gears} gears")

    def _each_shaft_between_has_its_inertia(self) -> Faults:
        yield from shafts_counted(self.masses, len(self.lobes) - 1)

    @property
    def alone(self) -> tuple[str, ...]:
        """Loads are keys of the machine, too."""
        return (*super().alone, "resistance.", "masses.")

    def require_bores(self) -> None:
        """Raise WrongInput for too large a bore; all else is refused where it is computed, with what would help."""
        try:
            self.train()
        except DesignError as refused:
            if refused.key == "train.gears.bore_mm":
                raise

    def machine(self) -> dict[str, Any]:
        """A pair of gears by themselves whose driven gear drives the others."""
        given = self.model_dump(by_alias=True, exclude_unset=True)
        body = {"bore_mm": self.gears.bore_mm} if self.gears.bore_mm else {}
        kept = ("teeth", "module_mm", "face_width_mm", "rack", "backlash_mm", "material")
        gears = {key: given["gears"][key] for key in kept if key in given["gears"]}
        gears |= {"lobes": {"driving": self.lobes[0], "driven": self.lobes[1]}, "driving": body, "driven": body}
        if further := list(self.lobes[2:]):
            bends = {"bends_deg": list(self.bends_deg)} if self.bends_deg else {}
            gears["idlers"] = {"lobes": further, **bends}
        return {
            "operation": {"speed_rpm": self.speed_rpm},
            "motion": self._motion,
            "gears": gears,
            "output": {"chord_tolerance_mm": self.gears.chord_mm(self.gears.module_mm)},
            **{
                key: given[key]
                for key in ("resistance", "masses", "strength", "tolerances")
                if given.get(key) is not None
            },
        }

    @property
    def _motion(self) -> dict[str, Any]:
        """The law of the first mesh."""
        if self.idler_radius is not None:
            return {"law": "pitch_curve", "gear": "driven", "expression_mm": self.idler_radius, "solve_for": "scale"}
        if self.ratio is None:
            return {"law": "uniform_crank"}
        return {"law": "ratio_expression", "ratio": self.ratio, "scale_to_close": True}

    def _made(self) -> Train:
        import numpy as np

        from ncgear.ratio.laws.row import row_laws
        from ncgear.ratio.transmission import Lobes
        from ncgear.trains.chain import chain_train, row_of

        bends = [radians(bend) for bend in self.bends_deg] or [0.0] * (len(self.lobes) - 2)
        directions = np.cumsum([0.0, *bends]).tolist()
        gears = self.gears
        form, chord_mm = gears.form(gears.module_mm), gears.chord_mm(gears.module_mm)
        # A law that is refused is refused where it is given
        law = "ratio" if self.idler_radius is None else "idler_radius"
        with below("train"), renamed("motion", law), renamed("motion.ratio", law), renamed("motion.expression_mm", law):
            first = self._first(Lobes(self.lobes[0], self.lobes[1]))
            laws = row_laws(first, self.lobes, directions, BENDS)
            row = row_of(laws, directions, gears.teeth, gears.module_mm)
            row.require_apart(BENDS)
            return chain_train(row, form, gears.face_width_mm, gears.bore_mm, self.speed_rpm, chord_mm)

    def _first(self, lobes: Lobes) -> Transmission:
        """The law of the first mesh."""
        from ncgear.design.laws.registry import LawName, law_keys
        from ncgear.mechanisms.driven_shaft import DrivenShaft

        motion = law_keys(LawName(self._motion["law"])).model_validate(self._motion)
        return motion.law_on(DrivenShaft(), lobes).transmission
