"""The load that vibration of a mesh adds to its teeth: K_V of ISO 6336-1, method B, at every place of the turn.

Both gears are masses at the ends of a spring, the loaded pairs of teeth.  The frequency of passing teeth over the
natural frequency is the resonance ratio

    N = w_passing / sqrt(c_gamma b / m_red),   1 / m_red = r1^2 / J1 + r2^2 / J2

with the arms r of the normal force and the inertias J of both shafts.  Pitch curves that are not round pass their teeth
at a speed that changes within a turn, and arms, inertia and stiffness change too: each place has its own N and K_V, as
if the gears were round with its values.  After ISO 6336-1:2006, 6.5 (from secondary sources: the public programs of
strength/iso6336.py, and two more that agree), with the load w = F_t K_A / b for each mm of width

    N up to N_S     1 + N (Cv1 Bp + Cv2 Bf + Cv3)       N_S = 0.85, under 100 N/mm 0.5 + 0.35 sqrt(w / 100)
    N up to 1.15    1 + Cv1 Bp + Cv2 Bf + Cv4
    N from 1.5      Cv5 Bp + Cv6 Bf + Cv7, linear between 1.15 and 1.5
    Bp = c' f_pb / w,   Bf = c' f_falpha / w,   c' = c_gamma / (0.75 e + 0.25)

where the factors Cv follow from the total contact ratio, e plus the overlap ratio of helical teeth, the deviations f
are those after running in, and B_k is 1, as for grades from 6 on without tip relief for the load.  Here K_V is at least
1: teeth that pass a resonance in every turn never settle above it.

Where the motion of the driven side is followed (``ncgear.dynamics.flank_changes``), the loads already swing with the
stiffness, and K_V is 1 plus the part of the deviations: K_V minus K_V without deviations.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array
from ncgear.numerics.units import N_PER_KG_MM_S2
from ncgear.strength.conditions import Conditions, Running
from ncgear.strength.contacts import LoadedContacts

RESONANCE = 0.85, 1.15
"""The resonance ratios between which a mesh resonates."""

BEYOND = 1.5
"""The resonance ratio from which the mesh runs above its resonance."""

LIGHT_N_MM = 100.0
"""Load per mm of width under which resonance begins at a smaller ratio."""


def dynamic_factor(
    resonance: Array,
    line_n_mm: Array,
    mesh_n_mm2: Array,
    contact_ratio: Array,
    deviations_mm: tuple[float, float],
    overlap_ratio: float = 0.0,
) -> Array:
    """K_V of method B at places of resonance ratio N, all of one shape, at least 1.

    ``line_n_mm`` is F_t K_A / b, above 0, ``mesh_n_mm2`` the mean stiffness c_gamma of the mesh, ``contact_ratio`` its
    contact ratio in sections across the axes, and ``deviations_mm`` are the deviations of base pitch and profile form.
    """
    across = np.maximum(contact_ratio, 1.0)
    e = across + overlap_ratio
    two = e <= 2.0
    more = np.maximum(e, 2.0)
    factors = (
        np.full(e.shape, 0.32),
        np.where(two, 0.34, 0.57 / (more - 0.3)),
        np.where(two, 0.23, 0.096 / (more - 1.56)),
        np.where(two, 0.90, (0.57 - 0.05 * more) / (more - 1.44)),
        np.full(e.shape, 0.47),
        np.where(two, 0.47, 0.12 / (more - 1.74)),
        np.where(e <= 1.5, 0.75, np.where(e > 2.5, 1.0, 0.125 * np.sin(np.pi * (e - 2.0)) + 0.875)),
    )
    single = mesh_n_mm2 / (0.75 * across + 0.25)
    pitch, profile = (single * deviation / line_n_mm for deviation in deviations_mm)
    along = factors[0] * pitch + factors[1] * profile
    below, at = 1.0 + resonance * (along + factors[2]), 1.0 + along + factors[3]
    above = factors[4] * pitch + factors[5] * profile + factors[6]
    begins = RESONANCE[0] - 0.35 * (1.0 - np.sqrt(np.minimum(line_n_mm / LIGHT_N_MM, 1.0)))
    falling = above + (at - above) * (BEYOND - np.clip(resonance, RESONANCE[1], BEYOND)) / (BEYOND - RESONANCE[1])
    return np.asarray(np.maximum(np.where(resonance <= begins, below, falling), 1.0))


@dataclass(frozen=True, eq=False)
class MeshStiffness:
    """Stiffness of a mesh at n driving angles, rising over ``cycle_rad``, as a mean over a tooth pitch; shape (n,).

    ``stiffness_n_mm`` is the stiffness of all loaded pairs, and ``contact_ratio`` their number; a pair of helical teeth
    counts with its share of the width.  Gears that turn less than once have no cycle.
    """

    phi1_rad: Array
    stiffness_n_mm: Array
    contact_ratio: Array
    cycle_rad: float | None

    @classmethod
    def of(
        cls, phi1_rad: Array, stiffness_n_mm: Array, pairs: Array, cycle_rad: float | None, per_pitch: int
    ) -> MeshStiffness | None:
        """Means over a pitch from values at even places, ``per_pitch`` in a pitch; None where no pair is loaded.

        For gears that turn less than once, places of the way out and of the way back count together.
        """
        rows = np.flatnonzero(pairs > 0)
        if not rows.size:
            return None
        rows = rows[np.argsort(phi1_rad[rows], kind="stable")]
        begins = np.arange(rows.size) - per_pitch // 2
        if cycle_rad is None:
            begins = np.clip(begins, 0, max(rows.size - per_pitch, 0))
        around = rows[(begins[:, None] + np.arange(per_pitch)) % rows.size]
        phi1, first = np.unique(phi1_rad[rows], return_index=True)
        stiffness, ratio = (values[around].mean(axis=1)[first] for values in (stiffness_n_mm, pairs))
        return cls(phi1, stiffness, ratio, cycle_rad)

    def at(self, phi1_rad: Array) -> tuple[Array, Array]:
        """Stiffness and contact ratio at driving angles, shape (m,) each."""
        stiffness, ratio = (
            np.interp(phi1_rad, self.phi1_rad, values, period=self.cycle_rad)
            for values in (self.stiffness_n_mm, self.contact_ratio)
        )
        return stiffness, ratio


@dataclass(frozen=True, eq=False)
class Vibration:
    """The values besides its loads on which the vibration of a pair depends.

    At driving angles, shape (n,), ``reduced_kg`` gives the reduced mass along the normal, and ``passing_rad_s`` the
    angular frequency at which teeth pass.  ``deviations_mm`` are those of base pitch and profile form after running in.
    """

    reduced_kg: Callable[[Array], Array]
    passing_rad_s: Callable[[Array], Array]
    deviations_mm: tuple[float, float]
    rack_angle_rad: float
    running: Running

    def resonance(self, phi1_rad: Array, mesh: MeshStiffness) -> Array:
        """N at driving angles, shape (n,); 0 where nothing has inertia."""
        stiffness, _ = mesh.at(phi1_rad)
        swing_s = np.sqrt(self.reduced_kg(phi1_rad) * N_PER_KG_MM_S2 / stiffness)
        return np.asarray(self.passing_rad_s(phi1_rad) * swing_s)

    def factors(
        self,
        phi1_rad: Array,
        force_n: Array,
        mesh: MeshStiffness | None,
        conditions: Conditions,
        followed: bool = False,
    ) -> Array:
        """K_V at driving angles for a normal force of all pairs together, shape (n,) each.

        It is taken from ``conditions`` where they give it.  Forces of a motion that is ``followed`` already swing with
        the stiffness: only the part of the deviations is added.
        """
        if conditions.dynamic_factor is not None or mesh is None:
            return np.full(force_n.shape, conditions.dynamic_factor or 1.0)
        overlap, state = self.running.overlap_ratio, self._state(phi1_rad, force_n, mesh, conditions.application_factor)
        found = dynamic_factor(*state, self.deviations_mm, overlap)
        return found if not followed else 1.0 + found - dynamic_factor(*state, (0.0, 0.0), overlap)

    def factors_at_speeds(
        self, phi1_rad: Array, force_n: Array, mesh: MeshStiffness, application_factor: float, faster: Array
    ) -> Array:
        """K_V, shape (s, n), under the same forces at multiples of the speed, shape (s,)."""
        resonance, line, stiffness, ratio = self._state(phi1_rad, force_n, mesh, application_factor)
        faster, overlap = faster[:, None] * resonance, self.running.overlap_ratio
        return dynamic_factor(faster, line, stiffness, ratio, self.deviations_mm, overlap)

    def _state(
        self, phi1_rad: Array, force_n: Array, mesh: MeshStiffness, application_factor: float
    ) -> tuple[Array, Array, Array, Array]:
        """The first four arguments of ``dynamic_factor``, shape (n,) each."""
        stiffness, ratio = mesh.at(phi1_rad)
        width = self.running.face_width_mm
        line = np.abs(force_n) * (application_factor * cos(self.rack_angle_rad) / width)
        line = np.maximum(line, np.finfo(float).tiny)
        return self.resonance(phi1_rad, mesh), line, stiffness / width, ratio

    def of_contacts(
        self, contacts: LoadedContacts, mesh: MeshStiffness | None, conditions: Conditions, followed: bool = False
    ) -> Array:
        """K_V of loaded contacts, shape (n,), from all contacts of their positions, as ``factors``.

        The load of vibration presses all sections of helical teeth, also those with next to no load; a given K_V
        multiplies each load.
        """
        if not contacts.force_n.size or conditions.dynamic_factor is not None or mesh is None:
            return np.full(contacts.force_n.shape, conditions.dynamic_factor or 1.0)
        _, first, row = np.unique(contacts.position, return_index=True, return_inverse=True)
        row = row.ravel()
        force = np.bincount(row, contacts.force_n).astype(float)
        found = self.factors(contacts.phi1_rad[first], force, mesh, conditions, followed)[row]
        section = row * (int(contacts.section.max()) + 1) + contacts.section
        even = force[row] * contacts.share / np.bincount(section, contacts.force_n)[section]
        return np.asarray(1.0 + (found - 1.0) * even)
