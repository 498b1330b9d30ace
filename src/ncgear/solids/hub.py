"""The room for the hub on a gear's upper face."""

from __future__ import annotations

from shapely import Point, Polygon

from ncgear.errors import WrongInput
from ncgear.solids.body import Hub
from ncgear.solids.largest import said_largest


def require_hub_room(disc: Polygon, hub: Hub, key: str) -> None:
    """Raise WrongInput for ``key``.hub.diameter_mm unless the hub stands within the gear's tooth roots.

    Then no hub reaches over its own outline, and hubs of two gears meet as little as their outlines do.
    """
    axis = Point(0.0, 0.0)
    largest = 2.0 * float(disc.exterior.distance(axis)) if disc.contains(axis) else 0.0
    if hub.diameter_mm <= largest:
        return
    right = said_largest(largest, "none fits about an axis outside the teeth")
    problem = f"a hub of {hub.diameter_mm:g} mm reaches over the tooth spaces, to where the mate's may be; {right}"
    raise WrongInput(problem, key=f"{key}.hub.diameter_mm")
