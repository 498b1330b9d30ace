"""High-precision references of pitch curves: radii by rays that meet shapes, mates by quadrature; mm and rad.

Every radius is found from the shape's definition in the plane: a ray from the axis is cut with an ellipse, with lines
and circles, or with a B-spline by de Boor's recursion.  What makes the mate close is a root of the closure alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from mpmath import mp

from oracles.quadrature import integral

Real = Any  # mpf
Radius = Callable[[Real], Real]

SOUGHT = {
    "semi_major": "semi_major_mm",
    "semi_minor": "semi_minor_mm",
    "eccentricity": "eccentricity",
    "side": "side_mm",
    "corner_radius": "corner_radius_mm",
}


@dataclass(frozen=True)
class Curve:
    """Radius by the angle, from 0 to 2 pi, and the angles between which it is smooth, rising from 0 to 2 pi."""

    radius: Radius
    joints: tuple[Real, ...]

    def turned_by_mate(self, distance: Real) -> Real:
        """How far the mate turns while this gear turns once."""
        return sum(
            integral(lambda at: self.radius(at) / (distance - self.radius(at)), a, b) for a, b in pairwise(self.joints)
        )

    def reached_by(self, angle: Callable[[Real], Real]) -> Curve:
        """The curve by another angle, to which its own is (rising or falling) by a shift."""
        turn = 2 * mp.pi
        own = sorted({mp.mpf(0), *(angle_of(joint, angle) for joint in self.joints)})
        joints = [at for at in own if mp.mpf(10) ** -25 < at < turn - mp.mpf(10) ** -25]
        return Curve(lambda at: self.radius(mod(angle(at))), (mp.mpf(0), *joints, turn))


def mod(angle: Real) -> Real:
    """The angle within a turn."""
    return angle - 2 * mp.pi * mp.floor(angle / (2 * mp.pi))


def angle_of(wanted: Real, angle: Callable[[Real], Real]) -> Real:
    """Where a shift, rising or falling, has a value; within a turn."""
    start, slope = angle(mp.mpf(0)), angle(mp.mpf(1)) - angle(mp.mpf(0))
    return mod((wanted - start) / slope)


def ellipse(major: Real, minor: Real, axis: tuple[Real, Real]) -> Curve:
    """The positive root of the ray in the ellipse's equation."""
    x, y = axis

    def radius(at: Real) -> Real:
        c, s = mp.cos(at), mp.sin(at)
        square, half = (c / major) ** 2 + (s / minor) ** 2, c * x / major**2 + s * y / minor**2
        rest = (x / major) ** 2 + (y / minor) ** 2 - 1
        return (mp.sqrt(half**2 - square * rest) - half) / square

    return Curve(radius, tuple(mp.pi * k / 4 for k in range(9)))


def modified_ellipse(latus: Real, eccentricity: Real, lobes: int, modification: Real) -> Curve:
    """Litvin's factors on both parts of each lobe."""
    lobe, top = 2 * mp.pi / lobes, mp.pi / (lobes * modification)

    def radius(at: Real) -> Real:
        within = at - lobe * mp.floor(at / lobe)
        falling = modification / (2 * modification - 1)
        inner = lobes * modification * within if within <= top else lobes * falling * (lobe - within)
        return latus / (1 + eccentricity * mp.cos(inner))

    joints = [k * lobe + part for k in range(lobes) for part in (mp.mpf(0), top / 2, top, (top + lobe) / 2)]
    return Curve(radius, (*joints, 2 * mp.pi))


def rounded_polygon(sides: int, side: Real, corner: Real, axis: tuple[Real, Real], digits: Any = mp) -> Curve:
    """The farthest point of the ray that is in the shape, whose border is lines and arcs; ``digits`` may be mp.fp."""
    x, y = axis
    half = digits.pi / sides
    flat = side / 2 / digits.tan(half)
    out = (flat - corner) / digits.cos(half)

    def radius(at: Real) -> Real:
        c, s = digits.cos(at), digits.sin(at)
        lines, number = [], None
        for k in range(sides):
            facing = c * digits.cos(2 * half * k) + s * digits.sin(2 * half * k)
            if facing > 0:
                reach = (flat - x * digits.cos(2 * half * k) - y * digits.sin(2 * half * k)) / facing
                lines.append((reach, k))
        reach, number = min(lines)
        along = -(x + reach * c) * digits.sin(2 * half * number) + (y + reach * s) * digits.cos(2 * half * number)
        straight = (flat - corner) * digits.tan(half)
        if abs(along) <= straight:
            return reach
        middle = 2 * half * number + half * digits.sign(along)
        across = x - out * digits.cos(middle), y - out * digits.sin(middle)
        b = across[0] * c + across[1] * s
        return digits.sqrt(b**2 - across[0] ** 2 - across[1] ** 2 + corner**2) - b

    joints = {digits.mpf(0), 2 * digits.pi}
    for k in range(sides):
        for sign in (-1, 1):
            ray, straight = 2 * half * k, sign * (flat - corner) * digits.tan(half)
            px = flat * digits.cos(ray) - straight * digits.sin(ray) - x
            py = flat * digits.sin(ray) + straight * digits.cos(ray) - y
            joints.add(digits.mpf(mod(digits.atan2(py, px))))
    return Curve(radius, tuple(sorted(joints)))


def b_spline(xs: list[Real], ys: list[Real], degree: int, axis: tuple[Real, Real]) -> Curve:
    """De Boor's recursion on uniform knots, and the parameter of each ray by bisection."""
    count = len(xs)

    def point(t: Real) -> tuple[Real, Real]:
        span = min(int(mp.floor(t)), count - 1)
        d = [(mp.mpf(xs[(span + j) % count]), mp.mpf(ys[(span + j) % count])) for j in range(degree + 1)]
        for r in range(1, degree + 1):
            for j in range(degree, r - 1, -1):
                share = (t - (span - degree + j)) / (degree + 1 - r)
                d[j] = tuple((1 - share) * before + share * now for before, now in zip(d[j - 1], d[j], strict=True))
        return d[degree][0] - axis[0], d[degree][1] - axis[1]

    def direction(t: Real) -> Real:
        px, py = point(t)
        return mp.atan2(py, px)

    knots = [direction(mp.mpf(k)) for k in range(count)]
    start = knots[0]

    def radius(at: Real) -> Real:
        wanted = mod(at - start)
        span = max(k for k in range(count) if mod(knots[k] - start) <= wanted)
        low, high = mp.mpf(span), mp.mpf(span + 1)
        first, rise = mod(knots[span] - start), mod(knots[(span + 1) % count] - knots[span])

        def missing(t: Real) -> Real:
            turned = direction(t) - knots[span]
            return turned - 2 * mp.pi * mp.nint((turned - (t - low) * rise) / (2 * mp.pi)) - (wanted - first)

        if missing(low) >= 0:
            t = low
        elif missing(high) <= 0:
            t = high
        else:
            c, s = mp.cos(at), mp.sin(at)

            def across(t: Real) -> Real:
                px, py = point(t)
                return py * c - px * s

            t = mp.findroot(across, (low, high), solver="anderson", tol=mp.mpf(10) ** -50, maxsteps=200)
        return mp.hypot(*point(t))

    return Curve(radius, tuple(sorted({mp.mpf(0), 2 * mp.pi, *map(mod, knots)})))


def drawn(motion: dict[str, Any]) -> bool:
    """Whether the curve of a design file's values is drawn in the plane."""
    return any(name in motion for name in ("ellipse", "rounded_polygon", "b_spline"))


def curve(motion: dict[str, Any], formula: Callable[[str, Real], Real]) -> Curve:
    """The curve of a design file's values, in its own angle."""
    if "expression_mm" in motion:
        text = motion["expression_mm"]
        return Curve(lambda at: formula(text, at), tuple(mp.pi * k / 4 for k in range(9)))
    name = next(name for name in ("ellipse", "modified_ellipse", "rounded_polygon", "b_spline") if name in motion)
    keys = motion[name]
    axis = mp.mpf(keys.get("axis_x_mm", 0)), mp.mpf(keys.get("axis_y_mm", 0))
    if name == "ellipse":
        return ellipse(mp.mpf(keys["semi_major_mm"]), mp.mpf(keys["semi_minor_mm"]), axis)
    if name == "modified_ellipse":
        factor = mp.mpf(keys.get("modification", 1))
        return modified_ellipse(
            mp.mpf(keys["semi_latus_rectum_mm"]), mp.mpf(keys["eccentricity"]), keys.get("lobes", 1), factor
        )
    if name == "rounded_polygon":
        return rounded_polygon(keys["sides"], mp.mpf(keys["side_mm"]), mp.mpf(keys["corner_radius_mm"]), axis)
    return b_spline(keys["x_mm"], keys["y_mm"], keys.get("degree", 3), axis)


@dataclass(frozen=True)
class Closed:
    """A curve by the angle that its gear turns, with the centre distance at which the mate closes."""

    curve: Curve
    distance: Real


def closed(
    motion: dict[str, Any], repeats: tuple[int, int], phase: Real, formula: Callable[[str, Real], Real], start: Real
) -> Closed:
    """The curve with what closes it, sought from ``start`` on; ``repeats`` are the lobes of the gear and its mate."""
    wanted = 2 * mp.pi * mp.mpf(repeats[0]) / repeats[1]
    key, distance = SOUGHT.get(motion.get("solve_for", "")), motion.get("center_distance_mm")
    group = next(name for name in motion if isinstance(motion[name], dict)) if key else ""

    def of(value: Real) -> Curve:
        return curve({**motion, group: {**motion[group], key: value}} if key else motion, formula)

    def missing(value: Real) -> Real:
        return of(value).turned_by_mate(distance if key else value) - wanted

    found = mp.findroot(missing, (start, start * (1 + mp.mpf(10) ** -6)), solver="secant", tol=mp.mpf(10) ** -44)
    plain = Closed(of(found), mp.mpf(distance) if key else found)
    back = drawn(motion) and motion.get("gear", "driving") == "driving"
    facing = (lambda at: phase - at) if back else (lambda at: at - phase)
    return replace(plain, curve=plain.curve.reached_by(facing))
