"""A pair of gears for FreeCAD: the macro that shows it there, and the process that computes it for the macro.

FreeCAD's own Python need not have ncgear's libraries.  So the macro starts ``python -m ncgear.files.freecad`` with the
Python that has ncgear, and keeps this process: it sends a line with the path of a design file and receives a line of
JSON.  Each solid is text of OpenCASCADE's format BREP, which FreeCAD reads directly, so that no face is approximated
again.
"""

from __future__ import annotations

import json
import os
import sys
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from typing import Any, TextIO

from ncgear.errors import DesignError
from ncgear.extras import require

MACRO = "ncgear.FCMacro"

COMMAND = '["ncgear-python", "-m", "ncgear.files.freecad"]'
"""The line of the macro that is replaced by the command of this Python."""


def macro() -> str:
    """The macro, which starts this Python."""
    text = (files("ncgear") / "files" / MACRO).read_text(encoding="utf-8")
    return text.replace(COMMAND, json.dumps([sys.executable, "-m", __name__]))


def answer(path: Path) -> dict[str, Any]:
    """The content that the macro shows of a design: the name, solids, places and pitch curves of each pair of gears.

    Places are in mm in the pose of phi1 = 0, the driving axis at the origin.  A pitch curve is a cubic B-spline: poles,
    knots and the multiplicity of each knot.  Raises the errors of the design.
    """
    require("OCP", "step", "FreeCAD's macro")
    import numpy as np
    from OCP.BRepTools import BRepTools
    from OCP.TopTools import TopTools_FormatVersion

    from ncgear.files.workshop.step import exact_solids, pitch_spline
    from ncgear.project.opened import load
    from ncgear.teeth.contour import CURVES_SHARE

    drive, pairs = load(path), []
    for pair in drive.by_stage:
        gears = []
        for gear, (shape, _) in exact_solids(pair).items():
            text = BytesIO()
            # Without the kernel's own triangles; the first version of the format is read by every FreeCAD.
            BRepTools.Write_s(shape, text, False, False, TopTools_FormatVersion.TopTools_FormatVersion_VERSION_1)
            spline = pitch_spline(pair.pitch.of(gear), CURVES_SHARE * pair.chord_tolerance_mm)
            knots, times = np.unique(spline.knots, return_counts=True)
            curve = {"poles": spline.poles_mm.tolist(), "knots": knots.tolist(), "times": times.tolist()}
            gears.append({"name": gear.value, "brep": text.getvalue().decode("ascii"), "pitch_curve": curve})
        pairs.append({"name": pair.stem, "center_distance_mm": pair.pitch.center_distance_mm, "gears": gears})
    return {"pairs": pairs}


def answered(lines: TextIO, out: TextIO) -> None:
    """Answer each line, the path of a design file, by a line of JSON; a refused design by its message."""
    for line in lines:
        try:
            found = answer(Path(line.rstrip("\r\n")))
        except DesignError as error:
            found = {"refused": str(error)}
        print(json.dumps(found), file=out, flush=True)


if __name__ == "__main__":
    # Output of the kernel goes to the messages, so that no other text stands between the answers.
    replies = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)
    sys.stdin.reconfigure(encoding="utf-8")  # type: ignore[union-attr]
    answered(sys.stdin, replies)
