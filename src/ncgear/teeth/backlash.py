"""Backlash by turning: both sides of the teeth follow the law exactly, and the play is the same angle everywhere.

The driven gear's idle flanks are the exact flanks of the law, turned about the gear's axis by a constant angle delta.
The pushing flanks touch at the law's driven angle phi2(phi1), the idle flanks at phi2(phi1) + delta: the idle flanks
are conjugate too, for any curves.  Between these two angles the gears are free, since a tooth that is turned off its
loaded flank stays within the tooth without play.

The share of delta that the driving gear's teeth lose is a choice: its idle flanks are set back by t along the pitch
curve, and the driven gear's are set forward by t before they are turned.  Flanks that cross the rolling curves at equal
arc lengths are conjugate, so this does not change the play.

The common normal of idle flanks goes through the pitch point, so its arm about the driven axis is

    L = r2 cos(alpha + theta),  tan(theta) = r1' / r1,

at any contact on the line of action; alpha is the rack's pressure angle of idle flanks, r1 and r2 are the pitch radii
and the prime is a derivative by the driving angle.  Along the normal the play is L delta.

A deviation of the tooth thickness moves idle flanks too, so that pushing flanks keep the law: by e along the pitch
curve, on both gears, which takes 2 e cos(alpha) off the play along the normal at every position.
"""

from __future__ import annotations

from functools import lru_cache
from math import cos, degrees, sin

from ncgear.errors import WrongInput
from ncgear.frozen import dataclass
from ncgear.numerics import jet
from ncgear.numerics.bounds import shown_above, shown_below
from ncgear.numerics.extrema import Extremum
from ncgear.numerics.jet import Jet
from ncgear.pitch import shape
from ncgear.pitch.pair import PitchPair
from ncgear.pitch.shape import Gear
from ncgear.teeth.form import Backlash, BasicRack

MOST_THINNED = 0.8
"""Largest share of half a pitch that play may take off a tooth at the pitch curve.  With more, less than a fifth of its
thickness would remain, and nothing at its tip."""


ROUNDING_MM = 1e-9
"""Rounding error of a thickness."""


@dataclass(frozen=True)
class Play:
    """The play of a pair.

    The driven gear's idle flanks are turned by ``driven_rad``.  Without a deviation of the teeth's thickness, the gear
    can turn by this angle at every position.  ``least_normal_mm`` and ``largest_normal_mm`` are the play along the idle
    flanks' normal, ``at`` driving angles in rad.  The driving gear's idle flanks are set back by ``setback_mm`` along
    the pitch curve, and the idle flanks of both gears stand out by ``thicker_mm``.
    """

    driven_rad: float
    least_normal_mm: Extremum
    largest_normal_mm: Extremum
    setback_mm: float
    thicker_mm: float = 0.0


NO_PLAY = Play(0.0, Extremum(0.0, 0.0), Extremum(0.0, 0.0), 0.0)


@lru_cache(maxsize=1)
def play_of(pitch: PitchPair, rack: BasicRack, asked: Backlash) -> Play:
    """The wanted play on pitch curves, the same for all sections; raises WrongInput where it leaves no teeth."""
    lower, upper = asked.thickness_mm
    if not (asked.least_normal_mm or asked.driven_rad or lower or upper):
        return NO_PLAY
    least, largest = idle_arms_mm(pitch, rack)
    angle = asked.driven_rad or asked.least_normal_mm / least.value
    cosine = cos(rack.angles_rad[1])
    setback = asked.driving_share * angle * least.value / cosine
    thinner = max(setback, angle * largest.value / cosine - setback)
    allowed = require_teeth(asked, thinner, rack)
    if thinner - lower >= allowed:
        raise WrongInput(
            f"{lower:g} mm and the backlash take more than {MOST_THINNED:.0%} of the thickness off some teeth at the "
            f"pitch curve; over {shown_above(thinner - allowed, 3)} mm is right",
            key="gears.tolerances.tooth_thickness_lower_mm",
        )
    room_mm = least.value * angle / (2.0 * cosine)
    if upper > room_mm + ROUNDING_MM:
        enough = shown_above(2.0 * upper * cosine, 3)
        remedy = f"{shown_below(room_mm, 3)} mm or less is right, or backlash_mm of {enough} mm or more"
        raise WrongInput(
            f"{upper:g} mm on both gears is more than their backlash, so that the thickest teeth jam; {remedy}",
            key="gears.tolerances.tooth_thickness_upper_mm",
        )
    wider_mm = -2.0 * asked.thicker_mm * cosine
    low, high = (Extremum(extremum.value * angle + wider_mm, extremum.at) for extremum in (least, largest))
    return Play(angle, low, high, setback, asked.thicker_mm)


def require_teeth(asked: Backlash, thinner_mm: float, rack: BasicRack) -> float:
    """Largest loss of the teeth's thickness in mm; raises WrongInput where the wanted play takes more."""
    allowed = MOST_THINNED * rack.pitch_mm / 2.0
    if thinner_mm >= allowed:
        given, key, unit = asked.least_normal_mm, "gears.backlash_mm", "mm"
        if asked.driven_rad:
            given, key, unit = degrees(asked.driven_rad), "gears.backlash_deg", "deg"
        raise WrongInput(
            f"{given:g} {unit} takes more than {MOST_THINNED:.0%} of the thickness off some teeth at the pitch curve; "
            f"only under {shown_below(given * (allowed / thinner_mm), 3)} {unit} takes less",
            key=key,
        )
    return allowed


def idle_arms_mm(pitch: PitchPair, rack: BasicRack) -> tuple[Extremum, Extremum]:
    """The least and the largest arm of the idle flanks' normal about the driven axis, L above, at driving angles."""
    angle_rad = rack.angles_rad[1]

    def arm(slope: Jet) -> Jet:
        """L at unit centre distance from dphi2/dphi1, one order less."""
        tilt = shape.tangent_slope(slope, pitch.mesh)
        radius = shape.radius(slope.truncated(tilt.order), Gear.DRIVEN, pitch.mesh)
        return radius * (cos(angle_rad) - sin(angle_rad) * tilt) / jet.sqrt(tilt * tilt + 1.0)

    low, high = (
        Extremum(extremum.value * pitch.center_distance_mm, extremum.at)
        for extremum in pitch.transmission.extremes(arm, 1)
    )
    return low, high
