"""The task of a mechanism, its limits, and the figures of a law for it.

The loads of a machine with all its masses come from the loaded machine (``ncgear.dynamics.loaded_machine``) at constant
driving speed, so peaks are exact.  Motor power is the driving shaft's torque times its speed: positive where
the motor drives, negative where it brakes.
"""

from __future__ import annotations

from dataclasses import field, replace
from functools import partial
from math import degrees, inf, pi, tan
from typing import Any

from ncgear.dynamics.driving_shaft import DrivingShaft
from ncgear.dynamics.loaded_machine import IDLE, RigidMachine, broken_cycle, largest_over
from ncgear.dynamics.mesh_force import MeshPlace
from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.kinematics.check import acceleration_rms_above, kinematic_check, peak_jerk
from ncgear.kinematics.motion import Machine, Stretch
from ncgear.mechanisms.forces import Masses
from ncgear.mechanisms.mechanism import Mechanism
from ncgear.mechanisms.slider_load import SliderLoad
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array
from ncgear.numerics.extrema import extremes_on, grid_between
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Vector
from ncgear.numerics.units import N_M_PER_N_MM
from ncgear.pitch.pair import PitchPair, sized_pair, solved_size
from ncgear.pitch.shape import Gear, tangent_slope
from ncgear.ratio.transmission import Lobes, Pair, PairsInSeries, Transmission


@dataclass(frozen=True)
class GearSize:
    """The size of an external pair by two of three figures: teeth of the driving gear, module, centre distance.

    ``rack_angle_rad`` is the pressure angle of its rack, ``idle_angle_rad`` the pressure angle of the idle flanks, None
    where both are the same.
    """

    teeth: int | None
    module_mm: float | None
    center_distance_mm: float | None
    rack_angle_rad: float
    idle_angle_rad: float | None = None

    def rolled_mm(self, lobes: Lobes) -> float:
        """The greatest length that a pair of this size rolls across the line of centres in one cycle.

        The pitch curves' own length bounds it where teeth and module are given.  With a centre distance a the driven
        gear's radius a i/(1 + i) is concave in i, so its mean over the crank's turn is at most its value at the mean i.
        """
        if self.teeth is not None and self.module_mm is not None:
            return self.teeth * pi * self.module_mm / lobes.driving
        assert self.center_distance_mm is not None
        mean = lobes.driving_period_rad / (2.0 * pi)
        return 2.0 * pi * self.center_distance_mm * mean / (1.0 + mean)


FLUCTUATION = 0.05
"""Coefficient of speed fluctuation without a wish; the default of the key in a design file."""


@dataclass(frozen=True)
class Task:
    """One turn of the crank against a load of the slider in one period of a driving gear that turns evenly.

    ``masses`` are the moving masses, of the mechanism's class ``MASSES``; with None only the resistance acts.
    ``gears`` is the size of the pair, which the force between teeth needs; None where it is not known.
    ``speed_fluctuation`` is the coefficient, largest minus smallest speed over the mean, for which a flywheel on the
    driving shaft is computed.  ``guide_friction`` is the coefficient of friction of the slider in its guide, which
    figures count.  ``harmonics_above`` is the order above which harmonics count; None where no harmonics count.

    Raises WrongInput for a speed that is not positive and for a driven gear of several lobes.
    """

    linkage: Mechanism
    load: SliderLoad
    speed_rad_s: float
    lobes: Lobes = field(default_factory=Lobes)
    masses: Masses | None = None
    gears: GearSize | None = None
    speed_fluctuation: float = FLUCTUATION
    guide_friction: float = 0.0
    harmonics_above: int | None = None

    def __post_init__(self) -> None:
        self.lobes.require_one_cycle()
        if not 0.0 < self.speed_rad_s < inf:
            problem = f"{self.speed_rad_s:g} rad/s is no driving speed; a positive one is needed"
            raise WrongInput(problem, key="operation.speed_rpm")

    @property
    def moving(self) -> Masses:
        """The moving masses; all zero where there are none."""
        return self.linkage.MASSES() if self.masses is None else self.masses

    def loaded(self, machine: Machine, laws_before: tuple[Transmission, ...] = ()) -> RigidMachine:
        """The machine of a law with all that the task gives; ``laws_before`` are as in ``RigidMachine``."""
        return RigidMachine(machine, self.moving, guide_friction=self.guide_friction, laws_before=laws_before)

    @property
    def cycle_rad(self) -> float:
        """Driving angle of one cycle of the slider."""
        return self.lobes.driving_period_rad

    @property
    def cycle_s(self) -> float:
        """Time of one cycle of the slider."""
        return self.cycle_rad / self.speed_rad_s

    @property
    def work_n_mm(self) -> float:
        """Work against the load over one cycle; negative where kept negative forces drive the slider."""
        return self.load.cycle_work_n_mm(self.linkage.stroke_mm)


LOAD_LIMITS = (
    "braking_power_w",
    "rms_torque_n_m",
    "flywheel_kg_mm2",
    "bearing_force_n",
    "shaking_force_n",
    "tooth_force_n",
    "flank_load_n_mm",
    "torque_harmonics_n_m",
)
"""Loads of the machine besides its peak power, by their names in ``Limits``, in ``Figures`` and in design files."""


@dataclass(frozen=True)
class Limits:
    """Bounds on every position of the cycle; None for a quantity that is free.

    ``ratio_min`` and ``ratio_max`` bound i12 = dphi1/dphi2; ``pressure_angle_rad`` bounds the tangent angle of the
    pitch curves, |atan(r1'/r1)|, not counting the rack's own; ``rack_angle_rad`` is the rack's own, which the limit in
    a design file and messages include.  The limits from ``braking_power_w`` on are for figures of
    ``ncgear.optimum.task``; the flywheel is for the task's speed fluctuation.  Raises WrongInput for a value that
    bounds nothing, with its key in the design file.
    """

    ratio_min: float
    ratio_max: float
    peak_power_w: float | None = None
    peak_acceleration_mm_s2: float | None = None
    peak_speed_mm_s: float | None = None
    pressure_angle_rad: float | None = None
    rack_angle_rad: float = 0.0
    braking_power_w: float | None = None
    rms_torque_n_m: float | None = None
    flywheel_kg_mm2: float | None = None
    bearing_force_n: float | None = None
    shaking_force_n: float | None = None
    tooth_force_n: float | None = None
    flank_load_n_mm: float | None = None
    torque_harmonics_n_m: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 < self.ratio_min < inf:
            raise _wrong("limits.ratio_min", self.ratio_min, "a positive ratio is needed")
        if not self.ratio_min < self.ratio_max < inf:
            raise _wrong("limits.ratio_max", self.ratio_max, f"a ratio over ratio_min = {self.ratio_min:g} is needed")
        positive = {
            "limits.peak_power_w": self.peak_power_w,
            "limits.peak_acceleration_mm_s2": self.peak_acceleration_mm_s2,
            "limits.peak_speed_mm_s": self.peak_speed_mm_s,
            **{f"limits.{name}": getattr(self, name) for name in LOAD_LIMITS},
        }
        for key, value in positive.items():
            if value is not None and not 0.0 < value < inf:
                raise _wrong(key, value, "a positive number is needed")
        tangent = self.pressure_angle_rad
        if tangent is not None and not 0.0 < tangent < pi / 2.0:
            said = "deg without the rack's own given; over 0 and under 90 is right"
            raise WrongInput(f"{degrees(tangent):g} {said}", key="optimize.limits.pressure_angle_deg")

    @property
    def steepness(self) -> float:
        """Largest |d ln(1 + s)/dphi2| with s = dphi2/dphi1; infinite where the pressure angle is free.

        r1 = a s / (1 + s) gives r1'/r1 = (ds/dphi2) / (1 + s), the prime by phi1.
        """
        return inf if self.pressure_angle_rad is None else tan(self.pressure_angle_rad)


TEETH = 100
"""Teeth per lobe of the pair for measuring curves; the figures are ratios, so any size is right."""


@dataclass(frozen=True, eq=False)
class Figures:
    """Peaks at the operating speed, ratio range, and the shape of the pitch curves.

    ``curvature_turns`` is the largest curvature of any curve, bulge or dent, times the length its pair rolls in one
    cycle.  ``peak_jerk_mm_s3`` is None where the acceleration jumps.  With several pairs the ratios are the whole
    train's, and ``convex`` means that all curves are.  The figures from ``braking_power_w`` on are computed here, None
    where no masses are given; ``tooth_force_n`` and ``flank_load_n_mm`` are None as well where the size of the gears is
    not known or there are several pairs.
    """

    peak_power_w: float
    peak_acceleration_mm_s2: float
    peak_speed_mm_s: float
    ratio_min: float
    ratio_max: float
    working_rad: float
    tangent_rad: float
    convex: bool
    curvature_turns: float
    peak_jerk_mm_s3: float | None = None
    braking_power_w: float | None = None
    rms_torque_n_m: float | None = None
    flywheel_kg_mm2: float | None = None
    bearing_force_n: float | None = None
    shaking_force_n: float | None = None
    tooth_force_n: float | None = None
    flank_load_n_mm: float | None = None
    torque_harmonics_n_m: float | None = None
    acceleration_harmonics_mm_s2: float | None = None
    center_distance_mm: float | None = None


def by_limit(found: Figures, pressure_angle_deg: float) -> dict[str, float | None]:
    """Figures by the keys of their limits in a design file; figures of the motion in both units of an output.

    The pressure angle includes the rack's own and belongs to the described pair.
    """
    moved = ("peak_speed", ""), ("peak_acceleration", "2"), ("peak_jerk", "3"), ("acceleration_harmonics", "2")
    alike = "peak_power_w", "ratio_max", "center_distance_mm", *LOAD_LIMITS
    return {
        **{f"{key}_{unit}_s{n}": getattr(found, f"{key}_mm_s{n}") for key, n in moved for unit in ("mm", "rad")},
        "pressure_angle_deg": pressure_angle_deg,
        **{name: getattr(found, name) for name in alike},
    }


@dataclass(frozen=True)
class Prices:
    """The costs of a unit of each figure in a goal, as in ``Figures``; raises WrongInput for an endless price."""

    peak_acceleration_mm_s2: float = 0.0
    peak_power_w: float = 0.0
    peak_speed_mm_s: float = 0.0
    peak_jerk_mm_s3: float = 0.0
    tangent_rad: float = 0.0
    braking_power_w: float = 0.0
    rms_torque_n_m: float = 0.0
    flywheel_kg_mm2: float = 0.0
    bearing_force_n: float = 0.0
    shaking_force_n: float = 0.0
    tooth_force_n: float = 0.0
    flank_load_n_mm: float = 0.0
    torque_harmonics_n_m: float = 0.0
    acceleration_harmonics_mm_s2: float = 0.0
    center_distance_mm: float = 0.0

    def __post_init__(self) -> None:
        for name, price in vars(self).items():
            if not 0.0 <= price < inf:
                key = f"weights.{name.removeprefix('peak_')}"
                raise _wrong(key, 1.0 / price, "a positive number is needed")

    @property
    def of_loads(self) -> bool:
        """Whether any figure of ``ncgear.optimum.task`` except the peak power has a price."""
        return any(getattr(self, name, 0.0) for name in LOAD_LIMITS)

    def of(self, found: Figures) -> float:
        """The sum of all figures' costs; figures without a price need not be known."""
        prices = {name: price for name, price in vars(self).items() if price}
        return float(sum(price * getattr(found, name) for name, price in prices.items()))


def figures(task: Task, train: PairsInSeries, as_large_as: PairsInSeries | None = None) -> Figures:
    """The figures of a law on a machine; raises NoSuchMechanism for curves too sharp to be computed.

    Power counts the masses. The centre distance and the force between the teeth are those of the law's own gears, or
    of another law's gears (``as_large_as``).
    """
    machine, above = Machine(train.whole, task.linkage, task.load, task.speed_rad_s), task.harmonics_above
    check, jerk = kinematic_check(machine), peak_jerk(machine)
    pairs = [_pair(task, pair) for pair in train.pairs]
    sized = pairs[0] if as_large_as is None else _pair(task, as_large_as.pairs[0])
    place = None if task.gears is None or len(pairs) > 1 else _place_of(task, task.gears, sized)
    lowest, highest = train.whole.ratio_range
    of_motion = Figures(
        peak_power_w=check.peak_power_w.value,
        peak_acceleration_mm_s2=check.peak_acceleration_cycle.value,
        peak_speed_mm_s=check.peak_speed.value,
        ratio_min=lowest.value,
        ratio_max=highest.value,
        working_rad=machine.extended_rad,
        tangent_rad=max(pair.largest_tangent_angle_rad.value for pair in pairs),
        convex=all(pair.convex(gear) for pair in pairs for gear in Gear),
        curvature_turns=max(abs(end.value) for pair in pairs for gear in Gear for end in pair.curvature_range[gear])
        * TEETH
        * pi,
        peak_jerk_mm_s3=None if jerk is None else jerk.value,
        acceleration_harmonics_mm_s2=None if above is None else acceleration_rms_above(machine, above),
        center_distance_mm=None if place is None else place.center_distance_mm,
    )
    if task.masses is None:
        return of_motion
    rigid = task.loaded(machine, tuple(pair.transmission for pair in train.pairs[:-1]))
    loads = felt(rigid, task.speed_fluctuation)
    if above is not None:
        loads["torque_harmonics_n_m"] = N_M_PER_N_MM * DrivingShaft(rigid).fluctuation.rms_above_n_mm(above)
    if place is None:
        return replace(of_motion, **loads)
    force, flanks = tooth_loads(replace(rigid, place=place))
    return replace(of_motion, **loads, tooth_force_n=force, flank_load_n_mm=flanks)


def _pair(task: Task, pair: Pair) -> PitchPair:
    return sized_pair(pair.transmission, TEETH * task.lobes.driving, 1.0, None)


def _place_of(task: Task, size: GearSize, pair: PitchPair) -> MeshPlace:
    lobes, length = task.lobes, pair.arc.period * task.lobes.driving
    own = solved_size(length, lobes, size.teeth, size.module_mm, size.center_distance_mm)
    # The direction of the centre line turns the force and leaves its size
    return MeshPlace(own.center_distance_mm, size.rack_angle_rad, pair.mesh, 0.0, size.idle_angle_rad)


def _wrong(key: str, value: float, needed: str) -> WrongInput:
    return WrongInput(f"{value:g} given; {needed}", key=f"optimize.{key}")


def felt(rigid: RigidMachine, speed_fluctuation: float) -> dict[str, Any]:
    """Figures of a machine over one cycle, by their names in ``Figures``; the speed fluctuation is over 0 to about 0.2.

    The braking power is the largest power that flows back to the motor, 0 where none does.  The r.m.s. torque is over
    the driving angle.  The flywheel is the inertia on the driving shaft, its gear included, that keeps the coefficient
    of speed fluctuation where the motor's torque is even: the motor then delivers the mean power alone.  The bearing
    force acts on the crank's bearings, without the teeth's; the shaking force is that of moving masses on the frame.
    """
    shaft, cycle = DrivingShaft(rigid), broken_cycle(rigid)
    free = replace(rigid.machine, load=SliderLoad())
    inert = RigidMachine(free, replace(rigid.masses, gravity_m_s2=(0.0, 0.0)))
    return {
        "peak_power_w": shaft.peak_power_w.value,
        "braking_power_w": shaft.braking_power_w.value,
        "rms_torque_n_m": shaft.rms_torque_n_m,
        "flywheel_kg_mm2": shaft.fluctuation.flywheel_kg_mm2(speed_fluctuation),
        "bearing_force_n": largest_over(rigid, cycle, lambda loads: loads.crank_bearing).value,
        # The frame's load without weights and resistance: the reactions of bearings and guide
        "shaking_force_n": largest_over(
            inert, broken_cycle(inert), lambda loads: Vector(loads.crank_bearing.x, loads.crank_bearing.y + loads.guide)
        ).value,
    }


def tooth_loads(rigid: RigidMachine) -> tuple[float, float]:
    """Largest force in N between the teeth, and flank load in N mm; infinite where flanks carry at 90 degrees or more.

    All of the force counts at the pitch point, where that of one pair of teeth or of several has the same arm.  The
    flank load is the force times relative curvature of the pitch curves times the centre distance squared.  It does
    not depend on the gears' size: the contact stress at the pitch point, p^2 = E* F (k1 + k2)/(pi b sin alpha), asks
    for a face width times centre distance squared in proportion to it.  With the tangent t = r1'/r1 the curvatures are
    k1 + k2 = (1 + s)^2/(a s sqrt(1 + t^2)).
    """
    place = rigid.place
    assert place is not None
    distance_mm = place.center_distance_mm

    def loads(stretch: Stretch, phi1: Array) -> tuple[Jet, Jet]:
        force = rigid.on(stretch, phi1).mesh_force.size_n
        slope = stretch.driven_angle(phi1, force.order + 2).differentiated()
        tangent, ratio = tangent_slope(slope, place.mesh), slope.truncated(force.order)
        curved = (1.0 + ratio) * (1.0 + ratio) / (ratio * jet.sqrt(1.0 + tangent * tangent))
        return force, force * curved * distance_mm

    ranges = [
        extremes_on(partial(loads, stretch), grid_between(stretch.start_rad, stretch.end_rad, breaks))
        for stretch, breaks in broken_cycle(rigid)
    ]
    least, most = min(force[0].value for force, _ in ranges), max(force[1].value for force, _ in ranges)
    # Beyond 90 degrees the size is negative
    return (inf, inf) if least < -IDLE * most else (most, max(flank[1].value for _, flank in ranges))
