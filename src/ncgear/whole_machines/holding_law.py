"""The best law whose teeth hold: laws are sought under caps of two loads, and their gears are rated, until both agree.

Stress against pitting grows with the root of the flank load, stress against breakage with the force between the teeth
(docs/method.md).  So the rating of a law's gears says how much of both loads the next law may have.  Local teeth,
knocks and factors that follow the law change with it, so that caps are corrected in rounds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf
from typing import TYPE_CHECKING

from ncgear.design.keys.design import Design
from ncgear.design.keys.optimize import Optimize
from ncgear.errors import DesignError, NoSuchMechanism, WrongInput
from ncgear.figures.advice.strength_advice import unfollowed_motion
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.task import Figures
from ncgear.project.best_law import BestLaw, motion_keys
from ncgear.project.law_task import drive_with, wishes_of
from ncgear.project.strengthening import rating_of
from ncgear.strength.holding import Damage

if TYPE_CHECKING:
    from ncgear.optimum.certified.limit import Motion

KEY = "optimize.limits.teeth_hold"

CAPPED = {Damage.CONTACT: ("flank_load_n_mm", 2.0), Damage.BENDING: ("tooth_force_n", 1.0)}
"""For each damage the load that is capped, and the power of the safety to which the load is in proportion."""

GOALS = {Damage.CONTACT: "least_flank_load", Damage.BENDING: "least_tooth_force"}
"""The goals of the laws with the least of these loads."""

AIMED = 1.003
"""Share of the wanted safety for which caps are set, so that the next law holds although factors change a little."""

NEAR = 1.01
"""Share of the wanted safety up to which a capped law counts as the best: caps of the next law differ by less than
2 %, which is less than the rating knows."""

EASED = 1.005
"""Least ratio of a cap to the load of the law that has the least: from there a search has room to move."""

MOST_LAWS = 8
"""Most laws that are found in sequence; two or three are usual."""

Caps = Mapping[Damage, float]
"""A number for each damage."""


class CappedLaw(BestLaw):
    """The best law under caps of loads besides the limits of ``asked``; its certified limit is that of all laws."""

    def __init__(self, asked: BestLaw, caps: Caps, begin: BestLaw | None = None) -> None:
        super().__init__(_capped(asked.given, caps), *asked.settings)
        self._asked, self._begin = asked, begin

    @property
    def known_motion(self) -> Motion | None:
        """The motion of the law to begin with, if one is given."""
        return super().known_motion if self._begin is None else self._begin.law.motion

    @property
    def asked(self) -> Optimize:
        """Goal and limits as the design file asks for them, without the caps."""
        return self._asked.asked

    @property
    def wishes_of_limit(self) -> Wishes:
        """The wishes as asked: which caps make teeth hold depends on the law, so they are no part of the proof."""
        return wishes_of(self._asked.design)


def holding(best: BestLaw, on_law: Callable[[int], None] = lambda laws: None) -> BestLaw:
    """The best law whose teeth hold: ``best`` if its teeth do, else the best law found under caps of its loads.

    ``on_law`` is called with the number of laws that were rated.  Raises NoSuchMechanism where no law was found whose
    teeth hold, and WrongInput where the teeth of a law cannot be rated or judged.
    """
    asked, caps, held, eased = best, dict[Damage, float](), None, False
    nearest, other = dict[Damage, float](), ""
    for laws in range(1, MOST_LAWS + 1):
        on_law(laws)
        shares, loads = _shares(best), _loads(best.figures)
        nearest = max(nearest, shares, key=lambda tried: min(tried.values(), default=0.0))
        if all(share >= 1.0 for share in shares.values()):
            held = best if held is None or best.goal < held.goal else held
        if held is best and min((shares[damage] for damage in caps), default=1.0) <= NEAR:
            break
        weak = [damage for damage, share in shares.items() if share < 1.0 or damage in caps]
        caps |= {damage: loads[damage] * (shares[damage] / AIMED) ** CAPPED[damage][1] for damage in weak}
        try:
            best = _found(asked, caps)
        except NoSuchMechanism:
            if held is not None or eased:
                break
            eased = True
            try:
                least = _of_least_load(asked, min(shares, key=lambda damage: shares[damage]))
                other = least.wishes.goal.value if min(_shares(least).values()) >= 1.0 else ""
                caps |= {
                    damage: max(caps[damage], EASED * load)
                    for damage, load in _loads(least.figures).items()
                    if damage in caps
                }
                best = _found(asked, caps, least)
            except DesignError:
                # Also where the gears of that law cannot be rated: the nearest law is told
                break
    if held is None:
        raise _refusal(nearest, laws, other)
    return held


def _found(asked: BestLaw, caps: Caps, begin: BestLaw | None = None) -> CappedLaw:
    """The law under caps, from the motion of another law on; raises NoSuchMechanism where none is found."""
    best = CappedLaw(asked, caps, begin)
    best.law  # noqa: B018
    return best


def _of_least_load(asked: BestLaw, damage: Damage) -> BestLaw:
    """The law with the least of the load that causes a damage, within the limits as asked."""
    goal = {"goal": GOALS[damage], "weights": None}
    design = asked.given.model_copy(update={"optimize": asked.asked.model_copy(update=goal)})
    best = BestLaw(design, *asked.settings)
    best.law  # noqa: B018
    return best


def _capped(design: Design, caps: Caps) -> Design:
    """The design with caps of loads; limits of the same loads that are lower stay."""
    asked = design.optimize
    assert asked is not None
    lower = {
        CAPPED[damage][0]: min(cap, getattr(asked.limits, CAPPED[damage][0]) or inf) for damage, cap in caps.items()
    }
    limits = asked.limits.model_copy(update=lower)
    return design.model_copy(update={"optimize": asked.model_copy(update={"limits": limits})})


def _loads(figures: Figures) -> dict[Damage, float]:
    """The loads of a law that are capped; known, since gears of a given size are asked for (``law_task``)."""
    return {damage: getattr(figures, name) for damage, (name, _) in CAPPED.items()}


def _shares(best: BestLaw) -> dict[Damage, float]:
    """The least safety of the law's teeth over the wanted safety, for each kind of damage that is rated."""
    try:
        rating = rating_of(drive_with(best.design, motion_keys(best.law)))
    except DesignError as error:
        raise WrongInput(f"true, but the teeth of the best law cannot be rated: {error}", key=KEY) from error
    if why := unfollowed_motion(rating):
        raise WrongInput(f"true, but the strength of the teeth is not judged: {why}", key=KEY)
    shares = dict[Damage, float]()
    for weakest in rating.weakest:
        shares[weakest.damage] = min(weakest.share, shares.get(weakest.damage, inf))
    return shares


def _refusal(shares: Caps, laws: int, other: str) -> NoSuchMechanism:
    """The refusal after the last rating: the shares of the nearest law, and another goal whose law's teeth hold."""
    damage, share = min(shares.items(), key=lambda damage_share: damage_share[1])
    rated = "of the only law" if laws == 1 else f"of {laws} laws the nearest"
    goal = f"the law of optimize.goal {other} has teeth that hold; " if other else ""
    return NoSuchMechanism(
        f"no law was found whose teeth hold: {rated} that was rated has {100.0 * share:.3g} % of the safety wanted "
        f"against {damage.words}; {goal}ncgear size finds gears that hold, and ncgear design law and gears together",
        key=KEY,
    )
