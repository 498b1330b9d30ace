"""Random design files: every law, every block of the schema, mostly near what can be made, and at times spoiled."""

from __future__ import annotations

from copy import deepcopy
from math import cos, pi
from typing import Any

import numpy as np
from hypothesis import strategies as st

from ncgear.design.laws.registry import LawName
from ncgear.design.reading.yaml import read_yaml
from ncgear.design.template import template
from ncgear.mechanisms.crank_slider import CrankSlider
from ncgear.numerics.jet import Jet

Data = dict[str, Any]
Draw = Any

LOBES = [(1, 1)] * 5 + [(1, 2), (2, 1), (2, 3), (3, 1)]

SPOILS = [0, -1, 3, 1e-9, -1e-9, 1e7, 1e12, 1e300, -1e300, float("nan"), float("inf"), None, True, "", "text", [], {}]
"""What comes in the place of a good value; most of it is wrong at most places."""


def number(low: float, high: float) -> st.SearchStrategy[float]:
    """A number as people write them: four digits."""
    return st.integers(0, 1000).map(lambda step: float(f"{low + (high - low) * step / 1000:.4g}"))


def at_times(values: st.SearchStrategy[Any], one_in: int = 4) -> st.SearchStrategy[Any]:
    """Values one time in so many, or else none; of equal strategies ``one_of`` would keep one only."""
    return st.integers(1, one_in).flatmap(lambda draw: values if draw == one_in else st.none())


def group(**values: st.SearchStrategy[Any]) -> st.SearchStrategy[Data]:
    """A group of keys, without those that have come out as none."""
    return st.fixed_dictionaries(values).map(
        lambda data: {key: value for key, value in data.items() if value is not None}
    )


# --- the machine


@st.composite
def linkages(draw: Draw) -> Data:
    """Rods from hardly longer than the crank on; offsets up to most of what the rod reaches."""
    crank = draw(number(5.0, 400.0))
    rod = crank * draw(st.one_of(number(1.001, 1.2), number(1.2, 6.0), number(1.2, 6.0)))
    offset = draw(at_times(number(-0.9, 0.9)))
    return {"crank_mm": crank, "rod_mm": rod, **({} if offset is None else {"offset_mm": offset * (rod - crank)})}


@st.composite
def yokes(draw: Draw) -> Data:
    """Scotch yokes."""
    return {"kind": "scotch_yoke", "crank_mm": draw(number(5.0, 400.0))}


@st.composite
def levers(draw: Draw) -> Data:
    """Slotted levers; at times the crank's circle reaches the lever's axis, or the lever is too short."""
    crank = draw(number(5.0, 200.0))
    pivot = crank * draw(st.one_of(number(1.05, 4.0), number(1.2, 2.5), number(0.95, 1.05)))
    return {
        "kind": "slotted_lever",
        "crank_mm": crank,
        "pivot_mm": pivot,
        "lever_mm": (pivot + crank) * draw(st.one_of(number(1.01, 2.0), number(0.98, 1.02))),
    }


@st.composite
def rockers(draw: Draw) -> Data:
    """Crank-rockers, whose coupler is at times a little too short or too long for the crank to turn fully."""
    crank = draw(number(5.0, 200.0))
    ground, rocker = (crank * draw(number(1.1, 6.0)) for _ in range(2))
    low, high = abs(ground - rocker) + crank, ground + rocker - crank
    return {
        "kind": "crank_rocker",
        "crank_mm": crank,
        "coupler_mm": low + (high - low) * draw(st.one_of(number(0.02, 0.98), number(0.1, 0.9), number(-0.05, 1.05))),
        "rocker_mm": rocker,
        "ground_mm": ground,
        **draw(group(side=at_times(st.sampled_from([1, -1])))),
    }


@st.composite
def racks_on_pinions(draw: Draw) -> Data:
    """Racks, each on a pinion on the driven shaft."""
    return {"kind": "rack_pinion", "radius_mm": draw(number(5.0, 100.0))}


EXPRESSIONS = ["200", "200 + 3*exp(x/900)", "5*x", "1000/(9 + x)", "300 - 2*x", "log(9 + x)*50", "sqrt(x)"]

resistances = st.one_of(
    group(
        polynomial_n=st.lists(number(-300.0, 500.0), min_size=1, max_size=2),
        where_negative=at_times(st.sampled_from(["zero", "keep"])),
    ),
    st.lists(st.tuples(number(1.0, 60.0), number(-50.0, 900.0)), min_size=2, max_size=8).map(
        lambda steps: {
            "table": {
                "displacement_mm": [sum(step for step, _ in steps[: i + 1]) for i in range(len(steps))],
                "force_n": [force for _, force in steps],
            }
        }
    ),
    group(expression_n=st.sampled_from(EXPRESSIONS)),
)

torques = st.one_of(
    group(
        polynomial_n_m=number(-5.0, 60.0).map(lambda torque: [torque]),
        where_negative=at_times(st.sampled_from(["zero", "keep"])),
    ),
    st.tuples(number(0.1, 20.0), number(0.0, 40.0), number(0.0, 6.0), st.integers(1, 3)).map(
        lambda of: {"expression_n_m": f"{of[0]} + {of[1]}*sin({of[3]}*x + {of[2]})"}
    ),
    number(0.1, 40.0).map(lambda torque: {"expression_n_m": f"{torque}*sin(x)"}),
    st.lists(number(-5.0, 60.0), min_size=2, max_size=6).map(
        lambda torques: {
            "table": {
                "angle_deg": [360.0 * i / len(torques) for i in range(len(torques) + 1)],
                "torque_n_m": [*torques, torques[0]],
            }
        }
    ),
)
"""Torques against an output that turns, nearly all the same after a turn."""


def both_ways(loads: st.SearchStrategy[Data], friction: str) -> st.SearchStrategy[Data]:
    """Loads out, and at times on the way back and by friction."""
    more = group(**{"returning": at_times(loads), friction: at_times(number(0.0, 20.0))})
    return st.tuples(loads, more).map(lambda parts: {**parts[0], **parts[1]})


published = group(
    name=st.sampled_from(["another", "a $ and \\frac", "ü"]),
    speed_rpm=number(10.0, 100.0),
    peak_power_w=number(1.0, 9000.0),
    peak_acceleration_mm_s2=at_times(number(1.0, 9000.0)),
)


BODY = {"mass_kg": number(0.1, 20.0), "center_mm": number(-20.0, 60.0)}
SWINGING = group(**BODY, inertia_kg_mm2=number(72_000.0, 1e6))
LINK = group(**BODY, inertia_kg_mm2=number(0.0, 1e5))

SHARED_MASSES = {
    "driven_gear_kg_mm2": at_times(number(0.0, 1e4)),
    "flywheel": at_times(group(inertia_kg_mm2=number(0.0, 1e6))),
}
MASSES = {
    "none": group(shaft_kg_mm2=number(0.0, 1e6), **SHARED_MASSES),
    "scotch_yoke": group(slider_kg=number(0.0, 50.0), crank=SWINGING, **SHARED_MASSES),
    "crank_rocker": group(rocker=SWINGING, coupler=LINK, crank=SWINGING, **SHARED_MASSES),
    "slotted_lever": group(
        slider_kg=number(0.0, 50.0),
        block_kg=at_times(number(0.0, 3.0)),
        lever=SWINGING,
        crank=SWINGING,
        **SHARED_MASSES,
    ),
}
"""What moves, by the kind of mechanism; none is gears by themselves."""


# --- motions


def strokes(linkage: Data) -> st.SearchStrategy[Data]:
    """The published baler's law, scaled to the linkage and changed; one quantity is left to be found."""

    @st.composite
    def made(draw: Draw) -> Data:
        solve_for = draw(st.sampled_from(["law_speed", "v1", "v2", "a1", "stroke"]))
        size, speed = linkage["crank_mm"] / 380.0, draw(number(10.0, 200.0))
        values = {
            "v1_mm_s": 1600.0 * size * speed / 52.81 * draw(number(0.8, 1.25)),
            "v2_mm_s": 1100.0 * size * speed / 52.81 * draw(number(0.7, 1.3)),
            "a1_mm_s2": -1500.0 * size * (speed / 20.0) ** 2 * draw(number(0.5, 1.5)),
            "law_speed_rpm": speed,
        }
        values.pop({"law_speed": "law_speed_rpm", "a1": "a1_mm_s2"}.get(solve_for, f"{solve_for}_mm_s"), None)
        angles = zip((0.4, 0.7, 1.0, 1.3), draw(st.tuples(*[number(-0.12, 0.12)] * 4)), strict=True)
        unit, full = draw(st.sampled_from([("pi", 1.0), ("deg", 180.0), ("rad", pi)]))
        return {
            "law": "three_segment_stroke",
            "solve_for": solve_for,
            **{f"theta{i}_{unit}": full * (angle + more) for i, (angle, more) in enumerate(angles, start=1)},
            **values,
            "return": draw(RETURNS),
        }

    return made()


RETURNS = st.one_of(
    st.just({"basis": "inverse_ratio"}),
    st.just({"e": "least_acceleration"}),
    number(-3.0, 3.0).map(lambda e: {"basis": "ratio", "e": e}),
    number(-1.0, 3.0).map(lambda e: {"basis": "inverse_ratio", "e": e}),
)


def ratio_expressions(lobes: tuple[int, int]) -> st.SearchStrategy[Data]:
    """Ratios and driven angles of the lobes' period, some of which touch zero."""
    driving, driven = lobes
    waves = st.tuples(number(0.0, 0.8), number(0.0, 0.3), st.integers(1, 3), number(0.0, 6.0))
    middle = driven / driving
    return st.one_of(
        waves.map(
            lambda wave: {
                "ratio": f"{middle!r}*(1 + {wave[0]}*cos({driving}*phi) + {wave[1]}*sin({wave[2] * driving}*phi))",
                "scale_to_close": True,
            }
        ),
        waves.map(
            lambda wave: {
                "driven_angle": f"phi/{middle!r} - {wave[0] / driven}*sin({driving}*phi)"
                f" - {wave[1] / wave[2]}*(cos({wave[2] * driving}*phi + {wave[3]}) - cos({wave[3]}))"
            }
        ),
        waves.map(lambda wave: {"ratio": f"{middle!r}*exp({wave[0]}*sin({driving}*phi))", "scale_to_close": True}),
    ).map(lambda values: {"law": "ratio_expression", **values})


def tables(linkage: Data | None, lobes: tuple[int, int]) -> st.SearchStrategy[Data]:
    """Points of a wave, some of them noisy, as ratio or as displacement of the crank-slider if there is one."""

    @st.composite
    def made(draw: Draw) -> Data:
        count, wave = draw(st.integers(4, 30)), draw(number(0.0, 0.6))
        noise = draw(at_times(st.lists(number(-0.05, 0.05), min_size=count, max_size=count)))
        phi = [2.0 * pi / lobes[0] * i / count for i in range(count)]
        around = [wave * cos(lobes[0] * angle) + (noise[i] if noise else 0.0) for i, angle in enumerate(phi)]
        if linkage is None or lobes != (1, 1) or draw(st.booleans()):
            ratio = [lobes[1] / lobes[0] * (1.0 + value) for value in around]
            return {"law": "table", "phi1_rad": phi, "ratio": ratio, "scale_to_close": draw(st.booleans())}
        phi = np.linspace(0.0, 2.0 * pi, 2 * count, endpoint=False)
        slider = CrankSlider(linkage["crank_mm"], linkage["rod_mm"], linkage.get("offset_mm", 0.0))
        # Half way round is the extended dead centre.
        ends = np.array([0.0, slider.working_angle_rad, 2.0 * pi])
        crank_angle = np.interp(phi - wave * np.sin(phi), [0.0, pi, 2.0 * pi], ends)
        places = slider.displacement(Jet(crank_angle[None, :])).value
        return {"law": "table", "phi1_deg": np.degrees(phi).tolist(), "displacement_mm": places.tolist()}

    return made()


harmonics = st.tuples(st.lists(number(-0.6, 0.6), max_size=5), st.lists(number(-0.6, 0.6), max_size=5)).map(
    lambda rows: {
        "cosine": [value / (i + 1) ** 2 for i, value in enumerate(rows[0])],
        "sine": [value / (i + 1) ** 2 for i, value in enumerate(rows[1])],
    }
)

ellipses = st.one_of(
    group(eccentricity=number(0.0, 0.7), phase_deg=at_times(number(-360.0, 720.0), 2)),
    group(eccentricity=number(0.0, 0.99), phase_pi=at_times(number(0.0, 2.0), 2)),
).map(lambda values: {"law": "ellipse", **values})


PITCH_CURVES = st.one_of(
    group(
        ellipse=group(
            semi_major_mm=number(10.0, 40.0),
            semi_minor_mm=number(8.0, 40.0),
            axis_x_mm=at_times(number(-9.0, 9.0), 2),
            axis_y_mm=at_times(number(-9.0, 9.0), 2),
        )
    ),
    group(
        modified_ellipse=group(
            semi_latus_rectum_mm=number(10.0, 40.0),
            eccentricity=number(0.0, 0.6),
            lobes=at_times(st.integers(1, 4), 2),
            modification=at_times(number(0.6, 1.8), 2),
        )
    ),
    group(
        rounded_polygon=group(sides=st.integers(3, 6), side_mm=number(40.0, 80.0), corner_radius_mm=number(2.0, 20.0))
    ),
    group(expression_mm=st.sampled_from(["30 + 4*cos(phi)", "30 + 2*cos(6*phi)", "30 + sin(phi)**3", "30 + phi"])),
    group(
        b_spline=group(
            x_mm=st.just([30.0, 4.0, -28.0, -2.0]), y_mm=st.just([1.0, 25.0, 3.0, -27.0]), degree=st.integers(2, 4)
        )
    ),
)


def pitch_curves() -> st.SearchStrategy[Data]:
    """Shapes that are closed by their size, and at times by the centre distance, turned at times."""
    closing = st.sampled_from(["scale", "scale", "center_distance"])
    more = group(law=st.just("pitch_curve"), solve_for=closing, phase_deg=at_times(number(0.0, 360.0)))
    return st.tuples(PITCH_CURVES, more, at_times(st.just({"gear": "driven"}))).map(
        lambda parts: {**parts[0], **parts[1], **(parts[2] or {})}
    )


@st.composite
def traced_curves(draw: Draw) -> Data:
    """Points of a wavy round curve, some hundredths of a millimetre off, in polar form or in the plane."""
    count, wave, places = draw(st.integers(12, 60)), draw(number(0.0, 0.3)), draw(st.integers(1, 3))
    off = draw(st.lists(number(-0.03, 0.03), min_size=count, max_size=count))
    angle = np.linspace(0.0, 2.0 * pi, count, endpoint=False)
    radius = 30.0 * (1.0 + wave / places * np.cos(places * angle)) + np.array(off)
    points = {"phi_deg": np.degrees(angle).tolist(), "radius_mm": radius.tolist()}
    if draw(st.booleans()):
        points = {"x_mm": (radius * np.cos(angle)).tolist(), "y_mm": (radius * np.sin(angle)).tolist()}
    closing = draw(st.sampled_from(["scale", "center_distance"]))
    tolerance = draw(st.sampled_from([0.01, 0.05, 0.2]))
    return {"law": "pitch_curve", "points": {**points, "tolerance_mm": tolerance}, "solve_for": closing}


FOUND_CURVES = st.one_of(
    number(15.0, 24.0).flatmap(
        lambda major: group(
            solve_for=st.just("semi_minor"),
            ellipse=group(
                semi_major_mm=st.just(major),
                axis_x_mm=at_times(number(-0.2 * major, 0.2 * major)),
                axis_y_mm=at_times(number(-0.2 * major, 0.2 * major)),
            ),
        )
    ),
    group(
        solve_for=st.just("semi_major"), ellipse=group(semi_minor_mm=number(15.0, 20.0), axis_x_mm=number(-4.0, 4.0))
    ),
    group(
        solve_for=st.just("eccentricity"),
        modified_ellipse=group(
            semi_latus_rectum_mm=number(14.0, 20.0), lobes=at_times(st.integers(1, 3)), modification=number(0.8, 1.4)
        ),
    ),
    group(
        solve_for=st.just("side"), rounded_polygon=group(sides=st.integers(3, 6), corner_radius_mm=number(3.0, 12.0))
    ),
    group(solve_for=st.just("corner_radius"), rounded_polygon=group(sides=st.just(4), side_mm=number(36.0, 39.5))),
).map(lambda values: {"law": "pitch_curve", "center_distance_mm": 40.0, **values})
"""Curves of which one quantity is found for a centre distance of 40 mm; mostly there is one."""

FUNCTIONS = [
    ("log(x)", 1.0, 5.0),
    ("exp(x)", 0.0, 1.2),
    ("1/x", 1.0, 2.5),
    ("x + 0.1*sin(3*x)", 0.0, 3.0),
    ("x**2", 0.5, 1.5),
    ("sqrt(x)", 0.0, 1.0),
]

open_motions = st.one_of(
    group(
        law=st.just("spiral"), range_deg=number(20.0, 330.0), ratio_start=number(0.5, 2.2), ratio_end=number(0.5, 2.2)
    ),
    st.tuples(st.sampled_from(FUNCTIONS), number(60.0, 320.0), number(0.7, 1.4)).map(
        lambda of: {
            "law": "function_generator",
            **dict(zip(("function", "x_from", "x_to"), of[0], strict=True)),
            "driving_range_deg": of[1],
            "driven_range_deg": of[1] * of[2],
        }
    ),
    st.tuples(number(0.7, 1.6), number(0.0, 0.5), number(0.3, 1.5), number(30.0, 320.0), st.booleans()).map(
        lambda of: {
            "law": "ratio_expression",
            "range_deg": of[3],
            **(
                {"driven_angle": f"{of[0]}*phi + {of[1]}*sin({of[2]}*phi)"}
                if of[4]
                else {"ratio": f"{of[0]}*(1 + {of[1]}*cos({of[2]}*phi))"}
            ),
        }
    ),
)
"""Laws of gears that turn less than once."""


def motions(linkage: Data | None, lobes: tuple[int, int]) -> st.SearchStrategy[Data]:
    """Any law that a crank-slider can have or, without one, any law of a ratio."""
    uniform = st.just({"law": "uniform_crank"})
    strategies = {
        LawName.THREE_SEGMENT_STROKE: strokes(linkage) if linkage and lobes == (1, 1) else uniform,
        LawName.RATIO_EXPRESSION: ratio_expressions(lobes),
        LawName.TABLE: tables(linkage, lobes),
        LawName.ELLIPSE: ellipses,
        LawName.PITCH_CURVE: pitch_curves(),
        LawName.UNIFORM_CRANK: uniform,
        LawName.HARMONIC_RATIO: group(law=st.just("harmonic_ratio"), second_stage=at_times(harmonics)).flatmap(
            lambda motion: harmonics.map(lambda rows: {**motion, **rows})
        ),
    }
    return st.one_of(*strategies.values(), *(near_template(law) for law in LawName if law not in strategies))


def near_template(law: LawName) -> st.SearchStrategy[Data]:
    """Values near the template's, fractions within 50 %, for a law that has no strategy of its own."""
    motion = read_yaml(template("random", law), "template").data["motion"]
    values = {
        key: number(0.5 * value, 1.5 * value) if isinstance(value, float) else st.just(value)
        for key, value in motion.items()
    }
    return group(**values)


# --- gears


racks = group(
    profile=at_times(st.sampled_from("ABCD")),
    pressure_angle_deg=at_times(st.sampled_from([14.5, 17.5, 20.0, 22.5, 25.0])),
    idle_pressure_angle_deg=at_times(st.sampled_from([14.5, 20.0, 25.0, 30.0]), 4),
    addendum=at_times(number(0.7, 1.2), 6),
    dedendum=at_times(number(1.1, 1.5), 6),
    root_radius=at_times(number(0.0, 0.4), 6),
    tip_relief=at_times(group(amount=number(0.002, 0.02), start=at_times(number(0.2, 0.9))), 6),
)

shifts = st.one_of(
    group(driving=at_times(number(-0.6, 0.6), 2), driven=at_times(number(-0.6, 0.6), 2)),
    st.just({"against_undercut": True}),
    group(per_tooth=st.lists(number(-0.4, 0.4), min_size=1, max_size=4)),
)

cutters = st.one_of(
    group(kind=st.sampled_from(["auto", "rack", "mate"])),
    group(kind=st.just("pinion"), teeth=at_times(st.integers(8, 60), 2)),
)


@st.composite
def bodies(draw: Draw, largest_mm: float) -> Data:
    """A bore, with a keyway at times."""
    bore = draw(number(0.05, 0.6)) * largest_mm
    keyway = draw(at_times(group(width_mm=number(0.2, 0.6), depth_mm=number(0.1, 0.3))))
    return {"bore_mm": bore, **({"keyway": {key: bore * part for key, part in keyway.items()}} if keyway else {})}


@st.composite
def sizes(draw: Draw, lobes: tuple[int, int], teeth: tuple[int, int]) -> Data:
    """Two of teeth, module and centre distance."""
    count = lobes[0] * max(draw(st.integers(*teeth)) // lobes[0], 3)
    module = draw(st.sampled_from([0.5, 1.0, 1.5, 2.0, 3.0, 10.0]))
    if draw(st.integers(0, 3)):
        return {"teeth": count, "module_mm": module}
    distance = count * module * (1.0 + lobes[1] / lobes[0]) / 2.0
    return {"teeth": count, "center_distance_mm": distance}


@st.composite
def gears(draw: Draw, lobes: tuple[int, int], teeth: tuple[int, int]) -> Data:
    """Spur, helical and internal gears."""
    size = draw(sizes(lobes, teeth))
    ring = lobes[1] > lobes[0] and draw(st.booleans())
    blank = bodies(0.7 * size["teeth"] * size.get("module_mm", 1.0))
    rim = number(1.0, 20.0).map(lambda mm: {"rim_mm": mm})
    values = draw(
        group(
            rack=at_times(racks, 2),
            helix=at_times(HELICES, 8),
            backlash_mm=at_times(number(0.0, 0.1), 2),
            profile_shift=at_times(shifts),
            cutter=at_times(cutters, 2),
            undercut=at_times(st.sampled_from(["avoid", "allow"])),
            least_tip_land=at_times(number(0.01, 0.5)),
            least_contact_ratio=st.sampled_from([None, 0.0, 0.0, 1.2]),
            method=at_times(st.sampled_from(["exact", "equivalent_gear"]), 8),
            index_holes=at_times(st.booleans()),
            driving=at_times(blank, 2),
            driven=at_times(rim if ring else blank, 2),
        )
    )
    mesh = {"mesh": "internal"} if ring else {}
    return {**size, **mesh, "lobes": {"driving": lobes[0], "driven": lobes[1]}, "face_width_mm": 10.0, **values}


HELICES = group(
    angle_deg=number(5.0, 30.0),
    kind=st.sampled_from(["helical", "herringbone"]),
    hand=st.sampled_from(["right", "left"]),
)


# --- whole files


@st.composite
def slider_designs(draw: Draw, teeth: tuple[int, int]) -> Data:
    """A crank-slider on gears that turn on and on."""
    linkage, lobes = draw(linkages()), draw(st.sampled_from(LOBES))
    motion = draw(motions(linkage, lobes))
    if motion.get("solve_for") == "stroke":
        linkage = {key: value for key, value in linkage.items() if key != "crank_mm"}
    values = draw(
        group(
            resistance=at_times(resistances, 2),
            comparison=at_times(group(published=st.lists(published, min_size=1, max_size=2)), 8),
            optimize=at_times(group(knots=st.integers(12, 720), limits=group(peak_power_w=number(1.0, 9e3))), 8),
            output=at_times(group(chord_tolerance_mm=st.sampled_from([0.002, 0.01, 0.05, 0.2])), 2),
        )
    )
    pair = fitted(draw(gears(lobes, teeth)), motion)
    return {
        "name": "random",
        "linkage": linkage,
        "operation": {"speed_rpm": draw(number(1.0, 600.0))},
        "motion": motion,
        "gears": pair,
        **values,
    }


def fitted(pair: Data, motion: Data) -> Data:
    """Gears without the keys that the law's pitch curve gives."""
    if motion["law"] != "pitch_curve":
        return pair
    dropped = {"mesh"} if motion["solve_for"] == "scale" else {"mesh", "module_mm", "center_distance_mm"}
    return {key: value for key, value in pair.items() if key not in dropped}


TORQUES_BOTH_WAYS = both_ways(torques, "friction_n_m")
FORCES_BOTH_WAYS = both_ways(resistances, "friction_n")

OTHERS = {
    "none": (st.none(), torques),
    "scotch_yoke": (yokes(), FORCES_BOTH_WAYS),
    "crank_rocker": (rockers(), TORQUES_BOTH_WAYS),
    "slotted_lever": (levers(), FORCES_BOTH_WAYS),
}
"""What gears drive besides a crank-slider, with its loads."""


@st.composite
def other_designs(draw: Draw, teeth: tuple[int, int]) -> Data:
    """Gears by themselves or another mechanism on gears that turn on and on, with masses at times."""
    kind = draw(st.sampled_from(["none", "none", *OTHERS]))
    linkage, loads = OTHERS[kind]
    curved = draw(st.booleans())
    lobes = (1, 1) if curved else draw(st.sampled_from(LOBES))
    motion = draw(st.one_of(traced_curves(), FOUND_CURVES) if curved else motions(None, lobes))
    return {
        "name": "random",
        "operation": {"speed_rpm": draw(number(1.0, 600.0))},
        "motion": motion,
        "gears": fitted(draw(gears(lobes, teeth)), motion),
        **draw(group(linkage=linkage, resistance=at_times(loads), masses=at_times(MASSES[kind]))),
    }


@st.composite
def open_designs(draw: Draw, teeth: tuple[int, int]) -> Data:
    """Gears that turn less than once, by module and centre distance, on any mechanism or none."""
    kind = draw(st.sampled_from(["none", "rack_pinion", "rack_pinion", "crank_slider", *OTHERS]))
    more = {"rack_pinion": (racks_on_pinions(), FORCES_BOTH_WAYS), "crank_slider": (linkages(), FORCES_BOTH_WAYS)}
    linkage, loads = {**OTHERS, **more}[kind]
    pair = draw(gears((1, 1), teeth))
    count = pair.pop("teeth")
    sizes = {"module_mm": pair.get("module_mm", 1.0), "center_distance_mm": count * pair.get("module_mm", 1.0)}
    refused = {"helix", "lobes", "method"}
    return {
        "name": "random",
        "operation": {"speed_rpm": draw(number(1.0, 60.0))},
        "motion": draw(open_motions),
        "gears": {key: value for key, value in {**pair, **sizes}.items() if key not in refused},
        **draw(group(linkage=linkage, resistance=at_times(loads))),
    }


@st.composite
def designs(draw: Draw, teeth: tuple[int, int] = (6, 60)) -> Data:
    """A design as a file's plain values, with gears; two thirds of them are crank-sliders that turn on and on."""
    return draw(draw(st.sampled_from([slider_designs] * 4 + [other_designs, open_designs]))(teeth))


@st.composite
def spoiled_designs(draw: Draw) -> Data:
    """Designs of which every third has one or two values or groups spoiled or left out."""
    # Copies, since a strategy gives the same object again, and a second value may be spoiled within the first.
    data = deepcopy(draw(designs()))
    for _ in range(draw(st.sampled_from([0, 0, 0, 0, 1, 2]))):
        place, key = draw(st.sampled_from(list(_places(data))))
        place[key] = deepcopy(draw(st.sampled_from(SPOILS) | number(-10.0, 10.0)))
        if place[key] is None and isinstance(place, dict):
            del place[key]
    return data


def _places(data: Any) -> Any:
    """Every group or list with each of its keys."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        yield data, key
        if isinstance(value, dict | list):
            yield from _places(value)
