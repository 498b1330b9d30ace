"""The data sheet of a pair of gears, with all that a drawing needs, as a plain value and as Markdown."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import zip_longest
from math import degrees, isclose
from typing import TYPE_CHECKING, TypeVar

from ncgear.design.keys.gears import PROFILES
from ncgear.errors import DesignError
from ncgear.figures.data_sheet.entries import SheetEntry, bodies, of_both, passed_rows, tolerances
from ncgear.figures.data_sheet.measured_tables import TITLE, band_table, cut_table, pin_tables, pitch_table, span_table
from ncgear.figures.numbers import OF_GEAR, micrometres, shown, to_digits, told
from ncgear.figures.tables import Cells, Table, Value, cell_text, columns_of, markdown, markdown_text
from ncgear.frozen import dataclass
from ncgear.pitch.curve import PitchCurve
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.figures import figures_of
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
    entries: tuple[SheetEntry, ...]


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
    rows: dict[str, Callable[[], Iterable[SheetEntry]]] = {
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
        for name, of in (("Span of", span_table), ("Pins in", pin_tables)):
            tables[f"{name} the {gear.value} gear"] = partial(lambda of, number: of(pair.measured[number]), of, number)
    told = tuple(table for title, of in tables.items() for table in tables_or_why(title, of))
    return DataSheet(pair.title, tuple(group for group in groups if group.entries), told)


MISSING = (ArithmeticError, ValueError, DesignError)
"""What computations raise where they fail."""


Found = TypeVar("Found")


def _or_why(computed: Callable[[], Found], said: Callable[[str], Found]) -> Found:
    """What is computed, or what says in its place why it could not be."""
    try:
        return computed()
    except MISSING as error:
        return said(f"could not be computed: {error}")


def rows_or_why(rows: Callable[[], Iterable[SheetEntry]]) -> tuple[SheetEntry, ...]:
    """The rows of a group, or one that says why they are missing."""
    return _or_why(lambda: tuple(rows()), lambda why: (SheetEntry("these figures", pair=why),))


def tables_or_why(title: str, tables: Callable[[], tuple[Table, ...]]) -> tuple[Table, ...]:
    """Tables, or an empty one that says why they are missing."""
    return _or_why(tables, lambda why: (Table(title, (), (), (why,)),))


def rows_found(tables: Callable[[], tuple[Table, ...]]) -> list[Cells]:
    """The rows of tables; none where they could not be computed."""
    return [row for table in tables_or_why("", tables) for row in table.rows]


def sizes(drive: Drive) -> Iterator[SheetEntry]:
    """The sizes of the gears and their places to each other."""
    pitch, size, covered = drive.pitch, drive.pitch.size, drive.pitch.transmission.lobes.range
    yield SheetEntry("kind of gear", driving=_kind(pitch.driving), driven=_kind(pitch.driven))
    yield SheetEntry("number of teeth", driving=size.driving_teeth, driven=size.driven_teeth)
    if covered is not None:
        yield of_both("turn between the end stops", map(degrees, (covered.driving_rad, covered.driven_rad)), "deg")
    yield from _of_pair(drive, "module_mm", "center_distance_mm", "face_width_mm")
    yield of_both(OF_GEAR["length"], map(pitch.length_mm, Gear))
    section = ", z = 0" if drive.helix else ""
    yield of_both("pitch radius", map(pitch.radius_range_mm, Gear))
    for name in ("tip", "root"):
        radii = (getattr(drive.reach[gear], f"{name}_mm") for gear in Gear)
        yield of_both(f"radius of {name}s{section}", ((float(radius.min()), float(radius.max())) for radius in radii))
    yield of_both("greatest radius over all", map(drive.outer_radii_mm.__getitem__, Gear))
    if drive.housing_radii_mm:
        yield of_both("bore of the housing", (2.0 * radius for radius in drive.housing_radii_mm.values()))
    yield of_both(OF_GEAR["min radius"], map(pitch.least_radius_mm, Gear))


def _of_pair(drive: Drive, *keys: str, before: str = "", after: str = "") -> Iterator[SheetEntry]:
    """Figures of the pair, with what stands before and after their names."""
    for key, value in figures_of(drive, *keys).items():
        name, text, unit = told(key, value)
        yield SheetEntry(f"{before}{name}{after}", unit, text)


def _kind(curve: PitchCurve) -> str:
    low, high = curve.transmission.ratio_range
    form = "circular" if isclose(low.value, high.value, rel_tol=ROUND) else "non-circular"
    return f"{form}, internal" if curve.is_ring else form


OF_SHIFTED = "profile shift coefficient of the {0} gear", "thickness on the {0} pitch curve, mm"
SHIFTED = columns_of("tooth", *(head.format(gear.value) for gear in Gear for head in OF_SHIFTED))


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


def rack_data(drive: Drive) -> Iterator[SheetEntry]:
    """The basic rack that generates both gears."""
    rack, module, asked, helix = drive.rack, drive.rack.module_mm, drive.gears.rack, drive.helix
    driving, driven = drive.teeth.driving.flanks, drive.teeth.driven.flanks
    pushing, idle = map(degrees, rack.angles_rad)
    if pushing == idle:
        yield SheetEntry("pressure angle", "deg", pushing)
    else:
        # The driving gear turns counter-clockwise; a pushed flank faces against the driven gear's turning.
        pushed = "clockwise" if drive.pitch.driven.is_ring else "counter-clockwise"
        yield SheetEntry("pressure angle, pushing flanks", "deg", pushing)
        yield SheetEntry("pressure angle, idle flanks", "deg", idle)
        yield SheetEntry("flanks that push face, seen from the end z > 0", driving="counter-clockwise", driven=pushed)
    given = asked.model_fields_set & {"addendum", "dedendum", "root_radius"}
    # A root radius that is left out is smaller than the profile's where that does not fit.
    smaller = asked.root_radius < PROFILES[asked.profile].root_radius
    departed = ", coefficients as below" if given or smaller else ""
    yield SheetEntry("basic rack of ISO 53", pair=f"profile {asked.profile}{departed}")
    sizes = (cell_text(size / module) for size in (rack.addendum_mm, rack.dedendum_mm, rack.root_radius_mm))
    yield SheetEntry("addendum, dedendum, root radius", "modules", ", ".join(sizes))
    if (relief := rack.relief) is None:
        yield SheetEntry("tip relief", pair="none")
    else:
        yield SheetEntry(f"tip relief at {to_digits(relief.full_mm / module, 4)} modules", "mm", relief.amount_mm)
        yield SheetEntry("tip relief begins over the pitch line at", "mm", relief.start_mm)
    if driving.has_own_shifts:
        yield SheetEntry("profile shift", pair="of each tooth, see its table")
    else:
        yield of_both("profile shift", (gear.rack.shift_mm / module for gear in (driving, driven)), "modules")
    yield from _of_pair(drive, "backlash_mm", "backlash_max_mm")
    if drive.play.thicker_mm == 0.0:
        yield from _of_pair(drive, "play_rad")
    else:
        yield from _of_pair(drive, "play_rad", before="least ")
        yield from _of_pair(drive, "play_greatest_rad")
    if helix is None:
        yield SheetEntry("helix angle", "deg", 0.0)
    else:
        hands, kind = (helix.hand, *({"right", "left"} - {helix.hand})), "herringbone, at z = 0 " * helix.herringbone
        yield SheetEntry("helix angle", "deg", degrees(helix.angle_rad))
        yield of_both("hand of helix", (f"{kind}{hand}" for hand in hands), "")
    by_itself = drive.teeth.cutter is CutterKind.RACK and driving.has_own_shifts
    yield SheetEntry("cutter", pair="rack, each space by itself" if by_itself else CUTTERS[drive.teeth.cutter])


def tooth_data(drive: Drive) -> Iterator[SheetEntry]:
    """Undercut and shortened teeth; mean number of pairs of flanks that touch, and least arc of any pair in pitches.

    Both under load too, where a load brings more flanks into contact.
    """
    both = drive.teeth.driving, drive.teeth.driven
    undercut = (_with_amount(gear.undercut, undercutting, gear) for gear in both)
    yield of_both("teeth that a tool of full depth undercuts", undercut, "")
    yield of_both("teeth with shortened tips", map(_shortened, both), "")
    section = ", z = 0" if drive.helix else ""
    without = f"{section}, without load" if drive.designed_contact.held_apart else section
    yield from _of_pair(drive, "contact_ratio_mean", "contact_ratio_min", after=without)
    if drive.pairs_under_load is not None:
        yield from _of_pair(drive, "contact_ratio_under_load_mean", "contact_ratio_under_load_min", after=section)
    if drive.helix:
        yield SheetEntry("overlap ratio", pair=drive.overlap_ratio)


def _shortened(gear: ToothedGear) -> str:
    numbers = {number for limit in Limit if limit is not Limit.FULL for number in gear.shortened(limit)}
    return _with_amount(sorted(numbers), lambda gear: shortening(gear, gear.tips.limit != Limit.FULL), gear)


def _with_amount(numbers: list[int], loss: Callable[[ToothedGear], Loss], gear: ToothedGear) -> str:
    if not numbers:
        return shown(numbers)
    found = loss(gear)
    return f"{shown(numbers)}, by up to {micrometres(found.amount_mm)} (tooth {found.tooth})"


def measurements(drive: Drive, gears: tuple[GearMeasures, GearMeasures]) -> Iterator[SheetEntry]:
    """The means of measuring, and the number of places where they can be used."""

    def measured(label: str, value: Callable[[GearMeasures], Value], unit: str = "") -> SheetEntry:
        return of_both(label, (_or_why(partial(value, gear), lambda why: why) for gear in gears), unit)

    if drive.helix:
        yield SheetEntry("section that is measured, z", "mm", section_z_mm(drive.helix))
    yield measured(f"diameter of measuring {gears[0].tool}s", lambda gear: gear.pins.diameter_mm, "mm")
    yield measured("spaces in which they measure", _spaces)
    yield measured("places of a span", _places)


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


def _sheet_row(entry: SheetEntry) -> list[str]:
    first, driven = (entry.pair, entry.driven) if entry.of_pair else (entry.driving, entry.driven)
    cells = markdown_text(first, entry.unit), markdown_text(driven, entry.unit)
    return [markdown_text(entry.label), *cells, markdown_text(entry.unit)]


def _headed(title: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A heading and a table of texts below it, which is left out where it has no columns."""
    table = ["", *markdown([markdown_text(head) for head in heads], rows, " --- ")] if heads else []
    return "\n".join([f"## {title}", *table])
