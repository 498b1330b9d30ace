"""Forces of a gear-driven crank-slider: Newton's and Euler's equations of all bodies as one linear system per angle.

Places come from the vector loop, pitch curves from r1 = a w / (1 + w) (of a ring a w / (1 - w)), all derivatives from
mpmath's differences at 40 digits; nothing is shared with the program but the frame: crank axis at the origin, slider on
y = offset moving along +x, crank turning clockwise.  Units: mm, kg, s, N.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from mpmath import mp

Real = Any
Angle = Callable[[Real], Real]

DIGITS = 40


@dataclass(frozen=True)
class Scene:
    """A machine: driven angle by the driving angle, linkage, masses, gears; all plain numbers.

    ``resistance`` and ``returning`` are the forces against the slider on its way out and back, by its displacement.
    The guide rubs against its motion with ``guide_friction`` times the size of its force.
    """

    driven_angle: Angle
    speed_rad_s: float
    crank: float
    rod: float
    offset: float
    slider_kg: float
    rod_kg: float
    rod_center: float
    rod_inertia: float
    crank_kg: float
    crank_center: float
    shaft_inertia: float
    gravity: tuple[float, float]
    resistance: Callable[[Real], Real]
    distance: float
    rack_angle: float
    internal: bool
    driving_axis: float
    returning: Callable[[Real], Real] = lambda x: mp.mpf(0)
    guide_friction: float = 0.0


def places(scene: Scene, phi1: Real) -> dict[str, Any]:
    """Crank direction, pin, wrist, centres as complex numbers, rod direction."""
    tilt = mp.asin(mp.mpf(scene.offset) / (scene.rod - scene.crank))
    crank = mp.expjpi(1) * mp.expj(tilt - scene.driven_angle(phi1))
    pin = scene.crank * crank
    x = pin.real + mp.sqrt(mp.mpf(scene.rod) ** 2 - (scene.offset - pin.imag) ** 2)
    wrist = mp.mpc(x, scene.offset)
    rod = (wrist - pin) / scene.rod
    centers = {"rod": pin + scene.rod_center * rod, "shaft": scene.crank_center * crank}
    return {"pin": pin, "wrist": wrist, **centers, "rod_angle": mp.asin(rod.imag)}


def accelerations(scene: Scene, phi1: Real) -> dict[str, Any]:
    """Second derivatives by time at constant driving speed, in m/s2 (angles in rad/s2 / 1000)."""
    names = "wrist", "rod", "shaft", "rod_angle"
    scale = mp.mpf(scene.speed_rad_s) ** 2 / 1000
    found = {name: mp.diff(lambda angle, name=name: places(scene, angle)[name], phi1, 2) * scale for name in names}
    return {**found, "shaft_angle": -mp.diff(scene.driven_angle, phi1, 2) * scale}


def action(scene: Scene, phi1: Real, *, pushing: bool) -> tuple[Any, Any, Any]:
    """Pitch point, driving axis and direction of the force on the driven gear, in the linkage's frame."""
    sense = -1 if scene.internal else 1

    def radius(angle: Real) -> Real:
        slope = mp.diff(scene.driven_angle, angle)
        return scene.distance * slope / (1 + sense * slope)

    point = sense * radius(phi1)
    # The driving curve as it lies at phi1: what is met at phi1 + d is still d ahead of the line of centres
    tangent = mp.diff(lambda step: sense * radius(phi1 + step) * mp.expj(-step), 0)
    moving = mp.mpc(0, sense)
    tangent *= mp.sign((tangent * moving.conjugate()).real) / abs(tangent)
    outward = sense
    forward = tangent if pushing else -tangent
    leaning = [forward * mp.expj(turn * mp.mpf(scene.rack_angle)) for turn in (1, -1)]
    # Teeth taper: the flank's normal leans away from the driving axis, measured along the pitch curve's own normal
    normal = max(tangent * mp.mpc(0, 1), -tangent * mp.mpc(0, 1), key=lambda side: (side * outward).real)
    force = max(leaning, key=lambda direction: (direction * normal.conjugate()).real)
    return tuple(_placed(scene, place) for place in (point - scene.distance, -scene.distance + mp.mpc(0), force))


def _placed(scene: Scene, vector: Any) -> Any:
    """From the gears' frame, driven axis at the origin, to the linkage's, in which the driven gear turns clockwise."""
    mirrored = vector.conjugate() if scene.internal else vector
    return mirrored * mp.expj(scene.driving_axis - mp.pi)


def solved(scene: Scene, phi1: float, *, working: bool, pushing: bool) -> dict[str, float]:
    """Wrist, pin and crank bearing, guide, mesh force, driving bearing and driving torque at one angle.

    Friction follows the side on which the guide presses: both are tried, and one of them must agree with its force.
    """
    with mp.workdps(DIGITS):
        names = ["wrist_x", "wrist_y", "pin_x", "pin_y", "crank_x", "crank_y", "guide", "mesh", "axis_x", "axis_y"]
        names.append("torque")
        rows, right = _equations(scene, mp.mpf(phi1), working, pushing, names)
        way, found = (1 if working else -1), []
        for side in (1, -1) if scene.guide_friction else (0,):
            rubbing = rows.copy()
            rubbing[0, names.index("guide")] -= way * side * mp.mpf(scene.guide_friction)
            solution = dict(zip(names, mp.lu_solve(rubbing, right), strict=True))
            found += [solution] if side * solution["guide"] >= 0 else []
        (only,) = found
        return {name: float(value) for name, value in only.items()}


def _equations(scene: Scene, phi1: Real, working: bool, pushing: bool, names: list[str]) -> tuple[Any, Any]:
    at, moved = places(scene, phi1), accelerations(scene, phi1)
    point, axis, direction = action(scene, phi1, pushing=pushing)
    gravity = mp.mpc(*scene.gravity)
    retracted = mp.sqrt(mp.mpf(scene.rod - scene.crank) ** 2 - mp.mpf(scene.offset) ** 2)
    x = at["wrist"].real - retracted
    press = scene.resistance(x) if working else -scene.returning(x)
    rows: list[dict[str, Any]] = []
    right: list[Any] = []

    def equation(value: Any, **terms: Any) -> None:
        rows.append(terms)
        right.append(value)

    slider = scene.slider_kg * (moved["wrist"] - gravity)
    equation(slider.real + press, wrist_x=1)
    equation(slider.imag, wrist_y=1, guide=1)
    rod = scene.rod_kg * (moved["rod"] - gravity)
    equation(rod.real, pin_x=1, wrist_x=-1)
    equation(rod.imag, pin_y=1, wrist_y=-1)
    to_pin, to_wrist = at["pin"] - at["rod"], at["wrist"] - at["rod"]
    spin = scene.rod_inertia * moved["rod_angle"]
    equation(spin, pin_x=-to_pin.imag, pin_y=to_pin.real, wrist_x=to_wrist.imag, wrist_y=-to_wrist.real)
    crank = scene.crank_kg * (moved["shaft"] - gravity)
    equation(crank.real, crank_x=1, pin_x=-1, mesh=direction.real)
    equation(crank.imag, crank_y=1, pin_y=-1, mesh=direction.imag)
    weight = (at["shaft"].conjugate() * scene.crank_kg * gravity).imag
    turning = (point.conjugate() * direction).imag
    shaft = scene.shaft_inertia * moved["shaft_angle"]
    equation(shaft - weight, pin_x=at["pin"].imag, pin_y=-at["pin"].real, mesh=turning)
    equation(mp.mpf(0), axis_x=1, mesh=-direction.real)
    equation(mp.mpf(0), axis_y=1, mesh=-direction.imag)
    # The driving gear turns counter-clockwise, in a ring clockwise, and does not change its speed
    held = ((point - axis).conjugate() * -direction).imag
    equation(mp.mpf(0), torque=-1 if scene.internal else 1, mesh=held)
    matrix = mp.matrix([[row.get(name, 0) for name in names] for row in rows])
    return matrix, mp.matrix(right)


def solved_yoke(scene: Scene, phi1: float, *, working: bool, pushing: bool) -> dict[str, float]:
    """The same of a Scotch yoke: a slot across the slider's line, in which the pin presses along the line alone.

    The slider's weight along the line counts; rod and offset do not.
    """
    with mp.workdps(DIGITS):
        angle, scale = mp.mpf(phi1), mp.mpf(scene.speed_rad_s) ** 2 / 1000

        def crank(at: Real) -> Real:
            return mp.expjpi(1) * mp.expj(-scene.driven_angle(at))

        out, center = crank(angle), scene.crank_center * crank(angle)
        moved = mp.diff(crank, angle, 2) * scale
        turned = -mp.diff(scene.driven_angle, angle, 2) * scale
        gravity = mp.mpc(*scene.gravity)
        x = scene.crank * (1 + out.real)
        press = scene.resistance(x) if working else -scene.returning(x)
        point, axis, direction = action(scene, angle, pushing=pushing)
        weight = scene.crank_kg * (scene.crank_center * moved - gravity)
        arm = scene.crank * out.imag
        tilting = (center.conjugate() * scene.crank_kg * gravity).imag
        held = ((point - axis).conjugate() * direction).imag
        turning = (point.conjugate() * direction).imag
        # Unknown: pin on the slot, both of the crank's bearing, the teeth, the driving torque
        rows = mp.matrix(
            [
                [1, 0, 0, 0, 0],
                [-1, 1, 0, direction.real, 0],
                [0, 0, 1, direction.imag, 0],
                [arm, 0, 0, turning, 0],
                [0, 0, 0, -held, -1 if scene.internal else 1],
            ]
        )
        slider = scene.slider_kg * (scene.crank * moved.real - gravity.real) + press
        right = mp.matrix([slider, weight.real, weight.imag, scene.shaft_inertia * turned - tilting, 0])
        names = ("pin_x", "crank_x", "crank_y", "mesh", "torque")
        return {name: float(value) for name, value in zip(names, mp.lu_solve(rows, right), strict=True)}
