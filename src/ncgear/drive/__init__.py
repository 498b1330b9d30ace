"""The drive: one design, whose stages are computed when they are first asked for, and once."""

from ncgear.drive.drive import Drive
from ncgear.drive.load import load, loads

__all__ = ["Drive", "load", "loads"]
