"""The rigid level: all that inverse dynamics tells of a machine at constant driving speed."""

from __future__ import annotations

from dataclasses import dataclass

from ncgear.dynamics.fluctuation import Fluctuation, fluctuation
from ncgear.dynamics.inverse import RigidMachine
from ncgear.dynamics.locking import refuse_locked
from ncgear.dynamics.peaks import LoadPeaks, load_peaks


@dataclass(frozen=True, eq=False)
class Rigid:
    """A machine, its peaks and what its torque swings; curves are ``machine.at``."""

    machine: RigidMachine
    peaks: LoadPeaks
    fluctuation: Fluctuation


def rigid_level(machine: RigidMachine) -> Rigid:
    """Peaks and torque swing of a machine; raises NoSuchMechanism where its teeth cannot hold the torque."""
    refuse_locked(machine)
    return Rigid(machine, load_peaks(machine), fluctuation(machine))
