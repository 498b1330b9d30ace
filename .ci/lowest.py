"""Print the lowest version that pyproject.toml allows of each library, as constraints for pip."""

import re
import sys
import tomllib
from pathlib import Path

project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
for wanted in [*project["dependencies"], *project["optional-dependencies"]["dev"]]:
    found = re.fullmatch(r"([\w.-]+)>=([\w.]+)", wanted)
    if found is None:
        sys.exit(f"pyproject.toml: {wanted!r} has no lowest version")
    print("{}=={}".format(*found.groups()))
