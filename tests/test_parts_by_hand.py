"""Machine parts and flanks by a few numbers that are done by hand: worse loads, thicker shafts, keys, shared edges."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ncgear.contact.placement import BACK, PUSHING
from ncgear.drivetrain.bearings import BearingLife
from ncgear.drivetrain.peaks import turned_back
from ncgear.drivetrain.shafts import ALLOWED_OF_YIELD
from ncgear.dynamics.history import meetings_s
from ncgear.errors import Unanswered, WrongInput
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import Extremum
from ncgear.pitch.shape import Gear
from ncgear.project import drivetrain, forces, sizing
from ncgear.project.face_load import FaceLoading
from ncgear.solids.helical.patches import _apart, _sharing_edges
from ncgear.strength import surfaces
from ncgear.strength.holding import Damage

Made: Any = SimpleNamespace


def life(load: float, largest: float) -> BearingLife:
    bearing: Any = Made()
    most, thrust = Extremum(largest, 1.0), Extremum(0.0, 0.0)
    return BearingLife(bearing, most, thrust, largest, load, 6.0, 10.0 * load, 1e4 / load, 100.0 / largest, True)


@pytest.mark.judges("project")
def test_of_two_loads_the_worse_of_each_part_counts() -> None:
    """A knock may unload a bearing over the cycle and press on it once: the shorter life and the larger force."""
    for law, knocks in ((life(30.0, 50.0), life(20.0, 90.0)), (life(20.0, 90.0), life(30.0, 50.0))):
        worse = drivetrain._worse_bearing(law, knocks)
        assert (worse.equivalent_n, worse.life_h) == (30.0, 1e4 / 30.0)
        assert (worse.largest_n.value, worse.static_safety) == (90.0, 100.0 / 90.0)


@pytest.mark.judges("project")
def test_loads_of_parts_grow_as_these_become_weaker() -> None:
    shaft = Made(fatigue=2.0, yielding=4.0)
    found: Any = Made(bearings=(life(30.0, 50.0), life(20.0, 90.0)), shaft=shaft, key=Made(pressure_mpa=70.0))
    assert drivetrain._sizes(found) == {
        "bearing_a_life": 30.0,
        "bearing_a_force": 50.0,
        "bearing_b_life": 20.0,
        "bearing_b_force": 90.0,
        "fatigue": 0.5,
        "yielding": 0.25,
        "key": 70.0,
    }
    bare: Any = Made(bearings=None, shaft=None, key=None)
    assert drivetrain._sizes(bare) == {}
    jammed: Any = Made(static_n=(5.0, 6.0), yielding=2.0)
    key: Any = Made(pressure_mpa=70.0)
    assert drivetrain._sizes_in_jam(jammed, key) == {
        "bearing_a_force": 5.0,
        "bearing_b_force": 6.0,
        "yielding": 0.5,
        "key": 70.0,
    }


@pytest.mark.judges("project")
@pytest.mark.parametrize(("fatigue", "enough"), [(0.3, True), (2.0, False), (1e-5, False)])
def test_a_shaft_that_is_too_thin_grows_until_it_holds(fatigue: float, enough: bool) -> None:
    """Safeties that go with the third power of 40 mm: the least that holds is 40 (s/0.3)^(1/3)."""

    def of_diameter(diameter: float) -> Any:
        return Made(fatigue=fatigue * (diameter / 40.0) ** 3, yielding=9.0 * (diameter / 40.0) ** 3)

    found = drivetrain._thick_enough_mm(of_diameter, 40.0, of_diameter(40.0))
    if not enough:
        assert found is None
    else:
        assert found is not None
        exact = 40.0 * (drivetrain.LEAST_SAFETY / fatigue) ** (1.0 / 3.0)
        assert exact * (1.0 - 1e-9) <= found <= drivetrain.GROWN * exact


@pytest.mark.judges("project")
def test_a_shaft_is_in_its_first_position_again_after_as_many_cycles_as_its_gear_has_lobes() -> None:
    machine = Made(transmission=Made(lobes=Made(driving=3)))
    first = Made(mesh=Made(sense=-1.0), driven_sense=-1.0)
    cycle: Any = Made(rigid=Made(places=(first,), machine=machine), cycle_rad=2.0 * pi / 3.0)
    thirds = np.arange(3) * 2.0 * pi / 3.0
    assert turned_back(cycle, 0)[:, 0] == pytest.approx(np.cos(thirds) - 1j * np.sin(thirds))
    assert turned_back(cycle, 1).tolist() == [[1.0]]


@pytest.mark.judges("project")
def test_a_key_bears_over_its_height_in_the_hub() -> None:
    """A keyway 3.4 mm deep leaves 3 mm beside the play; 60 N m on 40 mm of diameter and 20 mm of length are 50 MPa."""

    def key(
        depth: float | None = 3.4,
        height: float | None = None,
        yield_mpa: float | None = None,
        length: float | None = None,
    ) -> Any:
        keyway = None if depth is None else Made(depth_mm=depth)
        given = Made(key=Made(height_mm=height, length_mm=length, yield_mpa=yield_mpa))
        body = Made(keyway=keyway, hub=Made(height_mm=6.0))
        design: Any = Made(
            gears=Made(driving=body, driven=Made(keyway=None), face_width_mm=20.0, hub_mm=lambda gear: 6.0),
            shafts=[("driving shaft", "driving_shaft", given)],
            gears_on=lambda number: ("driving",),
        )
        section: Any = Made(yield_mpa=300.0, diameter_mm=40.0)
        return drivetrain._key(design, 0, section, [(-1e4, 6e4)])

    free = drivetrain.FREE_HEIGHT_MM
    pressure = 60_000.0 / (20.0 * (3.4 - free) * 20.0)
    assert key().pressure_mpa == pytest.approx(pressure)
    assert key(height=3.4 - free, depth=None).pressure_mpa == pytest.approx(pressure)
    assert key().safety == pytest.approx(ALLOWED_OF_YIELD * 300.0 / pressure)
    assert key(yield_mpa=150.0).safety == pytest.approx(key().safety / 2.0)
    assert key(yield_mpa=900.0).safety == pytest.approx(key().safety)
    assert key().both_senses
    assert key(length=26.0).pressure_mpa == pytest.approx(pressure * 20.0 / 26.0)
    for depth in (None, free, 0.5 * free):
        with pytest.raises(WrongInput):
            key(depth=depth)


@pytest.mark.judges("project")
def test_all_contacts_of_a_position_press_together() -> None:
    """Two contacts of one position bear 30 N and 5 N with 7 and 1 N/mm over 10 mm; backs push the other way."""
    contacts: Any = Made(
        position=np.array([0, 0, 2]),
        force_n=np.array([30.0, 5.0, 8.0]),
        stiffness_n_mm=np.array([7.0, 1.0, 4.0]),
        phi1_rad=np.array([0.1, 0.1, 0.3]),
        side=np.array([PUSHING, PUSHING, BACK]),
    )
    loading: Any = Made(model=Made(width_mm=10.0), pressing=lambda *given: given)
    phi1, urge, force, stiffness, application, shaken = FaceLoading.loads_of(
        loading, contacts, 1.25, np.array([1.1, 1.1, 1.4])
    )
    assert force.tolist() == [35.0, 0.0, 8.0]
    assert stiffness == pytest.approx([0.8, 0.0, 0.4])
    assert (phi1.tolist(), urge.tolist()) == ([0.1, 0.0, 0.3], [1.0, 1.0, -1.0])
    assert (application, shaken.tolist()) == (1.25, [1.1, 1.0, 1.4])


@pytest.mark.judges("solids")
def test_patches_share_edges_but_for_rounding() -> None:
    poles = np.arange(2 * 4 * 3 * 3, dtype=float).reshape(2, 4, 3, 3)
    poles[0, -1], poles[1, -1] = poles[1, 0] + 1e-9, poles[0, 0] - 1e-9
    shared = _sharing_edges(poles, 1e-6)
    assert (shared[0, -1] == poles[1, 0]).all()
    assert (shared[1, -1] == poles[0, 0]).all()
    assert (shared[:, :-1] == poles[:, :-1]).all()
    with pytest.raises(Unanswered):
        _sharing_edges(poles, 1e-12)


@pytest.mark.judges("solids")
def test_surfaces_are_apart_from_sections_by_their_largest_distance(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("ncgear.solids.helical.patches._points", lambda curves, height, share: curves)
    exact = np.zeros((2, 3, 3))
    found: Any = lambda height: np.full((3, 2, 3), height)  # noqa: E731
    off = exact + 1.0
    off[1, 2] += [3.0, 0.0, 4.0]
    assert _apart(found, [(0.0, exact), (1.0, off)], np.zeros(3)) == pytest.approx(5.0)


@dataclass
class Touching:
    """Contacts by their columns."""

    phi1_rad: np.ndarray

    def on(self, gear: Gear) -> Any:
        """Teeth 1, 2, 3 of the driving gear on 4, 5, 6 of the driven one."""
        return Made(tooth=np.array([1, 2, 3]) + (3 if gear is Gear.DRIVEN else 0))


@pytest.mark.judges("strength")
def test_the_place_of_the_largest_value_is_that_of_its_teeth() -> None:
    touching: Any = Touching(np.array([0.1, 0.2, 0.3]))
    told = surfaces._place(touching, np.array([3.0, 7.0, -1.0]))
    assert (told.value, told.phi1_rad) == (7.0, 0.2)
    assert sorted(vars(told).values()) == sorted([7.0, 0.2, 2, 5])
    nowhere = surfaces._place(touching, np.array([-1.0, -1.0, -1.0]))
    assert sorted(vars(nowhere).values()) == sorted([0.0, 0.0, 1, 1])


@pytest.mark.judges("dynamics")
def test_flanks_that_meet_exactly_at_a_sample_are_found() -> None:
    """|t - 2| - 1 is zero at 1 and 3, with a sample there and without; t^2 only touches zero, from above or below."""

    def apart(time_s: Array) -> Array:
        return np.abs(time_s - 2.0) - 1.0

    for samples in (np.arange(5.0), np.arange(0.3, 4.0), np.array([0.0, 1.0, 2.0, 3.5])):
        assert meetings_s(apart, samples) == pytest.approx([1.0, 3.0], abs=1e-12)
        assert meetings_s(lambda time_s: -apart(time_s), samples) == pytest.approx([1.0, 3.0], abs=1e-12)
    assert meetings_s(lambda time_s: -(time_s**2), np.arange(-2.0, 3.0)).size == 0
    assert set(meetings_s(np.square, np.arange(-2.0, 3.0))) == {0.0}


@pytest.mark.judges("strength")
def test_wear_follows_the_mean_load_and_both_flanks_of_a_side_add_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Dry: 2000 and 1000 meetings of 1e-6 and 3e-6 mm at even load; a load shaken by 1.5 wears a 1.5th of its depth."""
    monkeypatch.setattr(surfaces, "depth_mm", lambda pressed, share, _: np.array([[1e-6], [3e-6]]) * share)
    pair: Any = Made(
        oil=None,
        conditions=Made(life_h=10.0),
        running=Made(meetings=lambda hours: np.array([200.0, 100.0]) * hours),
        coefficients_mm3_n_m=None,
    )
    found = surfaces._Pair.quantities(
        pair, np.array([PUSHING, BACK]), np.array([1.0, 1.5]), Made(line_n_mm=np.array([5.0, 6.0]))
    )
    assert found[:2].tolist() == [[0.0, 0.0], [0.0, 0.0]]
    assert found[2:4] == pytest.approx(np.array([[2e-3, 2e-3 / 1.5], [3e-3, 3e-3 / 1.5]]))
    assert found[4:] == pytest.approx(np.array([[5e-3, 0.0], [0.0, 5e-3 / 1.5]]))


@pytest.mark.judges("strength")
def test_plastics_creep_by_the_time_that_a_tooth_is_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    """1.5 teeth share a load at every position; of 10 teeth each is loaded 0.15 of 100 h; the softer one counts."""
    asked: list[float] = []
    monkeypatch.setattr(surfaces, "Plastic", Made)
    monkeypatch.setattr(surfaces, "creep_factor", lambda name, hours: asked.append(hours) or name)
    contacts = Made(
        position=np.array([0, 1, 1, 2]),
        share=np.array([1.0, 1.0, 1.0, 9.0]),
        force_n=np.array([10.0, 30.0, 20.0, 5.0]),
        stiffness_n_mm=np.array([100.0, 100.0, 1000.0, 100.0]),
    )
    loading: Any = Made(still=None, contacts=contacts, even=np.array([True, True, False]))
    choices: Any = Made(entry=Made(name=2.0)), Made(entry=Made(name=3.0))
    running: Any = Made(teeth=(10, 15))
    found = surfaces._creep(loading, choices, Made(life_h=100.0), running)
    assert found is not None
    assert asked == pytest.approx([15.0, 15.0])
    assert sorted(vars(found).values()) == pytest.approx([0.3, 0.9, 15.0])


@pytest.mark.judges("project")
@pytest.mark.parametrize(
    ("damage", "factor"), [(Damage.BENDING, 1.0 / (0.8 * 1.5 * 2.0)), (Damage.CONTACT, 1.0 / 1.2**2)]
)
def test_a_face_is_wider_by_what_its_stress_lacks(damage: Damage, factor: float) -> None:
    """Four fifths of the wanted safety on curves 1.5 times as large with twice the module."""
    one: Any = Made(damage=damage, share=0.8)
    assert sizing._wider(one, 1.5, 2.0) == pytest.approx(factor)


@pytest.mark.judges("project")
def test_a_width_is_guessed_from_the_nearest_gears_by_the_tooth_that_needs_most() -> None:
    """Of 20 mm: bending asks for 1/(0.5 x 1 x 2), wear for 1/(0.4 x 1 x 2); five modules at least."""
    near = gears(20, 2.0, 20.0)
    search: Any = Made(computed=[gears(40, 2.0, 9.0), near], widths_mm=lambda module: (5.0 * module, np.inf))
    search.nearest = lambda teeth, module: near
    search.scale = lambda teeth, module: sizing._Search.scale(search, teeth, module)
    assert search.scale(20, 4.0) == pytest.approx(1.0)
    # From 20 teeth of 2 mm to 20 of 4 mm the pitch curves are twice as large, and the module.
    bending, wear = 20.0 / (0.5 * 2.0 * 2.0), 20.0 / (0.4 * 2.0 * 2.0)
    assert sizing._Search.width(search, 20, 4.0) == max(np.ceil(max(bending, wear)), 20.0)
    assert sizing._Search.width(search, 20, 2.0) == np.ceil(20.0 / 0.4)
    # K_Hbeta 1.2 grows with the width: b/(1 + 0.2 b) is 2.5/1.2 at 3.571 times the width, and 2/1.2 at 2.5 times.
    near.uneven = 1.2
    assert sizing._Search.width(search, 20, 2.0) == 72.0
    near.rating.holds = False
    assert sizing._Search.width(search, 20, 2.0) == 50.0


def gears(teeth: int, module: float, width: float, uneven: float = 1.0) -> Any:
    """Gears whose roots have half of the wanted safety, and their flanks two fifths of that against wear."""
    weakest = [Made(damage=Damage.BENDING, share=0.5)]
    rating = Made(weakest=weakest, holds=True)
    return Made(teeth=teeth, module_mm=module, face_width_mm=width, rating=rating, flank_share=0.4, uneven=uneven)


@pytest.mark.judges("project")
@pytest.mark.parametrize("sections", [1, 4])
def test_a_share_of_the_critical_damping_follows_from_stiffness_and_mass(sections: int) -> None:
    """2 sqrt(k m) of 200 N/mm in all and 9 N s2/mm3 on an arm of 30 mm; in sections of helical teeth its part each."""
    gaps = Made(touching_levers_mm=np.array([30.0]), touching_stiffness=np.array([200.0 / sections]), sections=sections)
    impact = Made(exponent=1.5, full_damping_depth_mm=0.04, damping_n_s_mm=0.0)
    given: Any = Made(damping_n_s_mm=None, damping_ratio=0.1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(forces, "replace", lambda one, **changes: Made(**{**vars(one), **changes}))
        meshing: Any = Made(gaps=gaps, impact=impact)
        found = forces.damped(given, meshing, 9.0 * 900.0).impact.damping_n_s_mm
        given.damping_n_s_mm = 1.0
        assert forces.damped(given, meshing, 1.0) is meshing
    # At the depth of full damping the slope of a force d^1.5 is 1.5 d^0.5.
    assert found == pytest.approx(0.1 * 2.0 * (200.0 * 1.5 * 0.2 * 9.0) ** 0.5 / sections)
