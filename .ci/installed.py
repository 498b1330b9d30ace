"""Every command of an installed ncgear, from a foreign folder: .ci/installed.py PROGRAM, with no checkout on its path.

Each has to end with the status that it should have: 0, or 2 where an extra is missing, told before any work.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

DESIGNS = "pusher", "ellipse", "pump-1-2", "rocker-drive", "oval-flow-meter"

EACH = ("check {0}", "build {0} --format dxf")
"""Commands of every design."""

ONCE = """
--version | examples | explain gears.module_mm | schema | reproduce | new mine --law ellipse | formulas pusher.yaml
strength pump-1-2.yaml | report ellipse.yaml | animate ellipse.yaml | compare pusher.yaml ellipse.yaml
simulate baler-dynamics.yaml | tolerance ellipse.yaml --samples 64 | size pusher.yaml | bench uniform-crank.yaml
balance balance/threshing-drum.yaml
"""

EXTRAS = {
    "optimize pusher.yaml": "optimize",
    "frontier pusher.yaml": "optimize",
    "build ellipse.yaml --format step": "step",
    "animate ellipse.yaml --out film.mp4": "video",
    "studio ellipse.yaml": "studio",
    "sweep pusher.yaml --vary linkage.rod_mm=200:240:3": "sweep",
}
"""Commands that need an extra, which an installation without any does not have."""

SOON_S = 4.0
"""Time in which a missing extra is told, on a machine that is three times slower than usual."""


def main() -> None:
    """Run all; a line for each that ends otherwise than it should."""
    program, wrong = Path(sys.argv[1]).absolute(), 0
    environment = {"PATH": os.environ["PATH"], "PYTHONIOENCODING": "cp1252", "LANG": "C"}
    with TemporaryDirectory(suffix="-\u017elut\u00fd k\u016f\u0148") as folder:

        def ends(arguments: str, status: int, said: str = "") -> bool:
            begun = time.monotonic()
            found = subprocess.run([program, *arguments.split()], cwd=folder, env=environment, capture_output=True)
            took, err = time.monotonic() - begun, found.stderr.decode("cp1252")
            right = found.returncode == status and said in err and (not said or took < SOON_S)
            print(f"{'' if right else 'WRONG: '}{arguments}: {found.returncode} in {took:.1f} s", flush=True)
            if not right:
                print(err)
            return right

        for name in (*DESIGNS, "baler-dynamics", "uniform-crank", "balance/threshing-drum"):
            wrong += not ends(f"new --example {name}", 0)
        for name in DESIGNS:
            for arguments in EACH:
                wrong += not ends(arguments.format(f"{name}.yaml"), 0)
        for arguments in re.split(r"[|\n]", ONCE.strip()):
            wrong += not ends(arguments.strip(), 0)
        for arguments, extra in EXTRAS.items():
            wrong += not ends(arguments, 2, f"ncgear[{extra}]")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
