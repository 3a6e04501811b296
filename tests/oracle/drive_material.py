"""A material point along a path: rows joined by straight lines, from rest."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from damage_plasticity import COMPONENTS, Branch, Material, Point, matrix
from tables import Floats

#: Tolerances of the integrator, relative and in MPa (README.md, "Accuracy").
RTOL, ATOL = 1e-11, 1e-12
#: A state with f above -ON_SURFACE [MPa] lies on the yield surface: hundred times the drift of f.
ON_SURFACE = 1e-7
#: A piece ends where a principal stress is this far beyond zero [MPa], so that one that stays at zero ends none.
BEYOND_ZERO = 1e-10
#: Points of a straight elastic path at which f is looked at. f is not convex where beta < gamma.
LOOKS = 65
#: Pieces into which a row may fall.
PIECES = 200


@dataclass
class Curves:
    """The answer, one entry a row of the path."""

    strains: Floats
    stresses: Floats
    #: kt, kc, dt, dc, d. Shape (rows, 5).
    state: Floats
    #: Largest |f| at the end of a plastic piece [MPa].
    drift: float = 0.0


@dataclass
class _Row:
    """Rates within a row, of which the time runs from 0 to 1."""

    strain: Floats
    strain_rate: Floats
    stress_rate: Floats
    #: Duration of the row over the viscosity.
    pace: float


@dataclass
class _Walk:
    """A point that goes along a path. Stresses in MPa; kappa and plastic strains times E, so in MPa, too."""

    point: Point
    stress: Floats = field(default_factory=lambda: np.zeros(6))
    kappa: Floats = field(default_factory=lambda: np.zeros(2))
    #: Free strains times E.
    free: Floats = field(default_factory=lambda: np.zeros(0))
    #: Viscous strain times E, viscous damage.
    viscous: Floats = field(default_factory=lambda: np.zeros(7))
    drift: float = 0.0

    @property
    def kt(self) -> float:
        return float(self.kappa[0] / self.point.material.E)

    @property
    def kc(self) -> float:
        return float(self.kappa[1] / self.point.material.E)

    # ---- Where the point is -----------------------------------------------------------------------------------

    def strengths(self) -> tuple[float, float]:
        m = self.point.material
        sbt = m.tensile.at(self.kt, m.tensile.segment(self.kt))[0]
        return sbt, m.compressive.at(self.kc, m.compressive.segment(self.kc))[0]

    def damages(self) -> tuple[float, float]:
        m = self.point.material
        dt = m.tensile.at(self.kt, m.tensile.segment(self.kt))[2]
        return dt, m.compressive.at(self.kc, m.compressive.segment(self.kc))[2]

    def integrity(self, stress: Floats) -> float:
        return self.point.integrity(self.point.weight(np.linalg.eigvalsh(matrix(stress))), *self.damages())

    def loading(self, row: _Row, neutral: bool) -> Branch | None:
        """The branch on which the point yields from here on, if it does.

        `neutral` says that an elastic piece of no length was the last: the rate of the multiplier may then be zero
        at first, where a path turns along the yield surface.

        At a zero largest principal stress both branches of f are tried. With dlam/dt the directional derivative of
        f falls on both sides of the corner, so one of them at most agrees with its own rate.
        """
        if self.point.yield_function(self.stress, *self.strengths()) < -ON_SURFACE:
            return None
        branch = self.point.branch(self.stress, self.kt, self.kc)
        largest = np.linalg.eigvalsh(matrix(self.stress))[-1]
        both = abs(largest) <= 2.0 * BEYOND_ZERO
        for sign in (-1, 1) if both else (branch.signs[2],):
            tried = Branch(branch.tensile, branch.compressive, (*branch.signs[:2], sign))
            rates = self.point.rates(self.stress, self.kt, self.kc, tried, row.strain_rate, row.stress_rate)
            if (rates[4] > 0.0 or neutral) and (not both or sign * rates[5] >= -BEYOND_ZERO):
                return tried
        return None

    # ---- Pieces -----------------------------------------------------------------------------------------------

    def elastic(self, row: _Row, start: float) -> float:
        """Goes on while nothing yields; the time at which it stops to do so, or 1."""
        before = self.integrity(self.stress)
        rate, free = self.point.elastic_rates(before, row.strain_rate, row.stress_rate)
        strengths = self.strengths()

        def f(t: float) -> float:
            return self.point.yield_function(self.stress + (t - start) * rate, *strengths)

        end = 1.0
        times = np.linspace(start, 1.0, LOOKS)
        low = start
        for t in times[1:]:
            if f(t) > 0.0:
                # f(low) may be a drift above 0 where the point has just left the surface or turns on it.
                end = brentq(f, low, t, xtol=1e-16, rtol=1e-15) if f(low) < 0.0 else low
                break
            low = t
        begin = self.stress.copy()
        if row.pace:
            self._relax(row, start, end, lambda t: begin + (t - start) * rate)
        self.stress = begin + (end - start) * rate
        self.free = self.free + (end - start) * self.point.material.E * free
        if row.stress_rate.any() or self.point.free:
            held = np.abs(self.stress[self.point.free]).max(initial=0.0)
            # Elastic rates hold with a constant d; where r changes d, a zero stress alone stays as prescribed.
            assert abs(self.integrity(self.stress) - before) * held < 1e-9, "d changes under a prescribed stress"
        return float(end)

    def plastic(self, row: _Row, start: float, branch: Branch) -> float:
        """Goes on while the point yields on a branch; the time at which the piece ends, or 1."""
        point, E = self.point, self.point.material.E
        n = len(point.free)

        def split(y: Floats) -> tuple[Floats, float, float]:
            return y[:6], float(y[6] / E), float(y[7] / E)

        last: list[tuple[float, Floats, tuple]] = []

        def rates(t: float, y: Floats) -> tuple:
            if not (last and last[0][0] == t and np.array_equal(last[0][1], y)):
                last[:] = [(t, y.copy(), point.rates(*split(y), branch, row.strain_rate, row.stress_rate))]
            return last[0][2]

        def right_hand_side(t: float, y: Floats) -> Floats:
            stress, free, kt, kc, _, _ = rates(t, y)
            out = np.concatenate([stress, [E * kt, E * kc], E * free, np.zeros(7 if row.pace else 0)])
            if row.pace:
                out[8 + n :] = self._viscous_rates(row, t, *split(y), y[8 + n :])
            return out

        m = point.material
        ends = (m.tensile.end(branch.tensile), m.compressive.end(branch.compressive))

        def unloads(t: float, y: Floats) -> float:
            return rates(t, y)[4]

        def flips(t: float, y: Floats) -> float:
            return float((np.linalg.eigvalsh(matrix(y[:6])) * branch.signs).min() + BEYOND_ZERO)

        events: list[Callable[[float, Floats], float]] = [unloads, flips]
        for i, end in enumerate(ends):
            if np.isfinite(end):
                events.append(lambda t, y, i=i, end=end: E * end - y[6 + i])
        for event in events:
            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        y = np.concatenate([self.stress, self.kappa, self.free, self.viscous if row.pace else []])
        done = solve_ivp(right_hand_side, (start, 1.0), y, "DOP853", events=events, rtol=RTOL, atol=ATOL)
        assert done.status >= 0, done.message
        y = done.y[:, -1]
        self.stress, self.kappa, self.free = y[:6], y[6:8].copy(), y[8 : 8 + n]
        for i, reached in enumerate(done.t_events[2:]):
            if len(reached):
                # To the digit, so that the next piece lies on the next segment.
                which = [i for i, end in enumerate(ends) if np.isfinite(end)][i]
                node = ends[which]
                self.kappa[which] = np.nextafter(E * node, np.inf)
        if row.pace:
            self.viscous = y[8 + n :]
        self.drift = max(self.drift, abs(point.yield_function(self.stress, *self.strengths())))
        return float(done.t[-1])

    # ---- Viscosity --------------------------------------------------------------------------------------------

    def _viscous_rates(self, row: _Row, t: float, stress: Floats, kt: float, kc: float, viscous: Floats) -> Floats:
        """Rates of E eps_v and d_v ("Viscosity")."""
        m = self.point.material
        strain = row.strain + t * row.strain_rate
        plastic = strain - np.linalg.solve(m.stiffness, stress)
        dt = m.tensile.at(kt, m.tensile.segment(kt))[2]
        dc = m.compressive.at(kc, m.compressive.segment(kc))[2]
        r = self.point.weight(np.linalg.eigvalsh(matrix(stress)))
        d = 1.0 - self.point.integrity(r, dt, dc)
        return row.pace * (np.append(m.E * plastic, d) - viscous)

    def _relax(self, row: _Row, start: float, end: float, stress: Callable[[float], Floats]) -> None:
        done = solve_ivp(
            lambda t, y: self._viscous_rates(row, t, stress(t), self.kt, self.kc, y),
            (start, end), self.viscous, "DOP853", rtol=RTOL, atol=ATOL,
        )  # fmt: skip
        self.viscous = done.y[:, -1]


def drive(material: Material, path: Floats, stress: Sequence[str] = (), seconds: float = 1.0) -> Curves:
    """Takes a virgin point along a path.

    Parameters
    ----------
    path
        Strains [-]; nominal stresses [MPa] in the columns that `stress` names. Shape (rows, 6).
    seconds
        Duration of a row, for viscosity.
    """
    point = Point(material, [COMPONENTS.index(name) for name in stress])
    given = [i for i in range(6) if i not in point.free]
    walk = _Walk(point, free=np.zeros(len(point.free)))
    answer = Curves(*(np.zeros((len(path), n)) for n in (6, 6, 5)))
    last = np.zeros(6)
    for i, to in enumerate(path):
        row = _Row(last, np.zeros(6), np.zeros(6), seconds / material.viscosity if material.viscosity else 0.0)
        row.strain_rate[given] = (to - last)[given]
        row.stress_rate[point.free] = (to - last)[point.free]
        t, neutral = 0.0, False
        for _ in range(PIECES):
            branch = walk.loading(row, neutral)
            before = t
            t = walk.plastic(row, t, branch) if branch else walk.elastic(row, t)
            neutral = branch is None and t == before
            if t >= 1.0:
                break
        else:
            raise RuntimeError(f"row {i}: more than {PIECES} pieces")
        last = to
        strain = to.copy()
        strain[point.free] = walk.free / material.E
        integrity = walk.integrity(walk.stress)
        sigma = integrity * walk.stress
        if row.pace:
            sigma = (1.0 - walk.viscous[6]) * material.stiffness @ (strain - walk.viscous[:6] / material.E)
        answer.strains[i], answer.stresses[i] = strain, sigma
        answer.state[i] = [walk.kt, walk.kc, *walk.damages(), 1.0 - integrity]
    answer.drift = walk.drift
    return answer
