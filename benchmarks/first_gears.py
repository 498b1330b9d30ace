"""How long a stranger waits for the first gears, and what an installation without extras takes on the disk.

Run as ``make bench`` or ``python benchmarks/first_gears.py``.  Writes benchmarks/first-gears.md.  Steps are those of
somebody who has Python and nothing else; the first build also compiles what it loads to bytecode, the second has it.
"""

from __future__ import annotations

import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).parents[1]

SIZES = """
import json
from importlib.metadata import distributions
print(json.dumps({one.name: sum(file.locate().stat().st_size for file in one.files or () if file.locate().is_file())
                  for one in distributions()}))
"""
"""What the files of each distribution take, in bytes."""

LEAST_MB = 5.0
"""A library with less than this is counted among the others."""


PAGE = """\
# The first gears

Written by `python benchmarks/first_gears.py`: {cores} cores, Python {python}. How long somebody waits who
has nothing but Python, and what an installation without extras takes on the disk. Packages come from a near mirror;
elsewhere the network decides how long that takes. On a machine busy with other work, the clock says more of that work.

{times}

{sizes}

Bytecode, which Python writes beside the sources, comes on top. `scipy` finds roots and solves systems; `sympy` and
`mpmath` make closed forms, and proofs in many digits; `matplotlib` draws, with `fonttools` and `pillow`; `ezdxf` writes
drawings; `manifold3d`, `shapely` and `trimesh` make and check solids.
"""


def page(times: dict[str, tuple[float, float]], sizes: dict[str, int]) -> str:
    """The written page: times by the clock and of processors in s, sizes in bytes."""
    large = {name: size for name, size in sizes.items() if size >= LEAST_MB * 1e6}
    rows = [(f"`{name}`", size) for name, size in sorted(large.items(), key=lambda row: -row[1])]
    rows += [(f"{len(sizes) - len(large)} others", sum(sizes.values()) - sum(large.values()))]
    rows += [("all", sum(sizes.values()))]
    return PAGE.format(
        cores=os.cpu_count(),
        python=platform.python_version(),
        times="\n".join(
            [
                "| step | by the clock, s | processors, s |",
                "|---|---|---|",
                *(f"| {step} | {clock:.1f} | {processors:.1f} |" for step, (clock, processors) in times.items()),
            ]
        ),
        sizes="\n".join(
            ["| library | on the disk, MB |", "|---|---|", *(f"| {name} | {size / 1e6:.0f} |" for name, size in rows)]
        ),
    )


def main() -> None:
    """Install and build in an environment of its own, and write the page."""
    times: dict[str, tuple[float, float]] = {}
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_"))}

    def done(step: str, *command: str) -> str:
        before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
        run = subprocess.run(command, cwd=place, env=environment, check=True, capture_output=True, text=True)
        clock, after = perf_counter() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
        times[step] = clock, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return run.stdout

    with tempfile.TemporaryDirectory() as place:
        bin_ = Path(place, "venv", "Scripts" if os.name == "nt" else "bin")
        python, ncgear = str(bin_ / "python"), str(bin_ / "ncgear")
        done("`python -m venv`", sys.executable, "-m", "venv", "venv")
        done("`pip install ncgear`", python, "-m", "pip", "install", "--no-compile", str(ROOT))
        done("`ncgear new --example pusher`", ncgear, "new", "--example", "pusher")
        done("the first `ncgear build pusher.yaml`", ncgear, "build", "pusher.yaml")
        done("the second `ncgear build pusher.yaml`", ncgear, "build", "pusher.yaml")
        found = json.loads(subprocess.check_output([python, "-c", SIZES], env=environment))
    sizes = {name: size for name, size in found.items() if name not in ("pip", "setuptools")}
    (ROOT / "benchmarks" / "first-gears.md").write_text(page(times, sizes), encoding="utf-8")


if __name__ == "__main__":
    main()
