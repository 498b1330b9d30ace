"""A mesh that swings, at many speeds: a spring that changes from tooth to tooth and along the pitch curves.

With x the driven gear's angle beyond the law's, e that angle at rest under the load, K the stiffness of the loaded
pairs about the driven axis and J the inertia of both shafts there, 1/J = 1/J2 + (dphi2/dphi1)^2 / J1,

    (J x.). + C x. + K (x - e) = 0,   C = 2 zeta sqrt(J K),   phi1 = w t

so that the teeth bear T - K (x - e) instead of T: a parametric oscillator (Hill's equation), driven by the error of the
loaded teeth from tooth to tooth.  Between two places K, J and e' are constant, and the step is exact.  The periodic
motion follows from the map over a cycle, whose multipliers (Floquet) tell whether other motions die away.  The pairs
are those loaded at rest: where teeth would part, the result exceeds the true swing.
"""

from __future__ import annotations

import numpy as np

from ncgear.frozen import dataclass
from ncgear.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class SwingingMesh:
    """A mesh at m driving angles, rising over a cycle; shape (m,) each.

    ``stiffness_n_mm`` is K in N mm per rad, ``inertia_n_mm_s2`` J, ``error_rad`` e, ``torque_n_mm`` T of the driven
    gear; ``damping_ratio`` is zeta.
    """

    phi1_rad: Array
    cycle_rad: float
    stiffness_n_mm: Array
    inertia_n_mm_s2: Array
    error_rad: Array
    torque_n_mm: Array
    damping_ratio: float


@dataclass(frozen=True, eq=False)
class Swings:
    """The swings of a mesh at s speeds; shape (s,) each.

    ``load_factor`` is the largest torque of the teeth over the largest at rest, infinite where swings grow without end;
    ``multiplier`` is the factor by which a swing grows over a cycle.
    """

    load_factor: Array
    multiplier: Array


def swings(mesh: SwingingMesh, speeds_rad_s: Array) -> Swings:
    """The swings of a mesh at driving speeds in rad/s, shape (s,), all above 0."""
    steps = _Steps.of(mesh, speeds_rad_s)
    # Columns: two unit states without excitation, and the state of rest with excitation.
    states = np.zeros((2, 3, speeds_rad_s.size))
    states[0, 0] = states[1, 1] = 1.0
    driven = np.array([0.0, 0.0, 1.0])[:, None]
    for row in range(mesh.phi1_rad.size):
        states = steps.after(row, states, driven)
    turned, last = states[:, :2], states[:, 2]
    trace, determinant = turned[0, 0] + turned[1, 1], turned[0, 0] * turned[1, 1] - turned[0, 1] * turned[1, 0]
    root = np.sqrt((trace / 2.0) ** 2 - determinant + 0j)
    multiplier = np.maximum(np.abs(trace / 2.0 + root), np.abs(trace / 2.0 - root))
    # (1 - A) x = b, by Cramer's rule; the determinant is 0 only where a multiplier is 1.
    free = 1.0 - trace + determinant
    with np.errstate(divide="ignore", invalid="ignore"):
        first = ((1.0 - turned[1, 1]) * last[0] + turned[0, 1] * last[1]) / free
        second = (turned[1, 0] * last[0] + (1.0 - turned[0, 0]) * last[1]) / free
        most, state = np.zeros(speeds_rad_s.size), np.stack([first, second])[:, None]
        for row in range(mesh.phi1_rad.size):
            beyond = -mesh.stiffness_n_mm[row] * state[0, 0]
            most = np.maximum(most, np.abs(mesh.torque_n_mm[row] + beyond))
            state = steps.after(row, state, np.ones((1, 1)))
    factor = most / np.abs(mesh.torque_n_mm).max()
    return Swings(np.where(multiplier < 1.0, factor, np.inf), multiplier)


@dataclass(frozen=True, eq=False)
class _Steps:
    """The steps from place to place: a state is x - e, and the momentum J x. with its sense.

    A step of the (m, s) is ``turning`` (m, s, 2, 2) times a state, and ``drift`` (m, s, 2) where e drives it.
    """

    turning: Array
    drift: Array

    @classmethod
    def of(cls, mesh: SwingingMesh, speeds_rad_s: Array) -> _Steps:
        def held(values: Array) -> Array:
            return ((values + np.roll(values, -1)) / 2.0)[:, None]

        angle = np.diff(mesh.phi1_rad, append=mesh.phi1_rad[0] + mesh.cycle_rad)[:, None]
        time = angle / speeds_rad_s
        rate = (np.roll(mesh.error_rad, -1) - mesh.error_rad)[:, None] / time
        stiffness, inertia = held(mesh.stiffness_n_mm), held(mesh.inertia_n_mm_s2)
        swing = np.sqrt(stiffness / inertia)
        decay = mesh.damping_ratio * swing
        slower = swing * np.sqrt(1.0 - mesh.damping_ratio**2)
        fading = np.exp(-decay * time)
        cosine, sine = fading * np.cos(slower * time), fading * np.sin(slower * time) / slower
        # For x - e about its rest r under damping, and its rate v.
        a, b = cosine + decay * sine, sine / inertia
        c, d = -inertia * swing**2 * sine, cosine - decay * sine
        behind = -2.0 * decay * rate / swing**2
        resting = np.stack([np.broadcast_to(behind, time.shape), inertia * rate])
        turning = np.array([[a, b], [c, d]])
        return cls(turning, resting - np.einsum("ij...,j...->i...", turning, resting))

    def after(self, row: int, states: Array, driven: Array) -> Array:
        """States of shape (2, k, s) a place later; ``driven`` (k, 1) marks the driven states of the k."""
        turning, drift = self.turning[:, :, row, None], self.drift[:, row, None] * driven
        return np.asarray(turning[:, 0] * states[0] + turning[:, 1] * states[1] + drift)
