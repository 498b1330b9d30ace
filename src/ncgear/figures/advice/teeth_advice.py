"""Advices about the teeth of a pair: undercut, tips, contact, thrust, assembly within tolerances, index holes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import degrees
from typing import NamedTuple

from ncgear.contact.designed.as_designed import SideContact
from ncgear.contact.placement import BACK, PUSHING
from ncgear.errors import DesignError
from ncgear.figures.advice.law_advice import STEEPEST_DEG
from ncgear.figures.advice.tried_advice import CLOSER, FINER, FLATTER
from ncgear.figures.advice.values import Advice, Change, Kind, NotJudged, Remedy, changed
from ncgear.figures.data_sheet.entries import limit_words
from ncgear.figures.numbers import MICRORAD, micrometres, placed, teeth_words, to_digits
from ncgear.numerics.arrays import Mask
from ncgear.pitch.shape import Gear
from ncgear.project.alternatives import (
    blunt_addendum,
    bridging_helix,
    enough_teeth,
    is_given,
    resized,
    room_for_index_hole,
    shift_free_of_undercut,
    steeper_rack,
)
from ncgear.project.drive import Drive
from ncgear.project.tolerance_limits import MOST_JAMMED, Jamming, backlash_key, jamming_of
from ncgear.project.tooth_form import thickness_limits_mm
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.lost import Loss, shortening, undercutting
from ncgear.teeth.tips import Limit

MEANINGS = {
    Limit.SLOPE: "their lands would slope too much, since the other edge of the tooth is lower",
    Limit.FILLET: "they would reach into the mate's fillets",
    Limit.CUSP: "they would end in cusps, so concave is the pitch curve there",
    Limit.FOULING: "they would run into the mate's tips, so concave is the pitch curve there",
    Limit.HELIX: "they would jump between sections of the helical teeth",
    Limit.OTHER_MESH: "they would be too high for the gear's other mesh",
}
"""Why tips of full height are shortened; undercut and pointed tips have advices of their own."""

NEGLIGIBLE = 0.02
"""Share of the contact ratio that undercut or lower tips may cost before they matter: a few hundredths of a pitch,
where standards ask for a contact ratio to a tenth.  The hundredth of a flank that is kept clear of its cusp costs both
gears together somewhat over one per cent, however little is undercut."""


class DamagedTeeth(NamedTuple):
    """Teeth of one gear, and what they have lost."""

    gear: str
    teeth: list[int]
    loss: Loss

    def __str__(self) -> str:
        lost = f"by up to {micrometres(self.loss.amount_mm)} (tooth {self.loss.tooth})"
        return f"{teeth_words(self.teeth)} of the {self.gear} gear, {lost}"


def undercut(drive: Drive) -> Advice | None:
    """Teeth that a tool of full depth would cut into."""
    found = _found(drive, lambda gear: gear.tips.undercut, lambda gear, _: undercutting(gear))
    if not found:
        return None
    allowed = drive.gears.undercut == "allow"
    shorter = _found(drive, partial(_lowered, reason=Limit.UNDERCUT), shortening)
    meaning = "the flanks are cut away near the root, which weakens the teeth and shortens the contact"
    if not allowed:
        tips = f" ({_named(shorter)})" if shorter else ""
        meaning = f"the mating tips are shortened instead{tips}, so that all flanks are exact; the contact is shorter"
    what = f"{_counted(found)} {'are' if allowed else 'would be'} undercut"
    named = f"{'' if allowed else 'at full height '}{_named(found)}"
    told = _judged(drive, Advice(Kind.UNDERCUT, what, meaning), named, found if allowed else shorter)
    return replace(told, remedies=_ways_out_of_undercut(drive)) if told.matters else told


def _judged(drive: Drive, told: Advice, named: str, shorter: list[DamagedTeeth]) -> Advice:
    """What is told of named teeth whose contact is shorter, as a remark where that costs hardly any contact."""
    cost = sum(tooth_loss.loss.contact_pitches for tooth_loss in shorter)
    if cost >= NEGLIGIBLE * drive.designed_contact.contact_ratio:
        return replace(told, meaning=f"{named}; {told.meaning}")
    share = to_digits(100.0 * NEGLIGIBLE, 2)
    lost = f"at most {to_digits(cost, 2)} pitches of contact, less than {share} % of the contact ratio"
    meaning = f"{named}; it costs {lost if cost else 'no contact'} and does not matter"
    return replace(told, meaning=meaning, remedies=(), matters=False)


def _ways_out_of_undercut(drive: Drive) -> tuple[Remedy, ...]:
    """The remedies; each alone leaves no tooth undercut, wherever the teeth stand on the pitch curves."""
    enough = enough_teeth(drive)
    remedies = [
        Remedy(f"from {enough} driving teeth at this centre distance there is none", changed(resized(drive, enough)))
    ]
    if (found := shift_free_of_undercut(drive)) is not None:
        modules = found[0] / drive.rack.module_mm
        words = f"shift the profiles, by {to_digits(modules, 3)} modules outwards on the driving gear"
        remedies.append(Remedy(words, changed(found[1])))
    if steeper := steeper_rack(drive, STEEPEST_DEG):
        remedies.append(Remedy("take a rack with a greater pressure angle", changed(steeper)))
    return tuple(remedies)


def pointed(drive: Drive) -> Advice | None:
    """Teeth whose flanks meet, or nearly, below the full height."""
    found = _found(drive, partial(_lowered, reason=Limit.LAND), shortening)
    if not found:
        return None
    least = drive.gears.least_tip_land
    what = f"the tips of {_counted(found)} are shortened: their lands would be under {least:g} modules wide"
    meaning = "a sharp tip chips when hardened and wears fast, so it ends lower; the contact is shorter for it"
    lower = (Remedy("make all teeth so low", changed(blunt)),) if (blunt := blunt_addendum(drive)) else ()
    ways_out = (*lower, *_closer(drive), FINER)
    return _judged(drive, Advice(Kind.POINTED, what, meaning, ways_out), _named(found), found)


def _closer(drive: Drive) -> tuple[Remedy, ...]:
    """Less backlash, which leaves thicker teeth, where there is any."""
    return (CLOSER,) if getattr(drive.gears, backlash_key(drive.gears)) else ()


def shortened(drive: Drive) -> list[Advice]:
    """Tips that are shortened for another reason than their point, one advice for each reason."""
    advices = []
    for reason, words in MEANINGS.items():
        found = _found(drive, partial(_lowered, reason=reason), shortening)
        if found:
            short, _, since = words.partition(", ")
            what, meaning = f"the tips of {_counted(found)} are shortened: {short}", "their contact is shorter"
            ways_out = (FLATTER,) if reason is Limit.HELIX else (*_closer(drive), FINER)
            named = f"{since}: {_named(found)}" if since else _named(found)
            advices.append(_judged(drive, Advice(Kind.SHORTENED, what, meaning, ways_out), named, found))
    return advices


def _lowered(gear: ToothedGear, reason: Limit) -> Mask:
    """Flanks whose tips a reason limits below the rack's full height; raised tips may be limited above it."""
    return (gear.flanks.tip_height_mm < gear.flanks.full_tip_mm) & (gear.tips.limit == reason)


def _found(
    drive: Drive, marked: Callable[[ToothedGear], Mask], loss: Callable[[ToothedGear, Mask], Loss]
) -> list[DamagedTeeth]:
    """The teeth of each gear with marked flanks, and what these have lost; empty where there are none."""
    both = (("driving", drive.teeth.driving), ("driven", drive.teeth.driven))
    masks = [(name, gear, marked(gear)) for name, gear in both]
    return [
        DamagedTeeth(name, sorted({int(tooth) for tooth in gear.flanks.tooth[mask]}), loss(gear, mask))
        for name, gear, mask in masks
        if mask.any()
    ]


def _counted(found: list[DamagedTeeth]) -> str:
    numbers = " and ".join(f"{len(counted.teeth)} {counted.gear}" for counted in found)
    return f"{numbers} {'tooth' if numbers.startswith('1 ') and len(found) == 1 else 'teeth'}"


def _named(found: list[DamagedTeeth]) -> str:
    return "; ".join(map(str, found))


def contact_ratio(drive: Drive) -> Advice | None:
    """Flanks that lose contact, unless the overlap of helical teeth bridges the gap; idle ones if they are to hold."""
    designed = drive.designed_contact
    judged = (designed.pushing, designed.back) if drive.gears.drives == "both_ways" else (designed.pushing,)
    sides = [side for side in judged if _parts(drive, side)]
    if not sides:
        return None
    extremes = drive.contact_extremes
    found = {PUSHING: extremes.pushing_error_rad, BACK: extremes.back_error_rad}
    error = max(found[side.side].width for side in sides)
    places = [placed(degrees(float(designed.placement.phi1_rad[side.pairs.parted_at]))) for side in sides]
    helix, words = bridging_helix(drive), "make the teeth helical, so that the next ones touch before these part"
    helical = (Remedy(words, changed(helix)),) if helix else ()
    return Advice(
        Kind.CONTACT_RATIO,
        f"at some positions no flanks touch, off the law by {to_digits(1e6 * error, 2)} {MICRORAD}",
        f"so at phi1 = {', '.join(places)} deg, since the shortest contact of a flank pair lasts "
        f"{to_digits(min(side.pairs.least_arc for side in sides), 3)} pitches; the driven gear is carried by an edge "
        "there, and it knocks and wears",
        (*helical, FINER),
    )


def parted_in_time(partings: int, apart_s: float, whole_s: float) -> Advice:
    """How often and how long pushing flanks part in the motion in time, which no other command follows."""
    whole = f"{to_digits(whole_s, 3)} s"
    times = "once" if partings == 1 else f"{partings} times"
    what = f"in time the pushing flanks part {times}, {to_digits(apart_s, 3)} s of {whole} in all"
    if not partings:
        what = f"in time the pushing flanks never part within {whole}"
    return Advice(Kind.CONTACT_RATIO, what, "they knock when they meet again" if partings else "", matters=False)


def idle_flanks(drive: Drive) -> Advice | None:
    """Idle flanks that would not hold as pushing ones must, where the driving gear is said to push only."""
    designed, (_, short) = drive.designed_contact, drive.short_contacts
    parts = _parts(drive, designed.back)
    if drive.gears.drives == "both_ways" or (short is None and not parts):
        return None
    return Advice(
        Kind.IDLE_FLANKS,
        "idle flanks part; they knock where masses or a weight turn the torque round",
        f"{short or 'at some positions none touch'}; drives: both_ways refuses such teeth",
        (FINER,),
    )


def _parts(drive: Drive, side: SideContact) -> bool:
    """Whether flanks lose contact that a helix does not bridge."""
    return side.pairs.longest_gap > drive.overlap_ratio * drive.designed_contact.placement.per_tooth


def thrust(drive: Drive) -> Advice | None:
    """The thrust of helical teeth along their axes; none where both shafts have bearings, which are judged with it."""
    helix, around = drive.helix, drive.design.drivetrain
    shafts = (around.driving_shaft, around.driven_shaft) if around else ()
    if helix is None or not helix.thrust_share or (shafts and all(shaft and shaft.bearing_a for shaft in shafts)):
        return None
    towards, away = ("growing", "falling") if helix.hand == "right" else ("falling", "growing")
    return Advice(
        Kind.THRUST,
        f"an axial thrust of {to_digits(helix.thrust_share, 3)} of the tangential force loads both shafts",
        f"at the pitch point it pushes the driving gear towards {towards} z and the driven one towards {away} z; the "
        "bearings of both shafts must take it",
        (Remedy("herringbone teeth cancel it", (Change("gears.helix.kind", "herringbone"),)),),
    )


SPREAD = Remedy("smaller bends, or bends to both sides, spread the row")


def room(drive: Drive) -> list[Advice]:
    """Gears of a row that do not mesh, and meet somewhere in the turn."""
    meeting = (distance for distance in drive.whole.row_room if distance.least_distance_mm <= 0.0)
    names = (
        (f"{distance.first} and {distance.second}".replace("_", " "), placed(degrees(distance.at_rad)))
        for distance in meeting
    )
    what = [f"{gears} meet at phi1 = {place} deg" for gears, place in names]
    return [Advice(Kind.ROOM, said, "the row cannot turn past there", (SPREAD,)) for said in what]


NEARLY_ALL = 0.995

OTHER_WAYS = Remedy("take finer tolerances or larger teeth: so much backlash would leave no teeth")


def jams(drive: Drive) -> Advice | NotJudged | None:
    """Assemblies of a pair that jam, as estimated; None where no more than one in a hundred does.

    Not judged where the file gives a backlash of 0, since the exact pair is wanted then, where no grade holds for the
    gears, and where another pair in series with these has no sound contact.
    """
    try:
        found = jamming_of(drive)
    except DesignError as error:
        return NotJudged(error.problem)
    if found.share <= MOST_JAMMED:
        return None
    share = "nearly all" if found.share > NEARLY_ALL else f"about {to_digits(100.0 * found.share, 2)} % of the"
    if found.given == 0.0 and is_given(drive.design, found.key):
        return NotJudged(f"a backlash of 0 is written down: {share} assemblies of the exact pair jam")
    unit = found.key.rpartition("_")[2]
    has = f"the backlash is {found.given:g} {unit}" if found.given else "the teeth have no backlash"
    if thickness_limits_mm(drive.gears):
        has += ", the teeth are the thickest that the file allows"
    return Advice(
        Kind.JAMS,
        f"{share} assemblies jam, {f'{found.process} as usual' if found.process else 'made as tolerances says'}",
        f"{has}, and with {', '.join(limit_words(found.tolerances))} it takes {found.enough:g} {unit} for 99.9 % to "
        "turn: both flanks of a tooth are pressed somewhere; ncgear tolerance draws assemblies one by one",
        _ways_out(found),
    )


def _ways_out(found: Jamming) -> tuple[Remedy, ...]:
    backlash = Remedy("give the teeth so much backlash", (Change(found.key, found.enough),))
    narrower = Remedy(
        "make the gears narrower: over their width tilted teeth take the backlash", changed(found.narrower)
    )
    ways = (*([narrower] if found.narrower else []), *([backlash] if found.fits else []))
    return ways or (OTHER_WAYS,)


def index_holes(drive: Drive) -> Advice | NotJudged | None:
    """The gears that have no room for the index hole that the file asks for; None where both have theirs."""
    try:
        plans = dict(zip(Gear, drive.finished_plans, strict=True))
    except DesignError as error:
        return NotJudged(error.problem)
    lacking = [gear for gear in Gear if plans[gear].index_hole is None]
    if not lacking:
        return None
    names = " and ".join(gear.value for gear in lacking)
    what = f"no room for the index hole of the {names} gear{'s' if lacking[1:] else ''}"
    found = [room_for_index_hole(drive, gear) for gear in lacking]
    room = (
        [Remedy("make room for it", changed({key: holes[key] for holes in found for key in holes}))]
        if all(found)
        else []
    )
    without = Remedy("do without, and mark a tooth and its space by hand", (Change("gears.index_holes", value=False),))
    meaning = "nothing on them shows which teeth go together"
    return Advice(Kind.INDEX_HOLES, what, meaning, (*room, without))
