"""Run the studies and write docs/speed-against-error.md with its pictures.

``make bench`` runs all of them, in some minutes.  By hand, into export/bench, a few: ``PYTHONPATH=benchmarks python -m
speed_against_error.run --only closure --only limit``.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ncgear.files.publish import prepare
from speed_against_error.certified_limit import limit_study
from speed_against_error.contact import contact_angle_study, contact_ratio_study
from speed_against_error.driven_angle import ellipse_angle_study, return_angle_study
from speed_against_error.inversion import inversion_study
from speed_against_error.makeable_laws import makeable_study, places_study
from speed_against_error.outlines import circular_outline_study, elliptical_outline_study
from speed_against_error.page import PAGE, PICTURES, page, picture, summary
from speed_against_error.pitch_curves import (
    baler_curvature_study,
    baler_length_study,
    ellipse_curvature_study,
    ellipse_length_study,
)
from speed_against_error.return_period import basis_study, closure_study
from speed_against_error.simulation import baler_simulation_study, half_power_simulation_study
from speed_against_error.solids import surface_study, volume_study
from speed_against_error.study import TIMED_S, Study, measured
from speed_against_error.tooth_elements import deflection_study, root_stress_study

STUDIES: Mapping[str, Callable[[], Study]] = {
    "inversion": inversion_study,
    "closure": closure_study,
    "return-basis": basis_study,
    "driven-angle-ellipse": ellipse_angle_study,
    "driven-angle-return": return_angle_study,
    "pitch-length-ellipse": ellipse_length_study,
    "pitch-length-baler": baler_length_study,
    "curvature-ellipse": ellipse_curvature_study,
    "curvature-baler": baler_curvature_study,
    "outlines-circle": circular_outline_study,
    "outlines-ellipse": elliptical_outline_study,
    "contact-ratio": contact_ratio_study,
    "contact-angle": contact_angle_study,
    "solid-volume": volume_study,
    "solid-surface": surface_study,
    "simulation-baler": baler_simulation_study,
    "simulation-half": half_power_simulation_study,
    "limit": limit_study,
    "makeable": makeable_study,
    "makeable-places": places_study,
    "tooth-root-stress": root_stress_study,
    "tooth-deflection": deflection_study,
}
"""All studies by their keys, in the order of the way of the data."""


def run(arguments: Sequence[str] | None = None, timed_s: float = TIMED_S) -> None:
    """Measure the studies that the command line names, or all; print a line for each, and write page and pictures."""
    parser = ArgumentParser(prog="speed_against_error.run", description="Measure speed against error; write the page.")
    parser.add_argument("--out", type=Path, default=Path("export/bench"), help="output folder (export/bench)")
    parser.add_argument("--only", action="append", choices=list(STUDIES), help="a study, can be given again")
    asked = parser.parse_args(arguments)
    prepare(asked.out)
    found = []
    for key, make in STUDIES.items():
        if asked.only is None or key in asked.only:
            found.append(measured(make(), timed_s))
            print(summary(found[-1]), flush=True)
    (asked.out / PICTURES).mkdir(parents=True, exist_ok=True)
    for one in found:
        (asked.out / PICTURES / f"{one.study.key}.png").write_bytes(picture(one))
    (asked.out / PAGE).write_text(page(found), encoding="utf-8")


if __name__ == "__main__":
    run()
