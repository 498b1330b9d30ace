"""Gears in a row, where idlers mesh with two mates: laws in closed form and by quadrature, teeth by polygons."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import pairwise
from math import pi, radians

import numpy as np
import pytest
from mpmath import mp, mpf
from shapely import Polygon

import drives
from ncgear.errors import WrongInput
from ncgear.numerics.arrays import Array
from ncgear.pitch.shape import Gear
from ncgear.ratio.laws.ellipse import elliptical_law
from ncgear.ratio.laws.row import laws_in_series, row_laws
from ncgear.ratio.transmission import Lobes, Transmission
from ncgear.teeth.form import Backlash, ToothForm
from ncgear.trains.chain import PairRow, chain_train, row_of
from ncgear.trains.contact import contacts_of
from ncgear.trains.train import Poses, Train
from pairs import rack

SHAPE = "idler_radius: 5*cos(phi) + sqrt(40**2 - (5*sin(phi))**2)"

train_of = partial(drives.train_of, "idler-chain")


def made_row(
    first: Transmission, lobes: tuple[int, ...], directions_rad: tuple[float, ...], teeth: int, module_mm: float
) -> PairRow:
    return row_of(row_laws(first, lobes, directions_rad, "bends"), directions_rad, teeth, module_mm)


OTHERS = (
    ((SHAPE, "ratio: 1 + 0.25*cos(phi)"), ("bends_deg: [40, -70]", "bends_deg: [-35, 20]"), ("teeth: 36", "teeth: 40")),
    (
        (SHAPE, "ratio: 1 + 0.15*sin(2*phi)"),
        ("[1, 1, 1, 1]", "[2, 3, 2, 4]"),
        ("[40, -70]", "[50, 50]"),
        ("teeth: 36", "teeth: 48"),
    ),
)


@pytest.mark.judges("trains")
def test_elliptic_idlers_in_a_straight_row_square_the_ratio() -> None:
    """Ellipses about their foci turn with tan(theta / 2) = k tan(phi / 2); the idler's far side does so once more."""
    share = 0.3
    law = elliptical_law(share, 0.0, Lobes())
    row = made_row(law, (1, 1, 1, 1), (0.0, 0.0, 0.0), 40, 2.0)
    phi = np.linspace(0.1, 3.0, 9)
    first, second, third = np.tan(row.turned_rad(phi)[1:] / 2.0) / np.tan(phi / 2.0)
    factor = first[0]
    assert max(factor, 1.0 / factor) == pytest.approx((1.0 + share) / (1.0 - share), rel=1e-12)
    for found, power in ((first, 1), (second, 2), (third, 3)):
        assert found == pytest.approx(np.full(9, factor**power), rel=1e-9)
    assert [pair.center_distance_mm for pair in row.pairs] == pytest.approx([row.pairs[0].center_distance_mm] * 3)
    whole = laws_in_series([pair.transmission for pair in row.pairs]).whole
    turned = whole.driven_angle(phi, 2)
    assert np.tan(turned.value / 2.0) == pytest.approx(factor**3 * np.tan(phi / 2.0), rel=1e-9)
    slope = factor**3 / (np.cos(phi / 2.0) ** 2 + (factor**3 * np.sin(phi / 2.0)) ** 2)
    assert turned.derivative(1) == pytest.approx(slope, rel=1e-9)
    bend = slope**2 * (1.0 - factor**6) * np.sin(phi) / (2.0 * factor**3)
    assert turned.derivative(2) == pytest.approx(bend, abs=1e-7)


@pytest.mark.slow
@pytest.mark.judges("trains")
def test_mates_of_an_eccentric_idler_by_quadrature() -> None:
    """The idler's radius where it faces each mate, by its polar angle: 30 digits, without the code's laws."""
    train = train_of()
    offset, circle, bend = 5.0, 40.0, radians(40.0)
    alpha = np.array([1.1])
    poses = train.poses_at(alpha)
    axes = poses.x_mm[:, 0] + 1j * poses.y_mm[:, 0]
    distance = abs(axes[1] - axes[0])
    assert np.angle((axes[2] - axes[1]) / (axes[1] - axes[0])) == pytest.approx(bend, abs=1e-12)
    with mp.workdps(30):
        # Sizes as in the file; the module scales them.
        unit = mp.findroot(
            lambda a: mp.quad(lambda t: _ratio(t, a, offset, circle), [0, mp.pi, 2 * mp.pi]) - 2 * mp.pi, 80
        )

        def mate(at: mpf, face: float) -> mpf:
            """How far a mate turns while the idler turns by ``at``; the idler faces it at a polar angle later."""
            return mp.quad(lambda t: _ratio(t + face, unit, offset, circle), [0, at])

        first = float(poses.angle_rad[1, 0] - train.poses_at(np.zeros(1)).angle_rad[1, 0])
        assert first < 0.0
        assert float(mate(mpf(-first), 0.0)) == pytest.approx(1.1, abs=1e-9)
        turned = float(poses.angle_rad[2, 0] - train.poses_at(np.zeros(1)).angle_rad[2, 0])
        assert float(mate(mpf(-first), bend - pi)) == pytest.approx(turned, abs=1e-9)
    scale = 36 * pi * 2.0 / (2.0 * pi * circle)
    assert float(unit) * scale == pytest.approx(distance, rel=1e-9)


def _ratio(polar: mpf, distance: mpf, offset: float, circle: float) -> mpf:
    radius = offset * mp.cos(polar) + mp.sqrt(circle**2 - (offset * mp.sin(polar)) ** 2)
    return radius / (distance - radius)


def outlines_of(train: Train) -> dict[str, Array]:
    return {part.name: part.outline_mm for part in train.parts}


@pytest.mark.judges("trains")
@pytest.mark.slow
@pytest.mark.parametrize("changes", [(), *OTHERS])
def test_every_idler_meshes_with_both_of_its_mates(changes: tuple[tuple[str, str], ...]) -> None:
    """By polygons over a cycle; concave curves and lobes of all kinds, too."""
    train = train_of(changes)
    for found in contacts_of(train, outlines_of(train)):
        assert found.penetration_max_mm < train.tolerance_mm
        assert found.gap_max_mm < 3.0 * train.tolerance_mm


def turned(train: Train, angle_rad: float) -> Train:
    """The train with its last gear turned on."""

    def poses_at(driving_rad: Array) -> Poses:
        poses = train.poses_at(driving_rad)
        return replace(poses, angle_rad=poses.angle_rad + np.array([0.0, 0.0, 0.0, angle_rad])[:, None])

    return replace(train, poses_at=poses_at, meshes=train.meshes[-1:])


@pytest.mark.slow
def test_a_gear_half_a_pitch_off_clashes() -> None:
    train = train_of()
    (found,) = contacts_of(turned(train, pi / 36.0), outlines_of(train))
    assert found.penetration_max_mm > 0.1


@pytest.mark.slow
def test_the_last_gear_turns_on_freely_by_the_play() -> None:
    """0.08 mm along the normal, which is at most 42 mm from the axis."""
    train = train_of()
    free, over = (contacts_of(turned(train, -angle), outlines_of(train))[0] for angle in (0.07 / 42.0, 0.11 / 30.0))
    assert free.penetration_max_mm < train.tolerance_mm
    assert free.gap_max_mm > 0.02
    assert over.penetration_max_mm > train.tolerance_mm


def test_round_gears_are_a_plain_row() -> None:
    row = made_row(elliptical_law(0.0, 0.0, Lobes(2, 3)), (2, 3, 1), (0.0, 0.5), 20, 1.0)
    assert row.teeth == (20, 30, 10)
    assert np.abs(np.diff(row.axes_mm)) == pytest.approx([25.0, 20.0], rel=1e-9)
    assert row.turned_rad(np.array([0.6]))[:, 0] == pytest.approx([0.6, 0.4, 1.2], rel=1e-9)
    assert row.pairs[1].length_mm(Gear.DRIVING) == pytest.approx(row.pairs[0].length_mm(Gear.DRIVEN), rel=1e-9)


def test_the_teeth_of_a_bent_row_of_three_touch_and_stay_apart() -> None:
    """By polygons at places of their own: within the play, no overlap but by chords; half a pitch off they clash."""
    row = made_row(elliptical_law(0.15, 0.0, Lobes(1, 2)), (1, 2, 1), (0.3, 1.1), 24, 2.0)
    train = chain_train(row, ToothForm(rack(), backlash=Backlash(0.1)), 10.0, None, 60.0, 0.01)
    angles = np.array([0.1, 1.3, 2.9, 4.4])
    poses = train.poses_at(angles)

    def placed(number: int, place: int, off_rad: float = 0.0) -> Polygon:
        points = train.parts[number].outline_mm @ [1.0, 1.0j] * np.exp(1j * (poses.angle_rad[number, place] + off_rad))
        points = points + poses.x_mm[number, place] + 1j * poses.y_mm[number, place]
        return Polygon(np.stack([points.real, points.imag], axis=-1))

    for place in range(angles.size):
        gears = [placed(number, place) for number in range(3)]
        for one, other in pairwise(gears):
            assert one.intersection(other).area < 0.02
            assert one.distance(other) < 0.05
    off = placed(2, 0, pi / 24.0)
    assert off.intersection(placed(1, 0)).area > 0.5


def test_bends_that_are_not_those_of_the_idlers_are_refused() -> None:
    with pytest.raises(WrongInput, match="two idlers of 4 gears"):
        train_of((("[40, -70]", "[40]"),))
    with pytest.raises(WrongInput, match="only one of them can count"):
        train_of(((SHAPE, SHAPE + "\n  ratio: 1 + 0*phi"),))
