"""Backlash by turning: the angle of play by closed forms, who takes it off, and which pairs may have it."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from functools import cache
from math import cos, degrees, pi, radians
from re import search
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from drives import MACHINES, design_of, loaded
from engaged import LAWS, RINGS
from ncgear.errors import DesignError, NoSuchMechanism
from ncgear.figures.advice.teeth_advice import contact_ratio, idle_flanks
from ncgear.figures.advice.values import Kind
from ncgear.numerics.arrays import Array
from ncgear.pitch.pair import PitchPair, sized_pair
from ncgear.pitch.shape import Mesh
from ncgear.project.drive import Drive
from ncgear.ratio.transmission import Transmission
from ncgear.teeth.backlash import play_of
from ncgear.teeth.form import Backlash
from pairs import rack

ALPHA = radians(20.0)

Data = dict[str, Any]

# --- the angle ---------------------------------------------------------------------------------------------------


@cache
def pitch_of(name: str, teeth: int = 40) -> PitchPair:
    """Pitch curves of module 2, of a ring for the laws of rings."""
    law: Callable[[], Transmission] = (RINGS | LAWS)[name]
    return sized_pair(law(), teeth, 2.0, None, Mesh.INTERNAL if name in RINGS else Mesh.EXTERNAL)


@pytest.mark.judges("teeth")
@pytest.mark.tiers(quick=["uniform*"], rest="slow")
@pytest.mark.parametrize(
    ("name", "teeth", "driven_mm"),
    [("uniform", 30, 30.0), ("uniform 1:2", 24, 48.0), ("uniform 3:2", 30, 20.0), ("ring 1:2", 30, 60.0)],
)
def test_play_of_circular_gears_is_the_normal_backlash_over_the_base_radius(
    name: str, teeth: int, driven_mm: float
) -> None:
    play = play_of(pitch_of(name, teeth), rack(), Backlash(0.07))
    assert play.driven_rad == pytest.approx(0.07 / (driven_mm * cos(ALPHA)), rel=1e-12)
    assert play.least_normal_mm.value == pytest.approx(0.07, rel=1e-12)
    assert play.largest_normal_mm.value == pytest.approx(0.07, rel=1e-12)
    # Half of it on the driving gear; a flank that is set back by t along the curve leaves t cos(alpha) free.
    assert play.setback_mm * cos(ALPHA) == pytest.approx(0.035, rel=1e-12)


def arms(pitch: PitchPair, phi1: Array) -> Array:
    """|P x n| of idle flanks about the driven axis, from the driven curve's own points.

    The idle flanks of the driven gear are its back ones.  Their normals lean from the tangent by the rack's angle,
    towards the side that pushes the gear back: out of the gear on an external one, into the material of a ring.
    """
    at = pitch.driven.at_angle(phi1)
    normal = -cos(ALPHA) * at.tangent + np.sin(ALPHA) * at.normal
    return np.abs(at.position[..., 0] * normal[..., 1] - at.position[..., 1] * normal[..., 0])


def least_and_largest(pitch: PitchPair) -> tuple[float, float]:
    """Extremes of the arm over the cycle: the best of a dense row of angles, and then between its neighbours."""
    cycle = pitch.driving.periods * pitch.transmission.lobes.driving_period_rad
    phi1 = np.linspace(0.0, cycle, 20_001)
    found = []
    for sign in (1.0, -1.0):
        value = sign * arms(pitch, phi1)
        worst = int(np.argmin(value))
        near = minimize_scalar(
            lambda phi, sign=sign: float(sign * arms(pitch, np.array([phi]))[0]),
            bounds=(phi1[max(worst - 1, 0)], phi1[min(worst + 1, phi1.size - 1)]),
            method="bounded",
            options={"xatol": 1e-10},
        )
        found.append(sign * min(float(near.fun), float(value[worst])))
    return found[0], found[1]


@pytest.mark.tiers(quick=["sine", "ellipse"], rest="thorough")
@pytest.mark.parametrize("name", ["ellipse", "long ellipse", "sine", "deep sine", "baler", "ring"])
def test_play_is_the_normal_backlash_over_the_least_arm_of_idle_flanks(name: str) -> None:
    pitch = pitch_of(name)
    play, (least, largest) = play_of(pitch, rack(), Backlash(0.05)), least_and_largest(pitch)
    assert play.driven_rad == pytest.approx(0.05 / least, rel=1e-9)
    assert play.largest_normal_mm.value == pytest.approx(0.05 * largest / least, rel=1e-9)
    for extreme in (play.least_normal_mm, play.largest_normal_mm):
        assert arms(pitch, np.array([extreme.at]))[0] * play.driven_rad == pytest.approx(extreme.value, rel=1e-6)


@pytest.mark.parametrize("name", ["sine", "ellipse"])
def test_the_arm_of_pushing_flanks_is_another(name: str) -> None:
    """Negative control: with the normal of the other side the play would be a different one."""
    pitch = pitch_of(name)
    at = pitch.driven.at_angle(np.linspace(0.0, 2.0 * pi, 2001))
    normal = cos(ALPHA) * at.tangent + np.sin(ALPHA) * at.normal
    pushing = np.abs(at.position[:, 0] * normal[:, 1] - at.position[:, 1] * normal[:, 0])
    phi1 = play_of(pitch, rack(), Backlash(0.05)).least_normal_mm.at
    assert pushing[int(phi1 / (2.0 * pi) * 2000)] > 1.03 * least_and_largest(pitch)[0]


@pytest.mark.parametrize("name", ["uniform 1:2", "baler", "ring"])
def test_the_share_moves_the_flanks_and_not_the_play(name: str) -> None:
    plays = [play_of(pitch_of(name), rack(), Backlash(0.05, driving_share=share)) for share in (0.0, 0.5, 1.0)]
    assert len({play.driven_rad for play in plays}) == 1
    assert [play.setback_mm * cos(ALPHA) for play in plays] == pytest.approx([0.0, 0.025, 0.05], rel=1e-12)


def test_an_angle_is_taken_as_it_is() -> None:
    pitch = pitch_of("deep sine")
    play = play_of(pitch, rack(), Backlash(driven_rad=radians(0.2)))
    assert degrees(play.driven_rad) == pytest.approx(0.2, rel=1e-15)
    assert play.least_normal_mm.value == pytest.approx(radians(0.2) * least_and_largest(pitch)[0], rel=1e-9)


# --- the file ----------------------------------------------------------------------------------------------------


def with_gears(name: str, **gears: Any) -> Data:
    """The values of a worked design with other gears."""
    data = deepcopy(loaded(name).data)
    data["gears"] |= gears
    return data


def drive_of(data: Data) -> Drive:
    return Drive(design_of(data))


def test_a_file_may_give_the_angle() -> None:
    data = with_gears("ellipse", backlash_deg=0.15)
    del data["gears"]["backlash_mm"]
    assert degrees(drive_of(data).play.driven_rad) == pytest.approx(0.15, rel=1e-12)


def test_a_file_that_gives_both_is_refused() -> None:
    with pytest.raises(
        (DesignError, ValueError), match=r"backlash_mm: 0\.06 is given; leave out backlash_deg or backlash_mm"
    ):
        drive_of(with_gears("ellipse", backlash_deg=0.15))


# --- which pairs may have it -------------------------------------------------------------------------------------

NO_TEETH = {"baler-frontier", "feeder-wishes", "feeder-kept", "jar-pusher", "baler-a1-at-law-speed"}
"""No gears are asked for, or no flank could turn its mate; see test_free_turning.py."""

WORKED = [name for name in MACHINES if name not in NO_TEETH]

DEEP_SINE: Data = {
    "name": "deep",
    "linkage": {"crank_mm": 40, "rod_mm": 150},
    "operation": {"speed_rpm": 60},
    "motion": {"law": "ratio_expression", "driven_angle": "phi - 0.3*sin(2*phi)"},
    "gears": {"teeth": 60, "module_mm": 2, "face_width_mm": 10},
}

DEEP_RING: Data = {
    **DEEP_SINE,
    "motion": {"law": "ratio_expression", "ratio": "2+0.5*cos(phi)", "scale_to_close": True},
    "gears": {
        "mesh": "internal", "lobes": {"driving": 1, "driven": 2}, "teeth": 40, "module_mm": 2, "face_width_mm": 10
    },
}  # fmt: skip


def require_contact(data: Data) -> None:
    """Raise unless the teeth can be made and their contact is sound."""
    for stage in drive_of(data).by_stage:
        _ = stage.designed_contact


@pytest.mark.tiers(
    thorough=["ellipse", "pump-1-2"],
    slow=[
        "baler-smooth",
        "pusher",
        "baler-66",
        "baler-dynamics",
        "baler-real",
        "internal-1-2",
        "printed-pump",
        "rocker-drive",
        "traced-egg",
    ],
    rest="long",
)
@pytest.mark.parametrize("name", WORKED)
def test_worked_designs_may_have_backlash(name: str) -> None:
    require_contact(with_gears(name, backlash_mm=0.05))


@pytest.mark.tiers(slow=["sine-0.4"], rest="long")
@pytest.mark.parametrize("backlash_mm", [0.0, 0.05, 0.4])
@pytest.mark.parametrize("data", [DEEP_SINE, DEEP_RING], ids=["sine", "ring"])
def test_deep_laws_may_have_backlash(data: Data, backlash_mm: float) -> None:
    """With much play, tips are turned to where no tip comes without it: into the bottoms of the mate's spaces."""
    data = deepcopy(data)
    data["gears"]["backlash_mm"] = backlash_mm
    require_contact(data)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("gears", "lacking"),
    [
        ({"least_contact_ratio": 1.2}, r"touch over 1\.16 pitches only, less than 1\.2"),
        ({"teeth": 21}, "no flanks touch at phi1 ="),
    ],
)
def test_idle_flanks_are_refused_only_where_they_must_hold(gears: Data, lacking: str) -> None:
    """The baler's pushing flanks hold where the backs of its teeth do not."""
    one_way = drive_of(with_gears("baler", backlash_mm=0.05, **gears))
    assert one_way.designed_contact.pushing.pairs.longest_gap == 0.0
    pushing, back = one_way.short_contacts
    assert pushing is None
    assert back is not None
    assert search(lacking, back)
    advice = idle_flanks(one_way)
    assert advice is not None
    assert advice.kind is Kind.IDLE_FLANKS
    assert search(lacking, advice.line)
    assert contact_ratio(one_way) is None
    with pytest.raises(NoSuchMechanism, match="idle flanks, which drives: both_ways asks to hold: .*" + lacking):
        _ = drive_of(with_gears("baler", backlash_mm=0.05, drives="both_ways", **gears)).designed_contact


@pytest.mark.thorough
def test_idle_flanks_that_hold_are_not_spoken_of() -> None:
    for drives in ("one_way", "both_ways"):
        sound = drive_of(with_gears("ellipse", drives=drives))
        assert sound.short_contacts == (None, None)
        assert idle_flanks(sound) is None
