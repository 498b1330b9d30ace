"""The oil between loaded flanks: their temperature, the film against their roughness, and scuffing.

Flash temperature, friction and scuffing follow ISO/TS 6336-20 (Blok's equation), the film ISO/TS 6336-22 (the form of
Dowson and Higginson); both from secondary sources.  Each formula takes the values of its place of contact: the
standards take the coefficient of friction at the pitch point for all places, but here each place has its own.  The
formulas hold for metal flanks with enough oil; slow teeth throw little oil on.
"""

from __future__ import annotations

from enum import StrEnum
from math import log10, sqrt

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array, Columns
from ncgear.strength.conditions import Conditions
from ncgear.strength.hertz import contact_modulus_mpa, half_width_mm, hertz_pressure_mpa
from ncgear.strength.material import Material, MaterialFamily

ZERO_C = 273.15


@dataclass(frozen=True)
class Oil:
    """A mineral oil by its kinematic viscosities at 40 and 100 degrees Celsius in mm2/s."""

    at_40_mm2_s: float
    at_100_mm2_s: float

    @classmethod
    def of(cls, conditions: Conditions) -> Oil:
        """The oil of the service; the base oil of grease."""
        at_40 = conditions.oil_viscosity_mm2_s
        return cls(at_40, conditions.oil_viscosity_100_mm2_s or usual_at_100_mm2_s(at_40))

    def kinematic_mm2_s(self, temperature_c: Array | float) -> Array:
        """The viscosity by ASTM D341: log log (nu + 0.7) = A - B log T, T in K; any shape."""
        (low, first), (high, second) = (
            (log10(celsius + ZERO_C), log10(log10(known + 0.7)))
            for celsius, known in ((40.0, self.at_40_mm2_s), (100.0, self.at_100_mm2_s))
        )
        line = first + (second - first) / (high - low) * (np.log10(np.asarray(temperature_c) + ZERO_C) - low)
        return np.asarray(10.0 ** (10.0**line) - 0.7)

    def dynamic_pa_s(self, temperature_c: Array | float) -> Array:
        """Viscosity times density, which is 43.37 lg nu40 + 805.5 kg/m3 at 15 degrees and falls by 0.7 each kelvin."""
        density = 43.37 * log10(self.at_40_mm2_s) + 805.5 - 0.7 * (np.asarray(temperature_c) - 16.0)
        return np.asarray(1e-6 * self.kinematic_mm2_s(temperature_c) * density)

    def thickening_per_pa(self, temperature_c: Array | float) -> Array:
        """The pressure-viscosity coefficient alpha: 2.657e-8 eta38^0.1348 (1 + 516 (1 / T - 1 / 311))."""
        at_38 = 2.657e-8 * float(self.dynamic_pa_s(38.0)) ** 0.1348
        return np.asarray(at_38 * (1.0 + 516.0 * (1.0 / (np.asarray(temperature_c) + 273.0) - 1.0 / 311.0)))


def usual_at_100_mm2_s(at_40_mm2_s: float) -> float:
    """The viscosity at 100 degrees of mineral oils with a viscosity index of 95.

    A power through two points of ISO 2909: 86.1 and 10, 1725 and 70 mm2/s at 40 and 100 degrees.
    """
    return float(0.554 * at_40_mm2_s**0.649)


@dataclass(frozen=True, eq=False)
class Pressed(Columns):
    """n places at which flanks touch under load.

    ``line_n_mm`` and ``curvature_per_mm`` (shape (n,)) are the load for each mm of width, all factors included, and the
    relative curvature; ``rolling_m_s`` (shape (n, 2)) the speeds of the contact along both flanks.
    """

    line_n_mm: Array
    curvature_per_mm: Array
    rolling_m_s: Array

    @property
    def sum_speed_m_s(self) -> Array:
        """How fast both flanks draw oil into the contact together, shape (n,)."""
        return np.asarray(np.abs(self.rolling_m_s.sum(axis=1)))

    @property
    def sliding_m_s(self) -> Array:
        """Speed of sliding, shape (n,)."""
        return np.asarray(np.abs(self.rolling_m_s[:, 0] - self.rolling_m_s[:, 1]))


def roughness_um(conditions: Conditions) -> float:
    """The mean roughness Ra of both flanks: a sixth of Rz, as ISO 6336-2 takes it."""
    return conditions.flank_roughness_um / 6.0


MOST_FRICTION = 0.2
"""Most friction, of steel that oil hardly parts: the formula of test gears has no limit where flanks draw in no oil."""


def friction(pressed: Pressed, oil: Oil, conditions: Conditions) -> Array:
    """The coefficient of friction at n places, shape (n,).

    mu = 0.060 (w / (v_sum rho))^0.2 eta^-0.05 Ra^0.25 with w in N/mm, v_sum in m/s, rho in mm, eta at the oil's
    temperature in mPa s, Ra in um (ISO/TS 6336-20, method C, of mineral oils); MOST_FRICTION at the most.
    """
    load, drawn = pressed.line_n_mm * pressed.curvature_per_mm, pressed.sum_speed_m_s
    surface = 0.060 * thinness(oil, conditions) * roughness_um(conditions) ** 0.25
    grown = np.divide(load, drawn, out=np.full_like(load, np.inf), where=drawn > 0.0) ** 0.2
    return np.asarray(np.minimum(surface * grown, MOST_FRICTION))


def thinness(oil: Oil, conditions: Conditions) -> float:
    """The factor X_L = eta^-0.05 of mineral oils, with eta in mPa s at the oil's temperature."""
    return float((1e3 * oil.dynamic_pa_s(conditions.oil_temperature_c)) ** -0.05)


THERMAL = {
    MaterialFamily.STEEL: (45.0, 440.0),
    MaterialFamily.CAST_IRON: (45.0, 500.0),
    MaterialFamily.BRONZE: (55.0, 380.0),
}
"""Conductivity in W/(m K) and heat capacity in J/(kg K): steel by ISO/TS 6336-22, others rounded from data sheets."""


def flash_k(pressed: Pressed, coefficient: Array, materials: tuple[Material, Material]) -> Array:
    """Heating of the flanks within the contact, in K at n places, shape (n,): Blok's equation.

    1.11 mu w |v1 - v2| / (sqrt(2 b) (B1 sqrt(v1) + B2 sqrt(v2))) in SI units with the thermal contact coefficients
    B = sqrt(conductivity density heat) and Hertz's half-width b.  It holds for contacts so fast that no heat spreads
    along the flanks; slower contacts are heated less.
    """
    first, second = (sqrt(np.prod(THERMAL[material.family]) * material.density_kg_m3) for material in materials)
    roots = np.sqrt(np.abs(pressed.rolling_m_s))
    carried = first * roots[:, 0] + second * roots[:, 1]
    width = np.sqrt(2e-3 * half_width_mm(pressed.line_n_mm, pressed.curvature_per_mm, materials))
    heat = 1.11e3 * coefficient * pressed.line_n_mm * pressed.sliding_m_s
    return np.asarray(np.divide(heat, width * carried, out=np.zeros_like(heat), where=(width > 0.0) & (carried > 0.0)))


BULK_SHARE = {"oil": 0.47, "grease": 0.47 * 1.2}
"""Rise of the teeth over their oil as a share of the mean flash temperature, 0.47 X_S of ISO/TS 6336-20: dip
lubrication, and grease as sprayed oil: own choice, because it takes away less heat."""


HOTTEST_C = 300.0
"""Highest temperature at which the formulas thin the oil: beyond it oil burns, and they have no meaning."""


def film_um(pressed: Pressed, flash: Array, bulk_c: float, oil: Oil, materials: tuple[Material, Material]) -> Array:
    """The thickness of the film at n places, in um, shape (n,).

    1600 rho G^0.6 U^0.7 W^-0.13 S^0.22 with rho in mm, G = alpha E_r, U = eta v_sum / (2 E_r rho), W = 2 pi (p / E_r)^2
    and S the ratio of alpha eta at the contact's temperature to that at the teeth's: sliding thins the oil.
    """
    modulus_pa, bulk_c = 2e6 * contact_modulus_mpa(materials), min(bulk_c, HOTTEST_C)
    radius_mm = 1.0 / pressed.curvature_per_mm
    speed = oil.dynamic_pa_s(bulk_c) * pressed.sum_speed_m_s / (2.0 * modulus_pa * 1e-3 * radius_mm)
    pressure = hertz_pressure_mpa(pressed.line_n_mm, pressed.curvature_per_mm, materials)
    load = 2.0 * np.pi * (1e6 * pressure / modulus_pa) ** 2
    stiff = oil.thickening_per_pa(bulk_c) * modulus_pa
    hot = np.minimum(bulk_c + flash, HOTTEST_C)
    cold = oil.thickening_per_pa(bulk_c) * oil.dynamic_pa_s(bulk_c)
    thinned = oil.thickening_per_pa(hot) * oil.dynamic_pa_s(hot) / cold
    return np.asarray(1600.0 * radius_mm * stiff**0.6 * speed**0.7 * load**-0.13 * thinned**0.22)


class Regime(StrEnum):
    """How flanks are parted: by the oil's film, in part, or hardly."""

    FULL = "full film"
    MIXED = "mixed"
    BOUNDARY = "boundary"

    @classmethod
    def of(cls, thickness: float) -> Regime:
        """The regime of a specific film thickness lambda: up to 0.7 boundary, from 2 on full (Niemann and Winter)."""
        return cls.BOUNDARY if thickness < 0.7 else cls.MIXED if thickness < 2.0 else cls.FULL


def scuffing_c(oil: Oil, conditions: Conditions, structure: float) -> float:
    """The temperature of the contact at which flanks scuff: 80 + (0.85 + 1.4 X_W) X_L S^2.

    S is the load stage at which the oil fails in the FZG test A/8.3/90, X_W the structural factor of the steel.
    """
    return 80.0 + (0.85 + 1.4 * structure) * thinness(oil, conditions) * conditions.oil_fzg_stage**2
