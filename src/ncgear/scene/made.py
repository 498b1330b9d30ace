"""The scene of a drive."""

from __future__ import annotations

from ncgear.drive import Drive
from ncgear.scene.chamber import chamber_of
from ncgear.scene.gears import scene_pairs
from ncgear.scene.scene import Scene


def scene_of(drive: Drive) -> Scene:
    """The machine of a design, with its gears where the design tells them; of two stages, both pairs.

    Raises WrongInput or NoSuchMechanism where law, pitch curves or teeth cannot be made, or teeth do not mesh.
    """
    machine = drive.machine
    resistance = None if drive.design.resistance is None else machine.resistance
    chamber = chamber_of(drive.linkage, resistance)
    return Scene(drive.design.name, machine, drive.law.train, scene_pairs(drive), chamber)
