"""Hyperbolic Drucker-Prager plasticity: functions of the state, rate equations, a point along a path.

Source: docs/theory/drucker-prager.md, of which equations have their numbers here. Tension is positive, stresses in MPa,
components in the order xx, yy, zz, xy, yz, zx with engineering shear strains. While the point yields,

    dsigma/dt = C : (deps/dt - N dlam/dt)        domega/dt = omega' dlam/dt        dF/dt = 0

and the last equation, the consistency condition, gives the multiplier lam. omega' is (8) with deps_p = N dlam. The
rates are smooth between the kinks of w (9) and the ends of loading; DOP853 of SciPy integrates one such piece after the
other. While the point is elastic the stress is linear in time, and the instant of yielding is a root of F.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.integrate import solve_ivp

from damage_plasticity import COMPONENTS, IDENTITY, TWICE, invariants
from pieces import PIECES, leaves
from tables import Floats

#: Tolerances of the integrator, relative and in MPa (README.md, "Accuracy").
RTOL, ATOL = 1e-12, 1e-13
#: A state with F above -ON_SURFACE [MPa] lies on the yield surface: more than ten times the drift of F.
ON_SURFACE = 1e-7
#: A piece ends where 3 sigma_m is this far beyond q or -q [MPa], so that uniaxial states, where it is either, end none.
#: The error of w is of second order in that.
BEYOND = 1e-9
#: Strength that is left (7).
RESIDUAL = 0.001


@dataclass(frozen=True)
class DruckerPrager:
    """Parameters with the names of the deck: MPa, degrees, N/mm. An energy of `math.inf` says: no softening."""

    E: float
    nu: float
    c: float
    phi: float
    psi: float
    f_t: float
    G_I: float = math.inf
    G_c: float = math.inf
    #: Equivalent length of the element [mm].
    length: float = 1.0

    @cached_property
    def stiffness(self) -> Floats:
        """C [MPa], from strains with engineering shears to stresses. Shape (6, 6)."""
        shear = self.E / (2.0 * (1.0 + self.nu))
        lame = self.E * self.nu / ((1.0 + self.nu) * (1.0 - 2.0 * self.nu))
        return np.diag([2.0 * shear] * 3 + [shear] * 3) + lame * np.outer(IDENTITY, IDENTITY)

    @cached_property
    def eta(self) -> float:
        """Slope of the surface (2)."""
        return _slope(self.phi)

    @cached_property
    def eta_bar(self) -> float:
        """Slope of the potential (5)."""
        return _slope(self.psi)

    @cached_property
    def f_c(self) -> float:
        """f_c (3) [MPa]."""
        phi = math.radians(self.phi)
        return 2.0 * self.c * math.cos(phi) / (1.0 - math.sin(phi))

    @cached_property
    def k(self) -> float:
        """k (4) [MPa]."""
        return 3.0 * (self.f_c - self.f_t) * (1.0 - self.eta**2 / 9.0) / (2.0 * self.eta)

    @cached_property
    def a(self) -> float:
        """a (4) [MPa]."""
        return math.sqrt((self.k - self.eta * self.f_t / 3.0) ** 2 - self.f_t**2)

    def y(self, omega: float) -> float:
        """y (7)."""
        return RESIDUAL + (1.0 - RESIDUAL) * math.exp(-omega)

    def F(self, stress: Floats, omega: float) -> float:
        """F (1) [MPa]."""
        mean, q, _ = invariants(stress)
        y = self.y(omega)
        return math.hypot(q, self.a * y) + self.eta * mean - self.k * y

    def damages(self, kt: float, kc: float) -> tuple[float, float]:
        """Shares of the strength that kappa_t and kappa_c alone would have taken (7, 11)."""
        omegas = self.f_t * self.length * kt / self.G_I, self.f_c * self.length * kc / self.G_c
        return 1.0 - self.y(omegas[0]), 1.0 - self.y(omegas[1])

    def rates(
        self, stress: Floats, omega: float, side: int, strain: Floats, by_stress: Floats, free: list[int]
    ) -> Rates:
        """Rates of a point that yields.

        `side` chooses the formula of w (9): 1 beyond p = 1, -1 below p = 0, 0 between. The stress rates `by_stress` of
        the components `free` are prescribed, all other strain rates in `strain`.
        """
        mean, q, deviator = invariants(stress)
        y = self.y(omega)
        root = math.hypot(q, self.a * y)
        # As derivatives by the six components, in which a shear stands for two.
        radial = 1.5 * TWICE * deviator / root
        normal = radial + self.eta / 3.0 * IDENTITY
        N = radial + self.eta_bar / 3.0 * IDENTITY
        work = float(stress @ N)
        p = 0.5 + 1.5 * mean / q if side == 0 else 0.0
        w = p * p * (3.0 - 2.0 * p) if side == 0 else 0.5 * (1 + side)
        omega_slope = work * self.length / y * (w / self.G_I + (1.0 - w) / self.G_c)
        y_slope = RESIDUAL - y
        # dF/dt = normal : dsigma/dt - softening dlam/dt
        softening = -(self.a**2 * y / root - self.k) * y_slope * omega_slope
        C = self.stiffness
        CN, nC = C @ N, normal @ C
        bottom = float(nC @ N) + softening
        tangent = C - np.outer(CN, nC) / bottom
        rate = strain.copy()
        rate[free] = np.linalg.solve(tangent[np.ix_(free, free)], by_stress[free] - tangent[free] @ strain)
        multiplier = float(nC @ rate) / bottom
        return Rates(
            C @ rate - multiplier * CN,
            multiplier * omega_slope,
            multiplier * w * work / (y * self.f_t),
            multiplier * (1.0 - w) * work / (y * self.f_c),
            rate[free],
            multiplier,
        )


@dataclass(frozen=True)
class Rates:
    """Rates of a point that yields."""

    stress: Floats
    omega: float
    kt: float
    kc: float
    #: Strains whose stresses are prescribed.
    free: Floats
    multiplier: float


@dataclass
class Curves:
    """Results, one entry per row of the path."""

    #: Shape (rows, 6).
    strains: Floats
    #: Stresses [MPa]. Shape (rows, 6).
    stresses: Floats
    #: kappa_t, kappa_c, and the damages of both. Shape (rows, 4).
    state: Floats
    #: Largest |F| at the end of a plastic piece [MPa].
    drift: float = 0.0


@dataclass
class _Point:
    """A point during its path. Stresses in MPa; strains and equivalent plastic strains are multiplied by E."""

    law: DruckerPrager
    free: list[int]
    stress: Floats = field(default_factory=lambda: np.zeros(6))
    omega: float = 0.0
    kappa: Floats = field(default_factory=lambda: np.zeros(2))
    #: Strains whose stresses are prescribed.
    strain: Floats = field(default_factory=lambda: np.zeros(0))
    drift: float = 0.0

    def elastic(self, strain: Floats, by_stress: Floats, start: float) -> float:
        """Integrates until the point yields; returns that time, or 1."""
        law, free, begin, C = self.law, self.free, self.stress, self.law.stiffness
        rate = strain.copy()
        rate[free] = np.linalg.solve(C[np.ix_(free, free)], by_stress[free] - C[free] @ strain)
        to = C @ rate
        end = leaves(lambda t: law.F(begin + (t - start) * to, self.omega), start)
        self.stress = begin + (end - start) * to
        self.strain = self.strain + (end - start) * law.E * rate[free]
        return end

    def plastic(self, strain: Floats, by_stress: Floats, start: float, neutral: bool) -> float | None:
        """Integrates while the point yields and the formula of w holds; returns the end time, or 1.

        None if it does not yield. `neutral` says that the last piece was elastic and had no length. The multiplier
        may then begin at zero, where a path turns along the yield surface.
        """
        law = self.law
        side = _side(self.stress)

        def rates(y: Floats) -> Rates:
            return law.rates(y[:6], float(y[6]), side, strain, by_stress, self.free)

        def right_hand_side(_: float, y: Floats) -> Floats:
            now = rates(y)
            return np.array([*now.stress, now.omega, law.E * now.kt, law.E * now.kc, *(law.E * now.free)])

        # Each event is positive on the piece and falls through zero at its end.
        def unloads(_: float, y: Floats) -> float:
            return rates(y).multiplier

        def tensile(_: float, y: Floats) -> float:
            mean, q, _ = invariants(y[:6])
            return (3.0 * mean - q if side == 1 else q - 3.0 * mean) + BEYOND

        def compressive(_: float, y: Floats) -> float:
            mean, q, _ = invariants(y[:6])
            return (-3.0 * mean - q if side == -1 else q + 3.0 * mean) + BEYOND

        y = np.array([*self.stress, self.omega, *self.kappa, *self.strain])
        if law.F(self.stress, self.omega) < -ON_SURFACE or not (neutral or unloads(start, y) > 0.0):
            return None
        events: list[Callable[[float, Floats], float]] = [unloads, tensile, compressive]
        for event in events:
            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        done = solve_ivp(right_hand_side, (start, 1.0), y, "DOP853", events=events, rtol=RTOL, atol=ATOL)
        if done.status < 0:
            raise RuntimeError(f"no answer beyond the time {done.t[-1]} of a row: {done.message}")
        y = done.y[:, -1]
        self.stress, self.omega, self.kappa, self.strain = y[:6], float(y[6]), y[7:9], y[9:]
        self.drift = max(self.drift, abs(law.F(self.stress, self.omega)))
        return float(done.t[-1])


def _slope(degrees: float) -> float:
    sine = math.sin(math.radians(degrees))
    return 6.0 * sine / (3.0 - sine)


def _side(stress: Floats) -> int:
    """The formula of w (9) that holds; where p is 0 or 1, both formulas have the same w and the same slope."""
    mean, q, _ = invariants(stress)
    return 1 if 3.0 * mean > q else -1 if 3.0 * mean < -q else 0


def drive(law: DruckerPrager, path: Floats, stress: Sequence[str] = ()) -> Curves:
    """Drives a point from its initial state along a path.

    Parameters
    ----------
    path
        Strains [-]; stresses [MPa] in the columns that `stress` names. Shape (rows, 6).
    """
    free = [COMPONENTS.index(name) for name in stress]
    point = _Point(law, free, strain=np.zeros(len(free)))
    answer = Curves(*(np.zeros((len(path), n)) for n in (6, 6, 4)))
    last = np.zeros(6)
    for i, to in enumerate(path):
        rate, by_stress = to - last, np.zeros(6)
        by_stress[free], rate[free] = rate[free], 0.0
        _go(point, rate, by_stress)
        last, strain = to, to.copy()
        strain[free] = point.strain / law.E
        kt, kc = point.kappa / law.E
        answer.strains[i], answer.stresses[i] = strain, point.stress
        answer.state[i] = [kt, kc, *law.damages(kt, kc)]
    answer.drift = point.drift
    return answer


def _go(point: _Point, strain: Floats, by_stress: Floats) -> None:
    """Integrates to the end of a row, whose time runs from 0 to 1."""
    t, neutral = 0.0, False
    for _ in range(PIECES):
        end = point.plastic(strain, by_stress, t, neutral)
        neutral = False
        if end is None:
            end = point.elastic(strain, by_stress, t)
            neutral = end == t
        t = end
        if t >= 1.0:
            return
    raise RuntimeError(f"more than {PIECES} pieces")
