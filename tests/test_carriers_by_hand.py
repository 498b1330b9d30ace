"""Forces of teeth and axes on a carrier by the balance of each gear, by hand."""

from __future__ import annotations

from math import pi, radians, tan
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ncgear.trains.loads as loads
from ncgear.trains.loads import PutMass
from ncgear.trains.train import GROUND, GearMesh, Part, Poses, Train

Made: Any = SimpleNamespace


@pytest.mark.judges("trains")
def test_teeth_and_axes_of_round_gears_on_a_carrier_bear_what_their_masses_need(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A sun of 20 mm, an idler of 10 and a planet of 20 that does not turn, beside it a pinion of 20 in a ring of 60.

    Masses beside the axes; the moment about an axis is a tangential force, beside which teeth push away from their
    own gear by tan(20 deg).
    """
    square = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    fixed = {"sun": GROUND, "ring": GROUND}
    names = ["carrier", "sun", "idler_2", "planet", "pinion", "ring"]
    at, turns = np.array([0.0, 0.0, 30.0, 60.0, 40.0, 0.0]), np.array([1.0, 0.0, 3.0, 0.0, -2.0, 0.0])

    def poses(phi: Any) -> Poses:
        places = at[:, None] * np.exp(1j * phi)
        return Poses(places.real, places.imag, turns[:, None] * phi)

    parts = tuple(Part(name, square, 1.0, fixed_to=fixed.get(name, "")) for name in names)
    meshes = (GearMesh("sun", "idler_2"), GearMesh("idler_2", "planet"), GearMesh("pinion", "ring"))
    train = Train(parts, meshes, poses, "carrier", 2.0 * pi, 90.0, 0.01, Made())
    kg, beside = {"idler_2": 2.0, "planet": 3.0, "pinion": 1.5}, {"idler_2": 2j, "planet": 5.0, "pinion": -4.0}
    put = [PutMass(name, complex(beside[name]), kg[name]) for name in kg]
    gravity = -9810j
    monkeypatch.setattr(loads, "POSITIONS", 96)
    found = loads.joint_forces(train, radians(20.0), 1e-9, put, gravity)

    phi, speed = np.linspace(0.0, 2.0 * pi, 96, endpoint=False), 3.0 * pi
    out, needed, moment = np.exp(1j * phi), {}, {}
    for name in kg:
        number = names.index(name)
        arm = beside[name] * np.exp(1j * turns[number] * phi)
        needed[name] = kg[name] * (-(at[number] * out + turns[number] ** 2 * arm) * speed**2 - gravity)
        moment[name] = (arm.conj() * needed[name]).imag

    def pushed(along: Any, away: float) -> Any:
        return out * (1j * along + away * np.abs(along) * tan(radians(20.0)))

    on_planet = -moment["planet"] / 20.0
    on_idler = -moment["idler_2"] / 10.0 - on_planet
    on_pinion = moment["pinion"] / 20.0
    from_sun, from_idler, from_ring = pushed(on_idler, 1.0), pushed(on_planet, 1.0), pushed(on_pinion, -1.0)
    teeth = {("sun", "idler_2"): from_sun, ("idler_2", "planet"): from_idler, ("pinion", "ring"): -from_ring}
    axes = {"planet": needed["planet"] - from_idler, "pinion": needed["pinion"] - from_ring}
    axes["idler_2"] = needed["idler_2"] - from_sun + from_idler
    assert found.teeth_n.keys() == teeth.keys()
    assert found.axes_n.keys() == axes.keys()
    for mesh, force in teeth.items():
        assert found.teeth_n[mesh] == pytest.approx(force / 1e3, abs=1e-6 * np.abs(force).max() / 1e3)
    for name, force in axes.items():
        assert found.axes_n[name] == pytest.approx(force / 1e3, abs=1e-6 * np.abs(force).max() / 1e3)
    assert found.largest_n()[1]["idler"] == pytest.approx(np.abs(axes["idler_2"]).max() / 1e3)
    assert found.largest_n()[0]["idler and planet"] == pytest.approx(np.abs(from_idler).max() / 1e3)
