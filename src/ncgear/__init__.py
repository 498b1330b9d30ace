"""ncgear: non-circular gears from the motion of a slider."""

__version__ = "0.1.0"
