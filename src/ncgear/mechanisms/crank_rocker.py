"""The crank-rocker: a four-bar linkage whose crank turns fully and whose rocker, the output, swings to and fro.

Frame and pose: the crank's axis O is at the origin and the crank turns clockwise; the rocker's axis C is at (d, 0), its
pin B above the line of the axes (``side`` 1) or below it (``side`` -1). The place of the rocker is the angle gamma at C
from CO to CB, which lies between 0 and pi, and grows from the retracted dead centre, where crank and coupler lie over
each other, to the extended dead centre, where they lie in one line.  Loads of the output are torques in N mm that act
towards the retracted dead centre.

Let a, b, c, d be crank, coupler, rocker and ground, and theta the direction of the crank from the line of the axes,
counted towards the side of the rocker's pin.  The loop is closed where (F. Freudenstein, "Approximate synthesis of
four-bar linkages", Trans. ASME 77 (1955) 853-861, with gamma in place of its supplement)

    a^2 + c^2 + d^2 - b^2 - 2 a d cos(theta) - 2 c d cos(gamma) + 2 a c cos(gamma + theta) = 0

At the dead centres OB = b -+ a, and gamma follows from the triangle of OB, c and d.  The crank turns fully where it is
the shortest and a + longest < sum of the other two (F. Grashof, "Theoretische Maschinenlehre", vol. 2, 1883).
"""

from __future__ import annotations

from collections.abc import Mapping
from math import factorial, pi
from typing import Any, ClassVar, Self

import numpy as np

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.mechanisms.forces import JointForces, Masses, Pace, crank_forces, moving_force, place
from ncgear.mechanisms.mechanism import Link, LinkShape, Mechanism, Mechanisms, MovingMass, Output, Point
from ncgear.numerics import jet
from ncgear.numerics.arrays import Array, Mask, Number
from ncgear.numerics.bounds import shown_below
from ncgear.numerics.jet import Jet
from ncgear.numerics.plane import Term, Vector
from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.numerics.zeros import zeros_between

SINC = tuple((-1.0) ** k / factorial(2 * k + 1) for k in range(12))
"""Coefficients of sin(z)/z in powers of z^2; exact to rounding up to z = pi/2, more than half of any stroke."""


@dataclass(frozen=True)
class RockerMasses(Masses):
    """The masses of a crank-rocker.

    The coupler's centre of mass lies ``coupler_center_mm`` from the crank pin towards the rocker's pin; its inertia is
    about that centre.  The rocker's centre of mass lies ``rocker_center_mm`` from its axis towards its pin; its inertia
    is about the axis and includes everything that turns with it.
    """

    rocker_kg: float = 0.0
    rocker_center_mm: float = 0.0
    rocker_inertia_kg_mm2: float = 0.0
    coupler_kg: float = 0.0
    coupler_center_mm: float = 0.0
    coupler_inertia_kg_mm2: float = 0.0


@dataclass(frozen=True, eq=False)
class CrankRockers(Mechanisms[Number]):
    """Quantities that follow from the lengths of one crank-rocker, or of n of them where lengths have shape (n,)."""

    crank_mm: Number
    coupler_mm: Number
    rocker_mm: Number
    ground_mm: Number
    side: Number

    @property
    def turns_fully(self) -> Mask:
        """Where |coupler - rocker| < ground - crank and ground + crank < coupler + rocker."""
        near = np.abs(self.coupler_mm - self.rocker_mm) < self.ground_mm - self.crank_mm
        return near & (self.ground_mm + self.crank_mm < self.coupler_mm + self.rocker_mm)

    @property
    def nearest_mm(self) -> Number:
        """The angle gamma in rad at the retracted dead centre."""
        sine, cosine = self._half_angle(self._near_mm)
        return 2.0 * np.arctan2(sine, cosine)

    @property
    def stroke_mm(self) -> Number:
        """The angle in rad through which the rocker swings: the sine of half of it is free of cancellation."""
        (sine, cosine), (far_sine, far_cosine) = map(self._half_angle, (self._near_mm, self._far_mm))
        share = self.crank_mm * self.coupler_mm / (self.ground_mm * self.rocker_mm)
        half: Number = np.arcsin(share / (far_sine * cosine + far_cosine * sine))
        return 2.0 * half

    @property
    def half_way(self) -> Number:
        """Half the stroke in rad."""
        return 0.5 * self.stroke_mm

    @property
    def working_angle_rad(self) -> Number:
        """Crank angle from the retracted to the extended dead centre: pi plus the angle between the two couplers."""
        near, far = self.nearest_mm, self.nearest_mm + self.stroke_mm
        return pi + self.side * (self._direction(near) - self._direction(far))

    def _direction(self, gamma_rad: Number) -> Number:
        """Direction of the rocker's pin from the crank's axis, positive towards the side of the pin."""
        across, along = self.rocker_mm * np.sin(gamma_rad), self.ground_mm - self.rocker_mm * np.cos(gamma_rad)
        return np.arctan2(across, along)

    @property
    def _near_mm(self) -> Number:
        """Distance of the crank's axis from the rocker's pin at the retracted dead centre."""
        return self.coupler_mm - self.crank_mm

    @property
    def _far_mm(self) -> Number:
        """Distance of the crank's axis from the rocker's pin at the extended dead centre."""
        return self.coupler_mm + self.crank_mm

    def _half_angle(self, distance_mm: Number) -> tuple[Number, Number]:
        """Sine and cosine of gamma/2 where the rocker's pin is at a distance from the crank's axis."""
        legs = 4.0 * self.ground_mm * self.rocker_mm
        apart, whole = self.ground_mm - self.rocker_mm, self.ground_mm + self.rocker_mm
        sine: Number = np.sqrt((distance_mm - apart) * (distance_mm + apart) / legs)
        cosine: Number = np.sqrt((whole - distance_mm) * (whole + distance_mm) / legs)
        return sine, cosine

    @property
    def _start_rad(self) -> Number:
        """Angle theta at the retracted dead centre: opposite to the rocker pin's direction from the crank's axis."""
        return pi + self._direction(self.nearest_mm)

    def displacement(self, crank_angle: Jet) -> Jet:
        """The rocker's angle from the retracted dead centre in rad, with derivatives; relatively accurate near zeros.

        With x the displacement and v the change of theta, the equation of the loop less its value at the dead centre,
        where its slope by theta is zero, is P (1 - cos x) + Q sin x = R with R = a (b - a) (1 - cos v)/c.  (P, Q) is CA
        turned by gamma at the dead centre; tan(x/2) = R/(Q + S) = (S - Q)/(2 P - R) where S = CA sin(angle at C from A
        to B), free of cancellation with the sign of Q that makes both terms one-signed.
        """
        start, near = self._start_rad, self.nearest_mm
        turned = -self.side * crank_angle
        versine = jet.sine_versine(turned)[1]
        both_sine, both_cosine = jet.sin_cos(turned + (start + near))
        _, half_cosine = jet.sin_cos((turned + start) * 0.5)
        opened = half_cosine * half_cosine * (4.0 * self.crank_mm * self.ground_mm)
        along = self.ground_mm * np.cos(near) - self.crank_mm * both_cosine
        across = self.ground_mm * np.sin(near) - self.crank_mm * both_sine
        raised = versine * (self.crank_mm * self._near_mm / self.rocker_mm)
        # (b + c)^2 - AC^2 and AC^2 - (b - c)^2
        whole, apart = self.ground_mm + self.crank_mm, self.coupler_mm - self.rocker_mm
        joined = self.coupler_mm + self.rocker_mm
        short = opened + (joined - whole) * (joined + whole)
        long = (whole - apart) * (whole + apart) - opened
        root = jet.sqrt(short * long) / (2.0 * self.rocker_mm)
        ahead = across.value >= 0.0
        rise = Jet(np.where(ahead, raised.coefficients, (root - across).coefficients))
        run = Jet(np.where(ahead, (root + across).coefficients, (2.0 * along - raised).coefficients))
        return 2.0 * jet.arctan(rise / run)

    def working_angle(self, displacement_mm: Array, remaining_mm: Array) -> Array:
        """Crank angle in rad in the working stroke, at angles of the rocker and at the rest of its swing, shape (n,).

        With s = OB, and s0 and s1 its ends, the triangle of crank, coupler and s gives the angle w between its crank
        and the crank of the retracted dead centre, without the turning of s: tan^2(w/2) = (s - s0)(s + s1)/((s1 - s)(s
        + s0)), where s^2 - s0^2 = 4 c d sin(x/2) sin(gamma0 + x/2), and likewise at the other end.
        """
        near, distance = self.nearest_mm, np.sqrt(self._square(np.sin(0.5 * (displacement_mm + self.nearest_mm))))
        gone = np.sin(0.5 * displacement_mm) * np.sin(near + 0.5 * displacement_mm)
        left = np.sin(0.5 * remaining_mm) * np.sin(near + self.stroke_mm - 0.5 * remaining_mm)
        sine_side, cosine_side = np.sqrt(gone) * (distance + self._far_mm), np.sqrt(left) * (distance + self._near_mm)
        return 2.0 * (np.arctan2(sine_side, cosine_side) + self._half_tilt(displacement_mm))

    def regular_slope(self, displacement: Jet, root: Jet) -> Jet:
        """The slope of w, which the law of cosines gives as in a crank-slider, and that of s, times the root.

        In both, s^2 - s0^2 and s1^2 - s^2 are as in ``working_angle``, with sin(z) = z sinc(z).
        """
        near, half, left = self.nearest_mm, displacement * 0.5, (self.stroke_mm - displacement) * 0.5
        sine, cosine = jet.sin_cos(displacement + near)
        square = self._square(jet.sin_cos(half + 0.5 * near)[0])
        rise, _ = jet.sin_cos(half + near)
        fall, _ = jet.sin_cos(near + self.stroke_mm - left)
        ends = jet.sqrt(_sinc(half) * rise * _sinc(left) * fall) * 2.0
        turned = root * (cosine * -self.ground_mm + self.rocker_mm) * (self.side * self.rocker_mm)
        return (sine * (square + self._near_mm * self._far_mm) / ends + turned) / square

    def _square(self, half_sine: Array | Jet) -> Any:
        """OB^2 in mm^2 from sin(gamma/2)."""
        square = half_sine * half_sine * (4.0 * self.ground_mm * self.rocker_mm)
        return square + (self.ground_mm - self.rocker_mm) ** 2

    def _half_tilt(self, displacement_mm: Array) -> Array:
        """Half the angle in rad by which OB turns with the crank on the way to a displacement."""
        near, half = self.nearest_mm, 0.5 * displacement_mm
        moved = 2.0 * self.rocker_mm * np.sin(half)
        x, y = self.ground_mm - self.rocker_mm * np.cos(near), self.rocker_mm * np.sin(near)
        dx, dy = moved * np.sin(half + near), moved * np.cos(half + near)
        distance = np.sqrt(self._square(np.sin(half + 0.5 * near)))
        facing = distance * self._near_mm + dx * x + dy * y + self._near_mm**2
        return np.arctan((dx * y - dy * x) / facing) * self.side


def _sinc(argument: Jet) -> Jet:
    return jet.polynomial(SINC, argument * argument)


@dataclass(frozen=True)
class CrankRocker(CrankRockers[float], Mechanism):
    """A crank-rocker; raises WrongInput for lengths that are not positive or whose crank cannot turn fully."""

    NAME: ClassVar[str] = "a crank-rocker"
    OUTPUT: ClassVar[Output] = Output("rocker", angular=True)
    PISTON: ClassVar[bool] = False
    GUIDED: ClassVar[bool] = False
    POINTS: ClassVar[tuple[str, ...]] = ()
    RODS: ClassVar[tuple[str, ...]] = ("rocker", "coupler")
    MASSES: ClassVar[type[Masses]] = RockerMasses
    JOINTS: ClassVar[Mapping[str, str]] = {
        "rocker_bearing": "rocker's bearing",
        "rocker_pin": "rocker pin",
        "pin": "crank pin",
    }
    PINS: ClassVar[Mapping[str, str]] = {"crank-pin": "coupler", "rocker-pin": "rocker"}

    crank_mm: float
    coupler_mm: float
    rocker_mm: float
    ground_mm: float
    side: float = 1.0

    def __post_init__(self) -> None:
        for name in ("crank_mm", "coupler_mm", "rocker_mm", "ground_mm"):
            if not getattr(self, name) > 0.0:
                problem = f"{getattr(self, name):g} is not a length; a positive one is needed"
                raise WrongInput(problem, key=f"linkage.{name}")
        if self.side not in (1, -1):
            raise WrongInput(f"{self.side:g} given; 1 or -1 is right", key="linkage.side")
        if self.turns_fully:
            return
        others = {"coupler": self.coupler_mm, "rocker": self.rocker_mm, "ground": self.ground_mm}
        longest = max(others, key=others.__getitem__)
        most = sum(others.values()) - 2.0 * others[longest]
        least = min(most, *others.values())
        cure = f"a crank under {shown_below(least)} mm works" if least > 0.0 else f"a shorter {longest} is needed first"
        raise WrongInput(
            f"the crank cannot turn fully: it must be the shortest link, and crank + {longest} = "
            f"{self.crank_mm + others[longest]:g} mm less than the other two together, "
            f"{sum(others.values()) - others[longest]:g} mm (Grashof); {cure}",
            key="linkage.crank_mm",
        )

    @classmethod
    def many(cls, **lengths: Array) -> CrankRockers[Array]:
        """Many crank-rockers; ``turns_fully`` tells which of them are possible."""
        return CrankRockers(**{"side": np.ones_like(lengths["crank_mm"]), **lengths})

    @classmethod
    def of_stroke(cls, stroke_mm: float, **lengths: float) -> Self:
        """The crank-rocker with given coupler, rocker and ground whose rocker swings through an angle in rad.

        The angle grows from 0 with the length of the crank, which is found in a bracket.  Raises WrongInput where no
        crank gives the angle.
        """
        others = [lengths[name] for name in ("coupler_mm", "rocker_mm", "ground_mm")]
        most = min(*others, sum(others) - 2.0 * max(others))
        longest = most * (1.0 - 1e-9)
        if not (most > 0.0 and 0.0 < stroke_mm < cls(longest, **lengths).stroke_mm):
            raise WrongInput(
                f"no crank swings this rocker through the {np.degrees(stroke_mm):.6g} deg that follow from the law; "
                "a shorter rocker_mm swings further",
                key="linkage.rocker_mm",
            )
        columns = {name: np.array([value]) for name, value in lengths.items()}
        found = zeros_between(
            lambda crank: cls.many(crank_mm=crank, **columns).stroke_mm - stroke_mm, np.zeros(1), np.array([longest])
        )
        return cls(float(found[0]), **lengths)

    def crank_angle(self, displacement_mm: Array, returning: Mask) -> Array:
        """Crank angle in rad, 0 to 2 pi, at displacements in [0, stroke] in rad, both of shape (n,)."""
        working = self.working_angle(displacement_mm, self.stroke_mm - displacement_mm)
        tilt = 2.0 * self._half_tilt(displacement_mm)
        return np.where(returning, 2.0 * pi - working + 2.0 * tilt, working)

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """Crank angles at which crank and ground lie in one line, and the width of the bend of the displacement there.

        The roots of the closed loop meet where AC = b + c, at theta = pi + i y, or AC = |b - c|, at theta = i y: cosh y
        - 1 is the excess of (b + c)^2 over (a + d)^2, or of (d - a)^2 over (b - c)^2, over 2 a d.
        """
        twice = 2.0 * self.crank_mm * self.ground_mm
        whole, joined = self.crank_mm + self.ground_mm, self.coupler_mm + self.rocker_mm
        apart, less = self.ground_mm - self.crank_mm, self.coupler_mm - self.rocker_mm
        excess = {pi: (joined - whole) * (joined + whole) / twice, 0.0: (apart - less) * (apart + less) / twice}
        return tuple(
            (float(self.side * (self._start_rad - theta) % (2.0 * pi)), float(2.0 * np.arcsinh(np.sqrt(0.5 * beyond))))
            for theta, beyond in excess.items()
        )

    @property
    def crank_start_rad(self) -> float:
        """Direction opposite to the direction from the crank's axis to the rocker's pin."""
        return float(self.side * self._start_rad)

    @property
    def pivots_mm(self) -> Mapping[str, Point]:
        """The axis of the rocker."""
        return {"rocker": (self.ground_mm, 0.0)}

    def links(self, crank_angle: Jet) -> Mapping[str, Link]:
        """Rocker, crank and coupler; each has its own frame, with +x from its first pin, the origin, to its next.

        The rocker's own frame has its origin at its pin and its axis on +x, the coupler's at the crank's pin.
        """
        rocker, pin = self._rocker(crank_angle), self.crank_body(crank_angle, 0.0).pin
        along = rocker.origin - pin
        # Relative to the direction at the retracted dead centre, from which the coupler never turns by half a turn
        start = self.crank_start_rad - pi
        cosine, sine = np.cos(start), np.sin(start)
        x, y = along.x * cosine + along.y * sine, along.y * cosine - along.x * sine
        coupler = 2.0 * jet.arctan(y / (x + self.coupler_mm)) + start
        return {"rocker": rocker, "crank": self.crank_link(crank_angle), "coupler": Link(pin, coupler)}

    def _rocker(self, crank_angle: Jet) -> Link:
        gamma = self.displacement(crank_angle) + self.nearest_mm
        sine, cosine = jet.sin_cos(gamma)
        pin = Vector(self.ground_mm - self.rocker_mm * cosine, self.side * self.rocker_mm * sine)
        return Link(pin, -self.side * gamma)

    def transmission_rad(self, crank_rad: Array) -> Array:
        """Angle between coupler and rocker."""
        links = self.links(Jet(crank_rad[None, :]))
        return np.arcsin(np.abs(np.sin(links["coupler"].angle.value - links["rocker"].angle.value)))

    @property
    def rod_lines_mm(self) -> Mapping[str, tuple[tuple[Point, Point], ...]]:
        """The coupler from the crank pin to the rocker, and the rocker from its pin to its axis."""
        lengths = {"coupler": self.coupler_mm, "rocker": self.rocker_mm}
        return {name: (((0.0, 0.0), (length, 0.0)),) for name, length in lengths.items()}

    def shapes(self) -> Mapping[str, LinkShape]:
        """Rocker and coupler with an eye at each end."""
        return {name: LinkShape(bars, bars[0]) for name, bars in self.rod_lines_mm.items()}

    def moving_masses(self, crank_angle: Jet, masses: Masses) -> tuple[MovingMass, ...]:
        """Rocker and coupler."""
        assert isinstance(masses, RockerMasses)
        links = self.links(crank_angle)
        own = masses.rocker_inertia_kg_mm2 - masses.rocker_kg * masses.rocker_center_mm**2
        rocker = MovingMass(
            masses.rocker_kg, self._on_rocker(links["rocker"], masses.rocker_center_mm), links["rocker"].angle, own
        )
        center = self._on_coupler(links["coupler"].origin, links["rocker"].origin, masses.coupler_center_mm)
        return rocker, MovingMass(masses.coupler_kg, center, links["coupler"].angle, masses.coupler_inertia_kg_mm2)

    def _on_rocker(self, rocker: Link, distance_mm: float) -> Vector:
        """The point of the rocker at a distance from its axis towards its pin."""
        axis = self._axis(rocker.angle)
        return axis + (rocker.origin - axis) * (distance_mm / self.rocker_mm)

    def _on_coupler(self, pin: Vector, rocker_pin: Vector, distance_mm: float) -> Vector:
        """The point of the coupler at a distance from the crank's pin towards the rocker's pin."""
        return pin + (rocker_pin - pin) * (distance_mm / self.coupler_mm)

    def _axis(self, angle: Jet) -> Vector:
        still = 0.0 * angle
        return Vector(still + self.ground_mm, still)

    def joint_forces(self, crank_angle: Jet, masses: Masses, pace: Pace, resistance_n: Term) -> JointForces:
        """Forces at the rocker's axis, its pin and the crank's pin by the equations of rocker, coupler and crank.

        Moments of the rocker about its axis and of the coupler about the crank's pin are two equations for the force at
        the rocker's pin.  The forces at the rocker's axis and pin act on the rocker, the force at the crank's pin acts
        on the coupler.
        """
        assert isinstance(masses, RockerMasses)
        rocker, coupler = self.moving_masses(crank_angle, masses)
        links, crank = self.links(crank_angle), self.crank_body(crank_angle, masses.crank_center_mm)
        axis = self._axis(crank_angle)
        arm, reach = (place(pace, links["rocker"].origin - point) for point in (axis, crank.pin))
        swings, moves = (moving_force(masses, pace, body.mass_kg, body.center) for body in (rocker, coupler))
        turned, tilted = (
            pace.second(body.angle) * (N_PER_KG_MM_S2 * body.inertia_kg_mm2) for body in (rocker, coupler)
        )
        # Counter-clockwise moments of the pin's force about the axis, and of its opposite about the crank's pin
        about_axis = turned + place(pace, rocker.center - axis).cross(swings) - self.side * resistance_n
        about_pin = tilted + place(pace, coupler.center - crank.pin).cross(moves)
        pushed = (reach * about_axis + arm * about_pin) * (1.0 / arm.cross(reach))
        pin = moves + pushed
        crank_axis, torque = crank_forces(crank, masses, pace, pin)
        joints = {"rocker_bearing": swings - pushed, "rocker_pin": pushed, "pin": pin}
        return JointForces(joints, crank_axis, 0.0 * pushed.x, torque)
