"""Hydraulic motors and pumps of a lobed sun, round planets and a lobed ring: teeth, poses and figures.

Teeth stand on the curves of ``pitch.lobed`` by one rack.  The planets are ordinary involute gears, which a hob cuts; a
pinion cuts sun and ring, and fits wherever planets fit if it has no more teeth than a planet.  At angle 0 a lobe of the
sun points at a lobe of the ring, with a tooth of the sun at its top.  A planet there with an even number of teeth has
spaces on both sides, a planet with an odd number a space and a tooth: so the top of the ring's lobe has a tooth, or a
space.  All other planets then find teeth and spaces as they need them (``pitch.lobed``).

A planet's frame turns with it.  A planet that touches the sun at phi, where the sun's arc from the lobe's top is
S(phi), has turned by alpha + phi - eta + S / rho.

Play is taken off the idle flanks of sun and ring.  The planets, which stand between both, keep their teeth.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, degrees, pi, tan

import numpy as np

from ncgear.errors import NoSuchMechanism, below, renamed
from ncgear.frozen import dataclass
from ncgear.numerics import chebyshev
from ncgear.numerics.arrays import Array, ComplexArray
from ncgear.numerics.chebyshev import PiecewiseChebyshev
from ncgear.numerics.units import CM3_PER_MM3, N_M_PER_N_MM
from ncgear.pitch.chambers import Chambers
from ncgear.pitch.curve import ClosedPitchCurve
from ncgear.pitch.lobed import LobedCurves
from ncgear.pitch.rolled import circle
from ncgear.pitch.shape import Gear, Mesh
from ncgear.solids.plan.room import INNER_WALL_IN_MODULES
from ncgear.teeth.backlash import require_teeth
from ncgear.teeth.fitting import PairTips, fitted_pair, least_contact_ratio
from ncgear.teeth.flank import flanks_of
from ncgear.teeth.form import Backlash, BasicRack, TipLimits
from ncgear.teeth.fouling import refuse_fouling_cutter
from ncgear.teeth.gear import ToothedGear, toothed_gear
from ncgear.teeth.outline import ChordTolerance
from ncgear.teeth.sides import refuse_sharp_curve
from ncgear.teeth.tips import Tips, held_below
from ncgear.teeth.tool import FEWER_TEETH, HARMLESS, MOST_TEETH, PinionCircle, RackLine, gouged_mm
from ncgear.trains.train import GROUND, GearMesh, Part, Poses, Train, TrainCondition, TrainFigures, contact_condition


@dataclass(frozen=True)
class MotorTeeth:
    """Choices for the teeth: the rack, the planets' teeth and shift, and the cutter's teeth (None: as many as fit)."""

    rack: BasicRack
    planet_teeth: int
    teeth_per_lobe: int
    planet_shift_mm: float
    cutter_teeth: int | None
    backlash_mm: float


@dataclass(frozen=True, eq=False)
class MotorGears:
    """Sun, planet and ring with teeth, and the least contact ratio of their meshes."""

    sun: ToothedGear
    planet: ToothedGear
    ring: ToothedGear
    contact_ratio: float


def motor_gears(curves: LobedCurves, teeth: MotorTeeth, tolerance_mm: float) -> MotorGears:
    """The teeth of all gears, outlines sampled to a tolerance.

    A planet's tips are as high as both meshes allow.  Raises NoSuchMechanism, naming gear and tooth, where no tooth can
    stand.
    """
    rack, shift, rho = teeth.rack, teeth.planet_shift_mm, curves.planet_radius_mm
    for curve in (curves.sun_curve, curves.ring_curve):
        refuse_sharp_curve(curve, rack.module_mm, "teeth_per_lobe")
    cutters = [_cutter(curve, teeth) for curve in (curves.sun_curve, curves.ring_curve)]
    quarter, outwards = rack.pitch_mm / 4.0, shift * tan(rack.pressure_angle_rad)
    planet_half, other_half = quarter + outwards, quarter - outwards
    play = teeth.backlash_mm / cos(rack.pressure_angle_rad)
    require_teeth(Backlash(teeth.backlash_mm), play, rack)
    planet_rack, other_rack = rack.shifted(shift), rack.shifted(-shift)
    limits = TipLimits()
    around, within = (
        circle(gear, mesh, rho, mate.curvature_bounds[0])
        for gear, mesh, mate in (
            (Gear.DRIVEN, Mesh.EXTERNAL, curves.sun_curve),
            (Gear.DRIVING, Mesh.INTERNAL, curves.ring_curve),
        )
    )
    halves = planet_half, planet_half
    sun, planet = fitted_pair(
        flanks_of(
            curves.sun_curve,
            other_rack,
            teeth.teeth_per_lobe * curves.sun_lobes,
            cutters[0],
            0.0,
            (other_half, other_half - play),
        ),
        flanks_of(around, planet_rack, teeth.planet_teeth, RackLine(), 2.0 * quarter, halves),
        limits,
    )
    inner, ring = fitted_pair(
        flanks_of(within, planet_rack, teeth.planet_teeth, RackLine(), 0.0, halves),
        flanks_of(
            curves.ring_curve,
            other_rack,
            teeth.teeth_per_lobe * curves.ring_lobes,
            cutters[1],
            0.0 if teeth.planet_teeth % 2 == 0 else 2.0 * quarter,
            (other_half - play, other_half),
        ),
        limits,
    )
    planet = _as_high_as_both(planet, inner)
    for tips in (sun, ring):
        refuse_fouling_cutter(tips)
    inner = held_below(inner, np.full(inner.flanks.count, float(planet.flanks.tip_height_mm.min())))
    pairs: tuple[PairTips, PairTips] = ((sun, planet), (inner, ring))
    chords = ChordTolerance(tolerance_mm, tolerance_mm)
    made = [toothed_gear(tips, chords) for tips in (sun, planet, ring)]
    return MotorGears(made[0], made[1], made[2], min(map(least_contact_ratio, pairs)))


def _cutter(curve: ClosedPitchCurve, teeth: MotorTeeth) -> PinionCircle:
    """The cutter of sun or ring: as given, else as large as the hollows allow, but no smaller than a planet."""
    count, module = teeth.cutter_teeth, teeth.rack.module_mm
    if count is None:
        low = curve.curvature_bounds[0]
        fits = MOST_TEETH if low >= 0.0 else min(MOST_TEETH, int(-2.0 / (low * module)) - FEWER_TEETH)
        count = max(teeth.planet_teeth, fits)
    pinion = PinionCircle(count, module)
    depth = gouged_mm(curve, teeth.rack, 1.0 / pinion.radius_mm)
    if not depth <= HARMLESS * module:
        raise NoSuchMechanism(
            f"a pinion cutter of {count} teeth does not go into the hollows: it would cut {depth:.3g} mm deep into "
            f"flanks there; {teeth.planet_teeth} teeth, as a planet has, go into all of them",
            key="gears.cutter_teeth",
        )
    return pinion


OTHER_CUTTER = "another number of cutter teeth, or a smaller pressure angle, is needed"


def _as_high_as_both(planet: Tips, inner: Tips) -> Tips:
    """The planet with all tips as high as its meshes with sun and ring allow: each of its teeth meets all of theirs."""
    lowest = min(float(tips.flanks.tip_height_mm.min()) for tips in (planet, inner))
    deepest = max(float(tips.met_depth_mm.max()) for tips in (planet, inner))
    count = planet.flanks.count
    return replace(held_below(planet, np.full(count, lowest)), met_depth_mm=np.full(count, deepest))


@dataclass(frozen=True)
class MotorBodies:
    """Widths and sizes of the bodies in mm: the rim of the ring, the bore of the sun."""

    face_width_mm: float
    rim_mm: float
    bore_mm: float | None


def motor_train(
    curves: LobedCurves,
    teeth: MotorTeeth,
    bodies: MotorBodies,
    speed_rpm: float,
    pressure_mpa: float | None,
    tolerance_mm: float,
) -> Train:
    """The motor as a train whose ring stands; the driving angle is the sun's.

    A cycle is a lobe of the sun: then each planet stands where the next one stood.  Raises NoSuchMechanism as
    ``motor_gears``.
    """
    with below("train"), renamed("gears.cutter.teeth", "gears.cutter_teeth", OTHER_CUTTER):
        gears = motor_gears(curves, teeth, tolerance_mm)
    width, names = bodies.face_width_mm, [f"planet_{number + 1}" for number in range(curves.planets)]
    outline, wall_mm = gears.planet.outline_mm, INNER_WALL_IN_MODULES * teeth.rack.module_mm
    parts = [
        Part("sun", gears.sun.outline_mm, width, gears.sun.teeth, bore_mm=bodies.bore_mm, wall_mm=wall_mm),
        Part("ring", gears.ring.outline_mm, width, gears.ring.teeth, 0.0, None, bodies.rim_mm, GROUND, (), wall_mm),
        *(Part(name, outline, width, gears.planet.teeth) for name in names),
    ]
    meshes = [GearMesh("sun", name) for name in names] + [GearMesh(name, "ring", Mesh.INTERNAL) for name in names]
    chambers, path = Chambers(curves, width), planet_path(curves)
    told = _told(curves, teeth, gears, chambers, speed_rpm, pressure_mpa)

    def poses_at(driving_rad: Array) -> Poses:
        alpha = np.asarray(driving_rad, dtype=float)
        place, turn = path.at(chambers.places_rad(alpha), alpha)
        none = np.zeros((2, alpha.size))
        return Poses(
            np.concatenate([none, place.real]),
            np.concatenate([none, place.imag]),
            np.concatenate([alpha[None], none[:1], turn]),
        )

    return Train(tuple(parts), tuple(meshes), poses_at, "sun", curves.lobe_rad, speed_rpm, tolerance_mm, told)


@dataclass(frozen=True, eq=False)
class PlanetPath:
    """Position of a planet by its place g = phi + chi, in columns over one period.

    The columns are its centre as seen along the ray through its contacts (x, y in mm), the ray's angle phi in the sun's
    frame and the planet's turn there, both in rad.  ``rise`` is the growth of the columns over a period.
    """

    form: PiecewiseChebyshev
    rise: Array

    def at(self, places_rad: Array, alpha_rad: Array) -> tuple[ComplexArray, Array]:
        """Centres in mm as complex numbers and angles in rad, at angles of the sun; shapes broadcast."""
        periods, local = np.divmod(places_rad, self.form.breaks[-1])
        columns = self.form(local) + periods[..., None] * self.rise
        centre = (columns[..., 0] + 1j * columns[..., 1]) * np.exp(1j * (columns[..., 2] + alpha_rad))
        return centre, columns[..., 3] + alpha_rad


def planet_path(curves: LobedCurves) -> PlanetPath:
    """The path of every planet of a motor."""
    period, rho = 2.0 * pi / curves.ring_lobes + curves.lobe_rad, curves.planet_radius_mm

    def columns(place: Array) -> Array:
        phi = curves.places.angle(place)
        seen = curves.centre_mm(phi) * np.exp(-1j * phi)
        # The sun's curve runs against phi.
        turn = phi - curves.lean_rad(phi) - curves.sun_curve.arc.length(-phi) / rho
        return np.column_stack([seen.real, seen.imag, phi, turn])

    rise = np.array([0.0, 0.0, curves.lobe_rad, curves.lobe_rad + curves.sun_curve.arc.period / rho])
    return PlanetPath(chebyshev.fitted(columns, [0.0, period]), rise)


def _told(
    curves: LobedCurves,
    teeth: MotorTeeth,
    gears: MotorGears,
    chambers: Chambers,
    speed_rpm: float,
    pressure_mpa: float | None,
) -> TrainFigures:
    root_mm = curves.planet_radius_mm - float(gears.planet.flanks.root_depth_mm.max())
    ports = chambers.ports(root_mm)
    least, most = chambers.dead_spaces
    low, high = chambers.flow_range
    per_turn_cm3 = chambers.per_turn_mm3 * CM3_PER_MM3
    radii = np.array([0.0, pi / curves.sun_lobes])
    (outer, inner), (far, near) = curves.radius(radii, 0).value, curves.ring(radii, 0)[0].value
    rows = [
        (
            "gears",
            f"sun of {curves.sun_lobes} lobes and {gears.sun.teeth} teeth, {curves.planets} planets of "
            f"{gears.planet.teeth} teeth, ring of {curves.ring_lobes} lobes and {gears.ring.teeth} teeth",
        ),
        (
            "pitch radii",
            f"sun {inner:.5g} to {outer:.5g} mm, planets {curves.planet_radius_mm:.5g} mm, ring {near:.5g} to "
            f"{far:.5g} mm",
        ),
        (
            "displacement",
            f"{per_turn_cm3:.5g} cm3 per turn of the sun, {chambers.pulses} pulses of "
            f"{100.0 * chambers.pulsation:.3g} % of the mean flow; {per_turn_cm3 * speed_rpm * L_PER_CM3:.4g} l/min",
        ),
        (
            "chambers",
            f"{chambers.count}, each {least.area_mm2:.5g} to {most.area_mm2:.5g} mm2 and "
            f"{curves.sun_lobes * curves.ring_lobes / chambers.count:.4g} times filled a turn",
        ),
        (
            "ports",
            f"{2 * curves.ring_lobes} at {ports[0].distance_mm:.5g} mm from the axis, of up to "
            f"{2.0 * max(ports[0].radius_mm, 0.0):.4g} mm diameter, at {degrees(ports[0].direction_rad):.4g} (growing "
            f"chambers) and {degrees(ports[1].direction_rad):.4g} deg from a lobe of the ring",
        ),
    ]
    figures = {
        "sun_teeth": gears.sun.teeth,
        "planet_teeth": gears.planet.teeth,
        "ring_teeth": gears.ring.teeth,
        "planets": curves.planets,
        "sun_pitch_radius_min_mm": float(inner),
        "sun_pitch_radius_max_mm": float(outer),
        "ring_pitch_radius_min_mm": float(near),
        "ring_pitch_radius_max_mm": float(far),
        "displacement_cm3": per_turn_cm3,
        "displacement_min_cm3": 2.0 * pi * low.value * CM3_PER_MM3,
        "displacement_max_cm3": 2.0 * pi * high.value * CM3_PER_MM3,
        "flow_l_min": per_turn_cm3 * speed_rpm * L_PER_CM3,
        "pulsation_percent": 100.0 * chambers.pulsation,
        "chamber_min_mm2": least.area_mm2,
        "chamber_max_mm2": most.area_mm2,
        "chamber": _over_a_cycle(chambers),
        "dead_spaces": [
            {
                "area_mm2": space.area_mm2,
                "direction_deg": degrees(space.middle_rad),
                "planets_beside_deg": degrees(space.beside_rad),
            }
            for space in (least, most)
        ],
        "ports": [
            {
                "direction_deg": degrees(port.direction_rad),
                "distance_mm": port.distance_mm,
                "radius_max_mm": port.radius_mm,
            }
            for port in ports
        ],
        "contact_ratio_min": gears.contact_ratio,
    }
    if pressure_mpa is not None:
        force = chambers.most_tooth_force(pressure_mpa, teeth.rack.pressure_angle_rad)
        torques = [pressure_mpa * torque.value * N_M_PER_N_MM for torque in (low, high)]
        rows.append(
            (
                "under pressure",
                f"{pressure_mpa:g} MPa turn the sun with {torques[0]:.4g} to {torques[1]:.4g} N m, and load the "
                f"teeth of a planet with up to {force.value:.4g} N on either side",
            )
        )
        figures |= {
            "pressure_mpa": pressure_mpa,
            "torque_min_n_m": torques[0],
            "torque_max_n_m": torques[1],
            "tooth_force_max_n": force.value,
        }
    head = f"lobed motor, {curves.sun_lobes} by {curves.ring_lobes} lobes, {curves.planets} planets"
    return TrainFigures(head, tuple(rows), figures, _conditions(gears, min(port.radius_mm for port in ports), teeth))


L_PER_CM3 = 1e-3
"""One cm3 in litres."""

ROWS = 25
"""Places of a chamber's cycle in the summary, from the least volume on."""


def _over_a_cycle(chambers: Chambers) -> list[dict[str, float]]:
    """The volume of a chamber over its cycle; the other chambers have the same volumes at other angles of the sun."""
    turned = np.linspace(0.0, chambers.cycle_rad, ROWS)
    places = chambers.dead_spaces[0].place_rad - turned
    volumes = chambers.area_mm2(places) * chambers.width_mm
    return [
        {"sun_deg": angle, "volume_mm3": volume}
        for angle, volume in zip(np.degrees(turned).tolist(), volumes.tolist(), strict=True)
    ]


def _conditions(gears: MotorGears, port_mm: float, teeth: MotorTeeth) -> tuple[TrainCondition, ...]:
    cures = CURES if teeth.planet_shift_mm == 0.0 else ("train.gears.planet_shift nearer to 0", *CURES)
    sealed = port_mm > 0.0
    covered = "planets cover every port at the dead spaces beside it"
    if not sealed:
        covered = f"no planet covers a port at both dead spaces beside it: they miss it by {-port_mm:.3g} mm"
    return (
        TrainCondition("dead spaces", sealed, covered, () if sealed else ("larger planets: fewer teeth per lobe",)),
        contact_condition(gears.contact_ratio, *cures),
    )


CURES = ("a larger pressure angle (train.gears.rack.pressure_angle_deg)", "fewer teeth per lobe", "more planet teeth")
"""Changes that let teeth on sharp humps be higher."""
