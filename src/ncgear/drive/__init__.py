"""The drive: one design, whose stages are computed when they are first asked for, and once."""

from ncgear.drive.drive import Drive

__all__ = ["Drive"]
