"""Optional libraries, which a part of ncgear needs and most users do not."""

from __future__ import annotations

from importlib.util import find_spec

from ncgear.errors import WrongInput


def require(library: str, extra: str, purpose: str) -> None:
    """Refuse to go on without a library, naming the command that installs it; raises WrongInput."""
    if find_spec(library) is None:
        raise WrongInput(
            f"needs {library}, which is not installed; python -m pip install 'ncgear[{extra}]' installs it", key=purpose
        )
