"""From keys to values: the closed law of a design on its mechanism, its lobes, load and wishes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from math import degrees, isclose, pi, tan

import numpy as np

from ncgear.design.keys.base import key_of
from ncgear.design.keys.design import Design
from ncgear.design.keys.gears import Gears
from ncgear.design.keys.machine import RockerTorque, ShaftTorque, StrokeForce, TurningLoad
from ncgear.design.keys.optimize import Optimize
from ncgear.design.mechanisms import mechanism_of, mechanism_of_stroke
from ncgear.design.wishes.base import On, WishKeys
from ncgear.design.wishes.registry import KINDS, Wishes
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.mechanisms.resistance import FormulaResistance, PolynomialResistance, Resistance, TableResistance
from ncgear.mechanisms.slider_load import NO_RESISTANCE, SliderLoad
from ncgear.numerics.bounds import shown_below
from ncgear.ratio.transmission import CLOSED, Law, Lobes, PairsInSeries, Transmission
from ncgear.wishes.wish import Wish


def law_of(design: Design) -> Law:
    """The design's closed law on its mechanism.

    Raises WrongInput for values that contradict each other, NoSuchMechanism when no such motion exists.
    """
    law, gears = _given_law(design), design.gears
    if gears is not None and gears.idlers is not None:
        from ncgear.ratio.laws.row import laws_in_series, row_laws

        lobes = gears.lobes.driving, gears.lobes.driven, *gears.idlers.lobes
        directions, first = gears.idlers.directions_rad, law.transmission
        if design.prescribes_row:
            from ncgear.ratio.laws.shared_idler import shared_by_idler

            first = shared_by_idler(first, pi + directions[1], "gears.idlers.bends_deg").first
        laws = row_laws(first, lobes, directions, "gears.idlers")
        return replace(law, train=laws_in_series(laws))
    if gears is None or gears.pairs == 1:
        return law
    parts: Sequence[float] = gears.parts or (1.0,) * gears.pairs
    if gears.sharing == "pressure_angle":
        parts = evenly_steep(law.transmission, parts)
    return replace(law, train=_shared_out(law.transmission, parts))


def _shared_out(whole: Transmission, parts: Sequence[float]) -> PairsInSeries:
    from ncgear.ratio.laws.row import shared_out

    return shared_out(whole, parts)


EVENLY_STEEP = 1e-8
"""Largest difference of the pairs' greatest tangents of pressure angles that counts as none, as a share of them: told
are four digits of the angles."""

MOST_SHARINGS = 100
"""Steps in which the angles become even: 6 to 20 for laws of 3 to 60 degrees (tests/test_shared_pairs.py)."""


def evenly_steep(whole: Transmission, parts: Sequence[float]) -> Sequence[float]:
    """Parts of a law with which the curves of all pairs lean equally much at most, with ``parts`` to begin with.

    A pair's tangent is its part times what changes little with the part, so parts over tangents come near step by step.
    """
    from ncgear.pitch.pair import largest_tangent_angle_rad

    for _ in range(MOST_SHARINGS):
        train = _shared_out(whole, parts)
        steepest = [tan(largest_tangent_angle_rad(pair.transmission).value) for pair in train.pairs]
        if max(steepest) - min(steepest) <= EVENLY_STEEP * max(steepest):
            return parts
        nearer = [part / slope for part, slope in zip(parts, steepest, strict=True)]
        parts = [part / sum(nearer) for part in nearer]
    raise NoSuchMechanism(
        f"no parts of the ratio were found that give all {len(parts)} pairs the same pressure angle; even is right, "
        "or gears.parts",
        key="gears.sharing",
    )


def _given_law(design: Design) -> Law:
    """The law before it is shared out over pairs; of a row of gears, that of the first pair."""
    motion, lobes = design.motion, lobes_of(design)
    if motion.gives_stroke:
        linkage = mechanism_of_stroke(design.linkage, motion.solved_stroke_mm)
        with _naming_a_lock(linkage):
            return motion.law_on(linkage, lobes)
    linkage = mechanism_of(design.linkage)
    with _naming_a_lock(linkage):
        law = motion.law_on(linkage, lobes, ring=design.gears is not None and design.gears.mesh == "internal")
    covered, linkage = law.transmission.lobes.range, law.linkage
    if covered is None and not linkage.RETURNS and not linkage.OUTPUT.angular:
        raise WrongInput(
            f"{motion.law}, with which the gears turn on and on, but the {linkage.OUTPUT.name} of {linkage.NAME} never "
            "comes back by itself; a law over a range (range_deg, spiral or function_generator) is right",
            key="motion.law",
        )
    if covered is None or not linkage.RETURNS:
        return law
    if covered.driven_rad > law.linkage.working_angle_rad * (1.0 + CLOSED):
        raise NoSuchMechanism(
            f"the driven gear turns by {degrees(covered.driven_rad):.5g} deg and the crank's working stroke is "
            f"{degrees(law.linkage.working_angle_rad):.5g} deg: gears that turn less than once stay within it; a "
            "smaller range, or a greater ratio, is right",
            key="motion",
        )
    return law


LOCKED_DEG = 15.0
"""Transmission angle under which a linkage counts as nearly locked: near 0 its output hardly follows its crank."""


@contextmanager
def _naming_a_lock(linkage: Mechanism) -> Iterator[None]:
    """A context in which refusals of a ratio name the linkage where it nearly locks: the ratio follows from it."""
    try:
        yield
    except NoSuchMechanism as error:
        least_rad, crank_rad = linkage.least_transmission() if linkage.RODS else (pi, 0.0)
        if degrees(least_rad) < LOCKED_DEG and " ratio " in error.problem:
            error.problem += (
                f"; {linkage.NAME} nearly locks at the crank angle of {degrees(crank_rad):.4g} deg, where its "
                f"transmission angle is {degrees(least_rad):.3g} deg: other lengths (linkage) may help"
            )
        raise


def require_whole_turns(design: Design, what: str) -> None:
    """Raise WrongInput where the gears turn less than once; ``what`` is not offered for such gears."""
    if design.motion.is_open:
        raise WrongInput(
            f"{design.motion.law} over a range, with which gears turn to and fro, less than once; {what} is offered "
            "for gears that turn on and on",
            key="motion.law",
        )


def lobes_of(design: Design) -> Lobes:
    """Lobes of both gears; one each where the file has no gears."""
    return Lobes(design.gears.lobes.driving, design.gears.lobes.driven) if design.gears else Lobes()


def size_of(gears: Gears, law: Law) -> tuple[int | None, float | None, float | None]:
    """Teeth, module in mm and centre distance in mm as given; the distance from the law if the law determines it.

    Raises WrongInput where the file gives a distance that differs from the law's.
    """
    from ncgear.pitch.pair import CONSISTENT

    given, follows = gears.center_distance_mm, law.center_distance_mm
    if follows is not None and given is not None and not isclose(given, follows, rel_tol=CONSISTENT):
        raise WrongInput(
            f"{given:.9g} mm given, but the pitch curve closes with its mate at {follows:.9g} mm; give that, or leave "
            "the key out",
            key="gears.center_distance_mm",
        )
    return gears.teeth, gears.module_mm, given if follows is None else follows


def kept_size(design: Design) -> tuple[int | None, float | None, float | None]:
    """Teeth, module in mm and centre distance in mm with which the design's gears keep their size under another law.

    They are the values of the file.  Only for a law that gives the centre distance: teeth with the module, or else with
    that distance.
    """
    gears = design.gears
    assert gears is not None
    if not design.motion.gives_center_distance:
        return gears.teeth, gears.module_mm, gears.center_distance_mm
    from ncgear.pitch.pair import sized_pair
    from ncgear.pitch.shape import Mesh

    law = law_of(design)
    size = sized_pair(law.transmission, *size_of(gears, law), Mesh(gears.mesh)).size
    return size.driving_teeth, gears.module_mm, size.center_distance_mm if gears.module_mm is None else None


def load_of(design: Design) -> SliderLoad:
    """The load of the slider; zero force where the file has none."""
    given = design.resistance
    if given is None:
        return SliderLoad()
    working = _resistance_of(given, "resistance")
    match given:
        case ShaftTorque():
            if design.motion.is_open:
                return SliderLoad(working)
            _refuse_a_seam(working)
            if design.gears is not None and design.gears.idlers is not None:
                _refuse_uneven_turns(working, (design.gears.lobes.driven, *design.gears.idlers.lobes))
            return SliderLoad(working, repeats_after=2.0 * pi)
        case RockerTorque():
            friction = N_MM_PER_N_M * given.friction_n_m
        case _:
            friction = given.friction_n
    return SliderLoad(working, _resistance_of(given.returning, "resistance.returning"), friction)


SAME_TORQUE = 1e-9
"""Difference of the torque after a turn, as a share of the largest torque in it, that counts as zero."""


def _refuse_uneven_turns(torque: Resistance, lobes: tuple[int, ...]) -> None:
    """Refuse a torque on the last gear of a row that other gears do not meet again after a turn; raises WrongInput.

    ``lobes`` are those of all driven gears.
    """
    last, turn = lobes[-1], np.linspace(0.0, 2.0 * pi, 181)
    if all(count % last == 0 for count in lobes):
        return
    change = torque.force_n(np.mod(turn + 2.0 * pi / last, 2.0 * pi)) - torque.force_n(turn)
    if np.abs(change).max() > SAME_TORQUE * np.abs(torque.force_n(turn)).max():
        raise WrongInput(
            f"the torque changes within a turn of the last gear, whose lobes ({last}) other gears do not have a "
            f"multiple of; a torque that repeats every {360.0 / last:.6g} deg is right",
            key="resistance",
        )


def _refuse_a_seam(torque: Resistance) -> None:
    """Refuse a torque on the driven shaft that differs after a turn; raises WrongInput."""
    turn = torque.force_n(np.linspace(0.0, 2.0 * pi, 181))
    first, last = turn[[0, -1]]
    if abs(last - first) > SAME_TORQUE * np.abs(turn).max():
        raise WrongInput(
            f"the torque is {first / N_MM_PER_N_M:.6g} N m at 0 deg and {last / N_MM_PER_N_M:.6g} N m at 360 deg, "
            "but it repeats every turn of the driven shaft; the same value at both is right",
            key="resistance",
        )


N_MM_PER_N_M = 1000.0


def _resistance_of(given: StrokeForce | TurningLoad | None, key: str) -> Resistance:
    """The resistance of one stroke, whose keys are below ``key``."""
    if given is None:
        return NO_RESISTANCE
    if isinstance(given, TurningLoad):
        return _torque_of(given, key)
    keep = given.where_negative == "keep"
    if given.table is not None:
        return TableResistance(given.table.displacement_mm or (), given.table.force_n or (), keep)
    if given.expression_n is not None:
        return FormulaResistance(given.expression_n, keep, f"{key}.expression_n")
    return PolynomialResistance(given.polynomial_n, keep) if given.polynomial_n else NO_RESISTANCE


def _torque_of(given: TurningLoad, key: str) -> Resistance:
    """The torque in N mm over the output's angle in rad."""
    keep = given.where_negative == "keep"
    if given.table is not None:
        angles = tuple(np.radians(given.table.angle_deg or ()).tolist())
        return TableResistance(angles, tuple(N_MM_PER_N_M * value for value in given.table.torque_n_m or ()), keep)
    if given.expression_n_m is not None:
        return FormulaResistance(given.expression_n_m, keep, f"{key}.expression_n_m", turning=True)
    coefficients = tuple(N_MM_PER_N_M * value for value in given.polynomial_n_m or ())
    return PolynomialResistance(coefficients, keep) if coefficients else NO_RESISTANCE


def keeps_even_speed(design: Design) -> bool:
    """Whether a hard wish asks for even speed somewhere on the stretch on which the design's own law prescribes it.

    The wish then tells which part of this stretch is needed.  False where the law prescribes no even speed.
    """
    stretch, wishes = design.motion.even_rad, design.wishes
    if stretch is None or wishes is None:
        return False
    try:
        law = law_of(design)
    except DesignError:
        return False
    place = law.linkage.OUTPUT.place
    crank = law.transmission.driven_angle(np.array(stretch))
    start, end = place.factor * law.linkage.displacement(crank).value
    kept = (wish for wish in wishes.constant_speed if wish.hard and wish.stroke == "working")
    return any(wish.place("from") < end and wish.place("to") > start for wish in kept)


def motion_wishes_of(design: Design, linkage: Mechanism, cycle_rad: float) -> tuple[Wish, ...]:
    """The wishes of a design's motion, for a mechanism whose cycle takes a driving angle of ``cycle_rad``.

    Raises WrongInput for places outside the stroke, angles outside the cycle and wishes that contradict each other,
    NoSuchMechanism for an exact dwell.
    """
    on = On(linkage, cycle_rad, (design.optimize or Optimize()).limits.ratio_max)
    wished = dict(_wished(design.wishes))
    _refuse_places(wished, on)
    _refuse_angles(wished, on)
    for key, keys in wished.items():
        keys.refuse(key, on)
    for kind in KINDS:
        kind.refuse_together(design.wishes, on)
    output = linkage.OUTPUT
    return tuple(keys.value(on, key=key, weight=keys.soft_weight, output=output) for key, keys in wished.items())


def _wished(wishes: Wishes) -> Iterator[tuple[str, WishKeys]]:
    for kind in KINDS:
        for number, keys in enumerate(kind.completed(wishes.of(kind))):
            yield f"wishes.{kind.KIND}.{number}" if kind.SEVERAL else f"wishes.{kind.KIND}", keys


def _refuse_places(wished: dict[str, WishKeys], on: On) -> None:
    """Refuse places beyond the stroke, and places at its very end where the output must move."""
    unit, stroke = on.linkage.OUTPUT.place, on.stroke
    for reaches in (False, True):
        for key, keys in wished.items():
            for name in keys.REACHING if reaches else keys.INSIDE:
                place = keys.place(name)
                if place is not None and not (place <= stroke if reaches else place < stroke):
                    right = "at most that" if reaches else "less"
                    raise WrongInput(
                        f"{place:g} given, but the stroke is {shown_below(stroke)} {unit.text}; {right} is right",
                        key=f"{key}.{name}_{unit.ending}",
                    )


def _refuse_angles(wished: dict[str, WishKeys], on: On) -> None:
    for key, keys in wished.items():
        for quantity, in_rad in keys.ANGLES:
            if not getattr(keys, in_rad) < on.cycle_rad:
                name = key_of(keys, quantity)
                raise WrongInput(
                    f"{getattr(keys, name):g} given, but a cycle takes {degrees(on.cycle_rad):g} deg of the driving "
                    "angle; less is right",
                    key=f"{key}.{name}",
                )
