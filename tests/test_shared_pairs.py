"""A law shared out over pairs in series: ``gears.pairs``.

The judges are a whole law whose root has a closed form, the composition of all pairs, and round gears, which carry the
load of a single pair.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import pairwise
from math import inf

import mpmath
import numpy as np
import pytest

from drives import drive_of_text
from ncgear.errors import NoSuchMechanism, WrongInput
from ncgear.figures.summary.check_summary import stages_summary
from ncgear.project.drive import Drive
from ncgear.project.opened import _in_common, drive_like
from ncgear.project.safest_parts import safest_parts
from ncgear.project.strengthening import rating_of
from ncgear.strength.holding import worst

MACHINE = """\
name: shared
operation: {{speed_rpm: 60}}
motion: {law}
gears: {{teeth: 24, module_mm: 2, face_width_mm: 12, pairs: {pairs}{more}}}
resistance: {{expression_n_m: "{torque}"}}
"""
# The square of 1 + 0.3 cos phi has the mean 1.045.
SQUARE = '{law: ratio_expression, ratio: "1.045/(1 + 0.3*cos(phi))**2"}'
# The cube has the mean 1.135.
CUBE = '{law: ratio_expression, ratio: "1.135/(1 + 0.3*cos(phi))**3"}'
JOINTED = '{law: ratio_expression, ratio: "1 + 0.2*abs(sin(phi))", scale_to_close: true}'
EVEN = "{law: harmonic_ratio}"


@cache
def made(law: str, pairs: int, torque: str = "10", more: str = "") -> Drive:
    return drive_of_text(MACHINE.format(law=law, pairs=pairs, torque=torque, more=more))


@pytest.mark.parametrize(("law", "more"), [(SQUARE, ""), (CUBE, ", parts: [0.5, 1]")])
def test_the_root_of_a_power_has_a_closed_form(law: str, more: str) -> None:
    first, second = made(law, 2, more=more).law.train.pairs
    phi1 = np.linspace(0.0, 2.0 * np.pi, 90)
    angle = first.transmission.driven_angle(phi1, 3)
    assert angle.value == pytest.approx(phi1 + 0.3 * np.sin(phi1), abs=1e-14)
    for order, wanted in enumerate([1.0 + 0.3 * np.cos(phi1), -0.3 * np.sin(phi1), -0.3 * np.cos(phi1)], start=1):
        assert angle.derivative(order) == pytest.approx(wanted, abs=1e-13)
    between = angle.value
    assert second.shaft_rad(between + 4.0 * np.pi) == pytest.approx(phi1 + 4.0 * np.pi, abs=1e-13)
    assert second.speed(between) == pytest.approx(1.0 + 0.3 * np.cos(phi1), abs=1e-13)


@pytest.mark.thorough
def test_the_second_pair_has_the_derivatives_of_its_closed_form() -> None:
    """Its driven angle by the angle of the shaft between, which mpmath inverts and differentiates."""
    second = made(SQUARE, 2).law.train.pairs[1].transmission
    with mpmath.workdps(40):

        def driven(between: mpmath.mpf) -> mpmath.mpf:
            phi = mpmath.findroot(lambda x: x + mpmath.mpf("0.3") * mpmath.sin(x) - between, between)
            return phi + (
                mpmath.mpf("0.6") * mpmath.sin(phi) + mpmath.mpf("0.0225") * mpmath.sin(2 * phi)
            ) / mpmath.mpf("1.045")

        places = [0.4, 2.0, 3.3, 5.9]
        wanted = np.array([[float(mpmath.diff(driven, place, order)) for place in places] for order in range(4)])
    found = second.driven_angle(np.array(places), 3)
    for order in range(4):
        assert (found.value if order == 0 else found.derivative(order)) == pytest.approx(wanted[order], abs=1e-12)


@pytest.mark.parametrize("law", [SQUARE, JOINTED])
def test_all_pairs_together_make_the_whole_law_and_share_its_logarithm(law: str) -> None:
    drive = made(law, 4)
    phi1 = np.linspace(0.001, 6.28, 500)
    angles, logarithms, shaft = [phi1], [], phi1
    for number, pair in enumerate(drive.law.train.pairs):
        if number:
            assert pair.shaft_rad(shaft) == pytest.approx(phi1, abs=1e-13)
        turned = pair.transmission.driven_angle(shaft, 1)
        logarithms.append(np.log(turned.derivative(1)))
        shaft = turned.value
        angles.append(shaft)
    whole = drive.transmission.driven_angle(phi1, 1)
    assert shaft == pytest.approx(whole.value, abs=1e-13)
    wanted = np.log(whole.derivative(1)) / 4.0
    for one in logarithms:
        assert np.ptp(one - wanted) < 1e-12
    assert len(drive.law.train.pairs[0].transmission.pieces) == len(drive.transmission.pieces)


@pytest.mark.parametrize("count", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_pairs_share_a_law_at_equal_pressure_angles(count: int) -> None:
    """Judged by the angles of pitch curves in closed form, from speeds that the mean over a turn brings round."""
    wild = '{law: ratio_expression, ratio: "1/(1 + 0.6*cos(phi))**2", scale_to_close: true}'
    drive = made(wild, count, more=", sharing: pressure_angle")
    phi1 = np.linspace(0.0, 2.0 * np.pi, 20_001)
    base = 1.0 + 0.6 * np.cos(phi1)
    bend = 0.6 * np.sin(phi1) / base
    logarithms = [np.ptp(np.log(one.transmission.driven_angle(phi1, 1).derivative(1))) for one in drive.law.train.pairs]
    parts = 2.0 * np.cumsum(logarithms) / sum(logarithms)
    speeds = [np.ones_like(phi1), *(base**part / np.mean(base[1:] ** part) for part in parts)]
    steepest = [
        np.abs(part * bend / (before + after)).max()
        for part, (before, after) in zip(np.diff(parts, prepend=0.0), pairwise(speeds), strict=True)
    ]
    assert steepest == pytest.approx([steepest[0]] * count, rel=1e-5)
    told = [one.pitch.largest_pressure_angle_deg(0.0) for one in drive.by_stage]
    assert told == pytest.approx(np.degrees(np.arctan(steepest)), rel=1e-5)
    assert max(told) < 0.9 * max(one.pitch.largest_pressure_angle_deg(0.0) for one in made(wild, count).by_stage)


def test_safest_parts_of_pressures_in_closed_form() -> None:
    """Safeties of flanks go as the root of a load over a curvature radius; here all change linearly with the part."""
    asked = list[tuple[float, ...]]()

    def pressed(*lines: tuple[float, float]) -> Callable[[tuple[float, ...], int], float]:
        def share(parts: tuple[float, ...], pair: int) -> float:
            asked.append(parts)
            load, more = lines[pair]
            if parts[0] <= 0.1 and pair:
                raise NoSuchMechanism("no teeth", key="gears")
            return 1.0 / (load + more * parts[pair]) ** 0.5

        return share

    def judged(*lines: tuple[float, float]) -> None:
        even = (1.0 + sum(load / more for load, more in lines)) / sum(1.0 / more for _, more in lines)
        share, asked[:] = pressed(*lines), []
        parts = safest_parts(share, len(lines))
        assert sum(parts) == pytest.approx(1.0)
        assert min(share(parts, pair) for pair in range(len(lines))) == pytest.approx(even**-0.5, rel=0.004)

    judged((1.0, 0.7), (1.4, 0.5))
    assert len(asked) < 50
    judged((1.0, 0.7), (1.1, 0.5), (1.05, 0.9))
    # Pair 2 is the safer whatever part pair 1 takes; pair 1 is safest with the greatest.
    assert safest_parts(lambda parts, pair: 1.2 if pair else 1.0 + 0.1 * parts[0], 2)[0] > 0.9
    refusal = NoSuchMechanism("no teeth", key="gears")

    def refused(_parts: tuple[float, ...], _pair: int) -> float:
        raise refusal

    with pytest.raises(NoSuchMechanism, match="no teeth"):
        safest_parts(refused, 2)
    with pytest.raises(WrongInput, match="the teeth carry no load"):
        safest_parts(lambda _parts, _pair: inf, 2)


@pytest.mark.slow
@pytest.mark.parametrize(("count", "bend", "torque"), [(2, 0.4, 0.4), (3, 0.25, 0.3)])
def test_pairs_share_a_law_safely(count: int, bend: float, torque: float) -> None:
    """Rated afterwards by `strength`, from the parts alone: all pairs are equally safe, and the weakest gains."""
    wild = f'{{law: ratio_expression, ratio: "1/(1 + {bend}*cos(phi))**{count}", scale_to_close: true}}'
    load = f"10*(1 - {torque}*cos(x))"
    even, found = (
        [worst(rating_of(pair).weakest).share for pair in made(wild, count, load, more).by_stage]
        for more in ("", ", sharing: safety")
    )
    assert found == pytest.approx([found[0]] * count, rel=0.005)
    assert min(found) > 1.02 * min(even)
    assert max(even) > 1.03 * min(even)


def test_safe_sharing_needs_a_load() -> None:
    text = MACHINE.format(law=EVEN, pairs=2, torque="10", more=", sharing: safety").rpartition("resistance")[0]
    with pytest.raises(WrongInput, match="a load of the teeth") as wrong:
        drive_of_text(text)
    assert wrong.value.key == "gears.sharing"


def test_every_pair_passes_the_power_of_the_driven_shaft() -> None:
    drive = made(SQUARE, 3, "10 + 4*sin(x)")
    phi1 = np.linspace(0.0, 2.0 * np.pi, 60)
    whole = drive.transmission.driven_angle(phi1, 1)
    power = 1000.0 * (10.0 + 4.0 * np.sin(whole.value)) * whole.derivative(1)
    shaft, speed = phi1, np.ones_like(phi1)
    for pair in drive.by_stage:
        turned = pair.pair.transmission.driven_angle(shaft, 1)
        speed = speed * turned.derivative(1)
        assert pair.tooth_load.torque_n_mm(shaft) * speed == pytest.approx(power, rel=1e-11)
        shaft = turned.value


@pytest.mark.slow
def test_each_of_three_round_pairs_is_as_strong_as_one() -> None:
    single = rating_of(made(EVEN, 1)).weakest
    for pair in made(EVEN, 3).by_stage:
        for found, wanted in zip(rating_of(pair).weakest, single, strict=True):
            assert found.safety == pytest.approx(wanted.safety, rel=1e-12)
            assert (found.gear, found.damage) == (wanted.gear, wanted.damage)


def test_shafts_between_have_names() -> None:
    found = [stages_summary(pair)["stage"] for pair in made(EVEN, 3).by_stage]
    assert [(one["driving_gear_on"], one["driven_gear_on"], one["seen_from"]) for one in found] == [
        ("driving shaft", "shaft between stages 1 and 2", "driving end"),
        ("shaft between stages 1 and 2", "shaft between stages 2 and 3", "other end of the shafts"),
        ("shaft between stages 2 and 3", "crank shaft", "driving end"),
    ]


@pytest.mark.parametrize(
    ("law", "more", "key", "said"),
    [
        ("{law: harmonic_ratio, second_stage: {}}", "", "gears.pairs", "motion.second_stage shares the ratio already"),
        ('{law: ratio_expression, ratio: "2", range_deg: 90}', "", "gears.pairs", "over a range, less than a turn"),
        (EVEN, ", lobes: {driving: 2, driven: 2}", "gears.lobes", "one lobe each"),
        (EVEN, ", parts: [1, 2]", "gears.parts", "2 given for three parts of three pairs"),
        (EVEN, ", parts: [1, 2, 1], sharing: even", "gears.parts", "leave one of them out"),
    ],
)
def test_what_cannot_be_shared_out_is_refused(law: str, more: str, key: str, said: str) -> None:
    with pytest.raises(WrongInput) as wrong:
        made(law, 3, "10", more)
    assert wrong.value.key == key
    assert said in wrong.value.problem


@pytest.mark.parametrize(("key", "value"), [("sharing", "even"), ("parts", "[1, 2]")])
def test_one_pair_shares_nothing(key: str, value: str) -> None:
    with pytest.raises(WrongInput, match="one pair has the whole ratio") as wrong:
        made(EVEN, 1, "10", f", {key}: {value}")
    assert wrong.value.key == f"gears.{key}"


def test_a_stage_that_is_not_there_is_refused() -> None:
    drive = made(EVEN, 3)
    assert drive.of_stage(3).stage == 3
    for stage, said in ((None, "three pairs of gears; --stage 1, --stage 2 or --stage 3"), (4, "no --stage 4")):
        with pytest.raises(WrongInput) as wrong:
            drive.of_stage(stage)
        assert wrong.value.key == "gears.pairs"
        assert said in wrong.value.problem


def test_a_drive_that_shares_its_law_otherwise_takes_no_law_over() -> None:
    """As a sweep over the number of pairs, whose designs differ in nothing else."""
    three = made(SQUARE, 3)
    _ = three.law
    changed = three.design.model_copy(update={"gears": three.gears.model_copy(update={"pairs": 2})})
    assert len(drive_like(three, changed).law.train.pairs) == 2
    same = three.design.model_copy(update={"gears": three.gears.model_copy(update={"face_width_mm": 20.0})})
    assert drive_like(three, same).law is three.law
    told = same.model_copy(update={"gears": same.gears.model_copy(update={"sharing": "safety"})})
    assert _in_common(told, told) == ()
