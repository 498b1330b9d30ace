"""Other values for wishes and limits that no law keeps, checked by trying them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from ncgear.design.keys.design import Design
from ncgear.design.keys.optimize import Optimize
from ncgear.design.words import spellings
from ncgear.errors import DesignError
from ncgear.extras import installed
from ncgear.frozen import dataclass
from ncgear.optimum.makeable.wishes import Wishes
from ncgear.optimum.offers import Refused
from ncgear.optimum.task import Task
from ncgear.project.law_task import wishes_of
from ncgear.wishes.wish import Offer

if TYPE_CHECKING:
    from ncgear.optimum.makeable.law import Eased

ROOMS = (0.0, 0.005, 0.02, 0.08)
"""Shares by which limits are eased beyond the need of a law with few knots; tried in turn until one is enough."""


def asking_for(design: Design, offers: Sequence[Offer]) -> Design:
    """The design with the values of offers; raises ValidationError or DesignError where a file may not ask for them."""
    for key, value in (value for offer in offers for value in offer.values):
        group, *path = key.split(".")
        model = getattr(design, group) or Optimize()
        data = model.model_dump(by_alias=True, exclude_unset=True)
        _put(data, path, value)
        design = design.model_copy(update={group: type(model).model_validate(data)})
    wishes_of(design)
    return design


def _put(data: dict[str, Any], path: Sequence[str], value: Any) -> None:
    """Set a key of nested groups and lists; the same angle in another unit is removed."""
    *groups, name = path
    within: Any = data
    for group in groups:
        if isinstance(within, dict):
            held = within.setdefault(group, {})
            # Lists of models are tuples, which are immutable.
            within[group] = within = list(held) if isinstance(held, tuple) else held
        else:
            within = within[int(group)]
    for spelled in spellings(name.removesuffix("_deg")) if name.endswith("_deg") else ():
        within.pop(spelled, None)
    within[name] = value


def may_be_asked(design: Design, offers: Sequence[Offer]) -> bool:
    """Whether a file with the values of all offers can be read and its wishes do not contradict each other."""
    try:
        asking_for(design, offers)
    except (ValidationError, DesignError):
        return False
    return True


def with_what_was_found(
    design: Design, task: Task, wishes: Wishes, refused: Refused, has_law: Callable[[Design], bool]
) -> Refused:
    """The refusal with the offers that a file may ask for, followed by offers with which laws were found, if any.

    Where no single limit is enough, all limits that must give way together are named in its place, with values for
    which a law was found that keeps every wish; ``has_law`` tries a design.  Without the optimiser, all offers are only
    guesses.
    """
    refused = refused.among(lambda offers: may_be_asked(design, offers))
    if not installed("casadi"):
        return refused
    from ncgear.optimum.makeable.law import found_instead

    tried = RefusedDesign(design, task, has_law)
    each = [offer for eased in found_instead(task, wishes) for offer in tried.enough(eased)]
    if not any(map(_is_limit, each)):
        if limits := _together(tried, wishes, limits_alone=True):
            return Refused(refused.said, [*limits, *each], refused.key, _limits, each=False, found=True)
        if not each and (found := _together(tried, wishes, limits_alone=False)):
            return Refused(refused.said, found, refused.key, _all, each=False, found=True)
    if not each:
        return refused
    if refused.found and refused.each:
        return Refused(refused.said, each, each[0].key, refused.told, each=True, found=True)
    return Refused(refused.said if refused.found else refused.problem, each, refused.key, _each, each=True, found=True)


def _together(tried: RefusedDesign, wishes: Wishes, *, limits_alone: bool) -> list[Offer]:
    """Limits, with values, that together allow a law that keeps all wishes; wishes too unless ``limits_alone``.

    Empty where none were found.
    """
    from ncgear.optimum.makeable.law import found_together

    eased = found_together(tried.task, wishes, limits_alone=limits_alone)
    return [] if eased is None else tried.enough(eased, ROOMS[1:])


@dataclass(frozen=True, eq=False)
class RefusedDesign:
    """A design whose wishes are refused, its machine, and the function that tries a whole design.

    With masses, other wishes lead to other gears, whose inertia counts: such a design is tried as a whole.
    """

    design: Design
    task: Task
    has_law: Callable[[Design], bool]

    def enough(self, eased: Eased, rooms: Sequence[float] = ROOMS) -> list[Offer]:
        """The offers, eased until a search with their values finds a law; empty where a file may not ask for them."""
        from ncgear.optimum.makeable.law import keeps_all

        for room in rooms:
            offers = eased(room)
            if not offers or not may_be_asked(self.design, offers):
                return []
            asking = asking_for(self.design, offers)
            if keeps_all(self.task, wishes_of(asking)) and (asking.masses is None or self.has_law(asking)):
                return offers
        return []


def _is_limit(offer: Offer) -> bool:
    return not offer.key.startswith("wishes.")


def _each(said: str, offers: Sequence[Offer]) -> str:
    found = "a law was found with" if len(offers) == 1 else "laws were found with each of these:"
    return f"{said}; {found} {', '.join(map(str, offers))}"


def _all(said: str, offers: Sequence[Offer]) -> str:
    return f"{said}; a law was found with all of these together: {', '.join(map(str, offers))}"


def _limits(said: str, offers: Sequence[Offer]) -> str:
    """The words for limits that must give way together, or for one of the wishes."""
    limits, wishes = (
        ", ".join(str(offer) for offer in offers if _is_limit(offer) is of_limits) for of_limits in (True, False)
    )
    all_of = "" if sum(map(_is_limit, offers)) == 1 else " all of these together:"
    either = f"; with the limits as they are, one with {wishes}" if wishes else ""
    return f"{said}; a law that keeps every wish was found with{all_of} {limits}{either}"
