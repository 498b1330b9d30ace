"""Advices about the law, the speeds, the resistance and the pitch curves."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import cos, degrees, floor, isclose, radians

from ncgear.design.keys.optimize import Optimize
from ncgear.figures.advice.values import Advice, Change, Kind, NotJudged, Remedy, changed
from ncgear.figures.numbers import drawn, fixed, micrometres, placed, to_digits
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.pitch import shape
from ncgear.pitch.pair import STRAIGHT, largest_tangent_angle_rad
from ncgear.pitch.shape import Gear, Mesh
from ncgear.project import alternatives
from ncgear.project.drive import Drive
from ncgear.project.passing import CRANK_PIN, about_axis
from ncgear.ratio.transmission import Transmission

OPTIMIZE = "ncgear optimize"

WIDEST_RATIO = 5.0
"""Where the ratio or its inverse exceeds this, the smaller pitch radius is under a sixth of the centre distance."""

SAME_SPEED = 1e-3
"""Relative difference of two speeds that nobody notices: 1 mm/s in a metre per second."""

STEEPEST_DEG = 60.0
"""Pressure angle beyond which the force on a tooth is over twice the part of it that turns (cos 60 deg = 0.5)."""


def ratio_range(drive: Drive) -> Advice | None:
    """A ratio beyond what gears follow well; with two stages, the ratio of the drive's own stage."""
    low, high = drive.pair.transmission.ratio_range
    if not _too_wide(drive.pair.transmission):
        return None
    words = drive.design.motion.NARROWER_RATIO
    narrower = (Remedy(words),) if words else ()
    best = optimised(drive, ratio_min=1.0 / WIDEST_RATIO, ratio_max=WIDEST_RATIO)
    return Advice(
        Kind.RATIO_RANGE,
        f"the ratio runs from {to_digits(low.value, 3)} to {to_digits(high.value, 3)}, beyond 1:{WIDEST_RATIO:g}",
        f"at {placed(degrees(low.at))} and {placed(degrees(high.at))} deg one gear has almost no radius where the "
        "other is large: few teeth carry there, and the shaft of the small side is thin",
        (*narrower, *tempered(drive, _too_wide), *best),
    )


def _too_wide(transmission: Transmission) -> bool:
    low, high = transmission.ratio_range
    return low.value < 1.0 / WIDEST_RATIO or high.value > WIDEST_RATIO


def speeds(drive: Drive) -> Advice | None:
    """A remark where the machine runs at another speed than the speed at which the velocities of its law hold.

    The machine's speed is always given by a person, and so are the velocities: it says what holds at that speed.
    """
    operating, law = drive.design.operation.speed_rpm, drive.law_speed_rpm
    if abs(operating / law - 1.0) < SAME_SPEED:
        return None
    unit, facts = drive.linkage.OUTPUT.speed, drive.law.stroke.facts if drive.law.stroke else {}
    share, end = operating / law, f"_{unit.ending}"
    given = {
        key.removesuffix(end): fact for key, fact in facts.items() if key.endswith(end) and isinstance(fact, float)
    }
    named = [f"{name} is {to_digits(share * value, 5)} {unit.text}" for name, value in given.items()]
    held = " and ".join(named) or f"velocities are {to_digits(share, 3)} times as large"
    return Advice(
        Kind.SPEEDS,
        f"at {operating:g} r/min {held}",
        f"the law's velocities hold at {to_digits(law, 5)} r/min",
        matters=False,
    )


def negative_resistance(drive: Drive, returning: bool) -> Advice | None:
    """A resistance that would drive the slider in a part of one stroke."""
    resistance = drive.machine.load.on(returning)
    key, way = ("resistance.returning", " on the way back") if returning else ("resistance", "")
    stretches = resistance.negative_stretches_mm(drive.linkage.stroke_mm)
    if not stretches:
        return None
    place = drive.linkage.OUTPUT.place
    ends = [[to_digits(place.factor * end, 3) for end in stretch] for stretch in stretches]
    named = ", ".join(f"{low}..{high}" for low, high in ends)
    kept, rule = resistance.keep_negative, f"{key}.where_negative"
    drives = f", where it drives the {drive.linkage.OUTPUT.name}" if kept else ""
    other = "take it as zero there" if kept else "count it, where the load really pulls the slider"
    remedies = (
        Remedy("give a resistance that is nowhere under zero, as a table or a formula"),
        Remedy(other, (Change(rule, "zero" if kept else "keep"),)),
    )
    return Advice(
        Kind.NEGATIVE_RESISTANCE,
        f"the resistance{way} is negative in places and {'kept' if kept else 'taken as zero there'}",
        f"for displacements of {named} {place.text}{drives}",
        () if alternatives.is_given(drive.design, rule) else remedies,
        matters=not alternatives.is_given(drive.design, rule),
    )


def pressure_angle(drive: Drive) -> Advice | None:
    """Flanks that press on the shafts more than they turn the driven gear."""
    angle = drive.largest_pressure_angle_deg
    if angle <= STEEPEST_DEG:
        return None
    at = degrees(drive.pitch.largest_tangent_angle_rad.at)
    return Advice(
        Kind.PRESSURE_ANGLE,
        f"pressure angle up to {to_digits(angle, 3)} deg (at phi1 = {placed(at)} deg): friction may lock",
        f"only {fixed(100.0 * cos(radians(angle)), 0)} % of the force between the teeth turns the driven gear there; "
        "the rest loads the shafts",
        _less_steep(drive, angle),
    )


def _less_steep(drive: Drive, angle: float) -> tuple[Remedy, ...]:
    rack, mesh = radians(drive.gears.carrying_angle_deg), drive.pitch.mesh

    def steep(transmission: Transmission) -> bool:
        return degrees(largest_tangent_angle_rad(transmission, mesh).value + rack) > STEEPEST_DEG

    flatter = alternatives.flatter_rack(drive, angle - STEEPEST_DEG)
    words = "take a rack with a smaller pressure angle, of which more teeth may be undercut"
    other_rack = (Remedy(words, changed(flatter)),) if flatter else ()
    sought = optimised(drive, pressure_angle_deg=STEEPEST_DEG) if mesh is Mesh.EXTERNAL else ()
    return (*other_rack, *tempered(drive, steep), *sought)


def ring(drive: Drive) -> Advice | None:
    """What the workshop needs to make an internal gear."""
    if not drive.pitch.driven.is_ring:
        return None
    return Advice(
        Kind.RING,
        "the driven gear is internal and no hob cuts it: wire, mill, print or shape it",
        "a shaper needs a smaller cutter; the gear is carried on its rim, or by a plate behind the driving gear",
    )


def crank_pin(drive: Drive) -> list[Advice | NotJudged]:
    """A crank pin that comes near to the driving shaft, to what carries it, to another link's axis or to an end stop.

    The crank is carried by the last driven shaft.  Where the design does not say how thick its pin is, it is taken to
    be as thick as that shaft or, where that has no bore, as the driving one.
    """
    gears, crank, fit = drive.gears, drive.linkage.crank_mm, drive.design.fit
    thick = (gears.driven.crank_pin and gears.driven.crank_pin.diameter_mm) or gears.driven.bore_mm
    pin = (thick or gears.driving.bore_mm or 0.0) / 2.0
    passing = {Gear.DRIVING: abs(drive.pitch.center_distance_mm - crank), Gear.DRIVEN: crank}
    bodies = {Gear.DRIVING: gears.driving, Gear.DRIVEN: gears.driven}
    judged = [gear for gear in Gear if gear is Gear.DRIVEN or fit is None or fit.driving_shaft == "through"]
    near = [(gear, *about_axis(bodies[gear])) for gear in judged]
    # A ring is carried on its rim
    unknown = [
        gear for gear, _, radius in near if radius is None and not (gear is Gear.DRIVEN and drive.pitch.driven.is_ring)
    ]
    return [
        *(
            Advice(
                Kind.CRANK_PIN,
                f"a {drawn(2.0 * pin, 'mm')} mm crank pin touches the {gear.value} gear's {part}",
                f"where both are on the same side of the gears: it passes {drawn(round(passing[gear], 2), 'mm')} mm "
                f"from the {gear.value} gear's axis, about which the {part} is {drawn(2.0 * radius, 'mm')} mm thick",
                (_below(drive, NO_MEETING) if gear is Gear.DRIVING else _beside_own_shaft(drive, part, radius, pin),),
            )
            for gear, part, radius in near
            if radius is not None and passing[gear] < radius + pin
        ),
        *(
            Advice(
                Kind.CRANK_PIN,
                f"a {drawn(2.0 * pin, 'mm')} mm crank pin touches the {passing.standing.name}",
                f"it passes {drawn(round(passing.distance_mm, 2), 'mm')} mm from its middle",
                (_thinner("crank pin", passing.distance_mm - (passing.standing.radius_mm or 0.0)),),
            )
            for passing in drive.passings
            if passing.part == CRANK_PIN and not passing.standing.about_driving_axis
            if passing.distance_mm < (passing.standing.radius_mm or 0.0) + pin
        ),
        *_in_slot(drive, pin),
        *([NO_BORE] if unknown else []),
    ]


def _in_slot(drive: Drive, pin_mm: float) -> Iterator[Advice]:
    """A pin of a given radius that is as thick as the bar in whose slot it slides."""
    fit = drive.design.fit
    slotted = any(shape.slots for shape in drive.linkage.shapes().values())
    if slotted and fit and fit.rod_width_mm is not None and fit.rod_width_mm <= 2.0 * pin_mm:
        wide, thick = drawn(fit.rod_width_mm, "mm"), drawn(2.0 * pin_mm, "mm")
        yield Advice(
            Kind.CRANK_PIN,
            f"a {thick} mm crank pin does not go into a slot of a part {wide} mm wide",
            remedies=(Remedy(f"make that part wider than {thick} mm, or the pin thinner"),),
        )


NO_BORE = NotJudged("a gear has no bore_mm, and so no shaft of known size")

NO_MEETING = (
    "let the driving shaft end below the crank, carry the crank on the other side of the gears, or take another centre "
    "distance"
)


def _thinner(part: str, room_mm: float) -> Remedy:
    """What is round has to be as thin as its room, or where there is none, to stand elsewhere."""
    if room_mm <= 0.0:
        return Remedy(f"no {part} is thin enough, but one {drawn(-room_mm, 'mm')} mm farther off or more")
    return Remedy(f"make the {part} no more than {shown_below(2.0 * room_mm, 3)} mm thick")


def _beside_own_shaft(drive: Drive, part: str, radius_mm: float, pin_mm: float) -> Remedy:
    """The crank's own shaft or hub beside its pin, by their radii: the distance between them is the crank's length."""
    crank_mm = drive.linkage.crank_mm
    if part == "shaft" and drive.gears.driven.crank_pin is None:
        # The pin is taken to be as thick as the shaft.
        return _thinner("shaft with its crank pin", crank_mm / 2.0)
    if pin_mm < crank_mm:
        return _thinner(part, crank_mm - pin_mm)
    if radius_mm < crank_mm:
        return _thinner("crank pin", crank_mm - radius_mm)
    return Remedy(f"take a crank of {shown_above(radius_mm + pin_mm, 3)} mm or more, or thinner parts")


def _below(drive: Drive, words: str) -> Remedy:
    """A driving shaft that ends below what moves; only words where the file says that it goes through."""
    change = Change("fit.driving_shaft", "ends")
    return Remedy(str(change)) if alternatives.is_given(drive.design, change.key) else Remedy(words, (change,))


def rods(drive: Drive) -> list[Advice | NotJudged]:
    """Rods that meet what stands in their plane, however thin they are where the file gives no width of them.

    The driving shaft stands there unless the section ``fit`` says that it ends below.
    """
    fit = drive.design.fit
    found: list[Advice | NotJudged] = []
    for passing in drive.passings:
        ends = fit is not None and fit.driving_shaft == "ends" and passing.standing.about_driving_axis
        room, half, radius = passing.room_mm, passing.half_mm or 0.0, passing.standing.radius_mm
        if passing.part == CRANK_PIN or ends:
            continue
        if room is None or radius is None:
            found.append(NO_BORE)
            continue
        if not passing.meets:
            continue
        at, wide = degrees(passing.phi1_rad), f"{drawn(2.0 * half, 'mm')} mm wide" if half else "however thin it is"
        widest = drawn(floor(100.0 * room) / 100.0, "mm")
        lower = f"make the {passing.part} no wider than {widest} mm, or " if room > 0.01 else ""
        taken = f", and {drawn(radius, 'mm')} mm of it are taken" if radius else ""
        words = f"{lower}let the {passing.standing.name} end below the {passing.part}"
        found.append(
            Advice(
                Kind.ROD,
                f"the {passing.part} meets the {passing.standing.name} at phi1 = {placed(at)} deg",
                f"its middle passes the centre at {drawn(passing.distance_mm, 'mm')} mm{taken}: a {passing.part}, "
                f"{wide}, cannot pass there",
                (_below(drive, words) if passing.standing.about_driving_axis else Remedy(words),),
            )
        )
    return found


def pin_beside_hub(drive: Drive) -> Advice | None:
    """A remark about a crank pin in a gear with a hub on the same face: what the pin moves must run above the hub."""
    driven = drive.gears.driven
    if driven.crank_pin is None or driven.hub is None:
        return None
    return Advice(
        Kind.CRANK_PIN,
        "the crank pin stands beside the driven gear's hub",
        f"the hub is {drawn(driven.hub.height_mm, 'mm')} mm high, and at a dead centre what the pin moves lies over "
        "the axis: let the pin stand out above the hub or on the other face",
        matters=False,
    )


def concave(drive: Drive) -> list[Advice | None]:
    """Pitch curves that are dented; where a hob does no harm to the flanks, that is only a remark."""
    return [_dented(drive, gear) for gear in Gear]


def _dented(drive: Drive, gear: Gear) -> Advice | None:
    # A check needs no module that makes teeth.
    from ncgear.teeth.tool import HARMLESS, gouged_mm

    radius = drive.pitch.least_concave_radius_mm(gear)
    if radius is None:
        return None
    stretches = tuple((degrees(a), degrees(b)) for a, b in drive.pitch.concave_ranges(gear))
    named = stretches_in_words(stretches, degrees(drive.pitch.transmission.lobes.driving_period_rad))
    where = f"its pitch curve is concave for phi1 in {named} deg (radius {to_digits(radius, 4)} mm)"
    depth = gouged_mm(drive.pitch.of(gear), drive.rack)
    if not drive.pitch.of(gear).is_ring and depth <= HARMLESS * drive.rack.module_mm:
        harm = f"{where}; a hob cuts {micrometres(depth)} into the flanks there, which does not matter"
        return Advice(Kind.CONCAVE, f"the {gear.value} gear is hardly concave", harm, matters=False)
    return Advice(
        Kind.CONCAVE,
        f"the {gear.value} gear is concave and no hob cuts it: wire, mill, print or shape it",
        f"{where}; a shaper needs a smaller cutter, the mate's teeth stand close together there and their tips may "
        "have to be shortened",
        _convex(drive, gear),
    )


def stretches_in_words(stretches_deg: Sequence[tuple[float, float]], period_deg: float) -> str:
    """Stretches of the driving angle within a period in whole degrees, or in as many digits as tell their ends apart.

    One that goes on over the end of the period is one: 350..20.  What is too narrow for six decimals is left out,
    unless nothing else is there.
    """
    told = [
        stretch for stretch in stretches_deg if fixed(stretch[0], MOST_DECIMALS) != fixed(stretch[1], MOST_DECIMALS)
    ]
    told = told or list(stretches_deg)
    if len(told) > 1 and told[0][0] == 0.0 and isclose(told[-1][1], period_deg):
        told = [*told[1:-1], (told[-1][0], told[0][1])]
    return ", ".join(map(_stretch, told))


MOST_DECIMALS = 6
"""Decimals of degrees in words: far below what any gear shows."""


def _stretch(ends_deg: tuple[float, float]) -> str:
    decimals = (count for count in range(MOST_DECIMALS) if len({fixed(end, count) for end in ends_deg}) > 1)
    count = next(decimals, MOST_DECIMALS)
    return "..".join(fixed(end, count) for end in ends_deg)


def _convex(drive: Drive, gear: Gear) -> tuple[Remedy, ...]:
    """Laws that leave no dent; no remedy for a ring, which no hob cuts in any case."""
    mesh = drive.pitch.mesh
    if shape.is_ring(gear, mesh):
        return ()

    def dented(transmission: Transmission) -> bool:
        return transmission.extremes(lambda slope: shape.curvature(slope, gear, mesh), 2)[0].value < -STRAIGHT

    sought = optimised(drive, convex=True) if mesh is Mesh.EXTERNAL else ()
    return (*tempered(drive, dented), *sought)


def optimised(drive: Drive, **limits: float | bool) -> tuple[Remedy, ...]:
    """The remedy of an optimised law within limits, which are given by their keys under ``optimize.limits``.

    A limit of the file that is as tight stays as it is.  Empty where one of the file is wider, since a person wants it
    so, and where the output never returns, since there is nothing to optimise then.
    """
    own = (drive.design.optimize or Optimize()).limits
    given = {key: getattr(own, key) for key in limits if alternatives.is_given(drive.design, f"optimize.limits.{key}")}
    if not all(_as_tight(key, value, limits[key]) for key, value in given.items()) or not drive.linkage.RETURNS:
        return ()
    changes = changed({f"optimize.limits.{key}": value for key, value in limits.items() if key not in given})
    return (Remedy("let the best law within this limit be found" if changes else OPTIMIZE, changes, OPTIMIZE),)


def _as_tight(key: str, given: float | bool | None, wanted: float | bool) -> bool:
    """Whether a limit of the file lets a law do no more than a wanted one."""
    if given is None:
        return False
    return given >= wanted if isinstance(wanted, bool) or key == "ratio_min" else given <= wanted


def tempered(drive: Drive, harmful: Callable[[Transmission], bool]) -> tuple[Remedy, ...]:
    """The remedy of the design's own law with a smaller swing that is not ``harmful``; empty where there is none.

    Empty too where that law no longer keeps a wish or a limit of the file that the law as given keeps.
    """
    percent = alternatives.kept_percent(drive.design, harmful)
    if percent == 0:
        return ()
    changes = alternatives.gentler(drive.design, percent / alternatives.STEPS)
    if not alternatives.overstepped(alternatives.changed_motion(drive.design, changes)) <= alternatives.overstepped(
        drive.design
    ):
        return ()
    text = f"keep {percent} % of the law's swing, which moves the {drive.linkage.OUTPUT.name} more evenly"
    return (Remedy(text, changed(changes)),)
