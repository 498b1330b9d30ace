"""The pictures of a strength: PNG by file name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ncgear.drawings.charts.chart import joints_up_to
from ncgear.drawings.charts.drawer import STRENGTH_COLUMN, STRENGTH_LOOK, column_png
from ncgear.drawings.charts.strength_charts import strength_charts
from ncgear.drawings.pictures import positions_at, titled
from ncgear.drawings.plots.coloured_teeth import ColouredGear, coloured_teeth_png, stress_field_png
from ncgear.figures.numbers import to_digits
from ncgear.numerics.arrays import largest_rows
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.project.strengthening import Rating
from ncgear.strength.holding import lives_of, worst


def strength_pictures(drive: Drive, rating: Rating) -> dict[str, bytes]:
    """The gears coloured by how far each tooth holds, and loads and stresses over the cycle."""
    charts = strength_charts(rating.strength, rating.weakest)
    joints = np.degrees(joints_up_to(drive.pair.transmission, np.radians(charts[0].end)))
    charts = [replace(chart, joints_deg=joints) for chart in charts]
    pictures = {
        "strength.png": _gears(drive, rating),
        "strength-cycle.png": column_png(charts, _titled(drive, "loads of the teeth"), STRENGTH_LOOK, STRENGTH_COLUMN),
    }
    return pictures if rating.strength.method == "estimate" else {**pictures, "strength-stress.png": _field(drive)}


def _field(drive: Drive) -> bytes:
    """The stress by finite elements, each tooth at the place of contact with its largest root stress."""
    from ncgear.strength.elements.teeth import Elements

    judged = drive.judged_teeth("elements")
    contacts, roots = judged.strength.contacts, judged.strength.stresses.tension_mpa
    fields = {}
    for place, (gear, method) in enumerate(zip(Gear, judged.methods, strict=True)):
        assert isinstance(method, Elements)
        places = contacts.on(gear)
        worst_of_tooth = largest_rows(roots[place], places.tooth - 1, drive.teeth.of(gear).teeth)
        rows = worst_of_tooth[worst_of_tooth >= 0]
        chosen = places.kept(rows)
        load_n_mm = roots[place, rows] / method.root_stress(chosen).tension_mpa
        fields[gear] = method.painted(chosen, load_n_mm)
    row = int(np.argmax(roots.max(axis=0)))
    (position,) = positions_at(drive, contacts.phi1_rad[[row]])
    return stress_field_png(drive, fields, float(roots.max()), position, _titled(drive, "stress in the teeth"))


def _gears(drive: Drive, rating: Rating) -> bytes:
    """The pair at the driving angle at which its weakest tooth has its largest stress."""
    strength, found = rating.strength, rating.weakest
    wanted = {(one.gear, one.damage): one.wanted for one in found}
    gears = {}
    for gear in Gear:
        shares = [life.safety / wanted[gear, damage] for damage, life in lives_of(strength, gear).items()]
        gears[gear] = ColouredGear(np.min(shares, axis=0), worst([one for one in found if one.gear is gear]).tooth)
    weakest = worst(found)
    (position,) = positions_at(drive, np.array([weakest.phi1_rad]))
    least, tooth = to_digits(weakest.safety, 3), f"tooth {weakest.tooth} of the {weakest.gear.value} gear"
    what = f"least safety {least} against {weakest.damage.words}, {tooth},"
    return coloured_teeth_png(drive, gears, position, _titled(drive, what))


def _titled(drive: Drive, what: str) -> str:
    return titled(drive, what if drive.stage is None else f"stage {drive.stage}, {what}")
