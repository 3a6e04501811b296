"""The cohesive-frictional joint: functions of the state and rate equations.

Source: docs/theory/joint.md, of which equations have their numbers here; 1 to 8 are those of the paper. Opening u and
slip delta in mm, normal traction sigma (tension positive) and shear traction tau in MPa. While the joint slips,

    ddelta_p/dt = n dgamma/dt,   n = tau/|tau|          d|tau|/dt = dg/dt

and the last equation, the consistency condition, gives the multiplier gamma. With tau = k_s (delta - delta_p) (16) it
and the part across n read

    k_s dgamma/dt = k_s n . ddelta/dt - dg/dt           |tau| dn/dt = k_s (1 - n n) . ddelta/dt
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from tables import Floats


@dataclass(frozen=True)
class Joint:
    """Parameters of a joint with the names of the deck: MPa, mm, N/mm^3. Without f_t and c it is dry (19)."""

    f_t: float
    c: float
    tan_phi: float
    mu: float
    u_k: float
    delta_k: float
    zeta: float
    xi: float
    normal_stiffness: float
    shear_stiffness: float
    coupling: str = "max"

    @property
    def dry(self) -> bool:
        """Whether there is no bond."""
        return self.f_t == 0.0 and self.c == 0.0

    @property
    def u_0(self) -> float:
        """u_0 (9) [mm]."""
        return self.f_t / self.normal_stiffness

    def Q(self, w: float) -> float:
        """Q (6, 10) of w [mm]."""
        return _scaling(self.zeta, w / self.u_k)

    def H(self, s: float) -> float:
        """H (8, 10) of s_max [mm]."""
        return _scaling(self.xi, s / self.delta_k)

    def slope_Q(self, damage: float) -> float:
        """Q'(Q^-1(D)) [1/mm]."""
        return _slope(self.zeta, damage) / self.u_k if damage < 1.0 else 0.0

    def slope_H(self, damage: float) -> float:
        """H'(H^-1(D)) [1/mm]."""
        return _slope(self.xi, damage) / self.delta_k if damage < 1.0 else 0.0

    def normal(self, u: float, u_max: float, damage: float) -> float:
        """sigma (1, 5, 14) [MPa]."""
        if u <= 0.0:
            return self.normal_stiffness * u
        if damage >= 1.0:
            return 0.0
        return (1.0 - damage) * self.f_t * u / max(u_max, (1.0 - damage) * self.u_0)

    def limit(self, sigma: float, damage: float) -> float:
        """g (3, 7, 15) [MPa]."""
        bond = max(self.c - self.tan_phi * sigma, 0.0)
        return (1.0 - damage) * bond + damage * self.mu * max(-sigma, 0.0)


def _scaling(brittleness: float, part: float) -> float:
    return 1.0 if part >= 1.0 else math.expm1(-brittleness * max(part, 0.0)) / math.expm1(-brittleness)


def _slope(brittleness: float, damage: float) -> float:
    """Derivative of `_scaling` with respect to the part, where its value is `damage`."""
    whole = -math.expm1(-brittleness)
    return brittleness * (1.0 - whole * damage) / whole


@dataclass(frozen=True)
class Part:
    """A part of a row, in which u passes none of 0, u_max, u_0, u_0 + u_k. Its time runs from 0 to 1."""

    u: float
    u_rate: float
    slip: Floats
    slip_rate: Floats
    closed: bool
    #: u = u_max grows.
    loading: bool
    #: u = u_max grows beyond u_0, and w with it.
    softening: bool


@dataclass(frozen=True)
class Branch:
    """A smooth piece of the rates of slip."""

    #: sigma = k_n u although open: u_max < (1 - D) u_0.
    elastic: bool
    #: "Q", "H" or "both" drives D; "": D is constant.
    driver: str
    #: s_max = |delta_p| grows.
    growing: bool


def outwards(plastic: Floats, n: Floats) -> float:
    """d|delta_p|/dgamma."""
    length = math.hypot(*plastic)
    return float(plastic @ n) / length if length > 0.0 else 1.0


def rates(
    j: Joint, part: Part, branch: Branch, u: float, u_max: float, damage: float, plastic: Floats, n: Floats
) -> tuple[float, float]:
    """dgamma/dt and dD/dt of a point that slips in the direction n."""
    # dD = D_t dt + D_gamma dgamma
    D_t = j.slope_Q(damage) * part.u_rate if branch.driver in ("Q", "both") and part.softening else 0.0
    D_gamma = 0.0
    if branch.driver in ("H", "both") and branch.growing:
        D_gamma = j.slope_H(damage) * outwards(plastic, n)
    # dsigma = s_t dt + s_D dD
    if part.closed or branch.elastic:
        s_t, s_D = j.normal_stiffness * part.u_rate, 0.0
    elif damage >= 1.0:
        s_t, s_D = 0.0, 0.0
    elif part.loading:
        s_t, s_D = 0.0, -j.f_t
    else:
        s_t, s_D = (1.0 - damage) * j.f_t / u_max * part.u_rate, -j.f_t * u / u_max
    sigma = j.normal(u, u_max, damage)
    bonded, pressed = j.c - j.tan_phi * sigma > 0.0, sigma < 0.0
    # At sigma = 0 the side on which the part lies.
    pressed = pressed or (sigma == 0.0 and part.closed)
    g_s = -(1.0 - damage) * j.tan_phi * bonded - damage * j.mu * pressed
    g_D = -max(j.c - j.tan_phi * sigma, 0.0) + j.mu * max(-sigma, 0.0)
    by_D = g_s * s_D + g_D
    ks = j.shear_stiffness
    gamma = (ks * float(n @ part.slip_rate) - g_s * s_t - by_D * D_t) / (ks + by_D * D_gamma)
    return gamma, D_t + D_gamma * gamma
