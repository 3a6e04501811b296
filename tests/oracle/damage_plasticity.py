"""Concrete damaged plasticity as rate equations, integrated with SciPy to nearly the last digit.

Source: docs/theory/damage-plasticity.md; the sections are named where they are used. Tension is positive, stresses
in MPa, components in the order xx, yy, zz, xy, yz, zx with engineering shear strains.

The state is (sigma_bar, kappa_t, kappa_c). While the point yields, the multiplier follows from consistency,

    d sigma_bar/dt = C0 : (d eps/dt - N dlam/dt)      d kappa/dt = h dlam/dt      df/dt = 0,

and DOP853 (explicit, order 8) integrates this between the points where the right-hand side has a kink: nodes of the
tables, changes of sign of a principal stress, the end of loading. While the point is elastic the effective stress is
linear in time; the instant at which it yields is a root of f along a straight line.
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

#: Principal stresses that differ by less [MPa] count as equal.
EQUAL = 1e-9


@dataclass(frozen=True)
class Material:
    """Parameters of a material as a deck has them; the angle in degrees."""

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
    length_ratio: float = 1.0

    def _curve(self, rows: Rows) -> Curve:
        return curve(rows, self.E, interpolation=self.interpolation, length_ratio=self.length_ratio)

    @cached_property
    def tensile(self) -> Curve:
        """Curve of kappa_t."""
        return self._curve(self.tension)

    @cached_property
    def compressive(self) -> Curve:
        """Curve of kappa_c."""
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
        """Of the yield function: biaxial strength."""
        return (self.fb0_fc0 - 1.0) / (2.0 * self.fb0_fc0 - 1.0)

    @cached_property
    def gamma(self) -> float:
        """Of the yield function: triaxial compression."""
        return 3.0 * (1.0 - self.K_c) / (2.0 * self.K_c - 1.0)

    @cached_property
    def T(self) -> float:
        """Tangent of the dilation angle."""
        return float(np.tan(np.radians(self.dilation_angle)))

    @cached_property
    def a(self) -> float:
        """Rounding of the potential's vertex [MPa], of the first stress of the tension table."""
        return self.eccentricity * self.tension[0][0] * self.T


@dataclass(frozen=True)
class Branch:
    """Which smooth piece of the right-hand side holds: segments of both curves, signs of principal stresses."""

    tensile: int
    compressive: int
    #: In the order of rising principal stresses.
    signs: tuple[int, int, int]


def matrix(stress: Floats) -> Floats:
    """A stress as a symmetric 3 x 3 matrix; leading axes stay."""
    out = np.empty((*stress.shape[:-1], 3, 3))
    out[..., ROW, COLUMN] = stress
    out[..., COLUMN, ROW] = stress
    return out


def dyad(vector: Floats) -> Floats:
    """Weights w with w . stress = vector . stress . vector, the six components' stress."""
    x, y, z = vector
    return np.array([x * x, y * y, z * z, 2 * x * y, 2 * y * z, 2 * z * x])


@dataclass
class Point:
    """A material point and the functions of its state."""

    material: Material
    #: Components whose nominal stress is prescribed instead of the strain.
    free: list[int] = field(default_factory=list)

    # ---- Functions of the state -----------------------------------------------------------------------------

    def invariants(self, stress: Floats) -> tuple[float, float, Floats]:
        """Mean stress, q [MPa], deviator."""
        mean = float(stress[0] + stress[1] + stress[2]) / 3.0
        deviator = stress - mean * IDENTITY
        return mean, math.sqrt(1.5 * float(deviator @ (TWICE * deviator))), deviator

    def beta(self, sbt: float, sbc: float) -> float:
        """Of the yield function: tension, from both effective strengths."""
        return (1.0 - self.material.alpha) * sbc / sbt - (1.0 + self.material.alpha)

    def yield_function(self, stress: Floats, sbt: float, sbc: float) -> float:
        """f [MPa] of an effective stress ("Yield")."""
        m = self.material
        mean, q, _ = self.invariants(stress)
        largest = np.linalg.eigvalsh(matrix(stress))[-1]
        corner = self.beta(sbt, sbc) * max(largest, 0.0) - m.gamma * max(-largest, 0.0)
        return (q + 3.0 * m.alpha * mean + corner) / (1.0 - m.alpha) - sbc

    def flow(self, stress: Floats) -> Floats:
        """N with engineering shears ("Flow")."""
        m = self.material
        _, q, deviator = self.invariants(stress)
        n = 1.5 * deviator / math.hypot(m.a, q) + m.T / 3.0 * IDENTITY
        n[3:] *= 2.0
        return n

    def weight(self, principal: Floats, signs: Sequence[int] | None = None) -> float:
        """r: part of the principal stresses that is tensile, 0 without stress ("Hardening")."""
        tensile, total = 0.0, 0.0
        for p, sign in zip(principal, np.sign(principal) if signs is None else signs, strict=True):
            tensile += p if sign > 0 else 0.0
            total += sign * p
        return float(tensile / total) if total > 0.0 else 0.0

    def hardening(self, principal: Floats, r: float) -> tuple[float, float]:
        """d kappa_t/dlam and d kappa_c/dlam ("Hardening"); N has the directions of the stress."""
        m = self.material
        least, middle, largest = (float(p) for p in principal)
        mean = (least + middle + largest) / 3.0
        square = (least - mean) ** 2 + (middle - mean) ** 2 + (largest - mean) ** 2
        scale = 1.5 / math.sqrt(m.a**2 + 1.5 * square)
        n_min, n_max = scale * (least - mean) + m.T / 3.0, scale * (largest - mean) + m.T / 3.0
        return r * max(n_max, 0.0), (1.0 - r) * max(-n_min, 0.0)

    def integrity(self, r: float, dt: float, dc: float) -> float:
        """1 - d ("Damage and recovery")."""
        m = self.material
        return (1.0 - (1.0 - m.tension_recovery * r) * dc) * (1.0 - (1.0 - m.compression_recovery * (1.0 - r)) * dt)

    # ---- Rates ----------------------------------------------------------------------------------------------

    def branch(self, stress: Floats, kt: float, kc: float) -> Branch:
        """The piece on which a state lies, by the signs that its principal stresses have now."""
        signs = [1 if p > 0.0 else -1 for p in np.linalg.eigvalsh(matrix(stress))]
        m = self.material
        return Branch(m.tensile.segment(kt), m.compressive.segment(kc), (signs[0], signs[1], signs[2]))

    def rates(
        self, stress: Floats, kt: float, kc: float, branch: Branch, strain_rate: Floats, stress_rate: Floats
    ) -> tuple[Floats, Floats, float, float, float, float]:
        """Plastic rates of stress, free strains, kt, kc; the multiplier's rate; that of the largest principal stress.

        `strain_rate` is 0 where the stress is prescribed, of which `stress_rate` holds the nominal rates.
        """
        m = self.material
        C = m.stiffness
        principal, vectors = np.linalg.eigh(matrix(stress))
        if principal[2] - principal[1] < EQUAL:
            # Of equal values the one that grows faster is the larger one from now on. The flow does not tell them
            # apart, so the elastic rate decides.
            pair = vectors[:, 1:]
            _, turn = np.linalg.eigh(pair.T @ matrix(C @ strain_rate) @ pair)
            vectors[:, 1:] = pair @ turn
        of_principal = [dyad(v) for v in vectors.T]
        sbt, sbt_k, dt, dt_k = m.tensile.at(kt, branch.tensile)
        sbc, sbc_k, dc, dc_k = m.compressive.at(kc, branch.compressive)

        # df/d sigma_bar, df/d kappa_t, df/d kappa_c
        mean, q, deviator = self.invariants(stress)
        direction = 1.5 * deviator / q if q > 0.0 else np.zeros(6)
        direction[3:] *= 2.0  # each shear component stands for two of the tensor
        positive = branch.signs[2] > 0
        beta = self.beta(sbt, sbc)
        f_s = direction + m.alpha * IDENTITY + (beta if positive else m.gamma) * of_principal[2]
        f_s /= 1.0 - m.alpha
        largest = principal[2] if positive else 0.0
        f_kt = -largest * sbc * sbt_k / sbt**2
        f_kc = largest * sbc_k / sbt - sbc_k

        r = self.weight(principal, branch.signs)
        h_t, h_c = self.hardening(principal, r)
        flow = C @ self.flow(stress)
        trial = C @ strain_rate

        # Unknown are the rates of the free strains and of the multiplier:
        #   f_s . rate + (f_kt h_t + f_kc h_c) dlam = 0                            consistency
        #   (1 - d) rate_u + sigma_bar_u d(1 - d)/dt = stress_rate_u               prescribed nominal stress
        # with rate = trial + C_u deps_u - flow dlam.
        n = len(self.free)
        A, b = np.empty((n + 1, n + 1)), np.empty(n + 1)
        A[0, :n] = f_s @ C[:, self.free]
        A[0, n] = -f_s @ flow + f_kt * h_t + f_kc * h_c
        b[0] = -f_s @ trial
        if n:
            total = float(np.dot(branch.signs, principal))
            r_s = np.zeros(6)
            if total > 0.0:
                r_s = sum(((s > 0) - r * s) * w for s, w in zip(branch.signs, of_principal, strict=True)) / total
            s_t, s_c = 1.0 - m.tension_recovery * r, 1.0 - m.compression_recovery * (1.0 - r)
            left, right = 1.0 - s_t * dc, 1.0 - s_c * dt
            by_r = m.tension_recovery * dc * right - left * m.compression_recovery * dt
            by_lam = -s_t * dc_k * h_c * right - left * s_c * dt_k * h_t
            for i, u in enumerate(self.free):
                to = by_r * stress[u] * r_s
                to[u] += left * right
                A[1 + i, :n] = to @ C[:, self.free]
                A[1 + i, n] = -to @ flow + stress[u] * by_lam
                b[1 + i] = stress_rate[u] - to @ trial
        x = np.linalg.solve(A, b) if n else b / A[0]
        multiplier = float(x[n])
        rate = trial + C[:, self.free] @ x[:n] - flow * multiplier
        return rate, x[:n], h_t * multiplier, h_c * multiplier, multiplier, float(of_principal[2] @ rate)

    def elastic_rates(self, integrity: float, strain_rate: Floats, stress_rate: Floats) -> tuple[Floats, Floats]:
        """Rates of the effective stress and of the free strains while nothing yields and d stays."""
        C = self.material.stiffness
        trial = C @ strain_rate
        free = np.linalg.solve(
            C[np.ix_(self.free, self.free)], stress_rate[self.free] / integrity - trial[self.free]
        )
        rate = trial + C[:, self.free] @ free
        rate[self.free] = stress_rate[self.free] / integrity
        return rate, free
