"""The pictures of a strength: PNG by file name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ncgear.drawings.charts.chart import joints_up_to
from ncgear.drawings.charts.drawer import STRENGTH_COLUMN, STRENGTH_LOOK, column_png
from ncgear.drawings.charts.strength_charts import strength_charts
from ncgear.drawings.pictures import titled
from ncgear.drawings.plots.assembled_pair import positions_at
from ncgear.drawings.plots.coloured_teeth import ColouredGear, coloured_teeth_png
from ncgear.figures.numbers import to_digits
from ncgear.pitch.shape import Gear
from ncgear.project.drive import Drive
from ncgear.strength.answer import Strength
from ncgear.strength.holding import Weakest, lives_of, worst


def strength_pictures(drive: Drive, strength: Strength, found: Sequence[Weakest]) -> dict[str, bytes]:
    """The gears coloured by how far each tooth holds, and loads and stresses over the cycle."""
    charts = strength_charts(strength, found)
    joints = np.degrees(joints_up_to(drive.pair.transmission, np.radians(charts[0].end)))
    charts = [replace(chart, joints_deg=joints) for chart in charts]
    return {
        "strength.png": _gears(drive, strength, found),
        "strength-cycle.png": column_png(charts, titled(drive, "loads of the teeth"), STRENGTH_LOOK, STRENGTH_COLUMN),
    }


def _gears(drive: Drive, strength: Strength, found: Sequence[Weakest]) -> bytes:
    """The pair at the driving angle at which its weakest tooth has its largest stress."""
    wanted = {one.damage: one.wanted for one in found}
    gears = {}
    for gear in Gear:
        shares = [life.safety / wanted[damage] for damage, life in lives_of(strength, gear).items()]
        gears[gear] = ColouredGear(np.min(shares, axis=0), worst([one for one in found if one.gear is gear]).tooth)
    weakest = worst(list(found))
    (position,) = positions_at(drive, np.array([weakest.phi1_rad]))
    least = f"{to_digits(weakest.safety, 3)} against {weakest.damage.words}, tooth {weakest.tooth} of the {weakest.gear.value} gear"
    return coloured_teeth_png(drive, gears, position, titled(drive, f"least safety {least}"))
