"""Lines of the data sheet: bodies, the way past what stands beside the gears, tolerances, and these in words."""

from __future__ import annotations

from collections.abc import Iterable
from math import degrees
from typing import TYPE_CHECKING, Any

from ncgear.design.keys.tolerances import AssemblyTolerances
from ncgear.figures.numbers import drawn
from ncgear.figures.tables import Value, cell_text
from ncgear.frozen import dataclass
from ncgear.project.drive import Drive
from ncgear.project.gear_solids import rim_mm_of
from ncgear.project.passing import CRANK_PIN
from ncgear.project.tolerance_limits import Process, tolerances_of
from ncgear.project.tooth_form import thickness_limits_mm
from ncgear.tolerances.drawn import MADE_C
from ncgear.tolerances.iso286 import distance_deviation_mm, hole_text

if TYPE_CHECKING:
    from ncgear.solids.plan.body import RoundHole


@dataclass(frozen=True)
class SheetEntry:
    """One line of the sheet: a value of the ``pair``, or one each of the ``driving`` and the ``driven`` gear.

    ``unit`` may be empty.
    """

    label: str
    unit: str = ""
    pair: Value = None
    driving: Value = None
    driven: Value = None

    @property
    def of_pair(self) -> bool:
        """Whether the value belongs to the pair, so that it needs one cell only."""
        return self.pair is not None

    @property
    def texts(self) -> tuple[str, ...]:
        """The value of the pair, or the values of both gears, as text with the decimals of the unit."""
        values = (self.pair,) if self.of_pair else (self.driving, self.driven)
        return tuple(cell_text(value, self.unit) for value in values)


def of_both(label: str, values: Iterable[Value], unit: str = "mm") -> SheetEntry:
    """A line with a value of each gear, first the driving one's."""
    return SheetEntry(label, unit, None, *values)


def tolerances(drive: Drive) -> tuple[SheetEntry, ...]:
    """The tolerances of a pair."""
    given, gears, lead = drive.gears.tolerances, drive.gears, drive.gears.lead
    pin = gears.driven.crank_pin
    pinned = None if pin is None else hole_text(given.crank_pin_fit, pin.diameter_mm)
    bores = [body.bore_mm and bore_text(drive, body.bore_mm) for body in (gears.driving, gears.driven)]
    rows = (
        SheetEntry("standard", pair=given.standard or None),
        SheetEntry("accuracy grade", pair=given.grade or None),
        SheetEntry("lead crowning of both gears together", "\u00b5m", pair=lead.crowning_um or None),
        SheetEntry("end relief of both gears together", "\u00b5m", pair=lead.end_relief_um),
        SheetEntry("length of the end relief", "mm", pair=lead.end_relief_length_mm),
        SheetEntry("deviation of tooth thickness", "mm", thickness_limits_mm(gears)),
        SheetEntry("deviation of the centre distance", "mm", pair=distance_text(drive)),
        of_both("fit of the bore", bores),
        SheetEntry("fit of the crank pin's hole", "mm", driven=pinned),
        SheetEntry("fit of the index hole", pair=given.index_hole_fit if gears.index_holes else None),
        SheetEntry("sizes without a tolerance", pair=general_text(drive)),
        SheetEntry("roughness Ra, flanks; others", "\u00b5m", pair=f"{given.flank_ra_um:g}; {given.ra_um:g}"),
        SheetEntry("note", pair=given.note or None),
    )
    return _given(rows)


def distance_text(drive: Drive) -> str | None:
    """How far the centre distance may be off, either way, in mm: as assemblies are judged, or JS7 where they are exact.

    None where neither the file nor the standard says.
    """
    judged_mm = tolerances_of(drive)[0].center_distance_mm
    deviation_mm = judged_mm or distance_deviation_mm(drive.pitch.center_distance_mm)
    return f"\u00b1{drawn(deviation_mm, 'mm')}" if deviation_mm else None


def bore_text(drive: Drive, diameter_mm: float) -> str:
    """The fit of a bore."""
    return hole_text(drive.gears.tolerances.bore_fit, diameter_mm)


def general_text(drive: Drive) -> str:
    """The class of sizes without a tolerance of their own."""
    return f"ISO 2768-{drive.gears.tolerances.general}"


def bodies(drive: Drive) -> tuple[SheetEntry, ...]:
    """Bores, keyways and the other parts of the bodies; solids are made only where a gear has round holes."""
    gears, both, clearance = drive.gears, (drive.gears.driving, drive.gears.driven), drive.gears.process_clearance_mm
    rows = [
        of_both("bore", (body.bore_mm for body in both)),
        of_both("keyway, width x depth", _sizes(_each(both, "keyway"), "width_mm", "depth_mm")),
        of_both("hub, diameter x height", _sizes(_each(both, "hub"), "diameter_mm", "height_mm")),
        of_both("thickness of web", (x and x.thickness_mm for x in _each(both, "web"))),
    ]
    if any((gears.index_holes, *_each(both, "lightening_holes"), gears.driven.crank_pin)):
        plans = drive.solids.driving.plan, drive.solids.driven.plan
        pin, holes = plans[1].crank_pin, _each(plans, "lightening_holes")
        rows.append(SheetEntry("diameter of the crank pin's hole", "mm", driven=pin.diameter_mm if pin else None))
        rows.append(SheetEntry("centre of the crank pin's hole, x and y", "mm", driven=_place(pin) if pin else None))
        sizes = (f"{len(group)} x {_mm(group[0].diameter_mm)}" if group else None for group in holes)
        rows.append(of_both("lightening holes, number x diameter", sizes))
        if gears.index_holes:
            marks = _each(plans, "index_hole")
            rows.append(of_both("diameter of index hole", (x.diameter_mm if x else "no room for one" for x in marks)))
            rows.append(of_both("index hole, x and y", (x and _place(x) for x in marks)))
    stops = (x and f"{_mm(x.pin_mm)}, {_mm(x.radius_mm)}" for x in _each(both, "end_stop"))
    rim = rim_mm_of(gears, drive.rack.module_mm) if drive.pitch.driven.is_ring else None
    rows.append(of_both("pin of end stop, diameter, radius", stops))
    rows.append(SheetEntry("rim outside the deepest root", "mm", driven=rim))
    rows.append(SheetEntry("bevel of the edges at z = 0", "mm", gears.first_layer_chamfer_mm or None))
    kerf = SheetEntry("kerf in files for cutting", "mm", -2.0 * clearance)
    rows.append(kerf if clearance < 0.0 else SheetEntry("clearance in files for printing", "mm", clearance or None))
    return _given(rows)


def _each(both: Iterable[object], name: str) -> list[Any]:
    return [getattr(gear, name) for gear in both]


def _sizes(parts: Iterable[Any], *names: str) -> list[Value]:
    """``10 x 4``: the sizes of each part, None where a gear has none."""
    return [part and " x ".join(_mm(getattr(part, name)) for name in names) for part in parts]


def _given(rows: Iterable[SheetEntry]) -> tuple[SheetEntry, ...]:
    return tuple(row for row in rows if row.of_pair or row.driving or row.driven)


def _mm(size_mm: float) -> str:
    return drawn(size_mm, "mm")


def _place(hole: RoundHole) -> str:
    return f"{_mm(hole.x_mm)}, {_mm(hole.y_mm)}"


def passed_summary(drive: Drive) -> dict[str, Any]:
    """The section ``fit`` of the summary: nothing for gears that turn no crank.

    The keys of each distance begin with the names of both, as ``rod_to_driving_shaft``.  ``width_max`` is the widest
    part that passes, less than 0 where none does; ``clearance`` is there where the width is given.
    """
    found: dict[str, Any] = {}
    for passing in drive.passings:
        name = f"{passing.part} to {passing.standing.name}".replace("'s", "").replace(" ", "_")
        found[f"{name}_min_mm"] = passing.distance_mm
        found[f"{name}_min_at_rad"] = passing.phi1_rad
        if passing.room_mm is not None:
            found[f"{name}_width_max_mm"] = passing.room_mm
        if passing.clearance_mm is not None:
            found[f"{name}_clearance_mm"] = passing.clearance_mm
    return {"fit": found} if found else {}


def passed_rows(drive: Drive) -> tuple[SheetEntry, ...]:
    """The same as rows of the data sheet: distances between middles, the angles, and the widest part that passes."""
    rows = []
    for passing in drive.passings:
        name, room = f"{passing.part} to {passing.standing.name}", passing.room_mm
        rows.append(SheetEntry(f"{name}: least distance of their middles", "mm", pair=passing.distance_mm))
        rows.append(SheetEntry(f"{name}: driving angle there", "deg", pair=degrees(passing.phi1_rad)))
        if room is not None:
            rows.append(
                SheetEntry(f"{name}: widest {passing.part} that passes", "mm", pair=room if room > 0.0 else "none")
            )
        if passing.clearance_mm is not None:
            rows.append(SheetEntry(f"{name}: clearance, under 0 where they meet", "mm", pair=passing.clearance_mm))
    rows += [SheetEntry(f"{shaft} beside the {part}", pair="must end below it") for part, shaft in shafts_below(drive)]
    return tuple(rows)


def shafts_below(drive: Drive) -> list[tuple[str, str]]:
    """Each rod that meets the driving gear's shaft or hub, and what must end below it."""
    return [
        (passing.part, passing.standing.name)
        for passing in drive.passings
        if passing.meets and passing.part != CRANK_PIN and passing.standing.about_driving_axis
    ]


def limit_words(given: AssemblyTolerances) -> list[str]:
    """What deviates, by its largest value."""
    driving, driven, warm = given.driving, given.driven, given.temperature
    words = [
        f"centre distance \u00b1{given.center_distance_mm:g} mm" if given.center_distance_mm else "",
        _both("bores off by {} mm", driving.eccentricity_mm, driven.eccentricity_mm),
        _both("tilted by {} deg", driving.tilt_deg, driven.tilt_deg),
        _both("keyways \u00b1{} deg", driving.index_deg, driven.index_deg),
        _both("single pitch \u00b1{} mm", driving.single_pitch_mm or 0.0, driven.single_pitch_mm or 0.0),
        _both("profile within {} mm", driving.profile_mm or 0.0, driven.profile_mm or 0.0),
        _both("wear up to {} mm", driving.wear_mm, driven.wear_mm),
    ]
    if warm is not None and (warm.largest_c > warm.least_c or warm.least_c != MADE_C):
        words.append(f"{warm.least_c:g} to {warm.largest_c:g} \u00b0C")
    grades = {limits.grade or given.grade for limits in (driving, driven)} - {None}
    if grades:
        words.insert(0, f"grade {' and '.join(str(grade) for grade in sorted(g for g in grades if g))} of ISO 1328-1")
    return [word for word in words if word] or ["none"]


def assumed_words(process: Process | None) -> str:
    """What stands before tolerances that the file does not give; nothing before those that it gives."""
    return "" if process is None else f"usual for {process} gears, "


def _both(text: str, driving: float, driven: float) -> str:
    if not (driving or driven):
        return ""
    return text.format(f"{driving:g}" if driving == driven else f"{driving:g} and {driven:g}")
