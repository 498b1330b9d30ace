"""What a person is told of a fault, whatever it is; the conversation goes on after it."""

from __future__ import annotations

from ncgear.errors import DesignError


def words_of(error: Exception) -> str:
    """A fault of the design or of a file in its own words; any other is one of ncgear."""
    match error:
        case DesignError():
            return str(error)
        case OSError(strerror=str(reason), filename=name):
            return f"{name}: {reason}" if name else reason
    return f"internal fault: {type(error).__name__}: {error}; please report"
