"""Concrete damaged plasticity: functions of the state and rate equations.

Source: docs/theory/damage-plasticity.md, of which equations have their numbers here. Tension is positive, stresses in
MPa, components in the order xx, yy, zz, xy, yz, zx with engineering shear strains. The state is the effective stress
and the two hardening variables. While the point yields, with C0 the elastic stiffness,

    dsigma_bar/dt = C0 : (deps/dt - N dlam/dt)        dkappa/dt = h dlam/dt        df/dt = 0

and the last equation, the consistency condition, gives the multiplier lam.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from tables import Curve, Floats, Rows, curve

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")
IDENTITY = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
#: How often each component stands in the tensor.
TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
#: Places of the six components in a symmetric 3 x 3 matrix.
ROW, COLUMN = [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]
#: Principal stresses that differ by less are equal; a smaller von Mises stress is rounding [MPa].
EQUAL = 1e-9


@dataclass(frozen=True)
class Material:
    """Parameters of a material with the names of the deck; angle in degrees, viscosity in s."""

    E: float
    nu: float
    tension: Rows
    compression: Rows
    dilation_angle: float = 10.0
    eccentricity: float = 0.1
    fb0_fc0: float = 1.16
    K_c: float = 2.0 / 3.0
    tension_recovery: float = 0.0
    compression_recovery: float = 1.0
    viscosity: float = 0.0
    interpolation: str = "eff1"
    #: l_ref/l of the crack band.
    length_ratio: float = 1.0

    def _curve(self, rows: Rows) -> Curve:
        return curve(rows, self.E, interpolation=self.interpolation, length_ratio=self.length_ratio)

    @cached_property
    def tensile(self) -> Curve:
        """Curve over kappa_t."""
        return self._curve(self.tension)

    @cached_property
    def compressive(self) -> Curve:
        """Curve over kappa_c."""
        return self._curve(self.compression)

    @cached_property
    def stiffness(self) -> Floats:
        """C0 [MPa], from strains with engineering shears to stresses. Shape (6, 6)."""
        shear = self.E / (2.0 * (1.0 + self.nu))
        bulk = self.E / (3.0 * (1.0 - 2.0 * self.nu))
        stiffness = np.diag([2.0 * shear] * 3 + [shear] * 3)
        stiffness[:3, :3] += bulk - 2.0 * shear / 3.0
        return stiffness

    @cached_property
    def alpha(self) -> float:
        """alpha (3): biaxial compression."""
        return (self.fb0_fc0 - 1.0) / (2.0 * self.fb0_fc0 - 1.0)

    @cached_property
    def gamma(self) -> float:
        """gamma (3): triaxial compression."""
        return 3.0 * (1.0 - self.K_c) / (2.0 * self.K_c - 1.0)

    @cached_property
    def T(self) -> float:
        """T (6): tangent of the dilation angle."""
        return math.tan(math.radians(self.dilation_angle))

    @cached_property
    def a(self) -> float:
        """a (6): rounding of the potential's vertex [MPa]."""
        return self.eccentricity * self.tension[0][0] * self.T


@dataclass(frozen=True)
class Branch:
    """A smooth piece of the rates: segments of both curves and signs of the principal stresses, smallest first."""

    tensile: int
    compressive: int
    signs: tuple[int, int, int]


@dataclass(frozen=True)
class Rates:
    """Rates of a point that yields."""

    stress: Floats
    #: Strains whose stresses are prescribed.
    free: Floats
    kt: float
    kc: float
    multiplier: float
    #: Of the largest principal stress.
    largest: float


def matrix(stress: Floats) -> Floats:
    """A stress as a symmetric 3 x 3 matrix."""
    out = np.empty((3, 3))
    out[ROW, COLUMN] = stress
    out[COLUMN, ROW] = stress
    return out


def dyad(vector: Floats) -> Floats:
    """Weights w of the six components with w . stress = vector . stress . vector."""
    x, y, z = vector
    return np.array([x * x, y * y, z * z, 2.0 * x * y, 2.0 * y * z, 2.0 * z * x])


def invariants(stress: Floats) -> tuple[float, float, Floats]:
    """Mean stress, von Mises stress q, deviator (1)."""
    mean = float(stress[0] + stress[1] + stress[2]) / 3.0
    deviator = stress - mean * IDENTITY
    return mean, math.sqrt(1.5 * float(deviator @ (TWICE * deviator))), deviator


@dataclass
class Law:
    """The law of a material, of which the strains or the nominal stresses are prescribed."""

    material: Material
    #: Components whose nominal stress is prescribed instead of the strain.
    free: list[int] = field(default_factory=list)

    # ---- Functions of the state -----------------------------------------------------------------------------

    def beta(self, sbt: float, sbc: float) -> float:
        """beta (4) of both effective strengths."""
        return (1.0 - self.material.alpha) * sbc / sbt - (1.0 + self.material.alpha)

    def yield_function(self, stress: Floats, sbt: float, sbc: float) -> float:
        """f (2) [MPa] of an effective stress and both effective strengths."""
        m = self.material
        mean, q, _ = invariants(stress)
        largest = float(np.linalg.eigvalsh(matrix(stress))[-1])
        corner = self.beta(sbt, sbc) * max(largest, 0.0) - m.gamma * max(-largest, 0.0)
        return q + 3.0 * m.alpha * mean + corner - (1.0 - m.alpha) * sbc

    def flow(self, stress: Floats) -> Floats:
        """N (6) with engineering shears."""
        m = self.material
        _, q, deviator = invariants(stress)
        if q < EQUAL:
            return m.T / 3.0 * IDENTITY
        return TWICE * (1.5 * deviator / math.hypot(m.a, q) + m.T / 3.0 * IDENTITY)

    def weight(self, principal: Floats, signs: Sequence[int] | None = None) -> float:
        """r (7)."""
        tensile, total = 0.0, 0.0
        for p, sign in zip(principal, np.sign(principal) if signs is None else signs, strict=True):
            tensile += p if sign > 0 else 0.0
            total += sign * p
        return float(tensile / total) if total > 0.0 else 0.0

    def hardening(self, principal: Floats, r: float) -> tuple[float, float]:
        """dkappa_t/dlam and dkappa_c/dlam (8); N has the principal directions of the stress."""
        m = self.material
        least, middle, largest = (float(p) for p in principal)
        mean = (least + middle + largest) / 3.0
        square = (least - mean) ** 2 + (middle - mean) ** 2 + (largest - mean) ** 2
        scale = 1.5 / math.sqrt(m.a**2 + 1.5 * square)
        n_min, n_max = scale * (least - mean) + m.T / 3.0, scale * (largest - mean) + m.T / 3.0
        return r * max(n_max, 0.0), (1.0 - r) * max(-n_min, 0.0)

    def integrity(self, r: float, dt: float, dc: float) -> float:
        """1 - d (12)."""
        m = self.material
        s_t, s_c = 1.0 - m.tension_recovery * r, 1.0 - m.compression_recovery * (1.0 - r)
        return (1.0 - s_t * dc) * (1.0 - s_c * dt)

    # ---- Rates ----------------------------------------------------------------------------------------------

    def branch(self, stress: Floats, kt: float, kc: float) -> Branch:
        """The piece on which a state lies."""
        least, middle, largest = (1 if p > 0.0 else -1 for p in np.linalg.eigvalsh(matrix(stress)))
        m = self.material
        return Branch(m.tensile.segment(kt), m.compressive.segment(kc), (least, middle, largest))

    def rates(
        self, stress: Floats, kt: float, kc: float, branch: Branch, strain_rate: Floats, stress_rate: Floats
    ) -> Rates:
        """Rates of a point that yields.

        `strain_rate` is zero in the components whose nominal stress is prescribed; `stress_rate` holds those rates.
        """
        m = self.material
        C = m.stiffness
        principal, vectors = np.linalg.eigh(matrix(stress))
        if principal[2] - principal[1] < EQUAL:
            # Of two equal values the one that grows faster becomes the largest. The flow is the same for both, so
            # the elastic rates tell which.
            pair = vectors[:, 1:]
            _, turn = np.linalg.eigh(pair.T @ matrix(C @ strain_rate) @ pair)
            vectors[:, 1:] = pair @ turn
        of_principal = [dyad(v) for v in vectors.T]
        sbt, sbt_k, dt, dt_k = m.tensile.at(kt, branch.tensile)
        sbc, sbc_k, dc, dc_k = m.compressive.at(kc, branch.compressive)

        # Derivatives of f with respect to sigma_bar, kappa_t, kappa_c.
        _, q, deviator = invariants(stress)
        positive = branch.signs[2] > 0
        f_s = m.alpha * IDENTITY + (self.beta(sbt, sbc) if positive else m.gamma) * of_principal[2]
        if q > EQUAL:
            f_s += TWICE * (1.5 * deviator / q)
        largest = float(principal[2]) if positive else 0.0
        f_kt = -largest * (1.0 - m.alpha) * sbc * sbt_k / sbt**2
        f_kc = (1.0 - m.alpha) * sbc_k * (largest / sbt - 1.0)

        r = self.weight(principal, branch.signs)
        h_t, h_c = self.hardening(principal, r)
        flow = C @ self.flow(stress)
        trial = C @ strain_rate

        # With rate = trial + C_u deps_u - flow dlam the unknowns are the free strains' rates and the multiplier's:
        #   f_s . rate + (f_kt h_t + f_kc h_c) dlam = 0                           consistency
        #   (1 - d) rate_u + sigma_bar_u d(1 - d)/dt = stress_rate_u              prescribed nominal stress
        n = len(self.free)
        A, b = np.empty((n + 1, n + 1)), np.empty(n + 1)
        A[0, :n] = f_s @ C[:, self.free]
        A[0, n] = -f_s @ flow + f_kt * h_t + f_kc * h_c
        b[0] = -f_s @ trial
        if n:
            r_s = np.zeros(6)
            total = float(np.dot(branch.signs, principal))
            if total > 0.0:
                for sign, weights in zip(branch.signs, of_principal, strict=True):
                    r_s += ((sign > 0) - r * sign) / total * weights
            s_t, s_c = 1.0 - m.tension_recovery * r, 1.0 - m.compression_recovery * (1.0 - r)
            left, right = 1.0 - s_t * dc, 1.0 - s_c * dt
            by_r = m.tension_recovery * dc * right - left * m.compression_recovery * dt
            by_multiplier = -s_t * dc_k * h_c * right - left * s_c * dt_k * h_t
            for i, u in enumerate(self.free):
                to = by_r * stress[u] * r_s
                to[u] += left * right
                A[1 + i, :n] = to @ C[:, self.free]
                A[1 + i, n] = -to @ flow + stress[u] * by_multiplier
                b[1 + i] = stress_rate[u] - to @ trial
        x = np.linalg.solve(A, b) if n else b / A[0]
        multiplier = float(x[n])
        rate = trial + C[:, self.free] @ x[:n] - flow * multiplier
        return Rates(rate, x[:n], h_t * multiplier, h_c * multiplier, multiplier, float(of_principal[2] @ rate))
