"""Thickness of the material under the roots of each tooth, up to the next edge of its gear's body."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import shapely

from ncgear.numerics.arrays import Array
from ncgear.solids.plan.body import BodyPlan
from ncgear.teeth.gear import ToothedGear
from ncgear.teeth.outline import exact_curves
from ncgear.teeth.reach import FILLET_CURVE, PROBES, ROOT_LAND


def walls_mm(gear: ToothedGear, plan: BodyPlan) -> Array:
    """The least wall in mm under both roots of each tooth, shape (z,); infinite where the body has no other edge.

    Edges are the bore with its keyway, holes, slots and the sides of pockets, and for a ring its rim.  A hole narrower
    than a pitch, such as the index hole, does not count as an edge: beside it the root stands on the body.
    """
    pitch_mm = pi * gear.flanks.rack.module_mm
    mark, pin = (
        hole if hole is not None and hole.diameter_mm >= pitch_mm else None
        for hole in (plan.index_hole, plan.crank_pin)
    )
    wide = tuple(hole for hole in plan.lightening_holes if hole.diameter_mm >= pitch_mm)
    section = replace(plan, lightening_holes=wide, index_hole=mark, crank_pin=pin).section
    edges = [section.exterior] if plan.is_ring else list(section.interiors)
    edges += [] if plan.web is None else [pocket.exterior for pocket in plan.web.pockets]
    flanks, curves = gear.flanks, exact_curves(gear.tips, gear.sides)
    found = np.full(flanks.count // 2, np.inf)
    if not edges:
        return found[: gear.teeth]
    every = shapely.union_all(edges)
    shapely.prepare(every)
    for kind in (FILLET_CURVE, ROOT_LAND):
        curve = curves[kind]
        rows = np.arange(curve.owner.size)
        points = curve.at(rows[:, None], PROBES)[0]
        least = shapely.distance(every, shapely.points(points)).min(axis=1)
        # A root belongs to the tooth of its flank, and a land to the teeth on both of its sides.
        np.minimum.at(found, curve.owner // 2 % found.size, least)
        if kind == ROOT_LAND:
            np.minimum.at(found, (curve.owner // 2 + 1) % found.size, least)
    return found[: gear.teeth]
