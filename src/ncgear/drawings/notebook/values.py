"""The view of each value in a notebook: the drive, its stages from the law to the strength, and results of searches.

``ncgear.shown.Shown`` calls ``html``.  A value shows its own content; the drive shows the whole machine, for which it
makes the teeth.  No view starts a search.
"""

from __future__ import annotations

import re
from base64 import b64encode
from collections.abc import Callable, Iterator, Mapping
from functools import partial, singledispatch

import numpy as np
from markupsafe import Markup

from ncgear.contact.designed.as_designed import AsDesigned
from ncgear.design.keys.base import Model
from ncgear.design.keys.design import Design
from ncgear.drawings.charts import teeth_charts
from ncgear.drawings.charts.chart import LOAD, MOTION, Quantity, motion_chart
from ncgear.drawings.notebook.pieces import (
    NOTHING,
    charts,
    facts,
    figures,
    framed,
    made,
    not_made,
    picture,
    pitch_outlines,
    refusal,
    running,
    section_outline,
    table,
    tooth_outline,
    tooth_outlines,
)
from ncgear.drawings.page.chart_figure import PageChart
from ncgear.drawings.page.motion_charts import motion_charts
from ncgear.drawings.page.page_charts import ratio_chart
from ncgear.drawings.page.tables import typeset
from ncgear.drawings.plots.frontier_plot import frontier
from ncgear.drawings.scene.scene import scene_of
from ncgear.figures.advice.verdict import KnownParts, judged
from ncgear.figures.answers.machine import gear_facts, machine_facts
from ncgear.figures.balance.parts import balancing_figures
from ncgear.figures.best_law import figures_summary
from ncgear.figures.data_sheet.measured_tables import cut_table
from ncgear.figures.mended import found_words, tried_words
from ncgear.figures.numbers import shown, to_digits
from ncgear.figures.strong import HEADS as WEAKEST
from ncgear.figures.strong import METHODS, weakest_cells
from ncgear.figures.summary.check_summary import comparison_rows, comparison_tables
from ncgear.figures.tables import Column, Table, columns_of
from ncgear.kinematics.check import KinematicCheck, peak_figures
from ncgear.kinematics.motion import Machine, OutputMotion, sample_angles
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.numerics.units import RAD_S_PER_RPM
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.project.balancing import Balancing
from ncgear.project.best_law import BestLaw
from ncgear.project.drive import Drive
from ncgear.project.frontier_run import Frontier
from ncgear.project.mending import Mend, Mending
from ncgear.project.workshop_measures import CutGear
from ncgear.ratio.transmission import Law, Transmission
from ncgear.solids.mesh.pair import GearSolid, SolidPair
from ncgear.strength.answer import Strength
from ncgear.strength.holding import WantedSafety, weakest_teeth
from ncgear.teeth.gear import ToothedGear, ToothedPair
from ncgear.whole_machines.search import WholeMachines
from ncgear.whole_machines.told import HEADS, machines_answer

ANY_SAFETY = WantedSafety(0.0, 0.0)
"""A strength knows no wanted safety; with this no tooth is too weak."""


def html(value: object) -> str:
    """The value as HTML that stands by itself; where a part cannot be made, the HTML says so, and nothing is raised."""
    title, description = _title(value)
    return framed(title, *_as_far_as_made(value), description=description)


def _as_far_as_made(value: object) -> Iterator[Markup]:
    """The pieces of a value, up to a piece that cannot be made; the refusal stands in the place of that piece."""
    try:
        yield from _pieces(value)
    except Exception as error:
        yield not_made(error)


def _title(value: object) -> tuple[str, str]:
    """A drive and a design have the name and description of the file; any other value has its type's name."""
    if isinstance(value, Balancing):
        return value.balance.name, ""
    if isinstance(value, Design):
        return value.name, value.description or ""
    if not isinstance(value, Drive):
        return type(value).__name__, ""
    return value.title, value.design.description or ""


@singledispatch
def _pieces(value: object) -> Iterator[Markup]:
    raise TypeError(f"{type(value).__name__} has no picture")


@_pieces.register
def _drive(drive: Drive) -> Iterator[Markup]:
    """The whole machine; pieces that need a refused part are left out, and the refusal is told once."""
    pairs = drive.by_stage if drive.design.gears is not None else ()
    pieces: list[Callable[[], Markup]] = [
        lambda: facts([("mechanism", _mechanism(drive.linkage)), *typeset(machine_facts(drive))]),
        *(partial(lambda pair: facts(typeset(gear_facts(pair), pair.of)), pair) for pair in pairs),
        lambda: running(scene_of(drive)),
        lambda: charts(motion_charts(drive, drive.transmission.cycle_rad)[1:]),
        lambda: NOTHING.join(map(table, comparison_tables(comparison_rows(drive)))),
        lambda: _verdict(drive),
    ]
    yield from dict.fromkeys(map(made, pieces))


def _verdict(drive: Drive) -> Markup:
    """The verdict of a check on a machine: its warnings, and the conditions that it cannot judge."""
    verdict = judged(drive, KnownParts.MOTION)
    warnings = [refusal(f"warning: {line}") for line in verdict.lines(matter=True)]
    left = facts([("not judged", verdict.not_judged.removeprefix("Not judged: "))]) if verdict.not_judged else NOTHING
    return NOTHING.join([*warnings, left])


def _mechanism(linkage: Mechanism) -> str:
    return re.sub("(?<=[a-z])(?=[A-Z])", " ", type(linkage).__name__).lower()


@_pieces.register
def _law(law: Law) -> Iterator[Markup]:
    pairs = len(law.train.pairs)
    yield facts([("mechanism", _mechanism(law.linkage)), ("pairs of gears", str(pairs))])
    yield figures({**law.facts, **(law.stroke.facts if law.stroke else {})})
    yield from _transmission(law.transmission)


@_pieces.register
def _transmission(law: Transmission) -> Iterator[Markup]:
    (low, high), lobes = law.ratio_range, f"{law.lobes.driving} : {law.lobes.driven}"
    yield figures({"ratio_min": low.value, "ratio_max": high.value, "lobes": lobes, "pieces": len(law.pieces)})
    yield charts([PageChart("ratio", ratio_chart(law, law.cycle_rad))])


@_pieces.register
def _machine(machine: Machine) -> Iterator[Markup]:
    yield figures({"mechanism": _mechanism(machine.linkage), "speed_rpm": machine.speed_rad_s / RAD_S_PER_RPM})
    yield from _motion(machine.motion(sample_angles(machine.transmission)))


@_pieces.register
def _motion(motion: OutputMotion) -> Iterator[Markup]:
    powered = () if motion.power_with_masses_w is None else (Quantity.POWER,)
    loaded = LOAD if np.any(motion.load != 0.0) else powered
    chosen = (*MOTION, *loaded, Quantity.RATIO)
    yield charts(PageChart(quantity.value, motion_chart(quantity, motion.linkage, motion)) for quantity in chosen)


@_pieces.register
def _check(check: KinematicCheck) -> Iterator[Markup]:
    yield figures({"speed_rpm": check.speed_rpm} | peak_figures(check))


@_pieces.register
def _pitch(pitch: PitchPair) -> Iterator[Markup]:
    size, radii = pitch.size, {f"radius_{gear.value}_mm": [pitch.radius_range_mm(gear)] for gear in Gear}
    teeth = f"{size.driving_teeth} : {size.driven_teeth}"
    yield figures({"center_distance_mm": size.center_distance_mm, "teeth": teeth, "module_mm": size.module_mm} | radii)
    yield picture(pitch_outlines(pitch), "both pitch curves")


@_pieces.register
def _teeth(teeth: ToothedPair) -> Iterator[Markup]:
    counts = [(f"teeth, {gear.value}", str(teeth.of(gear).teeth)) for gear in Gear]
    yield facts([*counts, ("cutter", teeth.cutter.value)])
    yield picture(tooth_outlines(teeth), "both gears in mesh")


@_pieces.register
def _gear(gear: ToothedGear) -> Iterator[Markup]:
    yield figures({"teeth": gear.teeth, "undercut": gear.undercut, "points": len(gear.outline_mm)})
    yield picture([tooth_outline(gear)], "a gear")


@_pieces.register
def _contact(contact: AsDesigned) -> Iterator[Markup]:
    yield figures(
        {
            "contact_ratio": contact.contact_ratio,
            "contact_ratio_min": contact.least_arc,
            "transmission_error_rad": contact.pushing.transmission_error_rad,
            "backlash_max_rad": float(contact.backlash_rad.max()),
            "penetration_max_mm": float(contact.overlap_mm.max()),
            "positions": contact.placement.count,
        }
    )
    drawn = teeth_charts.pressure_angle(contact), teeth_charts.sliding(contact), teeth_charts.backlash(contact)
    yield charts(PageChart(chart.name.replace(" ", "-"), chart) for chart in drawn)


@_pieces.register
def _solids(solids: SolidPair) -> Iterator[Markup]:
    for gear in Gear:
        yield from _solid(solids.of(gear), gear)


@_pieces.register
def _solid(solid: GearSolid, gear: Gear = Gear.DRIVING) -> Iterator[Markup]:
    size = " x ".join(to_digits(float(length), 4) for length in solid.mesh.extents)
    mark = "yes" if solid.index_hole else "no"
    yield facts([("size", f"{size} mm"), ("triangles", str(len(solid.mesh.faces))), ("index hole", mark)])
    yield picture([section_outline(gear, solid.plan.section)], "a gear")


@_pieces.register
def _strength(strength: Strength) -> Iterator[Markup]:
    found = weakest_teeth(strength, dict.fromkeys(Gear, ANY_SAFETY))
    heads = {place: head for place, head in enumerate(WEAKEST) if head.label != "wanted"}
    cells = [weakest_cells(weakest, strength.wears) for weakest in found]
    made_of = (f"{gear.value} gear of {strength.of(gear).material.name}" for gear in Gear)
    rows = tuple(tuple(row[place] for place in heads) for row in cells)
    yield table(Table("The weakest teeth", tuple(heads.values()), rows, (METHODS[strength.method], *made_of)))
    drawn = teeth_charts.strength_charts(strength, found)
    yield charts(PageChart(chart.name.replace(" ", "-"), chart) for chart in drawn)


@_pieces.register
def _cut(gear: CutGear) -> Iterator[Markup]:
    yield table(cut_table(gear))


@_pieces.register
def _mend(mend: Mend) -> Iterator[Markup]:
    yield facts([("what works", found_words(mend))])
    yield from (picture(tooth_outlines(pair.teeth), "both gears in mesh") for pair in mend.drive.by_stage)


@_pieces.register
def _mending(search: Mending) -> Iterator[Markup]:
    yield refusal(str(search.refusal))
    if search.failed:
        yield facts([("tried in vain", tried_words(search.failed))])
    if search.found is not None:
        yield from _mend(search.found)


@_pieces.register
def _best_law(best: BestLaw) -> Iterator[Markup]:
    """The law that was found, and no further search, which would take seconds."""
    if "law" not in vars(best):
        yield facts([("best law", f"of {best.design.name}: searched for when .law or .figures is asked for")])
        return
    found = {"best law": best.figures, "uniform crank": best.uniform_figures}
    if best.given_figures is not None:
        found["this design"] = best.given_figures
    for name, law in found.items():
        yield Markup("<p><b>{}</b></p>").format(name) + figures(figures_summary(law))


@_pieces.register
def _frontier(found: Frontier) -> Iterator[Markup]:
    columns = columns_of("cap on the power, W", "limit, mm/s2", "best law, mm/s2", "family, mm/s2")
    rows = tuple(
        tuple(
            map(shown, (point.cap_w, point.limit_mm_s2, point.law.peak_acceleration_mm_s2, of.peak_acceleration_mm_s2))
        )
        for point, of in zip(found.laws, found.families, strict=True)
    )
    yield table(Table("Least peak acceleration", columns, rows))
    limit = np.array([[law.cap_w, law.limit_mm_s2] for law in found.laws])
    laws = np.array([[law.law.peak_power_w, law.law.peak_acceleration_mm_s2] for law in found.laws])
    known = [
        (family.peak_power_w, family.peak_acceleration_mm_s2)
        for family in found.families
        if None not in (family.peak_power_w, family.peak_acceleration_mm_s2)
    ]
    family = np.array(known).reshape(-1, 2)
    shown_as = '<img alt="power against acceleration" style="max-width:100%" src="data:image/png;base64,{}">'
    data = b64encode(frontier(limit, laws, family, [], "power against acceleration")).decode()
    yield Markup(shown_as).format(data)


@_pieces.register
def _whole_machines(found: WholeMachines) -> Iterator[Markup]:
    answer = machines_answer(found)
    rows = tuple((row.name, *row.texts) for row in answer.rows)
    yield table(Table(answer.head, tuple(map(Column, ("machine", *HEADS))), rows))


@_pieces.register
def _balancing(balancing: Balancing) -> Iterator[Markup]:
    """Every part of the balance file under its name; of tables within, the command and its files have the rows."""
    for part, content in balancing_figures(balancing).items():
        for content_part in content if isinstance(content, list) else [content]:
            if isinstance(content_part, Mapping):
                yield Markup("<p><b>{}</b></p>").format(part.replace("_", " ")) + figures(content_part)


@_pieces.register
def _design(design: Design) -> Iterator[Markup]:
    yield table(Table("Keys of the file", columns_of("key", "value"), tuple(_given(design, ""))))


def _given(group: Model, above: str) -> Iterator[tuple[str, str]]:
    for name in (name for name in type(group).model_fields if name in group.model_fields_set):
        value, path = getattr(group, name), f"{above}{type(group).model_fields[name].alias or name}"
        several = value if isinstance(value, tuple) and value and isinstance(value[0], Model) else ()
        for number, item in enumerate(several):
            yield from _given(item, f"{path}.{number}.")
        if isinstance(value, Model):
            yield from _given(value, f"{path}.")
        elif not several:
            yield path, shown(value)
