"""The data sheet of a pair of gears, with all that a drawing needs, as a plain value and as Markdown."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import zip_longest
from math import degrees, isclose
from typing import TYPE_CHECKING

from ncgear.design.keys.gears import PROFILES
from ncgear.errors import DesignError
from ncgear.figures.data_sheet.entries import Entry, bodies, passed_rows, tolerances
from ncgear.figures.data_sheet.measured_tables import cut_table, pin_tables, span_table
from ncgear.figures.data_sheet.pitch_table import pitch_table
from ncgear.figures.numbers import micrometres, shown, to_digits
from ncgear.figures.quantities import OF_GEAR, figure, name_of
from ncgear.figures.tables import Cells, Column, Table, Value, markdown, markdown_text
from ncgear.figures.thickness import TITLE, band_table
from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.workshop_measures import GearMeasures, cut_gears, section_z_mm
from ncgear.teeth.form import CutterKind
from ncgear.teeth.lost import Loss, shortening, undercutting
from ncgear.teeth.shifts import thickness_mm
from ncgear.teeth.tips import Limit

if TYPE_CHECKING:
    from ncgear.teeth.gear import ToothedGear

ROUND = 1e-9
"""A gear is called circular where the ratio varies by less than this, relatively: that is rounding."""


@dataclass(frozen=True)
class Group:
    """Entries under a heading."""

    title: str
    entries: tuple[Entry, ...]


@dataclass(frozen=True)
class DataSheet:
    """All that a drawing of the pair needs."""

    name: str
    groups: tuple[Group, ...]
    tables: tuple[Table, ...]


def data_sheet(pair: Drive) -> DataSheet:
    """The sheet of one pair of gears; a design in two stages has one for each drive in ``by_stage``.

    Raises WrongInput or NoSuchMechanism as the drive does up to the contact of the teeth, and nothing beyond: a figure
    that cannot be computed says why, where it would stand.
    """
    pair.require_sound_teeth()
    name = pair.design.name if pair.stage is None else f"{pair.design.name}, stage {pair.stage}"
    rows: dict[str, Callable[[], Sequence[Entry]]] = {
        "Sizes": partial(sizes, pair),
        "Basic rack": partial(rack_data, pair),
        "Teeth": partial(tooth_data, pair),
        "Bodies": partial(bodies, pair),
        "Beside the gears": partial(passed_rows, pair),
        "Tolerances": partial(tolerances, pair),
        "Measurements of the teeth": lambda: measurements(pair, pair.measured),
    }
    groups = (Group(title, rows_or_why(of)) for title, of in rows.items())
    tables: dict[str, Callable[[], tuple[Table, ...]]] = {
        TITLE: lambda: band_table(pair),
        "Cut by": lambda: tuple(map(cut_table, cut_gears(pair))),
        "Teeth of their own shift": lambda: shifted_teeth(pair),
        "Pitch curves": lambda: (pitch_table(pair.pitch),),
    }
    for number, gear in enumerate(Gear):
        tables[f"Span of the {gear.value} gear"] = partial(_of_one, pair, number, span_table)
        tables[f"Pins in the {gear.value} gear"] = partial(_of_one, pair, number, pin_tables)
    told = tuple(table for title, of in tables.items() for table in tables_or_why(title, of))
    return DataSheet(name, tuple(group for group in groups if group.entries), told)


MISSING = (ArithmeticError, ValueError, DesignError)
"""What computations raise where they fail."""


def _missing(error: Exception) -> str:
    return f"could not be computed: {error}"


def rows_or_why(rows: Callable[[], Sequence[Entry]]) -> tuple[Entry, ...]:
    """The rows of a group, or one that says why they are missing."""
    try:
        return tuple(rows())
    except MISSING as error:
        return (Entry("these figures", pair=_missing(error)),)


def _cell(value: Callable[[], Value]) -> Value:
    """A value, or why it is missing."""
    try:
        return value()
    except MISSING as error:
        return _missing(error)


def tables_or_why(title: str, tables: Callable[[], tuple[Table, ...]]) -> tuple[Table, ...]:
    """Tables, or an empty one that says why they are missing."""
    try:
        return tables()
    except MISSING as error:
        return (Table(title, (), (), (_missing(error),)),)


def rows_found(tables: Callable[[], tuple[Table, ...]]) -> list[Cells]:
    """The rows of tables; none where they could not be computed."""
    return [row for table in tables_or_why("", tables) for row in table.rows]


def _of_one(pair: Drive, number: int, tables: Callable[[GearMeasures], tuple[Table, ...]]) -> tuple[Table, ...]:
    return tables(pair.measured[number])


def sizes(drive: Drive) -> tuple[Entry, ...]:
    """The sizes of the gears and their places to each other."""
    size, pitch = drive.pitch.size, drive.pitch
    return (
        Entry("kind of gear", driving=_kind(pitch.driving), driven=_kind(pitch.driven)),
        Entry("number of teeth", driving=size.driving_teeth, driven=size.driven_teeth),
        *_turns(drive),
        Entry(name_of("module_mm"), "mm", pair=size.module_mm),
        Entry(name_of("center_distance_mm"), "mm", pair=size.center_distance_mm),
        Entry(name_of("face_width_mm"), "mm", pair=drive.gears.face_width_mm),
        _of_both(OF_GEAR["length"], pitch.length_mm(Gear.DRIVING), pitch.length_mm(Gear.DRIVEN)),
        *_radii(drive),
        _of_both(OF_GEAR["min radius"], pitch.least_radius_mm(Gear.DRIVING), pitch.least_radius_mm(Gear.DRIVEN)),
    )


def _turns(drive: Drive) -> list[Entry]:
    """How far gears that turn less than once turn from one end stop to the other."""
    covered = drive.pitch.transmission.lobes.range
    if covered is None:
        return []
    angles = degrees(covered.driving_rad), degrees(covered.driven_rad)
    return [Entry("turn between the end stops", "deg", driving=angles[0], driven=angles[1])]


def _kind(curve: PitchCurve) -> str:
    low, high = curve.transmission.ratio_range
    form = "circular" if isclose(low.value, high.value, rel_tol=ROUND) else "non-circular"
    return f"{form}, internal" if curve.is_ring else form


def _of_both(label: str, driving: float, driven: float) -> Entry:
    return Entry(label, "mm", driving=driving, driven=driven)


def _radii(drive: Drive) -> list[Entry]:
    of_teeth, over_all, housing = drive.tooth_radii_mm, drive.outer_radii_mm, drive.housing_radii_mm
    section = ", in the section at z = 0" if drive.helix else ""
    return [
        *_ends("pitch radius", *(drive.pitch.radius_range_mm(gear) for gear in Gear)),
        *_ends(f"radius of tips{section}", *(_range(of_teeth[gear][0]) for gear in Gear)),
        *_ends(f"radius of roots{section}", *(_range(of_teeth[gear][1]) for gear in Gear)),
        _of_both("greatest radius over all", over_all[Gear.DRIVING], over_all[Gear.DRIVEN]),
        *([_of_both("bore of the housing", *(2.0 * radius for radius in housing.values()))] if housing else []),
    ]


def _range(values: Array) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def _ends(name: str, driving: tuple[float, float], driven: tuple[float, float]) -> list[Entry]:
    words = ("least", "greatest")
    return [_of_both(f"{word} {name}", *ends) for word, *ends in zip(words, driving, driven, strict=True)]


SHIFTED = (
    Column("tooth"),
    Column("profile shift coefficient of the driving gear"),
    Column("thickness on the driving pitch curve", "mm"),
    Column("profile shift coefficient of the driven gear"),
    Column("thickness on the driven pitch curve", "mm"),
)


def shifted_teeth(drive: Drive) -> tuple[Table, ...]:
    """The shift of each tooth and its thickness along the pitch curve; no table where all teeth are alike."""
    driving, driven = drive.teeth.driving.flanks, drive.teeth.driven.flanks
    if not driving.has_own_shifts:
        return ()
    rack = drive.rack
    columns = []
    for flanks in (driving, driven):
        shift = flanks.full_tip_mm[::2] - rack.addendum_mm
        outwards = thickness_mm(rack.module_mm, shift, rack.angles_rad)
        columns += [(shift / rack.module_mm).tolist(), outwards.tolist()]
    rows = tuple((number, *row) for number, row in enumerate(zip_longest(*columns), 1))
    note = (
        "play is not taken off these thicknesses; they are pi m / 2 + x m (tan(alpha) + tan(beta)), x being the shift"
    )
    return (Table("Teeth with a profile shift of their own", SHIFTED, rows, (note,), long=True),)


CUTTERS = {
    CutterKind.RACK: "rack (hob)",
    CutterKind.PINION: "pinion (shaper)",
    CutterKind.MATE: "none; spaces cleared for the mate's tips (wire, mill, print)",
}
"""The workshop's words for the tool that leaves the fillets."""


def rack_data(drive: Drive) -> tuple[Entry, ...]:
    """The basic rack that generates both gears."""
    rack, module, asked = drive.rack, drive.rack.module_mm, drive.gears.rack
    given = asked.model_fields_set & {"addendum", "dedendum", "root_radius"}
    # A root radius that is left out is smaller than the profile's where that does not fit.
    smaller = asked.root_radius < PROFILES[asked.profile].root_radius
    departed = ", coefficients as below" if given or smaller else ""
    return (
        *_angles(drive),
        Entry("basic rack of ISO 53", pair=f"profile {drive.gears.rack.profile}{departed}"),
        Entry("addendum coefficient", pair=rack.addendum_mm / module),
        Entry("dedendum coefficient", pair=rack.dedendum_mm / module),
        Entry("root radius coefficient", pair=rack.root_radius_mm / module),
        *_relief(drive),
        _shifts(drive),
        Entry(name_of("backlash_mm"), "mm", pair=drive.play.least_normal_mm.value),
        Entry(name_of("backlash_max_mm"), "mm", pair=drive.play.largest_normal_mm.value),
        *_play(drive),
        *_helix(drive),
        Entry("cutter", pair=_cutter(drive)),
    )


def _play(drive: Drive) -> list[Entry]:
    """The play of the driven gear: one angle, or the least and the greatest."""
    least, greatest = map(degrees, drive.play_range_rad)
    if drive.play.thicker_mm == 0.0:
        return [Entry(name_of("play_rad"), "deg", pair=least)]
    return [
        Entry(f"{word} {name_of('play_rad')}", "deg", pair=value)
        for word, value in (("least", least), ("greatest", greatest))
    ]


def _angles(drive: Drive) -> list[Entry]:
    """The rack's pressure angles and, where they differ, which flanks are which."""
    pushing, idle = map(degrees, drive.rack.angles_rad)
    if pushing == idle:
        return [Entry("pressure angle of the rack", "deg", pair=pushing)]
    # The driving gear turns counter-clockwise; a pushed flank faces against the driven gear's turning.
    pushed = "clockwise" if drive.pitch.driven.is_ring else "counter-clockwise"
    return [
        Entry("pressure angle of the rack, flanks that push", "deg", pair=pushing),
        Entry("pressure angle of the rack, idle flanks", "deg", pair=idle),
        Entry("flanks that push face, seen from the end z > 0", driving="counter-clockwise", driven=pushed),
    ]


def _cutter(drive: Drive) -> str:
    kind = drive.teeth.cutter
    each = kind is CutterKind.RACK and drive.teeth.driving.flanks.has_own_shifts
    return "rack, each space by itself" if each else CUTTERS[kind]


def _relief(drive: Drive) -> list[Entry]:
    relief, module = drive.rack.relief, drive.rack.module_mm
    if relief is None:
        return [Entry("tip relief", pair="none")]
    start = Entry("tip relief begins over the pitch line at", "mm", pair=relief.start_mm)
    return [Entry(f"tip relief at {to_digits(relief.full_mm / module, 4)} modules", "mm", pair=relief.amount_mm), start]


def _shifts(drive: Drive) -> Entry:
    driving, driven = (gear.flanks.rack for gear in (drive.teeth.driving, drive.teeth.driven))
    module = drive.rack.module_mm
    if drive.teeth.driving.flanks.has_own_shifts:
        return Entry("profile shift coefficient", pair="of each tooth, see its table")
    return Entry("profile shift coefficient", driving=driving.shift_mm / module, driven=driven.shift_mm / module)


def _helix(drive: Drive) -> list[Entry]:
    helix = drive.helix
    if helix is None:
        return [Entry("helix angle", "deg", pair=0.0)]
    other = {"right": "left", "left": "right"}[helix.hand]
    kind = "herringbone, at z = 0 " if helix.herringbone else ""
    return [
        Entry("helix angle at the pitch curve", "deg", pair=degrees(helix.angle_rad)),
        Entry("hand of helix", driving=f"{kind}{helix.hand}", driven=f"{kind}{other}"),
    ]


def tooth_data(drive: Drive) -> tuple[Entry, ...]:
    """Undercut and shortened teeth, and how long the teeth touch."""
    driving, driven = drive.teeth.driving, drive.teeth.driven
    undercut = _undercut(driving), _undercut(driven)
    return (
        Entry("teeth that a tool of full depth undercuts", driving=undercut[0], driven=undercut[1]),
        Entry("teeth with shortened tips", driving=_shortened(driving), driven=_shortened(driven)),
        *_contact_ratios(drive),
        *([Entry("overlap ratio", pair=drive.overlap_ratio)] if drive.helix else []),
    )


def _contact_ratios(drive: Drive) -> list[Entry]:
    """Mean number of pairs of flanks that touch, and least arc of any pair; under load where it brings more in."""
    designed, loaded = drive.designed_contact, drive.pairs_under_load
    section = ", in the section at z = 0" if drive.helix else ""
    without = f"{section}, without load" if designed.held_apart else section
    rows = [
        _ratio("contact_ratio_mean", designed.contact_ratio, without),
        _ratio("contact_ratio_min", designed.least_arc, without),
    ]
    if loaded is None:
        return rows
    under, shortest = min(side.contact_ratio for side in loaded), min(side.least_arc for side in loaded)
    return [
        *rows,
        _ratio("contact_ratio_under_load_mean", under, section),
        _ratio("contact_ratio_under_load_min", shortest, section),
    ]


def _ratio(key: str, value: float, where: str) -> Entry:
    return Entry(f"{name_of(key)}{where}", pair=figure(key, value))


def _undercut(gear: ToothedGear) -> str:
    return _with_amount(gear.undercut, undercutting, gear)


def _shortened(gear: ToothedGear) -> str:
    numbers = {number for limit in Limit if limit is not Limit.FULL for number in gear.shortened(limit)}
    return _with_amount(sorted(numbers), lambda one: shortening(one, one.tips.limit != Limit.FULL), gear)


def _with_amount(numbers: list[int], loss: Callable[[ToothedGear], Loss], gear: ToothedGear) -> str:
    """Numbers of teeth, and how much these have lost at most."""
    if not numbers:
        return shown(numbers)
    found = loss(gear)
    return f"{shown(numbers)}, by up to {micrometres(found.amount_mm)} (tooth {found.tooth})"


def measurements(drive: Drive, gears: tuple[GearMeasures, GearMeasures]) -> tuple[Entry, ...]:
    """The means of measuring, and the number of places where they can be used."""
    driving, driven = gears

    def of_both(label: str, value: Callable[[GearMeasures], Value], unit: str = "") -> Entry:
        return Entry(label, unit, driving=_cell(partial(value, driving)), driven=_cell(partial(value, driven)))

    return (
        *([Entry("section that is measured, z", "mm", pair=section_z_mm(drive.helix))] if drive.helix else []),
        of_both(f"diameter of measuring {driving.tool}s", lambda gear: gear.pins.diameter_mm, "mm"),
        of_both("spaces in which they measure", _spaces),
        of_both("places of a span", _places),
    )


def _spaces(gear: GearMeasures) -> Value:
    measured, spaces = gear.pins.space.size, gear.toothed.teeth - (gear.toothed.flanks.made is not None)
    return "all" if measured == spaces else f"{measured} of {spaces}"


def _places(gear: GearMeasures) -> Value:
    """The number of places in which a span is defined, or why there is none."""
    spans = gear.spans
    if gear.working.is_ring:
        return "not defined: plates do not reach the flanks of a ring"
    if gear.working.flanks.equivalent:
        return "not defined: flanks of equivalent gears do not follow the pitch curve"
    pushing, idle = gear.working.flanks.rack.angles_rad
    if pushing != idle:
        return "not defined: flanks of unequal pressure angles have no common normal"
    if spans.everywhere:
        return "everywhere alike"
    if not spans.first.size:
        return "not defined: nowhere do two plates touch flanks along one normal"
    return int(spans.first.size)


def sheet_text(sheet: DataSheet) -> str:
    """The sheet as Markdown."""
    blocks = [f"# Gear data: {sheet.name}"]
    for group in sheet.groups:
        blocks.append(_headed(group.title, SHEET_HEADS, map(_sheet_row, group.entries)))
    for table in sheet.tables:
        notes = [f"{note[0].upper()}{note[1:]}." for note in table.notes]
        rows = [
            [markdown_text(value, column.unit) for value, column in zip(row, table.columns, strict=False)]
            for row in table.rows
        ]
        blocks += [_headed(table.title, [column.heading for column in table.columns], rows), *notes]
    return "\n\n".join(blocks) + "\n"


SHEET_HEADS = "", "driving, or both", "driven", "unit"


def _sheet_row(entry: Entry) -> list[str]:
    first, driven = (entry.pair, entry.driven) if entry.of_pair else (entry.driving, entry.driven)
    cells = markdown_text(first, entry.unit), markdown_text(driven, entry.unit)
    return [markdown_text(entry.label), *cells, markdown_text(entry.unit)]


def _headed(title: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A heading and a table of texts below it, which is left out where it has no columns."""
    table = ["", *markdown([markdown_text(head) for head in heads], rows, " --- ")] if heads else []
    return "\n".join([f"## {title}", *table])
