"""Optional libraries that some parts of ncgear need."""

from __future__ import annotations

from importlib.util import find_spec

from ncgear.errors import WrongInput


def installed(library: str) -> bool:
    """Whether a library can be imported."""
    return find_spec(library) is not None


def require(library: str, extra: str, purpose: str) -> None:
    """Raise WrongInput where a library is not installed; the message names the command that installs it."""
    if not installed(library):
        raise WrongInput(
            f"needs {library}, which is not installed; python -m pip install 'ncgear[{extra}]' installs it",
            location=purpose,
        )
