"""A material point along a path whose rows are joined by straight lines, from rest.

The rates of damage_plasticity.py are smooth between nodes of the tables, changes of sign of principal stresses and
the ends of loading. DOP853 of SciPy (explicit Runge-Kutta, order 8, with events) integrates one such piece after the
other. While the point is elastic the stress follows from the strain, and the instant of yielding is a root of f.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from damage_plasticity import COMPONENTS, Branch, Law, Material, Rates, matrix
from pieces import PIECES, leaves
from tables import Floats

#: Tolerances of the integrator, relative and in MPa (README.md, "Accuracy").
RTOL, ATOL = 1e-12, 1e-13
#: A state with f above -ON_SURFACE [MPa] lies on the yield surface: more than ten times the drift of f.
ON_SURFACE = 1e-7
#: A piece ends where a principal stress is this far beyond zero [MPa], so that one that stays at zero ends none.
BEYOND_ZERO = 1e-10


@dataclass
class Curves:
    """Results, one entry per row of the path."""

    #: Shape (rows, 6).
    strains: Floats
    #: Nominal stresses [MPa]. Shape (rows, 6).
    stresses: Floats
    #: kappa_t, kappa_c, d_t, d_c, d. Shape (rows, 5).
    state: Floats
    #: Largest |f| at the end of a plastic piece [MPa].
    drift: float = 0.0


@dataclass
class _Row:
    """Rates within a row, whose time runs from 0 to 1."""

    strain: Floats
    strain_rate: Floats
    stress_rate: Floats
    #: Duration of the row over the viscosity; 0 without viscosity.
    pace: float


@dataclass
class _Point:
    """A point during its path. Stresses in MPa; strains and hardening variables are multiplied by E, so in MPa, too."""

    law: Law
    stress: Floats = field(default_factory=lambda: np.zeros(6))
    kappa: Floats = field(default_factory=lambda: np.zeros(2))
    #: Strains whose stresses are prescribed.
    free: Floats = field(default_factory=lambda: np.zeros(0))
    #: Viscous strain, viscous damage.
    viscous: Floats = field(default_factory=lambda: np.zeros(7))
    drift: float = 0.0

    @property
    def material(self) -> Material:
        return self.law.material

    @property
    def kt(self) -> float:
        return float(self.kappa[0] / self.material.E)

    @property
    def kc(self) -> float:
        return float(self.kappa[1] / self.material.E)

    def strengths(self) -> tuple[float, float]:
        """Effective strengths in tension and compression [MPa]."""
        return _at(self.material, self.kt, self.kc, 0)

    def damages(self) -> tuple[float, float]:
        """d_t and d_c."""
        return _at(self.material, self.kt, self.kc, 2)

    def integrity(self, stress: Floats) -> float:
        """1 - d under an effective stress."""
        return self.law.integrity(self.law.weight(np.linalg.eigvalsh(matrix(stress))), *self.damages())

    # ---- Pieces ---------------------------------------------------------------------------------------------

    def loading(self, row: _Row, neutral: bool) -> Branch | None:
        """The branch on which the point yields from here on; None if it is elastic.

        At a largest principal stress of zero both branches of f are tried: the one holds whose rates lead to its own
        side. The directional derivative of f falls with the multiplier on both sides, so there is one at most.
        `neutral` says that the last piece was elastic and had no length. The multiplier may then begin at zero,
        where a path turns along the yield surface.
        """
        if self.law.yield_function(self.stress, *self.strengths()) < -ON_SURFACE:
            return None
        branch = self.law.branch(self.stress, self.kt, self.kc)
        largest = np.linalg.eigvalsh(matrix(self.stress))[-1]
        corner = abs(largest) <= 2.0 * BEYOND_ZERO
        for sign in (-1, 1) if corner else (branch.signs[2],):
            tried = Branch(branch.tensile, branch.compressive, (*branch.signs[:2], sign))
            rates = self.law.rates(self.stress, self.kt, self.kc, tried, row.strain_rate, row.stress_rate)
            own_side = not corner or sign * rates.largest >= -BEYOND_ZERO
            if own_side and (rates.multiplier > 0.0 or neutral):
                return tried
        return None

    def elastic(self, row: _Row, start: float) -> float:
        """Integrates until the point yields; returns that time, or 1."""
        C, free = self.material.stiffness, self.law.free
        begin, strengths = self.stress, self.strengths()
        held = self.integrity(begin) * begin[free]
        flexibility = np.linalg.inv(C[np.ix_(free, free)])

        def at(t: float, integrity: float) -> tuple[Floats, Floats]:
            """Effective stress and increments of the free strains for a given 1 - d."""
            trial = begin + (t - start) * C @ row.strain_rate
            wanted = (held + (t - start) * row.stress_rate[free]) / integrity
            strain = flexibility @ (wanted - trial[free])
            out = trial + C[:, free] @ strain
            out[free] = wanted
            return out, strain

        def found(t: float) -> tuple[Floats, Floats]:
            """The same with the 1 - d of that stress: r changes while the point is elastic."""
            if not (held.any() or row.stress_rate.any()):
                return at(t, 1.0)
            low, high = sorted(self.law.integrity(r, *self.damages()) for r in (0.0, 1.0))
            if low == high:
                return at(t, low)
            # Wider by rounding, since an end of the interval may be the root.
            low, high = low * (1.0 - 1e-9), high * (1.0 + 1e-9)
            return at(t, brentq(lambda x: x - self.integrity(at(t, x)[0]), low, high, xtol=1e-16, rtol=1e-15))

        end = leaves(lambda t: self.law.yield_function(found(t)[0], *strengths), start)
        if row.pace:
            self._relax(row, start, end, lambda t: found(t)[0])
        self.stress, strain = found(end)
        self.free = self.free + self.material.E * strain
        return end

    def plastic(self, row: _Row, start: float, branch: Branch) -> float:
        """Integrates while the point yields on a branch; returns the end time, or 1."""
        E, n = self.material.E, len(self.law.free)
        ends = (self.material.tensile.end(branch.tensile), self.material.compressive.end(branch.compressive))

        def rates(y: Floats) -> Rates:
            return self.law.rates(y[:6], y[6] / E, y[7] / E, branch, row.strain_rate, row.stress_rate)

        def right_hand_side(t: float, y: Floats) -> Floats:
            now = rates(y)
            parts = [now.stress, [E * now.kt, E * now.kc], E * now.free]
            if row.pace:
                kappa = float(y[6] / E), float(y[7] / E)
                parts.append(self._viscous_rates(row, t, y[:6], kappa, branch.signs, y[8 + n :]))
            return np.concatenate(parts)

        # Each event is positive on the piece and falls through zero at its end.
        def unloads(_: float, y: Floats) -> float:
            return rates(y).multiplier

        def changes_sign(_: float, y: Floats) -> float:
            return float((np.linalg.eigvalsh(matrix(y[:6])) * branch.signs).min() + BEYOND_ZERO)

        events: list[Callable[[float, Floats], float]] = [unloads, changes_sign]
        nodes = [i for i in (0, 1) if np.isfinite(ends[i])]
        for i in nodes:
            events.append(lambda _, y, i=i: E * ends[i] - y[6 + i])
        for event in events:
            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        y = np.concatenate([self.stress, self.kappa, self.free, self.viscous if row.pace else []])
        done = solve_ivp(right_hand_side, (start, 1.0), y, "DOP853", events=events, rtol=RTOL, atol=ATOL)
        if done.status < 0:
            raise RuntimeError(f"no answer beyond the time {done.t[-1]} of a row: {done.message}")
        y = done.y[:, -1]
        self.stress, self.kappa, self.free = y[:6], y[6:8].copy(), y[8 : 8 + n]
        if row.pace:
            self.viscous = y[8 + n :]
        for i, times in zip(nodes, done.t_events[2:], strict=True):
            if len(times):
                # Move to the next segment, independently of rounding.
                self.kappa[i] = np.nextafter(E * ends[i], np.inf)
        self.drift = max(self.drift, abs(self.law.yield_function(self.stress, *self.strengths())))
        return float(done.t[-1])

    # ---- Viscosity ------------------------------------------------------------------------------------------

    def _viscous_rates(
        self,
        row: _Row,
        t: float,
        stress: Floats,
        kappa: tuple[float, float],
        signs: Sequence[int],
        viscous: Floats,
    ) -> Floats:
        """Rates whose backward Euler step is (13): mu deps_v/dt = eps_p - eps_v, the same of d_v."""
        m = self.material
        plastic = row.strain + t * row.strain_rate - np.linalg.solve(m.stiffness, stress)
        r = self.law.weight(np.linalg.eigvalsh(matrix(stress)), signs)
        d = 1.0 - self.law.integrity(r, *_at(m, *kappa, 2))
        return row.pace * (np.append(m.E * plastic, d) - viscous)

    def _relax(self, row: _Row, start: float, end: float, stress: Callable[[float], Floats]) -> None:
        """Viscous strain and damage while the point is elastic, in pieces between changes of sign."""
        while start < end:
            signs = np.where(np.linalg.eigvalsh(matrix(stress(start))) > 0.0, 1, -1)

            def rates(t: float, y: Floats, signs: Floats = signs) -> Floats:
                return self._viscous_rates(row, t, stress(t), (self.kt, self.kc), signs, y)

            def changes_sign(t: float, _: Floats, signs: Floats = signs) -> float:
                return float((np.linalg.eigvalsh(matrix(stress(t))) * signs).min() + BEYOND_ZERO)

            changes_sign.terminal, changes_sign.direction = True, -1  # type: ignore[attr-defined]
            done = solve_ivp(
                rates, (start, end), self.viscous, "DOP853", events=changes_sign, rtol=RTOL, atol=ATOL
            )
            self.viscous, start = done.y[:, -1], float(done.t[-1])


def _at(material: Material, kt: float, kc: float, which: int) -> tuple[float, float]:
    """One of the values of both curves."""
    tensile, compressive = material.tensile, material.compressive
    return (
        tensile.at(kt, tensile.segment(kt))[which],
        compressive.at(kc, compressive.segment(kc))[which],
    )


def drive(material: Material, path: Floats, stress: Sequence[str] = (), seconds: float = 1.0) -> Curves:
    """Drives a point from its initial state along a path.

    Parameters
    ----------
    path
        Strains [-]; nominal stresses [MPa] in the columns that `stress` names. Shape (rows, 6).
    seconds
        Duration of a row, for viscosity, which needs prescribed strains.
    """
    law = Law(material, [COMPONENTS.index(name) for name in stress])
    if material.viscosity and law.free:
        raise ValueError("with viscosity all strains are prescribed")
    given = [i for i in range(6) if i not in law.free]
    point = _Point(law, free=np.zeros(len(law.free)))
    answer = Curves(*(np.zeros((len(path), n)) for n in (6, 6, 5)))
    last = np.zeros(6)
    for i, to in enumerate(path):
        row = _Row(last, np.zeros(6), np.zeros(6), seconds / material.viscosity if material.viscosity else 0.0)
        row.strain_rate[given] = (to - last)[given]
        row.stress_rate[law.free] = (to - last)[law.free]
        _go(point, row)
        last = to
        strain = to.copy()
        strain[law.free] = point.free / material.E
        integrity = point.integrity(point.stress)
        sigma = integrity * point.stress
        if row.pace:
            # (14)
            sigma = (1.0 - point.viscous[6]) * material.stiffness @ (strain - point.viscous[:6] / material.E)
        answer.strains[i], answer.stresses[i] = strain, sigma
        answer.state[i] = [point.kt, point.kc, *point.damages(), 1.0 - integrity]
    answer.drift = point.drift
    return answer


def _go(point: _Point, row: _Row) -> None:
    """Integrates to the end of a row."""
    t, neutral = 0.0, False
    for _ in range(PIECES):
        before = t
        branch = point.loading(row, neutral)
        t = point.plastic(row, t, branch) if branch else point.elastic(row, t)
        if t >= 1.0:
            return
        neutral = branch is None and t == before
    raise RuntimeError(f"more than {PIECES} pieces")
