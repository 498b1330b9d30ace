"""The pictures of a build, each as PNG bytes."""

from ncgear.output.plots.curves import motion, power
from ncgear.output.plots.mesh import contact
from ncgear.output.plots.pairs import Assembled, Position, pitch_curves, tooth_pair, turned

__all__ = ["Assembled", "Position", "contact", "motion", "pitch_curves", "power", "tooth_pair", "turned"]
