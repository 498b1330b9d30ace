"""The pictures of a strength: PNG by file name."""

from __future__ import annotations

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
from ncgear.project.strengthening import Verdict
from ncgear.strength.holding import lives_of, worst


def strength_pictures(drive: Drive, verdict: Verdict) -> dict[str, bytes]:
    """The gears coloured by how far each tooth holds, and loads and stresses over the cycle."""
    charts = strength_charts(verdict.strength, verdict.weakest)
    joints = np.degrees(joints_up_to(drive.pair.transmission, np.radians(charts[0].end)))
    charts = [replace(chart, joints_deg=joints) for chart in charts]
    return {
        "strength.png": _gears(drive, verdict),
        "strength-cycle.png": column_png(charts, titled(drive, "loads of the teeth"), STRENGTH_LOOK, STRENGTH_COLUMN),
    }


def _gears(drive: Drive, verdict: Verdict) -> bytes:
    """The pair at the driving angle at which its weakest tooth has its largest stress."""
    strength, found = verdict.strength, verdict.weakest
    wanted = {(one.gear, one.damage): one.wanted for one in found}
    gears = {}
    for gear in Gear:
        shares = [life.safety / wanted[gear, damage] for damage, life in lives_of(strength, gear).items()]
        gears[gear] = ColouredGear(np.min(shares, axis=0), worst([one for one in found if one.gear is gear]).tooth)
    weakest = worst(found)
    (position,) = positions_at(drive, np.array([weakest.phi1_rad]))
    least, tooth = to_digits(weakest.safety, 3), f"tooth {weakest.tooth} of the {weakest.gear.value} gear"
    what = f"least safety {least} against {weakest.damage.words}, {tooth},"
    return coloured_teeth_png(drive, gears, position, titled(drive, what))
